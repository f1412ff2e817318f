#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "core/base/result.h"

// Volume files that are refused, each with what its refusal has to say.

namespace isoslider::test {

struct BadFile {
    const char* label;
    const char* file;
    std::string bytes;
    ErrorCode code;
    const char* says; ///< part of the message: the field, or what was expected
    std::string companion = {}; ///< bytes of "data.raw" beside it
};

inline void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.label; } // NOLINT: GoogleTest's name

const std::vector<BadFile>& badMetaImages();
const std::vector<BadFile>& badNrrds();
const std::vector<BadFile>& badNiftis();
const std::vector<BadFile>& badVtks();
const std::vector<BadFile>& badMaps();

/// The header of an NRRD file whose samples lie in another.
std::string detachedNrrd(const std::string& dataFile);

} // namespace isoslider::test
