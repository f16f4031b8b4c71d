!> Channel + state -> numbers: one row of a history at t(n), between the two halves of a cycle.
module kj_sample
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INTERNAL
   use kj_math3, only: cross, to_quaternion, turn_between
   use kj_curve, only: curve_integral
   use kj_joint_types, only: joint_types, NDOF, FRAME_CROSS
   use kj_joint_batch, only: joint_batch_t, SPRING8, LAW_SPRING_CURVE, DOF_FREE, DOF_BLOCKED
   use kj_joint_stop, only: has_limits
   use kj_model, only: model_t
   use kj_state, only: state_t, OWNER_JOINT
   use kj_load, only: gravity_at
   use kj_energy, only: balance_t, balance_of, energy_error
   use kj_sample_node, only: node_value
   use kj_history, only: history_t, variable_t, add_variable
   use kj_channels, only: channels, CH_TIME, CH_CYCLE, CH_TIME_STEP, CH_KE_TRANS, CH_KE_ROT, &
      CH_IE, CH_WORK, CH_POTENTIAL, CH_ENERGY_ERROR, CH_MOM_X, CH_MOM_Y, CH_MOM_Z, CH_ANG_X, &
      CH_ANG_Y, CH_ANG_Z, CH_MASS, CH_OWNER_KIND, CH_OWNER, CH_FINAL, CH_J_FORCE, CH_J_MOMENT, &
      CH_J_DISP, CH_J_ROT, CH_J_VEL, CH_J_ANGVEL, CH_J_IE, CH_J_ELASTIC, CH_J_DISSIPATED, &
      CH_J_LENGTH, CH_J_VIOL_T, CH_J_VIOL_R, CH_J_FRAME, CH_J_ORTHO, CH_J_STATE, CH_J_FRICTION, &
      CH_J_GAP, CH_J_GAP_ROT, CH_B_POS, CH_B_VEL, CH_B_ANGVEL, CH_B_ACC, CH_B_ANGACC, CH_B_FORCE, &
      CH_B_MOMENT, CH_B_IMPULSE, CH_B_ANGIMP, CH_B_ROTSUM, CH_B_ORIENT, CH_B_KE, &
      CH_S_FORCE, CH_S_MOMENT, &
      CH_S_DISP, CH_S_ROT, CH_S_IE, OF_RUN, OF_JOINT, OF_BODY, OF_NODE, OF_SPRING
   implicit none
   private

   public :: sampler_t, new_sampler, sample_row

   !> What sampling keeps between rows
   type :: sampler_t
      real(wp), allocatable :: orientation(:, :)   !! (4, n_body) last quaternions, for their sign
      real(wp), allocatable :: gravity(:, :)       !! (n_lead, 3) acceleration at the sample
      type(balance_t) :: balance                   !! of the last row
      real(wp) :: energy_error = 0.0_wp            !! of the last row
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
      allocate (sampler%orientation(4, model%n_body), source=0.0_wp)
      sampler%orientation(1, :) = 1.0_wp
      allocate (sampler%gravity(model%n_lead, 3), source=0.0_wp)
   end subroutine new_sampler

   !> A spring of the history has laws of rotation
   pure logical function any_moments(model)
      type(model_t), intent(in) :: model

      any_moments = any(model%batch(model%joint(model%th_spring)%batch)%kind == SPRING8)
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
   subroutine sample_row(model, state, history, final, sampler, row, error)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(history_t), intent(in) :: history
      logical, intent(in) :: final               !! a last state that is no regular sample
      type(sampler_t), intent(inout) :: sampler
      real(wp), intent(out) :: row(:)            !! (history%n_value)
      type(error_t), allocatable, intent(out) :: error

      integer :: i, k

      sampler%balance = balance_of(model, state)
      sampler%energy_error = state%ledger_error
      if (state%staggered) sampler%energy_error = energy_error(state, sampler%balance)
      sampler%gravity = 0.0_wp
      do i = 1, size(model%gravity)
         if (.not. state%staggered) exit         ! the consistent f_own holds gravity
         do k = 1, size(model%gravity(i)%node)
            associate (lead => model%gravity(i)%node(k))
               sampler%gravity(lead, :) = sampler%gravity(lead, :) + &
                  gravity_at(model, state, model%gravity(i), state%time)
            end associate
         end do
      end do
      do i = 1, size(history%variable)
         associate (v => history%variable(i))
            associate (values => row(v%first:v%first + v%n_entity*v%n_comp - 1))
               select case (channels(v%channel)%owner)
               case (OF_RUN)
                  values = run_value(model, state, sampler, v%channel, final)
               case (OF_JOINT)
                  do k = 1, v%n_entity
                     values((k - 1)*v%n_comp + 1:k*v%n_comp) = joint_value(model, state, v, k)
                  end do
               case (OF_BODY)
                  do k = 1, v%n_entity
                     call body_value(model, state, v, model%th_body(k), sampler, &
                        values((k - 1)*v%n_comp + 1:k*v%n_comp))
                  end do
               case (OF_SPRING)
                  do k = 1, v%n_entity
                     values((k - 1)*v%n_comp + 1:k*v%n_comp) = spring_value(model, state, v, k)
                  end do
               case (OF_NODE)
                  do k = 1, v%n_entity
                     values((k - 1)*v%n_comp + 1:k*v%n_comp) = node_value(model, state, v, k)
                  end do
               case default
                  call fail(error, ERR_INTERNAL, 'no owner for channel row '//str(v%channel))
                  return
               end select
            end associate
         end associate
      end do
   end subroutine sample_row

   real(wp) function run_value(model, state, sampler, channel, final) result(y)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(sampler_t), intent(in) :: sampler
      integer, intent(in) :: channel
      logical, intent(in) :: final

      y = 0.0_wp
      associate (b => sampler%balance)
         select case (channel)
         case (CH_TIME); y = state%time
         case (CH_CYCLE); y = real(state%cycle, wp)
         case (CH_TIME_STEP); y = state%h2
         case (CH_KE_TRANS); y = b%kinetic_trans
         case (CH_KE_ROT); y = b%kinetic_rot
         case (CH_IE); y = b%internal
         case (CH_WORK); y = state%work
         case (CH_POTENTIAL); y = b%potential
         case (CH_ENERGY_ERROR); y = sampler%energy_error
         case (CH_MOM_X, CH_MOM_Y, CH_MOM_Z); y = b%momentum(channel - CH_MOM_X + 1)
         case (CH_ANG_X, CH_ANG_Y, CH_ANG_Z); y = b%angular_momentum(channel - CH_ANG_X + 1)
         case (CH_MASS); y = b%mass
         case (CH_OWNER_KIND); y = real(state%owner_kind, wp)
         case (CH_OWNER); if (state%owner_kind > 0) y = real(owner_id(model, state), wp)
         case (CH_FINAL); y = merge(1.0_wp, 0.0_wp, final)
         end select
      end associate
   end function run_value

   !> User id of the body, node or joint that limits the step
   pure integer function owner_id(model, state) result(id)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state

      if (state%owner_kind == OWNER_JOINT) then
         id = model%joint(state%owner)%id
      else if (state%owner <= model%n_body) then
         id = model%body_id(state%owner)
      else
         id = model%node_id(state%owner)
      end if
   end function owner_id

   !> Value of a joint channel; k counts the joints of the history
   function joint_value(model, state, v, k) result(y)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(variable_t), intent(in) :: v
      integer, intent(in) :: k
      real(wp) :: y(v%n_comp)

      integer :: j

      y = 0.0_wp
      associate (ref => model%joint(model%th_joint(k)))
         j = ref%place
         associate (s => state%joint(ref%batch), free => joint_types(ref%row)%free)
            select case (v%channel)
            case (CH_J_FORCE); y = s%f(j, 1:3)
            case (CH_J_MOMENT); y = s%f(j, 4:6)
            case (CH_J_DISP); y = s%q(j, 1:3)
            case (CH_J_ROT); y = s%q(j, 4:6)
            case (CH_J_VEL); y = s%qdot(j, 1:3)
            case (CH_J_ANGVEL); y = s%qdot(j, 4:6)
            case (CH_J_IE); y = s%energy(j)
            case (CH_J_ELASTIC); y = elastic_energy(model, state, ref%batch, j)
            case (CH_J_DISSIPATED); y = s%energy(j) - elastic_energy(model, state, ref%batch, j)
            case (CH_J_LENGTH)
               y = norm2(state%world%x(ref%node(2), :) - state%world%x(ref%node(1), :))
            case (CH_J_VIOL_T); y = norm2(pack(s%q(j, 1:3), free(1:3) == 0))
            case (CH_J_VIOL_R); y = norm2(pack(s%q(j, 4:6), free(4:6) == 0))
            case (CH_J_FRAME); y = frame_quaternion(s%e(j, :), model%batch(ref%batch)%frame)
            case (CH_J_ORTHO)
               if (allocated(state%ortho)) then
                  y = state%ortho(model%batch(ref%batch)%first + j)
                  return
               end if
               y = maxval(abs(asin([dot_product(s%e(j, 1:3), s%e(j, 4:6)), &
                  dot_product(s%e(j, 4:6), s%e(j, 7:9)), dot_product(s%e(j, 7:9), s%e(j, 1:3))])))
            case (CH_J_STATE)
               y = merge(real(DOF_FREE, wp), real(DOF_BLOCKED, wp), free == 1)
               if (allocated(s%flag)) y = real(s%flag(j, :), wp)
            case (CH_J_FRICTION); if (allocated(s%slip_energy)) y = s%slip_energy(j)
            case (CH_J_GAP, CH_J_GAP_ROT)
               y = gaps(model%batch(ref%batch), state%staggered, j, s%q(j, :), &
                  merge(1, 4, v%channel == CH_J_GAP))
            end select
         end associate
      end associate
   end function joint_value

   !> Value of a spring channel; k counts the springs of the history
   function spring_value(model, state, v, k) result(y)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(variable_t), intent(in) :: v
      integer, intent(in) :: k
      real(wp) :: y(v%n_comp)

      y = 0.0_wp
      associate (ref => model%joint(model%th_spring(k)))
         associate (s => state%joint(ref%batch), i => ref%place)
            select case (v%channel)
            case (CH_S_FORCE); y = s%f(i, 1:3)
            case (CH_S_MOMENT); y = s%f(i, 4:6)
            case (CH_S_DISP); y = s%q(i, 1:3)
            case (CH_S_ROT); y = s%q(i, 4:6)
            case (CH_S_IE); y = s%energy(i)
            end select
         end associate
      end associate
   end function spring_value

   !> How far three directions are from their nearest stop; negative beyond it. Combined stops have
   !> one radius, the least of theirs, but each its own under legacy.
   pure function gaps(batch, legacy, j, q, first) result(gap)
      type(joint_batch_t), intent(in) :: batch
      logical, intent(in) :: legacy
      integer, intent(in) :: j, first            !! joint of the batch; 1 or 4
      real(wp), intent(in) :: q(NDOF)
      real(wp) :: gap(3)

      real(wp), dimension(3) :: lo, hi, x
      logical :: combined(3)

      gap = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. batch%limited) return
      lo = batch%limit%lo(j, first:first + 2)
      hi = batch%limit%hi(j, first:first + 2)
      x = q(first:first + 2)
      combined = batch%limit%combined(j, first:first + 2) > 0.0_wp
      where (hi > 0.0_wp) gap = hi - x
      where (lo < 0.0_wp) gap = merge(min(gap, x - lo), x - lo, hi > 0.0_wp)
      if (.not. any(combined)) return
      where (combined) gap = 0.5_wp*(hi - lo) - norm2(pack(x - 0.5_wp*(lo + hi), combined))
      if (.not. legacy) where (combined) gap = minval(gap, mask=combined)
   end function gaps

   !> Energy stored in the elastic laws of a joint: k q^2/2, or the integral of its curve; with
   !> stops, friction and lock
   pure real(wp) function elastic_energy(model, state, batch, j) result(u)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      integer, intent(in) :: batch, j

      real(wp) :: k
      integer :: dof

      u = 0.0_wp
      if (model%batch(batch)%limited) u = state%joint(batch)%stored(j)
      associate (b => model%batch(batch), q => state%joint(batch)%q)
         do dof = 1, 6
            if (iand(b%law(dof), LAW_SPRING_CURVE) /= 0) then
               u = u + b%k(j, dof)*curve_integral(model%curves, b%k_curve(j, dof), 0.0_wp, &
                  q(j, dof))
            else
               k = b%k(j, dof)
               if (b%limited .and. joint_types(b%row)%free(dof) == 0) &
                  k = state%joint(batch)%k_block(j, merge(1, 2, dof <= 3))
               u = u + 0.5_wp*k*q(j, dof)**2
            end if
         end do
      end associate
   end function elastic_energy

   !> World from joint frame; a universal frame (e1, e2, e3) gives that of (e1, e2, e1 x e2)
   pure function frame_quaternion(e, frame) result(q)
      real(wp), intent(in) :: e(9)
      integer, intent(in) :: frame
      real(wp) :: q(4)

      real(wp) :: r(3, 3)

      r = reshape(e, [3, 3])
      if (frame == FRAME_CROSS) r(:, 3) = cross(e(1:3), e(4:6))
      q = to_quaternion(r)
   end function frame_quaternion

   subroutine body_value(model, state, v, body, sampler, y)
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(variable_t), intent(in) :: v
      integer, intent(in) :: body
      type(sampler_t), intent(inout) :: sampler
      real(wp), intent(out) :: y(v%n_comp)

      real(wp) :: vh(3), w(3), wl(3)
      integer :: k

      y = 0.0_wp
      select case (v%channel)
      case (CH_B_POS); y = state%world%x(body, :)
      case (CH_B_VEL); y = state%v(body, :)
      case (CH_B_ANGVEL); y = state%world%w(body, :)
      case (CH_B_ACC); y = state%a(body, :)
      case (CH_B_ANGACC); y = state%al(body, :)
      case (CH_B_FORCE)
         y = state%f(body, :) + state%f_own(body, :) + state%mass(body)*sampler%gravity(body, :)
      case (CH_B_MOMENT); y = state%m(body, :) + state%m_own(body, :)
      case (CH_B_IMPULSE); y = state%impulse(body, :)
      case (CH_B_ANGIMP); y = state%angular_impulse(body, :)
      case (CH_B_ROTSUM); y = state%rotation_sum(body, :)
      case (CH_B_ORIENT)
         y = to_quaternion(turn_between(model%axes(body, :), state%p(body, :)))
         if (dot_product(y, sampler%orientation(:, body)) < 0.0_wp) y = -y
         sampler%orientation(:, body) = y
      case (CH_B_KE)
         vh = state%v(body, :) + 0.5_wp*state%h1*state%a(body, :)
         w = state%world%w(body, :) + 0.5_wp*state%h1*state%al(body, :)
         wl = [(dot_product(w, state%p(body, k:k + 2)), k=1, 7, 3)]
         y = 0.5_wp*(state%mass(body)*dot_product(vh, vh) + sum(state%principal(body, :)*wl**2))
      end select
   end subroutine body_value

end module kj_sample
