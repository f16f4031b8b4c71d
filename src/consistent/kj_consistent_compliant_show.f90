!> Forces at t of the integrator `compliant`: the mean of the multipliers of the steps before and
!> after. That of the step after needs its position stage, which is undone. At a start or jump no
!> step lies before: half of the one after tells the force at t + h/6, the whole that at t + h/3.
!> Source: docs/theory/compliant.md 7.
module kj_consistent_compliant_show
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_types, only: NDOF
   use kj_consistent_matrix, only: N_CONSISTENT_WRENCH
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_matrix, only: wrench_of_rows, add_wrenches
   use kj_consistent_compliant_march, only: pace_t, next_solve
   use kj_consistent_compliant_step, only: look_ahead
   implicit none
   private

   public :: begin_show, end_show

contains

   !> Put the forces at t into the joints (fd of implicit rows) and the leads, for whoever reads
   !> them
   subroutine begin_show(model, pace, state)
      type(consistent_model_t), intent(in) :: model
      type(pace_t), intent(in) :: pace           !! of the next steps
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: h, before, after, w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: b, at, from, n, k

      if (.not. allocated(state%compliant)) return
      h = next_solve(pace)
      associate (self => state%compliant)
         before = 2.0_wp
         if (self%jump > 0) then
            before = h/(h + self%h_last)
         else if (self%known /= state%cycle) then
            call look_ahead(model, 0.5_wp*h, state)
            self%known = -1
            do b = 1, size(model%batch)
               do at = 1, size(self%joint(b)%block)
                  self%joint(b)%block(at)%g = self%joint(b)%block(at)%f
               end do
            end do
         end if
         call look_ahead(model, h, state)
         after = 1.0_wp - before
         self%start%f(:, :) = state%f
         self%start%t(:, :) = state%t
         do b = 1, size(model%batch)
            if (.not. self%rowed(b)) cycle
            do at = 1, size(self%joint(b)%block)
               from = BLOCK*(at - 1) + 1
               n = min(BLOCK, model%batch(b)%n - from + 1)
               associate (rows => self%joint(b)%block(at), lanes => state%joint(b)%block(at))
                  do k = 1, NDOF
                     where (rows%weight(:n, k) > 0.0_wp) lanes%fd(:n, k) = before*rows%g(:n, k) + &
                        after*rows%f(:n, k)
                  end do
                  rows%force(:n, :) = merge(lanes%fd(:n, :), 0.0_wp, rows%weight(:n, :) > 0.0_wp)
                  call wrench_of_rows(n, NDOF, lanes%fd, lanes%b, w)
               end associate
               call add_wrenches(model%batch(b), from, n, w, state%f, state%t)
            end do
         end do
      end associate
   end subroutine begin_show

   !> As before
   subroutine end_show(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: b, at, n

      if (.not. allocated(state%compliant)) return
      associate (self => state%compliant)
         state%f = self%start%f
         state%t = self%start%t
         do b = 1, size(self%rowed)
            if (.not. self%rowed(b)) cycle
            do at = 1, size(self%joint(b)%block)
               n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
               where (self%joint(b)%block(at)%weight(:n, :) > 0.0_wp) &
                  state%joint(b)%block(at)%fd(:n, :) = 0.0_wp
            end do
         end do
      end associate
   end subroutine end_show

end module kj_consistent_compliant_show
