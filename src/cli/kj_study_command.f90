!> `kjoint study`: what accuracy costs for a deck.
!> One file: one command and what it prints, as lines and as JSON
module kj_study_command
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, add_finding, str
   use kj_output, only: write_output
   use kj_option, only: arguments_t, option_real, option_list, stem_of, OPT_OUTPUT, OPT_QUIET, &
      OPT_JSON, OPT_ERROR, OPT_SCALES, OPT_STIFFNESS
   use kj_run_arguments, only: take_run_options, find_engine, exit_code
   use kj_terminal, only: print_line, print_error
   use kj_signal, only: watch_signals, caught_signal
   use kj_render, only: print_findings, print_failure
   use kj_study, only: study_options_t, watcher_t, run_study
   use kj_study_table, only: study_t, trial_t, best_trial, order_of, CLASSES, N_CLASS
   use kj_words, only: counted, few, json_member, json_findings, json_pair
   implicit none
   private

   public :: study_command

   character(len=9), parameter :: SCHEMES(4) = [character(len=9) :: 'split2', 'liemid', 'rkmk4', &
      'legacy']

   real(wp), parameter :: WANTED_ERROR = 1.0e-3_wp
   character(len=1), parameter :: EOL = new_line('a')

   !> Says on stderr which run is done; stops after a signal
   type, extends(watcher_t) :: teller_t
      logical :: quiet = .false.
   contains
      procedure :: wants_stop
      procedure :: run_done
   end type teller_t

contains

   logical function wants_stop(self)
      class(teller_t), intent(in) :: self

      wants_stop = caught_signal() /= 0
      if (self%quiet) return
   end function wants_stop

   subroutine run_done(self, n_done, n_all, trial)
      class(teller_t), intent(inout) :: self
      integer, intent(in) :: n_done, n_all
      type(trial_t), intent(in) :: trial

      character(len=40) :: buffer

      if (self%quiet) return
      buffer = '  failed'
      if (trial%good) write (buffer, '(f10.2,a,i0,a)') trial%time, ' s  ', trial%cycles, ' cycles'
      call print_error('run '//str(n_done)//' of '//str(n_all)//': '//trial_name(trial)// &
         trim(buffer))
   end subroutine run_done

   !> Study a deck as the arguments say; everything that is to be said has been said on return
   subroutine study_command(args, code)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code                   !! exit code

      type(study_options_t) :: options
      type(study_t) :: study
      type(teller_t) :: teller
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error
      character(len=:), allocatable :: engine, root, json
      real(wp) :: wanted
      logical :: well

      call watch_signals()
      call take_study_options(args, options, wanted, error)
      if (.not. allocated(error)) call find_engine(args, options%run, engine, error)
      teller%quiet = args%given(OPT_QUIET) .or. args%given(OPT_JSON)
      if (.not. allocated(error)) &
         call run_study(args%operand(1)%s, engine, options, teller, study, findings, error)
      if (findings%n_error > 0 .and. allocated(error)) deallocate (error)   ! the findings say it
      well = findings%n_error == 0 .and. .not. allocated(error)
      if (well) then
         root = table_root(args)
         json = study_json(study, args%operand(1)%s, wanted)
         call write_output(root//'.json', json//EOL, study%input, error)
         call write_output(root//'.csv', study_csv(study)//EOL, study%input, error)
         well = .not. allocated(error)
      end if
      code = exit_code(findings, error)
      if (caught_signal() > 0) code = 128 + caught_signal()
      if (args%given(OPT_JSON)) then
         if (allocated(error)) call add_finding(findings, error)
         if (.not. well) json = ' '//json_findings(findings)//'}'
         call print_line('{'//json_member('exit_code', code)//', '//json(2:))
         return
      end if
      call print_findings(args, findings)
      call print_failure(error)
      if (args%given(OPT_QUIET) .or. .not. well) return
      call print_study(study, args%operand(1)%s, wanted)
      call print_line('table: '//root//'.json, '//root//'.csv; plot: tools/plot_study.py '//root// &
         '.json')
   end subroutine study_command

   !> Options of the command line as the library takes them
   subroutine take_study_options(args, options, wanted, error)
      type(arguments_t), intent(in) :: args
      type(study_options_t), intent(out) :: options
      real(wp), intent(out) :: wanted
      type(error_t), allocatable, intent(out) :: error

      wanted = WANTED_ERROR
      call take_run_options(args, options%run, error)
      options%threads = options%run%threads       ! a run has one
      options%run%threads = 1
      if (.not. allocated(error)) call option_real(args, OPT_ERROR, tiny(1.0_wp), wanted, error)
      options%wanted = wanted
      if (.not. allocated(error)) call option_list(args, OPT_SCALES, options%dt_scale, error)
      if (.not. allocated(error)) call option_list(args, OPT_STIFFNESS, options%kn_scale, error)
   end subroutine take_study_options

   !> What -o says without .json or .csv, else ROOT_study of DECK_0000.rad, here
   function table_root(args) result(root)
      type(arguments_t), intent(in) :: args
      character(len=:), allocatable :: root

      integer :: cut

      if (args%given(OPT_OUTPUT)) then
         root = args%value(OPT_OUTPUT)%s
         cut = max(index(root, '.json', back=.true.), index(root, '.csv', back=.true.))
         if (cut > 1 .and. cut >= len(root) - 4) root = root(:cut - 1)
         return
      end if
      root = stem_of(args%operand(1)%s)//'_study'
   end function table_root

   !> Table, orders, reference and recommendation
   subroutine print_study(study, deck, wanted)
      type(study_t), intent(in) :: study
      character(len=*), intent(in) :: deck       !! as the user named it
      real(wp), intent(in) :: wanted             !! error

      character(len=:), allocatable :: orders
      character(len=20) :: buffer
      character(len=3) :: mark
      integer :: i

      call print_line(study%title)
      call print_line('   '//counted(study%n_joint, 'joint', 'joints')//', '// &
         counted(study%n_body, 'rigid body', 'rigid bodies'))
      call print_line('')
      call print_line('scheme      step    Kn  cycles  cpu s   error   steps  veloc.'// &
         '  forces  energy')
      do i = 1, size(study%trial)
         if (i > 1) then
            if (trial_family(study%trial(i)) /= trial_family(study%trial(i - &
               1))) call print_line('')
         end if
         mark = ''
         if (is_unbeaten(study, i)) mark = ' *'
         if (i == best_trial(study, wanted)) mark = ' <-'
         call print_line(table_row(study%trial(i))//trim(mark))
      end do
      call print_line('')
      orders = ''
      do i = 1, size(SCHEMES)
         if (abs(order_of(study, trim(SCHEMES(i)))) <= 0.0_wp) cycle
         write (buffer, '(f8.2)') order_of(study, trim(SCHEMES(i)))
         orders = orders//', '//trim(SCHEMES(i))//' '//trim(adjustl(buffer))
      end do
      if (len(orders) > 0) call print_line('order in the time step: '//orders(3:))
      write (buffer, '(es8.2)') study%reference%step
      call print_line('reference: '//trial_name(study%reference)//', '// &
         str(study%reference%cycles)// &
         ' cycles of '//trim(buffer)//' on average')
      call print_line(joints_text(study))
      if (allocated(study%reference%gap_title)) call print_line( &
         'most opened, in the reference: '//study%reference%gap_title//' by '// &
         few(study%reference%gap, 3))
      call print_line('step: --dt-scale, of compliant --error; error: of positions and '// &
         'rotations, root mean')
      call print_line('square over the peak, against joints that do not give way; steps, '// &
         'velocities and')
      call print_line('forces: against the finest steps at this Kn; energy: its error, of '// &
         'legacy as')
      call print_line('OpenRadioss counts it; *: nothing is cheaper and as good; <-: the '// &
         'recommendation')
      call print_line('')
      call print_line(advice(study, deck, wanted))
   end subroutine print_study

   !> What is known of ideal joints
   function joints_text(study) result(text)
      type(study_t), intent(in) :: study
      character(len=:), allocatable :: text

      character(len=20) :: buffer

      if (study%extrapolated) then
         write (buffer, '(es8.1)') study%compliance
         text = 'joints: at Kn they give way by an error of '//trim(adjustl(buffer))
         write (buffer, '(es8.1)') study%doubt
         text = text//new_line('a')//'   (from runs at Kn and 4 Kn; from 4 Kn and 16 Kn it '// &
            'differs by '//trim(adjustl(buffer))//')'
      else if (max(study%reference%gap, study%reference%gap_rot) > 0.0_wp) then
         text = 'joints: runs at 4 Kn and 16 Kn failed, so errors do NOT count that joints give way'
      else
         text = 'joints: none gives way'
      end if
   end function joints_text

   !> No other setting is cheaper and at least as good in positions and rotations
   pure logical function is_unbeaten(study, i) result(front)
      type(study_t), intent(in) :: study
      integer, intent(in) :: i

      associate (t => study%trial)
         front = t(i)%good .and. .not. any(t%good .and. t%time < t(i)%time .and. &
            t%score <= t(i)%score)
      end associate
   end function is_unbeaten

   !> The one recommendation
   function advice(study, deck, wanted) result(text)
      type(study_t), intent(in) :: study
      character(len=*), intent(in) :: deck
      real(wp), intent(in) :: wanted
      character(len=:), allocatable :: text

      character(len=100) :: buffer
      integer :: i, best

      best = best_trial(study, wanted)
      write (buffer, '(es8.1)') wanted
      text = 'For an error of '//trim(adjustl(buffer))//': '
      if (best == 0) then
         text = 'No setting has an error of '//trim(adjustl(buffer))//'; nearest: '
         do i = 1, size(study%trial)
            if (.not. study%trial(i)%good) cycle
            if (best > 0) then
               if (study%trial(i)%score >= study%trial(best)%score) cycle
            end if
            best = i
         end do
         if (best == 0) then
            text = 'No setting ran to its end.'
            return
         end if
      end if
      associate (t => study%trial(best))
         text = text//'kjoint run '//deck//run_options(t)
         write (buffer, '(3(a,es8.1),a,f0.3,a)') '  (error', t%score, ': steps', t%by_step, &
            ', joints', t%by_joints, '; ', t%time, ' s)'
         if (t%time < 1.0_wp) write (buffer, '(3(a,es8.1),a,f5.3,a)') '  (error', t%score, &
            ': steps', t%by_step, ', joints', t%by_joints, '; ', t%time, ' s)'
         text = text//new_line('a')//trim(buffer)
         if (t%by_deck) then
            write (buffer, '(es10.3)') t%step
            text = text//new_line('a')//'with /DTIX at'//trim(buffer)// &
               ' in the engine deck: it limits the step of this deck, not its joints'
         end if
      end associate
   end function advice

   !> Options of run that give a trial; defaults are left out
   function run_options(t) result(text)
      type(trial_t), intent(in) :: t
      character(len=:), allocatable :: text

      text = ''
      associate (o => t%options)
         if (o%mechanism) text = text//' --mechanism'
         if (o%ignore_unsupported) text = text//' --ignore-unsupported'
         if (o%ignore_random) text = text//' --ignore-random'
         if (o%set /= '') text = text//' --set '//trim(o%set)
         if (o%joint /= '') text = text//' --joint '//trim(o%joint)
      end associate
      if (t%options%formulation == 'legacy') then
         text = text//' --legacy'
      else if (t%options%integrator /= 'split2') then
         text = text//' --integrator '//trim(t%options%integrator)
      end if
      if (t%options%kn /= '') text = text//' --kn '//trim(t%options%kn)
      if (t%options%error > 0.0_wp) then
         text = text//' --error '//few(t%options%error, 6)
         return
      end if
      if (.not. t%by_deck) text = text//' --dt-scale '//few(t%options%dt_scale, 6)
      if (abs(t%options%kn_scale - 1.0_wp) > 0.0_wp) &
         text = text//' --kn-scale '//few(t%options%kn_scale, 6)
   end function run_options

   !> "split2 0.45" or "split2 0.45, Kn x 0.1"
   function trial_name(t) result(text)
      type(trial_t), intent(in) :: t
      character(len=:), allocatable :: text

      if (t%options%error > 0.0_wp) then
         text = trim(t%options%integrator)//', error '//few(t%options%error, 6)
         return
      end if
      text = trim(t%options%integrator)//' '//few(t%options%dt_scale, 6)
      if (abs(t%options%kn_scale - 1.0_wp) > 0.0_wp) text = text//', Kn x '// &
         few(t%options%kn_scale, 6)
   end function trial_name

   function trial_family(t) result(text)
      type(trial_t), intent(in) :: t
      character(len=:), allocatable :: text

      text = trim(t%options%integrator)
      if (abs(t%options%kn_scale - 1.0_wp) > 0.0_wp) text = text//' Kn'
   end function trial_family

   function table_row(t) result(text)
      type(trial_t), intent(in) :: t
      character(len=:), allocatable :: text

      character(len=80) :: buffer

      text = t%options%integrator(:9)//short_column(t%options%dt_scale, 7)// &
         short_column(t%options%kn_scale, 6)
      if (t%options%error > 0.0_wp) text = t%options%integrator(:9)// &
         short_column(t%options%error, 7)//'   inf'
      if (.not. t%good) then
         text = text//'   failed'
         if (allocated(t%message)) text = text//': '//t%message
         return
      end if
      write (buffer, '(i8,f7.3,5es8.1)') t%cycles, t%time, t%score, t%by_step, &
         maxval(t%error(3:4)), maxval(t%error(5:6)), t%energy
      text = trim(text//buffer)
   end function table_row

   !> A number right-justified in n columns
   function short_column(x, n) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: n
      character(len=n) :: text

      if (len(few(x, 6)) < n) then
         text = adjustr(repeat(' ', n - len(few(x, 6)))//few(x, 6))
      else
         write (text, '(es7.0)') x
      end if
   end function short_column

   !> Everything, for tools/plot_study.py and others
   function study_json(study, deck, wanted) result(json)
      type(study_t), intent(in) :: study
      character(len=*), intent(in) :: deck
      real(wp), intent(in) :: wanted
      character(len=:), allocatable :: json

      character(len=1), parameter :: EOL = new_line('a')
      integer :: i, best

      json = '{'//json_member('deck', deck)//', '//json_member('title', study%title)// &
         ', '//json_member('joints', study%n_joint)//', '//json_member('bodies', study%n_body)// &
         ', '//json_member('floor', study%floor)//','//EOL// &
         json_member('extrapolated', study%extrapolated)//', '// &
         json_member('error_of_joints', study%compliance)//', '// &
         json_member('error_of_extrapolation', study%doubt)//','//EOL// &
         json_pair('reference', trial_json(study%reference, .false.))//','//EOL//'"settings": ['
      do i = 1, size(study%trial)
         if (i > 1) json = json//','
         json = json//EOL//trial_json(study%trial(i), is_unbeaten(study, i))
      end do
      json = json//'],'//EOL//'"orders": {'
      do i = 1, size(SCHEMES)
         if (i > 1) json = json//', '
         json = json//json_member(trim(SCHEMES(i)), order_of(study, trim(SCHEMES(i))))
      end do
      best = best_trial(study, wanted)
      json = json//'},'//EOL//json_member('wanted_error', wanted)//', '// &
         json_member('recommended', best)//', '// &
         json_member('recommendation', advice(study, deck, wanted))//'}'
   end function study_json

   function trial_json(t, unbeaten) result(json)
      type(trial_t), intent(in) :: t
      logical, intent(in) :: unbeaten
      character(len=:), allocatable :: json

      integer :: i

      json = '{'//json_member('name', trial_name(t))//', '// &
         json_member('formulation', trim(t%options%formulation))//', '// &
         json_member('integrator', trim(t%options%integrator))//', '// &
         json_member('dt_scale', t%options%dt_scale)//', '// &
         json_member('kn_scale', t%options%kn_scale)//', '// &
         json_member('ideal_joints', t%options%kn == 'inf')//', '// &
         json_member('good', t%good)
      if (allocated(t%message)) json = json//', '//json_member('message', t%message)
      if (t%good) then
         json = json//', '//json_member('cycles', t%cycles)//', '//json_member('step', t%step)// &
            ', '//json_member('cpu_s', t%time)//', '// &
            json_member('ns_per_joint_cycle', 1.0e9_wp*t%per_cycle)//', '// &
            json_member('error', t%score)//', '// &
            json_member('error_of_steps', t%by_step)//', '// &
            json_member('error_of_joints', t%by_joints)
         do i = 1, N_CLASS
            json = json//', '//json_member('error_'//trim(CLASSES(i)), t%error(i))
         end do
         json = json//', '//json_member('energy_error', t%energy)//', '// &
            json_member('violation_trans', t%gap)//', '// &
            json_member('violation_rot', t%gap_rot)//', '// &
            json_member('violation_joint', gap_title(t))//', '// &
            json_member('order', t%order)//', '// &
            json_member('unbeaten', unbeaten)
      end if
      json = json//'}'
   end function trial_json

   !> The joint that opened most; '' where none did
   pure function gap_title(t) result(title)
      type(trial_t), intent(in) :: t
      character(len=:), allocatable :: title

      title = ''
      if (allocated(t%gap_title)) title = t%gap_title
   end function gap_title

   !> A row a setting; a setting that failed has empty fields
   function study_csv(study) result(csv)
      type(study_t), intent(in) :: study
      character(len=:), allocatable :: csv

      character(len=1), parameter :: EOL = new_line('a')
      character(len=400) :: buffer
      integer :: i, k

      csv = 'formulation,integrator,dt_scale,kn_scale,good,cycles,step,cpu_s,'// &
         'ns_per_joint_cycle,error,error_of_steps,error_of_joints'
      do k = 1, N_CLASS
         csv = csv//',error_'//trim(CLASSES(k))
      end do
      csv = csv//',energy_error,violation_trans,violation_rot,order,unbeaten'//EOL
      do i = 1, size(study%trial)
         associate (t => study%trial(i))
            csv = csv//trim(t%options%formulation)//','//trim(t%options%integrator)//','// &
               few(t%options%dt_scale, 6)//','//few(t%options%kn_scale, 6)
            if (t%good) then
               write (buffer, '(a,i0,16(a,es13.6))') ',1,', t%cycles, ',', t%step, ',', t%time, &
                  ',', 1.0e9_wp*t%per_cycle, ',', t%score, ',', t%by_step, ',', t%by_joints, &
                  (',', t%error(k), k=1, N_CLASS), ',', t%energy, ',', t%gap, ',', t%gap_rot, &
                  ',', t%order
               csv = csv//trim(buffer)//','//merge('1', '0', is_unbeaten(study, i))//EOL
            else
               csv = csv//',0'//repeat(',', 12 + N_CLASS)//EOL
            end if
         end associate
      end do
   end function study_csv

end module kj_study_command
