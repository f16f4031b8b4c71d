!> Springs of /PROP/TYPE4 (along the line of their nodes) and /PROP/TYPE8 (six laws in axes that
!> are fixed or ride on an end): what they have of their own. All else they share with joints: they
!> are batches of another kind, with a frame rule and no blocked direction.
!>
!> Force and couples are those of virtual work: where the axes ride on an end, the couple r x F goes
!> to that end; axes fixed in space take it themselves. Source: docs/theory/legacy.md 5.
module kj_legacy_spring
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   use kj_joint_types, only: NDOF, FRAME_FIRST, FRAME_SECOND, FRAME_FIXED, FRAME_LINE, FRAME_APART
   use kj_joint_batch, only: joint_batch_t, is_spring, LAW_SPRING_CURVE, LAW_DAMPER_CURVE
   use kj_block, only: BLOCK
   implicit none
   private

   public :: spring_laws, couple_shares

contains

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

end module kj_legacy_spring
