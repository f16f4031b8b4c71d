!> What the builder knows of a deck before nodes are numbered: entities in deck order, and the
!> lookups from user ids to them; properties and joints on their way from cards into batches.
module kj_draft
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR
   use kj_sort, only: lookup_t, new_lookup, find, lower_bound
   use kj_keywords, only: keywords, OUT_OF_SCOPE
   use kj_deck_text, only: deck_t, line_text, place_of, report_header
   use kj_element_cards, only: element_row
   use kj_cards, only: cards_t, card_row_t, int_of, report
   use kj_curve, only: curve_set_t
   use kj_parameter, only: setting_t
   use kj_model, only: skew_set_t
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: KJOINT
   use kj_spring_law, only: spring_t
   implicit none
   private

   public :: draft_t, move_t, moved_point, box_set_t, property_t, joint_t, blocks_of, blocks_with, &
      index_blocks, find_blocks, reference, node_of, unsupported, group_nodes, &
      report_double_blocks, known_ids

   !> A block of elements
   type :: shelf_t
      integer :: block = 0                       !! of the deck
      integer :: row = 0                         !! of element_cards
      integer :: part = 0                        !! place of the part, 0 = not defined
      integer :: least = 1, most = 0             !! ids of its elements; most < least: not known yet
   end type shelf_t

   integer, parameter, public :: WAITING = 0, UNDER_WAY = 1, DONE = 2

   !> A set of nodes
   type :: group_t
      integer :: block = 0                       !! of the deck
      integer, allocatable :: node(:)            !! raw node indices, ascending user id
      integer :: state = WAITING                 !! its nodes are to be found, or are
      logical :: spoilt = .false.                !! something was wrong with it, or with one in it
   end type group_t

   !> All boxes of a deck, by which groups choose nodes and elements
   type :: box_set_t
      type(lookup_t) :: id
      integer, allocatable :: keyword(:)         !! (n) KW_ constant: its form
      integer, allocatable :: skew(:)            !! (n) skew index, 0 = global
      !> (3, n) RECTA: corners, components in the skew; SPHER: centre; CYLIN: ends of the axis; W
      real(wp), allocatable :: lo(:, :), hi(:, :)
      real(wp), allocatable :: radius(:)         !! (n) of round ones
   end type box_set_t

   !> A sensor of time
   type :: sensor_t
      real(wp) :: t_start = 0.0_wp, t_stop = huge(1.0_wp)
   end type sensor_t

   !> The elements of all /SPRING blocks, in deck order
   type :: elements_t
      integer :: n = 0
      type(card_row_t), allocatable :: card(:)   !! (n)
      integer, allocatable :: part(:)            !! (n) place of the part, 0 = not defined
      integer, allocatable :: node(:, :)         !! (2, n) raw node indices, 0 = not defined
      type(lookup_t) :: id                       !! of the elements
      type(lookup_t) :: of_part                  !! elements by the place of their part
   end type elements_t

   !> A /PROP/KJOINT or /PROP/KJOINT2, checked; in work units
   type :: property_t
      integer :: id = 0
      integer :: kind = KJOINT                  !! KJOINT, KJOINT2 or a SPRING
      integer :: row = 0                        !! row of kj_joint_types, 0 = not usable
      integer :: frame = 0                      !! FRAME_ constant
      integer :: skew(2) = 0                    !! skew indices
      real(wp) :: kn = 0.0_wp, cr = 0.0_wp
      real(wp) :: cr_stop = 0.0_wp              !! Cr as typed: its default is not for stops
      real(wp) :: k(NDOF) = 0.0_wp, c(NDOF) = 0.0_wp      !! of the free dofs
      integer :: k_curve(NDOF) = 0, c_curve(NDOF) = 0
      ! KJOINT2 only
      real(wp) :: scf = 1.0_wp                  !! scale of the blocked rotations
      logical :: automatic = .false.            !! Kn comes from the first step
      real(wp) :: lo(NDOF) = 0.0_wp, hi(NDOF) = 0.0_wp    !! stops, 0 = none
      integer :: combined(NDOF) = 0             !! 1 where the stop is shared with other dofs
      real(wp) :: k_limit(NDOF) = 0.0_wp        !! stiffness of friction and stop
      real(wp) :: slip(NDOF) = 0.0_wp           !! limit of friction, or scale of its curve
      integer :: slip_curve(NDOF) = 0
      real(wp) :: t_lock = huge(1.0_wp), t_free = huge(1.0_wp)
      logical :: limited = .false.              !! has stops, friction, a lock or automatic
                                                !! stiffness
      ! springs only
      type(spring_t), allocatable :: spring
   end type property_t

   !> A spring element on its way into a batch
   type :: joint_t
      type(card_row_t) :: card                  !! of /SPRING
      integer :: property = 0                   !! place in the list of properties
      integer :: node(2) = 0                    !! model indices
      integer :: skew(2) = 0
      real(wp) :: frame(3, 3) = 0.0_wp          !! at the start, columns, W
      real(wp) :: angle(3) = 0.0_wp             !! rotation at the start, J [rad]
      real(wp) :: xl0(3) = 0.0_wp, reduced(2) = 0.0_wp
      real(wp) :: k(NDOF) = 0.0_wp, c(NDOF) = 0.0_wp
      real(wp) :: k_block(2) = 0.0_wp           !! of the blocked translations and rotations
      integer :: law(NDOF) = 0
      ! springs only
      integer :: rule = 0                       !! FRAME_ constant, 0 = that of the property
      !> largest stiffness of translations and rotations, largest damping of both
      real(wp) :: top(4) = 0.0_wp
   end type joint_t

   !> A move of a submodel: x' = a x + b
   type :: move_t
      integer :: submodel = 0                    !! its id
      real(wp) :: a(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, &
         0.0_wp, 1.0_wp], [3, 3])
      real(wp) :: b(3) = 0.0_wp                  !! W, length
   end type move_t

   !> A deck and everything in it, in its order; node indices are "raw": places in the deck
   type :: draft_t
      type(deck_t) :: deck                       !! as it was read; takes the findings
      logical :: legacy = .false.                !! unit factors as OpenRadioss has them
      integer :: n_node = 0
      integer, allocatable :: id(:)
      real(wp), allocatable :: x(:, :)           !! (n_node, 3)
      real(wp), allocatable :: mass(:), inertia(:)
      type(lookup_t) :: node
      !> body that carries the node as secondary, 0 = none
      integer, allocatable :: body(:)
      integer, allocatable :: main_of(:)         !! body whose main node it is, 0 = none
      integer, allocatable :: new(:)             !! raw index -> model index
      ! others
      type(lookup_t) :: group, skew, curve, sensor, part, property, body_id
      type(lookup_t) :: block                    !! blocks by their ids, of all keywords
      type(shelf_t), allocatable :: shelf(:)     !! blocks of elements, in deck order
      type(lookup_t) :: shelf_of_part            !! shelves by the places of their parts
      type(group_t), allocatable :: groups(:)
      type(box_set_t) :: boxes
      type(skew_set_t) :: skews                  !! nodes are raw indices
      type(lookup_t) :: frame
      type(skew_set_t) :: frames                 !! axes at the start
      real(wp), allocatable :: frame_origin(:, :)   !! (0:n, 3) at the start
      type(curve_set_t) :: curves
      type(sensor_t), allocatable :: sensors(:)
      type(elements_t) :: elements
      integer, allocatable :: part_block(:), body_block(:)
      !> /RBODY blocks whose main node was made, the last nodes
      integer, allocatable :: made_main(:)
      type(property_t), allocatable :: properties(:)
      integer, allocatable :: property_block(:)  !! KJOINT, KJOINT2, then springs of types 4 and 8
      integer, allocatable :: part_property(:)   !! place in property_block, 0 = none
      integer, allocatable :: part_ids(:, :)     !! (3, parts) ids of property, material, subset
      !> "joint.field", value from outside; not allocated: none
      type(setting_t), allocatable :: joint_setting(:)
      logical, allocatable :: joint_set(:)       !! the joint of the setting is there
      type(move_t), allocatable :: moves(:)      !! of submodels
      integer, allocatable :: node_submodel(:)   !! where the deck has submodels: that of each node
   end type draft_t

   !> How a header begins that could define what a field names
   type :: family_t
      character(len=12) :: what
      character(len=8) :: head
   end type family_t

   type(family_t), parameter :: families(*) = [ &
      family_t('node group', '/GRNOD'), family_t('node group', '/SET'), &
      family_t('skew', '/SKEW'), family_t('frame', '/FRAME'), family_t('function', '/FUNCT'), &
      family_t('sensor', '/SENSOR'), family_t('property', '/PROP'), family_t('box', '/BOX'), &
      family_t('material', '/MAT')]

contains

   !> Indices of the blocks of one keyword, in deck order
   pure function blocks_of(deck, keyword) result(list)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: keyword             !! KW_ constant
      integer, allocatable :: list(:)

      integer :: i

      list = pack([(i, i=1, deck%n_block)], deck%block(:deck%n_block)%keyword == keyword)
   end function blocks_of

   !> Indices of the blocks of one keyword with one id, in deck order
   subroutine blocks_with(draft, keyword, id, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: keyword             !! KW_ constant
      integer, intent(in) :: id
      integer, allocatable, intent(out) :: list(:)

      call index_blocks(draft)
      associate (b => draft%block)
         list = b%place(lower_bound(b%id, id):lower_bound(b%id, id + 1) - 1)
      end associate
      list = pack(list, draft%deck%block(list)%keyword == keyword)
   end subroutine blocks_with

   !> Make the lookups of blocks by ids and of elements by parts, once the parts are known
   subroutine index_blocks(draft)
      type(draft_t), intent(inout) :: draft

      integer :: i, n, row

      if (allocated(draft%shelf)) return
      associate (b => draft%deck%block(:draft%deck%n_block))
         call new_lookup(b%id, draft%block)
         allocate (draft%shelf(size(b)))
         n = 0
         do i = 1, size(b)
            row = element_row(b(i)%keyword)
            if (row == 0) cycle
            n = n + 1
            draft%shelf(n) = shelf_t(i, row, find(draft%part, b(i)%id))
         end do
      end associate
      draft%shelf = draft%shelf(:n)
      call new_lookup(draft%shelf%part, draft%shelf_of_part)
   end subroutine index_blocks

   !> Blocks of a family, keyword by keyword, and the lookup from their ids to their places; an id
   !> that stands twice is reported
   subroutine find_blocks(deck, keyword, what, list, lookup)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: keyword(:)          !! KW_ constants
      character(len=*), intent(in) :: what       !! the family: "skew"
      integer, allocatable, intent(out) :: list(:)
      type(lookup_t), intent(out) :: lookup

      integer :: k

      allocate (list(0))
      do k = 1, size(keyword)
         list = [list, blocks_of(deck, keyword(k))]
      end do
      call new_lookup(deck%block(list)%id, lookup)
      call report_double_blocks(deck, list, what)
   end subroutine find_blocks

   !> Two blocks of one family with the same id: every one but the first is reported
   subroutine report_double_blocks(deck, blocks, what)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: blocks(:)
      character(len=*), intent(in) :: what

      type(lookup_t) :: lookup
      character(len=:), allocatable :: file
      integer :: i, number

      call new_lookup(deck%block(blocks)%id, lookup)
      do i = 2, size(blocks)
         if (lookup%id(i) /= lookup%id(i - 1)) cycle
         call place_of(deck, deck%block(blocks(lookup%place(i - 1)))%header, file, number)
         call report_header(deck, blocks(lookup%place(i)), SEV_ERROR, 'KJ-0079', what// &
            ' '//str(lookup%id(i))//' is defined twice', 'used before', hint='before: '//file// &
            ':'//str(number))
      end do
   end subroutine report_double_blocks

   !> Place of the entity that a field names; 0 when the field is 0 or names nothing (then reported)
   integer function reference(deck, cards, name, lookup, what, id) result(place)
      type(deck_t), intent(inout) :: deck
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name       !! of the field
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what       !! "skew", "function", ...
      character(len=*), intent(in) :: id         !! message id

      integer :: block

      place = 0
      if (int_of(cards, name) == 0) return
      place = find(lookup, int_of(cards, name))
      if (place > 0) return
      block = unsupported(deck, what, int_of(cards, name))
      if (block > 0) then
         call report(deck, cards, name, SEV_ERROR, 'KJ-9139', what//' '// &
            str(int_of(cards, name))//' is of a kind that is not supported', &
            'defined by '//line_text(deck, deck%block(block)%header))
      else
         call report(deck, cards, name, SEV_ERROR, id, what//' '//str(int_of(cards, name))// &
            ' is not defined', 'no such '//what, hint=known_ids(lookup, what))
      end if
   end function reference

   !> Raw index of the node that a field names; 0 when there is none (then reported)
   integer function node_of(draft, cards, name) result(raw)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: name       !! of the field

      raw = find(draft%node, int_of(cards, name))
      if (raw == 0) call report(draft%deck, cards, name, SEV_ERROR, 'KJ-0078', 'node '// &
         str(int_of(cards, name))//' is not defined', 'no such node')
   end function node_of

   !> Block out of scope that defines an entity; 0 when there is none
   pure integer function unsupported(deck, what, id) result(block)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: what
      integer, intent(in) :: id

      integer :: i

      do block = 1, deck%n_block
         if (deck%block(block)%id /= id .or. deck%block(block)%row == 0) cycle
         associate (row => keywords(deck%block(block)%row))
            if (row%status /= OUT_OF_SCOPE) cycle
            do i = 1, size(families)
               if (families(i)%what == what .and. index(row%name, trim(families(i)%head)) == 1) &
                  return
            end do
         end associate
      end do
      block = 0
   end function unsupported

   !> Where the moves of its submodel bring a point; a direction when `direction`
   pure function moved_point(draft, block, x, direction) result(y)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block               !! that types the point
      real(wp), intent(in) :: x(3)
      logical, intent(in) :: direction
      real(wp) :: y(3)

      integer :: i, s

      y = x
      if (.not. allocated(draft%moves)) return
      do i = 1, size(draft%moves)
         s = draft%deck%block(block)%submodel
         do while (s > 0)
            if (draft%deck%submodel(s)%id == draft%moves(i)%submodel) exit
            s = draft%deck%submodel(s)%parent
         end do
         if (s == 0) cycle
         y = matmul(draft%moves(i)%a, y)
         if (.not. direction) y = y + draft%moves(i)%b
      end do
   end function moved_point

   !> "defined: 1 2 5 ..." for hints
   pure function known_ids(lookup, what) result(text)
      type(lookup_t), intent(in) :: lookup
      character(len=*), intent(in) :: what
      character(len=160) :: text

      integer :: i

      text = 'the deck defines no '//what
      if (size(lookup%id) == 0) return
      text = 'defined:'
      do i = 1, min(12, size(lookup%id))
         text = trim(text)//' '//str(lookup%id(i))
      end do
      if (size(lookup%id) > 12) text = trim(text)//' ...'
   end function known_ids

   !> Raw indices of the nodes of the group that a field names.
   !>
   !> A field 0 or blank names none; where `needed`, that is an error.
   subroutine group_nodes(draft, cards, id, needed, nodes)
      type(draft_t), intent(inout) :: draft
      type(cards_t), intent(in) :: cards
      character(len=*), intent(in) :: id         !! of the message
      logical, intent(in) :: needed
      integer, allocatable, intent(out) :: nodes(:)

      integer :: place

      allocate (nodes(0))
      place = reference(draft%deck, cards, 'grnod_id', draft%group, 'node group', id)
      if (place > 0) nodes = draft%groups(place)%node
      if (int_of(cards, 'grnod_id') == 0 .and. needed) call report(draft%deck, cards, 'grnod_id', &
         SEV_ERROR, id, 'no node group is named', 'expected: id of a node group', &
         hint=known_ids(draft%group, 'node group'))
   end subroutine group_nodes

end module kj_draft
