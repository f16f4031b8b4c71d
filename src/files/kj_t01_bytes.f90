!> Bytes of a file, plain or gzip: the functions of zlib that read, which take either.
module kj_t01_bytes
   use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_int, c_long, c_null_ptr, c_null_char, &
      c_associated, c_loc
   use, intrinsic :: iso_fortran_env, only: int8, int64
   implicit none
   private

   public :: byte_file_t, open_bytes, read_bytes, seek_bytes, byte_position, read_text_line, &
      is_plain, close_bytes, why_not

   !> An open file; closed by close_bytes
   type :: byte_file_t
      type(c_ptr) :: handle = c_null_ptr      !! gzFile of zlib
   end type byte_file_t

   integer, parameter :: MOST_AT_ONCE = 2**24   !! bytes asked of zlib in one call
   integer(c_int), parameter :: FROM_START = 0_c_int

   interface
      function gzopen(path, mode) bind(c, name='gzopen') result(handle)
         import :: c_ptr, c_char
         character(kind=c_char), intent(in) :: path(*), mode(*)
         type(c_ptr) :: handle
      end function gzopen

      function gzread(handle, buffer, length) bind(c, name='gzread') result(n)
         import :: c_ptr, c_int
         type(c_ptr), value :: handle, buffer
         integer(c_int), value :: length
         integer(c_int) :: n
      end function gzread

      function gzgets(handle, buffer, length) bind(c, name='gzgets') result(same)
         import :: c_ptr, c_int, c_char
         type(c_ptr), value :: handle
         character(kind=c_char), intent(inout) :: buffer(*)
         integer(c_int), value :: length
         type(c_ptr) :: same
      end function gzgets

      function gzseek(handle, offset, whence) bind(c, name='gzseek') result(at)
         import :: c_ptr, c_int, c_long
         type(c_ptr), value :: handle
         integer(c_long), value :: offset
         integer(c_int), value :: whence
         integer(c_long) :: at
      end function gzseek

      function gztell(handle) bind(c, name='gztell') result(at)
         import :: c_ptr, c_long
         type(c_ptr), value :: handle
         integer(c_long) :: at
      end function gztell

      function gzdirect(handle) bind(c, name='gzdirect') result(plain)
         import :: c_ptr, c_int
         type(c_ptr), value :: handle
         integer(c_int) :: plain
      end function gzdirect

      function gzclose(handle) bind(c, name='gzclose') result(status)
         import :: c_ptr, c_int
         type(c_ptr), value :: handle
         integer(c_int) :: status
      end function gzclose
   end interface

contains

   !> Open for reading; `ok` is false when the file is missing or may not be read
   subroutine open_bytes(path, file, ok)
      character(len=*), intent(in) :: path
      type(byte_file_t), intent(out) :: file
      logical, intent(out) :: ok

      file%handle = gzopen(path//c_null_char, 'rb'//c_null_char)
      ok = c_associated(file%handle)
   end subroutine open_bytes

   !> Why a file cannot be opened, in the words of the system
   function why_not(path) result(why)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: why

      character(len=300) :: message
      integer :: unit, status

      message = ''
      open (newunit=unit, file=path, status='old', action='read', access='stream', &
         form='unformatted', iostat=status, iomsg=message)
      if (status == 0) close (unit)
      why = trim(message(index(message, ': ', back=.true.) + 1:))
      if (len_trim(why) == 0) why = ' it is no file'
      why = trim(adjustl(why))
   end function why_not

   !> Read up to size(bytes) bytes; fewer only at the end of the file, -1 on a damaged file
   subroutine read_bytes(file, bytes, n_read)
      type(byte_file_t), intent(in) :: file
      integer(int8), intent(inout), contiguous, target :: bytes(:)
      integer, intent(out) :: n_read

      integer :: n, ask

      n_read = 0
      do while (n_read < size(bytes))
         ask = min(size(bytes) - n_read, MOST_AT_ONCE)
         n = int(gzread(file%handle, c_loc(bytes(n_read + 1)), int(ask, c_int)))
         if (n < 0) n_read = -1
         if (n <= 0) return
         n_read = n_read + n
      end do
   end subroutine read_bytes

   !> Go to a place, counted from 0 in the unpacked bytes
   subroutine seek_bytes(file, at, ok)
      type(byte_file_t), intent(in) :: file
      integer(int64), intent(in) :: at
      logical, intent(out) :: ok

      ok = gzseek(file%handle, int(at, c_long), FROM_START) == at
   end subroutine seek_bytes

   !> Where the next byte comes from, counted from 0 in the unpacked bytes
   integer(int64) function byte_position(file) result(at)
      type(byte_file_t), intent(in) :: file

      at = int(gztell(file%handle), int64)
   end function byte_position

   !> Read a line without its end (LF or CR LF); `length` is -1 at the end of the file and for a
   !> line that is longer than `line` or not text
   subroutine read_text_line(file, line, length)
      type(byte_file_t), intent(in) :: file
      character(len=*), intent(inout) :: line
      integer, intent(out) :: length

      character(kind=c_char) :: buffer(len(line) + 3)
      integer :: i

      length = -1
      buffer = c_null_char
      if (.not. c_associated(gzgets(file%handle, buffer, size(buffer, kind=c_int)))) return
      do i = 1, size(buffer)
         if (buffer(i) == c_null_char) return
         if (buffer(i) == new_line('a')) exit
      end do
      if (i > size(buffer)) return
      length = i - 1
      if (length > 0) then
         if (buffer(length) == achar(13)) length = length - 1
      end if
      if (length > len(line)) then
         length = -1
         return
      end if
      line = ''
      do i = 1, length
         line(i:i) = buffer(i)
      end do
   end subroutine read_text_line

   !> Not packed: the size of the file is the number of its bytes
   logical function is_plain(file)
      type(byte_file_t), intent(in) :: file

      is_plain = gzdirect(file%handle) /= 0
   end function is_plain

   !> Close; nothing happens when it is not open
   subroutine close_bytes(file)
      type(byte_file_t), intent(inout) :: file

      integer(c_int) :: status

      if (.not. c_associated(file%handle)) return
      status = gzclose(file%handle)
      if (status /= 0_c_int) status = 0_c_int      ! nothing was written: nothing can be lost
      file%handle = c_null_ptr
   end subroutine close_bytes

end module kj_t01_bytes
