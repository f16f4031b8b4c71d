!> How threads share the work of a cycle: pieces of batches and of leads.
!>
!> Within a stage of a cycle joints do not see each other, and neither do leads, so the bits of a
!> run do not depend on how it is cut, or on which thread does what. A thread takes the next share
!> as soon as it is free, so that no one waits long for a thread that is slower.
module kj_team
   use kj_kinds, only: wp
   use kj_sort, only: sorted_order
   use kj_block, only: BLOCK
   implicit none
   private

   public :: team_t, new_team, owners, has_threads

   integer, parameter :: SHARES_OF_ONE = 4       !! for each thread, at most: slower ones do fewer
   integer, parameter :: LEAST_SHARE = 4096      !! joints or leads that are worth more than one
   integer, parameter :: PIECES = 2               !! in each share, at least
   !> Leads, or joints of all batches, in a piece: what comes next finds them in the cache
   integer, parameter, public :: MOST = 8*BLOCK
   integer, parameter :: FINE = 10**6             !! places along a batch that are told apart
   integer, parameter :: LEAD_WORK = 8            !! of a lead, in that of one joint end or node

   !> The pieces
   type :: team_t
      integer :: threads = 1
      !> (3, pieces) batch, first joint, last joint; all batches side by side, as decks have them
      integer, allocatable :: joint(:, :)
      integer, allocatable :: lead(:, :)          !! (2, pieces) first, last lead
      integer :: shares = 1                       !! pieces that a thread does in a row
      ! (0:shares) pieces up to the end of each share
      integer, allocatable :: joints(:)           !! of the pieces of joints
      integer, allocatable :: leads(:)            !! of the pieces of leads
   end type team_t

contains

   !> Cut a scene. It gets no more threads than it has joints and leads for: `least` each.
   pure subroutine new_team(threads, least, n_joint, n_end, team)
      integer, intent(in) :: threads, least
      integer, intent(in) :: n_joint(:)           !! of each batch
      integer, intent(in) :: n_end(:)             !! (n_lead) joint ends, and nodes to move, of each
      type(team_t), intent(out) :: team

      integer :: k, n, n_lead, length

      n_lead = size(n_end)
      n = sum(n_joint)
      team%threads = max(1, min(threads, max(n, n_lead)/max(1, least)))
      if (team%threads > 1) then
         k = max(1, min(SHARES_OF_ONE, max(n, n_lead)/(team%threads*LEAST_SHARE)))
         team%shares = k*team%threads
      end if
      call cut_batches(n_joint, min(MOST, piece_length(n, team%shares)), team%joint)
      length = min(MOST, piece_length(n_lead, team%shares))
      n = (n_lead + length - 1)/length
      allocate (team%lead(2, n))
      do k = 1, n
         team%lead(:, k) = [(k - 1)*length + 1, min(k*length, n_lead)]
      end do
      allocate (team%joints(0:team%shares), team%leads(0:team%shares))
      team%joints = fair_shares(real(team%joint(3, :) - team%joint(2, :) + 1, wp), team%shares)
      team%leads = fair_shares([(LEAD_WORK*real(team%lead(2, k) - team%lead(1, k) + 1, wp) + &
         sum(n_end(team%lead(1, k):team%lead(2, k))), k=1, n)], team%shares)
   end subroutine new_team

   !> Pieces of each batch, `length` joints of all batches together, in the order of their place
   !> along the batch
   pure subroutine cut_batches(n_joint, length, joint)
      integer, intent(in) :: n_joint(:), length
      integer, allocatable, intent(out) :: joint(:, :)

      integer :: b, k, n, from, step(size(n_joint))
      real(wp) :: blocks
      integer, allocatable :: place(:)

      blocks = real(length, wp)/BLOCK/max(1, sum(n_joint))
      n = 0
      do b = 1, size(n_joint)
         step(b) = BLOCK*max(1, ceiling(blocks*n_joint(b)))
         n = n + (n_joint(b) + step(b) - 1)/step(b)
      end do
      allocate (joint(3, n), place(n))
      k = 0
      do b = 1, size(n_joint)
         do from = 1, n_joint(b), step(b)
            k = k + 1
            joint(:, k) = [b, from, min(from + step(b) - 1, n_joint(b))]
            place(k) = int(FINE*(real(from - 1, wp)/n_joint(b)))
         end do
      end do
      joint = joint(:, sorted_order(place))
   end subroutine cut_batches

   !> (0:shares) pieces up to the end of each share, by the work of each piece
   pure function fair_shares(work, shares) result(to)
      real(wp), intent(in) :: work(:)
      integer, intent(in) :: shares
      integer :: to(0:shares)

      integer :: k, owner
      real(wp) :: before, total

      total = sum(work)
      to = 0
      before = 0.0_wp
      do k = 1, size(work)                        ! a piece belongs where its middle lies
         owner = min(shares, 1 + int(real(shares, wp)*(before + 0.5_wp*work(k))/total))
         to(owner:) = k
         before = before + work(k)
      end do
   end function fair_shares

   !> Share of each piece of joints
   pure function owners(team) result(owner)
      type(team_t), intent(in) :: team
      integer :: owner(size(team%joint, 2))

      integer :: s

      do s = 1, team%shares
         owner(team%joints(s - 1) + 1:team%joints(s)) = s
      end do
   end function owners

   !> Was this built with OpenMP?
   pure logical function has_threads()

      has_threads = .false.
      !$ has_threads = .true.
   end function has_threads

   !> A multiple of BLOCK; all of it where there is one share
   pure integer function piece_length(n, shares) result(length)
      integer, intent(in) :: n, shares

      length = n
      if (shares > 1) length = n/(PIECES*shares)
      length = BLOCK*(max(1, length + BLOCK - 1)/BLOCK)
      length = max(BLOCK, length)
   end function piece_length

end module kj_team
