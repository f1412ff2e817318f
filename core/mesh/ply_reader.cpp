#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "core/base/plain_text.h"
#include "core/mesh/loop_control.h"
#include "core/mesh/mesh_readers.h"
#include "core/mesh/text_scan.h"

namespace isoslider::mesh {
namespace {

enum class Type { I8, U8, I16, U16, I32, U32, F32, F64 };
enum class Encoding { Text, LittleEndian, BigEndian };

struct TypeName {
    std::string_view name, other;
    Type type;
};
constexpr TypeName kTypes[] = {{"char", "int8", Type::I8},      {"uchar", "uint8", Type::U8},
                               {"short", "int16", Type::I16},   {"ushort", "uint16", Type::U16},
                               {"int", "int32", Type::I32},     {"uint", "uint32", Type::U32},
                               {"float", "float32", Type::F32}, {"double", "float64", Type::F64}};

std::optional<Type> typeOf(std::string_view name) {
    for (const TypeName& known : kTypes)
        if (name == known.name || name == known.other)
            return known.type;
    return std::nullopt;
}

struct Property {
    std::string name;
    Type type = Type::F32;
    std::optional<Type> countType; ///< set: a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::Text;
    std::vector<Element> elements;
};

Error refuse(std::string message, const std::filesystem::path& path) {
    return makeError(ErrorCode::InvalidArgument, std::move(message), path);
}

Status addProperty(Header& header, std::string_view line, const std::filesystem::path& path) {
    Property property;
    std::string_view word = nextWord(line);
    if (word == "list") {
        property.countType = typeOf(nextWord(line));
        if (!property.countType || *property.countType >= Type::F32)
            return refuse("property: a list needs a whole-number type for its length", path);
        word = nextWord(line);
    }
    const auto type = typeOf(word);
    property.name = nextWord(line);
    if (!type || property.name.empty() || header.elements.empty())
        return refuse("property: type and name expected, found " + inQuotes(word), path);
    property.type = *type;
    header.elements.back().properties.push_back(std::move(property));
    return {};
}

Status addHeaderLine(Header& header, std::string_view line, const std::filesystem::path& path) {
    const std::string_view key = nextWord(line);
    if (key == "format") {
        const std::string_view name = nextWord(line);
        if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
            return refuse("format: " + inQuotes(name) + " is not known", path);
        header.encoding = name == "ascii"               ? Encoding::Text
                          : name == "binary_big_endian" ? Encoding::BigEndian
                                                        : Encoding::LittleEndian;
        return {};
    }
    if (key == "element") {
        Element element;
        element.name = nextWord(line);
        const std::string_view count = nextWord(line);
        if (!parseNumber(count, element.count) || header.elements.size() > 100)
            return refuse("element: name and count expected, found " + inQuotes(count), path);
        header.elements.push_back(std::move(element));
        return {};
    }
    if (key == "property")
        return addProperty(header, line, path);
    if (key == "comment" || key == "obj_info" || key.empty())
        return {};
    return refuse("header: " + inQuotes(key) + " is not known", path);
}

/// Takes numbers one after the other, from text or bytes. Exact for every PLY type.
class Numbers {
public:
    Numbers(std::string_view rest, Encoding encoding) : rest_(rest), encoding_(encoding) {}

    std::size_t remaining() const { return rest_.size(); }
    /// Besides blanks at the end of a text.
    bool isAtEnd() const {
        return encoding_ == Encoding::Text ? rest_.find_first_not_of(" \t\r\n") == std::string_view::npos
                                           : rest_.empty();
    }

    bool take(Type type, double& out) {
        if (encoding_ == Encoding::Text)
            return parseNumber(nextWord(rest_), out);
        switch (type) {
            case Type::I8: return takeAs<std::int8_t>(out);
            case Type::U8: return takeAs<std::uint8_t>(out);
            case Type::I16: return takeAs<std::int16_t>(out);
            case Type::U16: return takeAs<std::uint16_t>(out);
            case Type::I32: return takeAs<std::int32_t>(out);
            case Type::U32: return takeAs<std::uint32_t>(out);
            case Type::F32: return takeAs<float>(out);
            case Type::F64: return takeAs<double>(out);
        }
        return false;
    }

private:
    template <class T>
    bool takeAs(double& out) {
        if (rest_.size() < sizeof(T))
            return false;
        char bytes[sizeof(T)];
        std::memcpy(bytes, rest_.data(), sizeof(T));
        if ((encoding_ == Encoding::BigEndian) != (std::endian::native == std::endian::big))
            std::reverse(bytes, bytes + sizeof(T));
        T value;
        std::memcpy(&value, bytes, sizeof(T));
        out = static_cast<double>(value);
        rest_.remove_prefix(sizeof(T));
        return true;
    }

    std::string_view rest_;
    Encoding encoding_;
};

class Body {
public:
    Body(Numbers numbers, const std::filesystem::path& path, const JobControl& job)
        : numbers_(numbers), path_(path), bytes_(numbers.remaining()), loop_(job, bytes_, "reading") {}

    Result<TriangleSoup> read(const Header& header) {
        for (const Element& element : header.elements) {
            if (element.properties.empty())
                continue; // takes no bytes, however many there are
            if (element.count > numbers_.remaining())
                return makeError(ErrorCode::Corruption,
                                 "element " + element.name + ": the header asks for " + std::to_string(element.count) +
                                     ", the file cannot hold them",
                                 path_);
            for (std::uint64_t i = 0; i < element.count; ++i) {
                if (!loop_.goesOn(bytes_ - numbers_.remaining()))
                    return cancelledError();
                ISO_TRY(readItem(element, i));
            }
        }
        if (!numbers_.isAtEnd())
            return makeError(ErrorCode::Corruption, "has bytes behind the last element that its header names", path_);
        ISO_TRY(checkIndices(soup_, path_));
        return std::move(soup_);
    }

private:
    Status readItem(const Element& element, std::uint64_t number) {
        glm::dvec3 position(0.0);
        corners_.clear();
        for (const Property& property : element.properties) {
            double value = 0.0;
            double count = 1.0;
            const bool isCorners = property.name == "vertex_indices" || property.name == "vertex_index";
            if (property.countType && !takeCount(*property.countType, count))
                return endError(element, number);
            for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
                if (!numbers_.take(property.type, value))
                    return endError(element, number);
                if (property.countType && isCorners)
                    corners_.push_back(std::abs(value) < 1e15 ? static_cast<std::int64_t>(value) : -1);
            }
            if (!property.countType && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
                position[property.name[0] - 'x'] = value;
        }
        if (element.name == "vertex")
            soup_.positions.push_back(position);
        else if (element.name == "face")
            ISO_TRY(addPolygon(soup_, corners_, path_));
        return {};
    }

    bool takeCount(Type type, double& count) {
        return numbers_.take(type, count) && count >= 0.0 && count <= static_cast<double>(numbers_.remaining());
    }

    Error endError(const Element& element, std::uint64_t number) const {
        return makeError(ErrorCode::Corruption,
                         element.name + " " + std::to_string(number) + ": the file ends early or is damaged", path_);
    }

    Numbers numbers_;
    const std::filesystem::path& path_;
    std::size_t bytes_;
    LoopControl loop_;
    TriangleSoup soup_;
    std::vector<std::int64_t> corners_;
};

} // namespace

Result<TriangleSoup> readPly(std::string_view bytes, const std::filesystem::path& path, const JobControl& job) {
    std::string_view rest = bytes, line;
    if (!nextLine(rest, line) || line != "ply")
        return refuse("is not a readable ply mesh: its first line is not 'ply'", path);
    Header header;
    while (nextLine(rest, line)) {
        if (line == "end_header")
            return Body(Numbers(rest, header.encoding), path, job).read(header);
        if (line.size() > 1000)
            break;
        ISO_TRY(addHeaderLine(header, line, path));
    }
    return refuse("is not a readable ply mesh: its header does not end", path);
}

} // namespace isoslider::mesh
