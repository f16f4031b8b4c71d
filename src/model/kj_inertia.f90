!> Mass, centre of gravity and principal axes of a rigid body from its main and secondary nodes.
!> Source: docs/theory/legacy.md 2.1, 2.2.
module kj_inertia
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_math3, only: IDENTITY, cross, unit
   use kj_lapack, only: principal_axes
   implicit none
   private

   public :: body_input_t, body_mass_t, gather_body, correct_inertia

   !> What the deck says
   type :: body_input_t
      integer :: icog = 1, ispher = 2
      logical :: swept = .false.               !! principal axes as Radioss finds them
      real(wp) :: x(3) = 0.0_wp               !! main node as typed
      real(wp) :: mass = 0.0_wp               !! nodal mass of the main node plus that of the card
      real(wp) :: node_inertia = 0.0_wp       !! nodal inertia of the main node
      real(wp) :: j(3, 3) = 0.0_wp            !! inertia of the card, global axes
   end type body_input_t

   !> What follows
   type :: body_mass_t
      real(wp) :: x(3) = 0.0_wp               !! main node moved to its place
      real(wp) :: mass = 0.0_wp
      real(wp) :: principal(3) = 0.0_wp       !! descending, before the Ispher correction
      real(wp) :: axes(3, 3) = 0.0_wp         !! columns, right-handed
   end type body_mass_t

contains

   !> Collect a body.
   !>
   !> Errors: ERR_INTERNAL when the eigenvalues do not converge.
   subroutine gather_body(input, x, mass, inertia, body, error)
      type(body_input_t), intent(in) :: input
      real(wp), intent(in) :: x(:, :)                  !! (n, 3) secondary nodes
      real(wp), intent(in) :: mass(:), inertia(:)      !! (n) their own
      type(body_mass_t), intent(out) :: body
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: main, j(3, 3)
      integer :: i

      main = input%mass
      if (abs(main) <= 0.0_wp) main = 1.0e-20_wp
      body%x = input%x
      body%mass = main
      if (input%icog <= 3) body%mass = main + sum(mass)
      if (input%icog == 1) body%x = (main*input%x + matmul(mass, x))/body%mass
      if (input%icog == 2 .and. sum(mass) > 0.0_wp) body%x = matmul(mass, x)/sum(mass)
      j = input%j + input%node_inertia*IDENTITY
      if (input%icog == 1) j = j + main*steiner(input%x - body%x)
      if (input%icog <= 3) then
         do i = 1, size(mass)
            j = j + inertia(i)*IDENTITY + mass(i)*steiner(x(i, :) - body%x)
         end do
      end if
      if (size(mass) == 1) j = j + 1.0e-20_wp*IDENTITY
      if (input%swept) then
         call swept_axes(j, body%principal, body%axes)
      else
         call principal_axes(j, body%principal, body%axes, error)
      end if
   end subroutine gather_body

   !> Principal axes by Jacobi's rotations, with the thresholds and the order of OpenRadioss.
   !>
   !> Legacy quirk: the norm that the thresholds come from has a22 in place of an off-diagonal
   !> entry, and off-diagonals up to 3e-8 of it may be left over. Source: docs/theory/legacy.md 2.2.
   pure subroutine swept_axes(j, principal, axes)
      real(wp), intent(in) :: j(3, 3)
      real(wp), intent(out) :: principal(3), axes(3, 3)   !! descending; columns, right-handed

      integer, parameter :: PAIR(2, 3) = reshape([1, 2, 1, 3, 2, 3], [2, 3])
      real(wp) :: a(3, 3), norm2, threshold, least, swap(3)
      integer :: i, k, sweep
      logical :: turned

      a = j
      axes = IDENTITY
      norm2 = 2.0_wp*a(1, 2)**2 + 2.0_wp*a(1, 3)**2 + a(2, 3)**2 + a(2, 2)**2
      threshold = 1.414_wp*sqrt(norm2)/3.0_wp
      least = threshold*real(1.0e-7, wp)
      turned = norm2 > 0.0_wp
      do sweep = 1, merge(1000, 0, turned)
         turned = .false.
         do i = 1, 3
            call turn_pair(PAIR(1, i), PAIR(2, i), threshold, a, axes, turned)
         end do
         if (turned) cycle
         if (.not. threshold > least) exit
         threshold = threshold/3.0_wp
      end do
      do i = 1, 3
         do k = i, 3
            if (.not. a(i, i) < a(k, k)) cycle
            swap = [a(i, i), a(k, k), 0.0_wp]
            a(i, i) = swap(2)
            a(k, k) = swap(1)
            swap = axes(:, i)
            axes(:, i) = axes(:, k)
            axes(:, k) = swap
         end do
         principal(i) = a(i, i)
      end do
      axes(:, 1) = unit(axes(:, 1))
      axes(:, 2) = unit(axes(:, 2))
      axes(:, 3) = unit(cross(axes(:, 1), axes(:, 2)))
   end subroutine swept_axes

   !> Rotation that clears entry (l, m), l < m, of a symmetric matrix, of which the upper triangle
   !> is kept; none where the entry is below the threshold
   pure subroutine turn_pair(l, m, threshold, a, axes, turned)
      integer, intent(in) :: l, m
      real(wp), intent(in) :: threshold
      real(wp), intent(inout) :: a(3, 3), axes(3, 3)
      logical, intent(inout) :: turned           !! becomes true where it rotates

      real(wp) :: x, y, s, c, kl, km, ll, mm, column(3)
      integer :: k

      if (abs(a(l, m)) < threshold .or. abs(a(l, m)) <= 0.0_wp) return
      turned = .true.
      x = 0.5_wp*(a(l, l) - a(m, m))
      y = -a(l, m)/sqrt(a(l, m)**2 + x**2)
      if (x < 0.0_wp) y = -y
      s = y/sqrt(2.0_wp*(1.0_wp + sqrt(abs(1.0_wp - y**2))))
      c = sqrt(abs(1.0_wp - s**2))
      k = 6 - l - m
      kl = a(min(k, l), max(k, l))
      km = a(min(k, m), max(k, m))
      a(min(k, l), max(k, l)) = c*kl - s*km
      a(min(k, m), max(k, m)) = s*kl + c*km
      column = axes(:, l)
      axes(:, l) = c*column - s*axes(:, m)
      axes(:, m) = s*column + c*axes(:, m)
      ll = a(l, l)
      mm = a(m, m)
      a(l, l) = c**2*ll + s**2*mm - 2.0_wp*a(l, m)*s*c
      a(m, m) = s**2*ll + c**2*mm + 2.0_wp*a(l, m)*s*c
      a(l, m) = (ll - mm)*s*c + a(l, m)*(c**2 - s**2)
   end subroutine turn_pair

   !> |r|^2 1 - r r^T
   pure function steiner(r) result(d)
      real(wp), intent(in) :: r(3)
      real(wp) :: d(3, 3)

      d = dot_product(r, r)*IDENTITY - spread(r, 2, 3)*spread(r, 1, 3)
   end function steiner

   !> The Ispher rule: 1 mean of the three; 2 where the smallest is under a thousandth of the
   !> largest, such values get a tenth of the largest on top; 3 nothing. changed: rule 2 acted
   pure subroutine correct_inertia(ispher, principal, changed)
      integer, intent(in) :: ispher
      real(wp), intent(inout) :: principal(3)          !! descending
      logical, intent(out) :: changed

      real(wp) :: largest

      changed = .false.
      largest = principal(1)
      if (ispher == 1) principal = sum(principal)/3.0_wp
      if (ispher /= 2) return
      if (principal(3) > real(1.0e-3, wp)*largest) return
      changed = .true.
      where (principal/largest < 1.0e-3_wp) principal = principal + 0.1_wp*largest
   end subroutine correct_inertia

end module kj_inertia
