#pragma once

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

namespace isoslider::test {

/// A file system of a few megabytes, in memory, mounted on a folder: really full when it is full. Only this process and
/// those that it starts see it. Needs root and a system that lets it mount; problem() states what is missing.
class SmallDisk {
public:
    SmallDisk(std::filesystem::path folder, std::size_t mebibytes) : folder_(std::move(folder)) {
        std::filesystem::create_directories(folder_);
        const std::string options = "size=" + std::to_string(mebibytes) + "m";
        if (::geteuid() != 0)
            problem_ = "only root may mount a file system";
        else if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
                 ::mount("none", folder_.c_str(), "tmpfs", 0, options.c_str()) != 0)
            problem_ = std::string("no file system can be mounted here: ") + std::strerror(errno);
    }
    ~SmallDisk() {
        if (problem_.empty())
            ::umount2(folder_.c_str(), MNT_DETACH);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

    /// Empty: it is there.
    const std::string& problem() const { return problem_; }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

    /// Leaves so many bytes free, some thousand more or less.
    void fill(std::size_t freeBytes = 0) const {
        const int file = ::open((folder_ / kFiller).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
        const std::vector<char> block(4096, 'x');
        while (std::filesystem::space(folder_).available > freeBytes)
            if (::write(file, block.data(), block.size()) <= 0)
                break;
        ::close(file);
    }
    void free() const { std::filesystem::remove(folder_ / kFiller); }

    /// Everything in it but what filled it.
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
            if (entry.path().filename() != kFiller)
                names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

private:
    static constexpr char kFiller[] = "filler";

    std::filesystem::path folder_;
    std::string problem_;
};

} // namespace isoslider::test
