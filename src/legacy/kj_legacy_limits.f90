!> Forces of a block of KJOINT2 joints with stops, friction, lock or automatic stiffness, under the
!> legacy formulation: for each dof spring, limits, critical damping, user damping.
!> Source: docs/theory/legacy.md 3.6, 4.
module kj_legacy_limits
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t
   use kj_joint_types, only: joint_types, NDOF, FRAME_CROSS
   use kj_joint_batch, only: joint_batch_t, LAW_SPRING_CURVE, LAW_DAMPER_CURVE, DOF_FREE, &
      DOF_SLIDING, DOF_STICKING, DOF_AT_STOP, DOF_LOCKED, has_friction
   use kj_legacy_joint, only: legacy_block_t, legacy_limit_t
   use kj_block, only: BLOCK
   use kj_nodal_stiffness, only: step_stiffness
   use kj_legacy_law, only: add_spring, add_spring_curve_slope, add_damper, add_damper_curve, &
      add_critical_damping
   use kj_legacy_stop, only: plain_overlap, combined_overlap, add_friction, add_stop, add_lock
   implicit none
   private

   public :: limited_laws

contains

   !> Force of each dof, and the time-step stiffness
   pure subroutine limited_laws(batch, curves, time, h12, from, n, q, qdot, state, limit, f)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: time
      real(wp), intent(in) :: h12                 !! of the cycle before, 0 in the first
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF), qdot(BLOCK, NDOF)
      type(legacy_block_t), intent(inout) :: state
      type(legacy_limit_t), intent(inout) :: limit
      real(wp), intent(out) :: f(BLOCK, NDOF)

      real(wp) :: k_top(BLOCK, 2), c_top(BLOCK, 2), k_eff(BLOCK), cr(BLOCK), cr_top(BLOCK), &
         reach(BLOCK, 2)
      logical :: acts(BLOCK)
      integer :: dof, s, to

      to = from + n - 1
      k_top = 0.0_wp
      c_top = 0.0_wp
      cr_top = 0.0_wp
      f = 0.0_wp
      limit%stored(:n) = 0.0_wp
      call lock_joints(batch, time, from, n, state%q, limit)
      call find_reach(batch, from, n, q, reach)
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         k_eff = 0.0_wp
         acts(:n) = joint_types(batch%row)%free(dof) == 0
         if (joint_types(batch%row)%free(dof) == 0) then
            call add_spring(n, q(:, dof), limit%k_block(:n, s), f(:, dof), k_eff, k_top(:, s))
         else
            call add_elastic(batch, curves, from, n, dof, q(:, dof), f(:, dof), k_eff, k_top(:, s))
            call add_limits(batch, curves, time, h12, from, n, dof, q(:, dof), qdot(:, dof), &
               reach(:, s), limit, f(:, dof), k_eff, k_top(:, s), acts)
         end if
         cr(:n) = merge(batch%limit%cr(from:to), 0.0_wp, acts(:n))
         cr_top(:n) = max(cr_top(:n), cr(:n))
         call add_critical_damping(n, cr, k_eff, batch%reduced(from:to, s), qdot(:, dof), f(:, dof))
         if (joint_types(batch%row)%free(dof) == 0) cycle
         if (iand(batch%law(dof), LAW_DAMPER_CURVE) /= 0) then
            call add_damper_curve(n, curves, batch%c_curve(from:to, dof), batch%c(from:to, dof), &
               qdot(:, dof), f(:, dof), c_top(:, s))
         else
            call add_damper(n, batch%c(from:to, dof), qdot(:, dof), f(:, dof), c_top(:, s))
         end if
      end do
      do s = 1, 2
         call step_stiffness(n, k_top(:, s), c_top(:, s), cr_top, batch%reduced(from:to, s), &
            state%stiff(:n, s))
      end do
   end subroutine limited_laws

   !> Elastic law of a free dof
   pure subroutine add_elastic(batch, curves, from, n, dof, q, f, k_eff, k_top)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, value :: from, n, dof
      real(wp), intent(in) :: q(n)
      real(wp), intent(inout) :: f(n), k_eff(n), k_top(n)

      integer :: to

      to = from + n - 1
      if (iand(batch%law(dof), LAW_SPRING_CURVE) /= 0) then
         call add_spring_curve_slope(n, curves, batch%k_curve(from:to, dof), &
            batch%k(from:to, dof), q, f, k_eff, k_top)
      else
         call add_spring(n, q, batch%k(from:to, dof), f, k_eff, k_top)
      end if
   end subroutine add_elastic

   !> Joints whose sensor has become active keep the q of the cycle before, moved inside the stops.
   !> Legacy quirk: a sensor locks nothing in universal joints.
   pure subroutine lock_joints(batch, time, from, n, q, limit)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: time
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF)     !! of the cycle before
      type(legacy_limit_t), intent(inout) :: limit

      integer :: i, j, dof

      if (batch%frame == FRAME_CROSS) return
      do i = 1, n
         j = from + i - 1
         if (limit%locked(i) > 0.0_wp .or. .not. time > batch%limit%t_lock(j)) cycle
         limit%locked(i) = 1.0_wp
         do dof = 1, NDOF
            associate (held => limit%q_lock(i, dof))
               held = q(i, dof)
               if (batch%limit%lo(j, dof) < 0.0_wp) held = max(held, batch%limit%lo(j, dof))
               if (batch%limit%hi(j, dof) > 0.0_wp) held = min(held, batch%limit%hi(j, dof))
            end associate
         end do
      end do
   end subroutine lock_joints

   !> Distance from the centre of combined stops, of translations and of rotations
   pure subroutine find_reach(batch, from, n, q, reach)
      type(joint_batch_t), intent(in) :: batch
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF)
      real(wp), intent(out) :: reach(BLOCK, 2)

      integer :: i, j, dof, s

      reach = 0.0_wp
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         do i = 1, n
            j = from + i - 1
            reach(i, s) = reach(i, s) + batch%limit%combined(j, dof)* &
               (q(i, dof) - 0.5_wp*(batch%limit%lo(j, dof) + batch%limit%hi(j, dof)))**2
         end do
      end do
      reach(:n, :) = sqrt(reach(:n, :))
   end subroutine find_reach

   !> Friction, stop and lock of one free dof
   pure subroutine add_limits(batch, curves, time, h12, from, n, dof, q, qdot, reach, limit, f, &
      k_eff, k_top, acts)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: time, h12
      integer, value :: from, n, dof
      real(wp), intent(in) :: q(n), qdot(n), reach(n)
      type(legacy_limit_t), intent(inout) :: limit
      real(wp), intent(inout) :: f(n), k_eff(n), k_top(n)
      logical, intent(inout) :: acts(n)

      real(wp) :: over(BLOCK), direction(BLOCK), way(BLOCK)
      logical :: nearby(BLOCK), slides(BLOCK), rubs(BLOCK), locked(BLOCK)
      integer :: to, s

      to = from + n - 1
      s = merge(1, 2, dof <= 3)
      way(:n) = qdot*h12
      associate (l => batch%limit, k_block => limit%k_block(:n, s))
         call plain_overlap(n, q, l%lo(from:to, dof), l%hi(from:to, dof), over, direction, nearby)
         call combined_overlap(n, q, l%lo(from:to, dof), l%hi(from:to, dof), &
            l%combined(from:to, dof), reach, over, direction, nearby)
         rubs(:n) = has_friction(l%k(from:to, dof), l%slip(from:to, dof), &
            l%slip_curve(from:to, dof))
         call add_friction(n, curves, l%slip_curve(from:to, dof), l%k(from:to, dof), &
            l%slip(from:to, dof), l%combined(from:to, dof), over, direction, q, way, &
            limit%friction(:n, dof), f, k_eff, k_top, limit%slip_energy(:n), slides, acts)
         where (rubs(:n)) limit%stored(:n) = limit%stored(:n) + &
            0.5_wp*limit%friction(:n, dof)**2/l%k(from:to, dof)
         call add_stop(n, rubs, l%k(from:to, dof), k_block, over, direction, nearby, f, k_eff, &
            k_top, limit%stored(:n), acts)
         locked(:n) = limit%locked(:n) > 0.0_wp .and. time < l%t_free(from:to)
         call add_lock(n, locked, k_block, q, limit%q_lock(:n, dof), f, k_eff, k_top, &
            limit%stored(:n), acts)
      end associate
      limit%flag(:n, dof) = DOF_FREE
      where (rubs(:n)) limit%flag(:n, dof) = merge(DOF_SLIDING, DOF_STICKING, slides(:n))
      where (abs(over(:n)) > 0.0_wp) limit%flag(:n, dof) = DOF_AT_STOP
      where (locked(:n)) limit%flag(:n, dof) = DOF_LOCKED
   end subroutine add_limits

end module kj_legacy_limits
