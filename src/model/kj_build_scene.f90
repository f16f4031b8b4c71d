!> Cards -> draft: nodes, added masses, functions, sensors; and what the deck says of its analysis.
module kj_build_scene
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, fail, add_finding, error_t, str, SEV_ERROR, SEV_WARNING, &
      ERR_INPUT
   use kj_sort, only: new_lookup, find
   use kj_keywords, only: KW_NODE, KW_ADMAS, KW_FUNCT, KW_MOVE_FUNCT, KW_SENSOR_TIME, KW_ANALY, &
      KW_RANDOM
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, rows_t, read_cards, read_rows, real_of, int_of, is_given, report, &
      report_row, report_header
   use kj_draft, only: draft_t, blocks_of, block_lookup, group_nodes, report_double_blocks, &
      known_ids
   implicit none
   private

   public :: build_nodes, build_masses, build_curves, build_sensors, check_analysis

contains

   !> Nodes of all /NODE blocks
   subroutine build_nodes(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(rows_t), allocatable :: rows(:)
      type(error_t), allocatable :: error
      integer :: i, n

      blocks = blocks_of(deck, KW_NODE)
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
      call report_bad_nodes(deck, blocks, rows, draft, findings)
      allocate (draft%mass(n), draft%inertia(n), source=0.0_wp)
      allocate (draft%body(n), draft%main_of(n), draft%new(n), source=0)
      if (n > 0) return
      call fail(error, ERR_INPUT, 'the deck has no node', 'KJ-0003')
      call add_finding(findings, error)
   end subroutine build_nodes

   !> Ids that stand twice or are not positive
   subroutine report_bad_nodes(deck, blocks, rows, draft, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:)
      type(rows_t), intent(in) :: rows(:)
      type(draft_t), intent(in) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer :: i, k, at

      do i = 1, draft%n_node
         if (draft%node%id(i) <= 0) then
            call locate(draft%node%place(i), k, at)
            call report_row(deck, blocks(k), rows(k), at, 'id', SEV_ERROR, 'KJ-9144', &
               'a node has the id '//str(draft%node%id(i)), 'expected: a positive id', findings)
         else if (i > 1) then
            if (draft%node%id(i) /= draft%node%id(i - 1)) cycle
            call locate(draft%node%place(i), k, at)
            call report_row(deck, blocks(k), rows(k), at, 'id', SEV_ERROR, 'KJ-0056', &
               'node '//str(draft%node%id(i))//' is defined twice', 'used before', findings)
         end if
      end do
   contains
      !> Block and row of a node
      subroutine locate(place, block, row)
         integer, intent(in) :: place
         integer, intent(out) :: block, row

         row = place
         do block = 1, size(rows)
            if (row <= rows(block)%n) return
            row = row - rows(block)%n
         end do
      end subroutine locate
   end subroutine report_bad_nodes

   !> Added masses of nodes: /ADMAS types 0 (on each), 1 (shared), 5 (node by node)
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
         if (deck%block(blocks(i))%variant == 5) then
            call add_mass_rows(deck, blocks(i), draft, findings)
            cycle
         end if
         call read_cards(deck, blocks(i), cards, findings)
         call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0668', .true., findings, nodes)
         mass = real_of(cards, 'mass')
         if (mass < 0.0_wp) call report(deck, cards, 'mass', SEV_WARNING, 'KJ-0476', &
            'the added mass is negative', 'less than zero', findings)
         if (deck%block(blocks(i))%variant == 1) mass = mass/real(max(1, size(nodes)), wp)
         draft%mass(nodes) = draft%mass(nodes) + mass
      end do
   end subroutine build_masses

   subroutine add_mass_rows(deck, block, draft, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      type(rows_t) :: rows
      integer :: i, raw

      call read_rows(deck, block, rows, findings)
      do i = 1, rows%n
         raw = find(draft%node, rows%ints(i, 1))
         if (raw > 0) draft%mass(raw) = draft%mass(raw) + rows%reals(i, 1)
         if (raw == 0) call report_row(deck, block, rows, i, 'node_id', SEV_ERROR, 'KJ-0871', &
            'node '//str(rows%ints(i, 1))//' is not defined', 'no such node', findings)
         if (rows%reals(i, 1) < 0.0_wp) call report_row(deck, block, rows, i, 'mass', SEV_WARNING, &
            'KJ-0476', 'the added mass is negative', 'less than zero', findings)
      end do
   end subroutine add_mass_rows

   !> /FUNCT, and /MOVE_FUNCT on them in deck order
   subroutine build_curves(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:)
      type(rows_t), allocatable :: rows(:)
      integer :: i, n

      blocks = blocks_of(deck, KW_FUNCT)
      call block_lookup(deck, blocks, draft%curve)
      call report_double_blocks(deck, blocks, 'function', findings)
      allocate (rows(size(blocks)))
      do i = 1, size(blocks)
         call read_rows(deck, blocks(i), rows(i), findings)
         call check_points(deck, blocks(i), rows(i), findings)
      end do
      associate (c => draft%curves)
         c%n = size(blocks)
         c%id = deck%block(blocks)%id
         allocate (c%first(c%n + 1), c%x(sum(rows%n)), c%y(sum(rows%n)))
         n = 0
         do i = 1, c%n
            c%first(i) = n + 1
            c%x(n + 1:n + rows(i)%n) = rows(i)%reals(:, 1)
            c%y(n + 1:n + rows(i)%n) = rows(i)%reals(:, 2)
            n = n + rows(i)%n
         end do
         c%first(c%n + 1) = n + 1
      end associate
      call move_curves(deck, draft, findings)
   end subroutine build_curves

   subroutine check_points(deck, block, rows, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(rows_t), intent(in) :: rows
      type(finding_list_t), intent(inout) :: findings

      integer :: k

      do k = 2, rows%n
         if (.not. rows%reals(k, 1) > rows%reals(k - 1, 1)) call report_row(deck, block, rows, k, &
            'x', SEV_ERROR, 'KJ-0156', 'the abscissae of a function must increase', &
            'not above the line before', findings)
      end do
      if (rows%n == 0) then
         call report_header(deck, block, SEV_ERROR, 'KJ-9112', 'the function has no point', &
            'no card follows', findings)
      else if (rows%n == 1) then
         call report_header(deck, block, SEV_WARNING, 'KJ-1874', &
            'the function has a single point', 'one card', findings)
      end if
   end subroutine check_points

   !> x := x Ascale_x + Ashift_x, y := y Fscale_y + Fshift_y; a scale 0 means 1
   subroutine move_curves(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      real(wp) :: scale(2)
      integer :: i, place, first, last
      logical :: rises

      blocks = blocks_of(deck, KW_MOVE_FUNCT)
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         place = find(draft%curve, deck%block(blocks(i))%id)
         if (place == 0) then
            call report_header(deck, blocks(i), SEV_ERROR, 'KJ-9145', 'function '// &
               str(deck%block(blocks(i))%id)//' is not defined', 'no such function', findings, &
               known_ids(draft%curve, 'function'))
            cycle
         end if
         scale = [real_of(cards, 'Ascale_x'), real_of(cards, 'Fscale_y')]
         where (abs(scale) <= 0.0_wp) scale = 1.0_wp
         first = draft%curves%first(place)
         last = draft%curves%first(place + 1) - 1
         associate (x => draft%curves%x(first:last), y => draft%curves%y(first:last))
            rises = all(x(2:) > x(:size(x) - 1))
            x = x*scale(1) + real_of(cards, 'Ashift_x')
            y = y*scale(2) + real_of(cards, 'Fshift_y')
            if (scale(1) < 0.0_wp) then
               x = x(size(x):1:-1)
               y = y(size(y):1:-1)
            end if
            if (rises .and. any(.not. x(2:) > x(:size(x) - 1))) call report(deck, cards, &
               'Ascale_x', &
               SEV_ERROR, &
               'KJ-9146', 'the function has equal abscissae after the move', &
               'scale or shift too extreme', findings)
         end associate
      end do
   end subroutine move_curves

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
         if (.not. is_given(cards, 'Tstop') .or. real_of(cards, 'Tstop') <= 0.0_wp) cycle
         draft%sensors(i)%t_stop = max(real_of(cards, 'Tstop'), real_of(cards, 'Tdelay'))
         if (real_of(cards, 'Tstop') < real_of(cards, 'Tdelay')) call report(deck, cards, 'Tstop', &
            SEV_WARNING, 'KJ-9147', 'the sensor stops before it starts', 'taken as its start', &
            findings)
      end do
   end subroutine build_sensors

   !> /ANALY must be 3D, /RANDOM must disturb nothing
   subroutine check_analysis(deck, findings)
      type(deck_t), intent(in) :: deck
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      integer :: i

      do i = 1, deck%n_block
         select case (deck%block(i)%keyword)
         case (KW_ANALY)
            call read_cards(deck, i, cards, findings)
            if (int_of(cards, 'N2D3D') /= 0) call report(deck, cards, 'N2D3D', SEV_ERROR, &
               'KJ-9148', 'plane and axisymmetric scenes are not supported', 'expected: 0', &
               findings)
         case (KW_RANDOM)
            call read_cards(deck, i, cards, findings)
            if (abs(real_of(cards, 'Xalea')) > 0.0_wp) call report(deck, cards, 'Xalea', &
               SEV_ERROR, &
               'KJ-9149', 'disturbed coordinates are not supported', 'expected: 0', findings)
         end select
      end do
   end subroutine check_analysis

end module kj_build_scene
