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
   use kj_build_load, only: build_velocities, carry_secondaries, build_conditions, build_gravity, &
      build_cloads, build_motions
   use kj_build_request, only: build_requests
   use kj_model, only: model_t, SCALE_NONE, SCALE_MASS, SCALE_MASS_NEXT, STOP_BELOW, bcs_t
   use kj_math3, only: cross
   use kj_error, only: add_at, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, find
   use kj_engine_nodes, only: node_act_t, BY_NODES, BY_RANGES
   use kj_node_list, only: node_list_t, add_node, add_range
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

   !> /INIV: velocities of main and free nodes
   subroutine act_on_velocities(draft, acts, model)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: acts(:)
      type(model_t), intent(inout) :: model

      real(wp) :: a(3, 3), w(3)
      integer, allocatable :: lead(:)
      integer :: i, k, frame

      do i = 1, size(acts)
         if (acts(i)%what /= 'INIV') cycle
         call leads_of(draft, acts(i), model, lead)
         if (acts(i)%axis == 0) then
            do k = 1, size(lead)
               where (acts(i)%dof(:3)) model%v0(lead(k), :) = acts(i)%v(1)
               where (acts(i)%dof(4:)) model%w0(lead(k), :) = acts(i)%v(1)
            end do
            cycle
         end if
         call find_axes(draft, acts(i), draft%frame, 'frame', 'KJ-0490', frame)
         a = reshape(draft%frames%axes(frame, :), [3, 3])
         w = acts(i)%v(4)*a(:, acts(i)%axis)
         do k = 1, size(lead)
            model%w0(lead(k), :) = w
            model%v0(lead(k), :) = matmul(a, acts(i)%v(:3)) + cross(w, model%x0(lead(k), :) - &
               draft%frame_origin(frame, :))
         end do
      end do
   end subroutine act_on_velocities

   !> /BCS holds main and free nodes in more directions, /BCSR releases them
   subroutine act_on_conditions(draft, acts, model)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: acts(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: lead(:)
      integer :: i, k, at, skew

      do i = 1, size(acts)
         if (acts(i)%what == 'INIV') cycle
         call leads_of(draft, acts(i), model, lead)
         call find_axes(draft, acts(i), draft%skew, 'skew', 'KJ-0137', skew)
         do k = 1, size(lead)
            at = findloc(model%bcs%lead, lead(k), 1)
            if (acts(i)%what == 'BCSR') then
               if (at > 0) model%bcs(at)%fixed = model%bcs(at)%fixed .and. .not. acts(i)%dof
               cycle
            end if
            if (at == 0) then
               model%bcs = [model%bcs, bcs_t()]
               at = size(model%bcs)
               model%bcs(at)%lead = lead(k)
               model%bcs(at)%skew = skew
            else if (model%bcs(at)%skew /= skew) then
               call tell(draft, acts(i), SEV_ERROR, 'KJ-0148', 'node '// &
                  str(model%node_id(lead(k)))//' has boundary conditions in two skews', &
                  'another skew')
            end if
            model%bcs(at)%fixed = model%bcs(at)%fixed .or. acts(i)%dof
         end do
      end do
   end subroutine act_on_conditions

   !> Main and free nodes that a card names; those of bodies that follow are left out
   subroutine leads_of(draft, act, model, lead)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: act
      type(model_t), intent(in) :: model
      integer, allocatable, intent(out) :: lead(:)

      type(node_list_t) :: list
      integer :: i, raw

      allocate (list%node(16))
      if (act%by == BY_NODES) then
         do i = 1, size(act%id)
            raw = find(draft%node, act%id(i))
            if (raw > 0) call add_node(raw, list)
            if (raw == 0) call tell(draft, act, SEV_ERROR, 'KJ-0078', 'node '//str(act%id(i))// &
               ' is not defined', 'names it')
         end do
      else if (act%by == BY_RANGES) then
         do i = 1, size(act%id) - 1, 2
            call add_range(draft%node, act%id(i), act%id(i + 1), 1, list)
         end do
      else
         i = find(draft%group, act%id(1))
         if (i > 0) list%node = draft%groups(i)%node
         if (i > 0) list%n = size(list%node)
         if (i == 0) call tell(draft, act, SEV_ERROR, 'KJ-0668', 'node group '//str(act%id(1))// &
            ' is not defined', 'names it', 'of a mechanism that is taken out: name its nodes')
      end if
      lead = draft%new(list%node(:list%n))
      lead = pack(lead, lead > 0 .and. lead <= model%n_lead)
      if (size(lead) == 0) call tell(draft, act, SEV_WARNING, 'KJ-9154', &
         'a card of the engine deck names no main or free node', 'has no effect')
   end subroutine leads_of

   !> Place of a skew or frame; 0 = global
   subroutine find_axes(draft, act, lookup, what, id, place)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: act
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what, id
      integer, intent(out) :: place

      place = 0
      if (act%axes == 0) return
      place = find(lookup, act%axes)
      if (place == 0) call tell(draft, act, SEV_ERROR, id, what//' '//str(act%axes)// &
         ' is not defined', 'names it')
   end subroutine find_axes

   !> A finding at the header of a card
   subroutine tell(draft, act, severity, id, message, label, hint)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: act
      integer, intent(in) :: severity
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      call add_at(draft%deck%findings, severity, id, act%file, act%line, act%text, 1, &
         max(1, len_trim(act%text)), message, label, hint)
   end subroutine tell

end module kj_build
