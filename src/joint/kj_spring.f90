!> Springs of /PROP/TYPE4 (along the line of their nodes) and /PROP/TYPE8 (six laws in axes that are
!> fixed or ride on an end): what they have of their own. All else they share with joints: they are
!> batches of another kind, with a frame rule and no blocked direction.
!>
!> Force and couples are those of virtual work: where the axes ride on an end, the couple r x F goes
!> to that end; axes fixed in space take it themselves. Source: deck.md 5.3 and 5.4.
module kj_spring
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF, FRAME_FIRST, FRAME_SECOND, FRAME_FIXED, FRAME_LINE, FRAME_APART
   use kj_joint_batch, only: joint_batch_t, is_spring, LAW_SPRING_CURVE, LAW_DAMPER_CURVE
   use kj_joint_frame, only: BLOCK
   use kj_c_chart, only: first_skew, quaternion_frame
   implicit none
   private

   public :: line_axes, spring_laws, couple_shares, spring_axes, steepest_rise

contains

   !> Axes with e1 along r, all orthonormal; the global ones where r is zero
   pure subroutine line_axes(n, r, e)
      integer, intent(in) :: n
      real(wp), intent(in) :: r(BLOCK, 3)        !! from node 1 to node 2, W
      real(wp), intent(out) :: e(BLOCK, 9)

      real(wp) :: length, u(3), v(3)
      integer :: i

      do i = 1, n
         length = sqrt(r(i, 1)**2 + r(i, 2)**2 + r(i, 3)**2)
         u = [1.0_wp, 0.0_wp, 0.0_wp]
         if (length > 0.0_wp) u = r(i, :)/length
         v = 0.0_wp
         v(minloc(abs(u), dim=1)) = 1.0_wp
         v = v - dot_product(u, v)*u
         v = v/norm2(v)
         e(i, 1:3) = u
         e(i, 4:6) = v
         e(i, 7) = u(2)*v(3) - u(3)*v(2)
         e(i, 8) = u(3)*v(1) - u(1)*v(3)
         e(i, 9) = u(1)*v(2) - u(2)*v(1)
      end do
   end subroutine line_axes

   !> Axes of a block of springs and the couple on body 1 of a unit force along each, as the
   !> charts of joints have them (consistent formulation)
   pure subroutine spring_axes(n, frame, fixed, t1, t2, r, e, a1)
      integer, intent(in) :: n
      integer, intent(in) :: frame               !! FRAME_ constant of springs
      real(wp), intent(in) :: fixed(BLOCK, 9)    !! axes of FRAME_FIXED, W
      real(wp), intent(in) :: t1(BLOCK, 4), t2(BLOCK, 4)   !! triads that the ends carry, W
      real(wp), intent(in) :: r(BLOCK, 3)        !! from node 1 to node 2, W
      real(wp), intent(out) :: e(BLOCK, 9), a1(BLOCK, 9)

      if (frame == FRAME_FIRST) then
         call first_skew(n, t1, r, e, a1)
      else
         if (frame == FRAME_SECOND) call quaternion_frame(n, t2, e)
         if (frame == FRAME_LINE) call line_axes(n, r, e)
         if (frame == FRAME_FIXED) e(:n, :) = fixed(:n, :)
         a1(:n, :) = 0.0_wp
      end if
   end subroutine spring_axes

   !> Parts of the couple r x F that go to end 1 and end 2 under the legacy formulation.
   !>
   !> A joint gives half to each, and so does a skew that rides on neither end.
   pure function couple_shares(batch) result(part)
      type(joint_batch_t), intent(in) :: batch
      real(wp) :: part(2)

      part = 0.5_wp
      if (.not. is_spring(batch)) return
      part = 0.0_wp
      if (batch%frame == FRAME_FIRST) part(1) = 1.0_wp
      if (batch%frame == FRAME_SECOND) part(2) = 1.0_wp
      if (batch%frame == FRAME_APART) part = 0.5_wp
   end function couple_shares

   !> Force of each direction of springs from ..., linear or tabulated (legacy formulation)
   pure subroutine spring_laws(batch, curves, from, n, q, qdot, f)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF), qdot(BLOCK, NDOF)
      real(wp), intent(out) :: f(BLOCK, NDOF)    !! on node 1

      real(wp) :: y, slope
      integer :: i, j, dof

      do dof = 1, NDOF
         f(:n, dof) = 0.0_wp
         if (batch%law(dof) == 0) cycle
         do i = 1, n
            j = from + i - 1
            y = q(i, dof)
            if (iand(batch%law(dof), LAW_SPRING_CURVE) /= 0) &
               call law_value(curves, batch%k_curve(j, dof), q(i, dof), y, slope)
            f(i, dof) = batch%k(j, dof)*y
            y = qdot(i, dof)
            if (iand(batch%law(dof), LAW_DAMPER_CURVE) /= 0) &
               call law_value(curves, batch%c_curve(j, dof), qdot(i, dof), y, slope)
            f(i, dof) = f(i, dof) + batch%c(j, dof)*y
         end do
      end do
   end subroutine spring_laws

   !> Steepest rise of a curve anywhere, 0 where it only falls
   pure real(wp) function steepest_rise(curves, curve) result(slope)
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: curve               !! index

      integer :: p

      slope = 0.0_wp
      do p = curves%first(curve), curves%first(curve + 1) - 2
         slope = max(slope, (curves%y(p + 1) - curves%y(p))/(curves%x(p + 1) - curves%x(p)))
      end do
   end function steepest_rise

end module kj_spring
