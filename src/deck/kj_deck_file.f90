!> Files: one read for the whole of it, and line by line from there.
module kj_deck_file
   use kj_error, only: error_t, finding_list_t, fail, fail_at, add_finding, ERR_FILE
   use kj_deck_text, only: source_t
   implicit none
   private

   public :: load_source, next_line, folder_of, add_file_finding

contains

   !> Read a whole file; `problem` is '' when that went well.
   !>
   !> One thread at a time: a Fortran program cannot have a file open twice.
   subroutine load_source(path, role, source, problem)
      character(len=*), intent(in) :: path, role
      type(source_t), intent(out) :: source
      character(len=:), allocatable, intent(out) :: problem

      source%path = path
      source%role = role
      !$omp critical (kj_source_file)
      call read_file(path, source%text, problem)
      !$omp end critical (kj_source_file)
   end subroutine load_source

   subroutine read_file(path, text, problem)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text, problem

      integer, parameter :: long = selected_int_kind(18)
      character(len=200) :: message
      integer(long) :: n
      integer :: unit, stat

      text = ''
      problem = ''
      message = ''
      open (newunit=unit, file=path, access='stream', form='unformatted', action='read', &
         status='old', iostat=stat, iomsg=message)
      if (stat /= 0) then
         problem = trim(message)
         if (problem == '') problem = 'cannot be opened'
         return
      end if
      inquire (unit=unit, size=n)
      if (n < 0 .or. n >= int(huge(stat), long)) then
         problem = 'has no size, or is of 2 GiB and more'
      else if (n > 0) then
         deallocate (text)
         allocate (character(len=n) :: text, stat=stat)
         if (stat == 0) read (unit, iostat=stat, iomsg=message) text
         if (stat /= 0) problem = 'cannot be read: '//trim(message)
         if (stat /= 0) text = ''
      end if
      close (unit, iostat=stat)
      if (stat /= 0) problem = 'cannot be closed'
   end subroutine read_file

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

   !> Folder of a path with its slash; '' when it has none
   pure function folder_of(path) result(folder)
      character(len=*), intent(in) :: path
      character(len=index(path, '/', back=.true.)) :: folder

      folder = path(:index(path, '/', back=.true.))
   end function folder_of

   !> Append the error of a file that cannot be read; line 0 when no line of a deck names it
   subroutine add_file_finding(id, message, file, line, text, first, last, findings)
      character(len=*), intent(in) :: id, message
      character(len=*), intent(in) :: file, text      !! place of the #include
      integer, intent(in) :: line, first, last
      type(finding_list_t), intent(inout) :: findings

      type(error_t), allocatable :: finding

      if (line > 0) then
         call fail_at(finding, file, line, text, first, last, message, 'this file')
         finding%code = ERR_FILE
      else
         call fail(finding, ERR_FILE, message)
         finding%file = file
      end if
      finding%id = id
      call add_finding(findings, finding)
   end subroutine add_file_finding

end module kj_deck_file
