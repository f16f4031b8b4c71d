!> HDF5 datasets over time, and dimension scales; the conventions are those of kj_h5.
module kj_h5_data
   use hdf5, only: hid_t, hsize_t, h5dcreate_f, h5screate_simple_f, h5sclose_f, h5pclose_f, &
      h5pset_chunk_f, h5pset_shuffle_f, h5pset_deflate_f, H5P_DATASET_CREATE_F, H5S_UNLIMITED_F
   use h5ds, only: h5dsset_scale_f, h5dsattach_scale_f
   use kj_error, only: error_t
   use kj_h5, only: check, start_object, file_type
   implicit none
   private

   public :: create_series, make_scale, attach_scale

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
