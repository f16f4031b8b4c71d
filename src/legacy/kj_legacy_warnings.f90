!> Warnings where a known defect of the legacy scheme acts on a scene: one line each.
!> Source: docs/theory/legacy.md 10.
module kj_legacy_warnings
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, fail, add_finding, str, SEV_WARNING, ERR_INPUT
   use kj_joint_types, only: FRAME_FIRST, FRAME_CROSS, NDOF
   use kj_joint_batch, only: joint_batch_t, LAW_SPRING_CURVE, has_friction, has_limits, &
      is_spring
   use kj_curve, only: curve_set_t, law_value
   use kj_model, only: model_t, joint_title, body_title, BY_TIME
   use kj_legacy_state, only: legacy_state_t
   use kj_legacy_cost, only: spin_cost, node_drift
   implicit none
   private

   public :: warn_legacy, warn_costs, joint_of_bad_curve

   !> Defects of joints, in the order of their warnings
   integer, parameter :: FIRST_SKEW = 1, UNIVERSAL = 2, FALLING = 3, BACKWARD = 4, SHARED = 5, &
      RUBBING = 6
   ! Costs over a run that are worth a word
   real(wp), parameter :: SPIN_GAIN = 0.01_wp      !! part of the energy of rotation
   real(wp), parameter :: SPIN_ANGLE = 0.05_wp     !! error of attitude [rad]
   real(wp), parameter :: DRIFT_MOST = 1.0e-3_wp   !! change of a distance, fraction
   real(wp), parameter :: SUMMED_MOST = 0.01_wp    !! error of summed rotations [rad]

   character(len=7), parameter :: ID(6) = ['KJ-9201', 'KJ-9202', 'KJ-9203', 'KJ-9204', 'KJ-9207', &
      'KJ-9208']

contains

   !> Everything that can be seen before the first cycle
   subroutine warn_legacy(model, findings)
      type(model_t), intent(in) :: model
      type(finding_list_t), intent(inout) :: findings

      logical, allocatable :: acts(:)
      integer :: defect, j

      do defect = FIRST_SKEW, RUBBING
         acts = [(acts_on(model, defect, j), j=1, model%n_joint)]
         if (.not. any(acts)) cycle
         call warn(findings, ID(defect), trim(joint_text(model, acts))// &
            trim(text_of(defect)))
      end do
      call warn_shared_curves(model, findings)
   end subroutine warn_legacy

   !> What a defect does
   pure function text_of(defect) result(text)
      integer, intent(in) :: defect
      character(len=200) :: text

      text = ''
      select case (defect)
      case (FIRST_SKEW)
         text = ': skew flag 1 and a length: half the moment of the force goes to each body, '// &
            'so the legacy scheme creates or loses energy'
      case (UNIVERSAL)
         text = ': the legacy universal joint measures in a frame that it does not push in, '// &
            'so energy is not kept (some percent)'
      case (FALLING)
         text = ': a stiffness curve falls somewhere: the legacy scheme takes the root of its '// &
            'slope and gets NaN there'
      case (BACKWARD)
         text = ': a stiffness curve is above f(0) at negative abscissae: the time step of the '// &
            'legacy scheme collapses there'
      case (SHARED)
         text = ': shares a KJOINT2 with stops, friction or a lock: OpenRadioss mixes damping '// &
            'and friction of such joints, here each is alone'
      case (RUBBING)
         text = ': friction on a universal KJOINT2: in OpenRadioss it spoils the axes, here it '// &
            'does not'
      end select
   end function text_of

   pure logical function acts_on(model, defect, j) result(acts)
      type(model_t), intent(in) :: model
      integer, intent(in) :: defect, j

      integer :: place

      place = model%joint(j)%place
      associate (batch => model%batch(model%joint(j)%batch))
         select case (defect)
         case (FIRST_SKEW)
            acts = batch%frame == FRAME_FIRST .and. norm2(batch%xl0(place, :)) > 0.0_wp
         case (UNIVERSAL)
            acts = batch%frame == FRAME_CROSS
         case (SHARED)
            acts = .false.
            if (batch%limited) acts = has_limits(batch%limit, place) .and. &
               count(model%joint%property == model%joint(j)%property) > 1
         case (RUBBING)
            acts = .false.
            if (batch%limited .and. batch%frame == FRAME_CROSS) acts = any(has_friction( &
               batch%limit%k(place, :), batch%limit%slip(place, :), &
               batch%limit%slip_curve(place, :)))
         case default
            acts = bad_curve(model%curves, batch, place, defect)
         end select
      end associate
   end function acts_on

   !> User id of a joint whose stiffness curve this scheme cannot bear, 0 = none: one that falls,
   !> else one that is above f(0) at negative abscissae
   pure integer function joint_of_bad_curve(model) result(id)
      type(model_t), intent(in) :: model

      integer :: defect, j

      do defect = FALLING, BACKWARD
         do j = 1, model%n_joint
            id = model%joint(j)%id
            if (acts_on(model, defect, j)) return
         end do
      end do
      id = 0
   end function joint_of_bad_curve

   !> A stiffness curve of the joint falls (with a reduced mass), or is above f(0) at a knot < 0
   pure logical function bad_curve(curves, batch, place, defect) result(bad)
      type(curve_set_t), intent(in) :: curves
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: place, defect

      integer :: dof, c, first, last
      real(wp) :: scale, y0, slope

      bad = .false.
      do dof = 1, NDOF
         if (iand(batch%law(dof), LAW_SPRING_CURVE) == 0) cycle
         c = batch%k_curve(place, dof)
         scale = batch%k(place, dof)
         first = curves%first(c)
         last = curves%first(c + 1) - 1
         associate (x => curves%x(first:last), y => curves%y(first:last))
            if (defect == FALLING) then
               if (.not. batch%reduced(place, merge(1, 2, dof <= 3)) > 0.0_wp) cycle
               bad = bad .or. any(scale*(y(2:) - y(:size(y) - 1)) < 0.0_wp)
            else
               call law_value(curves, c, 0.0_wp, y0, slope)
               bad = bad .or. any(x < 0.0_wp .and. scale*(y - y0) > 0.0_wp)
            end if
         end associate
      end do
   end function bad_curve

   !> "joint 900", or "17 joints, the first 900"
   pure function joint_text(model, acts) result(text)
      type(model_t), intent(in) :: model
      logical, intent(in) :: acts(:)             !! (n_joint)
      character(len=160) :: text

      integer :: first

      first = minloc(model%joint(:size(acts))%id, dim=1, mask=acts)
      text = 'joint '//joint_title(model, first)
      if (count(acts) > 1) text = str(count(acts))//' joints, the first '//joint_title(model, first)
   end function joint_text

   !> Consecutive concentrated loads with one curve but other abscissa scales or abscissae
   subroutine warn_shared_curves(model, findings)
      type(model_t), intent(in) :: model
      type(finding_list_t), intent(inout) :: findings

      integer :: i
      logical :: shares

      do i = 2, size(model%cload)
         associate (a => model%cload(i - 1), b => model%cload(i))
            if (a%curve /= b%curve .or. b%curve == 0) cycle
            shares = b%abscissa /= BY_TIME .or. abs(a%x_scale - b%x_scale) > 0.0_wp
            if (.not. shares) cycle
            call warn(findings, 'KJ-9205', 'two concentrated loads in a row use function '// &
               str(model%curves%id(b%curve))// &
               ': the legacy scheme takes the value of the first for both')
            return
         end associate
      end do
   end subroutine warn_shared_curves

   !> After a run: what defects cost that act more or less with what the scene does
   subroutine warn_costs(model, state, findings)
      type(model_t), intent(in) :: model
      type(legacy_state_t), intent(in) :: state
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: gain, angle, drift
      integer :: at

      call spin_cost(state, at, gain, angle)
      if (abs(gain) > SPIN_GAIN .or. angle > SPIN_ANGLE) call warn(findings, 'KJ-9206', &
         'rigid body '//body_title(model, at)//': its spin, which the legacy scheme takes '// &
         'half a step old, has changed its energy of rotation by '// &
         trim(number(100.0_wp*gain))//' %, and its attitude by about '// &
         trim(number(angle))//' rad')
      call node_drift(model, state, at, drift)
      if (abs(drift) > DRIFT_MOST) call warn(findings, 'KJ-9211', 'node '// &
         str(model%node_id(at))//' is now '//trim(number(100.0_wp*abs(drift)))//' % '// &
         trim(merge('further from', 'nearer to   ', drift > 0.0_wp))// &
         ' the main node of rigid body '//body_title(model, model%lead(at))// &
         ' than at the start: the legacy scheme lets nodes of turning bodies drift')
      if (state%summed_error > SUMMED_MOST) call warn(findings, 'KJ-9212', &
         trim(element_name(model, state%summed_joint))//': the rotations that the legacy '// &
         'scheme sums are up to '//trim(number(state%summed_error))//' rad from the true ones, '// &
         'as they depend on the path; springs, stops and friction follow them')
   end subroutine warn_costs

   !> "joint 900" or "spring 900", by index among all elements of the batches
   pure function element_name(model, at) result(text)
      type(model_t), intent(in) :: model
      integer, intent(in) :: at
      character(len=160) :: text

      integer :: j

      text = ''
      do j = 1, size(model%joint)
         if (model%batch(model%joint(j)%batch)%first + model%joint(j)%place /= at) cycle
         text = 'joint '//joint_title(model, j)
         if (is_spring(model%batch(model%joint(j)%batch))) text = 'spring '//joint_title(model, j)
      end do
   end function element_name

   !> A number in as many columns as it takes to read it
   pure function number(x) result(text)
      real(wp), intent(in) :: x
      character(len=10) :: text

      write (text, '(f10.3)') x
      if (abs(x) >= 1.0e3_wp .or. abs(x) < 1.0e-2_wp) write (text, '(es10.1)') x
      text = adjustl(text)
   end function number

   subroutine warn(findings, id, message)
      type(finding_list_t), intent(inout) :: findings
      character(len=*), intent(in) :: id, message

      type(error_t), allocatable :: finding

      call fail(finding, ERR_INPUT, message, id)
      finding%severity = SEV_WARNING
      call add_finding(findings, finding)
   end subroutine warn

end module kj_legacy_warnings
