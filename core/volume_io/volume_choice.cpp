#include "core/volume_io/volume_choice.h"

#include "core/volume_io/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxNamedComponents = 9; // in one line

std::string range(std::int64_t count) { return "0 to " + std::to_string(count - 1); }

std::string inField(const VolumeField& field) { return field.name.empty() ? "" : inQuotes(field.name) + " "; }

std::string componentCount(const VolumeField& field) {
    std::string text = std::to_string(field.components) + " components";
    if (field.componentNames.empty() || field.componentNames.size() > kMaxNamedComponents)
        return text;
    for (std::size_t i = 0; i < field.componentNames.size(); ++i)
        text += (i == 0 ? " (" : ", ") + field.componentNames[i];
    return text + ")";
}

Error askFor(const VolumeField& field, bool asksComponent, bool asksFrame,
             const std::filesystem::path& path) {
    const std::string components = "--component " + range(field.components) + " or magnitude";
    const std::string frames = "--frame " + range(field.frames);
    std::string text = inField(field) + "has ";
    if (asksComponent && asksFrame)
        text += componentCount(field) + " and " + std::to_string(field.frames) + " frames: choose with " +
                components + ", and " + frames;
    else if (asksComponent)
        text += componentCount(field) + ": choose one with " + components;
    else
        text += std::to_string(field.frames) + " frames: choose one with " + frames;
    return makeError(ErrorCode::InvalidArgument, std::move(text), path);
}

} // namespace

Result<Choice> chooseIn(const VolumeField& field, const ReadOptions& options,
                        const std::filesystem::path& path) {
    const bool asksComponent = field.components > 1 && !options.component;
    const bool asksFrame = field.frames > 1 && !options.frame;
    if (asksComponent || asksFrame)
        return askFor(field, asksComponent, asksFrame, path);
    const Choice choice{options.component.value_or(0), options.frame.value_or(0)};
    if (choice.component == kMagnitude && field.components == 1)
        return refuseField("--component magnitude", inField(field) + "has one component only", path);
    if (choice.component != kMagnitude && (choice.component < 0 || choice.component >= field.components))
        return refuseField("--component " + std::to_string(choice.component),
                           inField(field) + "has component " + range(field.components), path);
    if (choice.frame < 0 || choice.frame >= field.frames)
        return refuseField("--frame " + std::to_string(choice.frame),
                           inField(field) + "has frame " + range(field.frames), path);
    return choice;
}

Result<Choice> chooseInOnlyField(const VolumeField& field, const ReadOptions& options,
                                 const std::filesystem::path& path) {
    if (!options.field.empty() && options.field != field.name)
        return refuseField("--field " + inQuotes(options.field),
                           "its one field has " + (field.name.empty() ? std::string("no name")
                                                                      : "the name " + inQuotes(field.name)),
                           path);
    return chooseIn(field, options, path);
}

} // namespace isoslider::io
