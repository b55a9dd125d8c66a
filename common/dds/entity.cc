#include "common/dds/entity.h"

#include <dds/dds.h>

namespace pangaea {

void DdsEntity::Reset() {
  if (handle_ > 0) dds_delete(handle_);
  handle_ = 0;
}

}  // namespace pangaea
