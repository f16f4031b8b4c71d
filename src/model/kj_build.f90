!> Deck -> model: every cross reference and range is checked on this way.
module kj_build
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, new_lookup, find, sorted_order
   use kj_joint_types, only: FRAME_MEAN, FRAME_CROSS
   use kj_joint_batch, only: KJOINT
   use kj_keywords, only: KW_TITLE, KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY
   use kj_deck_data, only: deck_t, title_of, line_text
   use kj_cards, only: th_t, read_th, report_id
   use kj_engine, only: engine_t
   use kj_draft, only: draft_t, blocks_of
   use kj_build_scene, only: build_nodes, build_groups, build_masses, build_skews, build_frames, build_curves, &
      build_sensors
   use kj_build_body, only: build_bodies, build_velocities
   use kj_build_joint, only: build_joints
   use kj_build_load, only: build_conditions, build_gravity, build_cloads, build_motions
   use kj_model, only: model_t, name_t, SCALE_NONE, SCALE_MASS, SCALE_MASS_NEXT, STOP_BELOW
   implicit none
   private

   public :: build_model

   real(wp), parameter :: DEFAULT_FACTOR = real(0.90, wp)   !! of the nodal step, single precision

contains

   !> The model of a deck; usable when findings%n_error is 0 afterwards
   subroutine build_model(deck, engine, model, findings)
      type(deck_t), intent(in) :: deck
      type(engine_t), intent(in) :: engine
      type(model_t), intent(out) :: model
      type(finding_list_t), intent(inout) :: findings

      type(draft_t) :: draft
      integer, allocatable :: blocks(:)
      integer :: n_error

      n_error = findings%n_error
      model%title = ''
      blocks = blocks_of(deck, KW_TITLE)
      if (size(blocks) > 0) model%title = title_of(deck, blocks(1))
      model%units = deck%work
      call build_nodes(deck, draft, findings)
      call build_groups(deck, draft, findings)
      call build_masses(deck, draft, findings)
      call build_skews(deck, draft, findings)
      call build_frames(deck, draft, findings)
      call build_curves(deck, draft, findings)
      call build_sensors(deck, draft, findings)
      call build_bodies(deck, draft, model, findings)
      if (findings%n_error > n_error) return
      call build_velocities(deck, draft, model, findings)
      call build_joints(deck, draft, model, findings)
      call build_conditions(deck, draft, model, findings)
      call build_gravity(deck, draft, model, findings)
      call build_cloads(deck, draft, model, findings)
      call build_motions(deck, draft, model, findings)
      call build_requests(deck, draft, model, findings)
      if (findings%n_error > n_error) return
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

   !> /TH requests: joints, bodies and nodes of the history, ascending user id; where the deck asks
   !> for none: all joints, all bodies, no nodes
   subroutine build_requests(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(lookup_t) :: joints
      integer, allocatable :: blocks(:)
      integer :: i

      call new_lookup(model%joint%id, joints)
      blocks = blocks_of(deck, KW_TH_SPRING)
      call collect(deck, blocks, joints, 'element', 'KJ-0069', SEV_ERROR, model%th_joint, findings)
      if (size(blocks) == 0) model%th_joint = joints%place
      blocks = blocks_of(deck, KW_TH_RBODY)
      call collect(deck, blocks, draft%body_id, 'rigid body', 'KJ-0257', SEV_WARNING, model%th_body, findings)
      if (size(blocks) == 0) model%th_body = [(i, i=1, model%n_body)]
      call collect_nodes(deck, draft, model, findings)
   end subroutine build_requests

   !> Entities that /TH blocks ask for, each once, ascending id; id 0 in a block asks for all
   subroutine collect(deck, blocks, lookup, what, id, severity, list, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:), severity
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what, id
      integer, allocatable, intent(out) :: list(:)
      type(finding_list_t), intent(inout) :: findings

      type(th_t) :: th
      logical :: wanted(size(lookup%id))
      integer :: b, k, place

      wanted = .false.
      do b = 1, size(blocks)
         call read_th(deck, blocks(b), th, findings)
         if (th%all) wanted = .true.
         do k = 1, th%object%n
            place = find(lookup, th%object%value(k))
            if (place > 0) then
               where (lookup%place == place) wanted = .true.
            else
               call report_id(deck, th%object, k, severity, id, what//' '//str(th%object%value(k))// &
                  ' is not defined', 'no such '//what, findings)
            end if
         end do
      end do
      list = pack(lookup%place, wanted)
   end subroutine collect

   subroutine collect_nodes(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(th_t) :: th
      integer, allocatable :: blocks(:), skew(:), order(:)
      integer :: b, k, raw, s

      blocks = blocks_of(deck, KW_TH_NODE)
      allocate (model%th_node(0), skew(0), model%th_node_name(0))
      do b = 1, size(blocks)
         call read_th(deck, blocks(b), th, findings)
         do k = 1, th%object%n
            raw = find(draft%node, th%object%value(k))
            if (raw == 0) then
               call report_id(deck, th%object, k, SEV_ERROR, 'KJ-0078', 'node '//str(th%object%value(k))// &
                  ' is not defined', 'no such node', findings)
               cycle
            end if
            s = 0
            if (th%skew(k) /= 0) s = find(draft%skew, th%skew(k))
            if (th%skew(k) /= 0 .and. s == 0) call report_id(deck, th%object, k, SEV_ERROR, 'KJ-0137', 'skew '// &
               str(th%skew(k))//' is not defined', 'in a skew that does not exist', findings)
            if (any(model%th_node == draft%new(raw))) cycle
            model%th_node = [model%th_node, draft%new(raw)]
            skew = [skew, s]
            call append_name(model, name_on(line_text(deck, th%object%line(k))))
         end do
      end do
      order = sorted_order(model%node_id(model%th_node))
      model%th_node = model%th_node(order)
      model%th_node_skew = skew(order)
      model%th_node_name = model%th_node_name(order)
   end subroutine collect_nodes

   subroutine append_name(model, name)
      type(model_t), intent(inout) :: model
      character(len=*), intent(in) :: name

      type(name_t), allocatable :: longer(:)
      integer :: n

      n = size(model%th_node_name)
      allocate (longer(n + 1))
      longer(:n) = model%th_node_name
      longer(n + 1)%s = trim(name)
      call move_alloc(longer, model%th_node_name)
   end subroutine append_name

   !> Name of a node in its request: columns 21 to 100
   pure function name_on(text) result(name)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: name

      name = ''
      if (len(text) > 20) name = trim(adjustl(text(21:min(100, len(text)))))
   end function name_on

   !> Engine deck -> controls
   subroutine set_controls(engine, model)
      type(engine_t), intent(in) :: engine
      type(model_t), intent(inout) :: model

      associate (c => model%control)
         c%t_stop = engine%t_stop
         if (engine%has_tfile) c%sample = engine%th_dt
         if (engine%print_every /= 0) c%print_every = abs(engine%print_every)
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
         c%joint_step = model%n_joint > 0 .and. .not. c%nodal_step
         if (.not. engine%has_dtix) return
         c%dt_ini = engine%dtix_ini
         if (engine%dtix_max > 0.0_wp) c%dt_max = engine%dtix_max
      end associate
   end subroutine set_controls

end module kj_build
