!> A deck that is being written: lines, each with the line of another deck it is a copy of, if any.
module kj_text_block
   use kj_deck_text, only: deck_t, line_text, lengthen, put_text
   implicit none
   private

   public :: page_t, new_page, put, put_copy

   !> The text so far
   type :: page_t
      character(len=:), allocatable :: text      !! the first n bytes are set
      integer :: n = 0
      integer :: n_line = 0
      integer, allocatable :: origin(:)          !! (>= n_line) line of the full deck, 0 = none
   end type page_t

contains

   !> An empty page
   subroutine new_page(page)
      type(page_t), intent(out) :: page

      page%text = ''
      allocate (page%origin(1024), source=0)
   end subroutine new_page

   !> Append a line
   subroutine put(page, line, origin)
      type(page_t), intent(inout) :: page
      character(len=*), intent(in) :: line
      integer, intent(in), optional :: origin

      call put_text(line//achar(10), page%n, page%text)
      page%n = page%n + len(line) + 1
      page%n_line = page%n_line + 1
      if (page%n_line > size(page%origin)) call lengthen(page%origin)
      page%origin(page%n_line) = 0
      if (present(origin)) page%origin(page%n_line) = origin
   end subroutine put

   !> Append a copy of a line of a deck
   subroutine put_copy(page, deck, line)
      type(page_t), intent(inout) :: page
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line                !! index in deck

      call put(page, line_text(deck, line), line)
   end subroutine put_copy

end module kj_text_block
