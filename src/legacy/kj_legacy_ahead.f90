!> What the next block of joints of a legacy batch reads, asked for while the present one is worked
!> on: in parts between its loops, as memory takes only some requests at a time.
module kj_legacy_ahead
   use kj_kinds, only: wp
   use kj_prefetch, only: prefetch
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: joint_batch_t, joint_state_t
   use kj_block, only: BLOCK
   implicit none
   private

   public :: ahead_t, next_block, prefetch_part

   !> Parts that come before these: 3 and 3 of the frames, 6 of the rates, 6 of the work, 6 of the
   !> forces, 3 of the ends
   integer, parameter, public :: AHEAD_FRAME = 0, AHEAD_AXES = 3, AHEAD_RATE = 6, AHEAD_WORK = 12, &
      AHEAD_FORCE = 18, AHEAD_END = 24

   !> A block to come
   type :: ahead_t
      integer :: from = 1, to = 0                 !! joints of the batch; none: no request
   end type ahead_t

contains

   !> The block of joint `from`, in scenes that are too large for the cache
   pure type(ahead_t) function next_block(batch, large, from) result(ahead)
      type(joint_batch_t), intent(in) :: batch
      logical, intent(in) :: large
      integer, intent(in) :: from

      if (large) ahead = ahead_t(from, min(from + BLOCK - 1, batch%n))
   end function next_block

   !> Ask for a part
   pure subroutine prefetch_part(ahead, part, batch, x, state)
      type(ahead_t), intent(in) :: ahead
      integer, intent(in) :: part
      type(joint_batch_t), intent(in) :: batch
      real(wp), contiguous, intent(in) :: x(:, :)         !! (n_node, 3)
      type(joint_state_t), intent(in) :: state

      integer :: k

      associate (from => ahead%from, to => ahead%to)
         if (to < from) return
         select case (part)
         case (AHEAD_FRAME + 1:AHEAD_FRAME + 3)
            call prefetch(from, to, state%e(:, part - AHEAD_FRAME))
         case (AHEAD_AXES + 1:AHEAD_AXES + 3)
            k = 3 + 2*(part - AHEAD_AXES)
            call prefetch(from, to, state%e(:, k - 1:k))
         case (AHEAD_RATE + 1:AHEAD_RATE + NDOF)
            k = part - AHEAD_RATE
            call prefetch(from, to, state%q(:, k))
            if (batch%law(k) /= 0) call prefetch(from, to, batch%k(:, k))
         case (AHEAD_WORK + 1:AHEAD_WORK + NDOF)
            k = part - AHEAD_WORK
            if (batch%law(k) /= 0) call prefetch(from, to, state%f(:, k))
         case (AHEAD_FORCE + 1:AHEAD_FORCE + NDOF)
            k = part - AHEAD_FORCE
            if (batch%law(k) /= 0) call prefetch(from, to, batch%c(:, k))
         case (AHEAD_END + 1)
            call prefetch(from, to, batch%xl0)
            call prefetch(from, to, state%energy)
            call prefetch(from, to, state%stiff)
         case (AHEAD_END + 2)
            call prefetch(from, to, batch%node)
            call prefetch(from, to, batch%lead)
         case (AHEAD_END + 3)
            do k = 1, 2                              ! the ends of joints mostly lie side by side
               call prefetch(batch%node(from, k), batch%node(from, k) + to - from, x)
            end do
         end select
      end associate
   end subroutine prefetch_part

end module kj_legacy_ahead
