!> Compares two histories, channel by channel and entity by entity: `kjoint diff`.
!>
!> A pass over REF finds the peaks that the tolerances hang on, a pass over both sides compares
!> rows of equal time; a block of rows of each is in memory, however long they are. ISO/TS 18571
!> ratings need whole curves, so that the two files are walked through again for as many curves at a
!> time as fit in memory.
!> One file: matching, comparing and rating are one pass after the other over the same list.
module kj_diff
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_FILE, ERR_INPUT, str
   use kj_channels, only: CH_TIME, channels, OF_RUN, OF_JOINT, CH_CYCLE, CH_TIME_STEP, &
      CH_OWNER_KIND, CH_OWNER
   use kj_metrics, only: metrics, curve_sums_t, add_sample, finish_metrics, M_ISO, M_ISO_Z, &
      M_ISO_P, M_ISO_M, M_ISO_S, rate_iso18571, iso18571_t
   use kj_diff_types, only: diff_options_t, diff_result_t, channel_result_t, profile_t, &
      find_profile, set_window, N_WORST, class_result_t
   use kj_diff_walk, only: walk_t, open_cursor, convert_units, rewind_cursor, advance, time_of, &
      is_final, in_window, close_cursor, start_walk, next_pair, cursor_t
   use kj_diff_measure, only: rounding_t, rounding_of, add_peaks, scene_energy, set_tolerances, &
      compare_rows, list_groups, find_in_groups, entity_ids
   use kj_diff_report, only: diff_text, diff_json, diff_junit
   use kj_text, only: append_text, text_t
   use kj_sort, only: lookup_t
   use kj_history, only: history_t, entity_title
   use kj_series, only: series_t, find_series, component_name, channel_path, NORM
   implicit none
   private

   public :: compare_histories, diff_options_t, diff_result_t, set_window, diff_text, diff_json, &
      diff_junit

   real(wp), parameter :: EQUAL_TIMES = 1.0e-9_wp           !! of the span of REF
   real(wp), parameter :: EQUAL_TIMES_SINGLE = 1.0e-7_wp    !! where a side has 32-bit times

   !> What tells of the steps of a run and not of the scene
   integer, parameter :: OF_STEPS(4) = [CH_CYCLE, CH_TIME_STEP, CH_OWNER_KIND, CH_OWNER]

   integer, parameter :: MOST_SAMPLES = 10000     !! the cost grows with their square
   integer, parameter :: MOST_REALS = 2**23       !! of curves in memory

contains

   !> Compare RUN with REF; either may be a history of ours or a T01
   !>
   !> Errors: ERR_FILE when a file cannot be read or REF holds no sample, ERR_INPUT when the
   !> profile is not known or the window holds no sample of REF.
   subroutine compare_histories(ref_path, run_path, options, result, error)
      character(len=*), intent(in) :: ref_path, run_path
      type(diff_options_t), intent(in) :: options
      type(diff_result_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error

      type(walk_t) :: walk

      result%ref_path = ref_path
      result%run_path = run_path
      call open_cursor(ref_path, walk%ref, error)
      if (allocated(error)) return
      call open_cursor(run_path, walk%run, error)
      if (.not. allocated(error)) call choose_profile(options, walk, result%profile, error)
      if (.not. allocated(error)) call compare_open(walk, options, result, error)
      call close_cursor(walk%ref)
      call close_cursor(walk%run)
   end subroutine compare_histories

   !> The profile asked for, else parity with a T01 on a side, else platform; with its tolerance
   subroutine choose_profile(options, walk, profile, error)
      type(diff_options_t), intent(in) :: options
      type(walk_t), intent(in) :: walk
      type(profile_t), intent(out) :: profile
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: name

      name = trim(options%profile)
      if (name == '') then
         name = 'platform'
         if (walk%ref%reader%is_t01 .or. walk%run%reader%is_t01) name = 'parity'
      end if
      call find_profile(name, profile, error)
      if (options%rtol >= 0.0_wp) profile%rtol = options%rtol
      profile%bitwise = profile%bitwise .and. options%rtol < 0.0_wp
   end subroutine choose_profile

   !> The comparison of two open histories
   subroutine compare_open(walk, options, result, error)
      type(walk_t), intent(inout) :: walk
      type(diff_options_t), intent(in) :: options
      type(diff_result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error

      type(rounding_t) :: rounding
      type(curve_sums_t), allocatable :: sums(:)
      logical :: found, single(2)

      call take_notes(walk, result)
      call convert_units(walk%run, walk%ref)
      call match_channels(walk%ref, walk%run, options, result%profile, result%channel, error)
      if (allocated(error)) return
      if (allocated(options%channels)) then
         allocate (result%run_only(0))
      else
         call list_run_only(walk%ref, walk%run, result%run_only)
      end if
      call find_classes(result%channel, result%class)
      result%strict = options%strict
      single = [walk%ref%history%single_precision, walk%run%history%single_precision]
      rounding = rounding_of(count(single))
      walk%interpolate = options%interpolate
      walk%has_window = options%has_window
      walk%window = options%window + [-1, 1]*maxval(abs(options%window))* &
         merge(EQUAL_TIMES_SINGLE, EQUAL_TIMES, any(single))
      call look_at_reference(walk, options, any(single), result, error)
      if (.not. allocated(error)) call start_walk(walk, error)
      allocate (sums(merge(sum(result%channel%n_comp), 0, any(options%metrics))))
      do
         if (.not. allocated(error)) call next_pair(walk, found, error)
         if (allocated(error)) return
         if (.not. found) exit
         call compare_rows(walk%t, walk%x, walk%y, result%profile%bitwise, rounding, result%channel)
         if (size(sums) > 0) call add_to_sums(walk, result%channel, sums)
      end do
      call judge(walk, result)
      if (size(sums) == 0) return
      call keep_metrics(sums, result%channel)
      if (options%metrics(M_ISO)) call rate_channels(walk, result%channel, result%note, error)
   end subroutine compare_open

   !> What the user should know about the two files
   subroutine take_notes(walk, result)
      type(walk_t), intent(in) :: walk
      type(diff_result_t), intent(inout) :: result

      result%ignored = walk%ref%reader%unknown
      result%n_ref = walk%ref%n_row
      result%n_run = walk%run%n_row
      allocate (result%note(0))
      if (allocated(walk%ref%reader%note)) call append_text(result%note, &
         'REF: '//walk%ref%reader%note)
      if (allocated(walk%run%reader%note)) call append_text(result%note, &
         'RUN: '//walk%run%reader%note)
   end subroutine take_notes

   !> First pass: peaks and energy of REF inside the window, the span of its times; then tolerances
   subroutine look_at_reference(walk, options, single, result, error)
      type(walk_t), intent(inout) :: walk
      type(diff_options_t), intent(in) :: options
      logical, intent(in) :: single                !! a side has 32-bit times
      type(diff_result_t), intent(inout) :: result
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: t, first, last, energy
      integer :: n, i

      n = 0
      first = huge(1.0_wp)
      last = -huge(1.0_wp)
      energy = 0.0_wp
      call rewind_cursor(walk%ref)
      do
         call advance(walk%ref, error)
         if (allocated(error)) return
         if (.not. walk%ref%more) exit
         t = time_of(walk%ref)
         if (.not. is_final(walk%ref)) last = max(last, t)
         first = min(first, t)
         if (.not. in_window(walk, t)) cycle
         n = n + 1
         call add_peaks(walk%ref%row, result%channel)
         energy = max(energy, scene_energy(walk%ref%row, result%channel))
      end do
      if (n == 0 .and. walk%ref%n_row == 0) then
         call fail(error, ERR_FILE, result%ref_path//' holds no sample')
      else if (n == 0) then
         call fail(error, ERR_INPUT, 'the window holds no sample of '//result%ref_path)
      end if
      if (n == 0) return
      last = max(first, last)
      walk%tolerance = EQUAL_TIMES*(last - first)
      if (single) walk%tolerance = EQUAL_TIMES_SINGLE*max(last - first, abs(last))
      call set_tolerances(result%profile, options%atol, energy, result%channel)
      do i = 1, size(result%channel)
         if (result%channel(i)%channel == CH_TIME) result%channel(i)%tolerance = walk%tolerance
      end do
   end subroutine look_at_reference

   !> Add a pair of rows to the sums of the metrics
   subroutine add_to_sums(walk, list, sums)
      type(walk_t), intent(in) :: walk
      type(channel_result_t), intent(in) :: list(:)
      type(curve_sums_t), intent(inout) :: sums(:)    !! one for each number of each channel

      integer :: i, k, at

      at = 0
      do i = 1, size(list)
         if (list(i)%run_at > 0) then
            do k = 1, list(i)%n_comp
               call add_sample(sums(at + k), walk%t, walk%x(list(i)%ref_at + k - 1), &
                  walk%y(list(i)%run_at + k - 1))
            end do
         end if
         at = at + list(i)%n_comp
      end do
   end subroutine add_to_sums

   !> From the sums to the metrics
   subroutine keep_metrics(sums, list)
      type(curve_sums_t), intent(in) :: sums(:)
      type(channel_result_t), intent(inout) :: list(:)

      integer :: i, k, at

      at = 0
      do i = 1, size(list)
         allocate (list(i)%metric(size(metrics), list(i)%n_comp), &
            source=ieee_value(1.0_wp, ieee_quiet_nan))
         do k = 1, list(i)%n_comp
            call finish_metrics(sums(at + k), list(i)%metric(:, k))
         end do
         at = at + list(i)%n_comp
      end do
   end subroutine keep_metrics

   !> The verdict, the classes and the worst channels
   subroutine judge(walk, result)
      type(walk_t), intent(in) :: walk
      type(diff_result_t), intent(inout) :: result

      integer :: i

      result%n_sample = walk%n_pair
      result%n_ref_alone = walk%n_ref_alone
      result%n_run_alone = walk%n_run_alone
      result%alone_at = walk%alone_at
      do i = 1, size(result%channel)
         associate (c => result%channel(i))
            if (c%channel == CH_TIME .and. walk%n_ref_alone + walk%n_run_alone > 0) then
               c%different = .true.
               c%excess = huge(1.0_wp)
               c%time = walk%alone_at
            end if
            if (.not. c%counted) cycle
            if (c%run_at == 0) then
               c%different = .true.
               c%excess = huge(1.0_wp)
            end if
            result%n_channel = result%n_channel + 1
            result%class(c%class)%n_channel = result%class(c%class)%n_channel + 1
            call note_worst(i, result)
            if (c%channel /= CH_TIME) result%n_number = result%n_number + c%n_number
            if (c%n_void > 0) result%incomplete = .true.
            if (.not. c%different) cycle
            result%n_different = result%n_different + 1
            result%class(c%class)%n_different = result%class(c%class)%n_different + 1
         end associate
      end do
      result%incomplete = result%incomplete .or. result%n_number == 0 .or. &
         size(result%ignored) > 0
      result%code = merge(1, 0, result%n_different > 0 .or. &
         (result%strict .and. (result%incomplete .or. size(result%run_only) > 0)))
   end subroutine judge

   !> Put a channel in its place among the worst of all and of its class
   subroutine note_worst(i, result)
      integer, intent(in) :: i
      type(diff_result_t), intent(inout) :: result

      integer :: at

      if (.not. result%channel(i)%excess > 0.0_wp) return
      associate (class => result%class(result%channel(i)%class))
         if (class%worst == 0) then
            class%worst = i
         else if (result%channel(i)%excess > result%channel(class%worst)%excess) then
            class%worst = i
         end if
      end associate
      at = result%n_worst + 1
      do while (at > 1)
         if (result%channel(result%worst(at - 1))%excess >= result%channel(i)%excess) exit
         at = at - 1
      end do
      if (at > N_WORST) return
      result%n_worst = min(result%n_worst + 1, N_WORST)
      result%worst(at + 1:result%n_worst) = result%worst(at:result%n_worst - 1)
      result%worst(at) = i
   end subroutine note_worst

   !> List every channel of every entity of REF with its place in RUN, 0 where RUN has none
   !>
   !> A T01 has joints and springs in one group, a history of ours has two: what is not found in the
   !> one group is looked for in the other. There springs of type 4 alone have no moments, which in
   !> a T01 are 0: these are left out.
   !> Profile `solver` and interpolation compare runs of other steps: channels that tell of the
   !> steps are then listed only. Of a vector of which some components are wanted each stands alone.
   !> Errors: ERR_INPUT when a wanted channel is not in REF
   subroutine match_channels(ref, run, options, profile, list, error)
      type(cursor_t), intent(in) :: ref, run
      type(diff_options_t), intent(in) :: options
      type(profile_t), intent(in) :: profile
      type(channel_result_t), allocatable, intent(out) :: list(:)
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ref_id(:)
      type(lookup_t) :: in_run(2)
      logical :: wanted(ref%history%n_value)
      integer :: run_variable(size(channels)), group(2), i, j, k, g, n, at, c

      call mark_wanted(ref%history, options, wanted, error)
      if (allocated(error)) return
      wanted = wanted .and. ref%reader%given
      n = 0
      do i = 1, size(ref%history%variable)
         associate (v => ref%history%variable(i))
            do at = v%first, v%first + (v%n_entity - 1)*v%n_comp, v%n_comp
               if (all(wanted(at:at + v%n_comp - 1))) then
                  n = n + 1
               else
                  n = n + count(wanted(at:at + v%n_comp - 1))
               end if
            end do
         end associate
      end do
      allocate (list(n))
      run_variable = 0
      do i = 1, size(run%history%variable)
         run_variable(run%history%variable(i)%channel) = i
      end do
      n = 0
      do i = 1, size(ref%history%variable)
         associate (v => ref%history%variable(i))
            call entity_ids(ref%history, channels(v%channel)%owner, ref_id)
            call list_groups(run%history, v%channel, group, in_run)
            do j = 1, v%n_entity
               at = v%first + (j - 1)*v%n_comp
               call find_in_groups(ref_id, j, in_run, k, g)
               if (g == 2 .and. channels(v%channel)%owner == OF_JOINT) then
                  if (run_variable(group(g)) == 0) cycle
               end if
               if (all(wanted(at:at + v%n_comp - 1))) then
                  call append(v%channel, j, k, at, 0, v%n_comp, '')
               else
                  do c = 1, v%n_comp
                     if (wanted(at + c - 1)) call append(v%channel, j, k, at, c - 1, 1, &
                        '.'//component_name(v%n_comp, c))
                  end do
               end if
            end do
         end associate
      end do
      list = list(:n)

   contains

      !> Some components of an entity: n_comp from the one behind `skip`
      subroutine append(channel, entity, entity_in_run, ref_at, skip, n_comp, component)
         integer, intent(in) :: channel, entity, entity_in_run, ref_at, skip, n_comp
         character(len=*), intent(in) :: component

         n = n + 1
         list(n)%channel = channel
         list(n)%entity = ref_id(entity)
         list(n)%n_comp = n_comp
         list(n)%ref_at = ref_at + skip
         list(n)%name = name_of(channel, str(ref_id(entity)))//component
         list(n)%title = title_of(ref%history, channel, entity)//component
         list(n)%counted = .not. (any(OF_STEPS == channel) .and. &
            (profile%name == 'solver' .or. options%interpolate))
         if (entity_in_run == 0 .or. run_variable(group(g)) == 0) return
         associate (v => run%history%variable(run_variable(group(g))))
            at = v%first + (entity_in_run - 1)*v%n_comp + skip
         end associate
         if (run%reader%given(at)) list(n)%run_at = at
      end subroutine append
   end subroutine match_channels

   !> Channels that RUN has and REF has not, also variables that our layout does not know
   subroutine list_run_only(ref, run, list)
      type(cursor_t), intent(in) :: ref, run
      type(text_t), allocatable, intent(out) :: list(:)

      integer, allocatable :: run_id(:)
      type(lookup_t) :: in_ref(2)
      type(text_t), allocatable :: found(:)
      integer :: ref_variable(size(channels)), group(2), i, j, k, g, at, n

      n = 0
      allocate (found(sum(run%history%variable%n_entity) + size(run%reader%unknown)))
      ref_variable = 0
      do i = 1, size(ref%history%variable)
         ref_variable(ref%history%variable(i)%channel) = i
      end do
      do i = 1, size(run%history%variable)
         associate (v => run%history%variable(i))
            call entity_ids(run%history, channels(v%channel)%owner, run_id)
            call list_groups(ref%history, v%channel, group, in_ref)
            do j = 1, v%n_entity
               if (.not. run%reader%given(v%first + (j - 1)*v%n_comp)) cycle
               call find_in_groups(run_id, j, in_ref, k, g)
               if (k > 0) then
                  if (ref_variable(group(g)) > 0) then
                     associate (w => ref%history%variable(ref_variable(group(g))))
                        at = w%first + (k - 1)*w%n_comp
                     end associate
                     if (ref%reader%given(at)) cycle
                  end if
               end if
               n = n + 1
               found(n)%s = title_of(run%history, v%channel, j)
            end do
         end associate
      end do
      do i = 1, size(run%reader%unknown)
         if (any([(ref%reader%unknown(j)%s == run%reader%unknown(i)%s, &
            j=1, size(ref%reader%unknown))])) cycle
         n = n + 1
         found(n)%s = run%reader%unknown(i)%s
      end do
      allocate (list(n))
      do i = 1, n
         call move_alloc(found(i)%s, list(i)%s)
      end do
   end subroutine list_run_only

   !> The values of a row of REF that are to be compared; the time always
   !>
   !> Errors: ERR_INPUT for a name that means nothing, or the norm of a vector.
   subroutine mark_wanted(history, options, wanted, error)
      type(history_t), intent(in) :: history
      type(diff_options_t), intent(in) :: options
      logical, intent(out) :: wanted(:)
      type(error_t), allocatable, intent(out) :: error

      type(series_t), allocatable :: series(:)
      integer :: i

      wanted = .not. allocated(options%channels)
      if (.not. allocated(options%channels)) return
      call find_series(history, options%channels, series, error)
      if (allocated(error)) return
      wanted(1) = .true.
      do i = 1, size(series)
         if (series(i)%comp == NORM) then
            call fail(error, ERR_INPUT, 'norms are not compared, but the vectors themselves: '// &
               series(i)%name)
            return
         end if
         associate (v => history%variable(series(i)%variable))
            wanted(v%first + (series(i)%entity - 1)*v%n_comp + series(i)%comp - 1) = .true.
         end associate
      end do
   end subroutine mark_wanted

   !> "joint/force[5]", "kinetic_energy_trans"
   pure function name_of(channel, entity) result(name)
      integer, intent(in) :: channel
      character(len=*), intent(in) :: entity
      character(len=:), allocatable :: name

      name = channel_path(channel)
      if (channels(channel)%owner /= OF_RUN) name = name//'['//entity//']'
   end function name_of

   !> "joint/force[pin C (5)]" of an entity by its place
   pure function title_of(history, channel, e) result(title)
      type(history_t), intent(in) :: history
      integer, intent(in) :: channel, e
      character(len=:), allocatable :: title

      title = name_of(channel, '')
      if (channels(channel)%owner /= OF_RUN) &
         title = name_of(channel, entity_title(history, channels(channel)%owner, e))
   end function title_of

   !> The classes that occur, in the order of the channels, and the class of each channel
   subroutine find_classes(list, classes)
      type(channel_result_t), intent(inout) :: list(:)
      type(class_result_t), allocatable, intent(out) :: classes(:)

      type(class_result_t) :: found(size(channels))
      integer :: i, n

      n = 0
      do i = 1, size(list)
         list(i)%class = findloc(found(:n)%name, channels(list(i)%channel)%class, 1)
         if (list(i)%class > 0) cycle
         n = n + 1
         found(n)%name = channels(list(i)%channel)%class
         list(i)%class = n
      end do
      classes = found(:n)
   end subroutine find_classes

   !> Rate every number of every channel that both sides have
   !>
   !> Of more than MOST_SAMPLES samples every second, third, ... is taken, and a note says so.
   !> Errors: ERR_FILE.
   subroutine rate_channels(walk, list, note, error)
      type(walk_t), intent(inout) :: walk
      type(channel_result_t), intent(inout) :: list(:)
      type(text_t), allocatable, intent(inout) :: note(:)
      type(error_t), allocatable, intent(out) :: error

      integer :: channel(sum(list%n_comp)), comp(sum(list%n_comp)), i, k, n, step, n_kept, most

      if (walk%n_pair == 0) return
      n = 0
      do i = 1, size(list)
         if (list(i)%run_at == 0) cycle
         do k = 1, list(i)%n_comp
            n = n + 1
            channel(n) = i
            comp(n) = k
         end do
      end do
      step = 1 + (walk%n_pair - 1)/MOST_SAMPLES
      n_kept = 1 + (walk%n_pair - 1)/step
      if (step > 1) call append_text(note, 'iso18571: one of '//str(step)//' samples is rated')
      most = max(1, MOST_REALS/(2*n_kept))
      do i = 1, n, most
         k = min(n, i + most - 1)
         call rate_curves(walk, step, n_kept, channel(i:k), comp(i:k), list, error)
         if (allocated(error)) return
      end do
   end subroutine rate_channels

   !> Collect some curves in a walk and rate them
   subroutine rate_curves(walk, step, n_kept, channel, comp, list, error)
      type(walk_t), intent(inout) :: walk
      integer, intent(in) :: step, n_kept                !! one sample of `step`; samples taken
      integer, intent(in) :: channel(:), comp(:)         !! place in `list`, number of the channel
      type(channel_result_t), intent(inout) :: list(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: x(:, :), y(:, :)          !! (n_kept, curves)
      type(iso18571_t) :: rating
      logical :: found
      integer :: i, n

      allocate (x(n_kept, size(channel)), y(n_kept, size(channel)))
      call start_walk(walk, error)
      do
         if (allocated(error)) return
         call next_pair(walk, found, error)
         if (allocated(error)) return
         if (.not. found) exit
         if (mod(walk%n_pair - 1, step) /= 0) cycle
         n = 1 + (walk%n_pair - 1)/step
         do i = 1, size(channel)
            x(n, i) = walk%x(list(channel(i))%ref_at + comp(i) - 1)
            y(n, i) = walk%y(list(channel(i))%run_at + comp(i) - 1)
         end do
      end do
      do i = 1, size(channel)
         call rate_iso18571(x(:, i), y(:, i), rating)
         associate (m => list(channel(i))%metric)
            m(M_ISO_Z, comp(i)) = rating%corridor
            m(M_ISO_P, comp(i)) = rating%phase
            m(M_ISO_M, comp(i)) = rating%magnitude
            m(M_ISO_S, comp(i)) = rating%slope
            m(M_ISO, comp(i)) = rating%overall
         end associate
      end do
   end subroutine rate_curves

end module kj_diff
