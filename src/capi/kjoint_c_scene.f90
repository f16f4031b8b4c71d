!> C functions that ask and change a model between its steps. include/kjoint.h is their
!> documentation.
!> One file: functions that ask a model and change it
module kjoint_c_scene
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_f_pointer, c_associated, &
      c_size_t
   use kj_error, only: error_t, str, fail, ERR_INPUT
   use kj_host, only: joint_result_t
   use kjoint, only: body_state_t, simulation_bodies, simulation_joints, body_state, joint_state, &
      node_position, set_body_load, set_load_factor, set_body_velocity, set_body_pose, lock_joint, &
      save_simulation, restore_simulation, simulation_history
   use kjoint_c_base, only: box_t, entered, outcome, refuse, put_count, c_joint_result_t, &
      c_joint_result, OK, OF_MODEL, put_text
   use kj_system, only: c_text
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_units, only: unit_text
   use kj_version, only: KJOINT_VERSION
   use kj_history, only: history_t, variable_t
   use kj_channels, only: channels, OF_RUN
   use kj_series, only: series_t, find_series, series_value, channel_path
   implicit none
   private

   public :: kj_model_body_count, kj_model_joint_count, kj_model_body_ids, kj_model_joint_ids, &
      kj_model_body, kj_model_joint, kj_model_node, kj_model_set_body_load, &
      kj_model_set_load_factor, kj_model_set_body_velocity, kj_model_set_body_pose, &
      kj_model_lock_joint, kj_model_save, kj_model_restore, kj_version, kj_model_channels, &
      kj_model_shape, kj_model_series, kj_model_unit, kj_model_about, kj_model_curve

   integer, parameter :: ABOUT_WIDTH = 120     !! room for an id and a label of a hundred letters

   !> kj_body
   type, bind(c) :: c_body_t
      integer(c_int) :: id
      real(c_double) :: mass, position(3), attitude(4), velocity(3), omega(3), force(3), moment(3)
   end type c_body_t

contains

   !> See kjoint.h
   integer(c_int) function kj_model_body_count(model, n) bind(c) result(status)
      type(c_ptr), value :: model, n

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) &
         status = put_count(size(simulation_bodies(box%sim)), n)
   end function kj_model_body_count

   !> See kjoint.h
   integer(c_int) function kj_model_joint_count(model, n) bind(c) result(status)
      type(c_ptr), value :: model, n

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) &
         status = put_count(size(simulation_joints(box%sim)), n)
   end function kj_model_joint_count

   !> See kjoint.h
   integer(c_int) function kj_model_body_ids(model, count, ids) bind(c) result(status)
      type(c_ptr), value :: model, ids
      integer(c_int), value :: count

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) status = put_ids(simulation_bodies(box%sim), box, &
         count, ids)
   end function kj_model_body_ids

   !> See kjoint.h
   integer(c_int) function kj_model_joint_ids(model, count, ids) bind(c) result(status)
      type(c_ptr), value :: model, ids
      integer(c_int), value :: count

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) status = put_ids(simulation_joints(box%sim), box, &
         count, ids)
   end function kj_model_joint_ids

   integer(c_int) function put_ids(list, box, count, ids) result(status)
      integer, intent(in) :: list(:)
      type(box_t), intent(inout) :: box
      integer(c_int), intent(in) :: count
      type(c_ptr), intent(in) :: ids

      integer(c_int), pointer :: numbers(:)

      if (count < size(list) .or. .not. c_associated(ids)) then
         status = refuse('there are '//str(size(list))//' ids, and ids has no room for them', &
            box%message)
         return
      end if
      call c_f_pointer(ids, numbers, [size(list)])
      numbers = int(list, c_int)
      status = OK
   end function put_ids

   !> See kjoint.h
   integer(c_int) function kj_model_body(model, id, body) bind(c) result(status)
      type(c_ptr), value :: model, body
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      type(body_state_t) :: b
      type(c_body_t), pointer :: c

      if (.not. entered(model, OF_MODEL, box, status, c_associated(body), 'body is null')) return
      call body_state(box%sim, int(id), b, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(body, c)
      c%id = int(b%id, c_int)
      c%mass = b%mass
      c%position = b%position
      c%attitude = b%attitude
      c%velocity = b%velocity
      c%omega = b%omega
      c%force = b%force
      c%moment = b%moment
   end function kj_model_body

   !> See kjoint.h
   integer(c_int) function kj_model_joint(model, id, result) bind(c) result(status)
      type(c_ptr), value :: model, result
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      type(joint_result_t) :: r
      type(c_joint_result_t), pointer :: c

      if (.not. entered(model, OF_MODEL, box, status, c_associated(result), &
         'result is null')) return
      call joint_state(box%sim, int(id), r, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(result, c)
      c = c_joint_result(r)
   end function kj_model_joint

   !> See kjoint.h
   integer(c_int) function kj_model_node(model, id, x) bind(c) result(status)
      type(c_ptr), value :: model, x
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: place(:)
      real(c_double) :: found(3)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(x), 'x is null')) return
      call node_position(box%sim, int(id), found, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      call c_f_pointer(x, place, [3])
      place = found
   end function kj_model_node

   !> See kjoint.h
   integer(c_int) function kj_model_set_body_load(model, id, force, moment) bind(c) result(status)
      type(c_ptr), value :: model, force, moment
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: f(:), m(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(force) .and. &
         c_associated(moment), 'force or moment is null')) return
      call c_f_pointer(force, f, [3])
      call c_f_pointer(moment, m, [3])
      call set_body_load(box%sim, int(id), f, m, error)
      status = outcome(error, box%message)
   end function kj_model_set_body_load

   !> See kjoint.h
   integer(c_int) function kj_model_set_load_factor(model, id, factor) bind(c) result(status)
      type(c_ptr), value :: model
      integer(c_int), value :: id
      real(c_double), value :: factor

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call set_load_factor(box%sim, int(id), factor, error)
      status = outcome(error, box%message)
   end function kj_model_set_load_factor

   !> See kjoint.h
   integer(c_int) function kj_model_set_body_velocity(model, id, velocity, omega) bind(c) &
      result(status)
      type(c_ptr), value :: model, velocity, omega
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: v(:), w(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(velocity) .and. &
         c_associated(omega), 'velocity or omega is null')) return
      call c_f_pointer(velocity, v, [3])
      call c_f_pointer(omega, w, [3])
      call set_body_velocity(box%sim, int(id), v, w, error)
      status = outcome(error, box%message)
   end function kj_model_set_body_velocity

   !> See kjoint.h
   integer(c_int) function kj_model_set_body_pose(model, id, position, attitude) bind(c) &
      result(status)
      type(c_ptr), value :: model, position, attitude
      integer(c_int), value :: id

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      real(c_double), pointer :: x(:), q(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(position) .and. &
         c_associated(attitude), 'position or attitude is null')) return
      call c_f_pointer(position, x, [3])
      call c_f_pointer(attitude, q, [4])
      call set_body_pose(box%sim, int(id), x, q, error)
      status = outcome(error, box%message)
   end function kj_model_set_body_pose

   !> See kjoint.h
   integer(c_int) function kj_model_lock_joint(model, id, locked) bind(c) result(status)
      type(c_ptr), value :: model
      integer(c_int), value :: id, locked

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call lock_joint(box%sim, int(id), locked /= 0, error)
      status = outcome(error, box%message)
   end function kj_model_lock_joint

   !> See kjoint.h
   integer(c_int) function kj_model_save(model, size_of, state, needed) bind(c) result(status)
      type(c_ptr), value :: model, state, needed
      integer(c_size_t), value :: size_of

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      integer(int8), allocatable :: byte(:)
      integer(int8), pointer :: room(:)
      integer(c_size_t), pointer :: n

      if (.not. entered(model, OF_MODEL, box, status)) return
      call save_simulation(box%sim, byte, error)
      status = outcome(error, box%message)
      if (status /= OK) return
      if (c_associated(needed)) then
         call c_f_pointer(needed, n)
         n = size(byte, kind=c_size_t)
      end if
      if (size_of == 0 .and. c_associated(needed)) return
      if (size_of < size(byte, kind=c_size_t) .or. .not. c_associated(state)) then
         status = refuse('the state has '//str(size(byte))// &
            ' bytes, and there is no room for them', box%message)
         return
      end if
      call c_f_pointer(state, room, [size(byte)])
      room = byte
   end function kj_model_save

   !> See kjoint.h
   integer(c_int) function kj_model_restore(model, size_of, state) bind(c) result(status)
      type(c_ptr), value :: model, state
      integer(c_size_t), value :: size_of

      type(box_t), pointer :: box
      type(error_t), allocatable :: error
      integer(int8), pointer :: byte(:)

      if (.not. entered(model, OF_MODEL, box, status, c_associated(state), 'state is null')) return
      call c_f_pointer(state, byte, [size_of])
      call restore_simulation(box%sim, byte, error)
      if (.not. allocated(error)) call box%samples%open(simulation_history(box%sim), error)
      if (.not. allocated(error)) box%stepping = .true.
      status = outcome(error, box%message)
   end function kj_model_restore

   !> See kjoint.h
   integer(c_int) function kj_version(buffer, size) bind(c, name='kj_version') result(status)
      type(c_ptr), value :: buffer
      integer(c_size_t), value :: size

      status = put_text(KJOINT_VERSION, buffer, size)
   end function kj_version

   !> Begin a call about a channel of a model. The call ends at once, with the status, when there is
   !> none, or the arguments are not right.
   logical function on_channel(model, channel, box, history, v, status, right, wrong) result(found)
      type(c_ptr), intent(in) :: model, channel
      type(box_t), pointer, intent(out) :: box
      type(history_t), intent(out) :: history
      type(variable_t), intent(out) :: v
      integer(c_int), intent(out) :: status
      logical, intent(in), optional :: right               !! as of entered
      character(len=*), intent(in), optional :: wrong

      character(len=:), allocatable :: name
      integer :: i

      found = .false.
      if (.not. entered(model, OF_MODEL, box, status, right, wrong)) return
      call c_text(channel, name)
      history = simulation_history(box%sim)
      status = OK
      box%message = ''
      do i = 1, size(history%variable)
         v = history%variable(i)
         found = channel_path(v%channel) == name
         if (found) return
      end do
      status = refuse('the history has no channel '//name, box%message)
   end function on_channel

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
      text = channel_path(history%variable(1)%channel)
      do i = 2, ubound(history%variable, 1)
         text = text//new_line('a')//channel_path(history%variable(i)%channel)
      end do
      status = put_text(text, buffer, size)
   end function kj_model_channels

   !> See kjoint.h
   integer(c_int) function kj_model_shape(model, channel, n_row, n_entity, n_comp) bind(c) &
      result(status)
      type(c_ptr), value :: model, channel, n_row, n_entity, n_comp

      type(box_t), pointer :: box
      type(history_t) :: history
      type(variable_t) :: v
      integer(c_int), pointer :: number

      if (.not. on_channel(model, channel, box, history, v, status, c_associated(n_row) .and. &
         c_associated(n_entity) .and. c_associated(n_comp), &
         'n_row, n_entity or n_comp is null')) return
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
      type(history_t) :: history
      type(variable_t) :: v
      real(c_double), pointer :: series(:, :)
      integer :: width

      if (.not. on_channel(model, channel, box, history, v, status)) return
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
      type(history_t) :: history

      if (.not. on_channel(model, channel, box, history, v, status)) return
      status = put_text(unit_text(channels(v%channel)%dim, history%units), buffer, size)
   end function kj_model_unit

   !> See kjoint.h
   integer(c_int) function kj_model_about(model, channel, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, channel, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(variable_t) :: v
      type(history_t) :: history
      character(len=:), allocatable :: text
      integer :: i, n

      if (.not. on_channel(model, channel, box, history, v, status)) return
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
      call c_text(name, text)
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

end module kjoint_c_scene
