!> `kjoint diff` and `kjoint convert`: options in, answer out.
module kj_diff_command
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_channels, only: CH_TIME
   use kj_text, only: text_t
   use kj_python_command, only: run_python, add_words
   use kj_metrics, only: find_metrics
   use kj_diff, only: compare_histories, diff_options_t, diff_result_t, set_window, diff_text, &
      diff_json, diff_junit
   use kj_reader, only: convert_t01
   use kj_output, only: settle_output, write_output
   use kj_sink_h5, only: sink_h5_t
   use kj_option, only: arguments_t, option_real, OPT_OUTPUT, OPT_JSON, OPT_PROFILE, OPT_INTERP, &
      OPT_WINDOW, OPT_PLOT, OPT_CHANNELS, OPT_METRICS, OPT_JUNIT, OPT_RTOL, OPT_STRICT
   use kj_json_writer, only: json_member
   use kj_terminal, only: print_text
   implicit none
   private

   public :: diff_command, convert_command

   integer, parameter :: MOST_DRAWN = 6          !! channels in the picture of a difference

contains

   !> Compare two histories; the answer goes to stdout
   !>
   !> Errors: ERR_INPUT for a wrong option, ERR_FILE for files that cannot be read or written.
   subroutine diff_command(args, code, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code                  !! 0 same, 1 different
      type(error_t), allocatable, intent(out) :: error

      type(diff_options_t) :: options
      type(diff_result_t) :: result
      character(len=:), allocatable :: text

      code = 0
      call take_options(args, options, error)
      if (allocated(error)) return
      call compare_histories(args%operand(1)%s, args%operand(2)%s, options, result, error)
      if (allocated(error)) return
      code = result%code
      if (args%given(OPT_JUNIT)) then
         call diff_junit(result, text)
         call write_output(args%value(OPT_JUNIT)%s, text, args%operand(:2), error)
         if (allocated(error)) return
      end if
      if (args%given(OPT_JSON)) then
         call diff_json(result, text)
      else
         call diff_text(result, options, text)
      end if
      call print_text(text)
      if (args%given(OPT_PLOT)) call plot_worst(args, result, error)
   end subroutine diff_command

   !> Draw the channels that differ most, worst first; at most six
   !>
   !> Errors: ERR_FILE when that fails
   subroutine plot_worst(args, result, error)
      type(arguments_t), intent(in) :: args
      type(diff_result_t), intent(in) :: result
      type(error_t), allocatable, intent(out) :: error

      type(text_t), allocatable :: words(:)
      character(len=:), allocatable :: place
      integer :: i, n, code

      call settle_output(args%value(OPT_PLOT)%s, args%operand(:2), place, error)
      if (allocated(error)) return
      call add_words(words, 'plot')
      call add_words(words, '--output='//args%value(OPT_PLOT)%s, '--')
      call add_words(words, args%operand(1)%s, args%operand(2)%s)
      n = 0
      do i = 1, result%n_worst
         associate (c => result%channel(result%worst(i)))
            if (c%channel == CH_TIME .or. c%run_at == 0) cycle
            call add_words(words, c%name)
         end associate
         n = n + 1
         if (n == MOST_DRAWN) exit
      end do
      if (n == 0) call add_words(words, 'internal_energy')
      call run_python(words, .false., code, error)
      if (code /= 0 .and. .not. allocated(error)) call fail(error, ERR_FILE, &
         args%value(OPT_PLOT)%s//' was not drawn')
   end subroutine plot_worst

   !> Options of the command line as the library takes them
   subroutine take_options(args, options, error)
      type(arguments_t), intent(in) :: args
      type(diff_options_t), intent(out) :: options
      type(error_t), allocatable, intent(out) :: error

      options%interpolate = args%given(OPT_INTERP)
      options%strict = args%given(OPT_STRICT)
      if (args%given(OPT_PROFILE)) options%profile = args%value(OPT_PROFILE)%s
      call option_real(args, OPT_RTOL, 0.0_wp, options%rtol, error)
      if (args%given(OPT_WINDOW) .and. .not. allocated(error)) &
         call set_window(args%value(OPT_WINDOW)%s, options, error)
      if (args%given(OPT_CHANNELS)) options%channels = args%value(OPT_CHANNELS)%s
      if (args%given(OPT_METRICS) .and. .not. allocated(error)) &
         call find_metrics(args%value(OPT_METRICS)%s, options%metrics, error)
   end subroutine take_options

   !> Turn a Radioss T01 into a history
   !>
   !> Errors: ERR_FILE when the T01 cannot be read or the history not be written.
   subroutine convert_command(args, command_line, error)
      type(arguments_t), intent(in) :: args
      character(len=*), intent(in) :: command_line
      type(error_t), allocatable, intent(out) :: error

      type(sink_h5_t) :: sink

      sink%path = args%operand(1)%s(index(args%operand(1)%s, '/', back=.true.) + 1:)//'.h5'
      if (args%given(OPT_OUTPUT)) sink%path = args%value(OPT_OUTPUT)%s
      sink%inputs = args%operand(:1)
      sink%command_line = command_line
      call convert_t01(args%operand(1)%s, sink, error)
      if (allocated(error)) return
      if (args%given(OPT_JSON)) then
         call print_text('{'//json_member('exit_code', 0)//', '// &
            json_member('t01', args%operand(1)%s)//', '//json_member('history', sink%path)//'}')
      else
         call print_text(sink%path)
      end if
   end subroutine convert_command

end module kj_diff_command
