!> What the integrator `compliant` would make of a scene at its start.
module kj_consistent_compliant_check
   use kj_kinds, only: wp
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: is_spring
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_conditions, only: body_matrix
   use kj_consistent_safe_step, only: bound_t, new_bound, compliances, rows_of_end
   use kj_consistent_build, only: new_consistent_state
   use kj_consistent_compliant_build, only: make_implicit, size_of
   use kj_consistent_compliant_march, only: pace_t, start_pace, solves_a_step, WIDER
   use kj_consistent_compliant_pair, only: SOLVES_A_PAIR => SOLVES
   implicit none
   private

   public :: compliant_outlook, compliant_steps, unresolved

   integer, parameter :: MOST_ROWS = 600         !! of the dense matrix of all blocked rows
   integer, parameter :: MOST_JOINTS = 10000     !! of a scene that is copied for a word of advice
   !> error of positions, of the size of the scene, over (turn a step)^2: 1/60 to 1/15 in six
   !> mechanisms
   real(wp), parameter :: ERROR_OF_TURN = 1.0_wp/15.0_wp
   real(wp), parameter :: ERROR_OF_PAIR = 1.0_wp/30.0_wp   !! over its fourth power: 1/1500 to 1/5
   real(wp), parameter :: LEAST_ERROR = 1.0e-8_wp    !! that the integrator keeps
   real(wp), parameter :: MOST_ERROR = 1.0e-2_wp     !! beyond it no advice
   real(wp), parameter :: MUCH = 0.1_wp          !! of the error: worth a line
   real(wp), parameter :: NONE_LEFT = 1.0e-8_wp  !! of a diagonal: the row is one of those before

contains

   !> Limits of the step by the turn of the bodies and by explicit springs, the frequency of the
   !> stiffest blocked row, and how many blocked rows repeat others
   subroutine compliant_outlook(model, state, h_turn, solves, h_springs, omega, redundant)
      type(consistent_model_t), intent(inout) :: model    !! its joints become implicit ones
      type(consistent_state_t), intent(inout) :: state    !! at the start, becomes that of compliant
      real(wp), intent(out) :: h_turn, h_springs !! huge: no limit
      integer, intent(out) :: solves             !! in a step
      real(wp), intent(out) :: omega
      integer, intent(out) :: redundant          !! -1: too many rows to tell

      type(pace_t) :: pace
      real(wp) :: s(NDOF, NDOF, 2)
      integer :: b, i, k, n

      omega = 0.0_wp
      n = 0
      do b = 1, size(model%batch)
         if (is_spring(model%batch(b))) cycle
         do i = 1, model%batch(b)%n
            call compliances(model, state, b, i, s)
            do k = 1, NDOF
               if (joint_types(model%batch(b)%row)%free(k) == 1) cycle
               n = n + 1
               omega = max(omega, sqrt(max(0.0_wp, model%batch(b)%k(i, k)*(s(k, k, 1) + &
                  s(k, k, 2)))))
            end do
         end do
      end do
      redundant = -1
      if (n <= MOST_ROWS) call count_redundant(model, state, n, redundant)
      call make_implicit(model)
      call start_pace(model, state, pace)
      h_turn = pace%h_turn
      solves = solves_a_step(pace)
      h_springs = huge(1.0_wp)
      if (pace%bound%h < huge(1.0_wp)) h_springs = pace%h_bound
   end subroutine compliant_outlook

   !> What joints gave way by in a run, over the size of the scene or in rad; 0: little beside the
   !> error that was asked for. Their springs ring about as far, which long steps do not show;
   !> rigid ones are not where a body carries one that is some 1e6 times as heavy.
   pure real(wp) function unresolved(model, pace, gap, turn)
      type(consistent_model_t), intent(in) :: model
      type(pace_t), intent(in) :: pace
      real(wp), intent(in) :: gap, turn          !! largest of the run, length and rad

      real(wp) :: size

      unresolved = turn
      size = size_of(model)
      if (size > 0.0_wp) unresolved = max(turn, gap/size)
      if (unresolved < MUCH*pace%tolerance) unresolved = 0.0_wp
   end function unresolved

   !> Solves in which the integrator would have the error that joints make which give way by `gap`,
   !> about; 0: it has no advantage that can be told. error: of the size of the scene, for --error
   subroutine compliant_steps(model, gap, turn, span, steps, error)
      type(consistent_model_t), intent(in) :: model
      real(wp), intent(in) :: gap, turn, span    !! of a run: largest, fastest turn of a joint, time
      real(wp), intent(out) :: steps, error

      type(consistent_model_t) :: scene
      type(consistent_state_t) :: state
      type(bound_t) :: bound
      type(pace_t) :: pace
      real(wp) :: most, h, pair

      steps = 0.0_wp
      error = 0.0_wp
      if (.not. (gap > 0.0_wp .and. turn > 0.0_wp)) return
      if (any(model%batch%limited) .or. model%n_joint > MOST_JOINTS) return
      error = max(LEAST_ERROR, gap/max(size_of(model), tiny(gap)))
      if (error > MOST_ERROR) return
      scene = model
      call make_implicit(scene)
      call new_consistent_state(scene, state)
      call new_bound(scene, .false., state, bound)
      most = min(pace%factor*bound%h, model%control%sample)
      h = min(most, min(pace%turn, sqrt(error/ERROR_OF_TURN))/turn)
      pair = min(most, min(WIDER*pace%turn, sqrt(sqrt(error/ERROR_OF_PAIR)))/turn)
      steps = max(1.0_wp, span/max(h, pair/SOLVES_A_PAIR))
   end subroutine compliant_steps

   !> Rows that depend on others: those of B M^-1/2 that Gram-Schmidt leaves nothing of
   subroutine count_redundant(model, state, n, redundant)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state
      integer, intent(in) :: n
      integer, intent(out) :: redundant

      real(wp), allocatable :: a(:, :)
      real(wp) :: rows(6, 6), p(3, 3), before, after
      integer :: b, i, e, k, at, l, lead, kept

      allocate (a(6*model%n_lead, n), source=0.0_wp)
      at = 0
      do b = 1, size(model%batch)
         if (is_spring(model%batch(b))) cycle
         do i = 1, model%batch(b)%n
            do e = 1, 2
               lead = model%batch(b)%lead(i, e)
               rows = rows_of_end(model%batch(b), state, b, i, e)
               p = body_matrix(state, lead)
               rows(:, 1:3) = rows(:, 1:3)*sqrt(model%inverse_mass(lead))
               rows(:, 4:6) = matmul(rows(:, 4:6), p)*spread(sqrt(model%inverse_inertia(lead, :)), &
                  1, 6)
               l = at
               do k = 1, NDOF
                  if (joint_types(model%batch(b)%row)%free(k) == 1) cycle
                  l = l + 1
                  a(6*lead - 5:6*lead, l) = a(6*lead - 5:6*lead, l) + rows(k, :)
               end do
            end do
            at = l
         end do
      end do
      redundant = 0
      kept = 0
      do i = 1, n
         before = sum(a(:, i)**2)
         do l = 1, 2                             ! twice is enough
            do k = 1, kept
               a(:, i) = a(:, i) - dot_product(a(:, k), a(:, i))*a(:, k)
            end do
         end do
         after = sum(a(:, i)**2)
         if (after > NONE_LEFT*before .and. before > 0.0_wp) then
            kept = kept + 1
            a(:, kept) = a(:, i)/sqrt(after)
         else
            redundant = redundant + 1
         end if
      end do
   end subroutine count_redundant

end module kj_consistent_compliant_check
