!> Cards -> model: initial velocities.
module kj_build_velocity
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, SEV_ERROR, SEV_WARNING
   use kj_math3, only: cross
   use kj_keywords, only: KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS
   use kj_deck_text, only: deck_t
   use kj_cards, only: cards_t, read_cards, real_of, text_of, report
   use kj_draft, only: draft_t, group_nodes, reference
   use kj_model, only: model_t
   implicit none
   private

   public :: build_velocities

contains

   !> Initial velocities in deck order, the last one on a node wins; secondary nodes follow their
   !> body
   subroutine build_velocities(deck, draft, model, findings)
      type(deck_t), intent(in) :: deck
      type(draft_t), intent(in) :: draft
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      type(cards_t) :: cards
      integer, allocatable :: nodes(:)
      integer :: i, b, keyword

      do i = 1, deck%n_block
         keyword = deck%block(i)%keyword
         if (.not. any(keyword == [KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS])) &
            cycle
         call read_cards(deck, i, cards, findings)
         call refuse_late(deck, cards, draft, findings)
         call group_nodes(draft, deck, cards, 'grnod_id', 'KJ-0668', .true., findings, nodes)
         nodes = draft%new(nodes)
         if (size(nodes) > 0 .and. all(nodes > model%n_lead)) call report(deck, cards, 'grnod_id', &
            SEV_WARNING, 'KJ-9152', 'an initial velocity of secondary nodes has no effect', &
            'holds secondary nodes only', findings, &
            hint='secondary nodes follow their body: give the velocity to its main node')
         if (keyword == KW_INIVEL_AXIS) then
            call set_axis_velocity(deck, cards, draft, nodes, model, findings)
         else
            call set_velocity(deck, cards, keyword, draft, nodes, model, findings)
         end if
      end do
      do i = model%n_lead + 1, model%n_node
         b = model%lead(i)
         model%v0(i, :) = model%v0(b, :) + &
            cross(model%w0(b, :), model%x0(i, :) - model%x0(b, :))
      end do
   end subroutine build_velocities

   !> Velocities act at the start, and at no other time
   subroutine refuse_late(deck, cards, draft, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      type(finding_list_t), intent(inout) :: findings

      integer :: sensor

      sensor = reference(deck, cards, 'sens_id', draft%sensor, 'sensor', 'KJ-1252', findings)
      if (sensor > 0) call report(deck, cards, 'sens_id', SEV_ERROR, 'KJ-9117', &
         'initial velocities after a sensor are not supported', 'expected: 0', findings)
      if (real_of(cards, 'Tstart') > 0.0_wp) call report(deck, cards, 'Tstart', SEV_ERROR, &
         'KJ-9117', &
         'initial velocities after the start are not supported', 'expected: 0', findings)
   end subroutine refuse_late

   !> /INIVEL/TRA, T+G and ROT
   subroutine set_velocity(deck, cards, keyword, draft, nodes, model, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      integer, intent(in) :: keyword
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: nodes(:)            !! model indices
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: v(3)
      integer :: k, skew

      v = [real_of(cards, 'Vx'), real_of(cards, 'Vy'), real_of(cards, 'Vz')]
      skew = reference(deck, cards, 'skew_id', draft%skew, 'skew', 'KJ-0184', findings)
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
   subroutine set_axis_velocity(deck, cards, draft, nodes, model, findings)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: nodes(:)            !! model indices
      type(model_t), intent(inout) :: model
      type(finding_list_t), intent(inout) :: findings

      real(wp) :: a(3, 3), origin(3), w(3), v(3)
      integer :: dir, frame, k

      dir = index('XYZ', text_of(cards, 'dir'))
      if (len(text_of(cards, 'dir')) /= 1) dir = 0
      if (dir == 0) call report(deck, cards, 'dir', SEV_ERROR, 'KJ-0933', &
         'the axis is not X, Y or Z', 'expected: X, Y or Z', findings)
      frame = reference(deck, cards, 'frame_id', draft%frame, 'frame', 'KJ-0490', findings)
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

end module kj_build_velocity
