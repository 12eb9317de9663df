// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/caster_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <unordered_map>

#include "base/thread_pool.h"
#include "lights/view_casters.h"
#include "scene/bounds.h"

namespace shadow_layers {
namespace {

using soft_kernel::kLeaf;
using soft_kernel::kNoChild;
using soft_kernel::kWidth;
using soft_kernel::Leaf;
using soft_kernel::Node;

// Trees of more nodes are baked by several threads, from about so many subtrees on.
constexpr std::size_t kManyNodes = 256, kSubtrees = 64;
constexpr std::size_t kInstanceBlock = 1 << 10;
constexpr std::align_val_t kAlignment{64};

Bounds get_box(const BoxTree::Node& node, int i) {
    return {{node.low[0][i], node.low[1][i], node.low[2][i]}, {node.high[0][i], node.high[1][i], node.high[2][i]}};
}

template <class T>
T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new[](std::max<std::size_t>(1, count) * sizeof(T), kAlignment));
}

/// Bits of the children whose boxes, given in object space, may cast into the shaft.
std::uint32_t find_alive(const BoxTree::Node& node, const glm::dmat4& frame_from_object,
                         const soft_kernel::Shaft& shaft, const BoxWidening& widening) {
    Node turned = make_empty_node();
    for (int i = 0; i < kWidth; ++i)
        if (node.child[i] != BoxTree::kNoChild)
            set_box(turned, i, transform_bounds(get_box(node, i), frame_from_object), widening, 0);
    return soft_kernel::choose_build().test_shaft(shaft, turned);
}

}  // namespace

void CasterTree::Release::operator()(void* memory) const { ::operator delete[](memory, kAlignment); }

class CasterTree::Maker {
public:
    Maker(CasterTree& made, const Scene& scene, const glm::dmat4& frame_from_world, const soft_kernel::Shaft& shaft,
          std::span<const TreeCaster> casters, const BoxWidening& widening)
        : made_(made), shaft_(shaft), casters_(casters), widening_(widening) {
        for (const TreeCaster& caster : casters) {
            const Instance& instance = scene.instances[caster.instance];
            bases_.push_back({frame_from_world * instance.world_from_object, made.node_count_, made.leaf_count_});
            made.node_count_ += caster.tree->nodes.size();
            made.leaf_count_ += caster.tree->leaf_count();
        }
    }

    void make(ThreadPool& threads) {
        // Two more for each instance are room for the nodes above them.
        made_.nodes_.reset(allocate<Node>(made_.node_count_ + 2 * casters_.size()));
        made_.leaves_.reset(allocate<Leaf>(made_.leaf_count_));
        for (std::size_t caster = 0; caster < casters_.size(); ++caster) add_tasks(caster);
        threads.parallel_for(tasks_.size(), 1, [&](std::size_t i, std::size_t) {
            tasks_[i].box = bake_node(tasks_[i].caster, tasks_[i].node, nullptr);
        });
        std::vector<ItemBox> boxes(casters_.size());
        std::vector<Bounds> bounds(casters_.size());
        for (std::size_t i = 0; i < tasks_.size();) i = finish_caster(i, bounds);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (int k = 0; k < 3; ++k) {
                boxes[i].low[k] = std::nextafter(float(bounds[i].min[k]), -std::numeric_limits<float>::infinity());
                boxes[i].high[k] = std::nextafter(float(bounds[i].max[k]), std::numeric_limits<float>::infinity());
            }
            if (bounds[i].is_empty()) boxes[i].low[0] = std::numeric_limits<float>::infinity();
        }
        add_top(*make_box_tree(boxes, &threads), bounds);
    }

private:
    struct Base {
        glm::dmat4 frame_from_object;
        std::size_t node, leaf;
    };
    struct Task {
        std::size_t caster;
        std::uint32_t node;
        Bounds box;
    };
    using Finished = std::unordered_map<std::uint32_t, Bounds>;

    void add_tasks(std::size_t caster) {
        const BoxTree& tree = *casters_[caster].tree;
        if (tree.nodes.empty()) return;
        std::vector<std::uint32_t> front = {0};
        while (tree.nodes.size() > kManyNodes && front.size() < kSubtrees) {
            std::vector<std::uint32_t> next;
            for (const std::uint32_t node : front)
                for (const std::uint32_t child : tree.nodes[node].child)
                    if (child != BoxTree::kNoChild && !(child & BoxTree::kLeaf)) next.push_back(child);
            if (next.size() <= front.size()) break;
            front = std::move(next);
        }
        for (const std::uint32_t node : front) tasks_.push_back({caster, node, {}});
    }

    /// Works the nodes over a caster's tasks, the first of which is `first`; returns the next caster's first.
    std::size_t finish_caster(std::size_t first, std::vector<Bounds>& bounds) {
        const std::size_t caster = tasks_[first].caster;
        Finished finished;
        std::size_t end = first;
        for (; end < tasks_.size() && tasks_[end].caster == caster; ++end)
            finished.emplace(tasks_[end].node, tasks_[end].box);
        bounds[caster] = bake_node(caster, 0, &finished);
        return end;
    }

    Bounds bake_node(std::size_t caster, std::uint32_t number, const Finished* finished) {
        if (finished)
            if (const auto found = finished->find(number); found != finished->end()) return found->second;
        const Base& base = bases_[caster];
        const BoxTree::Node& node = casters_[caster].tree->nodes[number];
        Node& baked = made_.nodes_[base.node + number];
        baked = make_empty_node();
        Bounds all;
        std::uint32_t alive = find_alive(node, base.frame_from_object, shaft_, widening_);
        for (; alive != 0; alive &= alive - 1) {
            const int i = std::countr_zero(alive);
            const bool is_leaf = node.child[i] & BoxTree::kLeaf;
            const std::uint32_t child = node.child[i] & ~BoxTree::kLeaf;
            const Bounds box = is_leaf ? bake_leaf(caster, child) : bake_node(caster, child, finished);
            if (box.is_empty()) continue;
            set_box(baked, i, box, widening_,
                    is_leaf ? kLeaf | std::uint32_t(base.leaf + child) : std::uint32_t(base.node + child));
            all.add(box);
        }
        return all;
    }

    Bounds bake_leaf(std::size_t caster, std::uint32_t number) {
        const Base& base = bases_[caster];
        const BoxTree& tree = *casters_[caster].tree;
        const Mesh& mesh = *casters_[caster].mesh;
        const std::uint32_t first = tree.leaf_first[number], count = tree.leaf_first[number + 1] - first;
        glm::dvec3 corners[kWidth][3];
        Bounds box;
        for (std::uint32_t i = 0; i < count; ++i)
            for (int k = 0; k < 3; ++k) {
                const glm::vec3& position = mesh.positions[mesh.triangles[tree.items[first + i]][k]];
                corners[i][k] = glm::dvec3(base.frame_from_object * glm::dvec4(glm::dvec3(position), 1.0));
                box.add(corners[i][k]);
            }
        Leaf& leaf = made_.leaves_[base.leaf + number];
        const glm::dvec3 origin = 0.5 * (box.min + box.max), half = box.max - origin;
        for (int k = 0; k < 3; ++k) leaf.origin[k] = origin[k];
        leaf.size = float(std::max({half.x, half.y, half.z}) * (1 + 1e-6));
        leaf.lanes = (1u << count) - 1;
        for (std::uint32_t i = 0; i < std::uint32_t(kWidth); ++i) {
            const bool is_there = i < count;
            leaf.instance[i] = casters_[caster].told_instance;
            leaf.triangle[i] = is_there ? tree.items[first + i] : kNoChild;
            for (int k = 0; k < 3; ++k) {
                leaf.a[k][i] = is_there ? float(corners[i][0][k] - origin[k]) : 0.0f;
                leaf.edge_1[k][i] = is_there ? float(corners[i][1][k] - corners[i][0][k]) : 0.0f;
                leaf.edge_2[k][i] = is_there ? float(corners[i][2][k] - corners[i][0][k]) : 0.0f;
            }
        }
        return box;
    }

    /// The tree over the instances: its leaves become nodes whose children are the roots of meshes.
    void add_top(const BoxTree& top, const std::vector<Bounds>& bounds) {
        if (top.nodes.empty()) return;
        const auto link = [&](std::uint32_t child) -> std::uint32_t {
            if (!(child & BoxTree::kLeaf)) return std::uint32_t(made_.node_count_ + child);
            const std::uint32_t leaf = child & ~BoxTree::kLeaf, first = top.leaf_first[leaf];
            if (top.leaf_first[leaf + 1] - first == 1) return std::uint32_t(bases_[top.items[first]].node);
            return std::uint32_t(made_.node_count_ + top.nodes.size() + leaf);
        };
        Node* next = made_.nodes_.get() + made_.node_count_;
        for (const BoxTree::Node& node : top.nodes) {
            *next = make_empty_node();
            for (int i = 0; i < kWidth; ++i)
                if (node.child[i] != BoxTree::kNoChild)
                    set_box(*next, i, get_box(node, i), widening_, link(node.child[i]));
            ++next;
        }
        for (std::size_t leaf = 0; leaf < top.leaf_count(); ++leaf) {
            *next = make_empty_node();
            for (std::uint32_t i = top.leaf_first[leaf]; i < top.leaf_first[leaf + 1]; ++i)
                set_box(*next, int(i - top.leaf_first[leaf]), bounds[top.items[i]], widening_,
                        std::uint32_t(bases_[top.items[i]].node));
            ++next;
        }
        // A tree of one instance needs no node above its root.
        made_.root_ = top.items.size() == 1 ? made_.nodes_.get() + bases_[top.items.front()].node
                                            : made_.nodes_.get() + made_.node_count_;
    }

    CasterTree& made_;
    const soft_kernel::Shaft& shaft_;
    std::span<const TreeCaster> casters_;
    const BoxWidening widening_;
    std::vector<Base> bases_;
    std::vector<Task> tasks_;
};

CasterTree::CasterTree(const Scene& scene, const glm::dvec3& picture_origin_ws, const LightFrame& frame,
                       const soft_kernel::Shaft& shaft, std::span<const TreeCaster> casters,
                       const BoxWidening& widening, ThreadPool& threads) {
    Maker(*this, scene, frame.from_world(picture_origin_ws), shaft, casters, widening).make(threads);
}

CasterTree::~CasterTree() = default;

std::size_t CasterTree::bytes_needed(const BoxTree& tree) {
    return tree.nodes.size() * sizeof(Node) + tree.leaf_count() * sizeof(Leaf);
}

std::size_t CasterTree::byte_size() const { return node_count_ * sizeof(Node) + leaf_count_ * sizeof(Leaf); }

std::vector<std::uint32_t> find_shaft_casters(const Scene& scene, const Light& light,
                                              const glm::dvec3& picture_origin_ws, const LightFrame& frame,
                                              const soft_kernel::Shaft& shaft, const BoxWidening& widening,
                                              ThreadPool& threads) {
    const glm::dmat4 frame_from_world = frame.from_world(picture_origin_ws);
    const std::size_t count = scene.instances.size();
    std::vector<std::uint8_t> alive(count, 0);
    threads.parallel_for(count, kInstanceBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t first = begin; first < end; first += kWidth) {
            Node boxes = make_empty_node();
            const std::size_t last = std::min(first + kWidth, end);
            for (std::size_t i = first; i < last; ++i) {
                const Instance& instance = scene.instances[i];
                const Bounds& bounds = scene.meshes[instance.mesh]->bounds;
                if (!casts_for(light, instance) || bounds.is_empty()) continue;
                set_box(boxes, int(i - first), transform_bounds(bounds, frame_from_world * instance.world_from_object),
                        widening, 0);
            }
            const std::uint32_t bits = soft_kernel::choose_build().test_shaft(shaft, boxes);
            for (std::size_t i = first; i < last; ++i) alive[i] = bits >> (i - first) & 1u;
        }
    });
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < count; ++i)
        if (alive[i]) found.push_back(std::uint32_t(i));
    return found;
}

}  // namespace shadow_layers
