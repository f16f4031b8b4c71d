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
   use kj_schedule, only: DO_JOINTS, DO_PART, DO_LEADS
   use kj_skew, only: move_skews
   use kj_legacy_force, only: add_joint_forces
   use kj_lead_map, only: sum_part
   use kj_legacy_load, only: is_loaded, add_cloads, turn_loads, find_gravity, &
      hold_conditions, impose_motion
   use kj_legacy_leads, only: gather, gather_and_accelerate, accelerate, accelerate_again
   use kj_legacy_body, only: solve_conditioned, move_leads, move_secondaries, check_turns
   use kj_legacy_time_step, only: choose_step
   use kj_legacy_auto_stiffness, only: set_blocking
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
      if (is_loaded(model, state)) then
         call in_pieces(do_joints_of, state%plan%stage(1)%shares, model, state)
         call in_pieces(gather, state%team%leads, model, state)
         call add_cloads(model, state)
         call add_host_loads(state)
         call in_pieces(accelerate, state%team%leads, model, state)
      else
         if (state%behind) call in_pieces(do_first, state%plan%stage(0)%shares, model, state)
         call in_pieces(do_all_of, state%plan%stage(1)%shares, model, state)
         call in_pieces(do_late, state%plan%stage(2)%shares, model, state)
         state%behind = .false.
      end if
      call solve_conditioned(model, state)
      call choose_step(model, state)
      call check_step(model, state, error)
      if (.not. allocated(error)) call set_blocking(model, state, error)
      state%work = state%work + state%power*state%h2
      if (any(model%control%below_min == [SCALE_MASS, SCALE_MASS_NEXT])) &
         call in_pieces(accelerate_again, state%team%leads, model, state)
      do i = 1, size(state%field)
         state%work = state%work + sum(state%field(i)%power)*state%h1
      end do
      call hold_conditions(model, state)
      call impose_motion(model, state)
   end subroutine find_accelerations

   !> Move everything to t(n + 1): at once, or in the next find_accelerations, where nothing but
   !> joints looks at nodes before.
   !>
   !> Errors: ERR_RUN when a body turns too far in a step.
   subroutine advance(model, state, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      call check_turns(model, state, error)
      state%behind = .not. is_loaded(model, state) .and. size(model%motion) == 0 .and. &
         size(model%skews%needed) == 0
      if (.not. state%behind) call in_pieces(move, state%team%leads, model, state)
      do i = 1, size(model%motion)
         state%motion_turn(i, :) = state%motion_turn(i, :) + &
            state%h2*state%world%w(model%motion(i)%lead, :)
      end do
      call turn_loads(model, state)
      state%cycle = state%cycle + 1
      state%time = state%time + state%h2
   end subroutine advance

   !> Joints at t(n), from state%world, time, h1 and h12: frames, forces and state of all joints;
   !> f, m, kn and kr are their sums over the leads, and nothing else
   subroutine find_joint_forces(model, state, sampling)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep the rates, too

      call ready_joints(model, state, sampling)
      call in_pieces(do_joints_of, state%plan%stage(1)%shares, model, state)
      call in_pieces(gather, state%team%leads, model, state)
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
   subroutine in_pieces(stage, shares, model, state)
      procedure(stage_i) :: stage
      integer, intent(in) :: shares(0:)      !! pieces up to the end of each share
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      integer :: share, piece

      if (state%team%threads == 1) then
         do piece = 1, shares(1)
            call stage(model, state, piece)
         end do
         return
      end if
      !$omp parallel do schedule(dynamic, 1) num_threads(state%team%threads) private(piece)
      do share = 1, state%team%shares
         do piece = shares(share - 1) + 1, shares(share)
            call stage(model, state, piece)
         end do
      end do
   end subroutine in_pieces

   !> Leads that joints of several shares wait for
   subroutine do_first(model, state, task)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: task

      call move(model, state, state%plan%stage(0)%item(task))
   end subroutine do_first

   !> A task of the stage that most are in
   subroutine do_all_of(model, state, task)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: task

      if (state%plan%stage(1)%kind(task) == DO_LEADS) then
         if (state%plan%stage(1)%round(task) > 0) then
            call gather_and_accelerate(model, state, state%plan%stage(1)%item(task))
         else if (state%behind) then
            call move(model, state, state%plan%stage(1)%item(task))
         end if
      else
         call do_joints_of(model, state, task)
      end if
   end subroutine do_all_of

   !> The same but for leads: joints and parts of hubs
   subroutine do_joints_of(model, state, task)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: task

      integer :: b

      associate (item => state%plan%stage(1)%item(task), joint => state%team%joint)
         select case (state%plan%stage(1)%kind(task))
         case (DO_JOINTS)
            b = joint(1, item)
            call add_joint_forces(model%batch(b), model%curves, state%world, state%h1, &
               state%sampling, joint(2, item), joint(3, item), state%joint(b), state%wrench)
         case (DO_PART)
            call sum_part(model%map, state%wrench, state%plan%hub(item), item, &
               state%part(:, item))
         end select
      end associate
   end subroutine do_joints_of

   !> Leads that had to wait for joints of several shares
   subroutine do_late(model, state, task)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: task

      call gather_and_accelerate(model, state, state%plan%stage(2)%item(task))
   end subroutine do_late

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

      if (state%h2 > 0.0_wp .and. ieee_is_finite(state%h2) .and. all(state%finite) .and. &
         all(ieee_is_finite(state%al(model%bcs%lead, 1)))) return
      call fail(error, ERR_RUN, 'the solution is not finite any more in cycle '// &
         str(state%cycle)// &
         ' (the nodal time step is no bound: try a smaller --dt-scale)')
   end subroutine check_step

end module kj_legacy_step
