!> Stops, friction and lock of a block of joints under the consistent formulation.
!>
!>   stop      f = k over along its direction, on both sides: a potential, nothing is lost
!>   combined  one circle or sphere: over = |q - c| - rho along (q - c)/|q - c|
!>   friction  elastic-plastic: r := r + k dq, brought back to |r| <= limit. What slides, p, is the
!>             part of dq that does not strain the spring; r p >= 0 is lost. Combined directions
!>             share the ellipse sum (r/limit)^2 <= 1
!>   lock      f = k_block (q - q0), q0 the coordinate when the sensor acts
!>
!> Forces of one direction add up. A stuck spring and a lock are damped by Cr as blocked directions
!> are; that is left to the dampers (c_limit). Signs are those of q: f on node 1.
module kj_c_limit
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: DOF_FREE, DOF_SLIDING, DOF_STICKING, DOF_AT_STOP, DOF_LOCKED, &
      DOF_BLOCKED
   use kj_joint_frame, only: BLOCK
   use kj_joint_stop, only: plain_overlap, has_friction
   use kj_c_batch, only: c_batch_t, c_joint_t
   implicit none
   private

   public :: add_limits, limit_stiffness, stop_stiffness

   real(wp), parameter :: TINY_VALUE = 1.0e-20_wp         !! nothing is given
   real(wp), parameter :: TWO_PI = 6.28318530717958647692528676656_wp

contains

   !> Add the limits of joints from..from + n - 1 to the forces of a block.
   !>
   !> joint%grip, c_limit, stored and flag are set anew; friction, slip_energy, locked, q_lock
   !> advance.
   pure subroutine add_limits(batch, curves, time, h, from, n, before, q, joint, f, lost)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: time, h            !! now, and the step that led here (0: none)
      integer, intent(in) :: from, n
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)   !! coordinates at time - h, time
      type(c_joint_t), intent(inout) :: joint
      real(wp), intent(inout) :: f(BLOCK, NDOF)
      real(wp), intent(out) :: lost(BLOCK)       !! energy that friction took in this step

      integer :: to, dof

      to = from + n - 1
      joint%stored(from:to) = 0.0_wp
      joint%c_limit(from:to, :) = 0.0_wp
      do dof = 1, NDOF
         joint%flag(from:to, dof) = merge(DOF_FREE, DOF_BLOCKED, &
            joint_types(batch%row)%free(dof) == 1)
      end do
      lost = 0.0_wp
      call rub(batch, curves, h, from, n, before, q, joint, f, lost)
      call stop_plain(batch, from, n, q, joint, f)
      call stop_combined(batch, from, n, 1, 3, q, joint, f)
      call stop_combined(batch, from, n, 4, 6, q, joint, f)
      call lock(batch, time, h, from, n, before, q, joint, f)
      joint%slip_energy(from:to) = joint%slip_energy(from:to) + lost(:n)
   end subroutine add_limits

   !> Friction of all directions
   pure subroutine rub(batch, curves, h, from, n, before, q, joint, f, lost)
      type(c_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: h
      integer, intent(in) :: from, n
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)
      type(c_joint_t), intent(inout) :: joint
      real(wp), intent(inout) :: f(BLOCK, NDOF), lost(BLOCK)

      real(wp) :: trial(NDOF), most(NDOF), ratio(NDOF), y, slope
      logical :: has(NDOF)
      integer :: i, j, dof

      associate (l => batch%limit)
         do i = 1, n
            j = from + i - 1
            has = has_friction(l%k(j, :), l%slip(j, :), l%slip_curve(j, :))
            if (.not. any(has)) cycle
            ratio = 0.0_wp
            most = 0.0_wp
            do dof = 1, NDOF
               if (.not. has(dof)) cycle
               most(dof) = l%slip(j, dof)
               if (l%slip_curve(j, dof) > 0) then
                  call law_value(curves, l%slip_curve(j, dof), q(i, dof), y, slope)
                  most(dof) = abs(most(dof)*y)
               end if
               trial(dof) = joint%friction(j, dof) + l%k(j, dof)*(q(i, dof) - before(i, dof))
               ratio(dof) = abs(trial(dof))/max(most(dof), TINY_VALUE)
            end do
            call share(l%combined(j, :) > 0.0_wp .and. most > TINY_VALUE, ratio)
            do dof = 1, NDOF
               if (.not. has(dof)) cycle
               call bring_back(h, l%k(j, dof), l%cr(j)*sqrt(l%k(j, dof)*batch%inertia(j, dof)), &
                  most(dof), trial(dof), ratio(dof), q(i, dof) - before(i, dof), &
                  joint%friction(j, dof), joint%c_limit(j, dof), lost(i))
               f(i, dof) = f(i, dof) + joint%friction(j, dof)
               joint%grip(j, dof) = most(dof)
               joint%stored(j) = joint%stored(j) + 0.5_wp*joint%friction(j, dof)**2/l%k(j, dof)
               joint%flag(j, dof) = merge(DOF_SLIDING, DOF_STICKING, ratio(dof) > 1.0_wp)
            end do
         end do
      end associate
   end subroutine rub

   !> Combined directions, translations and rotations for themselves, have one ratio of trial to
   !> limit
   pure subroutine share(combined, ratio)
      logical, intent(in) :: combined(NDOF)      !! and not without any friction now
      real(wp), intent(inout) :: ratio(NDOF)

      integer :: s

      do s = 1, 4, 3
         if (count(combined(s:s + 2)) < 2) cycle
         where (combined(s:s + 2)) &
            ratio(s:s + 2) = norm2(pack(ratio(s:s + 2), combined(s:s + 2)))
      end do
   end subroutine share

   !> Return of one direction to its limit, and the damping of its spring while it sticks: so much
   !> that spring and damper together stay within the limit
   pure subroutine bring_back(h, k, c, most, trial, ratio, change, r, c_limit, lost)
      real(wp), intent(in) :: h, k, c            !! step, stiffness, damping of the stuck spring
      real(wp), intent(in) :: most, trial, ratio !! limit, elastic force, force over limit
      real(wp), intent(in) :: change             !! of the coordinate
      real(wp), intent(inout) :: r               !! friction force
      real(wp), intent(inout) :: c_limit, lost

      real(wp) :: room

      r = trial
      if (ratio > 1.0_wp) then
         r = trial/ratio
         lost = lost + r*(trial - r)/k
      else if (h > 0.0_wp) then
         room = most
         if (r*change > 0.0_wp) room = (1.0_wp - ratio)*most
         c_limit = c_limit + min(c, room*h/max(abs(change), TINY_VALUE))
      end if
   end subroutine bring_back

   !> Stops of directions that are not combined
   pure subroutine stop_plain(batch, from, n, q, joint, f)
      type(c_batch_t), intent(in) :: batch
      integer, intent(in) :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF)
      type(c_joint_t), intent(inout) :: joint
      real(wp), intent(inout) :: f(BLOCK, NDOF)

      real(wp) :: over(BLOCK), direction(BLOCK), k
      logical :: close(BLOCK)
      integer :: i, j, dof, to

      to = from + n - 1
      do dof = 1, NDOF
         if (joint_types(batch%row)%free(dof) == 0) cycle
         call plain_overlap(n, q(:, dof), batch%limit%lo(from:to, dof), &
            batch%limit%hi(from:to, dof), over, direction, close)
         do i = 1, n
            j = from + i - 1
            if (batch%limit%combined(j, dof) > 0.0_wp .or. .not. abs(over(i)) > 0.0_wp) cycle
            k = stop_stiffness(batch, j, dof)
            f(i, dof) = f(i, dof) + k*over(i)
            joint%stored(j) = joint%stored(j) + 0.5_wp*k*over(i)**2
            joint%flag(j, dof) = DOF_AT_STOP
         end do
      end do
   end subroutine stop_plain

   !> Combined stops of directions first..last: a potential of the distance from the centre alone,
   !> with the least radius and the largest stiffness of them
   pure subroutine stop_combined(batch, from, n, first, last, q, joint, f)
      type(c_batch_t), intent(in) :: batch
      integer, intent(in) :: from, n, first, last
      real(wp), intent(in) :: q(BLOCK, NDOF)
      type(c_joint_t), intent(inout) :: joint
      real(wp), intent(inout) :: f(BLOCK, NDOF)

      real(wp) :: d(first:last), reach, over, k
      logical :: in(first:last)
      integer :: i, j, dof

      do i = 1, n
         j = from + i - 1
         associate (lo => batch%limit%lo(j, first:last), hi => batch%limit%hi(j, first:last))
            in = batch%limit%combined(j, first:last) > 0.0_wp
            if (.not. any(in)) cycle
            d = merge(q(i, first:last) - 0.5_wp*(lo + hi), 0.0_wp, in)
            reach = norm2(d)
            over = reach - minval(0.5_wp*(hi - lo), mask=in)
            if (.not. over > 0.0_wp) cycle
         end associate
         k = 0.0_wp
         do dof = first, last
            if (in(dof)) k = max(k, stop_stiffness(batch, j, dof))
         end do
         f(i, first:last) = f(i, first:last) + k*over*d/reach
         joint%stored(j) = joint%stored(j) + 0.5_wp*k*over**2
         where (in) joint%flag(j, first:last) = DOF_AT_STOP
      end do
   end subroutine stop_combined

   !> Lock of the free directions while the sensor acts. q0 is the coordinate at its very time, so
   !> the force starts from zero; the damping comes in over the first period of the lock.
   pure subroutine lock(batch, time, h, from, n, before, q, joint, f)
      type(c_batch_t), intent(in) :: batch
      real(wp), intent(in) :: time, h
      integer, intent(in) :: from, n
      real(wp), intent(in) :: before(BLOCK, NDOF), q(BLOCK, NDOF)
      type(c_joint_t), intent(inout) :: joint
      real(wp), intent(inout) :: f(BLOCK, NDOF)

      real(wp) :: k, m, part
      integer :: i, j, dof

      do i = 1, n
         j = from + i - 1
         associate (l => batch%limit)
            if (.not. time > l%t_lock(j)) cycle
            if (.not. joint%locked(j)) then
               part = 1.0_wp
               if (h > 0.0_wp) part = max(0.0_wp, 1.0_wp - (time - l%t_lock(j))/h)
               joint%q_lock(j, :) = before(i, :) + part*(q(i, :) - before(i, :))
               joint%locked(j) = .true.
            end if
            if (time > l%t_free(j)) cycle
            do dof = 1, NDOF
               if (joint_types(batch%row)%free(dof) == 0) cycle
               k = l%k_block(j, merge(1, 2, dof <= 3))
               m = batch%inertia(j, dof)
               f(i, dof) = f(i, dof) + k*(q(i, dof) - joint%q_lock(j, dof))
               joint%stored(j) = joint%stored(j) + 0.5_wp*k*(q(i, dof) - joint%q_lock(j, dof))**2
               joint%flag(j, dof) = DOF_LOCKED
               if (.not. m > 0.0_wp) cycle
               joint%c_limit(j, dof) = joint%c_limit(j, dof) + l%cr(j)*sqrt(k*m)* &
                  min(1.0_wp, (time - l%t_lock(j))*sqrt(k/m)/TWO_PI)
            end do
         end associate
      end do
   end subroutine lock

   !> Stiffness of the stop of one direction: its own, else that of blocked directions
   pure real(wp) function stop_stiffness(batch, j, dof) result(k)
      type(c_batch_t), intent(in) :: batch
      integer, intent(in) :: j, dof

      k = batch%limit%k(j, dof)
      if (.not. k > TINY_VALUE) k = batch%limit%k_block(j, merge(1, 2, dof <= 3))
   end function stop_stiffness

   !> Largest stiffness that the limits of joint j can add to each direction, for the time step
   pure function limit_stiffness(batch, curves, j) result(k)
      type(c_batch_t), intent(in) :: batch
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
            if (l%lo(j, dof) < 0.0_wp .or. l%hi(j, dof) > 0.0_wp) &
               stop(dof) = stop_stiffness(batch, j, dof)
            if (l%t_lock(j) < huge(1.0_wp)) &
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

end module kj_c_limit
