!> What the consistent formulation shows, all at time t.
module kj_consistent_snapshot
   use kj_kinds, only: wp
   use kj_math3, only: cross, rotation_vector
   use kj_skew, only: skew_axes
   use kj_snapshot, only: snapshot_t, shown_joints_t, show_owner, show_node, OWNER_NONE, OWNER_JOINT
   use kj_energy, only: balance_of
   use kj_joint_types, only: CHART_UNIVERSAL
   use kj_joint_batch, only: joint_batch_t, is_spring
   use kj_consistent_batch, only: consistent_joint_t, frame_of
   use kj_block, only: BLOCK, turn_frames
   use kj_consistent_chart, only: quaternion_frame
   use kj_consistent_matrix, only: joint_rates
   use kj_consistent_springs, only: turn_balls
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: spin_velocity
   use kj_consistent_conditions, only: body_matrix, held_force
   use kj_consistent_motion, only: motion_accelerations
   use kj_consistent_step, only: place_node
   use kj_consistent_march, only: march_t, balance_ledger, COMPLIANT
   use kj_consistent_compliant_show, only: begin_show, end_show
   use kj_consistent_islands, only: part_t, gather_parts
   implicit none
   private

   public :: show_consistent, show_consistent_clock

   integer, parameter :: NEXT(4) = [2, 3, 1, 2]   !! direction after 1, 2, 3, 4

contains

   !> Everything; the ledger of the state is balanced
   subroutine show_consistent(model, march, state, part, now)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(inout) :: march
      type(consistent_state_t), intent(inout) :: state
      type(part_t), intent(inout) :: part(:)     !! islands; none: the scene marches as one
      type(snapshot_t), intent(inout) :: now

      if (size(part) > 0) then
         call gather_parts(model, part, state, march)
      else
         call balance_ledger(model, state)
         call begin_show(model, march%pace, state)
      end if
      call show_consistent_clock(model, march, state, now)
      now%counts_losses = march%integrator == COMPLIANT
      now%work = state%work
      now%energy_error = state%error
      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      state%poses%v = state%v
      call show_leads(model, state, now)
      call show_nodes(model, state, now)
      call show_joints(model, state, now)
      call add_looseness(model, state, now)
      call note_loosest(model, now)
      now%balance = balance_of(model%model_t, now)
      if (size(part) == 0) call end_show(model, state)
   end subroutine show_consistent

   !> Cycle, time, step and who limits it
   subroutine show_consistent_clock(model, march, state, now)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(in) :: march
      type(consistent_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      integer :: j

      now%cycle = state%cycle
      now%time = state%time
      now%step = state%h
      if (state%cycle == 0) now%step = min(march%limit, march%first)
      call show_owner(model%model_t, OWNER_NONE, 0, now)
      if (march%joint == 0) return
      do j = 1, model%n_element
         if (model%batch(model%joint(j)%batch)%first + model%joint(j)%place == march%joint) exit
      end do
      call show_owner(model%model_t, OWNER_JOINT, j, now)
   end subroutine show_consistent_clock

   subroutine show_leads(model, state, now)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      real(wp) :: wanted(size(model%motion))
      logical :: on(size(model%motion))
      integer :: from

      call motion_accelerations(model, state, wanted, on)
      now%x = state%poses%x
      now%v = state%v
      now%w = state%poses%w
      now%f = state%f
      now%m = state%t
      do from = 1, model%n_lead, BLOCK
         call show_block(model, state, from, min(BLOCK, model%n_lead - from + 1), wanted, on, now)
      end do
      now%impulse = state%impulse
      now%angular_impulse = state%angular_impulse
      now%rotation_sum = state%turn
   end subroutine show_leads

   !> Accelerations and principal axes of n leads from ...
   subroutine show_block(model, state, from, n, wanted, on, now)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: from, n
      real(wp), intent(in) :: wanted(:)          !! (n_motion) accelerations of motions
      logical, intent(in) :: on(:)               !! that act now
      type(snapshot_t), intent(inout) :: now

      real(wp) :: q(BLOCK, 4), p(BLOCK, 9), f(BLOCK, 3), t(BLOCK, 3), l(BLOCK, 3), held(3, 2)
      integer :: i, k, to

      to = from + n - 1
      q(:n, :) = state%poses%quat(from:to, :)
      call quaternion_frame(n, q, p)
      f(:n, :) = state%f(from:to, :)
      l(:n, :) = state%l(from:to, :)
      associate (w => state%poses%w(from:to, :))
         do k = 1, 3
            t(:n, k) = state%t(from:to, k) - (w(:, NEXT(k))*l(:n, NEXT(k + 1)) - &
               w(:, NEXT(k + 1))*l(:n, NEXT(k)))
         end do
      end associate
      do i = 1, n
         if (model%rests(from + i - 1)) then
            f(i, :) = 0.0_wp
            t(i, :) = 0.0_wp
         end if
         if (model%hold_of(from + i - 1) == 0) cycle
         held(:, 1) = f(i, :)
         held(:, 2) = t(i, :)
         call held_force(model, state, model%hold_of(from + i - 1), held(:, 1), held(:, 2), &
            wanted, on)
         f(i, :) = held(:, 1)
         t(i, :) = held(:, 2)
      end do
      do k = 1, 3
         now%a(from:to, k) = model%inverse_mass(from:to)*f(:n, k)
         l(:n, k) = model%inverse_inertia(from:to, k)*(t(:n, 1)*p(:n, 3*k - 2) + &
            t(:n, 2)*p(:n, 3*k - 1) + t(:n, 3)*p(:n, 3*k))
      end do
      do k = 1, 3
         now%al(from:to, k) = p(:n, k)*l(:n, 1) + p(:n, k + 3)*l(:n, 2) + p(:n, k + 6)*l(:n, 3)
      end do
      call turn_axes(min(n, model%n_body - from + 1), p, model%axes0(from:, :), &
         model%axes(from:, :), now%p(from:, :))
   end subroutine show_block

   !> Principal axes from those at the start: p axes0^T axes
   pure subroutine turn_axes(n, p, axes0, axes, now)
      integer, intent(in) :: n
      real(wp), intent(in) :: p(BLOCK, 9)        !! body axes now, W
      real(wp), intent(in) :: axes0(:, :)        !! (n, 9) body axes at the start, W
      real(wp), intent(in) :: axes(:, :)         !! (n, 9) principal axes at the start, W
      real(wp), intent(inout) :: now(:, :)       !! (n, 9) principal axes now, W

      real(wp) :: m(3)
      integer :: i, k, col

      do col = 0, 6, 3
         !$omp simd private(m, k)
         do i = 1, n
            do k = 1, 3
               m(k) = axes0(i, 3*k - 2)*axes(i, col + 1) + axes0(i, 3*k - 1)*axes(i, col + 2) + &
                  axes0(i, 3*k)*axes(i, col + 3)
            end do
            do k = 1, 3
               now(i, col + k) = p(i, k)*m(1) + p(i, k + 3)*m(2) + p(i, k + 6)*m(3)
            end do
         end do
      end do
   end subroutine turn_axes

   !> Nodes of the history from the poses
   subroutine show_nodes(model, state, now)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      real(wp), dimension(3) :: r, x, d, v, a
      integer :: k, lead

      do k = 1, size(model%th_node)
         associate (node => model%th_node(k))
            lead = model%lead(node)
            x = now%x(lead, :)
            d = state%poses%d(lead, :)
            v = now%v(lead, :)
            a = now%a(lead, :)
            if (node /= lead) then
               r = place_node(model, state, node) - x
               x = x + r
               d = d + (r - (model%x0(node, :) - model%x0(lead, :)))
               v = v + cross(now%w(lead, :), r)
               a = a + cross(now%al(lead, :), r) + cross(now%w(lead, :), cross(now%w(lead, :), r))
            end if
            call show_node(model%model_t, k, skew_now(model, state, model%th_node_skew(k)), x, d, &
               v, now%w(lead, :), a, now%al(lead, :), now)
         end associate
      end do
   end subroutine show_nodes

   !> Axes of a skew
   pure function skew_now(model, state, s) result(axes)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: s
      real(wp) :: axes(9)

      axes = model%skews%axes(s, :)
      if (s == 0) return
      associate (dir => model%skews%dir(s), node => model%skews%node(:, s))
         if (dir > 0) axes = skew_axes(dir, place_node(model, state, node(1)), &
            place_node(model, state, node(2)), place_node(model, state, node(3)))
      end associate
   end function skew_now

   subroutine show_joints(model, state, now)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(snapshot_t), intent(inout) :: now

      integer :: b, j

      do b = 1, size(model%batch)
         associate (batch => model%batch(b), geometry => model%batch(b)%geometry, &
            joint => state%joint(b), shown => now%joint(b))
            call show_blocks(batch%n, joint, shown)
            if (allocated(geometry%rail)) call show_half_way(batch%xl0, geometry%rail, shown)
            if (batch%limited) shown%k_block = batch%limit%k_block
            call turn_balls(batch, state%poses, joint)
            call joint_rates(batch, state%poses, joint, shown%rate)
            shown%ortho = 0.0_wp
            if (geometry%chart == CHART_UNIVERSAL) then
               do j = 1, batch%n
                  shown%e(j, :) = frame_of(batch, joint, j)
               end do
               shown%ortho = skewness(shown%e)
            end if
            call show_in_mean_frame(geometry%plain, shown%e, shown%q, shown%f, shown%rate)
            do j = 1, batch%n
               shown%x(j, :) = 0.5_wp*(place_node(model, state, batch%node(j, 1)) + &
                  place_node(model, state, batch%node(j, 2)))
            end do
            call show_lengths(batch%xl0, shown)
            if (geometry%shifted) shown%q(:, 4:6) = shown%q(:, 4:6) + batch%angle0
         end associate
      end do
   end subroutine show_joints

   !> Coordinates, forces, energies, what limits do, and the axes of the translations, which are the
   !> frames of all but universal joints
   pure subroutine show_blocks(n_joint, joint, shown)
      integer, intent(in) :: n_joint
      type(consistent_joint_t), intent(in) :: joint
      type(shown_joints_t), intent(inout) :: shown

      integer :: at, from, to, n

      do at = 1, size(joint%block)
         from = (at - 1)*BLOCK + 1
         to = min(at*BLOCK, n_joint)
         n = to - from + 1
         associate (lanes => joint%block(at))
            shown%q(from:to, :) = lanes%q(:n, :)
            shown%f(from:to, :) = lanes%fe(:n, :) + lanes%fd(:n, :)
            shown%dissipated(from:to) = lanes%dissipated(:n)
            shown%energy(from:to) = lanes%elastic(:n) + lanes%dissipated(:n)
            shown%e(from:to, :) = lanes%b%force(:n, :)
         end associate
         if (.not. allocated(joint%limit)) cycle
         associate (limit => joint%limit(at))
            shown%f(from:to, :) = shown%f(from:to, :) + limit%friction(:n, :)
            shown%slip_energy(from:to) = limit%slip_energy(:n)
            shown%stored(from:to) = limit%stored(:n)
            shown%flag(from:to, :) = nint(limit%flag(:n, :))
         end associate
      end do
   end subroutine show_blocks

   !> Moments of joints on a rail as those of the mean frame are: half way between the nodes
   pure subroutine show_half_way(xl0, rail, shown)
      real(wp), intent(in) :: xl0(:, :)          !! (n, 3) offset at the start, J
      real(wp), intent(in) :: rail(:)
      type(shown_joints_t), intent(inout) :: shown

      real(wp) :: r(3)
      integer :: j

      do j = 1, size(rail)
         r = 0.5_wp*rail(j)*(xl0(j, :) + shown%q(j, 1:3))
         shown%f(j, 5) = shown%f(j, 5) + (r(3)*shown%f(j, 1) - r(1)*shown%f(j, 3))
         shown%f(j, 6) = shown%f(j, 6) + (r(1)*shown%f(j, 2) - r(2)*shown%f(j, 1))
      end do
   end subroutine show_half_way

   !> Node 2 is E (xl0 + q) from node 1
   pure subroutine show_lengths(xl0, shown)
      real(wp), intent(in) :: xl0(:, :)          !! (n, 3) offset at the start, J
      type(shown_joints_t), intent(inout) :: shown

      real(wp) :: u(3), r(3)
      integer :: j

      do j = 1, size(xl0, 1)
         u = xl0(j, :) + shown%q(j, 1:3)
         r = u(1)*shown%e(j, 1:3) + u(2)*shown%e(j, 4:6) + u(3)*shown%e(j, 7:9)
         shown%length(j) = sqrt(r(1)**2 + r(2)**2 + r(3)**2)
      end do
   end subroutine show_lengths

   !> Angle by which the second and third axis miss a right angle [rad]
   pure function skewness(e) result(angle)
      real(wp), intent(in) :: e(:, :)            !! (n, 9)
      real(wp) :: angle(size(e, 1))

      angle = abs(asin(max(-1.0_wp, min(1.0_wp, sum(e(:, 4:6)*e(:, 7:9), dim=2)))))
   end function skewness

   !> Components of joints that need no frame, from the frame of body 1 to the mean frame, which is
   !> turned by half the rotation between the two; components turn the other way
   pure subroutine show_in_mean_frame(plain, e, q, f, rate)
      logical, intent(in) :: plain(:)            !! those joints
      real(wp), intent(inout) :: e(:, :), q(:, :), f(:, :), rate(:, :)   !! (n, 9), (n, 6)

      real(wp), dimension(BLOCK, 9) :: frame, own
      real(wp) :: turn(BLOCK, 3), phi(BLOCK, 3)
      integer :: from, to, n, k

      do from = 1, size(plain), BLOCK
         n = min(BLOCK, size(plain) - from + 1)
         to = from + n - 1
         if (.not. any(plain(from:to))) cycle
         frame(:n, :) = e(from:to, :)
         do k = 1, 3
            own(:n, k) = q(from:to, k)
            own(:n, 3 + k) = f(from:to, k)
            own(:n, 6 + k) = rate(from:to, k)
            turn(:n, k) = merge(0.5_wp*q(from:to, 3 + k), 0.0_wp, plain(from:to))
         end do
         do k = 1, 3
            phi(:n, k) = turn(:n, 1)*frame(:n, k) + turn(:n, 2)*frame(:n, 3 + k) + &
               turn(:n, 3)*frame(:n, 6 + k)
         end do
         call turn_frames(n, phi, frame)
         turn(:n, :) = -turn(:n, :)
         call turn_frames(n, turn, own)
         e(from:to, :) = frame(:n, :)
         q(from:to, 1:3) = own(:n, 1:3)
         f(from:to, 1:3) = own(:n, 4:6)
         rate(from:to, 1:3) = own(:n, 7:9)
      end do
   end subroutine show_in_mean_frame

   !> The largest loss of orthogonality of all times, and whose it is
   subroutine note_loosest(model, now)
      type(consistent_model_t), intent(in) :: model
      type(snapshot_t), intent(inout) :: now

      integer :: j

      do j = 1, model%n_joint
         associate (o => now%joint(model%joint(j)%batch)%ortho(model%joint(j)%place))
            if (.not. o > now%loosest) cycle
            now%loosest = o
            now%loosest_joint = j
         end associate
      end do
   end subroutine note_loosest

   !> Turn of a loose skew away from the triad that its joint end carries
   subroutine add_looseness(model, state, now)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(snapshot_t), intent(inout) :: now

      real(wp) :: axes(3, 3), then(3, 3), p(3, 3)
      integer :: k, s, lead

      do k = 1, size(model%loose, 2)
         associate (ref => model%joint(model%loose(1, k)), e => model%loose(2, k))
            s = model%batch(ref%batch)%skew(ref%place, e)
            lead = model%batch(ref%batch)%lead(ref%place, e)
            axes = reshape(skew_now(model, state, s), [3, 3])
            p = matmul(body_matrix(state, lead), transpose(reshape(model%axes0(lead, :), [3, 3])))
            then = matmul(p, reshape(model%skews%axes(s, :), [3, 3]))
            associate (o => now%joint(ref%batch)%ortho(ref%place))
               o = max(o, norm2(rotation_vector(matmul(transpose(then), axes))))
            end associate
         end associate
      end do
   end subroutine add_looseness

end module kj_consistent_snapshot
