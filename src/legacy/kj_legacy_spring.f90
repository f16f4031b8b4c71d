!> Springs of /PROP/TYPE4, TYPE8 and TYPE13 in a legacy cycle: axes and displacements, laws, failure
!> and sensors, wrench on the leads, and what they ask of the time step.
!> Source: docs/theory/legacy.md 5.
module kj_legacy_spring
   use kj_kinds, only: wp
   use kj_math3, only: cross, unit
   use kj_curve, only: curve_set_t
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: joint_batch_t, SPRING4, SPRING8, SPRING13
   use kj_block, only: block_of, lane_of
   use kj_spring_law, only: spring_t, spring_block_t, base_force, rate_factor, damping_force, &
      failure, switch_spring, DEAD, ALIVE
   use kj_lead_map, only: W_FORCE, W_MOMENT1, W_MOMENT2, W_KN1, W_KN2, W_KR1, W_KR2
   use kj_legacy_joint, only: legacy_joint_t
   use kj_legacy_force, only: world_t
   implicit none
   private

   public :: add_spring_forces

   !> A spring in this cycle
   type :: motion_t
      real(wp) :: e(3, 3) = 0.0_wp               !! axes, columns, W
      real(wp) :: r(3) = 0.0_wp                  !! node 2 from node 1, W
      real(wp) :: length = 0.0_wp
      real(wp) :: q(NDOF) = 0.0_wp, dq(NDOF) = 0.0_wp   !! displacements and their change, E
      real(wp) :: f(NDOF) = 0.0_wp               !! on node 1, E
   end type motion_t

   real(wp), parameter :: LEAST = 1.0e-15_wp     !! of lengths, stiffnesses and dampings

contains

   !> Springs lo..hi of a batch: displacements, forces, energy and wrench
   pure subroutine add_spring_forces(batch, curves, world, v, mass, inertia, by_element, h, &
      keep_rates, lo, hi, joint, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(curve_set_t), intent(in) :: curves
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: v(:, :)            !! (n_node, 3) half a step ago, W
      real(wp), intent(in) :: mass(:), inertia(:)   !! (n_lead) nodal
      logical, intent(in) :: by_element          !! TYPE4 springs have a step of their own
      real(wp), intent(in) :: h                  !! step since the last call, 0 in the first
      logical, intent(in) :: keep_rates          !! store qdot, for a sample
      integer, intent(in) :: lo, hi
      type(legacy_joint_t), intent(inout) :: joint
      real(wp), contiguous, intent(inout) :: wrench(:, :)   !! (N_WRENCH, all joints)

      type(motion_t) :: m
      integer :: i, at, lane

      do i = lo, hi
         at = block_of(i)
         lane = lane_of(i)
         associate (s => joint%block(at), state => joint%spring(at), spring => batch%spring(i))
            call switch_spring(batch%kind == SPRING4, spring, world%time, h, s%q(lane, :), lane, &
               state)
            m%q = s%q(lane, :)
            m%e = reshape(s%e(lane, :), [3, 3])
            call move(batch, world, v, h, i, m)
            if (h <= 0.0_wp .and. world%time <= 0.0_wp) call set_zero(batch%kind, m, lane, state)
            call take_displacements(batch, spring, m, s%q(lane, :), state%zero(lane, 1:3))
            call find_forces(batch%kind, spring, curves, h, m, lane, state)
            s%energy(lane) = s%energy(lane) + 0.5_wp*sum(m%dq*(m%f + s%f(lane, :)))
            state%energy(lane, :) = state%energy(lane, :) + 0.5_wp*m%dq*(m%f + s%f(lane, :))
            call fail_spring(batch%kind, spring, h, m, lane, state)
            s%e(lane, :) = reshape(m%e, [9])
            s%q(lane, :) = m%q
            s%f(lane, :) = m%f
            if (keep_rates) s%qdot(lane, :) = rates(m, h)
            call put_wrench(batch, world, mass, inertia, by_element, i, m, lane, state, &
               wrench(:, batch%first + i))
         end associate
      end do
   end subroutine add_spring_forces

   pure function rates(m, h) result(rate)
      type(motion_t), intent(in) :: m
      real(wp), intent(in) :: h
      real(wp) :: rate(NDOF)

      rate = 0.0_wp
      if (h > 0.0_wp) rate = m%dq/h
   end function rates

   !> Components of a along axes; matmul would allocate
   pure function along(a, e) result(b)
      real(wp), intent(in) :: a(3), e(3, 3)
      real(wp) :: b(3)

      integer :: k

      do k = 1, 3
         b(k) = dot_product(a, e(:, k))
      end do
   end function along

   !> Axes now, and the displacements that are counted step by step; q and e are of the last cycle
   pure subroutine move(batch, world, v, h, i, m)
      type(joint_batch_t), intent(in) :: batch
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: v(:, :), h
      integer, intent(in) :: i
      type(motion_t), intent(inout) :: m

      real(wp) :: v21(3), w1(3), w2(3)

      associate (n1 => batch%node(i, 1), n2 => batch%node(i, 2))
         m%r = world%x(n2, :) - world%x(n1, :)
         m%length = sqrt(m%r(1)**2 + m%r(2)**2 + m%r(3)**2)
         v21 = v(n2, :) - v(n1, :)
      end associate
      w1 = world%w(batch%lead(i, 1), :)
      w2 = world%w(batch%lead(i, 2), :)
      select case (batch%kind)
      case (SPRING4)
         m%e = 0.0_wp
         m%e(:, 1) = m%r/max(m%length, LEAST)
      case (SPRING8)
         m%e = reshape(world%skew(batch%skew(i, 1), :), [3, 3])
         m%q(4:6) = m%q(4:6) + h*along(w2 - w1, m%e)
         if (batch%spring(i)%balanced) m%q(1:3) = m%q(1:3) + &
            h*along(v21 - cross(0.5_wp*(w1 + w2), m%r), m%e)
      case (SPRING13)
         call move_beam(v21, w1, w2, h, m)
      end select
   end subroutine move

   !> TYPE13: the axes follow the line of the nodes and the mean turn about it; a triad in the
   !> middle of the step measures what is counted
   pure subroutine move_beam(v21, w1, w2, h, m)
      real(wp), intent(in) :: v21(3), w1(3), w2(3), h
      type(motion_t), intent(inout) :: m

      real(wp) :: mid(3, 3), e2(3), turn(3), length, twist

      e2 = m%e(:, 2)
      length = norm2(m%r - 0.5_wp*h*v21)
      twist = 0.5_wp*h*dot_product(w1 + w2, unit(m%r - 0.5_wp*h*v21))
      mid = beam_axes(m%r - 0.5_wp*h*v21, e2, 0.5_wp*twist)
      m%e = beam_axes(m%r, e2, twist)
      turn = 0.5_wp*h*along(w1 + w2, mid)
      turn(2) = turn(2) + 2.0_wp*atan(0.5_wp*h*dot_product(v21, mid(:, 3))/length)
      turn(3) = turn(3) - 2.0_wp*atan(0.5_wp*h*dot_product(v21, mid(:, 2))/length)
      m%q(2) = m%q(2) - turn(3)*length
      m%q(3) = m%q(3) + turn(2)*length
      m%q(4:6) = m%q(4:6) + h*along(w2 - w1, mid)
   end subroutine move_beam

   !> Axes with e1 along r: e2 made perpendicular to it, and turned about it
   pure function beam_axes(r, e2, angle) result(e)
      real(wp), intent(in) :: r(3), e2(3), angle
      real(wp) :: e(3, 3)

      real(wp) :: y(3), z(3)

      e(:, 1) = unit(r)
      z = unit(cross(e(:, 1), e2))
      y = cross(z, e(:, 1))
      e(:, 2) = cos(angle)*y + sin(angle)*z
      e(:, 3) = cross(e(:, 1), e(:, 2))
   end function beam_axes

   !> The places of the first cycle are those without displacement
   pure subroutine set_zero(kind, m, lane, state)
      integer, intent(in) :: kind, lane
      type(motion_t), intent(in) :: m
      type(spring_block_t), intent(inout) :: state

      state%zero(lane, 1) = m%length
      if (kind == SPRING8) state%zero(lane, 1:3) = matmul(m%r, m%e)
   end subroutine set_zero

   !> Displacements that follow from the places of the nodes, and the change of all
   pure subroutine take_displacements(batch, spring, m, last, zero)
      type(joint_batch_t), intent(in) :: batch
      type(spring_t), intent(in) :: spring
      type(motion_t), intent(inout) :: m
      real(wp), intent(in) :: last(NDOF), zero(3)

      if (batch%kind /= SPRING8) then
         m%q(1) = m%length - zero(1)
      else if (.not. spring%balanced) then
         m%q(1:3) = matmul(m%r, m%e) - zero
      end if
      m%dq = m%q - last
   end subroutine take_displacements

   !> Forces of the laws; 0 while the spring is not alive, though its memory goes on
   pure subroutine find_forces(kind, spring, curves, h, m, lane, state)
      integer, intent(in) :: kind, lane
      type(spring_t), intent(in) :: spring
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: h
      type(motion_t), intent(inout) :: m
      type(spring_block_t), intent(inout) :: state

      real(wp) :: rate(NDOF), per
      integer :: k

      per = 1.0_wp
      if (spring%per_length) per = state%zero(lane, 1)
      rate = rates(m, h)/per
      m%f = 0.0_wp
      do k = 1, merge(1, NDOF, kind == SPRING4)
         associate (law => spring%dof(k))
            call base_force(law, curves, m%q(k)/per, m%dq(k)/per, m%length, state%base(lane, k), &
               state%hi(lane, k), state%lo(lane, k))
            if (state%alive(lane) < ALIVE) cycle
            m%f(k) = rate_factor(law, curves, rate(k))*state%base(lane, k) + &
               damping_force(law, curves, rate(k))
         end associate
      end do
   end subroutine find_forces

   !> A spring that is beyond its limits has no stiffness any more, and no force from the next cycle
   !> on
   pure subroutine fail_spring(kind, spring, h, m, lane, state)
      integer, intent(in) :: kind, lane
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: h
      type(motion_t), intent(in) :: m
      type(spring_block_t), intent(inout) :: state

      real(wp) :: q(NDOF)

      if (state%alive(lane) < ALIVE) return
      q = m%q
      if (kind == SPRING4) then
         if (q(1) > spring%dof(1)%hi .or. q(1) < spring%dof(1)%lo) state%alive(lane) = DEAD
         return
      end if
      if (spring%per_length) q = q/state%zero(lane, 1)
      call failure(spring, q, rates(m, h), m%f, state%energy(lane, :), h, state%damage(lane))
      if (state%damage(lane) >= 1.0_wp) state%alive(lane) = DEAD
   end subroutine fail_spring

   !> Force and moments on the leads, and the stiffness they feel.
   !>
   !> An end of a balanced spring, and of a beam, has half of the couple r x F; else there is none
   pure subroutine put_wrench(batch, world, mass, inertia, by_element, i, m, lane, state, wrench)
      type(joint_batch_t), intent(in) :: batch
      type(world_t), intent(in) :: world
      real(wp), intent(in) :: mass(:), inertia(:)
      logical, intent(in) :: by_element
      integer, intent(in) :: i, lane
      type(motion_t), intent(in) :: m
      type(spring_block_t), intent(inout) :: state
      real(wp), intent(out) :: wrench(:)

      real(wp) :: force(3), moment(3), couple(3), arm(3, 2), kn(2), kr(2)
      integer :: e

      force = matmul(m%e, m%f(1:3))
      moment = matmul(m%e, m%f(4:6))
      couple = 0.0_wp
      if (batch%spring(i)%balanced .or. batch%kind == SPRING13) couple = 0.5_wp*cross(m%r, force)
      do e = 1, 2
         arm(:, e) = world%x(batch%node(i, e), :) - world%x(batch%lead(i, e), :)
      end do
      wrench(W_FORCE:W_FORCE + 2) = force
      wrench(W_MOMENT1:W_MOMENT1 + 2) = moment + couple + cross(arm(:, 1), force)
      wrench(W_MOMENT2:W_MOMENT2 + 2) = couple - moment - cross(arm(:, 2), force)
      state%step(lane) = huge(1.0_wp)
      kn = 0.0_wp
      kr = 0.0_wp
      if (state%alive(lane) >= ALIVE) then
         if (batch%kind == SPRING4) then
            call ask_line(batch, i, mass, by_element, state%zero(lane, 1), kn, state%step(lane))
         else
            call ask_six(batch, i, mass, inertia, m%length, state%zero(lane, 1), kn, kr, &
               state%step(lane))
         end if
      end if
      wrench(W_KN1) = kn(1)
      wrench(W_KN2) = kn(2)
      wrench(W_KR1) = kr(1) + kn(1)*sum(arm(:, 1)**2)
      wrench(W_KR2) = kr(2) + kn(2)*sum(arm(:, 2)**2)
   end subroutine put_wrench

   !> TYPE4: stiffness on its nodes, each with its own mass, or by the step of the element
   pure subroutine ask_line(batch, i, mass, by_element, length0, kn, step)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp), intent(in) :: mass(:)
      logical, intent(in) :: by_element
      real(wp), intent(in) :: length0
      real(wp), intent(inout) :: kn(2), step

      real(wp) :: k, c, m, own
      integer :: e

      associate (spring => batch%spring(i))
         k = spring%dof(1)%k_step
         c = spring%dof(1)%c_step
         m = spring%mass
         if (spring%per_length) then
            k = k/length0
            c = c/length0
            m = m*length0
         end if
         if (by_element) then
            step = m/max(LEAST, c + sqrt(c**2 + m*k))
            kn = m/step**2
            return
         end if
         do e = 1, 2
            own = spring%node_mass(e)
            if (batch%node(i, e) == batch%lead(i, e)) own = mass(batch%lead(i, e))
            kn(e) = stiffness_of(k, c, 2.0_wp*own)
         end do
      end associate
   end subroutine ask_line

   !> TYPE8 and TYPE13: stiffness on their nodes, with the mass of the body where that is larger,
   !> and the step of the element
   pure subroutine ask_six(batch, i, mass, inertia, length, length0, kn, kr, step)
      type(joint_batch_t), intent(in) :: batch
      integer, intent(in) :: i
      real(wp), intent(in) :: mass(:), inertia(:), length, length0
      real(wp), intent(inout) :: kn(2), kr(2), step

      real(wp) :: k(2), c(2), m(2)
      integer :: e

      associate (spring => batch%spring(i))
         k = [maxval(spring%dof(1:3)%k_step), maxval(spring%dof(4:6)%k_step)]
         c = [max_damping(spring, 1), max_damping(spring, 4)]
         m = [spring%mass, spring%inertia]
         if (spring%per_length) then
            k = k/length0
            c = c/length0
            m = m*length0
         end if
         if (batch%kind == SPRING13) k(2) = k(2) + maxval(spring%dof(2:3)%k_step)*length**2
         do e = 1, 2
            associate (lead => batch%lead(i, e), on_body => batch%node(i, e) /= batch%lead(i, e))
               kn(e) = stiffness_of(k(1), c(1), felt_mass(on_body, spring%node_mass(e), &
                  mass(lead), m(1)))
               kr(e) = stiffness_of(k(2), c(2), felt_mass(on_body, spring%node_inertia(e), &
                  inertia(lead), m(2)))
            end associate
         end do
         if (spring%balanced) kr = kr + length**2*kn(2:1:-1)
         where (c + k < LEAST) m = 1.0_wp
         step = minval(m/max(LEAST, c + sqrt(c**2 + m*max(k, LEAST))))
      end associate
   end subroutine ask_six

   pure real(wp) function max_damping(spring, first) result(c)
      type(spring_t), intent(in) :: spring
      integer, intent(in) :: first               !! 1 or 4

      c = maxval(spring%dof(first:first + 2)%c) + &
         maxval(spring%dof(first:first + 2)%c_step - spring%dof(first:first + 2)%c)
   end function max_damping

   !> Twice the mass, or inertia, that a node shows to its spring
   pure real(wp) function felt_mass(on_body, own, of_lead, of_spring) result(m)
      logical, intent(in) :: on_body             !! a secondary node
      real(wp), intent(in) :: own, of_lead, of_spring

      m = 2.0_wp*of_lead
      if (on_body) m = 2.0_wp*max(own, of_lead)
      if (on_body .and. abs(own) <= 0.0_wp .or. abs(m) <= 0.0_wp) m = of_spring
   end function felt_mass

   !> (C + sqrt(C^2 + K m))^2/m, and what is left of it where one of them is 0
   pure real(wp) function stiffness_of(k, c, m) result(s)
      real(wp), intent(in) :: k, c, m

      s = k
      if (.not. (abs(c) > 0.0_wp .and. abs(m) > 0.0_wp)) return
      s = 4.0_wp*c**2/m
      if (abs(k) > 0.0_wp) s = (c + sqrt(c**2 + k*m))**2/m
   end function stiffness_of

end module kj_legacy_spring
