!> A Radioss T01 into any sink: `kjoint convert`.
module kj_convert
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_history, only: history_t
   use kj_sink, only: sink_t
   use kj_t01, only: t01_reader_t, open_t01, read_t01_rows, close_t01
   implicit none
   private

   public :: convert_t01

   integer, parameter :: BLOCK = 2**18       !! reals in memory at a time, about

contains

   !> Write all complete rows of a T01 to a sink
   !>
   !> The sink is closed with "NORMAL TERMINATION": what a T01 says nothing of (the outcome of the
   !> run) is not looked into; cycles are 0.
   !> Errors: ERR_FILE when the T01 cannot be read or the sink cannot be written.
   subroutine convert_t01(t01_path, sink, error)
      character(len=*), intent(in) :: t01_path
      class(sink_t), intent(inout) :: sink
      type(error_t), allocatable, intent(out) :: error

      type(t01_reader_t) :: reader
      type(history_t) :: history
      type(error_t), allocatable :: closing
      real(wp), allocatable :: rows(:, :)
      integer :: n_row, first, n, i

      call open_t01(t01_path, reader, history, n_row, error)
      if (allocated(error)) return
      call sink%open(history, error)
      if (allocated(error)) then
         call close_t01(reader)
         return
      end if
      allocate (rows(history%n_value, max(1, min(n_row, BLOCK/history%n_value))))
      first = 1
      do while (first <= n_row .and. .not. allocated(error))
         n = min(size(rows, 2), n_row - first + 1)
         call read_t01_rows(reader, first, n, rows, error)
         do i = 1, n
            if (allocated(error)) exit
            call sink%put(rows(:, i), error)
         end do
         first = first + n
      end do
      call close_t01(reader)
      if (allocated(error)) then
         call sink%close('ERROR '//error%message, 0, error%code, closing)
      else
         call sink%close('NORMAL TERMINATION', 0, 0, error)
      end if
   end subroutine convert_t01

end module kj_convert
