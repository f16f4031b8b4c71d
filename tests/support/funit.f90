!> The few pFUnit assertions this project uses, for machines that have no pFUnit. A test that fails
!> returns at its first failed assertion, as under pFUnit. Arguments of the program: modules to run.
module funit
   use, intrinsic :: iso_fortran_env, only: dp => real64, int64, output_unit
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none
   private

   public :: assertTrue, assertFalse, assertEqual, assertLessThan, assertGreaterThan
   public :: funit_here, funit_failed, funit_run, funit_finish

   interface assertEqual
      module procedure equal_int, equal_int_01, equal_int_1, equal_int_2, equal_long, equal_text
      module procedure equal_real, equal_real_01, equal_real_1, equal_real_02, equal_real_2
   end interface assertEqual

   interface assertLessThan
      module procedure less_int, less_real
   end interface assertLessThan

   interface assertGreaterThan
      module procedure greater_int, greater_real
   end interface assertGreaterThan

   abstract interface
      subroutine test_i()
      end subroutine test_i
   end interface

   interface
      subroutine c_exit(code) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: code
      end subroutine c_exit
   end interface

   character(len=:), allocatable :: file    !! file of the assertion under way
   integer :: line = 0                      !! its line
   logical :: failed = .false.              !! in the test under way
   integer :: n_passed = 0, n_failed = 0

contains

   !> Run one test of a module unless the arguments name others, as MODULE or MODULE.TEST; print its
   !> outcome
   subroutine funit_run(module, name, test)
      character(len=*), intent(in) :: module, name
      procedure(test_i) :: test

      if (.not. wanted(module, name)) return
      failed = .false.
      call test()
      if (failed) then
         n_failed = n_failed + 1
         write (output_unit, '(4a)') 'FAILED ', module, '.', name
      else
         n_passed = n_passed + 1
         write (output_unit, '(4a)') 'ok     ', module, '.', name
      end if
      flush (output_unit)
   end subroutine funit_run

   logical function wanted(module, name)
      character(len=*), intent(in) :: module, name

      character(len=100) :: argument
      integer :: i

      wanted = command_argument_count() == 0
      do i = 1, command_argument_count()
         call get_command_argument(i, argument)
         wanted = wanted .or. argument == module .or. argument == module//'.'//name
      end do
   end function wanted

   !> Print the totals; a failure, or no test at all, is a non-zero exit status
   subroutine funit_finish()
      write (output_unit, '(i0,a,i0,a)') n_passed, ' passed, ', n_failed, ' failed'
      flush (output_unit)
      call c_exit(merge(1_c_int, 0_c_int, n_failed > 0 .or. n_passed == 0))
   end subroutine funit_finish

   subroutine funit_here(in_file, at_line)
      character(len=*), intent(in) :: in_file
      integer, intent(in) :: at_line

      file = in_file
      line = at_line
   end subroutine funit_here

   logical function funit_failed()
      funit_failed = failed
   end function funit_failed

   subroutine report(message)
      character(len=*), intent(in) :: message

      failed = .true.
      write (output_unit, '(2a,i0,2a)') file, ':', line, ': ', message
   end subroutine report

   subroutine assertTrue(condition)
      logical, intent(in) :: condition

      if (.not. condition) call report('expected true')
   end subroutine assertTrue

   subroutine assertFalse(condition)
      logical, intent(in) :: condition

      if (condition) call report('expected false')
   end subroutine assertFalse

   ! ---- integers

   subroutine equal_int(expected, found)
      integer, intent(in) :: expected, found

      call equal_int_1([expected], [found])
   end subroutine equal_int

   subroutine equal_int_01(expected, found)
      integer, intent(in) :: expected, found(:)

      integer :: i

      call equal_int_1([(expected, i=1, size(found))], found)
   end subroutine equal_int_01

   subroutine equal_int_2(expected, found)
      integer, intent(in) :: expected(:, :), found(:, :)

      if (same_shape(shape(expected), shape(found))) &
         call equal_int_1(reshape(expected, [size(expected)]), reshape(found, [size(found)]))
   end subroutine equal_int_2

   subroutine equal_int_1(expected, found)
      integer, intent(in) :: expected(:), found(:)

      character(len=80) :: text
      integer :: i

      if (.not. same_shape(shape(expected), shape(found))) return
      do i = 1, size(expected)
         if (expected(i) == found(i)) cycle
         write (text, '(3(a,i0))') 'element ', i, ': expected ', expected(i), ' found ', found(i)
         call report(trim(text))
         return
      end do
   end subroutine equal_int_1

   subroutine equal_long(expected, found)
      integer(int64), intent(in) :: expected, found

      character(len=80) :: text

      if (expected == found) return
      write (text, '(2(a,i0))') 'expected ', expected, ' found ', found
      call report(trim(text))
   end subroutine equal_long

   subroutine less_int(a, b)
      integer, intent(in) :: a, b

      character(len=80) :: text

      if (a < b) return
      write (text, '(2(a,i0))') 'expected ', a, ' < ', b
      call report(trim(text))
   end subroutine less_int

   subroutine greater_int(a, b)
      integer, intent(in) :: a, b

      character(len=80) :: text

      if (a > b) return
      write (text, '(2(a,i0))') 'expected ', a, ' > ', b
      call report(trim(text))
   end subroutine greater_int

   ! ---- reals

   subroutine equal_real(expected, found, tolerance)
      real(dp), intent(in) :: expected, found
      real(dp), intent(in), optional :: tolerance

      call equal_real_1([expected], [found], tolerance)
   end subroutine equal_real

   subroutine equal_real_01(expected, found, tolerance)
      real(dp), intent(in) :: expected, found(:)
      real(dp), intent(in), optional :: tolerance

      integer :: i

      call equal_real_1([(expected, i=1, size(found))], found, tolerance)
   end subroutine equal_real_01

   subroutine equal_real_02(expected, found, tolerance)
      real(dp), intent(in) :: expected, found(:, :)
      real(dp), intent(in), optional :: tolerance

      call equal_real_01(expected, reshape(found, [size(found)]), tolerance)
   end subroutine equal_real_02

   subroutine equal_real_2(expected, found, tolerance)
      real(dp), intent(in) :: expected(:, :), found(:, :)
      real(dp), intent(in), optional :: tolerance

      if (same_shape(shape(expected), shape(found))) call equal_real_1( &
         reshape(expected, [size(expected)]), reshape(found, [size(found)]), tolerance)
   end subroutine equal_real_2

   subroutine equal_real_1(expected, found, tolerance)
      real(dp), intent(in) :: expected(:), found(:)
      real(dp), intent(in), optional :: tolerance

      character(len=120) :: text
      real(dp) :: tol
      integer :: i

      tol = 0.0_dp
      if (present(tolerance)) tol = tolerance
      if (.not. same_shape(shape(expected), shape(found))) return
      do i = 1, size(expected)
         if (abs(expected(i) - found(i)) <= tol) cycle   ! a NaN is not <= tol: it fails
         write (text, '(a,i0,2(a,es24.16))') 'element ', i, ': expected ', expected(i), &
            ' found ', found(i)
         call report(trim(text))
         return
      end do
   end subroutine equal_real_1

   subroutine less_real(a, b)
      real(dp), intent(in) :: a, b

      character(len=80) :: text

      if (a < b) return
      write (text, '(2(a,es24.16))') 'expected ', a, ' < ', b
      call report(trim(text))
   end subroutine less_real

   subroutine greater_real(a, b)
      real(dp), intent(in) :: a, b

      character(len=80) :: text

      if (a > b) return
      write (text, '(2(a,es24.16))') 'expected ', a, ' > ', b
      call report(trim(text))
   end subroutine greater_real

   ! ---- the rest

   logical function same_shape(expected, found)
      integer, intent(in) :: expected(:), found(:)

      same_shape = all(expected == found)
      if (.not. same_shape) call report('the shapes differ')
   end function same_shape

   subroutine equal_text(expected, found)
      character(len=*), intent(in) :: expected, found

      if (expected /= found .or. len(expected) /= len(found)) &
         call report('expected "'//expected//'" found "'//found//'"')
   end subroutine equal_text

end module funit
