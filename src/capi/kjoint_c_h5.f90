!> The C function that writes a history file, of a library with HDF5.
module kjoint_c_h5
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int
   use kj_error, only: error_t, ERR_FILE
   use kj_sink_h5, only: sink_h5_t
   use kjoint_c_base, only: box_t, entered, outcome, refuse, get_text, OF_MODEL
   implicit none
   private

   public :: kj_model_write_history

contains

   !> See kjoint.h
   integer(c_int) function kj_model_write_history(model, path) bind(c) result(status)
      type(c_ptr), value :: model, path

      type(box_t), pointer :: box
      type(sink_h5_t) :: sink
      type(error_t), allocatable :: error, other
      character(len=:), allocatable :: outcome_text
      integer :: i

      if (.not. entered(model, OF_MODEL, box, status)) return
      if (.not. allocated(box%samples%rows)) then
         status = refuse('there are no samples', box%message)
         return
      end if
      call get_text(path, sink%path)
      sink%command_line = 'kj_model_write_history'
      call sink%open(box%samples%history, error)
      do i = 1, box%samples%n_row
         if (.not. allocated(error)) call sink%put(box%samples%rows(:, i), error)
      end do
      if (allocated(error)) then
         call sink%close('ERROR TERMINATION', box%samples%cycles, ERR_FILE, other)
      else
         outcome_text = box%samples%status
         if (outcome_text == 'RUNNING') outcome_text = 'NORMAL TERMINATION'   ! stepped by a host
         call sink%close(outcome_text, box%samples%cycles, box%samples%exit_code, error)
      end if
      status = outcome(error, box%message)
   end function kj_model_write_history

end module kjoint_c_h5
