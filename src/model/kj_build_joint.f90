!> Cards -> model: elements of /SPRING with their properties, sorted into batches of one kind, type,
!> frame rule and law signature.
!> One file: an element from its property to its place in a batch
module kj_build_joint
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING, error_t, fail, add_finding, finding_list_t, &
      ERR_INPUT
   use kj_sort, only: find
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: KJOINT, KJOINT2, LAW_SPRING, LAW_DAMPER, &
      LAW_SPRING_CURVE, LAW_DAMPER_CURVE, joint_batch_t, limits_t, new_batch, new_limits, is_spring
   use kj_spring_law, only: spring_t
   use kj_deck_text, only: title_of
   use kj_cards, only: cards_t, read_cards, report_row, card_row_t, put_real
   use kj_draft, only: draft_t, property_t, joint_t
   use kj_model, only: model_t
   use kj_build_property, only: read_property
   use kj_attach_joint, only: match_skews, frame_of_skews, frame_of_nodes, angles_of_skews, &
      attach_spring, weigh_springs
   use kj_check_scene, only: warn_of_ends
   use kj_lead_map, only: build_lead_map
   use kj_number, only: parse_real, NUMBER_FINE
   use kj_spelling, only: did_you_mean
   implicit none
   private

   public :: build_joints, set_constants, fill_batches, scale_blocking

contains

   !> All joints and springs of the deck; the properties of springs are there
   subroutine build_joints(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(property_t), allocatable :: property(:)
      type(joint_t), allocatable :: joint(:)
      type(cards_t) :: cards
      integer :: i, n

      n = size(draft%property_block) - size(draft%properties)
      allocate (property(n))
      do i = 1, n
         call read_cards(draft%deck, draft%property_block(i), cards)
         call read_property(draft, cards, property(i))
      end do
      draft%properties = [property, draft%properties]
      allocate (joint(draft%elements%n), model%joint(draft%elements%n), &
         model%joint_name(draft%elements%n))
      call attach_elements(draft, 1, n, joint, model)
      call report_unset(draft)
      model%n_joint = model%n_element
      call attach_elements(draft, n + 1, size(draft%properties), joint, model)
      model%n_spring = model%n_element - model%n_joint
      joint = joint(:model%n_element)
      model%joint = model%joint(:model%n_element)
      if (draft%deck%findings%n_error > 0) return
      call weigh_springs(model, model%n_joint, joint)
      call warn_of_ends(draft, model, draft%properties, joint)
      call fill_batches(draft%properties, joint, model)
   end subroutine build_joints

   !> Elements of the parts whose property is one from `least` to `most`, after those that are there
   subroutine attach_elements(draft, least, most, joint, model)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: least, most
      type(joint_t), intent(inout) :: joint(:)
      type(model_t), intent(inout) :: model

      integer :: i, n, part, property

      n = model%n_element
      do i = 1, draft%elements%n
         part = draft%elements%part(i)
         if (part == 0) cycle
         property = draft%part_property(part)
         if (property == 0 .or. property < least .or. property > most) cycle
         if (.not. allocated(draft%properties(property)%spring)) &
            call set_fields(draft, draft%elements%card(i)%ints(1), property)
         n = n + 1
         joint(n)%card = draft%elements%card(i)
         joint(n)%property = property
         model%joint(n)%id = joint(n)%card%ints(1)
         model%joint(n)%part = draft%deck%block(joint(n)%card%block)%id
         model%joint_name(n)%s = title_of(draft%deck, draft%part_block(part))
         call attach(draft, model, draft%properties(property), joint(n))
      end do
      model%n_element = n
   end subroutine attach_elements

   !> Nodes, bodies, initial frame and constants of one element
   subroutine attach(draft, model, p, joint)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      integer :: given, third, raw(6)
      real(wp) :: r(3)

      call find_nodes(draft, joint%card, given, raw)
      if (any(raw(:given) == 0)) return
      joint%node = draft%new(raw(:2))
      if (raw(1) == raw(2)) then
         call report_row(draft%deck, joint%card, 'n2', SEV_ERROR, 'KJ-9120', &
            'both ends of the element are the same node', 'same as n1')
         return
      end if
      if (allocated(p%spring)) then
         third = 0
         if (given > 2) third = draft%new(raw(3))
         call attach_spring(draft, model, p, third, joint)
         return
      end if
      call check_ends(draft, model, p%kind, raw(:2), joint%card)
      if (p%row == 0) return
      r = model%x0(joint%node(2), :) - model%x0(joint%node(1), :)
      if (p%kind == KJOINT2) then
         given = min(given, 4)
         raw(given + 1:) = raw(1)
         call frame_of_nodes(draft, transpose(model%x0(draft%new(raw(:4)), :)), given, p, joint)
         joint%xl0 = matmul(r, joint%frame)
         call angles_of_skews(draft, p, joint)
      else
         call match_skews(draft, model, p, joint)
         call frame_of_skews(draft, p, r, joint)
      end if
      call set_constants(model, p, joint)
   end subroutine attach

   !> The nodes of an element: two, and those after them up to the first 0
   subroutine find_nodes(draft, card, given, raw)
      type(draft_t), intent(inout) :: draft
      type(card_row_t), intent(in) :: card
      integer, intent(out) :: given              !! 2 to 6
      integer, intent(out) :: raw(6)             !! raw node indices, 0 = not defined

      integer :: e

      raw = 0
      given = 6
      do e = 1, 6
         if (e > 2 .and. card%ints(e + 1) == 0) then
            given = e - 1
            exit
         end if
         raw(e) = find(draft%node, card%ints(e + 1))
         if (raw(e) == 0) call report_row(draft%deck, card, 'n'//str(e), SEV_ERROR, 'KJ-0078', &
            'node '//str(card%ints(e + 1))//' is not defined', 'no such node')
      end do
   end subroutine find_nodes

   !> Ends are secondary nodes of bodies; a KJOINT2 takes a node with mass, too
   subroutine check_ends(draft, model, kind, raw, card)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      integer, intent(in) :: kind, raw(2)
      type(card_row_t), intent(in) :: card

      integer :: e

      do e = 1, 2
         if (draft%main_of(raw(e)) > 0) call report_row(draft%deck, card, 'n'//str(e), SEV_ERROR, &
            'KJ-1768', 'node '//str(draft%id(raw(e)))// &
            ' of the joint is the main node of a rigid body', 'expected: a secondary node')
         if (draft%main_of(raw(e)) > 0 .or. draft%body(raw(e)) > 0) cycle
         if (kind == KJOINT) then
            call report_row(draft%deck, card, 'n'//str(e), SEV_WARNING, 'KJ-0391', 'node '// &
               str(draft%id(raw(e)))//' of the joint belongs to no rigid body', 'free node')
         else if (.not. model%mass(model%lead(draft%new(raw(e)))) > 0.0_wp) then
            call report_row(draft%deck, card, 'n'//str(e), SEV_ERROR, 'KJ-9130', 'node '// &
               str(draft%id(raw(e)))//' of the joint has no mass and belongs to no rigid body', &
               'expected: a secondary node, or a node with mass')
         end if
      end do
   end subroutine check_ends

   !> Reduced masses, stiffness and damping of all six dofs, law signature.
   !>
   !> KR = Kn max(1, L0^2), for KJOINT2 Kn max(SCF, L0^2); damping Cr sqrt(K m) on the
   !> blocked dofs. Source: docs/theory/legacy.md 3.1, 3.2.
   subroutine set_constants(model, p, joint)
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      real(wp) :: r(3), least
      integer :: dof, s

      r = model%x0(joint%node(2), :) - model%x0(joint%node(1), :)
      call reduce_masses(model, p%kind, joint)
      least = 1.0_wp
      if (p%kind == KJOINT2) least = p%scf
      joint%k_block = p%kn*[1.0_wp, max(least, dot_product(r, r))]
      joint%k = p%k
      joint%c = p%c
      joint%law = 0
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         if (joint_types(p%row)%free(dof) == 0) then
            joint%k(dof) = joint%k_block(s)
            joint%c(dof) = p%cr*sqrt(joint%k(dof)*joint%reduced(s))
         end if
         joint%law(dof) = law_of(joint%k(dof), p%k_curve(dof), LAW_SPRING, LAW_SPRING_CURVE) + &
            law_of(joint%c(dof), p%c_curve(dof), LAW_DAMPER, LAW_DAMPER_CURVE)
      end do
   end subroutine set_constants

   !> Reduced mass and inertia of the two ends; a free node counts for KJOINT2 alone
   subroutine reduce_masses(model, kind, joint)
      type(model_t), intent(in) :: model
      integer, intent(in) :: kind
      type(joint_t), intent(inout) :: joint

      real(wp) :: m(2), inertia(2)
      integer :: e, lead

      m = 0.0_wp
      inertia = 0.0_wp
      do e = 1, 2
         lead = model%lead(joint%node(e))
         if (lead <= model%n_body) then
            m(e) = model%mass(lead)
            inertia(e) = sum(model%principal(lead, :))/3.0_wp
         else if (kind == KJOINT2) then
            m(e) = model%mass(lead)
            inertia(e) = model%inertia(lead)
         end if
      end do
      if (sum(m) > 0.0_wp) joint%reduced(1) = product(m)/sum(m)
      if (sum(inertia) > 0.0_wp) joint%reduced(2) = product(inertia)/sum(inertia)
   end subroutine reduce_masses

   pure integer function law_of(value, curve, linear, tabulated) result(law)
      real(wp), intent(in) :: value
      integer, intent(in) :: curve, linear, tabulated

      law = 0
      if (abs(value) > 0.0_wp) law = linear
      if (curve > 0) law = tabulated
   end function law_of

   !> Sort the joints into batches of one kind, type, frame rule and law signature
   subroutine fill_batches(property, joint, model)
      type(property_t), intent(in) :: property(:)
      type(joint_t), intent(in) :: joint(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: key(:, :), batch_of(:), ends(:, :), count_of(:)
      integer :: j, b, n, mine(NDOF + 4)

      allocate (key(NDOF + 4, size(joint)), batch_of(size(joint)), count_of(size(joint)))
      n = 0
      do j = 1, size(joint)
         associate (p => property(joint(j)%property))
            mine = [p%row, p%frame, p%kind, merge(1, 0, p%limited), joint(j)%law]
            if (allocated(p%spring)) mine(4) = merge(2, 0, p%spring%hardened)
            if (joint(j)%rule > 0) mine(2) = joint(j)%rule
         end associate
         do b = 1, n
            if (all(key(:, b) == mine)) exit
         end do
         if (b > n) then
            n = b
            key(:, b) = mine
            count_of(b) = 0
         end if
         batch_of(j) = b
         count_of(b) = count_of(b) + 1
      end do
      allocate (model%batch(n), ends(2, size(joint)))
      do b = 1, n
         call new_batch(count_of(b), model%batch(b))
         model%batch(b)%first = sum(count_of(:b - 1))
         model%batch(b)%row = key(1, b)
         model%batch(b)%frame = key(2, b)
         model%batch(b)%kind = key(3, b)
         model%batch(b)%law = key(5:, b)
         if (key(4, b) == 1) call new_limits(model%batch(b))
         if (is_spring(model%batch(b))) allocate (model%batch(b)%spring(count_of(b)))
      end do
      count_of(:n) = 0
      do j = 1, size(joint)
         b = batch_of(j)
         count_of(b) = count_of(b) + 1
         call put_joint(property(joint(j)%property), joint(j), model%lead, count_of(b), &
            model%batch(b))
         if (is_spring(model%batch(b))) call put_spring(model, property(joint(j)%property)%spring, &
            joint(j)%node, model%batch(b)%spring(count_of(b)))
         ends(:, model%batch(b)%first + count_of(b)) = model%lead(joint(j)%node)
         model%joint(j)%batch = b
         model%joint(j)%place = count_of(b)
         model%joint(j)%node = joint(j)%node
         model%joint(j)%row = key(1, b)
         model%joint(j)%property = property(joint(j)%property)%id
      end do
      call build_lead_map(model%n_lead, ends, model%map)
   end subroutine fill_batches

   !> Constants of one joint into place i of its batch
   pure subroutine put_joint(p, joint, lead, i, batch)
      type(property_t), intent(in) :: p
      type(joint_t), intent(in) :: joint
      integer, intent(in) :: lead(:), i
      type(joint_batch_t), intent(inout) :: batch

      integer :: dof, s

      batch%node(i, :) = joint%node
      batch%lead(i, :) = lead(joint%node)
      batch%skew(i, :) = joint%skew
      batch%xl0(i, :) = joint%xl0
      batch%frame0(i, :) = reshape(joint%frame, [9])
      batch%k(i, :) = joint%k
      batch%c(i, :) = joint%c
      batch%angle0(i, :) = joint%angle
      batch%cr(i) = p%cr
      if (all(joint_types(p%row)%free == 1)) batch%cr(i) = 0.0_wp
      batch%reduced(i, :) = joint%reduced
      batch%scale(i) = p%scf
      batch%k_curve(i, :) = p%k_curve
      batch%c_curve(i, :) = p%c_curve
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         if (iand(joint%law(dof), LAW_SPRING) /= 0) &
            batch%k_top(i, s) = max(batch%k_top(i, s), joint%k(dof))
         if (iand(joint%law(dof), LAW_DAMPER) /= 0 .and. joint_types(p%row)%free(dof) == 1) &
            batch%c_top(i, s) = max(batch%c_top(i, s), joint%c(dof))
      end do
      if (is_spring(batch)) then
         batch%k_top(i, :) = joint%top(1:2)
         batch%c_top(i, :) = joint%top(3:4)
      end if
      if (batch%limited) call put_limits(p, joint, i, batch%limit)
   end subroutine put_joint

   !> Constants of a spring, with the own masses of its ends
   pure subroutine put_spring(model, property, node, spring)
      type(model_t), intent(in) :: model
      type(spring_t), intent(in) :: property
      integer, intent(in) :: node(2)
      type(spring_t), intent(out) :: spring

      spring = property
      spring%node_mass = model%node_mass(node)
      spring%node_inertia = model%node_inertia(node)
   end subroutine put_spring

   pure subroutine put_limits(p, joint, i, limit)
      type(property_t), intent(in) :: p
      type(joint_t), intent(in) :: joint
      integer, intent(in) :: i
      type(limits_t), intent(inout) :: limit

      limit%lo(i, :) = p%lo
      limit%hi(i, :) = p%hi
      limit%combined(i, :) = real(p%combined, wp)
      limit%k(i, :) = p%k_limit
      limit%slip(i, :) = p%slip
      limit%slip_curve(i, :) = p%slip_curve
      limit%cr(i) = p%cr
      limit%cr_stop(i) = p%cr_stop
      limit%k_block(i, :) = joint%k_block
      limit%automatic(i) = p%automatic
      limit%t_lock(i) = p%t_lock
      limit%t_free(i) = p%t_free
   end subroutine put_limits

   !> Multiply the stiffness of blocked directions by a factor and their damping by its root, so
   !> that the damping ratio stays
   pure subroutine scale_blocking(model, factor)
      type(model_t), intent(inout) :: model
      real(wp), intent(in) :: factor             !! above 0

      integer :: b

      do b = 1, size(model%batch)
         if (.not. is_spring(model%batch(b))) call scale_batch(model%batch(b), factor)
      end do
   end subroutine scale_blocking

   pure subroutine scale_batch(batch, factor)
      type(joint_batch_t), intent(inout) :: batch
      real(wp), intent(in) :: factor

      integer :: dof, s

      batch%k_top = 0.0_wp
      do dof = 1, NDOF
         if (joint_types(batch%row)%free(dof) == 0) then
            batch%k(:, dof) = factor*batch%k(:, dof)
            batch%c(:, dof) = sqrt(factor)*batch%c(:, dof)
         end if
         s = merge(1, 2, dof <= 3)
         if (iand(batch%law(dof), LAW_SPRING) /= 0) &
            batch%k_top(:, s) = max(batch%k_top(:, s), batch%k(:, dof))
      end do
      if (batch%limited) batch%limit%k_block = factor*batch%limit%k_block
   end subroutine scale_batch

   !> The fields that are set for a joint: its property becomes one of its own. Values are in work
   !> units.
   !>
   !> Errors: findings KJ-9431 for an unknown field or no number, those of a property
   subroutine set_fields(draft, id, property)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: id                  !! of the element
      integer, intent(inout) :: property         !! place in draft%properties

      type(cards_t) :: cards
      type(property_t) :: own
      type(finding_list_t) :: before
      integer :: i

      if (.not. allocated(draft%joint_setting)) return
      do i = 1, size(draft%joint_setting)
         if (joint_of(draft, i) /= str(id)) cycle
         draft%joint_set(i) = .true.
         if (cards%n == 0) then                  ! what its cards have to say is said already
            before = draft%deck%findings
            call read_cards(draft%deck, draft%property_block(property), cards)
            draft%deck%findings = before
         end if
         call put_field(draft, i, cards)
      end do
      if (cards%n == 0) return
      call read_property(draft, cards, own)
      draft%properties = [draft%properties, own]
      property = size(draft%properties)
   end subroutine set_fields

   !> One value; a field K_rx is also Krx, as /PROP/KJOINT has it, and kn is Kn
   subroutine put_field(draft, i, cards)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: i                   !! place among the settings
      type(cards_t), intent(inout) :: cards

      type(error_t), allocatable :: error
      real(wp) :: value
      integer :: dot, line, status
      logical :: found

      associate (name => draft%joint_setting(i)%name, text => draft%joint_setting(i)%value)
         call parse_real(text, value, status)
         dot = index(name, '.')
         line = index(name, '_')
         call put_real(cards, name(dot + 1:), value, found)
         if (.not. found .and. line > dot) call put_real(cards, name(dot + 1:line - 1)// &
            name(line + 1:), value, found)
         if (found .and. status == NUMBER_FINE) return
         if (found) then
            call fail(error, ERR_INPUT, '"'//text//'" is no number for '//name, 'KJ-9431')
         else
            call fail(error, ERR_INPUT, 'joint '//name(:dot - 1)//' has no number '// &
               name(dot + 1:), 'KJ-9431')
            error%hint = trim(did_you_mean(name(dot + 1:), pack(cards%name, cards%is_real)))
         end if
         call add_finding(draft%deck%findings, error)
      end associate
   end subroutine put_field

   !> Settings for joints that there are not. Errors: findings KJ-9430
   subroutine report_unset(draft)
      type(draft_t), intent(inout) :: draft

      type(error_t), allocatable :: error
      integer :: i

      if (.not. allocated(draft%joint_setting)) return
      do i = 1, size(draft%joint_setting)
         if (draft%joint_set(i)) cycle
         call fail(error, ERR_INPUT, 'there is no joint "'//joint_of(draft, i)// &
            '" to set a field of', 'KJ-9430')
         call add_finding(draft%deck%findings, error)
      end do
   end subroutine report_unset

   !> The joint that a setting means: its id as a text
   pure function joint_of(draft, i) result(id)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: i
      character(len=index(draft%joint_setting(i)%name//'.', '.') - 1) :: id

      id = draft%joint_setting(i)%name
   end function joint_of

end module kj_build_joint
