!> What a Radioss time-history file holds: the header, which says what stands in its rows and in
!> which order; where the rows begin, how many there are, blocks of them.
!> One file: the rows are laid out as the header says.
module kj_t01_content
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_text, only: text_t
   use kj_t01_file, only: t01_file_t, read_record, read_real_record, skip_record, broken, &
      decode_reals, decode_length, MARK, read_descriptor, read_text_reals, skip_text_reals
   use, intrinsic :: iso_fortran_env, only: int8, int64
   use kj_t01_bytes, only: read_bytes, seek_bytes, byte_position, is_plain
   implicit none
   private

   public :: t01_header_t, t01_group_t, read_t01_header, t01_rows_t, find_t01_rows, read_t01_block

   !> One /TH request: the same variables of some objects
   type :: t01_group_t
      integer :: type = 0                        !! type code: 0 node, 6 spring, 103 body, ...
      integer, allocatable :: object(:)          !! user ids, in the order of the rows
      type(text_t), allocatable :: name(:)       !! their names
      integer, allocatable :: code(:)            !! codes of the variables
   end type t01_group_t

   !> What stands before the rows
   type :: t01_header_t
      character(len=:), allocatable :: title     !! of the deck
      character(len=:), allocatable :: origin    !! date, program and machine
      logical :: has_units = .false.
      real(wp) :: si(3) = 1.0_wp                 !! SI value of the units of mass, length and time
      integer, allocatable :: global_code(:)
      integer, allocatable :: part_code(:), subset_code(:)    !! each once
      integer :: n_part_value = 0, n_subset_value = 0         !! reals of all parts, all subsets
      type(t01_group_t), allocatable :: group(:)
   end type t01_header_t

   integer, parameter :: HEAD_TEXT = 80   !! characters of the first two records

   !> Code of the first record, and the length of titles that it means
   integer, parameter :: versions(2, 4) = &
      reshape([3040, 40,  3041, 80,  3050, 100,  4021, 100], [2, 4])
   integer, parameter :: WITH_UNITS = 3050    !! from this code on more records follow

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

   !> Read from the first record to the place of the first row
   !>
   !> Errors: ERR_FILE when it is damaged.
   subroutine read_t01_header(file, header, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_header_t), intent(out) :: header
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), counts(:)
      character(len=:), allocatable :: text
      integer :: n_title, version, i

      call read_record(file, 1, HEAD_TEXT, 0, ints, header%title, error)
      if (allocated(error)) return
      version = findloc(versions(1, :), ints(1), 1)
      if (version == 0) then
         call broken(file, 'its header code '//str(ints(1))//' is not known', error)
         return
      end if
      n_title = versions(2, version)
      call read_record(file, 0, HEAD_TEXT, 0, ints, header%origin, error)
      if (.not. allocated(error) .and. versions(1, version) >= WITH_UNITS) &
         call read_extra_records(file, header, n_title, error)
      if (allocated(error)) return
      call read_record(file, 6, 0, 0, counts, text, error)
      if (allocated(error)) return
      call read_codes(file, counts(6), header%global_code, error)
      if (allocated(error)) return
      allocate (header%part_code(0), header%subset_code(0), header%group(0))
      do i = 1, counts(1)
         call read_part(file, n_title, header%part_code, header%n_part_value, error)
         if (allocated(error)) return
      end do
      do i = 1, counts(2)
         call read_record(file, 1, n_title, 0, ints, text, error)      ! a material
         if (allocated(error)) return
      end do
      do i = 1, counts(3)
         call read_record(file, 1, n_title, 0, ints, text, error)      ! a property
         if (allocated(error)) return
      end do
      do i = 1, counts(4)
         call read_subset(file, n_title, header%subset_code, header%n_subset_value, error)
         if (allocated(error)) return
      end do
      call read_groups(file, n_title, counts(5), header%group, error)
   end subroutine read_t01_header

   !> The number of further records, the length of titles, the SI values of the units, unknown ones
   subroutine read_extra_records(file, header, n_title, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_header_t), intent(inout) :: header
      integer, intent(inout) :: n_title
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: n_extra(:), length(:)
      character(len=:), allocatable :: text
      integer :: i

      call read_record(file, 1, 0, 0, n_extra, text, error)
      if (allocated(error)) return
      do i = 1, n_extra(1)
         if (i == 1) then
            call read_record(file, 1, 0, 0, length, text, error)
            if (allocated(error)) return
            n_title = length(1)
            if (n_title < 4 .or. n_title > 400 .or. mod(n_title, 4) /= 0) &
               call broken(file, 'a title length of '//str(n_title), error)
         else if (i == 2) then
            call read_real_record(file, 3, header%si, error)
            header%has_units = all(header%si > 0.0_wp)
         else
            call skip_record(file, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine read_extra_records

   !> A record of n codes; no record when n is 0
   subroutine read_codes(file, n, codes, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: codes(:)
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: text

      allocate (codes(0))
      if (n /= 0) call read_record(file, n, 0, 0, codes, text, error)
   end subroutine read_codes

   !> A part: id, title, 0, material, property, number of variables; and the codes of these
   subroutine read_part(file, n_title, all_codes, n_value, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title
      integer, allocatable, intent(inout) :: all_codes(:)
      integer, intent(inout) :: n_value
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), codes(:)
      character(len=:), allocatable :: title

      call read_record(file, 1, n_title, 4, ints, title, error)
      if (allocated(error)) return
      call read_codes(file, ints(5), codes, error)
      if (allocated(error)) return
      call add_codes(codes, all_codes, n_value)
   end subroutine read_part

   !> A subset: id, parent, children, parts, variables, title; and the lists of these
   subroutine read_subset(file, n_title, all_codes, n_value, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title
      integer, allocatable, intent(inout) :: all_codes(:)
      integer, intent(inout) :: n_value
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), list(:)
      character(len=:), allocatable :: title
      integer :: i

      call read_record(file, 5, n_title, 0, ints, title, error)
      if (allocated(error)) return
      do i = 3, 5
         call read_codes(file, ints(i), list, error)
         if (allocated(error)) return
      end do
      call add_codes(list, all_codes, n_value)
   end subroutine read_subset

   !> Count the values of an object, and note codes that are new
   pure subroutine add_codes(codes, all_codes, n_value)
      integer, intent(in) :: codes(:)
      integer, allocatable, intent(inout) :: all_codes(:)
      integer, intent(inout) :: n_value

      integer :: i

      n_value = n_value + size(codes)
      do i = 1, size(codes)
         if (all(all_codes /= codes(i))) all_codes = [all_codes, codes(i)]
      end do
   end subroutine add_codes

   !> The groups; memory grows as they are read, so that a wrong count ends at the end of the file
   subroutine read_groups(file, n_title, n_group, groups, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title, n_group
      type(t01_group_t), allocatable, intent(inout) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      type(t01_group_t), allocatable :: longer(:)
      type(t01_group_t) :: group
      integer :: i

      do i = 1, n_group
         call read_group(file, n_title, group, error)
         if (allocated(error)) return
         allocate (longer(i))
         longer(:i - 1) = groups
         longer(i) = group
         call move_alloc(longer, groups)
      end do
   end subroutine read_groups

   !> A group: id, type, 0, objects, variables, title; its objects; its codes
   subroutine read_group(file, n_title, group, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title
      type(t01_group_t), intent(out) :: group
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), id(:)
      type(text_t), allocatable :: longer(:)
      character(len=:), allocatable :: title
      integer :: i, n

      call read_record(file, 5, n_title, 0, ints, title, error)
      if (allocated(error)) return
      group%type = ints(2)
      allocate (group%object(0), group%name(0))
      do i = 1, ints(4)
         call read_record(file, 1, n_title, 0, id, title, error)
         if (allocated(error)) return
         n = size(group%name)
         if (i > n) then
            group%object = [group%object, spread(0, 1, max(n, 8))]
            allocate (longer(n + max(n, 8)))
            longer(:n) = group%name
            call move_alloc(longer, group%name)
         end if
         group%object(i) = id(1)
         group%name(i)%s = title
      end do
      if (ints(4) < 0) then
         call broken(file, 'a count is negative', error)
         return
      end if
      group%object = group%object(:ints(4))
      group%name = group%name(:ints(4))
      call read_codes(file, ints(5), group%code, error)
   end subroutine read_group

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
         call read_descriptor(file%bytes, found)
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
         call read_descriptor(file%bytes, n)
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
         call read_descriptor(file%bytes, n)
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

end module kj_t01_content
