!> Rows of a run at given times, and how far they are from those of another run, class by class.
module kj_study_metric
   use kj_kinds, only: wp
   use kj_error, only: error_t
   use kj_channels, only: channels, AT_T, AT_HALF, CH_ENERGY_ERROR, CH_J_FORCE, CH_J_MOMENT, &
      CH_J_VIOL_T, CH_J_VIOL_R, CH_B_POS, CH_B_VEL, CH_B_ANGVEL, CH_B_ORIENT, CH_N_POS, CH_N_VEL
   use kj_history, only: history_t, variable_t
   use kj_sink, only: sink_memory_t
   implicit none
   private

   public :: study_sink_t, class_errors

   !> What is compared; joint axes are not the same under all formulations, so joints are compared
   !> by the size of their force and moment, bodies and nodes by their vectors
   integer, parameter, public :: N_CLASS = 6
   character(len=16), parameter, public :: CLASSES(N_CLASS) = [character(len=16) :: &
      'displacement', 'rotation', 'velocity', 'angular_velocity', 'force', 'moment']
   integer, parameter :: COMPARED(2, 8) = reshape([CH_B_POS, 1, CH_N_POS, 1, CH_B_ORIENT, 2, &
      CH_B_VEL, 3, CH_N_VEL, 3, CH_B_ANGVEL, 4, CH_J_FORCE, 5, CH_J_MOMENT, 6], [2, 8])

   real(wp), parameter :: NOTHING = 1.0e-6_wp   !! of a force or moment beside the other

   !> A sink that keeps rows at wanted times, by straight lines between those it gets; without
   !> wanted times all it gets.
   !>
   !> Under the legacy formulation samples are cycles, and velocities stand half a step before them.
   type, extends(sink_memory_t) :: study_sink_t
      real(wp), allocatable :: wanted(:)        !! times
      integer :: n_half = 0                     !! rows complete in channels at t - dt/2
      real(wp), allocatable :: last(:)          !! the row before
      real(wp) :: t_last = 0.0_wp, half_last = 0.0_wp   !! its time, and that of its velocities
      integer :: n_put = 0
      real(wp) :: energy = 0.0_wp               !! largest |energy error| of all rows
      !> largest violation of all rows, length and angle
      real(wp) :: gap = 0.0_wp, gap_rot = 0.0_wp
      integer :: gap_joint = 0                  !! that opened most, its place; 0: none
   contains
      procedure :: open => open_study
      procedure :: put => put_study
   end type study_sink_t

contains

   !> Begin anew
   subroutine open_study(self, history, error)
      class(study_sink_t), intent(inout) :: self
      type(history_t), intent(in) :: history
      type(error_t), allocatable, intent(out) :: error

      call self%sink_memory_t%open(history, error)
      if (allocated(self%wanted)) then
         deallocate (self%rows)
         allocate (self%rows(history%n_value, size(self%wanted)), source=0.0_wp)
      end if
      if (allocated(self%last)) deallocate (self%last)
      allocate (self%last(history%n_value), source=0.0_wp)
      self%n_half = 0
      self%n_put = 0
      self%energy = 0.0_wp
      self%gap = 0.0_wp
      self%gap_joint = 0
      self%gap_rot = 0.0_wp
   end subroutine open_study

   !> Take one row
   subroutine put_study(self, row, error)
      class(study_sink_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_t), allocatable, intent(out) :: error

      real(wp) :: half

      half = row(1)
      if (self%history%legacy .and. self%n_put > 0) half = 0.5_wp*(row(1) + self%t_last)
      if (allocated(self%wanted)) then
         call fill(self, row, row(1), self%t_last, .false., self%n_row)
         call fill(self, row, half, self%half_last, .true., self%n_half)
      else
         call self%sink_memory_t%put(row, error)
         if (allocated(error)) return
         self%n_half = self%n_row
      end if
      call note_worst(self, row)
      self%last = row
      self%t_last = row(1)
      self%half_last = half
      self%n_put = self%n_put + 1
   end subroutine put_study

   !> Fill the rows whose time lies between the last row and this one, in the channels of one level
   pure subroutine fill(self, row, t, t_last, half, n)
      class(study_sink_t), intent(inout) :: self
      real(wp), intent(in) :: row(:), t, t_last
      logical, intent(in) :: half                !! channels at t - dt/2, else those at t
      integer, intent(inout) :: n                !! rows filled

      real(wp) :: a
      integer :: i

      do while (n < size(self%wanted))
         if (self%wanted(n + 1) > t + 1.0e-9_wp*abs(t)) return
         n = n + 1
         a = 1.0_wp
         if (t > t_last .and. self%n_put > 0) a = min(1.0_wp, &
            (self%wanted(n) - t_last)/(t - t_last))
         do i = 1, size(self%history%variable)
            associate (v => self%history%variable(i))
               if (channels(v%channel)%at /= merge(AT_HALF, AT_T, half)) cycle
               associate (from => v%first, to => v%first + v%n_entity*v%n_comp - 1)
                  self%rows(from:to, n) = self%last(from:to) + a*(row(from:to) - self%last(from:to))
               end associate
            end associate
         end do
      end do
   end subroutine fill

   !> Largest energy error and violations
   pure subroutine note_worst(self, row)
      class(study_sink_t), intent(inout) :: self
      real(wp), intent(in) :: row(:)

      integer :: i

      do i = 1, size(self%history%variable)
         associate (v => self%history%variable(i))
            associate (now => row(v%first:v%first + v%n_entity*v%n_comp - 1))
               if (v%channel == CH_ENERGY_ERROR) call raise(self%energy, now)
               if (v%channel == CH_J_VIOL_T) then
                  if (maxval(now) > self%gap) self%gap_joint = maxloc(now, dim=1)
                  call raise(self%gap, now)
               end if
               if (v%channel == CH_J_VIOL_R) call raise(self%gap_rot, now)
            end associate
         end associate
      end do
   end subroutine note_worst

   pure subroutine raise(worst, values)
      real(wp), intent(inout) :: worst
      real(wp), intent(in) :: values(:)

      integer :: k

      do k = 1, size(values)
         worst = larger(worst, abs(values(k)))
      end do
   end subroutine raise

   !> Error of a run against a reference that kept every row, class by class: the largest root mean
   !> square over time of one entity's difference, over the peak of the class in the reference.
   !>
   !> Positions and rotations count from the start, so that it does not matter where a scene lies.
   !> Bodies that only turn also move the nodes at their rim, and bodies that only slide could turn
   !> as far: so what the compliance of joints does is measured by the motion, not by itself. A
   !> class in which nothing happens has the error 0; so have moments that are nothing beside what
   !> the forces do over the way of the scene, and forces beside moments.
   pure function class_errors(ref, run, reach) result(error)
      class(study_sink_t), intent(in) :: ref, run
      real(wp), intent(in) :: reach              !! of the nodes of moving bodies from their centres
      real(wp) :: error(N_CLASS)

      real(wp) :: peak(N_CLASS)
      integer :: i, k, row, class

      error = 0.0_wp
      peak = 0.0_wp
      do i = 1, size(ref%history%variable)
         associate (v => ref%history%variable(i))
            row = findloc(COMPARED(1, :), v%channel, dim=1)
            if (row == 0) cycle
            class = COMPARED(2, row)
            do k = 1, v%n_entity
               error(class) = larger(error(class), distance(ref, run, v, k))
               peak(class) = max(peak(class), peak_of(ref, v, k, class <= 2))
            end do
         end associate
      end do
      if (reach > 0.0_wp) then
         ! a node at the rim goes along a chord
         peak(1) = max(peak(1), 2.0_wp*reach*sin(0.5_wp*peak(2)))
         peak(2) = max(peak(2), peak(1)/reach)
         peak(3) = max(peak(3), reach*peak(4))
         peak(4) = max(peak(4), peak(3)/reach)
      end if
      peak(5:6) = merge(peak(5:6), 0.0_wp, peak(5:6) > NOTHING*[peak(6)/max(peak(1), &
         tiny(1.0_wp)), &
         peak(5)*peak(1)])
      where (peak > 0.0_wp)
         error = error/peak
      else where (error <= huge(1.0_wp))
         error = 0.0_wp
      end where
   end function class_errors

   !> The larger of two numbers; what is not a number is larger than all
   pure real(wp) function larger(a, b)
      real(wp), intent(in) :: a, b

      larger = b
      if (a >= b .or. .not. a <= huge(1.0_wp)) larger = a
   end function larger

   !> Root mean square over time of the difference of one entity
   pure real(wp) function distance(ref, run, v, k) result(d)
      class(study_sink_t), intent(in) :: ref, run
      type(variable_t), intent(in) :: v
      integer, intent(in) :: k                   !! entity

      integer :: i, n, first, last

      first = v%first + (k - 1)*v%n_comp
      last = first + v%n_comp - 1
      n = min(ref%n_row, run%n_row)
      if (channels(v%channel)%at == AT_HALF) n = min(ref%n_row, run%n_half)
      d = 0.0_wp
      do i = 1, n
         d = d + apart(v, ref%rows(first:last, i), run%rows(first:last, i))**2
      end do
      d = sqrt(d/max(1, n))
   end function distance

   !> Distance of two values of a channel: quaternions by angle, joint forces by size
   pure real(wp) function apart(v, a, b) result(d)
      type(variable_t), intent(in) :: v
      real(wp), intent(in) :: a(:), b(:)

      if (v%n_comp == 4) then
         d = min(norm2(a - b), norm2(a + b))
         d = 4.0_wp*asin(min(1.0_wp, 0.5_wp*d))
      else if (v%channel == CH_J_FORCE .or. v%channel == CH_J_MOMENT) then
         d = abs(norm2(a) - norm2(b))
      else
         d = norm2(a - b)
      end if
   end function apart

   !> Peak of one entity in the reference
   pure real(wp) function peak_of(ref, v, k, from_start) result(peak)
      class(study_sink_t), intent(in) :: ref
      type(variable_t), intent(in) :: v
      integer, intent(in) :: k
      logical, intent(in) :: from_start          !! the change since the first row

      real(wp) :: zero(v%n_comp)
      integer :: i, first, last

      first = v%first + (k - 1)*v%n_comp
      last = first + v%n_comp - 1
      zero = 0.0_wp
      if (from_start) zero = ref%rows(first:last, 1)
      peak = 0.0_wp
      do i = 1, ref%n_row
         peak = max(peak, apart(v, ref%rows(first:last, i), zero))
      end do
   end function peak_of

end module kj_study_metric
