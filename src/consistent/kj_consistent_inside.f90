!> What single joints do inside, law by law, under the consistent formulation.
module kj_consistent_inside
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of, lane_of
   use kj_snapshot, only: inside_t
   use kj_consistent_batch, only: consistent_joint_t
   use kj_joint_types, only: CHART_VECTOR
   use kj_consistent_matrix, only: poses_t, add_moment, put_wrench, N_CONSISTENT_WRENCH
   use kj_consistent_springs, only: add_springs
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   implicit none
   private

   public :: look_inside_consistent

contains

   !> Laws and wrench of an element. The state keeps of a wrench only what the dampers changed last,
   !> so pass 1 of a step is done once more, in the pose as it is and on copies.
   subroutine look_inside_consistent(model, state, element, frame, inside)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: element             !! index into model%joint
      real(wp), intent(in) :: frame(9)           !! the one that is shown, columns, W
      type(inside_t), intent(inout) :: inside

      type(consistent_joint_t) :: joint
      type(poses_t) :: poses
      real(wp), allocatable :: wrench(:, :)
      integer :: from

      associate (b => model%joint(element)%batch, i => model%joint(element)%place)
         associate (batch => model%batch(b), lanes => state%joint(b)%block(block_of(i)))
            inside%told_apart = .true.
            inside%elastic = lanes%fe(lane_of(i), :)
            inside%damping = lanes%fd(lane_of(i), :)
            if (batch%limited) &
               inside%friction = state%joint(b)%limit(block_of(i))%friction(lane_of(i), :)
            if (batch%geometry%plain(i)) then
               call turn(lanes%b%force(lane_of(i), :), inside%elastic)
               call turn(lanes%b%force(lane_of(i), :), inside%damping)
               call turn(lanes%b%force(lane_of(i), :), inside%friction)
            end if
            if (allocated(state%compliant)) then
               call look_inside_compliant(model, state, b, i, inside)
               if (batch%geometry%plain(i)) &
                  call turn(lanes%b%force(lane_of(i), :), inside%elastic)
               return
            end if
            poses = state%poses
            poses%h = 0.0_wp
            poses%psi = 0.0_wp
            joint = state%joint(b)
            wrench = state%wrench
            from = (block_of(i) - 1)*BLOCK + 1
            call add_springs(batch, model%curves, poses, from, min(from + BLOCK - 1, batch%n), &
               joint, wrench)
            inside%force = wrench(1:3, batch%first + i)
            inside%moment = reshape(wrench(4:9, batch%first + i), [3, 2])
         end associate
      end associate

   contains

      !> Forces of the translations, from other axes to the shown frame
      subroutine turn(own, f)
         real(wp), intent(in) :: own(9)
         real(wp), intent(inout) :: f(6)

         f(1:3) = matmul(transpose(reshape(frame, [3, 3])), matmul(reshape(own, [3, 3]), f(1:3)))
      end subroutine turn
   end subroutine look_inside_consistent

   !> The same under the integrator compliant: its multipliers of blocked directions stand with the
   !> elastic forces
   pure subroutine look_inside_compliant(model, state, b, i, inside)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: b, i                !! batch and place
      type(inside_t), intent(inout) :: inside

      real(wp), dimension(BLOCK, 6) :: rows, springs
      real(wp) :: moment(BLOCK, 3), wrench(N_CONSISTENT_WRENCH, BLOCK)

      associate (lanes => state%joint(b)%block(block_of(i)), &
         own => state%compliant%joint(b)%block(block_of(i)), batch => model%batch(b))
         rows = own%force + lanes%fd
         springs = lanes%fe
         if (batch%limited) rows = rows + state%joint(b)%limit(block_of(i))%friction
         inside%elastic = springs(lane_of(i), :) + own%force(lane_of(i), :)
         moment = 0.0_wp
         call add_moment(BLOCK, rows(:, 4:6), lanes%b%turn, moment)
         if (batch%geometry%chart == CHART_VECTOR) then
            call add_moment(BLOCK, springs(:, 4:6), own%rot, moment)
         else
            call add_moment(BLOCK, springs(:, 4:6), lanes%b%turn, moment)
         end if
         call put_wrench(BLOCK, .false., rows(:, 1:3) + springs(:, 1:3), moment, lanes%b, wrench)
         inside%force = wrench(1:3, lane_of(i))
         inside%moment = reshape(wrench(4:9, lane_of(i)), [3, 2])
      end associate
   end subroutine look_inside_compliant

end module kj_consistent_inside
