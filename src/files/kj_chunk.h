/* One chunk of a history, see kj_chunk.c */
#ifndef KJ_CHUNK_H
#define KJ_CHUNK_H
#include <stddef.h>

/* Bytes that a packed chunk of `bytes` may take at most */
size_t kj_chunk_bound(size_t bytes);

/* Bytes that kj_pack_chunk needs to work with */
size_t kj_chunk_work(size_t bytes);

/* Pack a chunk of `rows_full` rows of `n_full` values of `size` bytes (real: 8 bytes as they are;
   exact: equal rows are equal bytes; plain: not shuffled, nor made smaller). Given are `rows` rows of `n` values, each `stride` after the
   one before; the others are 0.
   work: kj_chunk_work bytes, packed: kj_chunk_bound bytes. Returns the bytes packed, 0 on failure. */
size_t kj_pack_chunk(int plain, int exact, int real, int size, size_t n, size_t n_full, size_t rows,
   size_t rows_full, const double *values, size_t stride, unsigned char *work,
   unsigned char *packed);

#endif
