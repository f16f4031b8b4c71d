!> Lines of a file, which is in memory piece by piece.
module kj_file_lines
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_system, only: file_kind, KIND_FOLDER, KIND_OTHER
   implicit none
   private

   public :: file_lines_t, stand_at, take_next, read_piece, next_line, first_byte

   integer, parameter, public :: PIECE_SIZE = 2**18   !! bytes of a piece

   !> Where a reader of lines stands
   type :: file_lines_t
      character(len=:), allocatable :: path
      character(len=:), allocatable :: text      !! the piece
      integer(int64) :: start = 0                !! bytes of the file before it
      integer(int64) :: n_byte = 0               !! of the file
      integer :: next = 1                        !! first byte of the next line, in the piece
      integer :: number = 0                      !! of the last line
      character(len=:), allocatable :: problem   !! why the file cannot be read, '' = it can
   end type file_lines_t

contains

   !> Stand before a line; no byte is read anew that the piece has
   subroutine stand_at(lines, path, start, number)
      type(file_lines_t), intent(inout) :: lines
      character(len=*), intent(in) :: path
      integer(int64), intent(in) :: start        !! bytes before it
      integer, intent(in) :: number              !! of the line before it

      lines%number = number
      if (allocated(lines%path)) then
         if (lines%path == path .and. start >= lines%start .and. start <= lines%start + &
            len(lines%text)) then
            lines%next = int(start - lines%start) + 1
            return
         end if
      end if
      lines%path = path
      lines%start = start
      call read_piece(path, start, PIECE_SIZE, lines%text, lines%n_byte, lines%problem)
      lines%next = 1
      if (start == 0) lines%next = first_byte(lines%text)
   end subroutine stand_at

   !> The next line: bytes first to last of the piece; there = .false. at the end of the file
   subroutine take_next(lines, first, last, there)
      type(file_lines_t), intent(inout) :: lines
      integer, intent(out) :: first, last
      logical, intent(out) :: there

      integer :: next, n

      do
         first = lines%next
         last = 0
         there = lines%start + first <= lines%n_byte .and. len(lines%problem) == 0
         if (.not. there) return
         call next_line(lines%text, first, last, next)
         n = len(lines%text)
         if (next <= n + 1 .or. lines%start + n >= lines%n_byte) exit
         lines%start = lines%start + first - 1   ! its end is in the next piece
         lines%next = 1
         call read_piece(lines%path, lines%start, max(PIECE_SIZE, 2*(n - first + 1)), lines%text, &
            lines%n_byte, lines%problem)
      end do
      lines%next = next
      lines%number = lines%number + 1
   end subroutine take_next

   !> Read some bytes of a file; `problem` is '' when that went well.
   !>
   !> One thread at a time: a Fortran program cannot have a file open twice.
   subroutine read_piece(path, start, most, text, n_byte, problem)
      character(len=*), intent(in) :: path
      integer(int64), intent(in) :: start       !! bytes before them
      integer, intent(in) :: most               !! of them; fewer where the file ends
      character(len=:), allocatable, intent(out) :: text
      integer(int64), intent(out) :: n_byte     !! of the file
      character(len=:), allocatable, intent(out) :: problem

      text = ''
      problem = ''
      n_byte = 0
      if (any(file_kind(path) == [KIND_FOLDER, KIND_OTHER])) then
         problem = 'it is no regular file'
         if (file_kind(path) == KIND_FOLDER) problem = 'it is a folder'
         return
      end if
      !$omp critical (kj_source_file)
      call read_bytes(path, start, most, text, n_byte, problem)
      !$omp end critical (kj_source_file)
      if (start == 0 .and. problem == '') call judge_text(text, problem)
      if (problem /= '') text = ''
   end subroutine read_piece

   !> What is no text that can be read as lines
   pure subroutine judge_text(text, problem)
      character(len=*), intent(in) :: text
      character(len=:), allocatable, intent(inout) :: problem

      integer :: n

      if (len(text) < 4) return
      n = min(len(text), 100000)                 ! decks may be large
      if (any(text(:2) == [char(255)//char(254), char(254)//char(255)]) .or. &
         (text(:1) > char(0) .and. text(2:2) == char(0) .and. text(4:4) == char(0))) then
         problem = 'it is UTF-16: save it as UTF-8'
      else if (text(:2) == char(31)//char(139)) then
         problem = 'it is packed by gzip'
      else if (index(text(:n), char(13)) > 0 .and. index(text(:n), char(10)) == 0) then
         problem = 'its lines end in CR: save it with LF or CR LF'
      end if
   end subroutine judge_text

   !> Where the lines of a text begin: behind a byte order mark
   pure integer function first_byte(text) result(first)
      character(len=*), intent(in) :: text

      first = 1
      if (text(:min(3, len(text))) == char(239)//char(187)//char(191)) first = 4
   end function first_byte

   subroutine read_bytes(path, start, most, text, n_byte, problem)
      character(len=*), intent(in) :: path
      integer(int64), intent(in) :: start
      integer, intent(in) :: most
      character(len=:), allocatable, intent(inout) :: text, problem
      integer(int64), intent(out) :: n_byte

      character(len=200) :: message
      character(len=1) :: byte
      integer(int64) :: n
      integer :: unit, stat

      message = ''
      open (newunit=unit, file=path, access='stream', form='unformatted', action='read', &
         status='old', iostat=stat, iomsg=message)
      if (stat /= 0) then
         problem = trim(message)
         if (problem == '') problem = 'cannot be opened'
         return
      end if
      inquire (unit=unit, size=n_byte)
      if (n_byte < 0 .or. n_byte >= int(huge(stat), int64)) then
         problem = 'has no size, or is of 2 GiB and more'
      else if (n_byte > 0) then
         n = max(0_int64, min(n_byte - start, int(most, int64)))
         deallocate (text)
         allocate (character(len=n) :: text, stat=stat)
         if (stat == 0 .and. n > 0) read (unit, pos=start + 1, iostat=stat, iomsg=message) text
         if (stat /= 0) problem = 'cannot be read: '//trim(message)
         if (stat /= 0) text = ''
      else
         read (unit, iostat=stat) byte          ! those of /proc have no size, but bytes
         if (stat == 0) problem = 'it is no regular file'
      end if
      close (unit, iostat=stat)
      if (stat /= 0) problem = 'cannot be closed'
   end subroutine read_bytes

   !> Find the end of the line that begins at byte `first`
   pure subroutine next_line(text, first, last, next)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first
      integer, intent(out) :: last              !! its last byte, line feed and return left out
      integer, intent(out) :: next              !! first byte of the next line

      character(len=1), parameter :: FEED = achar(10), RETURN = achar(13)
      integer :: i

      do i = first, len(text)
         if (text(i:i) == FEED) exit
      end do
      next = i + 1
      last = i - 1
      if (last >= first) then
         if (text(last:last) == RETURN) last = last - 1
      end if
   end subroutine next_line

end module kj_file_lines
