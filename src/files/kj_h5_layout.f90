!> The layout of a history file: every group, dataset, scale and attribute but those of /run.
!> The rows come later, through kj_sink_h5.
module kj_h5_layout
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_version, only: KJOINT_VERSION
   use kj_sha256, only: sha256_t, add_text, digest_of
   use kj_utf8, only: as_utf8, is_plain
   use kj_units, only: unit_text
   use kj_channels, only: channels, groups, sampled_at, OF_RUN, OF_JOINT, OF_SPRING, AS_F64, &
      AS_I32, AS_I8, STORED_BYTES, CH_TIME, CH_OWNER_KIND, CH_FINAL, CH_J_STATE
   use kj_history, only: history_t, variable_t, text_t
   use kj_h5, only: hid_t, create_group, close_object, has_link, link_to, put_text, put_texts, &
      put_number, put_numbers
   use kj_h5_data, only: create_series, make_scale, attach_scale
   use kj_h5_fixed, only: write_text
   use kj_h5_group, only: group_scope_t, n_entity, component_name, component_scale, write_scales, &
      write_constants
   implicit none
   private

   public :: write_layout, get_row_shape, entities_in_chunk

   integer, parameter :: MOST_CHUNK_BYTES = 256*1024

contains

   !> Write everything that is known before the first row
   subroutine write_layout(file, history, n_chunk, series, error)
      integer(hid_t), intent(in) :: file
      type(history_t), intent(in) :: history
      integer, intent(in) :: n_chunk               !! rows in a chunk
      integer(hid_t), intent(out) :: series(:)     !! open dataset of each variable, -1 when empty
      type(error_t), allocatable, intent(inout) :: error

      type(group_scope_t) :: root
      character(len=64) :: all_input
      character(len=64), allocatable :: input(:)
      integer :: owner, i

      series = -1
      call find_digests(history, all_input, input)
      call put_root_attributes(file, history, all_input, error)
      root%group = file
      root%coordinates = ''
      do i = 1, size(history%variable)
         if (history%variable(i)%channel /= CH_TIME) cycle
         call write_variable(root, history, history%variable(i), n_chunk, series(i), error)
         root%time = series(i)
         exit
      end do
      do i = 1, size(history%variable)
         if (channels(history%variable(i)%channel)%owner /= OF_RUN .or. series(i) >= 0) cycle
         call write_variable(root, history, history%variable(i), n_chunk, series(i), error)
      end do
      do owner = OF_JOINT, OF_SPRING
         call write_group(file, root%time, history, owner, n_chunk, series, error)
      end do
      call write_input(file, history, input, error)
   end subroutine write_layout

   !> SHA-256 of all decks one after the other, and of each. Of the first of several, or the only
   !> one, it is found on the way: decks may be large.
   pure subroutine find_digests(history, all_input, input)
      type(history_t), intent(in) :: history
      character(len=64), intent(out) :: all_input
      character(len=64), allocatable, intent(out) :: input(:)

      type(sha256_t) :: all, one
      integer :: i

      allocate (input(0))
      if (allocated(history%input_text)) then
         deallocate (input)
         allocate (input(size(history%input_text)))
         do i = 1, size(input)
            call add_text(all, history%input_text(i)%s)
            one = sha256_t()
            if (i > 1) call add_text(one, history%input_text(i)%s)
            if (i == 1) one = all
            input(i) = digest_of(one)
         end do
      end if
      all_input = digest_of(all)
   end subroutine find_digests

   subroutine put_root_attributes(file, history, all_input, error)
      integer(hid_t), intent(in) :: file
      type(history_t), intent(in) :: history
      character(len=*), intent(in) :: all_input    !! digest of all decks
      type(error_t), allocatable, intent(inout) :: error

      integer :: owner

      call put_text(file, 'Conventions', 'CF-1.11 KJOINT-TH-1.0', error)
      if (allocated(history%title)) call put_text(file, 'title', as_utf8(history%title), error)
      call put_text(file, 'source', 'kjoint '//KJOINT_VERSION, error)
      call put_number(file, 'kjoint_format_major', AS_I32, 1.0_wp, error)
      call put_number(file, 'kjoint_format_minor', AS_I32, 0.0_wp, error)
      call put_text(file, 'unit_mass', trim(history%units%symbol(1)), error)
      call put_text(file, 'unit_length', trim(history%units%symbol(2)), error)
      call put_text(file, 'unit_time', trim(history%units%symbol(3)), error)
      call put_numbers(file, 'unit_si', AS_F64, history%units%si, error)
      if (history%single_precision) call put_text(file, 'precision', 'single', error)
      if (allocated(history%input_text)) call put_text(file, 'input_sha256', all_input, error)
      call put_text(file, 'NX_class', 'NXentry', error)
      do owner = OF_JOINT, OF_SPRING
         if (n_entity(history, owner) == 0) cycle
         call put_text(file, 'default', trim(groups(owner)%path), error)
         exit
      end do
   end subroutine put_root_attributes

   !> Write the group of one kind of entity; without entities there is none
   subroutine write_group(file, time, history, owner, n_chunk, series, error)
      integer(hid_t), intent(in) :: file, time     !! the scale over time
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner, n_chunk
      integer(hid_t), intent(inout) :: series(:)
      type(error_t), allocatable, intent(inout) :: error

      type(group_scope_t) :: scope
      integer :: i

      if (n_entity(history, owner) == 0) return
      call create_group(file, trim(groups(owner)%path), scope%group, error)
      scope%time = time
      call put_text(scope%group, 'NX_class', 'NXdata', error)
      call put_signal(scope%group, history, owner, error)
      if (time >= 0) call link_to(file, '/time', scope%group, 'time', error)
      call write_scales(scope, history, owner, error)
      call write_constants(scope, history, owner, error)
      do i = 1, size(history%variable)
         if (channels(history%variable(i)%channel)%owner /= owner) cycle
         if (history%variable(i)%n_entity == 0) cycle
         call write_variable(scope, history, history%variable(i), n_chunk, series(i), error)
      end do
      call close_object(scope%entity, error)
      call close_object(scope%axis, error)
      call close_object(scope%quaternion, error)
      call close_object(scope%axis6, error)
      call close_object(scope%group, error)
   end subroutine write_group

   !> What a NeXus viewer shows first: force of joints, position of the others, else what there is
   subroutine put_signal(group, history, owner, error)
      integer(hid_t), intent(in) :: group
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner
      type(error_t), allocatable, intent(inout) :: error

      character(len=20) :: wanted
      type(text_t), allocatable :: axes(:)
      integer :: i, best

      wanted = 'position'
      if (owner == OF_JOINT .or. owner == OF_SPRING) wanted = 'force'
      best = 0
      do i = size(history%variable), 1, -1
         if (channels(history%variable(i)%channel)%owner /= owner) cycle
         best = i
         if (channels(history%variable(i)%channel)%name == wanted) exit
      end do
      if (best == 0) return
      call put_text(group, 'signal', trim(channels(history%variable(best)%channel)%name), error)
      allocate (axes(merge(2, 3, history%variable(best)%n_comp == 1)))
      axes(1)%s = 'time'
      axes(2)%s = trim(groups(owner)%entity)
      if (size(axes) == 3) axes(3)%s = component_name(history%variable(best)%n_comp)
      call put_texts(group, 'axes', axes, error)
   end subroutine put_signal

   !> Shape of one row of a variable: [components, entities] as far as they are dimensions
   pure subroutine get_row_shape(variable, dims)
      type(variable_t), intent(in) :: variable
      integer, allocatable, intent(out) :: dims(:)

      logical :: over_entities

      over_entities = channels(variable%channel)%owner /= OF_RUN
      allocate (dims(merge(1, 0, variable%n_comp > 1) + merge(1, 0, over_entities)))
      if (variable%n_comp > 1) dims(1) = variable%n_comp
      if (over_entities) dims(size(dims)) = variable%n_entity
   end subroutine get_row_shape

   !> Entities of a variable that share a chunk
   pure integer function entities_in_chunk(variable, n_chunk) result(m)
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: n_chunk               !! rows in a chunk

      m = max(1, min(variable%n_entity, MOST_CHUNK_BYTES/ &
         (n_chunk*variable%n_comp*STORED_BYTES(channels(variable%channel)%kind))))
   end function entities_in_chunk

   !> Create the dataset of one variable over time and leave it open
   subroutine write_variable(scope, history, variable, n_chunk, id, error)
      type(group_scope_t), intent(in) :: scope
      type(history_t), intent(in) :: history
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: n_chunk
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer, allocatable :: dims(:), chunk(:)
      integer(hid_t), allocatable :: scales(:)
      integer :: i, rank

      call get_row_shape(variable, dims)
      rank = size(dims) + 1
      allocate (chunk(rank))
      chunk = [dims, n_chunk]
      if (rank > 1) chunk(rank - 1) = entities_in_chunk(variable, n_chunk)
      call create_series(scope%group, trim(channels(variable%channel)%name), &
         channels(variable%channel)%kind, dims, chunk, id, error)
      if (variable%channel == CH_TIME) then
         call make_scale(id, 'time', error)
      else
         allocate (scales(rank))
         scales(rank) = scope%time
         if (rank > 1) scales(rank - 1) = scope%entity
         if (rank == 3) scales(1) = component_scale(scope, variable%n_comp)
         do i = 1, rank
            call attach_scale(id, scales(i), i, rank, error)
         end do
      end if
      call put_variable_attributes(id, scope, history, variable%channel, error)
   end subroutine write_variable

   subroutine put_variable_attributes(id, scope, history, row, error)
      integer(hid_t), intent(in) :: id
      type(group_scope_t), intent(in) :: scope
      type(history_t), intent(in) :: history
      integer, intent(in) :: row                   !! of the channel table
      type(error_t), allocatable, intent(inout) :: error

      integer :: i

      call put_text(id, 'units', unit_text(channels(row)%dim, history%units), error)
      call put_text(id, 'long_name', trim(channels(row)%meaning), error)
      call put_text(id, 'channel_class', trim(channels(row)%class), error)
      if (row == CH_TIME) call put_text(id, 'axis', 'T', error)
      if (channels(row)%frame /= '') call put_text(id, 'frame', trim(channels(row)%frame), error)
      if (channels(row)%radioss /= '') &
         call put_text(id, 'radioss_name', trim(channels(row)%radioss), error)
      call put_text(id, 'sampled_at', sampled_at(row, history%legacy), error)
      if (len(scope%coordinates) > 0) call put_text(id, 'coordinates', scope%coordinates, error)
      if (row == CH_OWNER_KIND) then
         call put_numbers(id, 'flag_values', AS_I8, [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp], error)
         call put_text(id, 'flag_meanings', 'none node body joint', error)
      end if
      if (row == CH_J_STATE) then
         call put_numbers(id, 'flag_values', AS_I8, [(real(i, wp), i=0, 5)], error)
         call put_text(id, 'flag_meanings', 'free sliding sticking at_stop locked blocked', error)
      end if
      if (row == CH_FINAL) then
         call put_numbers(id, 'flag_values', AS_I8, [0.0_wp, 1.0_wp], error)
         call put_text(id, 'flag_meanings', 'sample final_state', error)
      end if
   end subroutine put_variable_attributes

   !> Write the deck files, a dataset each
   subroutine write_input(file, history, digest, error)
      integer(hid_t), intent(in) :: file
      type(history_t), intent(in) :: history
      character(len=64), intent(in) :: digest(:)   !! of each
      type(error_t), allocatable, intent(inout) :: error

      character(len=:), allocatable :: name
      integer(hid_t) :: group, id
      integer :: i

      if (.not. allocated(history%input_text)) return
      if (size(history%input_text) == 0) return
      call create_group(file, 'input', group, error)
      do i = 1, size(history%input_text)
         if (allocated(error)) exit
         ! files of one name in different folders are told apart by a suffix
         name = as_utf8(history%input_name(i)%s)
         name = name(index(name, '/', back=.true.) + 1:)
         do while (has_link(group, name))
            name = name//'~'
         end do
         if (is_plain(history%input_text(i)%s)) then
            call write_text(group, name, history%input_text(i)%s, id, error)
         else
            call write_text(group, name, as_utf8(history%input_text(i)%s), id, error)
         end if
         call put_text(id, 'sha256', digest(i), error)
         call put_text(id, 'role', history%input_role(i)%s, error)
         call close_object(id, error)
      end do
      call close_object(group, error)
   end subroutine write_input

end module kj_h5_layout
