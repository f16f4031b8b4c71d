/* Memory on huge pages; in C because Fortran cannot ask the system. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include "kj_huge_pages.h"

#define HUGE_PAGE ((size_t)2*1024*1024)

#if defined(__linux__) && !defined(MADV_COLLAPSE)
#define MADV_COLLAPSE 25                     /* Linux 6.1 */
#endif

void *kj_huge_room(size_t bytes)
{
#ifdef MADV_HUGEPAGE
   void *room;

   if (bytes >= HUGE_PAGE) {
      bytes = (bytes + HUGE_PAGE - 1)/HUGE_PAGE*HUGE_PAGE;
      if (posix_memalign(&room, HUGE_PAGE, bytes) != 0) return NULL;
      madvise(room, bytes, MADV_HUGEPAGE);
      return room;
   }
#endif
   return malloc(bytes + 1);
}

/* What is not all of one mapping stays as it is */
static void collapse(const void *at, size_t bytes)
{
#ifdef MADV_COLLAPSE
   uintptr_t page = (uintptr_t)at/HUGE_PAGE*HUGE_PAGE, end = (uintptr_t)at + bytes;

   for (; page < end; page += HUGE_PAGE)
      if (madvise((void *)page, HUGE_PAGE, MADV_COLLAPSE) != 0 && errno == EAGAIN) return;
#else
   (void)at;
   (void)bytes;
#endif
}

void kj_huge_reals(const double *array, size_t n)
{
   collapse(array, n*sizeof *array);
}

void kj_huge_integers(const int *array, size_t n)
{
   collapse(array, n*sizeof *array);
}
