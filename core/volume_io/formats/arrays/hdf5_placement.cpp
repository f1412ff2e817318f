#include "core/volume_io/formats/arrays/hdf5_placement.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "core/grid/length_unit.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

/// The last three axes, z slowest; the two of a plane.
Placement usualPlacement(const std::vector<std::uint64_t>& extents) {
    Placement placement;
    const auto rank = static_cast<int>(extents.size());
    for (int axis = 0; axis < std::min(rank, 3); ++axis)
        placement.axisOf[static_cast<std::size_t>(axis)] = rank - 1 - axis;
    return placement;
}

/// The axis of the data set that each label names; false unless they are x, y and z, or two of them.
bool orderByLabels(const std::vector<std::string>& labels, std::array<int, 3>& axisOf) {
    std::array<int, 3> found{-1, -1, -1};
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const std::string label = lowerCase(labels[i]);
        if (label != "x" && label != "y" && label != "z")
            return false;
        int& axis = found[static_cast<std::size_t>(label[0] - 'x')];
        if (axis >= 0)
            return false;
        axis = static_cast<int>(i);
    }
    axisOf = found;
    return true;
}

constexpr std::string_view kVtkPoints = "/VTKHDF/PointData/", kVtkCells = "/VTKHDF/CellData/";

bool arePositive(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v > 0.0 && std::isfinite(v); });
}

/// Names of all attributes of an object.
std::vector<std::string> attributeNames(hid_t object) {
    std::vector<std::string> names;
    const auto keep = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
        auto& kept = *static_cast<std::vector<std::string>*>(list);
        kept.emplace_back(name);
        return kept.size() < 1000 ? 0 : 1;
    };
    hsize_t at = 0;
    if (object >= 0)
        H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, &at, keep, &names);
    return names;
}

class PlacementReader {
public:
    PlacementReader(hid_t file, const Hdf5Dataset& dataset)
        : placement_(usualPlacement(dataset.extents)), file_(file), path_(dataset.path) {
        const std::size_t slash = dataset.path.rfind('/');
        dataset_ = Hdf5Handle(H5Oopen(file, dataset.path.c_str(), H5P_DEFAULT), H5Oclose);
        parent_ =
            Hdf5Handle(H5Oopen(file, slash == 0 ? "/" : dataset.path.substr(0, slash).c_str(), H5P_DEFAULT), H5Oclose);
        rank_ = dataset.extents.size();
    }

    Placement run() {
        // A mesh of one scalar is a data set with the attributes, one of several a group.
        for (const hid_t mesh : {dataset_.id(), parent_.id()})
            if (mesh >= 0 && placeAsOpenPmd(mesh))
                return std::move(placement_);
        if (placeAsVtk() || placeAsMinc() || placeByElementSize())
            return std::move(placement_);
        noteUnknown();
        return std::move(placement_);
    }

private:
    bool placeAsOpenPmd(hid_t mesh) {
        auto spacing = attributeNumbers(mesh, "gridSpacing");
        if (spacing.size() != rank_ || rank_ > 3)
            return false;
        auto labels = attributeTexts(mesh, "axisLabels");
        auto origin = attributeNumbers(mesh, "gridGlobalOffset");
        auto position = attributeNumbers(dataset_.id(), "position");
        origin.resize(rank_, 0.0);
        position.resize(rank_, 0.0);
        const auto order = attributeTexts(mesh, "dataOrder");
        if (!order.empty() && order[0] == "F") // labels and the like begin with the fastest axis
            for (auto* list : {&spacing, &origin, &position})
                std::reverse(list->begin(), list->end());
        if (!order.empty() && order[0] == "F")
            std::reverse(labels.begin(), labels.end());
        if (labels.size() != rank_ || !orderByLabels(labels, placement_.axisOf))
            placement_.notes.push_back("the axes are not labelled x, y, z: the last one is taken for x");
        for (int axis = 0; axis < 3; ++axis) {
            const int own = placement_.axisOf[static_cast<std::size_t>(axis)];
            if (own < 0)
                continue;
            const auto index = static_cast<std::size_t>(own);
            placement_.geometry.spacing[axis] = spacing[index];
            placement_.geometry.origin[axis] = origin[index] + position[index] * spacing[index];
        }
        noteUnits(mesh);
        return true;
    }

    void noteUnits(hid_t mesh) {
        const auto lengths = attributeNumbers(mesh, "gridUnitSI");
        if (lengths.size() == 1)
            placement_.lengthUnit = lengthUnitOfMetres(lengths[0]);
        if (lengths.size() == 1 && placement_.lengthUnit.empty())
            placement_.notes.push_back("lengths are in units of " + std::to_string(lengths[0]) + " m (gridUnitSI)");
        const auto values = attributeNumbers(dataset_.id(), "unitSI");
        if (values.size() == 1 && values[0] != 1.0)
            placement_.notes.push_back("values are stored in units of " + std::to_string(values[0]) + " SI (unitSI)");
    }

    bool placeByElementSize() {
        const auto size = attributeNumbers(dataset_.id(), "element_size_um"); // z, y, x
        if (size.size() != 3)
            return false;
        if (!arePositive(size)) {
            placement_.notes.push_back("element_size_um is not positive: spacing 1 is taken");
            return true;
        }
        placement_.geometry.spacing = {size[2], size[1], size[0]};
        placement_.lengthUnit = "µm";
        return true;
    }

    // Image data: the attributes of the group are in the order x, y, z; data sets have z slowest.
    bool placeAsVtk() {
        const bool isOfCells = path_.starts_with(kVtkCells);
        if ((!isOfCells && !path_.starts_with(kVtkPoints)) || rank_ > 3)
            return false;
        const Hdf5Handle group(H5Oopen(file_, "/VTKHDF", H5P_DEFAULT), H5Oclose);
        const auto spacing = attributeNumbers(group.id(), "Spacing"), origin = attributeNumbers(group.id(), "Origin"),
                   direction = attributeNumbers(group.id(), "Direction"),
                   extent = attributeNumbers(group.id(), "WholeExtent");
        if (spacing.size() != 3 || !arePositive(spacing))
            return false;
        GridGeometry& geometry = placement_.geometry;
        glm::dvec3 first(isOfCells ? 0.5 : 0.0); // of the first sample, in spacings
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            geometry.spacing[axis] = spacing[i];
            if (extent.size() == 6)
                first[axis] += extent[2 * i];
            for (std::size_t row = 0; row < 3 && direction.size() == 9; ++row)
                geometry.direction[axis][static_cast<int>(row)] = direction[3 * row + i];
            if (origin.size() == 3)
                geometry.origin[axis] = origin[i];
        }
        geometry.origin += geometry.direction * (geometry.spacing * first);
        return true;
    }

    // MINC 2: each axis has a variable with start, step and direction; its coordinates have x to the right and y to the
    // front, ours to the left and to the back.
    bool placeAsMinc() {
        constexpr std::string_view kImages = "/minc-2.0/image/";
        const auto order = attributeTexts(dataset_.id(), "dimorder");
        if (!path_.starts_with(kImages) || order.size() != 1)
            return false;
        const glm::dvec3 flip(-1.0, -1.0, 1.0);
        std::array<int, 3> axisOf{-1, -1, -1};
        GridGeometry geometry;
        std::set<std::string> units;
        std::vector<std::string> names;
        for (std::size_t at = 0; at <= order[0].size() && names.size() < 8;) {
            const std::size_t end = std::min(order[0].find(',', at), order[0].size());
            names.emplace_back(trimmed(std::string_view(order[0]).substr(at, end - at)));
            at = end + 1;
        }
        for (std::size_t i = 0; i < names.size(); ++i) {
            const int axis = names[i].size() == 6 && names[i].ends_with("space") ? names[i][0] - 'x' : -1;
            if (axis < 0 || axis > 2 || axisOf[static_cast<std::size_t>(axis)] >= 0 || names.size() != rank_)
                return false;
            axisOf[static_cast<std::size_t>(axis)] = static_cast<int>(i);
            const Hdf5Handle variable(H5Oopen(file_, ("/minc-2.0/dimensions/" + names[i]).c_str(), H5P_DEFAULT),
                                      H5Oclose);
            const auto step = attributeNumbers(variable.id(), "step"), start = attributeNumbers(variable.id(), "start"),
                       cosines = attributeNumbers(variable.id(), "direction_cosines");
            if (step.size() != 1 || !std::isfinite(step[0]) || step[0] == 0.0)
                return false;
            glm::dvec3 direction(axis == 0, axis == 1, axis == 2);
            if (cosines.size() == 3)
                direction = {cosines[0], cosines[1], cosines[2]};
            geometry.spacing[axis] = std::abs(step[0]);
            geometry.direction[axis] = (step[0] < 0.0 ? -1.0 : 1.0) * flip * direction + 0.0; // no negative zeros
            geometry.origin += (start.size() == 1 ? start[0] : 0.0) * flip * direction;
            const auto unit = attributeTexts(variable.id(), "units");
            units.insert(unit.size() == 1 ? lengthUnitOf(unit[0]) : std::string());
        }
        geometry.origin += 0.0;
        placement_.axisOf = axisOf;
        placement_.geometry = geometry;
        placement_.lengthUnit = units.size() == 1 ? *units.begin() : std::string();
        placement_.notes.push_back(
            "MINC: samples are taken as they are stored; its ranges of real values are not applied");
        return true;
    }

    // What a file states of distances in a way that is not known here is not kept quiet about.
    void noteUnknown() {
        constexpr std::string_view kWords[] = {"spacing",        "voxel",    "resolution", "pixel_size",
                                               "pixelsize",      "step",     "scale",      "element",
                                               "dimension_list", "dimorder", "voxel_size", "delta"};
        const Hdf5Handle root(H5Oopen(file_, "/", H5P_DEFAULT), H5Oclose);
        std::set<std::string> found;
        for (const hid_t object : {dataset_.id(), parent_.id(), root.id()})
            for (const std::string& name : attributeNames(object)) {
                const std::string lower = lowerCase(name);
                if (std::any_of(std::begin(kWords), std::end(kWords),
                                [&](std::string_view word) { return lower.find(word) != std::string::npos; }))
                    found.insert(inQuotes(name));
            }
        if (found.empty())
            return;
        std::string names;
        for (const std::string& name : found)
            names += (names.empty() ? "" : ", ") + name;
        placement_.notes.push_back("what the file states about distances is not understood (" + names +
                                   "): spacing 1 is taken");
    }

    Placement placement_;
    hid_t file_;
    std::string path_;
    Hdf5Handle dataset_, parent_;
    std::size_t rank_ = 0;
};

} // namespace

Placement placementOf(hid_t file, const Hdf5Dataset& dataset) { return PlacementReader(file, dataset).run(); }

} // namespace isoslider::io
