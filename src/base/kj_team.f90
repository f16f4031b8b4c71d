!> How threads share the work of a cycle: pieces of batches and of leads.
!>
!> Within a stage of a cycle joints do not see each other, and neither do leads, so the bits of a
!> run do not depend on how it is cut.
module kj_team
   implicit none
   private

   public :: team_t, new_team, has_threads

   integer, parameter, public :: GRAIN = 128      !! cuts lie at its multiples: whole blocks
   integer, parameter :: PIECES = 4               !! for each thread
   integer, parameter :: MOST_LEADS = 4*GRAIN     !! in a piece: stages that follow find them cached

   !> The pieces
   type :: team_t
      integer :: threads = 1
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

      integer :: b, k, n, from, length

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
   end subroutine new_team

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
