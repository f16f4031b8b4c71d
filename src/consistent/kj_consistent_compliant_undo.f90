!> A step of the integrator `compliant` that went wrong is taken back: what it changed.
!> Source: docs/theory/compliant.md 3, 6.
module kj_consistent_compliant_undo
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_consistent_batch, only: consistent_joint_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_joint_t
   use kj_consistent_compliant_forces, only: see_joints, take_coordinates
   implicit none
   private

   public :: keep_leads, restore_leads, keep_rest, undo_step

contains

   !> Remember the leads at the start of a step
   subroutine keep_leads(state)
      type(consistent_state_t), intent(inout) :: state

      associate (then => state%compliant%start)
         then%x(:, :) = state%poses%x
         then%d(:, :) = state%poses%d
         then%quat(:, :) = state%poses%quat
         then%v(:, :) = state%v
         then%l(:, :) = state%l
         then%f(:, :) = state%f
         then%t(:, :) = state%t
         then%own_f(:, :) = state%own_f
         then%own_t(:, :) = state%own_t
         then%impulse(:, :) = state%impulse
         then%angular_impulse(:, :) = state%angular_impulse
      end associate
   end subroutine keep_leads

   !> Bring them back
   subroutine restore_leads(state)
      type(consistent_state_t), intent(inout) :: state

      associate (then => state%compliant%start)
         state%poses%x(:, :) = then%x
         state%poses%d(:, :) = then%d
         state%poses%quat(:, :) = then%quat
         state%v(:, :) = then%v
         state%l(:, :) = then%l
         state%f(:, :) = then%f
         state%t(:, :) = then%t
         state%own_f(:, :) = then%own_f
         state%own_t(:, :) = then%own_t
         state%impulse(:, :) = then%impulse
         state%angular_impulse(:, :) = then%angular_impulse
      end associate
   end subroutine restore_leads

   !> Remember what the position stage leaves alone
   subroutine keep_rest(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i

      associate (then => state%compliant%then, self => state%compliant)
         then%cycle = state%cycle
         then%time = state%time
         then%work = state%work
         then%jump = self%jump
         then%h_last = self%h_last
         then%h_stiff = self%h_stiff
         do b = 1, size(model%batch)
            call keep_joints(model%batch(b)%first, model%batch(b)%n, state%joint(b), &
               self%joint(b), then%joint, then%rows)
            if (.not. allocated(state%joint(b)%limit)) cycle
            do i = 1, size(state%joint(b)%limit)
               then%limit(b)%block(i) = state%joint(b)%limit(i)
            end do
         end do
         then%turn(:, :) = state%turn
         then%node(:, :) = state%node
         then%skew(:, :) = state%skew
         then%motion_at(:) = state%motion_at
         then%load_force(:, :) = state%load_force
         then%load_place(:, :) = state%load_place
         do i = 1, size(state%field)
            then%field(i)%now = state%field(i)%now
         end do
      end associate
   end subroutine keep_rest

   !> Take back a whole step
   subroutine undo_step(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i

      call restore_leads(state)
      associate (then => state%compliant%then, self => state%compliant)
         state%cycle = then%cycle
         state%time = then%time
         state%poses%time = then%time
         state%work = then%work
         self%jump = then%jump
         self%h_last = then%h_last
         self%h_stiff = then%h_stiff
         do b = 1, size(model%batch)
            call restore_joints(model%batch(b)%first, model%batch(b)%n, then%joint, then%rows, &
               state%joint(b), self%joint(b))
            if (.not. allocated(state%joint(b)%limit)) cycle
            do i = 1, size(state%joint(b)%limit)
               state%joint(b)%limit(i) = then%limit(b)%block(i)
            end do
         end do
         call see_joints(model, state, self)
         call take_coordinates(model, state, self)
         state%turn(:, :) = then%turn
         state%node(:, :) = then%node
         state%skew(:, :) = then%skew
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

   subroutine keep_joints(first, n_joint, joint, rows, kept, multipliers)
      integer, intent(in) :: first, n_joint      !! joints before the batch, in it
      type(consistent_joint_t), intent(in) :: joint
      type(compliant_joint_t), intent(in) :: rows
      real(wp), intent(inout) :: kept(:, :), multipliers(:, :, :)

      integer :: at, from, to, n

      do at = 1, size(joint%block)
         n = min(BLOCK, n_joint - BLOCK*(at - 1))
         from = first + BLOCK*(at - 1) + 1
         to = from + n - 1
         kept(from:to, 1:6) = joint%block(at)%qd(:n, :)
         kept(from:to, 7:12) = joint%block(at)%fe(:n, :)
         kept(from:to, 13:18) = joint%block(at)%fd(:n, :)
         kept(from:to, 19) = joint%block(at)%elastic(:n)
         kept(from:to, 20) = joint%block(at)%dissipated(:n)
         kept(from:to, 21) = rows%block(at)%elastic(:n)
         multipliers(from:to, :, 1) = rows%block(at)%f_last(:n, :)
         multipliers(from:to, :, 2) = rows%block(at)%f_before(:n, :)
         multipliers(from:to, :, 3) = rows%block(at)%g(:n, :)
      end do
   end subroutine keep_joints

   subroutine restore_joints(first, n_joint, kept, multipliers, joint, rows)
      integer, intent(in) :: first, n_joint
      real(wp), intent(in) :: kept(:, :), multipliers(:, :, :)
      type(consistent_joint_t), intent(inout) :: joint
      type(compliant_joint_t), intent(inout) :: rows

      integer :: at, from, to, n

      do at = 1, size(joint%block)
         n = min(BLOCK, n_joint - BLOCK*(at - 1))
         from = first + BLOCK*(at - 1) + 1
         to = from + n - 1
         joint%block(at)%qd(:n, :) = kept(from:to, 1:6)
         joint%block(at)%fe(:n, :) = kept(from:to, 7:12)
         joint%block(at)%fd(:n, :) = kept(from:to, 13:18)
         joint%block(at)%elastic(:n) = kept(from:to, 19)
         joint%block(at)%dissipated(:n) = kept(from:to, 20)
         rows%block(at)%elastic(:n) = kept(from:to, 21)
         rows%block(at)%f_last(:n, :) = multipliers(from:to, :, 1)
         rows%block(at)%f_before(:n, :) = multipliers(from:to, :, 2)
         rows%block(at)%g(:n, :) = multipliers(from:to, :, 3)
      end do
   end subroutine restore_joints

end module kj_consistent_compliant_undo
