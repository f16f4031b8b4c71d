!> Arithmetic expressions: numbers, names, + - * / ^ **, parentheses, functions of one argument.
module kj_expression
   use kj_kinds, only: wp
   use kj_number, only: parse_real, NUMBER_FINE
   implicit none
   private

   public :: expression_t, names_t, evaluate

   !> Where names get their values
   type, abstract :: names_t
   contains
      procedure(value_of_name), deferred :: value_of
   end type names_t

   abstract interface
      !> Value of a name; found = .false. when there is none
      recursive subroutine value_of_name(self, name, value, found)
         import :: names_t, wp
         class(names_t), intent(inout) :: self
         character(len=*), intent(in) :: name
         real(wp), intent(out) :: value
         logical, intent(out) :: found
      end subroutine value_of_name
   end interface

   !> An expression on its way
   type :: expression_t
      character(len=:), allocatable :: text
      integer :: at = 1                         !! next character
      character(len=:), allocatable :: problem  !! '' while all is well
   end type expression_t

   character(len=5), parameter :: FUNCTIONS(*) = [character(len=5) :: 'SIN', 'COS', 'TAN', 'ASIN', &
      'ACOS', 'ATAN', 'SQRT', 'EXP', 'LN', 'LOG', 'LOG10', 'ABS', 'SINH', 'COSH', 'TANH']
   character(len=*), parameter :: LETTERS = &
      'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_', DIGITS = '0123456789'

contains

   !> Value of an expression; problem = '' when it has one
   recursive subroutine evaluate(text, names, value, problem)
      character(len=*), intent(in) :: text
      class(names_t), intent(inout) :: names
      real(wp), intent(out) :: value
      character(len=:), allocatable, intent(out) :: problem

      type(expression_t) :: e
      integer :: i

      e%text = ''
      do i = 1, len(text)
         if (text(i:i) /= ' ') e%text = e%text//text(i:i)
      end do
      e%problem = ''
      call take_sum(e, names, value)
      if (e%problem == '' .and. e%at <= len(e%text)) e%problem = '"'//e%text(e%at:)// &
         '" is not understood'
      if (e%problem == '' .and. .not. abs(value) <= huge(value)) e%problem = 'it is not finite'
      call move_alloc(e%problem, problem)
   end subroutine evaluate

   !> The character to come; a blank at the end
   pure character(len=1) function next(e) result(c)
      type(expression_t), intent(in) :: e

      c = ' '
      if (e%at <= len(e%text)) c = e%text(e%at:e%at)
   end function next

   !> Terms with + and - between them
   recursive subroutine take_sum(e, names, value)
      type(expression_t), intent(inout) :: e
      class(names_t), intent(inout) :: names
      real(wp), intent(out) :: value

      real(wp) :: other
      character(len=1) :: sign

      call take_product(e, names, value)
      do while (e%problem == '' .and. index('+-', next(e)) > 0)
         sign = next(e)
         e%at = e%at + 1
         call take_product(e, names, other)
         value = merge(value + other, value - other, sign == '+')
      end do
   end subroutine take_sum

   !> Factors with * and / between them
   recursive subroutine take_product(e, names, value)
      type(expression_t), intent(inout) :: e
      class(names_t), intent(inout) :: names
      real(wp), intent(out) :: value

      real(wp) :: other
      character(len=1) :: sign

      call take_power(e, names, value)
      do while (e%problem == '' .and. index('*/', next(e)) > 0)
         sign = next(e)
         e%at = e%at + 1
         call take_power(e, names, other)
         if (sign == '*') value = value*other
         if (sign == '/') value = value/other
      end do
   end subroutine take_product

   !> A value, and what raises it: 2^3^2 is 2^9, -2^2 is -4
   recursive subroutine take_power(e, names, value)
      type(expression_t), intent(inout) :: e
      class(names_t), intent(inout) :: names
      real(wp), intent(out) :: value

      real(wp) :: exponent
      integer :: width

      if (index('+-', next(e)) > 0) then
         width = merge(-1, 1, next(e) == '-')
         e%at = e%at + 1
         call take_power(e, names, value)
         value = width*value
         return
      end if
      call take_value(e, names, value)
      width = 0
      if (next(e) == '^') width = 1
      if (e%at < len(e%text)) then
         if (e%text(e%at:e%at + 1) == '**') width = 2
      end if
      if (width == 0 .or. e%problem /= '') return
      e%at = e%at + width
      call take_power(e, names, exponent)
      if (abs(exponent - nint(exponent)) <= 0.0_wp .and. abs(exponent) < 1.0e6_wp) then
         value = value**nint(exponent)
      else
         value = value**exponent
      end if
   end subroutine take_power

   !> A number, a name, a function, or a sum in parentheses
   recursive subroutine take_value(e, names, value)
      type(expression_t), intent(inout) :: e
      class(names_t), intent(inout) :: names
      real(wp), intent(out) :: value

      character(len=:), allocatable :: name
      integer :: last
      logical :: found

      value = 0.0_wp
      if (e%problem /= '') return
      if (next(e) == '(') then
         e%at = e%at + 1
         call take_sum(e, names, value)
         if (e%problem == '' .and. next(e) /= ')') e%problem = 'a ) is missing'
         e%at = e%at + 1
      else if (index(LETTERS//'&', next(e)) > 0 .and. next(e) /= ' ') then
         if (next(e) == '&') e%at = e%at + 1
         last = verify(e%text(e%at:)//' ', LETTERS//DIGITS) + e%at - 2
         name = e%text(e%at:last)
         e%at = last + 1
         if (next(e) == '(') then
            call take_function(e, names, name, value)
         else
            call names%value_of(name, value, found)
            if (.not. found) e%problem = '"'//name//'" has no value'
         end if
      else
         call take_number(e, value)
      end if
   end subroutine take_value

   !> A number such as 1.5e-3
   subroutine take_number(e, value)
      type(expression_t), intent(inout) :: e
      real(wp), intent(out) :: value

      integer :: last, status

      value = 0.0_wp
      last = verify(e%text(e%at:)//' ', DIGITS//'.') + e%at - 2
      if (last >= e%at .and. last + 2 <= len(e%text)) then
         if (index('eEdD', e%text(last + 1:last + 1)) > 0) then
            if (index(DIGITS//'+-', e%text(last + 2:last + 2)) > 0) &
               last = verify(e%text(last + 3:)//' ', DIGITS) + last + 1
         end if
      end if
      call parse_real(e%text(e%at:last), value, status)
      if (status /= NUMBER_FINE) e%problem = 'a number or a name is missing'
      e%at = last + 1
   end subroutine take_number

   !> A function and its argument; angles are in radians
   recursive subroutine take_function(e, names, name, value)
      type(expression_t), intent(inout) :: e
      class(names_t), intent(inout) :: names
      character(len=*), intent(in) :: name
      real(wp), intent(out) :: value

      real(wp) :: x
      integer :: k, i
      character(len=len(FUNCTIONS)) :: upper

      upper = name
      if (len(name) > len(upper)) upper = ''
      do i = 1, min(len(name), len(upper))
         k = index(LETTERS(27:52), name(i:i))
         if (k > 0) upper(i:i) = LETTERS(k:k)
      end do
      call take_value(e, names, x)
      value = x
      if (e%problem /= '') return
      select case (findloc(FUNCTIONS, upper, 1))
      case (1); value = sin(x)
      case (2); value = cos(x)
      case (3); value = tan(x)
      case (4); value = asin(x)
      case (5); value = acos(x)
      case (6); value = atan(x)
      case (7); value = sqrt(x)
      case (8); value = exp(x)
      case (9, 10); value = log(x)
      case (11); value = log10(x)
      case (12); value = abs(x)
      case (13); value = sinh(x)
      case (14); value = cosh(x)
      case (15); value = tanh(x)
      case default; e%problem = 'there is no function "'//name//'"'
      end select
   end subroutine take_function

end module kj_expression
