!> Every file that kjoint writes comes about here: beside its place, under a name of its own, and
!> takes its place when it is whole. Only a regular file or nothing is replaced, and no input.
module kj_output
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char, c_null_char, c_ptr
   use kj_error, only: error_t, fail, ERR_INPUT, ERR_FILE
   use kj_system, only: remove_file, c_text
   use kj_text, only: text_t
   implicit none
   private

   public :: settle_output, begin_output, append_output, end_output, write_output, copy_to
   public :: find_part, is_written, is_locked, why
   public :: open_part, name_part, has_name      ! for a file that is locked while it grows

   integer, parameter :: OTHER = 2               !! neither nothing nor a regular file
   integer, parameter :: TAKEN = -10000          !! kj_part_open
   integer, parameter :: MOST_PATH = 4096

   interface
      integer(c_int) function kj_same_file(a, b) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: a(*), b(*)
      end function kj_same_file

      integer(c_int) function kj_output_kind(path) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function kj_output_kind

      integer(c_int) function kj_real_path(path, real, n) bind(c)
         import :: c_int, c_char, c_size_t
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(inout) :: real(*)
         integer(c_size_t), value, intent(in) :: n
      end function kj_real_path

      integer(c_int) function kj_is_written(path) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function kj_is_written

      integer(c_int) function kj_is_locked(path) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function kj_is_locked

      integer(c_int) function kj_find_part(path, own, written, found, n) bind(c)
         import :: c_int, c_char, c_size_t
         character(kind=c_char), intent(in) :: path(*), own(*)
         integer(c_int), value, intent(in) :: written
         character(kind=c_char), intent(inout) :: found(*)
         integer(c_size_t), value, intent(in) :: n
      end function kj_find_part

      integer(c_int) function kj_part_open(path, part, n) bind(c)
         import :: c_int, c_char, c_size_t
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(inout) :: part(*)
         integer(c_size_t), value, intent(in) :: n
      end function kj_part_open

      integer(c_int) function kj_part_name(part, path, replace) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: part(*), path(*)
         integer(c_int), value, intent(in) :: replace
      end function kj_part_name

      integer(c_int) function kj_has_name(file) bind(c)
         import :: c_int
         integer(c_int), value, intent(in) :: file
      end function kj_has_name

      integer(c_int) function kj_copy_file(path, copy) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*), copy(*)
      end function kj_copy_file

      integer(c_int) function kj_append(path, n, bytes) bind(c)
         import :: c_int, c_size_t, c_char
         character(kind=c_char), intent(in) :: path(*), bytes(*)
         integer(c_size_t), value, intent(in) :: n
      end function kj_append

      type(c_ptr) function c_strerror(number) bind(c, name='strerror')
         import :: c_int, c_ptr
         integer(c_int), value :: number
      end function c_strerror

      integer(c_int) function c_close(file) bind(c, name='close')
         import :: c_int
         integer(c_int), value, intent(in) :: file
      end function c_close
   end interface

contains

   !> See whether a file may be written, and where: a symbolic link is followed.
   !> Errors: ERR_INPUT when it is an input, or something that is no regular file stands there
   subroutine settle_output(path, inputs, place, error)
      character(len=*), intent(in) :: path
      type(text_t), intent(in) :: inputs(:)      !! paths of the files that are read
      character(len=:), allocatable, intent(out) :: place
      type(error_t), allocatable, intent(inout) :: error

      character(len=MOST_PATH) :: real
      integer :: i

      place = path
      if (allocated(error)) return
      if (len_trim(path) == 0 .or. len(path) >= MOST_PATH) then
         call fail(error, ERR_INPUT, '"'//path//'" is no name for a file to write')
      else if (kj_output_kind(path//c_null_char) == OTHER) then
         call fail(error, ERR_INPUT, path//' is no regular file: it is not written to')
      end if
      do i = 1, size(inputs)
         if (allocated(error)) return
         if (kj_same_file(path//c_null_char, inputs(i)%s//c_null_char) /= 0) &
            call fail(error, ERR_INPUT, 'the output '//path//' is an input')
      end do
      if (kj_real_path(path//c_null_char, real, int(MOST_PATH, c_size_t)) == 0) &
         place = real(:index(real, c_null_char) - 1)
   end subroutine settle_output

   !> Open a new file beside `path`, to become it; nobody else may write that at the same time.
   !> Errors: ERR_FILE
   subroutine open_part(path, part, file, error)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: part       !! path of the new file
      integer, intent(out) :: file               !! its descriptor, negative on errors
      type(error_t), allocatable, intent(inout) :: error

      character(len=MOST_PATH) :: found

      file = -1
      part = ''
      if (allocated(error)) return
      found = c_null_char
      file = int(kj_part_open(path//c_null_char, found, int(MOST_PATH, c_size_t)))
      part = found(:index(found, c_null_char) - 1)
      if (file == TAKEN) then
         call fail(error, ERR_FILE, 'another run is writing '//path//', as '//part)
         error%hint = 'wait for its end, or give this one another name by -o'
      else if (file < 0) then
         call fail(error, ERR_FILE, 'cannot create '//path//': '//trim(why(-int(file, c_int))))
      end if
   end subroutine open_part

   !> Give a file that is open_part's its name. Errors: ERR_FILE
   subroutine name_part(part, path, replace, named, error)
      character(len=*), intent(in) :: part, path
      logical, intent(in) :: replace             !! a regular file that has this name
      logical, intent(out) :: named              !! or there is such a file, which stays
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      named = .false.
      if (allocated(error)) return
      status = int(kj_part_name(part//c_null_char, path//c_null_char, merge(1_c_int, 0_c_int, &
         replace)))
      named = status == 0
      if (status < 0) call fail(error, ERR_FILE, 'cannot rename '//part//' to '//path)
   end subroutine name_part

   !> An empty file beside the place of an output, to be written and then given to end_output.
   !> Errors: ERR_INPUT as settle_output, ERR_FILE as open_part
   subroutine begin_output(path, inputs, place, part, error)
      character(len=*), intent(in) :: path
      type(text_t), intent(in) :: inputs(:)      !! paths of the files that are read
      character(len=:), allocatable, intent(out) :: place, part
      type(error_t), allocatable, intent(inout) :: error

      integer :: file
      integer(c_int) :: ignored

      call settle_output(path, inputs, place, error)
      call open_part(place, part, file, error)
      if (file >= 0) ignored = c_close(int(file, c_int))
   end subroutine begin_output

   !> Write bytes to the end of a file of begin_output. Errors: ERR_FILE
   subroutine append_output(part, n, bytes, error)
      character(len=*), intent(in) :: part
      integer(c_size_t), intent(in) :: n
      character(kind=c_char), intent(in) :: bytes(*)
      type(error_t), allocatable, intent(inout) :: error

      integer(c_int) :: reason

      if (allocated(error)) return
      reason = kj_append(part//c_null_char, n, bytes)
      if (reason /= 0) call fail(error, ERR_FILE, trim(why(reason)))
   end subroutine append_output

   !> Give a file that is whole its name; remove it where an error came before, which gets the name
   !> of the output. Errors: ERR_FILE
   subroutine end_output(part, place, error)
      character(len=*), intent(in) :: part, place
      type(error_t), allocatable, intent(inout) :: error

      logical :: named

      if (part == '') return                     ! it was not begun
      if (allocated(error)) error%message = 'cannot write '//place//': '//error%message
      call name_part(part, place, .true., named, error)
      if (.not. named) call remove_file(part)
   end subroutine end_output

   !> Copy a file over another. Errors: ERR_FILE
   subroutine copy_to(path, copy, error)
      character(len=*), intent(in) :: path, copy
      type(error_t), allocatable, intent(inout) :: error

      integer(c_int) :: reason

      if (allocated(error)) return
      reason = kj_copy_file(path//c_null_char, copy//c_null_char)
      if (reason /= 0) call fail(error, ERR_FILE, 'cannot copy '//path//': '//trim(why(reason)))
   end subroutine copy_to

   !> Whether an open file still has a name, this one or another
   logical function has_name(file)
      integer, intent(in) :: file                !! descriptor

      has_name = kj_has_name(int(file, c_int)) /= 0
   end function has_name

   !> Whether a run is writing this file
   logical function is_written(path)
      character(len=*), intent(in) :: path

      is_written = kj_is_written(path//c_null_char) /= 0
   end function is_written

   !> Whether another program has locked this file against readers
   logical function is_locked(path)
      character(len=*), intent(in) :: path

      is_locked = kj_is_locked(path//c_null_char) /= 0
   end function is_locked

   !> The newest file beside `path` that grows to be it (written); or that a run left which was
   !> killed, and is newer than what stands at `path`. Empty when there is none
   subroutine find_part(path, written, part)
      character(len=*), intent(in) :: path
      logical, intent(in) :: written
      character(len=:), allocatable, intent(out) :: part

      character(len=MOST_PATH) :: found

      part = ''
      if (len(path) >= MOST_PATH) return
      if (kj_find_part(path//c_null_char, c_null_char, merge(1_c_int, 0_c_int, written), found, &
         int(MOST_PATH, c_size_t)) == 0) part = found(:index(found, c_null_char) - 1)
   end subroutine find_part

   !> Write a text to a file, whole or not at all.
   !> Errors: ERR_INPUT as settle_output, ERR_FILE
   subroutine write_output(path, text, inputs, error)
      character(len=*), intent(in) :: path, text
      type(text_t), intent(in) :: inputs(:)      !! paths of the files that are read
      type(error_t), allocatable, intent(inout) :: error

      character(len=:), allocatable :: place, part

      call begin_output(path, inputs, place, part, error)
      call append_output(part, len(text, c_size_t), text, error)
      call end_output(part, place, error)
   end subroutine write_output

   !> What the system calls an error
   function why(number) result(text)
      integer(c_int), intent(in) :: number
      character(len=80) :: text

      character(len=:), allocatable :: words

      call c_text(c_strerror(number), words)
      text = words
   end function why

end module kj_output
