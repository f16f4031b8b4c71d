!> Engine decks: run control -> plain values.
module kj_engine
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING, SEV_NOTE, str
   use kj_deck_text, only: deck_t, source_t, add_deck_finding, line_text, header_end
   use kj_engine_text, only: engine_line_t, load_engine, split_words, read_values, word_integer
   use kj_engine_words, only: engine_words, find_engine_word, EN_RUN, EN_VERS, EN_TFILE, EN_PRINT, &
      EN_DT, EN_DTIX, EN_TH, EN_STOP, EN_END, ENGINE_READ, ENGINE_NOTE
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
      character(len=5) :: noda = ''             !! /DT/NODA: NODA, CST, CST1 or STOP
      real(wp) :: noda_fac = 0.0_wp             !! its factor; 0 = default
      real(wp) :: noda_min = 0.0_wp             !! its least time step
      integer :: noda_line = 0                  !! number of its line
      logical :: has_dtix = .false.
      real(wp) :: dtix_ini = 0.0_wp             !! largest first step; 0 = no limit
      real(wp) :: dtix_max = 0.0_wp             !! largest step; 0 = no limit
      logical :: has_stop = .false.
      real(wp) :: stop_energy = 0.0_wp          !! energy error that ends the run; 0 = none
   end type engine_t

contains

   !> Read an engine deck
   !>
   !> Errors: findings with code ERR_FILE when the file cannot be read, else ERR_INPUT.
   subroutine read_engine(path, engine, source, findings, ignore_unsupported)
      character(len=*), intent(in) :: path
      type(engine_t), intent(out) :: engine
      type(source_t), intent(out) :: source     !! the file, for the record
      type(finding_list_t), intent(inout) :: findings
      logical, intent(in), optional :: ignore_unsupported  !! unsupported keywords only warn

      type(deck_t) :: deck
      integer :: line, header, severity
      logical :: readable

      severity = SEV_ERROR
      if (present(ignore_unsupported)) severity = merge(SEV_WARNING, SEV_ERROR, ignore_unsupported)
      call load_engine(path, deck, readable, findings)
      if (.not. readable) then
         source%path = path
         source%text = ''
         return
      end if
      line = 1
      do while (line <= deck%n_line)
         header = line
         line = line + 1
         do while (line <= deck%n_line)
            if (is_header(deck, line)) exit
            line = line + 1
         end do
         if (.not. take_block(deck, header, line - 1, severity, engine, findings)) exit
      end do
      if (.not. engine%has_run) call add_deck_finding(deck, min(1, deck%n_line), 1, &
         header_end(deck, 1), SEV_ERROR, 'KJ-E194', 'the engine deck has no /RUN', &
         'expected: /RUN/name/1 and the end time', findings)
      source = deck%source(1)
      source%role = 'engine'
   end subroutine read_engine

   !> The line is a header
   pure logical function is_header(deck, line)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line

      is_header = index(adjustl(line_text(deck, line)), '/') == 1
   end function is_header

   !> Read a header and its data lines; .false. when the deck ends here
   logical function take_block(deck, header, last, severity, engine, findings) result(go_on)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: header, last       !! lines; data lines are header + 1 to last
      integer, intent(in) :: severity           !! of a keyword that is not supported
      type(engine_t), intent(inout) :: engine
      type(finding_list_t), intent(inout) :: findings

      type(engine_line_t) :: words
      character(len=:), allocatable :: text
      integer :: row, end, first

      go_on = .true.
      text = line_text(deck, header)
      end = header_end(deck, header)
      first = verify(text, ' ')
      if (first == 0) first = 1
      if (text(first:first) /= '/') then
         call add_deck_finding(deck, header, first, end, SEV_WARNING, 'KJ-9025', &
            'a line without a header', 'ignored', findings)
         return
      end if
      if (first > 1) call add_deck_finding(deck, header, 1, first - 1, SEV_ERROR, 'KJ-9024', &
         'blanks before a header', 'a header begins in column 1', findings)
      call split_words(text, words)
      row = find_engine_word(words%word(1))
      if (row == 0) then
         text = 'unknown keyword'
         if (find_engine_word(upper(words%word(1))) > 0) text = 'keywords are in upper case'
         call add_deck_finding(deck, header, 1, end, severity, 'KJ-E189', &
            '/'//trim(words%word(1))//' is not an engine keyword', text, findings)
         return
      end if
      associate (w => engine_words(row))
         go_on = w%id /= EN_END
         if (w%status == ENGINE_READ) then
            call take_keyword(deck, w%id, words, header, last, severity, engine, findings)
         else if (w%status == ENGINE_NOTE) then
            if (w%id == EN_TH) call check_th_version(deck, words, header, findings)
            call add_deck_finding(deck, header, 1, end, SEV_NOTE, 'KJ-9023', &
               '/'//trim(words%word(1))//' has no effect here', trim(w%meaning), findings)
         else
            call add_deck_finding(deck, header, 1, end, severity, 'KJ-9022', &
               line_text(deck, header)//' is not supported', 'needs: '//trim(w%meaning), findings, &
               'remove the keyword, or ignore it with --ignore-unsupported')
         end if
      end associate
   end function take_block

   !> Read one of the keywords that steer the run
   subroutine take_keyword(deck, id, words, header, last, severity, engine, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: id                 !! EN_ constant
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last, severity
      type(engine_t), intent(inout) :: engine
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: value(3)
      logical :: second

      second = .false.
      select case (id)
      case (EN_RUN)
         second = engine%has_run
         if (.not. second) call take_run(deck, words, header, last, engine, findings)
      case (EN_VERS)
         second = engine%version /= 0
         if (.not. second) engine%version = word_integer(deck, header, words, 2, 0, findings)
         if (engine%version < 18) call say('KJ-E196', 'the version is below 18', 'expected: 2022')
      case (EN_TFILE)
         second = engine%has_tfile
         if (.not. second) then
            engine%has_tfile = .true.
            engine%th_type = word_integer(deck, header, words, 2, 0, findings)
            call read_values(deck, header, last, 1, 1, value, findings)
            engine%th_dt = round10(value(1))
         end if
      case (EN_PRINT)
         second = engine%print_every /= 0
         if (.not. second) engine%print_every = word_integer(deck, header, words, 2, 0, findings)
      case (EN_DT)
         call take_dt(deck, words, header, last, severity, engine, second, findings)
      case (EN_DTIX)
         second = engine%has_dtix
         if (.not. second) then
            engine%has_dtix = .true.
            call read_values(deck, header, last, 2, 2, value, findings)
            engine%dtix_ini = value(1)
            engine%dtix_max = value(2)
            if (value(2) < 0.0_wp .or. (value(2) > 0.0_wp .and. value(1) > value(2))) &
               call say('KJ-E316', 'the first time step is larger than the largest one', &
               'expected: first step, largest step')
         end if
      case (EN_STOP)
         second = engine%has_stop
         if (.not. second) call take_stop(deck, header, last, engine, findings)
      end select
      if (second) call add_deck_finding(deck, header, 1, header_end(deck, header), SEV_WARNING, &
         'KJ-9040', '/'//trim(words%word(1))//' stands twice', 'the first one holds', findings)

   contains

      subroutine say(message_id, message, label)
         character(len=*), intent(in) :: message_id, message, label

         call add_deck_finding(deck, header, 1, header_end(deck, header), SEV_ERROR, message_id, &
            message, label, findings)
      end subroutine say
   end subroutine take_keyword

   !> /RUN/name/number[/letter] and the end time
   subroutine take_run(deck, words, header, last, engine, findings)
      type(deck_t), intent(in) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last
      type(engine_t), intent(inout) :: engine
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: value(3)

      engine%has_run = .true.
      engine%run_name = words%word(2)
      engine%run_number = word_integer(deck, header, words, 3, 0, findings)
      if (engine%run_number <= 0) call add_deck_finding(deck, header, 1, header_end(deck, header), &
         SEV_ERROR, 'KJ-E195', 'the run number is not positive', 'expected: /RUN/name/1', findings)
      call read_values(deck, header, last, 1, 1, value, findings)
      engine%t_stop = round10(value(1))
   end subroutine take_run

   !> /DT, /DT/NODA and the time steps of elements
   subroutine take_dt(deck, words, header, last, severity, engine, second, findings)
      type(deck_t), intent(in) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last, severity
      type(engine_t), intent(inout) :: engine
      logical, intent(out) :: second            !! it stood before
      type(finding_list_t), intent(inout) :: findings

      character(len=5) :: element               ! the first five characters count
      real(wp) :: value(3)

      second = .false.
      element = trim(words%word(2))
      select case (element)
      case ('')
         second = engine%has_dt
         if (second) return
         engine%has_dt = .true.
         call read_values(deck, header, last, 2, 2, value, findings)
         engine%dt_fac = round10(value(1))
         engine%dt_min = round10(value(2))
      case ('NODA')
         second = engine%noda /= ''
         if (second) return
         engine%noda = trim(words%word(3))
         if (engine%noda == '') engine%noda = 'NODA'
         engine%noda_line = deck%line_number(header)
         select case (engine%noda)
         case ('NODA', 'CST', 'CST1', 'STOP')
         case ('DEL')
            call say(SEV_ERROR, 'KJ-E246', '/DT/NODA/DEL does not exist', 'use CST or STOP')
         case default
            call say(severity, 'KJ-9022', 'this kind of nodal time step is not supported', &
               'supported: /DT/NODA, CST, CST1, STOP')
         end select
         if (words%word(4) /= '') call say(severity, 'KJ-9022', &
            'a nodal time step for a group of nodes is not supported', 'supported: all nodes')
         call read_values(deck, header, last, 2, 3, value, findings)
         engine%noda_fac = value(1)
         engine%noda_min = value(2)
         if (value(3) > 0.0_wp) call say(severity, 'KJ-9022', &
            'a limit of the added mass is not supported', 'the third value of the next line')
      case ('NODE')
         call say(SEV_ERROR, 'KJ-E246', '/DT/NODE does not exist', 'use /DT/NODA')
      case ('SPRIN')
         call say(severity, 'KJ-9022', 'a time step for springs is not supported', 'use /DT/NODA')
      case default
         call say(SEV_NOTE, 'KJ-9023', 'this time step has no effect here', 'no such elements')
      end select

   contains

      subroutine say(level, id, message, label)
         integer, intent(in) :: level
         character(len=*), intent(in) :: id, message, label

         call add_deck_finding(deck, header, 1, header_end(deck, header), level, id, message, &
            label, &
            findings)
      end subroutine say
   end subroutine take_dt

   !> /STOP and /KILL: the limit of the energy error; there is no added mass to limit
   subroutine take_stop(deck, header, last, engine, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: header, last
      type(engine_t), intent(inout) :: engine
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: value(3)

      engine%has_stop = .true.
      call read_values(deck, header, last, 1, 3, value, findings)
      engine%stop_energy = value(1)
      call add_deck_finding(deck, header, 1, header_end(deck, header), SEV_WARNING, 'KJ-9041', &
         'the limits of this keyword do not act', 'not supported', findings, &
         'limit the energy error with --energy-limit')
   end subroutine take_stop

   !> /TH/VERS/n needs n of at least 40
   subroutine check_th_version(deck, words, header, findings)
      type(deck_t), intent(in) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header
      type(finding_list_t), intent(inout) :: findings

      integer :: version

      if (words%word(2) /= 'VERS') return
      version = word_integer(deck, header, words, 3, 0, findings)
      if (version < 40) call add_deck_finding(deck, header, 1, header_end(deck, header), &
         SEV_ERROR, &
         'KJ-E198', 'version '//str(version)//' of the T01 file does not exist', &
         'expected: 40 or more', findings)
   end subroutine check_th_version

   !> A value rounded to ten significant digits, as Radioss keeps run control
   pure real(wp) function round10(x) result(rounded)
      real(wp), intent(in) :: x

      character(len=24) :: text

      write (text, '(es24.9e4)') x
      read (text, '(f24.0)') rounded
   end function round10

end module kj_engine
