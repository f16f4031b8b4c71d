!> Node channels + state -> numbers.
module kj_sample_node
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_model, only: model_t
   use kj_legacy_state, only: legacy_state_t
   use kj_skew, only: axis_of
   use kj_legacy_body, only: secondary_velocity
   use kj_channels, only: CH_N_POS, CH_N_DISP, CH_N_VEL, CH_N_ANGVEL, CH_N_ACC, CH_N_ANGACC
   implicit none
   private

   public :: sample_nodes

contains

   !> A channel of the nodes of the history
   subroutine sample_nodes(model, state, channel, y)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: channel
      real(wp), intent(inout) :: y(:, :)         !! (3, nodes of the history)

      real(wp) :: x(3)
      integer :: k, skew, dir

      do k = 1, size(y, 2)
         associate (node => model%th_node(k))
            select case (channel)
            case (CH_N_POS); x = state%world%x(node, :)
            case (CH_N_DISP); x = state%d(node, :)
            case (CH_N_VEL); x = state%v(node, :)
            case (CH_N_ANGVEL); x = turning_of(model, state, node)
            case (CH_N_ACC); x = acceleration_of(model, state, node, 0)
            case (CH_N_ANGACC); x = acceleration_of(model, state, node, 3)
            end select
         end associate
         y(:, k) = x
         skew = model%th_node_skew(k)
         if (skew == 0 .or. channel == CH_N_POS) cycle
         do dir = 1, 3
            y(dir, k) = dot_product(x, axis_of(state%world%skew, skew, dir))
         end do
      end do
   end subroutine sample_nodes

   !> Angular velocity of a node; conditions act on a secondary node one cycle later than on its
   !> body
   pure function turning_of(model, state, node) result(w)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: node
      real(wp) :: w(3)

      integer :: lead

      lead = model%lead(node)
      w = state%world%w(lead, :)
      if (.not. state%staggered) return
      if (node /= lead .and. state%bcs_of(lead) > 0) w = state%w_before(state%bcs_of(lead), :)
   end function turning_of

   !> Acceleration (offset 0) or angular acceleration (offset 3) of a node; that of a secondary node
   !> is the difference of its velocities over h12 in the staggered scheme
   pure function acceleration_of(model, state, node, offset) result(a)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: node, offset
      real(wp) :: a(3)

      real(wp) :: v(3), w(3)
      integer :: lead

      lead = model%lead(node)
      if (node == lead) then
         a = state%a(lead, :)
         if (offset > 0) a = state%al(lead, :)
         return
      end if
      if (.not. state%staggered) then
         w = state%world%w(lead, :)
         v = state%world%x(node, :) - state%world%x(lead, :)
         a = state%a(lead, :) + cross(state%al(lead, :), v) + cross(w, cross(w, v))
         if (offset > 0) a = state%al(lead, :)
         return
      end if
      w = state%world%w(lead, :) + state%h12*state%al(lead, :)
      if (offset > 0) then
         a = (w - turning_of(model, state, node))/state%h12
         return
      end if
      v = state%v(lead, :) + state%h12*state%a(lead, :)
      a = (secondary_velocity(v, w, state%world%x(node, :) - state%world%x(lead, :), state%h2, &
         state%h12, model%n_secondary(lead) <= 2) - state%v(node, :))/state%h12
   end function acceleration_of

end module kj_sample_node
