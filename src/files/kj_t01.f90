!> Radioss time histories (T01) as a history of ours: every /TFILE type that holds data.
!>
!> A T01 knows no units of its own unless it was written with /TH/VERS >= 50; no cycles, no final
!> row, no cards: type, nodes and bodies of a joint, main node and inertia of a body are left
!> unallocated. Its springs are our joints. What our layout has no channel for is in `unknown`.
module kj_t01
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_history, only: history_t, text_t, add_variable
   use kj_channels, only: groups, CH_TIME, OF_JOINT, OF_BODY, OF_NODE
   use kj_t01_file, only: t01_file_t, open_t01_file, close_t01_file
   use kj_t01_header, only: t01_header_t, read_t01_header
   use kj_t01_rows, only: t01_rows_t, find_t01_rows, read_t01_block
   use kj_t01_map, only: t01_map_t, map_entities, map_globals, add_unknown
   use kj_t01_names, only: OF_PARTS, OF_SUBSETS
   use kj_t01_units, only: name_units
   implicit none
   private

   public :: t01_reader_t, open_t01, read_t01_rows, close_t01

   !> An open file; components are for reading only
   type :: t01_reader_t
      type(t01_file_t) :: file
      type(t01_rows_t) :: rows
      integer, allocatable :: source(:)      !! (n_value) place in a row of the file, 0 = not there
      logical, allocatable :: given(:)       !! (n_value) the file holds this series
      logical :: has_units = .false.         !! history%units were in the file
      character(len=:), allocatable :: origin    !! date, program, machine
      character(len=:), allocatable :: note      !! set when something was left out
      type(text_t), allocatable :: unknown(:)    !! variables without a channel of ours
   end type t01_reader_t

contains

   !> Open a file and say what it holds
   !>
   !> A vector channel exists when all its components are there for one entity at least; where
   !> they are not, its series is NaN, `given` is false and the lone components are in `unknown`.
   !> Entities ascend by user id, an id in several requests stands once.
   !> Errors: ERR_FILE when it cannot be opened, is no time history or is damaged.
   subroutine open_t01(path, reader, history, n_row, error)
      character(len=*), intent(in) :: path
      type(t01_reader_t), intent(out) :: reader
      type(history_t), intent(out) :: history
      integer, intent(out) :: n_row                    !! complete rows
      type(error_t), allocatable, intent(out) :: error

      type(t01_header_t) :: header
      type(t01_map_t) :: map
      integer :: i

      n_row = 0
      call open_t01_file(path, reader%file, error)
      if (allocated(error)) return
      call read_t01_header(reader%file, header, error)
      if (.not. allocated(error)) call locate_rows(reader, header, error)
      if (allocated(error)) then
         call close_t01(reader)
         return
      end if
      n_row = reader%rows%n_row
      if (reader%rows%cut_off) reader%note = 'row '//str(n_row + 1)//' is cut off and left out'

      history%title = header%title
      history%legacy = .true.
      history%single_precision = reader%file%is_text .or. reader%file%word == 4
      reader%origin = header%origin
      reader%has_units = header%has_units
      if (header%has_units) call name_units(header%si, history%units)
      call add_variable(history, CH_TIME, 1)
      allocate (reader%unknown(0), map%source(1))
      map%source = 1
      call map_globals(header%global_code, 1, history, map, reader%unknown)
      do i = 1, size(header%part_code)
         call add_unknown(OF_PARTS, header%part_code(i), '', reader%unknown)
      end do
      do i = 1, size(header%subset_code)
         call add_unknown(OF_SUBSETS, header%subset_code(i), '', reader%unknown)
      end do
      call map_groups(header, reader, history, map, error)
      call move_alloc(map%source, reader%source)
      reader%given = reader%source > 0
      if (allocated(error)) call close_t01(reader)
   end subroutine open_t01

   !> The records of a row: time, globals, parts, subsets, one a group
   subroutine locate_rows(reader, header, error)
      type(t01_reader_t), intent(inout) :: reader
      type(t01_header_t), intent(in) :: header
      type(error_t), allocatable, intent(out) :: error

      integer :: n_real(4 + size(header%group)), i
      logical :: used(4 + size(header%group))

      n_real(:4) = [1, size(header%global_code), header%n_part_value, header%n_subset_value]
      used(:4) = [.true., .true., .false., .false.]
      do i = 1, size(header%group)
         n_real(4 + i) = size(header%group(i)%object)*size(header%group(i)%code)
         used(4 + i) = any(groups(2:)%t01_type == header%group(i)%type)
      end do
      call find_t01_rows(reader%file, n_real, used, reader%rows, error)
   end subroutine locate_rows

   !> Joints, bodies and nodes with their channels and what is known of them
   subroutine map_groups(header, reader, history, map, error)
      type(t01_header_t), intent(in) :: header
      type(t01_reader_t), intent(inout) :: reader
      type(history_t), intent(inout) :: history
      type(t01_map_t), intent(inout) :: map
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: first(:), mass_place(:), unused(:)
      integer :: i, n

      ! place before the first value of each group in a row of the file
      call place_groups(header, reader%rows, first)
      call map_entities(OF_JOINT, header%group, first, history, map, history%joint_id, &
         history%joint_label, unused, reader%unknown)
      call map_entities(OF_BODY, header%group, first, history, map, history%body_id, &
         history%body_label, mass_place, reader%unknown)
      call map_entities(OF_NODE, header%group, first, history, map, history%node_id, &
         history%node_label, unused, reader%unknown)
      do i = 1, size(header%group)
         if (any(groups(2:)%t01_type == header%group(i)%type)) cycle
         do n = 1, size(header%group(i)%code)
            call add_unknown(header%group(i)%type, header%group(i)%code(n), '', reader%unknown)
         end do
      end do
      call read_masses(reader, mass_place, history%body_mass, error)
   end subroutine map_groups

   !> Where the values of each group stand in a row: behind those of all records before
   subroutine place_groups(header, rows, first)
      type(t01_header_t), intent(in) :: header
      type(t01_rows_t), intent(in) :: rows
      integer, allocatable, intent(out) :: first(:)    !! (groups) values of a row before it

      integer :: i, record

      allocate (first(size(header%group)), source=0)
      record = 1 + count([size(header%global_code), header%n_part_value, &
         header%n_subset_value] > 0)
      do i = 1, size(header%group)
         if (size(header%group(i)%object)*size(header%group(i)%code) == 0) cycle
         first(i) = sum(rows%n_real(:record))
         record = record + 1
      end do
   end subroutine place_groups

   !> Masses of the bodies from the first row; not allocated when no body has one
   subroutine read_masses(reader, place, mass, error)
      type(t01_reader_t), intent(inout) :: reader
      integer, intent(in) :: place(:)                  !! place in a row of the file, 0 = none
      real(wp), allocatable, intent(out) :: mass(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: values(:, :)
      integer :: i, n

      if (all(place == 0) .or. reader%rows%n_row == 0) return
      allocate (mass(size(place)), source=ieee_value(1.0_wp, ieee_quiet_nan))
      call read_t01_block(reader%file, reader%rows, 1, 1, values, n, error)
      if (allocated(error)) return
      do i = 1, size(place)
         if (place(i) > 0) mass(i) = values(place(i), 1)
      end do
   end subroutine read_masses

   !> Read n rows from row `first` on, as history%variable says; memory does not grow with n
   !>
   !> Errors: ERR_FILE when a row is damaged.
   subroutine read_t01_rows(reader, first, n, rows, error)
      type(t01_reader_t), intent(inout) :: reader
      integer, intent(in) :: first, n
      real(wp), intent(out) :: rows(:, :)              !! (history%n_value, >= n)
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: values(:, :)
      integer :: done, got, i, k

      done = 0
      do while (done < n)
         call read_t01_block(reader%file, reader%rows, first + done, n - done, values, got, error)
         if (allocated(error)) return
         do i = 1, got
            do k = 1, size(reader%source)
               if (reader%source(k) > 0) then
                  rows(k, done + i) = values(reader%source(k), i)
               else
                  rows(k, done + i) = ieee_value(1.0_wp, ieee_quiet_nan)
               end if
            end do
         end do
         done = done + got
      end do
   end subroutine read_t01_rows

   !> Close; nothing happens when it is not open
   subroutine close_t01(reader)
      type(t01_reader_t), intent(inout) :: reader

      call close_t01_file(reader%file)
   end subroutine close_t01

end module kj_t01
