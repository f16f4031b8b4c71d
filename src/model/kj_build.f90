!> Deck -> model: every cross reference and range is checked on this way.
!> One file: from the deck to what a run needs beside the scene
module kj_build
   use kj_kinds, only: wp
   use kj_joint_types, only: FRAME_MEAN, FRAME_CROSS
   use kj_joint_batch, only: KJOINT, SPRING4
   use kj_keywords, only: KW_TITLE, KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, KW_TH_PART
   use kj_deck_text, only: title_of, deck_t, line_text, report_header
   use kj_engine, only: engine_t
   use kj_draft, only: draft_t, blocks_of, known_ids
   use kj_build_scene, only: build_nodes, build_masses, build_curves, build_sensors, &
      check_analysis, build_parts
   use kj_build_axes, only: build_skews, build_frames, move_nodes
   use kj_build_group, only: build_groups
   use kj_build_body, only: build_bodies
   use kj_build_spring, only: build_spring_properties
   use kj_build_joint, only: build_joints
   use kj_build_load, only: build_velocities, carry_secondaries, build_conditions, build_gravity, &
      build_cloads, build_motions
   use kj_model, only: model_t, SCALE_NONE, SCALE_MASS, SCALE_MASS_NEXT, STOP_BELOW, bcs_t
   use kj_math3, only: cross
   use kj_error, only: add_at, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, find, new_lookup, sorted_order
   use kj_engine_nodes, only: node_act_t, BY_NODES, BY_RANGES
   use kj_node_list, only: node_list_t, add_node, add_range
   use kj_card_lists, only: th_t, read_th, report_id
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

   !> /TH requests: joints, springs, bodies and nodes of the history, ascending user id; where the
   !> deck asks for none: all joints, springs and bodies, no nodes
   subroutine build_requests(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(lookup_t) :: joints
      integer, allocatable :: blocks(:)

      call new_lookup(model%joint%id, joints)
      blocks = blocks_of(draft%deck, KW_TH_SPRING)
      call collect(draft%deck, blocks, joints, draft%elements%id, 'element', 'KJ-0069', SEV_ERROR, &
         model%th_joint)
      if (size(blocks) == 0) model%th_joint = joints%place
      model%th_spring = pack(model%th_joint, model%th_joint > model%n_joint)
      model%th_joint = pack(model%th_joint, model%th_joint <= model%n_joint)
      blocks = blocks_of(draft%deck, KW_TH_RBODY)
      call collect(draft%deck, blocks, draft%body_id, draft%body_id, 'rigid body', 'KJ-0257', &
         SEV_WARNING, model%th_body)
      if (size(blocks) == 0) model%th_body = draft%body_id%place
      call collect_nodes(draft, model)
      call check_parts(draft)
   end subroutine build_requests

   !> Entities that /TH blocks ask for, each once, ascending id; id 0 in a block asks for all
   subroutine collect(deck, blocks, lookup, all_ids, what, id, severity, list)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: blocks(:), severity
      type(lookup_t), intent(in) :: lookup       !! of what histories hold
      type(lookup_t), intent(in) :: all_ids      !! of what the deck defines
      character(len=*), intent(in) :: what, id
      integer, allocatable, intent(out) :: list(:)

      type(th_t) :: th
      logical :: wanted(size(lookup%id))
      integer :: b, k, i, place
      integer, allocatable :: rank(:)

      wanted = .false.
      allocate (rank(size(lookup%id)))
      rank(lookup%place) = [(i, i=1, size(rank))]
      do b = 1, size(blocks)
         call read_th(deck, blocks(b), th)
         if (th%all) wanted = .true.
         do k = 1, th%object%n
            place = find(lookup, th%object%value(k))
            if (place > 0) then
               wanted(rank(place)) = .true.
            else if (find(all_ids, th%object%value(k)) == 0) then
               call report_id(deck, th%object, k, severity, id, what//' '// &
                  str(th%object%value(k))//' is not defined', 'no such '//what, known_ids(all_ids, &
                  what))
            end if
         end do
      end do
      list = pack(lookup%place, wanted)
   end subroutine collect

   !> Nodes, each once for each set of axes it is asked for in, with the name of its first request
   subroutine collect_nodes(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(th_t), allocatable :: th(:)
      integer, allocatable :: blocks(:), block(:), place(:), skew(:), order(:)
      logical :: taken(model%n_node)
      integer :: b, k, n, raw, i

      blocks = blocks_of(draft%deck, KW_TH_NODE)
      allocate (th(size(blocks)))
      do b = 1, size(blocks)
         call read_th(draft%deck, blocks(b), th(b))
         if (any(th(b)%variable(:)(:2) == 'DR')) call report_header(draft%deck, blocks(b), &
            SEV_WARNING, 'KJ-0774', 'rotational displacements of nodes are not kept', 'asks for DR')
      end do
      n = sum(th%object%n)
      allocate (model%th_node(n), block(n), place(n), skew(n))
      taken = .false.
      n = 0
      do b = 1, size(blocks)
         do k = 1, th(b)%object%n
            raw = find(draft%node, th(b)%object%value(k))
            if (raw == 0) call report_id(draft%deck, th(b)%object, k, SEV_ERROR, 'KJ-0078', &
               'node '// str(th(b)%object%value(k))//' is not defined', 'no such node')
            i = skew_of(draft, th(b), k)
            if (raw == 0) cycle
            if (taken(draft%new(raw))) then
               if (any(model%th_node(:n) == draft%new(raw) .and. skew(:n) == i)) cycle
            end if
            taken(draft%new(raw)) = .true.
            n = n + 1
            model%th_node(n) = draft%new(raw)
            skew(n) = i
            block(n) = b
            place(n) = k
         end do
      end do
      order = sorted_order(model%node_id(model%th_node(:n)))
      model%th_node = model%th_node(order)
      model%th_node_skew = skew(order)
      allocate (model%th_node_name(n))
      do i = 1, n
         associate (object => th(block(order(i)))%object)
            model%th_node_name(i)%s = trim(name_on(line_text(draft%deck, &
               object%line(place(order(i))))))
         end associate
      end do
   end subroutine collect_nodes

   !> Skew that a request names for a node, 0 = global; a frame is another matter
   integer function skew_of(draft, th, k) result(skew)
      type(draft_t), intent(inout) :: draft
      type(th_t), intent(in) :: th
      integer, intent(in) :: k

      skew = 0
      if (th%skew(k) == 0) return
      skew = find(draft%skew, th%skew(k))
      if (skew > 0) return
      if (find(draft%frame, th%skew(k)) > 0) then
         call report_id(draft%deck, th%axes, k, SEV_ERROR, 'KJ-9153', &
            'histories relative to a frame are not supported', 'expected: id of a skew', &
            known_ids(draft%skew, 'skew'))
      else
         call report_id(draft%deck, th%axes, k, SEV_ERROR, 'KJ-0137', 'skew '//str(th%skew(k))// &
            ' is not defined', 'no such skew', known_ids(draft%skew, 'skew'))
      end if
   end function skew_of

   !> Name of a node in its request: columns 21 to 100, or what follows the second comma
   pure function name_on(text) result(name)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: name

      integer :: comma, second

      name = ''
      comma = index(text, ',')
      if (comma > 0) then
         second = index(text(comma + 1:), ',')
         if (second > 0) name = trim(adjustl(text(comma + second + 1:)))
      else if (len(text) > 20) then
         name = trim(adjustl(text(21:min(100, len(text)))))
      end if
   end function name_on

   !> Histories of parts are not written; their cards must be right all the same
   subroutine check_parts(draft)
      type(draft_t), intent(inout) :: draft

      type(th_t) :: th
      integer, allocatable :: blocks(:)
      integer :: b, k

      blocks = blocks_of(draft%deck, KW_TH_PART)
      do b = 1, size(blocks)
         call read_th(draft%deck, blocks(b), th)
         do k = 1, th%object%n
            if (find(draft%part, th%object%value(k)) == 0) call report_id(draft%deck, th%object, &
               k, SEV_WARNING, 'KJ-1610', 'part '//str(th%object%value(k))//' is not defined', &
               'no such part', known_ids(draft%part, 'part'))
         end do
         call report_header(draft%deck, blocks(b), SEV_WARNING, 'KJ-9156', &
            'histories of parts are not written', 'no effect')
      end do
   end subroutine check_parts

end module kj_build
