/* Some room on a file system, held by a file without a name. It is given back when a history has to be
   closed, so that the last of its bookkeeping finds room on a disk that is full. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <unistd.h>

/* Hold `bytes` in a file that loses its name at once. -1 where there is no such room. */
int kj_reserve_take(const char *name, long bytes)
{
   int file = open(name, O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600);

   if (file < 0) return -1;
   unlink(name);
   if (posix_fallocate(file, 0, bytes) == 0) return file;
   close(file);
   return -1;
}

void kj_reserve_give(int file)
{
   if (file >= 0) close(file);
}
