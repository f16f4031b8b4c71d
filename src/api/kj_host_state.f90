!> State of the joints of a host as a flat array: saved, and restored to go on with the same bits.
module kj_host_state
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_legacy_joint, only: legacy_joint_t
   use kj_block, only: rows_at, block_of, lane_of
   use kj_consistent_batch, only: consistent_joint_t
   use kj_host, only: joint_set_t
   use kj_host_scheme, only: follows_nodes
   implicit none
   private

   public :: joint_state_size, save_joints, restore_joints

   real(wp), parameter :: VERSION = 2.0_wp        !! of the layout
   integer, parameter :: HEAD = 6                 !! version, formulation, joints, size, time, step

   !> Where packing stands
   type :: tape_t
      real(wp), allocatable :: a(:)
      integer :: at = 0                          !! numbers passed so far
      logical :: write = .false.                 !! into the array, else out of it
   end type tape_t

contains

   !> Numbers in the state of a set, 0 before the start
   integer function joint_state_size(set) result(n)
      type(joint_set_t), intent(in) :: set

      type(tape_t) :: tape

      n = 0
      if (.not. set%started) return
      allocate (tape%a(0))
      call read_state(set, tape)
      n = HEAD + tape%at
   end function joint_state_size

   !> State of all joints. Errors: ERR_INPUT when the array has not joint_state_size(set) numbers
   subroutine save_joints(set, state, error)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(inout) :: state(:)
      type(error_t), allocatable, intent(out) :: error

      type(tape_t) :: tape

      call check_size(set, size(state), error)
      if (allocated(error)) return
      allocate (tape%a(size(state)))
      state(:HEAD) = heading(set, size(state))
      tape%write = .true.
      call read_state(set, tape)
      state(HEAD + 1:) = tape%a(:size(state) - HEAD)
   end subroutine save_joints

   !> Go back to a saved state of the same joints.
   !>
   !> Errors: ERR_INPUT when the array is not a state of these joints; they are as before then.
   subroutine restore_joints(set, state, error)
      type(joint_set_t), intent(inout) :: set
      real(wp), intent(in) :: state(:)
      type(error_t), allocatable, intent(out) :: error

      type(tape_t) :: tape

      call check_size(set, size(state), error)
      if (allocated(error)) return
      associate (expected => heading(set, size(state)))
         if (any(abs(state(:4) - expected(:4)) > 0.0_wp) .or. &
            .not. all(ieee_is_finite(state(:HEAD)))) then
            call fail(error, ERR_INPUT, 'the array is no state of these joints')
            return
         end if
      end associate
      tape%a = state(HEAD + 1:)
      call pass_state(set%model%batch%n, set%state%joint, set%cs%joint, tape)
      set%time = state(5)
      set%h_last = state(6)
   end subroutine restore_joints

   subroutine check_size(set, n, error)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: n
      type(error_t), allocatable, intent(out) :: error

      if (.not. set%started) then
         call fail(error, ERR_INPUT, 'the joints have not been started')
      else if (n /= joint_state_size(set)) then
         call fail(error, ERR_INPUT, 'the state has '//str(joint_state_size(set))// &
            ' numbers, not '//str(n))
      end if
   end subroutine check_size

   pure function heading(set, n) result(a)
      type(joint_set_t), intent(in) :: set
      integer, intent(in) :: n
      real(wp) :: a(HEAD)

      a = [VERSION, merge(1.0_wp, 2.0_wp, follows_nodes(set)), real(set%model%n_joint, wp), &
         real(n, wp), set%time, set%h_last]
   end function heading

   !> State of all batches onto the tape, or its size
   subroutine read_state(set, tape)
      type(joint_set_t), intent(in) :: set
      type(tape_t), intent(inout) :: tape

      type(legacy_joint_t), allocatable :: legacy(:)
      type(consistent_joint_t), allocatable :: consistent(:)
      legacy = set%state%joint
      consistent = set%cs%joint
      call pass_state(set%model%batch%n, legacy, consistent, tape)
   end subroutine read_state

   !> State of all batches onto the tape or off it; of one formulation there are none
   subroutine pass_state(n, legacy, consistent, tape)
      integer, intent(in) :: n(:)                !! joints of each batch
      type(legacy_joint_t), intent(inout) :: legacy(:)
      type(consistent_joint_t), intent(inout) :: consistent(:)
      type(tape_t), intent(inout) :: tape

      integer :: b

      do b = 1, size(legacy)
         call pass_legacy(n(b), legacy(b), tape)
      end do
      do b = 1, size(consistent)
         call pass_consistent(n(b), consistent(b), tape)
      end do
   end subroutine pass_state

   subroutine pass_legacy(n, joint, tape)
      integer, intent(in) :: n                   !! joints
      type(legacy_joint_t), target, intent(inout) :: joint
      type(tape_t), intent(inout) :: tape

      integer :: i, at

      do i = 1, n
         at = block_of(i)
         call pass_row(c_loc(joint%block(at)), storage_size(joint%block), lane_of(i), tape)
         if (allocated(joint%spring)) &
            call pass_row(c_loc(joint%spring(at)), storage_size(joint%spring), lane_of(i), tape)
         if (allocated(joint%limit)) &
            call pass_row(c_loc(joint%limit(at)), storage_size(joint%limit), lane_of(i), tape)
      end do
   end subroutine pass_legacy

   subroutine pass_consistent(n, joint, tape)
      integer, intent(in) :: n                   !! joints
      type(consistent_joint_t), target, intent(inout) :: joint
      type(tape_t), intent(inout) :: tape

      integer :: i, at

      do i = 1, n
         at = block_of(i)
         call pass_row(c_loc(joint%block(at)), storage_size(joint%block), lane_of(i), tape)
         if (allocated(joint%spring)) &
            call pass_row(c_loc(joint%spring(at)), storage_size(joint%spring), lane_of(i), tape)
         if (allocated(joint%limit)) &
            call pass_row(c_loc(joint%limit(at)), storage_size(joint%limit), lane_of(i), tape)
      end do
   end subroutine pass_consistent

   !> What goes with a joint of the block at an address
   subroutine pass_row(block_at, bits, lane, tape)
      type(c_ptr), intent(in) :: block_at
      integer, intent(in) :: bits, lane          !! size of the block, place in it
      type(tape_t), intent(inout) :: tape

      real(wp), pointer :: row(:, :)

      call rows_at(block_at, bits, row)
      call pass(row(lane, :), tape)
   end subroutine pass_row

   !> Numbers onto the tape, off it, or, when it is empty, only counted
   subroutine pass(values, tape)
      real(wp), intent(inout) :: values(:)
      type(tape_t), intent(inout) :: tape

      associate (from => tape%at + 1, to => tape%at + size(values))
         if (size(tape%a) >= to) then
            if (tape%write) tape%a(from:to) = values
            if (.not. tape%write) values = tape%a(from:to)
         end if
         tape%at = tape%at + size(values)
      end associate
   end subroutine pass

end module kj_host_state
