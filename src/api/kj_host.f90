!> Joints as elements of a host code: what a host describes, and the set that keeps it.
!>
!> The host owns nodes, masses and time. Everything is in units of the host, which must agree with
!> each other (such as kg, m, s or t, mm, s); angles are in radian, vectors in the global frame W
!> where nothing else is said. Node numbers count from 1 in the arrays of the host.
module kj_host
   use kj_kinds, only: wp
   use kj_math3, only: IDENTITY, cross
   use kj_joint_types, only: NDOF
   use kj_legacy_state, only: legacy_state_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_safe_step, only: bound_t
   implicit none
   private

   public :: joint_spec_t, joint_result_t, joint_set_t, host_vector, host_quaternion, shear_angle

   !> A joint as code describes it; what is not set keeps its default
   type :: joint_spec_t
      integer :: id = 0                          !! any number, for messages
      integer :: type = 0                        !! number in kj_joint_types, as on the card
      integer :: node(2) = 0                     !! host nodes at which end 1 and end 2 sit
      !> host nodes that take force and moment and whose rotation the ends follow, such as the main
      !> node of a rigid body; 0: the node itself
      integer :: carrier(2) = 0
      !> the joint frame is that of end 1 (skew flag 1), else midway between both ends
      logical :: first_frame = .false.
      !> host nodes that span the axes of an end (columns: end 1, end 2): x from the first to the
      !> second, the third in the x-y plane; 0: `axes` holds
      integer :: axis_node(3, 2) = 0
      !> joint frame at the start, columns x y z, W; universal: y the axis of end 1, z that of end 2
      real(wp) :: axes(3, 3) = IDENTITY
      real(wp) :: kn = 0.0_wp                    !! stiffness of blocked directions, force/length
      real(wp) :: cr = 0.0_wp                    !! twice their damping ratio, 0 to 1; 0 is 0.05
      !> stiffness of free directions, tx ty tz rx ry rz, or scale of the curve (0 is 1)
      real(wp) :: k(NDOF) = 0.0_wp
      real(wp) :: c(NDOF) = 0.0_wp               !! damping likewise
      integer :: k_curve(NDOF) = 0               !! force over displacement: from add_joint_curve
      integer :: c_curve(NDOF) = 0               !! force over velocity
   end type joint_spec_t

   !> What a joint does at the last call of joint_forces
   type :: joint_result_t
      integer :: id = 0
      integer :: type = 0                        !! number in kj_joint_types
      real(wp) :: force(NDOF) = 0.0_wp           !! force and moment on end 1, joint frame
      real(wp) :: displacement(NDOF) = 0.0_wp    !! of end 2 from end 1, joint frame; [rad]
      real(wp) :: frame(3, 3) = 0.0_wp           !! axes x y z of the joint frame, columns, W
      real(wp) :: energy = 0.0_wp                !! work done on the joint since the start
      !> energy that its dampers took; legacy does not tell it apart: 0
      real(wp) :: dissipated = 0.0_wp
      !> loss of orthogonality [rad], see find_orthogonality
      real(wp) :: orthogonality = 0.0_wp
   end type joint_result_t

   !> Joints of one host: constants and state. Sets are independent of each other. The components
   !> are for this library alone.
   type :: joint_set_t
      logical :: made = .false., started = .false.
      logical :: legacy = .false.
      logical :: by_component = .false.          !! host arrays are (n, 3), else (3, n)
      integer :: n_host = 0                      !! nodes of the host
      type(joint_spec_t), allocatable :: spec(:) !! (>= n_spec) joints until they are started
      integer :: n_spec = 0
      integer, allocatable :: host(:)            !! (n_node) host node of each node, 0 = not read
      integer, allocatable :: shear_node(:, :)   !! (3, n) nodes of each measured skew
      integer, allocatable :: shear_of(:)        !! (n) joint, ascending; negative: its end 2
      integer, allocatable :: shear_first(:)     !! (n_joint + 1) where those of a joint begin
      real(wp), allocatable :: shear0(:)         !! (n) angle of their first two directions at start
      real(wp), allocatable :: quat_own(:, :)    !! (n_lead, 4) principal axes in axes of the host
      real(wp) :: time = 0.0_wp, h_last = 0.0_wp !! time and step of the last call
      logical, allocatable :: warned(:)          !! (n_joint) of orthogonality
      type(consistent_model_t) :: model
      type(legacy_state_t) :: state                     !! legacy
      type(consistent_state_t) :: cs
      type(bound_t) :: bound
   end type joint_set_t

contains

   !> Vector of one host node
   pure function host_vector(set, a, node) result(y)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: a(:, :)            !! (3, n) or (n, 3)
      integer, intent(in) :: node
      real(wp) :: y(3)

      if (set%by_component) then
         y = a(node, :)
      else
         y = a(:, node)
      end if
   end function host_vector

   !> Unit quaternion w x y z of a host node; not finite where it has none
   pure function host_quaternion(set, attitude, node) result(q)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: attitude(:, :)
      integer, intent(in) :: node
      real(wp) :: q(4)

      if (set%by_component) then
         q = attitude(node, :)
      else
         q = attitude(:, node)
      end if
      q = q/norm2(q)
   end function host_quaternion

   !> Angle between the directions from node 1 to nodes 2 and 3 [rad]; constant on a rigid body
   pure real(wp) function shear_angle(x) result(angle)
      real(wp), intent(in) :: x(3, 3)            !! (node, component)

      associate (a => x(2, :) - x(1, :), b => x(3, :) - x(1, :))
         angle = atan2(norm2(cross(a, b)), dot_product(a, b))
      end associate
   end function shear_angle

end module kj_host
