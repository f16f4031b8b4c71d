!> Accuracy tests: `accuracy_tests NAME [NUMBER]`, decks are written into the current folder.
program accuracy_main
   use accuracy_check, only: check_t, say, quit
   use accuracy_order, only: check_order, check_driven
   use accuracy_ledger, only: check_ledger, check_momentum, check_cycles
   use accuracy_extremes, only: check_masses, check_stiffnesses, check_lengths, check_far, &
      check_coincident, check_opposite, check_turns, check_whole_turn, check_falling, &
      check_weightless, check_loose, check_first_step
   use accuracy_bodies, only: check_free, check_top
   use accuracy_limits, only: check_limit, check_four_bar
   implicit none

   type(check_t) :: check
   character(len=200) :: name, text, case
   integer :: number

   call get_command_argument(1, name)
   call get_command_argument(2, text)
   number = 0
   if (verify(trim(text), '0123456789') == 0) read (text, '(i10)') number
   select case (name)
   case ('order')
      call get_command_argument(3, case)
      call check_order(check, number, trim(case))
   case ('driven')
      call get_command_argument(3, case)
      call check_driven(check, number, trim(case))
   case ('ledger')
      call check_ledger(check)
   case ('momentum')
      call check_momentum(check)
   case ('cycles')
      call check_cycles(check, number)
   case ('masses')
      call check_masses(check)
   case ('stiffnesses')
      call check_stiffnesses(check)
   case ('lengths')
      call check_lengths(check)
   case ('far')
      call check_far(check)
   case ('coincident')
      call check_coincident(check)
   case ('opposite')
      call check_opposite(check)
   case ('turns')
      call check_turns(check)
   case ('falling')
      call check_falling(check)
   case ('weightless')
      call check_weightless(check)
   case ('whole_turn')
      call check_whole_turn(check)
   case ('loose')
      call check_loose(check)
   case ('first_step')
      call check_first_step(check)
   case ('free')
      call check_free(check, number)
   case ('top')
      call check_top(check, trim(text))
   case ('limit')
      call get_command_argument(3, case)
      call check_limit(check, trim(text), trim(case))
   case ('four_bar')
      call check_four_bar(check, number)
   case default
      call say('there is no test '//name)
   end select
   call quit(check)
end program accuracy_main
