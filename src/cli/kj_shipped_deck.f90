!> The decks of decks/, which the program holds: names and texts.
module kj_shipped_deck
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_char, c_size_t, c_f_pointer
   implicit none
   private

   public :: shipped_count, shipped_name, shipped_text

   interface
      integer(c_int) function kj_shipped_count() bind(c)
         import :: c_int
      end function kj_shipped_count
      type(c_ptr) function kj_shipped_name(i) bind(c)
         import :: c_int, c_ptr
         integer(c_int), value :: i
      end function kj_shipped_name
      type(c_ptr) function kj_shipped_text(i, n) bind(c)
         import :: c_int, c_ptr, c_size_t
         integer(c_int), value :: i
         integer(c_size_t), intent(out) :: n
      end function kj_shipped_text
      integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
         import :: c_size_t, c_ptr
         type(c_ptr), value :: text
      end function c_strlen
   end interface

contains

   !> Number of files
   integer function shipped_count() result(n)
      n = kj_shipped_count()
   end function shipped_count

   !> Name of file i of 1, 2, ...
   subroutine shipped_name(i, name)
      integer, intent(in) :: i
      character(len=:), allocatable, intent(out) :: name

      call take_text(kj_shipped_name(int(i - 1, c_int)), c_strlen(kj_shipped_name(int(i - 1, &
         c_int))), name)
   end subroutine shipped_name

   !> Its text
   subroutine shipped_text(i, text)
      integer, intent(in) :: i
      character(len=:), allocatable, intent(out) :: text

      type(c_ptr) :: pointer
      integer(c_size_t) :: n

      pointer = kj_shipped_text(int(i - 1, c_int), n)
      call take_text(pointer, n, text)
   end subroutine shipped_text

   subroutine take_text(pointer, n, text)
      type(c_ptr), intent(in) :: pointer
      integer(c_size_t), intent(in) :: n
      character(len=:), allocatable, intent(out) :: text

      character(kind=c_char), pointer :: letters(:)
      integer :: i

      call c_f_pointer(pointer, letters, [n])
      allocate (character(len=n) :: text)
      do i = 1, int(n)
         text(i:i) = letters(i)
      end do
   end subroutine take_text

end module kj_shipped_deck
