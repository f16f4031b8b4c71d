!> `kjoint extract`: the mechanism of a full deck, as a deck of its own, and what became of the
!> rest.
module kj_extract_command
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, add_finding, fail, str, ERR_RUN
   use kj_option, only: arguments_t, stem_of, OPT_OUTPUT, OPT_QUIET, OPT_JSON
   use kj_run_arguments, only: take_run_options, exit_code
   use kj_terminal, only: print_line
   use kj_output, only: write_output
   use kj_render, only: print_findings, print_failure
   use kj_words, only: counted, few, right, json_member, json_pair, json_list, json_findings, comma
   use kjoint, only: run_options_t, extract_report_t, extract_mechanism
   implicit none
   private

   public :: extract_command

contains

   !> Extract as the arguments say; everything that is to be said has been said on return
   subroutine extract_command(args, code)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code                   !! exit code

      type(run_options_t) :: options
      type(extract_report_t) :: report
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error
      character(len=:), allocatable :: path, engine
      logical :: well

      engine = ''
      if (args%n_operand == 2) engine = args%operand(2)%s
      path = stem_of(args%operand(1)%s)//'_mech_0000.rad'
      if (args%given(OPT_OUTPUT)) path = args%value(OPT_OUTPUT)%s
      call take_run_options(args, options, error)
      if (.not. allocated(error)) call extract_mechanism(args%operand(1)%s, engine, options, &
         report, findings)
      well = .not. allocated(error) .and. findings%n_error == 0
      if (well) then
         if (size(report%body_id) + report%n_joint + report%n_spring == 0) call fail(error, &
            ERR_RUN, 'nothing is left: the deck has no rigid body, joint or spring')
         if (.not. allocated(error)) call write_output(path, report%text, report%input, error)
         if (.not. allocated(error) .and. len(report%engine) > 0) call write_output( &
            engine_path(path), '#RADIOSS ENGINE'//new_line('a')//report%engine, report%input, error)
         well = .not. allocated(error)
      end if
      code = exit_code(findings, error)
      if (args%given(OPT_JSON)) then
         if (allocated(error)) call add_finding(findings, error)
         call print_json(merge(path, repeat(' ', len(path)), well), report, code, findings)
         return
      end if
      call print_findings(args, findings)
      call print_failure(error)
      if (well .and. .not. args%given(OPT_QUIET)) call print_report(args%operand(1)%s, path, report)
   end subroutine extract_command

   !> MECH_0000.rad -> MECH_0001.rad
   pure function engine_path(path) result(engine)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: engine

      integer :: cut

      cut = index(path, '_0000.rad', back=.true.)
      if (cut > 0) then
         engine = path(:cut)//'0001.rad'
      else
         engine = path//'_0001.rad'
      end if
   end function engine_path

   !> "107.392 kg"
   function mass_text(mass, report) result(text)
      real(wp), intent(in) :: mass
      type(extract_report_t), intent(in) :: report
      character(len=:), allocatable :: text

      text = few(mass, 6)//' '//trim(report%symbol(1))
   end function mass_text

   subroutine print_report(starter, path, report)
      character(len=*), intent(in) :: starter, path
      type(extract_report_t), intent(in) :: report

      character(len=:), allocatable :: line
      integer :: i

      call print_line('extract '//starter//' -> '//path)
      call print_line('kept      '//counted(size(report%body_id), 'rigid body', 'rigid bodies')// &
         ' ('//mass_text(report%in_bodies, report)//'), '// &
         counted(report%n_joint, 'joint', 'joints')//', '// &
         counted(report%n_spring, 'spring', 'springs')//', '// &
         counted(report%n_skew, 'moving axis system', 'moving axis systems')//', '// &
         counted(report%n_load, 'load', 'loads')//', '// &
         counted(report%n_gravity, 'gravity', 'gravities')//', '// &
         counted(report%n_free, 'free node', 'free nodes'))
      call print_line('mass      '//mass_text(report%in_bodies, report)//' of '// &
         mass_text(report%total, report)//' sits in the bodies, '// &
         mass_text(report%on_free, report)//' on free nodes; '// &
         mass_text(max(0.0_wp, report%total - report%in_bodies - report%on_free), report)// &
         ' of deformable parts and other nodes is dropped')
      do i = 1, size(report%lost)
         call print_line('          part '//str(report%lost(i)%id)//', '//report%lost(i)%title%s// &
            ': '//mass_text(report%lost(i)%mass, report))
      end do
      call print_bodies(report)
      call print_links(report)
      line = list_text(report)
      call print_line('dropped   '//line)
      call print_means(report)
   end subroutine print_report

   !> Each body: its mass and where it comes from, centre, principal inertia
   subroutine print_bodies(report)
      type(extract_report_t), intent(in) :: report

      integer :: b

      call print_line('')
      call print_line('      body  main node   mass         of elements  added        '// &
         'of the card  centre; principal inertia')
      do b = 1, size(report%body_id)
         call print_line(right(str(report%body_id(b)), 10)//right(str(report%main(b)), 11)// &
            '   '//column(report%mass(b))//column(report%from_elements(b))// &
            column(report%from_masses(b))//column(report%from_card(b))// &
            three(report%centre(:, b))//'; '//three(report%principal(:, b)))
      end do
      call print_line('')
   end subroutine print_bodies

   !> Three numbers; what is rounding beside the largest is 0
   function three(x) result(text)
      real(wp), intent(in) :: x(3)
      character(len=:), allocatable :: text

      real(wp) :: y(3)

      y = merge(x, 0.0_wp, abs(x) > 1.0e-15_wp*maxval(abs(x)))
      text = few(y(1), 5)//' '//few(y(2), 5)//' '//few(y(3), 5)
   end function three

   function column(value) result(text)
      real(wp), intent(in) :: value
      character(len=13) :: text

      text = few(value, 6)
   end function column

   !> The groups of bodies that joints and springs hold together
   subroutine print_links(report)
      type(extract_report_t), intent(in) :: report

      character(len=:), allocatable :: line
      integer :: g, b

      if (report%n_group == 1) then
         call print_line('links     '//counted(size(report%body_id), 'body hangs', &
            'bodies hang')// &
            ' together in 1 group')
      else
         call print_line('links     '//str(size(report%body_id))//' bodies in '// &
            counted(report%n_group, 'group', 'groups')//' that nothing holds together:')
         do g = 1, min(report%n_group, 12)
            line = ''
            do b = 1, size(report%body_id)
               if (report%group(b) == g .and. len(line) < 80) line = line//' '// &
                  str(report%body_id(b))
            end do
            call print_line('          '//line(2:))
         end do
      end if
      do b = 1, size(report%bridge)
         associate (p => report%bridge(b))
            if (p%alone) call print_line('          only part '//str(p%part)//' ('//p%title%s// &
               ', '//counted(p%n, 'element', 'elements')//') holds bodies '//str(p%body(1))// &
               ' and '//str(p%body(2))//' together: a joint or spring in its place would')
         end associate
      end do
   end subroutine print_links

   !> "4841 shells, 203 triangles, 3 /MAT"
   function list_text(report) result(line)
      type(extract_report_t), intent(in) :: report
      character(len=:), allocatable :: line

      integer :: i

      line = ''
      do i = 1, size(report%elements)
         line = line//', '//str(report%elements(i)%n)//' '//trim(report%elements(i)%name)
      end do
      if (report%n_spanning > 0) line = line//' ('//str(report%n_spanning)// &
         ' touch a body and something else)'
      do i = 1, size(report%others)
         line = line//', '//str(report%others(i)%n)//' '//trim(report%others(i)%name)
      end do
      if (len(line) == 0) line = '  nothing'
      line = line(3:)
   end function list_text

   !> What the mechanism lacks beside the full deck
   subroutine print_means(report)
      type(extract_report_t), intent(in) :: report

      character(len=:), allocatable :: bodies
      integer :: i, n

      do i = 1, size(report%acts)
         associate (a => report%acts(i))
            call print_line('means     '//str(a%n)//' '//trim(a%name)//': '//a%what%s// &
               bodies_text(a%body))
         end associate
      end do
      do i = 1, size(report%bridge)
         associate (p => report%bridge(i))
            if (p%void) cycle
            bodies = 'body '//str(p%body(1))
            if (p%body(2) > 0) bodies = 'bodies '//str(p%body(1))//' and '//str(p%body(2))
            call print_line('means     part '//str(p%part)//' ('//p%title%s//') pulls at '// &
               bodies//' in the full deck: '//counted(p%n, 'element', 'elements'))
         end associate
      end do
      n = sum(report%bridge%n, report%bridge%void)
      if (n > 0) call print_line('          '//counted(n, 'element', 'elements')// &
         ' of /MAT/VOID between bodies carry no force in the full deck either')
   end subroutine print_means

   pure function bodies_text(body) result(text)
      integer, intent(in) :: body(:)
      character(len=:), allocatable :: text

      integer :: i

      text = ''
      if (size(body) == 0) return
      text = '; bodies'
      do i = 1, min(8, size(body))
         text = text//' '//str(body(i))
      end do
      if (size(body) > 8) text = text//' and '//str(size(body) - 8)//' more'
   end function bodies_text

   subroutine print_json(path, report, code, findings)
      character(len=*), intent(in) :: path
      type(extract_report_t), intent(in) :: report
      integer, intent(in) :: code
      type(finding_list_t), intent(in) :: findings

      integer :: i

      call print_line('{'//json_member('exit_code', code))
      if (allocated(report%acts)) then     ! weighed, even if it cannot be written
         call print_line(', '//json_member('deck', trim(path))//', '//json_pair('units', &
            json_list(report%symbol)))
         call print_line(', "kept": {'//json_member('bodies', size(report%body_id))//', '// &
            json_member('joints', report%n_joint)//', '//json_member('springs', report%n_spring)// &
            ', '//json_member('moving_axes', report%n_skew)//', '// &
            json_member('loads', report%n_load)//', '//json_member('gravity', report%n_gravity)// &
            ', '//json_member('free_nodes', report%n_free)//'}')
         call print_line(', "mass": {'//json_member('total', report%total)//', '// &
            json_member('in_bodies', report%in_bodies)//', '// &
            json_member('on_free_nodes', report%on_free)//'}')
         call print_line(', '//json_member('groups', report%n_group)//', "bodies": [')
         do i = 1, size(report%body_id)
            call print_line(json_body(report, i)//comma(i, size(report%body_id)))
         end do
         call print_line('], "dropped": {')
         do i = 1, size(report%elements)
            call print_line(json_member(trim(report%elements(i)%name), report%elements(i)%n)// &
               comma(i, size(report%elements) + size(report%others)))
         end do
         do i = 1, size(report%others)
            call print_line(json_member(trim(report%others(i)%name), report%others(i)%n)// &
               comma(i, size(report%others)))
         end do
         call print_line('}, '//json_member('spanning_elements', report%n_spanning)// &
            ', "bridges": [')
         do i = 1, size(report%bridge)
            associate (p => report%bridge(i))
               call print_line('{'//json_member('part', p%part)//', '// &
                  json_member('title', p%title%s)//', '//json_member('elements', p%n)//', '// &
                  json_member('void', p%void)//', '//json_member('alone', p%alone)//', '// &
                  json_pair('bodies', json_list(p%body))//'}'// &
                  comma(i, size(report%bridge)))
            end associate
         end do
         call print_line('], "acts": [')
         do i = 1, size(report%acts)
            associate (a => report%acts(i))
               call print_line('{'//json_member('keyword', trim(a%name))//', '// &
                  json_member('what', a%what%s)//', '//json_member('n', &
                  a%n)//', '//json_pair('bodies', json_list(a%body))// &
                  '}'//comma(i, size(report%acts)))
            end associate
         end do
         call print_line(']')
      end if
      call print_line(', '//json_findings(findings)//'}')
   end subroutine print_json

   !> A body: tensor xx yy zz xy yz xz about its centre
   function json_body(report, b) result(json)
      type(extract_report_t), intent(in) :: report
      integer, intent(in) :: b
      character(len=:), allocatable :: json

      json = '{'//json_member('id', report%body_id(b))//', '// &
         json_member('name', report%body_name(b)%s)//', '// &
         json_member('main_node', report%main(b))//', '//json_member('mass', report%mass(b))// &
         ', '//json_pair('centre', json_list(report%centre(:, b)))//', '// &
         json_pair('principal', json_list(report%principal(:, b)))//', '// &
         json_pair('tensor', json_list(report%tensor(:, b)))//', '// &
         json_pair('mass_from', '{'//json_member('elements', report%from_elements(b))//', '// &
         json_member('added', report%from_masses(b))//', '// &
         json_member('card', report%from_card(b))//'}')//', '// &
         json_member('nodes', report%n_node(b))//', '//json_member('group', report%group(b))//'}'
   end function json_body

end module kj_extract_command
