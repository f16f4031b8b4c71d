!> The matrix M + B^T W B of the moving bodies, W = h/2 (h k + c) of the rows, and solutions of
!> (B M^-1 B^T + 1/W) f = r: M y + B^T W B y = B^T W r, f = W (r - B y).
!> Source: docs/theory/compliant.md 4.
module kj_consistent_compliant_matrix
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: matrix_t
   use kj_consistent_matrix, only: find_wrench, add_moment, N_CONSISTENT_WRENCH
   use kj_consistent_body, only: columns
   use kj_consistent_conditions, only: free_directions
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t, coefficients_t
   use kj_consistent_compliant_rows, only: coefficients
   use kj_consistent_compliant_factor, only: factorise, solve_bodies
   implicit none
   private

   public :: assemble, solve_rows, add_wrenches, wrench_of_rows

contains

   !> Assemble the matrix in the pose of B, and factorise it
   subroutine assemble(model, state, active, tried, self, good)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: active(:)           !! (n_motion)
      logical, intent(in) :: tried               !! B is that of the pose that is tried
      type(compliant_t), intent(inout) :: self
      logical, intent(out) :: good

      real(wp), parameter :: NONE(BLOCK, 6) = 0.0_wp
      type(coefficients_t) :: a
      integer :: b, at, n, i

      self%factor%below(:, :, :) = 0.0_wp
      call put_masses(model, state, active, self)
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do at = 1, size(self%joint(b)%block)
            n = min(BLOCK, model%batch(b)%n - BLOCK*(at - 1))
            associate (rows => self%joint(b)%block(at))
               if (tried) then
                  call coefficients(n, self%last(b) > 3, rows%weight, rows%damp, rows%b, a)
               else
                  call coefficients(n, self%last(b) > 3, rows%weight, NONE, &
                     state%joint(b)%block(at)%b, a)
               end if
            end associate
            associate (from => BLOCK*(at - 1), lead => model%batch(b)%lead)
               do i = 1, n
                  call scatter(lead(from + i, 1), lead(from + i, 2), &
                     self%pattern%place(model%batch(b)%first + from + i), i, self%last(b) > 3, a, &
                     self)
               end do
            end associate
         end do
      end do
      call factorise(self%pattern, self%factor, good)
   end subroutine assemble

   !> Masses and inertias; 1 times their size along directions that are held
   subroutine put_masses(model, state, active, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: active(:)
      type(compliant_t), intent(inout) :: self

      real(wp) :: e(9), q(4), j(3, 3), m(3, 3), p(3, 3), i1, i2, i3, s
      integer :: i, k, l, lead

      do i = 1, self%pattern%n
         lead = self%pattern%lead(i)
         q = state%poses%quat(lead, :)
         e = columns(q)
         i1 = model%spin_inertia(lead, 1)
         i2 = model%spin_inertia(lead, 2)
         i3 = model%spin_inertia(lead, 3)
         do k = 1, 3
            do l = 1, 3
               j(l, k) = (i1*e(k))*e(l) + (i2*e(k + 3))*e(l + 3) + (i3*e(k + 6))*e(l + 6)
            end do
         end do
         m = 0.0_wp
         m(1, 1) = model%mass(lead)
         m(2, 2) = model%mass(lead)
         m(3, 3) = model%mass(lead)
         if (self%partly(lead)) then
            call free_directions(model, state, lead, active, self%free(:, :, :, lead))
            do k = 1, 2
               p = self%free(:, :, k, lead)
               if (k == 1) then
                  s = max(model%mass(lead), tiny(s))
                  m = matmul(p, matmul(m, p))
                  call fill(s, p, m)
               else
                  s = max(i1, i2, i3, 1.0e-6_wp*model%mass(lead), tiny(s))
                  j = matmul(p, matmul(j, p))
                  call fill(s, p, j)
               end if
            end do
         end if
         call put_mass(m, j, self%factor%diagonal(1, 1, i))
      end do

   contains

      pure subroutine put_mass(m, j, d)
         real(wp), intent(in) :: m(3, 3), j(3, 3)
         real(wp), intent(inout) :: d(6, 6)

         integer :: k

         d = 0.0_wp
         do k = 1, 3
            d(1, k) = m(1, k)
            d(2, k) = m(2, k)
            d(3, k) = m(3, k)
            d(4, k + 3) = j(1, k)
            d(5, k + 3) = j(2, k)
            d(6, k + 3) = j(3, k)
         end do
      end subroutine put_mass

      !> a + s (1 - p)
      pure subroutine fill(size, p, a)
         real(wp), intent(in) :: size, p(3, 3)
         real(wp), intent(inout) :: a(3, 3)

         integer :: i

         a = a - size*p
         do i = 1, 3
            a(i, i) = a(i, i) + size
         end do
      end subroutine fill
   end subroutine put_masses

   !> Add what the joint in lane i of a block couples, between two leads
   subroutine scatter(lead1, lead2, place, i, turned, a, self)
      integer, intent(in) :: lead1, lead2, place, i
      logical, intent(in) :: turned              !! some rows are rotations
      type(coefficients_t), intent(in) :: a
      type(compliant_t), intent(inout) :: self

      associate (f => self%factor, c1 => self%pattern%column(lead1), &
         c2 => self%pattern%column(lead2))
         if (place == 0 .or. self%partly(lead1) .or. self%partly(lead2)) then
            call scatter_held([lead1, lead2], [c1, c2], place, i, turned, a, self)
            return
         end if
         call add_end(i, turned, a%ff, a%fc, 1.0_wp, a%cc, a%tt, f%diagonal(1, 1, c1))
         call add_end(i, turned, a%ff, a%fm, -1.0_wp, a%mm, a%tt, f%diagonal(1, 1, c2))
         call add_both(i, turned, c2 < c1, a, f%below(1, 1, place))
      end associate
   end subroutine scatter

   !> The same where a lead is held, in some directions or all, or is both
   subroutine scatter_held(lead, at, place, i, turned, a, self)
      integer, intent(in) :: lead(2), at(2), place, i
      logical, intent(in) :: turned
      type(coefficients_t), intent(in) :: a
      type(compliant_t), intent(inout) :: self

      real(wp) :: d(6, 6, 2), l(6, 6)
      integer :: e, k

      d = 0.0_wp
      l = 0.0_wp
      call add_end(i, turned, a%ff, a%fc, 1.0_wp, a%cc, a%tt, d(:, :, 1))
      call add_end(i, turned, a%ff, a%fm, -1.0_wp, a%mm, a%tt, d(:, :, 2))
      call add_both(i, turned, .false., a, l)
      do e = 1, 2
         if (at(e) == 0) cycle
         if (self%partly(lead(e))) then
            do k = 2, 6
               d(:k - 1, k, e) = d(k, :k - 1, e)
            end do
            call hold(self%free(:, :, :, lead(e)), d(:, :, e))
            d(:, :, e) = transpose(d(:, :, e))
            call hold(self%free(:, :, :, lead(e)), d(:, :, e))
            if (e == 1) l = transpose(l)
            call hold(self%free(:, :, :, lead(e)), l)
            if (e == 1) l = transpose(l)
         end if
         self%factor%diagonal(:, :, at(e)) = self%factor%diagonal(:, :, at(e)) + d(:, :, e)
      end do
      if (any(at == 0)) return
      if (at(1) == at(2)) then
         self%factor%diagonal(:, :, at(1)) = self%factor%diagonal(:, :, at(1)) + l + transpose(l)
      else
         if (at(2) < at(1)) l = transpose(l)
         self%factor%below(:, :, place) = self%factor%below(:, :, place) + l
      end if
   end subroutine scatter_held

   !> Add to the lower triangle of a diagonal block
   pure subroutine add_end(i, turned, ff, fc, sign, cc, tt, d)
      integer, intent(in) :: i
      logical, intent(in) :: turned
      real(wp), intent(in) :: ff(BLOCK, 9), fc(BLOCK, 9), cc(BLOCK, 9), tt(BLOCK, 9), sign
      real(wp), intent(inout) :: d(6, 6)

      integer :: j, k

      do j = 1, 3
         do k = 1, 3
            d(k + 3, j) = d(k + 3, j) + sign*fc(i, 3*k + j - 3)
         end do
         do k = j, 3
            d(k, j) = d(k, j) + ff(i, 3*j + k - 3)
            d(k + 3, j + 3) = d(k + 3, j + 3) + cc(i, 3*j + k - 3)
            if (turned) d(k + 3, j + 3) = d(k + 3, j + 3) + tt(i, 3*j + k - 3)
         end do
      end do
   end subroutine add_end

   !> Add the block of rows of end 2 and columns of end 1, or its transpose
   pure subroutine add_both(i, turned, transposed, a, l)
      integer, intent(in) :: i
      logical, intent(in) :: turned, transposed
      type(coefficients_t), intent(in) :: a
      real(wp), intent(inout) :: l(6, 6)

      integer :: j, k

      do j = 1, 3
         do k = 1, 3
            associate (low => 3*min(j, k) + max(j, k) - 3, at => 3*j + k - 3, &
               turned_at => 3*k + j - 3)
               l(k, j) = l(k, j) - a%ff(i, low)
               if (turned) l(k + 3, j + 3) = l(k + 3, j + 3) - a%tt(i, low)
               if (transposed) then
                  l(k, j + 3) = l(k, j + 3) + a%fm(i, at)
                  l(k + 3, j) = l(k + 3, j) - a%fc(i, turned_at)
                  l(k + 3, j + 3) = l(k + 3, j + 3) + a%mc(i, turned_at)
               else
                  l(k + 3, j) = l(k + 3, j) + a%fm(i, turned_at)
                  l(k, j + 3) = l(k, j + 3) - a%fc(i, at)
                  l(k + 3, j + 3) = l(k + 3, j + 3) + a%mc(i, at)
               end if
            end associate
         end do
      end do
   end subroutine add_both

   !> Rows of b along held directions become 0
   pure subroutine hold(p, b)
      real(wp), intent(in) :: p(3, 3, 2)
      real(wp), intent(inout) :: b(6, 6)

      b(1:3, :) = matmul(p(:, :, 1), b(1:3, :))
      b(4:6, :) = matmul(p(:, :, 2), b(4:6, :))
   end subroutine hold

   !> Forces and moments on the leads from rows%r: B^T r for the right-hand side; y of all leads
   subroutine solve_rows(model, state, tried, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: tried
      type(compliant_t), intent(inout) :: self

      real(wp) :: w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: b, at, n, from, i, k, c

      self%factor%x(:, :) = 0.0_wp
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do at = 1, size(self%joint(b)%block)
            from = BLOCK*(at - 1)
            n = min(BLOCK, model%batch(b)%n - from)
            associate (rows => self%joint(b)%block(at), lead => model%batch(b)%lead, &
               x => self%factor%x, column => self%pattern%column)
               if (tried) then
                  call wrench_of_rows(n, self%last(b), rows%r, rows%b, w)
               else
                  call wrench_of_rows(n, self%last(b), rows%r, state%joint(b)%block(at)%b, w)
               end if
               do i = 1, n
                  c = column(lead(from + i, 1))
                  if (c > 0) then
                     do k = 1, 6
                        x(k, c) = x(k, c) - w(i, k)
                     end do
                  end if
                  c = column(lead(from + i, 2))
                  if (c > 0) then
                     do k = 1, 3
                        x(k, c) = x(k, c) + w(i, k)
                        x(k + 3, c) = x(k + 3, c) - w(i, k + 6)
                     end do
                  end if
               end do
            end associate
         end do
      end do
      do i = 1, self%pattern%n
         associate (l => self%pattern%lead(i))
            if (.not. self%partly(l)) cycle
            self%factor%x(1:3, i) = matmul(self%free(:, :, 1, l), self%factor%x(1:3, i))
            self%factor%x(4:6, i) = matmul(self%free(:, :, 2, l), self%factor%x(4:6, i))
         end associate
      end do
      call solve_bodies(self%pattern, self%factor)
      do i = 1, self%pattern%n
         self%y(self%pattern%lead(i), :) = self%factor%x(1:3, i)
         self%turn(self%pattern%lead(i), :) = self%factor%x(4:6, i)
      end do
   end subroutine solve_rows

   !> Wrench of the forces f of the rows up to `last`, 3 or 6
   pure subroutine wrench_of_rows(n, last, f, b, wrench)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: f(BLOCK, 6)
      type(matrix_t), intent(in) :: b
      real(wp), intent(out) :: wrench(BLOCK, N_CONSISTENT_WRENCH)

      real(wp) :: moment(BLOCK, 3)

      moment(:n, :) = 0.0_wp
      if (last > 3) call add_moment(n, f(:, 4:6), b%turn, moment)
      call find_wrench(n, f(:, 1:3), moment, b, wrench)
   end subroutine wrench_of_rows

   !> Add the wrenches of n joints of a batch from `from` on to forces and moments of the leads
   pure subroutine add_wrenches(batch, from, n, wrench, f, t)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: from, n
      real(wp), intent(in) :: wrench(BLOCK, N_CONSISTENT_WRENCH)
      real(wp), contiguous, intent(inout) :: f(:, :), t(:, :)   !! (n_lead, 3)

      integer :: i, k

      do i = 1, n
         associate (a => batch%lead(from + i - 1, 1), b => batch%lead(from + i - 1, 2))
            do k = 1, 3
               f(a, k) = f(a, k) + wrench(i, k)
               t(a, k) = t(a, k) + wrench(i, k + 3)
               f(b, k) = f(b, k) - wrench(i, k)
               t(b, k) = t(b, k) + wrench(i, k + 6)
            end do
         end associate
      end do
   end subroutine add_wrenches

end module kj_consistent_compliant_matrix
