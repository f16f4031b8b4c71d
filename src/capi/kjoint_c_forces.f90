!> C functions of the joints of a host over time: convert, call, convert back. include/kjoint.h is
!> their documentation.
module kjoint_c_forces
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_f_pointer, c_associated
   use kj_error, only: error_t, finding_list_t
   use kj_host, only: joint_result_t
   use kjoint, only: joint_forces, joint_stiffness, critical_step, joint_count, joint_result, &
      joint_energy, joint_warnings, joint_state_size, save_joints, restore_joints
   use kjoint_c_base, only: box_t, entered, outcome, put_count, list_findings, c_joint_result_t, &
      c_joint_result, OK, OF_JOINTS
   implicit none
   private

   public :: kj_joints_forces, kj_joints_stiffness, kj_joints_critical_step, kj_joints_count, &
      kj_joints_result, kj_joints_energy, kj_joints_warnings, kj_joints_state_size, &
      kj_joints_save, kj_joints_restore

contains

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

end module kjoint_c_forces
