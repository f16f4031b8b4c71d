!> Cards -> draft: parts, and the elements of /SPRING blocks with their nodes.
module kj_build_part
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, new_lookup, find
   use kj_keywords, only: KW_PART, KW_SPRING, KW_KJOINT, KW_KJOINT2, KW_SPRING4, KW_SPRING8, &
      KW_MAT_VOID, KW_OTHER, keywords
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, read_cards, read_rows, int_of, report, report_row, report_header
   use kj_draft, only: draft_t, blocks_of, block_lookup, reference, report_double_blocks, known_ids
   implicit none
   private

   public :: build_parts

contains

   !> Parts and elements; draft%property_block holds the properties of all kinds
   subroutine build_parts(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      type(lookup_t) :: material
      type(cards_t) :: cards
      integer, allocatable :: materials(:)
      integer :: i, place

      draft%property_block = [blocks_of(deck, KW_KJOINT), blocks_of(deck, KW_KJOINT2), &
         blocks_of(deck, KW_SPRING4), blocks_of(deck, KW_SPRING8)]
      call report_double_blocks(deck, draft%property_block, 'property', findings)
      call block_lookup(deck, draft%property_block, draft%property)
      materials = blocks_of(deck, KW_MAT_VOID)
      do i = 1, size(materials)   ! their card is optional and used for nothing, but is of numbers
         if (deck%block(materials(i))%last > deck%block(materials(i))%first) &
            call read_cards(deck, materials(i), cards, findings)
      end do
      materials = [materials, other_materials(deck)]
      call block_lookup(deck, materials, material)
      draft%part_block = blocks_of(deck, KW_PART)
      call block_lookup(deck, draft%part_block, draft%part)
      call report_double_blocks(deck, draft%part_block, 'part', findings)
      allocate (draft%part_property(size(draft%part_block)))
      do i = 1, size(draft%part_block)
         call read_cards(deck, draft%part_block(i), cards, findings)
         draft%part_property(i) = reference(deck, cards, 'prop_id', draft%property, 'property', &
            'KJ-0178', findings)
         if (int_of(cards, 'prop_id') == 0) call report(deck, cards, 'prop_id', SEV_ERROR, &
            'KJ-0178', 'the part has no property', 'expected: id of a property', findings)
         place = reference(deck, cards, 'mat_id', material, 'material', 'KJ-0179', findings)
         if (int_of(cards, 'Irigid') /= 0) call report(deck, cards, 'Irigid', SEV_ERROR, &
            'KJ-9131', 'rigid parts are not supported', 'expected: 0', findings, &
            hint='put the nodes of the part into a /RBODY')
      end do
      call read_elements(deck, draft, findings)
      if (size(draft%part_block) == 0 .and. deck%n_block > 0) call report_header(deck, 1, &
         SEV_WARNING, 'KJ-1114', 'the deck has no /PART, so no joint', 'this deck', findings)
   end subroutine build_parts

   !> Blocks of materials that --ignore-unsupported let pass
   pure function other_materials(deck) result(list)
      type(deck_t), intent(in) :: deck
      integer, allocatable :: list(:)

      integer :: i
      logical :: is_material(deck%n_block)

      is_material = .false.
      do i = 1, deck%n_block
         if (deck%block(i)%keyword /= KW_OTHER .or. deck%block(i)%row == 0) cycle
         is_material(i) = keywords(deck%block(i)%row)%name == '/MAT'
      end do
      list = pack([(i, i=1, deck%n_block)], is_material)
   end function other_materials

   !> Cards of all /SPRING blocks, the parts they belong to, and double ids
   subroutine read_elements(deck, draft, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(inout) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: id(:), block(:), row(:)
      integer :: b, i, n, part

      associate (e => draft%elements)
         e%block = blocks_of(deck, KW_SPRING)
         allocate (e%rows(size(e%block)))
         do b = 1, size(e%block)
            call read_rows(deck, e%block(b), e%rows(b), findings)
         end do
         e%n = sum(e%rows%n)
         allocate (e%part(e%n), e%node(2, e%n), id(e%n), block(e%n), row(e%n))
         n = 0
         do b = 1, size(e%block)
            part = find(draft%part, deck%block(e%block(b))%id)
            if (part == 0 .and. e%rows(b)%n > 0) call report_header(deck, e%block(b), SEV_ERROR, &
               'KJ-0402', 'part '//str(deck%block(e%block(b))%id)// &
               ' of these elements is not defined', 'the id is that of a part', findings, &
               hint=known_ids(draft%part, 'part'))
            do i = 1, e%rows(b)%n
               n = n + 1
               e%part(n) = part
               e%node(1, n) = find(draft%node, e%rows(b)%ints(i, 2))
               e%node(2, n) = find(draft%node, e%rows(b)%ints(i, 3))
               id(n) = e%rows(b)%ints(i, 1)
               block(n) = b
               row(n) = i
            end do
         end do
         call new_lookup(id, e%id)
         call new_lookup(e%part, e%of_part)
         do i = 2, e%n
            if (e%id%id(i) /= e%id%id(i - 1)) cycle
            n = e%id%place(i)
            b = block(n)
            call report_row(deck, e%block(b), e%rows(b), row(n), 'id', SEV_ERROR, 'KJ-0079', &
               'element '//str(e%id%id(i))//' is defined twice', 'used before', findings)
         end do
      end associate
   end subroutine read_elements

end module kj_build_part
