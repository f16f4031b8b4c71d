!> Factor L D L^T, in blocks, of the matrix of the joints, and solutions with it. Pattern
!> and order are fixed: the same bits always. Blocks are 3 x 3: calls of LAPACK would cost more.
!> Source: docs/theory/compliant.md 4.
module kj_consistent_compliant_factor
   use kj_kinds, only: wp
   use kj_consistent_compliant_types, only: pattern_t, factor_t
   implicit none
   private

   public :: new_factor, factorise, solve

contains

   !> Room for the matrix
   subroutine new_factor(pattern, factor)
      type(pattern_t), intent(in) :: pattern
      type(factor_t), intent(out) :: factor

      allocate (factor%diagonal(4, 3, pattern%n), factor%below(4, 3, size(pattern%row)), &
         factor%x(4, pattern%n), source=0.0_wp)
      allocate (factor%sign(pattern%n), source=1.0_wp)
   end subroutine new_factor

   !> The matrix becomes its factor; good: all pivots have the sign of their node. Of diagonal
   !> blocks l d l^T there are l, without its ones, and 1/d on the diagonal; below them is l d.
   pure subroutine factorise(pattern, factor, good)
      type(pattern_t), intent(in) :: pattern
      type(factor_t), intent(inout) :: factor
      logical, intent(out) :: good

      call factor_columns(pattern%n, pattern%first, pattern%row, pattern%update, factor%sign, &
         factor%diagonal, factor%below, good)
   end subroutine factorise

   pure subroutine factor_columns(n, first, row, update, sign, diagonal, below, good)
      integer, intent(in) :: n, first(n + 1), row(*), update(*)
      real(wp), intent(in) :: sign(n)
      real(wp), intent(inout) :: diagonal(4, 3, n), below(4, 3, *)
      logical, intent(out) :: good

      real(wp) :: l(4, 3)
      integer :: i, a, b, next

      next = 1
      do i = 1, n
         call factor_block(sign(i), diagonal(:, :, i), good)
         if (.not. good) return
         do a = first(i), first(i + 1) - 1
            call divide(diagonal(:, :, i), below(:, :, a), l)
            do b = first(i), a - 1
               call subtract(l, below(:, :, b), below(:, :, update(next)))
               next = next + 1
            end do
            call subtract(l, below(:, :, a), diagonal(:, :, row(a)))
         end do
      end do
   end subroutine factor_columns

   pure subroutine factor_block(sign, a, good)
      real(wp), intent(in) :: sign               !! of the pivots
      real(wp), intent(inout) :: a(4, 3)         !! lower triangle
      logical, intent(out) :: good

      real(wp) :: d2, d3, part

      part = a(2, 1)
      good = is_pivot(a(1, 1))
      a(1, 1) = 1.0_wp/a(1, 1)
      a(2, 1) = part*a(1, 1)
      d2 = a(2, 2) - a(2, 1)*part
      part = a(3, 2) - a(3, 1)*a(2, 1)
      good = good .and. is_pivot(d2)
      a(2, 2) = 1.0_wp/d2
      a(3, 2) = part*a(2, 2)
      d3 = a(3, 3) - a(3, 1)*(a(3, 1)*a(1, 1)) - a(3, 2)*part
      a(3, 1) = a(3, 1)*a(1, 1)
      good = good .and. is_pivot(d3)
      a(3, 3) = 1.0_wp/d3

   contains

      pure logical function is_pivot(d)
         real(wp), intent(in) :: d

         is_pivot = sign*d > 0.0_wp .and. abs(d) <= huge(d)
      end function is_pivot
   end subroutine factor_block

   !> b := b l^-T, row by row, and over the pivots
   pure subroutine divide(diagonal, b, l)
      real(wp), intent(in) :: diagonal(4, 3)
      real(wp), intent(inout) :: b(4, 3)
      real(wp), intent(out) :: l(4, 3)

      integer :: i

      !$omp simd
      do i = 1, 4
         b(i, 2) = b(i, 2) - b(i, 1)*diagonal(2, 1)
         b(i, 3) = b(i, 3) - b(i, 1)*diagonal(3, 1) - b(i, 2)*diagonal(3, 2)
         l(i, 1) = b(i, 1)*diagonal(1, 1)
         l(i, 2) = b(i, 2)*diagonal(2, 2)
         l(i, 3) = b(i, 3)*diagonal(3, 3)
      end do
   end subroutine divide

   !> c := c - a b^T
   pure subroutine subtract(a, b, c)
      real(wp), intent(in) :: a(4, 3), b(4, 3)
      real(wp), intent(inout) :: c(4, 3)

      integer :: i, j

      do j = 1, 3
         !$omp simd
         do i = 1, 4
            c(i, j) = c(i, j) - (a(i, 1)*b(j, 1) + a(i, 2)*b(j, 2) + a(i, 3)*b(j, 3))
         end do
      end do
   end subroutine subtract

   !> factor%x := its solution
   pure subroutine solve(pattern, factor)
      type(pattern_t), intent(in) :: pattern
      type(factor_t), intent(inout) :: factor

      call solve_columns(pattern%n, pattern%first, pattern%row, factor%diagonal, factor%below, &
         factor%x)
   end subroutine solve

   pure subroutine solve_columns(n, first, row, diagonal, below, x)
      integer, intent(in) :: n, first(n + 1), row(*)
      real(wp), intent(in) :: diagonal(4, 3, n), below(4, 3, *)
      real(wp), intent(inout) :: x(4, n)

      real(wp) :: y(4, 3), x1, x2, x3
      integer :: i, a

      do i = 1, n
         x1 = x(1, i)
         x2 = x(2, i) - diagonal(2, 1, i)*x1
         x3 = x(3, i) - diagonal(3, 1, i)*x1 - diagonal(3, 2, i)*x2
         x1 = x1*diagonal(1, 1, i)
         x2 = x2*diagonal(2, 2, i)
         x3 = x3*diagonal(3, 3, i)
         do a = first(i), first(i + 1) - 1
            call take(below(:, :, a), x1, x2, x3, x(:, row(a)))
         end do
         x(1:3, i) = [x1, x2, x3]
      end do
      do i = n, 1, -1
         y = 0.0_wp
         do a = first(i), first(i + 1) - 1
            call add_turned(below(:, :, a), x(:, row(a)), y)
         end do
         x3 = x(3, i) - (y(1, 3) + y(2, 3) + y(3, 3))*diagonal(3, 3, i)
         x2 = x(2, i) - (y(1, 2) + y(2, 2) + y(3, 2))*diagonal(2, 2, i) - diagonal(3, 2, i)*x3
         x(1, i) = x(1, i) - (y(1, 1) + y(2, 1) + y(3, 1))*diagonal(1, 1, i) - &
            diagonal(3, 1, i)*x3 - diagonal(2, 1, i)*x2
         x(2, i) = x2
         x(3, i) = x3
      end do
   end subroutine solve_columns

   !> y := y - b x
   pure subroutine take(b, x1, x2, x3, y)
      real(wp), intent(in) :: b(4, 3), x1, x2, x3
      real(wp), intent(inout) :: y(4)

      integer :: i

      !$omp simd
      do i = 1, 4
         y(i) = y(i) - (b(i, 1)*x1 + b(i, 2)*x2 + b(i, 3)*x3)
      end do
   end subroutine take

   !> Columns of y := y + b, each times x: their sums are b^T x
   pure subroutine add_turned(b, x, y)
      real(wp), intent(in) :: b(4, 3), x(4)
      real(wp), intent(inout) :: y(4, 3)

      integer :: i, j

      do j = 1, 3
         !$omp simd
         do i = 1, 4
            y(i, j) = y(i, j) + b(i, j)*x(i)
         end do
      end do
   end subroutine add_turned

end module kj_consistent_compliant_factor
