!> /PART with Irigid -> the /RBODY over its nodes that it stands for, and the group of these.
!>
!> Both are blocks at the end of the deck; their lines have the place of the header of the part.
module kj_rigid_part
   use kj_error, only: str
   use kj_keywords, only: keywords, KW_PART, KW_RBODY, KW_GRNOD_PART
   use kj_deck_text, only: deck_t, block_t, source_t, line_text, first_card, title_of, add_line, &
      add_source, add_block, FLAT
   use kj_card_text, only: integer_field
   use kj_number, only: parse_integer, NUMBER_FINE
   implicit none
   private

   public :: make_rigid_parts

   integer, parameter :: SINCE = 2612           !! version of /BEGIN

contains

   !> A body for each rigid part
   subroutine make_rigid_parts(deck)
      type(deck_t), intent(inout) :: deck

      character(len=100) :: card(4)
      integer :: block, group, flag, status, i

      if (deck%version < SINCE) return
      do block = 1, deck%n_block
         if (deck%block(block)%keyword /= KW_PART) cycle
         card = ''
         do i = first_card(deck, block), min(first_card(deck, block) + 3, deck%block(block)%last)
            card(i - first_card(deck, block) + 1) = line_text(deck, i)
         end do
         call parse_integer(trim(card(1)(51:70)), flag, status)
         if (status /= NUMBER_FINE .or. flag == 0) cycle
         group = free_id(deck, '/GRNOD', '/SET')
         call append(deck, block, KW_RBODY, free_id(deck, '/RBODY', '/RBE2'), [ &
            card(2)(:10)//card(2)(51:60)//card(2)(11:20)//repeat(' ', 10)//card(2)(21:40)// &
            integer_field(group)//repeat(' ', 30), card(3), card(4)])
         card = integer_field(deck%block(block)%id)
         call append(deck, block, KW_GRNOD_PART, group, card(:1))
      end do
   end subroutine make_rigid_parts

   !> One more than all ids of blocks whose keywords begin so
   pure integer function free_id(deck, one, other) result(id)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: one, other

      integer :: i

      id = 1
      do i = 1, deck%n_block
         if (deck%block(i)%row == 0) cycle
         associate (name => keywords(deck%block(i)%row)%name)
            if (index(name, one) == 1 .or. index(name, other) == 1) &
               id = max(id, deck%block(i)%id + 1)
         end associate
      end do
   end function free_id

   !> Append a block: header, title of the part, cards
   subroutine append(deck, part, keyword, id, card)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: part                !! block of the part
      integer, intent(in) :: keyword, id
      character(len=*), intent(in) :: card(:)

      type(source_t) :: source
      type(block_t) :: block
      character(len=:), allocatable :: title
      integer :: s, i, n, header

      header = deck%block(part)%header
      title = title_of(deck, part)
      source%path = deck%source(deck%line_source(header))%path
      source%role = FLAT
      source%text = trim(keywords(keyword)%name)//'/'//str(id)//title
      n = len(source%text) - len(title)
      do i = 1, size(card)
         source%text = source%text//card(i)
      end do
      call add_source(deck, source, s)
      call add_line(deck, s, deck%line_number(header), 1, n)
      call add_line(deck, s, deck%line_number(header), n + 1, n + len(title))
      n = n + len(title)
      do i = 1, size(card)
         call add_line(deck, s, deck%line_number(header), n + 1, n + len(card))
         n = n + len(card)
      end do
      block%keyword = keyword
      block%row = keyword
      block%id = id
      block%unit_id = deck%block(part)%unit_id
      block%last = deck%n_line
      block%first = block%last - size(card)
      block%header = block%first - 1
      call add_block(deck, block)
   end subroutine append

end module kj_rigid_part
