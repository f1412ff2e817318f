#include "core/volume_io/formats/dicom/dicom_elements.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "core/volume_io/formats/inflated_file.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::uint32_t kUndefined = 0xffffffff;
constexpr DicomTag kItem = 0xfffee000, kItemEnd = 0xfffee00d, kSequenceEnd = 0xfffee0dd;
constexpr DicomTag kTransferSyntax = 0x00020010;
constexpr std::uint64_t kPreambleBytes = 128;
constexpr std::size_t kWindowBytes = std::size_t{1} << 16;
constexpr std::uint64_t kMaxValueBytes = std::uint64_t{1} << 16;
constexpr int kMaxDepth = 12;
constexpr std::int64_t kMaxElements = 4'000'000;
constexpr std::size_t kMaxFragments = 1'000'000;
constexpr std::string_view kDeflated = "1.2.840.10008.1.2.1.99";
constexpr std::string_view kExplicitBig = "1.2.840.10008.1.2.2";

constexpr std::string_view kRepresentations[] = {"AE", "AS", "AT", "CS", "DA", "DS", "DT", "FL", "FD", "IS", "LO", "LT",
                                                 "OB", "OD", "OF", "OL", "OV", "OW", "PN", "SH", "SL", "SQ", "SS", "ST",
                                                 "SV", "TM", "UC", "UI", "UL", "UN", "UR", "US", "UT", "UV"};
constexpr std::string_view kLongRepresentations[] = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                     "SV", "UC", "UN", "UR", "UT", "UV"};

template <class List>
bool isIn(const List& list, std::string_view text) {
    return std::find(std::begin(list), std::end(list), text) != std::end(list);
}

bool isPixelData(DicomTag tag) { return tag == 0x7fe00010 || tag == 0x7fe00008 || tag == 0x7fe00009; }

template <class T>
T load(const std::byte* bytes, bool isBigEndian) {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (isBigEndian != (std::endian::native == std::endian::big))
        std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

DicomTag loadTag(const std::byte* bytes, bool isBigEndian) {
    return DicomTag{load<std::uint16_t>(bytes, isBigEndian)} << 16 | load<std::uint16_t>(bytes + 2, isBigEndian);
}

std::string_view asText(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A window that moves over the bytes.
class Window {
public:
    explicit Window(const RandomAccessFile& file) : file_(file) {}

    /// `size` bytes from `offset` on, or fewer where they end; none of those that cannot be read.
    std::span<const std::byte> at(std::uint64_t offset, std::size_t size) {
        if (offset < begin_ || offset + size > begin_ + bytes_.size()) {
            bytes_.resize(kWindowBytes);
            begin_ = offset;
            const auto count = file_.readAt(offset, bytes_);
            bytes_.resize(count.isOk() ? count.value() : 0);
        }
        const auto skipped = static_cast<std::size_t>(offset - begin_);
        return std::span(bytes_).subspan(skipped, std::min(size, bytes_.size() - skipped));
    }

private:
    const RandomAccessFile& file_;
    std::vector<std::byte> bytes_;
    std::uint64_t begin_ = 0;
};

/// How elements are written, which may change from one sequence to the next.
struct Writing {
    bool isExplicit = true;
    bool isBigEndian = false;
};

struct Element {
    DicomTag tag = 0;
    std::string_view vr; ///< of kRepresentations; empty: not written out
    std::uint64_t offset = 0; ///< of the value
    std::uint32_t length = 0;
};

DicomValue decode(DicomKind kind, std::span<const std::byte> bytes, const Element& element, bool isBigEndian) {
    DicomValue value;
    const auto numbers = [&](auto sample) {
        using T = decltype(sample);
        for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T))
            value.numbers.push_back(static_cast<double>(load<T>(bytes.data() + i, isBigEndian)));
    };
    std::string_view text = asText(bytes);
    switch (kind) {
        case DicomKind::Text:
            text = text.substr(0, text.find('\0'));
            value.text = trimmed(text);
            break;
        case DicomKind::Decimal:
            text = text.substr(0, text.find('\0'));
            while (!trimmed(text).empty()) {
                const std::string_view word = text.substr(0, text.find('\\'));
                const auto number = parseReal(trimmed(word));
                if (!number)
                    return {};
                value.numbers.push_back(*number);
                text.remove_prefix(std::min(text.size(), word.size() + 1));
            }
            break;
        case DicomKind::Integer16:
            if (element.vr == "SS")
                numbers(std::int16_t{});
            else
                numbers(std::uint16_t{});
            break;
        case DicomKind::Unsigned16: numbers(std::uint16_t{}); break;
        case DicomKind::Unsigned32: numbers(std::uint32_t{}); break;
        case DicomKind::Real32: numbers(float{}); break;
        case DicomKind::Real64: numbers(double{}); break;
        case DicomKind::Sequence: break;
    }
    return value;
}

class Walker {
public:
    Walker(const DicomDataSet& dataSet, DicomSink& sink)
        : window_(*dataSet.bytes), path_(dataSet.bytes->path()), size_(dataSet.bytes->sizeBytes()), sink_(sink) {}

    /// Elements of [begin, end), or up to the mark that ends an item. Returns where the next thing begins.
    Result<std::uint64_t> elements(std::uint64_t begin, std::uint64_t end, Writing writing) {
        std::uint64_t at = begin;
        while (end - at >= 8) {
            if (++elements_ > kMaxElements)
                return makeError(ErrorCode::Corruption, "has more than " + std::to_string(kMaxElements) + " elements",
                                 path_, at);
            auto read = header(at, writing);
            if (!read.isOk())
                return std::move(read).error();
            const Element& element = read.value();
            if (element.tag == kItemEnd || element.tag == kSequenceEnd)
                return element.offset;
            if (place_.empty() && isPixelData(element.tag)) {
                foundSamples(element);
                return element.offset;
            }
            auto next = step(element, end, writing);
            if (!next.isOk())
                return next;
            at = next.value();
        }
        return end;
    }

    /// Elements of group 0002, which are always explicit and little-endian.
    Result<std::uint64_t> metaElements(std::uint64_t begin) {
        std::uint64_t at = begin;
        while (size_ - at >= 8) {
            auto read = header(at, {true, false});
            if (!read.isOk())
                return std::move(read).error();
            if (read.value().tag >> 16 != 2)
                break;
            auto next = step(read.value(), size_, {true, false});
            if (!next.isOk())
                return next;
            at = next.value();
        }
        return at;
    }

    const std::optional<DicomPixelData>& pixels() const { return pixels_; }

private:
    Error cutShort(const Element& element, std::uint64_t end) const {
        return makeError(ErrorCode::Corruption,
                         "element " + dicomTagText(element.tag) + ": its " + std::to_string(element.length) +
                             " bytes do not end within the " + std::to_string(end) + " there are",
                         path_, element.offset);
    }

    Result<Element> header(std::uint64_t at, Writing writing) {
        const auto bytes = window_.at(at, 12);
        if (bytes.size() < 8)
            return makeError(ErrorCode::Corruption, "ends within an element", path_, at);
        Element element;
        element.tag = loadTag(bytes.data(), writing.isBigEndian);
        element.offset = at + 8;
        element.length = load<std::uint32_t>(bytes.data() + 4, writing.isBigEndian);
        const auto* known = std::ranges::find(kRepresentations, asText(bytes.subspan(4, 2)));
        // Some writers leave the representation out of single elements; a length hardly looks like one.
        if (!writing.isExplicit || element.tag >> 16 == 0xfffe || known == std::end(kRepresentations))
            return element;
        element.vr = *known;
        if (!isIn(kLongRepresentations, element.vr)) {
            element.length = load<std::uint16_t>(bytes.data() + 6, writing.isBigEndian);
            return element;
        }
        if (bytes.size() < 12)
            return makeError(ErrorCode::Corruption, "ends within an element", path_, at);
        element.offset = at + 12;
        element.length = load<std::uint32_t>(bytes.data() + 8, writing.isBigEndian);
        return element;
    }

    Result<std::uint64_t> step(const Element& element, std::uint64_t end, Writing writing) {
        const DicomKind* kind = sink_.wants(place_, element.tag);
        const bool isWantedSequence = kind != nullptr && *kind == DicomKind::Sequence;
        if (element.offset > end)
            return cutShort(element, end);
        if (element.length == kUndefined) {
            // A sequence of unknown representation is written without representations.
            const bool isUnknown = element.vr == "UN";
            return sequence(element, end, isUnknown ? Writing{false, false} : writing, true);
        }
        if (element.length > end - element.offset)
            return cutShort(element, end);
        const std::uint64_t next = element.offset + element.length;
        if (isWantedSequence) {
            const auto walked = sequence(element, next, writing, false);
            if (!walked.isOk())
                return walked;
        } else if (kind != nullptr && element.length <= kMaxValueBytes) {
            const auto bytes = window_.at(element.offset, element.length);
            if (bytes.size() < element.length)
                return cutShort(element, end);
            sink_.take(place_, element.tag, decode(*kind, bytes, element, writing.isBigEndian));
        }
        return next;
    }

    Result<std::uint64_t> sequence(const Element& element, std::uint64_t end, Writing writing, bool isOpenEnded) {
        if (place_.size() >= kMaxDepth)
            return makeError(ErrorCode::Corruption, "sequences lie more than " + std::to_string(kMaxDepth) + " deep",
                             path_, element.offset);
        place_.push_back({element.tag, 0});
        std::uint64_t at = element.offset;
        while (end - at >= 8) {
            if (++elements_ > kMaxElements)
                return cutShort(element, end);
            const auto item = header(at, writing);
            if (!item.isOk())
                return item.error();
            at = item.value().offset;
            if (item.value().tag == kSequenceEnd) {
                place_.pop_back();
                return at;
            }
            const std::uint32_t length = item.value().length;
            if (item.value().tag != kItem || (length != kUndefined && length > end - at))
                return makeError(ErrorCode::Corruption,
                                 "sequence " + dicomTagText(element.tag) + ": an item of it was expected, found " +
                                     dicomTagText(item.value().tag) + " with " + std::to_string(length) + " bytes",
                                 path_, at);
            const auto walked = elements(at, length == kUndefined ? end : at + length, writing);
            if (!walked.isOk())
                return walked;
            at = length == kUndefined ? walked.value() : at + length;
            ++place_.back().index;
        }
        place_.pop_back();
        if (isOpenEnded)
            return makeError(ErrorCode::Corruption, "sequence " + dicomTagText(element.tag) + " does not end", path_,
                             at);
        return end;
    }

    void foundSamples(const Element& element) {
        DicomPixelData found;
        found.tag = element.tag;
        found.offset = element.offset;
        found.isEncapsulated = element.length == kUndefined;
        found.sizeBytes = found.isEncapsulated ? size_ - std::min(size_, element.offset) : element.length;
        found.isWords = element.vr == "OW" || element.vr.empty();
        pixels_ = found;
    }

    Window window_;
    fs::path path_;
    std::uint64_t size_;
    DicomSink& sink_;
    std::vector<DicomItem> place_;
    std::int64_t elements_ = 0;
    std::optional<DicomPixelData> pixels_;
};

class MetaSink final : public DicomSink {
public:
    const DicomKind* wants(std::span<const DicomItem>, DicomTag tag) override {
        static constexpr DicomKind kText = DicomKind::Text;
        return tag == kTransferSyntax ? &kText : nullptr;
    }
    void take(std::span<const DicomItem>, DicomTag, DicomValue value) override { transferSyntax = value.text; }
    std::string transferSyntax;
};

/// Elements in rising order as the first ones of a file have them: by which a file without preamble is recognised.
bool beginsWithElements(std::span<const std::byte> start, bool isBigEndian) {
    constexpr int kEnough = 3;
    DicomTag last = 0;
    int count = 0;
    for (std::size_t at = 0; at + 12 <= start.size() && count < kEnough; ++count) {
        const std::byte* bytes = start.data() + at;
        const DicomTag tag = loadTag(bytes, isBigEndian);
        const DicomTag group = tag >> 16;
        const bool isPossible = count == 0 ? group == 8 || group == 2 : group >= 2 && group <= 0x30 && group % 2 == 0;
        if (!isPossible || tag <= last)
            return false;
        const std::string_view vr = asText(start.subspan(at + 4, 2));
        std::size_t length = load<std::uint32_t>(bytes + 4, isBigEndian), head = 8;
        if (isIn(kLongRepresentations, vr)) {
            length = load<std::uint32_t>(bytes + 8, isBigEndian);
            head = 12;
        } else if (isIn(kRepresentations, vr)) {
            length = load<std::uint16_t>(bytes + 6, isBigEndian);
        } else if (isBigEndian) {
            return false; // is always explicit
        }
        if (length > start.size() || length % 2 != 0)
            return false;
        last = tag;
        at += head + length;
    }
    return count == kEnough;
}

} // namespace

std::string dicomTagText(DicomTag tag) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text = "(";
    for (int digit = 7; digit >= 0; --digit) {
        text += kDigits[tag >> (4 * digit) & 15];
        if (digit == 4)
            text += ',';
    }
    return text + ')';
}

Status DicomDataSet::allow(std::uint64_t end) const {
    if (const auto* inflated = dynamic_cast<const InflatedFile*>(bytes.get())) {
        ISO_TRY(checkFitsMemory(end, memoryBytes, bytes->path()));
        inflated->allow(end);
    }
    return {};
}

bool looksLikeDicom(std::span<const std::byte> start) {
    return (start.size() >= kPreambleBytes + 4 && asText(start.subspan(kPreambleBytes, 4)) == "DICM") ||
           beginsWithElements(start, false) || beginsWithElements(start, true);
}

Result<DicomDataSet> openDicomDataSet(const fs::path& path, std::uint64_t memoryBytes) {
    auto opened = defaultFileSystem().openForReading(path);
    if (!opened.isOk())
        return std::move(opened).error();
    DicomDataSet dataSet;
    dataSet.memoryBytes = memoryBytes;
    dataSet.bytes = std::move(opened).value();
    Window window(*dataSet.bytes);
    const auto start = window.at(0, 512);
    if (!looksLikeDicom(start))
        return makeError(ErrorCode::InvalidArgument,
                         "is not DICOM: neither 'DICM' at byte 128 nor elements of "
                         "group 0008 at its start",
                         path);
    dataSet.begin = start.size() >= kPreambleBytes + 4 && asText(start.subspan(kPreambleBytes, 4)) == "DICM"
                        ? kPreambleBytes + 4
                        : 0;
    MetaSink meta;
    const auto end = Walker(dataSet, meta).metaElements(dataSet.begin);
    if (!end.isOk())
        return end.error();
    dataSet.begin = end.value();
    dataSet.transferSyntax = meta.transferSyntax;
    if (dataSet.transferSyntax == kDeflated) {
        dataSet.bytes = std::make_shared<InflatedFile>(dataSet.bytes, dataSet.begin);
        dataSet.begin = 0;
    }
    // What the elements look like counts for more than what the meta information states of them.
    Window body(*dataSet.bytes);
    const auto first = body.at(dataSet.begin, 8);
    if (first.size() < 8)
        return makeError(ErrorCode::Corruption, "ends before its first element", path, dataSet.begin);
    dataSet.isExplicit = isIn(kRepresentations, asText(first.subspan(4, 2)));
    const auto group = load<std::uint16_t>(first.data(), false);
    dataSet.isBigEndian = group == 0x0800 || (dataSet.transferSyntax == kExplicitBig && group != 0x0008);
    return dataSet;
}

Result<DicomPixelData> walkDicomElements(const DicomDataSet& dataSet, DicomSink& sink) {
    Walker walker(dataSet, sink);
    const auto end =
        walker.elements(dataSet.begin, dataSet.bytes->sizeBytes(), {dataSet.isExplicit, dataSet.isBigEndian});
    if (!end.isOk())
        return end.error();
    if (!walker.pixels())
        return makeError(ErrorCode::InvalidArgument, "holds no image: there is no pixel data (7fe0,0010)",
                         dataSet.bytes->path());
    return *walker.pixels();
}

Result<std::vector<DicomFragment>> findDicomFragments(const DicomDataSet& dataSet, const DicomPixelData& samples) {
    const fs::path& path = dataSet.bytes->path();
    const std::uint64_t end = dataSet.bytes->sizeBytes();
    std::vector<DicomFragment> fragments;
    for (std::uint64_t at = samples.offset; end - at >= 8;) {
        std::array<std::byte, 8> head;
        ISO_TRY(dataSet.bytes->readExactlyAt(at, head));
        const DicomTag tag = loadTag(head.data(), dataSet.isBigEndian);
        const std::uint64_t size = load<std::uint32_t>(head.data() + 4, dataSet.isBigEndian);
        at += 8;
        if (tag == kSequenceEnd)
            return fragments;
        if (tag != kItem || size > end - at || fragments.size() == kMaxFragments)
            return makeError(ErrorCode::Corruption,
                             "pixel data: fragment " + std::to_string(fragments.size()) + " " + dicomTagText(tag) +
                                 " of " + std::to_string(size) + " bytes does not lie within the file",
                             path, at);
        fragments.push_back({at, size});
        at += size;
    }
    // The mark at the end is forgotten by some writers: the fragments are whole all the same.
    return fragments;
}

} // namespace isoslider::io
