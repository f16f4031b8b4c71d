!> The little the library asks of the operating system: files by name, the host, the clock.
module kj_system
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t, c_char, c_null_char, &
      c_ptr, c_associated, c_f_pointer
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   implicit none
   private

   public :: file_kind, remove_file, sync_file, absolute_path, host_name, date_time, &
      wall_clock, thread_clock, kj_kernel_machine, c_text

   !> struct timespec
   type, bind(c) :: c_time_t
      integer(c_long) :: seconds = 0, nanoseconds = 0
   end type c_time_t

   integer(c_int), parameter :: THREAD_CPU = 3_c_int   !! CLOCK_THREAD_CPUTIME_ID of Linux

   !> What a path is
   integer, parameter, public :: KIND_NONE = 0, KIND_REGULAR = 1, KIND_FOLDER = 2, KIND_OTHER = 3

   interface
      integer(c_int) function c_file_kind(path) bind(c, name='kj_file_kind')
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function c_file_kind
      !> The machine that the kernels at work are compiled for, x86-64-v3 say
      subroutine kj_kernel_machine(name) bind(c)
         import :: c_char
         character(kind=c_char), intent(out) :: name(16)
      end subroutine kj_kernel_machine
      integer(c_int) function c_clock_gettime(clock, time) bind(c, name='clock_gettime')
         import :: c_int, c_time_t
         integer(c_int), value :: clock
         type(c_time_t), intent(out) :: time
      end function c_clock_gettime
      integer(c_int) function c_remove(path) bind(c, name='remove')
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function c_remove
      integer(c_int) function c_open(path, flags) bind(c, name='open')
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: flags
      end function c_open
      integer(c_int) function c_fsync(file) bind(c, name='fsync')
         import :: c_int
         integer(c_int), value :: file
      end function c_fsync
      integer(c_int) function c_close(file) bind(c, name='close')
         import :: c_int
         integer(c_int), value :: file
      end function c_close
      type(c_ptr) function c_realpath(path, buffer) bind(c, name='realpath')
         import :: c_ptr, c_char
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(inout) :: buffer(*)
      end function c_realpath
      integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
         import :: c_size_t, c_ptr
         type(c_ptr), value :: text
      end function c_strlen
      integer(c_int) function c_gethostname(name, length) bind(c, name='gethostname')
         import :: c_int, c_size_t, c_char
         character(kind=c_char), intent(out) :: name(*)
         integer(c_size_t), value :: length
      end function c_gethostname
   end interface

contains

   !> The text at an address, up to a zero; '' at none
   subroutine c_text(address, text)
      type(c_ptr), intent(in) :: address
      character(len=:), allocatable, intent(out) :: text

      character(kind=c_char), pointer :: letters(:)
      integer :: i, n

      n = 0
      if (c_associated(address)) n = int(c_strlen(address))
      allocate (character(len=n) :: text)
      if (n > 0) call c_f_pointer(address, letters, [n])
      do i = 1, n
         text(i:i) = letters(i)
      end do
   end subroutine c_text

   !> What a path is, KIND_ constant; links are followed
   integer function file_kind(path)
      character(len=*), intent(in) :: path

      file_kind = int(c_file_kind(path//c_null_char))
   end function file_kind

   !> Remove a file; a file that is not there is no failure
   subroutine remove_file(path)
      character(len=*), intent(in) :: path

      integer(c_int) :: ignored

      ignored = c_remove(path//c_null_char)
   end subroutine remove_file

   !> Wait until a file is on its disk
   subroutine sync_file(path, done)
      character(len=*), intent(in) :: path
      logical, intent(out) :: done

      integer(c_int), parameter :: READ_ONLY = 0_c_int
      integer(c_int) :: file

      file = c_open(path//c_null_char, READ_ONLY)
      done = file >= 0
      if (.not. done) return
      done = c_fsync(file) == 0
      done = c_close(file) == 0 .and. done
   end subroutine sync_file

   !> Where a file is or will be, from the root; the path as it was where there is no such folder
   subroutine absolute_path(path, whole)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: whole

      integer, parameter :: PATH_MAX = 4096
      character(len=PATH_MAX + 1) :: buffer
      integer :: cut

      whole = path
      buffer = ''
      cut = index(path, '/', back=.true.)
      if (.not. c_associated(c_realpath(path(:cut)//'.'//c_null_char, buffer))) return
      whole = buffer(:index(buffer, c_null_char) - 1)//'/'//path(cut + 1:)
   end subroutine absolute_path

   !> Name of this machine, empty when it has none
   function host_name() result(name)
      character(len=:), allocatable :: name

      character(len=256) :: buffer
      integer :: n

      name = ''
      buffer = ''
      if (c_gethostname(buffer, len(buffer, c_size_t)) /= 0) return
      n = index(buffer, c_null_char) - 1
      if (n > 0) name = buffer(:n)
   end function host_name

   !> Date and time now as ISO 8601 has them: "2024-05-31T17:05:00.123+02:00"
   function date_time() result(text)
      character(len=:), allocatable :: text

      character(len=8) :: day
      character(len=10) :: clock
      character(len=5) :: zone

      call date_and_time(day, clock, zone)
      text = day(1:4)//'-'//day(5:6)//'-'//day(7:8)//'T'//clock(1:2)//':'//clock(3:4)//':'// &
         clock(5:10)//zone(1:3)//':'//zone(4:5)
   end function date_time

   !> Seconds of wall clock from a fixed but unknown origin
   function wall_clock() result(seconds)
      real(wp) :: seconds

      integer(int64) :: ticks, rate

      call system_clock(ticks, rate)
      seconds = real(ticks, wp)/real(max(rate, 1_int64), wp)
   end function wall_clock

   !> Seconds that this thread has had the processor, whatever else the machine does; where the
   !> system does not tell, the wall clock
   function thread_clock() result(seconds)
      real(wp) :: seconds

      type(c_time_t) :: time

      if (c_clock_gettime(THREAD_CPU, time) == 0) then
         seconds = real(time%seconds, wp) + 1.0e-9_wp*real(time%nanoseconds, wp)
      else
         seconds = wall_clock()
      end if
   end function thread_clock

end module kj_system
