/* Dimension scales as H5DSattach_scale of HDF5 leaves them, in two attributes: DIMENSION_LIST of a dataset
   names its scales, REFERENCE_LIST of a scale the datasets that use it. That function reads and writes both
   anew for each pair, a fifth of all work of a small history; here each is written once. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <hdf5.h>

enum { MOST_RANK = 4, MOST_SCALES = 8 };

typedef struct { hobj_ref_t set; int dimension; } kj_use;      /* an entry of REFERENCE_LIST */

typedef struct { hid_t id; hobj_ref_t place; size_t n, most; kj_use *use; } kj_scale;

typedef struct { hid_t list; int n; kj_scale scale[MOST_SCALES]; } kj_scales;   /* those that are open */

kj_scales *kj_scales_new(void)
{
   kj_scales *o = calloc(1, sizeof *o);
   if (o) o->list = H5Tvlen_create(H5T_STD_REF_OBJ);
   return o;
}

void kj_scales_free(kj_scales *o)
{
   if (!o) return;
   while (o->n > 0) free(o->scale[--o->n].use);
   H5Tclose(o->list);
   free(o);
}

/* Write an attribute of n values; negative when it fails */
static int put_list(hid_t object, const char *name, hid_t type, hsize_t n, const void *values)
{
   hid_t space = H5Screate_simple(1, &n, NULL);
   hid_t list = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
   int status = list < 0 ? -1 : H5Awrite(list, type, values);

   if (list >= 0) H5Aclose(list);
   H5Sclose(space);
   return status;
}

/* A scale and room for one more use of it, or NULL */
static kj_scale *find_scale(kj_scales *o, hid_t id)
{
   kj_scale *s = o->scale;

   while (s < o->scale + o->n && s->id != id) s++;
   if (s == o->scale + MOST_SCALES) return NULL;
   if (s == o->scale + o->n) {
      *s = (kj_scale){.id = id};
      if (H5Rcreate(&s->place, id, ".", H5R_OBJECT, -1) < 0) return NULL;
      o->n++;
   }
   if (s->n == s->most) {
      kj_use *more = realloc(s->use, (2*s->most + 16)*sizeof *more);
      if (!more) return NULL;
      s->use = more;
      s->most = 2*s->most + 16;
   }
   return s;
}

/* Give a dataset its scales, slowest dimension first; negative when it fails */
int kj_scales_attach(kj_scales *o, hid_t set, int rank, const hid_t *scale)
{
   hvl_t list[MOST_RANK];
   hobj_ref_t place;
   int i;

   if (!o || rank > MOST_RANK || H5Rcreate(&place, set, ".", H5R_OBJECT, -1) < 0) return -1;
   for (i = 0; i < rank; i++) {
      kj_scale *s = find_scale(o, scale[i]);
      if (!s) return -1;
      list[i] = (hvl_t){1, &s->place};
      memset(&s->use[s->n], 0, sizeof *s->use);      /* its padding is written, too */
      s->use[s->n].set = place;
      s->use[s->n++].dimension = i;
   }
   return put_list(set, "DIMENSION_LIST", o->list, (hsize_t)rank, list);
}

/* No dataset more will use this scale; negative when that cannot be written */
int kj_scales_end(kj_scales *o, hid_t id)
{
   kj_scale *s = o->scale;
   hid_t type;
   int status;

   while (s < o->scale + o->n && s->id != id) s++;
   if (s == o->scale + o->n) return 0;
   type = H5Tcreate(H5T_COMPOUND, sizeof *s->use);
   status = H5Tinsert(type, "dataset", offsetof(kj_use, set), H5T_STD_REF_OBJ);
   if (status >= 0) status = H5Tinsert(type, "dimension", offsetof(kj_use, dimension), H5T_NATIVE_INT);
   if (status >= 0) status = put_list(id, "REFERENCE_LIST", type, s->n, s->use);
   H5Tclose(type);
   free(s->use);
   *s = o->scale[--o->n];
   return status;
}
