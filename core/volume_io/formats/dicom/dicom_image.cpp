#include "core/volume_io/formats/dicom/dicom_image.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "core/volume_io/formats/dicom/dicom_pixels.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr DicomTag kSharedGroups = 0x52009229, kFrameGroups = 0x52009230, kDetectors = 0x00540022,
                   kLookupTable = 0x00283000;
constexpr std::size_t kMaxFrames = 65536;

using Numbers = std::vector<double>;

struct KnownElement {
    DicomTag tag;
    DicomKind kind;
};

using enum DicomKind;

// Of the whole file.
constexpr KnownElement kImageElements[] = {
    {0x00080018, Text}, // SOP instance
    {0x00080020, Text}, // study date
    {0x00080021, Text}, // series date
    {0x00080060, Text}, // modality
    {0x0008103e, Text}, // series description
    {0x0020000e, Text}, // series instance
    {0x00200011, Decimal}, // series number
    {0x00200013, Decimal}, // instance number
    {0x00280002, Unsigned16}, // samples per pixel
    {0x00280004, Text}, // photometric interpretation
    {0x00280006, Unsigned16}, // planar configuration
    {0x00280008, Decimal}, // number of frames
    {0x00280010, Unsigned16}, // rows
    {0x00280011, Unsigned16}, // columns
    {0x00280100, Unsigned16}, // bits allocated
    {0x00280101, Unsigned16}, // bits stored
    {0x00280102, Unsigned16}, // high bit
    {0x00280103, Unsigned16}, // pixel representation
    {0x00280120, Integer16}, // pixel padding value
    {0x00181164, Decimal}, // imager pixel spacing
    {0x3004000c, Decimal}, // grid frame offset vector
    {0x3004000e, Decimal}, // dose grid scaling
    {kLookupTable, Sequence}, {kSharedGroups, Sequence},
    {kFrameGroups, Sequence}, {kDetectors, Sequence}, // of nuclear medicine
};

// Of the whole file, or in the functional groups of all frames or of each.
constexpr KnownElement kFrameElements[] = {
    {0x00200032, Decimal}, // image position
    {0x00200037, Decimal}, // image orientation
    {0x00280030, Decimal}, // pixel spacing
    {0x00180050, Decimal}, // slice thickness
    {0x00180088, Decimal}, // spacing between slices
    {0x00281052, Decimal}, // rescale intercept
    {0x00281053, Decimal}, // rescale slope
    {0x00209056, Text}, // stack
    {0x00200100, Decimal}, // temporal position
    {0x00209128, Unsigned32}, // temporal position of a frame
    {0x00180086, Decimal}, // echo number
    {0x00180081, Decimal}, // echo time
    {0x00189082, Real64}, // effective echo time
    {0x00189087, Real64}, // b-value
    {0x00189089, Real64}, // direction of the diffusion gradient
    {0x00080008, Text}, // image type
    {0x00089007, Text}, // frame type
    {0x0062000b, Unsigned16}, // segment
    {0x00181060, Decimal}, // trigger time
    {0x00209153, Real64}, // trigger delay of a frame
    {0x00200012, Decimal}, // acquisition
    {0x00180060, Decimal}, // tube voltage
};

// Sequences in the functional groups that hold some of these.
constexpr KnownElement kGroupSequences[] = {
    {0x00209113, Sequence}, {0x00209116, Sequence}, {0x00289110, Sequence}, {0x00289145, Sequence},
    {0x00209111, Sequence}, {0x00189114, Sequence}, {0x00189117, Sequence}, {0x00189076, Sequence},
    {0x00189226, Sequence}, {0x00189329, Sequence}, {0x0062000a, Sequence}, {0x00189118, Sequence},
};

template <std::size_t size>
const DicomKind* find(const KnownElement (&known)[size], DicomTag tag) {
    const auto* found = std::ranges::find(known, tag, &KnownElement::tag);
    return found == std::end(known) ? nullptr : &found->kind;
}

std::optional<glm::dvec3> vectorAt(const Numbers& numbers, std::size_t at) {
    if (numbers.size() < at + 3 || !std::ranges::all_of(numbers, [](double n) { return std::isfinite(n); }))
        return std::nullopt;
    return glm::dvec3(numbers[at], numbers[at + 1], numbers[at + 2]);
}

std::optional<double> firstOf(const Numbers& numbers) {
    return numbers.empty() || !std::isfinite(numbers[0]) ? std::nullopt : std::optional(numbers[0]);
}

std::string joined(const DicomValue& value) {
    std::string text = value.text;
    for (const double number : value.numbers)
        text += (text.empty() ? "" : " ") + std::to_string(number);
    return text;
}

std::optional<DicomSplit> splitOf(DicomTag tag) {
    switch (tag) {
        case 0x00200100:
        case 0x00209128: return DicomSplit::Time;
        case 0x00180086: return DicomSplit::EchoNumber;
        case 0x00180081:
        case 0x00189082: return DicomSplit::EchoTime;
        case 0x00189087: return DicomSplit::BValue;
        case 0x00189089: return DicomSplit::Gradient;
        case 0x00080008:
        case 0x00089007: return DicomSplit::FrameType;
        case 0x0062000b: return DicomSplit::Segment;
        case 0x00181060:
        case 0x00209153: return DicomSplit::Trigger;
        case 0x00200012: return DicomSplit::Acquisition;
        case 0x00180060: return DicomSplit::Energy;
        default: return std::nullopt;
    }
}

void setDirections(DicomFrame& frame, const Numbers& numbers) {
    const auto alongRow = vectorAt(numbers, 0), alongColumn = vectorAt(numbers, 3);
    if (alongRow && alongColumn)
        frame.directions = {*alongRow, *alongColumn};
}

void assign(DicomFrame& frame, DicomTag tag, DicomValue& value) {
    if (const auto split = splitOf(tag)) {
        frame.splits[static_cast<std::size_t>(*split)] = joined(value);
        return;
    }
    switch (tag) {
        case 0x00200032: frame.position = vectorAt(value.numbers, 0); break;
        case 0x00200037: setDirections(frame, value.numbers); break;
        case 0x00280030:
            if (value.numbers.size() == 2) // between rows first
                frame.spacing = glm::dvec2(value.numbers[1], value.numbers[0]);
            break;
        case 0x00180050: frame.thickness = firstOf(value.numbers); break;
        case 0x00180088: frame.sliceSpacing = firstOf(value.numbers); break;
        case 0x00281052: frame.intercept = firstOf(value.numbers); break;
        case 0x00281053: frame.slope = firstOf(value.numbers); break;
        case 0x00209056: frame.stack = std::move(value.text); break;
        default: break;
    }
}

/// What `over` states, and of the rest what `frame` has said already.
void overlay(DicomFrame& frame, const DicomFrame& over) {
    const auto take = [](auto& mine, const auto& theirs) {
        if (theirs)
            mine = theirs;
    };
    take(frame.position, over.position);
    take(frame.directions, over.directions);
    take(frame.spacing, over.spacing);
    take(frame.thickness, over.thickness);
    take(frame.sliceSpacing, over.sliceSpacing);
    take(frame.slope, over.slope);
    take(frame.intercept, over.intercept);
    if (!over.stack.empty())
        frame.stack = over.stack;
    for (std::size_t i = 0; i < frame.splits.size(); ++i)
        if (!over.splits[i].empty())
            frame.splits[i] = over.splits[i];
}

/// Collects what is known of a file's images.
class ImageSink final : public DicomSink {
public:
    const DicomKind* wants(std::span<const DicomItem> place, DicomTag tag) override {
        if (place.empty()) {
            const DicomKind* kind = find(kImageElements, tag);
            hasLookupTable_ = hasLookupTable_ || tag == kLookupTable;
            return kind != nullptr ? kind : find(kFrameElements, tag);
        }
        if (place[0].sequence == kLookupTable)
            return nullptr;
        const DicomKind* kind = find(kFrameElements, tag);
        return kind != nullptr ? kind : find(kGroupSequences, tag);
    }

    void take(std::span<const DicomItem> place, DicomTag tag, DicomValue value) override {
        if (place.empty()) {
            if (find(kFrameElements, tag) != nullptr)
                assign(whole_, tag, value);
            else
                values_[tag] = std::move(value);
            return;
        }
        if (place[0].sequence == kSharedGroups || (place[0].sequence == kDetectors && place[0].index == 0))
            assign(shared_, tag, value);
        if (place[0].sequence != kFrameGroups || place[0].index >= kMaxFrames)
            return;
        if (each_.size() <= place[0].index)
            each_.resize(place[0].index + 1);
        assign(each_[place[0].index], tag, value);
    }

    const DicomValue& operator[](DicomTag tag) const {
        static const DicomValue kEmptyValue;
        const auto found = values_.find(tag);
        return found == values_.end() ? kEmptyValue : found->second;
    }
    std::string text(DicomTag tag) const { return (*this)[tag].text; }
    double number(DicomTag tag, double otherwise) const { return firstOf((*this)[tag].numbers).value_or(otherwise); }
    bool hasLookupTable() const { return hasLookupTable_; }
    bool has(DicomTag tag) const { return values_.contains(tag); }

    DicomFrame common() const {
        DicomFrame frame = whole_;
        overlay(frame, shared_);
        return frame;
    }
    const std::vector<DicomFrame>& each() const { return each_; }

private:
    std::map<DicomTag, DicomValue> values_;
    DicomFrame whole_, shared_;
    std::vector<DicomFrame> each_;
    bool hasLookupTable_ = false;
};

std::int64_t wholeNumber(double number) {
    return std::abs(number) < 1e15 ? static_cast<std::int64_t>(std::llround(number)) : 0;
}

Result<FileType> sampleType(const ImageSink& sink, DicomPixels& pixels, DicomTag samples, const fs::path& path) {
    if (samples == 0x7fe00008 || samples == 0x7fe00009) {
        pixels.bitsAllocated = samples == 0x7fe00008 ? 32 : 64;
        pixels.bitsStored = pixels.bitsAllocated;
        pixels.highBit = pixels.bitsAllocated - 1;
        return samples == 0x7fe00008 ? FileType::F32 : FileType::F64;
    }
    const bool isSigned = sink.number(0x00280103, 0) == 1;
    switch (pixels.bitsAllocated) {
        case 1:
        case 8: return isSigned ? FileType::I8 : FileType::U8;
        case 16: return isSigned ? FileType::I16 : FileType::U16;
        case 32: return isSigned ? FileType::I32 : FileType::U32;
        default:
            return refuseField("bits allocated (0028,0100)",
                               std::to_string(pixels.bitsAllocated) + " is none of 1, 8, 16 and 32", path);
    }
}

Result<DicomCoding> codingOf(const DicomDataSet& dataSet, bool isEncapsulated) {
    constexpr std::string_view kJpeg[] = {"50", "51", "57", "70"}, kJpegLs[] = {"80", "81"}, kJpeg2000[] = {"90", "91"};
    const std::string& syntax = dataSet.transferSyntax;
    if (!isEncapsulated)
        return DicomCoding::Native;
    if (syntax == "1.2.840.10008.1.2.5")
        return DicomCoding::Rle;
    const std::string prefix = "1.2.840.10008.1.2.4.";
    const std::string_view number = syntax.starts_with(prefix) ? std::string_view(syntax).substr(prefix.size()) : "";
    const auto isOf = [&](const auto& list) { return std::ranges::find(list, number) != std::end(list); };
    if (isOf(kJpeg))
        return DicomCoding::Jpeg;
    if (isOf(kJpegLs))
        return DicomCoding::JpegLs;
    if (isOf(kJpeg2000))
        return DicomCoding::Jpeg2000;
    return refuseField("transfer syntax (0002,0010)", inQuotes(syntax) + " is not read", dataSet.bytes->path());
}

Result<DicomPixels> readPixelLayout(const ImageSink& sink, const DicomDataSet& dataSet, const DicomPixelData& samples) {
    const fs::path& path = dataSet.bytes->path();
    DicomPixels pixels;
    pixels.rows = wholeNumber(sink.number(0x00280010, 0));
    pixels.columns = wholeNumber(sink.number(0x00280011, 0));
    pixels.components = static_cast<int>(sink.number(0x00280002, 1));
    pixels.bitsAllocated = static_cast<int>(sink.number(0x00280100, 0));
    pixels.bitsStored = static_cast<int>(sink.number(0x00280101, pixels.bitsAllocated));
    pixels.highBit = static_cast<int>(sink.number(0x00280102, pixels.bitsStored - 1));
    pixels.photometric = sink.text(0x00280004);
    pixels.transferSyntax = dataSet.transferSyntax;
    pixels.isPlanar = pixels.components > 1 && sink.number(0x00280006, 0) == 1;
    const auto type = sampleType(sink, pixels, samples.tag, path);
    if (!type.isOk())
        return type.error();
    pixels.type = type.value();
    if (pixels.rows < 1 || pixels.columns < 1)
        return refuseField("rows, columns (0028,0010)",
                           std::to_string(pixels.rows) + " x " + std::to_string(pixels.columns) +
                               " is not the size of an image",
                           path);
    if (pixels.components < 1 || pixels.components > 4)
        return refuseField("samples per pixel (0028,0002)", std::to_string(pixels.components) + " is not within 1..4",
                           path);
    if (samples.isEncapsulated && pixels.components != 1 && pixels.components != 3)
        return refuseField("samples per pixel (0028,0002)",
                           std::to_string(pixels.components) + " are not read of compressed images", path);
    if (pixels.bitsStored < 1 || pixels.highBit < pixels.bitsStored - 1 || pixels.highBit >= pixels.bitsAllocated)
        return refuseField("bits stored (0028,0101)",
                           std::to_string(pixels.bitsStored) + " bits up to bit " + std::to_string(pixels.highBit) +
                               " do not fit " + std::to_string(pixels.bitsAllocated) + " allocated",
                           path);
    const auto coding = codingOf(dataSet, samples.isEncapsulated);
    if (!coding.isOk())
        return coding.error();
    pixels.coding = coding.value();
    // The samples of this private syntax are big-endian, alone of all elements.
    const bool isGe = dataSet.transferSyntax == "1.2.840.113619.5.2";
    pixels.isBigEndian = pixels.coding == DicomCoding::Native && (dataSet.isBigEndian || isGe);
    pixels.isPairSwapped = pixels.isBigEndian && pixels.bitsAllocated <= 8 && samples.isWords;
    if (pixels.coding == DicomCoding::Native && pixels.photometric.ends_with("_422"))
        return refuseField("photometric interpretation (0028,0004)",
                           inQuotes(pixels.photometric) + " shares colours between samples, which is not read", path);
    return pixels;
}

Status locateNative(DicomPixels& pixels, std::uint64_t frames, const DicomDataSet& dataSet,
                    const DicomPixelData& samples, std::vector<std::string>& notes) {
    pixels.offset = samples.offset;
    const std::uint64_t size = dataSet.bytes->sizeBytes();
    std::uint64_t available = std::min(samples.sizeBytes, size - std::min(size, samples.offset));
    const auto points = static_cast<std::uint64_t>(pixels.rows * pixels.columns * pixels.components);
    // The product stays below 2^32 * 4 * 2^16 * 2^6.
    const std::uint64_t needed = (points * frames * static_cast<std::uint64_t>(pixels.bitsAllocated) + 7) / 8;
    std::byte last{};
    ISO_TRY(dataSet.allow(samples.offset + needed));
    if (needed <= available && !dataSet.bytes->readExactlyAt(samples.offset + needed - 1, {&last, 1}).isOk())
        available = 0;
    if (needed > available)
        return makeError(ErrorCode::Corruption,
                         "pixel data (7fe0,0010): " + std::to_string(pixels.columns) + " x " +
                             std::to_string(pixels.rows) + " x " + std::to_string(frames) + " samples of " +
                             std::to_string(pixels.bitsAllocated * pixels.components) + " bits need " +
                             std::to_string(needed) + " bytes, the file has " + std::to_string(available),
                         dataSet.bytes->path(), samples.offset);
    if (samples.sizeBytes > needed + 1)
        notes.push_back("the pixel data has " + std::to_string(samples.sizeBytes - needed) +
                        " bytes more than its frames, which are left out");
    return {};
}

Status locateFragments(DicomPixels& pixels, std::uint64_t frames, const DicomDataSet& dataSet,
                       const DicomPixelData& samples) {
    auto found = findDicomFragments(dataSet, samples);
    if (!found.isOk())
        return std::move(found).error();
    const fs::path& path = dataSet.bytes->path();
    auto assigned = assignDicomFragments(*dataSet.bytes, found.value(), frames);
    if (!assigned.isOk())
        return std::move(assigned).error();
    pixels.fragments = std::move(assigned).value();
    for (std::size_t frame = 0; frame < pixels.fragments.size(); ++frame)
        ISO_TRY(checkDicomCodestream(*dataSet.bytes, pixels, frame, path));
    return {};
}

// Radiotherapy doses and nuclear medicine place their frames along the normal.
void placeAlongNormal(DicomImage& image, const Numbers& offsets, double step) {
    const DicomFrame& first = image.frames.front();
    if (!first.position || !first.directions)
        return;
    const glm::dvec3 normal = glm::cross((*first.directions)[0], (*first.directions)[1]);
    const glm::dvec3 origin = *first.position;
    for (std::size_t i = 0; i < image.frames.size(); ++i) {
        const double offset = offsets.empty() ? step * static_cast<double>(i) : offsets[i] - offsets[0];
        image.frames[i].position = origin + offset * normal;
    }
    image.hasFramePositions = true;
}

void fillFrames(DicomImage& image, const ImageSink& sink, std::size_t count) {
    image.frames.assign(count, sink.common());
    for (std::size_t i = 0; i < std::min(count, sink.each().size()); ++i) {
        overlay(image.frames[i], sink.each()[i]);
        image.hasFramePositions = image.hasFramePositions || sink.each()[i].position;
    }
    const DicomFrame& first = image.frames.front();
    if (sink.has(0x3004000e))
        for (DicomFrame& frame : image.frames)
            frame.slope = sink.number(0x3004000e, 1.0);
    const Numbers& offsets = sink[0x3004000c].numbers;
    if (count > 1 && !image.hasFramePositions && offsets.size() == count)
        placeAlongNormal(image, offsets, 0.0);
    const double step = first.sliceSpacing.value_or(first.thickness.value_or(0.0));
    if (count > 1 && !image.hasFramePositions && step > 0.0) {
        placeAlongNormal(image, {}, step);
        if (image.hasFramePositions)
            image.notes.push_back("only the first frame has a position; the others follow at the stated distance");
    }
    const Numbers& imager = sink[0x00181164].numbers;
    if (!first.spacing && imager.size() == 2)
        for (DicomFrame& frame : image.frames)
            frame.spacing = glm::dvec2(imager[1], imager[0]);
}

void addNotes(DicomImage& image, const ImageSink& sink) {
    const std::string& photometric = image.pixels.photometric;
    if (photometric == "MONOCHROME1")
        image.notes.push_back("MONOCHROME1: the smallest samples are meant to look brightest; they are not inverted");
    if (photometric == "PALETTE COLOR")
        image.notes.push_back("PALETTE COLOR: samples are places in a table of colours, which is not applied");
    if (const auto padding = firstOf(sink[0x00280120].numbers))
        image.notes.push_back("samples outside the image are filled with " + std::to_string(wholeNumber(*padding)) +
                              " (before slope and intercept), which is kept");
    if (image.frames.front().splits[static_cast<std::size_t>(DicomSplit::FrameType)].find("MOSAIC") !=
        std::string::npos)
        image.notes.push_back("a mosaic: all slices lie beside each other in one image, and are not taken apart");
}

} // namespace

std::string_view dicomSplitName(DicomSplit split) {
    constexpr std::string_view kNames[] = {"times",       "echoes",   "echo times", "b-values",     "gradients",
                                           "image types", "segments", "triggers",   "acquisitions", "tube voltages"};
    static_assert(std::size(kNames) == static_cast<std::size_t>(DicomSplit::Count));
    return kNames[static_cast<std::size_t>(split)];
}

Result<DicomImage> readDicomImage(const fs::path& path, std::uint64_t memoryBytes) {
    auto dataSet = openDicomDataSet(path, memoryBytes);
    if (!dataSet.isOk())
        return std::move(dataSet).error();
    ImageSink sink;
    const auto samples = walkDicomElements(dataSet.value(), sink);
    if (!samples.isOk())
        return samples.error();
    auto pixels = readPixelLayout(sink, dataSet.value(), samples.value());
    if (!pixels.isOk())
        return std::move(pixels).error();
    const std::int64_t frames = wholeNumber(sink.number(0x00280008, 1));
    if (frames < 1 || frames > static_cast<std::int64_t>(kMaxFrames))
        return refuseField("number of frames (0028,0008)",
                           std::to_string(frames) + " is not within 1.." + std::to_string(kMaxFrames), path);
    DicomImage image;
    image.path = path;
    image.pixels = std::move(pixels).value();
    const auto count = static_cast<std::uint64_t>(frames);
    ISO_TRY(image.pixels.coding == DicomCoding::Native
                ? locateNative(image.pixels, count, dataSet.value(), samples.value(), image.notes)
                : locateFragments(image.pixels, count, dataSet.value(), samples.value()));
    image.series = sink.text(0x0020000e);
    image.instanceUid = sink.text(0x00080018);
    image.description = sink.text(0x0008103e);
    image.modality = sink.text(0x00080060);
    image.date = sink.has(0x00080021) && !sink.text(0x00080021).empty() ? sink.text(0x00080021) : sink.text(0x00080020);
    image.seriesNumber = wholeNumber(sink.number(0x00200011, 0));
    image.instance = wholeNumber(sink.number(0x00200013, 0));
    if (sink.hasLookupTable())
        image.notes.push_back("its modality lookup table (0028,3000) is not applied");
    fillFrames(image, sink, static_cast<std::size_t>(frames));
    addNotes(image, sink);
    return image;
}

} // namespace isoslider::io
