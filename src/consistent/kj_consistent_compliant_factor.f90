!> Block Cholesky factor L L^T of the matrix of the bodies, and solutions with it. Pattern and order
!> are fixed: the same bits always. Blocks are 6 x 6: one call of LAPACK each would cost more.
!> Source: docs/theory/compliant.md 4.
module kj_consistent_compliant_factor
   use kj_kinds, only: wp
   use kj_consistent_compliant_types, only: pattern_t, factor_t
   implicit none
   private

   public :: new_factor, factorise, solve_bodies

contains

   !> Room for the matrix
   subroutine new_factor(pattern, factor)
      type(pattern_t), intent(in) :: pattern
      type(factor_t), intent(out) :: factor

      allocate (factor%diagonal(6, 6, pattern%n), factor%below(6, 6, size(pattern%row)), &
         factor%x(6, pattern%n), source=0.0_wp)
   end subroutine new_factor

   !> The matrix becomes its factor; the diagonals of diagonal blocks become their inverses.
   !> good: all pivots are positive numbers
   pure subroutine factorise(pattern, factor, good)
      type(pattern_t), intent(in) :: pattern
      type(factor_t), intent(inout) :: factor
      logical, intent(out) :: good

      integer :: i, a, b, n

      good = .true.
      do i = 1, pattern%n
         call root(factor%diagonal(:, :, i), good)
         if (.not. good) return
         n = pattern%first_update(i)
         do a = pattern%first(i), pattern%first(i + 1) - 1
            call divide(factor%diagonal(:, :, i), factor%below(:, :, a))
            do b = pattern%first(i), a - 1
               call subtract(factor%below(:, :, a), factor%below(:, :, b), &
                  factor%below(:, :, pattern%update(n)))
               n = n + 1
            end do
            call subtract(factor%below(:, :, a), factor%below(:, :, a), &
               factor%diagonal(:, :, pattern%row(a)))
         end do
      end do
   end subroutine factorise

   !> Lower triangle := its Cholesky factor, with the inverse on the diagonal
   pure subroutine root(a, good)
      real(wp), intent(inout) :: a(6, 6)
      logical, intent(out) :: good

      integer :: i, j, k

      good = .false.
      do j = 1, 6
         if (.not. (a(j, j) > 0.0_wp .and. a(j, j) <= huge(1.0_wp))) return
         a(j, j) = 1.0_wp/sqrt(a(j, j))
         do i = j + 1, 6
            a(i, j) = a(i, j)*a(j, j)
         end do
         do k = j + 1, 6
            do i = k, 6
               a(i, k) = a(i, k) - a(i, j)*a(k, j)
            end do
         end do
      end do
      good = .true.
   end subroutine root

   !> b := b l^-T
   pure subroutine divide(l, b)
      real(wp), intent(in) :: l(6, 6)
      real(wp), intent(inout) :: b(6, 6)

      integer :: j, k

      do j = 1, 6
         do k = 1, j - 1
            b(:, j) = b(:, j) - b(:, k)*l(j, k)
         end do
         b(:, j) = b(:, j)*l(j, j)
      end do
   end subroutine divide

   !> c := c - a b^T
   pure subroutine subtract(a, b, c)
      real(wp), intent(in) :: a(6, 6), b(6, 6)
      real(wp), intent(inout) :: c(6, 6)

      integer :: j, k

      do j = 1, 6
         do k = 1, 6
            c(:, j) = c(:, j) - a(:, k)*b(j, k)
         end do
      end do
   end subroutine subtract

   !> factor%x := its solution
   pure subroutine solve_bodies(pattern, factor)
      type(pattern_t), intent(in) :: pattern
      type(factor_t), intent(inout) :: factor

      integer :: i, a, j, k

      associate (x => factor%x)
         do i = 1, pattern%n
            do j = 1, 6
               x(j, i) = x(j, i)*factor%diagonal(j, j, i)
               do k = j + 1, 6
                  x(k, i) = x(k, i) - factor%diagonal(k, j, i)*x(j, i)
               end do
            end do
            do a = pattern%first(i), pattern%first(i + 1) - 1
               do j = 1, 6
                  x(:, pattern%row(a)) = x(:, pattern%row(a)) - factor%below(:, j, a)*x(j, i)
               end do
            end do
         end do
         do i = pattern%n, 1, -1
            do a = pattern%first(i), pattern%first(i + 1) - 1
               do j = 1, 6
                  x(j, i) = x(j, i) - dot_product(factor%below(:, j, a), x(:, pattern%row(a)))
               end do
            end do
            do j = 6, 1, -1
               do k = j + 1, 6
                  x(j, i) = x(j, i) - factor%diagonal(k, j, i)*x(k, i)
               end do
               x(j, i) = x(j, i)*factor%diagonal(j, j, i)
            end do
         end do
      end associate
   end subroutine solve_bodies

end module kj_consistent_compliant_factor
