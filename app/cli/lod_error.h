#pragma once

#include <string>

#include <fmt/format.h>

#include "core/extract/merged/merge_bound.h"

namespace isoslider::cli {

/// How far merged cells may lead a surface astray, as given with --lod-error.
struct LodError {
    extract::MergeError error;
    std::string text; ///< as given

    bool isGiven() const { return !text.empty(); }
    bool merges() const { return error.amount > 0.0; }
};

/// As it is given with --lod-error: "0.25c", "0.5%".
inline std::string optionText(const extract::MergeError& error) {
    return fmt::format("{}{}", error.amount, error.measure == extract::MergeBound::Measure::Distance ? 'c' : '%');
}
/// For programs: "0.25 cells", "1 cells", "0.5 %".
inline std::string unitText(const extract::MergeError& error) {
    return fmt::format("{:g} {}", error.amount,
                       error.measure == extract::MergeBound::Measure::Distance ? "cells" : "%");
}
/// For people: "0.25 cells", "1 cell", "0.5 %".
inline std::string plainText(const extract::MergeError& error) {
    const bool isOneCell = error.amount == 1.0 && error.measure == extract::MergeBound::Measure::Distance;
    return isOneCell ? "1 cell" : unitText(error);
}

} // namespace isoslider::cli
