!> Header lines of a deck -> keyword, id and unit of a block, with a finding for all that is odd.
module kj_header_block
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING, SEV_NOTE
   use kj_keywords, only: keywords, find_keyword, nearest_keyword, READ_IT, NOTE_IT, HEAD_ID, &
      HEAD_UNIT, HEAD_TYPE_ID, HEAD_NONE, KW_OTHER
   use kj_spelling, only: upper, edit_distance
   use kj_card_fields, only: has_variant
   use kj_deck_text, only: deck_t, block_t, add_deck_finding, line_text, header_end
   use kj_header_line, only: header_t, split_header
   implicit none
   private

   public :: read_heading

contains

   !> Read a header: keyword, row, variant, id and unit_id of the block are set
   subroutine read_heading(deck, line, indent, severity, block, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: indent             !! blanks before the header
      integer, intent(in) :: severity           !! of a keyword that is not supported
      type(block_t), intent(out) :: block
      type(finding_list_t), intent(inout) :: findings

      type(header_t) :: header
      character(len=:), allocatable :: text
      integer :: row

      text = line_text(deck, line)
      if (indent > 0) call add_deck_finding(deck, line, 1, indent, SEV_ERROR, 'KJ-9024', &
         'blanks before a header', 'a header begins in column 1', findings)
      call split_header(text(indent + 1:), header)
      row = find_keyword(header%path)
      if (row == 0) row = find_misspelt(deck, line, indent, header%path, severity, findings)
      block%row = row
      block%header = line
      if (row == 0) return
      block%keyword = merge(keywords(row)%id, KW_OTHER, keywords(row)%status == READ_IT)
      call take_numbers(deck, indent, header, block, severity, findings)
      call report_status(deck, row, line, header%path, severity, findings)
   end subroutine read_heading

   !> Put the numbers of a header where the row of the keyword says
   subroutine take_numbers(deck, indent, header, block, severity, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: indent
      type(header_t), intent(in) :: header
      type(block_t), intent(inout) :: block
      integer, intent(in) :: severity
      type(finding_list_t), intent(inout) :: findings

      integer :: line, last

      line = block%header
      last = header_end(deck, line)
      if (header%rest_last >= header%rest_first) then
         call add_deck_finding(deck, line, indent + header%rest_first, indent + header%rest_last, &
            SEV_WARNING, 'KJ-9026', 'text after the numbers of a header', 'ignored', findings)
      end if
      associate (row => keywords(block%row))
         select case (row%head)
         case (HEAD_ID)
            if (header%n >= 1) block%id = header%number(1)
            if (header%n >= 2) block%unit_id = header%number(2)
            if (header%n < 1 .and. row%status == READ_IT) call add_deck_finding(deck, line, 1, &
               last, &
               SEV_WARNING, 'KJ-9036', 'the header has no id', 'taken as id 1', findings)
         case (HEAD_UNIT)
            if (header%n >= 1) block%unit_id = header%number(1)
         case (HEAD_TYPE_ID)
            if (header%n >= 1) block%variant = header%number(1)
            if (header%n >= 2) block%id = header%number(2)
            if (header%n >= 3) block%unit_id = header%number(3)
            if (header%n < 2) call add_deck_finding(deck, line, 1, last, SEV_ERROR, 'KJ-9036', &
               'the header has no type or no id', 'expected: '//trim(row%name)//'/type/id', &
               findings)
            if (.not. has_variant(row%id, block%variant)) then
               call add_deck_finding(deck, line, 1, last, severity, 'KJ-9022', trim(row%name)// &
                  ' of this type is not supported', 'supported: types 0, 1 and 5', findings)
               block%keyword = KW_OTHER
            end if
         end select
         if (row%head == HEAD_NONE .and. row%status == READ_IT .and. header%n > 0) then
            call add_deck_finding(deck, line, indent + header%first(1), last, SEV_WARNING, &
               'KJ-9026', trim(row%name)//' has no id', 'ignored', findings)
         end if
      end associate
   end subroutine take_numbers

   !> Tell of a keyword that is only noted or not supported
   subroutine report_status(deck, row, line, path, severity, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: row, line, severity
      character(len=*), intent(in) :: path       !! the words of the header
      type(finding_list_t), intent(inout) :: findings

      character(len=:), allocatable :: near
      integer :: last

      last = header_end(deck, line)
      associate (k => keywords(row))
         if (k%status == READ_IT) return
         near = ''
         if (path /= k%name) near = trim(near_miss(path))
         if (len(near) > 0 .and. k%status == NOTE_IT) then
            call add_deck_finding(deck, line, 1, last, SEV_WARNING, 'KJ-9023', path// &
               ' has no effect here', 'is it misspelt?', findings, 'did you mean '//near//'?')
            return
         else if (len(near) > 0) then
            call add_deck_finding(deck, line, 1, last, severity, 'KJ-9022', &
               line_text(deck, line)//' is not supported', 'is it misspelt?', findings, &
               'did you mean '//near//'?')
            return
         end if
         if (k%status == NOTE_IT) then
            call add_deck_finding(deck, line, 1, last, SEV_NOTE, 'KJ-9023', &
               trim(k%name)//' has no effect here', trim(k%meaning), findings)
         else
            call add_deck_finding(deck, line, 1, last, severity, 'KJ-9022', &
               line_text(deck, line)//' is not supported', 'needs: '//trim(k%meaning), findings, &
               'remove the block, or ignore it with --ignore-unsupported')
         end if
      end associate
   end subroutine report_status

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
   integer function find_misspelt(deck, line, indent, path, severity, findings) result(row)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line, indent, severity
      character(len=*), intent(in) :: path
      type(finding_list_t), intent(inout) :: findings

      character(len=:), allocatable :: near, hint
      integer :: last

      last = indent + len(path)
      row = find_keyword(upper(path))
      if (row > 0) then
         call add_deck_finding(deck, line, indent + 1, last, severity, 'KJ-9021', &
            path//' is not in upper case', 'Radioss ignores such a block', findings, &
            'write '//upper(path))
         if (severity /= SEV_ERROR) row = 0
         return
      end if
      near = trim(nearest_keyword(path))
      hint = ''
      if (len(near) > 0) hint = 'did you mean '//near//'?'
      if (index(path, ' ') > 0) then
         if (find_keyword(path(:index(path, ' ') - 1)) > 0) &
            hint = 'nothing may follow the word; put it in a comment line'
      end if
      call add_deck_finding(deck, line, indent + 1, last, severity, 'KJ-9020', &
         path//' is not a keyword', 'unknown keyword', findings, hint)
   end function find_misspelt

end module kj_header_block
