!> The nodal rule of the time step under the consistent formulation.
!> Source: legacy_scheme.md 2 and 4.6.
module kj_c_nodal
   use kj_kinds, only: wp
   use kj_joint_batch, only: joint_state_t, new_joint_state, LAW_SPRING_CURVE
   use kj_joint_force, only: start_stiffness
   use kj_joint_law, only: step_stiffness
   use kj_model, only: model_t
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_bound, only: largest_stiffness
   implicit none
   private

   public :: nodal_stiffness, nodal_bound

contains

   !> Stiffness that the joints show to the nodal rule at each lead
   subroutine nodal_stiffness(model, c, state, kn, kr)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      real(wp), intent(out) :: kn(:), kr(:)      !! (n_lead)

      type(joint_state_t) :: legacy
      real(wp) :: k(6), st, sr
      integer :: b, i, e, lead

      kn = 0.0_wp
      kr = 0.0_wp
      do b = 1, size(model%batch)
         call new_joint_state(model%batch(b), legacy)
         call start_stiffness(model%batch(b), legacy)
         do i = 1, model%batch(b)%n
            if (c%batch(b)%limited .or. any(c%batch(b)%law >= LAW_SPRING_CURVE)) then
               k = largest_stiffness(model%curves, c%batch(b), i)
               call step_stiffness(2, [maxval(k(1:3)), maxval(k(4:6))], &
                  model%batch(b)%c_top(i, :), [model%batch(b)%cr(i), model%batch(b)%cr(i)], &
                  model%batch(b)%reduced(i, :), legacy%stiff(i, :))
            end if
            st = legacy%stiff(i, 1)
            sr = legacy%stiff(i, 2) + st*sum((c%batch(b)%xl0(i, :) + state%joint(b)%q(i, 1:3))**2)
            do e = 1, 2
               lead = c%batch(b)%lead(i, e)
               kn(lead) = kn(lead) + 2.0_wp*st
               kr(lead) = kr(lead) + sr + 2.0_wp*st*sum(c%batch(b)%arm(i, 3*e - 2:3*e)**2)
            end do
         end do
      end do
   end subroutine nodal_stiffness

   !> The nodal rule: min over leads of sqrt(2 m/k_n), sqrt(2 I/k_r)
   subroutine nodal_bound(model, c, state, h)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      real(wp), intent(out) :: h

      real(wp) :: kn(model%n_lead), kr(model%n_lead)
      integer :: i

      call nodal_stiffness(model, c, state, kn, kr)
      h = huge(1.0_wp)
      do i = 1, model%n_lead
         if (model%mass(i) > 0.0_wp .and. kn(i) > 0.0_wp) h = min(h, &
            sqrt(2.0_wp*model%mass(i)/kn(i)))
         if (model%inertia(i) > 0.0_wp .and. kr(i) > 0.0_wp) h = min(h, &
            sqrt(2.0_wp*model%inertia(i)/kr(i)))
      end do
   end subroutine nodal_bound

end module kj_c_nodal
