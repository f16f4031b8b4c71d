!> Reading HDF5 datasets and names; the conventions are those of kj_h5. A file may
!> hold anything, so every shape and type is tested before memory is asked for.
module kj_h5_read
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_char, c_size_t, c_f_pointer, c_associated
   use hdf5, only: hid_t, hsize_t, h5gopen_f, h5gget_info_f, h5dopen_f, h5dread_f, h5dget_space_f, &
      h5dget_type_f, h5dvlen_reclaim_f, h5lget_name_by_idx_f, h5screate_simple_f, h5sclose_f, &
      h5sselect_hyperslab_f, h5sget_simple_extent_ndims_f, h5sget_simple_extent_dims_f, &
      h5tclose_f, h5tis_variable_str_f, H5P_DEFAULT_F, H5S_SELECT_SET_F, H5T_NATIVE_DOUBLE, &
      H5_INDEX_CRT_ORDER_F, H5_ITER_INC_F
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_history, only: text_t
   use kj_h5, only: check, close_object, utf8_type
   implicit none
   private

   public :: open_group, open_dataset, get_shape, read_rows, read_numbers, read_texts
   public :: get_link_names, copy_texts

   interface
      integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
         import :: c_size_t, c_ptr
         type(c_ptr), value :: text
      end function c_strlen
   end interface

contains

   !> Open a group
   subroutine open_group(parent, name, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      id = -1
      if (allocated(error)) return
      call h5gopen_f(parent, name, id, status)
      call check(status, 'open the group '//name, error)
   end subroutine open_group

   !> Open a dataset
   subroutine open_dataset(parent, name, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      id = -1
      if (allocated(error)) return
      call h5dopen_f(parent, name, id, status)
      call check(status, 'open the dataset '//name, error)
   end subroutine open_dataset

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
      call open_dataset(parent, name, id, error)
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
      call open_dataset(parent, name, id, error)
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

      character(kind=c_char), pointer :: from(:)
      integer :: i, j, n

      do i = 1, size(pointers)
         n = 0
         if (c_associated(pointers(i))) n = int(c_strlen(pointers(i)))
         allocate (character(len=n) :: texts(i)%s)
         if (n == 0) cycle
         call c_f_pointer(pointers(i), from, [n])
         do j = 1, n
            texts(i)%s(j:j) = from(j)
         end do
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

end module kj_h5_read
