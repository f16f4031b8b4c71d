!> Joint properties and joints on their way from cards into batches.
module kj_joint_draft
   use kj_kinds, only: wp
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: KJOINT
   implicit none
   private

   public :: property_t, joint_t

   !> A /PROP/KJOINT or /PROP/KJOINT2, checked; in work units
   type :: property_t
      integer :: id = 0
      integer :: kind = KJOINT                  !! KJOINT, KJOINT2, SPRING4 or SPRING8
      integer :: row = 0                        !! row of kj_joint_types, 0 = not usable
      integer :: frame = 0                      !! FRAME_ constant
      integer :: skew(2) = 0                    !! skew indices
      real(wp) :: kn = 0.0_wp, cr = 0.0_wp
      real(wp) :: cr_stop = 0.0_wp              !! Cr as typed: its default is not for stops
      real(wp) :: k(NDOF) = 0.0_wp, c(NDOF) = 0.0_wp      !! of the free dofs
      integer :: k_curve(NDOF) = 0, c_curve(NDOF) = 0
      ! KJOINT2 only
      real(wp) :: scf = 1.0_wp                  !! scale of the blocked rotations
      logical :: automatic = .false.            !! Kn comes from the first step
      real(wp) :: lo(NDOF) = 0.0_wp, hi(NDOF) = 0.0_wp    !! stops, 0 = none
      integer :: combined(NDOF) = 0             !! 1 where the stop is shared with other dofs
      real(wp) :: k_limit(NDOF) = 0.0_wp        !! stiffness of friction and stop
      real(wp) :: slip(NDOF) = 0.0_wp           !! limit of friction, or scale of its curve
      integer :: slip_curve(NDOF) = 0
      real(wp) :: t_lock = huge(1.0_wp), t_free = huge(1.0_wp)
      logical :: limited = .false.              !! has stops, friction, a lock or automatic
                                                !! stiffness
      ! springs only
      real(wp) :: mass = 0.0_wp, inertia = 0.0_wp
      logical :: balanced = .false.             !! asks for the couple of the force (Iequil)
   end type property_t

   !> A spring element on its way into a batch
   type :: joint_t
      integer :: property = 0                   !! place in the list of properties
      integer :: node(2) = 0                    !! model indices
      integer :: skew(2) = 0
      real(wp) :: frame(3, 3) = 0.0_wp          !! at the start, columns, W
      real(wp) :: angle(3) = 0.0_wp             !! rotation at the start, J [rad]
      real(wp) :: xl0(3) = 0.0_wp, reduced(2) = 0.0_wp
      real(wp) :: k(NDOF) = 0.0_wp, c(NDOF) = 0.0_wp
      real(wp) :: k_block(2) = 0.0_wp           !! of the blocked translations and rotations
      integer :: law(NDOF) = 0
      ! springs only
      integer :: rule = 0                       !! FRAME_ constant, 0 = that of the property
      !> largest stiffness of translations and rotations, largest damping of both
      real(wp) :: top(4) = 0.0_wp
   end type joint_t

end module kj_joint_draft
