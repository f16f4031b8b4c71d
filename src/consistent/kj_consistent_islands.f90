!> A scene in parts: islands of about the same safe step march together, each part on its own step,
!> and all meet at the times of the samples.
!>
!> A part has its own model, state and march, so its islands see exactly what they would see in a
!> scene of their own. Ground that several parts touch stands in each of them; its reactions add up.
!> Islands with nearly the same limit share a part because kernels work on blocks of joints: a
!> thousand equal pendulums are one part, not a thousand. Parts share nothing, so threads can take
!> them in any order and the bits of a run stay the same.
!> Source: docs/theory/consistent.md 14.
module kj_consistent_islands
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
   use kj_kinds, only: wp
   use kj_sort, only: sort_unique
   use kj_islands, only: find_islands, element_leads, island_steps
   use kj_cut_model, only: cut_t, cut_model
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_build, only: build_consistent_model, new_consistent_state
   use kj_consistent_ready, only: begin_scene
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_march, only: march_t, start_march, march, balance_ledger, close_ledger, &
      COMPLIANT
   use kj_consistent_compliant_build, only: make_implicit
   use kj_consistent_compliant_show, only: begin_show, end_show
   use kj_block, only: rows_at, block_of, lane_of
   use kj_consistent_batch, only: consistent_joint_t
   implicit none
   private

   public :: part_t, cut_scene, march_parts, gather_parts, gather_clock

   real(wp), parameter :: ALIKE = 1.1_wp         !! largest ratio of the limits in a part
   real(wp), parameter :: NO_LIMIT = 1.0e15_wp   !! a step above this is none
   integer, parameter :: LEAST_WORK = 4000       !! joint-steps that threads are worth it for

   !> One part
   type :: part_t
      type(cut_t) :: cut                         !! where it is in the scene
      type(consistent_model_t) :: model
      type(consistent_state_t) :: state
      type(march_t) :: march
   end type part_t

contains

   !> Cut a scene that stands at its start
   subroutine cut_scene(model, whole, n_island, part)
      type(consistent_model_t), intent(in) :: model
      type(march_t), intent(in) :: whole         !! march of the scene, started
      integer, intent(out) :: n_island
      !> shortest step first; empty for a scene that is best kept in one
      type(part_t), allocatable, intent(out) :: part(:)

      integer, allocatable :: island(:), group(:)
      integer :: home(model%n_lead), ends(2, model%n_element)
      integer :: of_element(model%n_element), n, p
      real(wp) :: limit(model%n_element)
      logical :: leads(model%n_lead)

      call find_islands(model%model_t, island, n_island)
      allocate (group(0:n_island), source=0)
      n = 0
      if (whole%integrator == COMPLIANT) then
         limit = min(whole%pace%bound%limit, whole%most/whole%pace%factor)
      else
         limit = min(whole%bound%limit, whole%most/whole%factor)
      end if
      if (n_island > 1) call group_islands(island_steps(model%model_t, island, n_island, limit), &
         group, n)
      if (n < 2) n = 0                           ! nothing to gain
      allocate (part(n))
      if (n == 0) return
      ends = element_leads(model%model_t)
      home = group(island)
      of_element = max(home(ends(1, :)), home(ends(2, :)))
      where (of_element == 0) of_element = n     ! from ground to ground
      do p = 1, n
         call find_leads(model, group(island), of_element, ends, p, leads)
         where (leads .and. home == 0) home = p
         if (p == n) then
            leads = leads .or. home == 0         ! ground that nothing touches
            where (home == 0) home = n
         end if
         call cut_model(model%model_t, leads, home == p, of_element == p, part(p)%cut, &
            part(p)%model%model_t)
         call start_part(whole, part(p))
      end do
   end subroutine cut_scene

   !> Group of each island: by its limit, upwards; islands that nothing limits go with the last
   subroutine group_islands(limit, group, n)
      real(wp), intent(in) :: limit(:)           !! (n_island) longest step of each
      integer, intent(out) :: group(0:)          !! 1..n; group(0) of ground is 0
      integer, intent(out) :: n

      integer :: bin(size(limit)), i
      integer, allocatable :: bins(:), number(:)

      bin = 0
      where (limit < NO_LIMIT) bin = int(log(limit/minval(limit))/log(ALIKE))
      bin = merge(bin, maxval(bin), limit < NO_LIMIT)
      bins = sort_unique(bin)
      n = size(bins)
      allocate (number(0:maxval(bin)), source=0)
      number(bins) = [(i, i=1, n)]
      group(0) = 0
      group(1:) = number(bin)
   end subroutine group_islands

   !> Leads of a part: those of its islands, and what its joints, loads and conditions touch
   subroutine find_leads(model, group, of_element, ends, p, leads)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: group(:)            !! (n_lead) 0 for ground
      integer, intent(in) :: of_element(:), ends(:, :)
      integer, intent(in) :: p
      logical, intent(out) :: leads(:)

      integer :: i, j

      leads = group == p
      do j = 1, size(of_element)
         if (of_element(j) == p) leads(ends(:, j)) = .true.
      end do
      do i = 1, size(model%gravity)
         if (any(group(model%gravity(i)%node) == p)) call add_skew(model%gravity(i)%skew)
      end do
      do i = 1, size(model%cload)
         if (any(group(model%lead(model%cload(i)%node)) == p)) call add_skew(model%cload(i)%skew)
      end do
      do i = 1, size(model%bcs)
         if (group(model%bcs(i)%lead) == p) call add_skew(model%bcs(i)%skew)
      end do
      do i = 1, size(model%motion)
         if (group(model%motion(i)%lead) == p) call add_skew(model%motion(i)%skew)
      end do

   contains

      !> The leads on which a moving skew rides
      subroutine add_skew(skew)
         integer, intent(in) :: skew

         if (skew == 0) return
         if (model%skews%dir(skew) == 0) return
         leads(model%lead(model%skews%node(:, skew))) = .true.
      end subroutine add_skew
   end subroutine find_leads

   !> Constants, first state and first limit of a part. Stiffness that joints took from the step
   !> stays what the whole scene gave: islands change the steps, not the scene.
   subroutine start_part(whole, part)
      type(march_t), intent(in) :: whole
      type(part_t), intent(inout) :: part

      call build_consistent_model(part%model)
      call new_consistent_state(part%model, part%state)
      call begin_scene(part%model, whole%pace%rigid, part%state)
      if (whole%integrator == COMPLIANT) call make_implicit(part%model)
      part%march%pace%rigid = whole%pace%rigid
      part%march%pace%tolerance = whole%pace%tolerance
      part%march%pace%turn = whole%pace%turn
      part%march%integrator = whole%integrator
      part%march%nodal = whole%nodal
      part%march%factor = step_factor(part%model)
      part%march%most = whole%most
      part%march%first = whole%first
      call start_march(part%model, part%state, part%march)
   end subroutine start_part

   !> Steps of all parts towards t_end, of each at most so many; arrived: all have reached it.
   !>
   !> Parts that are large enough for several threads go one after the other, the others side by
   !> side.
   subroutine march_parts(t_end, steps, threads, part, arrived)
      real(wp), intent(in) :: t_end
      integer, intent(in) :: steps(:)            !! of each part
      integer, intent(in) :: threads
      type(part_t), intent(inout) :: part(:)
      logical, intent(out) :: arrived

      logical :: there(size(part)), large(size(part)), worth
      integer :: p

      large = [(part(p)%model%team%threads > 1, p=1, size(part))]
      do p = 1, size(part)
         if (large(p)) call march_part(p)
      end do
      worth = threads > 1 .and. work() > real(LEAST_WORK, wp)
      !$omp parallel do schedule(dynamic, 1) num_threads(threads) if(worth)
      do p = 1, size(part)
         if (.not. large(p)) call march_part(p)
      end do
      arrived = all(there)

   contains

      subroutine march_part(p)
         integer, intent(in) :: p

         associate (a => part(p))
            call march(a%model, t_end, steps(p), a%march, a%state, there(p))
         end associate
      end subroutine march_part

      !> Joint-steps that lie ahead, about
      real(wp) function work()
         integer :: p

         work = 0.0_wp
         do p = 1, size(part)
            work = work + part(p)%model%n_element*min(real(steps(p), wp), &
               (t_end - part(p)%state%time)/part(p)%march%limit)
         end do
      end function work
   end subroutine march_parts

   !> State, clock and ledger of the scene as if it had marched as one. All parts must stand at the
   !> same time.
   subroutine gather_parts(model, part, state, march)
      type(consistent_model_t), intent(in) :: model
      type(part_t), intent(inout) :: part(:)
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      integer :: p

      state%f = 0.0_wp
      state%t = 0.0_wp
      state%impulse = 0.0_wp
      state%angular_impulse = 0.0_wp
      state%work = 0.0_wp
      state%energy = 0.0_wp
      do p = 1, size(part)
         call balance_ledger(part(p)%model, part(p)%state)
         call begin_show(part(p)%model, part(p)%march%pace, part(p)%state)
         call gather_leads(part(p)%cut, part(p)%state, state)
         call gather_joints(part(p)%cut, part(p)%model, model, part(p)%state, state)
         call end_show(part(p)%model, part(p)%state)
         state%work = state%work + part(p)%state%work
         state%energy = state%energy + part(p)%state%energy
      end do
      call gather_clock(part, state, march)
      if (state%cycle == 0) state%scale = sum(part%state%scale)
      call close_ledger(sum(part%state%change), state)
   end subroutine gather_parts

   !> Cycles and step of the part with the shortest step, and who holds it; the time that all parts
   !> have reached
   subroutine gather_clock(part, state, march)
      type(part_t), intent(in) :: part(:)
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      integer :: p

      p = minloc(part%march%limit, dim=1)
      state%time = minval(part%state%time)
      state%cycle = maxval(part%state%cycle)
      state%h = part(p)%state%h
      march%limit = part(p)%march%limit
      march%starting = part(p)%march%starting
      march%joint = 0
      if (part(p)%march%joint > 0) march%joint = part(p)%cut%element(part(p)%march%joint)
   end subroutine gather_clock

   !> Poses, momenta and loads of the leads. Ground stands in many parts at the same place; what the
   !> joints of each part do to it adds up.
   subroutine gather_leads(cut, from, state)
      type(cut_t), intent(in) :: cut
      type(consistent_state_t), intent(in) :: from
      type(consistent_state_t), intent(inout) :: state

      associate (l => cut%lead, body => cut%lead(:size(from%turn, 1)))
         state%poses%x(l, :) = from%poses%x
         state%poses%d(l, :) = from%poses%d
         state%poses%quat(l, :) = from%poses%quat
         state%v(l, :) = from%v
         state%l(l, :) = from%l
         state%turn(body, :) = from%turn
         state%f(l, :) = state%f(l, :) + from%f
         state%t(l, :) = state%t(l, :) + from%t
         state%impulse(body, :) = state%impulse(body, :) + from%impulse
         state%angular_impulse(body, :) = state%angular_impulse(body, :) + from%angular_impulse
      end associate
      state%skew(cut%skew, :) = from%skew(1:, :)
   end subroutine gather_leads

   subroutine gather_joints(cut, section, model, from, state)
      type(cut_t), intent(in) :: cut
      type(consistent_model_t), intent(in) :: section, model   !! of the part, of the scene
      type(consistent_state_t), intent(in) :: from
      type(consistent_state_t), intent(inout) :: state

      integer :: b, last, there

      last = 0
      do b = 1, size(cut%batch)
         there = cut%batch(b)
         associate (n => section%batch(b)%n)
            call gather_batch(from%joint(b), cut%element(last + 1:last + n) - &
               model%batch(there)%first, state%joint(there))
            last = last + n
         end associate
      end do
   end subroutine gather_joints

   !> Joints of one batch to their places in that of the scene
   subroutine gather_batch(from, place, to)
      type(consistent_joint_t), target, intent(in) :: from
      integer, intent(in) :: place(:)
      type(consistent_joint_t), target, intent(inout) :: to

      integer :: i, a, b

      do i = 1, size(place)
         a = block_of(i)
         b = block_of(place(i))
         call take_row(c_loc(from%block(a)), c_loc(to%block(b)), storage_size(to%block))
         if (allocated(from%spring)) &
            call take_row(c_loc(from%spring(a)), c_loc(to%spring(b)), storage_size(to%spring))
         if (allocated(from%limit)) &
            call take_row(c_loc(from%limit(a)), c_loc(to%limit(b)), storage_size(to%limit))
      end do

   contains

      subroutine take_row(source, goal, bits)
         type(c_ptr), intent(in) :: source, goal    !! blocks
         integer, intent(in) :: bits

         real(wp), pointer :: there(:, :), here(:, :)

         call rows_at(source, bits, there)
         call rows_at(goal, bits, here)
         here(lane_of(place(i)), :) = there(lane_of(i), :)
      end subroutine take_row
   end subroutine gather_batch

end module kj_consistent_islands
