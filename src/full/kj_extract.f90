!> A full deck -> the deck of its mechanism: one flat file with bodies, joints, springs and their
!> conditions. Source: docs/theory/full.md 5.
!>
!> Cards of what is kept are copied as they are (submodels and parameters are resolved in them);
!> nodes, bodies and groups are written anew, in work units.
!> One file: the sections of one file, in their order.
module kj_extract
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_NOTE
   use kj_version, only: KJOINT_VERSION
   use kj_sort, only: lookup_t, new_lookup, find, lower_bound
   use kj_keywords, only: keywords, HEAD_ID, HEAD_TYPE_ID, KW_BEGIN, KW_TITLE, KW_ANALY, &
      KW_FUNCT, KW_MOVE_FUNCT, KW_SENSOR_TIME, KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, KW_TH_PART, &
      KW_SKEW_FIX, KW_SKEW_MOV, KW_SKEW_MOV2, KW_FRAME_FIX, KW_FRAME_MOV, KW_FRAME_MOV2, &
      KW_FRAME_NOD
   use kj_deck_text, only: deck_t, line_text, title_of, report_header, folder_of, lengthen, put_text
   use kj_number, only: real_field, integer_field
   use kj_card_lists, only: th_t, read_th
   use kj_draft, only: draft_t
   use kj_model, only: model_t
   use kj_keep, only: keep_t, body_of
   implicit none
   private

   public :: write_mechanism, page_t, new_page

   !> The text so far
   type :: page_t
      character(len=:), allocatable :: text      !! the first n bytes are set
      integer :: n = 0
      integer :: n_line = 0
      integer, allocatable :: origin(:)          !! (>= n_line) line of the full deck, 0 = none
   end type page_t

contains

   !> The starter deck of the mechanism
   subroutine write_mechanism(draft, model, keep, kept, spring_mass, spring_inertia, page)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model         !! bodies, weighed
      type(keep_t), intent(in) :: keep
      integer, intent(in) :: kept(:)             !! raw indices of kept nodes, ascending
      real(wp), intent(in) :: spring_mass(:), spring_inertia(:)   !! of kept springs, on these
      type(page_t), intent(inout) :: page

      integer :: unit

      unit = 0                                   ! where the work units are the input units
      if (any(abs(draft%deck%input%si - draft%deck%work%si) > 0.0_wp)) &
         unit = maxval([0, draft%deck%unit_id(:draft%deck%n_unit)]) + 1
      call write_head(draft%deck, unit, page)
      call write_nodes(draft, model, keep, unit, page)
      call write_bodies(draft, model, unit, kept, spring_mass, spring_inertia, page)
      call write_springs(draft, keep, page)
      call write_masses(draft, unit, kept, spring_mass, page)
      call write_axes(draft, keep, unit, page)
      call write_tables(draft, keep, page)
      call write_conditions(draft, keep, page)
      call write_requests(draft, keep, page)
      call put(page, '/END')
   end subroutine write_mechanism

   pure integer function suffix_length(unit) result(n)
      integer, intent(in) :: unit

      n = 0
      if (unit > 0) n = len(str(unit)) + 1
   end function suffix_length

   !> '/7' for unit 7, nothing for 0
   pure function suffix(unit) result(text)
      integer, intent(in) :: unit
      character(len=suffix_length(unit)) :: text

      text = ''
      if (unit > 0) text = '/'//str(unit)
   end function suffix

   !> Comment, /BEGIN, title, units, kind of analysis
   subroutine write_head(deck, unit, page)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: unit
      type(page_t), intent(inout) :: page

      integer :: block, i

      call put(page, '#RADIOSS STARTER')
      call put(page, &
         '# The mechanism of '//deck%source(1)%path(len(folder_of(deck%source(1)%path)) + 1:)// &
         ', taken out by kjoint '// &
         KJOINT_VERSION)
      call put(page, '# SHA-256 of that deck: '//deck%source(1)%digest)
      do block = 1, deck%n_block
         if (.not. any(deck%block(block)%keyword == [KW_BEGIN, KW_TITLE, KW_ANALY])) cycle
         if (deck%block(block)%keyword == KW_BEGIN) call write_begin(deck, block, page)
         if (deck%block(block)%keyword /= KW_BEGIN) call copy_block(deck, block, page)
      end do
      do i = 1, deck%n_unit
         call put(page, '/UNIT'//suffix(deck%unit_id(i)))
         call put(page, 'units')
         call put(page, triple(deck%unit(i)%si))
      end do
      if (unit == 0) return
      call put(page, '/UNIT'//suffix(unit))
      call put(page, 'work units')
      call put(page, triple(deck%work%si))
   end subroutine write_head

   !> /BEGIN, with units where it has none: /UNIT/LENGTH/mm and its like say them
   subroutine write_begin(deck, block, page)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(page_t), intent(inout) :: page

      integer :: line

      call put_header(page, deck, block)
      do line = deck%block(block)%first, deck%block(block)%first + 3
         if (line <= deck%block(block)%last) then
            if (line < deck%block(block)%first + 2 .or. line_text(deck, line) /= '') then
               call put_copy(page, deck, line)
               cycle
            end if
         end if
         call put(page, triple(merge(deck%input%si, deck%work%si, &
            line < deck%block(block)%first + 3)))
      end do
   end subroutine write_begin

   !> Three numbers on a card
   pure function triple(x) result(text)
      real(wp), intent(in) :: x(3)
      character(len=60) :: text

      text = real_field(x(1))//real_field(x(2))//real_field(x(3))
   end function triple

   !> The header of a block as it is outside of submodels: words, id, unit
   subroutine take_header(deck, block, header)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      character(len=:), allocatable, intent(out) :: header

      character(len=:), allocatable :: text
      integer :: slash, next

      text = trim(line_text(deck, deck%block(block)%header))
      header = ''
      slash = 1
      do
         next = index(text(slash + 1:)//'/', '/') + slash
         if (verify(trim(text(slash + 1:next - 1)), ' 0123456789') == 0) exit
         header = header//'/'//trim(text(slash + 1:next - 1))
         slash = next
         if (slash >= len(text)) exit
      end do
      associate (b => deck%block(block))
         if (any(keywords(b%row)%head == [HEAD_ID, HEAD_TYPE_ID])) header = header//'/'//str(b%id)
         if (b%unit_id > 0) header = header//suffix(b%unit_id)
      end associate
   end subroutine take_header

   subroutine put_header(page, deck, block)
      type(page_t), intent(inout) :: page
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block

      character(len=:), allocatable :: header

      call take_header(deck, block, header)
      call put(page, header, deck%block(block)%header)
   end subroutine put_header

   !> Copy a block with its cards
   subroutine copy_block(deck, block, page)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(page_t), intent(inout) :: page

      integer :: line

      call put_header(page, deck, block)
      do line = deck%block(block)%first, deck%block(block)%last
         call put_copy(page, deck, line)
      end do
   end subroutine copy_block

   !> Kept nodes; main nodes stand at the centre of their body
   subroutine write_nodes(draft, model, keep, unit, page)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      type(keep_t), intent(in) :: keep
      integer, intent(in) :: unit
      type(page_t), intent(inout) :: page

      real(wp) :: x(3)
      integer :: i

      call put(page, '/NODE'//suffix(unit))
      do i = 1, draft%n_node
         if (.not. keep%node(i)) cycle
         x = draft%x(i, :)
         if (draft%main_of(i) > 0) x = model%x0(draft%main_of(i), :)
         call put(page, integer_field(draft%id(i))//triple(x))
      end do
   end subroutine write_nodes

   !> Bodies with the mass and inertia that they have in the full deck: ICoG 4 takes them as typed
   subroutine write_bodies(draft, model, unit, kept, spring_mass, spring_inertia, page)
      type(draft_t), intent(in) :: draft
      type(model_t), intent(in) :: model
      integer, intent(in) :: unit, kept(:)
      real(wp), intent(in) :: spring_mass(:), spring_inertia(:)
      type(page_t), intent(inout) :: page

      type(lookup_t) :: of_body
      real(wp) :: j(3, 3), axes(3, 3)
      integer :: b, main, i, next, first, last
      integer :: main_of(0:maxval([0, model%n_body, draft%main_of(kept)]))   ! places in kept

      main_of(draft%main_of(kept)) = [(i, i=1, size(kept))]
      call new_lookup(draft%body(kept), of_body)
      next = max(1, maxval([0, draft%group%id]) + 1)   ! ids from here on name no group
      do b = 1, model%n_body
         main = main_of(b)
         if (main == 0) cycle
         axes = reshape(model%axes(b, :), [3, 3])
         j = matmul(axes*spread(model%principal(b, :), 1, 3), transpose(axes))
         do i = 1, 3
            j(i, i) = j(i, i) - spring_inertia(main)
         end do
         first = lower_bound(of_body%id, b)
         last = lower_bound(of_body%id, b + 1) - 1
         call put(page, '/RBODY/'//str(model%body_id(b))//suffix(unit))
         call put(page, model%body_name(b)%s)
         call put(page, integer_field(draft%id(kept(main)))//integer_field(0)//integer_field(0)// &
            integer_field(merge(1, 3, model%ispher(b) == 1))// &
            real_field(model%mass(b) - spring_mass(main))//integer_field(next)// &
            integer_field(0)//integer_field(4)//integer_field(0))
         call put(page, triple([j(1, 1), j(2, 2), j(3, 3)]))
         call put(page, triple([j(1, 2), j(2, 3), j(1, 3)]))
         call put(page, integer_field(0)//integer_field(0)//integer_field(0))
         call write_group(draft, next, 'nodes of body '//str(model%body_id(b)), &
            kept(of_body%place(first:last)), page)
         next = next + 1
      end do
   end subroutine write_bodies

   subroutine write_group(draft, id, title, node, page)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: id, node(:)         !! raw indices
      character(len=*), intent(in) :: title
      type(page_t), intent(inout) :: page

      character(len=:), allocatable :: line
      integer :: i, k

      call put(page, '/GRNOD/NODE/'//str(id))
      call put(page, title)
      do i = 1, size(node), 10
         line = ''
         do k = i, min(i + 9, size(node))
            line = line//integer_field(draft%id(node(k)))
         end do
         call put(page, line)
      end do
   end subroutine write_group

   !> Parts, properties and elements of springs and joints
   subroutine write_springs(draft, keep, page)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(in) :: keep
      type(page_t), intent(inout) :: page

      integer :: i, block, line

      associate (deck => draft%deck)
         do i = 1, size(keep%property)
            if (keep%property(i)) call copy_block(deck, draft%property_block(i), page)
         end do
         do i = 1, size(keep%part)
            if (.not. keep%part(i)) cycle
            block = draft%part_block(i)
            call put_header(page, deck, block)
            call put(page, title_of(deck, block))
            call put(page, integer_field(draft%part_ids(1, i))//integer_field(0)//integer_field(0))
         end do
         block = 0
         do i = 1, draft%elements%n
            if (.not. keep%spring(i)) cycle
            line = draft%elements%card(i)%line
            if (draft%elements%card(i)%block /= block) then
               block = draft%elements%card(i)%block
               call put_header(page, deck, block)
            end if
            call put_copy(page, deck, line)
         end do
      end associate
   end subroutine write_springs

   !> Mass of free nodes: that of dropped elements and /ADMAS; kept springs bring their own
   subroutine write_masses(draft, unit, kept, spring_mass, page)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: unit, kept(:)
      real(wp), intent(in) :: spring_mass(:)
      type(page_t), intent(inout) :: page

      real(wp) :: mass
      integer :: i
      logical :: open

      open = .false.
      do i = 1, size(kept)
         if (body_of(draft, kept(i)) > 0) cycle
         mass = draft%mass(kept(i)) - spring_mass(i)
         if (.not. mass > 1.0e-12_wp*draft%mass(kept(i))) cycle
         if (.not. open) call put(page, '/ADMAS/5/1'//suffix(unit))
         if (.not. open) call put(page, 'mass of free nodes')
         open = .true.
         call put(page, real_field(mass)//integer_field(draft%id(kept(i))))
      end do
   end subroutine write_masses

   !> Skews and frames; those whose nodes are gone stand still
   subroutine write_axes(draft, keep, unit, page)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(in) :: keep
      integer, intent(in) :: unit
      type(page_t), intent(inout) :: page

      integer :: block, i
      real(wp), parameter :: NOWHERE(3) = 0.0_wp

      do block = 1, draft%deck%n_block
         associate (b => draft%deck%block(block))
            if (any(b%keyword == [KW_SKEW_FIX, KW_SKEW_MOV, KW_SKEW_MOV2])) then
               i = find(draft%skew, b%id)
               if (i == 0) cycle
               if (.not. keep%skew(i)) cycle
               if (keep%fixed_skew(i) .or. (b%keyword == KW_SKEW_FIX .and. b%submodel > 0)) then
                  call put_axes(page, '/SKEW/FIX/'//str(b%id)//suffix(unit), &
                     title_of(draft%deck, block), NOWHERE, draft%skews%axes(i, :))
               else
                  call copy_block(draft%deck, block, page)
               end if
            else if (any(b%keyword == [KW_FRAME_FIX, KW_FRAME_MOV, KW_FRAME_MOV2, KW_FRAME_NOD])) &
               then
               i = find(draft%frame, b%id)
               if (i == 0) cycle
               if (.not. keep%frame(i)) cycle
               if (keep%fixed_frame(i) .or. (b%keyword == KW_FRAME_FIX .and. b%submodel > 0)) then
                  call put_axes(page, '/FRAME/FIX/'//str(b%id)//suffix(unit), &
                     title_of(draft%deck, block), draft%frame_origin(i, :), &
                     draft%frames%axes(i, :))
               else
                  call copy_block(draft%deck, block, page)
               end if
            end if
         end associate
      end do
   end subroutine write_axes

   subroutine put_axes(page, header, title, origin, axes)
      type(page_t), intent(inout) :: page
      character(len=*), intent(in) :: header, title
      real(wp), intent(in) :: origin(3), axes(9)

      call put(page, header)
      call put(page, title)
      call put(page, triple(origin))
      call put(page, triple(axes(4:6)))
      call put(page, triple(axes(7:9)))
   end subroutine put_axes

   !> Functions and sensors that something kept names
   subroutine write_tables(draft, keep, page)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(in) :: keep
      type(page_t), intent(inout) :: page

      integer :: block, i

      do block = 1, draft%deck%n_block
         associate (b => draft%deck%block(block))
            if (any(b%keyword == [KW_FUNCT, KW_MOVE_FUNCT])) then
               i = find(draft%curve, b%id)
               if (i == 0) cycle
               if (keep%curve(i)) call copy_block(draft%deck, block, page)
            else if (b%keyword == KW_SENSOR_TIME) then
               i = find(draft%sensor, b%id)
               if (i == 0) cycle
               if (keep%sensor(i)) call copy_block(draft%deck, block, page)
            end if
         end associate
      end do
   end subroutine write_tables

   !> Conditions, and the groups they name, of kept nodes alone
   subroutine write_conditions(draft, keep, page)
      type(draft_t), intent(in) :: draft
      type(keep_t), intent(in) :: keep
      type(page_t), intent(inout) :: page

      integer :: block, i
      integer, allocatable :: node(:)

      do block = 1, draft%deck%n_block
         if (keep%block(block)) call copy_block(draft%deck, block, page)
      end do
      do i = 1, size(draft%groups)
         if (.not. keep%group(i)) cycle
         block = draft%groups(i)%block
         if (find(draft%group, draft%deck%block(block)%id) /= i) cycle
         node = pack(draft%groups(i)%node, keep%node(draft%groups(i)%node))
         call write_group(draft, draft%deck%block(block)%id, title_of(draft%deck, block), node, &
            page)
      end do
   end subroutine write_conditions

   !> Histories of what is kept
   subroutine write_requests(draft, keep, page)
      type(draft_t), intent(inout) :: draft
      type(keep_t), intent(in) :: keep
      type(page_t), intent(inout) :: page

      type(th_t) :: th
      logical, allocatable :: there(:)
      integer :: block, k, i, lost, at

      lost = 0
      at = 0
      do block = 1, draft%deck%n_block
         if (all(draft%deck%block(block)%keyword /= [KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, &
            KW_TH_PART])) cycle
         call read_th(draft%deck, block, th)
         allocate (there(th%object%n), source=.true.)
         do k = 1, th%object%n
            if (draft%deck%block(block)%keyword == KW_TH_NODE) then
               i = find(draft%node, th%object%value(k))
               if (i > 0) there(k) = keep%node(i)
            else if (draft%deck%block(block)%keyword == KW_TH_SPRING) then
               i = find(draft%elements%id, th%object%value(k))
               if (i > 0) there(k) = keep%spring(i)
            else if (draft%deck%block(block)%keyword == KW_TH_PART) then
               i = find(draft%part, th%object%value(k))
               if (i > 0) there(k) = keep%part(i)
            end if
         end do
         if (any(there) .or. th%all) call write_request(draft%deck, block, th, there, page)
         lost = lost + count(.not. there)
         if (at == 0 .and. lost > 0) at = block
         deallocate (there)
      end do
      if (lost > 0) call report_header(draft%deck, at, SEV_NOTE, 'KJ-9414', &
         'requests of nodes, springs and parts that are not in the mechanism are left out', &
         str(lost)//' from here on')
   end subroutine write_requests

   !> The names of a request, and the cards of its objects that are there
   subroutine write_request(deck, block, th, there, page)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block
      type(th_t), intent(in) :: th
      logical, intent(in) :: there(:)
      type(page_t), intent(inout) :: page

      character(len=100) :: card
      integer :: line, k, n

      call put_header(page, deck, block)
      do line = deck%block(block)%first, deck%block(block)%last
         if (any(th%object%line(:th%object%n) == line)) then
            if (.not. any(there .and. th%object%line(:th%object%n) == line)) cycle
            if (deck%block(block)%keyword /= KW_TH_PART) then
               call put_copy(page, deck, line)
               cycle
            end if
            card = ''                            ! of several parts some may be there
            n = 0
            do k = 1, th%object%n
               if (th%object%line(k) /= line .or. .not. there(k)) cycle
               card(n + 1:n + 10) = integer_field(th%object%value(k))
               n = n + 10
            end do
            call put(page, card(:n))
         else
            call put_copy(page, deck, line)
         end if
      end do
   end subroutine write_request

   !> An empty page
   subroutine new_page(page)
      type(page_t), intent(out) :: page

      page%text = ''
      allocate (page%origin(1024), source=0)
   end subroutine new_page

   !> Append a line
   subroutine put(page, line, origin)
      type(page_t), intent(inout) :: page
      character(len=*), intent(in) :: line
      integer, intent(in), optional :: origin

      call put_text(line//achar(10), page%n, page%text)
      page%n = page%n + len(line) + 1
      page%n_line = page%n_line + 1
      if (page%n_line > size(page%origin)) call lengthen(page%origin)
      page%origin(page%n_line) = 0
      if (present(origin)) page%origin(page%n_line) = origin
   end subroutine put

   !> Append a copy of a line of a deck
   subroutine put_copy(page, deck, line)
      type(page_t), intent(inout) :: page
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line                !! index in deck

      call put(page, line_text(deck, line), line)
   end subroutine put_copy

end module kj_extract
