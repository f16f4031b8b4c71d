!> SIGINT, SIGTERM, SIGHUP: the first asks the run to end well, the second ends the program at once.
!> SIGUSR1 asks for a checkpoint, SIGUSR2 for the status.
!> The flag is the one module variable of kjoint: a signal handler has no other place to write to.
module kj_signal
   use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_funptr, c_funloc
   implicit none
   private

   public :: watch_signals, caught_signal, take_wish

   integer, parameter, public :: WISH_CHECKPOINT = 1, WISH_STATUS = 2

   integer(c_int), parameter :: SIGHUP = 1, SIGINT = 2, SIGTERM = 15, &
      SIGUSR1 = 10, SIGUSR2 = 12                  ! of Linux
   integer(c_intptr_t), parameter :: SIG_IGN = 1

   interface
      type(c_funptr) function c_signal(number, handler) bind(c, name='signal')
         import :: c_int, c_funptr
         integer(c_int), value :: number
         type(c_funptr), value :: handler
      end function c_signal
      subroutine c_exit_now(code) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: code
      end subroutine c_exit_now
   end interface

   integer(c_int), volatile :: caught = 0      !! number of the first signal
   logical, volatile :: wish(2) = .false.      !! by WISH_ constant

contains

   !> From now on signals are noted instead of ending the program
   subroutine watch_signals()
      type(c_funptr) :: before

      before = c_signal(SIGINT, c_funloc(on_signal))
      before = c_signal(SIGTERM, c_funloc(on_signal))
      before = c_signal(SIGUSR1, c_funloc(on_wish))
      before = c_signal(SIGUSR2, c_funloc(on_wish))
      before = c_signal(SIGHUP, c_funloc(on_signal))
      if (transfer(before, SIG_IGN) == SIG_IGN) before = c_signal(SIGHUP, before)    ! nohup
   end subroutine watch_signals

   !> Number of the signal that came, 0 when none did; 128 more is the exit code
   integer function caught_signal()
      caught_signal = int(caught)
   end function caught_signal

   !> Whether something was asked for since the last call
   logical function take_wish(kind)
      integer, intent(in) :: kind                !! WISH_ constant

      take_wish = wish(kind)
      wish(kind) = .false.
   end function take_wish

   subroutine on_wish(number) bind(c)
      integer(c_int), value :: number

      if (number == SIGUSR1) wish(WISH_CHECKPOINT) = .true.
      if (number == SIGUSR2) wish(WISH_STATUS) = .true.
   end subroutine on_wish

   subroutine on_signal(number) bind(c)
      integer(c_int), value :: number

      if (caught /= 0) call c_exit_now(128_c_int + number)
      caught = number
   end subroutine on_signal

end module kj_signal
