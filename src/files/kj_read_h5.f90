!> Reads a history file: first what it holds, then its rows in blocks as large as the caller likes.
!> Groups, datasets and attributes it does not know are ignored.
module kj_read_h5
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_channels, only: channels, groups, OF_JOINT, OF_SPRING, AT_T
   use kj_history, only: history_t, add_variable, n_entity
   use kj_series, only: channel_path
   use kj_text, only: text_t
   use kj_h5, only: hid_t, start_hdf5, open_file, close_file, close_object, has_link
   use kj_h5_read, only: open_object, get_shape, read_rows, read_texts, get_link_names, get_text, &
      get_numbers, get_facts, read_numbers
   use kj_h5_layout, only: get_row_shape
   implicit none
   private

   public :: h5_reader_t, open_h5_history, read_h5_rows, close_h5_history, read_run_facts

   !> An open history file
   type :: h5_reader_t
      integer :: n_row = 0                                   !! rows that every variable has
      integer :: most_row = 0                                !! that one of them has
      character(len=:), allocatable :: path
      type(history_t), private :: history                    !! what a row holds
      integer(hid_t), private :: file = -1
      integer(hid_t), allocatable, private :: series(:)      !! datasets of the variables
   end type h5_reader_t

   integer, parameter :: FORMAT_MAJOR = 1                    !! newest layout this module reads

contains

   !> Open a history. Errors: ERR_FILE when it is no history or a damaged one; nothing stays open
   subroutine open_h5_history(path, reader, history, n_row, error)
      character(len=*), intent(in) :: path
      type(h5_reader_t), intent(out) :: reader
      type(history_t), intent(out) :: history
      integer, intent(out) :: n_row
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      integer :: owner

      n_row = 0
      reader%path = path
      allocate (history%variable(0))
      call start_hdf5(error)
      call open_file(path, reader%file, error)
      if (.not. allocated(error)) call read_root(reader%file, history, error)
      if (.not. allocated(error)) then
         do owner = OF_JOINT, OF_SPRING
            if (.not. has_link(reader%file, trim(groups(owner)%path))) cycle
            call read_entities(reader%file, owner, history, error)
         end do
         if (has_link(reader%file, 'input')) call read_input(reader%file, history, error)
         call find_variables(reader, history, error)
      end if
      if (allocated(error)) then
         error%file = path
         call close_h5_history(reader, closing)
         return
      end if
      reader%history = history
      n_row = reader%n_row
   end subroutine open_h5_history

   !> Close a history, also one that was not opened
   subroutine close_h5_history(reader, error)
      type(h5_reader_t), intent(inout) :: reader
      type(error_t), allocatable, intent(out) :: error

      call close_file(reader%file, error)
      if (allocated(reader%series)) deallocate (reader%series)
      reader%n_row = 0
   end subroutine close_h5_history

   !> Read n rows from row `first`. Errors: ERR_FILE
   subroutine read_h5_rows(reader, first, n, rows, error)
      type(h5_reader_t), intent(in) :: reader
      integer, intent(in) :: first, n               !! 1 <= first, first + n - 1 <= n_row
      real(wp), intent(out) :: rows(:, :)           !! (n_value, n) as history%variable says
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: dims(:)
      real(wp), allocatable :: values(:)
      integer :: i, row, width, at

      rows = 0.0_wp
      if (first < 1 .or. n < 0 .or. first + n - 1 > reader%n_row .or. &
         size(rows, 1) /= reader%history%n_value .or. size(rows, 2) < n) then
         call fail(error, ERR_FILE, 'rows '//str(first)//' to '//str(first + n - 1)// &
            ' are not in the history')
         return
      end if
      do i = 1, size(reader%series)
         call get_row_shape(reader%history%variable(i), dims)
         width = product(dims)
         at = reader%history%variable(i)%first
         allocate (values(width*n))
         call read_rows(reader%series(i), dims, first, n, values, error)
         if (allocated(error)) exit
         do row = 1, n
            rows(at:at + width - 1, row) = values((row - 1)*width + 1:row*width)
         end do
         deallocate (values)
      end do
      if (allocated(error)) error%file = reader%path
   end subroutine read_h5_rows

   !> The attributes of /run as text, in the order written. Errors: ERR_FILE
   subroutine read_run_facts(reader, names, values, error)
      type(h5_reader_t), intent(in) :: reader
      type(text_t), allocatable, intent(out) :: names(:), values(:)
      type(error_t), allocatable, intent(out) :: error

      integer(hid_t) :: group

      allocate (names(0), values(0))
      if (.not. has_link(reader%file, 'run')) return
      deallocate (names, values)
      call open_object(reader%file, 'run', group, error)
      call get_facts(group, names, values, error)
      call close_object(group, error)
   end subroutine read_run_facts

   !> Read the attributes of the root. Errors: ERR_FILE when this is no history we know
   subroutine read_root(file, history, error)
      integer(hid_t), intent(in) :: file
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      character(len=*), parameter :: UNIT_NAMES(3) = ['unit_mass  ', 'unit_length', 'unit_time  ']
      character(len=:), allocatable :: text
      real(wp) :: major(1)
      logical :: found
      integer :: i

      call get_numbers(file, 'kjoint_format_major', major, found, error)
      if (allocated(error)) return
      if (found) found = has_link(file, 'time')
      if (.not. found) then
         call fail(error, ERR_FILE, 'this HDF5 file is no history of kjoint')
         return
      end if
      if (nint(major(1)) > FORMAT_MAJOR) then
         call fail(error, ERR_FILE, 'the history has layout '//str(nint(major(1)))// &
            ', newer than this kjoint reads')
         return
      end if
      call get_text(file, 'title', history%title, error)
      do i = 1, 3
         call get_text(file, trim(UNIT_NAMES(i)), text, error)
         if (len(text) > 0) history%units%symbol(i) = text
      end do
      call get_numbers(file, 'unit_si', history%units%si, found, error)
      call get_text(file, 'precision', text, error)
      history%single_precision = text == 'single'
   end subroutine read_root

   !> Read the deck files
   subroutine read_input(file, history, error)
      integer(hid_t), intent(in) :: file
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      type(text_t), allocatable :: text(:)
      integer(hid_t) :: group, id
      integer :: i

      call open_object(file, 'input', group, error)
      call get_link_names(group, history%input_name, error)
      if (.not. allocated(error)) then
         allocate (history%input_text(size(history%input_name)))
         allocate (history%input_role(size(history%input_name)))
         do i = 1, size(history%input_name)
            call read_texts(group, history%input_name(i)%s, text, error)
            call open_object(group, history%input_name(i)%s, id, error)
            call get_text(id, 'role', history%input_role(i)%s, error)
            call close_object(id, error)
            if (allocated(error)) exit
            history%input_text(i)%s = ''
            if (size(text) == 1) history%input_text(i)%s = text(1)%s
         end do
      end if
      call close_object(group, error)
   end subroutine read_input

   !> Find the variables of the channel table that the file has, time first, and open them
   subroutine find_variables(reader, history, error)
      type(h5_reader_t), intent(inout) :: reader
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: id
      character(len=:), allocatable :: name, level
      integer :: row, n

      allocate (reader%series(0))
      history%legacy = .false.
      reader%n_row = huge(1)
      do row = 1, size(channels)
         if (allocated(error)) return
         n = n_entity(history, channels(row)%owner)
         name = channel_path(row)
         if (n == 0) cycle
         if (.not. has_link(reader%file, name)) cycle
         call open_object(reader%file, name, id, error)
         reader%series = [reader%series, id]
         call add_variable(history, row, n)
         call check_shape(reader, history, id, name, error)
         call get_text(id, 'sampled_at', level, error)
         if (channels(row)%at /= AT_T .and. len(level) > 1) history%legacy = .true.
      end do
   end subroutine find_variables

   !> Test the shape of the variable found last; rows count as far as every variable has them
   subroutine check_shape(reader, history, id, name, error)
      type(h5_reader_t), intent(inout) :: reader
      type(history_t), intent(in) :: history
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(inout) :: error

      integer, allocatable :: expected(:), dims(:)

      call get_shape(id, dims, error)
      if (allocated(error)) return
      call get_row_shape(history%variable(size(history%variable)), expected)
      if (size(dims) == size(expected) + 1) then
         if (all(dims(:size(expected)) == expected)) then
            reader%n_row = min(reader%n_row, dims(size(dims)))
            reader%most_row = max(reader%most_row, dims(size(dims)))
            return
         end if
      end if
      call fail(error, ERR_FILE, 'the dataset '//name//' has another shape than expected')
   end subroutine check_shape

   !> Read the entities of one group: ids, labels and constants, as far as they are there
   subroutine read_entities(file, owner, history, error)
      integer(hid_t), intent(in) :: file
      integer, intent(in) :: owner
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: group, scale
      real(wp), allocatable :: values(:)
      integer, allocatable :: dims(:)
      integer :: n

      call open_object(file, trim(groups(owner)%path), group, error)
      call open_object(group, trim(groups(owner)%entity), scale, error)
      call get_shape(scale, dims, error)
      call close_object(scale, error)
      if (.not. allocated(error)) then
         if (size(dims) /= 1) call fail(error, ERR_FILE, 'the scale of '// &
            trim(groups(owner)%path)//' has no single dimension')
      end if
      if (.not. allocated(error)) then
         n = dims(1)
         associate (e => history%entity(owner))
            call read_ids(group, trim(groups(owner)%entity), n, e%id, error)
            call read_labels(group, n, e%label, error)
            call read_ids(group, 'type', n, e%type, error)
            call read_ids(group, 'property', n, e%property, error)
            call read_pairs(group, 'node', n, e%node, error)
            call read_pairs(group, 'body', n, e%body, error)
            call read_ids(group, 'skew', n, e%skew, error)
            call read_blocking(group, n, e%blocking, error)
            call read_ids(group, 'main_node', n, e%main_node, error)
            call read_reals(group, 'mass', n, e%mass, error)
            call read_reals(group, 'inertia_principal', 3*n, values, error)
            if (allocated(values)) e%inertia = reshape(values, [3, n])
            call read_reals(group, 'principal_axes', 9*n, values, error)
            if (allocated(values)) e%axes = reshape(values, [3, 3, n])
         end associate
      end if
      call close_object(group, error)
   end subroutine read_entities

   !> Read the stiffness of the blocked directions, (2, n)
   subroutine read_blocking(group, n, blocking, error)
      integer(hid_t), intent(in) :: group
      integer, intent(in) :: n
      real(wp), allocatable, intent(out) :: blocking(:, :)
      type(error_t), allocatable, intent(inout) :: error

      real(wp), allocatable :: trans(:), rot(:)

      call read_reals(group, 'blocking_trans', n, trans, error)
      call read_reals(group, 'blocking_rot', n, rot, error)
      if (.not. allocated(trans) .or. .not. allocated(rot)) return
      allocate (blocking(2, n))
      blocking(1, :) = trans
      blocking(2, :) = rot
   end subroutine read_blocking

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

end module kj_read_h5
