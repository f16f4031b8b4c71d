!> One step of the consistent formulation: kick, drift, kick (split2 and liemid), and the forces.
!> Source: consistent.md 1; accuracy.md, integrators.
module kj_c_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_model, only: model_t
   use kj_skew, only: move_skews
   use kj_assembly, only: sum_part
   use kj_plan, only: DO_JOINTS, DO_PART, DO_LEADS
   use kj_c_force, only: add_springs
   use kj_c_damper, only: add_dampers
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_load, only: add_loads, find_gravity, count_gravity
   use kj_c_host, only: add_host_loads, look_ahead
   use kj_c_leads, only: move_leads, open_leads, meet_leads, look_leads, kick_leads, gather
   use kj_c_hold, only: project_rates, motion_targets, count_work
   implicit none
   private

   public :: c_step, find_forces, place_node, reach_motions

   !> Stages of a step that threads share, lead by lead
   integer, parameter :: MOVE = 1, OPEN = 2, LOOK = 3, MEET = 4, GATHERING = 5, KICKING = 6
   !> and joint by joint
   integer, parameter :: SPRINGS = 1, DAMPERS = 2
   !> What they go through: leads, tasks of the plan, or leads that have to wait in it
   integer, parameter :: ALL_LEADS = 1, PLANNED = 2, LATE = 3

   !> What the stages of a step are told
   type :: step_t
      logical :: midpoint = .false.                  !! liemid instead of split2
      real(wp) :: h = 0.0_wp
      real(wp), allocatable :: target(:)             !! (n_motion) wanted velocities
      logical, allocatable :: active(:)              !! (n_motion)
   end type step_t

contains

   !> From t to t + h by kick, drift, kick
   subroutine c_step(model, c, midpoint, h, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      real(wp) :: final(size(model%motion))
      type(step_t) :: step

      allocate (step%target(size(final)), step%active(size(final)))
      step%midpoint = midpoint
      step%h = h
      state%h = h
      call motion_targets(model, state, h, step%target, final, step%active)
      call for_leads(MOVE, model, c, step, state)
      call count_work(state)
      state%cycle = state%cycle + 1
      state%time = state%time + h
      call reach_motions(model, h, step%target, final, step%active, state)
      step%target = final
      call sum_forces(model, c, step, state)
      if (c%damped) then
         call for_joints(DAMPERS, KICKING, model, c, step, state)
      else
         call for_leads(KICKING, model, c, step, state)
      end if
      call count_work(state)
   end subroutine c_step

   !> Forces and moments of all leads in the pose reached. h = 0: at the start, dampers from the
   !> velocities as they are.
   subroutine find_forces(model, c, h, target, active, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h
      real(wp), intent(in) :: target(:)              !! (n_motion) velocities at the end of the step
      logical, intent(in) :: active(:)
      type(c_state_t), intent(inout) :: state

      type(step_t) :: step

      step%h = h
      step%target = target
      step%active = active
      call for_leads(OPEN, model, c, step, state)
      call sum_forces(model, c, step, state)
      if (c%damped) call for_joints(DAMPERS, GATHERING, model, c, step, state)
   end subroutine find_forces

   !> Forces of all but the dampers, and what these look at
   subroutine sum_forces(model, c, step, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      call place_nodes(model, c, state)
      call find_gravity(model, state)
      state%poses%time = state%time
      state%poses%h = step%h
      call for_joints(SPRINGS, MEET, model, c, step, state)
      call count_gravity(c, step%h, state)
      call add_loads(model, state)
      call add_host_loads(step%h, state)
      if (.not. c%damped) return
      if (is_loaded(model, state)) call for_leads(LOOK, model, c, step, state)
      call look_ahead(c, step%h, state)
      call project_rates(c, state, step%target, step%active)
   end subroutine sum_forces

   !> A stage of all leads
   subroutine for_leads(stage, model, c, step, state)
      integer, intent(in) :: stage
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      call in_pieces(ALL_LEADS, [0, stage], c%team%leads, model, c, step, state)
   end subroutine for_leads

   !> A stage of all joints, and one of all leads that follow them, in the order of the plan
   subroutine for_joints(joints, leads, model, c, step, state)
      integer, intent(in) :: joints                  !! stage
      integer, intent(in) :: leads                   !! stage, 0 = none
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      call in_pieces(PLANNED, [joints, leads], c%plan%shares, model, c, step, state)
      if (leads > 0) &
         call in_pieces(LATE, [joints, leads], c%plan%late_shares, model, c, step, state)
   end subroutine for_joints

   !> Stages piece by piece: in threads, or without them. Even a team of one thread costs a
   !> microsecond, more than the stage of a few joints.
   subroutine in_pieces(set, stages, shares, model, c, step, state)
      integer, intent(in) :: set                     !! ALL_LEADS, PLANNED or LATE
      integer, intent(in) :: stages(2)               !! of joints and of leads
      integer, intent(in) :: shares(0:)              !! pieces up to the end of each thread's share
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      integer :: share, piece

      if (c%team%threads == 1) then
         do piece = 1, shares(1)
            call work_on(set, stages, piece, model, c, step, state)
         end do
         return
      end if
      !$omp parallel do schedule(static, 1) num_threads(c%team%threads) private(piece)
      do share = 1, c%team%threads
         do piece = shares(share - 1) + 1, shares(share)
            call work_on(set, stages, piece, model, c, step, state)
         end do
      end do
   end subroutine in_pieces

   !> A piece of a set
   subroutine work_on(set, stages, piece, model, c, step, state)
      integer, intent(in) :: set, stages(2), piece
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      select case (set)
      case (ALL_LEADS)
         call work_on_leads(stages(2), piece, model, c, step, state)
      case (LATE)
         call work_on_leads(stages(2), c%plan%late(piece), model, c, step, state)
      case (PLANNED)
         associate (item => c%plan%item(piece))
            select case (c%plan%kind(piece))
            case (DO_JOINTS)
               call work_on_joints(stages(1), item, model, c, step, state)
            case (DO_PART)
               call sum_part(model%map, state%wrench, c%plan%hub(item), item, state%part(:, item))
            case (DO_LEADS)
               if (stages(2) > 0) call work_on_leads(stages(2), item, model, c, step, state)
            end select
         end associate
      end select
   end subroutine work_on

   !> One stage of one piece of the leads
   subroutine work_on_leads(stage, piece, model, c, step, state)
      integer, intent(in) :: stage, piece
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      associate (lo => c%team%lead(1, piece), hi => c%team%lead(2, piece))
         select case (stage)
         case (MOVE)
            call move_leads(model, c, step%midpoint, step%h, step%target, step%active, lo, hi, &
               state)
         case (OPEN)
            call open_leads(c, step%h, lo, hi, state)
         case (MEET)
            call meet_leads(model, c, step%h, c%damped .and. .not. is_loaded(model, state), lo, &
               hi, state)
         case (GATHERING)
            call gather(model, c, lo, hi, state)
         case (LOOK)
            call look_leads(c, step%h, lo, hi, state)
         case (KICKING)
            call kick_leads(model, c, step%h, step%target, step%active, lo, hi, state)
         end select
      end associate
   end subroutine work_on_leads

   !> One stage of one piece of the joints
   subroutine work_on_joints(stage, piece, model, c, step, state)
      integer, intent(in) :: stage, piece
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      associate (b => c%team%joint(1, piece), lo => c%team%joint(2, piece), &
         hi => c%team%joint(3, piece))
         select case (stage)
         case (SPRINGS)
            call add_springs(c%batch(b), model%curves, state%poses, lo, hi, state%joint(b), &
               state%wrench)
         case (DAMPERS)
            call add_dampers(c%batch(b), model%curves, state%poses, step%h, lo, hi, &
               state%joint(b), state%wrench)
         end select
      end associate
   end subroutine work_on_joints

   !> Loads act on leads beside joints and gravity
   pure logical function is_loaded(model, state)
      type(model_t), intent(in) :: model
      type(c_state_t), intent(in) :: state

      is_loaded = size(model%cload) > 0 .or. allocated(state%f_host)
   end function is_loaded

   !> What imposed displacements and accelerations have reached
   subroutine reach_motions(model, h, mean, final, active, state)
      type(model_t), intent(in) :: model
      real(wp), intent(in) :: h, mean(:), final(:)
      logical, intent(in) :: active(:)
      type(c_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%motion)
         if (.not. active(i)) cycle
         if (model%motion(i)%kind == 2) then
            state%motion_at(i) = state%motion_at(i) + h*mean(i)
         else
            state%motion_at(i) = final(i)
         end if
      end do
   end subroutine reach_motions

   !> Positions of the nodes that loads and skews read, and the skews
   subroutine place_nodes(model, c, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(inout) :: state

      integer :: i

      if (size(c%placed) == 0) return
      do i = 1, size(c%placed)
         state%node(c%placed(i), :) = place_node(model, c, state, c%placed(i))
      end do
      call move_skews(model%skews, state%node, state%skew)
   end subroutine place_nodes

   !> Position of a node from the pose of its lead
   pure function place_node(model, c, state, node) result(x)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      integer, intent(in) :: node
      real(wp) :: x(3)

      real(wp) :: a(3), t(3)
      integer :: lead

      lead = model%lead(node)
      a = c%arm(node, :)
      t = 2.0_wp*cross(state%poses%quat(lead, 2:4), a)
      x = state%poses%x(lead, :) + a + state%poses%quat(lead, 1)*t + &
         cross(state%poses%quat(lead, 2:4), t)
   end function place_node

end module kj_c_step
