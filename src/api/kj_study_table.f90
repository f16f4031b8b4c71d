!> The settings of a study with what came of them: orders, the cheapest for a wanted error, and the
!> stiffness that should do.
!> One file: a row of the table and what it is measured by
module kj_study_table
   use kj_text, only: text_t
   use kj_kinds, only: wp
   use kjoint, only: run_options_t
   use kj_error, only: error_t
   use kj_channels, only: channels, AT_T, AT_HALF, CH_ENERGY_ERROR, CH_J_FORCE, CH_J_MOMENT, &
      CH_J_VIOL_T, CH_J_VIOL_R, CH_B_POS, CH_B_VEL, CH_B_ANGVEL, CH_B_ORIENT, CH_N_POS, CH_N_VEL
   use kj_history, only: history_t, variable_t
   use kj_sink, only: sink_memory_t
   implicit none
   private

   public :: study_t, trial_t, find_orders, order_of, best_trial, foretell, study_sink_t, &
      class_errors

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

   !> One run and what came of it
   type :: trial_t
      type(run_options_t) :: options             !! formulation, integrator, dt_scale, kn_scale
      logical :: good = .false.
      character(len=:), allocatable :: message   !! why it is not good
      integer :: cycles = 0
      real(wp) :: step = 0.0_wp                  !! mean time step
      logical :: by_deck = .false.               !! /DTIX limits it, not the joints
      real(wp) :: time = 0.0_wp                  !! [s] of a processor that the run took
      real(wp) :: per_cycle = 0.0_wp             !! [s] a joint (else a body) and cycle
      !> by CLASSES: displacement and rotation against ideal joints, the others
      !> against the finest steps at this Kn
      real(wp) :: error(N_CLASS) = 0.0_wp
      real(wp) :: score = 0.0_wp                 !! larger error in displacement and rotation
      real(wp) :: by_step = 0.0_wp               !! the same against the finest steps at this Kn
      real(wp) :: by_joints = 0.0_wp             !! of the finest steps at this Kn
      real(wp) :: energy = 0.0_wp                !! largest |energy error|, a fraction
      real(wp) :: gap = 0.0_wp, gap_rot = 0.0_wp !! largest violation
      character(len=:), allocatable :: gap_title !! "pin C (903)", where that was
      real(wp) :: order = 0.0_wp                 !! from the step before it in its family, 0 = none
   end type trial_t

   !> A study
   type :: study_t
      character(len=:), allocatable :: title
      type(text_t), allocatable :: input(:)      !! paths of the decks
      type(trial_t) :: reference
      type(trial_t), allocatable :: trial(:)     !! families together, long steps first
      integer :: n_joint = 0, n_body = 0
      real(wp) :: reach = 0.0_wp                 !! of moving bodies, length
      real(wp) :: floor = 0.0_wp                 !! scores below it may be errors of the reference
      logical :: extrapolated = .false.          !! ideal joints are known, from runs at stiffer Kn
      real(wp) :: compliance = 0.0_wp            !! error of the joints at Kn
      real(wp) :: doubt = 0.0_wp                 !! between Kn, 4 Kn and 4 Kn, 16 Kn: error of truth
   end type study_t

   real(wp), parameter, public :: FINER = 0.25_wp        !! step of the reference over the shortest
   real(wp), parameter :: SURE = 4.0_wp          !! floor of orders, over the error of the reference
   real(wp), parameter :: NOISE = 1.25_wp        !! of times
   real(wp), parameter :: SAFELY = 0.8_wp        !! of the wanted error, where a setting is foretold

contains

   !> Observed orders: of each trial against the longer step before it, unless it is as near to the
   !> reference as that is to the truth.
   !>
   !> The reference has the scheme of the first family and a step FINER times as long as its
   !> shortest. With second order the last of the family is 1/FINER^2 - 1 errors of the reference
   !> away from it; and if the last two do not fit second order, the reference is to blame: it has
   !> its rounding, too.
   pure subroutine find_orders(study)
      type(study_t), intent(inout) :: study

      real(wp) :: last, before, ratio
      integer :: i

      study%floor = 0.0_wp
      before = 0.0_wp
      last = 0.0_wp
      ratio = 0.0_wp
      do i = 1, size(study%trial)
         if (.not. (same_family(study%trial(1), study%trial(i)) .and. study%trial(i)%good)) cycle
         if (i > 1) ratio = (study%trial(i - 1)%step/study%trial(i)%step)**2
         before = last
         last = study%trial(i)%by_step
      end do
      study%floor = last/(FINER**(-2) - 1.0_wp)
      if (before > 0.0_wp .and. ratio > 1.1_wp) study%floor = max(study%floor, &
         abs(ratio*last - before)/(ratio - 1.0_wp))
      study%floor = SURE*study%floor
      do i = 2, size(study%trial)
         associate (a => study%trial(i - 1), b => study%trial(i))
            if (.not. (same_family(a, b) .and. a%good .and. b%good)) cycle
            if (.not. (b%step < 0.99_wp*a%step .and. min(a%by_step, b%by_step) > &
               study%floor)) cycle
            b%order = log(a%by_step/b%by_step)/log(a%step/b%step)
         end associate
      end do
   end subroutine find_orders

   pure logical function same_family(a, b) result(same)
      type(trial_t), intent(in) :: a, b

      same = a%options%integrator == b%options%integrator .and. &
         abs(a%options%kn_scale - b%options%kn_scale) <= 0.0_wp
   end function same_family

   !> Order of an integrator: slope of the error over the step in a fit over its trials at Kn x 1;
   !> 0 when fewer than three are good and above the floor
   pure real(wp) function order_of(study, integrator) result(order)
      type(study_t), intent(in) :: study
      character(len=*), intent(in) :: integrator

      real(wp), allocatable :: x(:), y(:)
      logical :: mine(size(study%trial))
      integer :: i

      order = 0.0_wp
      do i = 1, size(study%trial)
         associate (t => study%trial(i))
            mine(i) = t%options%integrator == integrator .and. t%good .and. &
               t%by_step > study%floor .and. abs(t%options%kn_scale - 1.0_wp) <= 0.0_wp
         end associate
      end do
      if (count(mine) < 3) return
      x = log(pack(study%trial%step, mine))
      y = log(pack(study%trial%by_step, mine))
      x = x - sum(x)/size(x)
      y = y - sum(y)/size(y)
      if (sum(x*x) > 0.0_wp) order = sum(x*y)/sum(x*x)
   end function order_of

   !> The cheapest trial whose error in positions, rotations and energy is at most `wanted`; of
   !> those that cost the same but for the noise of clocks the first. 0 when there is none.
   pure integer function best_trial(study, wanted) result(best)
      type(study_t), intent(in) :: study
      real(wp), intent(in) :: wanted

      logical :: fit(size(study%trial))

      fit = study%trial%good .and. study%trial%score <= wanted .and. study%trial%energy <= wanted
      best = 0
      if (.not. any(fit)) return
      fit = fit .and. study%trial%time <= NOISE*minval(study%trial%time, mask=fit)
      best = findloc(fit, .true., dim=1)
   end function best_trial

   !> One more trial: the stiffness that brings one of the trials to the wanted error at the least
   !> cost. Errors of joints go with 1/Kn, and so do those of steps, which go with the square of the
   !> step; the cost goes with its inverse, the square root of Kn. None when nothing promises to be
   !> cheaper than what there is.
   subroutine foretell(wanted, study, found)
      real(wp), intent(in) :: wanted
      type(study_t), intent(inout) :: study
      logical, intent(out) :: found

      type(trial_t), allocatable :: longer(:)
      real(wp) :: least, cost, scale, best_scale
      integer :: i, best

      found = .false.
      if (.not. study%extrapolated) return
      best = best_trial(study, wanted)
      least = huge(1.0_wp)
      if (best > 0) least = study%trial(best)%time/NOISE
      best = 0
      best_scale = 1.0_wp
      do i = 1, size(study%trial)
         associate (t => study%trial(i))
            if (.not. t%good .or. t%options%kn == 'inf') cycle
            scale = max(t%score, t%energy)/(SAFELY*wanted)
            if (.not. (scale > 1.0e-4_wp .and. scale < 1.0e6_wp)) cycle
            cost = t%time*sqrt(scale)
            if (.not. cost < least) cycle
            ! a softer one would have to hold what it promises; one that was tried has said it
            scale = t%options%kn_scale*rounded_up(scale)
            if (tried(study, t%options, scale)) cycle
            best = i
            best_scale = scale
            least = cost
         end associate
      end do
      found = best > 0
      if (.not. found) return
      allocate (longer(size(study%trial) + 1))
      longer(:size(study%trial)) = study%trial
      longer(size(longer))%options = study%trial(best)%options
      longer(size(longer))%options%kn_scale = best_scale
      call move_alloc(longer, study%trial)
   end subroutine foretell

   !> A setting like this, but for a Kn that differs by less than a fifth
   pure logical function tried(study, options, kn_scale)
      type(study_t), intent(in) :: study
      type(run_options_t), intent(in) :: options
      real(wp), intent(in) :: kn_scale

      integer :: i

      tried = .true.
      do i = 1, size(study%trial)
         associate (o => study%trial(i)%options)
            if (o%integrator /= options%integrator .or. o%kn /= options%kn) cycle
            if (abs(o%dt_scale - options%dt_scale) > 0.0_wp) cycle
            if (abs(log(o%kn_scale/kn_scale)) < 0.2_wp) return
         end associate
      end do
      tried = .false.
   end function tried

   !> The next number of two digits
   pure real(wp) function rounded_up(x) result(y)
      real(wp), intent(in) :: x

      real(wp) :: unit

      unit = 10.0_wp**(floor(log10(x)) - 1)
      y = ceiling(x/unit - 1.0e-6_wp)*unit
   end function rounded_up

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

end module kj_study_table
