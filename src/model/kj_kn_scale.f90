!> Softer or stiffer blocking of all joints, to see what it costs and what it spoils.
module kj_kn_scale
   use kj_kinds, only: wp
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: joint_batch_t, is_spring, LAW_SPRING
   use kj_model, only: model_t
   implicit none
   private

   public :: scale_blocking

contains

   !> Multiply the stiffness of blocked directions by a factor and their damping by its root, so
   !> that the damping ratio stays
   pure subroutine scale_blocking(model, factor)
      type(model_t), intent(inout) :: model
      real(wp), intent(in) :: factor             !! above 0

      integer :: b

      do b = 1, size(model%batch)
         if (.not. is_spring(model%batch(b))) call scale_batch(model%batch(b), factor)
      end do
   end subroutine scale_blocking

   pure subroutine scale_batch(batch, factor)
      type(joint_batch_t), intent(inout) :: batch
      real(wp), intent(in) :: factor

      integer :: dof, s

      batch%k_top = 0.0_wp
      do dof = 1, NDOF
         if (joint_types(batch%row)%free(dof) == 0) then
            batch%k(:, dof) = factor*batch%k(:, dof)
            batch%c(:, dof) = sqrt(factor)*batch%c(:, dof)
         end if
         s = merge(1, 2, dof <= 3)
         if (iand(batch%law(dof), LAW_SPRING) /= 0) &
            batch%k_top(:, s) = max(batch%k_top(:, s), batch%k(:, dof))
      end do
      if (batch%limited) batch%limit%k_block = factor*batch%limit%k_block
   end subroutine scale_batch

end module kj_kn_scale
