!> What an engine deck does to nodes at the start: /BCS, /BCSR, /INIV.
!>
!> Source: the keywords as the public reference guide of Radioss lists them; docs/theory/full.md 6.
module kj_engine_nodes
   use kj_kinds, only: wp
   use kj_error, only: SEV_ERROR, SEV_WARNING, SEV_NOTE
   use kj_sort, only: lookup_t, find
   use kj_number, only: parse_integer, NUMBER_FINE
   use kj_deck_text, only: deck_t, line_text, place_of, report_line, add_deck_finding
   use kj_engine_text, only: engine_line_t, split_words, next_item, read_values, word_integer
   implicit none
   private

   public :: node_act_t, take_node_act, keep_known

   !> How the nodes are named
   integer, parameter, public :: BY_NODES = 0, BY_RANGES = 1, BY_GROUP = 2

   !> One of them
   type :: node_act_t
      character(len=80) :: what = ''             !! BCS, BCSR, INIV
      logical :: dof(6) = .false.                !! which directions
      integer :: axis = 0                        !! of /INIV/AXIS: 1, 2 or 3
      integer :: axes = 0                        !! id of a skew, or of a frame; 0 = global
      real(wp) :: v(4) = 0.0_wp                  !! velocity; of AXIS Vxt, Vyt, Vzt, Vr
      integer :: by = BY_NODES
      integer, allocatable :: id(:)
      ! its header, for findings
      character(len=:), allocatable :: file, text
      integer :: line = 0
   end type node_act_t

contains

   !> Read one; known = .false.: of a kind that does nothing here, or is not known (then reported)
   subroutine take_node_act(deck, words, header, last, severity, act, known)
      type(deck_t), intent(inout) :: deck
      type(engine_line_t), intent(in) :: words
      integer, intent(in) :: header, last        !! lines
      integer, intent(in) :: severity            !! of a kind that is not known
      type(node_act_t), intent(out) :: act
      logical, intent(out) :: known

      character(len=3), parameter :: LETTERS = 'XYZ'
      real(wp) :: value(4)
      integer :: i, shift, n

      act%what = words%word(1)
      act%text = line_text(deck, header)
      call place_of(deck, header, act%file, act%line)
      known = any(words%word(2)(:4) == ['TRA ', 'ROT ', 'AXIS']) .and. &
         verify(trim(words%word(3)), LETTERS) == 0 .and. words%word(3) /= ''
      if (words%word(2) == 'AXIS') known = known .and. act%what == 'INIV' .and. &
         len_trim(words%word(3)) == 1
      if (any(words%word(2)(:4) == ['ALE ', 'LAG ']) .and. act%what /= 'INIV') then
         call report_line(deck, header, SEV_NOTE, 'KJ-9023', act%text//' has no effect here', &
            'of nodes that fluids use')
         return
      else if (.not. known) then
         call report_line(deck, header, severity, 'KJ-9022', act%text//' is not supported', &
            'expected: TRA or ROT and directions, or /INIV/AXIS and one')
         return
      end if
      shift = merge(3, 0, words%word(2) == 'ROT')
      do i = 1, 3
         act%dof(i + shift) = index(words%word(3), LETTERS(i:i)) > 0
      end do
      n = 0                                      ! lines before the nodes
      if (act%what == 'BCS') act%axes = word_integer(deck, header, words, 4)
      if (act%what == 'INIV') then
         act%by = word_integer(deck, header, words, 4)
         n = 1
         if (words%word(2) == 'AXIS') then
            n = 2
            act%axis = index(LETTERS, words%word(3)(:1))
            call read_values(deck, header, last, 1, 1, value)
            act%axes = nint(max(-1.0e9_wp, min(1.0e9_wp, value(1))))
            if (last > header) call read_values(deck, header + 1, last, 4, 4, act%v)
         else
            call read_values(deck, header, last, 1, 1, act%v)
         end if
      end if
      call read_ids(deck, header + n + 1, last, act%id)
      known = size(act%id) > 0
      if (.not. known) call report_line(deck, header, SEV_WARNING, 'KJ-9152', act%text// &
         ' names no node', 'has no effect')
   end subroutine take_node_act

   !> All integers on some lines
   subroutine read_ids(deck, first, last, ids)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: first, last         !! lines
      integer, allocatable, intent(out) :: ids(:)

      character(len=:), allocatable :: text
      integer :: line, at, a, b, id, status

      allocate (ids(0))
      do line = first, last
         text = line_text(deck, line)
         at = 1
         do
            call next_item(text, at, a, b)
            if (a == 0) exit
            call parse_integer(text(a:b), id, status)
            if (status == NUMBER_FINE) ids = [ids, id]
            if (status /= NUMBER_FINE) call add_deck_finding(deck, line, a, b, SEV_ERROR, &
               'KJ-9002', text(a:b)//' is not an integer', 'expected: a node')
         end do
      end do
   end subroutine read_ids

   !> Blank out the nodes that a mechanism lacks; some = .false.: none is left
   subroutine keep_known(deck, header, last, nodes, some)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: header, last        !! lines
      type(lookup_t), intent(in) :: nodes        !! of the mechanism
      logical, intent(out) :: some

      type(engine_line_t) :: words
      character(len=:), allocatable :: text
      integer :: line, first, at, a, b, id, status

      call split_words(adjustl(line_text(deck, header)), words)
      some = words%word(1) == 'INIV' .and. words%word(4) /= ''   ! ranges, a group: as they are
      if (some) return
      first = header + 1
      if (words%word(1) == 'INIV') first = merge(header + 3, header + 2, words%word(2) == 'AXIS')
      do line = first, last
         text = line_text(deck, line)
         at = 1
         do
            call next_item(text, at, a, b)
            if (a == 0) exit
            call parse_integer(text(a:b), id, status)
            if (status /= NUMBER_FINE) cycle
            some = some .or. find(nodes, id) > 0
            associate (start => deck%line_first(line) - 1)
               if (find(nodes, id) == 0) deck%source(1)%text(start + a:start + b) = ' '
            end associate
         end do
      end do
   end subroutine keep_known

end module kj_engine_nodes
