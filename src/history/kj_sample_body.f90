!> Channels of rigid bodies + snapshot -> numbers.
module kj_sample_body
   use kj_kinds, only: wp
   use kj_math3, only: to_quaternions
   use kj_block, only: BLOCK
   use kj_model, only: model_t
   use kj_snapshot, only: snapshot_t
   use kj_take, only: roster_t, take, take_block
   use kj_channels, only: CH_B_POS, CH_B_VEL, CH_B_ANGVEL, CH_B_ACC, CH_B_ANGACC, CH_B_FORCE, &
      CH_B_MOMENT, CH_B_IMPULSE, CH_B_ANGIMP, CH_B_ROTSUM, CH_B_ORIENT, CH_B_KE
   implicit none
   private

   public :: sample_bodies

contains

   !> A channel of the bodies of a roster
   subroutine sample_bodies(model, now, channel, roster, last, y)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel
      type(roster_t), intent(in) :: roster
      real(wp), intent(inout) :: last(:, :)      !! (4, n_body) the quaternions of the row before
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, bodies of the history)

      select case (channel)
      case (CH_B_POS); call take(now%x, roster, y)
      case (CH_B_VEL); call take(now%v, roster, y)
      case (CH_B_ANGVEL); call take(now%w, roster, y)
      case (CH_B_ACC); call take(now%a, roster, y)
      case (CH_B_ANGACC); call take(now%al, roster, y)
      case (CH_B_FORCE); call take(now%f, roster, y)
      case (CH_B_MOMENT); call take(now%m, roster, y)
      case (CH_B_IMPULSE); call take(now%impulse, roster, y)
      case (CH_B_ANGIMP); call take(now%angular_impulse, roster, y)
      case (CH_B_ROTSUM); call take(now%rotation_sum, roster, y)
      case (CH_B_ORIENT); call orientations(model, now, roster, last, y)
      case (CH_B_KE); call kinetic_energies(now, roster, y)
      end select
   end subroutine sample_bodies

   !> Rotations from the pose at the start; a quaternion has the sign that is nearer to the last one
   pure subroutine orientations(model, now, roster, last, y)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      type(roster_t), intent(in) :: roster
      real(wp), intent(inout) :: last(:, :)
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: from(BLOCK, 9), to(BLOCK, 9), r(BLOCK, 9), q(BLOCK, 4)
      integer :: i, k, n, first

      from = 0.0_wp
      to = 0.0_wp
      do first = 1, size(roster%place), BLOCK
         n = min(BLOCK, size(roster%place) - first + 1)
         associate (body => roster%place(first:first + n - 1), entity => roster%entity(first:))
            call take_block(model%axes, body, from)
            call take_block(now%p, body, to)
            do k = 1, 3
               do i = 1, 3
                  r(:, 3*(k - 1) + i) = to(:, i)*from(:, k) + to(:, i + 3)*from(:, k + 3) + &
                     to(:, i + 6)*from(:, k + 6)
               end do
            end do
            call to_quaternions(BLOCK, r, q)
            do i = 1, n
               associate (quat => last(:, body(i)))
                  quat = sign(1.0_wp, dot_product(q(i, :), quat))*q(i, :)
                  y(:, entity(i)) = quat
               end associate
            end do
         end associate
      end do
   end subroutine orientations

   pure subroutine kinetic_energies(now, roster, y)
      type(snapshot_t), intent(in) :: now
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: v(3), w(3), spin2
      integer :: i, k, body

      do i = 1, size(roster%place)
         body = roster%place(i)
         do k = 1, 3
            v(k) = now%v(body, k) + now%lag*now%a(body, k)
            w(k) = now%w(body, k) + now%lag*now%al(body, k)
         end do
         spin2 = 0.0_wp
         do k = 1, 3
            spin2 = spin2 + now%principal(body, k)*(w(1)*now%p(body, 3*k - 2) + &
               w(2)*now%p(body, 3*k - 1) + w(3)*now%p(body, 3*k))**2
         end do
         y(1, roster%entity(i)) = 0.5_wp*(now%mass(body)*(v(1)**2 + v(2)**2 + v(3)**2) + spin2)
      end do
   end subroutine kinetic_energies

end module kj_sample_body
