!> The smallest host: runs a deck into memory. It uses nothing but kjoint.
module quiet_monitor
   use kjoint, only: monitor_t, run_status_t, simulation_t, run_options_t, finding_list_t, error_t, &
      wp, ERR_INPUT, load_simulation, run_simulation, start_simulation, step_simulation, &
      set_body_load
   use kj_sink, only: sink_memory_t
   implicit none
   private

   public :: quiet_t, meddler_t

   !> Never stops a run
   type, extends(monitor_t) :: quiet_t
      integer :: n_tick = 0
   contains
      procedure :: tick
   end type quiet_t

   !> Loads, runs, starts, steps and changes the simulation that it watches
   type, extends(monitor_t) :: meddler_t
      type(simulation_t), pointer :: sim => null()
      integer :: n_refused = 0, n_tick = 0
   contains
      procedure :: tick => meddle
   end type meddler_t

contains

   subroutine meddle(self, status, stop)
      class(meddler_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      type(run_options_t) :: options
      type(run_status_t) :: other
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error
      type(sink_memory_t) :: sink
      type(quiet_t) :: monitor
      integer :: what

      stop = status%cycle < 0
      self%n_tick = self%n_tick + 1
      do what = 1, 5
         select case (what)
         case (1); call load_simulation(self%sim, 'none_0000.rad', '', options, findings, error)
         case (2); call run_simulation(self%sim, sink, monitor, other, error)
         case (3); call start_simulation(self%sim, error)
         case (4); call step_simulation(self%sim, error)
         case (5); call set_body_load(self%sim, 2, [0.0_wp, 0.0_wp, 0.0_wp], &
            [0.0_wp, 0.0_wp, 0.0_wp], error)
         end select
         if (.not. allocated(error)) cycle
         if (error%code == ERR_INPUT .and. index(error%message, 'runs') > 0) &
            self%n_refused = self%n_refused + 1
      end do
   end subroutine meddle

   subroutine tick(self, status, stop)
      class(quiet_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      stop = .false.
      if (status%cycle >= 0) self%n_tick = self%n_tick + 1
   end subroutine tick

end module quiet_monitor

!> usage: embed DECK_0000.rad
program embed
   use kjoint, only: simulation_t, run_options_t, run_status_t, finding_list_t, error_t, wp, &
      load_simulation, run_simulation, simulation_title
   use kj_sink, only: sink_memory_t
   use quiet_monitor, only: quiet_t, meddler_t
   implicit none

   type(simulation_t), target :: sim
   type(run_options_t) :: options
   type(run_status_t) :: status, meddled
   type(finding_list_t) :: findings
   type(error_t), allocatable :: error
   type(sink_memory_t) :: sink
   type(quiet_t) :: monitor
   type(meddler_t) :: meddler
   character(len=1000) :: deck

   call get_command_argument(1, deck)
   options%until = 0.01_wp
   call load_simulation(sim, trim(deck), '', options, findings, error)
   if (allocated(error)) error stop 1
   if (findings%n_error > 0) error stop 2
   call run_simulation(sim, sink, monitor, status, error)
   if (allocated(error)) error stop 3
   if (status%cycle < 10 .or. monitor%n_tick < 1) error stop 4
   meddler%sim => sim
   call run_simulation(sim, sink, meddler, meddled, error)
   if (allocated(error)) error stop 5
   if (meddler%n_tick < 1 .or. meddler%n_refused /= 5*meddler%n_tick) error stop 6
   if (meddled%cycle /= status%cycle) error stop 7
   print '(2a,i0,a)', trim(simulation_title(sim)), ': ', status%cycle, ' cycles'
end program embed
