!> Header of a Radioss time-history file: what its rows hold and in which order.
module kj_t01_header
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_history, only: text_t
   use kj_t01_file, only: t01_file_t, read_record, read_real_record, skip_record, broken
   implicit none
   private

   public :: t01_header_t, t01_group_t, read_t01_header

   !> One /TH request: the same variables of some objects
   type :: t01_group_t
      integer :: type = 0                        !! type code: 0 node, 6 spring, 103 body, ...
      integer, allocatable :: object(:)          !! user ids, in the order of the rows
      type(text_t), allocatable :: name(:)       !! their names
      integer, allocatable :: code(:)            !! codes of the variables
   end type t01_group_t

   !> What stands before the rows
   type :: t01_header_t
      character(len=:), allocatable :: title     !! of the deck
      character(len=:), allocatable :: origin    !! date, program and machine
      logical :: has_units = .false.
      real(wp) :: si(3) = 1.0_wp                 !! SI value of the units of mass, length and time
      integer, allocatable :: global_code(:)
      integer, allocatable :: part_code(:), subset_code(:)    !! each once
      integer :: n_part_value = 0, n_subset_value = 0         !! reals of all parts, all subsets
      type(t01_group_t), allocatable :: group(:)
   end type t01_header_t

   integer, parameter :: HEAD_TEXT = 80   !! characters of the first two records

   !> Code of the first record, and the length of titles that it means
   integer, parameter :: versions(2, 4) = &
      reshape([3040, 40,  3041, 80,  3050, 100,  4021, 100], [2, 4])
   integer, parameter :: WITH_UNITS = 3050    !! from this code on more records follow

contains

   !> Read from the first record to the place of the first row
   !>
   !> Errors: ERR_FILE when it is damaged.
   subroutine read_t01_header(file, header, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_header_t), intent(out) :: header
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), counts(:)
      character(len=:), allocatable :: text
      integer :: n_title, version, i

      call read_record(file, 1, HEAD_TEXT, 0, ints, header%title, error)
      if (allocated(error)) return
      version = findloc(versions(1, :), ints(1), 1)
      if (version == 0) then
         call broken(file, 'its header code '//str(ints(1))//' is not known', error)
         return
      end if
      n_title = versions(2, version)
      call read_record(file, 0, HEAD_TEXT, 0, ints, header%origin, error)
      if (.not. allocated(error) .and. versions(1, version) >= WITH_UNITS) &
         call read_extra_records(file, header, n_title, error)
      if (allocated(error)) return
      call read_record(file, 6, 0, 0, counts, text, error)
      if (allocated(error)) return
      call read_codes(file, counts(6), header%global_code, error)
      if (allocated(error)) return
      allocate (header%part_code(0), header%subset_code(0), header%group(0))
      do i = 1, counts(1)
         call read_part(file, n_title, header%part_code, header%n_part_value, error)
         if (allocated(error)) return
      end do
      do i = 1, counts(2)
         call read_record(file, 1, n_title, 0, ints, text, error)      ! a material
         if (allocated(error)) return
      end do
      do i = 1, counts(3)
         call read_record(file, 1, n_title, 0, ints, text, error)      ! a property
         if (allocated(error)) return
      end do
      do i = 1, counts(4)
         call read_subset(file, n_title, header%subset_code, header%n_subset_value, error)
         if (allocated(error)) return
      end do
      call read_groups(file, n_title, counts(5), header%group, error)
   end subroutine read_t01_header

   !> The number of further records, the length of titles, the SI values of the units, unknown ones
   subroutine read_extra_records(file, header, n_title, error)
      type(t01_file_t), intent(inout) :: file
      type(t01_header_t), intent(inout) :: header
      integer, intent(inout) :: n_title
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: n_extra(:), length(:)
      character(len=:), allocatable :: text
      integer :: i

      call read_record(file, 1, 0, 0, n_extra, text, error)
      if (allocated(error)) return
      do i = 1, n_extra(1)
         if (i == 1) then
            call read_record(file, 1, 0, 0, length, text, error)
            if (allocated(error)) return
            n_title = length(1)
            if (n_title < 4 .or. n_title > 400 .or. mod(n_title, 4) /= 0) &
               call broken(file, 'a title length of '//str(n_title), error)
         else if (i == 2) then
            call read_real_record(file, 3, header%si, error)
            header%has_units = all(header%si > 0.0_wp)
         else
            call skip_record(file, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine read_extra_records

   !> A record of n codes; no record when n is 0
   subroutine read_codes(file, n, codes, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: codes(:)
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: text

      allocate (codes(0))
      if (n /= 0) call read_record(file, n, 0, 0, codes, text, error)
   end subroutine read_codes

   !> A part: id, title, 0, material, property, number of variables; and the codes of these
   subroutine read_part(file, n_title, all_codes, n_value, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title
      integer, allocatable, intent(inout) :: all_codes(:)
      integer, intent(inout) :: n_value
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), codes(:)
      character(len=:), allocatable :: title

      call read_record(file, 1, n_title, 4, ints, title, error)
      if (allocated(error)) return
      call read_codes(file, ints(5), codes, error)
      if (allocated(error)) return
      call add_codes(codes, all_codes, n_value)
   end subroutine read_part

   !> A subset: id, parent, children, parts, variables, title; and the lists of these
   subroutine read_subset(file, n_title, all_codes, n_value, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title
      integer, allocatable, intent(inout) :: all_codes(:)
      integer, intent(inout) :: n_value
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), list(:)
      character(len=:), allocatable :: title
      integer :: i

      call read_record(file, 5, n_title, 0, ints, title, error)
      if (allocated(error)) return
      do i = 3, 5
         call read_codes(file, ints(i), list, error)
         if (allocated(error)) return
      end do
      call add_codes(list, all_codes, n_value)
   end subroutine read_subset

   !> Count the values of an object, and note codes that are new
   pure subroutine add_codes(codes, all_codes, n_value)
      integer, intent(in) :: codes(:)
      integer, allocatable, intent(inout) :: all_codes(:)
      integer, intent(inout) :: n_value

      integer :: i

      n_value = n_value + size(codes)
      do i = 1, size(codes)
         if (all(all_codes /= codes(i))) all_codes = [all_codes, codes(i)]
      end do
   end subroutine add_codes

   !> The groups; memory grows as they are read, so that a wrong count ends at the end of the file
   subroutine read_groups(file, n_title, n_group, groups, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title, n_group
      type(t01_group_t), allocatable, intent(inout) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      type(t01_group_t), allocatable :: longer(:)
      type(t01_group_t) :: group
      integer :: i

      do i = 1, n_group
         call read_group(file, n_title, group, error)
         if (allocated(error)) return
         allocate (longer(i))
         longer(:i - 1) = groups
         longer(i) = group
         call move_alloc(longer, groups)
      end do
   end subroutine read_groups

   !> A group: id, type, 0, objects, variables, title; its objects; its codes
   subroutine read_group(file, n_title, group, error)
      type(t01_file_t), intent(inout) :: file
      integer, intent(in) :: n_title
      type(t01_group_t), intent(out) :: group
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ints(:), id(:)
      type(text_t), allocatable :: longer(:)
      character(len=:), allocatable :: title
      integer :: i, n

      call read_record(file, 5, n_title, 0, ints, title, error)
      if (allocated(error)) return
      group%type = ints(2)
      allocate (group%object(0), group%name(0))
      do i = 1, ints(4)
         call read_record(file, 1, n_title, 0, id, title, error)
         if (allocated(error)) return
         n = size(group%name)
         if (i > n) then
            group%object = [group%object, spread(0, 1, max(n, 8))]
            allocate (longer(n + max(n, 8)))
            longer(:n) = group%name
            call move_alloc(longer, group%name)
         end if
         group%object(i) = id(1)
         group%name(i)%s = title
      end do
      if (ints(4) < 0) then
         call broken(file, 'a count is negative', error)
         return
      end if
      group%object = group%object(:ints(4))
      group%name = group%name(:ints(4))
      call read_codes(file, ints(5), group%code, error)
   end subroutine read_group

end module kj_t01_header
