!> Lines of an engine deck: words of a header, values of a list-directed line with their places.
module kj_engine_text
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: SEV_ERROR, SEV_WARNING, str
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE, NUMBER_BLANK, NUMBER_TEXT, &
      NUMBER_NOT_FINITE
   use kj_deck_text, only: deck_t, add_deck_finding, line_text, report_line, add_line, &
      add_file_finding
   use kj_file_lines, only: file_lines_t, stand_at, take_next, read_piece, next_line, first_byte
   implicit none
   private

   public :: engine_line_t, load_engine, has_engine_part, split_words, next_item, read_values, &
      word_integer, report_value, find_engine_word, is_engine_word

   !> What becomes of a keyword
   integer, parameter, public :: ENGINE_READ = 1, ENGINE_NOTE = 2, ENGINE_OUT = 3

   !> A row of the table
   type, public :: engine_word_t
      character(len=5)  :: name        !! first word of the header
      integer           :: status      !! ENGINE_ constant
      logical           :: once        !! of two of them the first holds
      character(len=60) :: meaning     !! ENGINE_OUT: what would be needed
   end type engine_word_t

   logical, parameter :: T = .true., F = .false.

   type(engine_word_t), parameter, public :: engine_words(*) = [ &
      engine_word_t('RUN',   ENGINE_READ, T, 'run number and end of the run'), &
      engine_word_t('TITLE', ENGINE_READ, T, 'title, not used'), &
      engine_word_t('VERS',  ENGINE_READ, T, 'version of the deck'), &
      engine_word_t('TFILE', ENGINE_READ, T, 'interval of the histories'), &
      engine_word_t('PRINT', ENGINE_READ, T, 'cycles between two lines of the listing'), &
      engine_word_t('DT',    ENGINE_READ, F, 'factor and least value of the time step'), &
      engine_word_t('DTIX',  ENGINE_READ, T, 'first and largest time step'), &
      engine_word_t('TH',    ENGINE_NOTE, F, 'form of the T01 file: none is written'), &
      engine_word_t('STOP',  ENGINE_READ, T, 'limits of energy and mass errors'), &
      engine_word_t('KILL',  ENGINE_READ, T, 'limits of energy and mass errors'), &
      engine_word_t('END',   ENGINE_READ, F, 'end of the deck'), &
      engine_word_t('RFILE', ENGINE_READ, T, 'checkpoints'), &
      engine_word_t('ATFIL', ENGINE_NOTE, F, 'history in a file A: not written'), &
      engine_word_t('BTFIL', ENGINE_NOTE, F, 'history in a file B: not written'), &
      engine_word_t('CTFIL', ENGINE_NOTE, F, 'history in a file C: not written'), &
      engine_word_t('DTFIL', ENGINE_NOTE, F, 'history in a file D: not written'), &
      engine_word_t('ETFIL', ENGINE_NOTE, F, 'history in a file E: not written'), &
      engine_word_t('FTFIL', ENGINE_NOTE, F, 'history in a file F: not written'), &
      engine_word_t('GTFIL', ENGINE_NOTE, F, 'history in a file G: not written'), &
      engine_word_t('HTFIL', ENGINE_NOTE, F, 'history in a file H: not written'), &
      engine_word_t('ITFIL', ENGINE_NOTE, F, 'history in a file I: not written'), &
      engine_word_t('ANIM',  ENGINE_NOTE, F, 'animation files: not written'), &
      engine_word_t('H3D',   ENGINE_NOTE, F, 'animation files: not written'), &
      engine_word_t('OUTP',  ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('STATE', ENGINE_NOTE, F, 'state files: not written'), &
      engine_word_t('DYNAI', ENGINE_NOTE, F, 'state files: not written'), &
      engine_word_t('ABF',   ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('MON',   ENGINE_NOTE, F, 'timing of other solvers'), &
      engine_word_t('PROC',  ENGINE_NOTE, F, 'parallel run of other solvers'), &
      engine_word_t('SPMD',  ENGINE_NOTE, F, 'parallel run of other solvers'), &
      engine_word_t('PARIT', ENGINE_NOTE, F, 'order of sums; ours never depends on threads'), &
      engine_word_t('DEBUG', ENGINE_NOTE, F, 'debugging of other solvers'), &
      engine_word_t('PERF',  ENGINE_NOTE, F, 'timing of other solvers'), &
      engine_word_t('NEGVO', ENGINE_NOTE, F, 'solid elements'), &
      engine_word_t('UPWIN', ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('BCS',   ENGINE_READ, F, 'nodes that are held'), &
      engine_word_t('BCSR',  ENGINE_READ, F, 'nodes that are released'), &
      engine_word_t('DEL',   ENGINE_OUT,  F, 'elements that are deleted: leave them out of the deck'), &
      engine_word_t('RBODY', ENGINE_OUT,  F, 'rigid bodies that are switched'), &
      engine_word_t('KEREL', ENGINE_OUT,  F, 'kinetic-energy relaxation'), &
      engine_word_t('DYREL', ENGINE_OUT,  F, 'dynamic relaxation'), &
      engine_word_t('ADYRE', ENGINE_OUT,  F, 'dynamic relaxation'), &
      engine_word_t('DAMP',  ENGINE_OUT,  F, 'Rayleigh damping'), &
      engine_word_t('INIV',  ENGINE_READ, F, 'velocities of nodes at the start'), &
      engine_word_t('IMPL',  ENGINE_OUT,  F, 'implicit solution'), &
      engine_word_t('EIG',   ENGINE_OUT,  F, 'eigenmodes'), &
      engine_word_t('THERM', ENGINE_OUT,  F, 'heat'), &
      engine_word_t('ALE',   ENGINE_OUT,  F, 'fluids'), &
      engine_word_t('INTER', ENGINE_OUT,  F, 'contact'), &
      engine_word_t('RLINK', ENGINE_OUT,  F, 'rigid links that are switched'), &
      engine_word_t('VEL',   ENGINE_OUT,  F, 'nodes that move alike'), &
      engine_word_t('FXINP', ENGINE_OUT,  F, 'flexible bodies'), &
      engine_word_t('MADYM', ENGINE_OUT,  F, 'a coupled run'), &
      engine_word_t('RAD2R', ENGINE_OUT,  F, 'a coupled run'), &
      engine_word_t('PYTHO', ENGINE_OUT,  F, 'functions in Python'), &
      engine_word_t('DELIN', ENGINE_NOTE, F, 'contacts that are deleted'), &
      engine_word_t('FVMBA', ENGINE_NOTE, F, 'airbags'), &
      engine_word_t('EBCS',  ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('UPWM',  ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('INCMP', ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('SHVER', ENGINE_NOTE, F, 'shell elements'), &
      engine_word_t('SHSUB', ENGINE_NOTE, F, 'shell elements'), &
      engine_word_t('OUTPU', ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('PATRA', ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('REPOR', ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('CHECK', ENGINE_NOTE, F, 'check sums of the deck')]

   integer, parameter :: MOST_WORDS = 8

   !> Words of a header between the slashes, blanks removed; '' where there is none
   type :: engine_line_t
      character(len=80) :: word(MOST_WORDS) = ''
      integer :: first(MOST_WORDS) = 1, last(MOST_WORDS) = 1   !! their columns
   end type engine_line_t

contains

   !> Load an engine deck: all lines but comments and blank ones; deck%readable tells of a failure
   !>
   !> Of a deck in one file the engine part begins at /RUN.
   subroutine load_engine(path, deck)
      character(len=*), intent(in) :: path
      type(deck_t), intent(inout) :: deck

      character(len=:), allocatable :: problem
      integer(int64) :: start, n_byte
      integer :: first, last, next, number
      logical :: found

      allocate (deck%source(1))
      deck%n_source = 1
      deck%source(1)%path = path
      deck%source(1)%role = 'engine'
      call find_engine_part(path, start, number, found)
      call read_piece(path, start, huge(first), deck%source(1)%text, n_byte, problem)
      deck%readable = len(problem) == 0
      if (.not. deck%readable) call add_file_finding('KJ-9030', &
         'the engine deck cannot be read: '//problem, path, 0, '', 0, 0, deck%findings)
      first = first_byte(deck%source(1)%text)
      do while (first <= len(deck%source(1)%text))
         number = number + 1
         call next_line(deck%source(1)%text, first, last, next)
         if (is_data(deck%source(1)%text(first:last))) call add_line(deck, 1, number, first, last)
         first = next
      end do
   end subroutine load_engine

   !> Where the engine part of a file begins: its first byte but for that of a deck in one file
   subroutine find_engine_part(path, start, number, found)
      character(len=*), intent(in) :: path
      integer(int64), intent(out) :: start      !! bytes before it
      integer, intent(out) :: number            !! lines before it
      logical, intent(out) :: found

      type(file_lines_t) :: lines
      integer :: first, last
      logical :: there, one_file, blank

      start = 0
      number = 0
      one_file = .false.
      blank = .true.
      call stand_at(lines, path, 0_int64, 0)
      do
         call take_next(lines, first, last, there)
         found = .false.
         if (.not. there) return
         found = index(lines%text(first:last), '/RUN') == 1 .and. (one_file .or. blank)
         if (found) exit
         if (index(lines%text(first:last), '/BEGIN') == 1) one_file = .true.
         if (blank) blank = .not. is_data(lines%text(first:last))
      end do
      if (.not. one_file) return
      start = lines%start + first - 1
      number = lines%number - 1
   end subroutine find_engine_part

   !> The file of a starter deck holds an engine part, too
   logical function has_engine_part(path) result(has)
      character(len=*), intent(in) :: path

      integer(int64) :: start
      integer :: number

      call find_engine_part(path, start, number, has)
   end function has_engine_part

   !> The line is neither a comment nor blank
   pure logical function is_data(text)
      character(len=*), intent(in) :: text

      is_data = .false.
      if (verify(text, ' '//achar(9)) == 0) return
      is_data = text(1:1) /= '#' .and. text(1:1) /= '$'
   end function is_data

   !> Take a header apart
   pure subroutine split_words(text, words)
      character(len=*), intent(in) :: text      !! has a / before each word
      type(engine_line_t), intent(out) :: words

      integer :: at, next, n, i, k

      at = index(text, '/')
      n = 0
      do while (at > 0 .and. at <= len(text) .and. n < MOST_WORDS)
         next = index(text(at + 1:), '/') + at
         if (next == at) next = len(text) + 1
         n = n + 1
         words%first(n) = at + 1
         words%last(n) = max(at + 1, next - 1)
         k = 0
         do i = at + 1, next - 1
            if (text(i:i) == ' ' .or. k == len(words%word)) cycle
            k = k + 1
            words%word(n)(k:k) = text(i:i)
         end do
         at = next
      end do
   end subroutine split_words

   !> A word of a header as an integer; 0 when there is no such word
   integer function word_integer(deck, line, words, k) result(value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line               !! of the header
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: k                  !! which word

      integer :: status

      call parse_integer(trim(words%word(k)), value, status)
      if (status == NUMBER_FINE) return
      value = 0
      if (status == NUMBER_BLANK) return
      call add_deck_finding(deck, line, words%first(k), words%last(k), SEV_ERROR, 'KJ-9002', &
         '"'//trim(words%word(k))//'" is not an integer', 'expected: an integer')
   end function word_integer

   !> Read up to `most` reals from the first data line of a block, as a list-directed read does
   !>
   !> Blanks and commas separate; 2*1.5 repeats; 1* and ,, leave a value at 0; / ends the line.
   !> Errors: fewer than `least` values (KJ-E073), text that is no number (KJ-9001).
   subroutine read_values(deck, header, last, least, most, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last       !! lines; data lines are header + 1 to last
      integer, intent(in) :: least, most
      real(wp), intent(out) :: value(:)         !! those that are missing are 0

      character(len=:), allocatable :: text
      integer :: at, a, b, n, times, line, i
      real(wp) :: x

      value = 0.0_wp
      n = 0
      line = min(header + 1, last)
      if (last > header) then
         text = line_text(deck, line)
         at = 1
         do while (n < most)
            call next_item(text, at, a, b)
            if (a == 0) exit
            call read_item(deck, line, text, a, b, times, x)
            do i = 1, min(times, most - n)
               n = n + 1
               value(n) = x
            end do
         end do
         if (n == most .and. at <= len(text)) call report_rest(deck, line, text, at)
      end if
      if (n >= least) return
      line = max(line, header)
      call report_line(deck, line, SEV_ERROR, 'KJ-E073', &
         'the keyword needs a line with '//str(least)//merge(' values', ' value ', least > 1), &
         'found: '//str(n))
   end subroutine read_values

   !> Append a finding that points at the k-th item of the data line of a block
   subroutine report_value(deck, header, last, k, severity, id, message, label)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last       !! lines; data lines are header + 1 to last
      integer, intent(in) :: k, severity
      character(len=*), intent(in) :: id, message, label

      character(len=:), allocatable :: text
      integer :: i, at, a, b

      text = line_text(deck, min(header + 1, last))
      at = 1
      do i = 1, k
         call next_item(text, at, a, b)
         if (a == 0) exit
      end do
      if (a == 0 .or. b < a) then
         a = 1
         b = max(1, len_trim(text))
      end if
      call add_deck_finding(deck, min(header + 1, last), a, b, severity, id, message, label)
   end subroutine report_value

   !> The next item of a list-directed line: columns [a, b], b < a when empty; a = 0 at the end
   pure subroutine next_item(text, at, a, b)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: at              !! column where to go on
      integer, intent(out) :: a, b

      character(len=*), parameter :: BLANKS = ' '//achar(9)
      integer :: n

      a = 0
      b = 0
      n = verify(text(min(at, len(text) + 1):), BLANKS)
      if (n == 0) return
      at = at + n - 1
      if (text(at:at) == '/') return
      a = at
      n = scan(text(at:), BLANKS//',/')
      if (n == 0) n = len(text) - at + 2
      b = at + n - 2
      at = at + n - 1
      n = verify(text(min(at, len(text) + 1):), BLANKS)
      if (n == 0) return
      if (text(at + n - 1:at + n - 1) == ',') at = at + n
   end subroutine next_item

   !> Read an item, with a repeat count perhaps
   subroutine read_item(deck, line, text, a, b, times, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line
      character(len=*), intent(in) :: text
      integer, intent(in) :: a, b               !! columns
      integer, intent(out) :: times
      real(wp), intent(out) :: value

      integer :: star, first, status

      times = 1
      first = a
      star = index(text(a:b), '*')
      status = NUMBER_FINE
      if (star > 1) then
         call parse_integer(text(a:a + star - 2), times, status)
         first = a + star
      end if
      value = 0.0_wp
      if (status == NUMBER_FINE .and. times > 0) call parse_real(text(first:b), value, status)
      if (times < 1) status = NUMBER_TEXT
      if (status == NUMBER_FINE .or. status == NUMBER_BLANK) return
      if (status == NUMBER_NOT_FINITE) then
         call add_deck_finding(deck, line, a, b, SEV_ERROR, 'KJ-9005', text(a:b)// &
            ' is not a finite number', 'expected: a real number')
      else
         call add_deck_finding(deck, line, a, b, SEV_ERROR, 'KJ-9001', text(a:b)// &
            ' is not a real number', 'expected: a real number')
      end if
      times = max(times, 1)
   end subroutine read_item

   !> Warn of text after the values
   subroutine report_rest(deck, line, text, at)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line, at
      character(len=*), intent(in) :: text

      integer :: first

      first = verify(text(at:), ' '//achar(9))
      if (first == 0) return
      first = at + first - 1
      if (text(first:first) == '/') return
      call add_deck_finding(deck, line, first, len_trim(text), SEV_WARNING, 'KJ-9009', &
         'text after the last value', 'ignored')
   end subroutine report_rest

   !> Row of an engine keyword; 0 when there is none
   pure integer function find_engine_word(word) result(row)
      character(len=*), intent(in) :: word     !! its first five characters count

      row = findloc(engine_words%name, word(:min(5, len(word))), 1)
   end function find_engine_word

   !> The first word of a header is one of an engine deck
   pure logical function is_engine_word(path)
      character(len=*), intent(in) :: path      !! words between slashes: DT/NODA

      is_engine_word = find_engine_word(path(:index(path//'/', '/') - 1)) > 0
   end function is_engine_word

end module kj_engine_text
