!> Objects that stand in several groups of a T01. The file does not tell in whose axes the values of
!> a node are, so a node is two entities where two groups have other values of one variable.
module kj_t01_repeats
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_sort, only: sorted_order
   use kj_t01_file, only: t01_file_t
   use kj_t01_content, only: t01_group_t, t01_rows_t, read_t01_block
   implicit none
   private

   public :: number_objects

   !> Two objects of one id in two groups, and where the variables that both have stand in a row
   type :: pair_t
      integer :: object(2) = 0
      integer, allocatable :: place(:, :)       !! (2, variables)
      logical :: differ = .false.               !! some value is another one
   end type pair_t

contains

   !> The entity of every object of the groups of one type, and the id of every entity, ascending.
   !>
   !> Objects of one id are one entity; where `apart`, as long as no value contradicts.
   !> Errors: ERR_FILE when a row is damaged.
   subroutine number_objects(file, rows, groups, before, type, apart, entity, id, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      type(t01_group_t), intent(in) :: groups(:)
      integer, intent(in) :: before(:)          !! values of a row before those of a group
      integer, intent(in) :: type               !! of the groups
      logical, intent(in) :: apart
      integer, allocatable, intent(out) :: entity(:)   !! of the objects, group by group
      integer, allocatable, intent(out) :: id(:)
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ids(:), group(:), place(:), order(:)
      type(pair_t), allocatable :: pair(:)
      integer :: i, j

      allocate (ids(0), group(0), place(0), pair(0))
      do i = 1, size(groups)
         if (groups(i)%type /= type) cycle
         ids = [ids, groups(i)%object]
         group = [group, spread(i, 1, size(groups(i)%object))]
         place = [place, [(j, j=1, size(groups(i)%object))]]
      end do
      order = sorted_order(ids)
      if (apart) call find_pairs(groups, before, ids, group, place, order, pair)
      if (size(pair) > 0) call compare_pairs(file, rows, pair, error)
      if (allocated(error)) return
      call join(ids, order, pair, entity, id)
   end subroutine number_objects

   !> All pairs of objects of one id that have a variable in common
   subroutine find_pairs(groups, before, ids, group, place, order, pair)
      type(t01_group_t), intent(in) :: groups(:)
      integer, intent(in) :: before(:), ids(:)
      integer, intent(in) :: group(:), place(:) !! group of each object, and its place there
      integer, intent(in) :: order(:)           !! ids(order) ascends
      type(pair_t), allocatable, intent(inout) :: pair(:)

      type(pair_t) :: new
      integer :: i, k, a, b

      do i = 2, size(order)
         do k = i - 1, 1, -1
            a = order(k)
            b = order(i)
            if (ids(a) /= ids(b)) exit
            new%object = [a, b]
            call find_common(groups(group(a)), before(group(a)), place(a), groups(group(b)), &
               before(group(b)), place(b), new%place)
            if (size(new%place, 2) > 0) pair = [pair, new]
         end do
      end do
   end subroutine find_pairs

   !> Places in a row of the variables that object i of group a and object j of group b both have
   pure subroutine find_common(a, before_a, i, b, before_b, j, place)
      type(t01_group_t), intent(in) :: a, b
      integer, intent(in) :: before_a, before_b, i, j
      integer, allocatable, intent(out) :: place(:, :)

      integer :: k, other, n, found(2, size(a%code))

      n = 0
      do k = 1, size(a%code)
         other = findloc(b%code, a%code(k), 1)
         if (other == 0) cycle
         n = n + 1
         found(:, n) = [before_a + (i - 1)*size(a%code) + k, &
            before_b + (j - 1)*size(b%code) + other]
      end do
      place = found(:, :n)
   end subroutine find_common

   !> Compare the values of all pairs in one pass over the rows
   subroutine compare_pairs(file, rows, pair, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      type(pair_t), intent(inout) :: pair(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: values(:, :)
      integer :: done, n, i, p

      done = 0
      do while (done < rows%n_row)
         call read_t01_block(file, rows, done + 1, rows%n_row - done, values, n, error)
         if (allocated(error)) return
         do p = 1, size(pair)
            do i = 1, n
               if (pair(p)%differ) exit
               pair(p)%differ = any(.not. same(values(pair(p)%place(1, :), i), &
                  values(pair(p)%place(2, :), i)))
            end do
         end do
         done = done + n
      end do
   end subroutine compare_pairs

   !> Equal numbers, or none on both sides
   elemental logical function same(a, b)
      real(wp), intent(in) :: a, b

      same = .not. abs(a - b) > 0.0_wp
   end function same

   !> Objects of one id, in the order of the file, join the first entity that none contradicts
   subroutine join(ids, order, pair, entity, id)
      integer, intent(in) :: ids(:), order(:)
      type(pair_t), intent(in) :: pair(:)
      integer, allocatable, intent(out) :: entity(:), id(:)

      integer :: i, k, e, first, n
      logical :: fits

      allocate (entity(size(ids)), id(size(ids)))
      n = 0
      first = 1
      do i = 1, size(order)
         associate (object => order(i))
            if (ids(object) /= ids(order(max(1, i - 1)))) first = n + 1
            do e = first, n + 1
               fits = .true.
               do k = 1, size(pair)
                  if (.not. pair(k)%differ .or. pair(k)%object(2) /= object) cycle
                  fits = fits .and. entity(pair(k)%object(1)) /= e
               end do
               if (fits) exit
            end do
            n = max(n, e)
            entity(object) = e
            id(e) = ids(object)
         end associate
      end do
      id = id(:n)
   end subroutine join

end module kj_t01_repeats
