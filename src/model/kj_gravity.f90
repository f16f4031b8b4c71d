!> Gravity on many leads, block by block: the stages of a cycle add it while the leads are cached,
!> in threads too. Blocks are the same for any number of threads, and so are the bits of the work.
module kj_gravity
   use kj_kinds, only: wp
   use kj_archive, only: archive_t, keep
   use kj_block, only: BLOCK
   implicit none
   private

   public :: gravity_t, new_gravity, keep_gravity, add_accelerations, add_weights, add_powers

   !> One card of gravity
   type :: gravity_t
      integer, allocatable :: lead(:)            !! where it acts, ascending
      !> (0:blocks of BLOCK leads) entries up to the end of each block
      integer, allocatable :: to(:)
      real(wp) :: now(3) = 0.0_wp                !! acceleration at t(n), W
      real(wp) :: mean(3) = 0.0_wp               !! over the step that led there
      real(wp), allocatable :: power(:)          !! (blocks) of the mean acceleration
      !> (entries, 3) acceleration of each lead, where it is not the same for all
      real(wp), allocatable :: each(:, :)
   end type gravity_t

contains

   !> A card that acts on these leads
   pure subroutine new_gravity(lead, n_lead, self)
      integer, intent(in) :: lead(:)             !! ascending
      integer, intent(in) :: n_lead              !! of the scene
      type(gravity_t), intent(out) :: self

      integer :: i, b, n_block

      n_block = (n_lead + BLOCK - 1)/BLOCK
      self%lead = lead
      allocate (self%to(0:n_block), source=0)
      allocate (self%power(n_block), source=0.0_wp)
      do i = 1, size(lead)
         b = (lead(i) - 1)/BLOCK + 1
         self%to(b) = self%to(b) + 1
      end do
      do b = 1, n_block
         self%to(b) = self%to(b) + self%to(b - 1)
      end do
   end subroutine new_gravity

   !> a += g for the leads among lo..hi, and the power; lo is the first lead of a block
   pure subroutine add_accelerations(lo, hi, n_lead, n_node, mass, v, self, a)
      integer, intent(in) :: lo, hi, n_lead, n_node
      real(wp), intent(in) :: mass(n_lead), v(n_node, 3)
      type(gravity_t), intent(inout) :: self
      real(wp), intent(inout) :: a(n_lead, 3)

      integer :: i, k

      do k = self%to((lo - 1)/BLOCK) + 1, self%to((hi + BLOCK - 1)/BLOCK)
         i = self%lead(k)
         a(i, 1) = a(i, 1) + self%now(1)
         a(i, 2) = a(i, 2) + self%now(2)
         a(i, 3) = a(i, 3) + self%now(3)
      end do
      call add_powers(lo, hi, n_lead, n_node, mass, v, self)
   end subroutine add_accelerations

   !> f += m g and own += m g for the leads among lo..hi; lo is the first lead of a block
   pure subroutine add_weights(lo, hi, n_lead, mass, self, f, own)
      integer, intent(in) :: lo, hi, n_lead
      real(wp), intent(in) :: mass(n_lead)
      type(gravity_t), intent(in) :: self
      real(wp), intent(inout) :: f(n_lead, 3), own(n_lead, 3)

      real(wp) :: g(3)
      integer :: i, j, k

      g = self%now
      do k = self%to((lo - 1)/BLOCK) + 1, self%to((hi + BLOCK - 1)/BLOCK)
         i = self%lead(k)
         if (allocated(self%each)) g = self%each(k, :)
         do j = 1, 3
            f(i, j) = f(i, j) + mass(i)*g(j)
            own(i, j) = own(i, j) + mass(i)*g(j)
         end do
      end do
   end subroutine add_weights

   !> Power of the mean acceleration on each block of the leads lo..hi
   pure subroutine add_powers(lo, hi, n_lead, n_row, mass, v, self)
      integer, intent(in) :: lo, hi, n_lead, n_row
      real(wp), intent(in) :: mass(n_lead), v(n_row, 3)
      type(gravity_t), intent(inout) :: self

      real(wp) :: power
      integer :: b, i, k

      do b = (lo - 1)/BLOCK + 1, (hi + BLOCK - 1)/BLOCK
         power = 0.0_wp
         do k = self%to(b - 1) + 1, self%to(b)
            i = self%lead(k)
            power = power + mass(i)*(self%mean(1)*v(i, 1) + self%mean(2)*v(i, 2) + &
               self%mean(3)*v(i, 3))
         end do
         self%power(b) = power
      end do
   end subroutine add_powers

   !> Save or restore a card
   subroutine keep_gravity(archive, self)
      type(archive_t), intent(inout) :: archive
      type(gravity_t), intent(inout) :: self

      integer :: i

      call keep(archive, self%lead)
      call keep(archive, self%to)
      do i = 1, 3
         call keep(archive, self%now(i))
         call keep(archive, self%mean(i))
      end do
      call keep(archive, self%power)
   end subroutine keep_gravity

end module kj_gravity
