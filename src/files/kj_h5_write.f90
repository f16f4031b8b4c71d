!> Writing HDF5 datasets: over time, and of fixed shape (constants, labels and texts); dimension
!> scales. The conventions are those of kj_h5.
module kj_h5_write
   use hdf5, only: hid_t, hsize_t, h5dopen_f, h5dclose_f, h5dget_space_f, h5dset_extent_f, &
      h5sget_simple_extent_ndims_f, h5sget_simple_extent_dims_f, h5dcreate_f, &
      h5screate_simple_f, h5sclose_f, h5pclose_f, h5pset_chunk_f, h5pset_fletcher32_f, &
      h5pset_shuffle_f, h5pset_deflate_f, &
      H5P_DATASET_CREATE_F, H5S_UNLIMITED_F, &
      size_t, h5dwrite_f, h5tclose_f, h5pcreate_f, h5pset_buffer_f, H5P_DATASET_XFER_F, &
      H5T_NATIVE_DOUBLE, H5T_STD_U8LE
   use h5ds, only: h5dsset_scale_f
   use kj_error, only: error_t
   use kj_h5, only: check, close_object, start_object, file_type, make_space, utf8_type, &
      put_attribute, forms_t
   use, intrinsic :: iso_fortran_env, only: int8, int64
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_char, c_int, c_int64_t, &
      c_null_char
   use kj_kinds, only: wp
   use kj_text, only: text_t
   implicit none
   private

   public :: start_forms, end_forms, create_series, cut_series, make_scale, attach_scales, &
      close_scale, write_numbers, write_texts, write_text, write_bytes, put_texts, &
      new_scales, free_scales

   integer, parameter :: DEFLATE_LEVEL = 1

   !> Where values are converted. The library takes 1 MB and clears it for every dataset, which is a
   !> third of all work for a small history.
   integer(size_t), parameter :: CONVERTED_BYTES = 16*1024
   integer(hsize_t), parameter :: BYTES_CHUNK = 1024*1024

   interface
      !> The scales of a file that are open, which datasets use (kj_scale.c); null without memory
      type(c_ptr) function new_scales() bind(c, name='kj_scales_new')
         import :: c_ptr
      end function new_scales

      !> Forget them
      subroutine free_scales(scales) bind(c, name='kj_scales_free')
         import :: c_ptr
         type(c_ptr), value :: scales
      end subroutine free_scales

      integer(c_int) function kj_scales_attach(scales, set, rank, scale) bind(c)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: scales
         integer(c_int64_t), value :: set
         integer(c_int), value :: rank
         integer(c_int64_t), intent(in) :: scale(rank)
      end function kj_scales_attach

      integer(c_int) function kj_scales_end(scales, id) bind(c)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: scales
         integer(c_int64_t), value :: id
      end function kj_scales_end
   end interface

contains

   !> Make what the datasets of a file share, for end_forms to close
   subroutine start_forms(forms, error)
      type(forms_t), intent(out) :: forms
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      call utf8_type(forms%text, error)
      if (allocated(error)) return
      call make_space([integer ::], forms%scalar, status)
      if (status >= 0) call start_object(H5P_DATASET_CREATE_F, forms%fixed, status)
      if (status >= 0) call start_object(H5P_DATASET_CREATE_F, forms%series, status)
      if (status >= 0) call h5pset_shuffle_f(forms%series, status)
      if (status >= 0) call h5pset_deflate_f(forms%series, DEFLATE_LEVEL, status)
      if (status >= 0) call h5pcreate_f(H5P_DATASET_XFER_F, forms%transfer, status)
      if (status >= 0) call h5pset_buffer_f(forms%transfer, CONVERTED_BYTES, status)
      call check(status, 'make ready for datasets', error)
   end subroutine start_forms

   !> Close it, also after an error
   subroutine end_forms(forms)
      type(forms_t), intent(in) :: forms

      integer :: ignored

      if (forms%text > 0) call h5tclose_f(forms%text, ignored)
      if (forms%scalar > 0) call h5sclose_f(forms%scalar, ignored)
      if (forms%fixed > 0) call h5pclose_f(forms%fixed, ignored)
      if (forms%series > 0) call h5pclose_f(forms%series, ignored)
      if (forms%transfer > 0) call h5pclose_f(forms%transfer, ignored)
   end subroutine end_forms

   !> Create a dataset over time and leave it open: no rows yet, last dimension unlimited
   subroutine create_series(parent, forms, name, kind, dims, chunk, id, error)
      integer(hid_t), intent(in) :: parent
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind                  !! AS_ constant
      integer, intent(in) :: dims(:)               !! of one row, e.g. [axes, entities], or none
      integer, intent(in) :: chunk(:)              !! the same and rows
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space
      integer(hsize_t) :: most(size(chunk))
      integer :: status, ignored

      id = -1
      if (allocated(error)) return
      space = -1
      most = [int(dims, hsize_t), H5S_UNLIMITED_F]
      call h5pset_chunk_f(forms%series, size(chunk), int(chunk, hsize_t), status)
      if (status >= 0) call h5screate_simple_f(size(chunk), &
         [int(dims, hsize_t), 0_hsize_t], space, status, most)
      if (status >= 0) call h5dcreate_f(parent, name, file_type(kind), space, id, status, &
         forms%series)
      if (space > 0) call h5sclose_f(space, ignored)
      call check(status, 'create the dataset '//name, error)
   end subroutine create_series

   !> Cut a dataset over time to n rows, if it has more
   subroutine cut_series(file, path, n, error)
      integer(hid_t), intent(in) :: file
      character(len=*), intent(in) :: path
      integer, intent(in) :: n
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: id, space
      integer(hsize_t), allocatable :: now(:), most(:)
      integer :: status, rank, ignored

      if (allocated(error)) return
      space = -1
      call h5dopen_f(file, path, id, status)
      if (status < 0) id = -1
      if (status >= 0) call h5dget_space_f(id, space, status)
      if (status >= 0) call h5sget_simple_extent_ndims_f(space, rank, status)
      if (status >= 0) then
         allocate (now(rank), most(rank))
         call h5sget_simple_extent_dims_f(space, now, most, status)
         if (now(rank) > n .and. status >= 0) then
            now(rank) = n
            call h5dset_extent_f(id, now, status)
         end if
      end if
      if (space > 0) call h5sclose_f(space, ignored)
      if (id > 0) call h5dclose_f(id, ignored)
      call check(status, 'cut the dataset '//path, error)
   end subroutine cut_series

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

   !> Label the dimensions of a dataset by scales, the fastest first
   subroutine attach_scales(scales, id, scale, error)
      type(c_ptr), intent(in) :: scales            !! that are open
      integer(hid_t), intent(in) :: id, scale(:)
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      call check(int(kj_scales_attach(scales, id, size(scale), scale(size(scale):1:-1))), &
         'attach dimension scales', error)
   end subroutine attach_scales

   !> A scale has all its datasets: note them in it, and close it, also after an error
   subroutine close_scale(scales, id, error)
      type(c_ptr), intent(in) :: scales            !! that are open
      integer(hid_t), intent(inout) :: id          !! -1 afterwards
      type(error_t), allocatable, intent(inout) :: error

      if (.not. allocated(error) .and. id >= 0) &
         call check(int(kj_scales_end(scales, id)), 'list the users of a dimension scale', error)
      call close_object(id, error)
   end subroutine close_scale

   !> Create a dataset of constant numbers and leave it open
   subroutine write_numbers(parent, forms, name, kind, dims, values, id, error)
      integer(hid_t), intent(in) :: parent
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind, dims(:)         !! AS_ constant; shape
      real(wp), contiguous, target, intent(in) :: values(:)   !! (product(dims))
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      id = -1
      if (allocated(error)) return
      call create_fixed(parent, forms, name, file_type(kind), H5T_NATIVE_DOUBLE, dims, &
         c_loc(values), id, error)
   end subroutine write_numbers

   !> Create a dataset of texts (n) and leave it open
   subroutine write_texts(parent, forms, name, texts, id, error)
      integer(hid_t), intent(in) :: parent
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name
      type(text_t), intent(in) :: texts(:)
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      character(kind=c_char), allocatable, target :: buffer(:)
      type(c_ptr), allocatable, target :: pointers(:)

      call c_texts(texts, buffer, pointers)
      call write_pointers(parent, forms, name, pointers, [size(texts)], id, error)
   end subroutine write_texts

   !> Texts as C has them: one buffer, each text ended by a null, and pointers to their starts
   subroutine c_texts(texts, buffer, pointers)
      type(text_t), intent(in) :: texts(:)
      character(kind=c_char), allocatable, target, intent(out) :: buffer(:)
      type(c_ptr), allocatable, intent(out) :: pointers(:)

      integer :: i, j, n

      n = 0
      do i = 1, size(texts)
         n = n + len(texts(i)%s) + 1
      end do
      allocate (buffer(n), pointers(size(texts)))
      n = 0
      do i = 1, size(texts)
         pointers(i) = c_loc(buffer(n + 1))
         do j = 1, len(texts(i)%s)
            buffer(n + j) = texts(i)%s(j:j)
         end do
         n = n + len(texts(i)%s) + 1
         buffer(n) = c_null_char
      end do
   end subroutine c_texts

   !> Set an attribute to texts of a shape, none for a single one
   subroutine put_texts(id, name, texts, dims, forms, error)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      type(text_t), intent(in) :: texts(:)
      integer, intent(in) :: dims(:)
      type(forms_t), intent(in) :: forms           !! of the file
      type(error_t), allocatable, intent(inout) :: error

      character(kind=c_char), allocatable, target :: buffer(:)
      type(c_ptr), allocatable, target :: pointers(:)

      call c_texts(texts, buffer, pointers)
      call put_attribute(id, name, forms%text, forms%text, dims, c_loc(pointers), error)
   end subroutine put_texts

   !> Create a dataset of one text, without dimensions, and leave it open. It may be a large one:
   !> the only copy is that with a null at its end.
   subroutine write_text(parent, forms, name, text, id, error)
      integer(hid_t), intent(in) :: parent
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name, text
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      character(kind=c_char, len=:), allocatable, target :: buffer
      type(c_ptr) :: pointers(1)

      allocate (character(len=len(text) + 1) :: buffer)
      buffer(:len(text)) = text
      buffer(len(buffer):) = c_null_char
      pointers = c_loc(buffer)
      call write_pointers(parent, forms, name, pointers, [integer ::], id, error)
   end subroutine write_text

   !> Create a dataset of texts with the given shape, none for a scalar
   subroutine write_pointers(parent, forms, name, pointers, dims, id, error)
      integer(hid_t), intent(in) :: parent
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name
      type(c_ptr), contiguous, target, intent(in) :: pointers(:)   !! to texts that end in a null
      integer, intent(in) :: dims(:)
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      call create_fixed(parent, forms, name, forms%text, forms%text, dims, c_loc(pointers), id, &
         error)
   end subroutine write_pointers

   !> Create and fill a dataset of fixed shape, none for a scalar
   subroutine create_fixed(parent, forms, name, stored, memory, dims, values, id, error)
      integer(hid_t), intent(in) :: parent, stored, memory   !! types in the file and of `values`
      type(forms_t), intent(in) :: forms           !! of the file
      character(len=*), intent(in) :: name
      integer, intent(in) :: dims(:)
      type(c_ptr), intent(in) :: values
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space
      integer :: status, ignored

      id = -1
      if (allocated(error)) return
      call make_space(dims, space, status)
      if (status >= 0) call h5dcreate_f(parent, name, stored, space, id, status, forms%fixed)
      if (status >= 0) call h5dwrite_f(id, memory, values, status, xfer_prp=forms%transfer)
      if (space > 0) call h5sclose_f(space, ignored)
      call check(status, 'write the dataset '//name, error)
   end subroutine create_fixed

   !> Create and fill a dataset of bytes that is read back whole or not at all: it has check sums
   subroutine write_bytes(parent, name, byte, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer(int8), contiguous, target, intent(in) :: byte(:)
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space, plist, id
      integer(hsize_t) :: n
      integer :: status, ignored

      if (allocated(error)) return
      id = -1
      space = -1
      n = size(byte, kind=int64)
      call start_object(H5P_DATASET_CREATE_F, plist, status)
      if (status >= 0) call h5pset_chunk_f(plist, 1, [min(n, BYTES_CHUNK)], status)
      if (status >= 0) call h5pset_fletcher32_f(plist, status)
      if (status >= 0) call h5screate_simple_f(1, [n], space, status)
      if (status >= 0) call h5dcreate_f(parent, name, H5T_STD_U8LE, space, id, status, plist)
      if (status >= 0) call h5dwrite_f(id, H5T_STD_U8LE, c_loc(byte), status)
      if (space > 0) call h5sclose_f(space, ignored)
      if (plist > 0) call h5pclose_f(plist, ignored)
      call check(status, 'write the dataset '//name, error)
      call close_object(id, error)
   end subroutine write_bytes

end module kj_h5_write
