!> Bodies of the public module: loading a deck, and what the history says of it.
submodule (kjoint) kjoint_impl
   use kj_run_option, only: settle_run_options
   use kj_error, only: fail, add_finding, SEV_ERROR
   use kj_deck, only: read_deck
   use kj_deck_text, only: deck_t, source_t
   use kj_engine, only: engine_t, read_engine
   use kj_engine_text, only: has_engine_part
   use kj_parameter, only: setting_t
   use kj_mechanism, only: take_mechanism
   use kj_text, only: append_text
   use kj_build, only: build_model
   use kj_build_joint, only: scale_blocking
   use kj_cards, only: rows_t, read_rows
   use kj_keywords, only: KW_NODE
   use kj_sort, only: lookup_t, new_lookup
   use kj_draft, only: draft_t, blocks_of
   use kj_joint_types, only: joint_types
   use kj_model, only: model_t
   use kj_sample, only: new_sampler
   use kj_scheme, only: choose_scheme
   use kj_scheme_check, only: check_scene
   use kj_history, only: entity_t, describe_shape
   use kj_joint_batch, only: blocking_stiffness
   implicit none

contains

   module procedure load_simulation
      type(draft_t) :: draft
      type(source_t) :: engine_source
      type(engine_t) :: controls
      type(simulation_t) :: fresh
      type(lookup_t) :: nodes
      type(extract_report_t) :: report
      character(len=:), allocatable :: path, kept

      if (sim%running) then
         call fail(error, ERR_INPUT, RUNS)
         return
      end if
      sim = fresh
      sim%options = options
      sim%root = starter(:root_length(starter))
      call settle_run_options(sim%options, error)
      if (allocated(error)) return
      call choose_scheme(sim%options, sim%scheme)
      draft%deck%ignore_random = options%ignore_random
      if (options%mechanism) then
         call take_mechanism(starter, settings_of(options%set), findings, draft%deck, report)
      else
         draft%deck%findings = findings
         call read_deck(starter, draft%deck, options%ignore_unsupported, &
            settings=settings_of(options%set))
      end if
      if (options%until >= 0.0_wp .and. len(engine) == 0) then
         controls%t_stop = options%until
      else
         call find_engine_deck(starter, engine, path)
         if (options%mechanism) then
            call find_nodes(draft%deck, nodes)
            call read_engine(path, controls, engine_source, draft%deck%findings, &
               options%ignore_unsupported, sim%scheme%legacy, kept, nodes)
         else
            call read_engine(path, controls, engine_source, draft%deck%findings, &
               options%ignore_unsupported, sim%scheme%legacy)
         end if
      end if
      if (len_trim(options%joint) > 0) then
         draft%joint_setting = settings_of(options%joint)
         allocate (draft%joint_set(size(draft%joint_setting)), source=.false.)
      end if
      if (draft%deck%readable) call build_model(draft, controls, sim%model%model_t, &
         sim%scheme%legacy)
      findings = draft%deck%findings
      if (findings%n_error > 0) return
      associate (c => sim%model%control)
         if (options%until >= 0.0_wp) c%t_stop = options%until
         if (options%sample >= 0.0_wp) c%sample = options%sample
         if (options%dt_scale > 0.0_wp) c%dt_factor = options%dt_scale
         c%threads = options%threads
         c%least_share = options%least_share
         c%dt_ini = options%dt_max_scale*c%dt_ini
         c%dt_max = options%dt_max_scale*c%dt_max
         if (.not. c%t_stop >= 0.0_wp) call fail(error, ERR_INPUT, 'the end time is negative')
      end associate
      if (allocated(error)) return
      if (abs(options%kn_scale - 1.0_wp) > 0.0_wp) call scale_blocking(sim%model%model_t, &
         options%kn_scale)
      call check_scene(sim%scheme, sim%model, options%dt_scale, findings, error)
      if (allocated(error)) return
      call describe(sim)
      call keep_inputs(draft%deck, engine_source, sim%history)
      sim%load_scale = sim%model%cload%y_scale
      sim%loaded = .true.
   end procedure load_simulation

   module procedure simulation_options
      options = sim%options
   end procedure simulation_options

   module procedure simulation_checkpoints
      at_end = sim%model%control%checkpoint
      cycles = sim%model%control%checkpoint_cycles
      run_number = sim%model%control%run_number
   end procedure simulation_checkpoints

   module procedure simulation_title
      title = sim%model%title
   end procedure simulation_title

   module procedure simulation_reach
      logical, allocatable :: held(:)
      integer :: i

      reach = 0.0_wp
      associate (m => sim%model%model_t)
         allocate (held(m%n_lead), source=.false.)
         do i = 1, size(m%bcs)
            held(m%bcs(i)%lead) = all(m%bcs(i)%fixed)
         end do
         do i = m%n_lead + 1, m%n_node
            if (.not. held(m%lead(i))) reach = max(reach, norm2(m%x0(i, :) - m%x0(m%lead(i), :)))
         end do
      end associate
   end procedure simulation_reach

   module procedure default_output
      path = sim%root(index(sim%root, '/', back=.true.) + 1:)//'.h5'
   end procedure default_output

   module procedure extract_mechanism
      type(draft_t) :: draft
      type(source_t) :: engine_source
      type(engine_t) :: controls
      type(model_t) :: model
      type(lookup_t) :: nodes
      type(error_t), allocatable :: error
      character(len=:), allocatable :: path, kept
      integer :: i
      logical :: has_engine

      draft%deck%ignore_random = options%ignore_random
      call take_mechanism(starter, settings_of(options%set), findings, draft%deck, report)
      report%engine = ''
      call find_engine_deck(starter, engine, path)
      inquire (file=path, exist=has_engine)
      if (has_engine) then
         call find_nodes(draft%deck, nodes)
         call read_engine(path, controls, engine_source, draft%deck%findings, &
            options%ignore_unsupported, kept=kept, nodes=nodes)
         report%engine = kept
         if (allocated(report%input)) call append_text(report%input, path)
      end if
      findings = draft%deck%findings
      if (findings%n_error > 0 .or. .not. draft%deck%readable) return
      call build_model(draft, controls, model, .false.)       ! what is written must run
      do i = findings%n + 1, draft%deck%findings%n
         if (draft%deck%findings%item(i)%severity /= SEV_ERROR) cycle
         error = draft%deck%findings%item(i)
         call add_finding(findings, error)
      end do
   end procedure extract_mechanism

   module procedure holds_engine
      holds = has_engine_part(starter)
   end procedure holds_engine

   !> The engine deck that is named, else ROOT_0001.rad, or the starter deck where that holds it
   subroutine find_engine_deck(starter, engine, path)
      character(len=*), intent(in) :: starter, engine
      character(len=:), allocatable, intent(out) :: path

      logical :: exists

      path = engine
      if (len(path) > 0) return
      path = starter(:root_length(starter))//'_0001.rad'
      inquire (file=path, exist=exists)
      if (exists) return
      if (has_engine_part(starter)) path = starter
   end subroutine find_engine_deck

   !> Ids of the nodes of a deck
   subroutine find_nodes(deck, nodes)
      type(deck_t), intent(inout) :: deck
      type(lookup_t), intent(out) :: nodes

      type(rows_t) :: rows

      if (deck%readable) then
         call read_rows(deck, blocks_of(deck, KW_NODE), rows)
         call new_lookup(rows%ints(:, 1), nodes)
      else
         call new_lookup([integer ::], nodes)
      end if
   end subroutine find_nodes

   !> 'a=1,b=2' -> names and values
   pure function settings_of(text) result(list)
      character(len=*), intent(in) :: text
      type(setting_t), allocatable :: list(:)

      type(setting_t) :: one
      integer :: first, last, equals

      allocate (list(0))
      first = 1
      do while (first <= len_trim(text))
         last = index(text(first:)//',', ',') + first - 2
         equals = index(text(first:last), '=')
         if (equals == 0) equals = last - first + 2
         one%name = trim(adjustl(text(first:first + equals - 2)))
         one%value = trim(adjustl(text(first + equals:last)))
         list = [list, one]
         first = last + 2
      end do
   end function settings_of

   !> What the history says of the scene
   subroutine describe(sim)
      type(simulation_t), intent(inout) :: sim

      integer :: i, n

      associate (h => sim%history, m => sim%model%model_t)
         h%title = m%title
         h%legacy = sim%scheme%legacy
         h%integrator = 'split2'
         if (h%legacy) h%integrator = 'legacy'
         if (sim%options%integrator /= '') h%integrator = trim(sim%options%integrator)
         h%units = m%units
         if (m%control%sample > 0.0_wp) &
            h%n_expected = nint(min(1.0e6_wp, m%control%t_stop/m%control%sample)) + 2
         call describe_elements(m, m%th_joint, h%entity(OF_JOINT))
         if (sim%options%kn /= 'inf') then
            allocate (h%entity(OF_JOINT)%blocking(2, size(m%th_joint)))
            do i = 1, size(m%th_joint)
               h%entity(OF_JOINT)%blocking(:, i) = blocking_stiffness(m%batch(m%joint(m%th_joint( &
                  i))%batch), m%joint(m%th_joint(i))%place)
            end do
         end if
         h%entity(OF_JOINT)%type = joint_types(m%joint(m%th_joint)%row)%id
         call describe_elements(m, m%th_spring, h%entity(OF_SPRING))
         h%entity(OF_SPRING)%type = m%batch(m%joint(m%th_spring)%batch)%kind
         n = size(m%th_body)
         associate (e => h%entity(OF_BODY))
            e%id = m%body_id(m%th_body)
            e%label = m%body_name(m%th_body)
            e%main_node = m%node_id(m%th_body)
            e%mass = m%mass(m%th_body)
            e%inertia = transpose(m%principal(m%th_body, :))
            allocate (e%axes(3, 3, n))
            do i = 1, n
               e%axes(:, :, i) = reshape(m%axes(m%th_body(i), :), [3, 3])
            end do
         end associate
         h%entity(OF_NODE)%id = m%node_id(m%th_node)
         h%entity(OF_NODE)%label = m%th_node_name
         if (any(m%th_node_skew > 0)) then
            allocate (h%entity(OF_NODE)%skew(size(m%th_node)), source=0)
            do i = 1, size(m%th_node)
               if (m%th_node_skew(i) > 0) h%entity(OF_NODE)%skew(i) = m%skews%id(m%th_node_skew(i))
            end do
         end if
      end associate
      call describe_shape(sim%model%model_t, sim%history%shape)
      call new_sampler(sim%model%model_t, sim%history, sim%sampler)
   end subroutine describe

   !> What the history says of joints or springs
   subroutine describe_elements(model, th, entity)
      type(model_t), intent(in) :: model
      integer, intent(in) :: th(:)               !! indices into model%joint
      type(entity_t), intent(inout) :: entity

      integer :: i

      entity%id = model%joint(th)%id
      entity%label = model%joint_name(th)
      entity%property = model%joint(th)%property
      allocate (entity%node(2, size(th)), entity%body(2, size(th)))
      do i = 1, size(th)
         entity%node(:, i) = model%node_id(model%joint(th(i))%node)
         entity%body(:, i) = body_ids(model, model%joint(th(i))%node)
      end do
   end subroutine describe_elements

   !> User ids of the bodies that carry two nodes, 0 for a free node
   pure function body_ids(model, node) result(ids)
      type(model_t), intent(in) :: model
      integer, intent(in) :: node(2)
      integer :: ids(2)

      integer :: e

      ids = 0
      do e = 1, 2
         if (model%lead(node(e)) <= model%n_body) ids(e) = model%body_id(model%lead(node(e)))
      end do
   end function body_ids

   !> The decks go into the history as they are; their texts are moved there
   subroutine keep_inputs(deck, engine_source, history)
      type(deck_t), intent(inout) :: deck
      type(source_t), intent(inout) :: engine_source
      type(history_t), intent(inout) :: history

      integer :: i, k, n
      logical :: kept(deck%n_source)

      kept = deck%source(:deck%n_source)%role /= 'flat' .and. &
         deck%source(:deck%n_source)%role /= 'piece'   ! those are no files
      allocate (history%input_path(0))
      do k = 1, deck%n_source
         if (kept(k)) call append_text(history%input_path, deck%source(k)%path)
      end do
      if (allocated(engine_source%text)) call append_text(history%input_path, engine_source%path)
      if (any(deck%source(:deck%n_source)%role == 'extract')) kept(2:) = .false.   ! all that runs
      n = count(kept)
      if (allocated(engine_source%text)) n = n + 1
      allocate (history%input_name(n), history%input_text(n), history%input_role(n))
      i = 0
      do k = 1, deck%n_source
         if (kept(k)) call keep(deck%source(k))
      end do
      if (i < n) call keep(engine_source)
   contains
      subroutine keep(source)
         type(source_t), intent(inout) :: source

         i = i + 1
         history%input_name(i)%s = source%path(index(source%path, '/', back=.true.) + 1:)
         call move_alloc(source%text, history%input_text(i)%s)
         history%input_role(i)%s = trim(source%role)
      end subroutine keep
   end subroutine keep_inputs

   !> DECK_0000.rad -> DECK: the length of the root
   pure integer function root_length(path) result(n)
      character(len=*), intent(in) :: path

      n = index(path, '_0000.rad', back=.true.)
      if (n == 0) n = index(path, '.', back=.true.)
      if (n <= index(path, '/', back=.true.) + 1) n = len(path) + 1
      n = n - 1
   end function root_length

end submodule kjoint_impl
