#include "core/volume_io/formats/field_choice.h"

#include <algorithm>

#include "core/volume_io/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxNamed = 12; ///< fields that one line of a message can list

std::string namesOf(const VolumeContents& contents) {
    std::string text;
    for (std::size_t i = 0; i < std::min(contents.fields.size(), kMaxNamed); ++i)
        text += (i > 0 ? ", " : "") + inQuotes(contents.fields[i].name);
    return text + (contents.fields.size() > kMaxNamed ? " ..." : "");
}

} // namespace

Status checkAnyField(const VolumeContents& contents, const std::filesystem::path& path) {
    if (contents.fields.empty())
        return refuseField("field", "the file has no samples of two or three dimensions", path);
    return {};
}

Result<std::size_t> chooseField(const VolumeContents& contents, const ReadOptions& options,
                                const std::filesystem::path& path) {
    const auto& fields = contents.fields;
    ISO_TRY(checkAnyField(contents, path));
    std::size_t chosen = contents.preferred;
    if (!options.field.empty()) {
        const auto found = std::find_if(fields.begin(), fields.end(),
                                        [&](const VolumeField& field) { return field.name == options.field; });
        if (found == fields.end())
            return refuseField("field", "there is none named " + inQuotes(options.field) + "; choose one of " +
                                            namesOf(contents), path);
        chosen = static_cast<std::size_t>(found - fields.begin());
    } else if (fields.size() > 1 && !contents.isPreferredChosen) {
        return refuseField("field", "the file has " + std::to_string(fields.size()) +
                                        "; choose one (--field): " + namesOf(contents), path);
    }
    if (!fields[chosen].problem.empty())
        return refuseField(inQuotes(fields[chosen].name), fields[chosen].problem, path);
    return chosen;
}

Result<std::int64_t> chooseFrame(const VolumeField& field, const ReadOptions& options,
                                 const std::filesystem::path& path) {
    if (!options.frame && field.frames > 1)
        return refuseField("frame", inQuotes(field.name) + " is a series of " + std::to_string(field.frames) +
                                        "; choose one from 0 (--frame)", path);
    const std::int64_t frame = options.frame.value_or(0);
    if (frame < 0 || frame >= field.frames)
        return refuseField("frame", std::to_string(frame) + " is not within 0.." + std::to_string(field.frames - 1),
                           path);
    return frame;
}

Result<int> chooseComponent(const VolumeField& field, const ReadOptions& options, const std::filesystem::path& path) {
    if (!options.component && field.components > 1)
        return refuseField("component", inQuotes(field.name) + " has " + std::to_string(field.components) +
                                            "; choose one from 0, or the magnitude (--component)", path);
    const int component = options.component.value_or(0);
    if (component < kMagnitude || component >= field.components)
        return refuseField("component", std::to_string(component) + " is not within 0.." +
                                            std::to_string(field.components - 1), path);
    return component;
}

} // namespace isoslider::io
