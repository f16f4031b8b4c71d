!> Stops, friction and lock of a block of joints under the consistent formulation.
!>
!>   stop      f = k over along its direction, on both sides: a potential. With a Cr it is damped as
!>             blocked directions are, but never by more than its force: it begins without a jump
!>             and does not pull. Without, nothing is lost
!>   combined  one circle or sphere: over = |q - c| - rho along (q - c)/|q - c|
!>   friction  elastic-plastic (kj_consistent_friction)
!>   lock      f = k_block (q - q0), q0 the coordinate when the sensor acts
!>
!> Forces of one direction add up. A stuck spring and a lock are damped by Cr as blocked directions
!> are; that is left to the dampers (c_limit). Signs are those of q: force on node 1.
!> Source: docs/theory/consistent.md 9, 11.
module kj_consistent_stop
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: DOF_FREE, DOF_AT_STOP, DOF_LOCKED, DOF_BLOCKED, has_friction, &
      joint_batch_t
   use kj_block, only: BLOCK
   use kj_consistent_batch, only: limit_block_t
   use kj_consistent_friction, only: rub
   implicit none
   private

   public :: add_limits, damp_round_stops, limit_stiffness, stop_stiffness

   real(wp), parameter :: TINY_VALUE = 1.0e-20_wp         !! nothing is given
   real(wp), parameter :: TWO_PI = 6.28318530717958647692528676656_wp

contains

   !> Limits of joints from..from + n - 1: forces of stops and locks added to those of a block, and
   !> the friction.
   !>
   !> In `state` grip, c_limit, c_round, to_round, stored and flag are set anew; friction,
   !> slip_energy, locked, q_lock advance.
   pure subroutine add_limits(batch, curves, time, h, from, n, before, q, slid, state, f, lost)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      !> now, and the step that led here (0: none)
      real(wp), intent(in) :: time(BLOCK), h(BLOCK)
      integer, value :: from, n
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)   !! coordinates at time - h, time
      real(wp), intent(in) :: slid(BLOCK, NDOF)  !! way of the step that friction sees
      type(limit_block_t), intent(inout) :: state
      real(wp), intent(inout) :: f(BLOCK, NDOF)
      real(wp), intent(out) :: lost(BLOCK)       !! energy that friction or a release took

      integer :: dof

      state%stored(:n) = 0.0_wp
      state%c_limit(:n, :) = 0.0_wp
      state%c_round(:n, :) = 0.0_wp
      do dof = 1, NDOF
         state%flag(:n, dof) = merge(DOF_FREE, DOF_BLOCKED, &
            joint_types(batch%row)%free(dof) == 1)
      end do
      lost = 0.0_wp
      call rub(batch, curves, h, from, n, q, slid, state, lost)
      state%slip_energy(:n) = state%slip_energy(:n) + lost(:n)
      call stop_plain(batch, h, from, n, before, q, state, f)
      call stop_combined(batch, h, from, n, 0, before, q, state, f)
      call stop_combined(batch, h, from, n, 3, before, q, state, f)
      call lock(batch, time, h, from, n, before, q, state, f, lost)
   end subroutine add_limits

   !> Stops of directions that are not combined
   pure subroutine stop_plain(batch, h, from, n, before, q, state, f)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: h(BLOCK)
      integer, value :: from, n
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)
      type(limit_block_t), intent(inout) :: state
      real(wp), intent(inout) :: f(BLOCK, NDOF)

      real(wp) :: over, k
      integer :: i, j, dof

      do dof = 1, NDOF
         if (joint_types(batch%row)%free(dof) == 0) cycle
         do i = 1, n
            j = from + i - 1
            if (batch%limit%combined(j, dof) > 0.0_wp) cycle
            over = 0.0_wp
            associate (lo => batch%limit%lo(j, dof), hi => batch%limit%hi(j, dof))
               if (hi > 0.0_wp) over = max(0.0_wp, q(i, dof) - hi)
               if (lo < 0.0_wp .and. q(i, dof) < lo) over = q(i, dof) - lo
            end associate
            if (.not. abs(over) > 0.0_wp) cycle
            k = stop_stiffness(batch, j, dof)
            f(i, dof) = f(i, dof) + k*over
            state%stored(i) = state%stored(i) + 0.5_wp*k*over**2
            state%flag(i, dof) = DOF_AT_STOP
            state%c_limit(i, dof) = state%c_limit(i, dof) + stop_damping(batch, h(i), j, dof, k, &
               abs(over), q(i, dof) - before(i, dof))
         end do
      end do
   end subroutine stop_plain

   !> Damping of a stop of stiffness k: as Cr has it, but no stronger than its force
   pure real(wp) function stop_damping(batch, h, j, dof, k, over, change) result(c)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: h, k, over
      integer, intent(in) :: j, dof
      real(wp), intent(in) :: change             !! of the coordinate in the step

      c = min(batch%limit%cr_stop(j)*sqrt(k*batch%geometry%inertia(j, dof)), &
         k*over*h/max(abs(change), TINY_VALUE))
   end function stop_damping

   !> Combined stops of directions first + 1..first + 3: a potential of the distance from the centre
   !> alone, with the least radius and the largest stiffness of them
   pure subroutine stop_combined(batch, h, from, n, first, before, q, state, f)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: h(BLOCK)
      integer, value :: from, n, first
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)
      type(limit_block_t), intent(inout) :: state
      real(wp), intent(inout) :: f(BLOCK, NDOF)

      real(wp) :: d(3), reach, radius, over, k, way
      logical :: in(3)
      integer :: i, j, dof, stiffest

      do i = 1, n
         j = from + i - 1
         do dof = 1, 3
            in(dof) = batch%limit%combined(j, first + dof) > 0.0_wp
         end do
         if (.not. any(in)) cycle
         d = 0.0_wp
         radius = huge(1.0_wp)
         k = -1.0_wp
         stiffest = first + 1
         do dof = 1, 3
            if (.not. in(dof)) cycle
            associate (lo => batch%limit%lo(j, first + dof), hi => batch%limit%hi(j, first + dof))
               d(dof) = q(i, first + dof) - 0.5_wp*(lo + hi)
               radius = min(radius, 0.5_wp*(hi - lo))
            end associate
            if (stop_stiffness(batch, j, first + dof) <= k) cycle
            k = stop_stiffness(batch, j, first + dof)
            stiffest = first + dof
         end do
         reach = norm2(d)
         over = reach - radius
         if (.not. over > 0.0_wp) cycle
         d = d/reach
         way = 0.0_wp
         do dof = 1, 3
            f(i, first + dof) = f(i, first + dof) + k*over*d(dof)
            if (in(dof)) state%flag(i, first + dof) = DOF_AT_STOP
            state%to_round(i, first + dof) = d(dof)
            way = way + d(dof)*(q(i, first + dof) - before(i, first + dof))
         end do
         state%stored(i) = state%stored(i) + 0.5_wp*k*over**2
         state%c_round(i, first/3 + 1) = stop_damping(batch, h(i), j, stiffest, k, over, way)
      end do
   end subroutine stop_combined

   !> Damping of combined stops along their direction d, after that of the single directions: the
   !> implicit f = c (d.rate - h/2 d.S change)/(1 + h/2 c d.S d), added along d to change, that of
   !> the damping forces of the block
   pure subroutine damp_round_stops(state, h, n, rate, s, change)
      type(limit_block_t), intent(in) :: state
      real(wp), intent(in) :: h(BLOCK)
      integer, value :: n
      real(wp), intent(in) :: rate(BLOCK, NDOF)  !! predicted
      real(wp), intent(in) :: s(BLOCK, 21)       !! B M^-1 B^T, lower triangle by rows
      real(wp), intent(inout) :: change(BLOCK, NDOF)

      real(wp) :: d(NDOF), sd(NDOF), c, f
      integer :: i, k, l, part

      do i = 1, n
         do part = 1, 2
            c = state%c_round(i, part)
            if (.not. c > 0.0_wp) cycle
            d = 0.0_wp
            d(3*part - 2:3*part) = state%to_round(i, 3*part - 2:3*part)
            do k = 1, NDOF
               sd(k) = 0.0_wp
               do l = 1, NDOF
                  sd(k) = sd(k) + s(i, max(k, l)*(max(k, l) - 1)/2 + min(k, l))*d(l)
               end do
            end do
            f = c*(dot_product(d, rate(i, :)) - 0.5_wp*h(i)*dot_product(sd, change(i, :)))/ &
               (1.0_wp + 0.5_wp*h(i)*c*dot_product(d, sd))
            change(i, :) = change(i, :) + f*d
         end do
      end do
   end subroutine damp_round_stops

   !> Lock of the free directions while the sensor acts. q0 is the coordinate at its very time, so
   !> the force starts from zero; the damping comes in over the first period of the lock. When the
   !> sensor lets go, what the lock holds is lost.
   pure subroutine lock(batch, time, h, from, n, before, q, state, f, lost)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: time(BLOCK), h(BLOCK)
      integer, value :: from, n
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)
      type(limit_block_t), intent(inout) :: state
      real(wp), intent(inout) :: f(BLOCK, NDOF), lost(BLOCK)

      real(wp) :: k, m, part, strain
      logical :: holds
      integer :: i, j, dof

      do i = 1, n
         j = from + i - 1
         associate (l => batch%limit)
            holds = time(i) > l%t_lock(j) .and. time(i) <= l%t_free(j)
            if (.not. (holds .or. state%locked(i) > 0.0_wp)) cycle
            if (.not. state%locked(i) > 0.0_wp) then
               part = 1.0_wp
               if (h(i) > 0.0_wp) part = max(0.0_wp, 1.0_wp - (time(i) - l%t_lock(j))/h(i))
               state%q_lock(i, :) = before(i, :) + part*(q(i, :) - before(i, :))
            end if
            state%locked(i) = merge(1.0_wp, 0.0_wp, holds)
            do dof = 1, NDOF
               if (joint_types(batch%row)%free(dof) == 0) cycle
               k = l%k_block(j, merge(1, 2, dof <= 3))
               m = batch%geometry%inertia(j, dof)
               strain = q(i, dof) - state%q_lock(i, dof)
               if (batch%geometry%implicit) then      ! a row of the integrator
                  if (holds) state%flag(i, dof) = DOF_LOCKED
                  cycle
               end if
               if (.not. holds) then
                  ! what is left of k strain^2/2 by the trapezoidal rule of the work
                  lost(i) = lost(i) + max(0.0_wp, 0.5_wp*k*strain*(before(i, dof) - &
                     state%q_lock(i, dof)))
                  cycle
               end if
               f(i, dof) = f(i, dof) + k*strain
               state%stored(i) = state%stored(i) + 0.5_wp*k*strain**2
               state%flag(i, dof) = DOF_LOCKED
               if (.not. m > 0.0_wp) cycle
               state%c_limit(i, dof) = state%c_limit(i, dof) + l%cr(j)*sqrt(k*m)* &
                  min(1.0_wp, (time(i) - l%t_lock(j))*sqrt(k/m)/TWO_PI)
            end do
         end associate
      end do
   end subroutine lock

   !> Stiffness of the stop of one direction: its own, else that of blocked directions
   pure real(wp) function stop_stiffness(batch, j, dof) result(k)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: j, dof

      k = batch%limit%k(j, dof)
      if (.not. k > TINY_VALUE) k = batch%limit%k_block(j, merge(1, 2, dof <= 3))
   end function stop_stiffness

   !> Largest stiffness that the limits of joint j can add to each direction, for the time step;
   !> friction alone where blocked directions are implicit: these see to stops and locks
   pure function limit_stiffness(batch, curves, j) result(k)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: j
      real(wp) :: k(NDOF)

      real(wp) :: steep, stop(NDOF)
      integer :: dof, p, s

      k = 0.0_wp
      stop = 0.0_wp
      associate (l => batch%limit)
         do dof = 1, NDOF
            if (joint_types(batch%row)%free(dof) == 0) cycle
            if ((l%lo(j, dof) < 0.0_wp .or. l%hi(j, dof) > 0.0_wp) .and. &
               .not. batch%geometry%implicit) stop(dof) = stop_stiffness(batch, j, dof)
            if (l%t_lock(j) < huge(1.0_wp) .and. .not. batch%geometry%implicit) &
               k(dof) = k(dof) + l%k_block(j, merge(1, 2, dof <= 3))
            if (.not. has_friction(l%k(j, dof), l%slip(j, dof), l%slip_curve(j, dof))) cycle
            steep = l%k(j, dof)
            if (l%slip_curve(j, dof) > 0) then
               do p = curves%first(l%slip_curve(j, dof)), &
                  curves%first(l%slip_curve(j, dof) + 1) - 2
                  steep = max(steep, abs(l%slip(j, dof)*(curves%y(p + 1) - curves%y(p))/ &
                     (curves%x(p + 1) - curves%x(p))))
               end do
            end if
            k(dof) = k(dof) + steep
         end do
         do s = 1, 4, 3
            where (l%combined(j, s:s + 2) > 0.0_wp) &
               stop(s:s + 2) = maxval(l%combined(j, s:s + 2)*stop(s:s + 2))
         end do
      end associate
      k = k + stop
   end function limit_stiffness

end module kj_consistent_stop
