#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#define H5_USE_110_API // the structures below have grown since
#include <hdf5.h>

#include "core/volume_io/sources/sample_source.h"

// What the readers that rest on the HDF5 library share. For the sources of this folder only.

namespace isoslider::io {

/// While it lives, this thread alone calls HDF5 and NetCDF, and neither prints. Not to be nested.
class Hdf5Session {
public:
    Hdf5Session();
    ~Hdf5Session();
    Hdf5Session(const Hdf5Session&) = delete;
    Hdf5Session& operator=(const Hdf5Session&) = delete;

    /// Corruption: `what`, with the innermost complaint of the library on one line.
    Error error(std::string_view what, const std::filesystem::path& path) const;

private:
    std::scoped_lock<std::mutex> lock_;
};

/// Owns an identifier of the library. Close it, like everything here, within a session.
class Hdf5Handle {
public:
    using Closer = herr_t (*)(hid_t);

    Hdf5Handle() = default;
    Hdf5Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
    Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
    Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(closer_, other.closer_);
        return *this;
    }
    ~Hdf5Handle() { close(); }

    void close() {
        if (id_ >= 0)
            closer_(std::exchange(id_, -1));
    }
    bool isOpen() const { return id_ >= 0; }
    hid_t id() const { return id_; }

private:
    hid_t id_ = -1;
    Closer closer_ = nullptr;
};

/// For reading, without locks. Errors: Corruption.
Result<Hdf5Handle> openHdf5File(const Hdf5Session& session, const std::filesystem::path& path);

/// A data set of two to four dimensions.
struct Hdf5Dataset {
    std::string path; ///< "/group/name"
    std::vector<std::uint64_t> extents; ///< slowest first
    FileType type = FileType::F32;
    std::string problem; ///< why its samples cannot be read; empty: they can
};

/// All of them, by name; through hard links only, each once. At most kMaxObjects objects are visited: then
/// `isCut` is set.
struct Hdf5Tree {
    std::vector<Hdf5Dataset> datasets;
    bool isCut = false;
};
inline constexpr std::size_t kMaxObjects = 10'000;
Hdf5Tree walkHdf5(hid_t file);

/// Proves that the file holds the samples of a data set and that no part of it unpacks to more than a share of
/// memory. Refuses samples in other files. `name` is for messages. Errors: InvalidArgument, Corruption.
Status checkStorage(const Hdf5Session& session, hid_t dataset, std::string_view name, const std::filesystem::path& path,
                    std::uint64_t fileBytes);

/// Samples of a whole row of chunks stay in memory, if they are few: planes are read one after the other.
Hdf5Handle openDataset(hid_t file, const std::string& name);

/// Attributes of an object: all the numbers of one, or its texts. Empty if there is none such.
std::vector<double> attributeNumbers(hid_t object, const char* name);
std::vector<std::string> attributeTexts(hid_t object, const char* name);

} // namespace isoslider::io
