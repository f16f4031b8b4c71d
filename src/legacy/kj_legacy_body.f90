!> Rigid bodies of the legacy scheme: nodal forces -> accelerations -> motion of their nodes.
!> Source: docs/theory/legacy.md 2.3 to 2.5.
module kj_legacy_body
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_math3, only: cross, rotation, solve_small
   use kj_model, only: model_t, body_title
   use kj_legacy_state, only: legacy_state_t, crew_t
   use kj_skew, only: axis_of
   use kj_block, only: BLOCK, group_of, turn_frames, to_local, to_world
   implicit none
   private

   public :: turn_bodies, solve_conditioned, linear_accelerations, move_leads, move_secondaries, &
      check_turns
   public :: secondary_velocity

contains

   !> Turn the principal axes by h1 w and solve the Euler equations of bodies lo..hi.
   !>
   !> al = P I^-1 (P^T m - w_l x I w_l), w at t - h1/2
   subroutine turn_bodies(lo, hi, moment, state, fastest)
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: moment(lo:, :)     !! (>= hi - lo + 1, 3) W
      type(legacy_state_t), intent(inout) :: state
      real(wp), intent(inout) :: fastest         !! the largest w**2, of them too

      integer :: from, n

      from = lo
      do while (from <= hi)
         n = group_of(hi - from + 1)
         select case (n)
         case (1)
            call turn_block(1, from, moment(from:, :), state, fastest)
         case (2)
            call turn_block(2, from, moment(from:, :), state, fastest)
         case (3)
            call turn_block(3, from, moment(from:, :), state, fastest)
         case (4)
            call turn_block(4, from, moment(from:, :), state, fastest)
         case (8)
            call turn_block(8, from, moment(from:, :), state, fastest)
         case default
            call turn_block(n, from, moment(from:, :), state, fastest)
         end select
         from = from + n
      end do
   end subroutine turn_bodies

   !> The same of n bodies from ..., at most BLOCK
   subroutine turn_block(n, from, moment, state, fastest)
      integer, value :: n, from
      real(wp), intent(in) :: moment(:, :)       !! (>= n, 3) W
      type(legacy_state_t), intent(inout) :: state
      real(wp), intent(inout) :: fastest

      real(wp), dimension(BLOCK, 3) :: phi, w, m, wl, ml, al, j
      real(wp) :: p(BLOCK, 9)
      integer :: i, k

      do k = 1, 3
         do i = 1, n
            state%principal(from + i - 1, k) = max(state%principal(from + i - 1, k), &
               state%inertia(from + i - 1))
            j(i, k) = state%principal(from + i - 1, k)
            w(i, k) = state%world%w(from + i - 1, k)
            phi(i, k) = state%h1*w(i, k)
            m(i, k) = moment(i, k)
         end do
      end do
      !$omp simd reduction(max: fastest)
      do i = 1, n
         fastest = max(fastest, w(i, 1)**2 + w(i, 2)**2 + w(i, 3)**2)
      end do
      do k = 1, 9
         p(:n, k) = state%p(from:from + n - 1, k)
      end do
      call turn_frames(n, phi, p)
      do k = 1, 9
         state%p(from:from + n - 1, k) = p(:n, k)
      end do
      call to_local(n, p, w, wl)
      call to_local(n, p, m, ml)
      !$omp simd
      do i = 1, n
         ml(i, 1) = (ml(i, 1) + (j(i, 2) - j(i, 3))*wl(i, 2)*wl(i, 3))/j(i, 1)
         ml(i, 2) = (ml(i, 2) + (j(i, 3) - j(i, 1))*wl(i, 3)*wl(i, 1))/j(i, 2)
         ml(i, 3) = (ml(i, 3) + (j(i, 1) - j(i, 2))*wl(i, 1)*wl(i, 2))/j(i, 3)
      end do
      call to_world(n, p, ml, al)
      do k = 1, 3
         state%al(from:from + n - 1, k) = al(:n, k)
      end do
   end subroutine turn_block

   !> Bodies with rotational conditions: solve the reduced system (B J B^T) g = B m, al = B^T g,
   !> where the rows of B are the free axes.
   subroutine solve_conditioned(model, state)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: p(3, 3), j(3, 3), b(3, 3), a(3, 3), w(3), m(3), g(3)
      integer :: i, lead, dof, n
      logical :: ok

      do i = 1, size(model%bcs)
         lead = model%bcs(i)%lead
         if (lead > model%n_body .or. .not. any(model%bcs(i)%fixed(4:6))) cycle
         n = 0
         b = 0.0_wp
         do dof = 1, 3
            if (model%bcs(i)%fixed(dof + 3)) cycle
            n = n + 1
            b(n, :) = axis_of(state%world%skew, model%bcs(i)%skew, dof)
         end do
         state%al(lead, :) = 0.0_wp
         if (n == 0) cycle
         p = reshape(state%p(lead, :), [3, 3])
         j = matmul(p*spread(state%principal(lead, :), 1, 3), transpose(p))
         w = state%world%w(lead, :)
         m = state%m(lead, :) + state%m_own(lead, :) + cross(matmul(j, w), w)
         g = matmul(b, m)
         a = matmul(matmul(b, j), transpose(b))
         call solve_small(n, a, g, ok)
         if (ok) state%al(lead, :) = matmul(g, b)
      end do
   end subroutine solve_conditioned

   !> a = f/m and, for free nodes, al = m/I, of leads lo..hi; zero where there is no mass or inertia
   pure subroutine linear_accelerations(n_body, lo, hi, f, m, state)
      integer, intent(in) :: n_body, lo, hi
      real(wp), contiguous, intent(in) :: f(lo:, :), m(lo:, :)   !! (>= hi - lo + 1, 3) W
      type(legacy_state_t), intent(inout) :: state

      integer :: first, k

      first = max(lo, n_body + 1)
      do k = 1, 3
         call divide(hi - lo + 1, f(lo:, k), state%mass(lo:hi), state%a(lo:hi, k))
         call divide(hi - first + 1, m(first:, k), state%inertia(first:hi), state%al(first:hi, k))
      end do
   end subroutine linear_accelerations

   !> y = x/m, 0 where m is; no division by 0, which a host may trap
   pure subroutine divide(n, x, m, y)
      integer, value :: n
      real(wp), intent(in) :: x(n), m(n)
      real(wp), intent(out) :: y(n)

      integer :: i

      !$omp simd
      do i = 1, n
         y(i) = merge(x(i), 0.0_wp, m(i) > 0.0_wp)/max(m(i), tiny(m))
      end do
   end subroutine divide

   !> v += h12 a, w += h12 al, x += h2 v of leads lo..hi; of bodies before that the sum of h2 w
   pure subroutine move_leads(placed, lo, hi, state)
      logical, intent(in) :: placed              !! someone reads d of one of them
      integer, intent(in) :: lo, hi
      type(legacy_state_t), intent(inout) :: state

      integer :: from, n

      from = lo
      do while (from <= hi)
         n = group_of(hi - from + 1)
         select case (n)
         case (1)
            call move_block(1, from, placed, state)
         case (2)
            call move_block(2, from, placed, state)
         case (3)
            call move_block(3, from, placed, state)
         case (4)
            call move_block(4, from, placed, state)
         case (8)
            call move_block(8, from, placed, state)
         case default
            call move_block(n, from, placed, state)
         end select
         from = from + n
      end do
   end subroutine move_leads

   pure subroutine move_block(n, lo, placed, state)
      integer, value :: n, lo
      logical, intent(in) :: placed
      type(legacy_state_t), intent(inout) :: state

      integer :: k, hi, last

      hi = lo + n - 1
      last = min(hi, size(state%rotation_sum, 1))
      do k = 1, 3
         call add_to(last - lo + 1, state%h2, state%world%w(lo:last, k), &
            state%rotation_sum(lo:last, k))
         call add_to(n, state%h12, state%a(lo:hi, k), state%v(lo:hi, k))
         call add_to(n, state%h12, state%al(lo:hi, k), state%world%w(lo:hi, k))
         if (placed) call add_to(n, state%h2, state%v(lo:hi, k), state%d(lo:hi, k))
         call add_to(n, state%h2, state%v(lo:hi, k), state%world%x(lo:hi, k))
      end do
   end subroutine move_block

   !> y := y + h x
   pure subroutine add_to(n, h, x, y)
      integer, value :: n
      real(wp), intent(in) :: h, x(n)
      real(wp), intent(inout) :: y(n)

      integer :: i

      !$omp simd
      do i = 1, n
         y(i) = y(i) + h*x(i)
      end do
   end subroutine add_to

   !> New velocity of a secondary node at r from the main node, given the body's new v and w.
   !>
   !> v + w x r + h2/2 w x (w x r). With at most two secondary nodes (`few`) the first w x r is the
   !> finite rotation over h12 once it is large, and the centripetal part counts twice.
   pure function secondary_velocity(v, w, r, h2, h12, few) result(u)
      real(wp), intent(in) :: v(3), w(3), r(3), h2, h12
      logical, intent(in) :: few
      real(wp) :: u(3)

      real(wp) :: rel(3)

      rel = cross(w, r)
      if (few) then
         if (dot_product(w, w)*h12**2 > 1.0e-6_wp .and. dot_product(rel, rel)*h12**2 > 1.0e-8_wp) &
            rel = (matmul(rotation(w*h12), r) - r)/h12
      end if
      u = v + rel + 0.5_wp*h2*cross(w, rel)
   end function secondary_velocity

   !> Move the crews of leads lo..hi, which have their old velocities and positions, by one step
   pure subroutine move_secondaries(lo, hi, state)
      integer, intent(in) :: lo, hi
      type(legacy_state_t), intent(inout) :: state

      call move_crew(state%crew, lo, hi, state%h2, state%h12, size(state%v, 1), size(state%a, 1), &
         state%a, state%al, state%world%w, state%world%x, state%v, state%d)
   end subroutine move_secondaries

   !> The same with arrays that the compiler knows to be apart; see secondary_velocity. Nodes of a
   !> lead at rest stay where they are.
   pure subroutine move_crew(crew, lo, hi, h2, h12, n_node, n_lead, a, al, w, x, v, d)
      type(crew_t), intent(in) :: crew
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: h2, h12
      integer, intent(in) :: n_node, n_lead
      real(wp), dimension(n_lead, 3), intent(in) :: a, al, w
      real(wp), dimension(n_node, 3), intent(inout) :: x, v, d

      real(wp) :: u(3), t(3), r(3), wb(3), vb(3), xb(3)
      logical :: rests
      integer :: i, k, b

      do b = lo, hi
         vb = v(b, :) + h12*a(b, :)
         wb = w(b, :) + h12*al(b, :)
         xb = x(b, :)
         rests = all(abs(vb) <= 0.0_wp) .and. all(abs(wb) <= 0.0_wp)
         if (rests .and. crew%unread(b)) cycle
         do k = crew%first(b), crew%first(b + 1) - 1
            if (rests .and. .not. crew%kept(k)) cycle
            i = crew%node(k)
            r = x(i, :) - xb
            if (crew%few(b)) then
               u = secondary_velocity(vb, wb, r, h2, h12, .true.)
            else
               t(1) = wb(2)*r(3) - wb(3)*r(2)
               t(2) = wb(3)*r(1) - wb(1)*r(3)
               t(3) = wb(1)*r(2) - wb(2)*r(1)
               u(1) = vb(1) + t(1) + 0.5_wp*h2*(wb(2)*t(3) - wb(3)*t(2))
               u(2) = vb(2) + t(2) + 0.5_wp*h2*(wb(3)*t(1) - wb(1)*t(3))
               u(3) = vb(3) + t(3) + 0.5_wp*h2*(wb(1)*t(2) - wb(2)*t(1))
            end if
            x(i, :) = x(i, :) + h2*u
            if (.not. crew%kept(k)) cycle
            v(i, :) = u
            d(i, :) = d(i, :) + h2*u
         end do
      end do
   end subroutine move_crew

   !> Errors: ERR_RUN when a body with more than two secondary nodes turned by over 1 rad.
   subroutine check_turns(model, state, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error

      integer :: b, piece

      do piece = 1, size(state%fastest)
         ! conditions have made some slower since, none faster
         if (state%h2**2*state%fastest(piece) <= 1.0_wp) cycle
         do b = state%team%lead(1, piece), min(state%team%lead(2, piece), model%n_body)
            if (model%n_secondary(b) <= 2) cycle
            if (state%h2**2*(state%world%w(b, 1)**2 + state%world%w(b, 2)**2 + &
               state%world%w(b, 3)**2) <= 1.0_wp) cycle
            call fail(error, ERR_RUN, 'body '//body_title(model, b)// &
               ' turns by more than 1 rad in a step')
            return
         end do
      end do
   end subroutine check_turns

end module kj_legacy_body
