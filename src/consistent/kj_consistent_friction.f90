!> Friction of a block of joints under the consistent formulation: elastic-plastic.
!>
!>   r := r + k dq, and from beyond its limit back to the point of the limit that is nearest in
!>   energy. So what slides, p, the part of dq that does not strain the spring, is along the normal
!>   of the limit, and r.p >= 0 is lost.
!>
!> Combined directions share the ellipse sum (r/limit)^2 <= 1.
!> Source: docs/theory/consistent.md 10.
module kj_consistent_friction
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: DOF_SLIDING, DOF_STICKING, has_friction, joint_batch_t
   use kj_block, only: BLOCK
   use kj_consistent_batch, only: limit_block_t
   implicit none
   private

   public :: rub, turn_in_frame

   real(wp), parameter :: TINY_VALUE = 1.0e-20_wp         !! nothing is given
   integer, parameter :: ITERATIONS = 50
   integer, parameter :: ALL_DOFS(NDOF) = [1, 2, 3, 4, 5, 6]
   integer, parameter :: FIRST(NDOF) = [1, 1, 1, 4, 4, 4]   !! translations, rotations

contains

   !> Friction of all directions of joints from..from + n - 1: state%friction
   pure subroutine rub(batch, curves, h, from, n, q, slid, state, lost)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: h(BLOCK)           !! step, 0: none
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF)     !! coordinates now, for functions
      real(wp), intent(in) :: slid(BLOCK, NDOF)  !! dq
      type(limit_block_t), intent(inout) :: state
      real(wp), intent(inout) :: lost(BLOCK)     !! energy

      logical :: has(NDOF), together(NDOF)
      integer :: i, j, dof, s

      do i = 1, n
         j = from + i - 1
         has = has_friction(batch%limit%k(j, :), batch%limit%slip(j, :), &
            batch%limit%slip_curve(j, :))
         if (.not. any(has)) cycle
         do dof = 1, NDOF
            if (has(dof)) state%grip(i, dof) = friction_limit(batch, curves, j, dof, q(i, dof))
         end do
         together = has .and. batch%limit%combined(j, :) > 0.0_wp
         do s = 1, 4, 3
            if (any(together(s:s + 2))) call rub_together(batch, h(i), j, i, &
               together .and. spread(s, 1, NDOF) == FIRST, slid(i, :), state, lost(i))
         end do
         do dof = 1, NDOF
            if (has(dof) .and. .not. together(dof)) call rub_together(batch, h(i), j, i, &
               ALL_DOFS == dof, slid(i, :), state, lost(i))
         end do
      end do
   end subroutine rub

   !> Limit of friction at q
   pure real(wp) function friction_limit(batch, curves, j, dof, q) result(most)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: j, dof
      real(wp), intent(in) :: q

      real(wp) :: y, slope

      most = batch%limit%slip(j, dof)
      if (batch%limit%slip_curve(j, dof) == 0) return
      call law_value(curves, batch%limit%slip_curve(j, dof), q, y, slope)
      most = abs(most*y)
   end function friction_limit

   !> Friction of the directions of joint j that share a limit (or of one), and the damping of their
   !> springs while they stick: so much that spring and damper together stay within the limit.
   !>
   !> What is lost is the work on the friction, by the trapezoidal rule as all work on joints, less
   !> what its spring takes: 1/2 (r_old + r).p, p the way that slides. As p is along the normal of
   !> the limit in r, and r_old is inside, that is never negative while the limit stays; where it
   !> shrinks as the motion turns round, nothing is counted.
   pure subroutine rub_together(batch, h, j, i, in, slid, state, lost)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: h
      integer, intent(in) :: j, i                !! in the batch, in the block
      logical, intent(in) :: in(NDOF)
      real(wp), intent(in) :: slid(NDOF)
      type(limit_block_t), intent(inout) :: state
      real(wp), intent(inout) :: lost

      real(wp) :: k(NDOF), most(NDOF), trial(NDOF), r(NDOF), load, room, work
      logical :: slides
      integer :: dof

      k = batch%limit%k(j, :)
      most = state%grip(i, :)
      trial = state%friction(i, :) + k*slid
      r = merge(trial, 0.0_wp, in .and. most > TINY_VALUE)
      call bring_back(k, most, r, load)
      slides = load > 1.0_wp .or. any(in .and. .not. most > TINY_VALUE)
      work = 0.0_wp
      do dof = 1, NDOF
         if (.not. in(dof)) cycle
         work = work + 0.5_wp*(state%friction(i, dof) + r(dof))*(trial(dof) - r(dof))/k(dof)
         state%friction(i, dof) = r(dof)
         state%stored(i) = state%stored(i) + 0.5_wp*r(dof)**2/k(dof)
         state%flag(i, dof) = merge(DOF_SLIDING, DOF_STICKING, slides)
         if (slides .or. .not. h > 0.0_wp) cycle
         room = most(dof)
         if (r(dof)*slid(dof) > 0.0_wp) room = (1.0_wp - load)*most(dof)
         state%c_limit(i, dof) = min(batch%limit%cr(j)* &
            sqrt(k(dof)*batch%geometry%inertia(j, dof)), &
            room*h/max(abs(slid(dof)), TINY_VALUE))
      end do
      if (slides) lost = lost + max(0.0_wp, work)
   end subroutine rub_together

   !> Return of the friction r to the ellipse load^2 = sum (r/most)^2 = 1, where it is outside: to
   !> r/(1 + g k/most^2), with the g that solves it. That is the nearest point with the energy
   !> r^2/(2 k) as measure.
   !>
   !> Newton's method on 1/load = 1: at once for one direction or equal ones, monotone for others.
   pure subroutine bring_back(k, most, r, load)
      real(wp), intent(in) :: k(NDOF), most(NDOF)
      real(wp), intent(inout) :: r(NDOF)         !! 0 where there is no friction
      real(wp), intent(out) :: load              !! before the return

      real(wp) :: b(NDOF), a(NDOF), now, g
      integer :: i

      b = 0.0_wp
      a = 0.0_wp
      where (abs(r) > 0.0_wp)
         b = r/most
         a = k/most**2
      end where
      load = norm2(b)
      if (.not. load > 1.0_wp) return
      g = 0.0_wp
      do i = 1, ITERATIONS
         now = norm2(b/(1.0_wp + g*a))
         if (now - 1.0_wp <= epsilon(now)) exit
         g = g + now**2*(now - 1.0_wp)/sum(b**2*a/(1.0_wp + g*a)**3)
      end do
      r = r/(1.0_wp + g*a)
   end subroutine bring_back

   !> Relative turn of the last step in the joint frame, rows of rot: a chart of three free
   !> rotations stretches turns the more the larger they are, friction knows nothing of that
   pure subroutine turn_in_frame(batch, psi, from, n, rot, turn)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: psi(:, :)          !! (n_lead, 3) rotation vectors of the step, W
      integer, value :: from, n
      real(wp), intent(in) :: rot(BLOCK, 9)
      real(wp), intent(inout) :: turn(BLOCK, NDOF)   !! its columns 4-6

      real(wp) :: d(3)
      integer :: i, k

      do i = 1, n
         d = psi(batch%lead(from + i - 1, 2), :) - psi(batch%lead(from + i - 1, 1), :)
         do k = 1, 3
            turn(i, k + 3) = dot_product(rot(i, 3*k - 2:3*k), d)
         end do
      end do
   end subroutine turn_in_frame

end module kj_consistent_friction
