!> `kjoint list`: the tables of joint types, deck keywords and output channels, as lines or JSON.
module kj_list
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_units, only: dimensions
   use kj_joint_types, only: joint_types, DOF_NAME, FRAME_CROSS
   use kj_keywords, only: keywords, status_name
   use kj_channels, only: channels
   use kj_json_writer, only: json_pair, json_text, json_list
   use kj_series, only: channel_path
   use kj_spelling, only: did_you_mean
   use kj_terminal, only: print_line
   implicit none
   private

   public :: print_table

   character(len=8), parameter :: TABLES(3) = ['joints  ', 'keywords', 'channels']
   character(len=*), parameter :: HEADING(3) = [character(len=90) :: &
      'type  name          nodes  free directions     blocked by Kn       frame', &
      'keyword               status       meaning, or what would be needed', &
      'channel                           size  dimension             Radioss       meaning']

   character(len=47), parameter :: CROSS = ' one axis of each body', &
      MEAN = ' mean of both skews, or the first (skew flag 1)'
   integer, parameter :: N_ROW(3) = [size(joint_types), size(keywords), size(channels)]

contains

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
            call add('keyword', trim(keywords(i)%name), 22)
            call add('status', trim(status_name(keywords(i)%status)), 13)
            call add('meaning', trim(keywords(i)%meaning), 1)
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
            call add('name', trim(t%name), len(t%name) + 2)
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
            call add('channel', channel_path(i), 34)
            call cell('size', str(c%n_comp), '  '//str(c%n_comp), 6)
            call add('dimension', trim(dimensions(c%dim)%name), 22)
            call add('class', trim(c%class), 0)
            call add('frame', trim(c%frame), 0)
            call add('radioss', trim(c%radioss), 14)
            call add('meaning', trim(c%meaning), 1)
         end associate
      end subroutine add_channel

      !> A text that is the same for people and in JSON
      subroutine add(key, text, width)
         character(len=*), intent(in) :: key, text
         integer, intent(in) :: width

         call cell(key, json_text(text), text, width)
      end subroutine add

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

end module kj_list
