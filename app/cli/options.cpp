#include "app/cli/options.h"

#include <limits>

#include <fmt/format.h>

#include "app/cli/number_parsing.h"

namespace isoslider::cli {
namespace {

/// An option that hands its text to `parse`, which throws when it will not do.
template <class Parse>
CLI::Option* addText(CLI::App& command, const std::string& name, Parse parse, const std::string& help) {
    return command.add_option_function<std::string>(
        name, [name, parse](const std::string& text) { parse(name, text); }, help);
}

[[noreturn]] void refuse(const std::string& name, const std::string& text, const std::string& expected) {
    throw CLI::ValidationError(name, fmt::format("'{}' is not {}", text, expected));
}

double finiteOrThrow(const std::string& name, std::string_view text) {
    const auto value = parseFinite(text);
    if (!value)
        refuse(name, std::string(text), "a finite number (a point marks decimals, as in 1.5)");
    return *value;
}

std::array<std::string_view, 3> threePartsOrThrow(const std::string& name, const std::string& text) {
    const auto parts = splitAt(text, ',');
    if (parts.size() != 3)
        refuse(name, text, "three numbers with commas between");
    return {parts[0], parts[1], parts[2]};
}

// Sizes that no grid can have are the reader's to refuse: a size read from a file meets the same words.
GridDims dimsOrThrow(const std::string& name, const std::string& text) {
    const auto parts = threePartsOrThrow(name, text);
    GridDims dims{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto size = parseInteger(parts[axis]);
        if (!size)
            refuse(name, text, "three whole numbers with commas between");
        dims[axis] = *size;
    }
    return dims;
}

glm::dvec3 spacingOrThrow(const std::string& name, const std::string& text) {
    const auto parts = threePartsOrThrow(name, text);
    glm::dvec3 spacing{};
    for (int axis = 0; axis < 3; ++axis) {
        spacing[axis] = finiteOrThrow(name, parts[static_cast<std::size_t>(axis)]);
        if (spacing[axis] <= 0.0)
            refuse(name, text, "three distances above zero");
    }
    return spacing;
}

int componentOrThrow(const std::string& name, const std::string& text) {
    if (text == "magnitude")
        return io::kMagnitude;
    const auto value = parseInteger(text);
    if (!value || *value < 0 || *value > std::numeric_limits<int>::max())
        refuse(name, text, "a number from 0, or 'magnitude'");
    return static_cast<int>(*value);
}

std::int64_t frameOrThrow(const std::string& name, const std::string& text) {
    const auto value = parseInteger(text);
    if (!value || *value < 0)
        refuse(name, text, "a number from 0");
    return *value;
}

std::string knownScalarTypes() {
    std::string names;
    for (const auto type : kAllScalarTypes)
        names += (names.empty() ? "" : ", ") + std::string(scalarTypeName(type));
    return names;
}

ScalarType typeOrThrow(const std::string& name, const std::string& text) {
    const auto type = scalarTypeFromName(text);
    if (!type)
        refuse(name, text, "a sample type; known: " + knownScalarTypes());
    return *type;
}

LodError lodErrorOrThrow(const std::string& name, const std::string& text) {
    const bool hasUnit = text.ends_with('%') || text.ends_with('c');
    const auto amount = parseFinite(std::string_view(text).substr(0, text.size() - (hasUnit ? 1 : 0)));
    if (!amount || *amount < 0.0 || (!hasUnit && *amount != 0.0))
        refuse(name, text, "an error bound, as 0.5% of the value range or 0.25c cells");
    using Measure = extract::MergeBound::Measure;
    return {{text.ends_with('c') ? Measure::Distance : Measure::Scalar, *amount}, text};
}

} // namespace

CLI::Option* requireName(CLI::Option* option, const std::string& what) {
    return option->check(
        [what](const std::string& name) { return name.empty() ? what + " has no name" : std::string(); });
}

CLI::Option* addNumber(CLI::App& command, const std::string& name, std::optional<double>& target,
                       const std::string& help) {
    return addText(
               command, name,
               [&target](const std::string& option, const std::string& text) { target = finiteOrThrow(option, text); },
               help)
        ->type_name("X");
}

CLI::Option* addInteger(CLI::App& command, const std::string& name, std::int64_t& target, std::int64_t least,
                        std::int64_t most, const std::string& help) {
    return addText(
               command, name,
               [&target, least, most](const std::string& option, const std::string& text) {
                   const auto value = parseInteger(text);
                   if (!value || *value < least || *value > most)
                       refuse(option, text, fmt::format("a whole number from {} to {}", least, most));
                   target = *value;
               },
               help)
        ->type_name("N");
}

CLI::Option* addDims(CLI::App& command, const std::string& name, GridDims& target, const std::string& help) {
    return addText(
               command, name,
               [&target](const std::string& option, const std::string& text) { target = dimsOrThrow(option, text); },
               help)
        ->type_name("NX,NY,NZ");
}

CLI::Option* addLodError(CLI::App& command, LodError& target, const std::string& help) {
    const auto parse = [&target](const std::string& name, const std::string& text) {
        target = lodErrorOrThrow(name, text);
    };
    return addText(command, "--lod-error", parse, help)->type_name("P%|Xc");
}

io::ReadOptions VolumeOptions::readOptions() const {
    io::ReadOptions options;
    options.field = field;
    options.component = component;
    options.frame = frame;
    options.resampleDims = resampleDims;
    options.allowsExternalData = allowsExternal;
    options.allowsTrailing = allowsTrailing;
    if (type) {
        options.raw = io::RawLayout{dims, *type, spacing, static_cast<std::uint64_t>(skipBytes), isBigEndian};
    }
    return options;
}

void addVolumeOptions(CLI::App& command, VolumeOptions& target) {
    auto* dims = addText(
        command, "--raw-dims",
        [&target](const std::string& name, const std::string& text) { target.dims = dimsOrThrow(name, text); },
        "read a headerless file of NX,NY,NZ samples, x fastest");
    auto* type = addText(
        command, "--raw-type",
        [&target](const std::string& name, const std::string& text) { target.type = typeOrThrow(name, text); },
        "its sample type: " + knownScalarTypes());
    auto* spacing = addText(
        command, "--raw-spacing",
        [&target](const std::string& name, const std::string& text) { target.spacing = spacingOrThrow(name, text); },
        "its distances between samples, A,B,C (1,1,1)");
    auto* skip = addInteger(command, "--raw-skip", target.skipBytes, 0, std::numeric_limits<std::int64_t>::max(),
                            "bytes before its first sample (0)");
    auto* bigEndian = command.add_flag("--big-endian", target.isBigEndian, "its bytes are big-endian");
    auto* trailing = command.add_flag("--allow-trailing", target.allowsTrailing, "accept bytes behind the last sample");
    auto* external = command.add_flag("--allow-external", target.allowsExternal,
                                      "accept data files outside the folder of their header");
    auto* field = command.add_option("--field", target.field,
                                     "scalar field, data set or series to take where a file has several");
    auto* component = addText(
        command, "--component",
        [&target](const std::string& name, const std::string& text) {
            target.component = componentOrThrow(name, text);
        },
        "component of each sample to take, from 0, or 'magnitude'");
    auto* frame = addText(
        command, "--frame",
        [&target](const std::string& name, const std::string& text) { target.frame = frameOrThrow(name, text); },
        "volume of a series in time to take, from 0");
    auto* resample = addDims(command, "--resample", target.resampleDims,
                             "size of the uniform grid that other grids are resampled to");
    dims->needs(type)->type_name("NX,NY,NZ");
    type->needs(dims)->type_name("TYPE");
    spacing->type_name("A,B,C");
    field->type_name("NAME");
    component->type_name("N");
    frame->type_name("N");
    for (auto* option : {spacing, skip, bigEndian})
        option->needs(dims);
    for (auto* option : {field, component, frame, resample}) // headerless samples are one uniform volume
        option->excludes(dims);
    target.added = {dims, type, spacing, skip, bigEndian, trailing, external, field, component, frame, resample};
    for (auto* option : target.added)
        option->group("Volumes");
}

} // namespace isoslider::cli
