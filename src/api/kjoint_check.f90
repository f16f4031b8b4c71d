!> Bodies of the public module: what a scene is like before it runs.
submodule (kjoint:kjoint_run) kjoint_check
   use kj_joint_types, only: NDOF
   use kj_joint_batch, only: blocking_stiffness, joint_batch_t, LAW_SPRING_CURVE, &
      LAW_DAMPER_CURVE, has_friction
   use kj_curve, only: curve_set_t, law_value
   use kj_model, only: model_t, joint_title, body_title, SCALE_NONE
   use kj_consistent_state, only: consistent_state_t
   use kj_consistent_auto_stiffness, only: start_scene
   use kj_scheme, only: critical_factor, scheme_t, start_scheme, go_on, is_over, warn_after
   use kj_scheme_check, only: refuse_years
   use kj_system, only: wall_clock
   use kj_consistent_safe_step, only: bound_t, new_bound
   use kj_islands, only: find_islands, island_steps
   use kj_consistent_nodal_step, only: exact_bound
   use kj_consistent_compliant_check, only: compliant_outlook
   implicit none

   real(wp), parameter :: TRY = 0.02_wp          !! [s] of wall clock
   integer, parameter :: MOST_DOFS = 3000        !! of the eigenvalue problem of the whole scene

contains

   module procedure check_simulation
      report%n_node = sim%model%n_node
      report%n_free = sim%model%n_lead - sim%model%n_body
      report%n_curve = sim%model%curves%n
      report%n_load = size(sim%model%cload) + size(sim%model%gravity)
      call tell_joints(sim%model%model_t, report)
      call tell_stops(sim%model%model_t, report)
      call tell_bodies(sim%model%model_t, report)
      call tell_limits(sim%model%model_t, report)
      report%factor = critical_factor(sim%scheme, sim%model)
      report%t_stop = sim%model%control%t_stop
      call try_run(sim, report, error)
   end procedure check_simulation

   !> Begin to run a copy, from where the scene stands: how long the whole run takes, and what ends
   !> it at once
   subroutine try_run(sim, report, error)
      type(simulation_t), intent(in) :: sim
      type(check_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error

      type(consistent_model_t) :: model
      type(scheme_t) :: scheme
      type(error_t), allocatable :: late         ! not told: it depends on the clock
      real(wp) :: clock

      integer :: first

      call refuse_begin(sim, error)
      if (allocated(error)) return
      model = sim%model
      scheme = sim%scheme
      if (.not. sim%restored) call start_scheme(model, scheme, error)
      if (allocated(error)) return
      first = scheme%now%cycle
      call refuse_years(model%model_t, scheme, .false., report%cycles, error)
      if (allocated(error)) return
      if (is_over(model%model_t, scheme)) then
         call warn_after(model%model_t, scheme, report%warnings)
         return
      end if
      report%values = sim%history%n_value
      clock = wall_clock()
      call go_on(model, scheme, error)           ! as many cycles on any machine
      if (allocated(error)) return
      call refuse_years(model%model_t, scheme, .false., report%cycles, late)
      report%cycles = report%cycles + real(scheme%now%cycle - first, wp)
      do
         if (allocated(late) .or. is_over(model%model_t, scheme)) exit
         if (wall_clock() - clock > TRY) exit
         call go_on(model, scheme, late)
      end do
      report%seconds = (wall_clock() - clock)/real(max(1, scheme%now%cycle - first), wp)* &
         report%cycles
      report%samples = report%cycles
      if (model%control%sample > 0.0_wp) report%samples = min(report%cycles, 1.0_wp + &
         model%control%t_stop/model%control%sample)
   end subroutine try_run

   !> Type, ends, frame, length, stiffness and damping of each joint
   subroutine tell_joints(model, report)
      type(model_t), intent(in) :: model
      type(check_t), intent(inout) :: report

      integer :: j, n, p, e

      n = model%n_element
      report%n_spring = model%n_spring
      report%joint = model%joint%id
      report%property = model%joint%property
      report%row = model%joint%row
      allocate (report%joint_title(n))
      allocate (report%kind(n), report%frame(n), report%node(2, n), report%automatic(n))
      allocate (report%body(2, n), source=0)
      allocate (report%length(n), report%blocking(2, n), report%ratio(n), source=0.0_wp)
      do j = 1, n
         p = model%joint(j)%place
         report%joint_title(j)%s = joint_title(model, j)
         associate (b => model%batch(model%joint(j)%batch), node => model%joint(j)%node)
            report%kind(j) = b%kind
            report%frame(j) = b%frame
            report%node(:, j) = model%node_id(node)
            do e = 1, 2
               if (model%lead(node(e)) <= model%n_body) &
                  report%body(e, j) = model%body_id(model%lead(node(e)))
            end do
            report%length(j) = norm2(model%x0(node(2), :) - model%x0(node(1), :))
            report%automatic(j) = .false.
            if (b%limited) report%automatic(j) = b%limit%automatic(p)
            report%blocking(:, j) = blocking_stiffness(b, p)
            report%ratio(j) = damping_ratio(model%curves, b%law, b%k(p, :), b%c(p, :), &
               b%k_curve(p, :), b%c_curve(p, :), b%reduced(p, :))
         end associate
      end do
   end subroutine tell_joints

   !> Stops, friction and locks of KJOINT2
   subroutine tell_stops(model, report)
      type(model_t), intent(in) :: model
      type(check_t), intent(inout) :: report

      type(limit_row_t) :: row
      integer :: j, dof

      allocate (report%t_lock(model%n_element), report%t_free(model%n_element), source=huge(1.0_wp))
      allocate (report%limit(0))
      do j = 1, model%n_joint
         associate (b => model%batch(model%joint(j)%batch), p => model%joint(j)%place)
            if (.not. b%limited) cycle
            report%t_lock(j) = b%limit%t_lock(p)
            report%t_free(j) = b%limit%t_free(p)
            do dof = 1, NDOF
               row = limit_row(model, b, p, dof)
               row%joint = j
               if (row%lo < 0.0_wp .or. row%hi > 0.0_wp .or. row%slip > 0.0_wp) &
                  report%limit = [report%limit, row]
            end do
         end associate
      end do
   end subroutine tell_stops

   !> Stop and friction of one direction of joint p of a batch
   pure function limit_row(model, b, p, dof) result(row)
      type(model_t), intent(in) :: model
      type(joint_batch_t), intent(in) :: b
      integer, intent(in) :: p, dof
      type(limit_row_t) :: row

      associate (l => b%limit)
         row%dof = dof
         row%lo = l%lo(p, dof)
         row%hi = l%hi(p, dof)
         row%combined = l%combined(p, dof) > 0.0_wp
         row%stop_k = l%k(p, dof)
         if (.not. row%stop_k > 0.0_wp) row%stop_k = l%k_block(p, merge(1, 2, dof <= 3))
         if (.not. has_friction(l%k(p, dof), l%slip(p, dof), l%slip_curve(p, dof))) return
         row%slip = l%slip(p, dof)
         row%slip_k = l%k(p, dof)
         if (l%slip_curve(p, dof) > 0) row%slip_curve = model%curves%id(l%slip_curve(p, dof))
      end associate
   end function limit_row

   !> Largest c/(2 sqrt(k m)) of all dofs with a stiffness; curves count with their slope at 0
   pure real(wp) function damping_ratio(curves, law, k, c, k_curve, c_curve, reduced) result(ratio)
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: law(NDOF), k_curve(NDOF), c_curve(NDOF)
      real(wp), intent(in) :: k(NDOF), c(NDOF)   !! or scales of curves
      real(wp), intent(in) :: reduced(2)         !! mass and inertia

      real(wp) :: stiffness, damping, m, y, slope
      integer :: dof

      ratio = 0.0_wp
      do dof = 1, NDOF
         stiffness = k(dof)
         damping = c(dof)
         m = reduced(merge(1, 2, dof <= 3))
         if (iand(law(dof), LAW_SPRING_CURVE) /= 0) then
            call law_value(curves, k_curve(dof), 0.0_wp, y, slope)
            stiffness = k(dof)*slope
         end if
         if (iand(law(dof), LAW_DAMPER_CURVE) /= 0) then
            call law_value(curves, c_curve(dof), 0.0_wp, y, slope)
            damping = c(dof)*slope
         end if
         if (.not. stiffness*m > 0.0_wp) cycle
         ratio = max(ratio, damping/(2.0_wp*sqrt(stiffness*m)))
      end do
   end function damping_ratio

   !> Mass, inertia, centre, joints and conditions of each body
   subroutine tell_bodies(model, report)
      type(model_t), intent(in) :: model
      type(check_t), intent(inout) :: report

      integer :: i, n

      n = model%n_body
      report%body_id = model%body_id
      allocate (report%body_title(n))
      do i = 1, n
         report%body_title(i)%s = body_title(model, i)
      end do
      report%n_secondary = model%n_secondary
      report%n_joint = model%map%first(2:n + 1) - model%map%first(:n)
      report%mass = model%mass(:n)
      report%inertia = transpose(model%principal)
      report%centre = transpose(model%x0(:n, :))
      allocate (report%held(6, n), source=.false.)
      allocate (report%n_driven(n), source=0)
      do i = 1, size(model%bcs)
         if (model%bcs(i)%lead <= n) report%held(:, model%bcs(i)%lead) = model%bcs(i)%fixed
      end do
      do i = 1, size(model%motion)
         associate (lead => model%motion(i)%lead)
            if (lead <= n) report%n_driven(lead) = report%n_driven(lead) + 1
         end associate
      end do
   end subroutine tell_bodies

   !> Limits of the time step in the first pose
   subroutine tell_limits(model, report)
      type(model_t), intent(in) :: model
      type(check_t), intent(inout) :: report

      type(consistent_model_t) :: scene
      type(consistent_state_t) :: state
      type(bound_t) :: bound
      type(error_t), allocatable :: error
      integer, allocatable :: island(:)
      integer :: n

      ! a stiffness that nothing tells yet is left 0
      scene%model_t = model
      call start_scene(scene, .false., .true., state, error)
      call new_bound(scene, .false., state, bound)
      report%safe_step = bound%h
      call find_islands(model, island, n)
      report%island_step = island_steps(model, island, n, bound%limit)
      call radioss_step(model, report%nodal_step)
      call exact_bound(scene, state, bound, MOST_DOFS, report%exact_step)
      call sort_limits()
      if (allocated(error)) return
      call compliant_outlook(scene, state, report%turn_step, report%n_solve, report%spring_step, &
         report%stiffest, report%n_redundant)

   contains

      !> Batch order to deck order
      subroutine sort_limits()
         integer :: j, at

         allocate (report%step(model%n_element))
         do j = 1, model%n_element
            at = model%batch(model%joint(j)%batch)%first + model%joint(j)%place
            report%step(j) = bound%limit(at)
            if (bound%joint == at) report%safe_joint = j
         end do
      end subroutine sort_limits
   end subroutine tell_limits

   !> The step of the first cycle of Radioss without /DT, unscaled; huge where nothing limits it
   subroutine radioss_step(model, step)
      type(model_t), intent(in) :: model
      real(wp), intent(out) :: step

      type(consistent_model_t) :: scene
      type(scheme_t) :: scheme
      type(error_t), allocatable :: error        ! told by the trial run
      real(wp), parameter :: NO_LIMIT = 0.99e6_wp

      scene%model_t = model
      scene%control%dt_ini = 0.0_wp
      scene%control%dt_max = huge(1.0_wp)
      scene%control%below_min = SCALE_NONE
      scheme%legacy = .true.
      call start_scheme(scene, scheme, error)
      step = huge(1.0_wp)
      if (scheme%now%step < NO_LIMIT) step = scheme%now%step/model%control%dt_factor
   end subroutine radioss_step

end submodule kjoint_check
