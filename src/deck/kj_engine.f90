!> Engine decks: run control -> plain values.
!> One file: the keywords of one table, each with the values it reads.
module kj_engine
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING, SEV_NOTE, str
   use kj_deck_text, only: deck_t, source_t, add_deck_finding, line_text, header_end, report_line, &
      report_file
   use kj_engine_text, only: engine_line_t, load_engine, split_words, read_values, word_integer, &
      report_value, engine_word_t, engine_words, find_engine_word, ENGINE_READ, ENGINE_NOTE, &
      ENGINE_OUT
   use kj_engine_nodes, only: node_act_t, take_node_act, keep_known
   use kj_sort, only: lookup_t
   use kj_keywords, only: find_keyword
   use kj_spelling, only: upper
   implicit none
   private

   public :: engine_t, read_engine, round10

   !> Run control; times are in work units
   type :: engine_t
      character(len=80) :: run_name = ''
      integer :: run_number = 1
      logical :: has_run = .false.              !! /RUN was read; t_stop is of no use without
      real(wp) :: t_stop = 0.0_wp               !! end of the run
      integer :: version = 0                    !! of /VERS
      logical :: has_tfile = .false.
      integer :: th_type = 0                    !! type of the T01 file
      real(wp) :: th_dt = 0.0_wp                !! interval of the histories; 0 = every cycle
      integer :: print_every = 0                !! cycles; negative: also on the screen; 0 = default
      logical :: has_dt = .false.
      real(wp) :: dt_fac = 0.0_wp               !! factor of /DT; 0 = default
      real(wp) :: dt_min = 0.0_wp               !! least time step of /DT
      logical :: adds_mass = .true.             !! the run can do what CST and CST1 ask for
      character(len=5) :: noda = ''             !! /DT/NODA: NODA, CST, CST1 or STOP
      real(wp) :: noda_fac = 0.0_wp             !! its factor; 0 = default
      real(wp) :: noda_min = 0.0_wp             !! its least time step
      logical :: has_dtix = .false.
      real(wp) :: dtix_ini = 0.0_wp             !! largest first step; 0 = no limit
      real(wp) :: dtix_max = 0.0_wp             !! largest step; 0 = no limit
      logical :: has_stop = .false., has_kill = .false., has_rfile = .false.
      real(wp) :: stop_energy = 0.0_wp          !! energy error that ends the run; 0 = none
      logical :: stop_saves = .false.           !! /STOP: then the state is saved
      logical :: checkpoint = .false.           !! /RFILE: it is saved at the end
      integer :: checkpoint_cycles = 0          !! and every so many cycles; 0 = only then
      type(node_act_t), allocatable :: acts(:)  !! on nodes at the start; not allocated: none
   end type engine_t

contains

   !> Read an engine deck
   !>
   !> Errors: findings with code ERR_FILE when the file cannot be read, else ERR_INPUT.
   subroutine read_engine(path, engine, source, findings, ignore_unsupported, adds_mass, kept, &
      nodes)
      character(len=*), intent(in) :: path
      type(engine_t), intent(out) :: engine
      type(source_t), intent(out) :: source     !! the file, for the record
      type(finding_list_t), intent(inout) :: findings
      logical, intent(in), optional :: ignore_unsupported  !! unsupported keywords only warn
      logical, intent(in), optional :: adds_mass  !! the run can do what CST asks for; .true.
      !> of a full deck: what steers elements is left out, and this is the rest
      character(len=:), allocatable, intent(out), optional :: kept
      type(lookup_t), intent(in), optional :: nodes   !! with `kept`: those of the mechanism

      type(deck_t) :: deck
      character(len=:), allocatable :: text
      integer :: line, header, severity

      severity = SEV_ERROR
      if (present(ignore_unsupported)) severity = merge(SEV_WARNING, SEV_ERROR, ignore_unsupported)
      if (present(adds_mass)) engine%adds_mass = adds_mass
      deck%findings = findings
      call load_engine(path, deck)
      text = deck%source(1)%text
      if (present(kept)) call leave_out(deck, severity, nodes, kept)
      line = 1
      do while (line <= deck%n_line)
         header = line
         line = line + 1
         do while (line <= deck%n_line)
            if (is_header(deck, line)) exit
            line = line + 1
         end do
         if (.not. take_block(deck, header, line - 1, severity, engine)) exit
      end do
      if (deck%readable .and. .not. engine%has_run) then
         if (deck%n_line > 0) call report_line(deck, 1, SEV_ERROR, 'KJ-E194', &
            'the engine deck has no /RUN', 'expected: /RUN/name/1 and the end time')
         if (deck%n_line == 0) call report_file(deck, path, 'KJ-E194', 'the engine deck is empty', &
            'expected: /RUN/name/1 and the end time')
      end if
      findings = deck%findings
      source = deck%source(1)
      source%text = text
   end subroutine read_engine

   !> Leave out the keywords that steer elements and output; `kept` has the lines of the others
   subroutine leave_out(deck, severity, nodes, kept)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: severity           !! SEV_WARNING: so is what is not supported
      type(lookup_t), intent(in) :: nodes       !! of the mechanism
      character(len=:), allocatable, intent(out) :: kept

      integer :: line, n
      logical :: goes

      kept = ''
      n = 0
      goes = .false.
      do line = 1, deck%n_line
         if (is_header(deck, line)) call judge(deck, line, severity, nodes, goes)
         if (goes .or. line_text(deck, line) == '') cycle
         n = n + 1
         deck%line_source(n) = deck%line_source(line)
         deck%line_number(n) = deck%line_number(line)
         deck%line_first(n) = deck%line_first(line)
         deck%line_last(n) = deck%line_last(line)
         kept = kept//line_text(deck, n)//achar(10)
      end do
      deck%n_line = n
   end subroutine leave_out

   !> Whether a keyword of the engine deck of a full deck means nothing to its mechanism
   subroutine judge(deck, line, severity, nodes, goes)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line                !! of the header
      integer, intent(in) :: severity
      type(lookup_t), intent(in) :: nodes
      logical, intent(out) :: goes

      type(engine_line_t) :: words
      integer :: row, last
      logical :: some

      call split_words(adjustl(line_text(deck, line)), words)
      row = find_engine_word(words%word(1))
      goes = row == 0
      if (goes) then
         call report_line(deck, line, SEV_WARNING, 'KJ-E189', '/'//trim(words%word(1))// &
            ' is not an engine keyword that is known here', 'left out of the mechanism')
         return
      end if
      select case (engine_words(row)%name)
      case ('DEL', 'INTER', 'ALE', 'THERM')
         goes = .true.
      case ('RBODY')
         goes = words%word(2) == 'ON'
      case ('DT')
         goes = all(words%word(2) /= [character(len=4) :: '', 'NODA'])
         if (words%word(2) == 'NODA' .and. words%word(3)(:3) == 'CST') then
            goes = .true.
            call report_line(deck, line, SEV_WARNING, 'KJ-9425', &
               'mass scaling is left out of the mechanism', 'adds mass to nodes of elements')
         end if
      case ('BCS', 'BCSR', 'INIV')
         do last = line, deck%n_line - 1
            if (is_header(deck, last + 1)) exit
         end do
         call keep_known(deck, line, last, nodes, some)
         goes = .not. some
         if (goes) call report_line(deck, line, SEV_WARNING, 'KJ-9421', &
            'none of the nodes of this condition is in the mechanism', 'left out')
      case ('TH')
      case default
         goes = engine_words(row)%status == ENGINE_NOTE
      end select
      if (goes .or. engine_words(row)%status /= ENGINE_OUT .or. severity == SEV_ERROR) return
      goes = .true.
      call report_line(deck, line, severity, 'KJ-9022', line_text(deck, line)// &
         ' is left out of the mechanism', 'needs: '//trim(engine_words(row)%meaning))
   end subroutine judge

   !> The line is a header
   pure logical function is_header(deck, line)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line

      is_header = index(adjustl(line_text(deck, line)), '/') == 1
   end function is_header

   !> Read a header and its data lines; .false. when the deck ends here
   logical function take_block(deck, header, last, severity, engine) result(go_on)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last       !! lines; data lines are header + 1 to last
      integer, intent(in) :: severity           !! of a keyword that is not supported
      type(engine_t), intent(inout) :: engine

      type(engine_line_t) :: words
      type(engine_word_t) :: w
      character(len=:), allocatable :: text
      integer :: row, end, first

      go_on = .true.
      text = line_text(deck, header)
      end = header_end(deck, header)
      first = verify(text, ' ')
      if (first == 0) first = 1
      if (text(first:first) /= '/') then
         call add_deck_finding(deck, header, first, end, SEV_WARNING, 'KJ-9025', &
            'a line without a header', 'ignored')
         return
      end if
      if (first > 1) call add_deck_finding(deck, header, 1, first - 1, SEV_ERROR, 'KJ-9024', &
         'blanks before a header', 'a header begins in column 1')
      call split_words(text, words)
      row = find_engine_word(words%word(1))
      if (row == 0) then
         text = 'unknown keyword'
         if (find_engine_word(upper(words%word(1))) > 0) text = 'keywords are in upper case'
         if (find_keyword('/'//trim(words%word(1))) > 0) text = 'it belongs into the starter deck'
         call report_line(deck, header, severity, 'KJ-E189', '/'//trim(words%word(1))// &
            ' is not an engine keyword', text)
         return
      end if
      w = engine_words(row)
      go_on = w%name /= 'END'
      if (w%status == ENGINE_READ) then
         call take_keyword(deck, w%name, words, header, last, severity, engine)
      else if (w%status == ENGINE_NOTE) then
         if (w%name == 'TH') call check_th_version(deck, words, header)
         call report_line(deck, header, SEV_NOTE, 'KJ-9023', '/'//trim(words%word(1))// &
            ' has no effect here', trim(w%meaning))
      else
         call report_line(deck, header, severity, 'KJ-9022', line_text(deck, header)// &
            ' is not supported', 'needs: '//trim(w%meaning), &
            trim(cure(severity)))
      end if
   end function take_block

   !> What to do about a keyword that is not supported
   pure function cure(severity) result(text)
      integer, intent(in) :: severity           !! SEV_WARNING: it is ignored
      character(len=60) :: text

      text = 'remove the keyword'
      if (severity == SEV_ERROR) &
         text = 'remove the keyword, or ignore it with --ignore-unsupported'
   end function cure

   !> Read one of the keywords that steer the run
   subroutine take_keyword(deck, name, words, header, last, severity, engine)
      type(deck_t), intent(inout) :: deck
      character(len=5), intent(in) :: name      !! of the row
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last, severity
      type(engine_t), intent(inout) :: engine

      type(node_act_t) :: act
      real(wp) :: value(3)
      logical :: second, known

      second = .false.
      select case (name)
      case ('RUN')
         second = engine%has_run
         if (.not. second) call take_run(deck, words, header, last, engine)
      case ('VERS')
         second = engine%version /= 0
         if (.not. second) engine%version = word_integer(deck, header, words, 2)
         if (engine%version < 18) call report_line(deck, header, SEV_ERROR, 'KJ-E196', &
            'the version is below 18', 'expected: 2022')
      case ('TFILE')
         second = engine%has_tfile
         if (.not. second) then
            engine%has_tfile = .true.
            engine%th_type = word_integer(deck, header, words, 2)
            call read_values(deck, header, last, 1, 1, value)
            call refuse_negative(deck, header, last, value(:1))
            engine%th_dt = round10(value(1))
         end if
      case ('PRINT')
         second = engine%print_every /= 0
         if (.not. second) engine%print_every = word_integer(deck, header, words, 2)
      case ('DT')
         call take_dt(deck, words, header, last, severity, engine, second)
      case ('DTIX')
         second = engine%has_dtix
         if (.not. second) then
            engine%has_dtix = .true.
            call read_values(deck, header, last, 2, 2, value)
            call refuse_negative(deck, header, last, value(:1))
            engine%dtix_ini = value(1)
            engine%dtix_max = value(2)
            if (value(2) < 0.0_wp .or. (value(2) > 0.0_wp .and. value(1) > value(2))) &
               call report_line(deck, header, merge(SEV_WARNING, SEV_ERROR, engine%version > 0 &
               .and. engine%version < 51 .and. value(2) > 0.0_wp), 'KJ-E316', &
               'the first time step is larger than the largest one', &
               'expected: first step, largest step')
         end if
      case ('STOP')
         second = engine%has_stop
         engine%has_stop = .true.
         if (.not. second) call take_stop(deck, header, last, .true., engine)
      case ('KILL')
         second = engine%has_kill
         engine%has_kill = .true.
         if (.not. second) call take_stop(deck, header, last, .false., engine)
      case ('BCS', 'BCSR', 'INIV')
         call take_node_act(deck, words, header, last, severity, act, known)
         if (.not. allocated(engine%acts)) allocate (engine%acts(0))
         if (known) engine%acts = [engine%acts, act]
      case ('RFILE')
         second = engine%has_rfile
         engine%has_rfile = .true.
         if (.not. second) call take_rfile(deck, words, header, last, engine)
      end select
      if (second) call report_line(deck, header, SEV_WARNING, 'KJ-9040', &
         '/'//trim(words%word(1))//' stands twice', 'the first one holds')
   end subroutine take_keyword

   !> /RUN/name/number[/letter] and the end time
   subroutine take_run(deck, words, header, last, engine)
      type(deck_t), intent(inout) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last
      type(engine_t), intent(inout) :: engine

      real(wp) :: value(3)

      engine%has_run = .true.
      engine%run_name = words%word(2)
      engine%run_number = word_integer(deck, header, words, 3)
      if (engine%run_number <= 0) call report_line(deck, header, SEV_ERROR, 'KJ-E195', &
         'the run number is not positive', 'expected: /RUN/name/1')
      call read_values(deck, header, last, 1, 1, value)
      call refuse_negative(deck, header, last, value(:1))
      engine%t_stop = round10(value(1))
   end subroutine take_run

   !> /DT, /DT/NODA and the time steps of elements
   subroutine take_dt(deck, words, header, last, severity, engine, second)
      type(deck_t), intent(inout) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last, severity
      type(engine_t), intent(inout) :: engine
      logical, intent(out) :: second            !! it stood before

      character(len=5) :: element               ! the first five characters count
      real(wp) :: value(3)

      second = .false.
      element = trim(words%word(2))
      select case (element)
      case ('')
         second = engine%has_dt
         if (second) return
         engine%has_dt = .true.
         call read_values(deck, header, last, 2, 2, value)
         call check_factor(deck, header, last, value)
         engine%dt_fac = round10(value(1))
         engine%dt_min = round10(value(2))
      case ('NODA')
         second = engine%noda /= ''
         if (second) return
         engine%noda = trim(words%word(3))
         if (engine%noda == '') engine%noda = 'NODA'
         select case (engine%noda)
         case ('NODA', 'STOP')
         case ('CST', 'CST1')
            if (.not. engine%adds_mass) call report_line(deck, header, severity, 'KJ-9067', &
               '/DT/NODA/'//trim(engine%noda)//' adds mass: only the legacy formulation does '// &
               'that', 'would change the mass of bodies', 'run with --legacy'//trim( &
               merge('; or leave the mass as it is with --ignore-unsupported', repeat(' ', 54), &
               severity == SEV_ERROR)))
            if (.not. engine%adds_mass) engine%noda = 'NODA'
         case ('DEL')
            call report_line(deck, header, SEV_ERROR, 'KJ-E246', '/DT/NODA/DEL does not exist', &
               'use CST or STOP')
         case default
            call report_line(deck, header, severity, 'KJ-9022', &
               'this kind of nodal time step is not supported', &
               'supported: /DT/NODA, CST, CST1, STOP')
         end select
         if (words%word(4) /= '') call report_line(deck, header, severity, 'KJ-9022', &
            'a nodal time step for a group of nodes is not supported', 'supported: all nodes')
         call read_values(deck, header, last, 2, 3, value)
         call check_factor(deck, header, last, value)
         engine%noda_fac = value(1)
         engine%noda_min = value(2)
         if (value(3) > 0.0_wp) call report_line(deck, header, severity, 'KJ-9022', &
            'a limit of the added mass is not supported', 'the third value of the next line')
      case ('NODE')
         call report_line(deck, header, SEV_ERROR, 'KJ-E246', '/DT/NODE does not exist', &
            'use /DT/NODA')
      case ('AMS')
         call report_line(deck, header, severity, 'KJ-9022', '/DT/AMS scales mass, which is '// &
            'not supported', 'would change the mass of bodies', &
            trim(cure(severity)))
      case ('SPRIN')
         call report_line(deck, header, severity, 'KJ-9022', &
            'a time step for springs is not supported', 'use /DT/NODA')
      case default
         call report_line(deck, header, SEV_NOTE, 'KJ-9023', 'this time step has no effect here', &
            'no such elements')
      end select
   end subroutine take_dt

   !> Factor and least value of a time step
   subroutine check_factor(deck, header, last, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last
      real(wp), intent(in) :: value(:)

      call refuse_negative(deck, header, last, value(:2))
      if (value(1) > 1.0_wp) call report_value(deck, header, last, 1, SEV_WARNING, 'KJ-9065', &
         'a factor above 1 makes time steps longer than the critical one', 'usual: 0.9')
   end subroutine check_factor

   !> Numbers of run control that must not be below zero
   subroutine refuse_negative(deck, header, last, value)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last
      real(wp), intent(in) :: value(:)          !! the first ones of the data line

      integer :: k

      do k = 1, size(value)
         if (value(k) < 0.0_wp) call report_value(deck, header, last, k, SEV_ERROR, 'KJ-9064', &
            'a time, interval or factor of the run is negative', &
            'expected: a positive number, or 0')
      end do
   end subroutine refuse_negative

   !> /STOP and /KILL: the limit of the energy error, as a fraction. There are no limits of mass.
   subroutine take_stop(deck, header, last, saves, engine)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last
      logical, intent(in) :: saves              !! the state, when the limit is passed
      type(engine_t), intent(inout) :: engine

      real(wp) :: value(6)                      ! the last three are of output that is not written

      call read_values(deck, header, last, 1, 6, value)
      call refuse_negative(deck, header, last, value(:1))
      if (value(1) > 0.0_wp .and. (engine%stop_energy <= 0.0_wp .or. &
         value(1) < engine%stop_energy)) then
         engine%stop_energy = value(1)
         engine%stop_saves = saves
      end if
      if (any(value(2:3) > 0.0_wp)) call report_line(deck, header, SEV_WARNING, 'KJ-9041', &
         'the limits of mass do not act', 'not supported')
   end subroutine take_stop

   !> /RFILE: checkpoints; of the cycles between two, 0 is none but that at the end
   subroutine take_rfile(deck, words, header, last, engine)
      type(deck_t), intent(inout) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last
      type(engine_t), intent(inout) :: engine

      real(wp) :: value(3)                       ! the number of files that are kept goes unused

      engine%checkpoint = words%word(2) /= 'OFF'
      if (.not. engine%checkpoint) return
      call read_values(deck, header, last, 1, 3, value)
      call refuse_negative(deck, header, last, value(:1))
      engine%checkpoint_cycles = nint(min(value(1), 1.0e9_wp))
   end subroutine take_rfile

   !> /TH/VERS/n needs n of at least 40
   subroutine check_th_version(deck, words, header)
      type(deck_t), intent(inout) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header

      integer :: version

      if (words%word(2) /= 'VERS') return
      version = word_integer(deck, header, words, 3)
      if (version < 40) call report_line(deck, header, SEV_ERROR, 'KJ-E198', &
         'version '//str(version)//' of the T01 file does not exist', 'expected: 40 or more')
   end subroutine check_th_version

   !> A value rounded to ten significant digits, as Radioss keeps run control
   pure real(wp) function round10(x) result(rounded)
      real(wp), intent(in) :: x

      character(len=24) :: text

      write (text, '(es24.9e4)') x
      read (text, '(f24.0)') rounded
   end function round10

end module kj_engine
