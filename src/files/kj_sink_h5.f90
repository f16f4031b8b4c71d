!> The sink that writes a history file. Rows are held until a chunk is full; a thread in the
!> background packs and writes it. At least every FLUSH_SECONDS what is there becomes readable by
!> others, and stays so if the program is killed.
!>
!> The file grows under a name of its own beside `path`. It takes that name at the first flush where
!> nothing has it; in place of an older history at the end, when the run ended well or was stopped.
!>
!> One file: the sink, whose parts share its state.
module kj_sink_h5
   use, intrinsic :: iso_c_binding, only: c_ptr, C_NULL_PTR, c_associated
   use, intrinsic :: iso_fortran_env, only: compiler_version, compiler_options, int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE, ERR_INTERNAL
   use kj_version, only: KJOINT_VERSION
   use kj_system, only: remove_file, host_name, date_time, wall_clock
   use kj_text, only: text_t, as_utf8
   use kj_channels, only: AS_F64, AS_I32, AS_I64, CH_TIME
   use kj_history, only: history_t
   use kj_sink, only: sink_t
   use kj_output, only: settle_output, open_part, name_part, has_name
   use kj_h5, only: hid_t, start_hdf5, hdf5_version, create_file, close_file, create_group, &
      close_object, find_place, put_text, put_number
   use kj_h5_layout, only: write_layout
   use kj_h5_store, only: begin_store, commit_rows, last_rows, finish_store, close_store, &
      packer_t, new_packer, free_packer, write_in_background, finish_background, write_buffer
   implicit none
   private

   !> A history file under way, or none
   type, extends(sink_t), public :: sink_h5_t
      ! set by the caller before open
      character(len=:), allocatable :: path           !! of the history
      type(text_t), allocatable :: inputs(:)          !! paths that are read, besides the decks
      character(len=:), allocatable :: command_line   !! kept in /run
      logical :: reproducible = .false.               !! equal runs write equal bytes
      logical :: live = .false.                       !! readers may follow it (SWMR)
      integer :: n_threads = 1                        !! of the run, kept in /run
      !> Where the file is, now and when it was closed; empty: it was removed, having no rows
      character(len=:), allocatable :: place
      logical :: named = .false.                      !! it has its final name
      ! own
      character(len=:), allocatable, private :: target         !! what it is to become
      integer, private :: descriptor = -1                      !! of the open file
      type(c_ptr), private :: store = C_NULL_PTR               !! the file
      type(packer_t), private :: packer
      integer, private :: n_value = 0, n_chunk = 1             !! reals in a row, rows in a chunk
      integer, private :: n_written = 0                        !! rows in chunks that are full
      integer, private :: n_ready = 0                          !! the same and of the last chunk
      integer, private :: n_packing = 0                        !! rows packed in the background
      integer, private :: n_held = 0                           !! rows in the buffer
      logical, private :: failed = .false.                     !! a row could not be written
      logical, private :: repeated = .false.                   !! part of a chunk was written
      ! wall clock [s]; rows put before `flushed` are readable by others
      real(wp), private :: started = 0.0_wp, flushed = 0.0_wp, last_put = 0.0_wp, handed = 0.0_wp
   contains
      procedure :: open => open_h5
      procedure :: put => put_h5
      procedure :: flush => flush_h5
      procedure :: close => close_h5
   end type sink_h5_t

   integer, parameter :: MOST_CHUNK_ROWS = 1024, LEAST_CHUNK_ROWS = 16   !! powers of two
   integer, parameter :: PASSES = 2              !! that bring the last rows forward in the file
   integer, parameter :: MOST_BUFFER_BYTES = 4*1024*1024
   integer, parameter :: SIGNAL_CODE = 128       !! exit codes above: who uses it stopped the run
   real(wp), parameter :: FLUSH_SECONDS = 2.0_wp, FAST_CHUNK = 0.1_wp*FLUSH_SECONDS

contains

   !> Create the file and write everything that is known before the first row.
   !> Errors: ERR_INPUT when the path is an input, or of something else than a file; ERR_FILE when
   !> the file cannot be created, or another run writes it
   subroutine open_h5(self, history, error)
      class(sink_h5_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(text_t), allocatable :: inputs(:)

      call give_up(self)
      if (.not. allocated(self%path)) self%path = ''
      self%n_value = history%n_value
      self%n_chunk = rows_in_chunk(history)
      self%n_written = 0
      self%n_ready = 0
      self%n_packing = 0
      self%n_held = 0
      self%failed = .false.
      self%repeated = .false.
      self%named = .false.
      self%started = wall_clock()
      self%flushed = self%started
      self%last_put = self%started
      self%handed = self%started

      allocate (inputs(0))
      if (allocated(self%inputs)) inputs = [inputs, self%inputs]
      if (allocated(history%input_path)) inputs = [inputs, history%input_path]
      call settle_output(self%path, inputs, self%target, error)
      self%place = ''
      call write_start(self, history, error)
      call new_packer(history, self%store, self%n_chunk, self%reproducible, self%packer, error)
      if (allocated(error)) then
         call free_packer(self%packer)
         call close_store(self%store, closing)
         if (self%descriptor >= 0) call remove_file(self%place)
         self%place = ''
      end if
   end subroutine open_h5

   !> Forget a run that was not closed
   subroutine give_up(self)
      class(sink_h5_t), intent(inout) :: self

      type(error_t), allocatable :: ignored

      call free_packer(self%packer)
      if (.not. c_associated(self%store)) return
      call close_store(self%store, ignored)
      if (.not. self%named) call remove_file(self%place)
   end subroutine give_up

   !> Make the file in memory, and write it
   subroutine write_start(self, history, error)
      class(sink_h5_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(inout) :: error

      type(error_t), allocatable :: closing
      integer(hid_t) :: file
      integer(int64) :: series(size(history%variable)), run

      call start_hdf5(error)
      call create_file(self%target//' in memory', file, error, image=.true., live=self%live)
      call write_layout(file, history, self%n_chunk, series, error)
      call put_start(self, history, file, run, error)
      self%descriptor = -1
      call open_part(self%target, self%place, self%descriptor, error)
      call begin_store(self%descriptor, file, series, &
         findloc(history%variable%channel, CH_TIME, 1), run, self%live, self%store, error)
      call close_file(file, closing)
   end subroutine write_start

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

   !> Write to /run what is known at the start, and room for the outcome; reproducible leaves out
   !> what differs between runs
   subroutine put_start(self, history, file, place, error)
      class(sink_h5_t), intent(in) :: self
      type(history_t), intent(in) :: history
      integer(hid_t), intent(in) :: file
      integer(int64), intent(out) :: place         !! of /run
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: run

      call create_group(file, 'run', run, error)
      call find_place(run, place, error)
      if (.not. self%reproducible .and. allocated(self%command_line)) &
         call put_text(run, 'command_line', as_utf8(self%command_line), error)
      call put_text(run, 'version', KJOINT_VERSION, error)
      if (allocated(history%integrator)) &
         call put_text(run, 'integrator', history%integrator, error)
      call put_text(run, 'compiler', compiler_version(), error)
      call put_text(run, 'compiler_options', compiler_options(), error)
      call put_text(run, 'hdf5_version', hdf5_version(), error)
      if (.not. self%reproducible) then
         call put_number(run, 'n_threads', AS_I32, real(self%n_threads, wp), error)
         call put_text(run, 'host', as_utf8(host_name()), error)
         call put_text(run, 'started', date_time(), error)
         call put_text(run, 'ended', '', error)
         call put_number(run, 'elapsed_s', AS_F64, 0.0_wp, error)
      end if
      call put_number(run, 'cycles', AS_I64, 0.0_wp, error)
      call put_text(run, 'status', 'RUNNING', error)
      call put_number(run, 'exit_code', AS_I32, 0.0_wp, error)
      call close_object(run, error)
   end subroutine put_start

   !> Take one row. Errors: ERR_FILE when it, or one before, cannot be written, ERR_INTERNAL when it
   !> does not fit
   subroutine put_h5(self, row, error)
      class(sink_h5_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. c_associated(self%store)) then
         call fail(error, ERR_INTERNAL, 'a row came to a history that is not open')
         return
      end if
      if (size(row) /= self%n_value) then
         call fail(error, ERR_INTERNAL, 'a row of '//str(size(row))// &
            ' values came to a history of '//str(self%n_value))
         return
      end if
      if (self%failed) then
         call fail(error, ERR_FILE, 'an earlier row could not be written')
         return
      end if
      self%n_held = self%n_held + 1
      call keep_row(self%n_value, row, self%packer%buffer(:, self%n_held))
      if (self%n_held == self%n_chunk) call hand_over(self, error)
      call flush_in_time(self, error)
   end subroutine put_h5

   !> A row into the buffer, as one piece of memory
   pure subroutine keep_row(n, row, kept)
      integer, intent(in) :: n
      real(wp), intent(in) :: row(n)
      real(wp), intent(out) :: kept(n)

      kept = row
   end subroutine keep_row

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

      if (.not. c_associated(self%store)) return
      call finish_packing(self, error)
      self%repeated = self%repeated .or. self%n_held > 0
      call write_held(self, error)
      call make_readable(self, error)
   end subroutine flush_h5

   !> Make what is written readable by others, by the name of the history where nothing has it
   subroutine make_readable(self, error)
      class(sink_h5_t), intent(inout) :: self
      type(error_t), allocatable, intent(inout) :: error

      call commit_rows(self%store, self%n_ready, error)
      if (.not. self%named .and. self%n_ready > 0) call take_name(self, .false., error)
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
      call write_in_background(self%packer, self%n_written)
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

      integer :: n

      n = self%n_held
      if (n == 0 .or. self%failed) return
      call write_buffer(self%packer, self%n_written, n, error)
      call note_written(self, 0, error)
      if (.not. allocated(error)) self%n_ready = self%n_written + n
   end subroutine write_held

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
         self%n_ready = max(self%n_ready, self%n_written)
      end if
   end subroutine note_written

   !> Give the file its final name; replace: in place of an older history. Errors: ERR_FILE
   subroutine take_name(self, replace, error)
      class(sink_h5_t), intent(inout) :: self
      logical, intent(in) :: replace
      type(error_t), allocatable, intent(inout) :: error

      call name_part(self%place, self%target, replace, self%named, error)
      if (self%named) self%place = self%target
   end subroutine take_name

   !> Write the rest and the outcome and close the file, whatever fails on the way, and give it its
   !> name. A failed run without rows leaves no file; one with rows does not replace an older one.
   !> Errors: ERR_FILE, the first
   subroutine close_h5(self, status, cycles, exit_code, error)
      class(sink_h5_t), intent(inout) :: self
      character(len=*), intent(in) :: status
      integer, intent(in) :: cycles, exit_code
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      character(len=:), allocatable :: ended
      logical :: known
      integer :: i

      if (.not. c_associated(self%store)) return
      call finish_packing(self, error)
      call last_rows(self%store)
      call write_held(self, error)
      call commit_rows(self%store, self%n_ready, closing)
      do i = 1, merge(PASSES, 0, self%repeated .and. .not. allocated(closing))
         call write_held(self, error)            ! where the last time left room
         call commit_rows(self%store, self%n_ready, closing)
      end do
      call free_packer(self%packer)
      ended = date_time()
      if (self%reproducible) ended = ''
      if (allocated(error)) then
         call finish_store(self%store, as_utf8('ERROR TERMINATION: '//error%message), ended, &
            wall_clock() - self%started, cycles, error%code, closing)
      else
         call finish_store(self%store, as_utf8(status), ended, wall_clock() - self%started, &
            cycles, exit_code, closing)
      end if
      known = has_name(self%descriptor)
      call close_store(self%store, closing)
      if (.not. known .and. .not. allocated(closing)) call fail(closing, ERR_FILE, &
         'the history '//self%place//' was removed or replaced while it was written')
      if (.not. allocated(error)) call move_alloc(closing, error)
      call end_name(self, known, exit_code, error)
   end subroutine close_h5

   !> The name of a file that is closed
   subroutine end_name(self, known, exit_code, error)
      class(sink_h5_t), intent(inout) :: self
      logical, intent(in) :: known               !! it has a name
      integer, intent(in) :: exit_code
      type(error_t), allocatable, intent(inout) :: error

      type(error_t), allocatable :: ignored

      if (self%named .or. .not. known) return
      if (.not. allocated(error) .and. (exit_code == 0 .or. exit_code > SIGNAL_CODE)) then
         call take_name(self, .true., error)
      else if (self%n_ready > 0) then
         call take_name(self, .false., ignored)
      else
         call remove_file(self%place)
         self%place = ''
      end if
   end subroutine end_name

end module kj_sink_h5
