!> A deck as text: its files, the lines that count and the blocks they form.
!>
!> A line is a pair of places in the text of its file: 1e6 lines cost four integers each. Of a full
!> deck comments and the cards of nodes and elements are no lines: they stay in the file, and
!> kj_element_cards reads them when somebody asks.
!> One file: lines, blocks and findings all point into the same texts.
module kj_deck_text
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, add_at, SEV_ERROR, error_t, fail, fail_at, add_finding, &
      ERR_FILE, ERR_INPUT
   use kj_file_lines, only: file_lines_t, read_piece
   use kj_units, only: unit_system_t, dimensions, factor_of
   use kj_keywords, only: keywords, N_KEYWORD
   implicit none
   private

   public :: source_t, block_t, deck_t, submodel_t, id_shift, line_text, place_of, title_of, &
      first_card, block_factors, add_deck_finding, report_file, report_header, report_line, &
      header_end, lengthen, mute_block, add_line, add_source, move_source, add_block, load_source, &
      put_text, folder_of, add_file_finding, block_at, kind_word

   !> Roles of sources that are no files: lines made of others, cards that stay in their file
   character(len=*), parameter, public :: FLAT = 'flat', PIECE = 'piece'

   !> A file in memory
   type :: source_t
      character(len=:), allocatable :: path     !! as the user or the #include named it
      character(len=:), allocatable :: text     !! all bytes of the file; of a full deck its lines
      character(len=8) :: role = 'starter'      !! starter, engine, include, flat, piece
      integer :: used = 0                       !! bytes in use where the text grows
      character(len=64) :: digest = ''          !! SHA-256 of the first file of a full deck
   end type source_t

   !> A //SUBMODEL: its blocks have ids that count from its offsets
   type :: submodel_t
      integer :: id = 0                         !! as others name it
      integer :: parent = 0                     !! the submodel around it, 0 = none
      integer :: block = 0                      !! of the deck
      integer :: shift(0:6) = 0                 !! of ids: 0 in general, then OF_NODE to OF_SUBMODEL
   end type submodel_t

   !> A header and the lines up to the next one
   type :: block_t
      integer :: keyword = 0                    !! KW_ constant; 0 = its cards are not read
      integer :: row = 0                        !! row of kj_keywords; 0 = not known
      integer :: variant = 0                    !! type in the header (ADMAS)
      integer :: id = 1                         !! first number of the header
      integer :: unit_id = 0                    !! /UNIT of this block; 0 = input units
      integer :: submodel = 0                   !! index of the submodel it stands in, 0 = none
      integer :: header = 0                     !! line of the header
      integer :: first = 1, last = 0            !! its lines, title included; last < first: none
      !> cards that stay in the file: how many, before its byte from + 1 to its byte to; the number
      !> of the line before them
      integer :: n_far = 0
      integer(int64) :: from = 0, to = 0
      integer :: number = 0
      !> another layout: findings on its cards mean nothing
      logical :: mute = .false.
   end type block_t

   !> A deck with all included files, and what was found in it
   type :: deck_t
      type(finding_list_t) :: findings
      type(source_t), allocatable :: source(:)  !! (n_source)
      integer :: n_source = 0
      ! of a full deck: cards that stay in their file
      type(file_lines_t) :: far                 !! where they are read
      integer :: far_source = 0                 !! the source that they are copied into, 0 = none
      integer :: far_line = 0                   !! the first of three lines of it
      integer :: n_line = 0                     !! headers and cards; comments are left out
      integer, allocatable :: line_source(:)    !! (>= n_line) index of the file
      integer, allocatable :: line_number(:)    !! (>= n_line) number in the file, 1-based
      integer, allocatable :: line_first(:)     !! (>= n_line) first byte in the text of the file
      integer, allocatable :: line_last(:)      !! (>= n_line) last byte, line end left out
      type(block_t), allocatable :: block(:)    !! (>= n_block)
      integer :: n_block = 0
      integer :: invers = 0                     !! format version of /BEGIN as typed
      integer :: version = 0                    !! format version that selects the layouts
      !> what is out of scope is left out: by --ignore-unsupported, and where `full`
      logical :: lenient = .false.
      logical :: full = .false.                 !! a full deck, of which the mechanism is taken out
      logical :: ignore_random = .false.        !! /RANDOM disturbs nothing
      type(submodel_t), allocatable :: submodel(:)  !! (n_submodel)
      integer :: n_submodel = 0
      logical :: readable = .true.              !! .false.: further findings make no sense
      logical :: whole = .true.                 !! it has an end: /END, or the engine part
      logical :: torn = .false.                 !! its last line is a card without a line end
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

   !> Line of the first card of a block after its title
   pure integer function first_card(deck, block) result(line)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block

      line = deck%block(block)%first
      if (title_line(deck, block) > 0) line = line + 1
   end function first_card

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

   !> What is added to the ids of a family in a submodel
   pure integer function id_shift(deck, submodel, family) result(shift)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: submodel           !! index, 0 = none
      integer, intent(in) :: family             !! OF_ constant of kj_field

      shift = 0
      if (submodel == 0 .or. family == 0) return
      associate (s => deck%submodel(submodel)%shift)
         shift = s(0)
         if (family < size(s)) shift = s(family)
      end associate
   end function id_shift

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
   subroutine add_deck_finding(deck, line, first, last, severity, id, message, label, hint)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! index; 0 = no place
      integer, intent(in) :: first, last        !! columns
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      character(len=:), allocatable :: file
      integer :: number

      call place_of(deck, line, file, number)
      if (is_known(deck%findings, id, file, number, first, last)) return
      if (deck%has_mute) then
         if (is_mute(deck, line)) return
      end if
      call add_at(deck%findings, severity, id, file, number, line_text(deck, line), first, last, &
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

   !> The line belongs to a mute block
   pure logical function is_mute(deck, line)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index, 1 to n_line

      integer :: block

      block = block_at(deck, line)
      is_mute = .false.
      if (block > 0) is_mute = deck%block(block)%mute .and. line <= deck%block(block)%last
   end function is_mute

   !> The last block that begins at a line or before it, 0 = none; blocks ascend in lines
   pure integer function block_at(deck, line) result(block)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index, 1 to n_line

      integer :: hi, middle

      block = 0
      hi = deck%n_block
      do while (block < hi)
         middle = (block + hi + 1)/2
         if (deck%block(middle)%header <= line) then
            block = middle
         else
            hi = middle - 1
         end if
      end do
   end function block_at

   !> /GRSHEL/PART/7 -> PART, of the header of a block
   pure function kind_word(deck, block) result(word)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      character(len=10) :: word

      character(len=120) :: text
      integer :: slash

      text = line_text(deck, deck%block(block)%header)
      slash = index(text(2:), '/') + 1
      word = ''
      if (slash > 1) word = text(slash + 1:slash + index(text(slash + 1:)//'/', '/') - 1)
   end function kind_word

   !> Append an error that points at a file as a whole
   subroutine report_file(deck, path, id, message, label)
      type(deck_t), intent(inout) :: deck
      character(len=*), intent(in) :: path, id, message, label

      type(error_t), allocatable :: finding

      call fail(finding, ERR_INPUT, message, id)
      finding%file = path
      finding%label = label
      call add_finding(deck%findings, finding)
   end subroutine report_file

   !> Append a finding that points at the header of a block
   subroutine report_header(deck, block, severity, id, message, label, hint)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      call report_line(deck, deck%block(block)%header, severity, id, message, label, hint)
   end subroutine report_header

   !> Append a finding that points at a whole line
   subroutine report_line(deck, line, severity, id, message, label, hint)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! index; 0 = no place
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      call add_deck_finding(deck, line, 1, header_end(deck, line), severity, id, message, label, &
         hint)
   end subroutine report_line

   !> Last column of a header, at least 1
   pure integer function header_end(deck, line) result(last)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line

      last = max(1, len_trim(line_text(deck, line)))
   end function header_end

   !> Append a line
   pure subroutine add_line(deck, s, number, first, last)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: s, number, first, last

      integer :: n

      n = deck%n_line + 1
      if (n == 1) allocate (deck%line_source(64), deck%line_number(64), deck%line_first(64), &
         deck%line_last(64))
      if (n > size(deck%line_first)) then
         call lengthen(deck%line_source)
         call lengthen(deck%line_number)
         call lengthen(deck%line_first)
         call lengthen(deck%line_last)
      end if
      deck%n_line = n
      deck%line_source(n) = s
      deck%line_number(n) = number
      deck%line_first(n) = first
      deck%line_last(n) = last
      deck%source(s)%used = max(deck%source(s)%used, last)
   end subroutine add_line

   !> Move a text into the deck
   pure subroutine add_source(deck, source, s)
      type(deck_t), intent(inout) :: deck
      type(source_t), intent(inout) :: source
      integer, intent(out) :: s                 !! its index

      type(source_t), allocatable :: longer(:)
      integer :: i

      if (deck%n_source == size(deck%source)) then
         allocate (longer(2*deck%n_source))
         do i = 1, deck%n_source
            call move_source(deck%source(i), longer(i))
         end do
         call move_alloc(longer, deck%source)
      end if
      s = deck%n_source + 1
      deck%n_source = s
      call move_source(source, deck%source(s))
   end subroutine add_source

   !> Move the text of a file without a copy
   pure subroutine move_source(from, to)
      type(source_t), intent(inout) :: from, to

      to%role = from%role
      to%used = from%used
      to%digest = from%digest
      call move_alloc(from%path, to%path)
      call move_alloc(from%text, to%text)
   end subroutine move_source

   !> Write a text behind the first n bytes of another
   pure subroutine put_text(line, n, text)
      character(len=*), intent(in) :: line
      integer, intent(in) :: n
      character(len=:), allocatable, intent(inout) :: text

      character(len=:), allocatable :: longer

      if (n + len(line) > len(text)) then
         allocate (character(len=2*(n + len(line)) + 4096) :: longer)
         longer(:n) = text(:n)
         call move_alloc(longer, text)
      end if
      text(n + 1:n + len(line)) = line
   end subroutine put_text

   !> Append a block
   pure subroutine add_block(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      type(block_t), allocatable :: longer(:)

      if (deck%n_block == size(deck%block)) then
         allocate (longer(2*deck%n_block))
         longer(:deck%n_block) = deck%block
         call move_alloc(longer, deck%block)
      end if
      deck%n_block = deck%n_block + 1
      deck%block(deck%n_block) = block
   end subroutine add_block

   !> Double the length of an array
   pure subroutine lengthen(array)
      integer, allocatable, intent(inout) :: array(:)

      integer, allocatable :: longer(:)

      allocate (longer(2*size(array)))
      longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine lengthen

   !> Read a whole file; `problem` is '' when that went well.
   subroutine load_source(path, role, source, problem)
      character(len=*), intent(in) :: path, role
      type(source_t), intent(out) :: source
      character(len=:), allocatable, intent(out) :: problem

      integer(int64) :: n

      source%path = path
      source%role = role
      call read_piece(path, 0_int64, huge(0), source%text, n, problem)
   end subroutine load_source

   !> Folder of a path with its slash; '' when it has none
   pure function folder_of(path) result(folder)
      character(len=*), intent(in) :: path
      character(len=index(path, '/', back=.true.)) :: folder

      folder = path(:index(path, '/', back=.true.))
   end function folder_of

   !> Append the error of a file that cannot be read; line 0 when no line of a deck names it
   subroutine add_file_finding(id, message, file, line, text, first, last, findings)
      character(len=*), intent(in) :: id, message
      character(len=*), intent(in) :: file, text      !! place of the #include
      integer, intent(in) :: line, first, last
      type(finding_list_t), intent(inout) :: findings

      type(error_t), allocatable :: finding

      if (line > 0) then
         call fail_at(finding, file, line, text, first, last, message, 'this file')
         finding%code = ERR_FILE
      else
         call fail(finding, ERR_FILE, message)
         finding%file = file
      end if
      finding%id = id
      call add_finding(findings, finding)
   end subroutine add_file_finding

end module kj_deck_text
