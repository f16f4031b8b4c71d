!> What a history holds apart from its rows: the entities, the variables and where each stands in
!> a row. The solver fills it for a run, the T01 and HDF5 readers for a file; sinks write it.
module kj_history
   use kj_kinds, only: wp
   use kj_units, only: unit_system_t
   use kj_error, only: str
   use kj_text, only: text_t
   use kj_channels, only: channels, OF_RUN, OF_JOINT, OF_SPRING
   use kj_model, only: model_t
   implicit none
   private

   public :: history_t, entity_t, shape_t, variable_t, n_entity, add_variable, place_of, &
      entity_title, describe_shape

   !> One dataset over time: n_entity series of n_comp numbers, component fastest
   type :: variable_t
      integer :: channel = 0    !! row of kj_channels
      integer :: n_entity = 1
      integer :: n_comp = 1
      integer :: first = 0      !! place in a row: first + (entity - 1) n_comp + comp - 1
   end type variable_t

   !> The entities of one kind, ascending user id, and what is constant of them; what a file does
   !> not tell, or this kind does not have, is not allocated
   type :: entity_t
      integer, allocatable :: id(:)
      type(text_t), allocatable :: label(:)
      ! joints and springs
      integer, allocatable :: type(:), property(:)
      integer, allocatable :: node(:, :), body(:, :)   !! (2, n) user ids of the ends, 0 = none
      integer, allocatable :: skew(:)                  !! id of the axes of a node's components
      !> (2, n) stiffness of the blocked translations and rotations; 0 = none, or not known before
      !> a run
      real(wp), allocatable :: blocking(:, :)
      ! rigid bodies
      integer, allocatable :: main_node(:)
      real(wp), allocatable :: mass(:)
      real(wp), allocatable :: inertia(:, :)           !! (3, n) principal
      real(wp), allocatable :: axes(:, :, :)           !! (3, 3, n) columns: axes at t=0
   end type entity_t

   !> Points of the rigid bodies, their centres among them, and segments that picture them
   type :: shape_t
      integer, allocatable :: body(:), node(:)         !! (n) user ids
      !> (3, n) from the centre of gravity, in axes that the body carries: those of W at t = 0
      real(wp), allocatable :: point(:, :)
      integer, allocatable :: segment(:, :)            !! (2, segments) indices of points
   end type shape_t

   !> What a history says once
   type :: history_t
      character(len=:), allocatable :: title
      type(unit_system_t) :: units
      logical :: legacy = .true.                     !! formulation, decides @sampled_at
      character(len=:), allocatable :: integrator    !! of the run; not allocated: not known
      logical :: single_precision = .false.          !! times and values came from 32-bit reals
      integer :: n_value = 0                         !! reals in a row
      integer :: n_expected = 0                      !! rows that will come, about; 0 = not known
      type(variable_t), allocatable :: variable(:)   !! time first
      type(entity_t) :: entity(OF_JOINT:OF_SPRING)   !! by OF_ constant
      type(shape_t) :: shape                         !! not allocated where a file has none
      ! deck files: name, full text, role ("starter", "engine", "include")
      type(text_t), allocatable :: input_name(:), input_text(:), input_role(:)
      type(text_t), allocatable :: input_path(:)     !! where they were read; no sink writes there
   end type history_t

contains

   !> Number of entities of an owner, 1 for the run itself
   pure integer function n_entity(history, owner) result(n)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner               !! OF_ constant

      n = merge(1, 0, owner == OF_RUN)
      if (owner == OF_RUN) return
      if (allocated(history%entity(owner)%id)) n = size(history%entity(owner)%id)
   end function n_entity

   !> Append a variable of one channel for n entities
   subroutine add_variable(history, channel, n)
      type(history_t), intent(inout) :: history
      integer, intent(in) :: channel, n

      type(variable_t) :: v

      if (.not. allocated(history%variable)) allocate (history%variable(0))
      v%channel = channel
      v%n_entity = n
      v%n_comp = channels(channel)%n_comp
      v%first = history%n_value + 1
      history%variable = [history%variable, v]
      history%n_value = history%n_value + v%n_entity*v%n_comp
   end subroutine add_variable

   !> Place in a row of a channel of the run; 0 when the history lacks it
   pure integer function place_of(history, channel) result(place)
      type(history_t), intent(in) :: history
      integer, intent(in) :: channel

      place = findloc(history%variable%channel, channel, 1)
      if (place > 0) place = history%variable(place)%first
   end function place_of

   pure integer function title_length(entity, e) result(n)
      type(entity_t), intent(in) :: entity
      integer, intent(in) :: e

      n = len(str(entity%id(e)))
      if (.not. allocated(entity%label)) return
      if (.not. allocated(entity%label(e)%s)) return
      associate (label => entity%label(e)%s)
         if (len_trim(label) > 0) n = n + len_trim(label) + 3
      end associate
   end function title_length

   !> An entity as people know it: "pin C (903)"; its user id where it has no label
   pure function entity_title(history, owner, e) result(title)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner               !! OF_ constant, not of the run
      integer, intent(in) :: e                   !! place among its entities
      character(len=title_length(history%entity(owner), e)) :: title

      title = str(history%entity(owner)%id(e))
      if (len(title) > len_trim(title)) title = trim(history%entity(owner)%label(e)%s)//' ('// &
         str(history%entity(owner)%id(e))//')'
   end function entity_title

   !> Centres and nodes of the bodies of the history; a segment from the centre to each node that a
   !> joint or spring holds
   pure subroutine describe_shape(model, shape)
      type(model_t), intent(in) :: model
      type(shape_t), intent(out) :: shape

      logical :: shown(model%n_node), held(model%n_node)
      integer :: place(model%n_node), owner, i, n

      shown = .false.
      shown(model%th_body) = .true.
      shown = shown(model%lead)                  ! a body is the lead of its nodes, and of itself
      held = .false.
      do i = 1, model%n_element
         held(model%joint(i)%node) = .true.
      end do
      n = 0
      do i = 1, model%n_node
         if (.not. shown(i)) cycle
         n = n + 1
         place(i) = n
      end do
      allocate (shape%body(n), shape%node(n), shape%point(3, n))
      allocate (shape%segment(2, count(shown(model%n_lead + 1:) .and. held(model%n_lead + 1:))))
      n = 0
      do i = 1, model%n_node
         if (.not. shown(i)) cycle
         owner = model%lead(i)
         shape%body(place(i)) = model%body_id(owner)
         shape%node(place(i)) = model%node_id(i)
         shape%point(:, place(i)) = model%x0(i, :) - model%x0(owner, :)
         if (i == owner .or. .not. held(i)) cycle
         n = n + 1
         shape%segment(:, n) = [place(owner), place(i)]
      end do
   end subroutine describe_shape

end module kj_history
