!> `kjoint help /GRAV`: the page of a keyword of the starter deck, from the tables that read it.
module kj_card_page
   use kj_error, only: str
   use kj_units, only: dimensions
   use kj_joint_types, only: joint_types
   use kj_keywords, only: keywords, keyword_of, READ_IT, ASIDE, FULL_ONLY, NOTE_IT, HEAD_ID, &
      HEAD_UNIT, HEAD_TYPE_ID, KW_KJOINT
   use kj_card_fields, only: fields, field_t, EACH, ROWS, DOFS, IDS, PAIRS, TRIPLES, NAMES, CLAUSES
   use kj_new_command, only: shipped_count, shipped_name, shipped_text
   use kj_spelling, only: upper
   use kj_terminal, only: print_line
   implicit none
   private

   public :: find_keyword_page, print_keyword_page

contains

   !> Row of the keyword that a word of a user means: /GRAV, grav; 0 for none
   integer function find_keyword_page(word) result(row)
      character(len=*), intent(in) :: word

      do row = size(keywords), 1, -1
         if (keywords(row)%name == upper(word)) return
      end do
   end function find_keyword_page

   !> What it is, its header, its cards with columns, and an empty block to fill in
   subroutine print_keyword_page(row)
      integer, intent(in) :: row

      integer :: type, keyword

      associate (k => keywords(row))
         call print_line(trim(k%name)//': '//trim(k%meaning))
         call print_line('')
         select case (k%status)
         case (READ_IT, ASIDE)
         case (FULL_ONLY)
            call print_line('   read with --mechanism and by extract')
         case (NOTE_IT)
            call print_line('   not read: it does not change what kjoint computes')
            return
         case default
            call print_line('   not supported: an error, or a warning with --ignore-unsupported')
            return
         end select
         keyword = keyword_of(row)
         if (.not. any(fields%keyword == keyword .and. fields%variant /= EACH)) &
            call print_block(row, keyword, EACH)
         do type = 0, maxval(fields%variant, mask=fields%keyword == keyword)
            if (.not. any(fields%keyword == keyword .and. fields%variant == type)) cycle
            call print_line(trim(merge('type '//str(type)//', '//joint_types(max(1, type))%name, &
               'type '//str(type)//repeat(' ', 2 + len(joint_types%name)), keyword == KW_KJOINT)))
            call print_block(row, keyword, type)
            call print_line('')
         end do
         call print_example(row)
      end associate
   end subroutine print_keyword_page

   !> The cards of one variant
   subroutine print_block(row, keyword, variant)
      integer, intent(in) :: row, keyword, variant

      integer :: card, i
      logical :: here(size(fields))

      here = fields%keyword == keyword .and. (fields%variant == EACH .or. &
         fields%variant == variant .or. variant == EACH)
      if (any(here)) call print_line('   card     columns name         meaning [dimension]')
      do i = 1, size(fields)
         if (here(i)) call print_field(i)
      end do
      if (any(here)) call print_line('')
      call print_line('   Columns are fixed: ten for an integer, twenty for a number. To fill in:')
      call print_line('')
      call print_line(header(row, variant))
      if (keywords(row)%titled) call print_line('a title')
      do card = 1, maxval(fields%card, mask=here)
         if (any(here .and. fields%card == card)) then
            call print_line(ruler(here .and. fields%card == card))
            call print_line('')
         end if
      end do
   end subroutine print_block

   subroutine print_field(i)
      integer, intent(in) :: i

      character(len=100) :: line
      character(len=7) :: kind
      type(field_t) :: f

      f = fields(i)
      kind = 'text'
      if (f%kind == 'i') kind = 'integer'
      if (f%kind == 'r') kind = 'real'
      line = str(f%card)//repeated(f%times)
      write (line(10:), '(i0,a,i0)') f%first, '-', f%last
      line(18:) = trim(f%name)
      line(31:) = trim(f%meaning)
      if (f%dim > 1) line = trim(line)//' ['//trim(dimensions(f%dim)%name)//']'
      if (kind /= 'real') line = trim(line)//' ('//trim(kind)//')'
      if (f%since > 0) line = trim(line)//', format '//str(f%since)//' and later'
      call print_line('   '//trim(line))
   end subroutine print_field

   !> The block of a shipped deck that has this keyword, else another name of it
   subroutine print_example(row)
      integer, intent(in) :: row

      character(len=:), allocatable :: deck, text
      integer :: i, j, first, last

      do i = 1, shipped_count()
         call shipped_name(i, deck)
         if (index(deck, '_0000.rad') == 0) cycle
         call shipped_text(i, text)
         call find_block(text, trim(keywords(row)%name), first, last)
         do j = 1, merge(size(keywords), 0, first > last .and. keyword_of(row) > 0)
            if (keyword_of(j) /= keyword_of(row)) cycle
            call find_block(text, trim(keywords(j)%name), first, last)
            if (first <= last) exit
         end do
         if (first > last) cycle
         call print_line('')
         call print_line('   From '//deck//' (kjoint new '//deck(:len(deck) - 9)//'):')
         call print_line('')
         call print_line(text(first:last))
         return
      end do
   end subroutine print_example

   !> From the header of a keyword to the last line before the next header that is no comment
   pure subroutine find_block(text, name, first, last)
      character(len=*), intent(in) :: text, name
      integer, intent(out) :: first, last        !! characters; first above last: it has none

      integer :: from, to

      first = index(new_line('a')//text, new_line('a')//name//new_line('a'))
      if (first == 0) first = index(new_line('a')//text, new_line('a')//name//'/')
      last = first - 1
      if (first == 0) then
         first = 1
         last = 0
         return
      end if
      from = first
      do
         to = index(text(from:), new_line('a')) - 1
         if (to < 0) to = len(text) - from + 1
         if (from > first .and. text(from:min(from, len(text))) == '/') exit
         if (scan(text(from:min(from, len(text))), '#$') == 0) last = from + to - 1
         from = from + to + 1
         if (from > len(text)) exit
      end do
   end subroutine find_block

   !> How often a card stands
   pure function repeated(times) result(text)
      integer, intent(in) :: times
      character(len=:), allocatable :: text

      select case (times)
      case (ROWS); text = ' ...'
      case (DOFS); text = ' a dof'
      case (IDS, PAIRS, TRIPLES, NAMES, CLAUSES); text = ' list'
      case default; text = ''
      end select
   end function repeated

   pure function header(row, variant) result(text)
      integer, intent(in) :: row, variant
      character(len=:), allocatable :: text

      text = trim(keywords(row)%name)
      select case (keywords(row)%head)
      case (HEAD_ID); text = text//'/1'
      case (HEAD_TYPE_ID); text = text//'/'//str(max(0, variant))//'/1'
      case (HEAD_UNIT)
      end select
   end function header

   !> A comment with the names of the fields in their columns, to the right as numbers stand
   pure function ruler(here) result(text)
      logical, intent(in) :: here(:)               !! by fields
      character(len=:), allocatable :: text

      integer :: i, n

      text = repeat(' ', maxval(fields%last, mask=here))
      text(1:1) = '#'
      do i = 1, size(fields)
         if (.not. here(i)) cycle
         n = min(len_trim(fields(i)%name), fields(i)%last - max(fields(i)%first, 2) + 1)
         text(fields(i)%last - n + 1:fields(i)%last) = fields(i)%name(:n)
      end do
   end function ruler

end module kj_card_page
