!> Leads in a legacy cycle, a piece at a time: forces from their joints, turn of the bodies and
!> accelerations, in one go while they are in the cache.
!> Source: docs/theory/legacy.md 2.
module kj_legacy_leads
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_team, only: MOST
   use kj_block, only: BLOCK
   use kj_model, only: model_t
   use kj_legacy_state, only: legacy_state_t, EPS20
   use kj_lead_map, only: gather_wrenches, W_FORCE, W_MOMENT1, W_MOMENT2
   use kj_legacy_load, only: is_loaded
   use kj_gravity, only: add_accelerations
   use kj_legacy_body, only: turn_bodies, linear_accelerations
   use kj_legacy_time_step, only: least_ratio
   implicit none
   private

   public :: gather, gather_and_accelerate, accelerate, accelerate_again

   !> Forces and moments on the leads of a piece, W, and the stiffness that they feel
   type :: load_on_t
      real(wp), dimension(MOST, 3) :: f, m
      real(wp), dimension(MOST) :: kn, kr
   end type load_on_t

contains

   !> Forces on leads and their stiffness, kept
   subroutine gather(model, state, piece)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call sum_joints(model, piece, state, load)
      call keep_load(piece, load, state)
      if (.not. is_loaded(model, state)) return
      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         state%f_own(lo:hi, :) = 0.0_wp
         state%m_own(lo:hi, :) = 0.0_wp
      end associate
   end subroutine gather

   !> Forces on leads, and their accelerations
   subroutine gather_and_accelerate(model, state, piece)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call sum_joints(model, piece, state, load)
      if (state%sampling .or. state%kept(piece)) call keep_load(piece, load, state)
      call accelerate_by(model, piece, load, state)
   end subroutine gather_and_accelerate

   !> The same with forces that `gather` and loads have left
   subroutine accelerate(model, state, piece)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call recall_load(piece, state, load)
      call accelerate_by(model, piece, load, state)
   end subroutine accelerate

   !> Accelerations once more, with other masses
   subroutine accelerate_again(model, state, piece)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call recall_load(piece, state, load)
      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         call add_own(model, lo, hi, load%f, load%m, state)
      end associate
      call accelerate_leads(model, piece, load, state)
   end subroutine accelerate_again

   subroutine sum_joints(model, piece, state, load)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(legacy_state_t), intent(in) :: state
      type(load_on_t), intent(out) :: load

      integer :: n

      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         call gather_wrenches(model%map, state%wrench, state%part, lo, hi, load%f, load%m, &
            load%kn, load%kr)
         n = hi - lo + 1
      end associate
      load%kn(:n) = load%kn(:n) + EPS20
      load%kr(:n) = load%kr(:n) + EPS20
   end subroutine sum_joints

   subroutine keep_load(piece, load, state)
      integer, intent(in) :: piece
      type(load_on_t), intent(in) :: load
      type(legacy_state_t), intent(inout) :: state

      integer :: n

      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         n = hi - lo + 1
         state%f(lo:hi, :) = load%f(:n, :)
         state%m(lo:hi, :) = load%m(:n, :)
         state%kn(lo:hi) = load%kn(:n)
         state%kr(lo:hi) = load%kr(:n)
      end associate
   end subroutine keep_load

   subroutine recall_load(piece, state, load)
      integer, intent(in) :: piece
      type(legacy_state_t), intent(in) :: state
      type(load_on_t), intent(out) :: load

      integer :: n

      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         n = hi - lo + 1
         load%f(:n, :) = state%f(lo:hi, :)
         load%m(:n, :) = state%m(lo:hi, :)
         load%kn(:n) = state%kn(lo:hi)
         load%kr(:n) = state%kr(lo:hi)
      end associate
   end subroutine recall_load

   !> Loads on leads lo..hi themselves join what their joints and secondary nodes give
   pure subroutine add_own(model, lo, hi, f, m, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      real(wp), intent(inout) :: f(lo:, :), m(lo:, :)   !! (>= hi - lo + 1, 3) W
      type(legacy_state_t), intent(in) :: state

      if (.not. is_loaded(model, state)) return
      f(lo:hi, :) = f(lo:hi, :) + state%f_own(lo:hi, :)
      m(lo:hi, :) = m(lo:hi, :) + state%m_own(lo:hi, :)
   end subroutine add_own

   !> Turn of the bodies, accelerations, and what limits the step; impulses of the forces on
   !> secondary nodes, as the Radioss time history keeps them
   subroutine accelerate_by(model, piece, load, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(load_on_t), intent(inout) :: load
      type(legacy_state_t), intent(inout) :: state

      integer :: lo, hi, last, from, to

      lo = state%team%lead(1, piece)
      hi = state%team%lead(2, piece)
      last = min(hi, model%n_body)
      state%fastest(piece) = 0.0_wp
      do from = lo, last, BLOCK
         to = min(from + BLOCK - 1, last)
         call add_impulses(from, to, load%f(from - lo + 1:, :), load%m(from - lo + 1:, :), state)
         if (any(state%sprung(from:to))) call take_back(model, from, to, state)
         call add_own(model, from, to, load%f(from - lo + 1:, :), load%m(from - lo + 1:, :), state)
         call turn_bodies(from, to, load%m(from - lo + 1:, :), state, state%fastest(piece))
      end do
      call add_own(model, max(lo, last + 1), hi, load%f(max(lo, last + 1) - lo + 1:, :), &
         load%m(max(lo, last + 1) - lo + 1:, :), state)
      state%finite(piece) = all(ieee_is_finite(state%al(lo:last, 1)))
      call accelerate_leads(model, piece, load, state)
      if (model%control%nodal_step .or. model%control%joint_step) call least_ratio(model, state, &
         lo, hi, load%kn, load%kr, state%least(piece), state%least_at(piece))
   end subroutine accelerate_by

   !> Sums over time of forces and moments on bodies lo..hi
   pure subroutine add_impulses(lo, hi, f, m, state)
      integer, intent(in) :: lo, hi
      real(wp), intent(in) :: f(lo:, :), m(lo:, :)   !! (>= hi - lo + 1, 3) W
      type(legacy_state_t), intent(inout) :: state

      integer :: k

      do k = 1, 3
         state%impulse(lo:hi, k) = state%impulse(lo:hi, k) + state%h1*f(lo:hi, k)
         state%angular_impulse(lo:hi, k) = state%angular_impulse(lo:hi, k) + state%h1*m(lo:hi, k)
      end do
   end subroutine add_impulses

   !> Forces of springs on main nodes of bodies lo..hi are no part of the sums over time
   pure subroutine take_back(model, lo, hi, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: lo, hi
      type(legacy_state_t), intent(inout) :: state

      real(wp) :: f(3), m(3)
      integer :: b, i, j, e

      do b = lo, hi
         if (.not. state%sprung(b)) cycle
         f = 0.0_wp
         m = 0.0_wp
         do i = model%map%first(b), model%map%first(b + 1) - 1
            j = abs(model%map%joint(i))
            e = merge(1, 2, model%map%joint(i) > 0)
            if (.not. state%on_main(e, j)) cycle
            if (e == 1) f = f + state%wrench(W_FORCE:W_FORCE + 2, j)
            if (e == 2) f = f - state%wrench(W_FORCE:W_FORCE + 2, j)
            m = m + state%wrench(merge(W_MOMENT1, W_MOMENT2, e == 1): &
               merge(W_MOMENT1, W_MOMENT2, e == 1) + 2, j)
         end do
         state%impulse(b, :) = state%impulse(b, :) - state%h1*f
         state%angular_impulse(b, :) = state%angular_impulse(b, :) - state%h1*m
      end do
   end subroutine take_back

   subroutine accelerate_leads(model, piece, load, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(load_on_t), intent(in) :: load
      type(legacy_state_t), intent(inout) :: state

      integer :: i

      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         call linear_accelerations(model%n_body, lo, hi, load%f, load%m, state)
         do i = 1, size(state%field)
            call add_accelerations(lo, hi, size(state%a, 1), size(state%v, 1), state%mass, &
               state%v, state%field(i), state%a)
         end do
      end associate
   end subroutine accelerate_leads

end module kj_legacy_leads
