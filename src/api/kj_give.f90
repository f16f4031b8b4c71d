!> Warnings at the end of a run where joints gave way so much that the mechanism moved otherwise
!> than the deck means it.
module kj_give
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, add_finding, str, SEV_WARNING
   use kj_channels, only: OF_JOINT
   use kj_model, only: model_t
   use kj_history, only: history_t, entity_title
   use kj_extremes, only: extremes_t
   implicit none
   private

   public :: warn_give

   real(wp), parameter :: MOST = 0.01_wp         !! of an arm; as much for a turn [rad]

contains

   !> One for each joint of the history whose ends moved apart by more than 1 % of its longer
   !> arm, or turned apart by 0.01 rad, in a blocked direction
   subroutine warn_give(model, history, x, findings)
      type(model_t), intent(in) :: model
      type(history_t), intent(in) :: history
      type(extremes_t), intent(in) :: x
      type(finding_list_t), intent(inout) :: findings

      character(len=:), allocatable :: title
      real(wp) :: arm
      integer :: k

      if (.not. allocated(x%give)) return
      do k = 1, size(x%give, 2)
         arm = longer_arm(model, model%joint(model%th_joint(k))%node)
         title = 'joint '//entity_title(history, OF_JOINT, k)//' gave way by '
         if (x%give(1, k) > MOST*arm .and. arm > 0.0_wp) then
            call warn(title//str(nint(min(1.0e9_wp, 100.0_wp*x%give(1, k)/arm)))// &
               ' % of its arm, '//two(x%give(1, k))// &
               ' of '//two(arm))
         else if (x%give(2, k) > MOST) then
            call warn(title//two(x%give(2, k))//' rad in a blocked rotation')
         end if
      end do

   contains

      subroutine warn(message)
         character(len=*), intent(in) :: message

         type(error_t) :: finding

         finding%severity = SEV_WARNING
         finding%id = 'KJ-9302'
         finding%message = message
         finding%hint = 'raise Kn, or read the results with that in mind'
         call add_finding(findings, finding)
      end subroutine warn
   end subroutine warn_give

   !> The longer distance of a joint node from the centre of its body; 0 where both are centres
   pure real(wp) function longer_arm(model, node) result(arm)
      type(model_t), intent(in) :: model
      integer, intent(in) :: node(2)

      integer :: e

      arm = 0.0_wp
      do e = 1, 2
         arm = max(arm, norm2(model%x0(node(e), :) - model%x0(model%lead(node(e)), :)))
      end do
   end function longer_arm

   !> Two digits: "4.1E-02"
   pure function two(value) result(text)
      real(wp), intent(in) :: value
      character(len=7) :: text

      write (text, '(es7.1)') value
   end function two

end module kj_give
