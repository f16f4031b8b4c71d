!> `kjoint help`: the program, one command, the cards of a keyword, or one message explained.
module kj_help
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_version, only: KJOINT_VERSION
   use kj_keywords, only: nearest_keyword
   use kj_card_page, only: find_keyword_page, print_keyword_page
   use kj_message, only: messages, find_message
   use kj_option, only: commands, option_t, option, has_option, N_OPTION
   use kj_spelling, only: did_you_mean
   use kj_table_json, only: help_json
   use kj_words, only: buffer_t
   use kj_terminal, only: print_line
   implicit none
   private

   public :: print_help_on

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

end module kj_help
