!> Force laws of one local dof for a block of joints, and the stiffness they ask of the time step.
!> Pure, no branch on the joint type: a blocked dof is a dof with a penalty stiffness.
module kj_legacy_law
   use kj_kinds, only: wp
   use kj_curve, only: curve_set_t, law_value
   implicit none
   private

   public :: add_spring_and_damper, add_spring_curve, add_damper_curve
   public :: add_spring, add_spring_curve_slope, add_critical_damping, add_damper

contains

   !> f += k q + c qdot
   pure subroutine add_spring_and_damper(n, q, qdot, k, c, f)
      integer, value :: n
      real(wp), intent(in) :: q(n), qdot(n)    !! displacement or rotation, and its rate
      real(wp), intent(in) :: k(n), c(n)
      real(wp), intent(inout) :: f(n)          !! force or moment on node 1

      integer :: i

      !$omp simd
      do i = 1, n
         f(i) = f(i) + k(i)*q(i) + c(i)*qdot(i)
      end do
   end subroutine add_spring_and_damper

   !> Tabulated elastic force f += k g(q), with its stiffness for the time step.
   !>
   !> Legacy quirks, kept on purpose: the secant (f - f(0))/max(1e-15, q) also counts, so a small
   !> negative q can ask for an enormous stiffness; a negative slope makes the critical damping
   !> of this free dof 0 sqrt(negative) = NaN where the reduced mass is not zero.
   !> Source: docs/theory/legacy.md 3.6.
   pure subroutine add_spring_curve(n, curves, curve, k, mass, q, qdot, f, k_top)
      integer, value :: n
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: curve(n)          !! index of the curve
      real(wp), intent(in) :: k(n)             !! scale of the curve
      real(wp), intent(in) :: mass(n)          !! reduced mass or inertia
      real(wp), intent(in) :: q(n), qdot(n)
      real(wp), intent(inout) :: f(n)
      real(wp), intent(inout) :: k_top(n)      !! largest stiffness so far

      real(wp) :: y, slope, y0, slope0, k_eff
      integer :: i

      do i = 1, n
         call law_value(curves, curve(i), q(i), y, slope)
         call law_value(curves, curve(i), 0.0_wp, y0, slope0)
         k_eff = k(i)*slope
         k_top(i) = max(k_top(i), k_eff, k(i)*(y - y0)/max(1.0e-15_wp, q(i)))
         f(i) = f(i) + k(i)*y + 0.0_wp*sqrt(k_eff*mass(i))*qdot(i)
      end do
   end subroutine add_spring_curve

   !> Tabulated damping force f += c g(qdot), with its slope for the time step
   pure subroutine add_damper_curve(n, curves, curve, c, qdot, f, c_top)
      integer, value :: n
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: curve(n)
      real(wp), intent(in) :: c(n), qdot(n)
      real(wp), intent(inout) :: f(n)
      real(wp), intent(inout) :: c_top(n)

      real(wp) :: y, slope
      integer :: i

      do i = 1, n
         call law_value(curves, curve(i), qdot(i), y, slope)
         f(i) = f(i) + c(i)*y
         c_top(i) = max(c_top(i), c(i)*slope)
      end do
   end subroutine add_damper_curve

   !> f += k q, and its stiffness
   pure subroutine add_spring(n, q, k, f, k_eff, k_top)
      integer, value :: n
      real(wp), intent(in) :: q(n), k(n)
      real(wp), intent(inout) :: f(n)
      real(wp), intent(inout) :: k_eff(n)      !! stiffness of this dof
      real(wp), intent(inout) :: k_top(n)      !! largest stiffness so far

      integer :: i

      !$omp simd
      do i = 1, n
         f(i) = f(i) + k(i)*q(i)
         k_eff(i) = k_eff(i) + k(i)
         k_top(i) = max(k_top(i), k_eff(i))
      end do
   end subroutine add_spring

   !> Tabulated elastic force f += k g(q) as `add_spring_curve`, for dofs whose critical damping
   !> comes later: it tells its slope
   pure subroutine add_spring_curve_slope(n, curves, curve, k, q, f, k_eff, k_top)
      integer, value :: n
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: curve(n)          !! index of the curve
      real(wp), intent(in) :: k(n)             !! scale of the curve
      real(wp), intent(in) :: q(n)
      real(wp), intent(inout) :: f(n), k_eff(n), k_top(n)

      real(wp) :: y, slope, y0, slope0
      integer :: i

      do i = 1, n
         call law_value(curves, curve(i), q(i), y, slope)
         call law_value(curves, curve(i), 0.0_wp, y0, slope0)
         f(i) = f(i) + k(i)*y
         k_eff(i) = k_eff(i) + k(i)*slope
         k_top(i) = max(k_top(i), k_eff(i), k(i)*(y - y0)/max(1.0e-15_wp, q(i)))
      end do
   end subroutine add_spring_curve_slope

   !> f += cr sqrt(k m) qdot; NaN where k < 0, as the legacy scheme has it
   pure subroutine add_critical_damping(n, cr, k, m, qdot, f)
      integer, value :: n
      real(wp), intent(in) :: cr(n)            !! critical damping ratio, 0 where none acts
      real(wp), intent(in) :: k(n), m(n)       !! stiffness of the dof, reduced mass or inertia
      real(wp), intent(in) :: qdot(n)
      real(wp), intent(inout) :: f(n)

      integer :: i

      !$omp simd
      do i = 1, n
         f(i) = f(i) + cr(i)*sqrt(k(i)*m(i))*qdot(i)
      end do
   end subroutine add_critical_damping

   !> f += c qdot, and its damping for the time step
   pure subroutine add_damper(n, c, qdot, f, c_top)
      integer, value :: n
      real(wp), intent(in) :: c(n), qdot(n)
      real(wp), intent(inout) :: f(n)
      real(wp), intent(inout) :: c_top(n)

      integer :: i

      !$omp simd
      do i = 1, n
         f(i) = f(i) + c(i)*qdot(i)
         c_top(i) = max(c_top(i), c(i))
      end do
   end subroutine add_damper

end module kj_legacy_law
