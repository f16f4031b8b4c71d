!> Cards -> model: rigid bodies, the numbering of nodes, initial velocities.
module kj_build_body
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, add_finding, str, SEV_ERROR, SEV_WARNING
   use kj_math3, only: cross
   use kj_sort, only: find
   use kj_keywords, only: KW_RBODY, KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS
   use kj_deck_data, only: deck_t, title_of
   use kj_cards, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_draft, only: draft_t, blocks_of, block_lookup, group_nodes, reference
   use kj_inertia, only: body_input_t, body_mass_t, gather_body, correct_inertia
   use kj_model, only: model_t
   implicit none
   private

   public :: build_bodies, build_velocities

   !> Nodes of one body
   type :: crew_t
      integer :: main = 0                       !! raw index
      integer, allocatable :: node(:)           !! secondary nodes, raw indices
   end type crew_t

contains

   !> Bodies in ascending user id; numbers the nodes of the model
   subroutine build_bodies(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(cards_t), allocatable :: cards(:)
      type(crew_t), allocatable :: crew(:)
      integer, allocatable :: blocks(:)
      integer :: b, n_error

      n_error = findings%n_error
      blocks = blocks_of(deck, KW_RBODY)
      call block_lookup(deck, blocks, draft%body_id)
      blocks = blocks(draft%body_id%place)
      draft%body_id%place = [(b, b=1, size(blocks))]
      draft%body_block = blocks
      model%n_body = size(blocks)
      model%body_id = deck%block(blocks)%id
      allocate (cards(model%n_body), crew(model%n_body), model%body_name(model%n_body))
      do b = 1, model%n_body
         call read_cards(deck, blocks(b), cards(b), findings)
         model%body_name(b)%s = title_of(deck, blocks(b))
         call check_double_id(deck, cards(b), model%body_id, b, findings)
         call collect_crew(deck, cards(b), b, draft, crew(b), findings)
      end do
      if (findings%n_error > n_error) return
      call number_nodes(draft, crew, model)
      call weigh_bodies(deck, cards, crew, draft, model, findings)
   end subroutine build_bodies

   subroutine check_double_id(deck, cards, ids, b, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: ids(:), b
      type(finding_list_t), intent(inout) :: findings

      if (b == 1) return
      if (ids(b) == ids(b - 1)) call report(deck, cards, 'node_id', SEV_ERROR, 'KJ-0079', &
         'rigid body '//str(ids(b))//' is defined twice', 'second body with this id', findings)
   end subroutine check_double_id

   !> Main and secondary nodes of one body
   subroutine collect_crew(deck, cards, b, draft, crew, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: b
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(inout) :: crew
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: nodes(:)
      integer :: i, n

      call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0053', findings, nodes)
      allocate (crew%node(0))
      crew%main = find(draft%node, int_of(cards, 'node_id'))
      if (int_of(cards, 'node_id') == 0) then
         call report(deck, cards, 'node_id', SEV_ERROR, 'KJ-3122', 'the rigid body has no main node', &
            'expected: id of a node', findings, hint='kjoint does not create nodes: define one and name it here')
         return
      else if (crew%main == 0) then
         call report(deck, cards, 'node_id', SEV_ERROR, 'KJ-0078', 'node '// &
            str(int_of(cards, 'node_id'))//' is not defined', 'no such node', findings)
         return
      end if
      if (draft%main_of(crew%main) > 0) call report(deck, cards, 'node_id', SEV_ERROR, 'KJ-0442', &
         'two rigid bodies have the same main node', 'main node of another body', findings)
      draft%main_of(crew%main) = b
      if (size(nodes) == 0) call report(deck, cards, 'grnod_id', SEV_WARNING, 'KJ-0352', &
         'the rigid body has no secondary nodes', 'no node', findings)
      n = 0
      do i = 1, size(nodes)
         if (nodes(i) == crew%main) then
            call report(deck, cards, 'grnod_id', SEV_WARNING, 'KJ-1624', &
               'the main node was removed from the secondary nodes', 'holds the main node', findings)
            cycle
         end if
         if (draft%body(nodes(i)) > 0) then
            call report(deck, cards, 'grnod_id', SEV_ERROR, 'KJ-3121', 'node '// &
               str(draft%id(nodes(i)))//' is a secondary node of two rigid bodies', &
               'holds a node of another body', findings)
            cycle
         end if
         draft%body(nodes(i)) = b
         n = n + 1
         nodes(n) = nodes(i)
      end do
      crew%node = nodes(:n)
   end subroutine collect_crew

   !> Main nodes, then free nodes, then secondary nodes body by body
   subroutine number_nodes(draft, crew, model)
      type(draft_t), intent(inout) :: draft
      type(crew_t), intent(in) :: crew(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: raw(:)
      integer :: b, i, n

      allocate (raw(draft%n_node), model%first(model%n_body + 1))
      n = model%n_body
      raw(:n) = crew%main
      do i = 1, draft%n_node
         if (draft%body(i) > 0 .or. draft%main_of(i) > 0) cycle
         n = n + 1
         raw(n) = i
      end do
      model%n_lead = n
      model%n_node = draft%n_node
      allocate (model%lead(model%n_node))
      model%lead(:n) = [(i, i=1, n)]
      do b = 1, model%n_body
         model%first(b) = n + 1
         raw(n + 1:n + size(crew(b)%node)) = crew(b)%node
         model%lead(n + 1:n + size(crew(b)%node)) = b
         n = n + size(crew(b)%node)
      end do
      model%first(model%n_body + 1) = n + 1
      draft%new(raw) = [(i, i=1, n)]
      model%node_id = draft%id(raw)
      model%x0 = draft%x(raw, :)
      model%node_mass = draft%mass(raw)
      model%node_inertia = draft%inertia(raw)
      model%mass = model%node_mass(:model%n_lead)
      model%inertia = model%node_inertia(:model%n_lead)
      allocate (model%v0(n, 3), model%w0(model%n_lead, 3), source=0.0_wp)
   end subroutine number_nodes

   !> Masses, centres of gravity and principal axes; moves the main nodes
   subroutine weigh_bodies(deck, cards, crew, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards(:)
      type(crew_t), intent(in) :: crew(:)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(body_input_t) :: input
      type(body_mass_t) :: body
      type(error_t), allocatable :: error
      integer :: b
      logical :: changed

      allocate (model%principal(model%n_body, 3), model%axes(model%n_body, 9), &
         model%ispher(model%n_body))
      do b = 1, model%n_body
         call read_body(deck, cards(b), crew(b), draft, input, findings)
         call gather_body(input, draft%x(crew(b)%node, :), draft%mass(crew(b)%node), &
            draft%inertia(crew(b)%node), body, error)
         if (allocated(error)) then
            call add_finding(findings, error)
            return
         end if
         call correct_inertia(input%ispher, body%principal, changed)
         call check_body(deck, cards(b), body, changed, findings)
         model%x0(b, :) = body%x
         model%mass(b) = body%mass
         model%principal(b, :) = body%principal
         model%inertia(b) = minval(body%principal)
         model%axes(b, :) = reshape(body%axes, [9])
         model%ispher(b) = input%ispher
      end do
   end subroutine weigh_bodies

   subroutine read_body(deck, cards, crew, draft, input, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(crew_t), intent(in) :: crew
      type(draft_t), intent(in) :: draft
      type(body_input_t), intent(out) :: input
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: a(3, 3)
      integer :: skew

      input%icog = int_of(cards, 'ICoG')
      if (input%icog == 0) input%icog = 1
      if (input%icog < 1 .or. input%icog > 4) call report(deck, cards, 'ICoG', SEV_ERROR, 'KJ-9114', &
         'ICoG must be 1, 2, 3 or 4', 'expected: 1 to 4', findings)
      input%ispher = int_of(cards, 'Ispher')
      if (input%ispher == 0) input%ispher = 2
      if (input%ispher < 1 .or. input%ispher > 3) call report(deck, cards, 'Ispher', SEV_ERROR, 'KJ-9115', &
         'Ispher must be 1, 2 or 3', 'expected: 1 to 3', findings)
      if (int_of(cards, 'sens_id') > 0) call report(deck, cards, 'sens_id', SEV_ERROR, 'KJ-9116', &
         'rigid bodies that a sensor switches are not supported', 'expected: 0', findings)
      input%x = draft%x(crew%main, :)
      input%mass = draft%mass(crew%main) + real_of(cards, 'Mass')
      input%node_inertia = draft%inertia(crew%main)
      input%j(1, :) = [real_of(cards, 'Jxx'), real_of(cards, 'Jxy'), real_of(cards, 'Jxz')]
      input%j(2, :) = [real_of(cards, 'Jxy'), real_of(cards, 'Jyy'), real_of(cards, 'Jyz')]
      input%j(3, :) = [real_of(cards, 'Jxz'), real_of(cards, 'Jyz'), real_of(cards, 'Jzz')]
      skew = reference(deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137', findings)
      if (skew == 0) return
      a = reshape(draft%skews%axes(skew, :), [3, 3])
      input%j = matmul(matmul(a, input%j), transpose(a))
   end subroutine read_body

   subroutine check_body(deck, cards, body, changed, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(body_mass_t), intent(in) :: body
      logical, intent(in) :: changed
      type(finding_list_t), intent(inout) :: findings

      if (.not. body%mass > 1.0e-30_wp) then
         call report(deck, cards, 'Mass', SEV_ERROR, 'KJ-0679', 'the rigid body has no mass', &
            'expected: a mass here or on its nodes', findings)
      else if (.not. minval(body%principal) > 0.0_wp) then
         call report(deck, cards, 'Jxx', SEV_ERROR, 'KJ-0274', &
            'the smallest principal inertia of the rigid body is not positive', &
            'expected: a positive definite inertia', findings)
      end if
      if (changed) call report(deck, cards, 'Jxx', SEV_WARNING, 'KJ-0275', &
         'a principal inertia is under a thousandth of the largest: it was raised by a tenth of it', &
         'very slender', findings, hint='Ispher 3 keeps the inertia as typed')
      if (maxval(body%principal) > 1.0001_wp*(sum(body%principal) - maxval(body%principal))) &
         call report(deck, cards, 'Jxx', SEV_WARNING, 'KJ-0542', &
         'the inertia of the rigid body is not that of a solid: I1 > I2 + I3', 'not physical', findings)
   end subroutine check_body

   !> Initial velocities in deck order, the last one on a node wins; secondary nodes follow their body
   subroutine build_velocities(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      integer, allocatable :: nodes(:)
      integer :: i, b, keyword

      do i = 1, deck%n_block
         keyword = deck%block(i)%keyword
         if (.not. any(keyword == [KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS])) cycle
         call read_cards(deck, i, cards, findings)
         if (is_given(cards, 'sens_id') .or. is_given(cards, 'Tstart')) call refuse_late(deck, cards, findings)
         call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0053', findings, nodes)
         if (size(nodes) == 0 .and. int_of(cards, 'grnod_id') == 0) call report(deck, cards, 'grnod_id', &
            SEV_ERROR, 'KJ-0668', 'the initial velocity has no node group', 'expected: id of a node group', findings)
         if (keyword == KW_INIVEL_AXIS) then
            call set_axis_velocity(deck, cards, draft, nodes, model, findings)
         else
            call set_velocity(deck, cards, keyword, draft, nodes, model, findings)
         end if
      end do
      do b = 1, model%n_body
         do i = model%first(b), model%first(b + 1) - 1
            model%v0(i, :) = model%v0(b, :) + cross(model%w0(b, :), model%x0(i, :) - model%x0(b, :))
         end do
      end do
   end subroutine build_velocities

   subroutine refuse_late(deck, cards, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(finding_list_t), intent(inout) :: findings

      if (int_of(cards, 'sens_id') > 0) call report(deck, cards, 'sens_id', SEV_ERROR, 'KJ-9117', &
         'initial velocities after a sensor are not supported', 'expected: 0', findings)
      if (real_of(cards, 'Tstart') > 0.0_wp) call report(deck, cards, 'Tstart', SEV_ERROR, 'KJ-9117', &
         'initial velocities after the start are not supported', 'expected: 0', findings)
   end subroutine refuse_late

   subroutine set_velocity(deck, cards, keyword, draft, nodes, model, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: keyword, nodes(:)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: v(3)
      integer :: i, k, skew

      v = [real_of(cards, 'Vx'), real_of(cards, 'Vy'), real_of(cards, 'Vz')]
      skew = reference(deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0184', findings)
      v = matmul(reshape(draft%skews%axes(skew, :), [3, 3]), v)
      do k = 1, size(nodes)
         i = draft%new(nodes(k))
         if (keyword /= KW_INIVEL_ROT) then
            model%v0(i, :) = v
         else if (i <= model%n_lead) then
            model%w0(i, :) = v
         end if
      end do
   end subroutine set_velocity

   !> v = Vt + Vr axis x (x - O), w = Vr axis, at the place of a main node after it moved
   subroutine set_axis_velocity(deck, cards, draft, nodes, model, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: nodes(:)
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: a(3, 3), origin(3), w(3), v(3)
      integer :: dir, frame, i, k

      dir = index('XYZ', text_of(cards, 'dir'))
      if (len(text_of(cards, 'dir')) /= 1 .or. dir == 0) then
         call report(deck, cards, 'dir', SEV_ERROR, 'KJ-0933', 'the axis is not X, Y or Z', &
            'expected: X, Y or Z', findings)
         return
      end if
      frame = reference(deck, cards, 'frame_id', draft%frame, 'frame', 'KJ-0490', findings)
      a = reshape(draft%frames%axes(frame, :), [3, 3])
      origin = draft%frame_origin(frame, :)
      w = real_of(cards, 'Vr')*a(:, dir)
      v = matmul(a, [real_of(cards, 'Vxt'), real_of(cards, 'Vyt'), real_of(cards, 'Vzt')])
      do k = 1, size(nodes)
         i = draft%new(nodes(k))
         model%v0(i, :) = v + cross(w, model%x0(i, :) - origin)
         if (i <= model%n_lead) model%w0(i, :) = w
      end do
   end subroutine set_axis_velocity

end module kj_build_body
