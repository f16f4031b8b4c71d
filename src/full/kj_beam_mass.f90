!> Inertia of beams at their nodes. Source: docs/theory/full.md 2.4.
module kj_beam_mass
   use kj_kinds, only: wp
   use kj_full_property, only: section_t
   implicit none
   private

   public :: beam_inertia

contains

   !> Spherical inertia of each end of a beam: that of a slender rod 1.2 times as long, not below
   !> what its section has about its axis; more for short ones, which shear
   pure real(wp) function beam_inertia(s, length, density, nu, elastic) result(inertia)
      type(section_t), intent(in) :: s
      real(wp), intent(in) :: length, density
      real(wp), intent(in) :: nu
      logical, intent(in) :: elastic             !! nu is known; else nothing is said of shear

      real(wp) :: m, b, f, c, p, k, h

      inertia = 0.0_wp
      b = max(s%iyy, s%izz)
      if (.not. length > 0.0_wp) return
      m = 0.5_wp*density*s%area*length
      inertia = 1.2_wp*m*(1.2_wp*length)**2/12.0_wp + 0.5_wp*density*length*b
      if (b > 0.0_wp) then
         f = s%area*length**2/(12.0_wp*b)
         if (s%integrated .and. 12.0_wp*f > 12.0_wp) inertia = 1.2_wp*m*(1.2_wp*length)**2 + &
            0.5_wp*density*length*b
         if (f < 1.0_wp .and. elastic) then
            c = 1.2_wp*2.0_wp*(1.0_wp + nu)
            p = c/f*min(s%iyy, s%izz)/b
            k = (4.0_wp + p)/(1.0_wp + p)
            h = max(1.0_wp, k/(1.0_wp + f))
            inertia = h*inertia
         end if
      end if
      inertia = max(inertia, 0.5_wp*density*length*s%ixx)
   end function beam_inertia

end module kj_beam_mass
