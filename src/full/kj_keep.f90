!> What of a full deck belongs to its mechanism: bodies, the springs that hang on them, and what
!> these name. Source: docs/theory/full.md 4.
!> One file: marks on blocks, ids and nodes that fill each other until nothing is added.
module kj_keep
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, find, find_root
   use kj_keywords, only: keywords, KW_KJOINT, KW_KJOINT2, KW_SPRING4, KW_BCS, KW_GRAV, &
      KW_CLOAD, KW_IMPVEL, KW_IMPDISP, KW_IMPACC, &
      KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS, KW_TH_NODE
   use kj_deck_text, only: first_card, report_header, report_line, line_text
   use kj_card_lists, only: th_t, read_th
   use kj_card_cut, only: cut_t, cut_card
   use kj_number, only: parse_integer, NUMBER_FINE
   use kj_deck_flat, only: ids_on_card, id_columns_t
   use kj_field, only: OF_SKEW, OF_FRAME, OF_FUNCTION, OF_SENSOR
   use kj_cards, only: cards_t, read_cards, int_of, report, report_row
   use kj_draft, only: draft_t, unsupported
   implicit none
   private

   public :: keep_t, decide, body_of

   !> Conditions that act on nodes of a group
   integer, parameter :: CONDITIONS(*) = [KW_BCS, KW_GRAV, KW_CLOAD, KW_IMPVEL, KW_IMPDISP, &
      KW_IMPACC, KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS]

   !> Marks
   type :: keep_t
      logical, allocatable :: node(:)            !! (n_node)
      logical, allocatable :: spring(:)          !! (elements) of draft%elements
      logical, allocatable :: part(:), property(:)   !! (parts), (property_block)
      logical, allocatable :: block(:)           !! (n_block) conditions that still act
      logical, allocatable :: group(:), curve(:), sensor(:)
      logical, allocatable :: skew(:), frame(:)
      !> written with their axes at the start
      logical, allocatable :: fixed_skew(:), fixed_frame(:)
      integer :: n_free = 0                      !! nodes of no body among those kept
      integer :: n_lost = 0                      !! conditions that lost all their nodes
   end type keep_t

contains

   !> Body of a node, main or secondary; 0 = none
   pure integer function body_of(draft, raw) result(body)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: raw                 !! raw index, 0 = none

      body = 0
      if (raw == 0) return
      body = max(draft%body(raw), draft%main_of(raw))
   end function body_of

   !> Mark all that belongs to the mechanism
   subroutine decide(draft, element_mass, keep)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: element_mass(:)    !! (n_node) mass of elements
      type(keep_t), intent(out) :: keep

      integer :: n

      allocate (keep%node(draft%n_node), keep%spring(draft%elements%n), &
         keep%part(size(draft%part_block)), keep%property(size(draft%property_block)), &
         keep%block(draft%deck%n_block), keep%group(size(draft%groups)), &
         keep%curve(draft%curves%n), keep%sensor(size(draft%sensors)), source=.false.)
      n = draft%skews%n
      allocate (keep%skew(n), keep%fixed_skew(n), source=.false.)
      n = draft%frames%n
      allocate (keep%frame(n), keep%fixed_frame(n), source=.false.)
      keep%node = draft%main_of > 0
      call keep_springs(draft, element_mass, keep)
      call keep_conditions(draft, keep)
      call keep_requests(draft, keep)
      call keep_axes(draft, keep)
      call fill_bodies(draft, keep)
      call report_free_nodes(draft, element_mass, keep)
   end subroutine decide

   !> Springs and joints of properties that are read, but those that hang on deformable parts alone
   subroutine keep_springs(draft, element_mass, keep)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: element_mass(:)
      type(keep_t), intent(inout) :: keep

      integer, allocatable :: parent(:)
      logical, allocatable :: tied(:)
      integer :: i, k, raw(6), root, other, n

      allocate (parent(draft%n_node))
      parent = [(i, i=1, draft%n_node)]
      do i = 1, draft%elements%n
         if (.not. is_known(draft, i)) cycle
         call spring_nodes(draft, i, raw, n)
         if (any(raw(:2) == 0)) cycle
         call find_root(raw(1), parent, root)
         call find_root(raw(2), parent, other)
         parent(other) = root
      end do
      allocate (tied(draft%n_node), source=.true.)
      do i = 1, draft%n_node
         call find_root(i, parent, root)
         if (body_of(draft, i) == 0 .and. element_mass(i) > 0.0_wp) tied(root) = .false.
      end do
      do i = 1, draft%n_node
         call find_root(i, parent, root)
         if (body_of(draft, i) > 0) tied(root) = .true.
      end do
      do i = 1, draft%elements%n
         if (.not. is_known(draft, i)) cycle
         call spring_nodes(draft, i, raw, n)
         if (raw(1) > 0) then
            call find_root(raw(1), parent, root)
            if (.not. tied(root)) cycle
         end if
         keep%spring(i) = .true.
         do k = 1, n
            if (raw(k) > 0) keep%node(raw(k)) = .true.
         end do
         keep%part(draft%elements%part(i)) = .true.
         keep%property(draft%part_property(draft%elements%part(i))) = .true.
         call mark_line(draft, draft%elements%card(i)%block, draft%elements%card(i)%line, keep)
      end do
      do i = 1, size(keep%property)
         if (.not. keep%property(i)) cycle
         call mark_block(draft, draft%property_block(i), keep)
         call mark_ranks(draft, draft%property_block(i), keep)
      end do
   end subroutine keep_springs

   !> TYPE4 springs with fct3 count the functions up to it: docs/theory/legacy.md 5.2
   subroutine mark_ranks(draft, block, keep)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      type(keep_t), intent(inout) :: keep

      type(cards_t) :: cards

      if (draft%deck%block(block)%keyword /= KW_SPRING4) return
      call read_cards(draft%deck, block, cards)
      associate (c => draft%curve)
         keep%curve(pack(c%place, c%id <= int_of(cards, 'fct3'))) = .true.
      end associate
   end subroutine mark_ranks

   !> The part of an element has a property that is read
   pure logical function is_known(draft, i)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: i

      is_known = draft%elements%part(i) > 0
      if (is_known) is_known = draft%part_property(draft%elements%part(i)) > 0
   end function is_known

   !> Raw nodes of an element: two ends, then those that span its axes
   pure subroutine spring_nodes(draft, i, raw, n)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: i
      integer, intent(out) :: raw(6), n

      integer :: k

      raw = 0
      n = 2
      raw(:2) = draft%elements%node(:, i)
      do k = 3, 6
         if (draft%elements%card(i)%ints(k + 1) == 0) exit
         raw(k) = find(draft%node, draft%elements%card(i)%ints(k + 1))
         n = k
      end do
   end subroutine spring_nodes

   !> Conditions whose group has a node of a body or a kept free node. A force keeps the secondary
   !> nodes it acts on; the others act on main nodes and free ones
   subroutine keep_conditions(draft, keep)
      type(draft_t), intent(inout) :: draft
      type(keep_t), intent(inout) :: keep

      type(cards_t) :: cards
      integer :: block, group, i, k, keyword
      logical :: acts

      do block = 1, draft%deck%n_block
         keyword = draft%deck%block(block)%keyword
         if (all(CONDITIONS /= keyword)) cycle
         call read_cards(draft%deck, block, cards)
         group = find(draft%group, int_of(cards, 'grnod_id'))
         acts = int_of(cards, 'grnod_id') == 0 .or. group == 0   ! of all nodes, or an error
         if (group > 0) then
            do k = 1, size(draft%groups(group)%node)
               i = draft%groups(group)%node(k)
               if (keyword == KW_CLOAD .and. draft%body(i) > 0) keep%node(i) = .true.
               acts = acts .or. keep%node(i)
            end do
            keep%group(group) = keep%group(group) .or. acts
         end if
         keep%block(block) = acts
         if (acts) then
            call mark_block(draft, block, keep)
         else if (size(draft%groups(group)%node) > 0) then
            keep%n_lost = keep%n_lost + 1
            call report(draft%deck, cards, 'grnod_id', SEV_WARNING, 'KJ-9421', &
               'none of the nodes of this condition is in the mechanism', 'left out')
         end if
      end do
   end subroutine keep_conditions

   !> Nodes of bodies that histories ask for, and the axes they ask for
   subroutine keep_requests(draft, keep)
      type(draft_t), intent(inout) :: draft
      type(keep_t), intent(inout) :: keep

      type(th_t) :: th
      integer :: block, k, raw

      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= KW_TH_NODE) cycle
         call read_th(draft%deck, block, th)
         do k = 1, th%object%n
            raw = find(draft%node, th%object%value(k))
            if (body_of(draft, raw) > 0) keep%node(raw) = .true.
            if (raw == 0) cycle
            if (keep%node(raw)) call mark_line(draft, block, th%object%line(k), keep)
         end do
      end do
   end subroutine keep_requests

   !> Mark what the cards of a block name
   subroutine mark_block(draft, block, keep)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      type(keep_t), intent(inout) :: keep

      integer :: line

      do line = first_card(draft%deck, block), draft%deck%block(block)%last
         call mark_line(draft, block, line, keep)
      end do
   end subroutine mark_block

   !> Mark what a card names: axes, functions, sensors
   subroutine mark_line(draft, block, line, keep)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block, line
      type(keep_t), intent(inout) :: keep

      integer, allocatable :: axes(:), functions(:), sensors(:)

      axes = ids_of_family(draft, block, line, OF_SKEW)
      functions = ids_of_family(draft, block, line, OF_FUNCTION)
      sensors = ids_of_family(draft, block, line, OF_SENSOR)
      call mark(draft%skew, axes, keep%skew)
      call mark(draft%frame, axes, keep%frame)
      call mark(draft%frame, ids_of_family(draft, block, line, OF_FRAME), keep%frame)
      call mark(draft%curve, functions, keep%curve)
      call mark(draft%sensor, sensors, keep%sensor)
      call refuse(draft, draft%curve, 'function', functions, line)
      call refuse(draft, draft%sensor, 'sensor', sensors, line)
   end subroutine mark_line

   pure subroutine mark(lookup, ids, marks)
      type(lookup_t), intent(in) :: lookup
      integer, intent(in) :: ids(:)
      logical, intent(inout) :: marks(:)

      integer :: i, place

      do i = 1, size(ids)
         place = find(lookup, ids(i))
         if (place > 0) marks(place) = .true.
      end do
   end subroutine mark

   !> What is kept names a thing of a kind that is not read
   subroutine refuse(draft, lookup, what, ids, line)
      type(draft_t), intent(inout) :: draft
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what
      integer, intent(in) :: ids(:), line

      integer :: i, block

      do i = 1, size(ids)
         if (find(lookup, ids(i)) > 0) cycle
         block = unsupported(draft%deck, what, ids(i))
         if (block > 0) call report_line(draft%deck, line, SEV_ERROR, 'KJ-9415', what//' '// &
            str(ids(i))//' is needed in the mechanism, and of a kind that is not read', &
            'names '//line_text(draft%deck, draft%deck%block(block)%header))
      end do
   end subroutine refuse

   !> Ids of one family on a card
   function ids_of_family(draft, block, line, family) result(ids)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block, line, family
      integer, allocatable :: ids(:)

      type(id_columns_t) :: columns
      type(cut_t) :: cut
      character(len=:), allocatable :: text
      integer :: i, value, status

      text = line_text(draft%deck, line)
      allocate (ids(0))
      call ids_on_card(draft%deck, block, line, text, columns)
      if (columns%n == 0) return
      call cut_card(text, columns%n, columns%first(:columns%n), columns%last(:columns%n), cut)
      do i = 1, columns%n
         if (columns%family(i) /= family .or. cut%last(i) < cut%first(i)) cycle
         call parse_integer(text(cut%first(i):cut%last(i)), value, status)
         if (status == NUMBER_FINE .and. value /= 0) ids = [ids, value]
      end do
   end function ids_of_family

   !> Axes that follow nodes of bodies keep these; others stand still from now on
   subroutine keep_axes(draft, keep)
      type(draft_t), intent(inout) :: draft
      type(keep_t), intent(inout) :: keep

      logical, allocatable :: of_joints(:)
      integer :: i

      allocate (of_joints(draft%skews%n), source=.false.)
      do i = 1, size(draft%property_block)
         if (keep%property(i)) call mark_joint_skews(draft, draft%property_block(i), of_joints)
      end do
      do i = 1, draft%skews%n
         if (.not. keep%skew(i) .or. draft%skews%dir(i) == 0) cycle
         call keep_axis_nodes(draft, draft%skews%node(:, i), of_joints(i), 'skew', &
            draft%skews%id(i), block_of_axes(draft, draft%skews%id(i), .false.), keep, &
            keep%fixed_skew(i))
      end do
      do i = 1, draft%frames%n
         if (.not. keep%frame(i) .or. draft%frames%node(1, i) == 0) cycle
         call keep_axis_nodes(draft, draft%frames%node(:, i), .false., 'frame', &
            draft%frames%id(i), block_of_axes(draft, draft%frames%id(i), .true.), keep, &
            keep%fixed_frame(i))
      end do
   end subroutine keep_axes

   subroutine mark_joint_skews(draft, block, of_joints)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block
      logical, intent(inout) :: of_joints(:)

      integer :: line

      if (all(draft%deck%block(block)%keyword /= [KW_KJOINT, KW_KJOINT2])) return
      do line = first_card(draft%deck, block), draft%deck%block(block)%last
         call mark(draft%skew, ids_of_family(draft, block, line, OF_SKEW), of_joints)
      end do
   end subroutine mark_joint_skews

   !> Keep the nodes of moving axes; where one of them is in no body the axes become fixed ones
   subroutine keep_axis_nodes(draft, node, of_joint, what, id, block, keep, fixed)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: node(3), id, block
      logical, intent(in) :: of_joint
      character(len=*), intent(in) :: what
      type(keep_t), intent(inout) :: keep
      logical, intent(out) :: fixed

      integer :: k

      fixed = .false.
      do k = 1, 3
         if (node(k) == 0) cycle
         if (body_of(draft, node(k)) == 0 .and. .not. keep%node(node(k))) fixed = .true.
      end do
      if (.not. fixed) then
         keep%node(pack(node, node > 0)) = .true.
      else if (of_joint) then
         call report_header(draft%deck, block, SEV_ERROR, 'KJ-9422', what//' '//str(id)// &
            ' of a joint follows a node that is in no body', 'would be lost with its elements')
      else
         call report_header(draft%deck, block, SEV_WARNING, 'KJ-9423', what//' '//str(id)// &
            ' follows nodes that are in no body', 'stands still in the mechanism')
      end if
   end subroutine keep_axis_nodes

   !> Block that defines a skew, or a frame
   pure integer function block_of_axes(draft, id, is_frame) result(block)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: id
      logical, intent(in) :: is_frame

      do block = draft%deck%n_block, 1, -1
         if (draft%deck%block(block)%id /= id .or. draft%deck%block(block)%row == 0) cycle
         if (index(keywords(draft%deck%block(block)%row)%name, merge('/FRAME', '/SKEW ', &
            is_frame)) &
            == 1 .or. index(keywords(draft%deck%block(block)%row)%name, &
            trim(merge('/FRAME', '/SKEW ', is_frame))//'/') == 1) return
      end do
   end function block_of_axes

   !> A body of three nodes and more keeps three: OpenRadioss moves smaller ones in another way
   subroutine fill_bodies(draft, keep)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(inout) :: keep

      integer :: i, n(maxval([0, draft%body]))

      n = 0
      do i = 1, draft%n_node
         if (draft%body(i) > 0 .and. keep%node(i)) n(draft%body(i)) = n(draft%body(i)) + 1
      end do
      do i = 1, draft%n_node
         if (draft%body(i) == 0 .or. keep%node(i)) cycle
         if (n(draft%body(i)) >= 3) cycle
         keep%node(i) = .true.
         n(draft%body(i)) = n(draft%body(i)) + 1
      end do
   end subroutine fill_bodies

   !> Ends of springs on deformable parts are free now
   subroutine report_free_nodes(draft, element_mass, keep)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: element_mass(:)
      type(keep_t), intent(inout) :: keep

      integer :: i, k

      do i = 1, draft%n_node
         if (keep%node(i) .and. body_of(draft, i) == 0) keep%n_free = keep%n_free + 1
      end do
      do i = 1, draft%elements%n
         if (.not. keep%spring(i)) cycle
         do k = 1, 2
            associate (raw => draft%elements%node(k, i))
               if (raw == 0) cycle
               if (body_of(draft, raw) > 0) cycle
               if (element_mass(raw) > 0.0_wp) call report_row(draft%deck, &
                  draft%elements%card(i), 'n'//str(k), SEV_WARNING, 'KJ-9424', 'node '// &
                  str(draft%id(raw))//' is in no body', 'free in the mechanism')
            end associate
         end do
      end do
   end subroutine report_free_nodes

end module kj_keep
