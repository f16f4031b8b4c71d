!> Starter decks: file(s) -> blocks of lines with their origin, format version and units.
!>
!> A unit is a prefix and g, m or s, or its SI value.
!> One file: reading a deck is one pass with many turns
module kj_deck
   use kj_kinds, only: wp
   use kj_error, only: SEV_ERROR, SEV_WARNING, SEV_NOTE, str
   use kj_units, only: unit_system_t, factor_of
   use kj_keywords, only: keywords, KW_BEGIN, KW_UNIT, KW_UNIT_MASS, KW_UNIT_LENGTH, KW_UNIT_TIME, &
      KW_KJOINT2, KW_INIVEL_AXIS, KW_PART, KW_RBODY, KW_GRNOD_PART
   use kj_card_fields, only: field_range
   use kj_deck_text, only: deck_t, source_t, report_file, report_header, mute_block, report_line, &
      line_text, block_t, first_card, title_of, add_line, add_source, add_block, FLAT
   use kj_deck_scan, only: scan_deck
   use kj_deck_flat, only: flatten_deck
   use kj_parameter, only: setting_t
   use kj_cards, only: cards_t, read_cards, int_of, text_of, report
   use kj_number, only: parse_real, NUMBER_FINE, parse_integer, integer_field
   implicit none
   private

   public :: read_deck

   integer, parameter :: SINCE = 2612           !! version of /BEGIN

   integer, parameter :: NEWEST = 2612          !! newest format version
   integer, parameter :: OLD = 2017             !! of older ones not every layout is known
   integer, parameter :: VERSIONS(*) = [51, 90, 100, 110, 120, 130, 140, 2017, 2018, 2019, 2020, &
      2021, 2022, 2023, 2024, 2025, 2026, NEWEST]
   character(len=6), parameter :: QUANTITY(3) = ['mass  ', 'length', 'time  ']

   !> What a base unit is called
   integer, parameter :: UNIT_MASS = 1, UNIT_LENGTH = 2, UNIT_TIME = 3
   integer, parameter :: ONE_UNIT(3) = [KW_UNIT_MASS, KW_UNIT_LENGTH, KW_UNIT_TIME]

   !> A prefix of a unit
   type :: prefix_t
      character(len=2) :: name       !! as in a deck
      character(len=2) :: symbol     !! as in UDUNITS
      real(wp)         :: value
      real(wp)         :: of_gram    !! SI value of the gram with it: rounded once
   end type prefix_t

   type(prefix_t), parameter :: prefixes(*) = [ &
      prefix_t('',   '',   1e0_wp,   1e-3_wp),  &
      prefix_t('k',  'k',  1e3_wp,   1e0_wp),   &
      prefix_t('m',  'm',  1e-3_wp,  1e-6_wp),  &
      prefix_t('M',  'M',  1e6_wp,   1e3_wp),   &
      prefix_t('mu', 'u',  1e-6_wp,  1e-9_wp),  &
      prefix_t('u',  'u',  1e-6_wp,  1e-9_wp),  &
      prefix_t('n',  'n',  1e-9_wp,  1e-12_wp), &
      prefix_t('p',  'p',  1e-12_wp, 1e-15_wp), &
      prefix_t('f',  'f',  1e-15_wp, 1e-18_wp), &
      prefix_t('a',  'a',  1e-18_wp, 1e-21_wp), &
      prefix_t('z',  'z',  1e-21_wp, 1e-24_wp), &
      prefix_t('y',  'y',  1e-24_wp, 1e-27_wp), &
      prefix_t('c',  'c',  1e-2_wp,  1e-5_wp),  &
      prefix_t('d',  'd',  1e-1_wp,  1e-4_wp),  &
      prefix_t('da', 'da', 1e1_wp,   1e-2_wp),  &
      prefix_t('h',  'h',  1e2_wp,   1e-1_wp),  &
      prefix_t('K',  'k',  1e3_wp,   1e0_wp),   &
      prefix_t('G',  'G',  1e9_wp,   1e6_wp),   &
      prefix_t('T',  'T',  1e12_wp,  1e9_wp),   &
      prefix_t('P',  'P',  1e15_wp,  1e12_wp),  &
      prefix_t('E',  'E',  1e18_wp,  1e15_wp),  &
      prefix_t('Z',  'Z',  1e21_wp,  1e18_wp),  &
      prefix_t('Y',  'Y',  1e24_wp,  1e21_wp)]

   !> SI values beyond make factors and products of them that no real holds
   real(wp), parameter :: LEAST = 1.0e-30_wp, MOST = 1.0e30_wp

   character(len=1), parameter :: BASE(3) = ['g', 'm', 's']
   character(len=2), parameter :: SI_SYMBOL(3) = ['kg', 'm ', 's ']

contains

   !> Read a starter deck with all it includes, find its blocks, its version and its units
   !>
   !> Never stops at a finding. deck%readable is .false. when there is no sense in going on.
   !> Errors: findings with code ERR_FILE when a file cannot be read, else ERR_INPUT.
   subroutine read_deck(path, deck, lenient, full, settings, source)
      character(len=*), intent(in) :: path
      type(deck_t), intent(inout) :: deck      !! a new one; what is found joins its findings
      logical, intent(in), optional :: lenient   !! what is out of scope is left out; .false.
      logical, intent(in), optional :: full      !! the mechanism will be taken out of it; .false.
      type(setting_t), intent(in), optional :: settings(:)   !! parameters from outside
      type(source_t), intent(inout), optional :: source   !! the deck, in place of the file; moved

      if (present(full)) deck%full = full
      deck%lenient = deck%full
      if (present(lenient)) deck%lenient = deck%lenient .or. lenient
      call field_range(deck%field_first, deck%field_last)
      call scan_deck(path, deck, source)
      if (.not. deck%readable) return
      call read_begin(deck)
      if (present(settings)) call flatten_deck(deck, settings)
      if (.not. present(settings)) call flatten_deck(deck, [setting_t ::])
      call make_rigid_parts(deck)
      call read_local_units(deck)
      call check_unit_ids(deck)
      call check_layouts(deck)
   end subroutine read_deck

   !> Read /BEGIN: version and units
   subroutine read_begin(deck)
      type(deck_t), intent(inout) :: deck

      type(cards_t) :: cards
      integer :: i, begin

      begin = 0
      do i = 1, deck%n_block
         if (deck%block(i)%keyword /= KW_BEGIN) cycle
         if (begin > 0) call report_header(deck, i, SEV_ERROR, 'KJ-9038', 'a second /BEGIN', &
            'the first one holds')
         if (begin == 0) begin = i
      end do
      if (begin == 0) then
         if (deck%n_line > 0) call report_line(deck, 1, SEV_ERROR, 'KJ-0573', &
            'the deck has no /BEGIN, so no units', 'expected: /BEGIN')
         if (deck%n_line == 0) call report_file(deck, deck%source(1)%path, 'KJ-0573', &
            'the deck is empty', 'expected: /BEGIN, and blocks such as /NODE')
         deck%readable = deck%readable .and. deck%n_line > 0
         deck%version = NEWEST
         return
      end if
      call read_cards(deck, begin, cards)
      call choose_version(deck, cards)
      call read_units(deck, cards)
   end subroutine read_begin

   !> Choose the version of the layouts
   subroutine choose_version(deck, cards)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards

      deck%invers = int_of(cards, 'invers')
      deck%version = deck%invers
      if (any(VERSIONS == deck%invers)) then
         if (deck%version < OLD) call report(deck, cards, 'invers', SEV_NOTE, 'KJ-9063', &
            'format version '//str(deck%invers)//' is old: cards whose layout of that time is '// &
            'not known are read as those of '//str(OLD), 'read as '//str(OLD))
         return
      end if
      deck%version = NEWEST
      if (deck%invers <= 44) then
         call report(deck, cards, 'invers', SEV_ERROR, 'KJ-9027', &
            'format versions up to 44 have '// &
            'cards of 8 columns a field, which are not supported', 'expected: 51 to 2026', &
            'convert the deck; a deck with fields of 10 columns may just say 2026')
         deck%readable = .false.
      else
         call report(deck, cards, 'invers', SEV_WARNING, 'KJ-9029', 'format version '// &
            str(deck%invers)//' is not known', 'read as the newest one')
      end if
   end subroutine choose_version

   !> Read the two triples of /BEGIN; one that is blank is copied from the other
   subroutine read_units(deck, cards)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards

      type(unit_system_t) :: input, work
      integer :: i
      logical :: has_input, has_work

      call read_some(deck, cards, '_input', 1, 3, input, has_input)
      call read_some(deck, cards, '_work', 1, 3, work, has_work)
      if (.not. (has_input .or. has_work)) call read_words(deck, input, has_input)
      if (.not. (has_input .or. has_work)) then
         call report(deck, cards, 'mass_input', SEV_ERROR, 'KJ-0574', '/BEGIN has no units', &
            'expected: units of mass, length and time', 'for example kg, m, s')
      end if
      if (.not. has_input) input = work
      if (.not. has_work) work = input
      deck%input = input
      deck%work = work
      do i = 1, size(deck%factor)
         deck%factor(i) = factor_of(i, deck%input, deck%work)
      end do
      if (any(abs(deck%input%si - deck%work%si) > 0.0_wp)) then
         call report(deck, cards, 'mass_work', SEV_NOTE, 'KJ-0754', &
            'input units and work units differ', 'results are in work units')
      end if
   end subroutine read_units

   !> Read units of a card; given = .false. when all of them are blank
   subroutine read_some(deck, cards, suffix, first, last, units, given)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix    !! of the names of the fields
      integer, intent(in) :: first, last        !! UNIT_ constants
      type(unit_system_t), intent(inout) :: units
      logical, intent(out) :: given

      character(len=:), allocatable :: text, name
      logical :: found
      integer :: i

      given = .false.
      do i = first, last
         given = given .or. len(text_of(cards, trim(QUANTITY(i))//suffix)) > 0
      end do
      if (.not. given) return
      do i = first, last
         name = trim(QUANTITY(i))//suffix
         text = text_of(cards, name)
         call read_unit(text, i, units%si(i), units%symbol(i), found)
         if (.not. found) call report(deck, cards, name, SEV_ERROR, 'KJ-0573', &
            'the unit of '//trim(QUANTITY(i))//' is not understood', 'expected: a prefix and '// &
            BASE(i)//', or the SI value, 1e-30 to 1e30')
      end do
   end subroutine read_some

   !> Units of an old deck, in headers such as /UNIT/LENGTH/mm
   subroutine read_words(deck, units, given)
      type(deck_t), intent(inout) :: deck
      type(unit_system_t), intent(inout) :: units
      logical, intent(inout) :: given

      integer :: i, k
      logical :: found

      do i = 1, deck%n_block
         k = findloc(ONE_UNIT, deck%block(i)%keyword, 1)
         if (k == 0 .or. unit_word(deck, i) == '') cycle
         given = .true.
         call read_unit(trim(unit_word(deck, i)), k, units%si(k), units%symbol(k), found)
         if (.not. found) call report_header(deck, i, SEV_ERROR, 'KJ-0573', 'the unit of '// &
            trim(QUANTITY(k))//' is not understood', 'expected: a prefix and '//BASE(k))
      end do
   end subroutine read_words

   !> What follows the last slash
   pure function after_slash(text) result(word)
      character(len=*), intent(in) :: text
      character(len=8) :: word

      word = text(index(text, '/', back=.true.) + 1:)
   end function after_slash

   !> 'mm' of /UNIT/LENGTH/mm; '' of /UNIT/LENGTH/7
   pure function unit_word(deck, block) result(word)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! of a single unit
      character(len=8) :: word

      word = after_slash(line_text(deck, deck%block(block)%header))
      if (verify(word, ' +-0123456789') == 0) word = ''
   end function unit_word

   !> Read all /UNIT blocks; those of one quantity add to what others of their id say
   subroutine read_local_units(deck)
      type(deck_t), intent(inout) :: deck

      type(cards_t) :: cards
      integer :: i, k, n, at
      logical :: given

      n = count([(any(deck%block(i)%keyword == [KW_UNIT, ONE_UNIT]), i=1, deck%n_block)])
      allocate (deck%unit_id(n), deck%unit(n))
      do i = 1, deck%n_block
         k = findloc(ONE_UNIT, deck%block(i)%keyword, 1)
         if (k == 0 .and. deck%block(i)%keyword /= KW_UNIT) cycle
         if (k > 0) then
            if (unit_word(deck, i) /= '') cycle
         end if
         at = findloc(deck%unit_id(:deck%n_unit), deck%block(i)%id, 1)
         if (at > 0 .and. k == 0) call report_header(deck, i, SEV_ERROR, 'KJ-0079', '/UNIT/'// &
            str(deck%block(i)%id)//' is defined twice', 'second definition')
         if (at == 0 .or. k == 0) then
            deck%n_unit = deck%n_unit + 1
            at = deck%n_unit
            deck%unit_id(at) = deck%block(i)%id
            deck%unit(at) = deck%input
         end if
         call read_cards(deck, i, cards)
         call read_some(deck, cards, '', max(1, k), merge(3, k, k == 0), deck%unit(at), given)
         if (.not. given) call report(deck, cards, trim(QUANTITY(max(1, k))), SEV_ERROR, &
            'KJ-0573', '/UNIT has no units', 'expected: units of mass, length and time')
      end do
   end subroutine read_local_units

   !> Every unit id in a header of cards that are read must be defined
   subroutine check_unit_ids(deck)
      type(deck_t), intent(inout) :: deck

      character(len=:), allocatable :: known
      integer :: i

      do i = 1, deck%n_block
         if (deck%block(i)%unit_id == 0 .or. deck%block(i)%keyword == KW_UNIT) cycle
         if (deck%block(i)%row == 0) cycle
         if (deck%block(i)%keyword == 0 .and. all(keywords(deck%block(i)%row)%name(:5) /= &
            ['/MAT ', '/PROP'])) cycle
         if (any(deck%unit_id(:deck%n_unit) == deck%block(i)%unit_id)) cycle
         known = trim(id_list(deck%unit_id(:deck%n_unit)))
         call report_header(deck, i, SEV_ERROR, 'KJ-0659', '/UNIT/'//str(deck%block(i)%unit_id)// &
            ' is not defined', 'the last number is the id of a /UNIT', known)
      end do
   end subroutine check_unit_ids

   !> Keywords whose cards are another matter in an old format version
   subroutine check_layouts(deck)
      type(deck_t), intent(inout) :: deck

      integer :: i

      do i = 1, deck%n_block
         if (deck%block(i)%keyword == KW_KJOINT2 .and. deck%version < 120) then
            call report_header(deck, i, SEV_WARNING, 'KJ-9028', '/PROP/KJOINT2 has no layout '// &
               'before version 120: its cards are read as those of 120', 'the deck has version '// &
               str(deck%invers), 'check the values in the output of kjoint check')
         else if (deck%block(i)%keyword == KW_INIVEL_AXIS .and. deck%version < 120) then
            call report_header(deck, i, SEV_ERROR, 'KJ-2046', '/INIVEL/AXIS needs version 120', &
               'the deck has version '//str(deck%invers))
            call mute_block(deck, i)
         end if
      end do
   end subroutine check_layouts

   !> "defined: 1, 2, 3" for a hint; at most ten ids
   pure function id_list(ids) result(text)
      integer, intent(in) :: ids(:)
      character(len=160) :: text

      integer :: i

      text = 'none is defined'
      do i = 1, min(10, size(ids))
         if (i == 1) text = 'defined: '//str(ids(i))
         if (i > 1) text = trim(text)//', '//str(ids(i))
      end do
      if (size(ids) > 10) text = trim(text)//', ...'
   end function id_list

   !> SI value and UDUNITS symbol of a unit; found = .false. when the text is none, or a number
   !> beyond 1e-30 to 1e30
   !>
   !> 'Mg' and '1000.' are the tonne. A number that no code stands for keeps its value in the
   !> symbol: '(0.3048 m)'.
   pure subroutine read_unit(text, kind, si, symbol, found)
      character(len=*), intent(in) :: text        !! no blanks around it
      integer, intent(in) :: kind                 !! UNIT_ constant
      real(wp), intent(out) :: si
      character(len=20), intent(out) :: symbol
      logical, intent(out) :: found

      integer :: i, status
      real(wp) :: value

      symbol = SI_SYMBOL(kind)
      call parse_real(text, si, status)
      found = status == NUMBER_FINE .and. si >= LEAST .and. si <= MOST
      do i = 1, size(prefixes)
         value = merge(prefixes(i)%of_gram, prefixes(i)%value, kind == UNIT_MASS)
         if (found) then
            if (abs(value - si) > 1e-12_wp*si) cycle
         else
            if (text /= trim(prefixes(i)%name)//BASE(kind)) cycle
            si = value
         end if
         found = .true.
         symbol = trim(prefixes(i)%symbol)//BASE(kind)
         return
      end do
      if (found) symbol = '('//text(:min(len(text), 13))//' '//trim(SI_SYMBOL(kind))//')'
      if (.not. found) si = 1.0_wp
   end subroutine read_unit

   !> A body for each rigid part
   subroutine make_rigid_parts(deck)
      type(deck_t), intent(inout) :: deck

      character(len=100) :: card(4)
      integer :: block, group, flag, status, i

      if (deck%version < SINCE) return
      do block = 1, deck%n_block
         if (deck%block(block)%keyword /= KW_PART) cycle
         card = ''
         do i = first_card(deck, block), min(first_card(deck, block) + 3, deck%block(block)%last)
            card(i - first_card(deck, block) + 1) = line_text(deck, i)
         end do
         call parse_integer(trim(card(1)(51:70)), flag, status)
         if (status /= NUMBER_FINE .or. flag == 0) cycle
         group = free_id(deck, '/GRNOD', '/SET')
         call append(deck, block, KW_RBODY, free_id(deck, '/RBODY', '/RBE2'), [ &
            card(2)(:10)//card(2)(51:60)//card(2)(11:20)//repeat(' ', 10)//card(2)(21:40)// &
            integer_field(group)//repeat(' ', 30), card(3), card(4)])
         card = integer_field(deck%block(block)%id)
         call append(deck, block, KW_GRNOD_PART, group, card(:1))
      end do
   end subroutine make_rigid_parts

   !> One more than all ids of blocks whose keywords begin so
   pure integer function free_id(deck, one, other) result(id)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: one, other

      integer :: i

      id = 1
      do i = 1, deck%n_block
         if (deck%block(i)%row == 0) cycle
         associate (name => keywords(deck%block(i)%row)%name)
            if (index(name, one) == 1 .or. index(name, other) == 1) &
               id = max(id, deck%block(i)%id + 1)
         end associate
      end do
   end function free_id

   !> Append a block: header, title of the part, cards
   subroutine append(deck, part, keyword, id, card)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: part                !! block of the part
      integer, intent(in) :: keyword, id
      character(len=*), intent(in) :: card(:)

      type(source_t) :: source
      type(block_t) :: block
      character(len=:), allocatable :: title
      integer :: s, i, n, header

      header = deck%block(part)%header
      title = title_of(deck, part)
      source%path = deck%source(deck%line_source(header))%path
      source%role = FLAT
      source%text = trim(keywords(keyword)%name)//'/'//str(id)//title
      n = len(source%text) - len(title)
      do i = 1, size(card)
         source%text = source%text//card(i)
      end do
      call add_source(deck, source, s)
      call add_line(deck, s, deck%line_number(header), 1, n)
      call add_line(deck, s, deck%line_number(header), n + 1, n + len(title))
      n = n + len(title)
      do i = 1, size(card)
         call add_line(deck, s, deck%line_number(header), n + 1, n + len(card))
         n = n + len(card)
      end do
      block%keyword = keyword
      block%row = keyword
      block%id = id
      block%unit_id = deck%block(part)%unit_id
      block%last = deck%n_line
      block%first = block%last - size(card)
      block%header = block%first - 1
      call add_block(deck, block)
   end subroutine append

end module kj_deck
