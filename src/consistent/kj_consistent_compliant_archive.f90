!> The state of the integrator `compliant` in a checkpoint. What a step finds anew is left out: the
!> matrix, the leads at the start of a step.
module kj_consistent_compliant_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use kj_archive, only: archive_t, keep, keep_blocks
   use kj_consistent_compliant_types, only: compliant_t
   use kj_consistent_compliant_march, only: pace_t
   implicit none
   private

   public :: keep_compliant, keep_pace

contains

   !> Multipliers and rows of the joints, and what the next step goes on with
   subroutine keep_compliant(self, state)
      type(archive_t), intent(inout) :: self
      type(compliant_t), allocatable, target, intent(inout) :: state

      integer :: b

      if (.not. allocated(state)) return
      do b = 1, size(state%joint)
         associate (block_of => state%joint(b)%block)
            call keep_blocks(self, c_loc(block_of(1)), size(block_of), storage_size(block_of))
         end associate
      end do
      call keep(self, state%h_factor)
      call keep(self, state%h_last)
      call keep(self, state%h_stiff)
      call keep(self, state%known)
      call keep(self, state%h_known)
      call keep(self, state%renewed)
      call keep(self, state%jump)
      call keep(self, state%force)
      call keep(self, state%e_way)
      call keep(self, state%e_turn)
      call keep(self, state%passes)
      call keep(self, state%joint_worst)
      call keep(self, state%failed)
      call keep(self, state%loss)
      call keep(self, state%kinetic)
      state%factored = .false.
   end subroutine keep_compliant

   !> Where the step control stands, but for its bound
   subroutine keep_pace(self, pace)
      type(archive_t), intent(inout) :: self
      type(pace_t), intent(inout) :: pace

      call keep(self, pace%rigid)
      call keep(self, pace%tolerance)
      call keep(self, pace%turn)
      call keep(self, pace%factor)
      call keep(self, pace%most)
      call keep(self, pace%first)
      call keep(self, pace%h_error)
      call keep(self, pace%h_turn)
      call keep(self, pace%h_bound)
      call keep(self, pace%h_stop)
      call keep(self, pace%limited)
      call keep(self, pace%able)
      call keep(self, pace%paired)
      call keep(self, pace%c)
      call keep(self, pace%limit)
      call keep(self, pace%owner)
      call keep(self, pace%span)
      call keep(self, pace%event)
      call keep(self, pace%target)
      call keep(self, pace%h)
      call keep(self, pace%left)
      call keep(self, pace%since)
      call keep(self, pace%drift)
      call keep(self, pace%failed)
      call keep(self, pace%longest)
      call keep(self, pace%crawled)
      call keep(self, pace%tries)
      call keep(self, pace%passes)
      call keep(self, pace%halvings)
      call keep(self, pace%rejected)
   end subroutine keep_pace

end module kj_consistent_compliant_archive
