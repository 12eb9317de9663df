// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/weld.h"

#include <algorithm>
#include <bit>

#include "scene/adjacency.h"
#include "scene/bounds.h"

namespace shadow_layers {

namespace {

/// Mixes a position's bits; adding 0 turns -0 into 0, so that places compare and hash alike.
std::uint64_t hash_place(const glm::vec3& p) {
    const auto bits = [](float c) { return std::uint64_t(std::bit_cast<std::uint32_t>(c + 0.0f)); };
    std::uint64_t hash = (bits(p.x) | bits(p.y) << 32) * 0x9e3779b97f4a7c15u;
    hash = ((hash ^ hash >> 32) + bits(p.z)) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ hash >> 29) * 0x94d049bb133111ebu;
    return hash ^ hash >> 32;
}

bool is_before(const glm::vec3& p, const glm::vec3& q) {
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    return p.z < q.z;
}

/// One bit per hash value; 32 to 64 times as many bits as items, so that about one item in fifty meets a set bit.
class HashBitmap {
public:
    explicit HashBitmap(std::size_t item_count)
        : mask_(std::bit_ceil(std::max<std::size_t>(item_count, 2) * 32) - 1), words_((mask_ + 64) / 64) {}
    bool test(std::uint64_t hash) const { return words_[(hash & mask_) / 64] >> (hash & 63) & 1u; }
    bool test_and_set(std::uint64_t hash) {
        std::uint64_t& word = words_[(hash & mask_) / 64];
        const std::uint64_t bit = std::uint64_t{1} << (hash & 63);
        const bool was = word & bit;
        word |= bit;
        return was;
    }

private:
    std::uint64_t mask_;
    std::vector<std::uint64_t> words_;
};

/// Have any two of the vertices that stand for a class come to the same place?
bool has_meeting_classes(std::span<const std::uint32_t> weld, std::span<const glm::vec3> positions) {
    const auto count = std::uint32_t(positions.size());
    HashBitmap seen(count), suspect(count);
    bool any = false;
    for (std::uint32_t v = 0; v < count; ++v) {
        if (weld[v] != v) continue;
        const std::uint64_t hash = hash_place(positions[v]);
        if (!seen.test_and_set(hash)) continue;
        suspect.test_and_set(hash);
        any = true;
    }
    if (!any) return false;
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t v = 0; v < count; ++v)
        if (weld[v] == v && suspect.test(hash_place(positions[v]))) candidates.push_back(v);
    std::sort(candidates.begin(), candidates.end(),
              [&](std::uint32_t v, std::uint32_t w) { return is_before(positions[v], positions[w]); });
    return std::adjacent_find(candidates.begin(), candidates.end(), [&](std::uint32_t v, std::uint32_t w) {
               return positions[v] == positions[w];
           }) != candidates.end();
}

}  // namespace

std::vector<std::uint32_t> weld_vertices(std::span<const glm::vec3> positions) {
    const auto count = std::uint32_t(positions.size());
    const std::size_t mask = std::bit_ceil(std::max<std::size_t>(count, 2) * 2) - 1;
    std::vector<std::uint32_t> weld(count), slots(mask + 1, kNoVertex);
    for (std::uint32_t v = 0; v < count; ++v) {
        weld[v] = v;
        if (!is_usable_vertex(positions[v])) continue;
        for (std::size_t slot = hash_place(positions[v]) & mask;; slot = (slot + 1) & mask) {
            if (slots[slot] == kNoVertex) {
                slots[slot] = v;
                break;
            }
            if (positions[slots[slot]] == positions[v]) {
                weld[v] = slots[slot];
                break;
            }
        }
    }
    return weld;
}

bool weld_still_holds(std::span<const std::uint32_t> weld, std::span<const glm::vec3> positions) {
    if (weld.size() != positions.size()) return false;
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
        if (!is_usable_vertex(positions[v])) return false;
        if (positions[weld[v]] != positions[v]) return false;
    }
    return !has_meeting_classes(weld, positions);
}

}  // namespace shadow_layers
