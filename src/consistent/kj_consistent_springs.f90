!> Forces of the joints of a batch under the consistent formulation: pass 1 of a step, coordinates,
!> springs and limits from the poses. Pass 2, the dampers, is in kj_consistent_dampers.
!> One file: what a pass does with a joint, from its ends to its wrench.
!> Source: docs/theory/joints.md 2, 7, 8.
module kj_consistent_springs
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF, FRAME_FIXED, CHART_TWIST, CHART_VECTOR, CHART_UNIVERSAL
   use kj_joint_batch, only: LAW_SPRING_CURVE, LAW_SPRING, is_spring, is_hardened, SPRING13, &
      joint_batch_t
   use kj_block, only: BLOCK, block_of, lane_of, group_of, turn_arm
   use kj_consistent_batch, only: consistent_joint_t, consistent_block_t, matrix_t, &
      in_groups, group_at
   use kj_consistent_matrix, only: poses_t, rates, put_wrench, add_moment
   use kj_consistent_dampers, only: count_damping
   use kj_consistent_hardening, only: hardened_forces
   use kj_consistent_stop, only: add_limits
   use kj_consistent_friction, only: turn_in_frame
   use kj_consistent_chart, only: relative_pose, twist_chart, vector_chart, nearest_vector, &
      first_skew, spring_axes, quaternion_frame, couple
   use kj_consistent_universal, only: universal_chart
   implicit none
   private

   public :: add_springs, turn_balls, coordinates, laws

contains

   !> Pass 1 for joints lo..hi: what the dampers took before the drift (B is still that of then),
   !> coordinates, B, spring forces, spring work, rates with the velocities of the half step; wrench
   !> of springs and limits, and of the dampers as they were.
   !>
   !> lo is the first joint of a block: a multiple of BLOCK, plus 1.
   subroutine add_springs(batch, curves, poses, lo, hi, joint, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: lo, hi
      type(consistent_joint_t), target, intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)   !! (N_CONSISTENT_WRENCH, all joints)

      type(consistent_block_t), pointer :: state
      integer :: from, n

      from = lo
      do while (from <= hi)
         n = min(BLOCK, hi - from + 1)
         if (in_groups(batch)) n = group_of(n)
         call group_at(joint%block(block_of(from)), lane_of(from), state)
         select case (n)
         case (1)
            call springs_of(1, batch, curves, poses, from, state, joint, wrench)
         case (2)
            call springs_of(2, batch, curves, poses, from, state, joint, wrench)
         case (3)
            call springs_of(3, batch, curves, poses, from, state, joint, wrench)
         case (4)
            call springs_of(4, batch, curves, poses, from, state, joint, wrench)
         case (8)
            call springs_of(8, batch, curves, poses, from, state, joint, wrench)
         case (BLOCK)
            call springs_of(BLOCK, batch, curves, poses, from, state, joint, wrench)
         case default
            call springs_of(n, batch, curves, poses, from, state, joint, wrench)
         end select
         from = from + n
      end do
   end subroutine add_springs

   !> The same for n joints of a block, whose first is `from`
   pure subroutine springs_of(n, batch, curves, poses, from, state, joint, wrench)
      integer, value :: n
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, intent(in) :: from
      type(consistent_block_t), target, intent(inout) :: state     !! from these joints on
      type(consistent_joint_t), target, intent(inout) :: joint     !! its blocks are not touched
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      real(wp) :: q(BLOCK, 6), f(BLOCK, 6), rot(BLOCK, 9), moment(BLOCK, 3), lost(BLOCK)
      integer :: at, k, sprung, damped

      sprung = batch%geometry%sprung
      damped = batch%geometry%damped
      at = (from - 1)/BLOCK + 1
      if (damped > 0 .and. poses%h(1) > 0.0_wp) &
         call count_damping(batch, poses%v, poses%w_left, poses%h, from, n, state)
      call coordinates(batch, batch%geometry%ball, poses, from, n, state%q, q, state%b, rot)
      call laws(batch, curves, poses, from, n, q, at, state, joint, f, lost)
      call keep_coordinates(n, sprung, q, f, state)
      if (batch%limited) then
         state%elastic(:n) = state%elastic(:n) - lost(:n)
         state%dissipated(:n) = state%dissipated(:n) + lost(:n)
      end if
      moment(:n, :) = 0.0_wp
      if (batch%geometry%chart == CHART_VECTOR) then
         if (sprung > 3) call add_moment(n, f(:, 4:6), rot, moment)
      else if (sprung > 3) then
         call add_moment(n, f(:, 4:6), state%b%turn, moment)
      end if
      if (damped > 0) then
         call rates(batch, damped, poses%v, poses%w, from, n, state%b, q)
         do k = 1, damped
            state%qd(:n, k) = q(:n, k)
            q(:n, k) = state%fd(:n, k)
            if (batch%limited) q(:n, k) = q(:n, k) + joint%limit(at)%friction(:n, k)
         end do
         f(:n, 1:3) = f(:n, 1:3) + q(:n, 1:3)
         if (damped > 3) call add_moment(n, q(:, 4:6), state%b%turn, moment)
      end if
      call put_wrench(n, batch%abreast, f(:, 1:3), moment, state%b, wrench(:, batch%first + from:))
   end subroutine springs_of

   !> What steps leave out: the axes of the free rotations of balls
   pure subroutine turn_balls(batch, poses, joint)
      type(joint_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses             !! of the coordinates of the joints
      type(consistent_joint_t), intent(inout) :: joint

      real(wp) :: q(BLOCK, 6), rot(BLOCK, 9)
      integer :: from

      if (.not. batch%geometry%ball) return
      do from = 1, batch%n, BLOCK
         associate (lanes => joint%block(block_of(from)))
            call coordinates(batch, .false., poses, from, min(BLOCK, batch%n - from + 1), &
               lanes%q, q, lanes%b, rot)
         end associate
      end do
   end subroutine turn_balls

   !> Keep coordinates and spring forces, and count the work done on the springs
   pure subroutine keep_coordinates(n, sprung, q, f, state)
      integer, value :: n
      integer, intent(in) :: sprung              !! last dof that may have an elastic force: 0, 3, 6
      real(wp), intent(in) :: q(BLOCK, 6), f(BLOCK, 6)
      type(consistent_block_t), intent(inout) :: state

      integer :: i, k

      do k = sprung + 1, NDOF
         state%q(:n, k) = q(:n, k)
      end do
      do k = 1, sprung
         !$omp simd
         do i = 1, n
            state%elastic(i) = state%elastic(i) + &
               0.5_wp*(q(i, k) - state%q(i, k))*(f(i, k) + state%fe(i, k))
            state%q(i, k) = q(i, k)
            state%fe(i, k) = f(i, k)
         end do
      end do
   end subroutine keep_coordinates

   !> Forces of springs, stops and locks, and the friction of the joints and its work
   pure subroutine laws(batch, curves, poses, from, n, q, at, state, joint, f, lost)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(poses_t), intent(in) :: poses
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, 6)
      integer, intent(in) :: at                  !! the block
      type(consistent_block_t), target, intent(inout) :: state   !! with the last coordinates
      type(consistent_joint_t), target, intent(inout) :: joint   !! its blocks are not touched
      real(wp), intent(out) :: f(BLOCK, 6), lost(BLOCK)

      real(wp), dimension(BLOCK, 6) :: now, before, slid, friction
      integer :: k, to

      if (is_hardened(batch)) then
         call hardened_forces(batch, curves, poses%time, poses%h, from, n, q, state, &
            joint%spring(at), f)
         return
      end if
      if (.not. (batch%geometry%shifted .or. batch%limited)) then
         do k = 1, max(3, batch%geometry%sprung)
            call spring(batch, curves, from, n, k, q(:, k), f(:, k))
         end do
         do k = max(3, batch%geometry%sprung) + 1, NDOF
            f(:n, k) = 0.0_wp
         end do
         return
      end if
      to = from + n - 1
      now(:n, :) = q(:n, :)
      before(:n, :) = state%q(:n, :)
      if (batch%geometry%shifted) then
         now(:n, 4:6) = now(:n, 4:6) + batch%angle0(from:to, :)
         before(:n, 4:6) = before(:n, 4:6) + batch%angle0(from:to, :)
      end if
      do k = 1, NDOF
         call spring(batch, curves, from, n, k, now(:, k), f(:, k))
      end do
      if (.not. batch%limited) return
      slid(:n, :) = now(:n, :) - before(:n, :)
      if (batch%geometry%chart == CHART_VECTOR) call turn_in_frame(batch, poses%psi, from, n, &
         state%b%turn, slid)
      friction(:n, :) = joint%limit(at)%friction(:n, :)
      call add_limits(batch, curves, poses%time, poses%h, from, n, before, now, slid, &
         joint%limit(at), f, lost)
      state%elastic(:n) = state%elastic(:n) + 0.5_wp* &
         sum(slid(:n, :)*(friction(:n, :) + joint%limit(at)%friction(:n, :)), dim=2)
   end subroutine laws

   !> Coordinates and B of a block, and the moments on body 1 of unit spring moments where they are
   !> not those of B (CHART_VECTOR); brief: of balls alone, without these moments and those of B
   pure subroutine coordinates(batch, brief, poses, from, n, last, q, b, rot)
      type(joint_batch_t), intent(in) :: batch
      logical, intent(in) :: brief
      type(poses_t), intent(in) :: poses
      integer, value :: from, n
      real(wp), intent(in) :: last(BLOCK, 6)        !! last coordinates
      real(wp), intent(out) :: q(BLOCK, 6)
      type(matrix_t), intent(inout) :: b
      real(wp), intent(out) :: rot(BLOCK, 9)

      real(wp), dimension(BLOCK, 4) :: t1, t2, p
      real(wp), dimension(BLOCK, 3) :: r, arm1, arm2, xl, axis
      real(wp), dimension(BLOCK, 9) :: e
      real(wp), dimension(BLOCK) :: angle, scalar, turns
      real(wp) :: share
      integer :: i, k

      do k = 4, 6
         q(:n, k) = last(:n, k)
      end do
      call see_ends(batch, poses, from, n, t1, t2, p, arm1, arm2, r)
      if (is_spring(batch) .and. batch%kind /= SPRING13) then
         e(:n, :) = batch%frame0(from:from + n - 1, :)
         call spring_axes(n, batch%frame, e, t1, t2, r, b%force, b%couple)
      else if (.not. batch%geometry%mean) then
         call first_skew(n, t1, r, b%force, b%couple)
      end if
      select case (batch%geometry%chart)
      case (CHART_TWIST)
         call twist_chart(n, batch%geometry%mean, t1, p, r, q(:, 4:6), b%force, b%couple, &
            b%turn)
         if (allocated(batch%geometry%rail)) then
            scalar(:n) = batch%geometry%rail(from:from + n - 1)
            call ride_on_rail(n, scalar, t1, t2, p, r, b%turn, b%force, b%couple)
         end if
      case (CHART_VECTOR)
         if (brief) then
            if (batch%geometry%mean) call first_skew(n, t1, r, b%force, b%couple)
            call nearest_vector(n, p, q(:, 4:6), axis, scalar, angle, turns)
         else
            do i = 1, n
               scalar(i) = merge(1.0_wp, 0.0_wp, batch%geometry%plain(from + i - 1))
            end do
            call vector_chart(n, batch%geometry%mean, scalar, t1, p, r, q(:, 4:6), b%force, &
               b%couple, rot, b%turn)
         end if
      case (CHART_UNIVERSAL)
         angle(:n) = batch%geometry%axis_angle(from:from + n - 1)
         call universal_chart(n, t1, t2, r, angle, q(:, 4:6), xl, e, b%force, b%couple, &
            scalar)
         b%turn(:n, :) = b%force(:n, :)
      case default   ! CHART_LINE
         q(:n, 4:6) = 0.0_wp
         b%turn(:n, :) = 0.0_wp
      end select
      do k = 0, 2
         !$omp simd
         do i = 1, n
            q(i, k + 1) = b%force(i, 3*k + 1)*r(i, 1) + b%force(i, 3*k + 2)*r(i, 2) + &
               b%force(i, 3*k + 3)*r(i, 3) - batch%xl0(from + i - 1, k + 1)
         end do
         call add_lever(n, arm1, b%force(:, 3*k + 1:3*k + 3), b%couple(:, 3*k + 1:3*k + 3))
      end do
      ! axes that ride on neither end take no couple
      share = merge(0.0_wp, 1.0_wp, is_spring(batch) .and. (batch%frame == FRAME_FIXED))
      do k = 1, 3
         !$omp simd
         do i = 1, n
            b%apart(i, k) = share*r(i, k) + (arm1(i, k) - arm2(i, k))
         end do
      end do
   end subroutine coordinates

   !> Frame and couples of twist_chart where one body does not turn: the mean of both twists, but
   !> the swing of that body alone. The mean frame would act half way between the nodes, with half
   !> the travel as a lever on the body that turns.
   pure subroutine ride_on_rail(n, rail, t1, t2, p, r, rot, e, a1)
      integer, value :: n
      real(wp), intent(in) :: rail(BLOCK)           !! 1, -1: the swing of body 1, 2; 0: mean frame
      real(wp), intent(in) :: t1(BLOCK, 4), t2(BLOCK, 4)
      real(wp), intent(in) :: p(BLOCK, 4)           !! from twist_chart
      real(wp), intent(in) :: r(BLOCK, 3), rot(BLOCK, 9)
      real(wp), intent(inout) :: e(BLOCK, 9), a1(BLOCK, 9)

      real(wp) :: d1(BLOCK, 9), d2(BLOCK, 9), d(9), y(BLOCK, 3), c, s, half
      integer :: i, k

      call quaternion_frame(n, t1, d1)
      call quaternion_frame(n, t2, d2)
      do i = 1, n
         if (abs(rail(i)) < 0.5_wp) cycle
         d = merge(d1(i, :), d2(i, :), rail(i) > 0.0_wp)
         c = p(i, 1)/sqrt(p(i, 1)**2 + p(i, 2)**2)
         s = sign(1.0_wp, rail(i))*p(i, 2)/sqrt(p(i, 1)**2 + p(i, 2)**2)
         e(i, 1:3) = d(1:3)
         e(i, 4:6) = c*d(4:6) + s*d(7:9)
         e(i, 7:9) = c*d(7:9) - s*d(4:6)
      end do
      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), y)
         do i = 1, n
            if (abs(rail(i)) < 0.5_wp) cycle
            half = 0.5_wp*dot_product(e(i, 1:3), y(i, :))
            if (rail(i) > 0.0_wp) a1(i, k:k + 2) = y(i, :) - half*rot(i, 1:3)
            if (rail(i) < 0.0_wp) a1(i, k:k + 2) = half*rot(i, 1:3)
         end do
      end do
   end subroutine ride_on_rail

   !> Triads and arms carried by the two ends, their relative pose, and node 2 from node 1
   pure subroutine see_ends(batch, poses, from, n, t1, t2, p, arm1, arm2, r)
      type(joint_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      integer, value :: from, n
      real(wp), dimension(BLOCK, 4), intent(out) :: t1, t2, p
      real(wp), dimension(BLOCK, 3), intent(out) :: arm1, arm2, r

      real(wp), dimension(BLOCK, 4) :: q1, q2, c1, c2
      real(wp) :: a1(BLOCK, 3), a2(BLOCK, 3)
      integer :: i, j, k, lead1, lead2

      if (batch%abreast) then
         lead1 = batch%lead(from, 1)
         lead2 = batch%lead(from, 2)
         q1(:n, :) = poses%quat(lead1:lead1 + n - 1, :)
         q2(:n, :) = poses%quat(lead2:lead2 + n - 1, :)
         r(:n, :) = poses%d(lead2:lead2 + n - 1, :) - poses%d(lead1:lead1 + n - 1, :)
      else
         do i = 1, n
            j = from + i - 1
            lead1 = batch%lead(j, 1)
            lead2 = batch%lead(j, 2)
            do k = 1, 4
               q1(i, k) = poses%quat(lead1, k)
               q2(i, k) = poses%quat(lead2, k)
            end do
            do k = 1, 3
               r(i, k) = poses%d(lead2, k) - poses%d(lead1, k)
            end do
         end do
      end if
      do k = 1, 4
         c1(:n, k) = batch%geometry%triad(from:from + n - 1, k)
         c2(:n, k) = batch%geometry%triad(from:from + n - 1, k + 4)
      end do
      do k = 1, 3
         a1(:n, k) = batch%geometry%arm(from:from + n - 1, k)
         a2(:n, k) = batch%geometry%arm(from:from + n - 1, k + 3)
      end do
      call turn_arm(n, q1, a1, arm1)
      call turn_arm(n, q2, a2, arm2)
      do k = 1, 3
         !$omp simd
         do i = 1, n
            r(i, k) = batch%geometry%apart(from + i - 1, k) + r(i, k) + (arm2(i, k) - arm1(i, k))
         end do
      end do
      call relative_pose(n, q1, q2, c1, c2, t1, t2, p)
   end subroutine see_ends

   !> m := m + a x f
   pure subroutine add_lever(n, a, f, m)
      integer, value :: n
      real(wp), intent(in) :: a(BLOCK, 3), f(BLOCK, 3)
      real(wp), intent(inout) :: m(BLOCK, 3)

      integer :: i

      !$omp simd
      do i = 1, n
         m(i, 1) = m(i, 1) + (a(i, 2)*f(i, 3) - a(i, 3)*f(i, 2))
         m(i, 2) = m(i, 2) + (a(i, 3)*f(i, 1) - a(i, 1)*f(i, 3))
         m(i, 3) = m(i, 3) + (a(i, 1)*f(i, 2) - a(i, 2)*f(i, 1))
      end do
   end subroutine add_lever

   !> Elastic force of one dof
   pure subroutine spring(batch, curves, from, n, dof, q, f)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, value :: from, n, dof
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

end module kj_consistent_springs
