/* Files that the program writes: which may be replaced, and a name of its own for each while it grows. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { TAKEN = 10000,                     /* kj_part_open, no number of an error */
   NOTHING = 0, REGULAR = 1, OTHER = 2,                /* kj_output_kind */
   TRIES = 20 };
static const char tail[] = ".part";

/* Whether two paths are one file */
int kj_same_file(const char *a, const char *b)
{
   struct stat s, t;
   return stat(a, &s) == 0 && stat(b, &t) == 0 && s.st_dev == t.st_dev && s.st_ino == t.st_ino;
}

/* What stands at a path, as one sees it through symbolic links */
int kj_output_kind(const char *path)
{
   struct stat s;
   if (stat(path, &s) == 0) return S_ISREG(s.st_mode) ? REGULAR : OTHER;
   return lstat(path, &s) == 0 ? OTHER : NOTHING;
}

/* Where a symbolic link leads, into `real` of n bytes. 0: it is one */
int kj_real_path(const char *path, char *real, size_t n)
{
   char found[PATH_MAX];
   struct stat s;
   if (lstat(path, &s) || !S_ISLNK(s.st_mode)) return -1;
   if (!realpath(path, found) || strlen(found) >= n) return -1;
   strcpy(real, found);
   return 0;
}

/* A lock that says that a file is written. Readers may lock the rest of it as they like, and, where their
   locks are of this kind (NFS), share this one. */
static struct flock mark(short type)
{
   struct flock lock = {0};
   lock.l_type = type;
   lock.l_whence = SEEK_SET;
   lock.l_start = (off_t)1 << 62;
   lock.l_len = 1;
   return lock;
}

/* Whether a process writes this history */
int kj_is_written(const char *path)
{
   struct flock lock = mark(F_WRLCK);
   int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC), written = 0;
   if (file < 0) return 0;
   written = fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
   close(file);
   return written;
}

/* Whether another program holds a lock that keeps readers out, as HDF5 takes it to write */
int kj_is_locked(const char *path)
{
   int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC), locked;
   if (file < 0) return 0;
   locked = flock(file, LOCK_SH | LOCK_NB) && errno == EWOULDBLOCK;
   close(file);
   return locked;
}

/* Is `name` that of a file which grows to be `base`? */
static int grows_to_be(const char *name, const char *base)
{
   size_t n = strlen(base), m = strlen(name), t = sizeof tail - 1;
   return m == n + 7 + t && !strncmp(name, base, n) && name[n] == '.' && !strcmp(name + m - t, tail);
}

/* The file beside `path` that grows to be it, when `written`; else that a run left which was killed, when
   it is newer than what stands at `path`. The newest; but not `own`. Its path into `found` of n bytes.
   0: there is one */
int kj_find_part(const char *path, const char *own, int written, char *found, size_t n)
{
   const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
   size_t folder = (size_t)(base - path);
   char *name = malloc(folder + NAME_MAX + 2);
   struct timespec newest = {0, 0};
   struct dirent *entry;
   struct stat s;
   DIR *all;
   int missing = -1;

   if (!name) return -1;
   if (!written && stat(path, &s) == 0) newest = s.st_mtim;
   memcpy(name, path, folder);
   strcpy(name + folder, ".");
   all = opendir(name);
   while (all && (entry = readdir(all))) {
      if (!grows_to_be(entry->d_name, base)) continue;
      strcpy(name + folder, entry->d_name);
      if (!strcmp(name, own) || strlen(name) >= n || lstat(name, &s) || !S_ISREG(s.st_mode)) continue;
      if (kj_is_written(name) != written || s.st_mtim.tv_sec < newest.tv_sec ||
         (s.st_mtim.tv_sec == newest.tv_sec && s.st_mtim.tv_nsec < newest.tv_nsec)) continue;
      newest = s.st_mtim;
      strcpy(found, name);
      missing = 0;
   }
   if (all) closedir(all);
   free(name);
   return missing;
}

/* Open a file with a name of its own beside `path`, into `part` of n bytes, marked as being written */
static int open_part(const char *path, char *part, size_t n)
{
   static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789";
   struct flock lock = mark(F_RDLCK);
   struct timespec now;
   int i, k, file = -1;

   for (i = 0; i < TRIES && file < 0; i++) {
      unsigned long seed;
      clock_gettime(CLOCK_REALTIME, &now);
      seed = ((unsigned long)now.tv_nsec*2654435761u ^ (unsigned long)getpid() << 16) + (unsigned long)i;
      if ((size_t)snprintf(part, n, "%s.......%s", path, tail) >= n) return -1;
      for (k = 0; k < 6; k++, seed /= 36) part[strlen(path) + 1 + (size_t)k] = letters[seed % 36];
      file = open(part, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (file < 0 && errno != EEXIST) return -1;
   }
   if (file >= 0) fcntl(file, F_OFD_SETLK, &lock);
   return file;
}

/* The same, when nobody writes what is to become `path`. The file, or -errno, or -TAKEN with the file of
   the other in `part`. Who comes at the same time as another waits a moment. */
int kj_part_open(const char *path, char *part, size_t n)
{
   char own[PATH_MAX];
   int i, file;

   for (i = 0; i < TRIES; i++) {
      struct timespec pause = {0, (1 + getpid() % 13)*1000000L*(1 + i)};
      if (kj_is_written(path)) {
         snprintf(part, n, "%s", path);
         return -TAKEN;
      }
      file = open_part(path, own, sizeof own < n ? sizeof own : n);
      if (file < 0) return errno ? -errno : -EIO;
      if (kj_find_part(path, own, 1, part, n)) {
         strcpy(part, own);
         return file;
      }
      unlink(own);
      close(file);
      if (i > 0 && kj_find_part(path, "", 1, part, n) == 0) return -TAKEN;
      nanosleep(&pause, NULL);
   }
   return -TAKEN;
}

/* Give a file the name `path`: where there is none, or in place of one. 0: done; 1: there is one, which
   was to stay; -1: failed */
int kj_part_name(const char *part, const char *path, int replace)
{
   int kind = kj_output_kind(path);

   if (kind == OTHER) return -1;
   if (replace) return rename(part, path);
   if (kind == REGULAR) return 1;
   if (link(part, path) == 0) return unlink(part);
   if (errno == EEXIST) return 1;
   return rename(part, path);                /* where a file has one name only */
}

/* Whether an open file still has a name */
int kj_has_name(int file)
{
   struct stat s;
   return fstat(file, &s) == 0 && s.st_nlink > 0;
}

/* Write n bytes. 0, or the number of the error */
static int write_all(int file, size_t n, const char *bytes)
{
   while (n > 0) {
      ssize_t done = write(file, bytes, n);
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) return errno;
      bytes += done;
      n -= (size_t)done;
   }
   return 0;
}

/* Close files that may be open. `reason`, or the number of the error */
static int close_all(int from, int to, int reason)
{
   if (from >= 0) close(from);
   if (to >= 0 && close(to) < 0 && reason == 0) reason = errno;
   return reason;
}

/* Copy a file over another that is there. 0, or the number of the error */
int kj_copy_file(const char *path, const char *copy)
{
   char block[1 << 16];
   int from = open(path, O_RDONLY | O_CLOEXEC), to = from < 0 ? -1 : open(copy, O_WRONLY | O_CLOEXEC);
   int reason = to < 0 ? errno : 0;
   ssize_t n = 1;

   while (reason == 0 && n != 0) {
      n = read(from, block, sizeof block);
      if (n > 0) reason = write_all(to, (size_t)n, block);
      if (n < 0 && errno != EINTR) reason = errno;
   }
   return close_all(from, to, reason);
}

/* Write n bytes to the end of a file that is there. 0, or the number of the error */
int kj_append(const char *path, size_t n, const char *bytes)
{
   int file = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);

   return close_all(-1, file, file < 0 ? errno : write_all(file, n, bytes));
}
