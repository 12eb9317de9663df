// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/cancel_token.h"
#include "base/clock.h"
#include "base/content_cache.h"
#include "base/thread_pool.h"
#include "engine/draw_state.h"
#include "engine/stage_record.h"
#include "gl/buffer.h"
#include "gl/device.h"
#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/shader_source.h"
#include "gl/texture.h"
#include "gl/vertex_array.h"
#include "scene/mesh_data_cache.h"

namespace shadow_layers {

class Context;
class Engine;
class MeshCache;

struct EngineOptions {
    std::string shader_dir;
    int threads = 0;
    std::size_t gpu_cache_bytes = std::size_t{1} << 30;     ///< half for meshes, half for stage results
    std::size_t host_cache_bytes = std::size_t{512} << 20;  ///< mesh data
    bool debug = false;
};

/// Times what happens while it lives, as one stage of the current record. Not nested: the outer would count the inner
/// too. Its end asks GL for errors; the next Engine call that may throw tells of them, and of what else went
/// wrong there, under the stage's name.
class StageTimer {
public:
    StageTimer(Engine& engine, std::string stage);
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

private:
    Engine& engine_;
    std::string stage_;
    StageRecord::Mark mark_;
};

/// What techniques and stages get: GL, programs, caches, threads, clocks, the cancel token. Lives on the worker thread,
/// which owns the context. Everything here is called from that thread only, except within ThreadPool loops, which must
/// not touch GL.
class Engine {
public:
    Engine(Context& context, const EngineOptions& options);
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    const gl::Device& device() const { return *device_; }
    const GladGLContext& gl() const { return device_->gl(); }
    const gl::Limits& limits() const { return device_->limits(); }
    bool software() const { return device_->software(); }

    /// The program of these files (paths from the shader folder) and defines; compiled once, kept for the engine's
    /// life.
    const gl::Program& program(const std::string& vertex, const std::string& fragment, const gl::Defines& defines = {});
    /// Any set of stages: {"x.vert", "x.geom", "x.frag"} or {"x.comp"}.
    const gl::Program& program(const std::vector<std::string>& files, const gl::Defines& defines = {});

    /// Results of stages on the GL, kept between frames by the keys of their inputs. T::byte_size() is of the GL's.
    ContentCache& stages() { return stages_; }
    /// What is derived from meshes on the host, kept between frames.
    MeshDataCache& mesh_data() { return mesh_data_; }
    /// Meshes on the GPU; used through draw_scene (engine/scene_draw.h).
    MeshCache& meshes() { return *meshes_; }
    ThreadPool& threads() { return *threads_; }
    CancelToken& cancel_token() { return cancel_; }

    /// Throws Cancelled if the session was told so, else what the end of a stage met (DriverError for a GL error). Call
    /// it in long CPU loops (from this thread) and between draws.
    void check_cancelled();

    /// How far a technique is with the sample of the light at hand, 0 to 1. Long CPU loops tell it as often as they
    /// like: it goes on at most every 30 ms. Also within ThreadPool loops: what other threads tell is left out.
    void tell_progress(double fraction);

    /// `auto timer = engine.time_stage("depth_map");` CPU wall time and GL time of the scope, summed by name.
    [[nodiscard]] StageTimer time_stage(const char* stage) { return StageTimer(*this, stage); }
    void count(const std::string& counter, std::int64_t amount);
    /// Kept once per render, in order.
    void warn(const std::string& text);

    /// Sets state and draws one triangle over the viewport with the program in use (vertex: "frame/fullscreen.vert").
    void draw_fullscreen(const DrawState& state = {});
    /// Sets state and draws `vertex_count` vertices without attributes; the program in use makes them from gl_VertexID.
    void draw_vertices(const DrawState& state, GLenum mode, GLsizei vertex_count);
    /// Compute: groups to cover `items` threads at `group` per group.
    static GLuint group_count(int items, int group) { return GLuint((items + group - 1) / group); }

    // --- for the session and tests ---
    /// Lets the caches drop what the last renders did not use.
    void begin_render();
    /// Counts renders from 1; for caches outside of the engine's own.
    std::uint64_t render_number() const { return render_number_; }
    /// Where progress goes from now on; null: nowhere.
    void set_progress(std::function<void(double fraction)> progress);
    /// The work that comes is this part of what is told of.
    void set_progress_part(double begin, double end) { progress_begin_ = begin, progress_end_ = end; }
    /// Where times and counts go from now on; null: nowhere. Not owned.
    void set_record(StageRecord* record) { record_ = record; }
    StageRecord* record() { return record_; }
    std::vector<std::string> take_warnings();
    /// Forgets errors that a render left behind which was given up.
    void drop_errors();
    /// Vertex stream for draw_scene, grown as needed; its old content is dropped.
    gl::Buffer& instance_stream(std::size_t bytes);
    /// The same, and DriverError if GL reports an error now.
    void check_gl(const char* where);
    /// Bytes on the GL held by all objects alive.
    std::size_t gpu_bytes() const { return device_->live_bytes(); }
    /// Lets no more than one earlier batch of draws be unfinished: what a cancel waits for stays short. Throws
    /// Cancelled if the session was told so, DriverError if the driver is lost: it fails to wait, or is not done in a
    /// minute.
    void limit_queue();
    /// Waits for all GL work.
    void finish();

private:
    friend class StageTimer;
    std::unique_ptr<gl::Device> device_;
    std::unique_ptr<gl::ShaderSource> sources_;
    std::unique_ptr<ThreadPool> threads_;
    CancelToken cancel_;
    std::map<std::string, gl::Program> programs_;
    ContentCache stages_;
    MeshDataCache mesh_data_;
    std::unique_ptr<MeshCache> meshes_;
    gl::VertexArray empty_vertices_;
    gl::Buffer instance_stream_;
    GLsync last_batch_ = nullptr;
    StageRecord* record_ = nullptr;
    std::uint64_t render_number_ = 0;
    const std::thread::id thread_ = std::this_thread::get_id();
    std::function<void(double)> progress_;
    double progress_begin_ = 0, progress_end_ = 1;
    WallClock progress_clock_;        ///< since progress was last told
    std::exception_ptr stage_error_;  ///< the first one since it was last told
    std::vector<std::string> warnings_;
};

}  // namespace shadow_layers
