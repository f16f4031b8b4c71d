!> Spring elements: their nodes, axes and constants at the start.
module kj_attach_spring
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_math3, only: IDENTITY, cross, unit
   use kj_sort, only: find
   use kj_curve, only: curve_set_t, steepest_rise
   use kj_joint_types, only: NDOF, FRAME_FIRST, FRAME_SECOND, FRAME_FIXED, FRAME_APART
   use kj_joint_batch, only: SPRING8, SPRING13, LAW_SPRING, LAW_DAMPER, LAW_SPRING_CURVE, &
      LAW_DAMPER_CURVE, LAW_HARDENED
   use kj_spring_law, only: direction_t
   use kj_deck_text, only: deck_t
   use kj_cards, only: report_row
   use kj_draft, only: draft_t, known_ids, property_t, joint_t
   use kj_model, only: model_t
   implicit none
   private

   public :: attach_spring, weigh_springs

contains

   !> Check one spring and find its axes and reference length; its nodes are there
   subroutine attach_spring(draft, model, p, third, spring)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      integer, intent(in) :: third               !! its third node, 0 = none
      type(joint_t), intent(inout) :: spring

      real(wp) :: r(3)

      call check_nodes(draft%deck, model, spring)
      r = model%x0(spring%node(2), :) - model%x0(spring%node(1), :)
      spring%rule = p%frame
      if (p%kind == SPRING8) then
         call choose_skew(draft, model, p, spring)
         spring%frame = reshape(draft%skews%axes(spring%skew(1), :), [3, 3])
         spring%xl0 = matmul(r, spring%frame)
      else if (p%kind == SPRING13) then
         call take_beam_axes(draft, model, p, r, third, spring)
      else
         spring%frame = IDENTITY
         spring%xl0 = [norm2(r), 0.0_wp, 0.0_wp]
      end if
      spring%k = p%k
      spring%c = p%c
      call put_laws(draft%curves, p, spring)
   end subroutine attach_spring

   !> Axes of a beam: x along it, y towards the third node, else along that of the skew, or the
   !> next axis of it where that is along the beam
   subroutine take_beam_axes(draft, model, p, r, third, spring)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      real(wp), intent(in) :: r(3)
      integer, intent(in) :: third
      type(joint_t), intent(inout) :: spring

      real(wp) :: y(3), axes(3, 3)

      spring%xl0 = [norm2(r), 0.0_wp, 0.0_wp]
      spring%frame = IDENTITY
      if (.not. norm2(r) > 1.0e-15_wp) then
         call report_row(draft%deck, spring%card, 'n2', SEV_ERROR, 'KJ-0325', &
            'the nodes of the spring are at one place: it has no axis', 'same place as n1')
         return
      end if
      axes = reshape(draft%skews%axes(p%skew(1), :), [3, 3])
      y = axes(:, 2)
      if (third > 0) y = model%x0(third, :) - model%x0(spring%node(1), :)
      if (norm2(cross(unit(r), unit(y))) < 1.0e-10_wp) y = axes(:, 3)
      spring%frame(:, 1) = unit(r)
      spring%frame(:, 3) = unit(cross(spring%frame(:, 1), y))
      spring%frame(:, 2) = cross(spring%frame(:, 3), spring%frame(:, 1))
   end subroutine take_beam_axes

   !> Ends that are main nodes of bodies, or cannot move
   subroutine check_nodes(deck, model, spring)
      type(deck_t), intent(inout) :: deck
      type(model_t), intent(in) :: model
      type(joint_t), intent(in) :: spring

      integer :: e

      do e = 1, 2
         if (spring%node(e) <= model%n_body) then
            call report_row(deck, spring%card, 'n'//str(e), SEV_WARNING, 'KJ-0448', 'node '// &
               str(model%node_id(spring%node(e)))// &
               ' of the spring is the main node of a rigid body', 'better: a secondary node')
         else if (spring%node(e) <= model%n_lead) then
            if (model%mass(spring%node(e)) > 0.0_wp) cycle
            call report_row(deck, spring%card, 'n'//str(e), SEV_WARNING, 'KJ-9229', 'node '// &
               str(model%node_id(spring%node(e)))// &
               ' of the spring has no mass: it stays in its place', 'no mass')
         end if
      end do
   end subroutine check_nodes

   !> Skew of the element, or else of the property; and what carries it
   subroutine choose_skew(draft, model, p, spring)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: spring

      integer, parameter :: SKEW = 8             !! column of skew_id in the rows of /SPRING
      integer :: e, lead(2)

      spring%skew(1) = p%skew(1)
      if (spring%card%ints(SKEW) /= 0) then
         spring%skew(1) = find(draft%skew, spring%card%ints(SKEW))
         if (spring%skew(1) == 0) call report_row(draft%deck, spring%card, 'skew_id', SEV_ERROR, &
            'KJ-0137', 'skew '//str(spring%card%ints(SKEW))//' is not defined', 'no such skew', &
            known_ids(draft%skew, 'skew'))
      end if
      spring%rule = FRAME_FIXED
      if (is_moving(draft, spring%skew(1))) then
         lead = model%lead(spring%node)
         spring%rule = FRAME_APART
         do e = 2, 1, -1
            if (all(model%lead(draft%new(draft%skews%node(:, spring%skew(1)))) == lead(e))) &
               spring%rule = merge(FRAME_FIRST, FRAME_SECOND, e == 1)
         end do
      end if
      if (spring%rule == FRAME_APART .and. .not. draft%legacy) call report_row(draft%deck, &
         spring%card, 'n1', SEV_ERROR, 'KJ-9228', 'skew '//str(draft%skews%id(spring%skew(1)))// &
         ' of the spring rides on neither of its ends', 'expected: a node of the body of the skew')
      if (p%spring%balanced .and. spring%rule == FRAME_FIXED .and. .not. draft%legacy) call &
         report_row(draft%deck, spring%card, 'n1', SEV_ERROR, 'KJ-9227', 'property '//str(p%id)// &
         ' asks for a couple (Iequil = 1), and the axes of the spring are fixed in space', &
         'a spring with fixed axes')
   end subroutine choose_skew

   !> A skew that follows nodes, all of them known
   pure logical function is_moving(draft, skew) result(moving)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: skew                !! index, 0 = global

      moving = .false.
      if (skew == 0) return
      if (draft%skews%dir(skew) > 0) moving = all(draft%skews%node(:, skew) > 0)
   end function is_moving

   !> Law signature, and the largest stiffness and damping for the time step
   pure subroutine put_laws(curves, p, spring)
      type(curve_set_t), intent(in) :: curves
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: spring

      real(wp) :: k, c
      integer :: dof, s

      spring%law = 0
      spring%top = 0.0_wp
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         k = spring%k(dof)
         c = spring%c(dof)
         if (p%k_curve(dof) > 0) then
            spring%law(dof) = LAW_SPRING_CURVE
            k = k*steepest_rise(curves, p%k_curve(dof))
         else if (abs(k) > 0.0_wp) then
            spring%law(dof) = LAW_SPRING
         end if
         if (p%c_curve(dof) > 0) then
            spring%law(dof) = spring%law(dof) + LAW_DAMPER_CURVE
            c = c*steepest_rise(curves, p%c_curve(dof))
         else if (abs(c) > 0.0_wp) then
            spring%law(dof) = spring%law(dof) + LAW_DAMPER
         end if
         if (p%spring%hardened) spring%law(dof) = merge(LAW_HARDENED, 0, acts(p%spring%dof(dof)))
         spring%top(s) = max(spring%top(s), k)
         spring%top(s + 2) = max(spring%top(s + 2), c)
      end do
   end subroutine put_laws

   !> A direction has any force
   pure logical function acts(law)
      type(direction_t), intent(in) :: law

      acts = law%load > 0 .or. law%damper > 0 .or. abs(law%k) > 0.0_wp .or. abs(law%c) > 0.0_wp
   end function acts

   !> Mass and inertia that the nodal time step of damped springs counts on: the smaller one of the
   !> two ends, shared among all elements there
   subroutine weigh_springs(model, n_joint, elements)
      type(model_t), intent(in) :: model
      integer, intent(in) :: n_joint             !! elements before the springs
      type(joint_t), intent(inout) :: elements(:)

      integer :: count_of(model%n_lead), i, e, lead

      count_of = 0
      do i = 1, size(elements)
         do e = 1, 2
            lead = model%lead(elements(i)%node(e))
            count_of(lead) = count_of(lead) + 1
         end do
      end do
      do i = n_joint + 1, size(elements)
         elements(i)%reduced = huge(1.0_wp)
         do e = 1, 2
            lead = model%lead(elements(i)%node(e))
            if (model%mass(lead) > 0.0_wp) elements(i)%reduced(1) = &
               min(elements(i)%reduced(1), model%mass(lead)/count_of(lead))
            if (model%inertia(lead) > 0.0_wp) elements(i)%reduced(2) = &
               min(elements(i)%reduced(2), model%inertia(lead)/count_of(lead))
         end do
         where (elements(i)%reduced >= huge(1.0_wp)) elements(i)%reduced = 0.0_wp
      end do
   end subroutine weigh_springs

end module kj_attach_spring
