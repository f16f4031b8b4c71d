!> A scene under way as bytes, and back: what a checkpoint holds. Whatever the formulation, all of
!> its state goes along by the lists of kj_consistent_archive and kj_legacy_archive.
!>
!> A state goes with the deck, the version and the options that it was saved with; the rest, such as
!> the end of the run, may be another one when it is restored.
module kj_checkpoint
   use, intrinsic :: iso_fortran_env, only: int8, int64
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_version, only: KJOINT_VERSION
   use kj_archive, only: archive_t, new_archive, open_archive, close_archive, keep, is_done
   use kj_sha256, only: sha256_t, add_text, digest_of
   use kj_history, only: history_t
   use kj_sample, only: sampler_t
   use kj_legacy_archive, only: keep_legacy
   use kj_consistent_state, only: consistent_model_t
   use kj_consistent_archive, only: keep_state, keep_march
   use kj_consistent_impact_step, only: step_factor
   use kj_consistent_march, only: change_limits
   use kj_run_option, only: run_options_t, write_run_options
   use kj_scheme, only: scheme_t, plan_sample, show_clock
   implicit none
   private

   public :: save_scene, sign_state, restore_scene

   character(len=*), parameter :: KIND = 'kjoint state 2'

   !> What a state has to have in common with the scene that it is restored to
   type :: head_t
      character(len=:), allocatable :: kind      !! and layout
      character(len=:), allocatable :: version   !! of kjoint
      character(len=:), allocatable :: deck      !! sum of its texts, without the engine deck
      character(len=:), allocatable :: options   !! that the state depends on
   end type head_t

contains

   !> The state of a scene, and the rows that its history has so far. Unsigned, it lacks the sum of
   !> the deck, which takes longer than many a cycle, until sign_state.
   subroutine save_scene(options, history, rows, model, scheme, sampler, signed, byte)
      type(run_options_t), intent(in) :: options    !! settled
      type(history_t), intent(in) :: history
      integer, intent(in) :: rows
      type(consistent_model_t), intent(inout) :: model
      type(scheme_t), intent(inout) :: scheme
      type(sampler_t), intent(inout) :: sampler
      logical, intent(in) :: signed
      integer(int8), allocatable, intent(out) :: byte(:)

      type(archive_t) :: archive
      type(head_t) :: head
      real(wp) :: interval
      integer(int64) :: room
      integer :: n, pass

      n = rows
      interval = model%control%sample
      call new_head(options, history, signed, head)
      room = 0
      do pass = 1, 2                             ! count, then save
         call new_archive(archive, room)
         call keep_head(archive, head)
         call keep_scene(archive, n, interval, model, scheme, sampler)
         room = archive%n
      end do
      call close_archive(archive, byte)
   end subroutine save_scene

   !> Put the sum of the deck into a state that was saved unsigned
   subroutine sign_state(options, history, byte)
      type(run_options_t), intent(in) :: options    !! settled
      type(history_t), intent(in) :: history
      integer(int8), intent(inout) :: byte(:)

      type(archive_t) :: archive
      type(head_t) :: head

      call new_head(options, history, .true., head)
      call new_archive(archive)
      call keep_head(archive, head)
      byte(:archive%n) = archive%byte(:archive%n)
   end subroutine sign_state

   !> Restore a state over a scene that was started.
   !>
   !> Errors: ERR_INPUT when it is none, or of another deck, version or other options; the scene is
   !> as it was. ERR_INPUT, too, when it is damaged: then the scene is lost.
   subroutine restore_scene(byte, options, history, rows, model, scheme, sampler, lost, error)
      integer(int8), allocatable, intent(inout) :: byte(:)     !! moved away
      type(run_options_t), intent(in) :: options    !! settled
      type(history_t), intent(in) :: history
      integer, intent(out) :: rows
      type(consistent_model_t), intent(inout) :: model
      type(scheme_t), intent(inout) :: scheme
      type(sampler_t), intent(inout) :: sampler
      logical, intent(out) :: lost
      type(error_t), allocatable, intent(out) :: error

      type(archive_t) :: archive
      type(head_t) :: wanted, found
      real(wp) :: interval

      rows = 0
      lost = .false.
      call new_head(options, history, .true., wanted)
      call open_archive(byte, archive)
      call keep_head(archive, found)
      if (archive%damaged) then
         call fail(error, ERR_INPUT, 'this is no saved state')
      else if (found%kind /= wanted%kind) then
         call fail(error, ERR_INPUT, 'this is no saved state of this layout')
      else if (found%version /= wanted%version) then
         call fail(error, ERR_INPUT, 'the state was saved by kjoint '//found%version// &
            ', and this is '//wanted%version)
      else if (found%deck /= wanted%deck) then
         call fail(error, ERR_INPUT, 'the state is of another deck: the starter deck, or '// &
            'a file that it includes, has changed')
      else if (found%options /= wanted%options) then
         call fail(error, ERR_INPUT, 'the state was saved with '//found%options// &
            ', and this run has '//wanted%options)
      end if
      if (allocated(error)) return
      interval = model%control%sample
      call keep_scene(archive, rows, interval, model, scheme, sampler)
      lost = .not. is_done(archive)
      if (lost) then
         call fail(error, ERR_INPUT, 'the saved state is damaged')
      else
         call take_controls(interval, model, scheme)
      end if
   end subroutine restore_scene

   subroutine new_head(options, history, signed, head)
      type(run_options_t), intent(in) :: options
      type(history_t), intent(in) :: history
      logical, intent(in) :: signed              !! with the sum of the deck, else blanks
      type(head_t), intent(out) :: head

      type(run_options_t) :: fixed
      type(sha256_t) :: sum
      integer :: i

      head%kind = KIND
      head%version = KJOINT_VERSION
      fixed%formulation = options%formulation
      fixed%integrator = options%integrator
      fixed%dt_rule = options%dt_rule
      fixed%kn_scale = options%kn_scale
      fixed%kn = options%kn
      fixed%islands = options%islands
      fixed%ignore_unsupported = options%ignore_unsupported
      fixed%mechanism = options%mechanism
      fixed%set = options%set
      fixed%joint = options%joint
      call write_run_options(fixed, head%options)
      head%deck = repeat(' ', len(digest_of(sum)))
      if (.not. signed) return
      do i = 1, size(history%input_text)
         if (history%input_role(i)%s /= 'engine') call add_text(sum, history%input_text(i)%s)
      end do
      head%deck = digest_of(sum)
   end subroutine new_head

   subroutine keep_head(archive, head)
      type(archive_t), intent(inout) :: archive
      type(head_t), intent(inout) :: head

      call keep(archive, head%kind)
      call keep(archive, head%version)
      call keep(archive, head%deck)
      call keep(archive, head%options)
   end subroutine keep_head

   !> All that changes in a run. What a host may change of the model goes along.
   subroutine keep_scene(archive, rows, interval, model, self, sampler)
      type(archive_t), intent(inout) :: archive
      integer, intent(inout) :: rows
      type(consistent_model_t), intent(inout) :: model
      type(scheme_t), intent(inout) :: self
      type(sampler_t), intent(inout) :: sampler
      real(wp), intent(inout) :: interval           !! of the samples

      integer :: i

      call keep(archive, rows)
      call keep(archive, interval)
      call keep(archive, self%due)
      call keep(archive, self%apart)
      call keep(archive, self%n_sample)
      call keep(archive, self%t_first)
      call keep(archive, self%t_next)
      call keep(archive, self%now%loosest)
      call keep(archive, self%now%loosest_joint)
      do i = 1, size(model%cload)
         call keep(archive, model%cload(i)%y_scale)
      end do
      do i = 1, size(model%batch)
         if (.not. model%batch(i)%limited) cycle
         call keep(archive, model%batch(i)%limit%t_lock)
         call keep(archive, model%batch(i)%limit%t_free)
      end do
      call keep_legacy(archive, self%cycles)
      call keep_state(archive, self%state)
      call keep_march(archive, self%march)
      do i = 1, size(self%part)
         call keep_state(archive, self%part(i)%state)
         call keep_march(archive, self%part(i)%march)
      end do
      call keep(archive, sampler%orientation)
      if (archive%saving) return
      self%shown = .false.
      call show_clock(model, self)
   end subroutine keep_scene

   !> What the model says of steps and samples now, for a scene that was restored and goes on with
   !> it. Where nothing changed, neither do its bits.
   subroutine take_controls(interval, model, self)
      real(wp), intent(in) :: interval          !! of samples, before
      type(consistent_model_t), intent(in) :: model
      type(scheme_t), intent(inout) :: self

      integer :: p

      if (allocated(self%state%joint)) call change_limits(model, step_factor(model), &
         model%control%dt_max, self%state, self%march)
      do p = 1, size(self%part)
         call change_limits(self%part(p)%model, step_factor(model), model%control%dt_max, &
            self%part(p)%state, self%part(p)%march)
      end do
      if (abs(interval - model%control%sample) <= 0.0_wp) return
      self%t_first = self%now%time
      self%n_sample = 0
      self%t_next = self%t_first
      self%due = .true.
      call plan_sample(model%model_t, self)
   end subroutine take_controls

end module kj_checkpoint
