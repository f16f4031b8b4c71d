!> Cards -> properties of springs, /PROP/TYPE4 and /PROP/TYPE8, and their mass on the nodes.
!>
!> What is supported is elastic: force = K q, or A f1(q/Ascale), plus C q' + Hscale f4(q'/F).
!> Source: docs/theory/deck.md 5.3 and 5.4.
module kj_build_spring
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_units, only: dimensions, D_LENGTH, D_NUMBER, D_FORCE, D_MOMENT, D_VELOCITY, &
      D_ANGULAR_VELOCITY
   use kj_curve, only: add_curve
   use kj_joint_types, only: ROW_FREE, NDOF, DOF_NAME, FRAME_FIXED, FRAME_LINE
   use kj_joint_batch, only: SPRING4, SPRING8
   use kj_keywords, only: KW_SPRING4, KW_SPRING8
   use kj_deck_text, only: deck_t, block_factors
   use kj_cards, only: cards_t, read_cards, real_of, int_of, is_given, report
   use kj_draft, only: draft_t, blocks_of, reference, property_t
   use kj_build_property, only: convert_abscissae
   implicit none
   private

   public :: build_spring_properties

   real(wp), parameter :: NO_FAILURE = 1.0e29_wp !! a limit beyond it is none

contains

   !> Properties of all springs, those of type 4 first; adds their masses to the nodes of the draft
   subroutine build_spring_properties(draft)
      type(draft_t), intent(inout) :: draft

      type(property_t), allocatable :: property(:)
      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      integer :: i

      blocks = [blocks_of(draft%deck, KW_SPRING4), blocks_of(draft%deck, KW_SPRING8)]
      allocate (property(size(blocks)))
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         call read_spring(draft, cards, draft%deck%block(blocks(i))%keyword, property(i))
      end do
      call move_alloc(property, draft%properties)
      call add_masses(draft)
   end subroutine build_spring_properties

   !> Half of the mass and inertia of each spring to each of its nodes
   subroutine add_masses(draft)
      type(draft_t), intent(inout) :: draft

      integer :: i, e, before, place

      before = size(draft%property_block) - size(draft%properties)
      do i = 1, draft%elements%n
         if (draft%elements%part(i) == 0) cycle
         place = draft%part_property(draft%elements%part(i)) - before
         if (place < 1) cycle
         do e = 1, 2
            associate (node => draft%elements%node(e, i), p => draft%properties(place))
               if (node == 0) cycle
               draft%mass(node) = draft%mass(node) + 0.5_wp*p%mass
               draft%inertia(node) = draft%inertia(node) + 0.5_wp*p%inertia
            end associate
         end do
      end do
   end subroutine add_masses

   !> A spring along its line with one law, for the change of the length (type 4), or one with six
   !> laws in the axes of a skew (type 8)
   subroutine read_spring(draft, cards, keyword, p)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: keyword             !! KW_SPRING4 or KW_SPRING8
      type(property_t), intent(out) :: p

      integer :: dof

      p%id = draft%deck%block(cards%block)%id
      p%row = ROW_FREE
      p%mass = real_of(cards, 'Mass')
      if (keyword == KW_SPRING4) then
         p%kind = SPRING4
         p%frame = FRAME_LINE
         if (.not. p%mass > 1.0e-15_wp) call report(draft%deck, cards, 'Mass', SEV_ERROR, &
            'KJ-0229', 'the spring has no mass', 'expected: more than 1e-15')
      else
         p%kind = SPRING8
         p%frame = FRAME_FIXED
         if (p%mass < 0.0_wp) call report(draft%deck, cards, 'Mass', SEV_ERROR, 'KJ-0229', &
            'the mass of the spring is negative', 'expected: 0 or more')
         p%inertia = real_of(cards, 'Inertia')
         if (p%inertia <= 1.0e-20_wp) then
            call report(draft%deck, cards, 'Inertia', SEV_WARNING, 'KJ-0445', &
               'the spring has no inertia: 1e-20 is taken', 'expected: a small inertia')
            p%inertia = 1.0e-20_wp
         end if
         p%skew(1) = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
         p%balanced = int_of(cards, 'Iequil') == 1
      end if
      if (int_of(cards, 'sens_id') /= 0) then
         call report(draft%deck, cards, 'sens_id', SEV_ERROR, 'KJ-9220', &
            'springs that a sensor switches are not supported', 'expected: 0')
      else if (int_of(cards, 'Isflag') /= 0) then
         call report(draft%deck, cards, 'Isflag', SEV_WARNING, 'KJ-9225', &
            'Isflag has no effect without a sensor', 'sens_id is 0')
      end if
      if (int_of(cards, 'Ileng') /= 0) call report(draft%deck, cards, 'Ileng', SEV_ERROR, &
         'KJ-9223', 'springs with laws per unit of length are not supported', 'expected: 0', &
         hint='give mass, stiffness and damping of the spring as it is')
      if (int_of(cards, 'Fsmooth') /= 0) call report(draft%deck, cards, 'Fsmooth', SEV_ERROR, &
         'KJ-9226', 'springs with filtered rates are not supported', 'expected: 0')
      if (keyword == KW_SPRING4) call read_law(draft, cards, 1, '', p)
      do dof = 1, merge(0, NDOF, keyword == KW_SPRING4)
         call read_law(draft, cards, dof, '_'//DOF_NAME(dof), p)
      end do
   end subroutine read_spring

   !> Law of one direction; its fields end in `suffix`
   subroutine read_law(draft, cards, dof, suffix, p)
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: dof
      character(len=*), intent(in) :: suffix
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(inout) :: p

      real(wp) :: factor(size(dimensions)), unit(3)

      factor = block_factors(draft%deck, cards%block)
      unit = factor([D_LENGTH, D_VELOCITY, D_FORCE])
      if (dof > 3) unit = factor([D_NUMBER, D_ANGULAR_VELOCITY, D_MOMENT])
      p%k(dof) = real_of(cards, 'K'//suffix)
      p%c(dof) = real_of(cards, 'C'//suffix)
      p%k_curve(dof) = reference(draft%deck, cards, 'fct1'//suffix, draft%curve, 'function', &
         'KJ-0127')
      p%c_curve(dof) = reference(draft%deck, cards, 'fct4'//suffix, draft%curve, 'function', &
         'KJ-0127')
      call check_rule(draft%deck, cards, suffix)
      call check_options(draft, cards, suffix)
      if (p%k_curve(dof) > 0) then
         p%k(dof) = or_unit('A', unit(3))
         call convert_abscissae(draft, or_unit('Ascale', unit(1)), p%k_curve(dof))
      end if
      if (p%c_curve(dof) > 0) call join_dampers(draft, or_unit('Hscale', unit(3)), &
         or_unit('F', unit(2)), p%c(dof), p%c_curve(dof))
   contains
      !> Value of a scale; 0 means 1 in the units of the block
      real(wp) function or_unit(name, one) result(scale)
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: one

         scale = real_of(cards, name//suffix)
         if (abs(scale) <= 0.0_wp) scale = one
         if (scale > 0.0_wp .or. name == 'A' .or. name == 'Hscale') return
         call report(draft%deck, cards, name//suffix, SEV_ERROR, 'KJ-9230', &
            'the scale of the abscissa of a function is negative', 'expected: a positive number')
         scale = one
      end function or_unit
   end subroutine read_law

   !> One curve for the linear and the tabulated damper: C v + Hscale f4(v/F)
   subroutine join_dampers(draft, y_scale, x_scale, c, curve)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: y_scale, x_scale
      real(wp), intent(inout) :: c               !! damping in, scale of the curve out
      integer, intent(inout) :: curve

      real(wp), allocatable :: x(:), y(:)
      integer :: first, last, id

      if (abs(c) <= 0.0_wp) then
         call convert_abscissae(draft, x_scale, curve)
         c = y_scale
         return
      end if
      first = draft%curves%first(curve)
      last = draft%curves%first(curve + 1) - 1
      x = x_scale*draft%curves%x(first:last)
      y = y_scale*draft%curves%y(first:last) + c*x
      id = draft%curves%id(curve)   ! the set grows: no reference into it
      call add_curve(draft%curves, id, x, y)
      curve = draft%curves%n
      c = 1.0_wp
   end subroutine join_dampers

   !> The hardening rule H: what Radioss refuses, then what is not supported here
   subroutine check_rule(deck, cards, suffix)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix

      integer :: rule
      logical :: load, unload

      rule = int_of(cards, 'H'//suffix)
      if (rule == 0) return
      load = int_of(cards, 'fct1'//suffix) /= 0
      unload = int_of(cards, 'fct3'//suffix) /= 0
      if (rule == 4 .and. abs(real_of(cards, 'K'//suffix)) <= 0.0_wp) call report(deck, cards, &
         'K'//suffix, SEV_ERROR, 'KJ-0230', 'H = 4 needs a stiffness', &
         'expected: a positive stiffness')
      if (any(rule == [4, 5, 8]) .and. .not. load) then
         call report(deck, cards, 'fct1'//suffix, SEV_ERROR, 'KJ-0231', 'H = '//str(rule)// &
            ' needs a function', 'expected: id of a function')
      else if (rule == 6 .and. .not. (load .and. unload)) then
         call report(deck, cards, 'fct3'//suffix, SEV_ERROR, 'KJ-1057', &
            'H = 6 needs functions of loading and unloading', 'expected: fct1 and fct3')
      else if (rule == 7 .and. .not. load) then
         call report(deck, cards, 'fct1'//suffix, SEV_ERROR, 'KJ-1058', &
            'H = 7 needs a function of loading', 'expected: id of a function')
      else if (.not. load .and. rule > 0 .and. rule <= 2) then
         call report(deck, cards, 'H'//suffix, SEV_WARNING, 'KJ-9225', &
            'the hardening rule has no effect without fct1', 'fct1 is 0')
      else
         call report(deck, cards, 'H'//suffix, SEV_ERROR, 'KJ-9222', 'springs with H = '// &
            str(rule)//' are not supported', 'expected: 0, elastic')
      end if
   end subroutine check_rule

   !> Options that are not supported, and those without effect
   subroutine check_options(draft, cards, suffix)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix
      type(draft_t), intent(inout) :: draft

      character(len=9), parameter :: LIMIT(2) = ['delta_min', 'delta_max']
      integer :: i, place
      logical :: load

      do i = 1, 2
         associate (value => abs(real_of(cards, LIMIT(i)//suffix)))
            if (value > 0.0_wp .and. value < NO_FAILURE) call report(draft%deck, cards, &
               LIMIT(i)//suffix, SEV_ERROR, 'KJ-9221', 'springs that fail are not supported', &
               'expected: 0')
         end associate
      end do
      load = int_of(cards, 'fct1'//suffix) /= 0
      if (is_set('A') .and. .not. load) call report(draft%deck, cards, 'A'//suffix, SEV_WARNING, &
         'KJ-0663', 'A has no effect without a function', 'fct1 is 0')
      place = reference(draft%deck, cards, 'fct2'//suffix, draft%curve, 'function', 'KJ-0127')
      place = reference(draft%deck, cards, 'fct3'//suffix, draft%curve, 'function', 'KJ-0127')
      if (load .and. is_set('B')) call refuse_rate('B')
      if (load .and. int_of(cards, 'fct2'//suffix) /= 0) call refuse_rate('fct2')
      if (.not. load .and. is_set('B')) call warn('B', 'fct1 is 0')
      if (.not. load .and. int_of(cards, 'fct2'//suffix) /= 0) call warn('fct2', 'fct1 is 0')
      if (int_of(cards, 'H'//suffix) == 0 .and. int_of(cards, 'fct3'//suffix) /= 0) &
         call warn('fct3', 'H is 0')
      if (is_set('Hscale') .and. int_of(cards, 'fct4'//suffix) == 0) &
         call warn('Hscale', 'fct4 is 0')
   contains
      logical function is_set(name)
         character(len=*), intent(in) :: name

         is_set = is_given(cards, name//suffix) .and. abs(real_of(cards, name//suffix)) > 0.0_wp
      end function is_set

      subroutine refuse_rate(name)
         character(len=*), intent(in) :: name

         call report(draft%deck, cards, name//suffix, SEV_ERROR, 'KJ-9224', &
            'an elastic force that depends on the rate is not supported', 'expected: 0', &
            hint='damping of its own is C, or Hscale with fct4')
      end subroutine refuse_rate

      subroutine warn(name, label)
         character(len=*), intent(in) :: name, label

         call report(draft%deck, cards, name//suffix, SEV_WARNING, 'KJ-9225', name// &
            ' of the spring has no effect', label)
      end subroutine warn
   end subroutine check_options

end module kj_build_spring
