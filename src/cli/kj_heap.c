/* Memory of the program in large pages, where the system has them. A run of one joint touches 700 pages of
   4 KB, most of them by HDF5, and the first touch of each costs more than a microsecond. */
#define _DEFAULT_SOURCE
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* The heap begins anew a little below a large page, so that nothing of it is touched before it is asked for
   in one piece, and keeps what is freed. Called first of all. */
void kj_large_pages(void)
{
#if defined __GLIBC__ && defined MADV_HUGEPAGE
   enum { PAGE = 2*1024*1024, ROOM = 4*PAGE, BELOW = 65536 };
   uintptr_t end = (uintptr_t)sbrk(0), first = (end + BELOW + PAGE - 1)/PAGE*PAGE;
   void *whole;

   mallopt(M_MMAP_THRESHOLD, ROOM + PAGE);
   mallopt(M_TRIM_THRESHOLD, 2*ROOM);
   if (sbrk((intptr_t)(first - BELOW - end)) == (void *)-1) return;
   whole = malloc(BELOW + ROOM);
   if (whole) madvise((void *)first, ROOM, MADV_HUGEPAGE);
   free(whole);
#endif
}
