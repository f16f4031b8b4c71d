!> The stiffness that a joint asks of the nodal time step, damping included: the one rule of both
!> formulations. Source: docs/theory/legacy.md 7.2.
module kj_nodal_stiffness
   use kj_kinds, only: wp
   use kj_joint_batch, only: joint_batch_t
   implicit none
   private

   public :: step_stiffness, start_stiffness

contains

   !> Stiffness that the nodal time step sees, damping included.
   !>
   !>   C = max(cr sqrt(k m), c),   s = (C + sqrt(C^2 + k m))^2 / m;   s = k where m vanishes
   !> Source: docs/theory/legacy.md 7.2.
   pure subroutine step_stiffness(n, k_top, c_top, cr, m, s)
      integer, intent(in) :: n
      real(wp), intent(in) :: k_top(n), c_top(n)
      real(wp), intent(in) :: cr(n)            !! twice the damping ratio
      real(wp), intent(in) :: m(n)             !! reduced mass or inertia
      real(wp), intent(out) :: s(n)

      real(wp) :: c
      integer :: i

      do i = 1, n
         s(i) = k_top(i)
         if (m(i) <= 1.0e-15_wp) cycle
         c = max(cr(i)*sqrt(k_top(i)*m(i)), c_top(i))
         s(i) = (c + sqrt(c**2 + k_top(i)*m(i)))**2/m(i)
      end do
   end subroutine step_stiffness

   !> Time-step stiffness of joints whose laws are linear; constant over the run
   pure subroutine start_stiffness(batch, stiff)
      type(joint_batch_t), intent(in) :: batch
      real(wp), intent(out) :: stiff(:, :)       !! (n, 2) translation and rotation

      integer :: s

      do s = 1, 2
         call step_stiffness(batch%n, batch%k_top(:, s), batch%c_top(:, s), batch%cr, &
            batch%reduced(:, s), stiff(:, s))
      end do
   end subroutine start_stiffness

end module kj_nodal_stiffness
