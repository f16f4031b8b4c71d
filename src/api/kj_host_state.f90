!> State of the joints of a host as a flat array: saved, and restored to go on with the same bits.
module kj_host_state
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT, finding_list_t, add_finding, SEV_WARNING
   use kj_legacy_joint, only: legacy_joint_t
   use kj_block, only: rows_at, block_of, lane_of
   use kj_consistent_batch, only: consistent_joint_t
   use kj_host, only: joint_set_t, joint_result_t
   use kj_host_scheme, only: follows_nodes, evaluate, carrier_stiffness, carrier_step, &
      joint_values, find_orthogonality
   use kj_joint_types, only: joint_types
   use kj_host_check, only: check_shape, check_nodes, check_finite, check_attitude
   implicit none
   private

   public :: joint_state_size, save_joints, restore_joints, joint_forces, joint_stiffness, &
      critical_step, joint_count, joint_result, joint_energy, joint_warnings

   real(wp), parameter :: VERSION = 2.0_wp        !! of the layout
   integer, parameter :: HEAD = 6                 !! version, formulation, joints, size, time, step

   !> Where packing stands
   type :: tape_t
      real(wp), allocatable :: a(:)
      integer :: at = 0                          !! numbers passed so far
      logical :: write = .false.                 !! into the array, else out of it
   end type tape_t

contains

   !> Numbers in the state of a set, 0 before the start
   integer function joint_state_size(set) result(n)
      type(joint_set_t), intent(in) :: set

      type(tape_t) :: tape

      n = 0
      if (.not. set%started) return
      allocate (tape%a(0))
      call read_state(set, tape)
      n = HEAD + tape%at
   end function joint_state_size

   !> State of all joints. Errors: ERR_INPUT when the array has not joint_state_size(set) numbers
   subroutine save_joints(set, state, error)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(inout) :: state(:)
      type(error_t), allocatable, intent(out) :: error

      type(tape_t) :: tape

      call check_size(set, size(state), error)
      if (allocated(error)) return
      allocate (tape%a(size(state)))
      state(:HEAD) = heading(set, size(state))
      tape%write = .true.
      call read_state(set, tape)
      state(HEAD + 1:) = tape%a(:size(state) - HEAD)
   end subroutine save_joints

   !> Go back to a saved state of the same joints.
   !>
   !> Errors: ERR_INPUT when the array is not a state of these joints; they are as before then.
   subroutine restore_joints(set, state, error)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: state(:)
      type(error_t), allocatable, intent(out) :: error

      type(tape_t) :: tape

      call check_size(set, size(state), error)
      if (allocated(error)) return
      associate (expected => heading(set, size(state)))
         if (any(abs(state(:4) - expected(:4)) > 0.0_wp) .or. &
            .not. all(ieee_is_finite(state(:HEAD)))) then
            call fail(error, ERR_INPUT, 'the array is no state of these joints')
            return
         end if
      end associate
      tape%a = state(HEAD + 1:)
      call pass_state(set%model%batch%n, set%state%joint, set%cs%joint, tape)
      set%time = state(5)
      set%h_last = state(6)
   end subroutine restore_joints

   subroutine check_size(set, n, error)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: n
      type(error_t), allocatable, intent(out) :: error

      if (.not. set%started) then
         call fail(error, ERR_INPUT, 'the joints have not been started')
      else if (n /= joint_state_size(set)) then
         call fail(error, ERR_INPUT, 'the state has '//str(joint_state_size(set))// &
            ' numbers, not '//str(n))
      end if
   end subroutine check_size

   pure function heading(set, n) result(a)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: n
      real(wp) :: a(HEAD)

      a = [VERSION, merge(1.0_wp, 2.0_wp, follows_nodes(set)), real(set%model%n_joint, wp), &
         real(n, wp), set%time, set%h_last]
   end function heading

   !> State of all batches onto the tape, or its size
   subroutine read_state(set, tape)
      type(joint_set_t), intent(in) :: set
      type(tape_t), intent(inout) :: tape

      type(legacy_joint_t), allocatable :: legacy(:)
      type(consistent_joint_t), allocatable :: consistent(:)
      legacy = set%state%joint
      consistent = set%cs%joint
      call pass_state(set%model%batch%n, legacy, consistent, tape)
   end subroutine read_state

   !> State of all batches onto the tape or off it; of one formulation there are none
   subroutine pass_state(n, legacy, consistent, tape)
      integer, intent(in) :: n(:)                !! joints of each batch
      type(legacy_joint_t), intent(inout) :: legacy(:)
      type(consistent_joint_t), intent(inout) :: consistent(:)
      type(tape_t), intent(inout) :: tape

      integer :: b

      do b = 1, size(legacy)
         call pass_legacy(n(b), legacy(b), tape)
      end do
      do b = 1, size(consistent)
         call pass_consistent(n(b), consistent(b), tape)
      end do
   end subroutine pass_state

   subroutine pass_legacy(n, joint, tape)
      integer, intent(in) :: n                   !! joints
      type(legacy_joint_t), target, intent(inout) :: joint
      type(tape_t), intent(inout) :: tape

      integer :: i, at

      do i = 1, n
         at = block_of(i)
         call pass_row(c_loc(joint%block(at)), storage_size(joint%block), lane_of(i), tape)
         if (allocated(joint%spring)) &
            call pass_row(c_loc(joint%spring(at)), storage_size(joint%spring), lane_of(i), tape)
         if (allocated(joint%limit)) &
            call pass_row(c_loc(joint%limit(at)), storage_size(joint%limit), lane_of(i), tape)
      end do
   end subroutine pass_legacy

   subroutine pass_consistent(n, joint, tape)
      integer, intent(in) :: n                   !! joints
      type(consistent_joint_t), target, intent(inout) :: joint
      type(tape_t), intent(inout) :: tape

      integer :: i, at

      do i = 1, n
         at = block_of(i)
         call pass_row(c_loc(joint%block(at)), storage_size(joint%block), lane_of(i), tape)
         if (allocated(joint%spring)) &
            call pass_row(c_loc(joint%spring(at)), storage_size(joint%spring), lane_of(i), tape)
         if (allocated(joint%limit)) &
            call pass_row(c_loc(joint%limit(at)), storage_size(joint%limit), lane_of(i), tape)
      end do
   end subroutine pass_consistent

   !> What goes with a joint of the block at an address
   subroutine pass_row(block_at, bits, lane, tape)
      type(c_ptr), intent(in) :: block_at
      integer, intent(in) :: bits, lane          !! size of the block, place in it
      type(tape_t), intent(inout) :: tape

      real(wp), pointer :: row(:, :)

      call rows_at(block_at, bits, row)
      call pass(row(lane, :), tape)
   end subroutine pass_row

   !> Numbers onto the tape, off it, or, when it is empty, only counted
   subroutine pass(values, tape)
      real(wp), intent(inout) :: values(:)
      type(tape_t), intent(inout) :: tape

      associate (from => tape%at + 1, to => tape%at + size(values))
         if (size(tape%a) >= to) then
            if (tape%write) tape%a(from:to) = values
            if (.not. tape%write) values = tape%a(from:to)
         end if
         tape%at = tape%at + size(values)
      end associate
   end subroutine pass

   !> Forces and moments of all joints at t, ADDED into the arrays of the host at the carriers.
   !>
   !> To be called once a cycle, with positions at t and velocities at t - h/2, as a leap-frog has
   !> them. Under the consistent formulation call it when f and m hold all other forces: the
   !> dampers look ahead to the velocities at t with them.
   !> Errors: ERR_INPUT when shapes do not fit or a value of a node of a joint is not finite; the
   !> arrays and the joints are as before then.
   subroutine joint_forces(set, time, h, x, v, omega, f, m, error, attitude)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: time               !! t
      real(wp), intent(in) :: h                  !! step since the last call; 0 in the first
      real(wp), intent(in) :: x(:, :)            !! positions at t, W, (3, n)
      real(wp), intent(in) :: v(:, :)            !! velocities at t - h/2, W, (3, n)
      real(wp), intent(in) :: omega(:, :)        !! angular velocities at t - h/2, W, (3, n)
      real(wp), intent(inout) :: f(:, :)         !! forces on the nodes, W, (3, n)
      real(wp), intent(inout) :: m(:, :)         !! moments about the nodes, W, (3, n)
      type(error_t), allocatable, intent(out) :: error
      !> quaternions at t, w x y z, world from axes of the node, (4, n); consistent needs them
      real(wp), intent(in), optional :: attitude(:, :)

      integer :: last

      if (.not. set%started) then
         call fail(error, ERR_INPUT, 'the joints have not been started')
         return
      end if
      last = set%model%n_lead
      call check_finite(h, 'the step', error)
      if (.not. allocated(error)) call check_finite(abs(time), 'the time', error)
      if (.not. allocated(error)) call check_shape(set, x, 'x', error)
      if (.not. allocated(error)) call check_shape(set, v, 'v', error)
      if (.not. allocated(error)) call check_shape(set, omega, 'omega', error)
      if (.not. allocated(error)) call check_shape(set, f, 'f', error)
      if (.not. allocated(error)) call check_shape(set, m, 'm', error)
      if (.not. allocated(error)) call check_attitude(set, error, attitude)
      if (.not. allocated(error)) call check_nodes(set, x, size(set%host), 'x', error)
      if (.not. allocated(error)) call check_nodes(set, v, last, 'v', error)
      if (.not. allocated(error)) call check_nodes(set, omega, last, 'omega', error)
      if (allocated(error)) return
      call evaluate(set, time, h, x, v, omega, f, m, attitude)
      set%time = time
      set%h_last = h
   end subroutine joint_forces

   !> Stiffness at the carriers for the nodal time step of the host, ADDED into its arrays: a node
   !> bears h = sqrt(2 m/kn) and sqrt(2 I/kr), I its smallest inertia. Damping is in it.
   !>
   !> Errors: ERR_INPUT when sizes do not fit or joint_forces has not been called.
   subroutine joint_stiffness(set, kn, kr, error)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(inout) :: kn(:)           !! (n) force/length
      real(wp), intent(inout) :: kr(:)           !! (n) moment/rad
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: k(:), r(:)
      integer :: i

      if (.not. set%started) then
         call fail(error, ERR_INPUT, 'the joints have not been started')
      else if (size(kn) /= set%n_host .or. size(kr) /= set%n_host) then
         call fail(error, ERR_INPUT, 'the arrays kn and kr need '//str(set%n_host)//' values')
      end if
      if (allocated(error)) return
      call carrier_stiffness(set, k, r)
      do i = 1, set%model%n_lead
         if (set%host(i) == 0) cycle
         kn(set%host(i)) = kn(set%host(i)) + k(i)
         kr(set%host(i)) = kr(set%host(i)) + r(i)
      end do
   end subroutine joint_stiffness

   !> Largest stable step for the joints alone, in the present pose; huge when nothing limits it.
   !>
   !> Consistent: 2/omega is never below it (proven; its dampers cost nothing). Legacy: the nodal
   !> rule, which takes a factor of 0.9 and proves nothing. What else acts on the nodes the host
   !> must count itself.
   !> Errors: ERR_INPUT before the first call of joint_forces.
   subroutine critical_step(set, h, error)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(out) :: h
      type(error_t), allocatable, intent(out) :: error

      h = huge(1.0_wp)
      if (set%started) then
         call carrier_step(set, h)
      else
         call fail(error, ERR_INPUT, 'the joints have not been started')
      end if
   end subroutine critical_step

   !> Number of joints, 0 before the start
   pure integer function joint_count(set) result(n)
      type(joint_set_t), intent(in) :: set

      n = set%model%n_joint
   end function joint_count

   !> What joint j does. Errors: ERR_INPUT when there is no such joint.
   subroutine joint_result(set, j, result, error)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: j                   !! 1 to joint_count(set)
      type(joint_result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error

      if (.not. set%started) then
         call fail(error, ERR_INPUT, 'the joints have not been started')
         return
      else if (j < 1 .or. j > set%model%n_joint) then
         call fail(error, ERR_INPUT, 'there is no joint '//str(j)//' of '//str(set%model%n_joint))
         return
      end if
      result%id = set%model%joint(j)%id
      result%type = joint_types(set%model%joint(j)%row)%id
      call joint_values(set, j, result)
      result%orthogonality = find_orthogonality(set, j)
   end subroutine joint_result

   !> Work done on all joints since the start, and the part of it that dampers and friction took (0
   !> under legacy, which does not tell it apart)
   pure subroutine joint_energy(set, work, dissipated)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(out) :: work, dissipated

      integer :: b, i

      work = 0.0_wp
      dissipated = 0.0_wp
      if (.not. set%started) return
      do b = 1, size(set%state%joint)            ! legacy
         do i = 1, size(set%state%joint(b)%block)
            work = work + sum(set%state%joint(b)%block(i)%energy)
         end do
      end do
      do b = 1, size(set%cs%joint)               ! consistent
         do i = 1, size(set%cs%joint(b)%block)
            dissipated = dissipated + sum(set%cs%joint(b)%block(i)%dissipated)
            work = work + sum(set%cs%joint(b)%block(i)%elastic)
         end do
      end do
      work = work + dissipated
   end subroutine joint_energy

   !> Add a warning for each joint whose loss of orthogonality passes a limit, once a joint
   subroutine joint_warnings(set, limit, findings)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: limit              !! [rad], such as 0.01
      type(finding_list_t), intent(inout) :: findings

      type(error_t), allocatable :: warning
      character(len=12) :: text
      real(wp) :: loss
      integer :: j

      if (.not. set%started) return
      do j = 1, set%model%n_joint
         if (set%warned(j)) cycle
         loss = find_orthogonality(set, j)
         if (.not. loss > limit) cycle
         set%warned(j) = .true.
         write (text, '(es10.3)') loss
         call fail(warning, ERR_INPUT, 'the axes of joint '//str(set%model%joint(j)%id)// &
            ' have lost their right angles by '//trim(adjustl(text))// &
            ' rad: its ends are not rigid', 'KJ-9301')
         warning%severity = SEV_WARNING
         call add_finding(findings, warning)
      end do
   end subroutine joint_warnings

end module kj_host_state
