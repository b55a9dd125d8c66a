#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace pangaea {

enum class ErrorCode {
  kInvalidArgument,  // an option, a config value or a message field is out of range
  kNotFound,         // a file, a key or an id does not exist
  kCorrupt,          // data that exists cannot be what it claims to be
  kUnsupported,      // a version or a kind this build does not know
  kRefused,          // understood, but not allowed
  kUnavailable,      // disk, network or peer does not answer now; trying later may help
};

// What went wrong in the outside world, in words for the person who can mend it: what, where, the allowed range.
struct Error {
  ErrorCode code;
  std::string message;
};

// The value, or why the outside world did not give one. Our own mistakes are PANGAEA_CHECKs instead.
template <typename T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

[[nodiscard]] inline tl::unexpected<Error> Fail(ErrorCode code, std::string message) {
  return tl::make_unexpected(Error{code, std::move(message)});
}

}  // namespace pangaea
