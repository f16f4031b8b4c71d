!> Runs of the accuracy tests: a deck in, its rows in memory out, and how to read them.
module accuracy_run
   use kjoint, only: wp, error_t, finding_list_t, simulation_t, run_options_t, run_status_t, &
      monitor_t, load_simulation, run_simulation
   use kj_channels, only: find_channel, channels
   use kj_sink, only: sink_memory_t
   use accuracy_check, only: say
   implicit none
   private

   public :: run_t, run_deck, series, times, distance, slope_of

   !> A finished run
   type :: run_t
      type(sink_memory_t) :: sink
      type(run_status_t) :: status
      logical :: good = .false.                  !! loaded and ran to its end
      character(len=7) :: id = ''                !! of the first finding that is an error
      character(len=:), allocatable :: message   !! what went wrong
   end type run_t

   !> Nobody watches
   type, extends(monitor_t) :: nobody_t
   contains
      procedure :: tick => no_tick
   end type nobody_t

contains

   subroutine no_tick(self, status, stop)
      class(nobody_t), intent(inout) :: self
      type(run_status_t), intent(in) :: status
      logical, intent(out) :: stop

      stop = status%cycle < 0 .and. same_type_as(self, self)
   end subroutine no_tick

   !> Run ROOT_0000.rad
   subroutine run_deck(root, options, run)
      character(len=*), intent(in) :: root
      type(run_options_t), intent(in) :: options
      type(run_t), intent(out) :: run

      type(simulation_t) :: sim
      type(finding_list_t) :: findings
      type(nobody_t) :: nobody
      type(error_t), allocatable :: error
      integer :: i

      call load_simulation(sim, root//'_0000.rad', '', options, findings, error)
      do i = findings%n, 1, -1
         if (findings%item(i)%severity < 3) cycle
         run%id = findings%item(i)%id
         run%message = findings%item(i)%message
      end do
      if (.not. allocated(error) .and. findings%n_error == 0) then
         call run_simulation(sim, run%sink, nobody, run%status, error)
         run%good = .not. allocated(error)
      end if
      if (allocated(error)) run%message = error%message
   end subroutine run_deck

   !> Values of a channel of the k-th owner over time: (n_comp, n_row)
   function series(run, owner, name, k) result(values)
      type(run_t), intent(in) :: run
      integer, intent(in) :: owner               !! OF_ constant of kj_channels
      character(len=*), intent(in) :: name
      integer, intent(in) :: k
      real(wp), allocatable :: values(:, :)

      integer :: row, i, first

      row = find_channel(owner, name)
      do i = 1, size(run%sink%history%variable)
         associate (v => run%sink%history%variable(i))
            if (v%channel /= row .or. k > v%n_entity) cycle
            first = v%first + (k - 1)*v%n_comp
            values = run%sink%rows(first:first + v%n_comp - 1, :run%sink%n_row)
            return
         end associate
      end do
      call say('there is no channel '//name)
      allocate (values(1, run%sink%n_row), source=huge(1.0_wp))
   end function series

   function times(run) result(t)
      type(run_t), intent(in) :: run
      real(wp), allocatable :: t(:)

      t = run%sink%rows(1, :run%sink%n_row)
   end function times

   !> Largest difference of a channel over all owners and all samples of two runs; quaternions as
   !> angle. huge where the runs do not have the same samples.
   real(wp) function distance(a, b, owner, name) result(most)
      type(run_t), intent(in) :: a, b
      integer, intent(in) :: owner
      character(len=*), intent(in) :: name

      real(wp), allocatable :: x(:, :), y(:, :)
      integer :: i, k, j

      most = huge(1.0_wp)
      if (.not. (a%good .and. b%good)) return
      if (a%sink%n_row /= b%sink%n_row) return
      most = 0.0_wp
      do i = 1, size(a%sink%history%variable)
         if (channels(a%sink%history%variable(i)%channel)%owner /= owner .or. &
            channels(a%sink%history%variable(i)%channel)%name /= name) cycle
         do k = 1, a%sink%history%variable(i)%n_entity
            x = series(a, owner, name, k)
            y = series(b, owner, name, k)
            do j = 1, size(x, 2)
               if (size(x, 1) == 4) then
                  most = max(most, 2.0_wp*min(norm2(x(:, j) - y(:, j)), norm2(x(:, j) + y(:, j))))
               else
                  most = max(most, norm2(x(:, j) - y(:, j)))
               end if
            end do
         end do
      end do
   end function distance

   !> Slope of a straight line through log y over log x
   pure real(wp) function slope_of(x, y) result(slope)
      real(wp), intent(in) :: x(:), y(:)

      real(wp) :: a(size(x)), b(size(x))

      a = log(x) - sum(log(x))/size(x)
      b = log(y) - sum(log(y))/size(y)
      slope = sum(a*b)/sum(a*a)
   end function slope_of

end module accuracy_run
