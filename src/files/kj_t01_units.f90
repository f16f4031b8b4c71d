!> Unit symbols for the SI factors that a T01 holds.
module kj_t01_units
   use kj_kinds, only: wp
   use kj_units, only: unit_system_t
   implicit none
   private

   public :: name_units

   type :: symbol_t
      integer          :: base       !! 1 mass, 2 length, 3 time
      character(len=2) :: text       !! UDUNITS symbol
      real(wp)         :: si         !! its SI value
   end type symbol_t

   type(symbol_t), parameter :: symbols(*) = [ &
      symbol_t(1, 'kg', 1.0_wp),    &
      symbol_t(1, 'g',  1.0e-3_wp), &
      symbol_t(1, 'mg', 1.0e-6_wp), &
      symbol_t(1, 'Mg', 1.0e3_wp),  &
      symbol_t(1, 'Gg', 1.0e6_wp),  &
      symbol_t(2, 'm',  1.0_wp),    &
      symbol_t(2, 'cm', 1.0e-2_wp), &
      symbol_t(2, 'mm', 1.0e-3_wp), &
      symbol_t(2, 'um', 1.0e-6_wp), &
      symbol_t(2, 'km', 1.0e3_wp),  &
      symbol_t(3, 's',  1.0_wp),    &
      symbol_t(3, 'ms', 1.0e-3_wp), &
      symbol_t(3, 'us', 1.0e-6_wp)]

   real(wp), parameter :: ROUNDING = 1.0e-6_wp     !! the file may hold 32-bit reals

contains

   !> Units from SI values; one without a symbol is written as a number and its SI unit
   subroutine name_units(si, units)
      real(wp), intent(in) :: si(3)                !! of the units of mass, length and time
      type(unit_system_t), intent(out) :: units

      character(len=*), parameter :: si_symbol(3) = ['kg', 'm ', 's ']
      integer :: i, j

      do i = 1, 3
         units%si(i) = si(i)
         write (units%symbol(i), '(a,es13.7,a)') '(', si(i), ' '//trim(si_symbol(i))//')'
         do j = 1, size(symbols)
            if (symbols(j)%base /= i) cycle
            if (abs(si(i) - symbols(j)%si) > ROUNDING*symbols(j)%si) cycle
            units%si(i) = symbols(j)%si
            units%symbol(i) = symbols(j)%text
         end do
      end do
   end subroutine name_units

end module kj_t01_units
