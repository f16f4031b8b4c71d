/* A history file under way, see kj_store.c */
#ifndef KJ_STORE_H
#define KJ_STORE_H
#include <stddef.h>
#include <stdint.h>

typedef struct kj_store kj_store;

/* Write chunk number `block` over time, number `part` over the entities, of a series, all from 0:
   `n` bytes, packed; plain: without the first filter of the series. It counts when the rows are committed, and may be written again before it is
   full. Negative when it fails. */
int kj_store_chunk(kj_store *o, size_t series, size_t block, size_t part, int plain,
   size_t n, const unsigned char *packed);
#endif
