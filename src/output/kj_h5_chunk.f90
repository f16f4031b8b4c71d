!> Rows into the chunks of datasets over time, each chunk packed here and written as it is: HDF5's
!> own filters take several times as long. A file cannot be told from one that they wrote but by
!> the length of its chunks.
module kj_h5_chunk
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_int32_t, c_int64_t, c_double, c_ptr, &
      C_NULL_PTR, c_associated, c_f_pointer
   use hdf5, only: hid_t, hsize_t, h5dset_extent_f, H5P_DEFAULT_F
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_channels, only: channels, AS_F64, STORED_BYTES, CH_TIME
   use kj_history, only: history_t, variable_t
   use kj_h5, only: check
   use kj_h5_layout, only: get_row_shape, entities_in_chunk
   implicit none
   private

   public :: packer_t, new_packer, free_packer, find_row, pack_in_background, write_background, &
      write_buffer, write_rows

   integer, parameter :: MOST_AT_ONCE = 16       !! columns packed before any is written: big rows
   integer, parameter :: LEAST_SHARED = 2**17    !! values in these that are worth threads

   !> The chunks of one dataset for some of its entities
   type :: column_t
      integer(hid_t) :: series = -1              !! the dataset
      integer :: entity = 0                      !! the first, from 0
      integer, allocatable :: dims(:)            !! of a row of the dataset
   end type column_t

   !> What packs them: values of a row that go to one chunk, as kj_packer.c has it
   type, bind(c) :: slice_t
      integer(c_int) :: real = 1, size = 8       !! stored: as a real, bytes
      integer(c_size_t) :: first = 0             !! from 0
      integer(c_size_t) :: n = 1, n_full = 1     !! values that there are, that a chunk has
   end type slice_t

   !> Where each value of a row goes, and room to pack
   type :: packer_t
      private
      integer :: n_chunk = 1, n_value = 0        !! rows in a chunk, values in a row
      type(column_t), allocatable :: column(:)   !! time last
      type(slice_t), allocatable :: slice(:)     !! of each column
      integer :: group = 1                       !! columns that are packed before any is written
      integer :: threads = 1
      type(c_ptr) :: own = C_NULL_PTR            !! what the thread in the background may touch
      real(wp), pointer, contiguous :: buffer(:, :) => null()   !! of it, (n_value, n_chunk)
   end type packer_t

   interface
      type(c_ptr) function kj_packer_new(exact, n_value, rows_full, group, threads, n_column, &
         column) bind(c)
         import :: c_int, c_size_t, c_ptr, slice_t
         integer(c_int), value, intent(in) :: exact
         integer(c_size_t), value, intent(in) :: n_value, rows_full, group, threads, n_column
         type(slice_t), intent(in) :: column(*)
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

      type(c_ptr) function kj_packer_packed(own, i, length) bind(c)
         import :: c_ptr, c_size_t
         type(c_ptr), value, intent(in) :: own
         integer(c_size_t), value, intent(in) :: i
         integer(c_size_t), intent(out) :: length
      end function kj_packer_packed

      subroutine kj_packer_begin(own) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: own
      end subroutine kj_packer_begin

      subroutine kj_packer_end(own) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: own
      end subroutine kj_packer_end

      subroutine kj_packer_free(own) bind(c)
         import :: c_ptr
         type(c_ptr), value, intent(in) :: own
      end subroutine kj_packer_free

      !> HDF5 1.10 has it for C alone; offset in file order
      integer(c_int) function write_chunk(series, plist, filters, offset, length, bytes) &
         bind(c, name='H5Dwrite_chunk')
         import :: c_int, c_int32_t, c_int64_t, c_size_t, c_ptr
         integer(c_int64_t), value, intent(in) :: series, plist
         integer(c_int32_t), value, intent(in) :: filters     !! bits of those that were left out
         integer(c_int64_t), intent(in) :: offset(*)
         integer(c_size_t), value, intent(in) :: length
         type(c_ptr), value, intent(in) :: bytes
      end function write_chunk
   end interface

contains

   !> Cut the variables of a history into columns of chunks. Errors: ERR_FILE without memory
   subroutine new_packer(history, series, n_chunk, threads, exact, packer, error)
      type(history_t), intent(in) :: history
      integer(hid_t), intent(in) :: series(:)    !! datasets of the variables, -1 = none
      integer, intent(in) :: n_chunk             !! rows in a chunk
      integer, intent(in) :: threads             !! that pack rows which are a chunk each
      logical, intent(in) :: exact               !! equal rows are equal bytes
      type(packer_t), intent(inout) :: packer
      type(error_t), allocatable, intent(inout) :: error

      integer :: i

      call free_packer(packer)
      packer%n_chunk = n_chunk
      packer%n_value = history%n_value
      allocate (packer%column(0), packer%slice(0))
      associate (v => history%variable)
         do i = 1, size(v)
            if (v(i)%channel /= CH_TIME) call add_columns(v(i), series(i), packer)
         end do
         do i = 1, size(v)
            if (v(i)%channel == CH_TIME) call add_columns(v(i), series(i), packer)
         end do
      end associate
      packer%group = max(1, size(packer%column))
      packer%threads = 1
      if (n_chunk == 1) then
         packer%group = min(packer%group, MOST_AT_ONCE)
         packer%threads = max(1, min(threads, packer%group))
      end if
      packer%own = kj_packer_new(merge(1_c_int, 0_c_int, exact), &
         int(history%n_value, c_size_t), int(n_chunk, c_size_t), int(packer%group, c_size_t), &
         int(packer%threads, c_size_t), size(packer%slice, kind=c_size_t), packer%slice)
      if (.not. c_associated(packer%own)) then
         if (.not. allocated(error)) call fail(error, ERR_FILE, 'no memory to pack a history')
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
      if (allocated(packer%column)) deallocate (packer%column, packer%slice)
   end subroutine free_packer

   !> The buffer that is to be filled
   subroutine find_buffer(packer)
      type(packer_t), intent(inout) :: packer

      call c_f_pointer(kj_packer_rows(packer%own), packer%buffer, [packer%n_value, packer%n_chunk])
   end subroutine find_buffer

   subroutine add_columns(variable, series, packer)
      type(variable_t), intent(in) :: variable
      integer(hid_t), intent(in) :: series
      type(packer_t), intent(inout) :: packer

      type(column_t) :: new
      type(slice_t) :: slice
      type(column_t), allocatable :: longer(:)
      integer :: m, n

      if (series < 0) return
      m = entities_in_chunk(variable, packer%n_chunk)
      new%series = series
      call get_row_shape(variable, new%dims)
      slice%real = merge(1, 0, channels(variable%channel)%kind == AS_F64)
      slice%size = STORED_BYTES(channels(variable%channel)%kind)
      slice%n_full = m*variable%n_comp
      do while (new%entity < variable%n_entity)
         slice%first = variable%first - 1 + new%entity*variable%n_comp
         slice%n = min(m, variable%n_entity - new%entity)*variable%n_comp
         n = size(packer%column)
         allocate (longer(n + 1))
         longer(:n) = packer%column
         longer(n + 1) = new
         call move_alloc(longer, packer%column)
         packer%slice = [packer%slice, slice]
         new%entity = new%entity + m
      end do
   end subroutine add_columns

   !> Where row i of the buffer is written
   subroutine find_row(packer, i, row)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: i
      real(wp), pointer, contiguous, intent(out) :: row(:)

      row => packer%buffer(:, i)
   end subroutine find_row

   !> The buffer is full: pack it in the background and go on with the other. write_background comes
   !> before the next of these.
   subroutine pack_in_background(packer)
      type(packer_t), intent(inout) :: packer

      call kj_packer_begin(packer%own)
      call find_buffer(packer)
   end subroutine pack_in_background

   !> Write the chunk that was packed in the background
   subroutine write_background(packer, before, error)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: before              !! rows written so far
      type(error_t), allocatable, intent(inout) :: error

      integer :: i

      call kj_packer_end(packer%own)
      do i = 1, size(packer%column)
         call write_packed(packer, i, before, packer%n_chunk, error)
      end do
   end subroutine write_background

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
            call write_packed(packer, i, before, n, error)
         end do
      end do
   end subroutine write_rows

   !> Pack the next chunk of some columns
   subroutine pack_some(packer, first, last, n, rows)
      !$ use omp_lib, only: omp_get_thread_num
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: first, last, n
      real(wp), intent(in) :: rows(packer%n_value, n)

      integer :: i, thread

      !$omp parallel do default(none) shared(packer, first, last, n, rows) private(thread) &
      !$omp schedule(dynamic) num_threads(packer%threads) &
      !$omp if(sum(packer%slice(first:last)%n)*n > LEAST_SHARED)
      do i = first, last
         thread = 0
         !$ thread = omp_get_thread_num()
         call kj_packer_column(packer%own, int(i - 1, c_size_t), int(thread, c_size_t), &
            int(n, c_size_t), rows)
      end do
      !$omp end parallel do
   end subroutine pack_some

   !> Write the packed chunk of a column, whose first chunk makes the dataset longer
   subroutine write_packed(packer, i, before, n, error)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: i                   !! column
      integer, intent(in) :: before, n           !! rows before the chunk, rows in it
      type(error_t), allocatable, intent(inout) :: error

      integer(hsize_t), allocatable :: extent(:)
      integer(c_int64_t), allocatable :: offset(:)
      integer(c_size_t) :: length
      type(c_ptr) :: bytes
      integer :: status

      if (allocated(error)) return
      bytes = kj_packer_packed(packer%own, int(i - 1, c_size_t), length)
      associate (c => packer%column(i))
         extent = [int(c%dims, hsize_t), int(before + n, hsize_t)]
         allocate (offset(size(extent)), source=0_c_int64_t)
         offset(1) = before
         if (size(c%dims) > 0) offset(2) = c%entity
         status = 0
         if (c%entity == 0) call h5dset_extent_f(c%series, extent, status)
         if (length == 0) status = -1
         if (status >= 0) status = write_chunk(int(c%series, c_int64_t), &
            int(H5P_DEFAULT_F, c_int64_t), 0_c_int32_t, offset, length, bytes)
      end associate
      call check(status, 'write rows from '//str(before + 1), error)
   end subroutine write_packed

end module kj_h5_chunk
