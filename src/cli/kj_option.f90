!> THE tables of the command line: commands and options. The parser and the help are driven by them;
!> what does not exist has no row. To add an option: a row here, and its use in the command.
module kj_option
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_spelling, only: edit_distance
   implicit none
   private

   public :: command_t, option_t, word_t, arguments_t, parse_arguments, has_option, did_you_mean

   integer, parameter, public :: CMD_RUN = 1, CMD_CHECK = 2, CMD_STUDY = 3, CMD_DIFF = 4, &
      CMD_CONVERT = 5, CMD_INFO = 6, CMD_LIST = 7, CMD_HELP = 8, CMD_VERSION = 9

   !> One command of the program
   type :: command_t
      integer           :: id              !! CMD_ constant
      character(len=9)  :: name
      character(len=40) :: operands        !! as the help shows them
      integer           :: least, most     !! number of operands
      character(len=70) :: meaning
   end type command_t

   type(command_t), parameter, public :: commands(*) = [ &
      !         id           name         operands                           least most meaning
      command_t(CMD_RUN,     'run',       'DECK_0000.rad [DECK_0001.rad]',      0, 2, &
                'advance a Radioss deck in time and write its history'), &
      command_t(CMD_CHECK,   'check',     'DECK_0000.rad [DECK_0001.rad]',      0, 2, &
                'read and check a deck, and say what its scene is like'), &
      command_t(CMD_STUDY,   'study',     'DECK_0000.rad [DECK_0001.rad]',      0, 2, &
                'run a deck in many settings: what accuracy costs, which to take'), &
      command_t(CMD_DIFF,    'diff',      'REF RUN',                            2, 2, &
                'compare two histories, each a kjoint .h5 or a Radioss T01'), &
      command_t(CMD_CONVERT, 'convert',   'T01',                                1, 1, &
                'turn a Radioss time history into a kjoint .h5'), &
      command_t(CMD_INFO,    'info',      'RUN.h5',                             1, 1, &
                'what is in a history: channels, samples, energies, provenance'), &
      command_t(CMD_LIST,    'list',      'joints|keywords|channels',           1, 1, &
                'print a table: joint types, deck keywords or output channels'), &
      command_t(CMD_HELP,    'help',      '[COMMAND|KJ-nnnn]',                  0, 1, &
                'this help, the options of a command, or a message explained'), &
      command_t(CMD_VERSION, '--version', '',                                   0, 0, &
                'print the version')]

   integer, parameter, public :: OPT_OUTPUT = 1, OPT_INPUT = 2, OPT_LEGACY = 3, &
      OPT_FORMULATION = 4, OPT_INTEGRATOR = 5, OPT_DT_RULE = 6, OPT_DT_SCALE = 7, &
      OPT_UNTIL = 8, OPT_SAMPLE = 9, OPT_ENERGY_LIMIT = 10, OPT_IGNORE = 11, &
      OPT_REPRODUCIBLE = 12, OPT_QUIET = 13, OPT_VERBOSE = 14, OPT_JSON = 15, OPT_PROFILE = 16, &
      OPT_RTOL = 17, OPT_INTERP = 18, OPT_WINDOW = 19, OPT_METRICS = 20, OPT_JUNIT = 21, &
      OPT_KN_SCALE = 22, OPT_ERROR = 23, OPT_SCALES = 24, OPT_STIFFNESS = 25, OPT_THREADS = 26, &
      OPT_ISLANDS = 27

   !> One option of one command or more
   type :: option_t
      integer           :: id              !! OPT_ constant
      character(len=2)  :: short           !! '-o' or ''
      character(len=20) :: name            !! '--output'
      character(len=8)  :: value           !! what stands for its value in the help, '' = takes none
      character(len=30) :: commands        !! names of the commands that take it
      character(len=70) :: meaning
   end type option_t

   type(option_t), parameter, public :: options(*) = [ &
      !        id                short name                   value     commands
      option_t(OPT_OUTPUT,       '-o', '--output',            'FILE',   'run convert study', &
               'history (study: table) to write; default: as the deck or T01, here'), &
      option_t(OPT_INPUT,        '-i', '--input',             'DECK',   'run check study', &
               'the starter deck, as Radioss users type it'), &
      option_t(OPT_LEGACY,       '',   '--legacy',            '',       'run check', &
               'the scheme of Radioss, cycle by cycle: legacy, legacy, nodal'), &
      option_t(OPT_FORMULATION,  '',   '--formulation',       'NAME',   'run check', &
               'of the joints: consistent (default) or legacy'), &
      option_t(OPT_INTEGRATOR,   '',   '--integrator',        'NAME',   'run', &
               'of the bodies: split2 (default), liemid, rkmk4; legacy with legacy'), &
      option_t(OPT_DT_RULE,      '',   '--dt-rule',           'NAME',   'run', &
               'critical time step: safe (default), or nodal as Radioss has it'), &
      option_t(OPT_DT_SCALE,     '',   '--dt-scale',          'S',      'run check', &
               'fraction of the critical time step; default: that of /DT, or 0.9'), &
      option_t(OPT_UNTIL,        '',   '--until',             'T',      'run check study', &
               'end of the run, instead of that of the engine deck'), &
      option_t(OPT_SAMPLE,       '',   '--sample',            'DT',     'run check study', &
               'interval of the samples, instead of /TFILE; 0: every cycle'), &
      option_t(OPT_ENERGY_LIMIT, '',   '--energy-limit',      'PCT',    'run', &
               'stop with exit code 1 beyond this error; default 15, legacy: none'), &
      option_t(OPT_IGNORE,       '',   '--ignore-unsupported', '',      'run check study', &
               'warn about keywords out of scope instead of stopping'), &
      option_t(OPT_REPRODUCIBLE, '',   '--reproducible',      '',       'run', &
               'no dates or host in the history: equal runs are equal bytes'), &
      option_t(OPT_QUIET,        '-q', '--quiet',             '',       'run check study', &
               'errors and warnings only'), &
      option_t(OPT_VERBOSE,      '-v', '--verbose',           '',       'run check', &
               'notes with their cards, a listing line every /PRINT cycles'), &
      option_t(OPT_JSON,         '',   '--json',              '',       'run check study diff', &
               'findings and summary as one JSON object on stdout'), &
      option_t(OPT_PROFILE,      '',   '--profile',           'NAME',   'diff', &
               'exact, repeat 1e-12, platform 1e-9, parity 1e-7 or solver 1e-2'), &
      option_t(OPT_RTOL,         '',   '--rtol',              'R',      'diff', &
               'tolerance over the peak of each channel, instead of the profile''s'), &
      option_t(OPT_INTERP,       '',   '--interp',            '',       'diff', &
               'interpolate RUN linearly on the times of REF'), &
      option_t(OPT_WINDOW,       '',   '--window',            'T0:T1',  'diff', &
               'compare these times only'), &
      option_t(OPT_METRICS,      '',   '--metrics',           'LIST',   'diff', &
               'of max,nrmse,pearson,sprague-geers,iso18571: print these too'), &
      option_t(OPT_JUNIT,        '',   '--junit',             'FILE',   'diff', &
               'write the verdict of each channel as JUnit XML'), &
      option_t(OPT_KN_SCALE,     '',   '--kn-scale',          'F',      'run', &
               'factor on the stiffness of the blocked directions of all joints'), &
      option_t(OPT_ERROR,        '',   '--error',             'E',      'study', &
               'wanted error of positions and rotations, of their peaks; default 1e-3'), &
      option_t(OPT_SCALES,       '',   '--scales',            'LIST',   'study', &
               'of --dt-scale to try, longest first; default 0.9,0.45,0.225,0.1125'), &
      option_t(OPT_STIFFNESS,    '',   '--stiffness',         'LIST',   'study', &
               'of --kn-scale to try beside 1; default 0.1,0.01'), &
      option_t(OPT_THREADS,      '',   '--threads',           'N',      'run study', &
               'threads of a run, runs of a study; default: OMP_NUM_THREADS, else 1'), &
      option_t(OPT_ISLANDS,      '',   '--islands',           '',       'run', &
               'parts that do not act on each other take their own time steps')]

   !> A word of the command line
   type :: word_t
      character(len=:), allocatable :: s
   end type word_t

   !> A parsed command line
   type :: arguments_t
      integer :: command = 0                       !! CMD_ constant
      integer :: n_operand = 0
      type(word_t) :: operand(2)                   !! the first n_operand are set
      logical :: given(size(options)) = .false.    !! by OPT_ constant
      type(word_t) :: value(size(options))         !! of options that take one
   end type arguments_t

contains

   !> Turn the words of the command line into a command with operands and options
   !>
   !> Errors: ERR_INPUT for an unknown command or option (with the nearest known one), a value that
   !> is missing or not wanted, an option given twice, too few or too many operands.
   subroutine parse_arguments(words, args, error)
      type(word_t), intent(in) :: words(:)
      type(arguments_t), intent(out) :: args
      type(error_t), allocatable, intent(out) :: error

      integer :: i
      logical :: only_operands

      if (size(words) == 0) then
         args%command = CMD_HELP
         return
      end if
      call find_command(words(1)%s, args%command, error)
      if (allocated(error)) return
      if (asks_for_help(words(2:)) .and. args%command /= CMD_HELP) then
         args%command = CMD_HELP
         args%n_operand = 1
         args%operand(1) = words(1)
         return
      end if
      only_operands = args%command == CMD_HELP       ! of `help --version`, say
      i = 2
      do while (i <= size(words))
         if (words(i)%s == '--' .and. .not. only_operands) then
            only_operands = .true.
         else if (is_option(words(i)%s) .and. .not. only_operands) then
            call take_option(words, i, args, error)
         else
            call take_operand(words(i), args, error)
         end if
         if (allocated(error)) return
         i = i + 1
      end do
      call check_operands(args, error)
   end subroutine parse_arguments

   !> Command with this name; --help, -h, -V are other names
   subroutine find_command(name, command, error)
      character(len=*), intent(in) :: name
      integer, intent(out) :: command
      type(error_t), allocatable, intent(out) :: error

      integer :: row

      command = 0
      do row = 1, size(commands)
         if (commands(row)%name == name) command = commands(row)%id
      end do
      if (name == '--help' .or. name == '-h') command = CMD_HELP
      if (name == '-V' .or. name == 'version') command = CMD_VERSION
      if (command > 0) return
      call fail(error, ERR_INPUT, 'unknown command "'//name//'"')
      error%hint = did_you_mean(name, commands%name)
      if (len(error%hint) == 0) error%hint = '`kjoint help` lists the commands'
   end subroutine find_command

   pure logical function asks_for_help(words)
      type(word_t), intent(in) :: words(:)

      integer :: i

      asks_for_help = .false.
      do i = 1, size(words)
         if (words(i)%s == '--') return
         if (words(i)%s == '--help' .or. words(i)%s == '-h') asks_for_help = .true.
      end do
   end function asks_for_help

   !> A word that begins with - and is neither "-" nor a negative number
   pure logical function is_option(word)
      character(len=*), intent(in) :: word

      is_option = .false.
      if (len(word) < 2) return
      if (word(1:1) /= '-') return
      is_option = verify(word(2:2), '0123456789.') > 0
   end function is_option

   !> Take the option words(i), and its value from the same word or the next one
   subroutine take_option(words, i, args, error)
      type(word_t), intent(in) :: words(:)
      integer, intent(inout) :: i              !! moves on to the last word that was used
      type(arguments_t), intent(inout) :: args
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: name
      integer :: row, equals

      name = words(i)%s
      equals = index(name, '=')
      if (name(1:2) == '--' .and. equals > 0) name = name(:equals - 1)
      call find_option(name, args%command, row, error)
      if (allocated(error)) return
      if (args%given(row)) then
         call fail(error, ERR_INPUT, name//' is given twice')
         return
      end if
      args%given(row) = .true.
      if (options(row)%value == '') then
         if (len(name) < len(words(i)%s)) call fail(error, ERR_INPUT, name//' takes no value')
      else if (len(name) < len(words(i)%s)) then
         args%value(row)%s = words(i)%s(equals + 1:)
      else
         if (i < size(words)) then
            if (.not. is_option(words(i + 1)%s)) args%value(row) = words(i + 1)
         end if
         i = i + 1
      end if
      if (options(row)%value == '' .or. allocated(error)) return
      if (allocated(args%value(row)%s)) then
         if (len(args%value(row)%s) > 0) return
      end if
      call fail(error, ERR_INPUT, name//' needs a value: '//name//' '//trim(options(row)%value))
   end subroutine take_option

   !> Row of an option that a command takes
   subroutine find_option(name, command, row, error)
      character(len=*), intent(in) :: name
      integer, intent(in) :: command
      integer, intent(out) :: row
      type(error_t), allocatable, intent(out) :: error

      logical :: mine(size(options))
      integer :: i

      mine = [(has_option(command, i), i=1, size(options))]
      do row = 1, size(options)
         if (options(row)%name /= name .and. options(row)%short /= name) cycle
         if (mine(row)) return
         call fail(error, ERR_INPUT, '`'//trim(commands(command)%name)//'` has no option '//name)
         error%hint = 'it is an option of: '//trim(options(row)%commands)
         return
      end do
      call fail(error, ERR_INPUT, 'unknown option '//name)
      error%hint = did_you_mean(name, pack(options%name, mine))
      if (len(error%hint) == 0) &
         error%hint = '`kjoint help '//trim(commands(command)%name)//'` lists the options'
   end subroutine find_option

   !> Whether a command takes the option of this row
   pure logical function has_option(command, row)
      integer, intent(in) :: command, row      !! CMD_ and OPT_ constant

      has_option = index(' '//trim(options(row)%commands)//' ', &
                         ' '//trim(commands(command)%name)//' ') > 0
   end function has_option

   subroutine take_operand(word, args, error)
      type(word_t), intent(in) :: word
      type(arguments_t), intent(inout) :: args
      type(error_t), allocatable, intent(out) :: error

      if (args%n_operand == commands(args%command)%most) then
         call fail(error, ERR_INPUT, 'one operand too many: "'//word%s//'"')
         error%hint = usage(args%command)
         return
      end if
      args%n_operand = args%n_operand + 1
      args%operand(args%n_operand) = word
   end subroutine take_operand

   !> Enough operands; -i DECK is the first operand of run
   subroutine check_operands(args, error)
      type(arguments_t), intent(inout) :: args
      type(error_t), allocatable, intent(out) :: error

      if (args%given(OPT_INPUT)) then
         if (args%n_operand == 2) then
            call fail(error, ERR_INPUT, 'one operand too many: "'//args%operand(2)%s//'"')
            return
         end if
         if (args%n_operand == 1) args%operand(2) = args%operand(1)
         args%operand(1) = args%value(OPT_INPUT)
         args%n_operand = args%n_operand + 1
      end if
      if (args%n_operand >= max(1, commands(args%command)%least)) return
      if (args%command == CMD_HELP .or. args%command == CMD_VERSION) return
      call fail(error, ERR_INPUT, '`'//trim(commands(args%command)%name)//'` needs more operands')
      error%hint = usage(args%command)
   end subroutine check_operands

   pure function usage(command) result(text)
      integer, intent(in) :: command
      character(len=:), allocatable :: text

      text = 'usage: kjoint '//trim(commands(command)%name)//' '//trim(commands(command)%operands)
   end function usage

   !> 'did you mean "run"?' with the candidate nearest to a word, empty when none is near
   pure function did_you_mean(word, candidates) result(text)
      character(len=*), intent(in) :: word, candidates(:)
      character(len=:), allocatable :: text

      integer :: i, best, d, least

      text = ''
      best = 0
      least = len_trim(word)/3 + 2               ! more edits than that is another word
      do i = 1, size(candidates)
         d = edit_distance(trim(word), trim(candidates(i)))
         if (d >= least) cycle
         least = d
         best = i
      end do
      if (best > 0) text = 'did you mean "'//trim(candidates(best))//'"?'
   end function did_you_mean

end module kj_option
