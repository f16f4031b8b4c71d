#define _GNU_SOURCE
/* Programs of the Python package kjoint: found in the build tree, in an installed tree or among the
   packages of Python, run, and waited for. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Places of the package that the build knows: under the prefix of an installed tree, and among the
   sources */
#ifndef KJOINT_INSTALLED_PYTHON
#define KJOINT_INSTALLED_PYTHON "lib/kjoint/python"
#endif
#ifndef KJOINT_SOURCE_PYTHON
#define KJOINT_SOURCE_PYTHON ""
#endif

/* The module is run inside the package, so that its relative imports work */
static const char *SCRIPT =
    "import sys\n"
    "try:\n"
    "    import kjoint\n"
    "except ImportError:\n"
    "    sys.exit('error: the Python package kjoint is not found\\n'\n"
    "             '    = install it: python3 -m pip install kjoint; KJOINT_PYTHON names another Python')\n"
    "import runpy\n"
    "try:\n"
    "    runpy.run_module('kjoint.' + sys.argv.pop(1), run_name='__main__')\n"
    "except ModuleNotFoundError as error:\n"
    "    print(f'error: this needs the Python package {error.name}\\n    = install it: '\n"
    "          f'{sys.executable} -m pip install {error.name}', file=sys.stderr)\n"
    "    sys.exit(3)\n";

/* A folder beside the program; 1 when it is there */
static int beside(const char *program, int up, const char *tail, char *path)
{
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%s", program);
    for (int i = 0; i < up; ++i) {
        char *slash = strrchr(folder, '/');
        if (!slash)
            return 0;
        *slash = '\0';
    }
    int n = snprintf(path, PATH_MAX, "%s/%s", folder, tail);
    return n < PATH_MAX && access(path, F_OK) == 0;
}

/* Run MODULE of the package with words; words are n texts, each ended by a null character. Returns
   the exit code; 127: there is no Python. With become the program takes the place of this one, with
   its signals and its exit code, so that only 127 comes back */
int kj_run_python(const char *words, int n, int become)
{
    char program[PATH_MAX] = "", package[PATH_MAX] = "", python[PATH_MAX] = "python3";
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    const char *chosen = getenv("KJOINT_PYTHON");
    if (chosen && *chosen)
        snprintf(python, sizeof python, "%s", chosen);
    else if (!beside(program, 2, "venv/bin/python", python))      /* of a build tree */
        strcpy(python, "python3");
    if (!beside(program, 2, KJOINT_INSTALLED_PYTHON, package)) {
        snprintf(package, sizeof package, "%s", KJOINT_SOURCE_PYTHON);
        if (access(package, F_OK) != 0)
            package[0] = '\0';                  /* an installed wheel */
    }
    char **argv = calloc((size_t)n + 4, sizeof *argv);
    if (!argv)
        return 4;
    argv[0] = python;
    argv[1] = "-c";
    argv[2] = (char *)SCRIPT;
    for (int i = 0; i < n; ++i) {
        argv[3 + i] = (char *)words;
        words += strlen(words) + 1;
    }
    fflush(stdout);
    pid_t child = become ? 0 : fork();
    if (child == 0) {
        if (package[0]) {
            const char *before = getenv("PYTHONPATH");
            char path[2 * PATH_MAX];
            snprintf(path, sizeof path, "%s%s%s", package, before && *before ? ":" : "",
                     before ? before : "");
            setenv("PYTHONPATH", path, 1);
        }
        setenv("KJOINT_PROGRAM", program, 1);
        char library[PATH_MAX];
        if (beside(program, 1, "libkjoint_c.so", library))       /* of a build tree */
            setenv("KJOINT_LIBRARY", library, 0);
        execvp(python, argv);
        free(argv);
        if (become)
            return 127;
        _exit(127);
    }
    free(argv);
    int status = 0;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    if (child < 0)
        return 4;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
