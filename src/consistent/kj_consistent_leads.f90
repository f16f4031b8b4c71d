!> What a step does with its leads, block by block: between the forces of two poses a lead depends
!> on no other.
!> One file: the stages of a step, and the kernels of few leads that they share.
!> Source: docs/theory/consistent.md 2.
module kj_consistent_leads
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of, group_of
   use kj_lead_map, only: lead_map_t, gather_abreast, first_hub, is_hub, sum_hub, N_SUM
   use kj_consistent_matrix, only: N_CONSISTENT_WRENCH
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: midpoint_drift, kick, drift, predict, spin, inertias_of, &
      lead_frames
   use kj_consistent_conditions, only: project, keep_rates, hold_rotations, project_rates, &
      FIRST_HALF, SECOND_HALF
   implicit none
   private

   public :: move_leads, open_leads, look_leads, kick_leads, gather, no_forces

   !> What is done with the leads that move, and with all bodies
   integer, parameter :: MOVE = 1, LOOK = 2, KICKING = 3, IMPULSES = 4

contains

   !> First half kick and drift of leads lo..hi, with their conditions, and what they need before
   !> the forces of the new pose. lo is the first lead of a block.
   subroutine move_leads(model, midpoint, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h(BLOCK)               !! of the leads of each block
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      call work_on_movers(MOVE, model, midpoint, h, lo, hi, state)
   end subroutine move_leads

   !> One thing with all leads among lo..hi that move. Leads that rest have impulses alone: a block
   !> does not see those at either end of it.
   subroutine work_on_movers(what, model, midpoint, h, lo, hi, state)
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: from, n, lane

      do from = lo, hi, BLOCK
         if (what /= LOOK) call work_on_lanes(IMPULSES, from, 1, &
            min(BLOCK, hi - from + 1, model%n_body - from + 1), model, midpoint, h, state)
         call movers(model, from, lane, n)
         call work_on_lanes(what, from, lane, n, model, midpoint, h, state)
      end do
   end subroutine work_on_movers

   !> The same with n leads from a place on of the block that begins with lead lo
   subroutine work_on_lanes(what, lo, lane, n, model, midpoint, h, state)
      integer, value :: what, lo, lane, n
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(BLOCK)
      type(consistent_state_t), intent(inout) :: state

      integer :: many

      do while (n > 0)
         many = part_of(n, model, lo)
         select case (many)                             ! few leads: kernels of their own
         case (1)
            call work(1, lo + lane - 1, what, model, midpoint, h(lane:), state)
         case (2)
            call work(2, lo + lane - 1, what, model, midpoint, h(lane:), state)
         case (3)
            call work(3, lo + lane - 1, what, model, midpoint, h(lane:), state)
         case (4)
            call work(4, lo + lane - 1, what, model, midpoint, h(lane:), state)
         case (8)
            call work(8, lo + lane - 1, what, model, midpoint, h(lane:), state)
         case (BLOCK)
            call work(BLOCK, lo + lane - 1, what, model, midpoint, h(lane:), state)
         case default
            call work(many, lo + lane - 1, what, model, midpoint, h(lane:), state)
         end select
         lane = lane + many
         n = n - many
      end do
   end subroutine work_on_lanes

   !> The same with n leads from ...
   subroutine work(n, from, what, model, midpoint, h, state)
      integer, value :: n, from
      integer, intent(in) :: what
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      select case (what)
      case (IMPULSES)
         call add_impulse(n, from, model%n_lead, model%n_body, h, state%f, state%t, state%own_f, &
            state%own_t, state%impulse, state%angular_impulse)
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

      lane = 1
      n = 0
      associate (m => model%mover(:, block_of(lo)))
         if (m(1) == 0) return
         lane = m(1) - lo + 1
         n = m(2) - m(1) + 1
      end associate
   end subroutine movers

   !> How many of n leads of the block that begins with lead lo go through a kernel at once: all,
   !> where some have conditions
   pure integer function part_of(n, model, lo) result(many)
      integer, intent(in) :: n, lo
      type(consistent_model_t), intent(in) :: model

      many = group_of(n)
      if (many == n) return
      if (model%hold_to(block_of(lo)) > model%hold_to(block_of(lo) - 1)) many = n
   end function part_of

   !> move_leads for n leads from ...
   subroutine move_block(n, from, model, midpoint, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: midpoint
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: i, first, last

      call holds(model, from, first, last)
      if (last >= first) call keep_rates(model, first, last, state)
      call kick(n, from, model, h, state%f, state%t, state%v, state%l)
      if (last >= first) call project(model, state%mean, state%active, FIRST_HALF, first, last, &
         state)
      call spin(n, from, model, state%poses%quat, state%l, state%poses%w)
      call open_turn(n, from, model%n_lead, h, state%v, state%poses%w, state%poses%psi, &
         state%poses%w_left, state%poses%v)
      do i = first, last
         state%kept%quat(:, i) = state%poses%quat(model%hold(i)%lead, :)
         state%kept%w(:, i) = state%poses%w(model%hold(i)%lead, :)
      end do
      if (midpoint) then
         call midpoint_drift(model, state, h, from, from + n - 1)
      else
         call drift(n, from, model, h, state%v, state%l, state%poses%x, state%poses%d, &
            state%poses%quat)
      end if
      if (last >= first) call hold_rotations(model, state%mean, state%active, first, last, state)
      call open_block(n, from, model, h, state)
   end subroutine move_block

   !> Velocities of the half step and the turn in its first half
   pure subroutine open_turn(n, from, n_lead, h, v, w, psi, w_left, v_left)
      integer, value :: n, from, n_lead
      real(wp), intent(in) :: h(n), v(n_lead, 3), w(n_lead, 3)
      real(wp), intent(inout), dimension(n_lead, 3) :: psi, w_left, v_left

      integer :: i, j, k

      do k = 1, 3
         !$omp simd private(i)
         do j = 1, n
            i = from + j - 1
            psi(i, k) = 0.5_wp*h(j)*w(i, k)
            w_left(i, k) = w(i, k)
            v_left(i, k) = v(i, k)
         end do
      end do
   end subroutine open_turn

   !> First and last hold of the block of a lead
   pure subroutine holds(model, lead, first, last)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lead
      integer, intent(out) :: first, last

      first = model%hold_to(block_of(lead) - 1) + 1
      last = model%hold_to(block_of(lead))
   end subroutine holds

   !> Half a step of the impulses of joints and of loads on secondary nodes, of n bodies from ...:
   !> p += h/2 (f - own_f), l += h/2 (t - own_t)
   pure subroutine add_impulse(n, from, n_lead, n_body, h, f, t, own_f, own_t, p, l)
      integer, value :: n, from, n_lead, n_body
      real(wp), intent(in) :: h(n)
      real(wp), intent(in), dimension(n_lead, 3) :: f, t, own_f, own_t
      real(wp), intent(inout) :: p(n_body, 3), l(n_body, 3)

      integer :: i, j, k

      do k = 1, 3
         !$omp simd private(i)
         do j = 1, n
            i = from + j - 1
            p(i, k) = p(i, k) + 0.5_wp*h(j)*(f(i, k) - own_f(i, k))
            l(i, k) = l(i, k) + 0.5_wp*h(j)*(t(i, k) - own_t(i, k))
         end do
      end do
   end subroutine add_impulse

   !> Angular velocities in the pose reached, and the other half of the turn
   subroutine open_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h(lo:hi)
      type(consistent_state_t), intent(inout) :: state

      integer :: from

      do from = lo, hi, BLOCK
         call open_block(min(BLOCK, hi - from + 1), from, model, h(from:), state)
      end do
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

   !> What the dampers look at: predicted velocities, with what the host of single joints adds to
   !> forces, brought onto the conditions; and inverse inertias
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

      real(wp) :: e(BLOCK, 9), inverse(BLOCK, 6), f(BLOCK, 3), t(BLOCK, 3)
      integer :: to, k, first, last

      call holds(model, from, first, last)
      to = from + n - 1
      do k = 1, 3
         f(:n, k) = state%f(from:to, k)
         t(:n, k) = state%t(from:to, k)
      end do
      if (allocated(state%f_ahead)) then
         f(:n, :) = f(:n, :) + state%f_ahead(from:to, :)
         t(:n, :) = t(:n, :) + state%t_ahead(from:to, :)
      end if
      call lead_frames(n, from, model%n_lead, state%poses%quat, e)
      call inertias_of(n, from, model, e, inverse, state%poses%ij)
      call predict(n, from, model, h, inverse, f, t, state%v, state%l, state%poses%v, &
         state%poses%w)
      if (last >= first) call project_rates(model, state%final, state%active, first, last, state)
   end subroutine look_block

   !> Second half kick of leads lo..hi and the sum of turns
   subroutine kick_leads(model, h, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(BLOCK)
      integer, intent(in) :: lo, hi                  !! lo is the first lead of a block
      type(consistent_state_t), intent(inout) :: state

      call work_on_movers(KICKING, model, .false., h, lo, hi, state)
   end subroutine kick_leads

   subroutine kick_block(n, from, model, h, state)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      type(consistent_state_t), intent(inout) :: state

      integer :: first, last

      call holds(model, from, first, last)
      if (last >= first) call keep_rates(model, first, last, state)
      call kick(n, from, model, h, state%f, state%t, state%v, state%l)
      if (last >= first) call project(model, state%final, state%active, SECOND_HALF, first, last, &
         state)
      call add_turn(from, min(from + n - 1, model%n_body), model%n_lead, model%n_body, &
         state%poses%psi, state%turn)
   end subroutine kick_block

   !> turn += psi of bodies from..to
   pure subroutine add_turn(from, to, n_lead, n_body, psi, turn)
      integer, value :: from, to, n_lead, n_body
      real(wp), intent(in) :: psi(n_lead, 3)
      real(wp), intent(inout) :: turn(n_body, 3)

      integer :: i

      !$omp simd
      do i = from, to
         turn(i, 1) = turn(i, 1) + psi(i, 1)
         turn(i, 2) = turn(i, 2) + psi(i, 2)
         turn(i, 3) = turn(i, 3) + psi(i, 3)
      end do
   end subroutine add_turn

   !> The wrenches of the joints on the leads lo..hi, at most BLOCK: all that acts on them so far
   !> (afresh), or more of it
   pure subroutine gather(model, afresh, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: afresh
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: totals(BLOCK, 6)
      integer :: n

      if (.not. model%map%abreast) then
         call add_wrenches(model%map, afresh, lo, hi, model%n_lead, size(state%wrench, 2), &
            size(state%own_f, 1), state%wrench, state%part, state%f, state%t, state%own_f, &
            state%own_t)
         return
      end if
      n = hi - lo + 1
      call gather_abreast(model%map, state%wrench, lo, n, totals)
      if (afresh) call no_forces(lo, hi, model%n_lead, state%f, state%t)
      if (afresh) call no_forces(lo, hi, model%n_lead, state%own_f, state%own_t)
      state%f(lo:hi, :) = state%f(lo:hi, :) + totals(:n, :3)
      state%t(lo:hi, :) = state%t(lo:hi, :) + totals(:n, 4:)
   end subroutine gather

   !> f = 0 and t = 0 of leads lo..hi
   pure subroutine no_forces(lo, hi, n_lead, f, t)
      integer, value :: lo, hi, n_lead               !! n_lead: 0 where there are no f and t
      real(wp), intent(inout) :: f(n_lead, 3), t(n_lead, 3)

      integer :: i, k

      if (n_lead == 0) return
      do i = lo, hi
         do k = 1, 3
            f(i, k) = 0.0_wp
            t(i, k) = 0.0_wp
         end do
      end do
   end subroutine no_forces

   pure subroutine add_wrenches(map, afresh, lo, hi, n_lead, n_joint, n_own, wrench, part, f, t, &
      own_f, own_t)
      type(lead_map_t), intent(in) :: map
      logical, intent(in) :: afresh
      integer, value :: lo, hi, n_lead, n_joint, n_own   !! n_own: n_lead, or 0
      real(wp), intent(in) :: wrench(N_CONSISTENT_WRENCH, n_joint), part(:, :)
      real(wp), intent(inout) :: f(n_lead, 3), t(n_lead, 3), own_f(n_own, 3), own_t(n_own, 3)

      real(wp) :: total(6), of_hub(N_SUM)
      integer :: lead, hub, i, j, k

      hub = first_hub(map, lo)
      do lead = lo, hi
         if (is_hub(map, lead)) then
            call sum_hub(map, part, hub, of_hub)
            total = of_hub(:6)
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
         if (.not. afresh) then
            do k = 1, 3
               total(k) = f(lead, k) + total(k)
               total(k + 3) = t(lead, k) + total(k + 3)
            end do
         else if (n_own > 0) then
            do k = 1, 3
               own_f(lead, k) = 0.0_wp
               own_t(lead, k) = 0.0_wp
            end do
         end if
         do k = 1, 3
            f(lead, k) = total(k)
            t(lead, k) = total(k + 3)
         end do
      end do
   end subroutine add_wrenches

end module kj_consistent_leads
