!> Arrays of all joints of one type, frame rule and law signature: constants and state.
!> Structure of arrays, joint first: one dof of all joints is one contiguous column.
module kj_joint_batch
   use kj_kinds, only: wp
   use kj_joint_types, only: NDOF
   implicit none
   private

   public :: joint_batch_t, joint_state_t, new_batch, new_joint_state

   !> Law signature of a dof, bits
   integer, parameter, public :: LAW_SPRING = 1        !! linear stiffness
   integer, parameter, public :: LAW_DAMPER = 2        !! linear damping, user or critical
   integer, parameter, public :: LAW_SPRING_CURVE = 4  !! tabulated elastic force
   integer, parameter, public :: LAW_DAMPER_CURVE = 8  !! tabulated damping force

   !> Constants of n joints; all in work units
   type :: joint_batch_t
      integer :: n = 0
      integer :: first = 0                      !! index of joint 1 of the batch among all joints, less 1
      integer :: row = 0                        !! row of kj_joint_types
      integer :: frame = 0                      !! FRAME_ constant
      integer :: law(NDOF) = 0                  !! LAW_ bits of each dof
      integer, allocatable :: node(:, :)        !! (n, 2) node index of each end
      integer, allocatable :: lead(:, :)        !! (n, 2) body or free node that carries the end
      integer, allocatable :: skew(:, :)        !! (n, 2) skew index of each end, 0 = none
      real(wp), allocatable :: xl0(:, :)        !! (n, 3) reference offset of node 2, J, length
      real(wp), allocatable :: frame0(:, :)     !! (n, 9) frame at the start, columns E1 E2 E3
      real(wp), allocatable :: k(:, :)          !! (n, 6) stiffness, or scale of the curve
      real(wp), allocatable :: c(:, :)          !! (n, 6) linear damping, user plus critical; or scale of the curve
      real(wp), allocatable :: cr(:)            !! (n) critical damping ratio of the blocked dofs
      real(wp), allocatable :: reduced(:, :)    !! (n, 2) reduced mass, reduced inertia
      integer, allocatable :: k_curve(:, :)     !! (n, 6) curve index, 0 = none
      integer, allocatable :: c_curve(:, :)     !! (n, 6)
      real(wp), allocatable :: k_top(:, :)      !! (n, 2) largest linear stiffness, translation and rotation
      real(wp), allocatable :: c_top(:, :)      !! (n, 2) largest linear user damping
   end type joint_batch_t

   !> What changes
   type :: joint_state_t
      real(wp), allocatable :: e(:, :)          !! (n, 9) joint frame, columns E1 E2 E3
      real(wp), allocatable :: q(:, :)          !! (n, 6) displacement and rotation, J
      real(wp), allocatable :: f(:, :)          !! (n, 6) force and moment on node 1, J
      real(wp), allocatable :: energy(:)        !! (n) work done on the joint
      real(wp), allocatable :: qdot(:, :)       !! (n, 6) rates; only at samples
      real(wp), allocatable :: stiff(:, :)      !! (n, 2) time-step stiffness, translation and rotation
   end type joint_state_t

contains

   !> Allocate the constants of n joints, all zero
   subroutine new_batch(n, batch)
      integer, intent(in) :: n
      type(joint_batch_t), intent(inout) :: batch

      batch%n = n
      allocate (batch%node(n, 2), batch%lead(n, 2), batch%skew(n, 2), batch%k_curve(n, NDOF), &
         batch%c_curve(n, NDOF), source=0)
      allocate (batch%xl0(n, 3), batch%frame0(n, 9), batch%k(n, NDOF), batch%c(n, NDOF), &
         batch%cr(n), batch%reduced(n, 2), batch%k_top(n, 2), batch%c_top(n, 2), source=0.0_wp)
   end subroutine new_batch

   !> State at the start: initial frame, unstrained
   subroutine new_joint_state(batch, state)
      type(joint_batch_t), intent(in) :: batch
      type(joint_state_t), intent(out) :: state

      associate (n => batch%n)
         allocate (state%q(n, NDOF), state%f(n, NDOF), state%energy(n), state%qdot(n, NDOF), &
            state%stiff(n, 2), source=0.0_wp)
      end associate
      allocate (state%e, source=batch%frame0)
   end subroutine new_joint_state

end module kj_joint_batch
