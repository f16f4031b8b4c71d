!> What a step does with its leads, block by block: between the forces of two poses a lead depends
!> on no other.
!> Source: docs/theory/consistent.md 2.
module kj_consistent_leads
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of
   use kj_lead_map, only: gather_wrench, gather_abreast, first_hub, N_SUM
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: midpoint_drift, kick, drift, predict, spin, inertias_of
   use kj_consistent_conditions, only: project, keep_rates, hold_rotations, project_rates, &
      FIRST_HALF, SECOND_HALF
   implicit none
   private

   public :: move_leads, open_leads, look_leads, kick_leads, gather

contains

   !> First half kick and drift of leads lo..hi, with their conditions, and what they need before
   !> the forces of the new pose. lo is the first lead of a block. Leads that rest have impulses
   !> alone: where they stand at either end of a block it does not see them.
   subroutine move_leads(model, midpoint, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h(BLOCK)               !! of the leads of each block
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: from, n, lane, many

      do from = lo, hi, BLOCK
         call add_impulses(model, h, from, min(from + BLOCK - 1, hi), state)
         call movers(model, from, lane, n)
         do while (n > 0)
            many = part_of(n, model, from)
            select case (many)
            case (1)
               call move_block(1, from + lane - 1, model, midpoint, h(lane:), state)
            case (2)
               call move_block(2, from + lane - 1, model, midpoint, h(lane:), state)
            case (3)
               call move_block(3, from + lane - 1, model, midpoint, h(lane:), state)
            case (4)
               call move_block(4, from + lane - 1, model, midpoint, h(lane:), state)
            case (8)
               call move_block(8, from + lane - 1, model, midpoint, h(lane:), state)
            case (BLOCK)
               call move_block(BLOCK, from + lane - 1, model, midpoint, h(lane:), state)
            case default
               call move_block(many, from + lane - 1, model, midpoint, h(lane:), state)
            end select
            lane = lane + many
            n = n - many
         end do
      end do
      call no_forces(lo, hi, state)
   end subroutine move_leads

   !> The leads that move of the block that begins with lead lo: place of the first, and how many up
   !> to the last
   pure subroutine movers(model, lo, lane, n)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo
      integer, intent(out) :: lane, n

      associate (m => model%mover(:, block_of(lo)))
         lane = m(1) - lo + 1
         n = merge(m(2) - m(1) + 1, 0, m(1) > 0)
      end associate
   end subroutine movers

   !> How many of n leads of the block that begins with lead lo go through a kernel at once: few in
   !> numbers that have kernels of their own, unless some have conditions
   pure integer function part_of(n, model, lo) result(many)
      integer, intent(in) :: n, lo
      type(consistent_model_t), intent(in) :: model

      many = n
      if (n > 4 .and. n < 8) many = 4
      if (model%hold_to(block_of(lo)) > model%hold_to(block_of(lo) - 1)) many = n
   end function part_of

   !> move_leads for n leads from ...
   subroutine move_block(n, from, model, midpoint, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k, first, last

      call holds(model, from, first, last)
      call keep_rates(model, first, last, state)
      call kick(n, from, model, h, state)
      call project(model, state%mean, state%active, FIRST_HALF, first, last, state)
      call spin(n, from, model, state%poses%quat, state%l, state%poses%w)
      do k = 1, 3
         !$omp simd
         do i = from, from + n - 1
            state%poses%psi(i, k) = 0.5_wp*h(i - from + 1)*state%poses%w(i, k)
            state%poses%w_left(i, k) = state%poses%w(i, k)
            state%poses%v(i, k) = state%v(i, k)
         end do
      end do
      do i = first, last
         state%kept%quat(:, i) = state%poses%quat(model%hold(i)%lead, :)
         state%kept%w(:, i) = state%poses%w(model%hold(i)%lead, :)
      end do
      if (midpoint) then
         call midpoint_drift(model, state, h, from, from + n - 1)
      else
         call drift(n, from, model, h, state)
      end if
      call hold_rotations(model, state%mean, state%active, first, last, state)
      call open_block(n, from, model, h, state)
   end subroutine move_block

   !> First and last hold of the block of a lead
   pure subroutine holds(model, lead, first, last)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lead
      integer, intent(out) :: first, last

      first = model%hold_to(block_of(lead) - 1) + 1
      last = model%hold_to(block_of(lead))
   end subroutine holds

   !> Half a step of the impulses of joints and of loads on secondary nodes
   pure subroutine add_impulses(model, h, lo, hi, state)
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
   end subroutine add_impulses

   !> Angular velocities in the pose reached, the other half of the turn, and no forces yet
   subroutine open_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h(lo:hi)
      type(consistent_state_t), intent(inout) :: state

      integer :: from

      do from = lo, hi, BLOCK
         call open_block(min(BLOCK, hi - from + 1), from, model, h(from:), state)
      end do
      call no_forces(lo, hi, state)
   end subroutine open_leads

   pure subroutine open_block(n, from, model, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k

      call spin(n, from, model, state%poses%quat, state%l, state%poses%w)
      do k = 1, 3
         !$omp simd
         do i = from, from + n - 1
            state%poses%psi(i, k) = state%poses%psi(i, k) + &
               0.5_wp*h(i - from + 1)*state%poses%w(i, k)
         end do
      end do
   end subroutine open_block

   pure subroutine no_forces(lo, hi, state)
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k

      do k = 1, 3
         do i = lo, hi
            state%f(i, k) = 0.0_wp
            state%t(i, k) = 0.0_wp
         end do
         if (size(state%own_f, 1) == 0) cycle
         do i = lo, hi
            state%own_f(i, k) = 0.0_wp
            state%own_t(i, k) = 0.0_wp
         end do
      end do
   end subroutine no_forces

   !> What the dampers look at: predicted velocities, brought onto the conditions, and inverse
   !> inertias
   subroutine look_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi                  !! lo is the first lead of a block
      type(consistent_state_t), intent(inout) :: state

      integer :: from, n, lane, many

      do from = lo, hi, BLOCK
         call movers(model, from, lane, n)
         do while (n > 0)
            many = part_of(n, model, from)
            select case (many)
            case (1)
               call look_block(1, from + lane - 1, model, h(lane:), state)
            case (2)
               call look_block(2, from + lane - 1, model, h(lane:), state)
            case (3)
               call look_block(3, from + lane - 1, model, h(lane:), state)
            case (4)
               call look_block(4, from + lane - 1, model, h(lane:), state)
            case (8)
               call look_block(8, from + lane - 1, model, h(lane:), state)
            case (BLOCK)
               call look_block(BLOCK, from + lane - 1, model, h(lane:), state)
            case default
               call look_block(many, from + lane - 1, model, h(lane:), state)
            end select
            lane = lane + many
            n = n - many
         end do
      end do
   end subroutine look_leads

   subroutine look_block(n, from, model, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: first, last

      call holds(model, from, first, last)
      call predict(n, from, model, h, state)
      call project_rates(model, state%final, state%active, first, last, state)
      call inertias_of(n, from, model, state%poses%quat, state%poses%ij)
   end subroutine look_block

   !> Second half kick of leads lo..hi and the sum of turns
   subroutine kick_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi                  !! lo is the first lead of a block
      type(consistent_state_t), intent(inout) :: state

      integer :: from, n, lane, many

      do from = lo, hi, BLOCK
         call add_impulses(model, h, from, min(from + BLOCK - 1, hi), state)
         call movers(model, from, lane, n)
         do while (n > 0)
            many = part_of(n, model, from)
            select case (many)
            case (1)
               call kick_block(1, from + lane - 1, model, h(lane:), state)
            case (2)
               call kick_block(2, from + lane - 1, model, h(lane:), state)
            case (3)
               call kick_block(3, from + lane - 1, model, h(lane:), state)
            case (4)
               call kick_block(4, from + lane - 1, model, h(lane:), state)
            case (8)
               call kick_block(8, from + lane - 1, model, h(lane:), state)
            case (BLOCK)
               call kick_block(BLOCK, from + lane - 1, model, h(lane:), state)
            case default
               call kick_block(many, from + lane - 1, model, h(lane:), state)
            end select
            lane = lane + many
            n = n - many
         end do
      end do
   end subroutine kick_leads

   subroutine kick_block(n, from, model, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k, first, last

      call holds(model, from, first, last)
      call keep_rates(model, first, last, state)
      call kick(n, from, model, h, state)
      call project(model, state%final, state%active, SECOND_HALF, first, last, state)
      do k = 1, 3
         do i = from, min(from + n - 1, model%n_body)
            state%turn(i, k) = state%turn(i, k) + state%poses%psi(i, k)
         end do
      end do
   end subroutine kick_block

   !> Add the wrenches of the joints to the leads lo..hi, at most BLOCK
   pure subroutine gather(model, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: total(N_SUM), totals(BLOCK, 6)
      integer :: lead, hub, k, n

      if (model%map%abreast) then
         n = hi - lo + 1
         call gather_abreast(model%map, state%wrench, lo, n, totals)
         state%f(lo:hi, :) = state%f(lo:hi, :) + totals(:n, :3)
         state%t(lo:hi, :) = state%t(lo:hi, :) + totals(:n, 4:)
         return
      end if
      hub = first_hub(model%map, lo)
      do lead = lo, hi
         call gather_wrench(model%map, state%wrench, state%part, lead, hub, total)
         do k = 1, 3
            state%f(lead, k) = state%f(lead, k) + total(k)
            state%t(lead, k) = state%t(lead, k) + total(k + 3)
         end do
      end do
   end subroutine gather

end module kj_consistent_leads
