!> Consistent joint coordinates of a block of joints: from the poses of the two ends to the
!> coordinates q and the matrix B of q' = B u, for each chart of the rotations.
!>
!> A row of B is kept as what a unit force along that coordinate does (the generalised force is
!> -B^T F): for translation k the force E(:, k) on node 1 (and the opposite on node 2) and the
!> couples A1(:, k) on the body of node 1, r x E(:, k) - A1(:, k) on the other, next to those of the
!> arms; for rotation k the moment R(:, k) on body 1 and the opposite on body 2. Matrices are 9
!> columns; all vectors W; r goes from node 1 to node 2.
!> One file: charts share frames, turns and couples.
!> Source: docs/theory/joints.md 2 to 7.
module kj_consistent_chart
   use kj_kinds, only: wp
   use kj_math3, only: angles
   use kj_joint_types, only: FRAME_FIRST, FRAME_SECOND, FRAME_LINE, FRAME_FIXED
   use kj_block, only: BLOCK, line_axes
   implicit none
   private

   public :: relative_pose, twist_chart, vector_chart, nearest_vector, first_skew, &
      quaternion_frame, couple, spring_axes, count_turns

   real(wp), parameter :: TWO_PI = 6.28318530717958647692528676656_wp
   real(wp), parameter :: SMALL = 1.0e-3_wp          !! angle below which a series is exact [rad]
   real(wp), parameter :: NO_TURN = 1.0e-150_wp      !! whose square is a number yet

contains

   !> Triads carried by the two bodies and the turn between them: p = conj(t1) t2
   pure subroutine relative_pose(n, q1, q2, c1, c2, t1, t2, p)
      integer, value :: n
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
      integer, value :: n
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
      integer, value :: n
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

   !> Translations in the frame of body 1, which takes the whole couple
   pure subroutine first_skew(n, t1, r, e, a1)
      integer, value :: n
      real(wp), intent(in) :: t1(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(out) :: e(BLOCK, 9), a1(BLOCK, 9)

      integer :: k

      call quaternion_frame(n, t1, e)
      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), a1(:, k:k + 2))
      end do
   end subroutine first_skew

   !> y = r x e
   pure subroutine couple(n, r, e, y)
      integer, value :: n
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

   !> The nearest whole number, without a branch; |x| < 2^51
   elemental real(wp) function whole(x)
      real(wp), intent(in) :: x

      real(wp), parameter :: SHIFT = 1.5_wp/epsilon(1.0_wp)

      whole = (x + SHIFT) - SHIFT
   end function whole

   !> Is a whole number odd?
   elemental logical function odd(x)
      real(wp), intent(in) :: x

      odd = abs(0.5_wp*x - whole(0.5_wp*x)) > 0.25_wp
   end function odd

   !> An angle of each joint on the branch nearest to the last one
   pure subroutine count_turns(n, angle, last)
      integer, value :: n
      real(wp), intent(in) :: angle(BLOCK)          !! but for whole turns
      real(wp), intent(inout) :: last(BLOCK)        !! last angle in, new one out

      integer :: i

      !$omp simd
      do i = 1, n
         last(i) = angle(i) + TWO_PI*whole((last(i) - angle(i))*(1.0_wp/TWO_PI))
      end do
   end subroutine count_turns

   !> At most one free rotation: swing and twist, p = h s h, theta_x = 2 atan2(px, p0) counted over
   !> turns, theta_y = 2 py, theta_z = 2 pz. Gives the mean frame E = E1 h s^1/2 and its couples
   !> too.
   pure subroutine twist_chart(n, mean, t1, p, r, theta, e, a1, rot)
      integer, value :: n
      !> fill e, a1 (else they are those of first_skew)
      logical, intent(in) :: mean
      real(wp), intent(in) :: t1(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(inout) :: p(BLOCK, 4)        !! its sign may turn
      real(wp), intent(inout) :: theta(BLOCK, 3)    !! last angles in, new angles out
      real(wp), intent(inout) :: e(BLOCK, 9), a1(BLOCK, 9)
      real(wp), intent(out) :: rot(BLOCK, 9)

      real(wp) :: d(BLOCK, 9), s0(BLOCK), inverse(BLOCK), c, s, y, z
      integer :: i, k

      call unwrap(n, p, theta, s0)
      call quaternion_frame(n, t1, d)
      !$omp simd
      do i = 1, n
         inverse(i) = 1.0_wp/s0(i)
      end do
      do k = 0, 2
         !$omp simd private(c, s, y, z)
         do i = 1, n
            c = p(i, 1)*inverse(i)
            s = p(i, 2)*inverse(i)
            y = d(i, 4 + k)
            z = d(i, 7 + k)
            d(i, 4 + k) = c*y + s*z
            d(i, 7 + k) = c*z - s*y
            rot(i, 1 + k) = d(i, 1 + k) + &
               (p(i, 4)*d(i, 4 + k) - p(i, 3)*d(i, 7 + k))*inverse(i)
            rot(i, 4 + k) = s0(i)*d(i, 4 + k) - p(i, 4)*d(i, 1 + k)
            rot(i, 7 + k) = s0(i)*d(i, 7 + k) + p(i, 3)*d(i, 1 + k)
         end do
      end do
      if (mean) call mean_twist(n, d, p, s0, r, rot, e, a1)
   end subroutine twist_chart

   !> Twist of p nearest to the last one, the other two angles, and cos(swing/2); p gets the sign
   !> that goes with the twist
   pure subroutine unwrap(n, p, theta, s0)
      integer, value :: n
      real(wp), intent(inout) :: p(BLOCK, 4), theta(BLOCK, 3)
      real(wp), intent(out) :: s0(BLOCK)

      real(wp) :: half(BLOCK), turns, sign
      integer :: i, k

      call angles(n, p(:, 2), p(:, 1), half)
      !$omp simd private(turns, sign, k)
      do i = 1, n
         turns = whole((theta(i, 1) - 2.0_wp*half(i))*(1.0_wp/TWO_PI))
         theta(i, 1) = 2.0_wp*half(i) + TWO_PI*turns
         sign = merge(-1.0_wp, 1.0_wp, odd(turns))
         do k = 1, 4
            p(i, k) = sign*p(i, k)
         end do
         theta(i, 2) = 2.0_wp*p(i, 3)
         theta(i, 3) = 2.0_wp*p(i, 4)
         s0(i) = sqrt(p(i, 1)**2 + p(i, 2)**2)
      end do
   end subroutine unwrap

   !> Frame E = D s^1/2 with s = (s0, 0, py, pz), and couples on the bodies when E turns with
   !> w_E = w1 + H (w2 - w1): H^T y on body 2 and y - H^T y on body 1, y = r x e_k
   pure subroutine mean_twist(n, d, p, s0, r, rot, e, a1)
      integer, value :: n
      real(wp), intent(in) :: d(BLOCK, 9), p(BLOCK, 4), s0(BLOCK), r(BLOCK, 3), rot(BLOCK, 9)
      real(wp), intent(out) :: e(BLOCK, 9), a1(BLOCK, 9)

      real(wp), dimension(BLOCK) :: r0, ry, rz, inverse, part
      real(wp) :: y(BLOCK, 3), a, b, c, g_y, g_z, g_0, h1, h2, h3
      integer :: i, k

      !$omp simd
      do i = 1, n
         r0(i) = sqrt(0.5_wp*(1.0_wp + s0(i)))
         inverse(i) = 1.0_wp/r0(i)
         part(i) = 0.5_wp/s0(i)
         ry(i) = 0.5_wp*p(i, 3)*inverse(i)
         rz(i) = 0.5_wp*p(i, 4)*inverse(i)
      end do
      do k = 0, 2
         !$omp simd
         do i = 1, n
            e(i, 1 + k) = (1.0_wp - 2.0_wp*(ry(i)*ry(i) + rz(i)*rz(i)))*d(i, 1 + k) + &
               2.0_wp*r0(i)*(rz(i)*d(i, 4 + k) - ry(i)*d(i, 7 + k))
            e(i, 4 + k) = -2.0_wp*r0(i)*rz(i)*d(i, 1 + k) + &
               (1.0_wp - 2.0_wp*rz(i)*rz(i))*d(i, 4 + k) + 2.0_wp*ry(i)*rz(i)*d(i, 7 + k)
            e(i, 7 + k) = 2.0_wp*r0(i)*ry(i)*d(i, 1 + k) + 2.0_wp*ry(i)*rz(i)*d(i, 4 + k) + &
               (1.0_wp - 2.0_wp*ry(i)*ry(i))*d(i, 7 + k)
         end do
      end do
      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), y)
         !$omp simd private(a, b, c, g_y, g_z, g_0, h1, h2, h3)
         do i = 1, n
            a = e(i, 1)*y(i, 1) + e(i, 2)*y(i, 2) + e(i, 3)*y(i, 3)
            b = e(i, 4)*y(i, 1) + e(i, 5)*y(i, 2) + e(i, 6)*y(i, 3)
            c = e(i, 7)*y(i, 1) + e(i, 8)*y(i, 2) + e(i, 9)*y(i, 3)
            g_y = 2.0_wp*(a*rz(i) + b*r0(i))
            g_z = 2.0_wp*(c*r0(i) - a*ry(i))
            g_0 = -2.0_wp*(b*ry(i) + c*rz(i)) - &
               0.5_wp*(g_y*p(i, 3) + g_z*p(i, 4))*inverse(i)**2
            h1 = 0.5_wp*(d(i, 1)*y(i, 1) + d(i, 2)*y(i, 2) + d(i, 3)*y(i, 3))
            h2 = 0.25_wp*(g_y - g_0*p(i, 3)*part(i))*inverse(i)
            h3 = 0.25_wp*(g_z - g_0*p(i, 4)*part(i))*inverse(i)
            a1(i, k) = y(i, 1) - (h1*rot(i, 1) + h2*rot(i, 4) + h3*rot(i, 7))
            a1(i, k + 1) = y(i, 2) - (h1*rot(i, 2) + h2*rot(i, 5) + h3*rot(i, 8))
            a1(i, k + 2) = y(i, 3) - (h1*rot(i, 3) + h2*rot(i, 6) + h3*rot(i, 9))
         end do
      end do
   end subroutine mean_twist

   !> Three free rotations: rotation vector of p on the branch nearest to the last one, in the frame
   !> Em = E1 Exp(theta/2): rot = Em T, T = n n^T + (a/2)/sin(a/2) (1 - n n^T).
   !> Mean translations: A1^T = 1/2 - 1/2 tan(a/4) [n], A2^T = 1/2 + 1/2 tan(a/4) [n]. That is
   !> singular at a whole turn; joints whose translations need no frame (plain) take that of body 1.
   pure subroutine vector_chart(n, mean, plain, t1, p, r, theta, e, a1, rot, em)
      integer, value :: n
      logical, intent(in) :: mean                   !! fill e, a1
      real(wp), intent(in) :: plain(BLOCK)          !! 1 for a plain joint, else 0
      real(wp), intent(in) :: t1(BLOCK, 4), p(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(inout) :: theta(BLOCK, 3)    !! last rotation vector in, new one out
      real(wp), intent(inout) :: e(BLOCK, 9), a1(BLOCK, 9)
      real(wp), intent(out) :: rot(BLOCK, 9)
      real(wp), intent(out) :: em(BLOCK, 9)         !! the frame Em

      real(wp) :: half(BLOCK, 4), q(BLOCK, 4), axis(BLOCK, 3), along
      real(wp), dimension(BLOCK) :: s, a, turns, g, t
      integer :: i, k

      call nearest_vector(n, p, theta, axis, s, a, turns)
      call halve(n, p, s, a, turns, axis, half, g, t)
      call multiply(n, t1, half, q)
      call quaternion_frame(n, q, em)
      do k = 0, 2
         !$omp simd private(along)
         do i = 1, n
            along = em(i, 1 + k)*axis(i, 1) + em(i, 4 + k)*axis(i, 2) + em(i, 7 + k)*axis(i, 3)
            rot(i, 1 + k) = g(i)*em(i, 1 + k) + (1.0_wp - g(i))*axis(i, 1)*along
            rot(i, 4 + k) = g(i)*em(i, 4 + k) + (1.0_wp - g(i))*axis(i, 2)*along
            rot(i, 7 + k) = g(i)*em(i, 7 + k) + (1.0_wp - g(i))*axis(i, 3)*along
            q(i, 2 + k) = along
         end do
      end do
      if (.not. mean) return
      call quaternion_frame(n, t1, e)
      do k = 1, 9
         !$omp simd
         do i = 1, n
            e(i, k) = merge(e(i, k), em(i, k), plain(i) > 0.5_wp)
         end do
      end do
      call mean_vector(n, plain, q(:, 2:4), t, r, e, a1)
   end subroutine vector_chart

   !> Couples of the mean frame of three free rotations: half of r x e each, and t n x (r x e)/2
   !> more on body 2 than on body 1, t = tan(a/4)
   pure subroutine mean_vector(n, plain, axis, t, r, e, a1)
      integer, value :: n
      real(wp), intent(in) :: plain(BLOCK)          !! 1 for a plain joint, else 0
      real(wp), intent(in) :: axis(BLOCK, 3)        !! n, W
      real(wp), intent(in) :: t(BLOCK), r(BLOCK, 3), e(BLOCK, 9)
      real(wp), intent(out) :: a1(BLOCK, 9)

      real(wp) :: y(BLOCK, 3), z(BLOCK, 3), part
      integer :: i, j, k

      do k = 1, 7, 3
         call couple(n, r, e(:, k:k + 2), y)
         call couple(n, axis, y, z)
         do j = 0, 2
            !$omp simd private(part)
            do i = 1, n
               part = 0.5_wp*(y(i, 1 + j) + t(i)*z(i, 1 + j))
               a1(i, k + j) = y(i, 1 + j) - merge(0.0_wp, part, plain(i) > 0.5_wp)
            end do
         end do
      end do
   end subroutine mean_vector

   !> Rotation vector a*axis of p nearest to the last vector; axis (1, 0, 0) for no turn at all
   pure subroutine nearest_vector(n, p, theta, axis, s, a, turns)
      integer, value :: n
      real(wp), intent(in) :: p(BLOCK, 4)
      real(wp), intent(inout) :: theta(BLOCK, 3)    !! last vector in, new one out
      real(wp), intent(out) :: axis(BLOCK, 3)
      real(wp), intent(out) :: s(BLOCK)             !! |sin(a/2)|
      real(wp), intent(out) :: a(BLOCK), turns(BLOCK)   !! and its whole turns

      real(wp) :: c(BLOCK), inverse
      integer :: i

      !$omp simd
      do i = 1, n
         s(i) = sqrt(p(i, 2)**2 + p(i, 3)**2 + p(i, 4)**2)
         c(i) = abs(p(i, 1))
      end do
      call angles(n, s, c, a)
      !$omp simd private(inverse)
      do i = 1, n
         inverse = sign(1.0_wp, p(i, 1))/max(s(i), NO_TURN)   ! parts below it are next to nothing
         axis(i, 1) = merge(p(i, 2)*inverse, 1.0_wp, s(i) > NO_TURN)
         axis(i, 2) = p(i, 3)*inverse
         axis(i, 3) = p(i, 4)*inverse
         turns(i) = whole((theta(i, 1)*axis(i, 1) + theta(i, 2)*axis(i, 2) + &
            theta(i, 3)*axis(i, 3) - 2.0_wp*a(i))*(1.0_wp/TWO_PI))
         a(i) = 2.0_wp*a(i) + TWO_PI*turns(i)
         theta(i, 1) = a(i)*axis(i, 1)
         theta(i, 2) = a(i)*axis(i, 2)
         theta(i, 3) = a(i)*axis(i, 3)
      end do
   end subroutine nearest_vector

   !> Half of the turn that nearest_vector has found
   pure subroutine halve(n, p, s, a, turns, axis, half, g, t)
      integer, value :: n
      real(wp), intent(in) :: p(BLOCK, 4), s(BLOCK), a(BLOCK), turns(BLOCK), axis(BLOCK, 3)
      real(wp), intent(out) :: half(BLOCK, 4)       !! quaternion, but for its sign
      real(wp), intent(out) :: g(BLOCK), t(BLOCK)   !! (a/2)/sin(a/2), tan(a/4)

      real(wp) :: part, half_c, half_s
      logical :: turned
      integer :: i

      !$omp simd private(part, half_c, half_s, turned)
      do i = 1, n
         turned = odd(turns(i))
         half_c = sqrt(0.5_wp*(1.0_wp + abs(p(i, 1))))
         half_s = 0.5_wp*s(i)/half_c
         half(i, 1) = merge(-half_s, half_c, turned)
         part = merge(half_c, half_s, turned)
         half(i, 2) = part*axis(i, 1)
         half(i, 3) = part*axis(i, 2)
         half(i, 4) = part*axis(i, 3)
         t(i) = part/merge(-max(half_s, tiny(s)), half_c, turned)
         part = merge(-s(i), s(i), turned)
         g(i) = merge(0.5_wp*a(i), 1.0_wp + a(i)**2/24.0_wp, abs(a(i)) > SMALL)/ &
            merge(part, 1.0_wp, abs(a(i)) > SMALL)
      end do
   end subroutine halve

   !> Axes of a block of springs and the couple on body 1 of a unit force along each, as the
   !> charts of joints have them (consistent formulation)
   pure subroutine spring_axes(n, frame, fixed, t1, t2, r, e, a1)
      integer, value :: n
      integer, intent(in) :: frame               !! FRAME_ constant of springs
      real(wp), intent(in) :: fixed(BLOCK, 9)    !! axes of FRAME_FIXED, W
      real(wp), intent(in) :: t1(BLOCK, 4), t2(BLOCK, 4)   !! triads that the ends carry, W
      real(wp), intent(in) :: r(BLOCK, 3)        !! from node 1 to node 2, W
      real(wp), intent(out) :: e(BLOCK, 9), a1(BLOCK, 9)

      if (frame == FRAME_FIRST) then
         call first_skew(n, t1, r, e, a1)
      else
         if (frame == FRAME_SECOND) call quaternion_frame(n, t2, e)
         if (frame == FRAME_LINE) call line_axes(n, r, e)
         if (frame == FRAME_FIXED) e(:n, :) = fixed(:n, :)
         a1(:n, :) = 0.0_wp
      end if
   end subroutine spring_axes

end module kj_consistent_chart
