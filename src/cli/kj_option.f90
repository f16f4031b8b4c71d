!> THE tables of the command line: commands and options. The parser and the help are driven by them;
!> what does not exist has no row. To add an option of a run: see kj_run_option. To add another: a
!> row here, and its use in the command.
!>
!> One file: the tables, and the parser that they drive.
module kj_option
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_number, only: parse_real, NUMBER_FINE
   use kj_spelling, only: did_you_mean
   use kj_text, only: word_t => text_t          ! of the command line
   use kj_run_option, only: run_options, describe_run_option, A_TEXT
   implicit none
   private

   public :: command_t, option_t, word_t, arguments_t, parse_arguments, option, has_option, &
      option_real, option_list, stem_of

   integer, parameter, public :: CMD_RUN = 1, CMD_CHECK = 2, CMD_STUDY = 3, CMD_SWEEP = 4, &
      CMD_FIT = 5, CMD_DIFF = 6, CMD_CONVERT = 7, CMD_EXPORT = 8, CMD_PLOT = 9, &
      CMD_ANIMATE = 10, CMD_REPORT = 11, CMD_INFO = 12, CMD_LIST = 13, CMD_WATCH = 14, &
      CMD_RECOVER = 15, CMD_EXTRACT = 16, CMD_NEW = 17, CMD_HELP = 18, CMD_VERSION = 19

   integer, parameter :: MANY = huge(1)         !! operands

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
      command_t(CMD_CHECK,   'check',     'DECK_0000.rad [DECK_0001.rad] ...',  0, MANY, &
                'read and check decks, and say what their scenes are like'), &
      command_t(CMD_STUDY,   'study',     'DECK_0000.rad [DECK_0001.rad]',      0, 2, &
                'run a deck in many settings: what accuracy costs, which to take'), &
      command_t(CMD_SWEEP,   'sweep',     'DECK_0000.rad [DECK_0001.rad]',      0, 2, &
                'run many variants of a deck on all cores: a table of measures'), &
      command_t(CMD_FIT,     'fit',       'DECK_0000.rad [DECK_0001.rad]',      0, 2, &
                'the values of parameters of a deck that meet a target'), &
      command_t(CMD_DIFF,    'diff',      'REF RUN',                            2, 2, &
                'compare two histories, each a kjoint .h5 or a Radioss T01'), &
      command_t(CMD_CONVERT, 'convert',   'T01',                                1, 1, &
                'turn a Radioss time history into a kjoint .h5'), &
      command_t(CMD_EXPORT,  'export',    'RUN.h5 [CHANNEL ...]',               1, MANY, &
                'a history for others: csv, json, Radioss T01, ParaView'), &
      command_t(CMD_PLOT,    'plot',      'RUN.h5 [CHANNEL ...] [OTHER.h5 ...]', 1, MANY, &
                'channels over time, runs over one another, what differs below'), &
      command_t(CMD_ANIMATE, 'animate',   'RUN.h5',                             1, 1, &
                'the moving mechanism as a film, or its picture at a time'), &
      command_t(CMD_REPORT,  'report',    'RUN.h5 [REF.h5]',                    1, 2, &
                'one page for a browser: the run, its mechanism, curves, joints'), &
      command_t(CMD_INFO,    'info',      'RUN.h5',                             1, 1, &
                'what is in a history or T01: worst joints, channels, energies'), &
      command_t(CMD_LIST,    'list',      'joints|keywords|channels',           1, 1, &
                'print a table: joint types, deck keywords or output channels'), &
      command_t(CMD_WATCH,   'watch',     'RUN.h5 [CHANNEL ...]',               1, MANY, &
                'follow a run until it ends, with curves of channels'), &
      command_t(CMD_RECOVER, 'recover',   'RUN.h5',                             1, 1, &
                'put right the history of a run that was killed'), &
      command_t(CMD_EXTRACT, 'extract',   'FULL_0000.rad [FULL_0001.rad]',      1, 2, &
                'the mechanism of a full deck with shells, solids, contacts: a new deck'), &
      command_t(CMD_NEW,     'new',       '[KIND]',                             0, 1, &
                'write a commented deck to begin with; alone: which there are'), &
      command_t(CMD_HELP,    'help',      '[COMMAND|/KEYWORD|KJ-nnnn]',         0, 1, &
                'this help, a command, the cards of a keyword, a message explained'), &
      command_t(CMD_VERSION, '--version', '',                                   0, 0, &
                'print the version')]

   integer, parameter, public :: OPT_OUTPUT = 1, OPT_INPUT = 2, OPT_LEGACY = 3, OPT_REPRODUCIBLE = &
      4, OPT_QUIET = 5, OPT_VERBOSE = 6, OPT_JSON = 7, OPT_PROFILE = 8, OPT_RTOL = 9, OPT_INTERP = &
      10, OPT_WINDOW = 11, OPT_METRICS = 12, OPT_JUNIT = 13, OPT_ERROR = 14, OPT_SCALES = 15, &
      OPT_STIFFNESS = 16, OPT_TRACE = 17, OPT_TRACE_CYCLES = 18, OPT_STRICT = 19, OPT_TO = 20, &
      OPT_SEPARATOR = 21, OPT_DECIMAL = 22, OPT_TFILE = 23, OPT_CHANNELS = 24, &
      OPT_CHECKPOINT = 25, OPT_CHECKPOINT_EVERY = 26, OPT_RESTART = 27, OPT_NEW_FILE = 28, &
      OPT_LISTING = 29, OPT_LIVE = 30, OPT_UNITS = 31, OPT_COLOUR = 32, OPT_AT = 33, &
      OPT_SECONDS = 34, OPT_PLOT = 35, OPT_WERROR = 36, OPT_VARY = 37, OPT_TABLE = 38, &
      OPT_MEASURE = 39, OPT_DRAWS = 40, OPT_RANDOM = 41, OPT_LHS = 42, OPT_SOBOL = 43, &
      OPT_SEED = 44, OPT_EVERY = 45, OPT_KEEP = 46, OPT_RESUME = 47, OPT_TARGET = 48, &
      OPT_STARTS = 49

   !> One option of one command or more
   type :: option_t
      integer           :: id              !! OPT_ constant
      character(len=2)  :: short           !! '-o' or ''
      character(len=20) :: name            !! '--output'
      character(len=8)  :: value           !! what stands for its value in the help, '' = takes none
      character(len=70) :: commands        !! names of the commands that take it
      character(len=150) :: meaning
   end type option_t

   type(option_t), parameter :: own_options(*) = [ &
      !        id                short name                   value     commands
      option_t(OPT_OUTPUT,       '-o', '--output',            'FILE', &
               'run convert export study sweep fit extract plot animate report', &
               'file to write; default: named as what is read, here; export: stdout'), &
      option_t(OPT_INPUT,        '-i', '--input',             'DECK',   'run check study sweep fit', &
               'the starter deck, as Radioss users type it'), &
      option_t(OPT_LEGACY,       '',   '--legacy',            '',       'run check', &
               'the scheme of Radioss, cycle by cycle: legacy, legacy, nodal'), &
      option_t(OPT_REPRODUCIBLE, '',   '--reproducible',      '',       'run sweep', &
               'no dates or host in the file: equal runs are equal bytes'), &
      option_t(OPT_QUIET,        '-q', '--quiet',             '',       'run check study sweep fit extract', &
               'errors and warnings only'), &
      option_t(OPT_VERBOSE,      '-v', '--verbose',           '',       'run check extract --version', &
               'notes with their cards, a line every /PRINT cycles, not every 10 s; --version: '// &
               'for which machine the kernels are'), &
      option_t(OPT_JSON,         '',   '--json',              '',       'run check study diff info extract convert list help', &
               'the answer as one JSON object on stdout'), &
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
      option_t(OPT_JUNIT,        '',   '--junit',             'FILE',   'diff check', &
               'write the verdict of each channel or deck as JUnit XML'), &
      option_t(OPT_ERROR,        '',   '--error',             'E',      'study', &
               'wanted error of positions and rotations, of their peaks; default 1e-3'), &
      option_t(OPT_SCALES,       '',   '--scales',            'LIST',   'study', &
               'of --dt-scale to try, longest first; default 0.9,0.45,0.225,0.1125'), &
      option_t(OPT_STIFFNESS,    '',   '--stiffness',         'LIST',   'study', &
               'of --kn-scale to try beside 1; default 0.1,0.01'), &
      option_t(OPT_TRACE,        '',   '--trace',             'ID,...', 'run', &
               'print all that these joints, springs, bodies, nodes do; with --json in lines'), &
      option_t(OPT_TRACE_CYCLES, '',   '--trace-cycles',      'A:B',    'run', &
               'the cycles of --trace; default 0:9'), &
      option_t(OPT_STRICT,       '',   '--strict',            '',       'diff', &
               'what is not compared counts as different: on one side alone, not a number'), &
      option_t(OPT_TO,           '',   '--to',                'FORMAT', 'export', &
               'csv, json, t01, vtkhdf, pvd; default: by the name of FILE, csv on stdout'), &
      option_t(OPT_SEPARATOR,    '',   '--separator',         'CHAR',   'export', &
               'between columns of csv: a character or `tab`; default a comma'), &
      option_t(OPT_DECIMAL,      '',   '--decimal',           'CHAR',   'export', &
               'before the fraction of numbers in csv: . or ,; default a point'), &
      option_t(OPT_TFILE,        '',   '--tfile',             'N',      'export', &
               '/TFILE type of a t01: 1 64-bit, 4 32-bit; default: as precise as RUN.h5'), &
      option_t(OPT_CHANNELS,     '',   '--channels',          'LIST',   'diff', &
               'compare these only: group/dataset[entity].component, blanks between them'), &
      option_t(OPT_CHECKPOINT,   '',   '--checkpoint',        '',       'run', &
               'leave RUN.restart.h5 at the end, to go on from'), &
      option_t(OPT_CHECKPOINT_EVERY, '', '--checkpoint-every', 'S',     'run', &
               'write it every S seconds of wall clock, and at the end'), &
      option_t(OPT_RESTART,      '',   '--restart',           'FILE',   'run', &
               'go on from RUN.restart.h5, same bits; its history grows'), &
      option_t(OPT_NEW_FILE,     '',   '--new-file',          '',       'run', &
               'with --restart: a history of its own, RUN.2.h5 or -o'), &
      option_t(OPT_LISTING,      '',   '--listing',           'FILE',   'run', &
               'write a line every /PRINT cycles to a file, in the columns of Radioss'), &
      option_t(OPT_LIVE,         '',   '--live',              '',       'run', &
               'a history that programs can follow while it grows: h5py swmr=True'), &
      option_t(OPT_UNITS,        '',   '--units',             'LIST',   'plot', &
               'to draw in, such as N,mm,ms or kN,m,deg; default: those of the history'), &
      option_t(OPT_COLOUR,       '',   '--colour',            'LOAD',   'animate', &
               'of the joints: force, moment or gap; default force'), &
      option_t(OPT_AT,           '',   '--at',                'T',      'animate', &
               'time of a .png; default: the last'), &
      option_t(OPT_SECONDS,      '',   '--seconds',           'S',      'animate', &
               'length of the film; default 6'), &
      option_t(OPT_PLOT,         '',   '--plot',              'FILE',   'diff', &
               'draw the channels that differ most'), &
      option_t(OPT_WERROR,       '',   '--werror',            '',       'check', &
               'warnings count as errors'), &
      option_t(OPT_VARY,         '',   '--vary',              'N=SPEC', 'sweep fit', &
               'a parameter and its values: a:b:n[:log], v1,v2,..., '// &
               'normal(mean,sd), uniform(a,b); of fit: a:b or a:b:start'), &
      option_t(OPT_TABLE,        '',   '--table',             'FILE',   'sweep', &
               'csv with a column a parameter and a row a variant, instead of --vary'), &
      option_t(OPT_MEASURE,      '',   '--measure',           'M',      'sweep fit', &
               'CHANNEL:max, min, mean, rms, range, final, tmax, tmin, at(t), '// &
               'rmse(REF.h5) or iso18571(REF.h5)'), &
      option_t(OPT_DRAWS,        '',   '--sample',            'N',      'sweep', &
               'so many draws of the parameters, instead of all combinations'), &
      option_t(OPT_RANDOM,       '',   '--random',            '',       'sweep', &
               'draws that know nothing of each other: the default'), &
      option_t(OPT_LHS,          '',   '--lhs',               '',       'sweep', &
               'draws by a Latin hypercube: one in each Nth of each parameter'), &
      option_t(OPT_SOBOL,        '',   '--sobol',             '',       'sweep', &
               'draws by the sequence of Sobol, best a power of 2 of them'), &
      option_t(OPT_SEED,         '',   '--seed',              'N',      'sweep fit', &
               'of the draws; default 0'), &
      option_t(OPT_EVERY,        '',   '--every',             'DT',     'sweep', &
               'interval of the samples that measures see, time; default: that of /TFILE'), &
      option_t(OPT_KEEP,         '',   '--keep',              'LIST',   'sweep', &
               'histories of these variants in FILE.runs: all, or numbers such as 1,20:30'), &
      option_t(OPT_RESUME,       '',   '--resume',            '',       'sweep', &
               'go on with a sweep that was stopped or killed'), &
      option_t(OPT_TARGET,       '',   '--target',            'T',      'fit', &
               'of a measure, in their order: a value, or REF.h5 whose curve CHANNEL follows'), &
      option_t(OPT_STARTS,       '',   '--starts',            'N',      'fit', &
               'places to begin from: the middle, then draws; the best fit counts; default 1')]

   !> Options that may be given more than once, with a line end between their values
   integer, parameter :: REPEATED(*) = [OPT_VARY, OPT_MEASURE, OPT_TARGET]

   integer, parameter, public :: FIRST_RUN = size(own_options)     !! before the run options
   integer, parameter, public :: N_OPTION = FIRST_RUN + size(run_options)

   !> A parsed command line
   type :: arguments_t
      integer :: command = 0                       !! CMD_ constant
      integer :: n_operand = 0
      type(word_t), allocatable :: operand(:)      !! the first n_operand are set
      logical :: given(N_OPTION) = .false.         !! by OPT_ constant, then of a run
      type(word_t) :: value(N_OPTION)              !! of options that take one
   end type arguments_t

contains

   !> An option by its row: those of the command line, then those of a run
   pure function option(row) result(o)
      integer, intent(in) :: row
      type(option_t) :: o

      integer :: i

      if (row <= FIRST_RUN) then
         o = own_options(row)
         return
      end if
      associate (r => run_options(row - FIRST_RUN))
         o = option_t(row, '', '--'//r%name, r%value, r%commands, &
            describe_run_option(row - FIRST_RUN))
         if (index(r%commands, 'run') > 0) o%commands = trim(r%commands)//' fit sweep'
         if (r%name == 'sample') o%commands = trim(r%commands)//' fit'    ! of sweep: --every
      end associate
      do i = 1, len(o%name)
         if (o%name(i:i) == '_') o%name(i:i) = '-'
      end do
   end function option

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

      allocate (args%operand(max(2, size(words))))
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
         else if (is_option(words(i)%s) .and. (.not. only_operands .or. &
            (args%command == CMD_HELP .and. words(i)%s == '--json'))) then
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
      row = findloc(commands%name, name, 1)
      if (row > 0) command = commands(row)%id
      if (name == '--help' .or. name == '-h') command = CMD_HELP
      if (name == '-V' .or. name == 'version') command = CMD_VERSION
      if (command > 0) return
      call fail(error, ERR_INPUT, 'unknown command "'//name//'"')
      error%hint = trim(did_you_mean(name, commands%name))
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

      character(len=:), allocatable :: name, before
      type(option_t) :: o
      integer :: equals

      name = words(i)%s
      equals = index(name, '=')
      if (name(1:2) == '--' .and. equals > 0) name = name(:equals - 1)
      call find_option(name, args%command, o, error)
      if (allocated(error)) return
      before = ''
      if (args%given(o%id)) then
         before = args%value(o%id)%s//glue(o)
         if (glue(o) == ' ') call fail(error, ERR_INPUT, name//' is given twice')
         if (allocated(error)) return
      end if
      args%given(o%id) = .true.
      if (o%value == '') then
         args%value(o%id)%s = '1'
         if (len(name) < len(words(i)%s)) call fail(error, ERR_INPUT, name//' takes no value')
         return
      end if
      args%value(o%id)%s = ''
      if (len(name) < len(words(i)%s)) then
         args%value(o%id)%s = words(i)%s(equals + 1:)
      else if (i < size(words)) then
         if (.not. is_option(words(i + 1)%s)) args%value(o%id) = words(i + 1)
         i = i + 1
      end if
      if (len(args%value(o%id)%s) == 0) &
         call fail(error, ERR_INPUT, name//' needs a value: '//name//' '//trim(o%value))
      args%value(o%id)%s = before//args%value(o%id)%s
   end subroutine take_option

   !> What joins the values of an option that is given again; a blank where that is wrong
   pure character function glue(o)
      type(option_t), intent(in) :: o

      glue = ' '
      if (any(o%id == REPEATED)) glue = new_line('')
      if (o%id <= FIRST_RUN) return
      if (run_options(o%id - FIRST_RUN)%kind == A_TEXT) glue = ','
   end function glue

   !> An option that a command takes; two commands may have options of the same name
   subroutine find_option(name, command, o, error)
      character(len=*), intent(in) :: name
      integer, intent(in) :: command
      type(option_t), intent(out) :: o
      type(error_t), allocatable, intent(out) :: error

      type(option_t) :: all(N_OPTION)
      integer :: i

      all = [(option(i), i=1, N_OPTION)]
      do i = 1, N_OPTION
         o = all(i)
         if (o%name /= name .and. o%short /= name) cycle
         if (has_option(command, o)) then
            if (allocated(error)) deallocate (error)
            return
         end if
         if (allocated(error)) cycle
         call fail(error, ERR_INPUT, '`'//trim(commands(command)%name)//'` has no option '//name)
         error%hint = 'it is an option of: '//trim(o%commands)
      end do
      if (allocated(error)) return
      call fail(error, ERR_INPUT, 'unknown option '//name)
      error%hint = trim(did_you_mean(name, pack(all%name, &
         [(has_option(command, all(i)), i=1, N_OPTION)])))
      if (len(error%hint) == 0) &
         error%hint = '`kjoint help '//trim(commands(command)%name)//'` lists the options'
   end subroutine find_option

   !> Whether a command takes an option
   pure logical function has_option(command, o)
      integer, intent(in) :: command           !! CMD_ constant
      type(option_t), intent(in) :: o

      has_option = index(' '//trim(o%commands)//' ', &
                         ' '//trim(commands(command)%name)//' ') > 0
   end function has_option

   !> Value of an option that takes a real number; `value` is kept when the option is not given
   !>
   !> Errors: ERR_INPUT when it is no number or below `least`
   subroutine option_real(args, row, least, value, error)
      type(arguments_t), intent(in) :: args
      integer, intent(in) :: row               !! OPT_ constant
      real(wp), intent(in) :: least
      real(wp), intent(inout) :: value
      type(error_t), allocatable, intent(out) :: error

      type(option_t) :: o
      integer :: status
      real(wp) :: number

      if (.not. args%given(row)) return
      o = option(row)
      call parse_real(args%value(row)%s, number, status)
      if (status /= NUMBER_FINE) then
         call fail(error, ERR_INPUT, trim(o%name)//' needs a number, not "'// &
                   args%value(row)%s//'"')
      else if (number < least) then
         call fail(error, ERR_INPUT, trim(o%name)//' is too small: '// &
                   args%value(row)%s)
      else
         value = number
      end if
   end subroutine option_real

   !> Positive numbers with commas between them, descending; not allocated when the option is not
   !> given
   !>
   !> Errors: ERR_INPUT when one is no number, not positive or larger than the one before it
   subroutine option_list(args, row, list, error)
      type(arguments_t), intent(in) :: args
      integer, intent(in) :: row                 !! OPT_ constant
      real(wp), allocatable, intent(inout) :: list(:)
      type(error_t), allocatable, intent(out) :: error

      type(option_t) :: o
      character(len=:), allocatable :: rest
      real(wp) :: x
      integer :: comma, status

      if (.not. args%given(row)) return
      allocate (list(0))
      rest = args%value(row)%s//','
      do while (len(rest) > 0)
         comma = index(rest, ',')
         call parse_real(rest(:comma - 1), x, status)
         if (status == NUMBER_FINE .and. size(list) > 0) then
            if (x >= list(size(list))) status = NUMBER_FINE + 1
         end if
         if (status /= NUMBER_FINE .or. .not. x > 0.0_wp) then
            o = option(row)
            call fail(error, ERR_INPUT, trim(o%name)// &
               ' needs falling positive numbers with commas between them, not "'// &
               args%value(row)%s//'"')
            return
         end if
         list = [list, x]
         rest = rest(comma + 1:)
      end do
   end subroutine option_list

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
         if (args%n_operand > 1) then
            call fail(error, ERR_INPUT, 'one operand too many: "'//args%operand(2)%s//'"')
            return
         end if
         if (args%n_operand == 1) args%operand(2) = args%operand(1)
         args%operand(1) = args%value(OPT_INPUT)
         args%n_operand = args%n_operand + 1
      end if
      if (args%n_operand >= max(1, commands(args%command)%least)) return
      if (any(args%command == [CMD_NEW, CMD_HELP, CMD_VERSION]) .or. args%given(OPT_RESTART)) return
      call fail(error, ERR_INPUT, '`'//trim(commands(args%command)%name)//'` needs more operands')
      error%hint = usage(args%command)
   end subroutine check_operands

   pure function usage(command) result(text)
      integer, intent(in) :: command
      character(len=:), allocatable :: text

      text = 'usage: kjoint '//trim(commands(command)%name)//' '//trim(commands(command)%operands)
   end function usage

   !> folder/DECK_0000.rad -> DECK, folder/RUN.h5 -> RUN: what is named after an operand stands here
   pure function stem_of(path) result(stem)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: stem

      integer :: cut

      stem = path(index(path, '/', back=.true.) + 1:)
      cut = index(stem, '_0000.rad', back=.true.)
      if (cut <= 1) cut = index(stem, '.', back=.true.)
      if (cut > 1) stem = stem(:cut - 1)
   end function stem_of

end module kj_option
