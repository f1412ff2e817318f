#include "tests/gui/sync_watch.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>

namespace {

std::atomic<int> allSyncs{0};
thread_local int ownSyncs = 0;

int counted(long call, int file) {
    ++allSyncs;
    ++ownSyncs;
    return static_cast<int>(::syscall(call, file));
}

} // namespace

// A program's own functions take the place of those of the C library, in the libraries it uses too.
extern "C" int fsync(int file) { return counted(SYS_fsync, file); }
extern "C" int fdatasync(int file) { return counted(SYS_fdatasync, file); }

namespace isoslider::test {

int syncsOfThisThread() { return ownSyncs; }
int syncsOfAllThreads() { return allSyncs; }

} // namespace isoslider::test
