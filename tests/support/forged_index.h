#pragma once

#include <algorithm>
#include <string>

#include "core/index/format/index_format.h"

namespace isoslider::test {

/// An index file with its meta replaced and all checksums made right: what only a forger would write.
inline std::string forgedIndex(const std::string& file, const index::IndexMeta& meta) {
    index::Preamble preamble = index::decodePreamble(std::as_bytes(std::span(file)), file.size(), "forged").value();
    const auto encoded = index::encodeMeta(meta);
    preamble.metaBytes = encoded.size();
    preamble.metaChecksum = index::metaChecksum(encoded);
    preamble.fileBytes = preamble.metaOffset + encoded.size();
    const auto head = index::encodePreamble(preamble);
    std::string out = file.substr(0, preamble.metaOffset);
    std::copy_n(reinterpret_cast<const char*>(head.data()), head.size(), out.begin());
    return out.append(reinterpret_cast<const char*>(encoded.data()), encoded.size());
}

} // namespace isoslider::test
