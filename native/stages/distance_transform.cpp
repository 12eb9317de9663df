// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/distance_transform.h"

#include <algorithm>
#include <cmath>

#include "base/clock.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

constexpr int kThreadsPerGroup = 64, kTile = 32;  // as in the shaders
// Sweeps are cut into bands so that a picture with short sides keeps a GPU busy too; shorter bands than this cost more
// at their ends than they bring.
constexpr int kLeastBand = 64, kMostBands = 32;

struct Bands {
    explicit Bands(int side)
        : length(std::max(kLeastBand, (side + kMostBands - 1) / kMostBands)), count((side + length - 1) / length) {}
    int length, count;
};

const gl::Program& use_pass(Engine& engine, const char* name, const gl::Texture& mask_tx,
                            const gl::Defines& defines = {}) {
    engine.check_cancelled();
    const gl::Program& program = engine.program({"stages/distance_transform/" + std::string(name) + ".comp"}, defines);
    program.use();
    program.set("u_size", glm::ivec2(mask_tx.width(), mask_tx.height()));
    return program;
}

void dispatch(Engine& engine, GLuint groups_x, GLuint groups_y) {
    engine.gl().DispatchCompute(groups_x, groups_y, 1);
    engine.gl().MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void fit_texture(Engine& engine, gl::Texture& texture, const gl::TextureDesc& desc, const char* label) {
    if (texture && texture.width() == desc.width && texture.height() == desc.height) return;
    texture = gl::Texture();  // first gives back what is held
    texture = gl::Texture(engine.device(), desc, label);
}

void fit_buffer(Engine& engine, gl::Buffer& buffer, std::size_t bytes, const char* label) {
    if (buffer && buffer.byte_size() >= bytes) return;
    buffer = gl::Buffer();
    buffer = gl::Buffer(engine.device(), bytes, label);
}

/// Border lines as in a picture with shadows: rings of several sizes.
gl::Texture make_sample_mask(Engine& engine) {
    constexpr int kWidth = 640, kHeight = 360;
    std::vector<std::uint8_t> mask(std::size_t(kWidth * kHeight), 0);
    for (int ring = 0; ring < 6; ++ring) {
        const double radius = 20 + 15 * ring, centre_x = 80 + 95 * ring, centre_y = ring % 2 ? 120 : 240;
        for (int step = 0; step < 2000; ++step) {
            const double angle = step * 0.00314159265;
            const int x = int(centre_x + radius * std::cos(2 * angle)),
                      y = int(centre_y + radius * std::sin(2 * angle));
            if (x >= 0 && x < kWidth && y >= 0 && y < kHeight) mask[std::size_t(y * kWidth + x)] = 1;
        }
    }
    gl::Texture mask_tx(engine.device(), {GL_R8UI, kWidth, kHeight}, "distance transform sample");
    mask_tx.upload(mask.data());
    return mask_tx;
}

}  // namespace

const gl::Texture& DistanceTransform::run(Engine& engine, const gl::Texture& mask_tx,
                                          const DistanceTransformOptions& options) {
    return run_by(engine, fastest_method(engine), mask_tx, options);
}

const gl::Texture& DistanceTransform::run_by(Engine& engine, Method method, const gl::Texture& mask_tx,
                                             const DistanceTransformOptions& options) {
    const auto timer = engine.time_stage("distance_transform");
    transform(engine, method, mask_tx, options);
    return nearest_tx_;
}

DistanceTransform::Method DistanceTransform::fastest_method(Engine& engine) {
    if (!fastest_) {
        const auto timer = engine.time_stage("distance_transform_choice");
        const gl::Texture mask_tx = make_sample_mask(engine);
        const double cpu_ms = time_method(engine, Method::CPU, mask_tx);
        fastest_ = time_method(engine, Method::GL, mask_tx) < cpu_ms ? Method::GL : Method::CPU;
    }
    return *fastest_;
}

std::size_t DistanceTransform::byte_size() const {
    return nearest_tx_.byte_size() + sites_tx_.byte_size() + links_tx_.byte_size() + margin_buf_.byte_size() +
           ends_buf_.byte_size() + mask_.size() + nearest_.size() * sizeof(std::uint32_t);
}

double DistanceTransform::time_method(Engine& engine, Method method, const gl::Texture& mask_tx) {
    double least_ms = std::numeric_limits<double>::max();
    for (int round = 0; round < 4; ++round) {
        engine.finish();
        const WallClock clock;
        transform(engine, method, mask_tx, {});
        engine.finish();
        if (round > 0) least_ms = std::min(least_ms, clock.elapsed_ms());  // the first one compiles
    }
    return least_ms;
}

void DistanceTransform::transform(Engine& engine, Method method, const gl::Texture& mask_tx,
                                  const DistanceTransformOptions& options) {
    if (mask_tx.target() != GL_TEXTURE_2D || (mask_tx.format() != GL_R8UI && mask_tx.format() != GL_R8))
        throw InputError("distance transform: the mask's format must be GL_R8UI or GL_R8, without layers");
    const int width = mask_tx.width(), height = mask_tx.height();
    check_transform(width, height, options);
    fit_texture(engine, nearest_tx_, {GL_R32UI, width, height}, "nearest sites");
    if (method == Method::GL)
        transform_on_gl(engine, mask_tx, std::min(options.bound_px, kFarthestTransformDistance));
    else
        transform_on_cpu(engine, mask_tx, options);
}

void DistanceTransform::transform_on_cpu(Engine& engine, const gl::Texture& mask_tx,
                                         const DistanceTransformOptions& options) {
    const int width = mask_tx.width(), height = mask_tx.height();
    mask_.resize(std::size_t(width) * std::size_t(height));
    nearest_.resize(mask_.size());
    mask_tx.read(0, 0, width, height, mask_.data(), mask_.size());
    engine.check_cancelled();
    find_nearest_sites(mask_, width, height, options, engine.threads(), nearest_);
    nearest_tx_.upload(nearest_.data());
}

void DistanceTransform::transform_on_gl(Engine& engine, const gl::Texture& mask_tx, int bound_px) {
    const int width = mask_tx.width(), height = mask_tx.height();
    const Bands columns(width), rows(height);
    fit_texture(engine, sites_tx_, {GL_R16UI, height, width}, "sites of columns");
    fit_texture(engine, links_tx_, {GL_R32UI, height, width}, "links of columns");
    fit_buffer(engine, margin_buf_, sizeof(std::uint32_t) * std::size_t(width) * std::size_t(rows.count), "margins");
    fit_buffer(engine, ends_buf_, sizeof(std::uint32_t) * std::size_t(height) * std::size_t(columns.count), "ends");
    find_column_sites(engine, mask_tx, rows.length, rows.count, bound_px);

    sites_tx_.bind_image(0, GL_READ_ONLY);
    links_tx_.bind_image(1, GL_READ_WRITE);
    ends_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, 0);
    const GLuint row_groups = Engine::group_count(height, kThreadsPerGroup);
    use_pass(engine, "stack", mask_tx).set("u_band_columns", columns.length);
    dispatch(engine, row_groups, GLuint(columns.count));
    for (int stride = 1; stride < columns.count; stride *= 2) {
        const int pairs = (columns.count - stride + 2 * stride - 1) / (2 * stride);
        use_pass(engine, "merge", mask_tx).set("u_stride", stride);
        dispatch(engine, row_groups, GLuint(pairs));
    }
    nearest_tx_.bind_image(2, GL_WRITE_ONLY);
    use_pass(engine, "colour", mask_tx).set("u_bound", bound_px);
    dispatch(engine, Engine::group_count(height, kTile), 1);
    engine.gl().MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

/// Up to sites_tx_: per pixel the row of the nearest site of its column, x and y exchanged. The result's texture holds
/// the rows on the way.
void DistanceTransform::find_column_sites(Engine& engine, const gl::Texture& mask_tx, int band_rows, int band_count,
                                          int bound_px) {
    const int width = mask_tx.width(), height = mask_tx.height();
    const GLuint column_groups = Engine::group_count(width, kThreadsPerGroup);
    const auto use_column_pass = [&](const char* name, const gl::Defines& defines = {}) -> const gl::Program& {
        const gl::Program& program = use_pass(engine, name, mask_tx, defines);
        program.set("u_band_rows", band_rows);
        return program;
    };
    nearest_tx_.bind_image(0, GL_READ_WRITE);
    margin_buf_.bind_base(GL_SHADER_STORAGE_BUFFER, 0);
    use_column_pass("flood", {{"MASK_IS_UINT", mask_tx.format() == GL_R8UI ? "1" : "0"}}).set("u_mask_tx", 0);
    mask_tx.bind(0);
    dispatch(engine, column_groups, GLuint(band_count));

    use_column_pass("margins").set("u_band_count", band_count);
    dispatch(engine, column_groups, GLuint(band_count));

    sites_tx_.bind_image(1, GL_WRITE_ONLY);
    use_column_pass("transpose").set("u_bound", bound_px);
    dispatch(engine, Engine::group_count(width, kTile), Engine::group_count(height, kTile));
}

}  // namespace shadow_layers
