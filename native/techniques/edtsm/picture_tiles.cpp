// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "techniques/edtsm/picture_tiles.h"

#include <algorithm>

#include "engine/banded_draw.h"
#include "techniques/edtsm/penumbra_params.h"

namespace shadow_layers {
namespace {

struct PackedRectangle {
    std::uint32_t columns, rows;  // begin | end << 16
};

std::uint32_t pack(int begin, int end) { return std::uint32_t(begin) | std::uint32_t(end) << 16; }

}  // namespace

PictureTiles::PictureTiles(ThreadPool& threads, std::span<const std::uint8_t> mask, int width, int height)
    : width_(width),
      height_(height),
      columns_((width + kSide - 1) / kSide),
      rows_((height + kSide - 1) / kSide),
      marks_(std::size_t(columns_) * std::size_t(rows_), 0) {
    threads.parallel_for(std::size_t(rows_), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin * kSide; y < std::min(end * kSide, std::size_t(height)); ++y) {
            const std::uint8_t* line = mask.data() + y * std::size_t(width);
            std::uint8_t* marks = marks_.data() + y / kSide * std::size_t(columns_);
            for (int column = 0; column < columns_; ++column) {
                const int first = column * kSide, last = std::min(first + kSide, width);
                std::uint8_t any = 0;
                for (int x = first; x < last; ++x) any |= line[x];
                marks[column] |= any != 0;
            }
        }
    });
}

bool PictureTiles::empty() const { return count() == 0; }

std::size_t PictureTiles::count() const {
    return std::size_t(std::count(marks_.begin(), marks_.end(), std::uint8_t(1)));
}

PictureTiles PictureTiles::grown(int radius_px) const {
    const int reach = std::min((std::max(radius_px, 0) + kSide - 1) / kSide, std::max(columns_, rows_));
    PictureTiles result = *this;
    std::fill(result.marks_.begin(), result.marks_.end(), std::uint8_t(0));
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column) {
            if (!marks_[std::size_t(row * columns_ + column)]) continue;
            const int left = std::max(0, column - reach), right = std::min(columns_ - 1, column + reach);
            for (int y = std::max(0, row - reach); y <= std::min(rows_ - 1, row + reach); ++y)
                std::fill_n(result.marks_.begin() + y * columns_ + left, right - left + 1, std::uint8_t(1));
        }
    return result;
}

void PictureTiles::draw(Engine& engine, const gl::Program& program, double reads_per_pixel) const {
    std::vector<PackedRectangle> rectangles;  // tiles of a row that touch are one
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column) {
            if (!marks_[std::size_t(row * columns_ + column)]) continue;
            const int first = column;
            while (column < columns_ && marks_[std::size_t(row * columns_ + column)]) ++column;
            rectangles.push_back({pack(first * kSide, std::min(column * kSide, width_)),
                                  pack(row * kSide, std::min((row + 1) * kSide, height_))});
        }
    if (rectangles.empty()) return;
    const gl::Buffer list_buf(engine.device(), std::span<const PackedRectangle>(rectangles), "picture tiles");
    list_buf.bind_base(GL_SHADER_STORAGE_BUFFER, kTileListSlot);
    program.set("u_picture_size", glm::vec2(width_, height_));
    // Tiles lie unevenly: as if all did in some rows, no band is longer than it should be.
    draw_in_bands(engine, width_, height_, reads_per_pixel, {}, [&](const DrawState& band) {
        engine.draw_vertices(band, GL_TRIANGLES, GLsizei(6 * rectangles.size()));
    });
}

}  // namespace shadow_layers
