!> Forces of the joints of a batch under the consistent formulation: pass 1 of a step, coordinates
!> and
!> springs from the poses. Pass 2, the dampers, is in kj_c_damper.
!> Source: consistent.md 1.
module kj_c_force
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: LAW_SPRING_CURVE, LAW_SPRING
   use kj_joint_frame, only: BLOCK
   use kj_c_batch, only: c_batch_t, c_joint_t, CHART_TWIST, CHART_VECTOR, &
      CHART_UNIVERSAL
   use kj_c_limit, only: add_limits
   use kj_spring, only: spring_axes
   use kj_c_chart, only: relative_pose, twist_chart, vector_chart, universal_chart, first_skew
   implicit none
   private

   public :: poses_t, add_springs, joint_rates, rates, put_wrench

   !> force on end 1, moment about lead 1, about lead 2
   integer, parameter, public :: N_C_WRENCH = 9

   !> What joints see of the leads, joint-independent arrays
   type :: poses_t
      real(wp) :: time = 0.0_wp
      real(wp) :: h = 0.0_wp                      !! step that led here, 0 = none
      real(wp), allocatable :: x(:, :)            !! (n_lead, 3) W
      !> (n_lead, 3) displacement: what joints read, so that a scene may lie far away
      real(wp), allocatable :: d(:, :)
      real(wp), allocatable :: quat(:, :)         !! (n_lead, 4) attitude: world from body axes
      real(wp), allocatable :: v(:, :), w(:, :)   !! (n_lead, 3) velocities; predicted in pass 2
      !> (n_lead, 3) turn in the last step, rotation vector
      real(wp), allocatable :: psi(:, :)
      real(wp), allocatable :: im(:)              !! (n_lead) inverse mass times number of joints
      !> (n_lead, 6) inverse inertia xx yy zz xy xz yz, W, times joints
      real(wp), allocatable :: ij(:, :)
   end type poses_t

contains

   !> Pass 1 for joints lo..hi: coordinates, B, spring forces, spring work, rates with the
   !> velocities of the half step; wrench of the springs and of the dampers as they were
   pure subroutine add_springs(batch, curves, poses, lo, hi, joint, wrench)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: lo, hi
      type(c_joint_t), intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)   !! (N_C_WRENCH, all joints)

      real(wp), dimension(BLOCK, 9) :: e, dir, m1, m2, rot, rot_d
      real(wp) :: q(BLOCK, 6), f(BLOCK, 6), ortho(BLOCK), lost(BLOCK), change
      integer :: from, to, n, i, k

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         n = to - from + 1
         q(:n, :) = joint%q(from:to, :)
         call coordinates(batch, poses, from, n, q, e, dir, m1, m2, rot, rot_d, ortho)
         call laws(batch, curves, poses, from, n, q, joint, f, lost)
         do k = 1, NDOF
            do i = 1, n
               change = q(i, k) - joint%q(from + i - 1, k)
               joint%elastic(from + i - 1) = joint%elastic(from + i - 1) + &
                  0.5_wp*change*(f(i, k) + joint%fe(from + i - 1, k))
            end do
         end do
         if (batch%limited) then
            joint%elastic(from:to) = joint%elastic(from:to) - lost(:n)
            joint%dissipated(from:to) = joint%dissipated(from:to) + lost(:n)
         end if
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

   !> Forces of springs and limits; joint holds the coordinates of the last step
   pure subroutine laws(batch, curves, poses, from, n, q, joint, f, lost)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: from, n
      real(wp), intent(in) :: q(BLOCK, 6)
      type(c_joint_t), intent(inout) :: joint
      real(wp), intent(out) :: f(BLOCK, 6), lost(BLOCK)

      real(wp) :: now(BLOCK, 6), before(BLOCK, 6)
      integer :: k, to

      if (.not. (batch%shifted .or. batch%limited)) then
         do k = 1, NDOF
            call spring(batch, curves, from, n, k, q(:, k), f(:, k))
         end do
         return
      end if
      to = from + n - 1
      now(:n, :) = q(:n, :)
      before(:n, :) = joint%q(from:to, :)
      if (batch%shifted) then
         now(:n, 4:6) = now(:n, 4:6) + batch%shift(from:to, :)
         before(:n, 4:6) = before(:n, 4:6) + batch%shift(from:to, :)
      end if
      do k = 1, NDOF
         call spring(batch, curves, from, n, k, now(:, k), f(:, k))
      end do
      if (batch%limited) call add_limits(batch, curves, poses%time, poses%h, from, n, before, now, &
         joint, f, lost)
   end subroutine laws

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
            r(i, k) = batch%apart(from + i - 1, k) + (poses%d(batch%lead(from + i - 1, 2), k) - &
               poses%d(batch%lead(from + i - 1, 1), k)) + (arm2(i, k) - arm1(i, k))
         end do
      end do
      call relative_pose(n, q1, q2, c1, c2, t1, t2, p)
      ortho = 0.0_wp
      if (batch%spring) then
         dir(:n, :) = batch%axes(from:to, :)
         call spring_axes(n, batch%frame, dir, t1, t2, r, e, m1, m2)
      else if (.not. batch%mean) then
         call first_skew(n, t1, r, e, m1, m2)
      end if
      select case (batch%chart)
      case (CHART_TWIST)
         call twist_chart(n, batch%mean, t1, p, r, q(:, 4:6), e, m1, m2, rot)
         rot_d(:n, :) = rot(:n, :)
      case (CHART_VECTOR)
         plain(:n) = batch%plain(from:to)
         call vector_chart(n, batch%mean, plain, t1, p, r, q(:, 4:6), e, m1, m2, rot, rot_d)
      case (CHART_UNIVERSAL)
         ortho(:n) = batch%angle0(from:to)
         a(:n, 1) = ortho(:n)
         call universal_chart(n, t1, t2, r, a(:, 1), q(:, 4:6), xl, e, rot, m1, m2, ortho)
         rot_d(:n, :) = rot(:n, :)
      case default   ! CHART_LINE
         q(:n, 4:6) = 0.0_wp
         rot(:n, :) = 0.0_wp
         rot_d(:n, :) = 0.0_wp
      end select
      dir(:n, :) = e(:n, :)
      if (batch%chart == CHART_UNIVERSAL) dir(:n, :) = rot(:n, :)
      do k = 0, 2
         do i = 1, n
            q(i, k + 1) = dir(i, 3*k + 1)*r(i, 1) + dir(i, 3*k + 2)*r(i, 2) + &
               dir(i, 3*k + 3)*r(i, 3) - &
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
            wrench(k, i) = wrench(k, i) + f(i, 1)*dir(i, k) + f(i, 2)*dir(i, k + 3) + &
               f(i, 3)*dir(i, k + 6)
            wrench(k + 3, i) = wrench(k + 3, i) + f(i, 1)*m1(i, k) + f(i, 2)*m1(i, k + 3) + &
               f(i, 3)*m1(i, k + 6) + moment
            wrench(k + 6, i) = wrench(k + 6, i) + f(i, 1)*m2(i, k) + f(i, 2)*m2(i, k + 3) + &
               f(i, 3)*m2(i, k + 6) - moment
         end do
      end do
   end subroutine put_wrench

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
            rate(i, 1 + k) = dir(i, 3*k + 1)*dv(i, 1) + dir(i, 3*k + 2)*dv(i, 2) + &
               dir(i, 3*k + 3)*dv(i, 3) - &
               (m1(i, 3*k + 1)*w1(i, 1) + m1(i, 3*k + 2)*w1(i, 2) + m1(i, 3*k + 3)*w1(i, 3)) - &
               (m2(i, 3*k + 1)*w2(i, 1) + m2(i, 3*k + 2)*w2(i, 2) + m2(i, 3*k + 3)*w2(i, 3))
            rate(i, 4 + k) = rot(i, 3*k + 1)*(w2(i, 1) - w1(i, 1)) + &
               rot(i, 3*k + 2)*(w2(i, 2) - w1(i, 2)) + &
               rot(i, 3*k + 3)*(w2(i, 3) - w1(i, 3))
         end do
      end do
   end subroutine rates

end module kj_c_force
