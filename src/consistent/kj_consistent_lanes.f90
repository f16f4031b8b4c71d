!> Scenes of one topology side by side: place s of every block of leads and joints is that of scene
!> s, so kernels do for 64 small scenes what they do for a large one. Each has its own step and its
!> own time.
!>
!> A scene keeps its own model, state and march, which decide all that lies between two spells of
!> steps; the steps alone are taken here. What they change is copied back when somebody wants to see
!> it. So the bits of a scene are those that it has alone.
!> Source: docs/sweep.md.
module kj_consistent_lanes
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, rows_at, block_of, lane_of
   use kj_joint_batch, only: joint_batch_t, is_spring
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_step, only: step_to_loads, step_from_loads, place_nodes, reach_motion
   use kj_consistent_load, only: add_loads
   use kj_consistent_conditions, only: FIRST_HALF, SECOND_HALF
   use kj_consistent_motion, only: motion_target
   implicit none
   private

   public :: lanes_t, seat, step_lanes, take_out, take_coordinates

   !> A scene whose steps are taken here. Its loads act by its own model and state.
   type :: scene_t
      type(consistent_model_t), pointer :: model => null()
      type(consistent_state_t), pointer :: state => null()
   end type scene_t

   !> The scenes as one
   type :: lanes_t
      type(scene_t) :: scene(BLOCK)
      logical :: loaded = .false.                !! loads act on some, or axes move in some
      type(consistent_model_t) :: model
      type(consistent_state_t) :: state
      real(wp) :: work(BLOCK) = 0.0_wp           !! of imposed motion
   end type lanes_t

   !> Constants of one scene into its place, or at first into all
   interface put
      procedure put_numbers, put_table, put_integers, put_integer_table, put_logicals
   end interface put

contains

   !> A scene takes a place
   subroutine seat(model, state, s, lanes)
      type(consistent_model_t), target, intent(in) :: model
      type(consistent_state_t), target, intent(inout) :: state   !! its loads act in it, later
      integer, intent(in) :: s                   !! place
      type(lanes_t), intent(inout) :: lanes

      integer :: b, i

      lanes%scene(s)%model => model
      lanes%scene(s)%state => state
      lanes%loaded = lanes%loaded .or. size(model%placed) > 0
      associate (w => lanes%model, p => lanes%state%poses)
         call put(model%mass, s, w%mass)
         call put(model%inverse_mass, s, w%inverse_mass)
         call put(model%spin_inertia, s, w%spin_inertia)
         call put(model%inverse_inertia, s, w%inverse_inertia)
         call put(model%equal, s, w%equal)
         call put(model%n_end, s, w%n_end)
         call put(model%turns, s, w%turns)
         call put(state%poses%im, s, p%im)
         do b = 1, size(model%batch)
            call seat_batch(model%batch(b), s, w%batch(b))
         end do
         associate (n => model%skews%n)
            lanes%state%skew((s - 1)*n + 1:s*n, :) = state%skew(1:, :)
         end associate
         do i = 1, size(model%gravity)
            lanes%state%field(i)%each(s::BLOCK, :) = &
               spread(state%field(i)%now, 1, size(model%gravity(i)%node))
         end do
         do i = 1, size(model%motion)
            w%motion(BLOCK*(i - 1) + s) = model%motion(i)
         end do
         p%time(s) = state%time
         p%h(s) = state%h
      end associate
      lanes%work(s) = state%work
      lanes%state%motion_at(s::BLOCK) = state%motion_at
      lanes%state%mean(s::BLOCK) = state%mean
      lanes%state%final(s::BLOCK) = state%final
      call carry(.true., s, model, state, lanes)
   end subroutine seat

   subroutine seat_batch(one, s, wide)
      type(joint_batch_t), intent(in) :: one
      integer, intent(in) :: s
      type(joint_batch_t), intent(inout) :: wide

      call put(one%xl0, s, wide%xl0)
      call put(one%frame0, s, wide%frame0)
      call put(one%k, s, wide%k)
      call put(one%c, s, wide%c)
      call put(one%k_curve, s, wide%k_curve)
      call put(one%c_curve, s, wide%c_curve)
      call put(one%angle0, s, wide%angle0)
      if (allocated(one%spring)) wide%spring(s::BLOCK) = one%spring
      associate (g => one%geometry, w => wide%geometry)
         call put(g%plain, s, w%plain)
         call put(g%arm, s, w%arm)
         call put(g%triad, s, w%triad)
         call put(g%apart, s, w%apart)
         call put(g%axis_angle, s, w%axis_angle)
         if (allocated(g%rail)) call put(g%rail, s, w%rail)
         if (allocated(g%inertia)) call put(g%inertia, s, w%inertia)
      end associate
      if (.not. one%limited) return
      associate (l => one%limit, w => wide%limit)
         call put(l%lo, s, w%lo)
         call put(l%hi, s, w%hi)
         call put(l%combined, s, w%combined)
         call put(l%k, s, w%k)
         call put(l%slip, s, w%slip)
         call put(l%slip_curve, s, w%slip_curve)
         call put(l%cr, s, w%cr)
         call put(l%cr_stop, s, w%cr_stop)
         call put(l%k_block, s, w%k_block)
         call put(l%t_lock, s, w%t_lock)
         call put(l%t_free, s, w%t_free)
      end associate
   end subroutine seat_batch

   pure subroutine put_numbers(one, s, wide)
      real(wp), intent(in) :: one(:)
      integer, intent(in) :: s
      real(wp), allocatable, intent(inout) :: wide(:)

      if (.not. allocated(wide)) allocate (wide(BLOCK*size(one)))
      wide(s::BLOCK) = one
   end subroutine put_numbers

   pure subroutine put_table(one, s, wide)
      real(wp), intent(in) :: one(:, :)
      integer, intent(in) :: s
      real(wp), allocatable, intent(inout) :: wide(:, :)

      if (.not. allocated(wide)) allocate (wide(BLOCK*size(one, 1), size(one, 2)))
      wide(s::BLOCK, :) = one
   end subroutine put_table

   pure subroutine put_integers(one, s, wide)
      integer, intent(in) :: one(:)
      integer, intent(in) :: s
      integer, allocatable, intent(inout) :: wide(:)

      if (.not. allocated(wide)) allocate (wide(BLOCK*size(one)))
      wide(s::BLOCK) = one
   end subroutine put_integers

   pure subroutine put_integer_table(one, s, wide)
      integer, intent(in) :: one(:, :)
      integer, intent(in) :: s
      integer, allocatable, intent(inout) :: wide(:, :)

      if (.not. allocated(wide)) allocate (wide(BLOCK*size(one, 1), size(one, 2)))
      wide(s::BLOCK, :) = one
   end subroutine put_integer_table

   pure subroutine put_logicals(one, s, wide)
      logical, intent(in) :: one(:)
      integer, intent(in) :: s
      logical, allocatable, intent(inout) :: wide(:)

      if (.not. allocated(wide)) allocate (wide(BLOCK*size(one)))
      wide(s::BLOCK) = one
   end subroutine put_logicals

   !> What the steps have made of a scene; cycles are counted by who asks for steps
   subroutine take_out(model, s, lanes, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: s
      type(lanes_t), intent(inout) :: lanes      !! is not changed
      type(consistent_state_t), intent(inout) :: state

      state%time = lanes%state%poses%time(s)
      state%work = lanes%work(s)
      state%motion_at = lanes%state%motion_at(s::BLOCK)
      state%mean = lanes%state%mean(s::BLOCK)
      state%final = lanes%state%final(s::BLOCK)
      state%active = lanes%state%active(s::BLOCK)
      call carry(.false., s, model, state, lanes)
   end subroutine take_out

   !> All that steps change, from the state of a scene to its place or back
   subroutine carry(inward, s, model, state, lanes)
      logical, intent(in) :: inward
      integer, intent(in) :: s
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), target, intent(inout) :: state
      type(lanes_t), target, intent(inout) :: lanes

      integer :: b, i

      associate (a => state, w => lanes%state)
         call both(a%poses%x, w%poses%x)
         call both(a%poses%d, w%poses%d)
         call both(a%poses%quat, w%poses%quat)
         call both(a%poses%v, w%poses%v)
         call both(a%poses%w, w%poses%w)
         call both(a%poses%w_left, w%poses%w_left)
         call both(a%poses%psi, w%poses%psi)
         call both(a%v, w%v)
         call both(a%l, w%l)
         call both(a%f, w%f)
         call both(a%t, w%t)
         call both(a%own_f, w%own_f)
         call both(a%own_t, w%own_t)
         call both(a%impulse, w%impulse)
         call both(a%angular_impulse, w%angular_impulse)
         call both(a%turn, w%turn)
         do b = 1, size(a%joint)
            associate (one => a%joint(b), wide => w%joint(b))
               do i = 1, model%batch(b)%n
                  call both_rows(c_loc(one%block(block_of(i))), c_loc(wide%block(i)), &
                     storage_size(one%block), i)
                  if (allocated(one%limit)) call both_rows(c_loc(one%limit(block_of(i))), &
                     c_loc(wide%limit(i)), storage_size(one%limit), i)
                  if (allocated(one%spring)) call both_rows(c_loc(one%spring(block_of(i))), &
                     c_loc(wide%spring(i)), storage_size(one%spring), i)
               end do
            end associate
         end do
      end associate

   contains

      subroutine both(one, wide)
         real(wp), contiguous, intent(inout) :: one(:, :), wide(:, :)

         if (inward) then
            wide(s::BLOCK, :) = one
         else
            one(:, :) = wide(s::BLOCK, :)
         end if
      end subroutine both

      !> A joint of a scene in its block, and in the lanes the block of that joint
      subroutine both_rows(one, wide, bits, i)
         type(c_ptr), intent(in) :: one, wide
         integer, intent(in) :: bits, i

         real(wp), pointer :: row(:, :), there(:, :)

         call rows_at(one, bits, row)
         call rows_at(wide, bits, there)
         if (inward) then
            there(s, :) = row(lane_of(i), :)
         else
            row(lane_of(i), :) = there(s, :)
         end if
      end subroutine both_rows
   end subroutine carry

   !> Time, coordinates and rates of the joints, and axes of springs: what is_calm looks at
   subroutine take_coordinates(model, s, lanes, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: s
      type(lanes_t), intent(in) :: lanes
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i

      state%time = lanes%state%poses%time(s)
      do b = 1, size(model%batch)
         do i = 1, model%batch(b)%n
            associate (one => state%joint(b)%block(block_of(i)), k => lane_of(i), &
               wide => lanes%state%joint(b)%block(i))
               one%q(k, :) = wide%q(s, :)
               if (model%batch(b)%limited) one%qd(k, :) = wide%qd(s, :)
               if (.not. is_spring(model%batch(b))) cycle
               one%b%force(k, :) = wide%b%force(s, :)
               one%b%couple(k, :) = wide%b%couple(s, :)
               one%b%apart(k, :) = wide%b%apart(s, :)
            end associate
         end do
      end do
   end subroutine take_coordinates

   !> So many steps of the scenes in the first n places, each by its own step
   subroutine step_lanes(midpoint, n, steps, h, lanes)
      logical, intent(in) :: midpoint            !! liemid instead of split2
      integer, intent(in) :: n, steps
      real(wp), intent(in) :: h(n)
      type(lanes_t), intent(inout) :: lanes

      integer :: i, b, at

      associate (team => lanes%model%team, p => lanes%state%poses)
         do i = 1, size(team%lead, 2)
            team%lead(:, i) = BLOCK*(i - 1) + [1, n]
         end do
         at = 0
         do b = 1, size(lanes%model%batch)
            do i = 1, lanes%model%batch(b)%n, BLOCK
               at = at + 1
               team%joint(:, at) = [b, i, i + n - 1]
            end do
         end do
         p%h(:n) = h
         do i = 1, steps
            call drive(n, h, lanes)
            p%time(:n) = p%time(:n) + h
            call step_to_loads(lanes%model, midpoint, lanes%loaded, lanes%state)
            if (size(lanes%model%motion) > 0) call count_work(n, FIRST_HALF, lanes)
            if (lanes%loaded) call act_loads(n, lanes)
            call step_from_loads(lanes%model, lanes%loaded, lanes%state)
            if (size(lanes%model%motion) > 0) call count_work(n, SECOND_HALF, lanes)
         end do
      end associate
   end subroutine step_lanes

   !> What imposed motions want of a step, and where they are at its end
   subroutine drive(n, h, lanes)
      integer, intent(in) :: n
      real(wp), intent(in) :: h(n)
      type(lanes_t), intent(inout) :: lanes

      integer :: i, s

      associate (a => lanes%state, motion => lanes%model%motion)
         do i = 1, size(motion)
            s = lane_of(i)
            if (s > n) cycle
            call motion_target(lanes%model%curves, motion(i), a%motion_at(i), a%poses%time(s), &
               h(s), a%mean(i), a%final(i), a%active(i))
            if (a%active(i)) call reach_motion(motion(i), h(s), a%mean(i), a%final(i), &
               a%motion_at(i))
         end do
      end associate
   end subroutine drive

   !> The loads of each scene, and its axes that move, by its own model from what they read of it
   subroutine act_loads(n, lanes)
      integer, intent(in) :: n
      type(lanes_t), intent(inout) :: lanes

      integer :: s, i, cycle

      do s = 1, n
         associate (model => lanes%scene(s)%model, a => lanes%scene(s)%state, w => lanes%state)
            do i = 1, size(model%placed)
               associate (lead => model%lead(model%placed(i)), &
                  at => BLOCK*(model%lead(model%placed(i)) - 1) + s)
                  a%poses%x(lead, :) = w%poses%x(at, :)
                  a%poses%d(lead, :) = w%poses%d(at, :)
                  a%poses%quat(lead, :) = w%poses%quat(at, :)
                  a%poses%psi(lead, :) = w%poses%psi(at, :)
                  a%poses%w(lead, :) = w%poses%w(at, :)
                  a%v(lead, :) = w%v(at, :)
                  a%f(lead, :) = w%f(at, :)
                  a%t(lead, :) = w%t(at, :)
                  a%own_f(lead, :) = w%own_f(at, :)
                  a%own_t(lead, :) = w%own_t(at, :)
               end associate
            end do
            cycle = a%cycle
            a%cycle = max(1, cycle)              ! loads work from the first step on
            a%time = w%poses%time(s)
            a%work = lanes%work(s)
            call place_nodes(model, a)
            call add_loads(model, a)
            a%cycle = cycle
            lanes%work(s) = a%work
            w%skew((s - 1)*model%skews%n + 1:s*model%skews%n, :) = a%skew(1:, :)
            do i = 1, size(model%placed)
               associate (lead => model%lead(model%placed(i)), &
                  at => BLOCK*(model%lead(model%placed(i)) - 1) + s)
                  w%f(at, :) = a%f(lead, :)
                  w%t(at, :) = a%t(lead, :)
                  w%own_f(at, :) = a%own_f(lead, :)
                  w%own_t(at, :) = a%own_t(lead, :)
               end associate
            end do
         end associate
      end do
   end subroutine act_loads

   !> The work of the projections of a part of a step, in the order of a scene alone
   pure subroutine count_work(n, part, lanes)
      integer, intent(in) :: n, part
      type(lanes_t), intent(inout) :: lanes

      integer :: i, s

      do i = 1, size(lanes%model%hold), BLOCK
         do s = 1, n
            associate (done => lanes%state%kept%work(:, i + s - 1, part))
               lanes%work(s) = lanes%work(s) + done(1)
               lanes%work(s) = lanes%work(s) + done(2)
            end associate
         end do
      end do
   end subroutine count_work

end module kj_consistent_lanes
