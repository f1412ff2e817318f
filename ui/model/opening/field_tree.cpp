#include "ui/model/opening/field_tree.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

namespace isoslider::model {
namespace {

// Elsewhere a slash is part of a name: "velocity m/s".
bool namesArePaths(const io::VolumeContents& contents) {
    return contents.format == "HDF5" || contents.format == "NetCDF";
}

std::vector<std::string> partsOf(std::string_view path) {
    std::vector<std::string> parts;
    while (!path.empty()) {
        const auto part = path.substr(0, path.find('/'));
        if (!part.empty())
            parts.emplace_back(part);
        path.remove_prefix(std::min(path.size(), part.size() + 1));
    }
    return parts;
}

} // namespace

FieldTree::FieldTree() : nodes_(1) {}

FieldTree::FieldTree(const io::VolumeContents& contents) : nodes_(1) {
    const bool hasPaths = namesArePaths(contents);
    std::map<std::pair<std::size_t, std::string>, std::size_t> groups; // by parent and name
    for (std::size_t field = 0; field < contents.fields.size(); ++field) {
        const std::string& name = contents.fields[field].name;
        auto parts = hasPaths ? partsOf(name) : std::vector<std::string>{name};
        if (parts.empty())
            parts.push_back(name);
        std::size_t parent = 0;
        for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
            const auto [found, isNew] = groups.try_emplace({parent, parts[i]}, nodes_.size());
            parent = isNew ? add(parent, parts[i], std::nullopt) : found->second;
            hasGroups_ = true;
        }
        nodeOfField_.push_back(add(parent, std::move(parts.back()), field));
    }
}

std::size_t FieldTree::add(std::size_t parent, std::string name, std::optional<std::size_t> field) {
    const std::size_t index = nodes_.size();
    nodes_.push_back({std::move(name), parent, nodes_[parent].children.size(), field, {}});
    nodes_[parent].children.push_back(index);
    return index;
}

} // namespace isoslider::model
