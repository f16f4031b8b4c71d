!> Limits and first angles of KJOINT2 for the consistent formulation: constants and first energies.
module kj_consistent_build_stops
   use kj_kinds, only: wp
   use kj_curve, only: curve_integral
   use kj_joint_batch, only: joint_batch_t, LAW_SPRING_CURVE
   use kj_consistent_batch, only: consistent_batch_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   implicit none
   private

   public :: build_limits, direction_inertia, start_energies

contains

   !> Limits, and the effective mass and inertia of each direction
   subroutine build_limits(model, old, batch)
      type(consistent_model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: old
      type(consistent_batch_t), intent(inout) :: batch

      integer :: i, dof

      batch%limited = .true.
      batch%limit = old%limit
      batch%damped = .true.
      allocate (batch%inertia(old%n, 6))
      do i = 1, old%n
         batch%inertia(i, 1:3) = old%reduced(i, 1)
         do dof = 4, 6
            batch%inertia(i, dof) = direction_inertia(model, old%lead(i, :), &
               old%frame0(i, 3*dof - 11:3*dof - 9))
         end do
      end do
   end subroutine build_limits

   !> Effective inertia 1/(e.J1^-1 e + e.J2^-1 e) of a relative turn about e; 0 where nothing turns
   pure real(wp) function direction_inertia(model, lead, e) result(m)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lead(2)
      real(wp), intent(in) :: e(3)

      real(wp) :: sum_inverse
      integer :: s

      sum_inverse = 0.0_wp
      do s = 1, 2
         sum_inverse = sum_inverse + sum(model%inverse_inertia(lead(s), :)*matmul(e, &
            reshape(model%axes0(lead(s), :), [3, 3]))**2)
      end do
      m = 0.0_wp
      if (sum_inverse > 0.0_wp) m = 1.0_wp/sum_inverse
   end function direction_inertia

   !> Elastic energy at the start of joints whose angles do not start at 0 or that start beyond a
   !> stop
   subroutine start_energies(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i

      do b = 1, size(model%geometry)
         associate (batch => model%geometry(b), joint => state%joint(b))
            if (batch%limited) joint%elastic = joint%elastic + joint%stored
            if (.not. batch%shifted) cycle
            do i = 1, batch%n
               joint%elastic(i) = joint%elastic(i) + spring_energy(model, batch, i)
            end do
         end associate
      end do
   end subroutine start_energies

   !> Energy in the rotational springs of joint i at its first angles
   pure real(wp) function spring_energy(model, batch, i) result(u)
      type(consistent_model_t), intent(in) :: model
      type(consistent_batch_t), intent(in) :: batch
      integer, intent(in) :: i

      integer :: dof

      u = 0.0_wp
      do dof = 4, 6
         associate (angle => batch%shift(i, dof - 3), k => batch%k(i, dof))
            if (iand(batch%law(dof), LAW_SPRING_CURVE) /= 0) then
               u = u + k*curve_integral(model%curves, batch%k_curve(i, dof), 0.0_wp, angle)
            else
               u = u + 0.5_wp*k*angle**2
            end if
         end associate
      end do
   end function spring_energy

end module kj_consistent_build_stops
