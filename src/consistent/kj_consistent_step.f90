!> One step of the consistent formulation: kick, drift, kick (split2 and liemid), and the forces.
!> Source: docs/theory/consistent.md 2.
module kj_consistent_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_block, only: BLOCK
   use kj_skew, only: move_skews
   use kj_lead_map, only: sum_hubs
   use kj_model, only: motion_t, IMPOSE_DISPLACEMENT
   use kj_team, only: next_cycle, team_clock
   use kj_consistent_springs, only: add_springs
   use kj_consistent_dampers, only: add_dampers
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_load, only: add_loads, find_gravity, add_gravity, count_gravity, add_host_loads
   use kj_consistent_leads, only: move_leads, open_leads, look_leads, kick_leads, gather
   use kj_consistent_conditions, only: count_work, FIRST_HALF, SECOND_HALF
   use kj_consistent_motion, only: motion_targets
   implicit none
   private

   public :: split_step, step_to_loads, step_from_loads, find_forces, place_node, place_nodes, &
      reach_motions, reach_motion

   !> What threads do with pieces of leads: one thing or the sum of several, in this order
   integer, parameter :: MOVE = 1, OPEN = 2, GATHERING = 4, WEIGH = 8, LOOK = 16, KICKING = 32
   !> and with pieces of joints
   integer, parameter :: SPRINGS = 1, DAMPERS = 2
   integer, parameter :: NOTHING = 0

   !> What the stages of a step are told
   type :: step_t
      logical :: midpoint = .false.                  !! liemid instead of split2
      real(wp) :: h = 0.0_wp
   end type step_t

contains

   !> From t to t + h by kick, drift, kick
   subroutine split_step(model, midpoint, h, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      type(step_t) :: step
      real(wp) :: started

      call next_cycle(model%team, state%trial)
      started = team_clock(model%team)
      state%h = h
      if (size(model%motion) > 0) then
         call motion_targets(model, state, h, state%mean, state%final, state%active)
         call reach_motions(model, h, state%mean, state%final, state%active, state)
      end if
      state%cycle = min(state%cycle, huge(state%cycle) - 1) + 1     ! no more can be counted
      state%time = state%time + h
      call set_clock(model, h, state)
      step%midpoint = midpoint
      step%h = h
      call to_new_pose(MOVE, KICKING, model, step, state)
      state%trial%spent = state%trial%spent + (team_clock(model%team) - started)
   end subroutine split_step

   !> The same from poses%time - poses%h to poses%time, up to where loads act, by itself: motions,
   !> clock and work of the state are left to others, and so are loads
   subroutine step_to_loads(model, midpoint, loaded, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint                !! liemid instead of split2
      logical, intent(in) :: loaded                  !! there are loads
      type(consistent_state_t), intent(inout) :: state

      type(step_t) :: step

      step%midpoint = midpoint
      call to_loads(MOVE, KICKING, loaded, model, step, state)
   end subroutine step_to_loads

   !> From there to the end of the step
   subroutine step_from_loads(model, loaded, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: loaded
      type(consistent_state_t), intent(inout) :: state

      type(step_t) :: step

      call from_loads(KICKING, loaded, model, step, state)
   end subroutine step_from_loads

   !> Forces and moments of all leads in the pose reached. h = 0: at the start, dampers from the
   !> velocities as they are.
   subroutine find_forces(model, h, target, active, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      real(wp), intent(in) :: target(:)              !! (n_motion) velocities at the end of the step
      logical, intent(in) :: active(:)
      type(consistent_state_t), intent(inout) :: state

      type(step_t) :: step

      step%h = h
      state%mean = target
      state%final = target
      state%active = active
      call set_clock(model, h, state)
      call to_new_pose(OPEN, NOTHING, model, step, state)
   end subroutine find_forces

   !> The time of the new pose and the step to it, as kernels read them
   pure subroutine set_clock(model, h, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      associate (n => model%team%lanes)
         state%poses%time(:n) = state%time
         state%poses%h(:n) = h
      end associate
   end subroutine set_clock

   !> Leads come to the new pose, forces of all but the dampers follow, these from what leads look
   !> at then, and the end of the step
   subroutine to_new_pose(first, last, model, step, state)
      integer, intent(in) :: first, last             !! what leads do before joints, and after them
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      logical :: loaded

      ! loads act beside joints and gravity
      loaded = size(model%cload) > 0 .or. allocated(state%f_host)
      call to_loads(first, last, loaded, model, step, state)
      if (first == MOVE) call count_work(FIRST_HALF, state)
      call count_gravity(model, step%h, state)
      if (loaded) call add_loads(model, state)
      if (loaded) call add_host_loads(step%h, state)
      call from_loads(last, loaded, model, step, state)
      if (last == KICKING) call count_work(SECOND_HALF, state)
   end subroutine to_new_pose

   !> Up to where loads act. Leads do all that lies between two looks of the joints in one go,
   !> except where nodes or loads come between.
   subroutine to_loads(first, last, loaded, model, step, state)
      integer, intent(in) :: first, last
      logical, intent(in) :: loaded
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      call for_leads(first, model, step, state)
      if (size(model%placed) > 0) call place_nodes(model, state)
      call find_gravity(model, state)
      call for_joints(SPRINGS, model, state)
      call for_leads(GATHERING + WEIGH + merge(NOTHING, after_loads(last, model), loaded), &
         model, step, state)
   end subroutine to_loads

   subroutine from_loads(last, loaded, model, step, state)
      integer, intent(in) :: last
      logical, intent(in) :: loaded
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      if (loaded) call for_leads(after_loads(last, model), model, step, state)
      if (.not. model%damped) return
      call for_joints(DAMPERS, model, state)
      call for_leads(GATHERING + last, model, step, state)
   end subroutine from_loads

   !> What leads do once loads act: before the dampers, or at the end
   pure integer function after_loads(last, model) result(what)
      integer, intent(in) :: last
      type(consistent_model_t), intent(in) :: model

      what = merge(LOOK, last, model%damped)
   end function after_loads

   !> Something with all leads, piece by piece: in threads, or without them. Even a team of one
   !> thread costs a microsecond, more than the stage of a few joints.
   subroutine for_leads(what, model, step, state)
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      integer :: piece

      if (what == NOTHING) return
      associate (team => model%team)
         if (has(what, GATHERING) .and. size(model%map%hub) > 0) call sum_hubs(model%map, &
            state%trial%threads, state%wrench, state%part)
         if (state%trial%threads == 1) then
            do piece = 1, size(team%lead, 2)
               call work_on_leads(what, team%lead(:, piece), model, step, state)
            end do
            return
         end if
         !$omp parallel do schedule(dynamic, 1) num_threads(state%trial%threads)
         do piece = 1, size(team%lead, 2)
            call work_on_leads(what, team%lead(:, piece), model, step, state)
         end do
      end associate
   end subroutine for_leads

   !> Something with all joints
   subroutine for_joints(what, model, state)
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: piece

      associate (team => model%team)
         if (state%trial%threads == 1) then
            do piece = 1, size(team%joint, 2)
               call work_on_joints(what, team%joint(:, piece), model, state)
            end do
            return
         end if
         !$omp parallel do schedule(dynamic, 1) num_threads(state%trial%threads)
         do piece = 1, size(team%joint, 2)
            call work_on_joints(what, team%joint(:, piece), model, state)
         end do
      end associate
   end subroutine for_joints

   !> A piece of the leads, block by block
   subroutine work_on_leads(what, piece, model, step, state)
      integer, intent(in) :: what
      integer, intent(in) :: piece(2)                !! first, last lead
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      integer :: lo, hi

      do lo = piece(1), piece(2), BLOCK
         hi = min(lo + BLOCK - 1, piece(2))
         if (has(what, MOVE)) &
            call move_leads(model, step%midpoint, state%poses%h, lo, hi, state)
         if (has(what, OPEN)) call open_leads(model, state%poses%h, lo, hi, state)
         if (has(what, GATHERING)) call gather(model, has(what, WEIGH), lo, hi, state)
         if (has(what, WEIGH)) call add_gravity(model, lo, hi, state)
         if (has(what, LOOK)) call look_leads(model, state%poses%h, lo, hi, state)
         if (has(what, KICKING)) call kick_leads(model, state%poses%h, lo, hi, state)
      end do
   end subroutine work_on_leads

   !> Is a part among what leads do?
   pure logical function has(what, part)
      integer, intent(in) :: what, part

      has = iand(what, part) /= 0
   end function has

   !> A piece of the joints
   subroutine work_on_joints(what, piece, model, state)
      integer, intent(in) :: what
      integer, intent(in) :: piece(3)                !! batch, first joint, last joint
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      associate (b => piece(1), lo => piece(2), hi => piece(3))
         select case (what)
         case (SPRINGS)
            call add_springs(model%batch(b), model%curves, state%poses, lo, hi, state%joint(b), &
               state%wrench)
         case (DAMPERS)
            call add_dampers(model%batch(b), model%curves, state%poses, lo, hi, state%joint(b), &
               state%wrench)
         end select
      end associate
   end subroutine work_on_joints

   !> What imposed displacements and accelerations have reached
   subroutine reach_motions(model, h, mean, final, active, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h, mean(:), final(:)
      logical, intent(in) :: active(:)
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%motion)
         if (active(i)) call reach_motion(model%motion(i), h, mean(i), final(i), state%motion_at(i))
      end do
   end subroutine reach_motions

   !> The same of one motion that acts
   pure subroutine reach_motion(motion, h, mean, final, at)
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: h, mean, final
      real(wp), intent(inout) :: at

      if (motion%kind == IMPOSE_DISPLACEMENT) then
         at = at + h*mean
      else
         at = final
      end if
   end subroutine reach_motion

   !> Positions of the nodes that loads and skews read, and the skews
   subroutine place_nodes(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%placed)
         state%node(model%placed(i), :) = place_node(model, state, model%placed(i))
      end do
      call move_skews(model%skews, state%node, state%skew)
   end subroutine place_nodes

   !> Position of a node from the pose of its lead
   pure function place_node(model, state, node) result(x)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: node
      real(wp) :: x(3)

      real(wp) :: a(3), t(3)
      integer :: lead

      lead = model%lead(node)
      a = model%arm(node, :)
      t = 2.0_wp*cross(state%poses%quat(lead, 2:4), a)
      x = state%poses%x(lead, :) + a + state%poses%quat(lead, 1)*t + &
         cross(state%poses%quat(lead, 2:4), t)
   end function place_node

end module kj_consistent_step
