!> The cards of a block, one after the other: lines of the deck, or cards that stayed in the file.
!>
!> A card in the file is copied into lines of the deck that are kept free for it, so that it is read
!> as any other and findings know its place.
module kj_card_walk
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_deck_text, only: deck_t, first_card, put_text, report_file
   use kj_file_lines, only: stand_at, take_next
   implicit none
   private

   public :: card_walk_t, start_walk, next_card

   !> Where a walk stands
   type :: card_walk_t
      integer :: block = 0                      !! index in deck
      integer :: line = 0                       !! index in deck of the card under way
      integer :: next = 0                       !! the same of the next one
      integer(int64) :: at = 0                  !! in the file: bytes before the next one
      integer :: number = 0                     !! in the file: number of the line under way
   end type card_walk_t

contains

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

end module kj_card_walk
