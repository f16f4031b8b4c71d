!> Two histories walked through together, row by row at equal times, a block of rows in memory.
module kj_diff_walk
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_units, only: factor_of
   use kj_history, only: history_t, place_of
   use kj_channels, only: channels, CH_FINAL, AS_F64
   use kj_reader, only: history_reader_t, open_history_file, next_row, rewind_rows, &
      close_history_file
   implicit none
   private

   public :: cursor_t, walk_t, open_cursor, convert_units, rewind_cursor, advance, time_of, &
      is_final, close_cursor, start_walk, next_pair, in_window

   !> A history and one of its rows
   type :: cursor_t
      type(history_reader_t) :: reader
      type(history_t) :: history
      integer :: n_row = 0
      logical :: more = .false.                 !! there is a row
      real(wp), allocatable :: row(:)           !! (n_value) this one
      integer, private :: final_at = 0          !! place of the channel `final`, 0 = none
      real(wp), allocatable, private :: factor(:)   !! (n_value) to the units of the other side
   end type cursor_t

   !> A walk over both; x and y are the rows of REF and RUN at the time t
   type :: walk_t
      type(cursor_t) :: ref, run
      logical :: interpolate = .false.
      logical :: has_window = .false.
      real(wp) :: window(2) = 0.0_wp
      real(wp) :: tolerance = 0.0_wp            !! of equal times
      real(wp) :: t = 0.0_wp
      real(wp), allocatable :: x(:), y(:)
      integer :: n_pair = 0
      integer :: n_ref_alone = 0, n_run_alone = 0   !! without a partner, final rows apart
      real(wp) :: alone_at = 0.0_wp                 !! time of the first
      real(wp), allocatable, private :: before(:)   !! row of RUN before its present one
      logical, private :: has_before = .false.
      real(wp), private :: ref_step = 0.0_wp        !! between the last rows of REF
      real(wp), private :: last_t = 0.0_wp          !! of REF
   end type walk_t

contains

   ! ---- one side

   !> Open a history; errors: ERR_FILE
   subroutine open_cursor(path, cursor, error)
      character(len=*), intent(in) :: path
      type(cursor_t), intent(out) :: cursor
      type(error_t), allocatable, intent(out) :: error

      call open_history_file(path, cursor%reader, cursor%history, cursor%n_row, error)
      if (allocated(error)) return
      cursor%final_at = place_of(cursor%history, CH_FINAL)
      allocate (cursor%row(cursor%history%n_value))
   end subroutine open_cursor

   !> From now on give values in the units of another history, if both files say theirs
   subroutine convert_units(cursor, other)
      type(cursor_t), intent(inout) :: cursor
      type(cursor_t), intent(in) :: other

      integer :: i
      real(wp) :: factor

      if (.not. (cursor%reader%has_units .and. other%reader%has_units)) return
      if (all(abs(cursor%history%units%si - other%history%units%si) <= 0.0_wp)) return
      allocate (cursor%factor(cursor%history%n_value), source=1.0_wp)
      do i = 1, size(cursor%history%variable)
         associate (v => cursor%history%variable(i))
            factor = factor_of(channels(v%channel)%dim, cursor%history%units, other%history%units)
            cursor%factor(v%first:v%first + v%n_entity*v%n_comp - 1) = factor
         end associate
      end do
   end subroutine convert_units

   !> Go to the place before the first row
   subroutine rewind_cursor(cursor)
      type(cursor_t), intent(inout) :: cursor

      call rewind_rows(cursor%reader)
      cursor%more = .false.
   end subroutine rewind_cursor

   !> Go to the next row; errors: ERR_FILE
   subroutine advance(cursor, error)
      type(cursor_t), intent(inout) :: cursor
      type(error_t), allocatable, intent(out) :: error

      call next_row(cursor%reader, cursor%row, cursor%more, error)
      if (cursor%more .and. allocated(cursor%factor)) cursor%row = cursor%factor*cursor%row
   end subroutine advance

   !> Time of the present row: time is the first variable
   pure real(wp) function time_of(cursor) result(t)
      type(cursor_t), intent(in) :: cursor

      t = cursor%row(cursor%history%variable(1)%first)
   end function time_of

   !> Is the present row the state of the end, off the sample times
   pure logical function is_final(cursor)
      type(cursor_t), intent(in) :: cursor

      is_final = cursor%final_at > 0
      if (is_final) is_final = cursor%row(cursor%final_at) > 0.5_wp
   end function is_final

   !> Close; nothing happens when it is not open
   subroutine close_cursor(cursor)
      type(cursor_t), intent(inout) :: cursor

      type(error_t), allocatable :: error

      call close_history_file(cursor%reader, error)
      if (allocated(error)) deallocate (error)     ! it was only read: nothing can be lost
      cursor%more = .false.
   end subroutine close_cursor

   ! ---- both sides

   !> Go before the first pair; errors: ERR_FILE
   subroutine start_walk(walk, error)
      type(walk_t), intent(inout) :: walk
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(walk%x)) then
         allocate (walk%x(walk%ref%history%n_value), walk%y(walk%run%history%n_value))
         allocate (walk%before(walk%run%history%n_value))
      end if
      walk%n_pair = 0
      walk%n_ref_alone = 0
      walk%n_run_alone = 0
      walk%has_before = .false.
      walk%ref_step = 0.0_wp
      call rewind_cursor(walk%ref)
      call rewind_cursor(walk%run)
      call step_ref(walk, error)
      if (allocated(error)) return
      call step_run(walk, error)
   end subroutine start_walk

   !> Find the next two rows of equal time; rows without a partner are counted on the way
   !>
   !> A final row without a partner lies beyond the last common sample and is not counted.
   !> Errors: ERR_FILE.
   subroutine next_pair(walk, found, error)
      type(walk_t), intent(inout) :: walk
      logical, intent(out) :: found
      type(error_t), allocatable, intent(out) :: error

      if (walk%interpolate) then
         call next_between(walk, found, error)
      else
         call next_equal(walk, found, error)
      end if
      if (found) walk%n_pair = walk%n_pair + 1
   end subroutine next_pair

   !> The next two rows of equal time
   subroutine next_equal(walk, found, error)
      type(walk_t), intent(inout) :: walk
      logical, intent(out) :: found
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: late

      found = .false.
      do while (walk%ref%more .or. walk%run%more)
         late = merge(1.0_wp, -1.0_wp, walk%ref%more)
         if (walk%ref%more .and. walk%run%more) then
            late = time_of(walk%run) - time_of(walk%ref)
            found = abs(late) <= walk%tolerance
         end if
         if (found) then
            walk%t = time_of(walk%ref)
            walk%x = walk%ref%row
            walk%y = walk%run%row
            call step_ref(walk, error)
            if (.not. allocated(error)) call step_run(walk, error)
            return
         end if
         if (late > 0.0_wp) then
            call note_alone(walk, walk%ref, walk%n_ref_alone)
            call step_ref(walk, error)
         else
            call note_alone(walk, walk%run, walk%n_run_alone)
            call step_run(walk, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine next_equal

   !> The next row of REF with RUN interpolated at its time
   subroutine next_between(walk, found, error)
      type(walk_t), intent(inout) :: walk
      logical, intent(out) :: found
      type(error_t), allocatable, intent(out) :: error

      found = .false.
      do while (walk%ref%more .and. .not. found)
         walk%t = time_of(walk%ref)
         do while (walk%run%more)
            if (time_of(walk%run) >= walk%t - walk%tolerance) exit
            call step_run(walk, error)
            if (allocated(error)) return
         end do
         if (walk%run%more) then
            walk%y = walk%run%row
            found = walk%has_before .or. abs(time_of(walk%run) - walk%t) <= walk%tolerance
            if (walk%has_before .and. abs(time_of(walk%run) - walk%t) > walk%tolerance) &
               call interpolate(walk%run%history, walk%before, walk%t, walk%y)
         end if
         if (found) walk%x = walk%ref%row
         if (.not. found) call note_alone(walk, walk%ref, walk%n_ref_alone)
         call step_ref(walk, error)
         if (allocated(error)) return
      end do
      if (.not. found .and. .not. walk%has_window) call end_of_run(walk, error)
   end subroutine next_between

   !> Rows of RUN more than a sample interval after the end of REF: it has another end time
   subroutine end_of_run(walk, error)
      type(walk_t), intent(inout) :: walk
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: step

      do while (walk%run%more)
         step = walk%ref_step
         if (walk%has_before) step = max(step, time_of(walk%run) - walk%before(1))
         if (.not. time_of(walk%run) <= walk%last_t + step + walk%tolerance) &
            call note_alone(walk, walk%run, walk%n_run_alone)
         call step_run(walk, error)
         if (allocated(error)) return
      end do
   end subroutine end_of_run

   !> Value at t between two rows: linear; quaternions made 1 long again; integers of the row before
   pure subroutine interpolate(history, before, t, row)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: before(:)          !! row before
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: row(:)          !! row behind, then the value at t

      real(wp) :: s, q(4)
      integer :: i, k, first, last

      s = (t - before(1))/(row(1) - before(1))
      do i = 1, size(history%variable)
         first = history%variable(i)%first
         last = first + history%variable(i)%n_entity*history%variable(i)%n_comp - 1
         if (channels(history%variable(i)%channel)%kind /= AS_F64) then
            row(first:last) = before(first:last)
         else if (history%variable(i)%n_comp == 4) then
            do k = first, last, 4
               q = row(k:k + 3)
               if (dot_product(q, before(k:k + 3)) < 0.0_wp) q = -q
               q = before(k:k + 3) + s*(q - before(k:k + 3))
               row(k:k + 3) = q/norm2(q)
            end do
         else
            row(first:last) = before(first:last) + s*(row(first:last) - before(first:last))
         end if
      end do
      row(1) = t
   end subroutine interpolate

   !> Count a row that has no partner, unless it is the state of the end
   subroutine note_alone(walk, cursor, n)
      type(walk_t), intent(inout) :: walk
      type(cursor_t), intent(in) :: cursor
      integer, intent(inout) :: n

      if (is_final(cursor)) return
      if (walk%n_ref_alone + walk%n_run_alone == 0) walk%alone_at = time_of(cursor)
      n = n + 1
   end subroutine note_alone

   !> Next row of REF in the window
   subroutine step_ref(walk, error)
      type(walk_t), intent(inout) :: walk
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: before
      logical :: had

      had = walk%ref%more
      before = 0.0_wp
      if (had) before = time_of(walk%ref)
      call step_in_window(walk, walk%ref, error)
      if (allocated(error) .or. .not. walk%ref%more) return
      if (is_final(walk%ref)) return
      if (had) walk%ref_step = time_of(walk%ref) - before
      walk%last_t = time_of(walk%ref)
   end subroutine step_ref

   !> Next row of RUN: in the window, or any when it is interpolated
   subroutine step_run(walk, error)
      type(walk_t), intent(inout) :: walk
      type(error_t), allocatable, intent(out) :: error

      walk%has_before = walk%run%more .and. walk%interpolate
      if (walk%has_before) walk%before = walk%run%row
      if (walk%interpolate) then
         call advance(walk%run, error)
      else
         call step_in_window(walk, walk%run, error)
      end if
   end subroutine step_run

   !> Is a time inside the window, if there is one
   pure logical function in_window(walk, t)
      type(walk_t), intent(in) :: walk
      real(wp), intent(in) :: t

      in_window = .not. walk%has_window .or. (t >= walk%window(1) .and. t <= walk%window(2))
   end function in_window

   subroutine step_in_window(walk, cursor, error)
      type(walk_t), intent(in) :: walk
      type(cursor_t), intent(inout) :: cursor
      type(error_t), allocatable, intent(out) :: error

      do
         call advance(cursor, error)
         if (allocated(error) .or. .not. cursor%more .or. .not. walk%has_window) return
         if (in_window(walk, time_of(cursor))) return
      end do
   end subroutine step_in_window

end module kj_diff_walk
