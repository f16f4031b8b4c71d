!> Joints of a host over time: forces, stiffness, critical step, results. All physics is that of
!> the model level: find_joint_forces of kj_legacy_step, find_forces of kj_consistent_step.
module kj_host_force
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, add_finding, str, ERR_INPUT, SEV_WARNING
   use kj_math3, only: rotation_vector
   use kj_joint_types, only: joint_types, FRAME_CROSS
   use kj_skew, only: skew_axes
   use kj_legacy_step, only: find_joint_forces
   use kj_consistent_step, only: find_forces
   use kj_consistent_conditions, only: body_matrix
   use kj_consistent_safe_step, only: renew_bound, has_moved
   use kj_block, only: block_of, lane_of
   use kj_consistent_batch, only: frame_of
   use kj_consistent_nodal_step, only: nodal_stiffness
   use kj_host, only: joint_set_t, joint_result_t, host_vector, shear_angle
   use kj_host_check, only: check_shape, check_nodes, check_finite
   use kj_host_start, only: check_attitude, host_quaternion, turned
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
      if (.not. allocated(error)) call check_attitude(set, .not. set%legacy, error, attitude)
      if (.not. allocated(error)) call check_nodes(set, x, size(set%host), 'x', error)
      if (.not. allocated(error)) call check_nodes(set, v, last, 'v', error)
      if (.not. allocated(error)) call check_nodes(set, omega, last, 'omega', error)
      if (allocated(error)) return
      if (set%legacy) then
         call legacy_forces(set, time, h, x, omega)
         call add_at_carriers(set, set%state%f, set%state%m, f, m)
      else
         call consistent_forces(set, time, h, x, v, omega, f, m, attitude)
         call add_at_carriers(set, set%cs%f, set%cs%t, f, m)
      end if
      set%h_last = h
   end subroutine joint_forces

   !> Frames from nodes and angular velocities
   subroutine legacy_forces(set, time, h, x, omega)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: time, h, x(:, :), omega(:, :)

      integer :: i

      associate (s => set%state)
         s%time = time
         s%h1 = h
         s%h12 = 0.0_wp
         if (h > 0.0_wp) s%h12 = 0.5_wp*(set%h_last + h)
         do i = 1, size(set%host)
            if (set%host(i) > 0) s%world%x(i, :) = host_vector(set, x, set%host(i))
         end do
         do i = 1, set%model%n_lead
            if (set%host(i) > 0) s%world%w(i, :) = host_vector(set, omega, set%host(i))
         end do
         call find_joint_forces(set%model%model_t, s, .true.)
      end associate
   end subroutine legacy_forces

   !> Frames from attitudes; dampers by block Jacobi
   subroutine consistent_forces(set, time, h, x, v, omega, f, m, attitude)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: time, h, x(:, :), v(:, :), omega(:, :), f(:, :), m(:, :)
      real(wp), intent(in) :: attitude(:, :)

      real(wp) :: p(3, 3), none(0)
      logical :: never(0)
      integer :: i

      never = .false.
      none = 0.0_wp
      associate (s => set%cs, model => set%model)
         do i = 1, set%model%n_lead
            if (set%host(i) == 0) cycle
            s%v(i, :) = host_vector(set, v, set%host(i))
            s%poses%w(i, :) = host_vector(set, omega, set%host(i))
            s%f_ahead(i, :) = host_vector(set, f, set%host(i))
            s%t_ahead(i, :) = host_vector(set, m, set%host(i))
         end do
         s%poses%v = s%v
         s%poses%w_left = s%poses%w
         s%poses%psi = 0.5_wp*h*s%poses%w
         do i = 1, set%model%n_lead
            if (set%host(i) == 0) cycle
            s%poses%x(i, :) = host_vector(set, x, set%host(i))
            s%poses%d(i, :) = s%poses%x(i, :) - set%model%x0(i, :)
            s%poses%quat(i, :) = turned(host_quaternion(set, attitude, set%host(i)), &
               set%quat_own(i, :))
            p = body_matrix(s, i)
            s%l(i, :) = matmul(p, model%spin_inertia(i, :)*matmul(s%poses%w(i, :), p))
         end do
         do i = 1, size(s%node, 1)
            if (set%host(i) > 0) s%node(i, :) = host_vector(set, x, set%host(i))
         end do
         s%time = time
         s%h = h
         call find_forces(model, h, none, never, s)
      end associate
   end subroutine consistent_forces

   !> Sums of the carriers into the arrays of the host
   subroutine add_at_carriers(set, force, moment, f, m)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: force(:, :), moment(:, :)   !! (n_lead, 3)
      real(wp), intent(inout) :: f(:, :), m(:, :)

      integer :: i

      do i = 1, set%model%n_lead
         associate (node => set%host(i))
            if (node == 0) cycle
            if (set%by_component) then
               f(node, :) = f(node, :) + force(i, :)
               m(node, :) = m(node, :) + moment(i, :)
            else
               f(:, node) = f(:, node) + force(i, :)
               m(:, node) = m(:, node) + moment(i, :)
            end if
         end associate
      end do
   end subroutine add_at_carriers

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

   subroutine carrier_stiffness(set, k, r)
      type(joint_set_t), intent(in) :: set
      real(wp), allocatable, intent(out) :: k(:), r(:)   !! (n_lead)

      if (set%legacy) then
         k = set%state%kn
         r = set%state%kr
      else
         allocate (k(set%model%n_lead), r(set%model%n_lead))
         call nodal_stiffness(set%model, set%cs, k, r)
      end if
   end subroutine carrier_stiffness

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

      integer :: i

      h = huge(1.0_wp)
      if (.not. set%started) then
         call fail(error, ERR_INPUT, 'the joints have not been started')
      else if (set%legacy) then
         associate (s => set%state)
            do i = 1, set%model%n_lead
               if (set%model%map%first(i + 1) == set%model%map%first(i)) cycle
               if (s%mass(i) > 0.0_wp) h = min(h, sqrt(2.0_wp*s%mass(i)/s%kn(i)))
               if (s%inertia(i) > 0.0_wp) h = min(h, sqrt(2.0_wp*s%inertia(i)/s%kr(i)))
            end do
         end associate
      else
         if (has_moved(set%model, set%cs, set%bound)) call renew_bound(set%model, set%cs, set%bound)
         h = set%bound%h
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
      associate (ref => set%model%joint(j))
         result%id = ref%id
         result%type = joint_types(ref%row)%id
         if (set%legacy) then
            associate (s => set%state%joint(ref%batch)%block(block_of(ref%place)), &
               i => lane_of(ref%place))
               result%force = s%f(i, :)
               result%displacement = s%q(i, :)
               result%frame = reshape(s%e(i, :), [3, 3])
               result%energy = s%energy(i)
            end associate
         else
            associate (joint => set%cs%joint(ref%batch), at => block_of(ref%place), &
               i => lane_of(ref%place))
               result%force = joint%block(at)%fe(i, :) + joint%block(at)%fd(i, :)
               if (allocated(joint%limit)) &
                  result%force = result%force + joint%limit(at)%friction(i, :)
               result%displacement = joint%block(at)%q(i, :)
               result%frame = reshape(frame_of(set%model%batch(ref%batch), joint, ref%place), [3, &
                  3])
               result%dissipated = joint%block(at)%dissipated(i)
               result%energy = joint%block(at)%elastic(i) + result%dissipated
            end associate
         end if
      end associate
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
      do b = 1, size(set%model%batch)
         if (set%legacy) then
            do i = 1, size(set%state%joint(b)%block)
               work = work + sum(set%state%joint(b)%block(i)%energy)
            end do
         else
            do i = 1, size(set%cs%joint(b)%block)
               dissipated = dissipated + sum(set%cs%joint(b)%block(i)%dissipated)
               work = work + sum(set%cs%joint(b)%block(i)%elastic)
            end do
         end if
      end do
      work = work + dissipated
   end subroutine joint_energy

   !> Loss of orthogonality of joint j [rad], 0 between rigid bodies that keep their blocked
   !> directions: the largest of (1) axes y and z of a universal joint off 90 degrees, (2) change of
   !> the angle between the axis nodes of an end, (3) consistent: turn of the axis nodes of an end
   !> away from the attitude of its carrier
   real(wp) function find_orthogonality(set, j) result(loss)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: j

      real(wp) :: x(3, 3), now(3, 3), then(3, 3), p(3, 3), e(9), cosine
      integer :: i, lead

      loss = 0.0_wp
      associate (ref => set%model%joint(j))
         if (joint_types(ref%row)%frame == FRAME_CROSS) then
            if (set%legacy) then
               e = set%state%joint(ref%batch)%block(block_of(ref%place))%e(lane_of(ref%place), :)
            else
               e = frame_of(set%model%batch(ref%batch), set%cs%joint(ref%batch), ref%place)
            end if
            cosine = dot_product(e(4:6), e(7:9))
            loss = abs(asin(max(-1.0_wp, min(1.0_wp, cosine))))
         end if
         do i = set%shear_first(j), set%shear_first(j + 1) - 1
            if (set%legacy) x = set%state%world%x(set%shear_node(:, i), :)
            if (.not. set%legacy) x = set%cs%node(set%shear_node(:, i), :)
            loss = max(loss, abs(shear_angle(x) - set%shear0(i)))
            if (set%legacy) cycle
            lead = set%model%lead(ref%node(merge(1, 2, set%shear_of(i) > 0)))
            now = reshape(skew_axes(1, x(1, :), x(2, :), x(3, :)), [3, 3])
            associate (n => set%shear_node(:, i), x0 => set%model%x0)
               then = reshape(skew_axes(1, x0(n(1), :), x0(n(2), :), x0(n(3), :)), [3, 3])
            end associate
            p = matmul(body_matrix(set%cs, lead), &
               transpose(reshape(set%model%axes0(lead, :), [3, 3])))
            loss = max(loss, norm2(rotation_vector(matmul(transpose(matmul(p, then)), now))))
         end do
      end associate
   end function find_orthogonality

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
