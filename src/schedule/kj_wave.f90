!> Several steps of the consistent formulation in one pass over the scene: a piece of joints goes on
!> to its next step as soon as its neighbours have met their forces, while it is in the cache, so
!> that a large scene is read from memory once for all these steps.
!>
!> Tasks are those of kj_plan, step by step. Of the two stages the first is what each share can do
!> alone, the second what lies between shares, in groups that do not see each other.
!>
!> Joints do not wait for a hub at rest, whose lead other threads may be writing: it is written with
!> what it holds already, at once and never through another value (kj_consistent_conditions,
!> kj_consistent_body).
module kj_wave
   use kj_kinds, only: wp
   use kj_sort, only: sorted_order, find_root
   use kj_team, only: team_t
   use kj_lead_map, only: lead_map_t
   use kj_plan, only: plan_t, stage_t, hubs_of_parts
   use kj_task_graph, only: graph_t, new_graph
   implicit none
   private

   public :: new_wave, wave_share

   integer, parameter, public :: N_STEP = 4       !! steps in a wave
   !> So many tasks wait for one in the mean of a scene that has no order to follow
   integer, parameter :: CROWD = 20

   !> Tasks of all steps, and how far they have been put in order; task t of step k is t + (k - 1) n
   type :: order_t
      integer, allocatable :: group(:)            !! who takes it in the stage under way, or 0
      integer, allocatable :: waits(:)            !! for so many that are still to be done
      logical, allocatable :: done(:)
      integer, allocatable :: list(:)             !! tasks of the stage under way
      integer :: n = 0                            !! how many
   end type order_t

contains

   !> Plan for the joints and leads of a team whose hubs all rest: no joint waits for them. No
   !> stages where the scene has no order that a wave could follow.
   pure subroutine new_wave(first, map, team, rounds, plan)
      integer, intent(in) :: first(:)             !! of each batch, number of the joints before it
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      integer, intent(in) :: rounds               !! 2 where joints are damped, else 1
      type(plan_t), intent(out) :: plan

      type(graph_t) :: graph
      type(order_t) :: order
      integer :: n_group

      plan%team = team
      plan%hub = hubs_of_parts(map)
      allocate (plan%ready(size(plan%hub), rounds), source=.true.)
      call new_graph(first, map, team, rounds, graph)
      if (size(graph%next) > CROWD*graph%n) then
         allocate (plan%stage(0))
         return
      end if
      allocate (plan%stage(2))
      order%group = repeated(graph%owner, graph%owner)
      order%waits = repeated(graph%waits(:, 0), graph%waits(:, 0) + graph%waits(:, 1))
      allocate (order%done(size(order%group)), source=.false.)
      allocate (order%list(size(order%group)))
      call order_stage(team%shares, graph, order, plan%stage(1))
      call find_groups(graph, order, n_group)
      call order_stage(n_group, graph, order, plan%stage(2))
   end subroutine new_wave

   !> What the first step has, and what the others have
   pure function repeated(in_first, in_others) result(values)
      integer, intent(in) :: in_first(:), in_others(:)
      integer :: values(N_STEP*size(in_first))

      integer :: k

      values = [in_first, (in_others, k=2, N_STEP)]
   end function repeated

   !> Groups of what is not done: no task of one waits for another
   pure subroutine find_groups(graph, order, n_group)
      type(graph_t), intent(in) :: graph
      type(order_t), intent(inout) :: order
      integer, intent(out) :: n_group

      integer :: id, other, i, t, mine, theirs
      integer :: root(size(order%group))

      root = [(id, id=1, size(root))]
      do id = 1, size(root)
         if (order%done(id)) cycle
         t = modulo(id - 1, graph%n) + 1
         do i = graph%first(t), graph%first(t + 1) - 1
            other = id - t + graph%next(i) + graph%lag(i)*graph%n
            if (other > size(root)) cycle
            call find_root(id, root, mine)
            call find_root(other, root, theirs)
            root(theirs) = mine
         end do
      end do
      n_group = 0
      order%group = 0
      do id = 1, size(root)
         if (order%done(id)) cycle
         call find_root(id, root, mine)
         if (order%group(mine) == 0) then
            n_group = n_group + 1
            order%group(mine) = n_group
         end if
         order%group(id) = order%group(mine)
      end do
   end subroutine find_groups

   !> Each group goes along the scene, and with each task as deep into later steps as it can
   pure subroutine order_stage(n_group, graph, order, stage)
      integer, intent(in) :: n_group
      type(graph_t), intent(in) :: graph
      type(order_t), intent(inout) :: order
      type(stage_t), intent(out) :: stage

      integer, allocatable :: seed(:)
      integer :: g, i, id, first(n_group + 1)

      seed = pack([(id, id=1, size(order%group))], order%group > 0 .and. order%waits == 0 .and. &
         .not. order%done)
      seed = seed(sorted_order(graph%place(modulo(seed - 1, graph%n) + 1)))   ! stable
      seed = seed(sorted_order(order%group(seed)))
      first = [(count(order%group(seed) < g), g=1, n_group + 1)]
      order%n = 0
      allocate (stage%shares(0:n_group))
      stage%shares(0) = 0
      do g = 1, n_group
         do i = first(g) + 1, first(g + 1)
            call go_deep(graph, seed(i), order)
         end do
         stage%shares(g) = order%n
      end do
      associate (list => order%list(:order%n))
         stage%step = (list - 1)/graph%n + 1
         stage%kind = graph%kind(modulo(list - 1, graph%n) + 1)
         stage%round = graph%round(modulo(list - 1, graph%n) + 1)
         stage%item = graph%item(modulo(list - 1, graph%n) + 1)
      end associate
   end subroutine order_stage

   !> A task that waits for nothing, and what of its group then waits for nothing more
   pure subroutine go_deep(graph, seed, order)
      type(graph_t), intent(in) :: graph
      integer, intent(in) :: seed
      type(order_t), intent(inout) :: order

      integer, allocatable :: stack(:)
      integer :: i, id, t, n, other

      stack = [seed]
      n = 1
      do while (n > 0)
         id = stack(n)
         n = n - 1
         order%n = order%n + 1
         order%list(order%n) = id
         order%done(id) = .true.
         t = modulo(id - 1, graph%n) + 1
         do i = graph%first(t), graph%first(t + 1) - 1
            other = id - t + graph%next(i) + graph%lag(i)*graph%n
            if (other > size(order%group)) cycle
            order%waits(other) = order%waits(other) - 1
            if (order%waits(other) > 0 .or. order%group(other) /= order%group(id)) cycle
            if (n == size(stack)) stack = [stack, stack]
            n = n + 1
            stack(n) = other
         end do
      end do
   end subroutine go_deep

   !> How much of the time of its threads a wave uses: 1 where none ever waits for another
   pure real(wp) function wave_share(plan) result(share)
      type(plan_t), intent(in) :: plan

      integer :: s, n
      real(wp) :: work, time

      work = 0.0_wp
      time = 0.0_wp
      do s = 1, size(plan%stage)
         associate (to => plan%stage(s)%shares)
            n = ubound(to, 1)
            if (n == 0) cycle
            work = work + to(n)
            time = time + max(real(maxval(to(1:n) - to(0:n - 1)), wp), &
               real(to(n), wp)/n*((n + plan%team%threads - 1)/plan%team%threads))
         end associate
      end do
      share = 0.0_wp
      if (time > 0.0_wp) share = work/(plan%team%threads*time)
   end function wave_share

end module kj_wave
