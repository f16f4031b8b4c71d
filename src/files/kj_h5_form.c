/* The few parts of HDF5's file format that a history needs while it grows: superblock, messages of object
   headers, checksum, heap of texts. The format is that of "HDF5 File Format Specification 3.0", of which
   only what HDF5 writes for a history is known here; anything else is refused. */
#include <string.h>
#include "kj_h5_form.h"

enum { CONTINUATION = 16, MOST_PARTS = 64, SUM = 4,
   HEAD = 6 };              /* of a message, where the order of attributes is kept: always here */

/* A part of an object header: its messages, and where the checksum of [start, last) stands */
typedef struct { size_t start, first, last; } part;

uint64_t kj_get(const unsigned char *p, int bytes)
{
   uint64_t value = 0;
   while (bytes-- > 0) value = value << 8 | p[bytes];
   return value;
}

void kj_put(unsigned char *p, int bytes, uint64_t value)
{
   int i;
   for (i = 0; i < bytes; i++) p[i] = (unsigned char)(value >> 8*i);
}

static uint32_t turn(uint32_t x, int k)
{
   return x << k | x >> (32 - k);
}

/* The checksum of HDF5's metadata: lookup3 of Bob Jenkins, in the public domain */
static uint32_t checksum(size_t n, const unsigned char *p)
{
   uint32_t a = 0xdeadbeef + (uint32_t)n, b = a, c = a;
   unsigned char rest[12] = {0};

   for (; n > 12; n -= 12, p += 12) {
      a += (uint32_t)kj_get(p, 4);
      b += (uint32_t)kj_get(p + 4, 4);
      c += (uint32_t)kj_get(p + 8, 4);
      a -= c; a ^= turn(c, 4);  c += b;
      b -= a; b ^= turn(a, 6);  a += c;
      c -= b; c ^= turn(b, 8);  b += a;
      a -= c; a ^= turn(c, 16); c += b;
      b -= a; b ^= turn(a, 19); a += c;
      c -= b; c ^= turn(b, 4);  b += a;
   }
   if (n == 0) return c;
   memcpy(rest, p, n);
   a += (uint32_t)kj_get(rest, 4);
   b += (uint32_t)kj_get(rest + 4, 4);
   c += (uint32_t)kj_get(rest + 8, 4);
   c ^= b; c -= turn(b, 14);
   a ^= c; a -= turn(c, 11);
   b ^= a; b -= turn(a, 25);
   c ^= b; c -= turn(b, 16);
   a ^= c; a -= turn(c, 4);
   b ^= a; b -= turn(a, 14);
   c ^= b; c -= turn(b, 24);
   return c;
}

void kj_seal(unsigned char *block, size_t n)
{
   kj_put(block + n - SUM, SUM, checksum(n - SUM, block));
}

size_t kj_super_size(const unsigned char *super)
{
   return super[8] == 0 ? 96 : super[8] == 1 ? 100 : 48;
}

/* Where a superblock says the end */
static size_t end_place(const unsigned char *super)
{
   return super[8] == 0 ? 40 : super[8] == 1 ? 44 : 28;
}

uint64_t kj_get_end(const unsigned char *super)
{
   return kj_get(super + end_place(super), 8);
}

void kj_put_end(unsigned char *super, uint64_t end)
{
   kj_put(super + end_place(super), 8, end);
   if (super[8] >= 2) kj_seal(super, 48);
}

void kj_super_live(unsigned char *super)
{
   if (super[8] != 2) return;
   super[8] = 3;
   super[11] = 0;                            /* not marked as open, so that other readers open it, too */
   kj_seal(super, 48);
}

/* The first part of the object header; 0: it is none that is known */
static int first_part(const unsigned char *image, size_t n, uint64_t header, part *p)
{
   size_t at = (size_t)header + 6;
   int width;

   if (header > n || n - header < 64 || memcmp(image + header, "OHDR\2", 5)) return 0;
   if (!(image[header + 5] & 4)) return 0;
   if (image[header + 5] & 32) at += 16;
   if (image[header + 5] & 16) at += 4;
   width = 1 << (image[header + 5] & 3);
   p->start = (size_t)header;
   p->first = at + (size_t)width;
   p->last = p->first + (size_t)kj_get(image + at, width);
   return p->last + SUM <= n;
}

/* The message at `at` of a part that ends at `last`; 0: none */
static int read_message(unsigned char *bytes, size_t at, size_t last, kj_message *m)
{
   if (at + HEAD > last) return 0;
   m->head = bytes + at;
   m->body = m->head + HEAD;
   m->type = m->head[0];
   m->size = (size_t)kj_get(m->head + 1, 2);
   return at + HEAD + m->size <= last;
}

/* Take the messages that are wanted out of a part of a header, and put them into the block behind its
   `size` bytes; those that stay move up. Returns where they end, which is p->last where none was taken;
   0: no room. */
static size_t take_messages(unsigned char *image, const part *p, int (*wanted)(const kj_message *),
   unsigned char *block, size_t *size, size_t room)
{
   size_t at, n, stay = p->first, before = *size;
   kj_message m;

   for (at = p->first; read_message(image, at, p->last, &m); at += n) {
      n = HEAD + m.size;
      if (!wanted(&m)) continue;
      if (*size + n + SUM > room) return 0;
      memcpy(block + *size, m.head, n);
      *size += n;
   }
   if (*size == before) return p->last;
   for (at = p->first; read_message(image, at, p->last, &m); at += n) {
      n = HEAD + m.size;
      if (wanted(&m) || m.type == KJ_NIL) continue;
      memmove(image + stay, m.head, n);
      stay += n;
   }
   return stay;
}

static size_t put_message(unsigned char *image, size_t at, int type, size_t size)
{
   memset(image + at, 0, HEAD + size);
   image[at] = (unsigned char)type;
   kj_put(image + at + 1, 2, size);
   return at + HEAD;
}

size_t kj_move_messages(unsigned char *image, size_t n, uint64_t header,
   int (*wanted)(const kj_message *), uint64_t *address, unsigned char *block, size_t room)
{
   part parts[MOST_PARTS];
   size_t stay[MOST_PARTS], at, size = 4;
   kj_message m;
   int n_part = 1, i, lead = -1;

   if (!first_part(image, n, header, &parts[0])) return 0;
   for (i = 0; i < n_part; i++) {
      for (at = parts[i].first; read_message(image, at, parts[i].last, &m); at += HEAD + m.size) {
         uint64_t o, l;
         if (m.type != CONTINUATION || m.size < 16) continue;
         o = kj_get(m.body, 8);
         l = kj_get(m.body + 8, 8);
         if (n_part == MOST_PARTS || l < 8 || o > n || l > n - o || memcmp(image + o, "OCHK", 4)) return 0;
         parts[n_part++] = (part){(size_t)o, (size_t)o + 4, (size_t)(o + l) - SUM};
      }
      stay[i] = take_messages(image, &parts[i], wanted, block, &size, room);
      if (stay[i] == 0) return 0;
      if (lead < 0 && parts[i].last - stay[i] >= HEAD + 16) lead = i;
   }
   if (lead < 0) return 0;
   size += SUM;
   if (*address % KJ_PAGE + size > KJ_PAGE) *address += KJ_PAGE - *address % KJ_PAGE;
   memcpy(block, "OCHK", 4);
   kj_seal(block, size);
   at = put_message(image, stay[lead], CONTINUATION, 16);
   kj_put(image + at, 8, *address);
   kj_put(image + at + 8, 8, size);
   stay[lead] = at + 16;
   for (i = 0; i < n_part; i++) {
      size_t rest = parts[i].last - stay[i];
      memset(image + stay[i], 0, rest);
      if (rest >= HEAD) put_message(image, stay[i], KJ_NIL, rest - HEAD);
      kj_seal(image + parts[i].start, parts[i].last + SUM - parts[i].start);
   }
   return size;
}

int kj_next_message(unsigned char *block, size_t n, const kj_message *before, kj_message *message)
{
   size_t at = before ? (size_t)(before->body - block) + before->size : 4;
   return read_message(block, at, n - SUM, message);
}

const char *kj_attribute_name(const kj_message *m)
{
   return (const char *)m->body + (m->body[0] == 3 ? 9 : 8);
}

unsigned char *kj_attribute_value(const kj_message *m, size_t bytes)
{
   return m->body + m->size - bytes;
}

/* Put a text into a heap; returns where the next may stand */
static size_t put_text(unsigned char *heap, size_t at, int number, const char *text)
{
   size_t n = strlen(text);

   if (n > KJ_MOST_TEXT) n = KJ_MOST_TEXT;
   kj_put(heap + at, 2, (uint64_t)number);
   kj_put(heap + at + 8, 8, n);
   memcpy(heap + at + 16, text, n);
   return at + 16 + (n + 7)/8*8;
}

void kj_make_heap(unsigned char *heap, const char *first, const char *second)
{
   size_t at;

   memset(heap, 0, KJ_HEAP);
   memcpy(heap, "GCOL\1", 5);
   kj_put(heap + 8, 8, KJ_HEAP);
   at = put_text(heap, 16, 1, first);
   at = put_text(heap, at, 2, second);
   kj_put(heap + at + 8, 8, KJ_HEAP - at);
}
