/* All columns of the rows of a history, packed and written chunk by chunk: at once, or by a thread of
   its own while the caller fills the other of two buffers and leaves the file alone. Everything that the
   thread touches lies in the packer and the store: whoever forgets to free them leaks them, but the thread
   reads nothing that is gone. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include "kj_chunk.h"
#include "kj_store.h"

/* Bytes of rows at the start of a history that are written as they are: packing them takes several times the
   work of sampling them, and saves 15 to 45 % */
enum { PLAIN = 4*1024*1024 };

/* Values of a row that go to one chunk */
typedef struct {
   size_t series, part;                      /* the dataset, which chunk of a row, from 0 */
   size_t first, n, n_full;                  /* from 0; values that there are, that a chunk has */
   int real, size;                           /* stored: as a real, bytes */
} kj_column;

typedef struct {
   int exact;                                /* equal rows are equal bytes */
   size_t n_value, rows_full, n_column;      /* values in a row, rows in a chunk */
   kj_column *column;
   unsigned char *packed, *work;             /* a chunk, and room to pack it */
   double *rows[2];                          /* the buffers */
   int filling;                              /* which of them */
   int full;                                 /* the other is full, and not known to be written */
   int running;                              /* there is a thread */
   size_t before;                            /* rows before the full buffer */
   int status;                               /* of writing it */
   kj_store *store;                          /* the file */
   pthread_t thread;
} kj_packer;

static void join(kj_packer *p)
{
   if (p->running) pthread_join(p->thread, NULL);
   p->running = 0;
}

void kj_packer_free(kj_packer *p)
{
   if (!p) return;
   join(p);
   free(p->column);
   free(p->packed);
   free(p->work);
   free(p->rows[0]);
   free(p->rows[1]);
   free(p);
}

/* Two buffers of `rows_full` rows and room for a chunk; NULL when there is no memory */
kj_packer *kj_packer_new(kj_store *store, int exact, size_t n_value, size_t rows_full, size_t n_column,
   const kj_column *column)
{
   kj_packer *p = calloc(1, sizeof *p);
   size_t i, most = 0;

   if (!p) return NULL;
   for (i = 0; i < n_column; i++) {
      size_t bytes = column[i].n_full*rows_full*(size_t)column[i].size;
      if (bytes > most) most = bytes;
   }
   p->store = store;
   p->exact = exact;
   p->n_value = n_value;
   p->rows_full = rows_full;
   p->n_column = n_column;
   p->column = malloc((n_column + 1)*sizeof *p->column);
   p->packed = malloc(kj_chunk_bound(most));
   p->work = malloc(kj_chunk_work(most));
   p->rows[0] = malloc(n_value*rows_full*sizeof(double) + 1);
   p->rows[1] = malloc(n_value*rows_full*sizeof(double) + 1);
   if (!p->column || !p->packed || !p->work || !p->rows[0] || !p->rows[1]) {
      kj_packer_free(p);
      return NULL;
   }
   memcpy(p->column, column, n_column*sizeof *column);
   return p;
}

/* The buffer to be filled */
double *kj_packer_rows(kj_packer *p)
{
   return p->rows[p->filling];
}

/* Pack and write the first `n` rows of a buffer, which follow `before`. Negative when it fails. */
static int write_rows(kj_packer *p, size_t before, size_t n, const double *rows)
{
   int plain = before*p->n_value*sizeof(double) < PLAIN;
   size_t i;

   for (i = 0; i < p->n_column; i++) {
      const kj_column *c = &p->column[i];
      size_t bytes = kj_pack_chunk(plain, p->exact, c->real, c->size, c->n, c->n_full, n, p->rows_full,
         rows + c->first, p->n_value, p->work, p->packed);
      if (bytes == 0 ||
         kj_store_chunk(p->store, c->series, before/p->rows_full, c->part, plain, bytes,
            p->packed) < 0) return -1;
   }
   return 0;
}

/* The same of the buffer that is filled; kj_packer_end came before */
int kj_packer_write(kj_packer *p, size_t before, size_t n)
{
   return write_rows(p, before, n, p->rows[p->filling]);
}

static void *write_full(void *packer)
{
   kj_packer *p = packer;

   p->status = write_rows(p, p->before, p->rows_full, p->rows[!p->filling]);
   return NULL;
}

/* The buffer is full, of rows after `before`: write it in the background, fill the other. kj_packer_end
   came before. The thread takes no signals: they are for threads of the host. Where none can be made,
   the caller writes. */
void kj_packer_begin(kj_packer *p, size_t before)
{
   sigset_t all, signals;

   p->filling = !p->filling;
   p->full = 1;
   p->before = before;
   sigfillset(&all);
   pthread_sigmask(SIG_SETMASK, &all, &signals);
   p->running = pthread_create(&p->thread, NULL, write_full, p) == 0;
   pthread_sigmask(SIG_SETMASK, &signals, NULL);
   if (!p->running) write_full(p);
}

/* Wait until the full buffer is packed and written, if there is one. Negative when it could not be. */
int kj_packer_end(kj_packer *p)
{
   if (!p->full) return 0;
   join(p);
   p->full = 0;
   return p->status;
}
