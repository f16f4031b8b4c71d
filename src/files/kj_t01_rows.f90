!> Rows of a Radioss time-history file: where they begin, how many there are, blocks of them.
module kj_t01_rows
   use, intrinsic :: iso_fortran_env, only: int8, int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_t01_bytes, only: read_bytes, seek_bytes, byte_position, is_plain
   use kj_t01_text, only: read_descriptor, read_text_reals, skip_text_reals
   use kj_t01_file, only: t01_file_t, decode_reals, decode_length, broken, MARK
   implicit none
   private

   public :: t01_rows_t, find_t01_rows, read_t01_block

   integer, parameter :: BLOCK = 2**20      !! bytes of rows in memory at a time, about

   !> Where the rows are and what they look like
   type :: t01_rows_t
      integer, allocatable :: n_real(:)     !! reals of each record of a row, no empty records
      integer :: n_row = 0                  !! complete rows
      logical :: cut_off = .false.          !! bytes of one more row follow
      integer(int64) :: first_byte = 0      !! place of the first row
      integer(int64) :: row_bytes = 0       !! framed form only
      integer :: next_row = 1               !! text form: the row that is read next
   end type t01_rows_t

contains

   !> Find the rows behind the header
   !>
   !> The file itself says how long a record is that we do not use: that of fluid sections is longer
   !> than the header announces.
   !> Errors: ERR_FILE when a record we use is not as announced.
   subroutine find_t01_rows(file, announced, used, rows, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: announced(:)      !! reals of each record by the header
      logical, intent(in) :: used(:)           !! it must be so
      type(t01_rows_t), intent(out) :: rows
      type(error_t), allocatable, intent(out) :: error

      logical :: ok

      rows%first_byte = byte_position(file%bytes)
      rows%n_real = pack(announced, announced > 0)
      call measure_first_row(file, pack(used, announced > 0), rows%n_real, error)
      call seek_bytes(file%bytes, rows%first_byte, ok)
      if (allocated(error)) return
      rows%row_bytes = sum(int(rows%n_real, int64)*file%word + 2*MARK)
      if (file%is_text) then
         call count_text_rows(file, rows, error)
      else
         call count_rows(file, rows, error)
      end if
      call seek_bytes(file%bytes, rows%first_byte, ok)
      if (.not. ok .and. .not. allocated(error)) &
         call broken(file, 'its rows cannot be reached', error)
   end subroutine find_t01_rows

   !> Lengths of the records in the first row as far as the file goes
   subroutine measure_first_row(file, used, n_real, error)
      type(t01_file_t), intent(inout) :: file
      logical, intent(in) :: used(:)
      integer, intent(inout) :: n_real(:)       !! as announced, then as found
      type(error_t), allocatable, intent(out) :: error

      integer :: i, found
      logical :: ok

      do i = 1, size(n_real)
         call find_length(file, n_real(i), found, ok)
         if (found < 0) return
         if (.not. ok .or. (used(i) .and. found /= n_real(i))) then
            call broken(file, 'record '//str(i)//' of its first row is not as announced', error)
            return
         end if
         n_real(i) = found
      end do
   end subroutine measure_first_row

   !> Reals of the record that begins here, and go behind it; -1 where the file ends
   subroutine find_length(file, announced, found, ok)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: announced
      integer, intent(out) :: found
      logical, intent(out) :: ok                !! it can be a record

      integer(int8) :: head(MARK)
      integer :: n

      found = -1
      if (file%is_text) then
         call read_descriptor(file%bytes, 'R', found)
         ok = found > 0
         if (ok) call skip_text_reals(file%bytes, found, ok)
         if (.not. ok .and. found == announced) found = -1
         return
      end if
      call read_bytes(file%bytes, head, n)
      ok = n == MARK
      if (.not. ok) return
      found = decode_length(file, head)
      ok = found > 0 .and. mod(found, file%word) == 0
      if (ok) call seek_bytes(file%bytes, byte_position(file%bytes) + found + MARK, ok)
      found = max(found/file%word, 0)
   end subroutine find_length

   !> Rows of the framed form, from the number of bytes
   subroutine count_rows(file, rows, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      type(error_t), allocatable, intent(out) :: error

      integer(int64) :: total
      integer(int8), allocatable :: bytes(:)
      integer :: n

      if (is_plain(file%bytes)) then
         inquire (file=file%path, size=total)
         total = total - rows%first_byte
      else
         allocate (bytes(BLOCK))
         total = 0
         do
            call read_bytes(file%bytes, bytes, n)
            if (n < 0) call broken(file, 'it cannot be unpacked', error)
            if (n <= 0) exit
            total = total + n
         end do
      end if
      rows%n_row = int(min(total/rows%row_bytes, int(huge(1), int64)))
      rows%cut_off = total > rows%n_row*rows%row_bytes
   end subroutine count_rows

   !> Rows of the text form, counted line by line; damage before the end is an error
   subroutine count_text_rows(file, rows, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      type(error_t), allocatable, intent(out) :: error

      integer(int8) :: byte(1)
      integer :: n
      logical :: ok

      do
         call read_bytes(file%bytes, byte, n)
         if (n < 1) return
         call seek_bytes(file%bytes, byte_position(file%bytes) - 1, ok)
         call skip_text_row(file, rows, ok)
         if (.not. ok) exit
         rows%n_row = rows%n_row + 1
      end do
      rows%cut_off = .true.
      call read_bytes(file%bytes, byte, n)
      if (n > 0) call broken(file, 'row '//str(rows%n_row + 1)//' is not as announced', error)
   end subroutine count_text_rows

   subroutine skip_text_row(file, rows, ok)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(in) :: rows
      logical, intent(out) :: ok

      integer :: i, n

      do i = 1, size(rows%n_real)
         call read_descriptor(file%bytes, 'R', n)
         ok = n == rows%n_real(i)
         if (ok) call skip_text_reals(file%bytes, n, ok)
         if (.not. ok) return
      end do
   end subroutine skip_text_row

   !> Read rows first ... first + n - 1, the records of a row behind one another
   !>
   !> n may be less than asked for: `values` decides how many fit in memory at a time.
   !> Errors: ERR_FILE when a row is damaged.
   subroutine read_t01_block(file, rows, first, most, values, n, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      integer, intent(in) :: first, most                   !! first row; rows wanted
      real(wp), allocatable, intent(inout) :: values(:, :)    !! (sum(n_real), >= n), kept for reuse
      integer, intent(out) :: n                            !! rows read
      type(error_t), allocatable, intent(out) :: error

      integer :: fit, i

      fit = int(max(1_int64, BLOCK/rows%row_bytes))
      if (.not. allocated(values)) allocate (values(sum(rows%n_real), fit))
      n = min(most, fit)
      if (file%is_text) then
         call go_to_text_row(file, rows, first, error)
         do i = 1, n
            if (.not. allocated(error)) call read_text_row(file, rows, values(:, i), error)
         end do
      else
         call read_framed_rows(file, rows, first, n, values, error)
      end if
   end subroutine read_t01_block

   !> Framed rows, with a check of the lengths around every record
   subroutine read_framed_rows(file, rows, first, n, values, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(in) :: rows
      integer, intent(in) :: first, n
      real(wp), intent(inout) :: values(:, :)
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: bytes(:)
      integer(int64) :: at
      integer :: i, j, k, v, length, got
      logical :: ok

      at = rows%first_byte + (first - 1)*rows%row_bytes
      allocate (bytes(n*rows%row_bytes))
      call seek_bytes(file%bytes, at, ok)
      got = -1
      if (ok) call read_bytes(file%bytes, bytes, got)
      if (got < size(bytes)) then
         call broken(file, 'row '//str(first)//' cannot be read', error)
         return
      end if
      k = 0
      do i = 1, n
         v = 0
         do j = 1, size(rows%n_real)
            length = rows%n_real(j)*file%word
            if (decode_length(file, bytes(k + 1:k + MARK)) /= length .or. &
               decode_length(file, bytes(k + MARK + length + 1:k + 2*MARK + length)) /= length) then
               call broken(file, 'row '//str(first + i - 1)//' is not as announced', error)
               return
            end if
            call decode_reals(file, bytes(k + MARK + 1:k + MARK + length), &
               values(v + 1:v + rows%n_real(j), i))
            k = k + length + 2*MARK
            v = v + rows%n_real(j)
         end do
      end do
   end subroutine read_framed_rows

   !> Text rows have no places: go on from the last one, or from the first row
   subroutine go_to_text_row(file, rows, row, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      integer, intent(in) :: row
      type(error_t), allocatable, intent(out) :: error

      logical :: ok

      ok = .true.
      if (row < rows%next_row) then
         call seek_bytes(file%bytes, rows%first_byte, ok)
         rows%next_row = 1
      end if
      do while (ok .and. rows%next_row < row)
         call skip_text_row(file, rows, ok)
         rows%next_row = rows%next_row + 1
      end do
      if (.not. ok) call broken(file, 'row '//str(row)//' cannot be reached', error)
   end subroutine go_to_text_row

   subroutine read_text_row(file, rows, values, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_rows_t), intent(inout) :: rows
      real(wp), intent(inout) :: values(:)
      type(error_t), allocatable, intent(out) :: error

      integer :: j, n, v
      logical :: ok

      v = 0
      do j = 1, size(rows%n_real)
         call read_descriptor(file%bytes, 'R', n)
         ok = n == rows%n_real(j)
         if (ok) call read_text_reals(file%bytes, values(v + 1:v + n), ok)
         if (.not. ok) then
            call broken(file, 'a number in row '//str(rows%next_row)//' cannot be read', error)
            return
         end if
         v = v + n
      end do
      rows%next_row = rows%next_row + 1
   end subroutine read_text_row

end module kj_t01_rows
