!> Energies and momenta of a scene at its time, to which the velocities are advanced.
module kj_energy
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_model, only: model_t, load_t
   use kj_skew, only: axis_of
   use kj_snapshot, only: snapshot_t, balance_t
   implicit none
   private

   public :: balance_of

contains

   !> Sums over the leads, in their order
   function balance_of(model, now) result(b)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      type(balance_t) :: b

      real(wp) :: part(BLOCK, 9), total(9)
      integer :: i, k, n, before

      total = 0.0_wp
      do before = 0, model%n_lead - 1, BLOCK
         n = min(BLOCK, model%n_lead - before)
         call parts_of(model, now, before, n, part)
         do i = 1, n
            total = total + part(i, :)
         end do
      end do
      b%kinetic_trans = total(1)
      b%kinetic_rot = total(2)
      b%momentum = total(3:5)
      b%angular_momentum = total(6:8)
      b%mass = total(9)
      do k = 1, size(now%joint)
         b%internal = b%internal + sum(now%joint(k)%energy)
      end do
      do k = 1, size(model%gravity)
         b%potential = b%potential + potential_of(model, now, model%gravity(k))
      end do
   end function balance_of

   !> What each of a block of leads adds: both kinetic energies, momentum, angular momentum, mass
   pure subroutine parts_of(model, now, before, n, part)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: before, n           !! leads before the block, in it
      real(wp), intent(out) :: part(BLOCK, 9)

      real(wp) :: v(BLOCK, 3), w(BLOCK, 3), l(BLOCK, 3)
      integer :: i, j, k

      do k = 1, 3
         do i = 1, n
            v(i, k) = now%v(before + i, k) + now%lag*now%a(before + i, k)
            w(i, k) = now%w(before + i, k) + now%lag*now%al(before + i, k)
         end do
      end do
      call spins_of(model, now, before, n, w, l)
      do i = 1, n
         j = before + i
         associate (m => now%mass(j), x => now%x)
            part(i, 1) = 0.5_wp*m*(v(i, 1)**2 + v(i, 2)**2 + v(i, 3)**2)
            part(i, 2) = 0.5_wp*(w(i, 1)*l(i, 1) + w(i, 2)*l(i, 2) + w(i, 3)*l(i, 3))
            part(i, 3) = m*v(i, 1)
            part(i, 4) = m*v(i, 2)
            part(i, 5) = m*v(i, 3)
            part(i, 6) = l(i, 1) + m*(x(j, 2)*v(i, 3) - x(j, 3)*v(i, 2))
            part(i, 7) = l(i, 2) + m*(x(j, 3)*v(i, 1) - x(j, 1)*v(i, 3))
            part(i, 8) = l(i, 3) + m*(x(j, 1)*v(i, 2) - x(j, 2)*v(i, 1))
            part(i, 9) = m
         end associate
      end do
   end subroutine parts_of

   !> Spins J w of leads about themselves
   pure subroutine spins_of(model, now, before, n, w, l)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: before, n           !! leads before the block, in it
      real(wp), intent(in) :: w(BLOCK, 3)
      real(wp), intent(out) :: l(BLOCK, 3)

      real(wp) :: part
      integer :: i, j, k, n_body

      n_body = max(0, min(n, model%n_body - before))
      l(:n_body, :) = 0.0_wp
      do k = 1, 3
         do i = 1, n_body
            j = before + i
            associate (p => now%p)
               part = now%principal(j, k)*(w(i, 1)*p(j, 3*k - 2) + w(i, 2)*p(j, 3*k - 1) + &
                  w(i, 3)*p(j, 3*k))
               l(i, 1) = l(i, 1) + part*p(j, 3*k - 2)
               l(i, 2) = l(i, 2) + part*p(j, 3*k - 1)
               l(i, 3) = l(i, 3) + part*p(j, 3*k)
            end associate
         end do
         do i = n_body + 1, n
            l(i, k) = now%inertia(before + i)*w(i, k)
         end do
      end do
   end subroutine spins_of

   !> Potential -m g.d of a gravity card; 0 for one that changes with time or turns
   pure real(wp) function potential_of(model, now, load) result(u)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      type(load_t), intent(in) :: load

      real(wp) :: g(3), y
      integer :: k, lead

      u = 0.0_wp
      if (load%sensed) return
      y = load%y_scale
      if (load%curve > 0) then
         associate (values => model%curves%y(model%curves%first(load%curve): &
            model%curves%first(load%curve + 1) - 1))
            if (maxval(values) > minval(values)) return
            y = y*values(1)
         end associate
      end if
      if (load%skew > 0) then
         if (model%skews%node(1, load%skew) > 0) return
      end if
      g = y*axis_of(model%skews%axes, load%skew, load%dir)
      do k = 1, size(load%node)
         lead = load%node(k)
         u = u - now%mass(lead)*dot_product(g, now%x(lead, :) - model%x0(lead, :))
      end do
   end function potential_of

end module kj_energy
