!> What came out of a full deck, what was left behind, and what that did. Data, no text.
!> Source: docs/theory/full.md 6.
module kj_extract_report
   use kj_kinds, only: wp
   use kj_text, only: text_t
   use kj_error, only: str, SEV_WARNING
   use kj_sort, only: find, find_root
   use kj_keywords, only: keywords, KW_SPRING, KW_GRAV, KW_CLOAD, KW_KJOINT, KW_KJOINT2
   use kj_deck_text, only: title_of, report_header
   use kj_draft, only: draft_t
   use kj_model, only: model_t
   use kj_element_cards, only: element_row, element_cards
   use kj_element_mass, only: scales_t, element_t, first_element, next_element
   use kj_keep, only: keep_t, body_of
   use kj_acts, only: act_t, find_acts
   implicit none
   private

   public :: extract_report_t, new_report

   !> A kind of thing that is not in the mechanism
   type, public :: dropped_t
      character(len=20) :: name = ''             !! keyword, or what elements are called
      integer :: n = 0
   end type dropped_t

   !> A part whose elements touch bodies and something else, or two bodies
   type, public :: bridge_t
      integer :: part = 0                        !! id
      type(text_t) :: title
      integer :: n = 0                           !! elements
      !> without stiffness: no force in the full deck either
      logical :: void = .false.
      !> ids of two bodies it joins, 0 = a body and others
      integer :: body(2) = 0
      logical :: alone = .false.                 !! nothing else joins these two
   end type bridge_t

   !> A part that is left behind with its mass
   type, public :: lost_part_t
      integer :: id = 0
      type(text_t) :: title
      real(wp) :: mass = 0.0_wp
   end type lost_part_t

   !> All of it; masses and lengths in work units
   type :: extract_report_t
      character(len=:), allocatable :: text      !! the starter deck of the mechanism
      character(len=:), allocatable :: engine    !! its engine deck, '' = none
      type(text_t), allocatable :: input(:)      !! paths of the decks
      character(len=20) :: symbol(3) = ''        !! units of mass, length, time
      integer, allocatable :: body_id(:), main(:)   !! (bodies) ids
      type(text_t), allocatable :: body_name(:)
      real(wp), allocatable :: mass(:), centre(:, :)   !! (bodies), (3, bodies)
      real(wp), allocatable :: principal(:, :)   !! (3, bodies)
      real(wp), allocatable :: tensor(:, :)      !! (6, bodies) xx yy zz xy yz xz about the centre
      real(wp), allocatable :: from_elements(:), from_masses(:), from_card(:)   !! (bodies) mass
      integer, allocatable :: n_node(:)          !! (bodies) secondary nodes in the full deck
      integer, allocatable :: group(:)           !! (bodies) connected group, counted from 1
      integer :: n_group = 0
      integer :: n_joint = 0, n_spring = 0, n_skew = 0, n_load = 0, n_gravity = 0, n_free = 0
      integer :: n_lost = 0                      !! conditions that lost their nodes
      real(wp) :: total = 0.0_wp, in_bodies = 0.0_wp, on_free = 0.0_wp
      type(dropped_t), allocatable :: elements(:), others(:)
      !> elements that touch two bodies or a body and others
      integer :: n_spanning = 0
      type(bridge_t), allocatable :: bridge(:)
      type(act_t), allocatable :: acts(:)
      type(lost_part_t), allocatable :: lost(:)  !! heaviest first, at most five
   end type extract_report_t

   !> Where the elements lie, springs left out: part by part
   type :: survey_t
      integer :: n(size(element_cards)) = 0      !! elements of each kind
      integer, allocatable :: n_node(:), n_lost(:)   !! (parts) their nodes, those in no body
      integer, allocatable :: n_spanning(:)      !! (parts) that touch a body and something else
      integer, allocatable :: body(:, :)         !! (2, parts) a body and another that one spans
   end type survey_t

contains

   !> Count and weigh
   subroutine new_report(draft, scales, model, keep, element_mass, report)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      type(model_t), intent(in) :: model
      type(keep_t), intent(in) :: keep
      real(wp), intent(in) :: element_mass(:)    !! (n_node)
      type(extract_report_t), intent(out) :: report

      type(survey_t) :: seen

      report%symbol = draft%deck%work%symbol
      call tell_bodies(draft, model, element_mass, report)
      call tell_counts(draft, keep, report)
      call tell_mass(draft, model, keep, report)
      call tell_links(draft, keep, report)
      call survey(draft, seen)
      call tell_dropped(draft, seen, report)
      call tell_bridges(draft, scales, seen, report)
      call tell_lost_parts(draft, scales, seen, report)
      call find_acts(draft, keep, report%acts)
   end subroutine new_report

   !> Mass, centre and inertia of the bodies, and where the mass comes from
   subroutine tell_bodies(draft, model, element_mass, report)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      real(wp), intent(in) :: element_mass(:)
      type(extract_report_t), intent(inout) :: report

      real(wp) :: axes(3, 3), j(3, 3)
      integer :: b, n, i

      n = model%n_body
      report%body_id = model%body_id
      report%mass = model%mass(:n)
      report%centre = transpose(model%x0(:n, :))
      report%principal = transpose(model%principal(:n, :))
      allocate (report%tensor(6, n), report%from_elements(n), report%from_masses(n), &
         source=0.0_wp)
      allocate (report%body_name(n), report%main(n), report%n_node(n))
      report%n_node = 0
      do b = 1, n
         report%body_name(b)%s = model%body_name(b)%s
         report%main(b) = model%node_id(b)
         axes = reshape(model%axes(b, :), [3, 3])
         j = matmul(axes*spread(model%principal(b, :), 1, 3), transpose(axes))
         report%tensor(:, b) = [j(1, 1), j(2, 2), j(3, 3), j(1, 2), j(2, 3), j(1, 3)]
      end do
      do i = 1, draft%n_node
         b = body_of(draft, i)
         if (draft%body(i) > 0) report%n_node(b) = report%n_node(b) + 1
         if (b == 0) cycle
         report%from_elements(b) = report%from_elements(b) + element_mass(i)
         report%from_masses(b) = report%from_masses(b) + draft%mass(i) - element_mass(i)
      end do
      report%from_card = report%mass - report%from_elements - report%from_masses
   end subroutine tell_bodies

   !> Numbers of what is kept
   subroutine tell_counts(draft, keep, report)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(in) :: keep
      type(extract_report_t), intent(inout) :: report

      integer :: i, property

      do i = 1, draft%elements%n
         if (.not. keep%spring(i)) cycle
         property = draft%property_block(draft%part_property(draft%elements%part(i)))
         if (any(draft%deck%block(property)%keyword == [KW_KJOINT, KW_KJOINT2])) then
            report%n_joint = report%n_joint + 1
         else
            report%n_spring = report%n_spring + 1
         end if
      end do
      report%n_skew = count(keep%skew .and. .not. keep%fixed_skew .and. draft%skews%dir > 0)
      do i = 1, draft%deck%n_block
         if (.not. keep%block(i)) cycle
         if (draft%deck%block(i)%keyword == KW_GRAV) report%n_gravity = report%n_gravity + 1
         if (draft%deck%block(i)%keyword == KW_CLOAD) report%n_load = report%n_load + 1
      end do
      report%n_free = keep%n_free
      report%n_lost = keep%n_lost
   end subroutine tell_counts

   !> Mass in bodies, on kept free nodes, and in all
   subroutine tell_mass(draft, model, keep, report)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      type(keep_t), intent(in) :: keep
      type(extract_report_t), intent(inout) :: report

      integer :: i

      report%in_bodies = sum(model%mass(:model%n_body))
      report%total = report%in_bodies
      do i = 1, draft%n_node
         if (body_of(draft, i) > 0) cycle
         report%total = report%total + draft%mass(i)
         if (keep%node(i)) report%on_free = report%on_free + draft%mass(i)
      end do
   end subroutine tell_mass

   !> Bodies that joints and springs hold together
   subroutine tell_links(draft, keep, report)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(in) :: keep
      type(extract_report_t), intent(inout) :: report

      integer, allocatable :: parent(:), number(:)
      integer :: i, n, k, a, b, root, other

      n = size(report%body_id)
      allocate (parent(n + draft%n_node))        ! bodies, then nodes that are free
      parent = [(i, i=1, size(parent))]
      do i = 1, draft%elements%n
         if (.not. keep%spring(i)) cycle
         a = place(draft%elements%node(1, i))
         b = place(draft%elements%node(2, i))
         call find_root(a, parent, root)
         call find_root(b, parent, other)
         parent(other) = root
      end do
      allocate (report%group(n), number(size(parent)))
      number = 0
      do k = 1, n
         call find_root(k, parent, root)
         if (number(root) == 0) then
            report%n_group = report%n_group + 1
            number(root) = report%n_group
         end if
         report%group(k) = number(root)
      end do

   contains

      pure integer function place(raw)
         integer, intent(in) :: raw

         place = body_of(draft, raw)
         if (place == 0) place = n + max(1, raw)
      end function place
   end subroutine tell_links

   !> Read each element once more, now that the bodies are known
   subroutine survey(draft, seen)
      type(draft_t), intent(inout) :: draft
      type(survey_t), intent(out) :: seen

      type(element_t) :: e
      integer :: block, n

      n = size(draft%part_block)
      allocate (seen%n_node(n), seen%n_lost(n), seen%n_spanning(n), seen%body(2, n), source=0)
      do block = 1, draft%deck%n_block
         if (element_row(draft%deck%block(block)%keyword) == 0) cycle
         if (draft%deck%block(block)%keyword == KW_SPRING) cycle
         call first_element(draft, block, e)
         do
            call next_element(draft, e)
            if (e%row == 0) exit
            seen%n(e%row) = seen%n(e%row) + 1
            if (e%part > 0) call survey_element(draft, e, seen)
         end do
      end do
   end subroutine survey

   subroutine survey_element(draft, e, seen)
      type(draft_t), intent(in) :: draft
      type(element_t), intent(in) :: e
      type(survey_t), intent(inout) :: seen

      integer :: i, body, first, second, n, n_lost

      first = 0
      second = 0
      n = 0
      n_lost = 0
      do i = 1, element_cards(e%row)%members
         if (e%raw(i) == 0) cycle
         n = n + 1
         body = body_of(draft, e%raw(i))
         if (body == 0) n_lost = n_lost + 1
         if (body > 0 .and. first == 0) first = body
         if (body > 0 .and. body /= first) second = body
      end do
      seen%n_node(e%part) = seen%n_node(e%part) + n
      seen%n_lost(e%part) = seen%n_lost(e%part) + n_lost
      if (first == 0 .or. (second == 0 .and. n_lost == 0)) return
      seen%n_spanning(e%part) = seen%n_spanning(e%part) + 1
      associate (pair => seen%body(:, e%part))
         if (pair(2) == 0 .and. second > 0) pair = [first, second]
         if (pair(1) == 0) pair(1) = first
      end associate
   end subroutine survey_element

   !> Elements by kind, and blocks that are not in the mechanism by keyword
   subroutine tell_dropped(draft, seen, report)
      type(draft_t), intent(in) :: draft
      type(survey_t), intent(in) :: seen
      type(extract_report_t), intent(inout) :: report

      integer :: i

      allocate (report%elements(0), report%others(0))
      do i = 1, size(seen%n)
         if (seen%n(i) > 0) call count_up(report%elements, element_cards(i)%name, seen%n(i))
      end do
      do i = 1, draft%deck%n_block
         associate (b => draft%deck%block(i))
            if (b%row > 0 .and. b%keyword == 0) call count_up(report%others, &
               keywords(b%row)%name, 1)
         end associate
      end do
      do i = 1, draft%elements%n
         if (draft%elements%part(i) == 0) cycle
         if (draft%part_property(draft%elements%part(i)) == 0) call count_up(report%elements, &
            'springs', 1)
      end do
   end subroutine tell_dropped

   pure subroutine count_up(list, name, n)
      type(dropped_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: name
      integer, intent(in) :: n

      integer :: i

      do i = 1, size(list)
         if (list(i)%name /= name) cycle
         list(i)%n = list(i)%n + n
         return
      end do
      list = [list, dropped_t(name, n)]
   end subroutine count_up

   !> Elements that touch a body and something else: part by part
   subroutine tell_bridges(draft, scales, seen, report)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      type(survey_t), intent(in) :: seen
      type(extract_report_t), intent(inout) :: report

      type(bridge_t) :: b
      integer :: part, n

      report%n_spanning = sum(seen%n_spanning)
      allocate (report%bridge(0))
      do part = 1, size(draft%part_block)
         if (seen%n_spanning(part) == 0) cycle
         b = bridge_t(title=text_t())
         b%part = draft%deck%block(draft%part_block(part))%id
         b%n = seen%n_spanning(part)
         b%title%s = title_of(draft%deck, draft%part_block(part))
         if (scales%part_material(part) > 0) &
            b%void = scales%material(scales%part_material(part))%void
         associate (first => seen%body(1, part), second => seen%body(2, part))
            b%body(1) = report%body_id(first)
            if (second > 0) then
               b%body(2) = report%body_id(second)
               b%alone = report%group(first) /= report%group(second) .and. .not. b%void
            end if
         end associate
         report%bridge = [report%bridge, b]
      end do
      n = count(report%bridge%alone)
      if (n == 0) return
      b = report%bridge(findloc(report%bridge%alone, .true., 1))
      call report_header(draft%deck, draft%part_block(find(draft%part, b%part)), SEV_WARNING, &
         'KJ-9429', 'bodies '//str(b%body(1))//' and '//str(b%body(2))//' are held together by '// &
         str(b%n)//' elements of this part alone: in the mechanism they fall apart', &
         str(n)//' parts of this kind')
   end subroutine tell_bridges

   !> The five heaviest parts with mass outside of bodies
   subroutine tell_lost_parts(draft, scales, seen, report)
      type(draft_t), intent(in) :: draft
      type(scales_t), intent(in) :: scales
      type(survey_t), intent(in) :: seen
      type(extract_report_t), intent(inout) :: report

      integer :: k
      type(lost_part_t) :: lost
      integer :: part(1)
      real(wp), allocatable :: mass(:)

      allocate (report%lost(0), mass(size(draft%part_block)))
      mass = scales%part_mass*real(seen%n_lost, wp)/real(max(1, seen%n_node), wp)
      do k = 1, min(5, size(mass))
         part = maxloc(mass)
         if (.not. mass(part(1)) > 0.0_wp) exit
         lost%id = draft%deck%block(draft%part_block(part(1)))%id
         lost%title%s = title_of(draft%deck, draft%part_block(part(1)))
         lost%mass = mass(part(1))
         report%lost = [report%lost, lost]
         mass(part(1)) = 0.0_wp
      end do
   end subroutine tell_lost_parts

end module kj_extract_report
