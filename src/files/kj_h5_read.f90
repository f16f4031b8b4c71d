!> Reading HDF5 datasets, names and attributes; the conventions are those of kj_h5. A file may hold
!> anything, so every shape and type is tested before memory is asked for.
!> One file: all that reads numbers and texts.
module kj_h5_read
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
   use hdf5, only: hid_t, hsize_t, h5oopen_f, h5gget_info_f, h5dread_f, h5dget_space_f, &
      h5dget_type_f, h5dvlen_reclaim_f, h5lget_name_by_idx_f, h5screate_simple_f, h5sclose_f, &
      h5sselect_hyperslab_f, h5sget_simple_extent_ndims_f, h5sget_simple_extent_dims_f, &
      h5tclose_f, h5tis_variable_str_f, H5P_DEFAULT_F, H5S_SELECT_SET_F, H5T_NATIVE_DOUBLE, &
      H5_INDEX_CRT_ORDER_F, H5_ITER_INC_F, size_t, h5aopen_f, h5aopen_by_idx_f, h5aread_f, &
      h5aclose_f, h5aexists_f, h5aget_num_attrs_f, h5aget_name_f, h5aget_type_f, h5aget_space_f, &
      h5sget_simple_extent_npoints_f, h5tget_class_f, H5T_INTEGER_F, H5T_FLOAT_F, &
      H5T_STD_U8LE
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_system, only: c_text
   use kj_text, only: text_t
   use kj_h5, only: check, close_object, utf8_type
   use, intrinsic :: iso_fortran_env, only: int8, int64
   implicit none
   private

   public :: open_object, get_shape, read_rows, read_numbers, read_texts, read_bytes, &
      get_link_names, get_text, get_numbers, get_facts

contains

   !> Open a group or dataset
   subroutine open_object(parent, name, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      id = -1
      if (allocated(error)) return
      call h5oopen_f(parent, name, id, status)
      call check(status, 'open '//name, error)
   end subroutine open_object

   !> Shape of a dataset in Fortran order, size 0 for a scalar
   subroutine get_shape(id, dims, error)
      integer(hid_t), intent(in) :: id
      integer, allocatable, intent(out) :: dims(:)
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space
      integer(hsize_t), allocatable :: now(:), most(:)
      integer :: status, rank, ignored

      allocate (dims(0))
      if (allocated(error)) return
      rank = 0
      call h5dget_space_f(id, space, status)
      if (status < 0) space = -1
      if (status >= 0) call h5sget_simple_extent_ndims_f(space, rank, status)
      if (status >= 0 .and. rank > 0) then
         allocate (now(rank), most(rank))
         call h5sget_simple_extent_dims_f(space, now, most, status)
         if (status >= 0 .and. any(now > huge(1))) status = -1
         deallocate (dims)
         allocate (dims(rank))
         dims = 0
         if (status >= 0) dims = int(now)
      end if
      if (space > 0) call h5sclose_f(space, ignored)
      call check(status, 'read the shape of a dataset', error)
   end subroutine get_shape

   !> Read rows of a dataset over time
   subroutine read_rows(id, dims, first, n, values, error)
      integer(hid_t), intent(in) :: id
      integer, intent(in) :: dims(:)               !! shape of one row, Fortran order
      integer, intent(in) :: first, n              !! the first row, from 1; how many
      real(wp), contiguous, target, intent(out) :: values(:)   !! (product(dims)*n)
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space, memory
      integer(hsize_t) :: start(size(dims) + 1), block(size(dims) + 1)
      type(c_ptr) :: address
      integer :: status, ignored

      values = 0.0_wp
      if (allocated(error) .or. n < 1) return
      memory = -1
      start = 0
      start(size(start)) = first - 1
      block = [int(dims, hsize_t), int(n, hsize_t)]
      call h5dget_space_f(id, space, status)
      if (status < 0) space = -1
      if (status >= 0) call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start, block, status)
      ! a memory space of the same shape: another one makes the library walk element by element
      if (status >= 0) call h5screate_simple_f(size(block), block, memory, status)
      address = c_loc(values)
      if (status >= 0) call h5dread_f(id, H5T_NATIVE_DOUBLE, address, status, memory, space)
      if (space > 0) call h5sclose_f(space, ignored)
      if (memory > 0) call h5sclose_f(memory, ignored)
      call check(status, 'read rows from '//str(first), error)
   end subroutine read_rows

   !> Read a whole dataset of numbers. Errors: also when it holds another number of them
   subroutine read_numbers(parent, name, values, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      real(wp), contiguous, target, intent(out) :: values(:)
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: id
      integer, allocatable :: dims(:)
      integer :: status
      type(c_ptr) :: address

      values = 0.0_wp
      call open_object(parent, name, id, error)
      call get_shape(id, dims, error)
      if (.not. allocated(error)) then
         if (product(int(dims, hsize_t)) /= size(values)) then
            call fail(error, ERR_FILE, 'the dataset '//name//' has another shape than expected')
         else if (size(values) > 0) then
            address = c_loc(values)
            call h5dread_f(id, H5T_NATIVE_DOUBLE, address, status)
            call check(status, 'read the dataset '//name, error)
         end if
      end if
      call close_object(id, error)
   end subroutine read_numbers

   !> Read a dataset of bytes
   subroutine read_bytes(parent, name, byte, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer(int8), allocatable, target, intent(out) :: byte(:)
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: id
      integer, allocatable :: dims(:)
      integer :: status
      type(c_ptr) :: address

      call open_object(parent, name, id, error)
      call get_shape(id, dims, error)
      if (.not. allocated(error)) then
         allocate (byte(product(dims)))
         if (size(byte) > 0) then
            address = c_loc(byte)
            call h5dread_f(id, H5T_STD_U8LE, address, status)
            call check(status, 'read the dataset '//name, error)
         end if
      end if
      call close_object(id, error)
   end subroutine read_bytes

   !> Read a dataset of texts, scalar or one-dimensional
   subroutine read_texts(parent, name, texts, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      type(text_t), allocatable, intent(out) :: texts(:)
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: id, utf8, stored, space
      integer, allocatable :: dims(:)
      type(c_ptr), allocatable, target :: pointers(:)
      type(c_ptr) :: address
      logical :: variable_length
      integer :: status, ignored

      allocate (texts(0))
      call utf8_type(utf8, error)
      call open_object(parent, name, id, error)
      call get_shape(id, dims, error)
      if (.not. allocated(error)) then
         variable_length = .false.
         space = -1
         call h5dget_type_f(id, stored, status)
         if (status >= 0) call h5tis_variable_str_f(stored, variable_length, status)
         if (.not. variable_length .or. size(dims) > 1) status = -1
         if (status < 0) dims = [0]
         deallocate (texts)
         allocate (pointers(product(dims)), texts(product(dims)))
         if (status >= 0) call h5dget_space_f(id, space, status)
         address = c_loc(pointers)
         if (status >= 0 .and. size(pointers) > 0) call h5dread_f(id, utf8, address, status)
         if (status >= 0) call copy_texts(pointers, texts)
         if (status >= 0) call h5dvlen_reclaim_f(utf8, space, H5P_DEFAULT_F, address, ignored)
         if (space > 0) call h5sclose_f(space, ignored)
         if (stored > 0) call h5tclose_f(stored, ignored)
         call check(status, 'read the texts '//name, error)
      end if
      call close_object(id, error)
      if (utf8 > 0) call h5tclose_f(utf8, ignored)
   end subroutine read_texts

   !> Texts of C pointers; a null pointer is an empty text
   subroutine copy_texts(pointers, texts)
      type(c_ptr), intent(in) :: pointers(:)
      type(text_t), intent(inout) :: texts(:)      !! (size(pointers))

      integer :: i

      do i = 1, size(pointers)
         call c_text(pointers(i), texts(i)%s)
      end do
   end subroutine copy_texts

   !> Names of what is in a group, in the order of creation
   subroutine get_link_names(group, names, error)
      integer(hid_t), intent(in) :: group
      type(text_t), allocatable, intent(out) :: names(:)
      type(error_t), allocatable, intent(inout) :: error

      character(len=1024) :: name
      integer :: status, i, n, storage, most

      allocate (names(0))
      if (allocated(error)) return
      call h5gget_info_f(group, storage, n, most, status)
      if (status >= 0) then
         deallocate (names)
         allocate (names(n))
         do i = 1, n
            name = ''
            if (status >= 0) call h5lget_name_by_idx_f(group, '.', H5_INDEX_CRT_ORDER_F, &
               H5_ITER_INC_F, int(i - 1, hsize_t), name, status)
            names(i)%s = trim(name)
         end do
      end if
      call check(status, 'read the names in a group', error)
   end subroutine get_link_names

   !> Text of an attribute; empty when it is not there
   subroutine get_text(id, name, text, error)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(out) :: text
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: attribute
      logical :: exists
      integer :: status, ignored

      text = ''
      if (allocated(error)) return
      call h5aexists_f(id, name, exists, status)
      if (status >= 0 .and. .not. exists) return
      if (status >= 0) call h5aopen_f(id, name, attribute, status)
      if (status >= 0) then
         call get_attribute_text(attribute, text, status)
         call h5aclose_f(attribute, ignored)
      end if
      call check(status, 'read the attribute '//name, error)
   end subroutine get_text

   !> Numbers of an attribute; not found when it is not there or holds another number of them
   subroutine get_numbers(id, name, values, found, error)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      real(wp), contiguous, target, intent(inout) :: values(:)   !! unchanged unless found
      logical, intent(out) :: found
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: attribute, space
      integer(hsize_t) :: n
      type(c_ptr) :: address
      integer :: status, ignored

      found = .false.
      if (allocated(error)) return
      call h5aexists_f(id, name, found, status)
      if (status < 0) found = .false.
      if (.not. found) return
      n = 0
      space = -1
      call h5aopen_f(id, name, attribute, status)
      if (status < 0) attribute = -1
      if (status >= 0) call h5aget_space_f(attribute, space, status)
      if (status >= 0) call h5sget_simple_extent_npoints_f(space, n, status)
      found = n == size(values)
      address = c_loc(values)
      if (status >= 0 .and. found) call h5aread_f(attribute, H5T_NATIVE_DOUBLE, address, status)
      if (space > 0) call h5sclose_f(space, ignored)
      if (attribute > 0) call h5aclose_f(attribute, ignored)
      call check(status, 'read the attribute '//name, error)
   end subroutine get_numbers

   !> Every attribute of an object as text, in the order of creation
   subroutine get_facts(id, names, values, error)
      integer(hid_t), intent(in) :: id
      type(text_t), allocatable, intent(out) :: names(:), values(:)
      type(error_t), allocatable, intent(inout) :: error

      character(len=256) :: name
      integer(hid_t) :: attribute
      integer :: status, ignored, i, n

      allocate (names(0), values(0))
      if (allocated(error)) return
      call h5aget_num_attrs_f(id, n, status)
      if (status >= 0) then
         deallocate (names, values)
         allocate (names(n), values(n))
         do i = 1, n
            names(i)%s = ''
            values(i)%s = ''
            if (status < 0) cycle
            call h5aopen_by_idx_f(id, '.', H5_INDEX_CRT_ORDER_F, H5_ITER_INC_F, &
               int(i - 1, hsize_t), attribute, status)
            if (status < 0) cycle
            name = ''
            call h5aget_name_f(attribute, len(name, size_t), name, status)
            names(i)%s = trim(name)
            if (status >= 0) call get_attribute_text(attribute, values(i)%s, status)
            call h5aclose_f(attribute, ignored)
         end do
      end if
      call check(status, 'read the attributes', error)
   end subroutine get_facts

   !> Value of an open attribute as text, several separated by blanks
   subroutine get_attribute_text(attribute, text, status)
      integer(hid_t), intent(in) :: attribute
      character(len=:), allocatable, intent(out) :: text
      integer, intent(out) :: status

      integer(hid_t) :: stored, space
      integer(hsize_t) :: n
      integer :: type_class, ignored, i
      logical :: variable_length
      character(len=24) :: number
      type(text_t), allocatable :: texts(:)
      real(wp), allocatable, target :: values(:)
      type(c_ptr) :: address

      text = ''
      n = 0
      type_class = -1
      space = -1
      variable_length = .false.
      call h5aget_type_f(attribute, stored, status)
      if (status < 0) stored = -1
      if (status >= 0) call h5tget_class_f(stored, type_class, status)
      if (status >= 0) call h5tis_variable_str_f(stored, variable_length, status)
      if (status >= 0) call h5aget_space_f(attribute, space, status)
      if (status >= 0) call h5sget_simple_extent_npoints_f(space, n, status)
      if (status >= 0 .and. variable_length) then
         call read_attribute_texts(attribute, space, int(n), texts, status)
         do i = 1, size(texts)
            if (i > 1) text = text//' '
            text = text//texts(i)%s
         end do
      else if (status >= 0 .and. (type_class == H5T_INTEGER_F .or. type_class == H5T_FLOAT_F)) then
         allocate (values(n))
         address = c_loc(values)
         if (n > 0) call h5aread_f(attribute, H5T_NATIVE_DOUBLE, address, status)
         do i = 1, size(values)
            if (status < 0) exit
            if (type_class == H5T_INTEGER_F) then
               write (number, '(i0)') nint(values(i), int64)
            else
               write (number, '(es14.6)') values(i)
            end if
            if (i > 1) text = text//' '
            text = text//trim(adjustl(number))
         end do
      end if
      if (space > 0) call h5sclose_f(space, ignored)
      if (stored > 0) call h5tclose_f(stored, ignored)
   end subroutine get_attribute_text

   !> Texts of an open attribute of variable-length strings
   subroutine read_attribute_texts(attribute, space, n, texts, status)
      integer(hid_t), intent(in) :: attribute, space
      integer, intent(in) :: n
      type(text_t), allocatable, intent(out) :: texts(:)
      integer, intent(out) :: status

      type(error_t), allocatable :: error
      type(c_ptr), allocatable, target :: pointers(:)
      type(c_ptr) :: address
      integer(hid_t) :: utf8
      integer :: ignored

      allocate (pointers(n), texts(n))
      call utf8_type(utf8, error)
      address = c_loc(pointers)
      status = -1
      if (n == 0) status = 0
      if (.not. allocated(error) .and. n > 0) call h5aread_f(attribute, utf8, address, status)
      if (status >= 0) then
         call copy_texts(pointers, texts)
         if (n > 0) call h5dvlen_reclaim_f(utf8, space, H5P_DEFAULT_F, address, ignored)
      else
         deallocate (texts)
         allocate (texts(0))
      end if
      if (utf8 > 0) call h5tclose_f(utf8, ignored)
   end subroutine read_attribute_texts

end module kj_h5_read
