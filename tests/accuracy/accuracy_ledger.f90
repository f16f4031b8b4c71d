!> The energy ledger, what floating pairs must keep, and a million cycles.
module accuracy_ledger
   use kjoint, only: wp, run_options_t
   use kj_channels, only: OF_RUN, OF_JOINT, OF_BODY
   use accuracy_check, only: check_t, below, within, holds, say
   use accuracy_deck, only: deck_t, new_deck, add_body, add_joint, add_motion, add_gravity, &
      write_deck, turn_about
   use accuracy_run, only: run_t, run_deck, series, slope_of
   implicit none
   private

   public :: check_ledger, check_momentum, check_cycles

contains

   !> S of the ledger stays within 1e-4 of the first kinetic energy at the default step, and its error
   !> falls as h^2. The decks are those on which the legacy scheme gains up to 558 %.
   subroutine check_ledger(check)
      type(check_t), intent(inout) :: check

      call fall(check, 'CYL05-like', 3, .false.)
      call fall(check, 'REV05-like', 2, .false.)
      call fall(check, 'SPH05-like', 1, .false.)
      call fall(check, 'UNI03-like', 5, .false.)
      call fall(check, 'UNI04-like', 5, .true.)
   end subroutine check_ledger

   subroutine fall(check, name, type, floating)
      type(check_t), intent(inout) :: check
      character(len=*), intent(in) :: name
      integer, intent(in) :: type
      logical, intent(in) :: floating

      real(wp), parameter :: PARTS(4) = [1.0_wp, 0.5_wp, 0.25_wp, 0.125_wp]
      type(run_options_t) :: options
      type(run_t) :: run
      type(deck_t) :: deck
      real(wp) :: error(4), h(4)
      integer :: i

      call scene(type, 1, floating, 0.05_wp, 0.5_wp, deck)
      call write_deck(deck, name)
      do i = 1, 4
         if (i > 1) options%dt_scale = 0.9_wp*PARTS(i)
         call run_deck(name, options, run)
         error(i) = ledger_error(run)
         h(i) = run%status%time_step
      end do
      call below(check, name//': S at the default step', error(1), 1.0e-4_wp)
      call within(check, name//': order of S', slope_of(h, error), 2.0_wp, 0.25_wp)
   end subroutine fall

   !> Largest change of S over the first kinetic energy. The channel energy_error is the change over
   !> the largest kinetic + elastic + |external work| so far.
   real(wp) function ledger_error(run) result(most)
      type(run_t), intent(in) :: run

      real(wp), allocatable :: k(:, :), e(:, :), w(:, :), d(:, :)
      real(wp) :: scale
      integer :: i

      most = huge(1.0_wp)
      if (.not. run%good) return
      k = series(run, OF_RUN, 'kinetic_energy_trans', 1) + series(run, OF_RUN, 'kinetic_energy_rot', 1)
      w = series(run, OF_RUN, 'external_work', 1)
      e = series(run, OF_JOINT, 'elastic_energy', 1)
      d = series(run, OF_RUN, 'energy_error', 1)
      scale = 0.0_wp
      most = 0.0_wp
      do i = 1, size(k, 2)
         scale = max(scale, k(1, i) + e(1, i) + abs(w(1, i)))
         most = max(most, abs(d(1, i))*scale/k(1, 1))
      end do
   end function ledger_error

   !> Body 2 thrown, on a joint with a length (0.17 m) and frames 12 degrees apart, on a held body under
   !> gravity, or on a free body without
   subroutine scene(type, flag, floating, cr, t_stop, deck)
      integer, intent(in) :: type, flag
      logical, intent(in) :: floating
      real(wp), intent(in) :: cr                 !! damping of blocked directions; free ones: cr/0.05 of theirs
      real(wp), intent(in) :: t_stop
      type(deck_t), intent(out) :: deck

      real(wp) :: e1(3, 3), e2(3, 3)

      call new_deck(deck, t_stop, 0.004_wp*t_stop)
      call add_body(deck, [0.0_wp, 0.0_wp, 0.0_wp], 5.0_wp, &
         [0.3_wp, 0.2_wp, 0.25_wp, 0.0_wp, 0.0_wp, 0.0_wp], .not. floating)
      call add_body(deck, [0.35_wp, 0.1_wp, -0.05_wp], 2.0_wp, &
         [0.02625_wp, 0.04734_wp, 0.05641_wp, -0.00799_wp, 0.00313_wp, 0.01097_wp], .false.)
      call add_motion(deck, 2, [0.3_wp, -0.2_wp, 0.4_wp], [2.0_wp, -1.0_wp, 1.5_wp])
      if (floating) call add_motion(deck, 1, [0.0_wp, 0.1_wp, -0.2_wp], [0.5_wp, 1.0_wp, -0.3_wp])
      e1 = turn_about([1.0_wp, 2.0_wp, -1.0_wp], 0.7_wp)
      e2 = matmul(turn_about([2.0_wp, -1.0_wp, 1.0_wp], 0.21_wp), e1)
      if (type == 5) e2 = matmul(e1, reshape([0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, &
         0.0_wp, 0.0_wp, 1.0_wp], [3, 3]))
      call add_joint(deck, type, flag, [1, 2], [0.0_wp, 0.0_wp, 0.0_wp], [0.12_wp, -0.07_wp, 0.09_wp], e1, e2, &
         1.0e6_wp, cr, [2000.0_wp, 3000.0_wp, 2500.0_wp, 40.0_wp, 30.0_wp, 50.0_wp], &
         cr/0.05_wp*[6.0_wp, 5.0_wp, 4.0_wp, 0.05_wp, 0.08_wp, 0.06_wp])
      if (.not. floating) call add_gravity(deck, 'Z', -9.81_wp, 0)
   end subroutine scene

   !> Two free bodies on one joint keep momentum and angular momentum to 1e-13 over 2 s, whatever its type
   subroutine check_momentum(check)
      type(check_t), intent(inout) :: check

      type(run_options_t) :: options
      type(run_t) :: run
      type(deck_t) :: deck
      character(len=20) :: name
      integer :: type, flag

      do type = 1, 9
         do flag = 0, 1
            call scene(type, flag, .true., 0.05_wp, 2.0_wp, deck)
            call write_deck(deck, 'floating')
            call run_deck('floating', options, run)
            if (.not. run%good) call say('the run failed: '//run%message)
            write (name, '(a,i0,a,i0)') 'type ', type, ', flag ', flag
            call below(check, trim(name)//': momentum', drift_of(run, 'momentum_'), 1.0e-13_wp)
            call below(check, trim(name)//': angular momentum', drift_of(run, 'angular_momentum_'), 1.0e-13_wp)
         end do
      end do
   end subroutine check_momentum

   !> Largest change of a vector of the run that stands in three channels, over its first size
   real(wp) function drift_of(run, name) result(most)
      type(run_t), intent(in) :: run
      character(len=*), intent(in) :: name

      real(wp), allocatable :: x(:, :), y(:, :), z(:, :)
      integer :: i

      most = huge(1.0_wp)
      if (.not. run%good) return
      x = series(run, OF_RUN, name//'x', 1)
      y = series(run, OF_RUN, name//'y', 1)
      z = series(run, OF_RUN, name//'z', 1)
      most = 0.0_wp
      do i = 1, size(x, 2)
         most = max(most, norm2([x(1, i) - x(1, 1), y(1, i) - y(1, 1), z(1, i) - z(1, 1)]))
      end do
      most = most/norm2([x(1, 1), y(1, 1), z(1, 1)])
   end function drift_of

   !> Floating pairs almost without damping for many cycles: kinetic + elastic energy has no trend, S
   !> stays, angular momentum drifts by rounding only, quaternions keep their length.
   !>
   !> The mean energy over the first and over the last tenth of the samples may differ by 1e-3 of the
   !> kinetic energy: the energy itself swings by (omega h)^2/4 of that of the ringing joint, some per
   !> cent of the whole, and 250 samples do not average that away to better.
   subroutine check_cycles(check, cycles)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: cycles              !! thousands

      integer, parameter :: TYPES(4) = [3, 5, 1, 9]
      real(wp), parameter :: STEP = 1.0e-4_wp    !! about a third of the limit, 1e-3 where all is soft
      type(run_options_t) :: options
      type(run_t) :: run
      type(deck_t) :: deck
      real(wp), allocatable :: energy(:, :), q(:, :)
      character(len=6) :: name
      integer :: i, m

      do i = 1, size(TYPES)
         write (name, '(a,i0)') 'type ', TYPES(i)
         call scene(TYPES(i), 1, .true., 1.0e-12_wp, 1.0_wp, deck)
         deck%dt_max = STEP
         deck%t_stop = 1000.0_wp*cycles*STEP
         deck%sample = deck%t_stop/2500.0_wp
         call write_deck(deck, 'cycles')
         call run_deck('cycles', options, run)
         if (.not. run%good) call say('the run failed: '//run%message)
         if (.not. run%good) cycle
         energy = series(run, OF_RUN, 'kinetic_energy_trans', 1) + series(run, OF_RUN, 'kinetic_energy_rot', 1) &
            + series(run, OF_JOINT, 'elastic_energy', 1)
         m = size(energy, 2)/10
         call below(check, name//': trend of the energy', abs(sum(energy(1, :m)) - &
            sum(energy(1, size(energy, 2) - m + 1:)))/m/energy(1, 1), 1.0e-3_wp)
         call below(check, name//': S', ledger_error(run), 1.0e-3_wp)
         call below(check, name//': momentum', drift_of(run, 'momentum_'), 1.0e-11_wp)
         call below(check, name//': angular momentum', drift_of(run, 'angular_momentum_'), 1.0e-11_wp)
         q = series(run, OF_BODY, 'orientation', 2)
         call below(check, name//': length of the quaternion', &
            maxval(abs(sqrt(sum(q**2, dim=1)) - 1.0_wp)), 1.0e-14_wp)
         call holds(check, name//': all cycles done', run%status%cycle >= 1000*cycles)
      end do
   end subroutine check_cycles

end module accuracy_ledger
