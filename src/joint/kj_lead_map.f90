!> Sum of joint wrenches into the leads that carry them. Each lead gathers its own joints in
!> ascending order, so the bits of the result do not depend on the number of threads. A lead with
!> more than SPAN joint ends, a "hub", sums them SPAN by SPAN: threads share these parts.
module kj_lead_map
   use kj_kinds, only: wp
   use kj_sort, only: lower_bound
   use kj_block, only: BLOCK
   implicit none
   private

   public :: lead_map_t, build_lead_map, sum_hubs, gather_wrenches, gather_abreast, first_hub, &
      is_hub, sum_hub

   !> Rows of the wrench of a joint
   integer, parameter, public :: W_FORCE = 1     !! 1-3: force on end 1, W; end 2 gets the opposite
   integer, parameter, public :: W_MOMENT1 = 4   !! 4-6: moment about the lead of end 1, W
   integer, parameter, public :: W_MOMENT2 = 7   !! 7-9: moment about the lead of end 2, W
   integer, parameter, public :: W_KN1 = 10, W_KN2 = 11   !! stiffness of each end, translation,
   integer, parameter, public :: W_KR1 = 12, W_KR2 = 13   !! and rotation, at the lead
   integer, parameter, public :: N_WRENCH = 13

   integer, parameter :: SPAN = 64
   integer, parameter, public :: N_SUM = 8        !! rows of a sum: force, moment, kn, kr
   integer, parameter :: WORTH_IT = 32            !! parts that threads share

   !> For each lead, the joint ends that act on it (compressed rows)
   type :: lead_map_t
      integer, allocatable :: first(:)   !! (n_lead + 1) start of each lead's row
      integer, allocatable :: joint(:)   !! (2 n_joint) joint of each entry; negative at end 2
      integer, allocatable :: hub(:)     !! leads with more than SPAN entries, ascending
      integer, allocatable :: part(:)    !! (hubs + 1) first part of each hub
      !> Joints of a block are at leads of a block, place by place, and of each nine rows of a
      !> wrench its places follow each other; no hubs
      logical :: abreast = .false.
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

   !> Sum of the wrenches of a part of hub h
   pure subroutine sum_part(map, wrench, h, part, total)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (rows of one, n_joint)
      integer, intent(in) :: h, part
      real(wp), intent(out) :: total(N_SUM)

      integer :: entries(2)

      entries = part_entries(map, h, part)
      call sum_entries(entries(1), entries(2), map%joint, wrench, total)
   end subroutine sum_part

   !> Sums of all parts of hubs
   subroutine sum_hubs(map, threads, wrench, part)
      type(lead_map_t), intent(in) :: map
      integer, intent(in) :: threads
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (rows of one, n_joint)
      real(wp), intent(inout) :: part(:, :)      !! (N_SUM, parts)

      integer :: h, p

      do h = 1, size(map%hub)
         if (threads == 1 .or. map%part(h + 1) - map%part(h) < WORTH_IT) then
            do p = map%part(h), map%part(h + 1) - 1
               call sum_part(map, wrench, h, p, part(:, p))
            end do
            cycle
         end if
         !$omp parallel do num_threads(threads)
         do p = map%part(h), map%part(h + 1) - 1
            call sum_part(map, wrench, h, p, part(:, p))
         end do
      end do
   end subroutine sum_hubs

   !> f, m, kn, kr of leads lo..hi := sums over their joints, of hubs over their parts; row 1 is
   !> lead lo. kn and kr are 0 where wrenches have none.
   pure subroutine gather_wrenches(map, wrench, part, lo, hi, f, m, kn, kr)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (rows of one, n_joint)
      real(wp), intent(in) :: part(:, :)         !! (N_SUM, parts), see sum_hubs
      integer, intent(in) :: lo, hi
      !> (>= hi - lo + 1, 3), W, and (>= hi - lo + 1)
      real(wp), contiguous, intent(inout) :: f(lo:, :), m(lo:, :), kn(lo:), kr(lo:)

      real(wp) :: total(N_SUM), of_hub(N_SUM)
      logical :: stiff
      integer :: lead, h, i, j, k

      stiff = size(wrench, 1) >= W_KR2
      h = first_hub(map, lo)
      do lead = lo, hi
         if (is_hub(map, lead)) then
            call sum_hub(map, part, h, of_hub)
            total = of_hub
         else
            total = 0.0_wp
            do i = map%first(lead), map%first(lead + 1) - 1
               j = map%joint(i)
               if (j > 0) then
                  do k = 1, 6
                     total(k) = total(k) + wrench(k, j)
                  end do
                  if (stiff) total(7) = total(7) + wrench(W_KN1, j)
                  if (stiff) total(8) = total(8) + wrench(W_KR1, j)
               else
                  do k = 1, 3
                     total(k) = total(k) - wrench(k, -j)
                     total(k + 3) = total(k + 3) + wrench(k + 6, -j)
                  end do
                  if (stiff) total(7) = total(7) + wrench(W_KN2, -j)
                  if (stiff) total(8) = total(8) + wrench(W_KR2, -j)
               end if
            end do
         end if
         do k = 1, 3
            f(lead, k) = total(k)
            m(lead, k) = total(k + 3)
         end do
         kn(lead) = total(7)
         kr(lead) = total(8)
      end do
   end subroutine gather_wrenches

   !> A lead with more than SPAN joint ends
   pure logical function is_hub(map, lead)
      type(lead_map_t), intent(in) :: map
      integer, intent(in) :: lead

      is_hub = map%first(lead + 1) - map%first(lead) > SPAN
   end function is_hub

   !> The first hub that is lead `lo` or comes after it
   pure integer function first_hub(map, lo)
      type(lead_map_t), intent(in) :: map
      integer, intent(in) :: lo

      first_hub = 1
      if (size(map%hub) > 0) first_hub = lower_bound(map%hub, lo)
   end function first_hub

   !> The sum of a hub over its parts: force, moment, kn, kr
   pure subroutine sum_hub(map, part, hub, total)
      type(lead_map_t), intent(in) :: map
      real(wp), intent(in) :: part(:, :)         !! (N_SUM, parts), see sum_hubs
      integer, intent(inout) :: hub              !! its number; then the next
      real(wp), intent(out) :: total(N_SUM)

      integer :: p

      total = 0.0_wp
      do p = map%part(hub), map%part(hub + 1) - 1
         total = total + part(:, p)
      end do
      hub = hub + 1
   end subroutine sum_hub

   !> Force and moment of the first n leads of the block that begins with lo, of joints abreast
   pure subroutine gather_abreast(map, wrench, lo, n, total)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (9, n_joint)
      integer, intent(in) :: lo, n
      real(wp), intent(out) :: total(BLOCK, 6)

      integer :: i, j

      total(:n, :) = 0.0_wp
      do i = map%first(lo), map%first(lo + 1) - 1
         j = abs(map%joint(i))
         call add_block(n, map%joint(i) > 0, wrench(:, j:j + BLOCK - 1), total)
      end do
   end subroutine gather_abreast

   pure subroutine add_block(n, at_first, wrench, total)
      integer, intent(in) :: n
      logical, intent(in) :: at_first            !! end of the joints
      real(wp), intent(in) :: wrench(BLOCK, 9)
      real(wp), intent(inout) :: total(BLOCK, 6)

      if (at_first) then
         total(:n, :) = total(:n, :) + wrench(:n, W_FORCE:W_MOMENT1 + 2)
      else
         total(:n, :3) = total(:n, :3) - wrench(:n, W_FORCE:W_FORCE + 2)
         total(:n, 4:) = total(:n, 4:) + wrench(:n, W_MOMENT2:W_MOMENT2 + 2)
      end if
   end subroutine add_block

   !> Sum over the entries first..last
   pure subroutine sum_entries(first, last, joint, wrench, total)
      integer, intent(in) :: first, last
      integer, contiguous, intent(in) :: joint(:)         !! of each entry
      real(wp), contiguous, intent(in) :: wrench(:, :)
      real(wp), intent(out) :: total(N_SUM)

      real(wp) :: force(3), moment(3), s, r
      logical :: stiff
      integer :: i, j

      stiff = size(wrench, 1) >= W_KR2
      force = 0.0_wp
      moment = 0.0_wp
      s = 0.0_wp
      r = 0.0_wp
      do i = first, last
         j = abs(joint(i))
         if (joint(i) > 0) then
            force = force + wrench(W_FORCE:W_FORCE + 2, j)
            moment = moment + wrench(W_MOMENT1:W_MOMENT1 + 2, j)
            if (stiff) s = s + wrench(W_KN1, j)
            if (stiff) r = r + wrench(W_KR1, j)
         else
            force = force - wrench(W_FORCE:W_FORCE + 2, j)
            moment = moment + wrench(W_MOMENT2:W_MOMENT2 + 2, j)
            if (stiff) s = s + wrench(W_KN2, j)
            if (stiff) r = r + wrench(W_KR2, j)
         end if
      end do
      total(1:3) = force
      total(4:6) = moment
      total(7) = s
      total(8) = r
   end subroutine sum_entries

end module kj_lead_map
