!> Submodels and parameters -> plain blocks: ids become those of the whole deck, names values.
!>
!> Only lines that change are written anew, into a text of their own; each keeps its file, number
!> and columns, so that findings point where the user typed. Source: docs/theory/full.md 3.
module kj_deck_flat
   use kj_error, only: SEV_ERROR
   use kj_keywords, only: keywords, KW_SUBMODEL, KW_PARAMETER, KW_UNIT, KW_UNIT_MASS, &
      KW_UNIT_LENGTH, KW_UNIT_TIME, KW_KJOINT, KW_SPRING8, KW_SPRING13, &
      KW_GRSHEL, KW_GRSH3N, KW_GRBRIC, KW_GRBEAM, KW_GRTRUS, KW_GRSPRI, KW_GRPART, &
      KW_SURF, KW_LINE, HEAD_ID, HEAD_TYPE_ID
   use kj_card_fields, only: EACH, ONCE, ROWS, DOFS, IDS, TRIPLES, CLAUSES, fields
   use kj_deck_text, only: deck_t, source_t, line_text, first_card, id_shift, add_deck_finding, &
      add_source, put_text, kind_word, FLAT
   use kj_card_cut, only: cut_t, cut_card, begins_with_number, MOST_ON_CARD
   use kj_number, only: parse_integer, NUMBER_FINE, integer_field
   use kj_field, only: named_by_field, named_by_header, named_by_clause, OF_NOTHING, OF_NODE, &
      OF_ELEMENT
   use kj_element_cards, only: element_row, element_cards
   use kj_parameter, only: parameters_t, setting_t, read_parameters, replace_names, report_unused
   implicit none
   private

   public :: flatten_deck, ids_on_card

   !> Columns of a card that hold ids
   type, public :: id_columns_t
      integer :: n = 0
      integer :: first(MOST_ON_CARD) = 0, last(MOST_ON_CARD) = 0
      integer :: family(MOST_ON_CARD) = 0       !! OF_ constant, OF_NOTHING = no id
      integer :: field(MOST_ON_CARD) = 0        !! row of the table of fields, 0 = none
   end type id_columns_t

contains

   !> Give every block the ids and values that hold outside of it
   !>
   !> Errors: findings of parameters and offsets
   subroutine flatten_deck(deck, settings)
      type(deck_t), intent(inout), target :: deck
      type(setting_t), intent(in) :: settings(:) !! parameters from outside

      type(parameters_t) :: list
      integer :: block

      call read_parameters(deck, settings, list)
      do block = 1, deck%n_block
         if (deck%block(block)%keyword == KW_SUBMODEL) call read_offsets(deck, block)
         if (deck%block(block)%keyword == KW_PARAMETER) cycle
         if (deck%block(block)%submodel > 0) call move_into_deck(deck, block)
         if (size(list%item) > 0 .or. deck%block(block)%submodel > 0) &
            call rewrite_block(deck, list, block)
      end do
      call report_unused(list)
   end subroutine flatten_deck

   !> The offsets of a submodel, with those around it
   subroutine read_offsets(deck, block)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block

      type(cut_t) :: cut
      character(len=:), allocatable :: text
      integer :: s, i, status, value

      s = findloc(deck%submodel(:deck%n_submodel)%block, block, 1)
      if (s == 0) return
      if (first_card(deck, block) > deck%block(block)%last) return
      text = line_text(deck, first_card(deck, block))
      call cut_card(text, 8, [(10*i - 9, i=1, 8)], [(10*i, i=1, 8)], cut)
      associate (shift => deck%submodel(s)%shift)
         do i = 1, 7
            value = 0
            if (cut%last(i) >= cut%first(i)) then
               call parse_integer(text(cut%first(i):cut%last(i)), value, status)
               if (status /= NUMBER_FINE) call add_deck_finding(deck, first_card(deck, block), &
                  cut%first(i), cut%last(i), SEV_ERROR, 'KJ-9002', &
                  'the offset is not an integer', 'expected: an integer')
            end if
            if (i == 1) shift = value
            if (i > 1 .and. value /= 0) shift(i - 1) = value
         end do
         if (deck%submodel(s)%parent > 0) shift = shift + &
            deck%submodel(deck%submodel(s)%parent)%shift
         deck%submodel(s)%id = deck%block(block)%id
      end associate
   end subroutine read_offsets

   !> Id and unit of the header of a block in a submodel
   subroutine move_into_deck(deck, block)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block

      integer :: family, unit

      associate (b => deck%block(block))
         if (b%row == 0) return
         if (any(keywords(b%row)%head == [HEAD_ID, HEAD_TYPE_ID])) then
            family = named_by_header(b%row, element_row(b%keyword) > 0 .or. &
               is_element(keywords(b%row)%name))
            b%id = b%id + id_shift(deck, b%submodel, family)
         end if
         if (any(b%keyword == [KW_UNIT, KW_UNIT_MASS, KW_UNIT_LENGTH, KW_UNIT_TIME])) return
         unit = unit_of(deck, b%submodel)
         if (b%unit_id == 0) b%unit_id = unit
      end associate
   end subroutine move_into_deck

   !> Unit of a submodel, or of one around it; 0 = none
   pure integer function unit_of(deck, submodel) result(unit)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: submodel

      integer :: s

      unit = 0
      s = submodel
      do while (s > 0 .and. unit == 0)
         unit = deck%block(deck%submodel(s)%block)%unit_id
         s = deck%submodel(s)%parent
      end do
   end function unit_of

   !> Elements that are not read stand under the id of a part, too
   pure logical function is_element(name)
      character(len=*), intent(in) :: name

      is_element = any(name == [character(len=20) :: '/QUAD', '/TRIA', '/RIVET', '/SPHCEL', &
         '/XELEM'])
   end function is_element

   !> Lines with names of parameters, and in submodels those with ids, are written anew
   subroutine rewrite_block(deck, list, block)
      type(deck_t), intent(inout) :: deck
      type(parameters_t), intent(inout) :: list
      integer, intent(in) :: block

      character(len=:), allocatable :: text
      integer :: line, s
      logical :: named, shifted

      do line = first_card(deck, block), deck%block(block)%last
         s = deck%line_source(line)
         named = index(deck%source(s)%text(deck%line_first(line):deck%line_last(line)), '&') > 0
         shifted = deck%block(block)%submodel > 0
         if (.not. (named .or. shifted)) cycle
         text = line_text(deck, line)
         if (named) call replace_names(list, line, text)
         if (shifted) call shift_ids(deck, block, line, text)
         if (text /= line_text(deck, line) .or. named) call put_line(deck, line, text)
      end do
   end subroutine rewrite_block

   !> Add the offsets of the submodel to the ids of a card
   subroutine shift_ids(deck, block, line, text)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block, line
      character(len=:), allocatable, intent(inout) :: text

      type(id_columns_t) :: columns
      type(cut_t) :: cut
      integer :: i, value, status, shift, moved
      character(len=10) :: new

      call ids_on_card(deck, block, line, text, columns)
      if (columns%n == 0) return
      call cut_card(text, columns%n, columns%first(:columns%n), columns%last(:columns%n), cut)
      moved = 0
      do i = 1, columns%n
         if (columns%family(i) == OF_NOTHING .or. cut%last(i) < cut%first(i)) cycle
         shift = id_shift(deck, deck%block(block)%submodel, columns%family(i))
         call parse_integer(text(cut%first(i) + moved:cut%last(i) + moved), value, status)
         if (status /= NUMBER_FINE .or. value == 0 .or. shift == 0) cycle
         new = integer_field(sign(abs(value) + shift, value))
         if (cut%free) then
            text = text(:cut%first(i) + moved - 1)//trim(adjustl(new))// &
               text(cut%last(i) + moved + 1:)
            moved = moved + len_trim(adjustl(new)) - (cut%last(i) - cut%first(i) + 1)
         else
            if (len(text) < columns%last(i)) text = text//repeat(' ', columns%last(i) - len(text))
            text(columns%first(i):columns%last(i)) = new
         end if
      end do
   end subroutine shift_ids

   !> The columns of a card with ids, and what the ids name
   subroutine ids_on_card(deck, block, line, text, columns)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, line
      character(len=*), intent(in) :: text       !! of the line
      type(id_columns_t), intent(out) :: columns

      integer :: row, card, k

      card = line - first_card(deck, block) + 1
      associate (b => deck%block(block))
         k = b%keyword
         if (k == 0) return
         row = element_row(k)
         if (row > 0 .and. deck%field_last(k) < deck%field_first(k)) then
            call element_columns(element_cards(row)%ints, card, columns)
         else if (any(k == [KW_GRSHEL, KW_GRSH3N, KW_GRBRIC, KW_GRBEAM, KW_GRTRUS, KW_GRSPRI, &
            KW_GRPART, KW_SURF, KW_LINE])) then
            call list_columns(trim(kind_word(deck, block)), columns)
         else if (deck%field_last(k) >= deck%field_first(k)) then
            call table_columns(deck, block, card, text, columns)
         else
            call list_columns('', columns)       ! /SUBSET
         end if
      end associate
   end subroutine ids_on_card

   !> The id of an element and its nodes, on card number `card` of a block
   pure subroutine element_columns(ints, card, columns)
      integer, intent(in) :: ints(3), card
      type(id_columns_t), intent(inout) :: columns

      integer :: which, i

      which = modulo(card - 1, count(ints > 0)) + 1
      columns%n = ints(which)
      do i = 1, columns%n
         columns%first(i) = 10*i - 9
         columns%last(i) = 10*i
         columns%family(i) = merge(OF_ELEMENT, OF_NODE, which == 1 .and. i == 1)
      end do
   end subroutine element_columns

   !> Ten ids on a card; of segments the first is their own
   pure subroutine list_columns(word, columns)
      character(len=*), intent(in) :: word       !! what they are ids of: PART, SEG, ...
      type(id_columns_t), intent(inout) :: columns

      integer :: i

      columns%n = 10
      do i = 1, 10
         columns%first(i) = 10*i - 9
         columns%last(i) = 10*i
      end do
      columns%family(:10) = named_by_clause(word)
      if (word == 'SEG') columns%family(1) = OF_NOTHING
   end subroutine list_columns

   !> Fields of the table on card number `card` of a block
   pure subroutine table_columns(deck, block, card, text, columns)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, card
      character(len=*), intent(in) :: text
      type(id_columns_t), intent(inout) :: columns

      integer :: i, variant, on_dof
      logical :: here

      associate (b => deck%block(block))
         variant = b%variant
         if (b%keyword == KW_KJOINT) variant = joint_type(line_text(deck, first_card(deck, block)))
         on_dof = modulo(card - 2, 3) + 2
         do i = deck%field_first(b%keyword), deck%field_last(b%keyword)
            if (fields(i)%since > deck%version) cycle
            if (all(fields(i)%variant /= [EACH, variant])) cycle
            select case (fields(i)%times)
            case (ONCE)
               here = fields(i)%card == card
            case (ROWS)
               here = fields(i)%card == 1 .or. begins_with_number(text)
            case (DOFS)
               here = card >= 2 .and. fields(i)%card == on_dof .and. &
                  (all(b%keyword /= [KW_SPRING8, KW_SPRING13]) .or. card < 20)
            case (IDS:TRIPLES)
               if (fields(i)%card == 1 .or. begins_with_number(text)) then
                  call list_columns('', columns)
                  columns%family = named_by_field(fields(i))
               end if
               return
            case (CLAUSES)
               call list_columns('', columns)
               columns%family(1) = OF_NOTHING
               columns%family(2:) = named_by_clause(clause_of(deck, block, card))
               return
            case default
               here = .false.
            end select
            if (.not. here) cycle
            columns%n = columns%n + 1
            columns%first(columns%n) = fields(i)%first
            columns%last(columns%n) = fields(i)%last
            columns%family(columns%n) = named_by_field(fields(i))
            columns%field(columns%n) = i
         end do
      end associate
   end subroutine table_columns

   !> The clause that a card of a /SET belongs to: its own word, or the last one before
   pure function clause_of(deck, block, card) result(word)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, card
      character(len=10) :: word

      integer :: line

      word = ''
      do line = first_card(deck, block) + card - 1, first_card(deck, block), -1
         word = line_text(deck, line)
         if (word /= '') return
      end do
   end function clause_of

   !> Joint type on the first card of a /PROP/KJOINT
   pure integer function joint_type(text)
      character(len=*), intent(in) :: text

      character(len=10) :: field
      integer :: status

      field = text
      if (index(field, ',') > 0) field = field(:index(field, ',') - 1)
      call parse_integer(field, joint_type, status)
   end function joint_type

   !> A line gets a new text, in a source of its own that has the name of the old one
   subroutine put_line(deck, line, text)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line
      character(len=*), intent(in) :: text

      type(source_t) :: source
      integer :: s, old, n

      old = deck%line_source(line)
      s = 0
      do n = 1, deck%n_source
         if (deck%source(n)%role == FLAT .and. deck%source(n)%path == deck%source(old)%path) s = n
      end do
      if (s == 0) then
         source%path = deck%source(old)%path
         source%role = FLAT
         source%text = ''
         call add_source(deck, source, s)
      end if
      n = deck%source(s)%used
      call put_text(text, n, deck%source(s)%text)
      deck%source(s)%used = n + len(text)
      deck%line_source(line) = s
      deck%line_first(line) = n + 1
      deck%line_last(line) = n + len(text)
   end subroutine put_line

end module kj_deck_flat
