!> C functions that ask and change a model between its steps. include/kjoint.h is their
!> documentation.
module kjoint_c_scene
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_f_pointer, c_associated, &
      c_size_t
   use kj_error, only: error_t, str
   use kj_host, only: joint_result_t
   use kjoint, only: body_state_t, simulation_bodies, simulation_joints, body_state, joint_state, &
      node_position, set_body_load, set_load_factor, set_body_velocity, set_body_pose, lock_joint, &
      save_simulation, restore_simulation, simulation_history
   use kjoint_c_base, only: box_t, entered, outcome, refuse, put_count, c_joint_result_t, &
      c_joint_result, OK, OF_MODEL
   use, intrinsic :: iso_fortran_env, only: int8
   implicit none
   private

   public :: kj_model_body_count, kj_model_joint_count, kj_model_body_ids, kj_model_joint_ids, &
      kj_model_body, kj_model_joint, kj_model_node, kj_model_set_body_load, &
      kj_model_set_load_factor, kj_model_set_body_velocity, kj_model_set_body_pose, &
      kj_model_lock_joint, kj_model_save, kj_model_restore

   !> kj_body
   type, bind(c) :: c_body_t
      integer(c_int) :: id
      real(c_double) :: mass, position(3), attitude(4), velocity(3), omega(3), force(3), moment(3)
   end type c_body_t

contains

   !> See kjoint.h
   integer(c_int) function kj_model_body_count(model, n) bind(c) result(status)
      type(c_ptr), value :: model, n

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) &
         status = put_count(size(simulation_bodies(box%sim)), n)
   end function kj_model_body_count

   !> See kjoint.h
   integer(c_int) function kj_model_joint_count(model, n) bind(c) result(status)
      type(c_ptr), value :: model, n

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) &
         status = put_count(size(simulation_joints(box%sim)), n)
   end function kj_model_joint_count

   !> See kjoint.h
   integer(c_int) function kj_model_body_ids(model, count, ids) bind(c) result(status)
      type(c_ptr), value :: model, ids
      integer(c_int), value :: count

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) status = put_ids(simulation_bodies(box%sim), box, &
         count, ids)
   end function kj_model_body_ids

   !> See kjoint.h
   integer(c_int) function kj_model_joint_ids(model, count, ids) bind(c) result(status)
      type(c_ptr), value :: model, ids
      integer(c_int), value :: count

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) status = put_ids(simulation_joints(box%sim), box, &
         count, ids)
   end function kj_model_joint_ids

   integer(c_int) function put_ids(list, box, count, ids) result(status)
      integer, intent(in) :: list(:)
      type(box_t), intent(inout) :: box
      integer(c_int), intent(in) :: count
      type(c_ptr), intent(in) :: ids

      integer(c_int), pointer :: numbers(:)

      if (count < size(list) .or. .not. c_associated(ids)) then
         status = refuse('there are '//str(size(list))//' ids, and ids has no room for them', &
            box%message)
         return
      end if
      call c_f_pointer(ids, numbers, [size(list)])
      numbers = int(list, c_int)
      status = OK
   end function put_ids

   !> See kjoint.h
   integer(c_int) function kj_model_body(model, id, body) bind(c) result(status)
      type(c_ptr), value :: model, body
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      type(body_state_t) :: b
      type(c_body_t), pointer :: c

      if (.not. entered(model, OF_MODEL, box, status, c_associated(body), 'body is null')) return
      call body_state(box%sim, int(id), b, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(body, c)
      c%id = int(b%id, c_int)
      c%mass = b%mass
      c%position = b%position
      c%attitude = b%attitude
      c%velocity = b%velocity
      c%omega = b%omega
      c%force = b%force
      c%moment = b%moment
   end function kj_model_body

   !> See kjoint.h
   integer(c_int) function kj_model_joint(model, id, result) bind(c) result(status)
      type(c_ptr), value :: model, result
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      type(joint_result_t) :: r
      type(c_joint_result_t), pointer :: c

      if (.not. entered(model, OF_MODEL, box, status, c_associated(result), &
         'result is null')) return
      call joint_state(box%sim, int(id), r, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(result, c)
      c = c_joint_result(r)
   end function kj_model_joint

   !> See kjoint.h
   integer(c_int) function kj_model_node(model, id, x) bind(c) result(status)
      type(c_ptr), value :: model, x
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: place(:)
      real(c_double) :: found(3)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(x), 'x is null')) return
      call node_position(box%sim, int(id), found, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(x, place, [3])
      place = found
   end function kj_model_node

   !> See kjoint.h
   integer(c_int) function kj_model_set_body_load(model, id, force, moment) bind(c) result(status)
      type(c_ptr), value :: model, force, moment
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: f(:), m(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(force) .and. &
         c_associated(moment), 'force or moment is null')) return
      call c_f_pointer(force, f, [3])
      call c_f_pointer(moment, m, [3])
      call set_body_load(box%sim, int(id), f, m, error)
      status = outcome(error, box%message)
   end function kj_model_set_body_load

   !> See kjoint.h
   integer(c_int) function kj_model_set_load_factor(model, id, factor) bind(c) result(status)
      type(c_ptr), value :: model
      integer(c_int), value :: id
      real(c_double), value :: factor

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call set_load_factor(box%sim, int(id), factor, error)
      status = outcome(error, box%message)
   end function kj_model_set_load_factor

   !> See kjoint.h
   integer(c_int) function kj_model_set_body_velocity(model, id, velocity, omega) bind(c) &
      result(status)
      type(c_ptr), value :: model, velocity, omega
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: v(:), w(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(velocity) .and. &
         c_associated(omega), 'velocity or omega is null')) return
      call c_f_pointer(velocity, v, [3])
      call c_f_pointer(omega, w, [3])
      call set_body_velocity(box%sim, int(id), v, w, error)
      status = outcome(error, box%message)
   end function kj_model_set_body_velocity

   !> See kjoint.h
   integer(c_int) function kj_model_set_body_pose(model, id, position, attitude) bind(c) &
      result(status)
      type(c_ptr), value :: model, position, attitude
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: x(:), q(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(position) .and. &
         c_associated(attitude), 'position or attitude is null')) return
      call c_f_pointer(position, x, [3])
      call c_f_pointer(attitude, q, [4])
      call set_body_pose(box%sim, int(id), x, q, error)
      status = outcome(error, box%message)
   end function kj_model_set_body_pose

   !> See kjoint.h
   integer(c_int) function kj_model_lock_joint(model, id, locked) bind(c) result(status)
      type(c_ptr), value :: model
      integer(c_int), value :: id, locked

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call lock_joint(box%sim, int(id), locked /= 0, error)
      status = outcome(error, box%message)
   end function kj_model_lock_joint

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

end module kjoint_c_scene
