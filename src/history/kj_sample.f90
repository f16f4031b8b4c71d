!> Channel + snapshot -> numbers: one row of a history.
!> One file: each channel is a case
module kj_sample
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INTERNAL
   use kj_joint_batch, only: SPRING4, has_limits, joint_batch_t, LAW_SPRING_CURVE, DOF_FREE, &
      DOF_BLOCKED
   use kj_model, only: model_t
   use kj_snapshot, only: snapshot_t, shown_joints_t
   use kj_history, only: history_t, add_variable
   use kj_channels, only: channels, CH_TIME, CH_CYCLE, CH_TIME_STEP, CH_KE_TRANS, CH_KE_ROT, &
      CH_IE, CH_WORK, CH_POTENTIAL, CH_ENERGY_ERROR, CH_MOM_X, CH_MOM_Y, CH_MOM_Z, CH_ANG_X, &
      CH_ANG_Y, CH_ANG_Z, CH_MASS, CH_OWNER_KIND, CH_OWNER, CH_FINAL, CH_J_STATE, CH_J_GAP_ROT, &
      CH_S_MOMENT, CH_S_ROT, CH_N_POS, CH_N_DISP, CH_N_VEL, CH_N_ANGVEL, CH_N_ACC, CH_N_ANGACC, &
      OF_RUN, OF_JOINT, OF_BODY, OF_NODE, OF_SPRING, CH_B_POS, CH_B_VEL, CH_B_ANGVEL, CH_B_ACC, &
      CH_B_ANGACC, CH_B_FORCE, CH_B_MOMENT, CH_B_IMPULSE, CH_B_ANGIMP, CH_B_ROTSUM, CH_B_ORIENT, &
      CH_B_KE, CH_J_POS, CH_J_FORCE, CH_J_MOMENT, CH_J_DISP, CH_J_ROT, CH_J_VEL, CH_J_ANGVEL, &
      CH_J_IE, CH_J_ELASTIC, CH_J_DISSIPATED, CH_J_LENGTH, CH_J_VIOL_T, CH_J_VIOL_R, CH_J_FRAME, &
      CH_J_ORTHO, CH_J_FRICTION, CH_J_GAP, CH_S_FORCE, CH_S_DISP, CH_S_IE, CH_S_LENGTH
   use kj_math3, only: to_quaternions
   use kj_block, only: BLOCK
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_curve, only: curve_integral
   use kj_joint_types, only: joint_types, NDOF, FRAME_CROSS
   implicit none
   private

   public :: sampler_t, new_sampler, sample_row

   !> Entities of a history whose values stand in the same arrays
   type :: roster_t
      integer :: batch = 0                       !! of joints and springs
      integer :: row = 0                         !! of kj_joint_types, of joints and springs
      integer, allocatable :: place(:)           !! in the arrays of the state
      integer, allocatable :: entity(:)          !! in the history
   end type roster_t

   !> Fill what a variable has of the entities of a roster, from columns or from one
   interface take
      module procedure take_columns, take_column
   end interface take

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

   !> A channel of the bodies of a roster
   subroutine sample_bodies(model, now, channel, roster, last, y)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel
      type(roster_t), intent(in) :: roster
      real(wp), intent(inout) :: last(:, :)      !! (4, n_body) the quaternions of the row before
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, bodies of the history)

      select case (channel)
      case (CH_B_POS); call take(now%x, roster, y)
      case (CH_B_VEL); call take(now%v, roster, y)
      case (CH_B_ANGVEL); call take(now%w, roster, y)
      case (CH_B_ACC); call take(now%a, roster, y)
      case (CH_B_ANGACC); call take(now%al, roster, y)
      case (CH_B_FORCE); call take(now%f, roster, y)
      case (CH_B_MOMENT); call take(now%m, roster, y)
      case (CH_B_IMPULSE); call take(now%impulse, roster, y)
      case (CH_B_ANGIMP); call take(now%angular_impulse, roster, y)
      case (CH_B_ROTSUM); call take(now%rotation_sum, roster, y)
      case (CH_B_ORIENT); call orientations(model, now, roster, last, y)
      case (CH_B_KE); call kinetic_energies(now, roster, y)
      end select
   end subroutine sample_bodies

   !> Rotations from the pose at the start; a quaternion has the sign that is nearer to the last one
   pure subroutine orientations(model, now, roster, last, y)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      type(roster_t), intent(in) :: roster
      real(wp), intent(inout) :: last(:, :)
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp), dimension(min(BLOCK, size(roster%place)), 9) :: from, to, r
      real(wp) :: q(size(r, 1), 4)
      integer :: i, k, n, first

      do first = 1, size(roster%place), BLOCK
         n = min(BLOCK, size(roster%place) - first + 1)
         associate (body => roster%place(first:first + n - 1), entity => roster%entity(first:))
            call take_block(model%axes, body, from)
            call take_block(now%p, body, to)
            do k = 1, 3
               do i = 1, 3
                  r(:, 3*(k - 1) + i) = to(:, i)*from(:, k) + to(:, i + 3)*from(:, k + 3) + &
                     to(:, i + 6)*from(:, k + 6)
               end do
            end do
            call to_quaternions(size(r, 1), r, q)
            do i = 1, n
               associate (quat => last(:, body(i)))
                  quat = sign(1.0_wp, dot_product(q(i, :), quat))*q(i, :)
                  y(:, entity(i)) = quat
               end associate
            end do
         end associate
      end do
   end subroutine orientations

   pure subroutine kinetic_energies(now, roster, y)
      type(snapshot_t), intent(in) :: now
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: v(3), w(3), spin2
      integer :: i, k, body

      do i = 1, size(roster%place)
         body = roster%place(i)
         do k = 1, 3
            v(k) = now%v(body, k) + now%lag*now%a(body, k)
            w(k) = now%w(body, k) + now%lag*now%al(body, k)
         end do
         spin2 = 0.0_wp
         do k = 1, 3
            spin2 = spin2 + now%principal(body, k)*(w(1)*now%p(body, 3*k - 2) + &
               w(2)*now%p(body, 3*k - 1) + w(3)*now%p(body, 3*k))**2
         end do
         y(1, roster%entity(i)) = 0.5_wp*(now%mass(body)*(v(1)**2 + v(2)**2 + v(3)**2) + spin2)
      end do
   end subroutine kinetic_energies

   !> A channel of the joints or springs of a roster
   subroutine sample_joints(model, now, channel, roster, y)
      type(model_t), intent(in) :: model
      type(snapshot_t), intent(in) :: now
      integer, intent(in) :: channel
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, entities of the history)

      associate (b => model%batch(roster%batch), s => now%joint(roster%batch))
         select case (channel)
         case (CH_J_POS); call take(s%x, roster, y)
         case (CH_J_FORCE, CH_S_FORCE); call take(s%f(:, 1:3), roster, y)
         case (CH_J_MOMENT, CH_S_MOMENT); call take(s%f(:, 4:6), roster, y)
         case (CH_J_DISP, CH_S_DISP); call take(s%q(:, 1:3), roster, y)
         case (CH_J_ROT, CH_S_ROT); call take(s%q(:, 4:6), roster, y)
         case (CH_J_VEL); call take(s%rate(:, 1:3), roster, y)
         case (CH_J_ANGVEL); call take(s%rate(:, 4:6), roster, y)
         case (CH_J_IE, CH_S_IE); call take(s%energy, roster, y)
         case (CH_J_ELASTIC, CH_J_DISSIPATED)
            if (now%counts_losses) then
               y(1, roster%entity) = s%energy(roster%place) - s%dissipated(roster%place)
            else
               call elastic_energies(model, b, s, roster, y)
            end if
            if (channel == CH_J_DISSIPATED) &
               y(1, roster%entity) = s%energy(roster%place) - y(1, roster%entity)
         case (CH_J_LENGTH, CH_S_LENGTH); call take(s%length, roster, y)
         case (CH_J_VIOL_T); call violations(joint_types(b%row)%free(1:3), s%q(:, 1:3), roster, y)
         case (CH_J_VIOL_R); call violations(joint_types(b%row)%free(4:6), s%q(:, 4:6), roster, y)
         case (CH_J_FRAME); call frames(s%e, b%frame, roster, y)
         case (CH_J_ORTHO); call take(s%ortho, roster, y)
         case (CH_J_STATE); call states(joint_types(b%row)%free, s, roster, y)
         case (CH_J_FRICTION)
            if (allocated(s%slip_energy)) then
               call take(s%slip_energy, roster, y)
            else
               y(:, roster%entity) = 0.0_wp
            end if
         case (CH_J_GAP); call gaps_of(b, now%stops_alone, s%q, 1, roster, y)
         case (CH_J_GAP_ROT); call gaps_of(b, now%stops_alone, s%q, 4, roster, y)
         end select
      end associate
   end subroutine sample_joints

   !> Energy stored in the elastic laws of a joint: k q^2/2, or the integral of its curve; with
   !> stops, friction and lock
   pure subroutine elastic_energies(model, b, s, roster, y)
      type(model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: b
      type(shown_joints_t), intent(in) :: s
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: u(size(roster%place))
      integer :: dof, i, j, part

      u = 0.0_wp
      if (b%limited) u = s%stored(roster%place)
      do dof = 1, NDOF
         if (iand(b%law(dof), LAW_SPRING_CURVE) /= 0) then
            do i = 1, size(u)
               j = roster%place(i)
               u(i) = u(i) + b%k(j, dof)*curve_integral(model%curves, b%k_curve(j, dof), 0.0_wp, &
                  s%q(j, dof))
            end do
         else if (b%limited .and. joint_types(b%row)%free(dof) == 0) then
            part = merge(1, 2, dof <= 3)
            do i = 1, size(u)
               j = roster%place(i)
               u(i) = u(i) + 0.5_wp*s%k_block(j, part)*s%q(j, dof)**2
            end do
         else
            do i = 1, size(u)
               j = roster%place(i)
               u(i) = u(i) + 0.5_wp*b%k(j, dof)*s%q(j, dof)**2
            end do
         end if
      end do
      y(1, roster%entity) = u
   end subroutine elastic_energies

   !> Norm of the displacements, or of the rotations, that are blocked
   pure subroutine violations(free, q, roster, y)
      integer, intent(in) :: free(3)             !! 1 where a direction is
      real(wp), contiguous, intent(in) :: q(:, :)        !! (n, 3)
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      integer :: i

      do i = 1, size(roster%place)
         associate (j => roster%place(i))
            y(1, roster%entity(i)) = sqrt((1 - free(1))*q(j, 1)**2 + (1 - free(2))*q(j, 2)**2 + &
               (1 - free(3))*q(j, 3)**2)
         end associate
      end do
   end subroutine violations

   !> Quaternion, world from joint frame; a universal frame (e1, e2, e3) gives that of
   !> (e1, e2, e1 x e2)
   pure subroutine frames(e, frame, roster, y)
      real(wp), contiguous, intent(in) :: e(:, :)        !! (n, 9)
      integer, intent(in) :: frame               !! FRAME_ constant
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: r(min(BLOCK, size(roster%place)), 9), q(size(r, 1), 4)
      integer :: i, n, first

      do first = 1, size(roster%place), BLOCK
         n = min(BLOCK, size(roster%place) - first + 1)
         call take_block(e, roster%place(first:first + n - 1), r)
         if (frame == FRAME_CROSS) then
            r(:, 7) = r(:, 2)*r(:, 6) - r(:, 3)*r(:, 5)
            r(:, 8) = r(:, 3)*r(:, 4) - r(:, 1)*r(:, 6)
            r(:, 9) = r(:, 1)*r(:, 5) - r(:, 2)*r(:, 4)
         end if
         call to_quaternions(size(r, 1), r, q)
         do i = 1, n
            y(:, roster%entity(first + i - 1)) = q(i, :)
         end do
      end do
   end subroutine frames

   !> What each direction does: DOF_ constants
   pure subroutine states(free, s, roster, y)
      integer, intent(in) :: free(NDOF)
      type(shown_joints_t), intent(in) :: s
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      integer :: i

      do i = 1, size(roster%place)
         y(:, roster%entity(i)) = merge(real(DOF_FREE, wp), real(DOF_BLOCKED, wp), free == 1)
         if (allocated(s%flag)) y(:, roster%entity(i)) = real(s%flag(roster%place(i), :), wp)
      end do
   end subroutine states

   pure subroutine gaps_of(b, alone, q, first, roster, y)
      type(joint_batch_t), intent(in) :: b
      logical, intent(in) :: alone
      real(wp), contiguous, intent(in) :: q(:, :)        !! (n, 6)
      integer, intent(in) :: first               !! 1 or 4
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)

      real(wp) :: x(3)
      integer :: i

      do i = 1, size(roster%place)
         x = q(roster%place(i), first:first + 2)
         y(:, roster%entity(i)) = gaps(b, alone, roster%place(i), x, first)
      end do
   end subroutine gaps_of

   !> How far three directions are from their nearest stop; negative beyond it. Combined stops have
   !> one radius, the least of theirs, or each its own (alone).
   pure function gaps(batch, alone, j, x, first) result(gap)
      type(joint_batch_t), intent(in) :: batch
      logical, intent(in) :: alone
      integer, intent(in) :: j, first            !! joint of the batch; 1 or 4
      real(wp), intent(in) :: x(3)
      real(wp) :: gap(3)

      real(wp), dimension(3) :: lo, hi
      logical :: combined(3)

      gap = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. batch%limited) return
      lo = batch%limit%lo(j, first:first + 2)
      hi = batch%limit%hi(j, first:first + 2)
      combined = batch%limit%combined(j, first:first + 2) > 0.0_wp
      where (hi > 0.0_wp) gap = hi - x
      where (lo < 0.0_wp) gap = merge(min(gap, x - lo), x - lo, hi > 0.0_wp)
      if (.not. any(combined)) return
      where (combined) gap = 0.5_wp*(hi - lo) - norm2(pack(x - 0.5_wp*(lo + hi), combined))
      if (.not. alone) where (combined) gap = minval(gap, mask=combined)
   end function gaps

   !> The entities of a history in their order
   pure subroutine new_roster(place, roster)
      integer, intent(in) :: place(:)
      type(roster_t), intent(out) :: roster

      integer :: k

      roster%place = place
      roster%entity = [(k, k=1, size(place))]
   end subroutine new_roster

   !> Joints or springs of a history by batches
   pure subroutine new_rosters(model, joint, roster)
      type(model_t), intent(in) :: model
      integer, intent(in) :: joint(:)            !! the elements of the history
      type(roster_t), allocatable, intent(out) :: roster(:)

      integer :: b, k, n
      integer :: of(size(model%batch)), place(size(joint)), batch(size(joint)), filled(size(joint))

      batch = model%joint(joint)%batch
      place = model%joint(joint)%place
      of = 0
      n = 0
      do k = 1, size(joint)
         of(batch(k)) = of(batch(k)) + 1
         if (of(batch(k)) == 1) n = n + 1
      end do
      allocate (roster(n))
      n = 0
      do b = 1, size(of)
         if (of(b) == 0) cycle
         n = n + 1
         allocate (roster(n)%place(of(b)), roster(n)%entity(of(b)))
         roster(n)%batch = b
         roster(n)%row = model%batch(b)%row
         of(b) = n
      end do
      filled = 0
      do k = 1, size(joint)
         associate (r => roster(of(batch(k))), i => filled(of(batch(k))))
            i = i + 1
            r%place(i) = place(k)
            r%entity(i) = k
         end associate
      end do
   end subroutine new_rosters

   pure subroutine take_columns(from, roster, y)
      real(wp), contiguous, intent(in) :: from(:, :)     !! (places, components)
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, entities)

      integer :: c, i

      if (size(y, 1) == 3) then
         do i = 1, size(roster%place)
            associate (j => roster%place(i), k => roster%entity(i))
               y(1, k) = from(j, 1)
               y(2, k) = from(j, 2)
               y(3, k) = from(j, 3)
            end associate
         end do
         return
      end if
      do c = 1, size(y, 1)
         do i = 1, size(roster%place)
            y(c, roster%entity(i)) = from(roster%place(i), c)
         end do
      end do
   end subroutine take_columns

   pure subroutine take_column(from, roster, y)
      real(wp), contiguous, intent(in) :: from(:)        !! (places)
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (1, entities)

      integer :: i

      do i = 1, size(roster%place)
         y(1, roster%entity(i)) = from(roster%place(i))
      end do
   end subroutine take_column

   !> Columns of some places, to work on them together; the rest of the block stays
   pure subroutine take_block(from, place, block)
      real(wp), contiguous, intent(in) :: from(:, :)     !! (places, components)
      integer, contiguous, intent(in) :: place(:)
      real(wp), contiguous, intent(inout) :: block(:, :)    !! (places at a time, components)

      integer :: c, i

      do c = 1, size(block, 2)
         do i = 1, size(place)
            block(i, c) = from(place(i), c)
         end do
      end do
   end subroutine take_block

end module kj_sample
