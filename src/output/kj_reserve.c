/* Some room on a file system, held by a file without a name. It is given back when a history has to be
   closed, so that the last of its bookkeeping finds room on a disk that is full. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

/* Hold `bytes` beside a file; `name`, which ends with XXXXXX, is gone again on return. -1 where there is
   no such room. */
int kj_reserve_take(char *name, long bytes)
{
   int file = mkstemp(name);

   if (file < 0) return -1;
   unlink(name);
   fcntl(file, F_SETFD, FD_CLOEXEC);
   if (posix_fallocate(file, 0, bytes) == 0) return file;
   close(file);
   return -1;
}

void kj_reserve_give(int file)
{
   if (file >= 0) close(file);
}
