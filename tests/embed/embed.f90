!> The smallest host: runs a deck into memory. It uses nothing but kjoint.
module quiet_monitor
   use kjoint, only: monitor_t, run_status_t
   implicit none
   private

   public :: quiet_t

   !> Never stops a run
   type, extends(monitor_t) :: quiet_t
      integer :: n_tick = 0
   contains
      procedure :: tick
   end type quiet_t

contains

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
   use kj_sink_memory, only: sink_memory_t
   use quiet_monitor, only: quiet_t
   implicit none

   type(simulation_t) :: sim
   type(run_options_t) :: options
   type(run_status_t) :: status
   type(finding_list_t) :: findings
   type(error_t), allocatable :: error
   type(sink_memory_t) :: sink
   type(quiet_t) :: monitor
   character(len=1000) :: deck

   call get_command_argument(1, deck)
   options%until = 0.01_wp
   call load_simulation(sim, trim(deck), '', options, findings, error)
   if (allocated(error)) error stop 1
   if (findings%n_error > 0) error stop 2
   call run_simulation(sim, sink, monitor, status, error)
   if (allocated(error)) error stop 3
   if (status%cycle < 10 .or. monitor%n_tick < 1) error stop 4
   print '(2a,i0,a)', trim(simulation_title(sim)), ': ', status%cycle, ' cycles'
end program embed
