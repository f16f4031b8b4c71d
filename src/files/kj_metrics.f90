!> Numbers that say how far one curve is from another, in one pass over their samples.
module kj_metrics
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   implicit none
   private

   public :: metric_t, curve_sums_t, add_sample, finish_metrics, find_metrics

   !> Columns of the results, one a row of the table below
   integer, parameter, public :: M_MAX = 1, M_NRMSE = 2, M_PEARSON = 3, M_SG_M = 4, M_SG_P = 5, &
      M_SG_C = 6, M_ISO_Z = 7, M_ISO_P = 8, M_ISO_M = 9, M_ISO_S = 10, M_ISO = 11

   !> One column of the results
   type :: metric_t
      character(len=14) :: option      !! name on the command line
      character(len=10) :: column      !! name of the number
      character(len=62) :: meaning
   end type metric_t

   type(metric_t), parameter, public :: metrics(*) = [ &
      metric_t('max',            'max',       'largest difference'), &
      metric_t('nrmse',          'nrmse',     'root mean square difference over the range of REF'), &
      metric_t('pearson',        'pearson',   'correlation coefficient'), &
      metric_t('sprague-geers',  'sg_m',      'Sprague and Geers, magnitude'), &
      metric_t('sprague-geers',  'sg_p',      'Sprague and Geers, phase'), &
      metric_t('sprague-geers',  'sg_c',      'Sprague and Geers, combined'), &
      metric_t('iso18571',       'iso_z',     'ISO/TS 18571, corridor rating'), &
      metric_t('iso18571',       'iso_p',     'ISO/TS 18571, phase rating'), &
      metric_t('iso18571',       'iso_m',     'ISO/TS 18571, magnitude rating'), &
      metric_t('iso18571',       'iso_s',     'ISO/TS 18571, slope rating'), &
      metric_t('iso18571',       'iso',       'ISO/TS 18571, overall rating')]

   !> Running sums over the samples of two curves x (REF) and y (RUN)
   type :: curve_sums_t
      integer :: n = 0
      real(wp) :: largest = 0.0_wp               !! of |x - y|
      real(wp) :: low = 0.0_wp, high = 0.0_wp    !! range of x
      real(wp) :: square = 0.0_wp                !! sum of (x - y)**2
      real(wp) :: mean_x = 0.0_wp, mean_y = 0.0_wp
      real(wp) :: var_x = 0.0_wp, var_y = 0.0_wp, cov = 0.0_wp        !! times n
      real(wp) :: int_xx = 0.0_wp, int_yy = 0.0_wp, int_xy = 0.0_wp   !! integrals over time
      real(wp) :: t = 0.0_wp, x = 0.0_wp, y = 0.0_wp                  !! the sample before
   end type curve_sums_t

contains

   !> Take a sample; one that is not finite on a side is passed over
   pure subroutine add_sample(sums, t, x, y)
      type(curve_sums_t), intent(inout) :: sums
      real(wp), intent(in) :: t, x, y

      real(wp) :: dx, dy

      if (.not. (abs(x) <= huge(x) .and. abs(y) <= huge(y))) return
      if (sums%n == 0) then
         sums%low = x
         sums%high = x
      else
         ! trapezoidal rule
         associate (h => 0.5_wp*(t - sums%t))
            sums%int_xx = sums%int_xx + h*(sums%x**2 + x**2)
            sums%int_yy = sums%int_yy + h*(sums%y**2 + y**2)
            sums%int_xy = sums%int_xy + h*(sums%x*sums%y + x*y)
         end associate
      end if
      sums%n = sums%n + 1
      sums%largest = max(sums%largest, abs(x - y))
      sums%low = min(sums%low, x)
      sums%high = max(sums%high, x)
      sums%square = sums%square + (x - y)**2
      ! Welford's update, which does not cancel
      dx = x - sums%mean_x
      dy = y - sums%mean_y
      sums%mean_x = sums%mean_x + dx/real(sums%n, wp)
      sums%mean_y = sums%mean_y + dy/real(sums%n, wp)
      sums%var_x = sums%var_x + dx*(x - sums%mean_x)
      sums%var_y = sums%var_y + dy*(y - sums%mean_y)
      sums%cov = sums%cov + dx*(y - sums%mean_y)
      sums%t = t
      sums%x = x
      sums%y = y
   end subroutine add_sample

   !> The metrics of one pass; NaN where one is not defined (a constant curve has no correlation)
   !>
   !>   nrmse   = sqrt(mean (x - y)**2)/(max x - min x)
   !>   sg_m    = sqrt(int y y/int x x) - 1
   !>   sg_p    = acos(int x y/sqrt(int x x int y y))/pi
   !>   sg_c    = sqrt(sg_m**2 + sg_p**2)
   !>
   !> Source: Sprague and Geers, Commun. Numer. Meth. Engng 20 (2004), doi:10.1002/cnm.681.
   pure subroutine finish_metrics(sums, values)
      type(curve_sums_t), intent(in) :: sums
      real(wp), intent(inout) :: values(:)      !! (size(metrics)); the ISO columns stay

      real(wp), parameter :: PI = acos(-1.0_wp)
      real(wp) :: c

      values(M_MAX:M_SG_C) = ieee_value(1.0_wp, ieee_quiet_nan)
      if (sums%n == 0) return
      values(M_MAX) = sums%largest
      if (sums%high > sums%low) then
         values(M_NRMSE) = sqrt(sums%square/real(sums%n, wp))/(sums%high - sums%low)
      else if (sums%largest <= 0.0_wp) then
         values(M_NRMSE) = 0.0_wp
      end if
      if (sums%var_x > 0.0_wp .and. sums%var_y > 0.0_wp) &
         values(M_PEARSON) = sums%cov/(sqrt(sums%var_x)*sqrt(sums%var_y))
      if (.not. sums%int_xx > 0.0_wp) return
      values(M_SG_M) = sqrt(sums%int_yy/sums%int_xx) - 1.0_wp
      if (.not. sums%int_yy > 0.0_wp) return
      c = sums%int_xy/(sqrt(sums%int_xx)*sqrt(sums%int_yy))
      values(M_SG_P) = acos(max(-1.0_wp, min(1.0_wp, c)))/PI
      values(M_SG_C) = sqrt(values(M_SG_M)**2 + values(M_SG_P)**2)
   end subroutine finish_metrics

   !> Columns for a list of options, "max,iso18571"
   !>
   !> Errors: ERR_INPUT when a name is not known.
   subroutine find_metrics(list, wanted, error)
      character(len=*), intent(in) :: list
      logical, intent(out) :: wanted(size(metrics))
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: name, known
      integer :: first, length, i

      wanted = .false.
      first = 1
      do while (first <= len(list) + 1)
         length = index(list(first:)//',', ',') - 1
         name = trim(adjustl(list(first:first + length - 1)))
         first = first + length + 1
         if (.not. any(metrics%option == name)) then
            known = ''
            do i = 1, size(metrics)
               if (index(known, trim(metrics(i)%option)) > 0) cycle
               known = known//' '//trim(metrics(i)%option)
            end do
            call fail(error, ERR_INPUT, 'there is no metric "'//name//'", but'//known)
            return
         end if
         where (metrics%option == name) wanted = .true.
      end do
   end subroutine find_metrics

end module kj_metrics
