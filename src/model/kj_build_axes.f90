!> Cards -> draft: skews, and frames as they are at the start.
module kj_build_axes
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR
   use kj_math3, only: cross, unit
   use kj_sort, only: find
   use kj_keywords, only: KW_SKEW_FIX, KW_SKEW_MOV, KW_SKEW_MOV2, KW_FRAME_FIX, KW_FRAME_MOV, &
      KW_FRAME_MOV2, KW_FRAME_NOD
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_draft, only: draft_t, blocks_of, block_lookup, report_double_blocks
   use kj_skew, only: skew_axes
   use kj_model, only: skew_set_t
   implicit none
   private

   public :: build_skews, build_frames

contains

   !> Fixed and moving skews
   subroutine build_skews(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i

      blocks = [blocks_of(deck, KW_SKEW_FIX), blocks_of(deck, KW_SKEW_MOV), &
         blocks_of(deck, KW_SKEW_MOV2)]
      call block_lookup(deck, blocks, draft%skew)
      call report_double_blocks(deck, blocks, 'skew', findings)
      call new_axes(deck, blocks, draft%skews)
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         if (deck%block(blocks(i))%keyword == KW_SKEW_FIX) then
            call fixed_axes(deck, cards, .true., draft%skews%axes(i, :), findings)
         else
            call moving_axes(deck, cards, draft, i, draft%skews, findings)
         end if
      end do
   end subroutine build_skews

   !> Frames, which have an origin too
   subroutine build_frames(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i

      blocks = [blocks_of(deck, KW_FRAME_FIX), blocks_of(deck, KW_FRAME_MOV), &
         blocks_of(deck, KW_FRAME_MOV2), blocks_of(deck, KW_FRAME_NOD)]
      call block_lookup(deck, blocks, draft%frame)
      call report_double_blocks(deck, blocks, 'frame', findings)
      call new_axes(deck, blocks, draft%frames)
      allocate (draft%frame_origin(0:size(blocks), 3), source=0.0_wp)
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         select case (deck%block(blocks(i))%keyword)
         case (KW_FRAME_FIX)
            call fixed_axes(deck, cards, .false., draft%frames%axes(i, :), findings)
            draft%frame_origin(i, :) = [real_of(cards, 'Ox'), real_of(cards, 'Oy'), &
               real_of(cards, 'Oz')]
         case (KW_FRAME_NOD)
            call node_frame(deck, cards, draft, i, findings)
         case default
            call moving_axes(deck, cards, draft, i, draft%frames, findings)
            if (draft%frames%node(1, i) > 0) &
               draft%frame_origin(i, :) = draft%x(draft%frames%node(1, i), :)
         end select
      end do
   end subroutine build_frames

   !> Axes of n blocks, all global
   subroutine new_axes(deck, blocks, set)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:)
      type(skew_set_t), intent(inout) :: set

      integer :: i

      set%n = size(blocks)
      set%id = deck%block(blocks)%id
      allocate (set%node(3, set%n), set%dir(set%n), source=0)
      allocate (set%axes(0:set%n, 9), source=0.0_wp)
      do i = 1, 9, 4
         set%axes(:, i) = 1.0_wp
      end do
   end subroutine new_axes

   !> Axes from a Y and a Z vector: z' = Z, x' = Y x Z, y' = z' x x'
   subroutine fixed_axes(deck, cards, replace, axes, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      logical, intent(in) :: replace             !! zero vectors mean the global axes
      real(wp), intent(inout) :: axes(9)
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: y(3), z(3)

      y = [real_of(cards, 'Yx'), real_of(cards, 'Yy'), real_of(cards, 'Yz')]
      z = [real_of(cards, 'Zx'), real_of(cards, 'Zy'), real_of(cards, 'Zz')]
      if (replace .and. all(abs(y) <= 0.0_wp)) y = [0.0_wp, 1.0_wp, 0.0_wp]
      if (replace .and. all(abs(z) <= 0.0_wp)) z = [0.0_wp, 0.0_wp, 1.0_wp]
      if (.not. norm2(cross(unit_or_zero(y), unit_or_zero(z))) > 1.0e-10_wp) then
         call report(deck, cards, 'Yx', SEV_ERROR, 'KJ-9143', &
            'the Y and Z vectors of the axes do not span a plane', &
            'expected: two vectors that are not along one line', findings)
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
   subroutine moving_axes(deck, cards, draft, i, set, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: i                   !! index in the set
      type(skew_set_t), intent(inout) :: set
      type(finding_list_t), intent(inout) :: findings

      character(len=2), parameter :: FIELD(3) = ['n1', 'n2', 'n3']
      real(wp) :: a(3), b(3)
      integer :: k, raw(3), dir

      do k = 1, 3
         raw(k) = find(draft%node, int_of(cards, FIELD(k)))
         if (raw(k) == 0) call report(deck, cards, FIELD(k), SEV_ERROR, 'KJ-0078', &
            'node '//str(int_of(cards, FIELD(k)))//' is not defined', 'no such node', findings)
      end do
      dir = 1
      if (any(deck%block(cards%block)%keyword == [KW_SKEW_MOV2, KW_FRAME_MOV2])) then
         dir = 3
      else if (is_given(cards, 'dir')) then
         dir = index('XYZ', text_of(cards, 'dir'))
         if (len(text_of(cards, 'dir')) /= 1) dir = 0
         if (dir == 0) call report(deck, cards, 'dir', SEV_ERROR, 'KJ-9110', &
            'the direction of the axes is not X, Y or Z', 'expected: X, Y or Z', findings)
      end if
      if (any(raw == 0) .or. dir == 0) return
      set%node(:, i) = raw
      set%dir(i) = dir
      a = draft%x(raw(2), :) - draft%x(raw(1), :)
      b = draft%x(raw(3), :) - draft%x(raw(1), :)
      if (.not. norm2(a) > 0.0_wp) then
         call report(deck, cards, 'n2', SEV_ERROR, 'KJ-0162', &
            'nodes 1 and 2 of the axes coincide', &
            'same place as node 1', findings)
      else if (.not. norm2(cross(unit_or_zero(a), unit_or_zero(b))) > 1.0e-10_wp) then
         call report(deck, cards, 'n3', SEV_ERROR, 'KJ-0163', &
            'the nodes of the axes stand in a line', 'on the line of nodes 1 and 2', findings)
      else
         set%axes(i, :) = skew_axes(dir, draft%x(raw(1), :), draft%x(raw(2), :), draft%x(raw(3), :))
      end if
   end subroutine moving_axes

   !> /FRAME/NOD: origin in n1; axes from n2 and n3, or from two vectors where these are blank
   subroutine node_frame(deck, cards, draft, i, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: i
      type(finding_list_t), intent(inout) :: findings

      integer :: raw

      if (int_of(cards, 'n1') <= 0) then
         call report(deck, cards, 'n1', SEV_ERROR, 'KJ-0900', 'the frame has no node', &
            'expected: id of a node', findings)
         return
      end if
      if (int_of(cards, 'n2') == 0 .and. int_of(cards, 'n3') == 0) then
         call fixed_axes(deck, cards, .false., draft%frames%axes(i, :), findings)
         raw = find(draft%node, int_of(cards, 'n1'))
         if (raw == 0) call report(deck, cards, 'n1', SEV_ERROR, 'KJ-0078', 'node '// &
            str(int_of(cards, 'n1'))//' is not defined', 'no such node', findings)
      else
         call moving_axes(deck, cards, draft, i, draft%frames, findings)
         raw = draft%frames%node(1, i)
      end if
      if (raw > 0) draft%frame_origin(i, :) = draft%x(raw, :)
   end subroutine node_frame

end module kj_build_axes
