!> Writes a history as the Radioss time history that OpenRadioss would have written of it: /TFILE/1
!> (64-bit, native byte order) or /TFILE/4 (32-bit, big endian, what most programs read), header
!> 3040. Layout: docs/theory/t01.md.
!>
!> Forces of bodies are impulses there, energies of springs stand in the globals twice, the last
!> state between samples has no row.
module kj_write_t01
   use, intrinsic :: iso_c_binding, only: c_char, c_size_t
   use, intrinsic :: iso_fortran_env, only: int32, real32, real64
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_version, only: KJOINT_VERSION
   use kj_channels, only: channels, groups, find_channel, find_t01, OF_RUN, OF_JOINT, OF_BODY, &
      OF_NODE, OF_SPRING, CH_FINAL, CH_IE
   use kj_history, only: history_t, n_entity, place_of
   use kj_output, only: settle_output, begin_output, append_output, end_output, write_output
   use kj_reader, only: history_reader_t, open_history_file, next_row, rewind_rows, &
      close_history_file
   use kj_t01, only: t01_name
   use kj_text, only: text_t
   implicit none
   private

   public :: write_t01

   integer, parameter :: AS_DOUBLE = 1, AS_SINGLE = 4         !! /TFILE types
   integer, parameter :: HEADER = 3040, N_HEAD = 80, N_TITLE = 40   !! code, lengths of texts
   integer, parameter :: N_GLOBAL = 22
   integer, parameter :: C_OFF = 1, C_SIE = 10, C_MASS = 34   !! codes that are no channels
   integer, parameter :: SPRING_TYPE = 6
   integer, parameter :: NONE(0) = 0
   character(kind=c_char), parameter :: BYTE(1) = 'a'        !! what transfer makes

   integer(c_size_t), parameter :: MOST_BYTES = 2**20        !! that are not in the file yet

   !> Where a column comes from when it is no place in a row
   integer, parameter :: IS_ZERO = 0, IS_ONE = -1, IS_MASS = -2

   !> Objects with the same variables
   type :: request_t
      integer :: owner = 0
      integer, allocatable :: entity(:)          !! places among the entities of the owner
      integer, allocatable :: code(:)            !! ascending
      integer, allocatable :: place(:, :)        !! (codes, entities) in a row, or IS_
   end type request_t

   !> A file being written
   type :: writer_t
      character(len=:), allocatable :: place, part   !! what it is to become, and is
      integer :: word = 8                        !! bytes of a real, and of 4 characters of a title
      logical :: swap = .false.                  !! byte order is not that of this machine
      integer(c_size_t) :: n = 0                 !! bytes that are not in the file yet
      character(kind=c_char), allocatable :: bytes(:)
   end type writer_t

contains

   !> Write the rows of a history, and beside them PATH_TITLES with the names of the variables.
   !>
   !> Errors: ERR_FILE when the history cannot be read or the T01 not be written; ERR_INPUT when one
   !> would stand in the place of an input, or of something that is no regular file
   subroutine write_t01(history_path, path, type, error)
      character(len=*), intent(in) :: history_path, path
      integer, intent(in) :: type                !! /TFILE type 1 or 4; 0: as precise as the history
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(history_reader_t) :: reader
      type(history_t) :: history
      type(request_t), allocatable :: request(:)
      type(writer_t) :: file
      real(wp), allocatable :: row(:)
      integer :: global(N_GLOBAL), n_row, final_at
      logical :: more

      call open_history_file(history_path, reader, history, n_row, error)
      if (allocated(error)) return
      allocate (row(history%n_value), source=0.0_wp)
      call next_row(reader, row, more, error)
      if (.not. allocated(error)) then
         call find_columns(history, row, global, request)
         call settle_output(path//'_TITLES', [text_t(history_path)], file%place, error)
         call begin_output(path, [text_t(history_path)], file%place, file%part, error)
      end if
      if (.not. allocated(error)) then
         file%word = merge(4, 8, type == AS_SINGLE .or. (type /= AS_DOUBLE .and. &
            history%single_precision))
         file%swap = file%word == 4 .and. iachar(transfer(1_int32, 'a')) == 1   ! little-endian
         allocate (file%bytes(4096))
         call put_header(file, history, request)
         final_at = place_of(history, CH_FINAL)
         call rewind_rows(reader)
         do
            call next_row(reader, row, more, error)
            if (.not. more) exit
            if (any(row(max(1, final_at):final_at) > 0.5_wp)) cycle
            call put_row(file, history, global, request, row)
            if (file%n < MOST_BYTES) cycle
            call append_output(file%part, file%n, file%bytes, error)
            file%n = 0
            if (allocated(error)) exit
         end do
         call append_output(file%part, file%n, file%bytes, error)
         call end_output(file%part, file%place, error)
         call write_titles(path//'_TITLES', history_path, request, error)
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
            if (owner == OF_SPRING) then         ! a T01 has springs and joints in one kind of group
               code = 0
               k = find_channel(OF_JOINT, trim(channels(variable%channel)%name))
               if (k > 0) code = channels(k)%t01
            end if
            if (code == 0) cycle
            at = variable%first + (e - 1)*variable%n_comp
            if (any(ieee_is_nan(first_row(at:at + variable%n_comp - 1)))) cycle
            do k = 1, variable%n_comp
               place(code + k - 1) = at + k - 1
            end do
         end associate
      end do
   end subroutine find_places

   ! ---- records

   subroutine put_header(file, history, request)
      type(writer_t), intent(inout) :: file
      type(history_t), intent(in) :: history
      type(request_t), intent(in) :: request(:)

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

      associate (entity => history%entity(owner))
         if (allocated(entity%label)) &
            call put_mixed(file, [entity%id(e)], entity%label(e)%s, N_TITLE, NONE)
         if (.not. allocated(entity%label)) &
            call put_mixed(file, [entity%id(e)], '', N_TITLE, NONE)
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
      values = merge(row(max(1, global)), 0.0_wp, global /= IS_ZERO)
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

      length = 4*(size(lead) + size(trail)) + n/4*file%word
      if (length == 0) return
      padded = text
      call put_ints(file, [length, lead])
      do i = 1, n, 4
         call put_bytes(file, transfer(padded(i:i + 3)//repeat(' ', file%word - 4), BYTE))
      end do
      call put_ints(file, [trail, length])
   end subroutine put_mixed

   subroutine put_ints(file, ints)
      type(writer_t), intent(inout) :: file
      integer, intent(in) :: ints(:)

      call put_words(file, 4, transfer(int(ints, int32), BYTE))
   end subroutine put_ints

   !> Words of n bytes each, in the byte order of the file
   subroutine put_words(file, n, bytes)
      type(writer_t), intent(inout) :: file
      integer, intent(in) :: n
      character(kind=c_char), intent(in) :: bytes(:)

      integer :: i

      if (.not. file%swap) call put_bytes(file, bytes)
      if (file%swap) call put_bytes(file, [(bytes(i + n - 1:i:-1), i=1, size(bytes), n)])
   end subroutine put_words

   subroutine put_bytes(file, bytes)
      type(writer_t), intent(inout) :: file
      character(kind=c_char), intent(in) :: bytes(:)

      character(kind=c_char), allocatable :: more(:)

      if (file%n + size(bytes) > size(file%bytes)) then
         allocate (more(2*(file%n + size(bytes))))
         more(:file%n) = file%bytes(:file%n)
         call move_alloc(more, file%bytes)
      end if
      file%bytes(file%n + 1:file%n + size(bytes)) = bytes
      file%n = file%n + size(bytes)
   end subroutine put_bytes

   !> A record of reals
   subroutine put_reals(file, values)
      type(writer_t), intent(inout) :: file
      real(wp), intent(in) :: values(:)

      if (size(values) == 0) return
      call put_ints(file, [file%word*size(values)])
      if (file%word == 4) call put_words(file, 4, transfer(real(values, real32), BYTE))
      if (file%word == 8) call put_words(file, 8, transfer(real(values, real64), BYTE))
      call put_ints(file, [file%word*size(values)])
   end subroutine put_reals

   pure integer function type_of(owner) result(type)
      integer, intent(in) :: owner

      type = merge(SPRING_TYPE, groups(owner)%t01_type, owner == OF_SPRING)
   end function type_of

   !> Write the names of the variables as /TH/TITLE has them: type code and name, a line each, in
   !> the order of a row; the type of the globals is 0. Errors: as write_output
   subroutine write_titles(path, history_path, request, error)
      character(len=*), intent(in) :: path, history_path
      type(request_t), intent(in) :: request(:)
      type(error_t), allocatable, intent(inout) :: error

      integer, parameter :: OF_GLOBALS = -1
      character(len=:), allocatable :: text, name
      integer :: i, k

      text = ''
      do k = 1, N_GLOBAL
         call add(0, t01_name(OF_GLOBALS, k))
      end do
      do i = 1, size(request)
         do k = 1, size(request(i)%code)
            name = t01_name(type_of(request(i)%owner), request(i)%code(k))
            call add(type_of(request(i)%owner), name(index(name, '/') + 1:))
         end do
      end do
      call write_output(path, text, [text_t(history_path)], error)

   contains

      subroutine add(code, title)
         integer, intent(in) :: code
         character(len=*), intent(in) :: title

         character(len=10) :: number

         write (number, '(i10)') code
         text = text//number//new_line('a')//title//new_line('a')
      end subroutine add
   end subroutine write_titles

end module kj_write_t01
