#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/cli/lod_error.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {

/// Options that several commands share. All throw CLI::ValidationError on a text that will not do.

/// An option or operand that names a file must not be empty; `what` it names, as "the output".
CLI::Option* requireName(CLI::Option* option, const std::string& what);
/// The operand that names what a command reads: a text, or a list of them.
template <class Names>
CLI::Option* addInput(CLI::App& command, const std::string& name, Names& target, const std::string& help) {
    return requireName(command.add_option(name, target, help)->required()->type_name(""), "the input");
}
/// A finite number: "nan", "inf", "1e999", "1,5" and an empty text are refused.
CLI::Option* addNumber(CLI::App& command, const std::string& name, std::optional<double>& target,
                       const std::string& help);
CLI::Option* addInteger(CLI::App& command, const std::string& name, std::int64_t& target, std::int64_t least,
                        std::int64_t most, const std::string& help);
/// Three whole numbers with commas between.
CLI::Option* addDims(CLI::App& command, const std::string& name, GridDims& target, const std::string& help);
/// --lod-error P%|Xc.
CLI::Option* addLodError(CLI::App& command, LodError& target, const std::string& help);

/// How to read a volume, as given on the command line.
struct VolumeOptions {
    GridDims dims{0, 0, 0};
    std::optional<ScalarType> type;
    glm::dvec3 spacing{1.0};
    std::int64_t skipBytes = 0;
    bool isBigEndian = false;
    bool allowsTrailing = false;
    bool allowsExternal = false;
    std::string field;
    std::optional<int> component;
    std::optional<std::int64_t> frame;
    GridDims resampleDims{0, 0, 0};
    std::vector<CLI::Option*> added; ///< to the command

    io::ReadOptions readOptions() const;
};

/// Adds --raw-dims, --raw-type and their companions, --field, --component, --frame, --resample, --allow-….
void addVolumeOptions(CLI::App& command, VolumeOptions& target);

} // namespace isoslider::cli
