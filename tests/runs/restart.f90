!> Restarted runs have the bits of runs that went through: each deck runs to its end; then it is
!> stopped by its monitor at a third, goes on from the state, on two threads, to two thirds of its
!> end time, and on to the end. All rows must be equal to the bit. So must those of a scene that a
!> host steps, saves and restores.
!>
!> usage: restart OPTIONS DECK_0000.rad ...       OPTIONS: as read_run_options reads them
module recorded_run
   use, intrinsic :: iso_fortran_env, only: int8
   use kjoint, only: wp, error_t, sink_t, history_t, monitor_t, run_status_t
   implicit none
   private

   public :: book_t, keeper_t

   !> Rows in memory
   type, extends(sink_t) :: book_t
      integer :: n = 0
      real(wp), allocatable :: row(:, :)         !! (n_value, rows)
   contains
      procedure :: open => open_book
      procedure :: put => put_row
      procedure :: flush => nothing
      procedure :: close => close_book
   end type book_t

   !> Ends a run at a cycle and keeps the last state
   type, extends(monitor_t) :: keeper_t
      integer :: last = huge(1)                  !! cycle that ends the run
      integer(int8), allocatable :: state(:)
   contains
      procedure :: tick
      procedure :: wants_state
      procedure :: take_state
   end type keeper_t

contains

   !> Rows beyond those of the older history are forgotten
   subroutine open_book(self, history, error)
      class(book_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(self%row)) allocate (self%row(history%n_value, 100000))
      self%n = self%rows_before
   end subroutine open_book

   subroutine put_row(self, row, error)
      class(book_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_t), allocatable, intent(out) :: error

      self%n = self%n + 1
      self%row(:, self%n) = row
   end subroutine put_row

   subroutine nothing(self, error)
      class(book_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      associate (unused => self)
      end associate
   end subroutine nothing

   subroutine close_book(self, status, cycles, exit_code, error)
      class(book_t), intent(inout) :: self
      character(len=*), intent(in) :: status
      integer, intent(in) :: cycles, exit_code
      type(error_t), allocatable, intent(out) :: error

      associate (unused => self, it => status, this => cycles, that => exit_code)
      end associate
   end subroutine close_book

   subroutine tick(self, status, stop)
      class(keeper_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      stop = status%cycle >= self%last
   end subroutine tick

   subroutine wants_state(self, ended, wanted)
      class(keeper_t), intent(inout) :: self
      logical, intent(in) :: ended
      logical, intent(out) :: wanted

      associate (unused => self)
      end associate
      wanted = ended
   end subroutine wants_state

   subroutine take_state(self, state, status, error)
      class(keeper_t), intent(inout) :: self
      integer(int8), intent(in) :: state(:)
      type(run_status_t), intent(in) :: status
      type(error_t), allocatable, intent(out) :: error

      associate (unused => status)
      end associate
      self%state = state
   end subroutine take_state

end module recorded_run

program restart
   use, intrinsic :: iso_fortran_env, only: int8
   use kjoint, only: wp, error_t, finding_list_t, run_options_t, run_status_t, simulation_t, &
      read_run_options, load_simulation, run_simulation, restore_simulation, save_simulation, &
      start_simulation, step_simulation, sample_simulation, simulation_history, history_t
   use recorded_run, only: book_t, keeper_t
   implicit none

   character(len=4096) :: text
   type(run_options_t) :: options
   type(error_t), allocatable :: problem
   integer :: i, n_wrong

   call get_command_argument(1, text)
   call read_run_options(trim(text), options, problem)
   call stop_on(problem)
   n_wrong = 0
   do i = 2, command_argument_count()
      call get_command_argument(i, text)
      call check_deck(trim(text), n_wrong)
   end do
   write (*, '(a,i0,a,i0,a)') 'restart: ', i - 2, ' decks, ', n_wrong, ' wrong'
   if (n_wrong > 0) error stop

contains

   subroutine stop_on(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      write (*, '(2a)') 'restart: ', error%message
      error stop
   end subroutine stop_on

   subroutine check_deck(deck, n_wrong)
      character(len=*), intent(in) :: deck
      integer, intent(inout) :: n_wrong

      type(book_t) :: whole, parts
      type(keeper_t) :: keeper
      type(run_options_t) :: shorter
      type(run_status_t) :: status
      integer(int8), allocatable :: state(:)
      integer :: cycles, stopped

      call run(deck, options, state, whole, keeper, status)
      cycles = status%cycle
      keeper%last = cycles/3
      call run(deck, options, state, parts, keeper, status)
      stopped = status%cycle
      call move_alloc(keeper%state, state)
      keeper%last = huge(1)
      shorter = options
      shorter%threads = 2
      shorter%least_share = 1
      shorter%until = 2.0_wp/3.0_wp*status%t_stop
      call run(deck, shorter, state, parts, keeper, status)
      call move_alloc(keeper%state, state)
      call run(deck, options, state, parts, keeper, status)
      call compare(deck//' run', whole%row(:, :whole%n), parts%row(:, :parts%n), n_wrong)
      write (*, '(2a,5(a,i0))') deck, ':', ' cycles ', cycles, ' stopped at ', stopped, ' rows ', &
         parts%n, ' state ', size(keeper%state)
      if (.not. options%islands) call check_host(deck, max(2, min(cycles, 300)), n_wrong)
   end subroutine check_deck

   !> A host steps a scene, goes back to a saved state in another scene, and steps again
   subroutine check_host(deck, steps, n_wrong)
      character(len=*), intent(in) :: deck
      integer, intent(in) :: steps
      integer, intent(inout) :: n_wrong

      type(simulation_t) :: sim, other
      type(history_t) :: history
      integer(int8), allocatable :: state(:)
      real(wp), allocatable :: row(:, :)
      type(error_t), allocatable :: error
      integer :: i, file

      call load(deck, options, sim)
      call load(deck, options, other)
      history = simulation_history(sim)
      allocate (row(history%n_value, 2))
      call start_simulation(sim, error)
      call stop_on(error)
      do i = 1, steps
         if (i == steps/2) call save_simulation(sim, state, error)
         call stop_on(error)
         call step_simulation(sim, error)
         call stop_on(error)
      end do
      call sample_simulation(sim, row(:, 1), error)
      call stop_on(error)
      open (newunit=file, status='scratch', access='stream', form='unformatted')
      write (file) state                         ! by a file of the host
      state = 0_int8
      read (file, pos=1) state
      close (file)
      call restore_simulation(other, state, error)
      call stop_on(error)
      do i = steps/2, steps
         call step_simulation(other, error)
         call stop_on(error)
      end do
      call sample_simulation(other, row(:, 2), error)
      call stop_on(error)
      call compare(deck//' host', row(:, 1:1), row(:, 2:2), n_wrong)
   end subroutine check_host

   subroutine load(deck, options, sim)
      character(len=*), intent(in) :: deck
      type(run_options_t), intent(in) :: options
      type(simulation_t), intent(out) :: sim

      type(finding_list_t) :: findings
      type(error_t), allocatable :: error

      call load_simulation(sim, deck, deck(:index(deck, '_0000.rad'))//'0001.rad', options, findings, error)
      call stop_on(error)
      if (findings%n_error > 0) error stop 'restart: the deck has errors'
   end subroutine load

   !> Run a deck from its start, or from a state
   subroutine run(deck, options, state, book, keeper, status)
      character(len=*), intent(in) :: deck
      type(run_options_t), intent(in) :: options
      integer(int8), allocatable, intent(in) :: state(:)
      type(book_t), intent(inout) :: book
      type(keeper_t), intent(inout) :: keeper
      type(run_status_t), intent(out) :: status

      type(simulation_t) :: sim
      type(error_t), allocatable :: error

      call load(deck, options, sim)
      if (allocated(state)) call restore_simulation(sim, state, error)
      call stop_on(error)
      call run_simulation(sim, book, keeper, status, error)
      call stop_on(error)
   end subroutine run

   !> Rows to the bit; NaN of a channel that has none equals itself
   subroutine compare(name, a, b, n_wrong)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: a(:, :), b(:, :)
      integer, intent(inout) :: n_wrong

      integer :: i, differ

      differ = abs(size(a, 2) - size(b, 2))
      do i = 1, min(size(a, 2), size(b, 2))
         if (any(transfer(a(:, i), [0_int8]) /= transfer(b(:, i), [0_int8]))) differ = differ + 1
      end do
      if (differ == 0) return
      n_wrong = n_wrong + 1
      write (*, '(2a,i0,a,i0,a)') name, ': ', differ, ' of ', size(a, 2), ' rows differ'
   end subroutine compare

end program restart
