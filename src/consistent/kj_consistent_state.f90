!> Everything that changes under the consistent formulation. Positions, velocities and forces stand
!> at the same time t(n); the leads (bodies and free nodes) all have an attitude.
module kj_consistent_state
   use kj_kinds, only: wp
   use kj_team, only: team_t, trial_t
   use kj_model, only: model_t
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_matrix, only: poses_t
   use kj_gravity, only: gravity_t
   use kj_consistent_compliant_types, only: compliant_t
   implicit none
   private

   public :: consistent_model_t, consistent_state_t, row_t, hold_t, kept_t, rates_t, stages_t

   !> One held or driven direction of a lead
   type :: row_t
      integer :: dir = 1                         !! 1-6
      integer :: skew = 0                        !! its axes
      integer :: motion = 0                      !! imposed motion that drives it, 0 = blocked
   end type row_t

   !> Conditions of one lead
   type :: hold_t
      integer :: lead = 0
      integer :: n_trans = 0, n_rot = 0          !! rows used
      type(row_t) :: trans(3), rot(3)
   end type hold_t

   !> What a step keeps of the leads that have conditions
   type :: kept_t
      real(wp), allocatable :: rates(:, :)       !! (6, n_hold) velocities before a kick
      real(wp), allocatable :: quat(:, :)        !! (4, n_hold) attitudes before the drift
      real(wp), allocatable :: w(:, :)           !! (3, n_hold) angular velocities of the drift
      !> (2, n_hold, parts of the step) work that the last projection took, translations and
      !> rotations
      real(wp), allocatable :: work(:, :, :)
   end type kept_t

   !> Rates of one stage of a Runge-Kutta step, or their weighted sum
   type :: rates_t
      real(wp), allocatable :: x(:, :), turn(:, :), v(:, :), l(:, :)   !! (n_lead, 3)
   end type rates_t

   !> What such a step keeps: where it starts, and its motions
   type :: stages_t
      type(rates_t) :: stage, total
      real(wp), allocatable :: x(:, :), d(:, :), quat(:, :), v(:, :), l(:, :)   !! (n_lead, 3 or 4)
      real(wp), allocatable :: mean(:), final(:), there(:), between(:)   !! (n_motion)
      logical, allocatable :: active(:), acts(:)
   end type stages_t

   !> The model with the constants of the consistent formulation
   type, extends(model_t) :: consistent_model_t
      type(joint_batch_t), allocatable :: geometry(:)   !! of each batch
      type(team_t) :: team                       !! pieces for the threads
      logical :: damped = .false.                !! some joint has damping
      real(wp), allocatable :: inverse_mass(:)   !! (n_lead) 0 where held or massless
      !> (n_lead, 3) principal inertia and its inverse, 0 where held
      real(wp), allocatable :: spin_inertia(:, :), inverse_inertia(:, :)
      !> (n_lead) axis of symmetry, 0 = three unequal inertias
      integer, allocatable :: equal(:)
      integer, allocatable :: n_end(:)           !! (n_lead) joint ends on it
      !> (n_lead, 4) attitude at the start: principal axes
      real(wp), allocatable :: quat0(:, :)
      real(wp), allocatable :: axes0(:, :)       !! (n_lead, 9) the same as columns
      real(wp), allocatable :: arm(:, :)         !! (n_node, 3) nodes from their leads, body axes
      !> secondary nodes that loads and skews need in every step
      integer, allocatable :: placed(:)
      integer, allocatable :: loose(:, :)        !! (2, n) joint ends whose skew rides elsewhere
      logical, allocatable :: steady(:)          !! (gravity cards) constant: has a potential
      type(hold_t), allocatable :: hold(:)       !! ascending lead; not of those that rest
      integer, allocatable :: hold_to(:)         !! (0:blocks of leads) holds up to that block
      !> (2, blocks of leads) first and last lead that does not rest; last < first: all rest
      integer, allocatable :: mover(:, :)
      integer, allocatable :: hold_of(:)         !! (n_lead) its conditions, 0 = none
      logical, allocatable :: rests(:)           !! (n_lead) blocked in all directions: no hold
      real(wp), allocatable :: turns(:)          !! (n_lead) 0 where it rests, else 1
   end type consistent_model_t

   !> The state
   type :: consistent_state_t
      integer :: cycle = 0
      real(wp) :: time = 0.0_wp
      real(wp) :: h = 0.0_wp                     !! step under way
      type(poses_t) :: poses                     !! what joints see
      !> (n_lead, 3) velocity, angular momentum about the lead, W
      real(wp), allocatable :: v(:, :), l(:, :)
      real(wp), allocatable :: f(:, :), t(:, :)  !! (n_lead, 3) force and moment, all but reactions
      !> (n_lead, 3) of these, gravity and loads on the lead itself; no rows where a host adds them
      real(wp), allocatable :: own_f(:, :), own_t(:, :)
      !> (n_lead, 3) of these, what an embedding host applies now and in the last step; not
      !> allocated: nothing
      real(wp), allocatable :: f_host(:, :), t_host(:, :), f_host_old(:, :), t_host_old(:, :)
      !> (n_lead, 3) what the host of single joints adds by itself: dampers look ahead with it
      real(wp), allocatable :: f_ahead(:, :), t_ahead(:, :)
      !> (n_body, 3) sums over time
      real(wp), allocatable :: impulse(:, :), angular_impulse(:, :), turn(:, :)
      real(wp), allocatable :: node(:, :)        !! (n_node, 3) positions of leads and placed nodes
      real(wp), allocatable :: skew(:, :)        !! (0:n_skew, 9)
      type(kept_t) :: kept
      type(consistent_joint_t), allocatable :: joint(:)
      real(wp), allocatable :: wrench(:, :)      !! (N_CONSISTENT_WRENCH, n_element)
      real(wp), allocatable :: part(:, :)        !! (N_SUM, parts of hubs) their sums
      type(trial_t) :: trial                     !! how many threads are at work
      !> (n_motion) wanted velocities of the step: mean, and at its end; which motions act
      real(wp), allocatable :: mean(:), final(:)
      logical, allocatable :: active(:)
      !> (n_motion) value reached: velocity of an imposed acceleration
      real(wp), allocatable :: motion_at(:)
      !> (3, entries) of concentrated loads
      real(wp), allocatable :: load_force(:, :), load_place(:, :)
      type(gravity_t), allocatable :: field(:)     !! cards of gravity
      type(compliant_t), allocatable :: compliant    !! of that integrator alone
      type(stages_t), allocatable :: stages          !! of rkmk4 alone, between its steps
      ! ledger
      real(wp) :: work = 0.0_wp                  !! of loads and imposed motion
      logical :: by_steps = .true.               !! work of loads by mean force times displacement
      real(wp) :: s0 = 0.0_wp                    !! S at the start
      real(wp) :: offset = 0.0_wp                !! of S, where the step changed
      real(wp) :: energy = 0.0_wp                !! kinetic + elastic, when last summed up
      real(wp) :: change = 0.0_wp                !! S - s0, then
      real(wp) :: scale = 0.0_wp                 !! largest kinetic + elastic + |work| so far
      real(wp) :: error = 0.0_wp                 !! (S - s0)/scale
   end type consistent_state_t

end module kj_consistent_state
