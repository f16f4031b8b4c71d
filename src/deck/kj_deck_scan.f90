!> Files -> lines -> blocks. Follows #include, leaves comments out, knows the keywords.
!> One file: all of it shares what is under way: file, submodel, block.
module kj_deck_scan
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_error, only: SEV_ERROR, SEV_WARNING, add_at, str
   use kj_keywords, only: keywords, READ_IT, KW_END, KW_SUBMODEL, KW_ENDSUB
   use kj_sha256, only: sha256_t, add_text, digest_of
   use kj_spelling, only: upper
   use kj_element_cards, only: stays_in_file
   use kj_deck_text, only: deck_t, source_t, block_t, submodel_t, add_deck_finding, line_text, &
      report_line, add_line, add_source, move_source, add_block, load_source, &
      folder_of, add_file_finding, put_text, PIECE
   use kj_file_lines, only: file_lines_t, stand_at, take_next, read_piece, next_line, first_byte, &
      PIECE_SIZE
   use kj_header, only: read_heading
   implicit none
   private

   public :: scan_deck

   integer, parameter :: DEEPEST = 50           !! files that include each other
   integer, parameter :: MOST_FILES = 10000     !! of a deck
   integer(int64), parameter :: MOST_BYTES = 4_int64*2**30   !! of all of them

   !> Where the scan stands
   type :: scan_t
      logical :: in_block = .false.             !! lines belong to the last block
      logical :: title_due = .false.            !! the next line is a title
      logical :: ended = .false.                !! /END was read
      logical :: stray = .false.                !! lines without a header were reported
      integer :: severity = SEV_ERROR           !! of a keyword that is not supported
      integer :: submodel = 0                   !! index in the deck, 0 = none
      integer :: depth = 0                      !! files open
      integer :: open(DEEPEST) = 0              !! their index in the deck
      integer(int64) :: n_byte = 0              !! read so far
      logical :: full = .false.                 !! a limit of the deck was met: no more is read
      ! of a full deck
      integer(int64) :: at = 0, next = 0        !! bytes before the line under way, and with it
      logical :: far = .false.                  !! the cards of the block stay in the file
      logical :: back = .false.                 !! these must become lines after all
      logical :: engine = .false.               !! in the engine part of a deck in one file
      character(len=:), allocatable :: folder   !! of the first file: includes start there
   end type scan_t

contains

   !> Read a deck and all it includes, and find its blocks
   !>
   !> Errors: findings with code ERR_FILE when a file cannot be read, else ERR_INPUT.
   subroutine scan_deck(path, deck, given)
      character(len=*), intent(in) :: path
      type(deck_t), intent(inout) :: deck
      type(source_t), intent(inout), optional :: given   !! its text, in place of the file

      type(scan_t) :: scan
      type(source_t) :: source
      character(len=:), allocatable :: problem

      if (deck%lenient) scan%severity = SEV_WARNING
      scan%folder = folder_of(path)
      allocate (deck%source(4), deck%block(64), deck%submodel(0))
      problem = ''
      if (present(given)) call move_source(given, source)
      if (.not. present(given)) call open_source(deck, path, 'starter', source, problem)
      if (len(problem) > 0) then
         call add_file_finding('KJ-9030', 'the deck cannot be read: '//problem, path, 0, '', 0, 0, &
            deck%findings)
         deck%readable = .false.
         return
      end if
      call scan_source(source, deck, scan)
      call close_block(deck, scan)
      deck%whole = scan%ended
      if (deck%torn .and. .not. deck%whole) call report_line(deck, deck%n_line, SEV_WARNING, &
         'KJ-9069', 'the last line has no line end, and no /END follows: is the deck cut?', &
         'the last line', 'write /END behind it')
      if (scan%submodel > 0) call report_line(deck, &
         deck%block(deck%submodel(scan%submodel)%block)%header, SEV_WARNING, 'KJ-9401', &
         'the submodel has no end', 'taken to the end of the deck', 'expected: //ENDSUB')
      if (deck%full .and. deck%n_line > 0) call keep_lines_free(deck)
   end subroutine scan_deck

   !> A source with its text; of a full deck without it
   subroutine open_source(deck, path, role, source, problem)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: path, role
      type(source_t), intent(out) :: source
      character(len=:), allocatable, intent(out) :: problem

      integer(int64) :: n

      if (.not. deck%full) then
         call load_source(path, role, source, problem)
         return
      end if
      source%path = path
      source%role = role
      call read_piece(path, 0_int64, PIECE_SIZE, source%text, n, problem)   ! can it be?
      source%text = ''
   end subroutine open_source

   !> Lines for cards that stay in the file, and a source that they are copied into
   subroutine keep_lines_free(deck)
      type(deck_t), intent(inout) :: deck

      type(source_t) :: source
      integer :: i

      source%path = ''
      source%text = ''
      source%role = PIECE
      call add_source(deck, source, deck%far_source)
      do i = 1, 3
         call add_line(deck, deck%far_source, 0, 1, 0)
      end do
      deck%far_line = deck%n_line - 2
   end subroutine keep_lines_free

   !> Scan a file of a full deck, piece by piece: what is no line is not kept in memory
   recursive subroutine scan_file(deck, s, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: s                  !! index of the file
      type(scan_t), intent(inout) :: scan

      type(file_lines_t) :: lines
      type(sha256_t) :: sum
      integer(int64) :: summed
      integer :: first, last, n
      logical :: there, over

      call stand_at(lines, deck%source(s)%path, 0_int64, 0)
      scan%n_byte = scan%n_byte + lines%n_byte
      summed = 0
      over = .false.
      do
         if (s == 1 .and. summed < lines%start + len(lines%text)) then
            call add_text(sum, lines%text(int(summed - lines%start) + 1:))
            summed = lines%start + len(lines%text)
         end if
         call take_next(lines, first, last, there)
         if (.not. there) exit
         if (over) cycle                        ! what is behind the end counts for the sum alone
         scan%at = lines%start + first - 1
         scan%next = min(lines%n_byte, lines%start + lines%next - 1)
         n = deck%source(s)%used
         call put_text(lines%text(first:last), n, deck%source(s)%text)
         call take_line(deck, s, lines%number, n + 1, n + last - first + 1, scan)
         if (scan%depth == 1 .and. scan%next == lines%n_byte) deck%torn = scan%in_block .and. &
            last == len(lines%text)
         over = scan%ended .or. scan%full
         if (over .and. s > 1) exit
         if (.not. scan%back) cycle
         scan%back = .false.                    ! read these cards again, as lines
         associate (b => deck%block(deck%n_block))
            call stand_at(lines, deck%source(s)%path, b%from, b%number)
            b%n_far = 0
         end associate
      end do
      if (s == 1) deck%source(s)%digest = digest_of(sum)
      if (len(lines%problem) > 0) call add_file_finding('KJ-9030', 'the deck cannot be read: '// &
         lines%problem, deck%source(s)%path, 0, '', 0, 0, deck%findings)
   end subroutine scan_file

   !> Append a file to the deck and scan its lines
   recursive subroutine scan_source(source, deck, scan)
      type(source_t), intent(inout) :: source   !! moved into the deck
      type(deck_t), intent(inout) :: deck
      type(scan_t), intent(inout) :: scan

      integer :: s, number, first, last, next

      call add_source(deck, source, s)
      scan%depth = scan%depth + 1
      scan%open(scan%depth) = s
      scan%n_byte = scan%n_byte + len(deck%source(s)%text)
      number = 0
      first = first_byte(deck%source(s)%text)
      if (deck%full) call scan_file(deck, s, scan)
      do while (.not. deck%full .and. first <= len(deck%source(s)%text))
         number = number + 1
         call next_line(deck%source(s)%text, first, last, next)
         call take_line(deck, s, number, first, last, scan)
         if (scan%ended .or. scan%full) exit
         if (scan%depth == 1 .and. next > len(deck%source(s)%text)) deck%torn = &
            scan%in_block .and. last == len(deck%source(s)%text)
         first = next
      end do
      if (scan%depth > 1) scan%ended = .false.
      if (scan%depth > 1) scan%engine = .false.
      scan%depth = scan%depth - 1
   end subroutine scan_source

   !> Decide what a line is: comment, #include, header or card
   recursive subroutine take_line(deck, s, number, first, last, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: s                  !! index of the file
      integer, intent(in) :: number             !! of the line
      integer, intent(in) :: first, last        !! its bytes
      type(scan_t), intent(inout) :: scan

      integer :: i

      i = first
      do while (i < last)
         if (deck%source(s)%text(i:i) /= ' ') exit
         i = i + 1
      end do
      if (scan%engine) then
         scan%engine = index(deck%source(s)%text(i:last), '/END/ENGINE') /= 1
         return
      end if
      if (last >= first) then
         select case (deck%source(s)%text(i:i))
         case ('#', '$')
            if (i == first) then
               if (is_include(deck%source(s)%text(first:last))) call include_file(deck, s, number, &
                  first, last, scan)
               return
            end if
         case ('/')
            if (i == first .or. .not. scan%title_due) then
               call close_block(deck, scan)
               scan%engine = is_engine(deck%source(s)%text(i:last))
               scan%ended = scan%engine .and. deck%n_block > 0
               if (scan%engine) return          ! before the starter part, or behind it
               call add_line(deck, s, number, first, last)
               call open_block(deck, i - first, scan)
               return
            end if
         end select
      end if
      if (deck%n_block == 0 .and. last >= first) then
         if (deck%source(s)%text(first:first) == '*') then
            call refuse_stars(deck, s, number, first, last, scan)
            return
         end if
      end if
      if (scan%in_block .and. scan%far) then
         call leave_card(deck, number, index(deck%source(s)%text(first:last), '&') > 0, scan)
      else if (scan%in_block) then
         call add_line(deck, s, number, first, last)
         scan%title_due = .false.
      else if (.not. scan%stray .and. deck%source(s)%text(first:last) /= '') then
         call add_at(deck%findings, SEV_ERROR, 'KJ-9025', deck%source(s)%path, number, &
            deck%source(s)%text(first:last), 1, last - first + 1, 'a card without a header', &
            'expected: a header such as /NODE', 'an included file must hold whole blocks')
         scan%stray = .true.
      end if
   end subroutine take_line

   !> A card that stays in the file; where one names a parameter all of its block become lines
   subroutine leave_card(deck, number, named, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: number             !! of the line
      logical, intent(in) :: named
      type(scan_t), intent(inout) :: scan

      associate (b => deck%block(deck%n_block))
         if (b%n_far == 0) then
            b%from = scan%at
            b%number = number - 1
         end if
         b%n_far = b%n_far + 1
         b%to = scan%next
      end associate
      scan%back = named
      scan%far = .not. named
   end subroutine leave_card

   !> A deck whose keywords begin with *: there is no sense in going on
   subroutine refuse_stars(deck, s, number, first, last, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: s, number, first, last
      type(scan_t), intent(inout) :: scan

      character(len=:), allocatable :: text, whose

      text = deck%source(s)%text(first:last)
      whose = 'LS-DYNA or Abaqus'
      if (index(upper(text), '*KEYWORD') == 1) whose = 'LS-DYNA'
      call add_at(deck%findings, SEV_ERROR, 'KJ-9062', deck%source(s)%path, number, text, 1, &
         last - first + 1, 'this is a deck of '//whose//': kjoint reads those of Radioss', &
         'expected: /BEGIN', 'convert the deck to the Radioss block format; a joint of '// &
         '*CONSTRAINED_JOINT is a /PROP/KJOINT2 there')
      deck%readable = .false.
      scan%ended = .true.
   end subroutine refuse_stars

   !> The engine part of a deck in one file begins here
   pure logical function is_engine(text)
      character(len=*), intent(in) :: text

      is_engine = text == '/RUN' .or. index(text, '/RUN/') == 1
   end function is_engine

   !> Start a block with the last line of the deck as its header
   subroutine open_block(deck, indent, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: indent             !! blanks before the header
      type(scan_t), intent(inout) :: scan

      type(block_t) :: block
      integer :: line

      line = deck%n_line
      call read_heading(deck, line, indent, scan%severity, block)
      block%first = line + 1
      block%last = line
      scan%title_due = .true.
      if (block%row > 0) scan%title_due = keywords(block%row)%titled
      block%submodel = scan%submodel
      call add_block(deck, block)
      if (block%keyword == KW_SUBMODEL) call enter_submodel(deck, scan, block%id)
      if (block%keyword == KW_ENDSUB) call leave_submodel(deck, line, scan)
      scan%in_block = .true.
      scan%far = deck%full .and. stays_in_file(block%keyword)
      scan%stray = .false.
      if (block%keyword == KW_END) call end_deck(deck, line, scan)
   end subroutine open_block

   !> //SUBMODEL: the blocks from here on are its own
   subroutine enter_submodel(deck, scan, id)
      type(deck_t), intent(inout) :: deck
      type(scan_t), intent(inout) :: scan
      integer, intent(in) :: id

      type(submodel_t), allocatable :: longer(:)

      if (deck%n_submodel == size(deck%submodel)) then
         allocate (longer(2*deck%n_submodel + 1))
         longer(:deck%n_submodel) = deck%submodel
         call move_alloc(longer, deck%submodel)
      end if
      deck%n_submodel = deck%n_submodel + 1
      associate (s => deck%submodel(deck%n_submodel))
         s%id = id
         s%parent = scan%submodel
         s%block = deck%n_block
      end associate
      scan%submodel = deck%n_submodel
   end subroutine enter_submodel

   subroutine leave_submodel(deck, line, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line
      type(scan_t), intent(inout) :: scan

      if (scan%submodel == 0) then
         call report_line(deck, line, SEV_WARNING, 'KJ-9402', '//ENDSUB without a //SUBMODEL', &
            'ignored')
      else
         scan%submodel = deck%submodel(scan%submodel)%parent
      end if
   end subroutine leave_submodel

   !> /END: stop here; in an included file, only that file ends
   subroutine end_deck(deck, line, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: line
      type(scan_t), intent(inout) :: scan

      scan%ended = .true.
      scan%in_block = .false.
      if (scan%depth > 1) call report_line(deck, line, SEV_WARNING, 'KJ-9034', &
         '/END in an included file', 'ends this file, not the deck')
   end subroutine end_deck

   !> End the block under way, and look whether its title is a card
   subroutine close_block(deck, scan)
      type(deck_t), intent(inout) :: deck
      type(scan_t), intent(inout) :: scan

      character(len=:), allocatable :: title

      if (.not. scan%in_block) return
      scan%in_block = .false.
      scan%title_due = .false.
      associate (b => deck%block(deck%n_block))
         b%last = deck%n_line
         if (b%row == 0 .or. b%first > b%last) return
         if (.not. keywords(b%row)%titled .or. keywords(b%row)%status /= READ_IT) return
         title = line_text(deck, b%first)
         if (len_trim(title) < 10 .or. verify(title, ' 0123456789+-.eE') > 0) return
         if (title(1:1) /= ' ') return
         call add_deck_finding(deck, b%first, 1, len_trim(title), SEV_WARNING, 'KJ-9016', &
            'the title looks like a card', 'taken as the title', &
            'the line after the header is always the title')
      end associate
   end subroutine close_block

   !> The line is #include and a file name
   pure logical function is_include(text)
      character(len=*), intent(in) :: text

      is_include = .false.
      if (len(text) < 9) return
      is_include = upper(text(:8)) == '#INCLUDE' .and. index(' '//achar(9), text(9:9)) > 0
   end function is_include

   !> Scan an included file; it ends the block under way
   recursive subroutine include_file(deck, s, number, first, last, scan)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: s, number, first, last
      type(scan_t), intent(inout) :: scan

      type(source_t) :: source
      character(len=:), allocatable :: text, name, path, problem
      integer :: i, n

      call close_block(deck, scan)
      text = deck%source(s)%text(first:last)
      name = trim(adjustl(text(9:)))
      n = len_trim(text)
      path = scan%folder//name
      if (index(name, '/') == 1) path = name
      do i = 1, scan%depth
         if (deck%source(scan%open(i))%path /= path) cycle
         call add_at(deck%findings, SEV_ERROR, 'KJ-9033', deck%source(s)%path, number, text, &
            n - len(name) + 1, n, 'the file includes itself', 'this file')
         return
      end do
      problem = ''
      if (scan%depth == DEEPEST) problem = 'more than 50 files include each other'
      if (deck%n_source == MOST_FILES) problem = 'the deck includes more than '//str(MOST_FILES)// &
         ' files'
      if (scan%n_byte > MOST_BYTES) problem = 'the deck is of more than 4 GiB'
      if (len(problem) == 0) call open_source(deck, path, 'include', source, problem)
      if (len(problem) > 0) then
         call add_file_finding('KJ-9031', 'the included file cannot be read: '//problem, &
            deck%source(s)%path, number, text, n - len(name) + 1, n, deck%findings)
         if (deck%n_source == MOST_FILES .or. scan%n_byte > MOST_BYTES) scan%full = .true.
         return
      end if
      call scan_source(source, deck, scan)
      call close_block(deck, scan)
   end subroutine include_file

end module kj_deck_scan
