!> What the legacy scheme shows at t(n), between the two halves of a cycle.
module kj_legacy_snapshot
   use kj_kinds, only: wp
   use kj_joint_batch, only: joint_batch_t
   use kj_block, only: BLOCK
   use kj_model, only: model_t
   use kj_snapshot, only: snapshot_t, shown_joints_t, show_owner, show_node
   use kj_energy, only: balance_of
   use kj_legacy_state, only: legacy_state_t
   use kj_legacy_load, only: gravity_at
   use kj_legacy_body, only: secondary_velocity
   implicit none
   private

   public :: show_legacy, show_legacy_clock

contains

   !> Everything; the energy of the first cycle is that of the start.
   !>
   !> Energy error E/(E0 + W) - 1, between -0.999 and 0.999, with E0 the energy at t = 0 less the
   !> work that cycle 0 already holds. Source: docs/theory/legacy.md 8.
   subroutine show_legacy(model, state, now)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      type(snapshot_t), intent(inout) :: now

      real(wp) :: energy

      call show_legacy_clock(model, state, now)
      now%lag = 0.5_wp*state%h1
      now%stops_alone = .true.
      now%work = state%work
      call show_leads(model, state, now)
      call show_nodes(model, state, now)
      call show_joints(model, state, now)
      now%balance = balance_of(model, now)
      associate (b => now%balance)
         energy = b%kinetic_trans + b%kinetic_rot + b%internal
      end associate
      if (state%cycle == 0) state%energy0 = energy - state%work
      now%energy_error = 0.0_wp
      if (abs(state%energy0 + state%work) < 1.0e-20_wp) return
      now%energy_error = energy/(state%energy0 + state%work) - 1.0_wp
      ! one that is not a number stays that
      if (now%energy_error < -0.999_wp) now%energy_error = -0.999_wp
      if (now%energy_error > 0.999_wp) now%energy_error = 0.999_wp
   end subroutine show_legacy

   !> Cycle, time, step and who limits it
   subroutine show_legacy_clock(model, state, now)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      now%cycle = state%cycle
      now%time = state%time
      now%step = state%h2
      call show_owner(model, state%owner_kind, state%owner, now)
   end subroutine show_legacy_clock

   subroutine show_leads(model, state, now)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      real(wp) :: g(3)
      integer :: i, k, lead

      associate (n => model%n_lead, nb => model%n_body)
         now%x = state%world%x(:n, :)
         now%v = state%v(:n, :)
         now%w = state%world%w
         now%a = state%a
         now%al = state%al
         now%m = state%m + state%m_own
         now%f = 0.0_wp                          ! gravity first
         do i = 1, size(model%gravity)
            g = gravity_at(model, state, model%gravity(i), state%time)
            do k = 1, size(model%gravity(i)%node)
               lead = model%gravity(i)%node(k)
               now%f(lead, :) = now%f(lead, :) + g
            end do
         end do
         do k = 1, 3
            now%f(:, k) = state%f(:, k) + state%f_own(:, k) + state%mass*now%f(:, k)
         end do
         now%mass = state%mass
         now%inertia = state%inertia
         now%principal = state%principal
         now%p = state%p
         now%impulse = state%impulse
         now%angular_impulse = state%angular_impulse
         ! that of this cycle, too
         now%rotation_sum = state%rotation_sum + state%h2*state%world%w(:nb, :)
      end associate
   end subroutine show_leads

   !> The acceleration of a secondary node is the difference of its velocities over h12. Conditions
   !> act on it one cycle later than on its body.
   subroutine show_nodes(model, state, now)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      real(wp), dimension(3) :: v, w, w_old, a, al
      integer :: k, lead

      do k = 1, size(model%th_node)
         associate (node => model%th_node(k), x => state%world%x)
            lead = model%lead(node)
            w_old = state%world%w(lead, :)
            a = state%a(lead, :)
            al = state%al(lead, :)
            if (node /= lead) then
               v = state%v(lead, :) + state%h12*a
               w = w_old + state%h12*al
               if (state%bcs_of(lead) > 0) w_old = state%w_before(state%bcs_of(lead), :)
               al = (w - w_old)/state%h12
               a = (secondary_velocity(v, w, x(node, :) - x(lead, :), state%h2, state%h12, &
                  model%n_secondary(lead) <= 2) - state%v(node, :))/state%h12
            end if
            call show_node(model, k, state%world%skew(model%th_node_skew(k), :), x(node, :), &
               state%d(node, :), state%v(node, :), w_old, a, al, now)
         end associate
      end do
   end subroutine show_nodes

   subroutine show_joints(model, state, now)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      integer :: b, at, from, to, n

      do b = 1, size(model%batch)
         associate (joint => state%joint(b), shown => now%joint(b))
            do at = 1, size(joint%block)
               from = (at - 1)*BLOCK + 1
               to = min(at*BLOCK, model%batch(b)%n)
               n = to - from + 1
               associate (s => joint%block(at))
                  shown%e(from:to, :) = s%e(:n, :)
                  shown%q(from:to, :) = s%q(:n, :)
                  shown%rate(from:to, :) = s%qdot(:n, :)
                  shown%f(from:to, :) = s%f(:n, :)
                  shown%energy(from:to) = s%energy(:n)
               end associate
               if (.not. allocated(joint%limit)) cycle
               associate (l => joint%limit(at))
                  shown%k_block(from:to, :) = l%k_block(:n, :)
                  shown%stored(from:to) = l%stored(:n)
                  shown%slip_energy(from:to) = l%slip_energy(:n)
                  shown%flag(from:to, :) = nint(l%flag(:n, :))
               end associate
            end do
            call show_lengths(model%batch(b), state%world%x, shown)
         end associate
      end do
   end subroutine show_joints

   !> Places, distances of nodes, and the largest angles by which two axes miss a right angle
   pure subroutine show_lengths(batch, x, shown)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(in) :: x(:, :)            !! (n_node, 3)
      type(shown_joints_t), intent(inout) :: shown

      real(wp) :: most
      integer :: j, k, l

      do j = 1, batch%n
         associate (n1 => batch%node(j, 1), n2 => batch%node(j, 2), e => shown%e)
            shown%x(j, :) = 0.5_wp*(x(n1, :) + x(n2, :))
            shown%length(j) = sqrt((x(n2, 1) - x(n1, 1))**2 + (x(n2, 2) - x(n1, 2))**2 + &
               (x(n2, 3) - x(n1, 3))**2)
            most = 0.0_wp
            do k = 0, 6, 3
               l = modulo(k + 3, 9)
               most = max(most, abs(e(j, k + 1)*e(j, l + 1) + e(j, k + 2)*e(j, l + 2) + &
                  e(j, k + 3)*e(j, l + 3)))
            end do
            shown%ortho(j) = asin(min(1.0_wp, most))
         end associate
      end do
   end subroutine show_lengths

end module kj_legacy_snapshot
