!> The run: march, samples, outcome.
submodule (kjoint) kjoint_run
   use kj_error, only: fail, str, add_finding
   use kj_system, only: wall_clock
   use kj_model, only: STOP_BELOW
   use kj_legacy_warnings, only: warn_large_turn
   use kj_legacy_state, only: new_legacy_state, OWNER_JOINT
   use kj_pages, only: place_state, place_consistent_state
   use kj_legacy_step, only: find_accelerations, advance
   use kj_energy, only: balance_t, balance_of
   use kj_sample, only: sample_row
   use kj_consistent_auto_stiffness, only: start_scene
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_march, only: start_march, march, balance_ledger, full_turn, SPLIT2, LIEMID, &
      RKMK4
   use kj_consistent_snapshot, only: publish
   use kj_consistent_islands, only: cut_scene, march_parts, gather_parts, gather_clock, joint_cycles
   implicit none

   real(wp), parameter :: LOOSE = 1.0e-3_wp     !! loss of orthogonality to warn of [rad]
   integer, parameter :: TICK_WORK = 20000      !! joint-cycles between two looks of the monitor
   integer, parameter :: LEAST_TICK = 8         !! cycles: each look takes a part of one
   character(len=8), parameter :: OWNER_NAME(0:3) = &
      ['none    ', 'node    ', 'body    ', 'joint   ']

contains

   module procedure run_simulation
      type(error_t), allocatable :: sink_error
      real(wp) :: clock
      logical :: stop, ignored

      if (.not. sim%loaded) then
         call fail(error, ERR_INPUT, 'no deck is loaded')
         return
      end if
      sim%started = .false.
      call new_legacy_state(sim%model%model_t, sim%state)
      call place_state(sim%model, sim%state)
      call sink%open(sim%history, error)
      if (allocated(error)) return
      clock = wall_clock()
      if (sim%legacy) then
         call run_legacy(sim, sink, monitor, status, clock, stop, error)
      else
         call run_consistent(sim, sink, monitor, status, clock, stop, error)
      end if
      call tell(sim, status)
      if (sim%state%turn_body > 0) call warn_large_turn(sim%model%model_t, sqrt(sim%state%turn2), &
         sim%state%turn_body, status%warnings)
      if (sim%state%ortho_worst > LOOSE) &
         call warn_loose_frame(sim%model%model_t, sim%state, status%warnings)
      status%wall_solve = status%wall_solve + wall_clock() - clock
      clock = wall_clock()
      call monitor%tick(status, ignored)
      call end_history(sink, stop, status%cycle, error, sink_error)
      if (allocated(sim%row)) deallocate (sim%row)
      status%wall_output = status%wall_output + wall_clock() - clock
   end procedure run_simulation

   !> Cycles between two looks of the monitor
   pure integer function tick_cycles(model) result(n)
      type(model_t), intent(in) :: model

      n = max(LEAST_TICK, TICK_WORK/max(1, model%n_joint + model%n_body))
   end function tick_cycles

   !> The legacy march: cycles while t <= Tstop, samples at cycles
   subroutine run_legacy(sim, sink, monitor, status, clock, stop, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      class(monitor_t), intent(inout) :: monitor
      type(run_status_t), intent(inout) :: status
      real(wp), intent(inout) :: clock
      logical, intent(out) :: stop               !! the monitor ended the run
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: t_next
      logical :: due, last

      t_next = 0.0_wp
      stop = .false.
      associate (state => sim%state, control => sim%model%control)
         do
            due = state%time >= t_next
            last = state%time + 1.2_wp*state%h2 > control%t_stop .or. stop .or. &
               control%below_min == STOP_BELOW         ! any cycle may be the last
            call find_accelerations(sim%model%model_t, state, due .or. last, error)
            if (allocated(error)) return
            if (state%cycle == 0) call start_energy(sim)
            last = state%time + state%h2 > control%t_stop .or. stop .or. state%ended
            if (due .or. last) then
               call add_row(sim, sink, .not. due, clock, status, error)
               t_next = min(control%t_stop, max(state%time, t_next + control%sample))
            end if
            if (allocated(error)) return
            call advance(sim%model%model_t, state, error)
            if (last .or. allocated(error)) return
            if (modulo(state%cycle, tick_cycles(sim%model%model_t)) > 0) cycle
            call tell(sim, status)
            call monitor%tick(status, stop)
         end do
      end associate
   end subroutine run_legacy

   !> The consistent march: each sample interval in equal steps, the end at Tstop. Islands stand at
   !> the same time at samples alone: stopped between them, their history ends at the last one.
   subroutine run_consistent(sim, sink, monitor, status, clock, stop, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      class(monitor_t), intent(inout) :: monitor
      type(run_status_t), intent(inout) :: status
      real(wp), intent(inout) :: clock
      logical, intent(out) :: stop
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: t_end
      integer :: sample
      logical :: arrived

      stop = .false.
      sample = 0
      call start_consistent(sim, error)
      if (allocated(error)) return
      sim%n_island = 0
      if (allocated(sim%part)) deallocate (sim%part)
      allocate (sim%part(0))
      if (sim%options%islands) &
         call cut_scene(sim%model, sim%march, sim%n_island, sim%part)
      call add_row(sim, sink, .false., clock, status, error)
      associate (cs => sim%c_state, control => sim%model%control)
         do while (cs%time < control%t_stop .and. .not. allocated(error))
            sample = sample + 1
            t_end = min(control%t_stop, sample*control%sample)
            if (control%sample <= 0.0_wp) t_end = min(control%t_stop, cs%time + sim%march%limit)
            if (control%t_stop - t_end < 1.0e-9_wp*control%sample) t_end = control%t_stop
            arrived = .false.
            do while (.not. (arrived .or. stop))
               call march_on(sim, t_end, arrived, error)
               if (allocated(error)) return
               sim%state%cycle = cs%cycle
               sim%state%time = cs%time
               sim%state%h2 = cs%h
               call tell(sim, status)
               call monitor%tick(status, stop)
            end do
            if (size(sim%part) > 0 .and. .not. arrived) return
            call add_row(sim, sink, .not. arrived .or. &
               (t_end < sample*control%sample*(1.0_wp - 1.0e-9_wp) .and. control%sample > 0.0_wp), &
               clock, status, error)
            if (stop) return
         end do
      end associate
   end subroutine run_consistent

   !> Some steps towards a time.
   !>
   !> Errors: those of check_state
   subroutine march_on(sim, t_end, arrived, error)
      type(simulation_t), intent(inout) :: sim
      real(wp), intent(in) :: t_end
      logical, intent(out) :: arrived
      type(error_t), allocatable, intent(out) :: error

      integer :: p

      if (size(sim%part) == 0) then
         call march(sim%model, t_end, tick_cycles(sim%model%model_t), sim%march, sim%c_state, &
            arrived)
         call check_state(sim%model, sim%c_state, error)
         return
      end if
      call march_parts(t_end, [(tick_cycles(sim%part(p)%model%model_t), p=1, size(sim%part))], &
         sim%model%control%threads, sim%part, arrived)
      do p = 1, size(sim%part)
         associate (part => sim%part(p))
            call check_state(part%model, part%state, error)
         end associate
         if (allocated(error)) return
      end do
      call gather_clock(sim%part, sim%c_state, sim%march)
   end subroutine march_on

   !> Constants, first state, limits and ledger of the consistent formulation
   subroutine start_consistent(sim, error)
      type(simulation_t), intent(inout) :: sim
      type(error_t), allocatable, intent(out) :: error

      call start_scene(sim%model, sim%options%integrator == 'rkmk4', sim%c_state, &
         error)
      if (allocated(error)) return
      call place_consistent_state(sim%model, sim%c_state)
      sim%march%integrator = SPLIT2
      if (sim%options%integrator == 'liemid') sim%march%integrator = LIEMID
      if (sim%options%integrator == 'rkmk4') sim%march%integrator = RKMK4
      sim%march%nodal = sim%options%dt_rule == 'nodal'
      sim%march%factor = step_factor(sim%model)
      sim%march%most = sim%model%control%dt_max
      if (sim%model%control%dt_ini > 0.0_wp) sim%march%first = sim%model%control%dt_ini
      call start_march(sim%model, sim%c_state, sim%march)
      if (.not. allocated(sim%state%ortho)) allocate (sim%state%ortho(sim%model%n_element), &
         source=0.0_wp)
   end subroutine start_consistent

   !> The run is still where the formulation holds
   subroutine check_state(model, state, error)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error

      integer :: j, at

      ! counted, as gfortran takes all() one by one
      if (count(abs(state%v) <= huge(1.0_wp)) < size(state%v) .or. &
         count(abs(state%l) <= huge(1.0_wp)) < size(state%l)) then
         call fail(error, ERR_RUN, 'the solution is not finite any more in cycle '// &
            str(state%cycle))
         return
      end if
      at = full_turn(model, state)
      if (at == 0) return
      do j = 1, model%n_element
         if (model%batch(model%joint(j)%batch)%first + model%joint(j)%place /= at) cycle
         call fail(error, ERR_RUN, 'joint '//str(model%joint(j)%id)// &
            ' has come to a whole turn: '// &
            'three free rotations with springs or a length end there (cycle '// &
               str(state%cycle)//')')
      end do
   end subroutine check_state

   !> Close the sink with the outcome; an error of the run goes before one of the sink
   subroutine end_history(sink, stopped, cycles, error, sink_error)
      class(sink_t), intent(inout) :: sink
      logical, intent(in) :: stopped
      integer, intent(in) :: cycles
      type(error_t), allocatable, intent(inout) :: error
      type(error_t), allocatable, intent(out) :: sink_error

      if (allocated(error)) then
         call sink%close('ERROR TERMINATION: '//error%message, cycles, error%code, sink_error)
      else if (stopped) then
         call sink%close('STOPPED BY USER', cycles, 130, sink_error)
      else
         call sink%close('NORMAL TERMINATION', cycles, 0, sink_error)
      end if
      if (.not. allocated(error) .and. allocated(sink_error)) call move_alloc(sink_error, error)
   end subroutine end_history

   !> After a run: the axes of a joint have turned against each other or against their body
   subroutine warn_loose_frame(model, state, findings)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(finding_list_t), intent(inout) :: findings

      type(error_t), allocatable :: finding
      character(len=8) :: buffer

      write (buffer, '(es8.1)') state%ortho_worst
      call fail(finding, ERR_INPUT, 'the frame of joint '// &
         str(model%joint(state%ortho_joint)%id)// &
         ' lost its orthogonality by up to '//trim(adjustl(buffer))//' rad', 'KJ-9216')
      finding%severity = SEV_WARNING
      call add_finding(findings, finding)
   end subroutine warn_loose_frame

   !> Sample the state into the sink; watches the energy limit
   subroutine add_row(sim, sink, final, clock, status, error)
      type(simulation_t), intent(inout) :: sim
      class(sink_t), intent(inout) :: sink
      logical, intent(in) :: final
      real(wp), intent(inout) :: clock           !! when the solver last had the processor
      type(run_status_t), intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error

      real(wp), pointer, contiguous :: row(:)
      real(wp) :: now

      now = wall_clock()
      status%wall_solve = status%wall_solve + now - clock
      if (.not. sim%legacy) then
         if (size(sim%part) > 0) then
            call gather_parts(sim%model, sim%part, sim%c_state, sim%march)
         else
            call balance_ledger(sim%model, sim%c_state)
         end if
         call publish(sim%model, sim%march, sim%c_state, sim%state)
      end if
      call sink%begin_row(row)
      if (associated(row)) then
         call sample_row(sim%model%model_t, sim%state, sim%history, final, sim%sampler, row, error)
         if (.not. allocated(error)) call sink%end_row(error)
      else
         if (.not. allocated(sim%row)) allocate (sim%row(sim%history%n_value))
         call sample_row(sim%model%model_t, sim%state, sim%history, final, sim%sampler, sim%row, &
            error)
         if (.not. allocated(error)) call sink%put(sim%row, error)
      end if
      clock = wall_clock()
      status%wall_output = status%wall_output + clock - now
      status%n_sample = status%n_sample + 1
      if (allocated(error)) return
      call tell(sim, status)
      if (sim%options%energy_limit < 0.0_wp) return
      if (100.0_wp*abs(status%energy_error) > sim%options%energy_limit) call fail(error, ERR_RUN, &
         'the energy error passed its limit in cycle '//str(sim%state%cycle))
   end subroutine add_row

   !> E0 of the energy error: the energy at t = 0, less the work that cycle 0 already holds
   subroutine start_energy(sim)
      type(simulation_t), intent(inout) :: sim

      type(balance_t) :: b

      b = balance_of(sim%model%model_t, sim%state)
      sim%state%energy0 = b%kinetic_trans + b%kinetic_rot + b%internal - sim%state%work
   end subroutine start_energy

   !> Renew the status
   subroutine tell(sim, status)
      type(simulation_t), intent(in) :: sim
      type(run_status_t), intent(inout) :: status

      status%cycle = sim%state%cycle
      status%time = sim%state%time
      status%t_stop = sim%model%control%t_stop
      status%time_step = sim%state%h2
      status%owner_kind = OWNER_NAME(sim%state%owner_kind)
      status%owner = 0
      if (sim%state%owner_kind > 0) then
         if (sim%state%owner_kind == OWNER_JOINT) then
            status%owner = sim%model%joint(sim%state%owner)%id
         else if (sim%state%owner <= sim%model%n_body) then
            status%owner = sim%model%body_id(sim%state%owner)
         else
            status%owner = sim%model%node_id(sim%state%owner)
         end if
      end if
      associate (b => sim%sampler%balance)
         status%kinetic = b%kinetic_trans + b%kinetic_rot
         status%internal = b%internal
      end associate
      status%energy_error = sim%sampler%energy_error
      status%work = sim%state%work
      status%n_joint = sim%model%n_joint
      status%n_spring = sim%model%n_spring
      status%n_body = sim%model%n_body
      status%n_node = sim%model%n_node
      status%print_every = sim%model%control%print_every
      status%joint_cycles = real(status%cycle, wp)*sim%model%n_joint
      status%least_cycle = status%cycle
      status%n_island = sim%n_island
      if (.not. allocated(sim%part)) return
      if (size(sim%part) == 0) return
      status%n_part = size(sim%part)
      status%joint_cycles = joint_cycles(sim%part)
      status%least_cycle = minval(sim%part%state%cycle)
   end subroutine tell

end submodule kjoint_run
