// A library to put before a program (LD_PRELOAD): system calls on files below a folder fail as the
// environment states.
//   ISO_FAIL_BELOW   the folder
//   ISO_FAIL_CALLS   "write": creating, writing, syncing, renaming; "read": reading
//   ISO_FAIL_HOW     "errno N": call ISO_FAIL_AT fails with error N; "kill": it ends the program; "full":
//   writes fail
//                    once ISO_FAIL_AT bytes are written; "short": every call transfers half; "interrupted":
//                    every second call fails with EINTR; "clock": time runs backwards, and no call fails
//   ISO_FAIL_AT      counting from 0

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

namespace {

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

const char* setting(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

std::atomic<long> calls{0};
std::atomic<long> bytesWritten{0};

bool isBelow(const char* path) {
    const std::size_t length = std::strlen(setting("ISO_FAIL_BELOW"));
    return length > 0 && std::strncmp(path, setting("ISO_FAIL_BELOW"), length) == 0;
}
bool isBelow(int descriptor) {
    char link[64], path[PATH_MAX];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t length = ::readlink(link, path, sizeof path - 1);
    path[length > 0 ? length : 0] = '\0';
    return descriptor > 2 && isBelow(path);
}
bool is(const char* name, const char* value) { return std::strcmp(setting(name), value) == 0; }

/// True, with errno set, when this call has to fail.
bool fails(const char* group) {
    if (!is("ISO_FAIL_CALLS", group))
        return false;
    const long call = calls++;
    if (is("ISO_FAIL_HOW", "interrupted")) {
        errno = EINTR;
        return call % 2 == 0;
    }
    if (is("ISO_FAIL_HOW", "short") || is("ISO_FAIL_HOW", "full") || call != std::atol(setting("ISO_FAIL_AT")))
        return false;
    if (is("ISO_FAIL_HOW", "kill"))
        ::kill(::getpid(), SIGKILL);
    const char* how = setting("ISO_FAIL_HOW");
    errno = std::strncmp(how, "errno ", 6) == 0 ? std::atoi(how + 6) : EIO;
    return true;
}

/// How many of `count` bytes this call may transfer; -1 with errno set for none.
ssize_t allowed(const char* group, int descriptor, std::size_t count) {
    if (!isBelow(descriptor))
        return static_cast<ssize_t>(count);
    if (fails(group))
        return -1;
    if (is("ISO_FAIL_CALLS", group) && is("ISO_FAIL_HOW", "short") && count > 1)
        return static_cast<ssize_t>(count / 2);
    if (!is("ISO_FAIL_HOW", "full") || std::strcmp(group, "write") != 0)
        return static_cast<ssize_t>(count);
    const long room = std::atol(setting("ISO_FAIL_AT")) - bytesWritten;
    if (room <= 0) {
        errno = ENOSPC;
        return -1;
    }
    const auto taken = std::min<long>(room, static_cast<long>(count));
    bytesWritten += taken;
    return taken;
}

int openFile(const char* name, const char* path, int flags, mode_t mode) {
    if ((flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0 && isBelow(path) && fails("write"))
        return -1;
    return next<int(const char*, int, mode_t)>(name)(path, flags, mode);
}
mode_t modeOf(int flags, va_list arguments) { return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0; }

} // namespace

extern "C" {

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = modeOf(flags, arguments);
    va_end(arguments);
    return openFile("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = modeOf(flags, arguments);
    va_end(arguments);
    return openFile("open64", path, flags, mode);
}
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
    const ssize_t room = allowed("write", descriptor, count);
    return room < 0 ? -1 : next<decltype(pwrite)>("pwrite")(descriptor, bytes, static_cast<size_t>(room), offset);
}
ssize_t write(int descriptor, const void* bytes, size_t count) {
    const ssize_t room = allowed("write", descriptor, count);
    return room < 0 ? -1 : next<decltype(write)>("write")(descriptor, bytes, static_cast<size_t>(room));
}
ssize_t pread(int descriptor, void* bytes, size_t count, off_t offset) {
    const ssize_t room = allowed("read", descriptor, count);
    return room < 0 ? -1 : next<decltype(pread)>("pread")(descriptor, bytes, static_cast<size_t>(room), offset);
}
ssize_t read(int descriptor, void* bytes, size_t count) {
    const ssize_t room = allowed("read", descriptor, count);
    return room < 0 ? -1 : next<decltype(read)>("read")(descriptor, bytes, static_cast<size_t>(room));
}
int fsync(int descriptor) {
    return isBelow(descriptor) && fails("write") ? -1 : next<decltype(fsync)>("fsync")(descriptor);
}
int ftruncate(int descriptor, off_t size) {
    return isBelow(descriptor) && fails("write") ? -1 : next<decltype(ftruncate)>("ftruncate")(descriptor, size);
}
int rename(const char* from, const char* to) noexcept { // which no signal interrupts
    return isBelow(to) && !is("ISO_FAIL_HOW", "interrupted") && fails("write")
               ? -1
               : next<int(const char*, const char*)>("rename")(from, to);
}
int clock_gettime(clockid_t clock, timespec* time) noexcept {
    const int outcome = next<int(clockid_t, timespec*)>("clock_gettime")(clock, time);
    if (outcome == 0 && clock == CLOCK_REALTIME && is("ISO_FAIL_HOW", "clock"))
        time->tv_sec -= 3600 * calls++; // an hour at each look
    return outcome;
}

} // extern "C"
