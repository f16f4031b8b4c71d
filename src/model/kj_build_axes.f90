!> Cards -> draft: skews, and frames as they are at the start.
module kj_build_axes
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_math3, only: cross, unit, rotation, IDENTITY
   use kj_sort, only: lookup_t, find
   use kj_keywords, only: KW_SKEW_FIX, KW_SKEW_MOV, KW_SKEW_MOV2, KW_FRAME_FIX, KW_FRAME_MOV, &
      KW_FRAME_MOV2, KW_FRAME_NOD, keywords, KW_TRANS_TRA, KW_TRANS_ROT, KW_TRANS_SYM, &
      KW_TRANS_SCA, KW_TRANS_MATRIX, KW_TRANS_POSITION
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_draft, only: draft_t, moved_point, find_blocks, node_of, move_t, group_nodes
   use kj_skew, only: skew_axes
   use kj_model, only: skew_set_t
   use kj_build_group, only: build_groups
   use kj_node_list, only: node_list_t, finish_list
   use kj_select, only: submodel_nodes
   implicit none
   private

   public :: build_skews, build_frames, move_nodes

   integer, parameter :: MOVES(*) = [KW_TRANS_TRA, KW_TRANS_ROT, KW_TRANS_SYM, KW_TRANS_SCA, &
      KW_TRANS_MATRIX, KW_TRANS_POSITION]
   real(wp), parameter :: PI = acos(-1.0_wp)

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

   !> Move the nodes of the draft; draft%moves keeps those of submodels, which take skews along
   subroutine move_nodes(draft)
      type(draft_t), intent(inout) :: draft

      type(cards_t) :: cards
      type(move_t) :: move
      integer, allocatable :: node(:)
      integer :: block, i, keyword

      allocate (draft%moves(0))
      if (all([(all(MOVES /= draft%deck%block(block)%keyword), block=1, draft%deck%n_block)])) &
         return
      call build_skews(draft)
      call build_groups(draft)
      do block = 1, draft%deck%n_block
         keyword = draft%deck%block(block)%keyword
         if (all(MOVES /= keyword)) cycle
         call read_cards(draft%deck, block, cards)
         call choose_nodes(draft, cards, node)
         select case (keyword)
         case (KW_TRANS_TRA); call translate(draft, cards, move)
         case (KW_TRANS_ROT); call turn(draft, cards, move)
         case (KW_TRANS_SYM); call mirror(draft, cards, move)
         case (KW_TRANS_SCA); call stretch(draft, cards, move)
         case (KW_TRANS_MATRIX); call multiply(cards, move)
         case (KW_TRANS_POSITION); call place(draft, cards, move)
         end select
         do i = 1, size(node)
            draft%x(node(i), :) = matmul(move%a, draft%x(node(i), :)) + move%b
         end do
         move%submodel = int_of(cards, 'submodel')
         if (move%submodel > 0) draft%moves = [draft%moves, move]
      end do
   end subroutine move_nodes

   !> The nodes of a group, or those of a submodel
   subroutine choose_nodes(draft, cards, node)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      integer, allocatable, intent(out) :: node(:)

      type(node_list_t) :: list

      call group_nodes(draft, cards, 'KJ-0053', .false., node)
      if (int_of(cards, 'submodel') > 0) then
         call submodel_nodes(draft, int_of(cards, 'submodel'), list)
         call finish_list(draft%id, list, node)
         if (size(node) == 0) call report(draft%deck, cards, 'submodel', SEV_WARNING, 'KJ-9408', &
            'submodel '//str(int_of(cards, 'submodel'))//' has no node', 'moves nothing')
      else if (int_of(cards, 'grnod_id') == 0) then
         call report(draft%deck, cards, 'grnod_id', SEV_ERROR, 'KJ-1865', &
            'the move names neither a group of nodes nor a submodel', 'expected: an id')
      end if
   end subroutine choose_nodes

   !> Place of node n1 or n2, ...; else the point X1 Y1 Z1, ... that is typed
   function point(draft, cards, which) result(x)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      character(len=1), intent(in) :: which
      real(wp) :: x(3)

      integer :: raw

      x = [real_of(cards, 'X'//which), real_of(cards, 'Y'//which), real_of(cards, 'Z'//which)]
      if (int_of(cards, 'n'//which) == 0) return
      raw = node_of(draft, cards, 'n'//which)
      if (raw > 0) x = draft%x(raw, :)
   end function point

   !> Along a vector, or from node 1 to node 2
   subroutine translate(draft, cards, move)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(move_t), intent(out) :: move

      real(wp) :: t(3)
      integer :: skew

      t = [real_of(cards, 'Tx'), real_of(cards, 'Ty'), real_of(cards, 'Tz')]
      skew = find(draft%skew, int_of(cards, 'skew_id'))
      if (skew > 0) t = matmul(reshape(draft%skews%axes(skew, :), [3, 3]), t)
      if (int_of(cards, 'n1') > 0 .and. int_of(cards, 'n2') > 0) &
         t = point(draft, cards, '2') - point(draft, cards, '1')
      move%b = t
   end subroutine translate

   !> About the axis from point 1 to point 2, right-handed
   subroutine turn(draft, cards, move)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(move_t), intent(out) :: move

      real(wp) :: p(3), axis(3)

      p = point(draft, cards, '1')
      axis = axis_of(draft, cards)
      move%a = rotation(axis*real_of(cards, 'Angle')*PI/180.0_wp)
      move%b = p - matmul(move%a, p)
   end subroutine turn

   !> At the plane through point 1 across the axis to point 2: a = 1 - 2 n n^T
   subroutine mirror(draft, cards, move)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(move_t), intent(out) :: move

      real(wp) :: p(3), n(3)

      p = point(draft, cards, '1')
      n = axis_of(draft, cards)
      move%a = IDENTITY - 2.0_wp*spread(n, 2, 3)*spread(n, 1, 3)
      move%b = 2.0_wp*dot_product(n, p)*n
   end subroutine mirror

   !> Unit vector from point 1 to point 2; reported when they coincide
   function axis_of(draft, cards) result(axis)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      real(wp) :: axis(3)

      axis = point(draft, cards, '2') - point(draft, cards, '1')
      if (norm2(axis) <= 0.0_wp) call report(draft%deck, cards, 'X2', SEV_ERROR, 'KJ-9410', &
         'the points of the axis coincide', 'expected: another point')
      axis = unit(axis)
   end function axis_of

   !> By three factors about node 1, or about the origin
   subroutine stretch(draft, cards, move)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(move_t), intent(out) :: move

      real(wp) :: s(3), p(3)
      integer :: i

      s = [real_of(cards, 'Sx'), real_of(cards, 'Sy'), real_of(cards, 'Sz')]
      where (abs(s) <= 0.0_wp) s = 1.0_wp
      p = point(draft, cards, '1')
      move%a = 0.0_wp
      do i = 1, 3
         move%a(i, i) = s(i)
      end do
      move%b = p - s*p
   end subroutine stretch

   !> By a matrix whose rows are typed
   subroutine multiply(cards, move)
      type(cards_t), intent(in) :: cards
      type(move_t), intent(out) :: move

      integer :: i, k

      do i = 1, 3
         do k = 1, 3
            move%a(i, k) = real_of(cards, 'M'//str(i)//str(k))
         end do
      end do
      move%b = [real_of(cards, 'Tx'), real_of(cards, 'Ty'), real_of(cards, 'Tz')]
   end subroutine multiply

   !> From points 1, 2, 3 to points 4, 5, 6: 1 comes to 4, the line 1-2 along 4-5, 3 into the plane
   subroutine place(draft, cards, move)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(move_t), intent(out) :: move

      real(wp) :: p(3, 6)
      integer :: i

      do i = 1, 6
         p(:, i) = point(draft, cards, str(i))
      end do
      move%a = matmul(triad(p(:, 4:)), transpose(triad(p(:, :3))))
      move%b = p(:, 4) - matmul(move%a, p(:, 1))
   end subroutine place

   !> Axes of three points: x from 1 to 2, 3 in the plane of x and y
   pure function triad(p) result(axes)
      real(wp), intent(in) :: p(3, 3)
      real(wp) :: axes(3, 3)

      axes(:, 1) = unit(p(:, 2) - p(:, 1))
      axes(:, 3) = unit(cross(p(:, 2) - p(:, 1), p(:, 3) - p(:, 1)))
      axes(:, 2) = cross(axes(:, 3), axes(:, 1))
   end function triad

end module kj_build_axes
