!> The matrix B of blocks of joints at work: rates q' = B u from the velocities of the leads, and
!> wrenches -B^T F on them. What its parts are stands in kj_consistent_chart.
!> Source: docs/theory/joints.md 2.
module kj_consistent_matrix
   use kj_kinds, only: wp
   use kj_joint_types, only: NDOF
   use kj_block, only: BLOCK
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: consistent_joint_t, matrix_t
   implicit none
   private

   public :: poses_t, rates, joint_rates, add_moment, find_wrench, put_wrench

   !> force on end 1, moment about lead 1, about lead 2
   integer, parameter, public :: N_CONSISTENT_WRENCH = 9

   !> What joints see of the leads, joint-independent arrays
   type :: poses_t
      ! time, and the step that led here, 0 = none: of joints and leads by their place in a block,
      ! as far as places are used (team%lanes)
      real(wp) :: time(BLOCK) = 0.0_wp, h(BLOCK) = 0.0_wp
      real(wp), allocatable :: x(:, :)            !! (n_lead, 3) W
      !> (n_lead, 3) displacement: what joints read, so that a scene may lie far away
      real(wp), allocatable :: d(:, :)
      real(wp), allocatable :: quat(:, :)         !! (n_lead, 4) attitude: world from body axes
      real(wp), allocatable :: v(:, :), w(:, :)   !! (n_lead, 3) velocities; predicted in pass 2
      !> (n_lead, 3) angular velocity of the half step, before its drift
      real(wp), allocatable :: w_left(:, :)
      !> (n_lead, 3) turn in the last step, rotation vector
      real(wp), allocatable :: psi(:, :)
      real(wp), allocatable :: im(:)              !! (n_lead) inverse mass times number of joints
      !> (n_lead, 6) inverse inertia xx yy zz xy xz yz, W, times joints
      real(wp), allocatable :: ij(:, :)
   end type poses_t

contains

   !> moment := moment + f1 rot1 + f2 rot2 + f3 rot3
   pure subroutine add_moment(n, f, rot, moment)
      integer, value :: n
      real(wp), intent(in) :: f(BLOCK, 3), rot(BLOCK, 9)
      real(wp), intent(inout) :: moment(BLOCK, 3)

      integer :: i, k

      do k = 1, 3
         !$omp simd
         do i = 1, n
            moment(i, k) = moment(i, k) + f(i, 1)*rot(i, k) + f(i, 2)*rot(i, k + 3) + &
               f(i, 3)*rot(i, k + 6)
         end do
      end do
   end subroutine add_moment

   !> Force on end 1 and moments about the leads of both ends, as rows of all joints; abreast: as
   !> gather_abreast reads them
   pure subroutine put_wrench(n, abreast, f, moment, b, wrench)
      integer, value :: n
      logical, intent(in) :: abreast
      real(wp), intent(in) :: f(BLOCK, 3), moment(BLOCK, 3)   !! as those of find_wrench
      type(matrix_t), intent(in) :: b
      !> (N_CONSISTENT_WRENCH, n and more)
      real(wp), contiguous, intent(inout) :: wrench(:, :)

      real(wp) :: w(BLOCK, N_CONSISTENT_WRENCH)
      integer :: i, k

      if (abreast) then
         call find_wrench(n, f, moment, b, wrench(:, :BLOCK))
         return
      end if
      call find_wrench(n, f, moment, b, w)
      do i = 1, n
         do k = 1, N_CONSISTENT_WRENCH
            wrench(k, i) = w(i, k)
         end do
      end do
   end subroutine put_wrench

   !> Force on end 1 and moments about the leads of both ends
   pure subroutine find_wrench(n, f, moment, b, w)
      integer, value :: n
      real(wp), intent(in) :: f(BLOCK, 3)         !! forces of the translations
      real(wp), intent(in) :: moment(BLOCK, 3)    !! of the rotations, on body 1, W
      type(matrix_t), intent(in) :: b
      real(wp), intent(out) :: w(BLOCK, N_CONSISTENT_WRENCH)

      integer :: i, k

      do k = 1, 3
         !$omp simd
         do i = 1, n
            w(i, k) = f(i, 1)*b%force(i, k) + f(i, 2)*b%force(i, k + 3) + f(i, 3)*b%force(i, k + 6)
            w(i, k + 3) = f(i, 1)*b%couple(i, k) + f(i, 2)*b%couple(i, k + 3) + &
               f(i, 3)*b%couple(i, k + 6) + &
               moment(i, k)
         end do
      end do
      !$omp simd
      do i = 1, n
         w(i, 7) = (b%apart(i, 2)*w(i, 3) - b%apart(i, 3)*w(i, 2)) - w(i, 4)
         w(i, 8) = (b%apart(i, 3)*w(i, 1) - b%apart(i, 1)*w(i, 3)) - w(i, 5)
         w(i, 9) = (b%apart(i, 1)*w(i, 2) - b%apart(i, 2)*w(i, 1)) - w(i, 6)
      end do
   end subroutine find_wrench

   !> Rates of all joints of a batch with the velocities of the poses
   pure subroutine joint_rates(batch, poses, joint, rate)
      type(joint_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      type(consistent_joint_t), intent(in) :: joint
      real(wp), intent(out) :: rate(:, :)        !! (n, 6) J

      real(wp) :: part(BLOCK, 6)
      integer :: from, n

      do from = 1, batch%n, BLOCK
         n = min(BLOCK, batch%n - from + 1)
         call rates(batch, NDOF, poses%v, poses%w, from, n, &
            joint%block((from - 1)/BLOCK + 1)%b, part)
         rate(from:from + n - 1, :) = part(:n, :)
      end do
   end subroutine joint_rates

   !> q' = B v: translations e.(v2 - v1 - w2 x d) + m1.(w2 - w1), rotations rot.(w2 - w1)
   pure subroutine rates(batch, rows, v, w, from, n, b, rate)
      type(joint_batch_t), intent(in) :: batch
      real(wp), contiguous, intent(in) :: v(:, :), w(:, :)   !! (n_lead, 3)
      integer, value :: rows, from, n            !! rows: 6; 3 where rotations are not wanted
      type(matrix_t), intent(in) :: b
      real(wp), intent(out) :: rate(BLOCK, 6)

      real(wp), dimension(BLOCK, 3) :: dv, w2, dw
      integer :: i, k, lead1, lead2

      if (batch%abreast) then
         lead1 = batch%lead(from, 1) - 1
         lead2 = batch%lead(from, 2) - 1
         do k = 1, 3
            !$omp simd
            do i = 1, n
               dv(i, k) = v(lead2 + i, k) - v(lead1 + i, k)
               w2(i, k) = w(lead2 + i, k)
               dw(i, k) = w2(i, k) - w(lead1 + i, k)
            end do
         end do
      else
         do i = 1, n
            lead1 = batch%lead(from + i - 1, 1)
            lead2 = batch%lead(from + i - 1, 2)
            do k = 1, 3
               dv(i, k) = v(lead2, k) - v(lead1, k)
               w2(i, k) = w(lead2, k)
               dw(i, k) = w2(i, k) - w(lead1, k)
            end do
         end do
      end if
      !$omp simd
      do i = 1, n
         dv(i, 1) = dv(i, 1) - (w2(i, 2)*b%apart(i, 3) - w2(i, 3)*b%apart(i, 2))
         dv(i, 2) = dv(i, 2) - (w2(i, 3)*b%apart(i, 1) - w2(i, 1)*b%apart(i, 3))
         dv(i, 3) = dv(i, 3) - (w2(i, 1)*b%apart(i, 2) - w2(i, 2)*b%apart(i, 1))
      end do
      do k = 0, 2
         !$omp simd
         do i = 1, n
            rate(i, 1 + k) = b%force(i, 3*k + 1)*dv(i, 1) + b%force(i, 3*k + 2)*dv(i, 2) + &
               b%force(i, 3*k + 3)*dv(i, 3) + &
               (b%couple(i, 3*k + 1)*dw(i, 1) + b%couple(i, 3*k + 2)*dw(i, 2) + &
               b%couple(i, 3*k + 3)*dw(i, 3))
         end do
      end do
      if (rows < NDOF) return
      do k = 0, 2
         !$omp simd
         do i = 1, n
            rate(i, 4 + k) = b%turn(i, 3*k + 1)*dw(i, 1) + b%turn(i, 3*k + 2)*dw(i, 2) + &
               b%turn(i, 3*k + 3)*dw(i, 3)
         end do
      end do
   end subroutine rates

end module kj_consistent_matrix
