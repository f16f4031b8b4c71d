!> First state of the consistent formulation, with the automatic stiffness of KJOINT2 joints (Kn =
!> 0).
!>
!> Rule: all blocked directions of such a joint get the same frequency, K = w^2 m with m their
!> effective mass or inertia, and w is as high as the wanted step allows: factor times the safe
!> bound of the scene is the largest step of the deck (/DTIX), or, where the rest of the scene asks
!> for less, nine tenths of what that asks for. Then SCF scales the result.
!> Source: docs/theory/consistent.md 12.
module kj_consistent_auto_stiffness
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: LAW_SPRING, LAW_DAMPER
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_build, only: build_consistent_model, new_consistent_state
   use kj_consistent_safe_step, only: bound_t, new_bound
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_ready, only: begin_scene
   implicit none
   private

   public :: start_scene

   real(wp), parameter :: SHARE = 0.9_wp         !! of the step of the other limits
   real(wp), parameter :: NO_STEP = 9.0e4_wp     !! a step above this is none
   integer, parameter :: HALVINGS = 30

contains

   !> Constants and state at t = 0.
   !>
   !> Errors: ERR_RUN when a joint takes its stiffness from the step, and nothing limits that.
   subroutine start_scene(model, explicit, rigid, state, error)
      type(consistent_model_t), intent(inout) :: model   !! that of all is there
      logical, intent(in) :: explicit            !! damping shortens the step
      logical, intent(in) :: rigid               !! joints that need no way to bear a force
      type(consistent_state_t), intent(out) :: state
      type(error_t), allocatable, intent(out) :: error

      call build_consistent_model(model)
      call new_consistent_state(model, state)
      if (any_automatic(model)) then
         call choose_stiffness(model, explicit, state, error)
         if (allocated(error)) return
         call new_consistent_state(model, state)
      end if
      call begin_scene(model, rigid, state)
   end subroutine start_scene

   !> Automatic stiffness from the step that the scene is to take
   subroutine choose_stiffness(model, explicit, state, error)
      type(consistent_model_t), intent(inout) :: model
      logical, intent(in) :: explicit
      type(consistent_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: wanted

      call set_stiffness(0.0_wp, model)
      wanted = min(model%control%dt_max, SHARE*step_of(model, explicit, state))
      if (.not. wanted < NO_STEP) then
         call fail(error, ERR_RUN, 'joint '//str(first_automatic(model))// &
            ' takes its stiffness from the time step, but nothing limits that: give /DTIX', &
            'KJ-9077')
         return
      end if
      call find_stiffness(explicit, wanted, state, model)
      call scale_stiffness(model)
   end subroutine choose_stiffness

   pure logical function any_automatic(model) result(any_one)
      type(consistent_model_t), intent(in) :: model

      any_one = first_automatic(model) > 0
   end function any_automatic

   !> User id of the first joint with automatic stiffness, 0 = none
   pure integer function first_automatic(model) result(id)
      type(consistent_model_t), intent(in) :: model

      integer :: j

      do j = 1, model%n_joint
         associate (b => model%batch(model%joint(j)%batch))
            if (.not. b%limited) cycle
            id = model%joint(j)%id
            if (b%limit%automatic(model%joint(j)%place)) return
         end associate
      end do
      id = 0
   end function first_automatic

   !> Step of the scene: factor times the safe bound
   real(wp) function step_of(model, explicit, state) result(h)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: explicit
      type(consistent_state_t), intent(inout) :: state

      type(bound_t) :: bound

      call new_bound(model, explicit, state, bound)
      h = step_factor(model)*min(bound%h, 1.0e30_wp)
   end function step_of

   !> The largest frequency whose step is not below the wanted one, by bisection of its logarithm
   !> between an upper limit and a thousandth of it
   subroutine find_stiffness(explicit, wanted, state, model)
      logical, intent(in) :: explicit
      real(wp), intent(in) :: wanted
      type(consistent_state_t), intent(inout) :: state
      type(consistent_model_t), intent(inout) :: model

      real(wp) :: low, high, middle
      integer :: i

      high = 2.0_wp*step_factor(model)/wanted   ! one free direction alone
      low = 1.0e-3_wp*high
      do i = 1, HALVINGS
         middle = sqrt(low*high)
         call set_stiffness(middle, model)
         if (step_of(model, explicit, state) >= wanted) then
            low = middle
         else
            high = middle
         end if
      end do
      call set_stiffness(low, model)
   end subroutine find_stiffness

   !> K = w^2 m of the blocked directions of all automatic joints, and their damping; stops and
   !> locks without a stiffness of their own get the largest
   subroutine set_stiffness(omega, model)
      real(wp), intent(in) :: omega
      type(consistent_model_t), intent(inout) :: model

      integer :: b, i, dof

      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         if (.not. any(model%batch(b)%limit%automatic)) cycle
         associate (batch => model%batch(b))
            do dof = 1, NDOF
               if (joint_types(batch%row)%free(dof) == 1) cycle
               batch%law(dof) = LAW_SPRING + LAW_DAMPER
               do i = 1, batch%n
                  if (.not. batch%limit%automatic(i)) cycle
                  batch%k(i, dof) = omega**2*batch%geometry%inertia(i, dof)
                  batch%c(i, dof) = model%batch(b)%cr(i)*omega*batch%geometry%inertia(i, dof)
               end do
            end do
            do i = 1, batch%n
               if (.not. batch%limit%automatic(i)) cycle
               batch%limit%k_block(i, 1) = omega**2*maxval(batch%geometry%inertia(i, 1:3))
               batch%limit%k_block(i, 2) = omega**2*maxval(batch%geometry%inertia(i, 4:6))
            end do
         end associate
      end do
   end subroutine set_stiffness

   !> SCF times the automatic stiffness
   subroutine scale_stiffness(model)
      type(consistent_model_t), intent(inout) :: model

      real(wp) :: s
      integer :: b, i

      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         do i = 1, model%batch(b)%n
            if (.not. model%batch(b)%limit%automatic(i)) cycle
            s = model%batch(b)%scale(i)
            where (joint_types(model%batch(b)%row)%free == 0)
               model%batch(b)%k(i, :) = s*model%batch(b)%k(i, :)
               model%batch(b)%c(i, :) = sqrt(s)*model%batch(b)%c(i, :)
            end where
            model%batch(b)%limit%k_block(i, :) = s*model%batch(b)%limit%k_block(i, :)
         end do
      end do
   end subroutine scale_stiffness

end module kj_consistent_auto_stiffness
