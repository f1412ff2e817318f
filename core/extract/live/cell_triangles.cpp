#include "core/extract/live/cell_triangles.h"

#include <algorithm>
#include <numeric>
#include <vector>

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/live/cell_triangles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/extract/live/bit_lists-inl.h"
#include "core/extract/live/wide_bits-inl.h"

#ifndef ISO_CELL_SHUFFLES
#define ISO_CELL_SHUFFLES
namespace isoslider::extract {

/// How the vertex numbers of a cell's triangles come out of two vectors of eight numbers that are gathered from the
/// vertex table, as byte shuffles: of the 16 numbers written, from each of the two vectors.
struct alignas(64) CellShuffle {
    std::array<std::uint8_t, 32> fromFirst, fromSecond;
};
/// Lane of each cell edge: 0 to 7 in the first vector, 8 to 15 in the second. See gathered in writeTriangles().
inline constexpr std::array<int, 12> kLaneOfCellEdge{0, 3, 8, 11, 1, 5, 9, 13, 2, 6, 4, 7};

struct PlainCells {
    std::array<CellShuffle, 256> shuffles;
    std::array<std::uint8_t, 256> corners; ///< 3 per triangle, at most 15; 0 for ambiguous signs
};
const PlainCells& plainCells();

/// ambiguousSignTable() as bits.
const std::array<std::uint8_t, 32>& ambiguousSignBits();

/// The triangles of a state as lanes: those of the two vectors above, then inner vertices.
struct StateCorners {
    static constexpr std::size_t kMost = 3 * cell::kMaxStateTriangles;
    static constexpr std::uint8_t kFirstInner = 16;
    std::uint8_t count = 0;
    std::uint8_t innerVertices = 0;
    std::array<std::uint8_t, kMost + 3> lanes{}; ///< read four at a time
};
const std::vector<StateCorners>& stateCorners();

/// The triangles of a state as lanes of 64: 8 for each of the pieces of the vertex table that begin 0, 9, 81 and 90
/// points further on (two points of four places each), then inner vertices.
struct StateLanes {
    static constexpr std::size_t kAtOnce = 32;
    static constexpr std::uint16_t kFirstInner = 32;
    using Group = std::array<std::uint16_t, kAtOnce>;
    struct alignas(64) Aligned : Group {};

    /// Of cells whose signs determine their triangles, by signs: those fit into 16 numbers.
    alignas(64) std::array<std::array<std::uint8_t, 16>, 256> plain{};
    std::vector<Aligned> first; ///< by state
    std::vector<Aligned> others; ///< of the few states with more corners
    std::vector<std::uint16_t> firstOther; ///< by state
    std::vector<std::uint8_t> counts, innerVertices;
    static const Aligned kUpwards; ///< 0 to 31

    const std::uint16_t* rest(cell::StateId state, std::size_t from) const {
        return others[firstOther[state] + from / kAtOnce - 1].data();
    }
};
const StateLanes& stateLanes();

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET <= HWY_AVX3 && HWY_TARGET > HWY_AVX3_DL
// Signs of the cells at all points, 64 at a time: a bit string per corner, each shifted by the corner's place.
HWY_INLINE void findAllSigns(const BitString& above, std::uint8_t* HWY_RESTRICT signs) {
    const hn::CappedTag<std::uint8_t, 64> d;
    for (int i = 0; i < kBitWords; ++i) {
        auto all = hn::Zero(d);
        const auto add = [&](std::uint64_t word, int corner) HWY_ATTR {
            const auto isAbove = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&word));
            all = hn::Or(all, hn::IfThenElseZero(isAbove, hn::Set(d, static_cast<std::uint8_t>(1 << corner))));
        };
        add(shiftedDown<0>(above, i), 0);
        add(shiftedDown<1>(above, i), 1);
        add(shiftedDown<9>(above, i), 2);
        add(shiftedDown<10>(above, i), 3);
        add(shiftedDown<81>(above, i), 4);
        add(shiftedDown<82>(above, i), 5);
        add(shiftedDown<90>(above, i), 6);
        add(shiftedDown<91>(above, i), 7);
        hn::Store(all, d, signs + 64 * i);
    }
}
#elif HWY_TARGET > HWY_AVX3 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
// The bytes K places behind those of `here`, where `next` follows it.
template <int K, class D, class V>
HWY_INLINE V bytesBehind(D d, V here, V next) {
    if constexpr (hn::MaxLanes(d) == 32)
        return hn::CombineShiftRightBytes<K>(d, hn::ConcatLowerUpper(d, next, here), here);
    else
        return hn::CombineShiftRightBytes<K>(d, next, here);
}

// Signs of the cells at all points: a byte for each, joined with that of the next point, line and plane in turn.
HWY_INLINE void findAllSigns(const BitString& above, std::uint8_t* HWY_RESTRICT signs) {
    const hn::CappedTag<std::uint8_t, 32> d;
    const hn::Repartition<std::uint16_t, decltype(d)> shorts;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    const auto up = [&](auto bytes, auto shift) HWY_ATTR { // none of the bits leaves its byte
        return hn::BitCast(d, hn::ShiftLeft<decltype(shift)::value>(hn::BitCast(shorts, bytes)));
    };
    const auto bits = reinterpret_cast<const std::uint8_t*>(above.words.data());
    const auto pointsFrom = [&](std::size_t p) HWY_ATTR {
        return hn::IfThenElseZero(hn::LoadMaskBits(d, bits + p / 8), hn::Set(d, 1));
    };
    const auto lineFrom = [&](auto points, auto next) HWY_ATTR {
        return hn::Or(points, up(bytesBehind<1>(d, points, next), std::integral_constant<int, 1>()));
    };
    auto points = pointsFrom(lanes);
    auto line = lineFrom(pointsFrom(0), points);
#pragma GCC unroll 2
    for (std::size_t p = 0; p < kPaddedPoints; p += lanes) { // of points behind the last there are words to read
        const auto nextPoints = pointsFrom(p + 2 * lanes);
        const auto nextLine = lineFrom(points, nextPoints);
        hn::Store(hn::Or(line, up(bytesBehind<9>(d, line, nextLine), std::integral_constant<int, 2>())), d, signs + p);
        points = nextPoints;
        line = nextLine;
    }
    constexpr std::size_t kBehindCells = 8 * kPointStride[2];
    for (std::size_t p = 0; p < kBehindCells; p += lanes)
        hn::Store(hn::Or(hn::Load(d, signs + p),
                         up(hn::LoadU(d, signs + p + kPointStride[2]), std::integral_constant<int, 4>())),
                  d, signs + p);
}
#endif

#if HWY_TARGET <= HWY_AVX3_DL
// Which of 64 signs are ambiguous: a bit in 32 bytes.
HWY_INLINE std::uint64_t whichAreAmbiguous(__m512i signs, __m512i table) {
    const __m512i bitOf = _mm512_set1_epi64(static_cast<long long>(0x8040201008040201u));
    const __m512i byte =
        _mm512_permutexvar_epi8(_mm512_and_si512(_mm512_srli_epi16(signs, 3), _mm512_set1_epi8(0x1f)), table);
    const __m512i bit = _mm512_shuffle_epi8(bitOf, _mm512_and_si512(signs, _mm512_set1_epi8(7)));
    return _mm512_test_epi8_mask(byte, bit);
}

void listCellsHere(const BitString& active, const BitString& above, CellList& list) {
    auto* const cells = reinterpret_cast<std::uint16_t*>(list.cells.data());
    list.count = static_cast<std::uint32_t>(listBits<1>(active, 0, cells) - cells);
    const WideBits here = WideBits::load(above);
    std::array<UnsetBits, 8> corners; // above, at the place of each corner
    here.store(corners[0]);
    here.down<1>().store(corners[1]);
    here.down<9>().store(corners[2]);
    here.down<10>().store(corners[3]);
    here.down<81>().store(corners[4]);
    here.down<82>().store(corners[5]);
    here.down<90>().store(corners[6]);
    here.down<91>().store(corners[7]);
    std::uint8_t* end = list.signs.data();
    for (std::size_t w = 0; w < kBitWords; ++w) {
        __m512i signs = _mm512_setzero_si512();
        for (std::size_t c = 0; c < corners.size(); ++c)
            signs = _mm512_or_si512(signs, _mm512_maskz_set1_epi8(corners[c].words[w], static_cast<char>(1 << c)));
        _mm512_storeu_si512(end, _mm512_maskz_compress_epi8(active.words[w], signs));
        end += std::popcount(active.words[w]);
    }
    const __m512i table =
        _mm512_castsi256_si512(_mm256_load_si256(reinterpret_cast<const __m256i*>(ambiguousSignBits().data())));
    list.ambiguousCount = 0;
    for (std::uint32_t k = 0; k < list.count; k += 64) {
        const __m512i signs = _mm512_loadu_si512(list.signs.data() + k);
        _mm512_storeu_si512(list.states.data() + k, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(signs)));
        _mm512_storeu_si512(list.states.data() + k + 32, _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(signs, 1)));
        std::uint64_t ambiguous = whichAreAmbiguous(signs, table);
        if (list.count - k < 64)
            ambiguous &= (std::uint64_t{1} << (list.count - k)) - 1;
        for (; ambiguous != 0; ambiguous &= ambiguous - 1)
            list.ambiguous[list.ambiguousCount++] =
                static_cast<std::uint16_t>(k + static_cast<std::uint32_t>(std::countr_zero(ambiguous)));
    }
}
#else
// States, and which are ambiguous, of the signs that are listed.
HWY_INLINE void findStates(CellList& list) {
    list.ambiguousCount = 0;
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
    for (std::uint32_t k = 0; k < list.count; ++k) {
        list.states[k] = list.signs[k];
        list.ambiguous[list.ambiguousCount] = static_cast<std::uint16_t>(k);
        list.ambiguousCount += ambiguousSignTable()[list.signs[k]];
    }
#else
    const hn::CappedTag<std::uint8_t, 32> d;
    const hn::Half<decltype(d)> half;
    const hn::RepartitionToWide<decltype(d)> shorts;
    constexpr auto lanes = static_cast<std::uint32_t>(hn::MaxLanes(d));
    // A bit in 32 bytes: which of them, in two tables of 16, then which of its bits.
    const std::uint8_t* const bits = ambiguousSignBits().data();
    alignas(16) static constexpr std::uint8_t kBits[16] = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    const auto low = hn::LoadDup128(d, bits), high = hn::LoadDup128(d, bits + 16), bitOf = hn::LoadDup128(d, kBits);
    for (std::uint32_t k = 0; k < list.count; k += lanes) {
        const auto signs = hn::LoadU(d, list.signs.data() + k);
        hn::StoreU(hn::PromoteTo(shorts, hn::LowerHalf(half, signs)), shorts, list.states.data() + k);
        hn::StoreU(hn::PromoteTo(shorts, hn::UpperHalf(half, signs)), shorts, list.states.data() + k + lanes / 2);
        const auto place = hn::And(hn::ShiftRight<3>(signs), hn::Set(d, 15));
        const auto byte = hn::IfThenElse(hn::TestBit(signs, hn::Set(d, 128)), hn::TableLookupBytes(high, place),
                                         hn::TableLookupBytes(low, place));
        const auto bit = hn::TableLookupBytes(bitOf, hn::And(signs, hn::Set(d, 7)));
        std::uint64_t ambiguous = 0;
        hn::StoreMaskBits(d, hn::TestBit(byte, bit), reinterpret_cast<std::uint8_t*>(&ambiguous));
        if (list.count - k < lanes)
            ambiguous &= (std::uint64_t{1} << (list.count - k)) - 1;
        for (; ambiguous != 0; ambiguous &= ambiguous - 1)
            list.ambiguous[list.ambiguousCount++] = static_cast<std::uint16_t>(k + firstBit(ambiguous));
    }
#endif
}

void listCellsHere(const BitString& active, const BitString& above, CellList& list) {
    auto* const cells = reinterpret_cast<std::uint16_t*>(list.cells.data());
    list.count = static_cast<std::uint32_t>(listBits<1>(active, 0, cells) - cells);
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
    for (std::uint32_t k = 0; k < list.count; ++k)
        list.signs[k] = signsOfCell(above, list.cells[k]);
#else
    alignas(64) std::array<std::uint8_t, kPaddedPoints> allSigns;
    findAllSigns(above, allSigns.data());
#pragma GCC unroll 4
    for (std::uint32_t k = 0; k < list.count; ++k)
        list.signs[k] = allSigns[list.cells[k].index()];
#endif
    findStates(list);
}
#endif

#if HWY_TARGET <= HWY_AVX3
// The edges of a cell are in 32 lanes, four pieces of the vertex table, and one permutation brings them into the order
// of its triangles; where its signs leave these open, with inner vertices in further lanes.
template <bool kHasMany>
HWY_INLINE std::uint32_t writeTrianglesOf(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                                          std::uint16_t* out) {
    const StateLanes& lanes = stateLanes();
    std::uint16_t* const begin = out;
    const __m512i upwards = _mm512_load_si512(StateLanes::kUpwards.data());
    for (std::uint32_t k = 0; k < list.count; ++k) {
        const std::uint16_t* const at = vertices.numbers.data() + 4 * list.cells[k].index();
        const auto piece = [](const std::uint16_t* from) {
            return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
        };
        const __m256i lower = _mm256_inserti128_si256(_mm256_castsi128_si256(piece(at)), piece(at + 4 * 9), 1);
        const __m256i upper =
            _mm256_inserti128_si256(_mm256_castsi128_si256(piece(at + 4 * 81)), piece(at + 4 * 90), 1);
        const cell::StateId state = list.states[k];
        const std::size_t count = lanes.counts[state];
        if (!kHasMany && HWY_LIKELY(state < 256)) {
            const __m256i order =
                _mm256_cvtepu8_epi16(_mm_load_si128(reinterpret_cast<const __m128i*>(lanes.plain[state].data())));
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_permutex2var_epi16(lower, order, upper));
            out += count;
            continue;
        }
        const __m512i edges = _mm512_inserti64x4(_mm512_castsi256_si512(lower), upper, 1);
        const __m512i inner = _mm512_add_epi16(upwards, _mm512_set1_epi16(static_cast<short>(firstInner)));
        _mm512_storeu_si512(out, _mm512_permutex2var_epi16(edges, _mm512_load_si512(lanes.first[state].data()), inner));
        for (std::size_t i = StateLanes::kAtOnce; i < count; i += StateLanes::kAtOnce)
            _mm512_storeu_si512(out + i,
                                _mm512_permutex2var_epi16(edges, _mm512_load_si512(lanes.rest(state, i)), inner));
        out += count;
        firstInner += lanes.innerVertices[state];
    }
    return static_cast<std::uint32_t>(out - begin);
}

// Where many cells are ambiguous, which ones they are cannot be predicted, and a branch costs more than whole lanes.
std::uint32_t writeTrianglesHere(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                                 std::uint16_t* out) {
    return 32 * list.ambiguousCount > list.count ? writeTrianglesOf<true>(list, firstInner, vertices, out)
                                                 : writeTrianglesOf<false>(list, firstInner, vertices, out);
}
#elif HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
std::uint32_t writeTrianglesHere(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                                 std::uint16_t* out) {
    return writeTrianglesReference(list, firstInner, vertices, out);
}
#else
// Of vectors of 32 bytes both halves are alike, so that each makes another half of the numbers.
std::uint32_t writeTrianglesHere(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                                 std::uint16_t* out) {
    const hn::CappedTag<std::uint8_t, 32> bytes;
    const hn::Repartition<std::uint16_t, decltype(bytes)> shorts;
    constexpr std::size_t lanes = hn::MaxLanes(shorts);
    const PlainCells& plain = plainCells();
    const StateCorners* const corners = stateCorners().data();
    std::uint16_t* const begin = out;
    // Lanes of the second piece, (x9 . z9 . | . . z10 .), that go to lanes 3, 4 and 7 of the first.
    alignas(16) static constexpr std::uint8_t kSpread[16] = {0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0,  1,
                                                             4,    5,    0x80, 0x80, 0x80, 0x80, 12, 13};
    alignas(16) static constexpr std::uint8_t kOfFirst[16] = {255, 255, 255, 255, 255, 255, 0, 0,
                                                              0,   0,   255, 255, 255, 255, 0, 0};
    alignas(16) static constexpr std::uint8_t kNotLane3[16] = {255, 255, 255, 255, 255, 255, 0,   0,
                                                               255, 255, 255, 255, 255, 255, 255, 255};
    const auto spread = hn::LoadDup128(bytes, kSpread);
    const auto ofFirst = hn::MaskFromVec(hn::LoadDup128(bytes, kOfFirst)),
               notLane3 = hn::MaskFromVec(hn::LoadDup128(bytes, kNotLane3));
    for (std::uint32_t k = 0; k < list.count; ++k) {
        const std::uint16_t* const at = vertices.numbers.data() + 4 * list.cells[k].index();
        // Pieces of the table: points p and p + 1 (x y z . | . y z .), then those 9, 81 and 90 further on.
        const auto piece = [&](std::size_t further)
                               HWY_ATTR { return hn::BitCast(bytes, hn::LoadDup128(shorts, at + 4 * further)); };
        const auto first = hn::IfThenElse(ofFirst, piece(0), hn::TableLookupBytes(piece(9), spread));
        const auto second = hn::IfThenElse(notLane3, piece(81), hn::ShiftLeftBytes<6>(piece(90))); // of x90
        const cell::StateId state = list.states[k];
        if (HWY_UNLIKELY(state >= 256)) {
            const StateCorners& its = corners[state];
            alignas(32) std::array<std::uint16_t, 32> numbers; // halves that are alike overwrite each other
            hn::Store(hn::BitCast(shorts, first), shorts, numbers.data());
            hn::StoreU(hn::BitCast(shorts, second), shorts, numbers.data() + 8);
            for (std::size_t i = 0; i < 16; i += lanes)
                hn::Store(hn::Iota(shorts, static_cast<std::uint16_t>(firstInner + i)), shorts,
                          numbers.data() + 16 + i);
            for (std::size_t i = 0; i < its.count; i += 4)
                for (std::size_t j = i; j < i + 4; ++j)
                    out[j] = numbers[its.lanes[j]];
            out += its.count;
            firstInner += its.innerVertices;
            continue;
        }
        const CellShuffle& shuffle = plain.shuffles[state];
        for (std::size_t i = 0; i < 16; i += lanes) {
            const auto fromFirst = hn::TableLookupBytesOr0(first, hn::Load(bytes, shuffle.fromFirst.data() + 2 * i)),
                       fromSecond = hn::TableLookupBytesOr0(second, hn::Load(bytes, shuffle.fromSecond.data() + 2 * i));
            hn::StoreU(hn::BitCast(shorts, hn::Or(fromFirst, fromSecond)), shorts, out + i);
        }
        out += plain.corners[state];
    }
    return static_cast<std::uint32_t>(out - begin);
}
#endif

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

const std::array<std::uint16_t, 12> kPlaceOfCellEdge = [] {
    std::array<std::uint16_t, 12> places{};
    for (std::size_t e = 0; e < places.size(); ++e) {
        // As kCellEdges, which another source file initialises: edge e lies along axis e / 4.
        const int axis = static_cast<int>(e) / 4, first = static_cast<int>(e) & 1,
                  second = static_cast<int>(e) >> 1 & 1;
        const int x = axis == 0 ? 0 : first, y = axis == 1 ? 0 : axis == 0 ? first : second, z = axis == 2 ? 0 : second;
        places[e] = static_cast<std::uint16_t>(4 * closedPoint(x, y, z).number() + axis);
    }
    return places;
}();

const std::array<bool, 256>& ambiguousSignTable() {
    static const auto isAmbiguous = [] {
        std::array<bool, 256> made{};
        for (std::size_t signs = 0; signs < made.size(); ++signs)
            made[signs] = cell::isAmbiguous(static_cast<std::uint8_t>(signs));
        return made;
    }();
    return isAmbiguous;
}

const std::array<std::uint8_t, 32>& ambiguousSignBits() {
    struct alignas(32) Bits : std::array<std::uint8_t, 32> {};
    static const auto bits = [] {
        Bits made{};
        for (std::size_t signs = 0; signs < 256; ++signs)
            if (ambiguousSignTable()[signs])
                made[signs / 8] = static_cast<std::uint8_t>(made[signs / 8] | 1u << (signs % 8));
        return made;
    }();
    return bits;
}

const PlainCells& plainCells() {
    static const auto cells = [] {
        PlainCells made;
        for (std::size_t signs = 0; signs < 256; ++signs) {
            CellShuffle& shuffle = made.shuffles[signs];
            shuffle.fromFirst.fill(0x80);
            shuffle.fromSecond.fill(0x80);
            made.corners[signs] = 0;
            if (cell::isAmbiguous(static_cast<std::uint8_t>(signs)))
                continue;
            std::size_t k = 0;
            for (const std::uint8_t edge : cell::cellStates()[signs].triangles) {
                const int lane = kLaneOfCellEdge[edge];
                auto& part = lane < 8 ? shuffle.fromFirst : shuffle.fromSecond;
                part[2 * k] = static_cast<std::uint8_t>(2 * (lane & 7));
                part[2 * k + 1] = static_cast<std::uint8_t>(2 * (lane & 7) + 1);
                ++k;
            }
            made.corners[signs] = static_cast<std::uint8_t>(k);
        }
        return made;
    }();
    return cells;
}

const std::vector<StateCorners>& stateCorners() {
    static const auto corners = [] {
        std::vector<StateCorners> made;
        for (const cell::CellState& state : cell::cellStates()) {
            StateCorners& its = made.emplace_back();
            its.count = static_cast<std::uint8_t>(state.triangles.size());
            its.innerVertices = state.innerVertices;
            std::transform(state.triangles.begin(), state.triangles.end(), its.lanes.begin(), [](std::uint8_t corner) {
                return static_cast<std::uint8_t>(corner < cell::kInnerVertex
                                                     ? kLaneOfCellEdge[corner]
                                                     : StateCorners::kFirstInner + corner - cell::kInnerVertex);
            });
        }
        return made;
    }();
    return corners;
}

const StateLanes::Aligned StateLanes::kUpwards = [] {
    Aligned upwards;
    std::iota(upwards.begin(), upwards.end(), std::uint16_t{0});
    return upwards;
}();

const StateLanes& stateLanes() {
    static const auto lanes = [] {
        StateLanes made;
        const auto laneOf = [](std::uint8_t corner) {
            if (corner >= cell::kInnerVertex)
                return static_cast<std::uint16_t>(StateLanes::kFirstInner + corner - cell::kInnerVertex);
            const auto axis = static_cast<std::uint16_t>(kPlaceOfCellEdge[corner] % 4);
            const auto start = coordsOf(ClosedPoint(kPlaceOfCellEdge[corner] / 4));
            return static_cast<std::uint16_t>(axis + 4 * start[0] + 8 * start[1] + 16 * start[2]);
        };
        for (std::size_t signs = 0; signs < 256; ++signs)
            if (const auto& corners = cell::cellStates()[signs].triangles;
                !cell::isAmbiguous(static_cast<std::uint8_t>(signs)))
                std::transform(corners.begin(), corners.end(), made.plain[signs].begin(),
                               [&](std::uint8_t corner) { return static_cast<std::uint8_t>(laneOf(corner)); });
        for (const cell::CellState& state : cell::cellStates()) {
            const std::size_t count = state.triangles.size();
            made.counts.push_back(static_cast<std::uint8_t>(count));
            made.innerVertices.push_back(state.innerVertices);
            made.firstOther.push_back(static_cast<std::uint16_t>(made.others.size()));
            made.first.emplace_back();
            for (std::size_t i = 0; i < count; ++i) {
                if (i >= StateLanes::kAtOnce && i % StateLanes::kAtOnce == 0)
                    made.others.emplace_back();
                (i < StateLanes::kAtOnce ? made.first : made.others).back()[i % StateLanes::kAtOnce] =
                    laneOf(state.triangles[i]);
            }
        }
        return made;
    }();
    return lanes;
}

HWY_EXPORT(listCellsHere);
HWY_EXPORT(writeTrianglesHere);

void listCells(const BitString& active, const BitString& above, CellList& list) {
    HWY_DYNAMIC_DISPATCH(listCellsHere)(active, above, list);
}

std::uint32_t writeTriangles(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                             std::uint16_t* out) {
    return HWY_DYNAMIC_DISPATCH(writeTrianglesHere)(list, firstInner, vertices, out);
}

std::uint32_t writeTrianglesReference(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                                      std::uint16_t* out) {
    std::uint16_t* const begin = out;
    for (std::uint32_t k = 0; k < list.count; ++k) {
        const cell::CellState& state = cell::cellStates()[list.states[k]];
        for (const std::uint8_t corner : state.triangles)
            *out++ = corner < cell::kInnerVertex
                         ? vertices.numbers[4 * list.cells[k].index() + kPlaceOfCellEdge[corner]]
                         : static_cast<std::uint16_t>(firstInner + corner - cell::kInnerVertex);
        firstInner += state.innerVertices;
    }
    return static_cast<std::uint32_t>(out - begin);
}

} // namespace isoslider::extract
#endif
