// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scene/adjacency.h"

namespace shadow_layers {

namespace {

/// Sets of positions remembered per weld: different meshes of one topology, or the last frames of a deforming one.
constexpr std::size_t kShapesPerWeld = 8;

}  // namespace

MeshEdges AdjacencyCache::add_shapes(Entries::iterator entry, const Mesh& mesh) {
    auto shapes = std::make_shared<const ComponentShapes>(measure_components(mesh, *entry->adjacency));
    entry->shapes.emplace_front(mesh.positions_key, shapes);
    bytes_ += shapes->byte_size();
    if (entry->shapes.size() > kShapesPerWeld) {
        bytes_ -= entry->shapes.back().second->byte_size();
        entry->shapes.pop_back();
    }
    return {entry->adjacency, shapes};
}

MeshEdges AdjacencyCache::get(const Mesh& mesh, ThreadPool* threads) {
    const auto [begin, end] = by_topology_.equal_range(mesh.topology_key);
    for (auto it = begin; it != end; ++it)
        for (const auto& [positions_key, shapes] : it->second->shapes)
            if (positions_key == mesh.positions_key) {
                use(it->second);
                return {it->second->adjacency, shapes};
            }
    MeshEdges found;
    for (auto it = begin; it != end && !found.adjacency; ++it)
        if (still_holds(*it->second->adjacency, mesh)) {
            use(it->second);
            found = add_shapes(it->second, mesh);
        }
    if (!found.adjacency) {
        ++weld_count_;
        entries_.push_front({mesh.topology_key, make_adjacency(mesh, threads), {}, render_});
        by_topology_.emplace(mesh.topology_key, entries_.begin());
        bytes_ += entries_.front().adjacency->byte_size();
        found = add_shapes(entries_.begin(), mesh);
    }
    trim();
    return found;
}

void AdjacencyCache::use(Entries::iterator entry) {
    entry->last_render = render_;
    entries_.splice(entries_.begin(), entries_, entry);
}

void AdjacencyCache::begin_render(std::uint64_t render, std::uint64_t kept) {
    render_ = render;
    while (!entries_.empty() && entries_.back().last_render + kept < render_) drop_last();
}

void AdjacencyCache::trim() {
    while (bytes_ > budget_bytes_ && entries_.size() > 1) drop_last();
}

void AdjacencyCache::drop_last() {
    const auto last = std::prev(entries_.end());
    bytes_ -= last->adjacency->byte_size();
    for (const auto& [key, shapes] : last->shapes) bytes_ -= shapes->byte_size();
    const auto [begin, end] = by_topology_.equal_range(last->topology_key);
    by_topology_.erase(std::find_if(begin, end, [&](const auto& item) { return item.second == last; }));
    entries_.erase(last);
}

void AdjacencyCache::clear() {
    entries_.clear();
    by_topology_.clear();
    bytes_ = 0;
}

}  // namespace shadow_layers
