!> Energies and momenta of a legacy state, with velocities advanced to t(n).
!> Source: legacy_scheme.md 5.
module kj_energy
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_model, only: model_t, load_t
   use kj_state, only: state_t
   use kj_skew, only: axis_of
   implicit none
   private

   public :: balance_t, balance_of, energy_error

   !> Sums over a scene
   type :: balance_t
      real(wp) :: kinetic_trans = 0.0_wp, kinetic_rot = 0.0_wp
      real(wp) :: internal = 0.0_wp
      real(wp) :: potential = 0.0_wp             !! of constant gravity, 0 at the start
      real(wp) :: momentum(3) = 0.0_wp, angular_momentum(3) = 0.0_wp   !! about the origin
      real(wp) :: mass = 0.0_wp
   end type balance_t

contains

   !> Sums over the leads, in their order
   function balance_of(model, state) result(b)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(balance_t) :: b

      real(wp) :: v(3), w(3), spin(3)
      integer :: i, k

      do i = 1, model%n_lead
         v = state%v(i, :) + 0.5_wp*state%h1*state%a(i, :)
         w = state%world%w(i, :) + 0.5_wp*state%h1*state%al(i, :)
         spin = spin_of(model, state, i, w)
         b%kinetic_trans = b%kinetic_trans + 0.5_wp*state%mass(i)*dot_product(v, v)
         b%kinetic_rot = b%kinetic_rot + 0.5_wp*dot_product(w, spin)
         b%momentum = b%momentum + state%mass(i)*v
         b%angular_momentum = b%angular_momentum + spin + &
            state%mass(i)*cross(state%world%x(i, :), v)
         b%mass = b%mass + state%mass(i)
      end do
      do k = 1, size(state%joint)
         b%internal = b%internal + sum(state%joint(k)%energy)
      end do
      do k = 1, size(model%gravity)
         b%potential = b%potential + potential_of(model, state, model%gravity(k))
      end do
   end function balance_of

   !> Spin J w of a lead about itself
   pure function spin_of(model, state, lead, w) result(l)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      integer, intent(in) :: lead
      real(wp), intent(in) :: w(3)
      real(wp) :: l(3)

      real(wp) :: part
      integer :: k

      l = state%inertia(lead)*w
      if (lead > model%n_body) return
      l = 0.0_wp
      do k = 1, 3
         part = state%principal(lead, k)*dot_product(w, state%p(lead, 3*k - 2:3*k))
         l = l + part*state%p(lead, 3*k - 2:3*k)
      end do
   end function spin_of

   !> Potential -m g.d of a gravity card; 0 for one that changes with time or turns
   pure real(wp) function potential_of(model, state, load) result(u)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(load_t), intent(in) :: load

      real(wp) :: g(3), y
      integer :: k, lead

      u = 0.0_wp
      if (load%sensed) return
      y = load%y_scale
      if (load%curve > 0) then
         associate (values => model%curves%y(model%curves%first(load%curve): &
            model%curves%first(load%curve + 1) - 1))
            if (maxval(values) > minval(values)) return
            y = y*values(1)
         end associate
      end if
      if (load%skew > 0) then
         if (model%skews%node(1, load%skew) > 0) return
      end if
      g = y*axis_of(state%world%skew, load%skew, load%dir)
      do k = 1, size(load%node)
         lead = load%node(k)
         u = u - state%mass(lead)*dot_product(g, state%world%x(lead, :) - model%x0(lead, :))
      end do
   end function potential_of

   !> Energy error of the legacy scheme as a fraction: E/(E0 + W) - 1, between -0.999 and 0.999
   pure real(wp) function energy_error(state, b) result(e)
      type(state_t), intent(in) :: state
      type(balance_t), intent(in) :: b

      e = 0.0_wp
      if (abs(state%energy0 + state%work) < 1.0e-20_wp) return
      e = (b%kinetic_trans + b%kinetic_rot + b%internal)/(state%energy0 + state%work) - 1.0_wp
      e = max(-0.999_wp, min(0.999_wp, e))
   end function energy_error

end module kj_energy
