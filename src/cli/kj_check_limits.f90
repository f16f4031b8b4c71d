!> Stops, friction and locks of the joints in what `kjoint check` prints.
module kj_check_limits
   use kj_kinds, only: wp
   use kj_error, only: str
   use kj_text, only: text_t
   use kj_joint_types, only: DOF_NAME
   use kj_terminal, only: print_line
   use kj_words, only: left
   use kj_json_writer, only: json_member, json_pair, json_real
   use kjoint, only: check_t, limit_row_t
   implicit none
   private

   public :: print_limits, limits_json, title_width, title_cell

contains

   !> The table of limits, and the locks; nothing where there are none
   subroutine print_limits(report)
      type(check_t), intent(in) :: report

      integer :: i, j, n

      n = title_width(report%joint_title)
      if (size(report%limit) > 0) then
         call print_line('')
         call print_line(title_cell('joint', n)// &
            'direction  stops                       stiffness'// &
            '    friction           stiffness')
      end if
      do i = 1, size(report%limit)
         associate (row => report%limit(i))
            call print_line(title_cell(report%joint_title(row%joint)%s, n)// &
               left(DOF_NAME(row%dof), 11)// &
               left(stops_text(row), 28)//left(stiffness_text(row), 13)// &
               left(friction_text(row), 19)//number(row%slip_k))
         end associate
      end do
      if (any(report%limit%combined)) call print_line('   *  combined: one circle or sphere')
      do j = 1, size(report%joint)
         if (report%t_lock(j) >= huge(1.0_wp)) cycle
         if (report%t_free(j) < huge(1.0_wp)) then
            call print_line(title_cell(report%joint_title(j)%s, n)// &
               'locked from '//number(report%t_lock(j))// &
               ' to '//number(report%t_free(j)))
         else
            call print_line(title_cell(report%joint_title(j)%s, n)// &
               'locked from '//number(report%t_lock(j)))
         end if
      end do
   end subroutine print_limits

   !> Of the column of titles in a table: longer ones go beyond it
   pure integer function title_width(title) result(n)
      type(text_t), intent(in) :: title(:)

      integer, parameter :: LEAST = 6, MOST = 32
      integer :: i

      n = LEAST
      do i = 1, size(title)
         n = min(MOST, max(n, len(title(i)%s)))
      end do
   end function title_width

   !> A title in its column of n letters, with what stands around it
   pure function title_cell(title, n) result(cell)
      character(len=*), intent(in) :: title
      integer, intent(in) :: n
      character(len=max(n, len(title)) + 5) :: cell

      cell = '   '//title
   end function title_cell

   !> '-1.4000E+00 to 1.0000E+00 *'; a side without a stop is '-'
   pure function stops_text(row) result(text)
      type(limit_row_t), intent(in) :: row
      character(len=:), allocatable :: text

      text = '-'
      if (.not. (row%lo < 0.0_wp .or. row%hi > 0.0_wp)) return
      text = number(row%lo)//' to '//number(row%hi)
      if (row%combined) text = text//' *'
   end function stops_text

   !> Stiffness of the stops
   pure function stiffness_text(row) result(text)
      type(limit_row_t), intent(in) :: row
      character(len=:), allocatable :: text

      text = '-'
      if (.not. (row%lo < 0.0_wp .or. row%hi > 0.0_wp)) return
      text = number(row%stop_k)
      if (.not. row%stop_k > 0.0_wp) text = 'automatic'
   end function stiffness_text

   !> '4.0000E+00', '1.0000E+00 * f 7' or '-'
   pure function friction_text(row) result(text)
      type(limit_row_t), intent(in) :: row
      character(len=:), allocatable :: text

      text = number(row%slip)
      if (row%slip_curve > 0) text = text//' * f '//str(row%slip_curve)
   end function friction_text

   !> '-' for 0
   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text

      character(len=11) :: buffer

      text = '-'
      if (.not. abs(value) > 0.0_wp) return
      write (buffer, '(es11.4)') value
      text = trim(adjustl(buffer))
   end function number

   !> Members of the JSON object of joint j: its limits and when it is locked; null: none, never
   function limits_json(report, j) result(json)
      type(check_t), intent(in) :: report
      integer, intent(in) :: j
      character(len=:), allocatable :: json

      character(len=:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(report%limit)
         if (report%limit(i)%joint /= j) cycle
         if (len(list) > 0) list = list//', '
         list = list//row_json(report%limit(i))
      end do
      json = json_pair('limits', '['//list//']')// &
         ', '//json_pair('locked_from', json_or_null(report%t_lock(j), huge(1.0_wp)))// &
         ', '//json_pair('locked_to', json_or_null(report%t_free(j), huge(1.0_wp)))
   end function limits_json

   function row_json(row) result(json)
      type(limit_row_t), intent(in) :: row
      character(len=:), allocatable :: json

      json = '{'//json_member('direction', trim(DOF_NAME(row%dof)))// &
         ', '//json_pair('lower_stop', json_or_null(row%lo, 0.0_wp))// &
         ', '//json_pair('upper_stop', json_or_null(row%hi, 0.0_wp))// &
         ', '//json_member('combined', row%combined)// &
         ', '//json_pair('stop_stiffness', json_or_null(row%stop_k, 0.0_wp))// &
         ', '//json_pair('friction', json_or_null(row%slip, 0.0_wp))// &
         ', '//json_member('friction_function', row%slip_curve)// &
         ', '//json_pair('friction_stiffness', json_or_null(row%slip_k, 0.0_wp))//'}'
   end function row_json

   !> null for the value that stands for none
   function json_or_null(value, none) result(json)
      real(wp), intent(in) :: value, none
      character(len=:), allocatable :: json

      json = 'null'
      if (abs(value - none) > 0.0_wp) json = json_real(value)
   end function json_or_null

end module kj_check_limits
