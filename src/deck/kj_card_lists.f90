!> Lists of ids, ten columns each, to the end of a block; the clauses of sets; requests for
!> histories: names of variables, then objects.
module kj_card_lists
   use kj_error, only: SEV_WARNING, SEV_ERROR
   use kj_card_fields, only: IDS, PAIRS, TRIPLES, fields
   use kj_deck_text, only: deck_t, add_deck_finding, first_card, lengthen, report_header, line_text
   use kj_card_cut, only: cut_t, cut_card, begins_with_number, read_integer_at, report_cut
   use kj_keywords, only: KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, KW_TH_PART
   use kj_spelling, only: upper
   implicit none
   private

   public :: ids_t, clauses_t, read_ids, read_id_lines, read_clauses, report_id, th_t, read_th

   integer, parameter :: WIDTH = 10             !! columns of an id
   integer, parameter :: FIRST_COLUMN(10) = [1, 11, 21, 31, 41, 51, 61, 71, 81, 91]

   !> Ids of a block and where they stand
   type :: ids_t
      integer :: n = 0
      integer, allocatable :: value(:)          !! (>= n) allocated, if a reader made the list
      integer, allocatable :: line(:)           !! (>= n) index in deck
      integer, allocatable :: first(:), last(:) !! (>= n) columns
   end type ids_t

   !> The clauses of a /SET: clause k has the ids from(k) to to(k)
   type :: clauses_t
      integer :: n = 0
      character(len=10), allocatable :: word(:) !! (>= n) NODE, PART, ...
      integer, allocatable :: line(:)           !! (>= n) index in deck of the word
      integer, allocatable :: from(:), to(:)    !! (>= n) in `ids`
      type(ids_t) :: ids
   end type clauses_t

   !> A request for histories
   type :: th_t
      character(len=10), allocatable :: variable(:)   !! names that exist, DEF and the like too
      type(ids_t) :: object                     !! ids of nodes, springs, bodies or parts
      integer, allocatable :: skew(:)           !! (object%n) axes of the components, NODE only
      type(ids_t) :: axes                       !! the same with its places, NODE only
      logical :: all = .false.                  !! RBODY, PART: a first id 0 asks for all
   end type th_t

   !> Names of a kind of object
   type :: th_names_t
      integer            :: keyword             !! KW_ constant
      character(len=250) :: names               !! between blanks
   end type th_names_t

   type(th_names_t), parameter :: th_names(4) = [ &
      th_names_t(KW_TH_NODE, &
         ' DEF DX DY DZ VX VY VZ AX AY AZ VRX VRY VRZ ARX ARY ARZ X Y Z TEMP D V A VR AR XYZ &
         &DRX DRY DRZ DR REACX REACY REACZ REACXX REACYY REACZZ PEXT '), &
      th_names_t(KW_TH_SPRING, &
         ' DEF OFF FX FY FZ MX MY MZ LX LY LZ RX RY RZ IE F1 F2 LENGTH FAIL '), &
      th_names_t(KW_TH_RBODY, &
         ' DEF FX FY FZ MX MY MZ RX RY RZ FXI FYI FZI MXI MYI MZI X Y Z DX DY DZ VX VY VZ AX AY AZ &
         &VRX VRY VRZ ARX ARY ARZ MASS IXX IYY IZZ IXY IYZ IZX STATUS F M R FI MI D XYZ V A '), &
      th_names_t(KW_TH_PART, &
         ' DEF IE KE XMOM YMOM ZMOM MASS HE TURBKE XCG YCG ZCG XXMOM YYMOM ZZMOM IXX IYY IZZ IXY &
         &IYZ IZX RIE KERB RKERB RKE ERODED HEAT VX VY VZ PW ')]

contains

   !> Read the ids of a block; blanks and zeros are left out, negative ids are kept
   !>
   !> Pairs and triples stay together: of them only those are left out that are zero as a whole.
   subroutine read_ids(deck, block, list)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(ids_t), intent(out) :: list

      integer :: i, together, on_card

      together = 1
      on_card = 10
      associate (b => deck%block(block))
         if (b%keyword > 0) then
            do i = deck%field_first(b%keyword), deck%field_last(b%keyword)
               if (fields(i)%times < IDS .or. fields(i)%times > TRIPLES) cycle
               on_card = fields(i)%last/WIDTH
               if (fields(i)%times == PAIRS) together = 2
               if (fields(i)%times == TRIPLES) together = 3
            end do
         end if
         call read_id_lines(deck, first_card(deck, block), b%last, on_card, together, list)
      end associate
   end subroutine read_ids

   !> Read ids from some lines
   subroutine read_id_lines(deck, start, end, on_card, together, list)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: start, end         !! lines, index in deck
      integer, intent(in) :: on_card            !! ids on a card, at most 10
      integer, intent(in) :: together           !! ids that belong together
      type(ids_t), intent(inout) :: list

      type(cut_t) :: cut
      integer :: line, source, k, j, value(10)

      call prepare(list)
      do line = start, end
         source = deck%line_source(line)
         call cut_card(deck%source(source)%text(deck%line_first(line):deck%line_last(line)), &
            on_card, FIRST_COLUMN(:on_card), FIRST_COLUMN(:on_card) + WIDTH - 1, cut)
         call report_cut(deck, line, cut)
         do k = 1, on_card
            call read_integer_at(deck, line, cut%first(k), cut%last(k), 'the id', &
               'an id of at most ten columns', value(k))
         end do
         do k = 1, on_card - together + 1, together
            if (all(value(k:k + together - 1) == 0)) cycle
            do j = k, k + together - 1
               call add_id(list, value(j), line, max(1, cut%first(j)), &
                  max(1, cut%first(j), cut%last(j)))
            end do
         end do
      end do
   end subroutine read_id_lines

   !> Make a list an empty one, ready for use, if it is not so yet
   subroutine prepare(list)
      type(ids_t), intent(inout) :: list

      if (allocated(list%value)) return
      allocate (list%value(16), list%line(16), list%first(16), list%last(16))
   end subroutine prepare

   !> Append an id with its place
   subroutine add_id(list, value, line, first, last)
      type(ids_t), intent(inout) :: list
      integer, intent(in) :: value
      integer, intent(in) :: line               !! index in deck
      integer, intent(in) :: first, last        !! columns

      call prepare(list)
      if (list%n == size(list%value)) then
         call lengthen(list%value)
         call lengthen(list%line)
         call lengthen(list%first)
         call lengthen(list%last)
      end if
      list%n = list%n + 1
      list%value(list%n) = value
      list%line(list%n) = line
      list%first(list%n) = first
      list%last(list%n) = last
   end subroutine add_id

   !> Read the clauses of a /SET; a blank word goes on with the clause before
   subroutine read_clauses(deck, block, clauses)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(clauses_t), intent(out) :: clauses

      type(cut_t) :: cut
      integer :: line, k, start, n, value, offset, source

      call prepare(clauses%ids)
      start = first_card(deck, block)
      n = max(1, deck%block(block)%last - start + 1)
      allocate (clauses%word(n), clauses%line(n), clauses%from(n), clauses%to(n))
      do line = start, deck%block(block)%last
         source = deck%line_source(line)
         offset = deck%line_first(line) - 1
         call cut_card(deck%source(source)%text(offset + 1:deck%line_last(line)), 10, &
            FIRST_COLUMN, FIRST_COLUMN + WIDTH - 1, cut)
         call report_cut(deck, line, cut)
         if (cut%last(1) >= cut%first(1)) then
            clauses%n = clauses%n + 1
            n = clauses%n
            clauses%word(n) = deck%source(source)%text(offset + cut%first(1):offset + cut%last(1))
            clauses%line(n) = line
            clauses%from(n) = clauses%ids%n + 1
            clauses%to(n) = clauses%ids%n
         else if (clauses%n == 0) then
            if (any(cut%last >= cut%first)) call add_deck_finding(deck, line, 1, WIDTH, &
               SEV_WARNING, 'KJ-9014', 'ids before the first clause', 'ignored')
            cycle
         end if
         do k = 2, 10
            call read_integer_at(deck, line, cut%first(k), cut%last(k), 'the id', &
               'an id of at most ten columns', value)
            if (value == 0) cycle
            call add_id(clauses%ids, value, line, cut%first(k), cut%last(k))
         end do
         clauses%to(clauses%n) = clauses%ids%n
      end do
   end subroutine read_clauses

   !> Append a finding that points at an id
   subroutine report_id(deck, list, k, severity, id, message, label, hint)
      type(deck_t), intent(inout) :: deck
      type(ids_t), intent(in) :: list
      integer, intent(in) :: k                  !! 1 to list%n
      integer, intent(in) :: severity           !! SEV_ constant
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      call add_deck_finding(deck, list%line(k), list%first(k), list%last(k), severity, id, &
         message, label, hint)
   end subroutine report_id

   !> Read a request: names up to the first card with a number, then objects
   !>
   !> Names that do not exist are findings and left out; so is an object 0 of NODE and SPRING.
   subroutine read_th(deck, block, th)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(th_t), intent(out) :: th

      character(len=10) :: field
      integer :: line, keyword

      keyword = deck%block(block)%keyword
      line = first_card(deck, block)
      allocate (th%variable(0), th%skew(0))
      do while (line <= deck%block(block)%last)
         if (begins_with_number(line_text(deck, line))) exit
         call read_names(deck, keyword, line, th%variable)
         line = line + 1
      end do
      if (size(th%variable) == 0) call report_header(deck, block, SEV_ERROR, 'KJ-1109', &
         'the request has no variable that exists', 'expected: names such as DEF')
      if (keyword == KW_TH_NODE .or. keyword == KW_TH_SPRING) then
         call read_objects(deck, line, deck%block(block)%last, keyword == KW_TH_NODE, th)
      else
         if (line <= deck%block(block)%last) then   ! the first field of ten columns
            field = line_text(deck, line)
            if (index(field, ',') > 0) field = field(:index(field, ',') - 1)
            th%all = adjustl(field) == '0'
         end if
         call read_id_lines(deck, line, deck%block(block)%last, 10, 1, th%object)
         deallocate (th%skew)
         allocate (th%skew(th%object%n), source=0)
      end if
   end subroutine read_th

   !> Read the names on one card
   subroutine read_names(deck, keyword, line, variable)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: keyword, line
      character(len=10), allocatable, intent(inout) :: variable(:)

      type(cut_t) :: cut
      character(len=:), allocatable :: text, name
      integer :: k, row

      text = line_text(deck, line)
      call cut_card(text, 10, FIRST_COLUMN, FIRST_COLUMN + 9, cut)
      call report_cut(deck, line, cut)
      row = 1
      do k = 1, size(th_names)
         if (th_names(k)%keyword == keyword) row = k
      end do
      do k = 1, 10
         if (cut%last(k) < cut%first(k)) cycle
         name = text(cut%first(k):cut%last(k))
         if (index(th_names(row)%names, ' '//name//' ') > 0 .and. index(name, ' ') == 0) then
            if (all(variable /= name)) call append(variable, name)
            cycle
         end if
         call report_name(deck, keyword, line, cut%first(k), cut%last(k), name, &
            trim(adjustl(th_names(row)%names)))
      end do
   end subroutine read_names

   !> Append a name to the list
   subroutine append(variable, name)
      character(len=10), allocatable, intent(inout) :: variable(:)
      character(len=*), intent(in) :: name

      character(len=10), allocatable :: longer(:)

      allocate (longer(size(variable) + 1))
      longer(:size(variable)) = variable
      longer(size(longer)) = name
      call move_alloc(longer, variable)
   end subroutine append

   !> The finding of a name that does not exist
   subroutine report_name(deck, keyword, line, first, last, name, known)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: keyword, line, first, last
      character(len=*), intent(in) :: name, known

      character(len=:), allocatable :: object, hint
      integer :: severity

      ! The names of parts are not all known here, and no history of parts is written.
      severity = merge(SEV_WARNING, SEV_ERROR, keyword == KW_TH_PART)
      object = ''
      if (keyword == KW_TH_NODE) object = 'nodes'
      if (keyword == KW_TH_SPRING) object = 'springs'
      if (keyword == KW_TH_RBODY) object = 'rigid bodies'
      if (keyword == KW_TH_PART) object = 'parts'
      hint = 'names: '//known
      if (name == 'ALL') then
         call add_deck_finding(deck, line, first, last, SEV_ERROR, 'KJ-0551', 'ALL is obsolete', &
            'expected: names such as DEF', hint)
         return
      end if
      if (upper(name) /= name) hint = 'names are in upper case'
      if (index(name, ' ') > 0) hint = 'one name in each field of ten columns'
      call add_deck_finding(deck, line, first, last, severity, 'KJ-0260', name// &
         ' is no variable of '//object, 'unknown name', hint)
   end subroutine report_name

   !> Read a list of objects, one a card: id, and for nodes the axes
   subroutine read_objects(deck, start, end, with_skew, th)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: start, end         !! lines, index in deck
      logical, intent(in) :: with_skew          !! columns 11 to 20 are the axes
      type(th_t), intent(inout) :: th

      type(cut_t) :: cut
      integer :: line, id, n
      integer, allocatable :: skew(:)

      call read_id_lines(deck, 1, 0, 10, 1, th%object)
      allocate (skew(max(0, end - start + 1)))
      skew = 0
      n = 0
      do line = start, end
         call cut_card(line_text(deck, line), 3, [1, 11, 21], [10, 20, 100], cut)
         cut%extra_last = 0
         call report_cut(deck, line, cut)
         call read_integer_at(deck, line, cut%first(1), cut%last(1), 'the id', 'an id', id)
         if (id == 0) then
            call add_deck_finding(deck, line, 1, 10, SEV_ERROR, merge('KJ-0078', 'KJ-0069', &
               with_skew), 'the card asks for the id 0', 'expected: an id', 'remove the card')
            cycle
         end if
         call add_id(th%object, id, line, cut%first(1), cut%last(1))
         n = n + 1
         if (with_skew) call read_integer_at(deck, line, cut%first(2), cut%last(2), 'skew_id', &
            'axes of the components', skew(n))
         if (with_skew) call add_id(th%axes, skew(n), line, cut%first(2), cut%last(2))
      end do
      th%skew = skew(:n)
   end subroutine read_objects

end module kj_card_lists
