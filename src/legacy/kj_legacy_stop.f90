!> Stops, friction and lock of one local dof of KJOINT2 for a block of joints.
!>
!> Each adds its force to f and its stiffness to k_eff, raises the time-step stiffness k_top, and
!> says by `acts` where it acts: there the critical damping of the dof is switched on.
!> Source: docs/theory/legacy.md 4.1 to 4.3.
module kj_legacy_stop
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_batch, only: limits_t, has_friction
   implicit none
   private

   public :: plain_overlap, combined_overlap, add_friction, add_stop, add_lock

   real(wp), parameter :: TINY_VALUE = 1.0e-20_wp         !! nothing is given, or not touched
   real(wp), parameter :: NEAR = real(0.001, wp)          !! close to a stop, single precision

contains

   !> How far q is beyond the stops of a dof; a stop 0 is none.
   !>
   !> over = max(0, q - hi) for q, hi > 0;  min(0, q - lo) for q, lo < 0
   !>
   !> Legacy quirk, kept on purpose: only the upper stop is seen from near.
   pure subroutine plain_overlap(n, q, lo, hi, over, direction, nearby)
      integer, value :: n
      real(wp), intent(in) :: q(n), lo(n), hi(n)
      real(wp), intent(out) :: over(n)          !! signed
      real(wp), intent(out) :: direction(n)     !! of the stop force: 1
      logical, intent(out) :: nearby(n)         !! within a thousandth of the upper stop

      integer :: i

      do i = 1, n
         over(i) = 0.0_wp
         direction(i) = 1.0_wp
         nearby(i) = .false.
         if (hi(i) > 0.0_wp) then
            if (q(i) > 0.0_wp) over(i) = max(0.0_wp, q(i) - hi(i))
            nearby(i) = abs((q(i) - hi(i))/hi(i)) < NEAR
         end if
         if (lo(i) < 0.0_wp .and. q(i) < 0.0_wp) over(i) = min(0.0_wp, q(i) - lo(i))
      end do
   end subroutine plain_overlap

   !> The same for dofs whose stops are combined to a circle or sphere; others stay as they are.
   !>
   !> c = (lo + hi)/2, rho = (hi - lo)/2, reach^2 = sum (q - c)^2 over the combined dofs;
   !> over = max(0, reach - rho) along (q - c)/reach
   pure subroutine combined_overlap(n, q, lo, hi, combined, reach, over, direction, nearby)
      integer, value :: n
      real(wp), intent(in) :: q(n), lo(n), hi(n)
      real(wp), intent(in) :: combined(n)       !! 1 or 0
      real(wp), intent(in) :: reach(n)
      real(wp), intent(inout) :: over(n), direction(n)
      logical, intent(inout) :: nearby(n)

      real(wp) :: rho
      integer :: i

      do i = 1, n
         if (.not. combined(i) > 0.0_wp) cycle
         rho = 0.5_wp*(hi(i) - lo(i))
         over(i) = max(0.0_wp, reach(i) - rho)
         direction(i) = 0.0_wp
         if (reach(i) > 0.0_wp) direction(i) = (q(i) - 0.5_wp*(lo(i) + hi(i)))/reach(i)
         nearby(i) = .false.
         if (rho > 0.0_wp) nearby(i) = abs((reach(i) - rho)/rho) < NEAR
      end do
   end subroutine combined_overlap

   !> Friction: a spring on the increments of q that slips at its limit, but not beyond a stop.
   !>
   !>   r := r + k dq, limited to |r| <= slip |g(q)|,  f += r,  energy += r (trial - r)/k
   !>
   !> dq = qdot h12 with the h12 of the cycle before, as the legacy scheme has it. The increment of
   !> combined dofs counts by their direction outside of the circle and not at all inside.
   pure subroutine add_friction(n, curves, curve, k, slip, combined, over, direction, q, dq, r, f, &
      k_eff, k_top, energy, slides, acts)
      integer, value :: n
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: curve(n)           !! index of the curve of the limit, 0 = none
      real(wp), intent(in) :: k(n)              !! stiffness of friction
      real(wp), intent(in) :: slip(n)           !! limit, or scale of its curve
      real(wp), intent(in) :: combined(n), over(n), direction(n)
      real(wp), intent(in) :: q(n), dq(n)
      real(wp), intent(inout) :: r(n)           !! friction force
      real(wp), intent(inout) :: f(n), k_eff(n), k_top(n)
      real(wp), intent(inout) :: energy(n)      !! taken by sliding
      logical, intent(out) :: slides(n)
      logical, intent(inout) :: acts(n)

      real(wp) :: limit, slope, k_most, trial, r_old, beta, k_tan
      logical :: beyond
      integer :: i

      do i = 1, n
         slides(i) = .false.
         if (.not. has_friction(k(i), slip(i), curve(i))) cycle
         limit = slip(i)
         k_most = k(i)
         if (curve(i) > 0) then
            call law_value(curves, curve(i), q(i), limit, slope)
            limit = abs(slip(i)*limit)
            k_most = max(k(i), abs(slip(i)*slope))
         end if
         r_old = r(i)
         trial = r_old + k(i)*dq(i)
         beyond = abs(over(i)) > TINY_VALUE
         beta = min(1.0_wp, limit/sqrt(max(1.0e-30_wp, trial**2)))
         if (beyond) beta = 1.0_wp
         if (combined(i) > 0.0_wp) then
            trial = r_old
            if (beyond) trial = r_old + k(i)*dq(i)*abs(direction(i))
         end if
         r(i) = trial*beta
         slides(i) = beta < 1.0_wp
         k_tan = min(abs(r(i) - r_old)/max(1.0e-15_wp, dq(i)), k_most)
         f(i) = f(i) + r(i)
         k_eff(i) = k_eff(i) + k_tan
         k_top(i) = max(k_top(i), k_eff(i) + max(k_tan, k(i)))
         energy(i) = energy(i) + r(i)*(trial - r(i))/k(i)
         acts(i) = .true.
      end do
   end subroutine add_friction

   !> Stop of dofs without friction: f += k over along its direction.
   !>
   !> Just before the stop its stiffness already counts, without force.
   pure subroutine add_stop(n, rubs, k, k_block, over, direction, nearby, f, k_eff, k_top, stored, &
      acts)
      integer, value :: n
      logical, intent(in) :: rubs(n)            !! has friction: no stop of its own
      real(wp), intent(in) :: k(n)              !! stiffness of the stop, 0 = k_block
      real(wp), intent(in) :: k_block(n)        !! stiffness of the blocked dofs
      real(wp), intent(in) :: over(n), direction(n)
      logical, intent(in) :: nearby(n)
      real(wp), intent(inout) :: f(n), k_eff(n), k_top(n)
      real(wp), intent(inout) :: stored(n)      !! elastic energy
      logical, intent(inout) :: acts(n)

      real(wp) :: ks, push
      integer :: i

      do i = 1, n
         if (rubs(i) .or. .not. (nearby(i) .or. abs(over(i)) > 0.0_wp)) cycle
         ks = k(i)
         if (.not. ks > TINY_VALUE) ks = k_block(i)
         push = ks*over(i)*direction(i)
         f(i) = f(i) + push
         if (ks > 0.0_wp) stored(i) = stored(i) + 0.5_wp*push**2/ks
         k_eff(i) = k_eff(i) + ks
         k_top(i) = max(k_top(i), k_eff(i))
         acts(i) = .true.
      end do
   end subroutine add_stop

   !> Lock of a free dof: f += k_block (q - q_lock)
   pure subroutine add_lock(n, locked, k_block, q, q_lock, f, k_eff, k_top, stored, acts)
      integer, value :: n
      logical, intent(in) :: locked(n)
      real(wp), intent(in) :: k_block(n), q(n), q_lock(n)
      real(wp), intent(inout) :: f(n), k_eff(n), k_top(n), stored(n)
      logical, intent(inout) :: acts(n)

      integer :: i

      do i = 1, n
         if (.not. locked(i)) cycle
         f(i) = f(i) + k_block(i)*(q(i) - q_lock(i))
         stored(i) = stored(i) + 0.5_wp*k_block(i)*(q(i) - q_lock(i))**2
         k_eff(i) = k_eff(i) + k_block(i)
         k_top(i) = max(k_top(i), k_eff(i))
         acts(i) = .true.
      end do
   end subroutine add_lock

end module kj_legacy_stop
