!> Writing HDF5 datasets and their dimension scales; the conventions are those of kj_h5.
module kj_h5_data
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_char
   use hdf5, only: hid_t, hsize_t, h5dcreate_f, h5dwrite_f, h5screate_simple_f, &
      h5sclose_f, h5tclose_f, h5pclose_f, h5pset_chunk_f, h5pset_shuffle_f, h5pset_deflate_f, &
      H5P_DATASET_CREATE_F, H5S_UNLIMITED_F, H5T_NATIVE_DOUBLE
   use h5ds, only: h5dsset_scale_f, h5dsattach_scale_f
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_history, only: text_t
   use kj_h5, only: check, start_object, file_type, make_space, utf8_type, c_texts
   implicit none
   private

   public :: create_series, write_numbers, write_texts, write_text
   public :: make_scale, attach_scale

   integer, parameter :: DEFLATE_LEVEL = 1

contains

   !> Create a dataset over time and leave it open: no rows yet, last dimension unlimited
   subroutine create_series(parent, name, kind, dims, chunk, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind                  !! AS_ constant
      integer, intent(in) :: dims(:)               !! of one row, e.g. [axes, entities], or none
      integer, intent(in) :: chunk(:)              !! the same and rows
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space, plist
      integer(hsize_t) :: most(size(chunk))
      integer :: status, ignored

      id = -1
      if (allocated(error)) return
      space = -1
      most = [int(dims, hsize_t), H5S_UNLIMITED_F]
      call start_object(H5P_DATASET_CREATE_F, plist, status)
      if (status >= 0) call h5pset_chunk_f(plist, size(chunk), int(chunk, hsize_t), status)
      if (status >= 0) call h5pset_shuffle_f(plist, status)
      if (status >= 0) call h5pset_deflate_f(plist, DEFLATE_LEVEL, status)
      if (status >= 0) call h5screate_simple_f(size(chunk), &
         [int(dims, hsize_t), 0_hsize_t], space, status, most)
      if (status >= 0) call h5dcreate_f(parent, name, file_type(kind), space, id, status, plist)
      if (space > 0) call h5sclose_f(space, ignored)
      if (plist > 0) call h5pclose_f(plist, ignored)
      call check(status, 'create the dataset '//name, error)
   end subroutine create_series

   !> Create a dataset of constant numbers and leave it open
   subroutine write_numbers(parent, name, kind, dims, values, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind, dims(:)         !! AS_ constant; shape
      real(wp), contiguous, target, intent(in) :: values(:)   !! (product(dims))
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) id = -1
      if (allocated(error)) return
      call create_fixed(parent, name, file_type(kind), H5T_NATIVE_DOUBLE, dims, c_loc(values), id, &
         error)
   end subroutine write_numbers

   !> Create a dataset of texts (n) and leave it open
   subroutine write_texts(parent, name, texts, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      type(text_t), intent(in) :: texts(:)
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      call write_some_texts(parent, name, texts, [size(texts)], id, error)
   end subroutine write_texts

   !> Create a dataset of one text, without dimensions, and leave it open
   subroutine write_text(parent, name, text, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name, text
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      type(text_t) :: texts(1)

      texts(1)%s = text
      call write_some_texts(parent, name, texts, [integer ::], id, error)
   end subroutine write_text

   !> Create a dataset of texts with the given shape, none for a scalar
   subroutine write_some_texts(parent, name, texts, dims, id, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      type(text_t), intent(in) :: texts(:)
      integer, intent(in) :: dims(:)
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      character(kind=c_char), allocatable, target :: buffer(:)
      type(c_ptr), allocatable, target :: pointers(:)
      integer(hid_t) :: utf8
      integer :: ignored

      id = -1
      call utf8_type(utf8, error)
      call c_texts(texts, buffer, pointers)
      call create_fixed(parent, name, utf8, utf8, dims, c_loc(pointers), id, error)
      if (utf8 > 0) call h5tclose_f(utf8, ignored)
   end subroutine write_some_texts

   !> Create and fill a dataset of fixed shape, none for a scalar
   subroutine create_fixed(parent, name, stored, memory, dims, values, id, error)
      integer(hid_t), intent(in) :: parent, stored, memory   !! types in the file and of `values`
      character(len=*), intent(in) :: name
      integer, intent(in) :: dims(:)
      type(c_ptr), intent(in) :: values
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space, plist
      integer :: status, ignored

      id = -1
      if (allocated(error)) return
      call start_object(H5P_DATASET_CREATE_F, plist, status)
      if (status >= 0) call make_space(dims, space, status)
      if (status >= 0) call h5dcreate_f(parent, name, stored, space, id, status, plist)
      if (status >= 0) call h5dwrite_f(id, memory, values, status)
      if (space > 0) call h5sclose_f(space, ignored)
      if (plist > 0) call h5pclose_f(plist, ignored)
      call check(status, 'write the dataset '//name, error)
   end subroutine create_fixed

   !> Make a dataset the scale of a dimension
   subroutine make_scale(id, name, error)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      if (allocated(error)) return
      call h5dsset_scale_f(id, status, name)
      call check(status, 'make '//name//' a dimension scale', error)
   end subroutine make_scale

   !> Label one dimension of a dataset by a scale. The library counts in file order (1 = slowest),
   !> this procedure in Fortran order (1 = fastest).
   subroutine attach_scale(id, scale, dim, rank, error)
      integer(hid_t), intent(in) :: id, scale
      integer, intent(in) :: dim, rank
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      if (allocated(error)) return
      call h5dsattach_scale_f(id, scale, rank - dim + 1, status)
      call check(status, 'attach a dimension scale', error)
   end subroutine attach_scale

end module kj_h5_data
