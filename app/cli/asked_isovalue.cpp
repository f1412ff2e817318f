#include "app/cli/asked_isovalue.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/cli/number_parsing.h"
#include "core/index/index_distribution.h"

namespace isoslider::cli {
namespace {

bool needsSpread(std::span<const AskedIsovalue> asked) {
    return std::any_of(asked.begin(), asked.end(), [](const AskedIsovalue& one) { return one.isInDeviations; });
}

Result<std::vector<double>> valuesIn(std::span<const AskedIsovalue> asked, const ValueSpread& spread,
                                     const std::string& path) {
    std::vector<double> values;
    for (const AskedIsovalue& one : asked) {
        auto value = one.in(spread);
        if (!value.isOk()) {
            Error error = std::move(value).error();
            error.path = path;
            return error;
        }
        values.push_back(value.value());
    }
    return values;
}

} // namespace

AskedIsovalue isovalueOrThrow(const std::string& option, std::string_view text) {
    const auto isovalue = askedIsovalueFrom(text, parseFinite);
    if (!isovalue)
        throw CLI::ValidationError(option,
                                   fmt::format("'{}' is not a finite number (a point marks decimals, as in 1.5), "
                                               "nor one of standard deviations, as in '2.5 sigma'",
                                               text));
    return *isovalue;
}

CLI::Option* addIsovalue(CLI::App& command, const std::string& name, std::optional<AskedIsovalue>& target,
                         const std::string& help) {
    return command
        .add_option_function<std::string>(
            name, [name, &target](const std::string& text) { target = isovalueOrThrow(name, text); },
            help + "; as '2.5 sigma': the mean and so many standard deviations")
        ->type_name("X");
}

Result<std::vector<double>> valuesOf(std::span<const AskedIsovalue> asked, const std::string& indexPath,
                                     const JobControl& job) {
    if (!needsSpread(asked))
        return valuesIn(asked, {}, indexPath);
    const auto reader = index::IndexReader::open(indexPath);
    if (!reader.isOk())
        return reader.error();
    job.report(0.0, "mean and standard deviation");
    const auto spread = index::spreadOf(*reader.value(), job);
    if (!spread.isOk())
        return spread.error();
    return valuesIn(asked, spread.value(), indexPath);
}

Result<std::vector<double>> valuesOf(std::span<const AskedIsovalue> asked, const ScalarGrid& grid,
                                     const std::string& path, const JobControl& job) {
    if (!needsSpread(asked))
        return valuesIn(asked, {}, path);
    const auto spread = spreadOf(grid, job);
    if (!spread.isOk())
        return spread.error();
    return valuesIn(asked, spread.value(), path);
}

} // namespace isoslider::cli
