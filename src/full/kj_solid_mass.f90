!> Volumes of solid elements and what share of them each node has. Source: docs/theory/full.md 2.3.
module kj_solid_mass
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_full_property, only: section_t
   implicit none
   private

   public :: brick_shares, wedge_shares, tetra_shares, tetra10_shares, brick20_shares, &
      shell16_shares, shell_area, triangle_area, triangle_shares, shell_inertia, beam_inertia

   !> Signs of the corners of a brick, in the order of its nodes
   real(wp), parameter :: R(8) = [-1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, &
      -1.0_wp]
   real(wp), parameter :: S(8) = [-1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, &
      1.0_wp]
   real(wp), parameter :: T(8) = [-1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, &
      1.0_wp]
   real(wp), parameter :: GAUSS = 1.0_wp/sqrt(3.0_wp)
   real(wp), parameter :: C = 3.0_wp/14.0_wp     !! mass of a corner over that of a mid node
   !> Edges with the mid nodes 5 to 10 of a tetrahedron
   integer, parameter :: EDGE4(2, 6) = reshape([1, 2, 2, 3, 3, 1, 1, 4, 2, 4, 3, 4], [2, 6])
   !> Edges with the mid nodes 9 to 20 of a brick: below, upright, above
   integer, parameter :: EDGE8(2, 12) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 1, 5, 2, 6, 3, 7, 4, 8, &
      5, 6, 6, 7, 7, 8, 8, 5], [2, 12])

contains

   !> Trilinear shape functions at a point
   pure function shape8(p) result(n)
      real(wp), intent(in) :: p(3)
      real(wp) :: n(8)

      n = 0.125_wp*(1.0_wp + R*p(1))*(1.0_wp + S*p(2))*(1.0_wp + T*p(3))
   end function shape8

   !> Their derivatives with respect to the point
   pure function slopes8(p) result(d)
      real(wp), intent(in) :: p(3)
      real(wp) :: d(3, 8)

      d(1, :) = 0.125_wp*R*(1.0_wp + S*p(2))*(1.0_wp + T*p(3))
      d(2, :) = 0.125_wp*S*(1.0_wp + R*p(1))*(1.0_wp + T*p(3))
      d(3, :) = 0.125_wp*T*(1.0_wp + R*p(1))*(1.0_wp + S*p(2))
   end function slopes8

   pure real(wp) function det(a)
      real(wp), intent(in) :: a(3, 3)

      det = dot_product(a(:, 1), cross(a(:, 2), a(:, 3)))
   end function det

   !> Shares of a brick: V/8 each; under Isolid 12 the integral of each shape function
   !>
   !> V = 8 det J at the centre; for Isolid 14, 17 and 18 the sum over 2x2x2 points.
   pure function brick_shares(x, isolid) result(share)
      real(wp), intent(in) :: x(3, 8)
      integer, intent(in) :: isolid
      real(wp) :: share(8)                       !! volume of each node

      real(wp) :: p(3), part(8)
      integer :: i

      select case (isolid)
      case (12, 14, 17, 18)
         part = 0.0_wp
         do i = 1, 8
            p = GAUSS*[R(i), S(i), T(i)]
            part = part + shape8(p)*det(matmul(x, transpose(slopes8(p))))
         end do
         share = abs(part)
         if (isolid /= 12) share = abs(sum(part))/8.0_wp
      case default
         share = abs(det(matmul(x, transpose(slopes8([0.0_wp, 0.0_wp, 0.0_wp])))))
      end select
   end function brick_shares

   !> Shares of a wedge: V/6 each, V = det J in its middle; weighted by the angles of the middle
   !> triangle when imas > 0
   pure function wedge_shares(x, imas) result(share)
      real(wp), intent(in) :: x(3, 6)
      integer, intent(in) :: imas
      real(wp) :: share(6)

      real(wp) :: a(3, 3), middle(3, 3), up(3)

      middle = 0.5_wp*(x(:, :3) + x(:, 4:))
      up = 0.5_wp*sum(x(:, 4:) - x(:, :3), 2)/3.0_wp
      a(:, 1) = middle(:, 2) - middle(:, 1)
      a(:, 2) = middle(:, 3) - middle(:, 1)
      a(:, 3) = up
      share = abs(det(a))/6.0_wp
      if (imas > 0) share = share*3.0_wp*[triangle_shares(middle), triangle_shares(middle)]
   end function wedge_shares

   !> Shares of a tetrahedron: V/4 each, or by the area of the face opposite to the node (imas 1)
   pure function tetra_shares(x, imas) result(share)
      real(wp), intent(in) :: x(3, 4)
      integer, intent(in) :: imas
      real(wp) :: share(4)

      real(wp) :: volume

      volume = abs(det(x(:, 2:) - spread(x(:, 1), 2, 3)))/6.0_wp
      share = volume/4.0_wp
      if (imas == 1) share = volume*face_weights(x)/4.0_wp
   end function tetra_shares

   !> 4 (area of the face opposite to node k)/(sum of the four faces)
   pure function face_weights(x) result(f)
      real(wp), intent(in) :: x(3, 4)
      real(wp) :: f(4)

      integer :: k, o(3)

      do k = 1, 4
         o = pack([1, 2, 3, 4], [1, 2, 3, 4] /= k)
         f(k) = norm2(cross(x(:, o(2)) - x(:, o(1)), x(:, o(3)) - x(:, o(1))))
      end do
      f = 4.0_wp*f/sum(f)
   end function face_weights

   !> Shares of a tetrahedron of ten nodes: corners C, mid nodes 1 of 4 C + 6; a mid node that is
   !> missing gives its share to the ends of its edge. itetra10 2, 3: corners alone
   pure function tetra10_shares(x, there, itetra10, imas) result(share)
      real(wp), intent(in) :: x(3, 10)           !! missing ones are not looked at
      logical, intent(in) :: there(10)
      integer, intent(in) :: itetra10, imas
      real(wp) :: share(10)

      real(wp), parameter :: A = (5.0_wp + 3.0_wp*sqrt(5.0_wp))/20.0_wp, &
         B = (5.0_wp - sqrt(5.0_wp))/20.0_wp
      real(wp) :: y(3, 10), l(4), slopes(3, 10), volume, weight(10)
      integer :: i

      y = x
      weight(:4) = 1.0_wp
      if (imas == 1) weight(:4) = face_weights(x(:, :4))
      do i = 1, 6
         if (.not. there(4 + i)) y(:, 4 + i) = 0.5_wp*(x(:, EDGE4(1, i)) + x(:, EDGE4(2, i)))
         weight(4 + i) = 0.5_wp*sum(weight(EDGE4(:, i)))
      end do
      volume = 0.0_wp
      do i = 1, 4
         l = B
         l(i) = A
         slopes = slopes10(l)
         volume = volume + abs(det(matmul(y, transpose(slopes))))/24.0_wp
      end do
      if (itetra10 == 2 .or. itetra10 == 3) then
         share(:4) = 0.25_wp*volume*weight(:4)
         share(5:) = 0.0_wp
         return
      end if
      share(:4) = volume*C/(4.0_wp*C + 6.0_wp)*weight(:4)
      share(5:) = volume/(4.0_wp*C + 6.0_wp)*weight(5:)
      call hand_on(EDGE4, there, share)
   end function tetra10_shares

   !> Derivatives of the shape functions of a tetrahedron of ten nodes with respect to l2, l3, l4
   pure function slopes10(l) result(d)
      real(wp), intent(in) :: l(4)               !! volume coordinates
      real(wp) :: d(3, 10)

      real(wp) :: e(4, 10)
      integer :: i

      e = 0.0_wp
      do i = 1, 4
         e(i, i) = 4.0_wp*l(i) - 1.0_wp
      end do
      do i = 1, 6
         e(EDGE4(1, i), 4 + i) = 4.0_wp*l(EDGE4(2, i))
         e(EDGE4(2, i), 4 + i) = 4.0_wp*l(EDGE4(1, i))
      end do
      d = e(2:, :) - spread(e(1, :), 1, 3)
   end function slopes10

   !> Give the shares of mid nodes that are missing to the ends of their edges
   pure subroutine hand_on(edge, there, share)
      integer, intent(in) :: edge(:, :)
      logical, intent(in) :: there(:)
      real(wp), intent(inout) :: share(:)

      integer :: i, n

      n = size(share) - size(edge, 2)
      do i = 1, size(edge, 2)
         if (there(n + i)) cycle
         share(edge(:, i)) = share(edge(:, i)) + 0.5_wp*share(n + i)
         share(n + i) = 0.0_wp
      end do
   end subroutine hand_on

   !> Shares of a brick of twenty nodes: corners C, mid nodes 1 of 8 C + 12; V by 2x2x2 points
   pure function brick20_shares(x, there) result(share)
      real(wp), intent(in) :: x(3, 20)
      logical, intent(in) :: there(20)
      real(wp) :: share(20)

      real(wp) :: y(3, 20), volume
      integer :: i

      y = x
      do i = 1, 12
         if (.not. there(8 + i)) y(:, 8 + i) = 0.5_wp*(x(:, EDGE8(1, i)) + x(:, EDGE8(2, i)))
      end do
      volume = 0.0_wp
      do i = 1, 8
         volume = volume + det(matmul(y, transpose(slopes20(GAUSS*[R(i), S(i), T(i)]))))
      end do
      share(:8) = abs(volume)*C/(8.0_wp*C + 12.0_wp)
      share(9:) = abs(volume)/(8.0_wp*C + 12.0_wp)
      call hand_on(EDGE8, there, share)
   end function brick20_shares

   !> Derivatives of the shape functions of a brick of twenty nodes: a mid node has
   !> (1 - q^2)(1 +- a)(1 +- b)/4 along its edge q, a corner gives up half of those next to it
   pure function slopes20(p) result(d)
      real(wp), intent(in) :: p(3)
      real(wp) :: d(3, 20)

      real(wp) :: sign(3), f(3), g(3)
      integer :: i, k, along

      d(:, :8) = slopes8(p)
      do i = 1, 12
         sign = 0.5_wp*([R(EDGE8(1, i)), S(EDGE8(1, i)), T(EDGE8(1, i))] + [R(EDGE8(2, i)), &
            S(EDGE8(2, i)), T(EDGE8(2, i))])
         along = minloc(abs(sign), 1)
         f = 1.0_wp + sign*p
         g = sign
         f(along) = 1.0_wp - p(along)**2
         g(along) = -2.0_wp*p(along)
         do k = 1, 3
            d(k, 8 + i) = 0.25_wp*g(k)*f(modulo(k, 3) + 1)*f(modulo(k + 1, 3) + 1)
         end do
         d(:, EDGE8(1, i)) = d(:, EDGE8(1, i)) - 0.5_wp*d(:, 8 + i)
         d(:, EDGE8(2, i)) = d(:, EDGE8(2, i)) - 0.5_wp*d(:, 8 + i)
      end do
   end function slopes20

   !> Shares of a thick shell of sixteen nodes: corners V/32, mid nodes of its faces 3 V/32
   pure function shell16_shares(x, there) result(share)
      real(wp), intent(in) :: x(3, 16)
      logical, intent(in) :: there(16)
      real(wp) :: share(16)

      real(wp) :: y(3, 20), volume, part(20)
      logical :: all_there(20)

      y(:, :12) = x(:, :12)
      y(:, 17:) = x(:, 13:)
      all_there = [there(:12), .false., .false., .false., .false., there(13:)]
      part = brick20_shares(y, all_there)
      volume = sum(part)
      share(:8) = volume/32.0_wp
      share(9:) = 3.0_wp*volume/32.0_wp
   end function shell16_shares

   !> Half of the cross product of the diagonals, for warped shells too
   pure real(wp) function shell_area(x) result(area)
      real(wp), intent(in) :: x(3, 4)

      area = 0.5_wp*norm2(cross(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2)))
   end function shell_area

   !> Half of the cross product of two sides
   pure real(wp) function triangle_area(x) result(area)
      real(wp), intent(in) :: x(3, 3)

      area = 0.5_wp*norm2(cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1)))
   end function triangle_area

   !> Share of each node of a triangle: its angle over pi
   pure function triangle_shares(x) result(share)
      real(wp), intent(in) :: x(3, 3)
      real(wp) :: share(3)

      real(wp) :: u(3), v(3)
      integer :: i

      do i = 1, 3
         u = x(:, modulo(i, 3) + 1) - x(:, i)
         v = x(:, modulo(i + 1, 3) + 1) - x(:, i)
         share(i) = atan2(norm2(cross(u, v)), dot_product(u, v))/acos(-1.0_wp)
      end do
   end function triangle_shares

   !> Inertia over mass of a layer: A/f + t^2/12 + z^2
   pure real(wp) function shell_inertia(area, f, t, z) result(per_mass)
      real(wp), intent(in) :: area
      real(wp), intent(in) :: f                  !! 9, of fine shells 12, of triangles 4.5
      real(wp), intent(in) :: t, z               !! thickness of the layer, place of its middle

      per_mass = area/f + t**2/12.0_wp + z**2
   end function shell_inertia

   !> Spherical inertia of each end of a beam: that of a slender rod 1.2 times as long, not below
   !> what its section has about its axis; more for short ones, which shear
   pure real(wp) function beam_inertia(s, length, density, nu, elastic) result(inertia)
      type(section_t), intent(in) :: s
      real(wp), intent(in) :: length, density
      real(wp), intent(in) :: nu
      logical, intent(in) :: elastic             !! nu is known; else nothing is said of shear

      real(wp) :: m, b, f, c, p, k, h

      inertia = 0.0_wp
      b = max(s%iyy, s%izz)
      if (.not. length > 0.0_wp) return
      m = 0.5_wp*density*s%area*length
      inertia = 1.2_wp*m*(1.2_wp*length)**2/12.0_wp + 0.5_wp*density*length*b
      if (b > 0.0_wp) then
         f = s%area*length**2/(12.0_wp*b)
         if (s%integrated .and. 12.0_wp*f > 12.0_wp) inertia = 1.2_wp*m*(1.2_wp*length)**2 + &
            0.5_wp*density*length*b
         if (f < 1.0_wp .and. elastic) then
            c = 1.2_wp*2.0_wp*(1.0_wp + nu)
            p = c/f*min(s%iyy, s%izz)/b
            k = (4.0_wp + p)/(1.0_wp + p)
            h = max(1.0_wp, k/(1.0_wp + f))
            inertia = h*inertia
         end if
      end if
      inertia = max(inertia, 0.5_wp*density*length*s%ixx)
   end function beam_inertia

end module kj_solid_mass
