!> C functions of the samples that a model keeps in memory. include/kjoint.h is their documentation.
module kjoint_c_samples
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_size_t, c_double, c_f_pointer, &
      c_associated
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_units, only: unit_text
   use kj_version, only: KJOINT_VERSION
   use kj_history, only: history_t, variable_t
   use kj_channels, only: channels, groups, OF_RUN
   use kj_series, only: series_t, find_series, series_value
   use kjoint, only: simulation_history
   use kjoint_c_base, only: box_t, entered, outcome, refuse, get_text, put_text, OK, OF_MODEL
   implicit none
   private

   public :: kj_version, kj_model_channels, kj_model_shape, kj_model_series, kj_model_unit, &
      kj_model_about, kj_model_curve

   integer, parameter :: ABOUT_WIDTH = 120     !! room for an id and a label of a hundred letters

contains

   !> See kjoint.h
   integer(c_int) function kj_version(buffer, size) bind(c, name='kj_version') result(status)
      type(c_ptr), value :: buffer
      integer(c_size_t), value :: size

      status = put_text(KJOINT_VERSION, buffer, size)
   end function kj_version

   !> Name of a variable as in the history file
   function name_of(v) result(name)
      type(variable_t), intent(in) :: v
      character(len=40) :: name

      associate (c => channels(v%channel))
         name = c%name
         if (len_trim(groups(c%owner)%path) > 0) name = trim(groups(c%owner)%path)//'/'//c%name
      end associate
   end function name_of

   !> A variable of the samples of a model. Errors: ERR_INPUT
   subroutine find_variable(box, channel, v, error)
      type(box_t), intent(in) :: box
      type(c_ptr), intent(in) :: channel
      type(variable_t), intent(out) :: v
      type(error_t), allocatable, intent(out) :: error

      type(history_t) :: history
      character(len=:), allocatable :: name
      integer :: i

      call get_text(channel, name)
      history = simulation_history(box%sim)
      do i = 1, size(history%variable)
         v = history%variable(i)
         if (name_of(v) == name) return
      end do
      call fail(error, ERR_INPUT, 'the history has no channel '//name)
   end subroutine find_variable

   !> See kjoint.h
   integer(c_int) function kj_model_channels(model, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(history_t) :: history
      character(len=:), allocatable :: text
      integer :: i

      if (.not. entered(model, OF_MODEL, box, status)) return
      history = simulation_history(box%sim)
      text = trim(name_of(history%variable(1)))
      do i = 2, ubound(history%variable, 1)
         text = text//new_line('a')//trim(name_of(history%variable(i)))
      end do
      status = put_text(text, buffer, size)
   end function kj_model_channels

   !> See kjoint.h
   integer(c_int) function kj_model_shape(model, channel, n_row, n_entity, n_comp) bind(c) &
      result(status)
      type(c_ptr), value :: model, channel, n_row, n_entity, n_comp

      type(box_t), pointer :: box
      type(variable_t) :: v
      type(error_t), allocatable :: error
      integer(c_int), pointer :: number

      if (.not. entered(model, OF_MODEL, box, status, c_associated(n_row) .and. &
         c_associated(n_entity) .and. c_associated(n_comp), &
         'n_row, n_entity or n_comp is null')) return
      call find_variable(box, channel, v, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(n_row, number)
      number = int(box%samples%n_row, c_int)
      call c_f_pointer(n_entity, number)
      number = int(v%n_entity, c_int)
      call c_f_pointer(n_comp, number)
      number = int(v%n_comp, c_int)
   end function kj_model_shape

   !> See kjoint.h
   integer(c_int) function kj_model_series(model, channel, count, values) bind(c) result(status)
      type(c_ptr), value :: model, channel, values
      integer(c_int), value :: count

      type(box_t), pointer :: box
      type(variable_t) :: v
      type(error_t), allocatable :: error
      real(c_double), pointer :: series(:, :)
      integer :: width

      if (.not. entered(model, OF_MODEL, box, status)) return
      call find_variable(box, channel, v, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      width = v%n_entity*v%n_comp
      if (count /= width*box%samples%n_row .or. .not. c_associated(values)) then
         status = refuse('the channel has '//str(width*box%samples%n_row)//' values, count is '// &
            str(int(count))//', or values is null', box%message)
         return
      end if
      call c_f_pointer(values, series, [width, box%samples%n_row])
      if (box%samples%n_row > 0) &
         series = box%samples%rows(v%first:v%first + width - 1, :box%samples%n_row)
   end function kj_model_series

   !> See kjoint.h
   integer(c_int) function kj_model_unit(model, channel, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, channel, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(variable_t) :: v
      type(error_t), allocatable :: error
      type(history_t) :: history

      if (.not. entered(model, OF_MODEL, box, status)) return
      call find_variable(box, channel, v, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      history = simulation_history(box%sim)
      status = put_text(unit_text(channels(v%channel)%dim, history%units), buffer, size)
   end function kj_model_unit

   !> See kjoint.h
   integer(c_int) function kj_model_about(model, channel, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, channel, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(variable_t) :: v
      type(error_t), allocatable :: error
      type(history_t) :: history
      character(len=:), allocatable :: text
      integer :: i, n

      if (.not. entered(model, OF_MODEL, box, status)) return
      call find_variable(box, channel, v, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      history = simulation_history(box%sim)
      allocate (character(len=60 + ABOUT_WIDTH*v%n_entity) :: text)
      n = 0
      call add(trim(channels(v%channel)%meaning))
      if (channels(v%channel)%owner /= OF_RUN) then
         associate (e => history%entity(channels(v%channel)%owner))
            do i = 1, v%n_entity
               call add(new_line('a')//str(e%id(i))//' ')
               if (.not. allocated(e%label)) cycle
               if (allocated(e%label(i)%s)) call add(trim(e%label(i)%s))
            end do
         end associate
      end if
      status = put_text(text(:n), buffer, size)

   contains

      subroutine add(part)
         character(len=*), intent(in) :: part

         integer :: last

         last = min(n + len(part), len(text))
         text(n + 1:last) = part
         n = last
      end subroutine add
   end function kj_model_about

   !> See kjoint.h
   integer(c_int) function kj_model_curve(model, name, count, values) bind(c) result(status)
      type(c_ptr), value :: model, name, values
      integer(c_int), value :: count

      type(box_t), pointer :: box
      type(series_t), allocatable :: series(:)
      type(error_t), allocatable :: error
      real(c_double), pointer :: y(:)
      character(len=:), allocatable :: text
      integer :: i

      if (.not. entered(model, OF_MODEL, box, status, c_associated(values), 'values is null')) &
         return
      call get_text(name, text)
      associate (samples => box%samples)
         call find_series(simulation_history(box%sim), text, series, error)
         if (.not. allocated(error)) then
            if (size(series) /= 1) then
               call fail(error, ERR_INPUT, text//' means '//str(size(series))// &
                  ' curves, not one, such as '//series(1)%name)
            else if (count /= samples%n_row) then
               call fail(error, ERR_INPUT, 'there are '//str(samples%n_row)//' samples, not '// &
                  str(int(count)))
            end if
         end if
         status = outcome(error, box%message)
         if (status /= OK) return
         call c_f_pointer(values, y, [count])
         do i = 1, samples%n_row
            y(i) = series_value(samples%history, series(1), samples%rows(:, i))
         end do
      end associate
   end function kj_model_curve

end module kjoint_c_samples
