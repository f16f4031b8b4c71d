!> `kjoint run`: options in, run, summary out.
module kj_run_command
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, str, add_finding
   use kj_system, only: wall_clock
   use kj_option, only: arguments_t, OPT_OUTPUT, OPT_REPRODUCIBLE, OPT_QUIET, &
      OPT_VERBOSE, OPT_JSON, OPT_LISTING, OPT_LIVE
   use kj_run_arguments, only: take_run_options, find_engine, exit_code
   use kj_terminal, only: print_line, may_overwrite, STDERR
   use kj_signal, only: watch_signals, caught_signal
   use kj_render, only: print_findings, print_failure
   use kj_words, only: counted, few, json_member, json_pair, json_findings
   use kj_trace_command, only: tracer_t, start_trace, end_trace
   use kj_progress, only: start_progress, list_to_file, end_progress, limiter, percent, rate, &
      SHOW_NOTHING, SHOW_STATUS, SHOW_LISTING, SHOW_SELDOM
   use kj_restart_file, only: restart_t
   use kj_keeper, only: start_keeper
   use kj_restart_command, only: continued_sink_t, find_restart, restart_from, continued_path
   use kj_text, only: text_t
   use kj_team, only: processors
   use kj_info, only: worst_lines, worst_json
   use kj_channels, only: OF_JOINT
   use kj_history, only: entity_title
   use kjoint, only: simulation_worst, simulation_history, history_t, extremes_t, simulation_t, &
      run_options_t, run_status_t, load_simulation, run_simulation, simulation_title, &
      default_output
   implicit none
   private

   public :: run_command

   real(wp), parameter :: GAIN = 10.0_wp         !! of compliant over split2: worth a line
   real(wp), parameter :: COST = 6.0_wp          !! of a cycle of compliant, in those of split2
   integer, parameter :: STOPPED = 130           !! exit code of a run that its user ended

   !> What came of a run
   type :: outcome_t
      type(run_status_t) :: status
      character(len=:), allocatable :: title, history, verdict
      character(len=:), allocatable :: checkpoint    !! path, where one was written
      real(wp) :: elapsed = 0.0_wp               !! [s] of wall clock
      integer :: code = 0                        !! exit code
      character(len=:), allocatable :: holder    !! of the time step; '' none
      type(text_t), allocatable :: worst(:)      !! what gave way most, in lines
      character(len=:), allocatable :: worst_json
      logical :: rigid = .false.                 !! Kn = infinity
   end type outcome_t

contains

   !> Run a deck as the arguments say; everything that is to be said has been said on return
   subroutine run_command(given, command_line, code)
      type(arguments_t), intent(in) :: given
      character(len=*), intent(in) :: command_line
      integer, intent(out) :: code                   !! exit code

      type(run_options_t) :: options
      type(simulation_t) :: sim
      type(tracer_t) :: tracer
      type(finding_list_t) :: findings
      type(outcome_t) :: outcome
      type(error_t), allocatable :: error
      type(arguments_t) :: args                      ! with the decks of the checkpoint
      type(restart_t) :: restart
      type(continued_sink_t), target :: sink
      character(len=:), allocatable :: engine
      logical :: goes_on

      call watch_signals()
      args = given
      tracer%sink => sink
      engine = ''
      call find_restart(args, options, restart, goes_on, error)
      if (.not. allocated(error)) call take_run_options(args, options, error)
      if (.not. allocated(error)) call find_engine(args, options, engine, error)
      if (.not. allocated(error)) &
         call load_simulation(sim, args%operand(1)%s, engine, options, findings, error)
      if (.not. allocated(error) .and. findings%n_error == 0) &
         call start_trace(args, sim, tracer, error)
      if (.not. allocated(error) .and. findings%n_error == 0 .and. goes_on) &
         call restart_from(restart, sim, error)
      if (.not. args%given(OPT_JSON)) call print_findings(args, findings)
      if (.not. allocated(error) .and. findings%n_error == 0) &
         call advance(sim, args, engine, command_line, min(options%threads, processors()), &
         restart, goes_on, sink, tracer, outcome, error)
      code = exit_code(findings, error)
      if (tracer%stopped .or. tracer%killed) code = STOPPED
      if (caught_signal() > 0) code = 128 + caught_signal()
      outcome%code = code
      outcome%rigid = options%kn == 'inf'
      if (args%given(OPT_JSON)) then
         call print_json(outcome, findings, error)
         return
      end if
      call print_findings(args, outcome%status%warnings)
      call print_failure(error)
      if (.not. args%given(OPT_QUIET) .and. allocated(outcome%verdict)) call print_summary(outcome)
   end subroutine run_command

   !> The run itself
   subroutine advance(sim, args, engine, command_line, threads, restart, goes_on, sink, tracer, &
      outcome, error)
      type(simulation_t), intent(inout) :: sim
      type(arguments_t), intent(in) :: args
      character(len=*), intent(in) :: engine, command_line
      integer, intent(in) :: threads
      type(restart_t), intent(in) :: restart
      logical, intent(in) :: goes_on                 !! from that checkpoint
      type(continued_sink_t), intent(inout) :: sink
      type(tracer_t), intent(inout) :: tracer
      type(outcome_t), intent(inout) :: outcome
      type(error_t), allocatable, intent(out) :: error

      type(history_t) :: history
      type(extremes_t) :: extremes
      real(wp) :: started
      integer :: show, owner, i

      outcome%title = trim(simulation_title(sim))
      sink%path = default_output(sim)
      if (args%given(OPT_OUTPUT)) sink%path = args%value(OPT_OUTPUT)%s
      if (goes_on) call continued_path(args, restart, sink)
      sink%reproducible = args%given(OPT_REPRODUCIBLE)
      sink%live = args%given(OPT_LIVE)
      sink%command_line = command_line
      sink%n_threads = threads
      outcome%history = sink%path
      show = SHOW_SELDOM
      if (may_overwrite(STDERR)) show = SHOW_STATUS
      if (args%given(OPT_VERBOSE)) show = SHOW_LISTING
      if (args%given(OPT_QUIET)) show = SHOW_NOTHING
      started = wall_clock()
      call start_keeper(args, sim, args%operand(1)%s, engine, sink%path, tracer, error)
      if (allocated(error)) return
      call start_progress(tracer%progress_t, show)
      if (args%given(OPT_LISTING)) call list_to_file(tracer%progress_t, &
         args%value(OPT_LISTING)%s, args%operand(:args%n_operand), error)
      if (allocated(error)) return
      call run_simulation(sim, sink, tracer, outcome%status, error)
      call end_progress(tracer%progress_t)
      call end_trace(tracer)
      outcome%elapsed = wall_clock() - started
      if (allocated(error) .and. outcome%status%n_node == 0) return      ! it was refused
      call simulation_worst(sim, extremes, owner)
      history = simulation_history(sim)
      outcome%holder = limiter(outcome%status)
      i = 0
      if (owner > 0) i = findloc(history%entity(OF_JOINT)%id, owner, dim=1)
      if (i > 0) outcome%holder = '  '//entity_title(history, OF_JOINT, i)
      call worst_lines(history, extremes, owner, outcome%worst)
      outcome%worst_json = worst_json(history, extremes)
      if (allocated(sink%place)) outcome%history = sink%place
      if (allocated(error)) call say_where(sink, error)
      outcome%verdict = 'NORMAL TERMINATION'
      if (caught_signal() > 0) outcome%verdict = 'STOPPED BY USER'
      if (tracer%stopped .or. tracer%killed) outcome%verdict = 'STOPPED BY USER'
      if (allocated(error)) outcome%verdict = 'ERROR TERMINATION'
      if (tracer%saved) outcome%checkpoint = tracer%path
      if (allocated(error) .or. .not. allocated(tracer%problem)) return
      call move_alloc(tracer%problem, error)
      error%message = 'cannot write the listing '//tracer%listing//': '//error%message
   end subroutine advance

   !> Where the rows of a run that failed are, when not where they were to go
   subroutine say_where(sink, error)
      type(continued_sink_t), intent(in) :: sink
      type(error_t), intent(inout) :: error

      if (.not. allocated(sink%place) .or. allocated(error%hint)) return
      if (sink%place == '' .or. sink%named) return
      error%hint = 'its rows are in '//sink%place//'; '//sink%path//' is an older history'
   end subroutine say_where

   subroutine print_summary(outcome)
      type(outcome_t), intent(in) :: outcome

      character(len=100) :: buffer
      real(wp) :: seconds
      integer :: i

      associate (s => outcome%status)
         seconds = max(outcome%elapsed, 1e-9_wp)
         call print_line(outcome%verdict//'  '//outcome%title)
         buffer = ''
         if (s%n_spring > 0) buffer = ', '//counted(s%n_spring, 'spring', 'springs')
         call print_line('   model         '//counted(s%n_joint, 'joint', 'joints')//', '// &
            counted(s%n_body, 'rigid body', 'rigid bodies')//', '// &
            counted(s%n_node, 'node', 'nodes')//trim(buffer))
         call print_line('   cycles        '//str(s%cycle))
         if (s%n_halved > 0) call print_line('   halved        '// &
            counted(s%n_halved, 'step', 'steps')//' that did not converge')
         if (s%n_island > 0) call print_line('   islands       '//islands_text(s))
         write (buffer, '(es12.6,a,es12.6)') s%time, ' of ', s%t_stop
         call print_line('   time          '//trim(buffer))
         write (buffer, '(es12.6)') s%time_step
         call print_line('   time step     '//trim(buffer)//outcome%holder)
         call print_line('   energy error  '//percent(s%energy_error))
         do i = 1, size(outcome%worst)
            call print_line('   '//outcome%worst(i)%s)
         end do
         if (s%compliant_steps > 0.0_wp .and. s%cycle > GAIN*COST*s%compliant_steps) then
            write (buffer, '(es8.1)') s%compliant_error
            call print_line('   --fast        this error in about '// &
               str(nint(s%compliant_steps))//' cycles, '// &
               str(nint(s%cycle/(COST*s%compliant_steps)))//' times as fast: --error '// &
               trim(adjustl(buffer)))
         end if
         if (s%unresolved > 0.0_wp .and. outcome%rigid) then
            call print_line('   not rigid     joints give way by '//few(s%unresolved, 2)// &
               ' of the size, or rad: masses too unlike')
         else if (s%unresolved > 0.0_wp) then
            call print_line('   not resolved  ringing of joints, about '// &
               few(s%unresolved, 2)//' of the size, or rad: see split2')
         end if
         write (buffer, '(f12.3,a)') outcome%elapsed, ' s  ('
         call print_line('   wall time     '//trim(adjustl(buffer))// &
                         rate(real(s%cycle, wp)/seconds)//' cycles/s, '// &
                         rate(s%joint_cycles/seconds)//' joint-cycles/s)')
         call print_line('   slowest cost  '//costs(s, seconds))
         if (outcome%history /= '') call print_line('   history       '//outcome%history)
         if (allocated(outcome%checkpoint)) call print_line('   checkpoint    '// &
            outcome%checkpoint)
      end associate
   end subroutine print_summary

   !> "3, in 2 groups of 120 to 4000 cycles"
   function islands_text(status) result(text)
      type(run_status_t), intent(in) :: status
      character(len=:), allocatable :: text

      text = str(status%n_island)//', all on one time step'
      if (status%n_part > 1) text = str(status%n_island)//', in '//str(status%n_part)// &
         ' groups of '//str(status%least_cycle)//' to '//str(status%cycle)//' cycles'
   end function islands_text

   !> "solver 91 %, history 7 %": shares of the wall time, the largest first
   function costs(status, seconds) result(text)
      type(run_status_t), intent(in) :: status
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text

      character(len=:), allocatable :: solver, history

      solver = 'solver '//str(nint(100*status%wall_solve/seconds))//' %'
      history = 'history '//str(nint(100*status%wall_output/seconds))//' %'
      text = solver//', '//history
      if (status%wall_output > status%wall_solve) text = history//', '//solver
   end function costs

   subroutine print_json(outcome, findings, error)
      type(outcome_t), intent(in) :: outcome
      type(finding_list_t), intent(in) :: findings
      type(error_t), intent(in), allocatable :: error

      type(finding_list_t) :: all_findings
      character(len=:), allocatable :: json
      integer :: i

      all_findings = findings
      do i = 1, outcome%status%warnings%n
         call add_finding(all_findings, outcome%status%warnings%item(i))
      end do
      if (allocated(error)) call add_finding(all_findings, error)
      json = '{'//json_member('exit_code', outcome%code)
      if (allocated(outcome%verdict)) then
         associate (s => outcome%status)
            json = json//', '//json_member('status', outcome%verdict)// &
               ', '//json_member('title', outcome%title)// &
               ', '//json_member('history', outcome%history)// &
               ', '//json_member('cycles', s%cycle)// &
               ', '//json_member('joint_cycles', s%joint_cycles)// &
               ', '//json_member('islands', s%n_island)// &
               ', '//json_member('island_groups', s%n_part)// &
               ', '//json_member('time', s%time)// &
               ', '//json_member('t_stop', s%t_stop)// &
               ', '//json_member('time_step', s%time_step)// &
               ', '//json_member('time_step_owner_kind', trim(s%owner_kind))// &
               ', '//json_member('time_step_owner', s%owner)// &
               ', '//json_member('time_step_owner_name', trim(adjustl(outcome%holder)))// &
               ', '//json_member('energy_error', s%energy_error)// &
               ', '//json_member('unresolved', s%unresolved)// &
               ', '//json_member('samples', s%n_sample)// &
               ', '//json_member('joints', s%n_joint)// &
               ', '//json_member('bodies', s%n_body)// &
               ', '//json_member('nodes', s%n_node)// &
               ', '//json_pair('worst', outcome%worst_json)// &
               ', '//json_member('wall_time', outcome%elapsed)// &
               ', '//json_member('wall_start', s%wall_start)// &
               ', '//json_member('wall_solve', s%wall_solve)// &
               ', '//json_member('wall_output', s%wall_output)
         end associate
      end if
      call print_line(json//', '//json_findings(all_findings)//'}')
   end subroutine print_json

end module kj_run_command
