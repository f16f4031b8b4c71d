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
            call subtract_square(factor%below(:, :, a), factor%diagonal(:, :, pattern%row(a)))
         end do
      end do
   end subroutine factorise

   !> Lower triangle := its Cholesky factor, with the inverse on the diagonal
   pure subroutine root(a, good)
      real(wp), intent(inout) :: a(6, 6)
      logical, intent(inout) :: good             !! becomes false where there is none

      call pivot(a(1, 1), good)
      a(2, 1) = a(2, 1)*a(1, 1)
      a(3, 1) = a(3, 1)*a(1, 1)
      a(4, 1) = a(4, 1)*a(1, 1)
      a(5, 1) = a(5, 1)*a(1, 1)
      a(6, 1) = a(6, 1)*a(1, 1)
      a(2, 2) = a(2, 2) - a(2, 1)*a(2, 1)
      call pivot(a(2, 2), good)
      a(3, 2) = (a(3, 2) - a(3, 1)*a(2, 1))*a(2, 2)
      a(4, 2) = (a(4, 2) - a(4, 1)*a(2, 1))*a(2, 2)
      a(5, 2) = (a(5, 2) - a(5, 1)*a(2, 1))*a(2, 2)
      a(6, 2) = (a(6, 2) - a(6, 1)*a(2, 1))*a(2, 2)
      a(3, 3) = a(3, 3) - a(3, 1)*a(3, 1) - a(3, 2)*a(3, 2)
      call pivot(a(3, 3), good)
      a(4, 3) = (a(4, 3) - a(4, 1)*a(3, 1) - a(4, 2)*a(3, 2))*a(3, 3)
      a(5, 3) = (a(5, 3) - a(5, 1)*a(3, 1) - a(5, 2)*a(3, 2))*a(3, 3)
      a(6, 3) = (a(6, 3) - a(6, 1)*a(3, 1) - a(6, 2)*a(3, 2))*a(3, 3)
      a(4, 4) = a(4, 4) - a(4, 1)*a(4, 1) - a(4, 2)*a(4, 2) - a(4, 3)*a(4, 3)
      call pivot(a(4, 4), good)
      a(5, 4) = (a(5, 4) - a(5, 1)*a(4, 1) - a(5, 2)*a(4, 2) - a(5, 3)*a(4, 3))*a(4, 4)
      a(6, 4) = (a(6, 4) - a(6, 1)*a(4, 1) - a(6, 2)*a(4, 2) - a(6, 3)*a(4, 3))*a(4, 4)
      a(5, 5) = a(5, 5) - a(5, 1)*a(5, 1) - a(5, 2)*a(5, 2) - a(5, 3)*a(5, 3) - a(5, 4)*a(5, 4)
      call pivot(a(5, 5), good)
      a(6, 5) = (a(6, 5) - a(6, 1)*a(5, 1) - a(6, 2)*a(5, 2) - a(6, 3)*a(5, 3) - &
         a(6, 4)*a(5, 4))*a(5, 5)
      a(6, 6) = a(6, 6) - a(6, 1)*a(6, 1) - a(6, 2)*a(6, 2) - a(6, 3)*a(6, 3) - &
         a(6, 4)*a(6, 4) - a(6, 5)*a(6, 5)
      call pivot(a(6, 6), good)

   contains

      pure subroutine pivot(a, good)
         real(wp), intent(inout) :: a
         logical, intent(inout) :: good

         good = good .and. a > 0.0_wp .and. a <= huge(1.0_wp)
         if (good) a = 1.0_wp/sqrt(a)
      end subroutine pivot
   end subroutine root

   !> b := b l^-T, row by row
   pure subroutine divide(l, b)
      real(wp), intent(in) :: l(6, 6)
      real(wp), intent(inout) :: b(6, 6)

      real(wp) :: x1, x2, x3, x4, x5, x6
      integer :: i

      !$omp simd private(x1, x2, x3, x4, x5, x6)
      do i = 1, 6
         x1 = b(i, 1)*l(1, 1)
         x2 = (b(i, 2) - x1*l(2, 1))*l(2, 2)
         x3 = (b(i, 3) - x1*l(3, 1) - x2*l(3, 2))*l(3, 3)
         x4 = (b(i, 4) - x1*l(4, 1) - x2*l(4, 2) - x3*l(4, 3))*l(4, 4)
         x5 = (b(i, 5) - x1*l(5, 1) - x2*l(5, 2) - x3*l(5, 3) - x4*l(5, 4))*l(5, 5)
         x6 = (b(i, 6) - x1*l(6, 1) - x2*l(6, 2) - x3*l(6, 3) - x4*l(6, 4) - x5*l(6, 5))*l(6, 6)
         b(i, 1) = x1
         b(i, 2) = x2
         b(i, 3) = x3
         b(i, 4) = x4
         b(i, 5) = x5
         b(i, 6) = x6
      end do
   end subroutine divide

   !> c := c - a b^T
   pure subroutine subtract(a, b, c)
      real(wp), intent(in) :: a(6, 6), b(6, 6)
      real(wp), intent(inout) :: c(6, 6)

      integer :: i, j

      do j = 1, 6
         !$omp simd
         do i = 1, 6
            c(i, j) = c(i, j) - (a(i, 1)*b(j, 1) + a(i, 2)*b(j, 2) + a(i, 3)*b(j, 3) + &
               a(i, 4)*b(j, 4) + a(i, 5)*b(j, 5) + a(i, 6)*b(j, 6))
         end do
      end do
   end subroutine subtract

   !> c := c - a a^T, of which nothing reads the upper triangle: pairs of columns from their row on
   pure subroutine subtract_square(a, c)
      real(wp), intent(in) :: a(6, 6)
      real(wp), intent(inout) :: c(6, 6)

      integer :: i, j

      do j = 1, 2
         !$omp simd
         do i = 1, 6
            c(i, j) = c(i, j) - (a(i, 1)*a(j, 1) + a(i, 2)*a(j, 2) + a(i, 3)*a(j, 3) + &
               a(i, 4)*a(j, 4) + a(i, 5)*a(j, 5) + a(i, 6)*a(j, 6))
         end do
      end do
      do j = 3, 4
         !$omp simd
         do i = 3, 6
            c(i, j) = c(i, j) - (a(i, 1)*a(j, 1) + a(i, 2)*a(j, 2) + a(i, 3)*a(j, 3) + &
               a(i, 4)*a(j, 4) + a(i, 5)*a(j, 5) + a(i, 6)*a(j, 6))
         end do
      end do
      do j = 5, 6
         do i = 5, 6
            c(i, j) = c(i, j) - (a(i, 1)*a(j, 1) + a(i, 2)*a(j, 2) + a(i, 3)*a(j, 3) + &
               a(i, 4)*a(j, 4) + a(i, 5)*a(j, 5) + a(i, 6)*a(j, 6))
         end do
      end do
   end subroutine subtract_square

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

      x(1) = x(1)*l(1, 1)
      x(2) = (x(2) - l(2, 1)*x(1))*l(2, 2)
      x(3) = (x(3) - l(3, 1)*x(1) - l(3, 2)*x(2))*l(3, 3)
      x(4) = (x(4) - l(4, 1)*x(1) - l(4, 2)*x(2) - l(4, 3)*x(3))*l(4, 4)
      x(5) = (x(5) - l(5, 1)*x(1) - l(5, 2)*x(2) - l(5, 3)*x(3) - l(5, 4)*x(4))*l(5, 5)
      x(6) = (x(6) - l(6, 1)*x(1) - l(6, 2)*x(2) - l(6, 3)*x(3) - l(6, 4)*x(4) - &
         l(6, 5)*x(5))*l(6, 6)
   end subroutine forward

   !> x := l^-T x
   pure subroutine backward(l, x)
      real(wp), intent(in) :: l(6, 6)
      real(wp), intent(inout) :: x(6)

      x(6) = x(6)*l(6, 6)
      x(5) = (x(5) - l(6, 5)*x(6))*l(5, 5)
      x(4) = (x(4) - l(6, 4)*x(6) - l(5, 4)*x(5))*l(4, 4)
      x(3) = (x(3) - l(6, 3)*x(6) - l(5, 3)*x(5) - l(4, 3)*x(4))*l(3, 3)
      x(2) = (x(2) - l(6, 2)*x(6) - l(5, 2)*x(5) - l(4, 2)*x(4) - l(3, 2)*x(3))*l(2, 2)
      x(1) = (x(1) - l(6, 1)*x(6) - l(5, 1)*x(5) - l(4, 1)*x(4) - l(3, 1)*x(3) - &
         l(2, 1)*x(2))*l(1, 1)
   end subroutine backward

   !> y := y - b x
   pure subroutine take(b, x, y)
      real(wp), intent(in) :: b(6, 6), x(6)
      real(wp), intent(inout) :: y(6)

      integer :: i

      !$omp simd
      do i = 1, 6
         y(i) = y(i) - (b(i, 1)*x(1) + b(i, 2)*x(2) + b(i, 3)*x(3) + b(i, 4)*x(4) + &
            b(i, 5)*x(5) + b(i, 6)*x(6))
      end do
   end subroutine take

   !> y := y - b^T x
   pure subroutine take_turned(b, x, y)
      real(wp), intent(in) :: b(6, 6), x(6)
      real(wp), intent(inout) :: y(6)

      integer :: j

      do j = 1, 6
         y(j) = y(j) - (b(1, j)*x(1) + b(2, j)*x(2) + b(3, j)*x(3) + b(4, j)*x(4) + &
            b(5, j)*x(5) + b(6, j)*x(6))
      end do
   end subroutine take_turned

end module kj_consistent_compliant_factor
