!> State of all joints of one batch under the legacy scheme.
module kj_legacy_joint
   use, intrinsic :: iso_c_binding, only: c_loc, c_f_pointer
   use kj_kinds, only: wp
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: joint_batch_t, is_spring, DOF_FREE, DOF_BLOCKED
   use kj_block, only: BLOCK, block_of, lane_of
   use kj_nodal_stiffness, only: start_stiffness
   use kj_spring_law, only: spring_block_t, WAITING, ALIVE
   implicit none
   private

   public :: legacy_block_t, legacy_limit_t, legacy_joint_t, new_legacy_joint, group_at

   !> State of a block of joints. A field stands here and nowhere else: blocks are saved and
   !> restored as a whole (rows_at)
   type :: legacy_block_t
      sequence
      real(wp) :: e(BLOCK, 9) = 0.0_wp           !! joint frame, columns E1 E2 E3
      real(wp) :: q(BLOCK, 6) = 0.0_wp           !! displacement and rotation, J
      real(wp) :: f(BLOCK, 6) = 0.0_wp           !! force and moment on node 1, J
      real(wp) :: energy(BLOCK) = 0.0_wp         !! work done on the joint
      real(wp) :: qdot(BLOCK, 6) = 0.0_wp        !! rates; only at samples
      real(wp) :: stiff(BLOCK, 2) = 0.0_wp       !! time-step stiffness, translation and rotation
   end type legacy_block_t

   !> State of the limits of a block
   type :: legacy_limit_t
      sequence
      real(wp) :: k_block(BLOCK, 2) = 0.0_wp     !! stiffness of blocked dofs at present
      real(wp) :: friction(BLOCK, 6) = 0.0_wp    !! friction force, J
      real(wp) :: slip_energy(BLOCK) = 0.0_wp    !! that sliding took
      real(wp) :: stored(BLOCK) = 0.0_wp         !! elastic energy of stops, friction and lock
      real(wp) :: locked(BLOCK) = 0.0_wp         !! 1 where it has been locked
      real(wp) :: q_lock(BLOCK, 6) = 0.0_wp      !! q held by the lock
      real(wp) :: flag(BLOCK, 6) = real(DOF_FREE, wp)   !! DOF_ constant
   end type legacy_limit_t

   !> State of the joints of a batch: the lanes of the last block beyond them are not used
   type :: legacy_joint_t
      type(legacy_block_t), allocatable :: block(:)
      type(legacy_limit_t), allocatable :: limit(:)   !! of limited batches only
      type(spring_block_t), allocatable :: spring(:)  !! of springs only
   end type legacy_joint_t

contains

   !> Joints of a block from a place on, as if their block began there
   subroutine group_at(block, lane, group)
      type(legacy_block_t), target, intent(in) :: block
      integer, intent(in) :: lane
      type(legacy_block_t), pointer, intent(out) :: group

      call c_f_pointer(c_loc(block%e(lane, 1)), group)
   end subroutine group_at

   !> State at the start: initial frames and angles, stiffness of the time step
   pure subroutine new_legacy_joint(batch, joint)
      type(joint_batch_t), intent(in) :: batch
      type(legacy_joint_t), intent(out) :: joint

      real(wp) :: stiff(batch%n, 2)
      integer :: i, at, lane, dof

      associate (blocks => (batch%n + BLOCK - 1)/BLOCK)
         allocate (joint%block(blocks))
         if (batch%limited) allocate (joint%limit(blocks))
         if (is_spring(batch)) allocate (joint%spring(blocks))
      end associate
      call start_stiffness(batch, stiff)
      do i = 1, batch%n
         at = block_of(i)
         lane = lane_of(i)
         joint%block(at)%e(lane, :) = batch%frame0(i, :)
         joint%block(at)%q(lane, 4:6) = batch%angle0(i, :)
         joint%block(at)%stiff(lane, :) = stiff(i, :)
         if (is_spring(batch)) joint%spring(at)%alive(lane) = merge(WAITING, ALIVE, &
            batch%spring(i)%sensed .and. batch%spring(i)%flag /= 1)
         if (.not. batch%limited) cycle
         joint%limit(at)%k_block(lane, :) = batch%limit%k_block(i, :)
         do dof = 1, NDOF
            if (joint_types(batch%row)%free(dof) == 0) joint%limit(at)%flag(lane, dof) = DOF_BLOCKED
         end do
      end do
   end subroutine new_legacy_joint

end module kj_legacy_joint
