!> Who waits for whom in a cycle, in what order, on which thread: docs/schedule.md has the drawing
!> and the words.
!>
!> A scene is cut into pieces of joints and of leads. Within a stage of a cycle joints do not see
!> each other, and neither do leads, so the bits of a run do not depend on how it is cut, or on
!> which thread does what. A thread takes the next share as soon as it is free, goes through it
!> piece by piece, and turns to what waits for a piece as soon as that is done, while its wrenches
!> are still in the cache. What waits for joints of several shares comes late, in stages of its own.
!>
!> Round 0 is leads alone, before their joints. A round is joints, parts of hubs, leads. A second
!> round starts for a joint as soon as the leads at both its ends have had their first.
!> One file: the cut and the order are one answer.
module kj_schedule
   use kj_sort, only: sorted_order
   use kj_lead_map, only: lead_map_t, part_entries
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   implicit none
   private

   public :: plan_t, stage_t, new_plan, plan_of_leads, team_t, new_team, owners, has_threads

   integer, parameter :: SHARES_OF_ONE = 4       !! for each thread, at most: slower ones do fewer
   integer, parameter :: LEAST_SHARE = 4096      !! joints or leads that are worth more than one
   integer, parameter :: PIECES = 2               !! in each share, at least
   !> Leads, or joints of all batches, in a piece: what comes next finds them in the cache
   integer, parameter, public :: MOST = 8*BLOCK
   integer, parameter :: FINE = 10**6             !! places along a batch that are told apart
   integer, parameter :: LEAD_WORK = 8            !! of a lead, in that of one joint end or node

   !> The pieces
   type :: team_t
      integer :: threads = 1
      !> (3, pieces) batch, first joint, last joint; all batches side by side, as decks have them
      integer, allocatable :: joint(:, :)
      integer, allocatable :: lead(:, :)          !! (2, pieces) first, last lead
      integer :: shares = 1                       !! pieces that a thread does in a row
      ! (0:shares) pieces up to the end of each share
      integer, allocatable :: joints(:)           !! of the pieces of joints
      integer, allocatable :: leads(:)            !! of the pieces of leads
   end type team_t

   !> What a task does with its item, a piece of joints, a part of a hub or a piece of leads
   integer, parameter, public :: DO_JOINTS = 1, DO_PART = 2, DO_LEADS = 3

   !> Tasks that threads share
   type :: stage_t
      integer, allocatable :: kind(:)             !! of each task, DO_ constant
      integer, allocatable :: round(:)            !! 0, 1 or 2
      integer, allocatable :: item(:)
      integer, allocatable :: shares(:)           !! (0:shares) tasks up to the end of each share
   end type stage_t

   !> Stages, one after the other
   type :: plan_t
      type(team_t) :: team                        !! whose pieces the items are
      type(stage_t), allocatable :: stage(:)
      integer, allocatable :: hub(:)              !! (parts) the hub of each part
      logical, allocatable :: ready(:, :)         !! (parts, rounds) summed by a task
   end type plan_t

   !> What pieces or parts wait for
   type :: wait_t
      integer, allocatable :: after(:)            !! piece of joints in its first round
      logical, allocatable :: early(:)            !! and for nothing of another share
   end type wait_t

   !> Tasks before they are put in order
   type :: tasks_t
      integer, allocatable :: kind(:), round(:), item(:), after(:)
      logical, allocatable :: early(:)
   end type tasks_t

contains

   ! ---- the cut: pieces and shares

   !> Cut a scene. It gets no more threads than it has joints and leads for: `least` each.
   pure subroutine new_team(threads, least, n_joint, n_end, team)
      integer, intent(in) :: threads, least
      integer, intent(in) :: n_joint(:)           !! of each batch
      integer, intent(in) :: n_end(:)             !! (n_lead) joint ends, and nodes to move, of each
      type(team_t), intent(out) :: team

      integer :: k, n, n_lead, length

      n_lead = size(n_end)
      n = sum(n_joint)
      team%threads = max(1, min(threads, max(n, n_lead)/max(1, least)))
      if (team%threads > 1) then
         k = max(1, min(SHARES_OF_ONE, max(n, n_lead)/(team%threads*LEAST_SHARE)))
         team%shares = k*team%threads
      end if
      call cut_batches(n_joint, min(MOST, piece_length(n, team%shares)), team%joint)
      length = min(MOST, piece_length(n_lead, team%shares))
      n = (n_lead + length - 1)/length
      allocate (team%lead(2, n))
      do k = 1, n
         team%lead(:, k) = [(k - 1)*length + 1, min(k*length, n_lead)]
      end do
      allocate (team%joints(0:team%shares), team%leads(0:team%shares))
      team%joints = fair_shares(real(team%joint(3, :) - team%joint(2, :) + 1, wp), team%shares)
      team%leads = fair_shares([(LEAD_WORK*real(team%lead(2, k) - team%lead(1, k) + 1, wp) + &
         sum(n_end(team%lead(1, k):team%lead(2, k))), k=1, n)], team%shares)
   end subroutine new_team

   !> Pieces of each batch, `length` joints of all batches together, in the order of their place
   !> along the batch
   pure subroutine cut_batches(n_joint, length, joint)
      integer, intent(in) :: n_joint(:), length
      integer, allocatable, intent(out) :: joint(:, :)

      integer :: b, k, n, from, step(size(n_joint))
      real(wp) :: blocks
      integer, allocatable :: place(:)

      blocks = real(length, wp)/BLOCK/max(1, sum(n_joint))
      n = 0
      do b = 1, size(n_joint)
         step(b) = BLOCK*max(1, ceiling(blocks*n_joint(b)))
         n = n + (n_joint(b) + step(b) - 1)/step(b)
      end do
      allocate (joint(3, n), place(n))
      k = 0
      do b = 1, size(n_joint)
         do from = 1, n_joint(b), step(b)
            k = k + 1
            joint(:, k) = [b, from, min(from + step(b) - 1, n_joint(b))]
            place(k) = int(FINE*(real(from - 1, wp)/n_joint(b)))
         end do
      end do
      joint = joint(:, sorted_order(place))
   end subroutine cut_batches

   !> (0:shares) pieces up to the end of each share, by the work of each piece
   pure function fair_shares(work, shares) result(to)
      real(wp), intent(in) :: work(:)
      integer, intent(in) :: shares
      integer :: to(0:shares)

      integer :: k, owner
      real(wp) :: before, total

      total = sum(work)
      to = 0
      before = 0.0_wp
      do k = 1, size(work)                        ! a piece belongs where its middle lies
         owner = min(shares, 1 + int(real(shares, wp)*(before + 0.5_wp*work(k))/total))
         to(owner:) = k
         before = before + work(k)
      end do
   end function fair_shares

   !> Share of each piece of joints
   pure function owners(team) result(owner)
      type(team_t), intent(in) :: team
      integer :: owner(size(team%joint, 2))

      integer :: s

      do s = 1, team%shares
         owner(team%joints(s - 1) + 1:team%joints(s)) = s
      end do
   end function owners

   !> Was this built with OpenMP?
   pure logical function has_threads()

      has_threads = .false.
      !$ has_threads = .true.
   end function has_threads

   !> A multiple of BLOCK; all of it where there is one share
   pure integer function piece_length(n, shares) result(length)
      integer, intent(in) :: n, shares

      length = n
      if (shares > 1) length = n/(PIECES*shares)
      length = BLOCK*(max(1, length + BLOCK - 1)/BLOCK)
      length = max(BLOCK, length)
   end function piece_length

   ! ---- the order: tasks and stages

   !> Plan for the joints and leads of a team: round 0 and one more, or two where `rests` is given
   pure subroutine new_plan(first, map, team, plan, rests)
      integer, intent(in) :: first(:)             !! of each batch, number of the joints before it
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      type(plan_t), intent(out) :: plan
      !> (n_lead) never moves: in the second round no joint waits for it where it is a hub
      logical, intent(in), optional :: rests(:)

      type(wait_t) :: joints, parts, leads
      type(tasks_t) :: tasks
      integer, allocatable :: piece(:)            !! of each joint
      integer :: i, round, rounds

      rounds = merge(2, 1, present(rests))
      plan%team = team
      plan%hub = hubs_of_parts(map)
      allocate (plan%ready(size(plan%hub), rounds))
      piece = pieces_of_joints(first, team, size(map%joint)/2)
      joints%after = [(i, i=1, size(team%joint, 2))]
      joints%early = spread(.true., 1, size(joints%after))
      call start_with_leads(map, team, piece, leads)
      tasks = no_tasks()
      call add_tasks(DO_LEADS, 0, leads, tasks)
      do round = 1, rounds
         if (round > 1) call wait_for_leads(map, team, rests, piece, parts, leads, joints)
         call wait_for_joints(map, team, piece, joints, parts, leads)
         plan%ready(:, round) = parts%early
         call add_tasks(DO_JOINTS, round, joints, tasks)
         call add_tasks(DO_PART, round, parts, tasks)
         call add_tasks(DO_LEADS, round, leads, tasks)
      end do
      call order_tasks(tasks, team, rounds, plan%stage)
   end subroutine new_plan

   !> The hub of each part
   pure function hubs_of_parts(map) result(hub)
      type(lead_map_t), intent(in) :: map
      integer, allocatable :: hub(:)

      integer :: i

      allocate (hub(map%part(size(map%part)) - 1))
      do i = 1, size(map%hub)
         hub(map%part(i):map%part(i + 1) - 1) = i
      end do
   end function hubs_of_parts

   !> The piece of each joint
   pure function pieces_of_joints(first, team, n_joint) result(piece)
      integer, intent(in) :: first(:)             !! of each batch, number of the joints before it
      type(team_t), intent(in) :: team
      integer, intent(in) :: n_joint
      integer :: piece(n_joint)

      integer :: i

      do i = 1, size(team%joint, 2)
         associate (j => team%joint(:, i))
            piece(first(j(1)) + j(2):first(j(1)) + j(3)) = i
         end associate
      end do
   end function pieces_of_joints

   !> All leads in one stage, without their joints
   pure subroutine plan_of_leads(team, plan)
      type(team_t), intent(in) :: team
      type(plan_t), intent(out) :: plan

      integer :: i, n

      n = size(team%lead, 2)
      plan%team = team
      allocate (plan%stage(0:0), plan%hub(0), plan%ready(0, 1))
      associate (stage => plan%stage(0))
         stage%kind = spread(DO_LEADS, 1, n)
         stage%round = spread(0, 1, n)
         stage%item = [(i, i=1, n)]
         stage%shares = team%leads
      end associate
   end subroutine plan_of_leads

   !> Where the pieces of leads begin: with the first of the joints that wait for them. Those that
   !> joints of several shares wait for come before all.
   pure subroutine start_with_leads(map, team, piece, leads)
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      integer, intent(in) :: piece(:)             !! of each joint
      type(wait_t), intent(out) :: leads

      integer, allocatable :: pieces(:)
      integer :: i, n, owner(size(team%joint, 2))

      owner = owners(team)
      n = size(team%lead, 2)
      allocate (leads%after(n), source=0)
      allocate (leads%early(n), source=.false.)
      do i = 1, n
         pieces = piece(abs(map%joint(map%first(team%lead(1, i)): &
            map%first(team%lead(2, i) + 1) - 1)))
         if (size(pieces) == 0) cycle
         leads%after(i) = minval(pieces)
         leads%early(i) = all(owner(pieces) == owner(pieces(1)))
      end do
   end subroutine start_with_leads

   !> What the parts of hubs and the pieces of leads wait for in a round
   pure subroutine wait_for_joints(map, team, piece, joints, parts, leads)
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      integer, intent(in) :: piece(:)             !! of each joint
      type(wait_t), intent(in) :: joints
      type(wait_t), intent(out) :: parts, leads

      integer :: i, h, entries(2), owner(size(team%joint, 2))

      owner = owners(team)
      i = map%part(size(map%part)) - 1
      allocate (parts%after(i), parts%early(i))
      do h = 1, size(map%hub)
         do i = map%part(h), map%part(h + 1) - 1
            entries = part_entries(map, h, i)
            call follow(joints, owner, piece(abs(map%joint(entries(1):entries(2)))), &
               parts%after(i), parts%early(i))
         end do
      end do
      allocate (leads%after(size(team%lead, 2)), leads%early(size(team%lead, 2)))
      do i = 1, size(team%lead, 2)
         entries = [map%first(team%lead(1, i)), map%first(team%lead(2, i) + 1) - 1]
         call follow(joints, owner, piece(abs(map%joint(entries(1):entries(2)))), &
            leads%after(i), leads%early(i))
      end do
   end subroutine wait_for_joints

   !> What waits for these pieces of joints: does one share have them all early?
   pure subroutine follow(joints, owner, pieces, after, early)
      type(wait_t), intent(in) :: joints
      integer, intent(in) :: owner(:), pieces(:)
      integer, intent(out) :: after
      logical, intent(out) :: early

      after = 0
      early = size(pieces) > 0
      if (.not. early) return
      after = maxval(joints%after(pieces))
      early = all(joints%early(pieces)) .and. all(owner(pieces) == owner(pieces(1)))
   end subroutine follow

   !> What joints wait for in the second round: that the leads at their ends, and the parts of hubs,
   !> have taken the wrenches of the first
   pure subroutine wait_for_leads(map, team, rests, piece, parts, leads, joints)
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      logical, intent(in) :: rests(:)
      integer, intent(in) :: piece(:)             !! of each joint
      type(wait_t), intent(in) :: parts, leads
      type(wait_t), intent(inout) :: joints

      integer :: i, h, lead, entries(2)
      logical :: free(size(rests))                ! no joint waits for it

      free = .false.
      free(map%hub) = rests(map%hub)
      do h = 1, size(map%hub)
         do i = map%part(h), map%part(h + 1) - 1
            entries = part_entries(map, h, i)
            call delay(joints, piece(abs(map%joint(entries(1):entries(2)))), parts%after(i), &
               parts%early(i))
         end do
      end do
      do i = 1, size(team%lead, 2)
         do lead = team%lead(1, i), team%lead(2, i)
            if (free(lead)) cycle
            entries = map%first(lead:lead + 1) - [0, 1]
            call delay(joints, piece(abs(map%joint(entries(1):entries(2)))), leads%after(i), &
               leads%early(i))
         end do
      end do
   end subroutine wait_for_leads

   !> These pieces of joints wait for something that comes after a piece, or late
   pure subroutine delay(joints, pieces, after, early)
      type(wait_t), intent(inout) :: joints
      integer, intent(in) :: pieces(:)
      integer, intent(in) :: after
      logical, intent(in) :: early

      integer :: i

      do i = 1, size(pieces)
         joints%after(pieces(i)) = max(joints%after(pieces(i)), after)
         joints%early(pieces(i)) = joints%early(pieces(i)) .and. early
      end do
   end subroutine delay

   pure type(tasks_t) function no_tasks() result(tasks)

      allocate (tasks%kind(0), tasks%round(0), tasks%item(0), tasks%after(0), tasks%early(0))
   end function no_tasks

   pure subroutine add_tasks(kind, round, wait, tasks)
      integer, intent(in) :: kind, round
      type(wait_t), intent(in) :: wait
      type(tasks_t), intent(inout) :: tasks

      integer :: i, n

      n = size(wait%after)
      tasks%kind = [tasks%kind, spread(kind, 1, n)]
      tasks%round = [tasks%round, spread(round, 1, n)]
      tasks%item = [tasks%item, [(i, i=1, n)]]
      tasks%after = [tasks%after, wait%after]
      tasks%early = [tasks%early, wait%early]
   end subroutine add_tasks

   !> The leads that several shares wait for; then each piece of joints, between its leads and what
   !> waited for it; then, round by round, late joints and late leads. Late parts are summed with
   !> their leads.
   pure subroutine order_tasks(tasks, team, rounds, stage)
      type(tasks_t), intent(in) :: tasks
      type(team_t), intent(in) :: team
      integer, intent(in) :: rounds
      type(stage_t), allocatable, intent(out) :: stage(:)

      integer, allocatable :: pick(:)
      integer :: i, round

      allocate (stage(0:2*rounds))
      stage(0) = late_stage(tasks, DO_LEADS, 0, team%shares)
      pick = pack([(i, i=1, size(tasks%early))], tasks%early)
      pick = pick(sorted_order(tasks%after(pick)))   ! stable
      stage(1) = stage_of(tasks, pick, [(count(tasks%after(pick) <= team%joints(i)), &
         i=0, team%shares)])
      do round = 1, rounds
         if (round > 1) stage(2*round - 1) = late_stage(tasks, DO_JOINTS, round, team%shares)
         stage(2*round) = late_stage(tasks, DO_LEADS, round, team%shares)
      end do
   end subroutine order_tasks

   !> What is late of a kind in a round
   pure type(stage_t) function late_stage(tasks, kind, round, shares) result(stage)
      type(tasks_t), intent(in) :: tasks
      integer, intent(in) :: kind, round, shares

      integer, allocatable :: pick(:)
      integer :: i

      pick = pack([(i, i=1, size(tasks%early))], .not. tasks%early .and. tasks%kind == kind .and. &
         tasks%round == round)
      stage = stage_of(tasks, pick, [((i*size(pick))/shares, i=0, shares)])
   end function late_stage

   pure type(stage_t) function stage_of(tasks, pick, shares) result(stage)
      type(tasks_t), intent(in) :: tasks
      integer, intent(in) :: pick(:)
      integer, intent(in) :: shares(0:)           !! (0:shares)

      stage%kind = tasks%kind(pick)
      stage%round = tasks%round(pick)
      stage%item = tasks%item(pick)
      allocate (stage%shares(0:ubound(shares, 1)))
      stage%shares = shares
   end function stage_of

end module kj_schedule
