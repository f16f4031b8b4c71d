!> Units as a deck names them: a prefix and g, m or s, or the SI value of the unit.
module kj_deck_units
   use kj_kinds, only: wp
   use kj_number, only: parse_real, NUMBER_FINE
   implicit none
   private

   public :: read_unit

   !> What a base unit is called
   integer, parameter, public :: UNIT_MASS = 1, UNIT_LENGTH = 2, UNIT_TIME = 3

   !> A prefix of a unit
   type :: prefix_t
      character(len=2) :: name       !! as in a deck
      character(len=2) :: symbol     !! as in UDUNITS
      real(wp)         :: value
      real(wp)         :: of_gram    !! SI value of the gram with it: rounded once
   end type prefix_t

   type(prefix_t), parameter :: prefixes(*) = [ &
      prefix_t('',   '',   1e0_wp,   1e-3_wp),  &
      prefix_t('k',  'k',  1e3_wp,   1e0_wp),   &
      prefix_t('m',  'm',  1e-3_wp,  1e-6_wp),  &
      prefix_t('M',  'M',  1e6_wp,   1e3_wp),   &
      prefix_t('mu', 'u',  1e-6_wp,  1e-9_wp),  &
      prefix_t('u',  'u',  1e-6_wp,  1e-9_wp),  &
      prefix_t('n',  'n',  1e-9_wp,  1e-12_wp), &
      prefix_t('p',  'p',  1e-12_wp, 1e-15_wp), &
      prefix_t('f',  'f',  1e-15_wp, 1e-18_wp), &
      prefix_t('a',  'a',  1e-18_wp, 1e-21_wp), &
      prefix_t('z',  'z',  1e-21_wp, 1e-24_wp), &
      prefix_t('y',  'y',  1e-24_wp, 1e-27_wp), &
      prefix_t('c',  'c',  1e-2_wp,  1e-5_wp),  &
      prefix_t('d',  'd',  1e-1_wp,  1e-4_wp),  &
      prefix_t('da', 'da', 1e1_wp,   1e-2_wp),  &
      prefix_t('h',  'h',  1e2_wp,   1e-1_wp),  &
      prefix_t('K',  'k',  1e3_wp,   1e0_wp),   &
      prefix_t('G',  'G',  1e9_wp,   1e6_wp),   &
      prefix_t('T',  'T',  1e12_wp,  1e9_wp),   &
      prefix_t('P',  'P',  1e15_wp,  1e12_wp),  &
      prefix_t('E',  'E',  1e18_wp,  1e15_wp),  &
      prefix_t('Z',  'Z',  1e21_wp,  1e18_wp),  &
      prefix_t('Y',  'Y',  1e24_wp,  1e21_wp)]

   !> SI values beyond make factors and products of them that no real holds
   real(wp), parameter :: LEAST = 1.0e-30_wp, MOST = 1.0e30_wp

   character(len=1), parameter :: BASE(3) = ['g', 'm', 's']
   character(len=2), parameter :: SI_SYMBOL(3) = ['kg', 'm ', 's ']

contains

   !> SI value and UDUNITS symbol of a unit; found = .false. when the text is none, or a number
   !> beyond 1e-30 to 1e30
   !>
   !> 'Mg' and '1000.' are the tonne. A number that no code stands for keeps its value in the
   !> symbol: '(0.3048 m)'.
   pure subroutine read_unit(text, kind, si, symbol, found)
      character(len=*), intent(in) :: text        !! no blanks around it
      integer, intent(in) :: kind                 !! UNIT_ constant
      real(wp), intent(out) :: si
      character(len=20), intent(out) :: symbol
      logical, intent(out) :: found

      integer :: i, status
      real(wp) :: value

      symbol = SI_SYMBOL(kind)
      call parse_real(text, si, status)
      found = status == NUMBER_FINE .and. si >= LEAST .and. si <= MOST
      do i = 1, size(prefixes)
         value = merge(prefixes(i)%of_gram, prefixes(i)%value, kind == UNIT_MASS)
         if (found) then
            if (abs(value - si) > 1e-12_wp*si) cycle
         else
            if (text /= trim(prefixes(i)%name)//BASE(kind)) cycle
            si = value
         end if
         found = .true.
         symbol = trim(prefixes(i)%symbol)//BASE(kind)
         return
      end do
      if (found) symbol = '('//text(:min(len(text), 13))//' '//trim(SI_SYMBOL(kind))//')'
      if (.not. found) si = 1.0_wp
   end subroutine read_unit

end module kj_deck_units
