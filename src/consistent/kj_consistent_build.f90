!> Model -> constants and first state of the consistent formulation.
!> One file: constants and first state come from the same cards, in one order.
module kj_consistent_build
   use kj_kinds, only: wp
   use kj_team, only: new_team
   use kj_block, only: block_of, lane_of
   use kj_lead_map, only: N_SUM
   use kj_math3, only: cross, to_quaternion, IDENTITY
   use kj_joint_types, only: joint_types, FRAME_FIRST, FRAME_CROSS, CHART_TWIST, CHART_UNIVERSAL, &
      CHART_VECTOR
   use kj_joint_batch, only: joint_batch_t, is_spring, SPRING13, LAW_DAMPER, LAW_DAMPER_CURVE, &
      LAW_SPRING, LAW_SPRING_CURVE, LAW_HARDENED, geometry_t
   use kj_model, only: load_t, IMPOSE_DISPLACEMENT
   use kj_skew, only: axis_of
   use kj_consistent_batch, only: chart_of, last_of, new_consistent_joint
   use kj_consistent_matrix, only: N_CONSISTENT_WRENCH
   use kj_consistent_state, only: consistent_model_t, consistent_state_t, row_t
   use kj_consistent_conditions, only: collect_holds, all_blocked, project_all, WHOLE
   use kj_consistent_motion, only: motion_targets
   use kj_gravity, only: new_gravity
   use kj_consistent_step, only: find_forces
   use kj_curve, only: curve_integral
   implicit none
   private

   public :: build_consistent_model, new_consistent_state, settle

   real(wp), parameter :: LEVERS = 6.0_wp        !! radii of inertia that blocked rotations count

contains

   !> Constants of the consistent formulation, from those of the model; again after each start
   subroutine build_consistent_model(model)
      type(consistent_model_t), intent(inout) :: model

      integer :: b, i, lead, j

      if (allocated(model%arm)) deallocate (model%hold_of, model%arm, &
         model%inverse_mass, model%spin_inertia, model%inverse_inertia, model%quat0, model%axes0, &
         model%equal, model%hold, model%hold_to, model%mover)
      allocate (model%hold_of(model%n_lead))
      model%n_end = model%map%first(2:) - model%map%first(:model%n_lead)
      call collect_holds(model)
      call set_inertia(model)
      allocate (model%arm(model%n_node, 3))
      do i = 1, model%n_node
         lead = model%lead(i)
         model%arm(i, :) = matmul(model%x0(i, :) - model%x0(lead, :), &
            reshape(model%axes0(lead, :), [3, 3]))
      end do
      do b = 1, size(model%batch)
         call build_batch(b, model)
      end do
      call new_team(model%control%threads, model%control%least_share, model%batch%n, &
         model%n_lead, model%team)
      model%damped = any([(model%batch(b)%geometry%damped > 0, b=1, size(model%batch))])
      model%steady = [(is_steady(model, model%gravity(i)), i=1, size(model%gravity))]
      model%placed = [integer ::]
      do i = 1, size(model%skews%needed)
         if (.not. used_by_loads(model, model%skews%needed(i))) cycle
         model%placed = [model%placed, (model%skews%node(j, model%skews%needed(i)), j=1, 3)]
      end do
      do i = 1, size(model%cload)
         model%placed = [model%placed, model%cload(i)%node]
      end do
      model%loose = loose_ends(model)
   end subroutine build_consistent_model

   !> Ends whose moving skew does not ride on the lead of the joint node: (2, n) joint in deck
   !> order, end
   pure function loose_ends(model) result(list)
      type(consistent_model_t), intent(in) :: model
      integer, allocatable :: list(:, :)

      integer :: j, e, s, n, pass

      do pass = 1, 2
         n = 0
         do j = 1, model%n_joint
            associate (b => model%batch(model%joint(j)%batch), place => model%joint(j)%place)
               do e = 1, 2
                  s = b%skew(place, e)
                  if (s == 0) cycle
                  if (model%skews%dir(s) == 0) cycle
                  if (all(model%lead(model%skews%node(:, s)) == b%lead(place, e))) cycle
                  n = n + 1
                  if (pass == 2) list(:, n) = [j, e]
               end do
            end associate
         end do
         if (pass == 1) allocate (list(2, n))
      end do
   end function loose_ends

   !> A skew whose axes loads, conditions or imposed motion read
   pure logical function used_by_loads(model, skew) result(used)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: skew

      used = any(model%cload%skew == skew) .or. any(model%gravity%skew == skew) .or. &
         any(model%bcs%skew == skew) .or. any(model%motion%skew == skew)
   end function used_by_loads

   !> Gravity that is constant in size and direction
   pure logical function is_steady(model, load) result(steady)
      type(consistent_model_t), intent(in) :: model
      type(load_t), intent(in) :: load

      integer :: first, last

      steady = .not. load%sensed
      if (load%curve > 0) then
         first = model%curves%first(load%curve)
         last = model%curves%first(load%curve + 1) - 1
         steady = steady .and. all(model%curves%y(first:last) >= model%curves%y(first)) .and. &
            all(model%curves%y(first:last) <= model%curves%y(first))
      end if
      if (load%skew > 0) steady = steady .and. model%skews%dir(load%skew) == 0
   end function is_steady

   !> Inverse masses and inertias, principal axes sorted by descending inertia
   subroutine set_inertia(model)
      type(consistent_model_t), intent(inout) :: model

      real(wp) :: axes(3, 3), inertia(3)
      integer :: i, h

      associate (n => model%n_lead)
         allocate (model%inverse_mass(n), model%spin_inertia(n, 3), model%inverse_inertia(n, 3), &
            model%quat0(n, 4), model%axes0(n, 9), source=0.0_wp)
         allocate (model%equal(n), source=0)
      end associate
      do i = 1, model%n_lead
         inertia = model%inertia(i)
         axes = IDENTITY
         if (i <= model%n_body) then
            inertia = model%principal(i, :)
            axes = reshape(model%axes(i, :), [3, 3])
            call sort_axes(inertia, axes)
         end if
         if (model%mass(i) > 0.0_wp) model%inverse_mass(i) = 1.0_wp/model%mass(i)
         model%spin_inertia(i, :) = inertia
         if (minval(inertia) > 0.0_wp) model%inverse_inertia(i, :) = 1.0_wp/inertia
         model%quat0(i, :) = to_quaternion(axes)
         model%axes0(i, :) = reshape(axes, [9])
         if (abs(inertia(2) - inertia(3)) <= 1.0e-12_wp*inertia(1)) model%equal(i) = 1
         if (abs(inertia(1) - inertia(2)) <= 1.0e-12_wp*inertia(1)) model%equal(i) = 3
         h = model%hold_of(i)
         if (model%rests(i)) then
            model%inverse_mass(i) = 0.0_wp
            model%inverse_inertia(i, :) = 0.0_wp
         end if
         if (h == 0) cycle
         if (all_blocked(model%hold(h)%trans, model%hold(h)%n_trans)) model%inverse_mass(i) = 0.0_wp
         if (all_blocked(model%hold(h)%rot, model%hold(h)%n_rot)) model%inverse_inertia(i, :) = &
            0.0_wp
      end do
   end subroutine set_inertia

   !> Descending values, right-handed axes
   pure subroutine sort_axes(values, axes)
      real(wp), intent(inout) :: values(3), axes(3, 3)

      real(wp) :: v
      integer :: i, k

      do k = 1, 2
         do i = 1, 3 - k
            if (values(i) >= values(i + 1)) cycle
            v = values(i)
            values(i) = values(i + 1)
            values(i + 1) = v
            axes(:, i:i + 1) = axes(:, i + 1:i:-1)
         end do
      end do
      axes(:, 3) = cross(axes(:, 1), axes(:, 2))
   end subroutine sort_axes

   !> What a batch gets under the consistent formulation: its geometry; offsets of universal joints
   !> on the dual basis; stiffness of blocked rotations; damping of these from the effective inertia
   !> of the direction
   subroutine build_batch(b, model)
      integer, intent(in) :: b
      type(consistent_model_t), intent(inout) :: model

      type(geometry_t) :: g
      real(wp) :: e(3, 3), t(3, 3), r(3), m
      integer :: i, s, dof

      associate (batch => model%batch(b))
         g%chart = chart_of(batch)
         g%mean = batch%frame /= FRAME_FIRST .and. &
            (batch%kind == SPRING13 .or. .not. is_spring(batch))
         g%sprung = last_of(batch, LAW_SPRING + LAW_SPRING_CURVE + LAW_HARDENED)
         g%damped = last_of(batch, LAW_DAMPER + LAW_DAMPER_CURVE + LAW_HARDENED)
         g%shifted = any(abs(batch%angle0) > 0.0_wp)
         g%apart = model%x0(batch%lead(:, 2), :) - model%x0(batch%lead(:, 1), :)
         g%plain = [(all(joint_types(batch%row)%free(1:3) == 0) .and. g%mean .and. &
            g%chart == CHART_VECTOR .and. norm2(batch%xl0(i, :)) <= 0.0_wp, i=1, batch%n)]
         g%ball = g%chart == CHART_VECTOR .and. max(g%sprung, g%damped) <= 3 .and. &
            (all(g%plain) .or. .not. g%mean)
         allocate (g%arm(batch%n, 6), g%triad(batch%n, 8), g%axis_angle(batch%n), source=0.0_wp)
         if (.not. is_spring(batch)) call set_rotations(model, batch)
         g%rail = rails(model, batch, g)
         if (all(abs(g%rail) < 0.5_wp)) deallocate (g%rail)
         if (batch%limited) allocate (g%inertia(batch%n, 6))
         do i = 1, batch%n
            e = reshape(batch%frame0(i, :), [3, 3])
            do s = 1, 2
               t = e
               if (g%chart == CHART_UNIVERSAL .and. s == 1) t(:, 3) = cross(e(:, 1), e(:, 2))
               if (g%chart == CHART_UNIVERSAL .and. s == 2) t(:, 2) = cross(e(:, 3), e(:, 1))
               t = matmul(transpose(reshape(model%axes0(batch%lead(i, s), :), [3, 3])), t)
               g%triad(i, 4*s - 3:4*s) = to_quaternion(t)
               g%arm(i, 3*s - 2:3*s) = model%arm(batch%node(i, s), :)
            end do
            if (batch%frame == FRAME_CROSS) then
               g%axis_angle(i) = atan2(norm2(cross(e(:, 2), e(:, 3))), &
                  dot_product(e(:, 2), e(:, 3)))
               r = model%x0(batch%node(i, 2), :) - model%x0(batch%node(i, 1), :)
               batch%xl0(i, :) = dual_components(e, r)
            end if
            if (batch%limited) g%inertia(i, 1:3) = batch%reduced(i, 1)
            do dof = 4, 6
               m = direction_inertia(model, batch%lead(i, :), e(:, dof - 3))
               if (batch%limited) g%inertia(i, dof) = m
               if (joint_types(batch%row)%free(dof) == 1) cycle
               batch%c(i, dof) = batch%cr(i)*sqrt(batch%k(i, dof)*m)
            end do
         end do
         batch%geometry = g
      end associate
   end subroutine build_batch

   !> Joints with a free translation in a mean frame, and a body that does not turn: 1, -1; else 0
   pure function rails(model, batch, geometry) result(rail)
      type(consistent_model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: batch
      type(geometry_t), intent(in) :: geometry
      real(wp) :: rail(batch%n)

      logical :: turns(2)
      integer :: i, e

      rail = 0.0_wp
      if (is_spring(batch) .or. .not. geometry%mean .or. geometry%chart /= CHART_TWIST) return
      if (all(joint_types(batch%row)%free(1:3) == 0)) return
      do i = 1, batch%n
         turns = [(any(model%inverse_inertia(batch%lead(i, e), :) > 0.0_wp), e=1, 2)]
         if (turns(1) .neqv. turns(2)) rail(i) = merge(1.0_wp, -1.0_wp, turns(2))
      end do
   end function rails

   !> Blocked rotations: KR = Kn max(SCF L^2, L0^2), L0 the distance of the nodes, L a lever of the
   !> bodies: LEVERS radii of inertia about the node, but no more than a metre, unless one radius is
   !> more; of two bodies that move the larger. A metre where none moves. So the unit of length does
   !> not matter. Nodes of a host are no bodies: theirs stays as it is.
   !> Source: docs/theory/joints.md 8.2.
   pure subroutine set_rotations(model, batch)
      type(consistent_model_t), intent(in) :: model
      type(joint_batch_t), intent(inout) :: batch

      real(wp) :: metre, square, radius, kr, arm(3)
      integer :: i, e, dof, lead, free

      if (all(joint_types(batch%row)%free(4:6) == 1) .or. .not. allocated(model%body_name)) return
      free = findloc(joint_types(batch%row)%free(1:3), 0, 1)
      if (free == 0) return
      metre = 1.0_wp/model%units%si(2)
      do i = 1, batch%n
         if (batch%limited) then
            if (batch%limit%automatic(i)) cycle
         end if
         square = 0.0_wp
         do e = 1, 2
            lead = batch%lead(i, e)
            if (.not. model%inverse_mass(lead) > 0.0_wp) cycle
            arm = model%x0(batch%node(i, e), :) - model%x0(lead, :)
            square = max(square, sum(arm**2) + maxval(model%spin_inertia(lead, :))/model%mass(lead))
         end do
         radius = sqrt(square)
         square = max(radius, min(metre, LEVERS*radius))**2
         if (.not. radius > 0.0_wp) square = metre**2
         arm = model%x0(batch%node(i, 2), :) - model%x0(batch%node(i, 1), :)
         kr = batch%k(i, free)*max(batch%scale(i)*square, sum(arm**2))
         do dof = 4, 6
            if (joint_types(batch%row)%free(dof) == 0) batch%k(i, dof) = kr
         end do
         batch%k_top(i, 2) = maxval(batch%k(i, 4:6), mask=iand(batch%law(4:6), LAW_SPRING) /= 0)
         if (batch%limited) batch%limit%k_block(i, 2) = kr
      end do
   end subroutine set_rotations

   !> Components of r on the dual basis of the columns of e
   pure function dual_components(e, r) result(x)
      real(wp), intent(in) :: e(3, 3), r(3)
      real(wp) :: x(3)

      real(wp) :: s

      s = dot_product(e(:, 1), cross(e(:, 2), e(:, 3)))
      x = [dot_product(r, cross(e(:, 2), e(:, 3))), dot_product(r, cross(e(:, 3), e(:, 1))), &
         dot_product(r, cross(e(:, 1), e(:, 2)))]/s
   end function dual_components

   !> State at t = 0 with its forces
   subroutine new_consistent_state(model, state, lean)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(out) :: state
      logical, intent(in), optional :: lean      !! without what only loads and histories read

      integer :: b, i, n_own
      logical :: without

      without = .false.
      if (present(lean)) without = lean
      associate (n => model%n_lead, p => state%poses)
         allocate (p%x, source=model%x0(:n, :))
         allocate (p%quat, source=model%quat0)
         allocate (p%v, source=model%v0(:n, :))
         allocate (state%v, source=model%v0(:n, :))
         allocate (p%w(n, 3), p%w_left(n, 3), p%psi(n, 3), p%im(n), p%ij(n, 6), p%d(n, 3), &
            state%l(n, 3), state%f(n, 3), state%t(n, 3), source=0.0_wp)
         n_own = merge(0, n, without)
         allocate (state%own_f(n_own, 3), state%own_t(n_own, 3), source=0.0_wp)
         n_own = merge(0, model%n_body, without)
         allocate (state%impulse(n_own, 3), state%angular_impulse(n_own, 3), &
            state%turn(n_own, 3), source=0.0_wp)
         p%im = model%inverse_mass*model%n_end
         do i = 1, n
            state%l(i, :) = start_spin(model, i)
         end do
      end associate
      n_own = merge(0, size(model%x0, 1), without)
      allocate (state%node, source=model%x0(:n_own, :))
      allocate (state%skew(0:model%skews%n, 9))
      state%skew = model%skews%axes
      allocate (state%joint(size(model%batch)))
      do b = 1, size(model%batch)
         call new_consistent_joint(model%batch(b), state%joint(b))
      end do
      allocate (state%part(N_SUM, model%map%part(size(model%map%part)) - 1), source=0.0_wp)
      allocate (state%wrench(N_CONSISTENT_WRENCH, model%n_element), &
         state%motion_at(size(model%motion)), &
         state%load_force(3, sum([(size(model%cload(i)%node), i=1, size(model%cload))])), &
         source=0.0_wp)
      allocate (state%field(size(model%gravity)))
      do i = 1, size(model%gravity)
         call new_gravity(model%gravity(i)%node, model%n_lead, state%field(i))
      end do
      allocate (state%load_place, source=state%load_force)
      call start_motions(model, state)
      allocate (state%kept%rates(6, size(model%hold)), state%kept%quat(4, size(model%hold)), &
         state%kept%w(3, size(model%hold)), state%kept%work(2, size(model%hold), WHOLE), &
         source=0.0_wp)
      allocate (state%mean(size(model%motion)), state%final(size(model%motion)), source=0.0_wp)
      allocate (state%active(size(model%motion)), source=.false.)
      state%work = 0.0_wp
      call settle(model, state)
      call start_energies(model, state)
   end subroutine new_consistent_state

   !> Velocities that obey conditions and imposed motion, and the forces of the present pose
   subroutine settle(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: mean(size(model%motion)), final(size(model%motion)), work
      logical :: active(size(model%motion))
      integer :: i

      work = state%work
      call motion_targets(model, state, 1.0e-30_wp, mean, final, active)
      active = active .and. model%motion%kind == 1
      do i = 1, model%n_lead
         if (.not. model%rests(i)) cycle
         state%v(i, :) = 0.0_wp
         state%l(i, :) = 0.0_wp
      end do
      call project_all(model, final, active, WHOLE, state)
      state%work = work
      call find_forces(model, 0.0_wp, final, active, state)
   end subroutine settle

   !> J w of a lead at the start; 0 where it cannot turn
   pure function start_spin(model, lead) result(l)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lead
      real(wp) :: l(3)

      real(wp) :: p(3, 3)

      l = 0.0_wp
      if (.not. maxval(model%inverse_inertia(lead, :)) > 0.0_wp) return
      p = reshape(model%axes0(lead, :), [3, 3])
      l = matmul(p, model%spin_inertia(lead, :)*matmul(model%w0(lead, :), p))
   end function start_spin

   !> Imposed accelerations start from the velocity there is
   subroutine start_motions(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: i

      do i = 1, size(model%motion)
         associate (m => model%motion(i))
            if (m%kind == IMPOSE_DISPLACEMENT) cycle
            if (m%dir <= 3) then
               state%motion_at(i) = dot_product(model%v0(m%lead, :), &
                  axis_of(state%skew, m%skew, m%dir))
            else
               state%motion_at(i) = dot_product(model%w0(m%lead, :), &
                  axis_of(state%skew, m%skew, m%dir))
            end if
         end associate
      end do
   end subroutine start_motions

   !> Effective inertia 1/(e.J1^-1 e + e.J2^-1 e) of a relative turn about e; 0 where nothing turns
   pure real(wp) function direction_inertia(model, lead, e) result(m)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: lead(2)
      real(wp), intent(in) :: e(3)

      real(wp) :: sum_inverse
      integer :: s

      sum_inverse = 0.0_wp
      do s = 1, 2
         sum_inverse = sum_inverse + sum(model%inverse_inertia(lead(s), :)* &
            matmul(e, reshape(model%axes0(lead(s), :), [3, 3]))**2)
      end do
      m = 0.0_wp
      if (sum_inverse > 0.0_wp) m = 1.0_wp/sum_inverse
   end function direction_inertia

   !> Elastic energy at the start of joints whose angles do not start at 0 or that start beyond a
   !> stop
   subroutine start_energies(model, state)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state

      integer :: b, i

      do b = 1, size(model%batch)
         associate (batch => model%batch(b), joint => state%joint(b))
            if (batch%limited) then
               do i = 1, size(joint%block)
                  joint%block(i)%elastic = joint%block(i)%elastic + joint%limit(i)%stored
               end do
            end if
            if (.not. batch%geometry%shifted) cycle
            do i = 1, batch%n
               associate (elastic => joint%block(block_of(i))%elastic(lane_of(i)))
                  elastic = elastic + spring_energy(model, batch, i)
               end associate
            end do
         end associate
      end do
   end subroutine start_energies

   !> Energy in the rotational springs of joint i at its first angles
   pure real(wp) function spring_energy(model, batch, i) result(u)
      type(consistent_model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: i

      integer :: dof

      u = 0.0_wp
      do dof = 4, 6
         associate (angle => batch%angle0(i, dof - 3), k => batch%k(i, dof))
            if (iand(batch%law(dof), LAW_SPRING_CURVE) /= 0) then
               u = u + k*curve_integral(model%curves, batch%k_curve(i, dof), 0.0_wp, angle)
            else
               u = u + 0.5_wp*k*angle**2
            end if
         end associate
      end do
   end function spring_energy

end module kj_consistent_build
