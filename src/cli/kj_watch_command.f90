!> `kjoint watch`: what a run does, from the history that it writes, until it ends.
module kj_watch_command
   use, intrinsic :: iso_c_binding, only: c_int
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN, ERR_FILE
   use kj_text, only: text_t
   use kj_channels, only: OF_JOINT, CH_TIME, CH_TIME_STEP, CH_OWNER_KIND, CH_OWNER, &
      CH_KE_TRANS, CH_KE_ROT, CH_IE, CH_WORK, CH_ENERGY_ERROR, CH_J_VIOL_T, CH_J_VIOL_R
   use kj_history, only: history_t, place_of
   use kj_output, only: find_part, is_written
   use kj_reader, only: history_reader_t, open_history_file, read_rows, read_facts, &
      close_history_file
   use kj_series, only: series_t, find_series, series_value
   use kj_option, only: arguments_t
   use kj_export_command, only: channel_names
   use kj_signal, only: watch_signals, caught_signal
   use kj_progress, only: percent
   use kj_words, only: few
   use kj_terminal, only: print_line, print_status, is_terminal, STDERR
   implicit none
   private

   public :: watch_command

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
         call look(place_of_run(args%operand(1)%s), channel_names(args, 2), status, line, error)
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
      do i = 1, size(facts)
         if (facts(i)%s == 'status') status = values(i)%s
      end do
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

end module kj_watch_command
