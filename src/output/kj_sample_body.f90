!> Channels of rigid bodies + state -> numbers.
module kj_sample_body
   use kj_kinds, only: wp
   use kj_math3, only: to_quaternion, turn_between
   use kj_model, only: model_t
   use kj_state, only: state_t
   use kj_take, only: roster_t, take
   use kj_channels, only: CH_B_POS, CH_B_VEL, CH_B_ANGVEL, CH_B_ACC, CH_B_ANGACC, CH_B_FORCE, &
      CH_B_MOMENT, CH_B_IMPULSE, CH_B_ANGIMP, CH_B_ROTSUM, CH_B_ORIENT, CH_B_KE
   implicit none
   private

   public :: sample_bodies

contains

   !> A channel of the bodies of a roster
   subroutine sample_bodies(model, state, channel, roster, gravity, last, y)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      integer, intent(in) :: channel
      type(roster_t), intent(in) :: roster
      real(wp), intent(in) :: gravity(:, :)      !! (n_lead, 3) acceleration not in state%f_own
      real(wp), intent(inout) :: last(:, :)      !! (4, n_body) the quaternions of the row before
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, bodies of the history)

      integer :: i

      select case (channel)
      case (CH_B_POS); call take(state%world%x, roster, y)
      case (CH_B_VEL); call take(state%v, roster, y)
      case (CH_B_ANGVEL); call take(state%world%w, roster, y)
      case (CH_B_ACC); call take(state%a, roster, y)
      case (CH_B_ANGACC); call take(state%al, roster, y)
      case (CH_B_FORCE)
         do i = 1, size(roster%place)
            associate (body => roster%place(i))
               y(:, roster%entity(i)) = state%f(body, :) + state%f_own(body, :) + &
                  state%mass(body)*gravity(body, :)
            end associate
         end do
      case (CH_B_MOMENT)
         do i = 1, size(roster%place)
            associate (body => roster%place(i))
               y(:, roster%entity(i)) = state%m(body, :) + state%m_own(body, :)
            end associate
         end do
      case (CH_B_IMPULSE); call take(state%impulse, roster, y)
      case (CH_B_ANGIMP); call take(state%angular_impulse, roster, y)
      case (CH_B_ROTSUM)
         call take(state%rotation_sum, roster, y)
         if (state%staggered) then     ! this cycle's share is not there yet
            do i = 1, size(roster%place)
               associate (body => roster%place(i))
                  y(:, roster%entity(i)) = y(:, roster%entity(i)) + &
                     state%h2*state%world%w(body, :)
               end associate
            end do
         end if
      case (CH_B_ORIENT); call orientations(model, state, roster, last, y)
      case (CH_B_KE); call kinetic_energies(state, roster, y)
      end select
   end subroutine sample_bodies

   !> Rotations from the pose at the start; a quaternion has the sign that is nearer to the last one
   pure subroutine orientations(model, state, roster, last, y)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(roster_t), intent(in) :: roster
      real(wp), intent(inout) :: last(:, :)
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: from(9), to(9), q(4)
      integer :: i, body

      do i = 1, size(roster%place)
         body = roster%place(i)
         from = model%axes(body, :)
         to = state%p(body, :)
         q = to_quaternion(turn_between(from, to))
         if (dot_product(q, last(:, body)) < 0.0_wp) q = -q
         last(:, body) = q
         y(:, roster%entity(i)) = q
      end do
   end subroutine orientations

   pure subroutine kinetic_energies(state, roster, y)
      type(state_t), intent(in) :: state
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: v(3), w(3), wl(3)
      integer :: i, k, body

      do i = 1, size(roster%place)
         body = roster%place(i)
         v = state%v(body, :) + 0.5_wp*state%h1*state%a(body, :)
         w = state%world%w(body, :) + 0.5_wp*state%h1*state%al(body, :)
         do k = 1, 3
            wl(k) = dot_product(w, state%p(body, 3*k - 2:3*k))
         end do
         y(1, roster%entity(i)) = 0.5_wp*(state%mass(body)*dot_product(v, v) + &
            sum(state%principal(body, :)*wl**2))
      end do
   end subroutine kinetic_energies

end module kj_sample_body
