!> One step of the consistent formulation: kick, drift, kick (split2 and liemid), and the forces.
!> Source: consistent.md 1; accuracy.md, integrators.
module kj_c_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_team, only: GRAIN
   use kj_model, only: model_t
   use kj_skew, only: move_skews
   use kj_assembly, only: sum_part
   use kj_plan, only: plan_t, DO_JOINTS, DO_PART, DO_LEADS
   use kj_c_force, only: add_springs
   use kj_c_damper, only: add_dampers
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_load, only: add_loads, find_gravity, count_gravity
   use kj_c_host, only: add_host_loads
   use kj_c_leads, only: move_leads, open_leads, meet_leads, look_leads, kick_leads, gather
   use kj_c_hold, only: motion_targets, count_work
   implicit none
   private

   public :: c_step, find_forces, place_node, reach_motions

   !> What threads do with pieces of leads, and of joints
   integer, parameter :: MOVE = 1, OPEN = 2, MEET = 3, LOOK = 4, MEET_AND_LOOK = 5, GATHERING = 6, &
      KICKING = 7, GATHER_AND_KICK = 8
   integer, parameter :: NOTHING = 0, SPRINGS = 1, DAMPERS = 2

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
      call sum_forces(GATHER_AND_KICK, model, c, step, state)
      if (.not. c%damped) call for_leads(KICKING, model, c, step, state)
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
      call sum_forces(GATHERING, model, c, step, state)
   end subroutine find_forces

   !> Forces of all but the dampers, and then of these from what they look at. Where no load is in
   !> between, dampers follow as soon as both leads of a joint have met their forces.
   subroutine sum_forces(last, model, c, step, state)
      integer, intent(in) :: last                    !! what leads do after the dampers
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      call place_nodes(model, c, state)
      call find_gravity(model, state)
      state%poses%time = state%time
      state%poses%h = step%h
      if (c%damped .and. .not. is_loaded(model, state)) then
         call go_through(c%twice, [SPRINGS, DAMPERS], [MEET_AND_LOOK, last], model, c, step, state)
         call count_gravity(c, step%h, state)
         return
      end if
      call go_through(c%once, [SPRINGS], [MEET], model, c, step, state)
      call count_gravity(c, step%h, state)
      call add_loads(model, state)
      call add_host_loads(step%h, state)
      if (.not. c%damped) return
      call for_leads(LOOK, model, c, step, state)
      call go_through(c%once, [DAMPERS], [last], model, c, step, state)
   end subroutine sum_forces

   !> One thing with all leads
   subroutine for_leads(what, model, c, step, state)
      integer, intent(in) :: what
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      call go_through(c%alone, [NOTHING], [what], model, c, step, state)
   end subroutine for_leads

   !> Stages of a plan one after the other, piece by piece: in threads, or without them. Even a team
   !> of one thread costs a microsecond, more than the stage of a few joints.
   subroutine go_through(plan, joints, leads, model, c, step, state)
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: joints(:), leads(:)     !! (rounds) what to do with them
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      integer :: s, share, task

      do s = 1, size(plan%stage)
         if (c%team%threads == 1) then
            do task = 1, size(plan%stage(s)%item)
               call do_task(plan, s, task, joints, leads, model, c, step, state)
            end do
            cycle
         end if
         !$omp parallel do schedule(static, 1) num_threads(c%team%threads) private(task)
         do share = 1, c%team%threads
            do task = plan%stage(s)%shares(share - 1) + 1, plan%stage(s)%shares(share)
               call do_task(plan, s, task, joints, leads, model, c, step, state)
            end do
         end do
      end do
   end subroutine go_through

   !> A task of stage s
   subroutine do_task(plan, s, task, joints, leads, model, c, step, state)
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: s, task, joints(:), leads(:)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      associate (item => plan%stage(s)%item(task), round => plan%stage(s)%round(task))
         select case (plan%stage(s)%kind(task))
         case (DO_JOINTS)
            call work_on_joints(joints(round), item, model, c, step, state)
         case (DO_PART)
            call sum_part(model%map, state%wrench, plan%hub(item), item, state%part(:, item, round))
         case (DO_LEADS)
            call work_on_leads(leads(round), plan%ready(:, round), round, item, model, c, step, &
               state)
         end select
      end associate
   end subroutine do_task

   !> A piece of the leads, whole blocks of kj_gravity at a time
   subroutine work_on_leads(what, ready, round, piece, model, c, step, state)
      integer, intent(in) :: what
      logical, intent(in) :: ready(:)                !! (parts of hubs) summed
      integer, intent(in) :: round                   !! of their sums
      integer, intent(in) :: piece
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      integer :: lo, hi

      do lo = c%team%lead(1, piece), c%team%lead(2, piece), GRAIN
         hi = min(lo + GRAIN - 1, c%team%lead(2, piece))
         if (what == MEET .or. what == MEET_AND_LOOK) &
            call meet_leads(model, c, ready, round, lo, hi, state)
         if (what == GATHERING .or. what == GATHER_AND_KICK) &
            call gather(model, ready, round, lo, hi, state)
         select case (what)
         case (MOVE)
            call move_leads(model, c, step%midpoint, step%h, step%target, step%active, lo, hi, &
               state)
         case (OPEN)
            call open_leads(c, step%h, lo, hi, state)
         case (LOOK, MEET_AND_LOOK)
            call look_leads(c, step%h, step%target, step%active, lo, hi, state)
         case (KICKING, GATHER_AND_KICK)
            call kick_leads(model, c, step%h, step%target, step%active, lo, hi, state)
         end select
      end do
   end subroutine work_on_leads

   !> A piece of the joints
   subroutine work_on_joints(what, piece, model, c, step, state)
      integer, intent(in) :: what, piece
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(step_t), intent(in) :: step
      type(c_state_t), intent(inout) :: state

      associate (b => c%team%joint(1, piece), lo => c%team%joint(2, piece), &
         hi => c%team%joint(3, piece))
         select case (what)
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
