!> Free rigid bodies and the heavy top: the numbers of the integrators.
module accuracy_bodies
   use kjoint, only: wp, run_options_t
   use kj_channels, only: OF_BODY
   use accuracy_check, only: check_t, below, holds, say
   use accuracy_deck, only: deck_t, new_deck, add_body, add_joint, add_motion, add_gravity, &
      write_deck, GLOBAL_AXES
   use accuracy_run, only: run_t, run_deck, series, times
   implicit none
   private

   public :: check_free, check_top

   real(wp), parameter :: NONE(6) = 0.0_wp
   integer, parameter :: N_DIRECTION = 27

contains

   !> Largest relative energy error of free bodies in 27 directions of the spin at 0.1, 0.5 and 1 rad
   !> a step, and no trend in it
   subroutine check_free(check, steps)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: steps               !! thousands; 20 is what the bounds were measured with

      real(wp), parameter :: UNEQUAL(3) = [1.0_wp, 2.0_wp, 3.0_wp], FLAT(3) = [1.0_wp, 1.0_wp, 2.0_wp], &
         LONG(3) = [2.0_wp, 2.0_wp, 1.0_wp]

      call spin(check, steps, 'split2', 'three unequal', UNEQUAL, [1.3e-4_wp, 3.0e-3_wp, 1.3e-2_wp])
      call spin(check, steps, 'split2', 'equal, flat', FLAT, [1.0e-12_wp, 1.0e-12_wp, 1.0e-12_wp])
      call spin(check, steps, 'split2', 'equal, long', LONG, [1.0e-12_wp, 1.0e-12_wp, 1.0e-12_wp])
      call spin(check, steps, 'liemid', 'equal, flat', FLAT, [1.0e-13_wp, 1.0e-13_wp, 1.0e-12_wp])
      call spin(check, steps, 'liemid', 'three unequal', UNEQUAL, [3.0e-4_wp, 8.0e-3_wp, 3.0e-2_wp])
   end subroutine check_free

   subroutine spin(check, steps, integrator, name, inertia, bound)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: steps
      character(len=*), intent(in) :: integrator, name
      real(wp), intent(in) :: inertia(3), bound(3)

      real(wp), parameter :: H = 0.01_wp, A_STEP(3) = [0.1_wp, 0.5_wp, 1.0_wp]
      type(run_options_t) :: options
      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: e(:, :)
      real(wp) :: n(3), most, trend
      character(len=50) :: what
      integer :: i, k, m

      options%integrator = integrator
      do i = 1, 3
         call new_deck(deck, 1000*steps*H, steps*H)
         deck%dt_max = H
         do k = 1, N_DIRECTION
            call add_body(deck, [real(k, wp), 0.0_wp, 0.0_wp], 1.0_wp, [inertia, NONE(1:3)], .false.)
            n = direction(k)
            call add_motion(deck, k, NONE(1:3), A_STEP(i)/H*n)
         end do
         call write_deck(deck, 'free')
         call run_deck('free', options, run)
         if (.not. run%good) call say('the run failed: '//run%message)
         most = 0.0_wp
         trend = 0.0_wp
         do k = 1, merge(N_DIRECTION, 0, run%good)
            e = series(run, OF_BODY, 'kinetic_energy', k)
            m = size(e, 2)/10
            most = max(most, maxval(abs(e/e(1, 1) - 1.0_wp)))
            trend = max(trend, abs(sum(e(1, 1:m)) - sum(e(1, size(e, 2) - m + 1:)))/(m*e(1, 1)))
         end do
         write (what, '(5a,f3.1)') integrator, ', ', name, ', ', 'w h = ', A_STEP(i)
         call holds(check, trim(what)//': runs', run%good)
         call below(check, trim(what)//': energy', most, bound(i))
         call below(check, trim(what)//': trend', trend, max(0.3_wp*bound(i), 1.0e-13_wp))
      end do
   end subroutine spin

   !> Unit vectors: to corners, edges and faces of a cube, and (1, 2, 3)
   pure function direction(k) result(n)
      integer, intent(in) :: k
      real(wp) :: n(3)

      integer :: j

      j = k - 1
      n = [modulo(j, 3), modulo(j/3, 3), modulo(j/9, 3)] - 1.0_wp
      if (maxval(abs(n)) <= 0.0_wp) n = [1.0_wp, 2.0_wp, 3.0_wp]
      n = n/norm2(n)
   end function direction

   !> The heavy top of Geradin and Cardona on a spherical joint, 0.2 s at half the critical step: the
   !> position is wrong by about 1e3/Kn, the gap of the joint (legacy at 1e9: 2.2e-4 m).
   !> Reference: that of the benchmark HTOP01, exact to 1e-11.
   subroutine check_top(check, folder)
      type(check_t), intent(inout) :: check
      character(len=*), intent(in) :: folder     !! of HTOP01

      type(run_options_t) :: options
      type(deck_t) :: deck
      type(run_t) :: run
      real(wp), allocatable :: x(:, :)
      real(wp) :: reference(3, 101)
      character(len=20) :: name
      integer :: i

      call read_reference(folder//'/reference.csv', reference)
      options%dt_scale = 0.5_wp
      do i = 7, 9
         call new_deck(deck, 0.2_wp, 0.002_wp)
         call add_body(deck, NONE(1:3), 10.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
         call add_body(deck, [0.0_wp, 1.0_wp, 0.0_wp], 15.0_wp, &
            [0.234375_wp, 0.46875_wp, 0.234375_wp, NONE(1:3)], .false.)
         call add_motion(deck, 2, [4.61538_wp, 0.0_wp, 0.0_wp], [0.0_wp, 150.0_wp, -4.61538_wp])
         call add_joint(deck, 1, 0, [1, 2], NONE(1:3), NONE(1:3), GLOBAL_AXES, GLOBAL_AXES, 10.0_wp**i, &
            0.05_wp, NONE, NONE)
         call add_gravity(deck, 'Z', -9.81_wp, 0)
         call write_deck(deck, 'top')
         call run_deck('top', options, run)
         write (name, '(a,i0)') 'top, Kn 10^', i
         call holds(check, trim(name)//': runs', run%good)
         if (.not. run%good) cycle
         x = series(run, OF_BODY, 'position', 2)
         call below(check, trim(name)//': position', maxval(abs(x - reference)), 1.5e3_wp/10.0_wp**i)
      end do
   end subroutine check_top

   !> Positions of node 200, columns 2 to 4, at 0, 0.002, ... 0.2 s
   subroutine read_reference(path, x)
      character(len=*), intent(in) :: path
      real(wp), intent(out) :: x(:, :)

      real(wp) :: t
      integer :: unit, i

      open (newunit=unit, file=path, action='read', status='old')
      read (unit, *)
      do i = 1, size(x, 2)
         read (unit, *) t, x(:, i)
      end do
      close (unit)
      if (abs(t - 0.2_wp) > 1.0e-9_wp) x = huge(1.0_wp)
   end subroutine read_reference

end module accuracy_bodies
