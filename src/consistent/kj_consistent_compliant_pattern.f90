!> Order of elimination and pattern of the Cholesky factor of the bodies: minimum degree, once at
!> the start. A tree of bodies, whatever its degrees, has no fill.
!> Source: docs/theory/compliant.md 4.
module kj_consistent_compliant_pattern
   use kj_sort, only: sort_unique
   use kj_consistent_compliant_types, only: pattern_t
   implicit none
   private

   public :: new_pattern

   !> Neighbours of a body, and more room
   type :: list_t
      integer :: n = 0
      integer, allocatable :: at(:)
   end type list_t

   !> Bodies by their degree: rings of a list that is linked both ways
   type :: queue_t
      integer, allocatable :: head(:), next(:), previous(:), degree(:)
      integer :: least = 0
   end type queue_t

contains

   !> Pattern of the bodies that joints couple
   pure subroutine new_pattern(ends, moves, pattern)
      integer, intent(in) :: ends(:, :)          !! (2, n_element) leads of joints; 0 = no rows
      logical, intent(in) :: moves(:)            !! (n_lead)
      type(pattern_t), intent(out) :: pattern

      type(list_t), allocatable :: near(:), below(:)
      integer, allocatable :: order(:), place_of(:), node(:)
      integer :: i, j, k, n

      allocate (pattern%column(size(moves)), source=0)
      n = 0
      do j = 1, size(ends, 2)
         do k = 1, 2
            if (ends(k, j) == 0) cycle
            if (.not. moves(ends(k, j)) .or. pattern%column(ends(k, j)) > 0) cycle
            n = n + 1
            pattern%column(ends(k, j)) = n
         end do
      end do
      pattern%n = n
      allocate (near(n), below(n), order(n), place_of(n), node(n))
      do j = 1, size(ends, 2)
         if (any(ends(:, j) == 0)) cycle
         associate (a => pattern%column(ends(1, j)), b => pattern%column(ends(2, j)))
            if (a == 0 .or. b == 0 .or. a == b) cycle
            if (holds(near(a), b)) cycle
            call add(b, near(a))
            call add(a, near(b))
         end associate
      end do
      call eliminate(near, order, below)
      do i = 1, n
         place_of(order(i)) = i
      end do
      do i = 1, size(moves)
         if (pattern%column(i) == 0) cycle
         pattern%column(i) = place_of(pattern%column(i))
      end do
      allocate (pattern%lead(n))
      do i = 1, size(moves)
         if (pattern%column(i) > 0) pattern%lead(pattern%column(i)) = i
      end do
      call list_blocks(order, place_of, below, pattern)
      call list_updates(pattern)
      allocate (pattern%place(size(ends, 2)), source=0)
      do j = 1, size(ends, 2)
         if (any(ends(:, j) == 0)) cycle
         associate (a => pattern%column(ends(1, j)), b => pattern%column(ends(2, j)))
            if (a > 0 .and. b > 0 .and. a /= b) pattern%place(j) = &
               find_block(pattern, max(a, b), min(a, b))
         end associate
      end do
   end subroutine new_pattern

   !> Order by least degree, and the neighbours that each has when its turn comes
   pure subroutine eliminate(near, order, below)
      type(list_t), intent(inout) :: near(:)
      integer, intent(out) :: order(:)
      type(list_t), intent(inout) :: below(:)

      type(queue_t) :: queue
      logical :: gone(size(near))
      integer :: i, j, k, now

      gone = .false.
      allocate (queue%head(0:size(near)), source=0)
      allocate (queue%next(size(near)), queue%previous(size(near)), queue%degree(size(near)), &
         source=0)
      do i = size(near), 1, -1
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
                     if (near(a)%n <= near(b)%n) then
                        if (holds(near(a), b)) cycle
                     else if (holds(near(b), a)) then
                        cycle
                     end if
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

   !> Into the ring of its degree
   pure subroutine put(i, degree, queue)
      integer, intent(in) :: i, degree
      type(queue_t), intent(inout) :: queue

      queue%degree(i) = degree
      queue%previous(i) = 0
      queue%next(i) = queue%head(degree)
      if (queue%next(i) > 0) queue%previous(queue%next(i)) = i
      queue%head(degree) = i
      queue%least = min(queue%least, degree)
   end subroutine put

   pure subroutine leave(i, queue)
      integer, intent(in) :: i
      type(queue_t), intent(inout) :: queue

      if (queue%previous(i) > 0) then
         queue%next(queue%previous(i)) = queue%next(i)
      else
         queue%head(queue%degree(i)) = queue%next(i)
      end if
      if (queue%next(i) > 0) queue%previous(queue%next(i)) = queue%previous(i)
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
   pure subroutine list_blocks(order, place_of, below, pattern)
      integer, intent(in) :: order(:), place_of(:)
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
            sort_unique(place_of(below(order(i))%at(:below(order(i))%n)))
      end do
   end subroutine list_blocks

   !> Where the product of two blocks of a column goes: pairs in the order of the lower triangle,
   !> without its diagonal
   pure subroutine list_updates(pattern)
      type(pattern_t), intent(inout) :: pattern

      integer :: i, a, b, n

      allocate (pattern%first_update(pattern%n + 1))
      pattern%first_update(1) = 1
      do i = 1, pattern%n
         n = pattern%first(i + 1) - pattern%first(i)
         pattern%first_update(i + 1) = pattern%first_update(i) + n*(n - 1)/2
      end do
      allocate (pattern%update(pattern%first_update(pattern%n + 1) - 1))
      do i = 1, pattern%n
         n = pattern%first_update(i)
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
