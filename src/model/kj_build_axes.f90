!> Cards -> draft: skews, and frames as they are at the start.
module kj_build_axes
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR
   use kj_math3, only: cross, unit
   use kj_sort, only: lookup_t
   use kj_keywords, only: KW_SKEW_FIX, KW_SKEW_MOV, KW_SKEW_MOV2, KW_FRAME_FIX, KW_FRAME_MOV, &
      KW_FRAME_MOV2, KW_FRAME_NOD, keywords
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_draft, only: draft_t, moved_point, find_blocks, node_of
   use kj_skew, only: skew_axes
   use kj_model, only: skew_set_t
   implicit none
   private

   public :: build_skews, build_frames

contains

   !> Skews, fixed and moving
   subroutine build_skews(draft)
      type(draft_t), intent(inout) :: draft

      type(lookup_t) :: id
      type(skew_set_t) :: set
      real(wp), allocatable :: origin(:, :)

      call read_axes(draft, [KW_SKEW_FIX, KW_SKEW_MOV, KW_SKEW_MOV2], 'skew', id, set, origin)
      draft%skew = id
      draft%skews = set
   end subroutine build_skews

   !> Frames, which have an origin too
   subroutine build_frames(draft)
      type(draft_t), intent(inout) :: draft

      type(lookup_t) :: id
      type(skew_set_t) :: set
      real(wp), allocatable :: origin(:, :)

      call read_axes(draft, [KW_FRAME_FIX, KW_FRAME_MOV, KW_FRAME_MOV2, KW_FRAME_NOD], 'frame', &
         id, set, origin)
      draft%frame = id
      draft%frames = set
      call move_alloc(origin, draft%frame_origin)
   end subroutine build_frames

   !> Axes and origins of all blocks of some keywords; those that are wrong stay global
   subroutine read_axes(draft, keywords, what, id, set, origin)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: keywords(:)         !! KW_ constants
      character(len=*), intent(in) :: what       !! "skew" or "frame"
      type(lookup_t), intent(out) :: id
      type(skew_set_t), intent(out) :: set
      real(wp), allocatable, intent(out) :: origin(:, :)   !! (0:n, 3)

      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i, first, keyword

      call find_blocks(draft%deck, keywords, what, blocks, id)
      set%n = size(blocks)
      set%id = draft%deck%block(blocks)%id
      allocate (set%node(3, set%n), set%dir(set%n), source=0)
      allocate (set%axes(0:set%n, 9), origin(0:set%n, 3), source=0.0_wp)
      set%axes(:, 1:9:4) = 1.0_wp
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         keyword = draft%deck%block(blocks(i))%keyword
         first = 0
         if (any(keyword == [KW_SKEW_FIX, KW_FRAME_FIX])) then
            call fixed_axes(draft%deck, cards, keyword == KW_SKEW_FIX, set%axes(i, :))
            origin(i, :) = [real_of(cards, 'Ox'), real_of(cards, 'Oy'), real_of(cards, 'Oz')]
            call move_axes(draft, blocks(i), set%axes(i, :), origin(i, :))
         else if (keyword == KW_FRAME_NOD .and. int_of(cards, 'n1') <= 0) then
            call report(draft%deck, cards, 'n1', SEV_ERROR, 'KJ-0900', 'the frame has no node', &
               'expected: id of a node')
         else if (keyword == KW_FRAME_NOD .and. int_of(cards, 'n2') == 0 .and. &
            int_of(cards, 'n3') == 0) then
            call fixed_axes(draft%deck, cards, .false., set%axes(i, :))
            first = node_of(draft, cards, 'n1')
         else
            call moving_axes(draft, cards, set%node(:, i), set%dir(i), set%axes(i, :))
            first = set%node(1, i)
         end if
         if (first > 0) origin(i, :) = draft%x(first, :)
      end do
   end subroutine read_axes

   !> Axes typed in a submodel go where it is moved; a mirror turns the third round
   pure subroutine move_axes(draft, block, axes, origin)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block
      real(wp), intent(inout) :: axes(9), origin(3)

      real(wp) :: y(3), z(3)

      if (draft%deck%block(block)%submodel == 0) return
      origin = moved_point(draft, block, origin, .false.)
      y = moved_point(draft, block, axes(4:6), .true.)
      z = moved_point(draft, block, axes(7:9), .true.)
      axes(1:3) = unit(cross(y, z))
      axes(7:9) = unit(z)
      axes(4:6) = cross(axes(7:9), axes(1:3))
   end subroutine move_axes

   !> Axes from a Y and a Z vector: z' = Z, x' = Y x Z, y' = z' x x'
   subroutine fixed_axes(deck, cards, replace, axes)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      logical, intent(in) :: replace             !! zero vectors mean the global axes
      real(wp), intent(inout) :: axes(9)

      real(wp) :: y(3), z(3)

      y = [real_of(cards, 'Yx'), real_of(cards, 'Yy'), real_of(cards, 'Yz')]
      z = [real_of(cards, 'Zx'), real_of(cards, 'Zy'), real_of(cards, 'Zz')]
      if (replace .and. all(abs(y) <= 0.0_wp)) y = [0.0_wp, 1.0_wp, 0.0_wp]
      if (replace .and. all(abs(z) <= 0.0_wp)) z = [0.0_wp, 0.0_wp, 1.0_wp]
      if (.not. norm2(cross(unit_or_zero(y), unit_or_zero(z))) > 1.0e-10_wp) then
         call report(deck, cards, 'Yx', SEV_ERROR, 'KJ-9143', &
            'the Y and Z vectors of the axes do not span a plane', &
            'expected: two vectors that are not along one line')
         return
      end if
      axes(7:9) = unit(z)
      axes(1:3) = unit(cross(y, z))
      axes(4:6) = cross(axes(7:9), axes(1:3))
   end subroutine fixed_axes

   !> Unit vector, safe for vectors of any length
   pure function unit_or_zero(v) result(u)
      real(wp), intent(in) :: v(3)
      real(wp) :: u(3)

      u = 0.0_wp
      if (maxval(abs(v)) > 0.0_wp) u = unit(v/maxval(abs(v)))
   end function unit_or_zero

   !> Axes from three nodes: their places give those at the start
   subroutine moving_axes(draft, cards, node, dir, axes)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      integer, intent(inout) :: node(3)          !! raw indices; 0 when one is missing
      integer, intent(inout) :: dir              !! axis along node 1 -> node 2, 1 x to 3 z
      real(wp), intent(inout) :: axes(9)

      real(wp) :: x(3, 3)
      integer :: k, raw(3), along

      do k = 1, 3
         raw(k) = node_of(draft, cards, 'n'//str(k))
      end do
      along = 1
      if (any(draft%deck%block(cards%block)%keyword == [KW_SKEW_MOV2, KW_FRAME_MOV2])) then
         along = 3
      else if (is_given(cards, 'dir')) then
         along = findloc(['X', 'Y', 'Z'], text_of(cards, 'dir'), 1)
         if (along == 0) call report(draft%deck, cards, 'dir', SEV_ERROR, 'KJ-9110', &
            'the direction of the axes is not X, Y or Z', 'expected: X, Y or Z')
      end if
      if (any(raw == 0) .or. along == 0) return
      node = raw
      dir = along
      x = transpose(draft%x(raw, :))
      if (.not. norm2(x(:, 2) - x(:, 1)) > 0.0_wp) then
         call report(draft%deck, cards, 'n2', SEV_ERROR, 'KJ-0162', &
            'nodes 1 and 2 of the axes coincide', 'same place as node 1')
      else if (.not. norm2(cross(unit_or_zero(x(:, 2) - x(:, 1)), &
         unit_or_zero(x(:, 3) - x(:, 1)))) > 1.0e-10_wp) then
         call report(draft%deck, cards, 'n3', SEV_ERROR, 'KJ-0163', &
            'the nodes of the axes stand in a line', 'on the line of nodes 1 and 2')
      else
         axes = skew_axes(dir, x(:, 1), x(:, 2), x(:, 3))
      end if
   end subroutine moving_axes

end module kj_build_axes
