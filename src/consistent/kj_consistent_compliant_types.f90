!> What the integrator `compliant` keeps: multipliers of the joints, their sparse matrix, and the
!> poses that a step starts from.
!> Source: docs/theory/compliant.md.
module kj_consistent_compliant_types
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_consistent_batch, only: matrix_t, limit_block_t
   use kj_gravity, only: gravity_t
   use kj_spring_law, only: spring_block_t
   implicit none
   private

   public :: compliant_block_t, compliant_joint_t, pattern_t, factor_t, end_t, link_t, tie_t, &
      damper_t, leads_then_t, then_t, compliant_t, LONG, N_KEPT

   integer, parameter :: LONG = 3                !! part of a pair whose multipliers do not stay
   integer, parameter :: N_KEPT = 39             !! numbers of a joint that a step changes

   !> A block of joints, numbers that begin as 0. Rows that are not implicit have weight 0.
   type :: compliant_block_t
      sequence
      real(wp) :: k(BLOCK, 6)                    !! stiffness and damping of implicit rows
      real(wp) :: c(BLOCK, 6)
      real(wp) :: own(BLOCK, 6)                  !! B M^-1 B^T of each row alone, of late
      real(wp) :: most(BLOCK, 6)                 !! k, but no more than the step can see
      real(wp) :: kappa(BLOCK, 6)                !! h/(h k + c)
      real(wp) :: phi(BLOCK, 6)                  !! c/(h k + c)
      real(wp) :: weight(BLOCK, 6)               !! h/2 (h k + c)
      real(wp) :: damp(BLOCK, 6)                 !! h/2 c of explicit rows with dampers
      real(wp) :: soft(BLOCK, 6)                 !! 1/(weight + damp) of the matrix that there is
      real(wp) :: f(BLOCK, 6)                    !! multipliers of the position stage
      real(wp) :: rise(BLOCK, 6)                 !! f of the last step less the g before it
      real(wp) :: rise_before(BLOCK, 6)          !! the same of the first short step of a pair
      real(wp) :: asked(BLOCK, 6)                !! change of f that the last pass asked for
      real(wp) :: g(BLOCK, 6)                    !! multipliers of the velocity stage
      real(wp) :: force(BLOCK, 6)                !! of implicit rows at the last time shown
      real(wp) :: rest(BLOCK, 6)                 !! forces of dampers beside their rows
      real(wp) :: r(BLOCK, 6)                    !! work space: residual, right-hand side
      real(wp) :: q0(BLOCK, 6)                   !! what a locked coordinate counts from
      real(wp) :: elastic(BLOCK)                 !! energy in implicit rows
      real(wp) :: q(BLOCK, 6)                    !! coordinates of the pose that is tried
      type(matrix_t) :: b                        !! and its B
      !> moments on body 1 of unit moments of springs, three free rotations
      real(wp) :: rot(BLOCK, 9)
   end type compliant_block_t

   !> The joints of a batch
   type :: compliant_joint_t
      type(compliant_block_t), allocatable :: block(:)
   end type compliant_joint_t

   !> Where the blocks of the factor stand. Nodes are three unknowns each, columns the nodes in the
   !> order of elimination.
   type :: pattern_t
      integer :: n = 0
      integer, allocatable :: column(:)          !! (n) of each node
      integer, allocatable :: first(:)           !! (n + 1) first block below each diagonal
      integer, allocatable :: row(:)             !! (blocks) column that the row belongs to
      integer, allocatable :: update(:)          !! where products of blocks of columns go
   end type pattern_t

   !> The matrix and its factor, blocks of 3 x 3 with a row of zeros, which makes them whole vectors
   type :: factor_t
      real(wp), allocatable :: diagonal(:, :, :) !! (4, 3, n) lower triangles
      real(wp), allocatable :: below(:, :, :)    !! (4, 3, blocks)
      real(wp), allocatable :: sign(:)           !! (n) of the diagonal: bodies have -1
      real(wp), allocatable :: x(:, :)           !! (4, n) right-hand side and solution
   end type factor_t

   !> An end of a joint
   type :: end_t
      integer :: batch = 0, at = 0, lane = 0     !! where the joint stands
      integer :: which = 0, lead = 0             !! 1 or 2, and the body there
      integer :: node = 0                        !! of translations; rotations: the next; 0 = none
   end type end_t

   !> A body between two joints, which is no node: what it couples. A block is that of the rows of
   !> the first and the columns of the second, translations and rotations; < 0: its transpose
   type :: link_t
      type(end_t) :: end(2)
      integer :: place(2, 2) = 0
   end type link_t

   !> An end of a joint at a body that is a node: blocks of its translations and the velocity, its
   !> translations and the angular velocity, its rotations and that
   type :: tie_t
      type(end_t) :: end
      integer :: place(3) = 0
   end type tie_t

   !> Leads at the start of a step
   type :: leads_then_t
      real(wp), allocatable :: x(:, :), d(:, :), quat(:, :), v(:, :), l(:, :)
      real(wp), allocatable :: f(:, :), t(:, :), own_f(:, :), own_t(:, :)
      real(wp), allocatable :: impulse(:, :), angular_impulse(:, :)
      !> (n_lead, 3) velocities and angular momentum of the half step
      real(wp), allocatable :: v_half(:, :), w_half(:, :), l_half(:, :)
   end type leads_then_t

   !> Limits and hardened springs of a batch
   type :: limits_then_t
      type(limit_block_t), allocatable :: block(:)
      type(spring_block_t), allocatable :: spring(:)
   end type limits_then_t

   !> All that a step changes, as it was. Coordinates and B follow from the poses.
   type :: then_t
      type(leads_then_t) :: leads
      integer :: cycle = 0, jump = 0
      real(wp) :: time = 0.0_wp, work = 0.0_wp, h_last = 0.0_wp, h_stiff = 0.0_wp
      real(wp), allocatable :: joint(:, :, :)         !! (BLOCK, N_KEPT, blocks of all batches)
      type(limits_then_t), allocatable :: limit(:)    !! (batches)
      real(wp), allocatable :: turn(:, :), motion_at(:)
      real(wp), allocatable :: load_force(:, :), load_place(:, :)
      type(gravity_t), allocatable :: field(:)
   end type then_t

   !> A row with a damper that is not implicit otherwise
   type :: damper_t
      integer :: batch = 0, at = 0, lane = 0, row = 0
      integer :: column = 0, part = 0            !! where it stands in a solution
   end type damper_t

   !> All of it
   type :: compliant_t
      logical :: rigid = .false.                 !! Kn = infinity
      !> of a rigid row over the way that its force alone moves the bodies in a step
      real(wp) :: gap = 1.0e-6_wp
      type(compliant_joint_t), allocatable :: joint(:)
      type(pattern_t) :: pattern
      type(factor_t) :: factor
      type(factor_t) :: first                    !! of the first short step of a pair
      type(link_t), allocatable :: link(:)
      type(tie_t), allocatable :: tie(:)
      !> these, where they are few: then the matrix of a velocity stage, which has them, serves the
      !> next position stage, and what unit forces on them do is taken out of its solutions
      type(damper_t), allocatable :: damper(:)
      real(wp), allocatable :: response(:, :, :) !! (4, n, dampers)
      integer, allocatable :: node(:)            !! (n_element) of translations, 0 = no rows
      integer, allocatable :: across(:)          !! (n_element) block of rotations, translations
      integer, allocatable :: hub(:)             !! leads that are nodes
      integer, allocatable :: body(:)            !! (n_lead) node of the velocity of these, 0 = none
      !> (n_lead) of the other leads: inverse mass, and what makes one of poses%ij; 0 for these
      real(wp), allocatable :: im(:), share(:)
      type(leads_then_t) :: start
      type(then_t) :: then(2)                    !! at the start of a step, and its fine end
      real(wp), allocatable :: y(:, :), turn(:, :)   !! (n_lead, 3) change of velocities
      logical, allocatable :: rowed(:)           !! (batches) some rows are implicit or have dampers
      !> (batches) the last row that is implicit or may have a damper, 3 or 6
      integer, allocatable :: last(:)
      logical, allocatable :: sprung(:)          !! (batches) some rows are explicit and have forces
      logical, allocatable :: explicit(:, :)     !! (6, batches) rows that are not implicit
      logical, allocatable :: damped(:)          !! (batches) some explicit row has a damper
      logical, allocatable :: partly(:)          !! (n_lead) some directions held
      !> (n_lead, 3) explicit forces and moments while those of constraints are added
      real(wp), allocatable :: f(:, :), t(:, :)
      !> (3, 3, 2, n_lead) projector on the free directions of these, translations and rotations
      real(wp), allocatable :: free(:, :, :, :)
      logical :: factored = .false.              !! the matrix of position stages is there
      logical :: any_damper = .false.            !! rows of dampers
      logical :: apart = .false.                 !! so many that the stages have their own matrices
      logical :: answered = .false.              !! and the responses of the dampers that are in it
      real(wp) :: h_factor = 0.0_wp              !! step of it
      real(wp) :: h_last = 0.0_wp                !! last step, 0 = none
      real(wp) :: h_stiff = 0.0_wp               !! longest step of late, for the stiffness bound
      integer :: known = -1                      !! cycle whose f is converged already
      real(wp) :: h_known = 0.0_wp               !! for this step
      integer :: renewed = 0                     !! steps since stiffness was bounded
      integer :: jump = 0                        !! steps since a start or jump
      integer :: part = 0                        !! of a pair, short, short, LONG; 0: a single step
      real(wp) :: size = 0.0_wp                  !! of the scene
      real(wp) :: stiffest(2) = 0.0_wp           !! largest 1/kappa, translations and rotations
      real(wp) :: e_way = 0.0_wp, e_turn = 0.0_wp   !! estimated error of the last step
      integer :: passes = 0                      !! of the last step
      integer :: joint_worst = 0                 !! that did not converge, index among all
      real(wp) :: force = 0.0_wp                 !! largest of late, moments over the size
      real(wp) :: left_over = 0.0_wp             !! part of the last change of f that is not in it
      logical :: failed = .false.                !! steps came to an end
      real(wp) :: loss = 0.0_wp                  !! kinetic energy that the start took
      real(wp) :: kinetic = 0.0_wp               !! that there was before
      !> that, and of the first forces over as much way as positions may be wrong by
      real(wp) :: least_scale = 0.0_wp
   end type compliant_t

end module kj_consistent_compliant_types
