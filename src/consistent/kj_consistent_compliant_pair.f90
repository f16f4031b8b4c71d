!> A step of fourth order: two short ones and a long one over the same time, whose errors of second
!> order cancel in fine + (fine - coarse)/3. What lies between fine and coarse is the error of the
!> long step.
!> Source: docs/theory/compliant.md 4.
module kj_consistent_compliant_pair
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t, LONG
   use kj_consistent_compliant_forces, only: take_coordinates
   use kj_consistent_compliant_pass, only: see_joints
   use kj_consistent_compliant_rows, only: extrapolate
   use kj_consistent_compliant_start, only: find_explicit
   use kj_consistent_compliant_step, only: compliant_step
   use kj_consistent_compliant_undo, only: keep_all, undo_step, has_moved_on, BEFORE, &
      FINE
   use kj_consistent_step, only: place_nodes
   implicit none
   private

   public :: pair_step

   integer, parameter, public :: SOLVES = LONG   !! in a pair
   real(wp), parameter :: THIRD = 1.0_wp/3.0_wp

contains

   !> From t to t + h; good is false, and the state that at t, when a step does not converge
   subroutine pair_step(model, h, close_way, close_turn, state, good, way, turn, passes)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      real(wp), intent(in) :: close_way, close_turn   !! errors that the passes are held against
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: good
      real(wp), intent(out) :: way, turn         !! error of the long step: bodies, rad
      integer, intent(out) :: passes

      integer :: part

      way = 0.0_wp
      turn = 0.0_wp
      passes = 0
      call keep_all(model, BEFORE, state)
      state%compliant%e_way = close_way
      state%compliant%e_turn = close_turn
      do part = 1, LONG
         state%compliant%part = part
         if (part == LONG) then
            call keep_all(model, FINE, state)
            call guess_long(model, state%compliant)
            call undo_step(model, state)
            state%compliant%known = state%cycle
            state%compliant%h_known = 0.0_wp     ! of no step: to be improved
         end if
         call compliant_step(model, merge(h, 0.5_wp*h, part == LONG), state, good)
         state%compliant%part = 0
         passes = passes + state%compliant%passes
         if (.not. good) then
            if (part > 1 .or. has_moved_on(state)) call undo_step(model, state)
            return
         end if
      end do
      call combine(model, state, way, turn)
   end subroutine pair_step

   !> Multipliers f of the long step: they rise from those of t - h/6 to those of t + h/3, the first
   !> short step's to t + h/6, the second's from t + h/3 to t + 2 h/3
   pure subroutine guess_long(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      integer :: b, at, n, first, i, k

      first = 0
      do b = 1, size(model%batch)
         do at = 1, size(self%joint(b)%block)
            n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
            associate (rows => self%joint(b)%block(at), kept => self%then(BEFORE)%joint)
               do k = 1, self%last(b)
                  !$omp simd
                  do i = 1, n
                     rows%g(i, k) = kept(i, 3 + k, first + at)
                     rows%rise(i, k) = 0.25_wp*rows%rise(i, k) + 1.25_wp*rows%rise_before(i, k)
                  end do
               end do
               call extrapolate(n, self%last(b), 1.0_wp, rows)
            end associate
         end do
         first = first + size(self%joint(b)%block)
      end do
   end subroutine guess_long

   !> The state after the long step becomes that of fourth order
   subroutine combine(model, state, way, turn)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      real(wp), intent(out) :: way, turn

      real(wp) :: most(2), angle, work, from(4), to(4)
      integer :: i, b, at, n, first

      most = 0.0_wp
      associate (fine => state%compliant%then(FINE), self => state%compliant)
         do i = 1, model%n_lead
            to = fine%leads%quat(i, :)
            from = state%poses%quat(i, :)
            call turn_on(to, from, angle)
            state%poses%quat(i, :) = from
            if (.not. (model%inverse_mass(i) > 0.0_wp .or. model%inverse_inertia(i, 1) > 0.0_wp)) &
               cycle
            most = max(most, [sum((fine%leads%x(i, :) - state%poses%x(i, :))**2), angle])
         end do
         way = sqrt(most(1))
         turn = most(2)
         call go_on(fine%leads%x, state%poses%x)
         call go_on(fine%leads%d, state%poses%d)
         call go_on(fine%leads%v, state%v)
         call go_on(fine%leads%l, state%l)
         call go_on(fine%leads%impulse, state%impulse)
         call go_on(fine%leads%angular_impulse, state%angular_impulse)
         call go_on(fine%turn, state%turn)
         work = fine%work + THIRD*(fine%work - state%work)
         first = 0
         do b = 1, size(model%batch)
            do at = 1, size(state%joint(b)%block)
               n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
               associate (rows => self%joint(b)%block(at), lanes => state%joint(b)%block(at))
                  lanes%elastic(:n) = lanes%elastic(:n) + (fine%joint(:n, 3, first + at) - &
                     rows%elastic(:n))
                  ! of the work on rows, what is not stored
                  lanes%dissipated(:n) = fine%joint(:n, 2, first + at) + THIRD* &
                     (fine%joint(:n, 2, first + at) - lanes%dissipated(:n) + &
                     fine%joint(:n, 3, first + at) - rows%elastic(:n))
                  rows%elastic(:n) = fine%joint(:n, 3, first + at)
                  rows%g(:n, :) = fine%joint(:n, 4:9, first + at)
                  rows%rise(:n, :) = fine%joint(:n, 10:15, first + at)
               end associate
            end do
            first = first + size(state%joint(b)%block)
         end do
         state%cycle = state%compliant%then(BEFORE)%cycle + SOLVES
         self%jump = fine%jump
         self%h_last = fine%h_last
         self%h_stiff = fine%h_stiff
         self%factored = .false.
         call place_nodes(model, state)
         call see_joints(model, state, self)
         call count_way(model, state, self)
      end associate
      call find_explicit(model, state)
      call take_coordinates(model, state, state%compliant)
      state%work = work
   end subroutine combine

   !> Work of the multipliers on what the coordinates of the pose differ by from those that the work
   !> so far belongs to
   pure subroutine count_way(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(in) :: self

      integer :: b, at, n, k, i, first

      first = 0
      do b = 1, size(model%batch)
         do at = 1, size(state%joint(b)%block)
            n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
            associate (rows => self%joint(b)%block(at), lanes => state%joint(b)%block(at), &
               fine => self%then(FINE)%joint)
               do k = 1, merge(self%last(b), 0, self%rowed(b))
                  do i = 1, n
                     if (rows%weight(i, k) > 0.0_wp) lanes%dissipated(i) = lanes%dissipated(i) + &
                        rows%g(i, k)*(rows%q(i, k) - fine(i, 15 + k, first + at) - &
                        THIRD*(fine(i, 15 + k, first + at) - lanes%q(i, k)))
                  end do
               end do
            end associate
         end do
         first = first + size(state%joint(b)%block)
      end do
   end subroutine count_way

   !> coarse := fine + (fine - coarse)/3
   pure subroutine go_on(fine, coarse)
      real(wp), intent(in) :: fine(:, :)
      real(wp), intent(inout) :: coarse(:, :)

      coarse = fine + THIRD*(fine - coarse)
   end subroutine go_on

   !> The same with attitudes, by a third of the rotation from coarse to fine; its angle
   pure subroutine turn_on(fine, coarse, angle)
      real(wp), intent(in) :: fine(4)
      real(wp), intent(inout) :: coarse(4)
      real(wp), intent(out) :: angle

      real(wp) :: a(4), part, s

      a = product_of(fine, [coarse(1), -coarse(2:4)])
      s = norm2(a(2:4))
      angle = 2.0_wp*atan2(s, abs(a(1)))
      part = THIRD
      if (s > 0.0_wp) part = sin(0.5_wp*THIRD*angle)/s
      coarse = product_of([cos(0.5_wp*THIRD*angle), sign(part, a(1))*a(2:4)], fine)
   end subroutine turn_on

   !> Product of quaternions
   pure function product_of(a, b) result(c)
      real(wp), intent(in) :: a(4), b(4)
      real(wp) :: c(4)

      c = [a(1)*b(1) - a(2)*b(2) - a(3)*b(3) - a(4)*b(4), &
         a(1)*b(2) + a(2)*b(1) + a(3)*b(4) - a(4)*b(3), &
         a(1)*b(3) - a(2)*b(4) + a(3)*b(1) + a(4)*b(2), &
         a(1)*b(4) + a(2)*b(3) - a(3)*b(2) + a(4)*b(1)]
   end function product_of

end module kj_consistent_compliant_pair
