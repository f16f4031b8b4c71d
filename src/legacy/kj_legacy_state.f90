!> Everything that changes during a legacy run.
!>
!> Between cycles x, d are at t(n), v, w at t(n - 1/2); after the forces of cycle n, a, al are at
!> t(n).
module kj_legacy_state
   use kj_kinds, only: wp
   use kj_team, only: team_t, trial_t, new_team
   use kj_lead_map, only: N_SUM, N_WRENCH
   use kj_joint_batch, only: is_spring, SPRING13
   use kj_model, only: model_t, bcs_t, SCALE_MASS, SCALE_MASS_NEXT
   use kj_legacy_force, only: world_t
   use kj_legacy_joint, only: legacy_joint_t, new_legacy_joint
   use kj_gravity, only: gravity_t, new_gravity
   use kj_snapshot, only: OWNER_NONE
   implicit none
   private

   public :: legacy_state_t, new_legacy_state, crew_t

   real(wp), parameter, public :: EPS20 = 1.0e-20_wp
   real(wp), parameter, public :: NO_LIMIT = 1.0e6_wp   !! step of a scene that nothing limits
   !> largest growth of the step, single precision
   real(wp), parameter, public :: GROWTH = real(1.1, wp)

   !> Secondary nodes that joints, skews, loads or the history read, lead by lead
   type :: crew_t
      integer, allocatable :: first(:)        !! (n_lead + 1) start of each lead's nodes
      integer, allocatable :: node(:)
      logical, allocatable :: kept(:)         !! its velocity and displacement are read, too
      logical, allocatable :: unread(:)       !! (n_lead) that is true of none of its nodes
      logical, allocatable :: few(:)          !! (n_lead) it has at most two secondary nodes
   end type crew_t

   !> The state
   type :: legacy_state_t
      integer :: cycle = 0
      real(wp) :: time = 0.0_wp
      real(wp) :: h1 = 0.0_wp, h2 = 0.0_wp, h12 = 0.0_wp   !! step before, after, their mean
      real(wp) :: h_old = 0.0_wp                          !! memory of the growth limit
      integer :: owner_kind = OWNER_NONE, owner = 0        !! who limits h2: index of lead or joint
      logical :: ended = .false.                          !! /DT/NODA/STOP acted
      logical :: sampling = .false.                       !! keep what only samples need
      ! what its defects cost so far (kj_legacy_cost)
      real(wp) :: weighed = 0.0_wp                         !! time of the last look at the spins
      !> (n_body) energy that the spin half a step old brought, largest energy of rotation, and
      !> error of attitude [rad]
      real(wp), allocatable :: spin_gain(:), spin_top(:), spin_angle(:)
      real(wp) :: summed_error = 0.0_wp                    !! of summed rotations [rad]
      integer :: summed_joint = 0                          !! that has it, index among all
      ! nodes and leads
      type(team_t) :: team                                 !! pieces for the threads
      type(trial_t) :: trial                               !! how many are at work
      type(world_t) :: world                               !! x, w, skew axes
      real(wp), allocatable :: d(:, :), v(:, :)            !! (n_node, 3); d where it is read
      real(wp), allocatable :: a(:, :), al(:, :)           !! (n_lead, 3)
      !> (n_lead, 3) from joints and secondaries; they, kn and kr where `kept`
      real(wp), allocatable :: f(:, :), m(:, :)
      real(wp), allocatable :: f_own(:, :), m_own(:, :)    !! (n_lead, 3) loads on the lead itself
      !> (n_lead, 3) of these, what an embedding host applies; not allocated: nothing
      real(wp), allocatable :: f_host(:, :), m_host(:, :)
      real(wp), allocatable :: kn(:), kr(:)                !! (n_lead) time-step stiffness
      real(wp), allocatable :: mass(:), inertia(:)         !! (n_lead) nodal, mass scaling included
      logical, allocatable :: jointed(:)                   !! (n_lead) carries a joint
      !> (n_lead) a spring acts on its main node; (2, n_element) that end of it does
      logical, allocatable :: sprung(:), on_main(:, :)
      !> nodal step of secondary nodes, which feel no stiffness
      real(wp) :: idle_limit = huge(1.0_wp)
      !> of each piece of leads, least m/k or I/k_r
      real(wp), allocatable :: least(:)
      integer, allocatable :: least_at(:)                  !! its lead, 0 = none
      real(wp), allocatable :: fastest(:)                  !! of each piece, largest w**2 of a body
      logical, allocatable :: finite(:)                    !! of each piece, its al is
      logical, allocatable :: placed(:)                    !! of each piece, someone reads its d
      !> of each piece, f, m, kn and kr of its leads are read after the stage that finds them
      logical, allocatable :: kept(:)
      type(crew_t) :: crew                                 !! secondary nodes that move
      ! bodies
      real(wp), allocatable :: p(:, :)                     !! (n_body, 9) principal axes, columns, W
      real(wp), allocatable :: principal(:, :)             !! (n_body, 3)
      real(wp), allocatable :: impulse(:, :), angular_impulse(:, :), rotation_sum(:, :)
      !> (n_bcs, 3) w before the conditions acted
      real(wp), allocatable :: w_before(:, :)
      integer, allocatable :: bcs_of(:)                    !! (n_lead) its conditions, 0 = none
      ! joints and springs
      type(legacy_joint_t), allocatable :: joint(:)        !! one a batch
      real(wp), allocatable :: wrench(:, :)                !! (N_WRENCH, n_element)
      real(wp), allocatable :: part(:, :)                  !! (N_SUM, parts of hubs) their sums
      ! loads
      type(gravity_t), allocatable :: field(:)               !! cards of gravity
      !> of each imposed motion in the last cycle
      real(wp), allocatable :: motion_power(:)
      real(wp), allocatable :: motion_turn(:, :)           !! (n_motion, 3) sum of w h of its lead
      !> of each node of each concentrated load: its abscissa in the last cycle, its turn
      real(wp), allocatable :: load_abscissa(:), load_turn(:)
      real(wp) :: power = 0.0_wp                           !! of concentrated loads, this cycle
      real(wp) :: work = 0.0_wp                            !! external work
      real(wp) :: energy0 = 0.0_wp                         !! energy at the start
   end type legacy_state_t

contains

   !> Nodes whose displacement someone reads
   pure function placed_nodes(model) result(placed)
      type(model_t), intent(in) :: model
      logical :: placed(model%n_node)

      integer :: i

      placed = .false.
      placed(model%th_node) = .true.
      placed(model%motion%lead) = .true.
      do i = 1, size(model%batch)              ! springs that look at the velocities of their nodes
         if (.not. is_spring(model%batch(i))) cycle
         if (any(model%batch(i)%spring%balanced) .or. model%batch(i)%kind == SPRING13) &
            placed([model%batch(i)%node]) = .true.
      end do
      do i = 1, size(model%cload)
         placed(model%cload(i)%node) = .true.
      end do
   end function placed_nodes

   !> Secondary nodes that anyone reads; the others stay where they were
   pure subroutine list_crew(model, kept, crew)
      type(model_t), intent(in) :: model
      logical, intent(in) :: kept(:)          !! (n_node) placed_nodes
      type(crew_t), intent(out) :: crew

      logical :: used(model%n_node)
      integer :: i, b, n, next(model%n_lead)

      used = kept
      do i = 1, model%n_element
         used(model%joint(i)%node) = .true.
      end do
      do i = 1, size(model%skews%needed)
         used(model%skews%node(:, model%skews%needed(i))) = .true.
      end do
      used(:model%n_lead) = .false.
      allocate (crew%first(model%n_lead + 1), source=0)
      do i = model%n_lead + 1, model%n_node
         if (used(i)) crew%first(model%lead(i)) = crew%first(model%lead(i)) + 1
      end do
      n = 0
      do b = 1, model%n_lead
         next(b) = n + 1
         n = n + crew%first(b)
      end do
      crew%first = [next, n + 1]
      allocate (crew%node(n))
      do i = model%n_lead + 1, model%n_node
         if (.not. used(i)) cycle
         crew%node(next(model%lead(i))) = i
         next(model%lead(i)) = next(model%lead(i)) + 1
      end do
      crew%kept = kept(crew%node)
      crew%unread = [(.not. any(crew%kept(crew%first(b):crew%first(b + 1) - 1)), b=1, model%n_lead)]
      allocate (crew%few(model%n_lead), source=.false.)
      crew%few(:model%n_body) = model%n_secondary <= 2
   end subroutine list_crew

   !> Ends of springs that are main nodes
   pure subroutine find_main_ends(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      integer :: b, i, e

      allocate (state%sprung(model%n_lead), state%on_main(2, model%n_element), source=.false.)
      do b = 1, size(model%batch)
         if (.not. is_spring(model%batch(b))) cycle
         do i = 1, model%batch(b)%n
            do e = 1, 2
               if (model%batch(b)%node(i, e) > model%n_body) cycle
               state%on_main(e, model%batch(b)%first + i) = .true.
               state%sprung(model%batch(b)%node(i, e)) = .true.
            end do
         end do
      end do
   end subroutine find_main_ends

   !> Conditions that leave some rotations: their moments are read once more
   pure elemental logical function turns_partly(bcs)
      type(bcs_t), intent(in) :: bcs

      turns_partly = any(bcs%fixed(4:6)) .and. .not. all(bcs%fixed(4:6))
   end function turns_partly

   !> Nodal step of the secondary nodes that have mass or inertia
   pure real(wp) function idle_limit(model) result(h)
      type(model_t), intent(in) :: model

      real(wp) :: least

      h = huge(1.0_wp)
      if (.not. allocated(model%node_mass)) return   ! of joints of a host
      associate (m => model%node_mass(model%n_lead + 1:), &
         inertia => model%node_inertia(model%n_lead + 1:))
         least = min(minval(m, mask=m > 0.0_wp), minval(inertia, mask=inertia > 0.0_wp))
      end associate
      if (least < 1.0_wp) h = model%control%dt_factor*sqrt(2.0_wp*least/EPS20)
   end function idle_limit

   !> State at t = 0, before the first cycle
   subroutine new_legacy_state(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(out) :: state

      logical, allocatable :: placed(:)
      integer :: i

      state%h_old = 1.0e6_wp/1.1_wp
      if (model%control%dt_ini > 0.0_wp) state%h_old = min(state%h_old, model%control%dt_ini/1.1_wp)
      allocate (state%world%x, source=model%x0)
      allocate (state%world%w, source=model%w0)
      allocate (state%world%skew(0:model%skews%n, 9))
      state%world%skew = model%skews%axes
      allocate (state%v, source=model%v0)
      allocate (state%d(model%n_node, 3), source=0.0_wp)
      associate (n => model%n_lead, nb => model%n_body)
         allocate (state%a(n, 3), state%al(n, 3), state%f(n, 3), state%m(n, 3), state%f_own(n, 3), &
            state%m_own(n, 3), source=0.0_wp)
         allocate (state%kn(n), state%kr(n), source=EPS20)
         allocate (state%impulse(nb, 3), state%angular_impulse(nb, 3), state%rotation_sum(nb, 3), &
            source=0.0_wp)
         allocate (state%spin_gain(nb), state%spin_top(nb), state%spin_angle(nb), source=0.0_wp)
         allocate (state%bcs_of(n), source=0)
      end associate
      allocate (state%mass, source=model%mass)
      allocate (state%inertia, source=model%inertia)
      placed = placed_nodes(model)
      call list_crew(model, placed, state%crew)
      call new_team(model%control%threads, model%control%least_share, model%batch%n, &
         model%n_lead, state%team)
      allocate (state%least(size(state%team%lead, 2)), source=huge(1.0_wp))
      allocate (state%least_at(size(state%team%lead, 2)), source=0)
      allocate (state%fastest(size(state%team%lead, 2)), source=0.0_wp)
      allocate (state%finite(size(state%team%lead, 2)), source=.true.)
      allocate (state%kept(size(state%team%lead, 2)))
      state%placed = [(any(placed(state%team%lead(1, i):state%team%lead(2, i))), &
         i=1, size(state%team%lead, 2))]
      allocate (state%field(size(model%gravity)))
      do i = 1, size(model%gravity)
         call new_gravity(model%gravity(i)%node, model%n_lead, state%field(i))
      end do
      allocate (state%p, source=model%axes)
      allocate (state%principal, source=model%principal)
      allocate (state%w_before(size(model%bcs), 3), source=0.0_wp)
      do i = 1, size(model%bcs)
         state%bcs_of(model%bcs(i)%lead) = i
      end do
      allocate (state%jointed(model%n_lead), source=.false.)
      do i = 1, model%n_joint
         state%jointed(model%lead(model%joint(i)%node)) = .true.
      end do
      state%idle_limit = idle_limit(model)
      call find_main_ends(model, state)
      do i = 1, size(state%kept)
         state%kept(i) = model%control%joint_step .and. model%n_spring > 0 .or. &
            any(turns_partly(model%bcs) .and. model%bcs%lead >= state%team%lead(1, i) .and. &
            model%bcs%lead <= state%team%lead(2, i)) .or. &
            any(model%control%below_min == [SCALE_MASS, SCALE_MASS_NEXT])
      end do
      allocate (state%joint(size(model%batch)))
      do i = 1, size(model%batch)
         call new_legacy_joint(model%batch(i), state%joint(i))
      end do
      allocate (state%wrench(N_WRENCH, model%n_element), source=0.0_wp)
      allocate (state%part(N_SUM, model%map%part(size(model%map%part)) - 1), source=0.0_wp)
      allocate (state%motion_power(size(model%motion)), source=0.0_wp)
      allocate (state%motion_turn(size(model%motion), 3), source=0.0_wp)
      allocate (state%load_abscissa(sum([(size(model%cload(i)%node), i=1, size(model%cload))])), &
         source=0.0_wp)
      state%load_turn = state%load_abscissa
   end subroutine new_legacy_state

end module kj_legacy_state
