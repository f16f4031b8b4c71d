!> Small dense algebra of 3-vectors and rotations. Matrices are 3x3, columns are axes.
module kj_math3
   use kj_kinds, only: wp
   implicit none
   private

   public :: cross, unit, solve_small, rotation, rotation_vector, to_quaternion, to_quaternions, &
      quaternion_product, inverse3, turn_coefficients, angles

   real(wp), parameter, public :: IDENTITY(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

   real(wp), parameter :: LARGE_TURN = 0.0625_wp   !! square of the angle where the series ends

   ! series of sin(a)/a and (1 - cos a)/a^2: (-1)^k/(2k + 1)! and (-1)^k/(2k + 2)!
   real(wp), parameter :: S1 = -1.0_wp/6.0_wp, S2 = 1.0_wp/120.0_wp, S3 = -1.0_wp/5040.0_wp, &
      S4 = 1.0_wp/362880.0_wp, S5 = -1.0_wp/39916800.0_wp
   real(wp), parameter :: C1 = -1.0_wp/24.0_wp, C2 = 1.0_wp/720.0_wp, C3 = -1.0_wp/40320.0_wp, &
      C4 = 1.0_wp/3628800.0_wp, C5 = -1.0_wp/479001600.0_wp

   ! (1 - atan(t)/t)/t^2 as a polynomial of t^2, |t| <= tan(pi/8)
   real(wp), parameter :: TAN_PI_8 = 0.41421356237309504880_wp
   real(wp), parameter :: QUARTER_PI = 0.78539816339744830962_wp
   real(wp), parameter :: P0 = 0.3333333333333333016_wp, P1 = -0.19999999999995520678_wp, &
      P2 = 0.14285714284666542922_wp, P3 = -0.11111111015256361727_wp, &
      P4 = 0.090909045781239018905_wp, P5 = -0.076921831908260865637_wp, &
      P6 = 0.066645114473819480001_wp, P7 = -0.058581489128022098816_wp, &
      P8 = 0.050854497379402598613_wp, P9 = -0.039231658295587191303_wp, &
      P10 = 0.019176887119062258989_wp

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

      length = sqrt((a(1)*a(1) + a(2)*a(2)) + a(3)*a(3))   ! not norm2: the bits of OpenRadioss
      u = a
      if (length > 0.0_wp) u = a/length
   end function unit

   !> sin(a)/a and (1 - cos a)/a^2 from a^2, for a block: series below a = 1/4 (error under 1e-17),
   !> libm above. An element's bits do not depend on its neighbours.
   pure subroutine turn_coefficients(n, a2, s, c)
      integer, value :: n
      real(wp), intent(in) :: a2(n)             !! squares of the angles [rad^2]
      real(wp), intent(out) :: s(n), c(n)

      real(wp) :: a4
      integer :: i
      logical :: large

      large = .false.
      !$omp simd private(a4) reduction(.or.:large)
      do i = 1, n
         ! Estrin's scheme: with few joints all waits for these
         a4 = a2(i)*a2(i)
         s(i) = 1.0_wp + a2(i)*((S1 + a2(i)*S2) + a4*((S3 + a2(i)*S4) + a4*S5))
         c(i) = 0.5_wp + a2(i)*((C1 + a2(i)*C2) + a4*((C3 + a2(i)*C4) + a4*C5))
         large = large .or. a2(i) >= LARGE_TURN
      end do
      if (large) call large_turns(n, a2, s, c)
   end subroutine turn_coefficients

   !> The same of the large turns of a block
   pure subroutine large_turns(n, a2, s, c)
      integer, value :: n
      real(wp), intent(in) :: a2(n)
      real(wp), intent(inout) :: s(n), c(n)

      real(wp) :: a
      integer :: i

      do i = 1, n
         if (a2(i) < LARGE_TURN) cycle
         a = sqrt(a2(i))
         s(i) = sin(a)/a
         c(i) = 2.0_wp*(sin(0.5_wp*a)/a)**2
      end do
   end subroutine large_turns

   !> atan2(y, x) of a block without a branch, in (-pi, pi]; error under 3e-16.
   !>
   !> The smaller over the larger coordinate t is brought below tan(pi/8) by
   !> atan t = pi/4 + atan((t - 1)/(t + 1)); there atan t = t - t^3 P(t^2), P the Chebyshev fit of
   !> degree 10 (error 5e-18 of the angle).
   pure subroutine angles(n, y, x, a)
      integer, value :: n
      real(wp), intent(in) :: y(n), x(n)
      real(wp), intent(out) :: a(n)             !! [rad]; 0 where x and y are

      real(wp) :: low, high, num, den, t, z, r
      integer :: i

      !$omp simd private(low, high, num, den, t, z, r)
      do i = 1, n
         low = min(abs(x(i)), abs(y(i)))
         high = max(abs(x(i)), abs(y(i)))
         num = merge(low - high, low, low > TAN_PI_8*high)
         den = merge(low + high, max(high, tiny(high)), low > TAN_PI_8*high)
         t = num/den
         z = t*t
         r = P5 + z*(P6 + z*(P7 + z*(P8 + z*(P9 + z*P10))))
         r = P0 + z*(P1 + z*(P2 + z*(P3 + z*(P4 + z*r))))
         r = t - t*(z*r)
         r = merge(QUARTER_PI + r, r, low > TAN_PI_8*high)
         r = merge(2.0_wp*QUARTER_PI - r, r, abs(y(i)) > abs(x(i)))
         r = merge(4.0_wp*QUARTER_PI - r, r, x(i) < 0.0_wp)
         a(i) = sign(r, y(i))
      end do
   end subroutine angles

   !> x := a^-1 x of the first n unknowns, by elimination; ok is false for a singular matrix
   pure subroutine solve_small(n, a, x, ok)
      integer, value :: n                  !! 1 to 3
      real(wp), intent(in) :: a(3, 3)
      real(wp), intent(inout) :: x(3)
      logical, intent(out) :: ok

      real(wp) :: u(3, 4), row(4), factor
      integer :: i, j, p

      u(:, :3) = a
      u(:, 4) = x
      ok = .false.
      do j = 1, n
         p = j
         do i = j + 1, n
            if (abs(u(i, j)) > abs(u(p, j))) p = i
         end do
         if (.not. abs(u(p, j)) > 0.0_wp) return
         row = u(p, :)
         u(p, :) = u(j, :)
         u(j, :) = row
         do i = j + 1, n
            factor = u(i, j)/u(j, j)
            u(i, j + 1:) = u(i, j + 1:) - factor*u(j, j + 1:)
         end do
      end do
      do j = n, 1, -1
         x(j) = u(j, 4)
         do i = j + 1, n
            x(j) = x(j) - u(j, i)*x(i)
         end do
         x(j) = x(j)/u(j, j)
      end do
      ok = .true.
   end subroutine solve_small

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

   !> Product of two quaternions (w, x, y, z): the turn b, then the turn a
   pure function quaternion_product(a, b) result(c)
      real(wp), intent(in) :: a(4), b(4)
      real(wp) :: c(4)

      c(1) = a(1)*b(1) - dot_product(a(2:4), b(2:4))
      c(2:4) = a(1)*b(2:4) + b(1)*a(2:4) + cross(a(2:4), b(2:4))
   end function quaternion_product

   !> Unit quaternion (w, x, y, z), w >= 0, of a rotation matrix
   pure function to_quaternion(r) result(q)
      real(wp), intent(in) :: r(3, 3)
      real(wp) :: q(4)

      call to_quaternions(1, r, q)
   end function to_quaternion

   !> The same of a block of rotation matrices without a branch: of the four multiples of each
   !> quaternion that a matrix has, that of the largest component (Shepperd)
   pure subroutine to_quaternions(n, r, q)
      integer, value :: n
      real(wp), intent(in) :: r(n, 9)           !! their columns
      real(wp), intent(out) :: q(n, 4)

      real(wp) :: trace, wx, wy, wz, xy, xz, yz, scale
      logical :: w, x, y
      integer :: i

      !$omp simd private(trace, wx, wy, wz, xy, xz, yz, scale, w, x, y)
      do i = 1, n
         trace = r(i, 1) + r(i, 5) + r(i, 9)
         wx = r(i, 6) - r(i, 8)
         wy = r(i, 7) - r(i, 3)
         wz = r(i, 2) - r(i, 4)
         xy = r(i, 2) + r(i, 4)
         xz = r(i, 3) + r(i, 7)
         yz = r(i, 6) + r(i, 8)
         w = trace >= max(r(i, 1), r(i, 5), r(i, 9))
         x = r(i, 1) >= max(r(i, 5), r(i, 9))
         y = r(i, 5) >= r(i, 9)
         q(i, 1) = merge(1.0_wp + trace, merge(wx, merge(wy, wz, y), x), w)
         q(i, 2) = merge(wx, merge(1.0_wp + 2.0_wp*r(i, 1) - trace, merge(xy, xz, y), x), w)
         q(i, 3) = merge(wy, merge(xy, merge(1.0_wp + 2.0_wp*r(i, 5) - trace, yz, y), x), w)
         q(i, 4) = merge(wz, merge(xz, merge(yz, 1.0_wp + 2.0_wp*r(i, 9) - trace, y), x), w)
         scale = sqrt(q(i, 1)**2 + q(i, 2)**2 + q(i, 3)**2 + q(i, 4)**2)
         scale = 1.0_wp/merge(-scale, scale, q(i, 1) < 0.0_wp)
         q(i, 1) = scale*q(i, 1)
         q(i, 2) = scale*q(i, 2)
         q(i, 3) = scale*q(i, 3)
         q(i, 4) = scale*q(i, 4)
      end do
   end subroutine to_quaternions

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
