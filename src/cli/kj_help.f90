!> `kjoint help` and `kjoint list`: what the tables of the program say, as lines or as JSON.
!> One file: help and list show the same tables
module kj_help
   use kj_error, only: error_t, fail, ERR_INPUT, str
   use kj_version, only: KJOINT_VERSION
   use kj_keywords, only: nearest_keyword, keywords, keyword_of, status_name
   use kj_card_page, only: find_keyword_page, print_keyword_page
   use kj_message, only: messages, find_message
   use kj_option, only: commands, option_t, option, has_option, N_OPTION
   use kj_engine_text, only: engine_words, find_engine_word
   use kj_spelling, only: did_you_mean, upper
   use kj_words, only: buffer_t, add, json_member, comma, json_pair, json_text, json_list
   use kj_terminal, only: print_line
   use kj_units, only: dimensions
   use kj_card_fields, only: fields, EACH
   use kj_joint_types, only: joint_types, DOF_NAME, FRAME_CROSS
   use kj_channels, only: channels
   use kj_series, only: channel_path
   implicit none
   private

   public :: print_help_on, print_table

   character(len=8), parameter :: TABLES(3) = ['joints  ', 'keywords', 'channels']
   character(len=*), parameter :: HEADING(3) = [character(len=90) :: &
      'type  name          nodes  free directions     blocked by Kn       frame', &
      'keyword               status       meaning, or what would be needed', &
      'channel                           size  dimension             Radioss       meaning']

   character(len=47), parameter :: CROSS = ' one axis of each body', &
      MEAN = ' mean of both skews, or the first (skew flag 1)'
   integer, parameter :: N_ROW(3) = [size(joint_types), size(keywords), size(channels)]

   character(len=*), parameter :: BEGIN = '{"exit_code": 0, ', NL = new_line('a')

   !> By ENGINE_ constant
   character(len=36), parameter :: ENGINE_STATUS(3) = [character(len=36) :: 'read', &
      'has no effect here', 'not supported: this would be needed']
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
      k = 0
      if (index(topic, '/') == 1) i = find_keyword_page(topic)
      if (index(topic, '/') == 1) k = engine_row(topic)
      if (i > 0) then
         call print_keyword_page(i)
      else if (k > 0) then
         call print_line(upper(topic)//' of the engine deck: '//trim(engine_words(k)%meaning))
         call print_line('   '//trim(ENGINE_STATUS(engine_words(k)%status)))
      else if (index(topic, '/') == 1) then
         call fail(error, ERR_INPUT, 'there is no keyword "'//topic//'"')
         error%hint = trim(nearest_keyword(topic))
         if (len(error%hint) > 0) error%hint = 'did you mean '//error%hint//'?'
         if (len(error%hint) == 0) error%hint = '`kjoint list keywords` has all'
      else
         call print_message(topic, error)
      end if
   end subroutine print_help_on

   !> Row of a keyword of the engine deck, /DT/NODA say; 0 = none
   pure integer function engine_row(topic) result(row)
      character(len=*), intent(in) :: topic

      row = find_engine_word(upper(topic(2:index(topic(2:)//'/', '/'))))
   end function engine_row

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
         if (find_keyword_page('/'//topic) > 0) error%hint = 'did you mean /'//upper(topic)//'?'
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
         if (row == 0) then
            row = engine_row(topic)
            if (row > 0) call add(b, BEGIN//json_member('keyword', upper(topic))//', '// &
               json_member('status', trim(ENGINE_STATUS(engine_words(row)%status)))//', '// &
               json_member('meaning', trim(engine_words(row)%meaning))//'}')
            return
         end if
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

   !> Print one table on stdout, as lines or as a JSON object
   !>
   !> Errors: ERR_INPUT when there is no table of this name
   subroutine print_table(name, as_json, error)
      character(len=*), intent(in) :: name
      logical, intent(in) :: as_json
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: row
      integer :: i, table

      call find_table(name, table, error)
      if (allocated(error)) return
      if (as_json) call print_line('{"exit_code": 0, "'//name//'": [')
      if (.not. as_json) call print_line(trim(HEADING(table)))
      do i = 1, N_ROW(table)
         row = ''
         select case (name)
         case ('joints')
            call add_joint()
         case ('keywords')
            call same('keyword', trim(keywords(i)%name), 22)
            call same('status', trim(status_name(keywords(i)%status)), 13)
            call same('meaning', trim(keywords(i)%meaning), 1)
         case ('channels')
            call add_channel()
         end select
         if (as_json) row = '{'//row(3:)//'}'//trim(merge(',', ' ', i < N_ROW(table)))
         call print_line(row)
      end do
      if (as_json) call print_line(']}')

   contains

      subroutine add_joint()
         associate (t => joint_types(i))
            call cell('type', str(t%id), '  '//str(t%id), 6)
            call same('name', trim(t%name), len(t%name) + 2)
            call cell('nodes', str(t%n_axis_node), str(t%n_axis_node), 4)
            call cell('free', json_list(pack(DOF_NAME, t%free == 1)), &
               words(pack(DOF_NAME, t%free == 1)), 20)
            call cell('blocked', json_list(pack(DOF_NAME, t%free == 0)), &
               words(pack(DOF_NAME, t%free == 0)), 20)
            call cell('frame', trim(merge('"cross"', '"mean" ', t%frame == FRAME_CROSS)), &
               trim(merge(CROSS, MEAN, t%frame == FRAME_CROSS)), 1)
         end associate
      end subroutine add_joint

      subroutine add_channel()
         associate (c => channels(i))
            call same('channel', channel_path(i), 34)
            call cell('size', str(c%n_comp), '  '//str(c%n_comp), 6)
            call same('dimension', trim(dimensions(c%dim)%name), 22)
            call same('class', trim(c%class), 0)
            call same('frame', trim(c%frame), 0)
            call same('radioss', trim(c%radioss), 14)
            call same('meaning', trim(c%meaning), 1)
         end associate
      end subroutine add_channel

      !> A text that is the same for people and in JSON
      subroutine same(key, text, width)
         character(len=*), intent(in) :: key, text
         integer, intent(in) :: width

         call cell(key, json_text(text), text, width)
      end subroutine same

      !> A member of the JSON object, or a column of so many letters; 0: not for people, 1: the last
      subroutine cell(key, json, text, width)
         character(len=*), intent(in) :: key, json, text
         integer, intent(in) :: width

         if (as_json) then
            row = row//', '//json_pair(key, json)
         else if (width == 1) then
            row = row//text
         else
            row = row//text(:min(len(text), width))//repeat(' ', max(0, width - len(text)))
         end if
      end subroutine cell
   end subroutine print_table

   subroutine find_table(name, table, error)
      character(len=*), intent(in) :: name
      integer, intent(out) :: table
      type(error_t), allocatable, intent(out) :: error

      table = findloc(TABLES, name, dim=1)
      if (table > 0) return
      call fail(error, ERR_INPUT, 'there is no table "'//name//'"')
      error%hint = trim(did_you_mean(name, TABLES))
      if (len(error%hint) == 0) error%hint = 'joints, keywords or channels'
   end subroutine find_table

   !> " tx ry"
   pure function words(names) result(text)
      character(len=*), intent(in) :: names(:)
      character(len=(len(names) + 1)*size(names)) :: text

      integer :: i

      write (text, '(*(1x,a))') (names(i), i=1, size(names))
   end function words

end module kj_help
