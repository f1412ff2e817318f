#include "core/volume_io/reader_process/messages.h"

#include <cmath>

#include "core/base/plain_text.h"
#include "core/grid/length_unit.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxText = std::size_t{1} << 16;

// One function for either direction keeps the order of fields the same: `Codec` is an Encoder or a Decoder.
class Encoder {
public:
    explicit Encoder(std::vector<std::byte>& out) : out_(out) {}
    template <class Value>
    void number(const Value& value) {
        out_.put<Value>(value);
    }
    void text(const std::string& value) { out_.putString(value.substr(0, kMaxText)); }
    void path(const std::filesystem::path& value) { text(value.string()); }
    template <class Enum>
    void choice(const Enum& value, Enum /*last*/) {
        out_.put<std::uint8_t>(static_cast<std::uint8_t>(value));
    }
    void flag(const bool& value) { out_.put<std::uint8_t>(value ? 1 : 0); }
    template <class Item, class Function>
    void list(const std::vector<Item>& items, const Function& each) {
        out_.put<std::uint32_t>(static_cast<std::uint32_t>(items.size()));
        for (const Item& item : items)
            each(item);
    }
    template <class Value, class Function>
    void optional(const std::optional<Value>& value, const Function& each) {
        flag(value.has_value());
        if (value)
            each(*value);
    }
    bool isGood() const { return true; }

private:
    ByteWriter out_;
};

class Decoder {
public:
    explicit Decoder(std::span<const std::byte> in) : in_(in) {}
    template <class Value>
    void number(Value& value) {
        value = in_.get<Value>();
    }
    void text(std::string& value) { value = in_.getString(kMaxText); }
    void path(std::filesystem::path& value) {
        std::string name;
        text(name);
        value = std::move(name);
    }
    template <class Enum>
    void choice(Enum& value, Enum last) {
        const auto index = in_.get<std::uint8_t>();
        hasFailed_ = hasFailed_ || index > static_cast<std::uint8_t>(last);
        value = hasFailed_ ? Enum{} : static_cast<Enum>(index);
    }
    void flag(bool& value) {
        const auto byte = in_.get<std::uint8_t>();
        hasFailed_ = hasFailed_ || byte > 1;
        value = byte == 1;
    }
    template <class Item, class Function>
    void list(std::vector<Item>& items, const Function& each) {
        const std::size_t count = in_.get<std::uint32_t>();
        for (std::size_t i = 0; i < count && isGood(); ++i) // an item takes a byte at least
            each(items.emplace_back());
    }
    template <class Value, class Function>
    void optional(std::optional<Value>& value, const Function& each) {
        bool isThere = false;
        flag(isThere);
        if (isThere && isGood())
            each(value.emplace());
    }
    bool isGood() const { return !hasFailed_ && !in_.hasFailed(); }
    bool isAtEnd() const { return in_.remaining() == 0; }

private:
    ByteReader in_;
    bool hasFailed_ = false;
};

template <class Codec, class Dims>
void dims(Codec& codec, Dims& value) {
    for (auto& size : value)
        codec.number(size);
}

template <class Codec, class Vector>
void vector(Codec& codec, Vector& value) {
    for (int i = 0; i < 3; ++i)
        codec.number(value[i]);
}

template <class Codec, class Options>
void options(Codec& codec, Options& value) {
    codec.optional(value.raw, [&](auto& raw) {
        dims(codec, raw.dims);
        codec.choice(raw.type, ScalarType::F64);
        vector(codec, raw.spacing);
        codec.number(raw.skipBytes);
        codec.flag(raw.isBigEndian);
    });
    codec.text(value.field);
    codec.optional(value.component, [&](auto& component) { codec.number(component); });
    codec.optional(value.frame, [&](auto& frame) { codec.number(frame); });
    dims(codec, value.resampleDims);
    codec.flag(value.allowsExternalData);
    codec.flag(value.allowsTrailing);
    codec.number(value.memoryBytes);
}

template <class Codec, class Request>
void request(Codec& codec, Request& value) {
    codec.choice(value.kind, RequestKind::ReadSlab);
    codec.text(value.path);
    options(codec, value.options);
    codec.number(value.zBegin);
    codec.number(value.zEnd);
}

template <class Codec, class Info>
void info(Codec& codec, Info& value) {
    dims(codec, value.geometry.dims);
    vector(codec, value.geometry.spacing);
    vector(codec, value.geometry.origin);
    for (int axis = 0; axis < 3; ++axis)
        vector(codec, value.geometry.direction[axis]);
    codec.choice(value.type, ScalarType::F64);
    codec.text(value.format);
    codec.text(value.fieldName);
    codec.list(value.dataFiles, [&](auto& file) { codec.path(file); });
    codec.text(value.fieldTitle);
    codec.text(value.lengthUnit);
    codec.flag(value.isPatientSpace);
    codec.list(value.notes, [&](auto& note) { codec.text(note); });
    codec.optional(value.resampling, [&](auto& report) {
        codec.number(report.sourcePoints);
        codec.number(report.comparedPoints);
        codec.number(report.maxDifference);
        codec.number(report.rmsDifference);
        codec.number(report.rangeFraction);
        codec.number(report.outsidePoints);
    });
}

template <class Codec, class Contents>
void contents(Codec& codec, Contents& value) {
    codec.text(value.format);
    codec.list(value.fields, [&](auto& field) {
        codec.text(field.name);
        codec.text(field.title);
        dims(codec, field.dims);
        codec.text(field.typeName);
        codec.number(field.components);
        codec.list(field.componentNames, [&](auto& name) { codec.text(name); });
        codec.flag(field.hasMagnitude);
        codec.number(field.frames);
        codec.flag(field.isResampled);
        codec.text(field.problem);
    });
    codec.number(value.preferred);
    codec.flag(value.isPreferredChosen);
}

template <class Codec, class Problem>
void error(Codec& codec, Problem& value) {
    codec.choice(value.code, ErrorCode::Cancelled);
    codec.text(value.message);
    codec.text(value.path);
    codec.optional(value.offset, [&](auto& offset) { codec.number(offset); });
}

template <class Function>
std::vector<std::byte> encoded(const Function& fill) {
    std::vector<std::byte> bytes;
    Encoder codec(bytes);
    fill(codec);
    return bytes;
}

template <class Function>
std::vector<std::byte> encodedReply(ReplyKind kind, const Function& fill) {
    return encoded([&](Encoder& codec) {
        codec.choice(kind, ReplyKind::Slab);
        fill(codec);
    });
}

template <class Value, class Function>
std::optional<Value> decoded(std::span<const std::byte> bytes, const Function& take) {
    Decoder codec(bytes);
    Value value;
    take(codec, value);
    if (!codec.isGood() || !codec.isAtEnd())
        return std::nullopt;
    return value;
}

template <class Value, class Function>
std::optional<Value> decodedReply(std::span<const std::byte> bytes, const Function& take) {
    return decoded<Value>(bytes, [&](Decoder& codec, Value& value) {
        ReplyKind kind{};
        codec.choice(kind, ReplyKind::Slab);
        take(codec, value);
    });
}

} // namespace

std::vector<std::byte> encodeRequest(const ReaderRequest& value) {
    return encoded([&](Encoder& codec) { request(codec, value); });
}

std::optional<ReaderRequest> decodeRequest(std::span<const std::byte> bytes) {
    return decoded<ReaderRequest>(bytes, [](Decoder& codec, ReaderRequest& value) { request(codec, value); });
}

std::vector<std::byte> encodeProgress(double fraction, std::string_view stage) {
    return encodedReply(ReplyKind::Progress, [&](Encoder& codec) {
        codec.number(fraction);
        codec.text(std::string(stage));
    });
}

std::vector<std::byte> encodeError(const Error& value) {
    return encodedReply(ReplyKind::Failed, [&](Encoder& codec) { error(codec, value); });
}

std::vector<std::byte> encodeInfo(const VolumeInfo& value) {
    return encodedReply(ReplyKind::Info, [&](Encoder& codec) { info(codec, value); });
}

std::vector<std::byte> encodeContents(const VolumeContents& value) {
    return encodedReply(ReplyKind::Contents, [&](Encoder& codec) { contents(codec, value); });
}

std::vector<std::byte> encodeSlab() {
    return encodedReply(ReplyKind::Slab, [](Encoder&) {});
}

std::optional<ReplyKind> replyKind(std::span<const std::byte> bytes) {
    if (bytes.empty() || bytes[0] > static_cast<std::byte>(ReplyKind::Slab))
        return std::nullopt;
    return static_cast<ReplyKind>(bytes[0]);
}

std::optional<ReaderProgress> decodeProgress(std::span<const std::byte> bytes) {
    auto value = decodedReply<ReaderProgress>(bytes, [](Decoder& codec, ReaderProgress& progress) {
        codec.number(progress.fraction);
        codec.text(progress.stage);
    });
    if (value && !(value->fraction >= 0.0 && value->fraction <= 1.0))
        return std::nullopt;
    return value;
}

std::optional<Error> decodeError(std::span<const std::byte> bytes) {
    auto value = decodedReply<Error>(bytes, [](Decoder& codec, Error& problem) { error(codec, problem); });
    if (value)
        value->message = oneLine(value->message);
    return value;
}

std::optional<VolumeInfo> decodeInfo(std::span<const std::byte> bytes) {
    auto value = decodedReply<VolumeInfo>(bytes, [](Decoder& codec, VolumeInfo& volume) { info(codec, volume); });
    if (!value || !checkDims(value->geometry.dims, "dims", {}).isOk() ||
        !checkGeometry(value->geometry, "geometry", {}).isOk() || !isLengthUnit(value->lengthUnit))
        return std::nullopt;
    value->fieldTitle = oneLine(value->fieldTitle);
    for (std::string& note : value->notes)
        note = oneLine(note);
    return value;
}

std::optional<VolumeContents> decodeContents(std::span<const std::byte> bytes) {
    auto value =
        decodedReply<VolumeContents>(bytes, [](Decoder& codec, VolumeContents& volumes) { contents(codec, volumes); });
    if (!value || value->fields.empty() || value->preferred >= value->fields.size())
        return std::nullopt;
    for (VolumeField& field : value->fields) {
        field.title = oneLine(field.title);
        field.problem = oneLine(field.problem);
        if (field.components < 1 || field.frames < 1 ||
            (!field.componentNames.empty() &&
             field.componentNames.size() != static_cast<std::size_t>(field.components)))
            return std::nullopt;
    }
    return value;
}

} // namespace isoslider::io
