!> Piecewise linear functions: all curves of a model in one pair of arrays.
module kj_curve
   use kj_kinds, only: wp
   implicit none
   private

   public :: curve_set_t, law_value, load_value, curve_integral, curve_moment, add_curve, &
      steepest_rise

   !> Curve c has the points first(c) .. first(c + 1) - 1, abscissae ascending; the arrays may be
   !> longer than n curves need
   type :: curve_set_t
      integer :: n = 0
      integer, allocatable :: id(:)          !! (n) user ids
      integer, allocatable :: first(:)       !! (n + 1)
      real(wp), allocatable :: x(:), y(:)
   end type curve_set_t

contains

   !> Append a curve
   subroutine add_curve(set, id, x, y)
      type(curve_set_t), intent(inout) :: set
      integer, intent(in) :: id
      real(wp), intent(in) :: x(:), y(:)     !! same size, x ascending

      integer :: from, to, room

      if (.not. allocated(set%id)) then
         allocate (set%id(0), set%first(1), set%x(0), set%y(0))
         set%first = 1
      end if
      from = set%first(set%n + 1)
      to = from + size(x) - 1
      if (set%n == size(set%id)) then
         set%id = [set%id, [(0, room=1, set%n + 8)]]
         set%first = [set%first, [(0, room=1, set%n + 8)]]
      end if
      if (to > size(set%x)) then
         set%x = [set%x, [(0.0_wp, room=1, to + 8)]]
         set%y = [set%y, [(0.0_wp, room=1, to + 8)]]
      end if
      set%n = set%n + 1
      set%id(set%n) = id
      set%x(from:to) = x
      set%y(from:to) = y
      set%first(set%n + 1) = to + 1
   end subroutine add_curve

   !> First point of the segment that holds x: the first segment whose right end is >= x, else the
   !> last
   pure integer function segment(set, c, x) result(left)
      type(curve_set_t), intent(in) :: set
      integer, intent(in) :: c
      real(wp), intent(in) :: x

      integer :: right, middle

      left = set%first(c)
      right = set%first(c + 1) - 1
      do while (right - left > 1)
         middle = (left + right)/2
         if (set%x(middle) >= x) then
            right = middle
         else
            left = middle
         end if
      end do
   end function segment

   !> Value and slope of a joint curve, end segments extended; a one-point curve is 0
   pure subroutine law_value(set, c, x, y, slope)
      type(curve_set_t), intent(in) :: set
      integer, intent(in) :: c               !! index of the curve
      real(wp), intent(in) :: x
      real(wp), intent(out) :: y, slope      !! slope of the left segment at a knot

      integer :: i

      y = 0.0_wp
      slope = 0.0_wp
      if (set%first(c + 1) - set%first(c) < 2) return
      i = segment(set, c, x)
      slope = (set%y(i + 1) - set%y(i))/(set%x(i + 1) - set%x(i))
      y = set%y(i) + slope*(x - set%x(i))
   end subroutine law_value

   !> Value of a load curve, end segments extended; a one-point curve is constant, curve 0 is 1
   pure real(wp) function load_value(set, c, x) result(y)
      type(curve_set_t), intent(in) :: set
      integer, intent(in) :: c               !! index of the curve, 0 = constant 1
      real(wp), intent(in) :: x

      real(wp) :: slope

      y = 1.0_wp
      if (c == 0) return
      if (set%first(c + 1) - set%first(c) == 1) then
         y = set%y(set%first(c))
      else
         call law_value(set, c, x, y, slope)
      end if
   end function load_value

   !> Exact integral of a joint curve from a to b
   pure real(wp) function curve_integral(set, c, a, b) result(area)
      type(curve_set_t), intent(in) :: set
      integer, intent(in) :: c
      real(wp), intent(in) :: a, b

      real(wp) :: from, to, y1, y2, slope
      integer :: i

      area = 0.0_wp
      from = min(a, b)
      do i = set%first(c) + 1, set%first(c + 1) - 1
         to = min(set%x(i), max(a, b))
         if (i == set%first(c + 1) - 1) to = max(a, b)
         if (to <= from) cycle
         slope = (set%y(i) - set%y(i - 1))/(set%x(i) - set%x(i - 1))
         y1 = set%y(i - 1) + slope*(from - set%x(i - 1))
         y2 = set%y(i - 1) + slope*(to - set%x(i - 1))
         area = area + 0.5_wp*(y1 + y2)*(to - from)
         from = to
      end do
      if (b < a) area = -area
   end function curve_integral

   !> Exact integral of (b - s) f(s) over s from a to b: f integrated twice; a <= b
   pure real(wp) function curve_moment(set, c, a, b) result(area)
      type(curve_set_t), intent(in) :: set
      integer, intent(in) :: c
      real(wp), intent(in) :: a, b

      real(wp) :: from, to, y1, y2, slope, h
      integer :: i, last

      area = 0.0_wp
      from = a
      last = set%first(c + 1) - 1
      do i = set%first(c) + 1, last
         to = min(set%x(i), b)
         if (i == last) to = b
         if (to <= from) cycle
         slope = (set%y(i) - set%y(i - 1))/(set%x(i) - set%x(i - 1))
         y1 = set%y(i - 1) + slope*(from - set%x(i - 1))
         y2 = set%y(i - 1) + slope*(to - set%x(i - 1))
         h = to - from
         area = area + (b - to)*0.5_wp*h*(y1 + y2) + h**2*(2.0_wp*y1 + y2)/6.0_wp
         from = to
      end do
   end function curve_moment

   !> Steepest rise of a curve anywhere, 0 where it only falls
   pure real(wp) function steepest_rise(curves, curve) result(slope)
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: curve               !! index

      integer :: p

      slope = 0.0_wp
      do p = curves%first(curve), curves%first(curve + 1) - 2
         slope = max(slope, (curves%y(p + 1) - curves%y(p))/(curves%x(p + 1) - curves%x(p)))
      end do
   end function steepest_rise

end module kj_curve
