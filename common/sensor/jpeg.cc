#include "common/sensor/jpeg.h"

#include <jpeglib.h>

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstdio>  // jpeglib.h needs it

namespace pangaea {
namespace {

int ByteAt(std::span<const std::byte> bytes, std::size_t i) { return static_cast<int>(bytes[i]); }

// libjpeg leaves by a jump where it would end the process otherwise.
struct ErrorExit {
  jpeg_error_mgr manager;  // first: libjpeg knows the whole by this part
  std::jmp_buf place;
};

[[noreturn]] void Leave(j_common_ptr decoder) {
  std::longjmp(reinterpret_cast<ErrorExit*>(decoder->err)->place, 1);  // NOLINT: libjpeg is C
}

// Asked for more than the file has. libjpeg would make up an end instead.
boolean LeaveForWantOfData(j_decompress_ptr decoder) { Leave(reinterpret_cast<j_common_ptr>(decoder)); }

void SayNothing(j_common_ptr /*decoder*/) {}

enum class Outcome { kDecoded, kCorrupt, kOfAnotherKind };

bool IsOfAnotherKind(const jpeg_decompress_struct& decoder) {
  const auto is_missing = [](const JHUFF_TBL* table) { return table == nullptr; };
  // The two that a baseline JPEG may have of each.
  const bool has_no_tables = std::all_of(decoder.ac_huff_tbl_ptrs, decoder.ac_huff_tbl_ptrs + 2, is_missing) &&
                             std::all_of(decoder.dc_huff_tbl_ptrs, decoder.dc_huff_tbl_ptrs + 2, is_missing);
  return decoder.num_components == 4 || has_no_tables;
}

// Nothing in here has a destructor, for the jump would pass it by.
Outcome Decode(std::span<const std::byte> file, jpeg_decompress_struct& decoder, ErrorExit& exit, cv::Mat& gray) {
  if (setjmp(exit.place) != 0) return Outcome::kCorrupt;  // NOLINT: as above
  jpeg_mem_src(&decoder, reinterpret_cast<const unsigned char*>(file.data()), file.size());
  decoder.src->fill_input_buffer = &LeaveForWantOfData;
  jpeg_read_header(&decoder, TRUE);
  if (IsOfAnotherKind(decoder)) return Outcome::kOfAnotherKind;
  decoder.out_color_space = JCS_GRAYSCALE;
  decoder.out_color_components = 1;
  jpeg_start_decompress(&decoder);
  // The header was read by ourselves before, and may have been read otherwise.
  if (decoder.output_width != static_cast<JDIMENSION>(gray.cols)) return Outcome::kCorrupt;
  if (decoder.output_height != static_cast<JDIMENSION>(gray.rows)) return Outcome::kCorrupt;
  while (decoder.output_scanline < decoder.output_height) {
    JSAMPROW row = gray.ptr(static_cast<int>(decoder.output_scanline));
    jpeg_read_scanlines(&decoder, &row, 1);
  }
  return Outcome::kDecoded;  // what comes after the pixels is not looked at
}

}  // namespace

bool IsJpeg(std::span<const std::byte> file) {
  return file.size() >= 2 && ByteAt(file, 0) == 0xFF && ByteAt(file, 1) == 0xD8;
}

// A few bytes of padding may follow the marker.
bool JpegIsComplete(std::span<const std::byte> file) {
  std::size_t end = file.size();
  while (end > 2 && ByteAt(file, end - 1) == 0) --end;
  return end > 2 && ByteAt(file, end - 2) == 0xFF && ByteAt(file, end - 1) == 0xD9;
}

// Annex B: the frame header SOFn holds the size.
Result<ImageSize> JpegSize(std::span<const std::byte> file) {
  std::size_t at = 2;
  while (at + 9 <= file.size() && ByteAt(file, at) == 0xFF) {
    const int marker = ByteAt(file, at + 1);
    const bool is_frame_header = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame_header) {
      return ImageSize{ByteAt(file, at + 7) << 8 | ByteAt(file, at + 8),
                       ByteAt(file, at + 5) << 8 | ByteAt(file, at + 6)};
    }
    const bool is_fill = marker == 0xFF;
    at += is_fill ? 1 : 2 + static_cast<std::size_t>(ByteAt(file, at + 2) << 8 | ByteAt(file, at + 3));
  }
  return Fail(ErrorCode::kCorrupt, "truncated or corrupt: the JPEG has no frame header");
}

std::optional<Result<cv::Mat>> DecodeGrayJpeg(std::span<const std::byte> file, ImageSize size) {
  const Result<cv::Mat> corrupt = Fail(ErrorCode::kCorrupt, "corrupt: the pixels cannot be decoded");
  if (size.width <= 0 || size.height <= 0) return corrupt;
  cv::Mat gray(size.height, size.width, CV_8UC1);
  jpeg_decompress_struct decoder{};
  ErrorExit exit{};
  decoder.err = jpeg_std_error(&exit.manager);
  exit.manager.error_exit = &Leave;
  exit.manager.output_message = &SayNothing;
  jpeg_create_decompress(&decoder);
  const Outcome outcome = Decode(file, decoder, exit, gray);
  jpeg_destroy_decompress(&decoder);
  if (outcome == Outcome::kOfAnotherKind) return std::nullopt;
  if (outcome == Outcome::kCorrupt) return corrupt;
  return gray;
}

}  // namespace pangaea
