!> /TRANSFORM: nodes are moved, in the order of the deck, before anything is built on them.
!>
!> Every move is x' = a x + b. Source: docs/theory/full.md 3.
module kj_transform
   use kj_kinds, only: wp
   use kj_error, only: SEV_ERROR, SEV_WARNING, str
   use kj_sort, only: find
   use kj_math3, only: cross, unit, rotation, IDENTITY
   use kj_keywords, only: KW_TRANS_TRA, KW_TRANS_ROT, KW_TRANS_SYM, KW_TRANS_SCA, &
      KW_TRANS_MATRIX, KW_TRANS_POSITION
   use kj_cards, only: cards_t, read_cards, real_of, int_of, report
   use kj_draft, only: draft_t, move_t, group_nodes, node_of
   use kj_build_axes, only: build_skews
   use kj_build_group, only: build_groups
   use kj_node_list, only: node_list_t, finish_list
   use kj_select, only: submodel_nodes
   implicit none
   private

   public :: move_nodes

   integer, parameter :: MOVES(*) = [KW_TRANS_TRA, KW_TRANS_ROT, KW_TRANS_SYM, KW_TRANS_SCA, &
      KW_TRANS_MATRIX, KW_TRANS_POSITION]
   real(wp), parameter :: PI = acos(-1.0_wp)

contains

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

      call group_nodes(draft, cards, 'grnod_id', 'KJ-0053', .false., node)
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

end module kj_transform
