/* Memory on huge pages, see kj_huge_pages.c */
#ifndef KJ_HUGE_PAGES_H
#define KJ_HUGE_PAGES_H
#include <stddef.h>

/* `bytes` to be given back by free, NULL when there is no memory; on huge pages if it fills one, where
   the system has them */
void *kj_huge_room(size_t bytes);

/* Put the `n` numbers of an array, and what shares a huge page with them, on huge pages now, as far as
   the system can */
void kj_huge_reals(const double *array, size_t n);
void kj_huge_integers(const int *array, size_t n);

#endif
