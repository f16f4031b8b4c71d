!> What a scene shows of itself at a time t. Samples, energies, the status, a host's questions and
!> exporters read this and nothing else; each formulation fills it when one of them is due
!> (kj_legacy_snapshot, kj_consistent_snapshot).
module kj_snapshot
   use kj_kinds, only: wp
   use kj_joint_types, only: NDOF
   use kj_model, only: model_t
   implicit none
   private

   public :: snapshot_t, shown_joints_t, inside_t, balance_t, new_snapshot, show_owner, show_node

   !> Who limits the step
   integer, parameter, public :: OWNER_NONE = 0, OWNER_NODE = 1, OWNER_BODY = 2, OWNER_JOINT = 3

   !> What kj_energy sums up over a scene
   type :: balance_t
      real(wp) :: kinetic_trans = 0.0_wp, kinetic_rot = 0.0_wp
      real(wp) :: internal = 0.0_wp
      real(wp) :: potential = 0.0_wp             !! of constant gravity, 0 at the start
      real(wp) :: momentum(3) = 0.0_wp, angular_momentum(3) = 0.0_wp   !! about the origin
      real(wp) :: mass = 0.0_wp
   end type balance_t

   !> Joints or springs of one batch; J is the joint frame
   type :: shown_joints_t
      real(wp), allocatable :: e(:, :)           !! (n, 9) frame, columns E1 E2 E3, W
      real(wp), allocatable :: q(:, :)           !! (n, 6) displacement and rotation, J
      real(wp), allocatable :: rate(:, :)        !! (n, 6) of q; as old as velocities
      real(wp), allocatable :: f(:, :)           !! (n, 6) force and moment on node 1, J
      real(wp), allocatable :: energy(:)         !! (n) work done on the joint
      !> (n) of this what dampers and friction took; 0 under legacy, which does not tell it apart
      real(wp), allocatable :: dissipated(:)
      real(wp), allocatable :: x(:, :)           !! (n, 3) midway between the two nodes, W
      real(wp), allocatable :: length(:)         !! (n) distance of the two nodes
      real(wp), allocatable :: ortho(:)          !! (n) loss of orthogonality of the frame [rad]
      ! of limited batches only
      real(wp), allocatable :: k_block(:, :)     !! (n, 2) stiffness of blocked dofs at present
      real(wp), allocatable :: stored(:)         !! (n) elastic energy of stops, friction and lock
      real(wp), allocatable :: slip_energy(:)    !! (n) energy that sliding took
      integer, allocatable :: flag(:, :)         !! (n, 6) DOF_ constant
   end type shown_joints_t

   !> What one joint or spring does inside; nobody but a trace asks
   type :: inside_t
      logical :: told_apart = .false.            !! `elastic`, `damping` are known: not in legacy
      !> forces of its laws on node 1, J: springs, stops and lock; dampers; friction
      real(wp), dimension(NDOF) :: elastic = 0.0_wp, damping = 0.0_wp, friction = 0.0_wp
      real(wp) :: force(3) = 0.0_wp              !! on end 1, W; the other end gets the opposite
      real(wp) :: moment(3, 2) = 0.0_wp          !! about the leads of ends 1 and 2, W
      real(wp) :: bound = huge(1.0_wp)           !! step that it allows, unscaled
      logical :: nodal = .false.                 !! nodal rule of its leads, else the safe bound
   end type inside_t

   !> The scene; vectors in W where nothing else is said
   type :: snapshot_t
      integer :: cycle = 0
      real(wp) :: time = 0.0_wp
      real(wp) :: step = 0.0_wp                  !! the coming one
      integer :: owner_kind = OWNER_NONE
      integer :: owner = 0                       !! user id of who limits the step, 0 = nobody
      !> velocities and rates are older than `time` by so much: half a step under legacy
      real(wp) :: lag = 0.0_wp
      logical :: stops_alone = .false.           !! each of combined stops has its own radius
      logical :: counts_losses = .false.         !! elastic energy of joints is what was not lost
      real(wp) :: work = 0.0_wp                  !! external work
      real(wp) :: energy_error = 0.0_wp          !! as a fraction
      type(balance_t) :: balance
      ! leads
      real(wp), allocatable :: mass(:)           !! (n_lead)
      real(wp), allocatable :: inertia(:)        !! (n_lead) of free nodes
      real(wp), allocatable :: x(:, :), v(:, :), w(:, :)     !! (n_lead, 3) w angular velocity
      real(wp), allocatable :: a(:, :), al(:, :)             !! (n_lead, 3) al angular acceleration
      real(wp), allocatable :: f(:, :), m(:, :)              !! (n_lead, 3) of joints and all loads
      ! bodies
      real(wp), allocatable :: principal(:, :)   !! (n_body, 3) inertia
      real(wp), allocatable :: p(:, :)           !! (n_body, 9) principal axes, columns
      !> (n_body, 3) of forces and moments on secondary nodes; sum of angular velocity times step
      real(wp), allocatable :: impulse(:, :), angular_impulse(:, :), rotation_sum(:, :)
      ! nodes of the history, (3, n): the vectors in their skews, but for the place
      real(wp), allocatable :: node_x(:, :), node_d(:, :), node_v(:, :), node_w(:, :)
      real(wp), allocatable :: node_a(:, :), node_al(:, :)
      type(shown_joints_t), allocatable :: joint(:)    !! one a batch
      real(wp) :: loosest = 0.0_wp               !! largest `ortho` of all times shown [rad]
      integer :: loosest_joint = 0               !! index of its joint
   end type snapshot_t

contains

   !> Room for a scene, as it is at its start
   pure subroutine new_snapshot(model, now)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(out) :: now

      integer :: b

      now%mass = model%mass
      now%inertia = model%inertia
      now%principal = model%principal
      now%p = model%axes
      associate (n => model%n_lead, nb => model%n_body, nh => size(model%th_node))
         allocate (now%x(n, 3), now%v(n, 3), now%w(n, 3), now%a(n, 3), now%al(n, 3), now%f(n, 3), &
            now%m(n, 3), now%impulse(nb, 3), now%angular_impulse(nb, 3), now%rotation_sum(nb, 3), &
            now%node_x(3, nh), now%node_d(3, nh), now%node_v(3, nh), now%node_w(3, nh), &
            now%node_a(3, nh), now%node_al(3, nh), source=0.0_wp)
      end associate
      allocate (now%joint(size(model%batch)))
      do b = 1, size(model%batch)
         associate (n => model%batch(b)%n, s => now%joint(b))
            allocate (s%x(n, 3), s%e(n, 9), s%q(n, NDOF), s%rate(n, NDOF), s%f(n, NDOF), &
               s%energy(n), &
               s%dissipated(n), s%length(n), s%ortho(n), source=0.0_wp)
            if (.not. model%batch(b)%limited) cycle
            allocate (s%k_block(n, 2), s%stored(n), s%slip_energy(n), source=0.0_wp)
            allocate (s%flag(n, NDOF), source=0)
         end associate
      end do
   end subroutine new_snapshot

   !> Who limits the step: a joint, or the body or free node with the index of a lead
   pure subroutine show_owner(model, kind, index, now)
      type(model_t), intent(in) :: model
      integer, intent(in) :: kind                !! OWNER_ constant
      integer, intent(in) :: index
      type(snapshot_t), intent(inout) :: now

      now%owner_kind = kind
      now%owner = 0
      select case (kind)
      case (OWNER_JOINT)
         now%owner = model%joint(index)%id
      case (OWNER_BODY, OWNER_NODE)
         now%owner = model%node_id(index)
         if (index <= model%n_body) now%owner = model%body_id(index)
      end select
   end subroutine show_owner

   !> Node k of the history
   pure subroutine show_node(model, k, skew, x, d, v, w, a, al, now)
      type(model_t), intent(in) :: model
      integer, intent(in) :: k
      real(wp), intent(in) :: skew(9)            !! its axes now, columns
      real(wp), dimension(3), intent(in) :: x, d, v, w, a, al
      type(snapshot_t), intent(inout) :: now

      now%node_x(:, k) = in_skew(x)
      now%node_d(:, k) = in_skew(d)
      now%node_v(:, k) = in_skew(v)
      now%node_w(:, k) = in_skew(w)
      now%node_a(:, k) = in_skew(a)
      now%node_al(:, k) = in_skew(al)

   contains

      pure function in_skew(y) result(y_skew)
         real(wp), intent(in) :: y(3)
         real(wp) :: y_skew(3)

         y_skew = y
         if (model%th_node_skew(k) == 0) return
         y_skew = [dot_product(y, skew(1:3)), dot_product(y, skew(4:6)), dot_product(y, skew(7:9))]
      end function in_skew
   end subroutine show_node

end module kj_snapshot
