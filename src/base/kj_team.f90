!> How threads share the work of a cycle: pieces of batches and of leads.
!>
!> Within a stage of a cycle joints do not see each other, and neither do leads, so the bits of a
!> run do not depend on how it is cut. A thread always gets the same pieces of a stage, and finds in
!> its cache what it had in the last one.
module kj_team
   use kj_kinds, only: wp
   implicit none
   private

   public :: team_t, new_team, even_shares, has_threads

   integer, parameter, public :: GRAIN = 128      !! cuts lie at its multiples: whole blocks
   integer, parameter :: PIECES = 4               !! for each thread
   integer, parameter :: MOST_LEADS = 4*GRAIN     !! in a piece: stages that follow find them cached
   integer, parameter :: LEAD_WORK = 8            !! of a lead, in that of gathering one joint end

   !> The pieces
   type :: team_t
      integer :: threads = 1
      integer, allocatable :: joint(:, :)         !! (3, pieces) batch, first joint, last joint
      integer, allocatable :: lead(:, :)          !! (2, pieces) first, last lead
      ! (0:threads) pieces up to the end of each thread's share
      integer, allocatable :: joints(:)           !! of the pieces of joints
      integer, allocatable :: leads(:)            !! of the pieces of leads
   end type team_t

contains

   !> Cut a scene. It gets no more threads than it has joints and leads for: `least` each.
   pure subroutine new_team(threads, least, n_joint, n_end, team)
      integer, intent(in) :: threads, least
      integer, intent(in) :: n_joint(:)           !! of each batch
      integer, intent(in) :: n_end(:)             !! (n_lead) joint ends on each lead
      type(team_t), intent(out) :: team

      integer :: b, k, n, n_lead, from, length

      n_lead = size(n_end)
      n = sum(n_joint)
      team%threads = max(1, min(threads, max(n, n_lead)/max(1, least)))
      length = piece_length(n, team%threads)
      n = 0
      do b = 1, size(n_joint)
         n = n + (n_joint(b) + length - 1)/length
      end do
      allocate (team%joint(3, n))
      k = 0
      do b = 1, size(n_joint)
         do from = 1, n_joint(b), length
            k = k + 1
            team%joint(:, k) = [b, from, min(from + length - 1, n_joint(b))]
         end do
      end do
      length = min(MOST_LEADS, piece_length(n_lead, team%threads))
      n = (n_lead + length - 1)/length
      allocate (team%lead(2, n))
      do k = 1, n
         team%lead(:, k) = [(k - 1)*length + 1, min(k*length, n_lead)]
      end do
      team%joints = even_shares(size(team%joint, 2), team%threads)
      team%leads = fair_shares(n_end, team%lead, team%threads)
   end subroutine new_team

   !> (0:threads) pieces up to the end of each thread's share, as many for each
   pure function even_shares(n, threads) result(to)
      integer, intent(in) :: n                    !! pieces
      integer, intent(in) :: threads
      integer :: to(0:threads)

      integer :: k

      to = [((k*n)/threads, k=0, threads)]
   end function even_shares

   !> The same by the work on each lead, which may carry any number of joints
   pure function fair_shares(n_end, lead, threads) result(to)
      integer, intent(in) :: n_end(:), lead(:, :)
      integer, intent(in) :: threads
      integer :: to(0:threads)

      integer :: k, owner
      real(wp) :: work(size(lead, 2)), before, total

      do k = 1, size(work)
         work(k) = LEAD_WORK*real(lead(2, k) - lead(1, k) + 1, wp) + &
            sum(n_end(lead(1, k):lead(2, k)))
      end do
      total = sum(work)
      to = 0
      before = 0.0_wp
      do k = 1, size(work)                        ! a piece belongs where its middle lies
         owner = min(threads, 1 + int(real(threads, wp)*(before + 0.5_wp*work(k))/total))
         to(owner:) = k
         before = before + work(k)
      end do
   end function fair_shares

   !> Was this built with OpenMP?
   pure logical function has_threads()

      has_threads = .false.
      !$ has_threads = .true.
   end function has_threads

   !> A multiple of GRAIN; all of it for one thread
   pure integer function piece_length(n, threads) result(length)
      integer, intent(in) :: n, threads

      length = n
      if (threads > 1) length = n/(PIECES*threads)
      length = GRAIN*(max(1, length + GRAIN - 1)/GRAIN)
      length = max(GRAIN, length)
   end function piece_length

end module kj_team
