#include "preprocess/levels/external_sort.h"

#include <algorithm>
#include <cerrno>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::preprocess {
namespace {

using test::IsOk;

template <class Key>
struct Input {
    std::vector<index::PointRecord<Key>> records; // in id order
    std::vector<KeyCount> counts;
};

// `values` distinct keys, one of which takes half of all records.
template <class Key>
Input<Key> randomInput(std::size_t count, std::uint64_t values, unsigned seed) {
    std::mt19937_64 random(seed);
    Input<Key> input;
    KeyCounter<Key> counter(count);
    for (std::size_t i = 0; i < count; ++i) {
        index::PointRecord<Key> record;
        const std::uint64_t value = random() % 2 ? 7 : random() % values;
        record.key = static_cast<Key>(value * 0x9e3779b97f4a7c15ull >> (64 - 8 * sizeof(Key)));
        record.setId(PointId(3 * i + (std::uint64_t{1} << 33)));
        record.edgeMask = static_cast<std::uint8_t>(1 + random() % 63);
        record.farKeys[5] = static_cast<Key>(random());
        input.records.push_back(record);
        counter.add(record.key);
    }
    input.counts = counter.takeCounts();
    return input;
}

template <class Key>
Status addInParts(ExternalSort<Key>& sort, const std::vector<index::PointRecord<Key>>& records) {
    for (std::size_t at = 0; at < records.size(); at += 333)
        ISO_TRY(sort.add(std::span(records).subspan(at, std::min<std::size_t>(333, records.size() - at))));
    return {};
}

template <class Key>
class ExternalSortTest : public testing::Test {};
using KeyTypes = testing::Types<std::uint16_t, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(ExternalSortTest, KeyTypes);

TYPED_TEST(ExternalSortTest, SortsLikeTheLibraryWithAndWithoutSpilling) {
    using Record = index::PointRecord<TypeParam>;
    for (const std::uint64_t memory : {std::uint64_t{1} << 30, std::uint64_t{100000}, std::uint64_t{1}})
        for (const std::uint64_t values : {1, 3, 1000, 1000000}) {
            SCOPED_TRACE(std::to_string(memory) + " bytes, " + std::to_string(values) + " values");
            const test::TemporaryFolder folder;
            const auto input = randomInput<TypeParam>(20000, values, 5);
            auto expected = input.records;
            std::stable_sort(expected.begin(), expected.end(),
                             [](const Record& a, const Record& b) { return a.key < b.key; });
            {
                ExternalSort<TypeParam> sort(input.counts, memory, folder / "runs");
                ASSERT_THAT(addInParts(sort, input.records), IsOk());
                EXPECT_EQ(sort.recordCount(), input.records.size());
                EXPECT_EQ(sort.spilledBytes() > 0, memory < 1u << 20);
                std::size_t at = 0;
                const auto drained = sort.drain(
                    [&](std::span<const Record> records) -> Status {
                        for (const Record& r : records) {
                            const Record& e = expected.at(at++);
                            EXPECT_TRUE(r.key == e.key && r.id() == e.id() && r.edgeMask == e.edgeMask &&
                                        r.farKeys[5] == e.farKeys[5])
                                << "record " << at - 1;
                            if (testing::Test::HasFailure())
                                return makeError(ErrorCode::Corruption, "stop");
                        }
                        return {};
                    },
                    {});
                ASSERT_THAT(drained, IsOk());
                EXPECT_EQ(at, expected.size());
            }
            EXPECT_TRUE(folder.names().empty()) << "the temporary file stays";
        }
}

// Counts that foretell nothing, so that all records meet in a partition or two; and a spill file for each of these.
TYPED_TEST(ExternalSortTest, DividesPartitionsThatAreTooLarge) {
    using Record = index::PointRecord<TypeParam>;
    const auto input = randomInput<TypeParam>(200'000, 1'000'000, 6);
    auto expected = input.records;
    std::stable_sort(expected.begin(), expected.end(), [](const Record& a, const Record& b) { return a.key < b.key; });
    for (const std::vector<KeyCount>& counts : {std::vector<KeyCount>{}, {{7, 1'000'000}}, {{1, 1}, {100, 1}}})
        for (const std::uint64_t memory : {std::uint64_t{2} << 20, std::uint64_t{64} << 20}) {
            const test::TemporaryFolder folder;
            {
                ExternalSort<TypeParam> sort(counts, memory, folder / "runs");
                ASSERT_THAT(addInParts(sort, input.records), IsOk());
                std::size_t at = 0, largest = 0;
                const auto drained = sort.drain(
                    [&](std::span<const Record> records) -> Status {
                        largest = std::max(largest, records.size_bytes());
                        for (const Record& record : records) {
                            const Record& wanted = expected.at(at++);
                            EXPECT_TRUE(record.key == wanted.key && record.id() == wanted.id()) << "record " << at - 1;
                            if (testing::Test::HasFailure())
                                return makeError(ErrorCode::Corruption, "stop");
                        }
                        return {};
                    },
                    {});
                ASSERT_THAT(drained, IsOk());
                EXPECT_EQ(at, expected.size());
                EXPECT_LE(largest, std::max<std::uint64_t>(memory / 4, 16384 * sizeof(Record)));
            }
            EXPECT_TRUE(folder.names().empty()) << "a temporary file stays";
        }
}

TYPED_TEST(ExternalSortTest, IsEmptyWithoutRecords) {
    const test::TemporaryFolder folder;
    ExternalSort<TypeParam> sort({}, 1, folder / "runs");
    std::size_t calls = 0;
    EXPECT_THAT(sort.drain(
                    [&](auto records) -> Status {
                        calls += !records.empty();
                        return {};
                    },
                    {}),
                IsOk());
    EXPECT_EQ(calls, 0u);
}

TEST(ExternalSortFaults, EveryFailingCallIsReportedAndNothingIsLeft) {
    using Record = index::PointRecord<std::uint32_t>;
    const auto input = randomInput<std::uint32_t>(2000, 50, 9);
    bool hasSucceeded = false;
    for (int failing = 0; !hasSucceeded; ++failing) {
        ASSERT_LT(failing, 2000);
        const test::TemporaryFolder folder;
        test::FaultyFileSystem faulty(failing, ENOSPC);
        {
            ExternalSort<std::uint32_t> sort(input.counts, 30000, folder / "runs", faulty);
            const Status status = [&]() -> Status {
                ISO_TRY(addInParts(sort, input.records));
                return sort.drain([](std::span<const Record>) -> Status { return {}; }, {});
            }();
            hasSucceeded = status.isOk() && failing >= faulty.calls();
            if (failing < faulty.calls()) {
                EXPECT_THAT(status, test::HasError(ErrorCode::OutOfSpace)) << "call " << failing;
            }
        }
        EXPECT_TRUE(folder.names().empty()) << "call " << failing;
    }
}

TEST(ExternalSortFaults, StopsOnRequestAndPassesErrorsOn) {
    using Record = index::PointRecord<std::uint32_t>;
    const auto input = randomInput<std::uint32_t>(500, 50, 2);
    const test::TemporaryFolder folder;
    ExternalSort<std::uint32_t> sort(input.counts, 1000, folder / "runs");
    ASSERT_THAT(addInParts(sort, input.records), IsOk());
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(sort.drain([](std::span<const Record>) -> Status { return {}; }, job),
                test::HasError(ErrorCode::Cancelled));

    ExternalSort<std::uint32_t> other(input.counts, 1u << 30, folder / "other");
    ASSERT_THAT(addInParts(other, input.records), IsOk());
    EXPECT_THAT(other.drain([](std::span<const Record>) -> Status { return makeError(ErrorCode::IoError, "no"); }, {}),
                test::HasError(ErrorCode::IoError));
}

} // namespace
} // namespace isoslider::preprocess
