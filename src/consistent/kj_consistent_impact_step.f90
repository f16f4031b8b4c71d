!> Shorter steps where a stop is met and where friction begins.
!>
!> A stop that begins or ends within a step errs by up to (w h)^2/4 of the energy of the impact, w
!> the frequency of the stop; a step near the stable limit, w h = 1.8, would make bounces of any
!> height. So before a stop is reached the step falls to w h = FINE, and stays there until the
!> impact is over.
!>
!> A change of the step shakes what rings at the time: in the mean its energy grows by a factor of
!> (1 + sqrt r)^2/(4 sqrt r), r the ratio of 1 - (w h/2)^2 after and before. That is 1.18 from 0.9
!> of the limit to short steps, 1.005 from half of it. Damping makes good for it; where there is
!> hardly any, a scene whose steps change at every stop takes no more than half.
!>
!> Friction of a joint that starts at speed goes from 0 to its limit within one step, and so misses
!> half a step of its force. So as long as its spring would be wound up in less than two steps, the
!> run starts with steps that take WINDUP of them to do it. Only then: a step that goes up and down
!> for the sake of friction would pump the ringing of blocked directions.
!> Source: docs/theory/time_step.md 8.
module kj_consistent_impact_step
   use kj_kinds, only: wp
   use kj_block, only: block_of, lane_of
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: DOF_STICKING, joint_batch_t
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_stop, only: stop_stiffness
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_safe_step, only: compliances
   implicit none
   private

   public :: contact_t, step_factor, watch_stops, no_stops, stop_frequency, windup_step

   real(wp), parameter :: FINE = 0.05_wp         !! w h while a stop is met: 6e-4 of the energy
   real(wp), parameter :: LASTS = 8.0_wp         !! of 1/w; an impact takes pi to 2 pi of it
   real(wp), parameter :: WINDUP = 10.0_wp       !! steps until friction slides
   real(wp), parameter :: MARGIN = 1.5_wp        !! on the way until the next look
   real(wp), parameter :: CALM_PART = 0.5_wp     !! of the limit
   real(wp), parameter :: LITTLE = 0.01_wp       !! Cr

   !> Stops that are met now, and what they ask for
   type :: contact_t
      real(wp) :: h = huge(1.0_wp)               !! longest step for their sake and that of friction
      real(wp) :: h_stop = huge(1.0_wp)          !! for their sake alone
      real(wp) :: until = -huge(1.0_wp)          !! time at which the last impact is over
      real(wp) :: h_wind = huge(1.0_wp)          !! for friction at the start
      real(wp) :: until_wind = 0.0_wp            !! time at which that is over
   end type contact_t

contains

   !> Fraction of the limit that steps of a scene take: that of its deck; CALM_PART at most where
   !> some joint has a stop and blocked directions of some are hardly damped
   pure real(wp) function step_factor(model) result(factor)
      type(consistent_model_t), intent(in) :: model

      logical :: stops, rings
      integer :: b

      factor = model%control%dt_factor
      stops = .false.
      rings = .false.
      do b = 1, size(model%batch)
         associate (batch => model%batch(b))
            if (batch%limited) stops = stops .or. any(batch%limit%lo < 0.0_wp) .or. &
               any(batch%limit%hi > 0.0_wp)
            if (all(joint_types(batch%row)%free == 1)) cycle
            rings = rings .or. any(batch%cr < LITTLE)
         end associate
      end do
      if (stops .and. rings) factor = min(factor, CALM_PART)
   end function step_factor

   !> Renew what stops and friction ask for, before some steps pass unseen
   subroutine watch_stops(model, state, h, steps, contact)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h                  !! step without them
      integer, intent(in) :: steps               !! until the next look
      type(contact_t), intent(inout) :: contact

      real(wp) :: omega, ahead
      integer :: b, i

      ahead = steps*min(h, 1.0e30_wp)
      if (state%time >= contact%until) contact%h_stop = huge(1.0_wp)
      if (state%cycle == 0) call watch_windup(model, state, h, contact)
      if (state%time >= contact%until_wind) contact%h_wind = huge(1.0_wp)
      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         do i = 1, model%batch(b)%n
            if (.not. meets_stop(model%batch(b), state%joint(b), i, MARGIN*ahead)) cycle
            omega = stop_frequency(model, state, b, i)
            if (.not. omega > 0.0_wp) cycle
            contact%h_stop = min(contact%h_stop, FINE/omega)
            contact%until = max(contact%until, state%time + ahead + LASTS/omega)
         end do
      end do
      contact%h = min(contact%h_stop, contact%h_wind)
   end subroutine watch_stops

   !> Later than at the start: renewing would change nothing
   pure logical function no_stops(model, state, h, steps, contact) result(none)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h                  !! step without them
      integer, intent(in) :: steps               !! until the next look
      type(contact_t), intent(in) :: contact

      integer :: b, i

      none = .not. (contact%h_stop < huge(1.0_wp) .and. state%time >= contact%until) .and. &
         .not. (contact%h_wind < huge(1.0_wp) .and. state%time >= contact%until_wind)
      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         do i = 1, model%batch(b)%n
            if (none) none = .not. meets_stop(model%batch(b), state%joint(b), i, &
               MARGIN*(steps*min(h, 1.0e30_wp)))
         end do
      end do
   end function no_stops

   !> What friction asks for at the start
   subroutine watch_windup(model, state, h, contact)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h                  !! step without it
      type(contact_t), intent(inout) :: contact

      real(wp) :: step
      integer :: b, i

      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         do i = 1, model%batch(b)%n
            step = windup_step(model%batch(b), state%joint(b), i, h)
            if (step >= h) cycle
            contact%h_wind = min(contact%h_wind, step)
            contact%until_wind = max(contact%until_wind, 1.5_wp*WINDUP*step)
         end do
      end do
   end subroutine watch_windup

   !> Step that resolves how friction of joint i at rest comes to its limit; huge when h does
   pure real(wp) function windup_step(batch, joint, i, h) result(step)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_joint_t), intent(in) :: joint
      integer, intent(in) :: i
      real(wp), intent(in) :: h

      real(wp) :: rise
      integer :: dof

      step = huge(1.0_wp)
      associate (limit => joint%limit(block_of(i)), lanes => joint%block(block_of(i)), &
         lane => lane_of(i))
         do dof = 1, NDOF
            if (nint(limit%flag(lane, dof)) /= DOF_STICKING) cycle
            rise = batch%limit%k(i, dof)*abs(lanes%qd(lane, dof))
            if (rise*h > 0.5_wp*limit%grip(lane, dof) .and. limit%grip(lane, dof) > 0.0_wp) &
               step = min(step, limit%grip(lane, dof)/(WINDUP*rise))
         end do
      end associate
   end function windup_step

   !> Joint i is inside its stops and comes to one within the time ahead
   pure logical function meets_stop(batch, joint, i, ahead) result(meets)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_joint_t), intent(in) :: joint
      integer, intent(in) :: i
      real(wp), intent(in) :: ahead

      real(wp) :: q(NDOF)
      integer :: dof, s

      q = joint%block(block_of(i))%q(lane_of(i), :)
      if (batch%geometry%shifted) q(4:6) = q(4:6) + batch%angle0(i, :)
      meets = .true.
      associate (lo => batch%limit%lo(i, :), hi => batch%limit%hi(i, :), &
         in => batch%limit%combined(i, :), &
         rate => joint%block(block_of(i))%qd(lane_of(i), :))
         do dof = 1, NDOF
            if (in(dof) > 0.0_wp) cycle
            if (hi(dof) > 0.0_wp .and. q(dof) <= hi(dof) .and. q(dof) + ahead*rate(dof) > hi(dof)) &
               return
            if (lo(dof) < 0.0_wp .and. q(dof) >= lo(dof) .and. q(dof) + ahead*rate(dof) < lo(dof)) &
               return
         end do
         do s = 1, 4, 3
            if (.not. any(in(s:s + 2) > 0.0_wp)) cycle
            associate (reach => norm2(in(s:s + 2)*(q(s:s + 2) - 0.5_wp*(lo(s:s + 2) + &
               hi(s:s + 2)))), radius => minval(0.5_wp*(hi(s:s + 2) - lo(s:s + 2)), &
               mask=in(s:s + 2) > 0.0_wp))
               if (reach <= radius .and. reach + ahead*norm2(in(s:s + 2)*rate(s:s + 2)) > radius) &
                  return
            end associate
         end do
      end associate
      meets = .false.
   end function meets_stop

   !> Highest frequency of the stops of joint i of batch b, each for itself
   real(wp) function stop_frequency(model, state, b, i) result(omega)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i

      real(wp) :: s(NDOF, NDOF, 2)
      integer :: dof

      omega = 0.0_wp
      call compliances(model, state, b, i, s)
      associate (batch => model%batch(b))
         do dof = 1, NDOF
            if (.not. (batch%limit%lo(i, dof) < 0.0_wp .or. batch%limit%hi(i, dof) > 0.0_wp)) cycle
            omega = max(omega, sqrt(stop_stiffness(batch, i, dof)*(s(dof, dof, 1) + &
               s(dof, dof, 2))))
         end do
      end associate
   end function stop_frequency

end module kj_consistent_impact_step
