!> Room on a disk that is held until a history has to be closed, so that a full disk does not spoil
!> what the file has: HDF5 keeps some of its bookkeeping in memory until then.
module kj_reserve
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_char, c_null_char
   implicit none
   private

   public :: take_reserve, give_reserve

   integer, parameter, public :: NO_RESERVE = -1
   integer(c_long), parameter :: BYTES = 2*1024*1024

   interface
      integer(c_int) function kj_reserve_take(name, bytes) bind(c)
         import :: c_int, c_long, c_char
         character(kind=c_char), intent(in) :: name(*)
         integer(c_long), value, intent(in) :: bytes
      end function kj_reserve_take

      subroutine kj_reserve_give(file) bind(c)
         import :: c_int
         integer(c_int), value, intent(in) :: file
      end subroutine kj_reserve_give
   end interface

contains

   !> Hold room by a file whose path is free again on return; NO_RESERVE where there is none
   subroutine take_reserve(path, reserve)
      character(len=*), intent(in) :: path
      integer, intent(out) :: reserve

      reserve = int(kj_reserve_take(path//c_null_char, BYTES))
   end subroutine take_reserve

   !> Give it back, if there is any
   subroutine give_reserve(reserve)
      integer, intent(inout) :: reserve

      call kj_reserve_give(int(reserve, c_int))
      reserve = NO_RESERVE
   end subroutine give_reserve

end module kj_reserve
