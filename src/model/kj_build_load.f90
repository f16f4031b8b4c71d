!> Cards -> model: boundary conditions, gravity, concentrated loads, imposed motion.
module kj_build_load
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: sort_unique
   use kj_units, only: dimensions, D_FORCE, D_MOMENT, D_VELOCITY, D_ANGULAR_VELOCITY, D_LENGTH, &
      D_ACCELERATION, D_ANGULAR_ACCELERATION, D_NUMBER, D_TIME
   use kj_keywords, only: KW_BCS, KW_GRAV, KW_CLOAD, KW_IMPVEL, KW_IMPDISP, KW_IMPACC
   use kj_deck_text, only: deck_t, block_factors
   use kj_cards, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_draft, only: draft_t, blocks_of, reference, group_nodes
   use kj_model, only: model_t, bcs_t, load_t, motion_t, IMPOSE_VELOCITY, IMPOSE_DISPLACEMENT, &
      IMPOSE_ACCELERATION, BY_DISPLACEMENT, BY_VELOCITY
   implicit none
   private

   public :: build_conditions, build_gravity, build_cloads, build_motions

   character(len=2), parameter :: DIRECTION(6) = ['X ', 'Y ', 'Z ', 'XX', 'YY', 'ZZ']

contains

   !> /BCS: one entry a lead; conditions on secondary nodes have no effect
   subroutine build_conditions(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:), nodes(:), entry_of(:)
      type(bcs_t), allocatable :: bcs(:), longer(:)
      type(cards_t) :: cards
      logical :: fixed(6)
      integer :: i, k, n, lead, skew

      blocks = blocks_of(deck, KW_BCS)
      allocate (entry_of(model%n_lead), source=0)
      allocate (bcs(64))
      n = 0
      do i = 1, size(blocks)
         call read_cards(deck, blocks(i), cards, findings)
         call read_code(deck, cards, fixed, findings)
         skew = reference(deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137', findings)
         call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0678', .true., findings, nodes)
         if (size(nodes) > 0 .and. all(draft%new(nodes) > model%n_lead)) call report(deck, cards, &
            'grnod_id', SEV_WARNING, 'KJ-9154', &
            'a boundary condition on secondary nodes has no effect', &
            'holds secondary nodes only', findings, &
            hint='secondary nodes follow their body: hold its main node')
         do k = 1, size(nodes)
            lead = draft%new(nodes(k))
            if (lead > model%n_lead) cycle
            if (entry_of(lead) == 0) then
               if (n == size(bcs)) then
                  allocate (longer(2*n))
                  longer(:n) = bcs
                  call move_alloc(longer, bcs)
               end if
               n = n + 1
               entry_of(lead) = n
               bcs(n)%lead = lead
               bcs(n)%skew = skew
            else if (bcs(entry_of(lead))%skew /= skew) then
               call report(deck, cards, 'skew_id', SEV_ERROR, 'KJ-0148', 'node '// &
                  str(draft%id(nodes(k)))//' has boundary conditions in two skews', &
                  'another skew', findings)
            end if
            bcs(entry_of(lead))%fixed = bcs(entry_of(lead))%fixed .or. fixed
         end do
      end do
      model%bcs = bcs(:n)
   end subroutine build_conditions

   subroutine read_code(deck, cards, fixed, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      logical, intent(out) :: fixed(6)
      type(finding_list_t), intent(inout) :: findings

      character(len=2), parameter :: FIELD(6) = ['Tx', 'Ty', 'Tz', 'Rx', 'Ry', 'Rz']
      integer :: i

      do i = 1, 6
         fixed(i) = int_of(cards, FIELD(i)) == 1
         if (int_of(cards, FIELD(i)) > 1) call report(deck, cards, FIELD(i), SEV_ERROR, 'KJ-1051', &
            'a digit of the condition is neither 0 nor 1', 'expected: 0 or 1', findings)
      end do
   end subroutine read_code

   !> Axis 1-6 that a field names, 0 (reported) when it names none of the first `most`
   integer function direction_of(deck, cards, most, id, findings) result(dir)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: most
      character(len=*), intent(in) :: id
      type(finding_list_t), intent(inout) :: findings

      do dir = 1, most
         if (DIRECTION(dir) == text_of(cards, 'dir')) return
      end do
      call report(deck, cards, 'dir', SEV_ERROR, id, 'the direction is not one of X Y Z XX YY ZZ', &
         'expected: a direction', findings)
      dir = 0
   end function direction_of

   !> Curve, sensor, skew and scales of a load card
   subroutine read_load(deck, cards, draft, curve_id, load, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      character(len=*), intent(in) :: curve_id     !! message id of a missing function
      type(load_t), intent(inout) :: load
      type(finding_list_t), intent(inout) :: findings

      integer :: sensor

      load%curve = reference(deck, cards, 'fct_id', draft%curve, 'function', curve_id, findings)
      load%skew = reference(deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0137', findings)
      sensor = reference(deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-0521', findings)
      load%sensed = sensor > 0
      if (load%sensed) load%t_start = draft%sensors(sensor)%t_start
      if (load%sensed) load%t_stop = draft%sensors(sensor)%t_stop
      load%x_scale = real_of(cards, 'Ascale')
      if (abs(load%x_scale) <= 0.0_wp) load%x_scale = factor_at(deck, cards%block, D_TIME)
   end subroutine read_load

   !> /GRAV: acts on leads only
   subroutine build_gravity(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:), nodes(:)
      type(cards_t) :: cards
      integer :: i, k

      blocks = blocks_of(deck, KW_GRAV)
      allocate (model%gravity(size(blocks)))
      do i = 1, size(blocks)
         associate (load => model%gravity(i))
            call read_cards(deck, blocks(i), cards, findings)
            load%dir = max(1, index('XYZ', text_of(cards, 'dir')))
            if (len(text_of(cards, 'dir')) /= 1 .or. index('XYZ', text_of(cards, 'dir')) == 0) then
               load%dir = 3
               if (is_given(cards, 'dir')) call report(deck, cards, 'dir', SEV_WARNING, 'KJ-9122', &
                  'the direction of gravity is not X, Y or Z: Z is taken', 'expected: X, Y or Z', &
                  findings)
            end if
            call read_load(deck, cards, draft, 'KJ-0154', load, findings)
            load%y_scale = real_of(cards, 'Fscale')
            if (abs(load%y_scale) <= 0.0_wp) load%y_scale = factor_at(deck, blocks(i), &
               D_ACCELERATION)
            call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0053', .false., findings, nodes)
            load%node = draft%new(nodes)
            if (int_of(cards, 'grnod_id') == 0) load%node = [(k, k=1, model%n_lead)]
            load%node = sort_unique(pack(load%node, load%node <= model%n_lead))
            if (size(nodes) > 0 .and. size(load%node) == 0) call report(deck, cards, 'grnod_id', &
               SEV_WARNING, 'KJ-9155', 'gravity on secondary nodes has no effect', &
               'holds secondary nodes only', findings, &
               hint='a body feels gravity where its main node is in the group')
         end associate
      end do
   end subroutine build_gravity

   !> /CLOAD
   subroutine build_cloads(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      integer, allocatable :: blocks(:), nodes(:)
      type(cards_t) :: cards
      integer :: i

      blocks = blocks_of(deck, KW_CLOAD)
      allocate (model%cload(size(blocks)))
      do i = 1, size(blocks)
         associate (load => model%cload(i))
            call read_cards(deck, blocks(i), cards, findings)
            load%id = deck%block(blocks(i))%id
            load%dir = max(1, direction_of(deck, cards, 6, 'KJ-0149', findings))
            call read_load(deck, cards, draft, 'KJ-9123', load, findings)
            load%abscissa = max(1, int_of(cards, 'Itypfun'))
            if (load%abscissa > 3 .or. int_of(cards, 'Itypfun') < 0) call report(deck, cards, &
               'Itypfun', SEV_ERROR, 'KJ-9124', &
               'the abscissa type is not 0, 1, 2 or 3', 'expected: 0 to 3', findings)
            load%y_scale = scale_of(cards, 'Fscale')* &
               factor_at(deck, blocks(i), merge(D_FORCE, D_MOMENT, load%dir <= 3))
            call scale_abscissa(deck, cards, draft%legacy, load, findings)
            call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0053', .true., findings, nodes)
            load%node = draft%new(nodes)
         end associate
      end do
   end subroutine build_cloads

   !> Ascale of a load over displacement or velocity in its own unit; OpenRadioss, and so the legacy
   !> formulation, takes it for a time
   subroutine scale_abscissa(deck, cards, legacy, load, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      logical, intent(in) :: legacy
      type(load_t), intent(inout) :: load
      type(finding_list_t), intent(inout) :: findings

      integer, parameter :: UNIT_OF(2, 2) = reshape([D_LENGTH, D_NUMBER, D_VELOCITY, &
         D_ANGULAR_VELOCITY], [2, 2])
      real(wp) :: wanted, is

      if (load%abscissa < BY_DISPLACEMENT .or. load%abscissa > BY_VELOCITY) return
      wanted = factor_at(deck, cards%block, UNIT_OF(merge(1, 2, load%dir <= 3), load%abscissa - 1))
      is = factor_at(deck, cards%block, D_TIME)
      if (.not. legacy) load%x_scale = load%x_scale*(wanted/is)
      if (legacy .and. abs(wanted - is) > 4.0_wp*epsilon(is)*is) call report(deck, cards, &
         'Itypfun', &
         SEV_WARNING, 'KJ-9209', &
         'the legacy scheme takes the scale of a displacement or velocity '// &
         'for a time when it converts units', 'not over time', findings, &
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

   !> A scale; 0 means 1
   pure real(wp) function scale_of(cards, name) result(s)
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name

      s = real_of(cards, name)
      if (abs(s) <= 0.0_wp) s = 1.0_wp
   end function scale_of

   !> /IMPVEL, /IMPDISP, /IMPACC: one entry a lead
   subroutine build_motions(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(motion_t), allocatable :: all_motions(:), longer(:)
      type(motion_t) :: motion
      integer, allocatable :: nodes(:)
      type(cards_t) :: cards
      integer :: i, k, n, kind

      allocate (all_motions(16))
      n = 0
      do i = 1, deck%n_block
         select case (deck%block(i)%keyword)
         case (KW_IMPVEL); kind = IMPOSE_VELOCITY
         case (KW_IMPDISP); kind = IMPOSE_DISPLACEMENT
         case (KW_IMPACC); kind = IMPOSE_ACCELERATION
         case default; cycle
         end select
         call read_cards(deck, i, cards, findings)
         call read_motion(deck, i, cards, draft, kind, motion, findings)
         call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0053', .true., findings, nodes)
         do k = 1, size(nodes)
            motion%lead = draft%new(nodes(k))
            if (motion%lead > model%n_lead) then
               call report(deck, cards, 'grnod_id', SEV_WARNING, 'KJ-0147', 'node '// &
                  str(draft%id(nodes(k)))// &
                  ' is a secondary node: its imposed motion has no effect', &
                  'holds a secondary node', findings)
               cycle
            end if
            if (n == size(all_motions)) then
               allocate (longer(2*n))
               longer(:n) = all_motions
               call move_alloc(longer, all_motions)
            end if
            n = n + 1
            all_motions(n) = motion
         end do
      end do
      model%motion = all_motions(:n)
   end subroutine build_motions

   subroutine read_motion(deck, block, cards, draft, kind, motion, findings)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, kind
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(motion_t), intent(out) :: motion
      type(finding_list_t), intent(inout) :: findings

      integer, parameter :: UNIT_OF(2, 3) = reshape([D_VELOCITY, D_ANGULAR_VELOCITY, D_LENGTH, &
         D_NUMBER, &
         D_ACCELERATION, D_ANGULAR_ACCELERATION], [2, 3])
      type(load_t) :: load

      motion%kind = kind
      motion%dir = max(1, direction_of(deck, cards, 6, 'KJ-0164', findings))
      call read_load(deck, cards, draft, 'KJ-9123', load, findings)
      motion%curve = load%curve
      motion%skew = load%skew
      motion%sensed = load%sensed
      motion%x_scale = load%x_scale
      motion%y_scale = scale_of(cards, 'Fscale')*factor_at(deck, block, UNIT_OF(merge(1, 2, &
         motion%dir <= 3), kind))
      motion%t_start = real_of(cards, 'Tstart')
      if (real_of(cards, 'Tstop') > 0.0_wp) motion%t_stop = real_of(cards, 'Tstop')
      if (load%sensed) then
         motion%t_sensor = load%t_start
         motion%t_start = max(motion%t_start, load%t_start)
         motion%t_stop = min(motion%t_stop, load%t_stop)
      end if
      if (kind == IMPOSE_ACCELERATION) return
      if (int_of(cards, 'frame_id') == 0) return
      if (int_of(cards, 'skew_id') /= 0) then
         call report(deck, cards, 'frame_id', SEV_ERROR, 'KJ-0491', &
            'a skew and a frame are given together', 'expected: 0', findings)
      else
         call report(deck, cards, 'frame_id', SEV_ERROR, 'KJ-9125', &
            'imposed motion in a frame is not supported', 'expected: 0', findings)
      end if
   end subroutine read_motion

end module kj_build_load
