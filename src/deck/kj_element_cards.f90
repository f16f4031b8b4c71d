!> THE table of the cards of elements, and their reader. An element is read when somebody asks for
!> its nodes, and never kept.
module kj_element_cards
   use kj_keywords, only: KW_SHELL, KW_SH3N, KW_BRICK, KW_TETRA4, KW_PENTA6, KW_TETRA10, &
      KW_BRIC20, KW_SHEL16, KW_BEAM, KW_TRUSS, KW_SPRING, KW_GRSHEL, KW_GRSH3N, KW_GRBRIC, &
      KW_GRBEAM, KW_GRTRUS, KW_GRSPRI, KW_NODE
   use kj_deck_text, only: deck_t, id_shift, first_card, put_text, report_file
   use kj_field, only: OF_ELEMENT, OF_NODE
   use kj_card_cut, only: cut_t, cut_card, read_integer_at
   use kj_number, only: parse_integer, NUMBER_FINE, NUMBER_BLANK
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_file_lines, only: stand_at, take_next
   implicit none
   private

   public :: element_row, stays_in_file, read_element, card_walk_t, start_walk, next_card

   !> Where a walk stands
   type :: card_walk_t
      integer :: block = 0                      !! index in deck
      integer :: line = 0                       !! index in deck of the card under way
      integer :: next = 0                       !! the same of the next one
      integer(int64) :: at = 0                  !! in the file: bytes before the next one
      integer :: number = 0                     !! in the file: number of the line under way
   end type card_walk_t

   integer, parameter, public :: MOST_NODES = 20

   !> A row: integers of ten columns each, the id first, then nodes
   type :: element_cards_t
      integer           :: keyword       !! KW_ constant
      integer           :: group         !! KW_ constant of the groups of its kind
      integer           :: ints(3)       !! integers on cards 1, 2, 3; 0 = no such card
      integer           :: members       !! nodes that belong to it; those after them only orient it
      character(len=10) :: name          !! of many of them
   end type element_cards_t

   type(element_cards_t), parameter, public :: element_cards(*) = [ &
      element_cards_t(KW_SHELL,   KW_GRSHEL, [5, 0, 0],   4, 'shells'), &
      element_cards_t(KW_SH3N,    KW_GRSH3N, [4, 0, 0],   3, 'triangles'), &
      element_cards_t(KW_BRICK,   KW_GRBRIC, [9, 0, 0],   8, 'solids'), &
      element_cards_t(KW_TETRA4,  KW_GRBRIC, [5, 0, 0],   4, 'solids'), &
      element_cards_t(KW_PENTA6,  KW_GRBRIC, [7, 0, 0],   6, 'solids'), &
      element_cards_t(KW_TETRA10, KW_GRBRIC, [1, 10, 0], 10, 'solids'), &
      element_cards_t(KW_BRIC20,  KW_GRBRIC, [9, 8, 4],  20, 'solids'), &
      element_cards_t(KW_SHEL16,  KW_GRBRIC, [9, 4, 4],  16, 'solids'), &
      element_cards_t(KW_BEAM,    KW_GRBEAM, [4, 0, 0],   2, 'beams'), &
      element_cards_t(KW_TRUSS,   KW_GRTRUS, [3, 0, 0],   2, 'trusses'), &
      element_cards_t(KW_SPRING,  KW_GRSPRI, [7, 0, 0],   6, 'springs')]

contains

   !> Row of a keyword; 0 when it is no element
   pure integer function element_row(keyword) result(row)
      integer, intent(in) :: keyword             !! KW_ constant

      do row = size(element_cards), 1, -1
         if (element_cards(row)%keyword == keyword) return
      end do
   end function element_row

   !> The cards of a block stay in the file of a full deck: those of nodes and elements do
   pure logical function stays_in_file(keyword)
      integer, intent(in) :: keyword             !! KW_ constant

      stays_in_file = keyword == KW_NODE .or. &
         (element_row(keyword) > 0 .and. keyword /= KW_SPRING)
   end function stays_in_file

   !> The next element of a walk; a card that is missing reads as zeros
   !>
   !> Goes on after a wrong field: it reads as 0, and a finding tells of it.
   subroutine read_element(deck, row, walk, id, node, there)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: row                 !! of the table
      type(card_walk_t), intent(inout) :: walk
      integer, intent(out) :: id
      integer, intent(out) :: node(MOST_NODES)   !! ids, 0 = none
      logical, intent(out) :: there              !! .false.: the block has no more

      integer :: value(MOST_NODES + 1), n, card
      logical :: has_card

      value = 0
      n = 0
      there = .false.
      do card = 1, 3
         if (element_cards(row)%ints(card) == 0) exit
         call next_card(deck, walk, card, has_card)
         if (has_card) call read_card(deck, walk%line, element_cards(row)%ints(card), &
            value(n + 1:))
         there = there .or. has_card
         n = n + element_cards(row)%ints(card)
      end do
      associate (b => deck%block(walk%block))
         if (b%n_far > 0 .and. b%submodel > 0) then   ! those in lines are shifted there
            call shift(id_shift(deck, b%submodel, OF_ELEMENT), value(1))
            call shift(id_shift(deck, b%submodel, OF_NODE), value(2:))
         end if
      end associate
      id = value(1)
      node = value(2:)

   contains

      elemental subroutine shift(by, value)
         integer, intent(in) :: by
         integer, intent(inout) :: value

         if (value /= 0) value = sign(abs(value) + by, value)
      end subroutine shift
   end subroutine read_element

   !> n integers of a line
   subroutine read_card(deck, line, n, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line, n
      integer, intent(inout) :: value(:)         !! (>= n)

      integer :: i, status, s, first, width

      s = deck%line_source(line)
      first = deck%line_first(line)
      width = deck%line_last(line) - first + 1
      do i = 1, n
         if (width < 10*i - 9) return
         call parse_integer(deck%source(s)%text(first + 10*i - 10:first + min(10*i, width) - 1), &
            value(i), status)
         if (status == NUMBER_FINE .or. status == NUMBER_BLANK) cycle
         call read_odd_card(deck, line, n, value)
         return
      end do
   end subroutine read_card

   !> The same for a line that is cut at commas, or wrong
   subroutine read_odd_card(deck, line, n, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line, n
      integer, intent(inout) :: value(:)

      type(cut_t) :: cut
      integer :: i, s

      s = deck%line_source(line)
      call cut_card(deck%source(s)%text(deck%line_first(line):deck%line_last(line)), n, &
         [(10*i - 9, i=1, n)], [(10*i, i=1, n)], cut)
      do i = 1, n
         call read_integer_at(deck, line, cut%first(i), cut%last(i), 'the id', 'an id', value(i))
      end do
   end subroutine read_odd_card

   !> Stand before the first card of a block
   pure subroutine start_walk(deck, block, walk)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(card_walk_t), intent(out) :: walk

      walk%block = block
      walk%next = first_card(deck, block)
      walk%at = deck%block(block)%from
      walk%number = deck%block(block)%number
   end subroutine start_walk

   !> Go on to the next card: walk%line; there = .false. at the end of the block
   !>
   !> In the file walk%line holds until the first card of another element is asked for.
   subroutine next_card(deck, walk, card, there)
      type(deck_t), intent(inout) :: deck
      type(card_walk_t), intent(inout) :: walk
      integer, intent(in) :: card               !! 1, 2 or 3: number in its element
      logical, intent(out) :: there

      integer :: first, last, used, file

      associate (b => deck%block(walk%block))
         if (b%n_far == 0) then
            there = walk%next <= b%last
            if (there) walk%line = walk%next
            if (there) walk%next = walk%next + 1
            return
         end if
         file = deck%line_source(b%header)
         call stand_at(deck%far, deck%source(file)%path, walk%at, walk%number)
         do
            there = walk%at < b%to
            if (.not. there) return
            call take_next(deck%far, first, last, there)
            if (.not. there) exit
            walk%at = deck%far%start + deck%far%next - 1
            if (last < first) exit
            if (scan(deck%far%text(first:first), '#$') == 0) exit
         end do
         walk%number = deck%far%number
         if (.not. there) then
            call report_file(deck, deck%source(file)%path, 'KJ-9030', 'the deck cannot be read '// &
               'again: '//deck%far%problem, 'read before')
            b%to = walk%at                      ! nothing is left of the block
            return
         end if
      end associate
      walk%line = deck%far_line + card - 1
      used = 0
      if (card > 1) used = deck%line_last(walk%line - 1)
      call put_text(deck%far%text(first:last), used, deck%source(deck%far_source)%text)
      deck%source(deck%far_source)%path = deck%far%path
      deck%line_number(walk%line) = walk%number
      deck%line_first(walk%line) = used + 1
      deck%line_last(walk%line) = used + last - first + 1
   end subroutine next_card

end module kj_element_cards
