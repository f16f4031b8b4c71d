!> What joints do in a step of the integrator `compliant` beside their implicit rows: explicit
!> springs, stops and friction, dampers of explicit rows, and locks.
!> Source: docs/theory/compliant.md 2, 5.
!> One file: what a step does with the joints, stage by stage.
module kj_consistent_compliant_forces
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of
   use kj_joint_types, only: joint_types, NDOF, CHART_VECTOR
   use kj_joint_batch, only: LAW_DAMPER, LAW_DAMPER_CURVE, LAW_HARDENED, is_hardened, joint_batch_t
   use kj_consistent_batch, only: limit_block_t
   use kj_consistent_matrix, only: rates, put_wrench, add_moment, N_CONSISTENT_WRENCH
   use kj_consistent_springs, only: laws
   use kj_consistent_dampers, only: damper
   use kj_consistent_hardening, only: hardened_damper
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t
   use kj_consistent_compliant_matrix, only: add_wrenches, wrench_of_rows
   use kj_consistent_compliant_rows, only: take_block
   implicit none
   private

   public :: spring_forces, damper_rows, add_rests, take_coordinates, renew_locks, &
      locks_turn

   real(wp), parameter :: SAME_TIME = 1.0e-9_wp  !! of the time itself

contains



   !> Forces of explicit rows without dampers in the pose that was seen, added to those of the
   !> leads; what they store and lose
   subroutine spring_forces(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(in) :: self

      integer :: piece, b

      if (.not. any(self%sprung)) return
      if (model%team%threads > 1) then
         !$omp parallel do schedule(static) num_threads(model%team%threads)
         do piece = 1, size(model%team%joint, 2)
            call springs_of_piece(model, model%team%joint(:, piece), self, state)
         end do
      else
         do piece = 1, size(model%team%joint, 2)
            call springs_of_piece(model, model%team%joint(:, piece), self, state)
         end do
      end if
      do b = 1, size(model%batch)
         if (self%sprung(b)) call add_rows(model%batch(b), state%wrench, state%f, state%t)
      end do
   end subroutine spring_forces

   subroutine springs_of_piece(model, piece, self, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: piece(3)
      type(compliant_t), intent(in) :: self
      type(consistent_state_t), intent(inout) :: state

      integer :: from

      if (.not. self%sprung(piece(1))) return
      do from = piece(2), piece(3), BLOCK
         call springs_of_block(model, piece(1), from, min(BLOCK, piece(3) - from + 1), self, state)
      end do
   end subroutine springs_of_piece

   !> Add wrenches that stand as rows of all joints
   pure subroutine add_rows(batch, wrench, f, t)
      type(joint_batch_t), intent(in) :: batch
      real(wp), contiguous, intent(in) :: wrench(:, :)   !! (N_CONSISTENT_WRENCH, n_element)
      real(wp), contiguous, intent(inout) :: f(:, :), t(:, :)

      real(wp) :: w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: from, n

      do from = 1, batch%n, BLOCK
         n = min(BLOCK, batch%n - from + 1)
         w(:n, :) = transpose(wrench(:, batch%first + from:batch%first + from + n - 1))
         call add_wrenches(batch, from, n, w, f, t)
      end do
   end subroutine add_rows

   subroutine springs_of_block(model, b, from, n, self, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b, from, n
      type(compliant_t), intent(in) :: self
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: f(BLOCK, 6), lost(BLOCK), moment(BLOCK, 3), rub(BLOCK, 6)
      integer :: at, i, k

      at = (from - 1)/BLOCK + 1
      associate (batch => model%batch(b), rows => self%joint(b)%block(at), &
         lanes => state%joint(b)%block(at))
         call laws(batch, model%curves, state%poses, from, n, rows%q, at, lanes, state%joint(b), &
            f, lost)
         do k = 1, NDOF
            if (.not. self%explicit(k, b)) then
               f(:n, k) = 0.0_wp
               cycle
            end if
            do i = 1, n
               lanes%elastic(i) = lanes%elastic(i) + &
                  0.5_wp*(rows%q(i, k) - lanes%q(i, k))*(f(i, k) + lanes%fe(i, k))
               lanes%fe(i, k) = f(i, k)
            end do
         end do
         rub = 0.0_wp
         if (batch%limited) then
            lanes%elastic(:n) = lanes%elastic(:n) - lost(:n)
            lanes%dissipated(:n) = lanes%dissipated(:n) + lost(:n)
            rub(:n, :) = state%joint(b)%limit(at)%friction(:n, :)
            call rates(batch, NDOF, state%poses%v, state%poses%w, from, n, rows%b, lanes%qd)
         end if
         moment(:n, :) = 0.0_wp
         if (batch%geometry%chart == CHART_VECTOR) then
            call add_moment(n, f(:, 4:6), rows%rot, moment)
         else
            call add_moment(n, f(:, 4:6), rows%b%turn, moment)
         end if
         if (batch%limited) then
            call add_moment(n, rub(:, 4:6), rows%b%turn, moment)
            f(:n, 1:3) = f(:n, 1:3) + rub(:n, 1:3)
         end if
         call put_wrench(n, .false., f(:, 1:3), moment, rows%b, &
            state%wrench(:, batch%first + from:))
      end associate
   end subroutine springs_of_block

   !> Dampers of explicit rows for the velocity stage: rows%damp = h/2 c, for curves the slope at
   !> the rates of the velocities of the poses. Forces beside them, rows%rest: what curves leave,
   !> and dampers of combined stops; any_rest: there may be some.
   subroutine damper_rows(model, h, state, self, any_rest)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(in) :: state
      type(compliant_t), intent(inout) :: self
      logical, intent(out) :: any_rest

      real(wp) :: rate(BLOCK, 6), f(BLOCK), c(BLOCK)
      logical :: curve
      integer :: b, at, from, n, k, i

      any_rest = .false.
      do b = 1, size(model%batch)
         if (.not. self%damped(b)) cycle
         associate (batch => model%batch(b))
            any_rest = any_rest .or. batch%limited .or. &
               any(iand(batch%law, LAW_DAMPER_CURVE + LAW_HARDENED) /= 0)
            do at = 1, size(self%joint(b)%block)
               from = BLOCK*(at - 1) + 1
               n = min(BLOCK, batch%n - from + 1)
               associate (rows => self%joint(b)%block(at))
                  call rates(batch, NDOF, state%poses%v, state%poses%w, from, n, rows%b, rate)
                  do k = 1, NDOF
                     if (.not. self%explicit(k, b)) cycle
                     if (is_hardened(batch)) then
                        call hardened_damper(batch, model%curves, from, n, k, rate(:, k), &
                           state%joint(b)%spring(at), f, c)
                     else
                        call damper(batch, model%curves, from, n, k, rate(:, k), f, c)
                     end if
                     curve = iand(batch%law(k), LAW_DAMPER_CURVE + LAW_HARDENED) /= 0
                     do i = 1, n
                        rows%rest(i, k) = merge(f(i) - c(i)*rate(i, k), 0.0_wp, curve)
                        if (batch%limited) c(i) = c(i) + state%joint(b)%limit(at)%c_limit(i, k)
                        rows%damp(i, k) = merge(0.0_wp, 0.5_wp*h*c(i), rows%k(i, k) > 0.0_wp)
                     end do
                  end do
                  if (batch%limited) call damp_round(n, state%joint(b)%limit(at), rate, rows%rest)
               end associate
            end do
         end associate
      end do
   end subroutine damper_rows

   !> Dampers of combined stops at the predicted rates. Explicit: while a stop acts, h w is 1/20.
   pure subroutine damp_round(n, limit, rate, rest)
      integer, intent(in) :: n
      type(limit_block_t), intent(in) :: limit
      real(wp), intent(in) :: rate(BLOCK, 6)
      real(wp), intent(inout) :: rest(BLOCK, 6)

      integer :: i, part

      do i = 1, n
         do part = 1, 2
            if (.not. limit%c_round(i, part) > 0.0_wp) cycle
            associate (to => 3*part)
               rest(i, to - 2:to) = rest(i, to - 2:to) + limit%c_round(i, part)* &
                  dot_product(limit%to_round(i, to - 2:to), rate(i, to - 2:to))* &
                  limit%to_round(i, to - 2:to)
            end associate
         end do
      end do
   end subroutine damp_round

   !> Add these rests to the forces of the leads
   subroutine add_rests(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(in) :: self

      real(wp) :: w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: b, at, from, n

      do b = 1, size(model%batch)
         if (.not. self%damped(b)) cycle
         do at = 1, size(self%joint(b)%block)
            from = BLOCK*(at - 1) + 1
            n = min(BLOCK, model%batch(b)%n - from + 1)
            call wrench_of_rows(n, NDOF, self%joint(b)%block(at)%rest, self%joint(b)%block(at)%b, w)
            call add_wrenches(model%batch(b), from, n, w, state%f, state%t)
         end do
      end do
   end subroutine add_rests




   !> Coordinates and B of the pose that was tried become those of the joints
   subroutine take_coordinates(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(in) :: self

      integer :: b, at

      do b = 1, size(model%batch)
         do at = 1, size(self%joint(b)%block)
            associate (rows => self%joint(b)%block(at), lanes => state%joint(b)%block(at))
               call take_block(min(BLOCK, model%batch(b)%n - BLOCK*(at - 1)), rows%q, rows%b, &
                  lanes%q, lanes%b)
            end associate
         end do
      end do
   end subroutine take_coordinates




   !> Some lock begins or ends now
   pure logical function locks_turn(model, state) result(turn)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      integer :: b

      turn = .false.
      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         associate (l => model%batch(b)%limit)
            turn = turn .or. any(abs(l%t_lock - state%time) <= SAME_TIME*state%time) .or. &
               any(abs(l%t_free - state%time) <= SAME_TIME*state%time)
         end associate
      end do
   end function locks_turn

   !> Locks that begin or end now: their free rows become implicit ones, or free again. changed:
   !> some did
   subroutine renew_locks(model, state, self, changed)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self
      logical, intent(out) :: changed

      logical :: holds
      integer :: b, at, i, k, j

      changed = .false.
      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         associate (batch => model%batch(b), l => model%batch(b)%limit)
            do j = 1, batch%n
               at = (j - 1)/BLOCK + 1
               i = modulo(j - 1, BLOCK) + 1
               holds = state%time >= l%t_lock(j)*(1.0_wp - SAME_TIME) .and. &
                  state%time < l%t_free(j)*(1.0_wp - SAME_TIME)
               associate (rows => self%joint(b)%block(at))
                  do k = 1, NDOF
                     if (joint_types(batch%row)%free(k) == 0) cycle
                     if (holds .eqv. rows%k(i, k) > 0.0_wp) cycle
                     changed = .true.
                     rows%f(i, k) = 0.0_wp
                     rows%rise(i, k) = 0.0_wp
                     rows%g(i, k) = 0.0_wp
                     rows%k(i, k) = 0.0_wp
                     rows%c(i, k) = 0.0_wp
                     rows%damp(i, k) = 0.0_wp
                     state%joint(b)%block(at)%fd(i, k) = 0.0_wp
                     if (.not. holds) cycle
                     rows%q0(i, k) = state%joint(b)%block(at)%q(i, k)
                     rows%k(i, k) = l%k_block(j, merge(1, 2, k <= 3))
                     rows%c(i, k) = l%cr(j)*sqrt(rows%k(i, k)*batch%geometry%inertia(j, k))
                     if (iand(batch%law(k), LAW_DAMPER) /= 0) rows%c(i, k) = rows%c(i, k) + &
                        batch%c(j, k)
                  end do
               end associate
            end do
         end associate
      end do
   end subroutine renew_locks

end module kj_consistent_compliant_forces
