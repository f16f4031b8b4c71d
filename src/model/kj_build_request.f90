!> Cards -> model: what the history holds.
module kj_build_request
   use kj_error, only: str, SEV_ERROR, SEV_WARNING
   use kj_sort, only: lookup_t, new_lookup, find, sorted_order
   use kj_keywords, only: KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, KW_TH_PART
   use kj_deck_text, only: deck_t, line_text, report_header
   use kj_card_lists, only: th_t, read_th, report_id
   use kj_draft, only: draft_t, blocks_of, known_ids
   use kj_model, only: model_t
   implicit none
   private

   public :: build_requests

contains

   !> /TH requests: joints, springs, bodies and nodes of the history, ascending user id; where the
   !> deck asks for none: all joints, springs and bodies, no nodes
   subroutine build_requests(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(lookup_t) :: joints
      integer, allocatable :: blocks(:)

      call new_lookup(model%joint%id, joints)
      blocks = blocks_of(draft%deck, KW_TH_SPRING)
      call collect(draft%deck, blocks, joints, draft%elements%id, 'element', 'KJ-0069', SEV_ERROR, &
         model%th_joint)
      if (size(blocks) == 0) model%th_joint = joints%place
      model%th_spring = pack(model%th_joint, model%th_joint > model%n_joint)
      model%th_joint = pack(model%th_joint, model%th_joint <= model%n_joint)
      blocks = blocks_of(draft%deck, KW_TH_RBODY)
      call collect(draft%deck, blocks, draft%body_id, draft%body_id, 'rigid body', 'KJ-0257', &
         SEV_WARNING, model%th_body)
      if (size(blocks) == 0) model%th_body = draft%body_id%place
      call collect_nodes(draft, model)
      call check_parts(draft)
   end subroutine build_requests

   !> Entities that /TH blocks ask for, each once, ascending id; id 0 in a block asks for all
   subroutine collect(deck, blocks, lookup, all_ids, what, id, severity, list)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: blocks(:), severity
      type(lookup_t), intent(in) :: lookup       !! of what histories hold
      type(lookup_t), intent(in) :: all_ids      !! of what the deck defines
      character(len=*), intent(in) :: what, id
      integer, allocatable, intent(out) :: list(:)

      type(th_t) :: th
      logical :: wanted(size(lookup%id))
      integer :: b, k, i, place
      integer, allocatable :: rank(:)

      wanted = .false.
      allocate (rank(size(lookup%id)))
      rank(lookup%place) = [(i, i=1, size(rank))]
      do b = 1, size(blocks)
         call read_th(deck, blocks(b), th)
         if (th%all) wanted = .true.
         do k = 1, th%object%n
            place = find(lookup, th%object%value(k))
            if (place > 0) then
               wanted(rank(place)) = .true.
            else if (find(all_ids, th%object%value(k)) == 0) then
               call report_id(deck, th%object, k, severity, id, what//' '// &
                  str(th%object%value(k))//' is not defined', 'no such '//what, known_ids(all_ids, &
                  what))
            end if
         end do
      end do
      list = pack(lookup%place, wanted)
   end subroutine collect

   !> Nodes, each once for each set of axes it is asked for in, with the name of its first request
   subroutine collect_nodes(draft, model)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(inout) :: model

      type(th_t), allocatable :: th(:)
      integer, allocatable :: blocks(:), block(:), place(:), skew(:), order(:)
      logical :: taken(model%n_node)
      integer :: b, k, n, raw, i

      blocks = blocks_of(draft%deck, KW_TH_NODE)
      allocate (th(size(blocks)))
      do b = 1, size(blocks)
         call read_th(draft%deck, blocks(b), th(b))
         if (any(th(b)%variable(:)(:2) == 'DR')) call report_header(draft%deck, blocks(b), &
            SEV_WARNING, 'KJ-0774', 'rotational displacements of nodes are not kept', 'asks for DR')
      end do
      n = sum(th%object%n)
      allocate (model%th_node(n), block(n), place(n), skew(n))
      taken = .false.
      n = 0
      do b = 1, size(blocks)
         do k = 1, th(b)%object%n
            raw = find(draft%node, th(b)%object%value(k))
            if (raw == 0) call report_id(draft%deck, th(b)%object, k, SEV_ERROR, 'KJ-0078', &
               'node '// str(th(b)%object%value(k))//' is not defined', 'no such node')
            i = skew_of(draft, th(b), k)
            if (raw == 0) cycle
            if (taken(draft%new(raw))) then
               if (any(model%th_node(:n) == draft%new(raw) .and. skew(:n) == i)) cycle
            end if
            taken(draft%new(raw)) = .true.
            n = n + 1
            model%th_node(n) = draft%new(raw)
            skew(n) = i
            block(n) = b
            place(n) = k
         end do
      end do
      order = sorted_order(model%node_id(model%th_node(:n)))
      model%th_node = model%th_node(order)
      model%th_node_skew = skew(order)
      allocate (model%th_node_name(n))
      do i = 1, n
         associate (object => th(block(order(i)))%object)
            model%th_node_name(i)%s = trim(name_on(line_text(draft%deck, &
               object%line(place(order(i))))))
         end associate
      end do
   end subroutine collect_nodes

   !> Skew that a request names for a node, 0 = global; a frame is another matter
   integer function skew_of(draft, th, k) result(skew)
      type(draft_t), intent(inout) :: draft
      type(th_t), intent(in) :: th
      integer, intent(in) :: k

      skew = 0
      if (th%skew(k) == 0) return
      skew = find(draft%skew, th%skew(k))
      if (skew > 0) return
      if (find(draft%frame, th%skew(k)) > 0) then
         call report_id(draft%deck, th%axes, k, SEV_ERROR, 'KJ-9153', &
            'histories relative to a frame are not supported', 'expected: id of a skew', &
            known_ids(draft%skew, 'skew'))
      else
         call report_id(draft%deck, th%axes, k, SEV_ERROR, 'KJ-0137', 'skew '//str(th%skew(k))// &
            ' is not defined', 'no such skew', known_ids(draft%skew, 'skew'))
      end if
   end function skew_of

   !> Name of a node in its request: columns 21 to 100, or what follows the second comma
   pure function name_on(text) result(name)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: name

      integer :: comma, second

      name = ''
      comma = index(text, ',')
      if (comma > 0) then
         second = index(text(comma + 1:), ',')
         if (second > 0) name = trim(adjustl(text(comma + second + 1:)))
      else if (len(text) > 20) then
         name = trim(adjustl(text(21:min(100, len(text)))))
      end if
   end function name_on

   !> Histories of parts are not written; their cards must be right all the same
   subroutine check_parts(draft)
      type(draft_t), intent(inout) :: draft

      type(th_t) :: th
      integer, allocatable :: blocks(:)
      integer :: b, k

      blocks = blocks_of(draft%deck, KW_TH_PART)
      do b = 1, size(blocks)
         call read_th(draft%deck, blocks(b), th)
         do k = 1, th%object%n
            if (find(draft%part, th%object%value(k)) == 0) call report_id(draft%deck, th%object, &
               k, SEV_WARNING, 'KJ-1610', 'part '//str(th%object%value(k))//' is not defined', &
               'no such part', known_ids(draft%part, 'part'))
         end do
         call report_header(draft%deck, blocks(b), SEV_WARNING, 'KJ-9156', &
            'histories of parts are not written', 'no effect')
      end do
   end subroutine check_parts

end module kj_build_request
