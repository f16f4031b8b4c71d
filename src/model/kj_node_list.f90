!> Lists of nodes that grow, lose members, and end sorted without repeats.
module kj_node_list
   use kj_sort, only: lookup_t, sorted_order, sort_unique, lower_bound
   use kj_deck_text, only: lengthen
   use kj_keywords, only: KW_SHELL, KW_SH3N, KW_BRICK, KW_TETRA4, KW_TETRA10, KW_BRIC20, &
      KW_PENTA6, KW_SHEL16
   implicit none
   private

   public :: node_list_t, add_node, add_nodes, add_range, remove_nodes, keep_nodes, finish_list, &
      faces_t, add_faces, add_face, find_single, keep_border

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

   !> Nodes in any order, with repeats
   type :: node_list_t
      integer :: n = 0
      integer, allocatable :: node(:)            !! (>= n) raw indices
   end type node_list_t

contains

   !> Append one node
   pure subroutine add_node(raw, list)
      integer, intent(in) :: raw                 !! raw index, > 0
      type(node_list_t), intent(inout) :: list

      if (.not. allocated(list%node)) allocate (list%node(16))
      if (list%n == size(list%node)) call make_room(list)
      list%n = list%n + 1
      list%node(list%n) = raw
   end subroutine add_node

   !> Leave out repeats of a long list, and lengthen it where that is not enough
   pure subroutine make_room(list)
      type(node_list_t), intent(inout) :: list

      integer, allocatable :: once(:)

      if (list%n >= 65536) then
         once = sort_unique(list%node)
         list%n = size(once)
         list%node(:list%n) = once
      end if
      if (2*list%n > size(list%node)) call lengthen(list%node)
   end subroutine make_room

   !> Append nodes; zeros are left out
   pure subroutine add_nodes(raw, list)
      integer, intent(in) :: raw(:)              !! raw indices
      type(node_list_t), intent(inout) :: list

      integer :: i

      do i = 1, size(raw)
         if (raw(i) > 0) call add_node(raw(i), list)
      end do
   end subroutine add_nodes

   !> Remove nodes wherever they stand in the list
   pure subroutine remove_nodes(ids, raw, list)
      integer, intent(in) :: ids(:)              !! user ids of raw indices
      integer, intent(in) :: raw(:)              !! ascending user id
      type(node_list_t), intent(inout) :: list

      call sift(ids, raw, .false., list)
   end subroutine remove_nodes

   !> Remove all nodes but these
   pure subroutine keep_nodes(ids, raw, list)
      integer, intent(in) :: ids(:), raw(:)      !! as of remove_nodes
      type(node_list_t), intent(inout) :: list

      call sift(ids, raw, .true., list)
   end subroutine keep_nodes

   !> Keep what is among some nodes, or what is not
   pure subroutine sift(ids, raw, among, list)
      integer, intent(in) :: ids(:), raw(:)
      logical, intent(in) :: among
      type(node_list_t), intent(inout) :: list

      integer, allocatable :: id(:)
      integer :: i, n, at
      logical :: is_there

      id = ids(raw)
      n = 0
      do i = 1, list%n
         at = lower_bound(id, ids(list%node(i)))
         is_there = .false.
         if (at <= size(raw)) is_there = raw(at) == list%node(i)
         if (is_there .neqv. among) cycle
         n = n + 1
         list%node(n) = list%node(i)
      end do
      list%n = n
   end subroutine sift

   !> The nodes of a list, each once, ascending user id
   pure subroutine finish_list(ids, list, node)
      integer, intent(in) :: ids(:)              !! user ids of raw indices
      type(node_list_t), intent(in) :: list
      integer, allocatable, intent(out) :: node(:)

      integer :: i, n
      integer, allocatable :: order(:)

      allocate (node(list%n))
      if (list%n == 0) return
      order = sorted_order(ids(list%node(:list%n)))
      n = 0
      do i = 1, list%n
         associate (raw => list%node(order(i)))
            if (n > 0) then
               if (ids(node(n)) == ids(raw)) cycle
            end if
            n = n + 1
            node(n) = raw
         end associate
      end do
      node = node(:n)
   end subroutine finish_list

   !> Append the nodes whose ids are first, first + step, ... up to last
   pure subroutine add_range(node, first, last, step, list)
      type(lookup_t), intent(in) :: node         !! of all nodes
      integer, intent(in) :: first, last, step   !! step > 0
      type(node_list_t), intent(inout) :: list

      integer :: i

      do i = lower_bound(node%id, first), size(node%id)
         if (node%id(i) > last) return
         if (is_step(node%id(i), first, step)) call add_node(node%place(i), list)
      end do
   end subroutine add_range

   !> id - first is a multiple of step; both may be as far apart as integers go
   pure logical function is_step(id, first, step)
      integer, intent(in) :: id, first, step

      is_step = modulo(modulo(id, step) - modulo(first, step), step) == 0
   end function is_step

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

   !> Append a face; one that lacks a node is left out
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

end module kj_node_list
