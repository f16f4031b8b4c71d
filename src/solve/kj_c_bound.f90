!> The safe time-step bound of a scene under the consistent formulation; kj_c_limits has others.
!> Damping is implicit, so stiffness alone counts (kappa = 0).
!>
!> Safe: with the mass of each body shared among its joints, M = sum s_bj M_b, the step is stable if
!> 4 M_j - h^2 K_j > 0 for every joint alone: h = 2/sqrt(max lambda_j), lambda_j the largest
!> eigenvalue of K^1/2 (sum_b B_b M_b^-1 B_b^T / s_bj) K^1/2.
!> Source: consistent.md 4.
module kj_c_bound
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_lapack, only: largest_eigenvalue
   use kj_joint_batch, only: LAW_SPRING_CURVE, LAW_DAMPER_CURVE
   use kj_curve, only: curve_set_t
   use kj_model, only: model_t
   use kj_c_batch, only: c_batch_t, matrix_of, CHART_VECTOR, CHART_LINE, N_B
   use kj_c_limit, only: limit_stiffness
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_hold, only: body_matrix
   implicit none
   private

   public :: bound_t, new_bound, renew_bound, has_moved, compliances, largest_stiffness, &
      rows_of_end

   !> The safe bound and what it rests on
   type :: bound_t
      real(wp) :: h = huge(1.0_wp)               !! the bound, unscaled
      integer :: joint = 0                       !! who holds it: index among all joints, 0 = none
      real(wp), allocatable :: share(:, :)       !! (2, n_element) of the mass of each end's lead
      real(wp), allocatable :: k(:, :)           !! (6, n_element) largest stiffness of each dof
      !> (6, n_element) largest damping of each dof, 0 where implicit
      real(wp), allocatable :: c(:, :)
      real(wp), allocatable :: limit(:)          !! (n_element) step that each joint allows
      real(wp), allocatable :: q(:, :)           !! (6, n_element) coordinates then
      !> (27, n_element) of springs: directions and couples, then
      real(wp), allocatable :: rows(:, :)
   end type bound_t

   integer, parameter :: SWEEPS = 4
   real(wp), parameter :: LEAST_SHARE = 1.0e-9_wp
   !> of |h lambda|: stable to 2.6, but RK4 damps by h^6 before
   real(wp), parameter :: RK4_RADIUS = 1.0_wp
   !> relative turn that asks for a new evaluation [rad]
   real(wp), parameter :: TURN = 0.05_wp

contains

   !> Stiffnesses and shares, and the bound in the present pose
   subroutine new_bound(model, c, explicit, state, bound)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      !> Runge-Kutta of fourth order with explicit damping
      logical, intent(in) :: explicit
      type(c_state_t), intent(in) :: state
      type(bound_t), intent(out) :: bound

      real(wp) :: s(6, 6, 2), total(model%n_lead), lambda(model%n_element)
      integer :: b, i, j, e, sweep

      allocate (bound%share(2, model%n_element), bound%k(6, model%n_element), &
         bound%limit(model%n_element))
      allocate (bound%q(6, model%n_element), bound%c(6, model%n_element), source=0.0_wp)
      if (any(c%batch%spring)) allocate (bound%rows(27, model%n_element), source=0.0_wp)
      do b = 1, size(c%batch)
         do i = 1, c%batch(b)%n
            j = c%batch(b)%first + i
            bound%k(:, j) = largest_stiffness(model%curves, c%batch(b), i)
            if (c%batch(b)%chart == CHART_LINE) &
               bound%k(2:3, j) = tension(c%batch(b), state, b, i, bound%k(1, j))
            if (explicit) bound%c(:, j) = steepest(model%curves, LAW_DAMPER_CURVE, c%batch(b)%law, &
               c%batch(b)%c(i, :), c%batch(b)%c_curve(i, :))
            call compliances(c, state, b, i, s)
            do e = 1, 2
               bound%share(e, j) = eigenvalue(bound%k(:, j), s(:, :, e))
            end do
         end do
      end do
      lambda = 1.0_wp
      do sweep = 0, SWEEPS
         total = 0.0_wp
         call add_up(c, bound, lambda, total)
         call divide(c, bound, lambda, total)
         call eigenvalues(c, state, bound, lambda)
      end do
      call take(bound, lambda)
      call keep_pose(c, state, bound)
   end subroutine new_bound

   !> The bound in the present pose with the shares as they are
   subroutine renew_bound(c, state, bound)
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      type(bound_t), intent(inout) :: bound

      real(wp) :: lambda(size(bound%limit))
      integer :: b, i

      do b = 1, size(c%batch)
         if (c%batch(b)%chart /= CHART_LINE) cycle
         do i = 1, c%batch(b)%n
            associate (k => bound%k(:, c%batch(b)%first + i))
               k(2:3) = tension(c%batch(b), state, b, i, k(1))
            end associate
         end do
      end do
      call eigenvalues(c, state, bound, lambda)
      call take(bound, lambda)
      call keep_pose(c, state, bound)
   end subroutine renew_bound

   !> Transverse stiffness F/L of a stretched spring along its line; k where it has no length
   pure real(wp) function tension(batch, state, b, i, k) result(stiffness)
      type(c_batch_t), intent(in) :: batch
      type(c_state_t), intent(in) :: state
      integer, intent(in) :: b, i
      real(wp), intent(in) :: k

      real(wp) :: length

      length = state%joint(b)%q(i, 1) + batch%xl0(i, 1)
      stiffness = k
      if (length > 0.0_wp) stiffness = max(0.0_wp, state%joint(b)%fe(i, 1)/length)
   end function tension

   !> Some joint has turned or slid so far since the last evaluation that the bound may be wrong
   pure logical function has_moved(c, state, bound) result(moved)
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound

      integer :: b, i, j
      real(wp) :: arm, rows(27)

      moved = .true.
      do b = 1, size(c%batch)
         do i = 1, c%batch(b)%n
            j = c%batch(b)%first + i
            if (maxval(abs(state%joint(b)%q(i, 4:6) - bound%q(4:6, j))) > TURN) return
            arm = norm2(c%batch(b)%arm(i, 1:3)) + norm2(c%batch(b)%arm(i, 4:6)) + &
               norm2(c%batch(b)%xl0(i, :) + bound%q(1:3, j))
            if (maxval(abs(state%joint(b)%q(i, 1:3) - bound%q(1:3, j))) > TURN*max(arm, &
               tiny(1.0_wp))) return
            if (.not. c%batch(b)%spring) cycle
            rows = abs(rows_of(state, b, i) - bound%rows(:, j))
            if (maxval(rows(:9)) > TURN .or. maxval(rows(10:)) > TURN*arm) return
         end do
      end do
      moved = .false.
   end function has_moved

   !> Directions and couples of a spring: its axes do not turn with the coordinates alone
   pure function rows_of(state, b, i) result(rows)
      type(c_state_t), intent(in) :: state
      integer, intent(in) :: b, i
      real(wp) :: rows(27)

      real(wp) :: m(N_B)
      integer :: k

      m = matrix_of(state%joint(b), i)
      rows(:18) = m(:18)
      do k = 1, 7, 3
         rows(k + 18:k + 20) = cross(m(28:30), m(k:k + 2)) - m(k + 9:k + 11)
      end do
   end function rows_of

   subroutine keep_pose(c, state, bound)
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      type(bound_t), intent(inout) :: bound

      integer :: b, i

      do b = 1, size(c%batch)
         associate (first => c%batch(b)%first)
            bound%q(:, first + 1:first + c%batch(b)%n) = transpose(state%joint(b)%q)
            if (.not. c%batch(b)%spring) cycle
            do i = 1, c%batch(b)%n
               bound%rows(:, first + i) = rows_of(state, b, i)
            end do
         end associate
      end do
   end subroutine keep_pose

   subroutine take(bound, lambda)
      type(bound_t), intent(inout) :: bound
      real(wp), intent(in) :: lambda(:)

      integer :: j

      bound%limit = huge(1.0_wp)
      where (lambda > 0.0_wp) bound%limit = 2.0_wp/sqrt(lambda)
      bound%h = huge(1.0_wp)
      bound%joint = 0
      if (size(lambda) == 0) return
      j = maxloc(lambda, dim=1)
      if (.not. lambda(j) > 0.0_wp) return
      bound%h = bound%limit(j)
      bound%joint = j
   end subroutine take

   subroutine eigenvalues(c, state, bound, lambda)
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound
      real(wp), intent(out) :: lambda(:)

      real(wp) :: s(6, 6, 2), root
      integer :: b, i, j

      do b = 1, size(c%batch)
         do i = 1, c%batch(b)%n
            j = c%batch(b)%first + i
            call compliances(c, state, b, i, s)
            s(:, :, 1) = s(:, :, 1)/bound%share(1, j) + s(:, :, 2)/bound%share(2, j)
            lambda(j) = eigenvalue(bound%k(:, j), s(:, :, 1))
            if (.not. any(bound%c(:, j) > 0.0_wp)) cycle
            root = 0.5_wp*eigenvalue(bound%c(:, j), s(:, :, 1))
            root = (root + sqrt(root**2 + lambda(j)))*2.0_wp/RK4_RADIUS
            lambda(j) = root**2
         end do
      end do
   end subroutine eigenvalues

   !> total of each lead: share times lambda over its joints
   pure subroutine add_up(c, bound, lambda, total)
      type(c_model_t), intent(in) :: c
      type(bound_t), intent(in) :: bound
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: total(:)

      integer :: b, i, j, e

      do b = 1, size(c%batch)
         do i = 1, c%batch(b)%n
            j = c%batch(b)%first + i
            do e = 1, 2
               total(c%batch(b)%lead(i, e)) = total(c%batch(b)%lead(i, e)) + &
                  bound%share(e, j)*lambda(j)
            end do
         end do
      end do
   end subroutine add_up

   !> share := share times lambda over the total of its lead
   pure subroutine divide(c, bound, lambda, total)
      type(c_model_t), intent(in) :: c
      type(bound_t), intent(inout) :: bound
      real(wp), intent(in) :: lambda(:), total(:)

      integer :: b, i, j, e

      do b = 1, size(c%batch)
         do i = 1, c%batch(b)%n
            j = c%batch(b)%first + i
            do e = 1, 2
               if (total(c%batch(b)%lead(i, e)) > 0.0_wp) then
                  bound%share(e, j) = max(LEAST_SHARE, bound%share(e, j)* &
                     lambda(j)/total(c%batch(b)%lead(i, e)))
               else
                  bound%share(e, j) = 1.0_wp
               end if
            end do
         end do
      end do
   end subroutine divide

   !> Largest stiffness of each dof of joint i, limits included
   pure function largest_stiffness(curves, batch, i) result(k)
      type(curve_set_t), intent(in) :: curves
      type(c_batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp) :: k(6)

      k = steepest(curves, LAW_SPRING_CURVE, batch%law, batch%k(i, :), batch%k_curve(i, :))
      if (batch%limited) k = k + limit_stiffness(batch, curves, i)
   end function largest_stiffness

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
   subroutine compliances(c, state, b, i, s)
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: state
      integer, intent(in) :: b, i
      real(wp), intent(out) :: s(6, 6, 2)

      real(wp) :: rows(6, 6), g
      integer :: e, lead

      do e = 1, 2
         lead = c%batch(b)%lead(i, e)
         rows = rows_of_end(c%batch(b), state, b, i, e)
         g = c%im(lead)
         s(:, :, e) = matmul(rows(:, 1:3), transpose(rows(:, 1:3)))*g
         rows(:, 4:6) = matmul(rows(:, 4:6), body_matrix(state, lead))
         s(:, :, e) = s(:, :, e) + matmul(rows(:, 4:6)*spread(c%ii(lead, :), 1, 6), &
            transpose(rows(:, 4:6)))
      end do
   end subroutine compliances

   !> Rows of B of one end: columns 1-3 velocity, 4-6 angular velocity of its lead
   pure function rows_of_end(batch, state, b, i, e) result(rows)
      type(c_batch_t), intent(in) :: batch
      type(c_state_t), intent(in) :: state
      integer, intent(in) :: b, i, e
      real(wp) :: rows(6, 6)

      real(wp) :: sign, g, a, m(N_B)
      integer :: k

      sign = merge(-1.0_wp, 1.0_wp, e == 1)
      g = 1.0_wp
      associate (joint => state%joint(b))
         if (batch%chart == CHART_VECTOR) then
            a = 0.5_wp*norm2(joint%q(i, 4:6))
            if (a > 1.0e-3_wp) g = abs(a/sin(a))
         end if
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

   !> Largest eigenvalue of K^1/2 S K^1/2
   real(wp) function eigenvalue(k, s) result(lambda)
      real(wp), intent(in) :: k(6), s(6, 6)

      real(wp) :: a(6, 6), root(6)

      root = sqrt(k)
      a = s*spread(root, 2, 6)*spread(root, 1, 6)
      call largest_eigenvalue(6, a, lambda)
   end function eigenvalue

end module kj_c_bound
