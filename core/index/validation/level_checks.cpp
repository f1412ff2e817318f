#include "core/index/validation/level_checks.h"

#include <algorithm>
#include <bit>
#include <string>

#include <tbb/parallel_for.h>

#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/validation/missing_cell_lookup.h"
#include "core/index/validation/value_thresholds.h"

namespace isoslider::index {
namespace {

constexpr std::size_t kPagesAtOnce = 256; // decoded side by side, then looked at in order
constexpr std::size_t kPageOrderByte = 18;

/// What is left of a page when it has been looked at.
struct PageFacts {
    bool isThere = false;
    std::uint64_t firstKey = 0, firstId = 0, lastKey = 0, lastId = 0; // of its first and last record
    std::uint64_t points = 0, edges = 0, activated = 0, distinctKeys = 0;
};

/// Each page of all levels is decoded once, on any thread; what it adds up to is compared afterwards.
template <class Key>
class LevelChecks {
public:
    LevelChecks(const IndexReader& reader, FaultList& faults, Level0Sums& sums)
        : reader_(reader),
          meta_(reader.meta()),
          grid_(reader.grid()),
          faults_(faults),
          sums_(sums),
          missing_(meta_.missingCells),
          ends_(grid_.brickCount()),
          thresholds_(reader.info()),
          curve_(thresholds_.count() + 1) {
        for (std::size_t level = 1; level < meta_.levels.size(); ++level)
            blocks_.emplace_back(meta_.levels[level].blocks.size());
    }

    Status run(const JobControl& job) {
        std::size_t all = 1, done = 0;
        for (const LevelDirectory& level : meta_.levels)
            all += level.pages.size();
        for (std::size_t level = 0; level < meta_.levels.size(); ++level)
            ISO_TRY(runLevel(level, [&](std::size_t pages) {
                done += pages;
                job.report(static_cast<double>(done) / static_cast<double>(all), "checking levels");
                return job.isStopRequested() ? Status(cancelledError()) : Status();
            }));
        compareEnds();
        compareCurve();
        for (std::size_t level = 1; level < meta_.levels.size(); ++level)
            compareBlocks(level);
        return {};
    }

private:
    /// Sums of one block of a level above 0: what its pages hold, and what level 0 states that they should.
    struct BlockSums {
        std::atomic<std::uint64_t> held{0}, wanted{0};
    };

    IndexFault pageFault(std::size_t level, std::size_t i, std::string problem) const {
        const PageEntry& entry = meta_.levels[level].pages[i];
        IndexFault fault;
        fault.part = "page " + std::to_string(i) + " of level " + std::to_string(level);
        fault.problem = std::move(problem);
        fault.offset = entry.offset;
        fault.isovalues = faults_.isovalues(entry.firstKey, entry.lastKey);
        return fault;
    }
    IndexFault levelFault(std::size_t level, std::string problem) const {
        IndexFault fault;
        fault.part = "level " + std::to_string(level);
        fault.problem = std::move(problem);
        return fault;
    }

    template <class Between>
    Status runLevel(std::size_t level, const Between& between) {
        const auto& pages = meta_.levels[level].pages;
        PageFacts sum;
        std::vector<PageFacts> facts;
        std::vector<Status> outcomes;
        bool isWhole = true;
        for (std::size_t first = 0; first < pages.size(); first += kPagesAtOnce) {
            const std::size_t count = std::min(kPagesAtOnce, pages.size() - first);
            facts.assign(count, {});
            outcomes.assign(count, {});
            tbb::parallel_for(std::size_t{0}, count,
                              [&](std::size_t i) { outcomes[i] = checkPage(level, first + i, facts[i]); });
            for (std::size_t i = 0; i < count; ++i) {
                ISO_TRY(outcomes[i]);
                isWhole = isWhole && facts[i].isThere;
                if (facts[i].isThere)
                    addFacts(level, first + i, facts[i], sum);
            }
            ISO_TRY(between(count));
        }
        if (level == 0) {
            sums_.isWhole = isWhole;
            sums_.distinctKeys = sum.distinctKeys;
        }
        if (isWhole)
            compareCounts(level, sum);
        return {};
    }

    void addFacts(std::size_t level, std::size_t i, const PageFacts& page, PageFacts& sum) {
        const bool isFirst = sum.points == 0;
        if (level == 0 && !isFirst) {
            if (page.firstKey < sum.lastKey || (page.firstKey == sum.lastKey && page.firstId < sum.lastId))
                faults_.add(pageFault(level, i, "has records that belong before the page before it"));
            sum.distinctKeys -= page.firstKey == sum.lastKey ? 1 : 0;
        }
        sum.points += page.points;
        sum.edges += page.edges;
        sum.activated += page.activated;
        sum.distinctKeys += page.distinctKeys;
        sum.lastKey = page.lastKey;
        sum.lastId = page.lastId;
    }

    void compareCounts(std::size_t level, const PageFacts& sum) {
        const SkipLevelInfo& stated = meta_.info.levels[level];
        std::uint64_t bytes = 0;
        for (const PageEntry& page : meta_.levels[level].pages)
            bytes += page.bytes;
        const std::uint64_t blocks = level == 0 ? sum.distinctKeys : meta_.levels[level].blocks.size();
        const std::uint64_t removed = level == 0 ? 0 : meta_.info.levels[level - 1].edges - stated.edges;
        const auto compare = [&](const char* what, std::uint64_t is, std::uint64_t there) {
            if (is != there)
                faults_.add(levelFault(level, "should have " + std::to_string(is) + " " + what + ", and has " +
                                                  std::to_string(there)));
        };
        compare("blocks", stated.blocks, blocks);
        compare("records", stated.points, sum.points);
        compare("entries", stated.edges, sum.edges);
        compare("activated entries", stated.activatedEdges, sum.activated);
        compare("bytes", stated.bytes, bytes);
        compare("redundant entries removed", stated.redundantRemoved, removed);
    }

    Status checkPage(std::size_t level, std::size_t i, PageFacts& facts) {
        const PageEntry& entry = meta_.levels[level].pages[i];
        thread_local std::vector<std::byte> bytes;
        thread_local DecodedPage<Key> page;
        // A wrong checksum has been reported.
        if (const Status read = reader_.readPage(entry, bytes); !read.isOk())
            return read.error().code == ErrorCode::Corruption ? Status() : read;
        if (const Status decoded = decodePage<Key>(bytes, grid_, page, reader_.pathString()); !decoded.isOk()) {
            faults_.add(pageFault(level, i, problemOf(decoded.error().message)));
            return {};
        }
        const auto refuse = [&](const char* problem) { faults_.add(pageFault(level, i, problem)); };
        if (!isPageOfVersion(meta_.info, page.hasNormals(), page.farEnds)) {
            refuse("is one of another format version");
            return {}; // it may lack what is looked at
        }
        facts.isThere = true;
        if (page.pointCount() != entry.points || page.entries != entry.edges)
            refuse("has other counts than the directory states");
        const auto [least, greatest] = std::minmax_element(page.keys.begin(), page.keys.end());
        const bool hasAllKeys = level == 0 || page.farEnds == FarEnds::Keys;
        if (*least != entry.firstKey || (hasAllKeys ? *greatest != entry.lastKey : *greatest > entry.lastKey))
            refuse("has other keys than the directory states");
        if (!page.forms.empty() && !(meta_.info.mergeError > 0.0))
            refuse("has merged cells where there are none");
        if (bytes[kPageOrderByte] != std::byte{level == 0 ? std::uint8_t{0} : std::uint8_t{1}})
            refuse("is in the order of another level");
        if (const char* problem = checkRecords(level, i, page, facts))
            refuse(problem);
        return {};
    }

    // The first thing that is wrong; null if nothing is.
    const char* checkRecords(std::size_t level, std::size_t pageNumber, const DecodedPage<Key>& page,
                             PageFacts& facts) {
        const char* problem = nullptr;
        const BlockEntry* block = level == 0 ? nullptr : &blockOfPage(level, pageNumber);
        std::atomic<std::uint64_t>* held =
            block ? &blocks_[level - 1][static_cast<std::size_t>(block - meta_.levels[level].blocks.data())].held
                  : nullptr;
        if (block && meta_.levels[level].pages[pageNumber].lastKey > block->lastKey)
            problem = "has a record outside the interval of its block";
        const bool isStrict = !(meta_.info.mergeError > 0.0);
        std::size_t at = 0;
        for (std::size_t i = 0; i < page.pointCount(); ++i) {
            const Record record = recordAt(page, i, at);
            at += page.hasFarKeys(i) ? static_cast<std::size_t>(std::popcount(record.mask)) : 0;
            if (i > 0) {
                const bool isBehind = level == 0 && page.keys[i] > page.keys[i - 1];
                if (!isBehind && (page.ids[i] < page.ids[i - 1] || (isStrict && page.ids[i] == page.ids[i - 1])))
                    problem = "has records out of order, or one twice";
                facts.distinctKeys += page.keys[i] != page.keys[i - 1] ? 1 : 0;
            }
            if (const char* fault = block ? checkInBlock(record, *block) : checkAtLevel0(record))
                problem = fault;
            countRecord(record, facts);
            const std::uint64_t hash = hashInBlock(record);
            if (held) {
                held->fetch_add(hash, std::memory_order_relaxed);
                continue;
            }
            for (std::size_t above = 1; above < meta_.levels.size(); ++above)
                addWanted(above, record, hash);
        }
        facts.points = page.pointCount();
        facts.distinctKeys += 1;
        facts.firstKey = page.keys.front();
        facts.firstId = page.ids.front();
        facts.lastKey = page.keys.back();
        facts.lastId = page.ids.back();
        return problem;
    }

    struct Record {
        std::uint64_t key, id;
        std::uint8_t mask, rising, form;
        bool isInterval; // of a brick, or of forms above 0: both ends have a record
        const Key* farKeys; // of an interval as many as the mask has bits
        std::uint64_t otherEnd() const { return farKeys[0]; }
    };
    Record recordAt(const DecodedPage<Key>& page, std::size_t i, std::size_t at) const {
        const bool isInterval = page.form(i) != record_form::kPoint || meta_.info.kind == IndexKind::Metacells;
        return {page.keys[i], page.ids[i], page.masks[i],           page.rising[i],
                page.form(i), isInterval,  page.farKeys.data() + at};
    }

    // What a record adds to the sum of its block. Of edges with the sign of where they go, so that those with both ends
    // in a block add up to nothing; intervals with both ends in a block are left out.
    std::uint64_t hashInBlock(const Record& record) const {
        if (record.isInterval) {
            std::uint64_t hash = mixHash(mixHash(idHash(record.id), record.form), record.key);
            for (int i = 0; i < std::popcount(record.mask); ++i)
                hash = mixHash(hash, record.farKeys[i]);
            return hash;
        }
        std::uint64_t sum = 0;
        const auto point = grid_.pointCoords(PointId(record.id));
        for (unsigned mask = record.mask; mask != 0; mask &= mask - 1) {
            const int edge = std::countr_zero(mask);
            sum += signedHash(lowerEnd(record.id, point, edge), edge / 2, record.rising >> edge & 1);
        }
        return sum;
    }

    // Of the two ends of an edge the sum is 0, if they say the same of it.
    static std::uint64_t signedHash(std::uint64_t lowerId, int axis, bool rises) {
        const std::uint64_t hash = edgeHash(lowerId, axis);
        return rises ? hash : std::uint64_t{0} - hash;
    }
    std::uint64_t lowerEnd(std::uint64_t id, const std::array<std::int64_t, 3>& point, int edge) const {
        if (edge & 1)
            return id;
        auto lower = point;
        --lower[static_cast<std::size_t>(edge / 2)];
        return grid_.pointId(lower[0], lower[1], lower[2]).number();
    }

    const BlockEntry& blockOfPage(std::size_t level, std::size_t page) const {
        const auto& blocks = meta_.levels[level].blocks; // leave no page out
        return *std::partition_point(blocks.begin(), blocks.end(), [&](const BlockEntry& block) {
            return block.firstPage + block.pageCount <= page;
        });
    }

    static const char* checkInBlock(const Record& record, const BlockEntry& block) {
        if (record.key < block.firstKey || record.key > block.lastKey)
            return "has a record outside the interval of its block";
        const bool isRedundant =
            record.isInterval && record.otherEnd() >= block.firstKey && record.otherEnd() <= block.lastKey;
        return isRedundant ? "has an entry that is redundant in its block" : nullptr;
    }

    void addWanted(std::size_t level, const Record& record, std::uint64_t hash) {
        const auto& blocks = meta_.levels[level].blocks;
        const auto block = std::partition_point(blocks.begin(), blocks.end(),
                                                [&](const BlockEntry& b) { return b.lastKey < record.key; });
        if (block == blocks.end() || record.key < block->firstKey) {
            hasKeysOutside_ = true;
            return;
        }
        if (!record.isInterval || record.otherEnd() < block->firstKey || record.otherEnd() > block->lastKey)
            blocks_[level - 1][static_cast<std::size_t>(block - blocks.begin())].wanted.fetch_add(
                hash, std::memory_order_relaxed);
    }

    const char* checkAtLevel0(const Record& record) {
        if (record.form != record_form::kPoint) {
            checkInterval(record);
            return record.otherEnd() == record.key ? "has an interval without values" : nullptr;
        }
        if (meta_.info.kind == IndexKind::Metacells) {
            if (!std::has_single_bit(record.mask))
                return "lists a brick without or with several entries";
            const std::uint64_t brick = record.id / kBrickPoints;
            const std::uint64_t least = std::min(record.key, record.otherEnd()),
                                greatest = std::max(record.key, record.otherEnd());
            const std::uint64_t hash = intervalHash(record.id, least, greatest);
            ends_.add(brick, record.rising != 0 ? hash : std::uint64_t{0} - hash);
            if (record.rising != 0)
                sums_.intervals.add(brick, hash);
            return least == greatest               ? "lists a brick with one value"
                   : record.id % kBrickPoints != 0 ? "lists a point that is no brick"
                                                   : nullptr;
        }
        return checkEdges(record);
    }

    // Both ends state the same edge, from either side.
    const char* checkEdges(const Record& record) {
        const auto point = grid_.pointCoords(PointId(record.id));
        const char* problem = nullptr;
        if (sums_.pointKeys)
            sums_.pointKeys->add(record.id, record.key);
        for (unsigned mask = record.mask; mask != 0; mask &= mask - 1) {
            const int edge = std::countr_zero(mask), axis = edge / 2;
            const bool rises = record.rising >> edge & 1;
            const std::uint64_t lower = lowerEnd(record.id, point, edge);
            ends_.add(lower / kBrickPoints, signedHash(lower, axis, rises));
            sums_.intervals.add(record.id / kBrickPoints, edgeEndHash(record.id, record.key, edge, rises));
            addToCurve(record.key, rises);
            if ((edge & 1) != 0 && !missing_.isEdgeUsable(grid_, point, axis))
                problem = "has an edge of no cell with eight finite corners";
        }
        return problem;
    }

    // Of merged cells: an interval has a record at its lower and one at its upper key.
    void checkInterval(const Record& record) {
        const bool isLower = record.rising != 0;
        std::uint64_t hash = mixHash(mixHash(idHash(record.id), record.form), std::min(record.key, record.otherEnd()));
        hash = mixHash(hash, std::max(record.key, record.otherEnd()));
        if (record_form::isEdge(record.form)) {
            for (int i = 1; i < 3; ++i)
                hash = mixHash(hash, record.farKeys[i]);
            addToCurve(record.key, record.rising != 0);
        }
        ends_.add(record.id / kBrickPoints, isLower ? hash : std::uint64_t{0} - hash);
    }

    static void countRecord(const Record& record, PageFacts& facts) {
        facts.edges += static_cast<std::uint64_t>(std::popcount(record.mask));
        facts.activated += static_cast<std::uint64_t>(std::popcount(record.rising));
    }

    void addToCurve(std::uint64_t key, bool rises) {
        curve_[thresholds_.firstAbove(key)].fetch_add(rises ? 1 : -1, std::memory_order_relaxed);
    }

    void compareEnds() {
        if (!sums_.isWhole)
            return; // the other ends are on pages that cannot be read
        for (std::uint64_t part = 0; part < ends_.parts(); ++part)
            if (ends_.at(part) != 0) {
                const bool isEdges = meta_.info.kind == IndexKind::Edges;
                IndexFault fault = levelFault(0, isEdges ? "has edges of which the two ends disagree"
                                                         : "has bricks of which the two ends disagree");
                fault.box = faults_.boxOfBricks(ends_.firstBrick(part), ends_.lastBrick(part));
                faults_.add(std::move(fault));
            }
    }

    // Of metacells the curve follows from the samples (sample_survey.h).
    void compareCurve() {
        if (!sums_.isWhole || meta_.info.kind == IndexKind::Metacells)
            return;
        std::vector<std::int64_t> changes;
        for (const auto& change : curve_)
            changes.push_back(change.load(std::memory_order_relaxed));
        thresholds_.compareCurve(changes, meta_.info, faults_);
    }

    void compareBlocks(std::size_t level) {
        const auto& blocks = meta_.levels[level].blocks;
        if (hasKeysOutside_)
            faults_.add(levelFault(level, "has no block for some keys of level 0"));
        hasKeysOutside_ = false;
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            const auto describe = [&](const char* problem) {
                IndexFault fault = levelFault(level, "");
                fault.part = "block " + std::to_string(i) + " of " + fault.part;
                fault.problem = problem;
                fault.isovalues = faults_.isovalues(blocks[i].firstKey, blocks[i].lastKey);
                return fault;
            };
            if (level > 1 && !isUnionOfBlocks(meta_.levels[level - 1].blocks, blocks[i]))
                faults_.add(describe("is no union of blocks of the level below"));
            if (sums_.isWhole && blocks_[level - 1][i].held != blocks_[level - 1][i].wanted)
                faults_.add(describe("is not the net change of level 0 over its interval"));
        }
    }

    static bool isUnionOfBlocks(const std::vector<BlockEntry>& below, const BlockEntry& block) {
        const auto first = std::partition_point(below.begin(), below.end(),
                                                [&](const BlockEntry& b) { return b.firstKey < block.firstKey; });
        const auto last = std::partition_point(below.begin(), below.end(),
                                               [&](const BlockEntry& b) { return b.lastKey < block.lastKey; });
        return first != below.end() && last != below.end() && first->firstKey == block.firstKey &&
               last->lastKey == block.lastKey;
    }

    const IndexReader& reader_;
    const IndexMeta& meta_;
    const BrickGrid& grid_;
    FaultList& faults_;
    Level0Sums& sums_;
    MissingCellLookup missing_;
    PartSums ends_; ///< of first ends, less those of last ends: 0 where they agree
    ValueThresholds thresholds_;
    std::vector<std::atomic<std::int64_t>> curve_; ///< by the first threshold above a key: what becomes active there
    std::vector<std::vector<BlockSums>> blocks_; ///< by level, from 1 on
    std::atomic<bool> hasKeysOutside_ = false;
};

} // namespace

Status checkLevels(const IndexReader& reader, FaultList& faults, Level0Sums& sums, const JobControl& job) {
    return visitScalarType(reader.info().type, [&](auto sample) {
        return LevelChecks<KeyOf<decltype(sample)>>(reader, faults, sums).run(job);
    });
}

} // namespace isoslider::index
