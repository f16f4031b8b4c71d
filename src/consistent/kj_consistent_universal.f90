!> Coordinates of universal joints under the consistent formulation, for a block of joints; what the
!> matrices mean stands in kj_consistent_chart.
!> Source: docs/theory/joints.md 6.
module kj_consistent_universal
   use kj_kinds, only: wp
   use kj_math3, only: angles
   use kj_block, only: BLOCK
   use kj_consistent_chart, only: quaternion_frame, couple, count_turns
   implicit none
   private

   public :: universal_chart

contains

   !> Universal: e2 carried by body 1, e3 by body 2, e1 = e2 x e3 normalised; coordinates on the
   !> dual basis G = E^-1. theta_1 = angle(e2, e3) less its start value, theta_2 and theta_3 turn
   !> about e2 and e3 from where e1 stood at the start, counted over turns; theta' = G (w2 - w1)
   !> exactly. Triads: body 1 carries (e1, e2, e1 x e2) of the start, body 2 (e1, e3 x e1, e3).
   pure subroutine universal_chart(n, t1, t2, r, angle0, theta, xl, e, dual, a1, ortho)
      integer, value :: n
      real(wp), intent(in) :: t1(BLOCK, 4), t2(BLOCK, 4), r(BLOCK, 3)
      real(wp), intent(in) :: angle0(BLOCK)          !! angle(e2, e3) at the start
      real(wp), intent(inout) :: theta(BLOCK, 3)     !! last angles in, new angles out
      real(wp), intent(out) :: xl(BLOCK, 3)          !! G r
      real(wp), intent(out) :: e(BLOCK, 9)           !! e1, e2, e3
      real(wp), intent(out) :: dual(BLOCK, 9)        !! force and moment of a unit coordinate
      real(wp), intent(out) :: a1(BLOCK, 9)
      real(wp), intent(out) :: ortho(BLOCK)          !! e2.e3

      real(wp), dimension(BLOCK, 9) :: b1, b2
      real(wp), dimension(BLOCK, 3) :: y, z
      real(wp) :: s(BLOCK)
      integer :: i

      call quaternion_frame(n, t1, b1)
      call quaternion_frame(n, t2, b2)
      e(:n, 4:6) = b1(:n, 4:6)
      e(:n, 7:9) = b2(:n, 7:9)
      call couple(n, e(:, 4:6), e(:, 7:9), y)
      !$omp simd
      do i = 1, n
         s(i) = sqrt(y(i, 1)**2 + y(i, 2)**2 + y(i, 3)**2)
         e(i, 1) = y(i, 1)/s(i)
         e(i, 2) = y(i, 2)/s(i)
         e(i, 3) = y(i, 3)/s(i)
         ortho(i) = e(i, 4)*e(i, 7) + e(i, 5)*e(i, 8) + e(i, 6)*e(i, 9)
      end do
      call couple(n, e(:, 7:9), e(:, 1:3), y)
      call couple(n, e(:, 1:3), e(:, 4:6), z)
      !$omp simd
      do i = 1, n
         dual(i, 1) = e(i, 1)
         dual(i, 2) = e(i, 2)
         dual(i, 3) = e(i, 3)
         dual(i, 4) = y(i, 1)/s(i)
         dual(i, 5) = y(i, 2)/s(i)
         dual(i, 6) = y(i, 3)/s(i)
         dual(i, 7) = z(i, 1)/s(i)
         dual(i, 8) = z(i, 2)/s(i)
         dual(i, 9) = z(i, 3)/s(i)
         xl(i, 1) = dual(i, 1)*r(i, 1) + dual(i, 2)*r(i, 2) + dual(i, 3)*r(i, 3)
         xl(i, 2) = dual(i, 4)*r(i, 1) + dual(i, 5)*r(i, 2) + dual(i, 6)*r(i, 3)
         xl(i, 3) = dual(i, 7)*r(i, 1) + dual(i, 8)*r(i, 2) + dual(i, 9)*r(i, 3)
      end do
      call universal_angles(n, b1(:, 1:3), b2(:, 1:3), e, s, ortho, angle0, theta)
      call universal_couples(n, e, dual, xl, s, ortho, a1)
   end subroutine universal_chart

   !> Angles of a universal joint from its axes and from where e1 stood at the start on both bodies
   pure subroutine universal_angles(n, x1, x2, e, s, ortho, angle0, theta)
      integer, value :: n
      real(wp), intent(in) :: x1(BLOCK, 3), x2(BLOCK, 3), e(BLOCK, 9)
      real(wp), intent(in) :: s(BLOCK), ortho(BLOCK) !! sine and cosine of angle(e2, e3)
      real(wp), intent(in) :: angle0(BLOCK)
      real(wp), intent(inout) :: theta(BLOCK, 3)

      real(wp), dimension(BLOCK) :: sine, cosine, a
      real(wp) :: y(BLOCK, 3)
      integer :: i

      call angles(n, s, ortho, a)
      theta(:n, 1) = a(:n) - angle0(:n)
      call couple(n, x1, e(:, 1:3), y)
      !$omp simd
      do i = 1, n
         sine(i) = e(i, 4)*y(i, 1) + e(i, 5)*y(i, 2) + e(i, 6)*y(i, 3)
         cosine(i) = x1(i, 1)*e(i, 1) + x1(i, 2)*e(i, 2) + x1(i, 3)*e(i, 3)
      end do
      call angles(n, sine, cosine, a)
      call count_turns(n, a, theta(:, 2))
      call couple(n, e(:, 1:3), x2, y)
      !$omp simd
      do i = 1, n
         sine(i) = e(i, 7)*y(i, 1) + e(i, 8)*y(i, 2) + e(i, 9)*y(i, 3)
         cosine(i) = e(i, 1)*x2(i, 1) + e(i, 2)*x2(i, 2) + e(i, 3)*x2(i, 3)
      end do
      call angles(n, sine, cosine, a)
      call count_turns(n, a, theta(:, 3))
   end subroutine universal_angles

   !> Couples on body 1 of the three translations: it carries e2 and turns e1
   pure subroutine universal_couples(n, e, dual, xl, s, ortho, a1)
      integer, value :: n
      real(wp), intent(in) :: e(BLOCK, 9), dual(BLOCK, 9), xl(BLOCK, 3), s(BLOCK), ortho(BLOCK)
      real(wp), intent(out) :: a1(BLOCK, 9)

      real(wp) :: y(BLOCK, 3), f(3), along, u, c1
      integer :: i, j, k

      do k = 1, 7, 3
         call couple(n, e(:, 4:6), dual(:, k:k + 2), y)
         !$omp simd private(f, along, u, c1, j)
         do i = 1, n
            along = dual(i, k)*e(i, 1) + dual(i, k + 1)*e(i, 2) + dual(i, k + 2)*e(i, 3)
            f(1) = dual(i, k) - along*e(i, 1)
            f(2) = dual(i, k + 1) - along*e(i, 2)
            f(3) = dual(i, k + 2) - along*e(i, 3)
            u = f(1)*e(i, 4) + f(2)*e(i, 5) + f(3)*e(i, 6)
            c1 = xl(i, 1)/s(i)
            do j = 0, 2
               a1(i, k + j) = xl(i, 2)*y(i, 1 + j) + c1*(u*e(i, 7 + j) - ortho(i)*f(1 + j))
            end do
         end do
      end do
   end subroutine universal_couples

end module kj_consistent_universal
