!> C functions that save the state of a model and go back to it. include/kjoint.h is their
!> documentation.
module kjoint_c_state
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_size_t, c_f_pointer, c_associated
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_error, only: error_t, str
   use kjoint, only: save_simulation, restore_simulation, simulation_history
   use kjoint_c_base, only: box_t, entered, outcome, refuse, OK, OF_MODEL
   implicit none
   private

   public :: kj_model_save, kj_model_restore

contains

   !> See kjoint.h
   integer(c_int) function kj_model_save(model, size_of, state, needed) bind(c) result(status)
      type(c_ptr), value :: model, state, needed
      integer(c_size_t), value :: size_of

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      integer(int8), allocatable :: byte(:)
      integer(int8), pointer :: room(:)
      integer(c_size_t), pointer :: n

      if (.not. entered(model, OF_MODEL, box, status)) return
      call save_simulation(box%sim, byte, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      if (c_associated(needed)) then
         call c_f_pointer(needed, n)
         n = size(byte, kind=c_size_t)
      end if
      if (size_of == 0 .and. c_associated(needed)) return
      if (size_of < size(byte, kind=c_size_t) .or. .not. c_associated(state)) then
         status = refuse('the state has '//str(size(byte))// &
            ' bytes, and there is no room for them', box%message)
         return
      end if
      call c_f_pointer(state, room, [size(byte)])
      room = byte
   end function kj_model_save

   !> See kjoint.h
   integer(c_int) function kj_model_restore(model, size_of, state) bind(c) result(status)
      type(c_ptr), value :: model, state
      integer(c_size_t), value :: size_of

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      integer(int8), pointer :: byte(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(state), 'state is null')) return
      call c_f_pointer(state, byte, [size_of])
      call restore_simulation(box%sim, byte, error)
      if (.not. allocated(error)) call box%samples%open(simulation_history(box%sim), error)
      if (.not. allocated(error)) box%stepping = .true.
      status = outcome(error, box%message)
   end function kj_model_restore

end module kjoint_c_state
