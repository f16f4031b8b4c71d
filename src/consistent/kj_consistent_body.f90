!> Rigid bodies under the consistent formulation: half kicks, the drift by plane rotations, and the
!> angular velocity that belongs to an angular momentum.
!> One file: kicks, drifts and what they read of the leads.
!> Source: docs/theory/consistent.md 2, 3; Dullweber, Leimkuhler, McLachlan, J. Chem. Phys. 107
!> (1997) 5840.
module kj_consistent_body
   use kj_kinds, only: wp
   use kj_math3, only: turn_coefficients, cross, rotation, inverse3, IDENTITY
   use kj_block, only: BLOCK, turn_arm
   use kj_consistent_chart, only: quaternion_frame
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   implicit none
   private

   public :: kick, drift, predict, spin_velocity, spin, inverse_inertias, inertias_of, &
      lead_frames, columns, turn_in_space, midpoint_drift, midpoint_turn

   integer, parameter :: MOST_ROUNDS = 30        !! of Newton's method

contains

   !> v += h/2 f/m, L += h/2 t of n leads from ...; blocked leads have no inverse mass or inertia
   pure subroutine kick(n, from, model, h, f, t, v, l)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)               !! the whole step of each lead
      real(wp), intent(in), dimension(model%n_lead, 3) :: f, t
      real(wp), intent(inout), dimension(model%n_lead, 3) :: v, l

      integer :: i, j, k

      do k = 1, 3
         !$omp simd private(i)
         do j = 1, n
            i = from + j - 1
            v(i, k) = v(i, k) + 0.5_wp*h(j)*model%inverse_mass(i)*f(i, k)
            l(i, k) = l(i, k) + 0.5_wp*h(j)*(model%turns(i)*t(i, k))
         end do
      end do
   end subroutine kick

   !> x += h v, and the free rotation over h of n leads from ..., at most BLOCK.
   !>
   !> Three unequal inertias: half, half about the smallest and the middle axis, whole about the
   !> largest, and back. Two equal ones: the exact motion, a turn h L/It in space and one about the
   !> axis of symmetry by h l (1/Ia - 1/It).
   pure subroutine drift(n, from, model, h, v, momentum, x, d, quat)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n)
      real(wp), intent(in), dimension(model%n_lead, 3) :: v, momentum
      real(wp), intent(inout), dimension(model%n_lead, 3) :: x, d
      real(wp), intent(inout) :: quat(model%n_lead, 4)

      real(wp), dimension(BLOCK, 3) :: l, space, part, w
      real(wp) :: q(BLOCK, 4), scale
      logical :: unequal
      integer :: to, i, k

      to = from + n - 1
      do k = 1, 3
         x(from:to, k) = x(from:to, k) + h(:n)*v(from:to, k)
         d(from:to, k) = d(from:to, k) + h(:n)*v(from:to, k)
         l(:n, k) = momentum(from:to, k)
      end do
      do k = 1, 4
         q(:n, k) = quat(from:to, k)
      end do
      unequal = any(model%equal(from:to) == 0)
      if (any(model%equal(from:to) > 0)) then
         call symmetric_part(model, from, n, h, l, space, part)
         call turn_in_space(n, space, q)
      else
         part(:n, 1) = 1.0_wp
         part(:n, 2:3) = 0.5_wp
      end if
      call conjugate_turn(n, q, l, w)
      call plane_turn(n, h, part(:, 3), model%inverse_inertia(from:to, 3), q(:, 1), q(:, 4), &
         q(:, 2), q(:, 3), w(:, 3), w(:, 1), w(:, 2))
      call plane_turn(n, h, part(:, 2), model%inverse_inertia(from:to, 2), q(:, 1), q(:, 3), &
         q(:, 4), q(:, 2), w(:, 2), w(:, 3), w(:, 1))
      call plane_turn(n, h, part(:, 1), model%inverse_inertia(from:to, 1), q(:, 1), q(:, 2), &
         q(:, 3), q(:, 4), w(:, 1), w(:, 2), w(:, 3))
      if (unequal) then
         do i = 1, n
            if (model%equal(from + i - 1) > 0) part(i, 2:3) = 0.0_wp
         end do
         call plane_turn(n, h, part(:, 2), model%inverse_inertia(from:to, 2), q(:, 1), q(:, 3), &
            q(:, 4), q(:, 2), w(:, 2), w(:, 3), w(:, 1))
         call plane_turn(n, h, part(:, 3), model%inverse_inertia(from:to, 3), q(:, 1), q(:, 4), &
            q(:, 2), q(:, 3), w(:, 3), w(:, 1), w(:, 2))
      end if
      !$omp simd private(scale)
      do i = 1, n
         scale = 1.5_wp - 0.5_wp*(q(i, 1)**2 + q(i, 2)**2 + q(i, 3)**2 + q(i, 4)**2)
         ! a lead at rest does not change by a rounding
         scale = merge(scale, 1.0_wp, model%inverse_inertia(from + i - 1, 1) > 0.0_wp)
         quat(from + i - 1, 1) = q(i, 1)*scale
         quat(from + i - 1, 2) = q(i, 2)*scale
         quat(from + i - 1, 3) = q(i, 3)*scale
         quat(from + i - 1, 4) = q(i, 4)*scale
      end do
   end subroutine drift

   !> Space turn h L/It of symmetric bodies (0 for others), and the share of each plane rotation
   pure subroutine symmetric_part(model, from, n, h, l, space, part)
      type(consistent_model_t), intent(in) :: model
      integer, value :: from, n
      real(wp), intent(in) :: h(n), l(BLOCK, 3)
      real(wp), intent(out) :: space(BLOCK, 3), part(BLOCK, 3)

      real(wp) :: it
      integer :: i, j, a

      do i = 1, n
         j = from + i - 1
         a = model%equal(j)
         if (a == 0) then
            space(i, :) = 0.0_wp
            part(i, 1) = 1.0_wp
            part(i, 2:3) = 0.5_wp
         else
            it = model%inverse_inertia(j, modulo(a, 3) + 1)
            space(i, :) = h(i)*it*l(i, :)
            part(i, :) = 0.0_wp
            if (model%inverse_inertia(j, a) > 0.0_wp) part(i, a) = &
               1.0_wp - it/model%inverse_inertia(j, a)
         end if
      end do
   end subroutine symmetric_part

   !> q := Exp(phi) q
   pure subroutine turn_in_space(n, phi, q)
      integer, value :: n
      real(wp), intent(in) :: phi(BLOCK, 3)
      real(wp), intent(inout) :: q(BLOCK, 4)

      real(wp) :: a2(BLOCK), s(BLOCK), c(BLOCK), w, x, y, z, p(4)
      integer :: i

      do i = 1, n
         a2(i) = 0.25_wp*(phi(i, 1)**2 + phi(i, 2)**2 + phi(i, 3)**2)
      end do
      call turn_coefficients(n, a2, s, c)
      !$omp simd private(w, x, y, z, p)
      do i = 1, n
         w = 1.0_wp - a2(i)*c(i)
         x = 0.5_wp*s(i)*phi(i, 1)
         y = 0.5_wp*s(i)*phi(i, 2)
         z = 0.5_wp*s(i)*phi(i, 3)
         p(1) = q(i, 1)
         p(2) = q(i, 2)
         p(3) = q(i, 3)
         p(4) = q(i, 4)
         q(i, 1) = w*p(1) - x*p(2) - y*p(3) - z*p(4)
         q(i, 2) = w*p(2) + x*p(1) + y*p(4) - z*p(3)
         q(i, 3) = w*p(3) + y*p(1) + z*p(2) - x*p(4)
         q(i, 4) = w*p(4) + z*p(1) + x*p(3) - y*p(2)
      end do
   end subroutine turn_in_space

   !> Turn about body axis a by share*h*l_a/I_a: q := q (c, s e_a), and l stays the same in space;
   !> columns of q and l, axes a, j, k in cyclic order
   pure subroutine plane_turn(n, h, share, ii, q0, qa, qj, qk, la, lj, lk)
      integer, value :: n
      real(wp), intent(in) :: h(n), share(n), ii(n), la(n)
      real(wp), intent(inout), dimension(n) :: q0, qa, qj, qk, lj, lk

      real(wp) :: x(BLOCK), x2(BLOCK), s(BLOCK), c(BLOCK), si, co, t
      integer :: i

      do i = 1, n
         x(i) = 0.5_wp*h(i)*share(i)*ii(i)*la(i)
         x2(i) = x(i)**2
      end do
      call turn_coefficients(n, x2, s, c)
      !$omp simd private(si, co, t)
      do i = 1, n
         si = x(i)*s(i)
         co = 1.0_wp - x2(i)*c(i)
         t = q0(i)
         q0(i) = co*t - si*qa(i)
         qa(i) = co*qa(i) + si*t
         t = qj(i)
         qj(i) = co*t + si*qk(i)
         qk(i) = co*qk(i) - si*t
         t = 2.0_wp*si*co
         co = 1.0_wp - 2.0_wp*si*si
         si = t
         t = lj(i)
         lj(i) = co*t + si*lk(i)
         lk(i) = co*lk(i) - si*t
      end do
   end subroutine plane_turn

   !> b = a in body axes: turned by the conjugate of q
   pure subroutine conjugate_turn(n, q, a, b)
      integer, value :: n
      real(wp), intent(in) :: q(BLOCK, 4), a(BLOCK, 3)
      real(wp), intent(out) :: b(BLOCK, 3)

      real(wp) :: p(BLOCK, 4)

      p(:n, 1) = q(:n, 1)
      p(:n, 2:4) = -q(:n, 2:4)
      call turn_arm(n, p, a, b)
   end subroutine conjugate_turn

   !> Velocities of n leads from ... after another half kick: v + h/2 f/m, J^-1 (L + h/2 t)
   pure subroutine predict(n, from, model, h, inverse, f, t, v, momentum, v_ahead, w_ahead)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h(n), inverse(BLOCK, 6)   !! J^-1 of the leads
      real(wp), intent(in) :: f(BLOCK, 3), t(BLOCK, 3)   !! of them
      real(wp), intent(in), dimension(model%n_lead, 3) :: v, momentum
      real(wp), intent(inout), dimension(model%n_lead, 3) :: v_ahead, w_ahead

      real(wp) :: l1, l2, l3
      integer :: i, j, k

      do k = 1, 3
         !$omp simd private(j)
         do i = 1, n
            j = from + i - 1
            v_ahead(j, k) = v(j, k) + 0.5_wp*h(i)*model%inverse_mass(j)*f(i, k)
         end do
      end do
      !$omp simd private(j, l1, l2, l3)
      do i = 1, n
         j = from + i - 1
         l1 = momentum(j, 1) + 0.5_wp*h(i)*t(i, 1)
         l2 = momentum(j, 2) + 0.5_wp*h(i)*t(i, 2)
         l3 = momentum(j, 3) + 0.5_wp*h(i)*t(i, 3)
         w_ahead(j, 1) = inverse(i, 1)*l1 + inverse(i, 4)*l2 + inverse(i, 5)*l3
         w_ahead(j, 2) = inverse(i, 4)*l1 + inverse(i, 2)*l2 + inverse(i, 6)*l3
         w_ahead(j, 3) = inverse(i, 5)*l1 + inverse(i, 6)*l2 + inverse(i, 3)*l3
      end do
   end subroutine predict

   !> w = J^-1 L of leads lo..hi
   pure subroutine spin_velocity(model, quat, l, lo, hi, w)
      type(consistent_model_t), intent(in) :: model
      real(wp), contiguous, intent(in) :: quat(:, :)  !! (n_lead, 4)
      real(wp), contiguous, intent(in) :: l(:, :)     !! (n_lead, 3) angular momentum, W
      integer, intent(in) :: lo, hi
      real(wp), contiguous, intent(inout) :: w(:, :)  !! (n_lead, 3)

      integer :: from

      do from = lo, hi, BLOCK
         call spin(min(BLOCK, hi - from + 1), from, model, quat, l, w)
      end do
   end subroutine spin_velocity

   !> The same of n leads from ..., at most BLOCK
   pure subroutine spin(n, from, model, quat, l, w)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: quat(model%n_lead, 4), l(model%n_lead, 3)
      real(wp), intent(inout) :: w(model%n_lead, 3)

      real(wp) :: part(BLOCK, 3), e(BLOCK, 9)
      integer :: k

      do k = 1, 3
         part(:n, k) = l(from:from + n - 1, k)
      end do
      call lead_frames(n, from, model%n_lead, quat, e)
      call spin_block(n, from, model, e, part, w)
   end subroutine spin

   !> Principal axes of n leads from ..., at most BLOCK
   pure subroutine lead_frames(n, from, n_lead, quat, e)
      integer, value :: n, from, n_lead
      real(wp), intent(in) :: quat(n_lead, 4)
      real(wp), intent(out) :: e(BLOCK, 9)

      real(wp) :: q(BLOCK, 4)
      integer :: k

      do k = 1, 4
         q(:n, k) = quat(from:from + n - 1, k)
      end do
      call quaternion_frame(n, q, e)
   end subroutine lead_frames

   !> w = J^-1 L of n leads from ..., frames and L of these alone
   pure subroutine spin_block(n, from, model, e, l, w)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: e(BLOCK, 9), l(BLOCK, 3)
      real(wp), intent(inout) :: w(model%n_lead, 3)

      real(wp) :: s1, s2, s3
      integer :: i, j

      !$omp simd private(j, s1, s2, s3)
      do i = 1, n
         j = from + i - 1
         s1 = model%inverse_inertia(j, 1)*(e(i, 1)*l(i, 1) + e(i, 2)*l(i, 2) + e(i, 3)*l(i, 3))
         s2 = model%inverse_inertia(j, 2)*(e(i, 4)*l(i, 1) + e(i, 5)*l(i, 2) + e(i, 6)*l(i, 3))
         s3 = model%inverse_inertia(j, 3)*(e(i, 7)*l(i, 1) + e(i, 8)*l(i, 2) + e(i, 9)*l(i, 3))
         w(j, 1) = e(i, 1)*s1 + e(i, 4)*s2 + e(i, 7)*s3
         w(j, 2) = e(i, 2)*s1 + e(i, 5)*s2 + e(i, 8)*s3
         w(j, 3) = e(i, 3)*s1 + e(i, 6)*s2 + e(i, 9)*s3
      end do
   end subroutine spin_block

   !> J^-1 in W times the number of joints of the lead: xx yy zz xy xz yz
   pure subroutine inverse_inertias(model, quat, lo, hi, ij)
      type(consistent_model_t), intent(in) :: model
      real(wp), contiguous, intent(in) :: quat(:, :)
      integer, intent(in) :: lo, hi
      real(wp), contiguous, intent(inout) :: ij(:, :) !! (n_lead, 6)

      real(wp) :: e(BLOCK, 9), inverse(BLOCK, 6)
      integer :: from, n

      do from = lo, hi, BLOCK
         n = min(BLOCK, hi - from + 1)
         call lead_frames(n, from, model%n_lead, quat, e)
         call inertias_of(n, from, model, e, inverse, ij)
      end do
   end subroutine inverse_inertias

   !> The same of n leads from ..., at most BLOCK, and J^-1 itself
   pure subroutine inertias_of(n, from, model, e, inverse, ij)
      integer, value :: n, from
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: e(BLOCK, 9)             !! frames of these leads
      real(wp), intent(out) :: inverse(BLOCK, 6)      !! of these leads: xx yy zz xy xz yz
      real(wp), intent(inout) :: ij(model%n_lead, 6)

      real(wp) :: x1, x2, x3, y1, y2, y3
      integer :: i, j, k

      !$omp simd private(j, x1, x2, x3, y1, y2, y3)
      do i = 1, n
         j = from + i - 1
         x1 = model%inverse_inertia(j, 1)*e(i, 1)
         x2 = model%inverse_inertia(j, 2)*e(i, 4)
         x3 = model%inverse_inertia(j, 3)*e(i, 7)
         y1 = model%inverse_inertia(j, 1)*e(i, 2)
         y2 = model%inverse_inertia(j, 2)*e(i, 5)
         y3 = model%inverse_inertia(j, 3)*e(i, 8)
         inverse(i, 1) = x1*e(i, 1) + x2*e(i, 4) + x3*e(i, 7)
         inverse(i, 2) = y1*e(i, 2) + y2*e(i, 5) + y3*e(i, 8)
         inverse(i, 3) = model%inverse_inertia(j, 1)*e(i, 3)*e(i, 3) + &
            model%inverse_inertia(j, 2)*e(i, 6)*e(i, 6) + &
            model%inverse_inertia(j, 3)*e(i, 9)*e(i, 9)
         inverse(i, 4) = x1*e(i, 2) + x2*e(i, 5) + x3*e(i, 8)
         inverse(i, 5) = x1*e(i, 3) + x2*e(i, 6) + x3*e(i, 9)
         inverse(i, 6) = y1*e(i, 3) + y2*e(i, 6) + y3*e(i, 9)
      end do
      do k = 1, 6
         !$omp simd
         do i = 1, n
            ij(from + i - 1, k) = model%n_end(from + i - 1)*inverse(i, k)
         end do
      end do
   end subroutine inertias_of

   !> Columns of the rotation matrix of a unit quaternion
   pure function columns(p) result(e)
      real(wp), intent(in) :: p(4)
      real(wp) :: e(9)

      e(1) = 1.0_wp - 2.0_wp*(p(3)*p(3) + p(4)*p(4))
      e(2) = 2.0_wp*(p(2)*p(3) + p(1)*p(4))
      e(3) = 2.0_wp*(p(2)*p(4) - p(1)*p(3))
      e(4) = 2.0_wp*(p(2)*p(3) - p(1)*p(4))
      e(5) = 1.0_wp - 2.0_wp*(p(2)*p(2) + p(4)*p(4))
      e(6) = 2.0_wp*(p(3)*p(4) + p(1)*p(2))
      e(7) = 2.0_wp*(p(2)*p(4) + p(1)*p(3))
      e(8) = 2.0_wp*(p(3)*p(4) - p(1)*p(2))
      e(9) = 1.0_wp - 2.0_wp*(p(2)*p(2) + p(3)*p(3))
   end function columns

   ! ---- Drift by the implicit Lie midpoint rule: exact angular momentum in space, exact energy of
   ! bodies with two equal inertias. Source: docs/theory/consistent.md 4; Krysl, IJNME 63 (2005).

   !> x += h v and the turn of leads lo..hi over h, at most BLOCK
   subroutine midpoint_drift(model, state, h, lo, hi)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h(lo:hi)

      real(wp) :: l(3), psi(3), a, q(4), p(4), s(1), k(1), e(9)
      integer :: i

      do i = lo, hi
         state%poses%x(i, :) = state%poses%x(i, :) + h(i)*state%v(i, :)
         state%poses%d(i, :) = state%poses%d(i, :) + h(i)*state%v(i, :)
         q = state%poses%quat(i, :)
         e = columns(q)
         l = state%l(i, :)
         l = [dot_product(l, e(1:3)), dot_product(l, e(4:6)), dot_product(l, e(7:9))]
         e(1:3) = model%inverse_inertia(i, :)
         psi = midpoint_turn(e(1:3), l, h(i))
         a = 0.25_wp*dot_product(psi, psi)
         call turn_coefficients(1, [a], s, k)
         p(1) = 1.0_wp - a*k(1)
         p(2:4) = 0.5_wp*s(1)*psi
         a = q(1)
         q(1) = a*p(1) - dot_product(q(2:4), p(2:4))
         q(2:4) = a*p(2:4) + p(1)*q(2:4) + cross(state%poses%quat(i, 2:4), p(2:4))
         state%poses%quat(i, :) = q*(1.5_wp - 0.5_wp*dot_product(q, q))
      end do
   end subroutine midpoint_drift

   !> Rotation vector of a step in body axes: psi = h J^-1 Exp(-psi/2) l, by Newton's method.
   !>
   !> With y = psi/2, p = Exp(-y) l: dp = p x (dexp(-y) dy),
   !> dexp(-y) = 1 - (1 - cos a)/a^2 [y] + (a - sin a)/a^3 [y]^2, a = |y|
   pure function midpoint_turn(ii, l, h) result(psi)
      real(wp), intent(in) :: ii(3)              !! inverse principal inertias
      real(wp), intent(in) :: l(3)               !! angular momentum, body axes
      real(wp), intent(in) :: h
      real(wp) :: psi(3)

      real(wp) :: p(3), miss(3), slope(3, 3), inverse(3, 3), e(3), once(3), a2, s(1), k(1), &
         third
      integer :: round, j
      logical :: regular

      psi = h*ii*l
      do round = 1, MOST_ROUNDS
         slope = rotation(-0.5_wp*psi)
         p = matmul(slope, l)
         miss = psi - h*ii*p
         if (maxval(abs(miss)) <= 4.0_wp*epsilon(1.0_wp)*maxval(abs(psi))) return
         a2 = 0.25_wp*dot_product(psi, psi)
         call turn_coefficients(1, [a2], s, k)
         third = 1.0_wp/6.0_wp - a2/120.0_wp
         if (a2 > 1.0e-3_wp) third = (1.0_wp - s(1))/a2
         do j = 1, 3
            e = 0.5_wp*IDENTITY(:, j)
            once = cross(0.5_wp*psi, e)
            e = e - k(1)*once + third*cross(0.5_wp*psi, once)
            slope(:, j) = IDENTITY(:, j) - h*ii*cross(p, e)
         end do
         call inverse3(slope, inverse, regular)
         if (.not. regular) return
         e = matmul(inverse, miss)
         psi = psi - e
      end do
   end function midpoint_turn

end module kj_consistent_body
