!> Accuracy tests: `accuracy_tests NAME [NUMBER]`, decks are written into the current folder.
program accuracy_main
   use accuracy_check, only: check_t, say, quit
   use accuracy_order, only: check_order
   use accuracy_ledger, only: check_ledger
   implicit none

   type(check_t) :: check
   character(len=40) :: name, text
   integer :: number

   call get_command_argument(1, name)
   call get_command_argument(2, text)
   number = 0
   if (len_trim(text) > 0) read (text, '(i10)') number
   select case (name)
   case ('order')
      call check_order(check, number)
   case ('ledger')
      call check_ledger(check)
   case default
      call say('there is no test '//name)
   end select
   call quit(check)
end program accuracy_main
