!> One step of the consistent formulation: kick, drift, kick (split2 and liemid), and the forces.
!> Source: docs/theory/consistent.md 2.
module kj_consistent_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_block, only: BLOCK
   use kj_skew, only: move_skews
   use kj_lead_map, only: sum_part
   use kj_schedule, only: plan_t, DO_JOINTS, DO_PART, DO_LEADS
   use kj_consistent_springs, only: add_springs
   use kj_consistent_dampers, only: add_dampers
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_load, only: add_loads, find_gravity, add_gravity, count_gravity, add_host_loads
   use kj_consistent_leads, only: move_leads, open_leads, look_leads, kick_leads, gather
   use kj_consistent_conditions, only: motion_targets, count_work, FIRST_HALF, SECOND_HALF
   implicit none
   private

   public :: split_step, find_forces, place_node, reach_motions

   !> What threads do with pieces of leads: one thing or the sum of several, in this order
   integer, parameter :: MOVE = 1, OPEN = 2, GATHERING = 4, WEIGH = 8, LOOK = 16, KICKING = 32
   !> and with pieces of joints
   integer, parameter :: SPRINGS = 1, DAMPERS = 2
   integer, parameter :: NOTHING = 0

   !> What the stages of a step are told
   type :: step_t
      logical :: midpoint = .false.                  !! liemid instead of split2
      real(wp) :: h = 0.0_wp
      !> (n_motion) wanted velocities: mean of the step, and at its end
      real(wp), allocatable :: mean(:), final(:)
      logical, allocatable :: active(:)              !! (n_motion)
   end type step_t

contains

   !> From t to t + h by kick, drift, kick
   subroutine split_step(model, midpoint, h, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      type(step_t) :: step

      associate (n => size(model%motion))
         allocate (step%mean(n), step%final(n), step%active(n))
      end associate
      step%midpoint = midpoint
      step%h = h
      state%h = h
      call motion_targets(model, state, h, step%mean, step%final, step%active)
      call reach_motions(model, h, step%mean, step%final, step%active, state)
      state%cycle = state%cycle + 1
      state%time = state%time + h
      call to_new_pose(MOVE, KICKING, model, step, state)
   end subroutine split_step

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
      step%mean = target
      step%final = target
      step%active = active
      call to_new_pose(OPEN, NOTHING, model, step, state)
   end subroutine find_forces

   !> Leads come to the new pose, forces of all but the dampers follow, these from what they look
   !> at, and the end of the step. Joints follow as soon as both leads are ready for them, except
   !> where nodes or loads come between.
   subroutine to_new_pose(first, last, model, step, state)
      integer, intent(in) :: first, last             !! what leads do before joints, and after them
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      integer :: before
      logical :: loaded

      before = first
      if (size(model%placed) > 0) then
         call for_leads(first, model, step, state)
         call place_nodes(model, state)
         before = NOTHING
      end if
      call find_gravity(model, state)
      state%poses%time = state%time
      state%poses%h = step%h
      loaded = is_loaded(model, state)
      if (model%damped .and. .not. loaded) then
         call go_through(model%twice, [before, GATHERING + WEIGH + LOOK, GATHERING + last], &
            [SPRINGS, DAMPERS], model, step, state)
      else if (.not. loaded) then
         call go_through(model%once, [before, GATHERING + WEIGH + last], [SPRINGS], model, step, &
            state)
      else
         call go_through(model%once, [before, GATHERING + WEIGH], [SPRINGS], model, step, state)
      end if
      if (first == MOVE) call count_work(FIRST_HALF, state)
      call count_gravity(model, step%h, state)
      if (loaded) then
         call add_loads(model, state)
         call add_host_loads(step%h, state)
         if (model%damped) then
            call go_through(model%once, [LOOK, GATHERING + last], [DAMPERS], model, step, state)
         else
            call for_leads(last, model, step, state)
         end if
      end if
      if (last == KICKING) call count_work(SECOND_HALF, state)
   end subroutine to_new_pose

   !> One thing with all leads
   subroutine for_leads(what, model, step, state)
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      call go_through(model%alone, [what], [integer ::], model, step, state)
   end subroutine for_leads

   !> Stages of a plan one after the other, piece by piece: in threads, or without them. Even a team
   !> of one thread costs a microsecond, more than the stage of a few joints.
   subroutine go_through(plan, leads, joints, model, step, state)
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: leads(0:), joints(:)    !! (rounds) what to do with them
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      integer :: s, share, task

      do s = lbound(plan%stage, 1), ubound(plan%stage, 1)
         if (size(plan%stage(s)%item) == 0) cycle
         if (plan%team%threads == 1) then
            do task = 1, size(plan%stage(s)%item)
               call do_task(plan, s, task, leads, joints, model, step, state)
            end do
            cycle
         end if
         !$omp parallel do schedule(dynamic, 1) num_threads(plan%team%threads) private(task)
         do share = 1, ubound(plan%stage(s)%shares, 1)
            do task = plan%stage(s)%shares(share - 1) + 1, plan%stage(s)%shares(share)
               call do_task(plan, s, task, leads, joints, model, step, state)
            end do
         end do
      end do
   end subroutine go_through

   !> A task of stage s
   subroutine do_task(plan, s, task, leads, joints, model, step, state)
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: s, task, leads(0:), joints(:)
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      associate (item => plan%stage(s)%item(task), round => plan%stage(s)%round(task))
         select case (plan%stage(s)%kind(task))
         case (DO_JOINTS)
            call work_on_joints(joints(round), plan%team%joint(:, item), model, step, state)
         case (DO_PART)
            call sum_part(model%map, state%wrench, plan%hub(item), item, &
               state%part(:, item, round))
         case (DO_LEADS)
            call work_on_leads(leads(round), plan%ready(:, max(1, round)), round, &
               plan%team%lead(:, item), model, step, state)
         end select
      end associate
   end subroutine do_task

   !> A piece of the leads, whole blocks of kj_gravity at a time
   subroutine work_on_leads(what, ready, round, piece, model, step, state)
      integer, intent(in) :: what
      logical, intent(in) :: ready(:)                !! (parts of hubs) summed
      integer, intent(in) :: round                   !! of their sums
      integer, intent(in) :: piece(2)                !! first, last lead
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      integer :: lo, hi

      if (what == NOTHING) return
      do lo = piece(1), piece(2), BLOCK
         hi = min(lo + BLOCK - 1, piece(2))
         if (has(MOVE)) call move_leads(model, step%midpoint, step%h, step%mean, step%active, &
            lo, hi, state)
         if (has(OPEN)) call open_leads(model, step%h, lo, hi, state)
         if (has(GATHERING)) call gather(model, ready, round, lo, hi, state)
         if (has(WEIGH)) call add_gravity(model, lo, hi, state)
         if (has(LOOK)) call look_leads(model, step%h, step%final, step%active, lo, hi, state)
         if (has(KICKING)) call kick_leads(model, step%h, step%final, step%active, lo, hi, state)
      end do

   contains

      pure logical function has(part)
         integer, intent(in) :: part

         has = iand(what, part) /= 0
      end function has

   end subroutine work_on_leads

   !> A piece of the joints
   subroutine work_on_joints(what, piece, model, step, state)
      integer, intent(in) :: what
      integer, intent(in) :: piece(3)                !! batch, first joint, last joint
      type(consistent_model_t), intent(in) :: model
      type(step_t), intent(in) :: step
      type(consistent_state_t), intent(inout) :: state

      associate (b => piece(1), lo => piece(2), hi => piece(3))
         select case (what)
         case (SPRINGS)
            call add_springs(model%batch(b), model%curves, state%poses, lo, hi, state%joint(b), &
               state%wrench)
         case (DAMPERS)
            call add_dampers(model%batch(b), model%curves, state%poses, step%h, lo, hi, &
               state%joint(b), state%wrench)
         end select
      end associate
   end subroutine work_on_joints

   !> Loads act on leads beside joints and gravity
   pure logical function is_loaded(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      is_loaded = size(model%cload) > 0 .or. allocated(state%f_host)
   end function is_loaded

   !> What imposed displacements and accelerations have reached
   subroutine reach_motions(model, h, mean, final, active, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h, mean(:), final(:)
      logical, intent(in) :: active(:)
      type(consistent_state_t), intent(inout) :: state

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
   subroutine place_nodes(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      if (size(model%placed) == 0) return
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
