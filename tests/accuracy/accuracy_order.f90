!> Order of convergence of each joint type: a smooth scene in steps h, h/2, h/4, h/8 against h/64 (rkmk4: h/32).
module accuracy_order
   use kjoint, only: wp, run_options_t
   use kj_channels, only: OF_BODY
   use accuracy_check, only: check_t, within, holds, say
   use accuracy_deck, only: deck_t, new_deck, add_body, add_joint, add_motion, ramp_curve, &
      add_gravity, add_load, add_drive, write_deck, turn_about
   use accuracy_run, only: run_t, run_deck, distance, slope_of
   implicit none
   private

   public :: check_order, check_driven

   real(wp), parameter :: SAMPLE = 0.01_wp
   real(wp), parameter :: LONGEST = 2.5e-4_wp    !! the step h; also the spacing of the ramp's table, so that
                                                 !! its kinks lie between steps
   real(wp), parameter :: LONG = 5.0e-3_wp       !! the same of compliant, 20 times the stable step

contains

   !> Order 2 in pose and velocity for one joint type and both skew flags (rkmk4: 4)
   subroutine check_order(check, type, integrator)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: type
      character(len=*), intent(in) :: integrator !! '' = the default

      type(run_options_t) :: options
      integer :: flag

      call choose(integrator, options)
      do flag = 0, 1
         if (type == 5 .and. flag == 1) cycle
         call fit(check, type, flag, .false., options)
      end do
   end subroutine check_order

   !> The same with body 1 driven: imposed velocity along y, imposed spin about z
   subroutine check_driven(check, type, integrator)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: type
      character(len=*), intent(in) :: integrator

      type(run_options_t) :: options

      call choose(integrator, options)
      call fit(check, type, 0, .true., options)
   end subroutine check_driven

   !> compliant: rigid joints, and the step of the deck alone
   subroutine choose(integrator, options)
      character(len=*), intent(in) :: integrator
      type(run_options_t), intent(inout) :: options

      options%integrator = integrator
      if (integrator /= 'compliant') return
      options%kn = 'inf'
      options%error = 1.0e3_wp
      options%turn = 1.0e3_wp
   end subroutine choose

   subroutine fit(check, type, flag, driven, options)
      type(check_t), intent(inout) :: check
      integer, intent(in) :: type, flag
      logical, intent(in) :: driven
      type(run_options_t), intent(in) :: options

      character(len=*), parameter :: NAMES(4) = [character(len=16) :: 'position', 'orientation', 'velocity', &
         'angular_velocity']
      integer :: parts(5)
      type(run_t) :: run(5)
      type(deck_t) :: deck
      real(wp) :: h(4), error(4), longest_step
      character(len=20) :: root
      character(len=80) :: line
      integer :: i, k

      write (root, '(a,i0,a,i0)') 'order', type, '_', flag
      parts = [64, 1, 2, 4, 8]
      if (options%integrator == 'rkmk4') parts(1) = 32
      longest_step = LONGEST
      if (options%integrator == 'compliant') longest_step = LONG
      call scene(type, flag, driven, deck)
      do i = 1, 5
         deck%dt_max = longest_step/parts(i)
         call write_deck(deck, trim(root))
         call run_deck(trim(root), options, run(i))
         if (.not. run(i)%good) call say('run '//trim(root)//': '//run(i)%message)
      end do
      h = longest_step/parts(2:)
      do k = 1, size(NAMES)
         error = [(distance(run(i), run(1), OF_BODY, trim(NAMES(k))), i=2, 5)]
         write (line, '(a,4es10.2)') '   errors of '//NAMES(k), error
         call say(line)
         write (line, '(a,i0,a,i0,a)') 'order, type ', type, ', skew flag ', flag, ', '//trim(NAMES(k))
         if (options%integrator == 'rkmk4' .and. k > 2) then
            ! what rings in the joint dies by the scheme as h^5, in velocities more than the rest
            call holds(check, trim(line), slope_of(h, error) > 3.6_wp)
         else if (options%integrator == 'rkmk4') then
            call within(check, trim(line), slope_of(h, error), 4.0_wp, 0.4_wp)
         else
            call within(check, trim(line), slope_of(h, error), 2.0_wp, 0.15_wp)
         end if
      end do
   end subroutine fit

   !> Two free bodies whose centres of gravity and principal axes lie on z, turning about z together:
   !> a motion without any joint force. Gravity on both, a force and a moment on body 2 grow from nothing
   !> with three continuous derivatives. Joint nodes aside of z and apart, frames 12 degrees apart.
   !> Driven: all starts at rest, the drive grows as smoothly.
   subroutine scene(type, flag, driven, deck)
      integer, intent(in) :: type, flag
      logical, intent(in) :: driven
      type(deck_t), intent(out) :: deck

      real(wp), parameter :: X1(3) = [0.10_wp, 0.05_wp, 0.12_wp], X2(3) = [0.16_wp, 0.02_wp, 0.25_wp]
      real(wp) :: e1(3, 3), e2(3, 3)

      call new_deck(deck, 0.5_wp, SAMPLE)
      call add_body(deck, [0.0_wp, 0.0_wp, 0.0_wp], 5.0_wp, &
         [0.06_wp, 0.05_wp, 0.08_wp, 0.0_wp, 0.0_wp, 0.0_wp], .false.)
      call add_body(deck, [0.0_wp, 0.0_wp, 0.4_wp], 2.0_wp, &
         [0.03_wp, 0.05_wp, 0.04_wp, 0.0_wp, 0.0_wp, 0.0_wp], .false.)
      if (.not. driven) then
         call add_motion(deck, 1, [0.3_wp, -0.2_wp, 0.1_wp], [0.0_wp, 0.0_wp, 2.0_wp])
         call add_motion(deck, 2, [0.3_wp, -0.2_wp, 0.1_wp], [0.0_wp, 0.0_wp, 2.0_wp])
      end if
      e1 = turn_about([1.0_wp, 2.0_wp, -1.0_wp], 0.7_wp)
      e2 = matmul(turn_about([2.0_wp, -1.0_wp, 1.0_wp], 0.21_wp), e1)
      if (type == 5) e2 = matmul(e1, reshape([0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, &
         0.0_wp, 0.0_wp, 1.0_wp], [3, 3]))
      call add_joint(deck, type, flag, [1, 2], X1, X2, e1, e2, 1.0e6_wp, 0.05_wp, &
         [2000.0_wp, 3000.0_wp, 2500.0_wp, 40.0_wp, 30.0_wp, 50.0_wp], &
         [6.0_wp, 5.0_wp, 4.0_wp, 0.05_wp, 0.08_wp, 0.06_wp])
      call ramp_curve(deck, 0.15_wp, LONGEST)
      if (driven) then
         call ramp_curve(deck, 0.4_wp, LONGEST)
         call add_drive(deck, 1, ' Y', 0.5_wp, 2)
         call add_drive(deck, 1, 'ZZ', 1.0_wp, 2)
      end if
      call add_gravity(deck, 'Z', -9.81_wp, 1)
      call add_load(deck, 2, ' X', 12.0_wp, 1)
      call add_load(deck, 2, ' Y', -8.0_wp, 1)
      call add_load(deck, 2, 'YY', 1.5_wp, 1)
      call add_load(deck, 2, 'ZZ', 1.0_wp, 1)
   end subroutine scene

end module accuracy_order
