!> Series of a history as text that other programs read: CSV for spreadsheets, JSON.
module kj_export
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_units, only: unit_text, dimensions, D_TIME
   use kj_text, only: as_utf8, is_plain
   use kj_channels, only: channels, AS_F64, OF_RUN
   use kj_history, only: history_t
   use kj_series, only: series_t, find_series, series_value, series_unit, channel_path, NORM
   use kj_reader, only: history_reader_t, open_history_file, next_row, close_history_file
   use kj_words, only: buffer_t, add, json_member, json_pair, json_real, json_list, comma
   implicit none
   private

   public :: export_csv, export_json

   character(len=3), parameter :: BYTE_ORDER_MARK = char(239)//char(187)//char(191)
   character, parameter :: NL = new_line('a')

contains

   !> A row a sample; the head names each column with its unit: joint/force[pin C].x [kg m s-2].
   !>
   !> A head that is not ASCII begins with a byte order mark, by which spreadsheets know UTF-8.
   !> Errors: ERR_FILE when the history cannot be read, ERR_INPUT for a name that means nothing
   subroutine export_csv(path, names, separator, decimal, text, error)
      character(len=*), intent(in) :: path, names      !! names as find_series has them
      character, intent(in) :: separator, decimal      !! between columns; before the fraction
      type(buffer_t), intent(out) :: text
      type(error_t), allocatable, intent(out) :: error

      type(history_t) :: history
      type(series_t), allocatable :: series(:)
      real(wp), allocatable :: time(:), values(:, :)
      character(len=:), allocatable :: head
      integer :: i, k

      call read_series(path, names, history, series, time, values, error)
      if (allocated(error)) return
      head = quoted('time ['//unit_text(D_TIME, history%units)//']', separator)
      do k = 1, size(series)
         head = head//separator//quoted(as_utf8(series(k)%name)//' ['// &
            series_unit(history, series(k))//']', separator)
      end do
      if (.not. is_plain(head)) call add(text, BYTE_ORDER_MARK)
      call add(text, head//NL)
      do i = 1, size(time)
         call add(text, number(time(i), decimal))
         do k = 1, size(series)
            call add(text, separator)
            if (is_whole(history, series(k))) then
               call add(text, str(nint(values(i, k))))
            else
               call add(text, number(values(i, k), decimal))
            end if
         end do
         call add(text, NL)
      end do
   end subroutine export_csv

   !> One object: title, time, and of each series name, channel, entity, label, component, unit,
   !> its exponents of mass, length and time, meaning and values; null where a value is not finite.
   !> Errors: as export_csv
   subroutine export_json(path, names, text, error)
      character(len=*), intent(in) :: path, names
      type(buffer_t), intent(out) :: text
      type(error_t), allocatable, intent(out) :: error

      type(history_t) :: history
      type(series_t), allocatable :: series(:)
      real(wp), allocatable :: time(:), values(:, :)
      integer :: k

      call read_series(path, names, history, series, time, values, error)
      if (allocated(error)) return
      call add(text, '{'//json_member('history', path)//', '// &
         json_member('title', trim(history%title))//', '// &
         json_pair('unit_si', json_list(history%units%si))//', '//json_pair('unit_symbol', &
         json_list(history%units%symbol))//','//NL//' '// &
         json_pair('time', '{'//json_member('units', unit_text(D_TIME, history%units))//', '))
      call add_values(time, text)
      call add(text, '},'//NL//' '//json_pair('series', '['))
      do k = 1, size(series)
         call add(text, NL//'  {'//described(history, series(k))//', ')
         call add_values(values(:, k), text)
         call add(text, '}'//trim(comma(k, size(series))))
      end do
      call add(text, NL//']}'//NL)
   end subroutine export_json

   !> Read a history from either kind of file and keep what the names mean
   subroutine read_series(path, names, history, series, time, values, error)
      character(len=*), intent(in) :: path, names
      type(history_t), intent(out) :: history
      type(series_t), allocatable, intent(out) :: series(:)
      real(wp), allocatable, intent(out) :: time(:), values(:, :)   !! (rows), (rows, series)
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(history_reader_t) :: reader
      real(wp), allocatable :: row(:)
      integer :: n_row, i, k
      logical :: more

      call open_history_file(path, reader, history, n_row, error)
      if (allocated(error)) return
      call find_series(history, names, series, error)
      if (.not. allocated(error)) then
         allocate (time(n_row), values(n_row, size(series)), row(history%n_value))
         do i = 1, n_row
            call next_row(reader, row, more, error)
            if (.not. more) exit
            time(i) = row(history%variable(1)%first)
            do k = 1, size(series)
               values(i, k) = series_value(history, series(k), row)
            end do
         end do
      end if
      call close_history_file(reader, closing)
   end subroutine read_series

   !> What a series is, as members of an object
   function described(history, series) result(json)
      type(history_t), intent(in) :: history
      type(series_t), intent(in) :: series
      character(len=:), allocatable :: json

      integer :: owner

      associate (channel => history%variable(series%variable)%channel)
         owner = channels(channel)%owner
         json = json_member('name', series%name)//', '// &
            json_member('channel', channel_path(channel))
         if (owner /= OF_RUN) then
            json = json//', '//json_member('entity', history%entity(owner)%id(series%entity))
            if (allocated(history%entity(owner)%label)) json = json//', '// &
               json_member('label', trim(history%entity(owner)%label(series%entity)%s))
         end if
         if (history%variable(series%variable)%n_comp > 1) json = json//', '// &
            json_member('component', series%name(index(series%name, '.', back=.true.) + 1:))
         json = json//', '//json_member('units', series_unit(history, series))// &
            ', '//json_pair('dimension', json_list(dimensions(channels(channel)%dim)%exponents))// &
            ', '//json_member('angle', dimensions(channels(channel)%dim)%angle)// &
            ', '//json_member('class', trim(channels(channel)%class))// &
            ', '//json_member('meaning', trim(channels(channel)%meaning))
      end associate
   end function described

   subroutine add_values(values, text)
      real(wp), intent(in) :: values(:)
      type(buffer_t), intent(inout) :: text

      integer :: i

      call add(text, '"values": [')
      do i = 1, size(values)
         call add(text, json_real(values(i))//comma(i, size(values)))
      end do
      call add(text, ']')
   end subroutine add_values

   pure logical function is_whole(history, series)
      type(history_t), intent(in) :: history
      type(series_t), intent(in) :: series

      is_whole = series%comp /= NORM .and. &
         channels(history%variable(series%variable)%channel)%kind /= AS_F64
   end function is_whole

   !> All digits, with this sign before the fraction; an empty field for what is not finite
   pure function number(value, decimal) result(text)
      real(wp), intent(in) :: value
      character, intent(in) :: decimal
      character(len=:), allocatable :: text

      integer :: dot

      text = json_real(value)
      if (text == 'null') text = ''
      dot = index(text, '.')
      if (dot > 0) text(dot:dot) = decimal
   end function number

   !> A field in quotes where it holds the separator or quotes
   pure function quoted(text, separator) result(field)
      character(len=*), intent(in) :: text
      character, intent(in) :: separator
      character(len=:), allocatable :: field

      integer :: i

      field = text
      if (scan(text, separator//'"'//NL) == 0) return
      field = '"'
      do i = 1, len(text)
         if (text(i:i) == '"') field = field//'"'
         field = field//text(i:i)
      end do
      field = field//'"'
   end function quoted

end module kj_export
