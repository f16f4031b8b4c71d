!> `kjoint plot`, `animate` and `report`: options in, and a program of the Python package draws.
module kj_show_command
   use kj_error, only: error_t
   use kj_option, only: arguments_t, OPT_OUTPUT, OPT_UNITS, OPT_COLOUR, OPT_AT, OPT_SECONDS
   use kj_python, only: run_python, add_words
   use kj_text, only: text_t
   use kj_output, only: settle_output
   implicit none
   private

   public :: plot_command, animate_command, report_command

contains

   !> Draw channels; operands that are files are histories, the others name channels
   !>
   !> Errors: of find_output; ERR_FILE when there is no Python.
   subroutine plot_command(args, code, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code
      type(error_t), allocatable, intent(out) :: error

      type(text_t), allocatable :: words(:)
      character(len=:), allocatable :: output
      integer :: i

      call add_words(words, 'plot')
      call find_output(args, '.png', output, code, error)
      if (allocated(error)) return
      call add_words(words, '--output', output)
      call add_option(args, OPT_UNITS, '--units', words)
      do i = 1, args%n_operand
         if (is_history(args%operand(i)%s) .or. i == 1) then
            call add_words(words, '--run', args%operand(i)%s)
         else
            call add_words(words, '--channel', args%operand(i)%s)
         end if
      end do
      call run_python(words, .false., code, error)
   end subroutine plot_command

   !> Draw the mechanism. Errors: ERR_FILE when there is no Python
   subroutine animate_command(args, code, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code
      type(error_t), allocatable, intent(out) :: error

      type(text_t), allocatable :: words(:)
      character(len=:), allocatable :: output

      call add_words(words, 'animate', args%operand(1)%s)
      call find_output(args, '.mp4', output, code, error)
      if (allocated(error)) return
      call add_words(words, '--output', output)
      call add_option(args, OPT_COLOUR, '--colour', words)
      call add_option(args, OPT_AT, '--at', words)
      call add_option(args, OPT_SECONDS, '--seconds', words)
      call run_python(words, .false., code, error)
   end subroutine animate_command

   !> Write the page. Errors: ERR_FILE when there is no Python
   subroutine report_command(args, code, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code
      type(error_t), allocatable, intent(out) :: error

      type(text_t), allocatable :: words(:)
      character(len=:), allocatable :: output

      call add_words(words, 'report', args%operand(1)%s)
      call find_output(args, '.html', output, code, error)
      if (allocated(error)) return
      call add_words(words, '--output', output)
      if (args%n_operand == 2) call add_words(words, '--reference', args%operand(2)%s)
      call run_python(words, .false., code, error)
   end subroutine report_command

   subroutine add_option(args, option, name, words)
      type(arguments_t), intent(in) :: args
      integer, intent(in) :: option              !! OPT_ constant
      character(len=*), intent(in) :: name
      type(text_t), allocatable, intent(inout) :: words(:)

      if (args%given(option)) call add_words(words, name, args%value(option)%s)
   end subroutine add_option

   !> -o, else the name of the history, in the current folder, with another suffix
   !>
   !> Errors: ERR_INPUT when it is an input, a device or a folder
   subroutine find_output(args, suffix, path, code, error)
      type(arguments_t), intent(in) :: args
      character(len=*), intent(in) :: suffix
      character(len=:), allocatable, intent(out) :: path
      integer, intent(out) :: code               !! 0
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: place

      code = 0
      path = args%operand(1)%s(index(args%operand(1)%s, '/', back=.true.) + 1:)
      if (index(path, '.', back=.true.) > 1) path = path(:index(path, '.', back=.true.) - 1)
      path = path//suffix
      if (args%given(OPT_OUTPUT)) path = args%value(OPT_OUTPUT)%s
      call settle_output(path, args%operand(:args%n_operand), place, error)
   end subroutine find_output

   !> A file of this name is there, or the name is one of a history
   logical function is_history(name)
      character(len=*), intent(in) :: name

      inquire (file=name, exist=is_history)
      if (len(name) > 3) is_history = is_history .or. name(len(name) - 2:) == '.h5'
   end function is_history

end module kj_show_command
