!> What a history holds apart from its rows: the entities, the variables and where each stands in
!> a row. The solver fills it for a run, the T01 and HDF5 readers for a file; sinks write it.
module kj_history
   use kj_kinds, only: wp
   use kj_units, only: unit_system_t
   use kj_channels, only: channels
   implicit none
   private

   public :: history_t, variable_t, text_t, add_variable

   !> A text of any length
   type :: text_t
      character(len=:), allocatable :: s
   end type text_t

   !> One dataset over time: n_entity series of n_comp numbers, component fastest
   type :: variable_t
      integer :: channel = 0    !! row of kj_channels
      integer :: n_entity = 1
      integer :: n_comp = 1
      integer :: first = 0      !! place in a row: first + (entity - 1) n_comp + comp - 1
   end type variable_t

   !> What a history says once
   type :: history_t
      character(len=:), allocatable :: title
      type(unit_system_t) :: units
      logical :: legacy = .true.                     !! formulation, decides @sampled_at
      logical :: single_precision = .false.          !! times and values came from 32-bit reals
      integer :: n_value = 0                         !! reals in a row
      integer :: n_expected = 0                      !! rows that will come, about; 0 = not known
      type(variable_t), allocatable :: variable(:)   !! time first
      ! joints, ascending user id
      integer, allocatable :: joint_id(:), joint_type(:), joint_property(:)
      integer, allocatable :: joint_node(:, :), joint_body(:, :)        !! (2, n) user ids, 0 = none
      type(text_t), allocatable :: joint_label(:)
      ! rigid bodies, ascending user id
      integer, allocatable :: body_id(:), body_main_node(:)
      real(wp), allocatable :: body_mass(:), body_inertia(:, :)         !! (n), (3, n) principal
      !> (3, 3, n) columns: axes at t=0
      real(wp), allocatable :: body_axes(:, :, :)
      type(text_t), allocatable :: body_label(:)
      ! nodes, ascending user id
      integer, allocatable :: node_id(:)
      type(text_t), allocatable :: node_label(:)
      ! springs, ascending user id
      integer, allocatable :: spring_id(:), spring_type(:), spring_property(:)
      integer, allocatable :: spring_node(:, :), spring_body(:, :)      !! (2, n) user ids, 0 = none
      type(text_t), allocatable :: spring_label(:)
      ! deck files: name, full text, role ("starter", "engine", "include")
      type(text_t), allocatable :: input_name(:), input_text(:), input_role(:)
   end type history_t

contains

   !> Append a variable of one channel for n_entity entities
   subroutine add_variable(history, channel, n_entity)
      type(history_t), intent(inout) :: history
      integer, intent(in) :: channel, n_entity

      type(variable_t) :: v
      type(variable_t), allocatable :: longer(:)
      integer :: n

      if (.not. allocated(history%variable)) allocate (history%variable(0))
      v%channel = channel
      v%n_entity = n_entity
      v%n_comp = channels(channel)%n_comp
      v%first = history%n_value + 1
      n = size(history%variable)
      allocate (longer(n + 1))
      longer(:n) = history%variable
      longer(n + 1) = v
      call move_alloc(longer, history%variable)
      history%n_value = history%n_value + v%n_entity*v%n_comp
   end subroutine add_variable

end module kj_history
