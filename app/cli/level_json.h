#pragma once

#include <nlohmann/json.hpp>

#include "app/cli/output.h"
#include "core/index/format/index_info.h"

namespace isoslider::cli {

/// One object per skip level, as `build` and `stats` report them.
inline Json levelsJson(const index::IndexInfo& info) {
    Json levels = Json::array();
    for (std::size_t level = 0; level < info.levels.size(); ++level) {
        const index::SkipLevelInfo& facts = info.levels[level];
        levels.push_back(Json{{"level", level},
                              {"blocks", facts.blocks},
                              {"points", facts.points},
                              {"edges", facts.edges},
                              {"activated_edges", facts.activatedEdges},
                              {"bytes", facts.bytes},
                              {"redundant_removed", facts.redundantRemoved}});
    }
    return levels;
}

} // namespace isoslider::cli
