!> The channels of REF, entity by entity, and where RUN has them.
module kj_diff_match
   use kj_error, only: str
   use kj_sort, only: lookup_t, new_lookup, find
   use kj_history, only: history_t
   use kj_channels, only: channels, groups, OF_RUN, OF_JOINT, OF_BODY, OF_NODE, OF_SPRING, &
      CH_CYCLE, CH_TIME_STEP, CH_OWNER_KIND, CH_OWNER
   use kj_diff_types, only: channel_result_t, class_result_t, diff_options_t, profile_t
   use kj_diff_walk, only: cursor_t
   implicit none
   private

   public :: match_channels, find_classes

   !> What tells of the steps of a run and not of the scene
   integer, parameter :: OF_STEPS(4) = [CH_CYCLE, CH_TIME_STEP, CH_OWNER_KIND, CH_OWNER]

contains

   !> List every channel of every entity of REF with its place in RUN, 0 where RUN has none
   !>
   !> Profile `solver` and interpolation compare runs of other steps: channels that tell of the
   !> steps are then listed only.
   subroutine match_channels(ref, run, options, profile, list)
      type(cursor_t), intent(in) :: ref, run
      type(diff_options_t), intent(in) :: options
      type(profile_t), intent(in) :: profile
      type(channel_result_t), allocatable, intent(out) :: list(:)

      integer, allocatable :: ref_id(:), run_id(:)
      type(lookup_t) :: in_run
      integer :: run_variable(size(channels)), i, j, k, n, at

      n = 0
      do i = 1, size(ref%history%variable)
         at = ref%history%variable(i)%first
         do j = 1, ref%history%variable(i)%n_entity
            if (ref%reader%given(at)) n = n + 1
            at = at + ref%history%variable(i)%n_comp
         end do
      end do
      allocate (list(n))
      run_variable = 0
      do i = 1, size(run%history%variable)
         run_variable(run%history%variable(i)%channel) = i
      end do
      n = 0
      do i = 1, size(ref%history%variable)
         associate (v => ref%history%variable(i))
            call entity_ids(ref%history, channels(v%channel)%owner, ref_id)
            call entity_ids(run%history, channels(v%channel)%owner, run_id)
            call new_lookup(run_id, in_run)
            do j = 1, v%n_entity
               at = v%first + (j - 1)*v%n_comp
               if (.not. ref%reader%given(at)) cycle
               n = n + 1
               list(n)%channel = v%channel
               list(n)%entity = ref_id(j)
               list(n)%n_comp = v%n_comp
               list(n)%ref_at = at
               list(n)%name = name_of(v%channel, ref_id(j))
               list(n)%counted = .not. (any(OF_STEPS == v%channel) .and. &
                  (profile%name == 'solver' .or. options%interpolate))
               k = find(in_run, ref_id(j))
               if (k == 0 .or. run_variable(v%channel) == 0) cycle
               at = run%history%variable(run_variable(v%channel))%first + (k - 1)*v%n_comp
               if (run%reader%given(at)) list(n)%run_at = at
            end do
         end associate
      end do
   end subroutine match_channels

   !> User ids of the entities of an owner; 0 for the run itself
   subroutine entity_ids(history, owner, id)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner                !! OF_ constant
      integer, allocatable, intent(out) :: id(:)

      if (owner == OF_RUN) id = [0]
      if (owner == OF_JOINT .and. allocated(history%joint_id)) id = history%joint_id
      if (owner == OF_BODY .and. allocated(history%body_id)) id = history%body_id
      if (owner == OF_NODE .and. allocated(history%node_id)) id = history%node_id
      if (owner == OF_SPRING .and. allocated(history%spring_id)) id = history%spring_id
      if (.not. allocated(id)) allocate (id(0))
   end subroutine entity_ids

   !> "joint/force[5]", "kinetic_energy_trans"
   pure function name_of(channel, entity) result(name)
      integer, intent(in) :: channel, entity
      character(len=:), allocatable :: name

      name = trim(channels(channel)%name)
      if (channels(channel)%owner == OF_RUN) return
      name = trim(groups(channels(channel)%owner)%path)//'/'//name//'['//str(entity)//']'
   end function name_of

   !> The classes that occur, in the order of the channels, and the class of each channel
   subroutine find_classes(list, classes)
      type(channel_result_t), intent(inout) :: list(:)
      type(class_result_t), allocatable, intent(out) :: classes(:)

      type(class_result_t) :: found(size(channels))
      integer :: i, n

      n = 0
      do i = 1, size(list)
         list(i)%class = findloc(found(:n)%name, channels(list(i)%channel)%class, 1)
         if (list(i)%class > 0) cycle
         n = n + 1
         found(n)%name = channels(list(i)%channel)%class
         list(i)%class = n
      end do
      classes = found(:n)
   end subroutine find_classes

end module kj_diff_match
