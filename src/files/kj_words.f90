!> Pieces of text for reports: a text that grows, columns, short numbers, counts, XML.
module kj_words
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: str, error_t, finding_list_t, SEVERITY_NAME
   use kj_text, only: as_utf8
   implicit none
   private

   public :: buffer_t, add, left, right, counted, short, few, escaped, json_member, json_pair, &
      json_text, json_real, json_list, json_findings, comma

   !> "name": value, of a text, a number or a truth
   interface json_member
      procedure :: text_member, real_member, integer_member, logical_member
   end interface json_member

   !> A list of numbers or texts
   interface json_list
      procedure :: list_of_reals, list_of_integers, list_of_texts
   end interface json_list

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

   pure function text_member(name, value) result(json)
      character(len=*), intent(in) :: name, value
      character(len=:), allocatable :: json

      json = json_pair(name, json_text(value))
   end function text_member

   pure function real_member(name, value) result(json)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      character(len=:), allocatable :: json

      json = json_pair(name, json_real(value))
   end function real_member

   pure function integer_member(name, value) result(json)
      character(len=*), intent(in) :: name
      integer, intent(in) :: value
      character(len=:), allocatable :: json

      json = json_pair(name, str(value))
   end function integer_member

   pure function logical_member(name, value) result(json)
      character(len=*), intent(in) :: name
      logical, intent(in) :: value
      character(len=:), allocatable :: json

      json = json_pair(name, trim(merge('true ', 'false', value)))
   end function logical_member

   !> "name": value, where the value is JSON already
   pure function json_pair(name, value) result(json)
      character(len=*), intent(in) :: name, value
      character(len=:), allocatable :: json

      json = '"'//name//'": '//value
   end function json_pair

   !> A text in quotes, with what must be escaped; what is not UTF-8 is read as Latin-1
   pure function json_text(text) result(json)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: json

      character(len=:), allocatable :: clean
      character(len=6) :: escaped
      integer :: i

      clean = as_utf8(text)
      json = '"'
      do i = 1, len(clean)
         select case (iachar(clean(i:i)))
         case (34, 92)
            json = json//'\'//clean(i:i)
         case (:31, 127)
            write (escaped, '(a,z4.4)') '\u', iachar(clean(i:i))
            json = json//escaped
         case default
            json = json//clean(i:i)
         end select
      end do
      json = json//'"'
   end function json_text

   !> A number with all its digits; null when it is not finite
   pure function json_real(value) result(json)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: json

      character(len=24) :: buffer

      json = 'null'
      if (.not. ieee_is_finite(value)) return
      write (buffer, '(es24.16e3)') value
      json = trim(adjustl(buffer))
   end function json_real

   pure function list_of_reals(values) result(json)
      real(wp), intent(in) :: values(:)
      character(len=:), allocatable :: json

      integer :: i

      json = '['
      do i = 1, size(values)
         json = json//json_real(values(i))//comma(i, size(values))
      end do
      json = json//']'
   end function list_of_reals

   pure function list_of_integers(values) result(json)
      integer, intent(in) :: values(:)
      character(len=:), allocatable :: json

      integer :: i

      json = '['
      do i = 1, size(values)
         json = json//str(values(i))//comma(i, size(values))
      end do
      json = json//']'
   end function list_of_integers

   !> Blanks at the end of a text do not count
   pure function list_of_texts(values) result(json)
      character(len=*), intent(in) :: values(:)
      character(len=:), allocatable :: json

      integer :: i

      json = '['
      do i = 1, size(values)
         json = json//json_text(trim(values(i)))//comma(i, size(values))
      end do
      json = json//']'
   end function list_of_texts

   !> A comma after all but the last of n
   pure function comma(i, n) result(text)
      integer, intent(in) :: i, n
      character(len=:), allocatable :: text

      text = repeat(', ', merge(1, 0, i < n))
   end function comma

   !> Members of an object: how many errors and warnings, how many findings were left out, the
   !> others as objects: severity, id, message, file, line, first, last, text, label, hint
   pure function json_findings(findings) result(json)
      type(finding_list_t), intent(in) :: findings
      character(len=:), allocatable :: json

      integer :: i

      json = json_member('errors', findings%n_error)//', '// &
         json_member('warnings', findings%n_warning)//', '// &
         json_member('findings_left_out', findings%n_left)//', "findings": ['
      do i = 1, findings%n
         json = json//json_finding(findings%item(i))//comma(i, findings%n)
      end do
      json = json//']'
   end function json_findings

   pure function json_finding(finding) result(json)
      type(error_t), intent(in) :: finding
      character(len=:), allocatable :: json

      associate (f => finding)
         json = '{'//json_member('severity', trim(SEVERITY_NAME(f%severity)))//', '// &
            json_member('id', trim(f%id))
         if (allocated(f%message)) json = json//', '//json_member('message', f%message)
         if (allocated(f%file)) json = json//', '//json_member('file', f%file)
         if (f%line > 0) json = json//', '//json_member('line', f%line)
         if (f%first > 0) json = json//', '//json_member('first', f%first)//', '// &
            json_member('last', f%last)
         if (allocated(f%text)) json = json//', '//json_member('text', f%text)
         if (allocated(f%label)) json = json//', '//json_member('label', f%label)
         if (allocated(f%hint)) json = json//', '//json_member('hint', f%hint)
      end associate
      json = json//'}'
   end function json_finding

end module kj_words
