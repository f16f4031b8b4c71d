!> A history file under way, which is readable after every single write (kj_store.c). HDF5 makes it
!> in memory, complete but for its rows, and has no part in it afterwards.
module kj_h5_store
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_size_t, c_double, c_char, c_ptr, &
      C_NULL_PTR, c_associated, c_null_char, c_f_pointer
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE, str
   use kj_h5, only: hid_t
   use kj_channels, only: channels, AS_F64, STORED_BYTES, CH_TIME
   use kj_history, only: history_t, variable_t
   use kj_h5_layout, only: entities_in_chunk
   implicit none
   private

   public :: begin_store, commit_rows, last_rows, finish_store, close_store, clear_marks, &
      packer_t, new_packer, free_packer, write_in_background, finish_background, write_buffer

   !> Values of a row that go to one chunk, as kj_packer.c has it
   type, bind(c) :: column_t
      integer(c_size_t) :: series = 0            !! the dataset, from 0
      integer(c_size_t) :: part = 0              !! which chunk of a row, from 0
      integer(c_size_t) :: first = 0             !! from 0
      integer(c_size_t) :: n = 1, n_full = 1     !! values that there are, that a chunk has
      integer(c_int) :: real = 1, size = 8       !! stored: as a real, bytes
   end type column_t

   !> Packs the rows of a history
   type :: packer_t
      real(wp), pointer, contiguous :: buffer(:, :) => null()   !! to be filled, (values, rows)
      type(c_ptr), private :: own = C_NULL_PTR   !! what the thread in the background may touch
   end type packer_t

   interface
      type(c_ptr) function kj_packer_new(store, exact, n_value, rows_full, n_column, column) bind(c)
         import :: c_int, c_size_t, c_ptr, column_t
         type(c_ptr), value, intent(in) :: store
         integer(c_int), value, intent(in) :: exact
         integer(c_size_t), value, intent(in) :: n_value, rows_full, n_column
         type(column_t), intent(in) :: column(*)
      end function kj_packer_new

      type(c_ptr) function kj_packer_rows(own) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: own
      end function kj_packer_rows

      integer(c_int) function kj_packer_write(own, before, n) bind(c)
         import :: c_ptr, c_size_t, c_int
         type(c_ptr), value, intent(in) :: own
         integer(c_size_t), value, intent(in) :: before, n
      end function kj_packer_write

      subroutine kj_packer_begin(own, before) bind(c)
         import :: c_ptr, c_size_t
         type(c_ptr), value, intent(in) :: own
         integer(c_size_t), value, intent(in) :: before
      end subroutine kj_packer_begin

      integer(c_int) function kj_packer_end(own) bind(c)
         import :: c_ptr, c_int
         type(c_ptr), value, intent(in) :: own
      end function kj_packer_end

      subroutine kj_packer_free(own) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: own
      end subroutine kj_packer_free
   end interface

   interface
      type(c_ptr) function kj_store_begin(file, h5, n_series, series, time, run, live) bind(c)
         import :: c_int, c_int64_t, c_size_t, c_ptr
         integer(c_int), value, intent(in) :: file, live
         integer(c_int64_t), value, intent(in) :: h5, run
         integer(c_size_t), value, intent(in) :: n_series, time
         integer(c_int64_t), intent(in) :: series(*)
      end function kj_store_begin

      integer(c_int) function kj_store_commit(store, rows) bind(c)
         import :: c_int, c_size_t, c_ptr
         type(c_ptr), value, intent(in) :: store
         integer(c_size_t), value, intent(in) :: rows
      end function kj_store_commit

      integer(c_int) function kj_store_finish(store, status, ended, elapsed, cycles, exit_code) &
         bind(c)
         import :: c_int, c_int64_t, c_double, c_ptr, c_char
         type(c_ptr), value, intent(in) :: store
         character(kind=c_char), intent(in) :: status(*), ended(*)
         real(c_double), value, intent(in) :: elapsed
         integer(c_int64_t), value, intent(in) :: cycles
         integer(c_int), value, intent(in) :: exit_code
      end function kj_store_finish

      subroutine kj_store_last(store) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: store
      end subroutine kj_store_last

      integer(c_int) function kj_clear_marks(path) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function kj_clear_marks

      integer(c_int) function kj_store_close(store) bind(c)
         import :: c_int, c_ptr
         type(c_ptr), value, intent(in) :: store
      end function kj_store_close
   end interface

contains

   !> Write the file that HDF5 holds in memory to an open, empty file
   subroutine begin_store(descriptor, file, series, time, run, live, store, error)
      integer, intent(in) :: descriptor          !! of the empty file; the store closes it
      integer(hid_t), intent(in) :: file         !! create_image's
      integer(int64), intent(in) :: series(:)    !! places of datasets over time, -1 = none
      integer, intent(in) :: time                !! which of them holds the time
      integer(int64), intent(in) :: run          !! that of the group that finish_store sets
      logical, intent(in) :: live                !! readers may follow it (SWMR)
      type(c_ptr), intent(out) :: store
      type(error_t), allocatable, intent(inout) :: error

      store = C_NULL_PTR
      if (allocated(error)) return
      store = kj_store_begin(int(descriptor, c_int), int(file, c_int64_t), &
         size(series, kind=c_size_t), series, int(time - 1, c_size_t), run, &
         merge(1_c_int, 0_c_int, live))
      if (.not. c_associated(store)) call fail(error, ERR_FILE, 'there is no room for a history')
   end subroutine begin_store

   !> From now on readers find n rows
   subroutine commit_rows(store, n, error)
      type(c_ptr), intent(in) :: store
      integer, intent(in) :: n
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (kj_store_commit(store, int(n, c_size_t)) < 0) &
         call fail(error, ERR_FILE, 'cannot write the index of the history')
   end subroutine commit_rows

   !> The rows that are written next are the last: they may stand where others stood a moment ago
   subroutine last_rows(store)
      type(c_ptr), intent(in) :: store

      call kj_store_last(store)
   end subroutine last_rows

   !> Tell the outcome of a run
   subroutine finish_store(store, status, ended, elapsed, cycles, exit_code, error)
      type(c_ptr), intent(in) :: store
      character(len=*), intent(in) :: status, ended
      real(wp), intent(in) :: elapsed            !! [s] of wall clock
      integer, intent(in) :: cycles, exit_code
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (kj_store_finish(store, status//c_null_char, ended//c_null_char, elapsed, &
         int(cycles, c_int64_t), int(exit_code, c_int)) < 0) &
         call fail(error, ERR_FILE, 'cannot write the outcome of the run')
   end subroutine finish_store

   !> Close the file, also after an error
   subroutine close_store(store, error)
      type(c_ptr), intent(inout) :: store        !! null afterwards
      type(error_t), allocatable, intent(inout) :: error

      if (.not. c_associated(store)) return
      if (kj_store_close(store) < 0 .and. .not. allocated(error)) &
         call fail(error, ERR_FILE, 'cannot close the history')
      store = C_NULL_PTR
   end subroutine close_store

   !> Take away the marks of a file that is open to be written, by which HDF5 refuses it
   subroutine clear_marks(path, marked, error)
      character(len=*), intent(in) :: path
      logical, intent(out) :: marked             !! it had them
      type(error_t), allocatable, intent(inout) :: error

      integer(c_int) :: status

      marked = .false.
      if (allocated(error)) return
      status = kj_clear_marks(path//c_null_char)
      marked = status > 0
      if (status < 0) call fail(error, ERR_FILE, 'cannot write '//path)
   end subroutine clear_marks

   !> Cut the variables of a history into columns of chunks. Errors: ERR_FILE without memory
   subroutine new_packer(history, store, n_chunk, exact, packer, error)
      type(history_t), intent(in) :: history
      type(c_ptr), intent(in) :: store           !! the file, its datasets as history%variable
      integer, intent(in) :: n_chunk             !! rows in a chunk
      logical, intent(in) :: exact               !! equal rows are equal bytes
      type(packer_t), intent(inout) :: packer
      type(error_t), allocatable, intent(inout) :: error

      type(column_t), allocatable :: column(:)   ! time last
      integer :: i, time

      call free_packer(packer)
      if (allocated(error)) return
      allocate (column(0))
      associate (v => history%variable)
         time = findloc(v%channel, CH_TIME, 1)
         do i = 1, size(v)
            if (i /= time) call add_columns(v(i), i, n_chunk, column)
         end do
         call add_columns(v(time), time, n_chunk, column)
      end associate
      packer%own = kj_packer_new(store, merge(1_c_int, 0_c_int, exact), &
         int(history%n_value, c_size_t), int(n_chunk, c_size_t), size(column, kind=c_size_t), &
         column)
      if (.not. c_associated(packer%own)) then
         call fail(error, ERR_FILE, 'no memory to pack a history')
         return
      end if
      call c_f_pointer(kj_packer_rows(packer%own), packer%buffer, [history%n_value, n_chunk])
   end subroutine new_packer

   !> Give back what a packer holds, when the thread in the background has ended
   subroutine free_packer(packer)
      type(packer_t), intent(inout) :: packer

      call kj_packer_free(packer%own)
      packer%own = C_NULL_PTR
      packer%buffer => null()
   end subroutine free_packer

   subroutine add_columns(variable, series, n_chunk, column)
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: series              !! number of the dataset
      integer, intent(in) :: n_chunk             !! rows in a chunk
      type(column_t), allocatable, intent(inout) :: column(:)

      type(column_t) :: new
      integer :: m, entity

      m = entities_in_chunk(variable, n_chunk)
      new%series = series - 1
      new%real = merge(1, 0, channels(variable%channel)%kind == AS_F64)
      new%size = STORED_BYTES(channels(variable%channel)%kind)
      new%n_full = m*variable%n_comp
      do entity = 0, variable%n_entity - 1, m
         new%part = entity/m
         new%first = variable%first - 1 + entity*variable%n_comp
         new%n = min(m, variable%n_entity - entity)*variable%n_comp
         column = [column, new]
      end do
   end subroutine add_columns

   !> The buffer is full: write it in the background and go on with the other. finish_background
   !> comes before the next of these.
   subroutine write_in_background(packer, before)
      type(packer_t), intent(inout) :: packer
      integer, intent(in) :: before              !! rows before the buffer

      call kj_packer_begin(packer%own, int(before, c_size_t))
      call c_f_pointer(kj_packer_rows(packer%own), packer%buffer, shape(packer%buffer))
   end subroutine write_in_background

   !> Wait until the chunk that went to the background is written. Errors: ERR_FILE
   subroutine finish_background(packer, before, error)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: before              !! rows before the chunk
      type(error_t), allocatable, intent(inout) :: error

      call check(kj_packer_end(packer%own), before, error)
   end subroutine finish_background

   !> Write the first n rows of the buffer; they can be written again, with more
   subroutine write_buffer(packer, before, n, error)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: before, n           !! rows written so far, whole chunks; rows
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      call check(kj_packer_write(packer%own, int(before, c_size_t), int(n, c_size_t)), before, &
         error)
   end subroutine write_buffer

   subroutine check(status, before, error)
      integer(c_int), intent(in) :: status       !! negative: a failure
      integer, intent(in) :: before              !! rows before those that were written
      type(error_t), allocatable, intent(inout) :: error

      if (status < 0 .and. .not. allocated(error)) &
         call fail(error, ERR_FILE, 'cannot write rows from '//str(before + 1))
   end subroutine check

end module kj_h5_store
