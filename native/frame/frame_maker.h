// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <list>
#include <map>
#include <memory>
#include <optional>

#include "engine/engine.h"
#include "frame/frame.h"
#include "frame/visibility_buffer.h"

namespace shadow_layers {

/// What a frame is made of. Camera and size are the full picture's; an empty region is not allowed here.
struct FrameView {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    int width = 0, height = 0;
    PixelRect region;
    int overscan_px = 0;
};

/// Buffers that frames leave behind, for the next frame of the same size: making 60 MB anew costs as much as filling
/// it. Shared by the frames, so that a frame may outlive its maker (but not the context).
class FramePool {
public:
    struct Buffers {
        int width = 0, height = 0;
        std::vector<glm::vec3> positions_rel, normals;
        std::vector<PixelIds> ids;
        std::vector<std::uint8_t> coverage;
        std::shared_ptr<gl::Texture> position_tx, normal_tx;
    };
    std::optional<Buffers> take(int width, int height);
    void give(Buffers buffers);
    /// What one frame needs while it is made; also too costly to make anew for each render.
    struct Scratch {
        std::optional<VisibilityBuffer> visibility;
        std::vector<glm::vec4> position_texels, normal_texels;
    };
    Scratch& scratch() { return scratch_; }
    void clear();
    std::size_t host_bytes() const;

private:
    Scratch scratch_;
    std::list<Buffers> free_;  ///< most recent first
};

/// Makes the frames of one render. The frames of offsets already made are kept while they fit the budget.
class FrameMaker {
public:
    FrameMaker(Engine& engine, std::shared_ptr<FramePool> pool, FrameView view,
               std::size_t budget_bytes = std::size_t{384} << 20);

    /// The frame moved by `offset_px` pixels. Times stages "frame_ids", "frame_readback" and "frame_resolve".
    std::shared_ptr<const Frame> make(const glm::dvec2& offset_px);

    const FrameView& view() const { return view_; }

private:
    std::shared_ptr<Frame> make_empty(const glm::dvec2& offset_px);
    void keep(const glm::dvec2& offset_px, const std::shared_ptr<const Frame>& frame);

    Engine& engine_;
    std::shared_ptr<FramePool> pool_;
    FrameView view_;
    ContentKey scene_key_;
    std::vector<Bounds> instance_bounds_ws_;
    struct Kept {
        glm::dvec2 offset_px;
        std::shared_ptr<const Frame> frame;
    };
    std::list<Kept> kept_;  ///< most recently used first
    std::size_t budget_bytes_;
};

/// The frames about one sample of the picture.
class SampleFrames final : public FrameSource {
public:
    SampleFrames(FrameMaker& maker, const glm::dvec2& offset_px)
        : maker_(maker), offset_px_(offset_px), centre_(maker.make(offset_px)) {}
    const Frame& centre() const override { return *centre_; }
    std::shared_ptr<const Frame> at_offset(double dx_px, double dy_px) override;

private:
    FrameMaker& maker_;
    glm::dvec2 offset_px_;
    std::shared_ptr<const Frame> centre_;
};

}  // namespace shadow_layers
