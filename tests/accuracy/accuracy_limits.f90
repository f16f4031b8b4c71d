!> Stability: the safe step against the step at which disturbed runs really blow up.
module accuracy_limits
   use kjoint, only: wp, run_options_t
   use kj_channels, only: OF_RUN
   use accuracy_check, only: check_t, below, above, holds, say
   use accuracy_deck, only: deck_t, new_deck, add_body, add_joint, add_motion, add_gravity, &
      add_load, write_deck, GLOBAL_AXES
   use accuracy_run, only: run_t, run_deck, series
   implicit none
   private

   public :: check_limit, check_four_bar

   real(wp), parameter :: NONE(6) = 0.0_wp
   real(wp), parameter :: THIN = 1.0e-3_wp       !! inertia of a bar about its axis over that across it

contains

   !> The safe step is 0.9 of the safe bound. Of a benchmark: runs over the whole of it are sound at
   !> that step and at 0.97 of the bound; the step at which a run of its beginning really blows up is not
   !> below the bound (less 1 %: the spin of bodies, which is not in the bound) and at most three times
   !> the safe step. Small loads in all directions on all bodies disturb the runs: a planar scene would
   !> never meet its modes out of the plane.
   subroutine check_limit(check, folder, case)
      type(check_t), intent(inout) :: check
      character(len=*), intent(in) :: folder     !! of the benchmarks
      character(len=*), intent(in) :: case

      real(wp) :: calm, kinetic, h, lo, hi, s, t
      logical :: sound
      integer :: i

      call disturb(folder//'/'//case//'/'//case, case)
      call try(case, 0.5_wp, -1.0_wp, 0.0_wp, calm, h, sound)
      call holds(check, case//': runs at half the bound', sound)
      call try(case, 0.9_wp, -1.0_wp, calm, kinetic, h, sound)
      call holds(check, case//': sound at the safe step, to its end', sound)
      call try(case, 0.97_wp, -1.0_wp, calm, kinetic, h, sound)
      call holds(check, case//': sound at 0.97 of the bound', sound)
      t = 500.0_wp*h
      call try(case, 0.5_wp, t, 0.0_wp, calm, h, sound)
      lo = 0.9_wp
      hi = 4.0_wp
      do i = 1, 9
         s = sqrt(lo*hi)
         call try(case, s, t, calm, kinetic, h, sound)
         if (sound) lo = s
         if (.not. sound) hi = s
      end do
      call above(check, case//': true limit over the bound', lo, 0.99_wp)
      call below(check, case//': true limit over the safe step', hi/0.9_wp, 3.0_wp)
   end subroutine check_limit

   !> One run at a factor of the safe step, without samples in between
   subroutine try(root, factor, until, calm, kinetic, h, sound)
      character(len=*), intent(in) :: root
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: until              !! end of the run, negative: that of the deck
      real(wp), intent(in) :: calm               !! kinetic energy at the end of a sound run, 0 = unknown
      real(wp), intent(out) :: kinetic, h        !! kinetic energy at the end, last step
      logical, intent(out) :: sound

      type(run_options_t) :: options
      type(run_t) :: run
      real(wp), allocatable :: k(:, :)

      options%dt_scale = factor
      options%until = until
      options%sample = 1.0e3_wp
      options%energy_limit = 1.0e30_wp
      call run_deck(root, options, run)
      sound = run%good
      kinetic = huge(1.0_wp)
      h = 0.0_wp
      if (.not. sound) return
      k = series(run, OF_RUN, 'kinetic_energy_trans', 1) + series(run, OF_RUN, 'kinetic_energy_rot', 1)
      kinetic = k(1, size(k, 2))
      h = run%status%time_step
      if (calm > 0.0_wp) sound = kinetic < 3.0_wp*calm
   end subroutine try

   !> Copy a deck with constant loads of 1e-3 N and N m, one in each direction on each body
   subroutine disturb(from, to)
      character(len=*), intent(in) :: from, to   !! roots

      character(len=3), parameter :: DIRS(6) = [character(len=3) :: '  X', '  Y', '  Z', ' XX', ' YY', ' ZZ']
      character(len=200) :: line
      character(len=10) :: node(100)
      integer :: in, out, status, n, i, k

      open (newunit=in, file=from//'_0000.rad', action='read', status='old')
      open (newunit=out, file=to//'_0000.rad', action='write', status='replace')
      n = 0
      do
         read (in, '(a)', iostat=status) line
         if (status /= 0 .or. line == '/END') exit
         write (out, '(a)') trim(line)
         if (index(line, '/RBODY') /= 1) cycle
         read (in, '(a)') line
         write (out, '(a)') trim(line)
         read (in, '(a)') line
         write (out, '(a)') trim(line)
         n = n + 1
         node(n) = line(:10)
      end do
      close (in)
      write (out, '(a)') '/FUNCT/9000', 'one', '                 0.0                 1.0', &
         '              1000.0                 1.0'
      do i = 1, n
         write (out, '(a,i0)') '/GRNOD/NODE/', 9000 + i
         write (out, '(a)') 'group', node(i)
         do k = 1, 6
            write (out, '(a,i0)') '/CLOAD/', 9000 + 10*i + k
            write (out, '(a)') 'disturbance'
            write (out, '(a,a10,2i10,i10,10x,a,f20.4)') '      9000', DIRS(k), 0, 0, 9000 + i, &
               '                 1.0', (-1)**(i/2 + k)*(0.7_wp + 0.1_wp*modulo(3*i + k, 5))*1.0e-3_wp
         end do
      end do
      write (out, '(a)') '/END'
      close (out)
      open (newunit=in, file=from//'_0001.rad', action='read', status='old')
      open (newunit=out, file=to//'_0001.rad', action='write', status='replace')
      do
         read (in, '(a)', iostat=status) line
         if (status /= 0) exit
         write (out, '(a)') trim(line)
      end do
      close (in)
      close (out)
   end subroutine disturb

   !> A four-bar linkage with stiff revolutes and thin, light bars. The legacy scheme with its nodal
   !> rule blows up at the default factor: damping from mean inertias is beyond critical about the axes
   !> of the bars, and acts half a step late. The consistent one runs at the safe step.
   subroutine check_four_bar(check, tenths)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: tenths              !! of a second: how long it runs

      character(len=*), parameter :: ROOT = 'four_bar'
      type(run_options_t) :: options
      type(deck_t) :: deck
      type(run_t) :: run

      call four_bar(deck, 0.1_wp*tenths)
      call write_deck(deck, ROOT)
      call run_deck(ROOT, options, run)
      call holds(check, 'four-bar: sound under the safe rule', run%good)
      if (run%good) call below(check, 'four-bar: ledger', &
         maxval(abs(series(run, OF_RUN, 'energy_error', 1))), 1.0e-4_wp)
      options%formulation = 'legacy'
      options%energy_limit = 15.0_wp
      options%until = 0.05_wp
      options%sample = 1.0e-3_wp
      call run_deck(ROOT, options, run)
      call holds(check, 'four-bar: blows up under legacy, nodal', .not. run%good)
      options%dt_scale = 0.45_wp
      call run_deck(ROOT, options, run)
      call holds(check, 'four-bar: not at half that step', run%good)
   end subroutine check_four_bar

   subroutine four_bar(deck, t_stop)
      type(deck_t), intent(out) :: deck
      real(wp), intent(in) :: t_stop

      real(wp), parameter :: P(3, 4) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.1_wp, 0.25_wp, 0.0_wp, &
         0.5_wp, 0.4_wp, 0.0_wp, 0.6_wp, 0.0_wp, 0.0_wp], [3, 4])
      real(wp) :: axes(3, 3)
      integer :: i

      axes = GLOBAL_AXES(:, [3, 1, 2])           ! x of the joint is z
      call new_deck(deck, t_stop, t_stop/100.0_wp)
      do i = 1, 3
         call add_bar(deck, P(:, i), P(:, i + 1), 0.05_wp)
      end do
      call add_body(deck, P(:, 1), 10.0_wp, [1.0_wp, 1.0_wp, 1.0_wp, NONE(1:3)], .true.)
      do i = 1, 2
         call add_joint(deck, 2, 0, [i, i + 1], P(:, i + 1), P(:, i + 1), axes, axes, 1.0e5_wp, 0.05_wp, NONE, NONE)
      end do
      call add_joint(deck, 2, 0, [4, 1], P(:, 1), P(:, 1), axes, axes, 1.0e5_wp, 0.05_wp, NONE, NONE)
      call add_joint(deck, 2, 0, [3, 4], P(:, 4), P(:, 4), axes, axes, 1.0e5_wp, 0.05_wp, NONE, NONE)
      call add_gravity(deck, 'Y', -9.81_wp, 0)
      do i = 1, 3
         call add_load(deck, i, ' Z', 1.0e-3_wp, 0)
      end do
   end subroutine four_bar

   !> A thin bar from a to b: m l^2/12 across, a hundredth of that along
   subroutine add_bar(deck, a, b, mass)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: a(3), b(3), mass

      real(wp) :: n(3), j(3, 3), across

      n = (b - a)/norm2(b - a)
      across = mass*dot_product(b - a, b - a)/12.0_wp
      j = across*GLOBAL_AXES - (1.0_wp - THIN)*across*spread(n, 2, 3)*spread(n, 1, 3)
      call add_body(deck, 0.5_wp*(a + b), mass, [j(1, 1), j(2, 2), j(3, 3), j(1, 2), j(2, 3), j(1, 3)], .false.)
   end subroutine add_bar

end module accuracy_limits
