!> Findings as people read them: severity, id, message, place, the card with carets, what to do.
module kj_render
   use kj_error, only: error_t, finding_list_t, str, SEV_NOTE, SEVERITY_NAME
   use kj_words, only: right
   use kj_option, only: arguments_t, OPT_QUIET, OPT_VERBOSE
   use kj_terminal, only: print_error, may_colour, STDERR, ESC
   implicit none
   private

   public :: render, print_findings, print_failure

   integer, parameter :: MOST_SHOWN = 20         !! of one severity
   character(len=2), parameter :: COLOUR(3) = ['36', '33', '31']
   character, parameter :: NL = new_line('a')

contains

   !> Print findings on stderr: errors and warnings (up to 20 of each), and notes, which are a line
   !> each unless -v is given, and nothing under -q
   subroutine print_findings(args, findings)
      type(arguments_t), intent(in) :: args
      type(finding_list_t), intent(in) :: findings

      logical :: colours, verbose, quiet
      integer :: shown(3), n_note, i, k

      colours = may_colour(STDERR)
      verbose = args%given(OPT_VERBOSE)
      quiet = args%given(OPT_QUIET)
      shown = 0
      n_note = 0
      do i = 1, findings%n
         k = findings%item(i)%severity
         if (k == SEV_NOTE) n_note = n_note + 1
         if (k == SEV_NOTE .and. quiet) cycle
         shown(k) = shown(k) + 1
         if (shown(k) > MOST_SHOWN) cycle
         if (k == SEV_NOTE .and. .not. verbose) then
            call print_error(in_one_line(findings%item(i), colours))
         else
            call print_error(render(findings%item(i), colours))
         end if
      end do
      call print_more(findings%n_error, 'error')
      call print_more(findings%n_warning, 'warning')
      if (.not. quiet) call print_more(n_note, 'note')
   end subroutine print_findings

   subroutine print_more(n, what)
      integer, intent(in) :: n
      character(len=*), intent(in) :: what

      character(len=:), allocatable :: plural

      if (n <= MOST_SHOWN) return
      plural = merge('s', ' ', n - MOST_SHOWN > 1)
      call print_error('and '//str(n - MOST_SHOWN)//' more '//what//trim(plural))
   end subroutine print_more

   !> Print an error on stderr, where there is one
   subroutine print_failure(error)
      type(error_t), allocatable, intent(in) :: error

      if (allocated(error)) call print_error(render(error, may_colour(STDERR)))
   end subroutine print_failure

   !> A finding as text of several lines, without the last line end
   !>
   !>   error[KJ-9001]: Kn is not a real number
   !>      --> bogie.rad:114:23-28
   !>       |
   !>   114 |          2            1.0e+O                 10.0
   !>       |                       ^^^^^^ expected: penalty of blocked dofs, 0 = automatic
   !>       = write a number such as 1.0e+9
   function render(finding, colours) result(text)
      type(error_t), intent(in) :: finding
      logical, intent(in) :: colours             !! with the colours of a terminal
      character(len=:), allocatable :: text

      character(len=:), allocatable :: number, margin

      text = head(finding, colours)
      number = '   '
      if (finding%line > 0) number = right(str(finding%line), 3)
      margin = repeat(' ', len(number))
      if (allocated(finding%file)) text = text//NL//margin//'--> '//place(finding)
      if (allocated(finding%text) .and. finding%line > 0) then
         text = text//NL//margin//' |'//NL//number//' | '//printable(finding%text)
         if (finding%first > 0) text = text//NL//margin//' | '//carets(finding, colours)
      else if (allocated(finding%label)) then
         if (len(finding%label) > 0) text = text//NL//margin//' = '//finding%label
      end if
      if (allocated(finding%hint)) then
         if (len(finding%hint) > 0) text = text//NL//margin//' = '//finding%hint
      end if
   end function render

   !> A finding as one line
   function in_one_line(finding, colours) result(text)
      type(error_t), intent(in) :: finding
      logical, intent(in) :: colours
      character(len=:), allocatable :: text

      text = head(finding, colours)
      if (allocated(finding%file)) text = text//' ('//place(finding)//')'
   end function in_one_line

   function head(finding, colours) result(text)
      type(error_t), intent(in) :: finding
      logical, intent(in) :: colours
      character(len=:), allocatable :: text

      integer :: k

      k = finding%severity
      text = trim(SEVERITY_NAME(k))
      if (finding%id /= '') text = text//'['//trim(finding%id)//']'
      text = paint(text//':', '1;'//COLOUR(k), colours)//' '
      if (allocated(finding%message)) text = text//printable(finding%message)
   end function head

   !> file, file:line, file:line:column or file:line:first-last
   pure function place(finding) result(text)
      type(error_t), intent(in) :: finding
      character(len=:), allocatable :: text

      text = finding%file
      if (finding%line == 0) return
      text = text//':'//str(finding%line)
      if (finding%first == 0) return
      text = text//':'//str(finding%first)
      if (finding%last > finding%first) text = text//'-'//str(finding%last)
   end function place

   !> The line below the card: blanks, carets under first to last, label
   function carets(finding, colours) result(text)
      type(error_t), intent(in) :: finding
      logical, intent(in) :: colours
      character(len=:), allocatable :: text

      integer :: before, below

      before = min(finding%first, len(finding%text) + 1)    ! of a long card the end is cut
      below = max(1, width(finding%text, before, min(finding%last, len(finding%text))))
      before = width(finding%text, 1, before - 1)
      text = repeat('^', below)
      if (allocated(finding%label)) text = trim(text//' '//finding%label)
      text = repeat(' ', before)//paint(text, '1;'//COLOUR(finding%severity), colours)
   end function carets

   !> Places on the screen that the bytes first to last of a text take
   pure integer function width(text, first, last)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last

      integer :: i

      width = max(0, last - first + 1)
      do i = first, min(last, len(text))
         if (iand(iachar(text(i:i)), 192) == 128) width = width - 1     ! UTF-8, not a first byte
      end do
   end function width

   !> The text with a blank for each control character, tabs among them
   pure function printable(text)
      character(len=*), intent(in) :: text
      character(len=len_trim(text)) :: printable

      integer :: i

      printable = text
      do i = 1, len(printable)
         if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) printable(i:i) = ' '
      end do
   end function printable

   pure function paint(text, code, colours) result(painted)
      character(len=*), intent(in) :: text, code
      logical, intent(in) :: colours
      character(len=:), allocatable :: painted

      painted = text
      if (colours) painted = ESC//'['//code//'m'//text//ESC//'[0m'
   end function paint

end module kj_render
