!> Arrays that are read soon, asked for ahead of time. Kernels go through a hundred columns block by
!> block, more than processors follow by themselves: without this a large scene waits for its
!> memory in every block.
module kj_prefetch
   use, intrinsic :: iso_c_binding, only: c_size_t, c_double, c_int
   implicit none
   private

   public :: prefetch

   !> The rows from..to of all columns, those that there are
   interface prefetch
      module procedure prefetch_real
      module procedure prefetch_column
      module procedure prefetch_integer
   end interface prefetch

   interface
      pure subroutine prefetch_reals(array, rows, columns, from, n) &
         bind(c, name='kj_prefetch_reals')
         import :: c_double, c_size_t
         real(c_double), intent(in) :: array(*)
         integer(c_size_t), intent(in), value :: rows, columns, from, n
      end subroutine prefetch_reals

      pure subroutine prefetch_integers(array, rows, columns, from, n) &
         bind(c, name='kj_prefetch_integers')
         import :: c_int, c_size_t
         integer(c_int), intent(in) :: array(*)
         integer(c_size_t), intent(in), value :: rows, columns, from, n
      end subroutine prefetch_integers
   end interface

contains

   pure subroutine prefetch_real(from, to, array)
      integer, intent(in) :: from, to
      real(c_double), contiguous, intent(in) :: array(:, :)

      integer :: last

      last = min(to, size(array, 1))
      if (last >= from) call prefetch_reals(array, int(size(array, 1), c_size_t), &
         int(size(array, 2), c_size_t), int(from, c_size_t), int(last - from + 1, c_size_t))
   end subroutine prefetch_real

   pure subroutine prefetch_column(from, to, array)
      integer, intent(in) :: from, to
      real(c_double), contiguous, intent(in) :: array(:)

      integer :: last

      last = min(to, size(array))
      if (last >= from) call prefetch_reals(array, int(size(array), c_size_t), 1_c_size_t, &
         int(from, c_size_t), int(last - from + 1, c_size_t))
   end subroutine prefetch_column

   pure subroutine prefetch_integer(from, to, array)
      integer, intent(in) :: from, to
      integer(c_int), contiguous, intent(in) :: array(:, :)

      integer :: last

      last = min(to, size(array, 1))
      if (last >= from) call prefetch_integers(array, int(size(array, 1), c_size_t), &
         int(size(array, 2), c_size_t), int(from, c_size_t), int(last - from + 1, c_size_t))
   end subroutine prefetch_integer

end module kj_prefetch
