!> What imposed motions want: velocities over a step and at its end, accelerations now.
!> Source: docs/theory/consistent.md 7.
module kj_consistent_motion
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, load_value, curve_integral, curve_moment
   use kj_model, only: motion_t, IMPOSE_VELOCITY, IMPOSE_DISPLACEMENT, IMPOSE_ACCELERATION
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   implicit none
   private

   public :: motion_targets, motion_target, motion_accelerations

contains

   !> Wanted velocities of the imposed motions over a step from t to t + h: the mean over the step
   !> (tables integrated exactly) and the value at its end. Inactive motions keep what there is.
   subroutine motion_targets(model, state, h, mean, final, active)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h
      real(wp), intent(out) :: mean(:), final(:)     !! (n_motion)
      logical, intent(out) :: active(:)

      integer :: i

      do i = 1, size(model%motion)
         call motion_target(model%curves, model%motion(i), state%motion_at(i), state%time, h, &
            mean(i), final(i), active(i))
      end do
   end subroutine motion_targets

   !> The same of one motion
   pure subroutine motion_target(curves, m, at, time, h, mean, final, active)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: at, time, h        !! at: what it has reached
      real(wp), intent(inout) :: mean, final
      logical, intent(out) :: active

      real(wp) :: a, b, moved

      active = time >= m%t_start .and. time <= m%t_stop
      if (.not. active) return
      a = (time - m%t_sensor)/m%x_scale
      b = (time + h - m%t_sensor)/m%x_scale
      select case (m%kind)
      case (IMPOSE_VELOCITY)
         mean = m%y_scale*m%x_scale*integral(curves, m, a, b)/h
         final = m%y_scale*load_value(curves, m%curve, b)
      case (IMPOSE_DISPLACEMENT)
         moved = at
         if (m%sensed) moved = m%y_scale*load_value(curves, m%curve, a)
         mean = (m%y_scale*load_value(curves, m%curve, b) - moved)/h
         final = slope_at(curves, m, b)
      case default   ! IMPOSE_ACCELERATION
         mean = at + m%y_scale*m%x_scale**2*moment(curves, m, a, b)/h
         final = at + m%y_scale*m%x_scale*integral(curves, m, a, b)
      end select
   end subroutine motion_target

   !> Accelerations that the imposed motions want now
   subroutine motion_accelerations(model, state, wanted, active)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(out) :: wanted(:)             !! (n_motion)
      logical, intent(out) :: active(:)

      real(wp) :: x
      integer :: i

      wanted = 0.0_wp
      do i = 1, size(model%motion)
         associate (m => model%motion(i))
            active(i) = state%time >= m%t_start .and. state%time <= m%t_stop
            x = (state%time - m%t_sensor)/m%x_scale
            if (m%kind == IMPOSE_VELOCITY) wanted(i) = slope_at(model%curves, m, x)
            if (m%kind == IMPOSE_ACCELERATION) wanted(i) = m%y_scale*load_value(model%curves, &
               m%curve, x)
         end associate
      end do
   end subroutine motion_accelerations

   !> Integral of the curve of a motion from a to b
   pure real(wp) function integral(curves, m, a, b) result(y)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: a, b

      y = (b - a)*load_value(curves, m%curve, a)
      if (m%curve == 0) return
      if (curves%first(m%curve + 1) - curves%first(m%curve) > 1) y = &
         curve_integral(curves, m%curve, a, b)
   end function integral

   !> Integral of (b - s) f(s) from a to b
   pure real(wp) function moment(curves, m, a, b) result(y)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: a, b

      y = 0.5_wp*(b - a)**2*load_value(curves, m%curve, a)
      if (m%curve == 0) return
      if (curves%first(m%curve + 1) - curves%first(m%curve) > 1) y = &
         curve_moment(curves, m%curve, a, b)
   end function moment

   !> Slope of the table of a motion at an abscissa, in its units over time
   pure real(wp) function slope_at(curves, m, x) result(rate)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: x

      integer :: i, last

      rate = 0.0_wp
      if (m%curve == 0) return
      last = curves%first(m%curve + 1) - 1
      do i = curves%first(m%curve), last - 1
         rate = m%y_scale/m%x_scale*(curves%y(i + 1) - curves%y(i))/(curves%x(i + 1) - curves%x(i))
         if (curves%x(i + 1) > x) return
      end do
   end function slope_at

end module kj_consistent_motion
