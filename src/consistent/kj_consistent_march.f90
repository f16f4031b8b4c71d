!> The march of a consistent run: equal steps up to a wanted time, none longer than the limit, which
!> is found anew as the scene moves; and the ledger of energy.
!> Source: docs/theory/time_step.md 9; the ledger: docs/theory/consistent.md 13.
!> One file: the limit, the steps and the ledger are changed together.
module kj_consistent_march
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_skew, only: axis_of
   use kj_joint_batch, only: LAW_SPRING, LAW_SPRING_CURVE, LAW_HARDENED, joint_batch_t
   use kj_joint_types, only: CHART_VECTOR
   use kj_model, only: model_t, joint_title, STOP_BELOW
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_block, only: BLOCK, block_of, lane_of
   use kj_consistent_chart, only: quaternion_frame
   use kj_consistent_body, only: spin_velocity
   use kj_consistent_conditions, only: held_force
   use kj_consistent_safe_step, only: bound_t, new_bound, renew_bound, has_moved
   use kj_consistent_nodal_step, only: nodal_bound
   use kj_consistent_impact_step, only: contact_t, watch_stops, no_stops
   use kj_consistent_load, only: field_at
   use kj_consistent_step, only: split_step
   use kj_consistent_rkmk, only: rkmk_step
   use kj_consistent_compliant_march, only: pace_t, start_pace, march_compliant
   implicit none
   private

   public :: march_t, start_march, march, is_too_short, change_limits, balance_ledger, &
      close_ledger, check_state
   public :: set_out, spell, count_steps, is_calm, look_ahead, arrive

   integer, parameter, public :: SPLIT2 = 1, LIEMID = 2, RKMK4 = 3, &
      COMPLIANT = 4                               !! integrators
   integer, parameter, public :: LOOK = 8        !! steps between two looks at the bound
   real(wp), parameter, public :: NEVER = huge(1.0_wp)   !! a time to march to
   ! sums over leads do not depend on threads: parts of SUMMED leads, WINDOW of them at a time
   integer, parameter :: SUMMED = 64, WINDOW = 64

   ! Joints that start with a jump ring, and near the limit ten times as far as they should, at the
   ! cost of the energy. So a run starts with shorter steps until the ringing has died down.
   real(wp), parameter :: START_PART = 1.0_wp/3.0_wp   !! of the step
   real(wp), parameter :: START_SPAN = 100.0_wp        !! for so many times the limit

   !> Where the march stands
   type :: march_t
      integer :: integrator = SPLIT2
      logical :: nodal = .false.                 !! nodal rule instead of the safe bound
      real(wp) :: factor = 0.9_wp                !! of the limit
      real(wp) :: most = huge(1.0_wp)            !! largest step allowed by the deck
      real(wp) :: first = huge(1.0_wp)           !! largest first step allowed by the deck
      real(wp) :: limit = huge(1.0_wp)           !! longest step now
      real(wp) :: start_end = 0.0_wp             !! time until which steps are shorter
      logical :: starting = .false.              !! limit is still the shorter one
      integer :: joint = 0                       !! who holds it, index among all joints
      type(bound_t) :: bound
      type(contact_t) :: contact                 !! stops that are met
      type(pace_t) :: pace                       !! of the integrator compliant
      ! steps to the time that is marched to; none left: to be found
      real(wp) :: t_end = 0.0_wp
      real(wp) :: h = 0.0_wp
      integer :: left = 0
      integer :: since = 0                       !! steps since the last look at the bound
      integer :: age = 0                         !! steps since it was found at a time marched to
   end type march_t

contains

   !> Find the first limit, and the ledger at the start
   subroutine start_march(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: self

      state%by_steps = self%integrator /= RKMK4
      self%left = 0
      self%age = 0
      self%start_end = state%time
      if (self%integrator == COMPLIANT) then
         self%pace%most = self%most
         self%pace%first = self%first
         self%pace%factor = min(self%factor, self%pace%factor)
         call start_pace(model, state, self%pace)
         self%limit = min(self%pace%limit, self%most)
         self%joint = self%pace%owner
         return
      end if
      call new_bound(model, .not. state%by_steps, state, self%bound)
      call take_limit(model, state, self)
      if (self%limit >= self%most .or. self%integrator == RKMK4) return
      self%start_end = state%time + START_SPAN*self%limit/self%factor
      call take_limit(model, state, self)
   end subroutine start_march

   !> Other limits of the steps from now on
   subroutine change_limits(model, factor, most, state, self)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: factor, most
      type(consistent_state_t), intent(in) :: state
      type(march_t), intent(inout) :: self

      if (abs(factor - self%factor) <= 0.0_wp .and. abs(most - self%most) <= 0.0_wp) return
      self%factor = factor
      self%most = most
      self%left = 0
      if (self%integrator == COMPLIANT) then
         self%pace%most = most
         self%pace%left = 0
         self%pace%limit = min(self%pace%limit, most)
         self%limit = self%pace%limit
         return
      end if
      call take_limit(model, state, self)
   end subroutine change_limits

   !> The longest step now: factor of the limit, less at the start, or what the deck allows
   subroutine take_limit(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(march_t), intent(inout) :: self

      real(wp) :: h

      h = self%bound%h
      if (self%nodal) call nodal_bound(model, state, h)
      self%limit = self%most
      self%joint = 0
      self%starting = state%time < self%start_end
      if (h > self%most/self%factor) return
      self%limit = h*self%factor
      if (self%starting) self%limit = START_PART*self%limit
      if (.not. self%nodal) self%joint = self%bound%joint
   end subroutine take_limit

   !> Whether the longest step, without what is taken off at the start, is below the least of
   !> /DT/NODA/STOP
   pure logical function is_too_short(model, self)
      type(model_t), intent(in) :: model
      type(march_t), intent(in) :: self

      is_too_short = model%control%below_min == STOP_BELOW .and. &
         self%limit < merge(START_PART, 1.0_wp, self%starting)*model%control%dt_min
   end function is_too_short

   !> Steps towards t_end, at most `steps` of them, or until they are too short; arrived: t_end is
   !> reached. The next call with the same t_end goes on as if it were the same one. t_end =
   !> NEVER: steps have full length.
   subroutine march(model, t_end, steps, self, state, arrived)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: t_end
      integer, intent(in) :: steps
      type(march_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: arrived

      integer :: left, now

      arrived = .not. t_end > state%time
      if (arrived) return
      if (self%integrator == COMPLIANT) then
         call march_compliant(model, t_end, steps, self%pace, state, arrived)
         self%limit = self%pace%limit
         self%joint = self%pace%owner
         return
      end if
      left = steps
      call set_out(model, t_end, left, self, state)
      do while (left > 0)
         now = spell(self, left)
         call take_steps(model, self%integrator, self%h, now, state)
         call count_steps(now, left, self, arrived)
         if (arrived) exit
         if (self%since == LOOK) call look_ahead(model, self, state)
         if (is_too_short(model%model_t, self)) exit
      end do
      if (arrived) call arrive(model, self, state)
   end subroutine march

   !> Begin a way to t_end, or go on with it
   subroutine set_out(model, t_end, left, self, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: t_end
      integer, intent(inout) :: left             !! steps that may be taken
      type(march_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state

      if (self%left > 0 .and. abs(t_end - self%t_end) <= 0.0_wp) return
      if (state%cycle == 0 .and. self%first < min(self%limit, t_end - state%time)) then
         call change_step(model, self%first, state)
         call take_steps(model, self%integrator, self%first, 1, state)
         left = left - 1
      end if
      self%t_end = t_end
      self%since = 0
      call watch_stops(model, state, self%limit, LOOK, self%contact)
      call divide_way(model, self, state)
   end subroutine set_out

   !> Steps of self%h until something is to be looked at
   pure integer function spell(self, left) result(n)
      type(march_t), intent(in) :: self
      integer, intent(in) :: left                !! steps that may be taken

      n = min(left, self%left, LOOK - self%since)
   end function spell

   !> So many steps are taken; arrived: the way is done
   pure subroutine count_steps(n, left, self, arrived)
      integer, intent(in) :: n
      integer, intent(inout) :: left
      type(march_t), intent(inout) :: self
      logical, intent(out) :: arrived

      left = left - n
      if (self%t_end < NEVER) self%left = self%left - n
      self%since = self%since + n
      self%age = self%age + n
      arrived = self%left == 0
   end subroutine count_steps

   !> At the end of the way: a new limit for the next one
   subroutine arrive(model, self, state)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state

      state%time = self%t_end
      if (self%age < LOOK) return
      self%age = 0
      call renew_bound(model, state, self%bound)
      call take_limit(model, state, self)
   end subroutine arrive

   !> look_ahead would change nothing; of the state it reads time, coordinates and rates of joints
   !> and the axes of springs
   pure logical function is_calm(model, self, state) result(calm)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(in) :: self
      type(consistent_state_t), intent(in) :: state

      calm = .not. (self%starting .and. state%time >= self%start_end)
      if (calm) calm = no_stops(model, state, self%limit, LOOK, self%contact)
      if (calm) calm = .not. has_moved(model, state, self%bound)
   end function is_calm

   !> Do the steps still hold where the scene is now?
   subroutine look_ahead(model, self, state)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: contact_h
      logical :: renew

      self%since = 0
      renew = has_moved(model, state, self%bound) .or. &
         (self%starting .and. state%time >= self%start_end)
      contact_h = self%contact%h
      call watch_stops(model, state, self%limit, LOOK, self%contact)
      if (.not. renew .and. abs(self%contact%h - contact_h) <= 0.0_wp) return
      if (renew) call renew_bound(model, state, self%bound)
      if (renew) call take_limit(model, state, self)
      call divide_way(model, self, state)
   end subroutine look_ahead

   !> Equal steps to where the march goes, full ones where it does not end
   subroutine divide_way(model, self, state)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state

      self%h = min(self%limit, self%contact%h)
      self%left = huge(self%left)
      if (self%t_end < NEVER) then
         self%left = needed_steps(self%t_end - state%time, self%h)
         self%h = (self%t_end - state%time)/self%left
      end if
      call change_step(model, self%h, state)
   end subroutine divide_way

   !> n steps of h
   subroutine take_steps(model, integrator, h, n, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: integrator
      real(wp), intent(in) :: h
      integer, intent(in) :: n
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      do i = 1, n
         if (integrator == RKMK4) then
            call rkmk_step(model, h, state)
         else
            call split_step(model, integrator == LIEMID, h, state)
         end if
      end do
   end subroutine take_steps

   !> The state is still where the formulation holds.
   !>
   !> Errors: ERR_RUN when it is not finite, or a joint has come to a whole turn.
   subroutine check_state(model, state, error)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error

      character(len=12) :: buffer
      integer :: j, at

      ! counted, as gfortran takes all() one by one
      if (count(abs(state%v) <= huge(1.0_wp)) < size(state%v) .or. &
         count(abs(state%l) <= huge(1.0_wp)) < size(state%l)) then
         call fail(error, ERR_RUN, 'the solution is not finite any more in cycle '// &
            str(state%cycle))
         return
      end if
      if (allocated(state%compliant)) then
         if (state%compliant%failed) then
            write (buffer, '(es12.5)') state%time
            call fail(error, ERR_RUN, 'joint '// &
               str(id_of(model, state%compliant%joint_worst))//' does not converge at t = '// &
               trim(adjustl(buffer))//' (cycle '//str(state%cycle)//')')
            return
         end if
      end if
      at = full_turn(model, state)
      if (at == 0) return
      do j = 1, model%n_element
         if (model%batch(model%joint(j)%batch)%first + model%joint(j)%place /= at) cycle
         call fail(error, ERR_RUN, 'joint '//joint_title(model%model_t, j)// &
            ' has come to a whole turn: '// &
            'three free rotations with springs or a length end there (cycle '// &
            str(state%cycle)//')')
      end do
   end subroutine check_state

   !> User id of a joint, by its index among all
   pure integer function id_of(model, at) result(id)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: at

      integer :: j

      id = 0
      do j = 1, model%n_element
         if (model%batch(model%joint(j)%batch)%first + model%joint(j)%place == at) &
            id = model%joint(j)%id
      end do
   end function id_of

   !> A joint (index among all) whose three free rotations come to a whole turn, where their chart
   !> ends, and that has something that hangs on them; 0 when there is none
   pure integer function full_turn(model, state) result(joint)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      real(wp), parameter :: NEAR = 6.2_wp           !! a little less than 2 pi [rad]
      integer :: b, i

      do b = 1, size(model%batch)
         if (model%batch(b)%geometry%chart /= CHART_VECTOR) cycle
         do i = 1, model%batch(b)%n
            associate (q => state%joint(b)%block(block_of(i))%q, lane => lane_of(i))
               if (.not. q(lane, 4)**2 + q(lane, 5)**2 + q(lane, 6)**2 > NEAR**2) cycle
            end associate
            joint = model%batch(b)%first + i
            if (needs_angles(model%batch(b), i)) return
         end do
      end do
      joint = 0
   end function full_turn

   !> Joint i has a spring, a stop, a lock, a limit of friction or a mean frame that hangs on its
   !> angles
   pure logical function needs_angles(batch, i) result(needs)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: i

      needs = .not. batch%geometry%plain(i) .or. &
         any(iand(batch%law(4:6), LAW_SPRING + LAW_SPRING_CURVE + LAW_HARDENED) /= 0)
      if (.not. batch%limited) return
      associate (l => batch%limit)
         needs = needs .or. any(l%lo(i, 4:6) < 0.0_wp) .or. any(l%hi(i, 4:6) > 0.0_wp) .or. &
            any(l%slip_curve(i, 4:6) > 0) .or. l%t_lock(i) < huge(1.0_wp)
      end associate
   end function needs_angles

   pure integer function needed_steps(span, limit) result(n)
      real(wp), intent(in) :: span, limit

      n = max(1, ceiling(min(span/limit, 1.0e9_wp) - 1.0e-6_wp))
   end function needed_steps

   !> A new step moves the h^2/8 term of the ledger: keep S where it is
   subroutine change_step(model, h, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      if (abs(h - state%h) <= 0.0_wp) return
      state%offset = state%offset + (h**2 - state%h**2)/8.0_wp*kick_term(model, state)
      state%h = h
   end subroutine change_step

   !> Sum over leads of F.F/m + T.J^-1 T, without what conditions take
   real(wp) function kick_term(model, state) result(q)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      real(wp) :: part(WINDOW)
      integer :: b, from

      q = 0.0_wp
      do from = 1, model%n_lead, SUMMED*WINDOW
         if (state%trial%threads == 1) then
            do b = 1, parts(from)
               call add_part(b)
            end do
         else
            !$omp parallel do schedule(static) num_threads(state%trial%threads)
            do b = 1, parts(from)
               call add_part(b)
            end do
         end if
         do b = 1, parts(from)
            q = q + part(b)
         end do
      end do

   contains

      pure integer function parts(from)
         integer, intent(in) :: from

         parts = min(WINDOW, (model%n_lead - from)/SUMMED + 1)
      end function parts

      subroutine add_part(b)
         integer, intent(in) :: b

         part(b) = kick_of(model, state, from + SUMMED*(b - 1), min(from + SUMMED*b - 1, &
            model%n_lead))
      end subroutine add_part
   end function kick_term

   !> The same of leads lo..hi
   real(wp) function kick_of(model, state, lo, hi) result(q)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: lo, hi

      real(wp) :: f(3), t(3), quat(BLOCK, 4), e(BLOCK, 9)
      integer :: i, j, k, from, n

      q = 0.0_wp
      do from = lo, hi, BLOCK
         n = min(BLOCK, hi - from + 1)
         do k = 1, 4
            quat(:n, k) = state%poses%quat(from:from + n - 1, k)
         end do
         call quaternion_frame(n, quat, e)
         do i = 1, n
            j = from + i - 1
            if (model%rests(j)) cycle
            f = state%f(j, :)
            t = state%t(j, :)
            if (model%hold_of(j) > 0) call held_force(model, state, model%hold_of(j), f, t)
            q = q + model%inverse_mass(j)*dot_product(f, f)
            do k = 1, 3
               q = q + model%inverse_inertia(j, k)*dot_product(e(i, 3*k - 2:3*k), t)**2
            end do
         end do
      end do
   end function kick_of

   !> Ledger S = kinetic + work on joints + potential - external work - h^2/8 kick term, and its
   !> change since the start over the largest kinetic + elastic + |work| so far
   subroutine balance_ledger(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: kinetic, joints, lost, s
      integer :: b, i

      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      kinetic = 0.5_wp*(sum(model%mass*sum(state%v**2, dim=2)) + sum(state%l*state%poses%w))
      joints = 0.0_wp
      lost = 0.0_wp
      state%energy = 0.0_wp
      do b = 1, size(state%joint)
         do i = 1, size(state%joint(b)%block)
            associate (lanes => state%joint(b)%block(i))
               state%energy = state%energy + sum(lanes%elastic)
               joints = joints + sum(lanes%elastic) + sum(lanes%dissipated)
               lost = lost + sum(lanes%dissipated)
            end associate
         end do
      end do
      state%energy = kinetic + state%energy
      s = kinetic + joints + potential(model, state) - state%work
      if (state%by_steps .and. .not. allocated(state%compliant)) &
         s = s - state%h**2/8.0_wp*kick_term(model, state) + state%offset
      if (allocated(state%compliant)) s = s - min(0.0_wp, lost)   ! joints do not give energy
      if (state%cycle == 0) then
         state%s0 = s
         state%scale = energy_of_rounding(model, state)
         if (allocated(state%compliant)) state%scale = max(state%scale, &
            state%compliant%least_scale)
      end if
      call close_ledger(s - state%s0, state)
   end subroutine balance_ledger

   !> The change of S as a fraction of the largest energy so far
   pure subroutine close_ledger(change, state)
      real(wp), intent(in) :: change
      type(consistent_state_t), intent(inout) :: state

      state%change = change
      state%scale = max(state%scale, state%energy + abs(state%work))
      state%error = 0.0_wp
      if (.not. state%scale <= 0.0_wp) state%error = change/state%scale   ! NaN stays NaN
   end subroutine close_ledger

   !> Energy of joints strained by a thousand times the rounding of coordinates: below it an energy
   !> means nothing, and a scene at rest has no other.
   pure real(wp) function energy_of_rounding(model, state) result(u)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      real(wp), parameter :: STRAIN = 1.0e3_wp*epsilon(1.0_wp)
      real(wp) :: reach
      integer :: b, i

      u = 0.0_wp
      do b = 1, size(model%batch)
         associate (k => model%batch(b)%k, lead => model%batch(b)%lead)
            do i = 1, model%batch(b)%n
               reach = maxval(abs(state%poses%x(lead(i, :), :))) + &
                  maxval(abs(model%batch(b)%geometry%arm(i, :)))
               u = u + 0.5_wp*STRAIN**2*(reach**2*sum(abs(k(i, 1:3))) + sum(abs(k(i, 4:6))))
            end do
         end associate
      end do
   end function energy_of_rounding

   !> Potential of constant gravity, 0 at the start
   pure real(wp) function potential(model, state) result(u)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      real(wp) :: g(3)
      integer :: i, k, lead

      u = 0.0_wp
      do i = 1, size(model%gravity)
         if (.not. model%steady(i)) cycle
         g = field_at(model, state, model%gravity(i))
         do k = 1, size(model%gravity(i)%node)
            lead = model%gravity(i)%node(k)
            u = u - model%mass(lead)*dot_product(g, state%poses%d(lead, :))
         end do
      end do
   end function potential

end module kj_consistent_march
