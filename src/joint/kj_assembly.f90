!> Sum of joint wrenches into the leads that carry them. Each lead gathers its own joints in
!> ascending order, so the bits of the result do not depend on the number of threads. A lead with
!> more than SPAN joint ends, a "hub", sums them SPAN by SPAN: threads can share these parts.
module kj_assembly
   use kj_kinds, only: wp
   use kj_joint_force, only: W_FORCE, W_MOMENT1, W_MOMENT2, W_KN, W_KR1, W_KR2
   implicit none
   private

   public :: lead_map_t, build_lead_map, part_entries, sum_part, gather_wrenches

   integer, parameter, public :: SPAN = 512
   integer, parameter, public :: N_SUM = 8        !! rows of a sum: force, moment, kn, kr

   !> For each lead, the joint ends that act on it (compressed rows)
   type :: lead_map_t
      integer, allocatable :: first(:)   !! (n_lead + 1) start of each lead's row
      integer, allocatable :: joint(:)   !! (2 n_joint) joint of each entry; negative at end 2
      integer, allocatable :: hub(:)     !! leads with more than SPAN entries, ascending
      integer, allocatable :: part(:)    !! (hubs + 1) first part of each hub
   end type lead_map_t

contains

   !> Build the map once, before the step loop
   pure subroutine build_lead_map(n_lead, ends, map)
      integer, intent(in) :: n_lead
      integer, intent(in) :: ends(:, :)   !! (2, n_joint) lead at each end
      type(lead_map_t), intent(out) :: map

      integer, allocatable :: next(:)
      integer :: j, e, lead

      allocate (map%first(n_lead + 1), map%joint(size(ends)))
      allocate (next(n_lead), source=0)
      do j = 1, size(ends, 2)
         do e = 1, 2
            next(ends(e, j)) = next(ends(e, j)) + 1
         end do
      end do
      map%first(1) = 1
      do lead = 1, n_lead
         map%first(lead + 1) = map%first(lead) + next(lead)
      end do
      next(:) = map%first(:n_lead)
      do j = 1, size(ends, 2)
         do e = 1, 2
            lead = ends(e, j)
            map%joint(next(lead)) = merge(j, -j, e == 1)
            next(lead) = next(lead) + 1
         end do
      end do
      next(:) = map%first(2:) - map%first(:n_lead)
      map%hub = pack([(lead, lead=1, n_lead)], next > SPAN)
      allocate (map%part(size(map%hub) + 1))
      map%part(1) = 1
      do j = 1, size(map%hub)
         map%part(j + 1) = map%part(j) + (next(map%hub(j)) + SPAN - 1)/SPAN
      end do
   end subroutine build_lead_map

   !> First and last entry of a part of hub h
   pure function part_entries(map, h, part) result(entries)
      type(lead_map_t), intent(in) :: map
      integer, intent(in) :: h, part
      integer :: entries(2)

      entries(1) = map%first(map%hub(h)) + SPAN*(part - map%part(h))
      entries(2) = min(entries(1) + SPAN, map%first(map%hub(h) + 1)) - 1
   end function part_entries

   !> The hub that a lead with many entries is
   pure integer function hub_of(map, lead) result(lo)
      type(lead_map_t), intent(in) :: map
      integer, intent(in) :: lead

      integer :: hi, middle

      lo = 1
      hi = size(map%hub)
      do while (lo < hi)
         middle = (lo + hi)/2
         if (map%hub(middle) < lead) then
            lo = middle + 1
         else
            hi = middle
         end if
      end do
   end function hub_of

   !> Sum of the wrenches of a part of hub h
   pure subroutine sum_part(map, wrench, h, part, total)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (N_WRENCH, n_joint)
      integer, intent(in) :: h, part
      real(wp), intent(out) :: total(N_SUM)

      integer :: entries(2)

      entries = part_entries(map, h, part)
      call sum_entries(map%joint(entries(1):entries(2)), wrench, total)
   end subroutine sum_part

   pure subroutine sum_entries(joint, wrench, total)
      integer, intent(in) :: joint(:)
      real(wp), contiguous, intent(in) :: wrench(:, :)
      real(wp), intent(out) :: total(N_SUM)

      real(wp) :: force(3), moment(3), s, r
      integer :: i, j

      force = 0.0_wp
      moment = 0.0_wp
      s = 0.0_wp
      r = 0.0_wp
      do i = 1, size(joint)
         j = abs(joint(i))
         s = s + wrench(W_KN, j)
         if (joint(i) > 0) then
            force = force + wrench(W_FORCE:W_FORCE + 2, j)
            moment = moment + wrench(W_MOMENT1:W_MOMENT1 + 2, j)
            r = r + wrench(W_KR1, j)
         else
            force = force - wrench(W_FORCE:W_FORCE + 2, j)
            moment = moment + wrench(W_MOMENT2:W_MOMENT2 + 2, j)
            r = r + wrench(W_KR2, j)
         end if
      end do
      total(1:3) = force
      total(4:6) = moment
      total(7) = s
      total(8) = r
   end subroutine sum_entries

   !> f, m, kn, kr of leads lo..hi := sums over their joints; row 1 is lead lo
   pure subroutine gather_wrenches(map, wrench, ready, part, lo, hi, f, m, kn, kr)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (N_WRENCH, n_joint)
      logical, intent(in) :: ready(:)            !! the sum of this part of a hub is there
      real(wp), intent(in) :: part(:, :)         !! (N_SUM, parts)
      integer, intent(in) :: lo, hi
      real(wp), contiguous, intent(inout) :: f(:, :), m(:, :)   !! (>= hi - lo + 1, 3), W
      real(wp), contiguous, intent(inout) :: kn(:), kr(:)       !! (>= hi - lo + 1)

      real(wp) :: total(N_SUM)
      integer :: lead, n, i

      do lead = lo, hi
         n = map%first(lead + 1) - map%first(lead)
         if (n <= SPAN) then
            call sum_entries(map%joint(map%first(lead):map%first(lead + 1) - 1), wrench, total)
         else
            call sum_parts(map, wrench, ready, part, hub_of(map, lead), total)
         end if
         i = lead - lo + 1
         f(i, :) = total(1:3)
         m(i, :) = total(4:6)
         kn(i) = total(7)
         kr(i) = total(8)
      end do
   end subroutine gather_wrenches

   !> Sum of the parts of hub h, those that are not ready included
   pure subroutine sum_parts(map, wrench, ready, part, h, total)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)
      logical, intent(in) :: ready(:)
      real(wp), intent(in) :: part(:, :)
      integer, intent(in) :: h
      real(wp), intent(out) :: total(N_SUM)

      real(wp) :: more(N_SUM)
      integer :: p

      total = 0.0_wp
      do p = map%part(h), map%part(h + 1) - 1
         if (ready(p)) then
            more = part(:, p)
         else
            call sum_part(map, wrench, h, p, more)
         end if
         total = total + more
      end do
   end subroutine sum_parts

end module kj_assembly
