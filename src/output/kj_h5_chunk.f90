!> Rows into the chunks of datasets over time, each chunk packed here and written as it is: HDF5's
!> own filters take several times as long. A file cannot be told from one that they wrote but by
!> the length of its chunks.
module kj_h5_chunk
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_int32_t, c_int64_t, c_double, c_int8_t
   use hdf5, only: hid_t, hsize_t, h5dset_extent_f, H5P_DEFAULT_F
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_channels, only: channels, AS_F64, STORED_BYTES
   use kj_history, only: variable_t
   use kj_h5, only: check
   use kj_h5_layout, only: get_row_shape, entities_in_chunk
   implicit none
   private

   public :: packer_t, new_packer, write_rows

   integer, parameter :: SLOTS = 16              !! chunks that are packed before any is written
   integer, parameter :: LEAST_SHARED = 2**17    !! values in these that are worth threads

   !> The chunks of one dataset for some of its entities
   type :: column_t
      integer(hid_t) :: series = -1              !! the dataset
      logical :: real = .true.                   !! stored as reals
      integer :: bytes = 8                       !! of a stored value
      integer :: first = 1                       !! place of the first value in a row
      integer :: n = 1, n_full = 1               !! values a row: there are, a chunk has
      integer :: entity = 0                      !! the first, from 0
      integer, allocatable :: dims(:)            !! of a row of the dataset
   end type column_t

   !> Where each value of a row goes, and room to pack
   type :: packer_t
      private
      integer :: n_chunk = 1                     !! rows in a chunk
      type(column_t), allocatable :: column(:)   !! time last
      integer :: threads = 1
      logical :: exact = .false.                 !! equal rows are equal bytes
      integer(c_int8_t), allocatable :: packed(:, :), work(:, :)   !! of each slot, of each thread
      integer(c_size_t) :: length(SLOTS) = 0     !! bytes packed
   end type packer_t

   interface
      pure integer(c_size_t) function kj_chunk_bound(bytes) bind(c)
         import :: c_size_t
         integer(c_size_t), value, intent(in) :: bytes
      end function kj_chunk_bound

      pure integer(c_size_t) function kj_chunk_work(bytes) bind(c)
         import :: c_size_t
         integer(c_size_t), value, intent(in) :: bytes
      end function kj_chunk_work

      integer(c_size_t) function kj_pack_chunk(exact, real, size, n, n_full, rows, rows_full, &
         values, stride, work, packed) bind(c)
         import :: c_int, c_size_t, c_double, c_int8_t
         integer(c_int), value, intent(in) :: exact, real, size
         integer(c_size_t), value, intent(in) :: n, n_full, rows, rows_full, stride
         real(c_double), intent(in) :: values(*)
         integer(c_int8_t), intent(inout) :: work(*), packed(*)
      end function kj_pack_chunk

      !> HDF5 1.10 has it for C alone; offset in file order
      integer(c_int) function write_chunk(series, plist, filters, offset, length, bytes) &
         bind(c, name='H5Dwrite_chunk')
         import :: c_int, c_int32_t, c_int64_t, c_size_t, c_int8_t
         integer(c_int64_t), value, intent(in) :: series, plist
         integer(c_int32_t), value, intent(in) :: filters     !! bits of those that were left out
         integer(c_int64_t), intent(in) :: offset(*)
         integer(c_size_t), value, intent(in) :: length
         integer(c_int8_t), intent(in) :: bytes(*)
      end function write_chunk
   end interface

contains

   !> Cut the variables of a history into columns of chunks
   subroutine new_packer(variable, series, i_time, n_chunk, threads, exact, packer)
      type(variable_t), intent(in) :: variable(:)
      integer(hid_t), intent(in) :: series(:)    !! datasets of the variables, -1 = none
      integer, intent(in) :: i_time              !! the variable that is written last, 0 = none
      integer, intent(in) :: n_chunk             !! rows in a chunk
      integer, intent(in) :: threads
      logical, intent(in) :: exact               !! equal rows are equal bytes
      type(packer_t), intent(out) :: packer

      integer(c_size_t) :: most
      integer :: i

      packer%n_chunk = n_chunk
      packer%exact = exact
      packer%threads = max(1, min(threads, SLOTS))
      allocate (packer%column(0))
      do i = 1, size(variable)
         if (i /= i_time) call add_columns(variable(i), series(i), n_chunk, packer%column)
      end do
      if (i_time > 0) call add_columns(variable(i_time), series(i_time), n_chunk, packer%column)
      most = 1
      do i = 1, size(packer%column)
         most = max(most, int(packer%column(i)%n_full, c_size_t)*n_chunk*packer%column(i)%bytes)
      end do
      allocate (packer%packed(kj_chunk_bound(most), min(SLOTS, size(packer%column))))
      allocate (packer%work(kj_chunk_work(most), packer%threads))
   end subroutine new_packer

   subroutine add_columns(variable, series, n_chunk, column)
      type(variable_t), intent(in) :: variable
      integer(hid_t), intent(in) :: series
      integer, intent(in) :: n_chunk
      type(column_t), allocatable, intent(inout) :: column(:)

      type(column_t), allocatable :: longer(:)
      type(column_t) :: new
      integer :: m, n

      if (series < 0) return
      m = entities_in_chunk(variable, n_chunk)
      new%series = series
      new%real = channels(variable%channel)%kind == AS_F64
      new%bytes = STORED_BYTES(channels(variable%channel)%kind)
      new%n_full = m*variable%n_comp
      call get_row_shape(variable, new%dims)
      do while (new%entity < variable%n_entity)
         new%first = variable%first + new%entity*variable%n_comp
         new%n = min(m, variable%n_entity - new%entity)*variable%n_comp
         n = size(column)
         allocate (longer(n + 1))
         longer(:n) = column
         longer(n + 1) = new
         call move_alloc(longer, column)
         new%entity = new%entity + m
      end do
   end subroutine add_columns

   !> Write up to a chunk of rows, the first of them the first of a chunk; the datasets end with
   !> them. The rest of the chunk is written as 0 and can be written again.
   subroutine write_rows(packer, before, n_value, n, rows, error)
      type(packer_t), intent(inout) :: packer
      integer, intent(in) :: before              !! rows written so far, whole chunks
      integer, intent(in) :: n_value, n          !! values in a row, rows
      real(wp), intent(in) :: rows(n_value, n)
      type(error_t), allocatable, intent(inout) :: error

      integer :: first, last, i

      do first = 1, size(packer%column), SLOTS
         if (allocated(error)) return
         last = min(first + SLOTS - 1, size(packer%column))
         call pack_some(packer, first, last, n_value, n, rows)
         do i = first, last
            call write_packed(packer, i, i - first + 1, before, n, error)
         end do
      end do
   end subroutine write_rows

   !> Pack the next chunk of some columns into the slots
   subroutine pack_some(packer, first, last, n_value, n, rows)
      !$ use omp_lib, only: omp_get_thread_num
      type(packer_t), intent(inout) :: packer
      integer, intent(in) :: first, last, n_value, n
      real(wp), intent(in) :: rows(n_value, n)

      integer :: i, thread

      !$omp parallel do default(none) shared(packer, first, last, n_value, n, rows) &
      !$omp private(thread) schedule(dynamic) num_threads(packer%threads) &
      !$omp if(sum(packer%column(first:last)%n)*n > LEAST_SHARED)
      do i = first, last
         thread = 1
         !$ thread = omp_get_thread_num() + 1
         associate (c => packer%column(i), slot => i - first + 1)
            packer%length(slot) = kj_pack_chunk(merge(1_c_int, 0_c_int, packer%exact), &
               merge(1_c_int, 0_c_int, c%real), &
               int(c%bytes, c_int), int(c%n, c_size_t), int(c%n_full, c_size_t), &
               int(n, c_size_t), int(packer%n_chunk, c_size_t), rows(c%first, 1), &
               int(n_value, c_size_t), packer%work(:, thread), packer%packed(:, slot))
         end associate
      end do
      !$omp end parallel do
   end subroutine pack_some

   !> Write the chunk in a slot to the dataset of its column, whose first chunk makes it longer
   subroutine write_packed(packer, i, slot, before, n, error)
      type(packer_t), intent(in) :: packer
      integer, intent(in) :: i, slot             !! column, slot
      integer, intent(in) :: before, n           !! rows before the chunk, rows in it
      type(error_t), allocatable, intent(inout) :: error

      integer(hsize_t), allocatable :: extent(:)
      integer(c_int64_t), allocatable :: offset(:)
      integer :: status

      if (allocated(error)) return
      associate (c => packer%column(i))
         extent = [int(c%dims, hsize_t), int(before + n, hsize_t)]
         allocate (offset(size(extent)), source=0_c_int64_t)
         offset(1) = before
         if (size(c%dims) > 0) offset(2) = c%entity
         status = 0
         if (c%entity == 0) call h5dset_extent_f(c%series, extent, status)
         if (packer%length(slot) == 0) status = -1
         if (status >= 0) status = write_chunk(int(c%series, c_int64_t), &
            int(H5P_DEFAULT_F, c_int64_t), 0_c_int32_t, offset, packer%length(slot), &
            packer%packed(:, slot))
      end associate
      call check(status, 'write rows from '//str(before + 1), error)
   end subroutine write_packed

end module kj_h5_chunk
