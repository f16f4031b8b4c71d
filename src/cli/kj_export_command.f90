!> `kjoint export`: series of a history for other programs.
!> One file: commands on histories that are there
module kj_export_command
   use kj_error, only: error_t, fail, ERR_INPUT, ERR_FILE, str, ERR_RUN
   use kj_words, only: buffer_t, few, json_member
   use kj_output, only: settle_output, write_output, find_part, is_written
   use kj_export, only: export_csv, export_json
   use kj_write_t01, only: write_t01
   use kj_text, only: text_t, fact
   use kj_python_command, only: run_python, add_words
   use kj_option, only: arguments_t, OPT_OUTPUT, OPT_TO, OPT_SEPARATOR, OPT_DECIMAL, OPT_TFILE, &
      option_real, OPT_JSON, OPT_PROFILE, OPT_INTERP, OPT_WINDOW, OPT_PLOT, OPT_CHANNELS, &
      OPT_METRICS, OPT_JUNIT, OPT_RTOL, OPT_STRICT
   use kj_terminal, only: print_line, print_text, print_status, is_terminal, STDERR
   use kj_kinds, only: wp
   use kj_channels, only: CH_TIME, OF_JOINT, CH_TIME_STEP, CH_OWNER_KIND, CH_OWNER, CH_KE_TRANS, &
      CH_KE_ROT, CH_IE, CH_WORK, CH_ENERGY_ERROR, CH_J_VIOL_T, CH_J_VIOL_R
   use kj_metrics, only: find_metrics
   use kj_diff, only: compare_histories, diff_options_t, diff_result_t, set_window, diff_text, &
      diff_json, diff_junit
   use kj_reader, only: convert_t01, history_reader_t, open_history_file, read_rows, read_facts, &
      close_history_file
   use kj_sink_h5, only: sink_h5_t
   use, intrinsic :: iso_c_binding, only: c_int
   use kj_history, only: history_t, place_of
   use kj_series, only: series_t, find_series, series_value
   use kj_signal, only: watch_signals, caught_signal
   use kj_progress, only: percent
   implicit none
   private

   public :: export_command, diff_command, convert_command, watch_command

   integer, parameter :: MOST_DRAWN = 6          !! channels in the picture of a difference

   integer, parameter :: WIDTH = 40              !! samples in a curve
   integer, parameter :: MOST_FAILURES = 10      !! to open a file that is about to get its name
   integer(c_int), parameter :: POLL = 500000    !! [us] between two looks
   character(len=7), parameter :: OWNER(0:3) = ['none   ', 'node   ', 'body   ', 'joint  ']

   interface
      integer(c_int) function c_usleep(microseconds) bind(c, name='usleep')
         import :: c_int
         integer(c_int), value :: microseconds
      end function c_usleep
   end interface

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
         call export_csv(args%operand(1)%s, channel_names(args), separator, decimal, text, error)
      case ('json')
         call export_json(args%operand(1)%s, channel_names(args), text, error)
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
   pure function channel_names(args) result(names)
      type(arguments_t), intent(in) :: args
      character(len=:), allocatable :: names

      integer :: i

      names = ''
      do i = 2, args%n_operand
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

   !> Follow a run until it ends: a line over the last one on a terminal, else a line whenever there
   !> are new rows.
   !>
   !> Errors: ERR_FILE when there is no such history, ERR_RUN when the run was killed, ERR_INPUT for
   !> a channel that is none
   subroutine watch_command(args, code, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: status, line, shown
      integer :: failures
      integer(c_int) :: ignored
      logical :: written

      code = 0
      failures = 0
      shown = ''
      call watch_signals()
      do
         written = is_written(place_of_run(args%operand(1)%s))
         if (allocated(error)) deallocate (error)
         call look(place_of_run(args%operand(1)%s), channel_names(args), status, line, error)
         if (allocated(error)) then
            failures = failures + 1
            if (failures > MOST_FAILURES .or. error%code /= ERR_FILE .or. shown == '') exit
         else
            failures = 0
            if (line /= shown) then
               if (is_terminal(STDERR)) then
                  call print_status(line)
               else
                  call print_line(line)
               end if
            end if
            shown = line
            if (status /= 'RUNNING' .or. .not. written) exit
         end if
         if (caught_signal() > 0) exit
         ignored = c_usleep(POLL)
      end do
      if (is_terminal(STDERR) .and. shown /= '') then
         call print_status('')
         call print_line(shown)
      end if
      if (caught_signal() > 0) code = 128 + caught_signal()
      if (allocated(error) .or. caught_signal() > 0) return
      if (status == 'RUNNING') call fail(error, ERR_RUN, 'nothing writes it: the run was killed')
   end subroutine watch_command

   !> Where a run writes what is to be `path`
   function place_of_run(path) result(place)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: place

      call find_part(path, .true., place)
      if (place == '') place = path
   end function place_of_run

   !> What the last row says
   subroutine look(path, names, status, line, error)
      character(len=*), intent(in) :: path, names
      character(len=:), allocatable, intent(out) :: status, line
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(history_reader_t) :: reader
      type(history_t) :: history
      type(text_t), allocatable :: facts(:), values(:)
      type(series_t), allocatable :: series(:)
      real(wp), allocatable :: rows(:, :)
      integer :: n_row, n, i

      status = ''
      line = ''
      call open_history_file(path, reader, history, n_row, error)
      if (allocated(error)) return
      n = min(n_row, merge(WIDTH, 1, names /= ''))
      allocate (rows(history%n_value, max(1, n)))
      if (n > 0) call read_rows(reader, n_row - n + 1, n, rows, error)
      if (.not. allocated(error)) call read_facts(reader, facts, values, error)
      if (.not. allocated(error) .and. names /= '') call find_series(history, names, series, error)
      call close_history_file(reader, closing)
      if (allocated(error)) return
      status = fact('status', facts, values, '')
      line = status//'  '//str(n_row)//' samples'
      if (n == 0) return
      line = line//row_text(history, rows(:, n))
      if (names == '') return
      do i = 1, min(3, size(series))
         line = line//'  '//series(i)%name//' '//curve(history, series(i), rows(:, :n))
      end do
   end subroutine look

   !> "  t 0.212  dt 1.20E-05 (joint 900)  kinetic ..."
   function row_text(history, row) result(text)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: row(:)
      character(len=:), allocatable :: text

      integer :: kind

      text = '  t '//few(run_value(CH_TIME), 4)//'  dt '//few(run_value(CH_TIME_STEP), 4)
      kind = nint(run_value(CH_OWNER_KIND))
      if (kind > 0 .and. kind <= ubound(OWNER, 1)) &
         text = text//' ('//trim(OWNER(kind))//' '//str(nint(run_value(CH_OWNER)))//')'
      text = text//'  kinetic '//few(run_value(CH_KE_TRANS) + run_value(CH_KE_ROT), 4)// &
         '  internal '//few(run_value(CH_IE), 4)//'  work '//few(run_value(CH_WORK), 4)// &
         '  error '//percent(run_value(CH_ENERGY_ERROR))//worst(CH_J_VIOL_T, 'gap')// &
         worst(CH_J_VIOL_R, 'angle')
   contains
      real(wp) function run_value(channel)
         integer, intent(in) :: channel

         integer :: i

         run_value = 0.0_wp
         i = place_of(history, channel)
         if (i > 0) run_value = row(i)
      end function run_value

      !> The joint that gives way most
      function worst(channel, name) result(words)
         integer, intent(in) :: channel
         character(len=*), intent(in) :: name
         character(len=:), allocatable :: words

         integer :: i, k

         words = ''
         i = findloc(history%variable%channel, channel, 1)
         if (i == 0) return
         associate (v => history%variable(i))
            k = maxloc(row(v%first:v%first + v%n_entity - 1), 1)
            words = '  '//name//' '//few(row(v%first + k - 1), 4)//' (joint '// &
               str(history%entity(OF_JOINT)%id(k))//')'
         end associate
      end function worst
   end function row_text

   !> A curve of blocks, a letter a sample, from its least to its largest value
   function curve(history, series, rows) result(text)
      type(history_t), intent(in) :: history
      type(series_t), intent(in) :: series
      real(wp), intent(in) :: rows(:, :)
      character(len=:), allocatable :: text

      real(wp) :: y(size(rows, 2)), span
      integer :: i, level

      do i = 1, size(y)
         y(i) = series_value(history, series, rows(:, i))
      end do
      span = max(maxval(y) - minval(y), tiny(1.0_wp))
      text = ''
      do i = 1, size(y)
         level = min(7, max(0, int(8*(y(i) - minval(y))/span)))
         text = text//char(226)//char(150)//char(129 + level)      ! U+2581 to U+2588
      end do
      text = text//' '//few(y(size(y)), 4)
   end function curve

end module kj_export_command
