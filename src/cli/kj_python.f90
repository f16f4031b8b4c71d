!> Runs the programs of the Python package kjoint (kj_python.c finds it).
module kj_python
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_text, only: text_t, append_text
   implicit none
   private

   public :: run_python, add_words

   integer, parameter :: NO_PYTHON = 127

   interface
      integer(c_int) function kj_run_python(words, n, become) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: words(*)
         integer(c_int), value :: n, become
      end function kj_run_python
   end interface

contains

   !> Run `python3 -m kjoint.WORD1 WORD2 ...` and wait for it, or become it; it has said what went
   !> wrong
   !>
   !> Errors: ERR_FILE when there is no Python.
   subroutine run_python(words, become, code, error)
      type(text_t), intent(in) :: words(:)
      logical, intent(in) :: become              !! signals and exit code are those of the program
      integer, intent(out) :: code               !! exit code of the program
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: all_words
      integer :: i

      all_words = ''
      do i = 1, size(words)
         all_words = all_words//words(i)%s//c_null_char
      end do
      code = int(kj_run_python(all_words, int(size(words), c_int), merge(1_c_int, 0_c_int, become)))
      if (code /= NO_PYTHON) return
      call fail(error, ERR_FILE, 'there is no Python 3, which this needs')
      error%hint = 'install python3, or name one by the environment variable KJOINT_PYTHON'
   end subroutine run_python

   !> Append a word, and another one where it is there
   subroutine add_words(words, one, other)
      type(text_t), allocatable, intent(inout) :: words(:)
      character(len=*), intent(in) :: one
      character(len=*), intent(in), optional :: other

      if (.not. allocated(words)) allocate (words(0))
      call append_text(words, one)
      if (present(other)) call append_text(words, other)
   end subroutine add_words

end module kj_python
