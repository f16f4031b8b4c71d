!> Rows, pattern and work space of the integrator `compliant`, once at the start.
!> Source: docs/theory/compliant.md 1, 4.
module kj_consistent_compliant_build
   use, intrinsic :: iso_c_binding, only: c_loc
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of, lane_of, clear
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: is_spring, LAW_DAMPER, LAW_DAMPER_CURVE, LAW_SPRING, &
      LAW_SPRING_CURVE, LAW_HARDENED
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_compliant_types, only: compliant_t, compliant_joint_t, leads_then_t, then_t, &
      end_t, damper_t, N_KEPT
   use kj_consistent_compliant_pattern, only: new_pattern, place
   use kj_consistent_compliant_factor, only: new_factor
   implicit none
   private

   public :: make_implicit, new_compliant, size_of

   integer, parameter :: DAMPERS = LAW_DAMPER + LAW_DAMPER_CURVE + LAW_HARDENED
   integer, parameter :: MOST_DAMPERS = 4        !! solutions that cost less than another matrix

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

      integer :: b

      if (allocated(state%compliant)) deallocate (state%compliant)
      allocate (state%compliant)
      associate (self => state%compliant, n => model%n_lead)
         self%rigid = rigid
         allocate (self%joint(size(model%batch)), self%rowed(size(model%batch)), &
            self%sprung(size(model%batch)), self%damped(size(model%batch)), &
            self%last(size(model%batch)), &
            self%explicit(NDOF, size(model%batch)))
         do b = 1, size(model%batch)
            call new_rows(model, b, self)
            if (.not. rigid) call find_energies(state%joint(b), self%joint(b))
         end do
         self%any_damper = any(self%damped)
         self%partly = model%hold_of > 0 .or. .not. (model%inverse_mass > 0.0_wp .and. &
            model%inverse_inertia(:, 1) > 0.0_wp)
         call new_nodes(model, self)
         call list_dampers(model, self)
         allocate (self%y(n, 3), self%turn(n, 3), &
            self%free(3, 3, 2, merge(n, 0, any(self%partly))), source=0.0_wp)
         call new_leads(model, state, self%start)
         allocate (self%f(n, 3), self%t(n, 3), source=0.0_wp)
         call new_then(model, state, self%start, self%then(1))
         self%then(2) = self%then(1)
         self%size = size_of(model)
      end associate
   end subroutine new_compliant

   !> Room for all that a step changes
   subroutine new_then(model, state, leads, then)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      type(leads_then_t), intent(in) :: leads
      type(then_t), intent(out) :: then

      integer :: b

      then%leads = leads
      allocate (then%joint(BLOCK, N_KEPT, sum((model%batch%n + BLOCK - 1)/BLOCK)), source=0.0_wp)
      allocate (then%limit(size(model%batch)))
      do b = 1, size(model%batch)
         allocate (then%limit(b)%block(0), then%limit(b)%spring(0))
         if (allocated(state%joint(b)%limit)) then%limit(b)%block = state%joint(b)%limit
         if (allocated(state%joint(b)%spring)) then%limit(b)%spring = state%joint(b)%spring
      end do
      then%turn = state%turn
      then%motion_at = state%motion_at
      then%load_force = state%load_force
      then%load_place = state%load_place
      then%field = state%field
   end subroutine new_then

   !> Rows of batch b
   subroutine new_rows(model, b, self)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b
      type(compliant_t), target, intent(inout) :: self

      integer :: at, i, j, k

      associate (batch => model%batch(b))
         allocate (self%joint(b)%block((batch%n + BLOCK - 1)/BLOCK))
         self%explicit(:, b) = is_spring(batch) .or. joint_types(batch%row)%free == 1
         self%damped(b) = batch%limited .or. any(self%explicit(:, b) .and. &
            iand(batch%law, DAMPERS) /= 0)
         self%sprung(b) = batch%limited .or. any(self%explicit(:, b) .and. &
            iand(batch%law, LAW_SPRING + LAW_SPRING_CURVE + LAW_HARDENED) /= 0)
         self%rowed(b) = self%damped(b) .or. any(.not. self%explicit(:, b))
         self%last(b) = merge(6, 3, self%damped(b) .or. any(.not. self%explicit(4:6, b)))
         do at = 1, size(self%joint(b)%block)
            call clear(c_loc(self%joint(b)%block(at)), storage_size(self%joint(b)%block))
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

   !> Energy of the rows in the present pose, which that of the joints has in it
   pure subroutine find_energies(joint, rows)
      type(consistent_joint_t), intent(in) :: joint
      type(compliant_joint_t), intent(inout) :: rows

      integer :: at

      do at = 1, size(rows%block)
         rows%block(at)%elastic = 0.5_wp*sum(rows%block(at)%k*joint%block(at)%q**2, dim=2)
      end do
   end subroutine find_energies

   !> Nodes of the matrix, three unknowns each: translations of a joint that has rows, its rotations
   !> if they are rows, velocity and angular velocity of bodies that are held in some directions,
   !> have more than two ends of joints, or both ends of one. The others link their joints.
   subroutine new_nodes(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      type(end_t), allocatable :: end(:)
      integer :: n_end(model%n_lead), held(2, model%n_lead), b, i, j, e, k, n

      allocate (self%node(model%n_element), self%across(model%n_element), &
         self%body(model%n_lead), source=0)
      allocate (end(2*model%n_element))
      n_end = 0
      n = 0
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do i = 1, model%batch(b)%n
            j = model%batch(b)%first + i
            self%node(j) = n + 1
            n = n + self%last(b)/3
            do e = 1, 2
               associate (lead => model%batch(b)%lead(i, e))
                  end(2*j - 2 + e) = end_t(b, block_of(i), lane_of(i), e, lead, self%node(j))
                  n_end(lead) = n_end(lead) + 1
                  held(min(2, n_end(lead)), lead) = 2*j - 2 + e
               end associate
            end do
         end do
      end do
      n_end = merge(n_end, 0, model%inverse_mass > 0.0_wp .or. model%inverse_inertia(:, 1) > 0.0_wp)
      do i = 1, model%n_lead
         if (n_end(i) == 0) cycle
         if (n_end(i) == 1 .and. model%hold_of(i) == 0) cycle
         if (n_end(i) == 2 .and. model%hold_of(i) == 0) then
            if (end(held(1, i))%node /= end(held(2, i))%node) cycle
         end if
         self%body(i) = n + 1
         n = n + 2
      end do
      self%hub = pack([(i, i=1, model%n_lead)], self%body > 0)
      self%im = merge(model%inverse_mass, 0.0_wp, self%body == 0)
      self%share = merge(1.0_wp/max(1, model%n_end), 0.0_wp, self%body == 0)
      allocate (self%link(count(n_end == 2 .and. self%body == 0)), &
         self%tie(sum(n_end, mask=self%body > 0)))
      k = 0
      do i = 1, model%n_lead
         if (n_end(i) /= 2 .or. self%body(i) > 0) cycle
         k = k + 1
         self%link(k)%end = end(held(:, i))
      end do
      k = 0
      do j = 1, size(end)
         if (end(j)%node == 0) cycle
         if (self%body(end(j)%lead) == 0) cycle
         k = k + 1
         self%tie(k)%end = end(j)
      end do
      call couple_nodes(n, end, self)
   end subroutine new_nodes

   !> The pattern of n nodes, and where each block stands in it
   subroutine couple_nodes(n, end, self)
      integer, intent(in) :: n
      type(end_t), intent(in) :: end(:)
      type(compliant_t), intent(inout) :: self

      integer, allocatable :: pair(:, :)
      integer :: i, j, k, l, n_pair, run

      allocate (pair(2, n + 4*size(self%link) + 3*size(self%tie)))
      n_pair = 0
      do run = 1, 2                              ! list what is coupled; see where that stands
         do j = 1, size(end), 2
            if (turned(end(j))) call couple(end(j)%node + 1, end(j)%node, self%across((j + 1)/2))
         end do
         do k = 1, size(self%link)
            associate (link => self%link(k))
               do l = 0, merge(1, 0, turned(link%end(2)))
                  do i = 0, merge(1, 0, turned(link%end(1)))
                     call couple(link%end(1)%node + i, link%end(2)%node + l, &
                        link%place(i + 1, l + 1))
                  end do
               end do
            end associate
         end do
         do k = 1, size(self%tie)
            associate (tie => self%tie(k), body => self%body(self%tie(k)%end%lead))
               call couple(tie%end%node, body, tie%place(1))
               call couple(tie%end%node, body + 1, tie%place(2))
               if (turned(tie%end)) call couple(tie%end%node + 1, body + 1, tie%place(3))
            end associate
         end do
         if (run == 1) call new_pattern(n, pair(:, :n_pair), self%pattern)
      end do
      call new_factor(self%pattern, self%factor)
      if (self%rigid) call new_factor(self%pattern, self%first)
      do i = 1, size(self%hub)
         self%factor%sign(self%pattern%column([0, 1] + self%body(self%hub(i)))) = -1.0_wp
      end do

   contains

      !> Its rotations are rows, too
      pure logical function turned(end)
         type(end_t), intent(in) :: end

         turned = end%node > 0
         if (turned) turned = self%last(end%batch) > 3
      end function turned

      subroutine couple(a, b, at)
         integer, intent(in) :: a, b
         integer, intent(inout) :: at

         if (run == 1) then
            n_pair = n_pair + 1
            pair(:, n_pair) = [a, b]
         else
            at = place(self%pattern, a, b)
         end if
      end subroutine couple
   end subroutine couple_nodes

   !> Rows of dampers, where they are few
   subroutine list_dampers(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      logical :: damped(NDOF, size(model%batch))
      integer :: b, i, k, n

      do b = 1, size(model%batch)
         damped(:, b) = self%damped(b) .and. self%explicit(:, b) .and. (model%batch(b)%limited &
            .or. iand(model%batch(b)%law, DAMPERS) /= 0)
      end do
      n = sum(model%batch%n*count(damped, dim=1))
      self%apart = n > MOST_DAMPERS
      if (self%apart) n = 0
      allocate (self%damper(n))
      allocate (self%response(4, self%pattern%n, n), source=0.0_wp)
      n = 0
      do b = 1, size(model%batch)
         if (self%apart) cycle
         do i = 1, model%batch(b)%n
            do k = 1, NDOF
               if (.not. damped(k, b)) cycle
               n = n + 1
               self%damper(n) = damper_t(b, block_of(i), lane_of(i), k, self%pattern%column( &
                  self%node(model%batch(b)%first + i) + merge(0, 1, k <= 3)), modulo(k - 1, 3) + 1)
            end do
         end do
      end do
   end subroutine list_dampers

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
