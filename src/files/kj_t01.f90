!> Radioss time histories (T01) as a history of ours: every /TFILE type that holds data.
!>
!> A T01 knows no units of its own unless it was written with /TH/VERS >= 50; no cycles, no final
!> row, no cards: type, nodes and bodies of a joint, main node and inertia of a body are left
!> unallocated. Its springs are our joints. What our layout has no channel for is in `unknown`.
!> One file: names of variables and places in a history are two tables of one map.
module kj_t01
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_history, only: history_t, add_variable
   use kj_text, only: text_t, append_text
   use kj_channels, only: groups, CH_TIME, OF_JOINT, OF_BODY, OF_NODE, channels, find_t01, OF_RUN
   use kj_t01_file, only: t01_file_t, open_t01_file, close_t01_file
   use kj_t01_content, only: t01_header_t, read_t01_header, t01_rows_t, find_t01_rows, &
      read_t01_block, t01_group_t
   use kj_units, only: unit_system_t, NO_UNITS
   use kj_t01_repeats, only: number_objects
   implicit none
   private

   public :: t01_reader_t, open_t01, read_t01_rows, close_t01, t01_name

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

   !> Type codes of what is no group in the file
   integer, parameter :: OF_GLOBALS = -1, OF_PARTS = -2, OF_SUBSETS = -3

   type :: owner_name_t
      integer           :: type
      character(len=10) :: name
   end type owner_name_t

   type(owner_name_t), parameter :: owner_names(*) = [ &
      owner_name_t(OF_GLOBALS, ''),          &
      owner_name_t(OF_PARTS,   'part'),      &
      owner_name_t(OF_SUBSETS, 'subset'),    &
      owner_name_t(0,          'node'),      &
      owner_name_t(1,          'brick'),     &
      owner_name_t(2,          'quad'),      &
      owner_name_t(3,          'shell'),     &
      owner_name_t(4,          'truss'),     &
      owner_name_t(5,          'beam'),      &
      owner_name_t(6,          'joint'),     &
      owner_name_t(7,          'sh3n'),      &
      owner_name_t(51,         'sphcel'),    &
      owner_name_t(101,        'inter'),     &
      owner_name_t(102,        'rwall'),     &
      owner_name_t(103,        'rigid_body'), &
      owner_name_t(104,        'section'),   &
      owner_name_t(105,        'cyl_jo'),    &
      owner_name_t(106,        'airbag'),    &
      owner_name_t(107,        'monvol'),    &
      owner_name_t(108,        'accel'),     &
      owner_name_t(109,        'rivet'),     &
      owner_name_t(110,        'frame'),     &
      owner_name_t(111,        'fxbody'),    &
      owner_name_t(113,        'gauge'),     &
      owner_name_t(114,        'cluster'),   &
      owner_name_t(115,        'sph_flow'),  &
      owner_name_t(116,        'surf'),      &
      owner_name_t(117,        'tria'),      &
      owner_name_t(118,        'slipring'),  &
      owner_name_t(119,        'retractor'), &
      owner_name_t(120,        'sensor'),    &
      owner_name_t(121,        'checksum')]

   !> Names of variables with codes that follow one another
   type :: code_names_t
      integer           :: type      !! type code of the owner
      integer           :: first     !! code of the first name
      character(len=70) :: names     !! blanks between them
   end type code_names_t

   type(code_names_t), parameter :: code_names(*) = [ &
      code_names_t(OF_GLOBALS, 1,   'IE KE XMOM YMOM ZMOM MASS DT RKE EFW SIE CE HE'), &
      code_names_t(OF_GLOBALS, 13,  'CE_ELAST CE_FRIC CE_DAMP WPLA DMASS DMASS% M_IN M_OUT E_IN E_OUT'), &
      code_names_t(OF_PARTS,   1,   'IE KE XMOM YMOM ZMOM MASS HE TURBKE XCG YCG ZCG'), &
      code_names_t(OF_PARTS,   21,  'RIE KERB RKERB RKE ERODED'), &
      code_names_t(OF_PARTS,   28,  'HEAT VX VY VZ PW'), &
      code_names_t(OF_SUBSETS, 1,   'IE KE XMOM YMOM ZMOM MASS HE TURBKE XCG YCG ZCG'), &
      code_names_t(OF_SUBSETS, 21,  'RIE KERB RKERB RKE ERODED'), &
      code_names_t(OF_SUBSETS, 28,  'HEAT VX VY VZ PW'), &
      code_names_t(0,          1,   'DX DY DZ VX VY VZ AX AY AZ VRX VRY VRZ ARX ARY ARZ X Y Z TEMP'), &
      code_names_t(0,          620, 'REACX REACY REACZ REACXX REACYY REACZZ DRX DRY DRZ PEXT'), &
      code_names_t(6,          1,   'OFF FX FY FZ MX MY MZ LX LY LZ RX RY RZ IE F1 F2'), &
      code_names_t(6,          65,  'LENGTH FAIL'), &
      code_names_t(103,        1,   'FX FY FZ MX MY MZ RX RY RZ FXI FYI FZI MXI MYI MZI X Y Z DX DY DZ'), &
      code_names_t(103,        22,  'VX VY VZ AX AY AZ VRX VRY VRZ ARX ARY ARZ'), &
      code_names_t(103,        34,  'MASS IXX IYY IZZ IXY IYZ IZX STATUS')]

   type :: symbol_t
      integer          :: base       !! 1 mass, 2 length, 3 time
      character(len=2) :: text       !! UDUNITS symbol
      real(wp)         :: si         !! its SI value
   end type symbol_t

   type(symbol_t), parameter :: symbols(*) = [ &
      symbol_t(1, 'kg', 1.0_wp),    &
      symbol_t(1, 'g',  1.0e-3_wp), &
      symbol_t(1, 'mg', 1.0e-6_wp), &
      symbol_t(1, 'Mg', 1.0e3_wp),  &
      symbol_t(1, 'Gg', 1.0e6_wp),  &
      symbol_t(2, 'm',  1.0_wp),    &
      symbol_t(2, 'cm', 1.0e-2_wp), &
      symbol_t(2, 'mm', 1.0e-3_wp), &
      symbol_t(2, 'um', 1.0e-6_wp), &
      symbol_t(2, 'km', 1.0e3_wp),  &
      symbol_t(3, 's',  1.0_wp),    &
      symbol_t(3, 'ms', 1.0e-3_wp), &
      symbol_t(3, 'us', 1.0e-6_wp)]

   real(wp), parameter :: ROUNDING = 1.0e-6_wp     !! the file may hold 32-bit reals

   integer, parameter :: BODY_MASS = 34      !! code of the mass of a body, which is no channel

contains

   !> Open a file and say what it holds
   !>
   !> A vector channel exists when all its components are there for one entity at least; where
   !> they are not, its series is NaN, `given` is false and the lone components are in `unknown`.
   !> Entities ascend by user id; an id in several requests stands once, but a node whose values
   !> differ between two, which are then in different axes, as often as it has values.
   !> Errors: ERR_FILE when it cannot be opened, is no time history or is damaged.
   subroutine open_t01(path, reader, history, n_row, error)
      character(len=*), intent(in) :: path
      type(t01_reader_t), intent(out) :: reader
      type(history_t), intent(out) :: history
      integer, intent(out) :: n_row                    !! complete rows
      type(error_t), allocatable, intent(out) :: error

      type(t01_header_t) :: header
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
      if (header%has_units) then
         call name_units(header%si, history%units)
      else
         history%units%si = ieee_value(1.0_wp, ieee_quiet_nan)
         history%units%symbol = NO_UNITS
      end if
      call add_variable(history, CH_TIME, 1)
      allocate (reader%unknown(0))
      reader%source = [1]
      call map_globals(header%global_code, 1, history, reader%source, reader%unknown)
      do i = 1, size(header%part_code)
         call add_unknown(OF_PARTS, header%part_code(i), '', reader%unknown)
      end do
      do i = 1, size(header%subset_code)
         call add_unknown(OF_SUBSETS, header%subset_code(i), '', reader%unknown)
      end do
      call map_groups(header, reader, history, error)
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
   subroutine map_groups(header, reader, history, error)
      type(t01_header_t), intent(in) :: header
      type(t01_reader_t), intent(inout) :: reader
      type(history_t), intent(inout) :: history
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: first(:), mass_place(:), unused(:)
      integer :: i, n

      ! place before the first value of each group in a row of the file
      call place_groups(header, reader%rows, first)
      call map_entities(OF_JOINT, header%group, first, reader, history, unused, error)
      if (allocated(error)) return
      call map_entities(OF_BODY, header%group, first, reader, history, mass_place, error)
      if (allocated(error)) return
      call map_entities(OF_NODE, header%group, first, reader, history, unused, error)
      if (allocated(error)) return
      do i = 1, size(header%group)
         if (any(groups(2:)%t01_type == header%group(i)%type)) cycle
         do n = 1, size(header%group(i)%code)
            call add_unknown(header%group(i)%type, header%group(i)%code(n), '', reader%unknown)
         end do
      end do
      call read_masses(reader, mass_place, history%entity(OF_BODY)%mass, error)
   end subroutine map_groups

   !> Where the values of each group stand in a row: behind those of all records before
   subroutine place_groups(header, rows, first)
      type(t01_header_t), intent(in) :: header
      type(t01_rows_t), intent(in) :: rows
      integer, allocatable, intent(out) :: first(:)    !! (groups) values of a row before it

      integer :: i, record

      allocate (first(size(header%group)), source=0)
      record = 1 + count([size(header%global_code), header%n_part_value, header%n_subset_value] > 0)
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

   !> Name of a variable as we write it: "SIE", "node/TEMP", "section/7" where it has no name here
   pure function t01_name(type, code) result(text)
      integer, intent(in) :: type, code
      character(len=:), allocatable :: text

      integer :: i

      text = str(code)
      do i = 1, size(code_names)
         if (code_names(i)%type /= type .or. code < code_names(i)%first) cycle
         call take_word(trim(code_names(i)%names), code - code_names(i)%first + 1, text)
      end do
      do i = 1, size(owner_names)
         if (owner_names(i)%type /= type) cycle
         if (type /= OF_GLOBALS) text = trim(owner_names(i)%name)//'/'//text
         return
      end do
      text = 'type '//str(type)//'/'//text
   end function t01_name

   !> The n-th word; `word` stays when there are fewer
   pure subroutine take_word(text, n, word)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n
      character(len=:), allocatable, intent(inout) :: word

      integer :: i, first, length

      first = 1
      do i = 1, n
         length = index(text(first:)//' ', ' ') - 1
         if (length <= 0) return
         if (i < n) first = first + length + 1
         if (first > len(text)) return
      end do
      word = text(first:first + length - 1)
   end subroutine take_word

   !> Units from SI values; one without a symbol is written as a number and its SI unit
   subroutine name_units(si, units)
      real(wp), intent(in) :: si(3)                !! of the units of mass, length and time
      type(unit_system_t), intent(out) :: units

      character(len=*), parameter :: si_symbol(3) = ['kg', 'm ', 's ']
      integer :: i, j

      do i = 1, 3
         units%si(i) = si(i)
         write (units%symbol(i), '(a,es13.7,a)') '(', si(i), ' '//trim(si_symbol(i))//')'
         do j = 1, size(symbols)
            if (symbols(j)%base /= i) cycle
            if (abs(si(i) - symbols(j)%si) > ROUNDING*symbols(j)%si) cycle
            units%si(i) = symbols(j)%si
            units%symbol(i) = symbols(j)%text
         end do
      end do
   end subroutine name_units

   !> Globals: one series each
   subroutine map_globals(codes, before, history, source, unknown)
      integer, intent(in) :: codes(:)
      integer, intent(in) :: before                    !! values of a row before the first
      type(history_t), intent(inout) :: history
      integer, allocatable, intent(inout) :: source(:)   !! as in t01_reader_t
      type(text_t), allocatable, intent(inout) :: unknown(:)

      integer :: place(size(channels)), i, row, comp

      place = 0
      do i = 1, size(codes)
         call find_t01(OF_RUN, codes(i), row, comp)
         if (row == 0) then
            call add_unknown(OF_GLOBALS, codes(i), '', unknown)
         else
            place(row) = before + i
         end if
      end do
      do row = 1, size(channels)
         if (place(row) == 0) cycle
         call add_variable(history, row, 1)
         source = [source, place(row)]
      end do
   end subroutine map_globals

   !> All entities of one kind, from all groups of this kind
   subroutine map_entities(owner, all_groups, before, reader, history, mass_place, error)
      integer, intent(in) :: owner                     !! OF_ constant
      type(t01_group_t), intent(in) :: all_groups(:)
      integer, intent(in) :: before(:)                 !! values of a row before those of a group
      type(t01_reader_t), intent(inout) :: reader      !! gets sources and unknown variables
      type(history_t), intent(inout) :: history
      integer, allocatable, intent(out) :: mass_place(:)        !! place of the mass, 0 = none
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: id(:), entity(:)
      integer, allocatable :: place(:, :)     !! (components of all channels, entities)
      integer :: slot(size(channels)), row, n

      call number_objects(reader%file, reader%rows, all_groups, before, groups(owner)%t01_type, &
         owner == OF_NODE, entity, id, error)
      if (allocated(error)) return
      call collect_names(groups(owner)%t01_type, all_groups, entity, size(id), &
         history%entity(owner)%label)
      history%entity(owner)%id = id
      n = 0
      do row = 1, size(channels)
         slot(row) = n
         if (channels(row)%owner == owner .and. channels(row)%t01 > 0) n = n + channels(row)%n_comp
      end do
      allocate (place(n, size(id)), mass_place(size(id)), source=0)
      call place_values(owner, all_groups, before, entity, slot, place, mass_place, reader%unknown)
      do row = 1, size(channels)
         if (channels(row)%owner /= owner .or. channels(row)%t01 == 0) cycle
         n = channels(row)%n_comp
         call add_channel(owner, row, place(slot(row) + 1:slot(row) + n, :), history, &
            reader%source, reader%unknown)
      end do
   end subroutine map_entities

   !> The first name of each entity that is not blank
   subroutine collect_names(type, all_groups, entity, n_entity, label)
      integer, intent(in) :: type, entity(:), n_entity
      type(t01_group_t), intent(in) :: all_groups(:)
      type(text_t), allocatable, intent(out) :: label(:)

      integer :: i, j, k, object

      allocate (label(n_entity))
      do i = 1, n_entity
         label(i)%s = ''
      end do
      object = 0
      do i = 1, size(all_groups)
         if (all_groups(i)%type /= type) cycle
         do j = 1, size(all_groups(i)%object)
            object = object + 1
            k = entity(object)
            if (len(label(k)%s) == 0) label(k)%s = all_groups(i)%name(j)%s
         end do
      end do
   end subroutine collect_names

   !> Place in a row of the file of every component we have a channel for; the first group wins
   subroutine place_values(owner, all_groups, before, entity, slot, place, mass_place, unknown)
      integer, intent(in) :: owner, before(:), entity(:)
      integer, intent(in) :: slot(:)
      type(t01_group_t), intent(in) :: all_groups(:)
      integer, intent(inout) :: place(:, :), mass_place(:)
      type(text_t), allocatable, intent(inout) :: unknown(:)

      integer :: i, j, k, n, row, comp, at, first

      first = 0
      do i = 1, size(all_groups)
         if (all_groups(i)%type /= groups(owner)%t01_type) cycle
         n = size(all_groups(i)%code)
         associate (mine => entity(first + 1:first + size(all_groups(i)%object)))
            do k = 1, n
               call find_t01(owner, all_groups(i)%code(k), row, comp)
               if (owner == OF_BODY .and. all_groups(i)%code(k) == BODY_MASS) then
                  mass_place(mine) = [(before(i) + (j - 1)*n + k, j=1, size(mine))]
               else if (row == 0) then
                  call add_unknown(all_groups(i)%type, all_groups(i)%code(k), '', unknown)
               else
                  at = slot(row) + comp
                  do j = 1, size(mine)
                     if (place(at, mine(j)) == 0) place(at, mine(j)) = before(i) + (j - 1)*n + k
                  end do
               end if
            end do
         end associate
         first = first + size(all_groups(i)%object)
      end do
   end subroutine place_values

   !> Add the channel if one entity has all its components; name the components that stand alone
   subroutine add_channel(owner, row, place, history, source, unknown)
      integer, intent(in) :: owner, row                !! OF_ constant, row of the channel table
      integer, intent(in) :: place(:, :)               !! (components, entities)
      type(history_t), intent(inout) :: history
      integer, allocatable, intent(inout) :: source(:)   !! as in t01_reader_t
      type(text_t), allocatable, intent(inout) :: unknown(:)

      logical :: whole(size(place, 2))
      integer :: kept(size(place, 1), size(place, 2)), comp

      whole = all(place > 0, dim=1)
      do comp = 1, size(place, 1)
         if (.not. any(place(comp, :) > 0 .and. .not. whole)) cycle
         call add_unknown(groups(owner)%t01_type, channels(row)%t01 + comp - 1, &
            ' (without the other components)', unknown)
      end do
      if (.not. any(whole)) return
      kept = merge(place, 0, spread(whole, 1, size(place, 1)))
      call add_variable(history, row, size(place, 2))
      source = [source, reshape(kept, [size(kept)])]
   end subroutine add_channel

   !> Note a variable that has no channel, once
   subroutine add_unknown(type, code, remark, unknown)
      integer, intent(in) :: type, code
      character(len=*), intent(in) :: remark
      type(text_t), allocatable, intent(inout) :: unknown(:)

      character(len=:), allocatable :: name
      integer :: i

      name = t01_name(type, code)//remark
      do i = 1, size(unknown)
         if (unknown(i)%s == name) return
      end do
      call append_text(unknown, name)
   end subroutine add_unknown

end module kj_t01
