!> /PARAMETER: names with values, and what stands for &name in a field.
!> One file: parameters and the expressions that give their values
module kj_parameter
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, add_finding, SEV_ERROR, SEV_WARNING, ERR_INPUT, str
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE, real_text
   use kj_keywords, only: KW_PARAMETER
   use kj_deck_text, only: deck_t, line_text, first_card, add_deck_finding, report_header, &
      block_at
   implicit none
   private

   public :: parameters_t, setting_t, read_parameters, replace_names, report_unused

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

   integer, parameter :: LETTER_COUNT = 10       !! characters of a name
   integer, parameter :: LONGEST_NUMBER = 20     !! columns
   integer, parameter :: MOST_LINES = 10         !! of an expression
   integer, parameter :: DEEPEST = 1000          !! expressions that name each other in a row

   !> name=value from outside, which takes the place of the value in the deck
   type :: setting_t
      character(len=:), allocatable :: name, value
   end type setting_t

   !> What a parameter holds
   integer, parameter :: A_REAL = 1, AN_INTEGER = 2, A_TEXT = 3

   !> One parameter
   type :: parameter_t
      character(len=LETTER_COUNT) :: name = ''
      integer :: kind = A_REAL
      logical :: expression = .false., used = .false., under_way = .false.
      !> known in the file or submodel of this block alone; 0 = everywhere
      integer :: source = 0, submodel = 0
      integer :: line = 0                        !! of its card, index in deck
      character(len=:), allocatable :: text      !! its value; until it is worked out, an expression
   end type parameter_t

   !> All of a deck
   type, extends(names_t) :: parameters_t
      type(parameter_t), allocatable :: item(:)
      integer :: from = 0                        !! line that asks for a name
      integer :: depth = 0                       !! expressions under way
      logical :: outside = .false.               !! some name was given from outside
      type(deck_t), pointer :: deck => null()
   contains
      procedure :: value_of
   end type parameters_t

contains

   !> All parameters of a deck; settings take the place of values
   !>
   !> Errors: findings, KJ-9403 to KJ-9407
   subroutine read_parameters(deck, settings, list)
      type(deck_t), intent(inout), target :: deck
      type(setting_t), intent(in) :: settings(:)
      type(parameters_t), intent(inout) :: list

      type(error_t), allocatable :: error
      integer :: i, k, n, block
      logical :: found

      list%deck => deck
      n = count(deck%block(:deck%n_block)%keyword == KW_PARAMETER)
      allocate (list%item(n))
      n = 0
      do block = 1, deck%n_block
         if (deck%block(block)%keyword /= KW_PARAMETER) cycle
         n = n + 1
         call read_parameter(deck, block, list%item(n))
      end do
      do i = 1, size(settings)
         found = .false.
         do k = 1, n
            if (list%item(k)%name /= settings(i)%name) cycle
            found = .true.
            list%item(k)%text = settings(i)%value
            list%item(k)%expression = .false.
            call check_value(deck, list%item(k))
            call shorten(list%item(k))
         end do
         if (found) cycle
         call fail(error, ERR_INPUT, 'the deck has no parameter '//settings(i)%name, 'KJ-9407')
         call add_finding(deck%findings, error)
      end do
      do k = 1, n
         call work_out(list, k)
      end do
   end subroutine read_parameters

   !> Name, kind, scope and value of one block
   subroutine read_parameter(deck, block, p)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block
      type(parameter_t), intent(inout) :: p

      character(len=:), allocatable :: header
      character(len=100) :: card
      integer :: line, length, status

      header = line_text(deck, deck%block(block)%header)
      line = first_card(deck, block)
      p%line = line
      p%text = ''
      card = ''
      if (line <= deck%block(block)%last) card = line_text(deck, line)
      p%name = adjustl(card(:LETTER_COUNT))
      if (index(header, '/LOCAL') > 0) then
         p%submodel = deck%block(block)%submodel
         if (p%submodel == 0) p%source = deck%line_source(deck%block(block)%header)
      end if
      p%expression = index(header, '_EXPR') > 0
      if (index(header, '/INT') > 0) p%kind = AN_INTEGER
      if (index(header, '/TEXT') > 0) p%kind = A_TEXT
      if (p%expression) then
         p%text = trim(card(11:))
         do line = line + 1, min(line + MOST_LINES - 1, deck%block(block)%last)   ! it may go on
            p%text = p%text//trim(line_text(deck, line))
         end do
      else if (p%kind == AN_INTEGER) then
         p%text = trim(adjustl(card(11:20)))
      else if (p%kind == A_REAL) then
         p%text = trim(adjustl(card(11:30)))
      else if (line < deck%block(block)%last) then
         p%text = trim(line_text(deck, line + 1))
         call parse_integer(trim(card(11:20)), length, status)
         if (status /= NUMBER_FINE .or. length <= 0) length = len(p%text)
         p%text = trim(p%text(:min(length, len(p%text))))
      end if
      if (p%name == '') call report_header(deck, block, SEV_ERROR, 'KJ-9403', &
         'the parameter has no name', 'expected: a name in columns 1 to 10 of its card')
      if (.not. p%expression) call check_value(deck, p)
   end subroutine read_parameter

   !> A value must be what its kind says
   subroutine check_value(deck, p)
      type(deck_t), intent(inout) :: deck
      type(parameter_t), intent(in) :: p

      real(wp) :: x
      integer :: i, status

      status = NUMBER_FINE
      if (p%kind == A_REAL) call parse_real(p%text, x, status)
      if (p%kind == AN_INTEGER) call parse_integer(p%text, i, status)
      if (status == NUMBER_FINE) return
      call add_deck_finding(deck, p%line, 1, 30, SEV_ERROR, 'KJ-9404', 'the value "'//p%text// &
         '" of parameter '//trim(p%name)//' is no '//merge('real number', 'integer    ', &
         p%kind == A_REAL), 'expected: a number within range')
   end subroutine check_value

   !> A number from outside has no more columns than one in the deck
   pure subroutine shorten(p)
      type(parameter_t), intent(inout) :: p

      real(wp) :: x
      integer :: status

      if (p%kind == A_TEXT .or. len(p%text) <= LONGEST_NUMBER) return
      call parse_real(p%text, x, status)
      if (status == NUMBER_FINE .and. p%kind == A_REAL) p%text = real_text(x, LONGEST_NUMBER)
      if (status == NUMBER_FINE .and. p%kind == AN_INTEGER) p%text = str(nint(x))
   end subroutine shorten

   !> The value of an expression becomes a text
   recursive subroutine work_out(list, k)
      type(parameters_t), intent(inout) :: list
      integer, intent(in) :: k

      character(len=:), allocatable :: problem
      real(wp) :: value
      integer :: from

      if (.not. list%item(k)%expression .or. list%item(k)%under_way) return
      list%item(k)%under_way = .true.
      from = list%from
      list%from = list%item(k)%line
      call evaluate(list%item(k)%text, list, value, problem)
      list%from = from
      list%item(k)%under_way = .false.
      list%item(k)%expression = .false.
      if (problem == '' .and. list%item(k)%kind == AN_INTEGER .and. .not. abs(value) < &
         real(huge(1), wp)) problem = 'it is larger than '//str(huge(1))
      if (problem /= '') then
         call add_deck_finding(list%deck, list%item(k)%line, 11, 100, SEV_ERROR, 'KJ-9405', &
            'the expression of parameter '//trim(list%item(k)%name)//' has no value', problem)
         value = 0.0_wp
      end if
      if (list%item(k)%kind == AN_INTEGER) then
         list%item(k)%text = str(nint(value))
      else
         list%item(k)%text = real_text(value, LONGEST_NUMBER)
      end if
   end subroutine work_out

   !> Value of a name in an expression
   recursive subroutine value_of(self, name, value, found)
      class(parameters_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(out) :: value
      logical, intent(out) :: found

      integer :: k, status, line

      value = 0.0_wp
      line = self%from
      k = place_of_name(self, name, line)
      found = k > 0
      if (.not. found) return
      self%item(k)%used = .true.
      found = .not. self%item(k)%under_way .and. self%item(k)%kind /= A_TEXT .and. &
         self%depth < DEEPEST
      if (.not. found) return
      self%depth = self%depth + 1
      call work_out(self, k)
      self%depth = self%depth - 1
      call parse_real(self%item(k)%text, value, status)
      found = status == NUMBER_FINE
   end subroutine value_of

   !> The parameter that a name means on a line: a local one before a global one; 0 = none
   pure integer function place_of_name(list, name, line) result(k)
      class(parameters_t), intent(in) :: list
      character(len=*), intent(in) :: name
      integer, intent(in) :: line                !! index in deck

      integer :: i, block

      k = 0
      do i = 1, size(list%item)
         if (list%item(i)%name /= name) cycle
         if (list%item(i)%source > 0) then
            if (list%item(i)%source /= list%deck%line_source(line)) cycle
         else if (list%item(i)%submodel > 0) then
            block = max(1, block_at(list%deck, line))
            if (list%item(i)%submodel /= list%deck%block(block)%submodel) cycle
         else if (k > 0) then
            cycle
         end if
         k = i
      end do
   end function place_of_name

   !> The text of a line with values in the place of names
   !>
   !> A value goes into the ten columns of the name, right-justified. A longer one goes on to the
   !> right, or comes from the left where the name ends its ten columns; without room: an error.
   subroutine replace_names(list, line, text)
      type(parameters_t), intent(inout) :: list
      integer, intent(in) :: line                !! index in deck
      character(len=:), allocatable, intent(inout) :: text

      character(len=:), allocatable :: name, value
      integer :: at, last, k, room

      at = index(text, '&')
      do while (at > 0)
         last = verify(text(at + 1:)//' ', &
            'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789') + at - 1
         name = text(at + 1:last)
         k = place_of_name(list, name, line)
         if (k == 0) then
            call add_deck_finding(list%deck, line, at, max(at, last), SEV_ERROR, 'KJ-9015', &
               'there is no parameter '//name, 'no such name', 'define it with /PARAMETER')
            value = '0'
         else
            list%item(k)%used = .true.
            value = list%item(k)%text
         end if
         if (at > 1) then
            if (text(at - 1:at - 1) == '-') then
               at = at - 1
               if (value(:1) == '-') value = ' '//value(2:)
               if (value(:1) /= ' ') value = '-'//value
               value = trim(adjustl(value))
            end if
         end if
         name = text(at:last)
         call put_value(text, at, last, value, room)
         if (len(value) > room) call add_deck_finding(list%deck, line, at - room + 1, at, &
            SEV_ERROR, 'KJ-9404', 'the value "'//value//'" of '//name// &
            ' is longer than its field', 'room for '//str(room)//' columns', 'write fewer digits')
         k = index(text(min(len(text), at + 1):), '&')
         at = merge(k + at, 0, k > 0 .and. at < len(text))
      end do
   end subroutine replace_names

   !> Put a value in the place of columns at to last
   pure subroutine put_value(text, at, last, value, room)
      character(len=:), allocatable, intent(inout) :: text
      integer, intent(inout) :: at               !! then: last column of the value
      integer, intent(in) :: last
      character(len=*), intent(in) :: value
      integer, intent(out) :: room               !! columns that it may have there

      integer :: begin, cell, before

      room = len(value)
      if (index(text, ',') > 0 .or. len(value) > LONGEST_NUMBER) then   ! numbers are no longer
         text = text(:at - 1)//value//text(last + 1:)
         at = at + len(value) - 1
         return
      end if
      cell = 10*((last - 1)/10 + 1)              ! last column of the ten in which the name ends
      begin = cell - 9
      if (len(text) < cell + 10) text = text//repeat(' ', cell + 10 - len(text))
      before = len_trim(text(:at - 1))
      if (text(cell + 1:cell + 10) == '' .and. len(value) > 10 .and. &
         (at == begin .or. last < cell .or. before > begin - 11 .or. begin == 1)) then
         cell = begin + len(value) - 1           ! on to the right
      end if
      text(at:last) = ' '
      at = cell
      room = cell - before
      if (len(value) <= room) then
         text(cell - len(value) + 1:cell) = value
      else
         text(before + 1:cell) = repeat('*', cell - before)
      end if
   end subroutine put_value

   !> A parameter that no field and no expression names
   subroutine report_unused(list)
      type(parameters_t), intent(inout) :: list

      integer :: k

      do k = 1, size(list%item)
         if (list%item(k)%used .or. list%item(k)%name == '') cycle
         call add_deck_finding(list%deck, list%item(k)%line, 1, LETTER_COUNT, SEV_WARNING, &
            'KJ-9406', 'nothing reads the parameter '//trim(list%item(k)%name), 'no effect')
      end do
   end subroutine report_unused

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

end module kj_parameter
