!> A history file under way, which is readable after every single write (kj_store.c). HDF5 makes it
!> in memory, complete but for its rows, and has no part in it afterwards.
module kj_h5_store
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_size_t, c_double, c_char, c_ptr, &
      C_NULL_PTR, c_associated, c_null_char
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_h5, only: hid_t
   implicit none
   private

   public :: begin_store, commit_rows, last_rows, finish_store, close_store, &
      clear_marks

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
      integer(hid_t), intent(in) :: series(:)    !! datasets over time, -1 = none
      integer, intent(in) :: time                !! which of them holds the time
      integer(hid_t), intent(in) :: run          !! the group whose attributes finish_store sets
      logical, intent(in) :: live                !! readers may follow it (SWMR)
      type(c_ptr), intent(out) :: store
      type(error_t), allocatable, intent(inout) :: error

      store = C_NULL_PTR
      if (allocated(error)) return
      store = kj_store_begin(int(descriptor, c_int), int(file, c_int64_t), &
         size(series, kind=c_size_t), int(series, c_int64_t), int(time - 1, c_size_t), &
         int(run, c_int64_t), merge(1_c_int, 0_c_int, live))
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

end module kj_h5_store
