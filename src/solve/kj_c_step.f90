!> One step of the consistent formulation: kick, drift, kick (split2 and liemid), and the forces.
!> Source: consistent.md 1; accuracy.md, integrators.
module kj_c_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_model, only: model_t
   use kj_skew, only: move_skews
   use kj_assembly, only: lead_map_t
   use kj_c_force, only: add_springs
   use kj_c_damper, only: add_dampers
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_load, only: add_loads, add_field
   use kj_c_midpoint, only: midpoint_drift
   use kj_c_host, only: add_host_loads, look_ahead
   use kj_c_body, only: kick, drift, predict, spin_velocity, inverse_inertias
   use kj_c_hold, only: project, project_rates, hold_rotations, motion_targets, FIRST_HALF, &
      SECOND_HALF
   implicit none
   private

   public :: c_step, find_forces, place_node, keep_rates, reach_motions

contains

   !> From t to t + h by kick, drift, kick
   subroutine c_step(model, c, midpoint, h, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      real(wp) :: mean(size(model%motion)), final(size(model%motion)), before(6, size(c%hold))
      real(wp) :: old(4, size(c%hold)), w(3, size(c%hold))
      logical :: active(size(model%motion))
      integer :: i

      state%h = h
      call motion_targets(model, state, h, mean, final, active)
      call keep_rates(c, state, before)
      call kick_all(model, c, h, state)
      call project(model, c, state, mean, active, FIRST_HALF, before)
      call turn_half(c, h, state)
      do i = 1, size(c%hold)
         old(:, i) = state%poses%quat(c%hold(i)%lead, :)
         w(:, i) = state%poses%w(c%hold(i)%lead, :)
      end do
      call drift_all(c, midpoint, h, state)
      call hold_rotations(c, state, h, mean, active, old, w)
      state%cycle = state%cycle + 1
      state%time = state%time + h
      call reach_motions(model, h, mean, final, active, state)
      call find_forces(model, c, h, final, active, state)
      call keep_rates(c, state, before)
      call kick_all(model, c, h, state)
      call project(model, c, state, final, active, SECOND_HALF, before)
      state%turn = state%turn + state%poses%psi(:model%n_body, :)
   end subroutine c_step

   !> Half a kick of all leads, and half a step of the impulses of joints and of loads on secondary
   !> nodes
   subroutine kick_all(model, c, h, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      integer :: piece, i, k

      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1) &
      !$omp private(i, k)
      do piece = 1, size(c%team%lead, 2)
         do k = 1, 3
            do i = c%team%lead(1, piece), min(c%team%lead(2, piece), model%n_body)
               state%impulse(i, k) = state%impulse(i, k) + &
                  0.5_wp*h*(state%f(i, k) - state%own_f(i, k))
               state%angular_impulse(i, k) = state%angular_impulse(i, k) + &
                  0.5_wp*h*(state%t(i, k) - state%own_t(i, k))
            end do
         end do
         call kick(c, state, h, c%team%lead(1, piece), c%team%lead(2, piece))
      end do
   end subroutine kick_all

   !> Angular velocities after the first half kick, and half of the turn that goes with them
   subroutine turn_half(c, h, state)
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      integer :: piece, i, k

      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1) &
      !$omp private(i, k)
      do piece = 1, size(c%team%lead, 2)
         call spin_velocity(c, state%poses%quat, state%l, c%team%lead(1, piece), &
            c%team%lead(2, piece), state%poses%w)
         do k = 1, 3
            do i = c%team%lead(1, piece), c%team%lead(2, piece)
               state%poses%psi(i, k) = 0.5_wp*h*state%poses%w(i, k)
               state%poses%w_left(i, k) = state%poses%w(i, k)
               state%poses%v(i, k) = state%v(i, k)
            end do
         end do
      end do
   end subroutine turn_half

   subroutine drift_all(c, midpoint, h, state)
      type(c_model_t), intent(in) :: c
      logical, intent(in) :: midpoint                !! liemid instead of split2
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      integer :: piece

      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1)
      do piece = 1, size(c%team%lead, 2)
         if (midpoint) then
            call midpoint_drift(c, state, h, c%team%lead(1, piece), c%team%lead(2, piece))
         else
            call drift(c, state, h, c%team%lead(1, piece), c%team%lead(2, piece))
         end if
      end do
   end subroutine drift_all

   !> Velocities of the held leads
   subroutine keep_rates(c, state, rates)
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(inout) :: state
      real(wp), intent(out) :: rates(:, :)           !! (6, n_hold)

      integer :: i, lead

      do i = 1, size(c%hold)
         lead = c%hold(i)%lead
         call spin_velocity(c, state%poses%quat, state%l, lead, lead, state%poses%w)
         rates(:, i) = [state%v(lead, :), state%poses%w(lead, :)]
      end do
   end subroutine keep_rates

   !> What imposed displacements and accelerations have reached
   subroutine reach_motions(model, h, mean, final, active, state)
      type(model_t), intent(in) :: model
      real(wp), intent(in) :: h, mean(:), final(:)
      logical, intent(in) :: active(:)
      type(c_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%motion)
         if (.not. active(i)) cycle
         if (model%motion(i)%kind == 2) then
            state%motion_at(i) = state%motion_at(i) + h*mean(i)
         else
            state%motion_at(i) = final(i)
         end if
      end do
   end subroutine reach_motions

   !> Forces and moments of all leads in the pose reached. h = 0: at the start, dampers from the
   !> velocities as they are.
   subroutine find_forces(model, c, h, target, active, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h
      real(wp), intent(in) :: target(:)              !! (n_motion) velocities at the end of the step
      logical, intent(in) :: active(:)
      type(c_state_t), intent(inout) :: state

      integer :: piece, b, i, k

      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1) &
      !$omp private(i, k)
      do piece = 1, size(c%team%lead, 2)
         call spin_velocity(c, state%poses%quat, state%l, c%team%lead(1, piece), &
            c%team%lead(2, piece), state%poses%w)
         do k = 1, 3
            do i = c%team%lead(1, piece), c%team%lead(2, piece)
               state%poses%psi(i, k) = state%poses%psi(i, k) + 0.5_wp*h*state%poses%w(i, k)
               state%f(i, k) = 0.0_wp
               state%t(i, k) = 0.0_wp
               state%own_f(i, k) = 0.0_wp
               state%own_t(i, k) = 0.0_wp
            end do
         end do
      end do
      call place_nodes(model, c, state)
      state%poses%time = state%time
      state%poses%h = h
      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1) &
      !$omp private(b)
      do piece = 1, size(c%team%joint, 2)
         b = c%team%joint(1, piece)
         call add_springs(c%batch(b), model%curves, state%poses, c%team%joint(2, piece), &
            c%team%joint(3, piece), state%joint(b), state%wrench)
      end do
      call gather_all(model, c, state)
      call add_loads(model, state)
      call add_field(model, c, h, state)
      call add_host_loads(h, state)
      if (c%damped) call damp(model, c, h, target, active, state)
   end subroutine find_forces

   !> Damping forces: predicted velocities, pass 2 of the joints
   subroutine damp(model, c, h, target, active, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h, target(:)
      logical, intent(in) :: active(:)
      type(c_state_t), intent(inout) :: state

      integer :: piece, b

      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1)
      do piece = 1, size(c%team%lead, 2)
         call predict(c, h, c%team%lead(1, piece), c%team%lead(2, piece), state)
         call inverse_inertias(c, state%poses%quat, c%team%lead(1, piece), &
            c%team%lead(2, piece), state%poses%ij)
      end do
      call look_ahead(c, h, state)
      call project_rates(c, state, target, active)
      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1) &
      !$omp private(b)
      do piece = 1, size(c%team%joint, 2)
         b = c%team%joint(1, piece)
         call add_dampers(c%batch(b), model%curves, state%poses, h, c%team%joint(2, piece), &
            c%team%joint(3, piece), state%joint(b), state%wrench)
      end do
      call gather_all(model, c, state)
   end subroutine damp

   subroutine gather_all(model, c, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(inout) :: state

      integer :: piece

      !$omp parallel do schedule(static) num_threads(c%team%threads) if(c%team%threads > 1)
      do piece = 1, size(c%team%lead, 2)
         call gather(model%map, state%wrench, c%team%lead(1, piece), c%team%lead(2, piece), &
            state%f, state%t)
      end do
   end subroutine gather_all

   !> Add the wrenches of the joints to their leads, ascending joint by lead
   pure subroutine gather(map, wrench, lo, hi, f, t)
      type(lead_map_t), intent(in) :: map
      real(wp), contiguous, intent(in) :: wrench(:, :)
      integer, intent(in) :: lo, hi
      real(wp), contiguous, intent(inout) :: f(:, :), t(:, :)

      real(wp) :: force(3), moment(3)
      integer :: lead, i, j

      do lead = lo, hi
         force = 0.0_wp
         moment = 0.0_wp
         do i = map%first(lead), map%first(lead + 1) - 1
            j = map%joint(i)
            if (j > 0) then
               force = force + wrench(1:3, j)
               moment = moment + wrench(4:6, j)
            else
               force = force - wrench(1:3, -j)
               moment = moment + wrench(7:9, -j)
            end if
         end do
         f(lead, :) = f(lead, :) + force
         t(lead, :) = t(lead, :) + moment
      end do
   end subroutine gather

   !> Positions of the nodes that loads and skews read, and the skews
   subroutine place_nodes(model, c, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(inout) :: state

      integer :: i

      if (size(c%placed) == 0) return
      do i = 1, size(c%placed)
         state%node(c%placed(i), :) = place_node(model, c, state, c%placed(i))
      end do
      call move_skews(model%skews, state%node, state%skew)
   end subroutine place_nodes

   !> Position of a node from the pose of its lead
   pure function place_node(model, c, state, node) result(x)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      integer, intent(in) :: node
      real(wp) :: x(3)

      real(wp) :: a(3), t(3)
      integer :: lead

      lead = model%lead(node)
      a = c%arm(node, :)
      t = 2.0_wp*cross(state%poses%quat(lead, 2:4), a)
      x = state%poses%x(lead, :) + a + state%poses%quat(lead, 1)*t + &
         cross(state%poses%quat(lead, 2:4), t)
   end function place_node

end module kj_c_step
