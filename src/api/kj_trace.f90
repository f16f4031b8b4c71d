!> The trace of a run: all that chosen joints, bodies and nodes see and do in chosen cycles, as
!> values. A run without one does nothing of this; a run with one is cut into single cycles there,
!> and each is looked at on a copy, so that the run itself keeps its bits.
module kj_trace
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, str, ERR_INPUT
   use kj_math3, only: cross, to_quaternion
   use kj_joint_types, only: NDOF
   use kj_model, only: model_t
   use kj_snapshot, only: inside_t
   use kj_consistent_state, only: consistent_model_t
   use kj_scheme, only: scheme_t, show, look_inside, node_place, node_moves
   implicit none
   private

   public :: trace_plan_t, trace_t, traced_lead_t, plan_trace, next_cycle, is_traced, take_trace

   integer, parameter, public :: TRACE_JOINT = 1, TRACE_SPRING = 2, TRACE_BODY = 3, TRACE_NODE = 4
   character(len=6), parameter, public :: TRACE_NAME(4) = ['joint ', 'spring', 'body  ', 'node  ']

   !> What is traced, and when
   type :: trace_plan_t
      integer, allocatable :: kind(:)            !! (n) TRACE_ constant
      integer, allocatable :: index(:)           !! (n) element, body or node
      integer :: first = 0, last = -1            !! cycles
      integer :: seen = -1                       !! the one before this
   end type trace_plan_t

   !> A body or free node; W
   type :: traced_lead_t
      logical :: is_body = .false.
      integer :: id = 0                          !! user id
      real(wp) :: mass = 0.0_wp
      real(wp) :: position(3) = 0.0_wp
      real(wp) :: attitude(4) = 0.0_wp           !! turn since the start, w x y z; of a body
      real(wp), dimension(3) :: velocity = 0.0_wp, omega = 0.0_wp
      real(wp), dimension(3) :: acceleration = 0.0_wp, omega_dot = 0.0_wp
      !> of joints, loads and gravity, moment about the lead
      real(wp), dimension(3) :: force = 0.0_wp, moment = 0.0_wp
      real(wp) :: energy = 0.0_wp                !! kinetic
      integer, allocatable :: joints(:)          !! user ids of the joints and springs on it
   end type traced_lead_t

   !> One thing in one cycle
   type :: trace_t
      integer :: kind = 0                        !! TRACE_ constant
      integer :: id = 0                          !! user id
      integer :: cycle = 0
      real(wp) :: time = 0.0_wp
      real(wp) :: lag = 0.0_wp                   !! velocities and rates are older by so much
      real(wp) :: step = 0.0_wp                  !! the coming one
      !> (1 or 2) leads of both ends; the body itself; the lead of the node
      type(traced_lead_t), allocatable :: lead(:)
      ! joints and springs
      integer :: node(2) = 0                     !! user ids of the ends
      real(wp) :: frame(9) = 0.0_wp              !! columns E1 E2 E3, W
      real(wp), dimension(NDOF) :: q = 0.0_wp, rate = 0.0_wp    !! J
      real(wp) :: force(NDOF) = 0.0_wp           !! sum of all laws, on end 1, J
      type(inside_t) :: inside
      integer, allocatable :: flag(:)            !! (6) DOF_ constant, of joints with limits
      real(wp) :: work = 0.0_wp                  !! done on it since the start
      ! nodes
      real(wp), dimension(3) :: position = 0.0_wp, velocity = 0.0_wp, acceleration = 0.0_wp  !! W
   end type trace_t

contains

   !> Find what has these user ids: all kinds that do.
   !>
   !> Errors: ERR_INPUT when nothing has an id, or the cycles are no range.
   subroutine plan_trace(model, ids, first, last, plan, error)
      type(model_t), intent(in) :: model
      integer, intent(in) :: ids(:), first, last
      type(trace_plan_t), intent(out) :: plan
      type(error_t), allocatable, intent(out) :: error

      integer :: i, k, n

      allocate (plan%kind(0), plan%index(0))
      if (size(ids) == 0) return
      if (first < 0 .or. last < first) then
         call fail(error, ERR_INPUT, 'the cycles of a trace are A:B with 0 <= A <= B, not '// &
            str(first)//':'//str(last))
         return
      end if
      do i = 1, size(ids)
         if (any(ids(:i - 1) == ids(i))) cycle
         n = size(plan%kind)
         do k = 1, model%n_element
            if (model%joint(k)%id == ids(i)) &
               call add(merge(TRACE_JOINT, TRACE_SPRING, k <= model%n_joint), k)
         end do
         do k = 1, model%n_body
            if (model%body_id(k) == ids(i)) call add(TRACE_BODY, k)
         end do
         do k = 1, model%n_node
            if (model%node_id(k) == ids(i)) call add(TRACE_NODE, k)
         end do
         if (size(plan%kind) > n) cycle
         call fail(error, ERR_INPUT, 'there is no joint, spring, body or node '//str(ids(i)))
         call tell_ids(model, error%hint)
         return
      end do
      plan%first = first
      plan%last = last

   contains

      subroutine add(kind, index)
         integer, intent(in) :: kind, index

         plan%kind = [plan%kind, kind]
         plan%index = [plan%index, index]
      end subroutine add
   end subroutine plan_trace

   !> 'there are joints 901, 902; bodies 1; nodes 100, 101'
   subroutine tell_ids(model, text)
      type(model_t), intent(in) :: model
      character(len=:), allocatable, intent(out) :: text

      text = 'there are'
      call add('joints', model%joint(:model%n_joint)%id)
      call add('springs', model%joint(model%n_joint + 1:model%n_element)%id)
      call add('bodies', model%body_id)
      call add('nodes', model%node_id)

   contains

      subroutine add(name, ids)
         character(len=*), intent(in) :: name
         integer, intent(in) :: ids(:)

         integer, parameter :: MOST = 12
         integer :: i

         if (size(ids) == 0) return
         if (len(text) > len('there are')) text = text//';'
         text = text//' '//name//' '//str(ids(1))
         do i = 2, min(MOST, size(ids))
            text = text//', '//str(ids(i))
         end do
         if (size(ids) > MOST) text = text//' and '//str(size(ids) - MOST)//' more'
      end subroutine add
   end subroutine tell_ids

   !> This cycle is one of those asked for, or the end of some that are taken at once
   pure logical function is_traced(plan, cycle) result(traced)
      type(trace_plan_t), intent(in) :: plan
      integer, intent(in) :: cycle

      traced = cycle >= plan%first .and. (cycle <= plan%last .or. (plan%seen >= 0 .and. &
         plan%seen < plan%last))
   end function is_traced

   !> The next cycle to look at; huge when there is none
   pure integer function next_cycle(plan, cycle) result(next)
      type(trace_plan_t), intent(in) :: plan
      integer, intent(in) :: cycle

      next = max(plan%first, cycle + 1)
      if (next > plan%last) next = huge(1)
   end function next_cycle

   !> Everything that is traced, now
   subroutine take_trace(model, scheme, plan, trace)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(in) :: scheme
      type(trace_plan_t), intent(in) :: plan
      type(trace_t), allocatable, intent(out) :: trace(:)

      type(scheme_t) :: copy
      integer :: i

      copy = scheme
      call show(model, copy)
      allocate (trace(size(plan%kind)))
      do i = 1, size(trace)
         associate (t => trace(i), now => copy%now)
            t%kind = plan%kind(i)
            t%cycle = now%cycle
            t%time = now%time
            t%lag = now%lag
            t%step = now%step
            select case (t%kind)
            case (TRACE_JOINT, TRACE_SPRING)
               call see_element(model, copy, plan%index(i), t)
            case (TRACE_BODY)
               t%id = model%body_id(plan%index(i))
               call find_leads(model%model_t, copy, [plan%index(i)], t%lead)
            case (TRACE_NODE)
               call see_node(model, copy, plan%index(i), t)
            end select
         end associate
      end do
   end subroutine take_trace

   !> A joint or spring
   subroutine see_element(model, scheme, j, t)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: j                   !! index into model%joint
      type(trace_t), intent(inout) :: t

      associate (ref => model%joint(j), i => model%joint(j)%place)
         associate (shown => scheme%now%joint(ref%batch))
            t%id = ref%id
            t%node = model%node_id(ref%node)
            call find_leads(model%model_t, scheme, model%lead(ref%node), t%lead)
            t%frame = shown%e(i, :)
            t%q = shown%q(i, :)
            t%rate = shown%rate(i, :)
            t%force = shown%f(i, :)
            t%work = shown%energy(i)
            if (allocated(shown%flag)) t%flag = shown%flag(i, :)
            call look_inside(model, scheme, j, t%frame, t%inside)
         end associate
      end associate
   end subroutine see_element

   !> A node: its own place, and what its lead makes it do
   subroutine see_node(model, scheme, node, t)
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: node
      type(trace_t), intent(inout) :: t

      real(wp) :: r(3)

      associate (lead => model%lead(node))
         t%id = model%node_id(node)
         call find_leads(model%model_t, scheme, [lead], t%lead)
         associate (l => t%lead(1))
            t%position = node_place(model, scheme, node)
            if (.not. node_moves(model%model_t, scheme, node)) t%position = l%position + &
               matmul(turn_of(model%model_t, scheme, lead), model%x0(node, :) - model%x0(lead, :))
            r = t%position - l%position
            t%velocity = l%velocity + cross(l%omega, r)
            t%acceleration = l%acceleration + cross(l%omega_dot, r) + &
               cross(l%omega, cross(l%omega, r))
         end associate
      end associate
   end subroutine see_node

   !> Turn of a body since the start
   pure function turn_of(model, scheme, body) result(turn)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: body
      real(wp) :: turn(3, 3)

      turn = matmul(reshape(scheme%now%p(body, :), [3, 3]), &
         transpose(reshape(model%axes(body, :), [3, 3])))
   end function turn_of

   !> Bodies or free nodes
   subroutine find_leads(model, scheme, which, lead)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: which(:)            !! their indices
      type(traced_lead_t), allocatable, intent(out) :: lead(:)

      integer :: i

      allocate (lead(size(which)))
      do i = 1, size(which)
         call find_lead(model, scheme, which(i), lead(i))
      end do
   end subroutine find_leads

   subroutine find_lead(model, scheme, i, lead)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: scheme
      integer, intent(in) :: i                   !! index of the lead
      type(traced_lead_t), intent(out) :: lead

      integer :: j, k

      associate (now => scheme%now)
         lead%is_body = i <= model%n_body
         lead%mass = now%mass(i)
         lead%position = now%x(i, :)
         lead%velocity = now%v(i, :)
         lead%omega = now%w(i, :)
         lead%acceleration = now%a(i, :)
         lead%omega_dot = now%al(i, :)
         lead%force = now%f(i, :)
         lead%moment = now%m(i, :)
         lead%energy = 0.5_wp*lead%mass*dot_product(lead%velocity, lead%velocity)
         if (lead%is_body) then
            lead%id = model%body_id(i)
            lead%attitude = to_quaternion(turn_of(model, scheme, i))
            do k = 1, 3
               lead%energy = lead%energy + 0.5_wp*now%principal(i, k)* &
                  dot_product(lead%omega, now%p(i, 3*k - 2:3*k))**2
            end do
         else
            lead%id = model%node_id(i)
            lead%energy = lead%energy + 0.5_wp*now%inertia(i)*dot_product(lead%omega, lead%omega)
         end if
         lead%joints = pack(model%joint%id, [(any(model%lead(model%joint(j)%node) == i), &
            j=1, model%n_element)])
      end associate
   end subroutine find_lead

end module kj_trace
