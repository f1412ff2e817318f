#include "core/extract/vertex_interpolation.h"

#include <limits>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/extract/edge_interpolation.h"

namespace isoslider::extract {
namespace {

template <class Live>
class VertexInterpolation : public testing::Test {
protected:
    void add(Live scalar1, Live scalar2, NormalCode normal1, NormalCode normal2, LocalEdge edge) {
        scalars1_.push_back(scalar1);
        scalars2_.push_back(scalar2);
        normalCodes_.push_back(normal1 | static_cast<std::uint32_t>(normal2) << 16);
        edges_.push_back(edge);
    }

    void run(Live isovalue) {
        const std::size_t count = edges_.size();
        const std::size_t room = (count + kInterpolationGroup - 1) / kInterpolationGroup * kInterpolationGroup;
        scalars1_.resize(room);
        scalars2_.resize(room);
        normalCodes_.resize(room);
        edges_.resize(room);
        positions_.assign(room, glm::vec3(-7.0f));
        normals_.assign(room, glm::vec3(-7.0f));
        interpolateVertices({scalars1_.data(), scalars2_.data(), normalCodes_.data(), edges_.data()}, count, kOrigin, isovalue,
                            positions_.data(), normals_.data());
        for (std::size_t i = 0; i < count; ++i)
            check(i, isovalue);
    }

    // One vertex, the plain way.
    void check(std::size_t i, Live isovalue) const {
        const int axis = edges_[i] / 512, local = edges_[i] % 512;
        const float t = static_cast<float>(edgeFraction<Live>(scalars1_[i], scalars2_[i], isovalue));
        glm::vec3 position(static_cast<float>(kOrigin[0] + local % 8), static_cast<float>(kOrigin[1] + local / 8 % 8),
                           static_cast<float>(kOrigin[2] + local / 64));
        position[axis] += t;
        ASSERT_EQ(positions_[i], position) << i;
        const glm::dvec3 n1(decodeDirection(static_cast<NormalCode>(normalCodes_[i] & 0xffff)));
        const glm::dvec3 n2(decodeDirection(static_cast<NormalCode>(normalCodes_[i] >> 16)));
        const glm::dvec3 sum = n1 + static_cast<double>(t) * (n2 - n1);
        glm::dvec3 expected = sum / glm::length(sum);
        if (glm::dot(sum, sum) < 1e-13) {
            expected = glm::dvec3(0.0);
            expected[axis] = scalars1_[i] < scalars2_[i] ? -1.0 : 1.0;
        } else if (glm::dot(sum, sum) < 1e-6) {
            return; // nearly opposite: any direction will do, but of unit length
        }
        ASSERT_LT(glm::length(glm::dvec3(normals_[i]) - expected), 1e-4) << i;
    }

    static constexpr std::array<std::int32_t, 3> kOrigin{80, 1048568, 8};
    std::vector<Live> scalars1_, scalars2_;
    std::vector<std::uint32_t> normalCodes_;
    std::vector<LocalEdge> edges_;
    std::vector<glm::vec3> positions_, normals_;
};

using LiveTypes = testing::Types<float, double>;
TYPED_TEST_SUITE(VertexInterpolation, LiveTypes);

NormalCode randomCode(std::mt19937& random) {
    if (random() % 8 == 0)
        return kNoNormal;
    const auto byte = [&] { return static_cast<unsigned>(static_cast<int>(random() % 255) - 127) & 255; };
    const unsigned u = byte();
    return static_cast<NormalCode>(u | byte() << 8);
}

TYPED_TEST(VertexInterpolation, DoesWhatTheScalarFormulaDoes) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> value(-100.0, 100.0);
    for (const std::size_t count : {1, 7, 8, 15, 16, 17, 400}) {
        this->scalars1_.clear();
        this->scalars2_.clear();
        this->normalCodes_.clear();
        this->edges_.clear();
        const double isovalue = value(random);
        for (std::size_t i = 0; i < count; ++i) {
            double low = isovalue - std::abs(value(random)), high = isovalue + std::abs(value(random));
            if (random() % 5 == 0)
                high = isovalue; // a tie
            if (random() % 2)
                std::swap(low, high);
            const NormalCode first = randomCode(random);
            this->add(static_cast<TypeParam>(low), static_cast<TypeParam>(high), first, random() % 3 ? randomCode(random) : first,
                      static_cast<LocalEdge>(random() % 1536));
        }
        this->run(static_cast<TypeParam>(isovalue));
    }
}

TYPED_TEST(VertexInterpolation, PointsAlongTheEdgeWhereTheFieldIsFlat) {
    for (int axis = 0; axis < 3; ++axis) {
        this->add(1, 3, kNoNormal, kNoNormal, static_cast<LocalEdge>(512 * axis + 77));
        this->add(3, 1, kNoNormal, kNoNormal, static_cast<LocalEdge>(512 * axis + 77));
        // Opposite normals that cancel in the middle.
        this->add(1, 3, encodeNormal({0, 0, 1}), encodeNormal({0, 0, -1}), static_cast<LocalEdge>(512 * axis + 5));
    }
    this->run(2);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(this->normals_[3 * axis][static_cast<int>(axis)], -1.0f) << "towards the lower scalar";
        EXPECT_EQ(this->normals_[3 * axis + 1][static_cast<int>(axis)], 1.0f);
        EXPECT_EQ(this->normals_[3 * axis + 2][static_cast<int>(axis)], -1.0f);
    }
}

TYPED_TEST(VertexInterpolation, StaysFiniteAtTheEndsOfTheRange) {
    using Limits = std::numeric_limits<TypeParam>;
    const TypeParam values[] = {Limits::lowest(), Limits::max(), -1, 0, 1, Limits::min()};
    for (const TypeParam isovalue : values) {
        this->scalars1_.clear();
        this->scalars2_.clear();
        this->normalCodes_.clear();
        this->edges_.clear();
        for (const TypeParam a : values)
            for (const TypeParam b : values)
                if ((a >= isovalue) != (b >= isovalue))
                    this->add(a, b, kNoNormal, 0x0501, 600);
        this->run(isovalue);
        for (std::size_t i = 0; i < this->positions_.size(); ++i)
            EXPECT_TRUE(std::isfinite(this->positions_[i].y) && std::isfinite(this->normals_[i].y));
    }
}

TYPED_TEST(VertexInterpolation, PlacesDenormalsAsTheScalarFormulaDoes) {
    constexpr TypeParam kUnit = std::numeric_limits<TypeParam>::denorm_min();
    for (int a = -9; a < 9; ++a)
        for (int b = -9; b < 9; ++b)
            if ((a >= 1) != (b >= 1))
                this->add(static_cast<TypeParam>(a) * kUnit, static_cast<TypeParam>(b) * kUnit, 0x0102, 0x0304, 5);
    this->run(kUnit);
}

} // namespace
} // namespace isoslider::extract
