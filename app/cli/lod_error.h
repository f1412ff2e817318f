#pragma once

#include <string>

#include "core/extract/merged/merge_bound.h"

namespace isoslider::cli {

/// How far merged cells may lead a surface astray, as given with --lod-error; 0: nothing is merged.
struct LodError {
    double amount = 0.0;
    bool isDistance = false; ///< in cells; else in % of the value range
    std::string text; ///< as given

    bool isGiven() const { return amount > 0.0; }
};

/// For a volume of values from `least` to `greatest`.
extract::MergeBound mergeBoundOf(const LodError& error, double least, double greatest);
/// One line for the certificate; `side`: of the largest merged cells.
std::string mergingText(const LodError& error, const extract::MergeBound& bound, int side);

} // namespace isoslider::cli
