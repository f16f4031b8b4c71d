!> Errors, warnings and notes as data: what, where, how bad. Nothing here prints or stops.
module kj_error
   implicit none
   private

   public :: error_t, finding_list_t, fail, fail_at, add_finding, add_at, code_of, &
      has_finding, str, width_of

   integer, parameter, public :: ERR_RUN      = 1   !! the run left its valid range (NaN, dt -> 0)
   integer, parameter, public :: ERR_INPUT    = 2   !! the deck or the call is wrong
   integer, parameter, public :: ERR_FILE     = 3   !! a file cannot be read or written
   integer, parameter, public :: ERR_INTERNAL = 4   !! a bug in kjoint

   integer, parameter, public :: SEV_NOTE = 1, SEV_WARNING = 2, SEV_ERROR = 3
   character(len=7), parameter, public :: SEVERITY_NAME(3) = ['note   ', 'warning', 'error  ']

   !> A finding; an unallocated error means success
   type :: error_t
      integer :: code = ERR_INTERNAL             !! ERR_ constant, the exit code of the command line
      integer :: severity = SEV_ERROR            !! SEV_ constant
      character(len=7) :: id = ''                !! stable id, KJ-nnnn or KJ-Ennn
      character(len=:), allocatable :: message   !! one sentence, no location
      character(len=:), allocatable :: label     !! short hint printed after the caret
      character(len=:), allocatable :: hint      !! what to do about it, may be unallocated
      character(len=:), allocatable :: file      !! deck file as the user named it
      character(len=:), allocatable :: text      !! the whole line of the deck
      integer :: line = 0                        !! 1-based; 0 = no place known
      integer :: first = 0, last = 0             !! columns, 1-based, inclusive
   end type error_t

   !> Everything found in a deck, in the order found
   type :: finding_list_t
      type(error_t), allocatable :: item(:)      !! (>= n) the first n are set
      integer :: n = 0
      integer :: n_error = 0, n_warning = 0      !! of these, also those beyond the limit
      integer :: n_left = 0                      !! beyond the limit, counted only
   end type finding_list_t

   integer, parameter :: MOST_TEXT = 400         !! characters of a card or message that are kept
   integer, parameter :: MOST_FINDINGS = 200     !! kept in a list; more are only counted

contains

   !> The part of a text that a message quotes
   pure function excerpt(text) result(part)
      character(len=*), intent(in) :: text
      character(len=min(len(text), MOST_TEXT)) :: part

      part = text
      if (len(text) > MOST_TEXT) part(MOST_TEXT - 2:) = '...'
   end function excerpt

   !> Raise an error without a place in a deck
   subroutine fail(error, code, message, id)
      type(error_t), allocatable, intent(out) :: error
      integer, intent(in) :: code
      character(len=*), intent(in) :: message
      character(len=*), intent(in), optional :: id

      allocate (error)
      error%code = code
      error%message = excerpt(message)
      if (present(id)) error%id = id
   end subroutine fail

   !> Raise an input error that points at columns of a deck line
   subroutine fail_at(error, file, line, text, first, last, message, label)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: file, text, message, label
      integer, intent(in) :: line, first, last

      call fail(error, ERR_INPUT, message)
      error%label = label
      error%file = file
      error%text = excerpt(text)
      error%line = line
      error%first = first
      error%last = last
   end subroutine fail_at

   !> Append a finding; beyond MOST_FINDINGS it is only counted
   subroutine add_finding(list, finding)
      type(finding_list_t), intent(inout) :: list
      type(error_t), intent(in) :: finding

      type(error_t), allocatable :: longer(:)

      if (finding%severity == SEV_ERROR) list%n_error = list%n_error + 1
      if (finding%severity == SEV_WARNING) list%n_warning = list%n_warning + 1
      if (list%n >= 2*MOST_FINDINGS .or. (list%n >= MOST_FINDINGS .and. &
         finding%severity /= SEV_ERROR)) then
         list%n_left = list%n_left + 1
         return
      end if
      if (.not. allocated(list%item)) allocate (list%item(16))
      if (list%n == size(list%item)) then
         allocate (longer(2*list%n))
         longer(:list%n) = list%item(:list%n)
         call move_alloc(longer, list%item)
      end if
      list%n = list%n + 1
      list%item(list%n) = finding
   end subroutine add_finding

   !> Append a finding with its place; `hint` may be empty
   subroutine add_at(list, severity, id, file, line, text, first, last, message, label, hint)
      type(finding_list_t), intent(inout) :: list
      integer, intent(in) :: severity, line, first, last
      character(len=*), intent(in) :: id, file, text, message, label
      character(len=*), intent(in), optional :: hint

      type(error_t), allocatable :: finding

      call fail_at(finding, file, line, text, first, last, message, label)
      finding%severity = severity
      finding%id = id
      if (present(hint)) then
         if (len_trim(hint) > 0) finding%hint = trim(hint)
      end if
      call add_finding(list, finding)
   end subroutine add_at

   !> What a list amounts to: 0 without errors, ERR_FILE when a file is among them, else ERR_INPUT
   pure integer function code_of(list) result(code)
      type(finding_list_t), intent(in) :: list

      code = 0
      if (list%n_error == 0) return
      code = ERR_INPUT
      if (any(list%item(:list%n)%code == ERR_FILE)) code = ERR_FILE
   end function code_of

   !> A finding with this id is in a list
   pure logical function has_finding(list, id)
      type(finding_list_t), intent(in) :: list
      character(len=*), intent(in) :: id

      integer :: i

      has_finding = .true.
      do i = 1, list%n
         if (list%item(i)%id == id) return
      end do
      has_finding = .false.
   end function has_finding

   !> Characters in the decimal text of an integer
   pure integer function width_of(i) result(n)
      integer, intent(in) :: i

      integer :: rest

      n = merge(2, 1, i < 0)
      rest = i/10
      do while (rest /= 0)
         n = n + 1
         rest = rest/10
      end do
   end function width_of

   !> Shortest decimal text of an integer.
   !>
   !> Its length is not deferred: gfortran keeps that of a deferred result in static memory, where
   !> threads would meet.
   pure function str(i) result(text)
      integer, intent(in) :: i
      character(len=width_of(i)) :: text

      write (text, '(i0)') i
   end function str

end module kj_error
