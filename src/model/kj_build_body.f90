!> Cards -> model: rigid bodies, and the numbering of nodes.
!>
!> A body with a wrong main node is kept for the checks that follow: another of its nodes stands in.
!> One file: what makes a body, and the numbers that its nodes get.
module kj_build_body
   use kj_kinds, only: wp
   use kj_error, only: error_t, str, SEV_ERROR, SEV_WARNING, SEV_NOTE
   use kj_keywords, only: KW_RBODY, KW_RBE2
   use kj_deck_text, only: deck_t, title_of
   use kj_cards, only: cards_t, read_cards, real_of, int_of, report
   use kj_draft, only: draft_t, group_nodes, reference, find_blocks, node_of
   use kj_inertia, only: body_input_t, body_mass_t, gather_body, correct_inertia
   use kj_model, only: model_t
   implicit none
   private

   public :: build_bodies

   !> One body on its way
   type :: crew_t
      integer :: block = 0                      !! of the deck
      integer :: main = 0                       !! raw index
      integer, allocatable :: node(:)           !! secondary nodes, raw indices
      type(body_input_t) :: input
      logical :: weighed = .true.               !! its mass can be told
      logical :: late = .false.                 !! a sensor makes it a body during the run
   end type crew_t

contains

   !> Bodies in ascending user id; numbers the nodes of the model
   subroutine build_bodies(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(cards_t) :: cards
      type(crew_t), allocatable :: crew(:)
      integer :: b, n, n_error

      call find_blocks(draft%deck, pack([KW_RBODY, KW_RBE2], [.true., draft%deck%full]), &
         'rigid body', draft%body_block, draft%body_id)
      draft%body_block = draft%body_block(draft%body_id%place)
      n = size(draft%body_block)
      allocate (crew(n))
      crew%block = draft%body_block
      do b = 1, n
         n_error = draft%deck%findings%n_error
         call read_cards(draft%deck, crew(b)%block, cards)
         crew(b)%weighed = draft%deck%findings%n_error == n_error
         call collect_crew(draft, cards, b, crew(b))
         call read_body(draft, cards, crew(b))
      end do
      call report_double_roles(draft, crew)
      call appoint_stand_ins(draft, crew)
      call keep_whole_bodies(draft, crew, model)
      call number_nodes(draft, crew, model)
      call weigh_bodies(draft, crew, model)
   end subroutine build_bodies

   !> Main and secondary nodes of one body
   subroutine collect_crew(draft, cards, b, crew)
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: b
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(inout) :: crew

      integer, allocatable :: nodes(:)
      integer :: i, n

      call take_main(draft, cards, b, crew)
      call group_nodes(draft, cards, 'KJ-0053', .false., nodes)
      if (size(nodes) == 0) call report(draft%deck, cards, 'grnod_id', SEV_WARNING, 'KJ-0352', &
         'the rigid body has no secondary nodes', 'no node')
      n = 0
      do i = 1, size(nodes)
         if (nodes(i) == crew%main) then
            call report(draft%deck, cards, 'grnod_id', SEV_WARNING, 'KJ-1624', &
               'the main node was removed from the secondary nodes', 'holds the main node')
            cycle
         end if
         if (draft%body(nodes(i)) > 0) then
            call report(draft%deck, cards, 'grnod_id', SEV_ERROR, 'KJ-3121', 'node '// &
               str(draft%id(nodes(i)))//' is a secondary node of two rigid bodies', &
               'holds a node of another body')
            cycle
         end if
         draft%body(nodes(i)) = b
         n = n + 1
         nodes(n) = nodes(i)
      end do
      crew%node = nodes(:n)
   end subroutine collect_crew

   !> The main node; 0 (reported) when it is not a node of its own
   subroutine take_main(draft, cards, b, crew)
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: b
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(inout) :: crew

      integer :: made

      if (int_of(cards, 'node_id') == 0) then
         made = findloc(draft%made_main, cards%block, 1)
         if (made == 0) return
         crew%main = draft%n_node - size(draft%made_main) + made
         call report(draft%deck, cards, 'node_id', merge(SEV_WARNING, SEV_NOTE, &
            real_of(cards, 'Mass') > 0.0_wp .or. int_of(cards, 'ICoG') >= 3), 'KJ-3122', &
            'the rigid body has no main node: node '//str(draft%id(crew%main))//' is made', &
            'at the origin, as in Radioss', &
            hint='a Mass here sits at the origin, and with ICoG '// &
            '3 and 4 the body turns about it')
      else
         crew%main = node_of(draft, cards, 'node_id')
      end if
      if (crew%main == 0) return
      if (draft%main_of(crew%main) > 0) then
         call report(draft%deck, cards, 'node_id', SEV_ERROR, 'KJ-0442', &
            'two rigid bodies have the same main node', 'main node of another body')
         crew%main = 0
      else
         draft%main_of(crew%main) = b
      end if
   end subroutine take_main

   !> What the cards say of mass and inertia
   subroutine read_body(draft, cards, crew)
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(inout) :: crew

      real(wp) :: a(3, 3)
      integer :: skew
      logical :: sensed

      associate (input => crew%input)
         input%swept = draft%legacy
         input%icog = choice_of(draft%deck, cards, 'ICoG', 4, 1, 'KJ-9114')
         input%ispher = choice_of(draft%deck, cards, 'Ispher', 3, 2, 'KJ-9115')
         sensed = int_of(cards, 'sens_id') > 0
         if (sensed) call check_sensor(draft, cards, crew%late)
         if (int_of(cards, 'Ifail') /= 0) call report(draft%deck, cards, 'Ifail', SEV_ERROR, &
            'KJ-9150', 'rigid bodies that fail are not supported', 'expected: 0')
         input%mass = real_of(cards, 'Mass')
         input%j(1, :) = [real_of(cards, 'Jxx'), real_of(cards, 'Jxy'), real_of(cards, 'Jxz')]
         input%j(2, :) = [real_of(cards, 'Jxy'), real_of(cards, 'Jyy'), real_of(cards, 'Jyz')]
         input%j(3, :) = [real_of(cards, 'Jxz'), real_of(cards, 'Jyz'), real_of(cards, 'Jzz')]
         skew = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
         if (draft%deck%block(crew%block)%keyword == KW_RBE2) then
            call check_coupling(draft%deck, cards)
            input%icog = 3
            input%ispher = 3
         else if (sensed) then
            input%icog = 1
            input%mass = 0.0_wp
            input%j = 0.0_wp
            skew = 0
         end if
         if (crew%main == 0) crew%weighed = .false.
         if (crew%main == 0) return
         input%x = draft%x(crew%main, :)
         input%mass = input%mass + draft%mass(crew%main)
         input%node_inertia = draft%inertia(crew%main)
         if (skew == 0) return
         a = reshape(draft%skews%axes(skew, :), [3, 3])
         input%j = matmul(matmul(a, input%j), transpose(a))
      end associate
   end subroutine read_body

   !> A sensor may switch a body on at the start, no later; Mass and J of its card do not count then
   subroutine check_sensor(draft, cards, late)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      logical, intent(inout) :: late

      integer :: sensor

      sensor = reference(draft%deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-0521')
      if (sensor == 0) return
      late = draft%sensors(sensor)%t_start > 0.0_wp
      if (late) then
         call report(draft%deck, cards, 'sens_id', SEV_ERROR, 'KJ-9116', &
            'a rigid body that becomes one during the run is not supported', &
            'expected: a sensor with Tdelay 0')
      else
         call report(draft%deck, cards, 'sens_id', SEV_NOTE, 'KJ-9411', &
            'Mass, J and skew of a body with a sensor do not count, as in Radioss', &
            'active from the start')
      end if
   end subroutine check_sensor

   !> An /RBE2 that couples all directions is a body
   subroutine check_coupling(deck, cards)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards

      character(len=2), parameter :: CODES(6) = ['Tx', 'Ty', 'Tz', 'Rx', 'Ry', 'Rz']
      integer :: i

      if (all([(int_of(cards, CODES(i)) == 1, i=1, 6)])) then
         call report(deck, cards, 'node_id', SEV_WARNING, 'KJ-9412', &
            'the coupling of all directions is taken as a rigid body', 'of ICoG 3 and Ispher 3')
      else
         call report(deck, cards, 'Tx', SEV_ERROR, 'KJ-9413', &
            'an /RBE2 that couples some directions only is not supported', 'expected: 111 111')
      end if
   end subroutine check_coupling

   !> A number from 1 to most; 0 means the default
   integer function choice_of(deck, cards, name, most, default, id) result(choice)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name, id
      integer, intent(in) :: most, default

      choice = int_of(cards, name)
      if (choice >= 1 .and. choice <= most) return
      if (choice /= 0) call report(deck, cards, name, SEV_ERROR, id, name//' must be 1 to '// &
         str(most), 'expected: 1 to '//str(most))
      choice = default
   end function choice_of

   !> A main node that is a secondary node of another body
   subroutine report_double_roles(draft, crew)
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(inout) :: crew(:)

      type(cards_t) :: cards
      integer :: b, other, k

      do b = 1, size(crew)
         if (crew(b)%main == 0) cycle
         other = draft%body(crew(b)%main)
         if (other == 0) cycle
         call read_cards(draft%deck, crew(b)%block, cards)
         call report(draft%deck, cards, 'node_id', SEV_ERROR, 'KJ-9151', 'main node '// &
            str(draft%id(crew(b)%main))//' is a secondary node of rigid body '// &
            str(draft%deck%block(crew(other)%block)%id), 'expected: a node of no other body', &
            hint='bodies on bodies are not supported: join them by a joint, or make them one')
         k = findloc(crew(other)%node, crew(b)%main, dim=1)
         crew(other)%node = [crew(other)%node(:k - 1), crew(other)%node(k + 1:)]
         draft%body(crew(b)%main) = 0
      end do
   end subroutine report_double_roles

   !> A body without a main node (an error was reported) goes on with one of its other nodes
   subroutine appoint_stand_ins(draft, crew)
      type(draft_t), intent(in) :: draft
      type(crew_t), intent(inout) :: crew(:)

      integer :: b, k

      do b = 1, size(crew)
         if (crew(b)%main > 0) cycle
         do k = 1, size(crew(b)%node)
            if (draft%main_of(crew(b)%node(k)) > 0) cycle
            crew(b)%main = crew(b)%node(k)
            crew(b)%node = [crew(b)%node(:k - 1), crew(b)%node(k + 1:)]
            exit
         end do
      end do
   end subroutine appoint_stand_ins

   !> Leave out bodies without any node of their own
   subroutine keep_whole_bodies(draft, crew, model)
      type(draft_t), intent(inout) :: draft
      type(crew_t), allocatable, intent(inout) :: crew(:)
      type(model_t), intent(inout) :: model

      type(crew_t), allocatable :: whole(:)
      integer :: b, n

      if (any(crew%main == 0)) then
         allocate (whole(count(crew%main > 0)))
         n = 0
         do b = 1, size(crew)
            if (crew(b)%main == 0) cycle
            n = n + 1
            whole(n) = crew(b)
            draft%body(crew(b)%node) = n
            if (draft%body(crew(b)%main) > 0) draft%body(crew(b)%main) = n
            if (draft%main_of(crew(b)%main) > 0) draft%main_of(crew(b)%main) = n
         end do
         call move_alloc(whole, crew)
      end if
      draft%body_id%id = draft%deck%block(crew%block)%id
      draft%body_id%place = [(b, b=1, size(crew))]
      model%n_body = size(crew)
      model%body_id = draft%body_id%id
      allocate (model%body_name(size(crew)))
      do b = 1, size(crew)
         model%body_name(b)%s = title_of(draft%deck, crew(b)%block)
      end do
   end subroutine keep_whole_bodies

   !> Main nodes, then free nodes, then secondary nodes body by body, ends of elements first. In a
   !> full deck main nodes alone: the rest of the model is that of its mechanism
   subroutine number_nodes(draft, crew, model)
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(in) :: crew(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: raw(:)
      logical :: is_end(0:draft%n_node)
      integer :: b, i, n

      is_end = .false.
      do i = 1, size(draft%elements%node, 2)
         is_end(draft%elements%node(:, i)) = .true.
      end do
      allocate (raw(draft%n_node), model%n_secondary(model%n_body))
      n = model%n_body
      raw(:n) = crew%main
      do i = 1, merge(0, draft%n_node, draft%deck%full)
         if (draft%body(i) > 0 .or. draft%main_of(i) > 0) cycle
         n = n + 1
         raw(n) = i
      end do
      model%n_lead = n
      model%n_node = merge(n, draft%n_node, draft%deck%full)
      allocate (model%lead(model%n_node))
      model%lead(:n) = [(i, i=1, n)]
      do b = 1, model%n_body
         model%n_secondary(b) = size(crew(b)%node)
         if (draft%deck%full) cycle
         call add_secondaries(b, pack(crew(b)%node, is_end(crew(b)%node)))
      end do
      do b = 1, merge(0, model%n_body, draft%deck%full)
         call add_secondaries(b, pack(crew(b)%node, .not. is_end(crew(b)%node)))
      end do
      raw = raw(:n)
      draft%new(raw) = [(i, i=1, n)]
      model%node_id = draft%id(raw)
      model%x0 = draft%x(raw, :)
      model%node_mass = draft%mass(raw)
      model%node_inertia = draft%inertia(raw)
      model%mass = model%node_mass(:model%n_lead)
      model%inertia = model%node_inertia(:model%n_lead)
      allocate (model%v0(n, 3), model%w0(model%n_lead, 3), source=0.0_wp)

   contains

      subroutine add_secondaries(body, nodes)
         integer, intent(in) :: body, nodes(:)

         raw(n + 1:n + size(nodes)) = nodes
         model%lead(n + 1:n + size(nodes)) = body
         n = n + size(nodes)
      end subroutine add_secondaries
   end subroutine number_nodes

   !> Masses, centres of gravity and principal axes; moves the main nodes
   subroutine weigh_bodies(draft, crew, model)
      type(crew_t), intent(in) :: crew(:)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(body_mass_t) :: body
      type(error_t), allocatable :: error
      integer :: b
      logical :: changed

      allocate (model%principal(model%n_body, 3), model%axes(model%n_body, 9), source=0.0_wp)
      model%ispher = crew%input%ispher
      do b = 1, model%n_body
         if (.not. crew(b)%weighed) cycle
         call gather_body(crew(b)%input, draft%x(crew(b)%node, :), draft%mass(crew(b)%node), &
            draft%inertia(crew(b)%node), body, error)
         changed = .false.
         if (allocated(error)) body%principal = 0.0_wp
         if (.not. allocated(error)) &
            call correct_inertia(crew(b)%input%ispher, body%principal, changed)
         if (.not. crew(b)%late) call check_body(draft%deck, crew(b)%block, body, changed)
         model%x0(b, :) = body%x
         model%mass(b) = body%mass
         model%principal(b, :) = body%principal
         model%inertia(b) = minval(body%principal)
         model%axes(b, :) = reshape(body%axes, [9])
      end do
   end subroutine weigh_bodies

   subroutine check_body(deck, block, body, changed)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block
      type(body_mass_t), intent(in) :: body
      logical, intent(in) :: changed

      type(cards_t) :: cards
      logical :: odd

      associate (p => body%principal)
         odd = maxval(p) > 1.0001_wp*(sum(p) - maxval(p))
         if (body%mass > 1.0e-19_wp .and. minval(p) > 0.0_wp .and. .not. (changed .or. odd)) return
         call read_cards(deck, block, cards)
         if (.not. body%mass > 1.0e-30_wp) then
            call report(deck, cards, 'Mass', SEV_ERROR, 'KJ-0679', 'the rigid body has no mass', &
               'expected: a mass here or on its nodes')
         else if (.not. minval(p) > 0.0_wp) then
            call report(deck, cards, 'Jxx', SEV_ERROR, 'KJ-0274', &
               'the smallest principal inertia of the rigid body is not positive', &
               'expected: a positive definite inertia')
            return
         else if (.not. body%mass > 1.0e-19_wp) then
            call report(deck, cards, 'Mass', SEV_WARNING, 'KJ-9157', &
               'the rigid body has no mass: 1e-20 is taken, as in Radioss', 'no mass')
         end if
         if (changed) call report(deck, cards, 'Jxx', SEV_WARNING, 'KJ-0275', &
            'a principal inertia is under a thousandth of the largest: a tenth of it was added', &
            'very slender', hint='Ispher 3 keeps the inertia as typed')
         if (odd) call report(deck, cards, 'Jxx', SEV_WARNING, 'KJ-0542', &
            'the inertia of the rigid body is not that of a solid: I1 > I2 + I3', 'not physical')
      end associate
   end subroutine check_body

end module kj_build_body
