#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include "core/index/index_writer.h"
#include "preprocess/forecast/size_only_file_system.h"
#include "preprocess/value_bins.h"

namespace isoslider::preprocess {

/// A small index of a part of a volume, never written, whose size states that of the whole one.
class ScaledIndex {
public:
    /// `name` is never written to.
    static Result<std::unique_ptr<ScaledIndex>> begin(const std::filesystem::path& name) {
        auto scaled = std::make_unique<ScaledIndex>();
        auto writer = index::IndexWriter::create(name, 0, scaled->files_);
        if (!writer.isOk())
            return std::move(writer).error();
        scaled->writer_ = std::move(writer).value();
        return scaled;
    }
    index::IndexWriter& writer() { return *writer_; }

    /// Of an index with `entryRatio` times as many entries and `pointRatio` times as many grid points: pages grow with
    /// those, the directory of blocks and what is stated of the volume do not. Call once.
    Result<double> finish(index::IndexMeta meta, double entryRatio, double pointRatio) {
        meta.info.histogram.counts.resize(kBins);
        meta.info.activeEdgesPerBin.resize(kBins);
        double missing = 0.0;
        if (!meta.missingCells.empty()) {
            const auto with = index::encodeMeta(meta).size();
            meta.missingCells.clear();
            missing = static_cast<double>(with - index::encodeMeta(meta).size());
        }
        auto finished = writer_->finish(std::move(meta));
        if (!finished.isOk())
            return std::move(finished).error();
        const index::IndexInfo& info = finished.value();
        double pages = 0.0;
        for (const index::SkipLevelInfo& level : info.levels)
            pages += static_cast<double>(level.bytes);
        const double fixed = static_cast<double>(info.indexBytes) - pages;
        return fixed + entryRatio * pages + pointRatio * missing;
    }

private:
    static constexpr std::size_t kBins = ValueBins<std::uint8_t>::kCount;

    SizeOnlyFileSystem files_;
    std::unique_ptr<index::IndexWriter> writer_;
};

} // namespace isoslider::preprocess
