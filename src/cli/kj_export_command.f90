!> `kjoint export`: series of a history for other programs.
module kj_export_command
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_words, only: buffer_t
   use kj_output, only: settle_output, write_output
   use kj_export, only: export_csv, export_json
   use kj_write_t01, only: write_t01
   use kj_text, only: text_t
   use kj_python_command, only: run_python, add_words
   use kj_option, only: arguments_t, OPT_OUTPUT, OPT_TO, OPT_SEPARATOR, OPT_DECIMAL, OPT_TFILE
   use kj_terminal, only: print_line, print_text
   implicit none
   private

   public :: export_command, channel_names

contains

   !> Write a history as --to or the name of the output says
   !>
   !> Errors: ERR_INPUT for a wrong option or a name that means no channel, ERR_FILE for files that
   !> cannot be read or written.
   subroutine export_command(args, code, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code               !! exit code where there is no error
      type(error_t), allocatable, intent(out) :: error

      type(buffer_t) :: text
      type(text_t), allocatable :: words(:)
      character(len=:), allocatable :: output, place, form
      character :: separator, decimal
      integer :: tfile

      code = 0
      output = '-'
      if (args%given(OPT_OUTPUT)) output = args%value(OPT_OUTPUT)%s
      form = form_of(output)
      if (args%given(OPT_TO)) form = args%value(OPT_TO)%s
      call take_csv_options(args, form, separator, decimal, error)
      if (.not. allocated(error)) call take_tfile(args, form, tfile, error)
      if (allocated(error)) return
      select case (form)
      case ('csv')
         call export_csv(args%operand(1)%s, channel_names(args, 2), separator, decimal, text, error)
      case ('json')
         call export_json(args%operand(1)%s, channel_names(args, 2), text, error)
      case ('t01')
         if (output == '-') then
            call fail(error, ERR_INPUT, 'a T01 needs a file to be written to: -o RUNT01')
         else if (args%n_operand > 1) then
            call fail(error, ERR_INPUT, 'a T01 holds all channels that it can; name none')
         else
            call write_t01(args%operand(1)%s, output, tfile, error)
         end if
      case ('vtkhdf', 'pvd')
         if (output == '-' .or. args%n_operand > 1) then
            call fail(error, ERR_INPUT, &
               'ParaView gets the whole mechanism, in a file: -o RUN.'//form)
         else
            call settle_output(output, args%operand(:1), place, error)
            if (allocated(error)) return
            call add_words(words, 'vtk')
            call add_words(words, '--to', form)
            call add_words(words, '--output='//output)
            call add_words(words, '--', args%operand(1)%s)
            call run_python(words, .false., code, error)
         end if
         return
      case default
         call fail(error, ERR_INPUT, 'what to write is not known from "'//form//'"')
         error%hint = '--to csv, json, t01, vtkhdf or pvd; or -o FILE.csv, RUNT01, RUN.vtkhdf ...'
      end select
      if (allocated(error)) return
      if (form /= 't01' .and. output == '-') then
         call print_text(text%s(:text%n))
         return
      end if
      if (form /= 't01') call write_output(output, text%s(:text%n), args%operand(:1), error)
      if (.not. allocated(error)) call print_line(output)
   end subroutine export_command

   !> The operands from `first` on with blanks between them, as kj_series takes them
   pure function channel_names(args, first) result(names)
      type(arguments_t), intent(in) :: args
      integer, intent(in) :: first
      character(len=:), allocatable :: names

      integer :: i

      names = ''
      do i = first, args%n_operand
         names = names//' '//args%operand(i)%s
      end do
   end function channel_names

   !> Format by the name of the output: what is behind the last point, t01 where it ends in T01,
   !> T02..
   pure function form_of(output) result(form)
      character(len=*), intent(in) :: output
      character(len=:), allocatable :: form

      integer :: n, dot

      n = len(output)
      dot = index(output, '.', back=.true.)
      form = output(dot + 1:)
      if (dot <= index(output, '/', back=.true.)) form = output
      if (output == '-') form = 'csv'
      if (n < 3) return
      if (output(n - 2:n - 2) == 'T' .and. verify(output(n - 1:), '0123456789') == 0) form = 't01'
   end function form_of

   subroutine take_csv_options(args, form, separator, decimal, error)
      type(arguments_t), intent(in) :: args
      character(len=*), intent(in) :: form
      character, intent(out) :: separator, decimal
      type(error_t), allocatable, intent(out) :: error

      separator = ','
      decimal = '.'
      if (args%given(OPT_DECIMAL)) then
         decimal = args%value(OPT_DECIMAL)%s(1:1)
         if (len(args%value(OPT_DECIMAL)%s) /= 1 .or. scan(decimal, '.,') == 0) &
            call fail(error, ERR_INPUT, '--decimal is . or ,')
         if (decimal == ',') separator = ';'
      end if
      if (args%given(OPT_SEPARATOR)) then
         separator = args%value(OPT_SEPARATOR)%s(1:1)
         if (args%value(OPT_SEPARATOR)%s == 'tab') then
            separator = achar(9)
         else if (len(args%value(OPT_SEPARATOR)%s) /= 1 .or. scan(separator, '"0123456789+-eE') > &
            0) then
            call fail(error, ERR_INPUT, '--separator is one character or `tab`')
         end if
      end if
      if (separator == decimal .and. .not. allocated(error)) &
         call fail(error, ERR_INPUT, '--separator and --decimal are the same character')
      if (form /= 'csv' .and. (args%given(OPT_DECIMAL) .or. args%given(OPT_SEPARATOR))) &
         call fail(error, ERR_INPUT, '--separator and --decimal are for csv')
   end subroutine take_csv_options

   subroutine take_tfile(args, form, tfile, error)
      type(arguments_t), intent(in) :: args
      character(len=*), intent(in) :: form
      integer, intent(out) :: tfile              !! 0: not given
      type(error_t), allocatable, intent(out) :: error

      tfile = 0
      if (.not. args%given(OPT_TFILE)) return
      if (args%value(OPT_TFILE)%s == '1') tfile = 1
      if (args%value(OPT_TFILE)%s == '4') tfile = 4
      if (tfile == 0) call fail(error, ERR_INPUT, '--tfile is 1 or 4')
      if (form /= 't01') call fail(error, ERR_INPUT, '--tfile is for t01')
   end subroutine take_tfile

end module kj_export_command
