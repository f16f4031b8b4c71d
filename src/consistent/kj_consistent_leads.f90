!> What a step does with its leads, block by block: between the forces of two poses a lead depends
!> on no other.
!> Source: docs/theory/consistent.md 2.
module kj_consistent_leads
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_lead_map, only: gather_wrenches
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: midpoint_drift, kick, drift, predict, spin_velocity, &
      inverse_inertias
   use kj_consistent_conditions, only: project, keep_rates, hold_rotations, project_rates, &
      FIRST_HALF, SECOND_HALF
   implicit none
   private

   public :: move_leads, open_leads, look_leads, kick_leads, gather

contains

   !> First half kick and drift of leads lo..hi, with their conditions, and what they need before
   !> the forces of the new pose. lo is the first lead of a block.
   subroutine move_leads(model, midpoint, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h(BLOCK)               !! of the leads of each block
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: from, to, first, last, i

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         first = model%hold_to((from - 1)/BLOCK) + 1
         last = model%hold_to((to + BLOCK - 1)/BLOCK)
         call keep_rates(model, first, last, state)
         call half_kick(model, h, from, to, state)
         call project(model, state%mean, state%active, FIRST_HALF, first, last, state)
         call half_turn(model, h, from, to, state)
         do i = first, last
            state%kept%quat(:, i) = state%poses%quat(model%hold(i)%lead, :)
            state%kept%w(:, i) = state%poses%w(model%hold(i)%lead, :)
         end do
         if (midpoint) then
            call midpoint_drift(model, state, h, from, to)
         else
            call drift(model, state, h, from, to)
         end if
         call hold_rotations(model, h, state%mean, state%active, first, last, state)
         call open_leads(model, h, from, to, state)
      end do
   end subroutine move_leads

   !> Half a kick, and half a step of the impulses of joints and of loads on secondary nodes
   pure subroutine half_kick(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h(lo:hi)
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      associate (p => state%impulse, l => state%angular_impulse, f => state%f, t => state%t, &
         own_f => state%own_f, own_t => state%own_t)
         !$omp simd
         do i = lo, min(hi, model%n_body)
            p(i, 1) = p(i, 1) + 0.5_wp*h(i)*(f(i, 1) - own_f(i, 1))
            p(i, 2) = p(i, 2) + 0.5_wp*h(i)*(f(i, 2) - own_f(i, 2))
            p(i, 3) = p(i, 3) + 0.5_wp*h(i)*(f(i, 3) - own_f(i, 3))
            l(i, 1) = l(i, 1) + 0.5_wp*h(i)*(t(i, 1) - own_t(i, 1))
            l(i, 2) = l(i, 2) + 0.5_wp*h(i)*(t(i, 2) - own_t(i, 2))
            l(i, 3) = l(i, 3) + 0.5_wp*h(i)*(t(i, 3) - own_t(i, 3))
         end do
      end associate
      call kick(model, state, h, lo, hi)
   end subroutine half_kick

   !> Angular velocities after the first half kick, and half of the turn that goes with them
   pure subroutine half_turn(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h(lo:hi)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k

      call spin_velocity(model, state%poses%quat, state%l, lo, hi, state%poses%w)
      do k = 1, 3
         !$omp simd
         do i = lo, hi
            state%poses%psi(i, k) = 0.5_wp*h(i)*state%poses%w(i, k)
            state%poses%w_left(i, k) = state%poses%w(i, k)
            state%poses%v(i, k) = state%v(i, k)
         end do
      end do
   end subroutine half_turn

   !> Angular velocities in the pose reached, the other half of the turn, and no forces yet
   pure subroutine open_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h(lo:hi)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k

      call spin_velocity(model, state%poses%quat, state%l, lo, hi, state%poses%w)
      do k = 1, 3
         !$omp simd
         do i = lo, hi
            state%poses%psi(i, k) = state%poses%psi(i, k) + 0.5_wp*h(i)*state%poses%w(i, k)
            state%f(i, k) = 0.0_wp
            state%t(i, k) = 0.0_wp
         end do
         if (size(state%own_f, 1) == 0) cycle
         state%own_f(lo:hi, k) = 0.0_wp
         state%own_t(lo:hi, k) = 0.0_wp
      end do
   end subroutine open_leads

   !> What the dampers look at: predicted velocities, brought onto the conditions, and inverse
   !> inertias
   subroutine look_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi                  !! lo is the first lead of a block
      type(consistent_state_t), intent(inout) :: state

      integer :: from, to, first, last

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         first = model%hold_to((from - 1)/BLOCK) + 1
         last = model%hold_to((to + BLOCK - 1)/BLOCK)
         call predict(model, h, from, to, state)
         call project_rates(model, state%final, state%active, first, last, state)
         call inverse_inertias(model, state%poses%quat, from, to, state%poses%ij)
      end do
   end subroutine look_leads

   !> Second half kick of leads lo..hi and the sum of turns
   subroutine kick_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi                  !! lo is the first lead of a block
      type(consistent_state_t), intent(inout) :: state

      integer :: from, to, first, last, k

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         first = model%hold_to((from - 1)/BLOCK) + 1
         last = model%hold_to((to + BLOCK - 1)/BLOCK)
         call keep_rates(model, first, last, state)
         call half_kick(model, h, from, to, state)
         call project(model, state%final, state%active, SECOND_HALF, first, last, state)
         to = min(to, model%n_body)
         do k = 1, 3
            state%turn(from:to, k) = state%turn(from:to, k) + state%poses%psi(from:to, k)
         end do
      end do
   end subroutine kick_leads

   !> Add the wrenches of the joints to the leads lo..hi, at most BLOCK
   pure subroutine gather(model, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      real(wp), dimension(BLOCK, 3) :: f, t
      real(wp), dimension(BLOCK) :: kn, kr            ! these wrenches have none
      integer :: n

      call gather_wrenches(model%map, state%wrench, state%part, lo, hi, f, t, kn, kr)
      n = hi - lo + 1
      state%f(lo:hi, :) = state%f(lo:hi, :) + f(:n, :)
      state%t(lo:hi, :) = state%t(lo:hi, :) + t(:n, :)
   end subroutine gather

end module kj_consistent_leads
