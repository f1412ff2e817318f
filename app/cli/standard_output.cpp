#include "app/cli/standard_output.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "app/cli/standard_streams.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"

namespace isoslider::cli {
namespace {

constexpr char kOutputName[] = "standard output";
constexpr std::size_t kOutputBlockBytes = std::size_t{1} << 20;

} // namespace

Outcome StandardOutput::prepare(Session& session, std::string& output, std::string_view suffix) {
    if (output != "-")
        return {};
    if (session.isJson)
        return Outcome::wrongUsage("--json needs standard output for itself; give -o the name of a file");
    const bool isText = suffix == ".obj" || suffix == ".off";
    if (!isText && isOutputTerminal())
        return Outcome::wrongUsage("standard output is a terminal, and the format is not text; redirect it");
    if (const Status made = folder_.make(temporaryFolder(), "isoslider-output"); !made.isOk())
        return made.error();
    output = file_ = (folder_.path() / (kOutputName + std::string(suffix))).string();
    session.shownNames.emplace_back(partialPath(file_).string(), kOutputName);
    session.shownNames.emplace_back(file_, kOutputName);
    session.output.leaveStandardOutput();
    return {};
}

Status StandardOutput::send(const Session& session) const {
    if (file_.empty())
        return {};
    const auto file = defaultFileSystem().openForReading(file_);
    if (!file.isOk())
        return file.error();
    std::vector<std::byte> block(kOutputBlockBytes);
    for (std::uint64_t at = 0; at < file.value()->sizeBytes(); at += block.size()) {
        const auto bytes =
            std::span(block).first(std::min<std::uint64_t>(block.size(), file.value()->sizeBytes() - at));
        ISO_TRY(file.value()->readExactlyAt(at, bytes));
        ISO_TRY(writeOutput(bytes, session.stop));
    }
    return {};
}

} // namespace isoslider::cli
