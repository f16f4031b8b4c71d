!> The layout of a history file: every group, dataset, scale and attribute but those of /run. The
!> rows come later, through kj_sink_h5.
!> One file: the layout of the file can be read from the root down to the labels.
module kj_h5_layout
   use, intrinsic :: iso_c_binding, only: c_ptr, C_NULL_PTR
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_units, only: unit_text, D_NUMBER, D_LENGTH, D_MASS, D_INERTIA, &
      D_STIFFNESS, D_ROT_STIFFNESS
   use kj_joint_types, only: joint_types, find_joint_type, DOF_NAME
   use kj_channels, only: channels, groups, OF_JOINT, OF_SPRING, AS_F64, AS_I32, sampled_at, &
      OF_RUN, AS_I8, STORED_BYTES, CH_TIME, CH_OWNER_KIND, CH_FINAL, CH_J_STATE
   use kj_history, only: history_t, n_entity, variable_t
   use kj_text, only: text_t, as_utf8, is_plain
   use kj_h5, only: hid_t, close_object, find_place, put_text, create_group, has_link, link_to, &
      put_number, put_numbers, forms_t
   use kj_h5_write, only: make_scale, attach_scales, close_scale, write_numbers, write_texts, &
      start_forms, end_forms, create_series, write_text, put_texts, new_scales, free_scales
   use kj_version, only: KJOINT_VERSION
   use kj_sha256, only: add_text, digest_of, sha256_t
   implicit none
   private

   public :: write_layout, get_row_shape, entities_in_chunk

   !> Meanings of the ids, labels and types of each kind of entity
   character(len=14), parameter :: ID_OF(OF_JOINT:OF_SPRING) = [character(len=14) :: &
      'spring element', 'rigid body', 'node', 'spring']
   character(len=23), parameter :: LABEL_OF(OF_JOINT:OF_SPRING) = [character(len=23) :: &
      'title of the part', 'title of the rigid body', 'name of the node', 'title of the part']

   !> What the datasets of one group share
   type :: group_scope_t
      integer(hid_t) :: group = -1
      type(c_ptr) :: scales = C_NULL_PTR                       !! that are open, of all groups
      type(forms_t) :: forms                                   !! what is made alike
      integer(hid_t) :: time = -1, entity = -1                 !! the scales
      integer(hid_t) :: axis = -1, quaternion = -1, axis6 = -1   !! those over components
      integer(hid_t) :: principal = -1                         !! that over principal axes
      character(len=:), allocatable :: coordinates                           !! @coordinates
   end type group_scope_t

   integer, parameter :: MOST_CHUNK_BYTES = 256*1024

contains

   !> Name of the dimension over components
   pure function component_name(n_comp) result(name)
      integer, intent(in) :: n_comp
      character(len=:), allocatable :: name

      name = 'axis'
      if (n_comp == 4) name = 'quaternion'
      if (n_comp == 6) name = 'axis6'
   end function component_name

   !> Its scale
   pure integer(hid_t) function component_scale(scope, n_comp) result(id)
      type(group_scope_t), intent(in) :: scope
      integer, intent(in) :: n_comp

      id = scope%axis
      if (n_comp == 4) id = scope%quaternion
      if (n_comp == 6) id = scope%axis6
   end function component_scale

   !> Write the dimension scales of a group and leave them open
   subroutine write_scales(scope, history, owner, error)
      type(group_scope_t), intent(inout) :: scope
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner
      type(error_t), allocatable, intent(inout) :: error

      associate (g => scope%group, f => scope%forms, e => history%entity(owner))
         call write_number_scale(g, f, trim(groups(owner)%entity), e%id, 'user id of the '// &
            trim(ID_OF(owner)), scope%entity, error)
         call write_component_scale(g, f, ['x', 'y', 'z'], 'component', scope%axis, error)
         if (has_variable(history, owner, 4)) call write_component_scale(g, f, &
            ['w', 'x', 'y', 'z'], 'component of the quaternion', scope%quaternion, error)
         if (allocated(e%axes)) call write_number_scale(g, f, 'principal', [1, 2, 3], &
            'principal axis', scope%principal, error)
         if (has_variable(history, owner, 6)) call write_component_scale(g, f, DOF_NAME, &
            'direction of the joint', scope%axis6, error)
      end associate
   end subroutine write_scales

   !> Write a scale of integers and leave it open
   subroutine write_number_scale(group, forms, name, values, meaning, id, error)
      integer(hid_t), intent(in) :: group
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name, meaning
      integer, intent(in) :: values(:)
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      call write_numbers(group, forms, name, AS_I32, [size(values)], real(values, wp), id, error)
      call make_scale(id, name, error)
      call put_text(id, 'units', '1', error, forms)
      call put_text(id, 'long_name', meaning, error, forms)
   end subroutine write_number_scale

   !> A variable of this owner has n_comp components
   pure logical function has_variable(history, owner, n_comp)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner, n_comp

      has_variable = any(channels(history%variable%channel)%owner == owner .and. &
         history%variable%n_comp == n_comp)
   end function has_variable

   !> Write the scale over components, a name each, and leave it open
   subroutine write_component_scale(group, forms, components, meaning, id, error)
      integer(hid_t), intent(in) :: group
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: components(:), meaning
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      type(text_t) :: names(size(components))
      integer :: i

      do i = 1, size(components)
         names(i)%s = trim(components(i))
      end do
      call write_texts(group, forms, component_name(size(components)), names, id, error)
      call make_scale(id, component_name(size(components)), error)
      call put_text(id, 'long_name', meaning, error, forms)
   end subroutine write_component_scale

   !> Write labels and numbers of the entities; texts become @coordinates of the scope
   subroutine write_constants(scope, history, owner, error)
      type(group_scope_t), intent(inout) :: scope
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner                 !! OF_ constant
      type(error_t), allocatable, intent(inout) :: error

      character(len=:), allocatable :: meaning
      integer :: n, e

      scope%coordinates = ''
      associate (entity => history%entity(owner))
         n = size(entity%id)
         call write_labels(scope, 'label', entity%label, trim(LABEL_OF(owner)), error)
         if (allocated(entity%type)) then
            meaning = 'type of the property: 4 or 8'
            if (owner == OF_JOINT) meaning = 'joint type number'
            if (owner == OF_JOINT) call write_kinds(scope, entity%type, error)
            call write_ids(scope, 'type', entity%type, meaning, error)
         end if
         if (allocated(entity%property)) &
            call write_ids(scope, 'property', entity%property, 'user id of the property', error)
         do e = 1, 2
            if (allocated(entity%node)) call write_ids(scope, 'node'//str(e), entity%node(e, :), &
               'user id of node '//str(e), error)
         end do
         do e = 1, 2
            if (allocated(entity%body)) call write_ids(scope, 'body'//str(e), entity%body(e, :), &
               'user id of the rigid body of node '//str(e)//', 0 = none', error)
         end do
         if (allocated(entity%skew)) call write_ids(scope, 'skew', entity%skew, &
            'user id of the skew whose axes the components have, 0 = global', error)
         if (allocated(entity%blocking)) then
            call write_constant(scope, 'blocking_trans', [n], entity%blocking(1, :), &
               [scope%entity], unit_text(D_STIFFNESS, history%units), &
               'stiffness of the blocked translations, 0 = none', error)
            call write_constant(scope, 'blocking_rot', [n], entity%blocking(2, :), &
               [scope%entity], unit_text(D_ROT_STIFFNESS, history%units), &
               'stiffness of the blocked rotations, 0 = none', error)
         end if
         if (allocated(entity%main_node)) &
            call write_ids(scope, 'main_node', entity%main_node, 'user id of the main node', error)
         if (allocated(entity%mass)) call write_constant(scope, 'mass', [n], entity%mass, &
            [scope%entity], unit_text(D_MASS, history%units), 'mass of the rigid body', error)
         if (allocated(entity%inertia)) call write_constant(scope, 'inertia_principal', [3, n], &
            reshape(entity%inertia, [3*n]), [scope%axis, scope%entity], &
            unit_text(D_INERTIA, history%units), 'principal moments of inertia', error)
         if (allocated(entity%axes)) call write_constant(scope, 'principal_axes', [3, 3, n], &
            reshape(entity%axes, [9*n]), [scope%axis, scope%principal, scope%entity], &
            unit_text(D_NUMBER, history%units), &
            'principal axes at t = 0, a row each, global components', error)
      end associate
   end subroutine write_constants

   !> Write the names of joint types
   subroutine write_kinds(scope, type, error)
      type(group_scope_t), intent(inout) :: scope
      integer, intent(in) :: type(:)
      type(error_t), allocatable, intent(inout) :: error

      type(text_t), allocatable :: kind(:)
      integer :: i, row

      allocate (kind(size(type)))
      do i = 1, size(kind)
         kind(i)%s = ''
         row = find_joint_type(type(i))
         if (row > 0) kind(i)%s = trim(joint_types(row)%name)
      end do
      call write_labels(scope, 'kind', kind, 'kind of the joint', error)
   end subroutine write_kinds

   !> Write texts over the entities; they become coordinates of the group's variables
   subroutine write_labels(scope, name, texts, meaning, error)
      type(group_scope_t), intent(inout) :: scope
      character(len=*), intent(in) :: name, meaning
      type(text_t), allocatable, intent(in) :: texts(:)
      type(error_t), allocatable, intent(inout) :: error

      type(text_t), allocatable :: utf8(:)
      integer(hid_t) :: id
      integer :: i

      if (.not. allocated(texts)) return
      allocate (utf8(size(texts)))
      do i = 1, size(texts)
         utf8(i)%s = ''
         if (allocated(texts(i)%s)) utf8(i)%s = as_utf8(texts(i)%s)
      end do
      call write_texts(scope%group, scope%forms, name, utf8, id, error)
      call attach_scales(scope%scales, id, [scope%entity], error)
      call put_text(id, 'long_name', meaning, error, scope%forms)
      call close_object(id, error)
      if (len(scope%coordinates) > 0) scope%coordinates = scope%coordinates//' '
      scope%coordinates = scope%coordinates//name
   end subroutine write_labels

   !> Write integers over the entities
   subroutine write_ids(scope, name, values, meaning, error)
      type(group_scope_t), intent(in) :: scope
      character(len=*), intent(in) :: name, meaning
      integer, intent(in) :: values(:)
      type(error_t), allocatable, intent(inout) :: error

      call write_constant(scope, name, [size(values)], real(values, wp), [scope%entity], '1', &
         meaning, error, AS_I32)
   end subroutine write_ids

   !> Write numbers over the entities
   subroutine write_constant(scope, name, dims, values, scales, units, meaning, error, kind)
      type(group_scope_t), intent(in) :: scope
      character(len=*), intent(in) :: name, units, meaning
      integer, intent(in) :: dims(:)               !! Fortran order
      real(wp), contiguous, intent(in) :: values(:)   !! (product(dims))
      integer(hid_t), intent(in) :: scales(:)      !! of each dimension
      type(error_t), allocatable, intent(inout) :: error
      integer, intent(in), optional :: kind        !! AS_ constant; AS_F64

      integer(hid_t) :: id
      integer :: stored

      stored = AS_F64
      if (present(kind)) stored = kind
      call write_numbers(scope%group, scope%forms, name, stored, dims, values, id, error)
      call attach_scales(scope%scales, id, scales, error)
      call put_text(id, 'units', units, error, scope%forms)
      call put_text(id, 'long_name', meaning, error, scope%forms)
      call close_object(id, error)
   end subroutine write_constant

   !> Write everything that is known before the first row
   subroutine write_layout(file, history, n_chunk, series, error)
      integer(hid_t), intent(in) :: file
      type(history_t), intent(in) :: history
      integer, intent(in) :: n_chunk               !! rows in a chunk
      integer(int64), intent(out) :: series(:)     !! where each dataset over time lies, -1 = none
      type(error_t), allocatable, intent(inout) :: error

      type(group_scope_t) :: root
      character(len=64) :: all_input
      character(len=64), allocatable :: input(:)
      integer(hid_t) :: id
      integer :: owner, i

      series = -1
      call find_digests(history, all_input, input)
      call put_root_attributes(file, history, all_input, error)
      root%group = file
      root%scales = new_scales()
      call start_forms(root%forms, error)
      root%coordinates = ''
      i = findloc(history%variable%channel, CH_TIME, 1)
      call write_variable(root, history, history%variable(i), n_chunk, root%time, series(i), error)
      do i = 1, size(history%variable)
         if (channels(history%variable(i)%channel)%owner /= OF_RUN .or. series(i) >= 0) cycle
         call write_variable(root, history, history%variable(i), n_chunk, id, series(i), error)
         call close_object(id, error)
      end do
      do owner = OF_JOINT, OF_SPRING
         call write_group(root, history, owner, n_chunk, series, error)
      end do
      if (allocated(history%shape%body)) call write_shape(root, history, error)
      call close_scale(root%scales, root%time, error)
      call free_scales(root%scales)
      call write_input(file, root%forms, history, input, error)
      call end_forms(root%forms)
   end subroutine write_layout

   !> SHA-256 of all decks one after the other, and of each. Of the first of several, or the only
   !> one, it is found on the way: decks may be large.
   pure subroutine find_digests(history, all_input, input)
      type(history_t), intent(in) :: history
      character(len=64), intent(out) :: all_input
      character(len=64), allocatable, intent(out) :: input(:)

      type(sha256_t) :: all, one
      integer :: i

      i = 0
      if (allocated(history%input_text)) i = size(history%input_text)
      allocate (input(i))
      do i = 1, size(input)
         call add_text(all, history%input_text(i)%s)
         one = sha256_t()
         if (i > 1) call add_text(one, history%input_text(i)%s)
         if (i == 1) one = all
         input(i) = digest_of(one)
      end do
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
      call put_number(file, 'kjoint_format_minor', AS_I32, 1.0_wp, error)
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
   subroutine write_group(root, history, owner, n_chunk, series, error)
      type(group_scope_t), intent(in) :: root
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner, n_chunk
      integer(int64), intent(inout) :: series(:)
      type(error_t), allocatable, intent(inout) :: error

      type(group_scope_t) :: scope
      integer(hid_t) :: id
      integer :: i

      if (n_entity(history, owner) == 0) return
      call create_group(root%group, trim(groups(owner)%path), scope%group, error)
      scope%time = root%time
      scope%scales = root%scales
      scope%forms = root%forms
      call put_text(scope%group, 'NX_class', 'NXdata', error)
      call put_signal(scope, history, owner, error)
      if (root%time >= 0) call link_to(root%group, '/time', scope%group, 'time', error)
      call write_scales(scope, history, owner, error)
      call write_constants(scope, history, owner, error)
      do i = 1, size(history%variable)
         if (channels(history%variable(i)%channel)%owner /= owner) cycle
         if (history%variable(i)%n_entity == 0) cycle
         call write_variable(scope, history, history%variable(i), n_chunk, id, series(i), error)
         call close_object(id, error)
      end do
      call close_scale(scope%scales, scope%entity, error)
      call close_scale(scope%scales, scope%axis, error)
      call close_scale(scope%scales, scope%quaternion, error)
      call close_scale(scope%scales, scope%axis6, error)
      call close_scale(scope%scales, scope%principal, error)
      call close_object(scope%group, error)
   end subroutine write_group

   !> Write the points and segments of the bodies, a group each: tables of their own
   subroutine write_shape(root, history, error)
      type(group_scope_t), intent(in) :: root
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(inout) :: error

      type(group_scope_t) :: scope

      associate (s => history%shape)
         if (size(s%body) == 0) return
         scope%scales = root%scales
         scope%forms = root%forms
         call open_table('point', size(s%body))
         call write_component_scale(scope%group, scope%forms, ['x', 'y', 'z'], 'component', &
            scope%axis, error)
         call write_ids(scope, 'body', s%body, 'user id of the rigid body', error)
         call write_ids(scope, 'node', s%node, 'user id of the node', error)
         call write_constant(scope, 'position', shape(s%point), reshape(s%point, &
            [size(s%point)]), [scope%axis, scope%entity], unit_text(D_LENGTH, history%units), &
            'from the centre of the body, in its axes: those of the world at t = 0', error)
         call close_scale(scope%scales, scope%axis, error)
         call close_table()
         if (size(s%segment, 2) == 0) return
         call open_table('segment', size(s%segment, 2))
         call write_ids(scope, 'point1', s%segment(1, :) - 1, 'first end, an index into /point', &
            error)
         call write_ids(scope, 'point2', s%segment(2, :) - 1, 'second end, an index into /point', &
            error)
         call close_table()
      end associate

   contains

      !> A group with a scale of its name, which counts from 0
      subroutine open_table(name, n)
         character(len=*), intent(in) :: name
         integer, intent(in) :: n

         integer :: i

         call create_group(root%group, name, scope%group, error)
         call write_number_scale(scope%group, scope%forms, name, [(i, i=0, n - 1)], &
            'index of the '//name, scope%entity, error)
      end subroutine open_table

      subroutine close_table()
         call close_scale(scope%scales, scope%entity, error)
         call close_object(scope%group, error)
      end subroutine close_table
   end subroutine write_shape

   !> What a NeXus viewer shows first: force of joints, position of the others, else what there is
   subroutine put_signal(scope, history, owner, error)
      type(group_scope_t), intent(in) :: scope
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
      call put_text(scope%group, 'signal', trim(channels(history%variable(best)%channel)%name), &
         error)
      allocate (axes(merge(2, 3, history%variable(best)%n_comp == 1)))
      axes(1)%s = 'time'
      axes(2)%s = trim(groups(owner)%entity)
      if (size(axes) == 3) axes(3)%s = component_name(history%variable(best)%n_comp)
      call put_texts(scope%group, 'axes', axes, [size(axes)], scope%forms, error)
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
   subroutine write_variable(scope, history, variable, n_chunk, id, place, error)
      type(group_scope_t), intent(in) :: scope
      type(history_t), intent(in) :: history
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: n_chunk
      integer(hid_t), intent(out) :: id
      integer(int64), intent(out) :: place
      type(error_t), allocatable, intent(inout) :: error

      integer, allocatable :: dims(:), chunk(:)
      integer(hid_t), allocatable :: scales(:)
      integer :: rank

      call get_row_shape(variable, dims)
      rank = size(dims) + 1
      allocate (chunk(rank))
      chunk = [dims, n_chunk]
      if (rank > 1) chunk(rank - 1) = entities_in_chunk(variable, n_chunk)
      call create_series(scope%group, scope%forms, trim(channels(variable%channel)%name), &
         channels(variable%channel)%kind, dims, chunk, id, error)
      if (variable%channel == CH_TIME) then
         call make_scale(id, 'time', error)
      else
         allocate (scales(rank))
         scales(rank) = scope%time
         if (rank > 1) scales(rank - 1) = scope%entity
         if (rank == 3) scales(1) = component_scale(scope, variable%n_comp)
         call attach_scales(scope%scales, id, scales, error)
      end if
      call put_variable_attributes(id, scope, history, variable%channel, error)
      call find_place(id, place, error)
   end subroutine write_variable

   subroutine put_variable_attributes(id, scope, history, row, error)
      integer(hid_t), intent(in) :: id
      type(group_scope_t), intent(in) :: scope
      type(history_t), intent(in) :: history
      integer, intent(in) :: row                   !! of the channel table
      type(error_t), allocatable, intent(inout) :: error

      integer :: i

      call put('units', unit_text(channels(row)%dim, history%units))
      call put('long_name', trim(channels(row)%meaning))
      call put('channel_class', trim(channels(row)%class))
      if (row == CH_TIME) call put('axis', 'T')
      if (channels(row)%frame /= '') call put('frame', trim(channels(row)%frame))
      if (channels(row)%radioss /= '') &
         call put('radioss_name', trim(channels(row)%radioss))
      call put('sampled_at', sampled_at(row, history%legacy))
      if (len(scope%coordinates) > 0) call put('coordinates', scope%coordinates)
      if (row == CH_OWNER_KIND) then
         call put_numbers(id, 'flag_values', AS_I8, [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp], error)
         call put('flag_meanings', 'none node body joint')
      end if
      if (row == CH_J_STATE) then
         call put_numbers(id, 'flag_values', AS_I8, [(real(i, wp), i=0, 5)], error)
         call put('flag_meanings', 'free sliding sticking at_stop locked blocked')
      end if
      if (row == CH_FINAL) then
         call put_numbers(id, 'flag_values', AS_I8, [0.0_wp, 1.0_wp], error)
         call put('flag_meanings', 'sample final_state')
      end if

   contains

      subroutine put(name, text)
         character(len=*), intent(in) :: name, text

         call put_text(id, name, text, error, scope%forms)
      end subroutine put
   end subroutine put_variable_attributes

   !> Write the deck files, a dataset each
   subroutine write_input(file, forms, history, digest, error)
      integer(hid_t), intent(in) :: file
      type(forms_t), intent(in) :: forms           !! of the file
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
            call write_text(group, forms, name, history%input_text(i)%s, id, error)
         else
            call write_text(group, forms, name, as_utf8(history%input_text(i)%s), id, error)
         end if
         call put_text(id, 'sha256', digest(i), error)
         call put_text(id, 'role', history%input_role(i)%s, error)
         call close_object(id, error)
      end do
      call close_object(group, error)
   end subroutine write_input

end module kj_h5_layout
