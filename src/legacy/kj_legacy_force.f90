!> Forces of one batch of joints under the legacy formulation: frame, laws of six dofs, wrench on
!> the two ends. Blocks of BLOCK joints; joints are independent, so the bits do not depend on how
!> the range is cut.
!> Limited batches have their laws in kj_legacy_limits. Source: docs/theory/legacy.md 3.5 to 3.7.
module kj_legacy_force
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t
   use kj_joint_types, only: NDOF, FRAME_MEAN, FRAME_CROSS
   use kj_joint_batch, only: joint_batch_t, KJOINT2, LAW_SPRING_CURVE, LAW_DAMPER_CURVE
   use kj_block, only: BLOCK, block_of, lane_of, group_of, turn_frames, turn_axes, cross_frames, &
      to_local, to_world, add_cross
   use kj_nodal_stiffness, only: step_stiffness
   use kj_lead_map, only: W_FORCE, W_MOMENT1, W_MOMENT2, W_KN1, W_KN2, W_KR1, W_KR2
   use kj_legacy_joint, only: legacy_block_t, legacy_joint_t, group_at
   use kj_legacy_law, only: add_spring_and_damper, add_spring_curve, add_damper_curve
   use kj_legacy_limits, only: limited_laws
   implicit none
   private

   public :: add_joint_forces, world_t

   !> What joints see of the scene; leads are bodies (their main node) and free nodes
   type :: world_t
      real(wp) :: time = 0.0_wp
      real(wp) :: h12 = 0.0_wp                   !! mean of the steps before and after the last time
      real(wp), allocatable :: x(:, :)           !! (n_node, 3) positions, leads first, W
      real(wp), allocatable :: w(:, :)           !! (n_lead, 3) angular velocities, W
      real(wp), allocatable :: skew(:, :)        !! (0:n_skew, 9) axes of the skews, W
   end type world_t

contains

   !> Joints lo..hi of a batch: new frame, displacements, forces, energy and wrench. lo is the first
   !> joint of a block.
   subroutine add_joint_forces(batch, curves, world, h, keep_rates, lo, hi, joint, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: h                  !! step since the last call, 0 in the first
      logical, intent(in) :: keep_rates          !! store qdot, for a sample
      integer, intent(in) :: lo, hi
      type(legacy_joint_t), target, intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)   !! (N_WRENCH, all joints)

      type(legacy_block_t), pointer :: state
      integer :: from, n

      from = lo
      do while (from <= hi)
         n = min(BLOCK, hi - from + 1)
         if (batch%n < BLOCK .and. .not. batch%limited) n = group_of(n)
         call group_at(joint%block(block_of(from)), lane_of(from), state)
         select case (n)
         case (1)
            call add_block(batch, curves, world, h, keep_rates, from, 1, state, joint, wrench)
         case (2)
            call add_block(batch, curves, world, h, keep_rates, from, 2, state, joint, wrench)
         case (3)
            call add_block(batch, curves, world, h, keep_rates, from, 3, state, joint, wrench)
         case (4)
            call add_block(batch, curves, world, h, keep_rates, from, 4, state, joint, wrench)
         case (8)
            call add_block(batch, curves, world, h, keep_rates, from, 8, state, joint, wrench)
         case default
            call add_block(batch, curves, world, h, keep_rates, from, n, state, joint, wrench)
         end select
         from = from + n
      end do
   end subroutine add_joint_forces

   pure subroutine add_block(batch, curves, world, h, keep_rates, from, n, state, joint, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: h
      logical, intent(in) :: keep_rates
      integer, value :: from, n                  !! first joint, joints
      type(legacy_block_t), target, intent(inout) :: state     !! from these joints on
      type(legacy_joint_t), target, intent(inout) :: joint     !! its blocks are not touched
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      real(wp) :: e(BLOCK, 9), xl(BLOCK, 3), turn(BLOCK, 3), q(BLOCK, NDOF), qdot(BLOCK, NDOF)
      real(wp) :: f(BLOCK, NDOF), change
      logical :: idle(NDOF)
      integer :: i, j, k, at

      at = (from - 1)/BLOCK + 1
      idle = batch%law == 0 .and. .not. batch%limited
      call move_frames(batch, world, h, from, n, state, e, xl, turn)
      do k = 1, 3
         do i = 1, n
            j = from + i - 1
            q(i, k) = xl(i, k) - batch%xl0(j, k)
            q(i, k + 3) = state%q(i, k + 3) + turn(i, k)*h
         end do
      end do
      do k = 1, NDOF
         do i = 1, n
            qdot(i, k) = 0.0_wp
            if (h > 0.0_wp) qdot(i, k) = (q(i, k) - state%q(i, k))/h
         end do
      end do
      if (batch%limited) then
         call limited_laws(batch, curves, world%time, world%h12, from, n, q, qdot, state, &
            joint%limit(at), f)
      else
         call laws(batch, curves, from, n, q, qdot, state, f)
      end if
      do k = 1, NDOF
         if (idle(k)) then                           ! without force, ever
            state%q(:n, k) = q(:n, k)
            cycle
         end if
         do i = 1, n
            change = q(i, k) - state%q(i, k)
            state%energy(i) = state%energy(i) + 0.5_wp*change*(f(i, k) + state%f(i, k))
            state%q(i, k) = q(i, k)
            state%f(i, k) = f(i, k)
         end do
      end do
      if (keep_rates) state%qdot(:n, :) = qdot(:n, :)
      call put_wrench(batch, world, from, n, state, e, xl, f, wrench(:, batch%first + from:))
   end subroutine add_block

   !> New frames, offset of node 2 in them, and relative angular velocity in them
   pure subroutine move_frames(batch, world, h, from, n, state, e, xl, turn)
      type(joint_batch_t), intent(in) :: batch
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: h
      integer, value :: from, n
      type(legacy_block_t), intent(inout) :: state
      real(wp), intent(out) :: e(BLOCK, 9), xl(BLOCK, 3), turn(BLOCK, 3)

      real(wp) :: dual(BLOCK, 9), r(BLOCK, 3), dw(BLOCK, 3), a(BLOCK, 3), b(BLOCK, 3)
      integer :: i, j, k

      do k = 1, 3
         do i = 1, n
            j = from + i - 1
            r(i, k) = world%x(batch%node(j, 2), k) - world%x(batch%node(j, 1), k)
            dw(i, k) = world%w(batch%lead(j, 2), k) - world%w(batch%lead(j, 1), k)
            a(i, k) = 0.5_wp*h*(world%w(batch%lead(j, 1), k) + world%w(batch%lead(j, 2), k))
         end do
      end do
      select case (batch%frame)
      case (FRAME_MEAN)
         e(:n, :) = state%e(:n, :)
         call turn_frames(n, a, e)
      case (FRAME_CROSS)
         if (batch%kind == KJOINT2) then
            call turn_own_axes(batch, world, h, from, n, state, a, b)
         else
            do k = 1, 3
               a(:n, k) = world%skew(batch%skew(from:from + n - 1, 1), k)
               b(:n, k) = world%skew(batch%skew(from:from + n - 1, 2), k)
            end do
         end if
         call cross_frames(n, a, b, e, dual)
      case default   ! FRAME_FIRST
         do k = 1, 9
            e(:n, k) = world%skew(batch%skew(from:from + n - 1, 1), k)
         end do
      end select
      state%e(:n, :) = e(:n, :)
      if (batch%frame == FRAME_CROSS) then
         call to_local(n, dual, r, xl)
         call to_local(n, dual, dw, turn)
      else
         call to_local(n, e, r, xl)
         call to_local(n, e, dw, turn)
      end if
   end subroutine move_frames

   !> Axes of universal KJOINT2, which turn with their bodies by themselves
   pure subroutine turn_own_axes(batch, world, h, from, n, state, u, v)
      type(joint_batch_t), intent(in) :: batch
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: h
      integer, value :: from, n
      type(legacy_block_t), intent(in) :: state
      real(wp), intent(out) :: u(BLOCK, 3), v(BLOCK, 3)

      real(wp) :: w1(BLOCK, 3), w2(BLOCK, 3)
      integer :: i, k

      do k = 1, 3
         do i = 1, n
            u(i, k) = state%e(i, 3 + k)
            v(i, k) = state%e(i, 6 + k)
            w1(i, k) = world%w(batch%lead(from + i - 1, 1), k)
            w2(i, k) = world%w(batch%lead(from + i - 1, 2), k)
         end do
      end do
      call turn_axes(n, h, w1, u)
      call turn_axes(n, h, w2, v)
   end subroutine turn_own_axes

   !> Force of each dof; renews the time-step stiffness where a curve can change it
   pure subroutine laws(batch, curves, from, n, q, qdot, state, f)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF), qdot(BLOCK, NDOF)
      type(legacy_block_t), intent(inout) :: state
      real(wp), intent(out) :: f(BLOCK, NDOF)

      real(wp) :: k_top(BLOCK, 2), c_top(BLOCK, 2), zero(BLOCK)
      logical :: renew
      integer :: dof, s, to

      to = from + n - 1
      renew = any(batch%law >= LAW_SPRING_CURVE)
      if (renew) then
         zero(:n) = 0.0_wp
         k_top(:n, :) = batch%k_top(from:to, :)
         c_top(:n, :) = batch%c_top(from:to, :)
      end if
      do dof = 1, NDOF
         f(:n, dof) = 0.0_wp
         if (batch%law(dof) == 0) cycle
         s = merge(1, 2, dof <= 3)
         if (iand(batch%law(dof), LAW_SPRING_CURVE + LAW_DAMPER_CURVE) == 0) then
            call add_spring_and_damper(n, q(:, dof), qdot(:, dof), batch%k(from:to, dof), &
               batch%c(from:to, dof), f(:, dof))
            cycle
         end if
         if (iand(batch%law(dof), LAW_SPRING_CURVE) /= 0) then
            call add_spring_curve(n, curves, batch%k_curve(from:to, dof), batch%k(from:to, dof), &
               batch%reduced(from:to, s), q(:, dof), qdot(:, dof), f(:, dof), k_top(:, s))
         else
            call add_spring_and_damper(n, q(:, dof), zero, batch%k(from:to, dof), zero, f(:, dof))
         end if
         if (iand(batch%law(dof), LAW_DAMPER_CURVE) /= 0) then
            call add_damper_curve(n, curves, batch%c_curve(from:to, dof), batch%c(from:to, dof), &
               qdot(:, dof), f(:, dof), c_top(:, s))
         else
            call add_spring_and_damper(n, zero, qdot(:, dof), zero, batch%c(from:to, dof), &
               f(:, dof))
         end if
      end do
      if (.not. renew) return
      do s = 1, 2
         call step_stiffness(n, k_top(:, s), c_top(:, s), batch%cr(from:to), &
            batch%reduced(from:to, s), state%stiff(:n, s))
      end do
   end subroutine laws

   !> Force and moments on the leads, and the stiffness they feel.
   !>
   !>   F = E f,  c = 1/2 XL x f,  moment at node 1: E (m + c), at node 2: -E (m - c)
   pure subroutine put_wrench(batch, world, from, n, state, e, xl, f, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(world_t), intent(in) :: world
      integer, value :: from, n
      type(legacy_block_t), intent(in) :: state
      real(wp), intent(in) :: e(BLOCK, 9), xl(BLOCK, 3), f(BLOCK, NDOF)
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      real(wp) :: force(BLOCK, 3), m(BLOCK, 3), m1(BLOCK, 3), m2(BLOCK, 3)
      real(wp) :: arm1(BLOCK, 3), arm2(BLOCK, 3), st, lever
      integer :: i, j, k

      call to_world(n, e, f(:, 1:3), force)
      m(:n, :) = f(:n, 4:6)
      call add_cross(n, 0.5_wp, xl, f(:, 1:3), m)
      call to_world(n, e, m, m1)
      m(:n, :) = -f(:n, 4:6)
      call add_cross(n, 0.5_wp, xl, f(:, 1:3), m)
      call to_world(n, e, m, m2)
      do k = 1, 3
         do i = 1, n
            j = from + i - 1
            arm1(i, k) = world%x(batch%node(j, 1), k) - world%x(batch%lead(j, 1), k)
            arm2(i, k) = world%x(batch%node(j, 2), k) - world%x(batch%lead(j, 2), k)
         end do
      end do
      call add_cross(n, 1.0_wp, arm1, force, m1)
      call add_cross(n, -1.0_wp, arm2, force, m2)
      do i = 1, n
         st = state%stiff(i, 1)
         lever = state%stiff(i, 2) + st*(xl(i, 1)**2 + xl(i, 2)**2 + xl(i, 3)**2)
         wrench(W_FORCE:W_FORCE + 2, i) = force(i, :)
         wrench(W_MOMENT1:W_MOMENT1 + 2, i) = m1(i, :)
         wrench(W_MOMENT2:W_MOMENT2 + 2, i) = m2(i, :)
         wrench(W_KN1, i) = 2.0_wp*st
         wrench(W_KN2, i) = 2.0_wp*st
         wrench(W_KR1, i) = lever + 2.0_wp*st*(arm1(i, 1)**2 + arm1(i, 2)**2 + arm1(i, 3)**2)
         wrench(W_KR2, i) = lever + 2.0_wp*st*(arm2(i, 1)**2 + arm2(i, 2)**2 + arm2(i, 3)**2)
      end do
   end subroutine put_wrench

end module kj_legacy_force
