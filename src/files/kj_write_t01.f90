!> Writes a history as the Radioss time history that OpenRadioss would have written of it: /TFILE/1
!> (64-bit, native byte order) or /TFILE/4 (32-bit, big endian, what most programs read), header
!> 3040. Layout: docs/theory/t01.md.
!>
!> Forces of bodies are impulses there, energies of springs stand in the globals twice, the last
!> state between samples has no row.
!> One file: columns, records and titles of one format.
module kj_write_t01
   use, intrinsic :: iso_fortran_env, only: int8, int32, real32, real64
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE
   use kj_version, only: KJOINT_VERSION
   use kj_channels, only: channels, groups, find_channel, find_t01, OF_RUN, OF_JOINT, OF_BODY, &
      OF_NODE, OF_SPRING, CH_FINAL, CH_IE
   use kj_history, only: history_t, n_entity
   use kj_reader, only: history_reader_t, open_history_file, read_rows, close_history_file
   use kj_t01, only: t01_name
   use kj_text, only: text_t
   use kj_output, only: settle_output, open_part, end_part
   implicit none
   private

   public :: write_t01

   integer, parameter :: AS_DOUBLE = 1, AS_SINGLE = 4         !! /TFILE types
   integer, parameter :: HEADER = 3040, N_HEAD = 80, N_TITLE = 40   !! code, lengths of texts
   integer, parameter :: N_GLOBAL = 22
   integer, parameter :: C_OFF = 1, C_SIE = 10, C_MASS = 34   !! codes that are no channels
   integer, parameter :: SPRING_TYPE = 6
   integer, parameter :: BLOCK = 2**18           !! reals of a history in memory at a time

   !> Where a column comes from when it is no place in a row
   integer, parameter :: IS_ZERO = 0, IS_ONE = -1, IS_MASS = -2

   !> Objects with the same variables
   type :: request_t
      integer :: owner = 0
      integer, allocatable :: entity(:)          !! places among the entities of the owner
      integer, allocatable :: code(:)            !! ascending
      integer, allocatable :: place(:, :)        !! (codes, entities) in a row, or IS_
   end type request_t

   !> A file being written, beside the one that it is to become
   type :: writer_t
      character(len=:), allocatable :: place, part
      integer :: descriptor = -1
      integer :: unit = -1, status = 0
      integer :: word = 8                        !! bytes of a real, and of 4 characters of a title
      logical :: swap = .false.                  !! byte order is not that of this machine
      character(len=200) :: why = ''
   end type writer_t

contains

   !> Write the rows of a history, and beside them PATH_TITLES with the names of the variables; each
   !> file takes its name when it is whole.
   !>
   !> Errors: ERR_FILE when the history cannot be read or the T01 not be written, ERR_INPUT when it
   !> would replace the history or no regular file.
   subroutine write_t01(history_path, path, type, error)
      character(len=*), intent(in) :: history_path, path
      integer, intent(in) :: type                !! /TFILE type 1 or 4; 0: as precise as the history
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(history_reader_t) :: reader
      type(history_t) :: history
      type(request_t), allocatable :: request(:)
      type(writer_t) :: file
      type(text_t) :: inputs(1)
      real(wp), allocatable :: rows(:, :)
      integer :: global(N_GLOBAL), n_row, first, n, i, final_at

      inputs(1)%s = history_path
      call open_history_file(history_path, reader, history, n_row, error)
      if (allocated(error)) return
      allocate (rows(history%n_value, max(1, min(n_row, BLOCK/history%n_value))))
      rows = 0.0_wp
      if (n_row > 0) call read_rows(reader, 1, 1, rows, error)
      if (.not. allocated(error)) then
         call find_columns(history, rows(:, 1), global, request)
         call open_file(path, inputs, .true., file, error)
         file%word = merge(4, 8, type == AS_SINGLE .or. (type /= AS_DOUBLE .and. &
            history%single_precision))
         ! 4-byte files are those of a big-endian machine
         file%swap = file%word == 4 .and. iachar(transfer(1_int32, 'a')) == 1
      end if
      if (.not. allocated(error)) then
         call put_header(file, history, request)
         final_at = place_of(history, CH_FINAL)
         do first = 1, n_row, size(rows, 2)
            n = min(size(rows, 2), n_row - first + 1)
            call read_rows(reader, first, n, rows, error)
            if (allocated(error)) exit
            do i = 1, n
               if (final_at > 0) then
                  if (rows(final_at, i) > 0.5_wp) cycle
               end if
               call put_row(file, history, global, request, rows(:, i))
            end do
         end do
         call end_file(path, file, error)
         if (.not. allocated(error)) call write_titles(path//'_TITLES', inputs, request, error)
      end if
      call close_history_file(reader, closing)
   end subroutine write_t01

   ! ---- which columns

   !> Places of the globals, and requests in the order of the format: springs, nodes, bodies
   subroutine find_columns(history, first_row, global, request)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: first_row(:)       !! not a number where a series is not there
      integer, intent(out) :: global(N_GLOBAL)
      type(request_t), allocatable, intent(out) :: request(:)

      integer, parameter :: ORDER(4) = [OF_JOINT, OF_SPRING, OF_NODE, OF_BODY]
      integer :: row, comp, i

      global = IS_ZERO
      do i = 1, N_GLOBAL
         call find_t01(OF_RUN, i, row, comp)
         if (row > 0) global(i) = place_of(history, row)
      end do
      global(C_SIE) = place_of(history, CH_IE)
      allocate (request(0))
      do i = 1, size(ORDER)
         call add_requests(history, ORDER(i), first_row, request)
      end do
   end subroutine find_columns

   !> One request for all entities that have the same channels
   subroutine add_requests(history, owner, first_row, request)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner
      real(wp), intent(in) :: first_row(:)
      type(request_t), allocatable, intent(inout) :: request(:)

      integer :: place(100, n_entity(history, owner)), e, k
      integer, allocatable :: members(:), codes(:)
      logical :: pending(n_entity(history, owner))
      type(request_t) :: one

      place = IS_ZERO
      do e = 1, size(place, 2)
         call find_places(history, owner, e, first_row, place(:, e))
      end do
      pending = .true.
      do while (any(pending))
         e = findloc(pending, .true., 1)
         codes = pack([(k, k=1, size(place, 1))], place(:, e) /= IS_ZERO)
         members = pack([(k, k=1, size(pending))], pending .and. &
            [(all((place(:, k) /= IS_ZERO) .eqv. (place(:, e) /= IS_ZERO)), k=1, size(pending))])
         pending(members) = .false.
         one = request_t(owner, members, codes, place(codes, members))
         request = [request, one]
      end do
   end subroutine add_requests

   !> Where each code of an entity stands in a row
   pure subroutine find_places(history, owner, e, first_row, place)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner, e
      real(wp), intent(in) :: first_row(:)
      integer, intent(inout) :: place(:)         !! by code

      integer :: v, code, at, k

      if (type_of(owner) == SPRING_TYPE) place(C_OFF) = IS_ONE
      if (owner == OF_BODY .and. allocated(history%entity(owner)%mass)) place(C_MASS) = IS_MASS
      do v = 1, size(history%variable)
         associate (variable => history%variable(v))
            if (channels(variable%channel)%owner /= owner) cycle
            code = channels(variable%channel)%t01
            if (owner == OF_SPRING) code = code_as_joint(variable%channel)
            if (code == 0) cycle
            at = variable%first + (e - 1)*variable%n_comp
            if (any(ieee_is_nan(first_row(at:at + variable%n_comp - 1)))) cycle
            do k = 1, variable%n_comp
               place(code + k - 1) = at + k - 1
            end do
         end associate
      end do
   end subroutine find_places

   !> A T01 has springs and joints in one kind of group: the code of the joint's channel of this
   !> name
   pure integer function code_as_joint(channel) result(code)
      integer, intent(in) :: channel

      integer :: row

      row = find_channel(OF_JOINT, trim(channels(channel)%name))
      code = 0
      if (row > 0) code = channels(row)%t01
   end function code_as_joint

   !> Place of a channel of the run in a row, IS_ZERO where there is none
   pure integer function place_of(history, channel) result(place)
      type(history_t), intent(in) :: history
      integer, intent(in) :: channel

      integer :: v

      place = IS_ZERO
      do v = 1, size(history%variable)
         if (history%variable(v)%channel == channel) place = history%variable(v)%first
      end do
   end function place_of

   ! ---- records

   !> Begin a file that is to become `path`. Errors: as settle_output, ERR_FILE
   subroutine open_file(path, inputs, binary, file, error)
      character(len=*), intent(in) :: path
      type(text_t), intent(in) :: inputs(:)
      logical, intent(in) :: binary              !! else lines
      type(writer_t), intent(out) :: file
      type(error_t), allocatable, intent(inout) :: error

      call settle_output(path, inputs, file%place, error)
      call open_part(file%place, file%part, file%descriptor, error)
      if (allocated(error)) return
      if (binary) then
         open (newunit=file%unit, file=file%part, access='stream', form='unformatted', &
            status='old', action='write', iostat=file%status, iomsg=file%why)
      else
         open (newunit=file%unit, file=file%part, status='old', action='write', &
            iostat=file%status, iomsg=file%why)
      end if
   end subroutine open_file

   !> End a file: it takes its name, or goes where something failed. Errors: ERR_FILE
   subroutine end_file(path, file, error)
      character(len=*), intent(in) :: path
      type(writer_t), intent(inout) :: file
      type(error_t), allocatable, intent(inout) :: error

      integer :: ignored

      if (file%status == 0) then
         close (file%unit, iostat=file%status, iomsg=file%why)
      else
         close (file%unit, iostat=ignored)
      end if
      if (file%status /= 0 .and. .not. allocated(error)) &
         call fail(error, ERR_FILE, 'cannot write '//path//': '//trim(file%why))
      if (allocated(file%part)) call end_part(file%part, file%descriptor, '', file%place, error)
   end subroutine end_file

   subroutine put_header(file, history, request)
      type(writer_t), intent(inout) :: file
      type(history_t), intent(in) :: history
      type(request_t), intent(in) :: request(:)

      integer, parameter :: NONE(0) = 0
      character(len=N_HEAD) :: origin
      character(len=10) :: title
      integer :: i, k, type

      origin(1:25) = ''
      origin(26:) = 'RADIOSS kjoint '//KJOINT_VERSION
      call put_mixed(file, [HEADER], history%title, N_HEAD, NONE)
      call put_mixed(file, NONE, origin, N_HEAD, NONE)
      call put_mixed(file, [0, 1, 0, 1, size(request), N_GLOBAL], '', 0, NONE)
      call put_mixed(file, [(i, i=1, N_GLOBAL)], '', 0, NONE)
      call put_mixed(file, [0], 'no_title', N_TITLE, NONE)
      call put_mixed(file, [0, 0, 0, 0, 0], 'GLOBAL MODEL', N_TITLE, NONE)
      do i = 1, size(request)
         associate (r => request(i))
            type = type_of(r%owner)
            title = groups(r%owner)%path
            call put_mixed(file, [i, type, 0, size(r%entity), size(r%code)], title, N_TITLE, NONE)
            do k = 1, size(r%entity)
               call put_object(file, history, r%owner, r%entity(k))
            end do
            call put_mixed(file, r%code, '', 0, NONE)
         end associate
      end do
   end subroutine put_header

   !> User id and name of an entity
   subroutine put_object(file, history, owner, e)
      type(writer_t), intent(inout) :: file
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner, e

      integer, parameter :: NONE(0) = 0

      associate (entity => history%entity(owner))
         if (allocated(entity%label)) then
            call put_mixed(file, [entity%id(e)], entity%label(e)%s, N_TITLE, NONE)
         else
            call put_mixed(file, [entity%id(e)], '', N_TITLE, NONE)
         end if
      end associate
   end subroutine put_object

   !> Time, globals, one record a request
   subroutine put_row(file, history, global, request, row)
      type(writer_t), intent(inout) :: file
      type(history_t), intent(in) :: history
      integer, intent(in) :: global(:)
      type(request_t), intent(in) :: request(:)
      real(wp), intent(in) :: row(:)

      real(wp), allocatable :: values(:)
      integer :: i, k, c, n

      call put_reals(file, row(:1))
      allocate (values(N_GLOBAL), source=0.0_wp)
      where (global /= IS_ZERO) values = row(max(1, global))
      call put_reals(file, values)
      do i = 1, size(request)
         deallocate (values)
         allocate (values(size(request(i)%place)))
         n = 0
         do k = 1, size(request(i)%entity)
            do c = 1, size(request(i)%code)
               n = n + 1
               select case (request(i)%place(c, k))
               case (IS_ONE)
                  values(n) = 1.0_wp
               case (IS_MASS)
                  values(n) = history%entity(request(i)%owner)%mass(request(i)%entity(k))
               case default
                  values(n) = row(request(i)%place(c, k))
               end select
            end do
         end do
         call put_reals(file, values)
      end do
   end subroutine put_row

   !> A record of integers, a text of n characters and integers; nothing where all are empty
   subroutine put_mixed(file, lead, text, n, trail)
      type(writer_t), intent(inout) :: file
      integer, intent(in) :: lead(:), n, trail(:)
      character(len=*), intent(in) :: text

      character(len=n) :: padded
      integer :: length, i

      if (file%status /= 0) return
      length = 4*(size(lead) + size(trail)) + n/4*file%word
      if (length == 0) return
      padded = text
      call put_ints(file, [length, lead])
      do i = 1, n, 4
         write (file%unit, iostat=file%status, iomsg=file%why) padded(i:i + 3)// &
            repeat(' ', file%word - 4)
      end do
      call put_ints(file, [trail, length])
   end subroutine put_mixed

   subroutine put_ints(file, ints)
      type(writer_t), intent(inout) :: file
      integer, intent(in) :: ints(:)

      integer(int8) :: bytes(4, size(ints))

      if (file%status /= 0) return
      bytes = reshape(transfer(int(ints, int32), bytes), shape(bytes))
      if (file%swap) bytes = bytes(4:1:-1, :)
      write (file%unit, iostat=file%status, iomsg=file%why) bytes
   end subroutine put_ints

   !> A record of reals
   subroutine put_reals(file, values)
      type(writer_t), intent(inout) :: file
      real(wp), intent(in) :: values(:)

      integer(int8) :: bytes(file%word, size(values))

      if (file%status /= 0 .or. size(values) == 0) return
      if (file%word == 4) then
         bytes = reshape(transfer(real(values, real32), bytes), shape(bytes))
      else
         bytes = reshape(transfer(real(values, real64), bytes), shape(bytes))
      end if
      if (file%swap) bytes = bytes(file%word:1:-1, :)
      call put_ints(file, [size(bytes)])
      if (file%status == 0) write (file%unit, iostat=file%status, iomsg=file%why) bytes
      call put_ints(file, [size(bytes)])
   end subroutine put_reals

   pure integer function type_of(owner) result(type)
      integer, intent(in) :: owner

      type = groups(owner)%t01_type
      if (owner == OF_SPRING) type = SPRING_TYPE
   end function type_of

   !> The names of the variables as /TH/TITLE has them: type code and name, a line each, in the
   !> order
   !> of a row; the type of the globals is 0
   subroutine write_titles(path, inputs, request, error)
      character(len=*), intent(in) :: path
      type(text_t), intent(in) :: inputs(:)
      type(request_t), intent(in) :: request(:)
      type(error_t), allocatable, intent(inout) :: error

      integer, parameter :: OF_GLOBALS = -1
      type(writer_t) :: file
      character(len=:), allocatable :: name
      integer :: i, k

      call open_file(path, inputs, .false., file, error)
      if (allocated(error)) return
      do k = 1, N_GLOBAL
         call put_title(0, t01_name(OF_GLOBALS, k))
      end do
      do i = 1, size(request)
         do k = 1, size(request(i)%code)
            name = t01_name(type_of(request(i)%owner), request(i)%code(k))
            call put_title(type_of(request(i)%owner), name(index(name, '/') + 1:))
         end do
      end do
      call end_file(path, file, error)

   contains

      subroutine put_title(type, name)
         integer, intent(in) :: type
         character(len=*), intent(in) :: name

         if (file%status == 0) write (file%unit, '(i10,/,a)', iostat=file%status, &
            iomsg=file%why) type, name
      end subroutine put_title
   end subroutine write_titles

end module kj_write_t01
