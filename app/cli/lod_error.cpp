#include "app/cli/lod_error.h"

#include <fmt/format.h>

namespace isoslider::cli {

extract::MergeBound mergeBoundOf(const LodError& error, double least, double greatest) {
    return error.isDistance ? extract::MergeBound{extract::MergeBound::Measure::Distance, error.amount}
                            : extract::percentOfRange(error.amount, least, greatest);
}

std::string mergingText(const LodError& error, const extract::MergeBound& bound, int side) {
    const std::string within = error.isDistance
                                   ? fmt::format("within {} cells", error.amount)
                                   : fmt::format("within {} % of the value range ({:.6g})", error.amount, bound.limit);
    return fmt::format("{}, of up to {} cells a side", within, side);
}

} // namespace isoslider::cli
