!> Cards -> model: joint properties, spring elements, and their batches.
module kj_build_joint
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: find
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: KJOINT, KJOINT2, SPRING4, SPRING8, LAW_SPRING, LAW_DAMPER, &
      LAW_SPRING_CURVE, LAW_DAMPER_CURVE
   use kj_keywords, only: KW_KJOINT, KW_KJOINT2
   use kj_deck_text, only: deck_t, title_of
   use kj_cards, only: cards_t, rows_t, read_cards, report_row
   use kj_draft, only: draft_t, blocks_of
   use kj_model, only: model_t
   use kj_joint_draft, only: property_t, joint_t
   use kj_build_property, only: read_property
   use kj_build_property2, only: read_property2
   use kj_attach_joint, only: match_skews, frame_of_skews, frame_of_nodes, angles_of_skews
   use kj_build_batch, only: fill_batches
   use kj_attach_spring, only: attach_spring, weigh_springs
   implicit none
   private

   public :: build_joints, set_constants

contains

   !> All joints and springs of the deck
   subroutine build_joints(deck, draft, springs, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(in) :: springs(:)   !! properties of springs
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(property_t), allocatable :: property(:)
      type(joint_t), allocatable :: joint(:)
      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i

      blocks = [blocks_of(deck, KW_KJOINT), blocks_of(deck, KW_KJOINT2)]
      allocate (property(size(blocks)))
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         if (deck%block(blocks(i))%keyword == KW_KJOINT2) then
            call read_property2(deck, cards, draft, property(i), findings)
         else
            call read_property(deck, cards, draft, property(i), findings)
         end if
      end do
      property = [property, springs]
      allocate (joint(draft%elements%n), model%joint(draft%elements%n), &
         model%joint_name(draft%elements%n))
      call attach_elements(deck, draft, property, 1, size(blocks), joint, model, findings)
      model%n_joint = model%n_element
      call attach_elements(deck, draft, property, size(blocks) + 1, size(property), joint, model, &
         findings)
      model%n_spring = model%n_element - model%n_joint
      joint = joint(:model%n_element)
      model%joint = model%joint(:model%n_element)
      if (findings%n_error > 0) return
      call weigh_springs(model, model%n_joint, joint)
      call fill_batches(property, joint, model)
   end subroutine build_joints

   !> Elements of the parts whose property is one from `least` to `most`, after those that are there
   subroutine attach_elements(deck, draft, property, least, most, joint, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(property_t), intent(in) :: property(:)
      integer, intent(in) :: least, most
      type(joint_t), intent(inout) :: joint(:)
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      integer :: b, i, n, part

      n = model%n_element
      do b = 1, size(draft%elements%block)
         associate (block => draft%elements%block(b), rows => draft%elements%rows(b))
            part = find(draft%part, deck%block(block)%id)
            if (part == 0) cycle
            if (draft%part_property(part) == 0) cycle
            if (draft%part_property(part) < least .or. draft%part_property(part) > most) cycle
            do i = 1, rows%n
               n = n + 1
               joint(n)%property = draft%part_property(part)
               model%joint(n)%id = rows%ints(i, 1)
               model%joint(n)%part = deck%block(block)%id
               model%joint_name(n)%s = title_of(deck, draft%part_block(part))
               call attach(deck, block, rows, i, draft, model, property, joint(n), findings)
            end do
         end associate
      end do
      model%n_element = n
   end subroutine attach_elements

   !> Nodes, bodies, initial frame and constants of one element
   subroutine attach(deck, block, rows, i, draft, model, property, joint, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, i
      type(rows_t), intent(in) :: rows
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: property(:)
      type(joint_t), intent(inout) :: joint
      type(finding_list_t), intent(inout) :: findings

      integer :: given, raw(6)

      call find_nodes(deck, block, rows, i, draft, given, raw, findings)
      if (any(raw(:given) == 0)) return
      joint%node = draft%new(raw(:2))
      associate (p => property(joint%property))
         if (raw(1) == raw(2)) then
            call report_row(deck, block, rows, i, 'n2', SEV_ERROR, 'KJ-9120', &
               'both ends of the element are the same node', 'same as n1', findings)
            return
         end if
         if (p%kind == SPRING4 .or. p%kind == SPRING8) then
            call attach_spring(deck, block, rows, i, draft, model, p, joint, findings)
            return
         end if
         call check_ends(deck, block, rows, i, draft, model, p%kind, raw(:2), findings)
         if (p%row == 0) return
         if (p%kind == KJOINT2) then
            given = min(given, 4)
            raw(given + 1:) = raw(1)
            call frame_of_nodes(deck, block, rows, i, draft, &
               transpose(model%x0(draft%new(raw(:4)), :)), given, p, joint, findings)
            call angles_of_skews(deck, block, rows, i, draft, p, joint, findings)
         else
            call match_skews(deck, block, rows, i, draft, model, p, joint, findings)
            call frame_of_skews(deck, block, rows, i, draft, p, joint, findings)
         end if
         call set_constants(model, p, joint)
      end associate
   end subroutine attach

   !> The nodes of an element: two, and those after them up to the first 0
   subroutine find_nodes(deck, block, rows, i, draft, given, raw, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, i
      type(rows_t), intent(in) :: rows
      type(draft_t), intent(in) :: draft
      integer, intent(out) :: given              !! 2 to 6
      integer, intent(out) :: raw(6)             !! raw node indices, 0 = not defined
      type(finding_list_t), intent(inout) :: findings

      character(len=2), parameter :: FIELD(6) = ['n1', 'n2', 'n3', 'n4', 'n5', 'n6']
      integer :: e

      raw = 0
      given = 6
      do e = 1, 6
         if (e > 2 .and. rows%ints(i, e + 1) == 0) then
            given = e - 1
            exit
         end if
         raw(e) = find(draft%node, rows%ints(i, e + 1))
         if (raw(e) == 0) call report_row(deck, block, rows, i, FIELD(e), SEV_ERROR, 'KJ-0078', &
            'node '//str(rows%ints(i, e + 1))//' is not defined', 'no such node', findings)
      end do
   end subroutine find_nodes

   !> Ends are secondary nodes of bodies; a KJOINT2 takes a node with mass, too
   subroutine check_ends(deck, block, rows, i, draft, model, kind, raw, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, i
      type(rows_t), intent(in) :: rows
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      integer, intent(in) :: kind, raw(2)
      type(finding_list_t), intent(inout) :: findings

      character(len=2), parameter :: FIELD(2) = ['n1', 'n2']
      integer :: e

      do e = 1, 2
         if (draft%main_of(raw(e)) > 0) call report_row(deck, block, rows, i, FIELD(e), SEV_ERROR, &
            'KJ-1768', 'node '//str(draft%id(raw(e)))// &
            ' of the joint is the main node of a rigid body', &
            'expected: a secondary node', findings)
         if (draft%main_of(raw(e)) > 0 .or. draft%body(raw(e)) > 0) cycle
         if (kind == KJOINT) then
            call report_row(deck, block, rows, i, FIELD(e), SEV_WARNING, 'KJ-0391', 'node '// &
               str(draft%id(raw(e)))//' of the joint belongs to no rigid body', 'free node', &
               findings)
         else if (.not. model%mass(model%lead(draft%new(raw(e)))) > 0.0_wp) then
            call report_row(deck, block, rows, i, FIELD(e), SEV_ERROR, 'KJ-9130', 'node '// &
               str(draft%id(raw(e)))//' of the joint has no mass and belongs to no rigid body', &
               'expected: a secondary node, or a node with mass', findings)
         end if
      end do
   end subroutine check_ends

   !> Reference offset, reduced masses, stiffness and damping of all six dofs, law signature.
   !>
   !> KR = Kn max(1, L0^2), for KJOINT2 Kn max(SCF, L0^2); critical damping Cr sqrt(K m) on the
   !> blocked dofs. Source: docs/theory/legacy.md 3.1, 3.2.
   subroutine set_constants(model, p, joint)
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      real(wp) :: r(3), least
      integer :: dof, s

      r = model%x0(joint%node(2), :) - model%x0(joint%node(1), :)
      joint%xl0 = matmul(r, joint%frame)
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

end module kj_build_joint
