!> Reads what a history file says once of its joints, springs, rigid bodies and nodes.
module kj_read_h5_group
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_channels, only: groups, OF_JOINT, OF_BODY, OF_NODE, OF_SPRING
   use kj_history, only: history_t, text_t
   use kj_h5, only: hid_t, close_object, has_link
   use kj_h5_read, only: open_group, open_dataset, get_shape, read_numbers, read_texts
   implicit none
   private

   public :: read_entities

contains

   !> Read the entities of one group: ids, labels and constants, as far as they are there
   subroutine read_entities(file, owner, history, error)
      integer(hid_t), intent(in) :: file
      integer, intent(in) :: owner
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: group, scale
      integer, allocatable :: dims(:)
      integer :: n

      call open_group(file, trim(groups(owner)%path), group, error)
      call open_dataset(group, trim(groups(owner)%entity), scale, error)
      call get_shape(scale, dims, error)
      call close_object(scale, error)
      if (.not. allocated(error)) then
         if (size(dims) /= 1) call fail(error, ERR_FILE, 'the scale of '// &
            trim(groups(owner)%path)//' has no single dimension')
      end if
      if (.not. allocated(error)) then
         n = dims(1)
         if (owner == OF_JOINT) call read_joints(group, n, history, error)
         if (owner == OF_BODY) call read_bodies(group, n, history, error)
         if (owner == OF_SPRING) call read_springs(group, n, history, error)
         if (owner == OF_NODE) then
            call read_ids(group, 'node', n, history%node_id, error)
            call read_labels(group, n, history%node_label, error)
         end if
      end if
      call close_object(group, error)
   end subroutine read_entities

   !> Read what is constant of each spring
   subroutine read_springs(group, n, history, error)
      integer(hid_t), intent(in) :: group
      integer, intent(in) :: n
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      call read_ids(group, 'spring', n, history%spring_id, error)
      call read_labels(group, n, history%spring_label, error)
      call read_ids(group, 'type', n, history%spring_type, error)
      call read_ids(group, 'property', n, history%spring_property, error)
      call read_pairs(group, 'node', n, history%spring_node, error)
      call read_pairs(group, 'body', n, history%spring_body, error)
   end subroutine read_springs

   !> Read what is constant of each joint
   subroutine read_joints(group, n, history, error)
      integer(hid_t), intent(in) :: group
      integer, intent(in) :: n
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      call read_ids(group, 'joint', n, history%joint_id, error)
      call read_labels(group, n, history%joint_label, error)
      call read_ids(group, 'type', n, history%joint_type, error)
      call read_ids(group, 'property', n, history%joint_property, error)
      call read_pairs(group, 'node', n, history%joint_node, error)
      call read_pairs(group, 'body', n, history%joint_body, error)
   end subroutine read_joints

   !> Read what is constant of each rigid body
   subroutine read_bodies(group, n, history, error)
      integer(hid_t), intent(in) :: group
      integer, intent(in) :: n
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      real(wp), allocatable :: values(:)

      call read_ids(group, 'body', n, history%body_id, error)
      call read_labels(group, n, history%body_label, error)
      call read_ids(group, 'main_node', n, history%body_main_node, error)
      call read_reals(group, 'mass', n, history%body_mass, error)
      call read_reals(group, 'inertia_principal', 3*n, values, error)
      if (allocated(values)) allocate (history%body_inertia(3, n))
      if (allocated(values)) history%body_inertia(:, :) = reshape(values, [3, n])
      call read_reals(group, 'principal_axes', 9*n, values, error)
      if (allocated(values)) allocate (history%body_axes(3, 3, n))
      if (allocated(values)) history%body_axes(:, :, :) = reshape(values, [3, 3, n])
   end subroutine read_bodies

   !> Read n reals; they stay unallocated when there is no such dataset
   subroutine read_reals(group, name, n, values, error)
      integer(hid_t), intent(in) :: group
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      real(wp), allocatable, intent(out) :: values(:)
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (.not. has_link(group, name)) return
      allocate (values(n))
      call read_numbers(group, name, values, error)
   end subroutine read_reals

   !> Read n integers; they stay unallocated when there is no such dataset
   subroutine read_ids(group, name, n, ids, error)
      integer(hid_t), intent(in) :: group
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: ids(:)
      type(error_t), allocatable, intent(inout) :: error

      real(wp), allocatable :: values(:)

      call read_reals(group, name, n, values, error)
      if (.not. allocated(values)) return
      allocate (ids(n))
      ids(:) = nint(min(max(values, -real(huge(1), wp)), real(huge(1), wp)))
   end subroutine read_ids

   !> Read the two datasets `name`1 and `name`2 of integers into (2, n)
   subroutine read_pairs(group, name, n, pairs, error)
      integer(hid_t), intent(in) :: group
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: pairs(:, :)
      type(error_t), allocatable, intent(inout) :: error

      integer, allocatable :: first(:), second(:)

      call read_ids(group, name//'1', n, first, error)
      call read_ids(group, name//'2', n, second, error)
      if (.not. allocated(first) .or. .not. allocated(second)) return
      allocate (pairs(2, n))
      pairs(1, :) = first
      pairs(2, :) = second
   end subroutine read_pairs

   !> Read the labels; they stay unallocated when there are none
   subroutine read_labels(group, n, labels, error)
      integer(hid_t), intent(in) :: group
      integer, intent(in) :: n
      type(text_t), allocatable, intent(out) :: labels(:)
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (.not. has_link(group, 'label')) return
      call read_texts(group, 'label', labels, error)
      if (allocated(error)) return
      if (size(labels) /= n) call fail(error, ERR_FILE, 'there are '//str(size(labels))// &
         ' labels for '//str(n)//' entities')
   end subroutine read_labels

end module kj_read_h5_group
