!> Cuts a card into fields: by column, or at commas when the line has one.
module kj_card_cut
   implicit none
   private

   public :: cut_t, cut_card, is_blank_text

   integer, parameter, public :: MOST_ON_CARD = 20   !! more fields than any card has

   !> The fields of one line; a field is blank when last < first
   type :: cut_t
      integer :: first(MOST_ON_CARD) = 1, last(MOST_ON_CARD) = 0   !! columns of the text
      integer :: extra_first = 1, extra_last = 0   !! text after the last field
      integer :: gap_first = 1, gap_last = 0       !! text in columns that belong to no field
      integer :: tab = 0                           !! column of the first tab
      integer :: torn = 0                          !! field whose text goes on in the next one
      logical :: free = .false.                    !! cut at commas
   end type cut_t

   character(len=1), parameter :: TAB = achar(9)

contains

   !> Find the text of n fields, given their columns in ascending order
   pure subroutine cut_card(text, n, first, last, cut)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      integer, intent(in) :: first(n), last(n)
      type(cut_t), intent(out) :: cut

      if (index(text, ',') > 0) then
         cut%free = .true.
         call cut_at_commas(text, n, first, last, cut)
      else
         call cut_at_columns(text, n, first, last, cut)
      end if
   end subroutine cut_card

   !> Fixed format
   pure subroutine cut_at_columns(text, n, first, last, cut)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      integer, intent(in) :: first(n), last(n)
      type(cut_t), intent(inout) :: cut

      integer :: i, next

      cut%tab = index(text, TAB)
      next = 1
      do i = 1, n
         if (first(i) > next) call note_text(text, next, first(i) - 1, cut%gap_first, cut%gap_last)
         call shrink(text, first(i), last(i), cut%first(i), cut%last(i))
         next = last(i) + 1
         if (cut%tab == 0 .or. next > len(text)) cycle
         if (.not. (is_gap(text(next - 1:next - 1)) .or. is_gap(text(next:next)))) cut%torn = i
      end do
      call note_text(text, next, len(text), cut%extra_first, cut%extra_last)
   end subroutine cut_at_columns

   !> Free format: one item a field; unused columns between two fields count as one item;
   !> fields of a few columns share the item of their ten columns, which is read right-justified
   pure subroutine cut_at_commas(text, n, first, last, cut)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      integer, intent(in) :: first(n), last(n)
      type(cut_t), intent(inout) :: cut

      integer :: i, at, next, a, b, cell

      at = 1
      next = 1
      cell = 0
      do i = 1, n
         if (last(i) - first(i) < 9) then
            if ((first(i) - 1)/10 + 1 > cell) call take_item(text, at, a, b)
            cell = (first(i) - 1)/10 + 1
            next = 10*cell + 1
            cut%first(i) = max(a, b - (10*cell - first(i)))
            cut%last(i) = b - (10*cell - last(i))
            if (cut%last(i) >= cut%first(i)) call shrink(text, cut%first(i), cut%last(i), &
               cut%first(i), cut%last(i))
            cycle
         end if
         if (first(i) > next) then
            call take_item(text, at, a, b)
            call note_text(text, a, b, cut%gap_first, cut%gap_last)
         end if
         call take_item(text, at, cut%first(i), cut%last(i))
         next = last(i) + 1
      end do
      call note_text(text, at, len(text), cut%extra_first, cut%extra_last)
   end subroutine cut_at_commas

   !> The next item of a line cut at commas; blank beyond the end
   pure subroutine take_item(text, at, first, last)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: at              !! column where the item begins; then the next
      integer, intent(out) :: first, last

      integer :: n

      first = at
      last = at - 1
      if (at > len(text)) return
      n = index(text(at:), ',')
      if (n == 0) n = len(text) - at + 2
      call shrink(text, at, at + n - 2, first, last)
      at = at + n
   end subroutine take_item

   !> Take the blanks off both ends of columns [a, b]; last < first when nothing is left
   pure subroutine shrink(text, a, b, first, last)
      character(len=*), intent(in) :: text
      integer, value :: a, b
      integer, intent(out) :: first, last

      first = a
      last = min(b, len(text))
      do while (last >= first)
         if (.not. is_gap(text(last:last))) exit
         last = last - 1
      end do
      do while (first < last)
         if (.not. is_gap(text(first:first))) exit
         first = first + 1
      end do
      if (last < first) last = first - 1
   end subroutine shrink

   !> Note the text in columns [a, b], unless there is none or some was noted before; zeros do
   !> not count, for they mean the same as blanks
   pure subroutine note_text(text, a, b, first, last)
      character(len=*), intent(in) :: text
      integer, intent(in) :: a, b
      integer, intent(inout) :: first, last

      integer :: i, j

      if (last >= first) return
      call shrink(text, a, b, i, j)
      if (j < i) return
      if (verify(text(i:j), ' 0.,'//TAB) == 0) return
      first = i
      last = j
   end subroutine note_text

   !> Blank or tab
   pure logical function is_gap(c)
      character(len=1), intent(in) :: c

      is_gap = c == ' ' .or. c == TAB
   end function is_gap

   !> Nothing but blanks and tabs
   pure logical function is_blank_text(text)
      character(len=*), intent(in) :: text

      is_blank_text = verify(text, ' '//TAB) == 0
   end function is_blank_text

end module kj_card_cut
