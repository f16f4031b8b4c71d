!> Time-step limits of a scene beside the safe bound: the nodal rule, and the exact limit of the
!> assembled scene.
module kj_consistent_nodal_step
   use kj_kinds, only: wp
   use kj_lapack, only: largest_eigenvalue
   use kj_block, only: block_of, lane_of
   use kj_joint_batch, only: is_spring, LAW_SPRING_CURVE
   use kj_nodal_stiffness, only: start_stiffness, step_stiffness
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_conditions, only: body_matrix
   use kj_consistent_safe_step, only: bound_t, largest_stiffness, rows_of_end
   implicit none
   private

   public :: nodal_stiffness, nodal_bound, exact_bound

contains

   !> Stiffness that the joints show to the nodal rule at each lead.
   !> Source: docs/theory/time_step.md 6.
   subroutine nodal_stiffness(model, state, kn, kr)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(out) :: kn(:), kr(:)      !! (n_lead)

      real(wp), allocatable :: stiff(:, :)
      real(wp) :: k(6), st, sr, times
      integer :: b, i, e, lead

      kn = 0.0_wp
      kr = 0.0_wp
      do b = 1, size(model%batch)
         times = merge(1.0_wp, 2.0_wp, is_spring(model%batch(b)))
         if (allocated(stiff)) deallocate (stiff)
         allocate (stiff(model%batch(b)%n, 2))
         call start_stiffness(model%batch(b), stiff)
         do i = 1, model%batch(b)%n
            if (model%batch(b)%limited .or. any(model%batch(b)%law >= LAW_SPRING_CURVE)) then
               k = largest_stiffness(model%curves, model%batch(b), i)
               call step_stiffness(2, [maxval(k(1:3)), maxval(k(4:6))], &
                  model%batch(b)%c_top(i, :), [model%batch(b)%cr(i), model%batch(b)%cr(i)], &
                  model%batch(b)%reduced(i, :), stiff(i, :))
            end if
            st = stiff(i, 1)
            sr = stiff(i, 2) + st*sum((model%batch(b)%xl0(i, :) + &
               state%joint(b)%block(block_of(i))%q(lane_of(i), 1:3))**2)
            do e = 1, 2
               lead = model%batch(b)%lead(i, e)
               kn(lead) = kn(lead) + times*st
               kr(lead) = kr(lead) + sr + times*st* &
                  sum(model%batch(b)%geometry%arm(i, 3*e - 2:3*e)**2)
            end do
         end do
      end do
   end subroutine nodal_stiffness

   !> The nodal rule: min over leads of sqrt(2 m/k_n), sqrt(2 I/k_r)
   subroutine nodal_bound(model, state, h)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(out) :: h

      real(wp) :: kn(model%n_lead), kr(model%n_lead)
      integer :: i

      call nodal_stiffness(model, state, kn, kr)
      h = huge(1.0_wp)
      do i = 1, model%n_lead
         if (model%mass(i) > 0.0_wp .and. kn(i) > 0.0_wp) h = &
            min(h, sqrt(2.0_wp*model%mass(i)/kn(i)))
         if (model%inertia(i) > 0.0_wp .and. kr(i) > 0.0_wp) h = &
            min(h, sqrt(2.0_wp*model%inertia(i)/kr(i)))
      end do
   end subroutine nodal_bound

   !> The exact limit 2/omega of the assembled scene; 0 when it has more than `most` dofs
   subroutine exact_bound(model, state, bound, most, h)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound
      integer, intent(in) :: most
      real(wp), intent(out) :: h

      real(wp), allocatable :: a(:, :)
      real(wp) :: rows(6, 12), p(3, 3), lambda
      integer :: b, i, j, e, k, at(2)

      h = 0.0_wp
      if (6*model%n_lead > most) return
      allocate (a(6*model%n_lead, 6*model%n_lead), source=0.0_wp)
      do b = 1, size(model%batch)
         do i = 1, model%batch(b)%n
            j = model%batch(b)%first + i
            do e = 1, 2
               at(e) = model%batch(b)%lead(i, e)
               rows(:, 6*e - 5:6*e) = rows_of_end(model%batch(b), state, b, i, e)
               p = body_matrix(state, at(e))
               rows(:, 6*e - 5:6*e - 3) = rows(:, 6*e - 5:6*e - 3)*sqrt(model%inverse_mass(at(e)))
               rows(:, 6*e - 2:6*e) = matmul(rows(:, 6*e - 2:6*e), p)* &
                  spread(sqrt(model%inverse_inertia(at(e), :)), 1, 6)
            end do
            do k = 1, 6
               rows(k, :) = rows(k, :)*sqrt(bound%k(k, j))
            end do
            do e = 1, 2
               do k = 1, 2
                  associate (block => a(6*at(e) - 5:6*at(e), 6*at(k) - 5:6*at(k)))
                     block = block + matmul(transpose(rows(:, 6*e - 5:6*e)), rows(:, 6*k - 5:6*k))
                  end associate
               end do
            end do
         end do
      end do
      call largest_eigenvalue(size(a, 1), a, lambda)
      h = huge(1.0_wp)
      if (lambda > 0.0_wp) h = 2.0_wp/sqrt(lambda)
   end subroutine exact_bound

end module kj_consistent_nodal_step
