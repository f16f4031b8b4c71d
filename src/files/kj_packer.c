/* All columns of the rows of a history, packed and written chunk by chunk: at once, or by a thread of
   its own while the caller fills the other of two buffers and leaves the file alone. Everything that the
   thread touches lies in the packer and the store: whoever forgets to free them leaks them, but the thread
   reads nothing that is gone. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include "kj_chunk.h"
#include "kj_store.h"

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
   unsigned char **packed;                   /* of each column; those of a group stand together */
   size_t *length;                           /* bytes packed, 0 = failed */
   unsigned char *work, *room;
   size_t n_work;                            /* bytes to work with, for each thread */
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
   free(p->length);
   free(p->work);
   free(p->room);
   free(p->rows[0]);
   free(p->rows[1]);
   free(p);
}

/* Room for the columns of a group at the same time, and for `threads` that pack; with two buffers of
   `rows_full` rows, or none where each row is a chunk. NULL when there is no memory. */
kj_packer *kj_packer_new(kj_store *store, int exact, size_t n_value, size_t rows_full, size_t group,
   size_t threads, size_t n_column, const kj_column *column)
{
   kj_packer *p = calloc(1, sizeof *p);
   size_t i, most = 0, used = 0, room = 0, held = rows_full > 1 ? n_value*rows_full : 0;

   if (!p) return NULL;
   p->store = store;
   p->exact = exact;
   p->n_value = n_value;
   p->rows_full = rows_full;
   p->n_column = n_column;
   p->column = calloc(n_column + 1, sizeof *p->column);
   p->packed = calloc(n_column + 1, sizeof *p->packed);
   p->length = calloc(n_column + 1, sizeof *p->length);
   p->rows[0] = malloc(held*sizeof(double) + 1);
   p->rows[1] = malloc(held*sizeof(double) + 1);
   for (i = 0; i < n_column; i++) {
      size_t bytes = column[i].n_full*rows_full*(size_t)column[i].size;
      if (i % group == 0) used = 0;
      used += kj_chunk_bound(bytes);
      if (used > room) room = used;
      if (bytes > most) most = bytes;
   }
   p->n_work = kj_chunk_work(most);
   p->work = malloc(threads*p->n_work);
   p->room = malloc(room + 1);
   if (!p->column || !p->packed || !p->length || !p->rows[0] || !p->rows[1] || !p->work ||
      !p->room) {
      kj_packer_free(p);
      return NULL;
   }
   for (i = 0; i < n_column; i++) {
      p->column[i] = column[i];
      p->packed[i] = p->room;
      if (i % group > 0) p->packed[i] = p->packed[i - 1] + kj_chunk_bound(
         column[i - 1].n_full*rows_full*(size_t)column[i - 1].size);
   }
   return p;
}

/* The buffer to be filled */
double *kj_packer_rows(kj_packer *p)
{
   return p->rows[p->filling];
}

/* Pack `n` rows of column `i`, by thread `thread`, all from 0 */
void kj_packer_column(kj_packer *p, size_t i, size_t thread, size_t n, const double *rows)
{
   const kj_column *c = &p->column[i];

   p->length[i] = kj_pack_chunk(p->exact, c->real, c->size, c->n, c->n_full, n, p->rows_full,
      rows + c->first, p->n_value, p->work + thread*p->n_work, p->packed[i]);
}

/* Write column `i` as it was packed last, of rows after `before`. Negative when it fails. */
int kj_packer_write(const kj_packer *p, size_t i, size_t before)
{
   const kj_column *c = &p->column[i];

   if (p->length[i] == 0) return -1;
   return kj_store_chunk(p->store, c->series, before/p->rows_full, c->part, p->length[i], p->packed[i]);
}

/* Pack the buffer that is full, and write it */
static void *pack_full(void *packer)
{
   kj_packer *p = packer;
   size_t i;

   p->status = 0;
   for (i = 0; i < p->n_column && p->status >= 0; i++) {
      kj_packer_column(p, i, 0, p->rows_full, p->rows[!p->filling]);
      p->status = kj_packer_write(p, i, p->before);
   }
   return NULL;
}

/* The buffer is full, of rows after `before`: pack it in the background, fill the other.
   kj_packer_end came before.
   The thread takes no signals: they are for threads of the host. Where none can be made, the caller
   packs. */
void kj_packer_begin(kj_packer *p, size_t before)
{
   sigset_t all, signals;

   p->filling = !p->filling;
   p->full = 1;
   p->before = before;
   sigfillset(&all);
   pthread_sigmask(SIG_SETMASK, &all, &signals);
   p->running = pthread_create(&p->thread, NULL, pack_full, p) == 0;
   pthread_sigmask(SIG_SETMASK, &signals, NULL);
   if (!p->running) pack_full(p);
}

/* Wait until the full buffer is packed and written, if there is one. Negative when it could not be. */
int kj_packer_end(kj_packer *p)
{
   if (!p->full) return 0;
   join(p);
   p->full = 0;
   return p->status;
}
