!> `kjoint list --json` and `kjoint help --json`: the tables of the program for other programs.
module kj_table_json
   use kj_version, only: KJOINT_VERSION
   use kj_units, only: dimensions
   use kj_joint_types, only: joint_types, DOF_NAME, NDOF, FRAME_CROSS
   use kj_keywords, only: keywords, keyword_of, status_name
   use kj_card_fields, only: fields, EACH
   use kj_channels, only: channels
   use kj_series, only: channel_path
   use kj_message, only: messages, find_message
   use kj_option, only: commands, option_t, option, has_option, N_OPTION
   use kj_card_page, only: find_keyword_page
   use kj_json_writer, only: json_member, json_pair, json_text, comma
   use kj_words, only: buffer_t, add
   implicit none
   private

   public :: table_json, help_json

   character(len=*), parameter :: BEGIN = '{"exit_code": 0, ', NL = new_line('a')

contains

   !> One of the tables joints, keywords, channels: an object with a list of its rows
   subroutine table_json(name, b)
      character(len=*), intent(in) :: name
      type(buffer_t), intent(inout) :: b

      integer :: i

      call add(b, BEGIN//'"'//name//'": [')
      select case (name)
      case ('joints')
         do i = 1, size(joint_types)
            associate (t => joint_types(i))
               call add(b, NL//'{'//json_member('type', t%id)//', '// &
                  json_member('name', trim(t%name))//', '//json_member('nodes', t%n_axis_node)// &
                  ', '//json_pair('free', directions(t%free == 1))//', '// &
                  json_pair('blocked', directions(t%free == 0))//', '//json_member('frame', &
                  trim(merge('cross', 'mean ', t%frame == FRAME_CROSS)))//'}'// &
                  comma(i, size(joint_types)))
            end associate
         end do
      case ('keywords')
         do i = 1, size(keywords)
            call add(b, NL//'{'//keyword_members(i)//'}'//comma(i, size(keywords)))
         end do
      case ('channels')
         do i = 1, size(channels)
            associate (c => channels(i))
               call add(b, NL//'{'//json_member('channel', channel_path(i))//', '// &
                  json_member('size', c%n_comp)//', '// &
                  json_member('dimension', trim(dimensions(c%dim)%name))//', '// &
                  json_member('class', trim(c%class))//', '//json_member('frame', trim(c%frame))// &
                  ', '//json_member('radioss', trim(c%radioss))//', '// &
                  json_member('meaning', trim(c%meaning))//'}'//comma(i, size(channels)))
            end associate
         end do
      end select
      call add(b, NL//']}')
   end subroutine table_json

   pure function keyword_members(i) result(json)
      integer, intent(in) :: i
      character(len=:), allocatable :: json

      json = json_member('keyword', trim(keywords(i)%name))//', '// &
         json_member('status', trim(status_name(keywords(i)%status)))//', '// &
         json_member('meaning', trim(keywords(i)%meaning))
   end function keyword_members

   !> ["tx", "ry"]
   pure function directions(wanted) result(json)
      logical, intent(in) :: wanted(NDOF)
      character(len=:), allocatable :: json

      integer :: dof

      json = ''
      do dof = 1, NDOF
         if (wanted(dof)) json = json//', '//json_text(trim(DOF_NAME(dof)))
      end do
      json = '['//json(min(3, len(json) + 1):)//']'
   end function directions

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
