!> Scenes of one process that march in turns, slice by slice: what they cost beside each other holds
!> where the pace of a machine changes from second to second.
!>
!> usage: bench_pairs FORMULATION SLICES STEP DECK THREADS CYCLES [DECK THREADS CYCLES ...]
!>
!> Each slice is about CYCLES steps of STEP of one scene. Prints a line for each slice: the ns a joint
!> and cycle of each scene in turn, by the wall clock, and those of the first two at the same time, each
!> in a thread of its own.
program bench_pairs
   use, intrinsic :: iso_fortran_env, only: int64
   use kjoint, only: wp, error_t, finding_list_t, simulation_t, run_options_t, load_simulation, &
      start_simulation, advance_simulation, simulation_status, run_status_t
   implicit none

   type :: scene_t
      type(simulation_t) :: sim
      real(wp) :: slice = 0.0_wp                     !! its length [time]
      real(wp) :: ns = 0.0_wp                        !! a joint and cycle of the last slice
   end type scene_t

   type(scene_t), allocatable :: scene(:)
   character(len=12) :: formulation
   character(len=1000) :: text
   integer :: n_slice, slice, i, n
   real(wp) :: step

   call get_command_argument(1, formulation)
   call get_command_argument(2, text)
   read (text, *) n_slice
   call get_command_argument(3, text)
   read (text, *) step
   n = (command_argument_count() - 3)/3
   allocate (scene(n))
   do i = 1, n
      call load(3*i + 1, scene(i))
      call march(scene(i))                           ! the start is not measured
   end do
   do slice = 1, n_slice
      do i = 1, n
         call march(scene(i))
      end do
      write (*, '(*(f0.3, 1x))', advance='no') scene%ns
      !$omp parallel do num_threads(2) schedule(static, 1)
      do i = 1, 2
         call march(scene(i))
      end do
      print '(*(f0.3, 1x))', scene(:2)%ns
   end do

contains

   !> The scene of three arguments from `at` on
   subroutine load(at, scene)
      integer, intent(in) :: at
      type(scene_t), intent(inout) :: scene

      type(run_options_t) :: options
      type(finding_list_t) :: findings
      type(error_t), allocatable :: error
      character(len=1000) :: deck
      integer :: cycles

      call get_command_argument(at, deck)
      call get_command_argument(at + 1, text)
      read (text, *) options%threads
      call get_command_argument(at + 2, text)
      read (text, *) cycles
      options%formulation = formulation
      call load_simulation(scene%sim, trim(deck), '', options, findings, error)
      call stop_on_error(error)
      if (findings%n_error > 0) error stop 'bench_pairs: the deck has errors'
      call start_simulation(scene%sim, error)
      call stop_on_error(error)
      scene%slice = cycles*step
   end subroutine load

   !> A slice of a scene
   subroutine march(scene)
      type(scene_t), intent(inout) :: scene

      type(run_status_t) :: before, after
      type(error_t), allocatable :: error
      integer(int64) :: begin, end, rate

      before = simulation_status(scene%sim)
      call system_clock(begin, rate)
      call advance_simulation(scene%sim, before%time + scene%slice, error)
      call system_clock(end)
      call stop_on_error(error)
      after = simulation_status(scene%sim)
      scene%ns = 1.0e9_wp*real(end - begin, wp)/real(rate, wp)/ &
         (real(after%n_joint, wp)*(after%cycle - before%cycle))
   end subroutine march

   subroutine stop_on_error(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      print '(2a)', 'bench_pairs: ', error%message
      error stop 2
   end subroutine stop_on_error

end program bench_pairs
