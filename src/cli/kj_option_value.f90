!> What is given to options that take a number.
module kj_option_value
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE
   use kj_team, only: has_threads
   use kj_terminal, only: environment
   use kj_option, only: arguments_t, options, OPT_THREADS
   implicit none
   private

   public :: option_real, option_threads

contains

   !> Value of an option that takes a real number; `value` is kept when the option is not given
   !>
   !> Errors: ERR_INPUT when it is no number or below `least`
   subroutine option_real(args, row, least, value, error)
      type(arguments_t), intent(in) :: args
      integer, intent(in) :: row               !! OPT_ constant
      real(wp), intent(in) :: least
      real(wp), intent(inout) :: value
      type(error_t), allocatable, intent(out) :: error

      integer :: status
      real(wp) :: number

      if (.not. args%given(row)) return
      call parse_real(args%value(row)%s, number, status)
      if (status /= NUMBER_FINE) then
         call fail(error, ERR_INPUT, trim(options(row)%name)//' needs a number, not "'// &
                   args%value(row)%s//'"')
      else if (number < least) then
         call fail(error, ERR_INPUT, trim(options(row)%name)//' is too small: '// &
                   args%value(row)%s)
      else
         value = number
      end if
   end subroutine option_real

   !> --threads, else OMP_NUM_THREADS, else 1
   !>
   !> Errors: ERR_INPUT when --threads is no whole number from 1
   subroutine option_threads(args, threads, error)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: threads
      type(error_t), allocatable, intent(out) :: error

      integer :: number, status

      threads = 1
      call parse_integer(environment('OMP_NUM_THREADS'), number, status)
      if (status == NUMBER_FINE) threads = max(1, number)
      if (.not. args%given(OPT_THREADS)) return
      call parse_integer(args%value(OPT_THREADS)%s, threads, status)
      if (status == NUMBER_FINE .and. threads > 1 .and. .not. has_threads()) call fail(error, &
         ERR_INPUT, 'this kjoint was built without OpenMP: it has one thread')
      if (status == NUMBER_FINE .and. threads > 0) return
      call fail(error, ERR_INPUT, '--threads needs a whole number from 1, not "'// &
         args%value(OPT_THREADS)%s//'"')
   end subroutine option_threads

end module kj_option_value
