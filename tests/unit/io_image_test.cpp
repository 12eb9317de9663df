// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <OpenImageIO/imageio.h>
#include <sys/resource.h>

#include <csignal>
#include <random>

#include "io/image_writer.h"
#include "io/whole_file.h"
#include "unit/io_support.h"

namespace shadow_layers::test {
namespace {

// A limit on the size of files stands in for a full disk: writes fail in the same place, with EFBIG instead of ENOSPC.
class SmallDisk {
public:
    explicit SmallDisk(rlim_t bytes) {
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~SmallDisk() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    sighandler_t handler_ = nullptr;
};

Image make_image(int width, int height, int channels) {
    Image image{width, height, channels, {}};
    std::minstd_rand random(1);  // noise, which does not compress
    for (int i = 0; i < width * height * channels; ++i) image.data.push_back(float(random() % 65536) / 65536.0f);
    return image;
}

class IoImage : public FolderTest {
protected:
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder_)) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }
};

TEST_F(IoImage, ExrComesBackBitForBit) {
    const PixelRect region{3, 2, 17, 11};
    const Image mask = make_image(17, 11, 1), tint = make_image(17, 11, 3), picture = make_image(17, 11, 4);
    {
        io::ExrWriter writer(folder_ / "layers.exr", 40, 30, region,
                             {{"View.Shadow Key sm", 1, {{"shadow_layers.light", "Key.001 \"é\""}}},
                              {"View.Tint", 3, {}},
                              {"View.Combined", 4, {}}});
        EXPECT_EQ(files().size(), 1u) << "a temporary file";
        EXPECT_FALSE(std::filesystem::exists(folder_ / "layers.exr")) << "not under its name before it is whole";
        writer.write(mask);
        writer.write(tint);
        writer.write(picture);
        writer.finish();
    }
    EXPECT_EQ(files(), std::vector<std::string>{"layers.exr"});
    const auto input = OIIO::ImageInput::open((folder_ / "layers.exr").string());
    ASSERT_TRUE(input);
    const std::vector<std::vector<std::string>> names = {
        {"View.Shadow Key sm.X"},
        {"View.Tint.R", "View.Tint.G", "View.Tint.B"},
        {"View.Combined.R", "View.Combined.G", "View.Combined.B", "View.Combined.A"}};
    const Image* images[] = {&mask, &tint, &picture};
    for (int part = 0; part < 3; ++part) {
        const OIIO::ImageSpec spec = input->spec(part);
        EXPECT_EQ(spec.channelnames, names[std::size_t(part)]);
        EXPECT_EQ(spec.format, OIIO::TypeDesc::FLOAT);
        EXPECT_EQ(spec.x, 3);
        EXPECT_EQ(spec.y, 30 - 2 - 11);
        EXPECT_EQ(spec.full_width, 40);
        EXPECT_EQ(spec.full_height, 30);
        std::vector<float> pixels(spec.image_pixels() * std::size_t(spec.nchannels));
        ASSERT_TRUE(input->read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()));
        const std::size_t row = std::size_t(spec.width * spec.nchannels);
        for (int y = 0; y < spec.height; ++y) {
            const float* file_row = pixels.data() + std::size_t(spec.height - 1 - y) * row;
            EXPECT_TRUE(std::equal(file_row, file_row + row, images[part]->data.data() + std::size_t(y) * row))
                << "row " << y;
        }
    }
    EXPECT_EQ(input->spec(0).get_string_attribute("shadow_layers.light"), "Key.001 \"é\"");
}

TEST_F(IoImage, AnExrThatIsNotFinishedLeavesNothing) {
    {
        io::ExrWriter writer(folder_ / "layers.exr", 8, 8, {0, 0, 8, 8}, {{"A", 1, {}}, {"B", 1, {}}});
        writer.write(make_image(8, 8, 1));
        EXPECT_THROW(writer.finish(), FileError);
    }
    EXPECT_TRUE(files().empty());
}

TEST_F(IoImage, PicturesOfAnotherSizeAreRefused) {
    io::ExrWriter writer(folder_ / "layers.exr", 8, 8, {0, 0, 8, 8}, {{"A", 1, {}}});
    EXPECT_THROW(writer.write(make_image(8, 9, 1)), FileError);
    EXPECT_THROW(writer.write(make_image(8, 8, 3)), FileError);
}

TEST_F(IoImage, PngOfAMaskIsLinearAndTheRightWayUp) {
    Image image{2, 3, 1, {0, 0.5f, 1, 2, -1, std::nanf("")}};
    io::write_png(folder_ / "mask.png", image);
    EXPECT_EQ(files(), std::vector<std::string>{"mask.png"});
    const auto input = OIIO::ImageInput::open((folder_ / "mask.png").string());
    ASSERT_TRUE(input);
    ASSERT_EQ(input->spec().nchannels, 1);
    std::vector<std::uint8_t> pixels(6);
    ASSERT_TRUE(input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT8, pixels.data()));
    EXPECT_EQ(pixels, (std::vector<std::uint8_t>{0, 0, 255, 255, 0, 128}));
}

TEST_F(IoImage, PngOfAPictureIsSrgbWithStraightAlpha) {
    // Premultiplied half grey at half coverage: straight 0.5, which sRGB encodes as 188.
    io::write_png(folder_ / "a.png", Image{1, 1, 4, {0.25f, 0.25f, 0.25f, 0.5f}});
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::open((folder_ / "a.png").string(), &config);
    ASSERT_TRUE(input);
    std::vector<std::uint8_t> pixels(4);
    ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, pixels.data()));
    EXPECT_EQ(pixels, (std::vector<std::uint8_t>{188, 188, 188, 128}));
}

TEST_F(IoImage, AFullDiskIsReportedAndNothingIsLeft) {
    const Image noise = make_image(256, 256, 1);
    for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{5000}, rlim_t{40000}}) {
        const SmallDisk disk(bytes);
        EXPECT_NE(
            error_of([&] {
                io::ExrWriter writer(folder_ / "layers.exr", 256, 256, {0, 0, 256, 256}, {{"A", 1, {}}, {"B", 1, {}}});
                writer.write(noise);
                writer.write(noise);
                writer.finish();
            }).find("layers.exr"),
            std::string::npos)
            << bytes;
        EXPECT_TRUE(files().empty()) << bytes;
        EXPECT_NE(error_of([&] { io::write_png(folder_ / "a.png", noise); }).find("free its disk"), std::string::npos);
        EXPECT_NE(error_of([&] { io::write_whole_file(folder_ / "a.json", std::string(50000, ' ')); }).find("a.json"),
                  std::string::npos);
        EXPECT_TRUE(files().empty()) << bytes;
    }
}

TEST_F(IoImage, AnOldFileStaysIfTheNewOneFails) {
    io::write_whole_file(folder_ / "a.json", "old");
    {
        const SmallDisk disk(10);
        EXPECT_THROW(io::write_whole_file(folder_ / "a.json", std::string(1000, 'x')), FileError);
    }
    std::ifstream stream(folder_ / "a.json");
    EXPECT_EQ(std::string((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>()), "old");
}

TEST_F(IoImage, FoldersThatCannotBeWrittenAreNamed) {
    EXPECT_NE(error_of([&] { io::make_output_folder("/proc/layers"); }).find("/proc/layers"), std::string::npos);
    write("file", "");
    EXPECT_NE(error_of([&] { io::make_output_folder(folder_ / "file"); }).find("file"), std::string::npos);
    EXPECT_NE(error_of([&] { io::write_png(folder_ / "nowhere" / "a.png", make_image(2, 2, 1)); }).find("No such file"),
              std::string::npos);
    EXPECT_THROW(io::ExrWriter(folder_ / "nowhere" / "a.exr", 2, 2, {0, 0, 2, 2}, {{"A", 1, {}}}), FileError);
    io::make_output_folder(folder_ / "new" / "deep");
    EXPECT_TRUE(std::filesystem::is_directory(folder_ / "new" / "deep"));
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "new" / "deep"));
}

}  // namespace
}  // namespace shadow_layers::test
