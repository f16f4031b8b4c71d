!> The arrays that a cycle goes through, on huge pages: a kernel reads blocks of 64 from a hundred
!> columns, so that in large scenes nearly each of them lies on a page of its own, more than a
!> processor knows the places of. A list for speed alone: what is not in it works as well.
module kj_pages
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_size_t
   use kj_team, only: LARGE
   use kj_joint_batch, only: joint_batch_t, joint_state_t
   use kj_c_batch, only: c_batch_t, c_joint_t
   use kj_model, only: model_t
   use kj_state, only: state_t
   use kj_c_state, only: c_model_t, c_state_t
   implicit none
   private

   public :: place_state, place_c_state

   interface
      !> Ask for huge pages below n numbers; nothing happens where there are none
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
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: s

      integer :: b

      if (model%n_joint + model%n_lead < LARGE) return
      do b = 1, size(model%batch)
         call place_batch(model%batch(b), s%joint(b))
      end do
      call huge_reals(s%world%x, size(s%world%x, kind=c_size_t))
      call huge_reals(s%world%w, size(s%world%w, kind=c_size_t))
      call huge_reals(s%v, size(s%v, kind=c_size_t))
      call huge_reals(s%a, size(s%a, kind=c_size_t))
      call huge_reals(s%al, size(s%al, kind=c_size_t))
      call huge_reals(s%f, size(s%f, kind=c_size_t))
      call huge_reals(s%m, size(s%m, kind=c_size_t))
      call huge_reals(s%kn, size(s%kn, kind=c_size_t))
      call huge_reals(s%kr, size(s%kr, kind=c_size_t))
      call huge_reals(s%mass, size(s%mass, kind=c_size_t))
      call huge_reals(s%inertia, size(s%inertia, kind=c_size_t))
      call huge_reals(s%p, size(s%p, kind=c_size_t))
      call huge_reals(s%principal, size(s%principal, kind=c_size_t))
      call huge_reals(s%impulse, size(s%impulse, kind=c_size_t))
      call huge_reals(s%angular_impulse, size(s%angular_impulse, kind=c_size_t))
      call huge_reals(s%rotation_sum, size(s%rotation_sum, kind=c_size_t))
   end subroutine place_state

   subroutine place_batch(b, s)
      type(joint_batch_t), intent(in) :: b
      type(joint_state_t), intent(in) :: s

      call huge_integers(b%node, size(b%node, kind=c_size_t))
      call huge_integers(b%lead, size(b%lead, kind=c_size_t))
      call huge_reals(b%xl0, size(b%xl0, kind=c_size_t))
      call huge_reals(b%k, size(b%k, kind=c_size_t))
      call huge_reals(b%c, size(b%c, kind=c_size_t))
      call huge_reals(s%e, size(s%e, kind=c_size_t))
      call huge_reals(s%q, size(s%q, kind=c_size_t))
      call huge_reals(s%f, size(s%f, kind=c_size_t))
      call huge_reals(s%qdot, size(s%qdot, kind=c_size_t))
      call huge_reals(s%energy, size(s%energy, kind=c_size_t))
      call huge_reals(s%stiff, size(s%stiff, kind=c_size_t))
   end subroutine place_batch

   !> Those of the consistent cycle
   subroutine place_c_state(model, c, s)
      type(model_t), intent(in) :: model
      type(c_model_t), intent(in) :: c
      type(c_state_t), intent(in) :: s

      integer :: b

      if (model%n_joint + model%n_lead < LARGE) return
      do b = 1, size(c%batch)
         call place_c_batch(c%batch(b), s%joint(b))
      end do
      associate (p => s%poses)
         call huge_reals(p%x, size(p%x, kind=c_size_t))
         call huge_reals(p%quat, size(p%quat, kind=c_size_t))
         call huge_reals(p%v, size(p%v, kind=c_size_t))
         call huge_reals(p%w, size(p%w, kind=c_size_t))
         call huge_reals(p%d, size(p%d, kind=c_size_t))
      end associate
      call huge_reals(c%im, size(c%im, kind=c_size_t))
      call huge_reals(c%i, size(c%i, kind=c_size_t))
      call huge_reals(c%ii, size(c%ii, kind=c_size_t))
      call huge_reals(s%v, size(s%v, kind=c_size_t))
      call huge_reals(s%l, size(s%l, kind=c_size_t))
      call huge_reals(s%f, size(s%f, kind=c_size_t))
      call huge_reals(s%t, size(s%t, kind=c_size_t))
      call huge_reals(s%own_f, size(s%own_f, kind=c_size_t))
      call huge_reals(s%own_t, size(s%own_t, kind=c_size_t))
      call huge_reals(s%impulse, size(s%impulse, kind=c_size_t))
      call huge_reals(s%angular_impulse, size(s%angular_impulse, kind=c_size_t))
      call huge_reals(s%turn, size(s%turn, kind=c_size_t))
      call huge_reals(s%wrench, size(s%wrench, kind=c_size_t))
   end subroutine place_c_state

   subroutine place_c_batch(b, s)
      type(c_batch_t), intent(in) :: b
      type(c_joint_t), intent(in) :: s

      call huge_integers(b%lead, size(b%lead, kind=c_size_t))
      call huge_reals(b%arm, size(b%arm, kind=c_size_t))
      call huge_reals(b%triad, size(b%triad, kind=c_size_t))
      call huge_reals(b%xl0, size(b%xl0, kind=c_size_t))
      call huge_reals(b%k, size(b%k, kind=c_size_t))
      call huge_reals(b%c, size(b%c, kind=c_size_t))
      call huge_reals(s%q, size(s%q, kind=c_size_t))
      call huge_reals(s%fe, size(s%fe, kind=c_size_t))
      call huge_reals(s%fd, size(s%fd, kind=c_size_t))
      call huge_reals(s%elastic, size(s%elastic, kind=c_size_t))
      call huge_reals(s%dissipated, size(s%dissipated, kind=c_size_t))
      call huge_reals(s%b, size(s%b, kind=c_size_t))
      call huge_reals(s%qd, size(s%qd, kind=c_size_t))
   end subroutine place_c_batch

end module kj_pages
