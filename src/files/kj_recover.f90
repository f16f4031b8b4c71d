!> Puts right what a history lacks whose run did not end: marks of an open file, datasets of unequal
!> length or with rows that cannot be read, the outcome. It works on a copy, which takes the name of
!> the history when all of it has been read.
module kj_recover
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_text, only: text_t, fact
   use kj_channels, only: AS_I32, AS_I64, CH_CYCLE
   use kj_history, only: history_t
   use kj_system, only: remove_file
   use kj_output, only: begin_output, end_output, copy_to, find_part, is_written, &
      is_locked
   use kj_h5, only: hid_t, start_hdf5, open_file, close_file, close_object, put_text, put_number
   use kj_h5_read, only: open_object
   use kj_h5_store, only: clear_marks
   use kj_h5_write, only: cut_series
   use kj_read_h5, only: h5_reader_t, open_h5_history, read_h5_rows, close_h5_history, &
      read_run_facts
   use kj_series, only: channel_path
   implicit none
   private

   public :: recover_history

   integer, parameter :: BLOCK = 2**18           !! reals in memory at a time, about

contains

   !> Put a history right; `told` says what was done, a line each, or that nothing was.
   !> Errors: ERR_FILE when somebody is writing it, when it is no history, or has no row
   subroutine recover_history(path, told, error)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: told
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: source, part, place
      logical :: exists, marked, changed

      told = ''
      source = path
      inquire (file=path, exist=exists)
      if (.not. exists) call find_part(path, .false., source)
      if (source == '') source = path
      if (is_written(source)) then
         call fail(error, ERR_FILE, 'a run is writing '//source)
      else if (is_locked(source)) then
         call fail(error, ERR_FILE, &
            'another program holds '//source//' open for writing, with a lock')
      end if
      if (allocated(error)) return
      call begin_output(path, [text_t ::], place, part, error)
      if (allocated(error)) return
      call copy_to(source, part, error)
      call clear_marks(part, marked, error)
      changed = marked .or. source /= path
      if (source /= path) call say('it was found as '//source, told)
      if (marked) call say('marked as open: mark taken away', told)
      if (.not. allocated(error)) call mend(part, changed, told, error)
      if (allocated(error)) then
         error%file = source
         call remove_file(part)
      else if (changed) then
         call end_output(part, place, error)
         if (source /= path .and. .not. allocated(error)) call remove_file(source)
      else
         call remove_file(part)
         told = path//' is sound'//new_line('a')
      end if
   end subroutine recover_history

   !> Equal lengths and an outcome
   subroutine mend(path, changed, told, error)
      character(len=*), intent(in) :: path
      logical, intent(inout) :: changed
      character(len=:), allocatable, intent(inout) :: told
      type(error_t), allocatable, intent(inout) :: error

      type(error_t), allocatable :: closing
      type(h5_reader_t) :: reader
      type(history_t) :: history
      type(text_t), allocatable :: names(:), values(:)
      real(wp), allocatable :: row(:, :)
      integer :: n_row, most, n
      logical :: running, cut

      call open_h5_history(path, reader, history, n_row, error)
      if (allocated(error)) then
         if (index(error%message, path) > 0) &   ! of the copy
            error%message = 'it is no HDF5 file, or cut off: nothing can be put right'
         return
      end if
      call read_run_facts(reader, names, values, error)
      most = reader%most_row
      call count_readable(reader, history%n_value, n_row, n)
      allocate (row(history%n_value, 1))
      if (n > 0) call read_h5_rows(reader, n, 1, row, closing)
      call close_h5_history(reader, closing)
      if (n == 0 .and. most > 0 .and. .not. allocated(error)) &
         call fail(error, ERR_FILE, 'it has no whole row')
      if (allocated(error)) return
      running = fact('status', names, values, '') == 'RUNNING'
      cut = n < most
      changed = changed .or. cut .or. running
      if (cut) call say('rows that all datasets have: '//str(n)//' of '//str(most)// &
         '; the others were cut off', told)
      if (running) call say('the run did not end: it says so now, after '//str(n)//' samples', told)
      if (cut .or. running) call rewrite(path, history, merge(n, -1, cut), running, &
         row(:, 1), error)
   end subroutine mend

   !> Rows that can be read of all datasets
   subroutine count_readable(reader, n_value, n_row, n)
      type(h5_reader_t), intent(in) :: reader
      integer, intent(in) :: n_value, n_row
      integer, intent(out) :: n

      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:, :)
      integer :: at_once, next

      at_once = max(1, min(max(1, n_row), BLOCK/max(1, n_value)))
      allocate (rows(n_value, at_once))
      n = 0
      do while (n < n_row)
         next = min(at_once, n_row - n)
         call read_h5_rows(reader, n + 1, next, rows, error)
         if (.not. allocated(error)) then
            n = n + next
         else if (at_once == 1) then
            return
         else
            at_once = max(1, at_once/2)
         end if
      end do
   end subroutine count_readable

   !> Cut the datasets to n rows unless n < 0; end the run that did not end
   subroutine rewrite(path, history, n, running, last, error)
      character(len=*), intent(in) :: path
      type(history_t), intent(in) :: history
      integer, intent(in) :: n
      logical, intent(in) :: running
      real(wp), intent(in) :: last(:)            !! row
      type(error_t), allocatable, intent(inout) :: error

      type(error_t), allocatable :: closing
      integer(hid_t) :: file, run
      integer :: i

      call start_hdf5(error)
      call open_file(path, file, error, to_write=.true.)
      do i = 1, size(history%variable)
         if (n >= 0) call cut_series(file, channel_path(history%variable(i)%channel), n, error)
      end do
      if (running) then
         call open_object(file, 'run', run, error)
         i = findloc(history%variable%channel, CH_CYCLE, 1)
         if (i > 0) call put_number(run, 'cycles', AS_I64, last(history%variable(i)%first), error)
         call put_text(run, 'status', 'ERROR TERMINATION: the run was killed', error)
         call put_number(run, 'exit_code', AS_I32, 137.0_wp, error)
         call close_object(run, closing)
      end if
      call close_file(file, closing)
      if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
   end subroutine rewrite

   subroutine say(line, told)
      character(len=*), intent(in) :: line
      character(len=:), allocatable, intent(inout) :: told

      told = told//line//new_line('a')
   end subroutine say

end module kj_recover
