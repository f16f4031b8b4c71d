!> Start of the integrator `compliant`, and jumps: velocities that the joints allow, and the
!> explicit forces of the present pose.
!> Source: docs/theory/compliant.md 5.
module kj_consistent_compliant_start
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_types, only: NDOF
   use kj_model, only: IMPOSE_VELOCITY
   use kj_consistent_matrix, only: rates
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: spin_velocity, kick
   use kj_consistent_leads, only: open_leads, look_leads
   use kj_consistent_conditions, only: project_all, keep_rates, WHOLE
   use kj_consistent_motion, only: motion_targets
   use kj_consistent_load, only: add_loads, find_gravity, add_gravity, add_host_loads
   use kj_consistent_step, only: place_nodes
   use kj_consistent_compliant_types, only: compliant_t
   use kj_consistent_compliant_matrix, only: assemble, solve_all
   use kj_consistent_compliant_forces, only: spring_forces, damper_rows, renew_locks
   use kj_consistent_compliant_pass, only: pass_t, over_joints, see_joints, ASK, GIVE
   use kj_consistent_compliant_step, only: prepare, put_locks
   implicit none
   private

   public :: start_velocities, find_explicit

   real(wp), parameter :: NO_STEP(BLOCK) = 0.0_wp

contains

   !> At the start or after a jump: velocities that joints do not allow lose their energy at once,
   !> by a velocity stage without forces; then the explicit forces of the present pose
   subroutine start_velocities(model, h, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h                  !! of the first step
      type(consistent_state_t), intent(inout) :: state

      type(pass_t) :: pass
      real(wp) :: mean(size(model%motion)), final(size(model%motion)), before, work, &
         guess
      logical :: active(size(model%motion)), good, changed
      integer :: b, at

      work = state%work
      before = kinetic(model, state)
      call renew_locks(model, state, state%compliant, changed)
      call put_locks(state%compliant)
      state%h = h
      call motion_targets(model, state, 1.0e-30_wp, mean, final, active)
      active = active .and. model%motion%kind == IMPOSE_VELOCITY
      state%final = final
      state%active = active
      call see_joints(model, state, state%compliant)
      call prepare(model, h, active, state, state%compliant, guess, good)
      call keep_rates(model, 1, size(model%hold), state)
      state%f = 0.0_wp
      state%t = 0.0_wp
      call look_leads(model, NO_STEP, 1, model%n_lead, state)
      associate (self => state%compliant)
         call assemble(model, state, active, .true., self, good)
         pass = pass_t(ASK, h=h, at_rest=.true.)
         call over_joints(model, pass, state, self)
         call solve_all(.true., self)
         pass%what = GIVE
         call over_joints(model, pass, state, self)
         call kick(model%n_lead, 1, model, spread(h, 1, model%n_lead), state%f, &
            state%t, state%v, state%l)
         call project_all(model, final, active, WHOLE, state)
         state%work = work
         if (state%cycle > 0) then
            call count_loss(model, h, state, self)
         else
            self%loss = before - kinetic(model, state)
            self%kinetic = before
         end if
         do b = 1, size(model%batch)             ! these were no forces that go on
            do at = 1, size(self%joint(b)%block)
               self%joint(b)%block(at)%g = 0.0_wp
            end do
         end do
         self%jump = 0
      end associate
      call find_explicit(model, state)
   end subroutine start_velocities

   !> Explicit forces of the present pose, without dampers; these from the velocities as they are
   subroutine find_explicit(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      type(pass_t) :: pass
      logical :: any_rest
      integer :: b, at, n, k

      state%compliant%y = 0.0_wp                 ! no step
      call open_leads(model, state%compliant%y(:, 1), 1, model%n_lead, state)
      state%f = 0.0_wp
      state%t = 0.0_wp
      state%own_f = 0.0_wp
      state%own_t = 0.0_wp
      state%poses%v = state%v
      state%poses%psi = 0.0_wp
      state%poses%h = 0.0_wp
      call place_nodes(model, state)
      call find_gravity(model, state)
      call spring_forces(model, state, state%compliant)
      call add_gravity(model, 1, model%n_lead, state)
      call add_loads(model, state)
      call add_host_loads(0.0_wp, state)
      call look_leads(model, NO_STEP, 1, model%n_lead, state)
      associate (self => state%compliant)
         call damper_rows(model, 1.0_wp, state, self, any_rest)
         pass = pass_t(ASK, h=1.0_wp)
         call over_joints(model, pass, state, self)
         do b = 1, size(model%batch)
            do at = 1, size(self%joint(b)%block)
               associate (lanes => state%joint(b)%block(at), rows => self%joint(b)%block(at))
                  n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
                  do k = 1, NDOF
                     lanes%fd(:n, k) = 0.0_wp
                     if (.not. self%explicit(k, b)) lanes%fe(:n, k) = 0.0_wp
                     if (self%explicit(k, b) .and. self%damped(b)) &
                        lanes%fd(:n, k) = merge(0.0_wp, rows%r(:n, k) + rows%rest(:n, k), &
                        rows%k(:n, k) > 0.0_wp)
                  end do
               end associate
            end do
         end do
      end associate
   end subroutine find_explicit

   !> What the jump took is lost in the joints: impulse times mean rate
   subroutine count_loss(model, h, state, self)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self

      real(wp) :: rate(BLOCK, 6, 2)
      integer :: b, at, from, n, k

      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, self%y)
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do at = 1, size(self%joint(b)%block)
            from = BLOCK*(at - 1) + 1
            n = min(BLOCK, model%batch(b)%n - from + 1)
            associate (rows => self%joint(b)%block(at), lanes => state%joint(b)%block(at))
               call rates(model%batch(b), NDOF, state%poses%v, state%poses%w, from, n, rows%b, &
                  rate(:, :, 1))
               call rates(model%batch(b), NDOF, state%v, self%y, from, n, rows%b, &
                  rate(:, :, 2))
               do k = 1, NDOF
                  lanes%dissipated(:n) = lanes%dissipated(:n) + 0.5_wp*h*rows%g(:n, k)*0.5_wp* &
                     (rate(:n, k, 1) + rate(:n, k, 2))
               end do
            end associate
         end do
      end do
   end subroutine count_loss

   real(wp) function kinetic(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      kinetic = 0.5_wp*(sum(model%mass*sum(state%v**2, dim=2)) + sum(state%l*state%poses%w))
   end function kinetic

end module kj_consistent_compliant_start
