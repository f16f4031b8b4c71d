!> Concentrated loads and gravity under the consistent formulation, their work and their power.
!> Source: docs/theory/consistent.md 8.
module kj_consistent_load
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_curve, only: load_value
   use kj_model, only: load_t, BY_TIME, BY_DISPLACEMENT
   use kj_skew, only: axis_of
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_gravity, only: add_weights, add_powers
   implicit none
   private

   public :: add_loads, find_gravity, add_gravity, count_gravity, load_power, field_at, &
      add_host_loads

contains

   !> Concentrated loads at t, and their work over the step: mean force times displacement
   subroutine add_loads(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

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
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
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

   !> Acceleration of each card of gravity in the pose reached, and its mean over the step; one that
   !> is constant is found at the start
   pure subroutine find_gravity(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: g(3)
      integer :: i

      do i = 1, size(model%gravity)
         if (model%steady(i) .and. state%cycle > 0) cycle
         g = field_at(model, state, model%gravity(i))
         state%field(i)%mean = 0.5_wp*(g + state%field(i)%now)
         state%field(i)%now = g
      end do
   end subroutine find_gravity

   !> Gravity as a force on the leads lo..hi; lo is the first lead of a block of kj_gravity
   pure subroutine add_gravity(model, lo, hi, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%gravity)
         call add_weights(lo, hi, model%n_lead, model%mass, state%field(i), state%f, state%own_f)
         if (model%steady(i) .or. .not. state%by_steps) cycle
         call add_powers(lo, hi, model%n_lead, model%n_lead, model%mass, state%v, state%field(i))
      end do
   end subroutine add_gravity

   !> The work over the step of gravity that changes counts as external
   pure subroutine count_gravity(model, h, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      if (.not. state%by_steps) return
      do i = 1, size(model%steady)
         if (.not. model%steady(i)) state%work = state%work + h*sum(state%field(i)%power)
      end do
   end subroutine count_gravity

   !> Power of concentrated loads and of a changing field, with the velocities of the poses
   real(wp) function load_power(model, state) result(power)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

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
         if (model%steady(i)) cycle
         do k = 1, size(model%gravity(i)%node)
            lead = model%gravity(i)%node(k)
            power = power + model%mass(lead)*dot_product(state%field(i)%now, state%poses%v(lead, :))
         end do
      end do
   end function load_power

   !> Acceleration of a gravity card now, W; zero while its sensor is silent
   pure function field_at(model, state, load) result(g)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
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

   ! ---- Forces that an embedding host adds to the bodies of a consistent scene.

   !> Forces and moments of an embedding host, W; work: mean force times displacement
   subroutine add_host_loads(h, state)
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      if (.not. allocated(state%f_host)) return
      state%f = state%f + state%f_host
      state%t = state%t + state%t_host
      state%own_f = state%own_f + state%f_host
      state%own_t = state%own_t + state%t_host
      if (state%by_steps) state%work = state%work + &
         0.5_wp*(h*sum((state%f_host + state%f_host_old)*state%v) + &
         sum((state%t_host + state%t_host_old)*state%poses%psi))
      state%f_host_old = state%f_host
      state%t_host_old = state%t_host
   end subroutine add_host_loads

end module kj_consistent_load
