!> Passes over the joints in a step of the integrator `compliant`: what each stage does with a joint
!> stands together, so that a joint is read once, and few joints have kernels of their own.
!> Source: docs/theory/compliant.md 2, 3; docs/performance.md.
module kj_consistent_compliant_pass
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of, lane_of, group_of
   use kj_joint_types, only: NDOF, CHART_VECTOR
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: consistent_block_t, in_groups, group_at
   use kj_consistent_matrix, only: poses_t, rates, N_CONSISTENT_WRENCH
   use kj_consistent_springs, only: coordinates
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_compliant_types, only: compliant_t, compliant_block_t, leads_then_t
   use kj_consistent_compliant_rows, only: extrapolate, correct, residual, find_change, &
      velocity_side, count_work, take_power, take_block
   use kj_consistent_compliant_matrix, only: add_wrenches, wrench_of_rows, put_side, &
      take_solution, rows_at
   implicit none
   private

   public :: pass_t, over_joints, see_joints, close_rows

   !> Coordinates and B of the present pose, as tried ones
   integer, parameter, public :: LOOK = 1
   !> Position stage: forces of multipliers f, guessed or changed by a part of r, on the leads;
   !> coordinates and B as LOOK, and the right-hand side; its solution r
   integer, parameter, public :: PUSH = 2, SEE = 3, TAKE = 4
   !> Velocity stage: the right-hand side for the velocities of the poses; multipliers g from its
   !> solution, and their forces on the leads
   integer, parameter, public :: ASK = 5, GIVE = 6
   !> After it: work on implicit rows, which is elastic or lost, and of dampers; the pose that was
   !> tried becomes the present one
   integer, parameter :: CLOSE = 7


   !> What a pass goes by, and the largest numbers that it finds, of translations and rotations
   type :: pass_t
      integer :: what = LOOK
      real(wp) :: h = 0.0_wp                     !! step
      logical :: guessed = .false., changed = .false.   !! f
      real(wp) :: guess = 0.0_wp                 !! part of the last rise
      real(wp) :: part = 0.0_wp                  !! of r that f lacks
      logical :: at_rest = .false.               !! without forces of implicit rows
      logical :: shift = .false.                 !! ASK: the rise is that of the last step
      real(wp) :: most(2) = 0.0_wp               !! SEE: residual, TAKE: change of f
      real(wp) :: force(2) = 0.0_wp              !! TAKE: f after it
   end type pass_t

contains

   !> Coordinates and B of all joints in the present pose, as tried ones
   subroutine see_joints(model, state, self)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self

      type(pass_t) :: pass

      call over_joints(model, pass, state, self)
   end subroutine see_joints

   !> End of a step
   subroutine close_rows(model, h, state, self)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: h
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self

      type(pass_t) :: pass

      pass%what = CLOSE
      pass%h = h
      call over_joints(model, pass, state, self)
   end subroutine close_rows

   !> A pass over all joints. Leads have the sum of forces in the order of the joints, by one thread
   subroutine over_joints(model, pass, state, self)
      type(consistent_model_t), intent(in) :: model
      type(pass_t), intent(inout) :: pass
      type(consistent_state_t), intent(inout) :: state
      type(compliant_t), intent(inout) :: self

      real(wp) :: most(2), force(2)
      integer :: piece

      most = 0.0_wp
      force = 0.0_wp
      if (model%team%threads > 1 .and. pass%what /= PUSH .and. pass%what /= GIVE) then
         !$omp parallel do schedule(static) num_threads(model%team%threads) &
         !$omp reduction(max: most, force)
         do piece = 1, size(model%team%joint, 2)
            call over_piece(model, model%team%joint(:, piece), pass, state, self, most, force)
         end do
      else                                       ! a team of one costs, too
         do piece = 1, size(model%team%joint, 2)
            call over_piece(model, model%team%joint(:, piece), pass, state, self, most, force)
         end do
      end if
      pass%most = most
      pass%force = force
   end subroutine over_joints

   !> The joints of a piece: batch, first joint, last joint
   subroutine over_piece(model, piece, pass, state, self, most, force)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: piece(3)
      type(pass_t), intent(in) :: pass
      type(consistent_state_t), target, intent(inout) :: state
      type(compliant_t), target, intent(inout) :: self
      real(wp), intent(inout) :: most(2), force(2)

      type(compliant_block_t), pointer :: rows
      type(consistent_block_t), pointer :: lanes
      integer :: b, from, n

      b = piece(1)
      if (.not. (self%rowed(b) .or. any(pass%what == [LOOK, SEE, CLOSE]))) return
      associate (batch => model%batch(b), first => model%batch(b)%first)
         from = piece(2)
         do while (from <= piece(3))
            n = min(BLOCK, piece(3) - from + 1)
            if (in_groups(batch)) n = group_of(n)
            call group_at(state%joint(b)%block(block_of(from)), lane_of(from), lanes)
            call rows_at(self%joint(b)%block(block_of(from)), lane_of(from), rows)
            select case (n)                      ! few joints: kernels of their own
            case (1)
               call over(1, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            case (2)
               call over(2, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            case (3)
               call over(3, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            case (4)
               call over(4, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            case (8)
               call over(8, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            case (BLOCK)
               call over(BLOCK, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            case default
               call over(n, pass, batch, from, self%last(b), self%rowed(b), self%damped(b), &
                  self%explicit(:, b), self%node(first + from), self%pattern%column, self%start, &
                  state%poses, lanes, rows, self%factor%x, model%n_lead, state%f, state%t, most, &
                  force)
            end select
            from = from + n
         end do
      end associate
   end subroutine over_piece

   !> The same for n joints of a block. Nodes of the joints of a batch follow each other.
   subroutine over(n, pass, batch, from, last, rowed, damped, explicit, node, column, start, &
      poses, lanes, rows, x, n_lead, f, t, most, force)
      integer, value :: n
      type(pass_t), intent(in) :: pass
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: from, last          !! first joint, last row
      logical, intent(in) :: rowed, damped, explicit(6)
      integer, intent(in) :: node                !! of translations of the first joint
      integer, intent(in) :: column(*), n_lead
      type(leads_then_t), intent(in) :: start
      type(poses_t), intent(in) :: poses
      type(consistent_block_t), intent(inout) :: lanes
      type(compliant_block_t), intent(inout) :: rows
      real(wp), intent(inout) :: x(4, *)         !! right-hand side and solution
      real(wp), intent(inout) :: f(n_lead, 3), t(n_lead, 3)
      real(wp), intent(inout) :: most(2), force(2)

      real(wp) :: y(BLOCK, 6), w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: i, k

      select case (pass%what)
      case (LOOK, SEE)
         call coordinates(batch, batch%geometry%ball .and. last == 3, poses, from, n, lanes%q, &
            rows%q, rows%b, rows%rot)
         if (batch%geometry%chart == CHART_VECTOR .and. batch%limited) then
            do i = 1, n                          ! locked: forces belong to the coordinates
               if (any(rows%k(i, 4:6) > 0.0_wp)) rows%b%turn(i, :) = rows%rot(i, :)
            end do
         end if
         if (pass%what == LOOK .or. .not. rowed) return
         call residual(n, last, pass%h, lanes%q, rows, most)
         call put_side(n, last, node, column, rows, x)
      case (PUSH)
         if (pass%guessed) call extrapolate(n, last, pass%guess, rows)
         if (pass%changed) call correct(n, last, pass%part, rows)
         do k = 1, last
            y(:n, k) = rows%f(:n, k)
            if (explicit(k)) y(:n, k) = y(:n, k) + lanes%fd(:n, k)
         end do
         call wrench_of_rows(n, last, y, lanes%b, w)
         call add_wrenches(batch, from, n, w, f, t)
      case (TAKE)
         call take_solution(n, last, .false., node, column, x, rows)
         call find_change(n, last, rows, most, force)
      case (ASK)
         if (pass%part > 0.0_wp) call correct(n, last, pass%part, rows)
         do k = 1, merge(last, 0, pass%shift)
            rows%rise_before(:n, k) = rows%rise(:n, k)
            rows%rise(:n, k) = rows%f(:n, k) - rows%g(:n, k)
         end do
         call rates(batch, last, poses%v, poses%w, from, n, rows%b, y)
         call velocity_side(n, last, pass%h, pass%at_rest, lanes%q, y, rows)
         call put_side(n, last, node, column, rows, x)
      case (GIVE)
         call take_solution(n, last, .true., node, column, x, rows)
         do k = 1, last
            rows%g(:n, k) = rows%r(:n, k) + rows%rest(:n, k)
         end do
         call wrench_of_rows(n, last, rows%g, rows%b, w)
         call add_wrenches(batch, from, n, w, f, t)
      case (CLOSE)
         if (rowed) call count_work(n, last, lanes%q, rows, lanes%elastic, lanes%dissipated)
         if (damped) then
            call rates(batch, NDOF, start%v_half, poses%w_left, from, n, lanes%b, y)
            call take_power(n, pass%h, explicit, lanes%fd, y, lanes%dissipated)
            do k = 1, NDOF
               if (explicit(k)) lanes%fd(:n, k) = merge(0.0_wp, rows%g(:n, k), &
                  rows%k(:n, k) > 0.0_wp)
            end do
            call rates(batch, NDOF, start%v_half, start%w_half, from, n, rows%b, y)
            call take_power(n, pass%h, explicit, lanes%fd, y, lanes%dissipated)
         end if
         call take_block(n, rows%q, rows%b, lanes%q, lanes%b)
      end select
   end subroutine over

end module kj_consistent_compliant_pass
