!> The C functions that need src/files: history files, the rating of curves.
module kjoint_c_h5
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_f_pointer, c_associated
   use kj_error, only: error_t, ERR_FILE, ERR_INPUT
   use kj_metrics, only: iso18571_t, rate_iso18571
   use kj_sink_h5, only: sink_h5_t
   use kjoint_c_base, only: box_t, entered, outcome, refuse, OF_MODEL, OK
   use kj_system, only: c_text
   implicit none
   private

   public :: kj_model_write_history, kj_rate_iso18571

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
      call c_text(path, sink%path)
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

   !> See kjoint.h
   integer(c_int) function kj_rate_iso18571(n, reference, curve, rating) bind(c) &
      result(status)
      integer(c_int), value :: n
      type(c_ptr), value :: reference, curve, rating

      real(c_double), pointer :: t(:), c(:), r
      type(iso18571_t) :: found

      status = ERR_INPUT
      if (n < 0 .or. .not. (c_associated(reference) .and. c_associated(curve) .and. &
         c_associated(rating))) return
      call c_f_pointer(reference, t, [n])
      call c_f_pointer(curve, c, [n])
      call c_f_pointer(rating, r)
      call rate_iso18571(t, c, found)
      r = found%overall
      status = OK
   end function kj_rate_iso18571

end module kjoint_c_h5
