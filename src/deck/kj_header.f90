!> Header lines of a deck, /WORD/WORD/number/number -> keyword, id and unit of a block, with a
!> finding for all that is odd.
module kj_header
   use kj_error, only: SEV_ERROR, SEV_WARNING, SEV_NOTE, has_finding
   use kj_keywords, only: keywords, find_keyword, nearest_keyword, READ_IT, NOTE_IT, FULL_ONLY, &
      ASIDE, KW_ADMAS, HEAD_ID, HEAD_UNIT, HEAD_TYPE_ID, HEAD_NONE, keyword_of
   use kj_spelling, only: upper, edit_distance
   use kj_number, only: parse_integer, NUMBER_TOO_LARGE
   use kj_card_fields, only: has_variant
   use kj_engine_text, only: is_engine_word
   use kj_deck_text, only: deck_t, block_t, add_deck_finding, line_text, header_end, report_line
   implicit none
   private

   public :: read_heading

   integer, parameter :: MOST_NUMBERS = 3
   integer, parameter :: ADMAS_OF_NODES(3) = [0, 1, 5]   !! types that no element has a part in

   !> A header taken apart
   type :: header_t
      character(len=:), allocatable :: path     !! the words: /PROP/TYPE33
      integer :: n = 0                          !! numbers after them, at most three
      integer :: number(MOST_NUMBERS) = 0
      integer :: first(MOST_NUMBERS) = 1, last(MOST_NUMBERS) = 1   !! their columns
      integer :: rest_first = 1, rest_last = 0  !! text that means nothing
   end type header_t

contains

   !> Read a header: keyword, row, variant, id and unit_id of the block are set
   subroutine read_heading(deck, line, indent, severity, block)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: indent             !! blanks before the header
      integer, intent(in) :: severity           !! of a keyword that is not supported
      type(block_t), intent(out) :: block

      type(header_t) :: header
      character(len=:), allocatable :: text
      integer :: row

      text = line_text(deck, line)
      if (indent > 0) call add_deck_finding(deck, line, 1, indent, SEV_ERROR, 'KJ-9024', &
         'blanks before a header', 'a header begins in column 1')
      call split_header(text(indent + 1:), header)
      row = find_keyword(header%path)
      if (row == 0) row = find_misspelt(deck, line, indent, header%path, severity)
      block%row = row
      block%header = line
      if (row == 0) return
      block%keyword = keyword_of(row)
      call take_numbers(deck, indent, header, block, severity)
      call report_status(deck, row, line, header%path, severity)
   end subroutine read_heading

   !> Put the numbers of a header where the row of the keyword says
   subroutine take_numbers(deck, indent, header, block, severity)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: indent
      type(header_t), intent(in) :: header
      type(block_t), intent(inout) :: block
      integer, intent(in) :: severity

      integer :: line, last

      line = block%header
      last = header_end(deck, line)
      if (header%rest_last >= header%rest_first) then
         call add_deck_finding(deck, line, indent + header%rest_first, indent + header%rest_last, &
            SEV_WARNING, 'KJ-9026', 'text after the numbers of a header', 'ignored')
      end if
      associate (row => keywords(block%row))
         select case (row%head)
         case (HEAD_ID)
            if (header%n >= 1) block%id = header%number(1)
            if (header%n >= 2) block%unit_id = header%number(2)
            if (header%n < 1 .and. row%status == READ_IT) call report_line(deck, line, &
               SEV_WARNING, 'KJ-9036', 'the header has no id', 'taken as id 1')
         case (HEAD_UNIT)
            if (header%n >= 1) block%unit_id = header%number(1)
         case (HEAD_TYPE_ID)
            if (header%n >= 1) block%variant = header%number(1)
            if (header%n >= 2) block%id = header%number(2)
            if (header%n >= 3) block%unit_id = header%number(3)
            if (header%n < 2) call report_line(deck, line, SEV_ERROR, 'KJ-9036', &
               'the header has no type or no id', 'expected: '//trim(row%name)//'/type/id')
            if (.not. has_variant(block%keyword, block%variant) .or. (block%keyword == KW_ADMAS &
               .and. .not. deck%full .and. all(block%variant /= ADMAS_OF_NODES))) then
               call report_line(deck, line, severity, 'KJ-9022', trim(row%name)// &
                  ' of this type is not supported', 'supported: types 0, 1 and 5')
               block%keyword = 0
            end if
         end select
         if (row%head == HEAD_NONE .and. row%status == READ_IT .and. header%n > 0) then
            call add_deck_finding(deck, line, indent + header%first(1), last, SEV_WARNING, &
               'KJ-9026', trim(row%name)//' has no id', 'ignored')
         end if
      end associate
   end subroutine take_numbers

   !> Tell of a keyword that is only noted or not supported
   subroutine report_status(deck, row, line, path, severity)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: row, line, severity
      character(len=*), intent(in) :: path       !! the words of the header

      character(len=:), allocatable :: near
      integer :: last

      last = header_end(deck, line)
      associate (k => keywords(row))
         if (any(k%status == [READ_IT, ASIDE]) .or. deck%full) return
         near = ''
         if (path /= k%name) near = trim(near_miss(path))
         if (len(near) > 0 .and. k%status == NOTE_IT) then
            call report_line(deck, line, SEV_WARNING, 'KJ-9023', path// ' has no effect here', &
               'is it misspelt?', 'did you mean '//near//'?')
            return
         else if (len(near) > 0) then
            call report_line(deck, line, severity, 'KJ-9022', line_text(deck, line)// &
               ' is not supported', 'is it misspelt?', 'did you mean '//near//'?')
            return
         end if
         if (k%status == NOTE_IT) then
            call report_line(deck, line, SEV_NOTE, 'KJ-9023', trim(k%name)// &
               ' has no effect here', trim(k%meaning))
         else
            call report_line(deck, line, severity, 'KJ-9022', line_text(deck, line)// &
               ' is not supported', 'needs: '//trim(k%meaning), &
               trim(cure(k%status, severity)))
         end if
      end associate
   end subroutine report_status

   !> What to do about a keyword that is not supported
   pure function cure(status, severity) result(text)
      integer, intent(in) :: status              !! OUT_OF_SCOPE or FULL_ONLY
      integer, intent(in) :: severity            !! SEV_WARNING: it is ignored
      character(len=110) :: text

      text = 'remove the block'
      if (severity == SEV_ERROR) text = 'remove the block, or ignore it with --ignore-unsupported'
      if (status == FULL_ONLY) text = &
         'run the mechanism of the deck alone with --mechanism, or see `kjoint help extract`'
   end function cure

   !> Keyword that is read and differs from `path` in two letters at most; '' when there is none, or
   !> when a digit makes the difference
   pure function near_miss(path) result(name)
      character(len=*), intent(in) :: path
      character(len=len(keywords%name)) :: name

      integer :: row

      do row = 1, size(keywords)
         if (keywords(row)%status /= READ_IT .or. scan(path, '0123456789') > 0) cycle
         name = keywords(row)%name
         if (edit_distance(path, trim(name)) <= 2) return
      end do
      name = ''
   end function near_miss

   !> Row of a keyword in lower case, else 0; with a finding in any case
   integer function find_misspelt(deck, line, indent, path, severity) result(row)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line, indent, severity
      character(len=*), intent(in) :: path

      character(len=:), allocatable :: near, hint
      integer :: last, level

      last = indent + len(path)
      row = find_keyword(upper(path))
      if (deck%full) then
         near = trim(nearest_keyword(path))
         level = SEV_NOTE
         if (row > 0) near = upper(path)
         if (len(near) > 0) level = merge(SEV_WARNING, SEV_NOTE, row > 0 .or. &
            edit_distance(path, near) == 1)
         call add_deck_finding(deck, line, indent + 1, last, level, 'KJ-9020', path// &
            ' is not a keyword', 'left out, as in Radioss', merge('did you mean '//near//'?', &
            repeat(' ', len(near) + 14), level == SEV_WARNING))
         row = 0
         return
      end if
      if (row > 0) then
         call add_deck_finding(deck, line, indent + 1, last, severity, 'KJ-9021', path// &
            ' is not in upper case', 'Radioss ignores such a block', 'write '//upper(path))
         if (severity /= SEV_ERROR) row = 0
         return
      end if
      if (is_engine_word(path(2:))) then
         if (.not. has_finding(deck%findings, 'KJ-9061')) call report_line(deck, line, severity, &
            'KJ-9061', 'a keyword of the engine deck', 'a deck in one file?', 'put '// &
            'the lines from /RUN on into a file of their own, ROOT_0001.rad beside ROOT_0000.rad')
         return
      end if
      near = trim(nearest_keyword(path))
      hint = ''
      if (len(near) > 0) hint = 'did you mean '//near//'?'
      if (index(path, ' ') > 0) then
         if (find_keyword(path(:index(path, ' ') - 1)) > 0) &
            hint = 'nothing may follow the word; put it in a comment line'
      end if
      call add_deck_finding(deck, line, indent + 1, last, severity, 'KJ-9020', path// &
         ' is not a keyword', 'unknown keyword', hint)
   end function find_misspelt

   !> Take a header apart; a number ends at the first character that is no digit
   pure subroutine split_header(text, header)
      character(len=*), intent(in) :: text      !! begins with /
      type(header_t), intent(out) :: header

      integer :: at, first, last, slash, digits_end
      logical :: is_number

      header%path = ''
      at = 1
      do while (at <= len(text))
         slash = index(text(at + 1:), '/')
         last = len(text)
         if (slash > 0) last = at + slash - 1
         first = at + 1
         call find_number(text, first, last, digits_end, is_number)
         if (is_number .and. header%n < MOST_NUMBERS) then
            call take_number(text, first, digits_end, header)
            call note_rest(text, digits_end + 1, last, header)
         else if (header%n > 0) then
            call note_rest(text, first, last, header)
         else if (slash > 0 .or. len_trim(text(first:last)) > 0) then
            header%path = header%path//'/'//trim(text(first:last))
         end if
         at = last + 1
      end do
   end subroutine split_header

   !> A number, with a sign perhaps, begins in column `first`
   pure subroutine find_number(text, first, last, digits_end, is_number)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: first           !! moved over blanks before a number
      integer, intent(in) :: last
      integer, intent(out) :: digits_end
      logical, intent(out) :: is_number

      integer :: i, n

      digits_end = first - 1
      is_number = .false.
      i = verify(text(first:last), ' ') + first - 1
      if (i < first) return
      n = i
      if (text(i:i) == '+' .or. text(i:i) == '-') n = i + 1
      digits_end = last
      if (n <= last) digits_end = verify(text(n:last), '0123456789') + n - 2
      if (digits_end < n - 1) digits_end = last
      is_number = digits_end >= n
      if (is_number) first = i
   end subroutine find_number

   !> Append a number; one that is too large becomes the largest integer
   pure subroutine take_number(text, first, last, header)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last
      type(header_t), intent(inout) :: header

      integer :: value, status

      call parse_integer(text(first:last), value, status)
      if (status == NUMBER_TOO_LARGE) value = huge(value)
      header%n = header%n + 1
      header%number(header%n) = value
      header%first(header%n) = first
      header%last(header%n) = last
   end subroutine take_number

   !> Note the first text that means nothing
   pure subroutine note_rest(text, first, last, header)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last
      type(header_t), intent(inout) :: header

      if (header%rest_last >= header%rest_first .or. last < first) return
      if (text(first:last) == '') return
      header%rest_first = first + verify(text(first:last), ' ') - 1
      header%rest_last = first + len_trim(text(first:last)) - 1
   end subroutine note_rest

end module kj_header
