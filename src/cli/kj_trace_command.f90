!> `kjoint run --trace`: its options, and what a person or a program reads of a traced cycle.
module kj_trace_command
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_number, only: parse_integer, NUMBER_FINE
   use kj_joint_types, only: DOF_NAME, NDOF
   use kj_words, only: json_member, json_pair, json_real, json_list, comma
   use kj_option, only: arguments_t, OPT_TRACE, OPT_TRACE_CYCLES, OPT_JSON
   use kj_keeper, only: keeper_t
   use kj_progress, only: end_progress
   use kj_terminal, only: print_line, print_error
   use kjoint, only: simulation_t, trace_simulation, trace_t, traced_lead_t, TRACE_NAME, &
      TRACE_JOINT, TRACE_SPRING, TRACE_BODY, TRACE_NODE
   implicit none
   private

   public :: tracer_t, start_trace, end_trace

   integer, parameter :: FIRST = 0, LAST = 9       !! cycles where none are asked for

   !> What a dof does, by DOF_ constant
   character(len=8), parameter :: DOES(0:5) = ['free    ', 'slides  ', 'sticks  ', 'at stop ', &
      'locked  ', 'blocked ']

   !> Monitor that prints traced cycles on stdout, too
   type, extends(keeper_t) :: tracer_t
      logical :: json = .false.                    !! a line of JSON each, else tables
      logical :: wanted = .false.
      logical :: seen = .false.
   contains
      procedure :: see
   end type tracer_t

contains

   !> Begin a trace where the command line asks for one.
   !>
   !> Errors: ERR_INPUT when its values are no ids or cycles, or as trace_simulation
   subroutine start_trace(args, sim, tracer, error)
      type(arguments_t), intent(in) :: args
      type(simulation_t), intent(inout) :: sim
      type(tracer_t), intent(inout) :: tracer
      type(error_t), allocatable, intent(out) :: error

      integer, allocatable :: ids(:), cycles(:)

      tracer%json = args%given(OPT_JSON)
      tracer%wanted = args%given(OPT_TRACE)
      if (.not. tracer%wanted) then
         if (args%given(OPT_TRACE_CYCLES)) call fail(error, ERR_INPUT, &
            '--trace-cycles says when, --trace ID must say what')
         return
      end if
      cycles = [FIRST, LAST]
      if (.not. all_integers(args%value(OPT_TRACE)%s, ',', ids)) then
         call fail(error, ERR_INPUT, '--trace needs user ids with commas between them, not "'// &
            args%value(OPT_TRACE)%s//'"')
      else if (args%given(OPT_TRACE_CYCLES)) then
         if (.not. all_integers(args%value(OPT_TRACE_CYCLES)%s, ':', cycles)) cycles = [integer ::]
         if (size(cycles) /= 2) call fail(error, ERR_INPUT, &
            '--trace-cycles needs two whole numbers A:B, not "'// &
            args%value(OPT_TRACE_CYCLES)%s//'"')
      end if
      if (.not. allocated(error)) call trace_simulation(sim, ids, cycles(1), cycles(2), error)
   end subroutine start_trace

   !> Say that nothing came where the run was too short
   subroutine end_trace(tracer)
      type(tracer_t), intent(in) :: tracer

      if (tracer%wanted .and. .not. tracer%seen) call print_error( &
         'warning: nothing was traced: the run ended before the first cycle of --trace-cycles')
   end subroutine end_trace

   !> Whole numbers with a mark between them; false when one is none
   logical function all_integers(text, mark, numbers) result(fine)
      character(len=*), intent(in) :: text
      character, intent(in) :: mark
      integer, allocatable, intent(out) :: numbers(:)

      integer :: from, to, number, status

      allocate (numbers(0))
      from = 1
      fine = .true.
      do while (fine .and. from <= len(text) + 1)
         to = from - 1 + index(text(from:)//mark, mark)
         call parse_integer(text(from:to - 1), number, status)
         fine = status == NUMBER_FINE .and. to > from
         numbers = [numbers, number]
         from = to + 1
      end do
   end function all_integers

   !> Print a traced cycle
   subroutine see(self, trace)
      class(tracer_t), intent(inout) :: self
      type(trace_t), intent(in) :: trace(:)

      integer :: i

      call end_progress(self%progress_t)
      self%seen = .true.
      do i = 1, size(trace)
         if (self%json) then
            call print_line(json_of(trace(i)))
         else
            call print_table(trace(i))
         end if
      end do
   end subroutine see

   ! ---- tables

   subroutine print_table(t)
      type(trace_t), intent(in) :: t

      character(len=80) :: line

      write (line, '(a,i0,a,es14.7,a,es12.5)') trim(TRACE_NAME(t%kind))//' '//str(t%id)// &
         '   cycle ', t%cycle, '   time ', t%time, '   step ', t%step
      call print_line(trim(line))
      if (t%lag > 0.0_wp) then
         write (line, '(a,es14.7)') '   velocities and rates are those of time ', t%time - t%lag
         call print_line(trim(line))
      end if
      select case (t%kind)
      case (TRACE_JOINT, TRACE_SPRING)
         call print_ends(t)
         call print_dofs(t)
      case (TRACE_BODY)
         call print_lead(t%lead(1))
         call row('force', t%lead(1)%force)
         call row('moment about it', t%lead(1)%moment)
         write (line, '(a,2es14.6)') '   mass, kinetic energy', t%lead(1)%mass, t%lead(1)%energy
         call print_line(trim(line))
         call print_ids('   joints and springs on it:', t%lead(1)%joints)
      case (TRACE_NODE)
         call row('position', t%position)
         call row('velocity', t%velocity)
         call row('acceleration', t%acceleration)
         call print_line('   it rides on '//name_of(t%lead(1)))
         call print_lead(t%lead(1))
      end select
      call print_line('')
   end subroutine print_table

   !> Leads of both ends, and what a joint does to them
   subroutine print_ends(t)
      type(trace_t), intent(in) :: t

      integer :: e

      do e = 1, 2
         call print_line('   end '//str(e)//': node '//str(t%node(e))//' on '//name_of(t%lead(e)))
         call print_lead(t%lead(e))
         call row('force of the joint', merge(t%inside%force, -t%inside%force, e == 1))
         call row('moment about it', t%inside%moment(:, e))
      end do
      do e = 1, 3
         call row('joint axis '//str(e), t%frame(3*e - 2:3*e))
      end do
   end subroutine print_ends

   !> Coordinates, rates and laws, a line each dof, and the step
   subroutine print_dofs(t)
      type(trace_t), intent(in) :: t

      character(len=80) :: line
      integer :: k

      call print_line('             q       rate    elastic    damping   friction      force')
      do k = 1, NDOF
         write (line, '(a,6es11.3)') '  '//DOF_NAME(k), t%q(k), t%rate(k), t%inside%elastic(k), &
            t%inside%damping(k), t%inside%friction(k), t%force(k)
         if (.not. t%inside%told_apart) line(27:48) = '          -          -'
         if (allocated(t%flag)) line(72:) = DOES(t%flag(k))
         call print_line(trim(line))
      end do
      line = '   nothing here limits the step'
      if (t%inside%bound < huge(1.0_wp)) write (line, '(a,es12.5,a)') '   it allows a step of ', &
         t%inside%bound, ', '//rule_of(t)
      call print_line(trim(line))
      write (line, '(a,es13.5)') '   work done on it ', t%work
      call print_line(trim(line))
   end subroutine print_dofs

   pure function rule_of(t) result(text)
      type(trace_t), intent(in) :: t
      character(len=:), allocatable :: text

      text = 'by the safe bound'
      if (t%inside%nodal) text = 'by the nodal rule of its ends'
   end function rule_of

   !> Where a body or free node is and how it moves
   subroutine print_lead(lead)
      type(traced_lead_t), intent(in) :: lead

      call row('position', lead%position)
      if (lead%is_body) call row('attitude', lead%attitude)
      call row('velocity', lead%velocity)
      call row('angular velocity', lead%omega)
      call row('acceleration', lead%acceleration)
      call row('angular accel.', lead%omega_dot)
   end subroutine print_lead

   !> A name and its numbers
   subroutine row(name, values)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:)

      character(len=80) :: line

      line = '      '//name
      write (line(25:), '(4es13.5)') values
      call print_line(trim(line))
   end subroutine row

   pure function name_of(lead) result(text)
      type(traced_lead_t), intent(in) :: lead
      character(len=:), allocatable :: text

      text = trim(merge('body     ', 'free node', lead%is_body))//' '//str(lead%id)
   end function name_of

   !> Ids in lines of at most 80 columns
   subroutine print_ids(name, ids)
      character(len=*), intent(in) :: name
      integer, intent(in) :: ids(:)

      character(len=:), allocatable :: line
      integer :: i

      line = name
      if (size(ids) == 0) line = line//' none'
      do i = 1, size(ids)
         if (len(line) + 1 + len(str(ids(i))) > 80) then
            call print_line(line)
            line = '     '
         end if
         line = line//' '//str(ids(i))
      end do
      call print_line(line)
   end subroutine print_ids

   ! ---- JSON

   function json_of(t) result(json)
      type(trace_t), intent(in) :: t
      character(len=:), allocatable :: json

      json = '{'//json_member('trace', trim(TRACE_NAME(t%kind)))//', '//json_member('id', t%id)// &
         ', '//json_member('cycle', t%cycle)//', '//json_member('time', t%time)// &
         ', '//json_member('velocity_time', t%time - t%lag)//', '//json_member('step', t%step)
      select case (t%kind)
      case (TRACE_JOINT, TRACE_SPRING)
         json = json//', '//json_joint(t)
      case (TRACE_BODY)
         json = json//', '//json_lead(t%lead(1))//', '//vector('force', t%lead(1)%force)//', '// &
            vector('moment', t%lead(1)%moment)//', '//json_member('mass', t%lead(1)%mass)// &
            ', '//json_member('kinetic_energy', t%lead(1)%energy)//', '// &
            json_pair('joints', json_list(t%lead(1)%joints))
      case (TRACE_NODE)
         json = json//', '//vector('position', t%position)//', '// &
            vector('velocity', t%velocity)//', '//vector('acceleration', t%acceleration)//', '// &
            json_pair('lead', '{'//json_name(t%lead(1))//', '//json_lead(t%lead(1))//'}')
      end select
      json = json//'}'
   end function json_of

   function json_joint(t) result(json)
      type(trace_t), intent(in) :: t
      character(len=:), allocatable :: json

      integer :: e

      json = '"ends": ['
      do e = 1, 2
         json = json//'{'//json_member('node', t%node(e))//', '//json_name(t%lead(e))//', '// &
            json_lead(t%lead(e))//', '// &
            vector('force', merge(t%inside%force, -t%inside%force, e == 1))//', '// &
            vector('moment', t%inside%moment(:, e))//'}'//comma(e, 2)
      end do
      json = json//'], '//vector('frame', t%frame)//', '//vector('q', t%q)//', '// &
         vector('rate', t%rate)//', '//law('elastic', t%inside%elastic, t%inside%told_apart)// &
         ', '//law('damping', t%inside%damping, t%inside%told_apart)//', '// &
         vector('friction', t%inside%friction)//', '//vector('force', t%force)//', '// &
         json_member('work', t%work)//', '// &
         json_member('bound_rule', trim(merge('nodal', 'safe ', t%inside%nodal)))
      json = json//', '//json_pair('bound', merge_text(t%inside%bound < huge(1.0_wp), &
         json_real(t%inside%bound)))
      if (.not. allocated(t%flag)) return
      json = json//', '//json_pair('does', json_list(DOES(t%flag)))
   end function json_joint

   function json_lead(lead) result(json)
      type(traced_lead_t), intent(in) :: lead
      character(len=:), allocatable :: json

      json = vector('position', lead%position)//', '// &
         law('attitude', lead%attitude, lead%is_body)//', '// &
         vector('velocity', lead%velocity)//', '//vector('omega', lead%omega)//', '// &
         vector('acceleration', lead%acceleration)//', '//vector('omega_dot', lead%omega_dot)
   end function json_lead

   function json_name(lead) result(json)
      type(traced_lead_t), intent(in) :: lead
      character(len=:), allocatable :: json

      json = json_member('carrier', trim(merge('body', 'node', lead%is_body)))//', '// &
         json_member('carrier_id', lead%id)
   end function json_name

   function vector(name, values) result(json)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      character(len=:), allocatable :: json

      json = json_pair(name, json_list(values))
   end function vector

   !> Numbers that are there, or null
   function law(name, values, known) result(json)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      logical, intent(in) :: known
      character(len=:), allocatable :: json

      json = json_pair(name, merge_text(known, json_list(values)))
   end function law

   pure function merge_text(known, text) result(json)
      logical, intent(in) :: known
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: json

      json = 'null'
      if (known) json = text
   end function merge_text

end module kj_trace_command
