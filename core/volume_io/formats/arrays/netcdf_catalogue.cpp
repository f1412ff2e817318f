#include "core/volume_io/formats/arrays/netcdf_catalogue.h"

#include <algorithm>
#include <map>
#include <set>

#include <netcdf.h>

#include "core/base/plain_text.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxVariables = 10'000;
constexpr int kMaxGroupDepth = 32;
constexpr std::size_t kMaxAttributeBytes = 4000;
constexpr std::size_t kMaxAttributeValues = 64;

bool isNumeric(nc_type type) { return type == NC_BYTE || (type >= NC_SHORT && type <= NC_UINT64); }

const char* typeNameOf(nc_type type) {
    constexpr const char* kNames[] = {"",        "int8",  "char",   "int16",  "int32", "float32",
                                      "float64", "uint8", "uint16", "uint32", "int64", "uint64"};
    return isNumeric(type) ? kNames[type] : "";
}

std::int64_t clampedProduct(std::int64_t count, std::uint64_t extent) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 62; // more is refused when it is opened
    const auto factor = static_cast<std::uint64_t>(count);
    return static_cast<std::int64_t>(factor != 0 && extent > kMost / factor ? kMost : factor * extent);
}

bool isPressureUnit(const std::string& unit) {
    constexpr const char* kUnits[] = {"pa",        "pascal", "pascals", "hpa", "mb",  "mbar",      "millibar",
                                      "millibars", "dbar",   "decibar", "bar", "atm", "atmosphere"};
    return std::find(std::begin(kUnits), std::end(kUnits), unit) != std::end(kUnits);
}

/// Of an axis of role Z. CF, 4.3: `positive` states it; a pressure grows downwards without it.
bool growsDownwards(const NetcdfAxis& axis) {
    const auto text = [&](const char* key) { return lowerCase(netcdfText(axis.group, axis.variable, key)); };
    if (const std::string positive = text("positive"); positive == "down" || positive == "up")
        return positive == "down";
    const std::string standard = text("standard_name");
    return standard == "depth" || standard == "air_pressure" || isPressureUnit(text("units"));
}

/// By the names and units that CF defines for coordinates, then by what people call them.
NetcdfRole roleOf(const NetcdfAxis& axis) {
    const std::string name = lowerCase(axis.name);
    if (axis.variable >= 0) {
        const auto text = [&](const char* key) { return lowerCase(netcdfText(axis.group, axis.variable, key)); };
        const std::string letter = text("axis"), standard = text("standard_name"), units = text("units");
        const std::map<std::string, NetcdfRole> letters{
            {"x", NetcdfRole::X}, {"y", NetcdfRole::Y}, {"z", NetcdfRole::Z}, {"t", NetcdfRole::Time}};
        if (const auto found = letters.find(letter); found != letters.end())
            return found->second;
        if (standard == "time" || units.find(" since ") != std::string::npos)
            return NetcdfRole::Time;
        if (standard == "longitude" || standard == "grid_longitude" || standard == "projection_x_coordinate" ||
            units == "degrees_east" || units == "degree_east")
            return NetcdfRole::X;
        if (standard == "latitude" || standard == "grid_latitude" || standard == "projection_y_coordinate" ||
            units == "degrees_north" || units == "degree_north")
            return NetcdfRole::Y;
        if (!text("positive").empty() || standard == "height" || standard == "depth" || standard == "altitude" ||
            standard == "air_pressure" || isPressureUnit(units))
            return NetcdfRole::Z;
    }
    const std::map<std::string, NetcdfRole> names{
        {"x", NetcdfRole::X},       {"lon", NetcdfRole::X},      {"longitude", NetcdfRole::X}, {"y", NetcdfRole::Y},
        {"lat", NetcdfRole::Y},     {"latitude", NetcdfRole::Y}, {"z", NetcdfRole::Z},         {"lev", NetcdfRole::Z},
        {"level", NetcdfRole::Z},   {"depth", NetcdfRole::Z},    {"height", NetcdfRole::Z},    {"plev", NetcdfRole::Z},
        {"time", NetcdfRole::Time}, {"t", NetcdfRole::Time}};
    const auto found = names.find(name);
    return found == names.end() ? NetcdfRole::Unknown : found->second;
}

/// Whatever is open: all variables that may be volumes.
class Catalogue {
public:
    Status read(int file, const std::filesystem::path& path) {
        collect(file, "", 0);
        if (isCut_)
            return makeError(ErrorCode::InvalidArgument, "has more groups or variables than any volume file", path);
        // Bounds of coordinates are no fields.
        std::erase_if(variables_, [&](const NetcdfVariable& variable) { return bounds_.contains(variable.name); });
        for (NetcdfVariable& variable : variables_)
            arrange(variable);
        return {};
    }

    std::vector<NetcdfVariable> take() { return std::move(variables_); }

private:
    void collect(int group, const std::string& prefix, int depth) {
        int count = 0;
        if (depth > kMaxGroupDepth || nc_inq_nvars(group, &count) != NC_NOERR)
            return cut();
        for (int id = 0; id < count; ++id)
            add(group, id, prefix);
        int groups = 0;
        if (nc_inq_grps(group, &groups, nullptr) != NC_NOERR || groups == 0)
            return;
        if (groups < 0 || static_cast<std::size_t>(groups) > kMaxVariables)
            return cut();
        std::vector<int> ids(static_cast<std::size_t>(groups));
        nc_inq_grps(group, &groups, ids.data());
        for (const int id : ids) {
            char name[NC_MAX_NAME + 1] = "";
            if (!isCut_ && nc_inq_grpname(id, name) == NC_NOERR)
                collect(id, prefix + name + "/", depth + 1);
        }
    }
    void cut() { isCut_ = true; }

    void add(int group, int id, const std::string& prefix) {
        char name[NC_MAX_NAME + 1] = "";
        NetcdfVariable variable;
        int rank = 0;
        if (++visited_ > kMaxVariables)
            return cut();
        if (nc_inq_var(group, id, name, &variable.type, &rank, nullptr, nullptr) != NC_NOERR)
            return;
        if (const std::string bounds = netcdfText(group, id, "bounds"); !bounds.empty())
            bounds_.insert(prefix + bounds);
        if (rank < 2 || rank > NC_MAX_VAR_DIMS || variable.type == NC_CHAR || variable.type == NC_STRING)
            return;
        std::vector<int> dimensions(static_cast<std::size_t>(rank));
        if (nc_inq_vardimid(group, id, dimensions.data()) != NC_NOERR)
            return;
        variable.group = group;
        variable.id = id;
        variable.name = prefix + name;
        for (const int dimension : dimensions)
            variable.axes.push_back(axisOf(group, dimension));
        if (!isNumeric(variable.type))
            variable.problem = "its values are of a user-defined type";
        variables_.push_back(std::move(variable));
    }

    static NetcdfAxis axisOf(int group, int dimension) {
        NetcdfAxis axis;
        char name[NC_MAX_NAME + 1] = "";
        std::size_t extent = 0;
        if (nc_inq_dim(group, dimension, name, &extent) != NC_NOERR)
            return axis;
        axis.name = name;
        axis.extent = extent;
        for (int at = group; axis.variable < 0;) { // a dimension is seen from the groups below its own
            int id = -1, rank = 0, own = -1;
            nc_type type = NC_NAT;
            if (nc_inq_varid(at, name, &id) == NC_NOERR &&
                nc_inq_var(at, id, nullptr, &type, &rank, nullptr, nullptr) == NC_NOERR && rank == 1 &&
                nc_inq_vardimid(at, id, &own) == NC_NOERR && own == dimension && isNumeric(type)) {
                axis.group = at;
                axis.variable = id;
            } else if (nc_inq_grp_parent(at, &at) != NC_NOERR) {
                break;
            }
        }
        axis.role = roleOf(axis);
        axis.isDownwards = axis.variable >= 0 && axis.role == NetcdfRole::Z && growsDownwards(axis);
        return axis;
    }

    void arrange(NetcdfVariable& variable) {
        std::vector<std::size_t> spatial;
        for (std::size_t i = 0; i < variable.axes.size(); ++i)
            if (variable.axes[i].role != NetcdfRole::Time)
                spatial.push_back(i);
        while (spatial.size() > 3) // ensembles and the like come before z
            spatial.erase(spatial.begin());
        std::map<NetcdfRole, std::size_t> known;
        for (const std::size_t i : spatial)
            known.emplace(variable.axes[i].role, i);
        known.erase(NetcdfRole::Unknown);
        if (known.size() == spatial.size()) {
            for (const auto& [role, i] : known)
                variable.axisOf[static_cast<std::size_t>(role) - static_cast<std::size_t>(NetcdfRole::X)] =
                    static_cast<int>(i);
        } else {
            for (std::size_t i = 0; i < spatial.size(); ++i)
                variable.axisOf[i] = static_cast<int>(spatial[spatial.size() - 1 - i]);
        }
        for (std::size_t i = 0; i < variable.axes.size(); ++i) // by order it may stand elsewhere
            variable.axes[i].isDownwards &= variable.axisOf[2] == static_cast<int>(i);
        for (std::size_t i = 0; i < variable.axes.size(); ++i)
            if (std::find(spatial.begin(), spatial.end(), i) == spatial.end())
                variable.others.push_back(i);
    }

    std::vector<NetcdfVariable> variables_;
    std::set<std::string> bounds_;
    std::size_t visited_ = 0;
    bool isCut_ = false;
};

} // namespace

std::string netcdfText(int group, int variable, const char* name) {
    nc_type type = NC_NAT;
    std::size_t size = 0;
    if (nc_inq_att(group, variable, name, &type, &size) != NC_NOERR || size == 0 || size > kMaxAttributeBytes)
        return {};
    if (type == NC_CHAR) {
        std::string text(size, '\0');
        return nc_get_att_text(group, variable, name, text.data()) == NC_NOERR ? text.substr(0, text.find('\0')) : "";
    }
    if (type == NC_STRING && size == 1) {
        char* text = nullptr;
        if (nc_get_att_string(group, variable, name, &text) != NC_NOERR || text == nullptr)
            return {};
        std::string copy = text;
        nc_free_string(1, &text);
        return copy;
    }
    return {};
}

std::vector<double> netcdfNumbers(int group, int variable, const char* name, int* typeOut) {
    nc_type type = NC_NAT;
    std::size_t size = 0;
    if (nc_inq_att(group, variable, name, &type, &size) != NC_NOERR || size == 0 || size > kMaxAttributeValues ||
        type == NC_CHAR || type > NC_UINT64)
        return {};
    std::vector<double> values(size);
    if (nc_get_att_double(group, variable, name, values.data()) != NC_NOERR)
        return {};
    if (typeOut != nullptr)
        *typeOut = type;
    return values;
}

FileType netcdfFileType(int type, bool isUnsigned) {
    switch (type) {
        case NC_BYTE: return isUnsigned ? FileType::U8 : FileType::I8;
        case NC_UBYTE: return FileType::U8;
        case NC_SHORT: return isUnsigned ? FileType::U16 : FileType::I16;
        case NC_USHORT: return FileType::U16;
        case NC_INT: return isUnsigned ? FileType::U32 : FileType::I32;
        case NC_UINT: return FileType::U32;
        case NC_INT64: return isUnsigned ? FileType::U64 : FileType::I64;
        case NC_UINT64: return FileType::U64;
        case NC_FLOAT: return FileType::F32;
        default: return FileType::F64;
    }
}

GridDims NetcdfVariable::dims() const {
    GridDims dims{1, 1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (axisOf[axis] >= 0)
            dims[axis] = clampedProduct(1, axes[static_cast<std::size_t>(axisOf[axis])].extent);
    return dims;
}

Result<std::vector<NetcdfVariable>> catalogueNetcdf(int file, const std::filesystem::path& path) {
    Catalogue catalogue;
    ISO_TRY(catalogue.read(file, path));
    return catalogue.take();
}

VolumeContents contentsOf(const std::vector<NetcdfVariable>& variables) {
    VolumeContents out;
    out.format = "NetCDF";
    std::size_t volumes = 0;
    for (const NetcdfVariable& variable : variables) {
        VolumeField field;
        field.name = variable.name;
        field.title = oneLine(netcdfText(variable.group, variable.id, "long_name"));
        field.typeName = typeNameOf(variable.type);
        field.problem = variable.problem;
        field.dims = variable.dims();
        for (const std::size_t axis : variable.others)
            field.frames = clampedProduct(field.frames, variable.axes[axis].extent);
        if (field.frames < 1) {
            field.frames = 1;
            field.problem = "it is a series of none";
        }
        // Where one of them has depth, planes beside it are masks and the like.
        if (field.problem.empty() && field.dims[0] > 1 && field.dims[1] > 1 && field.dims[2] > 1 && ++volumes == 1)
            out.preferred = out.fields.size();
        out.fields.push_back(std::move(field));
    }
    out.isPreferredChosen = volumes == 1;
    return out;
}

} // namespace isoslider::io
