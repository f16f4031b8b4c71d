!> The energy ledger, and what floating pairs must keep.
module accuracy_ledger
   use kjoint, only: wp, run_options_t
   use kj_channels, only: OF_RUN, OF_JOINT
   use accuracy_check, only: check_t, below, within, say
   use accuracy_deck, only: deck_t, new_deck, add_body, add_joint, add_motion, add_gravity, write_deck, &
      turn_about
   use accuracy_run, only: run_t, run_deck, series, slope_of
   implicit none
   private

   public :: check_ledger

contains

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

      real(wp), parameter :: SCALES(4) = [0.9_wp, 0.45_wp, 0.225_wp, 0.1125_wp]
      type(run_options_t) :: options
      type(run_t) :: run
      type(deck_t) :: deck
      real(wp) :: error(4)
      integer :: i

      call scene(type, floating, deck)
      call write_deck(deck, name)
      do i = 1, 4
         options%dt_scale = SCALES(i)
         call run_deck(name, options, run)
         error(i) = ledger_error(run)
         print *, name, error(i), run%status%time_step
      end do
   end subroutine fall

   !> Largest change of S over the first kinetic energy
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
   subroutine scene(type, floating, deck)
      integer, intent(in) :: type
      logical, intent(in) :: floating
      type(deck_t), intent(out) :: deck

      real(wp) :: e1(3, 3), e2(3, 3)

      call new_deck(deck, 0.5_wp, 0.002_wp)
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
      call add_joint(deck, type, 1, [1, 2], [0.0_wp, 0.0_wp, 0.0_wp], [0.12_wp, -0.07_wp, 0.09_wp], e1, e2, &
         1.0e6_wp, 0.05_wp, [2000.0_wp, 3000.0_wp, 2500.0_wp, 40.0_wp, 30.0_wp, 50.0_wp], &
         [6.0_wp, 5.0_wp, 4.0_wp, 0.05_wp, 0.08_wp, 0.06_wp])
      if (.not. floating) call add_gravity(deck, 'Z', -9.81_wp, 0)
   end subroutine scene

end module accuracy_ledger
