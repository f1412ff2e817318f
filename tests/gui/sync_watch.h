#pragma once

namespace isoslider::test {

/// How often the calling thread, and all threads of this program, have waited for a disk so far: calls of fsync and
/// fdatasync, also those of Qt.
int syncsOfThisThread();
int syncsOfAllThreads();

} // namespace isoslider::test
