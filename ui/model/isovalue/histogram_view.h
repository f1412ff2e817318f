#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/grid/value_distribution.h"
#include "ui/model/isovalue/value_scale.h"

namespace isoslider::model {

/// What a histogram shows of a volume's values: which range at first, its outline at any zoom and scale, and what lies
/// below the pointer.
class HistogramView {
public:
    HistogramView() : HistogramView(std::make_shared<const ValueDistribution>()) {}
    /// REQUIRES: not null.
    explicit HistogramView(std::shared_ptr<const ValueDistribution> values) : values_(std::move(values)) {}

    const ValueDistribution& values() const { return *values_; }

    struct Range {
        double lower = 0.0;
        double upper = 0.0;
    };
    /// Values without extreme outliers and fill values; the ends of bins where a bin is one value.
    Range usualRange() const;
    Range wholeRange() const;
    bool hasOutliers() const;
    /// Samples below and above a range, about; 0 may stand for values that were not counted.
    struct Beyond {
        std::uint64_t below = 0;
        std::uint64_t above = 0;
    };
    Beyond beyond(const Range& range) const;

    /// Steps to draw between two places of `scale`, in at most `columns` columns; `places` has one end more than
    /// counts.
    struct Outline {
        std::vector<double> places;
        std::vector<double> counts;
        bool isShared = false; ///< what covers several columns is shared out among them: counts are about
    };
    Outline outline(const ValueScale& scale, double lowerPlace, double upperPlace, int columns) const;
    /// The height that a linear axis of counts needs: where a few counts tower above all others, what the others need.
    struct Top {
        double height = 1.0;
        bool isClipped = false;
    };
    static Top topOf(const Outline& outline, bool clips);

    /// Of the values that one pixel covers.
    struct Readout {
        double lower = 0.0; ///< of the bin; equal to upper if it is of one value
        double upper = 0.0;
        std::uint64_t count = 0;
        double shareBelow = 0.0; ///< of all samples: those below the isovalue
        bool isExact = true;
    };
    std::optional<Readout> readout(double value) const;
    /// The same of the step of `outline` at a place of `scale`: what is stated is what is drawn there. Where several
    /// steps are of one value, of that.
    std::optional<Readout> readout(const Outline& outline, const ValueScale& scale, double place) const;

    /// The sample value nearest to `value`, where values are known: whole numbers, or a few others.
    std::optional<double> nearestSample(double value) const;
    /// The next one above it, or below.
    std::optional<double> nextSample(double value, bool isUpwards) const;
    bool knowsSamples() const { return values_->isEachValue || values_->spacing > 0.0; }

private:
    double binWidth() const;
    std::uint64_t weighted(double count) const;
    Outline bodyOutline(double lower, double upper, int columns) const;
    Outline cellOutline(const ValueScale& scale, double lowerPlace, double upperPlace, int columns) const;
    void narrowToSamples(Readout& readout) const;

    std::shared_ptr<const ValueDistribution> values_;
};

} // namespace isoslider::model
