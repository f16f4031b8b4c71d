!> The speed-accuracy trade of a deck: runs over time steps, integrators, formulations and blocking
!> stiffness, each compared with joints that do not give way, and with the finest steps at its Kn.
!> One file: a study is one plan of runs
module kj_study
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, ERR_INPUT, ERR_RUN
   use kj_system, only: thread_clock
   use kj_team, only: processors
   use kj_channels, only: OF_JOINT
   use kj_history, only: entity_title
   use kj_study_table, only: study_t, trial_t, FINER, find_orders, foretell, study_sink_t, &
      class_errors, N_CLASS
   use kjoint, only: run_options_t, run_status_t, simulation_t, monitor_t, load_simulation, &
      run_simulation, simulation_title, simulation_reach, simulation_joints, simulation_bodies
   implicit none
   private

   public :: study_options_t, watcher_t, run_study, extrapolate, soften

   real(wp), parameter :: STIFFER = 4.0_wp       !! Kn of the second of two runs over the first

   !> What a study may be told
   type :: study_options_t
      type(run_options_t) :: run                 !! until, sample, ignore_unsupported of all runs
      real(wp), allocatable :: dt_scale(:)       !! fractions of the limit; default 0.9, 0.45 ...
      real(wp), allocatable :: kn_scale(:)       !! beside 1; default 0.1, 0.01
      integer :: threads = 1                     !! runs at a time
      real(wp) :: wanted = 1.0e-3_wp             !! error of positions and rotations
   end type study_options_t

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
   integer, parameter :: MOST_FORETOLD = 2
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
      type(study_sink_t) :: reference, truth, sink
      type(run_options_t) :: run
      type(study_options_t) :: given
      integer :: i, n_done
      logical :: found

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
      call find_truth(starter, engine, run, watcher, reference, study, truth)
      call list_trials(given, study)
      n_done = 1
      call watcher%run_done(n_done, size(study%trial) + 1, study%reference)
      !$omp parallel do schedule(dynamic) num_threads(min(options%threads, processors())) &
      !$omp private(sink)
      do i = 1, size(study%trial)
         if (watcher%wants_stop()) cycle
         call one_trial(starter, engine, run%sample, study%reach, watcher, reference, truth, sink, &
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
      do i = 1, MOST_FORETOLD
         call foretell(given%wanted, study, found)
         if (.not. found) exit
         if (watcher%wants_stop()) exit
         associate (last => study%trial(size(study%trial)))
            call one_trial(starter, engine, run%sample, study%reach, watcher, reference, truth, &
               sink, last)
            call watcher%run_done(n_done + i, n_done + i, last)
         end associate
      end do
      if (watcher%wants_stop()) call fail(error, ERR_RUN, 'the study was stopped')
   end subroutine run_study

   !> What ideal joints would do, from runs at 4 Kn, and at 16 Kn to check it, with the steps of the
   !> reference; where they cannot be had, or no joint gives way, it is the reference
   subroutine find_truth(starter, engine, options, watcher, reference, study, truth)
      character(len=*), intent(in) :: starter, engine
      type(run_options_t), intent(in) :: options             !! of the reference
      class(watcher_t), intent(inout), target :: watcher
      type(study_sink_t), intent(in) :: reference
      type(study_t), intent(inout) :: study
      type(study_sink_t), intent(out) :: truth

      type(study_sink_t) :: stiff(2), check
      type(run_options_t) :: run
      type(simulation_t) :: sim
      type(trial_t) :: trial
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error
      integer :: i

      truth = reference
      if (.not. max(study%reference%gap, study%reference%gap_rot) > 0.0_wp) return
      do i = 1, 2
         run = options
         run%kn_scale = STIFFER**i*options%kn_scale
         run%dt_scale = min(0.9_wp, sqrt(STIFFER**i)*options%dt_scale)
         stiff(i)%wanted = reference%rows(1, :reference%n_row)
         call timed_run(starter, engine, run, watcher, stiff(i), sim, trial, findings, error)
         if (allocated(error) .or. stiff(i)%n_row < reference%n_row) return
      end do
      call extrapolate(reference, stiff(1), truth)
      call extrapolate(stiff(1), stiff(2), check)
      study%extrapolated = .true.
      study%compliance = score_of(class_errors(truth, reference, study%reach))
      study%doubt = score_of(class_errors(check, truth, study%reach))
   end subroutine find_truth

   !> The larger error in displacement and rotation; huge when one is not a number
   pure real(wp) function score_of(error) result(score)
      real(wp), intent(in) :: error(N_CLASS)

      score = huge(1.0_wp)
      if (all(error(1:2) <= huge(1.0_wp))) score = maxval(error(1:2))
   end function score_of

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
      real(wp), parameter :: OF_WANTED(2) = [1.0_wp, 0.1_wp]
      real(wp), allocatable :: dt(:), kn(:)
      integer :: i, k, n, most

      dt = options%dt_scale
      kn = options%kn_scale
      if (.not. max(study%reference%gap, study%reference%gap_rot) > 0.0_wp) kn = kn(:0)
      allocate (study%trial(3*size(dt) + min(RK4_STEPS, size(dt)) + size(kn) + size(OF_WANTED)))
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
      n = n + size(kn)
      do i = 1, size(OF_WANTED)
         associate (o => study%trial(n + i)%options)
            o = setting('compliant', maxval(dt), 1.0_wp)
            o%kn = 'inf'
            o%error = OF_WANTED(i)*options%wanted
         end associate
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
      study%input = sink%history%input_path
      study%n_joint = size(simulation_joints(sim))
      study%n_body = size(simulation_bodies(sim))
   end subroutine one_run

   !> One setting against the reference
   subroutine one_trial(starter, engine, sample, reach, watcher, reference, truth, sink, trial)
      character(len=*), intent(in) :: starter, engine
      real(wp), intent(in) :: sample, reach
      class(watcher_t), intent(inout), target :: watcher
      type(study_sink_t), intent(in) :: reference, truth
      type(study_sink_t), intent(inout) :: sink
      type(trial_t), intent(inout) :: trial

      type(study_sink_t) :: finest
      real(wp) :: error_here(N_CLASS)
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
      if (trial%options%kn == 'inf') then
         finest = truth
      else
         call soften(truth, reference, trial%options%kn_scale, finest)
      end if
      error_here = class_errors(truth, sink, reach)
      trial%error = class_errors(finest, sink, reach)
      trial%by_step = score_of(trial%error)
      trial%by_joints = score_of(class_errors(truth, finest, reach))
      trial%error(1:2) = error_here(1:2)
      trial%score = score_of(error_here)
      trial%good = all(trial%error <= huge(1.0_wp)) .and. trial%energy <= huge(1.0_wp)
      if (.not. trial%good) trial%message = 'not finite'
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
      ! what holds the step of compliant is its error
      trial%by_deck = status%owner_kind == 'none' .and. run%integrator /= 'compliant'
      trial%step = status%time/max(1, status%cycle)
      trial%per_cycle = trial%time/max(1, status%cycle)/max(1, max(status%n_joint, &
         merge(0, status%n_body, status%n_joint > 0)))
      trial%energy = sink%energy
      trial%gap = sink%gap
      trial%gap_rot = sink%gap_rot
      if (sink%gap_joint > 0) trial%gap_title = entity_title(sink%history, OF_JOINT, sink%gap_joint)
   end subroutine timed_run

   !> Rows for 1/Kn to 0: x(4 Kn) + (x(4 Kn) - x(Kn))/3
   subroutine extrapolate(soft, stiff, truth)
      type(study_sink_t), intent(in) :: soft     !! with Kn
      type(study_sink_t), intent(in) :: stiff    !! with STIFFER Kn, at the same times
      type(study_sink_t), intent(out) :: truth

      truth = stiff
      call blend(stiff%rows, soft%rows, -1.0_wp/(STIFFER - 1.0_wp), truth)
   end subroutine extrapolate

   !> Rows at `scale` times the Kn of `run`: the truth and what is left of its distance from the run
   subroutine soften(truth, run, scale, rows)
      type(study_sink_t), intent(in) :: truth, run
      real(wp), intent(in) :: scale
      type(study_sink_t), intent(out) :: rows

      rows = run
      call blend(truth%rows, run%rows, 1.0_wp/scale, rows)
   end subroutine soften

   !> a + part (b - a), quaternions of one sign and made 1 long
   subroutine blend(a, b, part, sink)
      real(wp), intent(in) :: a(:, :), b(:, :)
      real(wp), intent(in) :: part
      type(study_sink_t), intent(inout) :: sink

      integer :: i, k, n

      n = sink%n_row
      sink%rows(:, :n) = a(:, :n) + part*(b(:, :n) - a(:, :n))
      do i = 1, size(sink%history%variable)
         associate (v => sink%history%variable(i))
            if (v%n_comp /= 4) cycle
            do k = 1, v%n_entity
               call blend_turns(a(v%first + 4*(k - 1):v%first + 4*k - 1, :n), &
                  b(v%first + 4*(k - 1):v%first + 4*k - 1, :n), part, &
                  sink%rows(v%first + 4*(k - 1):v%first + 4*k - 1, :n))
            end do
         end associate
      end do
   end subroutine blend

   pure subroutine blend_turns(a, b, part, c)
      real(wp), intent(in) :: a(:, :), b(:, :)   !! (4, n)
      real(wp), intent(in) :: part
      real(wp), intent(inout) :: c(:, :)

      real(wp) :: q(4), length
      integer :: i

      do i = 1, size(c, 2)
         q = a(:, i) + part*(sign(1.0_wp, dot_product(a(:, i), b(:, i)))*b(:, i) - a(:, i))
         length = norm2(q)
         c(:, i) = q
         if (length > 0.0_wp) c(:, i) = q/length
      end do
   end subroutine blend_turns

end module kj_study
