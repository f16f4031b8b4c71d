!> Springs with more than an elastic law under the consistent formulation: their forces from the
!> coordinates, sensors and failure in pass 1 of a step, and their dampers in pass 2.
!>
!> What depends on the rate is a damper: it is implicit, and its work is that of dampers. When a
!> spring dies what it has stored is lost, and counts as dissipated.
!> Source: docs/theory/joints.md 8.4.
module kj_consistent_hardening
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: joint_batch_t, SPRING4
   use kj_block, only: BLOCK
   use kj_spring_law, only: spring_block_t, base_force, rate_force, failure, switch_spring, DEAD, &
      ALIVE
   use kj_consistent_batch, only: consistent_block_t
   implicit none
   private

   public :: hardened_forces, hardened_damper

contains

   !> Elastic forces of n springs from `from`, as their memory and sensors have them; state holds
   !> the coordinates of the last step
   pure subroutine hardened_forces(batch, curves, time, h, from, n, q, state, spring, f)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: time(BLOCK), h(BLOCK)   !! now, and the step that led here
      integer, value :: from, n
      real(wp), intent(in) :: q(BLOCK, NDOF)
      type(consistent_block_t), intent(inout) :: state
      type(spring_block_t), intent(inout) :: spring
      real(wp), intent(out) :: f(BLOCK, NDOF)

      real(wp) :: now(NDOF), last(NDOF), length, per
      integer :: i, j, k

      do i = 1, n
         j = from + i - 1
         last = state%q(i, :) - spring%zero(i, :)
         call switch_spring(batch%kind == SPRING4, batch%spring(j), time(i), h(i), last, i, spring)
         now = q(i, :) - spring%zero(i, :)
         length = q(i, 1) + batch%xl0(j, 1)
         per = length_of(batch, j, spring%zero(i, 1))
         f(i, :) = 0.0_wp
         do k = 1, NDOF
            associate (law => batch%spring(j)%dof(k))
               call base_force(law, curves, now(k)/per, (now(k) - last(k))/per, length, &
                  spring%base(i, k), spring%hi(i, k), spring%lo(i, k))
               if (spring%alive(i) >= ALIVE) f(i, k) = law%a*spring%base(i, k)
            end associate
         end do
         spring%energy(i, :) = spring%energy(i, :) + (now - last)* &
            (0.5_wp*(f(i, :) + state%fe(i, :)) + state%fd(i, :))
         call fail_spring(batch, j, i, h(i), now, per, f(i, :) + state%fd(i, :), state, spring)
      end do
   end subroutine hardened_forces

   !> Length that laws per unit of length count with, else 1
   pure real(wp) function length_of(batch, j, zero) result(length)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: j
      real(wp), intent(in) :: zero               !! change of length where the spring began

      length = 1.0_wp
      if (batch%spring(j)%per_length) length = batch%xl0(j, 1) + zero
   end function length_of

   !> A spring beyond its limits is dead from the next step on
   pure subroutine fail_spring(batch, j, i, h, q, per, force, state, spring)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: j, i                !! of the batch, of the block
      real(wp), intent(in) :: h, q(NDOF), per, force(NDOF)
      type(consistent_block_t), intent(inout) :: state
      type(spring_block_t), intent(inout) :: spring

      logical :: fails

      if (spring%alive(i) < ALIVE) return
      associate (s => batch%spring(j))
         if (batch%kind == SPRING4) then
            fails = q(1) > s%dof(1)%hi .or. q(1) < s%dof(1)%lo
         else
            call failure(s, q/per, state%qd(i, :)/per, force, spring%energy(i, :), h, &
               spring%damage(i))
            fails = spring%damage(i) >= 1.0_wp
         end if
      end associate
      if (.not. fails) return
      spring%alive(i) = DEAD
      state%dissipated(i) = state%dissipated(i) + state%elastic(i)
      state%elastic(i) = 0.0_wp
   end subroutine fail_spring

   !> Damping force of a direction at a rate, and its slope where positive
   pure subroutine hardened_damper(batch, curves, from, n, dof, rate, spring, f, c)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      integer, value :: from, n, dof
      real(wp), intent(in) :: rate(BLOCK)
      type(spring_block_t), intent(in) :: spring
      real(wp), intent(out) :: f(BLOCK), c(BLOCK)

      real(wp) :: per
      integer :: i, j

      do i = 1, n
         j = from + i - 1
         f(i) = 0.0_wp
         c(i) = 0.0_wp
         if (spring%alive(i) < ALIVE) cycle
         per = length_of(batch, j, spring%zero(i, 1))
         call rate_force(batch%spring(j)%dof(dof), curves, spring%base(i, dof), rate(i)/per, f(i), &
            c(i))
         c(i) = c(i)/per
      end do
   end subroutine hardened_damper

end module kj_consistent_hardening
