!> Rows of the joints in the integrator `compliant`, for blocks of joints: how stiff a step sees
!> them, residuals, multipliers, and what they add to the matrix of the bodies.
!> Source: docs/theory/compliant.md 1, 2, 4.
module kj_consistent_compliant_rows
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_types, only: NDOF
   use kj_consistent_batch, only: matrix_t
   use kj_consistent_compliant_types, only: compliant_block_t, coefficients_t
   implicit none
   private

   public :: bound_stiffness, weigh_rows, extrapolate, residual, find_change, velocity_side, &
      velocity_force, coefficients

contains

   !> Stiffness of implicit rows, no more than a step can see: 2/(gap h^2 s), s = B M^-1 B^T of the
   !> row alone. Rigid rows have all of it.
   pure subroutine bound_stiffness(n, h, gap, rigid, s, rows)
      integer, intent(in) :: n
      real(wp), intent(in) :: h, gap             !! longest step of late
      logical, intent(in) :: rigid
      real(wp), intent(in) :: s(BLOCK, 21)       !! lower triangles by rows
      type(compliant_block_t), intent(inout) :: rows

      real(wp) :: most
      integer :: i, k

      do k = 1, NDOF
         do i = 1, n
            if (.not. rows%k(i, k) > 0.0_wp) then
               rows%most(i, k) = 0.0_wp
               cycle
            end if
            associate (own => s(i, k*(k + 1)/2))
               most = merge(0.0_wp, huge(most), rigid)
               if (own > 0.0_wp) most = 2.0_wp/(gap*h**2*own)
            end associate
            if (.not. rigid) most = min(most, rows%k(i, k))
            rows%most(i, k) = most
         end do
      end do
   end subroutine bound_stiffness

   !> Compliance, memory and weight of the rows for a step h
   pure subroutine weigh_rows(n, h, rigid, rows)
      integer, intent(in) :: n
      real(wp), intent(in) :: h
      logical, intent(in) :: rigid
      type(compliant_block_t), intent(inout) :: rows

      real(wp) :: both, c
      integer :: i, k

      do k = 1, NDOF
         !$omp simd private(both, c)
         do i = 1, n
            c = merge(0.0_wp, rows%c(i, k), rigid .or. rows%most(i, k) < rows%k(i, k))
            both = h*rows%most(i, k) + c
            rows%weight(i, k) = 0.5_wp*h*both
            both = merge(1.0_wp/max(both, tiny(both)), 0.0_wp, both > 0.0_wp)
            rows%kappa(i, k) = h*both
            rows%phi(i, k) = c*both
         end do
      end do
   end subroutine weigh_rows

   !> First guess of the multipliers from those of the last three steps
   pure subroutine extrapolate(n, last, w, rows)
      integer, intent(in) :: n, last             !! rows from 1 to this, 3 or 6
      real(wp), intent(in) :: w(3)               !! their weights, the last first
      type(compliant_block_t), intent(inout) :: rows

      integer :: i, k

      do k = 1, last
         !$omp simd
         do i = 1, n
            rows%f(i, k) = w(1)*rows%f_last(i, k) + w(2)*rows%f_before(i, k) + &
               w(3)*rows%f_third(i, k)
         end do
      end do
   end subroutine extrapolate

   !> r = q - phi q(n) - kappa f, the largest of translations and rotations; then r/kappa, the
   !> right-hand side times the weight
   pure subroutine residual(n, last, h, before, rows, way, turn)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: h
      real(wp), intent(in) :: before(BLOCK, 6)   !! q at the start of the step
      type(compliant_block_t), intent(inout) :: rows
      real(wp), intent(inout) :: way, turn

      real(wp) :: worst, sum, r
      integer :: i, k

      do k = 1, last
         worst = 0.0_wp
         sum = 0.0_wp
         !$omp simd private(r) reduction(max: worst) reduction(+: sum)
         do i = 1, n
            r = (rows%q(i, k) - rows%q0(i, k)) - rows%phi(i, k)*(before(i, k) - rows%q0(i, k)) - &
               rows%kappa(i, k)*rows%f(i, k)
            r = merge(r, 0.0_wp, rows%weight(i, k) > 0.0_wp)
            rows%r(i, k) = (2.0_wp/h**2*rows%weight(i, k))*r
            worst = max(worst, abs(r))
            sum = sum + r
         end do
         if (.not. abs(sum) <= huge(sum)) worst = huge(worst)   ! what is no number is not small
         if (k <= 3) way = max(way, worst)
         if (k > 3) turn = max(turn, worst)
      end do
   end subroutine residual

   !> r := r - weight B y, a change of f; the largest change and the largest force after it,
   !> translations and rotations
   pure subroutine find_change(n, last, rate, rows, change, force)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: rate(BLOCK, 6)     !! B y
      type(compliant_block_t), intent(inout) :: rows
      real(wp), intent(inout) :: change(2), force(2)

      real(wp) :: d, largest, size
      integer :: i, k, part

      do k = 1, last
         part = merge(1, 2, k <= 3)
         largest = change(part)
         size = force(part)
         !$omp simd private(d) reduction(max: largest, size)
         do i = 1, n
            d = rows%r(i, k) - rows%weight(i, k)*rate(i, k)
            rows%r(i, k) = d
            largest = max(largest, abs(d))
            size = max(size, abs(rows%f(i, k) + d))
         end do
         change(part) = largest
         force(part) = size
      end do
   end subroutine find_change

   !> Right-hand side of the velocity stage times the weights:
   !> 2/h (B u + k/(h k + c) (kappa f + phi q(n)))
   pure subroutine velocity_side(n, last, h, at_rest, before, rate, rows)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: h
      logical, intent(in) :: at_rest             !! without the second part
      real(wp), intent(in) :: before(BLOCK, 6)
      real(wp), intent(in) :: rate(BLOCK, 6)     !! B u
      type(compliant_block_t), intent(inout) :: rows

      real(wp) :: part
      integer :: i, k

      part = merge(0.0_wp, 1.0_wp, at_rest)
      do k = 1, last
         !$omp simd
         do i = 1, n
            rows%r(i, k) = (rows%weight(i, k) + rows%damp(i, k))*(2.0_wp/h)*rate(i, k) + &
               part*rows%most(i, k)*(rows%kappa(i, k)*rows%f(i, k) + &
               rows%phi(i, k)*(before(i, k) - rows%q0(i, k)))
         end do
      end do
   end subroutine velocity_side

   !> g = r - weight B y, and the rest of the dampers
   pure subroutine velocity_force(n, last, rate, rows)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: rate(BLOCK, 6)     !! B y
      type(compliant_block_t), intent(inout) :: rows

      integer :: i, k

      do k = 1, last
         !$omp simd
         do i = 1, n
            rows%g(i, k) = rows%r(i, k) - (rows%weight(i, k) + rows%damp(i, k))*rate(i, k) + &
               rows%rest(i, k)
         end do
      end do
   end subroutine velocity_force

   !> What the joints add to the matrix of the bodies, rows weighted with weight + damp
   pure subroutine coefficients(n, turned, weight, damp, b, a)
      integer, intent(in) :: n
      logical, intent(in) :: turned              !! some rows are rotations
      real(wp), intent(in) :: weight(BLOCK, 6), damp(BLOCK, 6)
      type(matrix_t), intent(in) :: b
      !> of symmetric blocks the lower triangles alone, tt only where rows are rotations
      type(coefficients_t), intent(inout) :: a

      real(wp), dimension(BLOCK, 9) :: m, wf, wc, wm, wt
      integer :: i, j, k

      do k = 1, 7, 3
         !$omp simd
         do i = 1, n
            m(i, k) = (b%apart(i, 2)*b%force(i, k + 2) - b%apart(i, 3)*b%force(i, k + 1)) - &
               b%couple(i, k)
            m(i, k + 1) = (b%apart(i, 3)*b%force(i, k) - b%apart(i, 1)*b%force(i, k + 2)) - &
               b%couple(i, k + 1)
            m(i, k + 2) = (b%apart(i, 1)*b%force(i, k + 1) - b%apart(i, 2)*b%force(i, k)) - &
               b%couple(i, k + 2)
         end do
         do j = k, k + 2
            !$omp simd
            do i = 1, n
               wf(i, j) = (weight(i, (k + 2)/3) + damp(i, (k + 2)/3))*b%force(i, j)
               wc(i, j) = (weight(i, (k + 2)/3) + damp(i, (k + 2)/3))*b%couple(i, j)
               wm(i, j) = (weight(i, (k + 2)/3) + damp(i, (k + 2)/3))*m(i, j)
               if (turned) wt(i, j) = (weight(i, (k + 2)/3 + 3) + damp(i, (k + 2)/3 + 3))* &
                  b%turn(i, j)
            end do
         end do
      end do
      do j = 1, 3
         do k = 1, 3
            call products(wf, b%couple, a%fc)
            call products(wf, m, a%fm)
            call products(wm, b%couple, a%mc)
            if (k < j) cycle
            call products(wf, b%force, a%ff)
            call products(wc, b%couple, a%cc)
            call products(wm, m, a%mm)
            if (turned) call products(wt, b%turn, a%tt)
         end do
      end do

   contains

      !> Element (k, j) of u^T v
      pure subroutine products(u, v, uv)
         real(wp), intent(in) :: u(BLOCK, 9), v(BLOCK, 9)
         real(wp), intent(inout) :: uv(BLOCK, 9)

         integer :: i

         !$omp simd
         do i = 1, n
            uv(i, 3*j + k - 3) = u(i, k)*v(i, j) + u(i, k + 3)*v(i, j + 3) + &
               u(i, k + 6)*v(i, j + 6)
         end do
      end subroutine products
   end subroutine coefficients

end module kj_consistent_compliant_rows
