#pragma once

#include <filesystem>
#include <initializer_list>
#include <vector>

#include "core/base/result.h"

namespace isoslider::model {

struct Dataset;

/// The files that open volumes are read from, which no output may replace: those of the volumes and their indexes.
class ReadFiles {
public:
    /// Null stands for no volume.
    explicit ReadFiles(std::initializer_list<const Dataset*> volumes);

    /// Asks the disk: on a worker thread. Errors: InvalidArgument, naming the output.
    Status checkNotReplacedBy(const std::filesystem::path& output) const;

private:
    void add(const Dataset& volume);

    std::vector<std::filesystem::path> files_, folders_;
};

} // namespace isoslider::model
