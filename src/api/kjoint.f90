!> The public module of kjoint: everything an embedder uses.
!>
!> Two levels. Element level: the host owns nodes, masses and time, a joint_set_t gives it the
!> forces of joints (new_joint_set, add_joint, start_joints or take_joints; then joint_forces once a
!> cycle). Model level: a simulation_t is loaded from a deck and run (load_simulation,
!> run_simulation), or stepped by the host (start_simulation, advance_simulation). There is no
!> module state: sets and simulations live side by side, in threads, too. docs/embedding.md is the
!> guide.
!>
!> Units are those that the host or the deck chose; angles are in radian; W is the global frame.
!> One file: what an embedder may use stands in one list.
module kjoint
   use, intrinsic :: iso_fortran_env, only: int8
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, ERR_RUN, ERR_INPUT, ERR_FILE, ERR_INTERNAL, &
      SEV_NOTE, SEV_WARNING, SEV_ERROR
   use kj_version, only: KJOINT_VERSION
   use kj_consistent_state, only: consistent_model_t
   use kj_channels, only: OF_JOINT, OF_BODY, OF_NODE, OF_SPRING
   use kj_history, only: history_t
   use kj_sample, only: sampler_t
   use kj_extremes, only: extremes_t
   use kj_sink, only: sink_t, sink_memory_t
   use kj_extract_report, only: extract_report_t
   use kj_run_option, only: run_options_t, run_options, set_run_option, find_run_option, &
      read_run_options, write_run_options
   use kj_scheme, only: scheme_t
   use kj_trace, only: trace_plan_t, trace_t, traced_lead_t, TRACE_NAME, TRACE_JOINT, &
      TRACE_SPRING, TRACE_BODY, TRACE_NODE
   use kj_host, only: joint_set_t, joint_spec_t, joint_result_t
   use kj_host_build, only: new_joint_set, add_joint_curve, add_joint, start_joints
   use kj_host_state, only: joint_state_size, save_joints, restore_joints, joint_forces, &
      joint_stiffness, critical_step, joint_count, joint_result, joint_energy, joint_warnings
   use kj_text, only: text_t
   implicit none
   private

   public :: wp, error_t, finding_list_t, sink_t, history_t, KJOINT_VERSION, OF_JOINT, OF_BODY, &
      OF_NODE, OF_SPRING, ERR_RUN, ERR_INPUT, ERR_FILE, ERR_INTERNAL, SEV_NOTE, SEV_WARNING, &
      SEV_ERROR, run_options_t, run_options, set_run_option, find_run_option, read_run_options, &
      write_run_options, run_status_t, simulation_t, monitor_t, beside_t, trace_simulation, &
      trace_t, traced_lead_t, TRACE_NAME, TRACE_JOINT, TRACE_SPRING, TRACE_BODY, TRACE_NODE, &
      simulation_worst, extremes_t, load_simulation, run_simulation, run_simulations, &
      simulation_title, simulation_reach, simulation_options, simulation_checkpoints, &
      default_output, check_t, limit_row_t, check_simulation, extract_report_t, extract_mechanism, &
      holds_engine, start_simulation, advance_simulation, step_simulation, simulation_status, &
      save_simulation, restore_simulation, simulation_history, sample_simulation, channel_values, &
      sink_memory_t, body_state_t, simulation_bodies, simulation_joints, body_state, &
      node_position, joint_state, set_body_load, set_load_factor, set_body_velocity, &
      set_body_pose, lock_joint, joint_set_t, joint_spec_t, joint_result_t, new_joint_set, &
      add_joint_curve, add_joint, start_joints, take_joints, joint_forces, joint_stiffness, &
      critical_step, joint_count, joint_result, joint_energy, joint_warnings, joint_state_size, &
      save_joints, restore_joints

   !> Stop and friction of one direction of a joint; stops 0 and a friction limit 0: none
   type :: limit_row_t
      integer :: joint = 0                        !! index among the joints of the report
      integer :: dof = 0                          !! direction, 1-6
      real(wp) :: lo = 0.0_wp, hi = 0.0_wp        !! stops
      logical :: combined = .false.               !! one circle or sphere with others
      real(wp) :: stop_k = 0.0_wp                 !! stiffness of the stops; 0: automatic
      real(wp) :: slip = 0.0_wp                   !! limit of friction, or scale of its function
      integer :: slip_curve = 0                   !! id of the function, 0 = none
      real(wp) :: slip_k = 0.0_wp                 !! stiffness of friction
   end type limit_row_t

   !> Joints, bodies and time-step limits; all in work units, ids are those of the deck
   type :: check_t
      integer :: n_spring = 0                     !! the last ones of the joints
      integer :: n_node = 0, n_free = 0, n_curve = 0, n_load = 0
      ! limits of the time step, before any factor
      real(wp) :: nodal_step = 0.0_wp             !! the rule of Radioss; huge: nothing limits it
      real(wp) :: safe_step = 0.0_wp              !! stable for certain
      real(wp) :: exact_step = 0.0_wp             !! of the assembled scene; 0: too large to tell
      ! of the integrator compliant, at the start
      real(wp) :: turn_step = 0.0_wp              !! by the turn of the bodies; huge: no limit
      integer :: n_solve = 1                      !! solves that make such a step
      real(wp) :: spring_step = 0.0_wp            !! by explicit springs, friction; huge: none
      real(wp) :: stiffest = 0.0_wp               !! frequency of the stiffest blocked row alone
      integer :: n_redundant = 0                  !! blocked rows that repeat others; -1: too many
      real(wp) :: factor = 0.0_wp                 !! on the critical step, of deck or options
      integer :: safe_joint = 0                   !! place of the joint that holds it, 0 = none
      real(wp) :: t_stop = 0.0_wp                 !! end of a run
      real(wp) :: cycles = 0.0_wp                 !! of a run, about
      real(wp) :: seconds = 0.0_wp                !! that it takes by the pace of its first cycles
      real(wp) :: samples = 0.0_wp                !! that it writes, each of `values` numbers
      integer :: values = 0
      type(finding_list_t) :: warnings            !! of a run that would end at once
      real(wp), allocatable :: island_step(:)     !! safe steps of islands; huge: none
      ! joints in deck order, then springs in deck order
      integer, allocatable :: joint(:), property(:)   !! (n_joint)
      type(text_t), allocatable :: joint_title(:) !! (n_joint) "pin C (903)", or the id alone
      integer, allocatable :: row(:)              !! (n_joint) of kj_joint_types
      integer, allocatable :: kind(:)             !! (n_joint) KJOINT, KJOINT2, SPRING4 or SPRING8
      integer, allocatable :: frame(:)            !! (n_joint) FRAME_ constant
      integer, allocatable :: node(:, :), body(:, :)  !! (2, n_joint); body 0 = a free node
      real(wp), allocatable :: length(:)          !! (n_joint) from node 1 to node 2
      !> (2, n_joint) stiffness of the blocked translations and rotations, 0 = none or not yet known
      real(wp), allocatable :: blocking(:, :)
      logical, allocatable :: automatic(:)        !! (n_joint) blocking comes from the first step
      real(wp), allocatable :: ratio(:)           !! (n_joint) largest damping ratio of all dofs
      real(wp), allocatable :: step(:)            !! (n_joint) critical step of the joint alone
      real(wp), allocatable :: t_lock(:), t_free(:)   !! (n_element) locked from, to; huge: never
      !> stops and friction, in deck order of the joints; KJOINT2 only
      type(limit_row_t), allocatable :: limit(:)
      ! bodies in ascending id
      integer, allocatable :: body_id(:), n_secondary(:), n_joint(:)   !! (n_body)
      type(text_t), allocatable :: body_title(:)  !! (n_body) as of joints
      real(wp), allocatable :: mass(:)            !! (n_body)
      real(wp), allocatable :: inertia(:, :)      !! (3, n_body) principal, descending
      real(wp), allocatable :: centre(:, :)       !! (3, n_body) centre of gravity, W
      logical, allocatable :: held(:, :)          !! (6, n_body) blocked by conditions
      integer, allocatable :: n_driven(:)         !! (n_body) imposed motions
   end type check_t

   ! model level, stepped by the host
   ! element level

   character(len=*), parameter :: RUNS = &
      'the simulation runs: who watches it may read its status and stop it'

   !> Where a run stands
   type :: run_status_t
      integer :: cycle = 0
      real(wp) :: time = 0.0_wp, t_stop = 0.0_wp, time_step = 0.0_wp
      character(len=8) :: owner_kind = 'none'   !! what limits the step: none, node, body, joint
      integer :: owner = 0                      !! its user id
      real(wp) :: energy_error = 0.0_wp         !! fraction, of the last sample
      !> energies of the last sample
      real(wp) :: kinetic = 0.0_wp, internal = 0.0_wp, work = 0.0_wp
      real(wp) :: kinetic_rot = 0.0_wp          !! of kinetic, that of turning
      real(wp) :: mass = 0.0_wp                 !! of all
      integer :: n_joint = 0, n_body = 0, n_node = 0, n_spring = 0
      real(wp) :: joint_cycles = 0.0_wp         !! steps of all joints so far
      real(wp) :: cycles_to_go = 0.0_wp         !! to the end of the run, about, as it began
      integer :: n_island = 0                   !! of a run by islands; 0: all on one step
      integer :: n_part = 1                     !! groups of islands that share a step
      integer :: least_cycle = 0                !! cycles of the part with the fewest
      integer :: n_halved = 0                   !! steps of compliant that did not converge
      !> of compliant: what joints give way by, over the size of the scene or in rad, where that is
      !> much of the error that was asked for; how they ring is not seen
      real(wp) :: unresolved = 0.0_wp
      !> cycles that compliant would take for the error of the joints, and that error; 0: none told
      real(wp) :: compliant_steps = 0.0_wp, compliant_error = 0.0_wp
      integer :: n_sample = 0                   !! rows given to the sink
      integer :: print_every = 100              !! /PRINT: cycles between listing lines
      real(wp) :: wall_solve = 0.0_wp, wall_output = 0.0_wp            !! [s] of wall clock
      real(wp) :: wall_start = 0.0_wp            !! [s] of wall_solve, before the first step
      type(finding_list_t) :: warnings          !! what showed during the run, at its end
   end type run_status_t

   !> A scene and its state; any number can live side by side
   type :: simulation_t
      private
      type(run_options_t) :: options
      type(consistent_model_t) :: model         !! legacy reads that of all, model_t
      type(scheme_t) :: scheme                  !! formulation and state
      type(trace_plan_t) :: trace
      type(history_t) :: history
      type(sampler_t) :: sampler
      type(extremes_t) :: extremes              !! of the samples of this run
      real(wp), allocatable :: row(:)           !! the last sample, where the sink has no room
      character(len=:), allocatable :: root     !! name of the deck without _0000.rad
      logical :: loaded = .false.               !! can be run
      logical :: started = .false.              !! is stepped by the host
      logical :: restored = .false.             !! a run goes on from the state it has
      integer :: rows = 0                       !! of its history so far
      logical :: running = .false.              !! run_simulation has it
      real(wp), allocatable :: load_scale(:)    !! of the concentrated loads, as the deck has it
   end type simulation_t

   !> One rigid body now. Under legacy velocities are half a step older than the rest
   type :: body_state_t
      integer :: id = 0                         !! user id
      real(wp) :: mass = 0.0_wp
      real(wp) :: position(3) = 0.0_wp          !! centre of gravity (main node), W
      real(wp) :: attitude(4) = 0.0_wp          !! turn since the start, quaternion w x y z, W
      real(wp) :: velocity(3) = 0.0_wp          !! W
      real(wp) :: omega(3) = 0.0_wp             !! angular velocity, W [rad/time]
      real(wp) :: force(3) = 0.0_wp             !! of joints, loads and gravity, W
      real(wp) :: moment(3) = 0.0_wp            !! about the centre of gravity, W
   end type body_state_t

   !> Someone who watches a run
   type, abstract :: monitor_t
      integer :: stop_code = 130                !! exit code of a run that it stops
   contains
      procedure(tick_i), deferred :: tick
      procedure :: see                          !! a traced cycle; nothing is done with it here
      procedure :: wants_state                  !! for a checkpoint; here never
      procedure :: take_state                   !! that was wanted; nothing is done with it here
   end type monitor_t

   !> One of several runs side by side
   type :: beside_t
      type(simulation_t), pointer :: sim => null()   !! loaded
      class(sink_t), pointer :: sink => null()
      type(run_status_t) :: status
      type(error_t), allocatable :: error       !! as run_simulation has it
   end type beside_t

   abstract interface
      !> Called every few cycles and at the end. The simulation is not to be loaded, run, started,
      !> stepped or changed from here: that is refused with ERR_INPUT.
      subroutine tick_i(self, status, stop)
         import :: monitor_t, run_status_t
         class(monitor_t), intent(inout) :: self
         type(run_status_t), intent(in) :: status
         logical, intent(out) :: stop           !! end the run after the next cycle
      end subroutine tick_i
   end interface

   interface
      !> Read and check a deck.
      !>
      !> The scene can be run when findings%n_error is 0 and no error is allocated.
      !> Errors: ERR_INPUT when the options do not fit; whatever the deck does wrong is a finding.
      module subroutine load_simulation(sim, starter, engine, options, findings, error)
         type(simulation_t), intent(inout) :: sim  !! what it held is given up
         character(len=*), intent(in) :: starter   !! path of ROOT_0000.rad
         character(len=*), intent(in) :: engine    !! path of the engine deck; '' for ROOT_0001.rad
         type(run_options_t), intent(in) :: options
         type(finding_list_t), intent(inout) :: findings
         type(error_t), allocatable, intent(out) :: error
      end subroutine load_simulation

      !> Trace joints, springs, bodies and nodes with these user ids in the cycles first to last of
      !> the next runs: what they see and do goes to `see` of the monitor. No ids: no trace.
      !>
      !> Errors: ERR_INPUT when nothing has an id, the cycles are no range, no deck is loaded, or
      !> islands march by themselves.
      module subroutine trace_simulation(sim, ids, first, last, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: ids(:)
         integer, intent(in) :: first, last
         type(error_t), allocatable, intent(out) :: error
      end subroutine trace_simulation

      !> What a monitor sees of one traced cycle: everything that was asked for
      module subroutine see(self, trace)
         class(monitor_t), intent(inout) :: self
         type(trace_t), intent(in) :: trace(:)
      end subroutine see

      !> Whether a monitor wants the state now. Asked every few cycles, and at the end of a run
      module subroutine wants_state(self, ended, wanted)
         class(monitor_t), intent(inout) :: self
         logical, intent(in) :: ended           !! the run ends here
         logical, intent(out) :: wanted
      end subroutine wants_state

      !> The state from which a run goes on with the same bits, as restore_simulation takes it, and
      !> the status then. Errors: the monitor's own; they end the run.
      module subroutine take_state(self, state, status, error)
         class(monitor_t), intent(inout) :: self
         integer(int8), intent(in) :: state(:)
         type(run_status_t), intent(in) :: status
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_state

      !> Run a loaded scene to its end, from its start or from a restored state; the sink is opened
      !> and closed here. From a restored state the sink is told how many rows of an older history
      !> go before (sink_t).
      !>
      !> Errors: ERR_RUN when the run leaves its valid range or its energy limit (the history holds
      !> what came before), those of the sink.
      module subroutine run_simulation(sim, sink, monitor, status, error)
         type(simulation_t), intent(inout) :: sim
         class(sink_t), intent(inout) :: sink
         class(monitor_t), intent(inout) :: monitor
         type(run_status_t), intent(out) :: status
         type(error_t), allocatable, intent(out) :: error
      end subroutine run_simulation

      !> Run loaded scenes to their ends, each as run_simulation does and with the same bits. Where
      !> small scenes differ in numbers alone, such as variants of a deck, they take their steps
      !> together, which is faster.
      module subroutine run_simulations(run, monitor)
         type(beside_t), intent(inout) :: run(:)
         class(monitor_t), intent(inout) :: monitor   !! of all
      end subroutine run_simulations

      !> What gave way most in the samples of the last run
      module subroutine simulation_worst(sim, extremes, owner)
         type(simulation_t), intent(in) :: sim
         type(extremes_t), intent(out) :: extremes
         integer, intent(out) :: owner          !! joint that holds the step; 0, -1: none, ever
      end subroutine simulation_worst

      !> State at t = 0 with its forces, for a host that steps the scene by itself.
      !>
      !> Errors: ERR_INPUT when no deck is loaded; ERR_RUN as run_simulation.
      module subroutine start_simulation(sim, error)
         type(simulation_t), intent(inout) :: sim
         type(error_t), allocatable, intent(out) :: error
      end subroutine start_simulation

      !> March to a time. Consistent ends there exactly, in equal steps below the limit; legacy with
      !> the first cycle at or beyond it. Nothing is sampled, and the end time of the deck does not
      !> count.
      !>
      !> Errors: ERR_INPUT when the scene is not started or `until` is not finite; ERR_RUN as
      !> run_simulation.
      module subroutine advance_simulation(sim, until, error)
         type(simulation_t), intent(inout) :: sim
         real(wp), intent(in) :: until
         type(error_t), allocatable, intent(out) :: error
      end subroutine advance_simulation

      !> March a step, or so many, each as long as the limit allows. Errors: as advance_simulation
      module subroutine step_simulation(sim, error, steps)
         type(simulation_t), intent(inout) :: sim
         type(error_t), allocatable, intent(out) :: error
         integer, intent(in), optional :: steps
      end subroutine step_simulation

      !> The state of a started scene as bytes. Errors: ERR_INPUT when it is not started
      module subroutine save_simulation(sim, state, error)
         type(simulation_t), intent(inout) :: sim
         integer(int8), allocatable, intent(out) :: state(:)
         type(error_t), allocatable, intent(out) :: error
      end subroutine save_simulation

      !> Go on from a state of the same deck: with advance_simulation and step_simulation, or by
      !> run_simulation. A loaded scene is started by this. Bits are those of a scene that went on
      !> without. Number of threads, end, samples and steps may be others than then.
      !>
      !> Errors: ERR_INPUT when no deck is loaded, or the state is none of this deck, version of
      !> kjoint, formulation, integrator or stiffness; ERR_RUN as start_simulation.
      module subroutine restore_simulation(sim, state, error)
         type(simulation_t), intent(inout) :: sim
         integer(int8), intent(in) :: state(:)
         type(error_t), allocatable, intent(out) :: error
      end subroutine restore_simulation

      !> Where a stepped scene stands. Energies are those of the last sample_simulation.
      module function simulation_status(sim) result(status)
         type(simulation_t), intent(in) :: sim
         type(run_status_t) :: status
      end function simulation_status

      !> What a row of samples holds, to open a sink with
      module function simulation_history(sim) result(history)
         type(simulation_t), intent(in) :: sim
         type(history_t) :: history
      end function simulation_history

      !> All channels now, as simulation_history has them, for a sink or for channel_values.
      !>
      !> Errors: ERR_INPUT when the scene is not started or the row has not history%n_value numbers.
      module subroutine sample_simulation(sim, row, error)
         type(simulation_t), intent(inout) :: sim
         real(wp), intent(out) :: row(:)        !! (history%n_value)
         type(error_t), allocatable, intent(out) :: error
      end subroutine sample_simulation

      !> One channel out of a row, by its name in the history: 'kinetic_energy_rot', 'joint/force'.
      !>
      !> Errors: ERR_INPUT when there is no such channel or the row has another size.
      module subroutine channel_values(history, row, name, values, error)
         type(history_t), intent(in) :: history
         real(wp), intent(in) :: row(:)
         character(len=*), intent(in) :: name
         !> (component, joint or body or node), in the order of the history
         real(wp), allocatable, intent(out) :: values(:, :)
         type(error_t), allocatable, intent(out) :: error
      end subroutine channel_values

      !> User ids of all rigid bodies of a loaded scene
      module function simulation_bodies(sim) result(ids)
         type(simulation_t), intent(in) :: sim
         integer, allocatable :: ids(:)
      end function simulation_bodies

      !> User ids of all joints of a loaded scene
      module function simulation_joints(sim) result(ids)
         type(simulation_t), intent(in) :: sim
         integer, allocatable :: ids(:)
      end function simulation_joints

      !> A rigid body of a started scene. Errors: ERR_INPUT when there is none with this id.
      module subroutine body_state(sim, id, body, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id              !! user id of the /RBODY
         type(body_state_t), intent(out) :: body
         type(error_t), allocatable, intent(out) :: error
      end subroutine body_state

      !> Place of a node of a started scene, W. Under legacy only nodes that joints, loads or the
      !> history read move.
      !>
      !> Errors: ERR_INPUT when there is no node with this id.
      module subroutine node_position(sim, id, x, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id              !! user id
         real(wp), intent(out) :: x(3)
         type(error_t), allocatable, intent(out) :: error
      end subroutine node_position

      !> A joint of a started scene. Errors: ERR_INPUT when there is none with this id.
      module subroutine joint_state(sim, id, result, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id              !! user id of the /SPRING element
         type(joint_result_t), intent(out) :: result
         type(error_t), allocatable, intent(out) :: error
      end subroutine joint_state

      !> Force and moment of the host on a body, beside the loads of the deck, from now on until
      !> they are set anew. Their work counts as external.
      !>
      !> Errors: ERR_INPUT when there is no such body or a value is not finite.
      module subroutine set_body_load(sim, id, force, moment, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id              !! user id of the /RBODY
         real(wp), intent(in) :: force(3)       !! at the centre of gravity, W
         real(wp), intent(in) :: moment(3)      !! about it, W
         type(error_t), allocatable, intent(out) :: error
      end subroutine set_body_load

      !> Factor on the concentrated load /CLOAD/id, from the next step on.
      !>
      !> Errors: ERR_INPUT when there is no such load or the factor is not finite.
      module subroutine set_load_factor(sim, id, factor, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id
         real(wp), intent(in) :: factor
         type(error_t), allocatable, intent(out) :: error
      end subroutine set_load_factor

      !> Give a body other velocities; conditions and imposed motion still hold. The change of
      !> energy counts as external work under consistent.
      !>
      !> Errors: ERR_INPUT when there is no such body or a value is not finite.
      module subroutine set_body_velocity(sim, id, velocity, omega, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id
         real(wp), intent(in) :: velocity(3), omega(3)   !! of the centre of gravity, W
         type(error_t), allocatable, intent(out) :: error
      end subroutine set_body_velocity

      !> Put a body elsewhere; only under consistent, where forces are functions of the poses. The
      !> change of energy counts as external work.
      !>
      !> Errors: ERR_INPUT under legacy, when there is no such body, a value is not finite, or the
      !> quaternion is zero.
      module subroutine set_body_pose(sim, id, position, attitude, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id
         real(wp), intent(in) :: position(3)    !! of the centre of gravity, W
         real(wp), intent(in) :: attitude(4)    !! turn since the start, quaternion w x y z, W
         type(error_t), allocatable, intent(out) :: error
      end subroutine set_body_pose

      !> Lock the free directions of a /PROP/KJOINT2 as they are now, or free them: what its sensor
      !> would do.
      !>
      !> Errors: ERR_INPUT when there is no such joint, or it has neither stops, friction nor a
      !> sensor: then it cannot lock.
      module subroutine lock_joint(sim, id, locked, error)
         type(simulation_t), intent(inout) :: sim
         integer, intent(in) :: id              !! user id of the /SPRING element
         logical, intent(in) :: locked
         type(error_t), allocatable, intent(out) :: error
      end subroutine lock_joint

      !> Joints of a loaded deck as elements of a host, at the start of the deck, with its masses.
      !> The set is new and without joints; node_id maps the nodes of the host to the deck.
      !>
      !> Errors: ERR_INPUT when nothing is loaded, the set holds joints or has another formulation,
      !> or the host lacks a node: carriers are the main nodes of bodies; legacy reads the nodes of
      !> joints and of their skews, too.
      module subroutine take_joints(set, sim, node_id, error, attitude)
         type(joint_set_t), intent(inout) :: set
         type(simulation_t), intent(in) :: sim
         integer, intent(in) :: node_id(:)      !! (n) user id in the deck of each host node
         type(error_t), allocatable, intent(out) :: error
         !> quaternions at the start, (4, n), as start_joints; consistent needs them
         real(wp), intent(in), optional :: attitude(:, :)
      end subroutine take_joints

      !> Take the mechanism out of a full deck: report%text is its starter deck, report%engine its
      !> engine deck, '' when there is none. options%set gives values of parameters.
      !>
      !> Whatever the deck does wrong is a finding.
      module subroutine extract_mechanism(starter, engine, options, report, findings)
         character(len=*), intent(in) :: starter   !! path of ROOT_0000.rad
         character(len=*), intent(in) :: engine    !! path of the engine deck; '' for ROOT_0001.rad
         type(run_options_t), intent(in) :: options
         type(extract_report_t), intent(out) :: report
         type(finding_list_t), intent(inout) :: findings
      end subroutine extract_mechanism

      !> The file of a starter deck holds its engine deck, too: from /RUN on
      module function holds_engine(starter) result(holds)
         character(len=*), intent(in) :: starter
         logical :: holds
      end function holds_engine

      !> Joints, bodies and time-step limits of a loaded scene, as they are at its start, and how
      !> long a run takes.
      !>
      !> Errors: what a run ends with in its first cycles.
      module subroutine check_simulation(sim, report, error)
         type(simulation_t), intent(in) :: sim
         type(check_t), intent(out) :: report
         type(error_t), allocatable, intent(out) :: error
      end subroutine check_simulation

      !> What a loaded scene was told, with what the formulation decides
      module function simulation_options(sim) result(options)
         type(simulation_t), intent(in) :: sim
         type(run_options_t) :: options
      end function simulation_options

      !> What the engine deck says of checkpoints (/RFILE), and the number of the run: above 1 it
      !> goes on from a saved state
      module subroutine simulation_checkpoints(sim, at_end, cycles, run_number)
         type(simulation_t), intent(in) :: sim
         logical, intent(out) :: at_end
         integer, intent(out) :: cycles         !! between two; huge: none
         integer, intent(out) :: run_number
      end subroutine simulation_checkpoints

      !> Title of the deck
      module function simulation_title(sim) result(title)
         type(simulation_t), intent(in) :: sim
         character(len=100) :: title
      end function simulation_title

      !> Largest distance of a node from the main node of its body, over bodies that are not held;
      !> length, in the units of the deck
      module pure function simulation_reach(sim) result(reach)
         type(simulation_t), intent(in) :: sim
         real(wp) :: reach
      end function simulation_reach

      !> ROOT.h5 in the current folder
      module function default_output(sim) result(path)
         type(simulation_t), intent(in) :: sim
         character(len=:), allocatable :: path
      end function default_output
   end interface

end module kjoint
