!> C functions of a model and its run: convert, call, convert back. include/kjoint.h is their
!> documentation.
module kjoint_c_model
   use, intrinsic :: iso_c_binding, only: c_ptr, c_funptr, c_int, c_size_t, c_double, c_long_long, &
      c_f_pointer, c_f_procpointer, c_associated, c_null_ptr
   use kj_kinds, only: wp
   use kj_error, only: error_t, code_of
   use kj_history, only: history_t
   use kj_run_option, only: KIND_NAME
   use kjoint, only: run_options_t, run_options, read_run_options, write_run_options, &
      simulation_options, run_status_t, monitor_t, beside_t, load_simulation, run_simulation, &
      run_simulations, &
      start_simulation, advance_simulation, step_simulation, simulation_status, &
      simulation_history, sample_simulation
   use kjoint_c_base, only: box_t, entered, has_room, hand_out, release, outcome, refuse, &
      put_text, list_findings, OK, OF_MODEL
   use kj_system, only: c_text
   implicit none
   private

   public :: kj_options_list, kj_model_options, kj_model_load, kj_model_free, kj_model_message, &
      kj_model_title, kj_model_warnings, kj_model_run, kj_models_run, kj_model_start, &
      kj_model_advance, kj_model_step, kj_model_steps, kj_model_sample, kj_model_status

   !> kj_run_status
   type, bind(c) :: c_status_t
      integer(c_long_long) :: cycle
      real(c_double) :: time, time_end, time_step, kinetic, internal, work, energy_error
      integer(c_int) :: n_joint, n_body, n_node, n_sample
   end type c_status_t

   character(len=*), parameter :: RUNS = &
      'the model runs: a tick may read its status and stop it'

   abstract interface
      !> kj_tick
      integer(c_int) function watch_i(status, user) bind(c)
         import :: c_int, c_ptr, c_status_t
         type(c_status_t), intent(in) :: status
         type(c_ptr), value :: user
      end function watch_i
   end interface

   !> A watcher in C
   type, extends(monitor_t) :: c_monitor_t
      procedure(watch_i), pointer, nopass :: call_back => null()
      type(c_ptr) :: user = c_null_ptr
   contains
      procedure :: tick
   end type c_monitor_t

contains

   !> See kjoint.h
   integer(c_int) function kj_options_list(buffer, size) bind(c) result(status)
      type(c_ptr), value :: buffer
      integer(c_size_t), value :: size

      character, parameter :: TAB = achar(9)
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, ubound(run_options, 1)
         if (i > 1) text = text//new_line('a')
         associate (o => run_options(i))
            text = text//trim(o%name)//TAB//trim(KIND_NAME(o%kind))//TAB//trim(o%words)//TAB// &
               trim(o%default)//TAB//trim(o%meaning)
         end associate
      end do
      status = put_text(text, buffer, size)
   end function kj_options_list

   !> See kjoint.h
   integer(c_int) function kj_model_load(starter, engine, options, model, message, size) bind(c) &
      result(status)
      type(c_ptr), value :: starter, engine, options, model, message
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(run_options_t) :: chosen
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text, deck, controls

      if (.not. has_room(model, c_associated(starter), 'starter or model is null', message, size, &
         status)) return
      allocate (box)
      call c_text(starter, deck)
      call c_text(engine, controls)
      call c_text(options, text)
      call read_run_options(text, chosen, error)
      if (.not. allocated(error)) &
         call load_simulation(box%sim, deck, controls, chosen, box%findings, error)
      status = outcome(error, text)
      if (status == OK .and. box%findings%n_error > 0) then
         status = code_of(box%findings)
         call list_findings(box%findings, .true., text)
      end if
      call hand_out(box, OF_MODEL, status, text, message, size, model)
   end function kj_model_load

   !> See kjoint.h
   subroutine kj_model_free(model) bind(c)
      type(c_ptr), value :: model

      call release(model, OF_MODEL)
   end subroutine kj_model_free

   !> See kjoint.h
   integer(c_int) function kj_model_message(model, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box

      if (entered(model, OF_MODEL, box, status)) status = put_text(box%message, buffer, size)
   end function kj_model_message

   !> See kjoint.h
   integer(c_int) function kj_model_title(model, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      type(history_t) :: history

      if (.not. entered(model, OF_MODEL, box, status)) return
      history = simulation_history(box%sim)
      status = put_text(history%title, buffer, size)
   end function kj_model_title

   !> See kjoint.h
   integer(c_int) function kj_model_warnings(model, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      character(len=:), allocatable :: text

      if (.not. entered(model, OF_MODEL, box, status)) return
      call list_findings(box%findings, .false., text)
      status = put_text(text, buffer, size)
   end function kj_model_warnings

   !> See kjoint.h
   integer(c_int) function kj_model_options(model, buffer, size) bind(c) result(status)
      type(c_ptr), value :: model, buffer
      integer(c_size_t), value :: size

      type(box_t), pointer :: box
      character(len=:), allocatable :: text

      if (.not. entered(model, OF_MODEL, box, status)) return
      call write_run_options(simulation_options(box%sim), text)
      status = put_text(text, buffer, size)
   end function kj_model_options

   !> Ask the watcher
   subroutine tick(self, status, stop)
      class(c_monitor_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      stop = .false.
      if (associated(self%call_back)) stop = self%call_back(c_status(status), self%user) /= 0
   end subroutine tick

   pure function c_status(status) result(c)
      type(run_status_t), intent(in) :: status
      type(c_status_t) :: c

      c%cycle = status%cycle
      c%time = status%time
      c%time_end = status%t_stop
      c%time_step = status%time_step
      c%kinetic = status%kinetic
      c%internal = status%internal
      c%work = status%work
      c%energy_error = status%energy_error
      c%n_joint = int(status%n_joint, c_int)
      c%n_body = int(status%n_body, c_int)
      c%n_node = int(status%n_node, c_int)
      c%n_sample = int(status%n_sample, c_int)
   end function c_status

   !> See kjoint.h
   integer(c_int) function kj_model_run(model, tick, user) bind(c) result(status)
      type(c_ptr), value :: model, user
      type(c_funptr), value :: tick

      type(box_t), pointer :: box
      type(c_monitor_t) :: monitor
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      if (box%running) then
         status = refuse(RUNS, box%message)
         return
      end if
      call set_watcher(tick, user, monitor)
      box%stepping = .false.
      box%running = .true.
      call run_simulation(box%sim, box%samples, monitor, box%status, error)
      box%running = .false.
      status = outcome(error, box%message)
   end function kj_model_run

   subroutine set_watcher(tick, user, monitor)
      type(c_funptr), intent(in) :: tick
      type(c_ptr), intent(in) :: user
      type(c_monitor_t), intent(out) :: monitor

      procedure(watch_i), pointer :: call_back

      if (c_associated(tick)) then
         call c_f_procpointer(tick, call_back)
         monitor%call_back => call_back
      end if
      monitor%user = user
   end subroutine set_watcher

   !> See kjoint.h
   integer(c_int) function kj_models_run(n, models, tick, user, outcomes) bind(c) &
      result(status)
      integer(c_int), value :: n
      type(c_ptr), intent(in) :: models(*)
      type(c_funptr), value :: tick
      type(c_ptr), value :: user
      integer(c_int), intent(out) :: outcomes(*)

      type(beside_t) :: run(n)
      type(box_t), pointer :: box
      type(c_monitor_t) :: monitor
      integer(c_int) :: ignored
      integer :: i, k
      logical :: twice

      do i = 1, n
         if (.not. entered(models(i), OF_MODEL, box, status)) return
         if (box%running) then
            status = refuse(RUNS, box%message)
            return
         end if
         twice = any([(c_associated(models(k), models(i)), k=1, i - 1)])
         if (twice) then
            status = refuse('the same model twice', box%message)
            return
         end if
         run(i)%sim => box%sim
         run(i)%sink => box%samples
      end do
      call set_watcher(tick, user, monitor)
      call mark(.true.)
      call run_simulations(run, monitor)
      call mark(.false.)
      status = OK
      do i = 1, n
         if (.not. entered(models(i), OF_MODEL, box, ignored)) cycle
         box%status = run(i)%status
         outcomes(i) = outcome(run(i)%error, box%message)
      end do

   contains

      subroutine mark(running)
         logical, intent(in) :: running

         integer :: i

         do i = 1, n
            if (.not. entered(models(i), OF_MODEL, box, ignored)) cycle
            box%running = running
            box%stepping = .false.
         end do
      end subroutine mark
   end function kj_models_run

   !> See kjoint.h
   integer(c_int) function kj_model_start(model) bind(c) result(status)
      type(c_ptr), value :: model

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call start_simulation(box%sim, error)
      if (.not. allocated(error)) call box%samples%open(simulation_history(box%sim), error)
      box%stepping = .not. allocated(error)
      status = outcome(error, box%message)
   end function kj_model_start

   !> See kjoint.h
   integer(c_int) function kj_model_advance(model, until) bind(c) result(status)
      type(c_ptr), value :: model
      real(c_double), value :: until

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call advance_simulation(box%sim, until, error)
      status = outcome(error, box%message)
   end function kj_model_advance

   !> See kjoint.h
   integer(c_int) function kj_model_step(model) bind(c) result(status)
      type(c_ptr), value :: model

      status = kj_model_steps(model, 1_c_int)
   end function kj_model_step

   !> See kjoint.h
   integer(c_int) function kj_model_steps(model, n) bind(c) result(status)
      type(c_ptr), value :: model
      integer(c_int), value :: n

      type(box_t), pointer :: box
      type(error_t), allocatable :: error

      if (.not. entered(model, OF_MODEL, box, status)) return
      call step_simulation(box%sim, error, n)
      status = outcome(error, box%message)
   end function kj_model_steps

   !> See kjoint.h
   integer(c_int) function kj_model_sample(model) bind(c) result(status)
      type(c_ptr), value :: model

      type(box_t), pointer :: box
      type(history_t) :: history
      type(error_t), allocatable :: error
      real(wp), allocatable :: row(:)

      if (.not. entered(model, OF_MODEL, box, status)) return
      history = simulation_history(box%sim)
      allocate (row(history%n_value))
      call sample_simulation(box%sim, row, error)
      if (.not. allocated(error)) call box%samples%put(row, error)
      status = outcome(error, box%message)
   end function kj_model_sample

   !> See kjoint.h
   integer(c_int) function kj_model_status(model, now) bind(c, name='kj_model_status') &
      result(status)
      type(c_ptr), value :: model, now

      type(box_t), pointer :: box
      type(c_status_t), pointer :: c

      if (.not. entered(model, OF_MODEL, box, status, c_associated(now), 'status is null')) return
      call c_f_pointer(now, c)
      if (box%stepping) box%status = simulation_status(box%sim)
      box%status%n_sample = box%samples%n_row
      c = c_status(box%status)
      status = OK
   end function kj_model_status

end module kjoint_c_model
