!> The cards of a block, one after the other: lines of the deck, or cards that stayed in the file.
!>
!> A card in the file is read into a piece of it; lines of the deck that are kept free for that
!> point there while it is looked at, so that findings know its place.
module kj_card_walk
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_deck_text, only: deck_t, first_card, report_file
   use kj_file_lines, only: read_piece, next_line, PIECE_SIZE
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
   !> In the file walk%line holds until a card of the same number is asked for.
   subroutine next_card(deck, walk, card, there)
      type(deck_t), intent(inout) :: deck
      type(card_walk_t), intent(inout) :: walk
      integer, intent(in) :: card               !! 1, 2 or 3: number in its element
      logical, intent(out) :: there

      integer :: first, last, next

      if (deck%block(walk%block)%n_far == 0) then
         there = walk%next <= deck%block(walk%block)%last
         if (there) walk%line = walk%next
         if (there) walk%next = walk%next + 1
         return
      end if
      do
         call find_line(deck, walk, first, last, next, there)
         if (.not. there) return
         walk%at = walk%at + next - first
         walk%number = walk%number + 1
         if (last < first) exit
         if (scan(deck%source(deck%piece)%text(first:first), '#$') == 0) exit
      end do
      walk%line = deck%far_line + card - 1
      deck%line_number(walk%line) = walk%number
      deck%line_first(walk%line) = first
      deck%line_last(walk%line) = last
   end subroutine next_card

   !> The bytes, in the piece of the file, of the line that a walk comes to
   subroutine find_line(deck, walk, first, last, next, there)
      type(deck_t), intent(inout) :: deck
      type(card_walk_t), intent(in) :: walk
      integer, intent(out) :: first, last, next
      logical, intent(out) :: there

      integer :: most
      integer(int64) :: n

      associate (b => deck%block(walk%block))
         most = int(min(int(PIECE_SIZE, int64), max(b%to - walk%at, 2_int64**16)))
         do
            there = walk%at < b%to
            if (.not. there) return
            n = len(deck%source(deck%piece)%text, int64)
            if (deck%piece_file == deck%line_source(b%header) .and. walk%at >= deck%piece_start &
               .and. walk%at < deck%piece_start + n) then
               first = int(walk%at - deck%piece_start) + 1
               call next_line(deck%source(deck%piece)%text, first, last, next)
               if (next <= n + 1 .or. deck%piece_start + n >= b%to) return
            end if
            call load(deck, walk, most)
            most = 2*most
         end do
      end associate
   end subroutine find_line

   !> Load the piece of the file that begins with the line that a walk comes to
   subroutine load(deck, walk, most)
      type(deck_t), intent(inout) :: deck
      type(card_walk_t), intent(in) :: walk
      integer, intent(in) :: most               !! bytes of it

      character(len=:), allocatable :: problem
      integer(int64) :: n_byte
      integer :: file

      file = deck%line_source(deck%block(walk%block)%header)
      deck%piece_file = file
      deck%piece_start = walk%at
      deck%source(deck%piece)%path = deck%source(file)%path
      call read_piece(deck%source(file)%path, walk%at, most, deck%source(deck%piece)%text, n_byte, &
         problem)
      if (n_byte < deck%block(walk%block)%to) problem = 'it became shorter'
      if (problem == '') return
      call report_file(deck, deck%source(file)%path, 'KJ-9030', 'the deck cannot be read: '// &
         problem, 'read before')
      deck%block(walk%block)%to = walk%at        ! nothing is left of the block
   end subroutine load

end module kj_card_walk
