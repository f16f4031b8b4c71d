/* The machine that the kernels at work are compiled for. Where the build holds several
   (cmake/kjoint_variants.sh), the best that this processor can, or a lesser one named by
   KJOINT_KERNELS in the environment: settled before main, or when the library is loaded. All give
   the same bits. */
#include <stdlib.h>
#include <string.h>

#ifdef KJOINT_VARIANTS
static const char machines[][16] = {"x86-64", "x86-64-v3", "x86-64-v4"};
int kj_kernel = 0;

__attribute__((constructor)) static void choose(void)
{
    const char *wanted = getenv("KJOINT_KERNELS");
    __builtin_cpu_init();
    kj_kernel = __builtin_cpu_supports("x86-64-v4") ? 2 : __builtin_cpu_supports("x86-64-v3") ? 1 : 0;
    for (int i = 0; wanted && i < kj_kernel; i++)
        if (strcmp(wanted, machines[i]) == 0)
            kj_kernel = i;
}
#elif !defined KJOINT_MACHINE
#define KJOINT_MACHINE "of the build"
#endif

/* Its name, blanks behind */
void kj_kernel_machine(char name[16])
{
#ifdef KJOINT_VARIANTS
    const char *machine = machines[kj_kernel];
#else
    const char *machine = KJOINT_MACHINE;
#endif
    size_t length = strlen(machine);
    memset(name, ' ', 16);
    memcpy(name, machine, length < 16 ? length : 16);
}
