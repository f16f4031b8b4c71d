!> Spelling: upper case, and how far two words are apart. For "did you mean".
module kj_spelling
   implicit none
   private

   public :: upper, edit_distance, did_you_mean

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

   !> 'did you mean "run"?' with the candidate nearest to a word, in letters of either case; blank
   !> when none is near
   pure function did_you_mean(word, candidates) result(text)
      character(len=*), intent(in) :: word, candidates(:)
      character(len=len(candidates) + 16) :: text

      integer :: i, d, least

      text = ''
      least = len_trim(word)/3 + 2               ! more edits than that is another word
      do i = 1, size(candidates)
         d = edit_distance(upper(trim(word)), upper(trim(candidates(i))))
         if (d >= least) cycle
         least = d
         text = 'did you mean "'//trim(candidates(i))//'"?'
      end do
   end function did_you_mean

end module kj_spelling
