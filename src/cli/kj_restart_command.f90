!> `kjoint run --restart`, and runs 2, 3, ... of engine decks ROOT_0002.rad, ...: where they go on
!> from, and the history that goes on with them.
module kj_restart_command
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_FILE
   use kj_number, only: parse_integer, NUMBER_FINE
   use kj_option, only: arguments_t, OPT_RESTART, OPT_NEW_FILE, OPT_OUTPUT
   use kj_history, only: history_t
   use kj_output, only: find_part
   use kj_sink_h5, only: sink_h5_t
   use kj_reader, only: history_reader_t, open_history_file, next_row, close_history_file
   use kj_restart_file, only: restart_t, read_restart
   use kj_keeper, only: checkpoint_path
   use kjoint, only: run_options_t, read_run_options, simulation_t, restore_simulation
   implicit none
   private

   public :: continued_sink_t, find_restart, restart_from, continued_path

   !> A history that begins with the rows of an older one
   type, extends(sink_h5_t) :: continued_sink_t
      character(len=:), allocatable :: older     !! its path; not allocated: a new history
      character(len=:), allocatable :: killed    !! that of a run which was killed; it goes before
   contains
      procedure :: open => open_continued
   end type continued_sink_t

contains

   !> The checkpoint that a run goes on from, where it does: that of --restart, or of the run before
   !> one whose engine deck is ROOT_0002.rad or later. Decks and options that the command line does
   !> not name are those of the checkpoint.
   !>
   !> Errors: ERR_FILE when it cannot be read, ERR_INPUT when its options cannot
   subroutine find_restart(args, options, restart, goes_on, error)
      type(arguments_t), intent(inout) :: args
      type(run_options_t), intent(inout) :: options
      type(restart_t), intent(out) :: restart
      logical, intent(out) :: goes_on
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: path

      call complete_decks(args)
      goes_on = args%given(OPT_RESTART)
      if (goes_on) then
         path = args%value(OPT_RESTART)%s
      else
         if (args%n_operand == 2) goes_on = run_number(args%operand(2)%s) > 1
         if (.not. goes_on) return
         path = root_of(args%operand(1)%s)
         path = path(index(path, '/', back=.true.) + 1:)//'.h5'
         if (args%given(OPT_OUTPUT) .and. .not. args%given(OPT_NEW_FILE)) &
            path = args%value(OPT_OUTPUT)%s
         path = checkpoint_path(path)
      end if
      call read_restart(path, restart, error)
      if (allocated(error)) then
         if (.not. args%given(OPT_RESTART)) error%hint = &
            'run the engine deck before with --checkpoint or /RFILE, or name a file: --restart FILE'
         return
      end if
      call read_run_options(restart%options, options, error)
      if (args%n_operand == 2) then              ! its end and samples hold
         options%until = -1.0_wp
         options%sample = -1.0_wp
      end if
      if (args%n_operand > 0) return
      args%n_operand = 1
      args%operand(1)%s = restart%starter
      if (restart%engine == '') return
      args%n_operand = 2
      args%operand(2)%s = restart%engine
   end subroutine find_restart

   !> An engine deck alone stands for its starter deck, too
   subroutine complete_decks(args)
      type(arguments_t), intent(inout) :: args

      if (args%n_operand /= 1) return
      if (run_number(args%operand(1)%s) < 1) return
      args%n_operand = 2
      args%operand(2)%s = args%operand(1)%s
      args%operand(1)%s = root_of(args%operand(1)%s)//'_0000.rad'
   end subroutine complete_decks

   !> 2 of ROOT_0002.rad; 0 of another name
   pure integer function run_number(path) result(number)
      character(len=*), intent(in) :: path

      integer :: status

      number = 0
      if (len(path) < 9) return
      associate (tail => path(len(path) - 8:))
         if (tail(1:1) /= '_' .or. tail(6:) /= '.rad') return
         if (verify(tail(2:5), '0123456789') > 0) return
         call parse_integer(tail(2:5), number, status)
      end associate
      if (status /= NUMBER_FINE) number = 0
   end function run_number

   !> DECK_0000.rad -> DECK
   pure function root_of(path) result(root)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: root

      root = path
      if (len(path) > 9) then
         if (path(len(path) - 8:len(path) - 8) == '_') root = path(:len(path) - 9)
      end if
   end function root_of

   !> The state of a checkpoint. Errors: as restore_simulation, naming the file
   subroutine restart_from(restart, sim, error)
      type(restart_t), intent(inout) :: restart
      type(simulation_t), intent(inout) :: sim
      type(error_t), allocatable, intent(out) :: error

      integer(int8), allocatable :: state(:)

      call move_alloc(restart%state, state)
      call restore_simulation(sim, state, error)
   end subroutine restart_from

   !> Where the history of a run that goes on is: the old one, or one of its own
   subroutine continued_path(args, restart, sink)
      type(arguments_t), intent(in) :: args
      type(restart_t), intent(in) :: restart
      type(continued_sink_t), intent(inout) :: sink

      character(len=:), allocatable :: stem
      integer :: n
      logical :: exists

      if (.not. args%given(OPT_NEW_FILE)) then
         sink%older = restart%history
         call find_part(restart%history, .false., sink%killed)
         if (.not. args%given(OPT_OUTPUT)) sink%path = restart%history
         return
      end if
      if (args%given(OPT_OUTPUT)) return
      stem = checkpoint_path(restart%history)
      stem = stem(:index(stem, '.restart.h5', back=.true.))
      do n = 2, 1000000
         sink%path = stem//str(n)//'.h5'
         inquire (file=sink%path, exist=exists)
         if (.not. exists) return
      end do
   end subroutine continued_path

   !> Errors: as open of the sink; ERR_FILE when the older history lacks rows
   subroutine open_continued(self, history, error)
      class(continued_sink_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(history_reader_t) :: reader
      integer :: n_row

      n_row = 0
      if (allocated(self%older) .and. self%rows_before > 0) then
         call open_older(self%killed, history, self%rows_before, reader, error)
         if (allocated(error)) call open_older(self%older, history, self%rows_before, reader, error)
         if (allocated(error)) return
         n_row = self%rows_before
      end if
      call self%sink_h5_t%open(history, error)
      if (.not. allocated(error) .and. n_row > 0) &
         call copy_rows(reader, history%n_value, n_row, self, error)
      call close_history_file(reader, closing)
   end subroutine open_continued

   !> Errors: ERR_FILE when it is none of this scene or has too few rows
   subroutine open_older(path, history, n_row, reader, error)
      character(len=*), intent(in) :: path
      type(history_t), intent(in) :: history
      integer, intent(in) :: n_row
      type(history_reader_t), intent(out) :: reader
      type(error_t), allocatable, intent(out) :: error

      type(history_t) :: older
      integer :: found

      call open_history_file(path, reader, older, found, error)
      if (.not. allocated(error)) then
         if (older%n_value /= history%n_value) then
            call fail(error, ERR_FILE, path//' has other channels than this run')
         else if (found < n_row) then
            call fail(error, ERR_FILE, path//' has '//str(found)//' samples, the checkpoint '// &
               'goes on from '//str(n_row))
         end if
      end if
      if (allocated(error)) error%hint = 'with --new-file the run has a history of its own'
   end subroutine open_older

   !> The first rows of a history to a sink. Errors: ERR_FILE
   subroutine copy_rows(reader, n_value, n_row, sink, error)
      type(history_reader_t), intent(inout) :: reader
      integer, intent(in) :: n_value, n_row
      class(continued_sink_t), intent(inout) :: sink
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: row(:)
      integer :: i
      logical :: more

      allocate (row(n_value))
      do i = 1, n_row
         call next_row(reader, row, more, error)
         if (more) call sink%put(row, error)
         if (allocated(error)) return
      end do
   end subroutine copy_rows

end module kj_restart_command
