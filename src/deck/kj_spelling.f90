!> Spelling: upper case, and how far two words are apart. For "did you mean".
module kj_spelling
   implicit none
   private

   public :: upper, edit_distance

contains

   !> Text with the letters a to z in upper case
   pure function upper(text) result(big)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: big

      integer :: i, code

      big = text
      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar('a') .and. code <= iachar('z')) big(i:i) = achar(code - 32)
      end do
   end function upper

   !> Least number of letters to insert, remove or replace that turns one text into the other
   !>
   !> Source: V. I. Levenshtein, Soviet Physics Doklady 10 (1966) 707.
   pure integer function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b

      integer :: i, j, diagonal, above, row(0:len(b))

      row = [(j, j=0, len(b))]
      do i = 1, len(a)
         diagonal = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
            diagonal = above
         end do
      end do
      distance = row(len(b))
   end function edit_distance

end module kj_spelling
