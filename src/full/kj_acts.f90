!> What acts on bodies in a full deck and is not in its mechanism: contacts, walls, airbags, ties.
!> Source: docs/theory/full.md 6.
module kj_acts
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_text, only: text_t
   use kj_sort, only: find
   use kj_keywords, only: keywords
   use kj_deck_text, only: report_header
   use kj_draft, only: draft_t
   use kj_box, only: box_set_t, build_boxes
   use kj_node_list, only: node_list_t, add_nodes
   use kj_select, only: faces_t, surface_of, line_nodes, kind_word
   use kj_build_group, only: fill_one_group
   use kj_element_mass, only: scales_t, element_t, first_element, next_element, NO_PROBLEM
   use kj_element_cards, only: element_row
   use kj_full_card, only: card_integer
   use kj_keep, only: body_of
   implicit none
   private

   public :: act_t, find_acts, check_unweighed

   !> A kind of condition out of scope that acts on bodies in the full deck
   type :: act_t
      character(len=20) :: name = ''             !! keyword
      integer :: n = 0                           !! blocks that act on a body
      type(text_t) :: what                       !! what the mechanism lacks
      integer, allocatable :: body(:)            !! ids
   end type act_t

   !> What an id in a column of the first card names
   integer, parameter :: A_GROUP = 1, A_SURFACE = 2, A_LINE = 3, A_NODE = 4

   !> A row: up to three columns with ids
   type :: actor_t
      character(len=20) :: name
      character(len=10) :: kind                  !! second word of the header, '' = all others
      integer           :: column(3), names(3)   !! 0 = none
      integer           :: severity
      character(len=48) :: what
   end type actor_t

   type(actor_t), parameter :: actors(*) = [ &
      actor_t('/INTER', 'TYPE2', [1, 11, 0], [A_GROUP, A_SURFACE, 0], SEV_WARNING, 'a tie: what it ties is loose'), &
      actor_t('/INTER', 'TYPE3', [1, 11, 0], [A_SURFACE, A_SURFACE, 0], SEV_WARNING, 'no contact: bodies pass through'), &
      actor_t('/INTER', 'TYPE11', [1, 11, 0], [A_LINE, A_LINE, 0], SEV_WARNING, 'no contact: bodies pass through'), &
      actor_t('/INTER', 'TYPE19', [1, 11, 0], [A_SURFACE, A_SURFACE, 0], SEV_WARNING, 'no contact: bodies pass through'), &
      actor_t('/INTER', 'TYPE25', [1, 11, 0], [A_SURFACE, A_SURFACE, 0], SEV_WARNING, 'no contact: bodies pass through'), &
      actor_t('/INTER', '', [1, 11, 0], [A_GROUP, A_SURFACE, 0], SEV_WARNING, 'no contact: bodies pass through'), &
      actor_t('/RWALL', '', [21, 0, 0], [A_GROUP, 0, 0], SEV_WARNING, 'no wall: bodies pass through'), &
      actor_t('/MONVOL', '', [1, 0, 0], [A_SURFACE, 0, 0], SEV_WARNING, 'no airbag pushes'), &
      actor_t('/PLOAD', '', [1, 0, 0], [A_SURFACE, 0, 0], SEV_WARNING, 'no pressure'), &
      actor_t('/DAMP', '', [41, 0, 0], [A_GROUP, 0, 0], SEV_WARNING, 'no damping'), &
      actor_t('/CYL_JOINT', '', [1, 11, 21], [A_NODE, A_NODE, A_GROUP], SEV_WARNING, 'a joint of nodes: force path lost'), &
      actor_t('/RLINK', '', [21, 0, 0], [A_GROUP, 0, 0], SEV_WARNING, 'nodes move apart'), &
      actor_t('/RBE3', '', [1, 0, 0], [A_NODE, 0, 0], SEV_ERROR, 'a node that follows others'), &
      actor_t('/MERGE', '', [0, 0, 0], [0, 0, 0], SEV_ERROR, 'bodies that are one'), &
      actor_t('/GJOINT', '', [1, 0, 0], [A_NODE, 0, 0], SEV_ERROR, 'a gear')]

contains

   !> All kinds that act on a body, with a finding at the first of each
   subroutine find_acts(draft, acts)
      type(draft_t), intent(inout) :: draft
      type(act_t), allocatable, intent(out) :: acts(:)

      type(box_set_t) :: boxes
      logical, allocatable :: touched(:), all_touched(:)
      integer :: row, block, n, first

      allocate (acts(0), touched(max(1, size(draft%body_block))))
      call build_boxes(draft, boxes)
      do row = 1, size(actors)
         n = 0
         first = 0
         all_touched = touched .and. .false.
         do block = 1, draft%deck%n_block
            if (actor_of(draft, block) /= row) cycle
            call touch(draft, boxes, block, row, touched)
            if (.not. any(touched)) cycle
            n = n + 1
            if (first == 0) first = block
            all_touched = all_touched .or. touched
         end do
         if (n == 0) cycle
         call append(acts, row, n, pack(draft%body_id%id, all_touched(:size(draft%body_id%id))))
         call report_header(draft%deck, first, actors(row)%severity, merge('KJ-9428', 'KJ-9426', &
            actors(row)%severity == SEV_ERROR), trim(actors(row)%name)//' acts on bodies: '// &
            trim(actors(row)%what), str(n)//' of this kind, on '//str(count(all_touched))// &
            ' bodies')
      end do
   end subroutine find_acts

   !> Append an act to a list
   subroutine append(acts, row, n, body)
      type(act_t), allocatable, intent(inout) :: acts(:)
      integer, intent(in) :: row, n, body(:)

      type(act_t), allocatable :: longer(:)
      integer :: m

      m = size(acts)
      allocate (longer(m + 1))
      longer(:m) = acts
      longer(m + 1)%name = actors(row)%name
      longer(m + 1)%n = n
      longer(m + 1)%what%s = trim(actors(row)%what)
      longer(m + 1)%body = body
      call move_alloc(longer, acts)
   end subroutine append

   !> Row of a block; 0 = none
   integer function actor_of(draft, block) result(row)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block

      character(len=10) :: word

      row = 0
      if (draft%deck%block(block)%row == 0) return
      word = kind_word(draft, block)
      do row = 1, size(actors)
         if (keywords(draft%deck%block(block)%row)%name /= actors(row)%name) cycle
         if (actors(row)%kind == '' .or. actors(row)%kind == word) return
      end do
      row = 0
   end function actor_of

   !> Bodies with a node that a block names
   subroutine touch(draft, boxes, block, row, touched)
      type(draft_t), intent(inout) :: draft
      type(box_set_t), intent(in) :: boxes
      integer, intent(in) :: block, row
      logical, intent(inout) :: touched(:)

      type(node_list_t) :: list
      type(faces_t) :: faces
      integer, allocatable :: node(:)
      integer :: k, id, i

      touched = actors(row)%column(1) == 0
      do k = 1, 3
         if (actors(row)%column(k) == 0) exit
         call card_integer(draft%deck, block, 1, actors(row)%column(k), id)
         if (id <= 0) cycle
         list%n = 0
         select case (actors(row)%names(k))
         case (A_GROUP)
            call fill_one_group(draft, id, node)
            call add_nodes(node, list)
         case (A_SURFACE)
            faces%n = 0
            call surface_of(draft, boxes, id, 0, faces)
            do i = 1, faces%n
               call add_nodes(faces%node(:, i), list)
            end do
         case (A_LINE)
            call line_nodes(draft, boxes, id, list)
         case (A_NODE)
            call add_nodes([find(draft%node, id)], list)
         end select
         do i = 1, list%n
            id = body_of(draft, list%node(i))
            if (id > 0) touched(id) = .true.
         end do
      end do
   end subroutine touch

   !> Elements of bodies whose mass cannot be told: an error, the body would weigh too little
   subroutine check_unweighed(draft, scales)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales

      type(element_t) :: e
      integer :: block, i
      logical :: touches

      do block = 1, draft%deck%n_block
         if (element_row(draft%deck%block(block)%keyword) == 0) cycle
         call first_element(draft, block, e)
         if (e%part == 0) cycle
         if (scales%problem(e%part) == NO_PROBLEM) cycle
         touches = .false.
         do
            call next_element(draft, e)
            if (e%row == 0 .or. touches) exit
            do i = 1, size(e%raw)
               if (body_of(draft, e%raw(i)) > 0) touches = .true.
            end do
         end do
         if (touches) call report_header(draft%deck, block, SEV_ERROR, 'KJ-9427', &
            'the mass of the elements of part '//str(draft%deck%block(block)%id)// &
            ' is not known', 'they belong to a body', &
            'its material or property has no density, '// &
            'thickness or layers that are read')
      end do
   end subroutine check_unweighed

end module kj_acts
