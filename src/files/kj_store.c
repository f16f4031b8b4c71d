/* A history file under way. HDF5 makes it, with every dataset and no row, in memory; from then on it is
   written here, so that a process that is killed between any two of its writes leaves a file that every
   HDF5 reads:

   - A chunk goes where nothing that counts stands. Room of a chunk that was written again is used after
     QUARANTINE more commits, so that readers have time, too.
   - The index of a dataset (a B-tree of version 1) only grows: a node lies within a page of the disk, and
     one write puts the entries that came behind those that were there. What it says beyond the length of
     the dataset nobody looks at.
   - The length of each dataset and the root of its index stand together with those of the others in a
     table of a page or a few, which is written last, that of time at the end of it.
   - The outcome of the run is prepared in that table as messages that are nothing yet.
   - The superblock tells an end of the file that lies some commits ahead, and the file has that length, with
     a hole at its end: who has read it sees what comes in the meantime, too.

   One write within one page of a file is whole or not there at all when a process is killed. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <hdf5.h>
#include "kj_h5_form.h"
#include "kj_store.h"

enum { PAGE = KJ_PAGE, FAN = 64, AHEAD = 8, QUARANTINE = 3, MOST_LEVELS = 10, NODE_HEAD = 24, LEFT = 8, RIGHT = 16,
   MOST_BLOCK = 1024 };

typedef struct { uint64_t address; int used, dirty; unsigned char *bytes; } kj_node;

typedef struct { size_t n, most; kj_node *node; } kj_level;

typedef struct {
   unsigned char *block;                     /* in the table, of n bytes */
   size_t n;
   unsigned char *rows, *root;               /* in the block: length, address of the index */
   int rank;
   uint64_t chunk[4];                        /* its shape, and the bytes of a value */
   size_t parts;                             /* chunks over the entities */
   size_t n_chunk;                           /* in the index */
   int n_level;                              /* of the index, 0: no chunk yet */
   kj_level level[MOST_LEVELS];
} kj_series;

typedef struct { uint64_t address, size; long since; } kj_hole;   /* free, after which commit */

struct kj_store {
   int file;
   uint64_t end;                             /* of the file */
   uint64_t told;                            /* of it, as the superblock says */
   uint64_t committed, most;                 /* end at the last commit, largest growth by one */
   unsigned char super[128];
   uint64_t table_at;
   unsigned char *table;                     /* of whole pages */
   size_t n_table;
   unsigned char *run;                       /* in the table: facts of the run, of n_run bytes */
   size_t n_run;
   uint64_t heap_at;                         /* of the texts of the outcome */
   size_t n_series;
   kj_series *series;
   long commits, quarantine;
   size_t n_hole, most_holes;
   kj_hole *hole;                            /* by address */
};

/* Write all of it, or -1 */
static int write_at(int file, uint64_t at, size_t n, const unsigned char *bytes)
{
   while (n > 0) {
      ssize_t done = pwrite(file, bytes, n, (off_t)at);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) return -1;
      at += (uint64_t)done;
      bytes += done;
      n -= (size_t)done;
   }
   return 0;
}

/* ---- room */

static void remove_hole(kj_store *o, size_t i)
{
   o->n_hole--;
   memmove(o->hole + i, o->hole + i + 1, (o->n_hole - i)*sizeof *o->hole);
}

/* Note room that is free after the commit `since`; without memory it is lost */
static void give_room(kj_store *o, uint64_t address, uint64_t size, long since)
{
   size_t i = o->n_hole;

   if (size == 0) return;
   if (o->n_hole == o->most_holes) {
      size_t most = 2*o->most_holes + 64;
      kj_hole *more = realloc(o->hole, most*sizeof *more);
      if (!more) return;
      o->hole = more;
      o->most_holes = most;
   }
   while (i > 0 && o->hole[i - 1].address > address) i--;
   if (i > 0 && o->hole[i - 1].since == since &&
      o->hole[i - 1].address + o->hole[i - 1].size == address) {
      o->hole[i - 1].size += size;
      return;
   }
   memmove(o->hole + i + 1, o->hole + i, (o->n_hole - i)*sizeof *o->hole);
   o->hole[i] = (kj_hole){address, size, since};
   o->n_hole++;
}

/* Join holes that are free by now */
static void join_holes(kj_store *o)
{
   size_t i = 1;

   while (i < o->n_hole) {
      kj_hole *left = &o->hole[i - 1], *right = &o->hole[i];
      if (left->address + left->size == right->address && left->since + o->quarantine <= o->commits &&
         right->since + o->quarantine <= o->commits) {
         left->size += right->size;
         remove_hole(o, i);
      } else {
         i++;
      }
   }
}

static uint64_t take_room(kj_store *o, uint64_t size)
{
   uint64_t address = o->end;
   size_t i;

   for (i = 0; i < o->n_hole; i++) {
      kj_hole *hole = &o->hole[i];
      if (hole->size < size || hole->since + o->quarantine > o->commits) continue;
      address = hole->address;
      hole->address += size;
      hole->size -= size;
      if (hole->size == 0) remove_hole(o, i);
      return address;
   }
   o->end += size;
   return address;
}

/* Room at the end of the file that no page boundary cuts */
static uint64_t take_page_room(kj_store *o, uint64_t size)
{
   uint64_t left = PAGE - o->end % PAGE;

   if (left < size) {
      give_room(o, o->end, left, -QUARANTINE);
      o->end += left;
   }
   o->end += size;
   return o->end - size;
}

/* ---- index */

static size_t key_size(const kj_series *s)
{
   return 8 + 8*((size_t)s->rank + 1);
}

static size_t node_size(const kj_series *s)
{
   return NODE_HEAD + FAN*8 + (FAN + 1)*key_size(s);
}

static unsigned char *key_of(const kj_series *s, const kj_node *node, size_t i)
{
   return node->bytes + NODE_HEAD + i*(key_size(s) + 8);
}

static int grow(kj_level *level)
{
   size_t most = 2*level->most + 1;
   kj_node *more;

   if (level->n < level->most) return 0;
   more = realloc(level->node, most*sizeof *more);
   if (!more) return -1;
   level->node = more;
   level->most = most;
   return 0;
}

static int set_entry(kj_store *o, kj_series *s, int l, size_t i, const unsigned char *key,
   uint64_t child);

/* A node at the end of level l, whose first key is `key`; it holds its room on the disk at once, so that
   a commit needs none */
static int add_node(kj_store *o, kj_series *s, int l, const unsigned char *key)
{
   kj_level *level = &s->level[l];
   size_t n = node_size(s), k = level->n;
   uint64_t end = o->end;
   kj_node node = {0};

   if (l == MOST_LEVELS - 1 || grow(level) < 0) return -1;
   node.bytes = calloc(1, n);
   if (!node.bytes) return -1;
   memcpy(node.bytes, "TREE\1", 5);
   node.bytes[5] = (unsigned char)l;
   memset(node.bytes + LEFT, 0xff, 16);
   if (k > 0) kj_put(node.bytes + LEFT, 8, level->node[k - 1].address);
   node.address = take_page_room(o, n);
   if (write_at(o->file, node.address, n, node.bytes) < 0) {
      free(node.bytes);
      o->end = end;
      return -1;
   }
   level->node[level->n++] = node;
   if (l == s->n_level) s->n_level++;
   if (k == 0) return 0;
   kj_put(level->node[k - 1].bytes + RIGHT, 8, node.address);
   memcpy(key_of(s, &level->node[k - 1], FAN), key, key_size(s));
   level->node[k - 1].dirty = 1;
   if (k == 1 && set_entry(o, s, l + 1, 0, key_of(s, &level->node[0], 0), level->node[0].address) < 0)
      return -1;
   return set_entry(o, s, l + 1, k, key, node.address);
}

/* Entry i of level l, which is there or the next one */
static int set_entry(kj_store *o, kj_series *s, int l, size_t i, const unsigned char *key,
   uint64_t child)
{
   kj_node *node;
   unsigned char *at;
   int slot = (int)(i % FAN);

   if (i/FAN == s->level[l].n && add_node(o, s, l, key) < 0) return -1;
   node = &s->level[l].node[i/FAN];
   at = key_of(s, node, (size_t)slot);
   memcpy(at, key, key_size(s));
   kj_put(at + key_size(s), 8, child);
   if (slot == node->used) kj_put(node->bytes + 6, 2, (uint64_t)++node->used);
   node->dirty = 1;
   return 0;
}

/* The key of a chunk, or one that no chunk of the file reaches */
static void make_key(const kj_series *s, size_t block, size_t part, int plain, size_t n, unsigned char *key)
{
   memset(key, 0, key_size(s));
   kj_put(key, 4, n);
   key[4] = (unsigned char)plain;            /* filters left out, a bit each */
   kj_put(key + 8, 8, block*s->chunk[0]);
   if (s->rank > 1) kj_put(key + 16, 8, part*s->chunk[1]);
}

/* The last key of each level lies beyond the last chunk */
static void put_last_keys(kj_series *s, size_t block, size_t part)
{
   unsigned char key[48];
   int l, i;

   make_key(s, block + 1, part + 1, 0, 0, key);
   for (i = 2; i <= s->rank; i++) kj_put(key + 8 + 8*i, 8, s->chunk[i]);
   if (s->rank == 1) kj_put(key + 16, 8, s->chunk[1]);
   for (l = 0; l < s->n_level; l++) {
      kj_node *last = &s->level[l].node[s->level[l].n - 1];
      memcpy(key_of(s, last, (size_t)last->used), key, key_size(s));
      last->dirty = 1;
   }
}

int kj_store_chunk(kj_store *o, size_t series, size_t block, size_t part, int plain, size_t n,
   const unsigned char *packed)
{
   kj_series *s = &o->series[series];
   size_t i = block*s->parts + part;
   unsigned char key[48], *before = NULL;
   uint64_t address, end;

   if (i > s->n_chunk) return -1;
   make_key(s, block, part, plain, n, key);
   if (i < s->n_chunk) before = key_of(s, &s->level[0].node[i/FAN], i % FAN);
   if (!before && i/FAN == s->level[0].n && add_node(o, s, 0, key) < 0) return -1;
   end = o->end;
   address = take_room(o, n);
   if (write_at(o->file, address, n, packed) < 0) {
      if (o->end > end) o->end = end;
      else give_room(o, address, n, o->commits);
      return -1;
   }
   if (before) give_room(o, kj_get(before + key_size(s), 8), kj_get(before, 4), o->commits);
   if (set_entry(o, s, 0, i, key, address) < 0) return -1;
   if (before) return 0;
   s->n_chunk++;
   put_last_keys(s, block, part);
   return 0;
}

/* ---- commits */

static int write_table(kj_store *o, unsigned char *first, unsigned char *last)
{
   size_t page = (size_t)(first - o->table)/PAGE*PAGE;

   for (; page < (size_t)(last - o->table); page += PAGE)
      if (write_at(o->file, o->table_at + page, PAGE, o->table + page) < 0) return -1;
   return 0;
}

static int write_nodes(kj_store *o, kj_series *s)
{
   int l;
   size_t k;

   for (l = 0; l < s->n_level; l++)
      for (k = s->level[l].n; k-- > 0;) {
         kj_node *node = &s->level[l].node[k];
         if (!node->dirty) continue;
         if (write_at(o->file, node->address, node_size(s), node->bytes) < 0) return -1;
         node->dirty = 0;
      }
   return 0;
}

/* Tell where the file ends, in the superblock. Negative when that fails */
static int tell_end(kj_store *o, uint64_t end)
{
   if (end == o->told) return 0;
   kj_put_end(o->super, end);
   o->told = end;
   return write_at(o->file, 0, kj_super_size(o->super), o->super);
}

/* The end that the superblock tells lies as far ahead as AHEAD commits grow, where the system lets it */
static int tell_ahead(kj_store *o)
{
   uint64_t growth = o->end - o->committed, end;

   if (growth > o->most) o->most = growth;
   o->committed = o->end;
   end = o->end + AHEAD*o->most;
   if (o->told >= o->end + AHEAD/2*o->most) return 0;
   return tell_end(o, ftruncate(o->file, (off_t)end) == 0 ? end : o->end);
}

/* From now on the file has `rows` rows. Negative when it fails; then it has those of before. */
int kj_store_commit(kj_store *o, size_t rows)
{
   size_t i;

   if (tell_ahead(o) < 0) return -1;
   for (i = 0; i < o->n_series; i++)
      if (write_nodes(o, &o->series[i]) < 0) return -1;
   for (i = 0; i < o->n_series; i++) {
      kj_series *s = &o->series[i];
      if (!s->block) continue;
      kj_put(s->rows, 8, rows);
      if (s->n_chunk > 0) kj_put(s->root, 8, s->level[s->n_level - 1].node[0].address);
      kj_seal(s->block, s->n);
   }
   if (write_table(o, o->table, o->table + o->n_table) < 0) return -1;
   o->commits++;
   join_holes(o);
   return 0;
}

static void put_text(unsigned char *value, const char *text, uint64_t heap, int number)
{
   size_t n = strlen(text);

   kj_put(value, 4, n < KJ_MOST_TEXT ? n : KJ_MOST_TEXT);
   kj_put(value + 4, 8, heap);
   kj_put(value + 12, 4, (uint64_t)number);
}

/* Tell the outcome of the run. Negative when it fails */
int kj_store_finish(kj_store *o, const char *status, const char *ended, double elapsed, int64_t cycles,
   int exit_code)
{
   unsigned char heap[KJ_HEAP];
   kj_message m;
   uint64_t bits;
   int more;

   kj_make_heap(heap, status, ended);
   if (write_at(o->file, o->heap_at, sizeof heap, heap) < 0) return -1;
   memcpy(&bits, &elapsed, 8);
   for (more = kj_next_message(o->run, o->n_run, NULL, &m); more;
      more = kj_next_message(o->run, o->n_run, &m, &m)) {
      const char *name = kj_attribute_name(&m);
      m.head[0] = KJ_ATTRIBUTE;
      if (!strcmp(name, "status")) put_text(kj_attribute_value(&m, 16), status, o->heap_at, 1);
      if (!strcmp(name, "ended")) put_text(kj_attribute_value(&m, 16), ended, o->heap_at, 2);
      if (!strcmp(name, "elapsed_s")) kj_put(kj_attribute_value(&m, 8), 8, bits);
      if (!strcmp(name, "cycles")) kj_put(kj_attribute_value(&m, 8), 8, (uint64_t)cycles);
      if (!strcmp(name, "exit_code")) kj_put(kj_attribute_value(&m, 4), 4, (uint64_t)exit_code);
   }
   kj_seal(o->run, o->n_run);
   return write_table(o, o->run, o->run + o->n_run);
}

/* ---- begin and end */

void kj_store_free(kj_store *o)
{
   size_t i, k;
   int l;

   if (!o) return;
   for (i = 0; i < o->n_series && o->series; i++)
      for (l = 0; l < MOST_LEVELS; l++) {
         for (k = 0; k < o->series[i].level[l].n; k++) free(o->series[i].level[l].node[k].bytes);
         free(o->series[i].level[l].node);
      }
   free(o->series);
   free(o->table);
   free(o->hole);
   free(o);
}

static int changes_over_time(const kj_message *m)
{
   return m->type == KJ_DATASPACE || m->type == KJ_LAYOUT;
}

static int tells_outcome(const kj_message *m)
{
   static const char *const names[] = {"status", "ended", "elapsed_s", "cycles", "exit_code"};
   size_t i;

   for (i = 0; i < 5 && m->type == KJ_ATTRIBUTE; i++)
      if (!strcmp(kj_attribute_name(m), names[i])) return 1;
   return 0;
}

/* Move messages of an object into the table, within a page of it. NULL: it is no such object. */
static unsigned char *into_table(kj_store *o, unsigned char *image, size_t n, uint64_t header,
   int (*wanted)(const kj_message *), size_t *n_block)
{
   unsigned char block[MOST_BLOCK], *place;
   uint64_t at = o->table_at + o->n_table;

   *n_block = kj_move_messages(image, n, header, wanted, &at, block, sizeof block);
   if (*n_block == 0) return NULL;
   place = memcpy(o->table + (at - o->table_at), block, *n_block);
   o->n_table = (size_t)(at - o->table_at) + *n_block;
   return place;
}

/* Find what changes over time of a dataset, and move it into the table. Negative: it is not as
   expected. */
static int find_series(kj_store *o, unsigned char *image, size_t n, uint64_t header, kj_series *s)
{
   const unsigned char *dims = NULL, *layout = NULL;
   kj_message m;
   int more, i;

   s->block = into_table(o, image, n, header, changes_over_time, &s->n);
   if (!s->block) return -1;
   for (more = kj_next_message(s->block, s->n, NULL, &m); more;
      more = kj_next_message(s->block, s->n, &m, &m)) {
      if (m.type == KJ_DATASPACE) {
         s->rank = m.body[1];
         s->rows = m.body + (m.body[0] == 1 ? 8 : 4);
         dims = s->rows;
      }
      if (m.type == KJ_LAYOUT && m.body[0] == 3 && m.body[1] == 2) layout = m.body;
   }
   if (!dims || !layout || s->rank < 1 || s->rank > 3 || layout[2] != s->rank + 1) return -1;
   s->root = s->block + (layout - s->block) + 3;
   for (i = 0; i <= s->rank; i++) s->chunk[i] = kj_get(layout + 11 + 4*i, 4);
   s->parts = 1;
   if (s->rank > 1) s->parts = (size_t)((kj_get(dims + 8, 8) + s->chunk[1] - 1)/s->chunk[1]);
   return 0;
}

/* Make the table, behind the image of the file. Negative: something is not as expected */
static int make_table(kj_store *o, unsigned char *image, size_t n, const int64_t *series, size_t time,
   int64_t run)
{
   size_t i;

   o->table_at = (n + PAGE - 1)/PAGE*PAGE;
   o->table = calloc(o->n_series + 2, PAGE);
   if (!o->table) return -1;
   o->run = into_table(o, image, n, (uint64_t)run, tells_outcome, &o->n_run);
   if (!o->run) return -1;
   for (i = 0; i < o->n_series; i++)
      if (series[i] >= 0 && i != time && find_series(o, image, n, (uint64_t)series[i], &o->series[i]) < 0)
         return -1;
   if (series[time] >= 0 && find_series(o, image, n, (uint64_t)series[time], &o->series[time]) < 0) return -1;
   o->n_table = (o->n_table + PAGE - 1)/PAGE*PAGE;
   o->heap_at = o->table_at + o->n_table;
   o->end = o->heap_at + KJ_HEAP;
   return 0;
}

/* What the outcome will be told by is nothing until then, but the status */
static void hide_outcome(kj_store *o)
{
   kj_message m;
   int more;

   for (more = kj_next_message(o->run, o->n_run, NULL, &m); more;
      more = kj_next_message(o->run, o->n_run, &m, &m))
      if (strcmp(kj_attribute_name(&m), "status")) m.head[0] = KJ_NIL;
   kj_seal(o->run, o->n_run);
}

/* Write the file that HDF5 holds in memory (core driver), complete but for its rows, to the empty `file`.
   `series`: where its datasets over time lie, -1 where there is none, number `time` that of time; `run`:
   where the group of the outcome does. live: readers may follow it (SWMR). NULL when that fails. */
kj_store *kj_store_begin(int file, hid_t h5, size_t n_series, const int64_t *series, size_t time,
   int64_t run, int live)
{
   kj_store *o = calloc(1, sizeof *o);
   unsigned char **memory = NULL, *image;
   unsigned char heap[KJ_HEAP] = {0};
   hsize_t size = 0;
   size_t n, i;
   int fine;

   if (!o) return NULL;
   o->file = file;
   o->n_series = n_series;
   o->quarantine = QUARANTINE;
   o->series = calloc(n_series + 1, sizeof *o->series);
   fine = o->series && H5Fflush(h5, H5F_SCOPE_GLOBAL) >= 0 &&
      H5Fget_vfd_handle(h5, H5P_DEFAULT, (void **)&memory) >= 0 && H5Fget_filesize(h5, &size) >= 0 &&
      memory && *memory && size > sizeof o->super;
   image = fine ? *memory : NULL;
   n = fine ? (size_t)kj_get_end(image) : 0;
   fine = fine && n <= size && make_table(o, image, n, series, time, run) == 0;
   for (i = 0; i < n_series && fine; i++)
      if (o->series[i].block) fine = add_node(o, &o->series[i], 0, NULL) == 0;
   if (fine) {
      hide_outcome(o);
      kj_put_end(image, o->end);
      o->told = o->committed = o->end;
      if (live) kj_super_live(image);
      memcpy(o->super, image, sizeof o->super);
      fine = write_at(file, o->table_at, o->n_table, o->table) == 0 &&
         write_at(file, o->heap_at, KJ_HEAP, heap) == 0 &&
         write_at(file, sizeof o->super, n - sizeof o->super, image + sizeof o->super) == 0 &&
         write_at(file, 0, sizeof o->super, image) == 0;    /* now it is one */
   }
   if (fine) return o;
   kj_store_free(o);
   return NULL;
}

/* What is written from now on is the last: readers of before get no more time */
void kj_store_last(kj_store *o)
{
   o->quarantine = 1;
   join_holes(o);
}

/* Close the file, after kj_store_last and a commit without what is free at its end. Negative when that
   fails */
int kj_store_close(kj_store *o)
{
   const kj_hole *hole = o->n_hole > 0 ? &o->hole[o->n_hole - 1] : NULL;
   int status;

   if (hole && o->quarantine == 1 && hole->address + hole->size == o->end && hole->since < o->commits)
      o->end = hole->address;
   status = tell_end(o, o->end);
   if (ftruncate(o->file, (off_t)o->end) < 0) status = -1;
   if (close(o->file) < 0) status = -1;
   kj_store_free(o);
   return status;
}

/* Take away the marks of a file that HDF5 has open to be written (superblock of version 3). 1: it had
   them; 0: none; negative: failed */
int kj_clear_marks(const char *path)
{
   unsigned char super[48] = {0};
   int file = open(path, O_RDWR | O_CLOEXEC), status = 0;

   if (file < 0) return -1;
   if (pread(file, super, sizeof super, 0) == sizeof super && !memcmp(super, "\x89HDF", 4) &&
      super[8] == 3 && super[11] != 0) {
      super[11] = 0;
      kj_seal(super, sizeof super);
      status = write_at(file, 0, sizeof super, super) < 0 ? -1 : 1;
   }
   close(file);
   return status;
}
