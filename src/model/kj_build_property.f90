!> Cards -> properties of joints, /PROP/KJOINT and /PROP/KJOINT2, and their functions in work units.
!> Source: docs/theory/deck.md 5.1 and 5.2.
module kj_build_property
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_units, only: dimensions, D_LENGTH, D_MASS, D_TIME, D_FORCE, D_STIFFNESS, D_DAMPING, &
      D_MOMENT, D_ROT_STIFFNESS, D_ROT_DAMPING
   use kj_curve, only: add_curve
   use kj_joint_types, only: joint_types, find_joint_type, known_types, NDOF, DOF_NAME, &
      FRAME_MEAN, FRAME_FIRST, FRAME_CROSS
   use kj_joint_batch, only: KJOINT, KJOINT2, has_friction
   use kj_keywords, only: KW_KJOINT, KW_KJOINT2
   use kj_card_fields, only: fields
   use kj_deck_text, only: deck_t, block_factors
   use kj_cards, only: cards_t, real_of, int_of, report, report_cut_deck
   use kj_draft, only: draft_t, property_t, reference
   implicit none
   private

   public :: read_property, convert_abscissae

   character(len=7), parameter :: ID_FUNCTION = 'KJ-3126'

contains

   !> Check one property; row stays 0 when the type is not known
   subroutine read_property(draft, cards, p)
      type(draft_t), intent(inout) :: draft      !! gets curves whose abscissae are converted
      type(cards_t), intent(in) :: cards
      type(property_t), intent(out) :: p

      logical :: second

      second = draft%deck%block(cards%block)%keyword == KW_KJOINT2
      p%id = draft%deck%block(cards%block)%id
      p%kind = merge(KJOINT2, KJOINT, second)
      call report_cut_deck(draft%deck, cards)
      p%row = find_joint_type(int_of(cards, 'type'))
      if (p%row == 0) then
         call report(draft%deck, cards, 'type', SEV_ERROR, merge('KJ-0938', 'KJ-0409', second), &
            'there is no joint type '//str(int_of(cards, 'type')), 'expected: '//known_types())
         return
      end if
      if (.not. second .and. int_of(cards, 'skew_1') <= 0) call report(draft%deck, cards, &
         'skew_1', SEV_ERROR, 'KJ-0386', 'the joint has no skew on body 1', &
         'expected: id of a moving skew')
      p%skew(1) = reference(draft%deck, cards, 'skew_1', draft%skew, 'skew', 'KJ-0926')
      p%skew(2) = reference(draft%deck, cards, 'skew_2', draft%skew, 'skew', 'KJ-0926')
      p%kn = real_of(cards, 'Kn')
      p%cr = real_of(cards, 'Cr')
      if (p%cr < 0.0_wp .or. p%cr > 1.0_wp) call report(draft%deck, cards, 'Cr', SEV_ERROR, &
         'KJ-0388', 'Cr, twice the damping ratio, is not between 0 and 1', &
         'expected: 0 to 1; 1 is half of the critical damping')
      p%cr_stop = p%cr
      if (abs(p%cr) <= 0.0_wp) p%cr = merge(0.05_wp, 1.0_wp, draft%legacy)
      p%frame = joint_types(p%row)%frame
      if (second) then
         call read_kjoint2(draft, cards, p)
      else
         call read_kjoint(draft, cards, p)
      end if
   end subroutine read_property

   !> What /PROP/KJOINT has beside
   subroutine read_kjoint(draft, cards, p)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(property_t), intent(inout) :: p

      integer :: dof

      if (all(joint_types(p%row)%free == 1)) then
         p%cr = 0.0_wp
      else if (abs(p%kn) <= 0.0_wp) then
         call report(draft%deck, cards, 'Kn', SEV_ERROR, 'KJ-0387', &
            'the blocking stiffness is zero', 'expected: a positive stiffness')
      else if (p%kn < 0.0_wp) then
         call report(draft%deck, cards, 'Kn', SEV_ERROR, 'KJ-9118', &
            'the blocking stiffness is negative', 'expected: a positive stiffness')
      end if
      call check_cards(draft%deck, cards, p)
      call choose_frame(draft, cards, p)
      do dof = 1, NDOF
         if (joint_types(p%row)%free(dof) == 1) call read_laws(draft, cards, dof, DOF_NAME(dof), p)
      end do
      call convert_functions(draft, cards, p)
   end subroutine read_kjoint

   !> The card of Kn must be there; those behind it may be missing, which is said
   subroutine check_cards(deck, cards, p)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      type(property_t), intent(in) :: p

      logical :: mine(size(fields))
      integer :: needed, most

      mine = fields%keyword == KW_KJOINT .and. fields%variant == joint_types(p%row)%id
      most = maxval(fields%card, mask=mine)
      needed = min(most, 3)
      if (all(joint_types(p%row)%free == 1)) needed = 2      ! a free joint may have no law at all
      if (cards%n_card >= most .or. cards%n_card == 0) return
      if (cards%n_card >= needed) then
         call report(deck, cards, 'type', SEV_WARNING, 'KJ-9072', 'the last cards are '// &
            'missing: a joint of type '//str(int_of(cards, 'type'))//' has '//str(most), &
            'here are '//str(cards%n_card)//'; the others are read as blank', &
            'blank cards say that nothing is meant')
         return
      end if
      call report(deck, cards, 'type', SEV_ERROR, 'KJ-9071', 'a joint of type '// &
         str(int_of(cards, 'type'))//' has '//str(most)//' cards, here are '// &
         str(cards%n_card), 'needed: '//str(needed)//' at least')
   end subroutine check_cards

   !> What /PROP/KJOINT2 has beside. K and C are forces where a function stands; then abscissae are
   !> in input units, and a scale 0 means 1.
   subroutine read_kjoint2(draft, cards, p)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(property_t), intent(inout) :: p

      real(wp) :: factor(size(dimensions)), per(2)
      integer :: dof, n_dof, sensor

      if (p%kn < 0.0_wp) call report(draft%deck, cards, 'Kn', SEV_ERROR, 'KJ-9118', &
         'the blocking stiffness is negative', 'expected: a positive stiffness, or 0')
      p%automatic = p%kn < 0.5_wp
      p%scf = real_of(cards, 'SCF')
      if (p%scf < 0.0_wp) call report(draft%deck, cards, 'SCF', SEV_ERROR, 'KJ-0939', &
         'the scale of the blocked rotations is negative', 'expected: a positive number, or 0')
      if (abs(p%scf) <= 0.0_wp) p%scf = merge(10.0_wp, 1.0_wp, p%kn > 0.0_wp)
      sensor = reference(draft%deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-0521')
      if (sensor > 0) p%t_lock = draft%sensors(sensor)%t_start
      if (sensor > 0) p%t_free = draft%sensors(sensor)%t_stop
      n_dof = sum(joint_types(p%row)%free)
      if (cards%n_card > 1 .and. cards%n_card < 1 + 3*n_dof) call report(draft%deck, cards, &
         'type', SEV_ERROR, 'KJ-0973', 'a joint of type '//str(int_of(cards, 'type'))//' has '// &
         str(3*n_dof)//' cards of directions, here are '//str(cards%n_card - 1), &
         'expected: all of them, or none')
      factor = block_factors(draft%deck, cards%block)
      do dof = 1, NDOF
         if (joint_types(p%row)%free(dof) == 0) cycle
         call read_laws(draft, cards, dof, '_'//DOF_NAME(dof), p)
         per = factor(D_FORCE)/[factor(D_STIFFNESS), factor(D_DAMPING)]
         if (dof > 3) per = factor(D_MOMENT)/[factor(D_ROT_STIFFNESS), factor(D_ROT_DAMPING)]
         call convert_function(draft, per(1), per(1), 1.0_wp, p%k(dof), p%k_curve(dof))
         call convert_function(draft, per(2), per(2), 1.0_wp, p%c(dof), p%c_curve(dof))
         call read_limits(draft, cards, factor, dof, p)
      end do
      call combine_stops(draft%deck, cards, 1, 3, 'KJ-1599', p)
      call combine_stops(draft%deck, cards, 4, 6, 'KJ-1600', p)
      p%limited = p%automatic .or. p%t_lock < huge(1.0_wp) .or. any(p%lo < 0.0_wp) .or. &
         any(p%hi > 0.0_wp) .or. any(has_friction(p%k_limit, p%slip, p%slip_curve))
   end subroutine read_kjoint2

   !> Stiffness, damping and their functions of one direction; its fields end in `suffix`
   subroutine read_laws(draft, cards, dof, suffix, p)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: dof
      character(len=*), intent(in) :: suffix
      type(property_t), intent(inout) :: p

      p%k(dof) = real_of(cards, 'K'//suffix)
      p%c(dof) = real_of(cards, 'C'//suffix)
      p%k_curve(dof) = reference(draft%deck, cards, 'f_K'//suffix, draft%curve, 'function', &
         ID_FUNCTION)
      p%c_curve(dof) = reference(draft%deck, cards, 'f_C'//suffix, draft%curve, 'function', &
         ID_FUNCTION)
   end subroutine read_laws

   !> Frame rule of a property, and the checks of its skews
   subroutine choose_frame(draft, cards, p)
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(inout) :: p

      real(wp) :: dot

      p%frame = joint_types(p%row)%frame
      if (p%frame == FRAME_CROSS) then
         if (int_of(cards, 'skew_2') == 0) call report(draft%deck, cards, 'skew_2', SEV_ERROR, &
            'KJ-0926', 'a universal joint needs a skew on body 2', 'expected: id of a moving skew')
         if (any(p%skew == 0)) return
         dot = dot_product(draft%skews%axes(p%skew(1), 1:3), draft%skews%axes(p%skew(2), 1:3))
         if (dot > 1.0e-10_wp) call report(draft%deck, cards, 'skew_2', SEV_ERROR, 'KJ-0389', &
            'the x axes of the two skews of a universal joint are not perpendicular: '// &
            trim(angle_text(dot))//' degrees', 'expected: 90 degrees to skew_1')
         return
      end if
      if (int_of(cards, 'skew_flag') == 1) p%frame = FRAME_FIRST
      if (p%frame == FRAME_MEAN .and. int_of(cards, 'skew_2') == 0) then
         p%frame = FRAME_FIRST
         call report(draft%deck, cards, 'skew_2', SEV_WARNING, 'KJ-9119', &
            'without a second skew the joint frame is that of body 1 (as skew flag 1)', &
            'no skew on body 2', &
            hint='OpenRadioss works on undefined data here: set the skew flag to 1')
      end if
   end subroutine choose_frame

   function angle_text(cosine) result(text)
      real(wp), intent(in) :: cosine
      character(len=12) :: text

      write (text, '(f12.4)') acos(max(-1.0_wp, min(1.0_wp, cosine)))*45.0_wp/atan(1.0_wp)
      text = adjustl(text)
   end function angle_text

   !> Stops and friction of a free direction
   subroutine read_limits(draft, cards, factor, dof, p)
      type(cards_t), intent(in) :: cards
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: dof
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(inout) :: p

      character(len=2) :: d

      d = DOF_NAME(dof)
      p%lo(dof) = real_of(cards, 'SA-_'//d)
      p%hi(dof) = real_of(cards, 'SA+_'//d)
      if (p%lo(dof) > 0.0_wp) call report(draft%deck, cards, 'SA-_'//d, SEV_ERROR, 'KJ-0943', &
         'the lower stop is positive', 'expected: a negative value, or 0 for none')
      if (p%hi(dof) < 0.0_wp) call report(draft%deck, cards, 'SA+_'//d, SEV_ERROR, 'KJ-0944', &
         'the upper stop is negative', 'expected: a positive value, or 0 for none')
      call warn_of_degrees(draft%deck, cards, 'SA-_'//d, p, dof)
      call warn_of_degrees(draft%deck, cards, 'SA+_'//d, p, dof)
      p%k_limit(dof) = real_of(cards, 'Kfr_'//d)
      p%slip(dof) = real_of(cards, 'FM_'//d)
      p%slip_curve(dof) = reference(draft%deck, cards, 'f_FM_'//d, draft%curve, 'function', &
         ID_FUNCTION)
      call refuse_negative(draft%deck, cards, 'Kfr_'//d, 'the stiffness of friction')
      call refuse_negative(draft%deck, cards, 'FM_'//d, 'the limit of friction')
      if (p%slip_curve(dof) > 0) then
         if (abs(p%slip(dof)) <= 0.0_wp) p%slip(dof) = 1.0_wp
         if (dof <= 3) call convert_abscissae(draft, factor(D_LENGTH), p%slip_curve(dof))
      end if
      if (p%slip(dof) > 0.0_wp .and. .not. has_friction(p%k_limit(dof), p%slip(dof), &
         p%slip_curve(dof))) call report(draft%deck, cards, 'Kfr_'//d, SEV_WARNING, 'KJ-0979', &
         'a limit of friction without a stiffness: there is no friction', 'expected: a stiffness')
   end subroutine read_limits

   !> A stop of a rotation beyond what an angle can be, as one typed in degrees is: a turn for one
   !> axis, half a turn where there are several
   subroutine warn_of_degrees(deck, cards, name, p, dof)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name
      type(property_t), intent(in) :: p
      integer, intent(in) :: dof

      real(wp), parameter :: TURN = 8.0_wp*atan(1.0_wp), NONE = 1.0e4_wp   ! beyond: no stop meant
      character(len=24) :: angle, turns
      real(wp) :: most

      if (dof <= 3) return
      most = merge(TURN, 0.5_wp*TURN, sum(joint_types(p%row)%free(4:)) == 1)
      if (.not. abs(real_of(cards, name)) > most .or. abs(real_of(cards, name)) > NONE) return
      write (angle, '(f24.1)') real_of(cards, name)
      write (turns, '(f24.1)') abs(real_of(cards, name))/TURN
      call report(deck, cards, name, SEV_WARNING, 'KJ-9076', 'a stop of '// &
         trim(adjustl(angle))//' rad is '//trim(adjustl(turns))//' turns: is it in degrees?', &
         'expected: an angle in rad', 'degrees times 0.0174533 are rad')
   end subroutine warn_of_degrees

   subroutine refuse_negative(deck, cards, name, what)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name, what

      if (real_of(cards, name) >= 0.0_wp) return
      call report(deck, cards, name, SEV_ERROR, 'KJ-9126', what//' is negative', &
         'expected: a positive value, or 0 for none')
   end subroutine refuse_negative

   !> Stops that Icomb combines to a circle or sphere: directions first to last
   subroutine combine_stops(deck, cards, first, last, id, p)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: first, last         !! dofs
      character(len=*), intent(in) :: id         !! of the message on a single direction
      type(property_t), intent(inout) :: p

      integer :: dof, icomb(NDOF), at

      icomb = 0
      do dof = first, last
         icomb(dof) = int_of(cards, 'Icomb_'//DOF_NAME(dof))
      end do
      if (all(icomb == 0)) return
      at = findloc(icomb /= 0, .true., 1)
      if (count(icomb /= 0) == 1) then
         call report(deck, cards, 'Icomb_'//DOF_NAME(at), SEV_ERROR, id, &
            'Icomb is set on a single direction', 'expected: on two or three, or on none')
         return
      end if
      if (any(icomb /= 0 .and. icomb /= icomb(at))) call report(deck, cards, 'Icomb_'// &
         DOF_NAME(at), SEV_ERROR, 'KJ-1598', &
         'Icomb differs between the directions that it combines', 'expected: one value')
      do dof = first, last
         if (icomb(dof) == 0) cycle
         if (p%lo(dof) < 0.0_wp .or. p%hi(dof) > 0.0_wp) then
            p%combined(dof) = 1
         else
            call report(deck, cards, 'Icomb_'//DOF_NAME(dof), SEV_WARNING, 'KJ-9127', &
               'a direction without stops has nothing to combine', 'ignored')
         end if
      end do
      if (count(p%combined(first:last) == 1) == 1) p%combined(first:last) = 0
   end subroutine combine_stops

   !> Scales and functions of a /PROP/KJOINT in work units.
   !>
   !> A function has abscissae in input units; its scale K or C is a force (moment) in input units
   !> that was read as a stiffness (damping). OpenRadioss, and so the legacy formulation, has other
   !> factors: K and C get M/T (1/T for rotations) on top, abscissae are displacement L/T,
   !> velocity L, angle 1, angular velocity T.
   !> Source: docs/theory/deck.md 2.2.
   subroutine convert_functions(draft, cards, p)
      type(draft_t), intent(inout) :: draft      !! gets curves whose abscissae are converted
      type(cards_t), intent(in) :: cards
      type(property_t), intent(inout) :: p       !! scales as read, 0 = 1

      real(wp) :: f(size(dimensions)), x(2), y(2), one(2)
      integer :: dof

      f = block_factors(draft%deck, cards%block)
      do dof = 1, NDOF
         if (draft%legacy) then
            x = [f(D_TIME)/f(D_LENGTH), 1.0_wp/f(D_LENGTH)]
            y = f(D_MASS)/f(D_TIME)
            if (dof > 3) x = [1.0_wp, 1.0_wp/f(D_TIME)]
            if (dof > 3) y = 1.0_wp/f(D_TIME)
            one = y
            call warn('K', p%k_curve(dof), x(1), y(1))
            call warn('C', p%c_curve(dof), x(2), y(2))
         else
            x = f(D_FORCE)/[f(D_STIFFNESS), f(D_DAMPING)]
            if (dof > 3) x = f(D_MOMENT)/[f(D_ROT_STIFFNESS), f(D_ROT_DAMPING)]
            y = x
            one = f(merge(D_FORCE, D_MOMENT, dof <= 3))
         end if
         call convert_function(draft, x(1), y(1), one(1), p%k(dof), p%k_curve(dof))
         call convert_function(draft, x(2), y(2), one(2), p%c(dof), p%c_curve(dof))
      end do

   contains

      subroutine warn(letter, curve, x, y)
         character(len=1), intent(in) :: letter
         integer, intent(in) :: curve
         real(wp), intent(in) :: x, y

         if (curve == 0 .or. (is_one(x) .and. is_one(y))) return
         call report(draft%deck, cards, 'f_'//letter//DOF_NAME(dof), SEV_WARNING, 'KJ-9210', &
            'the legacy scheme has wrong unit factors where a joint has functions', &
            'input and work units differ', &
            hint='use the same input and work units, or run the consistent formulation')
      end subroutine warn
   end subroutine convert_functions

   !> Scale of a function and its abscissae in work units
   subroutine convert_function(draft, x, y, one, scale, curve)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: x, y               !! factors of abscissae and scale
      real(wp), intent(in) :: one                !! scale that 0 stands for
      real(wp), intent(inout) :: scale
      integer, intent(inout) :: curve            !! index, 0 = none

      if (curve == 0) return
      scale = merge(scale*y, one, abs(scale) > 0.0_wp)
      call convert_abscissae(draft, x, curve)
   end subroutine convert_function

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

end module kj_build_property
