!> One step of the integrator `compliant`: RATTLE with compliance. A position stage finds the
!> multipliers f with which the free flow of the bodies ends at q = f/k; a velocity stage, linear,
!> finds those, g, with which the velocities keep to it.
!> Source: docs/theory/compliant.md 2, 3.
!> One file: the two stages of a step.
module kj_consistent_compliant_step
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of
   use kj_consistent_compliance, only: compliance, end_inertias
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: inverse_inertias, spin
   use kj_consistent_leads, only: move_leads, look_leads, kick_leads, no_forces
   use kj_consistent_conditions, only: count_work, FIRST_HALF, SECOND_HALF
   use kj_consistent_motion, only: motion_targets
   use kj_consistent_load, only: add_loads, find_gravity, add_gravity, count_gravity, add_host_loads
   use kj_consistent_step, only: place_nodes, reach_motions
   use kj_consistent_compliant_types, only: compliant_t, compliant_block_t, factor_t, LONG
   use kj_consistent_compliant_rows, only: bound_stiffness, weigh_rows, extrapolate, correct
   use kj_consistent_compliant_matrix, only: assemble, find_responses, solve_all
   use kj_consistent_compliant_forces, only: spring_forces, damper_rows, add_rests, &
      renew_locks
   use kj_consistent_compliant_pass, only: pass_t, over_joints, close_rows, PUSH, SEE, TAKE, &
      ASK, GIVE
   use kj_consistent_compliant_undo, only: copy, keep_leads, restore_leads
   implicit none
   private

   public :: compliant_step, look_ahead, prepare, put_locks, find_worst

   !> with the Kn of the deck, and with infinite ones
   integer, parameter :: MOST_PASSES(2) = [8, 12]
   real(wp), parameter :: GROWTH(2) = [10.0_wp, 100.0_wp]   !! of the residual in a pass: it fails
   real(wp), parameter :: SLOW = 0.5_wp          !! of a change that the next one should stay below
   integer, parameter :: RENEW = 8               !! steps between two looks at the stiffness bound
   real(wp), parameter :: UNLIKE = 1.6_wp        !! ratio of steps that is a jump to the joints
   real(wp), parameter :: FORGET = 0.5_wp        !! of a step, by which a longer one is forgotten
   real(wp), parameter :: CLOSE = 1.0e-3_wp      !! of the error of the step; of forces that show
   !> of forces, the last change in single steps and the parts of pairs: those of the first and the
   !> long one are not shown
   real(wp), parameter :: MOST_CHANGE(0:LONG) = [1.0e-3_wp, 1.0e-2_wp, 1.0e-3_wp, 1.0e-2_wp]
   real(wp), parameter :: LATE = 0.5_wp          !! of the forces of the last step
   real(wp), parameter :: LAST_BITS = 16.0_wp*epsilon(1.0_wp)   !! of coordinates: noise of forces
   real(wp), parameter, public :: LEAST_STEP = 1.0e-100_wp   !! whose square is a number
   real(wp), parameter :: ROUNDING = 1.0e-12_wp  !! of the size of the scene, of a turn

contains

   !> From t to t + h; good is false, and the state that at t, when the position stage does not
   !> converge
   subroutine compliant_step(model, h, state, good)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: good

      logical :: changed

      state%h = h
      associate (self => state%compliant)
         if (max(h, self%h_last) > UNLIKE*min(h, self%h_last) .and. self%part /= LONG) self%jump = 0
      end associate
      call renew_locks(model, state, state%compliant, changed)
      if (changed) call put_locks(state%compliant)
      call motion_targets(model, state, h, state%mean, state%final, state%active)
      call position_stage(model, h, MOST_CHANGE(state%compliant%part), state, good)
      if (.not. good) then
         call restore_leads(state)
         return
      end if
      call reach_motions(model, h, state%mean, state%final, state%active, state)
      state%cycle = state%cycle + 1
      state%time = state%time + h
      state%poses%time = state%time
      associate (start => state%compliant%start, self => state%compliant)
         if (self%part == 0 .or. self%any_damper) then   ! else nobody asks
            call copy(size(state%v), state%v, start%v_half)
            call copy(size(state%v), state%poses%w, start%w_half)
            call copy(size(state%l), state%l, start%l_half)
         end if
      end associate
      call place_nodes(model, state)
      call find_gravity(model, state)
      call spring_forces(model, state, state%compliant)
      call add_gravity(model, 1, model%n_lead, state)
      call count_work(FIRST_HALF, state)
      call count_gravity(model, h, state)
      call add_loads(model, state)
      call add_host_loads(h, state)
      call velocity_stage(model, h, state, good)
      associate (self => state%compliant)
         call close_rows(model, h, state, self)
         self%known = -1
         if (self%part == LONG) return
         self%h_last = h
         self%h_stiff = longest_step(self%h_stiff, h)
         self%jump = self%jump + 1
         self%renewed = self%renewed + 1
      end associate
   end subroutine compliant_step

   !> What hangs on the rows is found anew
   subroutine put_locks(self)
      type(compliant_t), intent(inout) :: self

      self%factored = .false.
      self%renewed = RENEW
      self%jump = 0
      self%known = -1
   end subroutine put_locks

   !> Multipliers f that bring the leads to poses with q = phi q(n) + kappa f, and these poses; what
   !> is known before stands in state%compliant%start
   subroutine position_stage(model, h, settle, state, good)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      real(wp), intent(in) :: settle             !! change of f over the forces, at most
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: good

      type(pass_t) :: push_joints, see_joints, take_solution
      real(wp) :: last, change, force, scale, before
      logical :: settled, close_by
      integer :: pass, kind

      call keep_leads(state)
      state%poses%h = h
      good = h > LEAST_STEP
      if (.not. good) return
      push_joints%what = PUSH
      see_joints%what = SEE
      see_joints%h = h
      take_solution%what = TAKE
      associate (self => state%compliant, left => see_joints%most, part => push_joints%part)
         call prepare(model, h, state%active, state, self, push_joints%guess, good)
         if (.not. good) return
         settled = self%known == state%cycle .and. abs(h - self%h_known) <= 0.0_wp
         last = huge(last)
         before = huge(before)
         scale = max(self%size, tiny(scale))
         kind = merge(2, 1, self%rigid)
         self%left_over = 0.0_wp
         do pass = 0, MOST_PASSES(kind)
            if (pass > 0) call restore_leads(state)
            push_joints%guessed = pass == 0 .and. self%known /= state%cycle
            push_joints%changed = pass > 0
            call over_joints(model, push_joints, state, self)
            call move_leads(model, .false., state%poses%h, 1, model%n_lead, state)
            call no_forces(1, model%n_lead, model%n_lead, state%f, state%t)
            call no_forces(1, model%n_lead, size(state%own_f, 1), state%own_f, state%own_t)
            call over_joints(model, see_joints, state, self)
            good = left(1) <= CLOSE*self%e_way + ROUNDING*scale .and. &
               left(2) <= CLOSE*self%e_turn + ROUNDING
            self%passes = pass
            if (good .and. settled) then
               if (pass > 0) self%force = force
               return
            end if
            close_by = good
            good = .false.
            if (pass == MOST_PASSES(kind) .or. &
               .not. max(left(1)/scale, left(2)) <= GROWTH(kind)*last) exit
            last = max(left(1)/scale, left(2))
            call solve_all(.false., self)
            call over_joints(model, take_solution, state, self)
            associate (largest => take_solution%most)
               force = max(take_solution%force(1), take_solution%force(2)/scale, LATE*self%force)
               settled = largest(1) <= settle*force + LAST_BITS*scale*self%stiffest(1) .and. &
                  largest(2) <= scale*settle*force + LAST_BITS*self%stiffest(2)
               change = max(largest(1), largest(2)/scale)
            end associate
            good = close_by .and. settled        ! what would change is too little for a new pose
            if (good) self%force = force
            self%left_over = merge(1.0_wp, 0.0_wp, good)
            if (good) return
            if (self%rigid .and. pass > 1 .and. change > SLOW*before) then
               part = part*relaxation(model, self)
            else
               part = 1.0_wp
            end if
            before = change
         end do
         call find_worst(model, self)
      end associate
   end subroutine position_stage

   !> Weights of the rows and the factor for a position stage of this step, and those of its guess
   subroutine prepare(model, h, active, state, self, guess, good)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      logical, intent(in) :: active(:)
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self
      real(wp), intent(out) :: guess             !! part of the last rise
      logical, intent(out) :: good

      real(wp) :: stiff
      integer :: b, at, from, n
      logical :: anew, look

      look = (self%renewed >= RENEW .and. self%part <= 1) .or. self%jump == 0
      anew = look .or. abs(h - self%h_factor) > 0.0_wp
      if (anew .or. .not. self%factored) call inverse_inertias(model, state%poses%quat, 1, &
         model%n_lead, state%poses%ij)
      stiff = longest_step(self%h_stiff, h)
      if (self%part == LONG) stiff = 2.0_wp*longest_step(self%h_stiff, 0.5_wp*h)
      guess = 0.0_wp
      if (self%jump >= 2) guess = 0.5_wp*(1.0_wp + h/self%h_last)
      if (anew) self%stiffest = 0.0_wp
      do b = 1, size(model%batch)
         if (.not. (anew .and. self%rowed(b))) cycle
         do at = 1, size(self%joint(b)%block)
            from = BLOCK*(at - 1) + 1
            n = min(BLOCK, model%batch(b)%n - from + 1)
            associate (rows => self%joint(b)%block(at))
               if (look) call find_own(model, b, from, n, state, rows)
               call bound_stiffness(n, self%last(b), stiff, self%gap, self%rigid, rows)
               call weigh_rows(n, self%last(b), h, self%rigid, rows, self%stiffest)
            end associate
         end do
      end do
      good = .true.
      if (look) self%renewed = 0
      if (anew) self%factored = .false.
      ! rigid rows have the weights of the short steps
      if (self%part == LONG .and. self%rigid) then
         call swap(self%first, self%factor)
         self%answered = .false.
      else if (.not. self%factored) then
         call assemble(model, state, active, .false., self, good)
      end if
      if (good .and. .not. self%answered) call find_responses(self)
      self%factored = good
      self%h_factor = h
   end subroutine prepare

   !> B M^-1 B^T of each row of n joints alone
   subroutine find_own(model, b, from, n, state, rows)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b, from, n          !! batch, first joint of a block
      type(consistent_state_t), intent(in) :: state
      type(compliant_block_t), intent(inout) :: rows

      real(wp) :: im(BLOCK, 2), ij1(BLOCK, 6), ij2(BLOCK, 6), s(BLOCK, 21), ends
      integer :: i, k

      call end_inertias(model%batch(b), state%poses, from, n, im, ij1, ij2)
      do i = 1, n
         ends = 1.0_wp/max(1, model%n_end(model%batch(b)%lead(from + i - 1, 1)))
         im(i, 1) = im(i, 1)*ends
         ij1(i, :) = ij1(i, :)*ends
         ends = 1.0_wp/max(1, model%n_end(model%batch(b)%lead(from + i - 1, 2)))
         im(i, 2) = im(i, 2)*ends
         ij2(i, :) = ij2(i, :)*ends
      end do
      call compliance(n, 6, state%joint(b)%block(block_of(from))%b, im, ij1, ij2, s)
      do k = 1, 6
         rows%own(:n, k) = s(:n, k*(k + 1)/2)
      end do
   end subroutine find_own

   !> Two factors change places
   pure subroutine swap(a, b)
      type(factor_t), intent(inout) :: a, b

      real(wp), allocatable :: diagonal(:, :, :), below(:, :, :)

      call move_alloc(a%diagonal, diagonal)
      call move_alloc(a%below, below)
      call move_alloc(b%diagonal, a%diagonal)
      call move_alloc(b%below, a%below)
      call move_alloc(diagonal, b%diagonal)
      call move_alloc(below, b%below)
   end subroutine swap

   !> The longest step of late when h follows
   pure real(wp) function longest_step(longest, h)
      real(wp), intent(in) :: longest, h

      longest_step = max(h, longest - FORGET*h)
   end function longest_step

   !> Part of the last part of a change that is made, by Aitken: where a step leads through a
   !> singular position a change of f acts against what the matrix says. The second change does not
   !> tell: it takes back what redundant forces made of the pose before the first.
   pure real(wp) function relaxation(model, self) result(part)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(in) :: self

      real(wp) :: along, square
      integer :: b, at, n, k

      along = 0.0_wp
      square = 0.0_wp
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do at = 1, size(self%joint(b)%block)
            n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
            associate (rows => self%joint(b)%block(at))
               do k = 1, self%last(b)
                  along = along + sum(rows%asked(:n, k)*(rows%asked(:n, k) - rows%r(:n, k)))
                  square = square + sum((rows%asked(:n, k) - rows%r(:n, k))**2)
               end do
            end associate
         end do
      end do
      part = 1.0_wp
      if (square > 0.0_wp) part = along/square
   end function relaxation

   !> The joint with the largest force that is left over, after a step with the largest that it has
   subroutine find_worst(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      real(wp) :: most, r
      integer :: b, j, at, i

      most = -1.0_wp
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do j = 1, model%batch(b)%n
            at = (j - 1)/BLOCK + 1
            i = modulo(j - 1, BLOCK) + 1
            associate (rows => self%joint(b)%block(at))
               r = maxval(abs(rows%r(i, 1:3)*rows%kappa(i, 1:3)))
               r = max(r, self%size*maxval(abs(rows%r(i, 4:6)*rows%kappa(i, 4:6))))
            end associate
            if (r <= most) cycle
            most = r
            self%joint_worst = model%batch(b)%first + j
         end do
      end do
   end subroutine find_worst

   !> Multipliers g with which the velocities after the second half kick keep to the rows, that
   !> kick, and the estimate of the error of the step. state%f and state%t are those of explicit
   !> forces, and are so again afterwards.
   subroutine velocity_stage(model, h, state, good)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: good

      type(pass_t) :: pass
      logical :: any_rest

      call copy(size(state%f), state%f, state%compliant%f)
      call copy(size(state%t), state%t, state%compliant%t)
      call look_leads(model, state%poses%h, 1, model%n_lead, state)
      associate (self => state%compliant)
         if (self%any_damper) then
            call damper_rows(model, h, state, self, any_rest)
            if (any_rest) then
               call add_rests(model, state, self)
               call look_leads(model, state%poses%h, 1, model%n_lead, state)
               call copy(size(self%f), self%f, state%f)
               call copy(size(self%t), self%t, state%t)
            end if
         end if
         if (self%part == 1 .and. self%rigid) call swap(self%first, self%factor)
         call assemble(model, state, state%active, .true., self, good)
         self%factored = .not. self%apart
         pass%what = ASK
         pass%h = h
         pass%part = self%left_over
         pass%shift = self%part /= LONG
         call over_joints(model, pass, state, self)
         call solve_all(.true., self)
         pass%what = GIVE
         call over_joints(model, pass, state, self)
         call kick_leads(model, state%poses%h, 1, model%n_lead, state)
         call count_work(SECOND_HALF, state)
         call copy(size(self%f), self%f, state%f)
         call copy(size(self%t), self%t, state%t)
         if (self%part == 0) call estimate_error(model, h, state, self)
      end associate
   end subroutine velocity_stage

   !> h/6 |v1 - 2 v+ + v(n)|, and h/6 |J^-1 (L1 - L+) - J(n)^-1 (L+ - L(n))|; the largest of the
   !> bodies. Each change of L with the inertia of its own pose: a thin rod turns L away from where
   !> it is stiff.
   subroutine estimate_error(model, h, state, self)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self

      real(wp) :: most(2), way, turn
      integer :: from, i, k, n

      most = 0.0_wp
      do from = 1, model%n_lead, BLOCK
         n = min(BLOCK, model%n_lead - from + 1)
         do k = 1, 3
            !$omp simd
            do i = from, from + n - 1
               self%turn(i, k) = state%l(i, k) - self%start%l_half(i, k)
               self%t(i, k) = self%start%l_half(i, k) - self%start%l(i, k)
            end do
         end do
         call spin(n, from, model, state%poses%quat, self%turn, self%y)
         call spin(n, from, model, self%start%quat, self%t, self%f)
         do i = from, from + n - 1
            if (.not. (model%inverse_mass(i) > 0.0_wp .or. &
               model%inverse_inertia(i, 1) > 0.0_wp)) cycle
            way = 0.0_wp
            turn = 0.0_wp
            do k = 1, 3
               way = way + (state%v(i, k) - 2.0_wp*self%start%v_half(i, k) + &
                  self%start%v(i, k))**2
               turn = turn + (self%y(i, k) - self%f(i, k))**2
            end do
            most = max(most, [way, turn])
         end do
      end do
      self%e_way = h/6.0_wp*sqrt(most(1))
      self%e_turn = h/6.0_wp*sqrt(most(2))
   end subroutine estimate_error

   !> Multipliers f of the step that would follow, for the forces of the present time; the state
   !> stays
   subroutine look_ahead(model, h, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      logical :: good

      if (state%compliant%known == state%cycle) return
      call motion_targets(model, state, h, state%mean, state%final, state%active)
      call position_stage(model, h, CLOSE, state, good)
      call restore_leads(state)
      if (.not. good) then
         call forget_guess(model, state%compliant)
         return
      end if
      call add_left_over(model, state%compliant)
      state%compliant%known = state%cycle
      state%compliant%h_known = h
   end subroutine look_ahead

   !> Multipliers of a position stage with the change that was too little for a new pose
   pure subroutine add_left_over(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      integer :: b, at

      do b = 1, size(model%batch)
         do at = 1, merge(size(self%joint(b)%block), 0, self%rowed(b))
            call correct(min(BLOCK, model%batch(b)%n - BLOCK*(at - 1)), self%last(b), &
               self%left_over, self%joint(b)%block(at))
         end do
      end do
   end subroutine add_left_over

   !> Multipliers that did not converge may be no numbers: those of the last step instead
   pure subroutine forget_guess(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      integer :: b, at

      do b = 1, size(model%batch)
         do at = 1, size(self%joint(b)%block)
            call extrapolate(min(BLOCK, model%batch(b)%n - BLOCK*(at - 1)), &
               self%last(b), 0.0_wp, &
               self%joint(b)%block(at))
         end do
      end do
   end subroutine forget_guess

end module kj_consistent_compliant_step
