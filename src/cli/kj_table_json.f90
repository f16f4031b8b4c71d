!> `kjoint help --json`: what the program knows for other programs.
module kj_table_json
   use kj_version, only: KJOINT_VERSION
   use kj_units, only: dimensions
   use kj_keywords, only: keywords, keyword_of, status_name
   use kj_card_fields, only: fields, EACH
   use kj_message, only: messages, find_message
   use kj_option, only: commands, option_t, option, has_option, N_OPTION
   use kj_card_page, only: find_keyword_page
   use kj_json_writer, only: json_member, comma
   use kj_words, only: buffer_t, add
   implicit none
   private

   public :: help_json

   character(len=*), parameter :: BEGIN = '{"exit_code": 0, ', NL = new_line('a')

contains

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

end module kj_table_json
