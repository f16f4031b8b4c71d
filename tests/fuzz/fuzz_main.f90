!> Changes decks at random, reads and builds each, and runs some cycles of those that are right.
!>
!> usage: fuzz COUNT SEED DECK_0000.rad ...
!>
!> Of a deck in a folder full the mechanism is taken out. The deck under way is fuzz_0000.rad with
!> fuzz_0001.rad in the current folder: after a crash they are the proof. The same count, seed and
!> decks change the same things.
program fuzz_main
   use, intrinsic :: iso_fortran_env, only: output_unit
   use kj_kinds, only: wp
   use kj_error, only: error_t, finding_list_t
   use kj_system, only: thread_clock
   use kj_deck, only: read_deck
   use kj_deck_text, only: source_t
   use kj_parameter, only: setting_t
   use kj_mechanism, only: take_mechanism
   use kj_extract_report, only: extract_report_t
   use kj_engine, only: engine_t, read_engine
   use kj_model, only: model_t
   use kj_build, only: build_model
   use kj_legacy_state, only: legacy_state_t, new_legacy_state
   use kj_legacy_step, only: find_accelerations, advance
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_build, only: build_consistent_model, new_consistent_state
   use kj_consistent_safe_step, only: bound_t, new_bound, renew_bound
   use kj_consistent_nodal_step, only: nodal_bound
   use fuzz_text, only: random_t, seed_random, below, mutate, load_text, save_text
   use kj_draft, only: draft_t
   implicit none

   integer, parameter :: CYCLES = 20
   real(wp), parameter :: TOO_LONG = 20.0_wp     !! [s] of a processor for one deck

   type :: text_t
      character(len=:), allocatable :: starter, engine
      logical :: full = .false.
   end type text_t

   type(text_t), allocatable :: decks(:)
   integer :: count, seed, i, read_well, built, ran, with_findings
   real(wp) :: started, slowest, clock

   call read_arguments()
   read_well = 0
   built = 0
   ran = 0
   with_findings = 0
   slowest = 0.0_wp
   started = thread_clock()
   do i = 1, count
      clock = thread_clock()
      call try_one(seed + i)
      slowest = max(slowest, thread_clock() - clock)
      if (slowest > TOO_LONG) then
         write (output_unit, '(a,i0)') 'too long: mutation ', i
         error stop 1
      end if
   end do
   write (output_unit, '(i0,a,i0,a,f0.1,a)') count, ' changed decks of ', size(decks), ' in ', &
      thread_clock() - started, ' s'
   call tell('with a finding', with_findings)
   call tell('past the reader', read_well)
   call tell('past the builder', built)
   call tell('ran some cycles', ran)
   write (output_unit, '(3x,a20,f7.3,a)') 'slowest', slowest, ' s'
   deallocate (decks)

contains

   subroutine tell(what, n)
      character(len=*), intent(in) :: what
      integer, intent(in) :: n

      write (output_unit, '(3x,a20,f6.1,a)') what, 100.0_wp*n/max(1, count), ' %'
   end subroutine tell

   subroutine read_arguments()
      character(len=1000) :: word
      integer :: k, n

      call get_command_argument(1, word)
      read (word, *) count
      call get_command_argument(2, word)
      read (word, *) seed
      n = command_argument_count() - 2
      allocate (decks(n))
      do k = 1, n
         call get_command_argument(k + 2, word)
         call load_text(trim(word), decks(k)%starter)
         decks(k)%full = index(word, '/full/') > 0
         call load_text(word(:index(word, '_0000.rad'))//'0001.rad', decks(k)%engine)
      end do
   end subroutine read_arguments

   !> Change a deck in one to four places, read it, build it, and run it
   subroutine try_one(seed)
      integer, intent(in) :: seed

      type(random_t) :: random
      type(draft_t) :: draft
      type(engine_t) :: engine
      type(source_t) :: source
      type(model_t) :: model
      type(finding_list_t) :: findings
      type(extract_report_t) :: report
      character(len=:), allocatable :: starter, controls
      integer :: k, n

      call seed_random(random, seed)
      k = below(random, size(decks))
      starter = decks(k)%starter
      controls = decks(k)%engine
      do n = 1, below(random, 4)
         if (below(random, 12) == 1) then
            call mutate(random, controls)
         else
            call mutate(random, starter)
         end if
      end do
      call save_text('fuzz_0000.rad', starter)
      call save_text('fuzz_0001.rad', controls)
      if (decks(k)%full) then
         call take_mechanism('fuzz_0000.rad', [setting_t ::], findings, draft%deck, report)
      else
         call read_deck('fuzz_0000.rad', draft%deck, below(random, 4) == 1)
      end if
      call read_engine('fuzz_0001.rad', engine, source, draft%deck%findings)
      if (draft%deck%findings%n_error == 0) read_well = read_well + 1
      if (draft%deck%readable) call build_model(draft, engine, model, below(random, 2) == 1)
      findings = draft%deck%findings
      if (findings%n > 0) with_findings = with_findings + 1
      if (.not. draft%deck%readable .or. findings%n_error > 0) return
      built = built + 1
      call run_some_cycles(model)
      call find_limits(model)
   end subroutine try_one

   !> The legacy scheme from its start
   subroutine run_some_cycles(model)
      type(model_t), intent(in) :: model

      type(legacy_state_t) :: state
      type(error_t), allocatable :: error
      integer :: n

      call new_legacy_state(model, state)
      do n = 1, CYCLES
         call find_accelerations(model, state, .true., error)
         if (allocated(error)) return
         call advance(model, state, error)
         if (allocated(error)) return
      end do
      ran = ran + 1
   end subroutine run_some_cycles

   !> What `kjoint check` and the consistent formulation start with
   subroutine find_limits(model)
      type(model_t), intent(in) :: model

      type(consistent_model_t) :: scene
      type(consistent_state_t) :: state
      type(bound_t) :: bound
      real(wp) :: h

      scene%model_t = model
      call build_consistent_model(scene)
      call new_consistent_state(scene, state)
      call new_bound(scene, .false., state, bound)
      call nodal_bound(scene, state, h)
      call renew_in_place(scene, state, bound)
      call new_bound(scene, .true., state, bound)
      call renew_in_place(scene, state, bound)
   end subroutine find_limits

   !> A bound renewed where nothing has moved: never longer, and shorter by 1 - 6^(-1/512) at most
   !> (Runge-Kutta: at most twice that, stiffness and damping each have their share); or as
   !> short as a step of the largest real can be, where the eigenvalue is no number. Beyond LONGEST
   !> there may be no limit at all.
   subroutine renew_in_place(model, state, bound)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state
      type(bound_t), intent(inout) :: bound

      real(wp), parameter :: ROUNDING = 1.0e-9_wp, SHORTEST = 2.1_wp/sqrt(huge(1.0_wp)), &
         LONGEST = 8.0e149_wp
      real(wp) :: first(size(bound%limit))
      integer :: i

      first = bound%limit
      call renew_bound(model, state, bound)
      if (any(bound%limit > (1.0_wp + ROUNDING)*first .and. first < LONGEST) .or. &
         any(bound%limit < (6.0_wp**(-1.0_wp/256.0_wp) - ROUNDING)*first .and. &
         bound%limit > SHORTEST)) then
         print '(2es24.16)', (first(i), bound%limit(i), i=1, size(first))
         error stop 'a renewed bound differs from the first'
      end if
   end subroutine renew_in_place

end program fuzz_main
