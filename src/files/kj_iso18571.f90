!> Objective rating of one curve against another after ISO/TS 18571: corridor, phase, magnitude
!> and slope, each between 0 and 1, and their weighted sum.
!>
!> Written from the published method. What the text leaves open (rounding of the largest shift and
!> of the warping band, smoothing at the ends) was chosen so that the ratings agree with those of
!> the Python package objective-rating-metrics: tests/diff/check_iso18571.py.
module kj_iso18571
   use, intrinsic :: iso_fortran_env, only: int8
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use kj_kinds, only: wp
   implicit none
   private

   public :: iso18571_t, rate_iso18571

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

contains

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

end module kj_iso18571
