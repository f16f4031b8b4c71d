/* Loaded before HDF5, it makes a program believe that HDF5 may be called by one thread alone. */
int H5is_library_threadsafe(_Bool *safe);

int H5is_library_threadsafe(_Bool *safe)
{
   *safe = 0;
   return 0;
}
