!> One cycle of the legacy scheme, in two halves: up to the accelerations at t(n), where samples are
!> taken, and the motion to t(n + 1).
!> Source: legacy_scheme.md 1.2.
module kj_step
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_model, only: model_t, SCALE_MASS, SCALE_MASS_NEXT
   use kj_state, only: state_t, EPS20
   use kj_team, only: GRAIN
   use kj_gravity, only: add_accelerations
   use kj_skew, only: move_skews
   use kj_joint_force, only: add_joint_forces
   use kj_assembly, only: gather_wrenches
   use kj_load, only: add_cloads, find_gravity, hold_conditions, impose_motion
   use kj_body, only: turn_bodies, solve_conditioned, linear_accelerations, move_leads, &
      move_secondaries, check_turns
   use kj_time_step, only: choose_step, least_ratio
   use kj_blocking, only: set_blocking
   implicit none
   private

   public :: find_accelerations, advance, find_joint_forces

   abstract interface
      !> A stage of the cycle for one piece of the joints or leads (kj_team)
      subroutine stage_i(model, state, piece)
         import :: model_t, state_t
         type(model_t), intent(in) :: model
         type(state_t), intent(inout) :: state
         integer, intent(in) :: piece
      end subroutine stage_i
   end interface

contains

   !> Cycle n up to the accelerations: everything at t(n) is known, h2 is chosen.
   !>
   !> Errors: ERR_RUN when the time step is not a positive number.
   subroutine find_accelerations(model, state, sampling, error)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep what only samples need
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      state%h1 = state%h2
      call add_all_joints(model, state, sampling)
      call find_gravity(model, state)
      if (is_loaded(model, state)) then
         call in_pieces(gather, state%team%leads, model, state)
         call add_cloads(model, state)
         call add_host_loads(state)
         call in_pieces(accelerate, state%team%leads, model, state)
      else
         call in_pieces(gather_and_accelerate, state%team%leads, model, state)
      end if
      call solve_conditioned(model, state)
      call choose_step(model, state)
      call check_step(model, state, error)
      if (.not. allocated(error)) call set_blocking(model, state, error)
      state%work = state%work + state%power*state%h2
      if (any(model%control%below_min == [SCALE_MASS, SCALE_MASS_NEXT])) &
         call in_pieces(accelerate_leads, state%team%leads, model, state)
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
      type(state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      call check_turns(model, state, error)
      call in_pieces(move_nodes, state%crew%shares, model, state)
      call in_pieces(move, state%team%leads, model, state)
      do i = 1, size(model%motion)
         state%motion_turn(i, :) = state%motion_turn(i, :) + &
            state%h2*state%world%w(model%motion(i)%lead, :)
      end do
      state%cycle = state%cycle + 1
      state%time = state%time + state%h2
   end subroutine advance

   !> Joints at t(n), from state%world, time, h1 and h12: frames, forces and state of all joints;
   !> f, m, kn and kr are their sums over the leads, and nothing else
   subroutine find_joint_forces(model, state, sampling)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep the rates, too

      call add_all_joints(model, state, sampling)
      call in_pieces(gather, state%team%leads, model, state)
   end subroutine find_joint_forces

   !> Frames, forces and state of all joints
   subroutine add_all_joints(model, state, sampling)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      logical, intent(in) :: sampling        !! keep the rates, too

      call move_skews(model%skews, state%world%x, state%world%skew)
      state%world%time = state%time
      state%world%h12 = state%h12
      state%sampling = sampling
      call in_pieces(add_joints, state%team%joints, model, state)
   end subroutine add_all_joints

   !> Forces or moments may act on leads themselves; f_own and m_own are 0 otherwise
   pure logical function is_loaded(model, state)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state

      is_loaded = size(model%cload) > 0 .or. allocated(state%f_host)
   end function is_loaded

   !> Forces and moments of an embedding host on the leads, W, and their power
   subroutine add_host_loads(state)
      type(state_t), intent(inout) :: state

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
      integer, intent(in) :: shares(0:)      !! pieces up to the end of each thread's share
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state

      integer :: share, piece

      if (state%team%threads == 1) then
         do piece = 1, shares(1)
            call stage(model, state, piece)
         end do
         return
      end if
      !$omp parallel do schedule(static, 1) num_threads(state%team%threads) private(piece)
      do share = 1, state%team%threads
         do piece = shares(share - 1) + 1, shares(share)
            call stage(model, state, piece)
         end do
      end do
   end subroutine in_pieces

   subroutine add_joints(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      integer :: b

      b = state%team%joint(1, piece)
      call add_joint_forces(model%batch(b), model%curves, state%world, state%h1, state%sampling, &
         state%team%joint(2, piece), state%team%joint(3, piece), state%joint(b), state%wrench)
   end subroutine add_joints

   subroutine gather(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      integer :: lo, hi

      lo = state%team%lead(1, piece)
      hi = state%team%lead(2, piece)
      call gather_wrenches(model%map, state%wrench, lo, hi, state%f, state%m, state%kn, state%kr)
      state%kn(lo:hi) = state%kn(lo:hi) + EPS20
      state%kr(lo:hi) = state%kr(lo:hi) + EPS20
      if (is_loaded(model, state)) then
         state%f_own(lo:hi, :) = 0.0_wp
         state%m_own(lo:hi, :) = 0.0_wp
      end if
   end subroutine gather

   !> Turn of the bodies, accelerations, and what limits the step; impulses of the forces on
   !> secondary nodes, as the Radioss time history keeps them
   subroutine accelerate(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      integer :: lo, hi, last, k

      lo = state%team%lead(1, piece)
      hi = state%team%lead(2, piece)
      last = min(hi, model%n_body)
      do k = 1, 3
         state%impulse(lo:last, k) = state%impulse(lo:last, k) + state%h1*state%f(lo:last, k)
         state%angular_impulse(lo:last, k) = state%angular_impulse(lo:last, k) + &
            state%h1*state%m(lo:last, k)
      end do
      call turn_bodies(is_loaded(model, state), lo, last, state, state%fastest(piece))
      call accelerate_leads(model, state, piece)
      if (model%control%nodal_step .or. model%control%joint_step) &
         call least_ratio(model, state, lo, hi, state%least(piece), state%least_at(piece))
   end subroutine accelerate

   subroutine gather_and_accelerate(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      call gather(model, state, piece)
      call accelerate(model, state, piece)
   end subroutine gather_and_accelerate

   subroutine accelerate_leads(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      integer :: lo, hi, i

      lo = state%team%lead(1, piece)
      hi = state%team%lead(2, piece)
      call linear_accelerations(model, is_loaded(model, state), lo, hi, state)
      do i = 1, size(state%field)
         call add_accelerations(lo, hi, size(state%a, 1), size(state%v, 1), state%mass, state%v, &
            state%field(i), state%a)
      end do
   end subroutine accelerate_leads

   !> New positions of secondary nodes
   subroutine move_nodes(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      associate (unused => model%n_node)
      end associate
      call move_secondaries(GRAIN*(piece - 1) + 1, min(GRAIN*piece, size(state%crew%node)), state)
   end subroutine move_nodes

   !> New velocities and positions of bodies and free nodes
   subroutine move(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      associate (unused => model%n_node)
      end associate
      call move_leads(state%team%lead(1, piece), state%team%lead(2, piece), state)
   end subroutine move

   subroutine check_step(model, state, error)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error

      if (state%h2 > 0.0_wp .and. ieee_is_finite(state%h2) .and. &
         all(ieee_is_finite(state%al(:model%n_body, 1)))) return
      call fail(error, ERR_RUN, 'the solution is not finite any more in cycle '// &
         str(state%cycle)// &
         ' (the nodal time step is no bound: try a smaller --dt-scale)')
   end subroutine check_step

end module kj_step
