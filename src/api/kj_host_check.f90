!> Checks of what a host hands over at the element level: a wrong call gives an error, never a
!> crash.
module kj_host_check
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_math3, only: cross
   use kj_joint_types, only: joint_types, find_joint_type, known_types, FRAME_CROSS
   use kj_host, only: joint_spec_t, joint_set_t, host_vector, host_quaternion
   use kj_host_scheme, only: follows_nodes
   implicit none
   private

   public :: check_spec, check_shape, check_nodes, check_finite, check_attitude

contains

   !> A joint that code describes. Errors: ERR_INPUT, with what would be right
   subroutine check_spec(set, spec, error)
      type(joint_set_t), intent(in) :: set
      type(joint_spec_t), intent(in) :: spec
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: joint
      integer :: row, e

      joint = 'joint '//str(spec%id)//': '
      row = find_joint_type(spec%type)
      if (row == 0) then
         call fail(error, ERR_INPUT, joint//'there is no type '//str(spec%type)// &
            ', only '//known_types())
         return
      end if
      if (any(spec%node < 1 .or. spec%node > set%n_host) .or. &
         any(spec%carrier < 0 .or. spec%carrier > set%n_host) .or. &
         any(spec%axis_node < 0 .or. spec%axis_node > set%n_host)) then
         call fail(error, ERR_INPUT, joint//'a node is not between 1 and '//str(set%n_host))
         return
      end if
      if (carrier_of(spec, 1) == carrier_of(spec, 2)) then
         call fail(error, ERR_INPUT, joint//'both ends have the same carrier')
         return
      end if
      do e = 1, 2
         if (any(spec%axis_node(:, e) > 0) .neqv. all(spec%axis_node(:, e) > 0)) then
            call fail(error, ERR_INPUT, joint//'the axes of an end need three nodes')
            return
         end if
      end do
      if (follows_nodes(set) .and. (any(spec%axis_node(:, 1) == 0) .and. spec%first_frame .or. &
         any(spec%axis_node == 0) .and. joint_types(row)%frame == FRAME_CROSS)) then
         call fail(error, ERR_INPUT, joint// &
            'its frame follows axis nodes under the legacy formulation: give axis_node')
         return
      end if
      call check_laws(set, spec, row, joint, error)
   end subroutine check_spec

   subroutine check_laws(set, spec, row, joint, error)
      type(joint_set_t), intent(in) :: set
      type(joint_spec_t), intent(in) :: spec
      integer, intent(in) :: row
      character(len=*), intent(in) :: joint
      type(error_t), allocatable, intent(out) :: error

      integer :: n_curve

      n_curve = set%model%curves%n
      if (.not. all(ieee_is_finite([spec%kn, spec%cr, spec%k, spec%c]))) then
         call fail(error, ERR_INPUT, joint//'a stiffness or damping is not finite')
      else if (spec%kn < 0.0_wp .or. .not. spec%kn > 0.0_wp .and. &
         any(joint_types(row)%free == 0)) then
         call fail(error, ERR_INPUT, joint//'kn must be positive')
      else if (spec%cr < 0.0_wp .or. spec%cr > 1.0_wp) then
         call fail(error, ERR_INPUT, joint//'cr is not between 0 and 1')
      else if (any(spec%k < 0.0_wp) .or. any(spec%c < 0.0_wp)) then
         call fail(error, ERR_INPUT, joint//'a stiffness or damping is negative')
      else if (any(spec%k_curve < 0 .or. spec%k_curve > n_curve) .or. &
         any(spec%c_curve < 0 .or. spec%c_curve > n_curve)) then
         call fail(error, ERR_INPUT, joint//'a curve is not between 0 and '//str(n_curve))
      else if (any(joint_types(row)%free == 0 .and. (abs(spec%k) > 0.0_wp .or. &
         abs(spec%c) > 0.0_wp .or. spec%k_curve > 0 .or. spec%c_curve > 0))) then
         call fail(error, ERR_INPUT, joint//'a law stands on a blocked direction')
      else
         call check_axes(spec, row, joint, error)
      end if
   end subroutine check_laws

   !> The axes are finite, of unit length and, but for y and z of a universal joint, perpendicular
   subroutine check_axes(spec, row, joint, error)
      type(joint_spec_t), intent(in) :: spec
      integer, intent(in) :: row
      character(len=*), intent(in) :: joint
      type(error_t), allocatable, intent(out) :: error

      real(wp), parameter :: SMALL = 1.0e-6_wp
      real(wp) :: third(3)
      logical :: good

      if (all(spec%axis_node > 0)) return
      good = all(ieee_is_finite(spec%axes))
      if (good) then
         associate (a => spec%axes)
            third = cross(a(:, 1), a(:, 2))
            good = all(abs(norm2(a, dim=1) - 1.0_wp) < SMALL) .and. &
               abs(dot_product(a(:, 1), a(:, 2))) < SMALL .and. &
               abs(dot_product(a(:, 1), a(:, 3))) < SMALL .and. dot_product(third, a(:, 3)) > SMALL
            if (joint_types(row)%frame /= FRAME_CROSS) good = good .and. &
               all(abs(third - a(:, 3)) < SMALL)
         end associate
      end if
      if (.not. good) call fail(error, ERR_INPUT, joint// &
         'its axes are not three unit vectors of a right-handed frame')
   end subroutine check_axes

   pure integer function carrier_of(spec, e) result(node)
      type(joint_spec_t), intent(in) :: spec
      integer, intent(in) :: e

      node = spec%carrier(e)
      if (node == 0) node = spec%node(e)
   end function carrier_of

   !> An array of vectors of all host nodes
   subroutine check_shape(set, a, name, error)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: a(:, :)
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(out) :: error

      integer :: wanted(2)

      wanted = [3, set%n_host]
      if (set%by_component) wanted = wanted(2:1:-1)
      if (all(shape(a) == wanted)) return
      call fail(error, ERR_INPUT, 'the array '//name//' is ('//str(size(a, 1))//', '// &
         str(size(a, 2))//'), expected: ('//str(wanted(1))//', '//str(wanted(2))//')')
   end subroutine check_shape

   !> Vectors of the nodes first..last of the set are finite
   subroutine check_nodes(set, a, last, name, error)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: a(:, :)
      integer, intent(in) :: last
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(out) :: error

      integer :: i

      do i = 1, last
         if (set%host(i) == 0) cycle
         if (all(ieee_is_finite(host_vector(set, a, set%host(i))))) cycle
         call fail(error, ERR_INPUT, name//' of node '//str(set%host(i))//' is not finite')
         return
      end do
   end subroutine check_nodes

   !> A number is finite and not negative
   subroutine check_finite(value, name, error)
      real(wp), intent(in) :: value
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(out) :: error

      if (ieee_is_finite(value) .and. value >= 0.0_wp) return
      call fail(error, ERR_INPUT, name//' is not a finite number of at least 0')
   end subroutine check_finite

   !> Attitudes have the right shape, and are there when they must be
   subroutine check_attitude(set, error, attitude)
      type(joint_set_t), intent(in) :: set
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      integer :: wanted(2), i

      if (.not. present(attitude)) then
         if (.not. follows_nodes(set)) call fail(error, ERR_INPUT, &
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

end module kj_host_check
