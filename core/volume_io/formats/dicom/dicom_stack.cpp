#include "core/volume_io/formats/dicom/dicom_stack.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include <glm/geometric.hpp>

#include "core/base/plain_text.h"
#include "core/volume_io/formats/slice_line.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

using Slices = std::vector<DicomSlice>;

constexpr std::size_t kMaxGroups = 1000; ///< of one series
constexpr double kSamePlace = 0.01; ///< of the distance between samples
constexpr double kEven = 0.02; ///< of the slice spacing
constexpr double kNearlyEven = 0.05; ///< likewise, with a note
constexpr int kIntended = 3; ///< wider gaps beside each other: no slice is missing
constexpr double kStraight = 0.1; ///< of the distance between samples
constexpr double kMaxSlope = 2.0; ///< of a gantry: some 63 degrees

std::string shortNumber(double value) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << value;
    return text.str();
}

/// Slices of one group, or of one part of it.
class Stacker {
public:
    explicit Stacker(const std::vector<DicomImage>& images) : images_(images) {}

    std::vector<DicomStack> build() {
        std::map<std::string, Slices> bySeries;
        for (std::size_t i = 0; i < images_.size(); ++i)
            for (std::size_t frame = 0; frame < images_[i].frames.size(); ++frame)
                bySeries[images_[i].series].push_back({i, frame});
        std::vector<std::pair<std::string, Slices>> series(bySeries.begin(), bySeries.end());
        std::ranges::stable_sort(series, {},
                                 [&](const auto& named) { return image(named.second.front()).seriesNumber; });
        std::vector<DicomStack> all;
        for (auto& [name, slices] : series) {
            std::vector<DicomStack> stacks = stacksOf(std::move(slices));
            const std::string uid = name.empty() ? "unnamed" : name;
            for (std::size_t i = 0; i < stacks.size(); ++i)
                stacks[i].field.name = stacks.size() == 1 ? uid : uid + '#' + std::to_string(i + 1);
            std::move(stacks.begin(), stacks.end(), std::back_inserter(all));
        }
        return all;
    }

private:
    const DicomImage& image(const DicomSlice& slice) const { return images_[slice.image]; }
    const DicomFrame& frame(const DicomSlice& slice) const { return images_[slice.image].frames[slice.frame]; }

    std::vector<DicomStack> stacksOf(Slices slices) {
        std::vector<std::string> notes = dropCopies(slices);
        std::vector<DicomStack> stacks;
        std::vector<Slices> groups;
        bool isTooMany = false;
        for (const DicomSlice& slice : slices) {
            // Neighbours mostly belong together: the last group first.
            const auto found = std::find_if(groups.rbegin(), groups.rend(),
                                            [&](const Slices& group) { return fitTogether(group.front(), slice); });
            if (found != groups.rend())
                found->push_back(slice);
            else if (groups.size() < kMaxGroups)
                groups.push_back({slice});
            else
                isTooMany = true;
        }
        if (isTooMany)
            notes.push_back("has more than " + std::to_string(kMaxGroups) + " stacks; the rest is left out");
        for (Slices& group : groups)
            for (DicomStack& stack : split(std::move(group))) {
                stack.notes.insert(stack.notes.begin(), notes.begin(), notes.end());
                stacks.push_back(std::move(stack));
            }
        return stacks;
    }

    // The same image in two files.
    std::vector<std::string> dropCopies(Slices& slices) const {
        std::set<std::pair<std::string, std::size_t>> known;
        std::size_t copies = 0;
        std::string first;
        std::erase_if(slices, [&](const DicomSlice& slice) {
            const std::string& uid = image(slice).instanceUid;
            if (uid.empty() || known.insert({uid, slice.frame}).second)
                return false;
            if (copies++ == 0)
                first = image(slice).path.filename().string();
            return true;
        });
        if (copies == 0)
            return {};
        return {counted(copies, "slice") + " left out, copies of others by their instance UID, the first in " +
                inQuotes(first)};
    }

    bool fitTogether(const DicomSlice& a, const DicomSlice& b) const {
        if (a.image == b.image && !image(a).hasFramePositions)
            return true;
        const DicomPixels &p = image(a).pixels, &q = image(b).pixels;
        if (p.rows != q.rows || p.columns != q.columns || p.components != q.components || p.type != q.type ||
            p.photometric != q.photometric)
            return false;
        const DicomFrame &f = frame(a), &g = frame(b);
        if (f.position.has_value() != g.position.has_value() || f.directions.has_value() != g.directions.has_value() ||
            f.spacing.has_value() != g.spacing.has_value() || f.stack != g.stack)
            return false;
        if (f.directions)
            for (int i = 0; i < 2; ++i)
                if (!(glm::distance((*f.directions)[i], (*g.directions)[i]) < 1e-3))
                    return false;
        return !f.spacing || glm::distance(*f.spacing, *g.spacing) <= 1e-3 * glm::length(*f.spacing);
    }

    // --- slices at one place ---------------------------------------------------------------------------

    bool hasPlaces(const Slices& slices) const {
        const DicomFrame& first = frame(slices.front());
        return first.position && first.directions;
    }

    glm::dvec3 normalOf(const DicomSlice& slice) const {
        const auto& directions = *frame(slice).directions;
        return glm::cross(directions[0], directions[1]);
    }

    double sampleDistance(const DicomSlice& slice) const {
        const glm::dvec2 spacing = frame(slice).spacing.value_or(glm::dvec2(1.0));
        return std::min(spacing.x, spacing.y);
    }

    void sortByPlace(Slices& slices) const {
        if (!hasPlaces(slices)) {
            std::stable_sort(slices.begin(), slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
                return std::pair(image(a).instance, a.frame) < std::pair(image(b).instance, b.frame);
            });
            return;
        }
        const glm::dvec3 normal = normalOf(slices.front());
        std::stable_sort(slices.begin(), slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
            return glm::dot(*frame(a).position, normal) < glm::dot(*frame(b).position, normal);
        });
    }

    /// Lengths of the runs of sorted slices that lie at one place.
    std::vector<std::size_t> runs(const Slices& slices) const {
        std::vector<std::size_t> lengths;
        const glm::dvec3 normal = normalOf(slices.front());
        const double tolerance = kSamePlace * sampleDistance(slices.front());
        double begin = 0.0;
        for (const DicomSlice& slice : slices) {
            const double place = glm::dot(*frame(slice).position, normal);
            if (lengths.empty() || !(place - begin <= tolerance)) {
                lengths.push_back(0);
                begin = place;
            }
            ++lengths.back();
        }
        return lengths;
    }

    bool isPlain(Slices& slices) const {
        sortByPlace(slices);
        const auto lengths = runs(slices);
        return std::ranges::all_of(lengths, [](std::size_t length) { return length == 1; });
    }

    bool areAlike(const std::vector<Slices>& parts) const {
        for (const Slices& part : parts) {
            if (part.size() != parts.front().size())
                return false;
            for (std::size_t i = 0; i < part.size(); ++i)
                if (glm::distance(*frame(part[i]).position, *frame(parts.front()[i]).position) >
                    kStraight * sampleDistance(part[i]))
                    return false;
        }
        return true;
    }

    /// By the attributes whose bits are set; numbers by their size, else by name.
    std::vector<Slices> partsBy(unsigned attributes, const Slices& slices) const {
        std::map<std::vector<std::pair<double, std::string>>, Slices> parts;
        for (const DicomSlice& slice : slices) {
            std::vector<std::pair<double, std::string>> key;
            for (unsigned i = 0; i < static_cast<unsigned>(DicomSplit::Count); ++i)
                if ((attributes >> i & 1) != 0) {
                    const std::string& text = frame(slice).splits[i];
                    const auto numbers = words(text);
                    key.emplace_back(numbers.empty() ? 0.0 : parseReal(numbers[0]).value_or(0.0), text);
                }
            parts[key].push_back(slice);
        }
        std::vector<Slices> list;
        for (auto& [key, part] : parts)
            list.push_back(std::move(part));
        return list;
    }

    bool arePlain(std::vector<Slices>& parts) const {
        return parts.size() > 1 && std::ranges::all_of(parts, [&](Slices& part) { return isPlain(part); });
    }

    std::vector<DicomStack> split(Slices slices) const {
        if (!hasPlaces(slices)) {
            sortByPlace(slices);
            return {stack({std::move(slices)}, "")};
        }
        if (isPlain(slices))
            return {stack({std::move(slices)}, "")};
        constexpr auto kCount = static_cast<unsigned>(DicomSplit::Count);
        std::vector<std::pair<unsigned, std::string>> ways;
        unsigned varying = 0;
        const std::size_t firstRun = firstRepeated(slices);
        for (unsigned i = 0; i < kCount; ++i) {
            ways.emplace_back(1u << i, std::string(dicomSplitName(static_cast<DicomSplit>(i))));
            varying |= frame(slices[firstRun]).splits[i] != frame(slices[firstRun + 1]).splits[i] ? 1u << i : 0u;
        }
        ways.emplace_back(varying, "volumes");
        for (const bool needsAlike : {true, false})
            for (const auto& [attributes, name] : ways) {
                std::vector<Slices> parts = partsBy(attributes, slices);
                if (!arePlain(parts) || areAlike(parts) != needsAlike)
                    continue;
                if (needsAlike)
                    return {stack(std::move(parts), name)};
                std::vector<DicomStack> stacks;
                for (Slices& part : parts)
                    stacks.push_back(stack({std::move(part)}, ""));
                return stacks;
            }
        return {byOrder(std::move(slices))};
    }

    std::size_t firstRepeated(const Slices& slices) const {
        std::size_t at = 0;
        for (const std::size_t length : runs(slices)) {
            if (length > 1)
                return at;
            at += length;
        }
        return 0;
    }

    // Nothing distinguishes them but the order in which they were made.
    DicomStack byOrder(Slices slices) const {
        const auto lengths = runs(slices);
        const bool isRegular = std::ranges::all_of(lengths, [&](std::size_t n) { return n == lengths.front(); });
        if (!isRegular) {
            const std::size_t at = firstRepeated(slices);
            DicomStack made = stack({std::move(slices)}, "");
            const Slices& all = made.frames.front();
            made.field.problem = "slices " + inQuotes(image(all[at]).path.filename().string()) + " and " +
                                 inQuotes(image(all[at + 1]).path.filename().string()) +
                                 " lie at the same place, and nothing determines which of them belongs to the volume";
            return made;
        }
        std::vector<Slices> parts(lengths.front());
        for (std::size_t at = 0; at < slices.size(); at += parts.size()) {
            const auto begin = slices.begin() + static_cast<std::ptrdiff_t>(at);
            const auto end = begin + static_cast<std::ptrdiff_t>(parts.size());
            std::stable_sort(begin, end, [&](const DicomSlice& a, const DicomSlice& b) {
                return std::pair(image(a).instance, a.frame) < std::pair(image(b).instance, b.frame);
            });
            for (std::size_t i = 0; i < parts.size(); ++i)
                parts[i].push_back(slices[at + i]);
        }
        DicomStack made = stack(std::move(parts), "volumes");
        made.notes.push_back("several slices at each place, distinguished by their instance number only");
        return made;
    }

    // --- one stack ----------------------------------------------------------------------------------------

    DicomStack stack(std::vector<Slices> frames, const std::string& framesName) const {
        DicomStack made;
        made.frames = std::move(frames);
        const Slices& slices = made.frames.front();
        describe(made, framesName);
        std::set<std::string> notes;
        for (const Slices& part : made.frames)
            for (const DicomSlice& slice : part)
                for (const std::string& note : image(slice).notes)
                    if (notes.insert(note).second)
                        made.notes.push_back(note);
        made.type = typeOf(made);
        made.field.problem = hasPlaces(slices) ? place(made) : placeInOrder(made);
        made.field.dims = made.geometry.dims;
        made.field.isResampled = made.isTilted() || !made.places.empty();
        return made;
    }

    /// "axial ", "sagittal ", "coronal ", "oblique " by the normal's largest part, or nothing.
    std::string orientationName(const DicomSlice& slice) const {
        if (!frame(slice).directions)
            return "";
        constexpr const char* kNames[] = {"sagittal ", "coronal ", "axial "};
        const glm::dvec3 normal = normalOf(slice);
        for (int axis = 0; axis < 3; ++axis)
            if (std::abs(normal[axis]) > 0.8) // within 37 degrees, as a gantry may be tilted
                return kNames[axis];
        return "oblique ";
    }

    void describe(DicomStack& made, const std::string& framesName) const {
        const Slices& slices = made.frames.front();
        const DicomImage& first = image(slices.front());
        const DicomPixels& pixels = first.pixels;
        VolumeField& field = made.field;
        field.typeName = fileTypeName(pixels.type);
        field.components = pixels.components;
        if (pixels.components == 3)
            field.componentNames = pixels.photometric.starts_with("YBR_F")
                                       ? std::vector<std::string>{"Y", "Cb", "Cr"}
                                       : std::vector<std::string>{"red", "green", "blue"};
        field.frames = static_cast<std::int64_t>(made.frames.size());
        std::string title = first.description.empty() ? "no description" : first.description;
        if (!first.modality.empty())
            title += ", " + first.modality;
        title += ", " + counted(slices.size(), orientationName(slices.front()) + "slice") + " of " +
                 std::to_string(pixels.columns) + " x " + std::to_string(pixels.rows);
        if (field.frames > 1)
            title += ", " + std::to_string(field.frames) + ' ' + framesName;
        if (first.date.size() == 8)
            title += ", " + first.date.substr(0, 4) + '-' + first.date.substr(4, 2) + '-' + first.date.substr(6);
        field.title = oneLine(title);
    }

    // Slope and intercept that are whole keep integers integers, as far as all possible samples fit.
    ScalarType typeOf(const DicomStack& made) const {
        double least = 0.0, most = 0.0;
        bool isWhole = true, isRescaled = false;
        const DicomPixels& pixels = image(made.frames.front().front()).pixels;
        const ScalarType stored = memoryType(pixels.type);
        for (const Slices& part : made.frames)
            for (const DicomSlice& slice : part) {
                const double slope = frame(slice).slope.value_or(1.0), intercept = frame(slice).intercept.value_or(0.0);
                isRescaled = isRescaled || slope != 1.0 || intercept != 0.0;
                isWhole = isWhole && slope == std::floor(slope) && intercept == std::floor(intercept);
                const int bits = image(slice).pixels.bitsStored;
                const bool isSigned =
                    pixels.type == FileType::I8 || pixels.type == FileType::I16 || pixels.type == FileType::I32;
                const double low = isSigned ? -std::ldexp(1.0, bits - 1) : 0.0;
                const double high = std::ldexp(1.0, isSigned ? bits - 1 : bits) - 1.0;
                for (const double sample : {low, high}) {
                    least = std::min(least, slope * sample + intercept);
                    most = std::max(most, slope * sample + intercept);
                }
            }
        if (!isRescaled)
            return stored;
        if (stored == ScalarType::F64)
            return stored;
        if (isWhole && !isFloatType(stored) && least >= -32768.0 && most <= 32767.0)
            return ScalarType::I16;
        if (isWhole && !isFloatType(stored) && least >= -std::ldexp(1.0, 31) && most < std::ldexp(1.0, 31))
            return ScalarType::I32;
        return realType(stored);
    }

    static bool isDistance(double length) { return length > 0.0 && std::isfinite(length); }

    void setPlane(DicomStack& made) const {
        const Slices& slices = made.frames.front();
        const DicomFrame& first = frame(slices.front());
        const DicomPixels& pixels = image(slices.front()).pixels;
        GridGeometry& geometry = made.geometry;
        geometry.dims = {pixels.columns, pixels.rows, static_cast<std::int64_t>(slices.size())};
        made.hasMillimetres = first.spacing.has_value();
        if (first.spacing) {
            geometry.spacing.x = first.spacing->x;
            geometry.spacing.y = first.spacing->y;
        } else {
            made.notes.push_back("has no pixel spacing (0028,0030); 1 is assumed");
        }
        geometry.spacing.z = first.sliceSpacing.value_or(first.thickness.value_or(0.0));
        if (!isDistance(geometry.spacing.z)) {
            geometry.spacing.z = 1.0;
            if (slices.size() == 1 || !hasPlaces(slices))
                made.notes.push_back("has no slice thickness (0018,0050); 1 is assumed");
        }
    }

    std::string placeInOrder(DicomStack& made) const {
        setPlane(made);
        const Slices& slices = made.frames.front();
        if (slices.size() > 1)
            made.notes.push_back("slices have no position: they follow each other by instance and frame number, at "
                                 "the stated distance");
        const DicomFrame& first = frame(slices.front());
        if (first.position)
            made.geometry.origin = *first.position;
        return "";
    }

    // Empty, or why the slices make no volume.
    std::string place(DicomStack& made) const {
        setPlane(made);
        const Slices& slices = made.frames.front();
        const auto& directions = *frame(slices.front()).directions;
        const auto isUnit = [](const glm::dvec3& v) { return std::abs(glm::length(v) - 1.0) < 1e-2; };
        if (!isUnit(directions[0]) || !isUnit(directions[1]) || std::abs(glm::dot(directions[0], directions[1])) > 1e-2)
            return "image orientation (0020,0037): two perpendicular directions of length 1 expected";
        GridGeometry& geometry = made.geometry;
        if (!isDistance(geometry.spacing.x) || !isDistance(geometry.spacing.y))
            return "pixel spacing (0028,0030): two positive numbers expected";
        geometry.direction[0] = glm::normalize(directions[0]);
        geometry.direction[1] = glm::normalize(directions[1]);
        geometry.direction[2] = glm::normalize(glm::cross(directions[0], directions[1]));
        geometry.origin = *frame(slices.front()).position;
        if (slices.size() == 1)
            return "";
        const glm::dvec3 step =
            (*frame(slices.back()).position - geometry.origin) / static_cast<double>(slices.size() - 1);
        geometry.spacing.z = glm::dot(step, geometry.direction[2]);
        if (!std::isfinite(glm::length(step)))
            return "positions of slices (0020,0032) lie beyond what can be computed";
        if (std::string problem = findUneven(made, step); !problem.empty())
            return problem;
        if (!made.places.empty())
            return "";
        made.notes.push_back(counted(slices.size(), "slice") + " in the order of their positions, spacing from "
                                                               "these");
        return undoTilt(made, step);
    }

    std::string nameOf(const DicomSlice& slice) const {
        std::string name = inQuotes(image(slice).path.filename().string());
        return image(slice).frames.size() > 1 ? name + " frame " + std::to_string(slice.frame) : name;
    }

    std::string findUneven(DicomStack& made, const glm::dvec3& step) const {
        const Slices& slices = made.frames.front();
        const glm::dvec3& normal = made.geometry.direction[2];
        const double spacing = made.geometry.spacing.z;
        double worst = 0.0;
        std::vector<double> gaps;
        for (std::size_t i = 0; i < slices.size(); ++i) {
            const glm::dvec3 place = *frame(slices[i]).position;
            worst = std::max(worst,
                             std::abs(glm::dot(place - made.geometry.origin - static_cast<double>(i) * step, normal)));
            if (i > 0)
                gaps.push_back(glm::dot(place - *frame(slices[i - 1]).position, normal));
        }
        if (const std::size_t moved = findMovedSideways(made); moved < slices.size())
            return "slice " + nameOf(slices[moved]) + " is moved sideways: the slices do not lie along a line";
        if (worst <= kNearlyEven * spacing) {
            if (worst > kEven * spacing)
                made.notes.push_back("slices are not quite evenly spaced: positions are up to " + shortNumber(worst) +
                                     " mm away from those of the grid");
            return "";
        }
        const double middle = lowerMedian(gaps);
        const auto isMultiple = [&](double gap) {
            return std::lround(gap / middle) >= 1 && std::abs(gap / middle - std::round(gap / middle)) < 0.1;
        };
        // Where other gaps are of any width, a wide one is no sign of a missing slice.
        for (std::size_t i = 0; i < gaps.size() && std::ranges::all_of(gaps, isMultiple); ++i) {
            const double ratio = gaps[i] / middle;
            if (ratio > 1.5 && runOf(gaps, i) < kIntended)
                return "slices are missing: " + std::to_string(std::lround(ratio) - 1) + " between " +
                       nameOf(slices[i]) + " and " + nameOf(slices[i + 1]) + ", " + shortNumber(gaps[i]) +
                       " mm apart where others are " + shortNumber(middle);
        }
        const glm::dvec3 whole = *frame(slices.back()).position - made.geometry.origin;
        if (glm::length(whole - glm::dot(whole, normal) * normal) > kStraight * sampleDistance(slices.front()))
            return "slices are unevenly spaced and moved sideways, as by a tilted gantry: that is not read";
        spaceEvenly(made, *std::ranges::min_element(gaps), *std::ranges::max_element(gaps));
        return "";
    }

    // The slice that lies farthest off the line of the others, or their number if all lie on one.
    std::size_t findMovedSideways(const DicomStack& made) const {
        std::vector<glm::dvec3> places; // across, across, along
        for (const DicomSlice& slice : made.frames.front())
            places.push_back(glm::transpose(made.geometry.direction) * (*frame(slice).position - made.geometry.origin));
        return findOffLine(places, kStraight * sampleDistance(made.frames.front().front()));
    }

    /// How many gaps beside each other are as wide as this one.
    static int runOf(const std::vector<double>& gaps, std::size_t at) {
        const auto isAlike = [&](std::size_t i) { return std::abs(gaps[i] - gaps[at]) <= 0.1 * gaps[at]; };
        int count = 1;
        for (std::size_t i = at; i-- > 0 && isAlike(i);)
            ++count;
        for (std::size_t i = at + 1; i < gaps.size() && isAlike(i); ++i)
            ++count;
        return count;
    }

    // A grid as fine as the finest slices, with at most four planes for each.
    void spaceEvenly(DicomStack& made, double least, double most) const {
        const Slices& slices = made.frames.front();
        GridGeometry& geometry = made.geometry;
        const double extent = geometry.spacing.z * static_cast<double>(slices.size() - 1);
        geometry.spacing.z = std::max(least, geometry.spacing.z / 4.0);
        geometry.dims[2] = static_cast<std::int64_t>(std::floor(extent / geometry.spacing.z + 1e-6)) + 1;
        for (const DicomSlice& slice : slices)
            made.places.push_back(glm::dot(*frame(slice).position - geometry.origin, geometry.direction[2]) /
                                  geometry.spacing.z);
        made.notes.push_back(counted(slices.size(), "slice") + " in the order of their positions, " +
                             shortNumber(least) + " to " + shortNumber(most) + " mm apart: linearly interpolated to " +
                             std::to_string(geometry.dims[2]) + " of even spacing");
        made.type = realType(made.type);
    }

    std::string undoTilt(DicomStack& made, const glm::dvec3& step) const {
        GridGeometry& geometry = made.geometry;
        const auto slices = static_cast<double>(made.frames.front().size() - 1);
        const glm::dvec2 along(glm::dot(step, geometry.direction[0]), glm::dot(step, geometry.direction[1]));
        const glm::dvec2 shift(along.x / geometry.spacing.x, along.y / geometry.spacing.y);
        if (slices * glm::length(shift) < kStraight)
            return "";
        const double sideways = slices * std::max(std::abs(shift.x), std::abs(shift.y)); // in samples
        if (!(glm::length(along) <= kMaxSlope * geometry.spacing.z) || !(sideways <= static_cast<double>(kMaxDim)))
            return "the slices lie so far beside each other that they make no volume";
        made.shift = shift;
        for (int axis = 0; axis < 2; ++axis) {
            const double last = slices * shift[axis];
            made.firstSample[axis] = std::floor(std::min(0.0, last));
            const double end = std::ceil(static_cast<double>(geometry.dims[axis] - 1) + std::max(0.0, last));
            geometry.dims[axis] = static_cast<std::int64_t>(end - made.firstSample[axis]) + 1;
            geometry.origin += geometry.direction[axis] * (made.firstSample[axis] * geometry.spacing[axis]);
        }
        const double angle = std::atan2(glm::length(along), geometry.spacing.z) * 180.0 / 3.14159265358979323846;
        made.notes.push_back("the gantry was tilted by " + shortNumber(angle) +
                             " degrees: slices are moved back in "
                             "their planes, linearly interpolated; what lies outside them is missing");
        made.type = realType(made.type);
        return "";
    }

    const std::vector<DicomImage>& images_;
};

} // namespace

std::vector<DicomStack> buildDicomStacks(const std::vector<DicomImage>& images) { return Stacker(images).build(); }

} // namespace isoslider::io
