!> Damping forces of the joints of a batch under the consistent formulation: pass 2 of a step, from
!> predicted velocities, by block Jacobi (no loss of time step), and the energy that they take.
!> Source: consistent.md 4.
module kj_c_damper
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: LAW_DAMPER, LAW_DAMPER_CURVE
   use kj_joint_frame, only: BLOCK
   use kj_c_batch, only: c_batch_t, c_joint_t
   use kj_c_force, only: poses_t, rates, put_wrench
   implicit none
   private

   public :: add_dampers, count_damping

contains

   !> Pass 2 for joints lo..hi: damping forces from the predicted velocities, and the energy that
   !> the
   !> second half kick takes with them; wrench of what they change.
   !>
   !> (1 + h/2 C S) (f - f_old) = C B v* - f_old, S = B M^-1 B^T with each body's inverse mass times
   !> its number of joints; for a curve C is its slope at B v* where that is positive. h = 0: f = C
   !> B v.
   pure subroutine add_dampers(batch, curves, poses, h, lo, hi, joint, wrench)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      real(wp), intent(in) :: h
      integer, intent(in) :: lo, hi
      type(c_joint_t), intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      real(wp), dimension(BLOCK, 9) :: dir, m1, m2, rot
      real(wp), dimension(BLOCK, 6) :: rate, f, c
      real(wp) :: s(BLOCK, 21)
      integer :: from, to, n, i, k

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         n = to - from + 1
         dir(:n, :) = joint%dir(from:to, :)
         m1(:n, :) = joint%m1(from:to, :)
         m2(:n, :) = joint%m2(from:to, :)
         rot(:n, :) = joint%rot(from:to, :)
         call rates(batch, poses, from, n, dir, m1, m2, rot, rate)
         do k = 1, NDOF
            call damper(batch, curves, from, n, k, rate(:, k), f(:, k), c(:, k))
            if (batch%limited) then
               c(:n, k) = c(:n, k) + joint%c_limit(from:to, k)
               f(:n, k) = f(:n, k) + joint%c_limit(from:to, k)*rate(:n, k)
            end if
            f(:n, k) = f(:n, k) - joint%fd(from:to, k)
         end do
         if (h > 0.0_wp) then
            call compliance(batch, poses, from, n, dir, m1, m2, rot, s)
            call solve(n, 0.5_wp*h, c, s, f)
         end if
         call put_wrench(n, .false., f, dir, m1, m2, rot, wrench(:, batch%first + from:))
         do k = 1, NDOF
            do i = 1, n
               joint%fd(from + i - 1, k) = joint%fd(from + i - 1, k) + f(i, k)
               joint%dissipated(from + i - 1) = joint%dissipated(from + i - 1) + &
                  0.5_wp*h*joint%fd(from + i - 1, k)*joint%qd(from + i - 1, k)
            end do
         end do
      end do
   end subroutine add_dampers

   !> Energy that the dampers of joints lo..hi take in the first half kick: h/2 f.B v, v after it
   pure subroutine count_damping(batch, poses, h, lo, hi, joint)
      type(c_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      real(wp), intent(in) :: h
      integer, intent(in) :: lo, hi
      type(c_joint_t), intent(inout) :: joint

      real(wp), dimension(BLOCK, 9) :: dir, m1, m2, rot
      real(wp) :: rate(BLOCK, 6)
      integer :: from, to, n, k

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         n = to - from + 1
         dir(:n, :) = joint%dir(from:to, :)
         m1(:n, :) = joint%m1(from:to, :)
         m2(:n, :) = joint%m2(from:to, :)
         rot(:n, :) = joint%rot(from:to, :)
         call rates(batch, poses, from, n, dir, m1, m2, rot, rate)
         do k = 1, NDOF
            joint%dissipated(from:to) = joint%dissipated(from:to) + &
               0.5_wp*h*joint%fd(from:to, k)*rate(:n, k)
         end do
      end do
   end subroutine count_damping

   !> Damping force of one dof at a rate, and its slope where positive
   pure subroutine damper(batch, curves, from, n, dof, rate, f, c)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: from, n, dof
      real(wp), intent(in) :: rate(BLOCK)
      real(wp), intent(out) :: f(BLOCK), c(BLOCK)

      real(wp) :: y, slope
      integer :: i, j

      if (iand(batch%law(dof), LAW_DAMPER + LAW_DAMPER_CURVE) == 0) then
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

   !> S = B M^-1 B^T of each joint, lower triangle by rows: s11, s21, s22, s31, ...
   pure subroutine compliance(batch, poses, from, n, dir, m1, m2, rot, s)
      type(c_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: from, n
      real(wp), dimension(BLOCK, 9), intent(in) :: dir, m1, m2, rot
      real(wp), intent(out) :: s(BLOCK, 21)

      real(wp), dimension(BLOCK, 18) :: b1, b2, j1, j2
      real(wp) :: im(BLOCK), ij1(BLOCK, 6), ij2(BLOCK, 6)
      integer :: i, k, l, at

      do i = 1, n
         im(i) = poses%im(batch%lead(from + i - 1, 1)) + poses%im(batch%lead(from + i - 1, 2))
      end do
      do k = 1, 6
         ij1(:n, k) = poses%ij(batch%lead(from:from + n - 1, 1), k)
         ij2(:n, k) = poses%ij(batch%lead(from:from + n - 1, 2), k)
      end do
      b1(:n, 1:9) = m1(:n, :)
      b1(:n, 10:18) = rot(:n, :)
      b2(:n, 1:9) = m2(:n, :)
      b2(:n, 10:18) = -rot(:n, :)
      call weigh(n, ij1, b1, j1)
      call weigh(n, ij2, b2, j2)
      at = 0
      do k = 0, 5
         do l = 0, k
            at = at + 1
            !$omp simd
            do i = 1, n
               s(i, at) = b1(i, 3*k + 1)*j1(i, 3*l + 1) + b1(i, 3*k + 2)*j1(i, 3*l + 2) + &
                  b1(i, 3*k + 3)*j1(i, 3*l + 3) + &
                  b2(i, 3*k + 1)*j2(i, 3*l + 1) + b2(i, 3*k + 2)*j2(i, 3*l + 2) + &
                     b2(i, 3*k + 3)*j2(i, 3*l + 3)
            end do
         end do
      end do
      at = 0
      do k = 0, 2
         do l = 0, k
            at = at + 1
            !$omp simd
            do i = 1, n
               s(i, at) = s(i, at) + im(i)*(dir(i, 3*k + 1)*dir(i, 3*l + 1) + &
                  dir(i, 3*k + 2)*dir(i, 3*l + 2) + &
                  dir(i, 3*k + 3)*dir(i, 3*l + 3))
            end do
         end do
      end do
   end subroutine compliance

   !> y = J^-1 b for six vectors
   pure subroutine weigh(n, ij, b, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: ij(BLOCK, 6), b(BLOCK, 18)
      real(wp), intent(out) :: y(BLOCK, 18)

      integer :: i, k

      do k = 1, 16, 3
         !$omp simd
         do i = 1, n
            y(i, k) = ij(i, 1)*b(i, k) + ij(i, 4)*b(i, k + 1) + ij(i, 5)*b(i, k + 2)
            y(i, k + 1) = ij(i, 4)*b(i, k) + ij(i, 2)*b(i, k + 1) + ij(i, 6)*b(i, k + 2)
            y(i, k + 2) = ij(i, 5)*b(i, k) + ij(i, 6)*b(i, k + 1) + ij(i, 3)*b(i, k + 2)
         end do
      end do
   end subroutine weigh

   !> f := (1 + g C S)^-1 f for a block, C diagonal >= 0, S symmetric >= 0.
   !>
   !> With D = C^1/2 this is D (1 + g D S D)^-1 D^-1: the part of f along a dof without damping
   !> stays
   !> (it is zero). Cholesky without pivoting, all joints of the block at once: 6 x 6 is far too
   !> small for one LAPACK call a joint.
   pure subroutine solve(n, g, c, s, f)
      integer, intent(in) :: n
      real(wp), intent(in) :: g, c(BLOCK, 6), s(BLOCK, 21)
      real(wp), intent(inout) :: f(BLOCK, 6)

      real(wp) :: a(BLOCK, 21), d(BLOCK, 6), t
      integer :: i, k, l, m, at

      do k = 1, 6
         do i = 1, n
            d(i, k) = sqrt(c(i, k))
            if (d(i, k) > 0.0_wp) f(i, k) = f(i, k)/d(i, k)
         end do
      end do
      do k = 1, 6
         do l = 1, k
            at = k*(k - 1)/2 + l
            !$omp simd private(t)
            do i = 1, n
               t = g*d(i, k)*s(i, at)*d(i, l)
               if (k == l) t = t + 1.0_wp
               do m = 1, l - 1
                  t = t - a(i, k*(k - 1)/2 + m)*a(i, l*(l - 1)/2 + m)
               end do
               if (k == l) then
                  a(i, at) = sqrt(t)
               else
                  a(i, at) = t/a(i, l*(l + 1)/2)
               end if
            end do
         end do
      end do
      do k = 1, 6
         do m = 1, k - 1
            f(:n, k) = f(:n, k) - a(:n, k*(k - 1)/2 + m)*f(:n, m)
         end do
         f(:n, k) = f(:n, k)/a(:n, k*(k + 1)/2)
      end do
      do k = 6, 1, -1
         do m = k + 1, 6
            f(:n, k) = f(:n, k) - a(:n, m*(m - 1)/2 + k)*f(:n, m)
         end do
         f(:n, k) = f(:n, k)/a(:n, k*(k + 1)/2)
      end do
      do k = 1, 6
         do i = 1, n
            if (d(i, k) > 0.0_wp) f(i, k) = f(i, k)*d(i, k)
         end do
      end do
   end subroutine solve

end module kj_c_damper
