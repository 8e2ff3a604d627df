// What newlib asks of the board. There is one device, the console, and no input.
#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/types.h>

#include "console.h"
#include "semihosting.h"

#undef errno
extern int errno;

extern char heap_start[], heap_end[];  // linker.ld

// newlib declares these in headers of its own only while it is built itself.
int _write(int file, const char* text, int length);
int _read(int file, char* text, int length);
int _close(int file);
int _fstat(int file, struct stat* status);
int _isatty(int file);
off_t _lseek(int file, off_t offset, int whence);
int _kill(int process, int signal);
int _getpid(void);
void* _sbrk(ptrdiff_t increment);
_Noreturn void _exit(int status);

int _write(int file, const char* text, int length) {
  if (file != 1 && file != 2) {
    errno = EBADF;
    return -1;
  }
  console_write(text, (size_t)length);
  return length;
}

void* _sbrk(ptrdiff_t increment) {
  static char* heap_break = heap_start;
  char* const previous = heap_break;
  if (increment > heap_end - previous || increment < heap_start - previous) {
    errno = ENOMEM;
    return (void*)-1;
  }
  heap_break = previous + increment;
  return previous;
}

void _exit(int status) {
  console_flush();
  semihosting_exit(status);
}

int _read(int file, char* text, int length) {
  (void)file, (void)text, (void)length;
  return 0;  // end of file
}

int _close(int file) {
  (void)file;
  return -1;
}

int _fstat(int file, struct stat* status) {
  (void)file;
  status->st_mode = S_IFCHR;
  return 0;
}

int _isatty(int file) {
  return file <= 2;
}

off_t _lseek(int file, off_t offset, int whence) {
  (void)file, (void)offset, (void)whence;
  return 0;
}

int _kill(int process, int signal) {  // abort() ends here
  (void)process;
  _exit(128 + signal);
}

int _getpid(void) {
  return 1;
}
