/* What a path is, before it is opened: a FIFO would block, a device never end. */
#include <sys/stat.h>

/* 0 nothing, 1 a regular file, 2 a folder, 3 anything else; links are followed */
int kj_file_kind(const char *path)
{
  struct stat s;
  if (stat(path, &s) != 0) return 0;
  return S_ISREG(s.st_mode) ? 1 : S_ISDIR(s.st_mode) ? 2 : 3;
}
