!> A host of very many joints, built through the element level: what building costs, and a cycle.
!>
!> usage: bench_host FORMULATION JOINTS CYCLES
!>
!> A chain of balls, each with a rod to the next one and a spherical joint there, hangs by its first
!> ball, which is held, and falls. The host owns nodes, masses and time, as docs/embedding.md has
!> it: node k is the centre of ball k, node n + k the tip of its rod. Prints one line of JSON; units
!> kg m s.
program bench_host
   use, intrinsic :: iso_fortran_env, only: int64
   use kjoint, only: wp, error_t, joint_set_t, joint_spec_t, new_joint_set, add_joint, &
      start_joints, joint_forces, critical_step, joint_energy
   implicit none

   real(wp), parameter :: LENGTH = 0.1_wp, MASS = 0.2_wp, INERTIA = 2.0e-4_wp, GRAVITY = -9.81_wp

   type(joint_set_t) :: set
   type(error_t), allocatable :: error
   character(len=20) :: formulation, text
   real(wp), allocatable :: x(:, :), v(:, :), w(:, :), f(:, :), m(:, :), attitude(:, :)
   real(wp) :: h, built, marched, kinetic, potential, work, dissipated
   integer :: n_joint, n_cycle, n, cycle

   call get_command_argument(1, formulation)
   call get_command_argument(2, text)
   read (text, *) n_joint
   call get_command_argument(3, text)
   read (text, *) n_cycle

   n = n_joint + 1
   built = seconds()
   call place_balls()
   call build_joints()
   built = seconds() - built

   h = 0.0_wp
   call joint_forces(set, 0.0_wp, 0.0_wp, x, v, w, f, m, error, attitude)
   call stop_on_error()
   call critical_step(set, h, error)
   call stop_on_error()
   h = 0.5_wp*h
   marched = seconds()
   do cycle = 1, n_cycle
      call move_balls()
      f = 0.0_wp
      m = 0.0_wp
      call joint_forces(set, cycle*h, h, x, v, w, f, m, error, attitude)
      call stop_on_error()
   end do
   marched = seconds() - marched

   ! velocities are half a step behind
   v(:, 2:n) = v(:, 2:n) + 0.5_wp*h*f(:, 2:n)/MASS
   v(3, 2:n) = v(3, 2:n) + 0.5_wp*h*GRAVITY
   w(:, 2:n) = w(:, 2:n) + 0.5_wp*h*m(:, 2:n)/INERTIA
   call joint_energy(set, work, dissipated)
   kinetic = 0.5_wp*(MASS*sum(v(:, 2:n)**2) + INERTIA*sum(w(:, 2:n)**2))
   potential = -MASS*GRAVITY*sum(x(3, 2:n))
   print '(a,i0,5(a,es14.7),a)', '{"joints": ', n_joint, ', "build_s": ', built, &
      ', "ns": ', 1.0e9_wp*marched/(real(n_joint, wp)*max(1, n_cycle)), ', "step": ', h, &
      ', "potential": ', potential, ', "energy_error": ', &
      (kinetic + potential + work)/max(abs(potential), tiny(1.0_wp)), '}'

contains

   subroutine place_balls()
      integer :: k

      allocate (x(3, 2*n), v(3, 2*n), w(3, 2*n), f(3, 2*n), m(3, 2*n), attitude(4, 2*n), &
         source=0.0_wp)
      attitude(1, :) = 1.0_wp
      do k = 1, n
         x(1, k) = (k - 1)*LENGTH
         call place_tip(k)
      end do
   end subroutine place_balls

   subroutine build_joints()
      type(joint_spec_t) :: joint
      real(wp), allocatable :: masses(:), inertias(:, :)
      integer :: k

      call new_joint_set(set, trim(formulation), 2*n, error)
      call stop_on_error()
      joint%type = 1
      joint%kn = 1.0e6_wp
      do k = 1, n_joint
         joint%id = k
         joint%node = [n + k, k + 1]
         joint%carrier(1) = k
         call add_joint(set, joint, error)
         call stop_on_error()
      end do
      allocate (masses(2*n), inertias(3, 2*n), source=0.0_wp)
      masses(2:n) = MASS
      inertias(:, 2:n) = INERTIA
      call start_joints(set, x, masses, inertias, error, attitude)
      call stop_on_error()
   end subroutine build_joints

   !> Leap-frog; equal inertias have no gyroscopic moment
   subroutine move_balls()
      real(wp) :: q(4), turn(3)
      integer :: k

      do k = 2, n
         v(:, k) = v(:, k) + h/MASS*f(:, k)
         v(3, k) = v(3, k) + h*GRAVITY
         w(:, k) = w(:, k) + h/INERTIA*m(:, k)
         x(:, k) = x(:, k) + h*v(:, k)
         turn = 0.5_wp*h*w(:, k)
         q = attitude(:, k)
         attitude(1, k) = q(1) - dot_product(turn, q(2:4))
         attitude(2:4, k) = q(2:4) + q(1)*turn + [turn(2)*q(4) - turn(3)*q(3), &
            turn(3)*q(2) - turn(1)*q(4), turn(1)*q(3) - turn(2)*q(2)]
         attitude(:, k) = attitude(:, k)/norm2(attitude(:, k))
         call place_tip(k)
      end do
   end subroutine move_balls

   !> The rod lies along x of the ball
   subroutine place_tip(k)
      integer, intent(in) :: k

      associate (q => attitude(:, k))
         x(:, n + k) = x(:, k) + LENGTH*[1.0_wp - 2.0_wp*(q(3)**2 + q(4)**2), &
            2.0_wp*(q(2)*q(3) + q(1)*q(4)), 2.0_wp*(q(2)*q(4) - q(1)*q(3))]
      end associate
   end subroutine place_tip

   real(wp) function seconds()
      integer(int64) :: ticks, rate

      call system_clock(ticks, rate)
      seconds = real(ticks, wp)/real(rate, wp)
   end function seconds

   subroutine stop_on_error()
      if (.not. allocated(error)) return
      print '(2a)', 'bench_host: ', error%message
      error stop 2
   end subroutine stop_on_error

end program bench_host
