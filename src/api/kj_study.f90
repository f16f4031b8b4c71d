!> The speed-accuracy trade of a deck: runs over time steps, integrators, formulations and blocking
!> stiffness, each compared with the finest.
module kj_study
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, ERR_INPUT, ERR_RUN
   use kj_system, only: thread_clock
   use kj_study_metric, only: study_sink_t, class_errors, N_CLASS
   use kjoint, only: run_options_t, run_status_t, simulation_t, monitor_t, load_simulation, &
      run_simulation, simulation_title, simulation_reach, simulation_joints, simulation_bodies
   implicit none
   private

   public :: study_options_t, study_t, trial_t, watcher_t, run_study, best_trial, order_of

   !> What a study may be told
   type :: study_options_t
      type(run_options_t) :: run                 !! until, sample, ignore_unsupported of all runs
      real(wp), allocatable :: dt_scale(:)       !! fractions of the limit; default 0.9, 0.45 ...
      real(wp), allocatable :: kn_scale(:)       !! beside 1; default 0.1, 0.01
      integer :: threads = 1                     !! runs at a time
   end type study_options_t

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
      real(wp) :: error(N_CLASS) = 0.0_wp        !! by CLASSES of kj_study_metric
      real(wp) :: score = 0.0_wp                 !! largest error in displacement and rotation
      real(wp) :: energy = 0.0_wp                !! largest |energy error|, a fraction
      real(wp) :: gap = 0.0_wp, gap_rot = 0.0_wp !! largest violation
      real(wp) :: order = 0.0_wp                 !! from the step before it in its family, 0 = none
   end type trial_t

   !> A study
   type :: study_t
      character(len=:), allocatable :: title
      type(trial_t) :: reference
      type(trial_t), allocatable :: trial(:)     !! families together, long steps first
      integer :: n_joint = 0, n_body = 0
      real(wp) :: reach = 0.0_wp                 !! of moving bodies, length
      real(wp) :: floor = 0.0_wp                 !! scores below it may be errors of the reference
   end type study_t

   !> Someone who watches a study
   type, abstract :: watcher_t
   contains
      procedure(stop_i), deferred :: wants_stop
      procedure(done_i), deferred :: run_done
   end type watcher_t

   abstract interface
      !> Asked every few cycles, maybe by several threads at once
      logical function stop_i(self)
         import :: watcher_t
         class(watcher_t), intent(in) :: self
      end function stop_i
      !> Told after each run, by one thread at a time
      subroutine done_i(self, n_done, n_all, trial)
         import :: watcher_t, trial_t
         class(watcher_t), intent(inout) :: self
         integer, intent(in) :: n_done, n_all
         type(trial_t), intent(in) :: trial
      end subroutine done_i
   end interface

   !> Passes the wish to stop on to a run
   type, extends(monitor_t) :: pass_on_t
      class(watcher_t), pointer :: watcher => null()
   contains
      procedure :: tick
   end type pass_on_t

   real(wp), parameter :: DT_SCALES(4) = [0.9_wp, 0.45_wp, 0.225_wp, 0.1125_wp]
   real(wp), parameter :: KN_SCALES(2) = [0.1_wp, 0.01_wp]
   integer, parameter :: RK4_STEPS = 2           !! with shorter ones it is beyond the reference
   real(wp), parameter :: FINER = 0.25_wp        !! step of the reference over the shortest
   real(wp), parameter :: SURE = 4.0_wp          !! floor of orders, over the error of the reference
   real(wp), parameter :: NOISE = 1.25_wp        !! of times
   integer, parameter :: FEWEST_ROWS = 20, ROWS = 200   !! where the deck samples too rarely

contains

   subroutine tick(self, status, stop)
      class(pass_on_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop
      stop = status%cycle < 0
      if (.not. stop) stop = self%watcher%wants_stop()
   end subroutine tick

   !> Run the reference and all settings.
   !>
   !> Errors: those of loading; ERR_RUN when the reference fails or the watcher stops the study
   subroutine run_study(starter, engine, options, watcher, study, findings, error)
      character(len=*), intent(in) :: starter, engine    !! as for load_simulation
      type(study_options_t), intent(in) :: options
      class(watcher_t), intent(inout), target :: watcher
      type(study_t), intent(out) :: study
      type(finding_list_t), intent(inout) :: findings
      type(error_t), allocatable, intent(out) :: error
      type(study_sink_t) :: reference, sink
      type(run_options_t) :: run
      type(study_options_t) :: given
      integer :: i, n_done

      given = options
      if (.not. allocated(given%dt_scale)) given%dt_scale = DT_SCALES
      if (.not. allocated(given%kn_scale)) given%kn_scale = KN_SCALES
      call set_reference(given, study%reference%options)
      run = study%reference%options
      call one_run(starter, engine, run, watcher, reference, study, findings, error)
      if (allocated(error)) return
      if (reference%n_row < FEWEST_ROWS) then
         run%sample = reference%t_last/ROWS
         call one_run(starter, engine, run, watcher, reference, study, findings, error)
         if (allocated(error)) return
      end if
      call list_trials(given, study)
      n_done = 1
      call watcher%run_done(n_done, size(study%trial) + 1, study%reference)
      !$omp parallel do schedule(dynamic) num_threads(options%threads) private(sink)
      do i = 1, size(study%trial)
         if (watcher%wants_stop()) cycle
         call one_trial(starter, engine, run%sample, study%reach, watcher, reference, sink, &
            study%trial(i))
         !$omp critical (kj_study_done)
         n_done = n_done + 1
         call watcher%run_done(n_done, size(study%trial) + 1, study%trial(i))
         !$omp end critical (kj_study_done)
      end do
      !$omp end parallel do
      if (watcher%wants_stop()) then
         call fail(error, ERR_RUN, 'the study was stopped')
         return
      end if
      call find_orders(study)
   end subroutine run_study

   !> split2 with a step far shorter than all others
   pure subroutine set_reference(options, run)
      type(study_options_t), intent(in) :: options
      type(run_options_t), intent(out) :: run
      run = options%run
      run%formulation = 'consistent'
      run%integrator = 'split2'
      run%dt_scale = FINER*minval(options%dt_scale)
      run%dt_max_scale = run%dt_scale/maxval(options%dt_scale)
   end subroutine set_reference

   !> The settings of a study: families of falling steps, then softer blocking at the longest step
   pure subroutine list_trials(options, study)
      type(study_options_t), intent(in) :: options
      type(study_t), intent(inout) :: study

      character(len=6), parameter :: INTEGRATORS(4) = ['split2', 'liemid', 'rkmk4 ', 'legacy']
      real(wp), allocatable :: dt(:), kn(:)
      integer :: i, k, n, most

      dt = options%dt_scale
      kn = options%kn_scale
      if (.not. max(study%reference%gap, study%reference%gap_rot) > 0.0_wp) kn = kn(:0)
      allocate (study%trial(3*size(dt) + min(RK4_STEPS, size(dt)) + size(kn)))
      n = 0
      do k = 1, 4
         most = size(dt)
         if (INTEGRATORS(k) == 'rkmk4') most = min(RK4_STEPS, most)
         do i = 1, most
            n = n + 1
            study%trial(n)%options = setting(INTEGRATORS(k), dt(i), 1.0_wp)
         end do
      end do
      do i = 1, size(kn)
         study%trial(n + i)%options = setting('split2', maxval(dt), kn(i))
      end do
   contains
      pure function setting(integrator, dt_scale, kn_scale) result(run)
         character(len=*), intent(in) :: integrator
         real(wp), intent(in) :: dt_scale, kn_scale
         type(run_options_t) :: run

         run = options%run
         run%formulation = merge('legacy    ', 'consistent', integrator == 'legacy')
         run%integrator = integrator
         run%dt_scale = dt_scale
         run%dt_max_scale = dt_scale/maxval(dt)
         run%kn_scale = kn_scale
      end function setting
   end subroutine list_trials

   !> The reference, and what the scene is
   subroutine one_run(starter, engine, run, watcher, sink, study, findings, error)
      character(len=*), intent(in) :: starter, engine
      type(run_options_t), intent(in) :: run
      class(watcher_t), intent(inout), target :: watcher
      type(study_sink_t), intent(inout) :: sink
      type(study_t), intent(inout) :: study
      type(finding_list_t), intent(inout) :: findings
      type(error_t), allocatable, intent(out) :: error

      type(simulation_t) :: sim

      call timed_run(starter, engine, run, watcher, sink, sim, study%reference, findings, error)
      if (.not. allocated(error)) then
         if (watcher%wants_stop()) call fail(error, ERR_RUN, 'the study was stopped')
      end if
      if (allocated(error)) return
      study%title = trim(simulation_title(sim))
      study%reach = simulation_reach(sim)
      study%n_joint = size(simulation_joints(sim))
      study%n_body = size(simulation_bodies(sim))
   end subroutine one_run

   !> One setting against the reference
   subroutine one_trial(starter, engine, sample, reach, watcher, reference, sink, trial)
      character(len=*), intent(in) :: starter, engine
      real(wp), intent(in) :: sample, reach
      class(watcher_t), intent(inout), target :: watcher
      type(study_sink_t), intent(in) :: reference
      type(study_sink_t), intent(inout) :: sink
      type(trial_t), intent(inout) :: trial

      type(run_options_t) :: run
      type(simulation_t) :: sim
      type(trial_t) :: again
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error

      run = trial%options
      run%sample = sample
      run%energy_limit = 1.0e6_wp
      sink%wanted = reference%rows(1, :reference%n_row)
      call timed_run(starter, engine, run, watcher, sink, sim, trial, findings, error)
      if (trial%options%formulation == 'legacy' .and. trial%good) then
         ! its samples are cycles: the cost from the first run, rows from one that samples them all
         run%sample = 0.0_wp
         again = trial
         call timed_run(starter, engine, run, watcher, sink, sim, again, findings, error)
         again%time = trial%time
         again%per_cycle = trial%per_cycle
         trial = again
      end if
      if (allocated(error)) trial%message = error%message
      if (.not. trial%good) return
      trial%error = class_errors(reference, sink, reach)
      trial%score = maxval(trial%error(1:2))
      trial%good = trial%score < huge(1.0_wp)
   end subroutine one_trial

   !> A run, its cost and its worst. Errors: those of loading, findings and running
   subroutine timed_run(starter, engine, run, watcher, sink, sim, trial, findings, error)
      character(len=*), intent(in) :: starter, engine
      type(run_options_t), intent(in) :: run
      class(watcher_t), intent(inout), target :: watcher
      type(study_sink_t), intent(inout) :: sink
      type(simulation_t), intent(out) :: sim
      type(trial_t), intent(inout) :: trial
      type(finding_list_t), intent(out) :: findings
      type(error_t), allocatable, intent(out) :: error

      type(run_status_t) :: status
      type(pass_on_t) :: monitor
      real(wp) :: clock

      trial%good = .false.
      call load_simulation(sim, starter, engine, run, findings, error)
      if (.not. allocated(error) .and. findings%n_error > 0) &
         call fail(error, ERR_INPUT, 'the deck has errors')
      if (allocated(error)) return
      monitor%watcher => watcher
      clock = thread_clock()
      call run_simulation(sim, sink, monitor, status, error)
      if (allocated(error)) return
      trial%good = .true.
      trial%time = thread_clock() - clock
      trial%cycles = status%cycle
      trial%by_deck = status%owner_kind == 'none'
      trial%step = status%time/max(1, status%cycle)
      trial%per_cycle = trial%time/max(1, status%cycle)/max(1, max(status%n_joint, &
         merge(0, status%n_body, status%n_joint > 0)))
      trial%energy = sink%energy
      trial%gap = sink%gap
      trial%gap_rot = sink%gap_rot
   end subroutine timed_run

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
         last = study%trial(i)%score
      end do
      study%floor = last/(FINER**(-2) - 1.0_wp)
      if (before > 0.0_wp .and. ratio > 1.1_wp) study%floor = max(study%floor, &
         abs(ratio*last - before)/(ratio - 1.0_wp))
      study%floor = SURE*study%floor
      do i = 2, size(study%trial)
         associate (a => study%trial(i - 1), b => study%trial(i))
            if (.not. (same_family(a, b) .and. a%good .and. b%good)) cycle
            if (.not. (b%step < 0.99_wp*a%step .and. min(a%score, b%score) > study%floor)) cycle
            b%order = log(a%score/b%score)/log(a%step/b%step)
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
               t%score > study%floor .and. abs(t%options%kn_scale - 1.0_wp) <= 0.0_wp
         end associate
      end do
      if (count(mine) < 3) return
      x = log(pack(study%trial%step, mine))
      y = log(pack(study%trial%score, mine))
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

end module kj_study
