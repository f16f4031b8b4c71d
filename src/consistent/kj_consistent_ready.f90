!> A scene made ready to start: damping of blocked directions from the masses that they meet, and
!> poses in which the joints bear the first forces, so that none begins to ring.
!> Source: docs/theory/consistent.md 15.
module kj_consistent_ready
   use kj_kinds, only: wp
   use kj_math3, only: to_quaternion, rotation, cross
   use kj_block, only: BLOCK, block_of, lane_of
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: is_spring, LAW_SPRING
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_build, only: settle
   use kj_consistent_body, only: inverse_inertias, spin_velocity, columns
   use kj_consistent_compliance, only: end_inertias, compliance
   use kj_consistent_compliant_types, only: compliant_t
   use kj_consistent_compliant_build, only: make_implicit, new_compliant
   use kj_consistent_compliant_start, only: start_velocities
   use kj_consistent_compliant_step, only: look_ahead
   use kj_consistent_compliant_matrix, only: solve_rows, moves_of_rows
   use kj_consistent_compliant_pass, only: see_joints
   implicit none
   private

   public :: set_damping, begin_scene

   real(wp), parameter :: PIVOT = 1.0e-12_wp     !! of a diagonal entry: below it nothing moves
   ! (h w)^2 of the stiffest row of the first forces: 1/STIFF, left out, is what rounding takes
   real(wp), parameter :: STIFF = 1.0e8_wp
   real(wp), parameter :: FIRST_STEP = 10.0_wp   !! h w of that row with its own stiffness
   real(wp), parameter :: ALIKE = 0.05_wp        !! forces of two steps: else velocities jump
   real(wp), parameter :: FAR = 0.01_wp          !! of the scene, of a radian: no first forces

contains

   !> Damping, poses in which joints bear the first forces, velocities that obey conditions
   subroutine begin_scene(model, rigid, state)
      type(consistent_model_t), intent(inout) :: model
      logical, intent(in) :: rigid               !! joints that need no way to bear a force
      type(consistent_state_t), intent(inout) :: state    !! new

      real(wp) :: w2

      call set_damping(model, state, w2)
      if (.not. rigid) call bear_forces(model, w2, state)
      call settle(model, state)
   end subroutine begin_scene

   !> c = Cr sqrt(K m) of blocked directions, m what moves along one while the others of the joint
   !> hold: 1/m is a pivot of B M^-1 B^T, the last one. w2: largest K/m of a row alone.
   subroutine set_damping(model, state, w2)
      type(consistent_model_t), intent(inout) :: model
      type(consistent_state_t), intent(inout) :: state    !! of the poses the inverse inertias
      real(wp), intent(out) :: w2

      real(wp) :: im(BLOCK, 2), ij1(BLOCK, 6), ij2(BLOCK, 6), s(BLOCK, 21), m(NDOF)
      integer :: b, from, n, i, j, k

      w2 = 0.0_wp
      call inverse_inertias(model, state%poses%quat, 1, model%n_lead, state%poses%ij)
      do b = 1, size(model%batch)
         associate (batch => model%batch(b))
            if (is_spring(batch)) cycle
            do from = 1, batch%n, BLOCK
               n = min(BLOCK, batch%n - from + 1)
               call end_inertias(batch, state%poses, from, n, im, ij1, ij2)
               do i = 1, n
                  associate (ends => real(max(1, model%n_end(batch%lead(from + i - 1, :))), wp))
                     im(i, :) = im(i, :)/ends
                     ij1(i, :) = ij1(i, :)/ends(1)
                     ij2(i, :) = ij2(i, :)/ends(2)
                  end associate
               end do
               state%joint(b)%block((from - 1)/BLOCK + 1)%fd = 0.0_wp   ! by another damping
               call compliance(n, NDOF, state%joint(b)%block((from - 1)/BLOCK + 1)%b, im, ij1, &
                  ij2, s)
               do i = 1, n
                  j = from + i - 1
                  call held_masses(s(i, :), joint_types(batch%row)%free == 0, m)
                  do k = 1, NDOF
                     if (joint_types(batch%row)%free(k) == 1) cycle
                     if (iand(batch%law(k), LAW_SPRING) == 0) cycle
                     batch%c(j, k) = batch%cr(j)*sqrt(batch%k(j, k)*m(k))
                     w2 = max(w2, batch%k(j, k)*s(i, k*(k + 1)/2))
                  end do
               end do
            end do
         end associate
      end do
   end subroutine set_damping

   !> Mass or inertia along each direction while the other wanted ones hold; 0 where nothing moves
   pure subroutine held_masses(s, wanted, m)
      real(wp), intent(in) :: s(21)              !! lower triangle by rows
      logical, intent(in) :: wanted(NDOF)
      real(wp), intent(out) :: m(NDOF)

      real(wp) :: a(NDOF, NDOF)
      integer :: i, k, last

      m = 0.0_wp
      do last = 1, NDOF
         if (.not. wanted(last)) cycle
         do k = 1, NDOF
            do i = 1, k
               a(k, i) = s(k*(k - 1)/2 + i)
               a(i, k) = a(k, i)
            end do
         end do
         do k = 1, NDOF
            if (.not. wanted(k) .or. k == last) cycle
            if (.not. a(k, k) > PIVOT*s(k*(k + 1)/2)) cycle
            do i = 1, NDOF
               if (i /= k .and. wanted(i)) a(i, :) = a(i, :) - a(i, k)/a(k, k)*a(k, :)
            end do
         end do
         if (a(last, last) > PIVOT*s(last*(last + 1)/2)) m(last) = 1.0_wp/a(last, last)
      end do
   end subroutine held_masses

   !> Move the bodies of the start, by as little as can be in the sense of their masses, until
   !> blocked directions bear the forces of the first moment: those of joints that do not give way,
   !> shared as their stiffness wants it. They come from the position stage of `compliant` in a step
   !> of ten over the highest frequency and half of it, with all stiffness as many times larger, and
   !> are those a third of the step from now. Where velocities
   !> jump at the start, or the way is long, all stays unloaded.
   subroutine bear_forces(model, w2, state)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: w2                 !! from set_damping
      type(consistent_state_t), intent(inout) :: state

      type(consistent_model_t) :: stiff
      type(consistent_state_t) :: trial, first
      real(wp) :: h
      logical :: good
      integer :: pass, b, at

      if (.not. w2 > 0.0_wp) return
      h = FIRST_STEP/sqrt(w2)
      stiff = model
      call make_implicit(stiff)
      trial = state
      first = state
      call first_forces(stiff, 0.5_wp*h, w2, first, good)
      if (good) call first_forces(stiff, h, w2, trial, good)
      if (.not. good) return
      if (.not. same_forces(stiff, first%compliant, trial%compliant)) return
      call spin_velocity(model, state%poses%quat, state%l, 1, model%n_lead, state%poses%w)
      do b = 1, size(model%batch)
         do at = 1, size(trial%compliant%joint(b)%block)
            associate (f => trial%compliant%joint(b)%block(at)%f)
               f = 2.0_wp*first%compliant%joint(b)%block(at)%f - f
            end associate
         end do
      end do
      do pass = 1, 2
         call approach(stiff, trial, good)
         if (.not. good) return
      end do
      state%poses%x = trial%poses%x
      state%poses%d = trial%poses%d
      state%poses%quat = trial%poses%quat
      call keep_spin(model, state)
   end subroutine bear_forces

   !> Multipliers of a first step of joints that hardly give way, in state%compliant
   subroutine first_forces(model, h, w2, state, good)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h, w2
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: good

      integer :: b, at

      call new_compliant(model, .false., state)
      associate (self => state%compliant)
         self%gap = 1.0_wp/STIFF
         do b = 1, size(model%batch)
            do at = 1, size(self%joint(b)%block)
               self%joint(b)%block(at)%k = STIFF/(h**2*w2)*self%joint(b)%block(at)%k
               self%joint(b)%block(at)%c = 0.0_wp
            end do
         end do
         call start_velocities(model, h, state)
         call look_ahead(model, h, state)
         good = self%known == state%cycle
      end associate
   end subroutine first_forces

   !> A step of half the length finds the same: forces, and no velocity that jumps
   pure logical function same_forces(model, a, b) result(same)
      type(consistent_model_t), intent(in) :: model
      type(compliant_t), intent(in) :: a, b

      real(wp) :: largest(2), apart(2)
      integer :: i, at, n, part

      largest = 0.0_wp
      apart = 0.0_wp
      do i = 1, size(model%batch)
         do at = 1, size(a%joint(i)%block)
            n = min(BLOCK, model%batch(i)%n - BLOCK*(at - 1))
            associate (f => a%joint(i)%block(at)%f, g => b%joint(i)%block(at)%f)
               do part = 1, 2
                  largest(part) = max(largest(part), maxval(abs(g(:n, 3*part - 2:3*part))))
                  apart(part) = max(apart(part), maxval(abs(g(:n, 3*part - 2:3*part) - &
                     f(:n, 3*part - 2:3*part))))
               end do
            end associate
         end do
      end do
      same = apart(1) <= ALIKE*largest(1) .and. &
         apart(2) <= ALIKE*max(largest(2), a%size*largest(1))
   end function same_forces

   !> Poses with q = f/K of the blocked rows, by one step of Newton's method
   subroutine approach(model, state, good)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      logical, intent(out) :: good

      real(wp) :: q(4), turn(4)
      integer :: b, at, i, j, k

      associate (self => state%compliant)
         call see_joints(model, state, self)
         do b = 1, size(model%batch)
            do j = 1, model%batch(b)%n
               at = block_of(j)
               i = lane_of(j)
               associate (rows => self%joint(b)%block(at))
                  do k = 1, NDOF
                     rows%r(i, k) = 0.0_wp
                     if (self%explicit(k, b) .or. .not. model%batch(b)%k(j, k) > 0.0_wp) cycle
                     rows%r(i, k) = rows%weight(i, k)*(rows%f(i, k)/model%batch(b)%k(j, k) - &
                        rows%q(i, k))
                  end do
               end associate
            end do
         end do
         call solve_rows(model, self)
         call moves_of_rows(model, state%poses%ij, self)
         good = count(abs(self%y) <= FAR*self%size) == size(self%y) .and. &
            count(abs(self%turn) <= FAR) == size(self%turn)
         if (.not. good) return
         state%poses%d = state%poses%d + self%y
         state%poses%x = state%poses%x + self%y
         do i = 1, model%n_lead
            if (.not. any(abs(self%turn(i, :)) > 0.0_wp)) cycle
            turn = to_quaternion(rotation(self%turn(i, :)))
            q = state%poses%quat(i, :)
            state%poses%quat(i, :) = [turn(1)*q(1) - dot_product(turn(2:4), q(2:4)), &
               turn(1)*q(2:4) + q(1)*turn(2:4) + cross(turn(2:4), q(2:4))]
         end do
      end associate
   end subroutine approach

   !> The angular velocities stay, in the new attitudes
   subroutine keep_spin(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: e(3, 3)
      integer :: i

      do i = 1, model%n_lead
         if (.not. maxval(model%inverse_inertia(i, :)) > 0.0_wp) cycle
         e = reshape(columns(state%poses%quat(i, :)), [3, 3])
         state%l(i, :) = matmul(e, model%spin_inertia(i, :)*matmul(state%poses%w(i, :), e))
      end do
   end subroutine keep_spin

end module kj_consistent_ready
