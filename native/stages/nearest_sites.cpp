// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Exact nearest sites in two scans: along columns, then along rows over the lower envelope of the columns' offers, in
// integers. Based on [Meijster00]: A. Meijster, J. Roerdink, W. Hesselink, A general algorithm for computing distance
// transforms in linear time, 2000. Differences: the site itself is kept; ties are decided (lowest row, then leftmost),
// which needs no more than a shift of one where two columns change hands; whole runs of pixels are filled; a bound
// drops rows, columns and pixels beyond it.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "shadow_layers/error.h"
#include "stages/distance_transform.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kColumnsPerBlock = 256, kRowsPerBlock = 8;

// Rows in 16 bits, so that scan 1 works on eight columns per instruction. Sites that are not there lie farther off
// than any picture is high.
constexpr std::int16_t kNoRow = -1;
constexpr std::int16_t kRowBelowAll = -kLargestTransformSide;
constexpr std::int16_t kRowAboveAll = 2 * (kLargestTransformSide - 1) + 1;

/// Scan 1, columns [begin, end): each pixel gets the row of the nearest site of its own column, kNoRow if that is
/// farther than `bound`. Goes along rows, a strip at a time, to read memory in order.
void scan_columns(const std::uint8_t* mask, std::size_t width, int height, int bound, std::size_t begin,
                  std::size_t end, std::int16_t* rows) {
    const std::size_t count = end - begin;
    std::int16_t carried[kColumnsPerBlock];
    std::fill_n(carried, count, kRowBelowAll);
    for (int y = 0; y < height; ++y) {
        const std::uint8_t* mask_row = mask + std::size_t(y) * width + begin;
        std::int16_t* row = rows + std::size_t(y) * width + begin;
        for (std::size_t x = 0; x < count; ++x) row[x] = carried[x] = mask_row[x] ? std::int16_t(y) : carried[x];
    }
    std::fill_n(carried, count, kRowAboveAll);
    const auto radius = std::int16_t(std::min(bound, kLargestTransformSide - 1));
    for (int y = height - 1; y >= 0; --y) {
        const std::uint8_t* mask_row = mask + std::size_t(y) * width + begin;
        std::int16_t* row = rows + std::size_t(y) * width + begin;
        for (std::size_t x = 0; x < count; ++x) {
            carried[x] = mask_row[x] ? std::int16_t(y) : carried[x];
            const auto below = std::int16_t(y - row[x]), above = std::int16_t(carried[x] - y);
            const std::int16_t nearer = above < below ? carried[x] : row[x];
            row[x] = std::min(above, below) <= radius ? nearer : kNoRow;
        }
    }
}

/// Scan 2, one row at a time.
class RowScan {
public:
    /// `inverse_gaps[k]` = 1 / (2 k).
    RowScan(int width, int bound, const std::vector<double>& inverse_gaps)
        : width_(width), bound_(bound), inverse_gaps_(inverse_gaps), owners_(std::size_t(width)) {}

    void scan(const std::int16_t* rows, int y, std::uint32_t* nearest) {
        filled_ = 0;
        for (int x = skip_empty(rows, 0); x < width_; x = skip_empty(rows, x + 1)) {
            const int apart = rows[x] - y;
            // Nothing within the bound of both: the runs on either side do not meet.
            if (count_ > 0 && x - owners_[count_ - 1].x > 2 * bound_) fill_runs(nearest);
            offer({x, rows[x], apart * apart, 0});
        }
        fill_runs(nearest);
        std::fill(nearest + filled_, nearest + width_, kNoSite);
    }

private:
    /// A column's site, and the first pixel of the row that is nearer to it than to any column on the left.
    struct Owner {
        int x, site_y;
        int square;  ///< of the site's distance to the row
        int begin;
    };

    int skip_empty(const std::int16_t* rows, int x) const {
        constexpr int kStep = 4;
        while (x < width_ && rows[x] == kNoRow) {
            std::uint64_t next = 0;
            for (; x + kStep <= width_; x += kStep) {
                std::memcpy(&next, rows + x, sizeof next);
                if (next != ~std::uint64_t{0}) break;
            }
            while (x < width_ && rows[x] == kNoRow) ++x;
        }
        return x;
    }

    /// Is the right one's site nearer at `x`, or as near and lower?
    static bool wins(const Owner& right, const Owner& left, int x) {
        const int to_right = (x - right.x) * (x - right.x) + right.square;
        const int to_left = (x - left.x) * (x - left.x) + left.square;
        return to_right < to_left || (to_right == to_left && right.site_y < left.site_y);
    }

    /// The first pixel that the right one wins; it must lose pixel 0. The bisector is a fraction of integers; half a
    /// unit above its numerator no rounding of the product reaches the next integer, so that the result is exact.
    int first_win(const Owner& left, const Owner& right) const {
        const int tie = right.site_y < left.site_y ? 1 : 0;
        const int numerator = right.x * right.x - left.x * left.x + right.square - left.square - tie;
        return int((numerator + 0.5) * inverse_gaps_[std::size_t(right.x - left.x)]) + 1;
    }

    void offer(Owner column) {
        while (count_ > 0 && wins(column, owners_[count_ - 1], owners_[count_ - 1].begin)) --count_;
        if (count_ > 0) column.begin = first_win(owners_[count_ - 1], column);
        if (column.begin < width_) owners_[count_++] = column;
    }

    void fill_runs(std::uint32_t* nearest) {
        for (std::size_t k = 0; k < count_; ++k) {
            const Owner& owner = owners_[k];
            int begin = owner.begin, end = k + 1 < count_ ? owners_[k + 1].begin : width_;
            const int radius = int(std::sqrt(double(bound_ * bound_ - owner.square)));
            begin = std::max(begin, owner.x - radius);
            end = std::min(end, owner.x + radius + 1);
            if (begin >= end) continue;
            std::fill(nearest + filled_, nearest + begin, kNoSite);
            std::fill(nearest + begin, nearest + end, std::uint32_t(owner.site_y) << 16 | std::uint32_t(owner.x));
            filled_ = end;
        }
        count_ = 0;
    }

    int width_, bound_;
    const std::vector<double>& inverse_gaps_;
    std::vector<Owner> owners_;  ///< from left to right, each with a run of pixels
    std::size_t count_ = 0;
    int filled_ = 0;  ///< pixels of the row written
};

void check_input(std::span<const std::uint8_t> mask, int width, int height, const DistanceTransformOptions& options,
                 std::span<const std::uint32_t> nearest) {
    check_transform(width, height, options);
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    if (mask.size() != pixels || nearest.size() != pixels)
        throw InputError("distance transform of " + std::to_string(width) + "x" + std::to_string(height) +
                         " pixels: the mask has " + std::to_string(mask.size()) + " and the result " +
                         std::to_string(nearest.size()) + "; both must have width * height");
}

}  // namespace

void check_transform(int width, int height, const DistanceTransformOptions& options) {
    if (width < 1 || height < 1 || width > kLargestTransformSide || height > kLargestTransformSide)
        throw InputError("distance transform of " + std::to_string(width) + "x" + std::to_string(height) +
                         " pixels: sides must be 1 to " + std::to_string(kLargestTransformSide));
    if (options.bound_px < 0)
        throw InputError("distance transform: bound_px is " + std::to_string(options.bound_px) +
                         "; it must be 0 or more");
}

void find_nearest_sites(std::span<const std::uint8_t> mask, int width, int height,
                        const DistanceTransformOptions& options, ThreadPool& threads,
                        std::span<std::uint32_t> nearest) {
    check_input(mask, width, height, options, nearest);
    const int bound = std::min(options.bound_px, kFarthestTransformDistance);
    std::vector<std::int16_t> rows(mask.size());
    threads.parallel_for(std::size_t(width), kColumnsPerBlock, [&](std::size_t begin, std::size_t end) {
        scan_columns(mask.data(), std::size_t(width), height, bound, begin, end, rows.data());
    });
    std::vector<double> inverse_gaps(std::size_t(width), 0.0);
    for (std::size_t gap = 1; gap < inverse_gaps.size(); ++gap) inverse_gaps[gap] = 0.5 / double(gap);
    threads.parallel_for(std::size_t(height), kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
        RowScan scan(width, bound, inverse_gaps);
        for (std::size_t y = begin; y < end; ++y)
            scan.scan(rows.data() + y * std::size_t(width), int(y), nearest.data() + y * std::size_t(width));
    });
}

}  // namespace shadow_layers
