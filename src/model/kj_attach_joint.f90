!> Joint frames at the start of a run, and the angles that a KJOINT2 starts with.
!> Source: docs/theory/legacy.md 3.3, 3.4.
!> One file: elements on their nodes: axes, lengths, angles at the start
module kj_attach_joint
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_math3, only: cross, unit, rotation, rotation_vector, IDENTITY
   use kj_joint_types, only: joint_types, FRAME_MEAN, FRAME_FIRST, FRAME_CROSS, ANGLES_NONE, &
      ANGLES_X, NDOF, FRAME_SECOND, FRAME_FIXED, FRAME_APART
   use kj_deck_text, only: deck_t
   use kj_cards, only: report_row
   use kj_draft, only: draft_t, property_t, joint_t, known_ids
   use kj_model, only: model_t
   use kj_sort, only: find
   use kj_curve, only: curve_set_t, steepest_rise
   use kj_joint_batch, only: SPRING8, SPRING13, LAW_SPRING, LAW_DAMPER, LAW_SPRING_CURVE, &
      LAW_DAMPER_CURVE, LAW_HARDENED
   use kj_spring_law, only: direction_t
   implicit none
   private

   public :: match_skews, mean_frame, frame_of_skews, frame_of_nodes, angles_of_skews, &
      attach_spring, weigh_springs

   real(wp), parameter :: APART = 1.0e-10_wp   !! nodes nearer than this coincide, length

contains

   !> Skews of a joint against the bodies of its nodes; crosswise skews are swapped
   subroutine match_skews(draft, model, p, joint)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      integer :: e, s, body(2), owner(2)

      joint%skew = p%skew
      do e = 1, 2
         body(e) = model%lead(joint%node(e))
         if (body(e) > model%n_body) body(e) = 0
         owner(e) = -1
         s = p%skew(e)
         if (s == 0) cycle
         if (any(draft%skews%node(:, s) == 0)) cycle
         owner(e) = draft%body(draft%skews%node(1, s))
         if (any(draft%body(draft%skews%node(:, s)) /= owner(e))) owner(e) = 0
         if (owner(e) == 0 .and. body(e) > 0) call report_row(draft%deck, joint%card, 'id', &
            SEV_WARNING, 'KJ-0919', 'the nodes of skew '//str(draft%skews%id(s))// &
            ' are not all secondary nodes of one rigid body', 'joint with this skew')
      end do
      if (any(owner <= 0)) return
      if (body(1) /= body(2) .and. all(owner == body(2:1:-1))) then
         joint%skew = p%skew(2:1:-1)
         if (draft%legacy) then
            call report_row(draft%deck, joint%card, 'id', SEV_WARNING, 'KJ-0921', &
               'the skews of the joint stand crosswise to its nodes: they were swapped, but '// &
               'its reference offset is of the order written, as in OpenRadioss', 'half swapped', &
               hint='write the skew of the body of node 1 first')
         else
            call report_row(draft%deck, joint%card, 'id', SEV_WARNING, 'KJ-0921', &
               'the skews of the joint stand crosswise to its nodes: they were swapped', 'swapped')
         end if
      else if (any(owner /= body)) then
         call report_row(draft%deck, joint%card, 'id', SEV_WARNING, 'KJ-0920', &
            'a skew of the joint belongs to another body than its node', 'joint with this skew')
      end if
   end subroutine match_skews

   !> Initial frame by the rule of the property, and the offset r of node 2 in it.
   !> Source: docs/theory/legacy.md 3.3.
   subroutine frame_of_skews(draft, p, r, joint)
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(in) :: p
      real(wp), intent(in) :: r(3)                !! node 2 from node 1, W
      type(joint_t), intent(inout) :: joint

      real(wp) :: written(3, 3)
      logical :: opposite

      if (draft%legacy .and. p%frame == FRAME_MEAN) then
         call legacy_mean(draft%skews%axes(p%skew(1), :), draft%skews%axes(p%skew(2), :), &
            joint%skew(1) /= p%skew(1), joint%frame, written, opposite)
      else
         call mean_frame(p%frame, draft%skews%axes(joint%skew(1), :), &
            draft%skews%axes(joint%skew(2), :), joint%frame, opposite)
         written = joint%frame
         if (draft%legacy) call mean_frame(p%frame, draft%skews%axes(p%skew(1), :), &
            draft%skews%axes(p%skew(2), :), written, opposite)
      end if
      joint%xl0 = turned_back(written, r)
      if (opposite) call report_row(draft%deck, joint%card, 'id', SEV_ERROR, 'KJ-9121', &
         'the skews of the joint are 180 degrees apart: they have no mean frame', &
         'joint with these skews')
   end subroutine frame_of_skews

   !> Mean frame of the skews in the order written, as the starter of OpenRadioss finds it, and that
   !> of its first cycle: the same but for round-off, or where the skews stand crosswise the second
   !> skew turned by the half rotation from the first to it.
   !>
   !> Sums and products stand in the order that gives the bits of OpenRadioss: the sign of a first
   !> displacement of 1e-17 chooses the segment of a curve with a knot at 0.
   pure subroutine legacy_mean(axes1, axes2, crosswise, first, written, opposite)
      real(wp), intent(in) :: axes1(9), axes2(9)  !! in the order written; columns, W
      logical, intent(in) :: crosswise
      real(wp), intent(out) :: first(3, 3)        !! of cycle 0, columns, W
      real(wp), intent(out) :: written(3, 3)
      logical, intent(out) :: opposite            !! 180 degrees apart: there is no mean

      real(wp) :: u(3, 3), v(3, 3), a0(3, 3)

      u = reshape(axes1, [3, 3])
      v = reshape(axes2, [3, 3])
      a0 = 0.5_wp*(half_rotation(product_of(transpose(u), v)) + &
         transpose(half_rotation(product_of(transpose(v), u))))
      written = 0.5_wp*(product_of(u, a0) + product_of(v, transpose(a0)))
      first = product_of(u, a0)
      if (crosswise) first = product_of(v, a0)
      opposite = norm2(rotation_vector(matmul(transpose(u), v))) > 4.0_wp*atan(1.0_wp) - 2.0e-6_wp
   end subroutine legacy_mean

   !> The rotation by half the angle of another
   pure function half_rotation(q) result(half)
      real(wp), intent(in) :: q(3, 3)
      real(wp) :: half(3, 3)

      real(wp) :: c, s, t(3), length
      integer :: i, j

      c = min(1.0_wp, max(-1.0_wp, 0.5_wp*(((q(1, 1) + q(2, 2)) + q(3, 3)) - 1.0_wp)))
      s = sin(acos(c))
      t = 0.0_wp
      if (abs(s) > 0.0_wp) t = [q(3, 2) - q(2, 3), q(1, 3) - q(3, 1), q(2, 1) - q(1, 2)]*(0.5_wp/s)
      length = sqrt(t(1)*t(1) + t(2)*t(2) + t(3)*t(3))
      if (length > 0.0_wp) t = t*(1.0_wp/length)
      c = 0.5_wp*(c + 1.0_wp)
      s = sqrt(1.0_wp - c)
      c = sqrt(c)
      do i = 1, 3
         do j = 1, 3
            half(i, j) = t(i)*t(j)*(1.0_wp - c)
         end do
         half(i, i) = half(i, i) + c
      end do
      half(2, 1) = half(2, 1) + t(3)*s
      half(1, 2) = half(1, 2) - t(3)*s
      half(3, 1) = half(3, 1) - t(2)*s
      half(1, 3) = half(1, 3) + t(2)*s
      half(3, 2) = half(3, 2) + t(1)*s
      half(2, 3) = half(2, 3) - t(1)*s
   end function half_rotation

   !> a b, summed from left to right
   pure function product_of(a, b) result(c)
      real(wp), intent(in) :: a(3, 3), b(3, 3)
      real(wp) :: c(3, 3)

      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            c(i, j) = (a(i, 1)*b(1, j) + a(i, 2)*b(2, j)) + a(i, 3)*b(3, j)
         end do
      end do
   end function product_of

   !> a^T r, summed from left to right
   pure function turned_back(a, r) result(x)
      real(wp), intent(in) :: a(3, 3), r(3)
      real(wp) :: x(3)

      integer :: i

      do i = 1, 3
         x(i) = (a(1, i)*r(1) + a(2, i)*r(2)) + a(3, i)*r(3)
      end do
   end function turned_back

   !> Frame of a joint from the axes of its two skews, by a frame rule
   pure subroutine mean_frame(rule, axes1, axes2, frame, opposite)
      integer, intent(in) :: rule                 !! FRAME_ constant
      real(wp), intent(in) :: axes1(9), axes2(9)  !! columns, W
      real(wp), intent(out) :: frame(3, 3)        !! columns, W
      logical, intent(out) :: opposite            !! 180 degrees apart: there is no mean

      real(wp) :: u(3, 3), v(3, 3), half(3)

      u = reshape(axes1, [3, 3])
      v = reshape(axes2, [3, 3])
      opposite = .false.
      select case (rule)
      case (FRAME_FIRST)
         frame = u
      case (FRAME_MEAN)
         half = 0.5_wp*rotation_vector(matmul(transpose(u), v))
         frame = matmul(u, rotation(half))
         opposite = norm2(half) > 2.0_wp*atan(1.0_wp) - 1.0e-6_wp
      case default   ! FRAME_CROSS
         frame(:, 1) = unit(cross(u(:, 1), v(:, 1)))
         frame(:, 2) = u(:, 1)
         frame(:, 3) = v(:, 1)
      end select
   end subroutine mean_frame

   !> Initial frame of a KJOINT2: from its nodes, else from its first skew.
   !>
   !> Two nodes: x from 1 to 2. Three: x from 1 to 3. Four: x from 1 to 3, y in the plane of 1, 3
   !> and 4; universal: y from 1 to 3, z from 1 to 4.
   subroutine frame_of_nodes(draft, x, given, p, joint)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: x(3, 4)             !! places of the nodes, W
      integer, intent(in) :: given                !! number of nodes on the card, 2 to 4
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      logical :: apart12, has_skew
      integer :: needed

      needed = joint_types(p%row)%n_axis_node
      apart12 = norm2(x(:, 2) - x(:, 1)) > APART
      has_skew = p%skew(1) > 0
      if (.not. has_skew .and. merge(3, given, given == 2 .and. apart12) < needed) then
         call report_row(draft%deck, joint%card, 'id', SEV_ERROR, 'KJ-0936', 'the '// &
            trim(joint_types(p%row)%name)//' joint needs '//str(needed)// ' nodes for its axes', &
            'expected: more nodes, or a skew in the property')
      else if (given == 2 .and. needed == 2 .and. .not. has_skew) then
         joint%frame = IDENTITY
      else if (given == 2 .and. .not. apart12) then
         joint%frame = reshape(draft%skews%axes(p%skew(1), :), [3, 3])
      else if (norm2(x(:, min(given, 3)) - x(:, 1)) <= APART) then
         call report_row(draft%deck, joint%card, 'n3', SEV_ERROR, 'KJ-1009', &
            'node 3 of the joint lies on node 1: the joint has no x axis', 'same place as n1')
      else if (given < 4) then
         joint%frame = frame_about(unit(x(:, given) - x(:, 1)))
      else
         call frame_of_plane(draft%deck, x(:, 3) - x(:, 1), x(:, 4) - x(:, 1), &
            joint_types(p%row)%frame == FRAME_CROSS, joint)
      end if
   end subroutine frame_of_nodes

   !> Frame with this x axis; y is perpendicular to it and to one of the global axes
   pure function frame_about(axis) result(frame)
      real(wp), intent(in) :: axis(3)             !! unit
      real(wp) :: frame(3, 3)

      real(wp) :: y(3)

      y = [-axis(2), axis(1), 0.0_wp]
      if (maxloc(abs(axis), 1, back=.true.) == 3) y = [0.0_wp, axis(3), -axis(2)]
      frame(:, 1) = axis
      frame(:, 2) = unit(y)
      frame(:, 3) = unit(cross(axis, y))
   end function frame_about

   !> Frame of two directions: x along a and y in their plane; universal: y along a, z along b
   subroutine frame_of_plane(deck, a, b, universal, joint)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: a(3), b(3)
      logical, intent(in) :: universal
      type(joint_t), intent(inout) :: joint

      real(wp) :: normal(3)

      normal = cross(a, b)
      if (norm2(normal) <= 1.0e-10_wp*dot_product(a, a)) then
         call report_row(deck, joint%card, 'n4', SEV_ERROR, 'KJ-0937', &
            'nodes 1, 3 and 4 of the joint do not span a plane', 'on a line with n1 and n3')
         return
      end if
      if (.not. universal) then
         joint%frame(:, 1) = unit(a)
         joint%frame(:, 2) = unit(cross(normal, a))
         joint%frame(:, 3) = unit(normal)
         return
      end if
      joint%frame(:, 1) = unit(normal)
      joint%frame(:, 2) = unit(a)
      joint%frame(:, 3) = unit(b)
      if (abs(dot_product(a, b))/(norm2(normal) + norm2(a)) < 1.0e-4_wp) return
      joint%frame(:, 3) = unit(cross(joint%frame(:, 1), joint%frame(:, 2)))
      call report_row(deck, joint%card, 'n4', SEV_WARNING, 'KJ-9128', &
         'the axes of the universal joint, from node 1 to 3 and to 4, are not perpendicular: '// &
         'the second was turned', 'expected: perpendicular axes')
   end subroutine frame_of_plane

   !> Angles that a KJOINT2 starts with: the second skew against the first.
   !>
   !> Where the joint turns about x alone, the x axes of both skews are put on that of the joint.
   subroutine angles_of_skews(draft, p, joint)
      type(draft_t), intent(inout) :: draft
      type(property_t), intent(in) :: p
      type(joint_t), intent(inout) :: joint

      real(wp) :: u(3, 3), v(3, 3), cosine
      integer :: dof

      joint%angle = 0.0_wp
      if (any(p%skew == 0)) return
      if (joint_types(p%row)%angles == ANGLES_NONE) return
      if (draft%skews%id(p%skew(2)) <= 2) call report_row(draft%deck, joint%card, 'id', &
         SEV_WARNING, 'KJ-9129', &
         'skew_2 of the joint has the id '//str(draft%skews%id(p%skew(2)))// &
         ': OpenRadioss starts with undefined angles', 'joint with this skew', &
         hint='give the skew an id above 2')
      u = reshape(draft%skews%axes(p%skew(1), :), [3, 3])
      v = reshape(draft%skews%axes(p%skew(2), :), [3, 3])
      if (joint_types(p%row)%angles == ANGLES_X) then
         cosine = min(abs(dot_product(u(:, 1), joint%frame(:, 1))), &
            abs(dot_product(v(:, 1), joint%frame(:, 1))))
         if (cosine < 0.98_wp) then
            call report_row(draft%deck, joint%card, 'id', SEV_ERROR, 'KJ-3076', &
               'the x axes of the skews of the joint are not along its axis', &
               'joint with these skews')
            return
         end if
         if (cosine < 0.9998_wp) call report_row(draft%deck, joint%card, 'id', SEV_WARNING, &
            'KJ-3067', 'the x axes of the skews of the joint are over 1 degree off its axis', &
            'joint with these skews')
         call align(joint%frame(:, 1), u)
         call align(joint%frame(:, 1), v)
      end if
      joint%angle = rotation_vector(matmul(transpose(u), v))
      do dof = 4, 6
         if (p%lo(dof) < 0.0_wp .and. joint%angle(dof - 3) < p%lo(dof) .or. &
            p%hi(dof) > 0.0_wp .and. joint%angle(dof - 3) > p%hi(dof)) call report_row(draft%deck, &
            joint%card, 'id', SEV_ERROR, 'KJ-1133', &
            'an angle of the joint starts beyond its stop', 'joint with these skews')
      end do
   end subroutine angles_of_skews

   !> Put the x axis of a frame on +axis or -axis, whichever is nearer
   pure subroutine align(axis, frame)
      real(wp), intent(in) :: axis(3)
      real(wp), intent(inout) :: frame(3, 3)

      frame(:, 1) = sign(1.0_wp, dot_product(frame(:, 1), axis))*axis
      frame(:, 3) = unit(cross(frame(:, 1), frame(:, 2)))
      frame(:, 2) = cross(frame(:, 3), frame(:, 1))
   end subroutine align

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
      logical :: moving

      spring%skew(1) = p%skew(1)
      if (spring%card%ints(SKEW) /= 0) then
         spring%skew(1) = find(draft%skew, spring%card%ints(SKEW))
         if (spring%skew(1) == 0) call report_row(draft%deck, spring%card, 'skew_id', SEV_ERROR, &
            'KJ-0137', 'skew '//str(spring%card%ints(SKEW))//' is not defined', 'no such skew', &
            known_ids(draft%skew, 'skew'))
      end if
      spring%rule = FRAME_FIXED
      moving = spring%skew(1) > 0                ! it follows nodes, all of them known
      if (moving) moving = draft%skews%dir(spring%skew(1)) > 0 .and. &
         all(draft%skews%node(:, spring%skew(1)) > 0)
      if (moving) then
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

end module kj_attach_joint
