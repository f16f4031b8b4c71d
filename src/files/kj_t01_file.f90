!> Records of a Radioss time-history file, whatever its form: framed bytes of either byte order
!> with words of 4 or 8 bytes (/TFILE types 4 and 1), or text (type 3).
module kj_t01_file
   use, intrinsic :: iso_fortran_env, only: int8, int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_t01_bytes, only: byte_file_t, open_bytes, read_bytes, seek_bytes, byte_position, &
      close_bytes, why_not
   use kj_t01_text, only: begin_text, read_descriptor, read_text_record, read_text_reals
   implicit none
   private

   public :: t01_file_t, open_t01_file, read_record, read_real_record, skip_record, decode_reals, &
      decode_length, broken, close_t01_file

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
         call read_descriptor(file%bytes, 'R', announced)
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

end module kj_t01_file
