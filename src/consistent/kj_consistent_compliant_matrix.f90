!> The matrix B M^-1 B^T + 1/W of the joints, W = h/2 (h k + c) of the rows, and its solutions. A
!> body that more than two joints or a condition hold is a node, too: its velocities y, M y = B^T f.
!> Source: docs/theory/compliant.md 4.
!> One file: the matrix, from what its nodes have to its solutions.
module kj_consistent_compliant_matrix
   use, intrinsic :: iso_c_binding, only: c_loc, c_f_pointer
   use kj_kinds, only: wp
   use kj_math3, only: IDENTITY
   use kj_block, only: BLOCK, block_of, lane_of, group_of
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: matrix_t, consistent_block_t, in_groups, group_at
   use kj_consistent_matrix, only: poses_t, find_wrench, add_moment, &
      N_CONSISTENT_WRENCH
   use kj_consistent_body, only: columns
   use kj_consistent_compliance, only: compliance
   use kj_consistent_conditions, only: free_directions
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t, compliant_block_t, end_t, damper_t
   use kj_consistent_compliant_factor, only: factorise, solve
   implicit none
   private

   public :: assemble, find_responses, put_side, solve_all, take_solution, solve_rows, &
      moves_of_rows, add_wrenches, wrench_of_rows, rows_at

   real(wp), parameter :: NO_ROW = 1.0e200_wp    !! on the diagonal of a row that is not there

contains

   !> Assemble the matrix in the pose of B and of the inverse inertias, and factorise it
   subroutine assemble(model, state, active, tried, self, good)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: active(:)           !! (n_motion)
      logical, intent(in) :: tried               !! B and dampers are those of the velocity stage
      type(compliant_t), intent(inout) :: self
      logical, intent(out) :: good

      type(compliant_block_t), pointer :: rows
      type(consistent_block_t), pointer :: lanes
      integer :: b, from, n

      self%factor%below(:, :, :) = 0.0_wp
      do b = 1, size(model%batch)
         if (.not. self%rowed(b)) cycle
         from = 1
         do while (from <= model%batch(b)%n)
            n = min(BLOCK, model%batch(b)%n - from + 1)
            if (in_groups(model%batch(b))) n = group_of(n)
            call group_at(state%joint(b)%block(block_of(from)), lane_of(from), lanes)
            call rows_at(self%joint(b)%block(block_of(from)), lane_of(from), rows)
            if (tried) then
               call put_group(n, model, b, from, state%poses, tried, rows%b, rows, self)
            else
               call put_group(n, model, b, from, state%poses, tried, lanes%b, rows, self)
            end if
            from = from + n
         end do
      end do
      call put_links(state, tried, self)
      call put_bodies(model, state, active, tried, self)
      call factorise(self%pattern, self%factor, good)
      self%answered = .false.
   end subroutine assemble

   !> Rows of a block from a place on, as if their block began there
   subroutine rows_at(block, lane, rows)
      type(compliant_block_t), target, intent(in) :: block
      integer, intent(in) :: lane
      type(compliant_block_t), pointer, intent(out) :: rows

      call c_f_pointer(c_loc(block%k(lane, 1)), rows)
   end subroutine rows_at

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
      self%answered = .true.
   end subroutine find_responses

   !> Take the forces on rows of n dampers out of a solution
   subroutine take_out(self, n)
      type(compliant_t), intent(inout) :: self
      integer, intent(in) :: n

      real(wp) :: part
      integer :: column, d

      do d = 1, n
         if (.not. acts(self, self%damper(d))) cycle
         associate (x => self%factor%x, damper => self%damper(d))
            part = x(damper%part, damper%column)/self%response(damper%part, damper%column, d)
            do column = 1, size(x, 2)
               x(:, column) = x(:, column) - part*self%response(:, column, d)
            end do
         end associate
      end do
   end subroutine take_out

   !> It damps, and no lock holds its row
   pure logical function acts(self, damper)
      type(compliant_t), intent(in) :: self
      type(damper_t), intent(in) :: damper

      associate (rows => self%joint(damper%batch)%block(damper%at))
         acts = rows%damp(damper%lane, damper%row) > 0.0_wp .and. &
            .not. rows%weight(damper%lane, damper%row) > 0.0_wp
      end associate
   end function acts

   !> What n joints of a batch have alone
   subroutine put_group(n, model, b, from, poses, tried, matrix, rows, self)
      integer, intent(in) :: n, b, from          !! number of joints, batch, first joint
      type(consistent_model_t), intent(in) :: model
      type(poses_t), intent(in) :: poses
      logical, intent(in) :: tried
      type(matrix_t), intent(in) :: matrix
      type(compliant_block_t), target, intent(inout) :: rows
      type(compliant_t), target, intent(inout) :: self   !! its blocks are not touched

      select case (n)                            ! small numbers have kernels of their own
      case (1)
         call put_joints(1, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      case (2)
         call put_joints(2, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      case (3)
         call put_joints(3, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      case (4)
         call put_joints(4, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      case (8)
         call put_joints(8, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      case (BLOCK)
         call put_joints(BLOCK, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      case default
         call put_joints(n, model, b, from - 1, poses%ij, tried, matrix, rows, self)
      end select
   end subroutine put_group

   pure subroutine put_joints(n, model, b, from, ij, tried, matrix, rows, self)
      integer, value :: n
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b, from             !! joint before the first
      real(wp), contiguous, intent(in) :: ij(:, :)   !! of the leads, of the pose
      logical, intent(in) :: tried
      type(matrix_t), intent(in) :: matrix
      type(compliant_block_t), target, intent(inout) :: rows
      type(compliant_t), target, intent(inout) :: self   !! its blocks are not touched

      real(wp) :: im(BLOCK, 2), ij1(BLOCK, 6), ij2(BLOCK, 6), s(BLOCK, 21), both, with
      integer :: i, k, node, lead1, lead2

      do i = 1, n
         lead1 = model%batch(b)%lead(from + i, 1)
         lead2 = model%batch(b)%lead(from + i, 2)
         im(i, 1) = self%im(lead1)
         im(i, 2) = self%im(lead2)
         do k = 1, 6
            ij1(i, k) = self%share(lead1)*ij(lead1, k)
            ij2(i, k) = self%share(lead2)*ij(lead2, k)
         end do
      end do
      call compliance(n, self%last(b), matrix, im, ij1, ij2, s)
      with = merge(1.0_wp, 0.0_wp, tried .or. .not. self%apart)   ! rows of dampers, too
      do k = 1, self%last(b)
         !$omp simd private(both)
         do i = 1, n
            both = rows%weight(i, k) + with*rows%damp(i, k)
            rows%soft(i, k) = merge(1.0_wp/max(both, tiny(both)), NO_ROW, both > 0.0_wp)
            s(i, k*(k + 1)/2) = s(i, k*(k + 1)/2) + rows%soft(i, k)
         end do
      end do
      associate (f => self%factor)
         do i = 1, n
            node = self%node(model%batch(b)%first + from + i)
            call put_triangle(s(i, 1), s(i, 2), s(i, 4), s(i, 3), s(i, 5), s(i, 6), &
               f%diagonal(:, :, self%pattern%column(node)))
            if (self%last(b) == 3) cycle
            call put_triangle(s(i, 10), s(i, 14), s(i, 19), s(i, 15), s(i, 20), s(i, 21), &
               f%diagonal(:, :, self%pattern%column(node + 1)))
            associate (place => self%across(model%batch(b)%first + from + i))
               do k = 1, 3
                  if (place > 0) then
                     f%below(1:3, k, place) = [s(i, 6 + k), s(i, 10 + k), s(i, 15 + k)]
                  else
                     f%below(k, 1:3, -place) = [s(i, 6 + k), s(i, 10 + k), s(i, 15 + k)]
                  end if
               end do
            end associate
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

      real(wp) :: rows(4, 3, 3, 2), j(6), sign
      integer :: n, e, k, i

      rows = 0.0_wp
      do n = 1, size(self%link)
         associate (link => self%link(n), lead => self%link(n)%end(1)%lead)
            do e = 1, 2
               call gather(link%end(e), state, tried, self, rows(:, :, :, e))
            end do
            sign = merge(1.0_wp, -1.0_wp, link%end(1)%which == link%end(2)%which)
            j = (sign*self%share(lead))*state%poses%ij(lead, :)
            rows(:, :, 1, 2) = (sign*self%im(lead))*rows(:, :, 1, 2)
            call weigh(j, rows(:, :, 2, 2))
            if (link%place(1, 2) /= 0) call weigh(j, rows(:, :, 3, 2))
            do k = 1, 2
               do i = 1, 2
                  if (link%place(i, k) == 0) cycle
                  if (i == 1 .and. k == 1) call add(rows(:, :, 1, 1), rows(:, :, 1, 2), &
                     link%place(1, 1), self%factor%below)
                  call add(rows(:, :, i + 1, 1), rows(:, :, k + 1, 2), link%place(i, k), &
                     self%factor%below)
               end do
            end do
         end associate
      end do
   end subroutine put_links

   !> Rows of B at an end of a joint, those of end 1 with the other sign: forces and moments of
   !> translations, moments of rotations
   subroutine gather(end, state, tried, self, rows)
      type(end_t), intent(in) :: end
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: tried
      type(compliant_t), intent(in) :: self
      real(wp), intent(inout) :: rows(4, 3, 3)   !! the last of four stays 0

      if (tried) then
         call take_rows(end, self%last(end%batch) > 3, self%joint(end%batch)%block(end%at)%b, rows)
      else
         call take_rows(end, self%last(end%batch) > 3, state%joint(end%batch)%block(end%at)%b, rows)
      end if
   end subroutine gather

   pure subroutine take_rows(end, turned, b, rows)
      type(end_t), intent(in) :: end
      logical, intent(in) :: turned              !! some rows are rotations
      type(matrix_t), intent(in) :: b
      real(wp), intent(inout) :: rows(4, 3, 3)

      integer :: k, l

      associate (i => end%lane)
         do l = 1, 3
            do k = 1, 3
               rows(k, l, 1) = b%force(i, 3*k - 3 + l)
               rows(k, l, 2) = b%couple(i, 3*k - 3 + l)
            end do
         end do
         if (turned) then
            do l = 1, 3
               do k = 1, 3
                  rows(k, l, 3) = b%turn(i, 3*k - 3 + l)
               end do
            end do
         end if
         if (end%which == 1) return
         !$omp simd
         do k = 1, 4
            rows(k, 1, 2) = rows(k, 1, 2) - &
               (b%apart(i, 2)*rows(k, 3, 1) - b%apart(i, 3)*rows(k, 2, 1))
            rows(k, 2, 2) = rows(k, 2, 2) - &
               (b%apart(i, 3)*rows(k, 1, 1) - b%apart(i, 1)*rows(k, 3, 1))
            rows(k, 3, 2) = rows(k, 3, 2) - &
               (b%apart(i, 1)*rows(k, 2, 1) - b%apart(i, 2)*rows(k, 1, 1))
         end do
      end associate
   end subroutine take_rows

   !> Rows := rows J^-1
   pure subroutine weigh(j, rows)
      real(wp), intent(in) :: j(6)               !! xx yy zz xy xz yz
      real(wp), intent(inout) :: rows(4, 3)

      real(wp) :: x, y, z
      integer :: k

      !$omp simd private(x, y, z)
      do k = 1, 4
         x = rows(k, 1)
         y = rows(k, 2)
         z = rows(k, 3)
         rows(k, 1) = j(1)*x + j(4)*y + j(5)*z
         rows(k, 2) = j(4)*x + j(2)*y + j(6)*z
         rows(k, 3) = j(5)*x + j(6)*y + j(3)*z
      end do
   end subroutine weigh

   !> Add a b^T to a block, or its transpose to that of -place
   pure subroutine add(a, b, place, below)
      real(wp), intent(in) :: a(4, 3), b(4, 3)
      integer, intent(in) :: place
      real(wp), contiguous, intent(inout) :: below(:, :, :)

      if (place > 0) then
         call add_product(a, b, below(:, :, place))
      else
         call add_product(b, a, below(:, :, -place))
      end if
   end subroutine add

   !> c := c + a b^T
   pure subroutine add_product(a, b, c)
      real(wp), intent(in) :: a(4, 3), b(4, 3)
      real(wp), intent(inout) :: c(4, 3)

      integer :: i, j

      do j = 1, 3
         !$omp simd
         do i = 1, 4
            c(i, j) = c(i, j) + (a(i, 1)*b(j, 1) + a(i, 2)*b(j, 2) + a(i, 3)*b(j, 3))
         end do
      end do
   end subroutine add_product

   !> Bodies that are nodes, -M on the diagonal, and their joints; directions that are held are
   !> projected out and have the size of the mass alone
   subroutine put_bodies(model, state, active, tried, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      logical, intent(in) :: active(:), tried
      type(compliant_t), intent(inout) :: self

      real(wp) :: e(3, 3), m(3, 3), turned(3, 3), quat(4), rows(4, 3, 3), free(4, 3, 2), s
      integer :: i, k, part, lead

      do i = 1, size(self%hub)
         lead = self%hub(i)
         if (self%partly(lead)) call free_directions(model, state, lead, active, &
            self%free(:, :, :, lead))
         do part = 1, 2
            e = IDENTITY
            s = max(model%mass(lead), tiny(s))
            m = model%mass(lead)*IDENTITY
            if (part == 2) then
               quat = state%poses%quat(lead, :)
               e = reshape(columns(quat), [3, 3])
               s = max(maxval(model%spin_inertia(lead, :)), 1.0e-6_wp*model%mass(lead), tiny(s))
               do k = 1, 3
                  turned(k, :) = model%spin_inertia(lead, k)*e(:, k)
               end do
               m = matmul(e, turned)
            end if
            if (self%partly(lead)) then
               associate (p => self%free(:, :, part, lead))
                  turned = matmul(m, p)
                  m = matmul(p, turned) + s*(IDENTITY - p)
               end associate
            end if
            call put_triangle(-m(1, 1), -m(2, 1), -m(3, 1), -m(2, 2), -m(3, 2), -m(3, 3), &
               self%factor%diagonal(:, :, self%pattern%column(self%body(lead) + part - 1)))
         end do
      end do
      rows = 0.0_wp
      do i = 1, size(self%tie)
         associate (tie => self%tie(i), lead => self%tie(i)%end%lead, below => self%factor%below)
            call gather(tie%end, state, tried, self, rows)
            s = merge(-1.0_wp, 1.0_wp, tie%end%which == 1)
            do part = 1, 2
               free(:, :, part) = 0.0_wp
               free(1:3, :, part) = s*IDENTITY
               if (self%partly(lead)) free(1:3, :, part) = s*self%free(:, :, part, lead)
            end do
            call add(rows(:, :, 1), free(:, :, 1), tie%place(1), below)
            call add(rows(:, :, 2), free(:, :, 2), tie%place(2), below)
            if (tie%place(3) /= 0) call add(rows(:, :, 3), free(:, :, 2), tie%place(3), below)
         end associate
      end do
   end subroutine put_bodies

   !> rows%r, times the weights, becomes the solution f of (B M^-1 B^T + 1/W) f = r
   subroutine solve_rows(model, self)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(inout) :: self

      integer :: b, at, i, n, run

      if (.not. self%answered) call find_responses(self)
      do run = 1, 2
         do b = 1, size(model%batch)
            if (.not. self%rowed(b)) cycle
            do at = 1, size(self%joint(b)%block)
               i = BLOCK*(at - 1) + 1
               n = min(BLOCK, model%batch(b)%n - i + 1)
               i = self%node(model%batch(b)%first + i)
               if (run == 1) then
                  call put_side(n, self%last(b), i, self%pattern%column, self%joint(b)%block(at), &
                     self%factor%x)
               else
                  call take_solution(n, self%last(b), .false., i, self%pattern%column, &
                     self%factor%x, self%joint(b)%block(at))
               end if
            end do
         end do
         if (run == 1) call solve_all(.false., self)
      end do
   end subroutine solve_rows

   !> Right-hand side of n joints whose nodes begin with `node`, from rows%r times the weights
   pure subroutine put_side(n, last, node, column, rows, x)
      integer, value :: n
      integer, intent(in) :: last, node
      integer, intent(in) :: column(*)
      type(compliant_block_t), intent(in) :: rows
      real(wp), intent(inout) :: x(4, *)

      integer :: i, c

      do i = 1, n
         c = column(node + (i - 1)*(last/3))
         x(1, c) = rows%r(i, 1)*rows%soft(i, 1)
         x(2, c) = rows%r(i, 2)*rows%soft(i, 2)
         x(3, c) = rows%r(i, 3)*rows%soft(i, 3)
      end do
      if (last == 3) return
      do i = 1, n
         c = column(node + 2*i - 1)
         x(1, c) = rows%r(i, 4)*rows%soft(i, 4)
         x(2, c) = rows%r(i, 5)*rows%soft(i, 5)
         x(3, c) = rows%r(i, 6)*rows%soft(i, 6)
      end do
   end subroutine put_side

   !> Their solution as rows%r, 0 where there is no row
   pure subroutine take_solution(n, last, damped, node, column, x, rows)
      integer, value :: n
      integer, intent(in) :: last, node
      logical, intent(in) :: damped              !! rows of dampers have forces, too
      integer, intent(in) :: column(*)
      real(wp), intent(in) :: x(4, *)
      type(compliant_block_t), intent(inout) :: rows

      real(wp) :: with
      integer :: i, k, c

      do i = 1, n
         c = column(node + (i - 1)*(last/3))
         rows%r(i, 1) = x(1, c)
         rows%r(i, 2) = x(2, c)
         rows%r(i, 3) = x(3, c)
         if (last == 3) cycle
         c = column(node + 2*i - 1)
         rows%r(i, 4) = x(1, c)
         rows%r(i, 5) = x(2, c)
         rows%r(i, 6) = x(3, c)
      end do
      with = merge(1.0_wp, 0.0_wp, damped)
      do k = 1, last
         !$omp simd
         do i = 1, n
            rows%r(i, k) = merge(rows%r(i, k), 0.0_wp, &
               rows%weight(i, k) + with*rows%damp(i, k) > 0.0_wp)
         end do
      end do
   end subroutine take_solution

   !> self%factor%x := its solution
   subroutine solve_all(damped, self)
      logical, intent(in) :: damped              !! rows of dampers have forces, too
      type(compliant_t), intent(inout) :: self

      integer :: i

      associate (x => self%factor%x, column => self%pattern%column)
         do i = 1, size(self%hub)
            x(:, column(self%body(self%hub(i)))) = 0.0_wp
            x(:, column(self%body(self%hub(i)) + 1)) = 0.0_wp
         end do
      end associate
      call solve(self%pattern, self%factor)
      if (.not. damped) call take_out(self, size(self%damper))
   end subroutine solve_all

   !> self%y, self%turn: what a solution moves the leads, M^-1 B^T f, B of the pose that is tried
   subroutine moves_of_rows(model, ij, self)
      type(consistent_model_t), intent(in) :: model
      real(wp), contiguous, intent(in) :: ij(:, :)   !! of the leads, of that pose
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
         associate (j => self%share(i)*ij(i, :), c => self%pattern%column)
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
      integer, value :: n
      integer, intent(in) :: last
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
      integer, intent(in) :: from
      integer, value :: n
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
