!> Steps of the integrator `compliant`: as long as the error, the turn of the bodies, explicit
!> springs, stops and events allow.
!> Source: docs/theory/compliant.md 3, 6.
!> One file: all that decides on the length of a step.
module kj_consistent_compliant_march
   use kj_kinds, only: wp
   use kj_joint_batch, only: is_hardened
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: spin_velocity
   use kj_consistent_safe_step, only: bound_t, new_bound, renew_bound, has_moved
   use kj_consistent_compliant_types, only: compliant_t
   use kj_consistent_compliant_step, only: compliant_step, find_worst, LEAST_STEP
   use kj_consistent_compliant_build, only: new_compliant
   use kj_consistent_compliant_start, only: start_velocities
   use kj_consistent_compliant_forces, only: locks_turn
   use kj_consistent_compliant_stops, only: stop_step
   use kj_consistent_compliant_pair, only: pair_step, SOLVES
   use kj_consistent_compliant_undo, only: keep_all, undo_step, has_moved_on, BEFORE
   implicit none
   private

   public :: pace_t, start_pace, march_compliant, next_solve, solves_a_step

   integer, parameter :: LOOK = 4                !! steps between two looks at the error
   integer, parameter :: MOST_HALVINGS = 6
   integer, parameter :: MOST_TRIES = 12
   integer, parameter :: FIRST_TRIES = 60        !! of the first steps: half a step each
   real(wp), parameter :: ROUNDING = 1.0e-12_wp  !! error that no shorter step makes less
   integer, parameter :: FREE_STEPS = 2          !! after a start or jump: error not counted
   !> of the sum of errors of single steps: what a step does to velocities shifts all that follow
   real(wp), parameter :: LATER = 2.0_wp
   real(wp), parameter :: TOO_LARGE = 4.0_wp     !! error of a step over the allowed: taken back
   real(wp), parameter :: LEAST_PART = 0.25_wp   !! of the error of a mean step: may always be
   real(wp), parameter :: BOUND_PART = 0.5_wp    !! of the safe bound of explicit springs
   real(wp), parameter :: START_PART = 0.02_wp   !! of the run, first steps at most: what gives way
   real(wp), parameter :: CRAWL = 1.0e-8_wp      !! of the longest step: no motion asks for that
   integer, parameter :: MOST_CRAWLED = 1000     !! steps in a row
   real(wp), parameter :: USUAL = 1.0e-3_wp      !! at once is no error; less below this tolerance

   ! Steps of fourth order
   real(wp), parameter :: SHARE = 30.0_wp        !! CLOSE of it: of the allowed error, in a pass
   real(wp), parameter :: MOST_TOLERANCE = 0.1_wp   !! above it the error is none of the business
   real(wp), parameter :: FADE = 0.7_wp          !! of the largest error of late, in a step
   real(wp), parameter :: DOUBT = 0.8_wp         !! of solves, below which the order changes
   real(wp), parameter, public :: WIDER = 4.5_wp !! turn of a long step: its error is seen

   !> Step control
   type :: pace_t
      logical :: rigid = .false.                 !! Kn = infinity
      real(wp) :: tolerance = 1.0e-3_wp          !! error of the run over the size of the scene
      real(wp) :: turn = 0.1_wp                  !! largest turn a step [rad]
      real(wp) :: factor = BOUND_PART            !! of the bound
      real(wp) :: most = huge(1.0_wp)            !! largest step of the deck
      real(wp) :: first = huge(1.0_wp)           !! largest first step of the deck
      real(wp) :: h_error = huge(1.0_wp)         !! step that the error allows
      real(wp) :: h_turn = huge(1.0_wp)          !! by the turn rule
      real(wp) :: h_bound = huge(1.0_wp)         !! by explicit springs
      real(wp) :: h_stop = huge(1.0_wp)          !! by stops and friction
      logical :: limited = .false.               !! there are some
      logical :: able = .false.                  !! pairs of steps are possible
      logical :: paired = .false.                !! steps are taken as pairs, of fourth order
      real(wp) :: wrong(2) = 0.0_wp              !! of the last pair: way, turn
      real(wp) :: c = 0.0_wp                     !! error of a step over its cube, of late
      real(wp) :: limit = huge(1.0_wp)           !! least of them
      integer :: owner = 0                       !! joint that holds it, index among all
      real(wp) :: span = 0.0_wp                  !! time that the error is spread over
      real(wp), allocatable :: event(:)          !! times that steps end on, ascending
      real(wp) :: target = -1.0_wp               !! time that equal steps lead to
      real(wp) :: h = 0.0_wp
      integer :: left = 0                        !! of these steps
      integer :: since = 0                       !! steps since the last look
      real(wp) :: drift = 0.0_wp                 !! sum of errors over the allowed since then
      integer :: failed = 0                      !! halvings in a row
      real(wp) :: longest = 0.0_wp               !! step so far
      integer :: crawled = 0                     !! steps in a row that were next to nothing of it
      integer :: tries = 0                       !! of a step, after the first
      integer :: passes = 0, halvings = 0, rejected = 0   !! of the run
      type(bound_t) :: bound
   end type pace_t

contains

   !> Rows, first limits, and velocities that the joints allow
   subroutine start_pace(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(pace_t), intent(inout) :: self

      real(wp) :: loss, kinetic
      logical :: late
      integer :: b

      loss = 0.0_wp
      kinetic = 0.0_wp
      if (state%cycle > 0 .and. allocated(state%compliant)) then
         loss = state%compliant%loss
         kinetic = state%compliant%kinetic
      end if
      call new_compliant(model, self%rigid, state)
      call new_bound(model, .false., state, self%bound)
      self%h_bound = self%factor*min(self%bound%h, 1.0e30_wp)
      self%span = model%control%t_stop - state%time
      if (.not. self%span > 0.0_wp) self%span = 1.0_wp
      self%h_error = START_PART*self%span*min(1.0_wp, sqrt(self%tolerance/USUAL))
      self%limited = any(model%batch%limited)
      self%able = self%tolerance < MOST_TOLERANCE .and. .not. self%limited
      do b = 1, size(model%batch)
         self%able = self%able .and. .not. is_hardened(model%batch(b))
      end do
      self%paired = self%able
      if (self%able) self%h_error = START_PART*self%span* &
         min(1.0_wp, sqrt(sqrt(self%tolerance/USUAL)))
      call list_events(model, self)
      self%left = 0
      self%since = 0
      self%drift = 0.0_wp
      self%failed = 0
      call take_limit(model, state, self)
      self%h = min(self%limit, self%first, self%span)
      if (model%control%sample > 0.0_wp) self%h = min(self%h, model%control%sample)
      call start_velocities(model, max(self%h, LEAST_STEP), state)
      if (state%cycle > 0) then
         state%compliant%loss = loss
         state%compliant%kinetic = kinetic
      end if
      state%compliant%least_scale = max(state%compliant%kinetic, &
         self%tolerance*state%compliant%size*sum(norm2(state%f, dim=2)))
      call take_limit(model, state, self)
      if (.not. self%able) call try_first_steps(model, state, self)
      if (self%limited) call look_at_stops(model, state, self, late)
   end subroutine start_pace

   !> The error of the first steps does not tell by itself, nor can they be taken back: they are as
   !> long as one on a copy of the scene whose error does, and is small enough
   subroutine try_first_steps(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(pace_t), intent(inout) :: self

      type(consistent_state_t) :: copy
      real(wp) :: h, change
      logical :: good
      integer :: try, i

      do try = 1, FIRST_TRIES
         h = min(self%limit, self%first, (next_target(state%time + self%span, state%time, self) - &
            state%time)/(FREE_STEPS + 1))
         if (model%control%sample > 0.0_wp) h = min(h, model%control%sample)
         copy = state
         do i = 0, FREE_STEPS
            call expect_error(h, self, copy%compliant)
            call compliant_step(model, h, copy, good)
            if (.not. good) exit
         end do
         change = 0.5_wp
         if (good) change = 0.9_wp*sqrt(allowed_error(state, h, self)/ &
            max(error_of(self, copy%compliant), tiny(h)))
         if (change > 0.9_wp) return
         self%h_error = change*h
         self%limit = min(self%limit, self%h_error)
      end do
   end subroutine try_first_steps

   !> What a step is held against that follows none: the error that it may have
   pure subroutine expect_error(h, self, c)
      real(wp), intent(in) :: h
      type(pace_t), intent(in) :: self
      type(compliant_t), intent(inout) :: c

      if (c%e_way <= 0.0_wp) c%e_way = self%tolerance*c%size*h/self%span
      if (c%e_turn <= 0.0_wp) c%e_turn = self%tolerance*h/self%span
   end subroutine expect_error

   !> Times at which something begins or ends
   subroutine list_events(model, self)
      type(consistent_model_t), intent(in) :: model
      type(pace_t), intent(inout) :: self

      real(wp), allocatable :: t(:)
      real(wp) :: now
      integer :: b, i, k

      t = [model%motion%t_start, model%motion%t_stop, model%motion%t_sensor, &
         model%cload%t_start, model%cload%t_stop, model%gravity%t_start, model%gravity%t_stop]
      do b = 1, size(model%batch)
         if (model%batch(b)%limited) t = [t, model%batch(b)%limit%t_lock, &
            model%batch(b)%limit%t_free]
      end do
      t = pack(t, t > 0.0_wp .and. t < 1.0e29_wp)
      do i = 2, size(t)                          ! few
         now = t(i)
         do k = i - 1, 1, -1
            if (t(k) <= now) exit
            t(k + 1) = t(k)
         end do
         t(k + 1) = now
      end do
      self%event = t
   end subroutine list_events

   !> The longest step now
   subroutine take_limit(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(pace_t), intent(inout) :: self

      real(wp) :: fastest
      integer :: i

      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      fastest = 0.0_wp
      do i = 1, model%n_lead
         if (.not. maxval(model%inverse_inertia(i, :)) > 0.0_wp) cycle
         fastest = max(fastest, sum(state%poses%w(i, :)**2), &
            sum(state%l(i, :)**2)*model%inverse_inertia(i, 2)**2)
      end do
      self%h_turn = huge(1.0_wp)
      if (fastest > 0.0_wp) self%h_turn = merge(WIDER, 1.0_wp, self%paired)*self%turn/sqrt(fastest)
      if (self%bound%h < huge(1.0_wp)) then
         if (has_moved(model, state, self%bound)) then
            call renew_bound(model, state, self%bound)
            self%h_bound = self%factor*min(self%bound%h, 1.0e30_wp)
         end if
      end if
      self%limit = min(self%h_error, self%h_turn, self%h_bound, self%most)
      self%owner = 0
      if (self%h_bound <= self%limit) self%owner = self%bound%joint
   end subroutine take_limit

   !> Steps towards t_end, at most `steps` of them; arrived: t_end is reached. A run that no step
   !> brings further is marked in state%compliant%failed.
   subroutine march_compliant(model, t_end, steps, self, state, arrived)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: t_end
      integer, intent(in) :: steps
      type(pace_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: arrived

      real(wp) :: target, allowed
      logical :: good
      integer :: i, passes

      arrived = .not. t_end > state%time
      if (arrived) return
      do i = 1, steps
         target = next_target(t_end, state%time, self)
         if (self%left == 0 .or. abs(target - self%target) > 0.0_wp) &
            call divide(target, state, self)
         if (self%paired) then
            allowed = SHARE*self%tolerance*self%h/self%span
            call pair_step(model, self%h, allowed*state%compliant%size, allowed, state, good, &
               self%wrong(1), self%wrong(2), passes)
            self%passes = self%passes + passes
         else
            call expect_error(self%h, self, state%compliant)
            call keep_all(model, BEFORE, state)
            call compliant_step(model, self%h, state, good)
            self%passes = self%passes + state%compliant%passes
         end if
         if (.not. good) then
            if (has_moved_on(state)) call undo_step(model, state)
            self%halvings = self%halvings + 1
            self%failed = self%failed + 1
            state%compliant%failed = self%failed > MOST_HALVINGS
            if (state%compliant%failed) return
            self%h_error = 0.5_wp*self%h
            self%limit = min(self%limit, self%h_error)
            call divide(target, state, self)
            self%since = 0
            self%drift = 0.0_wp
            cycle
         end if
         self%failed = 0
         good = self%tries == MOST_TRIES
         if (.not. good) good = .not. is_wrong(model, state, self)
         if (.not. good) then
            self%tries = self%tries + 1
            call undo_step(model, state)
            self%rejected = self%rejected + 1
            call divide(target, state, self)
            cycle
         end if
         self%tries = 0
         self%longest = max(self%longest, self%h)
         self%crawled = merge(self%crawled + 1, 0, self%h_error < CRAWL*self%longest)
         if (self%crawled > MOST_CRAWLED) then
            call find_worst(model, state%compliant)
            state%compliant%failed = .true.
            return
         end if
         self%left = self%left - 1
         if (self%left == 0) state%time = self%target
         call watch(model, state, self)
         if (self%limited .and. self%left == 0) then
            if (locks_turn(model, state)) call start_velocities(model, self%h, state)
         end if
         arrived = .not. t_end > state%time
         if (arrived) return
      end do
   end subroutine march_compliant

   !> The end of the march or the next event
   pure real(wp) function next_target(t_end, time, self) result(target)
      real(wp), intent(in) :: t_end, time
      type(pace_t), intent(in) :: self

      integer :: i

      target = t_end
      do i = 1, size(self%event)
         if (self%event(i) <= time*(1.0_wp + 1.0e-9_wp)) cycle
         if (self%event(i) < t_end*(1.0_wp - 1.0e-9_wp)) target = self%event(i)
         return
      end do
   end function next_target

   !> Equal steps to a time
   pure subroutine divide(target, state, self)
      real(wp), intent(in) :: target
      type(consistent_state_t), intent(in) :: state
      type(pace_t), intent(inout) :: self

      real(wp) :: limit, h

      limit = min(self%limit, self%h_stop)
      if (state%cycle == 0) limit = min(limit, self%first)
      self%target = target
      self%left = max(1, ceiling(min((target - state%time)/limit, 1.0e9_wp) - 1.0e-6_wp))
      h = (target - state%time)/self%left
      ! the same bits for the same step: its matrix is still there
      if (abs(h - self%h) > 1.0e-12_wp*h) self%h = h
   end subroutine divide

   !> Steps that stops and friction ask for; late: the last step met a stop and was too long
   subroutine look_at_stops(model, state, self, late)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(pace_t), intent(inout) :: self
      logical, intent(out) :: late

      real(wp) :: before

      before = self%h_stop
      call stop_step(model, state, self%limit, self%h_stop, late)
      if (self%left > 0 .and. (self%h_stop < self%h*(1.0_wp - 1.0e-9_wp) .or. &
         self%h_stop > 1.2_wp*before)) call divide(self%target, state, self)
   end subroutine look_at_stops

   !> The step that was taken has a far too large error, or met a stop unawares: a shorter one is
   !> wanted, and set
   logical function is_wrong(model, state, self) result(wrong)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(pace_t), intent(inout) :: self

      real(wp) :: e, allowed, step
      logical :: late

      wrong = .false.
      associate (c => state%compliant)
         if (c%jump > FREE_STEPS .or. self%paired) then
            e = error_of(self, c)
            allowed = allowed_error(state, self%h, self)
            if (e > TOO_LARGE*allowed) then
               wrong = .true.
               self%h_error = max(0.3_wp, 0.9_wp*(allowed/e)**power(self))*self%h
               self%limit = min(self%limit, self%h_error)
               self%since = 0
               self%drift = 0.0_wp
            end if
         end if
      end associate
      if (wrong .or. .not. self%limited) return
      call stop_step(model, state, self%h, step, late)
      if (.not. late) return
      wrong = .true.
      self%h_stop = max(step, 0.25_wp*self%h)
   end function is_wrong

   !> Error that a step h may have. Its part of the run, or a part of what the steps so far had on
   !> average, which sums to no more than a logarithm of their number: what shakes by itself where a
   !> mechanism is singular is as wrong per time in shorter steps.
   pure real(wp) function allowed_error(state, h, self) result(e)
      type(consistent_state_t), intent(in) :: state
      real(wp), intent(in) :: h
      type(pace_t), intent(in) :: self

      e = self%tolerance/self%span*max(h, LEAST_PART*solves_a_step(self)*state%time/ &
         max(1, state%cycle))
      e = max(e, merge(error_of_pair(ROUNDING), ROUNDING, self%paired))
   end function allowed_error

   !> Estimated error of the last step, of the size of the scene or in rad. That of a pair: the
   !> error of its long step is (h/tau)**3, what is left (h/tau)**5.
   pure real(wp) function error_of(self, c) result(e)
      type(pace_t), intent(in) :: self
      type(compliant_t), intent(in) :: c

      if (self%paired) then
         e = self%wrong(2)
         if (c%size > 0.0_wp) e = max(e, self%wrong(1)/c%size)
         e = error_of_pair(e)
      else
         e = c%e_turn
         if (c%size > 0.0_wp) e = max(e, c%e_way/c%size)
         e = LATER*e
      end if
   end function error_of

   !> What is left of the error d of the long step: (h/tau)**3, (h/tau)**5
   pure real(wp) function error_of_pair(d) result(e)
      real(wp), intent(in) :: d

      e = d**(5.0_wp/3.0_wp)
   end function error_of_pair

   !> The order that takes fewer solves. The error of a short step is c h**3 by the last steps.
   subroutine choose_order(model, allowed, size, self)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: allowed            !! error per time
      real(wp), intent(in) :: size
      type(pace_t), intent(inout) :: self

      real(wp) :: c, h(2), turn, interval, work(2)

      if (self%paired) then
         c = self%wrong(2)
         if (size > 0.0_wp) c = max(c, self%wrong(1)/size)
         c = LATER*4.0_wp/3.0_wp*c/self%h**3
      else
         c = self%drift/self%since*allowed/self%h**2
      end if
      c = max(c, FADE*self%c, tiny(c))
      self%c = c
      turn = self%h_turn/merge(WIDER, 1.0_wp, self%paired)
      h(1) = min(0.9_wp*sqrt(allowed/c), turn)
      h(2) = min(0.9_wp*(allowed/error_of_pair(0.75_wp/LATER*c))**0.25_wp, WIDER*turn)
      h = min(h, self%h_bound, self%most)
      interval = model%control%sample
      if (.not. interval > 0.0_wp) interval = self%span
      work = [1, SOLVES]*ceiling(min(interval/h, 1.0e9_wp))
      if (self%paired .eqv. work(2) <= merge(1.0_wp, DOUBT, self%paired)*work(1)) return
      self%paired = .not. self%paired
      self%h_error = min(h(merge(2, 1, self%paired)), merge(3.0_wp, 0.75_wp, self%paired)*self%h)
   end subroutine choose_order

   !> Cycles that the next step counts as
   pure integer function solves_a_step(self)
      type(pace_t), intent(in) :: self

      solves_a_step = merge(SOLVES, 1, self%paired)
   end function solves_a_step

   !> By which power of the error over the allowed a step is shorter
   pure real(wp) function power(self)
      type(pace_t), intent(in) :: self

      power = merge(0.25_wp, 0.5_wp, self%paired)
   end function power

   !> The step of the next position stage
   pure real(wp) function next_solve(self) result(h)
      type(pace_t), intent(in) :: self

      h = merge(0.5_wp, 1.0_wp, self%paired)*self%h
   end function next_solve

   !> After a step: are the next ones as long?
   subroutine watch(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(pace_t), intent(inout) :: self

      real(wp) :: change, before, allowed
      logical :: late, was

      if (self%limited) call look_at_stops(model, state, self, late)
      if (state%compliant%jump <= FREE_STEPS .and. .not. self%paired) then
         self%drift = 0.0_wp
         return
      end if
      allowed = allowed_error(state, self%h, self)
      self%since = self%since + 1
      self%drift = self%drift + error_of(self, state%compliant)/allowed
      if (self%since < merge(1, LOOK, self%paired)) return
      before = self%limit
      was = self%paired
      if (self%able) call choose_order(model, allowed/self%h, state%compliant%size, self)
      if (was .eqv. self%paired) then
         change = 0.9_wp*(self%since/max(self%drift, tiny(change)))**power(self)
         change = max(0.3_wp, min(2.0_wp, change))
         if (change < 0.8_wp .or. change > 1.2_wp) self%h_error = change*min(self%h, self%h_error)
      end if
      self%since = 0
      self%drift = 0.0_wp
      call take_limit(model, state, self)
      if (self%left > 0 .and. (self%limit < self%h*(1.0_wp - 1.0e-9_wp) .or. &
         self%limit > 1.2_wp*before .or. (was .neqv. self%paired))) &
         call divide(self%target, state, self)
   end subroutine watch

end module kj_consistent_compliant_march
