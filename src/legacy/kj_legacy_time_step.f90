!> The nodal time step of the legacy scheme.
!> Source: docs/theory/legacy.md 7.
module kj_legacy_time_step
   use kj_kinds, only: wp
   use kj_joint_batch, only: SPRING4, is_spring
   use kj_block, only: block_of, lane_of
   use kj_model, only: model_t, SCALE_MASS, SCALE_MASS_NEXT, STOP_BELOW
   use kj_snapshot, only: OWNER_NONE, OWNER_NODE, OWNER_BODY, OWNER_JOINT
   use kj_legacy_state, only: legacy_state_t, NO_LIMIT, GROWTH
   implicit none
   private

   public :: choose_step, least_ratio, line_rule

contains

   !> h2, h_old and h12 of this cycle from the nodal stiffness; may add mass (/DT/NODA/CST)
   subroutine choose_step(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: limit, nodal

      limit = NO_LIMIT
      state%owner_kind = OWNER_NONE
      call limit_springs(model, state, limit)
      if (model%control%nodal_step) then
         nodal = min(nodal_limit(model, state), state%idle_limit)
         select case (model%control%below_min)
         case (SCALE_MASS)
            if (nodal < model%control%dt_min) then
               call add_mass(model, state)
               nodal = min(limit, model%control%dt_min)
            end if
         case (SCALE_MASS_NEXT)
            if (nodal < model%control%dt_min) call add_mass(model, state)
         case (STOP_BELOW)
            state%ended = nodal < model%control%dt_min
         end select
         limit = min(limit, nodal)
      else if (model%control%joint_step) then
         limit = min(limit, nodal_limit(model, state))
      end if
      if (limit >= NO_LIMIT) state%owner_kind = OWNER_NONE
      state%h2 = min(limit, GROWTH*state%h_old, model%control%dt_max)
      if (state%h2 < limit) state%owner_kind = OWNER_NONE
      state%h_old = state%h2
      state%h12 = 0.5_wp*(state%h1 + state%h2)
   end subroutine choose_step

   !> fac min sqrt(2 m/k) over leads with mass, and sqrt(2 I/k_r) over leads with inertia; finds the
   !> owner of the step, too
   real(wp) function nodal_limit(model, state) result(limit)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state   !! least_ratio and its lead are known

      integer :: piece

      limit = NO_LIMIT
      state%owner = 0
      if (size(state%least) > 0) then
         piece = minloc(state%least, dim=1)
         state%owner = state%least_at(piece)
         if (state%least(piece) < 0.25_wp*huge(1.0_wp)) &
            limit = model%control%dt_factor*sqrt(2.0_wp*state%least(piece))
      end if
      state%owner_kind = merge(OWNER_BODY, OWNER_NODE, state%owner <= model%n_body)
      if (state%owner == 0) state%owner_kind = OWNER_NONE
   end function nodal_limit

   !> TYPE4 springs have the step of their element: without /DT/NODA, and where a joint brings the
   !> nodal step in, in cycle 0 still
   pure logical function line_rule(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state

      line_rule = model%control%element_step .and. &
         (state%cycle == 0 .or. .not. model%control%nodal_step)
   end function line_rule

   !> The steps of springs by themselves, where the nodal step is off: of TYPE4 that of the element;
   !> of the others it counts if it is longer than what their leads allow
   pure subroutine limit_springs(model, state, limit)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      real(wp), intent(inout) :: limit

      real(wp) :: h
      integer :: b, i

      if (.not. (line_rule(model, state) .or. model%control%joint_step)) return
      do b = 1, size(model%batch)
         if (.not. is_spring(model%batch(b))) cycle
         if (model%batch(b)%kind /= SPRING4 .and. model%control%nodal_step) cycle
         do i = 1, model%batch(b)%n
            associate (joint => state%joint(b)%spring(block_of(i)), &
               lead => model%batch(b)%lead(i, :))
               h = joint%step(lane_of(i))
               if (h >= huge(1.0_wp)) cycle
               h = model%control%dt_factor*h
               if (model%batch(b)%kind /= SPRING4) h = max(h, min(step_of(lead(1)), &
                  step_of(lead(2))))
            end associate
            limit = min(limit, h)
         end do
      end do
   contains
      !> What a lead allows
      pure real(wp) function step_of(lead)
         integer, intent(in) :: lead

         step_of = 2.0_wp*state%mass(lead)/state%kn(lead)
         if (state%inertia(lead) > 0.0_wp) step_of = min(step_of, &
            2.0_wp*state%inertia(lead)/state%kr(lead))
         step_of = model%control%dt_factor*sqrt(step_of)
      end function step_of
   end subroutine limit_springs

   !> The least m/k and I/k_r of leads lo..hi, and the first lead that has it (0 = none); the step
   !> of TYPE45 joints is that of the leads that carry them
   pure subroutine least_ratio(model, state, lo, hi, kn, kr, least, at)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: kn(lo:), kr(lo:)   !! stiffness that each lead feels
      real(wp), intent(out) :: least
      integer, intent(out) :: at

      real(wp) :: ratio
      integer :: i

      least = huge(1.0_wp)
      at = 0
      do i = lo, hi
         if (model%control%joint_step .and. .not. state%jointed(i)) cycle
         ratio = huge(1.0_wp)
         if (state%mass(i) > 0.0_wp) ratio = state%mass(i)/kn(i)
         if (state%inertia(i) > 0.0_wp) ratio = min(ratio, state%inertia(i)/kr(i))
         if (ratio < least) then
            least = ratio
            at = i
         end if
      end do
   end subroutine least_ratio

   !> Mass scaling of the leads whose own step lies below dt_min.
   !>
   !> m := 1.00001 k/2 (dt_min/fac)^2, I := max(I, 1.00001 k_r/2 (dt_min/fac)^2); the angular
   !> acceleration of a body shrinks by I_old/I_new, as it is a moment over the nodal inertia.
   subroutine add_mass(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: fac, need
      integer :: i

      fac = model%control%dt_factor
      do i = 1, model%n_lead
         if (state%mass(i) > 0.0_wp) then
            if (fac*sqrt(2.0_wp*state%mass(i)/state%kn(i)) < model%control%dt_min) &
               state%mass(i) = 1.00001_wp*0.5_wp*state%kn(i)*(model%control%dt_min/fac)**2
         end if
         if (state%inertia(i) > 0.0_wp) then
            if (fac*sqrt(2.0_wp*state%inertia(i)/state%kr(i)) >= model%control%dt_min) cycle
            need = max(state%inertia(i), 1.00001_wp*0.5_wp*state%kr(i)* &
               (model%control%dt_min/fac)**2)
            if (i <= model%n_body) state%al(i, :) = state%al(i, :)*(state%inertia(i)/need)
            state%inertia(i) = need
         end if
      end do
   end subroutine add_mass

end module kj_legacy_time_step
