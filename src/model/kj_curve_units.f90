!> Functions of joints where input and work units differ.
module kj_curve_units
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_WARNING
   use kj_units, only: dimensions, D_LENGTH, D_MASS, D_TIME, D_FORCE, D_MOMENT, D_STIFFNESS, &
      D_ROT_STIFFNESS, D_DAMPING, D_ROT_DAMPING
   use kj_curve, only: add_curve
   use kj_joint_types, only: NDOF, DOF_NAME
   use kj_deck_text, only: deck_t, block_factors
   use kj_cards, only: cards_t, report
   use kj_draft, only: draft_t
   use kj_joint_draft, only: property_t
   implicit none
   private

   public :: convert_functions, convert_abscissae

contains

   !> Scales and functions of a /PROP/KJOINT in work units.
   !>
   !> A function has abscissae in input units; its scale K or C is a force (moment) in input units
   !> that was read as a stiffness (damping). OpenRadioss, and so the legacy formulation, has other
   !> factors: K and C get M/T (1/T for rotations) on top, abscissae are displacement L/T,
   !> velocity L, angle 1, angular velocity T.
   !> Source: docs/theory/deck.md 2.2.
   subroutine convert_functions(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft      !! gets curves whose abscissae are converted
      type(property_t), intent(inout) :: p       !! scales as read, 0 = 1
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: f(size(dimensions)), x(2), y(2)
      integer :: dof

      f = block_factors(deck, cards%block)
      do dof = 1, NDOF
         if (draft%legacy) then
            x = [f(D_TIME)/f(D_LENGTH), 1.0_wp/f(D_LENGTH)]
            y = f(D_MASS)/f(D_TIME)
            if (dof > 3) x = [1.0_wp, 1.0_wp/f(D_TIME)]
            if (dof > 3) y = 1.0_wp/f(D_TIME)
            call warn('K', p%k_curve(dof), x(1), y(1))
            call warn('C', p%c_curve(dof), x(2), y(2))
         else
            x = f(D_FORCE)/[f(D_STIFFNESS), f(D_DAMPING)]
            if (dof > 3) x = f(D_MOMENT)/[f(D_ROT_STIFFNESS), f(D_ROT_DAMPING)]
            y = x
         end if
         call convert(p%k(dof), p%k_curve(dof), x(1), y(1))
         call convert(p%c(dof), p%c_curve(dof), x(2), y(2))
      end do

   contains

      subroutine convert(scale, curve, x, y)
         real(wp), intent(inout) :: scale
         integer, intent(inout) :: curve
         real(wp), intent(in) :: x, y

         if (curve == 0) return
         if (abs(scale) <= 0.0_wp) then
            scale = 1.0_wp
            if (.not. draft%legacy) scale = f(merge(D_FORCE, D_MOMENT, dof <= 3))/y
         end if
         scale = scale*y
         call convert_abscissae(draft, x, curve)
      end subroutine convert

      subroutine warn(letter, curve, x, y)
         character(len=1), intent(in) :: letter
         integer, intent(in) :: curve
         real(wp), intent(in) :: x, y

         if (curve == 0 .or. (is_one(x) .and. is_one(y))) return
         call report(deck, cards, 'f_'//letter//DOF_NAME(dof), SEV_WARNING, 'KJ-9210', &
            'the legacy scheme has wrong unit factors where a joint has functions', &
            'input and work units differ', findings, &
            hint='use the same input and work units, or run the consistent formulation')
      end subroutine warn
   end subroutine convert_functions

   !> Put a copy of the curve with scaled abscissae in its place; none where the factor is 1
   subroutine convert_abscissae(draft, factor, curve)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: factor             !! input unit / work unit of the abscissa
      integer, intent(inout) :: curve            !! index

      real(wp), allocatable :: x(:), y(:)
      integer :: first, last, id

      if (is_one(factor)) return
      first = draft%curves%first(curve)
      last = draft%curves%first(curve + 1) - 1
      x = factor*draft%curves%x(first:last)
      y = draft%curves%y(first:last)
      id = draft%curves%id(curve)   ! the set grows: no reference into it
      call add_curve(draft%curves, id, x, y)
      curve = draft%curves%n
   end subroutine convert_abscissae

   pure logical function is_one(factor)
      real(wp), intent(in) :: factor

      is_one = abs(factor - 1.0_wp) <= 8.0_wp*epsilon(1.0_wp)
   end function is_one

end module kj_curve_units
