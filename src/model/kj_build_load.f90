!> Cards -> model: what acts on nodes: boundary conditions, gravity, concentrated loads, imposed
!> motion, initial velocities.
!> One file: loads, conditions, motions and velocities share sensors and scales.
module kj_build_load
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: sort_unique
   use kj_units, only: dimensions, D_FORCE, D_MOMENT, D_VELOCITY, D_ANGULAR_VELOCITY, D_LENGTH, &
      D_ACCELERATION, D_ANGULAR_ACCELERATION, D_NUMBER, D_TIME
   use kj_keywords, only: KW_BCS, KW_GRAV, KW_CLOAD, KW_IMPVEL, KW_IMPDISP, KW_IMPACC, &
      KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS
   use kj_deck_text, only: deck_t, block_factors, lengthen
   use kj_cards, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_draft, only: draft_t, blocks_of, reference, group_nodes
   use kj_model, only: model_t, bcs_t, load_t, motion_t, IMPOSE_VELOCITY, IMPOSE_DISPLACEMENT, &
      IMPOSE_ACCELERATION, BY_DISPLACEMENT, BY_VELOCITY
   use kj_check_scene, only: warn_of_conflict
   use kj_math3, only: cross
   implicit none
   private

   public :: build_conditions, build_gravity, build_cloads, build_motions, build_velocities, &
      carry_secondaries

   character(len=2), parameter :: DIRECTION(6) = ['X ', 'Y ', 'Z ', 'XX', 'YY', 'ZZ']

contains

   !> /BCS: one entry a lead; conditions on secondary nodes have no effect
   subroutine build_conditions(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      integer, allocatable :: blocks(:), nodes(:), entry_of(:)
      type(bcs_t), allocatable :: bcs(:)
      type(cards_t) :: cards
      logical :: fixed(6)
      integer :: i, k, n, lead, skew

      blocks = blocks_of(draft%deck, KW_BCS)
      allocate (entry_of(model%n_lead), source=0)
      allocate (bcs(model%n_lead))
      n = 0
      do i = 1, size(blocks)
         call read_cards(draft%deck, blocks(i), cards)
         call read_code(draft%deck, cards, fixed)
         skew = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
         call group_nodes(draft, cards, 'KJ-0678', .true., nodes)
         if (size(nodes) > 0 .and. all(draft%new(nodes) > model%n_lead)) call report(draft%deck, &
            cards, 'grnod_id', SEV_WARNING, 'KJ-9154', &
            'a boundary condition on secondary nodes has no effect', 'holds secondary nodes only', &
            hint='secondary nodes follow their body: hold its main node')
         do k = 1, size(nodes)
            lead = draft%new(nodes(k))
            if (lead > model%n_lead) cycle
            if (entry_of(lead) == 0) then
               n = n + 1
               entry_of(lead) = n
               bcs(n)%lead = lead
               bcs(n)%skew = skew
            else if (bcs(entry_of(lead))%skew /= skew) then
               call report(draft%deck, cards, 'skew_id', SEV_ERROR, 'KJ-0148', 'node '// &
                  str(draft%id(nodes(k)))//' has boundary conditions in two skews', 'another skew')
            end if
            bcs(entry_of(lead))%fixed = bcs(entry_of(lead))%fixed .or. fixed
         end do
      end do
      model%bcs = bcs(:n)
   end subroutine build_conditions

   subroutine read_code(deck, cards, fixed)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      logical, intent(out) :: fixed(6)

      character(len=2), parameter :: FIELD(6) = ['Tx', 'Ty', 'Tz', 'Rx', 'Ry', 'Rz']
      integer :: i

      do i = 1, 6
         fixed(i) = int_of(cards, FIELD(i)) == 1
         if (int_of(cards, FIELD(i)) > 1) call report(deck, cards, FIELD(i), SEV_ERROR, 'KJ-1051', &
            'a digit of the condition is neither 0 nor 1', 'expected: 0 or 1')
      end do
   end subroutine read_code

   !> Axis 1-6 that a field names; 1, and a finding, when it names none
   integer function direction_of(deck, cards, id) result(dir)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: id

      dir = findloc(DIRECTION, text_of(cards, 'dir'), 1)
      if (dir == 0) call report(deck, cards, 'dir', SEV_ERROR, id, &
         'the direction is not one of X Y Z XX YY ZZ', 'expected: a direction')
      dir = max(1, dir)
   end function direction_of

   !> Curve, sensor, skew and scales of a load card
   subroutine read_load(draft, cards, curve_id, load)
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft
      character(len=*), intent(in) :: curve_id     !! message id of a missing function
      type(load_t), intent(inout) :: load

      integer :: sensor

      load%curve = reference(draft%deck, cards, 'fct_id', draft%curve, 'function', curve_id)
      load%skew = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137')
      sensor = reference(draft%deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-0521')
      load%sensed = sensor > 0
      if (load%sensed) load%t_start = draft%sensors(sensor)%t_start
      if (load%sensed) load%t_stop = draft%sensors(sensor)%t_stop
      load%x_scale = real_of(cards, 'Ascale')
      if (abs(load%x_scale) <= 0.0_wp) load%x_scale = factor_at(draft%deck, cards%block, D_TIME)
   end subroutine read_load

   !> /GRAV: acts on leads only
   subroutine build_gravity(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      integer, allocatable :: blocks(:), nodes(:)
      type(cards_t) :: cards
      integer :: i, k

      blocks = blocks_of(draft%deck, KW_GRAV)
      allocate (model%gravity(size(blocks)))
      do i = 1, size(blocks)
         associate (load => model%gravity(i))
            call read_cards(draft%deck, blocks(i), cards)
            load%dir = findloc(DIRECTION(:3), text_of(cards, 'dir'), 1)
            if (load%dir == 0) then
               load%dir = 3
               if (is_given(cards, 'dir')) call report(draft%deck, cards, 'dir', SEV_WARNING, &
                  'KJ-9122', 'the direction of gravity is not X, Y or Z: Z is taken', &
                  'expected: X, Y or Z')
            end if
            call read_load(draft, cards, 'KJ-0154', load)
            load%y_scale = real_of(cards, 'Fscale')
            if (abs(load%y_scale) <= 0.0_wp) load%y_scale = factor_at(draft%deck, blocks(i), &
               D_ACCELERATION)
            call group_nodes(draft, cards, 'KJ-0053', .false., nodes)
            load%node = draft%new(nodes)
            if (int_of(cards, 'grnod_id') == 0) load%node = [(k, k=1, model%n_lead)]
            load%node = sort_unique(pack(load%node, load%node <= model%n_lead))
            if (size(nodes) > 0 .and. size(load%node) == 0) call report(draft%deck, cards, &
               'grnod_id', SEV_WARNING, 'KJ-9155', 'gravity on secondary nodes has no effect', &
               'holds secondary nodes only', &
               hint='a body feels gravity where its main node is in the group')
         end associate
      end do
   end subroutine build_gravity

   !> /CLOAD
   subroutine build_cloads(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      integer, allocatable :: blocks(:), nodes(:)
      type(cards_t) :: cards
      integer :: i

      blocks = blocks_of(draft%deck, KW_CLOAD)
      allocate (model%cload(size(blocks)))
      do i = 1, size(blocks)
         associate (load => model%cload(i))
            call read_cards(draft%deck, blocks(i), cards)
            load%id = draft%deck%block(blocks(i))%id
            load%dir = direction_of(draft%deck, cards, 'KJ-0149')
            call read_load(draft, cards, 'KJ-9123', load)
            load%abscissa = max(1, int_of(cards, 'Itypfun'))
            if (load%abscissa > 3 .or. int_of(cards, 'Itypfun') < 0) call report(draft%deck, &
               cards, 'Itypfun', SEV_ERROR, 'KJ-9124', 'the abscissa type is not 0, 1, 2 or 3', &
               'expected: 0 to 3')
            load%y_scale = scale_of(cards)*factor_at(draft%deck, blocks(i), &
               merge(D_FORCE, D_MOMENT, load%dir <= 3))
            call scale_abscissa(draft%deck, cards, draft%legacy, load)
            call group_nodes(draft, cards, 'KJ-0053', .true., nodes)
            load%node = draft%new(nodes)
         end associate
      end do
   end subroutine build_cloads

   !> Ascale of a load over displacement or velocity in its own unit; OpenRadioss, and so the legacy
   !> formulation, takes it for a time
   subroutine scale_abscissa(deck, cards, legacy, load)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      logical, intent(in) :: legacy
      type(load_t), intent(inout) :: load

      integer, parameter :: UNIT_OF(2, 2) = reshape([D_LENGTH, D_NUMBER, D_VELOCITY, &
         D_ANGULAR_VELOCITY], [2, 2])
      real(wp) :: wanted, is

      if (load%abscissa < BY_DISPLACEMENT .or. load%abscissa > BY_VELOCITY) return
      wanted = factor_at(deck, cards%block, UNIT_OF(merge(1, 2, load%dir <= 3), load%abscissa - 1))
      is = factor_at(deck, cards%block, D_TIME)
      if (.not. legacy) load%x_scale = load%x_scale*(wanted/is)
      if (legacy .and. abs(wanted - is) > 4.0_wp*epsilon(is)*is) call report(deck, cards, &
         'Itypfun', SEV_WARNING, 'KJ-9209', &
         'the legacy scheme takes the scale of a displacement or velocity '// &
         'for a time when it converts units', 'not over time', &
         hint='use the same input and work units')
   end subroutine scale_abscissa

   !> Input to work units of one dimension in one block
   pure real(wp) function factor_at(deck, block, dim) result(factor)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, dim         !! index of the block, D_ constant

      real(wp) :: factors(size(dimensions))

      factors = block_factors(deck, block)
      factor = factors(dim)
   end function factor_at

   !> Fscale; 0 means 1
   pure real(wp) function scale_of(cards) result(s)
      type(cards_t), intent(in) :: cards

      s = real_of(cards, 'Fscale')
      if (abs(s) <= 0.0_wp) s = 1.0_wp
   end function scale_of

   !> /IMPVEL, /IMPDISP, /IMPACC: one entry a lead
   subroutine build_motions(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(motion_t), allocatable :: all_motions(:), longer(:)
      type(motion_t) :: motion
      integer, allocatable :: nodes(:), before(:), chain(:)
      integer :: last_of(model%n_lead)           ! last motion of a lead
      type(cards_t) :: cards
      integer :: i, k, n, kind

      allocate (all_motions(16), before(16))     ! before: the motion of the same lead before it
      last_of = 0
      n = 0
      do i = 1, draft%deck%n_block
         select case (draft%deck%block(i)%keyword)
         case (KW_IMPVEL); kind = IMPOSE_VELOCITY
         case (KW_IMPDISP); kind = IMPOSE_DISPLACEMENT
         case (KW_IMPACC); kind = IMPOSE_ACCELERATION
         case default; cycle
         end select
         call read_cards(draft%deck, i, cards)
         call read_motion(draft, i, cards, kind, motion)
         call group_nodes(draft, cards, 'KJ-0053', .true., nodes)
         do k = 1, size(nodes)
            motion%lead = draft%new(nodes(k))
            if (motion%lead > model%n_lead) then
               call report(draft%deck, cards, 'grnod_id', SEV_WARNING, 'KJ-0147', 'node '// &
                  str(draft%id(nodes(k)))// &
                  ' is a secondary node: its imposed motion has no effect', &
                  'holds a secondary node')
               cycle
            end if
            if (n == size(all_motions)) then
               allocate (longer(2*n))
               longer(:n) = all_motions
               call move_alloc(longer, all_motions)
               call lengthen(before)
            end if
            n = n + 1
            all_motions(n) = motion
            before(n) = last_of(motion%lead)
            last_of(motion%lead) = n
            chain = chain_of(n, before)
            call warn_of_conflict(draft, model, cards, draft%id(nodes(k)), motion, &
               all_motions(chain))
         end do
      end do
      model%motion = all_motions(:n)
   end subroutine build_motions

   !> The motions of the same lead before the n-th
   pure function chain_of(n, before) result(list)
      integer, intent(in) :: n, before(:)
      integer, allocatable :: list(:)

      integer :: i

      allocate (list(0))
      i = before(n)
      do while (i > 0)
         list = [list, i]
         i = before(i)
      end do
   end function chain_of

   subroutine read_motion(draft, block, cards, kind, motion)
      integer, intent(in) :: block, kind
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft
      type(motion_t), intent(out) :: motion

      integer, parameter :: UNIT_OF(2, 3) = reshape([D_VELOCITY, D_ANGULAR_VELOCITY, D_LENGTH, &
         D_NUMBER, D_ACCELERATION, D_ANGULAR_ACCELERATION], [2, 3])
      type(load_t) :: load

      motion%kind = kind
      motion%dir = direction_of(draft%deck, cards, 'KJ-0164')
      call read_load(draft, cards, 'KJ-9123', load)
      motion%curve = load%curve
      motion%skew = load%skew
      motion%sensed = load%sensed
      motion%x_scale = load%x_scale
      motion%y_scale = scale_of(cards)*factor_at(draft%deck, block, &
         UNIT_OF(merge(1, 2, motion%dir <= 3), kind))
      motion%t_start = real_of(cards, 'Tstart')
      if (real_of(cards, 'Tstop') > 0.0_wp) motion%t_stop = real_of(cards, 'Tstop')
      if (load%sensed) then
         motion%t_sensor = load%t_start
         motion%t_off = load%t_stop
         motion%t_start = max(motion%t_start, load%t_start)
         motion%t_stop = min(motion%t_stop, load%t_stop)
      end if
      if (kind == IMPOSE_ACCELERATION) return
      if (int_of(cards, 'frame_id') == 0) return
      if (int_of(cards, 'skew_id') /= 0) then
         call report(draft%deck, cards, 'frame_id', SEV_ERROR, 'KJ-0491', &
            'a skew and a frame are given together', 'expected: 0')
      else
         call report(draft%deck, cards, 'frame_id', SEV_ERROR, 'KJ-9125', &
            'imposed motion in a frame is not supported', 'expected: 0')
      end if
   end subroutine read_motion

   !> Initial velocities in deck order, the last one on a node wins; secondary nodes follow their
   !> body
   subroutine build_velocities(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(cards_t) :: cards
      integer, allocatable :: nodes(:)
      integer :: i, keyword

      do i = 1, draft%deck%n_block
         keyword = draft%deck%block(i)%keyword
         if (.not. any(keyword == [KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS])) &
            cycle
         call read_cards(draft%deck, i, cards)
         call refuse_late(draft, cards)
         call group_nodes(draft, cards, 'KJ-0668', .true., nodes)
         nodes = draft%new(nodes)
         if (size(nodes) > 0 .and. all(nodes > model%n_lead)) call report(draft%deck, cards, &
            'grnod_id', SEV_WARNING, 'KJ-9152', &
            'an initial velocity of secondary nodes has no effect', 'holds secondary nodes only', &
            hint='secondary nodes follow their body: give the velocity to its main node')
         if (keyword == KW_INIVEL_AXIS) then
            call set_axis_velocity(draft, cards, nodes, model)
         else
            call set_velocity(draft, cards, keyword, nodes, model)
         end if
      end do
   end subroutine build_velocities

   !> Secondary nodes start with the velocity of their body
   subroutine carry_secondaries(model)
      type(model_t), intent(inout) :: model

      integer :: i, b

      do i = model%n_lead + 1, model%n_node
         b = model%lead(i)
         model%v0(i, :) = model%v0(b, :) + cross(model%w0(b, :), model%x0(i, :) - model%x0(b, :))
      end do
   end subroutine carry_secondaries

   !> Velocities act at the start, and at no other time
   subroutine refuse_late(draft, cards)
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft

      integer :: sensor

      sensor = reference(draft%deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-1252')
      if (sensor > 0) call report(draft%deck, cards, 'sens_id', SEV_ERROR, 'KJ-9117', &
         'initial velocities after a sensor are not supported', 'expected: 0')
      if (real_of(cards, 'Tstart') > 0.0_wp) call report(draft%deck, cards, 'Tstart', SEV_ERROR, &
         'KJ-9117', 'initial velocities after the start are not supported', 'expected: 0')
   end subroutine refuse_late

   !> /INIVEL/TRA, T+G and ROT
   subroutine set_velocity(draft, cards, keyword, nodes, model)
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: keyword
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: nodes(:)            !! model indices
      type(model_t), intent(inout) :: model

      real(wp) :: v(3)
      integer :: k, skew

      v = [real_of(cards, 'Vx'), real_of(cards, 'Vy'), real_of(cards, 'Vz')]
      skew = reference(draft%deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0184')
      v = matmul(reshape(draft%skews%axes(skew, :), [3, 3]), v)
      do k = 1, size(nodes)
         if (keyword /= KW_INIVEL_ROT) then
            model%v0(nodes(k), :) = v
         else if (nodes(k) <= model%n_lead) then
            model%w0(nodes(k), :) = v
         end if
      end do
   end subroutine set_velocity

   !> /INIVEL/AXIS: v = Vt + Vr axis x (x - O), w = Vr axis, at the place of a main node after it
   !> moved
   subroutine set_axis_velocity(draft, cards, nodes, model)
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: nodes(:)            !! model indices
      type(model_t), intent(inout) :: model

      real(wp) :: a(3, 3), origin(3), w(3), v(3)
      integer :: dir, frame, k

      dir = findloc(DIRECTION(:3), text_of(cards, 'dir'), 1)
      if (dir == 0) call report(draft%deck, cards, 'dir', SEV_ERROR, 'KJ-0933', &
         'the axis is not X, Y or Z', 'expected: X, Y or Z')
      frame = reference(draft%deck, cards, 'frame_id', draft%frame, 'frame', 'KJ-0490')
      if (dir == 0) return
      a = reshape(draft%frames%axes(frame, :), [3, 3])
      origin = draft%frame_origin(frame, :)
      w = real_of(cards, 'Vr')*a(:, dir)
      v = matmul(a, [real_of(cards, 'Vxt'), real_of(cards, 'Vyt'), real_of(cards, 'Vzt')])
      do k = 1, size(nodes)
         model%v0(nodes(k), :) = v + cross(w, model%x0(nodes(k), :) - origin)
         if (nodes(k) <= model%n_lead) model%w0(nodes(k), :) = w
      end do
   end subroutine set_axis_velocity

end module kj_build_load
