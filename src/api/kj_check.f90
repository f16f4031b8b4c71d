!> What `check_simulation` tells of a scene before it runs.
module kj_check
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t
   use kj_text, only: text_t
   implicit none
   private

   public :: check_t, limit_row_t

   !> Stop and friction of one direction of a joint; stops 0 and a friction limit 0: none
   type :: limit_row_t
      integer :: joint = 0                        !! index among the joints of the report
      integer :: dof = 0                          !! direction, 1-6
      real(wp) :: lo = 0.0_wp, hi = 0.0_wp        !! stops
      logical :: combined = .false.               !! one circle or sphere with others
      real(wp) :: stop_k = 0.0_wp                 !! stiffness of the stops; 0: automatic
      real(wp) :: slip = 0.0_wp                   !! limit of friction, or scale of its function
      integer :: slip_curve = 0                   !! id of the function, 0 = none
      real(wp) :: slip_k = 0.0_wp                 !! stiffness of friction
   end type limit_row_t

   !> Joints, bodies and time-step limits; all in work units, ids are those of the deck
   type :: check_t
      integer :: n_spring = 0                     !! the last ones of the joints
      integer :: n_node = 0, n_free = 0, n_curve = 0, n_load = 0
      ! limits of the time step, before any factor
      real(wp) :: nodal_step = 0.0_wp             !! the rule of Radioss; huge: nothing limits it
      real(wp) :: safe_step = 0.0_wp              !! stable for certain
      real(wp) :: exact_step = 0.0_wp             !! of the assembled scene; 0: too large to tell
      ! of the integrator compliant, at the start
      real(wp) :: turn_step = 0.0_wp              !! by the turn of the bodies; huge: no limit
      real(wp) :: spring_step = 0.0_wp            !! by explicit springs, friction; huge: none
      real(wp) :: stiffest = 0.0_wp               !! frequency of the stiffest blocked row alone
      integer :: n_redundant = 0                  !! blocked rows that repeat others; -1: too many
      real(wp) :: factor = 0.0_wp                 !! on the critical step, of deck or options
      integer :: safe_joint = 0                   !! place of the joint that holds it, 0 = none
      real(wp) :: t_stop = 0.0_wp                 !! end of a run
      real(wp) :: cycles = 0.0_wp                 !! of a run, about
      real(wp) :: seconds = 0.0_wp                !! that it takes by the pace of its first cycles
      real(wp) :: samples = 0.0_wp                !! that it writes, each of `values` numbers
      integer :: values = 0
      type(finding_list_t) :: warnings            !! of a run that would end at once
      real(wp), allocatable :: island_step(:)     !! safe steps of islands; huge: none
      ! joints in deck order, then springs in deck order
      integer, allocatable :: joint(:), property(:)   !! (n_joint)
      type(text_t), allocatable :: joint_title(:) !! (n_joint) "pin C (903)", or the id alone
      integer, allocatable :: row(:)              !! (n_joint) of kj_joint_types
      integer, allocatable :: kind(:)             !! (n_joint) KJOINT, KJOINT2, SPRING4 or SPRING8
      integer, allocatable :: frame(:)            !! (n_joint) FRAME_ constant
      integer, allocatable :: node(:, :), body(:, :)  !! (2, n_joint); body 0 = a free node
      real(wp), allocatable :: length(:)          !! (n_joint) from node 1 to node 2
      !> (2, n_joint) stiffness of the blocked translations and rotations, 0 = none or not yet known
      real(wp), allocatable :: blocking(:, :)
      logical, allocatable :: automatic(:)        !! (n_joint) blocking comes from the first step
      real(wp), allocatable :: ratio(:)           !! (n_joint) largest damping ratio of all dofs
      real(wp), allocatable :: step(:)            !! (n_joint) critical step of the joint alone
      real(wp), allocatable :: t_lock(:), t_free(:)   !! (n_element) locked from, to; huge: never
      !> stops and friction, in deck order of the joints; KJOINT2 only
      type(limit_row_t), allocatable :: limit(:)
      ! bodies in ascending id
      integer, allocatable :: body_id(:), n_secondary(:), n_joint(:)   !! (n_body)
      type(text_t), allocatable :: body_title(:)  !! (n_body) as of joints
      real(wp), allocatable :: mass(:)            !! (n_body)
      real(wp), allocatable :: inertia(:, :)      !! (3, n_body) principal, descending
      real(wp), allocatable :: centre(:, :)       !! (3, n_body) centre of gravity, W
      logical, allocatable :: held(:, :)          !! (6, n_body) blocked by conditions
      integer, allocatable :: n_driven(:)         !! (n_body) imposed motions
   end type check_t

end module kj_check
