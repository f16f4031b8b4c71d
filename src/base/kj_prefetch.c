/* Asks for memory before it is read; in C because Fortran has no word for it. */
#include <stddef.h>

#define LINE 64

/* A line into the second cache. Where the compiler has no word for it: nothing. */
static void ask(const char *at)
{
#if defined(__GNUC__)
   __builtin_prefetch(at, 0, 2);
#else
   (void)at;
#endif
}

/* `bytes` of each column, without a line that they begin within: whoever comes block by block has
   asked for that one with the block before. */
static void prefetch(const char *from, size_t column_bytes, size_t columns, size_t bytes)
{
   size_t k, at;

   for (k = 0; k < columns; k++, from += column_bytes)
      for (at = (LINE - (size_t)from % LINE) % LINE; at < bytes; at += LINE) ask(from + at);
}

/* Rows from..from + n - 1 (from 1) of an array of Fortran */
void kj_prefetch_reals(const double *array, size_t rows, size_t columns, size_t from, size_t n)
{
   prefetch((const char *)(array + from - 1), rows*sizeof *array, columns, n*sizeof *array);
}

void kj_prefetch_integers(const int *array, size_t rows, size_t columns, size_t from, size_t n)
{
   prefetch((const char *)(array + from - 1), rows*sizeof *array, columns, n*sizeof *array);
}
