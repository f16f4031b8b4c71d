!> The sink that writes a history file. Rows are held until a chunk is full; a thread in the
!> background packs and writes it. At least every FLUSH_SECONDS what is there becomes readable by
!> others. Where HDF5 is not thread-safe the caller writes, when the next chunk is full.
!>
!> The file grows under a name of its own beside `path` and takes that name at the first flush, so
!> that an older history is lost only to a run that got going. Room on the disk is held back for its
!> end: HDF5 keeps some of its bookkeeping in memory until then.
module kj_sink_h5
   use, intrinsic :: iso_fortran_env, only: compiler_version, compiler_options
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE, ERR_INTERNAL
   use kj_version, only: KJOINT_VERSION
   use kj_system, only: rename_file, remove_file, host_name, date_time, wall_clock
   use kj_utf8, only: as_utf8
   use kj_channels, only: AS_F64, AS_I32, AS_I64
   use kj_history, only: history_t
   use kj_sink, only: sink_t
   use kj_h5, only: hid_t, start_hdf5, hdf5_version, create_file, close_file, flush_file, &
      create_group, put_text, put_number
   use kj_h5_layout, only: write_layout
   use kj_h5_chunk, only: packer_t, new_packer, free_packer, find_row, pack_in_background, &
      finish_background, write_buffer, write_rows
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_char, c_null_char
   implicit none
   private

   integer, parameter :: NO_RESERVE = -1
   integer(c_long), parameter :: BYTES = 2*1024*1024

   interface
      integer(c_int) function kj_reserve_take(name, bytes) bind(c)
         import :: c_int, c_long, c_char
         character(kind=c_char), intent(in) :: name(*)
         integer(c_long), value, intent(in) :: bytes
      end function kj_reserve_take

      subroutine kj_reserve_give(file) bind(c)
         import :: c_int
         integer(c_int), value, intent(in) :: file
      end subroutine kj_reserve_give
   end interface

   !> A history file under way, or none (file < 0)
   type, extends(sink_t), public :: sink_h5_t
      ! set by the caller before open
      character(len=:), allocatable :: path           !! of the history
      character(len=:), allocatable :: command_line   !! kept in /run
      logical :: reproducible = .false.               !! equal runs write equal bytes
      integer :: n_threads = 1        !! of the run, kept in /run; they pack rows as big as a chunk
      ! own
      integer(hid_t), private :: file = -1, run = -1           !! /run
      type(packer_t), private :: packer
      integer, private :: reserve = NO_RESERVE                 !! room on the disk for the end
      integer, private :: n_value = 0, n_chunk = 1             !! reals in a row, rows in a chunk
      integer, private :: n_written = 0                        !! rows in chunks that are full
      integer, private :: n_packing = 0                        !! rows packed in the background
      integer, private :: n_held = 0                           !! rows in the buffer
      logical, private :: failed = .false.                     !! a row could not be written
      logical, private :: named = .false.                      !! the file has its final name
      ! wall clock [s]; rows put before `flushed` are readable by others
      real(wp), private :: started = 0.0_wp, flushed = 0.0_wp, last_put = 0.0_wp, handed = 0.0_wp
   contains
      procedure :: open => open_h5
      procedure :: put => put_h5
      procedure :: begin_row => begin_row_h5
      procedure :: end_row => end_row_h5
      procedure :: flush => flush_h5
      procedure :: close => close_h5
   end type sink_h5_t

   integer, parameter :: MOST_CHUNK_ROWS = 1024, LEAST_CHUNK_ROWS = 16   !! powers of two
   integer, parameter :: MOST_BUFFER_BYTES = 4*1024*1024
   real(wp), parameter :: FLUSH_SECONDS = 2.0_wp, FAST_CHUNK = 0.1_wp*FLUSH_SECONDS
   character(len=*), parameter :: GROWING = '.part'    !! ends the name of a file that is new

contains

   !> Create the file and write everything that is known before the first row.
   !> Errors: ERR_FILE when the file cannot be created
   subroutine open_h5(self, history, error)
      class(sink_h5_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      integer(hid_t), allocatable :: series(:)
      logical :: folder

      if (.not. allocated(self%path)) self%path = ''
      inquire (file=self%path//'/.', exist=folder)
      if (self%path == '' .or. folder .or. index(self%path, '/dev/') == 1) then
         call fail(error, ERR_FILE, '"'//self%path//'" is no name for a history file')
         return
      end if
      call free_packer(self%packer)
      if (self%file >= 0) call close_file(self%file, closing)   ! a run that was given up
      call start_hdf5(error)
      call create_file(self%path//GROWING, self%file, error)
      if (allocated(error)) then
         error%message = 'cannot create the history file '//self%path
         return
      end if

      self%n_value = history%n_value
      self%n_chunk = rows_in_chunk(history)
      self%n_written = 0
      self%n_packing = 0
      self%n_held = 0
      self%failed = .false.
      self%named = .false.
      self%started = wall_clock()
      self%flushed = self%started
      self%last_put = self%started
      self%handed = self%started

      call give_reserve(self%reserve)
      call take_reserve(self%path//GROWING//'.room', self%reserve)
      allocate (series(size(history%variable)))
      call write_layout(self%file, history, self%n_chunk, series, error)
      call new_packer(history, series, self%n_chunk, self%n_threads, self%reproducible, &
         self%packer, error)
      call put_start(self, error)
      if (allocated(error)) then
         call give_reserve(self%reserve)
         call free_packer(self%packer)
         call close_file(self%file, closing)
         call remove_file(self%path//GROWING)
      end if
   end subroutine open_h5

   !> Rows in a chunk: as many as the buffer takes, not many more than will come
   pure integer function rows_in_chunk(history) result(n)
      type(history_t), intent(in) :: history

      n = MOST_CHUNK_ROWS
      do while (n > 1 .and. n > MOST_BUFFER_BYTES/(8*max(1, history%n_value)))
         n = n/2
      end do
      if (history%n_expected < 1) return
      do while (n > LEAST_CHUNK_ROWS .and. n/2 >= history%n_expected)
         n = n/2
      end do
   end function rows_in_chunk

   !> Write to /run what is known at the start; reproducible leaves out what differs between runs
   subroutine put_start(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      call create_group(self%file, 'run', self%run, error)
      if (.not. self%reproducible .and. allocated(self%command_line)) &
         call put_text(self%run, 'command_line', as_utf8(self%command_line), error)
      call put_text(self%run, 'version', KJOINT_VERSION, error)
      call put_text(self%run, 'compiler', compiler_version(), error)
      call put_text(self%run, 'compiler_options', compiler_options(), error)
      call put_text(self%run, 'hdf5_version', hdf5_version(), error)
      if (.not. self%reproducible) then
         call put_number(self%run, 'n_threads', AS_I32, real(self%n_threads, wp), error)
         call put_text(self%run, 'host', as_utf8(host_name()), error)
         call put_text(self%run, 'started', date_time(), error)
      end if
      call put_text(self%run, 'status', 'RUNNING', error)
   end subroutine put_start

   !> Take one row. Errors: ERR_FILE when it, or one before, cannot be written, ERR_INTERNAL when it
   !> does not fit
   subroutine put_h5(self, row, error)
      class(sink_h5_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp), pointer, contiguous :: room(:)

      if (self%file < 0) then
         call fail(error, ERR_INTERNAL, 'a row came to a history that is not open')
         return
      end if
      if (size(row) /= self%n_value) then
         call fail(error, ERR_INTERNAL, 'a row of '//str(size(row))// &
            ' values came to a history of '//str(self%n_value))
         return
      end if
      call self%begin_row(room)
      if (associated(room)) then
         room = row
         call self%end_row(error)
      else if (self%failed) then
         call fail(error, ERR_FILE, 'an earlier row could not be written')
      else
         call write_row(self, row, error)
         call flush_in_time(self, error)
      end if
   end subroutine put_h5

   !> Room in the buffer, where a chunk has more than one row
   subroutine begin_row_h5(self, row)
      class(sink_h5_t), intent(inout) :: self
      real(wp), pointer, contiguous, intent(out) :: row(:)

      row => null()
      if (self%file < 0 .or. self%failed .or. self%n_chunk == 1) return
      call find_row(self%packer, self%n_held + 1, row)
   end subroutine begin_row_h5

   !> Count the row that was written into the buffer. Errors: ERR_FILE when a chunk is not written
   subroutine end_row_h5(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      self%n_held = self%n_held + 1
      if (self%n_held == self%n_chunk) call hand_over(self, error)
      call flush_in_time(self, error)
   end subroutine end_row_h5

   !> Flush when the next row, as far away as this one was, would come too late
   subroutine flush_in_time(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      real(wp) :: now

      if (self%reproducible .or. allocated(error)) return
      now = wall_clock()
      if (2.0_wp*now - self%last_put - self%flushed >= FLUSH_SECONDS) call self%flush(error)
      self%last_put = now
   end subroutine flush_in_time

   !> Make every row taken so far readable by others. Errors: ERR_FILE
   subroutine flush_h5(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (self%file < 0) return
      call finish_packing(self, error)
      call write_held(self, error)
      call make_readable(self, error)
   end subroutine flush_h5

   !> Make what is written readable by others
   subroutine make_readable(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      call flush_file(self%file, error)
      if (.not. allocated(error)) call take_name(self, error)
      self%flushed = wall_clock()
   end subroutine make_readable

   !> The buffer is full: when the chunk before is written, leave this one to the background. Chunks
   !> that come fast are flushed here, which spares writing parts of them; the rows of this one, the
   !> first of which came when the chunk before was full, wait for the next time.
   subroutine hand_over(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      real(wp) :: now, before

      call finish_packing(self, error)
      if (self%failed) return
      if (.not. self%reproducible) then
         now = wall_clock()
         before = self%handed
         self%handed = now
         if (now - before < FAST_CHUNK .and. now - self%flushed > FLUSH_SECONDS - 2*FAST_CHUNK) then
            call make_readable(self, error)
            self%flushed = before
         end if
      end if
      call pack_in_background(self%packer, self%n_written)
      self%n_packing = self%n_held
      self%n_held = 0
   end subroutine hand_over

   !> Let the background finish its chunk, time last: a reader finds at least as many rows of the
   !> rest. Reproducible files are flushed here, by rows instead of by the clock.
   subroutine finish_packing(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      integer :: n

      n = self%n_packing
      self%n_packing = 0
      if (n == 0) return
      call finish_background(self%packer, self%n_written, error)
      call note_written(self, n, error)
      if (self%reproducible) call make_readable(self, error)
   end subroutine finish_packing

   !> Write the rows in the buffer, part of a chunk: they stay there and are written again with the
   !> rest of it
   subroutine write_held(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      if (self%n_held == 0 .or. self%failed) return
      call write_buffer(self%packer, self%n_written, self%n_held, error)
      call note_written(self, 0, error)
   end subroutine write_held

   !> Write a row that is a chunk
   subroutine write_row(self, row, error)
      class(sink_h5_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_t), allocatable, intent(inout) :: error

      call write_rows(self%packer, self%n_written, 1, row, error)
      call note_written(self, 1, error)
      if (self%reproducible) call make_readable(self, error)
   end subroutine write_row

   !> A chunk of n rows was written, or the history ends before it: no rows come after a hole
   subroutine note_written(self, n, error)
      class(sink_h5_t), intent(inout) :: self
      integer, intent(in) :: n
      type(error_t), allocatable, intent(inout) :: error

      self%failed = allocated(error)
      if (self%failed) then
         error%file = self%path
         self%n_held = 0
      else
         self%n_written = self%n_written + n
      end if
   end subroutine note_written

   !> Give the file its final name, replacing an older history. Errors: ERR_FILE
   subroutine take_name(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      if (self%named) return
      call rename_file(self%path//GROWING, self%path, self%named)
      if (.not. self%named) call fail(error, ERR_FILE, 'cannot rename '//self%path//GROWING// &
         ' to '//self%path)
   end subroutine take_name

   !> Write the rest and the outcome and close the file, whatever fails on the way. A run that
   !> failed before its first row, or whose first flush failed, leaves no file.
   !> Errors: ERR_FILE, the first
   subroutine close_h5(self, status, cycles, exit_code, error)
      class(sink_h5_t), intent(inout) :: self
      character(len=*), intent(in) :: status
      integer, intent(in) :: cycles, exit_code
      type(error_t), allocatable, intent(out) :: error

      logical :: empty

      if (self%file < 0) return
      empty = self%n_written + self%n_packing + self%n_held == 0
      call finish_packing(self, error)
      call write_held(self, error)
      call give_reserve(self%reserve)
      call free_packer(self%packer)
      if (.not. self%reproducible) then
         call put_text(self%run, 'ended', date_time(), error)
         call put_number(self%run, 'elapsed_s', AS_F64, wall_clock() - self%started, error)
      end if
      call put_number(self%run, 'cycles', AS_I64, real(cycles, wp), error)
      call put_text(self%run, 'status', as_utf8(status), error)
      call put_number(self%run, 'exit_code', AS_I32, real(exit_code, wp), error)
      call close_file(self%file, error)
      self%run = -1
      if (self%named) return
      if (allocated(error) .or. (empty .and. exit_code /= 0)) then
         call remove_file(self%path//GROWING)
      else
         call take_name(self, error)
      end if
   end subroutine close_h5

   !> Hold room by a file whose path is free again on return; NO_RESERVE where there is none
   subroutine take_reserve(path, reserve)
      character(len=*), intent(in) :: path
      integer, intent(out) :: reserve

      reserve = int(kj_reserve_take(path//c_null_char, BYTES))
   end subroutine take_reserve

   !> Give it back, if there is any
   subroutine give_reserve(reserve)
      integer, intent(inout) :: reserve

      call kj_reserve_give(int(reserve, c_int))
      reserve = NO_RESERVE
   end subroutine give_reserve

end module kj_sink_h5
