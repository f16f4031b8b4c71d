!> From what a host describes to joints that can be evaluated: a small model whose bodies are the
!> carriers, so that all constants come about as those of a deck do.
!> One file: the joints of a host from their specification, or from a deck, to their state
module kj_host_build
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_curve, only: add_curve
   use kj_host, only: joint_spec_t, joint_set_t, host_vector, host_quaternion
   use kj_host_check, only: check_spec, check_shape, check_nodes, check_attitude
   use kj_host_scheme, only: begin_state, follows_nodes, refuse_automatic
   use kj_consistent_body, only: columns
   use kj_joint_types, only: joint_types, find_joint_type, NDOF, FRAME_MEAN, FRAME_FIRST, &
      FRAME_CROSS
   use kj_draft, only: property_t, joint_t
   use kj_build_joint, only: set_constants, fill_batches
   use kj_attach_joint, only: mean_frame
   use kj_skew, only: skew_axes
   use kj_sort, only: lookup_t, new_lookup, find
   use kj_model, only: model_t
   implicit none
   private

   public :: new_joint_set, add_joint_curve, add_joint, start_joints, take_model

   !> Mass and inertia where the host moves a carrier
   real(wp), parameter, public :: HELD = 1.0e30_wp

contains

   !> An empty set for a host with n nodes.
   !>
   !> Errors: ERR_INPUT when the formulation is not 'legacy' or 'consistent', or n is negative.
   subroutine new_joint_set(set, formulation, n, error, by_component)
      type(joint_set_t), intent(out) :: set
      !> 'legacy' (frames follow nodes and angular velocities as in Radioss) or 'consistent' (they
      !> follow the attitudes of the carriers)
      character(len=*), intent(in) :: formulation
      integer, intent(in) :: n                   !! nodes of the host
      type(error_t), allocatable, intent(out) :: error
      !> arrays of the host are (n, 3), (n, 4); else (3, n), (4, n)
      logical, intent(in), optional :: by_component

      if (all(formulation /= ['legacy    ', 'consistent'])) then
         call fail(error, ERR_INPUT, 'there is no formulation '//trim(formulation)// &
            ': consistent or legacy')
      else if (n < 0) then
         call fail(error, ERR_INPUT, 'the number of nodes is negative')
      else
         set%legacy = formulation == 'legacy'
         set%n_host = n
         if (present(by_component)) set%by_component = by_component
         allocate (set%spec(0))
         set%made = .true.
      end if
   end subroutine new_joint_set

   !> Add a function for the laws of joints that follow: at least two points, x ascending; straight
   !> between them and beyond.
   !>
   !> Errors: ERR_INPUT when the points do not fit, or the joints have been started.
   subroutine add_joint_curve(set, x, y, curve, error)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: x(:), y(:)
      integer, intent(out) :: curve              !! its number, for joint_spec_t
      type(error_t), allocatable, intent(out) :: error

      curve = 0
      call check_open(set, error)
      if (allocated(error)) return
      if (size(x) /= size(y) .or. size(x) < 2) then
         call fail(error, ERR_INPUT, 'a curve needs as many ordinates as abscissae, two or more')
      else if (.not. (all(ieee_is_finite(x)) .and. all(ieee_is_finite(y)))) then
         call fail(error, ERR_INPUT, 'a point of the curve is not finite')
      else if (.not. all(x(2:) > x(:size(x) - 1))) then
         call fail(error, ERR_INPUT, 'the abscissae of the curve do not ascend')
      else
         call add_curve(set%model%curves, set%model%curves%n + 1, x, y)
         curve = set%model%curves%n
      end if
   end subroutine add_joint_curve

   !> Add a joint; they are numbered from 1 in the order in which they come.
   !>
   !> Errors: ERR_INPUT when anything of it does not fit, or the joints have been started.
   subroutine add_joint(set, spec, error)
      type(joint_set_t), intent(inout) :: set
      type(joint_spec_t), intent(in) :: spec
      type(error_t), allocatable, intent(out) :: error

      type(joint_spec_t), allocatable :: longer(:)

      call check_open(set, error)
      if (allocated(error)) return
      call check_spec(set, spec, error)
      if (allocated(error)) return
      if (set%n_spec == size(set%spec)) then     ! half as many again: no more than 3 moves a joint
         allocate (longer(16 + set%n_spec + set%n_spec/2))
         longer(:set%n_spec) = set%spec
         call move_alloc(longer, set%spec)
      end if
      set%n_spec = set%n_spec + 1
      set%spec(set%n_spec) = spec
   end subroutine add_joint

   !> The set takes joints
   subroutine check_open(set, error)
      type(joint_set_t), intent(in) :: set
      type(error_t), allocatable, intent(out) :: error

      if (.not. set%made) then
         call fail(error, ERR_INPUT, 'the set of joints has not been made: call new_joint_set')
      else if (set%started) then
         call fail(error, ERR_INPUT, 'the joints have been started: none can be added')
      end if
   end subroutine check_open

   !> Fix the joints in the present places of the nodes, where they are free of force.
   !>
   !> Masses go into the damping of blocked directions and into the critical step. Mass 0: the host
   !> holds or drives the carrier. Inertia 0: it does not turn.
   !> Errors: ERR_INPUT when shapes do not fit or a value of a node of a joint is not finite or
   !> negative, when both carriers of a joint are held, when its axes do not exist.
   subroutine start_joints(set, x, mass, inertia, error, attitude)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: x(:, :)            !! positions, W, (3, n)
      real(wp), intent(in) :: mass(:)            !! (n)
      !> principal inertia about the node, along the axes of its attitude, (3, n)
      real(wp), intent(in) :: inertia(:, :)
      type(error_t), allocatable, intent(out) :: error
      !> quaternions w x y z, world from axes of the node, (4, n); consistent needs them
      real(wp), intent(in), optional :: attitude(:, :)

      call check_open(set, error)
      if (.not. allocated(error)) call check_shape(set, x, 'x', error)
      if (.not. allocated(error)) call check_shape(set, inertia, 'inertia', error)
      if (.not. allocated(error)) call check_attitude(set, error, attitude)
      if (allocated(error)) return
      if (size(mass) /= set%n_host) then
         call fail(error, ERR_INPUT, 'the array mass has '//str(size(mass))// &
            ' values, expected: '//str(set%n_host))
         return
      end if
      call number_nodes(set, error)
      if (.not. allocated(error)) call check_nodes(set, x, size(set%host), 'x', error)
      if (.not. allocated(error)) call set_scene(set, x, mass, inertia, error, attitude)
      if (.not. allocated(error)) call set_joints(set, error)
      if (.not. allocated(error)) call begin_state(set, error, attitude)
      if (allocated(error)) set%made = .false.   ! half numbered: it takes a new set
   end subroutine start_joints

   !> Carriers first, ascending; then the other nodes of the joints
   subroutine number_nodes(set, error)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error

      integer :: lead(set%n_host), new(set%n_host), j, e, i, n
      logical :: seen(set%n_host)

      lead = 0
      seen = .false.
      do j = 1, set%n_spec
         associate (s => set%spec(j))
            do e = 1, 2
               i = merge(s%carrier(e), s%node(e), s%carrier(e) > 0)
               if (lead(s%node(e)) > 0 .and. lead(s%node(e)) /= i) then
                  call fail(error, ERR_INPUT, 'node '//str(s%node(e))//' has two carriers')
                  return
               end if
               lead(s%node(e)) = i
               seen(i) = .true.
            end do
         end associate
      end do
      do i = 1, set%n_host
         if (seen(i) .and. lead(i) > 0 .and. lead(i) /= i) then
            call fail(error, ERR_INPUT, 'carrier '//str(i)//' is carried by another')
            return
         end if
      end do
      set%host = pack([(i, i=1, set%n_host)], seen)
      set%model%n_lead = size(set%host)
      set%model%n_body = set%model%n_lead
      where (seen) lead = [(i, i=1, set%n_host)]
      do j = 1, set%n_spec
         do e = 1, 2
            do n = 1, 3
               i = set%spec(j)%axis_node(n, e)
               if (i > 0) then
                  if (lead(i) == 0) lead(i) = lead(set%spec(j)%node(e))
               end if
            end do
         end do
      end do
      set%host = [set%host, pack([(i, i=1, set%n_host)], lead > 0 .and. .not. seen)]
      new = 0
      new(set%host) = [(i, i=1, size(set%host))]
      set%model%n_node = size(set%host)
      set%model%node_id = set%host
      set%model%lead = new(lead(set%host))
      do j = 1, set%n_spec
         associate (s => set%spec(j))
            s%node = new(s%node)
            do e = 1, 2
               if (s%axis_node(1, e) > 0) s%axis_node(:, e) = new(s%axis_node(:, e))
            end do
         end associate
      end do
   end subroutine number_nodes

   !> Nodes and masses of the small model, and nothing that loads or holds it
   subroutine set_scene(set, x, mass, inertia, error, attitude)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: x(:, :), mass(:), inertia(:, :)
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      real(wp) :: own(3)
      integer :: i

      associate (m => set%model%model_t, n => set%model%n_lead)
         allocate (m%x0(m%n_node, 3), m%v0(m%n_node, 3), m%w0(n, 3), m%mass(n), m%inertia(n), &
            m%principal(n, 3), m%axes(n, 9), source=0.0_wp)
         allocate (m%n_secondary(n), source=0)
         m%body_id = m%node_id(:n)
         allocate (m%bcs(0), m%gravity(0), m%cload(0), m%motion(0), m%th_joint(0), m%th_body(0), &
            m%th_spring(0), m%th_node(0), m%th_node_skew(0))
         do i = 1, m%n_node
            m%x0(i, :) = host_vector(set, x, set%host(i))
         end do
         do i = 1, n
            own = host_vector(set, inertia, set%host(i))
            if (.not. (ieee_is_finite(mass(set%host(i))) .and. all(ieee_is_finite(own))) .or. &
               mass(set%host(i)) < 0.0_wp .or. any(own < 0.0_wp)) then
               call fail(error, ERR_INPUT, 'mass or inertia of node '//str(set%host(i))// &
                  ' is negative or not finite')
               return
            end if
            m%mass(i) = mass(set%host(i))
            m%principal(i, :) = own
            if (.not. m%mass(i) > 0.0_wp) then
               m%mass(i) = HELD
               m%principal(i, :) = HELD
            end if
            m%inertia(i) = minval(m%principal(i, :))
            m%axes(i, :) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]
            if (present(attitude)) &
               m%axes(i, :) = columns(host_quaternion(set, attitude, set%host(i)))
         end do
         if (.not. allocated(m%curves%id)) then
            allocate (m%curves%id(0), m%curves%x(0), m%curves%y(0))
            allocate (m%curves%first(1), source=1)
         end if
      end associate
   end subroutine set_scene

   !> Skews, frames and constants of all joints
   subroutine set_joints(set, error)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error

      type(property_t), allocatable :: property(:), longer(:)
      type(joint_t), allocatable :: joint(:)
      logical :: moving(2*set%n_spec)
      integer :: j, n, s

      call set_skews(set)
      associate (m => set%model%model_t)
         m%n_joint = set%n_spec
         m%n_element = m%n_joint
         allocate (m%joint(m%n_joint), joint(m%n_joint), property(1))
         moving = .false.
         n = 0
         s = 0
         do j = 1, m%n_joint
            m%joint(j)%id = set%spec(j)%id
            if (n > 0) then
               if (.not. same_property(set%spec(j), set%spec(j - 1))) n = n + 1
            else
               n = 1
            end if
            if (n > size(property)) then
               allocate (longer(n + n/2))
               longer(:n - 1) = property
               call move_alloc(longer, property)
            end if
            call set_property(set%spec(j), property(n))
            joint(j)%property = n
            call set_joint(set, set%spec(j), property(n), s, joint(j), moving, error)
            if (allocated(error)) return
         end do
         m%skews%needed = pack([(s, s=1, m%skews%n)], moving(:m%skews%n))
         deallocate (set%spec)
         call fill_batches(property(:n), joint, m)
      end associate
   end subroutine set_joints

   !> Nodes, skews, frame and constants of one joint
   subroutine set_joint(set, spec, property, s, joint, moving, error)
      type(joint_set_t), intent(in) :: set
      type(joint_spec_t), intent(in) :: spec
      type(property_t), intent(in) :: property
      integer, intent(inout) :: s                !! skews so far
      type(joint_t), intent(inout) :: joint
      logical, intent(inout) :: moving(:)        !! (skews) moves with its nodes
      type(error_t), allocatable, intent(out) :: error

      integer :: e

      joint%node = spec%node
      do e = 1, 2
         if (spec%axis_node(1, e) == 0) cycle
         s = s + 1
         joint%skew(e) = s
         moving(s) = follows_nodes(set) .and. (property%frame == FRAME_CROSS .or. &
            property%frame == FRAME_FIRST .and. e == 1)
      end do
      call set_frame(set, property%frame, spec, joint, error)
      if (allocated(error)) return
      if (all(set%model%mass(set%model%lead(joint%node)) >= HELD)) then
         call fail(error, ERR_INPUT, 'joint '//str(spec%id)//': both carriers have mass 0')
         return
      end if
      joint%xl0 = matmul(set%model%x0(joint%node(2), :) - set%model%x0(joint%node(1), :), &
         joint%frame)
      call set_constants(set%model%model_t, property, joint)
   end subroutine set_joint

   !> Both joints have the same type and laws
   pure logical function same_property(a, b) result(same)
      type(joint_spec_t), intent(in) :: a, b

      same = a%type == b%type .and. (a%first_frame .eqv. b%first_frame) .and. &
         all(a%k_curve == b%k_curve) .and. all(a%c_curve == b%c_curve)
      if (same) same = .not. any(abs([a%kn, a%cr, a%k, a%c] - [b%kn, b%cr, b%k, b%c]) > 0.0_wp)
   end function same_property

   !> One skew for each end with axis nodes
   subroutine set_skews(set)
      type(joint_set_t), intent(inout) :: set

      integer :: j, e, n

      n = 0
      do j = 1, set%n_spec
         n = n + count(set%spec(j)%axis_node(1, :) > 0)
      end do
      associate (k => set%model%skews, x => set%model%x0)
         k%n = n
         allocate (k%id(n), k%dir(n), k%node(3, n), set%shear_node(3, n), set%shear_of(n), source=1)
         allocate (k%axes(0:n, 9), source=0.0_wp)
         k%axes(0, [1, 5, 9]) = 1.0_wp
         n = 0
         do j = 1, set%n_spec
            do e = 1, 2
               if (set%spec(j)%axis_node(1, e) == 0) cycle
               n = n + 1
               k%id(n) = n
               k%node(:, n) = set%spec(j)%axis_node(:, e)
               k%axes(n, :) = skew_axes(1, x(k%node(1, n), :), x(k%node(2, n), :), &
                  x(k%node(3, n), :))
               set%shear_node(:, n) = k%node(:, n)
               set%shear_of(n) = merge(j, -j, e == 1)
            end do
         end do
      end associate
   end subroutine set_skews

   !> What a deck would say in /PROP/KJOINT
   pure subroutine set_property(spec, p)
      type(joint_spec_t), intent(in) :: spec
      type(property_t), intent(out) :: p

      integer :: dof

      p%id = spec%id
      p%row = find_joint_type(spec%type)
      p%frame = joint_types(p%row)%frame
      if (spec%first_frame .and. p%frame == FRAME_MEAN) p%frame = FRAME_FIRST
      p%cr = spec%cr
      if (.not. p%cr > 0.0_wp) p%cr = 0.05_wp
      p%kn = spec%kn
      if (all(joint_types(p%row)%free == 1)) then
         p%cr = 0.0_wp
         p%kn = 0.0_wp
      end if
      p%k = spec%k
      p%c = spec%c
      p%k_curve = spec%k_curve
      p%c_curve = spec%c_curve
      do dof = 1, NDOF
         if (p%k_curve(dof) > 0 .and. .not. p%k(dof) > 0.0_wp) p%k(dof) = 1.0_wp
         if (p%c_curve(dof) > 0 .and. .not. p%c(dof) > 0.0_wp) p%c(dof) = 1.0_wp
      end do
   end subroutine set_property

   !> Frame at the start from the axis nodes, else as given
   subroutine set_frame(set, rule, spec, joint, error)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: rule
      type(joint_spec_t), intent(in) :: spec
      type(joint_t), intent(inout) :: joint
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: axes(9, 2)
      logical :: opposite
      integer :: e

      joint%frame = spec%axes
      if (all(joint%skew == 0)) return
      opposite = .false.
      do e = 1, 2
         axes(:, e) = set%model%skews%axes(joint%skew(merge(e, 3 - e, joint%skew(e) > 0)), :)
         if (rule == FRAME_CROSS .and. joint%skew(e) == 0) opposite = .true.
      end do
      if (all(abs(norm2(reshape(axes, [3, 6]), dim=1) - 1.0_wp) < 1.0e-6_wp) .and. &
         .not. opposite) then
         call mean_frame(rule, axes(:, 1), axes(:, 2), joint%frame, opposite)
         if (rule == FRAME_CROSS) opposite = abs(dot_product(axes(:3, 1), axes(:3, 2))) > 0.999_wp
      else
         opposite = .true.
      end if
      if (opposite) call fail(error, ERR_INPUT, 'joint '//str(spec%id)// &
         ': its axis nodes give no frame (in a line, 180 degrees apart, or one end without)')
   end subroutine set_frame

   !> The joints of a model, with its masses; loads and imposed motion stay behind.
   !>
   !> Errors: ERR_INPUT when the host lacks a node that the joints need, or has a node twice, or a
   !> stiffness of the joints would come from a first step that the host alone knows (legacy).
   subroutine take_model(set, model, node_id, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(model_t), intent(in) :: model
      integer, intent(in) :: node_id(:)          !! (n) user id in the deck of each host node
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      logical :: needed(model%n_node)

      if (size(node_id) /= set%n_host) then
         call fail(error, ERR_INPUT, 'the array node_id has '//str(size(node_id))// &
            ' values, expected: '//str(set%n_host))
         return
      end if
      set%model%model_t = model
      call strip_loads(set%model%model_t)
      call find_needed(set%model%model_t, follows_nodes(set), needed)
      call map_nodes(set, node_id, needed, error)
      if (allocated(error)) return
      call refuse_automatic(set, error)
      if (allocated(error)) return
      call measured_skews(set)
      call check_attitude(set, error, attitude)
      if (.not. allocated(error)) call begin_state(set, error, attitude)
   end subroutine take_model

   !> What loads and drives is the business of the host; which skews joints read
   subroutine strip_loads(model)
      type(model_t), intent(inout) :: model

      logical :: used(0:model%skews%n)
      integer :: i

      deallocate (model%gravity, model%cload, model%motion, model%th_joint, model%th_spring, &
         model%th_body, model%th_node, model%th_node_skew)
      allocate (model%gravity(0), model%cload(0), model%motion(0), model%th_joint(0), &
         model%th_spring(0), model%th_body(0), model%th_node(0), model%th_node_skew(0))
      used = .false.
      do i = 1, size(model%batch)
         if (model%batch(i)%frame == FRAME_MEAN) cycle
         used(model%batch(i)%skew(:, 1)) = .true.
         if (model%batch(i)%frame == FRAME_CROSS) used(model%batch(i)%skew(:, 2)) = .true.
      end do
      model%skews%needed = pack([(i, i=1, model%skews%n)], used(1:) .and. model%skews%dir > 0)
   end subroutine strip_loads

   !> Nodes that the host must have: carriers, and what their frames follow
   pure subroutine find_needed(model, ends, needed)
      type(model_t), intent(in) :: model
      logical, intent(in) :: ends                !! nodes of joints and of skews, too
      logical, intent(out) :: needed(:)

      integer :: i

      needed = .false.
      do i = 1, model%n_element
         needed(model%lead(model%joint(i)%node)) = .true.
         if (ends) needed(model%joint(i)%node) = .true.
      end do
      if (.not. ends) return
      do i = 1, size(model%skews%needed)
         needed(model%skews%node(:, model%skews%needed(i))) = .true.
      end do
   end subroutine find_needed

   subroutine map_nodes(set, node_id, needed, error)
      type(joint_set_t), intent(inout) :: set
      integer, intent(in) :: node_id(:)
      logical, intent(in) :: needed(:)
      type(error_t), allocatable, intent(out) :: error

      type(lookup_t) :: lookup
      integer :: i

      call new_lookup(node_id, lookup)
      do i = 2, size(lookup%id)
         if (lookup%id(i) /= lookup%id(i - 1)) cycle
         call fail(error, ERR_INPUT, 'node '//str(lookup%id(i))//' stands twice in node_id')
         return
      end do
      allocate (set%host(set%model%n_node), source=0)
      do i = 1, set%model%n_node
         if (i <= set%model%n_lead .and. .not. needed(i)) cycle
         set%host(i) = find(lookup, set%model%node_id(i))
         if (set%host(i) > 0 .or. .not. needed(i)) cycle
         call fail(error, ERR_INPUT, 'the host has no node '//str(set%model%node_id(i))// &
            ', which the joints need')
         return
      end do
   end subroutine map_nodes

   !> Moving skews of joint ends whose nodes the host has: their orthogonality is measured
   subroutine measured_skews(set)
      type(joint_set_t), intent(inout) :: set

      integer :: j, e, s, n, pass

      do pass = 1, 2
         n = 0
         do j = 1, set%model%n_joint
            associate (b => set%model%batch(set%model%joint(j)%batch), k => set%model%skews)
               do e = 1, 2
                  s = b%skew(set%model%joint(j)%place, e)
                  if (s == 0) cycle
                  if (k%dir(s) /= 1) cycle
                  if (.not. all(set%host(k%node(:, s)) > 0)) cycle
                  n = n + 1
                  if (pass == 1) cycle
                  set%shear_node(:, n) = k%node(:, s)
                  set%shear_of(n) = merge(j, -j, e == 1)
               end do
            end associate
         end do
         if (pass == 1) allocate (set%shear_node(3, n), set%shear_of(n))
      end do
   end subroutine measured_skews

end module kj_host_build
