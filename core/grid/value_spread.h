#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/job_control.h"
#include "core/base/result.h"
#include "core/grid/scalar_grid.h"

namespace isoslider {

/// Mean and standard deviation of a volume's finite samples, of all grid points alike: what density maps are read in
/// multiples of. The deviation is that of the samples themselves: divided by their count, not by one less.
struct ValueSpread {
    double mean = 0.0;
    double deviation = 0.0; ///< at least 0
    bool isExact = true; ///< false: estimated from some of the samples, or from a histogram

    /// "sigma" of an isovalue; REQUIRES: deviation > 0.
    double deviationsOf(double isovalue) const { return (isovalue - mean) / deviation; }
};

/// Sums up samples for their spread. Not to be shared between threads: each has one, merged in the end.
class SpreadSum {
public:
    /// Missing samples are left out. Errors of rounding stay below 1e-12 of the deviation.
    template <class Sample>
    void add(std::span<const Sample> samples);
    void add(double value, std::uint64_t count);
    void merge(const SpreadSum& other);

    std::uint64_t count() const { return count_; }
    /// Rounded to 1e-11 of the deviation, so that it does not depend on the order of the sums: the same from an index,
    /// from its volume, and on any number of threads. All zero without samples.
    ValueSpread spread() const;

    /// Of a range of them, such as those of the threads.
    template <class Sums>
    static ValueSpread spreadOfAll(const Sums& sums) {
        SpreadSum all;
        for (const SpreadSum& part : sums)
            all.merge(part);
        return all.spread();
    }

private:
    void mergePart(std::uint64_t count, long double mean, long double squares);
    void note(double value);

    std::uint64_t count_ = 0;
    double first_ = 0.0; ///< of the samples, and whether any differs from it: sums are not exact enough to tell
    bool hasFirst_ = false;
    bool doesAnyDiffer_ = false;
    long double mean_ = 0.0L; // of doubles near their greatest, squares have no place in a double
    long double squares_ = 0.0L; ///< of differences from the mean
};

/// Of all samples of a volume in memory, exactly. Errors: Cancelled.
Result<ValueSpread> spreadOf(const ScalarGrid& grid, const JobControl& job = {});

/// An isovalue as people ask for it: a value, or so many standard deviations above the mean.
struct AskedIsovalue {
    AskedIsovalue(double value) : number(value) {} // NOLINT(google-explicit-constructor): most are plain values
    AskedIsovalue(double amount, bool isDeviations) : number(amount), isInDeviations(isDeviations) {}

    double number;
    bool isInDeviations = false;

    /// Errors: InvalidArgument where it is in deviations and no two samples differ.
    Result<double> in(const ValueSpread& spread) const;

    bool operator==(const AskedIsovalue&) const = default;
};

/// Takes the word for standard deviations off the end of a text, with blanks before it: "2.5 sigma" becomes "2.5".
/// Words: sigma, σ, sd, std, in upper and lower case. False, leaving the text, if there is none. "rms" is none: some
/// programs measure it from the mean, others from 0.
bool removeDeviationWord(std::string_view& text);

/// What is written as an isovalue, as a number or one with a word behind it; numberFrom(text) reads the number, if it
/// is one.
template <class NumberFrom>
std::optional<AskedIsovalue> askedIsovalueFrom(std::string_view text, const NumberFrom& numberFrom) {
    const bool isInDeviations = removeDeviationWord(text);
    const std::optional<double> number = numberFrom(text);
    return number ? std::optional(AskedIsovalue(*number, isInDeviations)) : std::nullopt;
}

} // namespace isoslider
