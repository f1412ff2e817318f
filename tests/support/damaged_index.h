#pragma once

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "core/extract/slide_engine.h"

namespace isoslider::test {

/// Changes one byte of an index so that it still opens and the first move, to `isovalue`, fails.
inline void damageFirstMove(const std::filesystem::path& path, double isovalue) {
    constexpr std::uintmax_t kPlaces = 997;
    const auto size = std::filesystem::file_size(path);
    const auto flip = [&path](std::uintmax_t offset) {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(static_cast<std::streamoff>(offset));
        const int byte = file.get();
        file.seekp(static_cast<std::streamoff>(offset));
        file.put(static_cast<char>(byte ^ 0xff));
    };
    for (std::uintmax_t place = 0; place < kPlaces; ++place) {
        const auto offset = (size / 2 + place * size / kPlaces) % size;
        flip(offset);
        auto engine = extract::SlideEngine::open(path);
        if (engine.isOk() && !engine.value()->slideTo(isovalue).isOk())
            return;
        flip(offset);
    }
    FAIL() << "no byte of " << path << " stops a move only";
}

} // namespace isoslider::test
