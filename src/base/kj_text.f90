!> Texts of any length in arrays.
module kj_text
   implicit none
   private

   public :: text_t, append_text

   !> A text of any length
   type :: text_t
      character(len=:), allocatable :: s
   end type text_t

contains

   !> Append a text to a list
   subroutine append_text(list, text)
      type(text_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: text

      type(text_t), allocatable :: longer(:)
      integer :: i

      allocate (longer(size(list) + 1))
      do i = 1, size(list)
         call move_alloc(list(i)%s, longer(i)%s)
      end do
      longer(size(longer))%s = text
      call move_alloc(longer, list)
   end subroutine append_text

end module kj_text
