!> THE table of run options: run_options_t, the command line, the C interface and Python walk it.
!>
!> To add one: a component of run_options_t, a row, its case in exchange_value, and its use.
!> One file: the table and the four ways to walk it.
module kj_run_option
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT, ERR_INTERNAL
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE
   use kj_team, only: has_threads, processors
   implicit none
   private

   public :: run_options_t, run_option_t, find_run_option, set_run_option, read_run_options, &
      write_run_options, settle_run_options, describe_run_option

   integer, parameter, public :: MOST_TEXT = 400   !! characters of a text

   !> What a run may be told, as run_options says. These values leave it to the deck and the
   !> formulation.
   type :: run_options_t
      character(len=12) :: formulation = '', integrator = '', dt_rule = '', &
         kn = ''
      real(wp) :: until = -1.0_wp, sample = -1.0_wp
      real(wp) :: dt_scale = 0.0_wp, dt_max_scale = 1.0_wp, kn_scale = 1.0_wp
      real(wp) :: energy_limit = -1.0_wp
      real(wp) :: error = 0.0_wp, turn = 0.0_wp
      logical :: ignore_unsupported = .false., ignore_random = .false., mechanism = .false.
      character(len=MOST_TEXT) :: set = ''      !! name=value,name=value
      character(len=MOST_TEXT) :: joint = ''    !! id.field=value,id.field=value
      integer :: threads = 1, least_share = 500
      logical :: islands = .false., fast = .false., force = .false.
   end type run_options_t

   !> Kinds of values; a flag is 1 or 0 in a text
   integer, parameter, public :: A_WORD = 1, A_REAL = 2, AN_INTEGER = 3, A_FLAG = 4, A_TEXT = 5
   character(len=7), parameter, public :: KIND_NAME(5) = ['word   ', 'real   ', 'integer', &
      'flag   ', 'text   ']

   !> One option
   type :: run_option_t
      character(len=18) :: name        !! component of run_options_t; of the command line with -
      integer           :: kind        !! A_WORD, A_REAL, AN_INTEGER, A_FLAG or A_TEXT
      real(wp)          :: least       !! smallest number
      character(len=4)  :: value       !! what stands for its value in the help; a flag takes none
      character(len=23) :: commands    !! that take it
      character(len=32) :: default     !! the value where one always holds, or where it comes from
      character(len=43) :: words       !! all that it may be
      character(len=66) :: meaning
   end type run_option_t

   real(wp), parameter :: ABOVE_ZERO = tiny(1.0_wp)

   type(run_option_t), parameter, public :: run_options(*) = [ &
      !            name                  kind        least       value   commands           default
      run_option_t('formulation',        A_WORD,     0.0_wp,     'NAME', 'run check',       'consistent', &
                   'consistent or legacy', 'of the joints'), &
      run_option_t('integrator',         A_WORD,     0.0_wp,     'NAME', 'run',             'split2; legacy: legacy', &
                   'split2, liemid, rkmk4, compliant or legacy', 'of the bodies'), &
      run_option_t('dt_rule',            A_WORD,     0.0_wp,     'NAME', 'run',             'safe; legacy: nodal', &
                   'safe or nodal', 'of the critical time step'), &
      run_option_t('dt_scale',           A_REAL,     ABOVE_ZERO, 'S',    'run check',       'that of /DT, or 0.9', &
                   '', 'fraction of the critical time step'), &
      run_option_t('dt_max_scale',       A_REAL,     ABOVE_ZERO, 'F',    'run',             '1', &
                   '', 'factor on the time steps of /DTIX'), &
      run_option_t('until',              A_REAL,     0.0_wp,     'T',    'run check study', 'that of the engine deck', &
                   '', 'end of the run, time'), &
      run_option_t('sample',             A_REAL,     0.0_wp,     'DT',   'run check study', 'that of /TFILE', &
                   '', 'interval of the samples, time; 0: every cycle'), &
      run_option_t('energy_limit',       A_REAL,     0.0_wp,     'PCT',  'run',             '15; legacy, compliant: none', &
                   '', 'largest energy error in percent, else a run ends with an error'), &
      run_option_t('kn_scale',           A_REAL,     ABOVE_ZERO, 'F',    'run',             '1', &
                   '', 'factor on the stiffness of the blocked directions of all joints'), &
      run_option_t('kn',                 A_WORD,     0.0_wp,     'KN',   'run',             'deck', &
                   'deck or inf', 'of the blocked directions; inf goes with compliant'), &
      run_option_t('error',              A_REAL,     ABOVE_ZERO, 'TOL',  'run',             'that is 1e-3', &
                   '', 'of compliant, over the size of the scene, at the end of the run'), &
      run_option_t('turn',               A_REAL,     ABOVE_ZERO, 'RAD',  'run',             'that is 0.1', &
                   '', 'of compliant, largest turn of a body in a step'), &
      run_option_t('fast',               A_FLAG,     0.0_wp,     '',     'run',             '', &
                   '', 'the integrator compliant'), &
      run_option_t('ignore_unsupported', A_FLAG,     0.0_wp,     '',     'run check study extract', '', &
                   '', 'warn about keywords out of scope instead of stopping'), &
      run_option_t('ignore_random',      A_FLAG,     0.0_wp,     '',     'run check study extract', '', &
                   '', 'leave coordinates as they are where /RANDOM disturbs them'), &
      run_option_t('mechanism',          A_FLAG,     0.0_wp,     '',     'run check study', '', &
                   '', 'of a full deck the rigid bodies, joints and springs alone'), &
      run_option_t('set',                A_TEXT,     0.0_wp,     'N=V',  'run check study extract', '', &
                   '', 'values of /PARAMETER: name=value, more behind commas, or again'), &
      run_option_t('joint',              A_TEXT,     0.0_wp,     'J=V',  'run check study', '', &
                   '', 'fields of single joints: ID.Kn=V, ID.SA+_rx=V, work units'), &
      run_option_t('threads',            AN_INTEGER, 1.0_wp,     'N',    'run study',       '1; command line: OMP_NUM_THREADS', &
                   '', 'threads of a run; runs at a time of study, sweep (all cores), fit'), &
      run_option_t('least_share',        AN_INTEGER, 1.0_wp,     'N',    'run',             '500', &
                   '', 'joints or bodies that a thread needs to be worth it'), &
      run_option_t('islands',            A_FLAG,     0.0_wp,     '',     'run',             '', &
                   '', 'parts that do not act on each other take their own time steps'), &
      run_option_t('force',              A_FLAG,     0.0_wp,     '',     'run',             '', &
                   '', 'run even where it takes more than 1e12 cycles')]

   !> The value of one option
   type :: value_t
      character(len=MOST_TEXT) :: word = ''
      real(wp) :: number = 0.0_wp       !! integers, too; a flag is 1 or 0
   end type value_t

contains

   !> Row of an option; 0 when there is none
   pure integer function find_run_option(name) result(row)
      character(len=*), intent(in) :: name

      do row = size(run_options), 1, -1
         if (run_options(row)%name == name) return
      end do
   end function find_run_option

   !> Set one option from a text.
   !>
   !> Errors: ERR_INPUT when the text is no value of it
   subroutine set_run_option(row, name, text, options, error)
      integer, intent(in) :: row                  !! of run_options
      character(len=*), intent(in) :: name        !! as the caller knows the option, for messages
      character(len=*), intent(in) :: text
      type(run_options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      type(value_t) :: value
      integer :: status, whole

      status = NUMBER_FINE
      if (run_options(row)%kind == A_WORD) then
         value%word = text
      else if (run_options(row)%kind == A_TEXT) then
         call exchange_value(row, .false., options, value, error)    ! what is given again joins
         value%word = trim(value%word)//','//text
         if (value%word(:1) == ',') value%word = text
      else if (run_options(row)%kind == A_REAL) then
         call parse_real(text, value%number, status)
      else
         call parse_integer(text, whole, status)
         value%number = whole
      end if
      call check_value(row, name, text, value, status == NUMBER_FINE, error)
      if (.not. allocated(error)) call exchange_value(row, .true., options, value, error)
   end subroutine set_run_option

   !> A value against its row. Errors: ERR_INPUT
   subroutine check_value(row, name, text, value, fine, error)
      integer, intent(in) :: row
      character(len=*), intent(in) :: name, text
      type(value_t), intent(in) :: value
      logical, intent(in) :: fine                 !! the text is a number, where one is due
      type(error_t), allocatable, intent(out) :: error

      type(run_option_t) :: r

      r = run_options(row)
      select case (r%kind)
      case (A_WORD)
         if (.not. is_one_of(text, r%words)) call fail(error, ERR_INPUT, &
            'there is no '//trim(r%name)//' '//text//': '//trim(r%words))
      case (A_TEXT)
         if (len_trim(text) > MOST_TEXT) call fail(error, ERR_INPUT, name//' is longer than '// &
            str(MOST_TEXT)//' characters')
      case (A_REAL)
         if (.not. fine) then
            call fail(error, ERR_INPUT, name//' needs a number, not "'//text//'"')
         else if (.not. value%number >= r%least) then
            call fail(error, ERR_INPUT, name//' is too small: '//text)
         end if
      case (AN_INTEGER)
         if (.not. (fine .and. value%number >= r%least)) call fail(error, ERR_INPUT, &
            name//' needs a whole number from '//str(nint(r%least))//', not "'//text//'"')
      case (A_FLAG)
         if (.not. (fine .and. any(nint(value%number) == [0, 1]))) &
            call fail(error, ERR_INPUT, name//' is 1 or 0, not "'//text//'"')
      end select
   end subroutine check_value

   !> The one place that knows the component of a row: take its value or give it.
   !>
   !> Errors: ERR_INTERNAL when a row has no component
   subroutine exchange_value(row, take, options, value, error)
      integer, intent(in) :: row
      logical, intent(in) :: take                 !! the value goes into the options, else out
      type(run_options_t), intent(inout) :: options
      type(value_t), intent(inout) :: value
      type(error_t), allocatable, intent(out) :: error

      select case (run_options(row)%name)
      case ('formulation'); call word(options%formulation)
      case ('integrator'); call word(options%integrator)
      case ('dt_rule'); call word(options%dt_rule)
      case ('until'); call real_number(options%until)
      case ('sample'); call real_number(options%sample)
      case ('dt_scale'); call real_number(options%dt_scale)
      case ('dt_max_scale'); call real_number(options%dt_max_scale)
      case ('kn_scale'); call real_number(options%kn_scale)
      case ('energy_limit'); call real_number(options%energy_limit)
      case ('ignore_unsupported'); call flag(options%ignore_unsupported)
      case ('ignore_random'); call flag(options%ignore_random)
      case ('mechanism'); call flag(options%mechanism)
      case ('set'); call word(options%set)
      case ('joint'); call word(options%joint)
      case ('kn'); call word(options%kn)
      case ('error'); call real_number(options%error)
      case ('turn'); call real_number(options%turn)
      case ('fast'); call flag(options%fast)
      case ('threads'); call whole_number(options%threads)
      case ('least_share'); call whole_number(options%least_share)
      case ('islands'); call flag(options%islands)
      case ('force'); call flag(options%force)
      case default
         call fail(error, ERR_INTERNAL, 'no component '//run_options(row)%name)
      end select

   contains

      subroutine word(component)
         character(len=*), intent(inout) :: component
         if (take) component = value%word
         value%word = component
      end subroutine word

      subroutine real_number(component)
         real(wp), intent(inout) :: component
         if (take) component = value%number
         value%number = component
      end subroutine real_number

      subroutine whole_number(component)
         integer, intent(inout) :: component
         if (take) component = nint(value%number)
         value%number = component
      end subroutine whole_number

      subroutine flag(component)
         logical, intent(inout) :: component
         if (take) component = value%number > 0.5_wp
         value%number = merge(1.0_wp, 0.0_wp, component)
      end subroutine flag
   end subroutine exchange_value

   !> Set options from a text: name=value, with blanks between them; later ones win.
   !>
   !> Errors: ERR_INPUT when there is no such option or a value is none of it
   subroutine read_run_options(text, options, error)
      character(len=*), intent(in) :: text
      type(run_options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      character(len=*), parameter :: BLANKS = ' '//achar(9)//achar(10)//achar(13)
      character(len=:), allocatable :: names
      integer :: first, last, equals, row

      last = 0
      do while (verify(text(last + 1:), BLANKS) > 0)
         first = last + verify(text(last + 1:), BLANKS)
         last = first + scan(text(first:)//' ', BLANKS) - 2
         equals = index(text(first:last)//'=', '=') + first - 1
         row = find_run_option(text(first:equals - 1))
         if (row == 0) then
            names = trim(run_options(1)%name)
            do row = 2, size(run_options)
               names = names//', '//trim(run_options(row)%name)
            end do
            call fail(error, ERR_INPUT, 'there is no option '//text(first:equals - 1)//': '//names)
         else if (equals >= last) then
            call fail(error, ERR_INPUT, text(first:equals - 1)//' needs a value: '// &
               text(first:equals - 1)//'=...')
         else
            call set_run_option(row, text(first:equals - 1), text(equals + 1:last), options, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine read_run_options

   !> The options that are not left to the deck and the defaults, as read_run_options has them
   subroutine write_run_options(options, text)
      type(run_options_t), intent(in) :: options
      character(len=:), allocatable, intent(out) :: text

      type(value_t) :: value
      integer :: row

      text = ''
      do row = 1, size(run_options)
         if (is_left(row, options, value)) cycle
         text = text//' '//trim(run_options(row)%name)//'='//trim(text_of(row, value))
      end do
      text = text(min(2, len(text) + 1):)
   end subroutine write_run_options

   !> An option has the value that leaves it to the deck and the defaults
   logical function is_left(row, options, value)
      integer, intent(in) :: row
      type(run_options_t), intent(in) :: options
      type(value_t), intent(out) :: value         !! of the option

      type(run_options_t) :: chosen, default
      type(value_t) :: none
      type(error_t), allocatable :: error

      chosen = options
      call exchange_value(row, .false., chosen, value, error)
      call exchange_value(row, .false., default, none, error)
      is_left = value%word == none%word .and. abs(value%number - none%number) <= 0.0_wp
   end function is_left

   !> As read_run_options reads it, with all digits
   pure function text_of(row, value) result(text)
      integer, intent(in) :: row
      type(value_t), intent(in) :: value
      character(len=MOST_TEXT) :: text

      if (any(run_options(row)%kind == [A_WORD, A_TEXT])) then
         text = value%word
      else if (run_options(row)%kind == A_REAL) then
         write (text, '(es24.16e3)') value%number
         text = adjustl(text)
      else
         write (text, '(i0)') nint(value%number)
      end if
   end function text_of

   !> Check options, and put in what the formulation decides.
   !>
   !> Errors: ERR_INPUT when a value is out of its range or two do not go together
   subroutine settle_run_options(options, error)
      type(run_options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      type(value_t) :: value
      integer :: row
      logical :: legacy

      do row = 1, size(run_options)
         if (is_left(row, options, value)) cycle
         call check_value(row, trim(run_options(row)%name), trim(text_of(row, value)), value, &
            abs(value%number) <= huge(1.0_wp), error)
         if (allocated(error)) return
      end do
      associate (o => options)
         if (o%formulation == '') o%formulation = 'consistent'
         legacy = o%formulation == 'legacy'
         if (o%fast .and. o%integrator == '') o%integrator = 'compliant'
         if (o%kn == '') o%kn = 'deck'
         if (o%integrator == '') o%integrator = merge('legacy', 'split2', legacy)
         if (o%dt_rule == '') o%dt_rule = merge('nodal', 'safe ', legacy)
         if (o%energy_limit < 0.0_wp .and. .not. legacy .and. o%integrator /= 'compliant') &
            o%energy_limit = 15.0_wp
         if (legacy .neqv. o%integrator == 'legacy') then
            call fail(error, ERR_INPUT, 'the formulation '//trim(o%formulation)// &
               ' does not go with the integrator '//trim(o%integrator))
         else if (o%fast .and. o%integrator /= 'compliant') then
            call fail(error, ERR_INPUT, 'fast does not go with the integrator '// &
               trim(o%integrator))
         else if (o%integrator /= 'compliant' .and. (o%kn /= 'deck' .or. o%error > 0.0_wp .or. &
            o%turn > 0.0_wp)) then
            call fail(error, ERR_INPUT, &
               'kn=inf, error and turn go with the integrator compliant only')
         else if (o%integrator == 'compliant' .and. o%dt_rule /= 'safe') then
            call fail(error, ERR_INPUT, 'the integrator compliant goes with the safe rule only')
         else if (legacy .and. o%dt_rule /= 'nodal') then
            call fail(error, ERR_INPUT, 'the legacy formulation goes with the nodal rule only')
         else if (legacy .and. o%islands) then
            call fail(error, ERR_INPUT, &
               'the legacy formulation has one step for all: it does not go with islands')
         else if (o%threads > 1 .and. .not. has_threads()) then
            call fail(error, ERR_INPUT, 'this kjoint was built without OpenMP: it has one thread')
         end if
         o%threads = min(o%threads, max(1, processors()))
      end associate
   end subroutine settle_run_options

   !> Meaning, words and default of an option
   pure function describe_run_option(row) result(text)
      integer, intent(in) :: row
      character(len=150) :: text

      type(run_option_t) :: r

      r = run_options(row)
      text = r%meaning
      if (r%words /= '') text = trim(text)//': '//r%words
      if (r%default /= '') text = trim(text)//'; default: '//r%default
   end function describe_run_option

   !> Whether a word stands in 'split2, liemid, rkmk4 or legacy'
   pure logical function is_one_of(word, words)
      character(len=*), intent(in) :: word, words

      character(len=len(words) + 2) :: list
      integer :: i

      list = ' '//words
      do i = 1, len(list)
         if (list(i:i) == ',') list(i:i) = ' '
      end do
      is_one_of = index(list, ' '//word//' ') > 0 .and. word /= 'or' .and. len(word) > 0 .and. &
         scan(word, ' ') == 0
   end function is_one_of

end module kj_run_option
