!> Which elements and nodes stand behind an id: of parts, subsets, groups of elements, surfaces.
!>
!> Elements are read from their cards each time, block by block: nothing of them is kept.
!> One file: element groups, surfaces and lines name each other and walk the same cards
module kj_select
   use kj_sort, only: find, lower_bound, sort_unique
   use kj_keywords, only: keywords, KW_SUBSET, KW_KJOINT2, KW_GRSHEL, KW_GRSH3N, KW_GRBRIC, &
      KW_GRSPRI, KW_SURF, KW_LINE, KW_BOX_RECTA, KW_BOX_SPHER, KW_BOX_CYLIN
   use kj_deck_text, only: line_text, first_card, lengthen, kind_word
   use kj_card_lists, only: ids_t, read_ids, read_id_lines
   use kj_element_cards, only: element_cards, read_element, MOST_NODES, card_walk_t, start_walk
   use kj_draft, only: draft_t, blocks_with, index_blocks, box_set_t, moved_point, find_blocks, &
      reference, node_of
   use kj_node_list, only: node_list_t, add_node, add_nodes, faces_t, add_faces, add_face, &
      find_single, keep_border
   use kj_kinds, only: wp
   use kj_error, only: SEV_WARNING
   use kj_math3, only: cross
   use kj_cards, only: cards_t, read_cards, real_of, int_of, report
   implicit none
   private

   public :: filter_t, parts_of, element_ids_of, walk_elements, surface_of, line_nodes, &
      submodel_nodes, all_kinds, build_boxes, is_inside

   !> Groups or surfaces around one that is in none
   integer, parameter, public :: OUTERMOST(0) = [integer ::]

   !> Which elements are meant
   type :: filter_t
      logical :: kind(size(element_cards)) = .false.
      logical, allocatable :: part(:)            !! (parts) of these parts; else of all
      integer, allocatable :: id(:)              !! ascending; with these ids; else all
      integer :: box = 0                         !! inside this box, 0 = anywhere
      logical :: whole = .true.                  !! in the box with all nodes, else with one
   end type filter_t

contains

   !> All kinds of elements
   pure function all_kinds() result(kind)
      logical :: kind(size(element_cards))

      kind = .true.
   end function all_kinds

   !> Mark the parts that an id stands for: PART, SUBSET, MAT, PROP
   recursive subroutine parts_of(draft, word, id, part, around)
      type(draft_t), intent(inout) :: draft
      character(len=*), intent(in) :: word
      integer, intent(in) :: id
      logical, intent(inout) :: part(:)          !! (parts)
      integer, intent(in), optional :: around(:) !! subsets that this one is in: a circle ends

      type(ids_t) :: children
      integer, allocatable :: path(:), blocks(:)
      integer :: i, k

      select case (word)
      case ('PART')
         i = find(draft%part, id)
         if (i > 0) part(i) = .true.
      case ('MAT')
         part = part .or. draft%part_ids(2, :) == id
      case ('PROP')
         part = part .or. draft%part_ids(1, :) == id
      case ('SUBSET', 'SUBS')
         path = [id]
         if (present(around)) path = [around, id]
         part = part .or. draft%part_ids(3, :) == id
         call blocks_with(draft, KW_SUBSET, id, blocks)
         do i = 1, size(blocks)
            call read_ids(draft%deck, blocks(i), children)
            do k = 1, children%n
               if (all(path /= children%value(k))) call parts_of(draft, word, &
                  children%value(k), part, path)
            end do
         end do
      end select
   end subroutine parts_of

   !> Walk the elements that a filter lets pass: their nodes, ids and faces, as asked for
   subroutine walk_elements(draft, filter, list, ids, faces)
      type(draft_t), intent(inout) :: draft
      type(filter_t), intent(in) :: filter
      type(node_list_t), intent(inout), optional :: list
      integer, allocatable, intent(inout), optional :: ids(:)   !! appended, not sorted
      type(faces_t), intent(inout), optional :: faces

      type(card_walk_t) :: walk
      integer :: id, node(MOST_NODES), raw(MOST_NODES), members, n, i, s, least, most
      logical :: there
      integer, allocatable :: found(:), shelves(:)

      n = 0
      allocate (found(16))
      call find_shelves(draft, filter, shelves)
      do s = 1, size(shelves)
         members = element_cards(draft%shelf(shelves(s))%row)%members
         if (element_cards(draft%shelf(shelves(s))%row)%group == KW_GRSPRI) &
            members = spring_members(draft, draft%shelf(shelves(s))%part)
         call start_walk(draft%deck, draft%shelf(shelves(s))%block, walk)
         least = huge(least)
         most = 0
         do
            call read_element(draft%deck, draft%shelf(shelves(s))%row, walk, id, node, there)
            if (.not. there) exit
            if (id == 0) cycle
            least = min(least, id)
            most = max(most, id)
            if (allocated(filter%id)) then
               i = lower_bound(filter%id, id)
               if (i > size(filter%id)) cycle
               if (filter%id(i) /= id) cycle
            end if
            raw = 0
            do i = 1, members
               if (node(i) > 0) raw(i) = find(draft%node, node(i))
            end do
            if (filter%box > 0) then
               if (.not. in_box(draft, filter, raw(:members))) cycle
            end if
            if (present(list)) call add_nodes(raw(:members), list)
            if (present(faces)) call add_faces(draft%deck%block(walk%block)%keyword, raw, faces)
            if (n == size(found)) call lengthen(found)
            n = n + 1
            found(n) = id
         end do
         draft%shelf(shelves(s))%least = least
         draft%shelf(shelves(s))%most = most
      end do
      if (present(ids)) ids = [ids, found(:n)]
   end subroutine walk_elements

   !> Blocks that may hold elements which a filter lets pass, in deck order
   subroutine find_shelves(draft, filter, shelves)
      type(draft_t), intent(inout) :: draft
      type(filter_t), intent(in) :: filter
      integer, allocatable, intent(out) :: shelves(:)

      integer, allocatable :: parts(:)
      logical, allocatable :: may(:)
      integer :: i

      call index_blocks(draft)
      if (allocated(filter%part)) then
         parts = pack([(i, i=1, size(filter%part))], filter%part)
         allocate (shelves(0))
         do i = 1, size(parts)
            associate (l => draft%shelf_of_part)
               shelves = [shelves, l%place(lower_bound(l%id, parts(i)): &
                  lower_bound(l%id, parts(i) + 1) - 1)]
            end associate
         end do
         shelves = sort_unique(shelves)
      else
         shelves = [(i, i=1, size(draft%shelf))]
      end if
      may = filter%kind(draft%shelf(shelves)%row)
      if (allocated(filter%id)) then
         do i = 1, size(shelves)
            associate (s => draft%shelf(shelves(i)))
               if (may(i) .and. s%most >= s%least) may(i) = lower_bound(filter%id, s%least) < &
                  lower_bound(filter%id, s%most + 1)
            end associate
         end do
      end if
      shelves = pack(shelves, may)
   end subroutine find_shelves

   !> All nodes of an element, or one, are in the box of a filter
   pure logical function in_box(draft, filter, raw) result(inside)
      type(draft_t), intent(in) :: draft
      type(filter_t), intent(in) :: filter
      integer, intent(in) :: raw(:)

      integer :: i

      inside = filter%whole
      do i = 1, size(raw)
         if (raw(i) == 0) cycle
         if (is_inside(draft, filter%box, draft%x(raw(i), :)) .neqv. filter%whole) then
            inside = .not. filter%whole
            return
         end if
      end do
   end function in_box

   !> Nodes that belong to the springs of a part: two, of a pulley three, of a KJOINT2 four
   integer function spring_members(draft, part) result(members)
      type(draft_t), intent(in) :: draft         !! with its lookups
      integer, intent(in) :: part

      integer :: i

      members = 2
      if (part == 0) return
      do i = lower_bound(draft%block%id, draft%part_ids(1, part)), size(draft%block%id)
         if (draft%block%id(i) /= draft%part_ids(1, part)) exit
         associate (b => draft%deck%block(draft%block%place(i)))
            if (b%row == 0) cycle
            if (index(keywords(b%row)%name, '/PROP') /= 1) cycle
            if (b%keyword == KW_KJOINT2) members = 4
            if (any(kind_word(draft%deck, draft%block%place(i)) == ['TYPE12    ', 'SPR_PUL   '])) &
               members = 3
         end associate
      end do
   end function spring_members

   !> Ids of the elements of a group such as /GRSHEL/PART, ascending
   recursive subroutine element_ids_of(draft, keyword, group, around, ids)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: keyword             !! KW_GRSHEL, ...
      integer, intent(in) :: group               !! its id
      integer, intent(in) :: around(:)           !! groups that it is in: a circle ends
      integer, allocatable, intent(out) :: ids(:)

      integer, allocatable :: some(:), blocks(:)
      type(ids_t) :: list
      character(len=10) :: word
      integer :: i, k, sign

      allocate (ids(0))
      if (any(around == group)) return
      call blocks_with(draft, keyword, group, blocks)
      do i = 1, size(blocks)
         word = kind_word(draft%deck, blocks(i))
         call read_id_lines(draft%deck, first_card(draft%deck, blocks(i)), &
            draft%deck%block(blocks(i))%last, 10, 1, list)
         if (word == 'GENE') then
            call take_ranges(draft, keyword, list, ids)
            cycle
         end if
         do sign = 1, -1, -2
            do k = 1, list%n
               if (list%value(k)*sign < 0) cycle
               call ids_behind(draft, keyword, word, abs(list%value(k)), &
                  [around, group], some)
               if (sign > 0) ids = [ids, some]
               if (sign < 0) ids = pack(ids, .not. is_among(ids, some))
            end do
         end do
      end do
      ids = sort_unique(ids)
   end subroutine element_ids_of

   !> Ids of the elements behind one id of a list, ascending
   recursive subroutine ids_behind(draft, keyword, word, id, around, ids)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: keyword, id, around(:)
      character(len=*), intent(in) :: word
      integer, allocatable, intent(out) :: ids(:)

      type(filter_t) :: filter

      allocate (ids(0))
      filter%kind = element_cards%group == keyword
      select case (word)
      case ('PART', 'SUBSET', 'MAT', 'PROP')
         allocate (filter%part(size(draft%part_block)), source=.false.)
         call parts_of(draft, trim(word), id, filter%part)
         call walk_elements(draft, filter, ids=ids)
      case ('BOX', 'BOX2')
         filter%box = find(draft%boxes%id, id)
         filter%whole = word == 'BOX'
         if (filter%box > 0) call walk_elements(draft, filter, ids=ids)
      case ('GRSHEL', 'GRSH3N', 'GRBRIC', 'GRBEAM', 'GRTRUS', 'GRSPRI')
         call element_ids_of(draft, keyword, id, around, ids)
      case default                               ! SHEL, SH3N, BRIC, BEAM, TRUS, SPRI: elements
         ids = [id]
      end select
      ids = sort_unique(ids)
   end subroutine ids_behind

   !> Elements whose ids lie in pairs of first and last
   subroutine take_ranges(draft, keyword, list, ids)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: keyword
      type(ids_t), intent(in) :: list
      integer, allocatable, intent(inout) :: ids(:)

      type(filter_t) :: filter
      integer, allocatable :: every(:)
      integer :: k

      filter%kind = element_cards%group == keyword
      allocate (every(0))
      call walk_elements(draft, filter, ids=every)
      do k = 1, list%n - 1, 2
         ids = [ids, pack(every, every >= list%value(k) .and. every <= list%value(k + 1))]
      end do
   end subroutine take_ranges

   !> Whether each id is among some, which ascend
   pure function is_among(ids, some) result(among)
      integer, intent(in) :: ids(:), some(:)
      logical :: among(size(ids))

      integer :: i, at

      among = .false.
      do i = 1, size(ids)
         at = lower_bound(some, ids(i))
         if (at <= size(some)) among(i) = some(at) == ids(i)
      end do
   end function is_among

   !> The faces of a surface. Those of solids are the outer ones, unless the surface says ALL
   recursive subroutine surface_of(draft, id, around, faces)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: id, around(:)       !! surfaces that it is in: a circle ends
      type(faces_t), intent(inout) :: faces

      type(filter_t) :: filter
      type(ids_t) :: list
      character(len=10) :: word
      integer, allocatable :: blocks(:)
      integer :: i, block, k, first

      if (any(around == id)) return
      call blocks_with(draft, KW_SURF, id, blocks)
      do i = 1, size(blocks)
         block = blocks(i)
         word = kind_word(draft%deck, block)
         first = first_card(draft%deck, block)
         if (word == 'SEG') then
            call take_segments(draft, first, draft%deck%block(block)%last, 4, faces)
            cycle
         end if
         call read_id_lines(draft%deck, first, draft%deck%block(block)%last, 10, 1, list)
         if (word == 'SURF') then
            do k = 1, list%n
               if (list%value(k) > 0) call surface_of(draft, list%value(k), &
                  [around, id], faces)
            end do
            cycle
         end if
         call filter_of_surface(draft, word, list, filter)
         call take_surface(draft, filter, index(line_text(draft%deck, &
            draft%deck%block(block)%header), '/ALL') > 0, faces)
      end do
   end subroutine surface_of

   !> The elements that a surface is made of
   subroutine filter_of_surface(draft, word, list, filter)
      type(draft_t), intent(inout) :: draft
      character(len=*), intent(in) :: word       !! PART, GRSHEL, BOX, ...
      type(ids_t), intent(in) :: list
      type(filter_t), intent(out) :: filter

      integer, allocatable :: some(:)
      integer :: k, keyword

      filter%kind = .true.
      select case (word)
      case ('GRSHEL', 'GRSH3N', 'GRBRIC')
         if (word == 'GRSHEL') keyword = KW_GRSHEL
         if (word == 'GRSH3N') keyword = KW_GRSH3N
         if (word == 'GRBRIC') keyword = KW_GRBRIC
         filter%kind = element_cards%group == keyword
         allocate (filter%id(0))
         do k = 1, list%n
            call element_ids_of(draft, keyword, abs(list%value(k)), OUTERMOST, some)
            if (list%value(k) > 0) filter%id = sort_unique([filter%id, some])
            if (list%value(k) < 0) filter%id = pack(filter%id, .not. is_among(filter%id, some))
         end do
      case ('BOX', 'BOX2')
         if (list%n > 0) filter%box = find(draft%boxes%id, list%value(1))
         filter%whole = word == 'BOX'
         if (filter%box == 0) filter%kind = .false.
      case default
         allocate (filter%part(size(draft%part_block)), source=.false.)
         do k = 1, list%n
            if (list%value(k) > 0) call parts_of(draft, trim(word), list%value(k), filter%part)
         end do
      end select
   end subroutine filter_of_surface

   !> Faces of shells, and of solids those that no two of them share, or all
   subroutine take_surface(draft, filter, every, faces)
      type(draft_t), intent(inout) :: draft
      type(filter_t), intent(in) :: filter
      logical, intent(in) :: every
      type(faces_t), intent(inout) :: faces

      type(filter_t) :: shells, solids
      type(faces_t) :: all_faces
      logical, allocatable :: once(:)
      integer :: i

      shells = filter
      shells%kind = filter%kind .and. element_cards%group /= KW_GRBRIC
      call walk_elements(draft, shells, faces=faces)
      solids = filter
      solids%kind = filter%kind .and. element_cards%group == KW_GRBRIC
      call walk_elements(draft, solids, faces=all_faces)
      if (all_faces%n == 0) return
      call find_single(all_faces, once)
      do i = 1, all_faces%n
         if (every .or. once(i)) call add_face(all_faces%node(:, i), faces)
      end do
   end subroutine take_surface

   !> Segments: their id, then n nodes
   subroutine take_segments(draft, first, last, n, faces)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: first, last         !! lines
      integer, intent(in) :: n                   !! 4, or 2 of a line
      type(faces_t), intent(inout) :: faces

      type(ids_t) :: list
      integer :: line, k, raw(4), column

      do line = first, last
         call read_id_lines(draft%deck, line, line, n + 1, 1, list)
         raw = 0
         do k = 1, list%n
            column = (list%first(k) - 1)/10
            if (column >= 1) raw(column) = find(draft%node, list%value(k))
         end do
         if (n == 2) raw(3) = raw(2)
         if (raw(4) == 0) raw(4) = raw(3)
         call add_face(raw, faces)
         list%n = 0
      end do
   end subroutine take_segments

   !> Nodes of a line: of the segments it lists, of a surface, of the border of one
   subroutine line_nodes(draft, id, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: id
      type(node_list_t), intent(inout) :: list

      type(faces_t) :: faces
      type(ids_t) :: ids
      character(len=10) :: word
      integer, allocatable :: blocks(:)
      integer :: i, block, k, first

      call blocks_with(draft, KW_LINE, id, blocks)
      do i = 1, size(blocks)
         block = blocks(i)
         word = kind_word(draft%deck, block)
         first = first_card(draft%deck, block)
         if (word == 'SEG') then
            call take_segments(draft, first, draft%deck%block(block)%last, 2, faces)
         else if (word == 'SURF' .or. word == 'EDGE') then
            call read_id_lines(draft%deck, first, draft%deck%block(block)%last, 10, 1, ids)
            do k = 1, ids%n
               call surface_of(draft, ids%value(k), OUTERMOST, faces)
            end do
            if (word == 'EDGE') call keep_border(faces)
         end if
      end do
      do k = 1, faces%n
         call add_nodes(faces%node(:, k), list)
      end do
   end subroutine line_nodes

   !> Nodes that a submodel defines, those in it included
   subroutine submodel_nodes(draft, id, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: id
      type(node_list_t), intent(inout) :: list

      integer :: i, s

      if (.not. allocated(draft%node_submodel)) return
      do i = 1, size(draft%node_submodel)
         s = draft%node_submodel(i)
         do while (s > 0)
            if (draft%deck%submodel(s)%id == id) then
               call add_node(i, list)
               exit
            end if
            s = draft%deck%submodel(s)%parent
         end do
      end do
   end subroutine submodel_nodes

   !> RECTA by two corners, with edges along a skew; SPHER and CYLIN by points and a diameter
   subroutine build_boxes(draft)
      type(draft_t), intent(inout) :: draft

      type(box_set_t) :: boxes
      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      real(wp) :: corner(3, 2), a(3, 3)
      logical :: typed(2)
      integer :: i, n

      call find_blocks(draft%deck, [KW_BOX_RECTA, KW_BOX_SPHER, KW_BOX_CYLIN], 'box', blocks, &
         boxes%id)
      n = size(blocks)
      boxes%keyword = draft%deck%block(blocks)%keyword
      allocate (boxes%skew(n), boxes%lo(3, n), boxes%hi(3, n), boxes%radius(n))
      do i = 1, n
         call read_cards(draft%deck, blocks(i), cards)
         call read_corner(draft, cards, '1', corner(:, 1), typed(1))
         corner(:, 2) = corner(:, 1)
         typed(2) = .false.
         if (boxes%keyword(i) /= KW_BOX_SPHER) call read_corner(draft, cards, '2', corner(:, 2), &
            typed(2))
         boxes%radius(i) = 0.5_wp*real_of(cards, 'Diameter')
         boxes%skew(i) = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
         if (boxes%skew(i) > 0 .and. any(typed)) call report(draft%deck, cards, 'skew_id', &
            SEV_WARNING, 'KJ-9142', &
            'a box with a skew: its corners are taken as points in global axes', &
            'gives the directions of the edges', &
            hint='name nodes as corners where this is not meant')
         boxes%lo(:, i) = corner(:, 1)
         boxes%hi(:, i) = corner(:, 2)
         if (boxes%keyword(i) /= KW_BOX_RECTA) cycle
         a = reshape(draft%skews%axes(boxes%skew(i), :), [3, 3])
         corner = matmul(transpose(a), corner)
         boxes%lo(:, i) = min(corner(:, 1), corner(:, 2))
         boxes%hi(:, i) = max(corner(:, 1), corner(:, 2))
      end do
      draft%boxes = boxes
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
      if (typed) corner = moved_point(draft, cards%block, corner, .false.)
      if (typed) return
      raw = node_of(draft, cards, 'n'//which)
      if (raw > 0) corner = draft%x(raw, :)
   end subroutine read_corner

   !> A point is in a box or on its faces
   pure logical function is_inside(draft, box, x) result(inside)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: box
      real(wp), intent(in) :: x(3)               !! W

      real(wp) :: p(3), axis(3), along

      associate (boxes => draft%boxes, lo => draft%boxes%lo(:, box), &
         hi => draft%boxes%hi(:, box))
         select case (boxes%keyword(box))
         case (KW_BOX_SPHER)
            inside = norm2(x - lo) <= boxes%radius(box)
         case (KW_BOX_CYLIN)
            axis = hi - lo
            along = dot_product(x - lo, axis)
            inside = along >= 0.0_wp .and. along <= dot_product(axis, axis)
            if (inside) inside = norm2(cross(axis, x - lo)) <= boxes%radius(box)*norm2(axis)
         case default
            p = x
            if (boxes%skew(box) > 0) p = matmul(p, reshape(draft%skews%axes(boxes%skew(box), :), &
               [3, 3]))
            inside = all(p >= lo) .and. all(p <= hi)
         end select
      end associate
   end function is_inside

end module kj_select
