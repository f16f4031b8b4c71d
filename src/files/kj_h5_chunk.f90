!> Rows into the chunks of datasets over time, each chunk packed here: HDF5's own filters take
!> several times as long. A file cannot be told from one that they wrote but by the length of its
!> chunks.
module kj_h5_chunk
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_double, c_ptr, C_NULL_PTR, &
      c_associated, c_f_pointer
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_channels, only: channels, AS_F64, STORED_BYTES, CH_TIME
   use kj_history, only: history_t, variable_t
   use kj_h5_layout, only: entities_in_chunk
   implicit none
   private

   public :: packer_t, new_packer, free_packer, find_row, pack_in_background, finish_background, &
      write_buffer, write_rows

   integer, parameter :: MOST_AT_ONCE = 16       !! columns packed before any is written: big rows
   integer, parameter :: LEAST_SHARED = 2**17    !! values in these that are worth threads

   !> Values of a row that go to one chunk, as kj_packer.c has it
   type, bind(c) :: column_t
      integer(c_size_t) :: series = 0            !! the dataset, from 0
      integer(c_size_t) :: part = 0              !! which chunk of a row, from 0
      integer(c_size_t) :: first = 0             !! from 0
      integer(c_size_t) :: n = 1, n_full = 1     !! values that there are, that a chunk has
      integer(c_int) :: real = 1, size = 8       !! stored: as a real, bytes
   end type column_t

   !> Where each value of a row goes, and room to pack
   type :: packer_t
      private
      integer :: n_chunk = 1, n_value = 0        !! rows in a chunk, values in a row
      type(column_t), allocatable :: column(:)   !! time last
      integer :: group = 1                       !! columns that are packed before any is written
      integer :: threads = 1
      type(c_ptr) :: own = C_NULL_PTR            !! what the thread in the background may touch
      real(wp), pointer, contiguous :: buffer(:, :) => null()   !! of it, (n_value, n_chunk)
   end type packer_t

   interface
      type(c_ptr) function kj_packer_new(store, exact, n_value, rows_full, group, threads, &
         n_column, column) bind(c)
         import :: c_int, c_size_t, c_ptr, column_t
         type(c_ptr), value, intent(in) :: store
         integer(c_int), value, intent(in) :: exact
         integer(c_size_t), value, intent(in) :: n_value, rows_full, group, threads, n_column
         type(column_t), intent(in) :: column(*)
      end function kj_packer_new

      type(c_ptr) function kj_packer_rows(own) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: own
      end function kj_packer_rows

      subroutine kj_packer_column(own, i, thread, n, rows) bind(c)
         import :: c_ptr, c_size_t, c_double
         type(c_ptr), value, intent(in) :: own
         integer(c_size_t), value, intent(in) :: i, thread, n
         real(c_double), intent(in) :: rows(*)
      end subroutine kj_packer_column

      integer(c_int) function kj_packer_write(own, i, before) bind(c)
         import :: c_ptr, c_size_t, c_int
         type(c_ptr), value, intent(in) :: own
         integer(c_size_t), value, intent(in) :: i, before
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

contains

   !> Cut the variables of a history into columns of chunks. Errors: ERR_FILE without memory
   subroutine new_packer(history, store, n_chunk, threads, exact, packer, error)
      type(history_t), intent(in) :: history
      type(c_ptr), intent(in) :: store           !! the file, its datasets as history%variable
      integer, intent(in) :: n_chunk             !! rows in a chunk
      integer, intent(in) :: threads             !! that pack rows which are a chunk each
      logical, intent(in) :: exact               !! equal rows are equal bytes
      type(packer_t), intent(inout) :: packer
      type(error_t), allocatable, intent(inout) :: error

      integer :: i

      call free_packer(packer)
      packer%n_chunk = n_chunk
      packer%n_value = history%n_value
      allocate (packer%column(0))
      associate (v => history%variable)
         do i = 1, size(v)
            if (v(i)%channel /= CH_TIME) call add_columns(v(i), i, packer)
         end do
         do i = 1, size(v)
            if (v(i)%channel == CH_TIME) call add_columns(v(i), i, packer)
         end do
      end associate
      packer%group = max(1, size(packer%column))
      packer%threads = 1
      if (allocated(error)) return
      if (n_chunk == 1) then
         packer%group = min(packer%group, MOST_AT_ONCE)
         packer%threads = max(1, min(threads, packer%group))
      end if
      packer%own = kj_packer_new(store, merge(1_c_int, 0_c_int, exact), &
         int(history%n_value, c_size_t), int(n_chunk, c_size_t), int(packer%group, c_size_t), &
         int(packer%threads, c_size_t), size(packer%column, kind=c_size_t), packer%column)
      if (.not. c_associated(packer%own)) then
         call fail(error, ERR_FILE, 'no memory to pack a history')
         return
      end if
      if (n_chunk > 1) call find_buffer(packer)
   end subroutine new_packer

   !> Give back what a packer holds, when the thread in the background has ended
   subroutine free_packer(packer)
      type(packer_t), intent(inout) :: packer

      call kj_packer_free(packer%own)
      packer%own = C_NULL_PTR
      packer%buffer => null()
      if (allocated(packer%column)) deallocate (packer%column)
   end subroutine free_packer

   !> The buffer that is to be filled
   subroutine find_buffer(packer)
      type(packer_t), intent(inout) :: packer

      call c_f_pointer(kj_packer_rows(packer%own), packer%buffer, [packer%n_value, packer%n_chunk])
   end subroutine find_buffer

   subroutine add_columns(variable, series, packer)
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: series              !! number of the dataset
      type(packer_t), intent(inout) :: packer

      type(column_t) :: new
      integer :: m, entity

      m = entities_in_chunk(variable, packer%n_chunk)
      new%series = series - 1
      new%real = merge(1, 0, channels(variable%channel)%kind == AS_F64)
      new%size = STORED_BYTES(channels(variable%channel)%kind)
      new%n_full = m*variable%n_comp
      do entity = 0, variable%n_entity - 1, m
         new%part = entity/m
         new%first = variable%first - 1 + entity*variable%n_comp
         new%n = min(m, variable%n_entity - entity)*variable%n_comp
         packer%column = [packer%column, new]
      end do
   end subroutine add_columns

   !> Where row i of the buffer is written
   subroutine find_row(packer, i, row)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: i
      real(wp), pointer, contiguous, intent(out) :: row(:)

      row => packer%buffer(:, i)
   end subroutine find_row

   !> The buffer is full: pack it in the background and go on with the other. finish_background
   !> comes before the next of these.
   subroutine pack_in_background(packer, before)
      type(packer_t), intent(inout) :: packer
      integer, intent(in) :: before              !! rows before the buffer

      call kj_packer_begin(packer%own, int(before, c_size_t))
      call find_buffer(packer)
   end subroutine pack_in_background

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
      integer, intent(in) :: before, n           !! rows written so far, rows
      type(error_t), allocatable, intent(inout) :: error

      call write_rows(packer, before, n, packer%buffer, error)
   end subroutine write_buffer

   !> Write up to a chunk of rows, the first of them the first of a chunk; the datasets end with
   !> them. The rest of the chunk is written as 0 and can be written again.
   subroutine write_rows(packer, before, n, rows, error)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: before              !! rows written so far, whole chunks
      integer, intent(in) :: n                   !! rows
      real(wp), intent(in) :: rows(packer%n_value, n)
      type(error_t), allocatable, intent(inout) :: error

      integer :: first, last, i

      do first = 1, size(packer%column), packer%group
         if (allocated(error)) return
         last = min(first + packer%group - 1, size(packer%column))
         call pack_some(packer, first, last, n, rows)
         do i = first, last
            if (allocated(error)) return
            call check(kj_packer_write(packer%own, int(i - 1, c_size_t), int(before, c_size_t)), &
               before, error)
         end do
      end do
   end subroutine write_rows

   subroutine check(status, before, error)
      integer(c_int), intent(in) :: status       !! negative: a failure
      integer, intent(in) :: before              !! rows before those that were written
      type(error_t), allocatable, intent(inout) :: error

      if (status < 0 .and. .not. allocated(error)) &
         call fail(error, ERR_FILE, 'cannot write rows from '//str(before + 1))
   end subroutine check

   !> Pack the next chunk of some columns
   subroutine pack_some(packer, first, last, n, rows)
      !$ use omp_lib, only: omp_get_thread_num
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: first, last, n
      real(wp), intent(in) :: rows(packer%n_value, n)

      integer :: i, thread

      !$omp parallel do default(none) shared(packer, first, last, n, rows) private(thread) &
      !$omp schedule(dynamic) num_threads(packer%threads) &
      !$omp if(sum(packer%column(first:last)%n)*n > LEAST_SHARED)
      do i = first, last
         thread = 0
         !$ thread = omp_get_thread_num()
         call kj_packer_column(packer%own, int(i - 1, c_size_t), int(thread, c_size_t), &
            int(n, c_size_t), rows)
      end do
      !$omp end parallel do
   end subroutine pack_some

end module kj_h5_chunk
