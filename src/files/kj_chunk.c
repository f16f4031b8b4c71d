/* One chunk of a history: its rows out of the buffer, shuffled and deflated as HDF5's own filters
   would leave them, several times faster. What a reader gets is the same.

   A plain chunk takes a tenth of the work: it is not shuffled, and deflate puts its rows into stored
   blocks, as they are. Rows of a chunk that are still to come are zeros, which are deflated in either.

   Shuffled, byte k of all values stands together: the low bytes of measured numbers are noise,
   which deflate would search in vain. They go into stored blocks; the rest is deflated by ISA-L
   (KJOINT_ISAL), 7 times as fast as zlib, or by zlib. What ISA-L writes now and then hangs
   on what was in memory before, so reproducible histories are left to zlib. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#ifdef KJOINT_ISAL
#include <isa-l/igzip_lib.h>
#endif
#include <zlib.h>
#include "kj_chunk.h"

enum { SAMPLE = 4096, MOST_STORED = 65535, SLACK = 1024, SMALL = 32768 };

size_t kj_chunk_bound(size_t bytes)
{
   return bytes + bytes/8 + SLACK;
}

size_t kj_chunk_work(size_t bytes)
{
#ifdef KJOINT_ISAL
   return bytes + SLACK + sizeof(struct isal_zstream) + ISAL_DEF_LVL1_DEFAULT;
#else
   return bytes;
#endif
}

/* Exchange the bits `mask` of *high with those of *low that stand `shift` further up */
static void exchange(uint64_t *low, uint64_t *high, int shift, uint64_t mask)
{
   uint64_t t = ((*low >> shift) ^ *high) & mask;
   *high ^= t;
   *low ^= t << shift;
}

/* Byte k of value i to out[k*plane + i*step]: as it is, or eight values at a time, as a matrix that is
   transposed */
static void put_reals(size_t n, const double *x, size_t plane, size_t step, unsigned char *out)
{
   uint64_t v[8];
   size_t i = 0;
   int k;

#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
   if (plane == 1) {
      memcpy(out, x, 8*n);
      return;
   }
   for (; i + 8 <= n; i += 8) {
      memcpy(v, x + i, sizeof v);
      for (k = 0; k < 8; k += 2) exchange(&v[k], &v[k + 1], 8, 0x00ff00ff00ff00ffu);
      for (k = 0; k < 8; k++)
         if ((k & 2) == 0) exchange(&v[k], &v[k + 2], 16, 0x0000ffff0000ffffu);
      for (k = 0; k < 4; k++) exchange(&v[k], &v[k + 4], 32, 0x00000000ffffffffu);
      for (k = 0; k < 8; k++) memcpy(out + k*plane + i, &v[k], 8);
   }
#endif
   for (; i < n; i++) {
      memcpy(v, x + i, 8);
      for (k = 0; k < 8; k++) out[k*plane + i*step] = (unsigned char)(v[0] >> 8*k);
   }
}

/* The same of values that the file holds as integers of `size` bytes; what is no number is 0 */
static void put_integers(int size, size_t n, const double *x, size_t plane, size_t step,
   unsigned char *out)
{
   const double most = size == 1 ? 127.0 : size == 4 ? 2147483647.0 : 9007199254740992.0;
   size_t i;
   int k;

   for (i = 0; i < n; i++) {
      double y = x[i] > most ? most : x[i] < -most ? -most : x[i];
      uint64_t bits = (uint64_t)(y == y ? (int64_t)y : 0);
      for (k = 0; k < size; k++) out[k*plane + i*step] = (unsigned char)(bits >> 8*k);
   }
}

/* Would deflate gain little on this plane? Judged by a sample: bytes as frequent as in noise, and
   not those of the row before. */
static int is_noise(size_t plane, size_t row, const unsigned char *p)
{
   uint32_t count[4][256] = {{0}};
   size_t n = plane < SAMPLE ? plane & ~(size_t)3 : SAMPLE, i, k, equal = 0;
   double squares = 0.0, m = (double)n;

   if (n < 256) return 0;
   p += (plane - n)/2;
   for (i = 0; i < n; i += 4)
      for (k = 0; k < 4; k++) count[k][p[i + k]]++;
   for (k = 0; k < 256; k++) {
      double c = count[0][k] + count[1][k] + count[2][k] + count[3][k];
      squares += c*c;
   }
   if (squares > 1.25*m*m/256.0 + m) return 0;
   if (row + n > (plane + n)/2) return 1;
   for (i = 0; i < n; i++) equal += p[i] == p[i + row];
   return equal < n/16;
}

/* Deflate by zlib to the end of a stream without header; 0 when it fails */
static size_t deflate_exactly(size_t n, unsigned char *in, size_t room, unsigned char *out)
{
   z_stream s = {0};
   size_t made = 0;

   if (deflateInit2(&s, 1, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK) return 0;
   s.next_in = in;
   s.avail_in = (uInt)n;
   s.next_out = out;
   s.avail_out = (uInt)room;
   if (deflate(&s, Z_FINISH) == Z_STREAM_END) made = s.total_out;
   deflateEnd(&s);
   return made;
}

#ifdef KJOINT_ISAL
/* The same by ISA-L, with `work` to work in. Making codes, as level 1 does, takes longer than packing few
   bytes */
static size_t deflate_fast(int level, size_t n, unsigned char *in, size_t room, unsigned char *out,
   unsigned char *work)
{
   struct isal_zstream *z = (struct isal_zstream *)(((uintptr_t)work + SLACK - 64 + 63)/64*64);

   isal_deflate_stateless_init(z);
   z->level = n < SMALL ? 0 : (uint32_t)level;
   z->level_buf = (uint8_t *)(z + 1);
   z->level_buf_size = ISAL_DEF_LVL1_DEFAULT;
   z->gzip_flag = IGZIP_DEFLATE;
   z->end_of_stream = 1;
   z->next_in = in;
   z->avail_in = (uint32_t)n;
   z->next_out = out;
   z->avail_out = (uint32_t)room;
   return isal_deflate_stateless(z) == COMP_OK ? z->total_out : 0;
}
#endif

static uint32_t checksum(size_t n, const unsigned char *p)
{
#ifdef KJOINT_ISAL
   return isal_adler32(1, p, n);
#else
   return (uint32_t)adler32(1, p, (uInt)n);
#endif
}

size_t kj_pack_chunk(int plain, int exact, int real, int size, size_t n, size_t n_full, size_t rows,
   size_t rows_full, const double *values, size_t stride, unsigned char *work,
   unsigned char *packed)
{
   const size_t count = n_full*rows_full, bytes = count*(size_t)size;
   const size_t plane = plain ? 1 : count, step = plain ? (size_t)size : 1;
   unsigned char *in = work, *out = packed;
   size_t row, left, made, room;
   uint32_t sum;
   int k = 0;

   if (n < n_full || rows < rows_full) memset(work, 0, bytes);
   for (row = 0; row < rows; row++) {
      unsigned char *to = work + row*n_full*step;
      if (real)
         put_reals(n, values + row*stride, plane, step, to);
      else
         put_integers(size, n, values + row*stride, plane, step, to);
   }
   *out++ = 0x78;                            /* zlib: window of 32 KiB, fastest */
   *out++ = 0x01;
   while (!plain && k < size - 1 && is_noise(plane, n_full, work + k*plane)) k++;
   for (left = plain ? n_full*rows*(size_t)size : k*plane; left > 0; left -= made) {
      made = left < MOST_STORED ? left : MOST_STORED;
      *out++ = in + made == work + bytes;    /* a stored block: the last? */
      *out++ = (unsigned char)made;
      *out++ = (unsigned char)(made >> 8);
      *out++ = (unsigned char)~made;
      *out++ = (unsigned char)(~made >> 8);
      memcpy(out, in, made);
      in += made;
      out += made;
   }
   left = (size_t)(work + bytes - in);
   room = kj_chunk_bound(bytes) - (size_t)(out - packed) - 4;
   made = 0;
#ifdef KJOINT_ISAL
   if (!exact && left > 0) made = deflate_fast(plain ? 0 : 1, left, in, room, out, work + bytes);
#else
   (void)exact;
#endif
   if (made == 0 && left > 0) made = deflate_exactly(left, in, room, out);
   if (made == 0 && left > 0) return 0;
   out += made;
   sum = checksum(bytes, work);
   for (k = 24; k >= 0; k -= 8) *out++ = (unsigned char)(sum >> k);
   return (size_t)(out - packed);
}
