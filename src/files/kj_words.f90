!> Pieces of text for reports: a text that grows, columns, short numbers, counts, XML.
module kj_words
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: str
   use kj_utf8, only: as_utf8
   implicit none
   private

   public :: buffer_t, add, left, right, counted, short, short_time, escaped

   !> Text that grows: doubled when it is full
   type :: buffer_t
      character(len=:), allocatable :: s
      integer :: n = 0
   end type buffer_t

contains

   !> Append a text
   subroutine add(b, text)
      type(buffer_t), intent(inout) :: b
      character(len=*), intent(in) :: text

      character(len=:), allocatable :: longer

      if (.not. allocated(b%s)) allocate (character(len=4096) :: b%s)
      if (b%n + len(text) > len(b%s)) then
         allocate (character(len=2*len(b%s) + len(text)) :: longer)
         longer(:b%n) = b%s(:b%n)
         call move_alloc(longer, b%s)
      end if
      b%s(b%n + 1:b%n + len(text)) = text
      b%n = b%n + len(text)
   end subroutine add

   !> Text at the left of a column; not cut when it is longer
   pure function left(text, n) result(field)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      character(len=max(n, len(text))) :: field

      field = text
   end function left

   !> Text at the right of a column
   pure function right(text, n) result(field)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      character(len=max(n, len(text))) :: field

      field = repeat(' ', len(field) - len(text))//text
   end function right

   !> A number and what it counts: '1 rigid body', '2 rigid bodies'
   pure function counted(n, one, many) result(text)
      integer, intent(in) :: n
      character(len=*), intent(in) :: one, many
      character(len=:), allocatable :: text

      text = str(n)//' '//many
      if (n == 1) text = '1 '//one
   end function counted

   !> A positive number with a few digits: 2.3e-3, 0
   function short(value, digits) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(len=:), allocatable :: text

      character(len=40) :: buffer, form
      integer :: e, power

      if (.not. ieee_is_finite(value)) then
         text = 'infinity'
      else if (value <= 0.0_wp) then
         text = '0'
      else
         write (form, '(a,i0,a)') '(es40.', digits - 1, 'e4)'
         write (buffer, form) value
         buffer = adjustl(buffer)
         e = scan(buffer, 'E')
         read (buffer(e + 1:e + 5), '(i5)') power
         text = buffer(:e - 1)//'e'//str(power)
      end if
   end function short

   !> A time: up to 6 digits, without zeros at the end
   function short_time(value) result(text)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text

      character(len=40) :: buffer

      if (abs(value) >= 1.0e6_wp .or. (abs(value) < 1.0e-4_wp .and. abs(value) > 0.0_wp)) then
         text = short(abs(value), 6)
         if (value < 0.0_wp) text = '-'//text
         return
      end if
      write (buffer, '(f20.6)') value
      if (abs(value) >= 10.0_wp) write (buffer, '(f20.4)') value
      text = trim(adjustl(buffer))
      do while (text(len(text):) == '0')
         text = text(:len(text) - 1)
      end do
      if (text(len(text):) == '.') text = text(:len(text) - 1)
   end function short_time

   !> Text inside an attribute of XML
   function escaped(text) result(xml)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: xml, clean

      integer :: i

      clean = as_utf8(text)
      xml = ''
      do i = 1, len(clean)
         select case (clean(i:i))
         case ('&')
            xml = xml//'&amp;'
         case ('<')
            xml = xml//'&lt;'
         case ('>')
            xml = xml//'&gt;'
         case ('"')
            xml = xml//'&quot;'
         case default
            if (iachar(clean(i:i)) >= 32) xml = xml//clean(i:i)
         end select
      end do
   end function escaped

end module kj_words
