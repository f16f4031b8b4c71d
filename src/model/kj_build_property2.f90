!> Cards -> properties of /PROP/KJOINT2.
!> Source: docs/theory/deck.md 5.2.
module kj_build_property2
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_units, only: dimensions, D_LENGTH, D_FORCE, D_STIFFNESS, D_DAMPING, D_MOMENT, &
      D_ROT_STIFFNESS, D_ROT_DAMPING
   use kj_joint_types, only: joint_types, find_joint_type, known_types, NDOF, DOF_NAME
   use kj_joint_batch, only: KJOINT2, has_friction
   use kj_deck_text, only: deck_t, block_factors
   use kj_cards, only: cards_t, real_of, int_of, report
   use kj_draft, only: draft_t, reference
   use kj_joint_draft, only: property_t
   use kj_curve_units, only: convert_abscissae
   implicit none
   private

   public :: read_property2

   character(len=7), parameter :: ID_FUNCTION = 'KJ-3126'

contains

   !> Check one property; row stays 0 when the type is not known
   subroutine read_property2(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft      !! gets curves whose abscissae are converted
      type(property_t), intent(out) :: p
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: factor(size(dimensions))
      integer :: dof, n_dof

      p%id = deck%block(cards%block)%id
      p%kind = KJOINT2
      p%row = find_joint_type(int_of(cards, 'type'))
      if (p%row == 0) then
         call report(deck, cards, 'type', SEV_ERROR, 'KJ-0938', 'there is no joint type '// &
            str(int_of(cards, 'type')), 'expected: '//known_types(), findings)
         return
      end if
      p%frame = joint_types(p%row)%frame
      p%skew(1) = reference(deck, cards, 'skew_1', draft%skew, 'skew', 'KJ-0926', findings)
      p%skew(2) = reference(deck, cards, 'skew_2', draft%skew, 'skew', 'KJ-0926', findings)
      call read_blocking(deck, cards, p, findings)
      call read_sensor(deck, cards, draft, p, findings)
      n_dof = sum(joint_types(p%row)%free)
      if (cards%n_card > 1 .and. cards%n_card < 1 + 3*n_dof) call report(deck, cards, 'type', &
         SEV_ERROR, 'KJ-0973', 'a joint of type '//str(int_of(cards, &
         'type'))//' has '//str(3*n_dof)// ' cards of directions, here are '//str(cards%n_card - &
         1), 'expected: all of them, or none', findings)
      factor = block_factors(deck, cards%block)
      do dof = 1, NDOF
         if (joint_types(p%row)%free(dof) == 0) cycle
         call read_laws(deck, cards, factor, dof, draft, p, findings)
         call read_limits(deck, cards, factor, dof, draft, p, findings)
      end do
      call combine_stops(deck, cards, 1, 3, 'KJ-1599', p, findings)
      call combine_stops(deck, cards, 4, 6, 'KJ-1600', p, findings)
      p%limited = p%automatic .or. p%t_lock < huge(1.0_wp) .or. any(p%lo < 0.0_wp) .or. &
         any(p%hi > 0.0_wp) .or. any(has_friction(p%k_limit, p%slip, p%slip_curve))
   end subroutine read_property2

   !> Stiffness of the blocked directions, its scale and its damping
   subroutine read_blocking(deck, cards, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      p%kn = real_of(cards, 'Kn')
      if (p%kn < 0.0_wp) call report(deck, cards, 'Kn', SEV_ERROR, 'KJ-9118', &
         'the blocking stiffness is negative', 'expected: a positive stiffness, or 0', findings)
      p%automatic = p%kn < 0.5_wp
      p%scf = real_of(cards, 'SCF')
      if (p%scf < 0.0_wp) call report(deck, cards, 'SCF', SEV_ERROR, 'KJ-0939', &
         'the scale of the blocked rotations is negative', 'expected: a positive number, or 0', &
         findings)
      if (abs(p%scf) <= 0.0_wp) p%scf = merge(10.0_wp, 1.0_wp, p%kn > 0.0_wp)
      p%cr = real_of(cards, 'Cr')
      if (p%cr < 0.0_wp .or. p%cr > 1.0_wp) call report(deck, cards, 'Cr', SEV_ERROR, 'KJ-0388', &
         'the critical damping ratio is not between 0 and 1', 'expected: 0 to 1', findings)
      p%cr_stop = p%cr
      if (abs(p%cr) <= 0.0_wp) p%cr = 0.05_wp
   end subroutine read_blocking

   !> Times of the sensor that locks the joint
   subroutine read_sensor(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      integer :: sensor

      sensor = reference(deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-0521', findings)
      if (sensor == 0) return
      p%t_lock = draft%sensors(sensor)%t_start
      p%t_free = draft%sensors(sensor)%t_stop
   end subroutine read_sensor

   !> Stiffness and damping of a free direction; a scale 0 of a function means 1.
   !>
   !> K and C are forces where a function stands; then abscissae are in input units.
   subroutine read_laws(deck, cards, factor, dof, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      real(wp), intent(in) :: factor(:)          !! input units / work units, one per D_ constant
      integer, intent(in) :: dof
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: per_k, per_c
      character(len=2) :: d

      d = DOF_NAME(dof)
      p%k(dof) = real_of(cards, 'K_'//d)
      p%c(dof) = real_of(cards, 'C_'//d)
      p%k_curve(dof) = reference(deck, cards, 'f_K_'//d, draft%curve, 'function', ID_FUNCTION, &
         findings)
      p%c_curve(dof) = reference(deck, cards, 'f_C_'//d, draft%curve, 'function', ID_FUNCTION, &
         findings)
      per_k = factor(D_FORCE)/factor(D_STIFFNESS)
      per_c = factor(D_FORCE)/factor(D_DAMPING)
      if (dof > 3) per_k = factor(D_MOMENT)/factor(D_ROT_STIFFNESS)
      if (dof > 3) per_c = factor(D_MOMENT)/factor(D_ROT_DAMPING)
      if (p%k_curve(dof) > 0) then
         p%k(dof) = p%k(dof)*per_k
         if (abs(p%k(dof)) <= 0.0_wp) p%k(dof) = 1.0_wp
         call convert_abscissae(draft, per_k, p%k_curve(dof))
      end if
      if (p%c_curve(dof) > 0) then
         p%c(dof) = p%c(dof)*per_c
         if (abs(p%c(dof)) <= 0.0_wp) p%c(dof) = 1.0_wp
         call convert_abscissae(draft, per_c, p%c_curve(dof))
      end if
   end subroutine read_laws

   !> Stops and friction of a free direction
   subroutine read_limits(deck, cards, factor, dof, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: dof
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      character(len=2) :: d

      d = DOF_NAME(dof)
      p%lo(dof) = real_of(cards, 'SA-_'//d)
      p%hi(dof) = real_of(cards, 'SA+_'//d)
      if (p%lo(dof) > 0.0_wp) call report(deck, cards, 'SA-_'//d, SEV_ERROR, 'KJ-0943', &
         'the lower stop is positive', 'expected: a negative value, or 0 for none', findings)
      if (p%hi(dof) < 0.0_wp) call report(deck, cards, 'SA+_'//d, SEV_ERROR, 'KJ-0944', &
         'the upper stop is negative', 'expected: a positive value, or 0 for none', findings)
      p%k_limit(dof) = real_of(cards, 'Kfr_'//d)
      p%slip(dof) = real_of(cards, 'FM_'//d)
      p%slip_curve(dof) = reference(deck, cards, 'f_FM_'//d, draft%curve, 'function', &
         ID_FUNCTION, findings)
      call refuse_negative(deck, cards, 'Kfr_'//d, 'the stiffness of friction', findings)
      call refuse_negative(deck, cards, 'FM_'//d, 'the limit of friction', findings)
      if (p%slip_curve(dof) > 0) then
         if (abs(p%slip(dof)) <= 0.0_wp) p%slip(dof) = 1.0_wp
         if (dof <= 3) call convert_abscissae(draft, factor(D_LENGTH), p%slip_curve(dof))
      end if
      if (p%slip(dof) > 0.0_wp .and. .not. has_friction(p%k_limit(dof), p%slip(dof), &
         p%slip_curve(dof))) &
         call report(deck, cards, 'Kfr_'//d, SEV_WARNING, 'KJ-0979', &
         'a limit of friction without a stiffness: there is no friction', &
         'expected: a stiffness', findings)
   end subroutine read_limits

   subroutine refuse_negative(deck, cards, name, what, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name, what
      type(finding_list_t), intent(inout) :: findings

      if (real_of(cards, name) >= 0.0_wp) return
      call report(deck, cards, name, SEV_ERROR, 'KJ-9126', what//' is negative', &
         'expected: a positive value, or 0 for none', findings)
   end subroutine refuse_negative

   !> Stops that Icomb combines to a circle or sphere: directions first to last
   subroutine combine_stops(deck, cards, first, last, id, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: first, last         !! dofs
      character(len=*), intent(in) :: id         !! of the message on a single direction
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      integer :: dof, icomb(NDOF), at

      icomb = 0
      do dof = first, last
         icomb(dof) = int_of(cards, 'Icomb_'//DOF_NAME(dof))
      end do
      if (all(icomb == 0)) return
      at = findloc(icomb /= 0, .true., 1)
      if (count(icomb /= 0) == 1) then
         call report(deck, cards, 'Icomb_'//DOF_NAME(at), SEV_ERROR, id, &
            'Icomb is set on a single direction', 'expected: on two or three, or on none', findings)
         return
      end if
      if (any(icomb /= 0 .and. icomb /= icomb(at))) call report(deck, cards, 'Icomb_'// &
         DOF_NAME(at), SEV_ERROR, 'KJ-1598', &
         'Icomb differs between the directions that it combines', 'expected: one value', findings)
      do dof = first, last
         if (icomb(dof) == 0) cycle
         if (p%lo(dof) < 0.0_wp .or. p%hi(dof) > 0.0_wp) then
            p%combined(dof) = 1
         else
            call report(deck, cards, 'Icomb_'//DOF_NAME(dof), SEV_WARNING, 'KJ-9127', &
               'a direction without stops has nothing to combine', 'ignored', findings)
         end if
      end do
      if (count(p%combined(first:last) == 1) == 1) p%combined(first:last) = 0
   end subroutine combine_stops

end module kj_build_property2
