#pragma once

namespace isoslider::io {

/// What the reader process does: opens or lists one file or folder, as it is asked on `descriptor`, a connected
/// socket, and hands over slabs until the other end closes. Limits its own memory to what the file can
/// reasonably hold, and its time for opening; never writes a file. Returns the exit status.
int serveReader(int descriptor);

} // namespace isoslider::io
