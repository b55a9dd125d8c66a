#pragma once

#include <dds/dds.h>

#include <string>

#include "common/base/result.h"
#include "common/dds/entity.h"

namespace pangaea {

// The library's return code as a status; `what` says what was tried.
inline Status DdsStatus(dds_return_t code, const std::string& what) {
  if (code >= 0) return {};
  const ErrorCode kind = code == DDS_RETCODE_TIMEOUT || code == DDS_RETCODE_OUT_OF_RESOURCES
                             ? ErrorCode::kUnavailable
                             : ErrorCode::kInvalidArgument;
  return Fail(kind, "DDS: " + what + ": " + dds_strretcode(code));
}

// The entity of a handle, or the error a negative handle stands for.
inline Result<DdsEntity> DdsEntityOf(dds_entity_t handle, const std::string& what) {
  if (handle > 0) return DdsEntity(handle);
  const Status status = DdsStatus(handle, what);
  return tl::make_unexpected(status ? Error{ErrorCode::kUnavailable, "DDS: " + what} : status.error());
}

}  // namespace pangaea
