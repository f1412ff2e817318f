#include "core/volume_io/volume_choice.h"

#include <algorithm>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxNamedComponents = 9; // in one line
constexpr std::size_t kMaxNamed = 12; // fields in one line

std::string range(std::int64_t count) { return count > 1 ? "0 to " + std::to_string(count - 1) : "0 only"; }

std::string nameOf(const VolumeField& field) {
    return inQuotes(field.name) + (field.title.empty() ? "" : " (" + field.title + ")");
}

std::string inField(const VolumeField& field) { return field.name.empty() ? "" : nameOf(field) + " "; }

std::string namesOf(const VolumeContents& contents) {
    std::string text;
    for (std::size_t i = 0; i < std::min(contents.fields.size(), kMaxNamed); ++i)
        text += (i > 0 ? ", " : "") + nameOf(contents.fields[i]);
    return text + (contents.fields.size() > kMaxNamed ? " ..." : "");
}

std::string componentCount(const VolumeField& field) {
    std::string text = std::to_string(field.components) + " components";
    if (field.componentNames.empty() || field.componentNames.size() > kMaxNamedComponents)
        return text;
    for (std::size_t i = 0; i < field.componentNames.size(); ++i)
        text += (i == 0 ? " (" : ", ") + field.componentNames[i];
    return text + ")";
}

Error askFor(const VolumeField& field, bool asksComponent, bool asksFrame, const std::filesystem::path& path) {
    const std::string components =
        "--component " + range(field.components) + (field.hasMagnitude ? " or magnitude" : "");
    const std::string frames = "--frame " + range(field.frames);
    std::string text = inField(field) + "has ";
    if (asksComponent && asksFrame)
        text += componentCount(field) + " and " + std::to_string(field.frames) + " frames: choose with " + components +
                ", and " + frames;
    else if (asksComponent)
        text += componentCount(field) + ": choose one with " + components;
    else
        text += std::to_string(field.frames) + " frames: choose one with " + frames;
    return makeError(ErrorCode::InvalidArgument, std::move(text), path);
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
            return refuseField(
                "field", "there is none named " + inQuotes(options.field) + "; choose one of " + namesOf(contents),
                path);
        chosen = static_cast<std::size_t>(found - fields.begin());
    } else if (fields.size() > 1 && !contents.isPreferredChosen) {
        return refuseField(
            "field", "the file has " + std::to_string(fields.size()) + "; choose one (--field): " + namesOf(contents),
            path);
    }
    if (!fields[chosen].problem.empty())
        return refuseField(inQuotes(fields[chosen].name), fields[chosen].problem, path);
    return chosen;
}

Result<Choice> chooseIn(const VolumeField& field, const ReadOptions& options, const std::filesystem::path& path) {
    const bool asksComponent = field.components > 1 && !options.component;
    const bool asksFrame = field.frames > 1 && !options.frame;
    if (asksComponent || asksFrame)
        return askFor(field, asksComponent, asksFrame, path);
    const Choice choice{options.component.value_or(0), options.frame.value_or(0)};
    if (choice.component == kMagnitude && field.components == 1)
        return refuseField("--component magnitude", inField(field) + "has one component only", path);
    if (choice.component == kMagnitude && !field.hasMagnitude)
        return refuseField("--component magnitude", inField(field) + "has its components stored apart; choose one",
                           path);
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
                           "its one field has " +
                               (field.name.empty() ? std::string("no name") : "the name " + inQuotes(field.name)),
                           path);
    return chooseIn(field, options, path);
}

} // namespace isoslider::io
