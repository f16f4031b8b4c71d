!> The state of a legacy scene, field by field: THE list that checkpoints save and restore.
!> tests/cli/test_fields.py compares it with the types.
module kj_legacy_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use kj_archive, only: archive_t, keep, keep_blocks
   use kj_gravity, only: keep_gravity
   use kj_legacy_force, only: world_t
   use kj_legacy_joint, only: legacy_joint_t
   use kj_legacy_state, only: legacy_state_t
   implicit none
   private

   public :: keep_legacy

contains

   !> A state that was made for the same model
   subroutine keep_legacy(self, state)
      type(archive_t), intent(inout) :: self
      type(legacy_state_t), intent(inout) :: state

      integer :: i

      if (.not. allocated(state%joint)) return   ! the other formulation runs
      ! not here, as the model makes them: team, crew, jointed, sprung, on_main, idle_limit
      call keep(self, state%cycle)
      call keep(self, state%time)
      call keep(self, state%h1)
      call keep(self, state%h2)
      call keep(self, state%h12)
      call keep(self, state%h_old)
      call keep(self, state%owner_kind)
      call keep(self, state%owner)
      call keep(self, state%ended)
      call keep(self, state%sampling)
      call keep(self, state%weighed)
      call keep(self, state%spin_gain)
      call keep(self, state%spin_top)
      call keep(self, state%spin_angle)
      call keep(self, state%summed_error)
      call keep(self, state%summed_joint)
      call keep_world(self, state%world)
      call keep(self, state%d)
      call keep(self, state%v)
      call keep(self, state%a)
      call keep(self, state%al)
      call keep(self, state%f)
      call keep(self, state%m)
      call keep(self, state%f_own)
      call keep(self, state%m_own)
      call keep(self, state%f_host)
      call keep(self, state%m_host)
      call keep(self, state%kn)
      call keep(self, state%kr)
      call keep(self, state%mass)
      call keep(self, state%inertia)
      call keep(self, state%least)
      call keep(self, state%least_at)
      call keep(self, state%fastest)
      call keep(self, state%finite)
      call keep(self, state%placed)
      call keep(self, state%kept)
      call keep(self, state%p)
      call keep(self, state%principal)
      call keep(self, state%impulse)
      call keep(self, state%angular_impulse)
      call keep(self, state%rotation_sum)
      call keep(self, state%w_before)
      call keep(self, state%bcs_of)
      do i = 1, size(state%joint)
         call keep_joint(self, state%joint(i))
      end do
      call keep(self, state%wrench)
      call keep(self, state%part)
      do i = 1, size(state%field)
         call keep_gravity(self, state%field(i))
      end do
      call keep(self, state%motion_power)
      call keep(self, state%load_abscissa)
      call keep(self, state%load_turn)
      call keep(self, state%motion_turn)
      call keep(self, state%power)
      call keep(self, state%work)
      call keep(self, state%energy0)
   end subroutine keep_legacy

   subroutine keep_world(self, world)
      type(archive_t), intent(inout) :: self
      type(world_t), intent(inout) :: world

      call keep(self, world%time)
      call keep(self, world%h12)
      call keep(self, world%x)
      call keep(self, world%w)
      call keep(self, world%skew)
   end subroutine keep_world

   !> Blocks as a whole
   subroutine keep_joint(self, joint)
      type(archive_t), intent(inout) :: self
      type(legacy_joint_t), target, intent(inout) :: joint

      call keep_blocks(self, c_loc(joint%block(1)), size(joint%block), storage_size(joint%block))
      if (allocated(joint%limit)) &
         call keep_blocks(self, c_loc(joint%limit(1)), size(joint%limit), storage_size(joint%limit))
      if (allocated(joint%spring)) &
         call keep_blocks(self, c_loc(joint%spring(1)), size(joint%spring), &
            storage_size(joint%spring))
   end subroutine keep_joint

end module kj_legacy_archive
