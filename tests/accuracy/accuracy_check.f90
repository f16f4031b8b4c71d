!> What the accuracy tests claim: a number against its bound, printed; and the verdict of the program.
module accuracy_check
   use, intrinsic :: iso_fortran_env, only: output_unit
   use, intrinsic :: iso_c_binding, only: c_int
   use kjoint, only: wp
   implicit none
   private

   public :: check_t, below, above, within, holds, say, quit

   !> How many claims held
   type :: check_t
      integer :: n_good = 0, n_bad = 0
   end type check_t

   interface
      subroutine c_exit(code) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: code
      end subroutine c_exit
   end interface

contains

   !> value <= bound; a NaN fails
   subroutine below(self, what, value, bound)
      type(check_t), intent(inout) :: self
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: value, bound

      character(len=40) :: text

      write (text, '(es10.3,a,es9.2)') value, ' <= ', bound
      call record(self, what, trim(text), value <= bound)
   end subroutine below

   !> value >= bound
   subroutine above(self, what, value, bound)
      type(check_t), intent(inout) :: self
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: value, bound

      character(len=40) :: text

      write (text, '(es10.3,a,es9.2)') value, ' >= ', bound
      call record(self, what, trim(text), value >= bound)
   end subroutine above

   !> |value - wanted| <= tolerance
   subroutine within(self, what, value, wanted, tolerance)
      type(check_t), intent(inout) :: self
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: value, wanted, tolerance

      character(len=60) :: text

      write (text, '(g0.5,a,g0.5,a,g0.2)') value, ' = ', wanted, ' +- ', tolerance
      call record(self, what, trim(text), abs(value - wanted) <= tolerance)
   end subroutine within

   !> A claim without a number
   subroutine holds(self, what, truth)
      type(check_t), intent(inout) :: self
      character(len=*), intent(in) :: what
      logical, intent(in) :: truth

      call record(self, what, '', truth)
   end subroutine holds

   subroutine record(self, what, text, good)
      type(check_t), intent(inout) :: self
      character(len=*), intent(in) :: what, text
      logical, intent(in) :: good

      character(len=46) :: column

      column = what
      if (good) then
         self%n_good = self%n_good + 1
         call say('ok      '//column//' '//text)
      else
         self%n_bad = self%n_bad + 1
         call say('FAILED  '//column//' '//text)
      end if
   end subroutine record

   subroutine say(line)
      character(len=*), intent(in) :: line

      write (output_unit, '(a)') trim(line)
      flush (output_unit)
   end subroutine say

   !> End the program: exit code 1 when a claim failed or none was made
   subroutine quit(self)
      type(check_t), intent(in) :: self

      write (output_unit, '(i0,a,i0,a)') self%n_good, ' held, ', self%n_bad, ' failed'
      flush (output_unit)
      call c_exit(merge(1_c_int, 0_c_int, self%n_bad > 0 .or. self%n_good == 0))
   end subroutine quit

end module accuracy_check
