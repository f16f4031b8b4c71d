!> Fields of cards that no table describes: those of materials and of properties of elements.
!>
!> In free format a field is an item of its line: of reals every twenty columns are one, of integers
!> every ten, unless the caller knows better.
module kj_full_card
   use kj_kinds, only: wp
   use kj_deck_text, only: deck_t, first_card, line_text
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE
   use kj_card_cut, only: read_real_at, read_integer_at, cut_t, cut_card, MOST_ON_CARD
   implicit none
   private

   public :: card_real, card_integer, has_card

contains

   !> A block has a card of this number, the title not counted
   pure logical function has_card(deck, block, card)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, card

      has_card = first_card(deck, block) + card - 1 <= deck%block(block)%last
   end function has_card

   !> Real in twenty columns of a card, in work units; 0 when it is blank or missing
   !>
   !> Where it may not matter, `fine` tells that it is a number or blank; else a finding does.
   subroutine card_real(deck, block, card, first, factor, value, item, fine)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block, card         !! the title is not counted
      integer, intent(in) :: first               !! column
      real(wp), intent(in) :: factor             !! input to work units
      real(wp), intent(out) :: value
      integer, intent(in), optional :: item      !! in free format; first/20 + 1
      logical, intent(out), optional :: fine

      integer :: line, a, b, status

      value = 0.0_wp
      if (present(fine)) fine = .true.
      if (.not. has_card(deck, block, card)) return
      line = first_card(deck, block) + card - 1
      call find_field(line_text(deck, line), first, first + 19, a, b, item)
      if (.not. present(fine)) then
         call read_real_at(deck, line, a, b, 'the field', 'a real number', factor, value)
      else if (b >= a) then
         call parse_real(line_part(deck, line, a, b), value, status)
         fine = status == NUMBER_FINE
         value = merge(value*factor, 0.0_wp, fine)
      end if
   end subroutine card_real

   !> Integer in ten columns of a card; 0 when it is blank or missing. Likewise
   subroutine card_integer(deck, block, card, first, value, item, fine)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block, card, first
      integer, intent(out) :: value
      integer, intent(in), optional :: item      !! in free format; first/10 + 1
      logical, intent(out), optional :: fine

      integer :: line, a, b, status

      value = 0
      if (present(fine)) fine = .true.
      if (.not. has_card(deck, block, card)) return
      line = first_card(deck, block) + card - 1
      call find_field(line_text(deck, line), first, first + 9, a, b, item)
      if (.not. present(fine)) then
         call read_integer_at(deck, line, a, b, 'the field', 'an integer', value)
      else if (b >= a) then
         call parse_integer(line_part(deck, line, a, b), value, status)
         fine = status == NUMBER_FINE
         if (.not. fine) value = 0
      end if
   end subroutine card_integer

   !> Columns of a line
   pure function line_part(deck, line, first, last) result(text)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line, first, last
      character(len=last - first + 1) :: text

      character(len=last) :: start

      start = line_text(deck, line)
      text = start(first:)
   end function line_part

   !> Columns of the text in a field; b < a when it is blank
   pure subroutine find_field(text, first, last, a, b, item)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last
      integer, intent(out) :: a, b
      integer, intent(in), optional :: item      !! in free format

      type(cut_t) :: cut
      integer :: n, i

      n = 1
      if (index(text, ',') > 0) n = min(MOST_ON_CARD, first/(last - first + 1) + 1)
      if (present(item) .and. n > 1) n = item
      if (n == 1) call cut_card(text, 1, [first], [last], cut)
      if (n > 1) call cut_card(text, n, [(10*i - 9, i=1, n)], [(10*i, i=1, n)], cut)
      a = cut%first(n)
      b = cut%last(n)
   end subroutine find_field

end module kj_full_card
