#pragma once

#include <span>
#include <vector>

#include "core/base/state_archive.h"
#include "core/index/format/hidden_corner_codec.h"
#include "core/index/index_writer.h"

namespace isoslider::preprocess {

/// Cuts the stream of hidden corners into pages of whole bricks and writes each when it is full.
class HiddenPageBuilder {
public:
    HiddenPageBuilder(index::IndexWriter& writer, ScalarType type) : writer_(writer), type_(type) {}

    /// All hidden corners of one brick, ascending by place; none is fine. REQUIRES: bricks ascend from call to call.
    /// Errors: those of the writer.
    Status addBrick(std::span<const index::HiddenCorner> corners);
    /// Writes what is left.
    Status finish();
    void state(StateArchive& archive) { archive(page_); }

private:
    index::IndexWriter& writer_;
    ScalarType type_;
    std::vector<index::HiddenCorner> page_;
};

} // namespace isoslider::preprocess
