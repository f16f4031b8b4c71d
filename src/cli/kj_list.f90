!> `kjoint list`: the tables of joint types, deck keywords and output channels.
module kj_list
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_units, only: dimensions
   use kj_joint_types, only: joint_types, DOF_NAME, NDOF, FRAME_CROSS
   use kj_keywords, only: keywords, status_name
   use kj_channels, only: channels, groups
   use kj_spelling, only: did_you_mean
   use kj_table_json, only: table_json
   use kj_words, only: buffer_t
   use kj_terminal, only: print_line
   implicit none
   private

   public :: print_table

   character(len=8), parameter :: TABLES(3) = ['joints  ', 'keywords', 'channels']

contains

   !> Print one table on stdout, as lines or as a JSON object
   !>
   !> Errors: ERR_INPUT when there is no table of this name
   subroutine print_table(name, as_json, error)
      character(len=*), intent(in) :: name
      logical, intent(in) :: as_json
      type(error_t), allocatable, intent(out) :: error

      type(buffer_t) :: b

      if (as_json .and. any(TABLES == name)) then
         call table_json(name, b)
         call print_line(b%s(:b%n))
         return
      end if
      select case (name)
      case ('joints')
         call print_joints()
      case ('keywords')
         call print_keywords()
      case ('channels')
         call print_channels()
      case default
         call fail(error, ERR_INPUT, 'there is no table "'//name//'"')
         error%hint = trim(did_you_mean(name, TABLES))
         if (len(error%hint) == 0) error%hint = 'joints, keywords or channels'
      end select
   end subroutine print_table

   subroutine print_joints()
      character(len=:), allocatable :: line, free
      integer :: i, dof

      call print_line( &
         'type  name          nodes  free directions     blocked by Kn       frame')
      do i = 1, size(joint_types)
         line = column('  '//str(joint_types(i)%id), 6)//joint_types(i)%name
         free = ''
         do dof = 1, NDOF
            if (joint_types(i)%free(dof) == 1) free = free//' '//DOF_NAME(dof)
         end do
         line = line//'  '//str(joint_types(i)%n_axis_node)//'   '//column(free, 20)
         free = ''
         do dof = 1, NDOF
            if (joint_types(i)%free(dof) == 0) free = free//' '//DOF_NAME(dof)
         end do
         line = line//column(free, 20)
         if (joint_types(i)%frame == FRAME_CROSS) then
            line = line//' one axis of each body'
         else
            line = line//' mean of both skews, or the first (skew flag 1)'
         end if
         call print_line(line)
      end do
   end subroutine print_joints

   subroutine print_keywords()
      integer :: i

      call print_line('keyword               status       meaning, or what would be needed')
      do i = 1, size(keywords)
         call print_line(column(keywords(i)%name, 22)// &
            column(status_name(keywords(i)%status), 13)//trim(keywords(i)%meaning))
      end do
   end subroutine print_keywords

   subroutine print_channels()
      integer :: i

      call print_line( &
         'channel                           size  dimension             Radioss       meaning')
      do i = 1, size(channels)
         call print_line(column(trim(groups(channels(i)%owner)%path)//'/'//channels(i)%name, 34)// &
                         column('  '//str(channels(i)%n_comp), 6)// &
                         column(dimensions(channels(i)%dim)%name, 22)// &
                         column(channels(i)%radioss, 14)//trim(channels(i)%meaning))
      end do
   end subroutine print_channels

   !> The text cut or filled to n characters
   pure function column(text, n)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      character(len=n) :: column

      column = text
   end function column

end module kj_list
