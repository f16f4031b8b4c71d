!> Cards -> draft: nodes, parts and their elements, added masses, functions, sensors; and what the
!> deck says of its analysis.
module kj_build_scene
   use kj_kinds, only: wp
   use kj_error, only: fail, add_finding, error_t, str, SEV_ERROR, SEV_WARNING, ERR_INPUT
   use kj_sort, only: new_lookup, find, lookup_t
   use kj_keywords, only: KW_NODE, KW_ADMAS, KW_FUNCT, KW_MOVE_FUNCT, KW_SENSOR_TIME, KW_ANALY, &
      KW_RANDOM, KW_PART, KW_RBODY, KW_SPRING, KW_KJOINT, KW_KJOINT2, KW_SPRING4, KW_SPRING8, &
      KW_SPRING13, KW_MAT_VOID, &
      keywords
   use kj_deck_text, only: deck_t, report_header, first_card, line_text
   use kj_card_cut, only: cut_t, cut_card
   use kj_number, only: parse_integer, NUMBER_FINE, NUMBER_BLANK
   use kj_cards, only: cards_t, rows_t, read_cards, read_rows, real_of, int_of, is_given, report, &
      report_row, row_of, card_row_t, look_at
   use kj_draft, only: draft_t, blocks_of, index_blocks, group_nodes, known_ids, find_blocks, &
      reference, unsupported
   implicit none
   private

   public :: build_nodes, build_parts, build_masses, build_curves, build_sensors, check_analysis

contains

   !> Nodes of all /NODE blocks; ids that stand twice or are not positive are reported. A node with
   !> the id 0, which nothing can name, gets a negative one
   subroutine build_nodes(draft)
      type(draft_t), intent(inout) :: draft

      type(rows_t) :: rows
      type(card_row_t) :: row
      type(error_t), allocatable :: error
      integer :: i, n

      call read_rows(draft%deck, blocks_of(draft%deck, KW_NODE), rows)
      draft%n_node = rows%n
      draft%id = rows%ints(:, 1)
      call move_alloc(rows%reals, draft%x)
      call make_main_nodes(draft)
      n = draft%n_node
      draft%id = [(merge(-i, draft%id(i), draft%id(i) == 0), i=1, n)]
      if (draft%deck%n_submodel > 0) draft%node_submodel = [draft%deck%block(rows%block)%submodel, &
         [(0, i=rows%n + 1, n)]]
      call new_lookup(draft%id, draft%node)
      do i = 1, n
         if (draft%node%place(i) > rows%n) cycle      ! a node that was made
         if (all([0, draft%node%id(max(1, i - 1):i - 1)] < draft%node%id(i))) cycle
         call look_at(draft%deck, rows, draft%node%place(i), row)
         if (row%ints(1) == 0) then
            call report_row(draft%deck, row, 'id', SEV_WARNING, 'KJ-9144', &
               'a node has the id 0: nothing can name it', 'expected: a positive id')
         else if (row%ints(1) < 0) then
            call report_row(draft%deck, row, 'id', SEV_ERROR, 'KJ-9144', 'a node has the id '// &
               str(row%ints(1)), 'expected: a positive id')
         else
            call report_row(draft%deck, row, 'id', SEV_ERROR, 'KJ-0056', 'node '// &
               str(row%ints(1))//' is defined twice', 'used before')
         end if
      end do
      rows = rows_t()
      allocate (draft%mass(n), draft%inertia(n), source=0.0_wp)
      allocate (draft%body(n), draft%main_of(n), draft%new(n), source=0)
      if (n > 0) return
      call fail(error, ERR_INPUT, 'the deck has no node', 'KJ-0003')
      call add_finding(draft%deck%findings, error)
   end subroutine build_nodes

   !> Bodies without a main node get one: at the origin, with ids above all others
   subroutine make_main_nodes(draft)
      type(draft_t), intent(inout) :: draft

      type(cut_t) :: cut
      integer, allocatable :: blocks(:)
      character(len=:), allocatable :: text
      integer :: i, n, most, node, status
      real(wp), allocatable :: x(:, :)

      allocate (draft%made_main(0))
      if (draft%n_node == 0) return
      blocks = blocks_of(draft%deck, KW_RBODY)
      do i = 1, size(blocks)
         if (first_card(draft%deck, blocks(i)) > draft%deck%block(blocks(i))%last) cycle
         text = line_text(draft%deck, first_card(draft%deck, blocks(i)))
         call cut_card(text, 1, [1], [10], cut)
         call parse_integer(text(cut%first(1):cut%last(1)), node, status)
         if (any(status == [NUMBER_FINE, NUMBER_BLANK]) .and. node == 0) &
            draft%made_main = [draft%made_main, blocks(i)]
      end do
      n = size(draft%made_main)
      if (n == 0) return
      most = maxval(draft%id)
      allocate (x(draft%n_node + n, 3), source=0.0_wp)
      x(:draft%n_node, :) = draft%x
      call move_alloc(x, draft%x)
      draft%id = [draft%id, [(most + i, i=1, n)]]
      draft%n_node = draft%n_node + n
   end subroutine make_main_nodes

   !> Added masses of nodes: /ADMAS types 0 (on each), 1 (shared), 5 (node by node)
   subroutine build_masses(draft)
      type(draft_t), intent(inout) :: draft

      integer, allocatable :: blocks(:), nodes(:)
      type(cards_t) :: cards
      real(wp) :: mass
      integer :: i

      blocks = blocks_of(draft%deck, KW_ADMAS)
      do i = 1, size(blocks)
         if (draft%deck%block(blocks(i))%variant == 5) then
            call add_mass_rows(draft, blocks(i))
            cycle
         end if
         if (all(draft%deck%block(blocks(i))%variant /= [0, 1])) cycle   ! of parts
         call read_cards(draft%deck, blocks(i), cards)
         call group_nodes(draft, cards, 'KJ-0668', .true., nodes)
         mass = real_of(cards, 'mass')
         if (mass < 0.0_wp) call report(draft%deck, cards, 'mass', SEV_WARNING, 'KJ-0476', &
            'the added mass is negative', 'less than zero')
         if (draft%deck%block(blocks(i))%variant == 1) mass = mass/real(max(1, size(nodes)), wp)
         draft%mass(nodes) = draft%mass(nodes) + mass
      end do
   end subroutine build_masses

   subroutine add_mass_rows(draft, block)
      integer, intent(in) :: block
      type(draft_t), intent(inout) :: draft

      type(rows_t) :: rows
      integer :: i, raw

      call read_rows(draft%deck, [block], rows)
      do i = 1, rows%n
         raw = find(draft%node, rows%ints(i, 1))
         if (raw > 0) draft%mass(raw) = draft%mass(raw) + rows%reals(i, 1)
         if (raw == 0) call report_row(draft%deck, row_of(rows, i), 'node_id', SEV_ERROR, &
            'KJ-0871', 'node '//str(rows%ints(i, 1))//' is not defined', 'no such node')
         if (rows%reals(i, 1) < 0.0_wp) call report_row(draft%deck, row_of(rows, i), 'mass', &
            SEV_WARNING, 'KJ-0476', 'the added mass is negative', 'less than zero')
      end do
   end subroutine add_mass_rows

   !> /FUNCT, and /MOVE_FUNCT on them in deck order
   subroutine build_curves(draft)
      type(draft_t), intent(inout) :: draft

      integer, allocatable :: blocks(:)
      type(rows_t) :: rows
      integer :: i

      call find_blocks(draft%deck, [KW_FUNCT], 'function', blocks, draft%curve)
      call read_rows(draft%deck, blocks, rows)
      do i = 1, size(blocks)
         call check_points(draft%deck, blocks(i), rows, rows%from(i), rows%from(i + 1) - 1)
      end do
      draft%curves%n = size(blocks)
      draft%curves%id = draft%deck%block(blocks)%id
      draft%curves%first = rows%from
      draft%curves%x = rows%reals(:, 1)
      draft%curves%y = rows%reals(:, 2)
      call move_curves(draft)
   end subroutine build_curves

   !> The points of one function, rows `first` to `last`
   subroutine check_points(deck, block, rows, first, last)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block, first, last
      type(rows_t), intent(in) :: rows

      integer :: k

      do k = first + 1, last
         if (.not. rows%reals(k, 1) > rows%reals(k - 1, 1)) call report_row(deck, row_of(rows, k), &
            'x', SEV_ERROR, 'KJ-0156', 'the abscissae of a function must increase', &
            'not above the line before')
      end do
      if (last < first) then
         call report_header(deck, block, SEV_ERROR, 'KJ-9112', 'the function has no point', &
            'no card follows')
      else if (last == first) then
         call report_header(deck, block, SEV_WARNING, 'KJ-1874', &
            'the function has a single point', 'one card')
      end if
   end subroutine check_points

   !> x := x Ascale_x + Ashift_x, y := y Fscale_y + Fshift_y; a scale 0 means 1
   subroutine move_curves(draft)
      type(draft_t), intent(inout) :: draft

      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      real(wp) :: scale(2)
      integer :: i, place, first, last
      logical :: rises

      blocks = blocks_of(draft%deck, KW_MOVE_FUNCT)
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         place = find(draft%curve, draft%deck%block(blocks(i))%id)
         if (place == 0) then
            call report_header(draft%deck, blocks(i), SEV_ERROR, 'KJ-9145', 'function '// &
               str(draft%deck%block(blocks(i))%id)//' is not defined', 'no such function', &
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
            if (rises .and. any(.not. x(2:) > x(:size(x) - 1))) call report(draft%deck, cards, &
               'Ascale_x', SEV_ERROR, 'KJ-9146', &
               'the function has equal abscissae after the move', 'scale or shift too extreme')
         end associate
      end do
   end subroutine move_curves

   !> /SENSOR/TIME
   subroutine build_sensors(draft)
      type(draft_t), intent(inout) :: draft

      integer, allocatable :: blocks(:)
      type(cards_t) :: cards
      integer :: i

      call find_blocks(draft%deck, [KW_SENSOR_TIME], 'sensor', blocks, draft%sensor)
      allocate (draft%sensors(size(blocks)))
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         draft%sensors(i)%t_start = real_of(cards, 'Tdelay')
         if (.not. is_given(cards, 'Tstop') .or. real_of(cards, 'Tstop') <= 0.0_wp) cycle
         draft%sensors(i)%t_stop = max(real_of(cards, 'Tstop'), real_of(cards, 'Tdelay'))
         if (real_of(cards, 'Tstop') < real_of(cards, 'Tdelay')) call report(draft%deck, cards, &
            'Tstop', SEV_WARNING, 'KJ-9147', 'the sensor stops before it starts', &
            'taken as its start')
      end do
   end subroutine build_sensors

   !> /ANALY must be 3D, /RANDOM must disturb nothing
   subroutine check_analysis(deck)
      type(deck_t), intent(inout) :: deck

      type(cards_t) :: cards
      integer :: i

      do i = 1, deck%n_block
         select case (deck%block(i)%keyword)
         case (KW_ANALY)
            call read_cards(deck, i, cards)
            if (int_of(cards, 'N2D3D') /= 0) call report(deck, cards, 'N2D3D', SEV_ERROR, &
               'KJ-9148', 'plane and axisymmetric scenes are not supported', 'expected: 0')
         case (KW_RANDOM)
            call read_cards(deck, i, cards)
            if (abs(real_of(cards, 'Xalea')) > 0.0_wp) call report(deck, cards, 'Xalea', &
               merge(SEV_WARNING, SEV_ERROR, deck%ignore_random), 'KJ-9149', &
               'disturbed coordinates are not supported', 'expected: 0', hint= &
               'set Xalea to 0 in both programs; --ignore-random runs without the disturbance')
         end select
      end do
   end subroutine check_analysis

   !> Parts and elements; draft%property_block holds the properties of all kinds
   subroutine build_parts(draft)
      type(draft_t), intent(inout) :: draft

      type(lookup_t) :: material
      type(cards_t) :: cards
      integer, allocatable :: materials(:)
      integer :: i, place

      call find_blocks(draft%deck, [KW_KJOINT, KW_KJOINT2, KW_SPRING4, KW_SPRING8, KW_SPRING13], &
         'property', &
         draft%property_block, draft%property)
      materials = blocks_of(draft%deck, KW_MAT_VOID)
      do i = 1, size(materials)   ! their card is optional and used for nothing, but is of numbers
         if (draft%deck%block(materials(i))%last > draft%deck%block(materials(i))%first) &
            call read_cards(draft%deck, materials(i), cards)
      end do
      materials = [materials, other_materials(draft%deck)]
      call new_lookup(draft%deck%block(materials)%id, material)
      call find_blocks(draft%deck, [KW_PART], 'part', draft%part_block, draft%part)
      allocate (draft%part_property(size(draft%part_block)))
      allocate (draft%part_ids(3, size(draft%part_block)))
      do i = 1, size(draft%part_block)
         call read_cards(draft%deck, draft%part_block(i), cards)
         draft%part_ids(:, i) = [int_of(cards, 'prop_id'), int_of(cards, 'mat_id'), &
            int_of(cards, 'subset_id')]
         draft%part_property(i) = find(draft%property, int_of(cards, 'prop_id'))
         if (draft%part_property(i) == 0) then
            if (.not. is_left_out(draft%deck, int_of(cards, 'prop_id'))) &
               draft%part_property(i) = reference(draft%deck, cards, 'prop_id', draft%property, &
               'property', 'KJ-0178')
         end if
         if (int_of(cards, 'prop_id') == 0) call report(draft%deck, cards, 'prop_id', SEV_ERROR, &
            'KJ-0178', 'the part has no property', 'expected: id of a property')
         place = reference(draft%deck, cards, 'mat_id', material, 'material', 'KJ-0179')
      end do
      call read_elements(draft)
      call check_element_parts(draft)
      if (size(draft%part_block) == 0 .and. draft%deck%n_block > 0) call report_header(draft%deck, &
         1, SEV_WARNING, 'KJ-1114', 'the deck has no /PART, so no joint', 'this deck')
   end subroutine build_parts

   !> Elements of a part that is not defined: groups would lack their nodes
   subroutine check_element_parts(draft)
      type(draft_t), intent(inout) :: draft

      integer :: i

      call index_blocks(draft)
      do i = 1, merge(size(draft%shelf), 0, draft%deck%lenient)
         if (draft%shelf(i)%part > 0) cycle
         associate (b => draft%deck%block(draft%shelf(i)%block))
            if (b%keyword == KW_SPRING .or. max(b%n_far, b%last - b%first + 1) == 0) cycle
            call report_header(draft%deck, draft%shelf(i)%block, SEV_ERROR, 'KJ-0402', 'part '// &
               str(b%id)//' of these elements is not defined', 'the id is that of a part', &
               hint=known_ids(draft%part, 'part'))
         end associate
      end do
   end subroutine check_element_parts

   !> The property of this id is out of scope, and that is left out
   pure logical function is_left_out(deck, id)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: id

      is_left_out = deck%lenient
      if (is_left_out) is_left_out = unsupported(deck, 'property', id) > 0
   end function is_left_out

   !> Blocks of materials that --ignore-unsupported let pass
   pure function other_materials(deck) result(list)
      type(deck_t), intent(in) :: deck
      integer, allocatable :: list(:)

      integer :: i
      logical :: is_material(deck%n_block)

      is_material = .false.
      do i = 1, deck%n_block
         if (deck%block(i)%row == 0) cycle
         is_material(i) = keywords(deck%block(i)%row)%name == '/MAT'
      end do
      list = pack([(i, i=1, deck%n_block)], is_material)
   end function other_materials

   !> Cards of all /SPRING blocks, the parts they belong to, and double ids
   subroutine read_elements(draft)
      type(draft_t), intent(inout) :: draft

      type(rows_t) :: rows
      integer, allocatable :: blocks(:)
      integer :: b, i, n, part

      blocks = blocks_of(draft%deck, KW_SPRING)
      call read_rows(draft%deck, blocks, rows)
      n = rows%n
      associate (e => draft%elements)
         e%n = n
         allocate (e%card(n), e%part(n), e%node(2, n))
         do b = 1, size(blocks)
            associate (id => draft%deck%block(blocks(b))%id, first => rows%from(b), &
               last => rows%from(b + 1) - 1)
               part = find(draft%part, id)
               e%part(first:last) = part
               if (part == 0 .and. last >= first) call report_header(draft%deck, blocks(b), &
                  SEV_ERROR, 'KJ-0402', 'part '//str(id)//' of these elements is not defined', &
                  'the id is that of a part', hint=known_ids(draft%part, 'part'))
               if (part > 0 .and. .not. draft%deck%full) then
                  if (is_left_out(draft%deck, draft%part_ids(1, part))) &
                     call report_header(draft%deck, blocks(b), SEV_WARNING, 'KJ-9409', &
                     'the springs of part '//str(id)//' are left out', &
                     'their property is out of scope')
               end if
            end associate
         end do
         do i = 1, n
            e%card(i) = row_of(rows, i)
            e%node(1, i) = find(draft%node, rows%ints(i, 2))
            e%node(2, i) = find(draft%node, rows%ints(i, 3))
         end do
         call new_lookup(rows%ints(:, 1), e%id)
         call new_lookup(e%part, e%of_part)
         do i = 2, n
            if (e%id%id(i) == e%id%id(i - 1)) call report_row(draft%deck, &
               e%card(e%id%place(i)), 'id', SEV_ERROR, 'KJ-0079', &
               'element '//str(e%id%id(i))//' is defined twice', 'used before')
         end do
      end associate
   end subroutine read_elements

end module kj_build_scene
