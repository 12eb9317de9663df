// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/engine.h"

namespace shadow_layers {

/// Which squares of the picture hold anything of interest, so that costly passes are drawn over these alone.
class PictureTiles {
public:
    static constexpr int kSide = 16;  ///< pixels

    PictureTiles() = default;
    /// Marks the tiles where `mask` (width * height, row 0 first) is not 0.
    PictureTiles(ThreadPool& threads, std::span<const std::uint8_t> mask, int width, int height);

    bool empty() const;
    std::size_t count() const;
    /// These tiles and all within `radius_px` of one of their pixels.
    PictureTiles grown(int radius_px) const;

    /// Draws the program in use (vertex: kVertexShader) over the tiles into the bound target of the picture's size, in
    /// bands between which a cancel is heard; a pixel reads about `reads_per_pixel` texels.
    void draw(Engine& engine, const gl::Program& program, double reads_per_pixel) const;
    static constexpr const char* kVertexShader = "techniques/edtsm/picture_tiles.vert";

private:
    int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;
    std::vector<std::uint8_t> marks_;  // columns_ * rows_
};

}  // namespace shadow_layers
