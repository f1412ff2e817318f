#pragma once

#include <string>

#include "core/extract/merged/merge_bound.h"

namespace isoslider::cli {

/// How far merged cells may lead a surface astray, as given with --lod-error.
struct LodError {
    extract::MergeError error;
    std::string text; ///< as given

    bool isGiven() const { return !text.empty(); }
    bool merges() const { return error.amount > 0.0; }
};

} // namespace isoslider::cli
