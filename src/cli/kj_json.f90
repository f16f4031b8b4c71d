!> JSON text (RFC 8259) of the few things the program gives as objects.
module kj_json
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, str, SEV_NOTE, SEV_ERROR
   implicit none
   private

   public :: json_text, json_real, json_member, json_findings

   character(len=7), parameter :: SEVERITY(3) = ['note   ', 'warning', 'error  ']

contains

   !> "name": value
   pure function json_member(name, value) result(json)
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: value            !! JSON text
      character(len=:), allocatable :: json

      json = '"'//name//'": '//value
   end function json_member

   !> A text in quotes, with what must be escaped; bytes that are not UTF-8 become "?"
   pure function json_text(text) result(json)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: json

      character(len=6) :: escaped
      integer :: i, n

      json = '"'
      i = 1
      do while (i <= len(text))
         n = utf8_length(text(i:))
         select case (iachar(text(i:i)))
         case (34, 92)
            json = json//'\'//text(i:i)
         case (:31, 127)
            write (escaped, '(a,z4.4)') '\u', iachar(text(i:i))
            json = json//escaped
         case default
            if (n > 0) json = json//text(i:i + n - 1)
            if (n == 0) json = json//'?'
         end select
         i = i + max(n, 1)
      end do
      json = json//'"'
   end function json_text

   !> Bytes of the character a text begins with, 0 when these are not UTF-8
   pure integer function utf8_length(text) result(n)
      character(len=*), intent(in) :: text

      integer :: i

      select case (iachar(text(1:1)))
      case (0:127)
         n = 1
      case (194:223)
         n = 2
      case (224:239)
         n = 3
      case (240:244)
         n = 4
      case default
         n = 0
      end select
      if (n > len(text)) n = 0
      do i = 2, n
         if (iand(iachar(text(i:i)), 192) /= 128) then
            n = 0
            return
         end if
      end do
   end function utf8_length

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

   !> A list of objects: severity, id, message, file, line, first, last, text, label, hint
   pure function json_findings(findings) result(json)
      type(finding_list_t), intent(in) :: findings
      character(len=:), allocatable :: json

      integer :: i

      json = '['
      do i = 1, findings%n
         if (i > 1) json = json//', '
         json = json//json_finding(findings%item(i))
      end do
      json = json//']'
   end function json_findings

   pure function json_finding(finding) result(json)
      type(error_t), intent(in) :: finding
      character(len=:), allocatable :: json

      json = '{'//json_member('severity', &
         json_text(trim(SEVERITY(min(max(finding%severity, SEV_NOTE), SEV_ERROR)))))// &
         ', '//json_member('id', json_text(trim(finding%id)))
      if (allocated(finding%message)) json = json//text_member('message', finding%message)
      if (allocated(finding%file)) json = json//text_member('file', finding%file)
      if (finding%line > 0) json = json//', '//json_member('line', str(finding%line))
      if (finding%first > 0) json = json//', '//json_member('first', str(finding%first))// &
         ', '//json_member('last', str(finding%last))
      if (allocated(finding%text)) json = json//text_member('text', finding%text)
      if (allocated(finding%label)) json = json//text_member('label', finding%label)
      if (allocated(finding%hint)) json = json//text_member('hint', finding%hint)
      json = json//'}'
   end function json_finding

   pure function text_member(name, value) result(json)
      character(len=*), intent(in) :: name, value
      character(len=:), allocatable :: json

      json = ', '//json_member(name, json_text(value))
   end function text_member

end module kj_json
