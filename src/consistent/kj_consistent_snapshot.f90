!> Consistent state -> the arrays that sampling reads, all at time t.
module kj_consistent_snapshot
   use kj_kinds, only: wp
   use kj_math3, only: cross, rotation_vector
   use kj_skew, only: skew_axes
   use kj_legacy_state, only: legacy_state_t, OWNER_NONE, OWNER_JOINT
   use kj_joint_batch, only: joint_state_t, joint_batch_t
   use kj_joint_types, only: CHART_UNIVERSAL
   use kj_consistent_batch, only: consistent_joint_t, frame_of
   use kj_block, only: BLOCK, turn_frames
   use kj_consistent_chart, only: quaternion_frame
   use kj_consistent_matrix, only: joint_rates
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: spin_velocity
   use kj_consistent_conditions, only: body_matrix, held_force
   use kj_consistent_load, only: field_at
   use kj_consistent_step, only: place_node
   use kj_consistent_march, only: march_t
   implicit none
   private

   public :: publish

   integer, parameter :: NEXT(4) = [2, 3, 1, 2]   !! direction after 1, 2, 3, 4

contains

   !> Fill what a row of the history needs
   subroutine publish(model, march, cs, state)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(in) :: march
      type(consistent_state_t), intent(inout) :: cs
      type(legacy_state_t), intent(inout) :: state

      state%staggered = .false.
      state%cycle = cs%cycle
      state%time = cs%time
      state%h2 = cs%h
      if (cs%cycle == 0) state%h2 = min(march%limit, march%first)
      state%work = cs%work
      state%ledger_error = cs%error
      call spin_velocity(model, cs%poses%quat, cs%l, 1, model%n_lead, cs%poses%w)
      cs%poses%v = cs%v
      call publish_leads(model, cs, state)
      call publish_nodes(model, cs, state)
      call publish_joints(model, cs, state)
      call note_loosest(model, state)
      call publish_owner(model, march, state)
   end subroutine publish

   subroutine publish_owner(model, march, state)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(in) :: march
      type(legacy_state_t), intent(inout) :: state

      integer :: j

      state%owner_kind = OWNER_NONE
      state%owner = 0
      if (march%joint == 0) return
      do j = 1, model%n_element
         if (model%batch(model%joint(j)%batch)%first + model%joint(j)%place /= march%joint) cycle
         state%owner_kind = OWNER_JOINT
         state%owner = j
      end do
   end subroutine publish_owner

   subroutine publish_leads(model, cs, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: cs
      type(legacy_state_t), intent(inout) :: state

      integer :: from

      associate (n => model%n_lead)
         state%world%x(:n, :) = cs%poses%x
         state%world%w = cs%poses%w
         state%v(:n, :) = cs%v
         state%d(:n, :) = cs%poses%d
         state%f = cs%f - cs%own_f
         state%m = cs%t - cs%own_t
         state%f_own = cs%own_f
         state%m_own = cs%own_t
      end associate
      do from = 1, model%n_lead, BLOCK
         call publish_block(model, cs, from, min(BLOCK, model%n_lead - from + 1), state)
      end do
      state%impulse = cs%impulse
      state%angular_impulse = cs%angular_impulse
      state%rotation_sum = cs%turn
   end subroutine publish_leads

   !> Accelerations and principal axes of n leads from ...
   subroutine publish_block(model, cs, from, n, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: cs
      integer, intent(in) :: from, n
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: q(BLOCK, 4), p(BLOCK, 9), f(BLOCK, 3), t(BLOCK, 3), l(BLOCK, 3), held(3, 2)
      integer :: i, k, to

      to = from + n - 1
      q(:n, :) = cs%poses%quat(from:to, :)
      call quaternion_frame(n, q, p)
      f(:n, :) = cs%f(from:to, :)
      l(:n, :) = cs%l(from:to, :)
      associate (w => cs%poses%w(from:to, :))
         do k = 1, 3
            t(:n, k) = cs%t(from:to, k) - (w(:, NEXT(k))*l(:n, NEXT(k + 1)) - &
               w(:, NEXT(k + 1))*l(:n, NEXT(k)))
         end do
      end associate
      do i = 1, n
         if (model%hold_of(from + i - 1) == 0) cycle
         held(:, 1) = f(i, :)
         held(:, 2) = t(i, :)
         call held_force(model, cs, model%hold_of(from + i - 1), held(:, 1), held(:, 2))
         f(i, :) = held(:, 1)
         t(i, :) = held(:, 2)
      end do
      do k = 1, 3
         state%a(from:to, k) = model%inverse_mass(from:to)*f(:n, k)
         l(:n, k) = model%inverse_inertia(from:to, k)*(t(:n, 1)*p(:n, 3*k - 2) + t(:n, 2)*p(:n, &
            3*k - 1) + &
            t(:n, 3)*p(:n, 3*k))
      end do
      do k = 1, 3
         state%al(from:to, k) = p(:n, k)*l(:n, 1) + p(:n, k + 3)*l(:n, 2) + p(:n, k + 6)*l(:n, 3)
      end do
      call turn_axes(min(n, model%n_body - from + 1), p, model%axes0(from:, :), model%axes(from:, &
         :), &
         state%p(from:, :))
   end subroutine publish_block

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

   !> Secondary nodes of the history and of its skews from the poses
   subroutine publish_nodes(model, cs, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: cs
      type(legacy_state_t), intent(inout) :: state

      integer :: k, s, i

      do k = 1, size(model%th_node)
         call publish_node(model, cs, model%th_node(k), state)
         s = model%th_node_skew(k)
         if (s == 0) cycle
         if (model%skews%dir(s) == 0) cycle
         do i = 1, 3
            call publish_node(model, cs, model%skews%node(i, s), state)
         end do
         state%world%skew(s, :) = axes_now(model, state, s)
      end do
   end subroutine publish_nodes

   pure function axes_now(model, state, s) result(axes)
      type(consistent_model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: s
      real(wp) :: axes(9)

      associate (node => model%skews%node(:, s), x => state%world%x)
         axes = skew_axes(model%skews%dir(s), x(node(1), :), x(node(2), :), x(node(3), :))
      end associate
   end function axes_now

   subroutine publish_node(model, cs, node, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: cs
      integer, intent(in) :: node
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: r(3), r0(3)
      integer :: lead

      lead = model%lead(node)
      if (node == lead) return
      r = place_node(model, cs, node) - cs%poses%x(lead, :)
      r0 = model%x0(node, :) - model%x0(lead, :)
      state%world%x(node, :) = cs%poses%x(lead, :) + r
      state%d(node, :) = cs%poses%d(lead, :) + (r - r0)
      state%v(node, :) = cs%v(lead, :) + cross(cs%poses%w(lead, :), r)
   end subroutine publish_node

   subroutine publish_joints(model, cs, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: cs
      type(legacy_state_t), intent(inout) :: state

      integer :: b, j

      do b = 1, size(model%batch)
         associate (joint => cs%joint(b), out => state%joint(b))
            call publish_blocks(model%batch(b)%n, joint, out)
            if (model%batch(b)%limited) out%k_block = model%batch(b)%limit%k_block
            call joint_rates(model%batch(b), cs%poses, joint, out%qdot)
            if (model%batch(b)%geometry%chart == CHART_UNIVERSAL) then
               do j = 1, model%batch(b)%n
                  out%e(j, :) = frame_of(model%batch(b), joint, j)
               end do
            end if
            call show_in_mean_frame(model%batch(b)%geometry%plain, out%e, out%q, out%f, out%qdot)
            if (model%batch(b)%geometry%shifted) out%q(:, 4:6) = out%q(:, 4:6) + &
               model%batch(b)%angle0
            associate (ortho => state%ortho(model%batch(b)%first + 1:model%batch(b)%first + &
               model%batch(b)%n))
               ortho = 0.0_wp
               if (model%batch(b)%geometry%chart == CHART_UNIVERSAL) ortho = skewness(out%e)
            end associate
         end associate
      end do
      call add_looseness(model, cs, state)
   end subroutine publish_joints

   !> Coordinates, forces, energies, what limits do, and the axes of the translations, which are the
   !> frames of all but universal joints
   pure subroutine publish_blocks(n_joint, joint, out)
      integer, intent(in) :: n_joint
      type(consistent_joint_t), intent(in) :: joint
      type(joint_state_t), intent(inout) :: out

      integer :: at, from, to, n

      do at = 1, size(joint%block)
         from = (at - 1)*BLOCK + 1
         to = min(at*BLOCK, n_joint)
         n = to - from + 1
         associate (lanes => joint%block(at))
            out%q(from:to, :) = lanes%q(:n, :)
            out%f(from:to, :) = lanes%fe(:n, :) + lanes%fd(:n, :)
            out%energy(from:to) = lanes%elastic(:n) + lanes%dissipated(:n)
            out%e(from:to, :) = lanes%b%force(:n, :)
         end associate
         if (.not. allocated(joint%limit)) cycle
         associate (limit => joint%limit(at))
            out%f(from:to, :) = out%f(from:to, :) + limit%friction(:n, :)
            out%friction(from:to, :) = limit%friction(:n, :)
            out%slip_energy(from:to) = limit%slip_energy(:n)
            out%stored(from:to) = limit%stored(:n)
            out%locked(from:to) = limit%locked(:n) > 0.0_wp
            out%q_lock(from:to, :) = limit%q_lock(:n, :)
            out%flag(from:to, :) = nint(limit%flag(:n, :))
         end associate
      end do
   end subroutine publish_blocks

   !> Angle by which the second and third axis miss a right angle [rad]
   pure function skewness(e) result(angle)
      real(wp), intent(in) :: e(:, :)            !! (n, 9)
      real(wp) :: angle(size(e, 1))

      integer :: j

      do j = 1, size(angle)
         angle(j) = abs(asin(max(-1.0_wp, min(1.0_wp, dot_product(e(j, 4:6), e(j, 7:9))))))
      end do
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

   !> The largest loss of orthogonality of all samples, and whose it is
   subroutine note_loosest(model, state)
      type(consistent_model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: o
      integer :: j

      do j = 1, model%n_joint
         associate (ref => model%joint(j))
            o = state%ortho(model%batch(ref%batch)%first + ref%place)
         end associate
         if (.not. o > state%ortho_worst) cycle
         state%ortho_worst = o
         state%ortho_joint = j
      end do
   end subroutine note_loosest

   !> Turn of a loose skew away from the triad that its joint end carries
   subroutine add_looseness(model, cs, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: cs
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: now(3, 3), then(3, 3), p(3, 3)
      integer :: k, i, j, s, lead

      do k = 1, size(model%loose, 2)
         j = model%loose(1, k)
         associate (ref => model%joint(j))
            s = model%batch(ref%batch)%skew(ref%place, model%loose(2, k))
            lead = model%batch(ref%batch)%lead(ref%place, model%loose(2, k))
            do i = 1, 3
               call publish_node(model, cs, model%skews%node(i, s), state)
            end do
            now = reshape(axes_now(model, state, s), [3, 3])
            p = matmul(body_matrix(cs, lead), transpose(reshape(model%axes0(lead, :), [3, 3])))
            then = matmul(p, reshape(model%skews%axes(s, :), [3, 3]))
            associate (o => state%ortho(model%batch(ref%batch)%first + ref%place))
               o = max(o, norm2(rotation_vector(matmul(transpose(then), now))))
            end associate
         end associate
      end do
   end subroutine add_looseness

end module kj_consistent_snapshot
