!> Order of elimination and pattern of the Cholesky factor: minimum degree, once at the start. A
!> tree of bodies, whatever its degrees, has no fill.
!> Source: docs/theory/compliant.md 4.
module kj_consistent_compliant_pattern
   use kj_sort, only: sort_unique
   use kj_consistent_compliant_types, only: pattern_t
   implicit none
   private

   public :: new_pattern, place

   !> Neighbours of a node, and more room
   type :: list_t
      integer :: n = 0
      integer, allocatable :: at(:)
   end type list_t

   !> Nodes by their degree: lists that are linked both ways, first in, first out: the two ends of a
   !> chain come by turns, and need not wait for each other
   type :: queue_t
      integer, allocatable :: head(:), tail(:), next(:), previous(:), degree(:)
      integer :: least = 0
   end type queue_t

contains

   !> Pattern of n nodes of which pairs are coupled
   pure subroutine new_pattern(n, pair, pattern)
      integer, intent(in) :: n
      integer, intent(in) :: pair(:, :)          !! (2, pairs) may be there twice
      type(pattern_t), intent(out) :: pattern

      type(list_t), allocatable :: near(:), below(:)
      integer, allocatable :: order(:)
      integer :: j

      pattern%n = n
      allocate (near(n), below(n), order(n), pattern%column(n))
      do j = 1, size(pair, 2)
         associate (a => pair(1, j), b => pair(2, j))
            if (coupled(near, a, b)) cycle
            call add(b, near(a))
            call add(a, near(b))
         end associate
      end do
      call eliminate(near, order, below)
      pattern%column(order) = [(j, j=1, n)]
      call list_blocks(order, below, pattern)
      call list_updates(pattern)
   end subroutine new_pattern

   !> The block of node a, rows, and node b, columns; < 0: there is its transpose
   pure integer function place(pattern, a, b)
      type(pattern_t), intent(in) :: pattern
      integer, intent(in) :: a, b

      associate (i => pattern%column(a), j => pattern%column(b))
         place = sign(find_block(pattern, max(i, j), min(i, j)), i - j)
      end associate
   end function place

   !> One of the shorter list
   pure logical function coupled(near, a, b)
      type(list_t), intent(in) :: near(:)
      integer, intent(in) :: a, b

      if (near(a)%n <= near(b)%n) then
         coupled = holds(near(a), b)
      else
         coupled = holds(near(b), a)
      end if
   end function coupled

   !> Order by least degree, and the neighbours that each has when its turn comes
   pure subroutine eliminate(near, order, below)
      type(list_t), intent(inout) :: near(:)
      integer, intent(out) :: order(:)
      type(list_t), intent(inout) :: below(:)

      type(queue_t) :: queue
      logical :: gone(size(near))
      integer :: i, j, k, now

      gone = .false.
      allocate (queue%head(0:size(near)), queue%tail(0:size(near)), source=0)
      allocate (queue%next(size(near)), queue%previous(size(near)), queue%degree(size(near)), &
         source=0)
      do i = 1, size(near)
         call put(i, near(i)%n, queue)
      end do
      do i = 1, size(near)
         call take(queue, now)
         order(i) = now
         gone(now) = .true.
         do j = 1, near(now)%n
            if (.not. gone(near(now)%at(j))) call add(near(now)%at(j), below(now))
         end do
         do j = 1, below(now)%n
            associate (a => below(now)%at(j))
               call move(a, queue%degree(a) - 1, queue)
               do k = 1, j - 1
                  associate (b => below(now)%at(k))
                     if (coupled(near, a, b)) cycle
                     call add(b, near(a))
                     call add(a, near(b))
                     call move(a, queue%degree(a) + 1, queue)
                     call move(b, queue%degree(b) + 1, queue)
                  end associate
               end do
            end associate
         end do
         if (allocated(near(now)%at)) deallocate (near(now)%at)
         near(now)%n = 0
      end do
   end subroutine eliminate

   pure logical function holds(list, value)
      type(list_t), intent(in) :: list
      integer, intent(in) :: value

      holds = .false.
      if (list%n > 0) holds = any(list%at(:list%n) == value)
   end function holds

   pure subroutine add(value, list)
      integer, intent(in) :: value
      type(list_t), intent(inout) :: list

      integer, allocatable :: more(:)

      if (.not. allocated(list%at)) allocate (list%at(4))
      if (list%n == size(list%at)) then
         allocate (more(2*list%n))
         more(:list%n) = list%at
         call move_alloc(more, list%at)
      end if
      list%n = list%n + 1
      list%at(list%n) = value
   end subroutine add

   !> To the end of the list of its degree
   pure subroutine put(i, degree, queue)
      integer, intent(in) :: i, degree
      type(queue_t), intent(inout) :: queue

      queue%degree(i) = degree
      queue%next(i) = 0
      queue%previous(i) = queue%tail(degree)
      if (queue%previous(i) > 0) then
         queue%next(queue%previous(i)) = i
      else
         queue%head(degree) = i
      end if
      queue%tail(degree) = i
      queue%least = min(queue%least, degree)
   end subroutine put

   pure subroutine leave(i, queue)
      integer, intent(in) :: i
      type(queue_t), intent(inout) :: queue

      associate (before => queue%previous(i), after => queue%next(i), degree => queue%degree(i))
         if (before > 0) then
            queue%next(before) = after
         else
            queue%head(degree) = after
         end if
         if (after > 0) then
            queue%previous(after) = before
         else
            queue%tail(degree) = before
         end if
      end associate
   end subroutine leave

   pure subroutine move(i, degree, queue)
      integer, intent(in) :: i, degree
      type(queue_t), intent(inout) :: queue

      call leave(i, queue)
      call put(i, degree, queue)
   end subroutine move

   !> The next to be eliminated
   pure subroutine take(queue, i)
      type(queue_t), intent(inout) :: queue
      integer, intent(out) :: i

      do while (queue%head(queue%least) == 0)
         queue%least = queue%least + 1
      end do
      i = queue%head(queue%least)
      call leave(i, queue)
   end subroutine take

   !> Rows of each column, ascending
   pure subroutine list_blocks(order, below, pattern)
      integer, intent(in) :: order(:)
      type(list_t), intent(in) :: below(:)
      type(pattern_t), intent(inout) :: pattern

      integer :: i

      allocate (pattern%first(pattern%n + 1))
      pattern%first(1) = 1
      do i = 1, pattern%n
         pattern%first(i + 1) = pattern%first(i) + below(order(i))%n
      end do
      allocate (pattern%row(pattern%first(pattern%n + 1) - 1))
      do i = 1, pattern%n
         if (below(order(i))%n == 0) cycle
         pattern%row(pattern%first(i):pattern%first(i + 1) - 1) = &
            sort_unique(pattern%column(below(order(i))%at(:below(order(i))%n)))
      end do
   end subroutine list_blocks

   !> Where the product of two blocks of a column goes: pairs in the order of the lower triangle,
   !> without its diagonal
   pure subroutine list_updates(pattern)
      type(pattern_t), intent(inout) :: pattern

      integer :: i, a, b, n

      associate (number => pattern%first(2:) - pattern%first(:pattern%n))
         allocate (pattern%update(sum(number*(number - 1)/2)))
      end associate
      n = 1
      do i = 1, pattern%n
         do a = pattern%first(i), pattern%first(i + 1) - 1
            do b = pattern%first(i), a - 1
               pattern%update(n) = find_block(pattern, pattern%row(a), pattern%row(b))
               n = n + 1
            end do
         end do
      end do
   end subroutine list_updates

   !> The block of a row in a column, by bisection
   pure integer function find_block(pattern, row, column) result(at)
      type(pattern_t), intent(in) :: pattern
      integer, intent(in) :: row, column

      integer :: low, high

      low = pattern%first(column)
      high = pattern%first(column + 1) - 1
      do while (low < high)
         at = (low + high)/2
         if (pattern%row(at) < row) then
            low = at + 1
         else
            high = at
         end if
      end do
      at = low
   end function find_block

end module kj_consistent_compliant_pattern
