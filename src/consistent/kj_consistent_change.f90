!> What a host may change between the steps of a consistent scene. What a change does to the energy
!> is external work, but a new force acts from now on: it does none yet.
module kj_consistent_change
   use kj_kinds, only: wp
   use kj_math3, only: quaternion_product
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_body, only: columns
   use kj_consistent_build, only: settle
   use kj_consistent_march, only: march_t, start_march, balance_ledger
   implicit none
   private

   public :: put_load, put_velocity, put_pose

contains

   !> Force and moment of the host on a body. The force now there changes, too, so that the first
   !> half kick has it; not the ledger.
   subroutine put_load(model, b, force, moment, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b                   !! index of the body
      real(wp), intent(in) :: force(3), moment(3)    !! W
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: more(3), turn(3), before

      associate (s => state, n => model%n_lead)
         if (.not. allocated(s%f_host)) allocate (s%f_host(n, 3), s%t_host(n, 3), &
            s%f_host_old(n, 3), s%t_host_old(n, 3), source=0.0_wp)
         call balance_ledger(model, s)
         before = s%error*s%scale
         more = force - s%f_host(b, :)
         turn = moment - s%t_host(b, :)
         s%f(b, :) = s%f(b, :) + more
         s%own_f(b, :) = s%own_f(b, :) + more
         s%t(b, :) = s%t(b, :) + turn
         s%own_t(b, :) = s%own_t(b, :) + turn
         s%f_host(b, :) = force
         s%t_host(b, :) = moment
         s%f_host_old(b, :) = force
         s%t_host_old(b, :) = moment
         call balance_ledger(model, s)
         s%offset = s%offset - (s%error*s%scale - before)
      end associate
   end subroutine put_load

   !> Velocities of a body
   subroutine put_velocity(model, b, velocity, omega, state, march)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b
      real(wp), intent(in) :: velocity(3), omega(3)  !! W
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      real(wp) :: p(3, 3)

      p = reshape(columns(state%poses%quat(b, :)), [3, 3])
      state%v(b, :) = velocity
      state%l(b, :) = matmul(p, model%spin_inertia(b, :)*matmul(omega, p))
      call start_anew(model, state, march)
   end subroutine put_velocity

   !> Place of a body and its turn since the start
   subroutine put_pose(model, b, position, attitude, state, march)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: b
      real(wp), intent(in) :: position(3), attitude(4)   !! W; a quaternion of any length but 0
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      real(wp) :: q(4)

      q = quaternion_product(attitude, model%quat0(b, :))
      associate (p => state%poses)
         p%d(b, :) = position - model%x0(b, :)
         p%x(b, :) = position
         p%quat(b, :) = q/norm2(q)
      end associate
      call start_anew(model, state, march)
   end subroutine put_pose

   !> Forces after a change
   subroutine start_anew(model, state, march)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      real(wp) :: before, scale

      associate (s => state)
         call balance_ledger(model, s)
         before = s%error*s%scale
         s%poses%psi = 0.0_wp
         call settle(model, s)
         call balance_ledger(model, s)
         scale = s%scale
         s%work = s%work + s%error*scale - before
         call start_march(model, s, march)
      end associate
   end subroutine start_anew

end module kj_consistent_change
