!> ISO/TS 18571 ratings of the channels of a comparison: they need whole curves, so that the two
!> files are walked through again for as many curves at a time as fit in memory.
module kj_diff_rating
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_history, only: text_t
   use kj_metrics, only: M_ISO_Z, M_ISO_P, M_ISO_M, M_ISO_S, M_ISO
   use kj_iso18571, only: iso18571_t, rate_iso18571
   use kj_diff_types, only: channel_result_t
   use kj_diff_walk, only: walk_t, start_walk, next_pair
   implicit none
   private

   public :: rate_channels

   integer, parameter :: MOST_SAMPLES = 10000     !! the cost grows with their square
   integer, parameter :: MOST_REALS = 2**23       !! of curves in memory

contains

   !> Rate every number of every channel that both sides have
   !>
   !> Of more than MOST_SAMPLES samples every second, third, ... is taken, and a note says so.
   !> Errors: ERR_FILE.
   subroutine rate_channels(walk, list, note, error)
      type(walk_t), intent(inout) :: walk
      type(channel_result_t), intent(inout) :: list(:)
      type(text_t), allocatable, intent(inout) :: note(:)
      type(error_t), allocatable, intent(out) :: error

      type(text_t), allocatable :: longer(:)
      integer :: channel(sum(list%n_comp)), comp(sum(list%n_comp)), i, k, n, step, n_kept, most

      if (walk%n_pair == 0) return
      n = 0
      do i = 1, size(list)
         if (list(i)%run_at == 0) cycle
         do k = 1, list(i)%n_comp
            n = n + 1
            channel(n) = i
            comp(n) = k
         end do
      end do
      step = 1 + (walk%n_pair - 1)/MOST_SAMPLES
      n_kept = 1 + (walk%n_pair - 1)/step
      if (step > 1) then
         allocate (longer(size(note) + 1))
         longer(:size(note)) = note
         longer(size(longer))%s = 'iso18571: one of '//str(step)//' samples is rated'
         call move_alloc(longer, note)
      end if
      most = max(1, MOST_REALS/(2*n_kept))
      do i = 1, n, most
         k = min(n, i + most - 1)
         call rate_curves(walk, step, n_kept, channel(i:k), comp(i:k), list, error)
         if (allocated(error)) return
      end do
   end subroutine rate_channels

   !> Collect some curves in a walk and rate them
   subroutine rate_curves(walk, step, n_kept, channel, comp, list, error)
      type(walk_t), intent(inout) :: walk
      integer, intent(in) :: step, n_kept                !! one sample of `step`; samples taken
      integer, intent(in) :: channel(:), comp(:)         !! place in `list`, number of the channel
      type(channel_result_t), intent(inout) :: list(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: x(:, :), y(:, :)          !! (n_kept, curves)
      type(iso18571_t) :: rating
      logical :: found
      integer :: i, n

      allocate (x(n_kept, size(channel)), y(n_kept, size(channel)))
      call start_walk(walk, error)
      do
         if (allocated(error)) return
         call next_pair(walk, found, error)
         if (allocated(error)) return
         if (.not. found) exit
         if (mod(walk%n_pair - 1, step) /= 0) cycle
         n = 1 + (walk%n_pair - 1)/step
         do i = 1, size(channel)
            x(n, i) = walk%x(list(channel(i))%ref_at + comp(i) - 1)
            y(n, i) = walk%y(list(channel(i))%run_at + comp(i) - 1)
         end do
      end do
      do i = 1, size(channel)
         call rate_iso18571(x(:, i), y(:, i), rating)
         associate (m => list(channel(i))%metric)
            m(M_ISO_Z, comp(i)) = rating%corridor
            m(M_ISO_P, comp(i)) = rating%phase
            m(M_ISO_M, comp(i)) = rating%magnitude
            m(M_ISO_S, comp(i)) = rating%slope
            m(M_ISO, comp(i)) = rating%overall
         end associate
      end do
   end subroutine rate_curves

end module kj_diff_rating
