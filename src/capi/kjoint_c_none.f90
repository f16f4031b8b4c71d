!> The C functions that need src/files, of a library without HDF5.
module kjoint_c_none
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int
   use kj_error, only: ERR_FILE
   use kjoint_c_base, only: box_t, entered, refuse, OF_MODEL
   implicit none
   private

   public :: kj_model_write_history, kj_rate_iso18571

contains

   !> See kjoint.h
   integer(c_int) function kj_model_write_history(model, path) bind(c) result(status)
      type(c_ptr), value :: model, path

      type(box_t), pointer :: box

      associate (unused => path)
      end associate
      if (.not. entered(model, OF_MODEL, box, status)) return
      status = refuse('this library was built without HDF5 (KJOINT_IO)', box%message)
      status = ERR_FILE
   end function kj_model_write_history

   !> See kjoint.h
   integer(c_int) function kj_rate_iso18571(n, reference, curve, rating) bind(c) &
      result(status)
      integer(c_int), value :: n
      type(c_ptr), value :: reference, curve, rating

      associate (a => n, b => reference, c => curve, d => rating)
      end associate
      status = ERR_FILE
   end function kj_rate_iso18571

end module kjoint_c_none
