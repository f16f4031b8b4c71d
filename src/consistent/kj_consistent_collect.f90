!> Boundary conditions and imposed motions, gathered lead by lead.
!> Source: docs/theory/consistent.md 7.
module kj_consistent_collect
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_consistent_state, only: consistent_model_t, hold_t, row_t
   implicit none
   private

   public :: collect_holds, at_rest, all_blocked

contains

   !> Conditions and imposed motions of each lead as rows
   subroutine collect_holds(model)
      type(consistent_model_t), intent(inout) :: model

      type(hold_t), allocatable :: hold(:)
      integer :: i, k, n
      type(row_t) :: row

      model%hold_of = 0
      allocate (hold(size(model%bcs) + size(model%motion)))
      n = 0
      do i = 1, size(model%bcs)
         do k = 1, 6
            if (.not. model%bcs(i)%fixed(k)) cycle
            row%dir = k
            row%skew = model%bcs(i)%skew
            row%motion = 0
            call add_row(model%bcs(i)%lead, row)
         end do
      end do
      do i = 1, size(model%motion)
         row%dir = model%motion(i)%dir
         row%skew = model%motion(i)%skew
         row%motion = i
         call add_row(model%motion(i)%lead, row)
      end do
      call sort_holds(hold(:n), model)
   contains
      subroutine add_row(lead, new)
         integer, intent(in) :: lead
         type(row_t), intent(in) :: new

         integer :: at

         ! a node without inertia does not turn at all
         if (new%dir > 3 .and. .not. model%inertia(lead) > 0.0_wp) return
         if (model%hold_of(lead) == 0) then
            n = n + 1
            model%hold_of(lead) = n
            hold(n)%lead = lead
         end if
         at = model%hold_of(lead)
         if (new%dir <= 3) then
            if (hold(at)%n_trans == 3) return
            hold(at)%n_trans = hold(at)%n_trans + 1
            hold(at)%trans(hold(at)%n_trans) = new
         else
            if (hold(at)%n_rot == 3) return
            hold(at)%n_rot = hold(at)%n_rot + 1
            hold(at)%rot(hold(at)%n_rot) = new
         end if
      end subroutine add_row
   end subroutine collect_holds

   !> Conditions by ascending lead, and how many there are up to each block of leads
   pure subroutine sort_holds(hold, model)
      type(hold_t), intent(in) :: hold(:)
      type(consistent_model_t), intent(inout) :: model

      integer :: lead, n

      allocate (model%hold(size(hold)), model%hold_to(0:(size(model%hold_of) + BLOCK - 1)/BLOCK))
      model%hold_to(0) = 0
      n = 0
      do lead = 1, size(model%hold_of)
         if (model%hold_of(lead) > 0) then
            n = n + 1
            model%hold(n) = hold(model%hold_of(lead))
            model%hold_of(lead) = n
         end if
         model%hold_to((lead + BLOCK - 1)/BLOCK) = n
      end do
   end subroutine sort_holds

   !> Leads that are blocked in all directions
   pure function at_rest(model) result(rests)
      type(consistent_model_t), intent(in) :: model
      logical :: rests(size(model%hold_of))

      integer :: i

      rests = .false.
      do i = 1, size(model%hold)
         associate (hold => model%hold(i))
            rests(hold%lead) = all_blocked(hold%trans, hold%n_trans) .and. &
               all_blocked(hold%rot, hold%n_rot)
         end associate
      end do
   end function at_rest

   !> Rows hold three directions, and none is driven
   pure logical function all_blocked(rows, n) result(blocked)
      type(row_t), intent(in) :: rows(3)
      integer, intent(in) :: n

      blocked = n == 3 .and. all(rows%motion == 0)
   end function all_blocked

end module kj_consistent_collect
