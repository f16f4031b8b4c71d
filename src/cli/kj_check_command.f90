!> `kjoint check`: reads and checks decks, and prints what their scenes are like.
module kj_check_command
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, add_finding, str, SEV_WARNING, ERR_INPUT
   use kj_output, only: write_output
   use kj_option, only: arguments_t, OPT_QUIET, OPT_JSON, OPT_JUNIT, OPT_WERROR
   use kj_terminal, only: print_line
   use kj_render, only: print_findings, print_failure, render
   use kj_words, only: buffer_t, add, counted, escaped, json_member
   use kj_check_report, only: print_report, print_json
   use kj_restart_file, only: restart_t
   use kj_restart_command, only: find_restart, restart_from
   use kj_run_arguments, only: take_run_options, find_engine, exit_code
   use kjoint, only: simulation_t, run_options_t, check_t, load_simulation, check_simulation
   implicit none
   private

   public :: check_command

   character(len=*), parameter :: NL = new_line('a')

contains

   !> Check the decks that the arguments name; everything that is to be said has been said on return
   subroutine check_command(args, code)
      type(arguments_t), intent(in) :: args
      integer, intent(out) :: code                   !! exit code: the largest of the decks

      type(arguments_t) :: one
      type(buffer_t) :: cases
      type(error_t), allocatable :: error
      integer :: first, n_deck, n_failed
      logical :: several

      code = 0
      n_deck = 0
      n_failed = 0
      several = args%n_operand > 2
      if (args%n_operand == 2) several = starts_deck(args, 2)
      if (several .and. args%given(OPT_JSON)) call print_line('{"decks": [')
      first = 1
      do while (first <= args%n_operand)
         one = args
         one%operand(1) = args%operand(first)
         one%n_operand = 1
         if (first < args%n_operand) then
            if (.not. starts_deck(args, first + 1)) then
               one%n_operand = 2
               one%operand(2) = args%operand(first + 1)
            end if
         end if
         first = first + one%n_operand
         if (several .and. .not. args%given(OPT_JSON) .and. .not. args%given(OPT_QUIET)) then
            if (n_deck > 0) call print_line('')
            call print_line('== '//one%operand(1)%s)
         end if
         n_deck = n_deck + 1
         call check_deck(one, cases, code, n_failed)
         if (several .and. args%given(OPT_JSON) .and. first <= args%n_operand) call print_line(',')
      end do
      if (args%given(OPT_JUNIT)) call write_output(args%value(OPT_JUNIT)%s, &
         '<?xml version="1.0" encoding="UTF-8"?>'//NL//'<testsuite name="kjoint check" tests="'// &
         str(n_deck)//'" failures="'//str(n_failed)//'">'//NL//cases%s(:cases%n)// &
         '</testsuite>'//NL, args%operand(:args%n_operand), error)
      if (allocated(error)) then
         call print_failure(error)
         code = max(code, error%code)
      end if
      if (.not. several) return
      if (args%given(OPT_JSON)) then
         call print_line('], '//json_member('exit_code', code)//'}')
      else if (.not. args%given(OPT_QUIET)) then
         call print_line('')
         call print_line(counted(n_deck, 'deck', 'decks')//', '//str(n_failed)//' refused')
      end if
   end subroutine check_command

   !> Whether an operand is a starter deck: DECK_0000.rad; of two decks the second is an engine deck
   !> unless it has such a name, of more those named DECK_0001.rad, DECK_0002.rad...
   pure logical function starts_deck(args, i)
      type(arguments_t), intent(in) :: args
      integer, intent(in) :: i

      integer :: n

      associate (path => args%operand(i)%s)
         n = len(path)
         starts_deck = args%n_operand > 2
         if (n < 9) return
         if (path(n - 3:) /= '.rad' .or. path(n - 8:n - 8) /= '_') return
         if (verify(path(n - 7:n - 4), '0123456789') == 0) starts_deck = path(n - 7:n - 4) == '0000'
      end associate
   end function starts_deck

   !> Check one deck, and say what comes of it
   subroutine check_deck(given, cases, code, n_failed)
      type(arguments_t), intent(in) :: given         !! with this deck alone
      type(buffer_t), intent(inout) :: cases         !! of JUnit
      integer, intent(inout) :: code                 !! exit code, raised by that of this deck
      integer, intent(inout) :: n_failed             !! decks with another exit code than 0

      type(run_options_t) :: options
      type(simulation_t) :: sim
      type(check_t) :: report
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error, no_end
      type(arguments_t) :: args
      type(restart_t) :: restart
      character(len=:), allocatable :: engine
      integer :: own, i
      logical :: well, goes_on

      args = given
      call find_restart(args, options, restart, goes_on, error)
      if (.not. allocated(error)) call take_run_options(args, options, error)
      if (.not. allocated(error)) then
         call find_engine(args, options, engine, no_end)
         if (allocated(no_end)) options%until = 1.0_wp     ! to see what else is wrong
         call load_simulation(sim, args%operand(1)%s, engine, options, findings, error)
      end if
      if (.not. allocated(error) .and. allocated(no_end)) call move_alloc(no_end, error)
      if (goes_on .and. .not. allocated(error) .and. findings%n_error == 0) &
         call restart_from(restart, sim, error)
      well = .not. allocated(error) .and. findings%n_error == 0
      if (well) call check_simulation(sim, report, error)
      do i = 1, report%warnings%n
         call add_finding(findings, report%warnings%item(i))
      end do
      own = exit_code(findings, error)
      if (own == 0 .and. args%given(OPT_WERROR) .and. findings%n_warning > 0) own = ERR_INPUT
      code = max(code, own)
      if (own /= 0) n_failed = n_failed + 1
      if (.not. args%given(OPT_JSON)) then
         call print_findings(args, findings)
         call print_failure(error)
      end if
      if (allocated(error)) call add_finding(findings, error)
      if (args%given(OPT_JSON)) then
         call print_json(args%operand(1)%s, sim, report, well, own, findings)
      else if (well .and. .not. args%given(OPT_QUIET)) then
         call print_report(sim, report, findings)
      end if
      call add_case(args%operand(1)%s, findings, own /= 0, cases)
   end subroutine check_deck

   !> A test case of JUnit: a deck fails by its errors, or by warnings where these count
   subroutine add_case(deck, findings, failed, cases)
      character(len=*), intent(in) :: deck
      type(finding_list_t), intent(in) :: findings
      logical, intent(in) :: failed
      type(buffer_t), intent(inout) :: cases

      integer :: i

      call add(cases, '  <testcase classname="kjoint.check" name="'//escaped(deck)//'">')
      if (failed) call add(cases, '<failure message="'// &
         counted(findings%n_error, 'error', 'errors')//', '// &
         counted(findings%n_warning, 'warning', 'warnings')//'">'//NL)
      if (.not. failed .and. findings%n_warning > 0) call add(cases, '<system-out>'//NL)
      do i = 1, findings%n
         if (findings%item(i)%severity >= SEV_WARNING) &
            call add_lines(render(findings%item(i), .false.), cases)
      end do
      if (failed) call add(cases, '</failure>')
      if (.not. failed .and. findings%n_warning > 0) call add(cases, '</system-out>')
      call add(cases, '</testcase>'//NL)
   end subroutine add_case

   !> Lines as content of XML
   subroutine add_lines(text, cases)
      character(len=*), intent(in) :: text
      type(buffer_t), intent(inout) :: cases

      integer :: first, n

      first = 1
      do while (first <= len(text))
         n = index(text(first:)//NL, NL) - 1
         call add(cases, escaped(text(first:first + n - 1))//NL)
         first = first + n + 1
      end do
   end subroutine add_lines

end module kj_check_command
