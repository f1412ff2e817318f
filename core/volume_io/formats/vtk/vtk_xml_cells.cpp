#include "core/volume_io/formats/vtk/vtk_xml_cells.h"

#include <algorithm>
#include <functional>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kStep = std::size_t{1} << 16;

bool isBlank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

/// Bytes of a file one after the other, as they are or decoded from base64.
class ByteFeed {
public:
    ByteFeed(const RandomAccessFile& file, const VtkXmlPlace& place) : file_(file), place_(place) {}

    /// False at the end of the file, where base64 ends, and where reading fails.
    bool next(std::byte& out) {
        if (!place_.isText)
            return fetch(out);
        if (decoded_ == 0 && !decode())
            return false;
        out = static_cast<std::byte>(bits_ >> 8 * --decoded_ & 0xff);
        return true;
    }

private:
    bool fetch(std::byte& out) {
        if (used_ == held_.size()) {
            held_.resize(kStep);
            const auto got = file_.readAt(place_.begin, held_);
            held_.resize(got.isOk() ? got.value() : 0);
            place_.begin += held_.size();
            used_ = 0;
            if (held_.empty())
                return false;
        }
        out = held_[used_++];
        return true;
    }

    // Four letters; those that fill up the last ones count as nought.
    bool decode() {
        constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        bits_ = 0;
        for (int letters = 0; letters < 4;) {
            std::byte byte{};
            if (!fetch(byte))
                return false;
            const char c = static_cast<char>(byte);
            if (isBlank(c))
                continue;
            const auto value = c == '=' ? 0 : kLetters.find(c);
            if (value == std::string_view::npos)
                return false;
            bits_ = bits_ << 6 | static_cast<std::uint32_t>(value);
            ++letters;
        }
        decoded_ = 3;
        return true;
    }

    const RandomAccessFile& file_;
    VtkXmlPlace place_;
    std::vector<std::byte> held_;
    std::size_t used_ = 0;
    std::uint32_t bits_ = 0;
    int decoded_ = 0;
};

/// Numbers of an array, as long as `take` wants more.
using Take = std::function<bool(std::int64_t)>;

/// Of an integer type; others VTK converts in its own way.
struct IntegerType {
    std::uint64_t sizeBytes = 0; ///< 0: it is none
    bool isSigned = true;
};

IntegerType integerTypeOf(const XmlArray& array) {
    std::string_view type = xmlValue(array, "type");
    IntegerType found;
    if (type.starts_with('U')) {
        found.isSigned = false;
        type.remove_prefix(1);
    }
    if (type.starts_with("Int"))
        found.sizeBytes = static_cast<std::uint64_t>(parseInteger(type.substr(3)).value_or(0)) / 8;
    return found;
}

/// Passes on the numbers between a tag and the next. False: something stands there that is no whole number.
bool visitText(const RandomAccessFile& file, const XmlArray& array, const Take& take) {
    ByteFeed feed(file, {array.contentBegin, false});
    std::string word;
    for (bool isOpen = true; isOpen;) {
        std::byte byte{};
        const char c = feed.next(byte) ? static_cast<char>(byte) : '<';
        isOpen = c != '<';
        if (isOpen && !isBlank(c)) {
            word += c;
            if (word.size() > 40)
                return false;
        } else if (!word.empty()) {
            const auto number = parseInteger(word);
            if (!number)
                return false;
            if (!take(*number))
                return true;
            word.clear();
        }
    }
    return true;
}

std::int64_t numberOf(const std::byte* bytes, const IntegerType& type, bool isBigEndian) {
    std::uint64_t value = 0;
    for (std::uint64_t i = 0; i < type.sizeBytes; ++i)
        value |= std::to_integer<std::uint64_t>(bytes[i]) << 8 * (isBigEndian ? type.sizeBytes - 1 - i : i);
    const std::uint64_t shift = 64 - 8 * type.sizeBytes;
    return type.isSigned ? static_cast<std::int64_t>(value << shift) >> shift : static_cast<std::int64_t>(value);
}

/// Reads the arrays of cells of one file.
class CellCheck {
public:
    CellCheck(const RandomAccessFile& file, const VtkXmlHeader& header) : file_(file), header_(header) {
        isPacked_ = !xmlValue(header.outline.file, "compressor").empty();
        isBigEndian_ = xmlValue(header.outline.file, "byte_order") == "BigEndian";
        headingBytes_ = xmlValue(header.outline.file, "header_type", "UInt32") == "UInt64" ? 8 : 4;
    }

    Status run() {
        const XmlArray* connectivity = find("connectivity");
        const XmlArray* offsets = find("offsets");
        std::optional<std::uint64_t> corners;
        if (connectivity != nullptr && canRead(*connectivity))
            ISO_TRY(checkCorners(*connectivity, corners));
        if (offsets != nullptr && canRead(*offsets))
            ISO_TRY(checkOffsets(*offsets, corners));
        return {};
    }

private:
    const XmlArray* find(std::string_view name) const {
        for (const XmlArray& array : header_.outline.cellsArrays)
            if (xmlValue(array, "Name") == name)
                return &array;
        return nullptr;
    }

    static bool isText(const XmlArray& array) { return xmlValue(array, "format", "ascii") == "ascii"; }
    bool canRead(const XmlArray& array) const {
        const auto bytes = integerTypeOf(array).sizeBytes;
        return (isText(array) || !isPacked_) && (bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8);
    }

    Error damaged(std::string problem) const {
        return makeError(ErrorCode::Corruption, std::move(problem), file_.path());
    }

    Status checkCorners(const XmlArray& array, std::optional<std::uint64_t>& corners) const {
        std::uint64_t count = 0;
        std::optional<std::int64_t> wrong;
        const auto points = static_cast<std::int64_t>(header_.points);
        ISO_TRY(visit(array, [&](std::int64_t corner) {
            if (corner < 0 || corner >= points)
                wrong = corner;
            else
                ++count;
            return !wrong;
        }));
        if (wrong)
            return damaged("connectivity: corner " + std::to_string(count) + " is point " + std::to_string(*wrong) +
                           " of " + std::to_string(points));
        corners = count;
        return {};
    }

    // Without a count of corners: none can take less than a bit of the file, packed as it may be.
    Status checkOffsets(const XmlArray& array, std::optional<std::uint64_t> corners) const {
        constexpr std::uint64_t kMostPerByte = 8000;
        const auto most = static_cast<std::int64_t>(corners.value_or(file_.sizeBytes() * kMostPerByte));
        std::int64_t before = 0;
        std::optional<std::int64_t> wrong;
        ISO_TRY(visit(array, [&](std::int64_t offset) {
            if (offset < before || offset > most)
                wrong = offset;
            before = offset;
            return !wrong;
        }));
        if (wrong)
            return damaged("offsets: a cell ends at corner " + std::to_string(*wrong) + " of " + std::to_string(most) +
                           ", or before it begins");
        return {};
    }

    Status visit(const XmlArray& array, const Take& take) const {
        const std::string name(xmlValue(array, "Name"));
        if (isText(array)) {
            if (!visitText(file_, array, take))
                return damaged(name + ": whole numbers expected");
            return {};
        }
        const auto place = placeOfData(file_, header_.outline, array);
        if (!place.isOk())
            return place.error();
        if (!visitBytes(ByteFeed(file_, place.value()), integerTypeOf(array), take))
            return damaged(name + ": the file ends in its data");
        return {};
    }

    bool visitBytes(ByteFeed feed, const IntegerType& type, const Take& take) const {
        std::byte bytes[8];
        const auto number = [&](const IntegerType& wanted, std::int64_t& value) {
            for (std::uint64_t i = 0; i < wanted.sizeBytes; ++i)
                if (!feed.next(bytes[i]))
                    return false;
            value = numberOf(bytes, wanted, isBigEndian_);
            return true;
        };
        std::int64_t announced = 0, value = 0;
        if (!number({headingBytes_, false}, announced))
            return false;
        for (std::uint64_t left = static_cast<std::uint64_t>(announced) / type.sizeBytes; left > 0; --left) {
            if (!number(type, value))
                return false;
            if (!take(value))
                return true;
        }
        return true;
    }

    const RandomAccessFile& file_;
    const VtkXmlHeader& header_;
    bool isPacked_ = false;
    bool isBigEndian_ = false;
    std::uint64_t headingBytes_ = 4;
};

} // namespace

Status checkVtkXmlCells(const RandomAccessFile& file, const VtkXmlHeader& header) {
    return CellCheck(file, header).run();
}

} // namespace isoslider::io
