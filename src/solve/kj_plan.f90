!> The order in which a cycle takes its joints and leads: a thread goes through its joints piece by
!> piece, and turns to leads as soon as all their joints are done, while the wrenches are still in
!> its cache. Leads whose joints belong to several threads come late, in a stage of their own.
module kj_plan
   use kj_sort, only: sorted_order
   use kj_team, only: team_t
   use kj_assembly, only: lead_map_t, part_entries
   implicit none
   private

   public :: plan_t, new_plan

   integer, parameter, public :: DO_JOINTS = 0, DO_PART = 1, DO_LEADS = 2

   !> The order
   type :: plan_t
      integer, allocatable :: kind(:)             !! of each task, DO_ constant
      integer, allocatable :: item(:)             !! piece of joints, part of a hub, piece of leads
      integer, allocatable :: shares(:)           !! (0:threads) tasks, see kj_team
      integer, allocatable :: late(:)             !! pieces of leads of the second stage
      integer, allocatable :: late_shares(:)      !! (0:threads)
      integer, allocatable :: hub(:)              !! (parts) the hub of each part
      logical, allocatable :: ready(:)            !! (parts) summed by a task
   end type plan_t

contains

   !> Plan for the joints and leads of a team
   pure subroutine new_plan(first, map, team, plan)
      integer, intent(in) :: first(:)             !! of each batch, number of the joints before it
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      type(plan_t), intent(out) :: plan

      ! (2, n) first and last piece of joints that each part of a hub and piece of leads waits for
      integer, allocatable :: part(:, :), leads(:, :)
      logical, allocatable :: early(:)
      integer :: i, n_part

      n_part = map%part(size(map%part)) - 1
      allocate (part(2, n_part), leads(2, size(team%lead, 2)), plan%hub(n_part))
      do i = 1, size(map%hub)
         plan%hub(map%part(i):map%part(i + 1) - 1) = i
      end do
      call find_waits(first, map, team, part, leads)
      plan%ready = are_early(team, part)
      early = are_early(team, leads)
      plan%late = pack([(i, i=1, size(early))], .not. early)
      allocate (plan%shares(0:team%threads), plan%late_shares(0:team%threads))
      plan%late_shares = [((i*size(plan%late))/team%threads, i=0, team%threads)]
      call list_tasks(team, early, part(2, :), leads(2, :), plan)
   end subroutine new_plan

   !> One thread has all the joints that something waits for
   pure function are_early(team, wait) result(early)
      type(team_t), intent(in) :: team
      integer, intent(in) :: wait(:, :)           !! (2, n) first and last piece, 0 for none
      logical :: early(size(wait, 2))

      integer :: owner(size(team%joint, 2)), i, t

      do t = 1, team%threads
         owner(team%joints(t - 1) + 1:team%joints(t)) = t
      end do
      do i = 1, size(early)
         early(i) = wait(2, i) > 0
         if (early(i)) early(i) = owner(wait(1, i)) == owner(wait(2, i))
      end do
   end function are_early

   !> What the parts of hubs and the pieces of leads wait for
   pure subroutine find_waits(first, map, team, part, leads)
      integer, intent(in) :: first(:)
      type(lead_map_t), intent(in) :: map
      type(team_t), intent(in) :: team
      integer, intent(out) :: part(:, :), leads(:, :)

      integer, allocatable :: piece(:)            !! of each joint
      integer :: i, h, entries(2)

      allocate (piece(size(map%joint)/2))
      do i = 1, size(team%joint, 2)
         associate (j => team%joint(:, i))
            piece(first(j(1)) + j(2):first(j(1)) + j(3)) = i
         end associate
      end do
      do h = 1, size(map%hub)
         do i = map%part(h), map%part(h + 1) - 1
            entries = part_entries(map, h, i)
            part(:, i) = ends_of(piece(abs(map%joint(entries(1):entries(2)))))
         end do
      end do
      do i = 1, size(leads, 2)
         entries = [map%first(team%lead(1, i)), map%first(team%lead(2, i) + 1) - 1]
         leads(:, i) = ends_of(piece(abs(map%joint(entries(1):entries(2)))))
      end do
   end subroutine find_waits

   !> First and last of these pieces, 0 where there are none
   pure function ends_of(piece) result(ends)
      integer, intent(in) :: piece(:)
      integer :: ends(2)

      ends = 0
      if (size(piece) > 0) ends = [minval(piece), maxval(piece)]
   end function ends_of

   !> Each piece of joints, followed by what waited for it alone
   pure subroutine list_tasks(team, early, part_last, leads_last, plan)
      type(team_t), intent(in) :: team
      logical, intent(in) :: early(:)             !! of pieces of leads
      integer, intent(in) :: part_last(:), leads_last(:)
      type(plan_t), intent(inout) :: plan

      integer, allocatable :: parts(:), leads(:), after(:), order(:)
      integer :: i, n

      n = size(team%joint, 2)
      parts = pack([(i, i=1, size(plan%ready))], plan%ready)
      leads = pack([(i, i=1, size(early))], early)
      plan%kind = [spread(DO_JOINTS, 1, n), spread(DO_PART, 1, size(parts)), &
         spread(DO_LEADS, 1, size(leads))]
      plan%item = [[(i, i=1, n)], parts, leads]
      after = [[(i, i=1, n)], part_last(parts), leads_last(leads)]
      order = sorted_order(after)                 ! stable: joints, then parts, then leads
      plan%kind = plan%kind(order)
      plan%item = plan%item(order)
      plan%shares = [(count(after <= team%joints(i)), i=0, team%threads)]
   end subroutine list_tasks

end module kj_plan
