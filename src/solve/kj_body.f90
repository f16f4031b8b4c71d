!> Rigid bodies of the legacy scheme: nodal forces -> accelerations -> motion of their nodes.
!> Source: legacy_scheme.md 3.2, 3.3.
module kj_body
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_math3, only: cross, rotation
   use kj_lapack, only: solve_dense
   use kj_model, only: model_t
   use kj_state, only: state_t
   use kj_skew, only: axis_of
   use kj_joint_frame, only: BLOCK, turn_frames, to_local, to_world
   implicit none
   private

   public :: turn_bodies, solve_conditioned, linear_accelerations, move_leads, move_secondaries, &
      check_turns
   public :: secondary_velocity

contains

   !> Turn the principal axes by h1 w and solve the Euler equations of bodies lo..hi.
   !>
   !> al = P I^-1 (P^T m - w_l x I w_l), w at t - h1/2
   subroutine turn_bodies(state, lo, hi)
      type(state_t), intent(inout) :: state
      integer, intent(in) :: lo, hi

      real(wp), dimension(BLOCK, 3) :: phi, w, m, wl, ml, al
      real(wp) :: p(BLOCK, 9)
      integer :: from, to, n, i, k

      do from = lo, hi, BLOCK
         to = min(from + BLOCK - 1, hi)
         n = to - from + 1
         do k = 1, 3
            state%principal(from:to, k) = max(state%principal(from:to, k), state%inertia(from:to))
            w(:n, k) = state%world%w(from:to, k)
            phi(:n, k) = state%h1*w(:n, k)
            m(:n, k) = state%m(from:to, k) + state%m_own(from:to, k)
         end do
         p(:n, :) = state%p(from:to, :)
         call turn_frames(n, phi, p)
         state%p(from:to, :) = p(:n, :)
         call to_local(n, p, w, wl)
         call to_local(n, p, m, ml)
         associate (inertia => state%principal(from:to, :))
            do i = 1, n
               ml(i, 1) = (ml(i, 1) + (inertia(i, 2) - inertia(i, 3))*wl(i, 2)*wl(i, &
                  3))/inertia(i, 1)
               ml(i, 2) = (ml(i, 2) + (inertia(i, 3) - inertia(i, 1))*wl(i, 3)*wl(i, &
                  1))/inertia(i, 2)
               ml(i, 3) = (ml(i, 3) + (inertia(i, 1) - inertia(i, 2))*wl(i, 1)*wl(i, &
                  2))/inertia(i, 3)
            end do
         end associate
         call to_world(n, p, ml, al)
         state%al(from:to, :) = al(:n, :)
      end do
   end subroutine turn_bodies

   !> Bodies with rotational conditions: solve the reduced system (B J B^T) g = B m, al = B^T g,
   !> where the rows of B are the free axes.
   subroutine solve_conditioned(model, state)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state

      real(wp) :: p(3, 3), j(3, 3), b(3, 3), w(3), m(3), g(3)
      integer :: i, lead, dof, n
      logical :: ok

      do i = 1, size(model%bcs)
         lead = model%bcs(i)%lead
         if (lead > model%n_body .or. .not. any(model%bcs(i)%fixed(4:6))) cycle
         n = 0
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
         g(:n) = matmul(b(:n, :), m)
         call solve_dense(n, matmul(matmul(b(:n, :), j), transpose(b(:n, :))), g(:n), ok)
         if (ok) state%al(lead, :) = matmul(g(:n), b(:n, :))
      end do
   end subroutine solve_conditioned

   !> a = f/m and, for free nodes, al = m/I, of leads lo..hi; zero where there is no mass or inertia
   subroutine linear_accelerations(model, lo, hi, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      type(state_t), intent(inout) :: state

      integer :: i, k

      do k = 1, 3
         do i = lo, hi
            state%a(i, k) = 0.0_wp
            if (state%mass(i) > 0.0_wp) &
               state%a(i, k) = (state%f(i, k) + state%f_own(i, k))/state%mass(i)
         end do
         do i = max(lo, model%n_body + 1), hi
            state%al(i, k) = 0.0_wp
            if (state%inertia(i) > 0.0_wp) &
               state%al(i, k) = (state%m(i, k) + state%m_own(i, k))/state%inertia(i)
         end do
      end do
   end subroutine linear_accelerations

   !> v += h12 a, w += h12 al, x += h2 v of leads lo..hi
   subroutine move_leads(lo, hi, state)
      integer, intent(in) :: lo, hi
      type(state_t), intent(inout) :: state

      integer :: i, k

      do k = 1, 3
         do i = lo, hi
            state%v(i, k) = state%v(i, k) + state%h12*state%a(i, k)
            state%world%w(i, k) = state%world%w(i, k) + state%h12*state%al(i, k)
            state%d(i, k) = state%d(i, k) + state%h2*state%v(i, k)
            state%world%x(i, k) = state%world%x(i, k) + state%h2*state%v(i, k)
         end do
      end do
   end subroutine move_leads

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

   !> Move the secondary nodes of bodies lo..hi by one step; the leads have their old velocities and
   !> positions
   subroutine move_secondaries(model, lo, hi, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      type(state_t), intent(inout) :: state

      real(wp) :: w(3), v(3)
      integer :: b, k

      do b = lo, hi
         do k = 1, 3
            v(k) = state%v(b, k) + state%h12*state%a(b, k)
            w(k) = state%world%w(b, k) + state%h12*state%al(b, k)
         end do
         call move_crew(state, b, model%first(b + 1) - model%first(b) <= 2, v, w)
      end do
   end subroutine move_secondaries

   !> Keep the largest turn in a step.
   !>
   !> Errors: ERR_RUN when a body with more than two secondary nodes turned by over 1 rad.
   subroutine check_turns(model, state, error)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: turn2
      integer :: b

      do b = 1, model%n_body
         turn2 = state%h2**2*(state%world%w(b, 1)**2 + state%world%w(b, 2)**2 + &
            state%world%w(b, 3)**2)
         if (turn2 > state%turn2) then
            state%turn2 = turn2
            state%turn_body = b
         end if
         if (turn2 > 1.0_wp .and. model%first(b + 1) - model%first(b) > 2) then
            call fail(error, ERR_RUN, 'body '//str(model%body_id(b))// &
               ' turns by more than 1 rad in a step')
            return
         end if
      end do
   end subroutine check_turns

   !> Move the secondary nodes of one body that anyone reads; see secondary_velocity
   pure subroutine move_crew(state, b, few, v, w)
      type(state_t), intent(inout) :: state
      integer, intent(in) :: b
      logical, intent(in) :: few
      real(wp), intent(in) :: v(3), w(3)        !! new velocities of the body

      real(wp) :: r1, r2, r3, t1, t2, t3, u(3), half
      integer :: i, k

      half = 0.5_wp*state%h2
      do k = state%first_moved(b), state%first_moved(b + 1) - 1
         i = state%moved(k)
         r1 = state%world%x(i, 1) - state%world%x(b, 1)
         r2 = state%world%x(i, 2) - state%world%x(b, 2)
         r3 = state%world%x(i, 3) - state%world%x(b, 3)
         if (few) then
            u = secondary_velocity(v, w, [r1, r2, r3], state%h2, state%h12, few)
         else
            t1 = w(2)*r3 - w(3)*r2
            t2 = w(3)*r1 - w(1)*r3
            t3 = w(1)*r2 - w(2)*r1
            u(1) = v(1) + t1 + half*(w(2)*t3 - w(3)*t2)
            u(2) = v(2) + t2 + half*(w(3)*t1 - w(1)*t3)
            u(3) = v(3) + t3 + half*(w(1)*t2 - w(2)*t1)
         end if
         state%v(i, 1) = u(1)
         state%v(i, 2) = u(2)
         state%v(i, 3) = u(3)
         state%d(i, 1) = state%d(i, 1) + state%h2*u(1)
         state%d(i, 2) = state%d(i, 2) + state%h2*u(2)
         state%d(i, 3) = state%d(i, 3) + state%h2*u(3)
         state%world%x(i, 1) = state%world%x(i, 1) + state%h2*u(1)
         state%world%x(i, 2) = state%world%x(i, 2) + state%h2*u(2)
         state%world%x(i, 3) = state%world%x(i, 3) + state%h2*u(3)
      end do
   end subroutine move_crew

end module kj_body
