!> Records of a Radioss time-history file, whatever its form: framed bytes of either byte order
!> with words of 4 or 8 bytes (/TFILE types 4 and 1), or text (type 3).
!> One file: the two forms of one record
module kj_t01_file
   use, intrinsic :: iso_fortran_env, only: int8, int32, int64, real32, real64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_t01_bytes, only: byte_file_t, open_bytes, read_bytes, seek_bytes, byte_position, &
      close_bytes, why_not, read_text_line
   implicit none
   private

   public :: t01_file_t, open_t01_file, read_record, read_real_record, skip_record, decode_reals, &
      decode_length, broken, close_t01_file, read_descriptor, read_text_reals, skip_text_reals

   integer, parameter :: LINE_LENGTH = 512         !! longest line
   integer, parameter :: INT_WIDTH = 10, SHORT_INT_WIDTH = 5, REAL_WIDTH = 16
   integer, parameter :: INTS_A_LINE = 16, REALS_A_LINE = 5

   integer, parameter, public :: MARK = 4          !! bytes of a record length
   integer, parameter :: NO_RECORD = -1    !! read_length at the end of the file
   integer, parameter :: CHUNK = 65536
   integer, parameter :: FIRST_TEXT = 80           !! characters of the deck title, record 1

   !> An open file
   type :: t01_file_t
      type(byte_file_t) :: bytes
      character(len=:), allocatable :: path
      logical :: is_text = .false.
      logical :: swap = .false.        !! byte order is not that of this machine
      integer :: word = 4              !! bytes of a real, and of 4 characters of a title
   end type t01_file_t

contains

   !> Open and find out the form from the first bytes
   !>
   !> Errors: ERR_FILE when it cannot be opened or is no time history.
   subroutine open_t01_file(path, file, error)
      character(len=*), intent(in) :: path
      type(t01_file_t), intent(out) :: file
      type(error_t), allocatable, intent(out) :: error

      integer(int8) :: head(MARK)
      integer :: n
      logical :: ok

      file%path = path
      call open_bytes(path, file%bytes, ok)
      if (.not. ok) then
         call fail(error, ERR_FILE, 'cannot open '//path//': '//why_not(path))
         return
      end if
      call read_bytes(file%bytes, head, n)
      if (n == size(head)) then
         call find_framing(head, file, ok)
      else
         ok = .false.
      end if
      call rewind(file)
      if (ok) return
      call begin_text(file%bytes, file%is_text)
      if (file%is_text) return
      call close_t01_file(file)
      call fail(error, ERR_FILE, &
         path//' is neither a history of kjoint (HDF5) nor a Radioss time '// 'history (T01)')
   end subroutine open_t01_file

   !> The first record is an integer and 80 characters: its length tells byte order and word
   subroutine find_framing(head, file, found)
      integer(int8), intent(in) :: head(MARK)
      type(t01_file_t), intent(inout) :: file
      logical, intent(out) :: found

      integer :: i, j

      do i = 1, 2
         file%swap = i == 2
         do j = 1, 2
            file%word = 4*j
            found = decode_length(file, head) == MARK + FIRST_TEXT*j
            if (found) return
         end do
      end do
      file%swap = .false.
      file%word = 4
   end subroutine find_framing

   !> Read a record of integers, a text and integers; any of the three may be empty
   !>
   !> Errors: ERR_FILE when the record is not of this form.
   subroutine read_record(file, n_lead, n_char, n_trail, ints, text, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_lead, n_char, n_trail         !! integers, characters, integers
      integer, allocatable, intent(out) :: ints(:)           !! (n_lead + n_trail)
      character(len=:), allocatable, intent(out) :: text     !! without blanks at its end
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: bytes(:)
      integer(int64) :: expected
      integer :: n_text
      logical :: ok

      if (n_lead < 0 .or. n_trail < 0) then
         call broken(file, 'a count is negative', error)
      else if (file%is_text) then
         call read_text_record(file%bytes, n_lead, n_char, n_trail, ints, text, ok)
         if (.not. ok) call broken(file, 'a record is not of the form its header wants', error)
      else
         n_text = n_char/4*file%word
         expected = 4*(int(n_lead, int64) + n_trail) + n_text
         call read_payload(file, expected, bytes, error)
         if (allocated(error)) return
         allocate (ints(n_lead + n_trail))
         call decode_ints(file, bytes(:4*n_lead), ints(:n_lead))
         text = decode_text(file, bytes(4*n_lead + 1:4*n_lead + n_text))
         call decode_ints(file, bytes(4*n_lead + n_text + 1:), ints(n_lead + 1:))
      end if
   end subroutine read_record

   !> Read a record of n reals
   subroutine read_real_record(file, n, values, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n
      real(wp), intent(out) :: values(n)
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: bytes(:)
      integer :: announced
      logical :: ok

      values = 0.0_wp
      if (file%is_text) then
         call read_descriptor(file%bytes, announced)
         ok = announced == n
         if (ok) call read_text_reals(file%bytes, values, ok)
         if (.not. ok) call broken(file, 'a record of '//str(n)//' reals is not', error)
         return
      end if
      call read_payload(file, int(n, int64)*file%word, bytes, error)
      if (.not. allocated(error)) call decode_reals(file, bytes, values)
   end subroutine read_real_record

   !> Go over a record of any content; in the text form there is no such record
   subroutine skip_record(file, error)
      type(t01_file_t), intent(inout) :: file
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: bytes(:)
      integer :: length

      if (file%is_text) then
         call broken(file, 'a record of its header is not known', error)
         return
      end if
      call read_length(file, length)
      call read_payload(file, int(length, int64), bytes, error)
   end subroutine skip_record

   !> Length of the record that begins here, NO_RECORD at the end of the file; the place stays
   subroutine read_length(file, length)
      type(t01_file_t), intent(inout) :: file
      integer, intent(out) :: length            !! bytes

      integer(int8) :: head(MARK)
      integer(int64) :: at
      integer :: n
      logical :: ok

      at = byte_position(file%bytes)
      call read_bytes(file%bytes, head, n)
      length = NO_RECORD
      if (n == MARK) length = decode_length(file, head)
      call seek_bytes(file%bytes, at, ok)
      if (.not. ok) length = NO_RECORD
   end subroutine read_length

   !> Read a framed record of a known length
   subroutine read_payload(file, expected, bytes, error)
      type(t01_file_t), intent(inout) :: file
      integer(int64), intent(in) :: expected
      integer(int8), allocatable, intent(out) :: bytes(:)
      type(error_t), allocatable, intent(out) :: error

      integer(int8) :: head(MARK)
      integer :: n, length

      call read_bytes(file%bytes, head, n)
      length = NO_RECORD
      if (n == MARK) length = decode_length(file, head)
      if (n < MARK) then
         call broken(file, 'it ends inside its header', error)
      else if (length /= expected .or. length < 0) then
         call broken(file, 'a record of '//str(length)//' bytes is not as announced', error)
      else
         call read_marked(file, length, bytes, error)
      end if
   end subroutine read_payload

   !> Read `length` bytes and the length that must follow, in pieces: a wrong length in a damaged
   !> file ends at the end of the file, not in an allocation
   subroutine read_marked(file, length, bytes, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: length
      integer(int8), allocatable, intent(out) :: bytes(:)
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: longer(:)
      integer(int8) :: tail(MARK)
      integer :: have, n, want

      have = 0
      allocate (bytes(0))
      do while (have < length)
         want = min(length - have, max(CHUNK, have))
         allocate (longer(have + want))
         longer(:have) = bytes
         call move_alloc(longer, bytes)
         call read_bytes(file%bytes, bytes(have + 1:), n)
         if (n < want) exit
         have = have + want
      end do
      tail = 0_int8
      if (have == length) call read_bytes(file%bytes, tail, n)
      if (have < length .or. n < MARK) then
         call broken(file, 'it ends inside a record', error)
      else if (decode_length(file, tail) /= length) then
         call broken(file, 'the length after a record differs from the one before it', error)
      end if
   end subroutine read_marked

   ! ---- numbers from bytes

   !> A record length, or any other integer of 4 bytes
   pure integer function decode_length(file, bytes) result(value)
      type(t01_file_t), intent(in) :: file
      integer(int8), intent(in) :: bytes(4)

      if (file%swap) then
         value = int(transfer(bytes(4:1:-1), 1_int32))
      else
         value = int(transfer(bytes, 1_int32))
      end if
   end function decode_length

   pure subroutine decode_ints(file, bytes, ints)
      type(t01_file_t), intent(in) :: file
      integer(int8), intent(in) :: bytes(:)      !! (4 n)
      integer, intent(out) :: ints(:)            !! (n)

      integer :: i

      do i = 1, size(ints)
         ints(i) = decode_length(file, bytes(4*i - 3:4*i))
      end do
   end subroutine decode_ints

   !> Text of a title: with words of 8 bytes each holds 4 characters and 4 blanks
   pure function decode_text(file, bytes) result(text)
      type(t01_file_t), intent(in) :: file
      integer(int8), intent(in) :: bytes(:)
      character(len=:), allocatable :: text

      character(len=size(bytes)/file%word*4) :: buffer
      integer :: i, j

      do i = 1, len(buffer)
         j = (i - 1)/4*file%word + mod(i - 1, 4) + 1
         buffer(i:i) = achar(iand(int(bytes(j)), 255))
         if (buffer(i:i) < ' ') buffer(i:i) = ' '
      end do
      text = trim(buffer)
   end function decode_text

   !> Reals of the word length of the file
   pure subroutine decode_reals(file, bytes, values)
      type(t01_file_t), intent(in) :: file
      integer(int8), intent(in), contiguous :: bytes(:)     !! (word n)
      real(wp), intent(out) :: values(:)                    !! (n)

      integer :: i

      if (file%word == 8 .and. file%swap) then
         do i = 1, size(values)
            values(i) = real(transfer(bytes(8*i:8*i - 7:-1), 1.0_real64), wp)
         end do
      else if (file%word == 8) then
         do i = 1, size(values)
            values(i) = real(transfer(bytes(8*i - 7:8*i), 1.0_real64), wp)
         end do
      else if (file%swap) then
         do i = 1, size(values)
            values(i) = real(transfer(bytes(4*i:4*i - 3:-1), 1.0_real32), wp)
         end do
      else
         do i = 1, size(values)
            values(i) = real(transfer(bytes(4*i - 3:4*i), 1.0_real32), wp)
         end do
      end if
   end subroutine decode_reals

   ! ---- small things

   !> The error of a file that is damaged
   subroutine broken(file, what, error)
      type(t01_file_t), intent(in) :: file
      character(len=*), intent(in) :: what
      type(error_t), allocatable, intent(out) :: error

      call fail(error, ERR_FILE, file%path//' is damaged: '//what)
   end subroutine broken

   subroutine rewind(file)
      type(t01_file_t), intent(inout) :: file

      logical :: ok

      call seek_bytes(file%bytes, 0_int64, ok)
   end subroutine rewind

   !> Close; nothing happens when it is not open
   subroutine close_t01_file(file)
      type(t01_file_t), intent(inout) :: file

      call close_bytes(file%bytes)
   end subroutine close_t01_file

   !> Read the first line, "<name> FORMAT"; `found` is false on any other
   subroutine begin_text(bytes, found)
      type(byte_file_t), intent(in) :: bytes
      logical, intent(out) :: found

      character(len=LINE_LENGTH) :: line
      integer :: n

      call read_text_line(bytes, line, n)
      found = is_first(line, n)
   end subroutine begin_text

   !> A line of n characters is "<name> FORMAT"
   pure logical function is_first(line, n)
      character(len=*), intent(in) :: line
      integer, intent(in) :: n

      integer :: last

      is_first = n >= 6
      if (.not. is_first) return
      last = len_trim(line(:n))
      if (last >= 6) is_first = line(last - 5:last) == 'FORMAT'
   end function is_first

   !> Read the line that announces a record
   subroutine read_descriptor(bytes, count)
      type(byte_file_t), intent(in) :: bytes
      integer, intent(out) :: count                  !! as announced() has it

      character(len=LINE_LENGTH) :: line
      integer :: n

      call read_text_line(bytes, line, n)
      count = announced(line, n, 'R')
   end subroutine read_descriptor

   !> "ZZZZZEOR" and (count, letter) pairs: the sum of the counts with this letter, or -1 at the end
   !> of the file and on any other line
   pure integer function announced(line, n, letter) result(count)
      character(len=*), intent(in) :: line
      integer, intent(in) :: n                       !! characters of the line, -1 = none
      character(len=1), intent(in) :: letter         !! I, C or R

      integer :: i, number

      count = -1
      if (n < 8) return
      if (line(:8) /= 'ZZZZZEOR') return
      count = 0
      number = 0
      do i = 9, n
         if (verify(line(i:i), '0123456789') == 0) then
            number = min(10*number + iachar(line(i:i)) - iachar('0'), 10**8)
         else if (line(i:i) /= ' ') then
            if (line(i:i) == letter) count = count + number
            number = 0
         end if
      end do
   end function announced

   !> Read reals in columns of 16, 5 a line; not ok when one is not a number
   subroutine read_text_reals(bytes, values, ok)
      type(byte_file_t), intent(in) :: bytes
      real(wp), intent(out) :: values(:)
      logical, intent(out) :: ok

      character(len=LINE_LENGTH) :: line
      integer :: i, n, at, status

      values = 0.0_wp
      ok = .true.
      do i = 1, size(values)
         at = REAL_WIDTH*mod(i - 1, REALS_A_LINE)
         if (at == 0) call read_text_line(bytes, line, n)
         ok = n >= at + REAL_WIDTH
         if (ok) ok = len_trim(line(at + 1:at + REAL_WIDTH)) > 0
         if (.not. ok) return
         read (line(at + 1:at + REAL_WIDTH), '(f16.0)', iostat=status) values(i)
         ok = status == 0
         if (.not. ok) return
      end do
   end subroutine read_text_reals

   !> Go over the lines of n reals; not ok when one is too short
   subroutine skip_text_reals(bytes, n, ok)
      type(byte_file_t), intent(in) :: bytes
      integer, intent(in) :: n
      logical, intent(out) :: ok

      character(len=LINE_LENGTH) :: line
      integer :: i, length

      ok = .true.
      do i = 1, n, REALS_A_LINE
         call read_text_line(bytes, line, length)
         ok = length >= REAL_WIDTH*min(REALS_A_LINE, n - i + 1)
         if (.not. ok) return
      end do
   end subroutine skip_text_reals

   !> Read a record of integers, a text and integers: integers alone stand 16 a line, anything else
   !> on one line
   subroutine read_text_record(bytes, n_lead, n_char, n_trail, ints, text, ok)
      type(byte_file_t), intent(in) :: bytes
      integer, intent(in) :: n_lead, n_char, n_trail         !! integers, characters, integers
      integer, allocatable, intent(out) :: ints(:)           !! (n_lead + n_trail)
      character(len=:), allocatable, intent(out) :: text     !! without blanks at its end
      logical, intent(out) :: ok

      character(len=LINE_LENGTH) :: line
      integer :: i, n

      text = ''
      call read_text_line(bytes, line, n)
      if (is_first(line, n)) call read_text_line(bytes, line, n)    ! a second time
      ok = announced(line, n, 'I') == n_lead + n_trail
      if (.not. ok) then
         allocate (ints(0))
      else if (n_char > 0) then
         allocate (ints(n_lead + n_trail))
         ints = 0
         call read_mixed_line(bytes, n_lead, [n_char, announced(line, n, 'C')], n_trail, ints, &
            text, ok)
      else
         allocate (ints(0))
         do i = 1, n_lead, INTS_A_LINE
            call append_ints(bytes, min(INTS_A_LINE, n_lead - i + 1), ints, ok)
            if (.not. ok) exit
         end do
      end if
   end subroutine read_text_record

   !> Integers, a text and integers on one line
   subroutine read_mixed_line(bytes, n_lead, n_char, n_trail, ints, text, ok)
      type(byte_file_t), intent(in) :: bytes
      integer, intent(in) :: n_lead, n_trail
      integer, intent(in) :: n_char(2)               !! as the header has it, as announced
      integer, intent(inout) :: ints(:)
      character(len=:), allocatable, intent(inout) :: text
      logical, intent(out) :: ok

      character(len=LINE_LENGTH) :: line
      integer :: n, start, last, n_text

      call read_text_line(bytes, line, n)
      start = 0
      n_text = n_char(1)
      if (n >= 0) call cut_lead(line, n, n_char, SHORT_INT_WIDTH*n_trail, ints(:n_lead), start, &
         n_text)
      ok = n >= 0 .and. start >= 0
      last = start + n_text + SHORT_INT_WIDTH*n_trail
      ok = ok .and. last <= len(line)
      if (.not. ok) return
      text = trim(line(start + 1:start + n_text))
      call cut_ints(line(start + n_text + 1:last), SHORT_INT_WIDTH, ints(n_lead + 1:), ok)
   end subroutine read_mixed_line

   !> Integers before a text: 10 columns each, or 10 for the first and 5 for the others, or 5 each
   subroutine cut_lead(line, length, n_char, n_rest, ints, start, n_text)
      character(len=*), intent(in) :: line
      integer, intent(in) :: length                 !! columns of the line
      integer, intent(in) :: n_char(2), n_rest      !! those the text may have; those after it
      integer, intent(inout) :: ints(:)
      integer, intent(out) :: start                 !! columns of the integers, -1 = none fits
      integer, intent(out) :: n_text                !! columns of the text

      integer, parameter :: FIRST(3) = [INT_WIDTH, INT_WIDTH, SHORT_INT_WIDTH]
      integer, parameter :: OTHERS(3) = [INT_WIDTH, SHORT_INT_WIDTH, SHORT_INT_WIDTH]
      integer :: columns(3, 2), i, k
      logical :: exact, ok

      do k = 1, 2
         columns(:, k) = FIRST*min(size(ints), 1) + OTHERS*max(size(ints) - 1, 0) + n_char(k) + &
            n_rest
      end do
      ! the length of the line tells, unless blanks at its end were lost
      exact = any(columns == length)
      do k = 1, 2
         do i = 1, 3
            n_text = n_char(k)
            start = columns(i, k) - n_text - n_rest
            if (start > len(line) .or. length > columns(i, k)) cycle
            if (exact .and. columns(i, k) /= length) cycle
            call cut_ints(line(:start), OTHERS(i), ints, ok)
            if (ok) return
         end do
      end do
      start = -1
   end subroutine cut_lead

   !> Right-justified integers; the first takes what columns the others leave
   subroutine cut_ints(text, width, ints, ok)
      character(len=*), intent(in) :: text
      integer, intent(in) :: width                  !! columns of all but the first
      integer, intent(inout) :: ints(:)
      logical, intent(out) :: ok

      integer :: i, first, last, status

      ok = .true.
      if (size(ints) == 0) return
      last = len(text) - width*(size(ints) - 1)
      first = 1
      do i = 1, size(ints)
         ok = text(last:last) /= ' ' .and. verify(text(first:last), ' -0123456789') == 0
         if (.not. ok) return
         read (text(first:last), '(i10)', iostat=status) ints(i)
         ok = status == 0
         if (.not. ok) return
         first = last + 1
         last = last + width
      end do
   end subroutine cut_ints

   !> Read a line of n integers
   subroutine append_ints(bytes, n, ints, ok)
      type(byte_file_t), intent(in) :: bytes
      integer, intent(in) :: n
      integer, allocatable, intent(inout) :: ints(:)
      logical, intent(out) :: ok

      character(len=LINE_LENGTH) :: line
      integer :: more(n), length

      call read_text_line(bytes, line, length)
      ok = length >= 0
      if (.not. ok) return
      more = 0
      call cut_ints(line(:INT_WIDTH*n), INT_WIDTH, more, ok)
      ints = [ints, more]
   end subroutine append_ints

end module kj_t01_file
