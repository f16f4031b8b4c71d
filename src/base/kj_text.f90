!> Texts of any length in arrays.
module kj_text
   implicit none
   private

   public :: text_t, append_text, fact, as_utf8, is_plain

   !> A text of any length
   type :: text_t
      character(len=:), allocatable :: s
   end type text_t

contains

   !> Append a text to a list
   subroutine append_text(list, text)
      type(text_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: text

      type(text_t), allocatable :: longer(:)
      integer :: i

      allocate (longer(size(list) + 1))
      do i = 1, size(list)
         call move_alloc(list(i)%s, longer(i)%s)
      end do
      longer(size(longer))%s = text
      call move_alloc(longer, list)
   end subroutine append_text

   !> The same text as UTF-8: unchanged when it is UTF-8 already, else read as Latin-1. Null
   !> characters, which end a text in C, become blanks.
   pure function as_utf8(text) result(utf8)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: utf8

      integer :: i, n, code

      if (is_utf8(text)) then
         utf8 = text
         do i = 1, len(utf8)
            if (ichar(utf8(i:i)) == 0) utf8(i:i) = ' '
         end do
         return
      end if

      allocate (character(len=2*len(text)) :: utf8)
      n = 0
      do i = 1, len(text)
         code = ichar(text(i:i))
         if (code == 0) code = ichar(' ')
         if (code < 128) then
            n = n + 1
            utf8(n:n) = char(code)
         else
            utf8(n + 1:n + 2) = char(192 + code/64)//char(128 + mod(code, 64))
            n = n + 2
         end if
      end do
      utf8 = utf8(:n)
   end function as_utf8

   !> as_utf8 would change nothing, since all is ASCII without null characters
   pure logical function is_plain(text)
      character(len=*), intent(in) :: text

      integer :: i, code

      is_plain = .true.
      do i = 1, len(text)
         code = ichar(text(i:i))
         if (code == 0 .or. code > 127) is_plain = .false.
      end do
   end function is_plain

   !> Is this well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, up to U+10FFFF)?
   pure logical function is_utf8(text)
      character(len=*), intent(in) :: text

      integer :: i, j, code, n_more, low, high

      is_utf8 = .false.
      i = 0
      do while (i < len(text))
         i = i + 1
         code = ichar(text(i:i))
         if (code < 128) cycle
         n_more = 1
         if (code >= 224) n_more = 2
         if (code >= 240) n_more = 3
         if (code < 194 .or. code > 244 .or. i + n_more > len(text)) return
         ! bounds of the second byte
         low = 128
         high = 191
         if (code == 224) low = 160
         if (code == 237) high = 159
         if (code == 240) low = 144
         if (code == 244) high = 143
         do j = i + 1, i + n_more
            code = ichar(text(j:j))
            if (code < low .or. code > high) return
            low = 128
            high = 191
         end do
         i = i + n_more
      end do
      is_utf8 = .true.
   end function is_utf8

   !> Value of a named fact, `default` when there is none
   pure function fact(name, names, values, default) result(value)
      character(len=*), intent(in) :: name, default
      type(text_t), intent(in) :: names(:), values(:)
      character(len=:), allocatable :: value

      integer :: i

      value = default
      do i = 1, size(names)
         if (names(i)%s == name) value = values(i)%s
      end do
   end function fact

end module kj_text
