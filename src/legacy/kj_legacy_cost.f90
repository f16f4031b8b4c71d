!> What the defects of the legacy scheme cost a run: the energy that a spin half a step old brings,
!> the drift of secondary nodes, rotations that are summed. Nothing here changes a run.
!> Source: docs/theory/legacy.md 10.1.
module kj_legacy_cost
   use kj_kinds, only: wp
   use kj_math3, only: rotation, rotation_vector
   use kj_joint_types, only: joint_types, CHART_VECTOR, FRAME_MEAN, FRAME_FIRST, FRAME_SECOND
   use kj_joint_batch, only: joint_batch_t, LAW_SPRING, LAW_SPRING_CURVE
   use kj_block, only: block_of, lane_of
   use kj_model, only: model_t
   use kj_legacy_state, only: legacy_state_t
   implicit none
   private

   public :: weigh_spins, weigh_rotations, spin_cost, node_drift

   ! Looks at the spins cost next to nothing: each of the first cycles of a small scene has one, as
   ! its run may be short; later on, and in large scenes, they are rare.
   integer, parameter :: EACH = 500, FEW = 16    !! cycles, bodies
   integer, parameter :: EVERY = 32              !! cycles, and one more for each FEW bodies

contains

   !> The power of the gyroscopic moment -w x J w is 0. The scheme takes w of half a step before, so
   !> that it is w(t) . (-w' x J w'), which is summed over time. Its part of the energy of rotation
   !> is twice the relative error of the spin, and that times the angle turned one of attitude.
   subroutine weigh_spins(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: p(3, 3), w(3), now(3), j(3), dt, energy
      integer :: b

      if (mod(state%cycle, EVERY + model%n_body/FEW) /= 0 .and. &
         (state%cycle > EACH .or. model%n_body > FEW)) return
      dt = state%time - state%weighed
      state%weighed = state%time
      do b = 1, model%n_body
         p = reshape(state%p(b, :), [3, 3])
         w = matmul(state%world%w(b, :), p)
         now = w + 0.5_wp*state%h1*matmul(state%al(b, :), p)
         j = state%principal(b, :)
         energy = 0.5_wp*sum(j*now**2)
         if (.not. energy > 0.0_wp) cycle
         state%spin_gain(b) = state%spin_gain(b) + dt*( &
            now(1)*(j(2) - j(3))*w(2)*w(3) + now(2)*(j(3) - j(1))*w(3)*w(1) + &
            now(3)*(j(1) - j(2))*w(1)*w(2))
         state%spin_top(b) = max(state%spin_top(b), energy)
         state%spin_angle(b) = state%spin_angle(b) + dt*norm2(now)* &
            0.5_wp*abs(state%spin_gain(b))/state%spin_top(b)
      end do
   end subroutine weigh_spins

   !> The body that has lost or won most by it: part of its energy of rotation, error of attitude
   pure subroutine spin_cost(state, body, gain, angle)
      type(legacy_state_t), intent(in) :: state
      integer, intent(out) :: body               !! index, 0 = none
      real(wp), intent(out) :: gain              !! fraction
      real(wp), intent(out) :: angle             !! [rad]

      body = 0
      gain = 0.0_wp
      angle = 0.0_wp
      if (size(state%spin_gain) == 0) return
      body = maxloc(state%spin_angle, dim=1)
      if (state%spin_top(body) > 0.0_wp) gain = state%spin_gain(body)/state%spin_top(body)
      angle = state%spin_angle(body)
   end subroutine spin_cost

   !> The node whose distance from the main node of its body has changed most, as a fraction
   pure subroutine node_drift(model, state, node, drift)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(out) :: node               !! index, 0 = none
      real(wp), intent(out) :: drift             !! > 0: outward

      real(wp) :: before, change
      integer :: b, k

      node = 0
      drift = 0.0_wp
      do b = 1, model%n_body
         do k = state%crew%first(b), state%crew%first(b + 1) - 1
            associate (i => state%crew%node(k), x => state%world%x)
               before = norm2(model%x0(i, :) - model%x0(b, :))
               if (.not. before > 0.0_wp) cycle
               change = norm2(x(i, :) - x(b, :))/before - 1.0_wp
               if (.not. abs(change) > abs(drift)) cycle
               node = i
               drift = change
            end associate
         end do
      end do
   end subroutine node_drift

   !> Joints and springs with three free rotations that a law reads: their sums of relative angular
   !> velocity against the rotation between the bodies
   subroutine weigh_rotations(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: off
      integer :: b, i

      do b = 1, size(model%batch)
         if (.not. reads_sums(model%batch(b))) cycle
         do i = 1, model%batch(b)%n
            if (any(model%batch(b)%lead(i, :) > model%n_body)) cycle
            associate (lane => lane_of(i), block => state%joint(b)%block(block_of(i)))
               off = rotation_error(model, model%batch(b), i, state%p, block%q(lane, 4:6))
            end associate
            if (.not. off > state%summed_error) cycle
            state%summed_error = off
            state%summed_joint = model%batch(b)%first + i
         end do
      end do
   end subroutine weigh_rotations

   !> The elements of a batch sum three free rotations, and a law hangs on one of them
   pure logical function reads_sums(batch)
      type(joint_batch_t), intent(in) :: batch

      reads_sums = .false.
      if (joint_types(batch%row)%chart /= CHART_VECTOR) return
      if (all([FRAME_MEAN, FRAME_FIRST, FRAME_SECOND] /= batch%frame)) return
      reads_sums = any(iand(batch%law(4:6), LAW_SPRING + LAW_SPRING_CURVE) /= 0)
      if (batch%limited) reads_sums = .true.
   end function reads_sums

   !> How far the sums are from the rotation vector of body 2 against body 1, the nearest of those
   !> that whole turns apart are the same [rad]
   pure real(wp) function rotation_error(model, batch, i, p, q) result(off)
      type(model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp), intent(in) :: p(:, :)            !! (n_body, 9) axes of the bodies now
      real(wp), intent(in) :: q(3)               !! sums, joint frame

      real(wp), parameter :: TURN = 2.0_wp*acos(-1.0_wp)
      real(wp), dimension(3, 3) :: one, two, e, start
      real(wp) :: phi(3), axis(3), angle

      call turn_since_start(model, p, batch%lead(i, 1), one)
      call turn_since_start(model, p, batch%lead(i, 2), two)
      e = reshape(batch%frame0(i, :), [3, 3])
      start = rotation(0.5_wp*batch%angle0(i, :))
      phi = rotation_vector(matmul(matmul(start, matmul(transpose(matmul(one, e)), &
         matmul(two, e))), start))
      angle = norm2(phi)
      axis = phi/max(angle, tiny(1.0_wp))
      if (angle < 1.0e-9_wp) axis = q/max(norm2(q), tiny(1.0_wp))
      off = norm2(phi + TURN*anint((dot_product(q, axis) - angle)/TURN)*axis - q)
   end function rotation_error

   !> Rotation of a body since the start, W
   pure subroutine turn_since_start(model, p, body, r)
      type(model_t), intent(in) :: model
      real(wp), intent(in) :: p(:, :)
      integer, intent(in) :: body
      real(wp), intent(out) :: r(3, 3)

      r = matmul(reshape(p(body, :), [3, 3]), transpose(reshape(model%axes(body, :), [3, 3])))
   end subroutine turn_since_start

end module kj_legacy_cost
