!> The matrix B M^-1 B^T + 1/W of the joints, W = h/2 (h k + c) of the rows, and its solutions. A
!> body that more than two joints or a condition hold is a node, too: its velocities y, M y = B^T f.
!> Source: docs/theory/compliant.md 4.
!> One file: the matrix, from what its nodes have to its solutions.
module kj_consistent_compliant_matrix
   use kj_kinds, only: wp
   use kj_math3, only: IDENTITY
   use kj_block, only: BLOCK
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: matrix_t
   use kj_consistent_matrix, only: find_wrench, add_moment, N_CONSISTENT_WRENCH
   use kj_consistent_body, only: columns, inverse_inertias
   use kj_consistent_compliance, only: compliance
   use kj_consistent_conditions, only: free_directions
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t, end_t, damper_t
   use kj_consistent_compliant_factor, only: factorise, solve
   implicit none
   private

   public :: assemble, solve_rows, moves_of_rows, add_wrenches, wrench_of_rows, ROWS_IN_USE

   !> rows up to the third, or all
   logical, parameter :: YES = .true., NO = .false.
   logical, parameter :: ROWS_IN_USE(6, 2) = reshape([YES, YES, YES, NO, NO, NO, &
      YES, YES, YES, YES, YES, YES], [6, 2])
   real(wp), parameter :: NO_ROW = 1.0e200_wp    !! on the diagonal of a row that is not there

contains

   !> Assemble the matrix in the pose of B, and factorise it
   subroutine assemble(model, state, active, tried, self, good)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: active(:)           !! (n_motion)
      logical, intent(in) :: tried               !! B and dampers are those of the velocity stage
      type(compliant_t), intent(inout) :: self
      logical, intent(out) :: good

      integer :: b, from

      call inverse_inertias(model, state%poses%quat, 1, model%n_lead, self%ij)
      self%factor%below(:, :, :) = 0.0_wp
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do from = 0, model%batch(b)%n - 1, BLOCK
            select case (model%batch(b)%n - from)   ! small numbers have kernels of their own
            case (1)
               call put_joints(1, model, b, from, state, tried, self)
            case (2)
               call put_joints(2, model, b, from, state, tried, self)
            case (3)
               call put_joints(3, model, b, from, state, tried, self)
            case (4)
               call put_joints(4, model, b, from, state, tried, self)
            case default
               call put_joints(min(BLOCK, model%batch(b)%n - from), model, b, from, state, tried, &
                  self)
            end select
         end do
      end do
      call put_links(state, tried, self)
      call put_bodies(model, state, active, tried, self)
      call factorise(self%pattern, self%factor, good)
      if (good) call find_responses(self)
   end subroutine assemble

   !> What a unit force on the row of each damper does while those before it have none
   subroutine find_responses(self)
      type(compliant_t), intent(inout) :: self

      integer :: d

      do d = 1, size(self%damper)
         if (.not. acts(self, self%damper(d))) cycle
         self%factor%x = 0.0_wp
         self%factor%x(self%damper(d)%part, self%damper(d)%column) = 1.0_wp
         call solve(self%pattern, self%factor)
         call take_out(self, d - 1)
         self%response(:, :, d) = self%factor%x
      end do
   end subroutine find_responses

   !> Take the forces on rows of n dampers out of a solution
   subroutine take_out(self, n)
      type(compliant_t), intent(inout) :: self
      integer, intent(in) :: n

      real(wp) :: part
      integer :: d

      do d = 1, n
         if (.not. acts(self, self%damper(d))) cycle
         associate (x => self%factor%x, damper => self%damper(d))
            part = x(damper%part, damper%column)/self%response(damper%part, damper%column, d)
            x = x - part*self%response(:, :, d)
         end associate
      end do
   end subroutine take_out

   !> It damps, and no lock holds its row
   pure logical function acts(self, damper)
      type(compliant_t), intent(in) :: self
      type(damper_t), intent(in) :: damper

      associate (rows => self%joint(damper%batch)%block(damper%at))
         acts = rows%soft(damper%lane, damper%row) < NO_ROW .and. &
            .not. rows%weight(damper%lane, damper%row) > 0.0_wp
      end associate
   end function acts

   !> What n joints of a batch after `from` have alone
   pure subroutine put_joints(n, model, b, from, state, tried, self)
      integer, value :: n
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b, from
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: tried
      type(compliant_t), intent(inout) :: self

      real(wp) :: im(BLOCK, 2), ij1(BLOCK, 6), ij2(BLOCK, 6), s(BLOCK, 21), a(3, 3), both, with
      integer :: at, i, k, node, lead1, lead2

      at = from/BLOCK + 1
      do i = 1, n
         lead1 = model%batch(b)%lead(from + i, 1)
         lead2 = model%batch(b)%lead(from + i, 2)
         im(i, 1) = self%im(lead1)
         im(i, 2) = self%im(lead2)
         do k = 1, 6
            ij1(i, k) = self%share(lead1)*self%ij(lead1, k)
            ij2(i, k) = self%share(lead2)*self%ij(lead2, k)
         end do
      end do
      if (tried) then
         call compliance(n, ROWS_IN_USE(:, self%last(b)/3), self%joint(b)%block(at)%b, im, ij1, &
            ij2, s)
      else
         call compliance(n, ROWS_IN_USE(:, self%last(b)/3), state%joint(b)%block(at)%b, im, ij1, &
            ij2, s)
      end if
      with = merge(1.0_wp, 0.0_wp, tried .or. .not. self%apart)   ! rows of dampers, too
      associate (rows => self%joint(b)%block(at))
         do k = 1, self%last(b)
            !$omp simd private(both)
            do i = 1, n
               both = rows%weight(i, k) + with*rows%damp(i, k)
               rows%soft(i, k) = merge(1.0_wp/max(both, tiny(both)), NO_ROW, both > 0.0_wp)
               s(i, k*(k + 1)/2) = s(i, k*(k + 1)/2) + rows%soft(i, k)
            end do
         end do
      end associate
      associate (f => self%factor)
         do i = 1, n
            node = self%node(model%batch(b)%first + from + i)
            call put_triangle(s(i, 1), s(i, 2), s(i, 4), s(i, 3), s(i, 5), s(i, 6), &
               f%diagonal(:, :, self%pattern%column(node)))
            if (self%last(b) == 3) cycle
            call put_triangle(s(i, 10), s(i, 14), s(i, 19), s(i, 15), s(i, 20), s(i, 21), &
               f%diagonal(:, :, self%pattern%column(node + 1)))
            do k = 1, 3
               a(1, k) = s(i, 6 + k)
               a(2, k) = s(i, 10 + k)
               a(3, k) = s(i, 15 + k)
            end do
            call add(a, self%across(model%batch(b)%first + from + i), f%below)
         end do
      end associate
   end subroutine put_joints

   pure subroutine put_triangle(a11, a21, a31, a22, a32, a33, d)
      real(wp), intent(in) :: a11, a21, a31, a22, a32, a33
      real(wp), intent(inout) :: d(4, 3)

      d(1, 1) = a11
      d(2, 1) = a21
      d(3, 1) = a31
      d(2, 2) = a22
      d(3, 2) = a32
      d(3, 3) = a33
   end subroutine put_triangle

   !> What bodies between two joints couple
   subroutine put_links(state, tried, self)
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: tried
      type(compliant_t), intent(inout) :: self

      real(wp) :: f(3, 3, 2), u(3, 6, 2), v(3, 6), j(6), a(3, 3), sign
      integer :: n, e, k, last(2)

      do n = 1, size(self%link)
         associate (link => self%link(n), lead => self%link(n)%end(1)%lead, &
            below => self%factor%below)
            do e = 1, 2
               last(e) = self%last(link%end(e)%batch)
               call gather(link%end(e), state, tried, self, f(:, :, e), u(:, :, e))
            end do
            sign = merge(1.0_wp, -1.0_wp, link%end(1)%which == link%end(2)%which)
            j = (sign*self%share(lead))*self%ij(lead, :)
            do k = 1, last(2)
               v(1, k) = j(1)*u(1, k, 2) + j(4)*u(2, k, 2) + j(5)*u(3, k, 2)
               v(2, k) = j(4)*u(1, k, 2) + j(2)*u(2, k, 2) + j(6)*u(3, k, 2)
               v(3, k) = j(5)*u(1, k, 2) + j(6)*u(2, k, 2) + j(3)*u(3, k, 2)
            end do
            f(:, :, 2) = (sign*self%im(lead))*f(:, :, 2)
            a = 0.0_wp
            call add_product(f(:, :, 1), f(:, :, 2), a)
            call add_product(u(:, 1:3, 1), v(:, 1:3), a)
            call add(a, link%place(1, 1), below)
            if (last(1) > 3) call add_part(u(:, 4:6, 1), v(:, 1:3), link%place(2, 1), below)
            if (last(2) > 3) call add_part(u(:, 1:3, 1), v(:, 4:6), link%place(1, 2), below)
            if (all(last > 3)) call add_part(u(:, 4:6, 1), v(:, 4:6), link%place(2, 2), below)
         end associate
      end do
   end subroutine put_links

   !> The rows of B at an end of a joint: forces and moments on the lead; those of end 1 with the
   !> other sign
   subroutine gather(end, state, tried, self, f, u)
      type(end_t), intent(in) :: end
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: tried
      type(compliant_t), intent(in) :: self
      real(wp), intent(out) :: f(3, 3), u(3, 6)  !! each row a column

      if (tried) then
         call take_rows(end, self%joint(end%batch)%block(end%at)%b, self%last(end%batch) > 3, f, u)
      else
         call take_rows(end, state%joint(end%batch)%block(end%at)%b, self%last(end%batch) > 3, f, u)
      end if
   end subroutine gather

   pure subroutine take_rows(end, b, turned, f, u)
      type(end_t), intent(in) :: end
      type(matrix_t), intent(in) :: b
      logical, intent(in) :: turned
      real(wp), intent(out) :: f(3, 3), u(3, 6)

      integer :: i, k, l

      i = end%lane
      do k = 1, 3
         do l = 1, 3
            f(l, k) = b%force(i, 3*k - 3 + l)
            u(l, k) = b%couple(i, 3*k - 3 + l)
         end do
      end do
      if (turned) then
         do k = 1, 3
            do l = 1, 3
               u(l, k + 3) = b%turn(i, 3*k - 3 + l)
            end do
         end do
      end if
      if (end%which == 1) return
      do k = 1, 3
         u(1, k) = u(1, k) - (b%apart(i, 2)*f(3, k) - b%apart(i, 3)*f(2, k))
         u(2, k) = u(2, k) - (b%apart(i, 3)*f(1, k) - b%apart(i, 1)*f(3, k))
         u(3, k) = u(3, k) - (b%apart(i, 1)*f(2, k) - b%apart(i, 2)*f(1, k))
      end do
   end subroutine take_rows

   !> a^T b added to a block
   pure subroutine add_part(a, b, place, below)
      real(wp), intent(in) :: a(3, 3), b(3, 3)
      integer, intent(in) :: place
      real(wp), contiguous, intent(inout) :: below(:, :, :)

      real(wp) :: c(3, 3)

      c = 0.0_wp
      call add_product(a, b, c)
      call add(c, place, below)
   end subroutine add_part

   !> c := c + a^T b
   pure subroutine add_product(a, b, c)
      real(wp), intent(in) :: a(3, 3), b(3, 3)
      real(wp), intent(inout) :: c(3, 3)

      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            c(i, j) = c(i, j) + (a(1, i)*b(1, j) + a(2, i)*b(2, j) + a(3, i)*b(3, j))
         end do
      end do
   end subroutine add_product

   !> Add to a block, or its transpose to that of -place
   pure subroutine add(a, place, below)
      real(wp), intent(in) :: a(3, 3)
      integer, intent(in) :: place
      real(wp), contiguous, intent(inout) :: below(:, :, :)

      integer :: i, j

      if (place > 0) then
         do j = 1, 3
            do i = 1, 3
               below(i, j, place) = below(i, j, place) + a(i, j)
            end do
         end do
      else
         do j = 1, 3
            do i = 1, 3
               below(j, i, -place) = below(j, i, -place) + a(i, j)
            end do
         end do
      end if
   end subroutine add

   !> Bodies that are nodes, -M on the diagonal, and their joints; directions that are held are
   !> projected out and have the size of the mass alone
   subroutine put_bodies(model, state, active, tried, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: active(:), tried
      type(compliant_t), intent(inout) :: self

      real(wp) :: e(3, 3), m(3, 3), f(3, 3), u(3, 6), free(3, 3), s
      integer :: i, part, lead

      do i = 1, size(self%hub)
         lead = self%hub(i)
         if (self%partly(lead)) call free_directions(model, state, lead, active, &
            self%free(:, :, :, lead))
         do part = 1, 2
            e = IDENTITY
            s = max(model%mass(lead), tiny(s))
            m = model%mass(lead)*IDENTITY
            if (part == 2) then
               e = reshape(columns(state%poses%quat(lead, :)), [3, 3])
               s = max(maxval(model%spin_inertia(lead, :)), 1.0e-6_wp*model%mass(lead), tiny(s))
               m = matmul(e, spread(model%spin_inertia(lead, :), 2, 3)*transpose(e))
            end if
            if (self%partly(lead)) then
               associate (p => self%free(:, :, part, lead))
                  m = matmul(p, matmul(m, p)) + s*(IDENTITY - p)
               end associate
            end if
            call put_triangle(-m(1, 1), -m(2, 1), -m(3, 1), -m(2, 2), -m(3, 2), -m(3, 3), &
               self%factor%diagonal(:, :, self%pattern%column(self%body(lead) + part - 1)))
         end do
      end do
      do i = 1, size(self%tie)
         associate (tie => self%tie(i), lead => self%tie(i)%end%lead, below => self%factor%below)
            call gather(tie%end, state, tried, self, f, u)
            free = merge(-1.0_wp, 1.0_wp, tie%end%which == 1)*IDENTITY
            m = free
            if (self%partly(lead)) then
               free = free(1, 1)*self%free(:, :, 1, lead)
               m = m(1, 1)*self%free(:, :, 2, lead)
            end if
            call add_part(f, free, tie%place(1), below)
            call add_part(u(:, 1:3), m, tie%place(2), below)
            if (tie%place(3) /= 0) call add_part(u(:, 4:6), m, tie%place(3), below)
         end associate
      end do
   end subroutine put_bodies

   !> rows%r, times the weights, becomes the solution f of (B M^-1 B^T + 1/W) f = r
   subroutine solve_rows(model, damped, self)
      type(consistent_model_t), intent(in) :: model
      logical, intent(in) :: damped              !! rows of dampers have forces, too
      type(compliant_t), intent(inout) :: self

      real(wp) :: with
      integer :: b, at, i, k, n, from, c

      with = merge(1.0_wp, 0.0_wp, damped)
      associate (x => self%factor%x)
         do i = 1, size(self%hub)
            x(:, self%pattern%column(self%body(self%hub(i)))) = 0.0_wp
            x(:, self%pattern%column(self%body(self%hub(i)) + 1)) = 0.0_wp
         end do
         do b = 1, size(model%batch)
            if (.not. self%rowed(b)) cycle
            do at = 1, size(self%joint(b)%block)
               from = model%batch(b)%first + BLOCK*(at - 1)
               n = min(BLOCK, model%batch(b)%first + model%batch(b)%n - from)
               associate (rows => self%joint(b)%block(at))
                  do k = 0, self%last(b) - 3, 3
                     do i = 1, n
                        c = self%pattern%column(self%node(from + i) + k/3)
                        x(1, c) = rows%r(i, k + 1)*rows%soft(i, k + 1)
                        x(2, c) = rows%r(i, k + 2)*rows%soft(i, k + 2)
                        x(3, c) = rows%r(i, k + 3)*rows%soft(i, k + 3)
                     end do
                  end do
               end associate
            end do
         end do
         call solve(self%pattern, self%factor)
         if (.not. damped) call take_out(self, size(self%damper))
         do b = 1, size(model%batch)
            if (.not. self%rowed(b)) cycle
            do at = 1, size(self%joint(b)%block)
               from = model%batch(b)%first + BLOCK*(at - 1)
               n = min(BLOCK, model%batch(b)%first + model%batch(b)%n - from)
               associate (rows => self%joint(b)%block(at))
                  do k = 0, self%last(b) - 3, 3
                     do i = 1, n
                        c = self%pattern%column(self%node(from + i) + k/3)
                        rows%r(i, k + 1) = x(1, c)
                        rows%r(i, k + 2) = x(2, c)
                        rows%r(i, k + 3) = x(3, c)
                     end do
                  end do
                  do k = 1, self%last(b)
                     !$omp simd
                     do i = 1, n
                        rows%r(i, k) = merge(rows%r(i, k), 0.0_wp, &
                           rows%weight(i, k) + with*rows%damp(i, k) > 0.0_wp)
                     end do
                  end do
               end associate
            end do
         end do
      end associate
   end subroutine solve_rows

   !> self%y, self%turn: what a solution moves the leads, M^-1 B^T f, B of the pose that is tried
   subroutine moves_of_rows(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      real(wp) :: w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: b, at, from, n, i

      self%f = 0.0_wp
      self%t = 0.0_wp
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         do at = 1, size(self%joint(b)%block)
            from = BLOCK*(at - 1) + 1
            n = min(BLOCK, model%batch(b)%n - from + 1)
            call wrench_of_rows(n, self%last(b), self%joint(b)%block(at)%r, &
               self%joint(b)%block(at)%b, w)
            call add_wrenches(model%batch(b), from, n, w, self%f, self%t)
         end do
      end do
      do i = 1, model%n_lead
         associate (j => self%share(i)*self%ij(i, :), c => self%pattern%column)
            if (self%body(i) > 0) then
               self%y(i, :) = self%factor%x(1:3, c(self%body(i)))
               self%turn(i, :) = self%factor%x(1:3, c(self%body(i) + 1))
            else
               self%y(i, :) = -self%im(i)*self%f(i, :)
               self%turn(i, :) = -matmul(reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), &
                  j(3)], [3, 3]), self%t(i, :))
            end if
         end associate
      end do
   end subroutine moves_of_rows

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
