!> Joints of a host over time: forces, stiffness, critical step, results.
module kj_host_force
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, add_finding, str, ERR_INPUT, SEV_WARNING
   use kj_joint_types, only: joint_types
   use kj_host, only: joint_set_t, joint_result_t
   use kj_host_check, only: check_shape, check_nodes, check_finite, check_attitude
   use kj_host_scheme, only: evaluate, carrier_stiffness, carrier_step, joint_values, &
      find_orthogonality
   implicit none
   private

   public :: joint_forces, joint_stiffness, critical_step, joint_count, joint_result, &
      joint_energy, joint_warnings

contains

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

end module kj_host_force
