!> C functions that make the joints of a host: convert, call, convert back. include/kjoint.h is
!> their documentation.
module kjoint_c_joints
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_size_t, c_double, c_f_pointer, &
      c_associated
   use kj_error, only: error_t, ERR_INPUT
   use kj_joint_types, only: joint_types, find_joint_type, NDOF
   use kj_host, only: joint_spec_t
   use kjoint, only: new_joint_set, add_joint_curve, add_joint, start_joints, take_joints
   use kjoint_c_base, only: box_t, entered, has_room, hand_out, release, outcome, refuse, &
      get_text, put_text, OK, OF_JOINTS, OF_MODEL
   implicit none
   private

   public :: kj_joint_type, kj_joint_spec_init, kj_joints_new, kj_joints_free, kj_joints_message, &
      kj_joints_curve, kj_joints_add, kj_joints_start, kj_joints_take

   !> kj_joint_spec; nodes and curves count from 0
   type, bind(c) :: c_joint_spec_t
      integer(c_int) :: id, type, node(2), carrier(2), first_frame, axis_node(3, 2)
      real(c_double) :: axes(3, 3), kn, cr, k(6), c(6)
      integer(c_int) :: k_curve(6), c_curve(6)
   end type c_joint_spec_t

contains

   !> See kjoint.h
   integer(c_int) function kj_joint_type(type, name, size, free) bind(c) result(status)
      integer(c_int), value :: type
      type(c_ptr), value :: name, free
      integer(c_size_t), value :: size

      integer(c_int), pointer :: dofs(:)
      integer :: row

      status = ERR_INPUT
      row = find_joint_type(int(type))
      if (row == 0 .or. .not. c_associated(free)) return
      call c_f_pointer(free, dofs, [NDOF])
      dofs = int(joint_types(row)%free, c_int)
      status = put_text(trim(joint_types(row)%name), name, size)
   end function kj_joint_type

   !> See kjoint.h
   integer(c_int) function kj_joint_spec_init(spec) bind(c) result(status)
      type(c_ptr), value :: spec

      type(c_joint_spec_t), pointer :: s
      type(joint_spec_t) :: default

      status = ERR_INPUT
      if (.not. c_associated(spec)) return
      call c_f_pointer(spec, s)
      s%id = 0
      s%type = 0
      s%node = -1
      s%carrier = -1
      s%first_frame = 0
      s%axis_node = -1
      s%axes = default%axes
      s%kn = 0.0_c_double
      s%cr = 0.0_c_double
      s%k = 0.0_c_double
      s%c = 0.0_c_double
      s%k_curve = -1
      s%c_curve = -1
      status = OK
   end function kj_joint_spec_init

   !> See kjoint.h
   integer(c_int) function kj_joints_new(formulation, n_node, joints, message, size) bind(c) &
      result(status)
      type(c_ptr), value :: formulation, joints, message
      integer(c_int), value :: n_node
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text

      if (.not. has_room(joints, .true., 'joints is null', message, size, status)) return
      allocate (box)
      call get_text(formulation, text)
      call new_joint_set(box%set, text, int(n_node), error)
      status = outcome(error, text)
      call hand_out(box, OF_JOINTS, status, text, message, size, joints)
   end function kj_joints_new

   !> See kjoint.h
   subroutine kj_joints_free(joints) bind(c)
      type(c_ptr), value :: joints

      call release(joints, OF_JOINTS)
   end subroutine kj_joints_free

   !> See kjoint.h
   integer(c_int) function kj_joints_message(joints, buffer, size) bind(c) result(status)
      type(c_ptr), value :: joints, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box

      if (entered(joints, OF_JOINTS, box, status)) status = put_text(box%message, buffer, size)
   end function kj_joints_message

   !> See kjoint.h
   integer(c_int) function kj_joints_curve(joints, n, x, y, curve) bind(c) result(status)
      type(c_ptr), value :: joints, x, y, curve
      integer(c_int), value :: n

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: xs(:), ys(:)
      integer(c_int), pointer :: number
      integer :: place

      if (.not. entered(joints, OF_JOINTS, box, status, n >= 0 .and. c_associated(x) .and. &
         c_associated(y) .and. c_associated(curve), &
         'n is negative, or x, y or curve is null')) return
      call c_f_pointer(x, xs, [n])
      call c_f_pointer(y, ys, [n])
      call c_f_pointer(curve, number)
      call add_joint_curve(box%set, xs, ys, place, error)
      number = int(place - 1, c_int)
      status = outcome(error, box%message)
   end function kj_joints_curve

   !> See kjoint.h
   integer(c_int) function kj_joints_add(joints, spec) bind(c) result(status)
      type(c_ptr), value :: joints, spec

      type(box_t), pointer :: box
      type(c_joint_spec_t), pointer :: s
      type(joint_spec_t) :: joint
      type(error_t), allocatable :: error

      if (.not. entered(joints, OF_JOINTS, box, status, c_associated(spec), 'spec is null')) return
      call c_f_pointer(spec, s)
      joint%id = s%id
      joint%type = s%type
      joint%node = from_zero(s%node)
      joint%carrier = from_zero(s%carrier)
      joint%first_frame = s%first_frame /= 0
      joint%axis_node = reshape(from_zero(reshape(s%axis_node, [6])), [3, 2])
      joint%axes = s%axes
      joint%kn = s%kn
      joint%cr = s%cr
      joint%k = s%k
      joint%c = s%c
      joint%k_curve = from_zero(s%k_curve)
      joint%c_curve = from_zero(s%c_curve)
      call add_joint(box%set, joint, error)
      status = outcome(error, box%message)
   end function kj_joints_add

   !> Numbers from 0 to numbers from 1; -1 to none; what is below stays wrong
   elemental integer function from_zero(i) result(j)
      integer(c_int), intent(in) :: i

      j = i
      if (i >= -1 .and. i < huge(i)) j = i + 1
   end function from_zero

   !> See kjoint.h
   integer(c_int) function kj_joints_start(joints, n, x, mass, inertia, attitude) bind(c) &
      result(status)
      type(c_ptr), value :: joints, x, mass, inertia, attitude
      integer(c_int), value :: n

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: xs(:, :), masses(:), inertias(:, :), turns(:, :)

      if (.not. entered(joints, OF_JOINTS, box, status, n >= 0 .and. c_associated(x) .and. &
         c_associated(mass) .and. c_associated(inertia), &
         'n is negative, or x, mass or inertia is null')) return
      call c_f_pointer(x, xs, [3, int(n)])
      call c_f_pointer(mass, masses, [n])
      call c_f_pointer(inertia, inertias, [3, int(n)])
      turns => null()                            ! an argument that is absent
      if (c_associated(attitude)) call c_f_pointer(attitude, turns, [4, int(n)])
      call start_joints(box%set, xs, masses, inertias, error, turns)
      status = outcome(error, box%message)
   end function kj_joints_start

   !> See kjoint.h
   integer(c_int) function kj_joints_take(joints, model, n, node_id, attitude) bind(c) &
      result(status)
      type(c_ptr), value :: joints, model, node_id, attitude
      integer(c_int), value :: n

      character(len=*), parameter :: NO_NODES = 'n is negative, or model or node_id is null'
      type(box_t), pointer :: box
      type(box_t), pointer :: scene
      type(error_t), allocatable :: error
      integer(c_int), pointer :: ids(:)
      real(c_double), pointer :: turns(:, :)

      if (.not. entered(joints, OF_JOINTS, box, status, n >= 0 .and. c_associated(node_id), &
         NO_NODES)) return
      if (.not. entered(model, OF_MODEL, scene, status)) then
         status = refuse(NO_NODES, box%message)
         return
      end if
      call c_f_pointer(node_id, ids, [n])
      turns => null()                            ! an argument that is absent
      if (c_associated(attitude)) call c_f_pointer(attitude, turns, [4, int(n)])
      call take_joints(box%set, scene%sim, ids, error, turns)
      status = outcome(error, box%message)
   end function kj_joints_take

end module kjoint_c_joints
