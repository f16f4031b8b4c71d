!> Starter decks: file(s) -> blocks of lines with their origin, format version and units.
module kj_deck
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING, SEV_NOTE, str
   use kj_units, only: unit_system_t, factor_of
   use kj_keywords, only: KW_BEGIN, KW_UNIT, KW_KJOINT2, KW_INIVEL_AXIS
   use kj_card_fields, only: field_range
   use kj_deck_text, only: source_t, block_t, deck_t, line_text, place_of, title_of, block_units, &
      report_header, add_deck_finding, header_end, mute_block
   use kj_deck_scan, only: scan_deck
   use kj_cards_once, only: cards_t, read_cards, int_of, text_of, report
   use kj_deck_units, only: read_unit
   implicit none
   private

   public :: source_t, block_t, deck_t, read_deck, line_text, place_of, title_of, block_units, &
      report_header, add_deck_finding

   integer, parameter :: NEWEST = 2612          !! newest format version
   integer, parameter :: VERSIONS(*) = [51, 90, 100, 110, 120, 140, 2017, 2018, 2019, 2020, 2021, &
      2022, 2023, 2024, 2025, 2026, NEWEST]
   character(len=6), parameter :: QUANTITY(3) = ['mass  ', 'length', 'time  ']

contains

   !> Read a starter deck with all it includes, find its blocks, its version and its units
   !>
   !> Never stops at a finding. deck%readable is .false. when there is no sense in going on.
   !> Errors: findings with code ERR_FILE when a file cannot be read, else ERR_INPUT.
   subroutine read_deck(path, deck, findings, ignore_unsupported)
      character(len=*), intent(in) :: path
      type(deck_t), intent(out) :: deck
      type(finding_list_t), intent(inout) :: findings
      logical, intent(in), optional :: ignore_unsupported  !! unknown keywords only warn; .false.

      logical :: ignore

      ignore = .false.
      if (present(ignore_unsupported)) ignore = ignore_unsupported
      call field_range(deck%field_first, deck%field_last)
      call scan_deck(path, deck, findings, ignore)
      if (.not. deck%readable) return
      call read_begin(deck, findings)
      call read_local_units(deck, findings)
      call check_unit_ids(deck, findings)
      call check_layouts(deck, findings)
   end subroutine read_deck

   !> Read /BEGIN: version and units
   subroutine read_begin(deck, findings)
      type(deck_t), intent(inout) :: deck
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      integer :: i, begin

      begin = 0
      do i = 1, deck%n_block
         if (deck%block(i)%keyword /= KW_BEGIN) cycle
         if (begin > 0) call report_header(deck, i, SEV_ERROR, 'KJ-9038', 'a second /BEGIN', &
            'the first one holds', findings)
         if (begin == 0) begin = i
      end do
      if (begin == 0) then
         call add_deck_finding(deck, min(1, deck%n_line), 1, header_end(deck, 1), SEV_ERROR, &
            'KJ-0573', 'the deck has no /BEGIN, so no units', 'expected: /BEGIN', findings)
         deck%version = NEWEST
         return
      end if
      call read_cards(deck, begin, cards, findings)
      call choose_version(deck, cards, findings)
      call read_units(deck, cards, findings)
   end subroutine read_begin

   !> Choose the version of the layouts
   subroutine choose_version(deck, cards, findings)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      type(finding_list_t), intent(inout) :: findings

      deck%invers = int_of(cards, 'invers')
      deck%version = deck%invers
      if (any(VERSIONS == deck%invers)) return
      deck%version = NEWEST
      if (deck%invers <= 44) then
         call report(deck, cards, 'invers', SEV_ERROR, 'KJ-9027', &
            'format versions up to 44 have '// &
            'cards of 8 columns a field, which are not supported', 'expected: 51 to 2026', &
            findings, &
            'convert the deck; a deck with fields of 10 columns may just say 2026')
         deck%readable = .false.
      else
         call report(deck, cards, 'invers', SEV_WARNING, 'KJ-9029', 'format version '// &
            str(deck%invers)//' is not known', 'read as the newest one', findings)
      end if
   end subroutine choose_version

   !> Read the two triples of /BEGIN; one that is blank is copied from the other
   subroutine read_units(deck, cards, findings)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      type(finding_list_t), intent(inout) :: findings

      integer :: i
      logical :: has_input, has_work

      call read_triple(deck, cards, '_input', deck%input, has_input, findings)
      call read_triple(deck, cards, '_work', deck%work, has_work, findings)
      if (.not. (has_input .or. has_work)) then
         call report(deck, cards, 'mass_input', SEV_ERROR, 'KJ-0574', '/BEGIN has no units', &
            'expected: units of mass, length and time', findings, 'for example kg, m, s')
      end if
      if (.not. has_input) deck%input = deck%work
      if (.not. has_work) deck%work = deck%input
      do i = 1, size(deck%factor)
         deck%factor(i) = factor_of(i, deck%input, deck%work)
      end do
      if (any(abs(deck%input%si - deck%work%si) > 0.0_wp)) then
         call report(deck, cards, 'mass_work', SEV_NOTE, 'KJ-0754', &
            'input units and work units differ', 'results are in work units', findings)
      end if
   end subroutine read_units

   !> Read three units; given = .false. when all three are blank
   subroutine read_triple(deck, cards, suffix, units, given, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: suffix    !! of the names of the fields
      type(unit_system_t), intent(inout) :: units
      logical, intent(out) :: given
      type(finding_list_t), intent(inout) :: findings

      character(len=:), allocatable :: text, name
      logical :: found
      integer :: i

      given = .false.
      do i = 1, 3
         given = given .or. len(text_of(cards, trim(QUANTITY(i))//suffix)) > 0
      end do
      if (.not. given) return
      do i = 1, 3
         name = trim(QUANTITY(i))//suffix
         text = text_of(cards, name)
         call read_unit(text, i, units%si(i), units%symbol(i), found)
         if (.not. found) call report(deck, cards, name, SEV_ERROR, 'KJ-0573', &
            'the unit of '//trim(QUANTITY(i))//' is not understood', &
            'expected: a prefix and '//'gms'(i:i)//', or the SI value, 1e-30 to 1e30', &
            findings)
      end do
   end subroutine read_triple

   !> Read all /UNIT blocks
   subroutine read_local_units(deck, findings)
      type(deck_t), intent(inout) :: deck
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      type(unit_system_t) :: units
      integer :: i, n
      logical :: given

      n = 0
      if (deck%n_block > 0) n = count(deck%block(:deck%n_block)%keyword == KW_UNIT)
      allocate (deck%unit_id(n), deck%unit(n))
      do i = 1, deck%n_block
         if (deck%block(i)%keyword /= KW_UNIT) cycle
         call read_cards(deck, i, cards, findings)
         units = deck%input
         call read_triple(deck, cards, '', units, given, findings)
         if (.not. given) call report(deck, cards, 'mass', SEV_ERROR, 'KJ-0573', &
            '/UNIT has no units', 'expected: units of mass, length and time', findings)
         if (any(deck%unit_id(:deck%n_unit) == deck%block(i)%id)) call report_header(deck, i, &
            SEV_ERROR, 'KJ-0079', '/UNIT/'//str(deck%block(i)%id)//' is defined twice', &
            'second definition', findings)
         deck%n_unit = deck%n_unit + 1
         deck%unit_id(deck%n_unit) = deck%block(i)%id
         deck%unit(deck%n_unit) = units
      end do
   end subroutine read_local_units

   !> Every unit id in a header must be defined
   subroutine check_unit_ids(deck, findings)
      type(deck_t), intent(in) :: deck
      type(finding_list_t), intent(inout) :: findings

      character(len=:), allocatable :: known
      integer :: i

      do i = 1, deck%n_block
         if (deck%block(i)%unit_id == 0 .or. deck%block(i)%keyword == KW_UNIT) cycle
         if (any(deck%unit_id(:deck%n_unit) == deck%block(i)%unit_id)) cycle
         known = trim(id_list(deck%unit_id(:deck%n_unit)))
         call report_header(deck, i, SEV_ERROR, 'KJ-0659', '/UNIT/'//str(deck%block(i)%unit_id)// &
            ' is not defined', 'the last number is the id of a /UNIT', findings, known)
      end do
   end subroutine check_unit_ids

   !> Keywords whose cards are another matter in an old format version
   subroutine check_layouts(deck, findings)
      type(deck_t), intent(inout) :: deck
      type(finding_list_t), intent(inout) :: findings

      integer :: i

      do i = 1, deck%n_block
         if (deck%block(i)%keyword == KW_KJOINT2 .and. deck%version < 2019) then
            call report_header(deck, i, SEV_ERROR, 'KJ-9028', '/PROP/KJOINT2 had other cards '// &
               'before version 2019, which are not supported', 'the deck has version '// &
               str(deck%invers), findings, 'convert the property and raise the version in /BEGIN')
            call mute_block(deck, i)
         else if (deck%block(i)%keyword == KW_INIVEL_AXIS .and. deck%version < 120) then
            call report_header(deck, i, SEV_ERROR, 'KJ-2046', '/INIVEL/AXIS needs version 120', &
               'the deck has version '//str(deck%invers), findings)
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

end module kj_deck
