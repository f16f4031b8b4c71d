!> From the joints that a host describes to batches: skews, frames and constants, as those of a deck
!> come about.
module kj_host_joints
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_joint_types, only: joint_types, find_joint_type, NDOF, FRAME_MEAN, FRAME_FIRST, &
      FRAME_CROSS
   use kj_draft, only: property_t, joint_t
   use kj_build_joint, only: set_constants, fill_batches
   use kj_attach_joint, only: mean_frame
   use kj_skew, only: skew_axes
   use kj_host, only: joint_spec_t, joint_set_t
   use kj_host_scheme, only: follows_nodes
   implicit none
   private

   public :: set_joints

   !> Mass and inertia where the host moves a carrier
   real(wp), parameter, public :: HELD = 1.0e30_wp

contains

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

end module kj_host_joints
