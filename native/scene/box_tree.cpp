// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/box_tree.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/thread_pool.h"
#include "scene/bounds.h"

namespace shadow_layers {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kPrimitiveBlock = 1 << 12, kLeafBlock = 1 << 10;
// Subtrees of about this many items are built by one thread each.
constexpr std::size_t kTaskItems = 1 << 12;
// Below this depth ranges are halved by number, so that a traversal's stack is bounded whatever the mesh.
constexpr int kDeepest = 20;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Box {
    float low[3] = {kInfinity, kInfinity, kInfinity}, high[3] = {-kInfinity, -kInfinity, -kInfinity};
    void add(const float (&other_low)[3], const float (&other_high)[3]) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other_low[k]);
            high[k] = std::max(high[k], other_high[k]);
        }
    }
    double half_area() const {
        const double x = double(high[0]) - low[0], y = double(high[1]) - low[1], z = double(high[2]) - low[2];
        return x >= 0 ? x * y + y * z + z * x : 0;
    }
};

struct Primitive {
    float low[3];
    std::uint32_t item;
    float high[3];
    float centre(int axis) const { return 0.5f * low[axis] + 0.5f * high[axis]; }
};

struct Range {
    std::uint32_t begin, end;
    Box box;
    std::uint32_t size() const { return end - begin; }
};

/// Nodes and leaves of a part of the tree; numbers are its own.
struct Part {
    std::vector<BoxTree::Node> nodes;
    std::vector<std::uint32_t> leaf_first;
};

BoxTree::Node make_empty_node() {
    BoxTree::Node node;
    for (std::size_t i = 0; i < kTreeWidth; ++i) {
        for (int k = 0; k < 3; ++k) node.low[k][i] = kInfinity, node.high[k][i] = -kInfinity;
        node.child[i] = BoxTree::kNoChild;
    }
    return node;
}

void set_child(BoxTree::Node& node, std::size_t i, const Box& box, std::uint32_t child) {
    for (int k = 0; k < 3; ++k) node.low[k][i] = box.low[k], node.high[k][i] = box.high[k];
    node.child[i] = child;
}

class Builder {
public:
    Builder(std::vector<Primitive>& primitives, ThreadPool* threads) : primitives_(primitives), threads_(threads) {}

    void build(BoxTree& tree) {
        const Range all = make_range(0, std::uint32_t(primitives_.size()));
        Part top;
        build_node(all, 0, top, true);
        std::vector<Part> parts(tasks_.size());
        const auto work = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) build_node(tasks_[i].range, tasks_[i].depth, parts[i], false);
        };
        if (threads_)
            threads_->parallel_for(parts.size(), 1, work);
        else
            work(0, parts.size());
        join(top, parts, tree);
    }

private:
    struct Task {
        Range range;
        int depth;
        std::uint32_t node, child;  ///< the place in the top part that its root takes
    };

    Range make_range(std::uint32_t begin, std::uint32_t end) const {
        Range range{begin, end, {}};
        for (std::uint32_t i = begin; i < end; ++i) range.box.add(primitives_[i].low, primitives_[i].high);
        return range;
    }

    void build_node(const Range& range, int depth, Part& part, bool is_top) {
        std::array<Range, kTreeWidth> children;
        const std::size_t count = split_range(range, depth, children);
        const std::uint32_t number = std::uint32_t(part.nodes.size());
        part.nodes.push_back(make_empty_node());
        for (std::size_t i = 0; i < count; ++i) {
            const Range& child = children[i];
            std::uint32_t link = BoxTree::kNoChild;
            if (child.size() <= kTreeWidth) {
                link = BoxTree::kLeaf | std::uint32_t(part.leaf_first.size());
                part.leaf_first.push_back(child.begin);
            } else if (is_top && child.size() <= kTaskItems) {
                tasks_.push_back({child, depth + 1, number, std::uint32_t(i)});
            } else {
                link = std::uint32_t(part.nodes.size());
                build_node(child, depth + 1, part, is_top);
            }
            set_child(part.nodes[number], i, child.box, link);
        }
    }

    /// Cuts the largest range in two until there are enough.
    std::size_t split_range(const Range& range, int depth, std::array<Range, kTreeWidth>& children) {
        children[0] = range;
        std::size_t count = 1;
        while (count < kTreeWidth) {
            std::size_t best = kTreeWidth;
            double largest = -1;
            for (std::size_t i = 0; i < count; ++i) {
                const double size = depth < kDeepest ? children[i].box.half_area() : children[i].size();
                if (children[i].size() > kTreeWidth && size > largest) best = i, largest = size;
            }
            if (best == kTreeWidth) break;
            const Range whole = children[best];
            const std::uint32_t middle = cut(whole, depth);
            // In the order of the items, so that leaves follow one another as well.
            for (std::size_t i = count++; i > best + 1; --i) children[i] = children[i - 1];
            children[best] = make_range(whole.begin, middle);
            children[best + 1] = make_range(middle, whole.end);
        }
        return count;
    }

    /// Reorders the range and returns where it is cut.
    std::uint32_t cut(const Range& range, int depth) {
        Box centres;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const Primitive& p = primitives_[i];
            const float centre[3] = {p.centre(0), p.centre(1), p.centre(2)};
            centres.add(centre, centre);
        }
        int widest = 0;
        for (int k = 1; k < 3; ++k)
            if (centres.high[k] - centres.low[k] > centres.high[widest] - centres.low[widest]) widest = k;
        const auto first = primitives_.begin() + range.begin, last = primitives_.begin() + range.end;
        if (depth < kDeepest && centres.high[widest] > centres.low[widest]) {
            const Cut best = find_cut(range, centres);
            if (best.axis >= 0) {
                const auto middle = std::partition(
                    first, last, [&](const Primitive& p) { return find_bin(p, best.axis, centres) < best.bin; });
                const auto at = std::uint32_t(middle - primitives_.begin());
                if (at > range.begin && at < range.end) return at;
            }
        }
        const std::uint32_t at = range.begin + range.size() / 2;
        std::nth_element(first, primitives_.begin() + at, last, [&](const Primitive& a, const Primitive& b) {
            return a.centre(widest) != b.centre(widest) ? a.centre(widest) < b.centre(widest) : a.item < b.item;
        });
        return at;
    }

    struct Cut {
        int axis = -1, bin = 0;
    };

    static int find_bin(const Primitive& p, int axis, const Box& centres) {
        const float scale = float(kBins) / (centres.high[axis] - centres.low[axis]);
        return std::min(int((p.centre(axis) - centres.low[axis]) * scale), kBins - 1);
    }

    Cut find_cut(const Range& range, const Box& centres) const {
        Cut best;
        double least = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const float scale = float(kBins) / (centres.high[axis] - centres.low[axis]);
            if (!(scale > 0 && scale < kInfinity)) continue;
            std::array<Box, kBins> boxes;
            std::array<std::uint32_t, kBins> counts{};
            for (std::uint32_t i = range.begin; i < range.end; ++i) {
                const Primitive& p = primitives_[i];
                const int bin = std::min(int((p.centre(axis) - centres.low[axis]) * scale), kBins - 1);
                boxes[std::size_t(bin)].add(p.low, p.high);
                ++counts[std::size_t(bin)];
            }
            std::array<double, kBins> right_cost{};
            Box box;
            std::uint32_t count = 0;
            for (int bin = kBins - 1; bin > 0; --bin) {
                box.add(boxes[std::size_t(bin)].low, boxes[std::size_t(bin)].high);
                count += counts[std::size_t(bin)];
                right_cost[std::size_t(bin)] = box.half_area() * count_leaves(count);
            }
            box = {}, count = 0;
            for (int bin = 1; bin < kBins; ++bin) {
                box.add(boxes[std::size_t(bin - 1)].low, boxes[std::size_t(bin - 1)].high);
                count += counts[std::size_t(bin - 1)];
                const double cost = box.half_area() * count_leaves(count) + right_cost[std::size_t(bin)];
                if (count > 0 && count < range.size() && cost < least) least = cost, best = {axis, bin};
            }
        }
        return best;
    }

    /// A leaf costs the same whether it is full or not.
    static double count_leaves(std::uint32_t triangles) { return double((triangles + kTreeWidth - 1) / kTreeWidth); }

    void join(const Part& top, const std::vector<Part>& parts, BoxTree& tree) const {
        tree.nodes = top.nodes;
        tree.leaf_first = top.leaf_first;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const auto first_node = std::uint32_t(tree.nodes.size()),
                       first_leaf = std::uint32_t(tree.leaf_first.size());
            tree.nodes[tasks_[i].node].child[tasks_[i].child] = first_node;
            for (BoxTree::Node node : parts[i].nodes) {
                for (std::uint32_t& child : node.child)
                    if (child != BoxTree::kNoChild) child += child & BoxTree::kLeaf ? first_leaf : first_node;
                tree.nodes.push_back(node);
            }
            tree.leaf_first.insert(tree.leaf_first.end(), parts[i].leaf_first.begin(), parts[i].leaf_first.end());
        }
    }

    std::vector<Primitive>& primitives_;
    ThreadPool* threads_;
    std::vector<Task> tasks_;
};

/// False if a vertex can't be used.
bool find_triangle_box(const Mesh& mesh, std::uint32_t triangle, ItemBox& found) {
    Box box;
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& position = mesh.positions[mesh.triangles[triangle][k]];
        if (!is_usable_vertex(position)) return false;
        const float corner[3] = {position.x, position.y, position.z};
        box.add(corner, corner);
    }
    std::copy_n(box.low, 3, found.low);
    std::copy_n(box.high, 3, found.high);
    return true;
}

template <class Body>
void for_blocks(ThreadPool* threads, std::size_t count, std::size_t block, const Body& body) {
    if (threads)
        threads->parallel_for(count, block, body);
    else
        body(0, count);
}

/// False if a triangle can't be used.
bool find_leaf_boxes(const BoxTree& tree, const Mesh& mesh, ThreadPool* threads, std::vector<Box>& boxes) {
    boxes.assign(tree.leaf_count(), {});
    std::vector<std::uint8_t> good(tree.leaf_count(), 1);
    for_blocks(threads, tree.leaf_count(), kLeafBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t leaf = begin; leaf < end; ++leaf)
            for (std::uint32_t i = tree.leaf_first[leaf]; i < tree.leaf_first[leaf + 1]; ++i) {
                ItemBox box;
                if (find_triangle_box(mesh, tree.items[i], box))
                    boxes[leaf].add(box.low, box.high);
                else
                    good[leaf] = 0;
            }
    });
    return std::all_of(good.begin(), good.end(), [](std::uint8_t flag) { return flag; });
}

Box get_box(const BoxTree::Node& node) {
    Box box;
    for (std::size_t i = 0; i < kTreeWidth; ++i) {
        const float low[3] = {node.low[0][i], node.low[1][i], node.low[2][i]};
        const float high[3] = {node.high[0][i], node.high[1][i], node.high[2][i]};
        box.add(low, high);
    }
    return box;
}

double compute_cost(const BoxTree& tree) {
    double sum = 0;
    for (const BoxTree::Node& node : tree.nodes)
        for (std::size_t i = 0; i < kTreeWidth; ++i) {
            Box box;
            for (int k = 0; k < 3; ++k) box.low[k] = node.low[k][i], box.high[k] = node.high[k][i];
            sum += box.half_area();
        }
    const double root = get_box(tree.nodes.front()).half_area();
    return root > 0 ? sum / root : 0;
}

}  // namespace

std::shared_ptr<const BoxTree> make_box_tree(std::span<const ItemBox> boxes, ThreadPool* threads) {
    std::vector<Primitive> primitives;
    primitives.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!(boxes[i].low[0] <= boxes[i].high[0])) continue;
        Primitive& primitive = primitives.emplace_back();
        std::copy_n(boxes[i].low, 3, primitive.low);
        std::copy_n(boxes[i].high, 3, primitive.high);
        primitive.item = std::uint32_t(i);
    }
    auto tree = std::make_shared<BoxTree>();
    if (primitives.empty()) return tree;
    Builder(primitives, threads).build(*tree);
    // Leaves lie in the order of nodes, not of items: where one ends follows from the least start behind it.
    std::vector<std::uint32_t> starts = tree->leaf_first;
    std::sort(starts.begin(), starts.end());
    starts.push_back(std::uint32_t(primitives.size()));
    std::vector<std::uint32_t> first(1, 0);
    tree->items.reserve(primitives.size());
    for (const std::uint32_t start : tree->leaf_first) {
        const auto next = std::upper_bound(starts.begin(), starts.end(), start);
        for (std::uint32_t i = start; i < *next; ++i) tree->items.push_back(primitives[i].item);
        first.push_back(std::uint32_t(tree->items.size()));
    }
    tree->leaf_first = std::move(first);
    tree->cost = tree->made_cost = compute_cost(*tree);
    return tree;
}

std::shared_ptr<const BoxTree> make_mesh_tree(const Mesh& mesh, ThreadPool* threads) {
    std::vector<ItemBox> boxes(mesh.triangles.size());
    for_blocks(threads, boxes.size(), kPrimitiveBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (!find_triangle_box(mesh, std::uint32_t(i), boxes[i])) boxes[i].low[0] = kInfinity;
    });
    return make_box_tree(boxes, threads);
}

std::shared_ptr<const BoxTree> refit_mesh_tree(const BoxTree& tree, const Mesh& mesh, ThreadPool* threads) {
    // A vertex that was not usable may be now.
    if (tree.nodes.empty() || tree.items.size() != mesh.triangles.size()) return nullptr;
    std::vector<Box> leaf_boxes;
    if (!find_leaf_boxes(tree, mesh, threads, leaf_boxes)) return nullptr;
    auto fitted = std::make_shared<BoxTree>(tree);
    for (std::size_t number = fitted->nodes.size(); number-- > 0;) {
        BoxTree::Node& node = fitted->nodes[number];
        for (std::size_t i = 0; i < kTreeWidth; ++i) {
            const std::uint32_t child = node.child[i];
            if (child == BoxTree::kNoChild) continue;
            const bool is_leaf = child & BoxTree::kLeaf;
            set_child(node, i, is_leaf ? leaf_boxes[child & ~BoxTree::kLeaf] : get_box(fitted->nodes[child]), child);
        }
    }
    fitted->cost = compute_cost(*fitted);
    return fitted->cost <= 2 * tree.made_cost ? fitted : nullptr;
}

}  // namespace shadow_layers
