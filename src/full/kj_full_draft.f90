!> A full deck -> its draft: nodes with the mass of all elements, groups, and bodies that are
!> weighed.
module kj_full_draft
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_WARNING
   use kj_sort, only: find
   use kj_math3, only: cross
   use kj_keywords, only: KW_ADMAS, KW_GRPART, KW_RBE2, KW_RBODY
   use kj_deck_text, only: first_card, kind_word
   use kj_cards, only: cards_t, rows_t, read_cards, read_rows, real_of, int_of, report, &
      report_row, &
      row_of
   use kj_card_lists, only: ids_t, read_id_lines
   use kj_element_cards, only: element_row
   use kj_draft, only: draft_t, blocks_with
   use kj_build_scene, only: build_nodes, build_masses, build_curves, build_sensors, &
      check_analysis, build_parts
   use kj_transform, only: move_nodes
   use kj_build_axes, only: build_skews, build_frames
   use kj_build_group, only: build_groups
   use kj_build_body, only: build_bodies
   use kj_box, only: box_set_t, build_boxes
   use kj_faces, only: faces_t
   use kj_select, only: surface_of, parts_of, OUTERMOST
   use kj_element_mass, only: scales_t, new_scales, weigh_elements, weigh_block
   use kj_model, only: model_t
   implicit none
   private

   public :: build_full_draft

contains

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

      type(box_set_t) :: boxes
      type(faces_t) :: faces
      real(wp) :: x(3, 4), mass
      integer :: i, k, n

      call build_boxes(draft, boxes)
      call surface_of(draft, boxes, int_of(cards, 'surf_id'), OUTERMOST, faces)
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

end module kj_full_draft
