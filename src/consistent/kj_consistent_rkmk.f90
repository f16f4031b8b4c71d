!> Munthe-Kaas Runge-Kutta step of fourth order: four force evaluations, dampers from the velocities
!> of each stage. To verify the other integrators, and for soft joints.
!> Source: docs/theory/consistent.md 5; Munthe-Kaas, Appl. Numer. Math. 29 (1999) 115.
module kj_consistent_rkmk
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_block, only: BLOCK
   use kj_consistent_dampers, only: count_damping
   use kj_consistent_state, only: consistent_model_t, consistent_state_t, rates_t, stages_t
   use kj_consistent_body, only: spin_velocity, turn_in_space
   use kj_consistent_conditions, only: project_all, keep_rates, WHOLE
   use kj_consistent_motion, only: motion_targets
   use kj_consistent_load, only: load_power
   use kj_consistent_step, only: find_forces, reach_motions
   implicit none
   private

   public :: rkmk_step

   real(wp), parameter :: NODE(4) = [0.0_wp, 0.5_wp, 0.5_wp, 1.0_wp]
   real(wp), parameter :: WEIGHT(4) = [1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp]/6.0_wp

contains

   !> From t to t + h. Forces at t must be there (as after any step).
   subroutine rkmk_step(model, h, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state

      type(stages_t), allocatable :: self
      real(wp) :: time, work
      integer :: s

      state%h = h
      state%by_steps = .false.
      call move_alloc(state%stages, self)
      if (.not. allocated(self)) call new_stages(model, self)
      self%x = state%poses%x
      self%d = state%poses%d
      self%quat = state%poses%quat
      self%v = state%v
      self%l = state%l
      time = state%time
      work = state%work
      call motion_targets(model, state, h, self%mean, self%final, self%active)
      call keep_rates(model, 1, size(model%hold), state)
      call clear(self%stage)
      call clear(self%total)
      do s = 1, 4
         if (s > 1) then
            call move(model, h*NODE(s), self, self%stage, state)
            state%time = time
            call hold_stage(model, h*NODE(s), time, self, state)
            call find_forces(model, 0.0_wp, self%there, self%active, state)
         end if
         call take_rates(model, h*WEIGHT(s), h*NODE(s), state, work, self%stage)
         call add(WEIGHT(s), self%stage, self%total)
      end do
      call move(model, h, self, self%total, state)
      state%cycle = min(state%cycle, huge(state%cycle) - 1) + 1     ! no more can be counted
      state%time = time + h
      state%work = work
      call project_all(model, self%final, self%active, WHOLE, state)
      work = state%work
      call reach_motions(model, h, self%mean, self%final, self%active, state)
      state%poses%v = state%v
      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      state%poses%psi = h*self%total%turn
      state%turn = state%turn + state%poses%psi(:model%n_body, :)
      call find_forces(model, 0.0_wp, self%final, self%active, state)
      state%work = work
      call move_alloc(self, state%stages)
   end subroutine rkmk_step

   !> Room for the stages of a scene
   subroutine new_stages(model, self)
      type(consistent_model_t), intent(in) :: model
      type(stages_t), allocatable, intent(out) :: self

      allocate (self)
      associate (n => model%n_lead, m => size(model%motion))
         allocate (self%x(n, 3), self%d(n, 3), self%quat(n, 4), self%v(n, 3), self%l(n, 3))
         allocate (self%mean(m), self%final(m), self%there(m), self%between(m), source=0.0_wp)
         allocate (self%active(m), self%acts(m), source=.false.)
         call new_rates(n, self%stage)
         call new_rates(n, self%total)
      end associate
   end subroutine new_stages

   subroutine new_rates(n, rates)
      integer, intent(in) :: n
      type(rates_t), intent(out) :: rates

      allocate (rates%x(n, 3), rates%turn(n, 3), rates%v(n, 3), rates%l(n, 3))
   end subroutine new_rates

   subroutine clear(rates)
      type(rates_t), intent(inout) :: rates

      rates%x = 0.0_wp
      rates%turn = 0.0_wp
      rates%v = 0.0_wp
      rates%l = 0.0_wp
   end subroutine clear

   subroutine add(weight, stage, total)
      real(wp), intent(in) :: weight
      type(rates_t), intent(in) :: stage
      type(rates_t), intent(inout) :: total

      total%x = total%x + weight*stage%x
      total%turn = total%turn + weight*stage%turn
      total%v = total%v + weight*stage%v
      total%l = total%l + weight*stage%l
   end subroutine add

   !> State at the start of the step plus h times the rates
   subroutine move(model, h, self, rates, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(stages_t), intent(in) :: self
      type(rates_t), intent(in) :: rates
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: phi(BLOCK, 3), q(BLOCK, 4)
      integer :: from, to, n, i

      state%poses%x = self%x + h*rates%x
      state%poses%d = self%d + h*rates%x
      state%v = self%v + h*rates%v
      state%l = self%l + h*rates%l
      do from = 1, model%n_lead, BLOCK
         to = min(from + BLOCK - 1, model%n_lead)
         n = to - from + 1
         phi(:n, :) = h*rates%turn(from:to, :)
         q(:n, :) = self%quat(from:to, :)
         call turn_in_space(n, phi, q)
         do i = 1, n
            state%poses%quat(from + i - 1, :) = q(i, :)/norm2(q(i, :))
         end do
      end do
      state%poses%v = state%v
      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
   end subroutine move

   !> Conditions and drives on the velocities of a stage; self%there: those of the drives then
   subroutine hold_stage(model, h, time, self, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h                      !! from the start of the step to the stage
      real(wp), intent(in) :: time
      type(stages_t), intent(inout) :: self
      type(consistent_state_t), intent(inout) :: state

      call motion_targets(model, state, h, self%between, self%there, self%acts)
      state%time = time + h
      call project_all(model, self%there, self%acts, WHOLE, state)
      state%poses%v = state%v
      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
   end subroutine hold_stage

   !> Rates of a stage; its share of the work of loads and of what the dampers take.
   !>
   !> The turn since the start is u: u' = w - u x w/2 + u x (u x w)/12
   subroutine take_rates(model, share, since, state, work, stage)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: share, since
      type(consistent_state_t), intent(inout) :: state
      real(wp), intent(inout) :: work
      type(rates_t), intent(inout) :: stage

      real(wp), dimension(3) :: u, w, once, twice
      real(wp) :: whole(BLOCK)                       ! count_damping counts half a step
      integer :: i, b

      whole = 2.0_wp*share
      state%poses%v = state%v
      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      do b = 1, size(model%batch)
         if (model%batch(b)%geometry%damped == 0) cycle
         do i = 1, model%batch(b)%n, BLOCK
            call count_damping(model%batch(b), state%poses%v, state%poses%w, whole, i, &
               min(BLOCK, model%batch(b)%n - i + 1), state%joint(b)%block((i - 1)/BLOCK + 1))
         end do
      end do
      work = work + share*load_power(model, state)
      associate (n => model%n_body)
         state%impulse = state%impulse + share*(state%f(:n, :) - state%own_f(:n, :))
         state%angular_impulse = state%angular_impulse + share*(state%t(:n, :) - state%own_t(:n, :))
      end associate
      do i = 1, model%n_lead
         u = since*stage%turn(i, :)
         w = state%poses%w(i, :)
         stage%x(i, :) = state%v(i, :)
         once = cross(u, w)
         twice = cross(u, once)
         stage%turn(i, :) = w - 0.5_wp*once + twice/12.0_wp
         stage%v(i, :) = model%inverse_mass(i)*state%f(i, :)
         stage%l(i, :) = merge(0.0_wp, state%t(i, :), model%rests(i))
      end do
   end subroutine take_rates

end module kj_consistent_rkmk
