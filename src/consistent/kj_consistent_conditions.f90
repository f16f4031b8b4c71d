!> Boundary conditions and imposed motion under the consistent formulation: projections of velocity
!> and angular momentum in the half kicks, exact turns about a single free axis in the drift.
!> Source: docs/theory/consistent.md 7.
!> One file: conditions are gathered, projected and counted by the same rows.
module kj_consistent_conditions
   use kj_kinds, only: wp
   use kj_math3, only: rotation, to_quaternion, quaternion_product, cross, IDENTITY
   use kj_lapack, only: solve_dense
   use kj_curve, only: curve_set_t, load_value, curve_integral, curve_moment
   use kj_model, only: motion_t, IMPOSE_VELOCITY, IMPOSE_DISPLACEMENT
   use kj_skew, only: axis_of
   use kj_consistent_state, only: consistent_model_t, consistent_state_t, row_t, hold_t
   use kj_consistent_body, only: columns, spin_velocity
   use kj_block, only: BLOCK
   implicit none
   private

   public :: project, project_all, count_work, keep_rates, project_rates, hold_rotations, &
      body_matrix, motion_targets, held_force, collect_holds, all_blocked, free_directions

   !> Part of a step that a projection ends
   integer, parameter, public :: FIRST_HALF = 1, SECOND_HALF = 2, WHOLE = 3

contains

   !> Wanted velocities of the imposed motions over a step from t to t + h: the mean over the step
   !> (tables integrated exactly) and the value at its end. Inactive motions keep what there is.
   subroutine motion_targets(model, state, h, mean, final, active)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h
      real(wp), intent(out) :: mean(:), final(:)     !! (n_motion)
      logical, intent(out) :: active(:)

      integer :: i
      real(wp) :: a, b, moved

      do i = 1, size(model%motion)
         associate (m => model%motion(i))
            active(i) = state%time >= m%t_start .and. state%time <= m%t_stop
            if (.not. active(i)) cycle
            a = (state%time - m%t_sensor)/m%x_scale
            b = (state%time + h - m%t_sensor)/m%x_scale
            select case (m%kind)
            case (IMPOSE_VELOCITY)
               mean(i) = m%y_scale*m%x_scale*integral(model%curves, m, a, b)/h
               final(i) = m%y_scale*load_value(model%curves, m%curve, b)
            case (IMPOSE_DISPLACEMENT)
               moved = state%motion_at(i)
               if (m%sensed) moved = m%y_scale*load_value(model%curves, m%curve, a)
               mean(i) = (m%y_scale*load_value(model%curves, m%curve, b) - moved)/h
               final(i) = slope_at(model%curves, m, b)
            case default   ! IMPOSE_ACCELERATION
               mean(i) = state%motion_at(i) + m%y_scale*m%x_scale**2*moment(model%curves, m, a, b)/h
               final(i) = state%motion_at(i) + m%y_scale*m%x_scale*integral(model%curves, m, a, b)
            end select
         end associate
      end do
   end subroutine motion_targets

   !> Integral of the curve of a motion from a to b
   pure real(wp) function integral(curves, m, a, b) result(y)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: a, b

      y = (b - a)*load_value(curves, m%curve, a)
      if (m%curve == 0) return
      if (curves%first(m%curve + 1) - curves%first(m%curve) > 1) y = &
         curve_integral(curves, m%curve, a, b)
   end function integral

   !> Integral of (b - s) f(s) from a to b
   pure real(wp) function moment(curves, m, a, b) result(y)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: a, b

      y = 0.5_wp*(b - a)**2*load_value(curves, m%curve, a)
      if (m%curve == 0) return
      if (curves%first(m%curve + 1) - curves%first(m%curve) > 1) y = &
         curve_moment(curves, m%curve, a, b)
   end function moment

   !> Rate of an imposed displacement at its abscissa
   pure real(wp) function slope_at(curves, m, x) result(rate)
      type(curve_set_t), intent(in) :: curves
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: x

      integer :: i, last

      rate = 0.0_wp
      if (m%curve == 0) return
      last = curves%first(m%curve + 1) - 1
      do i = curves%first(m%curve), last - 1
         rate = m%y_scale/m%x_scale*(curves%y(i + 1) - curves%y(i))/(curves%x(i + 1) - curves%x(i))
         if (curves%x(i + 1) > x) return
      end do
   end function slope_at

   !> Velocities of the leads of holds first..last, into state%kept
   pure subroutine keep_rates(model, first, last, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: first, last
      type(consistent_state_t), intent(inout) :: state

      integer :: i, lead

      do i = first, last
         lead = model%hold(i)%lead
         call spin_velocity(model, state%poses%quat, state%l, lead, lead, state%poses%w)
         state%kept%rates(:, i) = [state%v(lead, :), state%poses%w(lead, :)]
      end do
   end subroutine keep_rates

   !> Project all held leads, and count the work
   subroutine project_all(model, target, active, part, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: target(:)              !! (n_motion) wanted velocity
      logical, intent(in) :: active(:)
      integer, intent(in) :: part
      type(consistent_state_t), intent(inout) :: state

      call project(model, target, active, part, 1, size(model%hold), state)
      call count_work(part, state)
   end subroutine project_all

   !> Count the work of the last projections of a part of the step
   pure subroutine count_work(part, state)
      integer, intent(in) :: part                    !! FIRST_HALF, ...
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(state%kept%work, 2)
         state%work = state%work + state%kept%work(1, i, part)
         state%work = state%work + state%kept%work(2, i, part)
      end do
   end subroutine count_work

   !> Bring velocity and angular momentum of the leads of holds first..last onto their conditions.
   !>
   !> v += B^T (B B^T)^-1 (u - B v), L += B^T (B J^-1 B^T)^-1 (u - B J^-1 L); work of driven rows:
   !> impulse times (start velocity + change/2) in the first half kick, (end - change/2) in the
   !> second, the mean of start and end over a whole step. Velocities before the kick: keep_rates.
   subroutine project(model, target, active, part, first, last, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: target(:)              !! (n_motion) wanted velocity
      logical, intent(in) :: active(:)
      integer, intent(in) :: part                    !! of the step that was kicked: FIRST_HALF, ...
      integer, intent(in) :: first, last
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: b(3, 3), u(3), power, before(6)
      logical :: drives(3)
      integer :: i, lead, n

      do i = first, last
         state%kept%work(:, i, part) = 0.0_wp
         before = state%kept%rates(:, i)
         associate (hold => model%hold(i))
            lead = hold%lead
            call rows_of(state, hold%trans(:hold%n_trans), target, active, b, u, drives, n)
            if (n == 3 .and. .not. any(drives)) then
               state%v(lead, :) = 0.0_wp
            else if (n > 0) then
               call drive(n, b, u, drives, part, before(1:3), unit_inverse(1.0_wp), &
                  state%v(lead, :), power)
               state%kept%work(1, i, part) = model%mass(lead)*power
            end if
            call rows_of(state, hold%rot(:hold%n_rot), target, active, b, u, drives, n)
            if (n == 0) cycle
            if (n == 3 .and. .not. any(drives(:3))) then
               state%l(lead, :) = 0.0_wp
            else
               call drive(n, b, u, drives, part, before(4:6), inverse_inertia(model, state, lead), &
                  state%l(lead, :), power)
               state%kept%work(2, i, part) = power
               if (part == FIRST_HALF .and. n == 1) call lean_back(model, state, lead, b, u)
            end if
         end associate
      end do
   end subroutine project

   !> A lead with two free axes: start the drift with half of the rate that its free rotation will
   !> build up along the held axis, with the other sign, so that the mean over the step is u
   subroutine lean_back(model, state, lead, b, u)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      integer, intent(in) :: lead
      real(wp), intent(in) :: b(3, 3), u(3)

      real(wp) :: g(3, 3), w(3), back(3), power

      g = inverse_inertia(model, state, lead)
      w = matmul(g, state%l(lead, :))
      back = u
      back(1) = u(1) + 0.5_wp*state%h*dot_product(b(1, :), matmul(g, cross(w, state%l(lead, :))))
      call drive(1, b, back, [.false., .false., .false.], FIRST_HALF, u, g, state%l(lead, :), power)
   end subroutine lean_back

   pure function unit_inverse(m) result(a)
      real(wp), intent(in) :: m
      real(wp) :: a(3, 3)

      a = 0.0_wp
      a(1, 1) = m
      a(2, 2) = m
      a(3, 3) = m
   end function unit_inverse

   !> Change p so that b (g p) = u with g symmetric; power of the driven rows
   subroutine drive(n, b, u, drives, part, before, g, p, power)
      integer, intent(in) :: n
      real(wp), intent(in) :: b(3, 3), u(3), before(3), g(3, 3)
      logical, intent(in) :: drives(3)
      integer, intent(in) :: part
      !> velocity (g = 1) or angular momentum (g = J^-1)
      real(wp), intent(inout) :: p(3)
      real(wp), intent(out) :: power

      real(wp) :: a(n, n), impulse(n), rate, old
      integer :: k
      logical :: ok

      a = matmul(b(:n, :), matmul(g, transpose(b(:n, :))))
      impulse = u(:n) - matmul(b(:n, :), matmul(g, p))
      call solve_dense(n, a, impulse, ok)
      power = 0.0_wp
      if (.not. ok) return
      do k = 1, n
         if (.not. drives(k)) cycle
         old = dot_product(b(k, :), matmul(g, p))
         rate = dot_product(b(k, :), before) + 0.5_wp*(u(k) - old)
         if (part == SECOND_HALF) rate = u(k) - 0.5_wp*(u(k) - old)
         if (part == WHOLE) rate = 0.5_wp*(dot_product(b(k, :), before) + u(k))
         power = power + impulse(k)*rate
      end do
      p = p + matmul(impulse, b(:n, :))
   end subroutine drive

   !> Velocities that pass 2 of the joints sees: predicted ones, brought onto the conditions of
   !> holds first..last
   subroutine project_rates(model, target, active, first, last, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: target(:)
      logical, intent(in) :: active(:)
      integer, intent(in) :: first, last
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: b(3, 3), u(3), power, l(3), g(3, 3)
      logical :: drives(3)
      integer :: i, lead, n

      do i = first, last
         lead = model%hold(i)%lead
         call rows_of(state, model%hold(i)%trans(:model%hold(i)%n_trans), target, active, b, u, &
            drives, n)
         if (n == 3 .and. .not. any(drives)) then
            state%poses%v(lead, :) = 0.0_wp
         else if (n > 0) then
            call drive(n, b, u, drives, FIRST_HALF, u, unit_inverse(1.0_wp), &
               state%poses%v(lead, :), power)
         end if
         call rows_of(state, model%hold(i)%rot(:model%hold(i)%n_rot), target, active, b, u, &
            drives, n)
         if (n == 3 .and. .not. any(drives)) then
            state%poses%w(lead, :) = 0.0_wp
         else if (n > 0) then
            g = inverse_inertia(model, state, lead)
            l = matmul(inertia(model, state, lead), state%poses%w(lead, :))
            call drive(n, b, u, drives, FIRST_HALF, u, g, l, power)
            state%poses%w(lead, :) = matmul(g, l)
         end if
      end do
   end subroutine project_rates

   !> Axes and wanted rates of the rows that act now
   subroutine rows_of(state, rows, target, active, b, u, drives, n)
      type(consistent_state_t), intent(in) :: state
      type(row_t), intent(in) :: rows(:)
      real(wp), intent(in) :: target(:)
      logical, intent(in) :: active(:)
      real(wp), intent(out) :: b(3, 3), u(3)
      logical, intent(out) :: drives(3)
      integer, intent(out) :: n

      integer :: k, m

      n = 0
      drives = .false.
      do k = 1, size(rows)
         m = rows(k)%motion
         if (m > 0) then
            if (.not. active(m)) cycle
         end if
         n = n + 1
         b(n, :) = axis_of(state%skew, rows(k)%skew, rows(k)%dir)
         u(n) = 0.0_wp
         if (m > 0) u(n) = target(m)
         drives(n) = m > 0
      end do
   end subroutine rows_of

   !> Projectors on the directions in which a lead moves freely, translations and rotations
   subroutine free_directions(model, state, lead, active, p)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      logical, intent(in) :: active(:)               !! (n_motion)
      real(wp), intent(out) :: p(3, 3, 2)

      real(wp) :: b(3, 3), u(3), none(size(active)), a(3)
      logical :: drives(3)
      integer :: part, k, n

      none = 0.0_wp
      do part = 1, 2
         p(:, :, part) = IDENTITY
         if (part == 1 .and. .not. model%inverse_mass(lead) > 0.0_wp) p(:, :, part) = 0.0_wp
         if (part == 2 .and. .not. maxval(model%inverse_inertia(lead, :)) > 0.0_wp) &
            p(:, :, part) = 0.0_wp
         if (model%hold_of(lead) == 0) cycle
         associate (hold => model%hold(model%hold_of(lead)))
            if (part == 1) call rows_of(state, hold%trans(:hold%n_trans), none, active, b, u, &
               drives, n)
            if (part == 2) call rows_of(state, hold%rot(:hold%n_rot), none, active, b, u, drives, n)
         end associate
         do k = 1, n
            a = matmul(p(:, :, part), b(k, :))
            if (norm2(a) < 1.0e-6_wp) cycle          ! of axes before
            a = a/norm2(a)
            p(:, :, part) = p(:, :, part) - spread(a, 2, 3)*spread(a, 1, 3)
         end do
      end do
   end subroutine free_directions

   !> Columns: principal axes of a lead, W
   pure function body_matrix(state, lead) result(p)
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp) :: p(3, 3)

      real(wp) :: e(9)

      e = columns(state%poses%quat(lead, :))
      p(:, 1) = e(1:3)
      p(:, 2) = e(4:6)
      p(:, 3) = e(7:9)
   end function body_matrix

   pure function inertia(model, state, lead) result(j)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp) :: j(3, 3)

      real(wp) :: p(3, 3)

      p = body_matrix(state, lead)
      j = matmul(p*spread(model%spin_inertia(lead, :), 1, 3), transpose(p))
   end function inertia

   pure function inverse_inertia(model, state, lead) result(g)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp) :: g(3, 3)

      real(wp) :: p(3, 3)

      p = body_matrix(state, lead)
      g = matmul(p*spread(1.0_wp/model%spin_inertia(lead, :), 1, 3), transpose(p))
   end function inverse_inertia

   !> After the drift: leads with a single free axis e turn about it exactly, by h e.w; a lead with
   !> all axes held or driven turns with the driven velocity; with two free axes the plane rotations
   !> stay.
   !>
   !> Attitudes before the drift and angular velocities during it: state%kept
   subroutine hold_rotations(model, h, target, active, first, last, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      real(wp), intent(in) :: target(:)              !! (n_motion)
      logical, intent(in) :: active(:)
      integer, intent(in) :: first, last             !! holds
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: q(4), p(4), turned(4), w(3), b(3, 3), u(3)
      logical :: drives(3)
      integer :: i, n, lead

      do i = first, last
         lead = model%hold(i)%lead
         call rows_of(state, model%hold(i)%rot(:model%hold(i)%n_rot), target, active, b, u, &
            drives, n)
         if (n < 2) cycle
         w = state%kept%w(:, i)
         q = to_quaternion(rotation(h*w))
         p = state%kept%quat(:, i)
         turned = quaternion_product(q, p)
         state%poses%quat(lead, :) = turned          ! at once: of a lead at rest others look at it
         state%l(lead, :) = matmul(inertia(model, state, lead), w)
      end do
   end subroutine hold_rotations

   !> Force without its components along blocked directions (they do no work)
   subroutine held_force(model, state, i, f, t)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: i                       !! index of the hold
      real(wp), intent(inout) :: f(3), t(3)

      real(wp) :: b(3, 3), u(3), none(size(state%motion_at)), power
      logical :: drives(3), inactive(size(state%motion_at))
      integer :: n

      none = 0.0_wp
      inactive = .false.
      associate (hold => model%hold(i))
         call rows_of(state, hold%trans(:hold%n_trans), none, inactive, b, u, drives, n)
         if (n > 0) call drive(n, b, u, drives, FIRST_HALF, u, unit_inverse(1.0_wp), f, power)
         call rows_of(state, hold%rot(:hold%n_rot), none, inactive, b, u, drives, n)
         if (n == 3) then
            t = 0.0_wp
         else if (n > 0) then
            call drive(n, b, u, drives, FIRST_HALF, u, inverse_inertia(model, state, hold%lead), &
               t, &
               power)
         end if
      end associate
   end subroutine held_force

   ! ---- Boundary conditions and imposed motions, gathered lead by lead. Source:
   ! docs/theory/consistent.md 7.

   !> Conditions and imposed motions of each lead as rows
   subroutine collect_holds(model)
      type(consistent_model_t), intent(inout) :: model

      type(hold_t), allocatable :: hold(:)
      integer :: i, k, n
      type(row_t) :: row

      model%hold_of = 0
      allocate (hold(size(model%bcs) + size(model%motion)))
      n = 0
      do i = 1, size(model%bcs)
         do k = 1, 6
            if (.not. model%bcs(i)%fixed(k)) cycle
            row%dir = k
            row%skew = model%bcs(i)%skew
            row%motion = 0
            call add_row(model%bcs(i)%lead, row)
         end do
      end do
      do i = 1, size(model%motion)
         row%dir = model%motion(i)%dir
         row%skew = model%motion(i)%skew
         row%motion = i
         call add_row(model%motion(i)%lead, row)
      end do
      call sort_holds(hold(:n), model)
   contains
      subroutine add_row(lead, new)
         integer, intent(in) :: lead
         type(row_t), intent(in) :: new

         integer :: at

         ! a node without inertia does not turn at all
         if (new%dir > 3 .and. .not. model%inertia(lead) > 0.0_wp) return
         if (model%hold_of(lead) == 0) then
            n = n + 1
            model%hold_of(lead) = n
            hold(n)%lead = lead
         end if
         at = model%hold_of(lead)
         if (new%dir <= 3) then
            if (hold(at)%n_trans == 3) return
            hold(at)%n_trans = hold(at)%n_trans + 1
            hold(at)%trans(hold(at)%n_trans) = new
         else
            if (hold(at)%n_rot == 3) return
            hold(at)%n_rot = hold(at)%n_rot + 1
            hold(at)%rot(hold(at)%n_rot) = new
         end if
      end subroutine add_row
   end subroutine collect_holds

   !> Conditions by ascending lead, and how many there are up to each block of leads
   pure subroutine sort_holds(hold, model)
      type(hold_t), intent(in) :: hold(:)
      type(consistent_model_t), intent(inout) :: model

      integer :: lead, n

      allocate (model%hold(size(hold)), model%hold_to(0:(size(model%hold_of) + BLOCK - 1)/BLOCK))
      model%hold_to(0) = 0
      n = 0
      do lead = 1, size(model%hold_of)
         if (model%hold_of(lead) > 0) then
            n = n + 1
            model%hold(n) = hold(model%hold_of(lead))
            model%hold_of(lead) = n
         end if
         model%hold_to((lead + BLOCK - 1)/BLOCK) = n
      end do
   end subroutine sort_holds

   !> Rows hold three directions, and none is driven
   pure logical function all_blocked(rows, n) result(blocked)
      type(row_t), intent(in) :: rows(3)
      integer, intent(in) :: n

      blocked = n == 3 .and. all(rows%motion == 0)
   end function all_blocked

end module kj_consistent_conditions
