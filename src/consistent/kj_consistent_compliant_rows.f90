!> Rows of the joints in the integrator `compliant`, for blocks of joints: how stiff a step sees
!> them, residuals and multipliers.
!> Source: docs/theory/compliant.md 1, 2.
module kj_consistent_compliant_rows
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_types, only: NDOF
   use kj_consistent_batch, only: matrix_t
   use kj_consistent_compliant_types, only: compliant_block_t
   implicit none
   private

   public :: bound_stiffness, weigh_rows, extrapolate, correct, residual, &
      find_change, velocity_side, count_work, take_power, take_block

contains

   !> Stiffness of implicit rows, no more than a step can see: 2/(gap h^2 s), s = B M^-1 B^T of the
   !> row alone. Rigid rows have all of it.
   pure subroutine bound_stiffness(n, last, h, gap, rigid, rows)
      integer, intent(in) :: n, last             !! rows from 1 to this, 3 or 6
      real(wp), intent(in) :: h, gap             !! longest step of late
      logical, intent(in) :: rigid
      type(compliant_block_t), intent(inout) :: rows

      real(wp) :: most, none
      integer :: i, k

      none = merge(0.0_wp, huge(none), rigid)
      do k = 1, last
         !$omp simd private(most)
         do i = 1, n
            most = 2.0_wp/(gap*h**2*max(rows%own(i, k), tiny(most)))
            most = merge(most, none, rows%own(i, k) > 0.0_wp)
            most = merge(most, rows%k(i, k), rigid .or. most < rows%k(i, k))
            rows%most(i, k) = merge(most, 0.0_wp, rows%k(i, k) > 0.0_wp)
         end do
      end do
   end subroutine bound_stiffness

   !> Compliance, memory and weight of the rows for a step h; the largest 1/compliance, translations
   !> and rotations
   pure subroutine weigh_rows(n, last, h, rigid, rows, stiffest)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: h
      logical, intent(in) :: rigid
      type(compliant_block_t), intent(inout) :: rows
      real(wp), intent(inout) :: stiffest(2)

      real(wp) :: both, c, most
      integer :: i, k

      do k = 1, last
         most = 0.0_wp
         !$omp simd private(both, c) reduction(max: most)
         do i = 1, n
            c = merge(0.0_wp, rows%c(i, k), rigid .or. rows%most(i, k) < rows%k(i, k))
            both = h*rows%most(i, k) + c
            rows%weight(i, k) = 0.5_wp*h*both
            both = merge(1.0_wp/max(both, tiny(both)), 0.0_wp, both > 0.0_wp)
            rows%kappa(i, k) = h*both
            rows%phi(i, k) = c*both
            most = max(most, rows%weight(i, k))
         end do
         stiffest((k + 2)/3) = max(stiffest((k + 2)/3), 2.0_wp/h**2*most)
      end do
   end subroutine weigh_rows

   !> First guess of the multipliers f of a step: g of the last one, which belongs to the pose that
   !> it begins in, and part of the last rise from there on
   pure subroutine extrapolate(n, last, part, rows)
      integer, value :: n
      integer, intent(in) :: last                !! rows from 1 to this, 3 or 6
      real(wp), intent(in) :: part
      type(compliant_block_t), intent(inout) :: rows

      integer :: i, k

      do k = 1, last
         !$omp simd
         do i = 1, n
            rows%f(i, k) = merge(rows%g(i, k) + part*rows%rise(i, k), 0.0_wp, &
               rows%weight(i, k) > 0.0_wp)
         end do
      end do
   end subroutine extrapolate

   !> f := f + part r
   pure subroutine correct(n, last, part, rows)
      integer, value :: n
      integer, intent(in) :: last
      real(wp), intent(in) :: part
      type(compliant_block_t), intent(inout) :: rows

      integer :: i, k

      do k = 1, last
         !$omp simd
         do i = 1, n
            rows%f(i, k) = rows%f(i, k) + part*rows%r(i, k)
            rows%asked(i, k) = rows%r(i, k)
         end do
      end do
   end subroutine correct

   !> r = q - phi q(n) - kappa f, the largest of translations and rotations; then r/kappa, the
   !> right-hand side times the weight
   pure subroutine residual(n, last, h, before, rows, largest)
      integer, value :: n
      integer, intent(in) :: last
      real(wp), intent(in) :: h
      real(wp), intent(in) :: before(BLOCK, 6)   !! q at the start of the step
      type(compliant_block_t), intent(inout) :: rows
      real(wp), intent(inout) :: largest(2)

      real(wp) :: on(BLOCK), worst(BLOCK), sum(BLOCK), r
      integer :: i, k, part

      do part = 1, last/3
         worst(:n) = 0.0_wp
         sum(:n) = 0.0_wp
         do k = 3*part - 2, 3*part
            !$omp simd
            do i = 1, n
               on(i) = merge(1.0_wp, 0.0_wp, rows%weight(i, k) > 0.0_wp)
            end do
            !$omp simd private(r)
            do i = 1, n
               r = (rows%q(i, k) - rows%q0(i, k)) - &
                  rows%phi(i, k)*(before(i, k) - rows%q0(i, k)) - rows%kappa(i, k)*rows%f(i, k)
               r = on(i)*r
               rows%r(i, k) = (2.0_wp/h**2*rows%weight(i, k))*r
               worst(i) = merge(abs(r), worst(i), abs(r) > worst(i))
               sum(i) = sum(i) + r
            end do
         end do
         do i = 1, n
            if (worst(i) > largest(part)) largest(part) = worst(i)
            if (.not. abs(sum(i)) <= huge(r)) largest(part) = huge(r)   ! no number is not small
         end do
      end do
   end subroutine residual

   !> The largest change r of f and the largest force after it, translations and rotations
   pure subroutine find_change(n, last, rows, change, force)
      integer, value :: n
      integer, intent(in) :: last
      type(compliant_block_t), intent(in) :: rows
      real(wp), intent(inout) :: change(2), force(2)

      real(wp) :: worst(BLOCK), most(BLOCK), d, f
      integer :: i, k, part

      do part = 1, last/3
         worst(:n) = 0.0_wp
         most(:n) = 0.0_wp
         do k = 3*part - 2, 3*part
            !$omp simd private(d, f)
            do i = 1, n
               d = abs(rows%r(i, k))
               f = abs(rows%f(i, k) + rows%r(i, k))
               worst(i) = merge(d, worst(i), d > worst(i))
               most(i) = merge(f, most(i), f > most(i))
            end do
         end do
         do i = 1, n
            if (worst(i) > change(part)) change(part) = worst(i)
            if (most(i) > force(part)) force(part) = most(i)
         end do
      end do
   end subroutine find_change

   !> Right-hand side of the velocity stage times the weights:
   !> 2/h (B u + k/(h k + c) (kappa f + phi q(n)))
   pure subroutine velocity_side(n, last, h, at_rest, before, rate, rows)
      integer, value :: n
      integer, intent(in) :: last
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

   !> Work of a step on implicit rows: 1/2 (f + g) (q - q(n)); elastic energy 1/2 k q^2 with the q
   !> that f stands for; the rest is lost
   pure subroutine count_work(n, last, before, rows, elastic, dissipated)
      integer, value :: n
      integer, intent(in) :: last
      real(wp), intent(in) :: before(BLOCK, 6)
      type(compliant_block_t), intent(inout) :: rows
      real(wp), intent(inout) :: elastic(BLOCK), dissipated(BLOCK)

      real(wp) :: work(BLOCK), stored(BLOCK), strain
      integer :: i, k

      work(:n) = 0.0_wp
      stored(:n) = 0.0_wp
      do k = 1, last
         !$omp simd private(strain)
         do i = 1, n
            strain = rows%kappa(i, k)*rows%f(i, k) + rows%phi(i, k)*(before(i, k) - rows%q0(i, k))
            stored(i) = stored(i) + 0.5_wp*rows%most(i, k)*strain**2
            work(i) = work(i) + merge(0.5_wp*(rows%f(i, k) + rows%g(i, k))* &
               (rows%q(i, k) - before(i, k)), 0.0_wp, rows%weight(i, k) > 0.0_wp)
         end do
      end do
      do i = 1, n
         elastic(i) = elastic(i) + (stored(i) - rows%elastic(i))
         dissipated(i) = dissipated(i) + (work(i) - (stored(i) - rows%elastic(i)))
         rows%elastic(i) = stored(i)
      end do
   end subroutine count_work

   !> Half a step of the power of dampers of explicit rows
   pure subroutine take_power(n, h, explicit, f, rate, dissipated)
      integer, value :: n
      real(wp), intent(in) :: h
      logical, intent(in) :: explicit(NDOF)
      real(wp), intent(in) :: f(BLOCK, 6), rate(BLOCK, 6)
      real(wp), intent(inout) :: dissipated(BLOCK)

      integer :: k

      do k = 1, NDOF
         if (explicit(k)) dissipated(:n) = dissipated(:n) + 0.5_wp*h*f(:n, k)*rate(:n, k)
      end do
   end subroutine take_power

   !> Coordinates and B of the pose that was tried become those of the joints
   pure subroutine take_block(n, from_q, from_b, q, b)
      integer, value :: n
      real(wp), intent(in) :: from_q(BLOCK, 6)
      type(matrix_t), intent(in) :: from_b
      real(wp), intent(inout) :: q(BLOCK, 6)
      type(matrix_t), intent(inout) :: b

      q(:n, :) = from_q(:n, :)
      b%force(:n, :) = from_b%force(:n, :)
      b%couple(:n, :) = from_b%couple(:n, :)
      b%turn(:n, :) = from_b%turn(:n, :)
      b%apart(:n, :) = from_b%apart(:n, :)
   end subroutine take_block

end module kj_consistent_compliant_rows
