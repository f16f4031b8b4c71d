!> What the formulation makes of a scene, before it starts.
module kj_scheme_check
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, ERR_INPUT, SEV_NOTE, add_finding, str, &
      SEV_WARNING
   use kj_joint_batch, only: has_friction
   use kj_model, only: model_t, joint_title
   use kj_legacy_warnings, only: warn_legacy
   use kj_consistent_state, only: consistent_model_t
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_march, only: RKMK4
   use kj_consistent_compliant_march, only: solves_a_step
   use kj_scheme, only: scheme_t, note
   use kj_channels, only: OF_JOINT
   use kj_history, only: history_t, entity_title
   use kj_extremes, only: extremes_t
   implicit none
   private

   public :: check_scene, refuse_years, warn_give

   real(wp), parameter :: MOST = 0.01_wp         !! of an arm; as much for a turn [rad]

   real(wp), parameter :: MOST_CYCLES = 1.0e12_wp   !! of a run that is not forced

contains

   !> What the formulation makes of a scene that was just built.
   !>
   !> Errors: ERR_INPUT when it has something that does not go with the formulation or integrator.
   subroutine check_scene(self, model, dt_scale, findings, error)
      type(scheme_t), intent(in) :: self
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: dt_scale          !! fraction of the critical step asked for; 0: none
      type(finding_list_t), intent(inout) :: findings
      type(error_t), allocatable, intent(out) :: error

      if (self%legacy) then
         call warn_legacy(model%model_t, findings)
      else
         if (step_factor(model) < dt_scale) call note(findings, SEV_NOTE, 'KJ-9042', &
            '--dt-scale is 0.5 at most where stops meet joints with hardly any damping')
         if (self%integrator == RKMK4) call refuse_path(model%model_t, error)
      end if
   end subroutine check_scene

   !> Friction and locks hold a state that only whole steps may change: rkmk4 evaluates between them
   subroutine refuse_path(model, error)
      type(model_t), intent(in) :: model
      type(error_t), allocatable, intent(out) :: error

      integer :: j

      do j = 1, model%n_joint
         associate (batch => model%batch(model%joint(j)%batch), place => model%joint(j)%place)
            if (.not. batch%limited) cycle
            associate (l => batch%limit)
               if (.not. (l%t_lock(place) < huge(1.0_wp) .or. any(has_friction(l%k(place, :), &
                  l%slip(place, :), l%slip_curve(place, :))))) cycle
            end associate
            call fail(error, ERR_INPUT, 'joint '//joint_title(model, j)// &
               ' has friction or a lock: these do not go with the integrator rkmk4')
            return
         end associate
      end do
   end subroutine refuse_path

   !> Cycles to the end of a run at the present step; a sample interval takes one at least
   pure real(wp) function cycles_to_go(model, self) result(n)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      real(wp) :: span, interval, h

      span = max(0.0_wp, model%control%t_stop - self%now%time)
      if (self%legacy) then
         interval = span
         h = min(self%cycles%h2, span)
         if (self%now%cycle == 0 .and. model%control%dt_ini > 0.0_wp) h = span   ! it is the first
      else
         interval = span
         if (model%control%sample > 0.0_wp) interval = min(span, model%control%sample)
         h = min(self%march%limit, interval)
      end if
      n = 0.0_wp
      if (span > 0.0_wp) n = solves_a_step(self%march%pace)*span/interval* &
         max(1.0_wp, interval/max(h, tiny(h)))
   end function cycles_to_go

   !> Cycles to the end of a run. Errors: ERR_INPUT beyond MOST_CYCLES, unless the run is forced
   subroutine refuse_years(model, self, force, cycles, error)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self
      logical, intent(in) :: force
      real(wp), intent(out) :: cycles
      type(error_t), allocatable, intent(out) :: error

      character(len=9) :: text

      cycles = cycles_to_go(model, self)
      if (force .or. cycles <= MOST_CYCLES) return
      write (text, '(es9.1)') cycles
      call fail(error, ERR_INPUT, 'the run would take'//text//' cycles, which is years', &
         'KJ-9079')
      error%hint = 'longer steps (a lower Kn), longer intervals of samples, an earlier end, '// &
         'or --force'
   end subroutine refuse_years

   !> One for each joint of the history whose ends moved apart by more than 1 % of its longer
   !> arm, or turned apart by 0.01 rad, in a blocked direction
   subroutine warn_give(model, history, x, findings)
      type(model_t), intent(in) :: model
      type(history_t), intent(in) :: history
      type(extremes_t), intent(in) :: x
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: arm
      integer :: k

      if (.not. allocated(x%give)) return
      do k = 1, size(x%give, 2)
         arm = longer_arm(model, model%joint(model%th_joint(k))%node)
         if (x%give(1, k) > MOST*arm .and. arm > 0.0_wp) then
            call warn(str(nint(min(1.0e9_wp, 100.0_wp*x%give(1, k)/arm)))// &
               ' % of its arm, '//two(x%give(1, k))// &
               ' of '//two(arm))
         else if (x%give(2, k) > MOST) then
            call warn(two(x%give(2, k))//' rad in a blocked rotation')
         end if
      end do

   contains

      subroutine warn(way)
         character(len=*), intent(in) :: way

         type(error_t) :: finding

         finding%severity = SEV_WARNING
         finding%id = 'KJ-9302'
         finding%message = 'joint '//entity_title(history, OF_JOINT, k)//' gave way by '//way
         finding%hint = 'raise Kn, or read the results with that in mind'
         call add_finding(findings, finding)
      end subroutine warn
   end subroutine warn_give

   !> The longer distance of a joint node from the centre of its body; 0 where both are centres
   pure real(wp) function longer_arm(model, node) result(arm)
      type(model_t), intent(in) :: model
      integer, intent(in) :: node(2)

      integer :: e

      arm = 0.0_wp
      do e = 1, 2
         arm = max(arm, norm2(model%x0(node(e), :) - model%x0(model%lead(node(e)), :)))
      end do
   end function longer_arm

   !> Two digits: "4.1E-02"
   pure function two(value) result(text)
      real(wp), intent(in) :: value
      character(len=7) :: text

      write (text, '(es7.1)') value
   end function two

end module kj_scheme_check
