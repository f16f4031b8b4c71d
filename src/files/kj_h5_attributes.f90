!> Reading HDF5 attributes; the conventions are those of kj_h5.
module kj_h5_attributes
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: hid_t, hsize_t, size_t, h5dvlen_reclaim_f, h5aopen_f, h5aopen_by_idx_f, &
      h5aread_f, h5aclose_f, h5aexists_f, h5aget_num_attrs_f, h5aget_name_f, h5aget_type_f, &
      h5aget_space_f, h5sclose_f, h5sget_simple_extent_npoints_f, h5tclose_f, h5tget_class_f, &
      h5tis_variable_str_f, H5P_DEFAULT_F, H5T_NATIVE_DOUBLE, H5T_INTEGER_F, H5T_FLOAT_F, &
      H5_INDEX_CRT_ORDER_F, H5_ITER_INC_F
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_history, only: text_t
   use kj_h5, only: check, utf8_type
   use kj_h5_read, only: copy_texts
   implicit none
   private

   public :: get_text, get_numbers, get_facts

contains

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

end module kj_h5_attributes
