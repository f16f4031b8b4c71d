!> Mass, centre of gravity and principal axes of a rigid body from its main and secondary nodes.
!> Source: docs/theory/legacy.md 2.1, 2.2.
module kj_inertia
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_math3, only: IDENTITY
   use kj_lapack, only: principal_axes
   implicit none
   private

   public :: body_input_t, body_mass_t, gather_body, correct_inertia

   !> What the deck says
   type :: body_input_t
      integer :: icog = 1, ispher = 2
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
      call principal_axes(j, body%principal, body%axes, error)
   end subroutine gather_body

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
