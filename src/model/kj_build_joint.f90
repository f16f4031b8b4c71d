!> Cards -> model: joint properties, spring elements, and their batches.
module kj_build_joint
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_math3, only: cross, unit, rotation, rotation_vector
   use kj_sort, only: find, lookup_t, new_lookup
   use kj_joint_types, only: joint_types, find_joint_type, NDOF, DOF_NAME, FRAME_MEAN, FRAME_FIRST, FRAME_CROSS
   use kj_joint_batch, only: joint_batch_t, new_batch, LAW_SPRING, LAW_DAMPER, LAW_SPRING_CURVE, LAW_DAMPER_CURVE
   use kj_assembly, only: build_lead_map
   use kj_keywords, only: KW_KJOINT, KW_PART, KW_SPRING
   use kj_deck_data, only: deck_t, title_of
   use kj_cards, only: cards_t, rows_t, read_cards, read_rows, real_of, int_of, is_given, report, report_row
   use kj_draft, only: draft_t, blocks_of, block_lookup, reference
   use kj_model, only: model_t
   implicit none
   private

   public :: build_joints

   !> A /PROP/KJOINT, checked
   type :: property_t
      integer :: id = 0
      integer :: row = 0                        !! row of kj_joint_types, 0 = not usable
      integer :: frame = 0                      !! FRAME_ constant
      integer :: skew(2) = 0                    !! skew indices
      real(wp) :: kn = 0.0_wp, cr = 0.0_wp
      real(wp) :: k(NDOF) = 0.0_wp, c(NDOF) = 0.0_wp      !! of the free dofs
      integer :: k_curve(NDOF) = 0, c_curve(NDOF) = 0
   end type property_t

   !> A spring element on its way into a batch
   type :: joint_t
      integer :: property = 0                   !! place in the list of properties
      integer :: node(2) = 0                    !! model indices
      integer :: skew(2) = 0
      real(wp) :: frame(3, 3) = 0.0_wp, xl0(3) = 0.0_wp, reduced(2) = 0.0_wp
      real(wp) :: k(NDOF) = 0.0_wp, c(NDOF) = 0.0_wp
      integer :: law(NDOF) = 0
   end type joint_t

contains

   !> All joints of the deck
   subroutine build_joints(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(property_t), allocatable :: property(:)
      type(joint_t), allocatable :: joint(:)
      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      type(lookup_t) :: parts
      integer, allocatable :: part_property(:)
      integer :: i

      blocks = blocks_of(deck, KW_KJOINT)
      call block_lookup(deck, blocks, draft%property)
      allocate (property(size(blocks)))
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         if (count(deck%block(blocks)%id == deck%block(blocks(i))%id) > 1) &
            call report(deck, cards, 'type', SEV_ERROR, 'KJ-0079', 'property '// &
            str(deck%block(blocks(i))%id)//' is defined twice', 'used before', findings)
         call read_property(deck, cards, draft, property(i), findings)
      end do
      draft%part_block = blocks_of(deck, KW_PART)
      call block_lookup(deck, draft%part_block, parts)
      allocate (part_property(size(draft%part_block)))
      do i = 1, size(draft%part_block)
         call read_cards(deck, draft%part_block(i), cards, findings)
         part_property(i) = reference(deck, cards, 'prop_id', draft%property, 'property', 'KJ-0178', findings)
      end do
      call read_springs(deck, draft, parts, part_property, property, joint, model, findings)
      if (findings%n_error == 0) call fill_batches(property, joint, model)
   end subroutine build_joints

   !> Check one property; row stays 0 when the type is not known
   subroutine read_property(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(property_t), intent(out) :: p
      type(finding_list_t), intent(inout) :: findings

      p%id = deck%block(cards%block)%id
      p%row = find_joint_type(int_of(cards, 'type'))
      if (p%row == 0) then
         call report(deck, cards, 'type', SEV_ERROR, 'KJ-0409', 'there is no joint type '// &
            str(int_of(cards, 'type')), 'expected: 1 to 9', findings)
         return
      end if
      if (int_of(cards, 'skew_1') <= 0) call report(deck, cards, 'skew_1', SEV_ERROR, 'KJ-0386', &
         'the joint has no skew on body 1', 'expected: id of a moving skew', findings)
      p%skew(1) = reference(deck, cards, 'skew_1', draft%skew, 'skew', 'KJ-0926', findings)
      p%skew(2) = reference(deck, cards, 'skew_2', draft%skew, 'skew', 'KJ-0926', findings)
      p%cr = real_of(cards, 'Cr')
      if (p%cr < 0.0_wp .or. p%cr > 1.0_wp) call report(deck, cards, 'Cr', SEV_ERROR, 'KJ-0388', &
         'the critical damping ratio is not between 0 and 1', 'expected: 0 to 1', findings)
      if (abs(p%cr) <= 0.0_wp) p%cr = 0.05_wp
      if (all(joint_types(p%row)%free == 1)) then
         p%cr = 0.0_wp
      else
         p%kn = real_of(cards, 'Kn')
         if (abs(p%kn) <= 0.0_wp) call report(deck, cards, 'Kn', SEV_ERROR, 'KJ-0387', &
            'the blocking stiffness is zero', 'expected: a positive stiffness', findings)
         if (p%kn < 0.0_wp) call report(deck, cards, 'Kn', SEV_ERROR, 'KJ-9118', &
            'the blocking stiffness is negative', 'expected: a positive stiffness', findings)
      end if
      call choose_frame(deck, cards, draft, p, findings)
      call read_free_dofs(deck, cards, draft, p, findings)
   end subroutine read_property

   !> Frame rule of a property, and the checks of its skews
   subroutine choose_frame(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: dot

      p%frame = joint_types(p%row)%frame
      if (p%frame == FRAME_CROSS) then
         if (int_of(cards, 'skew_2') == 0) call report(deck, cards, 'skew_2', SEV_ERROR, 'KJ-0926', &
            'a universal joint needs a skew on body 2', 'expected: id of a moving skew', findings)
         if (any(p%skew == 0)) return
         dot = dot_product(draft%skews%axes(p%skew(1), 1:3), draft%skews%axes(p%skew(2), 1:3))
         if (dot > 1.0e-10_wp) call report(deck, cards, 'skew_2', SEV_ERROR, 'KJ-0389', &
            'the x axes of the two skews of a universal joint are not perpendicular: '// &
            angle_text(dot)//' degrees', 'expected: 90 degrees to skew_1', findings)
         return
      end if
      if (int_of(cards, 'skew_flag') == 1) p%frame = FRAME_FIRST
      if (p%frame == FRAME_MEAN .and. int_of(cards, 'skew_2') == 0) then
         p%frame = FRAME_FIRST
         call report(deck, cards, 'skew_2', SEV_WARNING, 'KJ-9119', &
            'without a second skew the joint frame is that of body 1 (as skew flag 1)', &
            'no skew on body 2', findings, hint='OpenRadioss works on undefined data here: set the skew flag to 1')
      end if
   end subroutine choose_frame

   function angle_text(cosine) result(text)
      real(wp), intent(in) :: cosine
      character(len=:), allocatable :: text

      character(len=12) :: buffer

      write (buffer, '(f12.4)') acos(max(-1.0_wp, min(1.0_wp, cosine)))*45.0_wp/atan(1.0_wp)
      text = trim(adjustl(buffer))
   end function angle_text

   !> Stiffness, damping and curves of the free dofs; a scale 0 of a curve means 1
   subroutine read_free_dofs(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      integer :: i

      do i = 1, NDOF
         if (joint_types(p%row)%free(i) == 0) cycle
         p%k(i) = real_of(cards, 'K'//DOF_NAME(i))
         p%c(i) = real_of(cards, 'C'//DOF_NAME(i))
         p%k_curve(i) = reference(deck, cards, 'f_K'//DOF_NAME(i), draft%curve, 'function', 'KJ-3126', findings)
         p%c_curve(i) = reference(deck, cards, 'f_C'//DOF_NAME(i), draft%curve, 'function', 'KJ-3126', findings)
         if (p%k_curve(i) > 0 .and. abs(p%k(i)) <= 0.0_wp) p%k(i) = 1.0_wp
         if (p%c_curve(i) > 0 .and. abs(p%c(i)) <= 0.0_wp) p%c(i) = 1.0_wp
      end do
   end subroutine read_free_dofs

   !> /SPRING elements of joint properties
   subroutine read_springs(deck, draft, parts, part_property, property, joint, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(lookup_t), intent(in) :: parts
      integer, intent(in) :: part_property(:)
      type(property_t), intent(in) :: property(:)
      type(joint_t), allocatable, intent(out) :: joint(:)
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(rows_t), allocatable :: rows(:)
      integer :: b, i, n, part

      blocks = blocks_of(deck, KW_SPRING)
      allocate (rows(size(blocks)))
      do b = 1, size(blocks)
         call read_rows(deck, blocks(b), rows(b), findings)
      end do
      n = sum(rows%n)
      allocate (joint(n), model%joint(n), model%joint_name(n))
      n = 0
      do b = 1, size(blocks)
         part = find(parts, deck%block(blocks(b))%id)
         if (part == 0) then
            if (rows(b)%n > 0) call report_row(deck, blocks(b), rows(b), 1, 'id', SEV_ERROR, 'KJ-0402', &
               'part '//str(deck%block(blocks(b))%id)//' of these elements is not defined', &
               'element without a part', findings)
            cycle
         end if
         if (part_property(part) == 0) cycle
         do i = 1, rows(b)%n
            n = n + 1
            joint(n)%property = part_property(part)
            model%joint(n)%id = rows(b)%ints(i, 1)
            model%joint(n)%part = deck%block(blocks(b))%id
            model%joint_name(n)%s = title_of(deck, draft%part_block(part))
            call attach(deck, blocks(b), rows(b), i, draft, model, property, joint(n), findings)
         end do
      end do
      model%n_joint = n
      joint = joint(:n)
      model%joint = model%joint(:n)
      call report_double_joints(deck, blocks, rows, findings)
   end subroutine read_springs

   subroutine report_double_joints(deck, blocks, rows, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:)
      type(rows_t), intent(in) :: rows(:)
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: id(:), block(:), row(:)
      type(lookup_t) :: lookup
      integer :: b, i

      allocate (id(0), block(0), row(0))
      do b = 1, size(rows)
         id = [id, rows(b)%ints(:rows(b)%n, 1)]
         block = [block, spread(b, 1, rows(b)%n)]
         row = [row, [(i, i=1, rows(b)%n)]]
      end do
      call new_lookup(id, lookup)
      do i = 2, size(id)
         if (lookup%id(i) /= lookup%id(i - 1)) cycle
         b = block(lookup%place(i))
         call report_row(deck, blocks(b), rows(b), row(lookup%place(i)), 'id', SEV_ERROR, 'KJ-0079', &
            'element '//str(lookup%id(i))//' is defined twice', 'used before', findings)
      end do
   end subroutine report_double_joints

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

      character(len=2), parameter :: FIELD(2) = ['n1', 'n2']
      integer :: e, raw

      do e = 1, 2
         raw = find(draft%node, rows%ints(i, e + 1))
         if (raw == 0) then
            call report_row(deck, block, rows, i, FIELD(e), SEV_ERROR, 'KJ-0078', 'node '// &
               str(rows%ints(i, e + 1))//' is not defined', 'no such node', findings)
            return
         end if
         joint%node(e) = draft%new(raw)
         if (draft%main_of(raw) > 0) call report_row(deck, block, rows, i, FIELD(e), SEV_ERROR, 'KJ-1768', &
            'node '//str(draft%id(raw))//' of the joint is the main node of a rigid body', &
            'expected: a secondary node', findings)
         if (draft%main_of(raw) == 0 .and. draft%body(raw) == 0) call report_row(deck, block, rows, i, &
            FIELD(e), SEV_WARNING, 'KJ-0391', 'node '//str(draft%id(raw))// &
            ' of the joint belongs to no rigid body', 'free node', findings)
      end do
      if (joint%node(1) == joint%node(2)) then
         call report_row(deck, block, rows, i, 'n2', SEV_ERROR, 'KJ-9120', &
            'both ends of the joint are the same node', 'same as n1', findings)
         return
      end if
      if (property(joint%property)%row == 0) return
      call match_skews(deck, block, rows, i, draft, model, property(joint%property), joint, findings)
      call start_frame(deck, block, rows, i, draft, property(joint%property), joint, findings)
      call set_constants(model, property(joint%property), joint)
   end subroutine attach

   !> Skews of a joint against the bodies of its nodes; crosswise skews are swapped
   subroutine match_skews(deck, block, rows, i, draft, model, p, joint, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, i
      type(rows_t), intent(in) :: rows
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint
      type(finding_list_t), intent(inout) :: findings

      integer :: e, s, body(2), owner(2)

      joint%skew = p%skew
      do e = 1, 2
         body(e) = model%lead(joint%node(e))
         if (body(e) > model%n_body) body(e) = 0
         owner(e) = -1
         s = p%skew(e)
         if (s == 0) cycle
         if (any(draft%skews%node(:, s) == 0)) cycle
         owner(e) = draft%body(draft%skews%node(1, s))
         if (any(draft%body(draft%skews%node(:, s)) /= owner(e))) owner(e) = 0
         if (owner(e) == 0 .and. body(e) > 0) call report_row(deck, block, rows, i, 'id', SEV_WARNING, &
            'KJ-0919', 'the nodes of skew '//str(draft%skews%id(s))// &
            ' are not all secondary nodes of one rigid body', 'joint with this skew', findings)
      end do
      if (any(owner <= 0)) return
      if (body(1) /= body(2) .and. all(owner == body(2:1:-1))) then
         joint%skew = p%skew(2:1:-1)
         call report_row(deck, block, rows, i, 'id', SEV_WARNING, 'KJ-0921', &
            'the skews of the joint stand crosswise to its nodes: they were swapped', 'swapped', findings)
      else if (any(owner /= body)) then
         call report_row(deck, block, rows, i, 'id', SEV_WARNING, 'KJ-0920', &
            'a skew of the joint belongs to another body than its node', 'joint with this skew', findings)
      end if
   end subroutine match_skews

   !> Initial frame by the rule of the property.
   !> Source: legacy_scheme.md 4.2.
   subroutine start_frame(deck, block, rows, i, draft, p, joint, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, i
      type(rows_t), intent(in) :: rows
      type(draft_t), intent(in) :: draft
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: u(3, 3), v(3, 3), half(3)

      u = reshape(draft%skews%axes(joint%skew(1), :), [3, 3])
      v = reshape(draft%skews%axes(joint%skew(2), :), [3, 3])
      select case (p%frame)
      case (FRAME_FIRST)
         joint%frame = u
      case (FRAME_MEAN)
         half = 0.5_wp*rotation_vector(matmul(transpose(u), v))
         joint%frame = matmul(u, rotation(half))
         if (norm2(half) > 2.0_wp*atan(1.0_wp) - 1.0e-6_wp) call report_row(deck, block, rows, i, 'id', &
            SEV_ERROR, 'KJ-9121', 'the skews of the joint are 180 degrees apart: they have no mean frame', &
            'joint with these skews', findings)
      case default   ! FRAME_CROSS
         joint%frame(:, 1) = unit(cross(u(:, 1), v(:, 1)))
         joint%frame(:, 2) = u(:, 1)
         joint%frame(:, 3) = v(:, 1)
      end select
   end subroutine start_frame

   !> Reference offset, reduced masses, stiffness and damping of all six dofs, law signature.
   !>
   !> KR = Kn max(1, L0^2); critical damping Cr sqrt(K m) on the blocked dofs.
   !> Source: legacy_scheme.md 4.1, 4.3.
   subroutine set_constants(model, p, joint)
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      real(wp) :: r(3), m(2), inertia(2), mass
      integer :: e, dof, lead

      r = model%x0(joint%node(2), :) - model%x0(joint%node(1), :)
      joint%xl0 = matmul(r, joint%frame)
      m = 0.0_wp
      inertia = 0.0_wp
      do e = 1, 2
         lead = model%lead(joint%node(e))
         if (lead > model%n_body) cycle
         m(e) = model%mass(lead)
         inertia(e) = sum(model%principal(lead, :))/3.0_wp
      end do
      if (sum(m) > 0.0_wp) joint%reduced(1) = product(m)/sum(m)
      if (sum(inertia) > 0.0_wp) joint%reduced(2) = product(inertia)/sum(inertia)
      joint%k = p%k
      joint%c = p%c
      joint%law = 0
      do dof = 1, NDOF
         if (joint_types(p%row)%free(dof) == 0) then
            joint%k(dof) = p%kn
            if (dof > 3) joint%k(dof) = p%kn*max(1.0_wp, dot_product(r, r))
            mass = joint%reduced(merge(1, 2, dof <= 3))
            joint%c(dof) = p%cr*sqrt(joint%k(dof)*mass)
         end if
         joint%law(dof) = law_of(joint%k(dof), p%k_curve(dof), LAW_SPRING, LAW_SPRING_CURVE) + &
            law_of(joint%c(dof), p%c_curve(dof), LAW_DAMPER, LAW_DAMPER_CURVE)
      end do
   end subroutine set_constants

   pure integer function law_of(value, curve, linear, tabulated) result(law)
      real(wp), intent(in) :: value
      integer, intent(in) :: curve, linear, tabulated

      law = 0
      if (abs(value) > 0.0_wp) law = linear
      if (curve > 0) law = tabulated
   end function law_of

   !> Sort the joints into batches of one type, frame rule and law signature
   subroutine fill_batches(property, joint, model)
      type(property_t), intent(in) :: property(:)
      type(joint_t), intent(in) :: joint(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: key(:, :), batch_of(:), ends(:, :), count_of(:)
      integer :: j, b, n, mine(NDOF + 2)

      allocate (key(NDOF + 2, size(joint)), batch_of(size(joint)), count_of(size(joint)))
      n = 0
      do j = 1, size(joint)
         mine = [property(joint(j)%property)%row, property(joint(j)%property)%frame, joint(j)%law]
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
         model%batch(b)%law = key(3:, b)
      end do
      count_of(:n) = 0
      do j = 1, size(joint)
         b = batch_of(j)
         count_of(b) = count_of(b) + 1
         call put_joint(property(joint(j)%property), joint(j), model%lead, count_of(b), model%batch(b))
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
      batch%cr(i) = p%cr
      batch%reduced(i, :) = joint%reduced
      batch%k_curve(i, :) = p%k_curve
      batch%c_curve(i, :) = p%c_curve
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         if (iand(joint%law(dof), LAW_SPRING) /= 0) &
            batch%k_top(i, s) = max(batch%k_top(i, s), joint%k(dof))
         if (iand(joint%law(dof), LAW_DAMPER) /= 0 .and. joint_types(p%row)%free(dof) == 1) &
            batch%c_top(i, s) = max(batch%c_top(i, s), joint%c(dof))
      end do
   end subroutine put_joint

end module kj_build_joint
