!> Which joint opens most, carries most, turns fastest, comes nearest to a stop: found on the way,
!> row
!> by row, while a history is written or read.
module kj_extremes
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use kj_kinds, only: wp
   use kj_channels, only: CH_TIME, CH_J_FORCE, CH_J_MOMENT, CH_J_ANGVEL, CH_J_VIOL_T, CH_J_VIOL_R, &
      CH_J_GAP, CH_J_GAP_ROT
   use kj_history, only: history_t
   implicit none
   private

   public :: extreme_t, extremes_t, watch_row

   !> The largest value of a channel, or the least way to a stop
   type :: extreme_t
      real(wp) :: value = 0.0_wp                 !! norm of a vector
      real(wp) :: time = 0.0_wp
      real(wp) :: force = 0.0_wp                 !! of the joint then, norm
      integer :: joint = 0                       !! place among the joints of the history; 0: none
   end type extreme_t

   !> Of all rows seen so far
   type :: extremes_t
      type(extreme_t) :: gap = extreme_t()       !! blocked displacement
      type(extreme_t) :: gap_rot = extreme_t()   !! blocked rotation [rad]
      type(extreme_t) :: force = extreme_t(), moment = extreme_t()
      type(extreme_t) :: turn = extreme_t()      !! angular velocity of end 2 relative to end 1
      !> Least way to a stop; below 0 beyond it
      type(extreme_t) :: margin = extreme_t(), margin_rot = extreme_t()
      !> (2, joints) largest blocked displacement and rotation of each
      real(wp), allocatable :: give(:, :)
   end type extremes_t

contains

   !> Look at one more row
   pure subroutine watch_row(history, row, x)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: row(:)             !! (history%n_value)
      type(extremes_t), intent(inout) :: x

      real(wp) :: time
      integer :: v, force_at

      time = 0.0_wp
      force_at = 0
      do v = 1, size(history%variable)
         associate (variable => history%variable(v))
            if (.not. allocated(x%give) .and. variable%channel == CH_J_FORCE) &
               allocate (x%give(2, variable%n_entity), source=0.0_wp)
            associate (y => row(variable%first:variable%first + variable%n_entity*variable%n_comp &
               - 1))
               select case (variable%channel)
               case (CH_TIME); time = y(1)
               case (CH_J_FORCE)
                  force_at = variable%first
                  call watch(y, 3, time, row, force_at, x%force)
               case (CH_J_MOMENT); call watch(y, 3, time, row, force_at, x%moment)
               case (CH_J_ANGVEL); call watch(y, 3, time, row, force_at, x%turn)
               case (CH_J_VIOL_T)
                  call watch(y, 1, time, row, force_at, x%gap)
                  if (allocated(x%give)) x%give(1, :) = max(x%give(1, :), y)
               case (CH_J_VIOL_R)
                  call watch(y, 1, time, row, force_at, x%gap_rot)
                  if (allocated(x%give)) x%give(2, :) = max(x%give(2, :), y)
               case (CH_J_GAP); call watch_least(y, time, x%margin)
               case (CH_J_GAP_ROT); call watch_least(y, time, x%margin_rot)
               end select
            end associate
         end associate
      end do
   end subroutine watch_row

   !> The largest norm of the joints
   pure subroutine watch(y, n_comp, time, row, force_at, extreme)
      real(wp), intent(in) :: y(:)               !! (n_comp joints)
      integer, intent(in) :: n_comp
      real(wp), intent(in) :: time, row(:)
      integer, intent(in) :: force_at            !! place of the forces in the row, 0 = none
      type(extreme_t), intent(inout) :: extreme

      real(wp) :: square, most
      integer :: j, at, best

      most = extreme%value**2
      best = 0
      do j = 1, size(y)/n_comp
         at = n_comp*(j - 1)
         if (n_comp == 1) then
            square = y(at + 1)**2
         else
            square = y(at + 1)**2 + y(at + 2)**2 + y(at + 3)**2
         end if
         if (.not. square > most) cycle
         most = square
         best = j
      end do
      if (best == 0) return
      extreme = extreme_t(sqrt(most), time, 0.0_wp, best)
      if (force_at > 0) extreme%force = norm2(row(force_at + 3*best - 3:force_at + 3*best - 1))
   end subroutine watch

   !> The least of what is a number: there is a stop only then
   pure subroutine watch_least(y, time, extreme)
      real(wp), intent(in) :: y(:)               !! (3 joints)
      real(wp), intent(in) :: time
      type(extreme_t), intent(inout) :: extreme

      integer :: i

      do i = 1, size(y)
         if (ieee_is_nan(y(i))) cycle
         if (extreme%joint > 0 .and. y(i) >= extreme%value) cycle
         extreme = extreme_t(y(i), time, 0.0_wp, (i + 2)/3)
      end do
   end subroutine watch_least

end module kj_extremes
