!> First state of the joints of a host, and its attitudes as quaternions.
module kj_host_start
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_math3, only: quaternion_product
   use kj_joint_batch, only: is_spring
   use kj_legacy_state, only: new_legacy_state
   use kj_consistent_body, only: columns
   use kj_consistent_auto_stiffness, only: start_scene
   use kj_consistent_build, only: build_consistent_model, new_consistent_state
   use kj_consistent_safe_step, only: new_bound
   use kj_host, only: joint_set_t, shear_angle
   implicit none
   private

   public :: begin_state, columns_of, host_quaternion, check_attitude, turned

contains

   !> State at the start, when all constants stand; then what only the start needs goes.
   !>
   !> Errors: those of start_scene
   subroutine begin_state(set, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      call begin_shear(set)
      if (set%legacy) then
         call new_legacy_state(set%model%model_t, set%state)
         call drop_legacy(set)
      else
         call begin_consistent(set, error, attitude)
         if (allocated(error)) return
      end if
      allocate (set%warned(set%model%n_joint), source=.false.)
      set%started = .true.
   end subroutine begin_state

   !> Errors: those of start_scene
   subroutine begin_consistent(set, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      integer :: i

      associate (n => set%model%n_lead)
         if (any(set%model%batch%limited)) then
            call start_scene(set%model, .false., set%cs, error)
            if (allocated(error)) return
         else
            call build_consistent_model(set%model)
            call drop_constants(set)
            call new_consistent_state(set%model, set%cs, lean=.not. reads_nodes(set))
         end if
         deallocate (set%model%v0, set%model%w0, set%cs%impulse, set%cs%angular_impulse, &
            set%cs%turn)
         if (.not. reads_nodes(set)) then
            deallocate (set%model%axes0, set%cs%node)
            allocate (set%cs%node(0, 3))
         end if
         call move_alloc(set%model%quat0, set%quat_own)
         if (present(attitude)) then
            do i = 1, n
               if (set%host(i) > 0) set%quat_own(i, :) = &
                  seen_from(host_quaternion(set, attitude, set%host(i)), set%quat_own(i, :))
            end do
         end if
         call new_bound(set%model, .false., set%cs, set%bound)
         allocate (set%cs%f_ahead(n, 3), set%cs%t_ahead(n, 3), source=0.0_wp)
      end associate
   end subroutine begin_consistent

   !> Angles of the measured skews, and where those of each joint begin
   subroutine begin_shear(set)
      type(joint_set_t), intent(inout) :: set

      integer :: i, j

      allocate (set%shear0(size(set%shear_of)))
      do i = 1, size(set%shear0)
         set%shear0(i) = shear_angle(set%model%x0(set%shear_node(:, i), :))
      end do
      allocate (set%shear_first(set%model%n_joint + 1), source=1)
      do i = 1, size(set%shear_of)
         j = abs(set%shear_of(i))
         set%shear_first(j + 1) = set%shear_first(j + 1) + 1
      end do
      do j = 1, set%model%n_joint
         set%shear_first(j + 1) = set%shear_first(j + 1) + set%shear_first(j) - 1
      end do
   end subroutine begin_shear

   !> What the host owns, or only the start needs: motion of bodies and nodes, first frames
   subroutine drop_legacy(set)
      type(joint_set_t), intent(inout) :: set

      integer :: b

      associate (s => set%state, m => set%model%model_t)
         deallocate (s%d, s%v, s%a, s%al, s%impulse, s%angular_impulse, s%rotation_sum, s%p, &
            s%principal, s%crew%first, s%crew%node, s%crew%kept, s%crew%few, m%v0, m%w0, m%axes, &
            m%principal, m%node_id, m%body_id, m%n_secondary)
         do b = 1, size(m%batch)
            deallocate (m%batch(b)%frame0, m%batch(b)%angle0)
         end do
      end associate
   end subroutine drop_legacy

   !> Places of other nodes than carriers are read: skews are measured, or conditions read them
   pure logical function reads_nodes(set)
      type(joint_set_t), intent(in) :: set

      reads_nodes = size(set%shear_of) > 0 .or. size(set%model%placed) > 0
   end function reads_nodes

   !> What the constants of the consistent formulation stand for now
   subroutine drop_constants(set)
      type(joint_set_t), intent(inout) :: set

      integer :: b

      associate (m => set%model%model_t)
         do b = 1, size(m%batch)
            deallocate (m%batch(b)%node, m%batch(b)%skew)
            if (.not. is_spring(m%batch(b))) deallocate (m%batch(b)%frame0)
         end do
         deallocate (m%axes, m%principal, m%node_id, m%body_id, m%n_secondary)
         if (reads_nodes(set)) return
         m%x0 = m%x0(:m%n_lead, :)
         m%v0 = m%v0(:m%n_lead, :)
         deallocate (set%model%arm)
      end associate
   end subroutine drop_constants

   !> Attitudes have the right shape, and are there when they must be
   subroutine check_attitude(set, needed, error, attitude)
      type(joint_set_t), intent(in) :: set
      logical, intent(in) :: needed
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      integer :: wanted(2), i

      if (.not. present(attitude)) then
         if (needed) call fail(error, ERR_INPUT, &
            'the consistent formulation needs the attitudes of the carriers')
         return
      end if
      wanted = [4, set%n_host]
      if (set%by_component) wanted = wanted(2:1:-1)
      if (any(shape(attitude) /= wanted)) then
         call fail(error, ERR_INPUT, 'the array attitude is ('//str(size(attitude, 1))//', '// &
            str(size(attitude, 2))//'), expected: ('//str(wanted(1))//', '//str(wanted(2))//')')
         return
      end if
      if (.not. allocated(set%host)) return
      do i = 1, set%model%n_lead
         if (set%host(i) == 0) cycle
         if (all(ieee_is_finite(host_quaternion(set, attitude, set%host(i))))) cycle
         call fail(error, ERR_INPUT, 'attitude of node '//str(set%host(i))// &
            ' is not a quaternion other than zero')
         return
      end do
   end subroutine check_attitude

   !> Unit quaternion w x y z of a host node; not finite where it has none
   pure function host_quaternion(set, attitude, node) result(q)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: attitude(:, :)
      integer, intent(in) :: node
      real(wp) :: q(4)

      if (set%by_component) then
         q = attitude(node, :)
      else
         q = attitude(:, node)
      end if
      q = q/norm2(q)
   end function host_quaternion

   !> Axes of a quaternion as columns
   pure function columns_of(q) result(e)
      real(wp), intent(in) :: q(4)
      real(wp) :: e(9)

      e = columns(q)
   end function columns_of

   !> Attitude q in the axes of attitude p: p^-1 q
   pure function seen_from(p, q) result(own)
      real(wp), intent(in) :: p(4), q(4)
      real(wp) :: own(4)

      own = quaternion_product([p(1), -p(2:4)], q)
   end function seen_from

   !> Attitude `own` in the axes of attitude p, seen from the world: p own
   pure function turned(p, own) result(q)
      real(wp), intent(in) :: p(4), own(4)
      real(wp) :: q(4)

      q = quaternion_product(p, own)
      q = q/norm2(q)
   end function turned

end module kj_host_start
