!> Laws of springs (/PROP/TYPE4, TYPE8, TYPE13): what a direction is made of, and its force. The
!> legacy formulation calls them as they are; the consistent one where a spring has more than an
!> elastic law.
!> Source: docs/theory/legacy.md 5.2.
!> One file: the rules share their constants, memory and functions.
module kj_spring_law
   use kj_kinds, only: wp
   use kj_sensor, only: is_on
   use kj_curve, only: curve_set_t, law_value, steepest_rise
   use kj_joint_types, only: NDOF
   use kj_block, only: BLOCK
   implicit none
   private

   public :: direction_t, spring_t, spring_block_t, base_force, rate_factor, damping_force, &
      rate_force, failure, switch_spring, stiffness_bound, damping_bound

   !> Hardening rules, H on the card
   integer, parameter, public :: ELASTIC = 0, ISOTROPIC = 1, UNCOUPLED = 2, KINEMATIC = 4, &
      NONLINEAR = 5, ISOTROPIC_CURVES = 6, HYSTERETIC = 7, TOTAL_LENGTH = 8

   !> What a spring is, spring_block_t%alive
   real(wp), parameter, public :: WAITING = -10.0_wp, DEAD = 0.0_wp, ALIVE = 1.0_wp

   !> What failure looks at, Ifail2
   integer, parameter, public :: BY_WAY = 0, BY_FORCE = 1, BY_ENERGY = 2

   real(wp), parameter, public :: NO_FAILURE = 1.0e29_wp   !! a limit beyond it is none

   !> Law of a direction, in work units; functions by their index, 0 = none
   type :: direction_t
      integer :: rule = ELASTIC
      integer :: load = 0, rate = 0, unload = 0, damper = 0   !! fct1, fct2, fct3, fct4
      real(wp) :: k = 0.0_wp                     !! K of the card, over A
      real(wp) :: k_unload = 0.0_wp              !! the same, or the steepest rise of the function
      real(wp) :: a = 1.0_wp, b = 0.0_wp, e = 0.0_wp   !! scales of the rate factor
      real(wp) :: d = 1.0_wp, f = 1.0_wp         !! reference rate; 1/scale of rates
      real(wp) :: x_scale = 1.0_wp               !! Ascale
      real(wp) :: c = 0.0_wp, h = 0.0_wp         !! C, Hscale
      real(wp) :: lo = -1.0e30_wp, hi = 1.0e30_wp   !! limits of failure
      !> failure of TYPE13 with the rate: the limit grows by speed |v/v0|^power
      real(wp) :: speed = 0.0_wp, power = 1.0_wp, weight = 1.0_wp, exponent = 2.0_wp
      !> largest stiffness, A times k_unload, and damping, for the legacy time step
      real(wp) :: k_step = 0.0_wp, c_step = 0.0_wp
   end type direction_t

   !> Constants of a spring
   type :: spring_t
      type(direction_t) :: dof(NDOF)
      real(wp) :: mass = 0.0_wp, inertia = 0.0_wp   !! of the property
      !> laws are per unit of length: TYPE4 and TYPE13 with Ileng
      logical :: per_length = .false.
      logical :: balanced = .false.              !! Iequil: summed up, with the couple of the force
      logical :: summed = .false.                !! Ifail: all directions together
      integer :: criterion = BY_WAY              !! Ifail2
      real(wp) :: cutoff = 0.0_wp                !! frequency that smooths the criterion, 0 = none
      real(wp) :: v0 = 1.0_wp, w0 = 1.0_wp       !! reference rates of failure, TYPE13
      integer :: flag = 0                        !! Isflag
      real(wp) :: t_on = huge(1.0_wp), t_off = huge(1.0_wp)   !! of its sensor
      logical :: sensed = .false.
      !> own mass and inertia of ends that are secondary nodes
      real(wp) :: node_mass(2) = 0.0_wp, node_inertia(2) = 0.0_wp
      !> it has more than elastic laws and dampers: history, rates, failure or a sensor
      logical :: hardened = .false.
   end type spring_t

   !> State of a block of springs
   type :: spring_block_t
      sequence
      real(wp) :: base(BLOCK, 6) = 0.0_wp        !! base force, before factor and damper
      real(wp) :: hi(BLOCK, 6) = 0.0_wp, lo(BLOCK, 6) = 0.0_wp   !! memory of the rules
      real(wp) :: energy(BLOCK, 6) = 0.0_wp      !! work of each direction
      real(wp) :: zero(BLOCK, 6) = 0.0_wp        !! displacement where q is 0
      real(wp) :: alive(BLOCK) = ALIVE
      real(wp) :: damage(BLOCK) = 0.0_wp         !! criterion of failure, smoothed
      real(wp) :: step(BLOCK) = 0.0_wp           !! step of the element alone
   end type spring_block_t

contains

   pure real(wp) function value_of(curves, c, x) result(y)
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: c
      real(wp), intent(in) :: x

      real(wp) :: slope

      call law_value(curves, c, x, y, slope)
   end function value_of

   !> Base force at q, reached by dq; base is that of the step before and becomes that of now
   pure subroutine base_force(law, curves, q, dq, length, base, hi, lo)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: q, dq
      real(wp), intent(in) :: length             !! of the spring
      real(wp), intent(inout) :: base
      real(wp), intent(inout) :: hi, lo          !! memory: largest, least q; yield limits

      real(wp) :: trial, y

      if (law%load == 0) then
         base = law%k*q
         return
      end if
      trial = base + law%k_unload*dq
      y = value_of(curves, law%load, q/law%x_scale)
      select case (law%rule)
      case (ISOTROPIC)
         call yield_alike(law, curves, trial, base, hi)
      case (UNCOUPLED)
         call yield_apart(law%k_unload, q, y, base, hi, lo)
      case (KINEMATIC)
         base = max(min(trial, y), value_of(curves, law%unload, q/law%x_scale))
      case (NONLINEAR)
         call follow_power(law, curves, q, trial, y, base, hi, lo)
      case (ISOTROPIC_CURVES)
         call yield_by_curves(law, curves, dq, base, hi, lo)
      case (HYSTERETIC)
         associate (g => value_of(curves, law%unload, q/law%x_scale))
            if (dq >= 0.0_wp) base = min(trial, merge(y, g, q >= 0.0_wp))
            if (dq < 0.0_wp) base = max(trial, merge(g, y, q >= 0.0_wp))
         end associate
      case (TOTAL_LENGTH)
         base = value_of(curves, law%load, length/law%x_scale)
      case default   ! ELASTIC
         base = y
      end select
   end subroutine base_force

   !> H = 1: one plastic path hi for both signs
   pure subroutine yield_alike(law, curves, trial, base, path)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: trial
      real(wp), intent(inout) :: base, path

      real(wp) :: y

      y = value_of(curves, law%load, (sign(path, trial) + trial/law%k_unload)/law%x_scale)
      base = trial
      if (trial >= 0.0_wp .and. .not. trial > y) return
      if (trial < 0.0_wp .and. .not. trial < y) return
      path = path + abs(trial - y)/law%k_unload
      base = y
   end subroutine yield_alike

   !> H = 2: permanent elongation hi and compression lo, apart; no force between them
   pure subroutine yield_apart(k, q, y, base, hi, lo)
      real(wp), intent(in) :: k, q, y
      real(wp), intent(out) :: base
      real(wp), intent(inout) :: hi, lo

      base = 0.0_wp
      if (q > hi) then
         base = min(k*(q - hi), y)
         hi = q - base/k
      else if (q < lo) then
         base = max(k*(q - lo), y)
         lo = q - base/k
      end if
   end subroutine yield_apart

   !> H = 5: loading along the function beyond the largest q so far; else along a power, from the
   !> residual that the function of unloading gives for it
   pure subroutine follow_power(law, curves, q, trial, y, base, hi, lo)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: q, trial, y
      real(wp), intent(inout) :: base, hi, lo

      if (q > hi) then
         base = y
         hi = q
      else if (q > 0.0_wp) then
         base = unloaded(law, q, trial, y, hi, value_of(curves, law%load, hi/law%x_scale), &
            value_of(curves, law%unload, hi/law%x_scale))
      else if (q < lo) then
         base = y
         lo = q
      else if (q < 0.0_wp) then
         base = -unloaded(law, -q, -trial, -y, -lo, &
            -value_of(curves, law%load, lo/law%x_scale), &
            -value_of(curves, law%unload, lo/law%x_scale))
      end if
   end subroutine follow_power

   !> Force of H = 5 at 0 < q <= top, in tension; legacy quirk: Ascale multiplies a force
   pure real(wp) function unloaded(law, q, trial, y, top, y_top, residual) result(force)
      type(direction_t), intent(in) :: law
      real(wp), intent(in) :: q, trial, y, top, y_top
      real(wp), intent(in) :: residual           !! of the function of unloading at top

      real(wp) :: r, m, z

      force = 0.0_wp
      r = max(residual, 0.0_wp)
      if (.not. q > r .or. abs(y_top) <= 0.0_wp) return
      m = y_top*law%x_scale
      r = min(r, top - m/law%k_unload)
      z = (q - r)/(top - r)
      force = max(trial, m*z**((top - r)*law%k_unload/m), 0.0_wp)
      force = min(force, m*z, y)
   end function unloaded

   !> H = 6: yield limit hi for both signs, path lo while yielding; elastic slope from the function
   !> of unloading, which is taken without Ascale (legacy quirk)
   pure subroutine yield_by_curves(law, curves, dq, base, limit, path)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: dq
      real(wp), intent(inout) :: base, limit, path

      real(wp) :: trial, y

      trial = base + slope_at(curves, law%unload, base)*dq
      y = value_of(curves, law%load, (sign(abs(path), trial) + dq)/law%x_scale)
      base = trial
      if (trial >= 0.0_wp .and. trial > limit) then
         limit = y
      else if (trial < 0.0_wp .and. trial < -limit) then
         limit = -y
      else
         return
      end if
      base = y
      path = path + abs(dq)
   end subroutine yield_by_curves

   !> Slope of the first segment of a function whose ordinates hold y, the upper end not; beyond
   !> them that of the first or last segment; 0 where none does
   pure real(wp) function slope_at(curves, c, y) result(slope)
      type(curve_set_t), intent(in) :: curves
      integer, intent(in) :: c
      real(wp), intent(in) :: y

      integer :: i, first, last

      slope = 0.0_wp
      first = curves%first(c)
      last = curves%first(c + 1) - 1
      do i = first, last - 1
         if (.not. (y >= curves%y(i) .and. y < curves%y(i + 1) .or. &
            i == first .and. y < curves%y(first) .or. i == last - 1 .and. y > curves%y(last))) cycle
         slope = (curves%y(i + 1) - curves%y(i))/(curves%x(i + 1) - curves%x(i))
         return
      end do
   end function slope_at

   !> Factor of the base force at a rate
   pure real(wp) function rate_factor(law, curves, rate) result(factor)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: rate

      factor = law%a
      if (abs(law%b) > 0.0_wp) factor = factor + law%b*log(max(1.0_wp, abs(rate/law%d)))
      if (law%rate > 0) factor = factor + law%e*value_of(curves, law%rate, law%f*rate)
   end function rate_factor

   !> Force of the dampers at a rate
   pure real(wp) function damping_force(law, curves, rate) result(force)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: rate

      force = law%c*rate
      if (law%damper > 0) force = force + law%h*value_of(curves, law%damper, law%f*rate)
   end function damping_force

   !> What depends on the rate, beside A times the base force, and its slope where positive
   pure subroutine rate_force(law, curves, base, rate, force, slope)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves
      real(wp), intent(in) :: base, rate
      real(wp), intent(out) :: force, slope

      real(wp) :: y, dy

      force = law%c*rate
      slope = law%c
      if (law%damper > 0) then
         call law_value(curves, law%damper, law%f*rate, y, dy)
         force = force + law%h*y
         slope = slope + law%h*law%f*dy
      end if
      if (law%rate > 0) then
         call law_value(curves, law%rate, law%f*rate, y, dy)
         force = force + base*law%e*y
         slope = slope + base*law%e*law%f*dy
      end if
      if (abs(law%b) > 0.0_wp .and. abs(rate) > abs(law%d)) then
         force = force + base*law%b*log(abs(rate/law%d))
         slope = slope + base*law%b/rate
      end if
      slope = max(0.0_wp, slope)
   end subroutine rate_force

   !> Largest stiffness of a direction, for a safe step: of loading, unloading and both functions,
   !> at the largest rate factor that its function of the rate has
   pure real(wp) function stiffness_bound(law, curves) result(k)
      type(direction_t), intent(in) :: law
      type(curve_set_t), intent(in) :: curves

      real(wp) :: factor

      k = max(0.0_wp, law%k)
      if (law%load == 0) return
      k = max(law%k_unload, 0.0_wp)
      if (law%unload > 0) k = max(k, steepest_rise(curves, law%unload)/ &
         merge(1.0_wp, law%x_scale, law%rule == ISOTROPIC_CURVES))
      factor = abs(law%a)
      if (law%rate > 0) factor = factor + abs(law%e)*maxval(abs( &
         curves%y(curves%first(law%rate):curves%first(law%rate + 1) - 1)))
      k = k*factor
   end function stiffness_bound

   !> Largest damping of a direction without what scales the base force
   pure elemental real(wp) function damping_bound(law) result(c)
      type(direction_t), intent(in) :: law

      c = max(0.0_wp, law%c_step)
   end function damping_bound

   !> What its sensor makes of a spring.
   !>
   !> Isflag 0: it waits until the sensor is on. 1: it acts until then. 2: it waits, begins without
   !> force where it was a step before, and ends with the sensor.
   pure subroutine switch_spring(may_wait, spring, time, h, q, lane, state)
      logical, intent(in) :: may_wait            !! after its end (TYPE4), else it is dead
      type(spring_t), intent(in) :: spring
      real(wp), intent(in) :: time, h            !! now, and the step before
      real(wp), intent(inout) :: q(NDOF)         !! displacements a step before
      integer, intent(in) :: lane                !! of the block
      type(spring_block_t), intent(inout) :: state

      logical :: on

      if (.not. spring%sensed) return
      on = time > spring%t_on .and. is_on(time, h, spring%t_on, spring%t_off)
      associate (alive_now => state%alive(lane))
         if (spring%flag == 1) then
            if (on) alive_now = DEAD
         else if (on .and. alive_now <= WAITING) then
            alive_now = ALIVE
            if (spring%flag /= 2) return
            state%zero(lane, :) = state%zero(lane, :) + q
            q = 0.0_wp
         else if (spring%flag == 2 .and. .not. on .and. alive_now >= ALIVE) then
            alive_now = merge(WAITING, DEAD, may_wait)
         end if
      end associate
   end subroutine switch_spring

   !> The criterion of failure, 1 or more where the spring fails, smoothed over steps
   pure subroutine failure(spring, q, rate, force, energy, h, damage)
      type(spring_t), intent(in) :: spring
      real(wp), intent(in), dimension(NDOF) :: q, rate, force, energy
      real(wp), intent(in) :: h                  !! the step before
      real(wp), intent(inout) :: damage

      real(wp) :: part, total, share
      integer :: k

      total = 0.0_wp
      do k = 1, NDOF
         associate (law => spring%dof(k))
            if (law%hi >= NO_FAILURE .and. law%lo <= -NO_FAILURE) cycle
            part = part_of(law, spring%criterion, q(k), force(k), energy(k), &
               abs(rate(k)/merge(spring%v0, spring%w0, k <= 3)))
            if (spring%summed) then
               total = total + law%weight*abs(part)**law%exponent
            else
               total = max(total, part)
            end if
         end associate
      end do
      if (spring%cutoff > 0.0_wp) then
         share = 8.0_wp*atan(1.0_wp)*spring%cutoff*h
         share = share/(1.0_wp + share)
         if (damage < 1.0_wp) total = share*min(total, 1.0_wp + 1.0e-3_wp) + (1.0_wp - share)*damage
         damage = min(total, 1.0_wp)
         return
      end if
      damage = total
   end subroutine failure

   !> Part of its limit that a direction has reached
   pure real(wp) function part_of(law, criterion, q, force, energy, speed) result(part)
      type(direction_t), intent(in) :: law
      integer, intent(in) :: criterion
      real(wp), intent(in) :: q, force, energy, speed

      real(wp) :: z, more

      more = 0.0_wp
      if (abs(law%speed) > 0.0_wp) more = law%speed*speed**law%power
      select case (criterion)
      case (BY_FORCE); z = force
      case (BY_ENERGY); z = max(0.0_wp, energy)
      case default; z = q
      end select
      if (z > 0.0_wp) then
         part = z/(law%hi + more)
      else
         part = z/(law%lo - more)
      end if
   end function part_of

end module kj_spring_law
