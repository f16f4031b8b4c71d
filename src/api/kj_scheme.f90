!> How a scene gets from one time to the next: the one place of this folder that asks which
!> formulation runs. The others hand over the model and read the snapshot.
!> One file: the question is asked nowhere else.
module kj_scheme
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, add_finding, ERR_INPUT, SEV_WARNING
   use kj_block, only: block_of, lane_of
   use kj_model, only: model_t, joint_title, STOP_BELOW
   use kj_snapshot, only: snapshot_t, inside_t, new_snapshot
   use kj_legacy_state, only: legacy_state_t, new_legacy_state
   use kj_legacy_step, only: find_accelerations, advance
   use kj_legacy_snapshot, only: show_legacy, show_legacy_clock
   use kj_legacy_inside, only: look_inside_legacy, legacy_stiffness
   use kj_legacy_cost, only: weigh_rotations
   use kj_legacy_warnings, only: warn_costs
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_auto_stiffness, only: start_scene
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_step, only: place_node
   use kj_consistent_march, only: march_t, start_march, march, set_out, is_too_short, check_state, &
      NEVER, SPLIT2, RKMK4, COMPLIANT
   use kj_consistent_compliant_build, only: make_implicit
   use kj_consistent_islands, only: part_t, cut_scene, march_parts, gather_clock
   use kj_consistent_snapshot, only: show_consistent, show_consistent_clock
   use kj_consistent_inside, only: look_inside_consistent
   use kj_consistent_nodal_step, only: nodal_stiffness
   use kj_consistent_change, only: put_load, put_velocity, put_pose
   use kj_run_option, only: run_options_t
   implicit none
   private

   public :: scheme_t, choose_scheme, note, critical_factor, start_scheme, leaves_path, &
      plan_sample, is_over, show_clock, go_on, begin_way, end_way, finish_scheme, advance_to, &
      show, look_inside, node_place, node_moves, warn_after, NEVER
   public :: load_body, move_body, put_body, lock_place

   real(wp), parameter :: LOOSE = 1.0e-3_wp     !! loss of orthogonality to warn of [rad]
   real(wp), parameter :: LOST = 1.0e-6_wp      !! of the kinetic energy at the start, to warn of
   integer, parameter :: LOOK_WORK = 20000      !! joint-cycles between two looks of the monitor
   integer, parameter :: LEAST_LOOK = 8         !! cycles: each look takes a part of one
   real(wp), parameter :: NEAR = 1.0e-9_wp      !! of an interval: as good as there
   integer, parameter :: CHUNK = 1000           !! cycles of a host's march between two checks

   !> A scene under way
   type :: scheme_t
      logical :: legacy = .false.               !! formulation
      integer :: integrator = SPLIT2
      logical :: nodal = .false.                !! time-step rule
      logical :: islands = .false.              !! march on their own steps
      type(legacy_state_t) :: cycles            !! legacy
      ! consistent
      type(consistent_state_t) :: state
      type(march_t) :: march
      type(part_t), allocatable :: part(:)      !! parts of islands; empty: one step for all
      integer :: n_island = 0
      ! what it shows
      type(snapshot_t) :: now                   !! its clock is always right, the rest after `show`
      logical :: shown = .false.                !! all of it is right
      ! a run
      logical :: due = .false.                  !! stands at the time of a sample
      logical :: apart = .false.                !! islands stand at different times
      integer :: pause = huge(1)                !! cycle that a trace wants to look at
      integer :: n_sample = 0                   !! samples begun since t_first
      real(wp) :: t_first = 0.0_wp              !! time from which samples are counted
      real(wp) :: t_next = 0.0_wp               !! time of the next, whenever the run ends
   end type scheme_t

contains

   !> What a run was told of the formulation and its steps
   subroutine choose_scheme(options, self)
      type(run_options_t), intent(in) :: options    !! settled
      type(scheme_t), intent(inout) :: self

      self%legacy = options%formulation == 'legacy'
      self%integrator = max(SPLIT2, findloc([character(len=9) :: 'split2', 'liemid', 'rkmk4', &
         'compliant'], options%integrator, 1))
      self%march%pace%rigid = options%kn == 'inf'
      if (options%error > 0.0_wp) self%march%pace%tolerance = options%error
      if (options%turn > 0.0_wp) self%march%pace%turn = options%turn
      self%nodal = options%dt_rule == 'nodal'
      self%islands = options%islands
   end subroutine choose_scheme

   !> A finding about a scene or its run
   subroutine note(findings, severity, id, message)
      type(finding_list_t), intent(inout) :: findings
      integer, intent(in) :: severity
      character(len=*), intent(in) :: id, message

      type(error_t), allocatable :: finding

      call fail(finding, ERR_INPUT, message, id)
      finding%severity = severity
      call add_finding(findings, finding)
   end subroutine note

   !> Fraction of the critical step that a run takes
   real(wp) function critical_factor(self, model) result(factor)
      type(scheme_t), intent(in) :: self
      type(consistent_model_t), intent(in) :: model

      factor = merge(model%control%dt_factor, step_factor(model), self%legacy)
   end function critical_factor

   !> The scene at t = 0 with its forces, and what it shows.
   !>
   !> Errors: ERR_RUN as go_on, or when a joint takes its stiffness from a step that nothing limits.
   subroutine start_scheme(model, self, error)
      type(consistent_model_t), intent(inout) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call new_snapshot(model%model_t, self%now)
      if (allocated(self%part)) deallocate (self%part)
      allocate (self%part(0))
      self%n_island = 0
      self%n_sample = 0
      self%t_first = 0.0_wp
      self%t_next = 0.0_wp
      self%apart = .false.
      if (self%legacy) then
         call new_legacy_state(model%model_t, self%cycles)
         call find_accelerations(model%model_t, self%cycles, .true., error)
      else
         call start_consistent(model, self, error)
      end if
      if (allocated(error)) return
      self%shown = .false.
      call show(model, self)                    ! energies count from here
      self%due = .true.
      call plan_sample(model%model_t, self)
   end subroutine start_scheme

   !> Constants, first state, limits and ledger
   subroutine start_consistent(model, self, error)
      type(consistent_model_t), intent(inout) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call start_scene(model, self%integrator == RKMK4, self%march%pace%rigid, self%state, error)
      if (allocated(error)) return
      if (self%integrator == COMPLIANT) call make_implicit(model)
      self%march%integrator = self%integrator
      self%march%nodal = self%nodal
      self%march%factor = step_factor(model)
      self%march%most = model%control%dt_max
      if (model%control%dt_ini > 0.0_wp) self%march%first = model%control%dt_ini
      call start_march(model, self%state, self%march)
      if (self%islands) call cut_scene(model, self%march, self%n_island, self%part)
   end subroutine start_consistent

   !> The time of the next sample, once one is due. It does not look at the end of the run: a run
   !> that goes on later samples at the same times.
   pure subroutine plan_sample(model, self)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self

      associate (interval => model%control%sample, t => self%now%time)
         if (.not. self%due) return
         self%n_sample = self%n_sample + 1
         if (self%legacy) then
            self%t_next = max(t, self%t_next + interval)
         else if (interval > 0.0_wp) then
            self%t_next = self%t_first + self%n_sample*interval
         else
            self%t_next = t + self%march%limit
         end if
      end associate
   end subroutine plan_sample

   !> Whether a run stands at its end
   pure logical function is_over(model, self)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      is_over = merge(self%now%time + self%cycles%h2 > model%control%t_stop, &
         .not. self%now%time < model%control%t_stop, self%legacy) .or. is_cut_short(model, self)
   end function is_over

   !> Whether /DT/NODA/STOP ends a run; where islands march, or compliant, at a sample
   pure logical function is_cut_short(model, self)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      is_cut_short = self%cycles%ended .or. (is_too_short(model, self%march) .and. (self%due .or. &
         .not. (self%apart .or. self%integrator == COMPLIANT)))
   end function is_cut_short

   !> The time that a run marches to: of the next sample, or its end where that is as good as there
   pure real(wp) function target_time(model, self) result(t)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      associate (c => model%control)
         t = min(c%t_stop, self%t_next)
         if (.not. self%legacy .and. c%t_stop - t < NEAR*c%sample) t = c%t_stop
      end associate
   end function target_time

   !> Whether the coming steps are cut to the end of the run: a run that goes on beyond it has to
   !> start from here
   pure logical function leaves_path(model, self) result(leaves)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      leaves = .not. self%legacy .and. abs(target_time(model, self) - self%t_next) > 0.0_wp
   end function leaves_path

   !> Some cycles of a run, at most up to the next sample.
   !>
   !> Errors: ERR_RUN when the run leaves its valid range.
   subroutine go_on(model, self, error)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      logical :: arrived

      self%shown = .false.
      arrived = .false.
      if (self%legacy) then
         call cycle_on(model%model_t, self, error)
      else
         call march_on(model, self, cycles_ahead(model%model_t, self), &
            target_time(model%model_t, self), arrived, error)
      end if
      if (.not. allocated(error)) call stand(model, self, arrived)
   end subroutine go_on

   !> Where a scene stands after some cycles
   subroutine stand(model, self, arrived)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      logical, intent(in) :: arrived            !! of a march: at its target

      if (.not. self%legacy) self%due = arrived .and. (target_time(model%model_t, self) > &
         self%t_next - NEAR*self%t_next .or. .not. model%control%sample > 0.0_wp)
      call show_clock(model, self)
      call plan_sample(model%model_t, self)
   end subroutine stand

   !> go_on of a march whose steps are taken by somebody else: at most so many, which may be none.
   !> The scene does not march in parts.
   subroutine begin_way(model, self, left)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      integer, intent(out) :: left

      real(wp) :: until

      self%shown = .false.
      until = target_time(model%model_t, self)
      left = 0
      if (.not. until > self%state%time) return
      left = cycles_ahead(model%model_t, self)
      call set_out(model, until, left, self%march, self%state)
   end subroutine begin_way

   !> Errors: as go_on
   subroutine end_way(model, self, error)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      logical :: arrived

      arrived = .not. target_time(model%model_t, self) > self%state%time
      call check_state(model, self%state, error)
      if (.not. allocated(error)) call stand(model, self, arrived)
   end subroutine end_way

   !> Cycles between two looks of the monitor
   pure integer function look_cycles(model) result(n)
      type(model_t), intent(in) :: model

      n = max(LEAST_LOOK, LOOK_WORK/max(1, model%n_joint + model%n_body))
   end function look_cycles

   !> Cycles to the next look, of the monitor or of a trace
   pure integer function cycles_ahead(model, self) result(n)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      n = look_cycles(model)
      if (self%pause > self%now%cycle) n = min(n, self%pause - self%now%cycle)
   end function cycles_ahead

   !> Legacy cycles up to the next sample, the end, or the next look
   subroutine cycle_on(model, self, error)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      logical :: last
      integer :: i, n

      n = cycles_ahead(model, self)
      associate (s => self%cycles, control => model%control)
         do i = 1, n
            call advance(model, s, error)
            if (allocated(error)) return
            self%due = s%time >= self%t_next
            last = i == n .or. s%time + 1.2_wp*s%h2 > control%t_stop .or. &
               control%below_min == STOP_BELOW         ! any cycle may be the last
            call find_accelerations(model, s, self%due .or. last, error)
            if (allocated(error)) return
            if (self%due .or. s%time + s%h2 > control%t_stop .or. s%ended) exit
         end do
      end associate
   end subroutine cycle_on

   !> Some steps towards a time
   subroutine march_on(model, self, steps, t_end, arrived, error)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      integer, intent(in) :: steps              !! at most so many, of a scene that is not in parts
      real(wp), intent(in) :: t_end
      logical, intent(out) :: arrived
      type(error_t), allocatable, intent(out) :: error

      integer :: p

      if (size(self%part) == 0) then
         call march(model, t_end, steps, self%march, self%state, arrived)
         call check_state(model, self%state, error)
         return
      end if
      call march_parts(t_end, [(look_cycles(self%part(p)%model%model_t), p=1, size(self%part))], &
         model%control%threads, self%part, arrived)
      self%apart = .not. arrived
      do p = 1, size(self%part)
         call check_state(self%part(p)%model, self%part(p)%state, error)
         if (allocated(error)) return
      end do
      call gather_clock(self%part, self%state, self%march)
   end subroutine march_on

   !> After the last sample of a run: a legacy cycle that was begun ends
   subroutine finish_scheme(model, self, error)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (.not. self%legacy) return
      call advance(model%model_t, self%cycles, error)
      call show_clock(model, self)
   end subroutine finish_scheme

   !> March to a time, legacy to the first cycle at or beyond it; or, to NEVER, n steps
   subroutine advance_to(until, n, model, self, error)
      real(wp), intent(in) :: until
      integer, intent(in) :: n
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      integer :: left, cycle
      logical :: arrived

      left = n
      arrived = .not. self%now%time < until
      do while (left > 0 .and. .not. (arrived .or. allocated(error)))
         cycle = self%state%cycle
         if (self%legacy) then
            call take_cycle(model%model_t, self%cycles, error)
            arrived = .not. self%cycles%time < until
         else if (self%integrator == COMPLIANT .and. .not. until < NEVER) then
            call march_on(model, self, 1, self%state%time + self%march%limit, arrived, error)
            arrived = .false.
         else
            call march_on(model, self, min(left, CHUNK), until, arrived, error)
         end if
         if (.not. until < NEVER) left = left - max(1, self%state%cycle - cycle)
      end do
      self%shown = .false.
      call show_clock(model, self)
   end subroutine advance_to

   !> A cycle from accelerations to accelerations, so that everything is known in between
   subroutine take_cycle(model, state, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      call advance(model, state, error)
      if (.not. allocated(error)) call find_accelerations(model, state, .true., error)
   end subroutine take_cycle

   !> Cycle, time, step and who limits it
   subroutine show_clock(model, self)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self

      if (self%legacy) then
         call show_legacy_clock(model%model_t, self%cycles, self%now)
      else
         call show_consistent_clock(model, self%march, self%state, self%now)
      end if
   end subroutine show_clock

   !> Make the whole snapshot right; islands must stand at the same time
   subroutine show(model, self)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self

      if (self%shown) return
      if (self%legacy) then
         call show_legacy(model%model_t, self%cycles, self%now)
         call weigh_rotations(model%model_t, self%cycles)
      else
         call show_consistent(model, self%march, self%state, self%part, self%now)
      end if
      self%shown = .true.
   end subroutine show

   !> Place of any node now, W. Under legacy only those move that joints, loads or the history read.
   pure function node_place(model, self, node) result(x)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self
      integer, intent(in) :: node
      real(wp) :: x(3)

      if (self%legacy) then
         x = self%cycles%world%x(node, :)
      else
         x = place_node(model, self%state, node)
      end if
   end function node_place

   !> Whether node_place follows a node
   pure logical function node_moves(model, self, node) result(moves)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self
      integer, intent(in) :: node

      moves = .true.
      if (self%legacy) moves = node <= model%n_lead .or. any(self%cycles%crew%node == node)
   end function node_moves

   !> What an element does inside
   subroutine look_inside(model, self, element, frame, inside)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self
      integer, intent(in) :: element            !! index into model%joint
      real(wp), intent(in) :: frame(9)          !! that the snapshot shows
      type(inside_t), intent(out) :: inside

      real(wp) :: kn(model%n_lead), kr(model%n_lead)
      integer :: e

      inside%nodal = self%legacy .or. self%nodal
      associate (ref => model%joint(element))
         if (self%legacy) then
            call look_inside_legacy(model%model_t, self%cycles, element, inside)
         else
            call look_inside_consistent(model, self%state, element, frame, inside)
            if (.not. self%nodal) then
               if (allocated(self%march%bound%limit)) inside%bound = &
                  self%march%bound%limit(model%batch(ref%batch)%first + ref%place)
               return
            end if
            call nodal_stiffness(model, self%state, kn, kr)
         end if
         do e = 1, 2
            associate (i => model%lead(ref%node(e)))
               if (self%legacy) call legacy_stiffness(model%model_t, self%cycles, i, kn(i), kr(i))
               if (self%now%mass(i) > 0.0_wp .and. kn(i) > 0.0_wp) &
                  inside%bound = min(inside%bound, sqrt(2.0_wp*self%now%mass(i)/kn(i)))
               if (self%now%inertia(i) > 0.0_wp .and. kr(i) > 0.0_wp) &
                  inside%bound = min(inside%bound, sqrt(2.0_wp*self%now%inertia(i)/kr(i)))
            end associate
         end do
      end associate
   end subroutine look_inside

   !> What showed during a run
   subroutine warn_after(model, self, findings)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self
      type(finding_list_t), intent(inout) :: findings

      character(len=8) :: buffer

      if (is_cut_short(model, self)) call note(findings, SEV_WARNING, 'KJ-9303', &
         'the time step fell below the least of /DT/NODA/STOP: the run ends before its time')
      if (self%legacy) call warn_costs(model, self%cycles, findings)
      if (self%legacy) return
      call warn_of_loss(self, findings)
      if (self%now%loosest > LOOSE) then
         write (buffer, '(es8.1)') self%now%loosest
         call note(findings, SEV_WARNING, 'KJ-9216', 'the frame of joint '// &
            joint_title(model, self%now%loosest_joint)// &
            ' lost its orthogonality by up to '//trim(adjustl(buffer))//' rad')
      end if
   end subroutine warn_after

   !> Velocities at the start that the joints do not allow, under compliant
   subroutine warn_of_loss(self, findings)
      type(scheme_t), intent(in) :: self
      type(finding_list_t), intent(inout) :: findings

      character(len=40) :: text

      if (.not. allocated(self%state%compliant)) return
      associate (c => self%state%compliant)
         if (.not. c%loss > LOST*c%kinetic) return
         write (text, '(g0.4, a, g0.4)') c%loss, ' of ', c%kinetic
      end associate
      call note(findings, SEV_WARNING, 'KJ-9047', 'velocities at the start do not fit the '// &
         'joints: of the kinetic energy '//trim(text)//' was lost')
   end subroutine warn_of_loss

   !> Force and moment of the host on a body, W, until they are set anew
   subroutine load_body(b, force, moment, model, self)
      integer, intent(in) :: b
      real(wp), intent(in) :: force(3), moment(3)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self

      self%shown = .false.
      if (self%legacy) then
         associate (s => self%cycles, n => model%n_lead)
            if (.not. allocated(s%f_host)) allocate (s%f_host(n, 3), s%m_host(n, 3), source=0.0_wp)
            s%f_host(b, :) = force
            s%m_host(b, :) = moment
         end associate
      else
         call put_load(model, b, force, moment, self%state)
      end if
   end subroutine load_body

   !> Velocities of a body, W
   subroutine move_body(b, velocity, omega, model, self)
      integer, intent(in) :: b
      real(wp), intent(in) :: velocity(3), omega(3)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self

      self%shown = .false.
      if (self%legacy) then
         associate (s => self%cycles)
            s%v(b, :) = velocity
            s%world%w(b, :) = omega
            s%fastest = max(s%fastest, dot_product(omega, omega))
         end associate
      else
         call put_velocity(model, b, velocity, omega, self%state, self%march)
      end if
   end subroutine move_body

   !> Place of a body and its turn since the start, W. Errors: ERR_INPUT
   subroutine put_body(b, position, attitude, model, self, error)
      integer, intent(in) :: b
      real(wp), intent(in) :: position(3), attitude(4)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (self%legacy) then
         call fail(error, ERR_INPUT, &
            'the legacy formulation sums up its frames: a body cannot be put elsewhere')
      else if (.not. norm2(attitude) > 0.0_wp) then
         call fail(error, ERR_INPUT, 'the quaternion is zero')
      else
         self%shown = .false.
         call put_pose(model, b, position, attitude, self%state, self%march)
      end if
   end subroutine put_body

   !> Joint `place` of limited batch b locks at t_lock, and stays so
   subroutine lock_place(b, place, t_lock, model, self)
      integer, intent(in) :: b, place
      real(wp), intent(in) :: t_lock
      type(consistent_model_t), intent(inout) :: model
      type(scheme_t), intent(inout) :: self

      model%batch(b)%limit%t_lock(place) = t_lock
      model%batch(b)%limit%t_free(place) = huge(1.0_wp)
      self%shown = .false.
      if (self%legacy) then
         self%cycles%joint(b)%limit(block_of(place))%locked(lane_of(place)) = 0.0_wp
      else
         self%state%joint(b)%limit(block_of(place))%locked(lane_of(place)) = 0.0_wp
         call start_march(model, self%state, self%march)
      end if
   end subroutine lock_place

end module kj_scheme
