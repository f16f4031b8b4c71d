!> The two streams of the program, what they are connected to, and its end.
module kj_terminal
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   use kj_error, only: error_t, fail, ERR_FILE
   implicit none
   private

   public :: print_line, print_text, write_file, print_error, print_status, is_terminal, &
      may_colour, may_overwrite, environment, quit

   integer, parameter, public :: STDOUT = 1, STDERR = 2    !! streams
   character, parameter, public :: ESC = achar(27)

   interface
      integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_isatty
      subroutine c_exit(code) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: code
      end subroutine c_exit
   end interface

contains

   !> A line, or several, on stdout: results
   subroutine print_line(text)
      character(len=*), intent(in) :: text

      write (output_unit, '(a)') text
   end subroutine print_line

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

      flush (output_unit)
      write (error_unit, '(a)') text
      flush (error_unit)
   end subroutine print_error

   !> Write a text to a file
   !>
   !> Errors: ERR_FILE when that fails
   subroutine write_file(path, text, error)
      character(len=*), intent(in) :: path, text
      type(error_t), allocatable, intent(out) :: error

      character(len=200) :: why
      integer :: unit, status

      open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', &
            action='write', iostat=status, iomsg=why)
      if (status == 0) then
         write (unit, iostat=status, iomsg=why) text
         close (unit)
      end if
      if (status /= 0) call fail(error, ERR_FILE, 'cannot write '//path//': '//trim(why))
   end subroutine write_file

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

   !> End the program with an exit code; nothing is printed
   subroutine quit(code)
      integer, intent(in) :: code

      flush (output_unit)
      flush (error_unit)
      call c_exit(int(code, c_int))
   end subroutine quit

end module kj_terminal
