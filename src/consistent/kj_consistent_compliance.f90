!> What the joints of a block meet: S = B M^-1 B^T, and the largest eigenvalue of K^1/2 S K^1/2.
!> Source: docs/theory/time_step.md 3, 4.
module kj_consistent_compliance
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_joint_batch, only: joint_batch_t
   use kj_consistent_batch, only: matrix_t
   use kj_consistent_matrix, only: poses_t
   implicit none
   private

   public :: end_inertias, compliance, eigenvalues_from_above

contains

   !> Inverse masses and inertias of the leads of both ends, times their numbers of joints
   pure subroutine end_inertias(batch, poses, from, n, im, ij1, ij2)
      type(joint_batch_t), intent(in) :: batch
      type(poses_t), intent(in) :: poses
      integer, value :: from, n
      real(wp), intent(out) :: im(BLOCK, 2), ij1(BLOCK, 6), ij2(BLOCK, 6)

      integer :: i, k, lead1, lead2

      if (batch%abreast) then
         lead1 = batch%lead(from, 1)
         lead2 = batch%lead(from, 2)
         im(:n, 1) = poses%im(lead1:lead1 + n - 1)
         im(:n, 2) = poses%im(lead2:lead2 + n - 1)
         ij1(:n, :) = poses%ij(lead1:lead1 + n - 1, :)
         ij2(:n, :) = poses%ij(lead2:lead2 + n - 1, :)
         return
      end if
      do i = 1, n
         lead1 = batch%lead(from + i - 1, 1)
         lead2 = batch%lead(from + i - 1, 2)
         im(i, 1) = poses%im(lead1)
         im(i, 2) = poses%im(lead2)
         do k = 1, 6
            ij1(i, k) = poses%ij(lead1, k)
            ij2(i, k) = poses%ij(lead2, k)
         end do
      end do
   end subroutine end_inertias

   !> S = B M^-1 B^T of each joint, lower triangle by rows: s11, s21, s22, s31, ...
   pure subroutine compliance(n, rows, b, im, ij1, ij2, s)
      integer, value :: n, rows                  !! 6; 3 where those of rotations are not wanted
      type(matrix_t), intent(in) :: b
      real(wp), intent(in) :: im(BLOCK, 2)
      real(wp), intent(in) :: ij1(BLOCK, 6), ij2(BLOCK, 6)   !! J^-1: xx yy zz xy xz yz
      real(wp), intent(out) :: s(BLOCK, 21)

      real(wp), dimension(BLOCK, 9) :: m2, j1, j2, jr
      real(wp) :: ij(BLOCK, 6), both(BLOCK)
      integer :: i, k, l, at

      both(:n) = im(:n, 1) + im(:n, 2)
      do k = 1, 7, 3
         !$omp simd
         do i = 1, n
            m2(i, k) = (b%apart(i, 2)*b%force(i, k + 2) - &
               b%apart(i, 3)*b%force(i, k + 1)) - b%couple(i, k)
            m2(i, k + 1) = (b%apart(i, 3)*b%force(i, k) - &
               b%apart(i, 1)*b%force(i, k + 2)) - b%couple(i, k + 1)
            m2(i, k + 2) = (b%apart(i, 1)*b%force(i, k + 1) - &
               b%apart(i, 2)*b%force(i, k)) - b%couple(i, k + 2)
         end do
      end do
      call weigh(n, ij1, b%couple, j1)
      call weigh(n, ij2, m2, j2)
      at = 0
      do k = 1, 7, 3
         do l = 1, k, 3
            at = at + 1
            !$omp simd
            do i = 1, n
               s(i, at) = b%couple(i, k)*j1(i, l) + b%couple(i, k + 1)*j1(i, l + 1) + &
                  b%couple(i, k + 2)*j1(i, l + 2) + m2(i, k)*j2(i, l) + &
                  m2(i, k + 1)*j2(i, l + 1) + m2(i, k + 2)*j2(i, l + 2) + &
                  both(i)*(b%force(i, k)*b%force(i, l) + b%force(i, k + 1)*b%force(i, l + 1) + &
                  b%force(i, k + 2)*b%force(i, l + 2))
            end do
         end do
      end do
      if (rows < 6) return
      ij(:n, :) = ij1(:n, :) + ij2(:n, :)
      call weigh(n, ij, b%turn, jr)
      do k = 1, 7, 3
         do l = 1, 7, 3
            at = at + 1
            !$omp simd
            do i = 1, n
               s(i, at) = b%turn(i, k)*(j1(i, l) - j2(i, l)) + b%turn(i, k + 1)*(j1(i, l + 1) - &
                  j2(i, l + 1)) + b%turn(i, k + 2)*(j1(i, l + 2) - j2(i, l + 2))
            end do
         end do
         do l = 1, k, 3
            at = at + 1
            !$omp simd
            do i = 1, n
               s(i, at) = b%turn(i, k)*jr(i, l) + b%turn(i, k + 1)*jr(i, l + 1) + &
                  b%turn(i, k + 2)*jr(i, l + 2)
            end do
         end do
      end do
   end subroutine compliance

   !> y = J^-1 b for three vectors
   pure subroutine weigh(n, ij, b, y)
      integer, value :: n
      real(wp), intent(in) :: ij(BLOCK, 6), b(BLOCK, 9)
      real(wp), intent(out) :: y(BLOCK, 9)

      integer :: i, k

      do k = 1, 7, 3
         !$omp simd
         do i = 1, n
            y(i, k) = ij(i, 1)*b(i, k) + ij(i, 4)*b(i, k + 1) + ij(i, 5)*b(i, k + 2)
            y(i, k + 1) = ij(i, 4)*b(i, k) + ij(i, 2)*b(i, k + 1) + ij(i, 6)*b(i, k + 2)
            y(i, k + 2) = ij(i, 5)*b(i, k) + ij(i, 6)*b(i, k + 1) + ij(i, 3)*b(i, k + 2)
         end do
      end do
   end subroutine weigh

   !> Largest eigenvalue of K^1/2 S K^1/2 of each joint, from above by at most 0.7 %.
   !>
   !> For a symmetric A >= 0 of order 6, lambda <= (tr A^p)^(1/p) <= 6^(1/p) lambda. A over its
   !> trace, squared seven times, gives p = 256, for all joints of the block at once. LAPACK takes
   !> one matrix a call, which costs more than a cycle.
   pure subroutine eigenvalues_from_above(n, n_dof, s, k, lambda)
      integer, value :: n
      integer, intent(in) :: n_dof               !! 6; 3 where k is 0 for rotations
      real(wp), intent(in) :: s(BLOCK, 21)       !! lower triangles by rows
      real(wp), intent(in) :: k(BLOCK, 6)        !! >= 0
      real(wp), intent(out) :: lambda(BLOCK)

      integer, parameter :: SQUARINGS = 7
      real(wp), parameter :: LEAST = 1.0e-150_wp   !! root of an eigenvalue that limits no step
      real(wp) :: a(BLOCK, 21), root(BLOCK, 6), trace(BLOCK), inverse(BLOCK), scale(BLOCK)
      integer :: i, l, m, at, power

      ! over the largest k s: the trace of very stiff joints is no number any more
      scale(:n) = 0.0_wp
      do l = 1, n_dof
         root(:n, l) = sqrt(k(:n, l))
         scale(:n) = max(scale(:n), root(:n, l)*sqrt(max(0.0_wp, s(:n, l*(l + 1)/2))))
      end do
      inverse(:n) = merge(1.0_wp/max(scale(:n), LEAST), 0.0_wp, .not. scale(:n) < LEAST)
      trace(:n) = 0.0_wp
      do l = 1, n_dof
         root(:n, l) = root(:n, l)*inverse(:n)
         trace(:n) = trace(:n) + (root(:n, l)*s(:n, l*(l + 1)/2))*root(:n, l)
      end do
      inverse(:n) = 1.0_wp/max(trace(:n), tiny(1.0_wp))
      do l = 1, n_dof
         do m = 1, l
            at = l*(l - 1)/2 + m
            !$omp simd
            do i = 1, n
               a(i, at) = (root(i, l)*s(i, at))*root(i, m)*inverse(i)
            end do
         end do
      end do
      do power = 1, SQUARINGS
         call square(n, n_dof, a)
      end do
      lambda(:n) = 0.0_wp
      do l = 1, n_dof
         do m = 1, l
            at = l*(l - 1)/2 + m
            lambda(:n) = lambda(:n) + merge(1.0_wp, 2.0_wp, l == m)*a(:n, at)**2
         end do
      end do
      do power = 0, SQUARINGS
         lambda(:n) = sqrt(lambda(:n))
      end do
      lambda(:n) = lambda(:n)*trace(:n)*scale(:n)*scale(:n)
   end subroutine eigenvalues_from_above

   !> A := A A for symmetric matrices of order 6, lower triangles by rows
   pure subroutine square(n, n_dof, a)
      integer, value :: n
      integer, intent(in) :: n_dof               !! 6; 3 where the others are 0
      real(wp), intent(inout) :: a(BLOCK, 21)

      !> where the elements stand
      integer, parameter :: PLACE(6, 6) = reshape([1, 2, 4, 7, 11, 16, 2, 3, 5, 8, 12, 17, &
         4, 5, 6, 9, 13, 18, 7, 8, 9, 10, 14, 19, 11, 12, 13, 14, 15, 20, &
         16, 17, 18, 19, 20, 21], [6, 6])
      real(wp) :: b(BLOCK, 21)
      integer :: i, l, m, at, p(6), q(6)

      at = n_dof*(n_dof + 1)/2
      b(:n, :at) = a(:n, :at)
      if (n_dof == 3) then
         do l = 1, 3
            p = PLACE(:, l)
            do m = 1, l
               q = PLACE(:, m)
               at = PLACE(l, m)
               !$omp simd
               do i = 1, n
                  a(i, at) = b(i, p(1))*b(i, q(1)) + b(i, p(2))*b(i, q(2)) + b(i, p(3))*b(i, q(3))
               end do
            end do
         end do
         return
      end if
      do l = 1, 6
         p = PLACE(:, l)
         do m = 1, l
            q = PLACE(:, m)
            at = PLACE(l, m)
            !$omp simd
            do i = 1, n
               a(i, at) = b(i, p(1))*b(i, q(1)) + b(i, p(2))*b(i, q(2)) + b(i, p(3))*b(i, q(3)) + &
                  (b(i, p(4))*b(i, q(4)) + b(i, p(5))*b(i, q(5)) + b(i, p(6))*b(i, q(6)))
            end do
         end do
      end do
   end subroutine square

end module kj_consistent_compliance
