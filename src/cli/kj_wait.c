#define _POSIX_C_SOURCE 200809L
/* How threads of OpenMP wait for work. They spin, and starve who else wants the processor. The
   runtime reads what it is to do from the environment before main: the program starts once more. */
#include <limits.h>
#include <stdlib.h>
#include <unistd.h>

static char **arguments;

#ifdef __GLIBC__
__attribute__((constructor)) static void keep_arguments(int count, char **words)
{
    arguments = count > 0 ? words : NULL;
}
#endif

/* Start this program once more with threads that sleep while they wait, unless the environment says
   how they wait; where that fails they spin */
void kj_wait_passively(void)
{
    char path[PATH_MAX];
    if (!arguments || getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT"))
        return;
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
    if (length < 0 || setenv("OMP_WAIT_POLICY", "PASSIVE", 1))
        return;
    path[length] = '\0';
    execv(path, arguments);
}
