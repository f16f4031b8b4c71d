!> Scenes that differ in numbers alone, and may take their steps together (kj_consistent_lanes).
module kj_consistent_topology
   use kj_kinds, only: wp
   use kj_joint_batch, only: joint_batch_t
   use kj_model, only: motion_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t, row_t
   implicit none
   private

   public :: is_small, same_topology

   integer, parameter :: MOST_ELEMENTS = 64      !! larger scenes fill blocks by themselves

contains

   !> A scene whose steps others may take: no large one, with constant gravity, without a host
   pure logical function is_small(model, state) result(small)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: state

      small = model%n_element <= MOST_ELEMENTS .and. model%n_element > 0 .and. &
         model%team%threads == 1 .and. size(model%map%hub) == 0 .and. &
         all(model%steady) .and. &
         .not. (allocated(state%f_host) .or. allocated(state%compliant))
   end function is_small

   !> Two scenes differ in numbers alone
   pure logical function same_topology(a, b) result(same)
      type(consistent_model_t), intent(in) :: a, b

      integer :: i

      same = a%n_lead == b%n_lead .and. a%n_body == b%n_body .and. a%damped .eqv. b%damped
      same = same .and. size(a%batch) == size(b%batch) .and. size(a%hold) == size(b%hold) .and. &
         size(a%gravity) == size(b%gravity) .and. a%skews%n == b%skews%n .and. &
         size(a%motion) == size(b%motion)
      if (.not. same) return
      same = size(a%curves%y) == size(b%curves%y) .and. all(a%rests .eqv. b%rests)
      if (same) same = same_numbers(a%curves%x, b%curves%x) .and. &
         same_numbers(a%curves%y, b%curves%y) .and. same_integers(a%curves%first, b%curves%first)
      do i = 1, size(a%batch)
         if (same) same = same_batch(a%batch(i), b%batch(i))
      end do
      do i = 1, size(a%hold)
         same = same .and. a%hold(i)%lead == b%hold(i)%lead .and. &
            same_rows(a%hold(i)%trans, b%hold(i)%trans, a%hold(i)%n_trans, b%hold(i)%n_trans) &
            .and. same_rows(a%hold(i)%rot, b%hold(i)%rot, a%hold(i)%n_rot, b%hold(i)%n_rot)
      end do
      do i = 1, size(a%motion)
         same = same .and. same_motion(a%motion(i), b%motion(i))
      end do
      do i = 1, size(a%gravity)
         if (same) same = same_integers(a%gravity(i)%node, b%gravity(i)%node)
      end do
   end function same_topology

   pure logical function same_numbers(a, b) result(same)
      real(wp), intent(in) :: a(:), b(:)

      same = all(a >= b .and. a <= b)
   end function same_numbers

   pure logical function same_integers(a, b) result(same)
      integer, intent(in) :: a(:), b(:)

      same = size(a) == size(b)
      if (same) same = all(a == b)
   end function same_integers

   pure logical function same_motion(a, b) result(same)
      type(motion_t), intent(in) :: a, b

      same = a%kind == b%kind .and. a%lead == b%lead .and. a%dir == b%dir .and. &
         a%skew == b%skew .and. a%curve == b%curve
   end function same_motion

   pure logical function same_rows(a, b, n_a, n_b) result(same)
      type(row_t), intent(in) :: a(3), b(3)
      integer, intent(in) :: n_a, n_b            !! rows used

      same = n_a == n_b
      if (same) same = all(a(:n_a)%dir == b(:n_a)%dir) .and. &
         all(a(:n_a)%skew == b(:n_a)%skew) .and. all(a(:n_a)%motion == b(:n_a)%motion)
   end function same_rows

   pure logical function same_batch(a, b) result(same)
      type(joint_batch_t), intent(in) :: a, b

      same = a%n == b%n .and. a%row == b%row .and. a%frame == b%frame .and. &
         all(a%law == b%law) .and. a%kind == b%kind .and. (a%limited .eqv. b%limited)
      if (.not. same) return
      same = all(a%lead == b%lead)
      associate (g => a%geometry, h => b%geometry)
         same = same .and. g%chart == h%chart .and. (g%mean .eqv. h%mean) .and. &
            (g%ball .eqv. h%ball) .and. g%sprung == h%sprung .and. g%damped == h%damped .and. &
            (g%shifted .eqv. h%shifted) .and. (g%implicit .eqv. h%implicit) .and. &
            (allocated(g%rail) .eqv. allocated(h%rail))
      end associate
   end function same_batch

end module kj_consistent_topology
