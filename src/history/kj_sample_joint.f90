!> Channels of joints and springs + snapshot -> numbers, batch by batch.
module kj_sample_joint
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_kinds, only: wp
   use kj_math3, only: to_quaternions
   use kj_curve, only: curve_integral
   use kj_block, only: BLOCK
   use kj_joint_types, only: joint_types, NDOF, FRAME_CROSS
   use kj_joint_batch, only: joint_batch_t, LAW_SPRING_CURVE, DOF_FREE, DOF_BLOCKED
   use kj_model, only: model_t
   use kj_snapshot, only: snapshot_t, shown_joints_t
   use kj_take, only: roster_t, take, take_block
   use kj_channels, only: CH_J_POS, CH_J_FORCE, CH_J_MOMENT, CH_J_DISP, CH_J_ROT, CH_J_VEL, &
      CH_J_ANGVEL, CH_J_IE, CH_J_ELASTIC, CH_J_DISSIPATED, CH_J_LENGTH, CH_J_VIOL_T, CH_J_VIOL_R, &
      CH_J_FRAME, CH_J_ORTHO, CH_J_STATE, CH_J_FRICTION, CH_J_GAP, CH_J_GAP_ROT, CH_S_FORCE, &
      CH_S_MOMENT, CH_S_DISP, CH_S_ROT, CH_S_IE, CH_S_LENGTH
   implicit none
   private

   public :: sample_joints

contains

   !> A channel of the joints or springs of a roster
   subroutine sample_joints(model, now, channel, roster, y)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, entities of the history)

      associate (b => model%batch(roster%batch), s => now%joint(roster%batch))
         select case (channel)
         case (CH_J_POS); call take(s%x, roster, y)
         case (CH_J_FORCE, CH_S_FORCE); call take(s%f(:, 1:3), roster, y)
         case (CH_J_MOMENT, CH_S_MOMENT); call take(s%f(:, 4:6), roster, y)
         case (CH_J_DISP, CH_S_DISP); call take(s%q(:, 1:3), roster, y)
         case (CH_J_ROT, CH_S_ROT); call take(s%q(:, 4:6), roster, y)
         case (CH_J_VEL); call take(s%rate(:, 1:3), roster, y)
         case (CH_J_ANGVEL); call take(s%rate(:, 4:6), roster, y)
         case (CH_J_IE, CH_S_IE); call take(s%energy, roster, y)
         case (CH_J_ELASTIC); call elastic_energies(model, b, s, roster, y)
         case (CH_J_DISSIPATED)
            call elastic_energies(model, b, s, roster, y)
            y(1, roster%entity) = s%energy(roster%place) - y(1, roster%entity)
         case (CH_J_LENGTH, CH_S_LENGTH); call take(s%length, roster, y)
         case (CH_J_VIOL_T); call violations(joint_types(b%row)%free(1:3), s%q(:, 1:3), roster, y)
         case (CH_J_VIOL_R); call violations(joint_types(b%row)%free(4:6), s%q(:, 4:6), roster, y)
         case (CH_J_FRAME); call frames(s%e, b%frame, roster, y)
         case (CH_J_ORTHO); call take(s%ortho, roster, y)
         case (CH_J_STATE); call states(joint_types(b%row)%free, s, roster, y)
         case (CH_J_FRICTION)
            if (allocated(s%slip_energy)) then
               call take(s%slip_energy, roster, y)
            else
               y(:, roster%entity) = 0.0_wp
            end if
         case (CH_J_GAP); call gaps_of(b, now%stops_alone, s%q, 1, roster, y)
         case (CH_J_GAP_ROT); call gaps_of(b, now%stops_alone, s%q, 4, roster, y)
         end select
      end associate
   end subroutine sample_joints

   !> Energy stored in the elastic laws of a joint: k q^2/2, or the integral of its curve; with
   !> stops, friction and lock
   pure subroutine elastic_energies(model, b, s, roster, y)
      type(model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: b
      type(shown_joints_t), intent(in) :: s
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: u(size(roster%place))
      integer :: dof, i, j, part

      u = 0.0_wp
      if (b%limited) u = s%stored(roster%place)
      do dof = 1, NDOF
         if (iand(b%law(dof), LAW_SPRING_CURVE) /= 0) then
            do i = 1, size(u)
               j = roster%place(i)
               u(i) = u(i) + b%k(j, dof)*curve_integral(model%curves, b%k_curve(j, dof), 0.0_wp, &
                  s%q(j, dof))
            end do
         else if (b%limited .and. joint_types(b%row)%free(dof) == 0) then
            part = merge(1, 2, dof <= 3)
            do i = 1, size(u)
               j = roster%place(i)
               u(i) = u(i) + 0.5_wp*s%k_block(j, part)*s%q(j, dof)**2
            end do
         else
            do i = 1, size(u)
               j = roster%place(i)
               u(i) = u(i) + 0.5_wp*b%k(j, dof)*s%q(j, dof)**2
            end do
         end if
      end do
      y(1, roster%entity) = u
   end subroutine elastic_energies

   !> Norm of the displacements, or of the rotations, that are blocked
   pure subroutine violations(free, q, roster, y)
      integer, intent(in) :: free(3)             !! 1 where a direction is
      real(wp), contiguous, intent(in) :: q(:, :)        !! (n, 3)
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      integer :: i

      do i = 1, size(roster%place)
         associate (j => roster%place(i))
            y(1, roster%entity(i)) = sqrt((1 - free(1))*q(j, 1)**2 + (1 - free(2))*q(j, 2)**2 + &
               (1 - free(3))*q(j, 3)**2)
         end associate
      end do
   end subroutine violations

   !> Quaternion, world from joint frame; a universal frame (e1, e2, e3) gives that of
   !> (e1, e2, e1 x e2)
   pure subroutine frames(e, frame, roster, y)
      real(wp), contiguous, intent(in) :: e(:, :)        !! (n, 9)
      integer, intent(in) :: frame               !! FRAME_ constant
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: r(BLOCK, 9), q(BLOCK, 4)
      integer :: i, n, first

      r = 0.0_wp
      do first = 1, size(roster%place), BLOCK
         n = min(BLOCK, size(roster%place) - first + 1)
         call take_block(e, roster%place(first:first + n - 1), r)
         if (frame == FRAME_CROSS) then
            r(:, 7) = r(:, 2)*r(:, 6) - r(:, 3)*r(:, 5)
            r(:, 8) = r(:, 3)*r(:, 4) - r(:, 1)*r(:, 6)
            r(:, 9) = r(:, 1)*r(:, 5) - r(:, 2)*r(:, 4)
         end if
         call to_quaternions(BLOCK, r, q)
         do i = 1, n
            y(:, roster%entity(first + i - 1)) = q(i, :)
         end do
      end do
   end subroutine frames

   !> What each direction does: DOF_ constants
   pure subroutine states(free, s, roster, y)
      integer, intent(in) :: free(NDOF)
      type(shown_joints_t), intent(in) :: s
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      integer :: i

      do i = 1, size(roster%place)
         y(:, roster%entity(i)) = merge(real(DOF_FREE, wp), real(DOF_BLOCKED, wp), free == 1)
         if (allocated(s%flag)) y(:, roster%entity(i)) = real(s%flag(roster%place(i), :), wp)
      end do
   end subroutine states

   pure subroutine gaps_of(b, alone, q, first, roster, y)
      type(joint_batch_t), intent(in) :: b
      logical, intent(in) :: alone
      real(wp), contiguous, intent(in) :: q(:, :)        !! (n, 6)
      integer, intent(in) :: first               !! 1 or 4
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: x(3)
      integer :: i

      do i = 1, size(roster%place)
         x = q(roster%place(i), first:first + 2)
         y(:, roster%entity(i)) = gaps(b, alone, roster%place(i), x, first)
      end do
   end subroutine gaps_of

   !> How far three directions are from their nearest stop; negative beyond it. Combined stops have
   !> one radius, the least of theirs, or each its own (alone).
   pure function gaps(batch, alone, j, x, first) result(gap)
      type(joint_batch_t), intent(in) :: batch
      logical, intent(in) :: alone
      integer, intent(in) :: j, first            !! joint of the batch; 1 or 4
      real(wp), intent(in) :: x(3)
      real(wp) :: gap(3)

      real(wp), dimension(3) :: lo, hi
      logical :: combined(3)

      gap = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. batch%limited) return
      lo = batch%limit%lo(j, first:first + 2)
      hi = batch%limit%hi(j, first:first + 2)
      combined = batch%limit%combined(j, first:first + 2) > 0.0_wp
      where (hi > 0.0_wp) gap = hi - x
      where (lo < 0.0_wp) gap = merge(min(gap, x - lo), x - lo, hi > 0.0_wp)
      if (.not. any(combined)) return
      where (combined) gap = 0.5_wp*(hi - lo) - norm2(pack(x - 0.5_wp*(lo + hi), combined))
      if (.not. alone) where (combined) gap = minval(gap, mask=combined)
   end function gaps

end module kj_sample_joint
