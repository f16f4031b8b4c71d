!> Joints of a host under either formulation: the one place of kj_host_* that asks which one it is.
!> All physics is that of the model level: find_joint_forces of kj_legacy_step, find_forces of
!> kj_consistent_step.
module kj_host_scheme
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_math3, only: rotation_vector, quaternion_product
   use kj_block, only: block_of, lane_of
   use kj_joint_types, only: joint_types, FRAME_CROSS
   use kj_joint_batch, only: is_spring
   use kj_skew, only: skew_axes
   use kj_legacy_state, only: new_legacy_state
   use kj_legacy_step, only: find_joint_forces
   use kj_consistent_batch, only: frame_of
   use kj_consistent_build, only: build_consistent_model, new_consistent_state
   use kj_consistent_auto_stiffness, only: start_scene
   use kj_consistent_ready, only: set_damping
   use kj_consistent_step, only: find_forces
   use kj_consistent_conditions, only: body_matrix
   use kj_consistent_safe_step, only: new_bound, renew_bound, has_moved
   use kj_consistent_nodal_step, only: nodal_stiffness
   use kj_host, only: joint_set_t, joint_result_t, host_vector, host_quaternion, shear_angle
   implicit none
   private

   public :: follows_nodes, refuse_automatic, begin_state, evaluate, carrier_stiffness, &
      carrier_step, joint_values, find_orthogonality

contains

   !> Frames of joints follow nodes and angular velocities, not the attitudes of the carriers
   pure logical function follows_nodes(set)
      type(joint_set_t), intent(in) :: set

      follows_nodes = set%legacy
   end function follows_nodes

   !> Errors: ERR_INPUT when a stiffness would come from a first step that the host alone knows
   subroutine refuse_automatic(set, error)
      type(joint_set_t), intent(in) :: set
      type(error_t), allocatable, intent(out) :: error

      integer :: b

      do b = 1, size(set%model%batch)
         if (.not. (set%legacy .and. set%model%batch(b)%limited)) cycle
         if (any(set%model%batch(b)%limit%automatic)) call fail(error, ERR_INPUT, &
            'a joint takes its stiffness from the first step of a legacy run: give Kn in the deck')
      end do
   end subroutine refuse_automatic

   !> State at the start, when all constants stand; then what only the start needs goes.
   !>
   !> Errors: those of start_scene
   subroutine begin_state(set, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      call begin_shear(set)
      if (set%legacy) then
         call new_legacy_state(set%model%model_t, set%state)
         call drop_legacy(set)
         allocate (set%cs%joint(0))
      else
         call begin_consistent(set, error, attitude)
         if (allocated(error)) return
         allocate (set%state%joint(0))
      end if
      allocate (set%warned(set%model%n_joint), source=.false.)
      set%started = .true.
   end subroutine begin_state

   !> Errors: those of start_scene
   subroutine begin_consistent(set, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      real(wp) :: fastest
      integer :: i

      associate (n => set%model%n_lead)
         if (any(set%model%batch%limited)) then
            call start_scene(set%model, .false., .true., set%cs, error)
            if (allocated(error)) return
         else
            call build_consistent_model(set%model)
            call drop_constants(set)
            call new_consistent_state(set%model, set%cs, lean=.not. reads_nodes(set))
            call set_damping(set%model, set%cs, fastest)
         end if
         deallocate (set%model%v0, set%model%w0, set%cs%impulse, set%cs%angular_impulse, &
            set%cs%turn)
         if (.not. reads_nodes(set)) then
            deallocate (set%model%axes0, set%cs%node)
            allocate (set%cs%node(0, 3))
         end if
         call move_alloc(set%model%quat0, set%quat_own)
         if (present(attitude)) then
            do i = 1, n
               if (set%host(i) > 0) set%quat_own(i, :) = &
                  seen_from(host_quaternion(set, attitude, set%host(i)), set%quat_own(i, :))
            end do
         end if
         call new_bound(set%model, .false., set%cs, set%bound)
         allocate (set%cs%f_ahead(n, 3), set%cs%t_ahead(n, 3), source=0.0_wp)
      end associate
   end subroutine begin_consistent

   !> Angles of the measured skews, and where those of each joint begin
   subroutine begin_shear(set)
      type(joint_set_t), intent(inout) :: set

      integer :: i, j

      allocate (set%shear0(size(set%shear_of)))
      do i = 1, size(set%shear0)
         set%shear0(i) = shear_angle(set%model%x0(set%shear_node(:, i), :))
      end do
      allocate (set%shear_first(set%model%n_joint + 1), source=1)
      do i = 1, size(set%shear_of)
         j = abs(set%shear_of(i))
         set%shear_first(j + 1) = set%shear_first(j + 1) + 1
      end do
      do j = 1, set%model%n_joint
         set%shear_first(j + 1) = set%shear_first(j + 1) + set%shear_first(j) - 1
      end do
   end subroutine begin_shear

   !> What the host owns, or only the start needs: motion of bodies and nodes, first frames
   subroutine drop_legacy(set)
      type(joint_set_t), intent(inout) :: set

      integer :: b

      associate (s => set%state, m => set%model%model_t)
         deallocate (s%d, s%v, s%a, s%al, s%impulse, s%angular_impulse, s%rotation_sum, s%p, &
            s%principal, s%crew%first, s%crew%node, s%crew%kept, s%crew%few, m%v0, m%w0, m%axes, &
            m%principal, m%node_id, m%body_id, m%n_secondary)
         do b = 1, size(m%batch)
            deallocate (m%batch(b)%frame0, m%batch(b)%angle0)
         end do
      end associate
   end subroutine drop_legacy

   !> Places of other nodes than carriers are read: skews are measured, or conditions read them
   pure logical function reads_nodes(set)
      type(joint_set_t), intent(in) :: set

      reads_nodes = size(set%shear_of) > 0 .or. size(set%model%placed) > 0
   end function reads_nodes

   !> What the constants of the consistent formulation stand for now
   subroutine drop_constants(set)
      type(joint_set_t), intent(inout) :: set

      integer :: b

      associate (m => set%model%model_t)
         do b = 1, size(m%batch)
            deallocate (m%batch(b)%node, m%batch(b)%skew)
            if (.not. is_spring(m%batch(b))) deallocate (m%batch(b)%frame0)
         end do
         deallocate (m%axes, m%principal, m%node_id, m%body_id, m%n_secondary)
         if (reads_nodes(set)) return
         m%x0 = m%x0(:m%n_lead, :)
         m%v0 = m%v0(:m%n_lead, :)
         deallocate (set%model%arm)
      end associate
   end subroutine drop_constants

   !> Forces of all joints at t, added into the arrays of the host at the carriers; see joint_forces
   subroutine evaluate(set, time, h, x, v, omega, f, m, attitude)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: time, h, x(:, :), v(:, :), omega(:, :)
      real(wp), intent(inout) :: f(:, :), m(:, :)
      real(wp), intent(in), optional :: attitude(:, :)

      if (set%legacy) then
         call legacy_forces(set, time, h, x, omega)
         call add_at_carriers(set, set%state%f, set%state%m, f, m)
      else
         call consistent_forces(set, time, h, x, v, omega, f, m, attitude)
         call add_at_carriers(set, set%cs%f, set%cs%t, f, m)
      end if
   end subroutine evaluate

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

   !> What the nodal time step of the carriers has to bear
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

   !> See critical_step
   subroutine carrier_step(set, h)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(out) :: h

      integer :: i

      if (set%legacy) then
         h = huge(1.0_wp)
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
   end subroutine carrier_step

   !> Force, displacement, frame and energies of joint j
   pure subroutine joint_values(set, j, result)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: j
      type(joint_result_t), intent(inout) :: result

      associate (ref => set%model%joint(j), at => block_of(set%model%joint(j)%place), &
         i => lane_of(set%model%joint(j)%place))
         if (set%legacy) then
            associate (s => set%state%joint(ref%batch)%block(at))
               result%force = s%f(i, :)
               result%displacement = s%q(i, :)
               result%frame = reshape(s%e(i, :), [3, 3])
               result%energy = s%energy(i)
            end associate
         else
            associate (joint => set%cs%joint(ref%batch), s => set%cs%joint(ref%batch)%block(at))
               result%force = s%fe(i, :) + s%fd(i, :)
               if (allocated(joint%limit)) &
                  result%force = result%force + joint%limit(at)%friction(i, :)
               result%displacement = s%q(i, :)
               result%frame = reshape(frame_of(set%model%batch(ref%batch), joint, ref%place), &
                  [3, 3])
               result%dissipated = s%dissipated(i)
               result%energy = s%elastic(i) + s%dissipated(i)
            end associate
         end if
      end associate
   end subroutine joint_values

   !> Loss of orthogonality of joint j [rad], 0 between rigid bodies that keep their blocked
   !> directions: the largest of (1) axes y and z of a universal joint off 90 degrees, (2) change of
   !> the angle between the axis nodes of an end, (3) consistent: turn of the axis nodes of an end
   !> away from the attitude of its carrier
   real(wp) function find_orthogonality(set, j) result(loss)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: j

      type(joint_result_t) :: joint
      real(wp) :: x(3, 3), now(3, 3), then(3, 3), p(3, 3), cosine
      integer :: i, lead

      loss = 0.0_wp
      associate (ref => set%model%joint(j))
         if (joint_types(ref%row)%frame == FRAME_CROSS) then
            call joint_values(set, j, joint)
            cosine = dot_product(joint%frame(:, 2), joint%frame(:, 3))
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

   !> Attitude q in the axes of attitude p: p^-1 q
   pure function seen_from(p, q) result(own)
      real(wp), intent(in) :: p(4), q(4)
      real(wp) :: own(4)

      own = quaternion_product([p(1), -p(2:4)], q)
   end function seen_from

   !> Attitude `own` in the axes of attitude p, seen from the world: p own
   pure function turned(p, own) result(q)
      real(wp), intent(in) :: p(4), own(4)
      real(wp) :: q(4)

      q = quaternion_product(p, own)
      q = q/norm2(q)
   end function turned

end module kj_host_scheme
