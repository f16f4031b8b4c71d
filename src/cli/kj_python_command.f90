!> `kjoint plot`, `animate`, `report`, `sweep`, `fit`: options in, and a program of the Python
!> package takes over.
module kj_python_command
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_option, only: arguments_t, option_t, option, stem_of, FIRST_RUN, N_OPTION, OPT_INPUT, &
      OPT_OUTPUT
   use kj_text, only: text_t, append_text
   use kj_output, only: settle_output
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   implicit none
   private

   public :: python_command, run_python, add_words

   integer, parameter :: NO_PYTHON = 127

   interface
      integer(c_int) function kj_run_python(words, n, become) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: words(*)
         integer(c_int), value :: n, become
      end function kj_run_python
   end interface

contains

   !> Become a module of the package, with the operands, the options of the command, and those of a
   !> run as `--run NAME=VALUE`
   !>
   !> Errors: ERR_INPUT when the output is an input, a device or a folder; ERR_FILE when there is no
   !> Python.
   subroutine python_command(args, module, suffix, code, error)
      type(arguments_t), intent(in) :: args
      character(len=*), intent(in) :: module
      character(len=*), intent(in) :: suffix     !! of the output when none is named; empty: none
      integer, intent(out) :: code
      type(error_t), allocatable, intent(out) :: error

      type(text_t), allocatable :: words(:)
      character(len=:), allocatable :: path, place
      type(option_t) :: o
      integer :: i

      code = 0
      call add_words(words, module)
      path = ''
      if (len(suffix) > 0) path = stem_of(args%operand(1)%s)//suffix
      if (args%given(OPT_OUTPUT)) path = args%value(OPT_OUTPUT)%s
      if (len(path) > 0) then
         call settle_output(path, args%operand(:args%n_operand), place, error)
         if (allocated(error)) return
         call add_words(words, '--output='//path)
      end if
      do i = 1, N_OPTION
         if (.not. args%given(i) .or. any(i == [OPT_INPUT, OPT_OUTPUT])) cycle
         o = option(i)
         if (i > FIRST_RUN) then
            call add_words(words, '--run', trim(o%name(3:))//'='//args%value(i)%s)
         else if (o%value == '') then
            call add_words(words, trim(o%name))
         else
            call add_each(trim(o%name), args%value(i)%s, words)
         end if
      end do
      call add_words(words, '--')                ! what follows may begin with -
      do i = 1, args%n_operand
         call add_words(words, args%operand(i)%s)
      end do
      call run_python(words, .true., code, error)
   end subroutine python_command

   !> An option with each of the values that it was given
   subroutine add_each(name, values, words)
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: values     !! a line each
      type(text_t), allocatable, intent(inout) :: words(:)

      integer :: first, last

      first = 1
      do while (first <= len(values))
         last = index(values(first:)//new_line(''), new_line('')) + first - 2
         call add_words(words, name//'='//values(first:last))
         first = last + 2
      end do
   end subroutine add_each

   !> Run `python3 -m kjoint.WORD1 WORD2 ...` and wait for it, or become it; it has said what went
   !> wrong
   !>
   !> Errors: ERR_FILE when there is no Python.
   subroutine run_python(words, become, code, error)
      type(text_t), intent(in) :: words(:)
      logical, intent(in) :: become              !! signals and exit code are those of the program
      integer, intent(out) :: code               !! exit code of the program
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: all_words
      integer :: i

      all_words = ''
      do i = 1, size(words)
         all_words = all_words//words(i)%s//c_null_char
      end do
      code = int(kj_run_python(all_words, int(size(words), c_int), merge(1_c_int, 0_c_int, become)))
      if (code /= NO_PYTHON) return
      call fail(error, ERR_FILE, 'there is no Python 3, which this needs')
      error%hint = 'install python3, or name one by the environment variable KJOINT_PYTHON'
   end subroutine run_python

   !> Append a word, and another one where it is there
   subroutine add_words(words, one, other)
      type(text_t), allocatable, intent(inout) :: words(:)
      character(len=*), intent(in) :: one
      character(len=*), intent(in), optional :: other

      if (.not. allocated(words)) allocate (words(0))
      call append_text(words, one)
      if (present(other)) call append_text(words, other)
   end subroutine add_words

end module kj_python_command
