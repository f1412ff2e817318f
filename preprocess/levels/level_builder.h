#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/state_archive.h"
#include "core/index/format/block_codec.h"
#include "core/index/format/point_record.h"
#include "core/index/index_writer.h"

namespace isoslider::preprocess {

/// Cuts the sorted stream of point records into the pages of all skip levels and writes them.
///
/// Level 0 keeps the stream's order, kValuePagePoints to a page. A level above takes each record
/// into its current block, without the edges that are redundant there (PAPER 2.1); records left without edges
/// vanish. Within a block the records are re-sorted by id in chunks of kChunkPoints (a constant, so
/// that memory is bounded and the bytes depend on nothing else) and cut into pages of kIdPagePoints.
///
/// Pages are encoded in parallel and written in the order in which the stream completed them.
inline constexpr std::size_t kValuePagePoints = 4096;
inline constexpr std::size_t kIdPagePoints = 8192;
inline constexpr std::size_t kChunkPoints = 65536;

template <class Key>
class LevelBuilder {
public:
    using Record = index::PointRecord<Key>;

    /// `farEnds`: what pages state of them; `blockBegins`: first keys of the blocks of levels 1, 2, …
    /// (chooseBlockBegins).
    LevelBuilder(index::IndexWriter& writer, const BrickGrid& grid, index::FarEnds farEnds,
                 std::vector<std::vector<std::uint64_t>> blockBegins);
    ~LevelBuilder();

    /// Takes the next records of the stream, in (key, id) order; those without edges are left out. Errors: those of
    /// the writer.
    Status add(std::span<const Record> records);
    /// Ends all blocks and writes what is left.
    Status finish();

    /// What is open between two calls of add(). REQUIRES: the same `blockBegins`.
    void state(StateArchive& archive);

    /// Counts of what was written; bytes are the writer's. REQUIRES: finish() was called.
    std::vector<index::SkipLevelInfo> levelInfos() const;

private:
    class Level;
    Status encodeAndWrite();

    index::IndexWriter& writer_;
    const BrickGrid& grid_;
    index::FarEnds farEnds_;
    std::vector<std::unique_ptr<Level>> levels_;
    std::uint64_t position_ = 0; ///< records of the stream so far
};

extern template class LevelBuilder<std::uint16_t>;
extern template class LevelBuilder<std::uint32_t>;
extern template class LevelBuilder<std::uint64_t>;

} // namespace isoslider::preprocess
