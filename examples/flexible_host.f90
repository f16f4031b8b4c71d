!> An explicit beam code whose two flexible parts are joined by kjoint: a cantilever in two pieces,
!> welded at half length, bent by a force at its tip, damped until it rests.
!>
!> Joints are meant for rigid parts. Here the axes of a joint end come from beam nodes that bend, so
!> they lose their right angles: that is measured, warned about, and checked against beam theory,
!> as is the deflection.
module beams
   use kjoint, only: wp
   implicit none
   private

   public :: add_beam, turn_by, turned_vector

   real(wp), parameter, public :: LENGTH = 0.5_wp, SIDE = 0.02_wp             !! m
   real(wp), parameter, public :: AREA = SIDE**2, SECOND = SIDE**4/12.0_wp
   real(wp), parameter, public :: YOUNG = 210.0e9_wp, DENSITY = 7800.0_wp
   real(wp), parameter, public :: SHEAR = 5.0_wp/6.0_wp*YOUNG/2.6_wp*AREA     !! N
   real(wp), parameter, public :: BENDING = YOUNG*SECOND                      !! N m2
   real(wp), parameter :: TORSION = YOUNG/2.6_wp*0.1406_wp*SIDE**4

contains

   !> Forces and moments of a beam (one-point Timoshenko, along x of its nodes) on both its nodes
   subroutine add_beam(l, xa, xb, qa, qb, fa, fb, ma, mb)
      real(wp), intent(in) :: l, xa(3), xb(3), qa(4), qb(4)
      real(wp), intent(inout) :: fa(3), fb(3), ma(3), mb(3)

      real(wp) :: p(4), mid(4), r(3), strain(3), curvature(3), n(3), m(3)

      p = times([qa(1), -qa(2:4)], qb)           ! turn of b in a
      curvature = 2.0_wp*p(2:4)/l                ! small turns along a beam
      mid = p + [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      mid = times(qa, mid/norm2(mid))
      r = xb - xa
      strain = turned_vector([mid(1), -mid(2:4)], r)/l - [1.0_wp, 0.0_wp, 0.0_wp]
      n = turned_vector(mid, [YOUNG*AREA, SHEAR, SHEAR]*strain)
      m = turned_vector(mid, [TORSION, BENDING, BENDING]*curvature)
      fa = fa + n
      fb = fb - n
      ma = ma + m + 0.5_wp*cross(r, n)
      mb = mb - m + 0.5_wp*cross(r, n)
   end subroutine add_beam

   !> q := exp(phi) q, phi small
   subroutine turn_by(phi, q)
      real(wp), intent(in) :: phi(3)
      real(wp), intent(inout) :: q(4)

      q = times([1.0_wp, 0.5_wp*phi], q)
      q = q/norm2(q)
   end subroutine turn_by

   pure function turned_vector(q, a) result(b)
      real(wp), intent(in) :: q(4), a(3)
      real(wp) :: b(3)

      b = 2.0_wp*cross(q(2:4), a)
      b = a + q(1)*b + cross(q(2:4), b)
   end function turned_vector

   pure function times(a, b) result(c)
      real(wp), intent(in) :: a(4), b(4)
      real(wp) :: c(4)

      c = [a(1)*b(1) - dot_product(a(2:4), b(2:4)), &
         a(1)*b(2:4) + b(1)*a(2:4) + cross(a(2:4), b(2:4))]
   end function times

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

end module beams

program flexible_host
   use kjoint, only: wp, error_t, finding_list_t, joint_set_t, joint_spec_t, joint_result_t, &
      new_joint_set, add_joint, start_joints, joint_forces, joint_stiffness, joint_result, &
      joint_warnings
   use beams, only: add_beam, turn_by, turned_vector, LENGTH, SIDE, AREA, SECOND, DENSITY, YOUNG, &
      SHEAR, BENDING
   implicit none

   integer, parameter :: PIECES = 10             !! beams a part
   integer, parameter :: JOINT(2) = [PIECES + 1, PIECES + 2], TIP = 2*PIECES + 2
   integer, parameter :: SIDE_NODE(2) = [TIP + 1, TIP + 2], N = TIP + 2
   real(wp), parameter :: L = LENGTH/(2*PIECES)
   real(wp), parameter :: PUSH = 500.0_wp, KN = 1.0e7_wp    !! N, N/m
   real(wp), parameter :: LIMIT = 3.0e-4_wp                 !! warn above this loss [rad]

   type(error_t), allocatable :: error
   logical :: good

   good = .true.
   call bend('legacy')
   call bend('consistent')
   if (.not. good) error stop 1

contains

   !> The welded cantilever to its rest; the joint by one formulation
   subroutine bend(formulation)
      character(len=*), intent(in) :: formulation

      type(joint_set_t) :: set
      real(wp), dimension(3, N) :: x, v, w, f, m
      real(wp) :: q(4, N), mass(N), inertia(3, N), kn(N), kr(N), h, time, alpha
      integer :: i, e

      call lay_out(x, mass, inertia)
      v = 0.0_wp
      w = 0.0_wp
      q = spread([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 2, N)
      call weld(formulation, x, mass, inertia, q, set)
      alpha = 2.0_wp*3.516_wp*sqrt(BENDING/(DENSITY*AREA*LENGTH**4))   ! critical for the first mode
      time = 0.0_wp
      h = 0.0_wp
      do while (time < 0.04_wp)
         f = -alpha*spread(mass, 1, 3)*v
         m = -alpha*inertia*w
         f(3, TIP) = f(3, TIP) + PUSH
         do i = 1, TIP - 1                       ! the host's own elements first
            if (i == JOINT(1)) cycle
            call add_beam(L, x(:, i), x(:, i + 1), q(:, i), q(:, i + 1), f(:, i), f(:, i + 1), &
               m(:, i), m(:, i + 1))
         end do
         call joint_forces(set, time, h, x, v, w, f, m, error, q)
         call stop_on(error)
         if (.not. h > 0.0_wp) then              ! stiffness of beams and joint: nodal step
            kn = 4.0_wp*YOUNG*AREA/L
            kr = 4.0_wp*(BENDING/L + 0.25_wp*SHEAR*L)
            call joint_stiffness(set, kn, kr, error)
            call stop_on(error)
            h = 0.6_wp*sqrt(2.0_wp*min(minval(mass(:TIP)/kn(:TIP)), &
               minval(inertia(1, :TIP)/kr(:TIP))))
         end if
         do i = 2, TIP                           ! node 1 is clamped
            v(:, i) = v(:, i) + h*f(:, i)/mass(i)
            w(:, i) = w(:, i) + h*m(:, i)/inertia(:, i)
            x(:, i) = x(:, i) + h*v(:, i)
            call turn_by(h*w(:, i), q(:, i))
         end do
         do e = 1, 2                             ! side nodes ride on the joint nodes
            x(:, SIDE_NODE(e)) = x(:, JOINT(e)) + turned_vector(q(:, JOINT(e)), &
               [0.0_wp, 0.0_wp, SIDE])
         end do
         time = time + h
      end do
      call compare(formulation, x(3, TIP), set)
   end subroutine bend

   !> Nodes along x, the two joint nodes at one place; lumped masses
   subroutine lay_out(x, mass, inertia)
      real(wp), intent(out) :: x(3, N), mass(N), inertia(3, N)

      integer :: i

      x = 0.0_wp
      mass = 0.0_wp
      do i = 1, TIP
         x(1, i) = L*merge(i - 1, i - 2, i <= JOINT(1))
         mass(i) = DENSITY*AREA*L
         if (any(i == [1, TIP, JOINT])) mass(i) = 0.5_wp*mass(i)
      end do
      x(:, SIDE_NODE) = x(:, JOINT) + spread([0.0_wp, 0.0_wp, SIDE], 2, 2)
      inertia = 0.5_wp*L**2*spread(mass, 1, 3)   ! scaled up: only the rest counts here
   end subroutine lay_out

   !> Legacy: the axes of the joint follow nodes. Consistent: the attitudes of the joint nodes.
   subroutine weld(formulation, x, mass, inertia, q, set)
      character(len=*), intent(in) :: formulation
      real(wp), intent(in) :: x(3, N), mass(N), inertia(3, N), q(4, N)
      type(joint_set_t), intent(out) :: set

      type(joint_spec_t) :: fixed

      call new_joint_set(set, formulation, N, error)
      call stop_on(error)
      fixed%id = 1
      fixed%type = 8
      fixed%node = JOINT
      fixed%kn = KN
      if (formulation == 'legacy') then
         fixed%first_frame = .true.
         fixed%axis_node(:, 1) = [JOINT(1), JOINT(1) - 1, SIDE_NODE(1)]
         fixed%axis_node(:, 2) = [JOINT(2), JOINT(2) + 1, SIDE_NODE(2)]
      end if
      call add_joint(set, fixed, error)
      call stop_on(error)
      call start_joints(set, x, mass, inertia, error, q)
      call stop_on(error)
   end subroutine weld

   !> Deflection P L^3/3EI + P L/kGA + P/Kn + (P L/2)(L/2)/Kr, Kr = Kn*(1 m)^2; the angle between a
   !> beam at the joint and its end section: half the bend of that beam, P (L/2 + l/2)/EI * l/2,
   !> less the shear P/kGA
   subroutine compare(formulation, deflection, set)
      character(len=*), intent(in) :: formulation
      real(wp), intent(in) :: deflection
      type(joint_set_t), intent(inout) :: set

      type(joint_result_t) :: result
      type(finding_list_t) :: findings
      real(wp) :: exact, loss

      call joint_result(set, 1, result, error)
      call stop_on(error)
      exact = PUSH*LENGTH**3/(3.0_wp*BENDING) + PUSH*LENGTH/SHEAR + PUSH/KN + &
         0.25_wp*PUSH*LENGTH**2/KN
      loss = PUSH*(0.5_wp*LENGTH + 0.5_wp*L)/BENDING*0.5_wp*L - PUSH/SHEAR
      if (formulation == 'consistent') loss = 0.0_wp
      print '(a,2(a,f8.4),2(a,es9.2))', formulation, ': deflection ', 1.0e3_wp*deflection, &
         ' mm, theory ', 1.0e3_wp*exact, ' mm; loss of orthogonality ', result%orthogonality, &
         ' rad, theory ', loss
      good = good .and. abs(deflection/exact - 1.0_wp) < 3.0e-3_wp .and. &
         abs(result%orthogonality - loss) < 0.02_wp*loss + 1.0e-12_wp
      call joint_warnings(set, LIMIT, findings)
      if (findings%n_warning > 0) print '(2a)', 'warning: ', findings%item(1)%message
      good = good .and. (findings%n_warning > 0 .eqv. formulation == 'legacy')
   end subroutine compare

   subroutine stop_on(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      print '(2a)', 'flexible_host: ', error%message
      error stop 2
   end subroutine stop_on

end program flexible_host
