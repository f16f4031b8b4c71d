!> Cards -> draft: node groups of all kinds, and the boxes that some of them name.
!>
!> A group is a list of nodes that grows, loses members, and ends sorted. What its ids stand for is
!> a row of `kinds`: those of a /GRNOD, and the clauses of a /SET/GENERAL.
!> One file: groups, sets and boxes name each other, and fill the same lists.
module kj_build_group
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, new_lookup, find, lower_bound, sorted_order
   use kj_keywords, only: KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_GRNOD, KW_GRNOD_GENE, &
      KW_GRNOD_GEN_INCR, KW_GRNOD_PART, KW_GRNOD_BOX, KW_BOX_RECTA, KW_SET_GENERAL
   use kj_deck_text, only: add_deck_finding, lengthen, report_header
   use kj_cards, only: cards_t, read_cards, real_of, int_of, report
   use kj_card_lists, only: ids_t, clauses_t, read_ids, read_clauses, report_id
   use kj_draft, only: draft_t, blocks_of, find_blocks, report_double_blocks, reference, node_of, &
      known_ids
   implicit none
   private

   public :: build_groups

   !> What an id stands for
   integer, parameter :: A_NODE = 1, A_PART = 2, AN_ELEMENT = 3, A_BOX = 4, A_GROUP = 5
   character(len=10), parameter :: WHAT(5) = [character(len=10) :: 'node', 'part', 'element', &
      'box', 'node group']

   !> A kind of group, or a clause of a set
   type :: kind_t
      integer           :: keyword    !! KW_ constant, 0 = a clause alone
      character(len=8)  :: clause     !! of /SET/GENERAL, '' = none
      integer           :: of         !! A_ constant
      integer           :: together   !! ids that belong together: 1, 2 first and last, 3 increment
      character(len=7)  :: missing    !! message on an id that is not defined
      integer           :: severity   !! of it
   end type kind_t

   type(kind_t), parameter :: kinds(*) = [ &
      kind_t(KW_GRNOD_NODE,     'NODE',     A_NODE,     1, 'KJ-0078', SEV_ERROR),   &
      kind_t(KW_GRNOD_NODENS,   '',         A_NODE,     1, 'KJ-0078', SEV_ERROR),   &
      kind_t(KW_GRNOD_GENE,     'NODE_G',   A_NODE,     2, '',        SEV_ERROR),   &
      kind_t(KW_GRNOD_GEN_INCR, '',         A_NODE,     3, '',        SEV_ERROR),   &
      kind_t(KW_GRNOD_PART,     'PART',     A_PART,     1, 'KJ-0194', SEV_WARNING), &
      kind_t(0,                 'PART_G',   A_PART,     2, '',        SEV_WARNING), &
      kind_t(0,                 'SPRING',   AN_ELEMENT, 1, 'KJ-9140', SEV_WARNING), &
      kind_t(0,                 'SPRING_G', AN_ELEMENT, 2, '',        SEV_WARNING), &
      kind_t(KW_GRNOD_BOX,      'BOX',      A_BOX,      1, 'KJ-9135', SEV_WARNING), &
      kind_t(KW_GRNOD_GRNOD,    'SET',      A_GROUP,    1, 'KJ-0174', SEV_WARNING)]

   integer, parameter :: WAITING = 0, UNDER_WAY = 1, DONE = 2   !! state of a group

   !> Nodes in the order they came, with repeats
   type :: node_list_t
      integer :: n = 0
      integer, allocatable :: node(:)            !! (>= n) raw indices
   end type node_list_t

   !> Boxes with their edges along the axes of skews
   type :: box_set_t
      type(lookup_t) :: id
      integer, allocatable :: skew(:)            !! (n) skew index, 0 = global
      real(wp), allocatable :: lo(:, :), hi(:, :)   !! (3, n) corners, components in the skew
   end type box_set_t

   !> What groups are made of
   type :: workshop_t
      integer, allocatable :: state(:)           !! of each group
      logical, allocatable :: spoilt(:)          !! something was wrong with it, or with one in it
      type(box_set_t) :: boxes
   end type workshop_t

contains

   !> All groups of the deck; where a /GRNOD and a /SET share an id, the /GRNOD is meant
   subroutine build_groups(draft)
      type(draft_t), intent(inout) :: draft

      type(workshop_t) :: shop
      integer, allocatable :: groups(:), sets(:)
      integer :: i

      groups = pack([(i, i=1, draft%deck%n_block)], [(draft%deck%block(i)%keyword > 0 .and. &
         any(kinds%keyword == draft%deck%block(i)%keyword), i=1, draft%deck%n_block)])
      sets = blocks_of(draft%deck, KW_SET_GENERAL)
      call report_double_blocks(draft%deck, groups, 'node group')
      call report_double_blocks(draft%deck, sets, 'set')
      groups = [groups, sets]
      call new_lookup(draft%deck%block(groups)%id, draft%group)
      call build_boxes(draft, shop%boxes)
      allocate (draft%groups(size(groups)), shop%state(size(groups)))
      allocate (shop%spoilt(size(groups)), source=.false.)
      shop%state = WAITING
      draft%groups%block = groups
      do i = 1, size(groups)
         call fill_group(draft, shop, i)
      end do
   end subroutine build_groups

   !> The nodes of group i; groups that it names come first
   recursive subroutine fill_group(draft, shop, i)
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: i

      type(node_list_t) :: list
      type(ids_t) :: ids
      integer :: n_error, block, row

      if (shop%state(i) /= WAITING) return
      shop%state(i) = UNDER_WAY
      n_error = draft%deck%findings%n_error
      block = draft%groups(i)%block
      row = findloc(kinds%keyword, draft%deck%block(block)%keyword, 1)
      if (row == 0) then
         call fill_set(draft, shop, i, list)
      else
         call read_ids(draft%deck, block, ids)
         call take_ids(draft, shop, i, kinds(row), ids, 1, ids%n, list)
      end if
      call finish_list(draft, list, draft%groups(i)%node)
      if (draft%deck%findings%n_error > n_error) shop%spoilt(i) = .true.
      if (size(draft%groups(i)%node) == 0 .and. .not. shop%spoilt(i)) &
         call report_header(draft%deck, block, SEV_WARNING, 'KJ-0690', 'the node group is empty', &
         'no node')
      shop%state(i) = DONE
   end subroutine fill_group

   !> Nodes of a /SET/GENERAL
   recursive subroutine fill_set(draft, shop, group, list)
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: group
      type(node_list_t), intent(inout) :: list

      type(clauses_t) :: clauses
      type(kind_t) :: kind
      integer :: i, k, row

      call read_clauses(draft%deck, draft%groups(group)%block, clauses)
      do i = 1, clauses%n
         row = findloc(kinds%clause, clauses%word(i), 1)
         if (row == 0) then
            call add_deck_finding(draft%deck, clauses%line(i), 1, len(clauses%word), SEV_ERROR, &
               'KJ-9141', 'the clause '//trim(clauses%word(i))//' of a /SET is not supported', &
               'expected: NODE, NODE_G, PART, PART_G, SPRING, SPRING_G, BOX or SET')
            cycle
         end if
         kind = kinds(row)
         associate (ids => clauses%ids, from => clauses%from(i), to => clauses%to(i))
            if (kind%keyword == KW_GRNOD_GENE .and. modulo(to - from + 1, 2) == 1) &
               call report_id(draft%deck, ids, to, SEV_ERROR, 'KJ-9137', &
               'a range without its end', 'expected: two ids')
            do k = from, to
               if (kind%keyword == 0 .or. kind%keyword == KW_GRNOD_NODE) exit
               if (ids%value(k) < 0) call report_id(draft%deck, ids, k, SEV_ERROR, 'KJ-9138', &
                  'clauses that remove are not supported', 'expected: a positive id')
            end do
            call take_ids(draft, shop, group, kind, ids, from, to, list)
         end associate
      end do
   end subroutine fill_set

   !> Append the nodes that the ids from to to stand for. What groups remove is removed in the end.
   recursive subroutine take_ids(draft, shop, group, kind, ids, from, to, list)
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: group               !! under way
      type(kind_t), intent(in) :: kind
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: from, to
      type(node_list_t), intent(inout) :: list

      integer :: k, end, place, sign
      character(len=160) :: hint

      end = to
      if (kind%of == A_NODE) end = to - kind%together + 1     ! ranges without an end are left out
      do sign = 1, merge(-1, 1, kind%of == A_GROUP), -2
         do k = from, end, kind%together
            associate (id => ids%value(k), last => ids%value(min(k + min(kind%together, 2) - 1, &
               to)))
               if (kind%of == A_GROUP .and. id*sign < 0) cycle
               place = 1
               hint = ''
               select case (kind%of)
               case (A_NODE)
                  if (kind%together == 1) place = find(draft%node, id)
                  call take_nodes(draft, kind%together, ids, k, place, list)
               case (A_PART)
                  if (kind%together == 1) place = find(draft%part, id)
                  if (place == 0) hint = known_ids(draft%part, 'part')
                  if (place > 0) call add_parts(draft, id, last, list)
               case (AN_ELEMENT)
                  if (kind%together == 1) place = find(draft%elements%id, id)
                  if (place > 0) call add_elements(draft, id, last, list)
               case (A_BOX)
                  place = find(shop%boxes%id, id)
                  if (place == 0) hint = known_ids(shop%boxes%id, 'box')
                  if (place > 0) call add_box(draft, shop%boxes, place, list)
               case default   ! A_GROUP
                  place = find(draft%group, abs(id))
                  if (place == 0) hint = known_ids(draft%group, 'node group')
                  if (place > 0) call take_group(draft, shop, group, place, ids, k, list)
               end select
               if (place == 0 .and. (kind%of /= A_NODE .or. id >= 0)) call report_id(draft%deck, &
                  ids, k, kind%severity, kind%missing, trim(WHAT(kind%of))//' '// &
                  str(merge(abs(id), id, kind%of == A_GROUP))// &
                  ' is not defined', merge('no such node', 'adds no node', kind%of == A_NODE), hint)
            end associate
         end do
      end do
   end subroutine take_ids

   !> Append a node, or those of a range of ids
   subroutine take_nodes(draft, together, ids, k, place, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: together            !! 1 a node, 2 a range, 3 with an increment
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k                   !! the first of the ids
      integer, intent(in) :: place               !! raw index of the node, 0 = not defined
      type(node_list_t), intent(inout) :: list

      associate (id => ids%value)
         if (together == 1 .and. place > 0) then
            call add_node(place, list)
         else if (together == 1 .and. id(k) < 0) then
            call report_id(draft%deck, ids, k, SEV_WARNING, 'KJ-9134', 'a negative node id', &
               'ignored, as in Radioss')
         else if (together == 2) then
            if (id(k) > id(k + 1)) call report_id(draft%deck, ids, k, SEV_WARNING, 'KJ-9132', &
               'a range ends before it begins', 'no node in it')
            call add_range(draft, id(k), id(k + 1), 1, list)
         else if (together == 3) then
            if (id(k + 2) > 0) call add_range(draft, id(k), id(k + 1), id(k + 2), list)
            if (id(k + 2) <= 0) call report_id(draft%deck, ids, k + 2, SEV_ERROR, 'KJ-9133', &
               'the increment of a range is not positive', 'expected: 1 or more')
         end if
      end associate
   end subroutine take_nodes

   !> Append the nodes of another group, or remove them where its id is negative
   recursive subroutine take_group(draft, shop, group, other, ids, k, list)
      type(draft_t), intent(inout) :: draft
      type(workshop_t), intent(inout) :: shop
      integer, intent(in) :: group, other
      type(ids_t), intent(in) :: ids
      integer, intent(in) :: k                   !! id that names the other group
      type(node_list_t), intent(inout) :: list

      integer :: i

      if (shop%state(other) == UNDER_WAY) then
         call report_id(draft%deck, ids, k, SEV_ERROR, 'KJ-9136', &
            'node groups name each other in a circle', 'this group needs the one it is in')
         return
      end if
      call fill_group(draft, shop, other)
      shop%spoilt(group) = shop%spoilt(group) .or. shop%spoilt(other)
      if (ids%value(k) < 0) then
         call remove_nodes(draft, draft%groups(other)%node, list)
         return
      end if
      do i = 1, size(draft%groups(other)%node)
         call add_node(draft%groups(other)%node(i), list)
      end do
   end subroutine take_group

   !> /BOX/RECTA: two corners, as points in W or as nodes; the edges are along the skew
   subroutine build_boxes(draft, boxes)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(out) :: boxes

      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      real(wp) :: corner(3, 2), a(3, 3)
      logical :: typed(2)
      integer :: i

      call find_blocks(draft%deck, [KW_BOX_RECTA], 'box', blocks, boxes%id)
      allocate (boxes%skew(size(blocks)), boxes%lo(3, size(blocks)), boxes%hi(3, size(blocks)))
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         call read_corner(draft, cards, '1', corner(:, 1), typed(1))
         call read_corner(draft, cards, '2', corner(:, 2), typed(2))
         boxes%skew(i) = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
         if (boxes%skew(i) > 0 .and. any(typed)) call report(draft%deck, cards, 'skew_id', &
            SEV_WARNING, 'KJ-9142', &
            'a box with a skew: its corners are taken as points in global axes', &
            'gives the directions of the edges', &
            hint='name nodes as corners where this is not meant')
         a = reshape(draft%skews%axes(boxes%skew(i), :), [3, 3])
         corner = matmul(transpose(a), corner)
         boxes%lo(:, i) = min(corner(:, 1), corner(:, 2))
         boxes%hi(:, i) = max(corner(:, 1), corner(:, 2))
      end do
   end subroutine build_boxes

   !> A corner: the place of node n1 (n2), or else the point that is typed
   subroutine read_corner(draft, cards, which, corner, typed)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      character(len=1), intent(in) :: which      !! 1 or 2
      real(wp), intent(out) :: corner(3)         !! W, length
      logical, intent(out) :: typed

      integer :: raw

      corner = [real_of(cards, 'X'//which), real_of(cards, 'Y'//which), real_of(cards, 'Z'//which)]
      typed = int_of(cards, 'n'//which) == 0
      if (typed) return
      raw = node_of(draft, cards, 'n'//which)
      if (raw > 0) corner = draft%x(raw, :)
   end subroutine read_corner

   !> Append the nodes in a box, its faces included
   pure subroutine add_box(draft, boxes, box, list)
      type(draft_t), intent(in) :: draft
      type(box_set_t), intent(in) :: boxes
      integer, intent(in) :: box
      type(node_list_t), intent(inout) :: list

      real(wp) :: a(3, 3), p(3)
      integer :: i

      a = reshape(draft%skews%axes(boxes%skew(box), :), [3, 3])
      do i = 1, draft%n_node
         p = draft%x(i, :)
         if (boxes%skew(box) > 0) p = matmul(p, a)
         if (all(p >= boxes%lo(:, box)) .and. all(p <= boxes%hi(:, box))) call add_node(i, list)
      end do
   end subroutine add_box

   !> Append one node
   pure subroutine add_node(raw, list)
      integer, intent(in) :: raw                 !! raw index, > 0
      type(node_list_t), intent(inout) :: list

      if (.not. allocated(list%node)) allocate (list%node(16))
      if (list%n == size(list%node)) call lengthen(list%node)
      list%n = list%n + 1
      list%node(list%n) = raw
   end subroutine add_node

   !> Remove nodes wherever they stand in the list
   pure subroutine remove_nodes(draft, raw, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: raw(:)              !! ascending user id
      type(node_list_t), intent(inout) :: list

      integer, allocatable :: id(:)
      integer :: i, n, at

      id = draft%id(raw)
      n = 0
      do i = 1, list%n
         at = lower_bound(id, draft%id(list%node(i)))
         if (at <= size(raw)) then
            if (raw(at) == list%node(i)) cycle
         end if
         n = n + 1
         list%node(n) = list%node(i)
      end do
      list%n = n
   end subroutine remove_nodes

   !> Append the nodes whose ids are first, first + step, ... up to last
   pure subroutine add_range(draft, first, last, step, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first, last, step   !! step > 0
      type(node_list_t), intent(inout) :: list

      integer :: i

      do i = lower_bound(draft%node%id, first), size(draft%node%id)
         if (draft%node%id(i) > last) return
         if (is_step(draft%node%id(i), first, step)) call add_node(draft%node%place(i), list)
      end do
   end subroutine add_range

   !> id - first is a multiple of step; both may be as far apart as integers go
   pure logical function is_step(id, first, step)
      integer, intent(in) :: id, first, step

      is_step = modulo(modulo(id, step) - modulo(first, step), step) == 0
   end function is_step

   !> Append both ends of the elements of the parts whose ids are in [first, last]
   pure subroutine add_parts(draft, first, last, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first, last
      type(node_list_t), intent(inout) :: list

      integer :: i, k

      do k = lower_bound(draft%part%id, first), size(draft%part%id)
         if (draft%part%id(k) > last) return
         associate (part => draft%part%place(k), elements => draft%elements%of_part)
            do i = lower_bound(elements%id, part), size(elements%id)
               if (elements%id(i) > part) exit
               call add_ends(draft, elements%place(i), list)
            end do
         end associate
      end do
   end subroutine add_parts

   !> Append both ends of the elements whose ids are in [first, last]
   pure subroutine add_elements(draft, first, last, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first, last
      type(node_list_t), intent(inout) :: list

      integer :: i

      associate (lookup => draft%elements%id)
         do i = lower_bound(lookup%id, first), size(lookup%id)
            if (lookup%id(i) > last) return
            call add_ends(draft, lookup%place(i), list)
         end do
      end associate
   end subroutine add_elements

   pure subroutine add_ends(draft, element, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: element
      type(node_list_t), intent(inout) :: list

      integer :: e

      do e = 1, 2
         if (draft%elements%node(e, element) > 0) &
            call add_node(draft%elements%node(e, element), list)
      end do
   end subroutine add_ends

   !> The nodes of a list, each once, ascending user id
   pure subroutine finish_list(draft, list, node)
      type(draft_t), intent(in) :: draft
      type(node_list_t), intent(in) :: list
      integer, allocatable, intent(out) :: node(:)

      integer :: i, n
      integer, allocatable :: order(:)

      allocate (node(list%n))
      if (list%n == 0) return
      order = sorted_order(draft%id(list%node(:list%n)))
      n = 0
      do i = 1, list%n
         associate (raw => list%node(order(i)))
            if (n > 0) then
               if (draft%id(node(n)) == draft%id(raw)) cycle
            end if
            n = n + 1
            node(n) = raw
         end associate
      end do
      node = node(:n)
   end subroutine finish_list

end module kj_build_group
