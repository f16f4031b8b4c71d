!> The tasks of kj_plan as a graph: what each piece of joints, part of a hub and piece of leads
!> waits for within a step, and from one step to the next. Hubs all rest: no joint waits for them.
module kj_task_graph
   use kj_team, only: team_t, owners
   use kj_lead_map, only: lead_map_t, part_entries
   use kj_plan, only: pieces_of_joints, DO_JOINTS, DO_PART, DO_LEADS
   implicit none
   private

   public :: graph_t, new_graph

   !> Tasks of one step, the same in each
   type :: graph_t
      integer :: n = 0                            !! tasks of a step
      integer, allocatable :: kind(:), round(:), item(:)   !! (n)
      integer, allocatable :: place(:)            !! (n) where it begins along the scene
      integer, allocatable :: owner(:)            !! (n) the share that has all it waits for, or 0
      !> (n + 1) rows of what waits for each task, and by how many steps later it is
      integer, allocatable :: first(:)
      integer, allocatable :: next(:), lag(:)
      integer, allocatable :: waits(:, :)         !! (n, 0:1) for how many, 0 or 1 steps before
   end type graph_t

   !> What waits for what: pairs of tasks of a step, the second `lag` steps later
   type :: pairs_t
      integer :: n = 0
      integer, allocatable :: before(:), after(:), lag(:)
   end type pairs_t

   !> Numbers of the tasks of a step
   type :: numbers_t
      integer :: joints = 0, parts = 0, leads = 0 !! pieces of each
      integer :: rounds = 0
   end type numbers_t

contains

   !> The tasks of a step and what they wait for
   pure subroutine new_graph(first, map, team, rounds, graph)
      integer, intent(in) :: first(:)             !! of each batch, number of the joints before it
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      integer, intent(in) :: rounds               !! 2 where joints are damped, else 1
      type(graph_t), intent(out) :: graph

      type(numbers_t) :: n
      type(pairs_t) :: pairs
      integer, allocatable :: piece(:), pieces(:)
      integer :: i, h, entries(2)
      logical :: hub(size(map%first) - 1)

      n = numbers_t(size(team%joint, 2), map%part(size(map%part)) - 1, size(team%lead, 2), rounds)
      call name_tasks(n, graph)
      allocate (pairs%before(64), pairs%after(64), pairs%lag(64))
      piece = pieces_of_joints(first, team, size(map%joint)/2)
      hub = .false.
      hub(map%hub) = .true.
      call place_joints(n, owners(team), graph)
      do i = 1, n%leads
         pieces = distinct(pieces_at(map, team%lead(:, i), hub, piece), n%joints)
         call place_task(n, DO_LEADS, i, pieces, owners(team), graph)
         call link_leads(n, i, pieces, pairs)
      end do
      do h = 1, size(map%hub)
         do i = map%part(h), map%part(h + 1) - 1
            entries = part_entries(map, h, i)
            pieces = distinct(piece(abs(map%joint(entries(1):entries(2)))), n%joints)
            call place_task(n, DO_PART, i, pieces, owners(team), graph)
            call link_part(n, i, pieces, pairs)
         end do
      end do
      call link_tasks(pairs, graph)
   end subroutine new_graph

   !> Kinds, rounds and items
   pure subroutine name_tasks(n, graph)
      type(numbers_t), intent(in) :: n
      type(graph_t), intent(inout) :: graph

      integer :: r

      graph%n = task_of(n, DO_LEADS, n%rounds, n%leads)
      allocate (graph%kind(graph%n), graph%round(graph%n), graph%item(graph%n), &
         graph%place(graph%n), graph%owner(graph%n), source=0)
      call name_items(n, DO_LEADS, 0, n%leads, graph)
      do r = 1, n%rounds
         call name_items(n, DO_JOINTS, r, n%joints, graph)
         call name_items(n, DO_PART, r, n%parts, graph)
         call name_items(n, DO_LEADS, r, n%leads, graph)
      end do
   end subroutine name_tasks

   pure subroutine name_items(n, kind, round, items, graph)
      type(numbers_t), intent(in) :: n
      integer, intent(in) :: kind, round, items
      type(graph_t), intent(inout) :: graph

      integer :: i, t

      do i = 1, items
         t = task_of(n, kind, round, i)
         graph%kind(t) = kind
         graph%round(t) = round
         graph%item(t) = i
      end do
   end subroutine name_items

   !> Number of a task among those of a step; in round 0 there are leads alone
   pure integer function task_of(n, kind, round, item) result(task)
      type(numbers_t), intent(in) :: n
      integer, intent(in) :: kind, round, item

      task = item
      if (round == 0) return
      task = task + n%leads + (round - 1)*(n%joints + n%parts + n%leads)
      if (kind == DO_PART) task = task + n%joints
      if (kind == DO_LEADS) task = task + n%joints + n%parts
   end function task_of

   !> Pieces of the joints on leads from..to that are no hubs
   pure function pieces_at(map, ends, hub, piece) result(pieces)
      type(lead_map_t), intent(in) :: map
      integer, intent(in) :: ends(2)
      logical, intent(in) :: hub(:)
      integer, intent(in) :: piece(:)
      integer, allocatable :: pieces(:)

      integer :: lead, n

      allocate (pieces(map%first(ends(2) + 1) - map%first(ends(1))))
      n = 0
      do lead = ends(1), ends(2)
         if (hub(lead)) cycle
         associate (entries => map%joint(map%first(lead):map%first(lead + 1) - 1))
            pieces(n + 1:n + size(entries)) = piece(abs(entries))
            n = n + size(entries)
         end associate
      end do
      pieces = pieces(:n)
   end function pieces_at

   !> The different ones, ascending
   pure function distinct(values, most) result(list)
      integer, intent(in) :: values(:), most
      integer, allocatable :: list(:)

      integer :: i, low
      logical, allocatable :: there(:)

      list = [integer ::]
      if (size(values) == 0) return
      low = minval(values)
      allocate (there(low:min(most, maxval(values))), source=.false.)
      there(values) = .true.
      list = pack([(i, i=low, ubound(there, 1))], there)
   end function distinct

   pure subroutine place_joints(n, owner, graph)
      type(numbers_t), intent(in) :: n
      integer, intent(in) :: owner(:)
      type(graph_t), intent(inout) :: graph

      integer :: i, r, t

      do r = 1, n%rounds
         do i = 1, n%joints
            t = task_of(n, DO_JOINTS, r, i)
            graph%place(t) = i
            graph%owner(t) = owner(i)
         end do
      end do
   end subroutine place_joints

   !> Where a task begins, and the share that has all its joints; leads without joints are of the
   !> first share
   pure subroutine place_task(n, kind, item, pieces, owner, graph)
      type(numbers_t), intent(in) :: n
      integer, intent(in) :: kind, item, pieces(:), owner(:)
      type(graph_t), intent(inout) :: graph

      integer :: r, t

      do r = merge(0, 1, kind == DO_LEADS), n%rounds
         t = task_of(n, kind, r, item)
         graph%owner(t) = 1
         if (size(pieces) == 0) cycle
         graph%place(t) = pieces(1)
         graph%owner(t) = merge(owner(pieces(1)), 0, all(owner(pieces) == owner(pieces(1))))
      end do
   end subroutine place_task

   !> Leads come before their joints and after them, round by round, and then once more
   pure subroutine link_leads(n, item, pieces, pairs)
      type(numbers_t), intent(in) :: n
      integer, intent(in) :: item, pieces(:)
      type(pairs_t), intent(inout) :: pairs

      integer :: r, i

      do r = 1, n%rounds
         associate (before => task_of(n, DO_LEADS, r - 1, item), &
            after => task_of(n, DO_LEADS, r, item))
            call add_pair(before, after, 0, pairs)
            do i = 1, size(pieces)
               call add_pair(before, task_of(n, DO_JOINTS, r, pieces(i)), 0, pairs)
               call add_pair(task_of(n, DO_JOINTS, r, pieces(i)), after, 0, pairs)
            end do
         end associate
      end do
      call add_pair(task_of(n, DO_LEADS, n%rounds, item), task_of(n, DO_LEADS, 0, item), 1, pairs)
   end subroutine link_leads

   !> A part of a hub is summed before its joints find other wrenches
   pure subroutine link_part(n, item, pieces, pairs)
      type(numbers_t), intent(in) :: n
      integer, intent(in) :: item, pieces(:)
      type(pairs_t), intent(inout) :: pairs

      integer :: r, i

      do i = 1, size(pieces)
         do r = 1, n%rounds
            call add_pair(task_of(n, DO_JOINTS, r, pieces(i)), task_of(n, DO_PART, r, item), 0, &
               pairs)
            if (r < n%rounds) call add_pair(task_of(n, DO_PART, r, item), &
               task_of(n, DO_JOINTS, r + 1, pieces(i)), 0, pairs)
         end do
         call add_pair(task_of(n, DO_PART, n%rounds, item), task_of(n, DO_JOINTS, 1, pieces(i)), &
            1, pairs)
      end do
   end subroutine link_part

   pure subroutine add_pair(before, after, lag, pairs)
      integer, intent(in) :: before, after, lag
      type(pairs_t), intent(inout) :: pairs

      if (pairs%n == size(pairs%before)) then
         pairs%before = [pairs%before, pairs%before]
         pairs%after = [pairs%after, pairs%after]
         pairs%lag = [pairs%lag, pairs%lag]
      end if
      pairs%n = pairs%n + 1
      pairs%before(pairs%n) = before
      pairs%after(pairs%n) = after
      pairs%lag(pairs%n) = lag
   end subroutine add_pair

   !> Rows of what waits for each task, and how many each waits for
   pure subroutine link_tasks(pairs, graph)
      type(pairs_t), intent(in) :: pairs
      type(graph_t), intent(inout) :: graph

      integer :: i, t

      allocate (graph%first(graph%n + 1), source=0)
      allocate (graph%waits(graph%n, 0:1), source=0)
      allocate (graph%next(pairs%n), graph%lag(pairs%n))
      do i = 1, pairs%n
         graph%first(pairs%before(i)) = graph%first(pairs%before(i)) + 1
         associate (waits => graph%waits(pairs%after(i), pairs%lag(i)))
            waits = waits + 1
         end associate
      end do
      do t = 2, graph%n + 1
         graph%first(t) = graph%first(t) + graph%first(t - 1)
      end do
      do i = pairs%n, 1, -1                       ! rows are filled from their ends
         t = pairs%before(i)
         graph%next(graph%first(t)) = pairs%after(i)
         graph%lag(graph%first(t)) = pairs%lag(i)
         graph%first(t) = graph%first(t) - 1
      end do
      graph%first = graph%first + 1
   end subroutine link_tasks

end module kj_task_graph
