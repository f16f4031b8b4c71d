!> What a comparison of two histories is asked and what it answers.
module kj_diff_types
   use, intrinsic :: iso_fortran_env, only: int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_number, only: parse_real, NUMBER_FINE
   use kj_text, only: text_t
   use kj_metrics, only: metrics
   implicit none
   private

   public :: diff_options_t, diff_result_t, channel_result_t, class_result_t, profile_t
   public :: find_profile, set_window, is_quaternion

   !> A name for a tolerance
   type :: profile_t
      character(len=8) :: name
      real(wp) :: rtol           !! tolerance, of the peak in REF
      logical :: bitwise         !! equal bits wanted; rtol has no part in it
   end type profile_t

   type(profile_t), parameter :: profiles(*) = [ &
      profile_t('exact',    0.0_wp,     .true.),  &
      profile_t('repeat',   1.0e-12_wp, .false.), &
      profile_t('parity',   1.0e-7_wp,  .false.), &
      profile_t('platform', 1.0e-9_wp,  .false.), &
      profile_t('solver',   1.0e-2_wp,  .false.)]

   integer, parameter, public :: N_WORST = 10

   !> What is asked
   type :: diff_options_t
      character(len=20) :: profile = ''         !! '' = parity with a T01 on a side, else platform
      real(wp) :: rtol = -1.0_wp                !! in place of that of the profile when not negative
      real(wp) :: atol = 0.0_wp                 !! added to every tolerance, in units of REF
      logical :: interpolate = .false.          !! RUN linearly on the times of REF
      logical :: strict = .false.               !! what is not compared counts as different
      logical :: has_window = .false.
      real(wp) :: window(2) = 0.0_wp            !! first and last time compared
      logical :: metrics(size(metrics)) = .false.
      character(len=:), allocatable :: channels !! names as kj_series has them; not allocated: all
   end type diff_options_t

   !> One channel of one entity
   type :: channel_result_t
      character(len=:), allocatable :: name     !! "joint/force[5]", "joint/force[5].x", "mass"
      character(len=:), allocatable :: title    !! the same for people: "joint/force[pin C (5)]"
      integer :: channel = 0                    !! row of kj_channels
      integer :: class = 0                      !! place in diff_result_t%class
      integer :: entity = 0                     !! user id, 0 for the run
      integer :: n_comp = 1
      integer :: ref_at = 0, run_at = 0         !! place in a row of each side; run_at 0 = missing
      logical :: counted = .true.               !! false: listed, not part of the verdict
      logical :: different = .false.
      integer :: n_beyond = 0                   !! numbers beyond their tolerance
      integer(int64) :: n_number = 0            !! numbers compared
      integer(int64) :: n_void = 0              !! numbers that are NaN on both sides: not compared
      real(wp) :: peak = 0.0_wp                 !! largest norm in REF
      real(wp) :: tolerance = 0.0_wp            !! atol + rtol S
      ! the worst number: where its difference is largest in terms of the tolerance
      real(wp) :: excess = 0.0_wp               !! difference/tolerance, huge where that is 0
      real(wp) :: difference = 0.0_wp           !! NaN when only one side is NaN
      real(wp) :: allowed = 0.0_wp              !! the tolerance there
      real(wp) :: time = 0.0_wp
      integer :: comp = 0
      real(wp), allocatable :: metric(:, :)     !! (size(metrics), n_comp) when metrics are wanted
   end type channel_result_t

   !> All channels of one class together
   type :: class_result_t
      character(len=20) :: name = ''
      integer :: n_channel = 0, n_different = 0
      integer :: worst = 0                      !! place in diff_result_t%channel
   end type class_result_t

   !> What is answered
   type :: diff_result_t
      integer :: code = 0                       !! 0 same, 1 different
      character(len=:), allocatable :: ref_path, run_path
      type(profile_t) :: profile                !! with the tolerance that was used
      integer :: n_ref = 0, n_run = 0           !! samples
      integer :: n_sample = 0                   !! compared
      integer :: n_ref_alone = 0, n_run_alone = 0   !! without a partner, but for the final state
      real(wp) :: alone_at = 0.0_wp             !! time of the first of these
      integer :: n_channel = 0, n_different = 0
      integer(int64) :: n_number = 0            !! numbers compared, of channels other than the time
      logical :: incomplete = .false.           !! something of REF is not compared, or nothing is
      logical :: strict = .false.               !! that counts, and what RUN alone has
      type(channel_result_t), allocatable :: channel(:)    !! the time first
      type(class_result_t), allocatable :: class(:)
      integer :: n_worst = 0
      integer :: worst(N_WORST) = 0             !! places in `channel`, worst first
      type(text_t), allocatable :: ignored(:)   !! variables of REF that our layout does not know
      type(text_t), allocatable :: run_only(:)  !! channels of RUN that REF does not have
      type(text_t), allocatable :: note(:)
   end type diff_result_t

contains

   !> Row of a profile
   !>
   !> Errors: ERR_INPUT when there is none of this name.
   subroutine find_profile(name, profile, error)
      character(len=*), intent(in) :: name
      type(profile_t), intent(out) :: profile
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: known
      integer :: i

      known = ''
      do i = 1, size(profiles)
         profile = profiles(i)
         if (profile%name == name) return
         known = known//' '//trim(profile%name)
      end do
      call fail(error, ERR_INPUT, 'there is no profile "'//trim(name)//'", but'//known)
   end subroutine find_profile

   !> Take a window from its text, "T0:T1"
   !>
   !> Errors: ERR_INPUT when it is not of this form or T1 < T0.
   subroutine set_window(text, options, error)
      character(len=*), intent(in) :: text
      type(diff_options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      integer :: colon, status(2)

      colon = index(text, ':')
      call parse_real(text(:colon - 1), options%window(1), status(1))
      call parse_real(text(colon + 1:), options%window(2), status(2))
      options%has_window = all(status == NUMBER_FINE) .and. &
         options%window(1) <= options%window(2)
      if (.not. options%has_window) call fail(error, ERR_INPUT, &
         'a window is two times T0:T1 with T0 <= T1, not "'//text//'"')
   end subroutine set_window

   !> Compared by angle, as one number
   pure logical function is_quaternion(channel)
      type(channel_result_t), intent(in) :: channel

      is_quaternion = channel%n_comp == 4
   end function is_quaternion

end module kj_diff_types
