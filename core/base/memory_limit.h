#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace isoslider {

/// Memory that this process may use, in bytes: what is built into the machine, or less where a control group (of a
/// container, or a job of a batch system) or the process's limit on address space (`ulimit -v`) allows less.
std::uint64_t usableMemoryBytes();

/// The least limit of the control groups that `membership`, which is in the form of /proc/self/cgroup, names, and of
/// those that contain them; nullopt where none has one. `root` is where their files are (/sys/fs/cgroup), of either
/// version. Groups whose files are missing have no limit: a container sees its group as the root.
std::optional<std::uint64_t> memoryLimitOfGroups(std::string_view membership, const std::filesystem::path& root);

} // namespace isoslider
