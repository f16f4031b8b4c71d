!> Reads a history from a file of either kind: ours (HDF5) or a Radioss T01; and a T01 into any
!> sink. The kind is taken from the first bytes, not from the name.
module kj_reader
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_history, only: history_t
   use kj_text, only: text_t
   use kj_t01_bytes, only: byte_file_t, open_bytes, read_bytes, close_bytes, why_not
   use kj_t01, only: t01_reader_t, open_t01, read_t01_rows, close_t01
   use kj_read_h5, only: h5_reader_t, open_h5_history, read_h5_rows, close_h5_history, &
      read_run_facts
   use kj_output, only: is_locked, find_part
   use kj_sink, only: sink_t
   implicit none
   private

   public :: history_reader_t, open_history_file, read_rows, next_row, rewind_rows, read_facts, &
      close_history_file, convert_t01

   integer, parameter :: CLOSED = 0, KIND_T01 = 1, KIND_H5 = 2

   !> An open file; components are for reading only
   type :: history_reader_t
      integer, private :: kind = CLOSED
      type(t01_reader_t), private :: t01
      type(h5_reader_t), private :: h5
      integer, private :: n_row = 0, passed = 0          !! rows; those that next_row has given
      real(wp), allocatable, private :: rows(:, :)       !! a block of them
      logical :: is_t01 = .false.
      logical :: has_units = .false.             !! history%units are those of the file
      logical, allocatable :: given(:)           !! (n_value) the file holds this series
      type(text_t), allocatable :: unknown(:)    !! variables that our layout has no channel for
      character(len=:), allocatable :: note      !! set when something was left out
   end type history_reader_t

   integer, parameter :: HDF5_MAGIC(8) = [137, 72, 68, 70, 13, 10, 26, 10]

   integer, parameter :: BLOCK = 2**18       !! reals in memory at a time, about

contains

   !> Open a file and say what it holds
   !>
   !> Errors: ERR_FILE when it cannot be opened, is neither kind or is damaged.
   subroutine open_history_file(path, reader, history, n_row, error)
      character(len=*), intent(in) :: path
      type(history_reader_t), intent(out) :: reader
      type(history_t), intent(out) :: history
      integer, intent(out) :: n_row
      type(error_t), allocatable, intent(out) :: error

      logical :: is_h5

      n_row = 0
      call look_at_magic(path, is_h5, error)
      if (allocated(error)) then
         call look_beside(path, error)
         return
      end if
      if (is_h5) then
         call open_h5_history(path, reader%h5, history, n_row, error)
         if (allocated(error)) then
            if (index(error%message, 'cannot open') == 1) &
               error%hint = 'it is cut off or damaged; `kjoint recover` puts right what a kill left'
            if (is_locked(path)) &
               error%hint = 'another program holds it open for writing, with a lock'
            return
         end if
         reader%kind = KIND_H5
         reader%has_units = all(history%units%si > 0.0_wp)
         allocate (reader%given(history%n_value), source=.true.)
         allocate (reader%unknown(0))
      else
         call open_t01(path, reader%t01, history, n_row, error)
         if (allocated(error)) return
         reader%kind = KIND_T01
         reader%is_t01 = .true.
         reader%has_units = reader%t01%has_units
         reader%given = reader%t01%given
         call move_alloc(reader%t01%unknown, reader%unknown)
         if (allocated(reader%t01%note)) reader%note = reader%t01%note
      end if
      reader%n_row = n_row
   end subroutine open_history_file

   !> Where a history is that has not got its name, in the error that it is not there
   subroutine look_beside(path, error)
      character(len=*), intent(in) :: path
      type(error_t), intent(inout) :: error

      character(len=:), allocatable :: part
      logical :: exists

      inquire (file=path, exist=exists)
      if (exists) return
      error%message = 'there is no '//path
      call find_part(path, .true., part)
      if (part /= '') error%hint = 'a run that is to become it writes '//part
      if (part /= '') return
      call find_part(path, .false., part)
      if (part /= '') error%hint = 'a run that did not end left '//part
   end subroutine look_beside

   !> Does the file begin as HDF5 files do
   subroutine look_at_magic(path, is_h5, error)
      character(len=*), intent(in) :: path
      logical, intent(out) :: is_h5
      type(error_t), allocatable, intent(out) :: error

      type(byte_file_t) :: file
      integer(int8) :: head(size(HDF5_MAGIC))
      integer :: n
      logical :: ok

      is_h5 = .false.
      call open_bytes(path, file, ok)
      if (.not. ok) then
         call fail(error, ERR_FILE, 'cannot open '//path//': '//why_not(path))
         return
      end if
      call read_bytes(file, head, n)
      if (n < 0) then                            ! what can be opened and not be read is a folder
         call close_bytes(file)
         call fail(error, ERR_FILE, 'cannot read '//path//': '//why_not(path))
         return
      end if
      call close_bytes(file)
      if (n == size(head)) is_h5 = all(iand(int(head), 255) == HDF5_MAGIC)
   end subroutine look_at_magic

   !> Read n rows from row `first` on, as history%variable says
   !>
   !> Errors: ERR_FILE when a row is damaged.
   subroutine read_rows(reader, first, n, rows, error)
      type(history_reader_t), intent(inout) :: reader
      integer, intent(in) :: first, n
      real(wp), intent(out) :: rows(:, :)        !! (history%n_value, >= n)
      type(error_t), allocatable, intent(out) :: error

      if (reader%kind == KIND_T01) call read_t01_rows(reader%t01, first, n, rows, error)
      if (reader%kind == KIND_H5) call read_h5_rows(reader%h5, first, n, rows, error)
   end subroutine read_rows

   !> The next row, from the first on; none behind the last. Errors: ERR_FILE, as if none were left
   subroutine next_row(reader, row, more, error)
      type(history_reader_t), intent(inout) :: reader
      real(wp), intent(inout) :: row(:)          !! (history%n_value)
      logical, intent(out) :: more               !! there is one
      type(error_t), allocatable, intent(out) :: error

      integer :: k

      if (.not. allocated(reader%rows)) &
         allocate (reader%rows(size(row), max(1, min(reader%n_row, BLOCK/size(row)))))
      more = reader%passed < reader%n_row
      if (.not. more) return
      k = modulo(reader%passed, size(reader%rows, 2)) + 1
      if (k == 1) call read_rows(reader, reader%passed + 1, min(size(reader%rows, 2), &
         reader%n_row - reader%passed), reader%rows, error)
      more = .not. allocated(error)
      if (more) row = reader%rows(:, k)
      reader%passed = reader%passed + 1
   end subroutine next_row

   !> Go before the first row
   subroutine rewind_rows(reader)
      type(history_reader_t), intent(inout) :: reader

      reader%passed = 0
   end subroutine rewind_rows

   !> What the file says of its run: names and values of /run; of a T01 who made it. Errors:
   !> ERR_FILE
   subroutine read_facts(reader, names, values, error)
      type(history_reader_t), intent(in) :: reader
      type(text_t), allocatable, intent(out) :: names(:), values(:)
      type(error_t), allocatable, intent(out) :: error

      if (reader%kind == KIND_H5) then
         call read_run_facts(reader%h5, names, values, error)
         return
      end if
      allocate (names(1), values(1))
      names(1)%s = 'made by'
      values(1)%s = trim(adjustl(reader%t01%origin))
   end subroutine read_facts

   !> Close; nothing happens when it is not open
   subroutine close_history_file(reader, error)
      type(history_reader_t), intent(inout) :: reader
      type(error_t), allocatable, intent(out) :: error

      if (reader%kind == KIND_T01) call close_t01(reader%t01)
      if (reader%kind == KIND_H5) call close_h5_history(reader%h5, error)
      reader%kind = CLOSED
   end subroutine close_history_file

   !> Write all complete rows of a T01 to a sink
   !>
   !> The sink is closed with "NORMAL TERMINATION": what a T01 says nothing of (the outcome of the
   !> run) is not looked into; cycles are 0.
   !> Errors: ERR_FILE when the T01 cannot be read or the sink cannot be written.
   subroutine convert_t01(t01_path, sink, error)
      character(len=*), intent(in) :: t01_path
      class(sink_t), intent(inout) :: sink
      type(error_t), allocatable, intent(out) :: error

      type(history_reader_t) :: reader
      type(history_t) :: history
      type(error_t), allocatable :: closing
      real(wp), allocatable :: row(:)
      logical :: more, is_h5

      call look_at_magic(t01_path, is_h5, error)
      if (is_h5) call fail(error, ERR_FILE, t01_path//' is a history of kjoint already')
      if (.not. allocated(error)) &
         call open_t01(t01_path, reader%t01, history, reader%n_row, error)
      if (allocated(error)) return
      reader%kind = KIND_T01
      call sink%open(history, error)
      if (allocated(error)) then
         call close_t01(reader%t01)
         return
      end if
      allocate (row(history%n_value))
      do
         call next_row(reader, row, more, error)
         if (more) call sink%put(row, error)
         if (allocated(error) .or. .not. more) exit
      end do
      call close_t01(reader%t01)
      if (allocated(error)) then
         call sink%close('ERROR '//error%message, 0, error%code, closing)
      else
         call sink%close('NORMAL TERMINATION', 0, 0, error)
      end if
   end subroutine convert_t01

end module kj_reader
