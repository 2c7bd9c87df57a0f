#include "output/files/exr_file.h"

#include "base/error.h"

#ifdef SUPPLE_OPENEXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>

#include <algorithm>
#include <exception>
#endif

namespace supple {

#ifdef SUPPLE_OPENEXR
namespace {

// Takes a file's bytes in memory. The library goes back to fill in the table of rows.
class Bytes : public Imf::OStream {
 public:
  Bytes() : Imf::OStream("picture") {}
  void write(const char data[], int count) override {
    const std::size_t end = at_ + std::size_t(count);
    if (end > bytes.size()) bytes.resize(end);
    std::copy_n(data, count, bytes.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }

  std::vector<std::uint8_t> bytes;

 private:
  std::size_t at_ = 0;
};

}  // namespace

bool writes_exr() { return true; }

std::vector<std::uint8_t> exr_bytes(int width, int height, std::span<const float> values) {
  const std::size_t pixels = std::size_t(width) * height, channels = values.size() / pixels;
  SUPPLE_CHECK(values.size(), ==, (channels == 3 ? 3 : 1) * pixels);
  Bytes stream;
  try {
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < channels; ++c) {
      const char* name = channels == 1 ? "Y" : c == 0 ? "R" : c == 1 ? "G" : "B";
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      auto* first = reinterpret_cast<char*>(const_cast<float*>(values.data() + c));  // it is only read
      buffer.insert(name, Imf::Slice(Imf::FLOAT, first, channels * sizeof(float), channels * sizeof(float) * width));
    }
    Imf::OutputFile file(stream, header, 0);  // no threads: several pictures are compressed at a time
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  } catch (const std::exception& error) {
    throw RunError(std::string("a pass cannot be written as OpenEXR: ") + error.what());
  }
  return std::move(stream.bytes);
}
#else
bool writes_exr() { return false; }

std::vector<std::uint8_t> exr_bytes(int, int, std::span<const float>) {
  throw RunError("the program was built without OpenEXR");
}
#endif

}  // namespace supple
