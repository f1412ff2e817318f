#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/scratch_folder.h"

namespace isoslider::cli {

/// What a command reads, and so what its standard input can be.
enum class InputContent { Volume, VolumeOrIndex, Index, Mesh };

/// The input of a command where it is given as "-": standard input, kept in a file while the program runs, since
/// readers go to and fro in it. The file is called "standard input", with the suffix of its format.
class StandardInput {
public:
    /// Adds --input-format, and watches `path`, the command's input.
    void declare(CLI::App& command, std::string& path, InputContent content);

    /// Where the input is "-", reads it to its end into a folder below `parent` and makes that file the input. What
    /// begins like nothing that this command reads is refused at its first bytes; of headerless samples no more is read
    /// than `volume` describes. Otherwise does nothing.
    Outcome fetch(Session& session, const VolumeOptions& volume, const std::filesystem::path& parent);
    Outcome fetch(Session& session);

    /// Of the file it lies in; 0 where the input is none.
    std::uint64_t bytes() const { return bytes_; }

private:
    Status copy(const std::filesystem::path& parent, const io::ReadOptions& options, const JobControl& job);
    Status checkStart(const io::ReadOptions& options, std::span<const std::byte> start) const;

    std::string* path_ = nullptr; ///< the command's
    InputContent content_ = InputContent::Volume;
    std::string format_; ///< as given: a suffix without its point
    std::string suffix_; ///< of the file, with its point
    std::uint64_t bytes_ = 0;
    ScratchFolder folder_;
};

} // namespace isoslider::cli
