!> What is odd in a scene that can be built all the same: joints that hold nothing, or not where one
!> thinks, and conditions that contradict each other.
module kj_check_scene
   use kj_kinds, only: wp
   use kj_error, only: str, SEV_WARNING
   use kj_math3, only: cross, IDENTITY
   use kj_joint_types, only: joint_types
   use kj_joint_batch, only: KJOINT2, has_friction
   use kj_cards, only: cards_t, report, report_row
   use kj_draft, only: draft_t, property_t, joint_t
   use kj_model, only: model_t, motion_t
   implicit none
   private

   public :: warn_of_ends, warn_of_conflict

   real(wp), parameter :: OFF = 1.0e-3_wp       !! of the arm: nodes of a joint so far apart
   real(wp), parameter :: ALONG = 1.0e-6_wp     !! cosine of two directions that are not square

contains

   !> Both ends on one body; an end that has no rotation where the joint acts on it; nodes apart
   !> across the axis of a rotation
   subroutine warn_of_ends(draft, model, properties, joint)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: properties(:)
      type(joint_t), intent(in) :: joint(:)     !! (>= n_joint) joints first, then springs

      integer :: j, e, lead(2)

      do j = 1, model%n_joint
         associate (card => joint(j)%card, p => properties(joint(j)%property))
            lead = model%lead(joint(j)%node)
            if (lead(1) == lead(2)) then
               call report_row(draft%deck, card, 'n2', SEV_WARNING, 'KJ-9073', &
                  'both ends of the joint are on rigid body '//str(model%body_id(lead(1)))// &
                  ': it holds nothing', 'on the body of n1', 'expected: nodes of two bodies')
               cycle
            end if
            do e = 1, 2
               if (p%kind /= KJOINT2 .or. turns(lead(e))) cycle
               if (.not. (has_moments(p) .or. (turns(lead(3 - e)) .and. &
                  any(joint_types(p%row)%free(4:) == 0)))) cycle
               call report_row(draft%deck, card, 'n'//str(e), SEV_WARNING, 'KJ-9074', 'node '// &
                  str(model%node_id(joint(j)%node(e)))//' has no inertia: the joint holds its '// &
                  'place, but no rotation', 'a node with mass alone', &
                  'make it a secondary node of a rigid body')
            end do
            call warn_of_lever(draft, model, p, joint(j))
         end associate
      end do

   contains

      !> The lead has a rotation
      pure logical function turns(lead)
         integer, intent(in) :: lead

         turns = lead <= model%n_body .or. model%inertia(lead) > 0.0_wp
      end function turns
   end subroutine warn_of_ends

   !> The joint has a law on a rotation
   pure logical function has_moments(p)
      type(property_t), intent(in) :: p

      has_moments = any(abs(p%k(4:)) > 0.0_wp) .or. any(abs(p%c(4:)) > 0.0_wp) .or. &
         any(p%k_curve(4:) > 0) .or. any(p%c_curve(4:) > 0) .or. &
         any(p%lo(4:) < 0.0_wp) .or. any(p%hi(4:) > 0.0_wp) .or. &
         any(has_friction(p%k_limit(4:), p%slip(4:), p%slip_curve(4:)))
   end function has_moments

   !> A free rotation moves node 2 against node 1 along a blocked direction: the pivot is not at the
   !> nodes. Measured against the largest distance of an end from the centre of its body.
   subroutine warn_of_lever(draft, model, p, joint)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model
      type(property_t), intent(in) :: p
      type(joint_t), intent(in) :: joint

      character(len=11) :: apart
      real(wp) :: moved(3), most, arm
      integer :: axis, e

      most = 0.0_wp
      arm = 0.0_wp
      do axis = 1, 3
         if (joint_types(p%row)%free(3 + axis) == 0) cycle
         moved = cross(IDENTITY(:, axis), joint%xl0)
         where (joint_types(p%row)%free(:3) == 1) moved = 0.0_wp
         most = max(most, norm2(moved))
      end do
      do e = 1, 2
         associate (lead => model%lead(joint%node(e)))
            arm = max(arm, norm2(model%x0(joint%node(e), :) - model%x0(lead, :)))
         end associate
      end do
      if (.not. most > OFF*arm) return
      write (apart, '(es11.3)') most
      call report_row(draft%deck, joint%card, 'n2', SEV_WARNING, 'KJ-9075', 'the nodes of the '// &
         trim(joint_types(p%row)%name)//' joint stand '//trim(adjustl(apart))// &
         ' apart across its axis: it turns about neither', 'expected: the place of n1', &
         'give both nodes one place')
   end subroutine warn_of_lever

   !> A motion whose direction is held by a /BCS, or driven by one of the motions before it at the
   !> same time
   subroutine warn_of_conflict(draft, model, cards, node_id, motion, before)
      type(draft_t), intent(inout) :: draft
      type(model_t), intent(in) :: model        !! with its conditions
      type(cards_t), intent(in) :: cards        !! of the motion
      integer, intent(in) :: node_id
      type(motion_t), intent(in) :: motion
      type(motion_t), intent(in) :: before(:)   !! others of the same lead

      real(wp) :: axis(3)
      integer :: i, k

      axis = axis_of(motion)
      do i = 1, size(model%bcs)
         if (model%bcs(i)%lead /= motion%lead) cycle
         do k = 1, 3
            if (.not. model%bcs(i)%fixed(k + 3*((motion%dir - 1)/3))) cycle
            associate (e => draft%skews%axes(model%bcs(i)%skew, 3*k - 2:3*k))
               if (abs(dot_product(axis, e)) <= ALONG) cycle
            end associate
            call say('held by a /BCS')
            return
         end do
      end do
      do i = 1, size(before)
         if ((before(i)%dir > 3) .neqv. (motion%dir > 3)) cycle
         if (abs(dot_product(axis, axis_of(before(i)))) <= ALONG) cycle
         if (max(before(i)%t_start, motion%t_start) >= min(before(i)%t_stop, motion%t_stop)) cycle
         call say('driven by another motion')
         return
      end do

   contains

      !> Direction of a motion at the start, W
      pure function axis_of(m) result(axis)
         type(motion_t), intent(in) :: m
         real(wp) :: axis(3)

         integer :: k

         k = modulo(m%dir - 1, 3) + 1
         axis = draft%skews%axes(m%skew, 3*k - 2:3*k)
      end function axis_of

      subroutine say(how)
         character(len=*), intent(in) :: how

         call report(draft%deck, cards, 'dir', SEV_WARNING, 'KJ-0312', 'node '//str(node_id)// &
            ' is driven in a direction in which it is '//how, 'one of the two does not act', &
            'remove one; under --legacy the energies are wrong, as those of OpenRadioss')
      end subroutine say
   end subroutine warn_of_conflict

end module kj_check_scene
