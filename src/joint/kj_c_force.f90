!> Forces of the joints of a batch under the consistent formulation, in two passes: springs from the
!> poses, then dampers from predicted velocities (block Jacobi, no loss of time step).
!> Source: consistent.md 1 and 4.
module kj_c_force
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: LAW_SPRING_CURVE, LAW_DAMPER_CURVE, LAW_SPRING, LAW_DAMPER
   use kj_joint_frame, only: BLOCK
   use kj_c_batch, only: c_batch_t, c_joint_t, CHART_TWIST, CHART_VECTOR
   use kj_c_chart, only: relative_pose, twist_chart, vector_chart, universal_chart, first_skew
   implicit none
   private

   public :: poses_t, add_springs, add_dampers, count_damping, joint_rates

   integer, parameter, public :: N_C_WRENCH = 9   !! force on end 1, moment about lead 1, about lead 2

   !> What joints see of the leads, joint-independent arrays
   type :: poses_t
      real(wp), allocatable :: x(:, :)            !! (n_lead, 3) W
      real(wp), allocatable :: quat(:, :)         !! (n_lead, 4) attitude: world from body axes
      real(wp), allocatable :: v(:, :), w(:, :)   !! (n_lead, 3) velocities; predicted in pass 2
      real(wp), allocatable :: psi(:, :)          !! (n_lead, 3) turn in the last step, rotation vector
      real(wp), allocatable :: im(:)              !! (n_lead) inverse mass times number of joints
      real(wp), allocatable :: ij(:, :)           !! (n_lead, 6) inverse inertia xx yy zz xy xz yz, W, times joints
   end type poses_t

contains

   !> Pass 1 for joints lo..hi: coordinates, B, spring forces, spring work, rates with the velocities
   !> of the half step; wrench of the springs and of the dampers as they were
   pure subroutine add_springs(batch, curves, poses, lo, hi, joint, wrench)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: lo, hi
      type(c_joint_t), intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)   !! (N_C_WRENCH, all joints)

      real(wp), dimension(BLOCK, 9) :: e, dir, m1, m2, rot, rot_d
      real(wp) :: q(BLOCK, 6), f(BLOCK, 6), ortho(BLOCK), change
      integer :: from, to, n, i, k

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         n = to - from + 1
         q(:n, :) = joint%q(from:to, :)
         call coordinates(batch, poses, from, n, q, e, dir, m1, m2, rot, rot_d, ortho)
         do k = 1, NDOF
            call spring(batch, curves, from, n, k, q(:, k), f(:, k))
            do i = 1, n
               change = q(i, k) - joint%q(from + i - 1, k)
               joint%elastic(from + i - 1) = joint%elastic(from + i - 1) + &
                  0.5_wp*change*(f(i, k) + joint%fe(from + i - 1, k))
            end do
         end do
         joint%q(from:to, :) = q(:n, :)
         joint%fe(from:to, :) = f(:n, :)
         joint%e(from:to, :) = e(:n, :)
         joint%dir(from:to, :) = dir(:n, :)
         joint%m1(from:to, :) = m1(:n, :)
         joint%m2(from:to, :) = m2(:n, :)
         joint%rot(from:to, :) = rot_d(:n, :)
         joint%ortho(from:to) = ortho(:n)
         call put_wrench(n, .false., f, dir, m1, m2, rot, wrench(:, batch%first + from:))
         if (.not. batch%damped) cycle
         call rates(batch, poses, from, n, dir, m1, m2, rot_d, q)
         joint%qd(from:to, :) = q(:n, :)
         f(:n, :) = joint%fd(from:to, :)
         call put_wrench(n, .true., f, dir, m1, m2, rot_d, wrench(:, batch%first + from:))
      end do
   end subroutine add_springs

   !> Coordinates and B of a block; q holds the last coordinates on entry
   pure subroutine coordinates(batch, poses, from, n, q, e, dir, m1, m2, rot, rot_d, ortho)
      type(c_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: from, n
      real(wp), intent(inout) :: q(BLOCK, 6)
      real(wp), dimension(BLOCK, 9), intent(out) :: e, dir, m1, m2, rot, rot_d
      real(wp), intent(out) :: ortho(BLOCK)

      real(wp), dimension(BLOCK, 4) :: q1, q2, t1, t2, p
      real(wp), dimension(BLOCK, 3) :: r, arm1, arm2, xl
      real(wp) :: c1(BLOCK, 4), c2(BLOCK, 4), a(BLOCK, 3)
      logical :: plain(BLOCK)
      integer :: i, k, to

      to = from + n - 1
      do k = 1, 4
         q1(:n, k) = poses%quat(batch%lead(from:to, 1), k)
         q2(:n, k) = poses%quat(batch%lead(from:to, 2), k)
         c1(:n, k) = batch%triad(from:to, k)
         c2(:n, k) = batch%triad(from:to, k + 4)
      end do
      a(:n, :) = batch%arm(from:to, 1:3)
      call turn_arm(n, q1, a, arm1)
      a(:n, :) = batch%arm(from:to, 4:6)
      call turn_arm(n, q2, a, arm2)
      do k = 1, 3
         do i = 1, n
            r(i, k) = (poses%x(batch%lead(from + i - 1, 2), k) - &
               poses%x(batch%lead(from + i - 1, 1), k)) + (arm2(i, k) - arm1(i, k))
         end do
      end do
      call relative_pose(n, q1, q2, c1, c2, t1, t2, p)
      ortho = 0.0_wp
      if (.not. batch%mean) call first_skew(n, t1, r, e, m1, m2)
      select case (batch%chart)
      case (CHART_TWIST)
         call twist_chart(n, batch%mean, t1, p, r, q(:, 4:6), e, m1, m2, rot)
         rot_d(:n, :) = rot(:n, :)
      case (CHART_VECTOR)
         plain(:n) = batch%plain(from:to)
         call vector_chart(n, batch%mean, plain, t1, p, r, q(:, 4:6), e, m1, m2, rot, rot_d)
      case default
         ortho(:n) = batch%angle0(from:to)
         a(:n, 1) = ortho(:n)
         call universal_chart(n, t1, t2, r, a(:, 1), q(:, 4:6), xl, e, rot, m1, m2, ortho)
         rot_d(:n, :) = rot(:n, :)
      end select
      dir(:n, :) = e(:n, :)
      if (batch%chart > CHART_VECTOR) dir(:n, :) = rot(:n, :)
      do k = 0, 2
         do i = 1, n
            q(i, k + 1) = dir(i, 3*k + 1)*r(i, 1) + dir(i, 3*k + 2)*r(i, 2) + dir(i, 3*k + 3)*r(i, 3) - &
               batch%xl0(from + i - 1, k + 1)
         end do
         call add_lever(n, 1.0_wp, arm1, dir(:, 3*k + 1:3*k + 3), m1(:, 3*k + 1:3*k + 3))
         call add_lever(n, -1.0_wp, arm2, dir(:, 3*k + 1:3*k + 3), m2(:, 3*k + 1:3*k + 3))
      end do
   end subroutine coordinates

   !> m := m + sign a x f
   pure subroutine add_lever(n, sign, a, f, m)
      integer, intent(in) :: n
      real(wp), intent(in) :: sign, a(BLOCK, 3), f(BLOCK, 3)
      real(wp), intent(inout) :: m(BLOCK, 3)

      integer :: i

      !$omp simd
      do i = 1, n
         m(i, 1) = m(i, 1) + sign*(a(i, 2)*f(i, 3) - a(i, 3)*f(i, 2))
         m(i, 2) = m(i, 2) + sign*(a(i, 3)*f(i, 1) - a(i, 1)*f(i, 3))
         m(i, 3) = m(i, 3) + sign*(a(i, 1)*f(i, 2) - a(i, 2)*f(i, 1))
      end do
   end subroutine add_lever

   !> b = a turned by the quaternion q
   pure subroutine turn_arm(n, q, a, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: q(BLOCK, 4), a(BLOCK, 3)
      real(wp), intent(out) :: b(BLOCK, 3)

      real(wp) :: t1, t2, t3
      integer :: i

      !$omp simd private(t1, t2, t3)
      do i = 1, n
         t1 = 2.0_wp*(q(i, 3)*a(i, 3) - q(i, 4)*a(i, 2))
         t2 = 2.0_wp*(q(i, 4)*a(i, 1) - q(i, 2)*a(i, 3))
         t3 = 2.0_wp*(q(i, 2)*a(i, 2) - q(i, 3)*a(i, 1))
         b(i, 1) = a(i, 1) + q(i, 1)*t1 + (q(i, 3)*t3 - q(i, 4)*t2)
         b(i, 2) = a(i, 2) + q(i, 1)*t2 + (q(i, 4)*t1 - q(i, 2)*t3)
         b(i, 3) = a(i, 3) + q(i, 1)*t3 + (q(i, 2)*t2 - q(i, 3)*t1)
      end do
   end subroutine turn_arm

   !> Elastic force of one dof
   pure subroutine spring(batch, curves, from, n, dof, q, f)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: from, n, dof
      real(wp), intent(in) :: q(BLOCK)
      real(wp), intent(out) :: f(BLOCK)

      real(wp) :: y, slope
      integer :: i, j

      if (iand(batch%law(dof), LAW_SPRING + LAW_SPRING_CURVE) == 0) then
         f(:n) = 0.0_wp
      else if (iand(batch%law(dof), LAW_SPRING_CURVE) /= 0) then
         do i = 1, n
            j = from + i - 1
            call law_value(curves, batch%k_curve(j, dof), q(i), y, slope)
            f(i) = batch%k(j, dof)*y
         end do
      else
         !$omp simd
         do i = 1, n
            f(i) = batch%k(from + i - 1, dof)*q(i)
         end do
      end if
   end subroutine spring

   !> Force on end 1 and moments about the leads of both ends
   pure subroutine put_wrench(n, add, f, dir, m1, m2, rot, wrench)
      integer, intent(in) :: n
      logical, intent(in) :: add                 !! to what wrench holds
      real(wp), intent(in) :: f(BLOCK, 6)
      real(wp), dimension(BLOCK, 9), intent(in) :: dir, m1, m2, rot
      real(wp), intent(inout) :: wrench(:, :)

      real(wp) :: moment
      integer :: i, k

      if (.not. add) wrench(:, :n) = 0.0_wp
      do i = 1, n
         do k = 1, 3
            moment = f(i, 4)*rot(i, k) + f(i, 5)*rot(i, k + 3) + f(i, 6)*rot(i, k + 6)
            wrench(k, i) = wrench(k, i) + f(i, 1)*dir(i, k) + f(i, 2)*dir(i, k + 3) + f(i, 3)*dir(i, k + 6)
            wrench(k + 3, i) = wrench(k + 3, i) + f(i, 1)*m1(i, k) + f(i, 2)*m1(i, k + 3) + f(i, 3)*m1(i, k + 6) + moment
            wrench(k + 6, i) = wrench(k + 6, i) + f(i, 1)*m2(i, k) + f(i, 2)*m2(i, k + 3) + f(i, 3)*m2(i, k + 6) - moment
         end do
      end do
   end subroutine put_wrench

   !> Pass 2 for joints lo..hi: damping forces from the predicted velocities, and the energy that the
   !> second half kick takes with them; wrench of what they change.
   !>
   !> (1 + h/2 C S) (f - f_old) = C B v* - f_old, S = B M^-1 B^T with each body's inverse mass times
   !> its number of joints; for a curve C is its slope at B v* where that is positive. h = 0: f = C B v.
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
            joint%dissipated(from:to) = joint%dissipated(from:to) + 0.5_wp*h*joint%fd(from:to, k)*rate(:n, k)
         end do
      end do
   end subroutine count_damping

   !> Rates of all joints of a batch with the velocities of the poses
   pure subroutine joint_rates(batch, poses, joint, rate)
      type(c_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      type(c_joint_t), intent(in) :: joint
      real(wp), intent(out) :: rate(:, :)        !! (n, 6) J

      real(wp), dimension(BLOCK, 9) :: dir, m1, m2, rot
      real(wp) :: part(BLOCK, 6)
      integer :: from, to, n

      do from = 1, batch%n, BLOCK
         to = min(from + BLOCK - 1, batch%n)
         n = to - from + 1
         dir(:n, :) = joint%dir(from:to, :)
         m1(:n, :) = joint%m1(from:to, :)
         m2(:n, :) = joint%m2(from:to, :)
         rot(:n, :) = joint%rot(from:to, :)
         call rates(batch, poses, from, n, dir, m1, m2, rot, part)
         rate(from:to, :) = part(:n, :)
      end do
   end subroutine joint_rates

   !> q' = B v: translations e.(v2 - v1) - m1.w1 - m2.w2, rotations rot.(w2 - w1)
   pure subroutine rates(batch, poses, from, n, dir, m1, m2, rot, rate)
      type(c_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: from, n
      real(wp), dimension(BLOCK, 9), intent(in) :: dir, m1, m2, rot
      real(wp), intent(out) :: rate(BLOCK, 6)

      real(wp), dimension(BLOCK, 3) :: dv, w1, w2
      integer :: i, j, k

      do k = 1, 3
         do i = 1, n
            j = from + i - 1
            dv(i, k) = poses%v(batch%lead(j, 2), k) - poses%v(batch%lead(j, 1), k)
            w1(i, k) = poses%w(batch%lead(j, 1), k)
            w2(i, k) = poses%w(batch%lead(j, 2), k)
         end do
      end do
      do k = 0, 2
         !$omp simd
         do i = 1, n
            rate(i, 1 + k) = dir(i, 3*k + 1)*dv(i, 1) + dir(i, 3*k + 2)*dv(i, 2) + dir(i, 3*k + 3)*dv(i, 3) - &
               (m1(i, 3*k + 1)*w1(i, 1) + m1(i, 3*k + 2)*w1(i, 2) + m1(i, 3*k + 3)*w1(i, 3)) - &
               (m2(i, 3*k + 1)*w2(i, 1) + m2(i, 3*k + 2)*w2(i, 2) + m2(i, 3*k + 3)*w2(i, 3))
            rate(i, 4 + k) = rot(i, 3*k + 1)*(w2(i, 1) - w1(i, 1)) + rot(i, 3*k + 2)*(w2(i, 2) - w1(i, 2)) + &
               rot(i, 3*k + 3)*(w2(i, 3) - w1(i, 3))
         end do
      end do
   end subroutine rates

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
               s(i, at) = b1(i, 3*k + 1)*j1(i, 3*l + 1) + b1(i, 3*k + 2)*j1(i, 3*l + 2) + b1(i, 3*k + 3)*j1(i, 3*l + 3) + &
                  b2(i, 3*k + 1)*j2(i, 3*l + 1) + b2(i, 3*k + 2)*j2(i, 3*l + 2) + b2(i, 3*k + 3)*j2(i, 3*l + 3)
            end do
         end do
      end do
      at = 0
      do k = 0, 2
         do l = 0, k
            at = at + 1
            !$omp simd
            do i = 1, n
               s(i, at) = s(i, at) + im(i)*(dir(i, 3*k + 1)*dir(i, 3*l + 1) + dir(i, 3*k + 2)*dir(i, 3*l + 2) + &
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
   !> With D = C^1/2 this is D (1 + g D S D)^-1 D^-1: the part of f along a dof without damping stays
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

end module kj_c_force
