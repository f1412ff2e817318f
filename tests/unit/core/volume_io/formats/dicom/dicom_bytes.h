#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/unit/core/volume_io/volume_bytes.h"

// DICOM files as byte strings, small and sound; tests damage them.

namespace isoslider::test {

inline constexpr const char* kImplicitLittle = "1.2.840.10008.1.2";
inline constexpr const char* kExplicitLittle = "1.2.840.10008.1.2.1";
inline constexpr const char* kDeflatedLittle = "1.2.840.10008.1.2.1.99";
inline constexpr const char* kExplicitBig = "1.2.840.10008.1.2.2";
inline constexpr const char* kRunLength = "1.2.840.10008.1.2.5";

/// Elements of a data set, in the order of their tags whatever the order in which they are set.
class DicomElements {
public:
    struct Value {
        std::string vr;
        std::string text; ///< or bytes
        std::vector<double> numbers; ///< of US, SS, UL, FD
        std::vector<DicomElements> items; ///< of SQ
        std::uint32_t statedBytes = 0; ///< instead of the true length, unless 0
    };

    DicomElements& text(std::uint32_t tag, std::string vr, std::string value) {
        values_[tag] = {std::move(vr), std::move(value), {}, {}};
        return *this;
    }
    DicomElements& number(std::uint32_t tag, std::string vr, double value) {
        values_[tag] = {std::move(vr), "", {value}, {}};
        return *this;
    }
    DicomElements& sequence(std::uint32_t tag, std::vector<DicomElements> items) {
        values_[tag] = {"SQ", "", {}, std::move(items)};
        return *this;
    }
    DicomElements& without(std::uint32_t tag) {
        values_.erase(tag);
        return *this;
    }
    DicomElements& stating(std::uint32_t tag, std::uint32_t bytes) {
        values_[tag].statedBytes = bytes;
        return *this;
    }

    std::string bytes(bool isExplicit = true, bool isBigEndian = false) const {
        std::string all;
        for (const auto& [tag, value] : values_) {
            std::string body = value.text;
            for (const double number : value.numbers)
                body += encoded(value.vr, number, isBigEndian);
            for (const DicomElements& item : value.items) {
                const std::string inner = item.bytes(isExplicit, isBigEndian);
                body += tagBytes(0xfffee000, isBigEndian) + integer(inner.size(), 4, isBigEndian) + inner;
            }
            if (body.size() % 2 != 0)
                body += value.vr == "UI" || value.vr == "OB" ? '\0' : ' ';
            const std::uint64_t stated = value.statedBytes != 0 ? value.statedBytes : body.size();
            all += tagBytes(tag, isBigEndian);
            const bool isLong = value.vr == "SQ" || value.vr == "OB" || value.vr == "OW" || value.vr == "UN";
            if (!isExplicit)
                all += integer(stated, 4, isBigEndian);
            else if (isLong)
                all += value.vr + std::string(2, '\0') + integer(stated, 4, isBigEndian);
            else
                all += value.vr + integer(stated, 2, isBigEndian);
            all += body;
        }
        return all;
    }

    static std::string integer(std::uint64_t value, int size, bool isBigEndian = false) {
        std::string bytes;
        for (int i = 0; i < size; ++i)
            bytes += static_cast<char>(value >> (8 * (isBigEndian ? size - 1 - i : i)) & 255);
        return bytes;
    }
    static std::string tagBytes(std::uint32_t tag, bool isBigEndian = false) {
        return integer(tag >> 16, 2, isBigEndian) + integer(tag & 0xffff, 2, isBigEndian);
    }

private:
    static std::string encoded(const std::string& vr, double number, bool isBigEndian) {
        if (vr != "FD")
            return integer(static_cast<std::uint64_t>(static_cast<std::int64_t>(number)), vr == "UL" ? 4 : 2,
                           isBigEndian);
        std::uint64_t bits;
        std::memcpy(&bits, &number, sizeof bits);
        return integer(bits, 8, isBigEndian);
    }

    std::map<std::uint32_t, Value> values_;
};

/// An 8 x 6 slice of i16 at z, with samples made by `sample(x, y)`; spacing 0.5 along rows, 0.75 along
/// columns.
inline DicomElements dicomSlice(double z, int instance, const std::function<int(int, int)>& sample = {}) {
    DicomElements e;
    std::string samples;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x)
            samples += DicomElements::integer(
                static_cast<std::uint64_t>(static_cast<std::int64_t>(sample ? sample(x, y) : x + 10 * y)), 2);
    e.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.4").text(0x00080018, "UI", "1.2.3." + std::to_string(instance));
    e.text(0x00080021, "DA", "20240131").text(0x00080060, "CS", "MR").text(0x0008103e, "LO", "probe");
    e.text(0x00180050, "DS", "9").text(0x0020000e, "UI", "1.2.3").text(0x00200011, "IS", "4");
    e.text(0x00200013, "IS", std::to_string(instance));
    e.text(0x00200032, "DS", "10\\20\\" + std::to_string(z)).text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    e.number(0x00280002, "US", 1).text(0x00280004, "CS", "MONOCHROME2");
    e.number(0x00280010, "US", 6).number(0x00280011, "US", 8).text(0x00280030, "DS", "0.75\\0.5");
    e.number(0x00280100, "US", 16).number(0x00280101, "US", 16).number(0x00280102, "US", 15);
    e.number(0x00280103, "US", 1).text(0x7fe00010, "OW", samples);
    return e;
}

/// A whole file. Of big-endian syntaxes `elements` have to bring big-endian samples.
inline std::string dicomFile(const DicomElements& elements, const std::string& transferSyntax = kExplicitLittle) {
    DicomElements meta;
    meta.text(0x00020010, "UI", transferSyntax);
    const std::string head = meta.bytes();
    DicomElements length;
    length.text(0x00020000, "UL", DicomElements::integer(head.size(), 4));
    const std::string start = std::string(128, '\0') + "DICM" + length.bytes() + head;
    if (transferSyntax == kDeflatedLittle)
        return start + packed(elements.bytes(), -15);
    return start + elements.bytes(transferSyntax != kImplicitLittle, transferSyntax == kExplicitBig);
}

/// The value of encapsulated samples: a table of offsets, the fragments, the mark at the end.
inline std::string dicomFragments(const std::vector<std::string>& fragments, const std::string& table = "") {
    std::string all = DicomElements::tagBytes(0xfffee000) + DicomElements::integer(table.size(), 4) + table;
    for (const std::string& fragment : fragments)
        all += DicomElements::tagBytes(0xfffee000) + DicomElements::integer(fragment.size(), 4) + fragment;
    return all + DicomElements::tagBytes(0xfffee0dd) + DicomElements::integer(0, 4);
}

/// The same with its samples, that are not the last element, in fragments.
inline DicomElements encapsulated(DicomElements elements, const std::string& fragments) {
    return elements.text(0x7fe00010, "OB", fragments).stating(0x7fe00010, 0xffffffff);
}

} // namespace isoslider::test
