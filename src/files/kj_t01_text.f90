!> Records of the text form of a Radioss time history (/TFILE type 3): a line that announces the
!> items of a record, then integers in 10 columns, reals in 16 and texts as they are. Some versions
!> begin with an integer of 5 columns and a shorter title, and write the first line twice.
module kj_t01_text
   use kj_kinds, only: wp
   use kj_t01_bytes, only: byte_file_t, read_text_line
   implicit none
   private

   public :: begin_text, read_descriptor, read_text_record, read_text_reals, skip_text_reals

   integer, parameter :: LINE_LENGTH = 512         !! longest line
   integer, parameter :: INT_WIDTH = 10, SHORT_INT_WIDTH = 5, REAL_WIDTH = 16
   integer, parameter :: INTS_A_LINE = 16, REALS_A_LINE = 5

contains

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
   subroutine read_descriptor(bytes, letter, count)
      type(byte_file_t), intent(in) :: bytes
      character(len=1), intent(in) :: letter         !! I, C or R
      integer, intent(out) :: count                  !! as announced() has it

      character(len=LINE_LENGTH) :: line
      integer :: n

      call read_text_line(bytes, line, n)
      count = announced(line, n, letter)
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

end module kj_t01_text
