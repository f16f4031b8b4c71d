!> Extreme numbers in decks: masses, stiffnesses, lengths, places, turns.
module accuracy_extremes
   use kjoint, only: wp, run_options_t
   use kj_channels, only: OF_RUN, OF_JOINT, OF_BODY, OF_NODE
   use accuracy_check, only: check_t, below, within, holds, say
   use accuracy_deck, only: deck_t, new_deck, add_body, add_joint, add_motion, add_curve, &
      ramp_curve, add_gravity, add_load, write_deck, turn_about, GLOBAL_AXES
   use accuracy_run, only: run_t, run_deck, series, times, distance
   implicit none
   private

   public :: check_masses, check_stiffnesses, check_lengths, check_far, check_coincident
   public :: check_opposite, check_turns, check_whole_turn, check_falling, check_weightless, &
      check_loose, check_first_step

   real(wp), parameter :: NONE(6) = 0.0_wp

contains

   !> Run a deck; a failure is a failed claim
   subroutine run_it(check, deck, name, run)
      type(check_t), intent(inout) :: check
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: name
      type(run_t), intent(out) :: run

      type(run_options_t) :: options

      call write_deck(deck, 'extreme')
      call run_deck('extreme', options, run)
      if (run%good) return
      call say('   '//name//': '//run%message)
      call holds(check, name//': runs to its end', .false.)
   end subroutine run_it

   !> Two free bodies on a joint, thrown so that the joint starts with a jump
   subroutine pair(type, mass, length, kn, t_stop, deck, speed)
      integer, intent(in) :: type
      real(wp), intent(in) :: mass(2)            !! kg, inertias are 0.02 length^2 of them
      real(wp), intent(in) :: length             !! m: all lengths and velocities are multiples of it
      real(wp), intent(in) :: kn, t_stop
      type(deck_t), intent(out) :: deck
      real(wp), intent(in), optional :: speed    !! factor on the velocities

      real(wp), parameter :: J(6) = [0.02_wp, 0.03_wp, 0.04_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      real(wp) :: e2(3, 3), s

      s = 1.0_wp
      if (present(speed)) s = speed
      e2 = GLOBAL_AXES
      if (type == 5) e2 = GLOBAL_AXES(:, [2, 3, 1])
      call new_deck(deck, t_stop, 0.01_wp*t_stop)
      call add_body(deck, [0.0_wp, 0.0_wp, 0.0_wp], mass(1), mass(1)*length**2*J, .false.)
      call add_body(deck, length*[0.5_wp, 0.25_wp, 0.0_wp], mass(2), mass(2)*length**2*J, .false.)
      call add_motion(deck, 1, s*length*[0.25_wp, 0.0_wp, 0.5_wp], s*[0.5_wp, -1.0_wp, 0.25_wp])
      call add_motion(deck, 2, s*length*[0.25_wp, -0.25_wp, 0.5_wp], s*[2.0_wp, -1.0_wp, 1.5_wp])
      call add_joint(deck, type, 0, [1, 2], length*[0.125_wp, 0.125_wp, 0.0_wp], length*[0.25_wp, 0.125_wp, 0.0_wp], &
         GLOBAL_AXES, e2, kn, 0.05_wp, NONE, NONE)
   end subroutine pair

   !> Energy error of a run, and the change of momentum over its size
   subroutine conserved(check, name, run, energy, momentum)
      type(check_t), intent(inout) :: check
      character(len=*), intent(in) :: name
      type(run_t), intent(in) :: run
      real(wp), intent(in) :: energy, momentum   !! bounds

      real(wp) :: p(3), p0(3), most, size0
      real(wp), allocatable :: x(:, :), y(:, :), z(:, :), v(:, :)
      integer :: i

      if (.not. run%good) return
      call below(check, name//': ledger', maxval(abs(series(run, OF_RUN, 'energy_error', 1))), energy)
      x = series(run, OF_RUN, 'momentum_x', 1)
      y = series(run, OF_RUN, 'momentum_y', 1)
      z = series(run, OF_RUN, 'momentum_z', 1)
      p0 = [x(1, 1), y(1, 1), z(1, 1)]
      v = series(run, OF_BODY, 'velocity', 1)
      size0 = norm2(p0)
      most = 0.0_wp
      do i = 1, size(x, 2)
         p = [x(1, i), y(1, i), z(1, i)]
         most = max(most, norm2(p - p0))
      end do
      call below(check, name//': momentum', most/size0, momentum)
   end subroutine conserved

   !> Mass ratios 1e-6 to 1e6
   subroutine check_masses(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      character(len=24) :: name
      integer :: i, k
      integer, parameter :: TYPES(4) = [1, 2, 5, 8]

      do k = 1, size(TYPES)
         do i = -6, 6, 3
            write (name, '(a,i0,a,i0)') 'type ', TYPES(k), ', ratio 10^', i
            call pair(TYPES(k), [1.0_wp, 10.0_wp**i], 1.0_wp, 1.0e6_wp, min(0.2_wp, 0.2_wp*sqrt(10.0_wp**i)), deck)
            call run_it(check, deck, trim(name), run)
            call conserved(check, trim(name), run, 1.0e-3_wp, 1.0e-12_wp)
         end do
      end do
   end subroutine check_masses

   !> Blocking stiffness 1e-3 to 1e12 N/m: the ledger of a thrown pair, and the gap of a joint under a
   !> force that grows smoothly over twenty periods of the joint: F/Kn. Where Kn is small the pair is
   !> thrown so slowly that its blocked rotations stay below a tenth of a radian.
   subroutine check_stiffnesses(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      character(len=24) :: name
      real(wp), allocatable :: d(:, :)
      real(wp) :: kn, t, force
      integer :: i

      do i = -3, 12, 3
         kn = 10.0_wp**i
         t = 200.0_wp/sqrt(kn)
         write (name, '(a,i0)') 'Kn 10^', i
         call pair(2, [1.0_wp, 2.0_wp], 1.0_wp, kn, t, deck, speed=min(1.0_wp, 0.01_wp*sqrt(kn)))
         call run_it(check, deck, trim(name), run)
         call conserved(check, trim(name)//', thrown', run, 1.0e-3_wp, 1.0e-12_wp)
         force = min(1.0_wp, 1.0e-3_wp*kn)
         call new_deck(deck, t, 0.02_wp*t)
         call add_body(deck, [0.0_wp, 0.0_wp, 0.0_wp], 5.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
         call add_body(deck, [0.0_wp, 0.0_wp, 0.0_wp], 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .false.)
         call add_joint(deck, 8, 0, [1, 2], [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], GLOBAL_AXES, &
            GLOBAL_AXES, kn, 0.05_wp, NONE, NONE)
         call ramp_curve(deck, 0.6_wp*t, 1.0e-3_wp*t)
         call add_load(deck, 2, ' Y', force, 1)
         call run_it(check, deck, trim(name), run)
         if (.not. run%good) cycle
         d = series(run, OF_JOINT, 'displacement', 1)
         call below(check, trim(name)//': gap over F/Kn, less 1', &
            abs(d(2, size(d, 2))*kn/force - 1.0_wp), 1.0e-5_wp)
      end do
   end subroutine check_stiffnesses

   !> All lengths 1e-6 to 1e6 times as long. A spherical joint at one mass, time and Kn is the same motion
   !> to scale: positions over the scale, rotations as they are (to rounding, which a thousand steps of a
   !> joint that starts with a jump enlarge). Other types have blocked rotations of Kn max(1, L^2), which
   !> do not scale: their ledger must hold.
   subroutine check_lengths(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run, unit
      real(wp), allocatable :: x(:, :), y(:, :)
      character(len=24) :: name
      real(wp) :: scale
      integer :: i

      call pair(1, [1.0_wp, 2.0_wp], 1.0_wp, 1.0e6_wp, 0.2_wp, deck)
      call run_it(check, deck, 'spherical', unit)
      do i = -6, 6, 3
         scale = 10.0_wp**i
         write (name, '(a,i0)') 'length 10^', i
         call pair(1, [1.0_wp, 2.0_wp], scale, 1.0e6_wp, 0.2_wp, deck)
         call run_it(check, deck, trim(name), run)
         call conserved(check, trim(name)//', spherical', run, 1.0e-4_wp, 1.0e-12_wp)
         if (run%good .and. unit%good) then
            x = series(run, OF_BODY, 'position', 2)/scale
            y = series(unit, OF_BODY, 'position', 2)
            call below(check, trim(name)//': position to scale', maxval(abs(x - y)), 1.0e-10_wp)
            x = series(run, OF_JOINT, 'rotation', 1)
            y = series(unit, OF_JOINT, 'rotation', 1)
            call below(check, trim(name)//': rotation', maxval(abs(x - y)), 1.0e-10_wp)
         end if
         call pair(2, [1.0_wp, 2.0_wp], scale, 1.0e6_wp, 0.2_wp*min(1.0_wp, scale), deck)
         call run_it(check, deck, trim(name)//', revolute', run)
         call conserved(check, trim(name)//', revolute', run, 1.0e-4_wp, 1.0e-12_wp)
      end do
   end subroutine check_lengths

   !> A scene 1e6 units from the origin: joints read displacements of the bodies, not positions, so that
   !> nothing is lost as long as the deck can say where things are (here all numbers are exact in
   !> binary; otherwise coordinates of that size carry 1e-10).
   subroutine check_far(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: near, far
      character(len=8) :: name
      integer :: i
      integer, parameter :: TYPES(4) = [1, 3, 5, 8]

      do i = 1, size(TYPES)
         write (name, '(a,i0)') 'type ', TYPES(i)
         call shifted(TYPES(i), [0.0_wp, 0.0_wp, 0.0_wp], deck)
         call run_it(check, deck, trim(name)//' near', near)
         call shifted(TYPES(i), [1.0e6_wp, -1.0e6_wp, 1.0e6_wp], deck)
         call run_it(check, deck, trim(name)//' far', far)
         call below(check, trim(name)//': displacement', distance(near, far, OF_JOINT, 'displacement'), 1.0e-13_wp)
         call below(check, trim(name)//': rotation', distance(near, far, OF_JOINT, 'rotation'), 1.0e-13_wp)
      end do
   contains
      !> Numbers that are exact in binary and in the fields of a card
      subroutine shifted(type, x, scene)
         integer, intent(in) :: type
         real(wp), intent(in) :: x(3)
         type(deck_t), intent(out) :: scene

         real(wp) :: e2(3, 3)

         e2 = GLOBAL_AXES
         if (type == 5) e2 = GLOBAL_AXES(:, [2, 3, 1])
         call new_deck(scene, 0.5_wp, 0.005_wp)
         call add_body(scene, x, 2.0_wp, [0.25_wp, 0.5_wp, 0.375_wp, NONE(1:3)], .true.)
         call add_body(scene, x + [0.5_wp, 0.25_wp, 0.0_wp], 1.0_wp, [0.125_wp, 0.25_wp, 0.1875_wp, NONE(1:3)], &
            .false.)
         call add_joint(scene, type, 0, [1, 2], x, x + [0.125_wp, 0.0_wp, 0.0625_wp], GLOBAL_AXES, e2, &
            1.0e5_wp, 0.05_wp, [500.0_wp, 500.0_wp, 500.0_wp, 10.0_wp, 10.0_wp, 10.0_wp], &
            [2.0_wp, 2.0_wp, 2.0_wp, 0.1_wp, 0.1_wp, 0.1_wp])
         call add_gravity(scene, 'Z', -9.81_wp, 0)
         scene%dt_max = 1.0e-4_wp
      end subroutine shifted
   end subroutine check_far

   !> Joint nodes in one point, both frames alike, both centres of gravity there too
   subroutine check_coincident(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      real(wp) :: e2(3, 3)
      character(len=8) :: name
      integer :: type

      do type = 1, 9
         write (name, '(a,i0)') 'type ', type
         e2 = GLOBAL_AXES
         if (type == 5) e2 = GLOBAL_AXES(:, [2, 3, 1])
         call new_deck(deck, 0.1_wp, 0.001_wp)
         call add_body(deck, NONE(1:3), 1.0_wp, [0.1_wp, 0.2_wp, 0.15_wp, NONE(1:3)], .false.)
         call add_body(deck, NONE(1:3), 2.0_wp, [0.1_wp, 0.1_wp, 0.1_wp, NONE(1:3)], .false.)
         call add_motion(deck, 1, [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 0.5_wp])
         call add_motion(deck, 2, [0.0_wp, 0.0_wp, 1.0_wp], [1.0_wp, -1.0_wp, 2.0_wp])
         call add_joint(deck, type, 0, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, e2, 1.0e5_wp, 0.05_wp, &
            NONE, NONE)
         call run_it(check, deck, name, run)
         call conserved(check, name, run, 1.0e-4_wp, 1.0e-12_wp)
      end do
   end subroutine check_coincident

   !> Frames 180 degrees apart have no mean: KJ-9121, not a NaN; with the first skew as frame there is
   !> nothing to be said against them
   subroutine check_opposite(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      type(run_options_t) :: options
      character(len=24) :: name
      integer :: type, flag

      do type = 1, 9
         if (type == 5) cycle
         do flag = 0, 1
            write (name, '(a,i0,a,i0)') 'type ', type, ', flag ', flag
            call new_deck(deck, 0.01_wp, 0.001_wp)
            call add_body(deck, NONE(1:3), 1.0_wp, [0.1_wp, 0.2_wp, 0.15_wp, NONE(1:3)], .false.)
            call add_body(deck, [0.5_wp, 0.0_wp, 0.0_wp], 2.0_wp, [0.1_wp, 0.1_wp, 0.1_wp, NONE(1:3)], .false.)
            call add_joint(deck, type, flag, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, &
               turn_about([1.0_wp, 2.0_wp, 3.0_wp], acos(-1.0_wp)), 1.0e5_wp, 0.05_wp, NONE, NONE)
            call write_deck(deck, 'opposite')
            call run_deck('opposite', options, run)
            if (flag == 0) call holds(check, trim(name)//': KJ-9121', run%id == 'KJ-9121' .and. .not. run%good)
            if (flag == 1) call holds(check, trim(name)//': runs', run%good)
         end do
      end do
   end subroutine check_opposite

   !> A rotor on a revolute joint at 0.01 to 1 rad a step, up to some thousand turns: it counts them.
   !> Its centre of gravity is on the axis, its principal axes are those of the joint: the angle is w t.
   subroutine check_turns(check)
      type(check_t), intent(inout) :: check

      real(wp), parameter :: H = 1.0e-4_wp, A_STEP(4) = [0.01_wp, 0.1_wp, 0.5_wp, 1.0_wp]
      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: q(:, :), t(:)
      character(len=24) :: name
      integer :: i

      do i = 1, size(A_STEP)
         write (name, '(f4.2,a)') A_STEP(i), ' rad a step'
         call new_deck(deck, 20000*H, 100*H)
         call add_body(deck, NONE(1:3), 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
         call add_body(deck, NONE(1:3), 1.0_wp, [0.1_wp, 0.2_wp, 0.15_wp, NONE(1:3)], .false.)
         call add_motion(deck, 2, NONE(1:3), [A_STEP(i)/H, 0.0_wp, 0.0_wp])
         call add_joint(deck, 2, 0, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, GLOBAL_AXES, 1.0e5_wp, 0.05_wp, &
            NONE, NONE)
         deck%dt_max = H
         call run_it(check, deck, trim(name), run)
         if (.not. run%good) cycle
         q = series(run, OF_JOINT, 'rotation', 1)
         t = times(run)
         call below(check, trim(name)//': angle against w t, over it', maxval(abs(q(1, :) - A_STEP(i)/H*t))/ &
            (A_STEP(i)/H*t(size(t))), 1.0e-11_wp)
         call below(check, trim(name)//': blocked rotations', maxval(abs(q(2:3, :))), 1.0e-11_wp)
      end do
   end subroutine check_turns

   !> Ends on a spherical joint that turn against each other, 10 rad/s for 1 s. The chart of three free
   !> rotations ends at a whole turn. With nothing on the angles that does not matter: the centre of
   !> gravity is in the joint, so the spin stays and no force comes up. With a spring it is an error.
   subroutine check_whole_turn(check)
      type(check_t), intent(inout) :: check

      real(wp), parameter :: SPRING(2) = [0.0_wp, 1.0e-3_wp]
      type(deck_t) :: deck
      type(run_t) :: run
      type(run_options_t) :: options
      real(wp), allocatable :: w(:, :), f(:, :)
      integer :: i

      do i = 1, 2
         call new_deck(deck, 1.0_wp, 0.01_wp)
         call add_body(deck, NONE(1:3), 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
         call add_body(deck, NONE(1:3), 1.0_wp, [0.1_wp, 0.1_wp, 0.1_wp, NONE(1:3)], .false.)
         call add_motion(deck, 2, NONE(1:3), [6.0_wp, 0.0_wp, 8.0_wp])
         call add_joint(deck, 1, 0, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, GLOBAL_AXES, 1.0e5_wp, 0.05_wp, &
            [NONE(1:3), SPRING(i), SPRING(i), SPRING(i)], NONE)
         call write_deck(deck, 'whole')
         call run_deck('whole', options, run)
         if (i == 2) call holds(check, 'whole turn, spring: an error', .not. run%good .and. &
            index(run%message, '(901) has come to a whole turn') > 0)
         if (i == 2) cycle
         call holds(check, 'whole turn: runs', run%good)
         if (.not. run%good) cycle
         w = series(run, OF_BODY, 'angular_velocity', 2)
         f = series(run, OF_JOINT, 'force', 1)
         call below(check, 'whole turn: spin', maxval(abs(w - spread([6.0_wp, 0.0_wp, 8.0_wp], 2, size(w, 2)))), &
            1.0e-12_wp)
         call below(check, 'whole turn: force', maxval(abs(f)), 1.0e-8_wp)
      end do
   end subroutine check_whole_turn

   !> From rest on a falling curve, f(q) = -k q up to 0.5 m, under a force F: q'' = (k q + F)/m, so
   !> q = F/k (cosh(sqrt(k/m) t) - 1). F = 1 N, k = 100 N/m, m = 4 kg: 0.5 m at
   !> t = acosh(51)/5 = 0.925 s; the run ends at 0.9 s, q = 0.01 (cosh(4.5) - 1) = 0.44 m.
   subroutine check_falling(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: q(:, :), t(:)

      call new_deck(deck, 0.9_wp, 0.009_wp)
      call add_body(deck, NONE(1:3), 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
      call add_body(deck, NONE(1:3), 4.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .false.)
      call add_curve(deck, [-1.0_wp, -0.5_wp, 0.5_wp, 1.0_wp], [-1.0e3_wp, 50.0_wp, -50.0_wp, 1.0e3_wp])
      call add_curve(deck, [0.0_wp, 1.0_wp], [1.0_wp, 1.0_wp])
      call add_joint(deck, 6, 0, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, GLOBAL_AXES, 1.0e6_wp, 0.05_wp, &
         [1.0_wp, NONE(2:6)], NONE, curve=1)
      call add_load(deck, 2, ' X', 1.0_wp, 2)
      call run_it(check, deck, 'falling curve', run)
      if (.not. run%good) return
      q = series(run, OF_JOINT, 'displacement', 1)
      t = times(run)
      call below(check, 'falling curve: way', maxval(abs(q(1, :) - 0.01_wp*(cosh(5.0_wp*t) - 1.0_wp))), 1.0e-5_wp)
      call below(check, 'falling curve: ledger', maxval(abs(series(run, OF_RUN, 'energy_error', 1))), 1.0e-4_wp)
   end subroutine check_falling

   !> No gravity: a pair in uniform motion stays in it
   subroutine check_weightless(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: x(:, :), t(:), f(:, :)
      character(len=8) :: name
      integer :: type

      do type = 1, 9
         write (name, '(a,i0)') 'type ', type
         call pair(type, [1.0_wp, 2.0_wp], 1.0_wp, 1.0e6_wp, 1.0_wp, deck)
         call add_motion(deck, 1, [0.5_wp, -0.25_wp, 2.0_wp], NONE(1:3))
         call add_motion(deck, 2, [0.5_wp, -0.25_wp, 2.0_wp], NONE(1:3))
         call run_it(check, deck, name, run)
         if (.not. run%good) cycle
         t = times(run)
         x = series(run, OF_BODY, 'position', 1)
         f = series(run, OF_JOINT, 'force', 1)
         call below(check, name//': position', maxval(abs(x(3, :) - 2.0_wp*t)), 1.0e-12_wp)
         call below(check, name//': force', maxval(abs(f)), 1.0e-8_wp)
      end do
   end subroutine check_weightless

   !> The second skew of a joint has its third node on a body at rest, while its own body turns by 1 rad/s:
   !> after 0.01 s the skew is off by 0.01 rad, in the channel and as a warning; with all nodes on the
   !> body of the joint there is nothing to warn of
   subroutine check_loose(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: o(:, :)
      integer :: owner

      do owner = 2, 3
         call new_deck(deck, 0.01_wp, 0.001_wp)
         call add_body(deck, NONE(1:3), 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
         call add_body(deck, NONE(1:3), 1.0_wp, [0.1_wp, 0.2_wp, 0.15_wp, NONE(1:3)], .false.)
         call add_body(deck, NONE(1:3), 1.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .false.)
         call add_motion(deck, 2, NONE(1:3), [1.0_wp, 0.0_wp, 0.0_wp])
         call add_joint(deck, 2, 0, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, GLOBAL_AXES, 1.0e5_wp, 0.05_wp, &
            NONE, NONE, loose=owner)
         call run_it(check, deck, 'loose', run)
         if (.not. run%good) cycle
         o = series(run, OF_JOINT, 'orthogonality', 1)
         call within(check, 'loose: orthogonality', o(1, size(o, 2)), merge(0.01_wp, 0.0_wp, owner == 3), 1.0e-9_wp)
         if (owner == 2) call holds(check, 'loose: no warning', run%status%warnings%n == 0)
         if (owner == 3) call holds(check, 'loose: KJ-9216', run%status%warnings%n == 1)
         if (owner == 3 .and. run%status%warnings%n == 1) call holds(check, 'loose: names the joint', &
            run%status%warnings%item(1)%id == 'KJ-9216' .and. &
            index(run%status%warnings%item(1)%message, '(901) ') > 0)
      end do
   end subroutine check_loose

   !> /DTIX 1e-5 1e-4 and samples of 1 ms: a first step of 1e-5, then 0.99 ms in ten steps, and ten steps a
   !> sample from then on: 101 cycles to 10 ms
   subroutine check_first_step(check)
      type(check_t), intent(inout) :: check

      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: h(:, :)

      call new_deck(deck, 0.01_wp, 0.001_wp)
      call add_body(deck, NONE(1:3), 1.0_wp, [1.0_wp, 2.0_wp, 3.0_wp, NONE(1:3)], .false.)
      deck%dt_ini = 1.0e-5_wp
      deck%dt_max = 1.0e-4_wp
      call run_it(check, deck, 'first step', run)
      if (.not. run%good) return
      h = series(run, OF_RUN, 'time_step', 1)
      call within(check, 'first step', h(1, 1), 1.0e-5_wp, 1.0e-12_wp)
      call within(check, 'steps of the first sample', h(1, 2), 9.9e-5_wp, 1.0e-12_wp)
      call within(check, 'cycles', real(run%status%cycle, wp), 101.0_wp, 0.1_wp)
   end subroutine check_first_step

end module accuracy_extremes
