!> Boundary conditions and imposed motion under the consistent formulation: projections of velocity
!> and angular momentum in the half kicks, exact turns about a single free axis in the drift.
!> Source: docs/theory/consistent.md 7.
!> One file: conditions are gathered, projected and counted by the same rows.
module kj_consistent_conditions
   use kj_kinds, only: wp
   use kj_math3, only: rotation, to_quaternion, quaternion_product, cross, solve_small, IDENTITY
   use kj_skew, only: axis_of
   use kj_consistent_state, only: consistent_model_t, consistent_state_t, row_t, hold_t
   use kj_consistent_body, only: columns
   use kj_block, only: BLOCK, block_of, lane_of
   implicit none
   private

   public :: project, project_all, count_work, keep_rates, project_rates, hold_rotations, &
      body_matrix, held_force, collect_holds, all_blocked, free_directions

   !> Part of a step that a projection ends
   integer, parameter, public :: FIRST_HALF = 1, SECOND_HALF = 2, WHOLE = 3

contains

   !> Velocities of the leads of holds first..last, into state%kept
   pure subroutine keep_rates(model, first, last, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: first, last
      type(consistent_state_t), intent(inout) :: state

      integer :: i, lead

      do i = first, last
         lead = model%hold(i)%lead
         state%kept%rates(1:3, i) = state%v(lead, :)
         state%kept%rates(4:6, i) = spin_of(model, state, lead)
      end do
   end subroutine keep_rates

   !> J^-1 L of a lead
   pure function spin_of(model, state, lead) result(w)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp) :: w(3)

      real(wp) :: p(3, 3), l(3), s(3)
      integer :: k

      p = body_matrix(state, lead)
      l = state%l(lead, :)
      do k = 1, 3
         s(k) = model%inverse_inertia(lead, k)*(p(1, k)*l(1) + p(2, k)*l(2) + p(3, k)*l(3))
      end do
      w = p(:, 1)*s(1) + p(:, 2)*s(2) + p(:, 3)*s(3)
   end function spin_of

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
   !> second, the mean of start and end over a whole step. So in the halves it is the mean less or
   !> plus half of the change by forces; those of the rows of `compliant` do not count, as they
   !> do no work where a velocity jumps. Velocities before the kick: keep_rates.
   subroutine project(model, target, active, part, first, last, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: target(:)              !! (n_motion) wanted velocity
      logical, intent(in) :: active(:)
      integer, intent(in) :: part                    !! of the step that was kicked: FIRST_HALF, ...
      integer, intent(in) :: first, last
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: b(3, 3), u(3), p(3), power, before(6)
      logical :: drives(3)
      integer :: i, lead, n, count_as

      count_as = merge(WHOLE, part, allocated(state%compliant))
      do i = first, last
         state%kept%work(:, i, part) = 0.0_wp
         before = state%kept%rates(:, i)
         associate (hold => model%hold(i))
            lead = hold%lead
            if (count_as /= part) before = before + explicit_change(model, state, part, lead)
            call rows_of(state, hold%trans, hold%n_trans, b, u, drives, n, target, active)
            if (n == 3 .and. .not. any(drives)) then
               state%v(lead, :) = 0.0_wp
            else if (n > 0) then
               p = state%v(lead, :)
               call drive(n, b, u, drives, count_as, before(1:3), IDENTITY, p, power)
               state%v(lead, :) = p
               state%kept%work(1, i, part) = model%mass(lead)*power
            end if
            call rows_of(state, hold%rot, hold%n_rot, b, u, drives, n, target, active)
            if (n == 0) cycle
            if (n == 3 .and. .not. any(drives(:3))) then
               state%l(lead, :) = 0.0_wp
            else
               p = state%l(lead, :)
               call drive(n, b, u, drives, count_as, before(4:6), &
                  inverse_inertia(model, state, lead), p, power)
               state%l(lead, :) = p
               state%kept%work(2, i, part) = power
               if (part == FIRST_HALF .and. n == 1) call lean_back(model, state, lead, b, u)
            end if
         end associate
      end do
   end subroutine project

   !> Change of the velocities of a lead by the explicit forces of `compliant` in half a step, less
   !> than nothing in the first
   pure function explicit_change(model, state, part, lead) result(change)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: part, lead
      real(wp) :: change(6)

      associate (c => state%compliant)
         if (part == FIRST_HALF) then
            change = -[c%start%f(lead, :), c%start%t(lead, :)]
         else
            change = [c%f(lead, :), c%t(lead, :)]
         end if
      end associate
      change(1:3) = 0.5_wp*state%h*model%inverse_mass(lead)*change(1:3)
      change(4:6) = 0.5_wp*state%h*matmul(inverse_inertia(model, state, lead), change(4:6))
   end function explicit_change

   !> A lead with two free axes: start the drift with half of the rate that its free rotation will
   !> build up along the held axis, with the other sign, so that the mean over the step is u
   subroutine lean_back(model, state, lead, b, u)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      integer, intent(in) :: lead
      real(wp), intent(in) :: b(3, 3), u(3)

      real(wp) :: g(3, 3), l(3), w(3), x(3), back(3), power

      g = inverse_inertia(model, state, lead)
      l = state%l(lead, :)
      w = matmul(g, l)
      x = cross(w, l)
      x = matmul(g, x)
      back = u
      back(1) = u(1) + 0.5_wp*state%poses%h(lane_of(lead))*dot_product(b(1, :), x)
      call drive(1, b, back, [.false., .false., .false.], FIRST_HALF, u, g, l, power)
      state%l(lead, :) = l
   end subroutine lean_back

   !> a b^T
   pure function times_transposed(a, b) result(c)
      real(wp), intent(in) :: a(3, 3), b(3, 3)
      real(wp) :: c(3, 3)

      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            c(i, j) = a(i, 1)*b(j, 1) + a(i, 2)*b(j, 2) + a(i, 3)*b(j, 3)
         end do
      end do
   end function times_transposed

   !> Change p so that b (g p) = u with g symmetric; power of the driven rows
   pure subroutine drive(n, b, u, drives, part, before, g, p, power)
      integer, intent(in) :: n                       !! rows of b, the others are 0
      real(wp), intent(in) :: b(3, 3), u(3), before(3), g(3, 3)
      logical, intent(in) :: drives(3)
      integer, intent(in) :: part
      !> velocity (g = 1) or angular momentum (g = J^-1)
      real(wp), intent(inout) :: p(3)
      real(wp), intent(out) :: power

      real(wp) :: a(3, 3), gb(3, 3), gp(3), impulse(3), rate, old
      integer :: k
      logical :: ok

      gb = times_transposed(g, b)
      a = matmul(b, gb)
      gp = matmul(g, p)
      impulse = u - matmul(b, gp)
      call solve_small(n, a, impulse, ok)
      power = 0.0_wp
      if (.not. ok) return
      do k = 1, n
         if (.not. drives(k)) cycle
         old = dot_product(b(k, :), gp)
         rate = dot_product(b(k, :), before) + 0.5_wp*(u(k) - old)
         if (part == SECOND_HALF) rate = u(k) - 0.5_wp*(u(k) - old)
         if (part == WHOLE) rate = 0.5_wp*(dot_product(b(k, :), before) + u(k))
         power = power + impulse(k)*rate
      end do
      p = p + matmul(impulse, b)
   end subroutine drive

   !> Velocities that pass 2 of the joints sees: predicted ones, brought onto the conditions of
   !> holds first..last
   subroutine project_rates(model, target, active, first, last, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: target(:)
      logical, intent(in) :: active(:)
      integer, intent(in) :: first, last
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: b(3, 3), u(3), power, p(3), w(3), g(3, 3), j(3, 3)
      logical :: drives(3)
      integer :: i, lead, n

      do i = first, last
         lead = model%hold(i)%lead
         call rows_of(state, model%hold(i)%trans, model%hold(i)%n_trans, b, u, drives, n, target, &
            active)
         if (n == 3 .and. .not. any(drives)) then
            state%poses%v(lead, :) = 0.0_wp
         else if (n > 0) then
            p = state%poses%v(lead, :)
            call drive(n, b, u, drives, FIRST_HALF, u, IDENTITY, p, power)
            state%poses%v(lead, :) = p
         end if
         call rows_of(state, model%hold(i)%rot, model%hold(i)%n_rot, b, u, drives, n, target, &
            active)
         if (n == 3 .and. .not. any(drives)) then
            state%poses%w(lead, :) = 0.0_wp
         else if (n > 0) then
            g = inverse_inertia(model, state, lead)
            w = state%poses%w(lead, :)
            j = inertia(model, state, lead)
            p = matmul(j, w)
            call drive(n, b, u, drives, FIRST_HALF, u, g, p, power)
            state%poses%w(lead, :) = matmul(g, p)
         end if
      end do
   end subroutine project_rates

   !> Axes and wanted rates of the rows that act now; 0 beyond them
   pure subroutine rows_of(state, rows, most, b, u, drives, n, target, active)
      type(consistent_state_t), intent(in) :: state
      type(row_t), intent(in) :: rows(3)
      integer, intent(in) :: most                    !! rows used
      real(wp), intent(out) :: b(3, 3), u(3)
      logical, intent(out) :: drives(3)
      integer, intent(out) :: n
      real(wp), intent(in), optional :: target(:)    !! without them: blocked rows alone
      logical, intent(in), optional :: active(:)

      integer :: k, m

      n = 0
      drives = .false.
      b = 0.0_wp
      u = 0.0_wp
      do k = 1, most
         m = rows(k)%motion
         if (m > 0) then
            if (.not. present(active)) cycle
            if (.not. active(m)) cycle
         end if
         n = n + 1
         b(n, :) = axis_of(state%skew, rows(k)%skew, rows(k)%dir)
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

      real(wp) :: b(3, 3), u(3), a(3)
      logical :: drives(3)
      integer :: part, k, n

      do part = 1, 2
         p(:, :, part) = IDENTITY
         if (part == 1 .and. .not. model%inverse_mass(lead) > 0.0_wp) p(:, :, part) = 0.0_wp
         if (part == 2 .and. .not. maxval(model%inverse_inertia(lead, :)) > 0.0_wp) &
            p(:, :, part) = 0.0_wp
         if (model%hold_of(lead) == 0) cycle
         associate (hold => model%hold(model%hold_of(lead)))
            if (part == 1) call rows_of(state, hold%trans, hold%n_trans, b, u, drives, n, &
               state%mean, active)
            if (part == 2) call rows_of(state, hold%rot, hold%n_rot, b, u, drives, n, state%mean, &
               active)
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

      real(wp) :: e(9), q(4)

      q = state%poses%quat(lead, :)                  ! no strided section: it would be copied
      e = columns(q)
      p(:, 1) = e(1:3)
      p(:, 2) = e(4:6)
      p(:, 3) = e(7:9)
   end function body_matrix

   pure function inertia(model, state, lead) result(j)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp) :: j(3, 3)

      real(wp) :: p(3, 3), scaled(3, 3)
      integer :: k

      p = body_matrix(state, lead)
      do k = 1, 3
         scaled(:, k) = p(:, k)*model%spin_inertia(lead, k)
      end do
      j = times_transposed(scaled, p)
   end function inertia

   pure function inverse_inertia(model, state, lead) result(g)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp) :: g(3, 3)

      real(wp) :: p(3, 3), scaled(3, 3)
      integer :: k

      p = body_matrix(state, lead)
      do k = 1, 3
         scaled(:, k) = p(:, k)*(1.0_wp/model%spin_inertia(lead, k))
      end do
      g = times_transposed(scaled, p)
   end function inverse_inertia

   !> After the drift: leads with a single free axis e turn about it exactly, by h e.w; a lead with
   !> all axes held or driven turns with the driven velocity; with two free axes the plane rotations
   !> stay.
   !>
   !> Attitudes before the drift and angular velocities during it: state%kept
   subroutine hold_rotations(model, target, active, first, last, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: target(:)              !! (n_motion)
      logical, intent(in) :: active(:)
      integer, intent(in) :: first, last             !! holds
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: q(4), p(4), turned(4), w(3), b(3, 3), u(3)
      logical :: drives(3)
      integer :: i, n, lead

      do i = first, last
         lead = model%hold(i)%lead
         call rows_of(state, model%hold(i)%rot, model%hold(i)%n_rot, b, u, drives, n, target, &
            active)
         if (n < 2) cycle
         w = state%kept%w(:, i)
         q = to_quaternion(rotation(state%poses%h(lane_of(lead))*w))
         p = state%kept%quat(:, i)
         turned = quaternion_product(q, p)
         state%poses%quat(lead, :) = turned          ! at once: of a lead at rest others look at it
         state%l(lead, :) = matmul(inertia(model, state, lead), w)
      end do
   end subroutine hold_rotations

   !> Force without its components along blocked directions (they do no work); with accelerations of
   !> motions that act, with what makes them
   subroutine held_force(model, state, i, f, t, wanted, active)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: i                       !! index of the hold
      real(wp), intent(inout) :: f(3), t(3)
      real(wp), intent(in), optional :: wanted(:)    !! (n_motion)
      logical, intent(in), optional :: active(:)

      real(wp) :: b(3, 3), u(3), power
      logical :: drives(3)
      integer :: n

      associate (hold => model%hold(i))
         call rows_of(state, hold%trans, hold%n_trans, b, u, drives, n, wanted, active)
         u = model%mass(hold%lead)*u
         if (n > 0) call drive(n, b, u, drives, FIRST_HALF, u, IDENTITY, f, power)
         call rows_of(state, hold%rot, hold%n_rot, b, u, drives, n, wanted, active)
         if (n == 3 .and. .not. any(drives)) then
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

   !> Conditions by ascending lead, and how many there are up to each block of leads. What is
   !> blocked in all directions rests: it needs no more than an infinite mass.
   pure subroutine sort_holds(hold, model)
      type(hold_t), intent(in) :: hold(:)
      type(consistent_model_t), intent(inout) :: model

      integer :: lead, n

      model%rests = [(.false., lead=1, size(model%hold_of))]
      do n = 1, size(hold)
         associate (h => hold(n))
            model%rests(h%lead) = all_blocked(h%trans, h%n_trans) .and. all_blocked(h%rot, h%n_rot)
         end associate
      end do
      model%turns = merge(0.0_wp, 1.0_wp, model%rests)
      where (model%rests) model%hold_of = 0
      associate (blocks => (size(model%hold_of) + BLOCK - 1)/BLOCK)
         allocate (model%hold(count(model%hold_of > 0)), model%hold_to(0:blocks))
         allocate (model%mover(2, blocks), source=0)
      end associate
      model%hold_to(0) = 0
      n = 0
      do lead = 1, size(model%hold_of)
         if (.not. model%rests(lead)) then
            associate (m => model%mover(:, block_of(lead)))
               if (m(1) == 0) m(1) = lead
               m(2) = lead
            end associate
         end if
         if (model%hold_of(lead) > 0) then
            n = n + 1
            model%hold(n) = hold(model%hold_of(lead))
            model%hold_of(lead) = n
         end if
         model%hold_to(block_of(lead)) = n
      end do
   end subroutine sort_holds

   !> Rows hold three directions, and none is driven
   pure logical function all_blocked(rows, n) result(blocked)
      type(row_t), intent(in) :: rows(3)
      integer, intent(in) :: n

      blocked = n == 3 .and. all(rows%motion == 0)
   end function all_blocked

end module kj_consistent_conditions
