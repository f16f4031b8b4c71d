!> Forces that an embedding host adds to a consistent scene: to bodies of a model, or beside single
!> joints.
module kj_c_host
   use kj_kinds, only: wp
   use kj_c_body, only: spin_velocity
   use kj_c_state, only: c_model_t, c_state_t
   implicit none
   private

   public :: add_host_loads, look_ahead

contains

   !> Forces and moments of an embedding host, W; work: mean force times displacement
   subroutine add_host_loads(h, state)
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

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

   !> Predicted velocities again, with what the host of single joints adds to their forces
   subroutine look_ahead(c, h, state)
      type(c_model_t), intent(in) :: c
      real(wp), intent(in) :: h
      type(c_state_t), intent(inout) :: state

      integer :: k

      if (.not. allocated(state%f_ahead)) return
      do k = 1, 3
         state%poses%v(:, k) = state%v(:, k) + &
            0.5_wp*h*c%im*(state%f(:, k) + state%f_ahead(:, k))
      end do
      call spin_velocity(c, state%poses%quat, state%l + 0.5_wp*h*(state%t + state%t_ahead), 1, &
         size(c%im), state%poses%w)
   end subroutine look_ahead

end module kj_c_host
