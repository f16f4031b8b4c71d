!> Drift by the implicit Lie midpoint rule: exact angular momentum in space, exact energy of bodies
!> with two equal inertias.
!> Source: docs/theory/consistent.md 4; Krysl, IJNME 63 (2005) 2171.
module kj_consistent_midpoint
   use kj_kinds, only: wp
   use kj_math3, only: cross, rotation, inverse3, turn_coefficients, IDENTITY
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: columns
   implicit none
   private

   public :: midpoint_drift, midpoint_turn

   integer, parameter :: MOST_ROUNDS = 30        !! of Newton's method

contains

   !> x += h v and the turn of leads lo..hi over h
   subroutine midpoint_drift(model, state, h, lo, hi)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      real(wp), intent(in) :: h
      integer, intent(in) :: lo, hi

      real(wp) :: l(3), psi(3), a, q(4), p(4), s(1), k(1)
      integer :: i

      do i = lo, hi
         state%poses%x(i, :) = state%poses%x(i, :) + h*state%v(i, :)
         state%poses%d(i, :) = state%poses%d(i, :) + h*state%v(i, :)
         q = state%poses%quat(i, :)
         l = matmul(state%l(i, :), reshape(columns(q), [3, 3]))
         psi = midpoint_turn(model%inverse_inertia(i, :), l, h)
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

      real(wp) :: p(3), miss(3), slope(3, 3), inverse(3, 3), e(3), a2, s(1), k(1), third
      integer :: round, j
      logical :: regular

      psi = h*ii*l
      do round = 1, MOST_ROUNDS
         p = matmul(rotation(-0.5_wp*psi), l)
         miss = psi - h*ii*p
         if (maxval(abs(miss)) <= 4.0_wp*epsilon(1.0_wp)*maxval(abs(psi))) return
         a2 = 0.25_wp*dot_product(psi, psi)
         call turn_coefficients(1, [a2], s, k)
         third = 1.0_wp/6.0_wp - a2/120.0_wp
         if (a2 > 1.0e-3_wp) third = (1.0_wp - s(1))/a2
         do j = 1, 3
            e = 0.5_wp*IDENTITY(:, j)
            e = e - k(1)*cross(0.5_wp*psi, e) + third*cross(0.5_wp*psi, cross(0.5_wp*psi, e))
            slope(:, j) = IDENTITY(:, j) - h*ii*cross(p, e)
         end do
         call inverse3(slope, inverse, regular)
         if (.not. regular) return
         psi = psi - matmul(inverse, miss)
      end do
   end function midpoint_turn

end module kj_consistent_midpoint
