!> What `kjoint check` says of a scene, as lines or as JSON.
!> One file: one report, as lines and as JSON
module kj_check_report
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str
   use kj_joint_types, only: joint_types, FRAME_MEAN, FRAME_FIRST, FRAME_SECOND, FRAME_FIXED, &
      FRAME_APART, FRAME_LINE, DOF_NAME
   use kj_joint_batch, only: KJOINT2, SPRING4, SPRING8, SPRING13
   use kj_terminal, only: print_line
   use kj_words, only: left, right, counted, few, json_member, json_pair, json_real, json_list, &
      json_findings, comma
   use kj_progress, only: span_text
   use kjoint, only: simulation_t, check_t, simulation_title, limit_row_t
   use kj_text, only: text_t
   implicit none
   private

   public :: print_report, print_json

contains

   !> Counts, joints, stops, bodies, time steps, length of a run
   subroutine print_report(sim, report, findings)
      type(simulation_t), intent(in) :: sim
      type(check_t), intent(in) :: report
      type(finding_list_t), intent(in) :: findings

      call print_line(trim(simulation_title(sim)))
      call print_line('   '//counted(size(report%joint) - report%n_spring, 'joint', 'joints')// &
         ', '//springs_text(report%n_spring)// &
         counted(size(report%body_id), 'rigid body', 'rigid bodies')//', '// &
         counted(report%n_node, 'node', 'nodes')//' ('// &
         str(report%n_free)//' free), '//counted(report%n_curve, 'function', 'functions')//', '// &
         counted(report%n_load, 'load', 'loads'))
      if (size(report%joint) > 0) call print_joints(report)
      if (size(report%body_id) > 0) call print_bodies(report)
      call print_line('')
      call print_line('critical time step (a run takes '//fixed(report%factor, 3)//' of it)')
      call print_line('   nodal rule  '//trim(step_text(report%nodal_step)))
      if (report%safe_joint > 0) then
         call print_line('   safe        '//step_text(report%safe_step)//'  '// &
            report%joint_title(report%safe_joint)%s)
      else
         call print_line('   safe        '//trim(step_text(report%safe_step)))
      end if
      if (size(report%island_step) > 1) call print_line('   islands     '// &
         str(size(report%island_step))//', safe from '// &
         trim(step_text(minval(report%island_step)))//' to '// &
         trim(step_text(maxval(report%island_step)))//'  (each its own by --islands)')
      if (report%exact_step > 0.0_wp) then
         call print_line('   exact       '//trim(step_text(report%exact_step)))
      else
         call print_line('   exact       not computed: the scene is too large')
      end if
      call print_compliant(report)
      if (report%seconds > 0.0_wp) then
         call print_line('')
         call print_line('run: about '//few(report%cycles, 3)//' cycles, '// &
            few(report%samples, 3)//' samples of '//str(report%values)//' numbers; '// &
            span_text(report%seconds)//' at the pace of the first cycles')
      end if
      call print_line('')
      call print_line('findings: '//counted(findings%n_error, 'error', 'errors')//', '// &
         counted(findings%n_warning, 'warning', 'warnings'))
   end subroutine print_report

   !> What --integrator compliant would make of the scene
   subroutine print_compliant(report)
      type(check_t), intent(in) :: report

      character(len=:), allocatable :: turn
      real(wp) :: h, interval

      call print_line('step of --integrator compliant (error, stops may ask for less)')
      h = report%turn_step                       ! of a scene at rest it is beyond the end
      if (h > report%t_stop) h = huge(h)
      turn = '  (0.1 rad of a body)'
      if (report%n_solve > 1) turn = '  (0.45 rad of a body; '//str(report%n_solve)// &
         ' cycles make a step)'
      call print_line('   turn        '//trim(step_text(h))//turn)
      call print_line('   springs     '//trim(step_text(report%spring_step)))
      h = min(h, report%spring_step)
      if (report%samples < report%cycles) then
         interval = report%t_stop/(report%samples - 1.0_wp)
         call print_line('   samples     '//trim(step_text(interval)))
         h = min(h, interval)
      end if
      if (h < 0.5_wp*huge(h) .and. report%stiffest > 0.0_wp) call print_line( &
         '   stiffness   w h = '//trim(number(report%stiffest*h))// &
         ' of the stiffest blocked direction')
      if (report%n_redundant > 0) call print_line('   redundant   '// &
         counted(report%n_redundant, 'blocked direction', 'blocked directions')// &
         ': Kn shares the forces among them')
   end subroutine print_compliant

   !> "3 springs, ", nothing where there is none
   pure function springs_text(n) result(text)
      integer, intent(in) :: n
      character(len=:), allocatable :: text

      text = ''
      if (n > 0) text = counted(n, 'spring', 'springs')//', '
   end function springs_text

   subroutine print_joints(report)
      type(check_t), intent(in) :: report

      character(len=:), allocatable :: line
      integer :: j, n

      n = title_width(report%joint_title)
      call print_line('')
      call print_line(title_cell('joint', n)//'type            bodies              frame       '// &
         'length       blocking k   (rotation)   damping  critical dt')
      do j = 1, size(report%joint)
         line = title_cell(report%joint_title(j)%s, n)//type_text(report, j)//'  '// &
            left(body_text(report%body(:, j)), 18)//'  '//frame_text(report%frame(j))//'  '
         line = line//number(report%length(j))//'  '//blocking_text(report, j, 1)//'  '// &
            blocking_text(report, j, 2)//'  '//right(fixed(report%ratio(j), 3), 7)//'  '// &
            step_text(report%step(j))
         call print_line(trim(line))
      end do
      call print_line('   blocking k of rotations: moment per rad; damping: largest ratio '// &
         'c/(2 sqrt(k m)) of all directions')
      call print_limits(report)
   end subroutine print_joints

   subroutine print_bodies(report)
      type(check_t), intent(in) :: report

      integer :: b, n

      n = title_width(report%body_title)
      call print_line('')
      call print_line(title_cell('body', n)// &
         'mass         principal inertia                      '// &
         'centre of gravity                      joints  held     driven')
      do b = 1, size(report%body_id)
         call print_line(title_cell(report%body_title(b)%s, n)//number(report%mass(b))//'  '// &
            three(report%inertia(:, b))//'  '//three(report%centre(:, b))//'  '// &
            right(str(report%n_joint(b)), 6)//'  '//left(held_text(report%held(:, b)), 7)//'  '// &
            str(report%n_driven(b)))
      end do
   end subroutine print_bodies

   !> 'revolute', with a 2 behind that of a KJOINT2; springs by their property
   pure function type_text(report, j) result(text)
      type(check_t), intent(in) :: report
      integer, intent(in) :: j
      character(len=14) :: text

      text = joint_types(report%row(j))%name
      if (report%kind(j) == KJOINT2) text = trim(text)//'2'
      if (report%kind(j) == SPRING4) text = 'spring, type 4'
      if (report%kind(j) == SPRING8) text = 'spring, type 8'
      if (report%kind(j) == SPRING13) text = 'spring type 13'
   end function type_text

   pure function body_text(body) result(text)
      integer, intent(in) :: body(2)
      character(len=:), allocatable :: text

      character(len=:), allocatable :: one(:)

      allocate (character(len=12) :: one(2))
      one = 'node'
      if (body(1) > 0) one(1) = str(body(1))
      if (body(2) > 0) one(2) = str(body(2))
      text = trim(one(1))//' - '//trim(one(2))
   end function body_text

   !> How the joint frame turns
   pure function frame_text(frame) result(text)
      integer, intent(in) :: frame                  !! FRAME_ constant
      character(len=10) :: text

      text = 'cross'
      if (frame == FRAME_MEAN) text = 'mean'
      if (frame == FRAME_FIRST) text = 'first skew'
      if (frame == FRAME_SECOND) text = 'skew end 2'
      if (frame == FRAME_FIXED) text = 'fixed'
      if (frame == FRAME_APART) text = 'skew apart'
      if (frame == FRAME_LINE) text = 'line'
   end function frame_text

   !> Stiffness of the blocked translations (1) or rotations (2)
   function blocking_text(report, j, which) result(text)
      type(check_t), intent(in) :: report
      integer, intent(in) :: j, which
      character(len=11) :: text

      text = '-'
      if (report%blocking(which, j) > 0.0_wp) text = number(report%blocking(which, j))
      if (report%automatic(j)) text = 'automatic'
   end function blocking_text

   !> 'xyz xyz': held translations and rotations, '-' where free
   pure function held_text(held) result(text)
      logical, intent(in) :: held(6)
      character(len=7) :: text

      integer :: i

      text = '--- ---'
      do i = 1, 3
         if (held(i)) text(i:i) = 'xyz'(i:i)
         if (held(i + 3)) text(i + 4:i + 4) = 'xyz'(i:i)
      end do
   end function held_text

   function step_text(step) result(text)
      real(wp), intent(in) :: step
      character(len=11) :: text

      text = 'no limit'
      if (step < 0.5_wp*huge(step)) text = number(step)
   end function step_text

   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(len=11) :: text

      write (text, '(es11.4)') value
      text = adjustl(text)
   end function number

   pure function three(value) result(text)
      real(wp), intent(in) :: value(3)
      character(len=37) :: text

      text = number(value(1))//'  '//number(value(2))//'  '//number(value(3))
   end function three

   pure function fixed(value, digits) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(len=:), allocatable :: text

      character(len=24) :: buffer, form

      if (abs(value) >= 1.0e4_wp) then
         write (buffer, '(es9.2)') value
      else
         write (form, '(a,i0,a)') '(f12.', digits, ')'
         write (buffer, form) value
      end if
      text = trim(adjustl(buffer))
   end function fixed

   !> The same as an object; where the deck was refused its findings alone
   subroutine print_json(deck, sim, report, well, code, findings)
      character(len=*), intent(in) :: deck           !! path
      type(simulation_t), intent(in) :: sim
      type(check_t), intent(in) :: report
      logical, intent(in) :: well
      integer, intent(in) :: code
      type(finding_list_t), intent(in) :: findings

      integer :: i, safe

      call print_line('{'//json_member('exit_code', code)//', '//json_member('deck', deck))
      if (well) then
         safe = 0
         if (report%safe_joint > 0) safe = report%joint(report%safe_joint)
         call print_line(', '//json_member('title', trim(simulation_title(sim)))// &
            ', '//json_member('nodes', report%n_node)// &
            ', '//json_member('free_nodes', report%n_free)// &
            ', '//json_member('functions', report%n_curve)// &
            ', '//json_pair('nodal_step', json_step(report%nodal_step))// &
            ', '//json_pair('safe_step', json_step(report%safe_step))// &
            ', '//json_member('safe_joint', safe)// &
            ', '//json_pair('island_steps', '['//steps_json(report%island_step)//']')// &
            ', '//json_pair('exact_step', json_step(report%exact_step))// &
            ', '//json_pair('turn_step', json_step(report%turn_step))// &
            ', '//json_member('cycles_per_step', report%n_solve)// &
            ', '//json_pair('spring_step', json_step(report%spring_step))// &
            ', '//json_pair('stiffest_frequency', json_real(report%stiffest))// &
            ', '//json_member('redundant', report%n_redundant)// &
            ', '//json_member('factor', report%factor)// &
            ', '//json_member('cycles', report%cycles)// &
            ', '//json_member('samples', report%samples)// &
            ', '//json_member('seconds', report%seconds))
         call print_line(', "joints": [')
         do i = 1, size(report%joint)
            call print_line(joint_json(report, i)//trim(comma(i, size(report%joint))))
         end do
         call print_line('], "bodies": [')
         do i = 1, size(report%body_id)
            call print_line(body_json(report, i)//trim(comma(i, size(report%body_id))))
         end do
         call print_line(']')
      end if
      call print_line(', '//json_findings(findings)//'}')
   end subroutine print_json

   function joint_json(report, j) result(json)
      type(check_t), intent(in) :: report
      integer, intent(in) :: j
      character(len=:), allocatable :: json

      json = '{'//json_member('id', report%joint(j))// &
         ', '//json_member('name', report%joint_title(j)%s)// &
         ', '//json_member('type', trim(type_text(report, j)))// &
         ', '//json_member('property', report%property(j))// &
         ', '//json_pair('nodes', json_list(report%node(:, j)))// &
         ', '//json_pair('bodies', json_list(report%body(:, j)))// &
         ', '//json_member('frame', trim(frame_text(report%frame(j))))// &
         ', '//json_member('length', report%length(j))// &
         ', '//json_member('blocking_translation', report%blocking(1, j))// &
         ', '//json_member('blocking_rotation', report%blocking(2, j))// &
         ', '//json_member('damping_ratio', report%ratio(j))// &
         ', '//json_pair('critical_step', json_step(report%step(j)))// &
         ', '//limits_json(report, j)//'}'
   end function joint_json

   function body_json(report, b) result(json)
      type(check_t), intent(in) :: report
      integer, intent(in) :: b
      character(len=:), allocatable :: json

      json = '{'//json_member('id', report%body_id(b))// &
         ', '//json_member('name', report%body_title(b)%s)// &
         ', '//json_member('mass', report%mass(b))// &
         ', '//json_pair('inertia', json_list(report%inertia(:, b)))// &
         ', '//json_pair('centre', json_list(report%centre(:, b)))// &
         ', '//json_member('secondary_nodes', report%n_secondary(b))// &
         ', '//json_member('joints', report%n_joint(b))// &
         ', '//json_member('held', held_text(report%held(:, b)))// &
         ', '//json_member('driven', report%n_driven(b))//'}'
   end function body_json

   !> null where nothing limits the step
   function json_step(step) result(json)
      real(wp), intent(in) :: step
      character(len=:), allocatable :: json

      json = 'null'
      if (step < 0.5_wp*huge(step)) json = json_real(step)
   end function json_step

   !> Steps with commas between them
   function steps_json(steps) result(json)
      real(wp), intent(in) :: steps(:)
      character(len=:), allocatable :: json

      integer :: i

      json = ''
      do i = 1, size(steps)
         json = json//json_step(steps(i))//comma(i, size(steps))
      end do
   end function steps_json

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
               left(friction_text(row), 19)//amount(row%slip_k))
         end associate
      end do
      if (any(report%limit%combined)) call print_line('   *  combined: one circle or sphere')
      do j = 1, size(report%joint)
         if (report%t_lock(j) >= huge(1.0_wp)) cycle
         if (report%t_free(j) < huge(1.0_wp)) then
            call print_line(title_cell(report%joint_title(j)%s, n)// &
               'locked from '//amount(report%t_lock(j))// &
               ' to '//amount(report%t_free(j)))
         else
            call print_line(title_cell(report%joint_title(j)%s, n)// &
               'locked from '//amount(report%t_lock(j)))
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
      text = amount(row%lo)//' to '//amount(row%hi)
      if (row%combined) text = text//' *'
   end function stops_text

   !> Stiffness of the stops
   pure function stiffness_text(row) result(text)
      type(limit_row_t), intent(in) :: row
      character(len=:), allocatable :: text

      text = '-'
      if (.not. (row%lo < 0.0_wp .or. row%hi > 0.0_wp)) return
      text = amount(row%stop_k)
      if (.not. row%stop_k > 0.0_wp) text = 'automatic'
   end function stiffness_text

   !> '4.0000E+00', '1.0000E+00 * f 7' or '-'
   pure function friction_text(row) result(text)
      type(limit_row_t), intent(in) :: row
      character(len=:), allocatable :: text

      text = amount(row%slip)
      if (row%slip_curve > 0) text = text//' * f '//str(row%slip_curve)
   end function friction_text

   !> '-' for 0
   pure function amount(value) result(text)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text

      character(len=11) :: buffer

      text = '-'
      if (.not. abs(value) > 0.0_wp) return
      write (buffer, '(es11.4)') value
      text = trim(adjustl(buffer))
   end function amount

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

end module kj_check_report
