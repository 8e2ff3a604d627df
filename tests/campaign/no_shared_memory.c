// LD_PRELOAD: a disk that shares no memory (NOSHM), or has no locks (NOLOCK: the errno), for files
// with ".sqlite" in their names.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static int is_store(int file) {
  char link[64], path[512];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size < 0) return 0;
  path[size] = 0;
  return strstr(path, ".sqlite") != NULL;
}

void* mmap64(void* at, size_t size, int access, int flags, int file, off64_t offset) {
  void* (*real)(void*, size_t, int, int, int, off64_t) = dlsym(RTLD_NEXT, "mmap64");
  if (getenv("NOSHM") != NULL && file >= 0 && (flags & MAP_SHARED) != 0 && is_store(file)) {
    errno = ENODEV;
    return MAP_FAILED;
  }
  return real(at, size, access, flags, file, offset);
}
void* mmap(void* at, size_t size, int access, int flags, int file, off_t offset) {
  return mmap64(at, size, access, flags, file, offset);
}

static int control(int file, int command, void* argument) {
  int (*real)(int, int, ...) = dlsym(RTLD_NEXT, "fcntl64");
  const int locks = command == F_SETLK || command == F_SETLKW || command == F_GETLK;
  if (getenv("NOLOCK") != NULL && locks && is_store(file)) {
    errno = atoi(getenv("NOLOCK"));
    return -1;
  }
  return real(file, command, argument);
}
int fcntl64(int file, int command, ...) {
  va_list list;
  va_start(list, command);
  void* argument = va_arg(list, void*);
  va_end(list);
  return control(file, command, argument);
}
int fcntl(int file, int command, ...) {
  va_list list;
  va_start(list, command);
  void* argument = va_arg(list, void*);
  va_end(list);
  return control(file, command, argument);
}
