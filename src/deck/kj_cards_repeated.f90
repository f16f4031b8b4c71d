!> Cards that repeat to the end of a block -> arrays: nodes, springs, points, masses.
!>
!> A clean line takes the fast path: each field is parsed where it stands in the file. All other
!> lines (commas, tabs, wrong numbers, text beyond the fields) are cut and judged with care.
module kj_cards_repeated
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_WARNING
   use kj_units, only: dimensions
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE, NUMBER_BLANK, NUMBER_NOT_FINITE
   use kj_card_field, only: EACH, ROWS
   use kj_card_fields, only: fields
   use kj_deck_text, only: deck_t, add_deck_finding, block_factors, title_line, line_text
   use kj_card_cut, only: cut_t, cut_card, is_blank_text, MOST_ON_CARD
   use kj_card_values, only: read_integer_at, read_real_at, report_cut
   implicit none
   private

   public :: rows_t, read_rows, report_row

   !> Values of a block of rows
   type :: rows_t
      integer :: n = 0                          !! number of rows
      integer, allocatable :: ints(:, :)        !! (n, n_int) integer fields in table order
      real(wp), allocatable :: reals(:, :)      !! (n, n_real) real fields, in work units
      integer, allocatable :: line(:)           !! (n) index in deck
   end type rows_t

   !> The fields of a row
   type :: row_layout_t
      integer :: n = 0
      integer :: row(MOST_ON_CARD) = 0          !! in the table of fields
      integer :: first(MOST_ON_CARD) = 0, last(MOST_ON_CARD) = 0   !! columns
      integer :: kind(MOST_ON_CARD) = 0         !! 1 integer, 2 real, 3 text
      integer :: place(MOST_ON_CARD) = 0        !! column of `ints` or `reals`
      real(wp) :: factor(MOST_ON_CARD) = 1.0_wp
      integer :: n_int = 0, n_real = 0
      integer :: dense = 0                      !! columns 1 to dense are covered by fields
   end type row_layout_t

contains

   !> Read all rows of a block
   !>
   !> Goes on after a wrong field: it reads as 0, and a finding tells of it.
   subroutine read_rows(deck, block, rows, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(rows_t), intent(out) :: rows
      type(finding_list_t), intent(inout) :: findings

      type(row_layout_t) :: layout
      integer :: i, line, start, source
      logical :: clean

      call lay_out(deck, block, layout)
      start = deck%block(block)%first
      if (title_line(deck, block) > 0) start = start + 1
      rows%n = max(0, deck%block(block)%last - start + 1)
      allocate (rows%ints(rows%n, layout%n_int), rows%reals(rows%n, layout%n_real), &
         rows%line(rows%n))
      do i = 1, rows%n
         line = start + i - 1
         rows%line(i) = line
         source = deck%line_source(line)
         call read_clean_row(deck%source(source)%text(deck%line_first(line):deck%line_last(line)), &
            layout, rows%n, i, rows%ints, rows%reals, clean)
         if (.not. clean) call read_odd_row(deck, layout, i, rows, findings)
      end do
   end subroutine read_rows

   !> Collect the fields of a row of this block
   subroutine lay_out(deck, block, layout)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(row_layout_t), intent(out) :: layout

      integer :: i, n
      real(wp) :: factor(size(dimensions))

      factor = block_factors(deck, block)
      associate (b => deck%block(block))
         if (b%keyword < 1) return
         do i = deck%field_first(b%keyword), deck%field_last(b%keyword)
            if (fields(i)%times /= ROWS .or. fields(i)%since > deck%version) cycle
            if (fields(i)%variant /= EACH .and. fields(i)%variant /= b%variant) cycle
            n = layout%n + 1
            layout%n = n
            layout%row(n) = i
            layout%first(n) = fields(i)%first
            layout%last(n) = fields(i)%last
            layout%factor(n) = factor(fields(i)%dim)
            if (fields(i)%first == layout%dense + 1) layout%dense = fields(i)%last
            layout%kind(n) = index('ira', fields(i)%kind)
            if (layout%kind(n) == 1) layout%n_int = layout%n_int + 1
            if (layout%kind(n) == 2) layout%n_real = layout%n_real + 1
            layout%place(n) = merge(layout%n_int, layout%n_real, layout%kind(n) == 1)
         end do
      end associate
   end subroutine lay_out

   !> Read a row of which nothing is odd; clean = .false. when something is
   pure subroutine read_clean_row(text, layout, n, i, ints, reals, clean)
      character(len=*), intent(in) :: text
      type(row_layout_t), intent(in) :: layout
      integer, intent(in) :: n, i               !! number of rows, this row
      integer, intent(inout) :: ints(n, *)
      real(wp), intent(inout) :: reals(n, *)
      logical, intent(out) :: clean

      integer :: k, width, last, status
      real(wp) :: value

      width = len_trim(text)
      clean = width > 0 .and. width <= layout%dense
      do k = 1, layout%n
         if (.not. clean) return
         last = min(layout%last(k), width)
         select case (layout%kind(k))
         case (1)
            call parse_integer(text(layout%first(k):last), ints(i, layout%place(k)), status)
         case (2)
            call parse_real(text(layout%first(k):last), value, status)
            value = value*layout%factor(k)
            if (.not. abs(value) <= huge(value)) status = NUMBER_NOT_FINITE
            reals(i, layout%place(k)) = value
         case default
            cycle
         end select
         clean = status == NUMBER_FINE .or. status == NUMBER_BLANK
      end do
   end subroutine read_clean_row

   !> Read any row, with findings
   subroutine read_odd_row(deck, layout, i, rows, findings)
      type(deck_t), intent(in) :: deck
      type(row_layout_t), intent(in) :: layout
      integer, intent(in) :: i                  !! row
      type(rows_t), intent(inout) :: rows
      type(finding_list_t), intent(inout) :: findings

      type(cut_t) :: cut
      character(len=:), allocatable :: text
      integer :: k, line

      line = rows%line(i)
      text = line_text(deck, line)
      call cut_card(text, layout%n, layout%first(:layout%n), layout%last(:layout%n), cut)
      call report_cut(deck, line, cut, findings)
      if (is_blank_text(text)) call add_deck_finding(deck, line, 1, max(1, len(text)), &
         SEV_WARNING, 'KJ-9014', 'a blank line is a card of zeros', 'remove it', findings)
      do k = 1, layout%n
         associate (f => fields(layout%row(k)))
            select case (layout%kind(k))
            case (1)
               call read_integer_at(deck, line, cut%first(k), cut%last(k), f%name, f%meaning, &
                  rows%ints(i, layout%place(k)), findings)
            case (2)
               call read_real_at(deck, line, cut%first(k), cut%last(k), f%name, f%meaning, &
                  layout%factor(k), rows%reals(i, layout%place(k)), findings)
            end select
         end associate
      end do
   end subroutine read_odd_row

   !> Append a finding that points at a field of a row
   subroutine report_row(deck, block, rows, row, name, severity, id, message, label, findings, hint)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: row                !! 1 to rows%n
      character(len=*), intent(in) :: name      !! of the field
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      type(finding_list_t), intent(inout) :: findings
      character(len=*), intent(in), optional :: hint

      type(row_layout_t) :: layout
      type(cut_t) :: cut
      character(len=:), allocatable :: text
      integer :: k, first, last

      call lay_out(deck, block, layout)
      text = line_text(deck, rows%line(row))
      call cut_card(text, layout%n, layout%first(:layout%n), layout%last(:layout%n), cut)
      first = 1
      last = max(1, len_trim(text))
      do k = 1, layout%n
         if (fields(layout%row(k))%name /= name) cycle
         first = merge(cut%first(k), layout%first(k), cut%last(k) >= cut%first(k))
         last = merge(cut%last(k), layout%last(k), cut%last(k) >= cut%first(k))
      end do
      call add_deck_finding(deck, rows%line(row), first, last, severity, id, message, label, &
         findings, hint)
   end subroutine report_row

end module kj_cards_repeated
