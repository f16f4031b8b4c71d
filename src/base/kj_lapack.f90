!> The LAPACK routines that kjoint uses, behind error values.
module kj_lapack
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INTERNAL
   implicit none
   private

   public :: principal_axes, largest_eigenvalue

   interface
      subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
         import :: wp
         character(len=1), intent(in) :: jobz, uplo
         integer, intent(in) :: n, lda, lwork
         real(wp), intent(inout) :: a(lda, *)
         real(wp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsyev
   end interface

contains

   !> Principal values, descending, and right-handed axes (columns) of a symmetric 3x3 matrix.
   !>
   !> Errors: ERR_INTERNAL when LAPACK does not converge.
   subroutine principal_axes(j, values, axes, error)
      real(wp), intent(in) :: j(3, 3)
      real(wp), intent(out) :: values(3), axes(3, 3)
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: work(32), w(3), a(3, 3)
      integer :: info

      a = j
      call dsyev('V', 'U', 3, a, 3, w, work, size(work), info)
      if (info /= 0) then
         call fail(error, ERR_INTERNAL, 'dsyev returned '//str(info))
         return
      end if
      values = w(3:1:-1)
      axes(:, 1) = a(:, 3)
      axes(:, 2) = a(:, 2)
      axes(:, 3) = [axes(2, 1)*axes(3, 2) - axes(3, 1)*axes(2, 2), &
         axes(3, 1)*axes(1, 2) - axes(1, 1)*axes(3, 2), &
         axes(1, 1)*axes(2, 2) - axes(2, 1)*axes(1, 2)]
   end subroutine principal_axes

   !> Largest eigenvalue of a symmetric matrix; a is destroyed. huge when it is no finite number.
   subroutine largest_eigenvalue(n, a, value)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(n, n)
      real(wp), intent(out) :: value

      real(wp) :: w(n), work(34*n)
      integer :: info

      value = huge(1.0_wp)
      if (.not. all(abs(a) <= huge(1.0_wp))) return
      call dsyev('N', 'U', n, a, n, w, work, size(work), info)
      if (info == 0 .and. abs(w(n)) <= huge(1.0_wp)) value = w(n)
   end subroutine largest_eigenvalue

end module kj_lapack
