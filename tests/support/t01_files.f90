!> Writes small Radioss time histories of every form, for the tests of the reader. Written from
!> the description of the format, not with the reader.
module t01_files
   use, intrinsic :: iso_fortran_env, only: int8, int32, real32, real64
   implicit none
   private

   public :: t01_writer_t, write_small_t01, begin_t01, put_ints, put_reals, put_mixed, end_t01

   integer, parameter, public :: SMALL_WORDS = 47    !! numbers in a row of write_small_t01

   type :: t01_writer_t
      integer :: unit = -1
      integer :: form = 4        !! /TFILE type: 1, 3 or 4
   end type t01_writer_t

contains

   !> Write a file with everything a header may hold; number w of row i (from 0) is 1000 i + w
   !>
   !> Places: 1 time, 2-13 globals 1-12, 14-15 part, 16 subset, 17-21 spring 7 and 22-26 spring 3
   !> (OFF FX FY FZ IE), 27-29 node 20 and 30-32 node 10 (DX DY DZ), 33-34 node 30 (VX VY), 35-38
   !> body 1 (FX FY FZ MASS), 39-47 a fluid section, which is announced with 6 numbers.
   subroutine write_small_t01(path, form, code, n_title, n_row)
      character(len=*), intent(in) :: path
      integer, intent(in) :: form                !! /TFILE type: 1, 3 or 4
      integer, intent(in) :: code, n_title       !! header code and its length of titles
      integer, intent(in) :: n_row

      type(t01_writer_t) :: w
      integer :: i, first(9), last(9)

      call begin_t01(path, form, w)
      call put_mixed(w, [code], 'small', 80, [integer ::])
      call put_mixed(w, [integer ::], 'Sun Jan  1 00:00:00 2023', 80, [integer ::])
      if (code >= 3050) then
         call put_ints(w, [2])
         call put_ints(w, [n_title])
         call put_reals(w, [1000.0_real64, 0.001_real64, 1.0_real64])
      end if
      call put_ints(w, [1, 1, 1, 1, 5, 12])
      call put_ints(w, [(i, i=1, 12)])
      call put_mixed(w, [5], 'part', n_title, [0, 1, 1, 2])
      call put_ints(w, [1, 2])
      call put_mixed(w, [0], 'no_title', n_title, [integer ::])
      call put_mixed(w, [5], 'property', n_title, [integer ::])
      call put_mixed(w, [0, 0, 0, 1, 1], 'GLOBAL MODEL', n_title, [integer ::])
      call put_ints(w, [1])
      call put_ints(w, [2])
      call put_mixed(w, [1, 6, 0, 2, 5], 'springs', n_title, [integer ::])
      call put_mixed(w, [7], 'hinge', n_title, [integer ::])
      call put_mixed(w, [3], '', n_title, [integer ::])
      call put_ints(w, [1, 2, 3, 4, 14])
      call put_mixed(w, [2, 0, 0, 2, 3], '9 nodes', n_title, [integer ::])
      call put_mixed(w, [20], '', n_title, [integer ::])
      call put_mixed(w, [10], '', n_title, [integer ::])
      call put_ints(w, [1, 2, 3])
      call put_mixed(w, [3, 0, 0, 1, 2], 'more nodes', n_title, [integer ::])
      call put_mixed(w, [30], '', n_title, [integer ::])
      call put_ints(w, [4, 5])
      call put_mixed(w, [4, 103, 0, 1, 4], 'bodies', n_title, [integer ::])
      call put_mixed(w, [1], 'arm', n_title, [integer ::])
      call put_ints(w, [1, 2, 3, 34])
      call put_mixed(w, [5, 104, 0, 1, 6], 'fluid', n_title, [integer ::])
      call put_mixed(w, [8], '', n_title, [integer ::])
      call put_ints(w, [104, 105, 106, 107, 108, 109])
      first = [1, 2, 14, 16, 17, 27, 33, 35, 39]
      last = [1, 13, 15, 16, 26, 32, 34, 38, SMALL_WORDS]
      do i = 0, n_row - 1
         call put_row(w, i, first, last)
      end do
      call end_t01(w)
   end subroutine write_small_t01

   !> A row of records with the numbers 1000 i + first ... 1000 i + last
   subroutine put_row(w, i, first, last)
      type(t01_writer_t), intent(in) :: w
      integer, intent(in) :: i, first(:), last(:)

      integer :: j, k

      do j = 1, size(first)
         call put_reals(w, [(1000.0_real64*i + k, k=first(j), last(j))])
      end do
   end subroutine put_row

   !> Begin a file of a /TFILE type
   subroutine begin_t01(path, form, w)
      character(len=*), intent(in) :: path
      integer, intent(in) :: form
      type(t01_writer_t), intent(out) :: w

      w%form = form
      open (newunit=w%unit, file=path, access='stream', form='unformatted', status='replace')
      if (form == 3) call put_line(w, ' '//path//' FORMAT')
   end subroutine begin_t01

   subroutine end_t01(w)
      type(t01_writer_t), intent(inout) :: w

      close (w%unit)
   end subroutine end_t01

   !> A record of integers
   subroutine put_ints(w, ints)
      type(t01_writer_t), intent(in) :: w
      integer, intent(in) :: ints(:)

      character(len=160) :: line
      integer :: i

      if (w%form == 3) then
         write (line, '(i5,a)') size(ints), 'I'
         call put_line(w, 'ZZZZZEOR'//trim(line))
         do i = 1, size(ints), 16
            write (line, '(16i10)') ints(i:min(i + 15, size(ints)))
            call put_line(w, trim(line))
         end do
      else
         call put_int(w, 4*size(ints))
         do i = 1, size(ints)
            call put_int(w, ints(i))
         end do
         call put_int(w, 4*size(ints))
      end if
   end subroutine put_ints

   !> A record of reals
   subroutine put_reals(w, values)
      type(t01_writer_t), intent(in) :: w
      real(real64), intent(in) :: values(:)

      character(len=80) :: line
      integer(int8) :: four(4)
      integer :: i, length

      if (w%form == 3) then
         write (line, '(i5,a)') size(values), 'R'
         call put_line(w, 'ZZZZZEOR'//trim(line))
         do i = 1, size(values), 5
            write (line, '(5es16.8)') values(i:min(i + 4, size(values)))
            call put_line(w, trim(line))
         end do
         return
      end if
      length = size(values)*merge(8, 4, w%form == 1)
      call put_int(w, length)
      do i = 1, size(values)
         if (w%form == 1) then
            write (w%unit) values(i)
         else
            four = transfer(real(values(i), real32), four)
            write (w%unit) four(4:1:-1)
         end if
      end do
      call put_int(w, length)
   end subroutine put_reals

   !> A record of integers, a text padded to n_char characters, integers
   subroutine put_mixed(w, lead, text, n_char, trail)
      type(t01_writer_t), intent(in) :: w
      integer, intent(in) :: lead(:), trail(:)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n_char

      character(len=n_char) :: title
      character(len=200) :: line
      integer :: i, length

      title = text
      if (w%form == 3) then
         write (line, '(i5,a,i5,a,i5,a)') size(lead), 'I', n_char, 'C', size(trail), 'I'
         if (size(trail) == 0) line = line(:12)
         if (size(lead) == 0) line = line(7:)
         call put_line(w, 'ZZZZZEOR'//trim(line))
         write (line, '(16i10)') lead
         i = 10*size(lead)
         line(i + 1:i + n_char) = title
         i = i + n_char
         write (line(i + 1:), '(16i5)') trail
         call put_line(w, line(:i + 5*size(trail)))
         return
      end if
      length = 4*(size(lead) + size(trail)) + n_char*merge(2, 1, w%form == 1)
      call put_int(w, length)
      do i = 1, size(lead)
         call put_int(w, lead(i))
      end do
      do i = 1, n_char, 4
         write (w%unit) title(i:i + 3)
         if (w%form == 1) write (w%unit) '    '
      end do
      do i = 1, size(trail)
         call put_int(w, trail(i))
      end do
      call put_int(w, length)
   end subroutine put_mixed

   !> 4 bytes: little end first in type 1, big end first in type 4
   subroutine put_int(w, value)
      type(t01_writer_t), intent(in) :: w
      integer, intent(in) :: value

      integer(int8) :: four(4)

      four = transfer(int(value, int32), four)
      if (w%form == 4) four = four(4:1:-1)
      write (w%unit) four
   end subroutine put_int

   subroutine put_line(w, line)
      type(t01_writer_t), intent(in) :: w
      character(len=*), intent(in) :: line

      write (w%unit) line//new_line('a')
   end subroutine put_line

end module t01_files
