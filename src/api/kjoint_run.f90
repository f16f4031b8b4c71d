!> The run: samples, status, outcome.
!> One file: the course of a run.
submodule (kjoint) kjoint_run
   use kj_error, only: fail, str
   use kj_system, only: wall_clock
   use kj_sample, only: sample_row
   use kj_extremes, only: watch_row
   use kj_trace, only: plan_trace, next_cycle, is_traced, take_trace
   use kj_scheme_check, only: refuse_years, warn_give
   use kj_consistent_march, only: COMPLIANT
   use kj_consistent_compliant_check, only: compliant_steps, unresolved
   use kj_scheme, only: start_scheme, leaves_path, is_over, go_on, finish_scheme, show, warn_after
   use kj_checkpoint, only: save_scene, sign_state
   use kj_snapshot, only: OWNER_JOINT
   implicit none

   character(len=8), parameter :: OWNER_NAME(0:3) = ['none    ', 'node    ', 'body    ', 'joint   ']

   !> How a run under way stands, beside its scene and status
   type :: course_t
      real(wp) :: clock = 0.0_wp                 !! when the solver last had the processor
      logical :: stop = .false., over = .false.  !! by the monitor; all samples are taken
      logical :: sure = .false.                  !! that it does not take years
      integer(int8), allocatable :: left(:)      !! state where the steps began to be cut
   end type course_t

contains

   module procedure run_simulation
      type(course_t) :: course

      call open_run(sim, sink, error)
      if (allocated(error)) return
      call begin_run(sim, course, status, error)
      call run_on(sim, sink, monitor, course, status, error)
      if (sim%scheme%integrator == COMPLIANT) status%unresolved = unresolved(sim%model, &
         sim%scheme%march%pace, sim%extremes%gap%value, sim%extremes%gap_rot%value)
      if (.not. (allocated(error) .or. sim%scheme%legacy .or. &
         sim%scheme%integrator == COMPLIANT)) call compliant_steps(sim%model, &
         sim%extremes%gap%value, sim%extremes%turn%value, sim%scheme%now%time, &
         status%compliant_steps, status%compliant_error)
      call end_run(sim, sink, monitor, course, status, error)
   end procedure run_simulation

   !> A run into a sink, which is open unless there is an error
   subroutine open_run(sim, sink, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      type(error_t), allocatable, intent(out) :: error

      call check_loaded(sim, error)
      if (.not. allocated(error)) call refuse_begin(sim, error)
      if (allocated(error)) return
      sim%started = .false.
      sim%extremes = extremes_t()
      if (.not. sim%restored) sim%rows = 0
      sink%rows_before = sim%rows
      call sink%open(sim%history, error)
      sim%running = .not. allocated(error)
   end subroutine open_run

   !> The scene at its start
   subroutine begin_run(sim, course, status, error)
      type(simulation_t), intent(inout) :: sim
      type(course_t), intent(out) :: course
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error

      course%clock = wall_clock()
      if (.not. sim%restored) call start_scheme(sim%model, sim%scheme, error)
      status%wall_start = wall_clock() - course%clock
      sim%restored = .false.
      if (.not. allocated(error)) call refuse_years(sim%model%model_t, sim%scheme, &
         sim%options%force, status%cycles_to_go, error)
   end subroutine begin_run

   !> To the end, unless there is an error
   subroutine run_on(sim, sink, monitor, course, status, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      class(monitor_t), intent(inout) :: monitor
      type(course_t), intent(inout) :: course
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(inout) :: error

      do while (.not. allocated(error))
         call visit(sim, sink, monitor, course, status, error)
         if (course%over .or. allocated(error)) return
         call go_on(sim%model, sim%scheme, error)
         if (.not. allocated(error)) call pass(sim, monitor, course, status, error)
      end do
   end subroutine run_on

   !> A deck is loaded and does not run. Errors: ERR_INPUT
   subroutine check_loaded(sim, error)
      type(simulation_t), intent(in) :: sim
      type(error_t), allocatable, intent(out) :: error

      if (sim%running) then
         call fail(error, ERR_INPUT, RUNS)
      else if (.not. sim%loaded) then
         call fail(error, ERR_INPUT, 'no deck is loaded')
      end if
   end subroutine check_loaded

   !> What is left to do at the end of a run, with an error or without; the sink is closed
   subroutine end_run(sim, sink, monitor, course, status, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      class(monitor_t), intent(inout) :: monitor
      type(course_t), intent(inout) :: course
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(inout) :: error

      logical :: ignored

      if (.not. allocated(error)) call finish_scheme(sim%model, sim%scheme, error)
      call tell(sim, status)
      call warn_after(sim%model%model_t, sim%scheme, status%warnings)
      call warn_give(sim%model%model_t, sim%history, sim%extremes, status%warnings)
      call charge(status%wall_solve, course%clock)
      call monitor%tick(status, ignored)
      call end_history(sink, course%stop, monitor%stop_code, status%cycle, error)
      if (allocated(sim%row)) deallocate (sim%row)
      call charge(status%wall_output, course%clock)
      sim%running = .false.
   end subroutine end_run

   !> Errors: ERR_INPUT when a run can neither start nor go on from the state that was restored
   subroutine refuse_begin(sim, error)
      type(simulation_t), intent(in) :: sim
      type(error_t), allocatable, intent(out) :: error

      if (.not. sim%restored) then
         call refuse_later_run(sim, error)
      else if (is_over(sim%model%model_t, sim%scheme)) then
         call fail(error, ERR_INPUT, &
            'the saved state is at the end of the run already: ask for a later end')
      end if
   end subroutine refuse_begin

   !> Errors: ERR_INPUT when the engine deck says that it goes on from a run before
   subroutine refuse_later_run(sim, error)
      type(simulation_t), intent(in) :: sim
      type(error_t), allocatable, intent(out) :: error

      if (sim%model%control%run_number > 1) call fail(error, ERR_INPUT, 'run '// &
         str(sim%model%control%run_number)//' goes on from the saved state of the run before', &
         'KJ-9066')
   end subroutine refuse_later_run

   module procedure trace_simulation
      call check_loaded(sim, error)
      if (allocated(error)) return
      if (sim%options%islands .and. size(ids) > 0) then
         call fail(error, ERR_INPUT, 'islands march by themselves: a trace follows one scene')
      else
         call plan_trace(sim%model%model_t, ids, first, last, sim%trace, error)
      end if
      if (allocated(error)) sim%trace%last = -1
   end procedure trace_simulation

   module procedure see
      associate (nobody => self, nothing => trace)
      end associate
   end procedure see

   !> Show the monitor this cycle where it is traced, and pause at the next that is
   subroutine look(sim, monitor)
      type(simulation_t), intent(inout) :: sim
      class(monitor_t), intent(inout) :: monitor

      type(trace_t), allocatable :: trace(:)

      associate (cycle => sim%scheme%now%cycle)
         if (is_traced(sim%trace, cycle)) then
            call take_trace(sim%model, sim%scheme, sim%trace, trace)
            call monitor%see(trace)
         end if
         sim%trace%seen = cycle
         sim%scheme%pause = next_cycle(sim%trace, cycle)
      end associate
   end subroutine look

   module procedure wants_state
      wanted = .false.
      associate (nobody => self, never => ended)
      end associate
   end procedure wants_state

   module procedure take_state
      associate (nobody => self, nothing => state, never => status)
      end associate
   end procedure take_state

   !> What a run does where it stands: a sample where one is due, and at its end. Islands stand at
   !> the same time at samples alone: stopped between them, their history ends at the last one.
   subroutine visit(sim, sink, monitor, course, status, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      class(monitor_t), intent(inout) :: monitor
      type(course_t), intent(inout) :: course
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: ignored

      associate (s => sim%scheme, c => course)
         c%over = is_over(sim%model%model_t, s)
         call look(sim, monitor)
         call keep_point(sim, monitor, c%over .or. c%stop, status, c%left, error)
         if (allocated(error)) return
         if (s%due .or. c%over .or. (c%stop .and. .not. s%apart)) then
            call add_row(sim, sink, c%clock, status, error)
            if (.not. allocated(error)) call check_energy(sim, status, error)
            if (allocated(error) .and. sim%model%control%stop_saves) then
               sim%rows = sim%rows - 1           ! the run that goes on writes this one again
               call keep_state(sim, monitor, status, c%left, ignored)
            end if
         end if
         c%over = c%over .or. c%stop
      end associate
   end subroutine visit

   subroutine pass(sim, monitor, course, status, error)
      type(simulation_t), intent(inout) :: sim
      class(monitor_t), intent(inout) :: monitor
      type(course_t), intent(inout) :: course
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error

      if (.not. course%sure .and. sim%scheme%now%cycle > 1) then   ! on a full step
         call refuse_years(sim%model%model_t, sim%scheme, sim%options%force, &
            status%cycles_to_go, error)
         course%sure = .true.
         if (allocated(error)) return
      end if
      call tell(sim, status)
      call charge(status%wall_solve, course%clock)
      call monitor%tick(status, course%stop)
      call charge(status%wall_output, course%clock)
   end subroutine pass

   !> Hand the monitor the state where it wants it: the state now, or that from before the steps
   !> were cut to the end of the run, which a longer run does not share
   subroutine keep_point(sim, monitor, ended, status, left, error)
      type(simulation_t), intent(inout) :: sim
      class(monitor_t), intent(inout) :: monitor
      logical, intent(in) :: ended
      type(run_status_t), intent(inout) :: status
      integer(int8), allocatable, intent(inout) :: left(:)
      type(error_t), allocatable, intent(out) :: error

      logical :: wanted

      call monitor%wants_state(ended, wanted)
      if (.not. (ended .or. allocated(left))) then
         if (leaves_path(sim%model%model_t, sim%scheme)) call save_scene(sim%options, &
            sim%history, sim%rows, sim%model, sim%scheme, sim%sampler, .false., left)
      end if
      if (wanted) call keep_state(sim, monitor, status, left, error)
   end subroutine keep_point

   !> Hand the monitor the state now, or the one from before the steps were cut
   subroutine keep_state(sim, monitor, status, left, error)
      type(simulation_t), intent(inout) :: sim
      class(monitor_t), intent(inout) :: monitor
      type(run_status_t), intent(inout) :: status
      integer(int8), allocatable, intent(inout) :: left(:)
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: now(:)

      call tell(sim, status)
      if (allocated(left)) then
         call sign_state(sim%options, sim%history, left)
         call monitor%take_state(left, status, error)
      else
         call save_scene(sim%options, sim%history, sim%rows, sim%model, sim%scheme, sim%sampler, &
            .true., now)
         call monitor%take_state(now, status, error)
      end if
   end subroutine keep_state

   !> Close the sink with the outcome; an error of the run goes before one of the sink
   subroutine end_history(sink, stopped, stop_code, cycles, error)
      class(sink_t), intent(inout) :: sink
      logical, intent(in) :: stopped
      integer, intent(in) :: stop_code, cycles
      type(error_t), allocatable, intent(inout) :: error

      type(error_t), allocatable :: sink_error

      if (allocated(error)) then
         call sink%close('ERROR TERMINATION: '//error%message, cycles, error%code, sink_error)
      else if (stopped) then
         call sink%close('STOPPED BY USER', cycles, stop_code, sink_error)
      else
         call sink%close('NORMAL TERMINATION', cycles, 0, sink_error)
      end if
      if (.not. allocated(error) .and. allocated(sink_error)) call move_alloc(sink_error, error)
   end subroutine end_history

   !> Sample the state into the sink; watches the energy limit
   subroutine add_row(sim, sink, clock, status, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      real(wp), intent(inout) :: clock
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error

      call charge(status%wall_solve, clock)
      if (.not. allocated(sim%row)) allocate (sim%row(sim%history%n_value))
      call fill_row(sim, sim%row, error)
      if (.not. allocated(error)) call sink%put(sim%row, error)
      call charge(status%wall_output, clock)
      status%n_sample = status%n_sample + 1
      sim%rows = sim%rows + 1
      if (allocated(error)) return
      call tell(sim, status)
   end subroutine add_row

   !> The time since the clock was read goes to seconds; it is read again
   subroutine charge(seconds, clock)
      real(wp), intent(inout) :: seconds, clock

      real(wp) :: now

      now = wall_clock()
      seconds = seconds + (now - clock)
      clock = now
   end subroutine charge

   !> The limit of the energy error: that of the options, else of /STOP and /KILL.
   !> Errors: ERR_RUN when it is passed, and when the error is not a number
   subroutine check_energy(sim, status, error)
      type(simulation_t), intent(in) :: sim
      type(run_status_t), intent(in) :: status
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: limit

      limit = min(sim%model%control%stop_energy, huge(1.0_wp))
      if (sim%options%energy_limit >= 0.0_wp) limit = min(limit, sim%options%energy_limit/100.0_wp)
      if (abs(status%energy_error) <= limit) return
      if (abs(status%energy_error) <= huge(1.0_wp)) then
         call fail(error, ERR_RUN, 'the energy error passed its limit in cycle '// &
            str(status%cycle))
      else
         call fail(error, ERR_RUN, 'the energy is not finite any more in cycle '// &
            str(status%cycle))
      end if
   end subroutine check_energy

   !> All channels now; the row of a last state that is no regular sample says so
   subroutine fill_row(sim, row, error)
      type(simulation_t), intent(inout) :: sim
      real(wp), contiguous, intent(out) :: row(:)
      type(error_t), allocatable, intent(out) :: error

      call show(sim%model, sim%scheme)
      call sample_row(sim%model%model_t, sim%scheme%now, sim%history, .not. sim%scheme%due, &
         sim%sampler, row, error)
      if (.not. allocated(error)) call watch_row(sim%history, row, sim%extremes)
   end subroutine fill_row

   module procedure simulation_worst
      extremes = sim%extremes
      owner = 0
      if (sim%scheme%now%owner_kind == OWNER_JOINT) owner = sim%scheme%now%owner
      if (sim%options%integrator == 'compliant') owner = -1
   end procedure simulation_worst

   !> Renew the status
   subroutine tell(sim, status)
      type(simulation_t), intent(in) :: sim
      type(run_status_t), intent(inout) :: status

      associate (now => sim%scheme%now, model => sim%model)
         status%cycle = now%cycle
         status%time = now%time
         status%time_step = now%step
         status%owner_kind = OWNER_NAME(now%owner_kind)
         status%owner = now%owner
         status%kinetic = now%balance%kinetic_trans + now%balance%kinetic_rot
         status%kinetic_rot = now%balance%kinetic_rot
         status%mass = now%balance%mass
         status%internal = now%balance%internal
         status%work = now%work
         status%energy_error = now%energy_error
         status%n_halved = sim%scheme%march%pace%halvings
         status%t_stop = model%control%t_stop
         status%print_every = model%control%print_every
         status%n_joint = model%n_joint
         status%n_spring = model%n_spring
         status%n_body = model%n_body
         status%n_node = model%n_node
         status%joint_cycles = real(status%cycle, wp)*model%n_joint
         status%least_cycle = status%cycle
      end associate
      status%n_island = sim%scheme%n_island
      if (.not. allocated(sim%scheme%part)) return
      associate (part => sim%scheme%part)
         if (size(part) == 0) return
         status%n_part = size(part)
         status%joint_cycles = sum(real(part%state%cycle, wp)*part%model%n_joint)
         status%least_cycle = minval(part%state%cycle)
      end associate
   end subroutine tell

end submodule kjoint_run
