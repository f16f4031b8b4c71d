!> Lists of nodes that grow, lose members, and end sorted without repeats.
module kj_node_list
   use kj_sort, only: lookup_t, sorted_order, sort_unique, lower_bound
   use kj_deck_text, only: lengthen
   implicit none
   private

   public :: node_list_t, add_node, add_nodes, add_range, remove_nodes, keep_nodes, finish_list

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

end module kj_node_list
