!> Where samples go. The solver knows only this type; HDF5 is behind kj_sink_h5.
module kj_sink
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_history, only: history_t
   implicit none
   private

   !> A taker of samples
   type, abstract, public :: sink_t
      !> rows of an older history that stay, set before open; 0: a new history
      integer :: rows_before = 0
   contains
      procedure(open_i), deferred :: open
      procedure(put_i), deferred :: put
      procedure(flush_i), deferred :: flush
      procedure(close_i), deferred :: close
   end type sink_t

   abstract interface
      !> Begin a history; errors: ERR_FILE
      subroutine open_i(self, history, error)
         import :: sink_t, error_t, history_t
         class(sink_t), intent(inout) :: self
         type(history_t), intent(in) :: history
         type(error_t), allocatable, intent(out) :: error
      end subroutine open_i

      !> Take one row; errors: ERR_FILE
      subroutine put_i(self, row, error)
         import :: sink_t, error_t, wp
         class(sink_t), intent(inout) :: self
         real(wp), intent(in) :: row(:)             !! (history%n_value), as history%variable says
         type(error_t), allocatable, intent(out) :: error
      end subroutine put_i

      !> Make everything taken so far readable by others
      subroutine flush_i(self, error)
         import :: sink_t, error_t
         class(sink_t), intent(inout) :: self
         type(error_t), allocatable, intent(out) :: error
      end subroutine flush_i

      !> End the history with the outcome of the run
      subroutine close_i(self, status, cycles, exit_code, error)
         import :: sink_t, error_t
         class(sink_t), intent(inout) :: self
         character(len=*), intent(in) :: status     !! "NORMAL TERMINATION", ...
         integer, intent(in) :: cycles, exit_code
         type(error_t), allocatable, intent(out) :: error
      end subroutine close_i
   end interface

end module kj_sink
