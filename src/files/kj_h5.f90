!> HDF5 files, groups, links and attributes in the few forms that the history layout needs.
!> Only this module, kj_h5_write, kj_h5_store with kj_store.c, and kj_h5_read use HDF5.
!>
!> Every procedure takes `error` inout and does nothing once it is set, so that a row of calls
!> needs one test. What a procedure opens it closes, on errors too; a file is closed together
!> with everything still open in it. Shapes are in Fortran order, the reverse of the file's.
!> Numbers travel as reals (wp); HDF5 converts them to the type of the dataset.
!> Errors: ERR_FILE, naming what could not be done.
module kj_h5
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_char, c_null_char
   use hdf5, only: hid_t, hsize_t, size_t, h5pset_fapl_core_f, h5pset_cache_f, h5open_f, &
      h5dont_atexit_f, &
      h5eset_auto_f, h5get_libversion_f, h5fcreate_f, h5fopen_f, h5fclose_f, &
      h5gcreate_f, h5oclose_f, h5lcreate_hard_f, h5rcreate_f, hobj_ref_t_f, &
      h5pset_est_link_info_f, &
      h5lexists_f, h5acreate_f, h5awrite_f, h5aclose_f, h5adelete_f, h5screate_f, &
      h5screate_simple_f, h5sclose_f, h5tcopy_f, h5tset_cset_f, h5tclose_f, h5pcreate_f, &
      h5pclose_f, h5pset_libver_bounds_f, h5pset_fclose_degree_f, h5pset_link_creation_order_f, &
      h5pset_attr_creation_order_f, h5pset_attr_phase_change_f, h5pset_link_phase_change_f, &
      h5pset_obj_track_times_f, H5F_ACC_TRUNC_F, H5F_ACC_RDONLY_F, H5F_ACC_RDWR_F, &
      H5F_CLOSE_STRONG_F, H5F_LIBVER_EARLIEST_F, H5F_LIBVER_V18_F, H5P_FILE_CREATE_F, &
      H5P_FILE_ACCESS_F, H5P_GROUP_CREATE_F, H5P_CRT_ORDER_TRACKED_F, H5P_CRT_ORDER_INDEXED_F, &
      H5S_SCALAR_F, H5T_STRING, H5T_CSET_UTF8_F, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, H5T_STD_I64LE, &
      H5T_STD_I32LE, H5T_STD_I8LE
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_channels, only: AS_F64, AS_I64, AS_I32, AS_I8
   implicit none
   private

   public :: hid_t, start_hdf5, hdf5_version, create_file, open_file, close_file
   public :: create_group, close_object, find_place, has_link, link_to
   public :: put_text, put_number, put_numbers
   public :: check, start_object, file_type, make_space, utf8_type, put_attribute   ! for kj_h5_*

   !> What the many attributes and datasets of one file share: making each anew takes a tenth of all
   !> work of a small history. By start_forms of kj_h5_write.
   type, public :: forms_t
      integer(hid_t) :: text = -1, scalar = -1     !! type of every text, space of one value
      integer(hid_t) :: series = -1, fixed = -1    !! creation of datasets over time, of others
      integer(hid_t) :: transfer = -1              !! how values of the latter are written
   end type forms_t

   integer, parameter :: MOST_INLINE = 64    !! attributes or links kept in an object's header
   integer, parameter :: LINKS = 40, LETTERS = 12         !! links of a group, of their names: about
   integer(size_t), parameter :: CORE_INCREMENT = 256*1024      !! by which a file in memory grows

contains

   !> Make the library ready and silent. It may be called any number of times, and nothing ends the
   !> library, so that one user of it does not end it for another. It must not close itself at the
   !> end of the process either: after a failed write, on a full disk, that crashes (HDF5 1.10).
   subroutine start_hdf5(error)
      type(error_t), allocatable, intent(inout) :: error

      integer :: status, ignored

      if (allocated(error)) return
      call h5dont_atexit_f(ignored)
      call h5open_f(status)
      if (status >= 0) call h5eset_auto_f(0, status)
      call check(status, 'start the HDF5 library', error)
   end subroutine start_hdf5

   !> Version of the HDF5 library, "1.10.8"
   function hdf5_version() result(text)
      character(len=:), allocatable :: text

      integer :: major, minor, patch, status

      call h5get_libversion_f(major, minor, patch, status)
      text = ''
      if (status >= 0) text = str(major)//'.'//str(minor)//'.'//str(patch)
   end function hdf5_version

   !> Raise an error when an HDF5 status is negative
   subroutine check(status, action, error)
      integer, intent(in) :: status
      character(len=*), intent(in) :: action       !! what was tried, after "cannot"
      type(error_t), allocatable, intent(inout) :: error

      if (status < 0 .and. .not. allocated(error)) &
         call fail(error, ERR_FILE, 'cannot '//action//' (HDF5)')
   end subroutine check

   !> Create a file, replacing one of that name; an image is one in memory, lost when it is closed
   subroutine create_file(name, file, error, image, live)
      character(len=*), intent(in) :: name         !! of an image: that no other open file has
      integer(hid_t), intent(out) :: file
      type(error_t), allocatable, intent(inout) :: error
      logical, intent(in) :: image
      logical, intent(in) :: live                  !! with a superblock of version 2

      integer(hid_t) :: creation, access
      integer :: status, ignored

      file = -1
      if (allocated(error)) return
      access = -1
      call start_object(H5P_FILE_CREATE_F, creation, status)
      call prepare_links(creation, status)
      if (status >= 0) call h5pcreate_f(H5P_FILE_ACCESS_F, access, status)
      if (status >= 0 .and. image) then            ! its chunks are not written by HDF5
         call h5pset_fapl_core_f(access, CORE_INCREMENT, .false., status)
         if (status >= 0) call h5pset_cache_f(access, 0, 0_size_t, 0_size_t, 0.0, status)
      end if
      if (status >= 0) call h5pset_libver_bounds_f(access, merge(H5F_LIBVER_V18_F, &
         H5F_LIBVER_EARLIEST_F, live), H5F_LIBVER_V18_F, status)
      if (status >= 0) call h5pset_fclose_degree_f(access, H5F_CLOSE_STRONG_F, status)
      if (status >= 0) call h5fcreate_f(name, H5F_ACC_TRUNC_F, file, status, creation, access)
      if (creation > 0) call h5pclose_f(creation, ignored)
      if (access > 0) call h5pclose_f(access, ignored)
      call check(status, 'create the file '//name, error)
   end subroutine create_file

   !> Open a file, for reading only unless asked otherwise
   subroutine open_file(path, file, error, to_write)
      character(len=*), intent(in) :: path
      integer(hid_t), intent(out) :: file
      type(error_t), allocatable, intent(inout) :: error
      logical, intent(in), optional :: to_write

      integer(hid_t) :: access
      integer :: status, ignored, flags

      file = -1
      if (allocated(error)) return
      access = -1
      call h5pcreate_f(H5P_FILE_ACCESS_F, access, status)
      if (status >= 0) call h5pset_fclose_degree_f(access, H5F_CLOSE_STRONG_F, status)
      flags = H5F_ACC_RDONLY_F
      if (present(to_write)) flags = merge(H5F_ACC_RDWR_F, flags, to_write)
      if (status >= 0) call h5fopen_f(path, flags, file, status, access)
      if (access > 0) call h5pclose_f(access, ignored)
      call check(status, 'open '//path//' as an HDF5 file', error)
   end subroutine open_file

   !> Close a file and everything still open in it, also after an error
   subroutine close_file(file, error)
      integer(hid_t), intent(inout) :: file        !! -1 afterwards
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      if (file < 0) return
      call h5fclose_f(file, status)
      file = -1
      call check(status, 'close the file', error)
   end subroutine close_file

   !> Creation properties of any object: attributes keep their order, no times are stored
   subroutine start_object(class, plist, status)
      integer(hid_t), intent(in) :: class
      integer(hid_t), intent(out) :: plist
      integer, intent(out) :: status

      plist = -1
      call h5pcreate_f(class, plist, status)
      if (status >= 0) call h5pset_attr_creation_order_f(plist, order_flags(), status)
      if (status >= 0) call h5pset_obj_track_times_f(plist, .false., status)
      ! in the object header itself: indexed storage costs more than all else of a small file
      if (status >= 0) call h5pset_attr_phase_change_f(plist, MOST_INLINE, MOST_INLINE/2, status)
   end subroutine start_object

   !> Track and index the order of creation
   integer function order_flags()
      order_flags = ior(H5P_CRT_ORDER_TRACKED_F, H5P_CRT_ORDER_INDEXED_F)
   end function order_flags

   !> Creation properties of links: they keep their order, and stand in the header of the group,
   !> which has room for them from the start
   subroutine prepare_links(plist, status)
      integer(hid_t), intent(in) :: plist
      integer, intent(inout) :: status          !! nothing is done where it is negative

      if (status >= 0) call h5pset_link_creation_order_f(plist, order_flags(), status)
      if (status >= 0) call h5pset_link_phase_change_f(plist, MOST_INLINE, MOST_INLINE/2, &
         status)
      if (status >= 0) call h5pset_est_link_info_f(plist, LINKS, LETTERS, status)
   end subroutine prepare_links

   !> Create a group and leave it open
   subroutine create_group(parent, name, group, error)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name
      integer(hid_t), intent(out) :: group
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: plist
      integer :: status, ignored

      group = -1
      if (allocated(error)) return
      call start_object(H5P_GROUP_CREATE_F, plist, status)
      call prepare_links(plist, status)
      if (status >= 0) call h5gcreate_f(parent, name, group, status, gcpl_id=plist)
      if (plist > 0) call h5pclose_f(plist, ignored)
      call check(status, 'create the group '//name, error)
   end subroutine create_group

   !> Close a group or dataset, also after an error
   subroutine close_object(id, error)
      integer(hid_t), intent(inout) :: id          !! -1 afterwards
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      if (id < 0) return
      call h5oclose_f(id, status)
      id = -1
      call check(status, 'close an object', error)
   end subroutine close_object

   !> Where the header of a group or dataset lies in its file, -1 after an error
   subroutine find_place(id, place, error)
      integer(hid_t), intent(in) :: id
      integer(int64), intent(out) :: place
      type(error_t), allocatable, intent(inout) :: error

      type(hobj_ref_t_f) :: reference
      integer :: status

      place = -1
      if (allocated(error)) return
      call h5rcreate_f(id, '.', reference, status)
      if (status >= 0) place = int(reference%ref, int64)
      call check(status, 'find an object', error)
   end subroutine find_place

   !> Does the group have a link of this name?
   logical function has_link(parent, name)
      integer(hid_t), intent(in) :: parent
      character(len=*), intent(in) :: name

      integer :: status

      call h5lexists_f(parent, name, has_link, status)
      if (status < 0) has_link = .false.
   end function has_link

   !> Give an object a second name, a hard link, in another group
   subroutine link_to(from, path, group, name, error)
      integer(hid_t), intent(in) :: from, group
      character(len=*), intent(in) :: path, name   !! path of the object in `from`; its new name
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      if (allocated(error)) return
      call h5lcreate_hard_f(from, path, group, name, status)
      call check(status, 'link '//name, error)
   end subroutine link_to

   !> Type in the file of an AS_ constant
   integer(hid_t) function file_type(kind)
      integer, intent(in) :: kind

      integer(hid_t) :: types(4)

      types([AS_F64, AS_I64, AS_I32, AS_I8]) = [H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_I32LE, &
         H5T_STD_I8LE]
      file_type = types(kind)
   end function file_type

   !> Dataspace of a shape, scalar when there are no dimensions
   subroutine make_space(dims, space, status)
      integer, intent(in) :: dims(:)
      integer(hid_t), intent(out) :: space
      integer, intent(out) :: status

      space = -1
      if (size(dims) == 0) then
         call h5screate_f(H5S_SCALAR_F, space, status)
      else
         call h5screate_simple_f(size(dims), int(dims, hsize_t), space, status)
      end if
   end subroutine make_space

   !> Type of every text: variable length, UTF-8; the caller closes it
   subroutine utf8_type(id, error)
      integer(hid_t), intent(out) :: id
      type(error_t), allocatable, intent(inout) :: error

      integer :: status

      id = -1
      if (allocated(error)) return
      call h5tcopy_f(H5T_STRING, id, status)
      if (status >= 0) call h5tset_cset_f(id, H5T_CSET_UTF8_F, status)
      call check(status, 'make a text type', error)
   end subroutine utf8_type

   !> Set an attribute to a text
   subroutine put_text(id, name, text, error, forms)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name, text
      type(error_t), allocatable, intent(inout) :: error
      type(forms_t), intent(in), optional :: forms !! of the file, where many are set

      character(kind=c_char), target :: buffer(len(text) + 1)
      type(c_ptr), target :: pointer
      integer(hid_t) :: utf8
      integer :: i, ignored

      do i = 1, len(text)
         buffer(i) = text(i:i)
      end do
      buffer(len(text) + 1) = c_null_char
      pointer = c_loc(buffer)
      if (present(forms)) then
         call set_attribute(id, name, forms%text, forms%text, forms%scalar, c_loc(pointer), error)
      else
         call utf8_type(utf8, error)
         call put_attribute(id, name, utf8, utf8, [integer ::], c_loc(pointer), error)
         if (utf8 > 0) call h5tclose_f(utf8, ignored)
      end if
   end subroutine put_text

   !> Set an attribute to a number
   subroutine put_number(id, name, kind, value, error)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind                  !! AS_ constant
      real(wp), target, intent(in) :: value
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      call put_attribute(id, name, file_type(kind), H5T_NATIVE_DOUBLE, [integer ::], &
         c_loc(value), error)
   end subroutine put_number

   !> Set an attribute to an array of numbers
   subroutine put_numbers(id, name, kind, values, error)
      integer(hid_t), intent(in) :: id
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind                  !! AS_ constant
      real(wp), contiguous, target, intent(in) :: values(:)
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      call put_attribute(id, name, file_type(kind), H5T_NATIVE_DOUBLE, [size(values)], &
         c_loc(values), error)
   end subroutine put_numbers

   !> Create an attribute of a shape, in place of one of that name
   subroutine put_attribute(id, name, stored, memory, dims, values, error)
      integer(hid_t), intent(in) :: id, stored, memory       !! types in the file and of `values`
      character(len=*), intent(in) :: name
      integer, intent(in) :: dims(:)
      type(c_ptr), intent(in) :: values
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: space
      integer :: status, ignored

      if (allocated(error)) return
      call make_space(dims, space, status)
      call check(status, 'write the attribute '//name, error)
      call set_attribute(id, name, stored, memory, space, values, error)
      if (space > 0) call h5sclose_f(space, ignored)
   end subroutine put_attribute

   !> The same in a space that is there
   subroutine set_attribute(id, name, stored, memory, space, values, error)
      integer(hid_t), intent(in) :: id, stored, memory, space
      character(len=*), intent(in) :: name
      type(c_ptr), intent(in) :: values
      type(error_t), allocatable, intent(inout) :: error

      integer(hid_t) :: attribute
      integer :: status, ignored

      if (allocated(error)) return
      call h5acreate_f(id, name, stored, space, attribute, status)
      if (status < 0) then                         ! there is one of that name
         attribute = -1
         call h5adelete_f(id, name, status)
         if (status >= 0) call h5acreate_f(id, name, stored, space, attribute, status)
      end if
      if (status >= 0) call h5awrite_f(attribute, memory, values, status)
      if (attribute > 0) call h5aclose_f(attribute, ignored)
      call check(status, 'write the attribute '//name, error)
   end subroutine set_attribute

end module kj_h5
