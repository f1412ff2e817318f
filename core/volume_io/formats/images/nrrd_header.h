#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/grid/grid_geometry.h"
#include "core/volume_io/parsing/file_type.h"

namespace isoslider::io {

enum class NrrdRole { Space, Component, Frame };

struct NrrdAxis {
    std::int64_t size = 1;
    NrrdRole role = NrrdRole::Space;
    std::string kind; ///< lower case; empty: not given
    std::optional<std::vector<double>> direction; ///< from sample to sample; empty: "none"; no value: not given
    std::string spacing; ///< as given, else by the extent of the axis; empty, or "nan": unknown
    std::string minimum, maximum, center; ///< as given
    std::string unit; ///< without quotes
};

/// Header of a NRRD file, checked but for its data files.
struct NrrdHeader {
    std::map<std::string, std::string, std::less<>> fields; ///< names in lower case, in one spelling
    std::vector<std::string> dataFiles; ///< after "data file: LIST"
    bool isDetached = false;
    std::uint64_t sizeBytes = 0; ///< where attached data begins
    std::vector<NrrdAxis> axes; ///< fastest first; at most one of components and one of frames is longer than 1
    FileType type = FileType::U8;
    bool isBigEndian = false;

    std::string_view operator[](std::string_view key) const {
        const auto found = fields.find(key);
        return found == fields.end() ? std::string_view() : std::string_view(found->second);
    }
    /// Extents of the axes of space, in their order.
    GridDims dims() const;
    /// Extent of the axis of that role, or 1.
    std::int64_t extent(NrrdRole role) const;
    std::vector<std::string> componentNames() const;
    bool isText() const;
};

/// Errors: InvalidArgument, naming the field; IoError.
Result<NrrdHeader> readNrrdHeader(const std::filesystem::path& path);

/// The unit of all axes of space, by "space units" or "units"; empty where they have none, or several.
std::string lengthUnitOf(const NrrdHeader& header);

/// "(1,0,0)" as numbers; nothing where that is no vector.
std::optional<std::vector<double>> parseNrrdVector(std::string_view text);

} // namespace isoslider::io
