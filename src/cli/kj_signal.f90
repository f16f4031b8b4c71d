!> SIGINT and SIGTERM: the first asks the run to end well, the second ends the program at once.
!> The flag is the one module variable of kjoint: a signal handler has no other place to write to.
module kj_signal
   use, intrinsic :: iso_c_binding, only: c_int, c_funptr, c_funloc
   implicit none
   private

   public :: watch_signals, caught_signal

   integer(c_int), parameter :: SIGINT = 2, SIGTERM = 15

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

contains

   !> From now on signals are noted instead of ending the program
   subroutine watch_signals()
      type(c_funptr) :: before

      before = c_signal(SIGINT, c_funloc(on_signal))
      before = c_signal(SIGTERM, c_funloc(on_signal))
   end subroutine watch_signals

   !> Number of the signal that came, 0 when none did; 128 more is the exit code
   integer function caught_signal()
      caught_signal = int(caught)
   end function caught_signal

   subroutine on_signal(number) bind(c)
      integer(c_int), value :: number

      if (caught /= 0) call c_exit_now(128_c_int + number)
      caught = number
   end subroutine on_signal

end module kj_signal
