!> Cards -> properties of /PROP/KJOINT.
module kj_build_property
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_joint_types, only: joint_types, find_joint_type, known_types, NDOF, DOF_NAME, &
      FRAME_MEAN, FRAME_FIRST, FRAME_CROSS
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, real_of, int_of, report
   use kj_draft, only: draft_t, reference
   use kj_joint_draft, only: property_t
   use kj_curve_units, only: convert_functions
   implicit none
   private

   public :: read_property

contains

   !> Check one property; row stays 0 when the type is not known
   subroutine read_property(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft      !! gets curves whose abscissae are converted
      type(property_t), intent(out) :: p
      type(finding_list_t), intent(inout) :: findings

      p%id = deck%block(cards%block)%id
      p%row = find_joint_type(int_of(cards, 'type'))
      if (p%row == 0) then
         call report(deck, cards, 'type', SEV_ERROR, 'KJ-0409', 'there is no joint type '// &
            str(int_of(cards, 'type')), 'expected: '//known_types(), findings)
         return
      end if
      if (int_of(cards, 'skew_1') <= 0) call report(deck, cards, 'skew_1', SEV_ERROR, 'KJ-0386', &
         'the joint has no skew on body 1', 'expected: id of a moving skew', findings)
      p%skew(1) = reference(deck, cards, 'skew_1', draft%skew, 'skew', 'KJ-0926', findings)
      p%skew(2) = reference(deck, cards, 'skew_2', draft%skew, 'skew', 'KJ-0926', findings)
      p%cr = real_of(cards, 'Cr')
      if (p%cr < 0.0_wp .or. p%cr > 1.0_wp) call report(deck, cards, 'Cr', SEV_ERROR, 'KJ-0388', &
         'the critical damping ratio is not between 0 and 1', 'expected: 0 to 1', findings)
      if (abs(p%cr) <= 0.0_wp) p%cr = 0.05_wp
      if (all(joint_types(p%row)%free == 1)) then
         p%cr = 0.0_wp
      else
         p%kn = real_of(cards, 'Kn')
         if (abs(p%kn) <= 0.0_wp) call report(deck, cards, 'Kn', SEV_ERROR, 'KJ-0387', &
            'the blocking stiffness is zero', 'expected: a positive stiffness', findings)
         if (p%kn < 0.0_wp) call report(deck, cards, 'Kn', SEV_ERROR, 'KJ-9118', &
            'the blocking stiffness is negative', 'expected: a positive stiffness', findings)
      end if
      call choose_frame(deck, cards, draft, p, findings)
      call read_free_dofs(deck, cards, draft, p, findings)
      call convert_functions(deck, cards, draft, p, findings)
   end subroutine read_property

   !> Frame rule of a property, and the checks of its skews
   subroutine choose_frame(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: dot

      p%frame = joint_types(p%row)%frame
      if (p%frame == FRAME_CROSS) then
         if (int_of(cards, 'skew_2') == 0) call report(deck, cards, 'skew_2', SEV_ERROR, &
            'KJ-0926', 'a universal joint needs a skew on body 2', &
            'expected: id of a moving skew', findings)
         if (any(p%skew == 0)) return
         dot = dot_product(draft%skews%axes(p%skew(1), 1:3), draft%skews%axes(p%skew(2), 1:3))
         if (dot > 1.0e-10_wp) call report(deck, cards, 'skew_2', SEV_ERROR, 'KJ-0389', &
            'the x axes of the two skews of a universal joint are not perpendicular: '// &
            trim(angle_text(dot))//' degrees', 'expected: 90 degrees to skew_1', findings)
         return
      end if
      if (int_of(cards, 'skew_flag') == 1) p%frame = FRAME_FIRST
      if (p%frame == FRAME_MEAN .and. int_of(cards, 'skew_2') == 0) then
         p%frame = FRAME_FIRST
         call report(deck, cards, 'skew_2', SEV_WARNING, 'KJ-9119', &
            'without a second skew the joint frame is that of body 1 (as skew flag 1)', &
            'no skew on body 2', findings, &
            hint='OpenRadioss works on undefined data here: set the skew flag to 1')
      end if
   end subroutine choose_frame

   function angle_text(cosine) result(text)
      real(wp), intent(in) :: cosine
      character(len=12) :: text

      write (text, '(f12.4)') acos(max(-1.0_wp, min(1.0_wp, cosine)))*45.0_wp/atan(1.0_wp)
      text = adjustl(text)
   end function angle_text

   !> Stiffness, damping and curves of the free dofs
   subroutine read_free_dofs(deck, cards, draft, p, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(property_t), intent(inout) :: p
      type(finding_list_t), intent(inout) :: findings

      integer :: i

      do i = 1, NDOF
         if (joint_types(p%row)%free(i) == 0) cycle
         p%k(i) = real_of(cards, 'K'//DOF_NAME(i))
         p%c(i) = real_of(cards, 'C'//DOF_NAME(i))
         p%k_curve(i) = reference(deck, cards, 'f_K'//DOF_NAME(i), draft%curve, 'function', &
            'KJ-3126', findings)
         p%c_curve(i) = reference(deck, cards, 'f_C'//DOF_NAME(i), draft%curve, 'function', &
            'KJ-3126', findings)
      end do
   end subroutine read_free_dofs

end module kj_build_property
