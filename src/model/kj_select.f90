!> Which elements and nodes stand behind an id: of parts, subsets, groups of elements, surfaces.
!>
!> Elements are read from their cards each time, block by block: nothing of them is kept.
!> One file: element groups, surfaces and lines name each other and walk the same cards.
module kj_select
   use kj_sort, only: find, lower_bound, sort_unique
   use kj_keywords, only: keywords, KW_SUBSET, KW_NODE, KW_KJOINT2, KW_GRSHEL, KW_GRSH3N, &
      KW_GRBRIC, KW_GRBEAM, KW_GRTRUS, KW_GRSPRI, KW_GRPART, KW_SURF, KW_LINE, KW_SHELL, KW_SH3N, &
      KW_BRICK, KW_TETRA4, KW_TETRA10, KW_BRIC20, KW_PENTA6, KW_SHEL16
   use kj_deck_text, only: line_text, first_card, lengthen, kind_word
   use kj_card_lists, only: ids_t, read_ids, read_id_lines
   use kj_card_walk, only: card_walk_t, start_walk
   use kj_element_cards, only: element_cards, element_row, read_element, MOST_NODES
   use kj_draft, only: draft_t
   use kj_box, only: box_set_t, is_inside
   use kj_node_list, only: node_list_t, add_node, add_nodes
   implicit none
   private

   public :: filter_t, faces_t, parts_of, element_ids_of, walk_elements, surface_of, line_nodes, &
      submodel_nodes, all_kinds

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

   !> Faces of elements and segments
   type :: faces_t
      integer :: n = 0
      integer, allocatable :: node(:, :)         !! (4, >= n) raw indices; of a triangle 3 twice
   end type faces_t

   !> Corners of the faces of solids, counted as on their cards; a triangle repeats its last
   integer, parameter :: OF_BRICK(4, 6) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, &
      3, 4, 8, 7, 4, 1, 5, 8], [4, 6])
   integer, parameter :: OF_TETRA(4, 4) = reshape([1, 2, 3, 3, 1, 2, 4, 4, 2, 3, 4, 4, &
      3, 1, 4, 4], [4, 4])
   integer, parameter :: OF_WEDGE(4, 5) = reshape([1, 2, 3, 3, 4, 5, 6, 6, 1, 2, 5, 4, 2, 3, 6, 5, &
      3, 1, 4, 6], [4, 5])

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
      integer, allocatable :: path(:)
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
         do i = 1, draft%deck%n_block
            if (draft%deck%block(i)%keyword /= KW_SUBSET .or. draft%deck%block(i)%id /= id) cycle
            call read_ids(draft%deck, i, children)
            do k = 1, children%n
               if (all(path /= children%value(k))) call parts_of(draft, word, &
                  children%value(k), part, path)
            end do
         end do
      end select
   end subroutine parts_of

   !> Walk the elements that a filter lets pass: their nodes, ids and faces, as asked for
   subroutine walk_elements(draft, boxes, filter, list, ids, faces)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      type(filter_t), intent(in) :: filter
      type(node_list_t), intent(inout), optional :: list
      integer, allocatable, intent(inout), optional :: ids(:)   !! appended, not sorted
      type(faces_t), intent(inout), optional :: faces

      type(card_walk_t) :: walk
      integer :: block, row, id, node(MOST_NODES), raw(MOST_NODES), members, n, part, i
      logical :: there
      integer, allocatable :: found(:)

      n = 0
      allocate (found(16))
      do block = 1, draft%deck%n_block
         row = element_row(draft%deck%block(block)%keyword)
         if (row == 0) cycle
         if (.not. filter%kind(row)) cycle
         part = find(draft%part, draft%deck%block(block)%id)
         if (allocated(filter%part)) then
            if (part == 0) cycle
            if (.not. filter%part(part)) cycle
         end if
         members = element_cards(row)%members
         if (element_cards(row)%group == KW_GRSPRI) members = spring_members(draft, part)
         call start_walk(draft%deck, block, walk)
         do
            call read_element(draft%deck, row, walk, id, node, there)
            if (.not. there) exit
            if (id == 0) cycle
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
               if (.not. in_box(draft, boxes, filter, raw(:members))) cycle
            end if
            if (present(list)) call add_nodes(raw(:members), list)
            if (present(faces)) call add_faces(draft%deck%block(block)%keyword, raw, faces)
            if (n == size(found)) call lengthen(found)
            n = n + 1
            found(n) = id
         end do
      end do
      if (present(ids)) ids = [ids, found(:n)]
   end subroutine walk_elements

   !> All nodes of an element, or one, are in the box of a filter
   pure logical function in_box(draft, boxes, filter, raw) result(inside)
      type(draft_t), intent(in) :: draft
      type(box_set_t), intent(in) :: boxes
      type(filter_t), intent(in) :: filter
      integer, intent(in) :: raw(:)

      integer :: i

      inside = filter%whole
      do i = 1, size(raw)
         if (raw(i) == 0) cycle
         if (is_inside(draft, boxes, filter%box, draft%x(raw(i), :)) .neqv. filter%whole) then
            inside = .not. filter%whole
            return
         end if
      end do
   end function in_box

   !> Nodes that belong to the springs of a part: two, of a pulley three, of a KJOINT2 four
   integer function spring_members(draft, part) result(members)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: part

      integer :: i

      members = 2
      if (part == 0) return
      do i = 1, draft%deck%n_block
         associate (b => draft%deck%block(i))
            if (b%row == 0 .or. b%id /= draft%part_ids(1, part)) cycle
            if (index(keywords(b%row)%name, '/PROP') /= 1) cycle
            if (b%keyword == KW_KJOINT2) members = 4
            if (any(kind_word(draft%deck, i) == ['TYPE12    ', 'SPR_PUL   '])) members = 3
         end associate
      end do
   end function spring_members

   !> Ids of the elements of a group such as /GRSHEL/PART, ascending
   recursive subroutine element_ids_of(draft, boxes, keyword, group, around, ids)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      integer, intent(in) :: keyword             !! KW_GRSHEL, ...
      integer, intent(in) :: group               !! its id
      integer, intent(in) :: around(:)           !! groups that it is in: a circle ends
      integer, allocatable, intent(out) :: ids(:)

      integer, allocatable :: some(:)
      type(ids_t) :: list
      character(len=10) :: word
      integer :: block, k, sign

      allocate (ids(0))
      if (any(around == group)) return
      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= keyword) cycle
         if (draft%deck%block(block)%id /= group) cycle
         word = kind_word(draft%deck, block)
         call read_id_lines(draft%deck, first_card(draft%deck, block), &
            draft%deck%block(block)%last, 10, 1, list)
         if (word == 'GENE') then
            call take_ranges(draft, boxes, keyword, list, ids)
            cycle
         end if
         do sign = 1, -1, -2
            do k = 1, list%n
               if (list%value(k)*sign < 0) cycle
               call ids_behind(draft, boxes, keyword, word, abs(list%value(k)), &
                  [around, group], some)
               if (sign > 0) ids = [ids, some]
               if (sign < 0) ids = pack(ids, .not. is_among(ids, some))
            end do
         end do
      end do
      ids = sort_unique(ids)
   end subroutine element_ids_of

   !> Ids of the elements behind one id of a list, ascending
   recursive subroutine ids_behind(draft, boxes, keyword, word, id, around, ids)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
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
         call walk_elements(draft, boxes, filter, ids=ids)
      case ('BOX', 'BOX2')
         filter%box = find(boxes%id, id)
         filter%whole = word == 'BOX'
         if (filter%box > 0) call walk_elements(draft, boxes, filter, ids=ids)
      case ('GRSHEL', 'GRSH3N', 'GRBRIC', 'GRBEAM', 'GRTRUS', 'GRSPRI')
         call element_ids_of(draft, boxes, keyword, id, around, ids)
      case default                               ! SHEL, SH3N, BRIC, BEAM, TRUS, SPRI: elements
         ids = [id]
      end select
      ids = sort_unique(ids)
   end subroutine ids_behind

   !> Elements whose ids lie in pairs of first and last
   subroutine take_ranges(draft, boxes, keyword, list, ids)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      integer, intent(in) :: keyword
      type(ids_t), intent(in) :: list
      integer, allocatable, intent(inout) :: ids(:)

      type(filter_t) :: filter
      integer, allocatable :: every(:)
      integer :: k

      filter%kind = element_cards%group == keyword
      allocate (every(0))
      call walk_elements(draft, boxes, filter, ids=every)
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

   !> Faces of an element: of a shell itself, of a solid all around
   pure subroutine add_faces(keyword, raw, faces)
      integer, intent(in) :: keyword             !! KW_ constant of the element
      integer, intent(in) :: raw(:)              !! its nodes
      type(faces_t), intent(inout) :: faces

      integer :: i, corners(8)

      corners = raw(:8)
      select case (keyword)
      case (KW_SHELL)
         call add_face([raw(:3), merge(raw(4), raw(3), raw(4) > 0)], faces)
      case (KW_SH3N)
         call add_face([raw(:3), raw(3)], faces)
      case (KW_TETRA4, KW_TETRA10)
         do i = 1, 4
            call add_face(corners(OF_TETRA(:, i)), faces)
         end do
      case (KW_PENTA6)
         do i = 1, 5
            call add_face(corners(OF_WEDGE(:, i)), faces)
         end do
      case (KW_BRICK, KW_BRIC20, KW_SHEL16)
         if (all(corners(5:) == 0)) then
            do i = 1, 4
               call add_face(corners(OF_TETRA(:, i)), faces)
            end do
         else if (all(corners(7:) == 0)) then
            do i = 1, 5
               call add_face(corners(OF_WEDGE(:, i)), faces)
            end do
         else
            do i = 1, 6
               call add_face(corners(OF_BRICK(:, i)), faces)
            end do
         end if
      end select
   end subroutine add_faces

   pure subroutine add_face(node, faces)
      integer, intent(in) :: node(4)
      type(faces_t), intent(inout) :: faces

      integer, allocatable :: longer(:, :)

      if (any(node == 0)) return
      if (.not. allocated(faces%node)) allocate (faces%node(4, 64))
      if (faces%n == size(faces%node, 2)) then
         allocate (longer(4, 2*faces%n))
         longer(:, :faces%n) = faces%node
         call move_alloc(longer, faces%node)
      end if
      faces%n = faces%n + 1
      faces%node(:, faces%n) = node
   end subroutine add_face

   !> The faces of a surface. Those of solids are the outer ones, unless the surface says ALL
   recursive subroutine surface_of(draft, boxes, id, around, faces)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      integer, intent(in) :: id, around(:)       !! surfaces that it is in: a circle ends
      type(faces_t), intent(inout) :: faces

      type(filter_t) :: filter
      type(ids_t) :: list
      character(len=10) :: word
      integer :: block, k, first

      if (any(around == id)) return
      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= KW_SURF .or. draft%deck%block(block)%id /= id) cycle
         word = kind_word(draft%deck, block)
         first = first_card(draft%deck, block)
         if (word == 'SEG') then
            call take_segments(draft, first, draft%deck%block(block)%last, 4, faces)
            cycle
         end if
         call read_id_lines(draft%deck, first, draft%deck%block(block)%last, 10, 1, list)
         if (word == 'SURF') then
            do k = 1, list%n
               if (list%value(k) > 0) call surface_of(draft, boxes, list%value(k), &
                  [around, id], faces)
            end do
            cycle
         end if
         call filter_of_surface(draft, boxes, word, list, filter)
         call take_surface(draft, boxes, filter, index(line_text(draft%deck, &
            draft%deck%block(block)%header), '/ALL') > 0, faces)
      end do
   end subroutine surface_of

   !> The elements that a surface is made of
   subroutine filter_of_surface(draft, boxes, word, list, filter)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
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
            call element_ids_of(draft, boxes, keyword, abs(list%value(k)), OUTERMOST, some)
            if (list%value(k) > 0) filter%id = sort_unique([filter%id, some])
            if (list%value(k) < 0) filter%id = pack(filter%id, .not. is_among(filter%id, some))
         end do
      case ('BOX', 'BOX2')
         if (list%n > 0) filter%box = find(boxes%id, list%value(1))
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
   subroutine take_surface(draft, boxes, filter, every, faces)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      type(filter_t), intent(in) :: filter
      logical, intent(in) :: every
      type(faces_t), intent(inout) :: faces

      type(filter_t) :: shells, solids
      type(faces_t) :: all_faces
      logical, allocatable :: once(:)
      integer :: i

      shells = filter
      shells%kind = filter%kind .and. element_cards%group /= KW_GRBRIC
      call walk_elements(draft, boxes, shells, faces=faces)
      solids = filter
      solids%kind = filter%kind .and. element_cards%group == KW_GRBRIC
      call walk_elements(draft, boxes, solids, faces=all_faces)
      if (all_faces%n == 0) return
      call find_single(all_faces, once)
      do i = 1, all_faces%n
         if (every .or. once(i)) call add_face(all_faces%node(:, i), faces)
      end do
   end subroutine take_surface

   !> Faces whose nodes no other face has; faces with one least node stand together
   subroutine find_single(faces, once)
      type(faces_t), intent(in) :: faces
      logical, allocatable, intent(out) :: once(:)

      integer, allocatable :: least(:), next(:), last(:)
      integer :: i, k

      allocate (once(faces%n), source=.true.)
      allocate (least(faces%n), next(faces%n))
      least = minval(faces%node(:, :faces%n), 1)
      allocate (last(maxval(least)), source=0)
      do i = 1, faces%n
         next(i) = last(least(i))
         last(least(i)) = i
         k = next(i)
         do while (k > 0)
            if (is_same(faces%node(:, i), faces%node(:, k))) then
               once(i) = .false.
               once(k) = .false.
            end if
            k = next(k)
         end do
      end do
   end subroutine find_single

   !> Two faces have the same nodes
   pure logical function is_same(a, b)
      integer, intent(in) :: a(4), b(4)

      integer :: i

      is_same = .true.
      do i = 1, 4
         is_same = is_same .and. any(b == a(i)) .and. any(a == b(i))
      end do
   end function is_same

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
   subroutine line_nodes(draft, boxes, id, list)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      integer, intent(in) :: id
      type(node_list_t), intent(inout) :: list

      type(faces_t) :: faces
      type(ids_t) :: ids
      character(len=10) :: word
      integer :: block, k, first

      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= KW_LINE .or. draft%deck%block(block)%id /= id) cycle
         word = kind_word(draft%deck, block)
         first = first_card(draft%deck, block)
         if (word == 'SEG') then
            call take_segments(draft, first, draft%deck%block(block)%last, 2, faces)
         else if (word == 'SURF' .or. word == 'EDGE') then
            call read_id_lines(draft%deck, first, draft%deck%block(block)%last, 10, 1, ids)
            do k = 1, ids%n
               call surface_of(draft, boxes, ids%value(k), OUTERMOST, faces)
            end do
            if (word == 'EDGE') call keep_border(faces)
         end if
      end do
      do k = 1, faces%n
         call add_nodes(faces%node(:, k), list)
      end do
   end subroutine line_nodes

   !> Edges that one face alone has, as faces of two nodes
   subroutine keep_border(faces)
      type(faces_t), intent(inout) :: faces

      type(faces_t) :: edges, border
      logical, allocatable :: once(:)
      integer :: i, k, a, b

      do i = 1, faces%n
         do k = 1, 4
            a = faces%node(k, i)
            b = faces%node(modulo(k, 4) + 1, i)
            if (a /= b) call add_face([a, b, b, b], edges)
         end do
      end do
      if (edges%n > 0) then
         call find_single(edges, once)
         do i = 1, edges%n
            if (once(i)) call add_face(edges%node(:, i), border)
         end do
      end if
      faces = border
   end subroutine keep_border

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

end module kj_select
