!> A deck as text: its files, the lines that count and the blocks they form.
!>
!> A file is one string, a line is a pair of places in it: 1e6 lines cost four integers each.
module kj_deck_text
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, add_at, SEV_ERROR
   use kj_units, only: unit_system_t, dimensions, factor_of
   use kj_keywords, only: keywords, N_KEYWORD
   implicit none
   private

   public :: source_t, block_t, deck_t, line_text, place_of, title_of, title_line, block_units, &
      block_factors, add_deck_finding, report_header, header_end, lengthen, mute_block

   !> A file in memory
   type :: source_t
      character(len=:), allocatable :: path     !! as the user or the #include named it
      character(len=:), allocatable :: text     !! all bytes of the file
      character(len=8) :: role = 'starter'      !! starter, engine or include
   end type source_t

   !> A header and the lines up to the next one
   type :: block_t
      integer :: keyword = 0                    !! KW_ constant; 0 = not known
      integer :: row = 0                        !! row of kj_keywords; 0 = not known
      integer :: variant = 0                    !! type in the header (ADMAS)
      integer :: id = 1                         !! first number of the header
      integer :: unit_id = 0                    !! /UNIT of this block; 0 = input units
      integer :: header = 0                     !! line of the header
      integer :: first = 1, last = 0            !! its lines, title included; last < first: none
      !> another layout: findings on its cards mean nothing
      logical :: mute = .false.
   end type block_t

   !> A starter deck with all included files
   type :: deck_t
      type(source_t), allocatable :: source(:)  !! (n_source)
      integer :: n_source = 0
      integer :: n_line = 0                     !! headers and cards; comments are left out
      integer, allocatable :: line_source(:)    !! (>= n_line) index of the file
      integer, allocatable :: line_number(:)    !! (>= n_line) number in the file, 1-based
      integer, allocatable :: line_first(:)     !! (>= n_line) first byte in the text of the file
      integer, allocatable :: line_last(:)      !! (>= n_line) last byte, line end left out
      type(block_t), allocatable :: block(:)    !! (>= n_block)
      integer :: n_block = 0
      integer :: invers = 0                     !! format version of /BEGIN as typed
      integer :: version = 0                    !! format version that selects the layouts
      logical :: readable = .true.              !! .false.: further findings make no sense
      logical :: has_mute = .false.             !! some block is mute
      type(unit_system_t) :: input, work        !! units of the cards, units of the run
      integer :: n_unit = 0
      integer, allocatable :: unit_id(:)        !! (n_unit) ids of /UNIT
      type(unit_system_t), allocatable :: unit(:)   !! (n_unit)
      real(wp) :: factor(size(dimensions)) = 1.0_wp !! input to work units, one per D_ constant
      integer :: field_first(N_KEYWORD) = 1     !! rows of a keyword in the table of fields
      integer :: field_last(N_KEYWORD) = 0
   end type deck_t

contains

   !> Characters in a line, 0 for one that is not there
   pure integer function line_length(deck, line) result(n)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index, 1 to n_line

      n = 0
      if (line >= 1 .and. line <= deck%n_line) &
         n = max(0, deck%line_last(line) - deck%line_first(line) + 1)
   end function line_length

   !> Text of a line; '' for line 0
   pure function line_text(deck, line) result(text)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index, 1 to n_line
      character(len=line_length(deck, line)) :: text

      text = ''
      if (line < 1 .or. line > deck%n_line) return
      text = deck%source(deck%line_source(line))%text(deck%line_first(line):deck%line_last(line))
   end function line_text

   !> File and number of a line; '' and 0 for line 0
   pure subroutine place_of(deck, line, file, number)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index, 1 to n_line
      character(len=:), allocatable, intent(out) :: file
      integer, intent(out) :: number

      file = ''
      number = 0
      if (line < 1 .or. line > deck%n_line) return
      file = deck%source(deck%line_source(line))%path
      number = deck%line_number(line)
   end subroutine place_of

   !> Line of the title card of a block; 0 when it has none
   pure integer function title_line(deck, block) result(line)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block

      line = 0
      if (deck%block(block)%row == 0) return
      if (.not. keywords(deck%block(block)%row)%titled) return
      if (deck%block(block)%first > deck%block(block)%last) return
      line = deck%block(block)%first
   end function title_line

   !> Characters in the title of a block
   pure integer function title_length(deck, block) result(n)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block

      n = len_trim(adjustl(title_field(line_text(deck, title_line(deck, block)))))
   end function title_length

   !> What may hold the title: the first 100 columns
   pure function title_field(text) result(field)
      character(len=*), intent(in) :: text
      character(len=min(100, len(text))) :: field

      field = text
   end function title_field

   !> Title of a block without the blanks around it; '' when it has none
   pure function title_of(deck, block) result(text)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      character(len=title_length(deck, block)) :: text

      text = adjustl(title_field(line_text(deck, title_line(deck, block))))
   end function title_of

   !> Units of the numbers in a block: the input units, or those of its /UNIT
   pure function block_units(deck, block) result(units)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(unit_system_t) :: units

      integer :: i

      units = deck%input
      do i = 1, deck%n_unit
         if (deck%unit_id(i) == deck%block(block)%unit_id) units = deck%unit(i)
      end do
   end function block_units

   !> Factors that turn the numbers of a block into work units, one per D_ constant
   pure function block_factors(deck, block) result(factor)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      real(wp) :: factor(size(dimensions))

      integer :: i

      factor = deck%factor
      if (deck%block(block)%unit_id == 0) return
      do i = 1, size(factor)
         factor(i) = factor_of(i, block_units(deck, block), deck%work)
      end do
   end function block_factors

   !> From now on findings that point at the cards of a block are dropped
   subroutine mute_block(deck, block)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block

      deck%block(block)%mute = .true.
      deck%has_mute = .true.
   end subroutine mute_block

   !> Append a finding that points at columns of a line
   !>
   !> Where these columns have an error already nothing is added: what reads a wrong field as 0
   !> would find that 0 wrong again. The same finding at the same place is added once.
   subroutine add_deck_finding(deck, line, first, last, severity, id, message, label, findings, &
      hint)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index; 0 = no place
      integer, intent(in) :: first, last        !! columns
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      type(finding_list_t), intent(inout) :: findings
      character(len=*), intent(in), optional :: hint

      character(len=:), allocatable :: file
      integer :: number

      call place_of(deck, line, file, number)
      if (is_known(findings, id, file, number, first, last)) return
      if (deck%has_mute) then
         if (is_mute(deck, line)) return
      end if
      call add_at(findings, severity, id, file, number, line_text(deck, line), first, last, &
         message, label, hint)
   end subroutine add_deck_finding

   !> An error stands in these columns, or the same finding
   pure logical function is_known(findings, id, file, number, first, last)
      type(finding_list_t), intent(in) :: findings
      character(len=*), intent(in) :: id, file
      integer, intent(in) :: number, first, last

      integer :: i

      is_known = .true.
      do i = findings%n, 1, -1
         associate (item => findings%item(i))
            if (item%line /= number .or. number == 0) cycle
            if (item%first > last .or. item%last < first) cycle
            if (item%severity /= SEV_ERROR .and. item%id /= id) cycle
            if (item%file == file) return
         end associate
      end do
      is_known = .false.
   end function is_known

   !> The line belongs to a mute block; blocks ascend in lines
   pure logical function is_mute(deck, line)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index, 1 to n_line

      integer :: lo, hi, middle

      lo = 0
      hi = deck%n_block
      do while (lo < hi)
         middle = (lo + hi + 1)/2
         if (deck%block(middle)%header <= line) then
            lo = middle
         else
            hi = middle - 1
         end if
      end do
      is_mute = .false.
      if (lo > 0) is_mute = deck%block(lo)%mute .and. line <= deck%block(lo)%last
   end function is_mute

   !> Append a finding that points at the header of a block
   subroutine report_header(deck, block, severity, id, message, label, findings, hint)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      type(finding_list_t), intent(inout) :: findings
      character(len=*), intent(in), optional :: hint

      integer :: line

      line = deck%block(block)%header
      call add_deck_finding(deck, line, 1, header_end(deck, line), severity, id, message, label, &
         findings, hint)
   end subroutine report_header

   !> Last column of a header, at least 1
   pure integer function header_end(deck, line) result(last)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line

      last = max(1, len_trim(line_text(deck, line)))
   end function header_end

   !> Double the length of an array
   pure subroutine lengthen(array)
      integer, allocatable, intent(inout) :: array(:)

      integer, allocatable :: longer(:)

      allocate (longer(2*size(array)))
      longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine lengthen

end module kj_deck_text
