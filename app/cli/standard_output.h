#pragma once

#include <string>
#include <string_view>

#include "app/cli/command.h"
#include "app/cli/scratch_folder.h"

namespace isoslider::cli {

/// The output of a command where it is given as "-": a file that goes to standard output once it is whole, so that a
/// failure leaves standard output empty.
class StandardOutput {
public:
    /// Where `output` is "-", names a file below the temporary folder there, of the format with this suffix, and sends
    /// the report to standard error. Otherwise does nothing. Wrong usage: --json, which needs standard output itself; a
    /// terminal, for formats that are not text.
    Outcome prepare(Session& session, std::string& output, std::string_view suffix);
    /// Writes the file, if prepare() named one, to standard output.
    /// Errors: IoError (also when nobody reads any more), OutOfSpace, Cancelled.
    Status send(const Session& session) const;

private:
    std::string file_; ///< empty: the output is another
    ScratchFolder folder_;
};

} // namespace isoslider::cli
