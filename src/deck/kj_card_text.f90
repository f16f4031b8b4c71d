!> Values -> text of cards.
module kj_card_text
   use kj_kinds, only: wp
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE
   implicit none
   private

   public :: real_text, real_field, integer_field

contains

   !> 'E-3', nothing for 0
   pure function integer_exponent(e) result(text)
      integer, intent(in) :: e
      character(len=7) :: text

      character(len=6) :: buffer

      text = ''
      if (e == 0) return
      write (buffer, '(i0)') e
      text = 'E'//trim(buffer)
   end function integer_exponent

   !> The same with blanks behind
   pure function padded(value, width) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: width
      character(len=40) :: text

      character(len=40) :: buffer
      character(len=12) :: form
      character(len=:), allocatable :: mantissa, exponent
      real(wp) :: back
      integer :: digits, e, power, status

      text = '0.0'
      if (abs(value) <= 0.0_wp) return
      do digits = 1, 17
         write (form, '(a,i0,a)') '(es40.', digits - 1, 'e3)'
         write (buffer, form) value
         buffer = adjustl(buffer)
         e = index(buffer, 'E')
         mantissa = buffer(:e - 1)
         call parse_integer(buffer(e + 1:), power, status)
         exponent = trim(integer_exponent(power))
         if (len(mantissa) + len(exponent) > width) exit
         text = mantissa//exponent
         call parse_real(trim(text), back, status)
         if (status == NUMBER_FINE .and. abs(back - value) <= 0.0_wp) exit
      end do
   end function padded

   !> The shortest decimal that reads as the same real; of those that fit the width, the nearest
   pure function real_text(value, width) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: width               !! 9 or more
      character(len=len_trim(padded(value, width))) :: text

      text = padded(value, width)
   end function real_text

   !> A real in twenty columns, at least one of them blank
   pure function real_field(value) result(text)
      real(wp), intent(in) :: value
      character(len=20) :: text

      character(len=:), allocatable :: number

      number = real_text(value, 19)
      text = repeat(' ', 20 - len(number))//number
   end function real_field

   !> An integer in ten columns
   pure function integer_field(value) result(text)
      integer, intent(in) :: value
      character(len=10) :: text

      write (text, '(i10)') value
   end function integer_field

end module kj_card_text
