!> Damping forces of the joints of a batch under the consistent formulation: pass 2 of a step, from
!> predicted velocities, by block Jacobi (no loss of time step), and the energy that they take.
!> Source: docs/theory/consistent.md 6.
module kj_consistent_dampers
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: LAW_DAMPER, LAW_DAMPER_CURVE, joint_batch_t, is_hardened
   use kj_block, only: BLOCK, block_of, lane_of, group_of
   use kj_consistent_batch, only: consistent_joint_t, consistent_block_t, in_groups, &
      group_at
   use kj_consistent_matrix, only: poses_t, rates, put_wrench, add_moment
   use kj_consistent_compliance, only: end_inertias, compliance
   use kj_consistent_hardening, only: hardened_damper
   use kj_consistent_stop, only: damp_round_stops
   implicit none
   private

   public :: add_dampers, count_damping, damper

contains

   !> Pass 2 for joints lo..hi: damping forces from the predicted velocities, and the energy that
   !> the second half kick takes with them; wrench of what they change.
   !>
   !> (1 + h/2 C S) (f - f_old) = C B v* - f_old, S = B M^-1 B^T with each body's inverse mass times
   !> its number of joints; for a curve C is its slope at B v* where that is positive. h = 0: f = C
   !> B v. lo is the first joint of a block.
   subroutine add_dampers(batch, curves, poses, lo, hi, joint, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: lo, hi
      type(consistent_joint_t), target, intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      type(consistent_block_t), pointer :: state
      integer :: from, n

      from = lo
      do while (from <= hi)
         n = min(BLOCK, hi - from + 1)
         if (in_groups(batch)) n = group_of(n)
         call group_at(joint%block(block_of(from)), lane_of(from), state)
         select case (n)
         case (1)
            call dampers_of(1, batch, curves, poses, from, state, joint, wrench)
         case (2)
            call dampers_of(2, batch, curves, poses, from, state, joint, wrench)
         case (3)
            call dampers_of(3, batch, curves, poses, from, state, joint, wrench)
         case (4)
            call dampers_of(4, batch, curves, poses, from, state, joint, wrench)
         case (8)
            call dampers_of(8, batch, curves, poses, from, state, joint, wrench)
         case (BLOCK)
            call dampers_of(BLOCK, batch, curves, poses, from, state, joint, wrench)
         case default
            call dampers_of(n, batch, curves, poses, from, state, joint, wrench)
         end select
         from = from + n
      end do
   end subroutine add_dampers

   !> The same for n joints of a block, whose first is `from`
   pure subroutine dampers_of(n, batch, curves, poses, from, state, joint, wrench)
      integer, value :: n
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: from
      type(consistent_block_t), target, intent(inout) :: state     !! from these joints on
      type(consistent_joint_t), target, intent(inout) :: joint     !! its blocks are not touched
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      real(wp), dimension(BLOCK, 6) :: rate, f, c
      real(wp) :: s(BLOCK, 21), moment(BLOCK, 3), im(BLOCK, 2), ij1(BLOCK, 6), ij2(BLOCK, 6)
      integer :: at, last, i, k

      last = batch%geometry%damped
      if (last == 0) f(:n, :3) = 0.0_wp
      at = (from - 1)/BLOCK + 1
      associate (h => poses%h)
         call rates(batch, last, poses%v, poses%w, from, n, state%b, rate)
         do k = 1, last
            if (is_hardened(batch)) then
               call hardened_damper(batch, curves, from, n, k, rate(:, k), joint%spring(at), &
                  f(:, k), c(:, k))
            else
               call damper(batch, curves, from, n, k, rate(:, k), f(:, k), c(:, k))
            end if
            if (batch%limited) then
               c(:n, k) = c(:n, k) + joint%limit(at)%c_limit(:n, k)
               f(:n, k) = f(:n, k) + joint%limit(at)%c_limit(:n, k)*rate(:n, k)
            end if
            f(:n, k) = f(:n, k) - state%fd(:n, k)
         end do
         if (h(1) > 0.0_wp) then
            call end_inertias(batch, poses, from, n, im, ij1, ij2)
            call compliance(n, last, state%b, im, ij1, ij2, s)
            if (last == 3) call solve_three(n, h, c, s, f)
            if (last == 6) call solve(n, h, c, s, f)
            if (batch%limited) call damp_round_stops(joint%limit(at), h, n, rate, s, f)
         end if
         moment(:n, :) = 0.0_wp
         if (last > 3) call add_moment(n, f(:, 4:6), state%b%turn, moment)
         call put_wrench(n, batch%abreast, f(:, 1:3), moment, state%b, &
            wrench(:, batch%first + from:))
         do k = 1, last
            !$omp simd
            do i = 1, n
               state%fd(i, k) = state%fd(i, k) + f(i, k)
               state%dissipated(i) = state%dissipated(i) + &
                  0.5_wp*h(i)*state%fd(i, k)*state%qd(i, k)
            end do
         end do
      end associate
   end subroutine dampers_of

   !> Energy that the dampers of n joints from `from` take in half a step h: h/2 f.B v
   pure subroutine count_damping(batch, v, w, h, from, n, state)
      type(joint_batch_t), intent(in) :: batch
      real(wp), contiguous, intent(in) :: v(:, :), w(:, :)   !! (n_lead, 3) when B was found
      real(wp), intent(in) :: h(BLOCK)
      integer, value :: from, n                  !! n <= BLOCK
      type(consistent_block_t), intent(inout) :: state

      real(wp) :: rate(BLOCK, 6)
      integer :: i, k

      call rates(batch, batch%geometry%damped, v, w, from, n, state%b, rate)
      do k = 1, batch%geometry%damped
         !$omp simd
         do i = 1, n
            state%dissipated(i) = state%dissipated(i) + 0.5_wp*h(i)*state%fd(i, k)*rate(i, k)
         end do
      end do
   end subroutine count_damping

   !> Damping force of one dof at a rate, and its slope where positive
   pure subroutine damper(batch, curves, from, n, dof, rate, f, c)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, value :: from, n, dof
      real(wp), intent(in) :: rate(BLOCK)
      real(wp), intent(out) :: f(BLOCK), c(BLOCK)

      real(wp) :: y, slope
      integer :: i, j

      if (iand(batch%law(dof), LAW_DAMPER + LAW_DAMPER_CURVE) == 0) then   ! of limits alone
         f(:n) = 0.0_wp
         c(:n) = 0.0_wp
      else if (iand(batch%law(dof), LAW_DAMPER_CURVE) /= 0) then
         do i = 1, n
            j = from + i - 1
            call law_value(curves, batch%c_curve(j, dof), rate(i), y, slope)
            f(i) = batch%c(j, dof)*y
            c(i) = max(0.0_wp, batch%c(j, dof)*slope)
         end do
      else
         !$omp simd
         do i = 1, n
            c(i) = batch%c(from + i - 1, dof)
            f(i) = c(i)*rate(i)
         end do
      end if
   end subroutine damper

   !> f := (1 + g C S)^-1 f for a block, g = h/2, C diagonal >= 0, S symmetric >= 0.
   !>
   !> With D = C^1/2 this is D (1 + g D S D)^-1 D^-1: the part of f along a dof without damping
   !> stays (it is zero). L D L^T without pivoting, all joints of the block at once: 6 x 6 is far
   !> too small for one LAPACK call a joint.
   pure subroutine solve(n, h, c, s, f)
      integer, value :: n
      real(wp), intent(in) :: h(BLOCK), c(BLOCK, 6), s(BLOCK, 21)
      real(wp), intent(inout) :: f(BLOCK, 6)

      real(wp) :: a(BLOCK, 21), d(BLOCK, 6), scale(BLOCK, 6), pivot(BLOCK, 6), part
      integer :: i, k, l, m, at, row, column

      do k = 1, NDOF
         !$omp simd
         do i = 1, n
            d(i, k) = sqrt(c(i, k))
            scale(i, k) = merge(d(i, k), 1.0_wp, d(i, k) > 0.0_wp)
            f(i, k) = f(i, k)/scale(i, k)
         end do
      end do
      do k = 1, NDOF
         do l = 1, k
            at = k*(k - 1)/2 + l
            !$omp simd
            do i = 1, n
               a(i, at) = 0.5_wp*h(i)*d(i, k)*s(i, at)*d(i, l)
            end do
         end do
         a(:n, at) = a(:n, at) + 1.0_wp
      end do
      do k = 1, NDOF
         !$omp simd
         do i = 1, n
            pivot(i, k) = 1.0_wp/a(i, k*(k + 1)/2)
         end do
         do l = k + 1, NDOF
            row = l*(l - 1)/2
            do m = k + 1, l
               column = m*(m - 1)/2 + k
               !$omp simd private(part)
               do i = 1, n
                  part = a(i, row + k)*pivot(i, k)
                  a(i, row + m) = a(i, row + m) - part*a(i, column)
               end do
            end do
            !$omp simd
            do i = 1, n
               f(i, l) = f(i, l) - a(i, row + k)*pivot(i, k)*f(i, k)
            end do
         end do
      end do
      do k = NDOF, 1, -1
         do m = k + 1, NDOF
            !$omp simd
            do i = 1, n
               f(i, k) = f(i, k) - a(i, m*(m - 1)/2 + k)*f(i, m)
            end do
         end do
         !$omp simd
         do i = 1, n
            f(i, k) = f(i, k)*pivot(i, k)
         end do
      end do
      do k = 1, NDOF
         !$omp simd
         do i = 1, n
            f(i, k) = f(i, k)*scale(i, k)
         end do
      end do
   end subroutine solve

   !> The same of the translations alone, with the same bits, in registers
   pure subroutine solve_three(n, h, c, s, f)
      integer, value :: n
      real(wp), intent(in) :: h(BLOCK), c(BLOCK, 6), s(BLOCK, 21)
      real(wp), intent(inout) :: f(BLOCK, 6)

      real(wp) :: d1, d2, d3, s1, s2, s3, p1, p2, p3, a21, a22, a31, a32, a33, f1, f2, f3
      integer :: i

      !$omp simd private(d1, d2, d3, s1, s2, s3, p1, p2, p3, a21, a22, a31, a32, a33, f1, f2, f3)
      do i = 1, n
         d1 = sqrt(c(i, 1))
         d2 = sqrt(c(i, 2))
         d3 = sqrt(c(i, 3))
         s1 = merge(d1, 1.0_wp, d1 > 0.0_wp)
         s2 = merge(d2, 1.0_wp, d2 > 0.0_wp)
         s3 = merge(d3, 1.0_wp, d3 > 0.0_wp)
         a21 = 0.5_wp*h(i)*d2*s(i, 2)*d1
         a22 = 0.5_wp*h(i)*d2*s(i, 3)*d2 + 1.0_wp
         a31 = 0.5_wp*h(i)*d3*s(i, 4)*d1
         a32 = 0.5_wp*h(i)*d3*s(i, 5)*d2
         a33 = 0.5_wp*h(i)*d3*s(i, 6)*d3 + 1.0_wp
         p1 = 1.0_wp/(0.5_wp*h(i)*d1*s(i, 1)*d1 + 1.0_wp)
         p2 = 1.0_wp/(a22 - a21*p1*a21)
         a32 = a32 - a31*p1*a21
         p3 = 1.0_wp/(a33 - a31*p1*a31 - a32*p2*a32)
         f1 = f(i, 1)/s1
         f2 = f(i, 2)/s2 - a21*p1*f1
         f3 = (f(i, 3)/s3 - a31*p1*f1 - a32*p2*f2)*p3
         f2 = (f2 - a32*f3)*p2
         f1 = (f1 - a21*f2 - a31*f3)*p1
         f(i, 1) = f1*s1
         f(i, 2) = f2*s2
         f(i, 3) = f3*s3
      end do
   end subroutine solve_three

end module kj_consistent_dampers
