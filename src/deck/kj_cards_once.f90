!> The cards that stand once in a block -> named values, each with its place.
module kj_cards_once
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_WARNING
   use kj_units, only: dimensions
   use kj_keywords, only: keywords, KW_KJOINT, KW_KJOINT2, KW_SPRING8
   use kj_card_field, only: EACH, ONCE, DOFS
   use kj_joint_types, only: DOF_NAME, NDOF, find_joint_type
   use kj_card_fields, only: fields, list_free_dofs, rotational
   use kj_deck_text, only: deck_t, add_deck_finding, block_factors, header_end
   use kj_card_cut, only: cut_t, cut_card, is_blank_text, MOST_ON_CARD
   use kj_card_values, only: read_integer_at, read_real_at, report_cut
   implicit none
   private

   public :: cards_t, read_cards, real_of, int_of, text_of, is_given, report

   integer, parameter, public :: MOST_FIELDS = 128   !! more than any keyword has

   !> Values of one block, in the order of the cards
   type :: cards_t
      integer :: block = 0                      !! index in deck
      integer :: n = 0
      integer :: n_card = 0                     !! cards in the block, title not counted
      character(len=12) :: name(MOST_FIELDS) = ''
      integer :: integer_value(MOST_FIELDS) = 0
      real(wp) :: real_value(MOST_FIELDS) = 0.0_wp   !! in work units
      character(len=20) :: text_value(MOST_FIELDS) = ''
      integer :: line(MOST_FIELDS) = 0          !! index in deck; 0 when the card is missing
      integer :: first(MOST_FIELDS) = 1         !! columns of the text, or of the blank field
      integer :: last(MOST_FIELDS) = 1
      logical :: given(MOST_FIELDS) = .false.   !! not blank
   end type cards_t

contains

   !> Read all cards of a block that stand once
   !>
   !> Goes on after a wrong field: it reads as 0, and a finding tells of it.
   subroutine read_cards(deck, block, cards, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(cards_t), intent(inout) :: cards
      type(finding_list_t), intent(inout) :: findings

      integer :: keyword, n_read, joint_type, n_dof, dof(NDOF)
      real(wp) :: factor(size(dimensions))

      cards%block = block
      cards%n = 0
      associate (b => deck%block(block))
         keyword = b%keyword
         cards%n_card = b%last - b%first + 1
         if (b%row > 0) then
            if (keywords(b%row)%titled) cards%n_card = cards%n_card - 1
         end if
         factor = block_factors(deck, block)
         n_read = 0
         call read_variant(deck, factor, EACH, cards, n_read, findings)
         joint_type = int_of(cards, 'type')
         if (keyword == KW_KJOINT) &
            call read_variant(deck, factor, joint_type, cards, n_read, findings)
         if (keyword /= KW_KJOINT) &
            call read_variant(deck, factor, b%variant, cards, n_read, findings)
         if (keyword == KW_KJOINT2 .or. keyword == KW_SPRING8) then
            call list_free_dofs(keyword, joint_type, n_dof, dof)
            call read_dofs(deck, factor, n_dof, dof, cards, n_read, findings)
            if (keyword == KW_KJOINT2 .and. find_joint_type(joint_type) == 0) return
         end if
         if (keyword == KW_KJOINT .and. n_read < 3) return
      end associate
      if (n_read > 0) call report_length(deck, cards, n_read, findings)
   end subroutine read_cards

   !> Read the cards of one variant
   subroutine read_variant(deck, factor, variant, cards, n_read, findings)
      type(deck_t), intent(in) :: deck
      real(wp), intent(in) :: factor(:)         !! one per D_ constant
      integer, intent(in) :: variant            !! of the table of fields
      type(cards_t), intent(inout) :: cards
      integer, intent(inout) :: n_read          !! number of the last card with fields
      type(finding_list_t), intent(inout) :: findings

      integer :: i, n, card, row(MOST_ON_CARD)

      n = 0
      card = 0
      associate (k => deck%block(cards%block)%keyword)
         if (k < 1) return
         do i = deck%field_first(k), deck%field_last(k)
            if (fields(i)%times /= ONCE .or. fields(i)%variant /= variant) cycle
            if (fields(i)%since > deck%version) cycle
            if (fields(i)%card /= card) then
               call read_card(deck, factor, card, n, row, '', cards, findings)
               card = fields(i)%card
               n_read = max(n_read, card)
               n = 0
            end if
            n = n + 1
            row(n) = i
         end do
      end associate
      call read_card(deck, factor, card, n, row, '', cards, findings)
   end subroutine read_variant

   !> Read the groups of cards that stand once for each direction
   subroutine read_dofs(deck, factor, n_dof, dof, cards, n_read, findings)
      type(deck_t), intent(in) :: deck
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: n_dof, dof(NDOF)      !! the directions
      type(cards_t), intent(inout) :: cards
      integer, intent(inout) :: n_read
      type(finding_list_t), intent(inout) :: findings

      integer :: d, card, i, n, row(MOST_ON_CARD)

      associate (k => deck%block(cards%block)%keyword)
         do d = 1, n_dof
            do card = 2, 4
               n = 0
               do i = deck%field_first(k), deck%field_last(k)
                  if (fields(i)%times /= DOFS .or. fields(i)%card /= card) cycle
                  n = n + 1
                  row(n) = i
               end do
               call read_card(deck, factor, 3*(d - 1) + card, n, row, DOF_NAME(dof(d)), cards, &
                  findings)
            end do
         end do
         n_read = max(n_read, 1 + 3*n_dof)
      end associate
   end subroutine read_dofs

   !> Read n fields of one card; a missing card reads as blank
   subroutine read_card(deck, factor, card, n, row, dof, cards, findings)
      type(deck_t), intent(in) :: deck
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: card               !! number in the block, title not counted
      integer, intent(in) :: n
      integer, intent(in) :: row(:)             !! (>= n) rows of the table of fields
      character(len=*), intent(in) :: dof       !! direction, '' when the card has none
      type(cards_t), intent(inout) :: cards
      type(finding_list_t), intent(inout) :: findings

      type(cut_t) :: cut
      integer :: i, line, source, first(MOST_ON_CARD), last(MOST_ON_CARD)

      if (n == 0) return
      line = 0
      if (card <= cards%n_card) line = deck%block(cards%block)%last - cards%n_card + card
      if (line > 0) then
         source = deck%line_source(line)
         first(:n) = fields(row(:n))%first
         last(:n) = fields(row(:n))%last
         call cut_card(deck%source(source)%text(deck%line_first(line):deck%line_last(line)), n, &
            first(:n), last(:n), cut)
         call report_cut(deck, line, cut, findings)
      end if
      do i = 1, n
         call add_value(deck, factor, line, row(i), dof, cut%first(i), cut%last(i), cards, findings)
      end do
   end subroutine read_card

   !> Append one field to the values of the block
   subroutine add_value(deck, factor, line, row, dof, first, last, cards, findings)
      type(deck_t), intent(in) :: deck
      real(wp), intent(in) :: factor(:)
      integer, intent(in) :: line, row, first, last
      character(len=*), intent(in) :: dof
      type(cards_t), intent(inout) :: cards
      type(finding_list_t), intent(inout) :: findings

      integer :: k, dim, source, offset

      k = cards%n + 1
      cards%n = k
      cards%name(k) = fields(row)%name
      if (dof /= '') cards%name(k) = trim(fields(row)%name)//'_'//dof
      cards%line(k) = line
      cards%given(k) = last >= first
      cards%first(k) = merge(first, fields(row)%first, cards%given(k))
      cards%last(k) = merge(last, fields(row)%last, cards%given(k))
      cards%integer_value(k) = 0
      cards%real_value(k) = 0.0_wp
      cards%text_value(k) = ''
      if (.not. cards%given(k)) return
      select case (fields(row)%kind)
      case ('i')
         call read_integer_at(deck, line, first, last, cards%name(k), fields(row)%meaning, &
            cards%integer_value(k), findings)
      case ('r')
         dim = fields(row)%dim
         if (len(dof) > 0) then
            if (dof(1:1) == 'r') dim = rotational(dim)
         end if
         call read_real_at(deck, line, first, last, cards%name(k), fields(row)%meaning, &
            factor(dim), cards%real_value(k), findings)
      case default
         offset = deck%line_first(line) - 1
         source = deck%line_source(line)
         cards%text_value(k) = deck%source(source)%text(offset + first:offset + last)
      end select
   end subroutine add_value

   !> Findings of a block with too many cards, and of one whose title seems to be a card
   subroutine report_length(deck, cards, n_read, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: n_read
      type(finding_list_t), intent(inout) :: findings

      integer :: line, first, last

      associate (b => deck%block(cards%block))
         do line = b%last - cards%n_card + n_read + 1, b%last
            first = deck%line_first(line)
            last = deck%line_last(line)
            if (is_blank_text(deck%source(deck%line_source(line))%text(first:last))) cycle
            call add_deck_finding(deck, line, 1, header_end(deck, line), SEV_WARNING, 'KJ-9011', &
               'more cards than '//trim(keywords(b%row)%name)//' has', 'ignored', findings)
            exit
         end do
         if (cards%n_card > 0 .or. b%last < b%first .or. .not. keywords(b%row)%titled) return
         call add_deck_finding(deck, b%first, 1, header_end(deck, b%first), SEV_WARNING, &
            'KJ-9016', trim(keywords(b%row)%name)//' has no cards', 'taken as the title', &
            findings, &
            'the line after the header is always the title')
      end associate
   end subroutine report_length

   !> Index of a field by its name; 0 when the layout has no such field
   pure integer function find(cards, name) result(k)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      do k = 1, cards%n
         if (cards%name(k) == name) return
      end do
      k = 0
   end function find

   !> Real field in work units; 0 when it is blank, or not in the layout of this block
   pure real(wp) function real_of(cards, name) result(value)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      value = 0.0_wp
      k = find(cards, name)
      if (k > 0) value = cards%real_value(k)
   end function real_of

   !> Integer field; 0 when it is blank, or not in the layout of this block
   pure integer function int_of(cards, name) result(value)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      value = 0
      k = find(cards, name)
      if (k > 0) value = cards%integer_value(k)
   end function int_of

   !> Characters in a text field
   pure integer function text_length(cards, name) result(n)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      n = 0
      k = find(cards, name)
      if (k > 0) n = len_trim(cards%text_value(k))
   end function text_length

   !> Text field without the blanks around it; '' when it is blank, or not in the layout
   pure function text_of(cards, name) result(text)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name
      character(len=text_length(cards, name)) :: text

      integer :: k

      text = ''
      k = find(cards, name)
      if (k > 0) text = cards%text_value(k)
   end function text_of

   !> The field is in the layout of this block and not blank
   pure logical function is_given(cards, name) result(given)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      integer :: k

      given = .false.
      k = find(cards, name)
      if (k > 0) given = cards%given(k)
   end function is_given

   !> Append a finding that points at a field, or at the header when its card is missing
   subroutine report(deck, cards, name, severity, id, message, label, findings, hint)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name      !! of the field
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      type(finding_list_t), intent(inout) :: findings
      character(len=*), intent(in), optional :: hint

      integer :: k, line, first, last

      k = find(cards, name)
      line = 0
      if (k > 0) line = cards%line(k)
      if (line > 0) then
         first = cards%first(k)
         last = cards%last(k)
      else
         line = deck%block(cards%block)%header
         first = 1
         last = header_end(deck, line)
      end if
      call add_deck_finding(deck, line, first, last, severity, id, message, label, findings, hint)
   end subroutine report

end module kj_cards_once
