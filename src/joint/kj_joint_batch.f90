!> Arrays of all joints of one type, frame rule and law signature: constants.
!> Structure of arrays, joint first: one dof of all joints is one contiguous column.
module kj_joint_batch
   use kj_kinds, only: wp
   use kj_joint_types, only: NDOF, joint_types
   use kj_spring_law, only: spring_t
   implicit none
   private

   public :: joint_batch_t, limits_t, geometry_t, new_batch, new_limits, is_spring, &
      is_hardened, has_friction, has_limits, blocking_stiffness

   !> Law signature of a dof, bits
   integer, parameter, public :: LAW_SPRING = 1        !! linear stiffness
   integer, parameter, public :: LAW_DAMPER = 2        !! linear damping, user or critical
   integer, parameter, public :: LAW_SPRING_CURVE = 4  !! tabulated elastic force
   integer, parameter, public :: LAW_DAMPER_CURVE = 8  !! tabulated damping force
   integer, parameter, public :: LAW_HARDENED = 16     !! both as batch%spring has them

   integer, parameter, public :: KJOINT = 33, KJOINT2 = 45   !! kinds: /PROP/TYPE33, /PROP/TYPE45
   integer, parameter, public :: SPRING4 = 4, SPRING8 = 8, SPRING13 = 13   !! of /PROP/TYPEn

   real(wp), parameter :: TINY_VALUE = 1.0e-20_wp            !! nothing is given

   !> What a dof does, state%flag
   integer, parameter, public :: DOF_FREE = 0, DOF_SLIDING = 1, DOF_STICKING = 2, DOF_AT_STOP = 3, &
      DOF_LOCKED = 4, DOF_BLOCKED = 5

   !> Stops, friction, lock and automatic stiffness of a limited batch (KJOINT2 only).
   !>
   !> A stop 0 is no stop. Where a dof has friction its stop is the friction spring that may no
   !> longer slide; where it has none the stop has stiffness k, or for k = 0 that of blocked dofs.
   type :: limits_t
      real(wp), allocatable :: lo(:, :), hi(:, :)   !! (n, 6) stops, lo <= 0 <= hi
      real(wp), allocatable :: combined(:, :)   !! (n, 6) 1 where dofs share the stop, else 0
      real(wp), allocatable :: k(:, :)          !! (n, 6) stiffness of friction or stop
      real(wp), allocatable :: slip(:, :)       !! (n, 6) friction limit, or scale of its curve
      integer, allocatable :: slip_curve(:, :)  !! (n, 6) curve of q, 0 = none
      real(wp), allocatable :: cr(:)            !! (n) twice the damping ratio where a limit acts
      real(wp), allocatable :: cr_stop(:)       !! (n) the same of stops, consistent: as typed
      real(wp), allocatable :: k_block(:, :)    !! (n, 2) blocked translations, rotations
      logical, allocatable :: automatic(:)      !! (n) k_block comes from the first step
      real(wp), allocatable :: t_lock(:), t_free(:)   !! (n) locked while t_lock < t <= t_free
   end type limits_t

   !> What the consistent formulation adds to the constants of n joints
   type :: geometry_t
      integer :: chart = 0                       !! CHART_ constant
      logical :: mean = .true.                   !! translations in the mean frame, else of body 1
      integer :: sprung = 0, damped = 0          !! the dofs 1 to 0, 3 or 6 may have such forces
      logical :: shifted = .false.               !! some angle does not start at 0
      logical :: implicit = .false.              !! blocked directions and locks are implicit
      !> three free rotations without forces, and no translations that need their mean frame
      logical :: ball = .false.
      !> (n) equal springs without a length: no frame needed
      logical, allocatable :: plain(:)
      !> (n, 6) node 1 and node 2 from their leads, body axes
      real(wp), allocatable :: arm(:, :)
      real(wp), allocatable :: triad(:, :)       !! (n, 8) quaternions of the triads in body axes
      real(wp), allocatable :: apart(:, :)       !! (n, 3) lead 2 from lead 1 at the start, W
      real(wp), allocatable :: axis_angle(:)     !! (n) angle(e2, e3) at the start, universal
      !> (n) 1, -1: body 1, 2 does not turn and carries the mean frame; where a direction is free
      real(wp), allocatable :: rail(:)
      !> (n, 6) effective mass or inertia of each dof, of limited batches
      real(wp), allocatable :: inertia(:, :)
   end type geometry_t

   !> Constants of n joints; all in work units
   type :: joint_batch_t
      integer :: n = 0
      integer :: first = 0                      !! index of joint 1 of the batch among all joints,
                                                !! less 1
      integer :: row = 0                        !! row of kj_joint_types
      integer :: frame = 0                      !! FRAME_ constant
      integer :: law(NDOF) = 0                  !! LAW_ bits of each dof
      integer :: kind = KJOINT                  !! KJOINT, KJOINT2 or a SPRING
      logical :: limited = .false.              !! `limit` is there and acts
      logical :: abreast = .false.              !! leads of a block follow each other at either end
      integer, allocatable :: node(:, :)        !! (n, 2) node index of each end
      integer, allocatable :: lead(:, :)        !! (n, 2) body or free node that carries the end
      integer, allocatable :: skew(:, :)        !! (n, 2) skew index of each end, 0 = none
      real(wp), allocatable :: xl0(:, :)        !! (n, 3) reference offset of node 2, J, length
      real(wp), allocatable :: frame0(:, :)     !! (n, 9) frame at the start, columns E1 E2 E3
      real(wp), allocatable :: k(:, :)          !! (n, 6) stiffness, or scale of the curve
      real(wp), allocatable :: c(:, :)          !! (n, 6) linear damping, user plus critical; or
                                                !! scale of the curve
      real(wp), allocatable :: cr(:)            !! (n) twice the damping ratio of the blocked dofs
      real(wp), allocatable :: scale(:)         !! (n) SCF of a KJOINT2, else 1
      real(wp), allocatable :: reduced(:, :)    !! (n, 2) reduced mass, reduced inertia
      integer, allocatable :: k_curve(:, :)     !! (n, 6) curve index, 0 = none
      integer, allocatable :: c_curve(:, :)     !! (n, 6)
      real(wp), allocatable :: k_top(:, :)      !! (n, 2) largest linear stiffness, translation and
                                                !! rotation
      real(wp), allocatable :: c_top(:, :)      !! (n, 2) largest linear user damping
      real(wp), allocatable :: angle0(:, :)     !! (n, 3) rotation at the start, J [rad]
      type(spring_t), allocatable :: spring(:)  !! (n) of springs only
      type(limits_t) :: limit
      type(geometry_t) :: geometry
   end type joint_batch_t

contains

   !> A batch of springs with more than elastic laws
   pure logical function is_hardened(batch)
      type(joint_batch_t), intent(in) :: batch

      is_hardened = .false.
      if (allocated(batch%spring)) is_hardened = any(batch%law == LAW_HARDENED)
   end function is_hardened

   !> A batch of springs, not of joints
   pure elemental logical function is_spring(batch)
      type(joint_batch_t), intent(in) :: batch

      is_spring = any(batch%kind == [SPRING4, SPRING8, SPRING13])
   end function is_spring

   !> Allocate the constants of n joints, all zero
   subroutine new_batch(n, batch)
      integer, intent(in) :: n
      type(joint_batch_t), intent(inout) :: batch

      batch%n = n
      allocate (batch%node(n, 2), batch%lead(n, 2), batch%skew(n, 2), batch%k_curve(n, NDOF), &
         batch%c_curve(n, NDOF), source=0)
      allocate (batch%xl0(n, 3), batch%frame0(n, 9), batch%k(n, NDOF), batch%c(n, NDOF), &
         batch%cr(n), batch%reduced(n, 2), batch%k_top(n, 2), batch%c_top(n, 2), &
         batch%angle0(n, 3), source=0.0_wp)
      allocate (batch%scale(n), source=1.0_wp)
   end subroutine new_batch

   !> Allocate the limits of a batch: no stops, no friction, no lock
   subroutine new_limits(batch)
      type(joint_batch_t), intent(inout) :: batch

      batch%limited = .true.
      associate (n => batch%n, l => batch%limit)
         allocate (l%lo(n, NDOF), l%hi(n, NDOF), l%combined(n, NDOF), l%k(n, NDOF), &
            l%slip(n, NDOF), l%cr(n), l%cr_stop(n), l%k_block(n, 2), source=0.0_wp)
         allocate (l%slip_curve(n, NDOF), source=0)
         allocate (l%automatic(n), source=.false.)
         allocate (l%t_lock(n), l%t_free(n), source=huge(1.0_wp))
      end associate
   end subroutine new_limits

   !> A dof with this stiffness, limit and curve has friction
   pure elemental logical function has_friction(k, slip, curve) result(has)
      real(wp), intent(in) :: k, slip
      integer, intent(in) :: curve

      has = k > TINY_VALUE .and. (slip > TINY_VALUE .or. curve > 0)
   end function has_friction

   !> Joint j has stops, friction or a lock
   pure logical function has_limits(limit, j) result(has)
      type(limits_t), intent(in) :: limit
      integer, intent(in) :: j

      has = limit%t_lock(j) < huge(1.0_wp) .or. any(limit%lo(j, :) < 0.0_wp) .or. &
         any(limit%hi(j, :) > 0.0_wp) .or. &
         any(has_friction(limit%k(j, :), limit%slip(j, :), limit%slip_curve(j, :)))
   end function has_limits

   !> Stiffness of the blocked translations and rotations of joint p; 0 = none, or not yet known
   pure function blocking_stiffness(batch, p) result(k)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: p
      real(wp) :: k(2)

      k(1) = maxval(batch%k(p, :3), mask=joint_types(batch%row)%free(:3) == 0)
      k(2) = maxval(batch%k(p, 4:), mask=joint_types(batch%row)%free(4:) == 0)
      k = max(0.0_wp, k)
   end function blocking_stiffness

end module kj_joint_batch
