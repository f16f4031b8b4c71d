!> The settings of a study with what came of them: orders, the cheapest for a wanted error, and the
!> stiffness that should do.
module kj_study_table
   use kj_text, only: text_t
   use kj_kinds, only: wp
   use kj_study_metric, only: N_CLASS
   use kjoint, only: run_options_t
   implicit none
   private

   public :: study_t, trial_t, find_orders, order_of, best_trial, foretell

   !> One run and what came of it
   type :: trial_t
      type(run_options_t) :: options             !! formulation, integrator, dt_scale, kn_scale
      logical :: good = .false.
      character(len=:), allocatable :: message   !! why it is not good
      integer :: cycles = 0
      real(wp) :: step = 0.0_wp                  !! mean time step
      logical :: by_deck = .false.               !! /DTIX limits it, not the joints
      real(wp) :: time = 0.0_wp                  !! [s] of a processor that the run took
      real(wp) :: per_cycle = 0.0_wp             !! [s] a joint (else a body) and cycle
      !> by CLASSES of kj_study_metric: displacement and rotation against ideal joints, the others
      !> against the finest steps at this Kn
      real(wp) :: error(N_CLASS) = 0.0_wp
      real(wp) :: score = 0.0_wp                 !! larger error in displacement and rotation
      real(wp) :: by_step = 0.0_wp               !! the same against the finest steps at this Kn
      real(wp) :: by_joints = 0.0_wp             !! of the finest steps at this Kn
      real(wp) :: energy = 0.0_wp                !! largest |energy error|, a fraction
      real(wp) :: gap = 0.0_wp, gap_rot = 0.0_wp !! largest violation
      character(len=:), allocatable :: gap_title !! "pin C (903)", where that was
      real(wp) :: order = 0.0_wp                 !! from the step before it in its family, 0 = none
   end type trial_t

   !> A study
   type :: study_t
      character(len=:), allocatable :: title
      type(text_t), allocatable :: input(:)      !! paths of the decks
      type(trial_t) :: reference
      type(trial_t), allocatable :: trial(:)     !! families together, long steps first
      integer :: n_joint = 0, n_body = 0
      real(wp) :: reach = 0.0_wp                 !! of moving bodies, length
      real(wp) :: floor = 0.0_wp                 !! scores below it may be errors of the reference
      logical :: extrapolated = .false.          !! ideal joints are known, from runs at stiffer Kn
      real(wp) :: compliance = 0.0_wp            !! error of the joints at Kn
      real(wp) :: doubt = 0.0_wp                 !! between Kn, 4 Kn and 4 Kn, 16 Kn: error of truth
   end type study_t

   real(wp), parameter, public :: FINER = 0.25_wp        !! step of the reference over the shortest
   real(wp), parameter :: SURE = 4.0_wp          !! floor of orders, over the error of the reference
   real(wp), parameter :: NOISE = 1.25_wp        !! of times
   real(wp), parameter :: SAFELY = 0.8_wp        !! of the wanted error, where a setting is foretold

contains

   !> Observed orders: of each trial against the longer step before it, unless it is as near to the
   !> reference as that is to the truth.
   !>
   !> The reference has the scheme of the first family and a step FINER times as long as its
   !> shortest. With second order the last of the family is 1/FINER^2 - 1 errors of the reference
   !> away from it; and if the last two do not fit second order, the reference is to blame: it has
   !> its rounding, too.
   pure subroutine find_orders(study)
      type(study_t), intent(inout) :: study

      real(wp) :: last, before, ratio
      integer :: i

      study%floor = 0.0_wp
      before = 0.0_wp
      last = 0.0_wp
      ratio = 0.0_wp
      do i = 1, size(study%trial)
         if (.not. (same_family(study%trial(1), study%trial(i)) .and. study%trial(i)%good)) cycle
         if (i > 1) ratio = (study%trial(i - 1)%step/study%trial(i)%step)**2
         before = last
         last = study%trial(i)%by_step
      end do
      study%floor = last/(FINER**(-2) - 1.0_wp)
      if (before > 0.0_wp .and. ratio > 1.1_wp) study%floor = max(study%floor, &
         abs(ratio*last - before)/(ratio - 1.0_wp))
      study%floor = SURE*study%floor
      do i = 2, size(study%trial)
         associate (a => study%trial(i - 1), b => study%trial(i))
            if (.not. (same_family(a, b) .and. a%good .and. b%good)) cycle
            if (.not. (b%step < 0.99_wp*a%step .and. min(a%by_step, b%by_step) > &
               study%floor)) cycle
            b%order = log(a%by_step/b%by_step)/log(a%step/b%step)
         end associate
      end do
   end subroutine find_orders

   pure logical function same_family(a, b) result(same)
      type(trial_t), intent(in) :: a, b

      same = a%options%integrator == b%options%integrator .and. &
         abs(a%options%kn_scale - b%options%kn_scale) <= 0.0_wp
   end function same_family

   !> Order of an integrator: slope of the error over the step in a fit over its trials at Kn x 1;
   !> 0 when fewer than three are good and above the floor
   pure real(wp) function order_of(study, integrator) result(order)
      type(study_t), intent(in) :: study
      character(len=*), intent(in) :: integrator

      real(wp), allocatable :: x(:), y(:)
      logical :: mine(size(study%trial))
      integer :: i

      order = 0.0_wp
      do i = 1, size(study%trial)
         associate (t => study%trial(i))
            mine(i) = t%options%integrator == integrator .and. t%good .and. &
               t%by_step > study%floor .and. abs(t%options%kn_scale - 1.0_wp) <= 0.0_wp
         end associate
      end do
      if (count(mine) < 3) return
      x = log(pack(study%trial%step, mine))
      y = log(pack(study%trial%by_step, mine))
      x = x - sum(x)/size(x)
      y = y - sum(y)/size(y)
      if (sum(x*x) > 0.0_wp) order = sum(x*y)/sum(x*x)
   end function order_of

   !> The cheapest trial whose error in positions, rotations and energy is at most `wanted`; of
   !> those that cost the same but for the noise of clocks the first. 0 when there is none.
   pure integer function best_trial(study, wanted) result(best)
      type(study_t), intent(in) :: study
      real(wp), intent(in) :: wanted

      logical :: fit(size(study%trial))

      fit = study%trial%good .and. study%trial%score <= wanted .and. study%trial%energy <= wanted
      best = 0
      if (.not. any(fit)) return
      fit = fit .and. study%trial%time <= NOISE*minval(study%trial%time, mask=fit)
      best = findloc(fit, .true., dim=1)
   end function best_trial

   !> One more trial: the stiffness that brings one of the trials to the wanted error at the least
   !> cost. Errors of joints go with 1/Kn, and so do those of steps, which go with the square of the
   !> step; the cost goes with its inverse, the square root of Kn. None when nothing promises to be
   !> cheaper than what there is.
   subroutine foretell(wanted, study, found)
      real(wp), intent(in) :: wanted
      type(study_t), intent(inout) :: study
      logical, intent(out) :: found

      type(trial_t), allocatable :: longer(:)
      real(wp) :: least, cost, scale, best_scale
      integer :: i, best

      found = .false.
      if (.not. study%extrapolated) return
      best = best_trial(study, wanted)
      least = huge(1.0_wp)
      if (best > 0) least = study%trial(best)%time/NOISE
      best = 0
      best_scale = 1.0_wp
      do i = 1, size(study%trial)
         associate (t => study%trial(i))
            if (.not. t%good .or. t%options%kn == 'inf') cycle
            scale = max(t%score, t%energy)/(SAFELY*wanted)
            if (.not. (scale > 1.0e-4_wp .and. scale < 1.0e6_wp)) cycle
            cost = t%time*sqrt(scale)
            if (.not. cost < least) cycle
            ! a softer one would have to hold what it promises; one that was tried has said it
            scale = t%options%kn_scale*rounded_up(scale)
            if (tried(study, t%options, scale)) cycle
            best = i
            best_scale = scale
            least = cost
         end associate
      end do
      found = best > 0
      if (.not. found) return
      allocate (longer(size(study%trial) + 1))
      longer(:size(study%trial)) = study%trial
      longer(size(longer))%options = study%trial(best)%options
      longer(size(longer))%options%kn_scale = best_scale
      call move_alloc(longer, study%trial)
   end subroutine foretell

   !> A setting like this, but for a Kn that differs by less than a fifth
   pure logical function tried(study, options, kn_scale)
      type(study_t), intent(in) :: study
      type(run_options_t), intent(in) :: options
      real(wp), intent(in) :: kn_scale

      integer :: i

      tried = .true.
      do i = 1, size(study%trial)
         associate (o => study%trial(i)%options)
            if (o%integrator /= options%integrator .or. o%kn /= options%kn) cycle
            if (abs(o%dt_scale - options%dt_scale) > 0.0_wp) cycle
            if (abs(log(o%kn_scale/kn_scale)) < 0.2_wp) return
         end associate
      end do
      tried = .false.
   end function tried

   !> The next number of two digits
   pure real(wp) function rounded_up(x) result(y)
      real(wp), intent(in) :: x

      real(wp) :: unit

      unit = 10.0_wp**(floor(log10(x)) - 1)
      y = ceiling(x/unit - 1.0e-6_wp)*unit
   end function rounded_up

end module kj_study_table
