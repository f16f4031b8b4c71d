!> Checkpoints of `kjoint run`: when one is due, and writing it; the control file, by which a run is
!> told what to do while it runs.
module kj_keeper
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT, ERR_FILE
   use kj_system, only: wall_clock, absolute_path, sync_file
   use kj_output, only: settle_output
   use kj_text, only: text_t
   use kj_number, only: parse_real, NUMBER_FINE
   use kj_spelling, only: upper
   use kj_signal, only: caught_signal, take_wish, WISH_CHECKPOINT, WISH_STATUS
   use kj_option, only: arguments_t, OPT_CHECKPOINT, OPT_CHECKPOINT_EVERY
   use kj_terminal, only: print_error
   use kj_progress, only: progress_t, status_now
   use kj_restart_file, only: restart_t, write_restart
   use kj_sink_h5, only: sink_h5_t
   use kjoint, only: simulation_t, simulation_options, simulation_checkpoints, run_status_t, &
      write_run_options
   implicit none
   private

   public :: keeper_t, start_keeper, checkpoint_path

   real(wp), parameter :: LOOK = 0.5_wp          !! [s] between looks at the control file

   !> Monitor that keeps checkpoints, too
   type, extends(progress_t) :: keeper_t
      type(restart_t) :: what                    !! decks, options and history of the run
      character(len=:), allocatable :: path      !! of the checkpoint
      character(len=:), allocatable :: control   !! path of the control file
      class(sink_h5_t), pointer :: sink => null()      !! of the run
      logical :: at_end = .false.                !! asked for at the end of the run
      real(wp) :: every = huge(1.0_wp)           !! [s] of wall clock
      integer :: every_cycles = huge(1)
      logical :: stopped = .false.               !! by the control file, and wants to go on later
      logical :: killed = .false.                !! by the control file
      logical :: saved = .false.                 !! a checkpoint was written
      ! own
      logical, private :: wished = .false.       !! asked for by the control file
      real(wp), private :: last = 0.0_wp, looked = 0.0_wp   !! wall clock [s]
      integer, private :: cycle = 0, last_cycle = 0
   contains
      procedure :: tick => tick_keeper
      procedure :: wants_state
      procedure :: take_state
   end type keeper_t

contains

   !> RUN.h5 -> RUN.restart.h5
   pure function checkpoint_path(history) result(path)
      character(len=*), intent(in) :: history
      character(len=:), allocatable :: path

      integer :: n

      n = len(history)
      if (n > 3) then
         if (history(n - 2:) == '.h5') n = n - 3
      end if
      path = history(:n)//'.restart.h5'
   end function checkpoint_path

   !> When to keep what. Errors: ERR_INPUT when --checkpoint-every has no number above zero, or
   !> something that is no regular file stands in the place of a checkpoint that is asked for
   subroutine start_keeper(args, sim, starter, engine, history, self, error)
      type(arguments_t), intent(in) :: args
      type(simulation_t), intent(in) :: sim
      character(len=*), intent(in) :: starter, engine, history      !! paths
      class(keeper_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: place
      integer :: status, number

      call absolute_path(starter, self%what%starter)
      self%what%engine = ''
      if (len(engine) > 0) call absolute_path(engine, self%what%engine)
      call absolute_path(history, self%what%history)
      call write_run_options(simulation_options(sim), self%what%options)
      self%path = checkpoint_path(history)
      self%control = starter(:len(starter) - len('_0000.rad'))//'_0001.ctl'
      if (len(engine) > 4) self%control = engine(:len(engine) - 4)//'.ctl'
      self%control = self%control(index(self%control, '/', back=.true.) + 1:)
      call simulation_checkpoints(sim, self%at_end, self%every_cycles, number)
      if (args%given(OPT_CHECKPOINT) .or. args%given(OPT_CHECKPOINT_EVERY)) self%at_end = .true.
      if (self%at_end) call settle_output(self%path, [text_t ::], place, error)
      self%last = wall_clock()
      self%looked = self%last
      if (.not. args%given(OPT_CHECKPOINT_EVERY)) return
      associate (text => args%value(OPT_CHECKPOINT_EVERY)%s)
         call parse_real(text, self%every, status)
         if (status /= NUMBER_FINE .or. .not. self%every > 0.0_wp) call fail(error, ERR_INPUT, &
            '--checkpoint-every needs seconds, more than 0, not "'//text//'"')
      end associate
   end subroutine start_keeper

   !> Report, and do what signals and the control file ask for
   subroutine tick_keeper(self, status, stop)
      class(keeper_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      real(wp) :: now

      call self%progress_t%tick(status, stop)
      self%cycle = status%cycle
      if (take_wish(WISH_STATUS)) call print_error(status_now(self%progress_t, status))
      now = wall_clock()
      if (now - self%looked >= LOOK) then
         self%looked = now
         call read_control(self, status)
      end if
      stop = stop .or. self%stopped .or. self%killed
   end subroutine tick_keeper

   !> The control file: /STOP, /KILL, /INFO, /TFILE, /RFILE, a line each. What was done and where
   !> the run is stands in it afterwards.
   subroutine read_control(self, status)
      class(keeper_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status

      type(error_t), allocatable :: error
      character(len=200) :: line, word
      character(len=:), allocatable :: answer
      integer :: unit, state
      logical :: exists

      inquire (file=self%control, exist=exists)
      if (.not. exists) return
      open (newunit=unit, file=self%control, status='old', action='readwrite', iostat=state)
      if (state /= 0) return
      answer = ''
      do
         read (unit, '(a)', iostat=state) line
         if (state /= 0) exit
         word = upper(trim(adjustl(line)))
         if (word == '' .or. scan(word(1:1), '#$') > 0) cycle
         answer = answer//'# '//trim(line)
         select case (word)
         case ('/STOP'); self%stopped = .true.
         case ('/KILL'); self%killed = .true.
         case ('/INFO')
         case ('/RFILE'); self%wished = .true.
         case ('/TFILE'); call self%sink%flush(error)
         case default; answer = answer//': not known: /STOP, /KILL, /INFO, /TFILE, /RFILE'
         end select
         answer = answer//new_line('a')
      end do
      if (answer /= '') then
         rewind (unit)
         write (unit, '(a)') answer//'# '//status_now(self%progress_t, status)
         call print_error(self%control//': '//status_now(self%progress_t, status))
      end if
      close (unit)
   end subroutine read_control

   !> At the end where asked for or stopped, and as often as asked for
   subroutine wants_state(self, ended, wanted)
      class(keeper_t), intent(inout) :: self
      logical, intent(in) :: ended
      logical, intent(out) :: wanted

      wanted = take_wish(WISH_CHECKPOINT)
      wanted = wanted .or. self%wished .or. self%cycle - self%last_cycle >= self%every_cycles
      if (self%every < huge(1.0_wp)) then
         if (wall_clock() - self%last >= self%every) wanted = .true.
      end if
      if (.not. ended) return
      wanted = wanted .or. self%at_end .or. self%stopped
      if (caught_signal() /= 0) wanted = .true.
      wanted = wanted .and. .not. self%killed
   end subroutine wants_state

   !> Write the checkpoint, after the rows that it goes on from. One that cannot be written does not
   !> end the run: the older one stays.
   subroutine take_state(self, state, status, error)
      class(keeper_t), intent(inout) :: self
      integer(int8), intent(in) :: state(:)
      type(run_status_t), intent(in) :: status
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: problem
      logical :: done

      self%wished = .false.
      self%last_cycle = status%cycle
      self%what%state = state
      self%what%time = status%time
      self%what%cycle = status%cycle
      call self%sink%flush(error)
      if (allocated(error)) return
      call sync_file(self%sink%place, done)
      if (done) then
         call write_restart(self%path, self%what, problem)
      else
         call fail(problem, ERR_FILE, 'no checkpoint: its rows are not on the disk')
      end if
      self%last = wall_clock()
      if (allocated(problem)) then
         call print_error('warning: '//problem%message)
      else
         self%saved = .true.
      end if
   end subroutine take_state

end module kj_keeper
