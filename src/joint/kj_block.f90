!> Joint frames of a block of joints. Frames are 9 columns: E1, E2, E3 in the world frame W.
!> Every array has BLOCK rows, the first n are used.
module kj_block
   use, intrinsic :: iso_c_binding, only: c_ptr, c_f_pointer
   use kj_kinds, only: wp
   use kj_math3, only: turn_coefficients
   implicit none
   private

   public :: rows_at, clear, block_of, lane_of, group_of, turn_arm, turn_frames, turn_axes, &
      cross_frames, to_local, to_world, add_cross, line_axes

   integer, parameter, public :: BLOCK = 64    !! joints a kernel works on at a time

contains

   !> The numbers of a block of joints at an address as (BLOCK, fields): what goes with a joint from
   !> place to place is its row
   subroutine rows_at(address, bits, row)
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: bits                !! size of the block
      real(wp), pointer, intent(out) :: row(:, :)

      call c_f_pointer(address, row, [BLOCK, bits/storage_size(1.0_wp)/BLOCK])
   end subroutine rows_at

   !> The numbers of a block at an address become 0. Default values would be copied from a block of
   !> zeros in the file of the program, whose pages cost more than the run of a small scene.
   subroutine clear(address, bits)
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: bits                !! size of the block

      real(wp), pointer :: row(:, :)

      call rows_at(address, bits, row)
      row = 0.0_wp
   end subroutine clear

   !> Block of joint i of a batch
   pure elemental integer function block_of(i)
      integer, intent(in) :: i

      block_of = (i - 1)/BLOCK + 1
   end function block_of

   !> Place of joint i of a batch in its block
   pure elemental integer function lane_of(i)
      integer, intent(in) :: i

      lane_of = modulo(i - 1, BLOCK) + 1
   end function lane_of

   !> How many of n joints or leads go through a kernel at once. Few: numbers that callers write as
   !> constants, for which the compiler makes kernels of their own, without loops; more do not gain.
   pure integer function group_of(n) result(group)
      integer, intent(in) :: n

      group = min(n, BLOCK)
      if (n > 4 .and. n < 16) group = merge(4, 8, n < 8)
   end function group_of

   !> E := Exp(phi) E, exact (Rodrigues). Three columns, turned by the same vector.
   pure subroutine turn_frames(n, phi, e)
      integer, value :: n
      real(wp), intent(in) :: phi(BLOCK, 3)      !! rotation vector, W [rad]
      real(wp), intent(inout) :: e(BLOCK, 9)

      real(wp) :: a2(BLOCK), s(BLOCK), c(BLOCK), x, y, z, d
      integer :: i, k

      !$omp simd
      do i = 1, n
         a2(i) = phi(i, 1)**2 + phi(i, 2)**2 + phi(i, 3)**2
      end do
      call turn_coefficients(n, a2, s, c)
      do k = 1, 7, 3
         !$omp simd private(x, y, z, d)
         do i = 1, n
            x = e(i, k)
            y = e(i, k + 1)
            z = e(i, k + 2)
            d = c(i)*(phi(i, 1)*x + phi(i, 2)*y + phi(i, 3)*z)
            e(i, k) = x - c(i)*a2(i)*x + d*phi(i, 1) + s(i)*(phi(i, 2)*z - phi(i, 3)*y)
            e(i, k + 1) = y - c(i)*a2(i)*y + d*phi(i, 2) + s(i)*(phi(i, 3)*x - phi(i, 1)*z)
            e(i, k + 2) = z - c(i)*a2(i)*z + d*phi(i, 3) + s(i)*(phi(i, 1)*y - phi(i, 2)*x)
         end do
      end do
   end subroutine turn_frames

   !> u := (u + h w x u) made 1 long: to first order, as the legacy scheme has it
   pure subroutine turn_axes(n, h, w, u)
      integer, value :: n
      real(wp), intent(in) :: h
      real(wp), intent(in) :: w(BLOCK, 3)        !! W
      real(wp), intent(inout) :: u(BLOCK, 3)     !! W

      real(wp) :: x, y, z, s
      integer :: i

      !$omp simd private(x, y, z, s)
      do i = 1, n
         x = u(i, 1) + h*(w(i, 2)*u(i, 3) - w(i, 3)*u(i, 2))
         y = u(i, 2) + h*(w(i, 3)*u(i, 1) - w(i, 1)*u(i, 3))
         z = u(i, 3) + h*(w(i, 1)*u(i, 2) - w(i, 2)*u(i, 1))
         s = 1.0_wp/sqrt(x**2 + y**2 + z**2)
         u(i, 1) = s*x
         u(i, 2) = s*y
         u(i, 3) = s*z
      end do
   end subroutine turn_axes

   !> Universal frame E = [u x v normalised, u, v] and its dual basis (rows of E^-1).
   !>
   !> n = u x v / s, s = |u x v|;  dual: n, v x n / s, n x u / s
   pure subroutine cross_frames(n, u, v, e, dual)
      integer, value :: n
      real(wp), intent(in) :: u(BLOCK, 3), v(BLOCK, 3)   !! axis of body 1 and of body 2, unit, W
      real(wp), intent(out) :: e(BLOCK, 9), dual(BLOCK, 9)

      real(wp) :: s, n1, n2, n3
      integer :: i

      !$omp simd private(s, n1, n2, n3)
      do i = 1, n
         n1 = u(i, 2)*v(i, 3) - u(i, 3)*v(i, 2)
         n2 = u(i, 3)*v(i, 1) - u(i, 1)*v(i, 3)
         n3 = u(i, 1)*v(i, 2) - u(i, 2)*v(i, 1)
         s = 1.0_wp/sqrt(n1**2 + n2**2 + n3**2)
         n1 = n1*s
         n2 = n2*s
         n3 = n3*s
         e(i, 1) = n1
         e(i, 2) = n2
         e(i, 3) = n3
         e(i, 4:6) = u(i, :)
         e(i, 7:9) = v(i, :)
         dual(i, 1) = n1
         dual(i, 2) = n2
         dual(i, 3) = n3
         dual(i, 4) = (v(i, 2)*n3 - v(i, 3)*n2)*s
         dual(i, 5) = (v(i, 3)*n1 - v(i, 1)*n3)*s
         dual(i, 6) = (v(i, 1)*n2 - v(i, 2)*n1)*s
         dual(i, 7) = (n2*u(i, 3) - n3*u(i, 2))*s
         dual(i, 8) = (n3*u(i, 1) - n1*u(i, 3))*s
         dual(i, 9) = (n1*u(i, 2) - n2*u(i, 1))*s
      end do
   end subroutine cross_frames

   !> Components of a on the dual basis: b_k = dual_k . a (dual = E for an orthonormal frame)
   pure subroutine to_local(n, dual, a, b)
      integer, value :: n
      real(wp), intent(in) :: dual(BLOCK, 9)
      real(wp), intent(in) :: a(BLOCK, 3)       !! W
      real(wp), intent(out) :: b(BLOCK, 3)      !! J

      integer :: i, k

      do k = 1, 3
         !$omp simd
         do i = 1, n
            b(i, k) = dual(i, 3*k - 2)*a(i, 1) + dual(i, 3*k - 1)*a(i, 2) + dual(i, 3*k)*a(i, 3)
         end do
      end do
   end subroutine to_local

   !> a = E1 b1 + E2 b2 + E3 b3
   pure subroutine to_world(n, e, b, a)
      integer, value :: n
      real(wp), intent(in) :: e(BLOCK, 9)
      real(wp), intent(in) :: b(BLOCK, 3)       !! J
      real(wp), intent(out) :: a(BLOCK, 3)      !! W

      integer :: i, k

      do k = 1, 3
         !$omp simd
         do i = 1, n
            a(i, k) = e(i, k)*b(i, 1) + e(i, k + 3)*b(i, 2) + e(i, k + 6)*b(i, 3)
         end do
      end do
   end subroutine to_world

   !> c := c + factor a x b
   pure subroutine add_cross(n, factor, a, b, c)
      integer, value :: n
      real(wp), intent(in) :: factor
      real(wp), intent(in) :: a(BLOCK, 3), b(BLOCK, 3)
      real(wp), intent(inout) :: c(BLOCK, 3)

      integer :: i

      !$omp simd
      do i = 1, n
         c(i, 1) = c(i, 1) + factor*(a(i, 2)*b(i, 3) - a(i, 3)*b(i, 2))
         c(i, 2) = c(i, 2) + factor*(a(i, 3)*b(i, 1) - a(i, 1)*b(i, 3))
         c(i, 3) = c(i, 3) + factor*(a(i, 1)*b(i, 2) - a(i, 2)*b(i, 1))
      end do
   end subroutine add_cross

   !> b = a turned by the quaternion q
   pure subroutine turn_arm(n, q, a, b)
      integer, value :: n
      real(wp), intent(in) :: q(BLOCK, 4), a(BLOCK, 3)
      real(wp), intent(out) :: b(BLOCK, 3)

      real(wp) :: t1, t2, t3
      integer :: i

      !$omp simd private(t1, t2, t3)
      do i = 1, n
         t1 = 2.0_wp*(q(i, 3)*a(i, 3) - q(i, 4)*a(i, 2))
         t2 = 2.0_wp*(q(i, 4)*a(i, 1) - q(i, 2)*a(i, 3))
         t3 = 2.0_wp*(q(i, 2)*a(i, 2) - q(i, 3)*a(i, 1))
         b(i, 1) = a(i, 1) + q(i, 1)*t1 + (q(i, 3)*t3 - q(i, 4)*t2)
         b(i, 2) = a(i, 2) + q(i, 1)*t2 + (q(i, 4)*t1 - q(i, 2)*t3)
         b(i, 3) = a(i, 3) + q(i, 1)*t3 + (q(i, 2)*t2 - q(i, 3)*t1)
      end do
   end subroutine turn_arm

   !> Axes with e1 along r, all orthonormal; the global ones where r is zero
   pure subroutine line_axes(n, r, e)
      integer, value :: n
      real(wp), intent(in) :: r(BLOCK, 3)        !! from node 1 to node 2, W
      real(wp), intent(out) :: e(BLOCK, 9)

      real(wp) :: length, u(3), v(3)
      integer :: i

      do i = 1, n
         length = sqrt(r(i, 1)**2 + r(i, 2)**2 + r(i, 3)**2)
         u = [1.0_wp, 0.0_wp, 0.0_wp]
         if (length > 0.0_wp) u = r(i, :)/length
         v = 0.0_wp
         v(minloc(abs(u), dim=1)) = 1.0_wp
         v = v - dot_product(u, v)*u
         v = v/norm2(v)
         e(i, 1:3) = u
         e(i, 4:6) = v
         e(i, 7) = u(2)*v(3) - u(3)*v(2)
         e(i, 8) = u(3)*v(1) - u(1)*v(3)
         e(i, 9) = u(1)*v(2) - u(2)*v(1)
      end do
   end subroutine line_axes

end module kj_block
