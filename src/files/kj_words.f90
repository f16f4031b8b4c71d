!> Pieces of text for reports: a text that grows, columns, short numbers, counts, XML.
module kj_words
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: str
   use kj_utf8, only: as_utf8
   implicit none
   private

   public :: buffer_t, add, left, right, counted, short, few, escaped

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

   !> A number with at most so many digits as people write it: 0.0213, 196, 3.91e-6
   function few(value, digits) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(len=:), allocatable :: text

      character(len=40) :: buffer
      integer :: power

      write (buffer, '(es40.'//str(digits - 1)//'e4)') value
      if (.not. ieee_is_finite(value) .or. abs(value) < tiny(value)) then
         text = trim(adjustl(buffer))            ! NaN, Infinity
         if (ieee_is_finite(value)) text = '0'
         return
      end if
      read (buffer(index(buffer, 'E') + 1:), '(i5)') power
      if (power < -3 .or. power > max(4, digits - 1)) then
         text = without_zeros(buffer(:index(buffer, 'E') - 1))//'e'//str(power)
      else
         write (buffer, '(f40.'//str(max(0, digits - 1 - power))//')') value
         text = without_zeros(buffer)
      end if
   end function few

   !> A number with a point, without what ends it for nothing
   pure function without_zeros(number) result(text)
      character(len=*), intent(in) :: number
      character(len=:), allocatable :: text

      text = trim(adjustl(number))
      text = text(:verify(text, '0', back=.true.))
      if (text(len(text):) == '.') text = text(:len(text) - 1)
   end function without_zeros

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
