!> Cards -> boxes, and the nodes in them.
module kj_build_box
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, find
   use kj_keywords, only: KW_BOX_RECTA
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, read_cards, real_of, int_of, report
   use kj_draft, only: draft_t, blocks_of, block_lookup, report_double_blocks, reference
   use kj_node_list, only: node_list_t, add_node
   implicit none
   private

   public :: box_set_t, build_boxes, add_box

   !> Boxes with their edges along the axes of skews
   type :: box_set_t
      type(lookup_t) :: id
      integer, allocatable :: skew(:)            !! (n) skew index, 0 = global
      real(wp), allocatable :: lo(:, :), hi(:, :)   !! (3, n) corners, components in the skew
   end type box_set_t

contains

   !> /BOX/RECTA: two corners, as points in W or as nodes; the edges are along the skew
   subroutine build_boxes(deck, draft, boxes, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(box_set_t), intent(out) :: boxes
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      real(wp) :: corner(3, 2), a(3, 3)
      logical :: typed(2)
      integer :: i

      blocks = blocks_of(deck, KW_BOX_RECTA)
      call block_lookup(deck, blocks, boxes%id)
      call report_double_blocks(deck, blocks, 'box', findings)
      allocate (boxes%skew(size(blocks)), boxes%lo(3, size(blocks)), boxes%hi(3, size(blocks)))
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         call read_corner(deck, draft, cards, '1', corner(:, 1), typed(1), findings)
         call read_corner(deck, draft, cards, '2', corner(:, 2), typed(2), findings)
         boxes%skew(i) = reference(deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137', findings)
         if (boxes%skew(i) > 0 .and. any(typed)) call report(deck, cards, 'skew_id', SEV_WARNING, &
            'KJ-9142', 'a box with a skew: its corners are taken as points in global axes', &
            'gives the directions of the edges', findings, &
            hint='name nodes as corners where this is not meant')
         a = reshape(draft%skews%axes(boxes%skew(i), :), [3, 3])
         corner = matmul(transpose(a), corner)
         boxes%lo(:, i) = min(corner(:, 1), corner(:, 2))
         boxes%hi(:, i) = max(corner(:, 1), corner(:, 2))
      end do
   end subroutine build_boxes

   !> A corner: the place of node n1 (n2), or else the point that is typed
   subroutine read_corner(deck, draft, cards, which, corner, typed, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(cards_t), intent(in) :: cards
      character(len=1), intent(in) :: which      !! 1 or 2
      real(wp), intent(out) :: corner(3)         !! W, length
      logical, intent(out) :: typed
      type(finding_list_t), intent(inout) :: findings

      integer :: raw

      corner = [real_of(cards, 'X'//which), real_of(cards, 'Y'//which), real_of(cards, 'Z'//which)]
      typed = int_of(cards, 'n'//which) == 0
      if (typed) return
      raw = find(draft%node, int_of(cards, 'n'//which))
      if (raw > 0) then
         corner = draft%x(raw, :)
      else
         call report(deck, cards, 'n'//which, SEV_ERROR, 'KJ-0078', 'node '// &
            str(int_of(cards, 'n'//which))//' is not defined', 'no such node', findings)
      end if
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

end module kj_build_box
