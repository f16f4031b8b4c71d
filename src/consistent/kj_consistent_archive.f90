!> The state of a consistent scene, field by field: THE list that checkpoints save and restore.
!> tests/cli/test_fields.py compares it with the types.
module kj_consistent_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use kj_archive, only: archive_t, keep, keep_blocks
   use kj_gravity, only: keep_gravity
   use kj_consistent_matrix, only: poses_t
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_safe_step, only: bound_t
   use kj_consistent_impact_step, only: contact_t
   use kj_consistent_state, only: consistent_state_t, kept_t
   use kj_consistent_march, only: march_t
   use kj_consistent_compliant_archive, only: keep_compliant, keep_pace
   implicit none
   private

   public :: keep_state, keep_march

contains

   !> A state that was made for the same model; not here, as each step finds them: mean, final,
   !> active, stages; lambda of the bound is a place to work
   subroutine keep_state(self, state)
      type(archive_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      if (.not. allocated(state%joint)) return   ! the other formulation runs
      call keep(self, state%cycle)
      call keep(self, state%time)
      call keep(self, state%h)
      call keep_poses(self, state%poses)
      call keep(self, state%v)
      call keep(self, state%l)
      call keep(self, state%f)
      call keep(self, state%t)
      call keep(self, state%own_f)
      call keep(self, state%own_t)
      call keep(self, state%f_host)
      call keep(self, state%t_host)
      call keep(self, state%f_host_old)
      call keep(self, state%t_host_old)
      call keep(self, state%f_ahead)
      call keep(self, state%t_ahead)
      call keep(self, state%impulse)
      call keep(self, state%angular_impulse)
      call keep(self, state%turn)
      call keep(self, state%node)
      call keep(self, state%skew)
      call keep_kept(self, state%kept)
      do i = 1, size(state%joint)
         call keep_joint(self, state%joint(i))
      end do
      call keep(self, state%wrench)
      call keep(self, state%part)
      call keep(self, state%motion_at)
      call keep(self, state%load_force)
      call keep(self, state%load_place)
      do i = 1, size(state%field)
         call keep_gravity(self, state%field(i))
      end do
      call keep_compliant(self, state%compliant)
      call keep(self, state%work)
      call keep(self, state%by_steps)
      call keep(self, state%s0)
      call keep(self, state%offset)
      call keep(self, state%energy)
      call keep(self, state%change)
      call keep(self, state%scale)
      call keep(self, state%error)
   end subroutine keep_state

   subroutine keep_poses(self, poses)
      type(archive_t), intent(inout) :: self
      type(poses_t), intent(inout) :: poses

      call keep(self, poses%time(1))
      call keep(self, poses%h(1))
      poses%time = poses%time(1)
      poses%h = poses%h(1)
      call keep(self, poses%x)
      call keep(self, poses%d)
      call keep(self, poses%quat)
      call keep(self, poses%v)
      call keep(self, poses%w)
      call keep(self, poses%w_left)
      call keep(self, poses%psi)
      call keep(self, poses%im)
      call keep(self, poses%ij)
   end subroutine keep_poses

   subroutine keep_kept(self, kept)
      type(archive_t), intent(inout) :: self
      type(kept_t), intent(inout) :: kept

      call keep(self, kept%rates)
      call keep(self, kept%quat)
      call keep(self, kept%w)
      call keep(self, kept%work)
   end subroutine keep_kept

   !> Blocks as a whole
   subroutine keep_joint(self, joint)
      type(archive_t), intent(inout) :: self
      type(consistent_joint_t), target, intent(inout) :: joint

      call keep_blocks(self, c_loc(joint%block(1)), size(joint%block), storage_size(joint%block))
      if (allocated(joint%limit)) &
         call keep_blocks(self, c_loc(joint%limit(1)), size(joint%limit), storage_size(joint%limit))
      if (allocated(joint%spring)) &
         call keep_blocks(self, c_loc(joint%spring(1)), size(joint%spring), &
            storage_size(joint%spring))
   end subroutine keep_joint

   !> Where the march stands
   subroutine keep_march(self, march)
      type(archive_t), intent(inout) :: self
      type(march_t), intent(inout) :: march

      call keep(self, march%integrator)
      call keep(self, march%nodal)
      call keep(self, march%factor)
      call keep(self, march%most)
      call keep(self, march%first)
      call keep(self, march%limit)
      call keep(self, march%start_end)
      call keep(self, march%starting)
      call keep(self, march%joint)
      call keep_bound(self, march%bound)
      call keep_contact(self, march%contact)
      call keep_pace(self, march%pace)
      call keep_bound(self, march%pace%bound)
      call keep(self, march%t_end)
      call keep(self, march%h)
      call keep(self, march%left)
      call keep(self, march%since)
      call keep(self, march%age)
   end subroutine keep_march

   subroutine keep_bound(self, bound)
      type(archive_t), intent(inout) :: self
      type(bound_t), intent(inout) :: bound

      call keep(self, bound%h)
      call keep(self, bound%joint)
      call keep(self, bound%share)
      call keep(self, bound%k)
      call keep(self, bound%c)
      call keep(self, bound%limit)
      call keep(self, bound%q)
      call keep(self, bound%reach)
      call keep(self, bound%rows)
   end subroutine keep_bound

   subroutine keep_contact(self, contact)
      type(archive_t), intent(inout) :: self
      type(contact_t), intent(inout) :: contact

      call keep(self, contact%h)
      call keep(self, contact%h_stop)
      call keep(self, contact%until)
      call keep(self, contact%h_wind)
      call keep(self, contact%until_wind)
   end subroutine keep_contact

end module kj_consistent_archive
