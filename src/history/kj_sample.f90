!> Channel + snapshot -> numbers: one row of a history.
module kj_sample
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INTERNAL
   use kj_joint_batch, only: SPRING4, has_limits
   use kj_model, only: model_t
   use kj_snapshot, only: snapshot_t
   use kj_take, only: roster_t, new_roster, new_rosters
   use kj_sample_joint, only: sample_joints
   use kj_sample_body, only: sample_bodies
   use kj_history, only: history_t, add_variable
   use kj_channels, only: channels, CH_TIME, CH_CYCLE, CH_TIME_STEP, CH_KE_TRANS, CH_KE_ROT, &
      CH_IE, CH_WORK, CH_POTENTIAL, CH_ENERGY_ERROR, CH_MOM_X, CH_MOM_Y, CH_MOM_Z, CH_ANG_X, &
      CH_ANG_Y, CH_ANG_Z, CH_MASS, CH_OWNER_KIND, CH_OWNER, CH_FINAL, CH_J_STATE, CH_J_GAP_ROT, &
      CH_S_MOMENT, CH_S_ROT, CH_N_POS, CH_N_DISP, CH_N_VEL, CH_N_ANGVEL, CH_N_ACC, CH_N_ANGACC, &
      OF_RUN, OF_JOINT, OF_BODY, OF_NODE, OF_SPRING
   implicit none
   private

   public :: sampler_t, new_sampler, sample_row

   !> What sampling keeps between rows
   type :: sampler_t
      type(roster_t), allocatable :: joint(:), spring(:)     !! one a batch
      type(roster_t) :: body
      real(wp), allocatable :: orientation(:, :)   !! (4, n_body) last quaternions, for their sign
   end type sampler_t

contains

   !> Every channel of the table becomes a variable for the entities that the deck asks for
   subroutine new_sampler(model, history, sampler)
      type(model_t), intent(in) :: model
      type(history_t), intent(inout) :: history
      type(sampler_t), intent(out) :: sampler

      integer :: row, n(5)

      n(OF_RUN) = 1
      n(OF_JOINT) = size(model%th_joint)
      n(OF_BODY) = size(model%th_body)
      n(OF_NODE) = size(model%th_node)
      n(OF_SPRING) = size(model%th_spring)
      do row = 1, size(channels)
         if (row >= CH_J_STATE .and. row <= CH_J_GAP_ROT .and. .not. any_limits(model)) cycle
         if (any(row == [CH_S_MOMENT, CH_S_ROT]) .and. .not. any_moments(model)) cycle
         if (n(channels(row)%owner) > 0) call add_variable(history, row, n(channels(row)%owner))
      end do
      call new_rosters(model, model%th_joint, sampler%joint)
      call new_rosters(model, model%th_spring, sampler%spring)
      call new_roster(model%th_body, sampler%body)
      allocate (sampler%orientation(4, model%n_body), source=0.0_wp)
      sampler%orientation(1, :) = 1.0_wp
   end subroutine new_sampler

   !> A spring of the history has laws of rotation
   pure logical function any_moments(model)
      type(model_t), intent(in) :: model

      any_moments = any(model%batch(model%joint(model%th_spring)%batch)%kind /= SPRING4)
   end function any_moments

   !> A joint of the history has stops, friction or a lock
   pure logical function any_limits(model)
      type(model_t), intent(in) :: model

      integer :: k

      any_limits = .false.
      do k = 1, size(model%th_joint)
         associate (ref => model%joint(model%th_joint(k)))
            if (.not. model%batch(ref%batch)%limited) cycle
            any_limits = any_limits .or. has_limits(model%batch(ref%batch)%limit, ref%place)
         end associate
      end do
   end function any_limits

   !> Fill one row of a history
   subroutine sample_row(model, now, history, final, sampler, row, error)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      type(history_t), intent(in) :: history
      logical, intent(in) :: final               !! a last state that is no regular sample
      type(sampler_t), intent(inout) :: sampler
      real(wp), contiguous, intent(out) :: row(:)    !! (history%n_value)
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      do i = 1, size(history%variable)
         associate (v => history%variable(i))
            call sample_variable(model, now, v%channel, final, v%n_comp, v%n_entity, sampler, &
               row(v%first:v%first + v%n_comp*v%n_entity - 1), error)
         end associate
         if (allocated(error)) return
      end do
   end subroutine sample_row

   !> Fill what a row has of one variable
   subroutine sample_variable(model, now, channel, final, n_comp, n_entity, sampler, y, error)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel, n_comp, n_entity
      logical, intent(in) :: final
      type(sampler_t), intent(inout) :: sampler
      real(wp), intent(out) :: y(n_comp, n_entity)
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      select case (channels(channel)%owner)
      case (OF_RUN)
         y = run_value(now, channel, final)
      case (OF_JOINT)
         do i = 1, size(sampler%joint)
            call sample_joints(model, now, channel, sampler%joint(i), y)
         end do
      case (OF_SPRING)
         do i = 1, size(sampler%spring)
            call sample_joints(model, now, channel, sampler%spring(i), y)
         end do
      case (OF_BODY)
         call sample_bodies(model, now, channel, sampler%body, sampler%orientation, y)
      case (OF_NODE)
         call sample_nodes(now, channel, y)
      case default
         call fail(error, ERR_INTERNAL, 'no owner for channel row '//str(channel))
      end select
   end subroutine sample_variable

   !> Value of a channel of the whole scene
   pure real(wp) function run_value(now, channel, final) result(y)
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel
      logical, intent(in) :: final

      y = 0.0_wp
      associate (b => now%balance)
         select case (channel)
         case (CH_TIME); y = now%time
         case (CH_CYCLE); y = real(now%cycle, wp)
         case (CH_TIME_STEP); y = now%step
         case (CH_KE_TRANS); y = b%kinetic_trans
         case (CH_KE_ROT); y = b%kinetic_rot
         case (CH_IE); y = b%internal
         case (CH_WORK); y = now%work
         case (CH_POTENTIAL); y = b%potential
         case (CH_ENERGY_ERROR); y = now%energy_error
         case (CH_MOM_X, CH_MOM_Y, CH_MOM_Z); y = b%momentum(channel - CH_MOM_X + 1)
         case (CH_ANG_X, CH_ANG_Y, CH_ANG_Z); y = b%angular_momentum(channel - CH_ANG_X + 1)
         case (CH_MASS); y = b%mass
         case (CH_OWNER_KIND); y = real(now%owner_kind, wp)
         case (CH_OWNER); y = real(now%owner, wp)
         case (CH_FINAL); y = merge(1.0_wp, 0.0_wp, final)
         end select
      end associate
   end function run_value

   !> A channel of the nodes of the history
   pure subroutine sample_nodes(now, channel, y)
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel
      real(wp), intent(inout) :: y(:, :)         !! (3, nodes of the history)

      select case (channel)
      case (CH_N_POS); y = now%node_x
      case (CH_N_DISP); y = now%node_d
      case (CH_N_VEL); y = now%node_v
      case (CH_N_ANGVEL); y = now%node_w
      case (CH_N_ACC); y = now%node_a
      case (CH_N_ANGACC); y = now%node_al
      end select
   end subroutine sample_nodes

end module kj_sample
