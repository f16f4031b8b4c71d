!> Cards -> boxes, by which groups choose nodes and elements.
module kj_box
   use kj_kinds, only: wp
   use kj_error, only: SEV_WARNING
   use kj_math3, only: cross
   use kj_keywords, only: KW_BOX_RECTA, KW_BOX_SPHER, KW_BOX_CYLIN
   use kj_cards, only: cards_t, read_cards, real_of, int_of, report
   use kj_draft, only: draft_t, box_set_t, moved_point, find_blocks, reference, node_of
   implicit none
   private

   public :: build_boxes, is_inside

contains

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

end module kj_box
