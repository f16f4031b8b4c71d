!> What the commands that run a deck have in common: options of a run, engine deck, exit code.
module kj_run_arguments
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, code_of, ERR_INPUT
   use kj_number, only: parse_integer, NUMBER_FINE
   use kj_team, only: has_threads, processors
   use kj_terminal, only: environment
   use kj_option, only: arguments_t, option_t, option, FIRST_RUN, OPT_LEGACY
   use kjoint, only: run_options_t, run_options, set_run_option, holds_engine
   implicit none
   private

   public :: take_run_options, find_engine, exit_code

   interface
      subroutine kj_wait_passively() bind(c)
      end subroutine kj_wait_passively
   end interface

contains

   !> Run options of the command line; threads else as OMP_NUM_THREADS says. Where they are several
   !> the program starts once more, with threads that sleep while they wait.
   !>
   !> Errors: ERR_INPUT when one has a wrong value, or --legacy meets another formulation
   subroutine take_run_options(args, options, error)
      type(arguments_t), intent(in) :: args
      type(run_options_t), intent(inout) :: options    !! those that are not given stay
      type(error_t), allocatable, intent(out) :: error

      type(option_t) :: o
      integer :: i, number, status

      call parse_integer(environment('OMP_NUM_THREADS'), number, status)
      if (status == NUMBER_FINE .and. has_threads()) options%threads = max(1, number)
      do i = 1, size(run_options)
         o = option(FIRST_RUN + i)
         if (.not. args%given(o%id)) cycle
         call set_run_option(i, trim(o%name), args%value(o%id)%s, options, error)
         if (allocated(error)) return
      end do
      if (has_threads()) then
         if (min(options%threads, processors()) > 1) call kj_wait_passively()
      end if
      if (.not. args%given(OPT_LEGACY)) return
      if (all(options%formulation /= ['      ', 'legacy'])) call fail(error, ERR_INPUT, &
         '--legacy does not go with --formulation '//trim(options%formulation))
      options%formulation = 'legacy'
   end subroutine take_run_options

   !> The engine deck: that of the command line, else ROOT_0001.rad beside ROOT_0000.rad, else ''.
   !>
   !> Errors: ERR_INPUT when there is none and the options do not say when to end and to sample,
   !> unless there is no starter deck either
   subroutine find_engine(args, options, engine, error)
      type(arguments_t), intent(in) :: args
      type(run_options_t), intent(in) :: options
      character(len=:), allocatable, intent(out) :: engine
      type(error_t), allocatable, intent(out) :: error

      integer :: cut
      logical :: exists

      associate (starter => args%operand(1)%s)
         engine = ''
         cut = index(starter, '_0000.rad', back=.true.)
         if (args%n_operand == 2) then
            engine = args%operand(2)%s
         else if (cut > 0) then
            inquire (file=starter(:cut)//'0001.rad', exist=exists)
            if (exists) engine = starter(:cut)//'0001.rad'
         end if
         if (engine /= '' .or. min(options%until, options%sample) >= 0.0_wp) return
         inquire (file=starter, exist=exists)
         if (.not. exists) return
         if (holds_engine(starter)) return
         call fail(error, ERR_INPUT, 'no engine deck: '//starter//' has none beside it')
         error%hint = 'name one, or give --until T and --sample DT'
      end associate
   end subroutine find_engine

   !> Exit code that findings and an error ask for
   integer function exit_code(findings, error) result(code)
      type(finding_list_t), intent(in) :: findings
      type(error_t), intent(in), allocatable :: error

      code = code_of(findings)
      if (allocated(error)) code = error%code
   end function exit_code

end module kj_run_arguments
