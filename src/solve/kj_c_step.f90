!> One step of the consistent formulation: kick, drift, kick (split2 and liemid), and the forces.
!> Source: consistent.md 1; accuracy.md, integrators.
module kj_c_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_curve, only: load_value
   use kj_model, only: model_t, load_t, BY_TIME, BY_DISPLACEMENT
   use kj_skew, only: axis_of, move_skews
   use kj_assembly, only: lead_map_t
   use kj_c_force, only: add_springs
   use kj_c_damper, only: add_dampers, count_damping
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_midpoint, only: midpoint_drift
   use kj_c_host, only: add_host_loads, look_ahead
   use kj_c_body, only: kick, drift, spin_velocity, inverse_inertias
   use kj_c_hold, only: project, project_rates, hold_rotations, motion_targets, FIRST_HALF, &
      SECOND_HALF
   implicit none
   private

   public :: c_step, find_forces, place_node, field_at, load_power, keep_rates, reach_motions

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
      call count_impulses(model, h, state)
      call motion_targets(model, state, h, mean, final, active)
      call keep_rates(c, state, before)
      call kick(c, state, h, 1, model%n_lead)
      call project(model, c, state, mean, active, FIRST_HALF, before)
      call spin_velocity(c, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      state%poses%psi = 0.5_wp*h*state%poses%w
      state%poses%v = state%v
      do i = 1, size(c%batch)
         if (c%batch(i)%damped) call count_damping(c%batch(i), state%poses, h, 1, c%batch(i)%n, &
            state%joint(i))
      end do
      do i = 1, size(c%hold)
         old(:, i) = state%poses%quat(c%hold(i)%lead, :)
         w(:, i) = state%poses%w(c%hold(i)%lead, :)
      end do
      if (midpoint) then
         call midpoint_drift(c, state, h, 1, model%n_lead)
      else
         call drift(c, state, h, 1, model%n_lead)
      end if
      call hold_rotations(c, state, h, mean, active, old, w)
      state%cycle = state%cycle + 1
      state%time = state%time + h
      call reach_motions(model, h, mean, final, active, state)
      call find_forces(model, c, h, final, active, state)
      call count_impulses(model, h, state)
      call keep_rates(c, state, before)
      call kick(c, state, h, 1, model%n_lead)
      call project(model, c, state, final, active, SECOND_HALF, before)
      state%turn = state%turn + state%poses%psi(:model%n_body, :)
   end subroutine c_step

   !> Half a step of the impulses of joints and of loads on secondary nodes
   subroutine count_impulses(model, h, state)
      type(model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      associate (n => model%n_body)
         state%impulse = state%impulse + 0.5_wp*h*(state%f(:n, :) - state%own_f(:n, :))
         state%angular_impulse = state%angular_impulse + &
            0.5_wp*h*(state%t(:n, :) - state%own_t(:n, :))
      end associate
   end subroutine count_impulses

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

      integer :: b

      call spin_velocity(c, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      state%poses%psi = state%poses%psi + 0.5_wp*h*state%poses%w
      call place_nodes(model, c, state)
      state%poses%time = state%time
      state%poses%h = h
      do b = 1, size(c%batch)
         call add_springs(c%batch(b), model%curves, state%poses, 1, c%batch(b)%n, state%joint(b), &
            state%wrench)
      end do
      state%f = 0.0_wp
      state%t = 0.0_wp
      call gather(model%map, state%wrench, 1, model%n_lead, state%f, state%t)
      state%own_f = 0.0_wp
      state%own_t = 0.0_wp
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

      integer :: b, k

      do k = 1, 3
         state%poses%v(:, k) = state%v(:, k) + 0.5_wp*h*c%im*state%f(:, k)
      end do
      call spin_velocity(c, state%poses%quat, state%l + 0.5_wp*h*state%t, 1, model%n_lead, &
         state%poses%w)
      call look_ahead(c, h, state)
      call inverse_inertias(c, state%poses%quat, 1, model%n_lead, state%poses%ij)
      call project_rates(c, state, target, active)
      do b = 1, size(c%batch)
         call add_dampers(c%batch(b), model%curves, state%poses, h, 1, c%batch(b)%n, &
            state%joint(b), &
            state%wrench)
      end do
      call gather(model%map, state%wrench, 1, model%n_lead, state%f, state%t)
   end subroutine damp

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

   !> Concentrated loads at t, and their work over the step: mean force times displacement
   subroutine add_loads(model, state)
      type(model_t), intent(in) :: model
      type(c_state_t), intent(inout) :: state

      real(wp) :: force(3), x(3), arm(3)
      integer :: i, k, entry, node, lead

      entry = 0
      do i = 1, size(model%cload)
         do k = 1, size(model%cload(i)%node)
            entry = entry + 1
            node = model%cload(i)%node(k)
            lead = model%lead(node)
            x = state%node(node, :)
            if (node == lead) x = state%poses%x(lead, :)
            arm = x - state%poses%x(lead, :)
            force = load_vector(model, state, model%cload(i), lead, arm)
            if (node == lead) then
               if (model%cload(i)%dir <= 3) state%own_f(lead, :) = state%own_f(lead, :) + force
               if (model%cload(i)%dir > 3) state%own_t(lead, :) = state%own_t(lead, :) + force
            end if
            if (model%cload(i)%dir <= 3) then
               state%f(lead, :) = state%f(lead, :) + force
               state%t(lead, :) = state%t(lead, :) + cross(arm, force)
               if (state%by_steps .and. state%cycle > 0) state%work = state%work + 0.5_wp* &
                  dot_product(force + state%load_force(:, entry), x - state%load_place(:, entry))
            else
               state%t(lead, :) = state%t(lead, :) + force
               if (state%by_steps .and. state%cycle > 0) state%work = state%work + 0.5_wp* &
                  dot_product(force + state%load_force(:, entry), state%poses%psi(lead, :))
            end if
            state%load_force(:, entry) = force
            state%load_place(:, entry) = x
         end do
      end do
   end subroutine add_loads

   !> Force or moment of a load on a node at `arm` from its lead
   pure function load_vector(model, state, load, lead, arm) result(force)
      type(model_t), intent(in) :: model
      type(c_state_t), intent(in) :: state
      type(load_t), intent(in) :: load
      integer, intent(in) :: lead
      real(wp), intent(in) :: arm(3)
      real(wp) :: force(3)

      real(wp) :: axis(3), x

      axis = axis_of(state%skew, load%skew, load%dir)
      x = state%time
      if (load%sensed) x = x - load%t_start
      force = 0.0_wp
      if (x < 0.0_wp .or. state%time > load%t_stop) return
      if (load%abscissa == BY_DISPLACEMENT) then
         x = dot_product(state%poses%d(lead, :), axis)
      else if (load%abscissa /= BY_TIME) then
         x = dot_product(state%v(lead, :) + cross(state%poses%w(lead, :), arm), axis)
         if (load%dir > 3) x = dot_product(state%poses%w(lead, :), axis)
      end if
      force = load%y_scale*load_value(model%curves, load%curve, x/load%x_scale)*axis
   end function load_vector

   !> Gravity as a force on its leads; the work of a field that changes counts as external
   subroutine add_field(model, c, h, state)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      real(wp) :: g(3)
      integer :: i, k, lead

      do i = 1, size(model%gravity)
         g = field_at(model, state, model%gravity(i))
         do k = 1, size(model%gravity(i)%node)
            lead = model%gravity(i)%node(k)
            state%f(lead, :) = state%f(lead, :) + model%mass(lead)*g
            state%own_f(lead, :) = state%own_f(lead, :) + model%mass(lead)*g
            if (c%steady(i) .or. .not. state%by_steps) cycle
            state%work = state%work + 0.5_wp*model%mass(lead)* &
               dot_product(g + state%field(:, i), h*state%v(lead, :))
         end do
         state%field(:, i) = g
      end do
   end subroutine add_field

   !> Power of concentrated loads and of a changing field, with the velocities of the poses
   real(wp) function load_power(model, c, state) result(power)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state

      integer :: i, k, entry, lead

      power = 0.0_wp
      entry = 0
      do i = 1, size(model%cload)
         do k = 1, size(model%cload(i)%node)
            entry = entry + 1
            lead = model%lead(model%cload(i)%node(k))
            associate (f => state%load_force(:, entry), w => state%poses%w(lead, :))
               if (model%cload(i)%dir > 3) then
                  power = power + dot_product(f, w)
               else
                  power = power + dot_product(f, state%poses%v(lead, :) + &
                     cross(w, state%load_place(:, entry) - state%poses%x(lead, :)))
               end if
            end associate
         end do
      end do
      if (allocated(state%f_host)) power = power + sum(state%f_host*state%poses%v) + &
         sum(state%t_host*state%poses%w)
      do i = 1, size(model%gravity)
         if (c%steady(i)) cycle
         do k = 1, size(model%gravity(i)%node)
            lead = model%gravity(i)%node(k)
            power = power + model%mass(lead)*dot_product(state%field(:, i), state%poses%v(lead, :))
         end do
      end do
   end function load_power

   !> Acceleration of a gravity card now, W; zero while its sensor is silent
   pure function field_at(model, state, load) result(g)
      type(model_t), intent(in) :: model
      type(c_state_t), intent(in) :: state
      type(load_t), intent(in) :: load
      real(wp) :: g(3)

      real(wp) :: t

      t = state%time
      if (load%sensed) t = t - load%t_start
      g = 0.0_wp
      if (t < 0.0_wp .or. state%time > load%t_stop) return
      g = load%y_scale*load_value(model%curves, load%curve, t/load%x_scale)* &
         axis_of(state%skew, load%skew, load%dir)
   end function field_at

end module kj_c_step
