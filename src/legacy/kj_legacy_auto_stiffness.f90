!> Automatic stiffness of the blocked dofs of KJOINT2, from the first time step.
!> Source: docs/theory/legacy.md 4.4.
module kj_legacy_auto_stiffness
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_RUN
   use kj_joint_batch, only: joint_batch_t
   use kj_block, only: block_of, lane_of
   use kj_model, only: model_t
   use kj_legacy_state, only: legacy_state_t, EPS20
   implicit none
   private

   public :: set_blocking

   real(wp), parameter :: A = real(4.1, wp), SHARE = real(0.8, wp), MORE = real(1.3, &
      wp)   !! single precision
   real(wp), parameter :: NO_STEP = 9.0e4_wp      !! a first step above this is none

contains

   !> In cycle 0, with its step chosen: blocked stiffness of joints with Kn = 0, used from cycle 1
   !> on.
   !>
   !> Errors: ERR_RUN when nothing limits the first step.
   subroutine set_blocking(model, state, error)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: h
      integer :: b, i

      if (state%cycle > 0) return
      h = state%h2
      associate (c => model%control)
         if (c%nodal_step) h = max(h, c%dt_min/c%dt_factor)
         h = min(h, c%dt_max)
         if (h > NO_STEP) h = c%dt_min
      end associate
      do b = 1, size(model%batch)
         if (.not. model%batch(b)%limited) cycle
         do i = 1, model%batch(b)%n
            if (.not. model%batch(b)%limit%automatic(i)) cycle
            if (.not. h > 0.0_wp) then
               call fail(error, ERR_RUN, 'joint '//str(model%joint(joint_at(model, b, i))%id)// &
                  ' takes its stiffness from the first step, but nothing limits that: give /DTIX', &
                  'KJ-9077')
               return
            end if
            state%joint(b)%limit(block_of(i))%k_block(lane_of(i), :) = &
               stiffness_of(state, model%batch(b), i, h)
         end do
      end do
   end subroutine set_blocking

   !> Index of a joint in the model
   pure integer function joint_at(model, batch, place) result(j)
      type(model_t), intent(in) :: model
      integer, intent(in) :: batch, place

      do j = 1, model%n_joint
         if (model%joint(j)%batch == batch .and. model%joint(j)%place == place) return
      end do
      j = 1
   end function joint_at

   !> Kn and KR that the step h bears at both ends, but not below what already acts there
   pure function stiffness_of(state, batch, place, h) result(k)
      type(legacy_state_t), intent(in) :: state
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: place
      real(wp), intent(in) :: h
      real(wp) :: k(2)

      real(wp) :: length2, arm2, kx_least, kn(2), kr(2), inertia(2), room
      integer :: e, node(2), lead(2)
      logical :: raised

      node = batch%node(place, :)
      lead = batch%lead(place, :)
      length2 = sum((state%world%x(node(2), :) - state%world%x(node(1), :))**2)
      arm2 = 0.0_wp
      do e = 1, 2
         arm2 = max(arm2, sum((state%world%x(node(e), :) - state%world%x(lead(e), :))**2))
      end do
      kn = state%kn(lead)
      kr = state%kr(lead)
      inertia = state%inertia(lead)
      kx_least = huge(1.0_wp)
      k(2) = huge(1.0_wp)
      do e = 1, 2
         kx_least = min(kx_least, 2.0_wp*state%mass(lead(e))/(A*h**2) - kn(e))
         room = 0.0_wp
         if (inertia(e) > 0.0_wp) then
            room = inertia(e)/(A*h**2) - kr(e)
            kx_least = min(kx_least, SHARE*room/max(EPS20, arm2 + length2))
         else
            kx_least = min(kx_least, 1.0e30_wp)
         end if
         k(2) = min(k(2), room)
      end do
      k(1) = max(kx_least, 2.0_wp*kn(1), 2.0_wp*kn(2))
      raised = k(1) - kx_least > real(1.0e-8, wp)
      if (any(.not. inertia > 0.0_wp)) then
         k(2) = 0.0_wp
      else
         raised = raised .or. max(2.0_wp*kr(1), 2.0_wp*kr(2)) - k(2) > real(1.0e-8, wp)
         k(2) = max(k(2), 2.0_wp*kr(1), 2.0_wp*kr(2))
      end if
      if (raised) k(2) = max(k(2), MORE*k(1)*(arm2 + length2))
      k = k*batch%scale(place)
   end function stiffness_of

end module kj_legacy_auto_stiffness
