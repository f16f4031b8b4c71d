!> What acts on bodies in a full deck and is not in its mechanism: contacts, walls, airbags, ties.
!> Source: docs/theory/full.md 6.
module kj_acts
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_text, only: text_t
   use kj_sort, only: find
   use kj_keywords, only: keywords
   use kj_deck_text, only: report_header, first_card, kind_word
   use kj_cards, only: report_row
   use kj_draft, only: draft_t
   use kj_node_list, only: node_list_t, add_nodes, faces_t
   use kj_select, only: filter_t, surface_of, line_nodes, parts_of, walk_elements, &
      all_kinds, OUTERMOST
   use kj_build_group, only: fill_one_group
   use kj_element_mass, only: scales_t, element_t, first_element, next_element, NO_PROBLEM, &
      NO_DENSITY
   use kj_element_cards, only: element_row
   use kj_full_property, only: card_real, card_integer
   use kj_keep, only: keep_t, body_of
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

   !> What an id in a column names; A_PART is the id in the header
   integer, parameter :: A_GROUP = 1, A_SURFACE = 2, A_LINE = 3, A_NODE = 4, A_PART = 5

   !> Whom it must touch
   integer, parameter :: ALL_OF_THEM = 0, A_BODY = 1, ITS_MAIN = 2, ANY_KEPT = 3

   !> A row: up to four columns with ids
   type :: actor_t
      character(len=20) :: name
      character(len=10) :: kind                  !! second word of the header, '' = all others
      logical           :: rows                  !! each card has them, not the first alone
      integer           :: column(4), names(4)   !! 0 = none
      integer           :: whom
      integer           :: severity
      character(len=44) :: what
   end type actor_t

   logical, parameter :: T = .true., F = .false.
   integer, parameter :: G = A_GROUP, S = A_SURFACE, L = A_LINE, N = A_NODE, W = SEV_WARNING, &
      E = SEV_ERROR
   character(len=*), parameter :: PASS = 'no contact: bodies pass through'

   type(actor_t), parameter :: actors(*) = [ &
      actor_t('/INTER', 'TYPE2', F, [1, 11, 0, 0], [G, S, 0, 0], A_BODY, W, 'a tie: what it ties is loose'), &
      actor_t('/INTER', 'TYPE3', F, [1, 11, 0, 0], [S, S, 0, 0], A_BODY, W, PASS), &
      actor_t('/INTER', 'TYPE11', F, [1, 11, 0, 0], [L, L, 0, 0], A_BODY, W, PASS), &
      actor_t('/INTER', 'TYPE19', F, [1, 11, 0, 0], [S, S, 0, 0], A_BODY, W, PASS), &
      actor_t('/INTER', 'TYPE25', F, [1, 11, 0, 0], [S, S, 0, 0], A_BODY, W, PASS), &
      actor_t('/INTER', '', F, [1, 11, 0, 0], [G, S, 0, 0], A_BODY, W, PASS), &
      actor_t('/RWALL', '', F, [21, 0, 0, 0], [G, 0, 0, 0], A_BODY, W, 'no wall: bodies pass through'), &
      actor_t('/MONVOL', '', F, [1, 0, 0, 0], [S, 0, 0, 0], A_BODY, W, 'no airbag pushes'), &
      actor_t('/PLOAD', '', F, [1, 0, 0, 0], [S, 0, 0, 0], A_BODY, W, 'no pressure'), &
      actor_t('/LOAD', 'CENTRI', F, [41, 0, 0, 0], [G, 0, 0, 0], ANY_KEPT, E, 'centrifugal forces'), &
      actor_t('/LOAD', '', F, [1, 0, 0, 0], [S, 0, 0, 0], A_BODY, W, 'no pressure'), &
      actor_t('/DAMP', '', F, [41, 0, 0, 0], [G, 0, 0, 0], ITS_MAIN, W, 'no damping'), &
      actor_t('/CYL_JOINT', '', F, [1, 11, 21, 0], [N, N, G, 0], A_BODY, W, 'a joint of nodes: force path lost'), &
      actor_t('/RLINK', '', F, [21, 0, 0, 0], [G, 0, 0, 0], ITS_MAIN, E, 'nodes that move alike'), &
      actor_t('/RLINK', '', F, [21, 0, 0, 0], [G, 0, 0, 0], A_BODY, W, 'nodes move apart'), &
      actor_t('/RBE3', '', F, [1, 0, 0, 0], [N, 0, 0, 0], ANY_KEPT, E, 'a node that follows others'), &
      actor_t('/MERGE', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, E, 'bodies that are one'), &
      actor_t('/GJOINT', '', F, [1, 71, 81, 91], [N, N, N, N], ANY_KEPT, E, 'a gear'), &
      actor_t('/MPC', '', T, [1, 0, 0, 0], [N, 0, 0, 0], ANY_KEPT, E, 'nodes that others bind'), &
      actor_t('/QUAD', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, E, 'plane elements'), &
      actor_t('/TRIA', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, E, 'plane elements'), &
      actor_t('/RIVET', '', T, [11, 21, 0, 0], [N, N, 0, 0], A_BODY, W, 'no rivets'), &
      actor_t('/SPHCEL', '', T, [11, 0, 0, 0], [N, 0, 0, 0], A_BODY, W, 'no particles'), &
      actor_t('/XELEM', '', T, [11, 0, 0, 0], [G, 0, 0, 0], A_BODY, W, 'no strands'), &
      actor_t('/SLIPRING', '', F, [21, 0, 0, 0], [N, 0, 0, 0], A_BODY, W, 'no belts'), &
      actor_t('/RETRACTOR', '', F, [11, 0, 0, 0], [N, 0, 0, 0], A_BODY, W, 'no belts'), &
      actor_t('/INIVEL', 'NODE', T, [1, 0, 0, 0], [N, 0, 0, 0], ANY_KEPT, E, 'initial velocities node by node'), &
      actor_t('/RBODY/LAGMUL', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, E, 'a body by multipliers'), &
      actor_t('/NBCS', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'conditions node by node'), &
      actor_t('/BCS/LAGMUL', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'conditions by multipliers'), &
      actor_t('/IMPVEL/LAGMUL', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'velocities by multipliers'), &
      actor_t('/IMPVEL/FGEO', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'motion to a final geometry'), &
      actor_t('/IMPDISP/FGEO', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'motion to a final geometry'), &
      actor_t('/INISPRI', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'forces of springs at the start'), &
      actor_t('/PRELOAD', '', F, [0, 0, 0, 0], [0, 0, 0, 0], ALL_OF_THEM, W, 'bolts that are tightened'), &
      actor_t('/XREF', '', F, [1, 0, 0, 0], [A_PART, 0, 0, 0], A_BODY, W, 'masses are those of the mesh as it stands')]

contains

   !> All kinds that act on a body, with a finding at the first of each
   subroutine find_acts(draft, keep, acts)
      type(draft_t), intent(inout) :: draft
      type(keep_t), intent(in) :: keep
      type(act_t), allocatable, intent(out) :: acts(:)

      logical :: touched(0:size(draft%body_block)), all_touched(0:size(draft%body_block))
      integer :: row, block, n, first

      allocate (acts(0))
      do row = 1, size(actors)
         n = 0
         first = 0
         all_touched = .false.
         do block = 1, draft%deck%n_block
            if (.not. is_actor(draft, block, row)) cycle
            call touch(draft, keep, block, row, touched)
            if (.not. any(touched)) cycle
            n = n + 1
            if (first == 0) first = block
            all_touched = all_touched .or. touched
         end do
         if (n == 0) cycle
         call append(acts, row, n, pack(draft%body_id%id, all_touched(1:size(draft%body_id%id))))
         call report_header(draft%deck, first, actors(row)%severity, merge('KJ-9428', 'KJ-9426', &
            actors(row)%severity == SEV_ERROR), trim(told(row, any(all_touched(1:)))), &
            str(n)//' of this kind, on '//str(count(all_touched(1:)))//' bodies')
      end do
      call report_springs(draft)
   end subroutine find_acts

   !> What a kind does; of some it is not looked up on what
   pure function told(row, on_bodies) result(text)
      integer, intent(in) :: row
      logical, intent(in) :: on_bodies
      character(len=100) :: text

      text = trim(actors(row)%name)//' acts on kept nodes: '//actors(row)%what
      if (on_bodies) text = trim(actors(row)%name)//' acts on bodies: '//actors(row)%what
      if (actors(row)%whom == ALL_OF_THEM) text = trim(actors(row)%name)// &
         ' may act on bodies: '//actors(row)%what
   end function told

   !> Springs of laws that are not read, at bodies
   subroutine report_springs(draft)
      type(draft_t), intent(inout) :: draft

      integer :: i, n, first

      n = 0
      first = 0
      do i = draft%elements%n, 1, -1
         if (draft%elements%part(i) == 0) cycle
         if (draft%part_property(draft%elements%part(i)) > 0) cycle
         if (max(body_of(draft, draft%elements%node(1, i)), &
            body_of(draft, draft%elements%node(2, i))) == 0) cycle
         n = n + 1
         first = i
      end do
      if (n > 0) call report_row(draft%deck, draft%elements%card(first), 'id', SEV_WARNING, &
         'KJ-9426', 'springs of a law that is not read act on bodies', str(n)//' of this kind', &
         'their mass counts, their force does not')
   end subroutine report_springs

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

   !> A row is about a block
   logical function is_actor(draft, block, row)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block, row

      character(len=10) :: word

      is_actor = .false.
      if (draft%deck%block(block)%row == 0) return
      if (keywords(draft%deck%block(block)%row)%name /= actors(row)%name) return
      word = kind_word(draft%deck, block)
      is_actor = actors(row)%kind == word .or. (actors(row)%kind == '' .and. &
         all(actors%name /= actors(row)%name .or. actors%kind /= word))
   end function is_actor

   !> Bodies with a node that a block names; 0: a kept node of none
   subroutine touch(draft, keep, block, row, touched)
      type(draft_t), intent(inout) :: draft
      type(keep_t), intent(in) :: keep
      integer, intent(in) :: block, row
      logical, intent(out) :: touched(0:)

      type(node_list_t) :: list
      integer :: card, k, i, id, body
      logical :: fine

      touched = actors(row)%whom == ALL_OF_THEM
      list%n = 0
      do card = 1, merge(max(0, draft%deck%block(block)%last - first_card(draft%deck, block) + 1), &
         1, actors(row)%rows)
         do k = 1, count(actors(row)%column > 0)
            if (actors(row)%names(k) == A_PART) then
               id = draft%deck%block(block)%id
            else
               call card_integer(draft%deck, block, card, actors(row)%column(k), id, fine=fine)
            end if
            if (id > 0) call named_nodes(draft, actors(row)%names(k), id, list)
         end do
      end do
      do i = 1, list%n
         if (list%node(i) == 0) cycle
         body = body_of(draft, list%node(i))
         if (actors(row)%whom == ITS_MAIN) body = draft%main_of(list%node(i))
         if (body > 0) touched(body) = .true.
         if (actors(row)%whom == ANY_KEPT .and. keep%node(list%node(i))) touched(0) = .true.
      end do
   end subroutine touch

   !> Nodes behind an id
   subroutine named_nodes(draft, what, id, list)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: what, id            !! A_GROUP, ...
      type(node_list_t), intent(inout) :: list

      type(filter_t) :: filter
      type(faces_t) :: faces
      integer, allocatable :: node(:)
      integer :: i

      select case (what)
      case (A_GROUP)
         call fill_one_group(draft, id, node)
         call add_nodes(node, list)
      case (A_SURFACE)
         call surface_of(draft, id, OUTERMOST, faces)
         do i = 1, faces%n
            call add_nodes(faces%node(:, i), list)
         end do
      case (A_LINE)
         call line_nodes(draft, id, list)
      case (A_NODE)
         call add_nodes([find(draft%node, id)], list)
      case (A_PART)
         filter%kind = all_kinds()
         allocate (filter%part(size(draft%part_block)), source=.false.)
         call parts_of(draft, 'PART', id, filter%part)
         call walk_elements(draft, filter, list=list)
      end select
   end subroutine named_nodes

   !> Elements of bodies whose mass cannot be told: an error, the body would weigh too little
   subroutine check_unweighed(draft, scales)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales

      type(element_t) :: e
      integer :: block, i
      real(wp) :: density
      logical :: touches, rigid

      do block = 1, draft%deck%n_block
         if (element_row(draft%deck%block(block)%keyword) == 0) cycle
         call first_element(draft, block, e)
         if (e%part == 0) cycle
         if (scales%problem(e%part) == NO_PROBLEM) cycle
         touches = .false.
         rigid = .false.
         if (scales%part_material(e%part) > 0) &
            rigid = scales%material(scales%part_material(e%part))%rigid
         do
            call next_element(draft, e)
            if (e%row == 0 .or. touches) exit
            do i = 1, size(e%raw)
               if (body_of(draft, e%raw(i)) > 0 .or. rigid) touches = .true.
            end do
         end do
         if (rigid .and. touches) call report_header(draft%deck, block, SEV_ERROR, 'KJ-9428', &
            'the material of part '//str(draft%deck%block(block)%id)//' makes rigid bodies of '// &
            'its elements', 'these have no id and no main node', 'put its nodes into a /RBODY')
         if (rigid .or. .not. touches) cycle
         if (scales%problem(e%part) == NO_DENSITY .and. scales%part_material(e%part) > 0) &
            call card_real(draft%deck, scales%material(scales%part_material(e%part))%block, 1, 1, &
            1.0_wp, density)                     ! says what is wrong with it
         call report_header(draft%deck, block, SEV_ERROR, 'KJ-9427', &
            'the mass of the elements of part '//str(draft%deck%block(block)%id)// &
            ' is not known', 'they belong to a body', &
            'its material or property has no density, '// &
            'thickness or layers that are read')
      end do
   end subroutine check_unweighed

end module kj_acts
