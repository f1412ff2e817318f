#include "core/volume_io/reader_process/messages.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"

namespace isoslider::fuzz {
namespace {

/// What has been understood is stated again, and understood again as the same.
template <class Decode, class Encode>
void requireRoundTrip(std::span<const std::byte> bytes, const Decode& decode, const Encode& encode) {
    const auto value = decode(bytes);
    if (!value)
        return;
    const auto said = encode(*value);
    const auto again = decode(said);
    ISO_REQUIRE(again.has_value(), "");
    ISO_REQUIRE(encode(*again) == said, "");
}

} // namespace

/// A request of the program or an answer of its reader process.
void fuzzMessages(std::span<const std::byte> bytes) {
    requireRoundTrip(bytes, io::decodeRequest, io::encodeRequest);
    requireRoundTrip(bytes, io::decodeProgress, [](const io::ReaderProgress& progress) {
        return io::encodeProgress(progress.fraction, progress.stage);
    });
    requireRoundTrip(bytes, io::decodeError, io::encodeError);
    requireRoundTrip(bytes, io::decodeInfo, io::encodeInfo);
    requireRoundTrip(bytes, io::decodeContents, io::encodeContents);
    if (const auto error = io::decodeError(bytes); error && !error->message.empty())
        requireLine(error->message);
    if (const auto info = io::decodeInfo(bytes)) {
        requireGoodGeometry(info->geometry);
        for (const std::string& note : info->notes)
            if (!note.empty())
                requireLine(note);
    }
    if (const auto contents = io::decodeContents(bytes))
        ISO_REQUIRE(contents->preferred < contents->fields.size(), contents->format);
}

} // namespace isoslider::fuzz
