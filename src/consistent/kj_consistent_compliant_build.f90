!> Rows, pattern and work space of the integrator `compliant`, once at the start.
!> Source: docs/theory/compliant.md 1, 4.
module kj_consistent_compliant_build
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: is_spring, LAW_DAMPER, LAW_DAMPER_CURVE, LAW_SPRING, &
      LAW_SPRING_CURVE, LAW_HARDENED
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t, leads_then_t
   use kj_consistent_compliant_pattern, only: new_pattern
   use kj_consistent_compliant_factor, only: new_factor
   implicit none
   private

   public :: make_implicit, new_compliant, size_of

contains

   !> Blocked directions and locks of the joints are rows of the integrator
   pure subroutine make_implicit(model)
      type(consistent_model_t), intent(inout) :: model

      integer :: b

      do b = 1, size(model%batch)
         model%batch(b)%geometry%implicit = .true.
      end do
   end subroutine make_implicit

   !> Rows, pattern and work space of a scene
   subroutine new_compliant(model, rigid, state)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: rigid               !! Kn = infinity
      type(consistent_state_t), intent(inout) :: state

      integer :: ends(2, model%n_element), b, i
      logical :: moves(model%n_lead)

      if (allocated(state%compliant)) deallocate (state%compliant)
      allocate (state%compliant)
      associate (self => state%compliant, n => model%n_lead)
         self%rigid = rigid
         allocate (self%joint(size(model%batch)), self%rowed(size(model%batch)), &
            self%sprung(size(model%batch)), self%damped(size(model%batch)), &
            self%last(size(model%batch)), &
            self%explicit(NDOF, size(model%batch)))
         ends = 0
         do b = 1, size(model%batch)
            call new_rows(model, b, self)
            if (.not. self%rowed(b)) cycle
            do i = 1, model%batch(b)%n
               ends(:, model%batch(b)%first + i) = model%batch(b)%lead(i, :)
            end do
         end do
         self%any_damper = any(self%damped)
         moves = model%inverse_mass > 0.0_wp .or. model%inverse_inertia(:, 1) > 0.0_wp
         self%partly = model%hold_of > 0 .or. .not. (model%inverse_mass > 0.0_wp .and. &
            model%inverse_inertia(:, 1) > 0.0_wp)
         call new_pattern(ends, moves, self%pattern)
         call new_factor(self%pattern, self%factor)
         allocate (self%y(n, 3), self%turn(n, 3), &
            self%free(3, 3, 2, merge(n, 0, any(self%partly))), source=0.0_wp)
         call new_leads(model, state, self%start)
         allocate (self%then%joint(BLOCK, 27, sum((model%batch%n + BLOCK - 1)/BLOCK)), &
            self%f(n, 3), self%t(n, 3), source=0.0_wp)
         allocate (self%then%limit(size(model%batch)))
         do b = 1, size(model%batch)
            if (model%batch(b)%limited) self%then%limit(b)%block = state%joint(b)%limit
         end do
         self%then%turn = state%turn
         self%then%motion_at = state%motion_at
         self%then%load_force = state%load_force
         self%then%load_place = state%load_place
         self%then%field = state%field
         self%size = size_of(model)
      end associate
   end subroutine new_compliant

   !> Rows of batch b
   subroutine new_rows(model, b, self)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b
      type(compliant_t), intent(inout) :: self

      integer :: at, i, j, k

      associate (batch => model%batch(b))
         allocate (self%joint(b)%block((batch%n + BLOCK - 1)/BLOCK))
         self%explicit(:, b) = is_spring(batch) .or. joint_types(batch%row)%free == 1
         self%damped(b) = batch%limited .or. any(self%explicit(:, b) .and. &
            iand(batch%law, LAW_DAMPER + LAW_DAMPER_CURVE + LAW_HARDENED) /= 0)
         self%sprung(b) = batch%limited .or. any(self%explicit(:, b) .and. &
            iand(batch%law, LAW_SPRING + LAW_SPRING_CURVE + LAW_HARDENED) /= 0)
         self%rowed(b) = self%damped(b) .or. any(.not. self%explicit(:, b))
         self%last(b) = merge(6, 3, self%damped(b) .or. any(.not. self%explicit(4:6, b)))
         do at = 1, size(self%joint(b)%block)
            do i = 1, min(BLOCK, batch%n - BLOCK*(at - 1))
               j = BLOCK*(at - 1) + i
               do k = 1, NDOF
                  if (self%explicit(k, b)) cycle
                  self%joint(b)%block(at)%k(i, k) = batch%k(j, k)
                  self%joint(b)%block(at)%c(i, k) = batch%c(j, k)
               end do
            end do
         end do
      end associate
   end subroutine new_rows

   subroutine new_leads(model, state, then)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(leads_then_t), intent(out) :: then

      associate (n => model%n_lead)
         allocate (then%x(n, 3), then%d(n, 3), then%quat(n, 4), then%v(n, 3), then%l(n, 3), &
            then%f(n, 3), then%t(n, 3), then%v_half(n, 3), then%w_half(n, 3), &
            then%l_half(n, 3), source=0.0_wp)
         allocate (then%own_f, source=state%own_f)
         allocate (then%own_t, source=state%own_t)
         allocate (then%impulse, source=state%impulse)
         allocate (then%angular_impulse, source=state%angular_impulse)
      end associate
   end subroutine new_leads

   !> Largest extent of the leads and ends of joints along a global axis, or radius of inertia
   pure real(wp) function size_of(model) result(length)
      type(consistent_model_t), intent(in) :: model

      real(wp) :: lo(3), hi(3)
      integer :: b, i, e

      lo = huge(1.0_wp)
      hi = -huge(1.0_wp)
      do i = 1, model%n_lead
         lo = min(lo, model%x0(i, :))
         hi = max(hi, model%x0(i, :))
      end do
      do b = 1, size(model%batch)
         do e = 1, 2
            do i = 1, model%batch(b)%n
               lo = min(lo, model%x0(model%batch(b)%node(i, e), :))
               hi = max(hi, model%x0(model%batch(b)%node(i, e), :))
            end do
         end do
      end do
      length = max(0.0_wp, maxval(hi - lo))
      do i = 1, model%n_lead
         if (model%inverse_mass(i) > 0.0_wp) length = max(length, &
            sqrt(maxval(model%spin_inertia(i, :))/model%mass(i)))
      end do
   end function size_of

end module kj_consistent_compliant_build
