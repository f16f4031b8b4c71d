!> A step of the integrator `compliant` that went wrong is taken back: what it changed.
!> Source: docs/theory/compliant.md 3, 6.
module kj_consistent_compliant_undo
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_matrix, only: poses_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_step, only: place_nodes
   use kj_consistent_compliant_types, only: compliant_joint_t, leads_then_t
   use kj_consistent_compliant_forces, only: take_coordinates
   use kj_consistent_compliant_pass, only: see_joints
   implicit none
   private

   public :: copy, keep_leads, restore_leads, keep_all, undo_step, has_moved_on

   integer, parameter, public :: BEFORE = 1, FINE = 2   !! what is kept

contains

   !> b = a, n numbers
   pure subroutine copy(n, a, b)
      integer, value :: n
      real(wp), intent(in) :: a(n)
      real(wp), intent(inout) :: b(n)

      integer :: i

      !$omp simd
      do i = 1, n
         b(i) = a(i)
      end do
   end subroutine copy

   !> Remember the leads at the start of a step
   subroutine keep_leads(state)
      type(consistent_state_t), intent(inout) :: state

      call leads_to(state%compliant%start, state%poses, state%v, state%l, state%f, state%t, &
         state%own_f, state%own_t, state%impulse, state%angular_impulse)
   end subroutine keep_leads

   !> Bring them back
   subroutine restore_leads(state)
      type(consistent_state_t), intent(inout) :: state

      call leads_from(state%compliant%start, state%poses, state%v, state%l, state%f, state%t, &
         state%own_f, state%own_t, state%impulse, state%angular_impulse)
   end subroutine restore_leads

   pure subroutine leads_to(then, poses, v, l, f, t, own_f, own_t, impulse, angular_impulse)
      type(leads_then_t), intent(inout) :: then
      type(poses_t), intent(in) :: poses
      real(wp), intent(in), contiguous, dimension(:, :) :: v, l, f, t, own_f, own_t, impulse, &
         angular_impulse

      call copy(size(then%x), poses%x, then%x)
      call copy(size(then%d), poses%d, then%d)
      call copy(size(then%quat), poses%quat, then%quat)
      call copy(size(v), v, then%v)
      call copy(size(l), l, then%l)
      call copy(size(f), f, then%f)
      call copy(size(t), t, then%t)
      call copy(size(own_f), own_f, then%own_f)
      call copy(size(own_t), own_t, then%own_t)
      call copy(size(impulse), impulse, then%impulse)
      call copy(size(angular_impulse), angular_impulse, then%angular_impulse)
   end subroutine leads_to

   pure subroutine leads_from(then, poses, v, l, f, t, own_f, own_t, impulse, angular_impulse)
      type(leads_then_t), intent(in) :: then
      type(poses_t), intent(inout) :: poses
      real(wp), intent(inout), contiguous, dimension(:, :) :: v, l, f, t, own_f, own_t, impulse, &
         angular_impulse

      call copy(size(then%x), then%x, poses%x)
      call copy(size(then%d), then%d, poses%d)
      call copy(size(then%quat), then%quat, poses%quat)
      call copy(size(v), then%v, v)
      call copy(size(l), then%l, l)
      call copy(size(f), then%f, f)
      call copy(size(t), then%t, t)
      call copy(size(own_f), then%own_f, own_f)
      call copy(size(own_t), then%own_t, own_t)
      call copy(size(impulse), then%impulse, impulse)
      call copy(size(angular_impulse), then%angular_impulse, angular_impulse)
   end subroutine leads_from

   !> Remember all that a step changes
   subroutine keep_all(model, which, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: which               !! BEFORE or FINE
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i, first

      associate (then => state%compliant%then(which), self => state%compliant)
         call leads_to(then%leads, state%poses, state%v, state%l, state%f, state%t, state%own_f, &
            state%own_t, state%impulse, state%angular_impulse)
         then%cycle = state%cycle
         then%time = state%time
         then%work = state%work
         then%jump = self%jump
         then%h_last = self%h_last
         then%h_stiff = self%h_stiff
         first = 1
         do b = 1, size(model%batch)
            call keep_joints(model%batch(b)%n, self%sprung(b) .or. self%damped(b), state%joint(b), &
               self%joint(b), then%joint(:, :, first:))
            first = first + size(state%joint(b)%block)
            do i = 1, size(then%limit(b)%block)
               then%limit(b)%block(i) = state%joint(b)%limit(i)
            end do
            do i = 1, size(then%limit(b)%spring)
               then%limit(b)%spring(i) = state%joint(b)%spring(i)
            end do
         end do
         then%turn(:, :) = state%turn
         then%motion_at(:) = state%motion_at
         then%load_force(:, :) = state%load_force
         then%load_place(:, :) = state%load_place
         do i = 1, size(state%field)
            then%field(i)%now = state%field(i)%now
         end do
      end associate
   end subroutine keep_all

   !> The step since then failed in its velocity stage, beyond the new pose
   pure logical function has_moved_on(state)
      type(consistent_state_t), intent(in) :: state

      has_moved_on = state%cycle > state%compliant%then(BEFORE)%cycle
   end function has_moved_on

   !> Take back all since then
   subroutine undo_step(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i, first

      associate (then => state%compliant%then(BEFORE), self => state%compliant)
         call leads_from(then%leads, state%poses, state%v, state%l, state%f, state%t, state%own_f, &
            state%own_t, state%impulse, state%angular_impulse)
         state%cycle = then%cycle
         state%time = then%time
         state%poses%time = then%time
         state%work = then%work
         self%jump = then%jump
         self%h_last = then%h_last
         self%h_stiff = then%h_stiff
         first = 1
         do b = 1, size(model%batch)
            call restore_joints(model%batch(b)%n, self%sprung(b) .or. self%damped(b), &
               then%joint(:, :, first:), state%joint(b), self%joint(b))
            first = first + size(state%joint(b)%block)
            do i = 1, size(then%limit(b)%block)
               state%joint(b)%limit(i) = then%limit(b)%block(i)
            end do
            do i = 1, size(then%limit(b)%spring)
               state%joint(b)%spring(i) = then%limit(b)%spring(i)
            end do
         end do
         call place_nodes(model, state)
         call see_joints(model, state, self)
         call take_coordinates(model, state, self)
         state%turn(:, :) = then%turn
         state%motion_at(:) = then%motion_at
         state%load_force(:, :) = then%load_force
         state%load_place(:, :) = then%load_place
         do i = 1, size(state%field)
            state%field(i)%now = then%field(i)%now
         end do
         self%factored = .false.
         self%known = -1
      end associate
   end subroutine undo_step

   !> Energies and multipliers of a batch; of explicit rows (moved) their rates and forces too
   pure subroutine keep_joints(n_joint, moved, joint, rows, kept)
      integer, intent(in) :: n_joint
      logical, intent(in) :: moved
      type(consistent_joint_t), intent(in) :: joint
      type(compliant_joint_t), intent(in) :: rows
      real(wp), intent(inout) :: kept(:, :, :)   !! (BLOCK, N_KEPT, blocks and more)

      integer :: at, n

      do at = 1, size(joint%block)
         n = min(BLOCK, n_joint - BLOCK*(at - 1))
         kept(:n, 1, at) = joint%block(at)%elastic(:n)
         kept(:n, 2, at) = joint%block(at)%dissipated(:n)
         kept(:n, 3, at) = rows%block(at)%elastic(:n)
         kept(:n, 4:9, at) = rows%block(at)%g(:n, :)
         kept(:n, 10:15, at) = rows%block(at)%rise(:n, :)
         kept(:n, 16:21, at) = joint%block(at)%q(:n, :)
         if (.not. moved) cycle
         kept(:n, 22:27, at) = joint%block(at)%qd(:n, :)
         kept(:n, 28:33, at) = joint%block(at)%fe(:n, :)
         kept(:n, 34:39, at) = joint%block(at)%fd(:n, :)
      end do
   end subroutine keep_joints

   !> Bring them back
   pure subroutine restore_joints(n_joint, moved, kept, joint, rows)
      integer, intent(in) :: n_joint
      logical, intent(in) :: moved
      real(wp), intent(in) :: kept(:, :, :)
      type(consistent_joint_t), intent(inout) :: joint
      type(compliant_joint_t), intent(inout) :: rows

      integer :: at, n

      do at = 1, size(joint%block)
         n = min(BLOCK, n_joint - BLOCK*(at - 1))
         joint%block(at)%elastic(:n) = kept(:n, 1, at)
         joint%block(at)%dissipated(:n) = kept(:n, 2, at)
         rows%block(at)%elastic(:n) = kept(:n, 3, at)
         rows%block(at)%g(:n, :) = kept(:n, 4:9, at)
         rows%block(at)%rise(:n, :) = kept(:n, 10:15, at)
         if (.not. moved) cycle
         joint%block(at)%qd(:n, :) = kept(:n, 22:27, at)
         joint%block(at)%fe(:n, :) = kept(:n, 28:33, at)
         joint%block(at)%fd(:n, :) = kept(:n, 34:39, at)
      end do
   end subroutine restore_joints

end module kj_consistent_compliant_undo
