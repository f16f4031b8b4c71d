!> Joints of a deck as elements of a host.
module kj_host_deck
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_joint_types, only: FRAME_MEAN, FRAME_CROSS
   use kj_sort, only: lookup_t, new_lookup, find
   use kj_model, only: model_t
   use kj_kinds, only: wp
   use kj_host, only: joint_set_t
   use kj_host_check, only: check_attitude
   use kj_host_scheme, only: begin_state, follows_nodes, refuse_automatic
   implicit none
   private

   public :: take_model

contains

   !> The joints of a model, with its masses; loads and imposed motion stay behind.
   !>
   !> Errors: ERR_INPUT when the host lacks a node that the joints need, or has a node twice, or a
   !> stiffness of the joints would come from a first step that the host alone knows (legacy).
   subroutine take_model(set, model, node_id, error, attitude)
      type(joint_set_t), intent(inout) :: set
      type(model_t), intent(in) :: model
      integer, intent(in) :: node_id(:)          !! (n) user id in the deck of each host node
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: attitude(:, :)

      logical :: needed(model%n_node)

      if (size(node_id) /= set%n_host) then
         call fail(error, ERR_INPUT, 'the array node_id has '//str(size(node_id))// &
            ' values, expected: '//str(set%n_host))
         return
      end if
      set%model%model_t = model
      call strip_loads(set%model%model_t)
      call find_needed(set%model%model_t, follows_nodes(set), needed)
      call map_nodes(set, node_id, needed, error)
      if (allocated(error)) return
      call refuse_automatic(set, error)
      if (allocated(error)) return
      call measured_skews(set)
      call check_attitude(set, error, attitude)
      if (.not. allocated(error)) call begin_state(set, error, attitude)
   end subroutine take_model

   !> What loads and drives is the business of the host; which skews joints read
   subroutine strip_loads(model)
      type(model_t), intent(inout) :: model

      logical :: used(0:model%skews%n)
      integer :: i

      deallocate (model%gravity, model%cload, model%motion, model%th_joint, model%th_spring, &
         model%th_body, model%th_node, model%th_node_skew)
      allocate (model%gravity(0), model%cload(0), model%motion(0), model%th_joint(0), &
         model%th_spring(0), model%th_body(0), model%th_node(0), model%th_node_skew(0))
      used = .false.
      do i = 1, size(model%batch)
         if (model%batch(i)%frame == FRAME_MEAN) cycle
         used(model%batch(i)%skew(:, 1)) = .true.
         if (model%batch(i)%frame == FRAME_CROSS) used(model%batch(i)%skew(:, 2)) = .true.
      end do
      model%skews%needed = pack([(i, i=1, model%skews%n)], used(1:) .and. model%skews%dir > 0)
   end subroutine strip_loads

   !> Nodes that the host must have: carriers, and what their frames follow
   pure subroutine find_needed(model, ends, needed)
      type(model_t), intent(in) :: model
      logical, intent(in) :: ends                !! nodes of joints and of skews, too
      logical, intent(out) :: needed(:)

      integer :: i

      needed = .false.
      do i = 1, model%n_element
         needed(model%lead(model%joint(i)%node)) = .true.
         if (ends) needed(model%joint(i)%node) = .true.
      end do
      if (.not. ends) return
      do i = 1, size(model%skews%needed)
         needed(model%skews%node(:, model%skews%needed(i))) = .true.
      end do
   end subroutine find_needed

   subroutine map_nodes(set, node_id, needed, error)
      type(joint_set_t), intent(inout) :: set
      integer, intent(in) :: node_id(:)
      logical, intent(in) :: needed(:)
      type(error_t), allocatable, intent(out) :: error

      type(lookup_t) :: lookup
      integer :: i

      call new_lookup(node_id, lookup)
      do i = 2, size(lookup%id)
         if (lookup%id(i) /= lookup%id(i - 1)) cycle
         call fail(error, ERR_INPUT, 'node '//str(lookup%id(i))//' stands twice in node_id')
         return
      end do
      allocate (set%host(set%model%n_node), source=0)
      do i = 1, set%model%n_node
         if (i <= set%model%n_lead .and. .not. needed(i)) cycle
         set%host(i) = find(lookup, set%model%node_id(i))
         if (set%host(i) > 0 .or. .not. needed(i)) cycle
         call fail(error, ERR_INPUT, 'the host has no node '//str(set%model%node_id(i))// &
            ', which the joints need')
         return
      end do
   end subroutine map_nodes

   !> Moving skews of joint ends whose nodes the host has: their orthogonality is measured
   subroutine measured_skews(set)
      type(joint_set_t), intent(inout) :: set

      integer :: j, e, s, n, pass

      do pass = 1, 2
         n = 0
         do j = 1, set%model%n_joint
            associate (b => set%model%batch(set%model%joint(j)%batch), k => set%model%skews)
               do e = 1, 2
                  s = b%skew(set%model%joint(j)%place, e)
                  if (s == 0) cycle
                  if (k%dir(s) /= 1) cycle
                  if (.not. all(set%host(k%node(:, s)) > 0)) cycle
                  n = n + 1
                  if (pass == 1) cycle
                  set%shear_node(:, n) = k%node(:, s)
                  set%shear_of(n) = merge(j, -j, e == 1)
               end do
            end associate
         end do
         if (pass == 1) allocate (set%shear_node(3, n), set%shear_of(n))
      end do
   end subroutine measured_skews

end module kj_host_deck
