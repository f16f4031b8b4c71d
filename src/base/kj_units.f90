!> THE table of physical dimensions: exponents of mass, length and time, and their unit text.
!> Deck fields and output channels name a row by its D_ constant.
module kj_units
   use kj_kinds, only: wp
   implicit none
   private

   public :: unit_system_t, dimension_t, factor_of, unit_text

   integer, parameter, public :: D_NUMBER = 1, D_LENGTH = 2, D_MASS = 3, D_TIME = 4, D_INERTIA = &
      5, &
      D_FORCE = 6, D_MOMENT = 7, D_STIFFNESS = 8, D_ROT_STIFFNESS = 9, D_DAMPING = 10, &
      D_ROT_DAMPING = 11, D_VELOCITY = 12, D_ANGULAR_VELOCITY = 13, D_ACCELERATION = 14, &
      D_ANGULAR_ACCELERATION = 15, D_ENERGY = 16, D_ANGLE = 17, D_MOMENTUM = 18, &
      D_ANGULAR_MOMENTUM = 19, D_DENSITY = 20, D_AREA_DENSITY = 21

   !> A row of the table
   type :: dimension_t
      character(len=20) :: name
      integer :: exponents(3)    !! of mass, length, time
      logical :: angle           !! carries rad in its unit text
   end type dimension_t

   type(dimension_t), parameter, public :: dimensions(*) = [ &
      !           name                    M  L  T   rad
      dimension_t('number',               [0, 0, 0],  .false.), &
      dimension_t('length',               [0, 1, 0],  .false.), &
      dimension_t('mass',                 [1, 0, 0],  .false.), &
      dimension_t('time',                 [0, 0, 1],  .false.), &
      dimension_t('inertia',              [1, 2, 0],  .false.), &
      dimension_t('force',                [1, 1, -2], .false.), &
      dimension_t('moment',               [1, 2, -2], .false.), &
      dimension_t('stiffness',            [1, 0, -2], .false.), &
      dimension_t('rotational stiffness', [1, 2, -2], .false.), &
      dimension_t('damping',              [1, 0, -1], .false.), &
      dimension_t('rotational damping',   [1, 2, -1], .false.), &
      dimension_t('velocity',             [0, 1, -1], .false.), &
      dimension_t('angular velocity',     [0, 0, -1], .true.),  &
      dimension_t('acceleration',         [0, 1, -2], .false.), &
      dimension_t('angular acceleration', [0, 0, -2], .true.),  &
      dimension_t('energy',               [1, 2, -2], .false.), &
      dimension_t('angle',                [0, 0, 0],  .true.),  &
      dimension_t('momentum',             [1, 1, -1], .false.), &
      dimension_t('angular momentum',     [1, 2, -1], .false.), &
      dimension_t('density',              [1, -3, 0], .false.), &
      dimension_t('mass of an area',      [1, -2, 0], .false.)]

   !> A triple of base units; si is NaN where a file does not say its units, and the symbols are
   !> words for them
   type :: unit_system_t
      real(wp) :: si(3) = 1.0_wp                                !! SI value of mass, length, time
      character(len=20) :: symbol(3) = ['kg', 'm ', 's ']       !! UDUNITS symbols
   end type unit_system_t

   character(len=20), parameter, public :: NO_UNITS(3) = [character(len=20) :: 'mass', 'length', &
      'time']

contains

   !> Factor that turns a value in `input` units into `work` units, for one row of dimensions
   pure real(wp) function factor_of(dim, input, work) result(factor)
      integer, intent(in) :: dim                       !! D_ constant
      type(unit_system_t), intent(in) :: input, work

      integer :: i

      factor = 1.0_wp
      do i = 1, 3
         factor = factor*(input%si(i)/work%si(i))**dimensions(dim)%exponents(i)
      end do
   end function factor_of

   !> The same with blanks behind
   pure function unit_field(dim, units) result(text)
      integer, intent(in) :: dim
      type(unit_system_t), intent(in) :: units
      character(len=80) :: text

      character(len=*), parameter :: POWER(-3:2) = ['-3', '-2', '-1', '  ', '  ', '2 ']
      integer :: i, e

      text = ''
      if (dimensions(dim)%angle) text = 'rad'
      do i = 1, 3
         e = dimensions(dim)%exponents(i)
         if (e == 0) cycle
         text = adjustl(trim(text)//' '//trim(units%symbol(i))//POWER(e))
      end do
      if (len_trim(text) == 0) text = '1'
   end function unit_field

   !> Characters in the unit of a dimension
   pure integer function unit_length(dim, units) result(n)
      integer, intent(in) :: dim
      type(unit_system_t), intent(in) :: units

      n = len_trim(unit_field(dim, units))
   end function unit_length

   !> Unit of a dimension in UDUNITS form: "kg m s-2", "rad s-1", "1"
   pure function unit_text(dim, units) result(text)
      integer, intent(in) :: dim                       !! D_ constant
      type(unit_system_t), intent(in) :: units
      character(len=unit_length(dim, units)) :: text

      text = unit_field(dim, units)
   end function unit_text

end module kj_units
