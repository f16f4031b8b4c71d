!> The program kjoint. Everything is in kj_cli.
program kjoint_main
   use kj_cli, only: run_cli
   use kj_terminal, only: open_streams, quit
   implicit none

   integer :: code

   call open_streams()
   call run_cli(code)
   call quit(code)
end program kjoint_main
