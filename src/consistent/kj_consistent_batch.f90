!> State of all joints of one batch under the consistent formulation.
module kj_consistent_batch
   use kj_kinds, only: wp
   use kj_math3, only: cross, unit
   use kj_joint_types, only: joint_types, NDOF, FRAME_LINE, CHART_LINE, CHART_UNIVERSAL
   use kj_joint_batch, only: joint_batch_t, limits_t, DOF_FREE, LAW_SPRING, LAW_SPRING_CURVE, &
      LAW_DAMPER, LAW_DAMPER_CURVE
   use kj_block, only: BLOCK
   implicit none
   private

   public :: consistent_joint_t, new_consistent_joint, new_consistent_limits, chart_of, matrix_of, &
      frame_of, sprung_dofs, damped_dofs

   integer, parameter, public :: N_B = 30             !! numbers of the matrix B of a joint

   !> State
   type :: consistent_joint_t
      real(wp), allocatable :: q(:, :)           !! (n, 6) coordinates
      real(wp), allocatable :: fe(:, :)          !! (n, 6) elastic force on node 1, without friction
      real(wp), allocatable :: fd(:, :)          !! (n, 6) damping force on node 1
      !> (n) work done on springs and on dampers
      real(wp), allocatable :: elastic(:), dissipated(:)
      !> (BLOCK, N_B, blocks) the matrix B block by block, see kj_consistent_chart: 1-9 force
      !> of each unit translation, 10-18 moment M1 on lead 1 of each, 19-27 moment on body 1 of each
      !> unit damping moment; 28-30 d, so that d x force - M1 is the moment on lead 2; W
      real(wp), allocatable :: b(:, :, :)
      !> (n, 6) rates with the velocities of the half step
      real(wp), allocatable :: qd(:, :)
      ! of limited batches only
      real(wp), allocatable :: friction(:, :)    !! (n, 6) friction on node 1, beside fe
      real(wp), allocatable :: grip(:, :)        !! (n, 6) limit of friction, now; 0 = none
      !> (n, 6) damping of stops, stuck friction and lock, now
      real(wp), allocatable :: c_limit(:, :)
      !> (n, 2) damping of combined stops, translations and rotations, and (n, 6) its directions
      real(wp), allocatable :: c_round(:, :), to_round(:, :)
      real(wp), allocatable :: slip_energy(:)    !! (n) energy that sliding took
      real(wp), allocatable :: stored(:)         !! (n) energy in stops, stuck friction and lock
      logical, allocatable :: locked(:)          !! (n) is held by its lock
      real(wp), allocatable :: q_lock(:, :)      !! (n, 6) coordinates held by the lock
      integer, allocatable :: flag(:, :)         !! (n, 6) DOF_ constant
   end type consistent_joint_t

contains

   !> Chart of a batch
   pure integer function chart_of(batch) result(chart)
      type(joint_batch_t), intent(in) :: batch

      chart = joint_types(batch%row)%chart
      if (batch%frame == FRAME_LINE) chart = CHART_LINE
   end function chart_of

   !> The dofs of a batch that may have an elastic force
   pure function sprung_dofs(batch) result(on)
      type(joint_batch_t), intent(in) :: batch
      logical :: on(NDOF)

      on = batch%limited .or. iand(batch%law, LAW_SPRING + LAW_SPRING_CURVE) /= 0
   end function sprung_dofs

   !> The dofs of a batch that may have a damping force
   pure function damped_dofs(batch) result(on)
      type(joint_batch_t), intent(in) :: batch
      logical :: on(NDOF)

      on = batch%limited .or. iand(batch%law, LAW_DAMPER + LAW_DAMPER_CURVE) /= 0
   end function damped_dofs

   !> State of n joints, all zero
   pure subroutine new_consistent_joint(n, joint)
      integer, intent(in) :: n
      type(consistent_joint_t), intent(out) :: joint

      allocate (joint%q(n, 6), joint%fe(n, 6), joint%fd(n, 6), joint%elastic(n), &
         joint%dissipated(n), joint%b(BLOCK, N_B, (n + BLOCK - 1)/BLOCK), joint%qd(n, 6), &
         source=0.0_wp)
   end subroutine new_consistent_joint

   !> The matrix B of one joint
   pure function matrix_of(joint, i) result(b)
      type(consistent_joint_t), intent(in) :: joint
      integer, intent(in) :: i
      real(wp) :: b(N_B)

      b = joint%b(modulo(i - 1, BLOCK) + 1, :, (i - 1)/BLOCK + 1)
   end function matrix_of

   !> Frame of a joint from its matrix B: the forces of the translations are its axes, or for a
   !> universal joint the dual basis of its axes
   pure function frame_of(batch, joint, j) result(e)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_joint_t), intent(in) :: joint
      integer, intent(in) :: j
      real(wp) :: e(9)

      real(wp) :: b(N_B)

      b = matrix_of(joint, j)
      e = b(1:9)
      if (batch%geometry%chart /= CHART_UNIVERSAL) return
      e(4:6) = unit(cross(b(7:9), b(1:3)))
      e(7:9) = unit(cross(b(1:3), b(4:6)))
   end function frame_of

   !> State of the limits of n joints, all at rest
   pure subroutine new_consistent_limits(n, joint)
      integer, intent(in) :: n
      type(consistent_joint_t), intent(inout) :: joint

      allocate (joint%friction(n, 6), joint%grip(n, 6), joint%c_limit(n, 6), joint%c_round(n, 2), &
         joint%to_round(n, 6), &
         joint%slip_energy(n), joint%stored(n), joint%q_lock(n, 6), source=0.0_wp)
      allocate (joint%locked(n), source=.false.)
      allocate (joint%flag(n, 6), source=DOF_FREE)
   end subroutine new_consistent_limits

end module kj_consistent_batch
