!> Leads in a legacy cycle, a piece at a time: forces from their joints, turn of the bodies and
!> accelerations, in one go while they are in the cache.
!> Source: legacy_scheme.md 3.
module kj_leads
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_team, only: MOST
   use kj_model, only: model_t
   use kj_state, only: state_t, EPS20
   use kj_assembly, only: gather_wrenches
   use kj_load, only: is_loaded
   use kj_gravity, only: add_accelerations
   use kj_body, only: turn_bodies, linear_accelerations
   use kj_time_step, only: least_ratio
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
      type(state_t), intent(inout) :: state
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
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call sum_joints(model, piece, state, load)
      if (state%sampling .or. state%kept(piece)) call keep_load(piece, load, state)
      call accelerate_by(model, piece, load, state)
   end subroutine gather_and_accelerate

   !> The same with forces that `gather` and loads have left
   subroutine accelerate(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call recall_load(piece, state, load)
      call accelerate_by(model, piece, load, state)
   end subroutine accelerate

   !> Accelerations once more, with other masses
   subroutine accelerate_again(model, state, piece)
      type(model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer, intent(in) :: piece

      type(load_on_t) :: load

      call recall_load(piece, state, load)
      call add_own(model, piece, state, load)
      call accelerate_leads(model, piece, load, state)
   end subroutine accelerate_again

   subroutine sum_joints(model, piece, state, load)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(state_t), intent(in) :: state
      type(load_on_t), intent(out) :: load

      integer :: n

      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         call gather_wrenches(model%map, state%wrench, state%plan%ready(:, 1), state%part, &
            lo, hi, load%f, load%m, load%kn, load%kr)
         n = hi - lo + 1
      end associate
      load%kn(:n) = load%kn(:n) + EPS20
      load%kr(:n) = load%kr(:n) + EPS20
   end subroutine sum_joints

   subroutine keep_load(piece, load, state)
      integer, intent(in) :: piece
      type(load_on_t), intent(in) :: load
      type(state_t), intent(inout) :: state

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
      type(state_t), intent(in) :: state
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

   !> Loads on the leads themselves join what their joints and secondary nodes give
   subroutine add_own(model, piece, state, load)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(state_t), intent(in) :: state
      type(load_on_t), intent(inout) :: load

      integer :: n

      if (.not. is_loaded(model, state)) return
      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         n = hi - lo + 1
         load%f(:n, :) = load%f(:n, :) + state%f_own(lo:hi, :)
         load%m(:n, :) = load%m(:n, :) + state%m_own(lo:hi, :)
      end associate
   end subroutine add_own

   !> Turn of the bodies, accelerations, and what limits the step; impulses of the forces on
   !> secondary nodes, as the Radioss time history keeps them
   subroutine accelerate_by(model, piece, load, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(load_on_t), intent(inout) :: load
      type(state_t), intent(inout) :: state

      integer :: lo, hi, last, n, k

      lo = state%team%lead(1, piece)
      hi = state%team%lead(2, piece)
      last = min(hi, model%n_body)
      n = last - lo + 1
      do k = 1, 3
         state%impulse(lo:last, k) = state%impulse(lo:last, k) + state%h1*load%f(:n, k)
         state%angular_impulse(lo:last, k) = state%angular_impulse(lo:last, k) + &
            state%h1*load%m(:n, k)
      end do
      call add_own(model, piece, state, load)
      call turn_bodies(lo, last, load%m, state, state%fastest(piece))
      state%finite(piece) = all(ieee_is_finite(state%al(lo:last, 1)))
      call accelerate_leads(model, piece, load, state)
      if (model%control%nodal_step .or. model%control%joint_step) call least_ratio(model, state, &
         lo, hi, load%kn, load%kr, state%least(piece), state%least_at(piece))
   end subroutine accelerate_by

   subroutine accelerate_leads(model, piece, load, state)
      type(model_t), intent(in) :: model
      integer, intent(in) :: piece
      type(load_on_t), intent(in) :: load
      type(state_t), intent(inout) :: state

      integer :: i

      associate (lo => state%team%lead(1, piece), hi => state%team%lead(2, piece))
         call linear_accelerations(model%n_body, lo, hi, load%f, load%m, state)
         do i = 1, size(state%field)
            call add_accelerations(lo, hi, size(state%a, 1), size(state%v, 1), state%mass, &
               state%v, state%field(i), state%a)
         end do
      end associate
   end subroutine accelerate_leads

end module kj_leads
