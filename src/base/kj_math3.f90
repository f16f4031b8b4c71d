!> Small dense algebra of 3-vectors and rotations. Matrices are 3x3, columns are axes.
module kj_math3
   use kj_kinds, only: wp
   implicit none
   private

   public :: cross, unit, rotation, rotation_vector, to_quaternion, inverse3, turn_coefficients

   real(wp), parameter, public :: IDENTITY(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

   real(wp), parameter :: LARGE_TURN = 0.0625_wp   !! square of the angle where the series ends

contains

   !> a x b
   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> a/|a|; the zero vector stays zero
   pure function unit(a) result(u)
      real(wp), intent(in) :: a(3)
      real(wp) :: u(3)

      real(wp) :: length

      length = norm2(a)
      u = a
      if (length > 0.0_wp) u = a/length
   end function unit

   !> sin(a)/a and (1 - cos a)/a^2 from a^2, for a block: series below a = 1/4 (error under 1e-17),
   !> libm above. An element's bits do not depend on its neighbours.
   pure subroutine turn_coefficients(n, a2, s, c)
      integer, intent(in) :: n
      real(wp), intent(in) :: a2(n)             !! squares of the angles [rad^2]
      real(wp), intent(out) :: s(n), c(n)

      real(wp) :: a
      integer :: i

      !$omp simd
      do i = 1, n
         s(i) = 1.0_wp - a2(i)/6.0_wp*(1.0_wp - a2(i)/20.0_wp*(1.0_wp - a2(i)/42.0_wp* &
            (1.0_wp - a2(i)/72.0_wp*(1.0_wp - a2(i)/110.0_wp))))
         c(i) = 0.5_wp*(1.0_wp - a2(i)/12.0_wp*(1.0_wp - a2(i)/30.0_wp*(1.0_wp - a2(i)/56.0_wp* &
            (1.0_wp - a2(i)/90.0_wp*(1.0_wp - a2(i)/132.0_wp)))))
      end do
      if (.not. any(a2 >= LARGE_TURN)) return
      do i = 1, n
         if (a2(i) < LARGE_TURN) cycle
         a = sqrt(a2(i))
         s(i) = sin(a)/a
         c(i) = 2.0_wp*(sin(0.5_wp*a)/a)**2
      end do
   end subroutine turn_coefficients

   !> Exp of a rotation vector [rad] (Rodrigues)
   pure function rotation(phi) result(r)
      real(wp), intent(in) :: phi(3)
      real(wp) :: r(3, 3)

      real(wp) :: s(1), c(1)
      integer :: j

      call turn_coefficients(1, [dot_product(phi, phi)], s, c)
      do j = 1, 3
         r(:, j) = IDENTITY(:, j) + s(1)*cross(phi, IDENTITY(:, j)) + &
            c(1)*cross(phi, cross(phi, IDENTITY(:, j)))
      end do
   end function rotation

   !> Unit quaternion (w, x, y, z), w >= 0, of a rotation matrix (Shepperd's choice of pivot)
   pure function to_quaternion(r) result(q)
      real(wp), intent(in) :: r(3, 3)
      real(wp) :: q(4)

      real(wp) :: trace
      integer :: i, j, k

      trace = r(1, 1) + r(2, 2) + r(3, 3)
      i = maxloc([trace, r(1, 1), r(2, 2), r(3, 3)], dim=1) - 1
      if (i == 0) then
         q = [1.0_wp + trace, r(3, 2) - r(2, 3), r(1, 3) - r(3, 1), r(2, 1) - r(1, 2)]
      else
         j = modulo(i, 3) + 1
         k = modulo(j, 3) + 1
         q(1) = r(k, j) - r(j, k)
         q(1 + i) = 1.0_wp + 2.0_wp*r(i, i) - trace
         q(1 + j) = r(j, i) + r(i, j)
         q(1 + k) = r(k, i) + r(i, k)
      end if
      q = q/norm2(q)
      if (q(1) < 0.0_wp) q = -q
   end function to_quaternion

   !> Log of a rotation matrix: axis times angle, angle in [0, pi]
   pure function rotation_vector(r) result(phi)
      real(wp), intent(in) :: r(3, 3)
      real(wp) :: phi(3)

      real(wp) :: q(4), s

      q = to_quaternion(r)
      s = norm2(q(2:4))
      phi = 2.0_wp*q(2:4)
      if (s > 1.0e-8_wp) phi = 2.0_wp*atan2(s, q(1))/s*q(2:4)
   end function rotation_vector

   !> Inverse of a regular 3x3 matrix by cofactors; singular is false with a zero determinant
   pure subroutine inverse3(a, b, regular)
      real(wp), intent(in) :: a(3, 3)
      real(wp), intent(out) :: b(3, 3)
      logical, intent(out) :: regular

      real(wp) :: det

      b(1, :) = cross(a(:, 2), a(:, 3))
      b(2, :) = cross(a(:, 3), a(:, 1))
      b(3, :) = cross(a(:, 1), a(:, 2))
      det = dot_product(a(:, 1), b(1, :))
      regular = abs(det) > 0.0_wp
      if (regular) b = b/det
   end subroutine inverse3

end module kj_math3
