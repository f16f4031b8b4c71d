!> What a person sees of a run under way: one line that changes, or listing lines. It is also where
!> a signal reaches the run.
module kj_progress
   use kj_kinds, only: wp
   use, intrinsic :: iso_c_binding, only: c_size_t
   use kj_error, only: error_t, str
   use kj_output, only: write_output, append_output
   use kj_text, only: text_t
   use kj_words, only: right
   use kj_system, only: wall_clock
   use kj_signal, only: caught_signal
   use kj_terminal, only: print_error, print_status, columns, STDERR
   use kjoint, only: monitor_t, run_status_t
   implicit none
   private

   public :: progress_t, start_progress, list_to_file, end_progress, status_now, limiter, &
      percent, rate, span_text

   real(wp), parameter :: FIRST = 1.0_wp        !! [s] of wall clock before the first line
   real(wp), parameter :: LONG = 3600.0_wp      !! [s] a run that takes longer says so at once
   real(wp), parameter :: PAUSE = 0.2_wp        !! [s] of wall clock between two lines
   real(wp), parameter :: SELDOM = 10.0_wp      !! [s], where nobody looks on

   character(len=*), parameter :: HEADER = '     CYCLE         TIME    TIME-STEP '// &
      'ELEMENT                    ERROR     I-ENERGY   K-ENERGY T   K-ENERGY R     EXT-WORK'// &
      '  MAS.ERR   TOTAL MASS  MASS ADDED'

   integer, parameter, public :: SHOW_NOTHING = 0, SHOW_STATUS = 1, SHOW_LISTING = 2, &
      SHOW_SELDOM = 3                            !! a listing line every SELDOM seconds

   !> Monitor of a run that reports to stderr
   type, extends(monitor_t) :: progress_t
      integer :: show = SHOW_NOTHING            !! SHOW_ constant
      real(wp) :: started = 0.0_wp              !! wall clock [s]
      real(wp) :: shown = 0.0_wp                !! wall clock of the last line
      integer :: listed = -1                    !! cycle of the last listing line, over print_every
      character(len=:), allocatable :: listing  !! path of its file, where one was asked for
      character(len=:), allocatable :: lines    !! that are not in the file yet
      type(error_t), allocatable :: problem     !! of the listing: a line could not be written
      real(wp) :: kept = 0.0_wp                 !! wall clock when that was last written
      logical :: open = .false.                 !! a status line stands on the terminal
      logical :: warned = .false.               !! of a long run
   contains
      procedure :: tick
   end type progress_t

contains

   !> Begin to report
   subroutine start_progress(self, show)
      type(progress_t), intent(inout) :: self
      integer, intent(in) :: show               !! SHOW_ constant

      self%show = show
      self%started = wall_clock()
      self%shown = self%started + FIRST - PAUSE
      self%listed = -1
      self%open = .false.
      self%warned = .false.
   end subroutine start_progress

   !> Write the listing to a file, too, a line every /PRINT cycles.
   !> Errors: ERR_INPUT when that is an input or no regular file, ERR_FILE
   subroutine list_to_file(self, path, inputs, error)
      class(progress_t), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(text_t), intent(in) :: inputs(:)     !! paths of the files that are read
      type(error_t), allocatable, intent(inout) :: error

      call write_output(path, HEADER//new_line('a'), inputs, error)
      if (allocated(error)) return
      self%listing = path
      self%lines = ''
   end subroutine list_to_file

   !> Where a run is, in a line
   function status_now(self, status) result(text)
      class(progress_t), intent(in) :: self
      type(run_status_t), intent(in) :: status
      character(len=:), allocatable :: text

      text = status_line(status, wall_clock() - self%started, huge(1))
   end function status_now

   !> Take the status line away, end the listing
   subroutine end_progress(self)
      type(progress_t), intent(inout) :: self

      if (self%open) call print_status('')
      self%open = .false.
      if (allocated(self%listing)) call write_lines(self)
   end subroutine end_progress

   !> Report where the run is; stop it after a signal
   subroutine tick(self, status, stop)
      class(progress_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      real(wp) :: now
      integer :: passed
      logical :: every                           !! /PRINT cycles were passed

      stop = caught_signal() /= 0
      if (stop) self%stop_code = 128 + caught_signal()
      if (self%show /= SHOW_NOTHING .and. .not. self%warned .and. status%cycle > 0) then
         call warn_of_length(self, status)
         self%warned = .true.
      end if
      if (self%show == SHOW_NOTHING .and. .not. allocated(self%listing)) return
      now = wall_clock()
      passed = status%cycle/max(1, status%print_every)
      every = passed /= self%listed
      if (every .and. allocated(self%listing)) call keep(self, status, now)
      select case (self%show)
      case (SHOW_STATUS)
         if (now - self%shown >= PAUSE) then
            call print_status(status_line(status, now - self%started, width_of(columns(STDERR))))
            self%shown = now
            self%open = .true.
         end if
      case (SHOW_LISTING, SHOW_SELDOM)
         if (self%listed < 0) call print_error(HEADER)
         if (self%show == SHOW_SELDOM) every = self%listed < 0 .or. now - self%shown >= SELDOM
         if (every) then
            call print_error(listing_line(status))
            self%shown = now
         end if
      end select
      self%listed = passed
   end subroutine tick

   !> A run of more than an hour says so as it begins, by the pace of its first cycles
   subroutine warn_of_length(self, status)
      class(progress_t), intent(in) :: self
      type(run_status_t), intent(in) :: status

      character(len=9) :: cycles
      real(wp) :: seconds

      seconds = (wall_clock() - self%started)/status%cycle*status%cycles_to_go
      if (seconds < LONG) return
      write (cycles, '(es9.1)') status%cycles_to_go
      call print_error('the run takes about'//cycles//' cycles, at this pace '//span_text(seconds))
   end subroutine warn_of_length

   !> Seconds in a unit that people count in: "3.0 s", "12 minutes", "5 hours", "3 years"
   pure function span_text(seconds) result(text)
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text

      real(wp), parameter :: unit(4) = [60.0_wp, 3600.0_wp, 86400.0_wp, 31557600.0_wp]
      character(len=7), parameter :: name(4) = ['minutes', 'hours  ', 'days   ', 'years  ']
      character(len=12) :: number
      integer :: i

      i = count(seconds >= 2.0_wp*unit)
      if (i == 0) then
         write (number, '(f12.1)') seconds
         text = trim(adjustl(number))//' s'
         if (text(1:1) == '.') text = '0'//text
         return
      end if
      if (seconds/unit(i) < 9999.5_wp) then
         write (number, '(i0)') nint(seconds/unit(i))
      else
         write (number, '(es8.1)') seconds/unit(i)
      end if
      text = trim(adjustl(number))//' '//trim(name(i))
   end function span_text

   !> Columns that a line may take, so that it does not wrap; a terminal that does not say has 80
   pure integer function width_of(columns)
      integer, intent(in) :: columns

      width_of = columns - 1
      if (columns <= 0) width_of = 79
   end function width_of

   !> "42.3 %  t 0.212  ETA 0:12  dt 1.2E-05 (joint 900)  energy 0.01 %  118k cycles/s"; what does
   !> not fit on the right is left out
   function status_line(status, elapsed, width) result(text)
      type(run_status_t), intent(in) :: status
      real(wp), intent(in) :: elapsed           !! [s] of wall clock
      integer, intent(in) :: width              !! most characters
      character(len=:), allocatable :: text

      character(len=80) :: buffer
      real(wp) :: done

      done = 0.0_wp
      if (status%t_stop > 0.0_wp) done = min(1.0_wp, status%time/status%t_stop)
      write (buffer, '(f5.1,a,es9.3)') 100*done, ' %  t ', status%time
      text = trim(buffer)
      if (done > 0.0_wp) call add('  ETA '//clock(elapsed*(1.0_wp - done)/done))
      write (buffer, '(a,es8.2)') '  dt ', status%time_step
      call add(trim(buffer)//limiter(status))
      call add('  energy '//percent(status%energy_error))
      call add('  '//rate(real(status%cycle, wp)/elapsed)//' cycles/s')

   contains

      subroutine add(piece)
         character(len=*), intent(in) :: piece

         if (len(text) + len(piece) <= width) text = text//piece
      end subroutine add
   end function status_line

   !> A line for the file of the listing, whose lines can be read soon
   subroutine keep(self, status, now)
      class(progress_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      real(wp), intent(in) :: now

      self%lines = self%lines//listing_line(status)//new_line('a')
      if (now - self%kept < PAUSE) return
      call write_lines(self)
      self%kept = now
   end subroutine keep

   subroutine write_lines(self)
      class(progress_t), intent(inout) :: self

      call append_output(self%listing, len(self%lines, c_size_t), self%lines, self%problem)
      self%lines = ''
   end subroutine write_lines

   !> A line in the columns of Radioss; kjoint adds no mass
   function listing_line(status) result(text)
      type(run_status_t), intent(in) :: status
      character(len=:), allocatable :: text

      character(len=128) :: buffer
      character(len=20) :: owner

      owner = status%owner_kind
      if (status%owner > 0) write (owner, '(a,i11)') status%owner_kind, status%owner
      write (buffer, '(i10,2es13.5,1x,a20,a11)') status%cycle, status%time, status%time_step, &
         owner, right(percent(status%energy_error), 11)
      text = buffer(:68)
      write (buffer, '(4es13.5,i9,es13.5,i12)') status%internal, &
         status%kinetic - status%kinetic_rot, status%kinetic_rot, status%work, 0, status%mass, 0
      text = text//trim(buffer)
   end function listing_line

   !> "  (joint 900)": what limits the time step; empty when it is not known
   pure function limiter(status) result(text)
      type(run_status_t), intent(in) :: status
      character(len=:), allocatable :: text

      text = ''
      if (status%owner > 0) text = '  ('//trim(status%owner_kind)//' '//str(status%owner)//')'
   end function limiter

   !> A fraction as "0.012 %"
   pure function percent(fraction) result(text)
      real(wp), intent(in) :: fraction
      character(len=:), allocatable :: text

      character(len=24) :: buffer
      real(wp) :: value

      value = 100*fraction
      if (abs(value) >= 1e4_wp .or. (abs(value) < 1e-3_wp .and. abs(value) > 0.0_wp)) then
         write (buffer, '(es9.1)') value
      else
         write (buffer, '(f12.3)') value
      end if
      text = trim(adjustl(buffer))//' %'
      if (text(1:1) == '.') text = '0'//text
      if (text(1:2) == '-.') text = '-0'//text(2:)
   end function percent

   !> A rate in three digits: "950", "12.3 k", "1.20 M"
   pure function rate(per_second) result(text)
      real(wp), intent(in) :: per_second
      character(len=:), allocatable :: text

      character(len=3), parameter :: unit(0:4) = ['   ', ' k ', ' M ', ' G ', ' T ']
      character(len=12) :: buffer
      real(wp) :: value
      integer :: i

      value = per_second
      do i = 0, 3
         if (value < 999.5_wp) exit
         value = value/1000
      end do
      if (value < 9.995_wp) then
         write (buffer, '(f5.2)') value
      else if (value < 99.95_wp) then
         write (buffer, '(f5.1)') value
      else
         write (buffer, '(i0)') nint(value)
      end if
      text = trim(adjustl(buffer))//trim(unit(i))
   end function rate

   !> Seconds as m:ss or h:mm:ss
   pure function clock(seconds) result(text)
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text

      character(len=24) :: buffer
      integer :: s

      s = nint(min(seconds, 3.6e8_wp))
      if (s < 3600) then
         write (buffer, '(i0,a,i2.2)') s/60, ':', mod(s, 60)
      else
         write (buffer, '(i0,2(a,i2.2))') s/3600, ':', mod(s/60, 60), ':', mod(s, 60)
      end if
      text = trim(buffer)
   end function clock

end module kj_progress
