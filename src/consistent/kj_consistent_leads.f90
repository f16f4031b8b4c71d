!> What a step does with its leads, block by block: between the forces of two poses a lead depends
!> on no other.
!> Source: docs/theory/consistent.md 2.
module kj_consistent_leads
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of, group_of
   use kj_lead_map, only: lead_map_t, gather_wrench, gather_abreast, first_hub, N_SUM, SPAN
   use kj_consistent_matrix, only: N_CONSISTENT_WRENCH
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: midpoint_drift, kick, drift, predict, spin, inertias_of
   use kj_consistent_conditions, only: project, keep_rates, hold_rotations, project_rates, &
      FIRST_HALF, SECOND_HALF
   implicit none
   private

   public :: move_leads, open_leads, look_leads, kick_leads, gather

   !> What is done with the leads that move
   integer, parameter :: MOVE = 1, LOOK = 2, KICKING = 3

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

      call add_impulses(model, h, lo, hi, state)
      call work_on_movers(MOVE, model, midpoint, h, lo, hi, state)
      call no_forces(lo, hi, model%n_lead, size(state%own_f, 1), state%f, state%t, state%own_f, &
         state%own_t)
   end subroutine move_leads

   !> One thing with all leads among lo..hi that move
   subroutine work_on_movers(what, model, midpoint, h, lo, hi, state)
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: from, n, lane, many

      do from = lo, hi, BLOCK
         call movers(model, from, lane, n)
         do while (n > 0)
            many = part_of(n, model, from)
            select case (many)                          ! few leads: kernels of their own
            case (1)
               call work(1, from + lane - 1, what, model, midpoint, h(lane:), state)
            case (2)
               call work(2, from + lane - 1, what, model, midpoint, h(lane:), state)
            case (3)
               call work(3, from + lane - 1, what, model, midpoint, h(lane:), state)
            case (4)
               call work(4, from + lane - 1, what, model, midpoint, h(lane:), state)
            case (8)
               call work(8, from + lane - 1, what, model, midpoint, h(lane:), state)
            case (BLOCK)
               call work(BLOCK, from + lane - 1, what, model, midpoint, h(lane:), state)
            case default
               call work(many, from + lane - 1, what, model, midpoint, h(lane:), state)
            end select
            lane = lane + many
            n = n - many
         end do
      end do
   end subroutine work_on_movers

   !> The same with n leads from ...
   subroutine work(n, from, what, model, midpoint, h, state)
      integer, value :: n, from
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      select case (what)
      case (MOVE)
         call move_block(n, from, model, midpoint, h, state)
      case (LOOK)
         call look_block(n, from, model, h, state)
      case (KICKING)
         call kick_block(n, from, model, h, state)
      end select
   end subroutine work

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

   !> How many of n leads of the block that begins with lead lo go through a kernel at once: all,
   !> where some have conditions
   pure integer function part_of(n, model, lo) result(many)
      integer, intent(in) :: n, lo
      type(consistent_model_t), intent(in) :: model

      many = group_of(n)
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
      if (last >= first) call keep_rates(model, first, last, state)
      call kick(n, from, model, h, state)
      if (last >= first) call project(model, state%mean, state%active, FIRST_HALF, first, last, &
         state)
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
      if (last >= first) call hold_rotations(model, state%mean, state%active, first, last, state)
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
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: from

      do from = lo, min(hi, model%n_body), BLOCK
         call add_impulse(from, min(from + BLOCK - 1, hi, model%n_body), model%n_lead, &
            model%n_body, h, state%f, state%t, state%own_f, state%own_t, state%impulse, &
            state%angular_impulse)
      end do
   end subroutine add_impulses

   !> p += h/2 (f - own_f), l += h/2 (t - own_t) of bodies lo..hi
   pure subroutine add_impulse(lo, hi, n_lead, n_body, h, f, t, own_f, own_t, p, l)
      integer, value :: lo, hi, n_lead, n_body
      real(wp), intent(in) :: h(lo:hi)
      real(wp), intent(in), dimension(n_lead, 3) :: f, t, own_f, own_t
      real(wp), intent(inout) :: p(n_body, 3), l(n_body, 3)

      integer :: i

      !$omp simd
      do i = lo, hi
         p(i, 1) = p(i, 1) + 0.5_wp*h(i)*(f(i, 1) - own_f(i, 1))
         p(i, 2) = p(i, 2) + 0.5_wp*h(i)*(f(i, 2) - own_f(i, 2))
         p(i, 3) = p(i, 3) + 0.5_wp*h(i)*(f(i, 3) - own_f(i, 3))
         l(i, 1) = l(i, 1) + 0.5_wp*h(i)*(t(i, 1) - own_t(i, 1))
         l(i, 2) = l(i, 2) + 0.5_wp*h(i)*(t(i, 2) - own_t(i, 2))
         l(i, 3) = l(i, 3) + 0.5_wp*h(i)*(t(i, 3) - own_t(i, 3))
      end do
   end subroutine add_impulse

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
      call no_forces(lo, hi, model%n_lead, size(state%own_f, 1), state%f, state%t, state%own_f, &
         state%own_t)
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

   pure subroutine no_forces(lo, hi, n_lead, n_own, f, t, own_f, own_t)
      integer, value :: lo, hi, n_lead, n_own        !! n_own: 0 or n_lead
      real(wp), intent(inout) :: f(n_lead, 3), t(n_lead, 3), own_f(n_own, 3), own_t(n_own, 3)

      integer :: i, k

      do i = lo, hi
         do k = 1, 3
            f(i, k) = 0.0_wp
            t(i, k) = 0.0_wp
            if (n_own > 0) own_f(i, k) = 0.0_wp
            if (n_own > 0) own_t(i, k) = 0.0_wp
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

      call work_on_movers(LOOK, model, .false., h, lo, hi, state)
   end subroutine look_leads

   subroutine look_block(n, from, model, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: first, last

      call holds(model, from, first, last)
      call predict(n, from, model, h, state)
      if (last >= first) call project_rates(model, state%final, state%active, first, last, state)
      call inertias_of(n, from, model, state%poses%quat, state%poses%ij)
   end subroutine look_block

   !> Second half kick of leads lo..hi and the sum of turns
   subroutine kick_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi                  !! lo is the first lead of a block
      type(consistent_state_t), intent(inout) :: state

      call add_impulses(model, h, lo, hi, state)
      call work_on_movers(KICKING, model, .false., h, lo, hi, state)
   end subroutine kick_leads

   subroutine kick_block(n, from, model, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, k, first, last

      call holds(model, from, first, last)
      if (last >= first) call keep_rates(model, first, last, state)
      call kick(n, from, model, h, state)
      if (last >= first) call project(model, state%final, state%active, SECOND_HALF, first, last, &
         state)
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

      real(wp) :: totals(BLOCK, 6)
      integer :: n

      if (.not. model%map%abreast) then
         call add_wrenches(model%map, lo, hi, model%n_lead, size(state%wrench, 2), state%wrench, &
            state%part, state%f, state%t)
         return
      end if
      n = hi - lo + 1
      call gather_abreast(model%map, state%wrench, lo, n, totals)
      state%f(lo:hi, :) = state%f(lo:hi, :) + totals(:n, :3)
      state%t(lo:hi, :) = state%t(lo:hi, :) + totals(:n, 4:)
   end subroutine gather

   pure subroutine add_wrenches(map, lo, hi, n_lead, n_joint, wrench, part, f, t)
      type(lead_map_t), intent(in) :: map
      integer, value :: lo, hi, n_lead, n_joint
      real(wp), intent(in) :: wrench(N_CONSISTENT_WRENCH, n_joint), part(:, :)
      real(wp), intent(inout) :: f(n_lead, 3), t(n_lead, 3)

      real(wp) :: total(N_SUM)
      integer :: lead, hub, i, j, k

      hub = first_hub(map, lo)
      do lead = lo, hi
         if (map%first(lead + 1) - map%first(lead) > SPAN) then
            call gather_wrench(map, wrench, part, lead, hub, total)
         else
            total = 0.0_wp
            do i = map%first(lead), map%first(lead + 1) - 1
               j = map%joint(i)
               if (j > 0) then
                  do k = 1, 6
                     total(k) = total(k) + wrench(k, j)
                  end do
               else
                  do k = 1, 3
                     total(k) = total(k) - wrench(k, -j)
                     total(k + 3) = total(k + 3) + wrench(k + 6, -j)
                  end do
               end if
            end do
         end if
         do k = 1, 3
            f(lead, k) = f(lead, k) + total(k)
            t(lead, k) = t(lead, k) + total(k + 3)
         end do
      end do
   end subroutine add_wrenches

end module kj_consistent_leads
