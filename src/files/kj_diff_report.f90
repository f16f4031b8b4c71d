!> The outcome of a comparison as text, JSON and JUnit XML.
module kj_diff_report
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use kj_kinds, only: wp
   use kj_error, only: str
   use kj_joint_types, only: NDOF, DOF_NAME
   use kj_channels, only: channels, CH_TIME
   use kj_metrics, only: metrics
   use kj_diff_types, only: diff_options_t, diff_result_t, channel_result_t
   use kj_words, only: buffer_t, add, left, counted, short, few, escaped, json_member, json_pair, &
      json_text, json_list, comma
   use kj_text, only: text_t
   implicit none
   private

   public :: diff_text, diff_json, diff_junit

   character(len=*), parameter :: NL = new_line('a')

contains

   !> Lines for people: the two files, a line a class, the worst ten, the metrics, the verdict
   subroutine diff_text(result, options, text)
      type(diff_result_t), intent(in) :: result
      type(diff_options_t), intent(in) :: options
      character(len=:), allocatable, intent(out) :: text

      type(buffer_t) :: b
      integer :: i

      call add(b, 'REF '//result%ref_path//', '//counted(result%n_ref, 'sample', 'samples')//NL)
      call add(b, 'RUN '//result%run_path//', '//counted(result%n_run, 'sample', 'samples')//NL)
      call add(b, 'profile '//trim(result%profile%name)//', '//tolerance_text(result, options)// &
         ', '//counted(result%n_sample, 'sample', 'samples')//' compared'//NL//NL)
      call add_classes(result, b)
      if (result%n_worst > 0) then
         call add(b, NL//'largest differences, of their tolerances'//NL)
         do i = 1, result%n_worst
            call add(b, '  '//worst_of(result, result%channel(result%worst(i)))//NL)
         end do
      end if
      if (any(options%metrics)) call add_metrics(result, options, b)
      call add_lists(result, b)
      call add(b, NL//verdict(result)//NL)
      text = b%s(:b%n)
   end subroutine diff_text

   !> A line a class: channels, how many differ, the largest difference in terms of its tolerance
   subroutine add_classes(result, b)
      type(diff_result_t), intent(in) :: result
      type(buffer_t), intent(inout) :: b

      character(len=48) :: line
      integer :: i

      call add(b, 'class             channels  different  of tolerance'//NL)
      do i = 1, size(result%class)
         associate (class => result%class(i))
            if (class%n_channel == 0) cycle
            write (line, '(a16,2x,i8,2x,i9,2x)') class%name, class%n_channel, class%n_different
            if (class%worst == 0) then
               call add(b, line(:39)//'0'//NL)
            else
               call add(b, line(:39)//multiple(result%channel(class%worst)%excess)//'  '// &
                  result%channel(class%worst)%title//NL)
            end if
         end associate
      end do
   end subroutine add_classes

   !> The lists of what has no part in the verdict, and the notes
   subroutine add_lists(result, b)
      type(diff_result_t), intent(in) :: result
      type(buffer_t), intent(inout) :: b

      integer :: i

      call add_names('no channel of ours', result%ignored, b)
      call add_names('in RUN alone', result%run_only, b)
      call add_channels('not a number on both sides, at times or always', result%channel, &
         result%channel%n_void > 0, b)
      call add_channels('of the steps of a run', result%channel, .not. result%channel%counted, b)
      do i = 1, size(result%note)
         call add(b, NL//'note: '//result%note(i)%s//NL)
      end do
   end subroutine add_lists

   !> "not compared, in RUN alone: a b c": at most 20 names
   subroutine add_names(why, list, b)
      character(len=*), intent(in) :: why
      type(text_t), intent(in) :: list(:)
      type(buffer_t), intent(inout) :: b

      integer, parameter :: MOST = 20
      integer :: i

      if (size(list) == 0) return
      call add(b, NL//'not compared, '//why//':')
      do i = 1, min(MOST, size(list))
         call add(b, ' '//list(i)%s)
      end do
      if (size(list) > MOST) call add(b, ' and '//str(size(list) - MOST)//' more')
      call add(b, NL)
   end subroutine add_names

   !> The same of some channels
   subroutine add_channels(why, channel, wanted, b)
      character(len=*), intent(in) :: why
      type(channel_result_t), intent(in) :: channel(:)
      logical, intent(in) :: wanted(:)
      type(buffer_t), intent(inout) :: b

      type(text_t), allocatable :: names(:)
      integer :: i, n

      allocate (names(count(wanted)))
      n = 0
      do i = 1, size(channel)
         if (.not. wanted(i)) cycle
         n = n + 1
         names(n)%s = channel(i)%title
      end do
      call add_names(why, names, b)
   end subroutine add_channels

   !> The rule as it was applied
   function tolerance_text(result, options) result(text)
      type(diff_result_t), intent(in) :: result
      type(diff_options_t), intent(in) :: options
      character(len=:), allocatable :: text

      text = 'equal bits'
      if (result%profile%bitwise) return
      text = short(result%profile%rtol, 2)//' of the peak'
      if (options%atol > 0.0_wp) text = text//' + '//short(options%atol, 2)
   end function tolerance_text

   !> "SAME: 84 channels", "DIFFERENT: 3 of 84 channels, worst ..." and what that leaves open
   function verdict(result) result(text)
      type(diff_result_t), intent(in) :: result
      character(len=:), allocatable :: text

      if (result%n_different == 0) then
         text = 'SAME: '//str(result%n_channel)//' channels'
         if (result%code /= 0) text = 'DIFFERENT (strict): '//str(result%n_channel)// &
            ' channels are the same'
      else
         text = 'DIFFERENT: '//str(result%n_different)//' of '//str(result%n_channel)// &
            ' channels, worst '//worst_of(result, result%channel(result%worst(1)))
      end if
      if (result%n_number == 0) then
         text = text//'; NO NUMBER BUT THE TIME IS COMPARED'
      else if (result%incomplete) then
         text = text//'; not all of REF is compared'
      else if (result%strict .and. size(result%run_only) > 0) then
         text = text//'; RUN has more than REF'
      end if
   end function verdict

   !> "joint/force[5].x 2.3e-3 > 1.0e-3 at t=12.4"
   function worst_of(result, channel) result(text)
      type(diff_result_t), intent(in) :: result
      type(channel_result_t), intent(in) :: channel
      character(len=:), allocatable :: text

      character(len=1), parameter :: AXIS(3) = ['x', 'y', 'z']
      character(len=:), allocatable :: a, b
      integer :: digits

      text = channel%title
      if (channel%run_at == 0) then
         text = text//' is missing in RUN'
      else if (channel%channel == CH_TIME .and. result%n_ref_alone + result%n_run_alone > 0) then
         text = text//': '//str(result%n_ref_alone)//' samples of REF and '// &
            str(result%n_run_alone)//' of RUN have no partner, the first at t='// &
            few(result%alone_at, 6)
      else
         if (channel%n_comp == 3) text = text//'.'//AXIS(min(max(channel%comp, 1), 3))
         if (ieee_is_nan(channel%difference)) then
            text = text//' is not a number on one side'
         else
            do digits = 2, 17
               a = short(channel%difference, digits)
               b = short(channel%allowed, digits)
               if (a /= b) exit
            end do
            if (channel%different) text = text//' '//a//' > '//b
            if (.not. channel%different) text = text//' '//a//' <= '//b
         end if
         text = text//' at t='//few(channel%time, 6)
      end if
   end function worst_of

   !> A line for each number of each channel: the metrics wanted
   subroutine add_metrics(result, options, b)
      type(diff_result_t), intent(in) :: result
      type(diff_options_t), intent(in) :: options
      type(buffer_t), intent(inout) :: b

      character(len=12) :: cell
      character(len=40) :: name
      integer :: i, j, k

      name = 'metrics'
      call add(b, NL//name)
      do k = 1, size(metrics)
         cell = adjustr(metrics(k)%column//'  ')
         if (options%metrics(k)) call add(b, cell)
      end do
      call add(b, NL)
      do i = 1, size(result%channel)
         if (result%channel(i)%run_at == 0 .or. result%channel(i)%channel == CH_TIME) cycle
         do j = 1, result%channel(i)%n_comp
            call add(b, left('  '//result%channel(i)%title// &
               component(result%channel(i)%n_comp, j), len(name)))
            do k = 1, size(metrics)
               if (.not. options%metrics(k)) cycle
               cell = '-'
               if (ieee_is_finite(result%channel(i)%metric(k, j))) &
                  write (cell, '(es11.3)') result%channel(i)%metric(k, j)
               cell = adjustr(cell)
               call add(b, cell)
            end do
            call add(b, NL)
         end do
      end do
   end subroutine add_metrics

   !> An object: verdict, tolerances, classes, every channel with its worst number and its metrics
   subroutine diff_json(result, text)
      type(diff_result_t), intent(in) :: result
      character(len=:), allocatable, intent(out) :: text

      type(buffer_t) :: b
      integer :: i

      call add(b, '{'//json_member('exit_code', result%code)//', '//json_member('verdict', &
         trim(merge('SAME     ', 'DIFFERENT', result%code == 0)))//', '// &
         json_member('summary', verdict(result))//','//NL)
      call add(b, ' '//json_member('ref', result%ref_path)//', '// &
         json_member('run', result%run_path)//','//NL)
      call add(b, ' '//json_member('profile', trim(result%profile%name))//', '// &
         json_member('rtol', result%profile%rtol)//', '// &
         json_member('bitwise', result%profile%bitwise)//','//NL)
      call add(b, ' '//json_member('samples_ref', result%n_ref)//', '// &
         json_member('samples_run', result%n_run)//', '// &
         json_member('samples_compared', result%n_sample)//','//NL)
      call add(b, ' '//json_member('samples_ref_alone', result%n_ref_alone)//', '// &
         json_member('samples_run_alone', result%n_run_alone)//','//NL)
      call add(b, ' '//json_member('channels', result%n_channel)//', '// &
         json_member('different', result%n_different)//', '// &
         json_member('numbers', real(result%n_number, wp))//', '// &
         json_member('complete', .not. result%incomplete .and. size(result%run_only) == 0)//','//NL)
      call add(b, ' "classes": ['//NL)
      do i = 1, size(result%class)
         call add(b, '  {'//json_member('name', trim(result%class(i)%name))//', '// &
            json_member('channels', result%class(i)%n_channel)//', '// &
            json_member('different', result%class(i)%n_different)// &
            '}'//comma(i, size(result%class))//NL)
      end do
      call add(b, ' ],'//NL//' "worst": [')
      do i = 1, result%n_worst
         call add(b, json_text(result%channel(result%worst(i))%name)//comma(i, result%n_worst))
      end do
      call add(b, '],'//NL//' "channel": ['//NL)
      do i = 1, size(result%channel)
         call add_channel_object(result%channel(i), b)
         call add(b, comma(i, size(result%channel))//NL)
      end do
      call add(b, ' ],'//NL//' "ignored": '//text_array(result%ignored)//','//NL// &
         ' "run_only": '//text_array(result%run_only)//','//NL// &
         ' "notes": '//text_array(result%note)//'}'//NL)
      text = b%s(:b%n)
   end subroutine diff_json

   !> A list of texts
   function text_array(list) result(json)
      type(text_t), intent(in) :: list(:)
      character(len=:), allocatable :: json

      integer :: i

      json = '['
      do i = 1, size(list)
         json = json//json_text(list(i)%s)//comma(i, size(list))
      end do
      json = json//']'
   end function text_array

   subroutine add_channel_object(channel, b)
      type(channel_result_t), intent(in) :: channel
      type(buffer_t), intent(inout) :: b

      integer :: k

      call add(b, '  {'//json_member('name', channel%name)//', '// &
         json_member('title', channel%title)//', '// &
         json_member('class', trim(channels(channel%channel)%class))//', '// &
         json_member('compared', channel%counted)//', '// &
         json_member('different', channel%different)//', '// &
         json_member('missing', channel%run_at == 0)//', '// &
         json_member('peak', channel%peak)//', '// &
         json_member('difference', channel%difference)//', '// &
         json_member('tolerance', channel%allowed)//', '// &
         json_member('time', channel%time)//', '//json_member('component', channel%comp)//', '// &
         json_member('beyond', channel%n_beyond)//', '// &
         json_member('numbers', real(channel%n_number, wp))//', '// &
         json_member('not_numbers', real(channel%n_void, wp)))
      if (allocated(channel%metric)) then
         call add(b, ', "metrics": {')
         do k = 1, size(metrics)
            call add(b, json_pair(trim(metrics(k)%column), &
               json_list(channel%metric(k, :channel%n_comp)))//comma(k, size(metrics)))
         end do
         call add(b, '}')
      end if
      call add(b, '}')
   end subroutine add_channel_object

   !> A test suite with a test case a channel
   subroutine diff_junit(result, text)
      type(diff_result_t), intent(in) :: result
      character(len=:), allocatable, intent(out) :: text

      type(buffer_t) :: b
      integer :: i

      call add(b, '<?xml version="1.0" encoding="UTF-8"?>'//NL//'<testsuite name="kjoint diff '// &
         escaped(result%ref_path)//' '//escaped(result%run_path)//'" tests="'// &
         str(result%n_channel)//'" failures="'//str(result%n_different)//'">'//NL)
      do i = 1, size(result%channel)
         associate (c => result%channel(i))
            if (.not. c%counted) cycle
            call add(b, '  <testcase classname="'//trim(channels(c%channel)%class)//'" name="'// &
               escaped(c%name)//'"')
            if (c%different) then
               call add(b, '><failure message="'//escaped(worst_of(result, c))// &
                  '"/></testcase>'//NL)
            else
               call add(b, '/>'//NL)
            end if
         end associate
      end do
      call add(b, '</testsuite>'//NL)
      text = b%s(:b%n)
   end subroutine diff_junit

   ! ---- pieces of text

   !> A difference in terms of its tolerance
   function multiple(excess) result(text)
      real(wp), intent(in) :: excess
      character(len=:), allocatable :: text

      text = short(excess, 2)
      if (excess >= huge(1.0_wp)) text = 'any'
   end function multiple

   !> ".x" of a vector, ".w" of a quaternion, ".tx" of a state, nothing of a scalar
   pure function component(n_comp, k) result(text)
      integer, intent(in) :: n_comp, k
      character(len=:), allocatable :: text

      character(len=4), parameter :: LETTERS(4) = ['    ', '    ', 'xyz ', 'wxyz']

      text = ''
      if (n_comp >= 3 .and. n_comp <= 4) text = '.'//LETTERS(n_comp)(k:k)
      if (n_comp == NDOF) text = '.'//DOF_NAME(k)
   end function component

end module kj_diff_report
