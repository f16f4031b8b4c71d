!> Joints -> batches of one kind, type, frame rule and law signature.
module kj_build_batch
   use kj_kinds, only: wp
   use kj_joint_types, only: joint_types, NDOF
   use kj_joint_batch, only: joint_batch_t, limits_t, new_batch, new_limits, is_spring, &
      LAW_SPRING, LAW_DAMPER
   use kj_lead_map, only: build_lead_map
   use kj_joint_draft, only: property_t, joint_t
   use kj_model, only: model_t
   implicit none
   private

   public :: fill_batches

contains

   !> Sort the joints into batches of one kind, type, frame rule and law signature
   subroutine fill_batches(property, joint, model)
      type(property_t), intent(in) :: property(:)
      type(joint_t), intent(in) :: joint(:)
      type(model_t), intent(inout) :: model

      integer, allocatable :: key(:, :), batch_of(:), ends(:, :), count_of(:)
      integer :: j, b, n, mine(NDOF + 4)

      allocate (key(NDOF + 4, size(joint)), batch_of(size(joint)), count_of(size(joint)))
      n = 0
      do j = 1, size(joint)
         associate (p => property(joint(j)%property))
            mine = [p%row, p%frame, p%kind, merge(1, 0, p%limited), joint(j)%law]
            if (joint(j)%rule > 0) mine(2) = joint(j)%rule
         end associate
         do b = 1, n
            if (all(key(:, b) == mine)) exit
         end do
         if (b > n) then
            n = b
            key(:, b) = mine
            count_of(b) = 0
         end if
         batch_of(j) = b
         count_of(b) = count_of(b) + 1
      end do
      allocate (model%batch(n), ends(2, size(joint)))
      do b = 1, n
         call new_batch(count_of(b), model%batch(b))
         model%batch(b)%first = sum(count_of(:b - 1))
         model%batch(b)%row = key(1, b)
         model%batch(b)%frame = key(2, b)
         model%batch(b)%kind = key(3, b)
         model%batch(b)%law = key(5:, b)
         if (key(4, b) == 1) call new_limits(model%batch(b))
      end do
      count_of(:n) = 0
      do j = 1, size(joint)
         b = batch_of(j)
         count_of(b) = count_of(b) + 1
         call put_joint(property(joint(j)%property), joint(j), model%lead, count_of(b), &
            model%batch(b))
         ends(:, model%batch(b)%first + count_of(b)) = model%lead(joint(j)%node)
         model%joint(j)%batch = b
         model%joint(j)%place = count_of(b)
         model%joint(j)%node = joint(j)%node
         model%joint(j)%row = key(1, b)
         model%joint(j)%property = property(joint(j)%property)%id
      end do
      call build_lead_map(model%n_lead, ends, model%map)
   end subroutine fill_batches

   !> Constants of one joint into place i of its batch
   pure subroutine put_joint(p, joint, lead, i, batch)
      type(property_t), intent(in) :: p
      type(joint_t), intent(in) :: joint
      integer, intent(in) :: lead(:), i
      type(joint_batch_t), intent(inout) :: batch

      integer :: dof, s

      batch%node(i, :) = joint%node
      batch%lead(i, :) = lead(joint%node)
      batch%skew(i, :) = joint%skew
      batch%xl0(i, :) = joint%xl0
      batch%frame0(i, :) = reshape(joint%frame, [9])
      batch%k(i, :) = joint%k
      batch%c(i, :) = joint%c
      batch%angle0(i, :) = joint%angle
      batch%cr(i) = p%cr
      if (all(joint_types(p%row)%free == 1)) batch%cr(i) = 0.0_wp
      batch%reduced(i, :) = joint%reduced
      batch%k_curve(i, :) = p%k_curve
      batch%c_curve(i, :) = p%c_curve
      do dof = 1, NDOF
         s = merge(1, 2, dof <= 3)
         if (iand(joint%law(dof), LAW_SPRING) /= 0) &
            batch%k_top(i, s) = max(batch%k_top(i, s), joint%k(dof))
         if (iand(joint%law(dof), LAW_DAMPER) /= 0 .and. joint_types(p%row)%free(dof) == 1) &
            batch%c_top(i, s) = max(batch%c_top(i, s), joint%c(dof))
      end do
      if (is_spring(batch)) then
         batch%k_top(i, :) = joint%top(1:2)
         batch%c_top(i, :) = joint%top(3:4)
      end if
      if (batch%limited) call put_limits(p, joint, i, batch%limit)
   end subroutine put_joint

   pure subroutine put_limits(p, joint, i, limit)
      type(property_t), intent(in) :: p
      type(joint_t), intent(in) :: joint
      integer, intent(in) :: i
      type(limits_t), intent(inout) :: limit

      limit%lo(i, :) = p%lo
      limit%hi(i, :) = p%hi
      limit%combined(i, :) = real(p%combined, wp)
      limit%k(i, :) = p%k_limit
      limit%slip(i, :) = p%slip
      limit%slip_curve(i, :) = p%slip_curve
      limit%cr(i) = p%cr
      limit%cr_stop(i) = p%cr_stop
      limit%k_block(i, :) = joint%k_block
      limit%automatic(i) = p%automatic
      limit%scale(i) = p%scf
      limit%t_lock(i) = p%t_lock
      limit%t_free(i) = p%t_free
   end subroutine put_limits

end module kj_build_batch
