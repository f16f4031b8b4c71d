!> Cards -> typed values, each with its place: cards that stand once in a block as named values,
!> cards that repeat to its end (nodes, springs, points, masses) as arrays.
!>
!> A clean row takes the fast path: each field is parsed where it stands in the file. All other
!> lines (commas, tabs, wrong numbers, text beyond the fields) are cut and judged with care.
!> One file: cards that stand once and cards that repeat share cutting, judging and places.
module kj_cards
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: SEV_WARNING, SEV_ERROR
   use kj_units, only: dimensions
   use kj_keywords, only: keywords, KW_KJOINT, KW_KJOINT2, KW_SPRING8, KW_SPRING13
   use kj_card_fields, only: EACH, ONCE, DOFS, ROWS, fields, list_free_dofs, rotational
   use kj_joint_types, only: DOF_NAME, NDOF, find_joint_type
   use kj_deck_text, only: deck_t, add_deck_finding, block_factors, header_end, report_line, &
      first_card, line_text, id_shift
   use kj_field, only: OF_NODE
   use kj_element_cards, only: card_walk_t, start_walk, next_card
   use kj_card_cut, only: cut_t, cut_card, is_blank_text, MOST_ON_CARD, read_integer_at, &
      read_real_at, report_cut
   use kj_spelling, only: upper
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE, NUMBER_BLANK, NUMBER_NOT_FINITE
   implicit none
   private

   public :: cards_t, read_cards, put_real, real_of, int_of, text_of, is_given, report, &
      report_cut_deck, rows_t, card_row_t, read_rows, row_of, look_at, &
      report_row

   integer, parameter, public :: MOST_FIELDS = 160   !! more than any keyword has

   !> Values of one block, in the order of the cards
   type :: cards_t
      integer :: block = 0                      !! index in deck
      integer :: n = 0
      integer :: n_card = 0                     !! cards in the block, title not counted
      integer :: n_whole = 0                    !! cards that it has when all are there
      character(len=12) :: name(MOST_FIELDS) = ''
      integer :: integer_value(MOST_FIELDS) = 0
      logical :: is_real(MOST_FIELDS) = .false.
      real(wp) :: real_value(MOST_FIELDS) = 0.0_wp   !! in work units
      character(len=20) :: text_value(MOST_FIELDS) = ''
      integer :: line(MOST_FIELDS) = 0          !! index in deck; 0 when the card is missing
      integer :: first(MOST_FIELDS) = 1         !! columns of the text, or of the blank field
      integer :: last(MOST_FIELDS) = 1
      logical :: given(MOST_FIELDS) = .false.   !! not blank
   end type cards_t

   !> Values of the rows of some blocks, block after block
   type :: rows_t
      integer :: n = 0                          !! number of rows
      integer, allocatable :: from(:)           !! (blocks + 1) first row of each block
      !> (n) indices in deck; of a row that stays in the file the number of the line before it
      integer, allocatable :: block(:), line(:)
      integer(int64), allocatable :: at(:)      !! (n) and bytes of the file before it
      integer, allocatable :: ints(:, :)        !! (n, n_int) integer fields in table order
      real(wp), allocatable :: reals(:, :)      !! (n, n_real) real fields, in work units
   end type rows_t

   !> One row: its integers, and where it stands
   type :: card_row_t
      integer :: block = 0, line = 0            !! indices in deck
      integer :: ints(8) = 0                    !! no card has more
   end type card_row_t

   !> The fields of a row
   type :: row_layout_t
      integer :: n = 0
      integer :: row(MOST_ON_CARD) = 0          !! in the table of fields
      integer :: first(MOST_ON_CARD) = 0, last(MOST_ON_CARD) = 0   !! columns
      integer :: kind(MOST_ON_CARD) = 0         !! 1 integer, 2 real, 3 text
      integer :: place(MOST_ON_CARD) = 0        !! column of `ints` or `reals`
      real(wp) :: factor(MOST_ON_CARD) = 1.0_wp
      integer :: n_int = 0, n_real = 0
      integer :: dense = 0                      !! columns 1 to dense are covered by fields
   end type row_layout_t

contains

   !> Read all cards of a block that stand once
   !>
   !> Goes on after a wrong field: it reads as 0, and a finding tells of it.
   subroutine read_cards(deck, block, cards)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(cards_t), intent(inout) :: cards

      integer :: keyword, n_read, joint_type, n_dof, dof(NDOF)
      real(wp) :: factor(size(dimensions))

      cards%block = block
      cards%n = 0
      associate (b => deck%block(block))
         keyword = b%keyword
         cards%n_card = b%last - b%first + 1
         if (b%row > 0) then
            if (keywords(b%row)%titled) cards%n_card = cards%n_card - 1
         end if
         factor = block_factors(deck, block)
         n_read = 0
         call read_variant(deck, factor, EACH, cards, n_read)
         joint_type = int_of(cards, 'type')
         if (keyword == KW_KJOINT) call read_variant(deck, factor, joint_type, cards, n_read)
         if (keyword /= KW_KJOINT) call read_variant(deck, factor, b%variant, cards, n_read)
         if (any(keyword == [KW_KJOINT2, KW_SPRING8, KW_SPRING13])) then
            call list_free_dofs(keyword, joint_type, n_dof, dof)
            call read_dofs(deck, factor, n_dof, dof, cards, n_read)
         end if
         if (any(keyword == [KW_KJOINT, KW_KJOINT2])) then
            if (find_joint_type(joint_type) == 0) n_read = huge(n_read)   ! not known
         end if
      end associate
      if (n_read > 0 .and. n_read < huge(n_read)) call report_length(deck, cards, n_read)
      cards%n_whole = n_read
   end subroutine read_cards

   !> A deck without /END whose last block lacks cards, or the end of its last line, was cut
   subroutine report_cut_deck(deck, cards)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards        !! of any block

      character(len=:), allocatable :: name

      if (deck%whole .or. cards%block /= deck%n_block) return
      if (cards%n_card >= cards%n_whole .and. .not. deck%torn) return
      name = trim(keywords(deck%block(cards%block)%row)%name)
      call report_line(deck, max(deck%block(cards%block)%header, deck%block(cards%block)%last), &
         SEV_ERROR, 'KJ-9070', &
         'the deck ends in the middle of '//name, 'the last line, and no /END', &
         'complete the block and write /END behind it')
   end subroutine report_cut_deck

   !> Read the cards of one variant
   subroutine read_variant(deck, factor, variant, cards, n_read)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: factor(:)         !! one per D_ constant
      integer, intent(in) :: variant            !! of the table of fields
      type(cards_t), intent(inout) :: cards
      integer, intent(inout) :: n_read          !! number of the last card with fields

      integer :: i, n, card, row(MOST_ON_CARD)

      n = 0
      card = 0
      associate (k => deck%block(cards%block)%keyword)
         if (k < 1) return
         do i = deck%field_first(k), deck%field_last(k)
            if (fields(i)%times /= ONCE .or. fields(i)%variant /= variant) cycle
            if (fields(i)%since > deck%version) cycle
            if (fields(i)%card /= card) then
               call read_card(deck, factor, card, n, row, '', cards)
               card = fields(i)%card
               n_read = max(n_read, card)
               n = 0
            end if
            n = n + 1
            row(n) = i
         end do
      end associate
      call read_card(deck, factor, card, n, row, '', cards)
   end subroutine read_variant

   !> Read the groups of cards that stand once for each direction
   subroutine read_dofs(deck, factor, n_dof, dof, cards, n_read)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: n_dof, dof(NDOF)      !! the directions
      type(cards_t), intent(inout) :: cards
      integer, intent(inout) :: n_read

      integer :: d, card, i, n, row(MOST_ON_CARD)

      associate (k => deck%block(cards%block)%keyword)
         do d = 1, n_dof
            do card = 2, 4
               n = 0
               do i = deck%field_first(k), deck%field_last(k)
                  if (fields(i)%times /= DOFS .or. fields(i)%card /= card) cycle
                  if (fields(i)%since > deck%version) cycle
                  n = n + 1
                  row(n) = i
               end do
               call read_card(deck, factor, 3*(d - 1) + card, n, row, DOF_NAME(dof(d)), cards)
            end do
         end do
         n_read = max(n_read, 1 + 3*n_dof)
      end associate
   end subroutine read_dofs

   !> Read n fields of one card; a missing card reads as blank
   subroutine read_card(deck, factor, card, n, row, dof, cards)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: card               !! number in the block, title not counted
      integer, intent(in) :: n
      integer, intent(in) :: row(:)             !! (>= n) rows of the table of fields
      character(len=*), intent(in) :: dof       !! direction, '' when the card has none
      type(cards_t), intent(inout) :: cards

      type(cut_t) :: cut
      integer :: i, line, source, first(MOST_ON_CARD), last(MOST_ON_CARD)

      if (n == 0) return
      line = 0
      if (card <= cards%n_card) line = deck%block(cards%block)%last - cards%n_card + card
      if (line > 0) then
         source = deck%line_source(line)
         first(:n) = fields(row(:n))%first
         last(:n) = fields(row(:n))%last
         call cut_card(deck%source(source)%text(deck%line_first(line):deck%line_last(line)), n, &
            first(:n), last(:n), cut)
         call report_cut(deck, line, cut)
      end if
      do i = 1, n
         call add_value(deck, factor, line, row(i), dof, cut%first(i), cut%last(i), cards)
      end do
   end subroutine read_card

   !> Append one field to the values of the block
   subroutine add_value(deck, factor, line, row, dof, first, last, cards)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: line, row, first, last
      character(len=*), intent(in) :: dof
      type(cards_t), intent(inout) :: cards

      integer :: k, dim, source, offset

      k = cards%n + 1
      cards%n = k
      cards%name(k) = fields(row)%name
      if (dof /= '') cards%name(k) = trim(fields(row)%name)//'_'//dof
      cards%line(k) = line
      cards%given(k) = last >= first
      cards%first(k) = merge(first, fields(row)%first, cards%given(k))
      cards%last(k) = merge(last, fields(row)%last, cards%given(k))
      cards%is_real(k) = fields(row)%kind == 'r'
      cards%integer_value(k) = 0
      cards%real_value(k) = 0.0_wp
      cards%text_value(k) = ''
      if (.not. cards%given(k)) return
      select case (fields(row)%kind)
      case ('i')
         call read_integer_at(deck, line, first, last, cards%name(k), fields(row)%meaning, &
            cards%integer_value(k))
      case ('r')
         dim = fields(row)%dim
         if (len(dof) > 0) then
            if (dof(1:1) == 'r') dim = rotational(dim)
         end if
         call read_real_at(deck, line, first, last, cards%name(k), fields(row)%meaning, &
            factor(dim), cards%real_value(k))
      case default
         offset = deck%line_first(line) - 1
         source = deck%line_source(line)
         cards%text_value(k) = deck%source(source)%text(offset + first:offset + last)
      end select
   end subroutine add_value

   !> Findings of a block with too many cards, and of one whose title seems to be a card
   subroutine report_length(deck, cards, n_read)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: n_read

      integer :: line, first, last

      associate (b => deck%block(cards%block))
         do line = b%last - cards%n_card + n_read + 1, b%last
            first = deck%line_first(line)
            last = deck%line_last(line)
            if (is_blank_text(deck%source(deck%line_source(line))%text(first:last))) cycle
            call report_line(deck, line, SEV_WARNING, 'KJ-9011', &
               'more cards than '//trim(keywords(b%row)%name)//' has', 'ignored')
            exit
         end do
         if (cards%n_card > 0 .or. b%last < b%first .or. .not. keywords(b%row)%titled) return
         call report_line(deck, b%first, SEV_WARNING, 'KJ-9016', trim(keywords(b%row)%name)// &
            ' has no cards', 'taken as the title', 'the line after the header is always the title')
      end associate
   end subroutine report_length

   !> Index of a field by its name; 0 when the layout has no such field
   pure integer function find(cards, name) result(k)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      do k = 1, cards%n
         if (cards%name(k) == name) return
      end do
      k = 0
   end function find

   !> Real field in work units; 0 when it is blank, or not in the layout of this block
   pure real(wp) function real_of(cards, name) result(value)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      value = 0.0_wp
      k = find(cards, name)
      if (k > 0) value = cards%real_value(k)
   end function real_of

   !> Another value of a real field, in work units; found: the layout of this block has it
   pure subroutine put_real(cards, name, value, found)
      type(cards_t), intent(inout) :: cards
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      logical, intent(out) :: found

      integer :: k

      do k = 1, cards%n
         if (cards%is_real(k) .and. upper(cards%name(k)) == upper(name)) exit
      end do
      found = k <= cards%n
      if (.not. found) return
      cards%real_value(k) = value
      cards%given(k) = .true.
   end subroutine put_real

   !> Integer field; 0 when it is blank, or not in the layout of this block
   pure integer function int_of(cards, name) result(value)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      value = 0
      k = find(cards, name)
      if (k > 0) value = cards%integer_value(k)
   end function int_of

   !> Characters in a text field
   pure integer function text_length(cards, name) result(n)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      n = 0
      k = find(cards, name)
      if (k > 0) n = len_trim(cards%text_value(k))
   end function text_length

   !> Text field without the blanks around it; '' when it is blank, or not in the layout
   pure function text_of(cards, name) result(text)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name
      character(len=text_length(cards, name)) :: text

      integer :: k

      text = ''
      k = find(cards, name)
      if (k > 0) text = cards%text_value(k)
   end function text_of

   !> The field is in the layout of this block and not blank
   pure logical function is_given(cards, name) result(given)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      given = .false.
      k = find(cards, name)
      if (k > 0) given = cards%given(k)
   end function is_given

   !> Append a finding that points at a field, or at the header when its card is missing
   subroutine report(deck, cards, name, severity, id, message, label, hint)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name      !! of the field
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      integer :: k, line, first, last

      k = find(cards, name)
      line = 0
      if (k > 0) line = cards%line(k)
      if (line > 0) then
         first = cards%first(k)
         last = cards%last(k)
      else
         line = deck%block(cards%block)%header
         first = 1
         last = header_end(deck, line)
      end if
      call add_deck_finding(deck, line, first, last, severity, id, message, label, hint)
   end subroutine report

   !> Read all rows of some blocks of one keyword
   !>
   !> Goes on after a wrong field: it reads as 0, and a finding tells of it.
   subroutine read_rows(deck, blocks, rows)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: blocks(:)          !! indices, 1 to n_block
      type(rows_t), intent(out) :: rows

      type(row_layout_t) :: layout
      type(card_walk_t) :: walk
      integer :: b, i, source, shift
      logical :: clean, there

      layout%n_int = MOST_ON_CARD
      layout%n_real = MOST_ON_CARD
      allocate (rows%from(size(blocks) + 1), source=1)
      do b = 1, size(blocks)
         rows%from(b + 1) = rows%from(b) + max(deck%block(blocks(b))%n_far, &
            deck%block(blocks(b))%last - first_card(deck, blocks(b)) + 1)
         call lay_out(deck, blocks(b), layout)
      end do
      rows%n = rows%from(size(rows%from)) - 1
      allocate (rows%ints(rows%n, layout%n_int), rows%reals(rows%n, layout%n_real), &
         rows%block(rows%n), rows%line(rows%n))
      if (any(deck%block(blocks)%n_far > 0)) then
         allocate (rows%at(rows%n))
         rows%ints = 0
         rows%reals = 0.0_wp
      end if
      do b = 1, size(blocks)
         call lay_out(deck, blocks(b), layout)
         call start_walk(deck, blocks(b), walk)
         do i = rows%from(b), rows%from(b + 1) - 1
            if (allocated(rows%at)) rows%at(i) = walk%at
            rows%block(i) = blocks(b)
            rows%line(i) = walk%number
            call next_card(deck, walk, 1, there)
            if (.not. there) exit                ! the file changed
            if (deck%block(blocks(b))%n_far == 0) rows%line(i) = walk%line
            source = deck%line_source(walk%line)
            call read_clean_row( &
               deck%source(source)%text(deck%line_first(walk%line):deck%line_last(walk%line)), &
               layout, rows%n, i, rows%ints, rows%reals, clean)
            if (.not. clean) call read_odd_row(deck, layout, walk%line, i, rows)
         end do
         if (deck%block(blocks(b))%n_far == 0) cycle
         shift = id_shift(deck, deck%block(blocks(b))%submodel, OF_NODE)
         do i = rows%from(b), rows%from(b + 1) - 1   ! of nodes; those in lines are shifted there
            if (rows%ints(i, 1) /= 0) rows%ints(i, 1) = sign(abs(rows%ints(i, 1)) + shift, &
               rows%ints(i, 1))
         end do
      end do
   end subroutine read_rows

   !> Row i by itself, for a finding that points at it before the next one is looked at
   subroutine look_at(deck, rows, i, row)
      type(deck_t), intent(inout) :: deck
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: i                  !! 1 to rows%n
      type(card_row_t), intent(out) :: row

      type(card_walk_t) :: walk
      logical :: there

      row = row_of(rows, i)
      if (deck%block(row%block)%n_far == 0) return
      call start_walk(deck, row%block, walk)
      walk%at = rows%at(i)
      walk%number = row%line
      call next_card(deck, walk, 1, there)
      row%line = walk%line
   end subroutine look_at

   !> Collect the fields of a row of this block
   subroutine lay_out(deck, block, layout)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(row_layout_t), intent(out) :: layout

      integer :: i, n
      real(wp) :: factor(size(dimensions))

      factor = block_factors(deck, block)
      associate (b => deck%block(block))
         if (b%keyword < 1) return
         do i = deck%field_first(b%keyword), deck%field_last(b%keyword)
            if (fields(i)%times /= ROWS .or. fields(i)%since > deck%version) cycle
            if (fields(i)%variant /= EACH .and. fields(i)%variant /= b%variant) cycle
            n = layout%n + 1
            layout%n = n
            layout%row(n) = i
            layout%first(n) = fields(i)%first
            layout%last(n) = fields(i)%last
            layout%factor(n) = factor(fields(i)%dim)
            if (fields(i)%first == layout%dense + 1) layout%dense = fields(i)%last
            layout%kind(n) = index('ira', fields(i)%kind)
            if (layout%kind(n) == 1) layout%n_int = layout%n_int + 1
            if (layout%kind(n) == 2) layout%n_real = layout%n_real + 1
            layout%place(n) = merge(layout%n_int, layout%n_real, layout%kind(n) == 1)
         end do
      end associate
   end subroutine lay_out

   !> Read a row of which nothing is odd; clean = .false. when something is
   pure subroutine read_clean_row(text, layout, n, i, ints, reals, clean)
      character(len=*), intent(in) :: text
      type(row_layout_t), intent(in) :: layout
      integer, intent(in) :: n, i               !! number of rows, this row
      integer, intent(inout) :: ints(n, *)
      real(wp), intent(inout) :: reals(n, *)
      logical, intent(out) :: clean

      integer :: k, width, last, status
      real(wp) :: value

      width = len_trim(text)
      clean = width > 0 .and. width <= layout%dense
      do k = 1, layout%n
         if (.not. clean) return
         last = min(layout%last(k), width)
         select case (layout%kind(k))
         case (1)
            call parse_integer(text(layout%first(k):last), ints(i, layout%place(k)), status)
         case (2)
            call parse_real(text(layout%first(k):last), value, status)
            value = value*layout%factor(k)
            if (.not. abs(value) <= huge(value)) status = NUMBER_NOT_FINITE
            reals(i, layout%place(k)) = value
         case default
            cycle
         end select
         clean = status == NUMBER_FINE .or. status == NUMBER_BLANK
      end do
   end subroutine read_clean_row

   !> Read any row, with findings
   subroutine read_odd_row(deck, layout, line, i, rows)
      type(deck_t), intent(inout) :: deck
      type(row_layout_t), intent(in) :: layout
      integer, intent(in) :: line, i            !! index in deck, row
      type(rows_t), intent(inout) :: rows

      type(cut_t) :: cut
      character(len=:), allocatable :: text
      integer :: k

      text = line_text(deck, line)
      call cut_card(text, layout%n, layout%first(:layout%n), layout%last(:layout%n), cut)
      call report_cut(deck, line, cut)
      if (is_blank_text(text)) call add_deck_finding(deck, line, 1, max(1, len(text)), &
         SEV_WARNING, 'KJ-9014', 'a blank line is a card of zeros', 'remove it')
      do k = 1, layout%n
         associate (f => fields(layout%row(k)))
            select case (layout%kind(k))
            case (1)
               call read_integer_at(deck, line, cut%first(k), cut%last(k), f%name, f%meaning, &
                  rows%ints(i, layout%place(k)))
            case (2)
               call read_real_at(deck, line, cut%first(k), cut%last(k), f%name, f%meaning, &
                  layout%factor(k), rows%reals(i, layout%place(k)))
            end select
         end associate
      end do
   end subroutine read_odd_row

   !> Row i by itself
   pure type(card_row_t) function row_of(rows, i) result(row)
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: i                  !! 1 to rows%n

      row%block = rows%block(i)
      row%line = rows%line(i)
      row%ints(:size(rows%ints, 2)) = rows%ints(i, :)
   end function row_of

   !> Append a finding that points at a field of a row
   subroutine report_row(deck, row, name, severity, id, message, label, hint)
      type(deck_t), intent(inout) :: deck
      type(card_row_t), intent(in) :: row
      character(len=*), intent(in) :: name      !! of the field
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      type(row_layout_t) :: layout
      type(cut_t) :: cut
      character(len=:), allocatable :: text
      integer :: k, first, last

      call lay_out(deck, row%block, layout)
      text = line_text(deck, row%line)
      call cut_card(text, layout%n, layout%first(:layout%n), layout%last(:layout%n), cut)
      first = 1
      last = max(1, len_trim(text))
      do k = 1, layout%n
         if (fields(layout%row(k))%name /= name) cycle
         first = merge(cut%first(k), layout%first(k), cut%last(k) >= cut%first(k))
         last = merge(cut%last(k), layout%last(k), cut%last(k) >= cut%first(k))
      end do
      call add_deck_finding(deck, row%line, first, last, severity, id, message, label, hint)
   end subroutine report_row

end module kj_cards
