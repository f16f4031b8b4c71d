!> What the formulation makes of a scene, before it starts.
module kj_scheme_check
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, ERR_INPUT, SEV_NOTE
   use kj_joint_batch, only: has_friction
   use kj_model, only: model_t, joint_title
   use kj_legacy_warnings, only: warn_legacy
   use kj_consistent_state, only: consistent_model_t
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_march, only: RKMK4
   use kj_scheme, only: scheme_t, note
   implicit none
   private

   public :: check_scene

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

end module kj_scheme_check
