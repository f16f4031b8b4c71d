!> THE table of messages: every id a finding can have, what it means, why it comes, what to do.
!> `kjoint help KJ-0387` prints a row. The rows stand in kj_message_*, by their origin.
module kj_message
   use kj_message_row, only: message_t
   use kj_message_starter1, only: starter1_messages
   use kj_message_starter2, only: starter2_messages
   use kj_message_starter3, only: starter3_messages
   use kj_message_engine, only: engine_messages
   use kj_message_own, only: own_messages
   use kj_message_model, only: model_messages
   use kj_message_scene, only: scene_messages
   use kj_message_spring, only: spring_messages
   implicit none
   private

   public :: message_t, find_message

   !> All messages, ascending within each origin
   type(message_t), parameter, public :: messages(*) = [starter1_messages, starter2_messages, &
      starter3_messages, engine_messages, own_messages, model_messages, scene_messages, &
      spring_messages]

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
