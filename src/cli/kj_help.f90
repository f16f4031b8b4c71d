!> `kjoint help`: the program, one command, the cards of a keyword, or one message explained.
module kj_help
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_version, only: KJOINT_VERSION
   use kj_keywords, only: nearest_keyword, keywords, keyword_of, status_name
   use kj_card_page, only: find_keyword_page, print_keyword_page
   use kj_message, only: messages, find_message
   use kj_option, only: commands, option_t, option, has_option, N_OPTION
   use kj_spelling, only: did_you_mean
   use kj_words, only: buffer_t, add
   use kj_terminal, only: print_line
   use kj_units, only: dimensions
   use kj_card_fields, only: fields, EACH
   use kj_json_writer, only: json_member, comma
   implicit none
   private

   public :: print_help_on

   character(len=*), parameter :: BEGIN = '{"exit_code": 0, ', NL = new_line('a')

   integer, parameter :: WIDTH = 90              !! of paragraphs

contains

   !> All commands, and the options of the main one
   subroutine print_help()
      integer :: i

      call print_line('kjoint '//KJOINT_VERSION// &
                      ': kinematic joints between rigid bodies, as Radioss decks have them')
      call print_line('')
      call print_line('usage: kjoint COMMAND ...')
      call print_line('')
      do i = 1, size(commands)
         call print_row(trim(commands(i)%name)//' '//commands(i)%operands, commands(i)%meaning)
      end do
      call print_line('')
      call print_options(1)
      call print_line('')
      call print_line('Exit codes: 0 well; 1 ran and found against you; 2 usage or deck; 3 file;')
      call print_line('4 internal; 130, 143 stopped by a signal. `kjoint help COMMAND` says more.')
   end subroutine print_help

   !> One command, one keyword, or one message by its id, as lines or as a JSON object; all where
   !> the topic is empty
   !>
   !> Errors: ERR_INPUT when there is neither
   subroutine print_help_on(topic, as_json, error)
      character(len=*), intent(in) :: topic
      logical, intent(in) :: as_json
      type(error_t), allocatable, intent(out) :: error

      type(buffer_t) :: b
      integer :: i, k

      if (as_json) call help_json(topic, b)
      if (b%n > 0) then
         call print_line(b%s(:b%n))
         return
      else if (topic == '') then
         call print_help()
         return
      end if
      do i = 1, size(commands)
         if (commands(i)%name /= topic) cycle
         call print_line('usage: kjoint '//trim(commands(i)%name)//' '//trim(commands(i)%operands))
         call print_line('')
         call print_line('   '//trim(commands(i)%meaning))
         if (any([(has_option(i, option(k)), k=1, N_OPTION)])) then
            call print_line('')
            call print_options(i)
         end if
         return
      end do
      i = 0
      if (index(topic, '/') == 1) i = find_keyword_page(topic)
      if (i > 0) then
         call print_keyword_page(i)
      else if (index(topic, '/') == 1) then
         call fail(error, ERR_INPUT, 'there is no keyword "'//topic//'"')
         error%hint = trim(nearest_keyword(topic))
         if (len(error%hint) > 0) error%hint = 'did you mean '//error%hint//'?'
         if (len(error%hint) == 0) error%hint = '`kjoint list keywords` has all'
      else
         call print_message(topic, error)
      end if
   end subroutine print_help_on

   subroutine print_options(command)
      integer, intent(in) :: command

      character(len=4) :: short
      type(option_t) :: o
      integer :: i

      call print_line('Options of '//trim(commands(command)%name)//':')
      do i = 1, N_OPTION
         o = option(i)
         if (.not. has_option(command, o)) cycle
         short = ''
         if (o%short /= '') short = o%short//', '
         call print_row(short//trim(o%name)//' '//o%value, o%meaning)
      end do
   end subroutine print_options

   subroutine print_row(name, meaning)
      character(len=*), intent(in) :: name, meaning

      character(len=33) :: column

      if (len_trim(name) >= len(column)) then
         call print_line('   '//trim(name))
         column = ''
      else
         column = name
      end if
      call print_line('   '//column//trim(meaning))
   end subroutine print_row

   !> What a message means, why it comes and what to do
   subroutine print_message(topic, error)
      character(len=*), intent(in) :: topic
      type(error_t), allocatable, intent(out) :: error

      integer :: row

      row = find_message(topic)
      if (row == 0) then
         call fail(error, ERR_INPUT, 'there is no command and no message "'//topic//'"')
         error%hint = trim(did_you_mean(topic, commands%name))
         return
      end if
      call print_line(trim(messages(row)%id)//': '//trim(messages(row)%title))
      call print_line('')
      call print_wrapped('   cause: ', trim(messages(row)%cause))
      call print_wrapped('   cure:  ', trim(messages(row)%cure))
   end subroutine print_message

   !> A paragraph in lines of at most WIDTH characters, all but the first behind blanks
   subroutine print_wrapped(head, text)
      character(len=*), intent(in) :: head, text

      character(len=len(head)) :: margin
      integer :: first, last

      margin = head
      first = 1
      do while (first <= len(text))
         last = len(text)
         if (last - first + 1 > WIDTH - len(head)) then
            last = first + index(text(first:first + WIDTH - len(head)), ' ', back=.true.) - 2
            if (last < first) last = first + WIDTH - len(head) - 1      ! a word of that length
         end if
         call print_line(margin//text(first:last))
         margin = ''
         first = last + 1
         if (first <= len(text)) first = first + verify(text(first:), ' ') - 1
      end do
   end subroutine print_wrapped

   pure function keyword_members(i) result(json)
      integer, intent(in) :: i
      character(len=:), allocatable :: json

      json = json_member('keyword', trim(keywords(i)%name))//', '// &
         json_member('status', trim(status_name(keywords(i)%status)))//', '// &
         json_member('meaning', trim(keywords(i)%meaning))
   end function keyword_members

   !> The program (topic ''), a command, a keyword or a message; nothing is added where a topic is
   !> none of these
   subroutine help_json(topic, b)
      character(len=*), intent(in) :: topic
      type(buffer_t), intent(inout) :: b

      integer :: i, row

      if (topic == '') then
         call add(b, BEGIN//json_member('version', KJOINT_VERSION)//', "commands": [')
         do i = 1, size(commands)
            call add(b, NL//'{'//command_members(i)//'}'//comma(i, size(commands)))
         end do
         call add(b, NL//']}')
         return
      end if
      row = findloc(commands%name, topic, dim=1)
      if (row > 0) then
         call add(b, BEGIN//command_members(row)//', "options": [')
         call add_options(row, b)
         call add(b, NL//']}')
      else if (index(topic, '/') == 1) then
         row = find_keyword_page(topic)
         if (row == 0) return
         call add(b, BEGIN//keyword_members(row)//', "fields": [')
         call add_fields(keyword_of(row), b)
         call add(b, NL//']}')
      else
         row = find_message(topic)
         if (row == 0) return
         associate (m => messages(row))
            call add(b, BEGIN//json_member('id', trim(m%id))//', '// &
               json_member('title', trim(m%title))//', '//json_member('cause', trim(m%cause))// &
               ', '//json_member('cure', trim(m%cure))//'}')
         end associate
      end if
   end subroutine help_json

   pure function command_members(i) result(json)
      integer, intent(in) :: i
      character(len=:), allocatable :: json

      json = json_member('command', trim(commands(i)%name))//', '// &
         json_member('operands', trim(commands(i)%operands))//', '// &
         json_member('meaning', trim(commands(i)%meaning))
   end function command_members

   subroutine add_options(command, b)
      integer, intent(in) :: command
      type(buffer_t), intent(inout) :: b

      type(option_t) :: o
      character(len=:), allocatable :: between
      integer :: i

      between = NL
      do i = 1, N_OPTION
         o = option(i)
         if (.not. has_option(command, o)) cycle
         call add(b, between//'{'//json_member('short', trim(o%short))//', '// &
            json_member('name', trim(o%name))//', '//json_member('value', trim(o%value))//', '// &
            json_member('meaning', trim(o%meaning))//'}')
         between = ','//NL
      end do
   end subroutine add_options

   !> The fields of the cards of a keyword; variant: joint type, or type in the header
   subroutine add_fields(keyword, b)
      integer, intent(in) :: keyword
      type(buffer_t), intent(inout) :: b

      character(len=:), allocatable :: between
      integer :: i

      between = NL
      do i = 1, size(fields)
         associate (f => fields(i))
            if (f%keyword /= keyword) cycle
            call add(b, between//'{'//json_member('card', f%card)//', '// &
               json_member('first', f%first)//', '//json_member('last', f%last)//', '// &
               json_member('name', trim(f%name))//', '//json_member('kind', f%kind)//', '// &
               json_member('dimension', trim(dimensions(f%dim)%name))//', '// &
               json_member('meaning', trim(f%meaning)))
            if (f%variant /= EACH) call add(b, ', '//json_member('variant', f%variant))
            call add(b, '}')
         end associate
         between = ','//NL
      end do
   end subroutine add_fields

end module kj_help
