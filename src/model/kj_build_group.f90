!> Cards -> draft: node groups of all kinds.
!>
!> A group is a list of nodes that grows, loses members, and ends sorted. What its ids stand for is
!> a row of `kinds`: those of a /GRNOD, and the clauses of a /SET.
!> One file: groups and sets name each other, and fill the same lists.
module kj_build_group
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: new_lookup, find, lower_bound, sort_unique
   use kj_keywords, only: KW_RBODY, KW_SET_COLLECT, KW_SET_GENERAL
   use kj_group_kinds, only: kind_t, kinds, A_NODE, A_PART, AN_ELEMENT, A_BOX, A_GROUP, &
      AN_ELEMENT_GROUP, A_SURFACE, A_LINE, A_SUBMODEL, A_BODY, A_SEGMENT, ALL_NODES
   use kj_deck_text, only: add_deck_finding, report_header
   use kj_cards, only: cards_t, read_cards, int_of
   use kj_card_lists, only: ids_t, clauses_t, read_ids, read_clauses, report_id
   use kj_card_fields, only: fields
   use kj_deck_flat, only: ids_on_card, id_columns_t
   use kj_field, only: OF_GROUP
   use kj_element_cards, only: element_cards
   use kj_draft, only: draft_t, blocks_of, blocks_with, report_double_blocks, known_ids, WAITING, &
      UNDER_WAY, DONE
   use kj_node_list, only: node_list_t, add_node, add_nodes, add_range, remove_nodes, keep_nodes, &
      finish_list, faces_t
   use kj_select, only: filter_t, parts_of, element_ids_of, walk_elements, surface_of, line_nodes, &
      submodel_nodes, all_kinds, OUTERMOST, build_boxes, is_inside
   implicit none
   private

   public :: build_groups, fill_one_group

contains

   !> All groups of the deck; where a /GRNOD and a /SET share an id, the /GRNOD is meant.
   !>
   !> Of a full deck those that its mechanism names; the others stay empty.
   subroutine build_groups(draft)
      type(draft_t), intent(inout) :: draft

      integer, allocatable :: groups(:), sets(:)
      logical, allocatable :: named(:)
      integer :: i

      groups = pack([(i, i=1, draft%deck%n_block)], [(draft%deck%block(i)%keyword > 0 .and. &
         any(kinds%keyword == draft%deck%block(i)%keyword), i=1, draft%deck%n_block)])
      sets = blocks_of(draft%deck, KW_SET_GENERAL)
      call report_double_blocks(draft%deck, groups, 'node group')
      call report_double_blocks(draft%deck, sets, 'set')
      groups = [groups, sets, blocks_of(draft%deck, KW_SET_COLLECT)]
      call new_lookup(draft%deck%block(groups)%id, draft%group)
      call build_boxes(draft)
      if (allocated(draft%groups)) deallocate (draft%groups)
      allocate (draft%groups(size(groups)))
      draft%groups%block = groups
      do i = 1, size(groups)
         allocate (draft%groups(i)%node(0))
      end do
      call find_named(draft, named)
      do i = 1, size(groups)
         if (named(i)) call fill_group(draft, i)
      end do
   end subroutine build_groups

   !> Nodes of one group, whether a card of the mechanism names it or not
   subroutine fill_one_group(draft, id, node)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: id
      integer, allocatable, intent(out) :: node(:)

      integer :: place

      allocate (node(0))
      place = find(draft%group, id)
      if (place == 0) return
      draft%groups%spoilt = .true.               ! an empty group is no finding here
      call fill_group(draft, place)
      node = draft%groups(place)%node
   end subroutine fill_one_group

   !> Groups that a card of the deck names; all, unless it is a full deck
   subroutine find_named(draft, named)
      type(draft_t), intent(in) :: draft
      logical, allocatable, intent(out) :: named(:)

      type(id_columns_t) :: columns
      integer :: block, line, i, k, id, status, s

      allocate (named(size(draft%groups)), source=.not. draft%deck%full)
      if (.not. draft%deck%full) return
      do block = 1, draft%deck%n_block
         if (.not. names_groups(draft, block)) cycle
         do line = draft%deck%block(block)%first, draft%deck%block(block)%last
            s = draft%deck%line_source(line)
            associate (text => draft%deck%source(s)%text(draft%deck%line_first(line): &
               draft%deck%line_last(line)))
               if (index(text, ',') > 0) named = .true.   ! free format: all may be
               call ids_on_card(draft%deck, block, line, text, columns)
               do k = 1, columns%n
                  if (columns%family(k) /= OF_GROUP .or. columns%first(k) > len(text)) cycle
                  read (text(columns%first(k):min(len(text), columns%last(k))), '(i10)', &
                     iostat=status) id
                  if (status /= 0) named = .true.   ! wrong
                  i = find(draft%group, id)
                  if (status == 0 .and. i > 0) named(i) = .true.
               end do
            end associate
         end do
      end do
   end subroutine find_named

   !> The cards of a block name groups of nodes
   pure logical function names_groups(draft, block) result(names)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block

      names = .false.
      associate (k => draft%deck%block(block)%keyword)
         if (k == 0) return
         names = any(fields(draft%deck%field_first(k):draft%deck%field_last(k))%name == 'grnod_id')
      end associate
   end function names_groups

   !> The nodes of group i; groups that it names come first
   recursive subroutine fill_group(draft, i)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: i

      type(node_list_t) :: list
      type(ids_t) :: ids
      integer :: n_error, block, row, k

      if (draft%groups(i)%state /= WAITING) return
      draft%groups(i)%state = UNDER_WAY
      n_error = draft%deck%findings%n_error
      block = draft%groups(i)%block
      row = findloc(kinds%keyword, draft%deck%block(block)%keyword, 1)
      if (row > 0) then
         call read_ids(draft%deck, block, ids)
         call take_ids(draft, i, kinds(row), ids, 1, ids%n, list)
      else
         do k = i, size(draft%groups)            ! a /SET/COLLECT has several blocks
            if (draft%deck%block(draft%groups(k)%block)%id == draft%deck%block(block)%id .and. &
               draft%deck%block(draft%groups(k)%block)%keyword == draft%deck%block(block)%keyword) &
               call fill_set(draft, i, draft%groups(k)%block, list)
         end do
      end if
      call finish_list(draft%id, list, draft%groups(i)%node)
      if (draft%deck%findings%n_error > n_error) draft%groups(i)%spoilt = .true.
      if (size(draft%groups(i)%node) == 0 .and. .not. draft%groups(i)%spoilt) &
         call report_header(draft%deck, block, SEV_WARNING, 'KJ-0690', 'the node group is empty', &
         'no node')
      draft%groups(i)%state = DONE
   end subroutine fill_group

   !> Nodes of a /SET, clause by clause: _D removes, _I keeps what is in both
   recursive subroutine fill_set(draft, group, block, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: group, block
      type(node_list_t), intent(inout) :: list

      type(clauses_t) :: clauses
      type(node_list_t) :: some
      integer, allocatable :: node(:)
      integer :: i, k, row, dash
      character(len=10) :: word, suffix

      call read_clauses(draft%deck, block, clauses)
      do i = 1, clauses%n
         word = clauses%word(i)
         dash = scan(word//'_', '_')
         suffix = word(dash:)
         row = findloc(kinds%clause, word(:dash - 1), 1)
         if (dash == 1) row = 0
         if (row == 0 .or. verify(suffix, '_GDIAE ') > 0) then
            call add_deck_finding(draft%deck, clauses%line(i), 1, len(clauses%word), SEV_ERROR, &
               'KJ-9141', 'the clause '//trim(word)//' of a /SET is not supported', 'expected: '// &
               'NODE, PART, SUBS, SUBM, SOLID, SHELL, SH3N, BEAM, TRUSS, SPRING, SEG, SET, '// &
               'SETCOL, RBODY, BOX or ALL, with _G, _D or _I')
            cycle
         end if
         some%n = 0
         associate (ids => clauses%ids, from => clauses%from(i), to => clauses%to(i))
            do k = from, to
               if (ids%value(k) < 0 .and. kinds(row)%of /= A_NODE) call report_id(draft%deck, ids, &
                  k, SEV_ERROR, 'KJ-9138', 'a negative id in a clause of a /SET', &
                  'expected: a positive id', 'a clause with _D removes: '//trim(word)//'_D')
            end do
            if (index(suffix, 'G') > 0) then
               call take_clause_ranges(draft, group, kinds(row), ids, from, to, some)
            else
               call take_ids(draft, group, kinds(row), ids, from, to, some)
            end if
         end associate
         if (scan(suffix, 'DI') == 0) then
            if (some%n > 0) call add_nodes(some%node(:some%n), list)
            cycle
         end if
         call finish_list(draft%id, some, node)
         if (index(suffix, 'D') > 0) call remove_nodes(draft%id, node, list)
         if (index(suffix, 'I') > 0) call keep_nodes(draft%id, node, list)
      end do
   end subroutine fill_set

   !> Ranges of a clause: first, last, step stand in three fields; a step 0 is 1
   recursive subroutine take_clause_ranges(draft, group, kind, ids, from, to, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: group, from, to
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      type(node_list_t), intent(inout) :: list

      integer :: k, j, range(3), column, place
      integer, allocatable :: known(:)

      k = from
      do while (k <= to)
         range = 0
         column = (ids%first(k) - 11)/30
         place = k
         do while (k <= to)
            if (ids%line(k) /= ids%line(place) .or. (ids%first(k) - 11)/30 /= column) exit
            range(modulo((ids%last(k) - 11)/10, 3) + 1) = ids%value(k)
            k = k + 1
         end do
         if (range(2) == 0) call report_id(draft%deck, ids, place, SEV_ERROR, 'KJ-9137', &
            'a range without its end', 'expected: first and last id')
         if (range(2) == 0) cycle
         call ids_of_kind(draft, kind, known)
         known = pack(known, known >= range(1) .and. known <= range(2))
         if (range(3) > 1) known = pack(known, modulo(known - range(1), range(3)) == 0)
         do j = 1, size(known)
            if (kind%of == A_NODE) call add_node(find(draft%node, known(j)), list)
         end do
         if (kind%of /= A_NODE) call take_ids(draft, group, kind, as_list(known, ids, &
            place), 1, size(known), list)
      end do
   end subroutine take_clause_ranges

   !> All ids of what a clause names
   subroutine ids_of_kind(draft, kind, known)
      type(draft_t), intent(inout) :: draft
      type(kind_t), intent(in) :: kind
      integer, allocatable, intent(out) :: known(:)

      type(filter_t) :: filter

      allocate (known(0))
      select case (kind%of)
      case (A_NODE); known = draft%node%id
      case (A_PART); known = draft%part%id
      case (A_GROUP); known = draft%group%id
      case (AN_ELEMENT)
         filter%kind = element_cards%group == kind%which
         call walk_elements(draft, filter, ids=known)
      end select
      known = sort_unique(known)
   end subroutine ids_of_kind

   !> Ids that all stand at the place of id k of another list
   pure function as_list(value, ids, k) result(list)
      integer, intent(in) :: value(:), k
      type(ids_t), intent(in) :: ids
      type(ids_t) :: list

      integer :: i

      list%n = size(value)
      list%value = value
      list%line = [(ids%line(k), i=1, list%n)]
      list%first = [(ids%first(k), i=1, list%n)]
      list%last = [(ids%last(k), i=1, list%n)]
   end function as_list

   !> Append the nodes that the ids from to to stand for. What ids remove is removed in the end.
   recursive subroutine take_ids(draft, group, kind, ids, from, to, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: group               !! under way
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list

      type(node_list_t) :: some
      integer, allocatable :: node(:)
      integer :: sign

      if (.not. allocated(list%node)) allocate (list%node(16))
      select case (kind%of)
      case (A_NODE)
         call take_nodes(draft, kind, ids, from, to, list)
      case (A_SEGMENT)
         call take_segments(draft, kind, ids, from, to, list)
      case (AN_ELEMENT)
         call take_elements(draft, kind, ids, from, to, list)
      case (ALL_NODES)
         call add_nodes(draft%node%place, list)
      case default
         call take_signed(draft, group, kind, ids, from, to, 1, list)
         if (all(ids%value(from:to) > 0)) return
         call take_signed(draft, group, kind, ids, from, to, -1, some)
         sign = some%n
         call finish_list(draft%id, some, node)
         if (sign > 0) call remove_nodes(draft%id, node, list)
      end select
   end subroutine take_ids

   !> The nodes behind the ids of one sign
   recursive subroutine take_signed(draft, group, kind, ids, from, to, sign, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: group, from, to, sign
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      type(node_list_t), intent(inout) :: list

      type(filter_t) :: filter
      integer :: k, before, box, i
      logical :: known
      logical, allocatable :: part(:)

      filter%kind = all_kinds()
      allocate (filter%part(size(draft%part_block)), source=.false.)
      do k = from, to
         if (ids%value(k)*sign <= 0) cycle
         associate (id => abs(ids%value(k)))
            before = list%n
            known = .true.
            select case (kind%of)
            case (A_PART)
               allocate (part(size(filter%part)), source=.false.)
               call parts_of(draft, trim(merge('SUBSET', kind%clause, kind%clause == 'SUBS')), id, &
                  part)
               known = any(part)
               filter%part = filter%part .or. part
               deallocate (part)
            case (A_BOX)
               box = find(draft%boxes%id, id)
               known = box > 0
               do i = 1, merge(draft%n_node, 0, known)
                  if (is_inside(draft, box, draft%x(i, :))) call add_node(i, list)
               end do
            case (A_GROUP)
               known = find(draft%group, id) > 0
               if (known) call take_group(draft, group, find(draft%group, id), ids, k, list)
            case (A_SUBMODEL)
               call submodel_nodes(draft, id, list)
               known = list%n > before
            case (A_BODY)
               call take_body(draft, group, ids, k, known, list)
            case default
               call take_selection(draft, kind, id, list)
               known = list%n > before
            end select
            if (known) cycle
            i = k
            call report_id(draft%deck, ids, i, kind%severity, kind%missing, trim(kind%what)//' '// &
               str(id)//merge(' is not defined', ' has no node   ', kind%of <= A_GROUP), &
               'adds no node', known_of(draft, kind))
         end associate
      end do
      if (kind%of == A_PART) call walk_elements(draft, filter, list)
   end subroutine take_signed

   !> "defined: 1 2 3" of a kind, for a hint
   pure function known_of(draft, kind) result(hint)
      type(draft_t), intent(in) :: draft
      type(kind_t), intent(in) :: kind
      character(len=160) :: hint

      hint = ''
      if (kind%what == 'part') hint = known_ids(draft%part, 'part')
      if (kind%what == 'box') hint = known_ids(draft%boxes%id, 'box')
      if (kind%what == 'node group') hint = known_ids(draft%group, 'node group')
   end function known_of

   !> Nodes of a group of elements, a surface or a line
   subroutine take_selection(draft, kind, id, list)
      type(draft_t), intent(inout) :: draft
      type(kind_t), intent(in) :: kind
      integer, intent(in) :: id
      type(node_list_t), intent(inout) :: list

      type(filter_t) :: filter
      type(faces_t) :: faces
      integer :: i

      select case (kind%of)
      case (AN_ELEMENT_GROUP)
         filter%kind = element_cards%group == kind%which
         call element_ids_of(draft, kind%which, id, OUTERMOST, filter%id)
         if (size(filter%id) > 0) call walk_elements(draft, filter, list)
      case (A_SURFACE)
         call surface_of(draft, id, OUTERMOST, faces)
         do i = 1, faces%n
            call add_nodes(faces%node(:, i), list)
         end do
      case (A_LINE)
         call line_nodes(draft, id, list)
      end select
   end subroutine take_selection

   !> Append nodes, or those of ranges of ids
   subroutine take_nodes(draft, kind, ids, from, to, list)
      type(draft_t), intent(inout) :: draft
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list

      integer :: k, raw

      associate (id => ids%value)
         do k = from, to - kind%together + 1, kind%together   ! a range without an end is left out
            select case (kind%together)
            case (1)
               raw = find(draft%node, id(k))
               if (raw > 0) then
                  call add_node(raw, list)
               else if (id(k) < 0) then
                  call report_id(draft%deck, ids, k, SEV_WARNING, 'KJ-9134', 'a negative node id', &
                     'ignored, as in Radioss')
               else
                  call report_id(draft%deck, ids, k, kind%severity, kind%missing, 'node '// &
                     str(id(k))//' is not defined', 'no such node')
               end if
            case (2)
               if (id(k) > id(k + 1)) call report_id(draft%deck, ids, k, SEV_WARNING, 'KJ-9132', &
                  'a range ends before it begins', 'no node in it')
               call add_range(draft%node, id(k), id(k + 1), 1, list)
            case default
               if (id(k + 2) > 0) call add_range(draft%node, id(k), id(k + 1), id(k + 2), list)
               if (id(k + 2) <= 0) call report_id(draft%deck, ids, k + 2, SEV_ERROR, 'KJ-9133', &
                  'the increment of a range is not positive', 'expected: 1 or more')
            end select
         end do
      end associate
   end subroutine take_nodes

   !> Nodes of segments: the first id of a card is that of the segment
   subroutine take_segments(draft, kind, ids, from, to, list)
      type(draft_t), intent(inout) :: draft
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list

      integer :: k

      do k = from, to
         if (ids%last(k) > 20) call take_nodes(draft, kind, ids, k, k, list)
      end do
   end subroutine take_segments

   !> Nodes of elements by their ids
   subroutine take_elements(draft, kind, ids, from, to, list)
      type(draft_t), intent(inout) :: draft
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list

      type(filter_t) :: filter
      integer, allocatable :: found(:)
      integer :: k, at

      filter%kind = element_cards%group == kind%which
      filter%id = sort_unique(ids%value(from:to))
      allocate (found(0))
      call walk_elements(draft, filter, list, found)
      found = sort_unique(found)
      do k = from, to
         at = lower_bound(found, ids%value(k))
         if (at <= size(found)) then
            if (found(at) == ids%value(k)) cycle
         end if
         call report_id(draft%deck, ids, k, kind%severity, kind%missing, trim(kind%what)//' '// &
            str(ids%value(k))//' is not defined', 'adds no node')
      end do
   end subroutine take_elements

   !> Append the nodes of another group
   recursive subroutine take_group(draft, group, other, ids, k, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: group, other
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k                   !! id that names the other group
      type(node_list_t), intent(inout) :: list

      if (draft%groups(other)%state == UNDER_WAY) then
         call report_id(draft%deck, ids, k, SEV_ERROR, 'KJ-9136', &
            'node groups name each other in a circle', 'this group needs the one it is in')
         return
      end if
      call fill_group(draft, other)
      draft%groups(group)%spoilt = draft%groups(group)%spoilt .or. draft%groups(other)%spoilt
      call add_nodes(draft%groups(other)%node, list)
   end subroutine take_group

   !> Append the main node of a rigid body and those of its group
   recursive subroutine take_body(draft, group, ids, k, known, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: group
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k
      logical, intent(out) :: known
      type(node_list_t), intent(inout) :: list

      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      integer :: i, other

      call blocks_with(draft, KW_RBODY, ids%value(k), blocks)
      known = size(blocks) > 0
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         call add_nodes([find(draft%node, int_of(cards, 'node_id'))], list)
         other = find(draft%group, int_of(cards, 'grnod_id'))
         if (other > 0) call take_group(draft, group, other, ids, k, list)
      end do
   end subroutine take_body

end module kj_build_group
