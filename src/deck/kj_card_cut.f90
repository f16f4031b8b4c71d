!> Cuts a card into fields, by column, or at commas when the line has one; and reads them, with a
!> finding for everything that is no clean number or stands where nothing is read.
module kj_card_cut
   use kj_kinds, only: wp
   use kj_error, only: SEV_ERROR, SEV_WARNING, str
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE, NUMBER_BLANK, NUMBER_INNER_BLANK, &
      NUMBER_NOT_FINITE, NUMBER_FRACTION, NUMBER_WHOLE_REAL, NUMBER_TOO_LARGE
   use kj_deck_text, only: deck_t, add_deck_finding, line_text, header_end
   implicit none
   private

   public :: cut_t, cut_card, is_blank_text, begins_with_number, &
      read_integer_at, read_real_at, report_cut

   integer, parameter, public :: MOST_ON_CARD = 20   !! more fields than any card has

   !> The fields of one line; a field is blank when last < first
   type :: cut_t
      integer :: first(MOST_ON_CARD) = 1, last(MOST_ON_CARD) = 0   !! columns of the text
      integer :: extra_first = 1, extra_last = 0   !! text after the last field
      integer :: gap_first = 1, gap_last = 0       !! text in columns that belong to no field
      integer :: tab = 0                           !! column of the first tab
      integer :: torn = 0                          !! field whose text goes on in the next one
      logical :: free = .false.                    !! cut at commas
   end type cut_t

   character(len=1), parameter :: TAB = achar(9)

contains

   !> Find the text of n fields, given their columns in ascending order
   pure subroutine cut_card(text, n, first, last, cut)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      integer, intent(in) :: first(n), last(n)
      type(cut_t), intent(out) :: cut

      if (index(text, ',') > 0) then
         cut%free = .true.
         call cut_at_commas(text, n, first, last, cut)
      else
         call cut_at_columns(text, n, first, last, cut)
      end if
   end subroutine cut_card

   !> Fixed format
   pure subroutine cut_at_columns(text, n, first, last, cut)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      integer, intent(in) :: first(n), last(n)
      type(cut_t), intent(inout) :: cut

      integer :: i, next

      cut%tab = index(text, TAB)
      next = 1
      do i = 1, n
         if (first(i) > next) call note_text(text, next, first(i) - 1, cut%gap_first, cut%gap_last)
         call shrink(text, first(i), last(i), cut%first(i), cut%last(i))
         next = last(i) + 1
         if (cut%tab == 0 .or. next > len(text)) cycle
         if (.not. (is_gap(text(next - 1:next - 1)) .or. is_gap(text(next:next)))) cut%torn = i
      end do
      call note_text(text, next, len(text), cut%extra_first, cut%extra_last)
   end subroutine cut_at_columns

   !> Free format: one item a field; unused columns between two fields count as one item;
   !> fields of a few columns share the item of their ten columns, which is read right-justified
   pure subroutine cut_at_commas(text, n, first, last, cut)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      integer, intent(in) :: first(n), last(n)
      type(cut_t), intent(inout) :: cut

      integer :: i, at, next, a, b, cell

      at = 1
      next = 1
      cell = 0
      do i = 1, n
         if (last(i) - first(i) < 9) then
            if ((first(i) - 1)/10 + 1 > cell) call take_item(text, at, a, b)
            cell = (first(i) - 1)/10 + 1
            next = 10*cell + 1
            cut%first(i) = max(a, b - (10*cell - first(i)))
            cut%last(i) = b - (10*cell - last(i))
            if (cut%last(i) >= cut%first(i)) call shrink(text, cut%first(i), cut%last(i), &
               cut%first(i), cut%last(i))
            cycle
         end if
         if (first(i) > next) then
            call take_item(text, at, a, b)
            call note_text(text, a, b, cut%gap_first, cut%gap_last)
         end if
         call take_item(text, at, cut%first(i), cut%last(i))
         next = last(i) + 1
      end do
      call note_text(text, at, len(text), cut%extra_first, cut%extra_last)
   end subroutine cut_at_commas

   !> The next item of a line cut at commas; blank beyond the end
   pure subroutine take_item(text, at, first, last)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: at              !! column where the item begins; then the next
      integer, intent(out) :: first, last

      integer :: n

      first = at
      last = at - 1
      if (at > len(text)) return
      n = index(text(at:), ',')
      if (n == 0) n = len(text) - at + 2
      call shrink(text, at, at + n - 2, first, last)
      at = at + n
   end subroutine take_item

   !> Take the blanks off both ends of columns [a, b]; last < first when nothing is left
   pure subroutine shrink(text, a, b, first, last)
      character(len=*), intent(in) :: text
      integer, value :: a, b
      integer, intent(out) :: first, last

      first = a
      last = min(b, len(text))
      do while (last >= first)
         if (.not. is_gap(text(last:last))) exit
         last = last - 1
      end do
      do while (first < last)
         if (.not. is_gap(text(first:first))) exit
         first = first + 1
      end do
      if (last < first) last = first - 1
   end subroutine shrink

   !> Note the text in columns [a, b], unless there is none or some was noted before; zeros do
   !> not count, for they mean the same as blanks
   pure subroutine note_text(text, a, b, first, last)
      character(len=*), intent(in) :: text
      integer, intent(in) :: a, b
      integer, intent(inout) :: first, last

      integer :: i, j

      if (last >= first) return
      call shrink(text, a, b, i, j)
      if (j < i) return
      if (verify(text(i:j), ' 0.,'//TAB) == 0) return
      first = i
      last = j
   end subroutine note_text

   !> Blank or tab
   pure logical function is_gap(c)
      character(len=1), intent(in) :: c

      is_gap = c == ' ' .or. c == TAB
   end function is_gap

   !> Nothing but blanks and tabs
   pure logical function is_blank_text(text)
      character(len=*), intent(in) :: text

      is_blank_text = verify(text, ' '//TAB) == 0
   end function is_blank_text

   !> The first thing on a card is a number
   pure logical function begins_with_number(text) result(is_number)
      character(len=*), intent(in) :: text

      integer :: i

      i = verify(text, ' +-,'//TAB)
      is_number = .false.
      if (i > 0) is_number = index('0123456789', text(i:i)) > 0
   end function begins_with_number

   !> Integer in columns [first, last] of a line; 0 when they are blank or wrong
   subroutine read_integer_at(deck, line, first, last, name, meaning, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: first, last        !! columns; last < first: blank
      character(len=*), intent(in) :: name, meaning   !! of the field, for the finding
      integer, intent(out) :: value

      integer :: source, offset, status

      value = 0
      if (last < first) return
      source = deck%line_source(line)
      offset = deck%line_first(line) - 1
      call parse_integer(deck%source(source)%text(offset + first:offset + last), value, status)
      if (status == NUMBER_FINE .or. status == NUMBER_BLANK) return
      call report_number(deck, line, first, last, trim(name), trim(meaning), 'an integer', status)
   end subroutine read_integer_at

   !> Real in columns [first, last] of a line, times its unit; 0 when they are blank or wrong
   subroutine read_real_at(deck, line, first, last, name, meaning, factor, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: first, last        !! columns; last < first: blank
      character(len=*), intent(in) :: name, meaning   !! of the field, for the finding
      real(wp), intent(in) :: factor            !! input units / work units
      real(wp), intent(out) :: value

      integer :: source, offset, status

      value = 0.0_wp
      if (last < first) return
      source = deck%line_source(line)
      offset = deck%line_first(line) - 1
      call parse_real(deck%source(source)%text(offset + first:offset + last), value, status)
      value = value*factor
      if (status == NUMBER_FINE .and. .not. abs(value) <= huge(value)) status = NUMBER_NOT_FINITE
      if (status == NUMBER_FINE .or. status == NUMBER_BLANK) return
      value = 0.0_wp
      call report_number(deck, line, first, last, trim(name), trim(meaning), 'a real number', &
         status)
   end subroutine read_real_at

   !> The finding of a field that is no clean number
   subroutine report_number(deck, line, first, last, name, meaning, what, status)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line, first, last, status
      character(len=*), intent(in) :: name, meaning, what

      character(len=:), allocatable :: text, label, hint
      integer :: at

      text = line_text(deck, line)
      label = 'expected: '//meaning
      hint = ''
      if (index(text, ',') > 0) hint = 'a comma makes the line free format: its fields are cut '// &
         'at commas, and a decimal point is a point'
      if (index(text(first:last), '&') > 0) then
         hint = 'define it with /PARAMETER'
         call say(SEV_ERROR, 'KJ-9015', name//' is a parameter that the deck does not define')
         return
      end if
      select case (status)
      case (NUMBER_INNER_BLANK)
         call say(SEV_ERROR, 'KJ-9003', name//' has blanks inside its number')
      case (NUMBER_FRACTION)
         call say(SEV_ERROR, 'KJ-9004', name//' is an integer, but has a fraction')
      case (NUMBER_NOT_FINITE)
         call say(SEV_ERROR, 'KJ-9005', name//' is not a finite number in work units')
      case (NUMBER_TOO_LARGE)
         call say(SEV_ERROR, 'KJ-9006', name//' is larger than '//str(huge(status)))
      case (NUMBER_WHOLE_REAL)
         call say(SEV_WARNING, 'KJ-9013', name//' is an integer, but written as a real number')
      case default
         at = verify(text(first:last), ' 0123456789+-.eEdD')
         if (at > 0) label = label//', not "'//text(first + at - 1:first + at - 1)//'"'
         call say(SEV_ERROR, merge('KJ-9001', 'KJ-9002', what == 'a real number'), &
            name//' is not '//what)
      end select

   contains

      subroutine say(severity, id, message)
         integer, intent(in) :: severity
         character(len=*), intent(in) :: id, message

         call add_deck_finding(deck, line, first, last, severity, id, message, label, hint)
      end subroutine say
   end subroutine report_number

   !> Findings of text that belongs to no field, and of tabs
   subroutine report_cut(deck, line, cut)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! index in deck
      type(cut_t), intent(in) :: cut            !! the card

      if (cut%torn > 0) then
         call add_deck_finding(deck, line, cut%tab, header_end(deck, line), SEV_ERROR, 'KJ-9008', &
            'a tab moves a number over the border of its field', 'a tab counts as one column', &
            'replace tabs by blanks')
         return
      end if
      if (cut%tab > 0) then
         call add_deck_finding(deck, line, cut%tab, cut%tab, SEV_WARNING, 'KJ-9007', &
            'the card has a tab', 'a tab counts as one column', 'replace tabs by blanks')
      end if
      if (cut%gap_last >= cut%gap_first) then
         call add_deck_finding(deck, line, cut%gap_first, cut%gap_last, SEV_WARNING, 'KJ-9010', &
            'text in columns that belong to no field', 'ignored')
      end if
      if (cut%extra_last >= cut%extra_first) then
         call add_deck_finding(deck, line, cut%extra_first, cut%extra_last, SEV_WARNING, &
            'KJ-9009', 'text after the last field', 'ignored')
      end if
   end subroutine report_cut

end module kj_card_cut
