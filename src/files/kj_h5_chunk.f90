!> Rows into the chunks of datasets over time, each chunk packed here: HDF5's own filters take
!> several times as long. A file cannot be told from one that they wrote but by the length of its
!> chunks.
module kj_h5_chunk
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_ptr, C_NULL_PTR, c_associated, &
      c_f_pointer
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_channels, only: channels, AS_F64, STORED_BYTES, CH_TIME
   use kj_history, only: history_t, variable_t
   use kj_h5_layout, only: entities_in_chunk
   implicit none
   private

   public :: packer_t, new_packer, free_packer, write_in_background, finish_background, write_buffer

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

contains

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

end module kj_h5_chunk
