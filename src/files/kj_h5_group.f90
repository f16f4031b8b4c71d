!> What is constant in the group of one kind of entity: its scales, labels and numbers.
module kj_h5_group
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_utf8, only: as_utf8
   use kj_units, only: unit_text, D_NUMBER, D_MASS, D_INERTIA
   use kj_joint_types, only: joint_types, find_joint_type, DOF_NAME
   use kj_channels, only: channels, groups, OF_JOINT, OF_BODY, OF_NODE, OF_SPRING, AS_F64, AS_I32
   use kj_history, only: history_t, text_t
   use kj_h5, only: hid_t, close_object, put_text
   use kj_h5_data, only: make_scale, attach_scale
   use kj_h5_fixed, only: write_numbers, write_texts
   implicit none
   private

   public :: n_entity, component_name, component_scale, write_scales, write_constants

   !> What the datasets of one group share
   type, public :: group_scope_t
      integer(hid_t) :: group = -1
      integer(hid_t) :: time = -1, entity = -1                 !! the scales
      integer(hid_t) :: axis = -1, quaternion = -1, axis6 = -1   !! those over components
      character(len=:), allocatable :: coordinates                           !! @coordinates
   end type group_scope_t

contains

   !> Number of joints, bodies, nodes or springs
   pure integer function n_entity(history, owner) result(n)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner

      n = 0
      if (owner == OF_JOINT .and. allocated(history%joint_id)) n = size(history%joint_id)
      if (owner == OF_BODY .and. allocated(history%body_id)) n = size(history%body_id)
      if (owner == OF_NODE .and. allocated(history%node_id)) n = size(history%node_id)
      if (owner == OF_SPRING .and. allocated(history%spring_id)) n = size(history%spring_id)
   end function n_entity

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

      character(len=:), allocatable :: name, meaning
      integer, allocatable :: id(:)

      name = trim(groups(owner)%entity)
      allocate (id(n_entity(history, owner)))
      if (owner == OF_JOINT) id(:) = history%joint_id
      if (owner == OF_BODY) id(:) = history%body_id
      if (owner == OF_NODE) id(:) = history%node_id
      if (owner == OF_SPRING) id(:) = history%spring_id
      meaning = 'user id of the '//name
      if (owner == OF_JOINT) meaning = 'user id of the spring element'
      if (owner == OF_BODY) meaning = 'user id of the rigid body'
      call write_numbers(scope%group, name, AS_I32, [size(id)], real(id, wp), scope%entity, error)
      call make_scale(scope%entity, name, error)
      call put_text(scope%entity, 'units', '1', error)
      call put_text(scope%entity, 'long_name', meaning, error)
      call write_component_scale(scope%group, ['x', 'y', 'z'], 'component', scope%axis, error)
      if (has_variable(history, owner, 4)) call write_component_scale(scope%group, &
         ['w', 'x', 'y', 'z'], 'component of the quaternion', scope%quaternion, error)
      if (has_variable(history, owner, 6)) call write_component_scale(scope%group, DOF_NAME, &
         'direction of the joint', scope%axis6, error)
   end subroutine write_scales

   !> A variable of this owner has n_comp components
   pure logical function has_variable(history, owner, n_comp)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner, n_comp

      has_variable = any(channels(history%variable%channel)%owner == owner .and. &
         history%variable%n_comp == n_comp)
   end function has_variable

   !> Write the scale over components, a name each, and leave it open
   subroutine write_component_scale(group, components, meaning, id, error)
      integer(hid_t), intent(in) :: group
      character(len=*), intent(in) :: components(:), meaning
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      type(text_t) :: names(size(components))
      integer :: i

      do i = 1, size(components)
         names(i)%s = trim(components(i))
      end do
      call write_texts(group, component_name(size(components)), names, id, error)
      call make_scale(id, component_name(size(components)), error)
      call put_text(id, 'long_name', meaning, error)
   end subroutine write_component_scale

   !> Write labels and numbers of the entities; texts become @coordinates of the scope
   subroutine write_constants(scope, history, owner, error)
      type(group_scope_t), intent(inout) :: scope
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner                 !! OF_ constant
      type(error_t), allocatable, intent(inout) :: error

      scope%coordinates = ''
      if (owner == OF_JOINT) call write_joints(scope, history, error)
      if (owner == OF_BODY) call write_bodies(scope, history, error)
      if (owner == OF_SPRING) call write_springs(scope, history, error)
      if (owner == OF_NODE) call write_labels(scope, 'label', history%node_label, &
         'name of the node', error)
   end subroutine write_constants

   !> What is constant of each joint
   subroutine write_joints(scope, history, error)
      type(group_scope_t), intent(inout) :: scope
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(inout) :: error

      type(text_t), allocatable :: kind(:)
      integer :: i, row

      call write_labels(scope, 'label', history%joint_label, 'title of the part', error)
      if (allocated(history%joint_type)) then
         allocate (kind(size(history%joint_type)))
         do i = 1, size(kind)
            kind(i)%s = ''
            row = find_joint_type(history%joint_type(i))
            if (row > 0) kind(i)%s = trim(joint_types(row)%name)
         end do
         call write_labels(scope, 'kind', kind, 'kind of the joint', error)
         call write_ids(scope, 'type', history%joint_type, 'joint type number', error)
      end if
      if (allocated(history%joint_property)) &
         call write_ids(scope, 'property', history%joint_property, 'user id of the property', error)
      call write_ends(scope, history%joint_node, history%joint_body, error)
   end subroutine write_joints

   !> What is constant of each spring
   subroutine write_springs(scope, history, error)
      type(group_scope_t), intent(inout) :: scope
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(inout) :: error

      call write_labels(scope, 'label', history%spring_label, 'title of the part', error)
      if (allocated(history%spring_type)) &
         call write_ids(scope, 'type', history%spring_type, 'type of the property: 4 or 8', error)
      if (allocated(history%spring_property)) call write_ids(scope, 'property', &
         history%spring_property, 'user id of the property', error)
      call write_ends(scope, history%spring_node, history%spring_body, error)
   end subroutine write_springs

   !> Nodes of joints or springs and the bodies that carry them
   subroutine write_ends(scope, node, body, error)
      type(group_scope_t), intent(in) :: scope
      integer, allocatable, intent(in) :: node(:, :), body(:, :)   !! (2, n) user ids
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(node)) then
         call write_ids(scope, 'node1', node(1, :), 'user id of node 1', error)
         call write_ids(scope, 'node2', node(2, :), 'user id of node 2', error)
      end if
      if (allocated(body)) then
         call write_ids(scope, 'body1', body(1, :), &
            'user id of the rigid body of node 1, 0 = none', error)
         call write_ids(scope, 'body2', body(2, :), &
            'user id of the rigid body of node 2, 0 = none', error)
      end if
   end subroutine write_ends

   !> What is constant of each rigid body
   subroutine write_bodies(scope, history, error)
      type(group_scope_t), intent(inout) :: scope
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(inout) :: error

      integer :: n

      n = size(history%body_id)
      call write_labels(scope, 'label', history%body_label, 'title of the rigid body', error)
      if (allocated(history%body_main_node)) call write_ids(scope, 'main_node', &
         history%body_main_node, 'user id of the main node', error)
      if (allocated(history%body_mass)) call write_constant(scope, 'mass', [n], &
         history%body_mass, [scope%entity], unit_text(D_MASS, history%units), &
         'mass of the rigid body', error)
      if (allocated(history%body_inertia)) call write_constant(scope, 'inertia_principal', [3, n], &
         reshape(history%body_inertia, [3*n]), [scope%axis, scope%entity], &
         unit_text(D_INERTIA, history%units), 'principal moments of inertia', error)
      if (allocated(history%body_axes)) call write_constant(scope, 'principal_axes', [3, 3, n], &
         reshape(history%body_axes, [9*n]), [scope%axis, scope%axis, scope%entity], &
         unit_text(D_NUMBER, history%units), &
         'principal axes at t = 0, a row each, global components', error)
   end subroutine write_bodies

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
      call write_texts(scope%group, name, utf8, id, error)
      call attach_scale(id, scope%entity, 1, 1, error)
      call put_text(id, 'long_name', meaning, error)
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

      integer(hid_t) :: id

      call write_numbers(scope%group, name, AS_I32, [size(values)], real(values, wp), id, error)
      call attach_scale(id, scope%entity, 1, 1, error)
      call put_text(id, 'units', '1', error)
      call put_text(id, 'long_name', meaning, error)
      call close_object(id, error)
   end subroutine write_ids

   !> Write reals over the entities
   subroutine write_constant(scope, name, dims, values, scales, units, meaning, error)
      type(group_scope_t), intent(in) :: scope
      character(len=*), intent(in) :: name, units, meaning
      integer, intent(in) :: dims(:)               !! Fortran order
      real(wp), contiguous, intent(in) :: values(:)   !! (product(dims))
      integer(hid_t), intent(in) :: scales(:)      !! of each dimension
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: id
      integer :: i

      call write_numbers(scope%group, name, AS_F64, dims, values, id, error)
      do i = 1, size(dims)
         call attach_scale(id, scales(i), i, size(dims), error)
      end do
      call put_text(id, 'units', units, error)
      call put_text(id, 'long_name', meaning, error)
      call close_object(id, error)
   end subroutine write_constant

end module kj_h5_group
