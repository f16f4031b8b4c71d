!> Decks that are changed a little, at random but always the same way for the same seed.
module fuzz_text
   implicit none
   private

   public :: random_t, seed_random, below, mutate, load_text, save_text

   integer, parameter :: long = selected_int_kind(18)
   character, parameter :: NL = new_line('a')

   !> Random numbers: x := 16807 x mod (2^31 - 1)
   type :: random_t
      integer(long) :: x = 1
   end type random_t

   !> What fields are replaced by
   character(len=20), parameter :: NASTY(*) = [character(len=20) :: '', '0', '-1', '1', '2', '3', &
      '4', '5', '6', '7', '8', '9', '10', '99', '2147483647', '-2147483648', '9999999999', '1.5', &
      '0.0', '-0.0', '1e308', '1e-308', '-1e300', '1e20', '1e-20', '1e999', '1d5', '1+5', '1e', &
      'NaN', 'Inf', '-', '+', '.', 'e', 'O', 'x y', '1 2', '1,2', ',,,,', '&p', '/', '#', '$', &
      '"', &
      '''', achar(9), achar(0), char(255), '1000000000000000000', '0.1', '1.0', '1.e6', 'X', 'YY', &
      'ZZ', 'NODE', 'SET', 'NODE_G', 'DEF', 'ALL']

   character(len=32), parameter :: HEADERS(*) = [character(len=32) :: '/END', '/BEGIN', '/NODE', &
      '/PART/1', '/RBODY/1', '/RBODY/2', '/FUNCT/1', '/SPRING/5', '/PROP/KJOINT/5', &
      '/PROP/KJOINT2/5', '/PROP/TYPE4/5', '/PROP/TYPE8/5', '/SKEW/MOV/1', '/SKEW/FIX/1', &
      '/GRNOD/GRNOD/1', &
      '/GRNOD/NODE/1001', '/SET/GENERAL/1001', '/BOX/RECTA/1', '/GRNOD/BOX/1001', '/UNIT/1', &
      '/MOVE_FUNCT/1', '/TH/NODE/1', '/TH/RBODY/1', '/TH/SPRING/1', '/ADMAS/5/1', '/ADMAS/0/1', &
      '/BCS/1', '/CLOAD/1', '/IMPDISP/1', '/IMPVEL/1', '/INIVEL/AXIS/1', '/SENSOR/TIME/1', &
      '/FRAME/NOD/1', '/GRAV/1', '/MAT/LAW1/1', '#include fuzz.inc', '/nonsense', '//SUBMODEL/1', &
      '//ENDSUB', '/SHELL/1', '/SH3N/1', '/BRICK/1', '/TETRA10/1', '/BEAM/1', '/SURF/PART/1', &
      '/SURF/SURF/1', '/GRBRIC/PART/1', '/GRSHEL/GRSHEL/1', '/SUBSET/1', '/LINE/EDGE/1', &
      '/TRANSFORM/ROT/1', '/TRANSFORM/POSITION/1', '/PARAMETER/LOCAL/REAL/1', &
      '/PARAMETER/LOCAL/INT_EXPR', '/RBE2/1', '/GRNOD/SURF/1001', '/GRNOD/SUBSET/1001', &
      '/ADMAS/3/1', '/PROP/SHELL/1', '/PROP/SH_SANDW/1', '/INTER/TYPE7/1', '/']

contains

   subroutine seed_random(random, seed)
      type(random_t), intent(out) :: random
      integer, intent(in) :: seed

      random%x = modulo(int(seed, long)*2654435761_long, 2147483646_long) + 1
   end subroutine seed_random

   !> A number from 1 to n
   integer function below(random, n)
      type(random_t), intent(inout) :: random
      integer, intent(in) :: n

      random%x = modulo(16807_long*random%x, 2147483647_long)
      below = int(modulo(random%x/7_long, int(n, long))) + 1
   end function below

   !> Change one thing
   subroutine mutate(random, text)
      type(random_t), intent(inout) :: random
      character(len=:), allocatable, intent(inout) :: text

      integer :: first, last

      call pick_line(random, text, first, last)
      select case (below(random, 20))
      case (1:10)
         call change_field(random, text, first, last)
      case (11)
         text = text(:first - 1)//text(last + 2:)                             ! a line less
      case (12)
         text = text(:last)//NL//text(first:)                                 ! a line twice
      case (13)
         text = text(:first - 1)//trim(HEADERS(below(random, size(HEADERS))))//NL//text(first:)
      case (14)
         call change_digit(random, text)
      case (15)
         if (last > first) text = text(:first)//text(first + 2:)              ! a column less
      case (16)
         text = text(:first - 1)//' '//text(first:)                           ! a column more
      case (17)
         text = text(:first - 1)//NL//text(first:)                            ! a blank line
      case (18)
         text(max(1, min(first + below(random, 40), len(text))):) = &
            text(max(1, min(first + below(random, 40), len(text))):)
         if (below(random, 30) == 1) text = text(:first)                      ! the end is lost
      case (19)
         call swap_fields(random, text, first, last)
      case default
         call change_character(random, text)
      end select
      if (len(text) == 0) text = NL
   end subroutine mutate

   !> First and last byte of some line
   subroutine pick_line(random, text, first, last)
      type(random_t), intent(inout) :: random
      character(len=*), intent(in) :: text
      integer, intent(out) :: first, last

      integer :: at, n

      at = below(random, len(text))
      first = index(text(:at - 1), NL, back=.true.) + 1
      n = index(text(first:), NL)
      last = len(text)
      if (n > 0) last = first + n - 2
   end subroutine pick_line

   !> Put something else into ten or twenty columns
   subroutine change_field(random, text, first, last)
      type(random_t), intent(inout) :: random
      character(len=:), allocatable, intent(inout) :: text
      integer, intent(in) :: first, last

      integer :: width, column, from
      character(len=:), allocatable :: line
      character(len=20) :: field

      width = 10*below(random, 2)
      if (last - first < 10) width = 10
      column = (below(random, max(1, (last - first + width)/width)) - 1)*width
      line = text(first:last)//repeat(' ', max(0, column + width - (last - first + 1)))
      field = NASTY(below(random, size(NASTY)))
      from = column + width - min(width, len_trim(field)) + 1
      line(column + 1:column + width) = ' '
      line(from:column + width) = field
      text = text(:first - 1)//line//text(last + 1:)
   end subroutine change_field

   !> Exchange two fields of ten columns
   subroutine swap_fields(random, text, first, last)
      type(random_t), intent(inout) :: random
      character(len=*), intent(inout) :: text
      integer, intent(in) :: first, last

      character(len=10) :: keep
      integer :: a, b, n

      n = (last - first + 1)/10
      if (n < 2) return
      a = first + 10*(below(random, n) - 1)
      b = first + 10*(below(random, n) - 1)
      keep = text(a:a + 9)
      text(a:a + 9) = text(b:b + 9)
      text(b:b + 9) = keep
   end subroutine swap_fields

   !> Another digit somewhere
   subroutine change_digit(random, text)
      type(random_t), intent(inout) :: random
      character(len=*), intent(inout) :: text

      integer :: at, n

      at = below(random, len(text))
      n = scan(text(at:), '0123456789')
      if (n == 0) return
      at = at + n - 1
      n = below(random, 10)
      text(at:at) = '0123456789'(n:n)
   end subroutine change_digit

   !> Another character somewhere
   subroutine change_character(random, text)
      type(random_t), intent(inout) :: random
      character(len=*), intent(inout) :: text

      integer :: at

      at = below(random, len(text))
      text(at:at) = achar(below(random, 256) - 1)
   end subroutine change_character

   subroutine load_text(path, text)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text

      integer :: unit, n

      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
         action='read')
      inquire (unit=unit, size=n)
      allocate (character(len=n) :: text)
      read (unit) text
      close (unit)
   end subroutine load_text

   subroutine save_text(path, text)
      character(len=*), intent(in) :: path, text

      integer :: unit

      open (newunit=unit, file=path, access='stream', form='unformatted', status='replace')
      write (unit) text
      close (unit)
   end subroutine save_text

end module fuzz_text
