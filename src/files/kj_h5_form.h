/* Parts of HDF5's file format, see kj_h5_form.c */
#ifndef KJ_H5_FORM_H
#define KJ_H5_FORM_H
#include <stddef.h>
#include <stdint.h>

enum { KJ_NIL = 0, KJ_DATASPACE = 1, KJ_LAYOUT = 8, KJ_ATTRIBUTE = 12 };    /* types of messages */

enum { KJ_PAGE = 4096 };     /* what one write changes as a whole, see kj_store.c */

/* A message of an object header: its head stands at `head`, its body behind that */
typedef struct {
   unsigned char *head, *body;
   size_t size;                              /* of the body */
   int type;
} kj_message;

/* Numbers of 1 to 8 bytes, the lowest first */
uint64_t kj_get(const unsigned char *p, int bytes);
void kj_put(unsigned char *p, int bytes, uint64_t value);

/* Where the file ends, in its superblock; which has kj_super_size bytes */
uint64_t kj_get_end(const unsigned char *super);
void kj_put_end(unsigned char *super, uint64_t end);
size_t kj_super_size(const unsigned char *super);

/* Make a superblock of version 2 one of version 3, which readers of a file that grows want */
void kj_super_live(unsigned char *super);

/* Move the messages that are wanted out of the object header at `header` of the file `image` of n
   bytes, into a block that will stand at `address`, or at the next page where a boundary would cut it.
   Returns the bytes of the block, 0 where the header is none or has none of them. */
size_t kj_move_messages(unsigned char *image, size_t n, uint64_t header,
   int (*wanted)(const kj_message *), uint64_t *address, unsigned char *block, size_t room);

/* The first message of such a block when `message` is NULL, else the one after it; 0: no more */
int kj_next_message(unsigned char *block, size_t n, const kj_message *before, kj_message *message);

/* Renew the checksum of a block that was changed */
void kj_seal(unsigned char *block, size_t n);

/* Name of an attribute, and its value of `bytes` bytes */
const char *kj_attribute_name(const kj_message *message);
unsigned char *kj_attribute_value(const kj_message *message, size_t bytes);

/* A heap of KJ_HEAP bytes that holds two texts, cut where they are too long: numbers 1 and 2 */
enum { KJ_HEAP = 4096, KJ_MOST_TEXT = 1900 };
void kj_make_heap(unsigned char *heap, const char *first, const char *second);
#endif
