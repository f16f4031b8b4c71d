!> The program kjoint. Everything is in kj_cli.
program kjoint_main
   use kj_cli, only: run_cli
   use kj_terminal, only: open_streams, quit
   implicit none

   interface
      subroutine kj_large_pages() bind(c)        ! kj_heap.c
      end subroutine kj_large_pages
   end interface
   integer :: code

   call kj_large_pages()
   call open_streams()
   call run_cli(code)
   call quit(code)
end program kjoint_main
