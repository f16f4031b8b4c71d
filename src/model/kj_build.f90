!> Deck -> model: every cross reference and range is checked on this way.
module kj_build
   use kj_kinds, only: wp
   use kj_joint_types, only: FRAME_MEAN, FRAME_CROSS
   use kj_joint_batch, only: KJOINT, SPRING4
   use kj_keywords, only: KW_TITLE
   use kj_deck_text, only: title_of
   use kj_engine, only: engine_t
   use kj_draft, only: draft_t, blocks_of
   use kj_build_scene, only: build_nodes, build_masses, build_curves, build_sensors, &
      check_analysis, build_parts
   use kj_build_axes, only: build_skews, build_frames
   use kj_build_group, only: build_groups
   use kj_transform, only: move_nodes
   use kj_build_body, only: build_bodies
   use kj_build_spring, only: build_spring_properties
   use kj_build_joint, only: build_joints
   use kj_build_engine, only: act_on_velocities, act_on_conditions
   use kj_build_load, only: build_velocities, carry_secondaries, build_conditions, build_gravity, &
      build_cloads, build_motions
   use kj_build_request, only: build_requests
   use kj_model, only: model_t, SCALE_NONE, SCALE_MASS, SCALE_MASS_NEXT, STOP_BELOW
   implicit none
   private

   public :: build_model

   real(wp), parameter :: DEFAULT_FACTOR = real(0.90, wp)   !! of the nodal step, single precision

contains

   !> The model of a deck; usable when draft%deck%findings%n_error is 0 afterwards
   !>
   !> All blocks are checked, whatever is wrong with those before them.
   subroutine build_model(draft, engine, model, legacy)
      type(draft_t), intent(inout) :: draft      !! with a deck that was read
      type(engine_t), intent(in) :: engine
      type(model_t), intent(out) :: model
      logical, intent(in), optional :: legacy    !! unit factors as OpenRadioss has them; .false.

      integer, allocatable :: blocks(:)

      if (present(legacy)) draft%legacy = legacy
      model%title = ''
      blocks = blocks_of(draft%deck, KW_TITLE)
      if (size(blocks) > 0) model%title = title_of(draft%deck, blocks(1))
      model%units = draft%deck%work
      call check_analysis(draft%deck)
      call build_nodes(draft)
      call build_parts(draft)
      call move_nodes(draft)
      call build_skews(draft)
      call build_frames(draft)
      call build_groups(draft)
      call build_masses(draft)
      call build_curves(draft)
      call build_sensors(draft)
      call build_spring_properties(draft)
      call build_bodies(draft, model)
      call build_velocities(draft, model)
      if (allocated(engine%acts)) call act_on_velocities(draft, engine%acts, model)
      call carry_secondaries(model)
      call build_joints(draft, model)
      call build_conditions(draft, model)
      if (allocated(engine%acts)) call act_on_conditions(draft, engine%acts, model)
      call build_gravity(draft, model)
      call build_cloads(draft, model)
      call build_motions(draft, model)
      call build_requests(draft, model)
      if (draft%deck%findings%n_error > 0) return
      call finish_skews(draft, model)
      model%curves = draft%curves
      call set_controls(engine, model)
   end subroutine build_model

   !> Skews with model node indices; those that the cycle must renew
   subroutine finish_skews(draft, model)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model

      logical :: used(0:draft%skews%n)
      integer :: i, k

      model%skews = draft%skews
      used = .false.
      do i = 1, size(model%batch)
         if (model%batch(i)%frame == FRAME_MEAN) cycle
         used(model%batch(i)%skew(:, 1)) = .true.
         if (model%batch(i)%frame == FRAME_CROSS) used(model%batch(i)%skew(:, 2)) = .true.
      end do
      used(model%bcs%skew) = .true.
      used(model%gravity%skew) = .true.
      used(model%cload%skew) = .true.
      used(model%motion%skew) = .true.
      used(model%th_node_skew) = .true.
      do i = 1, model%skews%n
         if (model%skews%dir(i) == 0) cycle
         do k = 1, 3
            model%skews%node(k, i) = draft%new(draft%skews%node(k, i))
         end do
      end do
      model%skews%needed = pack([(i, i=1, model%skews%n)], used(1:) .and. model%skews%dir > 0)
   end subroutine finish_skews

   !> Engine deck -> controls
   subroutine set_controls(engine, model)
      type(engine_t), intent(in) :: engine
      type(model_t), intent(inout) :: model

      associate (c => model%control)
         c%t_stop = engine%t_stop
         if (engine%has_tfile) c%sample = engine%th_dt
         if (engine%print_every /= 0) c%print_every = abs(engine%print_every)
         c%run_number = engine%run_number
         if (engine%stop_energy > 0.0_wp) c%stop_energy = engine%stop_energy
         c%stop_saves = engine%stop_saves
         c%checkpoint = engine%checkpoint
         if (engine%checkpoint_cycles > 0) c%checkpoint_cycles = engine%checkpoint_cycles
         c%dt_factor = DEFAULT_FACTOR
         if (engine%has_dt) then
            if (engine%dt_fac > 0.0_wp) c%dt_factor = engine%dt_fac
            c%dt_min = engine%dt_min
         end if
         if (len_trim(engine%noda) > 0) then
            if (engine%noda_fac > 0.0_wp) c%dt_factor = engine%noda_fac
            if (engine%noda_min > 0.0_wp) c%dt_min = engine%noda_min
         end if
         select case (engine%noda)
         case ('CST'); c%below_min = SCALE_MASS
         case ('CST1'); c%below_min = SCALE_MASS_NEXT
         case ('STOP'); c%below_min = STOP_BELOW
         case default; c%below_min = SCALE_NONE
         end select
         c%nodal_step = any(model%batch%kind == KJOINT) .or. len_trim(engine%noda) > 0
         c%joint_step = any(model%batch%kind /= SPRING4) .and. .not. c%nodal_step
         c%element_step = len_trim(engine%noda) == 0
         if (.not. engine%has_dtix) return
         c%dt_ini = engine%dtix_ini
         if (engine%dtix_max > 0.0_wp) c%dt_max = engine%dtix_max
      end associate
   end subroutine set_controls

end module kj_build
