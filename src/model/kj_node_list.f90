!> Lists of nodes while a group is put together: they grow, lose members, and end sorted.
module kj_node_list
   use kj_sort, only: lower_bound, sorted_order
   use kj_deck_text, only: lengthen
   use kj_draft, only: draft_t
   implicit none
   private

   public :: node_list_t, add_node, add_nodes, remove_nodes, add_range, add_steps, add_parts, &
      add_elements, finish_list

   !> Nodes in the order they came, with repeats
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
      if (list%n == size(list%node)) call lengthen(list%node)
      list%n = list%n + 1
      list%node(list%n) = raw
   end subroutine add_node

   !> Append nodes
   pure subroutine add_nodes(raw, list)
      integer, intent(in) :: raw(:)
      type(node_list_t), intent(inout) :: list

      integer :: i

      do i = 1, size(raw)
         call add_node(raw(i), list)
      end do
   end subroutine add_nodes

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

   !> Append the nodes whose ids are in [first, last]
   pure subroutine add_range(draft, first, last, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first, last
      type(node_list_t), intent(inout) :: list

      integer :: i

      do i = lower_bound(draft%node%id, first), size(draft%node%id)
         if (draft%node%id(i) > last) return
         call add_node(draft%node%place(i), list)
      end do
   end subroutine add_range

   !> Append the nodes whose ids are first, first + step, ... up to last
   pure subroutine add_steps(draft, first, last, step, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first, last, step   !! step > 0
      type(node_list_t), intent(inout) :: list

      integer :: i

      do i = lower_bound(draft%node%id, first), size(draft%node%id)
         if (draft%node%id(i) > last) return
         if (is_step(draft%node%id(i), first, step)) call add_node(draft%node%place(i), list)
      end do
   end subroutine add_steps

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

end module kj_node_list
