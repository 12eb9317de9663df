// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/node_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shadow_layers {

using soft_kernel::kNoChild;
using soft_kernel::kWidth;
using soft_kernel::Node;

Node make_empty_node() {
    Node node;
    for (int i = 0; i < kWidth; ++i) {
        for (int k = 0; k < 3; ++k) {
            node.low[k][i] = std::numeric_limits<float>::infinity();
            node.high[k][i] = -std::numeric_limits<float>::infinity();
        }
        node.child[i] = kNoChild;
    }
    return node;
}

void set_box(Node& node, int i, const Bounds& box, const BoxWidening& widening, std::uint32_t link) {
    for (int k = 0; k < 3; ++k) {
        const double largest = std::max(std::abs(box.min[k]), std::abs(box.max[k]));
        const double margin = widening.relative * largest + widening.absolute;
        node.low[k][i] = float(box.min[k] - margin);
        node.high[k][i] = float(box.max[k] + margin);
    }
    node.child[i] = link;
}

}  // namespace shadow_layers
