!> One row of the table of messages.
module kj_message_row
   implicit none
   private

   public :: message_t

   !> A message explained
   type :: message_t
      character(len=7)   :: id         !! KJ-nnnn, KJ-Ennn: of OpenRadioss; KJ-9nnn: ours
      integer            :: severity   !! SEV_ constant, the usual one
      character(len=72)  :: title      !! what is wrong, in general
      character(len=240) :: cause      !! why
      character(len=160) :: cure       !! what to do
   end type message_t

end module kj_message_row
