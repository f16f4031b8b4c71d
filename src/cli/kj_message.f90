!> THE table of messages: every id a finding can have, what it means, why it comes, what to do.
!> `kjoint help KJ-0387` prints a row. The rows stand in kj_message_*, by what they are about.
module kj_message
   use kj_message_text, only: message_t, text_messages, full_messages
   use kj_message_scene, only: scene_messages
   use kj_message_joint, only: joint_messages
   implicit none
   private

   public :: message_t, find_message

   !> All messages, ascending within each subject
   type(message_t), parameter, public :: messages(*) = [text_messages, scene_messages, &
      joint_messages, full_messages]

contains

   !> Row of a message; 0 when there is none. The letters may be in lower case, the id without KJ-
   pure integer function find_message(id) result(row)
      character(len=*), intent(in) :: id        !! KJ-0387, kj-0387, 0387 or 387

      character(len=7) :: wanted
      character(len=4) :: digits
      integer :: first

      first = 1
      if (len(id) > 3) then
         if (index('KJ-kj-Kj-kJ-', id(:3)) > 0) first = 4
      end if
      digits = id(first:)
      if (digits(1:1) == 'e') digits(1:1) = 'E'
      digits = adjustr(digits)
      do row = 1, len(digits)
         if (digits(row:row) == ' ') digits(row:row) = '0'
      end do
      wanted = 'KJ-'//digits
      do row = 1, size(messages)
         if (messages(row)%id == wanted .and. len_trim(id) < first + 4) return
      end do
      row = 0
   end function find_message

end module kj_message
