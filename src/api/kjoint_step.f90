!> A scene that its host steps, samples and asks.
submodule (kjoint:kjoint_run) kjoint_step
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kj_math3, only: to_quaternion
   use kj_joint_types, only: joint_types
   use kj_series, only: channel_path
   use kj_scheme, only: advance_to, node_place, NEVER
   use kj_host_build, only: take_model
   use kj_checkpoint, only: save_scene, restore_scene
   implicit none

contains

   module procedure start_simulation
      call check_loaded(sim, error)
      if (.not. allocated(error)) call refuse_later_run(sim, error)
      if (allocated(error)) return
      if (sim%options%islands) then
         call fail(error, ERR_INPUT, 'islands march by themselves: a host steps one scene')
         return
      end if
      call start_scheme(sim%model, sim%scheme, error)
      sim%started = .not. allocated(error)
      sim%restored = .false.
   end procedure start_simulation

   module procedure save_simulation
      call check_started(sim, error)
      if (.not. allocated(error)) call save_scene(sim%options, sim%history, sim%rows, sim%model, &
         sim%scheme, sim%sampler, .true., state)
   end procedure save_simulation

   module procedure restore_simulation
      integer(int8), allocatable :: byte(:)
      logical :: lost

      call check_loaded(sim, error)
      if (.not. allocated(error) .and. .not. (sim%started .or. sim%restored)) &
         call start_scheme(sim%model, sim%scheme, error)
      if (allocated(error)) return
      byte = state
      call restore_scene(byte, sim%options, sim%history, sim%rows, sim%model, sim%scheme, &
         sim%sampler, lost, error)
      sim%restored = .not. allocated(error)
      if (lost) sim%started = .false.
      if (sim%restored) sim%started = .not. sim%options%islands
   end procedure restore_simulation

   module procedure advance_simulation
      call check_started(sim, error)
      if (.not. allocated(error) .and. .not. ieee_is_finite(until)) &
         call fail(error, ERR_INPUT, 'the time is not finite')
      if (allocated(error)) return
      call advance_to(until, huge(1), sim%model, sim%scheme, error)
      sim%started = .not. allocated(error)
   end procedure advance_simulation

   module procedure step_simulation
      integer :: n

      n = 1
      if (present(steps)) n = steps
      call check_started(sim, error)
      if (.not. allocated(error) .and. n < 0) &
         call fail(error, ERR_INPUT, 'the number of steps is negative')
      if (allocated(error)) return
      call advance_to(NEVER, n, sim%model, sim%scheme, error)
      sim%started = .not. allocated(error)
   end procedure step_simulation

   subroutine check_started(sim, error)
      type(simulation_t), intent(in) :: sim
      type(error_t), allocatable, intent(out) :: error

      if (sim%running) then
         call fail(error, ERR_INPUT, RUNS)
      else if (.not. sim%started) then
         call fail(error, ERR_INPUT, 'the simulation is not started, or an error has ended it')
      end if
   end subroutine check_started

   module procedure simulation_status
      if (sim%loaded) call tell(sim, status)
   end procedure simulation_status

   module procedure simulation_history
      if (sim%loaded) history = sim%history
   end procedure simulation_history

   module procedure sample_simulation
      row = 0.0_wp
      call check_started(sim, error)
      if (allocated(error)) return
      if (size(row) /= sim%history%n_value) then
         call fail(error, ERR_INPUT, 'a row has '//str(sim%history%n_value)//' numbers, not '// &
            str(size(row)))
         return
      end if
      call fill_row(sim, row, error)
   end procedure sample_simulation

   module procedure channel_values
      integer :: i

      if (size(row) /= history%n_value .or. .not. allocated(history%variable)) then
         call fail(error, ERR_INPUT, 'a row has '//str(history%n_value)//' numbers, not '// &
            str(size(row)))
         return
      end if
      do i = 1, size(history%variable)
         associate (v => history%variable(i))
            if (channel_path(v%channel) /= name) cycle
            values = reshape(row(v%first:v%first + v%n_comp*v%n_entity - 1), [v%n_comp, v%n_entity])
            return
         end associate
      end do
      call fail(error, ERR_INPUT, 'the history has no channel '//trim(name))
   end procedure channel_values

   module procedure simulation_bodies
      allocate (ids(0))
      if (sim%loaded) ids = sim%model%body_id
   end procedure simulation_bodies

   module procedure simulation_joints
      allocate (ids(0))
      if (sim%loaded) ids = sim%model%joint(:sim%model%n_joint)%id
   end procedure simulation_joints

   module procedure body_state
      integer :: b
      real(wp) :: p(3, 3)

      call find_body(sim, id, b, error)
      if (allocated(error)) return
      call show(sim%model, sim%scheme)
      body%id = id
      associate (s => sim%scheme%now)
         body%mass = s%mass(b)
         body%position = s%x(b, :)
         p = matmul(reshape(s%p(b, :), [3, 3]), transpose(reshape(sim%model%axes(b, :), [3, 3])))
         body%attitude = to_quaternion(p)
         body%velocity = s%v(b, :)
         body%omega = s%w(b, :)
         body%force = s%f(b, :)
         body%moment = s%m(b, :)
      end associate
   end procedure body_state

   !> Index of a body. Errors: ERR_INPUT
   subroutine find_body(sim, id, b, error)
      type(simulation_t), intent(in) :: sim
      integer, intent(in) :: id
      integer, intent(out) :: b
      type(error_t), allocatable, intent(out) :: error

      b = 0
      call check_started(sim, error)
      if (allocated(error)) return
      b = findloc(sim%model%body_id, id, 1)
      if (b == 0) call fail(error, ERR_INPUT, 'there is no rigid body '//str(id))
   end subroutine find_body

   !> Index of a joint. Errors: ERR_INPUT
   subroutine find_joint(sim, id, j, error)
      type(simulation_t), intent(in) :: sim
      integer, intent(in) :: id
      integer, intent(out) :: j
      type(error_t), allocatable, intent(out) :: error

      j = 0
      call check_started(sim, error)
      if (allocated(error)) return
      j = findloc(sim%model%joint(:sim%model%n_joint)%id, id, 1)
      if (j == 0) call fail(error, ERR_INPUT, 'there is no joint '//str(id))
   end subroutine find_joint

   module procedure node_position
      integer :: i

      x = 0.0_wp
      call check_started(sim, error)
      if (allocated(error)) return
      i = findloc(sim%model%node_id, id, 1)
      if (i > 0) x = node_place(sim%model, sim%scheme, i)
      if (i == 0) call fail(error, ERR_INPUT, 'there is no node '//str(id))
   end procedure node_position

   module procedure joint_state
      integer :: j

      call find_joint(sim, id, j, error)
      if (allocated(error)) return
      call show(sim%model, sim%scheme)
      associate (ref => sim%model%joint(j), i => sim%model%joint(j)%place)
         result%id = id
         result%type = joint_types(ref%row)%id
         associate (s => sim%scheme%now%joint(ref%batch))
            result%force = s%f(i, :)
            result%displacement = s%q(i, :)
            result%frame = reshape(s%e(i, :), [3, 3])
            result%energy = s%energy(i)
            result%dissipated = s%dissipated(i)
            result%orthogonality = s%ortho(i)
         end associate
      end associate
   end procedure joint_state

   module procedure take_joints
      if (.not. sim%loaded) then
         call fail(error, ERR_INPUT, 'no deck is loaded')
      else if (.not. set%made .or. set%started) then
         call fail(error, ERR_INPUT, 'the set of joints is not new')
      else if (set%n_spec > 0 .or. set%model%curves%n > 0) then
         call fail(error, ERR_INPUT, 'the set already holds joints or curves')
      else if (set%legacy .neqv. sim%scheme%legacy) then
         call fail(error, ERR_INPUT, 'the deck was loaded for another formulation than the set')
      end if
      if (allocated(error)) return
      call take_model(set, sim%model%model_t, node_id, error, attitude)
      if (allocated(error)) set%made = .false.
   end procedure take_joints

end submodule kjoint_step
