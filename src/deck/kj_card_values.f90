!> Values of fields, with a finding for everything that is no clean number or stands where
!> nothing is read.
module kj_card_values
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING, str
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE, NUMBER_BLANK, NUMBER_INNER_BLANK, &
      NUMBER_NOT_FINITE, NUMBER_FRACTION, NUMBER_WHOLE_REAL, NUMBER_TOO_LARGE
   use kj_deck_text, only: deck_t, add_deck_finding, line_text, header_end
   use kj_card_cut, only: cut_t
   implicit none
   private

   public :: read_integer_at, read_real_at, report_cut

contains

   !> Integer in columns [first, last] of a line; 0 when they are blank or wrong
   subroutine read_integer_at(deck, line, first, last, name, meaning, value, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: first, last        !! columns; last < first: blank
      character(len=*), intent(in) :: name, meaning   !! of the field, for the finding
      integer, intent(out) :: value
      type(finding_list_t), intent(inout) :: findings

      integer :: source, offset, status

      value = 0
      if (last < first) return
      source = deck%line_source(line)
      offset = deck%line_first(line) - 1
      call parse_integer(deck%source(source)%text(offset + first:offset + last), value, status)
      if (status == NUMBER_FINE .or. status == NUMBER_BLANK) return
      call report_number(deck, line, first, last, trim(name), trim(meaning), 'an integer', status, &
         findings)
   end subroutine read_integer_at

   !> Real in columns [first, last] of a line, times its unit; 0 when they are blank or wrong
   subroutine read_real_at(deck, line, first, last, name, meaning, factor, value, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: first, last        !! columns; last < first: blank
      character(len=*), intent(in) :: name, meaning   !! of the field, for the finding
      real(wp), intent(in) :: factor            !! input units / work units
      real(wp), intent(out) :: value
      type(finding_list_t), intent(inout) :: findings

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
         status, findings)
   end subroutine read_real_at

   !> The finding of a field that is no clean number
   subroutine report_number(deck, line, first, last, name, meaning, what, status, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line, first, last, status
      character(len=*), intent(in) :: name, meaning, what
      type(finding_list_t), intent(inout) :: findings

      character(len=:), allocatable :: text, label, hint
      integer :: at

      text = line_text(deck, line)
      label = 'expected: '//meaning
      hint = ''
      if (index(text, ',') > 0) hint = 'a comma makes the line free format: its fields are cut '// &
         'at commas, and a decimal point is a point'
      if (text(first:first) == '&') then
         call say(SEV_ERROR, 'KJ-9015', name//' is a parameter, and parameters are not supported')
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

         call add_deck_finding(deck, line, first, last, severity, id, message, label, findings, &
            hint)
      end subroutine say
   end subroutine report_number

   !> Findings of text that belongs to no field, and of tabs
   subroutine report_cut(deck, line, cut, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index in deck
      type(cut_t), intent(in) :: cut            !! the card
      type(finding_list_t), intent(inout) :: findings

      if (cut%torn > 0) then
         call add_deck_finding(deck, line, cut%tab, header_end(deck, line), SEV_ERROR, 'KJ-9008', &
            'a tab moves a number over the border of its field', 'a tab counts as one column', &
            findings, 'replace tabs by blanks')
         return
      end if
      if (cut%tab > 0) then
         call add_deck_finding(deck, line, cut%tab, cut%tab, SEV_WARNING, 'KJ-9007', &
            'the card has a tab', 'a tab counts as one column', findings, 'replace tabs by blanks')
      end if
      if (cut%gap_last >= cut%gap_first) then
         call add_deck_finding(deck, line, cut%gap_first, cut%gap_last, SEV_WARNING, 'KJ-9010', &
            'text in columns that belong to no field', 'ignored', findings)
      end if
      if (cut%extra_last >= cut%extra_first) then
         call add_deck_finding(deck, line, cut%extra_first, cut%extra_last, SEV_WARNING, &
            'KJ-9009', 'text after the last field', 'ignored', findings)
      end if
   end subroutine report_cut

end module kj_card_values
