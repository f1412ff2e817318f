#include "core/base/memory_limit.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string>

#include <sys/resource.h>

#include "core/base/machine.h"

namespace isoslider {
namespace {

std::string textOf(const std::filesystem::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// A number; "max", or no file, stands for none.
std::optional<std::uint64_t> limitIn(const std::filesystem::path& file) {
    const std::string text = textOf(file);
    std::uint64_t bytes = 0;
    if (std::from_chars(text.data(), text.data() + text.size(), bytes).ec != std::errc())
        return std::nullopt;
    return bytes;
}

bool hasMemory(std::string_view controllers) {
    while (!controllers.empty()) {
        const auto comma = std::min(controllers.find(','), controllers.size());
        if (controllers.substr(0, comma) == "memory")
            return true;
        controllers.remove_prefix(std::min(comma + 1, controllers.size()));
    }
    return false;
}

} // namespace

std::optional<std::uint64_t> memoryLimitOfGroups(std::string_view membership, const std::filesystem::path& root) {
    std::optional<std::uint64_t> least;
    const auto lookAt = [&](std::filesystem::path group, const std::filesystem::path& top, const char* file) {
        for (;; group = group.parent_path()) {
            if (const auto limit = limitIn(top / group / file))
                least = std::min(*limit, least.value_or(*limit));
            if (group.empty())
                return;
        }
    };
    while (!membership.empty()) { // lines "number:controllers:/group", of version 2 "0::/group"
        const std::string_view line = membership.substr(0, membership.find('\n'));
        membership.remove_prefix(std::min(line.size() + 1, membership.size()));
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (first == line.npos || second == line.npos)
            continue;
        const std::string_view controllers = line.substr(first + 1, second - first - 1);
        const auto group = std::filesystem::path(line.substr(second + 1)).relative_path();
        if (controllers.empty())
            lookAt(group, root, "memory.max");
        else if (hasMemory(controllers))
            lookAt(group, root / "memory", "memory.limit_in_bytes");
    }
    return least;
}

std::uint64_t usableMemoryBytes() {
    std::uint64_t bytes = physicalMemoryBytes();
    if (const auto limit = memoryLimitOfGroups(textOf("/proc/self/cgroup"), "/sys/fs/cgroup"))
        bytes = std::min(bytes, *limit);
    if (rlimit space{}; ::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        bytes = std::min<std::uint64_t>(bytes, space.rlim_cur);
    return bytes;
}

} // namespace isoslider
