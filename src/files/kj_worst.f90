!> What gave way most, in words and as JSON: the end of `kjoint run` and of `kjoint info`.
module kj_worst
   use kj_kinds, only: wp
   use kj_error, only: str
   use kj_text, only: text_t, append_text
   use kj_words, only: few
   use kj_json_writer, only: json_member, json_real
   use kj_units, only: unit_system_t, unit_text, D_LENGTH, D_FORCE, D_MOMENT, D_ANGLE, &
      D_ANGULAR_VELOCITY, D_ENERGY, D_STIFFNESS
   use kj_channels, only: OF_JOINT
   use kj_history, only: history_t, entity_title
   use kj_extremes, only: extreme_t, extremes_t
   implicit none
   private

   public :: worst_lines, worst_json

   integer, parameter :: N_KIND = 7
   real(wp), parameter :: LITTLE = 1.0e-3_wp     !! blocked turns below are not worth a line
   real(wp), parameter :: SOFT = 0.1_wp          !! Kn gap over force: below, Kn did not act

contains

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

   !> Unit of a dimension as people say it: "kN", "N mm", "J", "N/m"; as unit_text where it has no
   !> name
   pure function unit_name(dim, units) result(text)
      integer, intent(in) :: dim                       !! D_ constant
      type(unit_system_t), intent(in) :: units
      character(len=:), allocatable :: text

      character(len=:), allocatable :: force, energy

      text = unit_text(dim, units)
      if (.not. all(units%si > 0.0_wp)) return         ! not known
      associate (m => units%si(1), l => units%si(2), t => units%si(3))
         force = prefixed(m*l/t**2, 'N')
         energy = prefixed(m*l**2/t**2, 'J')
      end associate
      if (dim == D_ANGULAR_VELOCITY) text = 'rad/'//trim(units%symbol(3))
      if (dim == D_ENERGY .and. len(energy) > 0) text = energy
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

end module kj_worst
