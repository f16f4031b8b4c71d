!> Sum of joint wrenches into the leads that carry them. Each lead gathers its own joints in
!> ascending order, so the bits of the result do not depend on the number of threads.
module kj_assembly
   use kj_kinds, only: wp
   use kj_joint_force, only: W_FORCE, W_MOMENT1, W_MOMENT2, W_KN, W_KR1, W_KR2
   implicit none
   private

   public :: lead_map_t, build_lead_map, gather_wrenches

   !> For each lead, the joint ends that act on it (compressed rows)
   type :: lead_map_t
      integer, allocatable :: first(:)   !! (n_lead + 1) start of each lead's row
      integer, allocatable :: joint(:)   !! (2 n_joint) joint of each entry; negative at end 2
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
   end subroutine build_lead_map

   !> f, m, kn, kr of leads lo..hi := sums over their joints
   pure subroutine gather_wrenches(map, wrench, lo, hi, f, m, kn, kr)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)    !! (N_WRENCH, n_joint)
      integer, intent(in) :: lo, hi
      real(wp), contiguous, intent(inout) :: f(:, :), m(:, :)   !! (n_lead, 3), W
      real(wp), contiguous, intent(inout) :: kn(:), kr(:)       !! (n_lead)

      real(wp) :: force(3), moment(3), s, r
      integer :: lead, i, j

      do lead = lo, hi
         force = 0.0_wp
         moment = 0.0_wp
         s = 0.0_wp
         r = 0.0_wp
         do i = map%first(lead), map%first(lead + 1) - 1
            j = abs(map%joint(i))
            s = s + wrench(W_KN, j)
            if (map%joint(i) > 0) then
               force = force + wrench(W_FORCE:W_FORCE + 2, j)
               moment = moment + wrench(W_MOMENT1:W_MOMENT1 + 2, j)
               r = r + wrench(W_KR1, j)
            else
               force = force - wrench(W_FORCE:W_FORCE + 2, j)
               moment = moment + wrench(W_MOMENT2:W_MOMENT2 + 2, j)
               r = r + wrench(W_KR2, j)
            end if
         end do
         f(lead, :) = force
         m(lead, :) = moment
         kn(lead) = s
         kr(lead) = r
      end do
   end subroutine gather_wrenches

end module kj_assembly
