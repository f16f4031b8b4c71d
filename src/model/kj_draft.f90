!> What the builder knows of a deck before nodes are numbered: entities in deck order, and the
!> lookups from user ids to them.
module kj_draft
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, str, SEV_ERROR
   use kj_sort, only: lookup_t, new_lookup, find
   use kj_deck_data, only: deck_t
   use kj_cards, only: cards_t, int_of, report
   use kj_curve, only: curve_set_t
   use kj_model, only: skew_set_t
   implicit none
   private

   public :: draft_t, sensor_t, group_t, blocks_of, block_lookup, reference, group_nodes

   !> A set of nodes
   type :: group_t
      integer :: block = 0                       !! of the deck, 0 = not read yet
      integer, allocatable :: node(:)            !! raw node indices, ascending user id
   end type group_t

   !> A sensor of time
   type :: sensor_t
      real(wp) :: t_start = 0.0_wp, t_stop = huge(1.0_wp)
   end type sensor_t

   type :: draft_t
      ! nodes in deck order ("raw" indices)
      integer :: n_node = 0
      integer, allocatable :: id(:)
      real(wp), allocatable :: x(:, :)           !! (n_node, 3)
      real(wp), allocatable :: mass(:), inertia(:)
      type(lookup_t) :: node
      integer, allocatable :: body(:)            !! body that carries the node as secondary, 0 = none
      integer, allocatable :: main_of(:)         !! body whose main node it is, 0 = none
      integer, allocatable :: new(:)             !! raw index -> model index
      ! others
      type(lookup_t) :: group, skew, curve, sensor, part, property, joint_id, body_id
      type(group_t), allocatable :: groups(:)
      type(skew_set_t) :: skews                  !! nodes are raw indices
      type(lookup_t) :: frame
      type(skew_set_t) :: frames                 !! fixed frames: axes
      real(wp), allocatable :: frame_origin(:, :)   !! (0:n, 3)
      type(curve_set_t) :: curves
      type(sensor_t), allocatable :: sensors(:)
      integer, allocatable :: part_block(:), property_block(:), body_block(:)
   end type draft_t

contains

   !> Indices of the blocks of one keyword, in deck order
   pure function blocks_of(deck, keyword) result(list)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: keyword             !! KW_ constant
      integer, allocatable :: list(:)

      integer :: i

      list = pack([(i, i=1, deck%n_block)], deck%block(:deck%n_block)%keyword == keyword)
   end function blocks_of

   !> Lookup from the header ids of blocks to their place in the list
   pure subroutine block_lookup(deck, list, lookup)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: list(:)
      type(lookup_t), intent(out) :: lookup

      call new_lookup(deck%block(list)%id, lookup)
   end subroutine block_lookup

   !> Place of the entity that a field names; 0 when the field is 0 or names nothing (then reported)
   integer function reference(deck, cards, name, lookup, what, id, findings) result(place)
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name       !! of the field
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what       !! "skew", "function", ...
      character(len=*), intent(in) :: id         !! message id
      type(finding_list_t), intent(inout) :: findings

      place = 0
      if (int_of(cards, name) == 0) return
      place = find(lookup, int_of(cards, name))
      if (place > 0) return
      call report(deck, cards, name, SEV_ERROR, id, what//' '//str(int_of(cards, name))// &
         ' is not defined', 'no such '//what, findings, hint=known(lookup, what))
   end function reference

   !> "defined: 1 2 5 ..." for hints
   function known(lookup, what) result(text)
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what
      character(len=:), allocatable :: text

      integer :: i

      text = 'the deck defines no '//what
      if (size(lookup%id) == 0) return
      text = 'defined:'
      do i = 1, min(12, size(lookup%id))
         text = text//' '//str(lookup%id(i))
      end do
      if (size(lookup%id) > 12) text = text//' ...'
   end function known

   !> Raw indices of the nodes of the group that a field names. Field 0: none.
   subroutine group_nodes(draft, deck, cards, name, id, findings, nodes)
      type(draft_t), intent(in) :: draft
      type(deck_t), intent(in) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name, id   !! field and message id
      type(finding_list_t), intent(inout) :: findings
      integer, allocatable, intent(out) :: nodes(:)

      integer :: place

      allocate (nodes(0))
      place = reference(deck, cards, name, draft%group, 'node group', id, findings)
      if (place > 0) nodes = draft%groups(place)%node
   end subroutine group_nodes

end module kj_draft
