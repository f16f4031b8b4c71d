!> Axes of moving skews from the positions of their three nodes.
module kj_skew
   use kj_kinds, only: wp
   use kj_math3, only: cross, unit
   use kj_model, only: skew_set_t
   implicit none
   private

   public :: move_skews, skew_axes, axis_of

contains

   !> Renew the axes of the moving skews that the scene reads
   pure subroutine move_skews(skews, x, axes)
      type(skew_set_t), intent(in) :: skews
      real(wp), contiguous, intent(in) :: x(:, :)         !! (n_node, 3), W
      real(wp), intent(inout) :: axes(0:, :)              !! (0:n, 9) columns E1 E2 E3, W

      integer :: i, s

      do i = 1, size(skews%needed)
         s = skews%needed(i)
         axes(s, :) = skew_axes(skews%dir(s), x(skews%node(1, s), :), x(skews%node(2, s), :), &
            x(skews%node(3, s), :))
      end do
   end subroutine move_skews

   !> Axes of one moving skew.
   !>
   !> The axis `dir` runs from x1 to x2; x3 lies in the plane of that axis and the next one
   !> (x: y, y: z, z: x). /SKEW/MOV2 is the case dir = 3.
   !> Source: docs/theory/deck.md 8.
   pure function skew_axes(dir, x1, x2, x3) result(axes)
      integer, intent(in) :: dir                          !! 1 x, 2 y, 3 z
      real(wp), intent(in) :: x1(3), x2(3), x3(3)
      real(wp) :: axes(9)

      real(wp) :: first(3), second(3), third(3)
      integer :: k(3)

      first = x2 - x1
      third = cross(first, x3 - x1)
      second = cross(third, first)
      k = 3*(modulo([dir - 1, dir, dir + 1], 3)) + 1
      axes(k(1):k(1) + 2) = unit(first)
      axes(k(2):k(2) + 2) = unit(second)
      axes(k(3):k(3) + 2) = unit(third)
   end function skew_axes

   !> Axis 1-3 of a skew (4-6 mean the same axes for rotations); skew 0 is global
   pure function axis_of(axes, skew, dir) result(e)
      real(wp), intent(in) :: axes(0:, :)                 !! (0:n, 9)
      integer, intent(in) :: skew, dir
      real(wp) :: e(3)

      integer :: k

      k = 3*modulo(dir - 1, 3)
      e = axes(skew, k + 1:k + 3)
   end function axis_of

end module kj_skew
