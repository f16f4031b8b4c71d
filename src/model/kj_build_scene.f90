!> Cards -> draft: nodes, groups, added masses, skews, curves, sensors.
module kj_build_scene
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_math3, only: cross, unit
   use kj_sort, only: new_lookup, find, sort_unique
   use kj_curve, only: add_curve
   use kj_keywords, only: KW_NODE, KW_CNODE, KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_ADMAS, KW_SKEW_FIX, KW_SKEW_MOV, &
      KW_SKEW_MOV2, KW_FRAME_FIX, KW_FUNCT, KW_SENSOR_TIME
   use kj_deck_data, only: deck_t
   use kj_cards, only: cards_t, rows_t, ids_t, read_cards, read_rows, read_ids, real_of, int_of, text_of, &
      is_given, report, report_row, report_id, report_header
   use kj_draft, only: draft_t, blocks_of, block_lookup, group_nodes
   use kj_skew, only: skew_axes
   implicit none
   private

   public :: build_nodes, build_groups, build_masses, build_skews, build_frames, build_curves, build_sensors

contains

   !> Nodes of all /NODE blocks
   subroutine build_nodes(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(rows_t), allocatable :: rows(:)
      integer :: i, n

      blocks = [blocks_of(deck, KW_NODE), blocks_of(deck, KW_CNODE)]
      allocate (rows(size(blocks)))
      do i = 1, size(blocks)
         call read_rows(deck, blocks(i), rows(i), findings)
      end do
      draft%n_node = sum(rows%n)
      allocate (draft%id(draft%n_node), draft%x(draft%n_node, 3))
      n = 0
      do i = 1, size(blocks)
         draft%id(n + 1:n + rows(i)%n) = rows(i)%ints(:rows(i)%n, 1)
         draft%x(n + 1:n + rows(i)%n, :) = rows(i)%reals(:rows(i)%n, 1:3)
         n = n + rows(i)%n
      end do
      call new_lookup(draft%id, draft%node)
      call report_double_nodes(deck, blocks, rows, draft, findings)
      allocate (draft%mass(n), draft%inertia(n), source=0.0_wp)
      allocate (draft%body(n), draft%main_of(n), draft%new(n), source=0)
   end subroutine build_nodes

   subroutine report_double_nodes(deck, blocks, rows, draft, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:)
      type(rows_t), intent(in) :: rows(:)
      type(draft_t), intent(in) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer :: i, k, n, place

      do i = 2, draft%n_node
         if (draft%node%id(i) /= draft%node%id(i - 1)) cycle
         place = draft%node%place(i)
         n = 0
         do k = 1, size(rows)
            if (place <= n + rows(k)%n) exit
            n = n + rows(k)%n
         end do
         call report_row(deck, blocks(k), rows(k), place - n, 'id', SEV_ERROR, 'KJ-0056', &
            'node '//str(draft%node%id(i))//' is defined twice', 'used before', findings)
      end do
   end subroutine report_double_nodes

   !> Node groups
   subroutine build_groups(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(ids_t) :: ids
      integer :: i, k, n, raw

      blocks = [blocks_of(deck, KW_GRNOD_NODE), blocks_of(deck, KW_GRNOD_NODENS)]
      call block_lookup(deck, blocks, draft%group)
      call report_double_blocks(deck, blocks, 'node group', findings)
      allocate (draft%groups(size(blocks)))
      do i = 1, size(blocks)
         draft%groups(i)%block = blocks(i)
         call read_ids(deck, blocks(i), ids, findings)
         n = 0
         do k = 1, ids%n
            if (ids%value(k) < 0) cycle
            raw = find(draft%node, ids%value(k))
            if (raw == 0) then
               call report_id(deck, ids, k, SEV_ERROR, 'KJ-0078', 'node '//str(ids%value(k))// &
                  ' is not defined', 'no such node', findings)
               cycle
            end if
            n = n + 1
            ids%value(n) = ids%value(k)
         end do
         if (n == 0) call report_header(deck, blocks(i), SEV_WARNING, 'KJ-0690', &
            'the node group is empty', 'no node', findings)
         draft%groups(i)%node = sort_unique(ids%value(:n))
         draft%groups(i)%node = [(find(draft%node, draft%groups(i)%node(k)), &
            k=1, size(draft%groups(i)%node))]
      end do
   end subroutine build_groups

   !> Two blocks of one family with the same id
   subroutine report_double_blocks(deck, blocks, what, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:)
      character(len=*), intent(in) :: what
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: ids(:)
      integer :: i

      ids = deck%block(blocks)%id
      if (size(sort_unique(ids)) == size(ids)) return
      do i = 2, size(ids)
         if (any(ids(:i - 1) == ids(i))) call report_header(deck, blocks(i), SEV_ERROR, 'KJ-0079', &
            what//' '//str(ids(i))//' is defined twice', 'used before', findings)
      end do
   end subroutine report_double_blocks

   !> Added masses of nodes
   subroutine build_masses(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:), nodes(:)
      type(cards_t) :: cards
      real(wp) :: mass
      integer :: i

      blocks = blocks_of(deck, KW_ADMAS)
      do i = 1, size(blocks)
         if (deck%block(blocks(i))%variant == 5) call add_node_masses(deck, blocks(i), draft, findings)
         if (deck%block(blocks(i))%variant > 1) cycle
         call read_cards(deck, blocks(i), cards, findings)
         call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0668', findings, nodes)
         mass = real_of(cards, 'mass')
         if (mass < 0.0_wp) call report(deck, cards, 'mass', SEV_WARNING, 'KJ-0476', &
            'the added mass is negative', 'less than zero', findings)
         if (deck%block(blocks(i))%variant == 1) mass = mass/real(max(1, size(nodes)), wp)
         draft%mass(nodes) = draft%mass(nodes) + mass
      end do
   end subroutine build_masses

   !> Masses of single nodes: /ADMAS/5
   subroutine add_node_masses(deck, block, draft, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      type(rows_t) :: rows
      integer :: i, node

      call read_rows(deck, block, rows, findings)
      do i = 1, rows%n
         node = find(draft%node, rows%ints(i, 1))
         if (node == 0) then
            call report_row(deck, block, rows, i, 'node_id', SEV_ERROR, 'KJ-0078', 'node '// &
               str(rows%ints(i, 1))//' is not defined', 'no such node', findings)
            cycle
         end if
         if (rows%reals(i, 1) < 0.0_wp) call report_row(deck, block, rows, i, 'mass', SEV_WARNING, &
            'KJ-0476', 'the added mass is negative', 'less than zero', findings)
         draft%mass(node) = draft%mass(node) + rows%reals(i, 1)
      end do
   end subroutine add_node_masses

   !> Fixed and moving skews, and fixed frames for /INIVEL/AXIS
   subroutine build_skews(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: fixed(:), moving(:), blocks(:)
      type(cards_t) :: cards
      integer :: i

      fixed = blocks_of(deck, KW_SKEW_FIX)
      moving = [blocks_of(deck, KW_SKEW_MOV), blocks_of(deck, KW_SKEW_MOV2)]
      blocks = [fixed, moving]
      call block_lookup(deck, blocks, draft%skew)
      call report_double_blocks(deck, blocks, 'skew', findings)
      associate (s => draft%skews)
         s%n = size(blocks)
         s%id = deck%block(blocks)%id
         allocate (s%node(3, s%n), s%dir(s%n), source=0)
         allocate (s%axes(0:s%n, 9), source=0.0_wp)
         s%axes(0, 1:9:4) = 1.0_wp
         do i = 1, s%n
            call read_cards(deck, blocks(i), cards, findings)
            if (i <= size(fixed)) then
               s%axes(i, :) = fixed_axes(cards)
            else
               call moving_skew(deck, cards, i, draft, findings)
            end if
         end do
      end associate
   end subroutine build_skews

   !> Fixed frames, which have an origin too
   subroutine build_frames(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i

      blocks = blocks_of(deck, KW_FRAME_FIX)
      call block_lookup(deck, blocks, draft%frame)
      call report_double_blocks(deck, blocks, 'frame', findings)
      allocate (draft%frames%axes(0:size(blocks), 9), draft%frame_origin(0:size(blocks), 3), source=0.0_wp)
      draft%frames%axes(0, 1:9:4) = 1.0_wp
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         draft%frames%axes(i, :) = fixed_axes(cards)
         draft%frame_origin(i, :) = [real_of(cards, 'Ox'), real_of(cards, 'Oy'), real_of(cards, 'Oz')]
      end do
   end subroutine build_frames

   !> Axes from a Y and a Z vector: z' = Z, x' = Y x Z, y' = z' x x'
   function fixed_axes(cards) result(axes)
      type(cards_t), intent(in) :: cards
      real(wp) :: axes(9)

      real(wp) :: y(3), z(3)

      y = [real_of(cards, 'Yx'), real_of(cards, 'Yy'), real_of(cards, 'Yz')]
      z = [real_of(cards, 'Zx'), real_of(cards, 'Zy'), real_of(cards, 'Zz')]
      if (all(abs(y) <= 0.0_wp)) y = [0.0_wp, 1.0_wp, 0.0_wp]
      if (all(abs(z) <= 0.0_wp)) z = [0.0_wp, 0.0_wp, 1.0_wp]
      axes(7:9) = unit(z)
      axes(1:3) = unit(cross(y, z))
      axes(4:6) = cross(axes(7:9), axes(1:3))
   end function fixed_axes

   !> Nodes and direction of skew i of the draft, and its axes at the start
   subroutine moving_skew(deck, cards, i, draft, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: i
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      character(len=2), parameter :: FIELD(3) = ['n1', 'n2', 'n3']
      integer :: k, raw(3)
      real(wp) :: a(3), b(3)

      do k = 1, 3
         raw(k) = find(draft%node, int_of(cards, FIELD(k)))
         if (raw(k) == 0) call report(deck, cards, FIELD(k), SEV_ERROR, 'KJ-0078', &
            'node '//str(int_of(cards, FIELD(k)))//' is not defined', 'no such node', findings)
      end do
      if (any(raw == 0)) return
      associate (s => draft%skews)
         s%node(:, i) = raw
         s%dir(i) = 1
         if (deck%block(cards%block)%keyword == KW_SKEW_MOV2) then
            s%dir(i) = 3
         else if (is_given(cards, 'dir')) then
            s%dir(i) = index('XYZ', text_of(cards, 'dir'))
            if (len(text_of(cards, 'dir')) /= 1) s%dir(i) = 0
            if (s%dir(i) == 0) then
               call report(deck, cards, 'dir', SEV_ERROR, 'KJ-9110', 'the direction of the skew is not X, Y or Z', &
                  'expected: X, Y or Z', findings)
               return
            end if
         end if
         a = draft%x(raw(2), :) - draft%x(raw(1), :)
         b = draft%x(raw(3), :) - draft%x(raw(1), :)
         if (norm2(a) <= 0.0_wp) then
            call report(deck, cards, 'n2', SEV_ERROR, 'KJ-0162', 'nodes 1 and 2 of the skew coincide', &
               'same place as node 1', findings)
         else if (norm2(cross(a, b)) <= 1.0e-10_wp*norm2(a)*norm2(b) .or. norm2(b) <= 0.0_wp) then
            call report(deck, cards, 'n3', SEV_ERROR, 'KJ-0163', 'the nodes of the skew stand in a line', &
               'on the line of nodes 1 and 2', findings)
         end if
         s%axes(i, :) = skew_axes(s%dir(i), draft%x(raw(1), :), draft%x(raw(2), :), draft%x(raw(3), :))
      end associate
   end subroutine moving_skew

   !> /FUNCT
   subroutine build_curves(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(rows_t) :: rows
      integer :: i, k

      blocks = blocks_of(deck, KW_FUNCT)
      call block_lookup(deck, blocks, draft%curve)
      call report_double_blocks(deck, blocks, 'function', findings)
      do i = 1, size(blocks)
         call read_rows(deck, blocks(i), rows, findings)
         do k = 2, rows%n
            if (rows%reals(k, 1) <= rows%reals(k - 1, 1)) call report_row(deck, blocks(i), rows, k, 'x', &
               SEV_ERROR, 'KJ-0156', 'the abscissae of a function must increase', &
               'not above the line before', findings)
         end do
         if (rows%n == 0) then
            call report_header(deck, blocks(i), SEV_ERROR, 'KJ-9112', 'the function has no point', &
               'no card follows', findings)
         else if (rows%n == 1) then
            call report_header(deck, blocks(i), SEV_WARNING, 'KJ-1874', &
               'the function has a single point', 'one card', findings)
         end if
         call add_curve(draft%curves, deck%block(blocks(i))%id, rows%reals(:rows%n, 1), rows%reals(:rows%n, 2))
      end do
   end subroutine build_curves

   !> /SENSOR/TIME
   subroutine build_sensors(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i

      blocks = blocks_of(deck, KW_SENSOR_TIME)
      call block_lookup(deck, blocks, draft%sensor)
      call report_double_blocks(deck, blocks, 'sensor', findings)
      allocate (draft%sensors(size(blocks)))
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         draft%sensors(i)%t_start = real_of(cards, 'Tdelay')
         if (is_given(cards, 'Tstop') .and. real_of(cards, 'Tstop') > 0.0_wp) &
            draft%sensors(i)%t_stop = max(real_of(cards, 'Tstop'), real_of(cards, 'Tdelay'))
      end do
   end subroutine build_sensors

end module kj_build_scene
