!> When a sensor of time is on.
module kj_sensor
   use kj_kinds, only: wp
   implicit none
   private

   public :: is_on

contains

   !> The sensor is on in the cycle at t, as OpenRadioss has it: from the first cycle with t >= from
   !> on, and off for good from a later one with t >= to. Source: docs/theory/legacy.md 6.5.
   pure elemental logical function is_on(t, h1, from, to)
      real(wp), intent(in) :: t, h1              !! time of the cycle, and the step before it
      real(wp), intent(in) :: from, to           !! Tdelay, Tstop

      is_on = t >= from .and. (t < to .or. t - h1 < from)
   end function is_on

end module kj_sensor
