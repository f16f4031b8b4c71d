!> What single joints do inside under the legacy scheme.
module kj_legacy_inside
   use kj_kinds, only: wp
   use kj_block, only: block_of, lane_of
   use kj_lead_map, only: sum_hubs, gather_wrenches, W_FORCE, W_MOMENT1, W_MOMENT2
   use kj_model, only: model_t
   use kj_snapshot, only: inside_t
   use kj_legacy_state, only: legacy_state_t
   implicit none
   private

   public :: look_inside_legacy, legacy_stiffness

contains

   !> Wrench and friction of an element; spring and damper are one sum here
   subroutine look_inside_legacy(model, state, element, inside)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: element             !! index into model%joint
      type(inside_t), intent(inout) :: inside

      associate (b => model%joint(element)%batch, i => model%joint(element)%place)
         if (model%batch(b)%limited) &
            inside%friction = state%joint(b)%limit(block_of(i))%friction(lane_of(i), :)
         associate (w => state%wrench(:, model%batch(b)%first + i))
            inside%force = w(W_FORCE:W_FORCE + 2)
            inside%moment(:, 1) = w(W_MOMENT1:W_MOMENT1 + 2)
            inside%moment(:, 2) = w(W_MOMENT2:W_MOMENT2 + 2)
         end associate
      end associate
   end subroutine look_inside_legacy

   !> Time-step stiffness of a lead, translation and rotation
   subroutine legacy_stiffness(model, state, lead, kn, kr)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp), intent(out) :: kn, kr

      real(wp) :: f(1, 3), m(1, 3), k(1), r(1), part(size(state%part, 1), size(state%part, 2))

      call sum_hubs(model%map, 1, state%wrench, part)
      call gather_wrenches(model%map, state%wrench, part, lead, lead, f, m, k, r)
      kn = k(1)
      kr = r(1)
   end subroutine legacy_stiffness

end module kj_legacy_inside
