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

      integer :: i, a

      do i = 1, pattern%n
         call forward(factor%diagonal(:, :, i), factor%x(:, i))
         do a = pattern%first(i), pattern%first(i + 1) - 1
            call take(factor%below(:, :, a), factor%x(:, i), factor%x(:, pattern%row(a)))
         end do
      end do
      do i = pattern%n, 1, -1
         do a = pattern%first(i), pattern%first(i + 1) - 1
            call take_turned(factor%below(:, :, a), factor%x(:, pattern%row(a)), factor%x(:, i))
         end do
         call backward(factor%diagonal(:, :, i), factor%x(:, i))
      end do
   end subroutine solve_bodies

   !> x := l^-1 x
   pure subroutine forward(l, x)
      real(wp), intent(in) :: l(6, 6)
      real(wp), intent(inout) :: x(6)

      integer :: j, k

      do j = 1, 6
         x(j) = x(j)*l(j, j)
         do k = j + 1, 6
            x(k) = x(k) - l(k, j)*x(j)
         end do
      end do
   end subroutine forward

   !> x := l^-T x
   pure subroutine backward(l, x)
      real(wp), intent(in) :: l(6, 6)
      real(wp), intent(inout) :: x(6)

      integer :: j, k

      do j = 6, 1, -1
         do k = j + 1, 6
            x(j) = x(j) - l(k, j)*x(k)
         end do
         x(j) = x(j)*l(j, j)
      end do
   end subroutine backward

   !> y := y - b x
   pure subroutine take(b, x, y)
      real(wp), intent(in) :: b(6, 6), x(6)
      real(wp), intent(inout) :: y(6)

      integer :: j, k

      do j = 1, 6
         do k = 1, 6
            y(k) = y(k) - b(k, j)*x(j)
         end do
      end do
   end subroutine take

   !> y := y - b^T x
   pure subroutine take_turned(b, x, y)
      real(wp), intent(in) :: b(6, 6), x(6)
      real(wp), intent(inout) :: y(6)

      real(wp) :: s
      integer :: j, k

      do j = 1, 6
         s = 0.0_wp
         do k = 1, 6
            s = s + b(k, j)*x(k)
         end do
         y(j) = y(j) - s
      end do
   end subroutine take_turned

end module kj_consistent_compliant_factor
