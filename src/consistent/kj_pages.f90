!> The arrays that a cycle goes through, on huge pages: a kernel reads blocks of 64 from a hundred
!> columns, so that in large scenes nearly each of them lies on a page of its own, more than a
!> processor knows the places of. A list for speed alone: what is not in it works as well.
module kj_pages
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_size_t
   use kj_team, only: LARGE
   use kj_joint_batch, only: joint_batch_t, joint_state_t
   use kj_legacy_state, only: legacy_state_t
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   implicit none
   private

   public :: place_state, place_consistent_state

   !> Ask for huge pages below an array; nothing happens where there are none
   interface use_huge
      module procedure huge_column, huge_columns, huge_indices
   end interface use_huge

   interface
      subroutine huge_reals(array, n) bind(c, name='kj_huge_reals')
         import :: c_double, c_size_t
         real(c_double), intent(in) :: array(*)
         integer(c_size_t), value, intent(in) :: n
      end subroutine huge_reals

      subroutine huge_integers(array, n) bind(c, name='kj_huge_integers')
         import :: c_int, c_size_t
         integer(c_int), intent(in) :: array(*)
         integer(c_size_t), value, intent(in) :: n
      end subroutine huge_integers
   end interface

contains

   !> Those of the legacy cycle; the consistent formulation samples from them
   subroutine place_state(model, s)
      type(consistent_model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: s

      integer :: b

      if (model%n_joint + model%n_lead < LARGE) return
      do b = 1, size(model%batch)
         call place_batch(model%batch(b), s%joint(b))
      end do
      call use_huge(s%world%x)
      call use_huge(s%world%w)
      call use_huge(s%v)
      call use_huge(s%a)
      call use_huge(s%al)
      call use_huge(s%f)
      call use_huge(s%m)
      call use_huge(s%kn)
      call use_huge(s%kr)
      call use_huge(s%mass)
      call use_huge(s%inertia)
      call use_huge(s%p)
      call use_huge(s%principal)
      call use_huge(s%impulse)
      call use_huge(s%angular_impulse)
      call use_huge(s%rotation_sum)
   end subroutine place_state

   subroutine place_batch(b, s)
      type(joint_batch_t), intent(in) :: b
      type(joint_state_t), intent(in) :: s

      call use_huge(b%node)
      call use_huge(b%lead)
      call use_huge(b%xl0)
      call use_huge(b%k)
      call use_huge(b%c)
      call use_huge(s%e)
      call use_huge(s%q)
      call use_huge(s%f)
      call use_huge(s%qdot)
      call use_huge(s%energy)
      call use_huge(s%stiff)
   end subroutine place_batch

   !> Those of the consistent cycle
   subroutine place_consistent_state(model, s)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(in) :: s

      integer :: b

      if (model%n_joint + model%n_lead < LARGE) return
      do b = 1, size(model%batch)
         call place_consistent_batch(model%batch(b))
      end do
      associate (p => s%poses)
         call use_huge(p%x)
         call use_huge(p%quat)
         call use_huge(p%v)
         call use_huge(p%w)
         call use_huge(p%d)
      end associate
      call use_huge(model%inverse_mass)
      call use_huge(model%spin_inertia)
      call use_huge(model%inverse_inertia)
      call use_huge(s%v)
      call use_huge(s%l)
      call use_huge(s%f)
      call use_huge(s%t)
      call use_huge(s%own_f)
      call use_huge(s%own_t)
      call use_huge(s%impulse)
      call use_huge(s%angular_impulse)
      call use_huge(s%turn)
      call use_huge(s%wrench)
   end subroutine place_consistent_state

   subroutine place_consistent_batch(b)
      type(joint_batch_t), intent(in) :: b

      call use_huge(b%lead)
      call use_huge(b%geometry%arm)
      call use_huge(b%geometry%triad)
      call use_huge(b%xl0)
      call use_huge(b%k)
      call use_huge(b%c)
   end subroutine place_consistent_batch

   subroutine huge_column(array)
      real(c_double), contiguous, intent(in) :: array(:)

      call huge_reals(array, size(array, kind=c_size_t))
   end subroutine huge_column

   subroutine huge_columns(array)
      real(c_double), contiguous, intent(in) :: array(:, :)

      call huge_reals(array, size(array, kind=c_size_t))
   end subroutine huge_columns

   subroutine huge_indices(array)
      integer(c_int), contiguous, intent(in) :: array(:, :)

      call huge_integers(array, size(array, kind=c_size_t))
   end subroutine huge_indices

end module kj_pages
