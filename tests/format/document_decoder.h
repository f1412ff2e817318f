#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <zstd.h>

namespace isoslider::test {

/// A second reader of pages, written from core/index/format/FORMAT.md alone, slow and plain: it shares no line
/// with the product's, so that the document and the code are compared with each other.
struct DocumentPoint {
    std::uint64_t key = 0;
    std::uint64_t id = 0;
    int mask = 0;
    int normal = -1; ///< -1: the page has none
    int rising = -1; ///< directions; -1: far keys are stated
    std::vector<std::uint64_t> farKeys;
    std::vector<int> farNormals;
};

class DocumentDecoder {
public:
    explicit DocumentDecoder(std::span<const std::byte> page) : page_(page) {}

    std::optional<std::vector<DocumentPoint>> decode(std::uint64_t idCount) {
        const std::uint64_t points = number(0, 4), edges = number(4, 4), base = number(8, 8);
        const int keyBytes = static_cast<int>(number(16, 1)), idBytes = static_cast<int>(number(17, 1));
        const bool byId = number(18, 1) == 1;
        const std::uint64_t flags = number(19, 1), planes = number(20, 4);
        const int normalBytes = flags & 8 ? 0 : 2;
        const bool hasDirections = (flags & 16) != 0;
        const int directionBytes = hasDirections ? 1 : 0, farBytes = hasDirections ? 0 : keyBytes;
        if (planes != static_cast<std::uint64_t>(keyBytes + idBytes + 1 + directionBytes + farBytes + 2 * normalBytes))
            return std::nullopt;
        tableAt_ = 32;
        dataAt_ = 32 + 4 * planes;
        const auto keys = column(points, keyBytes), ids = column(points, idBytes), masks = column(points, 1),
                   directions = column(points, directionBytes), normals = column(points, normalBytes),
                   farKeys = column(edges, farBytes), farNormals = column(edges, normalBytes);
        if (!isGood_ || dataAt_ != page_.size())
            return std::nullopt;

        const std::uint64_t keyMask = keyBytes == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << (8 * keyBytes)) - 1;
        std::vector<DocumentPoint> out;
        std::uint64_t key = base, id = 0;
        int normal = 0;
        std::size_t edge = 0;
        for (std::size_t i = 0; i < points; ++i) {
            DocumentPoint point;
            key = ((byId ? base : key) + keys[i]) & keyMask;
            id = (id + ids[i]) % idCount;
            normal = plus(normal, static_cast<int>(normals[i]));
            point.key = key;
            point.id = id;
            point.normal = normalBytes > 0 ? normal : -1;
            point.mask = static_cast<int>(masks[i]);
            // Upward edges are known before the downward ones that are predicted from them.
            const std::size_t count = static_cast<std::size_t>(std::popcount(masks[i]));
            if (hasDirections) {
                point.rising = static_cast<int>(directions[i]);
                edge += count;
                out.push_back(std::move(point));
                continue;
            }
            point.farKeys.resize(count);
            point.farNormals.resize(normalBytes > 0 ? count : 0);
            for (int pass = 1; pass >= 0; --pass) {
                std::size_t at = 0;
                for (int e = 0; e < 6; ++e) {
                    if (!(point.mask >> e & 1))
                        continue;
                    const std::size_t here = at++;
                    if (e % 2 != pass)
                        continue;
                    const bool hasPair = e % 2 == 0 && (point.mask >> (e + 1) & 1);
                    std::uint64_t predictedKey = key;
                    int predictedNormal = normal;
                    if (hasPair && (flags & 1))
                        predictedKey = 2 * key - point.farKeys[here + 1];
                    if (normalBytes > 0 && hasPair && (flags & 2))
                        predictedNormal = minus(plus(normal, normal), point.farNormals[here + 1]);
                    const std::uint64_t code = farKeys[edge + here];
                    const std::uint64_t difference = code % 2 == 0 ? code / 2 : ~(code / 2);
                    point.farKeys[here] = (predictedKey + difference) & keyMask;
                    if (normalBytes > 0)
                        point.farNormals[here] = plus(predictedNormal, static_cast<int>(farNormals[edge + here]));
                }
            }
            edge += count;
            out.push_back(std::move(point));
        }
        return edge == edges ? std::optional(std::move(out)) : std::nullopt;
    }

private:
    static int plus(int a, int b) { return ((a & 255) + (b & 255)) % 256 + (((a >> 8) + (b >> 8)) % 256) * 256; }
    static int minus(int a, int b) {
        return ((a & 255) - (b & 255) + 256) % 256 + (((a >> 8) - (b >> 8) + 256) % 256) * 256;
    }

    std::uint64_t number(std::size_t at, int bytes) {
        std::uint64_t value = 0;
        for (int i = bytes - 1; i >= 0; --i) {
            if (at + static_cast<std::size_t>(i) >= page_.size()) {
                isGood_ = false;
                return 0;
            }
            value = value * 256 + static_cast<std::uint64_t>(page_[at + static_cast<std::size_t>(i)]);
        }
        return value;
    }

    std::vector<std::uint64_t> column(std::uint64_t count, int planes) {
        std::vector<std::uint64_t> values(count, 0);
        for (int p = 0; p < planes && isGood_; ++p) {
            const std::uint64_t entry = number(tableAt_, 4);
            tableAt_ += 4;
            const std::uint64_t length = entry % (1u << 30), mode = entry >> 30;
            if (dataAt_ + length > page_.size())
                isGood_ = false;
            if (!isGood_)
                break;
            std::vector<unsigned char> plane(count);
            const std::byte* data = page_.data() + dataAt_;
            if (mode == 0)
                plane.assign(count, static_cast<unsigned char>(data[0]));
            else if (mode == 1)
                for (std::size_t i = 0; i < count; ++i)
                    plane[i] = static_cast<unsigned char>(data[i]);
            else
                isGood_ = mode == 2 && ZSTD_decompress(plane.data(), count, data, length) == count;
            dataAt_ += length;
            for (std::size_t i = 0; i < count; ++i)
                values[i] += static_cast<std::uint64_t>(plane[i]) << (8 * p);
        }
        return values;
    }

    std::span<const std::byte> page_;
    std::size_t tableAt_ = 0;
    std::size_t dataAt_ = 0;
    bool isGood_ = true;
};

} // namespace isoslider::test
