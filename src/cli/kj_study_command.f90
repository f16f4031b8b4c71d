!> `kjoint study`: what accuracy costs for a deck.
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
   use kj_json_writer, only: json_member, json_findings
   use kj_study, only: study_options_t, watcher_t, run_study
   use kj_study_table, only: study_t, trial_t
   use kj_study_report, only: print_study, study_json, study_csv, trial_name
   implicit none
   private

   public :: study_command

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

end module kj_study_command
