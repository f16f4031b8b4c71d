!> The program kjoint without its main: command line in, exit code out.
module kj_cli
   use kj_error, only: error_t, finding_list_t, add_finding
   use kj_words, only: json_member, json_findings
   use kj_version, only: KJOINT_VERSION
   use kj_system, only: kj_kernel_machine
   use kj_info, only: describe_history
   use kj_recover, only: recover_history
   use kj_new_command, only: new_command
   use kj_option, only: arguments_t, word_t, parse_arguments, CMD_RUN, CMD_CHECK, CMD_DIFF, &
      CMD_CONVERT, CMD_EXPORT, CMD_PLOT, CMD_ANIMATE, CMD_REPORT, CMD_INFO, CMD_STUDY, &
      CMD_SWEEP, CMD_FIT, CMD_EXTRACT, CMD_WATCH, CMD_RECOVER, CMD_LIST, CMD_NEW, CMD_HELP, &
      CMD_VERSION, OPT_JSON, OPT_VERBOSE
   use kj_terminal, only: print_line, print_text
   use kj_render, only: print_failure
   use kj_help, only: print_help_on, print_table
   use kj_run_command, only: run_command
   use kj_check_command, only: check_command
   use kj_study_command, only: study_command
   use kj_python_command, only: python_command
   use kj_extract_command, only: extract_command
   use kj_export_command, only: export_command, diff_command, convert_command, watch_command
   implicit none
   private

   public :: run_cli

contains

   !> Do what the command line says
   subroutine run_cli(code)
      integer, intent(out) :: code             !! exit code

      type(word_t), allocatable :: words(:)
      type(arguments_t) :: args
      type(error_t), allocatable :: error
      type(finding_list_t) :: findings
      character(len=:), allocatable :: text, topic
      integer :: i
      character :: machine(16)

      call get_words(words)
      call parse_arguments(words, args, error)
      code = 0
      if (.not. allocated(error)) then
         select case (args%command)
         case (CMD_RUN)
            call run_command(args, command_line(words), code)
         case (CMD_CHECK)
            call check_command(args, code)
         case (CMD_EXTRACT)
            call extract_command(args, code)
         case (CMD_STUDY)
            call study_command(args, code)
         case (CMD_SWEEP)
            call python_command(args, 'variants', '_sweep.h5', code, error)
         case (CMD_FIT)
            call python_command(args, 'fit', '', code, error)
         case (CMD_DIFF)
            call diff_command(args, code, error)
         case (CMD_CONVERT)
            call convert_command(args, command_line(words), error)
         case (CMD_EXPORT)
            call export_command(args, code, error)
         case (CMD_PLOT)
            call python_command(args, 'plot', '.png', code, error)
         case (CMD_ANIMATE)
            call python_command(args, 'animate', '.mp4', code, error)
         case (CMD_REPORT)
            call python_command(args, 'report', '.html', code, error)
         case (CMD_INFO)
            call describe_history(args%operand(1)%s, args%given(OPT_JSON), text, error)
            if (.not. allocated(error)) call print_text(text)
         case (CMD_WATCH)
            call watch_command(args, code, error)
         case (CMD_RECOVER)
            call recover_history(args%operand(1)%s, text, error)
            if (.not. allocated(error)) call print_text(text)
         case (CMD_LIST)
            call print_table(args%operand(1)%s, args%given(OPT_JSON), error)
         case (CMD_NEW)
            call new_command(args, error)
         case (CMD_HELP)
            topic = ''
            if (args%n_operand == 1) topic = args%operand(1)%s
            call print_help_on(topic, args%given(OPT_JSON), error)
         case (CMD_VERSION)
            call print_line('kjoint '//KJOINT_VERSION)
            call kj_kernel_machine(machine)
            topic = 'kernels '//trim(transfer(machine, repeat(' ', 16)))
            if (args%given(OPT_VERBOSE)) call print_line(topic)
         end select
      end if
      if (.not. allocated(error)) return
      code = error%code
      if (any([(words(i)%s == '--json', i=1, size(words))])) then
         call add_finding(findings, error)
         call print_line('{'//json_member('exit_code', code)//', '// &
            json_findings(findings)//'}')
      else
         call print_failure(error)
      end if
   end subroutine run_cli

   subroutine get_words(words)
      type(word_t), allocatable, intent(out) :: words(:)

      integer :: i, length

      allocate (words(command_argument_count()))
      do i = 1, size(words)
         call get_command_argument(i, length=length)
         allocate (character(len=length) :: words(i)%s)
         if (length > 0) call get_command_argument(i, words(i)%s)
      end do
   end subroutine get_words

   !> The command as it was typed, words with blanks in quotes
   pure function command_line(words) result(text)
      type(word_t), intent(in) :: words(:)
      character(len=:), allocatable :: text

      integer :: i

      text = 'kjoint'
      do i = 1, size(words)
         if (index(words(i)%s, ' ') > 0 .or. len(words(i)%s) == 0) then
            text = text//' "'//words(i)%s//'"'
         else
            text = text//' '//words(i)%s
         end if
      end do
   end function command_line

end module kj_cli
