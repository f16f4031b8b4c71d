!> Fields of single joints from outside, "901.Kn=1e8,901.SA+_rx=0.5": the joint gets a copy of its
!> property, read again with these values.
module kj_joint_setting
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, add_finding, finding_list_t, ERR_INPUT
   use kj_number, only: parse_real, NUMBER_FINE
   use kj_cards, only: cards_t, read_cards, put_real
   use kj_draft, only: draft_t, property_t
   use kj_spelling, only: did_you_mean
   use kj_build_property, only: read_property
   implicit none
   private

   public :: set_fields, report_unset

contains

   !> The fields that are set for a joint: its property becomes one of its own. Values are in work
   !> units.
   !>
   !> Errors: findings KJ-9431 for an unknown field or no number, those of a property
   subroutine set_fields(draft, id, property)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: id                  !! of the element
      integer, intent(inout) :: property         !! place in draft%properties

      type(cards_t) :: cards
      type(property_t) :: own
      type(finding_list_t) :: before
      integer :: i

      if (.not. allocated(draft%joint_setting)) return
      do i = 1, size(draft%joint_setting)
         if (joint_of(draft, i) /= str(id)) cycle
         draft%joint_set(i) = .true.
         if (cards%n == 0) then                  ! what its cards have to say is said already
            before = draft%deck%findings
            call read_cards(draft%deck, draft%property_block(property), cards)
            draft%deck%findings = before
         end if
         call put_field(draft, i, cards)
      end do
      if (cards%n == 0) return
      call read_property(draft, cards, own)
      draft%properties = [draft%properties, own]
      property = size(draft%properties)
   end subroutine set_fields

   !> One value; a field K_rx is also Krx, as /PROP/KJOINT has it, and kn is Kn
   subroutine put_field(draft, i, cards)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: i                   !! place among the settings
      type(cards_t), intent(inout) :: cards

      type(error_t), allocatable :: error
      real(wp) :: value
      integer :: dot, line, status
      logical :: found

      associate (name => draft%joint_setting(i)%name, text => draft%joint_setting(i)%value)
         call parse_real(text, value, status)
         dot = index(name, '.')
         line = index(name, '_')
         call put_real(cards, name(dot + 1:), value, found)
         if (.not. found .and. line > dot) call put_real(cards, name(dot + 1:line - 1)// &
            name(line + 1:), value, found)
         if (found .and. status == NUMBER_FINE) return
         if (found) then
            call fail(error, ERR_INPUT, '"'//text//'" is no number for '//name, 'KJ-9431')
         else
            call fail(error, ERR_INPUT, 'joint '//name(:dot - 1)//' has no number '// &
               name(dot + 1:), 'KJ-9431')
            error%hint = trim(did_you_mean(name(dot + 1:), pack(cards%name, cards%is_real)))
         end if
         call add_finding(draft%deck%findings, error)
      end associate
   end subroutine put_field

   !> Settings for joints that there are not. Errors: findings KJ-9430
   subroutine report_unset(draft)
      type(draft_t), intent(inout) :: draft

      type(error_t), allocatable :: error
      integer :: i

      if (.not. allocated(draft%joint_setting)) return
      do i = 1, size(draft%joint_setting)
         if (draft%joint_set(i)) cycle
         call fail(error, ERR_INPUT, 'there is no joint "'//joint_of(draft, i)// &
            '" to set a field of', 'KJ-9430')
         call add_finding(draft%deck%findings, error)
      end do
   end subroutine report_unset

   !> The joint that a setting means: its id as a text
   pure function joint_of(draft, i) result(id)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: i
      character(len=index(draft%joint_setting(i)%name//'.', '.') - 1) :: id

      id = draft%joint_setting(i)%name
   end function joint_of

end module kj_joint_setting
