!> Cards -> properties of springs, /PROP/TYPE4, TYPE8 and TYPE13, and their mass on the nodes.
!> Source: docs/theory/deck.md 5.3 to 5.5.
!> One file: what a direction says is read once, for laws, step and failure alike.
module kj_build_spring
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_units, only: dimensions, D_LENGTH, D_NUMBER, D_FORCE, D_MOMENT, D_VELOCITY, &
      D_ANGULAR_VELOCITY, D_ENERGY
   use kj_curve, only: add_curve, steepest_rise
   use kj_joint_types, only: ROW_FREE, NDOF, DOF_NAME, FRAME_FIXED, FRAME_LINE, &
      FRAME_MEAN
   use kj_joint_batch, only: SPRING4, SPRING8, SPRING13
   use kj_spring_law, only: direction_t, spring_t, ELASTIC, UNCOUPLED, KINEMATIC, NONLINEAR, &
      ISOTROPIC_CURVES, HYSTERETIC, TOTAL_LENGTH, BY_FORCE, BY_ENERGY, NO_FAILURE
   use kj_keywords, only: KW_SPRING4, KW_SPRING8, KW_SPRING13
   use kj_deck_text, only: deck_t, block_factors
   use kj_cards, only: cards_t, read_cards, real_of, int_of, is_given, report, &
      report_cut_deck
   use kj_draft, only: draft_t, blocks_of, reference, property_t
   use kj_build_property, only: convert_abscissae
   implicit none
   private

   public :: build_spring_properties

contains

   !> Properties of all springs, those of type 4 first; adds their masses to the nodes of the draft
   subroutine build_spring_properties(draft)
      type(draft_t), intent(inout) :: draft

      type(property_t), allocatable :: property(:)
      type(cards_t) :: cards
      integer, allocatable :: blocks(:)
      integer :: i

      blocks = [blocks_of(draft%deck, KW_SPRING4), blocks_of(draft%deck, KW_SPRING8), &
         blocks_of(draft%deck, KW_SPRING13)]
      allocate (property(size(blocks)))
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         call report_cut_deck(draft%deck, cards)
         call read_spring(draft, cards, draft%deck%block(blocks(i))%keyword, property(i))
      end do
      call move_alloc(property, draft%properties)
      call add_masses(draft)
   end subroutine build_spring_properties

   !> Half of the mass and inertia of each spring to each of its nodes
   subroutine add_masses(draft)
      type(draft_t), intent(inout) :: draft

      real(wp) :: length
      integer :: i, e, before, place

      before = size(draft%property_block) - size(draft%properties)
      do i = 1, draft%elements%n
         if (draft%elements%part(i) == 0) cycle
         place = draft%part_property(draft%elements%part(i)) - before
         if (place < 1) cycle
         associate (node => draft%elements%node(:, i), spring => draft%properties(place)%spring)
            if (any(node == 0)) cycle
            length = 1.0_wp
            if (spring%per_length) length = norm2(draft%x(node(2), :) - draft%x(node(1), :))
            do e = 1, 2
               draft%mass(node(e)) = draft%mass(node(e)) + 0.5_wp*length*spring%mass
               draft%inertia(node(e)) = draft%inertia(node(e)) + 0.5_wp*length*spring%inertia
            end do
         end associate
      end do
   end subroutine add_masses

   !> A spring along its line with one law, for the change of the length (type 4), or one with six
   !> laws in the axes of a skew (type 8), or in those of a beam (type 13)
   subroutine read_spring(draft, cards, keyword, p)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: keyword             !! KW_SPRING4, 8 or 13
      type(property_t), intent(out) :: p

      integer :: dof

      p%id = draft%deck%block(cards%block)%id
      p%row = ROW_FREE
      allocate (p%spring)
      associate (spring => p%spring)
         spring%mass = real_of(cards, 'Mass')
         if (keyword == KW_SPRING4) then
            p%kind = SPRING4
            p%frame = FRAME_LINE
            if (.not. spring%mass > 1.0e-15_wp) call report(draft%deck, cards, 'Mass', SEV_ERROR, &
               'KJ-0229', 'the spring has no mass', 'expected: more than 1e-15')
            spring%per_length = int_of(cards, 'Ileng') == 1
         else
            call read_six(draft, cards, keyword == KW_SPRING13, p)
         end if
         call read_sensor(draft, cards, spring)
         if (keyword == KW_SPRING4) call read_law(draft, cards, 1, '', p)
         do dof = 1, merge(0, NDOF, keyword == KW_SPRING4)
            call read_law(draft, cards, dof, '_'//DOF_NAME(dof), p)
         end do
         spring%hardened = spring%hardened .or. spring%sensed .or. spring%per_length
      end associate
   end subroutine read_spring

   !> What a spring of type 8 or 13 has beside its laws
   subroutine read_six(draft, cards, beam, p)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      logical, intent(in) :: beam                !! type 13
      type(property_t), intent(inout) :: p

      p%kind = merge(SPRING13, SPRING8, beam)
      p%frame = merge(FRAME_MEAN, FRAME_FIXED, beam)
      associate (spring => p%spring)
         if (spring%mass < 0.0_wp) call report(draft%deck, cards, 'Mass', SEV_ERROR, 'KJ-0229', &
            'the mass of the spring is negative', 'expected: 0 or more')
         spring%inertia = real_of(cards, 'Inertia')
         if (spring%inertia <= 1.0e-20_wp) then
            call report(draft%deck, cards, 'Inertia', SEV_WARNING, 'KJ-0445', &
               'the spring has no inertia: 1e-20 is taken', 'expected: a small inertia')
            spring%inertia = 1.0e-20_wp
         end if
         p%skew(1) = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
         if (beam) then
            call read_beam(draft%deck, cards, spring)
         else
            spring%balanced = int_of(cards, 'Iequil') == 1
         end if
         spring%summed = int_of(cards, 'Ifail') == 1
         if (any(int_of(cards, 'Ifail2') == [BY_FORCE, BY_ENERGY])) &
            spring%criterion = int_of(cards, 'Ifail2')
         if (int_of(cards, 'Fsmooth') == 0) return
         spring%cutoff = real_of(cards, 'Fcut')
         if (abs(spring%cutoff) <= 0.0_wp) spring%cutoff = 1.0e30_wp
      end associate
   end subroutine read_six

   !> What a spring of type 13 has beside that of a type 8: failure that depends on the rate
   subroutine read_beam(deck, cards, spring)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      type(spring_t), intent(inout) :: spring

      integer :: dof

      if (spring%mass <= 1.0e-20_wp) then
         call report(deck, cards, 'Mass', SEV_WARNING, 'KJ-0444', &
            'the spring has no mass: 1e-20 is taken', 'expected: a small mass')
         spring%mass = 1.0e-20_wp
      end if
      spring%per_length = int_of(cards, 'Ileng') == 1
      spring%v0 = or_one('V0', 1.0_wp)
      spring%w0 = or_one('W0', 1.0_wp)
      do dof = 1, NDOF
         associate (law => spring%dof(dof), suffix => '_'//DOF_NAME(dof))
            law%speed = real_of(cards, 'c'//suffix)
            law%power = or_one('n'//suffix, 1.0_wp)
            law%weight = or_one('alpha'//suffix, 1.0_wp)
            law%exponent = or_one('beta'//suffix, 2.0_wp)
         end associate
      end do
   contains
      pure real(wp) function or_one(name, default) result(value)
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: default

         value = real_of(cards, name)
         if (abs(value) <= 0.0_wp) value = default
      end function or_one
   end subroutine read_beam

   !> The sensor that switches a spring, and how
   subroutine read_sensor(draft, cards, spring)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      type(spring_t), intent(inout) :: spring

      integer :: sensor

      sensor = reference(draft%deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-0521')
      spring%sensed = sensor > 0
      spring%flag = int_of(cards, 'Isflag')
      if (spring%sensed) then
         spring%t_on = draft%sensors(sensor)%t_start
         spring%t_off = draft%sensors(sensor)%t_stop
         if (.not. any(spring%flag == [0, 1, 2])) call report(draft%deck, cards, 'Isflag', &
            SEV_ERROR, 'KJ-9220', 'Isflag is not 0, 1 or 2', 'expected: 0, 1 or 2')
      else if (spring%flag /= 0) then
         call report(draft%deck, cards, 'Isflag', SEV_WARNING, 'KJ-9225', &
            'Isflag has no effect without a sensor', 'sens_id is 0')
      end if
   end subroutine read_sensor

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
      if (p%spring%per_length) unit(1) = 1.0_wp
      associate (law => p%spring%dof(dof))
         law%load = curve_of('fct1')
         law%rate = curve_of('fct2')
         law%unload = curve_of('fct3')
         law%damper = curve_of('fct4')
         law%k = real_of(cards, 'K'//suffix)
         law%c = real_of(cards, 'C'//suffix)
         law%x_scale = or_unit('Ascale', unit(1))
         law%h = or_unit('Hscale', unit(3))
         law%f = 1.0_wp/or_unit('F', unit(2))
         law%d = or_unit('D', unit(2))
         if (law%load > 0) then
            law%a = or_unit('A', unit(3))
            law%b = real_of(cards, 'B'//suffix)
            if (law%rate > 0) law%e = or_unit('E', unit(3))
         else
            law%rate = 0
         end if
         call check_rule(draft, cards, suffix, p%kind, law)
         call check_options(draft%deck, cards, suffix, law)
         call read_elastic(draft, law, p%k(dof), p%k_curve(dof), p%c(dof), p%c_curve(dof))
         if (draft%legacy .and. p%kind == SPRING4 .and. law%unload > 0) &
            law%f = real(rank_of(int_of(cards, 'fct3')), wp) + real(0.1, wp)
         call find_stiffness(draft, law)
         call read_failure(cards, suffix, factor, unit(1), dof, p%spring)
         p%spring%hardened = p%spring%hardened .or. law%rule /= ELASTIC .or. law%rate > 0 .or. &
            abs(law%b) > 0.0_wp .or. law%hi < NO_FAILURE .or. law%lo > -NO_FAILURE
      end associate
   contains
      integer function curve_of(name) result(curve)
         character(len=*), intent(in) :: name

         curve = reference(draft%deck, cards, name//suffix, draft%curve, 'function', 'KJ-0127')
      end function curve_of

      !> Value of a scale; 0 means 1 in the units of the block
      real(wp) function or_unit(name, one) result(scale)
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: one

         scale = real_of(cards, name//suffix)
         if (abs(scale) <= 0.0_wp) scale = one
         if (scale > 0.0_wp .or. any(name == ['A     ', 'D     ', 'E     ', 'Hscale'])) return
         call report(draft%deck, cards, name//suffix, SEV_ERROR, 'KJ-9230', &
            'the scale of the abscissa of a function is negative', 'expected: a positive number')
         scale = one
      end function or_unit

      !> Legacy quirk: the place of fct3 among all functions stands where 1/F should
      integer function rank_of(id) result(rank)
         integer, intent(in) :: id

         rank = count(draft%curve%id <= id)
      end function rank_of
   end subroutine read_law

   !> Stiffness that unloading has, and what the legacy time step sees
   pure subroutine find_stiffness(draft, law)
      type(draft_t), intent(in) :: draft
      type(direction_t), intent(inout) :: law

      if (law%load > 0) then
         law%k = law%k/law%a
         law%k_unload = max(law%k, steepest_rise(draft%curves, law%load)/law%x_scale)
      else
         law%k_unload = law%k
      end if
      law%k_step = law%a*law%k_unload
      law%c_step = law%c
      if (law%damper > 0) law%c_step = law%c + &
         max(0.0_wp, steepest_rise_of(law%h*law%f))
   contains
      !> Steepest rise of the damper, scaled
      pure real(wp) function steepest_rise_of(scale) result(slope)
         real(wp), intent(in) :: scale

         integer :: i

         slope = 0.0_wp
         associate (set => draft%curves)
            do i = set%first(law%damper), set%first(law%damper + 1) - 2
               slope = max(slope, scale*(set%y(i + 1) - set%y(i))/(set%x(i + 1) - set%x(i)))
            end do
         end associate
      end function steepest_rise_of
   end subroutine find_stiffness

   !> Stiffness, damping and their curves of an elastic law, as joints have them
   subroutine read_elastic(draft, law, k, k_curve, c, c_curve)
      type(draft_t), intent(inout) :: draft
      type(direction_t), intent(in) :: law
      real(wp), intent(inout) :: k, c
      integer, intent(inout) :: k_curve, c_curve

      k = law%k
      c = law%c
      k_curve = law%load
      c_curve = law%damper
      if (k_curve > 0) then
         k = law%a
         call convert_abscissae(draft, law%x_scale, k_curve)
      end if
      if (c_curve > 0) call join_dampers(draft, law%h, 1.0_wp/law%f, c, c_curve)
   end subroutine read_elastic

   !> Limits of failure: delta times Ascale where it is a way, else a force or an energy
   subroutine read_failure(cards, suffix, factor, unit, dof, spring)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix
      real(wp), intent(in) :: factor(:), unit    !! of the block; of its lengths, 1 for angles
      integer, intent(in) :: dof
      type(spring_t), intent(inout) :: spring

      real(wp) :: scale

      associate (law => spring%dof(dof))
         scale = law%x_scale/unit
         if (spring%criterion == BY_FORCE) scale = factor(merge(D_FORCE, D_MOMENT, dof <= 3))/ &
            factor(merge(D_LENGTH, D_NUMBER, dof <= 3))
         if (spring%criterion == BY_ENERGY) scale = factor(D_ENERGY)/ &
            factor(merge(D_LENGTH, D_NUMBER, dof <= 3))
         if (abs(real_of(cards, 'delta_min'//suffix)) > 0.0_wp) &
            law%lo = max(law%lo, scale*real_of(cards, 'delta_min'//suffix))
         if (abs(real_of(cards, 'delta_max'//suffix)) > 0.0_wp) &
            law%hi = min(law%hi, scale*real_of(cards, 'delta_max'//suffix))
      end associate
   end subroutine read_failure

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

   !> The hardening rule H
   subroutine check_rule(draft, cards, suffix, kind, law)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix
      integer, intent(in) :: kind
      type(direction_t), intent(inout) :: law

      integer :: rule
      logical :: load, unload

      rule = int_of(cards, 'H'//suffix)
      load = int_of(cards, 'fct1'//suffix) /= 0
      unload = int_of(cards, 'fct3'//suffix) /= 0
      if (.not. any(rule == [0, 1, 2, 4, 5, 6, 7, 8]) .or. rule == 8 .and. kind /= SPRING4) then
         call report(draft%deck, cards, 'H'//suffix, SEV_ERROR, 'KJ-9221', &
            'there is no hardening rule H = '//str(rule)//' here', &
            'expected: 0, 1, 2, 4, 5, 6, 7, of type 4 also 8')
         return
      end if
      if (rule == KINEMATIC .and. abs(real_of(cards, 'K'//suffix)) <= 0.0_wp) &
         call report(draft%deck, cards, 'K'//suffix, SEV_ERROR, 'KJ-0230', &
         'H = 4 needs a stiffness', 'expected: a positive stiffness')
      if (any(rule == [KINEMATIC, NONLINEAR, TOTAL_LENGTH]) .and. .not. load) then
         call need('fct1', 'KJ-0231', 'a function')
      else if (any(rule == [KINEMATIC, NONLINEAR]) .and. .not. unload) then
         call need('fct3', 'KJ-0231', 'a function of unloading')
      else if (rule == ISOTROPIC_CURVES .and. .not. (load .and. unload)) then
         call need('fct3', 'KJ-1057', 'functions of loading and unloading')
      else if (rule == HYSTERETIC .and. .not. load) then
         call need('fct1', 'KJ-1058', 'a function of loading')
      else if (rule == HYSTERETIC .and. .not. unload) then
         call report(draft%deck, cards, 'fct3'//suffix, SEV_WARNING, 'KJ-1059', &
            'H = 7 without a function of unloading is H = 2', 'fct3 is 0')
         rule = UNCOUPLED
      else if (.not. load .and. rule > 0) then
         call report(draft%deck, cards, 'H'//suffix, SEV_WARNING, 'KJ-9225', &
            'the hardening rule has no effect without fct1', 'fct1 is 0')
      end if
      if (load) law%rule = rule
   contains
      subroutine need(field, id, what)
         character(len=*), intent(in) :: field, id, what

         call report(draft%deck, cards, field//suffix, SEV_ERROR, id, 'H = '//str(rule)// &
            ' needs '//what, 'expected: id of a function')
      end subroutine need
   end subroutine check_rule

   !> Options without effect
   subroutine check_options(deck, cards, suffix, law)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix
      type(direction_t), intent(in) :: law

      logical :: load

      load = int_of(cards, 'fct1'//suffix) /= 0
      if (is_set('A') .and. .not. load) call report(deck, cards, 'A'//suffix, SEV_WARNING, &
         'KJ-0663', 'A has no effect without a function', 'fct1 is 0')
      if (.not. load .and. is_set('B')) call warn('B', 'fct1 is 0')
      if (.not. load .and. int_of(cards, 'fct2'//suffix) /= 0) call warn('fct2', 'fct1 is 0')
      if (all(law%rule /= [KINEMATIC, NONLINEAR, ISOTROPIC_CURVES, HYSTERETIC]) .and. &
         int_of(cards, 'fct3'//suffix) /= 0) call warn('fct3', 'H does not unload by a function')
      if (is_set('Hscale') .and. int_of(cards, 'fct4'//suffix) == 0) &
         call warn('Hscale', 'fct4 is 0')
   contains
      logical function is_set(name)
         character(len=*), intent(in) :: name

         is_set = is_given(cards, name//suffix) .and. abs(real_of(cards, name//suffix)) > 0.0_wp
      end function is_set

      subroutine warn(name, label)
         character(len=*), intent(in) :: name, label

         call report(deck, cards, name//suffix, SEV_WARNING, 'KJ-9225', name// &
            ' of the spring has no effect', label)
      end subroutine warn
   end subroutine check_options

end module kj_build_spring
