!> The names by which people ask a history for curves, the same wherever channels are named:
!>
!>    group/dataset[entity].component       joint/force[pin C].x, node/position[12].norm, mass
!>
!> An entity is its user id, its label, or both as in "pin C (903)"; without one: all. A component
!> is x y z, w x y z, tx to rz,
!> or `norm` of a vector; without one: all. * and ? stand for any text and any letter, but for the
!> stroke between group and dataset. Several names have blanks between them.
!> One file: the names are made and found by the same rules.
module kj_series
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_spelling, only: edit_distance
   use kj_units, only: unit_text
   use kj_joint_types, only: DOF_NAME
   use kj_channels, only: channels, groups, OF_RUN, CH_TIME
   use kj_history, only: history_t, entity_t, variable_t, entity_title
   implicit none
   private

   public :: series_t, find_series, series_value, series_unit, channel_path, &
      component_name

   integer, parameter, public :: NORM = 0        !! the length of the vector, as a component

   !> One number over time
   type :: series_t
      integer :: variable = 0                    !! place in history%variable
      integer :: entity = 1                      !! place among the entities of the variable
      integer :: comp = 1                        !! component, or NORM
      character(len=:), allocatable :: name      !! "joint/force[pin C].x"
   end type series_t

   !> A name taken apart
   type :: pattern_t
      character(len=:), allocatable :: path, entity, comp     !! not allocated: all
   end type pattern_t

   integer, parameter :: MOST_TOLD = 12          !! names in a hint
   integer, parameter :: MOST_LABELS = 1000      !! more entities than that go by their ids

contains

   !> The series that some names mean, in the order of the names, then of the history; all but the
   !> time when there is no name
   !>
   !> Errors: ERR_INPUT for a name that means nothing, with a hint.
   subroutine find_series(history, names, series, error)
      type(history_t), intent(in) :: history
      character(len=*), intent(in) :: names      !! blanks between them
      type(series_t), allocatable, intent(out) :: series(:)
      type(error_t), allocatable, intent(out) :: error

      type(pattern_t) :: pattern
      integer :: first, last, n

      n = 0
      allocate (series(16))
      last = 0
      if (len_trim(names) == 0) then
         pattern%path = '*'
         call add_matches(history, pattern, series, n)
         pattern%path = '*/*'
         call add_matches(history, pattern, series, n)
      end if
      do
         call next_name(names, first, last)
         if (first > last) exit
         call take_apart(names(first:last), pattern, error)
         if (allocated(error)) return
         associate (before => n + 0)
            call add_matches(history, pattern, series, n)
            if (n == before) call explain(history, names(first:last), pattern, error)
         end associate
         if (allocated(error)) return
      end do
      call resize(series, n)
   end subroutine find_series

   !> The next name behind `last`; blanks inside brackets belong to it
   pure subroutine next_name(names, first, last)
      character(len=*), intent(in) :: names
      integer, intent(out) :: first
      integer, intent(inout) :: last             !! below first: there is none

      integer :: depth

      first = last + 1
      do while (first <= len(names))
         if (names(first:first) /= ' ') exit
         first = first + 1
      end do
      depth = 0
      last = first - 1
      do while (last < len(names))
         if (names(last + 1:last + 1) == '[') depth = depth + 1
         if (names(last + 1:last + 1) == ']') depth = depth - 1
         if (names(last + 1:last + 1) == ' ' .and. depth <= 0) exit
         last = last + 1
      end do
   end subroutine next_name

   !> Errors: ERR_INPUT when a bracket is not closed
   subroutine take_apart(name, pattern, error)
      character(len=*), intent(in) :: name
      type(pattern_t), intent(out) :: pattern
      type(error_t), allocatable, intent(out) :: error

      integer :: left, right, dot

      left = index(name, '[')
      right = index(name, ']', back=.true.)
      dot = index(name, '.', back=.true.)
      if (left > 0 .and. right < left) then
         call fail(error, ERR_INPUT, 'a bracket of "'//name//'" is not closed')
         return
      end if
      if (dot > right) then
         pattern%comp = name(dot + 1:)
      else
         dot = len(name) + 1
      end if
      if (left > 0) then
         pattern%path = name(:left - 1)
         pattern%entity = name(left + 1:right - 1)
      else
         pattern%path = name(:dot - 1)
      end if
   end subroutine take_apart

   !> Append all series that a pattern means
   subroutine add_matches(history, pattern, series, n)
      type(history_t), intent(in) :: history
      type(pattern_t), intent(in) :: pattern
      type(series_t), allocatable, intent(inout) :: series(:)
      integer, intent(inout) :: n

      integer :: v, e, k

      do v = 1, size(history%variable)
         associate (variable => history%variable(v))
            if (variable%channel == CH_TIME) cycle
            if (.not. matches(channel_path(variable%channel), pattern%path)) cycle
            do e = 1, variable%n_entity
               if (.not. is_entity(history, variable, e, pattern)) cycle
               do k = NORM, variable%n_comp
                  if (.not. is_component(variable, k, pattern)) cycle
                  if (n == size(series)) call resize(series, 2*n)
                  n = n + 1
                  series(n)%variable = v
                  series(n)%entity = e
                  series(n)%comp = k
                  call take_name(history, variable, e, k, series(n)%name)
               end do
            end do
         end associate
      end do
   end subroutine add_matches

   subroutine resize(series, n)
      type(series_t), allocatable, intent(inout) :: series(:)
      integer, intent(in) :: n

      type(series_t), allocatable :: other(:)
      integer :: i

      allocate (other(n))
      do i = 1, min(n, size(series))
         other(i)%variable = series(i)%variable
         other(i)%entity = series(i)%entity
         other(i)%comp = series(i)%comp
         call move_alloc(series(i)%name, other(i)%name)
      end do
      call move_alloc(other, series)
   end subroutine resize

   pure logical function is_entity(history, variable, e, pattern) result(yes)
      type(history_t), intent(in) :: history
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: e
      type(pattern_t), intent(in) :: pattern

      integer :: owner

      yes = .not. allocated(pattern%entity)
      if (yes) return
      owner = channels(variable%channel)%owner
      if (owner == OF_RUN) return
      yes = matches(str(history%entity(owner)%id(e)), pattern%entity)
      if (yes) return
      yes = matches(label_of(history%entity(owner), e), pattern%entity) .or. &
         entity_title(history, owner, e) == pattern%entity
   end function is_entity

   pure logical function is_component(variable, k, pattern) result(yes)
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: k
      type(pattern_t), intent(in) :: pattern

      yes = k /= NORM
      if (.not. allocated(pattern%comp)) return
      if (k == NORM) then
         yes = variable%n_comp == 3 .and. pattern%comp == 'norm'
      else
         yes = variable%n_comp > 1 .and. matches(component_name(variable%n_comp, k), pattern%comp)
      end if
   end function is_component

   !> The text is of a pattern with * and ?; * does not stand for a stroke
   pure recursive logical function matches(text, pattern) result(yes)
      character(len=*), intent(in) :: text, pattern

      integer :: n

      if (len(pattern) == 0) then
         yes = len(text) == 0
      else if (pattern(1:1) == '*') then
         yes = .false.
         do n = 0, len(text)
            if (n > 0) then
               if (text(n:n) == '/') exit
            end if
            yes = matches(text(n + 1:), pattern(2:))
            if (yes) exit
         end do
      else
         yes = .false.
         if (len(text) == 0) return
         if (pattern(1:1) /= '?' .and. pattern(1:1) /= text(1:1)) return
         yes = matches(text(2:), pattern(2:))
      end if
   end function matches

   ! ---- names

   pure integer function path_length(channel) result(n)
      integer, intent(in) :: channel

      n = len_trim(channels(channel)%name)
      if (channels(channel)%owner /= OF_RUN) n = n + 1 + &
         len_trim(groups(channels(channel)%owner)%path)
   end function path_length

   !> "joint/force", "mass"
   pure function channel_path(channel) result(path)
      integer, intent(in) :: channel             !! row of kj_channels
      character(len=path_length(channel)) :: path

      path = channels(channel)%name
      if (channels(channel)%owner /= OF_RUN) path = trim(groups(channels(channel)%owner)%path)// &
         '/'//channels(channel)%name
   end function channel_path

   pure integer function component_length(n_comp, k) result(n)
      integer, intent(in) :: n_comp, k

      n = 0
      if (n_comp == 3 .or. n_comp == 4) n = 1
      if (n_comp == 6) n = 2
      if (k == NORM) n = 4
   end function component_length

   !> "x", "w", "rz", "norm"; empty for a single number
   pure function component_name(n_comp, k) result(name)
      integer, intent(in) :: n_comp, k
      character(len=component_length(n_comp, k)) :: name

      if (k == NORM) then
         name = 'norm'
      else if (n_comp == 6) then
         name = DOF_NAME(k)
      else if (n_comp == 3) then
         name = 'xyz' (k:k)
      else
         name = 'wxyz' (k:k)
      end if
   end function component_name

   !> Letters of the label of an entity, 0: it has none
   pure integer function label_length(entity, e) result(n)
      type(entity_t), intent(in) :: entity
      integer, intent(in) :: e

      n = 0
      if (.not. allocated(entity%label)) return
      if (allocated(entity%label(e)%s)) n = &
         len_trim(entity%label(e)%s)
   end function label_length

   pure function label_of(entity, e) result(label)
      type(entity_t), intent(in) :: entity
      integer, intent(in) :: e
      character(len=label_length(entity, e)) :: label

      label = ''
      if (len(label) > 0) label = entity%label(e)%s
   end function label_of

   !> Whether an entity goes by its label: no other has that
   pure logical function has_own_label(entity, e) result(own)
      type(entity_t), intent(in) :: entity
      integer, intent(in) :: e

      integer :: i

      own = .false.
      if (label_length(entity, e) == 0) return
      if (size(entity%id) > MOST_LABELS) return
      do i = 1, size(entity%id)
         if (i /= e .and. label_of(entity, i) == label_of(entity, e)) return
      end do
      own = .true.
   end function has_own_label

   pure integer function entity_length(entity, e) result(n)
      type(entity_t), intent(in) :: entity
      integer, intent(in) :: e

      n = len(str(entity%id(e)))
      if (has_own_label(entity, e)) n = label_length(entity, e)
   end function entity_length

   !> What a person calls an entity: its label where only one has that, else its user id
   pure function entity_name(history, owner, e) result(name)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner               !! OF_ constant, not of the run
      integer, intent(in) :: e                   !! place among its entities
      character(len=entity_length(history%entity(owner), e)) :: name

      if (has_own_label(history%entity(owner), e)) then
         name = label_of(history%entity(owner), e)
      else
         name = str(history%entity(owner)%id(e))
      end if
   end function entity_name

   pure subroutine take_name(history, variable, e, k, name)
      type(history_t), intent(in) :: history
      type(variable_t), intent(in) :: variable
      integer, intent(in) :: e, k
      character(len=:), allocatable, intent(out) :: name

      name = channel_path(variable%channel)
      if (channels(variable%channel)%owner /= OF_RUN) name = name//'['// &
         entity_name(history, channels(variable%channel)%owner, e)//']'
      if (variable%n_comp > 1) name = name//'.'//component_name(variable%n_comp, k)
   end subroutine take_name

   !> Say why a name means nothing, and what there is
   subroutine explain(history, name, pattern, error)
      type(history_t), intent(in) :: history
      character(len=*), intent(in) :: name
      type(pattern_t), intent(in) :: pattern
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: path, nearest, told
      integer :: v, e, d, least, found, k

      found = 0
      nearest = ''
      least = len(pattern%path)/3 + 2
      do v = 1, size(history%variable)
         if (history%variable(v)%channel == CH_TIME) cycle      ! it comes along with all
         path = channel_path(history%variable(v)%channel)
         if (found == 0 .and. matches(path, pattern%path)) found = v
         d = edit_distance(path, pattern%path)
         if (d >= least) cycle
         least = d
         nearest = path
      end do
      if (found == 0) then
         call fail(error, ERR_INPUT, 'there is no channel "'//pattern%path//'" in the history')
         error%hint = '`kjoint info` lists what a history holds'
         if (len(nearest) > 0) error%hint = 'did you mean "'//nearest//'"?'
         return
      end if
      associate (variable => history%variable(found), owner => &
         channels(history%variable(found)%channel)%owner)
         told = ''
         if (allocated(pattern%entity) .and. owner == OF_RUN) then
            call fail(error, ERR_INPUT, '"'//pattern%path//'" is of the whole run, not of "'// &
               pattern%entity//'"')
            return
         end if
         if (allocated(pattern%entity)) then
            if (.not. any([(is_entity(history, variable, e, pattern), e=1, &
               variable%n_entity)])) then
               do e = 1, min(variable%n_entity, MOST_TOLD)
                  told = told//', '//entity_name(history, owner, e)
               end do
               if (variable%n_entity > MOST_TOLD) told = told//', ...'
               call fail(error, ERR_INPUT, 'there is no '//trim(groups(owner)%entity)//' "'// &
                  pattern%entity//'" in the history')
               error%hint = 'there are: '//told(3:)
               return
            end if
         end if
         do k = 1, merge(variable%n_comp, 0, variable%n_comp > 1)
            told = told//', '//component_name(variable%n_comp, k)
         end do
         if (variable%n_comp == 3) told = told//', norm'
         call fail(error, ERR_INPUT, '"'//name//'" has no such component')
         error%hint = 'it is one number'
         if (len(told) > 2) error%hint = 'there are: '//told(3:)
      end associate
   end subroutine explain

   ! ---- values

   !> Value of a series in a row of its history
   pure real(wp) function series_value(history, series, row) result(y)
      type(history_t), intent(in) :: history
      type(series_t), intent(in) :: series
      real(wp), intent(in) :: row(:)             !! (history%n_value)

      integer :: at

      associate (v => history%variable(series%variable))
         at = v%first + (series%entity - 1)*v%n_comp
         if (series%comp == NORM) then
            y = sqrt(row(at)**2 + row(at + 1)**2 + row(at + 2)**2)
         else
            y = row(at + series%comp - 1)
         end if
      end associate
   end function series_value

   !> "kg m s-2"
   pure function series_unit(history, series) result(text)
      type(history_t), intent(in) :: history
      type(series_t), intent(in) :: series
      character(len=len(unit_text(channels(history%variable(series%variable)%channel)%dim, &
         history%units))) :: text

      text = unit_text(channels(history%variable(series%variable)%channel)%dim, history%units)
   end function series_unit

end module kj_series
