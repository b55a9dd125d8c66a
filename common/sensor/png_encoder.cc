#include "common/sensor/png_encoder.h"

#include <libdeflate.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "common/base/check.h"

namespace pangaea {
namespace {

// W3C, "Portable Network Graphics (PNG) Specification", second edition, as in png.cc.
constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::uint8_t kLeftFilter = 1;  // section 9.2: each byte less its left neighbour
constexpr int kQuickest = 1;

using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;

std::vector<std::byte> FilteredLines(const cv::Mat& gray) {
  std::vector<std::byte> lines;
  lines.reserve((static_cast<std::size_t>(gray.cols) + 1) * static_cast<std::size_t>(gray.rows));
  for (int row = 0; row < gray.rows; ++row) {
    lines.push_back(std::byte{kLeftFilter});
    int left = 0;
    for (const std::uint8_t pixel : std::span(gray.ptr(row), static_cast<std::size_t>(gray.cols))) {
      lines.push_back(static_cast<std::byte>(pixel - left));
      left = pixel;
    }
  }
  return lines;
}

std::vector<std::byte> Compressed(std::span<const std::byte> octets) {
  const Compressor compressor(libdeflate_alloc_compressor(kQuickest), &libdeflate_free_compressor);
  PANGAEA_CHECK(compressor != nullptr);  // out of memory
  std::vector<std::byte> compressed(libdeflate_zlib_compress_bound(compressor.get(), octets.size()));
  compressed.resize(
      libdeflate_zlib_compress(compressor.get(), octets.data(), octets.size(), compressed.data(), compressed.size()));
  PANGAEA_CHECK(!compressed.empty());  // the bound holds
  return compressed;
}

void AppendBigEndian(std::uint32_t value, std::vector<std::byte>& out) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::byte>(value >> shift & 0xFFU));
}

void AppendChunk(const char* type, std::span<const std::byte> data, std::vector<std::byte>& file) {
  AppendBigEndian(static_cast<std::uint32_t>(data.size()), file);
  const std::size_t checked_from = file.size();
  for (int i = 0; i < 4; ++i) file.push_back(static_cast<std::byte>(type[i]));
  file.insert(file.end(), data.begin(), data.end());
  AppendBigEndian(libdeflate_crc32(0, file.data() + checked_from, file.size() - checked_from), file);
}

std::vector<std::byte> Header(const cv::Mat& gray) {
  std::vector<std::byte> header;
  AppendBigEndian(static_cast<std::uint32_t>(gray.cols), header);
  AppendBigEndian(static_cast<std::uint32_t>(gray.rows), header);
  // 8 bits, grey; compression, filter method and interlacing 0.
  for (const int value : {8, 0, 0, 0, 0}) header.push_back(static_cast<std::byte>(value));
  return header;
}

}  // namespace

std::vector<std::byte> EncodeGrayPng(const cv::Mat& gray) {
  PANGAEA_CHECK(gray.type() == CV_8UC1 && !gray.empty());
  std::vector<std::byte> file;
  for (const std::uint8_t octet : kSignature) file.push_back(std::byte{octet});
  AppendChunk("IHDR", Header(gray), file);
  AppendChunk("IDAT", Compressed(FilteredLines(gray)), file);
  AppendChunk("IEND", {}, file);
  return file;
}

}  // namespace pangaea
