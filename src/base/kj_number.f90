!> Numbers in text: an exactly rounded parser of reals and a parser of integers.
!>
!> A decimal m 10**k with m of at most 30 digits and |k| <= 22 is computed in pairs of reals,
!> whose error is below 2**-100; where that could decide the last bit, and for all other
!> decimals, a formatted read takes over. So the result always has the bits of a read.
!> Source: W. D. Clinger, PLDI 1990, doi 10.1145/93542.93557; T. J. Dekker, Numer. Math. 18
!> (1971) 224, doi 10.1007/BF01397083.
!> One file: numbers and their texts, both ways
module kj_number
   use kj_kinds, only: wp
   implicit none
   private

   public :: parse_real, parse_integer, real_text, real_field, integer_field

   !> What a parser found
   integer, parameter, public :: &
      NUMBER_FINE = 0, &        !! a number and nothing else
      NUMBER_BLANK = 1, &       !! nothing: the value is 0
      NUMBER_TEXT = 2, &        !! something else than a number
      NUMBER_INNER_BLANK = 3, & !! blanks between the characters of the number
      NUMBER_NOT_FINITE = 4, &  !! infinite, not a number, or too large for a real
      NUMBER_FRACTION = 5, &    !! a real with a fraction where an integer is due
      NUMBER_WHOLE_REAL = 6, &  !! a real without fraction where an integer is due: value is set
      NUMBER_TOO_LARGE = 7      !! an integer beyond the largest one

   integer, parameter :: CHUNK = 15          !! decimal digits that a real holds exactly
   real(wp), parameter :: TEN(0:22) = [ &    ! the powers of ten a real holds exactly
      1e0_wp, 1e1_wp, 1e2_wp, 1e3_wp, 1e4_wp, 1e5_wp, 1e6_wp, 1e7_wp, 1e8_wp, 1e9_wp, 1e10_wp, &
      1e11_wp, 1e12_wp, 1e13_wp, 1e14_wp, 1e15_wp, 1e16_wp, 1e17_wp, 1e18_wp, 1e19_wp, 1e20_wp, &
      1e21_wp, 1e22_wp]

contains

   !> Real number of a field; blanks may stand on both sides
   !>
   !> Accepts 1, 1., .5, 1e6, 1.0D+6 and 1.0+6. The value is 0 unless the status is NUMBER_FINE.
   pure subroutine parse_real(text, value, status)
      character(len=*), intent(in) :: text
      real(wp), intent(out) :: value
      integer, intent(out) :: status           !! NUMBER_ constant

      real(wp) :: high, low                    ! the first 15 digits, the next 15
      integer :: i, n_digit, n_low, power, exponent, first
      logical :: negative, exact

      value = 0.0_wp
      call skip_blanks(text, 1, first)
      status = NUMBER_BLANK
      if (first > len(text)) return
      i = first
      call take_sign(text, i, negative)
      call take_digits(text, i, high, low, n_digit, n_low, power, exact)
      status = NUMBER_TEXT
      if (n_digit < 0) then
         if (is_not_finite(text(i:))) status = NUMBER_NOT_FINITE
         return
      end if
      call take_exponent(text, i, exponent, status)
      if (status /= NUMBER_FINE) return
      call check_rest(text, i, status)
      if (status /= NUMBER_FINE) return
      power = power + exponent
      if (exact) call compose(high, low, n_low, power, value, exact)
      if (exact) then
         if (negative) value = -value
      else
         call read_real(text(first:i - 1), value, status)
      end if
   end subroutine parse_real

   !> Integer of a field; blanks may stand on both sides
   pure subroutine parse_integer(text, value, status)
      character(len=*), intent(in) :: text
      integer, intent(out) :: value            !! 0 unless the status is NUMBER_FINE or _WHOLE_REAL
      integer, intent(out) :: status           !! NUMBER_ constant

      integer :: i, first, digit
      logical :: negative, too_large

      value = 0
      call skip_blanks(text, 1, i)
      status = NUMBER_BLANK
      if (i > len(text)) return
      call take_sign(text, i, negative)
      first = i
      too_large = .false.
      do while (i <= len(text))
         digit = iachar(text(i:i)) - iachar('0')
         if (digit < 0 .or. digit > 9) exit
         if (value > (huge(value) - digit)/10) too_large = .true.
         if (.not. too_large) value = 10*value + digit
         i = i + 1
      end do
      if (i <= len(text)) then
         if (i == first .or. iachar(text(i:i)) /= iachar(' ')) then
            call whole_real(text, value, status)
            return
         end if
      end if
      status = NUMBER_TEXT
      if (i > first) call check_rest(text, i, status)
      if (status == NUMBER_FINE .and. too_large) status = NUMBER_TOO_LARGE
      if (status /= NUMBER_FINE) value = 0
      if (negative) value = -value
   end subroutine parse_integer

   !> Judge a field that is no plain integer: 3.0 is 3, 3.5 has a fraction, the rest is text
   pure subroutine whole_real(text, value, status)
      character(len=*), intent(in) :: text
      integer, intent(out) :: value, status

      real(wp) :: number

      value = 0
      call parse_real(text, number, status)
      if (status /= NUMBER_FINE) return
      if (abs(number) > real(huge(value), wp)) then
         status = NUMBER_TOO_LARGE
      else if (abs(number - anint(number)) > 0.0_wp) then
         status = NUMBER_FRACTION
      else
         value = nint(number)
         status = NUMBER_WHOLE_REAL
      end if
   end subroutine whole_real

   !> Position of the first character that is no blank; len(text) + 1 when there is none
   pure subroutine skip_blanks(text, from, i)
      character(len=*), intent(in) :: text
      integer, intent(in) :: from
      integer, intent(out) :: i

      i = from
      do while (i <= len(text))
         if (iachar(text(i:i)) /= iachar(' ')) return   ! twice as fast as texts
         i = i + 1
      end do
   end subroutine skip_blanks

   !> Step over a sign
   pure subroutine take_sign(text, i, negative)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: i
      logical, intent(out) :: negative

      negative = .false.
      if (i > len(text)) return
      negative = text(i:i) == '-'
      if (negative .or. text(i:i) == '+') i = i + 1
   end subroutine take_sign

   !> Step over digits with at most one point among them
   pure subroutine take_digits(text, i, high, low, n_digit, n_low, power, exact)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: i
      real(wp), intent(out) :: high, low       !! significant digits 1 to 15 and 16 to 30
      integer, intent(out) :: n_digit          !! significant digits; -1 when there is no digit
      integer, intent(out) :: n_low            !! digits in `low`
      integer, intent(out) :: power            !! of ten, after the last digit
      logical, intent(out) :: exact            !! not more than 30 significant digits

      integer :: digit, n_seen, at_point

      high = 0.0_wp
      low = 0.0_wp
      n_digit = 0
      n_seen = 0
      at_point = -1
      do while (i <= len(text))
         digit = iachar(text(i:i)) - iachar('0')
         if (digit >= 0 .and. digit <= 9) then
            n_seen = n_seen + 1
            if (n_digit > 0 .or. digit > 0) n_digit = n_digit + 1
            if (n_digit <= CHUNK) then
               high = 10.0_wp*high + real(digit, wp)
            else if (n_digit <= 2*CHUNK) then
               low = 10.0_wp*low + real(digit, wp)
            end if
         else if (text(i:i) == '.' .and. at_point < 0) then
            at_point = n_seen
         else
            exit
         end if
         i = i + 1
      end do
      power = 0
      if (at_point >= 0) power = at_point - n_seen
      n_low = max(n_digit - CHUNK, 0)
      exact = n_low <= CHUNK
      if (n_seen == 0) n_digit = -1
   end subroutine take_digits

   !> Step over an exponent: e, E, d or D and an integer, or a sign and an integer
   pure subroutine take_exponent(text, i, exponent, status)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: i
      integer, intent(out) :: exponent         !! 0 when there is none; held below 100000
      integer, intent(out) :: status           !! NUMBER_FINE or NUMBER_TEXT

      logical :: negative
      integer :: digit, first

      exponent = 0
      status = NUMBER_FINE
      if (i > len(text)) return
      if (index('eEdD+-', text(i:i)) == 0) return
      if (index('eEdD', text(i:i)) > 0) i = i + 1
      call take_sign(text, i, negative)
      first = i
      do while (i <= len(text))
         digit = iachar(text(i:i)) - iachar('0')
         if (digit < 0 .or. digit > 9) exit
         exponent = min(10*exponent + digit, 99999)
         i = i + 1
      end do
      if (i == first) status = NUMBER_TEXT
      if (negative) exponent = -exponent
   end subroutine take_exponent

   !> Only blanks may follow a number
   pure subroutine check_rest(text, i, status)
      character(len=*), intent(in) :: text
      integer, intent(in) :: i
      integer, intent(out) :: status

      integer :: next

      status = NUMBER_FINE
      call skip_blanks(text, i, next)
      if (next > len(text)) return
      status = NUMBER_TEXT
      if (next > i .and. index('0123456789+-.', text(next:next)) > 0) status = NUMBER_INNER_BLANK
   end subroutine check_rest

   !> (high 10**n_low + low) 10**power, rounded once; exact = .false. when that is not certain
   pure subroutine compose(high, low, n_low, power, value, exact)
      real(wp), intent(in) :: high, low
      integer, intent(in) :: n_low, power
      real(wp), intent(out) :: value
      logical, intent(out) :: exact

      real(wp) :: m, m_rest, p, p_rest, half_gap

      value = 0.0_wp
      exact = abs(power) <= 22
      if (.not. exact) return
      if (n_low == 0) then
         if (power < 0) value = high/TEN(-power)
         if (power >= 0) value = high*TEN(power)
         return
      end if
      ! The whole mantissa as a pair: 30 digits fit in the 106 bits of two reals.
      call product_pair(high, TEN(n_low), p, p_rest)
      call sum_pair(p, low, m, m_rest)
      m_rest = m_rest + p_rest
      call sum_pair(m, m_rest, p, p_rest)
      m = p
      m_rest = p_rest
      if (power >= 0) then
         call product_pair(m, TEN(power), p, p_rest)
         p_rest = p_rest + m_rest*TEN(power)
      else
         p = m/TEN(-power)
         call product_pair(p, TEN(-power), half_gap, p_rest)
         p_rest = (((m - half_gap) - p_rest) + m_rest)/TEN(-power)
      end if
      call sum_pair(p, p_rest, value, m_rest)
      ! The pair rounds to `value` unless the rest is at the middle between two reals.
      half_gap = 0.5_wp*spacing(value)
      if (fraction(value) <= 0.5_wp .and. m_rest < 0.0_wp) half_gap = 0.5_wp*half_gap
      exact = abs(m_rest) < half_gap*(1.0_wp - 2.0_wp**(-30))
   end subroutine compose

   !> a + b as a rounded sum and its exact rest
   pure subroutine sum_pair(a, b, s, rest)
      real(wp), intent(in) :: a, b
      real(wp), intent(out) :: s, rest

      real(wp) :: part

      s = a + b
      part = s - a
      rest = (a - (s - part)) + (b - part)
   end subroutine sum_pair

   !> a b as a rounded product and its exact rest, by splitting both into 26-bit halves
   pure subroutine product_pair(a, b, p, rest)
      real(wp), intent(in) :: a, b
      real(wp), intent(out) :: p, rest

      real(wp), parameter :: SPLITTER = 2.0_wp**27 + 1.0_wp
      real(wp) :: t, a_high, a_low, b_high, b_low

      p = a*b
      t = SPLITTER*a
      a_high = t - (t - a)
      a_low = a - a_high
      t = SPLITTER*b
      b_high = t - (t - b)
      b_low = b - b_high
      rest = ((a_high*b_high - p) + a_high*b_low + a_low*b_high) + a_low*b_low
   end subroutine product_pair

   !> The text is a number in form: let a formatted read have it
   pure subroutine read_real(text, value, status)
      character(len=*), intent(in) :: text
      real(wp), intent(out) :: value
      integer, intent(out) :: status

      character(len=12) :: form
      integer :: stat

      write (form, '(a,i0,a)') '(f', len(text), '.0)'
      read (text, form, iostat=stat) value
      status = NUMBER_FINE
      if (stat == 0 .and. abs(value) <= huge(value)) return
      value = 0.0_wp
      status = NUMBER_NOT_FINITE
   end subroutine read_real

   !> The text is one of the words for infinity or not-a-number
   pure logical function is_not_finite(text)
      character(len=*), intent(in) :: text

      character(len=*), parameter :: BIG = 'INFATY', SMALL = 'infaty'
      character(len=8) :: word
      integer :: i, k

      word = text
      do i = 1, len(word)
         k = index(SMALL, word(i:i))
         if (k > 0) word(i:i) = BIG(k:k)
      end do
      is_not_finite = len_trim(text) <= 8 .and. &
         (word == 'INF' .or. word == 'INFINITY' .or. word == 'NAN')
   end function is_not_finite

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

end module kj_number
