/* Loaded before HDF5, it makes a program believe that HDF5 may be called by one thread alone, and ends
   the program when another thread writes a chunk. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

int H5is_library_threadsafe(_Bool *safe);
int H5Dwrite_chunk(int64_t, int64_t, uint32_t, const uint64_t *, size_t, const void *);

int H5is_library_threadsafe(_Bool *safe)
{
   *safe = 0;
   return 0;
}

int H5Dwrite_chunk(int64_t series, int64_t plist, uint32_t filters, const uint64_t *offset, size_t bytes,
   const void *chunk)
{
   int (*write_chunk)(int64_t, int64_t, uint32_t, const uint64_t *, size_t, const void *);

   if (gettid() != getpid()) abort();
   *(void **)&write_chunk = dlsym(RTLD_NEXT, "H5Dwrite_chunk");
   return write_chunk(series, plist, filters, offset, bytes, chunk);
}
