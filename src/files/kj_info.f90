!> What is in a history file, as text for people or as JSON: `kjoint info`.
!> One file: what is told of a history, from its survey to its lines
module kj_info
   use kj_kinds, only: wp
   use kj_error, only: error_t, str
   use kj_words, only: counted, few, left, right, json_member, json_pair, json_list, comma, &
      json_real
   use kj_units, only: unit_text, D_TIME, unit_system_t, D_LENGTH, D_FORCE, D_MOMENT, D_ANGLE, &
      D_ANGULAR_VELOCITY, D_STIFFNESS
   use kj_channels, only: channels, groups, CH_TIME, CH_CYCLE, CH_TIME_STEP, CH_J_GAP, &
      CH_J_GAP_ROT, CH_KE_TRANS, CH_KE_ROT, CH_IE, CH_WORK, CH_POTENTIAL, CH_ENERGY_ERROR, &
      CH_FINAL, CH_OWNER_KIND, CH_OWNER, OF_JOINT, OF_SPRING
   use kj_history, only: history_t, variable_t, n_entity, entity_title, place_of
   use kj_output, only: find_part, is_written
   use kj_text, only: text_t, append_text, fact
   use kj_reader, only: history_reader_t, open_history_file, next_row, read_facts, &
      close_history_file
   use kj_series, only: channel_path
   use kj_extremes, only: extremes_t, watch_row, extreme_t
   use kj_snapshot, only: OWNER_JOINT
   implicit none
   private

   public :: describe_history, worst_lines, worst_json

   integer, parameter :: N_KIND = 7
   real(wp), parameter :: LITTLE = 1.0e-3_wp     !! blocked turns below are not worth a line
   real(wp), parameter :: SOFT = 0.1_wp          !! Kn gap over force: below, Kn did not act

   integer, parameter :: NAME_WIDTH = 34, SHAPE_WIDTH = 18, UNIT_WIDTH = 14, NUMBER_WIDTH = 16

   !> What one pass over the rows finds
   type :: survey_t
      integer :: n_row = 0
      real(wp), allocatable :: first(:), last(:)       !! (n_value) the first and the last row
      real(wp), allocatable :: peak(:)                !! (variable) largest norm over entities, time
      real(wp), allocatable :: peak_time(:)            !! (variable) when that was
      real(wp) :: shortest_step = huge(1.0_wp), longest_step = 0.0_wp
      type(extremes_t) :: extremes                     !! what gave way most
      integer :: n_bad = 0                             !! values that are not finite
   end type survey_t

contains

   !> Describe a history of either kind: status, provenance, span, what gave way most, channels with
   !> shape, unit and peak, energies; in lines for people or as a JSON object.
   !> Errors: ERR_FILE when it cannot be read
   subroutine describe_history(path, as_json, text, error)
      character(len=*), intent(in) :: path
      logical, intent(in) :: as_json
      character(len=:), allocatable, intent(out) :: text   !! lines, each ended by a line feed
      type(error_t), allocatable, intent(out) :: error

      type(error_t), allocatable :: closing
      type(history_reader_t) :: reader
      type(history_t) :: history
      type(survey_t) :: survey
      type(text_t), allocatable :: names(:), values(:)
      integer :: n_row

      text = ''
      call open_history_file(path, reader, history, n_row, error)
      if (allocated(error)) return
      call survey_rows(reader, history, survey, error)
      if (.not. allocated(error)) call read_facts(reader, names, values, error)
      call close_history_file(reader, closing)
      if (allocated(error)) return
      if (as_json) then
         text = info_json(path, reader, history, survey, names, values)
         return
      end if
      call add_provenance(path, reader, history, names, values, text)
      call add_span(history, survey, names, values, text)
      call add_worst(history, survey, fact('integrator', names, values, ''), text)
      call add_channels(history, survey, text)
      call add_energies(history, survey, text)
   end subroutine describe_history

   !> What gave way most
   subroutine add_worst(history, survey, integrator, text)
      type(history_t), intent(in) :: history
      type(survey_t), intent(in) :: survey
      character(len=*), intent(in) :: integrator     !! '' where it is not known
      character(len=:), allocatable, intent(inout) :: text

      type(text_t), allocatable :: lines(:)
      integer :: owner, kind_at, i

      owner = 0
      kind_at = place_of(history, CH_OWNER_KIND)
      if (kind_at > 0 .and. survey%n_row > 0) then
         if (nint(survey%last(kind_at)) == OWNER_JOINT) &
            owner = nint(survey%last(place_of(history, CH_OWNER)))
      end if
      if (integrator == 'compliant') owner = -1
      call worst_lines(history, survey%extremes, owner, lines)
      if (size(lines) > 0) call add_line(text, '')
      do i = 1, size(lines)
         call add_line(text, '  '//lines(i)%s)
      end do
   end subroutine add_worst

   !> The same as one object
   function info_json(path, reader, history, survey, names, values) result(json)
      character(len=*), intent(in) :: path
      type(history_reader_t), intent(in) :: reader
      type(history_t), intent(in) :: history
      type(survey_t), intent(in) :: survey
      type(text_t), intent(in) :: names(:), values(:)
      character(len=:), allocatable :: json

      integer :: i, n, owner

      json = '{'//json_member('exit_code', 0)//', '//json_member('file', path)//', '// &
         json_member('kind', trim(merge('T01   ', 'kjoint', reader%is_t01)))//', '// &
         json_member('title', trim(history%title))//', "run": {'
      do i = 1, size(names)
         json = json//json_member(names(i)%s, values(i)%s)//comma(i, size(names))
      end do
      n = survey%n_row
      json = json//'}, '//json_member('samples', n)
      if (n > 0) json = json//', '//json_member('first_time', survey%first(1))//', '// &
         json_member('last_time', survey%last(1))
      if (all(history%units%si > 0.0_wp)) json = json//', '// &
         json_pair('units', json_list(history%units%symbol))
      do owner = OF_JOINT, OF_SPRING
         if (n_entity(history, owner) == 0) cycle
         json = json//', "'//trim(groups(owner)%path)//'": ['
         do i = 1, n_entity(history, owner)
            json = json//'{'//json_member('id', history%entity(owner)%id(i))//', '// &
               json_member('name', entity_title(history, owner, i))//'}'// &
               comma(i, n_entity(history, owner))
         end do
         json = json//']'
      end do
      json = json//', "worst": '//worst_json(history, survey%extremes)//', "channels": ['
      do i = 1, size(history%variable)
         associate (v => history%variable(i))
            json = json//'{'//json_member('name', channel_path(v%channel))//', '// &
               json_member('entities', v%n_entity)//', '// &
               json_member('components', v%n_comp)//', '//json_member('units', &
               unit_text(channels(v%channel)%dim, history%units))//', '// &
               json_member('peak', survey%peak(i))//', '// &
               json_member('peak_time', survey%peak_time(i))//'}'//comma(i, size(history%variable))
         end associate
      end do
      json = json//'], '//json_member('values_not_finite', survey%n_bad)//'}'//new_line('a')
   end function info_json

   !> Go once over all rows
   subroutine survey_rows(reader, history, survey, error)
      type(history_reader_t), intent(inout) :: reader
      type(history_t), intent(in) :: history
      type(survey_t), intent(out) :: survey
      type(error_t), allocatable, intent(out) :: error

      real(wp), allocatable :: row(:)
      logical :: more

      allocate (row(history%n_value))
      allocate (survey%first(history%n_value), survey%last(history%n_value), &
         survey%peak(size(history%variable)), survey%peak_time(size(history%variable)), &
         source=0.0_wp)
      do
         call next_row(reader, row, more, error)
         if (.not. more) return
         if (survey%n_row == 0) survey%first = row
         survey%n_row = survey%n_row + 1
         call survey_row(history, row, survey)
         call watch_row(history, row, survey%extremes)
         survey%last = row
      end do
   end subroutine survey_rows

   !> Work one row into the survey
   subroutine survey_row(history, row, survey)
      type(history_t), intent(in) :: history
      real(wp), intent(in) :: row(:)
      type(survey_t), intent(inout) :: survey

      real(wp) :: largest, time
      integer :: i, j, at, n_comp

      time = 0.0_wp
      do i = 1, size(history%variable)
         at = history%variable(i)%first
         n_comp = history%variable(i)%n_comp
         ! a gap is NaN where there is no stop
         if (all(history%variable(i)%channel /= [CH_J_GAP, CH_J_GAP_ROT])) &
            survey%n_bad = survey%n_bad + count(.not. abs( &
            row(at:at + n_comp*history%variable(i)%n_entity - 1)) <= huge(1.0_wp))
         if (history%variable(i)%channel == CH_TIME) time = row(at)
         if (history%variable(i)%channel == CH_TIME_STEP .and. row(at) > 0.0_wp) then
            survey%shortest_step = min(survey%shortest_step, row(at))
            survey%longest_step = max(survey%longest_step, row(at))
         end if
         largest = 0.0_wp
         do j = 1, history%variable(i)%n_entity
            largest = max(largest, norm2(row(at:at + n_comp - 1)))
            at = at + n_comp
         end do
         if (largest <= survey%peak(i)) cycle
         survey%peak(i) = largest
         survey%peak_time(i) = time
      end do
   end subroutine survey_row

   !> Title, status and where the history comes from
   subroutine add_provenance(path, reader, history, names, values, text)
      character(len=*), intent(in) :: path
      type(history_reader_t), intent(in) :: reader
      type(history_t), intent(in) :: history
      type(text_t), intent(in) :: names(:), values(:)      !! attributes of /run
      character(len=:), allocatable, intent(inout) :: text

      character(len=:), allocatable :: made, inputs
      integer :: i

      call add_line(text, path)
      if (len(history%title) > 0) call add_fact(text, 'title', trim(history%title))
      if (reader%is_t01) then
         call add_fact(text, 'made by', fact('made by', names, values, ''))
         if (allocated(reader%note)) call add_fact(text, 'note', reader%note)
         return
      end if
      made = fact('status', names, values, 'unknown')
      if (made == 'RUNNING') then
         if (.not. is_written(path)) made = 'RUNNING, but nothing writes it: the run was killed'
      end if
      call add_fact(text, 'status', made)
      call find_part(path, .false., made)
      if (made /= '') call add_fact(text, 'newer', 'a run that did not end left '//made)
      made = 'kjoint '//fact('version', names, values, 'of unknown version')
      made = joined(made, ', started ', fact('started', names, values, ''))
      made = joined(made, ', elapsed [s]: ', fact('elapsed_s', names, values, ''))
      made = joined(made, ', threads: ', fact('n_threads', names, values, ''))
      made = joined(made, ', host ', fact('host', names, values, ''))
      call add_fact(text, 'made by', made)
      call add_fact(text, 'scheme', fact('integrator', names, values, ''))
      call add_fact(text, 'command', fact('command_line', names, values, ''))
      call add_fact(text, 'compiler', fact('compiler', names, values, ''))
      if (allocated(history%input_name)) then
         inputs = ''
         do i = 1, size(history%input_name)
            if (i > 1) inputs = inputs//', '
            inputs = inputs//history%input_name(i)%s//' ('//history%input_role(i)%s//')'
         end do
         call add_fact(text, 'input', inputs)
      end if
   end subroutine add_provenance

   !> Entities, samples, cycles and steps
   subroutine add_span(history, survey, names, values, text)
      type(history_t), intent(in) :: history
      type(survey_t), intent(in) :: survey
      type(text_t), intent(in) :: names(:), values(:)
      character(len=:), allocatable, intent(inout) :: text

      character(len=10), parameter :: ONE(OF_JOINT:OF_SPRING) = [character(len=10) :: &
         'joint', 'rigid body', 'node', 'spring']
      character(len=12), parameter :: MANY(OF_JOINT:OF_SPRING) = [character(len=12) :: &
         'joints', 'rigid bodies', 'nodes', 'springs']
      character(len=:), allocatable :: line, unit
      integer :: i, owner

      unit = unit_text(D_TIME, history%units)
      line = trim(history%units%symbol(1))//', '//trim(history%units%symbol(2))//', '//unit
      if (.not. all(history%units%si > 0.0_wp)) line = 'not known'
      call add_fact(text, 'units', line)
      line = ''
      do owner = OF_JOINT, OF_SPRING
         if (allocated(history%entity(owner)%id)) line = joined(line, ', ', &
            counted(n_entity(history, owner), trim(ONE(owner)), trim(MANY(owner))))
      end do
      call add_fact(text, 'holds', line)
      line = counted(survey%n_row, 'sample', 'samples')
      i = place_of(history, CH_TIME)
      if (i > 0 .and. survey%n_row > 0) line = line//', t = '//few(survey%first(i), 6)//' to '// &
         few(survey%last(i), 6)//' '//unit
      i = place_of(history, CH_FINAL)
      if (i > 0) then
         if (nint(survey%last(i)) == 1) line = line//', the last one between sample times'
      end if
      call add_fact(text, 'sampled', line)
      line = fact('cycles', names, values, '')
      i = place_of(history, CH_CYCLE)
      if (len(line) == 0 .and. i > 0) line = few(survey%last(i), 6)//' so far'
      call add_fact(text, 'cycles', line)
      if (survey%longest_step > 0.0_wp) call add_fact(text, 'steps', &
         few(survey%shortest_step, 6)//' to '//few(survey%longest_step, 6)//' '//unit)
      if (survey%n_bad > 0) call add_fact(text, 'damaged', &
         counted(survey%n_bad, 'value is', 'values are')//' not finite')
   end subroutine add_span

   !> A line for each channel: shape in file order, unit, largest norm and when it was
   subroutine add_channels(history, survey, text)
      type(history_t), intent(in) :: history
      type(survey_t), intent(in) :: survey
      character(len=:), allocatable, intent(inout) :: text

      type(variable_t) :: v
      character(len=:), allocatable :: name, shape_text
      integer :: i

      call add_line(text, '')
      call add_line(text, left('channel ', NAME_WIDTH)//left('shape ', SHAPE_WIDTH)// &
         left('unit ', UNIT_WIDTH)//right(' peak', NUMBER_WIDTH)//right(' at t', NUMBER_WIDTH))
      do i = 1, size(history%variable)
         v = history%variable(i)
         name = channel_path(v%channel)
         shape_text = str(survey%n_row)
         if (len_trim(groups(channels(v%channel)%owner)%path) > 0) &
            shape_text = shape_text//' x '//str(v%n_entity)
         if (v%n_comp > 1) shape_text = shape_text//' x '//str(v%n_comp)
         call add_line(text, left(name//' ', NAME_WIDTH)//left(shape_text//' ', SHAPE_WIDTH)// &
            left(unit_text(channels(v%channel)%dim, history%units)//' ', UNIT_WIDTH)// &
            right(' '//few(survey%peak(i), 6), NUMBER_WIDTH)// &
            right(' '//few(survey%peak_time(i), 6), NUMBER_WIDTH))
      end do
   end subroutine add_channels

   !> The energy balance: first and last values, largest sizes
   subroutine add_energies(history, survey, text)
      type(history_t), intent(in) :: history
      type(survey_t), intent(in) :: survey
      character(len=:), allocatable, intent(inout) :: text

      integer, parameter :: ROWS(*) = [CH_KE_TRANS, CH_KE_ROT, CH_IE, CH_WORK, CH_POTENTIAL, &
         CH_ENERGY_ERROR]
      integer :: i, v, at

      if (survey%n_row == 0) return
      call add_line(text, '')
      call add_line(text, left('energy balance ', NAME_WIDTH)//right(' first', NUMBER_WIDTH)// &
         right(' last', NUMBER_WIDTH)//right(' largest', NUMBER_WIDTH)// &
         right(' at t', NUMBER_WIDTH))
      do i = 1, size(ROWS)
         v = findloc(history%variable%channel, ROWS(i), 1)
         if (v == 0) cycle
         at = history%variable(v)%first
         call add_line(text, left(trim(channels(ROWS(i))%meaning)//' ', NAME_WIDTH)// &
            right(' '//few(survey%first(at), 6), NUMBER_WIDTH)// &
            right(' '//few(survey%last(at), 6), NUMBER_WIDTH)// &
            right(' '//few(survey%peak(v), 6), NUMBER_WIDTH)// &
            right(' '//few(survey%peak_time(v), 6), NUMBER_WIDTH))
      end do
   end subroutine add_energies

   !> Both texts with `link` between them, the first alone when the second is empty
   pure function joined(first, link, second) result(text)
      character(len=*), intent(in) :: first, link, second
      character(len=:), allocatable :: text

      text = first
      if (len(second) == 0) return
      if (len(first) > 0) text = text//link
      text = text//second
   end function joined

   !> Append a named fact; an empty one is left out
   subroutine add_fact(text, name, value)
      character(len=:), allocatable, intent(inout) :: text
      character(len=*), intent(in) :: name, value

      if (len(value) > 0) call add_line(text, '  '//left(name//' ', 10)//value)
   end subroutine add_fact

   !> Append a line
   subroutine add_line(text, line)
      character(len=:), allocatable, intent(inout) :: text
      character(len=*), intent(in) :: line

      text = text//trim(line)//new_line('a')
   end subroutine add_line

   !> A line each, in columns:
   !> "largest gap     3.91e-6 m  crank pin (902) at t = 0.0213, force 196 N"
   subroutine worst_lines(history, x, owner, lines)
      type(history_t), intent(in) :: history
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: owner               !! joint that holds the step; 0, -1: none, ever
      type(text_t), allocatable, intent(out) :: lines(:)

      character(len=*), parameter :: NAME(N_KIND) = [character(len=14) :: 'largest gap', &
         'blocked turn', 'peak force', 'peak moment', 'fastest turn', 'nearest stop', &
         'nearest stop']
      integer, parameter :: DIM(N_KIND) = [D_LENGTH, D_ANGLE, D_FORCE, D_MOMENT, &
         D_ANGULAR_VELOCITY, D_LENGTH, D_ANGLE]
      type(extreme_t) :: all(N_KIND)
      character(len=:), allocatable :: line
      integer :: i

      allocate (lines(0))
      all = [x%gap, x%gap_rot, x%force, x%moment, x%turn, x%margin, x%margin_rot]
      do i = 1, N_KIND
         if (all(i)%joint == 0) cycle
         if (i == 2 .and. all(i)%value < LITTLE) cycle
         line = NAME(i)//few(abs(all(i)%value), 3)//' '//unit_name(DIM(i), history%units)
         if (all(i)%value < 0.0_wp) line = line//' beyond'
         line = line//'  '//entity_title(history, OF_JOINT, all(i)%joint)//' at t = '// &
            few(all(i)%time, 3)
         if (i == 1 .and. all(i)%force > 0.0_wp) line = line//', force '// &
            few(all(i)%force, 3)//' '//unit_name(D_FORCE, history%units)
         call append_text(lines, line)
         if (i == 1) call add_advice(history, all(i), owner, lines)
      end do
   end subroutine worst_lines

   !> The stiffness that halves the gap: it goes with 1/Kn, the step of the joint with 1/sqrt(Kn)
   subroutine add_advice(history, gap, owner, lines)
      type(history_t), intent(in) :: history
      type(extreme_t), intent(in) :: gap
      integer, intent(in) :: owner
      type(text_t), allocatable, intent(inout) :: lines(:)

      character(len=:), allocatable :: cost
      real(wp) :: kn

      associate (joints => history%entity(OF_JOINT))
         if (.not. allocated(joints%blocking)) return
         kn = joints%blocking(1, gap%joint)
         if (.not. kn > 0.0_wp) return
         if (gap%value*kn < SOFT*gap%force) return
         cost = 'at most 41 % more cycles'
         if (joints%id(gap%joint) == owner) cost = '41 % more cycles'
         if (owner < 0) cost = 'no more cycles'
      end associate
      call append_text(lines, 'half of it    Kn '//few(2.0_wp*kn, 3)//' instead of '// &
         few(kn, 3)//' '//unit_name(D_STIFFNESS, history%units)//': '//cost)
   end subroutine add_advice

   !> An object with a member for each that there is: value, joint, label, time, force
   function worst_json(history, x) result(json)
      type(history_t), intent(in) :: history
      type(extremes_t), intent(in) :: x
      character(len=:), allocatable :: json

      json = '{'
      call add('gap', x%gap)
      call add('blocked_rotation', x%gap_rot)
      call add('force', x%force)
      call add('moment', x%moment)
      call add('angular_velocity', x%turn)
      call add('stop_gap', x%margin)
      call add('stop_gap_rotation', x%margin_rot)
      json = json//'}'

   contains

      subroutine add(name, e)
         character(len=*), intent(in) :: name
         type(extreme_t), intent(in) :: e

         if (e%joint == 0) return
         if (len(json) > 1) json = json//', '
         json = json//'"'//name//'": {"value": '//json_real(e%value)//', "joint": '// &
            str(history%entity(OF_JOINT)%id(e%joint))//', '//json_member('name', &
            entity_title(history, OF_JOINT, e%joint))//', "time": '//json_real(e%time)// &
            ', "force": '//json_real(e%force)//'}'
      end subroutine add
   end function worst_json

   !> Unit of a dimension as people say it: "kN", "N mm", "N/m"; as unit_text where it has no name
   pure function unit_name(dim, units) result(text)
      integer, intent(in) :: dim                       !! D_ constant
      type(unit_system_t), intent(in) :: units
      character(len=:), allocatable :: text

      character(len=:), allocatable :: force

      text = unit_text(dim, units)
      if (.not. all(units%si > 0.0_wp)) return         ! not known
      associate (m => units%si(1), l => units%si(2), t => units%si(3))
         force = prefixed(m*l/t**2, 'N')
      end associate
      if (dim == D_ANGULAR_VELOCITY) text = 'rad/'//trim(units%symbol(3))
      if (len(force) == 0) return
      if (dim == D_FORCE) text = force
      if (dim == D_MOMENT) text = force//' '//trim(units%symbol(2))
      if (dim == D_STIFFNESS) text = force//'/'//trim(units%symbol(2))
   end function unit_name

   !> A unit with the prefix of its SI value; empty where there is none
   pure function prefixed(si, name) result(text)
      real(wp), intent(in) :: si
      character, intent(in) :: name
      character(len=:), allocatable :: text

      character, parameter :: PREFIX(-2:3) = ['u', 'm', ' ', 'k', 'M', 'G']
      integer :: power

      text = ''
      if (.not. si > 0.0_wp) return
      power = nint(log10(si)/3.0_wp)
      if (power < -2 .or. power > 3) return
      if (abs(si/10.0_wp**(3*power) - 1.0_wp) > 1.0e-6_wp) return
      text = trim(adjustl(PREFIX(power)//name))
   end function prefixed

end module kj_info
