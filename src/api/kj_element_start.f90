!> First state of the joints of a host, and its attitudes as quaternions.
module kj_element_start
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_math3, only: cross
   use kj_state, only: new_state
   use kj_c_body, only: columns
   use kj_c_blocking, only: start_scene
   use kj_c_bound, only: new_bound
   use kj_element, only: joint_set_t, shear_angle
   implicit none
   private

   public :: begin_state, columns_of, host_quaternion, check_attitude, turned

contains

   !> State at the start, when all constants stand. Errors: those of start_scene
   subroutine begin_state(set, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      integer :: i

      associate (n => set%model%n_lead)
         allocate (set%quat_host(4, n), source=0.0_wp)
         set%quat_host(1, :) = 1.0_wp
         do i = 1, n
            if (present(attitude) .and. set%host(i) > 0) &
               set%quat_host(:, i) = host_quaternion(set, attitude, set%host(i))
         end do
         if (set%legacy) then
            call new_state(set%model, set%state)
         else
            call start_scene(set%model, .false., set%c, set%cs, error)
            if (allocated(error)) return
            call new_bound(set%model, set%c, .false., set%cs, set%bound)
            allocate (set%cs%f_ahead(n, 3), set%cs%t_ahead(n, 3), source=0.0_wp)
         end if
      end associate
      allocate (set%shear0(size(set%shear_of)))
      do i = 1, size(set%shear0)
         set%shear0(i) = shear_angle(set%model%x0(set%shear_node(:, i), :))
      end do
      allocate (set%warned(set%model%n_joint), source=.false.)
      set%started = .true.
   end subroutine begin_state

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

   !> Attitude `first` turned as the host has turned from q0 to q1: q1 q0^-1 first
   pure function turned(q1, q0, first) result(q)
      real(wp), intent(in) :: q1(4), q0(4), first(4)
      real(wp) :: q(4)

      q = product_of(product_of(q1, [q0(1), -q0(2:4)]), first)
      q = q/norm2(q)
   end function turned

   pure function product_of(a, b) result(c)
      real(wp), intent(in) :: a(4), b(4)
      real(wp) :: c(4)

      c(1) = a(1)*b(1) - dot_product(a(2:4), b(2:4))
      c(2:4) = a(1)*b(2:4) + b(1)*a(2:4) + cross(a(2:4), b(2:4))
   end function product_of

end module kj_element_start
