!> Forces that an embedding host adds to the bodies of a consistent scene.
module kj_consistent_host
   use kj_kinds, only: wp
   use kj_consistent_state, only: consistent_state_t
   implicit none
   private

   public :: add_host_loads

contains

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

end module kj_consistent_host
