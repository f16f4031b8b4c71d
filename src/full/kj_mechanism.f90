!> The mechanism of a full deck: read it, take the mechanism out, read that as any deck.
!>
!> What runs is the text that `kjoint extract` writes: the file and the run in memory are one.
module kj_mechanism
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, add_finding, str, SEV_WARNING
   use kj_sort, only: find, lower_bound
   use kj_keywords, only: KW_SPRING, KW_ADMAS, KW_GRPART, KW_RBE2, KW_RBODY
   use kj_deck_text, only: deck_t, source_t, add_source, block_at, FLAT, PIECE, first_card, &
      kind_word
   use kj_deck, only: read_deck
   use kj_parameter, only: setting_t
   use kj_draft, only: draft_t, blocks_with
   use kj_model, only: model_t
   use kj_element_mass, only: scales_t, element_t, first_element, next_element, weigh, new_scales, &
      weigh_elements, weigh_block
   use kj_keep, only: keep_t, decide
   use kj_acts, only: check_unweighed
   use kj_extract, only: write_mechanism, page_t, new_page
   use kj_extract_report, only: extract_report_t, new_report
   use kj_math3, only: cross
   use kj_cards, only: cards_t, rows_t, read_cards, read_rows, real_of, int_of, report, &
      report_row, &
      row_of
   use kj_card_lists, only: ids_t, read_id_lines
   use kj_element_cards, only: element_row
   use kj_build_scene, only: build_nodes, build_masses, build_curves, build_sensors, &
      check_analysis, build_parts
   use kj_build_axes, only: build_skews, build_frames, move_nodes
   use kj_build_group, only: build_groups
   use kj_build_body, only: build_bodies
   use kj_node_list, only: faces_t
   use kj_select, only: surface_of, parts_of, OUTERMOST
   implicit none
   private

   public :: take_mechanism

   character(len=8), parameter :: ROLE = 'extract'

contains

   !> The deck of the mechanism; its lines that are copies keep their places in the full deck
   !>
   !> Errors: findings. deck%readable is .false. when there is no deck.
   subroutine take_mechanism(path, settings, findings, deck, report)
      character(len=*), intent(in) :: path
      type(setting_t), intent(in) :: settings(:) !! parameters from outside
      type(finding_list_t), intent(in) :: findings
      !> a new one, but for ignore_random; its findings are those of both decks
      type(deck_t), intent(inout) :: deck
      type(extract_report_t), intent(out) :: report

      type(draft_t) :: draft
      type(scales_t) :: scales
      type(model_t) :: model
      type(keep_t) :: keep
      type(page_t) :: page
      real(wp), allocatable :: element_mass(:), spring_mass(:), spring_inertia(:)
      integer, allocatable :: kept(:)
      integer :: i
      integer, allocatable :: files(:)

      draft%deck%findings = findings
      draft%deck%ignore_random = deck%ignore_random
      call read_deck(path, draft%deck, full=.true., settings=settings)
      if (draft%deck%readable) then
         call build_full_draft(draft, scales, element_mass, model)
         call check_unweighed(draft, scales)
      end if
      ! bodies that a sensor makes later, an error, can be weighed all the same
      if (draft%deck%findings%n_error == count([(draft%deck%findings%item(i)%id == 'KJ-9116', &
         i=1, draft%deck%findings%n)]) .and. draft%deck%readable) then
         call decide(draft, element_mass, keep)
         kept = pack([(i, i=1, draft%n_node)], keep%node)
         call weigh_kept_springs(draft, scales, keep, kept, spring_mass, spring_inertia)
         call new_page(page)
         call write_mechanism(draft, model, keep, kept, spring_mass, spring_inertia, page)
         call new_report(draft, scales, model, keep, element_mass, report)
      end if
      deck%findings = draft%deck%findings
      deck%readable = draft%deck%findings%n_error == 0 .and. draft%deck%readable
      if (.not. deck%readable) return
      report%text = page%text(:page%n)
      call read_page(path, page, draft%deck, deck)
      call leave_repeats(draft%deck%findings%n, deck%findings)
      associate (role => deck%source(:deck%n_source)%role)
         files = pack([(i, i=2, deck%n_source)], role(2:) /= FLAT .and. role(2:) /= PIECE)
      end associate
      allocate (report%input(size(files)))
      do i = 1, size(files)
         report%input(i)%s = deck%source(files(i))%path
      end do
   end subroutine take_mechanism

   !> Leave out what the full deck was told before: the format version, its units
   subroutine leave_repeats(n_full, findings)
      integer, intent(in) :: n_full              !! findings of the full deck, the first ones
      type(finding_list_t), intent(inout) :: findings

      type(finding_list_t) :: all
      integer :: i, k

      if (findings%n_left > 0) return            ! counts that no list explains
      all = findings
      findings = finding_list_t()
      do i = 1, all%n
         do k = 1, min(n_full, i - 1)
            if (all%item(k)%id == all%item(i)%id .and. all%item(k)%message == all%item(i)%message) &
               exit
         end do
         if (k > min(n_full, i - 1) .or. i <= n_full) call add_finding(findings, all%item(i))
      end do
   end subroutine leave_repeats

   !> Mass and inertia that kept springs put on nodes
   subroutine weigh_kept_springs(draft, scales, keep, kept, mass, inertia)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      type(keep_t), intent(in) :: keep
      integer, intent(in) :: kept(:)             !! raw indices of nodes, ascending
      real(wp), allocatable, intent(out) :: mass(:), inertia(:)   !! of these

      type(element_t) :: e
      integer :: block, i, at

      allocate (mass(size(kept)), inertia(size(kept)), source=0.0_wp)
      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= KW_SPRING) cycle
         call first_element(draft, block, e)
         do
            call next_element(draft, e)
            if (e%row == 0) exit
            i = find(draft%elements%id, e%id)
            if (i == 0) cycle
            if (.not. keep%spring(i)) cycle
            call weigh(draft, scales, e)
            do i = 1, 3
               if (e%raw(i) == 0 .or. .not. e%mass(i) > 0.0_wp) cycle
               at = lower_bound(kept, e%raw(i))
               mass(at) = mass(at) + e%mass(i)
               inertia(at) = inertia(at) + e%inertia(i)
            end do
         end do
      end do
   end subroutine weigh_kept_springs

   !> Read the text of the mechanism; lines that are copies point at what they are copies of
   subroutine read_page(path, page, full, deck)
      character(len=*), intent(in) :: path
      type(page_t), intent(in) :: page
      type(deck_t), intent(inout) :: full        !! its files move into `deck`
      type(deck_t), intent(inout) :: deck

      type(source_t) :: source
      integer :: i, k, first

      source%path = path//' (mechanism)'
      source%role = ROLE
      source%text = page%text(:page%n)
      call read_deck(path, deck, source=source)
      first = deck%n_source
      do i = 1, full%n_source
         call add_source(deck, full%source(i), k)
      end do
      do i = 1, deck%n_line
         if (deck%line_source(i) /= 1) cycle
         k = page%origin(deck%line_number(i))
         if (k == 0) cycle
         deck%line_source(i) = first + full%line_source(k)
         deck%line_number(i) = full%line_number(k)
         if (deck%block(max(1, block_at(deck, i)))%header == i) then      ! written anew: it stays
            deck%line_source(i) = 1
            cycle
         end if
         deck%line_first(i) = full%line_first(k)
         deck%line_last(i) = full%line_last(k)
      end do
   end subroutine read_page

   !> All of a full deck that its mechanism is made of
   subroutine build_full_draft(draft, scales, element_mass, model)
      type(draft_t), intent(inout) :: draft      !! with a deck that was read
      type(scales_t), intent(out) :: scales
      real(wp), allocatable, intent(out) :: element_mass(:)   !! (n_node) of elements but springs
      type(model_t), intent(out) :: model        !! bodies and nodes alone

      call check_analysis(draft%deck)
      call build_nodes(draft)
      call build_parts(draft)
      call move_nodes(draft)
      call build_skews(draft)
      call build_frames(draft)
      call build_groups(draft)
      call new_scales(draft, scales)
      call weigh_elements(draft, scales, springs=.false.)
      element_mass = draft%mass
      call weigh_elements(draft, scales, springs=.true.)
      call build_masses(draft)
      call add_part_masses(draft, scales)
      call build_curves(draft)
      call build_sensors(draft)
      call number_couplings(draft)
      call build_bodies(draft, model)
   end subroutine build_full_draft

   !> An /RBE2 is a body of its own; where a /RBODY has its id it gets another
   subroutine number_couplings(draft)
      type(draft_t), intent(inout) :: draft

      integer :: i, most

      associate (b => draft%deck%block(:draft%deck%n_block))
         most = maxval([0, pack(b%id, b%keyword == KW_RBODY .or. b%keyword == KW_RBE2)])
         do i = 1, size(b)
            if (b(i)%keyword /= KW_RBE2) cycle
            if (any(b%keyword == KW_RBODY .and. b%id == b(i)%id)) then
               most = most + 1
               b(i)%id = most
            end if
         end do
      end associate
   end subroutine number_couplings

   !> /ADMAS over surfaces (2) and parts (3, 6: added; 4, 7: the mass in the end)
   subroutine add_part_masses(draft, scales)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales

      type(cards_t) :: cards
      type(rows_t) :: rows
      logical, allocatable :: part(:)
      integer :: block, i

      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= KW_ADMAS) cycle
         allocate (part(size(draft%part_block)), source=.false.)
         select case (draft%deck%block(block)%variant)
         case (2)
            call read_cards(draft%deck, block, cards)
            call add_to_surface(draft, cards)
         case (3, 4)
            call read_cards(draft%deck, block, cards)
            call parts_of_group(draft, int_of(cards, 'grpart_id'), OUTERMOST, part)
            if (.not. any(part)) call report(draft%deck, cards, 'grpart_id', SEV_WARNING, &
               'KJ-9408', 'the group of parts '//str(int_of(cards, 'grpart_id'))// &
               ' has no part', 'adds no mass')
            call add_to_parts(draft, scales, part, real_of(cards, 'mass'), &
               draft%deck%block(block)%variant == 4)
         case (6, 7)
            call read_rows(draft%deck, [block], rows)
            do i = 1, rows%n
               part = draft%deck%block(draft%part_block)%id == rows%ints(i, 1)
               if (.not. any(part)) call report_row(draft%deck, row_of(rows, i), 'part_id', &
                  SEV_WARNING, 'KJ-0194', 'part '//str(rows%ints(i, 1))//' is not defined', &
                  'adds no mass')
               call add_to_parts(draft, scales, part, rows%reals(i, 1), &
                  draft%deck%block(block)%variant == 7)
            end do
         end select
         deallocate (part)
      end do
   end subroutine add_part_masses

   !> Mass of each face to its nodes, a quarter each, of triangles a third
   subroutine add_to_surface(draft, cards)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards

      type(faces_t) :: faces
      real(wp) :: x(3, 4), mass
      integer :: i, k, n

      call surface_of(draft, int_of(cards, 'surf_id'), OUTERMOST, faces)
      if (faces%n == 0) call report(draft%deck, cards, 'surf_id', SEV_WARNING, 'KJ-9408', &
         'surface '//str(int_of(cards, 'surf_id'))//' has no face', 'adds no mass')
      do i = 1, faces%n
         x = transpose(draft%x(faces%node(:, i), :))
         n = merge(3, 4, faces%node(3, i) == faces%node(4, i))
         mass = real_of(cards, 'mass')*0.5_wp*norm2(cross(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2)))
         do k = 1, n
            associate (raw => faces%node(k, i))
               draft%mass(raw) = draft%mass(raw) + mass/real(n, wp)
            end associate
         end do
      end do
   end subroutine add_to_surface

   !> Mark the parts of a /GRPART
   recursive subroutine parts_of_group(draft, id, around, part)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: id, around(:)       !! groups that it is in: a circle ends
      logical, intent(inout) :: part(:)

      type(ids_t) :: list
      character(len=10) :: word
      integer, allocatable :: blocks(:)
      integer :: i, k

      if (any(around == id)) return
      call blocks_with(draft, KW_GRPART, id, blocks)
      do i = 1, size(blocks)
         word = kind_word(draft%deck, blocks(i))
         call read_id_lines(draft%deck, first_card(draft%deck, blocks(i)), &
            draft%deck%block(blocks(i))%last, 10, 1, list)
         do k = 1, list%n
            if (word == 'GRPART') then
               call parts_of_group(draft, list%value(k), [around, id], part)
            else
               call parts_of(draft, trim(word), list%value(k), part)
            end if
         end do
      end do
   end subroutine parts_of_group

   !> Mass on the nodes of some parts, shared as their elements share theirs
   subroutine add_to_parts(draft, scales, part, mass, in_the_end)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      logical, intent(in) :: part(:)
      real(wp), intent(in) :: mass
      logical, intent(in) :: in_the_end          !! the mass that the parts have then

      real(wp) :: total, factor, of_block
      integer :: block, place, n

      total = sum(scales%part_mass, mask=part)
      if (.not. total > 0.0_wp) return
      factor = mass/total
      if (in_the_end) factor = (mass - total)/total
      do block = 1, draft%deck%n_block
         if (element_row(draft%deck%block(block)%keyword) == 0) cycle
         place = find(draft%part, draft%deck%block(block)%id)
         if (place == 0) cycle
         if (.not. part(place)) cycle
         call weigh_block(draft, scales, block, factor, .false., of_block, n)
      end do
   end subroutine add_to_parts

end module kj_mechanism
