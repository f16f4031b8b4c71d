!> One cycle of the legacy scheme, in two halves: up to the accelerations at t(n), where samples are
!> taken, and the motion to t(n + 1).
!> Source: docs/theory/legacy.md 1.2.
module kj_legacy_step
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_model, only: model_t, SCALE_MASS, SCALE_MASS_NEXT
   use kj_legacy_state, only: legacy_state_t
   use kj_block, only: BLOCK
   use kj_skew, only: move_skews
   use kj_joint_batch, only: is_spring
   use kj_legacy_force, only: add_joint_forces
   use kj_legacy_spring, only: add_spring_forces
   use kj_team, only: next_cycle, team_clock
   use kj_lead_map, only: sum_hubs
   use kj_legacy_load, only: is_loaded, add_cloads, turn_loads, find_gravity, &
      hold_conditions, impose_motion
   use kj_legacy_leads, only: gather, gather_and_accelerate, accelerate, accelerate_again
   use kj_legacy_body, only: solve_conditioned, move_leads, move_secondaries, check_turns
   use kj_legacy_time_step, only: choose_step, line_rule
   use kj_legacy_auto_stiffness, only: set_blocking
   use kj_legacy_cost, only: weigh_spins
   use kj_legacy_warnings, only: joint_of_bad_curve
   implicit none
   private

   public :: find_accelerations, advance, find_joint_forces

   abstract interface
      !> A stage of the cycle for one piece of the joints or leads (kj_schedule)
      subroutine stage_i(model, state, piece)
         import :: model_t, legacy_state_t
         type(model_t), intent(in) :: model
         type(legacy_state_t), intent(inout) :: state
         integer, intent(in) :: piece
      end subroutine stage_i
   end interface

contains

   !> Cycle n up to the accelerations: everything at t(n) is known, h2 is chosen.
   !>
   !> Errors: ERR_RUN when the time step is not a positive number.
   subroutine find_accelerations(model, state, sampling, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep what only samples need
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      state%h1 = state%h2
      call ready_joints(model, state, sampling)
      call find_gravity(model, state)
      call do_joints(model, state)
      if (is_loaded(model, state)) then
         call for_leads(gather, model, state)
         call add_cloads(model, state)
         call add_host_loads(state)
         call for_leads(accelerate, model, state)
      else
         call for_leads(gather_and_accelerate, model, state)
      end if
      call solve_conditioned(model, state)
      call choose_step(model, state)
      call check_step(model, state, error)
      if (.not. allocated(error)) call set_blocking(model, state, error)
      state%work = state%work + state%power*state%h2
      if (any(model%control%below_min == [SCALE_MASS, SCALE_MASS_NEXT])) &
         call for_leads(accelerate_again, model, state)
      do i = 1, size(state%field)
         state%work = state%work + sum(state%field(i)%power)*state%h1
      end do
      call hold_conditions(model, state)
      call impose_motion(model, state)
   end subroutine find_accelerations

   !> Move everything to t(n + 1).
   !>
   !> Errors: ERR_RUN when a body turns too far in a step.
   subroutine advance(model, state, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      call next_cycle(state%team, state%trial)
      call check_turns(model, state, error)
      call weigh_spins(model, state)
      call for_leads(move, model, state)
      do i = 1, size(model%motion)
         state%motion_turn(i, :) = state%motion_turn(i, :) + &
            state%h2*state%world%w(model%motion(i)%lead, :)
      end do
      call turn_loads(model, state)
      state%cycle = min(state%cycle, huge(state%cycle) - 1) + 1     ! no more can be counted
      state%time = state%time + state%h2
   end subroutine advance

   !> Joints at t(n), from state%world, time, h1 and h12: frames, forces and state of all joints;
   !> f, m, kn and kr are their sums over the leads, and nothing else
   subroutine find_joint_forces(model, state, sampling)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep the rates, too

      call ready_joints(model, state, sampling)
      call do_joints(model, state)
      call for_leads(gather, model, state)
   end subroutine find_joint_forces

   !> What joints look at
   subroutine ready_joints(model, state, sampling)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep the rates, too

      call move_skews(model%skews, state%world%x, state%world%skew)
      state%world%time = state%time
      state%world%h12 = state%h12
      state%sampling = sampling
   end subroutine ready_joints

   !> Forces and moments of an embedding host on the leads, W, and their power
   subroutine add_host_loads(state)
      type(legacy_state_t), intent(inout) :: state

      integer :: n

      if (.not. allocated(state%f_host)) return
      n = size(state%f_host, 1)
      state%f_own = state%f_own + state%f_host
      state%m_own = state%m_own + state%m_host
      state%power = state%power + sum(state%f_host*state%v(:n, :)) + &
         sum(state%m_host*state%world%w)
   end subroutine add_host_loads

   !> Do a stage piece by piece: in threads, or without them. Even a team of one thread costs a
   !> microsecond, more than the stage of a few joints.
   subroutine in_pieces(stage, pieces, model, state)
      procedure(stage_i) :: stage
      integer, intent(in) :: pieces
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: started
      integer :: piece

      started = team_clock(state%team)
      if (state%trial%threads == 1) then
         do piece = 1, pieces
            call stage(model, state, piece)
         end do
      else
         !$omp parallel do schedule(dynamic, 1) num_threads(state%trial%threads)
         do piece = 1, pieces
            call stage(model, state, piece)
         end do
      end if
      state%trial%spent = state%trial%spent + (team_clock(state%team) - started)
   end subroutine in_pieces

   !> A stage for all leads
   subroutine for_leads(stage, model, state)
      procedure(stage_i) :: stage
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      call in_pieces(stage, size(state%team%lead, 2), model, state)
   end subroutine for_leads

   !> Forces of all joints, and the sums of hubs
   subroutine do_joints(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      call in_pieces(do_piece, size(state%team%joint, 2), model, state)
      call sum_hubs(model%map, state%trial%threads, state%wrench, state%part)
   end subroutine do_joints

   subroutine do_piece(model, state, piece)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: piece

      associate (joint => state%team%joint(:, piece))
         if (is_spring(model%batch(joint(1)))) then
            call add_spring_forces(model%batch(joint(1)), model%curves, state%world, state%v, &
               state%mass, state%inertia, line_rule(model, state), state%h1, state%sampling, &
               joint(2), joint(3), state%joint(joint(1)), state%wrench)
            return
         end if
         call add_joint_forces(model%batch(joint(1)), model%curves, state%world, state%h1, &
            state%sampling, joint(2), joint(3), state%joint(joint(1)), state%wrench)
      end associate
   end subroutine do_piece

   !> New velocities and positions of bodies, their nodes and free nodes
   subroutine move(model, state, piece)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: piece

      integer :: lo, hi

      associate (unused => model%n_node)
      end associate
      do lo = state%team%lead(1, piece), state%team%lead(2, piece), BLOCK
         hi = min(lo + BLOCK - 1, state%team%lead(2, piece))
         call move_secondaries(lo, hi, state)
         call move_leads(state%placed(piece), lo, hi, state)
      end do
   end subroutine move

   subroutine check_step(model, state, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error

      logical :: finite
      integer :: i, joint

      finite = state%h2 > 0.0_wp .and. ieee_is_finite(state%h2) .and. all(state%finite)
      do i = 1, size(model%bcs)
         finite = finite .and. ieee_is_finite(state%al(model%bcs(i)%lead, 1))
      end do
      if (finite) return
      call fail(error, ERR_RUN, 'the solution is not finite any more in cycle '//str(state%cycle))
      error%hint = 'the nodal time step is no bound: try a smaller --dt-scale'
      joint = joint_of_bad_curve(model)
      if (joint > 0) error%hint = 'joint '//str(joint)//' has a stiffness curve that the '// &
         'legacy scheme cannot bear, see the warning: run the consistent formulation'
   end subroutine check_step

end module kj_legacy_step
