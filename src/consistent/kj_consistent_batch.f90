!> State of all joints of one batch under the consistent formulation.
module kj_consistent_batch
   use, intrinsic :: iso_c_binding, only: c_loc, c_f_pointer
   use kj_kinds, only: wp
   use kj_math3, only: cross, unit
   use kj_joint_types, only: joint_types, NDOF, FRAME_LINE, CHART_LINE, CHART_UNIVERSAL
   use kj_joint_batch, only: joint_batch_t, DOF_FREE, is_hardened
   use kj_spring_law, only: spring_block_t, WAITING, ALIVE
   use kj_block, only: BLOCK, block_of, lane_of, clear
   implicit none
   private

   public :: matrix_t, consistent_block_t, limit_block_t, consistent_joint_t, &
      new_consistent_joint, in_groups, group_at, chart_of, frame_of, last_of

   !> The matrix B of q' = B u of a block of joints, as what unit forces do (kj_consistent_chart); W
   type :: matrix_t
      sequence
      real(wp) :: force(BLOCK, 9)                !! on node 1, of each translation
      real(wp) :: couple(BLOCK, 9)               !! M1 on lead 1, of each translation
      real(wp) :: turn(BLOCK, 9)                 !! moment on body 1, of each damped rotation
      real(wp) :: apart(BLOCK, 3)                !! d: d x force - M1 is the moment on lead 2
   end type matrix_t

   !> State of a block of joints, numbers that begin as 0 (clear). A field stands here and nowhere
   !> else: blocks are saved, restored and gathered as a whole (rows_at)
   type :: consistent_block_t
      sequence
      real(wp) :: q(BLOCK, 6)                    !! coordinates
      real(wp) :: qd(BLOCK, 6)                   !! rates with the velocities of the half step
      real(wp) :: fe(BLOCK, 6)                   !! elastic force on node 1, without friction
      real(wp) :: fd(BLOCK, 6)                   !! damping force on node 1
      real(wp) :: elastic(BLOCK)                 !! work done on springs
      real(wp) :: dissipated(BLOCK)              !! work done on dampers
      type(matrix_t) :: b
   end type consistent_block_t

   !> State of the limits of a block, all at rest
   type :: limit_block_t
      sequence
      real(wp) :: friction(BLOCK, 6) = 0.0_wp    !! on node 1, beside fe
      real(wp) :: grip(BLOCK, 6) = 0.0_wp        !! limit of friction, now; 0 = none
      real(wp) :: c_limit(BLOCK, 6) = 0.0_wp     !! damping of stops, stuck friction and lock, now
      !> damping of combined stops, translations and rotations, and its directions
      real(wp) :: c_round(BLOCK, 2) = 0.0_wp, to_round(BLOCK, 6) = 0.0_wp
      real(wp) :: slip_energy(BLOCK) = 0.0_wp    !! that sliding took
      real(wp) :: stored(BLOCK) = 0.0_wp         !! energy in stops, stuck friction and lock
      real(wp) :: locked(BLOCK) = 0.0_wp         !! 1 where held by the lock
      real(wp) :: q_lock(BLOCK, 6) = 0.0_wp      !! coordinates held by the lock
      real(wp) :: flag(BLOCK, 6) = real(DOF_FREE, wp)   !! DOF_ constant
   end type limit_block_t

   !> State of the joints of a batch: the lanes of the last block beyond them are not used
   type :: consistent_joint_t
      type(consistent_block_t), allocatable :: block(:)
      type(limit_block_t), allocatable :: limit(:)   !! of limited batches only
      type(spring_block_t), allocatable :: spring(:)   !! of hardened springs only
   end type consistent_joint_t

contains

   !> Whether the joints of a batch may go through kernels in parts: those of a small scene, which
   !> have one step, without limits and memory, as these stand in blocks beside
   pure logical function in_groups(batch)
      type(joint_batch_t), intent(in) :: batch

      in_groups = batch%n < BLOCK .and. .not. (batch%limited .or. is_hardened(batch))
   end function in_groups

   !> Joints of a block from a place on, as if their block began there
   subroutine group_at(block, lane, group)
      type(consistent_block_t), target, intent(in) :: block
      integer, intent(in) :: lane
      type(consistent_block_t), pointer, intent(out) :: group

      call c_f_pointer(c_loc(block%q(lane, 1)), group)
   end subroutine group_at

   !> Chart of a batch
   pure integer function chart_of(batch) result(chart)
      type(joint_batch_t), intent(in) :: batch

      chart = joint_types(batch%row)%chart
      if (batch%frame == FRAME_LINE) chart = CHART_LINE
   end function chart_of

   !> The dofs of a batch that may have a force of some laws are among the first 0, 3 or 6
   pure integer function last_of(batch, laws) result(last)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: laws                !! sum of LAW_ constants

      logical :: on(NDOF)

      on = batch%limited .or. iand(batch%law, laws) /= 0
      last = merge(6, merge(3, 0, any(on)), any(on(4:)))
   end function last_of

   !> State of the joints of a batch, all zero
   subroutine new_consistent_joint(batch, joint)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_joint_t), target, intent(out) :: joint

      integer :: i

      associate (blocks => (batch%n + BLOCK - 1)/BLOCK)
         allocate (joint%block(blocks))
         do i = 1, blocks
            call clear(c_loc(joint%block(i)), storage_size(joint%block))
         end do
         if (batch%limited) allocate (joint%limit(blocks))
         if (.not. is_hardened(batch)) return
         allocate (joint%spring(blocks))
      end associate
      do i = 1, batch%n
         if (batch%spring(i)%sensed .and. batch%spring(i)%flag /= 1) &
            joint%spring(block_of(i))%alive(lane_of(i)) = WAITING
      end do
   end subroutine new_consistent_joint

   !> Frame of a joint from its matrix B: the forces of the translations are its axes, or for a
   !> universal joint the dual basis of its axes
   pure function frame_of(batch, joint, j) result(e)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_joint_t), intent(in) :: joint
      integer, intent(in) :: j
      real(wp) :: e(9)

      real(wp) :: f(9)

      f = joint%block(block_of(j))%b%force(lane_of(j), :)
      e = f
      if (batch%geometry%chart /= CHART_UNIVERSAL) return
      e(4:6) = unit(cross(f(7:9), f(1:3)))
      e(7:9) = unit(cross(f(1:3), f(4:6)))
   end function frame_of

end module kj_consistent_batch
