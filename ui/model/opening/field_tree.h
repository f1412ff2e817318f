#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/volume_io/volume_contents.h"

namespace isoslider::model {

/// The fields of a file in the groups that their names state: "/run1/density" is "density" in "run1". Files of
/// formats without groups make a list: no node has children.
class FieldTree {
public:
    struct Node {
        std::string name; ///< of a group, or the last part of a field's; of a list, the whole name
        std::size_t parent = 0; ///< 0: the root
        std::size_t row = 0; ///< among the parent's children
        std::optional<std::size_t> field; ///< in VolumeContents::fields; none: a group
        std::vector<std::size_t> children; ///< of a group, as they come in the file
    };

    /// The root alone.
    FieldTree();
    explicit FieldTree(const io::VolumeContents& contents);

    /// The root is node 0, a group without a name.
    const Node& node(std::size_t index) const { return nodes_[index]; }
    /// Node of a field. REQUIRES: it is one of those.
    std::size_t nodeOf(std::size_t field) const { return nodeOfField_[field]; }
    std::size_t size() const { return nodes_.size(); } ///< nodes, with the root
    bool hasGroups() const { return hasGroups_; }

private:
    std::size_t add(std::size_t parent, std::string name, std::optional<std::size_t> field);

    std::vector<Node> nodes_;
    std::vector<std::size_t> nodeOfField_;
    bool hasGroups_ = false;
};

} // namespace isoslider::model
