!> Requests for histories: names of variables, then objects.
module kj_cards_th
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING
   use kj_keywords, only: KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, KW_TH_PART
   use kj_spelling, only: upper
   use kj_deck_text, only: deck_t, add_deck_finding, report_header, title_line, line_text
   use kj_card_cut, only: cut_t, cut_card
   use kj_card_values, only: read_integer_at, report_cut
   use kj_cards_ids, only: ids_t, read_id_lines, add_id
   implicit none
   private

   public :: th_t, read_th

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

   integer, parameter :: FIRST_COLUMN(10) = [1, 11, 21, 31, 41, 51, 61, 71, 81, 91]

contains

   !> Read a request: names up to the first card with a number, then objects
   !>
   !> Names that do not exist are findings and left out; so is an object 0 of NODE and SPRING.
   subroutine read_th(deck, block, th, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block              !! index, 1 to n_block
      type(th_t), intent(out) :: th
      type(finding_list_t), intent(inout) :: findings

      integer :: line, keyword

      keyword = deck%block(block)%keyword
      line = deck%block(block)%first
      if (title_line(deck, block) > 0) line = line + 1
      allocate (th%variable(0), th%skew(0))
      do while (line <= deck%block(block)%last)
         if (begins_with_number(line_text(deck, line))) exit
         call read_names(deck, keyword, line, th%variable, findings)
         line = line + 1
      end do
      if (size(th%variable) == 0) call report_header(deck, block, SEV_ERROR, 'KJ-1109', &
         'the request has no variable that exists', 'expected: names such as DEF', findings)
      if (keyword == KW_TH_NODE .or. keyword == KW_TH_SPRING) then
         call read_objects(deck, line, deck%block(block)%last, keyword == KW_TH_NODE, th, findings)
      else
         if (line <= deck%block(block)%last) th%all = first_is_zero(line_text(deck, line))
         call read_id_lines(deck, line, deck%block(block)%last, 10, 1, th%object, findings)
         deallocate (th%skew)
         allocate (th%skew(th%object%n), source=0)
      end if
   end subroutine read_th

   !> Read the names on one card
   subroutine read_names(deck, keyword, line, variable, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: keyword, line
      character(len=10), allocatable, intent(inout) :: variable(:)
      type(finding_list_t), intent(inout) :: findings

      type(cut_t) :: cut
      character(len=:), allocatable :: text, name
      integer :: k, row

      text = line_text(deck, line)
      call cut_card(text, 10, FIRST_COLUMN, FIRST_COLUMN + 9, cut)
      call report_cut(deck, line, cut, findings)
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
            trim(adjustl(th_names(row)%names)), findings)
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
   subroutine report_name(deck, keyword, line, first, last, name, known, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: keyword, line, first, last
      character(len=*), intent(in) :: name, known
      type(finding_list_t), intent(inout) :: findings

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
         call add_deck_finding(deck, line, first, last, SEV_ERROR, 'KJ-0551', &
            'ALL is obsolete', 'expected: names such as DEF', findings, hint)
         return
      end if
      if (upper(name) /= name) hint = 'names are in upper case'
      if (index(name, ' ') > 0) hint = 'one name in each field of ten columns'
      call add_deck_finding(deck, line, first, last, severity, 'KJ-0260', &
         name//' is no variable of '//object, 'unknown name', findings, hint)
   end subroutine report_name

   !> Read a list of objects, one a card: id, and for nodes the axes
   subroutine read_objects(deck, start, end, with_skew, th, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: start, end         !! lines, index in deck
      logical, intent(in) :: with_skew          !! columns 11 to 20 are the axes
      type(th_t), intent(inout) :: th
      type(finding_list_t), intent(inout) :: findings

      type(cut_t) :: cut
      integer :: line, id, n
      integer, allocatable :: skew(:)

      call read_id_lines(deck, 1, 0, 10, 1, th%object, findings)     ! an empty list
      allocate (skew(max(0, end - start + 1)))
      skew = 0
      n = 0
      do line = start, end
         call cut_card(line_text(deck, line), 3, [1, 11, 21], [10, 20, 100], cut)
         cut%extra_last = 0
         call report_cut(deck, line, cut, findings)
         call read_integer_at(deck, line, cut%first(1), cut%last(1), 'the id', 'an id', id, &
            findings)
         if (id == 0) then
            call add_deck_finding(deck, line, 1, 10, SEV_ERROR, merge('KJ-0078', 'KJ-0069', &
               with_skew), 'the card asks for the id 0', 'expected: an id', findings, &
               'remove the card')
            cycle
         end if
         call add_id(th%object, id, line, cut%first(1), cut%last(1))
         n = n + 1
         if (with_skew) call read_integer_at(deck, line, cut%first(2), cut%last(2), 'skew_id', &
            'axes of the components', skew(n), findings)
         if (with_skew) call add_id(th%axes, skew(n), line, cut%first(2), cut%last(2))
      end do
      th%skew = skew(:n)
   end subroutine read_objects

   !> The first thing on a card is a number
   pure logical function begins_with_number(text) result(is_number)
      character(len=*), intent(in) :: text

      integer :: i

      i = verify(text, ' +-,'//achar(9))
      is_number = .false.
      if (i > 0) is_number = index('0123456789', text(i:i)) > 0
   end function begins_with_number

   !> The first field of ten columns is the number 0
   pure logical function first_is_zero(text) result(is_zero)
      character(len=*), intent(in) :: text

      character(len=10) :: field

      field = text
      if (index(field, ',') > 0) field = field(:index(field, ',') - 1)
      is_zero = adjustl(field) == '0'
   end function first_is_zero

end module kj_cards_th
