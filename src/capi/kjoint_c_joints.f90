!> C functions that make the joints of a host: convert, call, convert back. include/kjoint.h is
!> their documentation.
module kjoint_c_joints
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_size_t, c_double, c_f_pointer, &
      c_associated
   use kj_error, only: error_t, ERR_INPUT, finding_list_t
   use kj_joint_types, only: joint_types, find_joint_type, NDOF
   use kj_host, only: joint_spec_t, joint_result_t
   use kjoint, only: new_joint_set, add_joint_curve, add_joint, start_joints, take_joints, &
      joint_forces, joint_stiffness, critical_step, joint_count, joint_result, joint_energy, &
      joint_warnings, joint_state_size, save_joints, restore_joints
   use kjoint_c_base, only: box_t, entered, has_room, hand_out, release, outcome, refuse, &
      put_text, OK, OF_JOINTS, OF_MODEL, put_count, list_findings, c_joint_result_t, c_joint_result
   use kj_system, only: c_text
   implicit none
   private

   public :: kj_joint_type, kj_joint_spec_init, kj_joints_new, kj_joints_free, kj_joints_message, &
      kj_joints_curve, kj_joints_add, kj_joints_start, kj_joints_take, kj_joints_forces, &
      kj_joints_stiffness, kj_joints_critical_step, kj_joints_count, kj_joints_result, &
      kj_joints_energy, kj_joints_warnings, kj_joints_state_size, kj_joints_save, &
      kj_joints_restore

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
      call c_text(formulation, text)
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

   !> See kjoint.h
   integer(c_int) function kj_joints_forces(joints, time, h, n, x, v, omega, attitude, f, m) &
      bind(c) result(status)
      type(c_ptr), value :: joints, x, v, omega, attitude, f, m
      real(c_double), value :: time, h
      integer(c_int), value :: n

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: xs(:, :), vs(:, :), ws(:, :), turns(:, :), fs(:, :), ms(:, :)

      if (.not. entered(joints, OF_JOINTS, box, status, n >= 0 .and. c_associated(x) .and. &
         c_associated(v) .and. c_associated(omega) .and. c_associated(f) .and. c_associated(m), &
         'n is negative, or x, v, omega, f or m is null')) return
      call c_f_pointer(x, xs, [3, int(n)])
      call c_f_pointer(v, vs, [3, int(n)])
      call c_f_pointer(omega, ws, [3, int(n)])
      call c_f_pointer(f, fs, [3, int(n)])
      call c_f_pointer(m, ms, [3, int(n)])
      turns => null()                            ! an argument that is absent
      if (c_associated(attitude)) call c_f_pointer(attitude, turns, [4, int(n)])
      call joint_forces(box%set, time, h, xs, vs, ws, fs, ms, error, turns)
      status = outcome(error, box%message)
   end function kj_joints_forces

   !> See kjoint.h
   integer(c_int) function kj_joints_stiffness(joints, n, kn, kr) bind(c) result(status)
      type(c_ptr), value :: joints, kn, kr
      integer(c_int), value :: n

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: k(:), r(:)

      if (.not. entered(joints, OF_JOINTS, box, status, n >= 0 .and. c_associated(kn) .and. &
         c_associated(kr), 'n is negative, or kn or kr is null')) return
      call c_f_pointer(kn, k, [n])
      call c_f_pointer(kr, r, [n])
      call joint_stiffness(box%set, k, r, error)
      status = outcome(error, box%message)
   end function kj_joints_stiffness

   !> See kjoint.h
   integer(c_int) function kj_joints_critical_step(joints, h) bind(c) result(status)
      type(c_ptr), value :: joints, h

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: step

      if (.not. entered(joints, OF_JOINTS, box, status, c_associated(h), 'h is null')) return
      call c_f_pointer(h, step)
      call critical_step(box%set, step, error)
      status = outcome(error, box%message)
   end function kj_joints_critical_step

   !> See kjoint.h
   integer(c_int) function kj_joints_count(joints, n) bind(c) result(status)
      type(c_ptr), value :: joints, n

      type(box_t), pointer :: box

      if (entered(joints, OF_JOINTS, box, status)) status = put_count(joint_count(box%set), n)
   end function kj_joints_count

   !> See kjoint.h
   integer(c_int) function kj_joints_result(joints, joint, result) bind(c) result(status)
      type(c_ptr), value :: joints, result
      integer(c_int), value :: joint

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      type(c_joint_result_t), pointer :: c
      type(joint_result_t) :: r

      if (.not. entered(joints, OF_JOINTS, box, status, c_associated(result), &
         'result is null')) return
      call joint_result(box%set, min(int(joint), huge(1) - 1) + 1, r, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(result, c)
      c = c_joint_result(r)
   end function kj_joints_result

   !> See kjoint.h
   integer(c_int) function kj_joints_energy(joints, work, dissipated) bind(c) result(status)
      type(c_ptr), value :: joints, work, dissipated

      type(box_t), pointer :: box
      real(c_double), pointer :: w, d

      if (.not. entered(joints, OF_JOINTS, box, status, c_associated(work) .and. &
         c_associated(dissipated), 'work or dissipated is null')) return
      call c_f_pointer(work, w)
      call c_f_pointer(dissipated, d)
      call joint_energy(box%set, w, d)
      box%message = ''
      status = OK
   end function kj_joints_energy

   !> See kjoint.h
   integer(c_int) function kj_joints_warnings(joints, limit, n) bind(c) result(status)
      type(c_ptr), value :: joints, n
      real(c_double), value :: limit

      type(box_t), pointer :: box
      type(finding_list_t) :: findings
      integer(c_int), pointer :: count

      if (.not. entered(joints, OF_JOINTS, box, status, c_associated(n), 'n is null')) return
      call c_f_pointer(n, count)
      call joint_warnings(box%set, limit, findings)
      count = int(findings%n_warning, c_int)
      call list_findings(findings, .false., box%message)
      status = OK
   end function kj_joints_warnings

   !> See kjoint.h
   integer(c_int) function kj_joints_state_size(joints, n) bind(c) result(status)
      type(c_ptr), value :: joints, n

      type(box_t), pointer :: box

      if (entered(joints, OF_JOINTS, box, status)) status = put_count(joint_state_size(box%set), n)
   end function kj_joints_state_size

   !> See kjoint.h
   integer(c_int) function kj_joints_save(joints, n, state) bind(c) result(status)
      type(c_ptr), value :: joints, state
      integer(c_int), value :: n

      status = pass_state(joints, n, state, .true.)
   end function kj_joints_save

   !> See kjoint.h
   integer(c_int) function kj_joints_restore(joints, n, state) bind(c) result(status)
      type(c_ptr), value :: joints, state
      integer(c_int), value :: n

      status = pass_state(joints, n, state, .false.)
   end function kj_joints_restore

   integer(c_int) function pass_state(joints, n, state, keep) result(status)
      type(c_ptr), intent(in) :: joints, state
      integer(c_int), intent(in) :: n
      logical, intent(in) :: keep

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: numbers(:)

      if (.not. entered(joints, OF_JOINTS, box, status, n >= 0 .and. c_associated(state), &
         'n is negative, or state is null')) return
      call c_f_pointer(state, numbers, [n])
      if (keep) call save_joints(box%set, numbers, error)
      if (.not. keep) call restore_joints(box%set, numbers, error)
      status = outcome(error, box%message)
   end function pass_state

end module kjoint_c_joints
