!> Where samples go. The solver knows only this type; HDF5 is behind kj_sink_h5.
module kj_sink
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INTERNAL
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

   !> The rows of one run
   type, extends(sink_t), public :: sink_memory_t
      type(history_t) :: history               !! what a row holds
      real(wp), allocatable :: rows(:, :)      !! (history%n_value, >= n_row), the first n_row set
      integer :: n_row = 0
      character(len=:), allocatable :: status  !! "RUNNING" until close
      integer :: cycles = 0, exit_code = 0     !! as close was told
   contains
      procedure :: open => open_memory
      procedure :: put => put_memory
      procedure :: flush => flush_memory
      procedure :: close => close_memory
   end type sink_memory_t

   integer, parameter :: FIRST_ROWS = 64       !! room made at open, doubled when full

contains


   !> Begin anew; rows of an earlier run are dropped
   subroutine open_memory(self, history, error)
      class(sink_memory_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(out) :: error

      if (allocated(error)) return
      self%history = history
      if (allocated(self%rows)) deallocate (self%rows)
      allocate (self%rows(history%n_value, FIRST_ROWS))
      self%n_row = 0
      self%status = 'RUNNING'
      self%cycles = 0
      self%exit_code = 0
   end subroutine open_memory

   !> Keep one row. Errors: ERR_INTERNAL when it has another length or the sink is not open
   subroutine put_memory(self, row, error)
      class(sink_memory_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: longer(:, :)

      if (.not. allocated(self%rows)) then
         call fail(error, ERR_INTERNAL, 'a row came to a history that is not open')
         return
      end if
      if (size(row) /= size(self%rows, 1)) then
         call fail(error, ERR_INTERNAL, 'a row of '//str(size(row))// &
            ' values came to a history of '//str(size(self%rows, 1)))
         return
      end if
      if (self%n_row == size(self%rows, 2)) then
         allocate (longer(size(row), 2*self%n_row))
         longer(:, :self%n_row) = self%rows
         call move_alloc(longer, self%rows)
      end if
      self%n_row = self%n_row + 1
      self%rows(:, self%n_row) = row
   end subroutine put_memory

   !> Nothing to do: rows are readable at once
   subroutine flush_memory(self, error)
      class(sink_memory_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (allocated(error) .or. self%n_row == 0) return
   end subroutine flush_memory

   !> Keep the outcome
   subroutine close_memory(self, status, cycles, exit_code, error)
      class(sink_memory_t), intent(inout) :: self
      character(len=*), intent(in) :: status
      integer, intent(in) :: cycles, exit_code
      type(error_t), allocatable, intent(out) :: error

      if (allocated(error)) return
      self%status = status
      self%cycles = cycles
      self%exit_code = exit_code
   end subroutine close_memory

end module kj_sink
