!> What the builder knows of a deck before nodes are numbered: entities in deck order, and the
!> lookups from user ids to them.
module kj_draft
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR
   use kj_sort, only: lookup_t, new_lookup, find
   use kj_keywords, only: keywords, OUT_OF_SCOPE
   use kj_deck_text, only: deck_t, line_text, place_of
   use kj_cards, only: cards_t, rows_t, int_of, report, report_header
   use kj_curve, only: curve_set_t
   use kj_model, only: skew_set_t
   implicit none
   private

   public :: draft_t, sensor_t, group_t, elements_t, blocks_of, block_lookup, reference, &
      group_nodes, report_double_blocks, known_ids

   !> A set of nodes
   type :: group_t
      integer :: block = 0                       !! of the deck
      integer, allocatable :: node(:)            !! raw node indices, ascending user id
   end type group_t

   !> A sensor of time
   type :: sensor_t
      real(wp) :: t_start = 0.0_wp, t_stop = huge(1.0_wp)
   end type sensor_t

   !> The elements of all /SPRING blocks, in deck order
   type :: elements_t
      integer :: n = 0
      integer, allocatable :: block(:)           !! (blocks) of the deck
      type(rows_t), allocatable :: rows(:)       !! (blocks) their cards
      integer, allocatable :: part(:)            !! (n) place of the part, 0 = not defined
      integer, allocatable :: node(:, :)         !! (2, n) raw node indices, 0 = not defined
      type(lookup_t) :: id                       !! of the elements
      type(lookup_t) :: of_part                  !! elements by the place of their part
   end type elements_t

   !> Everything in deck order; node indices are "raw": places in the deck
   type :: draft_t
      logical :: legacy = .false.                !! unit factors as OpenRadioss has them
      integer :: n_node = 0
      integer, allocatable :: id(:)
      real(wp), allocatable :: x(:, :)           !! (n_node, 3)
      real(wp), allocatable :: mass(:), inertia(:)
      type(lookup_t) :: node
      !> body that carries the node as secondary, 0 = none
      integer, allocatable :: body(:)
      integer, allocatable :: main_of(:)         !! body whose main node it is, 0 = none
      integer, allocatable :: new(:)             !! raw index -> model index
      ! others
      type(lookup_t) :: group, skew, curve, sensor, part, property, body_id
      type(group_t), allocatable :: groups(:)
      type(skew_set_t) :: skews                  !! nodes are raw indices
      type(lookup_t) :: frame
      type(skew_set_t) :: frames                 !! axes at the start
      real(wp), allocatable :: frame_origin(:, :)   !! (0:n, 3) at the start
      type(curve_set_t) :: curves
      type(sensor_t), allocatable :: sensors(:)
      type(elements_t) :: elements
      integer, allocatable :: part_block(:), body_block(:)
      integer, allocatable :: property_block(:)  !! KJOINT, KJOINT2, then springs of types 4 and 8
      integer, allocatable :: part_property(:)   !! place in property_block, 0 = none
   end type draft_t

   !> How a header begins that could define what a field names
   type :: family_t
      character(len=12) :: what
      character(len=8) :: head
   end type family_t

   type(family_t), parameter :: families(*) = [ &
      family_t('node group', '/GRNOD'), family_t('node group', '/SET'), &
      family_t('skew', '/SKEW'), family_t('frame', '/FRAME'), family_t('function', '/FUNCT'), &
      family_t('sensor', '/SENSOR'), family_t('property', '/PROP'), family_t('box', '/BOX'), &
      family_t('material', '/MAT')]

contains

   !> Indices of the blocks of one keyword, in deck order
   pure function blocks_of(deck, keyword) result(list)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: keyword             !! KW_ constant
      integer, allocatable :: list(:)

      integer :: i

      list = pack([(i, i=1, deck%n_block)], deck%block(:deck%n_block)%keyword == keyword)
   end function blocks_of

   !> Lookup from the header ids of blocks to their place in the list
   pure subroutine block_lookup(deck, list, lookup)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: list(:)
      type(lookup_t), intent(out) :: lookup

      call new_lookup(deck%block(list)%id, lookup)
   end subroutine block_lookup

   !> Two blocks of one family with the same id: every one but the first is reported
   subroutine report_double_blocks(deck, blocks, what, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: blocks(:)
      character(len=*), intent(in) :: what
      type(finding_list_t), intent(inout) :: findings

      type(lookup_t) :: lookup
      character(len=:), allocatable :: file
      integer :: i, number

      call block_lookup(deck, blocks, lookup)
      do i = 2, size(blocks)
         if (lookup%id(i) /= lookup%id(i - 1)) cycle
         call place_of(deck, deck%block(blocks(lookup%place(i - 1)))%header, file, number)
         call report_header(deck, blocks(lookup%place(i)), SEV_ERROR, 'KJ-0079', &
            what//' '//str(lookup%id(i))//' is defined twice', 'used before', findings, &
            hint='before: '//file//':'//str(number))
      end do
   end subroutine report_double_blocks

   !> Place of the entity that a field names; 0 when the field is 0 or names nothing (then reported)
   integer function reference(deck, cards, name, lookup, what, id, findings) result(place)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name       !! of the field
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what       !! "skew", "function", ...
      character(len=*), intent(in) :: id         !! message id
      type(finding_list_t), intent(inout) :: findings

      integer :: block

      place = 0
      if (int_of(cards, name) == 0) return
      place = find(lookup, int_of(cards, name))
      if (place > 0) return
      block = unsupported(deck, what, int_of(cards, name))
      if (block > 0) then
         call report(deck, cards, name, SEV_ERROR, 'KJ-9139', what//' '// &
            str(int_of(cards, name))//' is of a kind that is not supported', &
            'defined by '//line_text(deck, deck%block(block)%header), findings)
      else
         call report(deck, cards, name, SEV_ERROR, id, what//' '//str(int_of(cards, name))// &
            ' is not defined', 'no such '//what, findings, hint=known_ids(lookup, what))
      end if
   end function reference

   !> Block out of scope that defines an entity; 0 when there is none
   pure integer function unsupported(deck, what, id) result(block)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: what
      integer, intent(in) :: id

      integer :: i

      do block = 1, deck%n_block
         if (deck%block(block)%id /= id .or. deck%block(block)%row == 0) cycle
         associate (row => keywords(deck%block(block)%row))
            if (row%status /= OUT_OF_SCOPE) cycle
            do i = 1, size(families)
               if (families(i)%what == what .and. index(row%name, trim(families(i)%head)) == 1) &
                  return
            end do
         end associate
      end do
      block = 0
   end function unsupported

   !> "defined: 1 2 5 ..." for hints
   pure function known_ids(lookup, what) result(text)
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what
      character(len=160) :: text

      integer :: i

      text = 'the deck defines no '//what
      if (size(lookup%id) == 0) return
      text = 'defined:'
      do i = 1, min(12, size(lookup%id))
         text = trim(text)//' '//str(lookup%id(i))
      end do
      if (size(lookup%id) > 12) text = trim(text)//' ...'
   end function known_ids

   !> Raw indices of the nodes of the group that a field names.
   !>
   !> A field 0 or blank names none; where `needed`, that is an error.
   subroutine group_nodes(draft, deck, cards, name, id, needed, findings, nodes)
      type(draft_t), intent(in) :: draft
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name, id   !! field and message id
      logical, intent(in) :: needed
      type(finding_list_t), intent(inout) :: findings
      integer, allocatable, intent(out) :: nodes(:)

      integer :: place

      allocate (nodes(0))
      place = reference(deck, cards, name, draft%group, 'node group', id, findings)
      if (place > 0) nodes = draft%groups(place)%node
      if (int_of(cards, name) == 0 .and. needed) call report(deck, cards, name, SEV_ERROR, id, &
         'no node group is named', 'expected: id of a node group', findings, &
         hint=known_ids(draft%group, 'node group'))
   end subroutine group_nodes

end module kj_draft
