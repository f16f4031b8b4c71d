!> `kjoint new`: a commented deck to begin with, one of those in decks/, which the program holds.
module kj_new_command
   use kj_error, only: error_t, fail, ERR_INPUT, ERR_FILE
   use kj_system, only: file_kind, KIND_NONE, c_text
   use kj_text, only: text_t
   use kj_output, only: write_output
   use kj_option, only: arguments_t
   use kj_joint_types, only: joint_types
   use kj_spelling, only: upper, did_you_mean
   use kj_terminal, only: print_line
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr
   implicit none
   private

   public :: new_command, shipped_count, shipped_name, shipped_text

   interface
      integer(c_int) function kj_shipped_count() bind(c)
         import :: c_int
      end function kj_shipped_count
      type(c_ptr) function kj_shipped_name(i) bind(c)
         import :: c_int, c_ptr
         integer(c_int), value :: i
      end function kj_shipped_name
      type(c_ptr) function kj_shipped_text(i) bind(c)
         import :: c_int, c_ptr
         integer(c_int), value :: i
      end function kj_shipped_text
   end interface

   character(len=*), parameter :: STARTER = '_0000.rad'
   integer, parameter :: WIDTH = 60

contains

   !> Write the starter and the engine deck of a kind into this folder, or list the kinds.
   !>
   !> Errors: ERR_INPUT when there is no such kind, ERR_FILE when a file of the name is there
   subroutine new_command(args, error)
      type(arguments_t), intent(in) :: args
      type(error_t), allocatable, intent(out) :: error

      character(len=WIDTH), allocatable :: kinds(:), about(:)
      character(len=:), allocatable :: word
      integer :: k, type, status

      call list_kinds(kinds, about)
      if (args%n_operand == 0) then
         call print_line('kjoint new KIND writes KIND_0000.rad and KIND_0001.rad. Kinds:')
         do k = 1, size(kinds)
            call print_line('   '//kinds(k)(:24)//trim(about(k)))
         end do
         return
      end if
      word = args%operand(1)%s
      read (word, *, iostat=status) type         ! the number of a joint type, or a part of the name
      if (status == 0 .and. type > 0 .and. type <= size(joint_types)) word = joint_types(type)%name
      word = trim(upper(word))
      do k = 1, size(kinds)
         if (index(upper(kinds(k)), word) == 1) exit
      end do
      if (k > size(kinds)) then
         do k = 1, size(kinds)
            if (index(upper(about(k)), '('//word//')') > 0) exit
         end do
      end if
      if (k > size(kinds)) then
         call fail(error, ERR_INPUT, 'there is no deck of the kind "'//args%operand(1)%s//'"')
         error%hint = trim(did_you_mean(args%operand(1)%s, kinds))
         if (len(error%hint) == 0) error%hint = '`kjoint new` lists them'
         return
      end if
      call write_deck(trim(kinds(k))//STARTER, error)
      if (.not. allocated(error)) call write_deck(trim(kinds(k))//'_0001.rad', error)
      if (.not. allocated(error)) call print_line('kjoint run '//trim(kinds(k))//STARTER)
   end subroutine new_command

   !> The names of the starter decks, without their end, and how their second line begins
   subroutine list_kinds(kinds, about)
      character(len=WIDTH), allocatable, intent(out) :: kinds(:), about(:)

      character(len=:), allocatable :: name, text
      integer :: i, first

      allocate (kinds(0), about(0))
      do i = 1, shipped_count()
         call shipped_name(i, name)
         if (index(name, STARTER) == 0) cycle
         call shipped_text(i, text)
         first = index(text, new_line('a')//'# ') + 3
         kinds = [character(len=WIDTH) :: kinds, name(:len(name) - len(STARTER))]
         about = [character(len=WIDTH) :: about, text(first:first + scan(text(first:), ':,.;') - 2)]
      end do
   end subroutine list_kinds

   !> A shipped deck into this folder; nothing happens when there is none of this name.
   !> Errors: ERR_FILE when a file of this name is there, or it cannot be written
   subroutine write_deck(name, error)
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: shipped, text
      integer :: i

      do i = 1, shipped_count()
         call shipped_name(i, shipped)
         if (shipped /= name) cycle
         if (file_kind(name) /= KIND_NONE) call fail(error, ERR_FILE, name//' is there already')
         call shipped_text(i, text)
         call write_output(name, text, [text_t ::], error)
      end do
   end subroutine write_deck

   !> Number of files
   integer function shipped_count() result(n)
      n = kj_shipped_count()
   end function shipped_count

   !> Name of file i of 1, 2, ...
   subroutine shipped_name(i, name)
      integer, intent(in) :: i
      character(len=:), allocatable, intent(out) :: name

      call c_text(kj_shipped_name(int(i - 1, c_int)), name)
   end subroutine shipped_name

   !> Its text
   subroutine shipped_text(i, text)
      integer, intent(in) :: i
      character(len=:), allocatable, intent(out) :: text

      call c_text(kj_shipped_text(int(i - 1, c_int)), text)
   end subroutine shipped_text

end module kj_new_command
