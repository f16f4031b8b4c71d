!> Consistent joint coordinates of a block of joints: from the poses of the two ends to the
!> coordinates q and the matrix B of q' = B u, for each chart of the rotations.
!>
!> A row of B is kept as what a unit force along that coordinate does (the generalised force is
!> -B^T F): for translation k the force E(:, k) on node 1 (and the opposite on node 2) and the
!> couples A1(:, k), A2(:, k) on the bodies of node 1 and 2, next to those of the arms; for rotation
!> k the moment R(:, k) on body 1 and the opposite on body 2. Matrices are 9 columns; all vectors W.
!> Source: consistent.md 1.
module kj_c_chart
   use kj_kinds, only: wp
   use kj_joint_frame, only: BLOCK
   implicit none
   private

   public :: relative_pose, twist_chart, vector_chart, universal_chart, first_skew, quaternion_frame

   real(wp), parameter :: TWO_PI = 6.28318530717958647692528676656_wp

contains

   !> Triads carried by the two bodies and the turn between them: p = conj(t1) t2
   pure subroutine relative_pose(n, q1, q2, c1, c2, t1, t2, p)
      integer, intent(in) :: n
      real(wp), intent(in) :: q1(BLOCK, 4), q2(BLOCK, 4)    !! attitude of the bodies
      real(wp), intent(in) :: c1(BLOCK, 4), c2(BLOCK, 4)    !! triads in body axes
      real(wp), intent(out) :: t1(BLOCK, 4), t2(BLOCK, 4)   !! triads, W
      real(wp), intent(out) :: p(BLOCK, 4)

      integer :: i

      call multiply(n, q1, c1, t1)
      call multiply(n, q2, c2, t2)
      !$omp simd
      do i = 1, n
         p(i, 1) = t1(i, 1)*t2(i, 1) + t1(i, 2)*t2(i, 2) + t1(i, 3)*t2(i, 3) + t1(i, 4)*t2(i, 4)
         p(i, 2) = t1(i, 1)*t2(i, 2) - t1(i, 2)*t2(i, 1) - t1(i, 3)*t2(i, 4) + t1(i, 4)*t2(i, 3)
         p(i, 3) = t1(i, 1)*t2(i, 3) - t1(i, 3)*t2(i, 1) - t1(i, 4)*t2(i, 2) + t1(i, 2)*t2(i, 4)
         p(i, 4) = t1(i, 1)*t2(i, 4) - t1(i, 4)*t2(i, 1) - t1(i, 2)*t2(i, 3) + t1(i, 3)*t2(i, 2)
      end do
   end subroutine relative_pose

   !> c = a b
   pure subroutine multiply(n, a, b, c)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(BLOCK, 4), b(BLOCK, 4)
      real(wp), intent(out) :: c(BLOCK, 4)

      integer :: i

      !$omp simd
      do i = 1, n
         c(i, 1) = a(i, 1)*b(i, 1) - a(i, 2)*b(i, 2) - a(i, 3)*b(i, 3) - a(i, 4)*b(i, 4)
         c(i, 2) = a(i, 1)*b(i, 2) + a(i, 2)*b(i, 1) + a(i, 3)*b(i, 4) - a(i, 4)*b(i, 3)
         c(i, 3) = a(i, 1)*b(i, 3) + a(i, 3)*b(i, 1) + a(i, 4)*b(i, 2) - a(i, 2)*b(i, 4)
         c(i, 4) = a(i, 1)*b(i, 4) + a(i, 4)*b(i, 1) + a(i, 2)*b(i, 3) - a(i, 3)*b(i, 2)
      end do
   end subroutine multiply

   !> Columns of the rotation matrix of a unit quaternion
   pure subroutine quaternion_frame(n, q, e)
      integer, intent(in) :: n
      real(wp), intent(in) :: q(BLOCK, 4)
      real(wp), intent(out) :: e(BLOCK, 9)

      real(wp) :: w, x, y, z
      integer :: i

      !$omp simd private(w, x, y, z)
      do i = 1, n
         w = q(i, 1)
         x = q(i, 2)
         y = q(i, 3)
         z = q(i, 4)
         e(i, 1) = 1.0_wp - 2.0_wp*(y*y + z*z)
         e(i, 2) = 2.0_wp*(x*y + w*z)
         e(i, 3) = 2.0_wp*(x*z - w*y)
         e(i, 4) = 2.0_wp*(x*y - w*z)
         e(i, 5) = 1.0_wp - 2.0_wp*(x*x + z*z)
         e(i, 6) = 2.0_wp*(y*z + w*x)
         e(i, 7) = 2.0_wp*(x*z + w*y)
         e(i, 8) = 2.0_wp*(y*z - w*x)
         e(i, 9) = 1.0_wp - 2.0_wp*(x*x + y*y)
      end do
   end subroutine quaternion_frame

   !> Translations in the frame of body 1: A1 = 1, A2 = 0
   pure subroutine first_skew(n, t1, r, e, a1, a2)
      integer, intent(in) :: n
      real(wp), intent(in) :: t1(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(out) :: e(BLOCK, 9), a1(BLOCK, 9), a2(BLOCK, 9)

      integer :: k

      call quaternion_frame(n, t1, e)
      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), a1(:, k:k + 2))
      end do
      a2(:n, :) = 0.0_wp
   end subroutine first_skew

   !> y = r x e
   pure subroutine couple(n, r, e, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: r(BLOCK, 3), e(BLOCK, 3)
      real(wp), intent(out) :: y(BLOCK, 3)

      integer :: i

      !$omp simd
      do i = 1, n
         y(i, 1) = r(i, 2)*e(i, 3) - r(i, 3)*e(i, 2)
         y(i, 2) = r(i, 3)*e(i, 1) - r(i, 1)*e(i, 3)
         y(i, 3) = r(i, 1)*e(i, 2) - r(i, 2)*e(i, 1)
      end do
   end subroutine couple

   !> At most one free rotation: swing and twist, p = h s h, theta_x = 2 atan2(px, p0) counted over
   !> turns, theta_y = 2 py, theta_z = 2 pz. Gives the mean frame E = E1 h s^1/2 and its couples
   !> too.
   pure subroutine twist_chart(n, mean, t1, p, r, theta, e, a1, a2, rot)
      integer, intent(in) :: n
      !> fill e, a1, a2 (else they are those of first_skew)
      logical, intent(in) :: mean
      real(wp), intent(in) :: t1(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(inout) :: p(BLOCK, 4)        !! its sign may turn
      real(wp), intent(inout) :: theta(BLOCK, 3)    !! last angles in, new angles out
      real(wp), intent(inout) :: e(BLOCK, 9), a1(BLOCK, 9), a2(BLOCK, 9)
      real(wp), intent(out) :: rot(BLOCK, 9)

      real(wp) :: d(BLOCK, 9), s0(BLOCK), c, s, y, z
      integer :: i, k

      do i = 1, n
         call unwrap(theta(i, 1), p(i, :))
         s0(i) = sqrt(p(i, 1)**2 + p(i, 2)**2)
         theta(i, 2) = 2.0_wp*p(i, 3)
         theta(i, 3) = 2.0_wp*p(i, 4)
      end do
      call quaternion_frame(n, t1, d)
      do k = 0, 2
         !$omp simd private(c, s, y, z)
         do i = 1, n
            c = p(i, 1)/s0(i)
            s = p(i, 2)/s0(i)
            y = d(i, 4 + k)
            z = d(i, 7 + k)
            d(i, 4 + k) = c*y + s*z
            d(i, 7 + k) = c*z - s*y
            rot(i, 1 + k) = d(i, 1 + k) + (p(i, 4)*d(i, 4 + k) - p(i, 3)*d(i, 7 + k))/s0(i)
            rot(i, 4 + k) = s0(i)*d(i, 4 + k) - p(i, 4)*d(i, 1 + k)
            rot(i, 7 + k) = s0(i)*d(i, 7 + k) + p(i, 3)*d(i, 1 + k)
         end do
      end do
      if (mean) call mean_twist(n, d, p, s0, r, rot, e, a1, a2)
   end subroutine twist_chart

   !> Twist of p nearest to the last one; p gets the sign that goes with it
   pure subroutine unwrap(twist, p)
      real(wp), intent(inout) :: twist
      real(wp), intent(inout) :: p(4)

      real(wp) :: principal
      integer :: turns

      principal = 2.0_wp*atan2(p(2), p(1))
      turns = nint((twist - principal)/TWO_PI)
      if (modulo(turns, 2) == 1) p = -p
      twist = principal + TWO_PI*turns
   end subroutine unwrap

   !> Frame E = D s^1/2 with s = (s0, 0, py, pz), and couples on the bodies when E turns with
   !> w_E = w1 + H (w2 - w1): H^T y on body 2 and y - H^T y on body 1, y = r x e_k
   pure subroutine mean_twist(n, d, p, s0, r, rot, e, a1, a2)
      integer, intent(in) :: n
      real(wp), intent(in) :: d(BLOCK, 9), p(BLOCK, 4), s0(BLOCK), r(BLOCK, 3), rot(BLOCK, 9)
      real(wp), intent(out) :: e(BLOCK, 9), a1(BLOCK, 9), a2(BLOCK, 9)

      real(wp) :: r0, ry, rz, y(BLOCK, 3), a, b, c, g_y, g_z, g_0, h(3)
      integer :: i, j, k

      do k = 0, 2
         !$omp simd private(r0, ry, rz)
         do i = 1, n
            r0 = sqrt(0.5_wp*(1.0_wp + s0(i)))
            ry = 0.5_wp*p(i, 3)/r0
            rz = 0.5_wp*p(i, 4)/r0
            e(i, 1 + k) = (1.0_wp - 2.0_wp*(ry*ry + rz*rz))*d(i, 1 + k) + &
               2.0_wp*r0*rz*d(i, 4 + k) - &
               2.0_wp*r0*ry*d(i, 7 + k)
            e(i, 4 + k) = -2.0_wp*r0*rz*d(i, 1 + k) + (1.0_wp - 2.0_wp*rz*rz)*d(i, 4 + k) + &
               2.0_wp*ry*rz*d(i, 7 + k)
            e(i, 7 + k) = 2.0_wp*r0*ry*d(i, 1 + k) + 2.0_wp*ry*rz*d(i, 4 + k) + &
               (1.0_wp - 2.0_wp*ry*ry)*d(i, 7 + k)
         end do
      end do
      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), y)
         !$omp simd private(r0, ry, rz, a, b, c, g_y, g_z, g_0, h, j)
         do i = 1, n
            r0 = sqrt(0.5_wp*(1.0_wp + s0(i)))
            ry = 0.5_wp*p(i, 3)/r0
            rz = 0.5_wp*p(i, 4)/r0
            a = e(i, 1)*y(i, 1) + e(i, 2)*y(i, 2) + e(i, 3)*y(i, 3)
            b = e(i, 4)*y(i, 1) + e(i, 5)*y(i, 2) + e(i, 6)*y(i, 3)
            c = e(i, 7)*y(i, 1) + e(i, 8)*y(i, 2) + e(i, 9)*y(i, 3)
            g_y = 2.0_wp*(a*rz + b*r0)
            g_z = 2.0_wp*(c*r0 - a*ry)
            g_0 = -2.0_wp*(b*ry + c*rz) - 0.5_wp*(g_y*p(i, 3) + g_z*p(i, 4))/r0**2
            h(1) = 0.5_wp*(d(i, 1)*y(i, 1) + d(i, 2)*y(i, 2) + d(i, 3)*y(i, 3))
            h(2) = 0.25_wp*(g_y - 0.5_wp*g_0*p(i, 3)/s0(i))/r0
            h(3) = 0.25_wp*(g_z - 0.5_wp*g_0*p(i, 4)/s0(i))/r0
            do j = 0, 2
               a2(i, k + j) = h(1)*rot(i, 1 + j) + h(2)*rot(i, 4 + j) + h(3)*rot(i, 7 + j)
               a1(i, k + j) = y(i, 1 + j) - a2(i, k + j)
            end do
         end do
      end do
   end subroutine mean_twist

   !> Three free rotations: rotation vector of p on the branch nearest to the last one, in the frame
   !> Em = E1 Exp(theta/2): rot = Em T, T = n n^T + (a/2)/sin(a/2) (1 - n n^T).
   !> Mean translations: A1^T = 1/2 - 1/2 tan(a/4) [n], A2^T = 1/2 + 1/2 tan(a/4) [n]. That is
   !> singular
   !> at a whole turn; joints whose translations need no frame (plain) take that of body 1.
   pure subroutine vector_chart(n, mean, plain, t1, p, r, theta, e, a1, a2, rot, em)
      integer, intent(in) :: n
      logical, intent(in) :: mean                   !! fill e, a1, a2
      logical, intent(in) :: plain(BLOCK)
      real(wp), intent(in) :: t1(BLOCK, 4), p(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(inout) :: theta(BLOCK, 3)    !! last rotation vector in, new one out
      real(wp), intent(inout) :: e(BLOCK, 9), a1(BLOCK, 9), a2(BLOCK, 9)
      real(wp), intent(out) :: rot(BLOCK, 9)
      real(wp), intent(out) :: em(BLOCK, 9)         !! the frame Em

      real(wp) :: half(BLOCK, 4), q(BLOCK, 4), axis(BLOCK, 3), a(BLOCK), t, g
      integer :: i, j, k

      do i = 1, n
         call nearest_vector(p(i, :), theta(i, :), axis(i, :), a(i))
         half(i, 1) = cos(0.25_wp*a(i))
         half(i, 2:4) = sin(0.25_wp*a(i))*axis(i, :)
      end do
      call multiply(n, t1, half, q)
      call quaternion_frame(n, q, em)
      do i = 1, n
         g = 1.0_wp + a(i)**2/24.0_wp               ! (a/2)/sin(a/2) of a small angle
         if (abs(a(i)) > 1.0e-3_wp) g = 0.5_wp*a(i)/sin(0.5_wp*a(i))
         do k = 1, 3
            do j = 1, 3
               rot(i, 3*k - 3 + j) = g*em(i, 3*k - 3 + j) + (1.0_wp - g)*axis(i, k)* &
                  (em(i, j)*axis(i, 1) + em(i, 3 + j)*axis(i, 2) + em(i, 6 + j)*axis(i, 3))
            end do
         end do
      end do
      if (.not. mean) return
      call quaternion_frame(n, t1, e)
      do i = 1, n
         if (.not. plain(i)) e(i, :) = em(i, :)
      end do
      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), a2(:, k:k + 2))
         do i = 1, n
            if (plain(i)) then
               a1(i, k:k + 2) = a2(i, k:k + 2)
               a2(i, k:k + 2) = 0.0_wp
               cycle
            end if
            t = tan(0.25_wp*a(i))
            associate (y => a2(i, k:k + 2))
               q(i, 2:4) = t*(em(i, 1:3)*axis(i, 1) + em(i, 4:6)*axis(i, 2) + em(i, 7:9)*axis(i, 3))
               a1(i, k) = q(i, 3)*y(3) - q(i, 4)*y(2)
               a1(i, k + 1) = q(i, 4)*y(1) - q(i, 2)*y(3)
               a1(i, k + 2) = q(i, 2)*y(2) - q(i, 3)*y(1)
            end associate
            q(i, 2:4) = a1(i, k:k + 2)
            a1(i, k:k + 2) = 0.5_wp*(a2(i, k:k + 2) - q(i, 2:4))
            a2(i, k:k + 2) = 0.5_wp*(a2(i, k:k + 2) + q(i, 2:4))
         end do
      end do
   end subroutine vector_chart

   !> Rotation vector angle*axis of p nearest to the last vector; axis (1, 0, 0) for no turn at all
   pure subroutine nearest_vector(p, theta, axis, angle)
      real(wp), intent(in) :: p(4)
      real(wp), intent(inout) :: theta(3)
      real(wp), intent(out) :: axis(3), angle

      real(wp) :: s, last

      last = norm2(theta)
      s = norm2(p(2:4))
      axis = [1.0_wp, 0.0_wp, 0.0_wp]
      if (s > 0.0_wp) axis = p(2:4)/s
      angle = 2.0_wp*atan2(s, p(1))
      if (last > 0.0_wp) angle = angle + TWO_PI*nint((dot_product(theta, axis) - angle)/TWO_PI)
      if (last <= 0.0_wp .and. angle > 0.5_wp*TWO_PI) angle = angle - TWO_PI
      theta = angle*axis
   end subroutine nearest_vector

   !> Universal: e2 carried by body 1, e3 by body 2, e1 = e2 x e3 normalised; coordinates on the
   !> dual
   !> basis G = E^-1. theta_1 = angle(e2, e3) less its start value, theta_2 and theta_3 turn about
   !> e2
   !> and e3 from where e1 stood at the start, counted over turns; theta' = G (w2 - w1) exactly.
   !> Triads: body 1 carries (e1, e2, e1 x e2) of the start, body 2 (e1, e3 x e1, e3).
   pure subroutine universal_chart(n, t1, t2, r, angle0, theta, xl, e, dual, a1, a2, ortho)
      integer, intent(in) :: n
      real(wp), intent(in) :: t1(BLOCK, 4), t2(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(in) :: angle0(BLOCK)          !! angle(e2, e3) at the start
      real(wp), intent(inout) :: theta(BLOCK, 3)     !! last angles in, new angles out
      real(wp), intent(out) :: xl(BLOCK, 3)          !! G r
      real(wp), intent(out) :: e(BLOCK, 9)           !! e1, e2, e3
      real(wp), intent(out) :: dual(BLOCK, 9)        !! force and moment of a unit coordinate
      real(wp), intent(out) :: a1(BLOCK, 9), a2(BLOCK, 9)
      real(wp), intent(out) :: ortho(BLOCK)          !! e2.e3

      real(wp) :: b1(BLOCK, 9), b2(BLOCK, 9), s, c1, u(3), v(3), m(3), f(3), fp(3), new(3)
      integer :: i, k

      call quaternion_frame(n, t1, b1)
      call quaternion_frame(n, t2, b2)
      do i = 1, n
         u = b1(i, 4:6)
         v = b2(i, 7:9)
         m = cross3(u, v)
         s = norm2(m)
         m = m/s
         ortho(i) = dot_product(u, v)
         e(i, :) = [m, u, v]
         dual(i, 1:3) = m
         dual(i, 4:6) = cross3(v, m)/s
         dual(i, 7:9) = cross3(m, u)/s
         xl(i, :) = [(dot_product(dual(i, 3*k - 2:3*k), r(i, :)), k=1, 3)]
         new(1) = atan2(s, ortho(i)) - angle0(i)
         new(2) = atan2(dot_product(u, cross3(b1(i, 1:3), m)), dot_product(b1(i, 1:3), m))
         new(3) = atan2(dot_product(v, cross3(m, b2(i, 1:3))), dot_product(m, b2(i, 1:3)))
         new(2:3) = new(2:3) + TWO_PI*nint((theta(i, 2:3) - new(2:3))/TWO_PI)
         theta(i, :) = new
         c1 = xl(i, 1)/s
         do k = 1, 7, 3
            f = dual(i, k:k + 2)
            fp = f - dot_product(f, m)*m
            a1(i, k:k + 2) = xl(i, 2)*cross3(u, f) + c1*(dot_product(fp, u)*v - ortho(i)*fp)
            a2(i, k:k + 2) = xl(i, 3)*cross3(v, f) + c1*(ortho(i)*fp - dot_product(fp, v)*u)
         end do
      end do
   end subroutine universal_chart

   pure function cross3(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c(1) = a(2)*b(3) - a(3)*b(2)
      c(2) = a(3)*b(1) - a(1)*b(3)
      c(3) = a(1)*b(2) - a(2)*b(1)
   end function cross3

end module kj_c_chart
