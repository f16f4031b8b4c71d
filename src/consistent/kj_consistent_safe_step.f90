!> The safe time-step bound of a scene under the consistent formulation;
!> kj_consistent_nodal_step has others.
!> Damping is implicit, so stiffness alone counts (kappa = 0).
!>
!> Safe: with the mass of each body shared among its joints, M = sum s_bj M_b, the step is stable if
!> 4 M_j - h^2 K_j > 0 for every joint alone: h = 2/sqrt(max lambda_j), lambda_j the largest
!> eigenvalue of K^1/2 (sum_b B_b M_b^-1 B_b^T / s_bj) K^1/2.
!> Source: docs/theory/time_step.md 3 to 5.
!> One file: the bound and what one joint shows to it.
module kj_consistent_safe_step
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_joint_batch, only: is_spring, is_hardened, LAW_DAMPER_CURVE, LAW_SPRING_CURVE, &
      joint_batch_t
   use kj_spring_law, only: stiffness_bound, damping_bound
   use kj_block, only: BLOCK, block_of, lane_of
   use kj_joint_types, only: joint_types, CHART_VECTOR, CHART_LINE
   use kj_consistent_compliance, only: end_inertias, compliance, eigenvalues_from_above
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: inverse_inertias
   use kj_lapack, only: largest_eigenvalue
   use kj_curve, only: curve_set_t
   use kj_consistent_stop, only: limit_stiffness
   use kj_consistent_conditions, only: body_matrix
   implicit none
   private

   public :: bound_t, new_bound, renew_bound, has_moved, largest_stiffness, steepest, curves_of, &
      compliances, rows_of_end, spin_up, eigenvalue

   !> The safe bound and what it rests on
   type :: bound_t
      real(wp) :: h = huge(1.0_wp)               !! the bound, unscaled
      integer :: joint = 0                       !! who holds it: index among all joints, 0 = none
      real(wp), allocatable :: share(:, :)       !! (2, n_element) of the mass of each end's lead
      real(wp), allocatable :: k(:, :)           !! (6, n_element) largest stiffness of each dof
      !> (6, n_element) largest damping of each dof; not allocated where damping is implicit
      real(wp), allocatable :: c(:, :)
      real(wp), allocatable :: limit(:)          !! (n_element) step that each joint allows
      real(wp), allocatable :: q(:, :)           !! (n_element, 6) coordinates then
      real(wp), allocatable :: reach(:)          !! (n_element) slide that asks for a new evaluation
      real(wp), allocatable :: lambda(:)         !! (n_element) eigenvalues
      real(wp), allocatable :: rows(:, :)        !! (27, n_element) of springs: axes, couples
   end type bound_t

   integer, parameter :: SWEEPS = 4
   real(wp), parameter :: LEAST_SHARE = 1.0e-9_wp
   real(wp), parameter :: RK4_RADIUS = 1.0_wp    !! of |h lambda|: stable to 2.6, but damps by h^6
   !> relative turn that asks for a new evaluation [rad]
   real(wp), parameter :: TURN = 0.05_wp

contains

   !> Stiffnesses and shares, and the bound in the present pose
   subroutine new_bound(model, explicit, state, bound)
      type(consistent_model_t), intent(in) :: model
      !> Runge-Kutta of fourth order with explicit damping
      logical, intent(in) :: explicit
      type(consistent_state_t), intent(inout) :: state    !! of the poses the inverse inertias
      type(bound_t), intent(out) :: bound

      real(wp) :: s(6, 6, 2), total(model%n_lead), lambda(model%n_element)
      integer :: b, i, j, e, sweep

      allocate (bound%share(2, model%n_element), bound%k(6, model%n_element), &
         bound%limit(model%n_element), bound%lambda(model%n_element))
      allocate (bound%q(model%n_element, 6), bound%reach(model%n_element), source=0.0_wp)
      if (explicit) allocate (bound%c(6, model%n_element))
      if (any(is_spring(model%batch))) allocate (bound%rows(27, model%n_element), source=0.0_wp)
      do b = 1, size(model%batch)
         do i = 1, model%batch(b)%n
            j = model%batch(b)%first + i
            bound%k(:, j) = largest_stiffness(model%curves, model%batch(b), i)
            if (model%batch(b)%geometry%chart == CHART_LINE) &
               bound%k(2:3, j) = tension(model%batch(b), state, b, i, bound%k(1, j))
            if (explicit .and. is_hardened(model%batch(b))) then
               bound%c(:, j) = damping_bound(model%batch(b)%spring(i)%dof)
            else if (explicit) then
               bound%c(:, j) = steepest(model%curves, LAW_DAMPER_CURVE, model%batch(b)%law, &
                  model%batch(b)%c(i, :), curves_of(model%batch(b)%c_curve, i))
            end if
            call compliances(model, state, b, i, s)
            do e = 1, 2
               bound%share(e, j) = eigenvalue(bound%k(:, j), s(:, :, e))
            end do
         end do
      end do
      lambda = 1.0_wp
      do sweep = 0, SWEEPS
         total = 0.0_wp
         call add_up(model, bound, lambda, total)
         call divide(model, bound, lambda, total)
         call eigenvalues_from_blocks(model, bound, state, lambda)
      end do
      call eigenvalues(model, state, bound, lambda)
      call take(bound, lambda)
      call keep_pose(model, state, bound)
   end subroutine new_bound

   !> The bound in the present pose with the shares as they are, from below by at most 0.4 %
   subroutine renew_bound(model, state, bound)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state    !! of the poses the inverse inertias
      type(bound_t), intent(inout) :: bound

      real(wp), allocatable :: lambda(:)
      integer :: b, i

      do b = 1, size(model%batch)
         if (model%batch(b)%geometry%chart /= CHART_LINE) cycle
         do i = 1, model%batch(b)%n
            associate (k => bound%k(:, model%batch(b)%first + i))
               k(2:3) = tension(model%batch(b), state, b, i, k(1))
            end associate
         end do
      end do
      call move_alloc(bound%lambda, lambda)
      call eigenvalues_from_blocks(model, bound, state, lambda)
      call take(bound, lambda)
      call move_alloc(lambda, bound%lambda)
      call keep_pose(model, state, bound)
   end subroutine renew_bound

   !> Largest eigenvalues of all joints, from above
   subroutine eigenvalues_from_blocks(model, bound, state, lambda)
      type(consistent_model_t), intent(in) :: model
      type(bound_t), intent(in) :: bound
      type(consistent_state_t), intent(inout) :: state    !! of the poses the inverse inertias
      real(wp), intent(out) :: lambda(:)         !! (n_element)

      integer :: piece

      if (state%trial%threads == 1) then
         call inverse_inertias(model, state%poses%quat, 1, model%n_lead, state%poses%ij)
         do piece = 1, size(model%team%joint, 2)
            call eigenvalues_of_piece(model, state, bound, model%team%joint(:, piece), lambda)
         end do
         return
      end if
      !$omp parallel do schedule(static) num_threads(state%trial%threads)
      do piece = 1, size(model%team%lead, 2)
         call inverse_inertias(model, state%poses%quat, model%team%lead(1, piece), &
            model%team%lead(2, piece), state%poses%ij)
      end do
      !$omp parallel do schedule(static) num_threads(state%trial%threads)
      do piece = 1, size(model%team%joint, 2)
         call eigenvalues_of_piece(model, state, bound, model%team%joint(:, piece), lambda)
      end do
   end subroutine eigenvalues_from_blocks

   !> Largest eigenvalues of some joints of a batch, from above
   pure subroutine eigenvalues_of_piece(model, state, bound, piece, lambda)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound
      integer, intent(in) :: piece(3)            !! batch, first, last joint
      real(wp), intent(inout) :: lambda(:)       !! (n_element)

      integer :: from, n

      do from = piece(2), piece(3), BLOCK
         n = min(BLOCK, piece(3) - from + 1)
         if (n == 1) then                               ! one joint: a kernel of its own
            call eigenvalues_of(1, model, state, bound, piece(1), from, lambda)
         else
            call eigenvalues_of(n, model, state, bound, piece(1), from, lambda)
         end if
      end do
   end subroutine eigenvalues_of_piece

   !> The same of the n joints of a block that begins with `from`
   pure subroutine eigenvalues_of(n, model, state, bound, b, from, lambda)
      integer, value :: n
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound
      integer, intent(in) :: b, from
      real(wp), intent(inout) :: lambda(:)       !! (n_element)

      real(wp), dimension(BLOCK, 6) :: ij1, ij2, k, c_part
      real(wp) :: im(BLOCK, 2), s(BLOCK, 21), part(BLOCK), root(BLOCK), w1, w2, g
      integer :: i, j, rows

      associate (batch => model%batch(b), joint => state%joint(b))
         call end_inertias(batch, state%poses, from, n, im, ij1, ij2)
         do i = 1, n
            j = batch%first + from + i - 1
            w1 = 1.0_wp/(bound%share(1, j)*model%n_end(batch%lead(from + i - 1, 1)))
            w2 = 1.0_wp/(bound%share(2, j)*model%n_end(batch%lead(from + i - 1, 2)))
            im(i, :) = im(i, :)*[w1, w2]
            ij1(i, :) = ij1(i, :)*w1
            ij2(i, :) = ij2(i, :)*w2
            g = 1.0_wp
            if (batch%geometry%chart == CHART_VECTOR) g = &
               spin_up([joint%block(block_of(from))%q(i, 4), &
               joint%block(block_of(from))%q(i, 5), joint%block(block_of(from))%q(i, 6)])
            k(i, :) = bound%k(:, j)*[1.0_wp, 1.0_wp, 1.0_wp, g**2, g**2, g**2]
            if (.not. allocated(bound%c)) cycle
            c_part(i, :) = bound%c(:, j)*[1.0_wp, 1.0_wp, 1.0_wp, g**2, g**2, g**2]
         end do
         rows = 6                                       ! rotations that are free need no rows
         if (.not. allocated(bound%c) .and. all(k(:n, 4:) <= 0.0_wp)) rows = 3
         call compliance(n, rows, joint%block(block_of(from))%b, im, ij1, ij2, s)
         call eigenvalues_from_above(n, rows, s, k, part)
         if (allocated(bound%c)) then
            call eigenvalues_from_above(n, 6, s, c_part, root)
            part(:n) = explicit(part(:n), root(:n))
         end if
         lambda(batch%first + from:batch%first + from + n - 1) = part(:n)
      end associate
   end subroutine eigenvalues_of

   !> Eigenvalue that limits Runge-Kutta of fourth order when damping has one too, NaN when that
   !> is none
   elemental real(wp) function explicit(stiffness, damping) result(lambda)
      real(wp), intent(in) :: stiffness, damping

      lambda = stiffness
      if (.not. damping <= epsilon(1.0_wp)*sqrt(stiffness)) &
         lambda = ((0.5_wp*damping + sqrt((0.5_wp*damping)**2 + stiffness))*2.0_wp/RK4_RADIUS)**2
   end function explicit

   !> Transverse stiffness F/L of a stretched spring along its line; k where it has no length
   pure real(wp) function tension(batch, state, b, i, k) result(stiffness)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i
      real(wp), intent(in) :: k

      real(wp) :: length

      associate (lanes => state%joint(b)%block(block_of(i)))
         length = lanes%q(lane_of(i), 1) + batch%xl0(i, 1)
         stiffness = k
         if (length > 0.0_wp) stiffness = max(0.0_wp, lanes%fe(lane_of(i), 1)/length)
      end associate
   end function tension

   !> Some joint has turned or slid so far since the last evaluation that the bound may be wrong
   pure logical function has_moved(model, state, bound) result(moved)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound

      integer :: b, from, to

      moved = .true.
      do b = 1, size(model%batch)
         do from = 1, model%batch(b)%n, BLOCK
            to = min(from + BLOCK - 1, model%batch(b)%n)
            if (block_moved(from, to, model%batch(b)%first, &
               state%joint(b)%block(block_of(from))%q, bound)) return
            if (.not. is_spring(model%batch(b))) cycle
            if (axes_moved(model%batch(b), state, b, from, to, bound)) return
         end do
      end do
      moved = .false.
   end function has_moved

   !> The same of the coordinates of joints from..to of a batch
   pure logical function block_moved(from, to, first, q, bound) result(moved)
      integer, intent(in) :: from, to, first     !! first: joints before the batch
      real(wp), intent(in) :: q(BLOCK, 6)        !! of the block that begins with `from`
      type(bound_t), intent(in) :: bound

      real(wp) :: worst
      integer :: i, k

      worst = 0.0_wp
      do k = 1, 3
         !$omp simd reduction(max: worst)
         do i = from, to
            worst = max(worst, abs(q(i - from + 1, k) - bound%q(first + i, k)) - &
               bound%reach(first + i), abs(q(i - from + 1, k + 3) - &
               bound%q(first + i, k + 3)) - TURN)
         end do
      end do
      moved = worst > 0.0_wp
   end function block_moved

   !> Axes of springs do not turn with the coordinates alone
   pure logical function axes_moved(batch, state, b, from, to, bound) result(moved)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, from, to
      type(bound_t), intent(in) :: bound

      real(wp) :: rows(27)
      integer :: i, j

      moved = .true.
      do i = from, to
         j = batch%first + i
         rows = abs(rows_of(state, b, i) - bound%rows(:, j))
         if (maxval(rows(:9)) > TURN .or. maxval(rows(10:)) > bound%reach(j)) return
      end do
      moved = .false.
   end function axes_moved

   !> Directions and couples of a spring
   pure function rows_of(state, b, i) result(rows)
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i
      real(wp) :: rows(27)

      real(wp) :: d(3), moment(3)
      integer :: k

      associate (b_of => state%joint(b)%block(block_of(i))%b, lane => lane_of(i))
         rows(:9) = b_of%force(lane, :)
         rows(10:18) = b_of%couple(lane, :)
         d = b_of%apart(lane, :)
      end associate
      do k = 1, 7, 3
         moment = cross(d, rows(k:k + 2))
         rows(k + 18:k + 20) = moment - rows(k + 9:k + 11)
      end do
   end function rows_of

   !> Coordinates that the bound was found for
   subroutine keep_pose(model, state, bound)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(bound_t), intent(inout) :: bound

      integer :: piece

      if (state%trial%threads == 1) then
         do piece = 1, size(model%team%joint, 2)
            call keep_piece(model, state, model%team%joint(:, piece), bound)
         end do
         return
      end if
      !$omp parallel do schedule(static) num_threads(state%trial%threads)
      do piece = 1, size(model%team%joint, 2)
         call keep_piece(model, state, model%team%joint(:, piece), bound)
      end do
   end subroutine keep_pose

   pure subroutine keep_piece(model, state, piece, bound)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: piece(3)            !! batch, first, last joint
      type(bound_t), intent(inout) :: bound

      real(wp) :: rows(27)
      integer :: i, j, k

      associate (b => piece(1), batch => model%batch(piece(1)))
         do i = piece(2), piece(3)
            j = batch%first + i
            do k = 1, 6
               bound%q(j, k) = state%joint(b)%block(block_of(i))%q(lane_of(i), k)
            end do
            associate (arm => batch%geometry%arm, q => bound%q, x => batch%xl0)
               bound%reach(j) = TURN*max(tiny(1.0_wp), &
                  length(arm(i, 1), arm(i, 2), arm(i, 3)) + &
                  length(arm(i, 4), arm(i, 5), arm(i, 6)) + &
                  length(x(i, 1) + q(j, 1), x(i, 2) + q(j, 2), x(i, 3) + q(j, 3)))
            end associate
            if (.not. is_spring(batch)) cycle
            rows = rows_of(state, b, i)
            bound%rows(:, j) = rows
         end do
      end associate
   end subroutine keep_piece

   pure real(wp) function length(x, y, z)
      real(wp), intent(in) :: x, y, z

      length = sqrt(x**2 + y**2 + z**2)
   end function length

   !> The limits that eigenvalues set; one that is no finite number counts as the largest there is
   subroutine take(bound, lambda)
      type(bound_t), intent(inout) :: bound
      real(wp), intent(inout) :: lambda(:)       !! (n_element)

      integer :: j

      do j = 1, size(lambda)
         if (.not. lambda(j) <= huge(1.0_wp)) lambda(j) = huge(1.0_wp)
         bound%limit(j) = huge(1.0_wp)
         if (lambda(j) > 0.0_wp) bound%limit(j) = 2.0_wp/sqrt(lambda(j))
      end do
      bound%h = huge(1.0_wp)
      bound%joint = 0
      if (size(lambda) == 0) return
      j = maxloc(lambda, dim=1)
      if (.not. lambda(j) > 0.0_wp) return
      bound%h = bound%limit(j)
      bound%joint = j
   end subroutine take

   subroutine eigenvalues(model, state, bound, lambda)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(bound_t), intent(in) :: bound
      real(wp), intent(out) :: lambda(:)

      real(wp) :: s(6, 6, 2)
      integer :: b, i, j

      do b = 1, size(model%batch)
         do i = 1, model%batch(b)%n
            j = model%batch(b)%first + i
            call compliances(model, state, b, i, s)
            s(:, :, 1) = s(:, :, 1)/bound%share(1, j) + s(:, :, 2)/bound%share(2, j)
            lambda(j) = eigenvalue(bound%k(:, j), s(:, :, 1))
            if (allocated(bound%c)) &
               lambda(j) = explicit(lambda(j), eigenvalue(bound%c(:, j), s(:, :, 1)))
         end do
      end do
   end subroutine eigenvalues

   !> total of each lead: share times lambda over its joints
   pure subroutine add_up(model, bound, lambda, total)
      type(consistent_model_t), intent(in) :: model
      type(bound_t), intent(in) :: bound
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: total(:)

      integer :: b, i, j, e

      do b = 1, size(model%batch)
         do i = 1, model%batch(b)%n
            j = model%batch(b)%first + i
            do e = 1, 2
               total(model%batch(b)%lead(i, e)) = total(model%batch(b)%lead(i, e)) + &
                  bound%share(e, j)*lambda(j)
            end do
         end do
      end do
   end subroutine add_up

   !> share := share times lambda over the total of its lead
   pure subroutine divide(model, bound, lambda, total)
      type(consistent_model_t), intent(in) :: model
      type(bound_t), intent(inout) :: bound
      real(wp), intent(in) :: lambda(:), total(:)

      integer :: b, i, j, e

      do b = 1, size(model%batch)
         do i = 1, model%batch(b)%n
            j = model%batch(b)%first + i
            do e = 1, 2
               if (total(model%batch(b)%lead(i, e)) > 0.0_wp) then
                  bound%share(e, j) = max(LEAST_SHARE, bound%share(e, j)* &
                     lambda(j)/total(model%batch(b)%lead(i, e)))
               else
                  bound%share(e, j) = 1.0_wp
               end if
            end do
         end do
      end do
   end subroutine divide

   ! ---- What one joint shows to the bounds of the time step: its largest stiffness, the rows of B
   ! of each end, B M^-1 B^T, and eigenvalues. Source: docs/theory/time_step.md 3.

   !> Largest stiffness of each dof of joint i, limits included
   pure function largest_stiffness(curves, batch, i) result(k)
      type(curve_set_t), intent(in) :: curves
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp) :: k(6)

      integer :: dof

      if (is_hardened(batch)) then
         k = [(stiffness_bound(batch%spring(i)%dof(dof), curves), dof=1, 6)]
         if (batch%spring(i)%per_length) k = k/batch%xl0(i, 1)
         return
      end if
      k = steepest(curves, LAW_SPRING_CURVE, batch%law, batch%k(i, :), &
         curves_of(batch%k_curve, i))
      if (batch%geometry%implicit .and. .not. is_spring(batch)) then
         where (joint_types(batch%row)%free == 0) k = 0.0_wp
      end if
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

      real(wp) :: rows(6, 6), p(3, 3), turned(6, 3), sums(2)
      integer :: e, lead, m, n, k

      do e = 1, 2
         lead = model%batch(b)%lead(i, e)
         rows = rows_of_end(model%batch(b), state, b, i, e)
         p = body_matrix(state, lead)
         do k = 1, 3
            do m = 1, 6
               turned(m, k) = rows(m, 4)*p(1, k) + rows(m, 5)*p(2, k) + rows(m, 6)*p(3, k)
            end do
         end do
         do n = 1, 6
            do m = 1, 6
               sums = 0.0_wp
               do k = 1, 3
                  sums(1) = sums(1) + rows(m, k)*rows(n, k)
                  sums(2) = sums(2) + turned(m, k)*model%inverse_inertia(lead, k)*turned(n, k)
               end do
               s(m, n, e) = sums(1)*model%inverse_mass(lead) + sums(2)
            end do
         end do
      end do
   end subroutine compliances

   !> Rows of B of one end: columns 1-3 velocity, 4-6 angular velocity of its lead
   pure function rows_of_end(batch, state, b, i, e) result(rows)
      type(joint_batch_t), intent(in) :: batch
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i, e
      real(wp) :: rows(6, 6)

      real(wp) :: sign, g, force(9), couple(9), turn(9), d(3)
      integer :: k

      sign = merge(-1.0_wp, 1.0_wp, e == 1)
      g = 1.0_wp
      associate (lanes => state%joint(b)%block(block_of(i)))
         if (batch%geometry%chart == CHART_VECTOR) g = spin_up(lanes%q(lane_of(i), 4:6))
         force = lanes%b%force(lane_of(i), :)
         couple = lanes%b%couple(lane_of(i), :)
         turn = lanes%b%turn(lane_of(i), :)
         d = lanes%b%apart(lane_of(i), :)
      end associate
      rows = 0.0_wp
      do k = 1, 3
         associate (from => 3*k - 2, to => 3*k)
            rows(k, 1:3) = sign*force(from:to)
            rows(k, 4:6) = -couple(from:to)
            if (e == 2) rows(k, 4:6) = couple(from:to) - cross(d, force(from:to))
            rows(k + 3, 4:6) = sign*g*turn(from:to)
         end associate
      end do
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
      lambda = 0.0_wp
      if (any(k > 0.0_wp)) call largest_eigenvalue(6, a, lambda)
   end function eigenvalue

end module kj_consistent_safe_step
