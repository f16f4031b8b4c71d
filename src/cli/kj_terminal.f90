!> The two streams of the program, what they are connected to, and its end.
module kj_terminal
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char
   use, intrinsic :: iso_fortran_env, only: error_unit
   use kj_error, only: ERR_FILE
   use kj_output, only: why
   implicit none
   private

   public :: open_streams, print_line, print_text, print_error, print_status, &
      is_terminal, columns, may_colour, may_overwrite, environment, quit

   integer, parameter, public :: STDOUT = 1, STDERR = 2    !! streams
   character, parameter, public :: ESC = achar(27)
   integer, parameter :: LEAST_WIDTH = 40      !! columns below which nothing is folded

   interface
      integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_isatty
      subroutine c_exit(code) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: code
      end subroutine c_exit
      ! kj_stdout.c
      subroutine kj_open_streams() bind(c)
      end subroutine kj_open_streams
      subroutine kj_put_line(text, length) bind(c)
         import :: c_char, c_size_t
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: length
      end subroutine kj_put_line
      integer(c_int) function kj_flush() bind(c)
         import :: c_int
      end function kj_flush
      integer(c_int) function kj_columns(stream) bind(c)
         import :: c_int
         integer(c_int), value :: stream
      end function kj_columns
   end interface

contains

   !> Begin the program: a stream that is closed takes no file of ours
   subroutine open_streams()
      call kj_open_streams()
   end subroutine open_streams

   !> A line, or several, on stdout: results. On a terminal that is narrower they are folded, but
   !> for JSON
   subroutine print_line(text)
      character(len=*), intent(in) :: text

      integer :: width, first, last

      width = columns(STDOUT)
      if (width < LEAST_WIDTH .or. len(text) <= width .or. &
         scan(text(:min(1, len(text))), '{[,]') > 0) then
         call kj_put_line(text, len(text, c_size_t))
         return
      end if
      first = 1
      do while (first <= len(text) + 1)
         last = index(text(first:), new_line('a')) + first - 2
         if (last < first - 1) last = len(text)
         call put_folded(text(first:last), width)
         first = last + 2
      end do
   end subroutine print_line

   !> One line, broken at blanks; what follows stands below the start of its last column, or 6 in
   subroutine put_folded(line, width)
      character(len=*), intent(in) :: line
      integer, intent(in) :: width

      integer :: first, last, indent, column

      first = 1
      indent = 0
      do
         last = len_trim(line)
         if (last - first + 1 > width - indent) then
            last = first + width - indent - 1
            column = index(line(first:last + 1), ' ', back=.true.)
            if (column > 1) last = first + column - 2
         end if
         call put(repeat(' ', indent)//line(first:last))
         if (last >= len_trim(line)) return
         if (first == 1) then
            column = index(line(:last), '  ', back=.true.) + 1
            indent = 6
            if (column <= width/2 .and. column > 1) indent = column
         end if
         first = last + 1
         first = first + max(verify(line(first:), ' '), 1) - 1
      end do

   contains

      subroutine put(piece)
         character(len=*), intent(in) :: piece

         call kj_put_line(piece, len(piece, c_size_t))
      end subroutine put
   end subroutine put_folded

   !> Columns of a terminal; 0 where a stream is none, or does not say
   integer function columns(stream)
      integer, intent(in) :: stream              !! STDOUT or STDERR

      columns = int(kj_columns(int(stream, c_int)))
   end function columns

   !> Lines that may already end with a line end, on stdout
   subroutine print_text(text)
      character(len=*), intent(in) :: text

      integer :: last

      last = len(text)
      if (last > 0) then
         if (text(last:) == new_line('a')) last = last - 1
      end if
      call print_line(text(:last))
   end subroutine print_text

   !> A line, or several, on stderr: findings and progress
   subroutine print_error(text)
      character(len=*), intent(in) :: text

      integer(c_int) :: ignored

      ignored = kj_flush()
      write (error_unit, '(a)') text
      flush (error_unit)
   end subroutine print_error

   !> A line on stderr over the last one; an empty text takes that away
   subroutine print_status(text)
      character(len=*), intent(in) :: text

      write (error_unit, '(a)', advance='no') achar(13)//text//ESC//'[K'
      flush (error_unit)
   end subroutine print_status

   !> Whether a person looks at a stream
   logical function is_terminal(stream)
      integer, intent(in) :: stream              !! STDOUT or STDERR

      is_terminal = c_isatty(int(stream, c_int)) /= 0
   end function is_terminal

   !> Whether lines may be written over: a terminal that is not a dumb one
   logical function may_overwrite(stream)
      integer, intent(in) :: stream              !! STDOUT or STDERR

      may_overwrite = is_terminal(stream)
      if (environment('TERM') == 'dumb') may_overwrite = .false.
   end function may_overwrite

   !> Whether colours are welcome on a stream, see no-color.org
   logical function may_colour(stream)
      integer, intent(in) :: stream              !! STDOUT or STDERR

      may_colour = may_overwrite(stream)
      if (environment('NO_COLOR') /= '') may_colour = .false.
   end function may_colour

   !> First 80 characters of a variable of the environment, empty when it is not set
   function environment(name) result(value)
      character(len=*), intent(in) :: name
      character(len=80) :: value

      integer :: status

      call get_environment_variable(name, value, status=status)
      if (status == 1) value = ''
   end function environment

   !> End the program with an exit code; where all went well but the output did not arrive, with
   !> that of a file that cannot be written
   subroutine quit(code)
      integer, intent(in) :: code

      integer(c_int) :: reason, last

      last = int(code, c_int)
      reason = kj_flush()
      if (reason /= 0) call print_error('error: cannot write the output: '//trim(why(reason)))
      if (reason /= 0 .and. code == 0) last = ERR_FILE
      flush (error_unit)
      call c_exit(last)
   end subroutine quit

end module kj_terminal
