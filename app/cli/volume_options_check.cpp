#include "app/cli/volume_options_check.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/volume_io/volume_choice.h"
#include "core/volume_io/volume_contents.h"

namespace isoslider::cli {
namespace {

Outcome cannotApply(const std::string& option, const std::string& kind, const std::filesystem::path& path) {
    const std::string message = fmt::format("{} cannot apply to {}", option, kind);
    return Outcome::wrongUsage(makeError(ErrorCode::InvalidArgument, message, path.string()).line());
}

} // namespace

Outcome checkVolumeOptions(const VolumeOptions& options, InputKind kind, const std::filesystem::path& path) {
    const auto given = std::find_if(options.added.begin(), options.added.end(),
                                    [](const CLI::Option* option) { return option->count() > 0; });
    if (kind != InputKind::Index || given == options.added.end())
        return {};
    return cannotApply((*given)->get_name(), "an index", path);
}

Outcome checkResampling(const io::ReadOptions& options, const std::filesystem::path& path, const JobControl& job) {
    if (options.resampleDims == GridDims{0, 0, 0})
        return {};
    const auto contents = io::listVolumes(path, options, job);
    if (!contents.isOk())
        return contents.error();
    const auto& fields = contents.value().fields;
    const auto isResampled = [](const io::VolumeField& field) { return field.isResampled; };
    const auto chosen = io::chooseField(contents.value(), options, path);
    if (chosen.isOk() ? isResampled(fields[chosen.value()]) : std::any_of(fields.begin(), fields.end(), isResampled))
        return {};
    return cannotApply("--resample", "a uniform grid", path);
}

} // namespace isoslider::cli
