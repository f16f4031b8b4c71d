!> The public module of kjoint: everything an embedder uses.
module kjoint
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t, ERR_RUN, ERR_INPUT, ERR_FILE, ERR_INTERNAL, &
      SEV_NOTE, &
      SEV_WARNING, SEV_ERROR
   use kj_version, only: KJOINT_VERSION
   use kj_deck, only: deck_t, source_t
   use kj_model, only: model_t
   use kj_state, only: state_t
   use kj_c_state, only: c_model_t, c_state_t
   use kj_c_advance, only: march_t
   use kj_history, only: history_t
   use kj_sample, only: sampler_t
   use kj_sink, only: sink_t
   use kj_check, only: check_t, limit_row_t
   implicit none
   private

   public :: wp, error_t, finding_list_t, sink_t, history_t, KJOINT_VERSION
   public :: ERR_RUN, ERR_INPUT, ERR_FILE, ERR_INTERNAL, SEV_NOTE, SEV_WARNING, SEV_ERROR
   public :: run_options_t, run_status_t, simulation_t, monitor_t
   public :: load_simulation, run_simulation, simulation_title, simulation_reach, &
      default_output
   public :: check_t, limit_row_t, check_simulation

   !> What a run may be told; '' and 0 stand for the defaults
   type :: run_options_t
      character(len=12) :: formulation = ''  !! consistent (default) or legacy
      !> split2 (default of consistent), liemid, rkmk4; legacy
      character(len=12) :: integrator = ''
      character(len=12) :: dt_rule = ''      !! safe (default of consistent) or nodal
      real(wp) :: until = -1.0_wp            !! end of the run, time; negative: /RUN
      real(wp) :: sample = -1.0_wp           !! sample interval, time; negative: /TFILE
      real(wp) :: dt_scale = 0.0_wp          !! factor on the critical step; 0: that of the deck
      real(wp) :: dt_max_scale = 1.0_wp      !! factor on the steps of /DTIX
      real(wp) :: kn_scale = 1.0_wp          !! factor on the stiffness of blocked directions
      !> largest energy error in percent; negative: 15, off under legacy
      real(wp) :: energy_limit = -1.0_wp
      logical :: ignore_unsupported = .false.   !! unsupported keywords become warnings
   end type run_options_t

   !> Where a run stands
   type :: run_status_t
      integer :: cycle = 0
      real(wp) :: time = 0.0_wp, t_stop = 0.0_wp, time_step = 0.0_wp
      character(len=8) :: owner_kind = 'none'   !! what limits the step: none, node, body, joint
      integer :: owner = 0                      !! its user id
      real(wp) :: energy_error = 0.0_wp         !! fraction, of the last sample
      !> energies of the last sample
      real(wp) :: kinetic = 0.0_wp, internal = 0.0_wp, work = 0.0_wp
      integer :: n_joint = 0, n_body = 0, n_node = 0, n_spring = 0
      integer :: n_sample = 0                   !! rows given to the sink
      integer :: print_every = 100              !! /PRINT: cycles between listing lines
      real(wp) :: wall_solve = 0.0_wp, wall_output = 0.0_wp            !! [s] of wall clock
      type(finding_list_t) :: warnings          !! what showed during the run, at its end
   end type run_status_t

   !> A scene and its state; any number can live side by side
   type :: simulation_t
      private
      type(run_options_t) :: options
      type(deck_t) :: deck
      type(source_t) :: engine_source
      type(model_t) :: model
      type(state_t) :: state                    !! legacy: the state; consistent: what samples read
      logical :: legacy = .false.
      type(c_model_t) :: c_model                !! consistent formulation
      type(c_state_t) :: c_state
      type(march_t) :: march
      type(history_t) :: history
      type(sampler_t) :: sampler
      character(len=:), allocatable :: root     !! name of the deck without _0000.rad
   end type simulation_t

   !> Someone who watches a run
   type, abstract :: monitor_t
   contains
      procedure(tick_i), deferred :: tick
   end type monitor_t

   abstract interface
      !> Called every few cycles and at the end
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
         type(simulation_t), intent(out) :: sim
         character(len=*), intent(in) :: starter   !! path of ROOT_0000.rad
         character(len=*), intent(in) :: engine    !! path of the engine deck; '' for ROOT_0001.rad
         type(run_options_t), intent(in) :: options
         type(finding_list_t), intent(inout) :: findings
         type(error_t), allocatable, intent(out) :: error
      end subroutine load_simulation

      !> Run a loaded scene from its start to its end; the sink is opened and closed here.
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

      !> Joints, bodies and time-step limits of a loaded scene, as they are at its start
      module subroutine check_simulation(sim, report)
         type(simulation_t), intent(in) :: sim
         type(check_t), intent(out) :: report
      end subroutine check_simulation

      !> Title of the deck
      module function simulation_title(sim) result(title)
         type(simulation_t), intent(in) :: sim
         character(len=:), allocatable :: title
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
