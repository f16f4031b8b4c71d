!> Lists of ids, ten columns each, to the end of a block; and the clauses of sets.
module kj_cards_ids
   use kj_error, only: finding_list_t, SEV_WARNING
   use kj_card_field, only: IDS, PAIRS, TRIPLES
   use kj_card_fields, only: fields
   use kj_deck_text, only: deck_t, add_deck_finding, title_line, lengthen
   use kj_card_cut, only: cut_t, cut_card
   use kj_card_values, only: read_integer_at, report_cut
   implicit none
   private

   public :: ids_t, clauses_t, read_ids, read_id_lines, read_clauses, report_id, add_id

   integer, parameter :: WIDTH = 10             !! columns of an id
   integer, parameter :: FIRST_COLUMN(10) = [1, 11, 21, 31, 41, 51, 61, 71, 81, 91]

   !> Ids of a block and where they stand
   type :: ids_t
      integer :: n = 0
      integer, allocatable :: value(:)          !! (>= n) allocated, if a reader made the list
      integer, allocatable :: line(:)           !! (>= n) index in deck
      integer, allocatable :: first(:), last(:) !! (>= n) columns
   end type ids_t

   !> The clauses of a /SET: clause k has the ids from(k) to to(k)
   type :: clauses_t
      integer :: n = 0
      character(len=10), allocatable :: word(:) !! (>= n) NODE, PART, ...
      integer, allocatable :: line(:)           !! (>= n) index in deck of the word
      integer, allocatable :: from(:), to(:)    !! (>= n) in `ids`
      type(ids_t) :: ids
   end type clauses_t

contains

   !> Read the ids of a block; blanks and zeros are left out, negative ids are kept
   !>
   !> Pairs and triples stay together: of them only those are left out that are zero as a whole.
   subroutine read_ids(deck, block, list, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(ids_t), intent(out) :: list
      type(finding_list_t), intent(inout) :: findings

      integer :: i, start, together, on_card

      together = 1
      on_card = 10
      associate (b => deck%block(block))
         start = b%first
         if (title_line(deck, block) > 0) start = start + 1
         if (b%keyword > 0) then
            do i = deck%field_first(b%keyword), deck%field_last(b%keyword)
               if (fields(i)%times < IDS .or. fields(i)%times > TRIPLES) cycle
               on_card = fields(i)%last/WIDTH
               if (fields(i)%times == PAIRS) together = 2
               if (fields(i)%times == TRIPLES) together = 3
            end do
         end if
         call read_id_lines(deck, start, b%last, on_card, together, list, findings)
      end associate
   end subroutine read_ids

   !> Read ids from some lines
   subroutine read_id_lines(deck, start, end, on_card, together, list, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: start, end         !! lines, index in deck
      integer, intent(in) :: on_card            !! ids on a card, at most 10
      integer, intent(in) :: together           !! ids that belong together
      type(ids_t), intent(inout) :: list
      type(finding_list_t), intent(inout) :: findings

      type(cut_t) :: cut
      integer :: line, source, k, j, value(10)

      call prepare(list)
      do line = start, end
         source = deck%line_source(line)
         call cut_card(deck%source(source)%text(deck%line_first(line):deck%line_last(line)), &
            on_card, FIRST_COLUMN(:on_card), FIRST_COLUMN(:on_card) + WIDTH - 1, cut)
         call report_cut(deck, line, cut, findings)
         do k = 1, on_card
            call read_integer_at(deck, line, cut%first(k), cut%last(k), 'the id', &
               'an id of at most ten columns', value(k), findings)
         end do
         do k = 1, on_card - together + 1, together
            if (all(value(k:k + together - 1) == 0)) cycle
            do j = k, k + together - 1
               call add_id(list, value(j), line, max(1, cut%first(j)), &
                  max(1, cut%first(j), cut%last(j)))
            end do
         end do
      end do
   end subroutine read_id_lines

   !> Make a list an empty one, ready for use, if it is not so yet
   subroutine prepare(list)
      type(ids_t), intent(inout) :: list

      if (allocated(list%value)) return
      allocate (list%value(16), list%line(16), list%first(16), list%last(16))
   end subroutine prepare

   !> Append an id with its place
   subroutine add_id(list, value, line, first, last)
      type(ids_t), intent(inout) :: list
      integer, intent(in) :: value
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: first, last        !! columns

      call prepare(list)
      if (list%n == size(list%value)) then
         call lengthen(list%value)
         call lengthen(list%line)
         call lengthen(list%first)
         call lengthen(list%last)
      end if
      list%n = list%n + 1
      list%value(list%n) = value
      list%line(list%n) = line
      list%first(list%n) = first
      list%last(list%n) = last
   end subroutine add_id

   !> Read the clauses of a /SET; a blank word goes on with the clause before
   subroutine read_clauses(deck, block, clauses, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(clauses_t), intent(out) :: clauses
      type(finding_list_t), intent(inout) :: findings

      type(cut_t) :: cut
      integer :: line, k, start, n, value, offset, source

      call prepare(clauses%ids)
      start = deck%block(block)%first
      if (title_line(deck, block) > 0) start = start + 1
      n = max(1, deck%block(block)%last - start + 1)
      allocate (clauses%word(n), clauses%line(n), clauses%from(n), clauses%to(n))
      do line = start, deck%block(block)%last
         source = deck%line_source(line)
         offset = deck%line_first(line) - 1
         call cut_card(deck%source(source)%text(offset + 1:deck%line_last(line)), 10, &
            FIRST_COLUMN, FIRST_COLUMN + WIDTH - 1, cut)
         call report_cut(deck, line, cut, findings)
         if (cut%last(1) >= cut%first(1)) then
            clauses%n = clauses%n + 1
            n = clauses%n
            clauses%word(n) = deck%source(source)%text(offset + cut%first(1):offset + cut%last(1))
            clauses%line(n) = line
            clauses%from(n) = clauses%ids%n + 1
            clauses%to(n) = clauses%ids%n
         else if (clauses%n == 0) then
            if (any(cut%last >= cut%first)) call add_deck_finding(deck, line, 1, WIDTH, &
               SEV_WARNING, 'KJ-9014', 'ids before the first clause', 'ignored', findings)
            cycle
         end if
         do k = 2, 10
            call read_integer_at(deck, line, cut%first(k), cut%last(k), 'the id', &
               'an id of at most ten columns', value, findings)
            if (value == 0) cycle
            call add_id(clauses%ids, value, line, cut%first(k), cut%last(k))
         end do
         clauses%to(clauses%n) = clauses%ids%n
      end do
   end subroutine read_clauses

   !> Append a finding that points at an id
   subroutine report_id(deck, list, k, severity, id, message, label, findings, hint)
      type(deck_t), intent(in) :: deck
      type(ids_t), intent(in) :: list
      integer, intent(in) :: k                  !! 1 to list%n
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      type(finding_list_t), intent(inout) :: findings
      character(len=*), intent(in), optional :: hint

      call add_deck_finding(deck, list%line(k), list%first(k), list%last(k), severity, id, &
         message, &
         label, findings, hint)
   end subroutine report_id

end module kj_cards_ids
