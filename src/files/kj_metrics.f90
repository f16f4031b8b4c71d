!> Numbers that say how far one curve is from another, in one pass over their samples.
module kj_metrics
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use, intrinsic :: iso_fortran_env, only: int8
   implicit none
   private

   public :: metric_t, curve_sums_t, add_sample, finish_metrics, find_metrics, iso18571_t, &
      rate_iso18571

   integer, parameter :: ISO_SHORTEST = 9     !! samples that a rating needs

   !> The four ratings and their weighted sum
   type :: iso18571_t
      real(wp) :: corridor = 0.0_wp, phase = 0.0_wp, magnitude = 0.0_wp, slope = 0.0_wp
      real(wp) :: overall = 0.0_wp
   end type iso18571_t

   real(wp), parameter :: INNER = 0.05_wp, OUTER = 0.5_wp    !! half widths, of the largest value
   real(wp), parameter :: LARGEST_SHIFT = 0.2_wp             !! of the number of samples
   real(wp), parameter :: LARGEST_MAGNITUDE = 0.5_wp         !! error that is rated 0
   real(wp), parameter :: LARGEST_SLOPE = 2.0_wp             !! error that is rated 0
   real(wp), parameter :: weights(4) = [0.4_wp, 0.2_wp, 0.2_wp, 0.2_wp]
   integer, parameter :: BAND = 10         !! warping goes less than 1/BAND of the samples away
   integer, parameter :: HALF_WINDOW = 4   !! slopes are means of 9 samples
   integer(int8), parameter :: DIAGONAL = 0_int8, ALONG_RUN = 1_int8, ALONG_REF = 2_int8

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

   !> Rate a curve; samples of both at equal times, evenly spaced
   !>
   !> A part that is not defined (a reference that is zero or has no slope, less than ISO_SHORTEST
   !> samples, a sample that is not finite) is NaN, and so is the overall rating. Equal curves are
   !> rated 1 in every part.
   pure subroutine rate_iso18571(reference, curve, rating)
      real(wp), intent(in) :: reference(:), curve(:)      !! (n)
      type(iso18571_t), intent(out) :: rating

      integer :: n, shift, kept, at_ref, at_run
      real(wp) :: largest

      n = size(reference)
      rating%corridor = 1.0_wp
      rating%phase = 1.0_wp
      rating%magnitude = 1.0_wp
      rating%slope = 1.0_wp
      if (n < ISO_SHORTEST .or. .not. all(abs(reference) + abs(curve) <= huge(1.0_wp))) then
         rating%corridor = ieee_value(1.0_wp, ieee_quiet_nan)
      else if (any(abs(reference - curve) > 0.0_wp)) then
         rating%corridor = corridor_of(reference, curve)
         call find_shift(reference, curve, shift)
         largest = LARGEST_SHIFT*real(n, wp)
         rating%phase = max(0.0_wp, (largest - abs(real(shift, wp)))/largest)
         kept = n - abs(shift)
         at_ref = max(0, -shift)
         at_run = max(0, shift)
         associate (t => reference(at_ref + 1:at_ref + kept), c => curve(at_run + 1:at_run + kept))
            rating%magnitude = magnitude_of(kept, t, c)
            rating%slope = slope_of(kept, t, c)
         end associate
      end if
      rating%overall = weights(1)*rating%corridor + weights(2)*rating%phase + &
         weights(3)*rating%magnitude + weights(4)*rating%slope
   end subroutine rate_iso18571

   !> Mean of 1 inside the inner corridor, 0 outside the outer one, quadratic between
   pure real(wp) function corridor_of(t, c) result(score)
      real(wp), intent(in) :: t(:), c(:)

      real(wp) :: norm, d
      integer :: i

      norm = maxval(abs(t))
      if (.not. norm > 0.0_wp) then
         score = ieee_value(1.0_wp, ieee_quiet_nan)
         return
      end if
      score = 0.0_wp
      do i = 1, size(t)
         d = abs(t(i) - c(i))/norm
         if (d < INNER) then
            score = score + 1.0_wp
         else if (d <= OUTER) then
            score = score + ((OUTER - d)/(OUTER - INNER))**2
         end if
      end do
      score = score/real(size(t), wp)
   end function corridor_of

   !> The shift of the curve with the largest correlation, at most a fifth of the samples
   !>
   !> Positive: the curve is late, its sample i + shift belongs to sample i of the reference.
   pure subroutine find_shift(t, c, shift)
      real(wp), intent(in) :: t(:), c(:)
      integer, intent(out) :: shift

      real(wp) :: best, r
      integer :: n, m

      n = size(t)
      shift = 0
      best = -2.0_wp
      do m = 0, int(LARGEST_SHIFT*real(n, wp))
         r = correlation(n - m, t(:n - m), c(m + 1:))
         if (r > best) then
            best = r
            shift = m
         end if
         r = correlation(n - m, t(m + 1:), c(:n - m))
         if (r > best) then
            best = r
            shift = -m
         end if
      end do
   end subroutine find_shift

   !> Correlation coefficient; NaN when one of the two is constant
   pure real(wp) function correlation(n, a, b) result(r)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(n), b(n)

      real(wp) :: mean_a, mean_b

      mean_a = sum(a)/real(n, wp)
      mean_b = sum(b)/real(n, wp)
      r = sum((a - mean_a)*(b - mean_b))/sqrt(sum((a - mean_a)**2)*sum((b - mean_b)**2))
   end function correlation

   !> From the distance along the warping path with the least sum of squares
   pure real(wp) function magnitude_of(n, t, c) result(score)
      integer, intent(in) :: n
      real(wp), intent(in) :: t(n), c(n)

      integer(int8), allocatable :: from(:, :)     !! (-width:width, n): step to (i, i + offset)
      real(wp) :: distance, norm
      integer :: i, j, width

      width = (n - 1)/BAND
      allocate (from(-width:width, n))
      call warp(n, width, t, c, from)
      distance = 0.0_wp
      norm = 0.0_wp
      i = n
      j = n
      do
         distance = distance + abs(t(j) - c(i))
         norm = norm + abs(t(j))
         if (i == 1 .and. j == 1) exit
         select case (from(j - i, i))
         case (DIAGONAL)
            i = i - 1
            j = j - 1
         case (ALONG_RUN)
            i = i - 1
         case default
            j = j - 1
         end select
      end do
      score = max(0.0_wp, 1.0_wp - distance/norm/LARGEST_MAGNITUDE)
      if (.not. norm > 0.0_wp) score = ieee_value(1.0_wp, ieee_quiet_nan)
   end function magnitude_of

   !> Dynamic time warping in a band: the cheapest way to every pair of samples (c(i), t(j))
   pure subroutine warp(n, width, t, c, from)
      integer, intent(in) :: n, width
      real(wp), intent(in) :: t(n), c(n)
      integer(int8), intent(out) :: from(-width:width, n)

      real(wp) :: before(-width - 1:width + 1), now(-width - 1:width + 1), best, infinity
      integer :: i, j, k

      from = DIAGONAL
      infinity = ieee_value(1.0_wp, ieee_positive_inf)     ! dearer than squares that overflow
      now = infinity
      do i = 1, n
         before = now
         now = infinity
         do k = max(-width, 1 - i), min(width, n - i)
            j = i + k
            best = 0.0_wp
            if (i == 1 .and. j > 1) then
               best = now(k - 1)
               from(k, i) = ALONG_REF
            else if (i > 1 .and. j == 1) then
               best = before(k + 1)
               from(k, i) = ALONG_RUN
            else if (i > 1) then
               best = before(k)                      ! (i - 1, j - 1)
               if (before(k + 1) < best) then        ! (i - 1, j)
                  best = before(k + 1)
                  from(k, i) = ALONG_RUN
               end if
               if (now(k - 1) < best) then           ! (i, j - 1)
                  best = now(k - 1)
                  from(k, i) = ALONG_REF
               end if
            end if
            now(k) = best + (c(i) - t(j))**2
         end do
      end do
   end subroutine warp

   !> From the distance of the smoothed slopes
   pure real(wp) function slope_of(n, t, c) result(score)
      integer, intent(in) :: n
      real(wp), intent(in) :: t(n), c(n)

      real(wp) :: a(n), b(n), norm

      a = smooth(n, slopes(n, t))
      b = smooth(n, slopes(n, c))
      norm = sum(abs(a))
      score = max(0.0_wp, 1.0_wp - sum(abs(b - a))/norm/LARGEST_SLOPE)
      if (.not. norm > 0.0_wp) score = ieee_value(1.0_wp, ieee_quiet_nan)
   end function slope_of

   !> Slopes a sample: central inside, one-sided at the ends
   pure function slopes(n, x) result(d)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n)
      real(wp) :: d(n)

      d(1) = x(2) - x(1)
      d(2:n - 1) = 0.5_wp*(x(3:) - x(:n - 2))
      d(n) = x(n) - x(n - 1)
   end function slopes

   !> Means of 9 samples, of fewer near the ends, always centred
   pure function smooth(n, x) result(s)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n)
      real(wp) :: s(n)

      integer :: i, h

      do i = 1, n
         h = min(HALF_WINDOW, i - 1, n - i)
         s(i) = sum(x(i - h:i + h))/real(2*h + 1, wp)
      end do
   end function smooth

end module kj_metrics
