!> Header lines: /WORD/WORD/number/number.
module kj_header_line
   implicit none
   private

   public :: header_t, split_header

   integer, parameter :: MOST_NUMBERS = 3

   !> A header taken apart
   type :: header_t
      character(len=:), allocatable :: path     !! the words: /PROP/TYPE33
      integer :: n = 0                          !! numbers after them, at most three
      integer :: number(MOST_NUMBERS) = 0
      integer :: first(MOST_NUMBERS) = 1, last(MOST_NUMBERS) = 1   !! their columns
      integer :: rest_first = 1, rest_last = 0  !! text that means nothing
   end type header_t

contains

   !> Take a header apart; a number ends at the first character that is no digit
   pure subroutine split_header(text, header)
      character(len=*), intent(in) :: text      !! begins with /
      type(header_t), intent(out) :: header

      integer :: at, first, last, slash, digits_end
      logical :: is_number

      header%path = ''
      at = 1
      do while (at <= len(text))
         slash = index(text(at + 1:), '/')
         last = len(text)
         if (slash > 0) last = at + slash - 1
         first = at + 1
         call find_number(text, first, last, digits_end, is_number)
         if (is_number .and. header%n < MOST_NUMBERS) then
            call take_number(text, first, digits_end, header)
            call note_rest(text, digits_end + 1, last, header)
         else if (header%n > 0) then
            call note_rest(text, first, last, header)
         else if (slash > 0 .or. len_trim(text(first:last)) > 0) then
            header%path = header%path//'/'//trim(text(first:last))
         end if
         at = last + 1
      end do
   end subroutine split_header

   !> A number, with a sign perhaps, begins in column `first`
   pure subroutine find_number(text, first, last, digits_end, is_number)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: first           !! moved over blanks before a number
      integer, intent(in) :: last
      integer, intent(out) :: digits_end
      logical, intent(out) :: is_number

      integer :: i, n

      digits_end = first - 1
      is_number = .false.
      i = verify(text(first:last), ' ') + first - 1
      if (i < first) return
      n = i
      if (text(i:i) == '+' .or. text(i:i) == '-') n = i + 1
      digits_end = last
      if (n <= last) digits_end = verify(text(n:last), '0123456789') + n - 2
      if (digits_end < n - 1) digits_end = last
      is_number = digits_end >= n
      if (is_number) first = i
   end subroutine find_number

   !> Append a number; one that is too large becomes the largest integer
   pure subroutine take_number(text, first, last, header)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last
      type(header_t), intent(inout) :: header

      integer :: value, stat

      read (text(first:last), '(i20)', iostat=stat) value
      if (stat /= 0) value = huge(value)
      header%n = header%n + 1
      header%number(header%n) = value
      header%first(header%n) = first
      header%last(header%n) = last
   end subroutine take_number

   !> Note the first text that means nothing
   pure subroutine note_rest(text, first, last, header)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last
      type(header_t), intent(inout) :: header

      if (header%rest_last >= header%rest_first .or. last < first) return
      if (text(first:last) == '') return
      header%rest_first = first + verify(text(first:last), ' ') - 1
      header%rest_last = first + len_trim(text(first:last)) - 1
   end subroutine note_rest

end module kj_header_line
