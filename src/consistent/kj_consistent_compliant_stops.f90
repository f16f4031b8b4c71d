!> Steps of the integrator `compliant` that stops and friction ask for: short before a stop is met
!> and while it acts, and while the spring of friction that begins to slide is wound up.
!> Source: docs/theory/compliant.md 5; docs/theory/time_step.md 8.
module kj_consistent_compliant_stops
   use kj_kinds, only: wp
   use kj_block, only: block_of, lane_of
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_impact_step, only: stop_frequency, windup_step
   implicit none
   private

   public :: stop_step

   real(wp), parameter :: FINE = 0.05_wp         !! w h while a stop acts: 6e-4 of the energy
   real(wp), parameter :: APPROACH = 4.0_wp      !! steps to a stop at the rate there is
   real(wp), parameter :: UNAWARE = 4.0_wp   !! w h over FINE of a step that met a stop

contains

   !> Longest next step; late: the last one, h, met a stop and was too long for it
   subroutine stop_step(model, state, h, step, late)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h
      real(wp), intent(out) :: step
      logical, intent(out) :: late

      real(wp) :: tau, fine_step
      integer :: b, i

      step = huge(1.0_wp)
      late = .false.
      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         do i = 1, model%batch(b)%n
            step = min(step, windup_step(model%batch(b), state%joint(b), i, h))
            tau = time_to_stop(model%batch(b), state%joint(b), i)
            if (tau >= APPROACH*h) cycle
            fine_step = stop_frequency(model, state, b, i)
            if (.not. fine_step > 0.0_wp) cycle
            fine_step = FINE/fine_step
            late = late .or. (.not. tau > 0.0_wp .and. h > UNAWARE*fine_step)
            step = min(step, max(fine_step, tau/APPROACH))
         end do
      end do
   end subroutine stop_step

   !> Time in which joint i comes to a stop at the rates of the half step; 0: it is beyond one
   pure real(wp) function time_to_stop(batch, joint, i) result(tau)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_joint_t), intent(in) :: joint
      integer, intent(in) :: i

      real(wp) :: q(NDOF), rate(NDOF), reach, radius
      integer :: dof, s

      q = joint%block(block_of(i))%q(lane_of(i), :)
      rate = joint%block(block_of(i))%qd(lane_of(i), :)
      if (batch%geometry%shifted) q(4:6) = q(4:6) + batch%angle0(i, :)
      tau = huge(1.0_wp)
      associate (lo => batch%limit%lo(i, :), hi => batch%limit%hi(i, :), &
         in => batch%limit%combined(i, :))
         do dof = 1, NDOF
            if (in(dof) > 0.0_wp) cycle
            if (hi(dof) > 0.0_wp) tau = min(tau, time_of(hi(dof) - q(dof), rate(dof)))
            if (lo(dof) < 0.0_wp) tau = min(tau, time_of(q(dof) - lo(dof), -rate(dof)))
         end do
         do s = 1, 4, 3
            if (.not. any(in(s:s + 2) > 0.0_wp)) cycle
            reach = norm2(in(s:s + 2)*(q(s:s + 2) - 0.5_wp*(lo(s:s + 2) + hi(s:s + 2))))
            radius = minval(0.5_wp*(hi(s:s + 2) - lo(s:s + 2)), mask=in(s:s + 2) > 0.0_wp)
            tau = min(tau, time_of(radius - reach, norm2(in(s:s + 2)*rate(s:s + 2))))
         end do
      end associate
   end function time_to_stop

   !> Time in which a gap closes
   pure real(wp) function time_of(gap, rate) result(tau)
      real(wp), intent(in) :: gap, rate

      tau = huge(1.0_wp)
      if (.not. gap > 0.0_wp) then
         tau = 0.0_wp
      else if (rate*huge(1.0_wp) > gap .and. rate > 0.0_wp) then
         tau = gap/rate
      end if
   end function time_of

end module kj_consistent_compliant_stops
