!> What the engine deck does to nodes at the start -> model: conditions and velocities.
module kj_build_engine
   use kj_kinds, only: wp
   use kj_math3, only: cross
   use kj_error, only: add_at, str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, find
   use kj_engine_nodes, only: node_act_t, BY_NODES, BY_RANGES
   use kj_draft, only: draft_t
   use kj_node_list, only: node_list_t, add_node, add_range
   use kj_model, only: model_t, bcs_t
   implicit none
   private

   public :: act_on_velocities, act_on_conditions

contains

   !> /INIV: velocities of main and free nodes
   subroutine act_on_velocities(draft, acts, model)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: acts(:)
      type(model_t), intent(inout) :: model

      real(wp) :: a(3, 3), w(3)
      integer, allocatable :: lead(:)
      integer :: i, k, frame

      do i = 1, size(acts)
         if (acts(i)%what /= 'INIV') cycle
         call leads_of(draft, acts(i), model, lead)
         if (acts(i)%axis == 0) then
            do k = 1, size(lead)
               where (acts(i)%dof(:3)) model%v0(lead(k), :) = acts(i)%v(1)
               where (acts(i)%dof(4:)) model%w0(lead(k), :) = acts(i)%v(1)
            end do
            cycle
         end if
         call find_axes(draft, acts(i), draft%frame, 'frame', 'KJ-0490', frame)
         a = reshape(draft%frames%axes(frame, :), [3, 3])
         w = acts(i)%v(4)*a(:, acts(i)%axis)
         do k = 1, size(lead)
            model%w0(lead(k), :) = w
            model%v0(lead(k), :) = matmul(a, acts(i)%v(:3)) + cross(w, model%x0(lead(k), :) - &
               draft%frame_origin(frame, :))
         end do
      end do
   end subroutine act_on_velocities

   !> /BCS holds main and free nodes in more directions, /BCSR releases them
   subroutine act_on_conditions(draft, acts, model)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: acts(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: lead(:)
      integer :: i, k, at, skew

      do i = 1, size(acts)
         if (acts(i)%what == 'INIV') cycle
         call leads_of(draft, acts(i), model, lead)
         call find_axes(draft, acts(i), draft%skew, 'skew', 'KJ-0137', skew)
         do k = 1, size(lead)
            at = findloc(model%bcs%lead, lead(k), 1)
            if (acts(i)%what == 'BCSR') then
               if (at > 0) model%bcs(at)%fixed = model%bcs(at)%fixed .and. .not. acts(i)%dof
               cycle
            end if
            if (at == 0) then
               model%bcs = [model%bcs, bcs_t()]
               at = size(model%bcs)
               model%bcs(at)%lead = lead(k)
               model%bcs(at)%skew = skew
            else if (model%bcs(at)%skew /= skew) then
               call tell(draft, acts(i), SEV_ERROR, 'KJ-0148', 'node '// &
                  str(model%node_id(lead(k)))//' has boundary conditions in two skews', &
                  'another skew')
            end if
            model%bcs(at)%fixed = model%bcs(at)%fixed .or. acts(i)%dof
         end do
      end do
   end subroutine act_on_conditions

   !> Main and free nodes that a card names; those of bodies that follow are left out
   subroutine leads_of(draft, act, model, lead)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: act
      type(model_t), intent(in) :: model
      integer, allocatable, intent(out) :: lead(:)

      type(node_list_t) :: list
      integer :: i, raw

      allocate (list%node(16))
      if (act%by == BY_NODES) then
         do i = 1, size(act%id)
            raw = find(draft%node, act%id(i))
            if (raw > 0) call add_node(raw, list)
            if (raw == 0) call tell(draft, act, SEV_ERROR, 'KJ-0078', 'node '//str(act%id(i))// &
               ' is not defined', 'names it')
         end do
      else if (act%by == BY_RANGES) then
         do i = 1, size(act%id) - 1, 2
            call add_range(draft%node, act%id(i), act%id(i + 1), 1, list)
         end do
      else
         i = find(draft%group, act%id(1))
         if (i > 0) list%node = draft%groups(i)%node
         if (i > 0) list%n = size(list%node)
         if (i == 0) call tell(draft, act, SEV_ERROR, 'KJ-0668', 'node group '//str(act%id(1))// &
            ' is not defined', 'names it', 'of a mechanism that is taken out: name its nodes')
      end if
      lead = draft%new(list%node(:list%n))
      lead = pack(lead, lead > 0 .and. lead <= model%n_lead)
      if (size(lead) == 0) call tell(draft, act, SEV_WARNING, 'KJ-9154', &
         'a card of the engine deck names no main or free node', 'has no effect')
   end subroutine leads_of

   !> Place of a skew or frame; 0 = global
   subroutine find_axes(draft, act, lookup, what, id, place)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: act
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what, id
      integer, intent(out) :: place

      place = 0
      if (act%axes == 0) return
      place = find(lookup, act%axes)
      if (place == 0) call tell(draft, act, SEV_ERROR, id, what//' '//str(act%axes)// &
         ' is not defined', 'names it')
   end subroutine find_axes

   !> A finding at the header of a card
   subroutine tell(draft, act, severity, id, message, label, hint)
      type(draft_t), intent(inout) :: draft
      type(node_act_t), intent(in) :: act
      integer, intent(in) :: severity
      character(len=*), intent(in) :: id, message, label
      character(len=*), intent(in), optional :: hint

      call add_at(draft%deck%findings, severity, id, act%file, act%line, act%text, 1, &
         max(1, len_trim(act%text)), message, label, hint)
   end subroutine tell

end module kj_build_engine
