!> Cards -> draft: node groups of all kinds. /SET/GENERAL is in kj_build_set.
module kj_build_group
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: find
   use kj_keywords, only: KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_GRNOD, KW_GRNOD_GENE, &
      KW_GRNOD_GEN_INCR, KW_GRNOD_PART, KW_GRNOD_BOX, KW_SET_GENERAL
   use kj_deck_text, only: deck_t, add_deck_finding
   use kj_cards, only: ids_t, clauses_t, read_ids, read_clauses, report_id, report_header
   use kj_draft, only: draft_t, block_lookup, report_double_blocks, known_ids
   use kj_node_list, only: node_list_t, add_node, add_nodes, remove_nodes, add_range, add_steps, &
      add_parts, add_elements, finish_list
   use kj_build_box, only: box_set_t, build_boxes, add_box
   implicit none
   private

   public :: build_groups

   integer, parameter :: WAITING = 0, UNDER_WAY = 1, DONE = 2   !! state of a group

   !> What groups are made of
   type :: workshop_t
      integer, allocatable :: state(:)           !! of each group
      logical, allocatable :: spoilt(:)          !! something was wrong with it, or with one in it
      type(box_set_t) :: boxes
   end type workshop_t

contains

   !> All groups of the deck; where a /GRNOD and a /SET share an id, the /GRNOD is meant
   subroutine build_groups(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      type(workshop_t) :: shop
      integer, allocatable :: groups(:), sets(:)
      integer :: i

      groups = pack([(i, i=1, deck%n_block)], [(is_group(deck%block(i)%keyword), i=1, &
         deck%n_block)])
      sets = pack([(i, i=1, deck%n_block)], deck%block(:deck%n_block)%keyword == KW_SET_GENERAL)
      call report_double_blocks(deck, groups, 'node group', findings)
      call report_double_blocks(deck, sets, 'set', findings)
      groups = [groups, sets]
      call block_lookup(deck, groups, draft%group)
      call build_boxes(deck, draft, shop%boxes, findings)
      allocate (draft%groups(size(groups)), shop%state(size(groups)))
      allocate (shop%spoilt(size(groups)), source=.false.)
      shop%state = WAITING
      draft%groups%block = groups
      do i = 1, size(groups)
         call fill_group(deck, draft, shop, i, findings)
      end do
   end subroutine build_groups

   pure logical function is_group(keyword)
      integer, intent(in) :: keyword

      is_group = any(keyword == [KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_GRNOD, KW_GRNOD_GENE, &
         KW_GRNOD_GEN_INCR, KW_GRNOD_PART, KW_GRNOD_BOX])
   end function is_group

   !> The nodes of group i; groups that it names come first
   recursive subroutine fill_group(deck, draft, shop, i, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: i
      type(finding_list_t), intent(inout) :: findings

      type(node_list_t) :: list
      type(ids_t) :: ids
      integer :: n_error

      if (shop%state(i) /= WAITING) return
      shop%state(i) = UNDER_WAY
      n_error = findings%n_error
      associate (block => draft%groups(i)%block)
         if (deck%block(block)%keyword == KW_SET_GENERAL) then
            call fill_set(deck, draft, shop, i, list, findings)
         else
            call read_ids(deck, block, ids, findings)
            call fill_kind(deck, draft, shop, i, deck%block(block)%keyword, ids, 1, ids%n, list, &
               findings)
         end if
         call finish_list(draft, list, draft%groups(i)%node)
         if (findings%n_error > n_error) shop%spoilt(i) = .true.
         if (size(draft%groups(i)%node) == 0 .and. .not. shop%spoilt(i)) call report_header(deck, &
            block, SEV_WARNING, 'KJ-0690', 'the node group is empty', 'no node', findings)
      end associate
      shop%state(i) = DONE
   end subroutine fill_group

   !> Nodes that the ids from to to stand for, as they would in a /GRNOD of this kind
   recursive subroutine fill_kind(deck, draft, shop, i, kind, ids, from, to, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: i                   !! group under way
      integer, intent(in) :: kind                !! KW_GRNOD_ constant
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: k

      select case (kind)
      case (KW_GRNOD_NODE, KW_GRNOD_NODENS)
         do k = from, to
            call take_node(deck, draft, ids, k, list, findings)
         end do
      case (KW_GRNOD_GENE)
         do k = from, to - 1, 2
            if (ids%value(k) > ids%value(k + 1)) call report_id(deck, ids, k, SEV_WARNING, &
               'KJ-9132', 'a range ends before it begins', 'no node in it', findings)
            call add_range(draft, ids%value(k), ids%value(k + 1), list)
         end do
      case (KW_GRNOD_GEN_INCR)
         do k = from, to - 2, 3
            if (ids%value(k + 2) <= 0) then
               call report_id(deck, ids, k + 2, SEV_ERROR, 'KJ-9133', &
                  'the increment of a range is not positive', 'expected: 1 or more', findings)
            else
               call add_steps(draft, ids%value(k), ids%value(k + 1), ids%value(k + 2), list)
            end if
         end do
      case (KW_GRNOD_PART)
         do k = from, to
            call take_part(deck, draft, ids, k, list, findings)
         end do
      case (KW_GRNOD_BOX)
         do k = from, to
            call take_box(deck, draft, shop%boxes, ids, k, list, findings)
         end do
      case default   ! KW_GRNOD_GRNOD: what is to be removed is removed in the end
         call take_groups(deck, draft, shop, i, ids, from, to, list, findings)
      end select
   end subroutine fill_kind

   subroutine take_node(deck, draft, ids, k, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: raw

      raw = find(draft%node, ids%value(k))
      if (raw > 0) then
         call add_node(raw, list)
      else if (ids%value(k) < 0) then
         call report_id(deck, ids, k, SEV_WARNING, 'KJ-9134', 'a negative node id', &
            'ignored, as in Radioss', findings)
      else
         call report_id(deck, ids, k, SEV_ERROR, 'KJ-0078', 'node '//str(ids%value(k))// &
            ' is not defined', 'no such node', findings)
      end if
   end subroutine take_node

   subroutine take_part(deck, draft, ids, k, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: part

      part = find(draft%part, ids%value(k))
      if (part > 0) then
         call add_parts(draft, ids%value(k), ids%value(k), list)
      else
         call report_id(deck, ids, k, SEV_WARNING, 'KJ-0194', 'part '//str(ids%value(k))// &
            ' is not defined', 'adds no node', findings, known_ids(draft%part, 'part'))
      end if
   end subroutine take_part

   subroutine take_box(deck, draft, boxes, ids, k, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(box_set_t), intent(in) :: boxes
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: box

      box = find(boxes%id, ids%value(k))
      if (box > 0) then
         call add_box(draft, boxes, box, list)
      else
         call report_id(deck, ids, k, SEV_WARNING, 'KJ-9135', 'box '//str(ids%value(k))// &
            ' is not defined', 'adds no node', findings, known_ids(boxes%id, 'box'))
      end if
   end subroutine take_box

   !> Nodes of other groups; a negative id removes those of its group
   recursive subroutine take_groups(deck, draft, shop, group, ids, from, to, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: group               !! group under way
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: k, other, sign

      do sign = 1, -1, -2
         do k = from, to
            if (ids%value(k)*sign < 0) cycle
            other = find(draft%group, abs(ids%value(k)))
            if (other == 0) then
               call report_id(deck, ids, k, SEV_WARNING, 'KJ-0174', 'node group '// &
                  str(abs(ids%value(k)))//' is not defined', 'adds no node', findings, &
                  known_ids(draft%group, 'node group'))
               cycle
            end if
            if (shop%state(other) == UNDER_WAY) then
               call report_id(deck, ids, k, SEV_ERROR, 'KJ-9136', &
                  'node groups name each other in a circle', 'this group needs the one it is in', &
                  findings)
               cycle
            end if
            call fill_group(deck, draft, shop, other, findings)
            shop%spoilt(group) = shop%spoilt(group) .or. shop%spoilt(other)
            if (sign > 0) call add_nodes(draft%groups(other)%node, list)
            if (sign < 0) call remove_nodes(draft, draft%groups(other)%node, list)
         end do
      end do
   end subroutine take_groups

   !> Nodes of a /SET/GENERAL: NODE, PART, SPRING, BOX and SET, with _G for ranges of ids
   recursive subroutine fill_set(deck, draft, shop, group, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: group
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      type(clauses_t) :: clauses
      integer :: i, k, kind

      call read_clauses(deck, draft%groups(group)%block, clauses, findings)
      do i = 1, clauses%n
         associate (ids => clauses%ids, from => clauses%from(i), to => clauses%to(i))
            select case (clauses%word(i))
            case ('NODE'); kind = KW_GRNOD_NODE
            case ('NODE_G'); kind = KW_GRNOD_GENE
            case ('PART'); kind = KW_GRNOD_PART
            case ('BOX'); kind = KW_GRNOD_BOX
            case ('SET'); kind = KW_GRNOD_GRNOD
            case ('SPRING', 'PART_G', 'SPRING_G')
               call take_elements(deck, draft, clauses, i, list, findings)
               cycle
            case default
               call refuse_clause(deck, clauses, i, findings)
               cycle
            end select
            if (kind == KW_GRNOD_GENE .and. modulo(to - from + 1, 2) == 1) call report_id(deck, &
               ids, to, SEV_ERROR, 'KJ-9137', 'a range without its end', 'expected: two ids', &
               findings)
            do k = from, to
               if (kind /= KW_GRNOD_NODE .and. ids%value(k) < 0) call report_id(deck, ids, k, &
                  SEV_ERROR, 'KJ-9138', 'clauses that remove are not supported', &
                  'expected: a positive id', findings)
            end do
            call fill_kind(deck, draft, shop, group, kind, ids, from, to, list, findings)
         end associate
      end do
   end subroutine fill_set

   !> Ends of elements: by their ids, or by ranges of these or of the ids of parts
   subroutine take_elements(deck, draft, clauses, i, list, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(clauses_t), intent(in) :: clauses
      integer, intent(in) :: i                   !! clause
      type(node_list_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: k, step, last

      step = merge(1, 2, clauses%word(i) == 'SPRING')
      associate (id => clauses%ids%value)
         do k = clauses%from(i), clauses%to(i), step
            last = min(k + step - 1, clauses%to(i))
            if (clauses%word(i) == 'PART_G') then
               call add_parts(draft, id(k), id(last), list)
            else
               call add_elements(draft, id(k), id(last), list)
            end if
            if (step == 1 .and. find(draft%elements%id, id(k)) == 0) call report_id(deck, &
               clauses%ids, k, SEV_WARNING, 'KJ-9140', 'element '//str(id(k))//' is not defined', &
               'adds no node', findings)
         end do
      end associate
   end subroutine take_elements

   subroutine refuse_clause(deck, clauses, i, findings)
      type(deck_t), intent(in) :: deck
      type(clauses_t), intent(in) :: clauses
      integer, intent(in) :: i
      type(finding_list_t), intent(inout) :: findings

      call add_deck_finding(deck, clauses%line(i), 1, len(clauses%word), SEV_ERROR, 'KJ-9141', &
         'the clause '//trim(clauses%word(i))//' of a /SET is not supported', &
         'expected: NODE, NODE_G, PART, PART_G, SPRING, SPRING_G, BOX or SET', findings)
   end subroutine refuse_clause

end module kj_build_group
