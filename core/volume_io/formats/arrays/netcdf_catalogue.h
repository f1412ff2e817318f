#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/volume_io/sources/sample_source.h"
#include "core/volume_io/volume_contents.h"

// What is in a NetCDF file. For the sources of this folder only; all of it runs within a Hdf5Session.

namespace isoslider::io {

/// What an axis stands for.
enum class NetcdfRole { Unknown, X, Y, Z, Time };

struct NetcdfAxis {
    std::string name;
    std::uint64_t extent = 0;
    int group = -1, variable = -1; ///< its coordinate variable; -1: none
    NetcdfRole role = NetcdfRole::Unknown;
    bool isDownwards = false; ///< a depth or a pressure, by `positive`, or else by what CF says of its name or unit
};

/// A variable of two or more dimensions.
struct NetcdfVariable {
    int group = -1, id = -1;
    std::string name; ///< with its groups: "group/name"
    int type = 0; ///< nc_type
    std::vector<NetcdfAxis> axes; ///< slowest first
    std::array<int, 3> axisOf{-1, -1, -1}; ///< which of `axes` is x, y, z; -1: none
    std::vector<std::size_t> others; ///< those that are none of them: their extents make the frames
    std::string problem; ///< why it cannot be read

    GridDims dims() const;
};

/// All variables that may be volumes, but those that bound coordinates. Axes are x, y, z by what CF states of their
/// coordinates, failing that by their order, z slowest; further ones and times make frames.
/// Errors: InvalidArgument (too many).
Result<std::vector<NetcdfVariable>> catalogueNetcdf(int file, const std::filesystem::path& path);

/// Fields as many as variables. If one alone has depth, it is preferred and chosen.
VolumeContents contentsOf(const std::vector<NetcdfVariable>& variables);

FileType netcdfFileType(int type, bool isUnsigned);

/// One text; empty if there is none such. `variable` may be NC_GLOBAL.
std::string netcdfText(int group, int variable, const char* attribute);
/// All numbers of one; `typeOut` is theirs, and left alone if there are none.
std::vector<double> netcdfNumbers(int group, int variable, const char* attribute, int* typeOut = nullptr);

} // namespace isoslider::io
