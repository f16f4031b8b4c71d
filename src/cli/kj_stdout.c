#define _POSIX_C_SOURCE 200809L
/* stdout through the C library: it says when a write failed, which the
   runtime of gfortran does not. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* Begin the program. Streams 0 to 2 that the caller closed get something to stand on, so that no
   file of ours takes their place; what is written to such a stream fails. A file that is too large
   is an error of writing, not the end of the program. */
void kj_open_streams(void)
{
    signal(SIGXFSZ, SIG_IGN);
    for (int stream = 0; stream <= 2; ++stream) {
        if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", stream ? O_RDONLY : O_WRONLY) != stream)
            return;
    }
}

/* A line on stdout */
void kj_put_line(const char *text, size_t length)
{
    fwrite(text, 1, length, stdout);
    putchar('\n');
}

/* Write out what waits; the error number of what was lost on stdout so far, 0 for nothing */
int kj_flush(void)
{
    errno = 0;
    int failed = fflush(stdout);
    return failed || ferror(stdout) ? (errno ? errno : EIO) : 0;
}

/* Columns of the terminal that a stream is; 0: it is none, or does not say */
int kj_columns(int stream)
{
    struct winsize size = {0};
    return ioctl(stream, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}
