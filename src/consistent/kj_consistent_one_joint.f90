!> What one joint shows to the bounds of the time step: its largest stiffness, the rows of B of each
!> end, B M^-1 B^T, and eigenvalues.
!> Source: docs/theory/time_step.md 3.
module kj_consistent_one_joint
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_lapack, only: largest_eigenvalue
   use kj_joint_batch, only: LAW_SPRING_CURVE
   use kj_curve, only: curve_set_t
   use kj_joint_types, only: CHART_VECTOR
   use kj_consistent_batch, only: consistent_batch_t, matrix_of, N_B
   use kj_consistent_stop, only: limit_stiffness
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_conditions, only: body_matrix
   implicit none
   private

   public :: largest_stiffness, steepest, curves_of, compliances, rows_of_end, spin_up, eigenvalue

contains

   !> Largest stiffness of each dof of joint i, limits included
   pure function largest_stiffness(curves, batch, i) result(k)
      type(curve_set_t), intent(in) :: curves
      type(consistent_batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp) :: k(6)

      k = steepest(curves, LAW_SPRING_CURVE, batch%law, batch%k(i, :), &
         curves_of(batch%k_curve, i))
      if (batch%limited) k = k + limit_stiffness(batch, curves, i)
   end function largest_stiffness

   !> Curves of joint i; none where the batch has none
   pure function curves_of(curve, i) result(row)
      integer, allocatable, intent(in) :: curve(:, :)   !! (n, 6)
      integer, intent(in) :: i
      integer :: row(6)

      row = 0
      if (allocated(curve)) row = curve(i, :)
   end function curves_of

   !> Largest stiffness or damping of each dof: that of a curve is its steepest rise anywhere
   pure function steepest(curves, bit, law, value, curve) result(k)
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: bit                 !! LAW_ bit of a curve
      integer, intent(in) :: law(6), curve(6)
      real(wp), intent(in) :: value(6)
      real(wp) :: k(6)

      integer :: dof, p

      k = max(0.0_wp, value)
      do dof = 1, 6
         if (iand(law(dof), bit) == 0) cycle
         k(dof) = 0.0_wp
         do p = curves%first(curve(dof)), curves%first(curve(dof) + 1) - 2
            k(dof) = max(k(dof), value(dof)*(curves%y(p + 1) - curves%y(p))/(curves%x(p + 1) - &
               curves%x(p)))
         end do
      end do
   end function steepest

   !> B_b M_b^-1 B_b^T of joint i of batch b, for both ends
   subroutine compliances(model, state, b, i, s)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i
      real(wp), intent(out) :: s(6, 6, 2)

      real(wp) :: rows(6, 6), g
      integer :: e, lead

      do e = 1, 2
         lead = model%geometry(b)%lead(i, e)
         rows = rows_of_end(model%geometry(b), state, b, i, e)
         g = model%inverse_mass(lead)
         s(:, :, e) = matmul(rows(:, 1:3), transpose(rows(:, 1:3)))*g
         rows(:, 4:6) = matmul(rows(:, 4:6), body_matrix(state, lead))
         s(:, :, e) = s(:, :, e) + matmul(rows(:, 4:6)*spread(model%inverse_inertia(lead, :), 1, &
            6), &
            transpose(rows(:, 4:6)))
      end do
   end subroutine compliances

   !> Rows of B of one end: columns 1-3 velocity, 4-6 angular velocity of its lead
   pure function rows_of_end(batch, state, b, i, e) result(rows)
      type(consistent_batch_t), intent(in) :: batch
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i, e
      real(wp) :: rows(6, 6)

      real(wp) :: sign, g, m(N_B)
      integer :: k

      sign = merge(-1.0_wp, 1.0_wp, e == 1)
      g = 1.0_wp
      associate (joint => state%joint(b))
         if (batch%chart == CHART_VECTOR) g = spin_up(joint%q(i, 4:6))
         m = matrix_of(joint, i)
         rows = 0.0_wp
         do k = 1, 3
            rows(k, 1:3) = sign*m(3*k - 2:3*k)
            rows(k, 4:6) = -m(3*k + 7:3*k + 9)
            if (e == 2) rows(k, 4:6) = m(3*k + 7:3*k + 9) - cross(m(28:30), m(3*k - 2:3*k))
            rows(k + 3, 4:6) = sign*g*m(3*k + 16:3*k + 18)
         end do
      end associate
   end function rows_of_end

   !> Largest factor by which the axes of a rotation vector turn spring moments: (a/2)/sin(a/2)
   pure real(wp) function spin_up(theta) result(g)
      real(wp), intent(in) :: theta(3)

      real(wp) :: a

      g = 1.0_wp
      a = 0.5_wp*norm2(theta)
      if (a > 1.0e-3_wp) g = abs(a/sin(a))
   end function spin_up

   !> Largest eigenvalue of K^1/2 S K^1/2
   real(wp) function eigenvalue(k, s) result(lambda)
      real(wp), intent(in) :: k(6), s(6, 6)

      real(wp) :: a(6, 6), root(6)

      root = sqrt(k)
      a = s*spread(root, 2, 6)*spread(root, 1, 6)
      call largest_eigenvalue(6, a, lambda)
   end function eigenvalue

end module kj_consistent_one_joint
