!> TABLE of the names of T01 variables, for those that our layout does not hold.
module kj_t01_names
   use kj_error, only: str
   implicit none
   private

   public :: t01_name

   !> Type codes of what is no group in the file
   integer, parameter, public :: OF_GLOBALS = -1, OF_PARTS = -2, OF_SUBSETS = -3

   type :: owner_name_t
      integer           :: type
      character(len=10) :: name
   end type owner_name_t

   type(owner_name_t), parameter :: owner_names(*) = [ &
      owner_name_t(OF_GLOBALS, ''),          &
      owner_name_t(OF_PARTS,   'part'),      &
      owner_name_t(OF_SUBSETS, 'subset'),    &
      owner_name_t(0,          'node'),      &
      owner_name_t(1,          'brick'),     &
      owner_name_t(2,          'quad'),      &
      owner_name_t(3,          'shell'),     &
      owner_name_t(4,          'truss'),     &
      owner_name_t(5,          'beam'),      &
      owner_name_t(6,          'joint'),     &
      owner_name_t(7,          'sh3n'),      &
      owner_name_t(51,         'sphcel'),    &
      owner_name_t(101,        'inter'),     &
      owner_name_t(102,        'rwall'),     &
      owner_name_t(103,        'rigid_body'), &
      owner_name_t(104,        'section'),   &
      owner_name_t(105,        'cyl_jo'),    &
      owner_name_t(106,        'airbag'),    &
      owner_name_t(107,        'monvol'),    &
      owner_name_t(108,        'accel'),     &
      owner_name_t(109,        'rivet'),     &
      owner_name_t(110,        'frame'),     &
      owner_name_t(111,        'fxbody'),    &
      owner_name_t(113,        'gauge'),     &
      owner_name_t(114,        'cluster'),   &
      owner_name_t(115,        'sph_flow'),  &
      owner_name_t(116,        'surf'),      &
      owner_name_t(117,        'tria'),      &
      owner_name_t(118,        'slipring'),  &
      owner_name_t(119,        'retractor'), &
      owner_name_t(120,        'sensor'),    &
      owner_name_t(121,        'checksum')]

   !> Names of variables with codes that follow one another
   type :: code_names_t
      integer           :: type      !! type code of the owner
      integer           :: first     !! code of the first name
      character(len=70) :: names     !! blanks between them
   end type code_names_t

   type(code_names_t), parameter :: code_names(*) = [ &
      code_names_t(OF_GLOBALS, 1,   'IE KE XMOM YMOM ZMOM MASS DT RKE EFW SIE CE HE'), &
      code_names_t(OF_GLOBALS, 13,  'CE_ELAST CE_FRIC CE_DAMP WPLA DMASS DMASS% M_IN M_OUT E_IN E_OUT'), &
      code_names_t(OF_PARTS,   1,   'IE KE XMOM YMOM ZMOM MASS HE TURBKE XCG YCG ZCG'), &
      code_names_t(OF_PARTS,   21,  'RIE KERB RKERB RKE ERODED'), &
      code_names_t(OF_PARTS,   28,  'HEAT VX VY VZ PW'), &
      code_names_t(OF_SUBSETS, 1,   'IE KE XMOM YMOM ZMOM MASS HE TURBKE XCG YCG ZCG'), &
      code_names_t(OF_SUBSETS, 21,  'RIE KERB RKERB RKE ERODED'), &
      code_names_t(OF_SUBSETS, 28,  'HEAT VX VY VZ PW'), &
      code_names_t(0,          1,   'DX DY DZ VX VY VZ AX AY AZ VRX VRY VRZ ARX ARY ARZ X Y Z TEMP'), &
      code_names_t(0,          620, 'REACX REACY REACZ REACXX REACYY REACZZ DRX DRY DRZ PEXT'), &
      code_names_t(6,          1,   'OFF FX FY FZ MX MY MZ LX LY LZ RX RY RZ IE F1 F2'), &
      code_names_t(6,          65,  'LENGTH FAIL'), &
      code_names_t(103,        1,   'FX FY FZ MX MY MZ RX RY RZ FXI FYI FZI MXI MYI MZI X Y Z DX DY DZ'), &
      code_names_t(103,        22,  'VX VY VZ AX AY AZ VRX VRY VRZ ARX ARY ARZ'), &
      code_names_t(103,        34,  'MASS IXX IYY IZZ IXY IYZ IZX STATUS')]

contains

   !> Name of a variable as we write it: "SIE", "node/TEMP", "section/7" where it has no name here
   pure function t01_name(type, code) result(text)
      integer, intent(in) :: type, code
      character(len=:), allocatable :: text

      integer :: i

      text = str(code)
      do i = 1, size(code_names)
         if (code_names(i)%type /= type .or. code < code_names(i)%first) cycle
         call take_word(trim(code_names(i)%names), code - code_names(i)%first + 1, text)
      end do
      do i = 1, size(owner_names)
         if (owner_names(i)%type /= type) cycle
         if (type /= OF_GLOBALS) text = trim(owner_names(i)%name)//'/'//text
         return
      end do
      text = 'type '//str(type)//'/'//text
   end function t01_name

   !> The n-th word; `word` stays when there are fewer
   pure subroutine take_word(text, n, word)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      character(len=:), allocatable, intent(inout) :: word

      integer :: i, first, length

      first = 1
      do i = 1, n
         length = index(text(first:)//' ', ' ') - 1
         if (length <= 0) return
         if (i < n) first = first + length + 1
         if (first > len(text)) return
      end do
      word = text(first:first + length - 1)
   end subroutine take_word

end module kj_t01_names
