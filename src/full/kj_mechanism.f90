!> The mechanism of a full deck: read it, take the mechanism out, read that as any deck.
!>
!> What runs is the text that `kjoint extract` writes: the file and the run in memory are one.
module kj_mechanism
   use kj_kinds, only: wp
   use kj_error, only: finding_list_t, add_finding
   use kj_sort, only: find, lower_bound
   use kj_keywords, only: KW_SPRING
   use kj_deck_text, only: deck_t, source_t, add_source, block_at, FLAT, PIECE
   use kj_deck, only: read_deck
   use kj_parameter, only: setting_t
   use kj_draft, only: draft_t
   use kj_model, only: model_t
   use kj_element_mass, only: scales_t, element_t, first_element, next_element, weigh
   use kj_full_draft, only: build_full_draft
   use kj_keep, only: keep_t, decide
   use kj_acts, only: check_unweighed
   use kj_text_block, only: page_t, new_page
   use kj_extract, only: write_mechanism
   use kj_extract_report, only: extract_report_t, new_report
   implicit none
   private

   public :: take_mechanism

   character(len=8), parameter :: ROLE = 'extract'

contains

   !> The deck of the mechanism; its lines that are copies keep their places in the full deck
   !>
   !> Errors: findings. deck%readable is .false. when there is no deck.
   subroutine take_mechanism(path, settings, findings, deck, report)
      character(len=*), intent(in) :: path
      type(setting_t), intent(in) :: settings(:) !! parameters from outside
      type(finding_list_t), intent(in) :: findings
      !> a new one, but for ignore_random; its findings are those of both decks
      type(deck_t), intent(inout) :: deck
      type(extract_report_t), intent(out) :: report

      type(draft_t) :: draft
      type(scales_t) :: scales
      type(model_t) :: model
      type(keep_t) :: keep
      type(page_t) :: page
      real(wp), allocatable :: element_mass(:), spring_mass(:), spring_inertia(:)
      integer, allocatable :: kept(:)
      integer :: i
      integer, allocatable :: files(:)

      draft%deck%findings = findings
      draft%deck%ignore_random = deck%ignore_random
      call read_deck(path, draft%deck, full=.true., settings=settings)
      if (draft%deck%readable) then
         call build_full_draft(draft, scales, element_mass, model)
         call check_unweighed(draft, scales)
      end if
      if (draft%deck%findings%n_error == count_late(draft%deck%findings) .and. &
         draft%deck%readable) then
         call decide(draft, element_mass, keep)
         kept = pack([(i, i=1, draft%n_node)], keep%node)
         call weigh_kept_springs(draft, scales, keep, kept, spring_mass, spring_inertia)
         call new_page(page)
         call write_mechanism(draft, model, keep, kept, spring_mass, spring_inertia, page)
         call new_report(draft, scales, model, keep, element_mass, report)
      end if
      deck%findings = draft%deck%findings
      deck%readable = draft%deck%findings%n_error == 0 .and. draft%deck%readable
      if (.not. deck%readable) return
      report%text = page%text(:page%n)
      call read_page(path, page, draft%deck, deck)
      call leave_repeats(draft%deck%findings%n, deck%findings)
      associate (role => deck%source(:deck%n_source)%role)
         files = pack([(i, i=2, deck%n_source)], role(2:) /= FLAT .and. role(2:) /= PIECE)
      end associate
      allocate (report%input(size(files)))
      do i = 1, size(files)
         report%input(i)%s = deck%source(files(i))%path
      end do
   end subroutine take_mechanism

   !> Errors of bodies that a sensor makes later: these can be weighed all the same
   pure integer function count_late(findings) result(n)
      type(finding_list_t), intent(in) :: findings

      n = 0
      if (findings%n > 0) n = count(findings%item(:findings%n)%id == 'KJ-9116')
   end function count_late

   !> Leave out what the full deck was told before: the format version, its units
   subroutine leave_repeats(n_full, findings)
      integer, intent(in) :: n_full              !! findings of the full deck, the first ones
      type(finding_list_t), intent(inout) :: findings

      type(finding_list_t) :: all
      integer :: i, k

      if (findings%n_left > 0) return            ! counts that no list explains
      all = findings
      findings = finding_list_t()
      do i = 1, all%n
         do k = 1, min(n_full, i - 1)
            if (all%item(k)%id == all%item(i)%id .and. all%item(k)%message == all%item(i)%message) &
               exit
         end do
         if (k > min(n_full, i - 1) .or. i <= n_full) call add_finding(findings, all%item(i))
      end do
   end subroutine leave_repeats

   !> Mass and inertia that kept springs put on nodes
   subroutine weigh_kept_springs(draft, scales, keep, kept, mass, inertia)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      type(keep_t), intent(in) :: keep
      integer, intent(in) :: kept(:)             !! raw indices of nodes, ascending
      real(wp), allocatable, intent(out) :: mass(:), inertia(:)   !! of these

      type(element_t) :: e
      integer :: block, i, at

      allocate (mass(size(kept)), inertia(size(kept)), source=0.0_wp)
      do block = 1, draft%deck%n_block
         if (draft%deck%block(block)%keyword /= KW_SPRING) cycle
         call first_element(draft, block, e)
         do
            call next_element(draft, e)
            if (e%row == 0) exit
            i = find(draft%elements%id, e%id)
            if (i == 0) cycle
            if (.not. keep%spring(i)) cycle
            call weigh(draft, scales, e)
            do i = 1, 3
               if (e%raw(i) == 0 .or. .not. e%mass(i) > 0.0_wp) cycle
               at = lower_bound(kept, e%raw(i))
               mass(at) = mass(at) + e%mass(i)
               inertia(at) = inertia(at) + e%inertia(i)
            end do
         end do
      end do
   end subroutine weigh_kept_springs

   !> Read the text of the mechanism; lines that are copies point at what they are copies of
   subroutine read_page(path, page, full, deck)
      character(len=*), intent(in) :: path
      type(page_t), intent(in) :: page
      type(deck_t), intent(inout) :: full        !! its files move into `deck`
      type(deck_t), intent(inout) :: deck

      type(source_t) :: source
      integer :: i, k, first

      source%path = path//' (mechanism)'
      source%role = ROLE
      source%text = page%text(:page%n)
      call read_deck(path, deck, source=source)
      first = deck%n_source
      do i = 1, full%n_source
         call add_source(deck, full%source(i), k)
      end do
      do i = 1, deck%n_line
         if (deck%line_source(i) /= 1) cycle
         k = page%origin(deck%line_number(i))
         if (k == 0) cycle
         deck%line_source(i) = first + full%line_source(k)
         deck%line_number(i) = full%line_number(k)
         if (deck%block(max(1, block_at(deck, i)))%header == i) then      ! written anew: it stays
            deck%line_source(i) = 1
            cycle
         end if
         deck%line_first(i) = full%line_first(k)
         deck%line_last(i) = full%line_last(k)
      end do
   end subroutine read_page

end module kj_mechanism
