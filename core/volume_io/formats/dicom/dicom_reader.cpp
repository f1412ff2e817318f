#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>
#include <type_traits>

#include "core/base/folders.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/dicom/dicom_folder.h"
#include "core/volume_io/formats/dicom/dicom_pixels.h"
#include "core/volume_io/formats/dicom/dicom_stack.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/volume_choice.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxFiles = 65536;

/// What a file or folder holds.
struct Collection {
    std::vector<DicomImage> images;
    std::vector<DicomStack> stacks;
    std::vector<std::string> notes;
};

Result<Collection> collectFolder(const fs::path& folder, std::uint64_t memoryBytes) {
    auto listed = listFiles(folder, {kMaxDicomDepth, kMaxFiles + 1});
    if (!listed.isOk())
        return std::move(listed).error();
    const std::vector<fs::path>& files = listed.value();
    if (files.size() > kMaxFiles)
        return makeError(ErrorCode::InvalidArgument,
                         "holds more than " + std::to_string(kMaxFiles) + " files; open a folder of fewer", folder);
    Collection found;
    std::size_t leftOut = 0;
    std::string reason;
    for (const fs::path& path : files) {
        auto image = beginsAsDicom(path) ? readDicomImage(path, memoryBytes)
                                         : Result<DicomImage>(makeError(ErrorCode::InvalidArgument, "is not DICOM"));
        if (image.isOk()) {
            found.images.push_back(std::move(image).value());
        } else if (leftOut++ == 0) {
            reason = inQuotes(path.filename().string()) + " " + image.error().message;
        }
    }
    if (leftOut > 0)
        found.notes.push_back(std::to_string(leftOut) + (leftOut == 1 ? " file is" : " files are") +
                              " left out; the first: " + reason);
    if (found.images.empty())
        return makeError(ErrorCode::InvalidArgument, "holds no DICOM image that can be read: " + reason, folder);
    return found;
}

Result<Collection> collect(const fs::path& path, std::uint64_t memoryBytes) {
    Collection found;
    if (isFolder(path)) {
        auto folder = collectFolder(path, memoryBytes);
        if (!folder.isOk())
            return folder;
        found = std::move(folder).value();
    } else {
        auto image = readDicomImage(path, memoryBytes);
        if (!image.isOk())
            return std::move(image).error();
        if (image.value().frames.size() == 1 && image.value().frames.front().position)
            found.notes.push_back("is one slice; its folder opens as the series");
        found.images.push_back(std::move(image).value());
    }
    found.stacks = buildDicomStacks(found.images);
    return found;
}

VolumeContents contentsOf(const Collection& found) {
    VolumeContents contents;
    contents.format = "DICOM";
    for (const DicomStack& stack : found.stacks)
        contents.fields.push_back(stack.field);
    const auto opens = std::ranges::find_if(contents.fields, [](const auto& field) { return field.problem.empty(); });
    contents.preferred = opens == contents.fields.end() ? 0 : static_cast<std::size_t>(opens - contents.fields.begin());
    return contents;
}

/// Slices decoded as they are asked for.
class DicomSource final : public VolumeSource {
public:
    DicomSource(std::vector<DicomImage> images, DicomStack stack, VolumeInfo info, const Choice& choice,
                std::uint64_t memoryBytes)
        : images_(std::move(images)),
          stack_(std::move(stack)),
          info_(std::move(info)),
          slices_(stack_.frames[static_cast<std::size_t>(choice.frame)]),
          component_(choice.component),
          memoryBytes_(memoryBytes),
          openImage_(images_.size()),
          heldSlices_{slices_.size(), slices_.size()} {
        info_.type = stack_.type;
        if (component_ == kMagnitude)
            info_.type = realType(info_.type);
    }

    const VolumeInfo& info() const override { return info_; }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        const GridDims& dims = info_.geometry.dims;
        ISO_CHECK(zBegin >= 0 && zBegin <= zEnd && zEnd <= dims[2]);
        const std::size_t planeBytes = static_cast<std::size_t>(dims[0] * dims[1]) * scalarTypeSizeBytes(info_.type);
        ISO_CHECK(out.size() == planeBytes * static_cast<std::size_t>(zEnd - zBegin));
        for (std::int64_t z = zBegin; z < zEnd; ++z)
            ISO_TRY(readSlice(static_cast<std::size_t>(z),
                              out.subspan(static_cast<std::size_t>(z - zBegin) * planeBytes, planeBytes)));
        return {};
    }

private:
    Status readSlice(std::size_t z, std::span<std::byte> out) {
        if (!stack_.places.empty())
            return blendSlices(static_cast<double>(z), out);
        if (!stack_.isTilted())
            return loadSlice(z, out);
        const DicomPixels& pixels = images_[slices_[z].image].pixels;
        auto& plane = planes_[0];
        plane.resize(static_cast<std::size_t>(pixels.rows * pixels.columns) * scalarTypeSizeBytes(info_.type));
        ISO_TRY(loadSlice(z, plane));
        visitFloat([&](auto sample) { moveBack<decltype(sample)>(pixels, static_cast<double>(z), out); });
        return {};
    }

    /// Slope and intercept applied, in the type of info().
    Status loadSlice(std::size_t index, std::span<std::byte> out) {
        const DicomSlice& slice = slices_[index];
        if (slice.image != openImage_) {
            auto opened = openDicomFrames(images_[slice.image], memoryBytes_);
            if (!opened.isOk())
                return std::move(opened).error();
            reader_ = std::move(opened).value();
            openImage_ = slice.image;
        }
        ISO_TRY(reader_->read(slice.frame, samples_));
        visitScalarType(info_.type, [&](auto sample) {
            convertFrom<decltype(sample)>(images_[slice.image].pixels.type, slice, out);
        });
        return {};
    }

    /// Calls `function` with a sample of info()'s type, which is f32 or f64.
    template <class Function>
    void visitFloat(const Function& function) const {
        if (info_.type == ScalarType::F64)
            function(double{});
        else
            function(float{});
    }

    /// A plane between two slices that are not evenly spaced.
    Status blendSlices(double z, std::span<std::byte> out) {
        const auto above = std::upper_bound(stack_.places.begin(), stack_.places.end(), z);
        const auto next = std::clamp<std::size_t>(static_cast<std::size_t>(above - stack_.places.begin()), 1,
                                                  stack_.places.size() - 1);
        const double begin = stack_.places[next - 1], end = stack_.places[next];
        const double share = std::clamp((z - begin) / (end - begin), 0.0, 1.0);
        // Neighbours lie in different ones of the two planes, and stay there for the next call.
        for (const std::size_t slice : {next - 1, next}) {
            auto& plane = planes_[slice % 2];
            if (heldSlices_[slice % 2] == slice && plane.size() == out.size())
                continue;
            plane.resize(out.size());
            heldSlices_[slice % 2] = slices_.size();
            ISO_TRY(loadSlice(slice, plane));
            heldSlices_[slice % 2] = slice;
        }
        visitFloat([&](auto sample) {
            using Out = decltype(sample);
            for (std::size_t i = 0; i < out.size(); i += sizeof(Out)) {
                Out a, b;
                std::memcpy(&a, planes_[(next - 1) % 2].data() + i, sizeof a);
                std::memcpy(&b, planes_[next % 2].data() + i, sizeof b);
                const Out value = share == 0.0 ? a : share == 1.0 ? b : static_cast<Out>((1.0 - share) * a + share * b);
                std::memcpy(out.data() + i, &value, sizeof value);
            }
        });
        return {};
    }

    template <class Out>
    void convertFrom(FileType stored, const DicomSlice& slice, std::span<std::byte> out) const {
        switch (stored) {
            case FileType::U8: return convert<std::uint8_t, Out>(slice, out);
            case FileType::I8: return convert<std::int8_t, Out>(slice, out);
            case FileType::U16: return convert<std::uint16_t, Out>(slice, out);
            case FileType::I16: return convert<std::int16_t, Out>(slice, out);
            case FileType::U32: return convert<std::uint32_t, Out>(slice, out);
            case FileType::I32: return convert<std::int32_t, Out>(slice, out);
            case FileType::F32: return convert<float, Out>(slice, out);
            default: return convert<double, Out>(slice, out);
        }
    }

    template <class In, class Out>
    void convert(const DicomSlice& slice, std::span<std::byte> out) const {
        const DicomImage& image = images_[slice.image];
        const DicomFrame& frame = image.frames[slice.frame];
        const double slope = frame.slope.value_or(1.0), intercept = frame.intercept.value_or(0.0);
        const bool isRescaled = slope != 1.0 || intercept != 0.0;
        const std::size_t count = out.size() / sizeof(Out);
        const auto components = static_cast<std::size_t>(image.pixels.components);
        const std::size_t stride = reader_->isPlanar() ? 1 : components;
        const std::size_t next = reader_->isPlanar() ? count : 1; // from one component to the other
        const auto at = [&](std::size_t i, std::size_t component) {
            In raw;
            std::memcpy(&raw, samples_.data() + (i * stride + component * next) * sizeof(In), sizeof raw);
            return raw;
        };
        const auto first = static_cast<std::size_t>(std::max(component_, 0));
        for (std::size_t i = 0; i < count; ++i) {
            Out value{};
            if (component_ == kMagnitude) {
                double squares = 0.0;
                for (std::size_t c = 0; c < components; ++c) {
                    const double part = slope * static_cast<double>(at(i, c)) + intercept;
                    squares += part * part;
                }
                value = static_cast<Out>(std::sqrt(squares));
            } else if (isRescaled) {
                value = static_cast<Out>(slope * static_cast<double>(at(i, first)) + intercept);
            } else {
                value = static_cast<Out>(at(i, first));
            }
            std::memcpy(out.data() + i * sizeof(Out), &value, sizeof value);
        }
    }

    /// Takes the first of planes_ to where slice z belongs in the grid. Samples the slice does not reach are
    /// missing.
    template <class Out>
    void moveBack(const DicomPixels& pixels, double z, std::span<std::byte> out) const {
        const GridDims& dims = info_.geometry.dims;
        const double x0 = stack_.firstSample.x - z * stack_.shift.x, y0 = stack_.firstSample.y - z * stack_.shift.y;
        const auto sample = [&](std::int64_t x, std::int64_t y) {
            Out value;
            std::memcpy(&value, planes_[0].data() + static_cast<std::size_t>(x + y * pixels.columns) * sizeof(Out),
                        sizeof value);
            return static_cast<double>(value);
        };
        // Rounding must not lose the outermost row.
        constexpr double kSlack = 1e-6;
        for (std::int64_t j = 0; j < dims[1]; ++j)
            for (std::int64_t i = 0; i < dims[0]; ++i) {
                const double lastX = static_cast<double>(pixels.columns - 1),
                             lastY = static_cast<double>(pixels.rows - 1);
                double x = x0 + static_cast<double>(i), y = y0 + static_cast<double>(j);
                Out value = std::numeric_limits<Out>::quiet_NaN();
                if (x >= -kSlack && x <= lastX + kSlack && y >= -kSlack && y <= lastY + kSlack) {
                    x = std::clamp(x, 0.0, lastX);
                    y = std::clamp(y, 0.0, lastY);
                    const auto left = static_cast<std::int64_t>(x), top = static_cast<std::int64_t>(y);
                    const std::int64_t right = std::min(left + 1, pixels.columns - 1),
                                       below = std::min(top + 1, pixels.rows - 1);
                    const double u = x - static_cast<double>(left), v = y - static_cast<double>(top);
                    value = static_cast<Out>((1.0 - v) * ((1.0 - u) * sample(left, top) + u * sample(right, top)) +
                                             v * ((1.0 - u) * sample(left, below) + u * sample(right, below)));
                }
                std::memcpy(out.data() + static_cast<std::size_t>(i + j * dims[0]) * sizeof(Out), &value, sizeof value);
            }
    }

    std::vector<DicomImage> images_;
    DicomStack stack_;
    VolumeInfo info_;
    const std::vector<DicomSlice>& slices_;
    int component_;
    std::uint64_t memoryBytes_; ///< that of ReadOptions
    std::size_t openImage_;
    std::unique_ptr<DicomFrameReader> reader_;
    std::vector<std::byte> samples_;
    std::array<std::vector<std::byte>, 2> planes_;
    std::array<std::size_t, 2> heldSlices_;
};

std::vector<fs::path> slicesOf(const std::vector<DicomImage>& images, const DicomStack& stack, const Choice& choice) {
    std::vector<fs::path> files;
    for (const DicomSlice& slice : stack.frames[static_cast<std::size_t>(choice.frame)])
        files.push_back(images[slice.image].path);
    return filesInFolder(std::move(files));
}

} // namespace

Result<VolumeContents> listDicom(const fs::path& path, const ReadOptions& options) {
    const auto found = collect(path, options.memoryBytes);
    if (!found.isOk())
        return found.error();
    return contentsOf(found.value());
}

Result<std::unique_ptr<VolumeSource>> openDicom(const fs::path& path, const ReadOptions& options) {
    auto found = collect(path, options.memoryBytes);
    if (!found.isOk())
        return std::move(found).error();
    const auto chosen = chooseField(contentsOf(found.value()), options, path);
    if (!chosen.isOk())
        return chosen.error();
    DicomStack stack = std::move(found.value().stacks[chosen.value()]);
    const auto choice = chooseIn(stack.field, options, path);
    if (!choice.isOk())
        return choice.error();
    VolumeInfo info;
    info.format = "DICOM";
    if (isFolder(path))
        info.dataFiles = slicesOf(found.value().images, stack, choice.value());
    info.fieldName = stack.field.name;
    info.fieldTitle = stack.field.title;
    if (stack.hasMillimetres)
        info.lengthUnit = "mm";
    info.geometry = stack.geometry;
    info.isPatientSpace = true;
    info.notes = stack.notes;
    info.notes.insert(info.notes.end(), found.value().notes.begin(), found.value().notes.end());
    const auto dims = checkDims(info.geometry.dims, "rows, columns, slices", path);
    if (!dims.isOk())
        return dims.error();
    ISO_TRY(checkGeometry(info.geometry, "pixel spacing, positions", path));
    return std::unique_ptr<VolumeSource>(std::make_unique<DicomSource>(
        std::move(found).value().images, std::move(stack), std::move(info), choice.value(), options.memoryBytes));
}

} // namespace isoslider::io
