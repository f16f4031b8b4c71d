!> Joints and leads in pieces that threads take. Within a stage of a cycle joints do not see each
!> other, and neither do leads, so the bits of a run do not depend on how a scene is cut, or on
!> which thread does what.
module kj_team
   !$ use omp_lib, only: omp_get_num_procs
   use kj_kinds, only: wp
   use kj_system, only: wall_clock
   use kj_block, only: BLOCK
   implicit none
   private

   public :: team_t, trial_t, new_team, next_cycle, team_clock, has_threads, processors

   integer, parameter :: PIECES = 4               !! for each thread, at least: slower ones do fewer
   !> joints or leads in a piece
   integer, parameter, public :: MOST = 512

   integer, parameter :: WINDOW = 4               !! cycles that are compared
   integer, parameter :: AGAIN = 32               !! windows of all threads between two looks at one
   real(wp), parameter :: DEAR = 50.0_wp          !! pause of threads that were slower, in losses
   real(wp), parameter :: FORGET = 1.02_wp        !! by window: scenes and clocks change

   !> Threads, or one: on a machine that others use the one may be faster, as threads meet at the
   !> end of each stage and wait for one that does not run. The time of the stages decides: threads
   !> that take longer than the quickest windows of one pause for DEAR times what that has cost, and
   !> for twice as many times at each further loss in a row, so that looks at them never cost more
   !> than the 1/DEAR of a run, and on a machine that stays busy next to nothing.
   type :: trial_t
      integer :: threads = 1                      !! of the stages of this cycle
      real(wp) :: spent = 0.0_wp                  !! in the stages of this window [s]
      real(wp) :: one = 0.5_wp*huge(1.0_wp)       !! in those of the quickest windows of one thread
      integer :: cycles = 0                       !! of this window that have begun
      integer :: left = AGAIN                     !! windows of all threads before a look at one
      real(wp) :: pause = 0.0_wp                  !! that all threads have still to make [s]
      real(wp) :: dear = DEAR                     !! the next pause, in losses
   end type trial_t

   !> The pieces: whole blocks
   type :: team_t
      integer :: threads = 1
      integer :: lanes = 0                        !! places of a block that are used
      integer, allocatable :: joint(:, :)         !! (3, pieces) batch, first joint, last joint
      integer, allocatable :: lead(:, :)          !! (2, pieces) first, last lead
   end type team_t

contains

   !> Cut a scene. It gets no more threads than it has joints and leads for: `least` each.
   pure subroutine new_team(threads, least, n_joint, n_lead, team)
      integer, intent(in) :: threads, least
      integer, intent(in) :: n_joint(:)           !! of each batch
      integer, intent(in) :: n_lead
      type(team_t), intent(out) :: team

      integer :: b, k, from, step

      team%lanes = min(BLOCK, max(n_lead, maxval(n_joint)))
      team%threads = max(1, min(threads, max(sum(n_joint), n_lead)/max(1, least)))
      step = piece_length(sum(n_joint), team%threads)
      allocate (team%joint(3, sum((n_joint + step - 1)/step)))
      k = 0
      do b = 1, size(n_joint)
         do from = 1, n_joint(b), step
            k = k + 1
            team%joint(:, k) = [b, from, min(from + step - 1, n_joint(b))]
         end do
      end do
      step = piece_length(n_lead, team%threads)
      allocate (team%lead(2, (n_lead + step - 1)/step))
      do k = 1, size(team%lead, 2)
         team%lead(:, k) = [(k - 1)*step + 1, min(k*step, n_lead)]
      end do
   end subroutine new_team

   !> Of n joints or leads: a multiple of BLOCK
   pure integer function piece_length(n, threads) result(length)
      integer, intent(in) :: n, threads

      length = MOST
      if (threads > 1) length = min(MOST, BLOCK*max(1, n/(PIECES*threads*BLOCK)))
   end function piece_length

   !> A cycle begins: with how many threads
   pure subroutine next_cycle(team, trial)
      type(team_t), intent(in) :: team
      type(trial_t), intent(inout) :: trial

      logical :: slower

      if (team%threads == 1) return
      slower = trial%threads > 1 .and. trial%spent > trial%one
      if (trial%cycles < WINDOW .and. .not. slower) then
         trial%cycles = trial%cycles + 1
         return
      end if
      if (slower) then
         trial%pause = trial%dear*(trial%spent - trial%one)
         trial%dear = 2.0_wp*trial%dear
         trial%threads = 1
      else if (trial%threads > 1) then
         trial%left = trial%left - 1
         if (trial%left == 0) then
            trial%threads = 1
            trial%dear = DEAR
         end if
      else
         trial%one = min(trial%spent, FORGET*trial%one)
         trial%pause = max(0.0_wp, trial%pause - trial%spent)
         trial%left = AGAIN
         if (trial%pause <= 0.0_wp) trial%threads = team%threads
      end if
      trial%cycles = 1
      trial%spent = 0.0_wp
   end subroutine next_cycle

   !> The wall clock where next_cycle wants to know what stages take, else 0 [s]
   real(wp) function team_clock(team)
      type(team_t), intent(in) :: team

      team_clock = 0.0_wp
      if (team%threads > 1) team_clock = wall_clock()
   end function team_clock

   !> Processors that this process may use
   integer function processors() result(n)

      n = 1
      !$ n = omp_get_num_procs()
   end function processors

   !> Was this built with OpenMP?
   pure logical function has_threads()

      has_threads = .false.
      !$ has_threads = .true.
   end function has_threads

end module kj_team
