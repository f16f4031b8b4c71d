!> Loads, gravity, boundary conditions and imposed motion of one legacy cycle.
!> Source: docs/theory/legacy.md 6, 8.2.
module kj_legacy_load
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_curve, only: load_value
   use kj_model, only: model_t, bcs_t, load_t, motion_t, BY_TIME, BY_DISPLACEMENT, BY_VELOCITY, &
      IMPOSE_VELOCITY, IMPOSE_DISPLACEMENT
   use kj_legacy_state, only: legacy_state_t
   use kj_skew, only: axis_of
   use kj_sensor, only: is_on
   implicit none
   private

   public :: is_loaded, add_cloads, turn_loads, find_gravity, gravity_at, hold_conditions, &
      impose_motion

contains

   !> Forces or moments may act on leads themselves; f_own and m_own are 0 otherwise
   pure logical function is_loaded(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state

      is_loaded = size(model%cload) > 0 .or. allocated(state%f_host)
   end function is_loaded

   !> Add concentrated loads to the leads; loads on secondary nodes join the sums of their body.
   !>
   !> The work of a step counts with the mean of the values now and a step ago: before the first
   !> active cycle the function is continued to negative times.
   !> Legacy quirk: consecutive cards with the same curve and time share both values, whatever their
   !> abscissa scales; with a displacement or velocity abscissa the curve alone decides.
   subroutine add_cloads(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: t, y, y_old, last_t, value, z, axis(3)
      integer :: i, k, at, node, last_curve

      state%power = 0.0_wp
      last_curve = -1
      last_t = 0.0_wp
      y = 0.0_wp
      y_old = 0.0_wp
      at = 0
      do i = 1, size(model%cload)
         associate (load => model%cload(i))
            t = state%time - load%t_start
            if (load%abscissa == BY_TIME .and. acts(state, load) .and. &
               (load%curve /= last_curve .or. abs(t - last_t) > 0.0_wp)) then
               y = load_value(model%curves, load%curve, t/load%x_scale)
               y_old = load_value(model%curves, load%curve, (t - state%h1)/load%x_scale)
            end if
            do k = 1, size(load%node)
               node = load%node(k)
               at = at + 1
               z = abscissa_of(model, state, load, node, at)
               if (acts(state, load)) then
                  axis = axis_of(state%world%skew, load%skew, load%dir)
                  if (load%abscissa /= BY_TIME .and. load%curve /= last_curve) then
                     y = load_value(model%curves, load%curve, z/load%x_scale)
                     y_old = load_value(model%curves, load%curve, &
                        state%load_abscissa(at)/load%x_scale)
                  end if
                  last_curve = load%curve
                  last_t = t
                  value = load%y_scale*y
                  call add_load(model, state, load%dir, node, value*axis)
                  state%power = state%power + 0.5_wp*load%y_scale*(y_old + y)* &
                     rate_along(model, state, load, node, axis)
               end if
               state%load_abscissa(at) = z
            end do
         end associate
      end do
   end subroutine add_cloads

   !> A card of load or gravity acts in this cycle
   pure logical function acts(state, load)
      type(legacy_state_t), intent(in) :: state
      type(load_t), intent(in) :: load

      acts = is_on(state%time, state%h1, load%t_start, load%t_stop)
   end function acts

   !> Velocity or angular velocity of a loaded dof
   pure real(wp) function rate_along(model, state, load, node, axis) result(rate)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(load_t), intent(in) :: load
      integer, intent(in) :: node
      real(wp), intent(in) :: axis(3)

      if (load%dir <= 3) then
         rate = dot_product(state%v(node, :), axis)
      else
         rate = dot_product(state%world%w(model%lead(node), :), axis)
      end if
   end function rate_along

   !> Displacement or velocity that a load depends on: a component in global axes, also of a load
   !> in a skew; rotations are 0 in a model that does not keep them. Time needs none.
   pure real(wp) function abscissa_of(model, state, load, node, at) result(z)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(load_t), intent(in) :: load
      integer, intent(in) :: node, at            !! and its place among those of all loads

      z = 0.0_wp
      select case (load%abscissa)
      case (BY_DISPLACEMENT)
         if (load%dir <= 3) then
            z = state%d(node, load%dir)
         else if (any(model%motion%dir > 3)) then
            z = state%load_turn(at)
         end if
      case (BY_VELOCITY)
         if (load%dir <= 3) then
            z = state%v(node, load%dir)
         else
            z = state%world%w(model%lead(node), load%dir - 3)
         end if
      end select
   end function abscissa_of

   !> Count the turns of nodes of loads, after the motion of a step
   pure subroutine turn_loads(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      integer :: i, k, at

      at = 0
      do i = 1, size(model%cload)
         do k = 1, size(model%cload(i)%node)
            at = at + 1
            if (model%cload(i)%dir <= 3) cycle
            state%load_turn(at) = state%load_turn(at) + state%h2* &
               state%world%w(model%lead(model%cload(i)%node(k)), model%cload(i)%dir - 3)
         end do
      end do
   end subroutine turn_loads

   pure subroutine add_load(model, state, dir, node, vector)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: dir, node
      real(wp), intent(in) :: vector(3)

      integer :: lead

      lead = model%lead(node)
      if (node == lead) then
         if (dir <= 3) then
            state%f_own(lead, :) = state%f_own(lead, :) + vector
         else
            state%m_own(lead, :) = state%m_own(lead, :) + vector
         end if
      else if (dir <= 3) then
         state%f(lead, :) = state%f(lead, :) + vector
         state%m(lead, :) = state%m(lead, :) + &
            cross(state%world%x(node, :) - state%world%x(lead, :), vector)
      else
         state%m(lead, :) = state%m(lead, :) + vector
      end if
   end subroutine add_load

   !> Acceleration of a gravity card, W, with its function at time t; 0 where it does not act now
   pure function gravity_at(model, state, load, t) result(g)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(load_t), intent(in) :: load
      real(wp), intent(in) :: t
      real(wp) :: g(3)

      g = 0.0_wp
      if (.not. acts(state, load)) return
      g = load%y_scale*load_value(model%curves, load%curve, (t - load%t_start)/load%x_scale)* &
         axis_of(state%world%skew, load%skew, load%dir)
   end function gravity_at

   !> Acceleration of each card of gravity now, and its mean with that of the last cycle
   pure subroutine find_gravity(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%gravity)
         associate (field => state%field(i))
            field%now = gravity_at(model, state, model%gravity(i), state%time)
            field%mean = 0.5_wp*(field%now + gravity_at(model, state, model%gravity(i), &
               state%time - state%h1))
         end associate
      end do
   end subroutine find_gravity

   !> Boundary conditions: the blocked components of acceleration and velocity become zero
   subroutine hold_conditions(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      integer :: i, dof, lead
      real(wp) :: e(3)

      do i = 1, size(model%bcs)
         lead = model%bcs(i)%lead
         state%w_before(i, :) = state%world%w(lead, :)
         if (rests(model%bcs(i))) then                  ! nothing would be left
            state%a(lead, :) = 0.0_wp
            state%v(lead, :) = 0.0_wp
            state%al(lead, :) = 0.0_wp
            state%world%w(lead, :) = 0.0_wp
            cycle
         end if
         do dof = 1, 6
            if (.not. model%bcs(i)%fixed(dof)) cycle
            e = axis_of(state%world%skew, model%bcs(i)%skew, dof)
            if (dof <= 3) then
               call take_along(e, lead, state%a)
               call take_along(e, lead, state%v)
            else
               call take_along(e, lead, state%al)
               call take_along(e, lead, state%world%w)
            end if
         end do
      end do
   end subroutine hold_conditions

   !> Conditions that block all directions, along global axes
   pure logical function rests(bcs)
      type(bcs_t), intent(in) :: bcs

      rests = bcs%skew == 0 .and. all(bcs%fixed)
   end function rests

   !> A row loses its component along e
   pure subroutine take_along(e, row, a)
      real(wp), intent(in) :: e(3)
      integer, intent(in) :: row
      real(wp), contiguous, intent(inout) :: a(:, :)

      real(wp) :: b(3)

      b = a(row, :)
      a(row, :) = b - dot_product(b, e)*e
   end subroutine take_along

   !> Imposed motion: replaces one component of the acceleration, and counts its work. The half of
   !> it that counts with the next step is lost (legacy quirk) where the motion ends before that.
   !>
   !> velocity: (c F(t + h2/2) - v)/h12;  displacement: ((c F(t + h2) - d)/h2 - v)/h12, after a
   !> sensor (c F(t + h2) - c F(t))/h2;  acceleration: c F(t + h2)
   subroutine impose_motion(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      integer :: i
      real(wp) :: e(3), old, new, rate, power

      do i = 1, size(model%motion)
         associate (motion => model%motion(i))
            power = 0.0_wp
            if (state%time >= motion%t_start .and. state%time <= motion%t_stop .and. &
               is_on(state%time, state%h1, motion%t_sensor, motion%t_off)) then
               e = axis_of(state%world%skew, motion%skew, motion%dir)
               if (motion%dir <= 3) then
                  old = dot_product(state%a(motion%lead, :), e)
                  rate = dot_product(state%v(motion%lead, :), e)
                  new = wanted_acceleration(model, state, motion, rate, &
                     dot_product(state%d(motion%lead, :), e))
                  state%a(motion%lead, :) = state%a(motion%lead, :) + (new - old)*e
               else
                  old = dot_product(state%al(motion%lead, :), e)
                  rate = dot_product(state%world%w(motion%lead, :), e)
                  new = wanted_acceleration(model, state, motion, rate, &
                     dot_product(state%motion_turn(i, :), e))
                  state%al(motion%lead, :) = state%al(motion%lead, :) + (new - old)*e
               end if
               power = 0.25_wp*(new - old)*inertia_along(model, state, motion, e)* &
                  (state%h12*new + 2.0_wp*rate)
               state%work = state%work + state%h1*(power + state%motion_power(i))
            end if
            state%motion_power(i) = power
         end associate
      end do
   end subroutine impose_motion

   pure real(wp) function wanted_acceleration(model, state, motion, rate, moved) result(a)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: rate, moved    !! velocity and displacement along the dof

      real(wp) :: t, target

      t = state%time - motion%t_sensor
      select case (motion%kind)
      case (IMPOSE_VELOCITY)
         a = (curve_at(t + 0.5_wp*state%h2) - rate)/state%h12
      case (IMPOSE_DISPLACEMENT)
         target = curve_at(t + state%h2) - moved
         if (motion%sensed) target = curve_at(t + state%h2) - curve_at(t)
         a = (target/state%h2 - rate)/state%h12
      case default   ! IMPOSE_ACCELERATION
         a = curve_at(t + state%h2)
      end select
   contains
      pure real(wp) function curve_at(time)
         real(wp), intent(in) :: time

         curve_at = motion%y_scale*load_value(model%curves, motion%curve, time/motion%x_scale)
      end function curve_at
   end function wanted_acceleration

   !> Mass or inertia that the work of an imposed motion counts with; for rotations of a body
   !> e.J e in a skew, but the sum of a column of J in global axes (legacy quirk)
   pure real(wp) function inertia_along(model, state, motion, e) result(m)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: e(3)

      real(wp) :: p(3, 3), je(3)

      if (motion%dir <= 3) then
         m = state%mass(motion%lead)
      else if (motion%lead > model%n_body) then
         m = state%inertia(motion%lead)
      else
         p = reshape(state%p(motion%lead, :), [3, 3])
         je = matmul(p, state%principal(motion%lead, :)*matmul(e, p))
         m = dot_product(e, je)
         if (motion%skew == 0) m = sum(je)
      end if
   end function inertia_along

end module kj_legacy_load
