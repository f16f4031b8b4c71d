!> Mass and inertia of shells and triangles at their nodes. Source: docs/theory/full.md 2.1.
module kj_shell_mass
   use kj_kinds, only: wp
   use kj_math3, only: cross
   implicit none
   private

   public :: shell_area, triangle_area, triangle_shares, shell_inertia

contains

   !> Half of the cross product of the diagonals, for warped shells too
   pure real(wp) function shell_area(x) result(area)
      real(wp), intent(in) :: x(3, 4)

      area = 0.5_wp*norm2(cross(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2)))
   end function shell_area

   !> Half of the cross product of two sides
   pure real(wp) function triangle_area(x) result(area)
      real(wp), intent(in) :: x(3, 3)

      area = 0.5_wp*norm2(cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1)))
   end function triangle_area

   !> Share of each node of a triangle: its angle over pi
   pure function triangle_shares(x) result(share)
      real(wp), intent(in) :: x(3, 3)
      real(wp) :: share(3)

      real(wp) :: u(3), v(3)
      integer :: i

      do i = 1, 3
         u = x(:, modulo(i, 3) + 1) - x(:, i)
         v = x(:, modulo(i + 1, 3) + 1) - x(:, i)
         share(i) = atan2(norm2(cross(u, v)), dot_product(u, v))/acos(-1.0_wp)
      end do
   end function triangle_shares

   !> Inertia over mass of a layer: A/f + t^2/12 + z^2
   pure real(wp) function shell_inertia(area, f, t, z) result(per_mass)
      real(wp), intent(in) :: area
      real(wp), intent(in) :: f                  !! 9, of fine shells 12, of triangles 4.5
      real(wp), intent(in) :: t, z               !! thickness of the layer, place of its middle

      per_mass = area/f + t**2/12.0_wp + z**2
   end function shell_inertia

end module kj_shell_mass
