!> A host with rigid bodies and a leap-frog of its own, which gets its joints from kjoint: the
!> element level. It marches as Radioss does, so that the result can be compared bit for bit with
!> kjoint running the same deck by itself: the model level.
!>
!> usage: rigid_host DECK_0000.rad     (two bodies, the first held, gravity -9.81 on the second)
module host_bodies
   use kjoint, only: wp
   implicit none
   private

   public :: bodies_t, accelerate, move

   !> What the host owns. Body b has its centre in node b; the other nodes ride on a body.
   type :: bodies_t
      integer :: n_body = 0, n = 0               !! bodies, nodes
      integer, allocatable :: carrier(:)         !! (n) body of each node
      real(wp), allocatable :: mass(:), inertia(:, :)   !! (n_body), (3, n_body) principal
      real(wp), allocatable :: axes(:, :)        !! (9, n_body) principal axes, columns
      logical, allocatable :: held(:)            !! (n_body)
      real(wp), allocatable :: x(:, :), v(:, :), w(:, :)   !! (3, n)
      real(wp), allocatable :: a(:, :), al(:, :)           !! (3, n_body) accelerations
      real(wp), allocatable :: f(:, :), m(:, :)            !! (3, n) forces and moments
   end type bodies_t

contains

   !> Accelerations at t from forces at t and angular velocities at t - h1/2
   subroutine accelerate(host, h1, gravity)
      type(bodies_t), intent(inout) :: host
      real(wp), intent(in) :: h1                 !! step that led to t
      real(wp), intent(in) :: gravity(3)         !! on bodies that are not held

      real(wp) :: wl(3), ml(3)
      integer :: b

      do b = 1, host%n_body
         if (host%held(b)) cycle
         associate (p => host%axes(:, b), i => host%inertia(:, b))
            call turn(h1*host%w(:, b), p)
            wl = into(p, host%w(:, b))
            ml = into(p, host%m(:, b))
            ml = [(ml(1) + (i(2) - i(3))*wl(2)*wl(3))/i(1), &
               (ml(2) + (i(3) - i(1))*wl(3)*wl(1))/i(2), &
               (ml(3) + (i(1) - i(2))*wl(1)*wl(2))/i(3)]
            host%al(:, b) = p(1:3)*ml(1) + p(4:6)*ml(2) + p(7:9)*ml(3)
         end associate
         host%a(:, b) = host%f(:, b)/host%mass(b) + gravity
      end do
   end subroutine accelerate

   !> Everything to t + h2
   subroutine move(host, h12, h2)
      type(bodies_t), intent(inout) :: host
      real(wp), intent(in) :: h12, h2            !! mean of the steps before and after t; after

      real(wp) :: t(3), r(3)
      integer :: i, b

      do i = host%n_body + 1, host%n
         b = host%carrier(i)
         r = host%x(:, i) - host%x(:, b)
         associate (v => host%v(:, b) + h12*host%a(:, b), w => host%w(:, b) + h12*host%al(:, b))
            t = cross(w, r)
            host%v(:, i) = v + t + 0.5_wp*h2*cross(w, t)
            host%w(:, i) = w
         end associate
         host%x(:, i) = host%x(:, i) + h2*host%v(:, i)
      end do
      do b = 1, host%n_body
         host%v(:, b) = host%v(:, b) + h12*host%a(:, b)
         host%w(:, b) = host%w(:, b) + h12*host%al(:, b)
         host%x(:, b) = host%x(:, b) + h2*host%v(:, b)
      end do
   end subroutine move

   !> Axes turned by a rotation vector below 1/4 (Rodrigues by series)
   subroutine turn(phi, e)
      real(wp), intent(in) :: phi(3)
      real(wp), intent(inout) :: e(9)

      real(wp) :: a2, s, c, d, x, y, z
      integer :: k

      a2 = phi(1)**2 + phi(2)**2 + phi(3)**2
      s = 1.0_wp - a2/6.0_wp*(1.0_wp - a2/20.0_wp*(1.0_wp - a2/42.0_wp* &
         (1.0_wp - a2/72.0_wp*(1.0_wp - a2/110.0_wp))))
      c = 0.5_wp*(1.0_wp - a2/12.0_wp*(1.0_wp - a2/30.0_wp*(1.0_wp - a2/56.0_wp* &
         (1.0_wp - a2/90.0_wp*(1.0_wp - a2/132.0_wp)))))
      do k = 1, 7, 3
         x = e(k)
         y = e(k + 1)
         z = e(k + 2)
         d = c*(phi(1)*x + phi(2)*y + phi(3)*z)
         e(k) = x - c*a2*x + d*phi(1) + s*(phi(2)*z - phi(3)*y)
         e(k + 1) = y - c*a2*y + d*phi(2) + s*(phi(3)*x - phi(1)*z)
         e(k + 2) = z - c*a2*z + d*phi(3) + s*(phi(1)*y - phi(2)*x)
      end do
   end subroutine turn

   pure function into(e, a) result(b)
      real(wp), intent(in) :: e(9), a(3)
      real(wp) :: b(3)

      b = [e(1)*a(1) + e(2)*a(2) + e(3)*a(3), e(4)*a(1) + e(5)*a(2) + e(6)*a(3), &
         e(7)*a(1) + e(8)*a(2) + e(9)*a(3)]
   end function into

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

end module host_bodies

program rigid_host
   use kjoint, only: wp, error_t, finding_list_t, run_options_t, simulation_t, history_t, OF_BODY, &
      body_state_t, load_simulation, start_simulation, step_simulation, body_state, joint_state, &
      node_position, simulation_bodies, simulation_joints, simulation_history, simulation_status, &
      run_status_t, joint_set_t, joint_result_t, joint_spec_t, new_joint_set, take_joints, &
      add_joint, start_joints, joint_forces, joint_stiffness, joint_result, joint_state_size, &
      save_joints, restore_joints
   use host_bodies, only: bodies_t, accelerate, move
   implicit none

   !> The nodes of the deck that the host has: centres of both bodies, then joint and skew nodes
   integer, parameter :: NODES(8) = [100, 200, 101, 102, 103, 201, 202, 203]
   integer, parameter :: CYCLES = 3000
   real(wp), parameter :: GRAVITY(3) = [0.0_wp, 0.0_wp, -9.81_wp]

   type(simulation_t) :: sim
   type(joint_set_t) :: from_deck, from_code
   type(error_t), allocatable :: error
   integer :: different

   call load()
   call make_sets()
   call march_beside('joints of the deck', from_deck)
   call march_beside('joints from code', from_code)

contains

   !> The model level: kjoint with the deck
   subroutine load()
      type(run_options_t) :: options
      type(finding_list_t) :: findings
      character(len=1000) :: deck

      options%formulation = 'legacy'
      call get_command_argument(1, deck)
      call load_simulation(sim, trim(deck), '', options, findings, error)
      call stop_on(error)
      if (findings%n_error > 0) error stop 'the deck has errors'
      call start_simulation(sim, error)
      call stop_on(error)
   end subroutine load

   !> The element level: the joints of the deck, and the same joint from code
   subroutine make_sets()
      type(joint_spec_t) :: revolute
      type(bodies_t) :: host

      call new_joint_set(from_deck, 'legacy', size(NODES), error)
      call stop_on(error)
      call take_joints(from_deck, sim, NODES, error)
      call stop_on(error)

      call start_host(host)
      call new_joint_set(from_code, 'legacy', size(NODES), error)
      call stop_on(error)
      revolute%id = 900
      revolute%type = 2
      revolute%node = [3, 6]                     ! nodes 101 and 201
      revolute%carrier = [1, 2]                  ! forces go to the centres
      revolute%axis_node = reshape([3, 4, 5, 6, 7, 8], [3, 2])
      revolute%kn = 1.0e6_wp
      revolute%cr = 0.05_wp
      revolute%k(4) = 40.0_wp                    ! about the free axis
      revolute%c(4) = 0.05_wp
      call add_joint(from_code, revolute, error)
      call stop_on(error)
      call start_joints(from_code, host%x, [host%mass, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
         0.0_wp], reshape([host%inertia, spread([0.0_wp, 0.0_wp, 0.0_wp], 2, 6)], [3, 8]), error)
      call stop_on(error)
   end subroutine make_sets

   !> Places, masses and velocities of the deck into the arrays of the host
   subroutine start_host(host)
      type(bodies_t), intent(out) :: host

      type(history_t) :: history
      type(body_state_t) :: body
      integer, allocatable :: ids(:)
      integer :: b, i

      ids = simulation_bodies(sim)
      history = simulation_history(sim)
      host%n_body = size(ids)
      host%n = size(NODES)
      host%carrier = [1, 2, 1, 1, 1, 2, 2, 2]
      host%held = [.true., .false.]
      host%mass = history%entity(OF_BODY)%mass
      host%inertia = history%entity(OF_BODY)%inertia
      host%axes = reshape(history%entity(OF_BODY)%axes, [9, 2])
      allocate (host%x(3, host%n), host%v(3, host%n), host%w(3, host%n), host%f(3, host%n), &
         host%m(3, host%n), host%a(3, 2), host%al(3, 2), source=0.0_wp)
      do i = 1, host%n
         call node_position(sim, NODES(i), host%x(:, i), error)
         call stop_on(error)
      end do
      do b = 1, 2
         call body_state(sim, ids(b), body, error)
         call stop_on(error)
         host%v(:, b) = body%velocity
         host%w(:, b) = body%omega
      end do
   end subroutine start_host

   !> Both levels side by side
   subroutine march_beside(what, set)
      character(len=*), intent(in) :: what
      type(joint_set_t), intent(inout) :: set

      type(bodies_t) :: host
      type(run_status_t) :: status
      real(wp) :: kn(size(NODES)), kr(size(NODES))
      real(wp), allocatable :: state(:)
      real(wp) :: h1, h12, h2, h_old, time
      integer :: cycle

      call start_simulation(sim, error)
      call stop_on(error)
      call start_host(host)
      different = 0
      time = 0.0_wp
      h2 = 0.0_wp
      h_old = 1.0e6_wp/1.1_wp
      allocate (state(joint_state_size(set)))
      do cycle = 1, CYCLES
         h1 = h2
         host%f = 0.0_wp
         host%m = 0.0_wp
         call joint_forces(set, time, h1, host%x, host%v, host%w, host%f, host%m, error)
         call stop_on(error)
         kn = 0.0_wp
         kr = 0.0_wp
         call joint_stiffness(set, kn, kr, error)
         call stop_on(error)
         h2 = min(nodal_step(host, kn, kr), real(1.1, wp)*h_old)
         h_old = h2
         h12 = 0.5_wp*(h1 + h2)
         call accelerate(host, h1, GRAVITY)
         call compare(set, host, time, h2)
         call move(host, h12, h2)
         time = time + h2
         if (modulo(cycle, 1000) == 0) then      ! a restart in between changes nothing
            call save_joints(set, state, error)
            call stop_on(error)
            call restore_joints(set, state, error)
            call stop_on(error)
         end if
         call step_simulation(sim, error)
         call stop_on(error)
      end do
      status = simulation_status(sim)
      print '(2a,i0,a,es13.6,a,i0,a)', what, ': ', CYCLES, ' cycles to t = ', status%time, ', ', &
         different, ' of them differ from the model level'
      if (different > 0) error stop 1
   end subroutine march_beside

   !> The nodal time step of Radioss: 0.9 sqrt(2 m/k)
   real(wp) function nodal_step(host, kn, kr) result(h)
      type(bodies_t), intent(in) :: host
      real(wp), intent(in) :: kn(:), kr(:)

      real(wp) :: ratio
      integer :: b

      ratio = huge(1.0_wp)
      do b = 1, host%n_body
         ratio = min(ratio, host%mass(b)/kn(b), minval(host%inertia(:, b))/kr(b))
      end do
      h = real(0.9, wp)*sqrt(2.0_wp*ratio)
   end function nodal_step

   !> Every bit of positions, accelerations, joint force and step
   subroutine compare(set, host, time, h)
      type(joint_set_t), intent(in) :: set
      type(bodies_t), intent(in) :: host
      real(wp), intent(in) :: time, h

      type(joint_result_t) :: here, there
      type(body_state_t) :: body
      type(run_status_t) :: status
      integer, allocatable :: ids(:)
      logical :: same
      integer :: b

      call joint_result(set, 1, here, error)
      call stop_on(error)
      ids = simulation_joints(sim)
      call joint_state(sim, ids(1), there, error)
      call stop_on(error)
      status = simulation_status(sim)
      same = equal([here%force, here%displacement, here%energy, time, h], &
         [there%force, there%displacement, there%energy, status%time, status%time_step])
      ids = simulation_bodies(sim)
      do b = 1, host%n_body
         call body_state(sim, ids(b), body, error)
         call stop_on(error)
         same = same .and. equal([host%x(:, b), host%v(:, b), host%w(:, b)], [body%position, &
            body%velocity, body%omega])
      end do
      if (.not. same) different = different + 1
   end subroutine compare

   pure logical function equal(a, b)
      real(wp), intent(in) :: a(:), b(:)

      equal = all(.not. abs(a - b) > 0.0_wp)
   end function equal

   subroutine stop_on(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      print '(2a)', 'rigid_host: ', error%message
      error stop 2
   end subroutine stop_on

end program rigid_host
