!> Entities of one history in another: by their ids, and of those with one id by their order.
module kj_diff_match
   use kj_channels, only: channels, find_channel, OF_RUN, OF_JOINT, OF_SPRING
   use kj_sort, only: lookup_t, new_lookup, lower_bound
   use kj_history, only: history_t
   implicit none
   private

   public :: list_groups, find_in_groups, entity_ids

contains

   !> The channels of another side that may hold what a channel holds, 0 = none, and their entities
   subroutine list_groups(other, channel, group, entities)
      type(history_t), intent(in) :: other
      integer, intent(in) :: channel
      integer, intent(out) :: group(2)
      type(lookup_t), intent(out) :: entities(2)

      integer, allocatable :: id(:)
      integer :: k

      group = [channel, 0]
      associate (c => channels(channel))
         if (c%owner == OF_JOINT) group(2) = find_channel(OF_SPRING, c%name)
         if (c%owner == OF_SPRING) group(2) = find_channel(OF_JOINT, c%name)
      end associate
      do k = 1, 2
         id = [integer ::]
         if (group(k) > 0) call entity_ids(other, channels(group(k))%owner, id)
         call new_lookup(id, entities(k))
      end do
   end subroutine list_groups

   !> Place of entity j on the other side, 0 = none, and which group has it
   pure subroutine find_in_groups(id, j, entities, k, group)
      integer, intent(in) :: id(:), j            !! ids ascend
      type(lookup_t), intent(in) :: entities(2)
      integer, intent(out) :: k, group

      group = 1
      k = partner(id, j, entities(1))
      if (k > 0) return
      k = partner(id, j, entities(2))
      if (k > 0) group = 2
   end subroutine find_in_groups

   !> Place on the other side of entity j: of those with one id the n-th belong together; 0 = none
   pure integer function partner(id, j, other) result(k)
      integer, intent(in) :: id(:), j           !! ids ascend
      type(lookup_t), intent(in) :: other

      integer :: n

      n = 0
      do while (j - n > 1)
         if (id(j - n - 1) /= id(j)) exit
         n = n + 1
      end do
      k = lower_bound(other%id, id(j)) + n
      if (k <= size(other%id)) then
         if (other%id(k) == id(j)) then
            k = other%place(k)
            return
         end if
      end if
      k = 0
   end function partner

   !> User ids of the entities of an owner; 0 for the run itself
   subroutine entity_ids(history, owner, id)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner                !! OF_ constant
      integer, allocatable, intent(out) :: id(:)

      if (owner == OF_RUN) then
         id = [0]
      else if (allocated(history%entity(owner)%id)) then
         id = history%entity(owner)%id
      end if
      if (.not. allocated(id)) allocate (id(0))
   end subroutine entity_ids

end module kj_diff_match
