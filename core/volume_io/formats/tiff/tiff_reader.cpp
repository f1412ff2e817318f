#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <system_error>

#include <tiff.h>

#include "core/base/folders.h"
#include "core/grid/length_unit.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/tiff/tiff_file.h"
#include "core/volume_io/formats/tiff/tiff_folder.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/sample_source.h"
#include "core/volume_io/volume_choice.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

/// How the pages of a file make volumes: page = channel * strides[0] + z * strides[1] + frame * strides[2].
struct PageOrder {
    std::int64_t channels = 1, slices = 1, frames = 1;
    std::int64_t strides[3] = {0, 1, 0};

    std::int64_t page(std::int64_t channel, std::int64_t z, std::int64_t frame) const {
        return channel * strides[0] + z * strides[1] + frame * strides[2];
    }
};

/// What a file or folder holds.
struct Stack {
    std::vector<fs::path> files; ///< one, or those of a folder in order
    TiffPage page; ///< what all are like
    PageOrder order;
    bool isOnePageForAll = false; ///< samples of all pages follow the first one's
    VolumeInfo info;
    int components() const { return page.components * static_cast<int>(order.channels); }
};

void noteOrder(Stack& stack) {
    const auto name = [](const fs::path& path) { return inQuotes(path.filename().string()); };
    const auto& files = stack.files;
    stack.info.notes.push_back(std::to_string(files.size()) + " slices in the natural order of their names, from " +
                               name(files.front()) + " to " + name(files.back()));
    for (std::size_t i = 0; i + 1 < files.size(); ++i) {
        const std::int64_t number = numberInName(files[i]), next = numberInName(files[i + 1]);
        if (number >= 0 && next > number + 1) {
            stack.info.notes.push_back("the numbers of the slices have a gap between " + name(files[i]) + " and " +
                                       name(files[i + 1]) + "; if a slice is missing there, the volume is too short");
            return;
        }
    }
}

// --- what writers put into the description
// --------------------------------------------------------------------

/// The value of "key=..." on a separate line, as ImageJ writes it.
std::string_view imageJValue(std::string_view text, std::string_view key) {
    for (std::size_t at = 0; at < text.size();) {
        const std::string_view line = text.substr(at, text.find('\n', at) - at);
        if (line.size() > key.size() && line.starts_with(key) && line[key.size()] == '=')
            return trimmed(line.substr(key.size() + 1));
        at += line.size() + 1;
    }
    return {};
}

/// An attribute of the first element `Pixels`, as OME writes it.
std::string_view omeValue(std::string_view text, std::string_view key) {
    const std::size_t begin = text.find("<Pixels ");
    if (begin == std::string_view::npos)
        return {};
    const std::string_view element = text.substr(begin, text.find('>', begin) - begin);
    const std::string start = " " + std::string(key) + "=\"";
    const std::size_t at = element.find(start);
    if (at == std::string_view::npos)
        return {};
    const std::string_view rest = element.substr(at + start.size());
    return rest.substr(0, rest.find('"'));
}

std::int64_t countOf(std::string_view text) {
    const auto count = parseInteger(text);
    return count && *count >= 1 && *count <= kMaxDim ? *count : 1;
}

void setSpacing(VolumeInfo& info, int axis, double spacing) {
    if (std::isfinite(spacing) && spacing > 0.0)
        info.geometry.spacing[axis] = spacing;
}

/// Pages of ImageJ's: channels fastest, then slices, then frames.
void readImageJ(const TiffFile& file, Stack& stack, std::int64_t pages) {
    const std::string_view text = file.imageDescription();
    PageOrder order{countOf(imageJValue(text, "channels")), countOf(imageJValue(text, "slices")),
                    countOf(imageJValue(text, "frames"))};
    order.strides[0] = 1;
    order.strides[1] = order.channels;
    order.strides[2] = order.channels * order.slices;
    if (order.channels * order.slices * order.frames == pages)
        stack.order = order;
    const std::string unit(imageJValue(text, "unit"));
    if (unit.empty() && imageJValue(text, "spacing").empty())
        return;
    for (int axis = 0; axis < 2; ++axis)
        setSpacing(stack.info, axis, 1.0 / file.resolution(axis));
    setSpacing(stack.info, 2, std::abs(parseReal(imageJValue(text, "spacing")).value_or(1.0)));
    stack.info.lengthUnit = lengthUnitOf(unit);
    if (stack.info.lengthUnit.empty())
        stack.info.notes.push_back("the spacing is in " + (unit.empty() ? "an unknown unit" : inQuotes(unit)));
}

void readOme(const TiffFile& file, Stack& stack, std::int64_t pages) {
    const std::string_view text = file.imageDescription();
    const std::string_view names = omeValue(text, "DimensionOrder");
    PageOrder order{countOf(omeValue(text, "SizeC")), countOf(omeValue(text, "SizeZ")),
                    countOf(omeValue(text, "SizeT"))};
    if (order.channels % stack.page.components == 0)
        order.channels /= stack.page.components; // those beside each other in one page
    const std::int64_t sizes[] = {order.channels, order.slices, order.frames};
    std::int64_t stride = 1;
    for (const char name : names.size() == 5 ? names.substr(2) : std::string_view("ZCT")) {
        const std::size_t which = std::string_view("CZT").find(name);
        if (which == std::string_view::npos)
            return;
        order.strides[which] = stride;
        stride *= sizes[which];
    }
    if (stride == pages)
        stack.order = order;
    else
        stack.info.notes.push_back("OME names " + std::to_string(stride) + " pages, the file has " +
                                   std::to_string(pages) + ", which are taken as slices");
    constexpr const char* kSizes[] = {"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"};
    std::string units;
    std::set<std::string> known;
    for (int axis = 0; axis < 3; ++axis) {
        const auto size = parseReal(omeValue(text, kSizes[axis]));
        if (!size)
            continue;
        setSpacing(stack.info, axis, *size);
        const std::string_view unit = omeValue(text, std::string(kSizes[axis]) + "Unit");
        units += (units.empty() ? "" : ", ") + (unit.empty() ? std::string("micrometres") : inQuotes(unit));
        known.insert(unit.empty() ? "µm" : lengthUnitOf(unit));
    }
    if (known.size() == 1)
        stack.info.lengthUnit = *known.begin();
    if (!units.empty() && stack.info.lengthUnit.empty())
        stack.info.notes.push_back("the spacing is in " + units);
}

// --- files and folders
// ----------------------------------------------------------------------------------------

void notePhotometric(Stack& stack) {
    if (stack.page.photometric == PHOTOMETRIC_MINISWHITE)
        stack.info.notes.push_back("the smallest samples are meant to look white; they are not inverted");
    if (stack.page.photometric == PHOTOMETRIC_PALETTE)
        stack.info.notes.push_back("samples are places in a table of colours, which is not applied");
}

Result<Stack> collectFile(const fs::path& path) {
    auto file = TiffFile::open(path);
    if (!file.isOk())
        return std::move(file).error();
    const TiffFile& tiff = *file.value();
    Stack stack;
    stack.files = {path};
    stack.page = tiff.pages().front();
    for (std::size_t i = 1; i < tiff.pages().size(); ++i)
        if (!tiff.pages()[i].isLike(stack.page))
            return refuseField(
                "page " + std::to_string(i + 1),
                "is " + tiff.pages()[i].description() + ", those before it are " + stack.page.description(), path);
    auto pages = static_cast<std::int64_t>(tiff.pages().size());
    const std::string_view text = tiff.imageDescription();
    const bool isImageJ = text.starts_with("ImageJ=");
    const std::int64_t stated = countOf(imageJValue(text, "images"));
    // Of stacks beyond 4 GiB ImageJ writes one directory, and all samples behind it.
    if (isImageJ && pages == 1 && stated > 1 && tiff.isPlain()) {
        const std::uint64_t available = tiff.bytes().sizeBytes() - stack.page.offset;
        if (available / stack.page.sizeBytes() < static_cast<std::uint64_t>(stated))
            return makeError(ErrorCode::Corruption,
                             "images=" + std::to_string(stated) + " of " + stack.page.description() +
                                 " do not fit the " + std::to_string(available) + " bytes behind the header",
                             path);
        stack.isOnePageForAll = true;
        pages = stated;
    }
    if (stack.page.depth > 1) {
        if (pages > 1)
            return refuseField("pages", "several, with " + std::to_string(stack.page.depth) + " slices in each", path);
        stack.isOnePageForAll = true;
        pages = stack.page.depth;
    }
    stack.order.slices = pages;
    if (isImageJ)
        readImageJ(tiff, stack, pages);
    else if (text.find("<OME") != std::string_view::npos)
        readOme(tiff, stack, pages);
    if (tiff.pagesLeftOut() > 0)
        stack.info.notes.push_back(std::to_string(tiff.pagesLeftOut()) + " reduced images or masks are left out");
    notePhotometric(stack);
    return stack;
}

Result<Stack> collectFolder(const fs::path& folder) {
    auto files = tiffFilesOf(folder);
    if (!files.isOk())
        return std::move(files).error();
    if (files.value().empty())
        return makeError(ErrorCode::InvalidArgument, "is a folder without TIFF files", folder);
    Stack stack;
    stack.files = std::move(files).value();
    for (std::size_t i = 0; i < stack.files.size(); ++i) {
        const auto file = TiffFile::open(stack.files[i]);
        if (!file.isOk())
            return file.error();
        const auto& pages = file.value()->pages();
        if (pages.size() != 1)
            return refuseField(
                "pages", "has " + std::to_string(pages.size()) + "; the slices of a folder are files of one page each",
                stack.files[i]);
        if (pages.front().depth > 1)
            return refuseField("image depth", "the slices of a folder are files of one slice each", stack.files[i]);
        if (i == 0)
            stack.page = pages.front();
        else if (!pages.front().isLike(stack.page))
            return refuseField("slice",
                               "is " + pages.front().description() + ", those before it in the folder are " +
                                   stack.page.description(),
                               stack.files[i]);
    }
    stack.order.slices = static_cast<std::int64_t>(stack.files.size());
    noteOrder(stack);
    notePhotometric(stack);
    return stack;
}

Result<Stack> collect(const fs::path& path) { return isFolder(path) ? collectFolder(path) : collectFile(path); }

/// Samples of the chosen pages, one after the other; holds one page at a time.
class PageStream final : public ByteStream {
public:
    PageStream(Stack stack, std::int64_t channel, std::int64_t frame)
        : stack_(std::move(stack)), channel_(channel), frame_(frame) {}

    std::uint64_t sizeBytes() const override {
        return stack_.page.sizeBytes() * static_cast<std::uint64_t>(stack_.order.slices);
    }

    Status readAt(std::uint64_t offset, std::span<std::byte> out) override {
        const std::uint64_t pageBytes = stack_.page.sizeBytes();
        while (!out.empty()) {
            const auto z = static_cast<std::int64_t>(offset / pageBytes);
            const std::uint64_t within = offset % pageBytes;
            const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), pageBytes - within));
            if (within == 0 && size == pageBytes) {
                ISO_TRY(load(z, out.first(size)));
            } else {
                if (z != heldZ_) {
                    held_.resize(pageBytes);
                    heldZ_ = -1;
                    ISO_TRY(load(z, held_));
                    heldZ_ = z;
                }
                std::memcpy(out.data(), held_.data() + within, size);
            }
            offset += size;
            out = out.subspan(size);
        }
        return {};
    }

private:
    Status load(std::int64_t z, std::span<std::byte> samples) {
        const bool isFolder = stack_.files.size() > 1;
        const std::size_t fileIndex = isFolder ? static_cast<std::size_t>(z) : 0;
        if (!file_ || fileIndex != openFile_) {
            auto opened = TiffFile::open(stack_.files[fileIndex]);
            if (!opened.isOk())
                return std::move(opened).error();
            file_ = std::move(opened).value();
            openFile_ = fileIndex;
        }
        const auto index = static_cast<std::size_t>(isFolder ? 0 : stack_.order.page(channel_, z, frame_));
        const std::size_t page = stack_.isOnePageForAll ? 0 : index;
        if (page >= file_->pages().size() || !file_->pages()[page].isLike(stack_.page))
            return makeError(ErrorCode::Corruption, "has changed while it was read", stack_.files[fileIndex]);
        if (!stack_.isOnePageForAll)
            return file_->readPage(page, samples);
        ISO_TRY(file_->bytes().readExactlyAt(stack_.page.offset + index * stack_.page.sizeBytes(), samples));
        const std::size_t size = fileTypeSizeBytes(stack_.page.type);
        if (file_->isBigEndian() == (std::endian::native == std::endian::little))
            for (std::size_t i = 0; i + size <= samples.size(); i += size)
                std::reverse(samples.data() + i, samples.data() + i + size);
        return {};
    }

    Stack stack_;
    std::int64_t channel_, frame_;
    std::unique_ptr<TiffFile> file_;
    std::size_t openFile_ = 0;
    std::vector<std::byte> held_;
    std::int64_t heldZ_ = -1;
};

VolumeField fieldOf(const Stack& stack) {
    VolumeField field;
    field.title = std::to_string(stack.order.slices) + (stack.order.slices == 1 ? " slice of " : " slices of ") +
                  stack.page.description();
    field.dims = {stack.page.columns, stack.page.rows, stack.order.slices};
    field.typeName = fileTypeName(stack.page.type);
    field.components = stack.components();
    field.hasMagnitude = stack.order.channels == 1;
    field.frames = stack.order.frames;
    const bool isColour = stack.page.photometric == PHOTOMETRIC_RGB || stack.page.photometric == PHOTOMETRIC_YCBCR;
    if (isColour && stack.order.channels == 1 && field.components == 3)
        field.componentNames = {"red", "green", "blue"};
    if (isColour && stack.order.channels == 1 && field.components == 4)
        field.componentNames = {"red", "green", "blue", "alpha"};
    return field;
}

} // namespace

Result<VolumeContents> listTiff(const fs::path& path, const ReadOptions& /*options*/) {
    const auto found = collect(path);
    if (!found.isOk())
        return found.error();
    VolumeContents contents;
    contents.format = "TIFF";
    contents.fields.push_back(fieldOf(found.value()));
    return contents;
}

Result<std::unique_ptr<VolumeSource>> openTiff(const fs::path& path, const ReadOptions& options) {
    auto found = collect(path);
    if (!found.isOk())
        return std::move(found).error();
    Stack& stack = found.value();
    const auto choice = chooseInOnlyField(fieldOf(stack), options, path);
    if (!choice.isOk())
        return choice.error();
    const std::int64_t sizes[] = {stack.page.columns, stack.page.rows, stack.order.slices};
    const auto dims = checkDims(sizes, "columns, rows, slices", path);
    if (!dims.isOk())
        return dims.error();
    VolumeInfo info = stack.info;
    info.format = "TIFF";
    info.geometry.dims = dims.value();
    if (isFolder(path))
        info.dataFiles = filesInFolder(stack.files);
    ISO_TRY(checkGeometry(info.geometry, "spacing", path));
    SampleLayout layout;
    layout.type = stack.page.type;
    layout.isBigEndian = std::endian::native == std::endian::big;
    layout.components = stack.page.components;
    const int component = choice.value().component;
    layout.component = component == kMagnitude ? kMagnitude : component % stack.page.components;
    const std::int64_t channel = component == kMagnitude ? 0 : component / stack.page.components;
    auto bytes = std::make_unique<PageStream>(std::move(stack), channel, choice.value().frame);
    return makeSampleSource(std::move(info), layout, std::move(bytes), path);
}

} // namespace isoslider::io
