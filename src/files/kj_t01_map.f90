!> From the variables of a T01 to the channels of a history: which number of a row goes where.
module kj_t01_map
   use kj_sort, only: lookup_t, new_lookup, find, sort_unique
   use kj_history, only: history_t, text_t, add_variable
   use kj_channels, only: channels, groups, find_t01, OF_RUN, OF_BODY
   use kj_t01_header, only: t01_group_t
   use kj_t01_names, only: t01_name, OF_GLOBALS
   implicit none
   private

   public :: t01_map_t, map_globals, map_entities, add_unknown

   !> Where the values of a row of a history come from
   type :: t01_map_t
      integer, allocatable :: source(:)      !! (n_value) place in a row of the file, 0 = not there
   end type t01_map_t

   integer, parameter :: BODY_MASS = 34      !! code of the mass of a body, which is no channel

contains

   !> Globals: one series each
   subroutine map_globals(codes, before, history, map, unknown)
      integer, intent(in) :: codes(:)
      integer, intent(in) :: before                    !! values of a row before the first
      type(history_t), intent(inout) :: history
      type(t01_map_t), intent(inout) :: map
      type(text_t), allocatable, intent(inout) :: unknown(:)

      integer :: place(size(channels)), i, row, comp

      place = 0
      do i = 1, size(codes)
         call find_t01(OF_RUN, codes(i), row, comp)
         if (row == 0) then
            call add_unknown(OF_GLOBALS, codes(i), '', unknown)
         else
            place(row) = before + i
         end if
      end do
      do row = 1, size(channels)
         if (place(row) == 0) cycle
         call add_variable(history, row, 1)
         map%source = [map%source, place(row)]
      end do
   end subroutine map_globals

   !> All entities of one kind, from all groups of this kind
   subroutine map_entities(owner, all_groups, before, history, map, id, label, mass_place, unknown)
      integer, intent(in) :: owner                     !! OF_ constant
      type(t01_group_t), intent(in) :: all_groups(:)
      integer, intent(in) :: before(:)                 !! values of a row before those of a group
      type(history_t), intent(inout) :: history
      type(t01_map_t), intent(inout) :: map
      integer, allocatable, intent(out) :: id(:)                !! ascending
      type(text_t), allocatable, intent(out) :: label(:)
      integer, allocatable, intent(out) :: mass_place(:)        !! place of the mass, 0 = none
      type(text_t), allocatable, intent(inout) :: unknown(:)

      integer, allocatable :: place(:, :)     !! (components of all channels, entities)
      integer :: slot(size(channels)), row, n

      call collect_entities(groups(owner)%t01_type, all_groups, id, label)
      n = 0
      do row = 1, size(channels)
         slot(row) = n
         if (channels(row)%owner == owner .and. channels(row)%t01 > 0) n = n + channels(row)%n_comp
      end do
      allocate (place(n, size(id)), mass_place(size(id)), source=0)
      call place_values(owner, all_groups, before, id, slot, place, mass_place, unknown)
      do row = 1, size(channels)
         if (channels(row)%owner /= owner .or. channels(row)%t01 == 0) cycle
         n = channels(row)%n_comp
         call add_channel(owner, row, place(slot(row) + 1:slot(row) + n, :), history, map, unknown)
      end do
   end subroutine map_entities

   !> Ids of one kind, ascending, each once; the first name that is not blank
   subroutine collect_entities(type, all_groups, id, label)
      integer, intent(in) :: type
      type(t01_group_t), intent(in) :: all_groups(:)
      integer, allocatable, intent(out) :: id(:)
      type(text_t), allocatable, intent(out) :: label(:)

      type(lookup_t) :: known
      integer :: i, j, k

      allocate (id(0))
      do i = 1, size(all_groups)
         if (all_groups(i)%type == type) id = [id, all_groups(i)%object]
      end do
      id = sort_unique(id)
      call new_lookup(id, known)
      allocate (label(size(id)))
      do i = 1, size(id)
         label(i)%s = ''
      end do
      do i = 1, size(all_groups)
         if (all_groups(i)%type /= type) cycle
         do j = 1, size(all_groups(i)%object)
            k = find(known, all_groups(i)%object(j))
            if (len(label(k)%s) == 0) label(k)%s = all_groups(i)%name(j)%s
         end do
      end do
   end subroutine collect_entities

   !> Place in a row of the file of every component we have a channel for; the first group wins
   subroutine place_values(owner, all_groups, before, id, slot, place, mass_place, unknown)
      integer, intent(in) :: owner, before(:), id(:), slot(:)
      type(t01_group_t), intent(in) :: all_groups(:)
      integer, intent(inout) :: place(:, :), mass_place(:)
      type(text_t), allocatable, intent(inout) :: unknown(:)

      type(lookup_t) :: known
      integer :: i, j, k, n, row, comp, entity, at

      call new_lookup(id, known)
      do i = 1, size(all_groups)
         if (all_groups(i)%type /= groups(owner)%t01_type) cycle
         n = size(all_groups(i)%code)
         do k = 1, n
            call find_t01(owner, all_groups(i)%code(k), row, comp)
            if (owner == OF_BODY .and. all_groups(i)%code(k) == BODY_MASS) then
               do j = 1, size(all_groups(i)%object)
                  entity = find(known, all_groups(i)%object(j))
                  mass_place(entity) = before(i) + (j - 1)*n + k
               end do
            else if (row == 0) then
               call add_unknown(all_groups(i)%type, all_groups(i)%code(k), '', unknown)
            else
               do j = 1, size(all_groups(i)%object)
                  entity = find(known, all_groups(i)%object(j))
                  at = slot(row) + comp
                  if (place(at, entity) == 0) place(at, entity) = before(i) + (j - 1)*n + k
               end do
            end if
         end do
      end do
   end subroutine place_values

   !> Add the channel if one entity has all its components; name the components that stand alone
   subroutine add_channel(owner, row, place, history, map, unknown)
      integer, intent(in) :: owner, row                !! OF_ constant, row of the channel table
      integer, intent(in) :: place(:, :)               !! (components, entities)
      type(history_t), intent(inout) :: history
      type(t01_map_t), intent(inout) :: map
      type(text_t), allocatable, intent(inout) :: unknown(:)

      logical :: whole(size(place, 2))
      integer :: kept(size(place, 1), size(place, 2)), comp

      whole = all(place > 0, dim=1)
      do comp = 1, size(place, 1)
         if (.not. any(place(comp, :) > 0 .and. .not. whole)) cycle
         call add_unknown(groups(owner)%t01_type, channels(row)%t01 + comp - 1, &
            ' (without the other components)', unknown)
      end do
      if (.not. any(whole)) return
      kept = merge(place, 0, spread(whole, 1, size(place, 1)))
      call add_variable(history, row, size(place, 2))
      map%source = [map%source, reshape(kept, [size(kept)])]
   end subroutine add_channel

   !> Note a variable that has no channel, once
   subroutine add_unknown(type, code, remark, unknown)
      integer, intent(in) :: type, code
      character(len=*), intent(in) :: remark
      type(text_t), allocatable, intent(inout) :: unknown(:)

      type(text_t), allocatable :: longer(:)
      character(len=:), allocatable :: name
      integer :: i

      name = t01_name(type, code)//remark
      do i = 1, size(unknown)
         if (unknown(i)%s == name) return
      end do
      allocate (longer(size(unknown) + 1))
      do i = 1, size(unknown)
         call move_alloc(unknown(i)%s, longer(i)%s)
      end do
      longer(size(longer))%s = name
      call move_alloc(longer, unknown)
   end subroutine add_unknown

end module kj_t01_map
